/* SPDX-License-Identifier: MIT
 * From [probe] sections to columns of files, and the values in them. */
#include "output/probes.h"

/* Place of the k-th particle from the probe in units of the reach, and its weight. Any positive one
 * reproduces linear fields; this one is smooth and vanishes at the reach. */
static double offset(const struct probe *probe, const struct particles *particles, int k,
                     double reach, double *x, double *y)
{
    *x = (particles->X[probe->particle[k]] - probe->given->point[0]) / reach;
    *y = (particles->Y[probe->particle[k]] - probe->given->point[1]) / reach;
    return square(square(max2(0, 1 - (*x * *x + *y * *y))));
}

/* Weights of linear moving least squares (Lancaster and Salkauskas 1981): the value at the probe of
 * the plane fitted to the particles. Particles on one line have the weighted mean. */
static void find_weights(struct probe *probe, const struct particles *particles, double reach)
{
    double m00 = 0, m10 = 0, m01 = 0, m20 = 0, m11 = 0, m02 = 0, x, y;
    for (int k = 0; k < probe->n; k++) {
        const double w = offset(probe, particles, k, reach, &x, &y);
        m00 += w, m10 += w * x, m01 += w * y;
        m20 += w * x * x, m11 += w * x * y, m02 += w * y * y;
    }
    const double c00 = m20 * m02 - m11 * m11;
    const double c10 = m11 * m01 - m10 * m02;
    const double c01 = m10 * m11 - m20 * m01;
    const double det = m00 * c00 + m10 * c10 + m01 * c01;
    const bool collinear = !(det > 1e-9 * m00 * m00 * m00);
    for (int k = 0; k < probe->n; k++) {
        const double w = offset(probe, particles, k, reach, &x, &y);
        probe->weight[k] = collinear ? w / m00 : w * (c00 + c10 * x + c01 * y) / det;
    }
}

/* To the particles of its body within 2 h; geometry/extent.c refuses points outside of a body. */
static enum err attach(struct probe *probe, const struct simulation *sim, struct arena *a,
                       struct diag *d)
{
    const struct particles *const particles = &sim->particles[KIND_SOLID];
    const double reach = 2 * scene_solid_h(sim->scene, probe->body);
    for (int64_t i = 0; i < particles->n; i++) {
        const double x = particles->X[i] - probe->given->point[0],
                     y = particles->Y[i] - probe->given->point[1];
        if (particles->body[i] != probe->body || square(x) + square(y) >= square(reach)) continue;
        TRY(arena_more(a, &probe->particle, probe->n, "probe", d));
        probe->particle[probe->n++] = (int32_t)i;
    }
    TRY(arena_array(a, &probe->weight, probe->n, "probe", d));
    find_weights(probe, particles, reach);
    return ERR_OK;
}

/* A point within half of the beam's thickness, or of an element, of its line. */
static enum err attach_to_beam(struct probe *probe, const struct simulation *sim, struct diag *d)
{
    const struct beams *const beams = &sim->beams;
    const struct scene_beam *const given = &sim->scene->beam[probe->beam];
    probe->place = beam_find(beams, probe->beam, probe->given->point);
    const double off = probe->place.distance;
    if (probe->target != TARGET_SOLID_POINT ||
        off <= 0.5 * beams->element[probe->place.element].length || off <= 0.5 * given->thickness)
        return ERR_OK;
    return fail_at(d, sim->scene, probe->given->common.line,
                   "[probe %s] point = %g, %g is %.3g m from the line of [beam %s]; move it there",
                   probe->given->common.name, probe->given->point[0], probe->given->point[1], off,
                   given->common.name);
}

/* What must bring fields up to date before a probe reads them, each more than the one before. */
enum need { NEED_NOTHING, NEED_REFRESH, NEED_WALL_FORCES };

static enum need need_of(const struct probe *probe)
{
    static const enum need needs[] = {
#define QUANTITY(NAME, name, target, need, ...) NEED_##need,
#include "case/quantities.def"
    };
    for (int k = 0; k < probe->n_bodies; k++)
        if (probe->bodies[k].kind == KIND_WALL) return NEED_WALL_FORCES;
    return needs[probe->given->quantity];
}

static void refresh(struct simulation *sim, enum need need)
{
    if (need == NEED_WALL_FORCES)
        simulation_wall_forces(sim);
    else if (need == NEED_REFRESH)
        simulation_refresh(sim);
}

