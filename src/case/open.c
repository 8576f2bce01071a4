/* SPDX-License-Identifier: MIT
 * [inflow] and [outflow] sections: derived data and checks. */
#include "case/case.h"
#include "base/elementary.h"

int scene_open_count(const struct scene *scene) { return scene->n_inflow + scene->n_outflow; }

struct scene_open scene_open_at(const struct scene *scene, int k)
{
    const bool inflow = k < scene->n_inflow;
    const enum section_id id = inflow ? SECTION_inflow : SECTION_outflow;
    const int index = inflow ? k : k - scene->n_inflow;
    _Static_assert(sizeof(struct scene_outflow) == sizeof(struct scene_inflow), "the same keys");
    const struct scene_inflow *const from = section_at(scene, id, index);
    const double sense = from->side ? -1 : 1; /* of the fluid, to the left of the line */
    struct scene_open o = {
        .kind = from->speed.e[0] || from->velocity.e[0] ? OPEN_VELOCITY : OPEN_PRESSURE,
        .common = &from->common,
        .inflow = inflow,
        .from = {from->from[0], from->from[1]},
        .along = {from->to[0] - from->from[0], from->to[1] - from->from[1]},
        .level = from->level,
        .absorb = from->absorb,
        .speed = from->speed.e[0],
        .velocity = {from->velocity.e[0], from->velocity.e[1]},
        .pressure = from->pressure.e[0],
        .sense = inflow ? 1 : -1,
    };
    o.length = elementary_hypot(o.along[0], o.along[1]);
    /* Whole spacings: the kernel's reach; one particle that has left and is not yet part of the
     * buffer; one of the buffer that has entered and is not yet relabelled. */
    o.depth = whole_parts(2 * scene->numerics.h_over_dp + 1) * scene->top.dp;
    o.along[0] /= o.length;
    o.along[1] /= o.length;
    o.inward[0] = -sense * o.along[1];
    o.inward[1] = sense * o.along[0];
    return o;
}

void scene_open_velocity(const struct scene_open *o, const double x[2], double time, double v[2])
{
    const double along = o->speed ? o->sense * expr_at_time(o->speed, x[0], x[1], time) : 0;
    for (int c = 0; c < 2; c++)
        v[c] = o->speed ? along * o->inward[c] : expr_at_time(o->velocity[c], x[0], x[1], time);
}

enum { LINE_POINTS = 33, LINE_TIMES = 65 };

/* Point k of those along the line. */
static void line_point(const struct scene_open *o, int k, double x[2])
{
    const double part = (k + 0.5) / LINE_POINTS * o->length;
    for (int c = 0; c < 2; c++) x[c] = o->from[c] + part * o->along[c];
}

double scene_open_flow(const struct scene_open *o, double time)
{
    double sum = 0;
    for (int k = 0; k < LINE_POINTS; k++) {
        double x[2], v[2];
        line_point(o, k, x);
        scene_open_velocity(o, x, time, v);
        sum += v[0] * o->inward[0] + v[1] * o->inward[1];
    }
    return sum / LINE_POINTS * o->length;
}

/* --- checks --- */

static enum err check_given(struct reader *r, const struct scene_open *o)
{
    const int given = (o->speed != NULL) + (o->velocity[0] != NULL) + (o->pressure != NULL);
    const double *const g = r->scene->top.gravity;
    if (o->length == 0) return bad_section(r, "`from` and `to`, the ends of its line, must differ");
    if (given > 1)
        return bad_section(r, "has more than one of `speed`, `velocity` and `pressure`; keep one");
    if (given == 0 && isnan(o->level))
        return bad_section(r, "needs `speed`, `velocity`, `pressure` or `level`");
    if (o->pressure && !isnan(o->level))
        return bad_section(r, "has both `pressure` and `level`, but `level` already sets the "
                              "pressure; remove one of them");
    if (!isnan(o->level) && !(g[1] < 0 && g[0] == 0))
        return bad_section(
            r, "level = %g m needs gravity that points down, but gravity is %g, %g m/s^2", o->level,
            g[0], g[1]);
    if (o->kind == OPEN_VELOCITY && o->absorb > 0)
        return bad_section(r, "`absorb` needs `pressure` or `level` without a velocity; a given "
                              "velocity holds exactly, so leave `absorb` out");
    return ERR_OK;
}

struct scene_open_range scene_open_range(const struct scene *scene, const struct scene_open *o)
{
    struct scene_open_range range = {.forth = -HUGE_VAL, .back = -HUGE_VAL};
    for (int n = 0; n < LINE_TIMES; n++) {
        const double time = scene->top.end_time * n / (LINE_TIMES - 1);
        for (int k = 0; k < LINE_POINTS; k++) {
            double x[2], v[2] = {0, 0};
            line_point(o, k, x);
            if (o->kind == OPEN_VELOCITY) scene_open_velocity(o, x, time, v);
            if (o->pressure) v[0] = expr_at_time(o->pressure, x[0], x[1], time);
            const double along = o->sense * (v[0] * o->inward[0] + v[1] * o->inward[1]);
            range.forth = max2(range.forth, along);
            range.back = max2(range.back, -along);
            range.largest = max2(range.largest, elementary_hypot(v[0], v[1]));
            range.time = time;
            for (int c = 0; c < 2; c++) range.x[c] = x[c];
            range.infinite = !isfinite(v[0] + v[1]);
            if (range.infinite) return range;
        }
    }
    return range;
}

/* Finite on the whole line at all times; a velocity must pass fluid, in through an inflow once. */
static enum err check_profile(struct reader *r, const struct scene_open *o)
{
    const struct scene_open_range range = scene_open_range(r->scene, o);
    if (range.infinite)
        return bad_section(r, "%s is not finite at (%g, %g) m and t = %g s; change the expression",
                           o->pressure ? "pressure"
                           : o->speed  ? "speed"
                                       : "velocity",
                           range.x[0], range.x[1], range.time);
    if (o->kind == OPEN_PRESSURE) return ERR_OK;
    if (range.largest > 0 && max2(range.forth, range.back) < 1e-9 * range.largest)
        return bad_section(r,
                           "its velocity is along the line everywhere and at all times, so no "
                           "fluid passes; add a component along (%.3g, %.3g), or use `speed`",
                           o->inward[0], o->inward[1]);
    if (range.forth <= 0 && range.back > 0)
        return bad_section(r,
                           "its velocity points %s the fluid everywhere and at all times, by up to "
                           "%g m/s: change its sign or `side`, or call it [%s]",
                           o->inflow ? "out of" : "into", range.back,
                           o->inflow ? "outflow" : "inflow");
    return ERR_OK;
}

enum err case_check_open(struct reader *r, const void *section)
{
    const struct scene_section_common *const common = section;
    if (r->scene->n_fluid == 0) return ERR_OK;
    const bool inflow = common->section == SECTION_inflow;
    const struct scene_open o =
        scene_open_at(r->scene, common->index + (inflow ? 0 : r->scene->n_inflow));
    TRY(check_given(r, &o));
    return check_profile(r, &o);
}
