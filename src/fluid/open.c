/* SPDX-License-Identifier: MIT */
#include "fluid/open.h"

#include "base/hash.h"
#include "expr/expr.h"
#include "fluid/across.h"
#include "fluid/eos.h"

#include <math.h>

/* Distance in spacings: fluid this far behind the line joins the buffer, a buffer particle this
 * far in front of it is relabelled without delay. Fluid that oscillates about the line by less
 * creates no copies. */
#define BAND 0.5

int64_t open_places(const struct scene *scene)
{
    double places = 1;
    int64_t n = scene->points[KIND_FLUID].n;
    for (int c = 0; c < 2; c++)
        places *= (scene->domain_upper[c] - scene->domain_lower[c]) / scene->top.dp;
    const double taken = (double)(n + scene->points[KIND_WALL].n);
    return n + n / 8 + (int64_t)min2(1e9, max2(0, places - taken));
}

/* Boundary n at each time, with expressions of its own. */
static enum err copy_boundary(struct open *o, int n, struct arena *a, struct diag *d)
{
    const struct scene_open *const b = &o->boundary[n];
    for (int m = 0; m < OPEN_TIMES; m++) {
        struct open_moment *const at = &o->at[n][m];
        *at = (struct open_moment){.boundary = *b};
        if (b->speed) TRY(expr_copy(&at->speed, b->speed, a, d));
        for (int c = 0; c < 2 && b->velocity[c]; c++)
            TRY(expr_copy(&at->velocity[c], b->velocity[c], a, d));
        at->boundary.speed = at->speed;
        for (int c = 0; c < 2; c++) at->boundary.velocity[c] = at->velocity[c];
    }
    return ERR_OK;
}

/* The times at which an evaluation takes the given velocities. Their rate is that over the time
 * in which sound crosses h. */
static void find_times(const struct fluid_constants *k, double time, double t[OPEN_TIMES])
{
    t[OPEN_BEFORE] = max2(0, time - 0.5 * k->h / k->c0);
    t[OPEN_AFTER] = t[OPEN_BEFORE] + k->h / k->c0;
    t[OPEN_NOW] = time;
}

/* Functions of time alone are then evaluated once a step instead of once a particle. */
static void fix_times(struct open *o, const struct fluid_constants *k, double time)
{
    double t[OPEN_TIMES];
    find_times(k, time, t);
    for (int n = 0; n < o->n; n++)
        for (int m = 0; m < OPEN_TIMES; m++) {
            const struct scene_open *const b = &o->boundary[n];
            struct open_moment *const at = &o->at[n][m];
            if (b->speed) expr_fix_time(at->speed, b->speed, t[m]);
            for (int c = 0; c < 2 && b->velocity[c]; c++)
                expr_fix_time(at->velocity[c], b->velocity[c], t[m]);
        }
}

enum err open_create(struct open *o, struct arena *a, const struct scene *scene, int64_t next_id,
                     struct diag *d)
{
    const size_t n = (size_t)scene_open_count(scene);
    int64_t members = 0;
    for (int64_t i = 0; i < scene->points[KIND_FLUID].n; i++)
        members += scene->points[KIND_FLUID].open[i] > 0;
    o->n = (int)n;
    o->next_id = next_id;
    o->capacity = 4 * members + 64;
    o->boundary = arena_alloc(a, n, sizeof *o->boundary, "open boundaries", d);
    o->at = arena_alloc(a, n, sizeof *o->at, "open boundaries", d);
    o->sum = arena_alloc(a, n, sizeof *o->sum, "open boundaries", d);
    o->count = arena_alloc(a, n, sizeof *o->count, "open boundaries", d);
    o->rate = arena_alloc(a, n, sizeof *o->rate, "open boundaries", d);
    const size_t capacity = (size_t)o->capacity;
    o->member = arena_alloc(a, capacity, sizeof *o->member, "open boundaries", d);
    o->mirror_p = arena_alloc(a, capacity, sizeof *o->mirror_p, "open boundaries", d);
    o->mirror_u = arena_alloc(a, capacity, sizeof *o->mirror_u, "open boundaries", d);
    o->mirror_v = arena_alloc(a, capacity, sizeof *o->mirror_v, "open boundaries", d);
    o->flow = arena_alloc(a, capacity, sizeof *o->flow, "open boundaries", d);
    if (!o->flow || !o->boundary || !o->at || !o->sum || !o->count || !o->rate || !o->member ||
        !o->mirror_p || !o->mirror_u || !o->mirror_v)
        return ERR_MEMORY;
    for (int k = 0; k < o->n; k++) {
        o->boundary[k] = scene_open_at(scene, k);
        TRY(copy_boundary(o, k, a, d));
        o->sum[k][OPEN_MEAN_FLOW] = (double)NAN;
    }
    return ERR_OK;
}

