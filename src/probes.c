/* SPDX-License-Identifier: MIT */
#include "probes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Weights of a particle in the local frame of a probe. */
struct moment {
    double m00, m10, m01, m20, m11, m02;
};

/* Weight over the squared distance in units of the reach; 0 at the reach. Any positive weight
 * reproduces linear fields; this one is smooth. */
static double nearness(double q2) { return q2 < 1 ? square(square(1 - q2)) : 0; }

static enum err no_body(const struct scene_probe *sp, const struct scene *scene, struct diag *d)
{
    const char *one = scene->n_solid > 0 ? scene->solid[0].common.name : "";
    return diag_fail(d, ERR_INPUT, "line %d: probe %s: body = '%s' names no solid section%s%s%s",
                     sp->common.line, sp->common.name, sp->body, one[0] ? "; there is '" : "", one,
                     one[0] ? "'" : "");
}

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
        const double w = nearness(x * x + y * y);
        m.m00 += w, m.m10 += w * x, m.m01 += w * y;
        m.m20 += w * x * x, m.m11 += w * x * y, m.m02 += w * y * y;
    }
    return m;
}

/* Linear moving least squares (Lancaster and Salkauskas 1981): the value at the probe of the plane
 * fitted through the particles, sum w (a + b x + c y). A row of particles carries no plane: then the
 * weighted mean. */
static void weigh(struct probe *pr, const struct particles *p, double reach)
{
    const struct moment m = moments(pr, p, reach);
    const double c00 = m.m20 * m.m02 - m.m11 * m.m11;
    const double c10 = m.m11 * m.m01 - m.m10 * m.m02;
    const double c01 = m.m10 * m.m11 - m.m20 * m.m01;
    const double det = m.m00 * c00 + m.m10 * c10 + m.m01 * c01;
    const bool flat = !(det > 1e-9 * m.m00 * m.m00 * m.m00);
    for (int k = 0; k < pr->n; k++) {
        const double x = (p->X[pr->particle[k]] - pr->point[0]) / reach;
        const double y = (p->Y[pr->particle[k]] - pr->point[1]) / reach;
        const double w = nearness(x * x + y * y);
        pr->weight[k] = flat ? w / m.m00 : w * (c00 + c10 * x + c01 * y) / det;
    }
}

/* A corner of a body lies 0.71 dp off its last particle; a point further off than h is a mistake. */
static enum err attach(struct probe *pr, const struct scene_probe *sp, const struct simulation *s,
                       struct arena *a, struct diag *d)
{
    const int body = scene_find_solid(s->scene, sp->body);
    if (body < 0) return no_body(sp, s->scene, d);
    const struct particles *p = &s->kind[KIND_SOLID];
    const double h = s->scene->h, reach = 2 * h;
    const double distance = nearest_distance(p, body, pr->point);
    if (!(distance < h))
        return diag_fail(
            d, ERR_INPUT,
            "line %d: probe %s: point = %g, %g lies %.3g m off the nearest particle of "
            "solid '%s'; at most h = %.3g m is possible",
            sp->common.line, sp->common.name, pr->point[0], pr->point[1], distance, sp->body, h);
    pr->n = find_near(p, body, pr->point, reach, NULL);
    pr->particle = arena_alloc(a, (size_t)pr->n, sizeof *pr->particle, "probe", d);
    pr->weight = arena_alloc(a, (size_t)pr->n, sizeof *pr->weight, "probe", d);
    if (!pr->particle || !pr->weight) return ERR_MEMORY;
    find_near(p, body, pr->point, reach, pr->particle);
    weigh(pr, p, reach);
    return ERR_OK;
}

static int quantity_columns(int quantity) { return quantity == PROBE_PRESSURE ? 1 : 2; }

enum err probes_create(struct probes *p, const struct simulation *s, struct arena *a,
                       struct diag *d)
{
    const struct scene *scene = s->scene;
    p->n = scene->n_probe;
    p->columns = 1;
    p->pressure = false;
    p->probe = arena_alloc(a, (size_t)p->n, sizeof *p->probe, "probes", d);
    if (!p->probe) return ERR_MEMORY;
    for (int k = 0; k < p->n; k++) {
        struct probe *pr = &p->probe[k];
        pr->quantity = scene->probe[k].quantity;
        memcpy(pr->point, scene->probe[k].point, sizeof pr->point);
        p->columns += quantity_columns(pr->quantity);
        if (pr->quantity == PROBE_PRESSURE)
            p->pressure = true;
        else
            TRY(attach(pr, &scene->probe[k], s, a, d));
    }
    return ERR_OK;
}

const char *probes_header(const struct scene *scene, struct arena *a, struct diag *d)
{
    static const char *const endings[][2] = {
        [PROBE_DISPLACEMENT] = {"dx_m", "dy_m"},
        [PROBE_VELOCITY] = {"vx_m_per_s", "vy_m_per_s"},
        [PROBE_PRESSURE] = {"p_Pa", NULL},
    };
    const size_t room = 8 + (size_t)scene->n_probe * 2 * (SCENE_NAME + 16);
    char *const header = arena_alloc(a, room, 1, "header of probes.csv", d);
    if (!header) return NULL;
    size_t at = (size_t)snprintf(header, room, "time_s");
    for (int k = 0; k < scene->n_probe; k++)
        for (int c = 0; c < quantity_columns(scene->probe[k].quantity); c++)
            at += (size_t)snprintf(header + at, room - at, ",%s_%s", scene->probe[k].common.name,
                                   endings[scene->probe[k].quantity][c]);
    return header;
}

static void weighted_sum(const struct probe *pr, const double *fx, const double *fy, double out[2])
{
    out[0] = out[1] = 0;
    for (int k = 0; k < pr->n; k++) {
        out[0] += pr->weight[k] * fx[pr->particle[k]];
        out[1] += pr->weight[k] * fy[pr->particle[k]];
    }
}

void probes_sample(const struct probes *p, struct simulation *s, double *row)
{
    const struct particles *solid = &s->kind[KIND_SOLID];
    if (p->pressure) simulation_refresh(s);
    *row++ = s->state.time;
    for (int k = 0; k < p->n; k++) {
        const struct probe *pr = &p->probe[k];
        if (pr->quantity == PROBE_PRESSURE)
            row[0] = simulation_pressure_at(s, pr->point[0], pr->point[1]);
        else if (pr->quantity == PROBE_VELOCITY)
            weighted_sum(pr, solid->vx, solid->vy, row);
        else
            weighted_sum(pr, solid->ux, solid->uy, row);
        row += quantity_columns(pr->quantity);
    }
}
