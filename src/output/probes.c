/* SPDX-License-Identifier: MIT */
#include "output/probes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const endings[PROBE_QUANTITIES] = {
#define QUANTITY(NAME, name, target, columns, meaning) columns,
#include "case/quantities.def"
#undef QUANTITY
};

/* Moments of the weights about a probe. */
struct moment {
    double m00, m10, m01, m20, m11, m02;
};

/* Weight at a squared distance in units of the reach. Any positive weight reproduces linear fields; this one
 * is smooth and vanishes at the reach. */
static double weight_at(double q2) { return q2 < 1 ? square(square(1 - q2)) : 0; }

/* Particles of the body within `reach` of the probe; `particle` may be NULL to count only. */
static int find_near(const struct particles *p, int body, const double at[2], double reach,
                     int32_t *particle)
{
    int n = 0;
    for (int64_t i = 0; i < p->n; i++) {
        if (p->body[i] != body) continue;
        if (square(p->X[i] - at[0]) + square(p->Y[i] - at[1]) >= square(reach)) continue;
        if (particle) particle[n] = (int32_t)i;
        n++;
    }
    return n;
}

static double nearest_distance(const struct particles *p, int body, const double at[2])
{
    double best = (double)INFINITY;
    for (int64_t i = 0; i < p->n; i++)
        if (p->body[i] == body)
            best = min2(best, square(p->X[i] - at[0]) + square(p->Y[i] - at[1]));
    return sqrt(best);
}

static struct moment moments(const struct probe *pr, const struct particles *p, double reach)
{
    struct moment m = {0};
    for (int k = 0; k < pr->n; k++) {
        const double x = (p->X[pr->particle[k]] - pr->point[0]) / reach;
        const double y = (p->Y[pr->particle[k]] - pr->point[1]) / reach;
        const double w = weight_at(x * x + y * y);
        m.m00 += w, m.m10 += w * x, m.m01 += w * y;
        m.m20 += w * x * x, m.m11 += w * x * y, m.m02 += w * y * y;
    }
    return m;
}

/* Weights of linear moving least squares (Lancaster and Salkauskas 1981): the value at the probe of the plane
 * fitted to the particles. Particles on one line determine no plane: then the weighted mean. */
static void weigh(struct probe *pr, const struct particles *p, double reach)
{
    const struct moment m = moments(pr, p, reach);
    const double c00 = m.m20 * m.m02 - m.m11 * m.m11;
    const double c10 = m.m11 * m.m01 - m.m10 * m.m02;
    const double c01 = m.m10 * m.m11 - m.m20 * m.m01;
    const double det = m.m00 * c00 + m.m10 * c10 + m.m01 * c01;
    const bool collinear = !(det > 1e-9 * m.m00 * m.m00 * m.m00);
    for (int k = 0; k < pr->n; k++) {
        const double x = (p->X[pr->particle[k]] - pr->point[0]) / reach;
        const double y = (p->Y[pr->particle[k]] - pr->point[1]) / reach;
        const double w = weight_at(x * x + y * y);
        pr->weight[k] = collinear ? w / m.m00 : w * (c00 + c10 * x + c01 * y) / det;
    }
}

/* A corner of a body is 0.71 dp from its nearest particle; a point further than h is a mistake. */
static enum err attach(struct probe *pr, const struct scene_probe *sp, const struct simulation *s,
                       struct arena *a, struct diag *d)
{
    const int body = pr->body;
    const struct particles *p = &s->kind[KIND_SOLID];
    const double h = scene_solid_h(s->scene, body), reach = 2 * h;
    const double distance = nearest_distance(p, body, pr->point);
    if (!(distance < h))
        return diag_fail(
            d, ERR_INPUT,
            "line %d: [probe %s] point = %g, %g is %.3g m from the nearest particle of "
            "[solid %s]; at most h = %.3g m is possible",
            sp->common.line, sp->common.name, pr->point[0], pr->point[1], distance, sp->body, h);
    pr->n = find_near(p, body, pr->point, reach, NULL);
    pr->particle = arena_alloc(a, (size_t)pr->n, sizeof *pr->particle, "probe", d);
    pr->weight = arena_alloc(a, (size_t)pr->n, sizeof *pr->weight, "probe", d);
    if (!pr->particle || !pr->weight) return ERR_MEMORY;
    find_near(p, body, pr->point, reach, pr->particle);
    weigh(pr, p, reach);
    return ERR_OK;
}