/* --- fields of the buffers --- */

/* Rate of the given velocity at a point of the line, over the time in which sound crosses h. */
static void given_acceleration(const struct open_moment at[OPEN_TIMES],
                               const struct fluid_constants *k, const double x[2], double time,
                               double a[2])
{
    double t[OPEN_TIMES], v[2];
    find_times(k, time, t);
    scene_open_velocity(&at[OPEN_BEFORE].boundary, x, t[OPEN_BEFORE], v);
    scene_open_velocity(&at[OPEN_AFTER].boundary, x, t[OPEN_AFTER], a);
    for (int c = 0; c < 2; c++) a[c] = (a[c] - v[c]) / (t[OPEN_AFTER] - t[OPEN_BEFORE]);
}

/* T-51: velocity of a buffer from the fluid around its particle's projection on the line.
 * Velocities that varied along the normal would compress the buffer, because it has none along the
 * line. Without fluid there the velocity does not change. */
static void mirror_velocity(struct open *o, int64_t m, const struct fluid_constants *k,
                            const struct particles *particles, const struct cells *cells,
                            const double on_line[2])
{
    const double *const n = o->boundary[particles->open[o->member[m]] - 1].inward;
    const struct across s = state_across(k, particles, cells, on_line);
    if (!(s.w > 0)) return;
    const double normal =
        linear_value(&s, s.u, s.ux, s.uy) * n[0] + linear_value(&s, s.v, s.vx, s.vy) * n[1];
    o->mirror_u[m] = normal * n[0];
    o->mirror_v[m] = normal * n[1];
}

/* A buffer particle's pressure from the fluid at its mirror image in the line (T-52), and with a
 * given pressure its velocity. With a given velocity: the pressure that T-10 gives a wall with that
 * velocity (T-50). Without fluid there its fields do not change. */
static void mirror_fields(struct open *o, int64_t m, const struct fluid_constants *k,
                          const struct particles *particles, const struct cells *cells, double time)
{
    const int32_t i = o->member[m];
    const struct scene_open *const b = &o->boundary[particles->open[i] - 1];
    const double x[2] = {particles->x[i], particles->y[i]};
    double in, along, on_line[2], mirror[2], a[2];
    scene_open_place(b, x, &in, &along);
    for (int axis = 0; axis < 2; axis++) {
        on_line[axis] = x[axis] - in * b->inward[axis];
        mirror[axis] = on_line[axis] + fabs(in) * b->inward[axis];
    }
    const struct across s = state_across(k, particles, cells, mirror);
    o->mirror_u[m] = particles->vx[i];
    o->mirror_v[m] = particles->vy[i];
    if (b->kind == OPEN_PRESSURE) {
        o->mirror_p[m] = s.w > 0 ? s.p_w / s.w : (double)NAN;
        mirror_velocity(o, m, k, particles, cells, on_line);
        return;
    }
    o->mirror_p[m] = eos_pressure(particles->dens[i], k->rho0, k->c0);
    if (!(s.w > 0)) return;
    given_acceleration(o->at[particles->open[i] - 1], k, on_line, time, a);
    const double from[2] = {x[0] - mirror[0], x[1] - mirror[1]};
    o->mirror_p[m] = (s.p_w + k->rho0 * ((k->gravity[0] - a[0]) * (s.mass_x + s.w * from[0]) +
                                         (k->gravity[1] - a[1]) * (s.mass_y + s.w * from[1]))) /
                     s.w;
}

