/* SPDX-License-Identifier: MIT
 * Open boundaries that can be simulated but are probably a mistake: given velocities that do not balance in a
 * full channel, lines that end inside the fluid. */
#include "geometry/point_index.h"

#include "case/case.h"

#include <math.h>

/* Fluid in front of the line beyond its end, and neither wall nor buffer behind the line there. */
static void warn_of_end(const struct sampler *g, const struct point_index *of,
                        const struct scene_open *o, bool last)
{
    const double dp = g->scene->top.dp, along = last ? o->length + 0.5 * dp : -0.5 * dp;
    double front[2], behind[2];
    for (int c = 0; c < 2; c++) {
        const double at = o->from[c] + along * o->along[c];
        front[c] = at + 0.5 * dp * o->inward[c];
        behind[c] = at - 0.5 * dp * o->inward[c];
    }
    if (point_index_at(of, front, 0.75 * dp, POINT_FLUID) < 0 ||
        point_index_at(of, behind, 0.8 * dp, POINT_ANY) >= 0)
        return;
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
static void warn_of_balance(const struct sampler *g, const struct point_index *of)
{
    const struct scene *const s = g->scene;
    int64_t n = 0;
    for (int k = 0; k < scene_open_count(s); k++)
        if (scene_open_at(s, k).kind != OPEN_VELOCITY) return;
    for (int64_t k = 0; k < of->n; k++) n += of->bit[k] == POINT_FLUID;
    double time;
    const double volume = (double)n * square(s->top.dp), more = surplus(s, volume, &time);
    if (more == 0 || !s->full) return;
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

/* The height up to which a buffer, or the fluid within 2 dp of the line, reaches. */
static double top_of(const struct point_index *of, const struct scene_open *o, int bit)
{
    const double dp = of->scene->top.dp;
    double top = -HUGE_VAL;
    for (int64_t k = 0; k < of->n; k++) {
        double in, along;
        if (of->bit[k] != bit) continue;
        scene_open_place(o, (const double[]){of->x[k], of->y[k]}, &in, &along);
        if (along < 0 || along > o->length || in < -o->depth || in > 2 * dp) continue;
        top = max2(top, of->y[k] + 0.5 * dp);
    }
    return top;
}

/* Without a level the buffer is filled over the whole line. */
static void warn_of_level(const struct sampler *g, const struct point_index *of,
                          const struct scene_open *o)
{
    const struct scene *const s = g->scene;
    const double buffer = top_of(of, o, POINT_BUFFER), fluid = top_of(of, o, POINT_FLUID);
    if (!(s->top.gravity[1] < 0) || !isnan(o->level) || !(buffer > fluid + 1.5 * s->top.dp)) return;
    char place[LOCATION_TEXT];
    scene_location(s, o->common->line, place);
    diag_warn(g->diag,
              "%s: the line of [%s %s] passes fluid up to y = %.4g m, but the surface of the fluid "
              "before it is at y = %.4g m. Above it fluid %s; `level = %.4g m` prevents this",
              place, o->inflow ? "inflow" : "outflow", o->common->name, buffer, fluid,
              o->inflow ? "falls in" : "waits", fluid);
}

enum err geometry_warn_of_open(struct sampler *g)
{
    const struct scene *const s = g->scene;
    struct point_index points;
    if (scene_open_count(s) == 0 || s->n_fluid == 0) return ERR_OK;
    TRY(point_index_create(&points, g));
    g->scene->full = !point_index_surface(&points);
    for (int k = 0; k < scene_open_count(s); k++) {
        const struct scene_open o = scene_open_at(s, k);
        for (int last = 0; last < 2; last++) warn_of_end(g, &points, &o, last);
        warn_of_level(g, &points, &o);
    }
    warn_of_balance(g, &points);
    return ERR_OK;
}