static struct probe_body find_body(const struct scene *scene, const char *name)
{
    const int solid = scene_find(scene, SECTION_solid, name);
    if (solid >= 0) return (struct probe_body){KIND_SOLID, solid};
    return (struct probe_body){KIND_WALL, scene_find(scene, SECTION_wall, name)};
}

/* The bodies of a force. */
static enum err find_bodies(struct probe *probe, const struct scene *scene, struct arena *a,
                            struct diag *d)
{
    char name[SCENE_TEXT];
    while (scene_listed(probe->given->body, probe->n_bodies, name)) probe->n_bodies++;
    TRY(arena_array(a, &probe->bodies, probe->n_bodies, "probe", d));
    for (int k = 0; k < probe->n_bodies && scene_listed(probe->given->body, k, name); k++)
        probe->bodies[k] = find_body(scene, name);
    return ERR_OK;
}

/* The body that carries a point or a line of the fluid. */
static enum err attach_to_body(struct probe *probe, const struct simulation *sim, struct arena *a,
                               struct diag *d)
{
    const struct probe_body on = find_body(sim->scene, probe->given->on);
    if (on.kind == KIND_WALL) {
        probe->motion = scene_wall_motion(sim->scene, on.body);
        return ERR_OK;
    }
    probe->body = on.body;
    return attach(probe, sim, a, d);
}

static enum err create_probe(struct probe *probe, const struct scene_probe *sp,
                             const struct simulation *sim, struct arena *a, struct diag *d)
{
    *probe =
        (struct probe){.given = sp,
                       .target = scene_probe_target(sp),
                       .columns = slice_count(slice_of(quantity_table[sp->quantity].columns), ','),
                       .motion = -1,
                       .kind = KIND_SOLID,
                       .body = scene_find(sim->scene, SECTION_solid, sp->body),
                       .beam = scene_find(sim->scene, SECTION_beam, sp->body)};
    if (probe->beam >= 0 && probe->target != TARGET_BODY) return attach_to_beam(probe, sim, d);
    if (probe->target == TARGET_SOLID && probe->body < 0) {
        probe->kind = KIND_WALL;
        probe->body =
            scene_find(sim->scene, SECTION_wall, sp->body) - scene_rigid_wall(sim->scene, 0);
        probe->spring = scene_find(sim->scene, SECTION_spring, sp->body);
        return ERR_OK;
    }
    if (probe->target == TARGET_BODY) return find_bodies(probe, sim->scene, a, d);
    if (*sp->on) return attach_to_body(probe, sim, a, d);
    return probe->target == TARGET_SOLID_POINT ? attach(probe, sim, a, d) : ERR_OK;
}

/* --- files --- */

bool probe_column(const struct scene_probe *sp, int column, char *name, size_t size)
{
    const char *ending = quantity_table[sp->quantity].columns;
    for (; column > 0 && *ending; column--) {
        ending += strcspn(ending, ",");
        ending += *ending == ',';
    }
    const int length = (int)strcspn(ending, ",");
    snprintf(name, size, "%s_%.*s", sp->common.name, length, ending);
    return length > 0;
}

/* Defines a file: of all probes without an interval (only = -1), or of probe `only`. */
static enum err create_file(struct probes *probes, const struct scene *scene, int only,
                            struct arena *a, struct diag *d)
{
    struct probe_file *const f = &probes->file[probes->n_files];
    const size_t size = 8 + (size_t)probes->n * PROBE_MAX_COLUMNS * PROBE_COLUMN_TEXT;
    char *const header = arena_alloc(a, size, 1, "header of probes.csv", d);
    char name[PROBE_COLUMN_TEXT];
    if (!header) return ERR_MEMORY;
    size_t at = (size_t)snprintf(header, size, "time_s");
    *f = (struct probe_file){.header = header, .columns = 1};
    for (int k = 0; k < probes->n; k++) {
        const struct scene_probe *const sp = &scene->probe[k];
        if (only >= 0 ? k != only : sp->interval > 0) continue;
        probes->probe[k].file = probes->n_files;
        probes->probe[k].column = f->columns;
        for (int c = 0; probe_column(sp, c, name, sizeof name); c++)
            at += (size_t)snprintf(header + at, size - at, ",%s", name);
        f->columns += probes->probe[k].columns;
        f->interval = sp->interval > 0 ? sp->interval : scene->output.probe_interval;
    }
    if (f->columns == 1) return ERR_OK;
    snprintf(f->name, sizeof f->name, only >= 0 ? "probes_%s.csv" : "probes.csv",
             only >= 0 ? scene->probe[only].common.name : "");
    probes->n_files++;
    return ERR_OK;
}