/* The given pressure at a point of the line, Pa. */
static double given_pressure(const struct scene_open *b, const struct fluid_constants *k,
                             const double on_line[2], double time)
{
    if (b->pressure) return scene_expr_at_time(b->pressure, on_line[0], on_line[1], time);
    return max2(0, -k->rho0 * k->gravity[1] * (b->level - on_line[1]));
}

/* T-52: pressure of a buffer particle such that it is `given` on the line; no tension at the end of
 * the water. */
static double odd_pressure(const struct scene_open *b, double given, double mirrored)
{
    if (isnan(mirrored)) return given;
    const double odd = 2 * given - mirrored;
    return b->pressure ? odd : max2(0, odd);
}

/* Velocity out of the fluid a spacing in front of the line, at fixed points: particles that come
 * and go would add noise. */
static double flow_at(const struct scene_open *b, const struct fluid_constants *k,
                      const struct particles *particles, const struct cells *cells, double along)
{
    double x[2];
    for (int axis = 0; axis < 2; axis++)
        x[axis] = b->from[axis] + along * b->along[axis] + k->dp * b->inward[axis];
    const struct across s = state_across(k, particles, cells, x);
    if (!(s.w > 0)) return 0;
    return -linear_value(&s, s.u, s.ux, s.uy) * b->inward[0] -
           linear_value(&s, s.v, s.vx, s.vy) * b->inward[1];
}

/* The mean flow out of the fluid through each boundary that uses it. */
static void find_flow(struct open *o, const struct fluid_constants *k,
                      const struct particles *particles, const struct cells *cells)
{
    for (int n = 0; n < o->n; n++) {
        const struct scene_open *const b = &o->boundary[n];
        const int places = (int)max2(1, min2((double)o->capacity, round(b->length / k->dp)));
        double sum = 0;
        if (!(b->absorb > 0)) continue;
#pragma omp parallel for schedule(static)
        for (int i = 0; i < places; i++)
            o->flow[i] = flow_at(b, k, particles, cells, (i + 0.5) * b->length / places);
        for (int i = 0; i < places; i++) sum += o->flow[i];
        o->rate[n].flow = sum / places;
        if (isnan(o->sum[n][OPEN_MEAN_FLOW])) o->sum[n][OPEN_MEAN_FLOW] = o->rate[n].flow;
    }
}

/* Counts a particle that is created (sign 1) or removed (-1). */
static void count_particle(struct open *o, const struct fluid_constants *k,
                           const struct particles *particles, int64_t i, double sign)
{
    double *const sum = o->sum[particles->open[i] - 1];
    sum[OPEN_MOMENTUM_X] += sign * particle_mass(k, particles, i) * particles->vx[i];
    sum[OPEN_MOMENTUM_Y] += sign * particle_mass(k, particles, i) * particles->vy[i];
    sum[OPEN_ENERGY] += sign * particle_energy(k, k->gravity, particles, i);
}

static void set_particle(struct open *o, int64_t m, const struct fluid_constants *k,
                         struct particles *particles, double time)
{
    const int32_t i = o->member[m];
    const int number = particles->open[i] - 1;
    const struct scene_open *const b = &o->boundary[number];
    double v[2] = {o->mirror_u[m], o->mirror_v[m]}, pressure = o->mirror_p[m], in, along;
    scene_open_place(b, (const double[]){particles->x[i], particles->y[i]}, &in, &along);
    const double on_line[2] = {particles->x[i] - in * b->inward[0],
                               particles->y[i] - in * b->inward[1]};
    if (b->kind == OPEN_PRESSURE) {
        double given = given_pressure(b, k, on_line, time);
        if (b->absorb > 0) /* T-53 */
            given += k->rho0 * k->c0 * (o->rate[number].flow - o->sum[number][OPEN_MEAN_FLOW]);
        pressure = odd_pressure(b, given, pressure);
    } else {
        scene_open_velocity(&o->at[number][OPEN_NOW].boundary, on_line, time, v);
    }
    particles->vx[i] = v[0];
    particles->vy[i] = v[1];
    particles->dens[i] = eos_dens(pressure, k->rho0, k->c0);
    if (particles->dens_slow) particles->dens_slow[i] = particles->dens[i];
    if (particles->vx_half) {
        particles->vx_half[i] = v[0];
        particles->vy_half[i] = v[1];
    }
    if (particles->vx_old) {
        particles->vx_old[i] = v[0];
        particles->vy_old[i] = v[1];
    }
}