static int quantity_columns(int quantity)
{
    int n = 1;
    for (const char *c = endings[quantity]; *c; c++) n += *c == ',';
    return n;
}

/* Whether a quantity depends on fields that only simulation_refresh updates. */
static bool needs_refresh(int quantity)
{
    return quantity == PROBE_STRESS || quantity == PROBE_FORCE || quantity == PROBE_ENERGY;
}

static enum err create_probe(struct probe *pr, const struct scene_probe *sp,
                             const struct simulation *s, struct arena *a, struct diag *d)
{
    *pr = (struct probe){.quantity = sp->quantity,
                         .target = scene_probe_target(sp),
                         .direction = sp->direction,
                         .columns = quantity_columns(sp->quantity)};
    memcpy(pr->point, sp->point, sizeof pr->point);
    memcpy(pr->to, sp->to, sizeof pr->to);
    pr->kind = KIND_SOLID;
    pr->body = scene_find_solid(s->scene, sp->body);
    if (pr->target == TARGET_BODY && pr->body < 0) {
        pr->kind = KIND_WALL;
        pr->body = scene_find_wall(s->scene, sp->body);
    }
    return pr->target == TARGET_SOLID_POINT ? attach(pr, sp, s, a, d) : ERR_OK;
}

/* --- files --- */

/* Appends ",<probe>_<ending>" for each column of a probe. */
static size_t name_columns(char *header, size_t size, size_t at, const char *name, int quantity)
{
    for (const char *ending = endings[quantity]; *ending;) {
        const int length = (int)strcspn(ending, ",");
        at += (size_t)snprintf(header + at, size - at, ",%s_%.*s", name, length, ending);
        ending += length + (ending[length] == ',');
    }
    return at;
}

/* Defines a file: of all probes without an interval of their own (only = -1), or of probe `only`. */
static enum err create_file(struct probes *p, const struct scene *scene, int only, struct arena *a,
                            struct diag *d)
{
    struct probe_file *const f = &p->file[p->n_files];
    const size_t size = 8 + (size_t)p->n * 5 * (SCENE_NAME + 24);
    char *const header = arena_alloc(a, size, 1, "header of probes.csv", d);
    if (!header) return ERR_MEMORY;
    size_t at = (size_t)snprintf(header, size, "time_s");
    *f = (struct probe_file){.header = header, .columns = 1};
    for (int k = 0; k < p->n; k++) {
        const struct scene_probe *const sp = &scene->probe[k];
        if (only >= 0 ? k != only : sp->interval > 0) continue;
        p->probe[k].file = p->n_files;
        at = name_columns(header, size, at, sp->common.name, sp->quantity);
        f->columns += p->probe[k].columns;
        f->refresh |= needs_refresh(sp->quantity);
        f->interval = sp->interval > 0 ? sp->interval : scene->output.probe_interval;
    }
    if (f->columns == 1) return ERR_OK;
    snprintf(f->name, sizeof f->name, only >= 0 ? "probes_%s.csv" : "probes.csv",
             only >= 0 ? scene->probe[only].common.name : "");
    p->n_files++;
    return ERR_OK;
}

enum err probes_create(struct probes *p, const struct simulation *s, struct arena *a,
                       struct diag *d)
{
    const struct scene *scene = s->scene;
    *p = (struct probes){.n = scene->n_probe};
    p->probe = arena_alloc(a, (size_t)p->n, sizeof *p->probe, "probes", d);
    p->file = arena_alloc(a, (size_t)p->n + 1, sizeof *p->file, "probes", d);
    if (!p->probe || !p->file) return ERR_MEMORY;
    for (int k = 0; k < p->n; k++) TRY(create_probe(&p->probe[k], &scene->probe[k], s, a, d));
    TRY(create_file(p, scene, -1, a, d));
    for (int k = 0; k < p->n; k++)
        if (scene->probe[k].interval > 0) TRY(create_file(p, scene, k, a, d));
    return ERR_OK;
}

