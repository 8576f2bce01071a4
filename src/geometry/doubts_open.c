/* SPDX-License-Identifier: MIT
 * Open boundaries that can be simulated but are probably a mistake: given velocities that do not balance in a
 * full channel, lines that end inside the fluid. */
#include "geometry/near.h"
#include "geometry/sampling.h"

#include "case/case.h"

#include <math.h>

/* All points, by cell. */
struct index {
    const struct scene *scene;
    struct near_table table;
    int64_t n;
    double *x, *y;
    bool *own; /* fluid, but not of a buffer */
};

static enum err index_points(struct index *to, struct sampler *g)
{
    const struct scene *const s = g->scene;
    int64_t n = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++) n += s->points[kind].n;
    *to = (struct index){.scene = s};
    to->x = arena_alloc(&g->temp, (size_t)n, sizeof *to->x, "open boundaries", g->diag);
    to->y = arena_alloc(&g->temp, (size_t)n, sizeof *to->y, "open boundaries", g->diag);
    to->own = arena_alloc(&g->temp, (size_t)n, sizeof *to->own, "open boundaries", g->diag);
    if (!to->x || !to->y || !to->own) return ERR_MEMORY;
    TRY(near_create(&to->table, s->top.dp, n, to->x, to->y, &g->temp, g->diag));
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int64_t k = 0; k < s->points[kind].n; k++) {
            to->x[to->n] = s->points[kind].x[k];
            to->y[to->n] = s->points[kind].y[k];
            to->own[to->n] = kind == KIND_FLUID && s->points[kind].open[k] == 0;
            near_insert(&to->table, to->n++);
        }
    return ERR_OK;
}

/* Whether a point lies within a distance of at most dp, in this image of a periodic domain. */
static bool has_point(const struct index *of, double x, double y, double within, bool own)
{
    const int64_t i = near_cell(&of->table, x), j = near_cell(&of->table, y);
    for (int64_t n = 0; n < 9; n++)
        for (int32_t at = near_first(&of->table, i + n % 3 - 1, j + n / 3 - 1); at;
             at = of->table.next[at - 1])
            if (square(of->x[at - 1] - x) + square(of->y[at - 1] - y) < square(within) &&
                (of->own[at - 1] || !own))
                return true;
    return false;
}

static bool has_any(const struct index *of, const double at[2], double within, bool own)
{
    const struct scene *const s = of->scene;
    const int nx = scene_periodic(s, 0), ny = scene_periodic(s, 1);
    for (int i = -nx; i <= nx; i++)
        for (int j = -ny; j <= ny; j++)
            if (has_point(of, at[0] + i * (s->domain_upper[0] - s->domain_lower[0]),
                          at[1] + j * (s->domain_upper[1] - s->domain_lower[1]), within, own))
                return true;
    return false;
}

/* Whether fluid somewhere has nothing beside it. */
static bool has_free_surface(const struct index *of)
{
    const double dp = of->scene->top.dp;
    for (int64_t k = 0; k < of->n; k++)
        for (int side = 0; side < 4 && of->own[k]; side++) {
            const double step = side % 2 ? 1.2 * dp : -1.2 * dp;
            const double at[2] = {of->x[k] + (side < 2 ? step : 0),
                                  of->y[k] + (side < 2 ? 0 : step)};
            if (!has_any(of, at, dp, false)) return true;
        }
    return false;
}

/* Fluid in front of the line beyond its end, and neither wall nor buffer behind the line there. */
static void warn_of_end(const struct sampler *g, const struct index *of, const struct scene_open *o,
                        bool last)
{
    const double dp = g->scene->top.dp, along = last ? o->length + 0.5 * dp : -0.5 * dp;
    double front[2], behind[2];
    for (int c = 0; c < 2; c++) {
        const double at = o->from[c] + along * o->along[c];
        front[c] = at + 0.5 * dp * o->inward[c];
        behind[c] = at - 0.5 * dp * o->inward[c];
    }
    if (!has_any(of, front, 0.75 * dp, true) || has_any(of, behind, 0.8 * dp, false)) return;
    char place[LOCATION_TEXT];
    scene_location(g->scene, o->common->line, place);
    diag_warn(g->diag,
              "%s: [%s %s] ends inside the fluid at (%.4g, %.4g) m, and no wall holds the fluid "
              "beyond it: it flows past the line and is lost; add a [wall], or let the line end at "
              "a wall or at the surface",
              place, o->inflow ? "inflow" : "outflow", o->common->name,
              o->from[0] + (last ? o->length * o->along[0] : 0),
              o->from[1] + (last ? o->length * o->along[1] : 0));
}

enum { TIMES = 256 };

/* The volume that has entered by the first time at which it is more than a hundredth of `volume`, or 0. */
static double surplus(const struct scene *s, double volume, double *time)
{
    const double step = s->top.end_time / TIMES;
    double sum = 0;
    for (int n = 0; n < TIMES; n++) {
        *time = (n + 1) * step;
        for (int k = 0; k < scene_open_count(s); k++) {
            const struct scene_open o = scene_open_at(s, k);
            sum += step * scene_open_flow(&o, (n + 0.5) * step);
        }
        if (fabs(sum) > 0.01 * volume) return sum;
    }
    return 0;
}

/* Given velocities hold exactly, whatever the pressure. */
static void warn_of_balance(const struct sampler *g, const struct index *of)
{
    const struct scene *const s = g->scene;
    int64_t n = 0;
    for (int k = 0; k < scene_open_count(s); k++)
        if (scene_open_at(s, k).kind != OPEN_VELOCITY) return;
    for (int64_t k = 0; k < of->n; k++) n += of->own[k];
    double time;
    const double volume = (double)n * square(s->top.dp), more = surplus(s, volume, &time);
    if (more == 0 || has_free_surface(of)) return;
    const struct scene_open o = scene_open_at(s, scene_open_count(s) - 1);
    char place[LOCATION_TEXT];
    scene_location(s, o.common->line, place);
    diag_warn(
        g->diag,
        "%s: [%s %s]: the open boundaries give velocities only, which let %.3g m^2 more %s "
        "than %s by t = %.3g s, %.2g %% of the fluid. It has no free surface, so %s; give one "
        "of them a `pressure` instead of its velocity",
        place, o.inflow ? "inflow" : "outflow", o.common->name, fabs(more), more > 0 ? "in" : "out",
        more > 0 ? "out" : "in", time, 100 * fabs(more) / volume,
        more > 0 ? "its pressure rises until a guard stops the run" : "voids open in it");
}

enum err geometry_warn_of_open(struct sampler *g)
{
    const struct scene *const s = g->scene;
    struct index points;
    if (scene_open_count(s) == 0 || s->n_fluid == 0) return ERR_OK;
    TRY(index_points(&points, g));
    for (int k = 0; k < scene_open_count(s); k++) {
        const struct scene_open o = scene_open_at(s, k);
        for (int last = 0; last < 2; last++) warn_of_end(g, &points, &o, last);
    }
    warn_of_balance(g, &points);
    return ERR_OK;
}