void open_set(struct open *o, const struct fluid_constants *k, struct particles *particles,
              const struct cells *cells, double time, bool counts)
{
    fix_times(o, k, time);
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++)
        particles->p[i] = eos_pressure(particles->dens[i], k->rho0, k->c0);
#pragma omp parallel for schedule(static)
    for (int64_t m = 0; m < o->n_members; m++) mirror_fields(o, m, k, particles, cells, time);
    find_flow(o, k, particles, cells);
    for (int64_t m = 0; m < o->n_members; m++) {
        const int32_t i = o->member[m];
        const double u = particles->vx[i], v = particles->vy[i],
                     energy = particle_energy(k, k->gravity, particles, i);
        set_particle(o, m, k, particles, time);
        if (!counts) continue;
        double *const sum = o->sum[particles->open[i] - 1];
        sum[OPEN_MOMENTUM_X] += particle_mass(k, particles, i) * (particles->vx[i] - u);
        sum[OPEN_MOMENTUM_Y] += particle_mass(k, particles, i) * (particles->vy[i] - v);
        sum[OPEN_ENERGY] += particle_energy(k, k->gravity, particles, i) - energy;
    }
}

void open_hold(struct open *o, const struct fluid_constants *k, struct particles *particles)
{
    for (int n = 0; n < o->n; n++) o->rate[n].force[0] = o->rate[n].force[1] = o->rate[n].power = 0;
    for (int64_t m = 0; m < o->n_members; m++) {
        const int32_t i = o->member[m];
        struct open_rate *const r = &o->rate[particles->open[i] - 1];
        r->force[0] -= particle_mass(k, particles, i) * particles->ax[i];
        r->force[1] -= particle_mass(k, particles, i) * particles->ay[i];
        r->power -= particle_mass(k, particles, i) *
                    (particles->ax[i] * particles->vx[i] + particles->ay[i] * particles->vy[i]);
        particles->ax[i] = particles->ay[i] = 0;
    }
}

void open_add_work(struct open *o, double dt)
{
    for (int k = 0; k < o->n; k++) {
        double *const sum = o->sum[k];
        sum[OPEN_MOMENTUM_X] += dt * o->rate[k].force[0];
        sum[OPEN_MOMENTUM_Y] += dt * o->rate[k].force[1];
        sum[OPEN_ENERGY] += dt * o->rate[k].power;
        if (!(o->boundary[k].absorb > 0)) continue;
        sum[OPEN_MEAN_FLOW] +=
            dt / (o->boundary[k].absorb + dt) * (o->rate[k].flow - sum[OPEN_MEAN_FLOW]);
    }
}

/* --- exchange --- */

bool open_due(const struct open *o, const struct particles *particles, double dp)
{
    bool due = false;
    for (int64_t m = 0; m < o->n_members; m++) {
        const int32_t i = o->member[m];
        double in, along;
        scene_open_place(&o->boundary[particles->open[i] - 1],
                         (const double[]){particles->x[i], particles->y[i]}, &in, &along);
        due |= in > BAND * dp;
    }
    return due;
}

/* Of the strips of a buffer: one spacing or nearly so. */
static double strip_width(const struct scene_open *b, double dp)
{
    return b->length / max2(1, round(b->length / dp));
}

/* From a place on the line to the middle of its strip; 0 but for rounding. */
static double aside_of(const struct scene_open *b, double along, double dp)
{
    const double width = strip_width(b, dp), aside = (floor(along / width) + 0.5) * width - along;
    return fabs(aside) > 1e-6 * dp ? aside : 0;
}

