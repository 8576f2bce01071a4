/* SPDX-License-Identifier: MIT
 * [inflow] and [outflow] sections: derived data and checks. */
#include "case/case.h"
#include "base/elementary.h"

#include <math.h>

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
        .word = section_table[id].word,
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
    /* Whole spacings for the kernel's reach, a particle that has left and is not yet part of the
     * buffer, and one of the buffer that has entered and is not yet relabelled. */
    o.depth = ceil((2 * scene->numerics.h_over_dp + 1) * (1 - 1e-9)) * scene->top.dp;
    o.along[0] /= o.length;
    o.along[1] /= o.length;
    o.inward[0] = -sense * o.along[1];
    o.inward[1] = sense * o.along[0];
    return o;
}

void scene_open_velocity(const struct scene_open *o, const double x[2], double time, double v[2])
{
    const double along = o->speed ? o->sense * scene_expr_at_time(o->speed, x[0], x[1], time) : 0;
    for (int c = 0; c < 2; c++)
        v[c] =
            o->speed ? along * o->inward[c] : scene_expr_at_time(o->velocity[c], x[0], x[1], time);
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
    const enum section_id id = (enum section_id)o->common->section;
    if (!(o->length > 0) || !scene_given(r->scene, id, o->common->index, "from") ||
        !scene_given(r->scene, id, o->common->index, "to"))
        return bad_section(r, o->common, NULL,
                           "needs `from` and `to`, the two ends of the line through which the "
                           "fluid passes");
    if (given > 1)
        return bad_section(r, o->common, NULL,
                           "has more than one of `speed`, `velocity` and `pressure`; keep one");
    if (given == 0 && isnan(o->level))
        return bad_section(r, o->common, NULL, "needs `speed`, `velocity`, `pressure` or `level`");
    if (o->pressure && !isnan(o->level))
        return bad_section(r, o->common, NULL,
                           "has both `pressure` and `level`, but `level` already sets the "
                           "pressure; remove one of them");
    if (!isnan(o->level) && !(g[1] < 0 && g[0] == 0))
        return bad_section(r, o->common, NULL,
                           "level = %g m needs gravity that points down, but gravity is %g, %g "
                           "m/s^2",
                           o->level, g[0], g[1]);
    if (o->kind == OPEN_VELOCITY && o->absorb > 0)
        return bad_section(r, o->common, NULL,
                           "`absorb` needs `pressure` or `level` without a velocity; a given "
                           "velocity holds exactly, so leave `absorb` out");
    return ERR_OK;
}

/* Where the guards would warn of the flow itself (time/guards.c), the user is warned before the
 * run. `largest`: of the given speed, m/s, or pressure, Pa, which changes the density by P/(rho0
 * c0^2) in Eq. 2. */
static void warn_of_sound(struct reader *r, const struct scene_open *o, double largest)
{
    const double c0 = r->scene->c0, stiffness = r->scene->rho0 * c0 * c0;
    if (o->kind == OPEN_VELOCITY) r->scene->given_speed = max2(r->scene->given_speed, largest);
    if (o->kind == OPEN_VELOCITY && c0 > 0 && largest > SPEED_WARNING * c0)
        warn_at(r->diag, r->scene, o->common->line,
                "[%s %s] gives the fluid up to %.4g m/s, above %g of the speed of sound, %.4g "
                "m/s, so it is not weakly compressible and may become unstable; use sound_speed "
                "= %.3g or more",
                o->word, o->common->name, largest, SPEED_WARNING, c0, 10 * largest);
    if (o->kind == OPEN_PRESSURE && stiffness > 0 && largest > DENS_WARNING * stiffness)
        warn_at(r->diag, r->scene, o->common->line,
                "[%s %s] gives the fluid up to %.4g Pa, which changes its density by about %.2g "
                "%%; 1 %% is usual, and the run stops at 30 %%; use sound_speed = %.3g or more",
                o->word, o->common->name, largest, 100 * largest / stiffness,
                sqrt(largest / (0.01 * r->scene->rho0)));
}

/* Finite on the whole line at all times; a velocity must pass fluid, in through an inflow at some
 * time. */
static enum err check_profile(struct reader *r, const struct scene_open *o)
{
    double forth = -HUGE_VAL, back = -HUGE_VAL, largest = 0; /* along `sense`, against it, m/s */
    for (int n = 0; n < LINE_TIMES; n++) {
        const double time = r->scene->top.end_time * n / (LINE_TIMES - 1);
        for (int k = 0; k < LINE_POINTS; k++) {
            double x[2], v[2] = {0, 0};
            line_point(o, k, x);
            if (o->kind == OPEN_VELOCITY) scene_open_velocity(o, x, time, v);
            if (o->pressure) v[0] = scene_expr_at_time(o->pressure, x[0], x[1], time);
            if (!isfinite(v[0] + v[1]))
                return bad_section(
                    r, o->common, NULL,
                    "%s is not finite at (%g, %g) m and t = %g s; change the expression",
                    o->pressure ? "pressure"
                    : o->speed  ? "speed"
                                : "velocity",
                    x[0], x[1], time);
            const double along = o->sense * (v[0] * o->inward[0] + v[1] * o->inward[1]);
            forth = max2(forth, along);
            back = max2(back, -along);
            largest = max2(largest, elementary_hypot(v[0], v[1]));
        }
    }
    warn_of_sound(r, o, largest);
    if (o->kind == OPEN_PRESSURE) return ERR_OK;
    if (largest > 0 && max2(forth, back) < 1e-9 * largest)
        return bad_section(r, o->common, NULL,
                           "its velocity is along the line everywhere and at all times, so no "
                           "fluid passes; give it a part along (%.3g, %.3g), or use `speed`",
                           o->inward[0], o->inward[1]);
    if (forth <= 0 && back > 0)
        return bad_section(r, o->common, NULL,
                           "its velocity points %s the fluid everywhere and at all times, by up "
                           "to %g m/s: change its sign or `side`, or call it [%s]",
                           o->inflow ? "out of" : "into", back, o->inflow ? "outflow" : "inflow");
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