enum err probes_create(struct probes *probes, const struct simulation *sim, struct arena *a,
                       struct diag *d)
{
    const struct scene *scene = sim->scene;
    *probes = (struct probes){.n = scene->n_probe};
    TRY(arena_array(a, &probes->probe, probes->n, "probes", d));
    TRY(arena_array(a, &probes->file, (size_t)probes->n + 1, "probes", d));
    for (int k = 0; k < probes->n; k++)
        TRY(create_probe(&probes->probe[k], &scene->probe[k], sim, a, d));
    TRY(create_file(probes, scene, -1, a, d));
    for (int k = 0; k < probes->n; k++)
        if (scene->probe[k].interval > 0) TRY(create_file(probes, scene, k, a, d));
    return ERR_OK;
}

/* --- values --- */

static void weighted_sum(const struct probe *probe, const double *fx, const double *fy,
                         double out[2])
{
    out[0] = out[1] = 0;
    for (int k = 0; k < probe->n; k++) {
        out[0] += probe->weight[k] * fx[probe->particle[k]];
        out[1] += probe->weight[k] * fy[probe->particle[k]];
    }
}

static void stress(const struct probe *probe, const struct simulation *sim, double out[5])
{
    double mean[4] = {0};
    for (int k = 0; k < probe->n; k++) {
        double sigma[4], det;
        solid_cauchy(&sim->solid, &sim->particles[KIND_SOLID], probe->particle[k], sigma, &det);
        for (int c = 0; c < 4; c++) mean[c] += probe->weight[k] * sigma[c];
    }
    out[0] = mean[0], out[1] = mean[1], out[2] = mean[3], out[3] = mean[2];
    out[4] = solid_von_mises(mean);
}

static void strain(const struct probe *probe, const struct simulation *sim, double out[3])
{
    const struct particles *const particles = &sim->particles[KIND_SOLID];
    out[0] = out[1] = out[2] = 0;
    for (int k = 0; k < probe->n; k++) {
        const int32_t i = probe->particle[k];
        const double xx = particles->Uxx[i], xy = particles->Uxy[i], yx = particles->Uyx[i],
                     yy = particles->Uyy[i];
        out[0] += probe->weight[k] * (xx + 0.5 * (xx * xx + yx * yx));
        out[1] += probe->weight[k] * (yy + 0.5 * (xy * xy + yy * yy));
        out[2] += probe->weight[k] * 0.5 * (xy + yx + xx * xy + yx * yy);
    }
}

/* Adds the forces fx, fy on the particles of a body, and their moment about the probe's point. */
static void add_forces(const struct probe *probe, const struct particles *particles, int body,
                       const double *fx, const double *fy, double out[3])
{
    for (int64_t i = 0; i < particles->n; i++) {
        if (particles->body[i] != body) continue;
        out[0] += fx[i];
        out[1] += fy[i];
        out[2] += (particles->x[i] - probe->given->point[0]) * fy[i] -
                  (particles->y[i] - probe->given->point[1]) * fx[i];
    }
}

static void force(const struct probe *probe, const struct simulation *sim, double out[3])
{
    out[0] = out[1] = out[2] = 0;
    for (int k = 0; k < probe->n_bodies; k++) {
        const struct particles *const particles = &sim->particles[probe->bodies[k].kind];
        add_forces(probe, particles, probe->bodies[k].body, particles->fx, particles->fy, out);
    }
}

/* T-75: the particles of a body have equal masses. Pose and its rate. */
static void pose(const struct probe *probe, const struct simulation *sim, double out[3],
                 double rate[3])
{
    const struct particles *const particles = &sim->particles[KIND_SOLID];
    double X = 0, Y = 0, ux = 0, uy = 0, vx = 0, vy = 0, n = 0;
    double across = 0, along = 0, to_across = 0, to_along = 0;
    for (int64_t i = 0; i < particles->n; i++) {
        if (particles->body[i] != probe->body) continue;
        n++;
        X += particles->X[i];
        Y += particles->Y[i];
        ux += particles->ux[i];
        uy += particles->uy[i];
        vx += particles->vx[i];
        vy += particles->vy[i];
    }
    X /= n, Y /= n, ux /= n, uy /= n, vx /= n, vy /= n;
    for (int64_t i = 0; i < particles->n; i++) {
        if (particles->body[i] != probe->body) continue;
        const double a = particles->X[i] - X, b = particles->Y[i] - Y;
        const double x = a + (particles->ux[i] - ux), y = b + (particles->uy[i] - uy);
        across += a * y - b * x;
        along += a * x + b * y;
        to_across += a * (particles->vy[i] - vy) - b * (particles->vx[i] - vx);
        to_along += a * (particles->vx[i] - vx) + b * (particles->vy[i] - vy);
    }
    out[0] = X + ux;
    out[1] = Y + uy;
    out[2] = elementary_atan2(across, along);
    rate[0] = vx;
    rate[1] = vy;
    rate[2] = (along * to_across - across * to_along) / (square(across) + square(along));
}