/* A copy of a particle that enters, in the middle of its strip, at `in` before the line. */
static enum err make_copy(struct open *o, const struct fluid_constants *k,
                          struct particles *particles, int64_t i, double in, struct diag *d)
{
    const int number = particles->open[i] - 1;
    const struct scene_open *const b = &o->boundary[number];
    if (particles->n == particles->capacity)
        return diag_fail(
            d, ERR_GUARD,
            "[%s %s] has brought in so much fluid that the limit of %lld particles is reached, "
            "because more fluid enters than leaves; a larger [domain] or an [outflow] may help",
            b->word, b->common->name, (long long)particles->capacity);
    const int64_t to = particles->n++;
    double place, along;
    particles_copy(particles, i, to);
    scene_open_place(b, (const double[]){particles->x[i], particles->y[i]}, &place, &along);
    const double aside = aside_of(b, along, k->dp);
    particles->id[to] = o->next_id++;
    particles->x[to] += (in - place) * b->inward[0] + aside * b->along[0];
    particles->y[to] += (in - place) * b->inward[1] + aside * b->along[1];
    o->count[number][OPEN_ENTERED]++;
    count_particle(o, k, particles, to, 1);
    return ERR_OK;
}

/* The strip of a buffer, one spacing wide along the normal, that a particle lies in, and its
 * distance from the line. Every place on the line belongs to one strip, so fluid that returns
 * adds none. */
static int strip_of(const struct scene_open *b, const struct particles *particles, int64_t i,
                    double dp, double *in)
{
    double along;
    scene_open_place(b, (const double[]){particles->x[i], particles->y[i]}, in, &along);
    return (int)floor(along / strip_width(b, dp));
}

/* Distance of the last particle in the strip of i from the line. Particles from `fresh` on are
 * new. */
static double last_of_strip(const struct open *o, const struct particles *particles, int64_t i,
                            int64_t fresh, double dp)
{
    const struct scene_open *const b = &o->boundary[particles->open[i] - 1];
    double last, in;
    const int own = strip_of(b, particles, i, dp, &last);
    for (int64_t m = 0; m < o->n_members + particles->n - fresh; m++) {
        const int64_t j = m < o->n_members ? o->member[m] : fresh + m - o->n_members;
        if (particles->open[j] == particles->open[i] && strip_of(b, particles, j, dp, &in) == own)
            last = min2(last, in);
    }
    return last;
}

/* T-54: fills the strip behind a particle that enters, but not above the level. Compressed
 * fluid has smaller distances: the inflow is its density times its velocity. */
static enum err fill_strip(struct open *o, const struct fluid_constants *k,
                           struct particles *particles, int64_t i, int64_t fresh, struct diag *d)
{
    const struct scene_open *const b = &o->boundary[particles->open[i] - 1];
    const double spacing = k->dp / (1 + particles->dens[i]);
    if (particles->y[i] > b->level) return ERR_OK; /* NAN: none */
    double in = last_of_strip(o, particles, i, fresh, k->dp) - spacing;
    for (; in >= -b->depth; in -= spacing) TRY(make_copy(o, k, particles, i, in, d));
    return ERR_OK;
}

/* Whether the buffer has no space for fluid that has come in: above its level, or close to a
 * buffer particle that moves inward. Two particles in one place would burst apart. */
static bool strip_is_full(const struct open *o, const struct particles *particles, int64_t i,
                          double dp)
{
    const struct scene_open *const b = &o->boundary[particles->open[i] - 1];
    double place, in;
    const int own = strip_of(b, particles, i, dp, &place);
    bool full = particles->y[i] > b->level; /* it runs off over the inflow; NAN: none */
    for (int64_t m = 0; m < o->n_members && !full; m++) {
        const int64_t j = o->member[m];
        full = particles->open[j] == particles->open[i] &&
               strip_of(b, particles, j, dp, &in) == own && fabs(in - place) < BAND * dp &&
               particles->vx[j] * b->inward[0] + particles->vy[j] * b->inward[1] > 0;
    }
    return full && b->kind == OPEN_VELOCITY;
}

/* The boundary whose buffer contains fluid at x, from 1; 0: none. */
static int32_t buffer_at(const struct open *o, const double x[2], double dp)
{
    for (int k = 0; k < o->n; k++) {
        const struct scene_open *const b = &o->boundary[k];
        double in, along;
        scene_open_place(b, x, &in, &along);
        if (in < -BAND * dp && in > -b->depth - dp && along > 0 && along < b->length) return k + 1;
    }
    return 0;
}

/* Whether a buffer particle is still in the buffer or in front of it. The sides of the buffer are
 * walls, which do not affect its motion. */