/* --- values --- */

static void weighted_sum(const struct probe *pr, const double *fx, const double *fy, double out[2])
{
    out[0] = out[1] = 0;
    for (int k = 0; k < pr->n; k++) {
        out[0] += pr->weight[k] * fx[pr->particle[k]];
        out[1] += pr->weight[k] * fy[pr->particle[k]];
    }
}

static void stress(const struct probe *pr, const struct simulation *s, double out[5])
{
    double mean[4] = {0};
    for (int k = 0; k < pr->n; k++) {
        double sigma[4], det;
        solid_cauchy(&s->solid, &s->kind[KIND_SOLID], pr->particle[k], sigma, &det);
        for (int c = 0; c < 4; c++) mean[c] += pr->weight[k] * sigma[c];
    }
    out[0] = mean[0], out[1] = mean[1], out[2] = mean[3], out[3] = mean[2];
    out[4] = solid_von_mises(mean);
}

static void force(const struct probe *pr, const struct simulation *s, double out[3])
{
    const struct particles *const p = &s->kind[pr->kind];
    out[0] = out[1] = out[2] = 0;
    for (int64_t i = 0; i < p->n; i++) {
        if (p->body[i] != pr->body) continue;
        out[0] += p->fx[i];
        out[1] += p->fy[i];
        out[2] += (p->x[i] - pr->point[0]) * p->fy[i] - (p->y[i] - pr->point[1]) * p->fx[i];
    }
}

static void energy(const struct probe *pr, const struct simulation *s, double out[3])
{
    const struct particles *const p = &s->kind[KIND_SOLID];
    double det, sum = 0;
    for (int64_t i = 0; i < p->n; i++)
        if (p->body[i] == pr->body) sum += square(p->vx[i]) + square(p->vy[i]);
    out[0] = 0.5 * s->solid.body[pr->body].mass * sum;
    solid_energy(&s->solid, p, pr->body, &out[1], &out[2], &det);
}

static void fluid_velocity(const struct probe *pr, const struct simulation *s, double out[2])
{
    const struct sample at = simulation_sample(s, pr->point[0], pr->point[1]);
    out[0] = at.vx;
    out[1] = at.vy;
}

static void values(const struct probe *pr, const struct simulation *s, double *row)
{
    const struct particles *const solid = &s->kind[KIND_SOLID];
    switch ((enum probe_quantity)pr->quantity) {
    case PROBE_DISPLACEMENT: weighted_sum(pr, solid->ux, solid->uy, row); break;
    case PROBE_VELOCITY:
        if (pr->target == TARGET_SOLID_POINT)
            weighted_sum(pr, solid->vx, solid->vy, row);
        else
            fluid_velocity(pr, s, row);
        break;
    case PROBE_PRESSURE: *row = simulation_pressure_at(s, pr->point[0], pr->point[1]); break;
    case PROBE_STRESS: stress(pr, s, row); break;
    case PROBE_LEVEL: *row = simulation_level(s, pr->point[0], pr->point[1]); break;
    case PROBE_FORCE: force(pr, s, row); break;
    case PROBE_FRONT: *row = simulation_front(s, pr->direction); break;
    case PROBE_ENERGY: energy(pr, s, row); break;
    case PROBE_FLUX: *row = simulation_flux(s, pr->point, pr->to); break;
    case PROBE_QUANTITIES: break;
    }
}

void probes_sample(const struct probes *p, struct simulation *s, int file, double *row)
{
    if (p->file[file].refresh) simulation_refresh(s);
    *row++ = s->state.time;
    for (int k = 0; k < p->n; k++) {
        if (p->probe[k].file != file) continue;
        values(&p->probe[k], s, row);
        row += p->probe[k].columns;
    }
}

void probes_values(const struct probes *p, struct simulation *s, int probe, double *row)
{
    if (needs_refresh(p->probe[probe].quantity)) simulation_refresh(s);
    values(&p->probe[probe], s, row);
}