/* The angle of a rigid body counts turns. */
static void rigid_pose(const struct probe *probe, const struct simulation *sim, double out[3],
                       double rate[3])
{
    const struct motion_state m =
        motion_at(sim->scene, scene_rigid_motion(sim->scene, probe->body), sim->state.time);
    for (int c = 0; c < 2; c++) {
        out[c] = m.centre[c] + m.d[c];
        rate[c] = m.v[c];
    }
    out[2] = m.angle;
    rate[2] = m.rate;
}

/* Force of hinge or guide on a rigid body in the last step, or of a spring at its end `to`. */
static void rigid_reaction(const struct probe *probe, const struct simulation *sim, double out[3])
{
    double at[2];
    if (probe->body >= 0) {
        const struct rigid_state *const s = &sim->rigid.state[probe->body];
        for (int c = 0; c < 2; c++) at[c] = sim->rigid.body[probe->body].centre[c] + s->x[c];
        memcpy(out, s->reaction, sizeof s->reaction);
    } else {
        if (beam_spring_force(&sim->beams, probe->spring, out))
            memcpy(at, sim->scene->spring[probe->spring].to, sizeof at);
        else
            rigid_spring_force(&sim->rigid, probe->spring, out, at);
        out[2] = 0;
    }
    out[2] += (at[0] - probe->given->point[0]) * out[1] - (at[1] - probe->given->point[1]) * out[0];
}

static void energy(const struct probe *probe, const struct simulation *sim, double out[3])
{
    const struct particles *const particles = &sim->particles[KIND_SOLID];
    double det, sum = 0;
    for (int64_t i = 0; i < particles->n; i++)
        if (particles->body[i] == probe->body)
            sum += square(particles->vx[i]) + square(particles->vy[i]);
    out[0] = 0.5 * sim->solid.body[probe->body].mass * sum;
    solid_energy(&sim->solid, particles, probe->body, &out[1], &out[2], &det);
}

/* Where a point of a wall is now. */
static void move_with_wall(const struct probe *probe, const struct simulation *sim, double at[2])
{
    if (probe->motion < 0) return;
    const struct motion_state m = motion_at(sim->scene, probe->motion, sim->state.time);
    memcpy(at, motion_of_point(&m, at[0], at[1]).x, 2 * sizeof *at);
}

/* Where a point of the fluid is now. */
static void present_point(const struct probe *probe, const struct simulation *sim, double at[2])
{
    memcpy(at, probe->given->point, sizeof probe->given->point);
    move_with_wall(probe, sim, at);
    if (probe->n > 0) {
        const struct particles *const particles = &sim->particles[KIND_SOLID];
        double u[2];
        weighted_sum(probe, particles->ux, particles->uy, u);
        at[0] += u[0];
        at[1] += u[1];
    }
}

static void surface_pressure(const struct probe *probe, const struct simulation *sim, double out[3])
{
    double from[2] = {probe->given->point[0], probe->given->point[1]},
           to[2] = {probe->given->to[0], probe->given->to[1]};
    move_with_wall(probe, sim, from);
    move_with_wall(probe, sim, to);
    fluid_pressure_on(sim, from, to, out);
}

/* Values of a beam, linear between its nodes. */
static void evaluate_beam(const struct probe *probe, const struct simulation *sim, double *row,
                          double *rate)
{
    const struct beams *const beams = &sim->beams;
    const int *const node = beams->element[probe->place.element].node;
    const struct beam_state *const a = &beams->state[node[0]], *const b = &beams->state[node[1]];
    const double part = probe->place.part;
    struct body_energy energy;
    switch ((enum probe_quantity)probe->given->quantity) {
    case PROBE_SECTION_FORCE: beam_section_force(beams, &probe->place, row); return;
    case PROBE_REACTION: beam_reaction(beams, probe->beam, probe->given->point, row); return;
    case PROBE_ENERGY:
        energy = beam_energy(beams, probe->beam);
        row[0] = energy.kinetic, row[1] = energy.elastic, row[2] = 0;
        return;
    default: break;
    }
    for (int c = 0; c < 2; c++) {
        const double v = a->v[c] + part * (b->v[c] - a->v[c]);
        row[c] = v;
        if (probe->given->quantity == PROBE_DISPLACEMENT) {
            row[c] = a->x[c] + part * (b->x[c] - a->x[c]);
            rate[c] = v;
        } else if (probe->given->quantity == PROBE_ACCELERATION) {
            row[c] = a->a[c] + part * (b->a[c] - a->a[c]);
        }
    }
}