static bool stays(const struct open *o, const struct particles *particles, int64_t i, double dp)
{
    const struct scene_open *const b = &o->boundary[particles->open[i] - 1];
    double in, along;
    scene_open_place(b, (const double[]){particles->x[i], particles->y[i]}, &in, &along);
    return in >= -b->depth - dp && along > 0 && along < b->length;
}

/* Removes the particles that have left their buffers, and those that found no space in one. */
static void end_particles(struct open *o, const struct fluid_constants *k,
                          struct particles *particles)
{
    int64_t kept = 0;
    for (int64_t i = 0; i < particles->n; i++) {
        const bool found_no_room = particles->open[i] < 0;
        if (found_no_room) particles->open[i] = -particles->open[i];
        if (found_no_room || (particles->open[i] && !stays(o, particles, i, k->dp))) {
            o->count[particles->open[i] - 1][OPEN_LEFT]++;
            count_particle(o, k, particles, i, -1);
            continue;
        }
        if (kept < i) particles_copy(particles, i, kept);
        kept++;
    }
    particles->n = kept;
}

/* Marks fluid that is to be removed. The given velocity is then not all that passes the line. */
static void mark_returned(struct open *o, struct particles *particles, int64_t i, struct diag *d)
{
    const struct scene_open *const b = &o->boundary[particles->open[i] - 1];
    if (!o->warned)
        diag_warn(
            d,
            "[%s %s] fluid runs back over the line at (%.4g, %.4g) m and is removed: less "
            "flows in than is given; a higher `level`, a slower start or a further line may help",
            b->word, b->common->name, particles->x[i], particles->y[i]);
    o->warned = true;
    particles->open[i] = -particles->open[i];
}

enum err open_exchange(struct open *o, const struct fluid_constants *k, struct particles *particles,
                       struct diag *d)
{
    const int64_t n = particles->n; /* copies follow behind */
    enum err e = ERR_OK;
    for (int64_t i = 0; i < n && !e; i++) {
        const double x[2] = {particles->x[i], particles->y[i]};
        double in, along;
        if (particles->open[i] == 0) {
            particles->open[i] = buffer_at(o, x, k->dp);
            if (particles->open[i] && strip_is_full(o, particles, i, k->dp))
                mark_returned(o, particles, i, d);
            continue;
        }
        scene_open_place(&o->boundary[particles->open[i] - 1], x, &in, &along);
        if (in <= 0 || !stays(o, particles, i, k->dp)) continue;
        e = fill_strip(o, k, particles, i, n, d);
        particles->open[i] = 0;
    }
    end_particles(o, k, particles);
    return e;
}

enum err open_list(struct open *o, const struct particles *particles, struct diag *d)
{
    o->n_members = 0;
    for (int64_t i = 0; i < particles->n; i++) {
        if (particles->open[i] == 0) continue;
        if (particles->open[i] < 0 || particles->open[i] > o->n)
            return diag_fail(
                d, ERR_INPUT,
                "checkpoint: fluid particle %lld belongs to open boundary %d, but the case has "
                "only %d; restore the [inflow] and [outflow] sections of the checkpoint",
                (long long)particles->id[i], (int)particles->open[i], o->n);
        if (o->n_members == o->capacity)
            return diag_fail(d, ERR_GUARD,
                             "the buffers of the open boundaries contain four times as many "
                             "particles as at the start. Fluid collects in them; a finer dp or a "
                             "line further from the disturbance may help");
        o->member[o->n_members++] = (int32_t)i;
    }
    return ERR_OK;
}

double open_energy(const struct open *o)
{
    double sum = 0;
    for (int k = 0; k < o->n; k++) sum += o->sum[k][OPEN_ENERGY];
    return sum;
}

void open_forget(struct open *o)
{
    for (int k = 0; k < o->n; k++)
        o->sum[k][OPEN_MOMENTUM_X] = o->sum[k][OPEN_MOMENTUM_Y] = o->sum[k][OPEN_ENERGY] = 0;
}

uint64_t open_hash(const struct open *o, uint64_t h)
{
    h = hash_bytes(h, o->sum, (size_t)o->n * sizeof *o->sum);
    h = hash_bytes(h, o->count, (size_t)o->n * sizeof *o->count);
    return hash_bytes(h, &o->next_id, sizeof o->next_id);
}