/* Values, and their rates where these are known. */
static void evaluate(const struct probe *probe, struct simulation *sim, double *row, double *rate)
{
    struct particles *const solid = &sim->particles[KIND_SOLID];
    struct held_forces now;
    double at[2] = {0};
    if (probe->beam >= 0 && probe->target != TARGET_BODY) {
        evaluate_beam(probe, sim, row, rate);
        return;
    }
    if (probe->target == TARGET_FLUID_POINT) present_point(probe, sim, at);
    switch ((enum probe_quantity)probe->given->quantity) {
    case PROBE_DISPLACEMENT:
        weighted_sum(probe, solid->ux, solid->uy, row);
        weighted_sum(probe, solid->vx, solid->vy, rate);
        break;
    case PROBE_VELOCITY:
        if (probe->target == TARGET_SOLID_POINT) {
            weighted_sum(probe, solid->vx, solid->vy, row);
        } else {
            const struct sample here = fluid_sample(sim, at[0], at[1]);
            row[0] = here.vx, row[1] = here.vy;
        }
        break;
    case PROBE_ACCELERATION:
        now = solid_held_forces(&sim->solid, solid, sim->state.time);
        weighted_sum(probe, now.ax, now.ay, row);
        break;
    case PROBE_REACTION:
        if (probe->kind == KIND_WALL) {
            rigid_reaction(probe, sim, row);
            break;
        }
        now = solid_held_forces(&sim->solid, solid, sim->state.time);
        row[0] = row[1] = row[2] = 0;
        add_forces(probe, solid, probe->body, now.held_x, now.held_y, row);
        break;
    case PROBE_PRESSURE: *row = fluid_sample(sim, at[0], at[1]).pressure; break;
    case PROBE_STRESS: stress(probe, sim, row); break;
    case PROBE_LEVEL: *row = fluid_level(sim, at[0], at[1]); break;
    case PROBE_FORCE: force(probe, sim, row); break;
    case PROBE_FRONT: *row = fluid_front(sim, probe->given->direction); break;
    case PROBE_ENERGY: energy(probe, sim, row); break;
    case PROBE_FLUX: *row = fluid_flux(sim, probe->given->point, probe->given->to); break;
    case PROBE_STRAIN: strain(probe, sim, row); break;
    case PROBE_POSE: (probe->kind == KIND_WALL ? rigid_pose : pose)(probe, sim, row, rate); break;
    case PROBE_SURFACE_PRESSURE: surface_pressure(probe, sim, row); break;
    case PROBE_SECTION_FORCE: break;
    case PROBE_QUANTITIES: break;
    }
}

void probes_sample(const struct probes *probes, struct simulation *sim, int file, bool means,
                   double *row, double *rate)
{
    enum need need = NEED_NOTHING;
    for (int k = 0; k < probes->n; k++) {
        const enum need wanted = need_of(&probes->probe[k]);
        const bool read = probes->probe[k].file == file && (!means || probes->probe[k].mean);
        if (read && wanted > need) need = wanted;
    }
    refresh(sim, need);
    row[0] = sim->state.time;
    for (int k = 0; k < probes->n; k++) {
        const struct probe *const probe = &probes->probe[k];
        if (probe->file != file || (means && !probe->mean)) continue;
        evaluate(probe, sim, row + probe->column, rate + probe->column);
    }
}

void probes_values(const struct probes *probes, struct simulation *sim, int k, double *row)
{
    const struct probe *const probe = &probes->probe[k];
    const struct probe_mean *const m = probe->mean;
    if (m && m->row >= 0 && m->time == sim->state.time) {
        for (int c = 0; c < probe->columns; c++) row[c] = m->sum[c] / m->covered;
        return;
    }
    refresh(sim, need_of(probe));
    double rate[PROBE_MAX_COLUMNS];
    evaluate(probe, sim, row, rate);
}
