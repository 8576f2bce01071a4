/* SPDX-License-Identifier: MIT
 * Starts that can be simulated but are probably a mistake: fluid a little beside the wall that is to hold it,
 * water without its own weight's pressure, motions near the speed of sound. */
#include "geometry/point_index.h"
#include "base/elementary.h"

#include "case/case.h"

#include <math.h>

/* --- fluid beside what is to hold it --- */

/* Whether a wall or body is two spacings from a particle in a direction, and nothing between. */
static bool faces_body(const struct point_index *of, int64_t k, const double toward[2],
                       int64_t *body)
{
    const double dp = of->scene->top.dp, x = of->x[k], y = of->y[k];
    const double next[2] = {x + dp * toward[0], y + dp * toward[1]};
    const double after[2] = {x + 2 * dp * toward[0], y + 2 * dp * toward[1]};
    if (point_index_at(of, next, 0.9 * dp, POINT_ANY) >= 0) return false;
    *body = point_index_at(of, after, 0.7 * dp, POINT_ANY);
    return *body >= 0 && of->bit[*body] == POINT_BODY;
}

/* What of a fluid faces a wall or body across a gap of one particle, not upwards. */
struct facing {
    int64_t n, first, body;
};

static struct facing find_facing(const struct point_index *of, int fluid)
{
    static const double sides[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    const double *const g = of->scene->top.gravity;
    struct facing f = {0};
    for (int64_t k = 0; k < of->n; k++) {
        if (of->bit[k] != POINT_FLUID || of->section[k] != fluid) continue;
        for (int side = 0; side < 4; side++) {
            int64_t body = -1;
            if (sides[side][0] * g[0] + sides[side][1] * g[1] < 0) continue;
            if (!faces_body(of, k, sides[side], &body)) continue;
            if (f.n++ == 0) f.first = k, f.body = body;
        }
    }
    return f;
}

static const struct scene_section_common *section_of(const struct point_index *of, int64_t k)
{
    const struct scene *const s = of->scene;
    return of->kind[k] == KIND_WALL ? &s->wall[of->section[k]].common
                                    : &s->solid[of->section[k]].common;
}

static void warn_of_gap(const struct sampler *g, const struct point_index *of, int fluid)
{
    enum { FEW = 3 }; /* particles at a corner or a curved face */
    const struct facing f = find_facing(of, fluid);
    char place[LOCATION_TEXT];
    if (f.n <= FEW) return;
    scene_location(g->scene, g->scene->fluid[fluid].common.line, place);
    diag_warn(
        g->diag,
        "%s: [fluid %s] begins one dp = %.3g m away from [%s %s] at (%.4g, %.4g) m and will run "
        "against it; let their shapes touch, or leave a gap of 2 dp or more",
        place, g->scene->fluid[fluid].common.name, g->scene->top.dp, kind_names[of->kind[f.body]],
        section_of(of, f.body)->name, of->x[f.first], of->y[f.first]);
}

/* --- the weight of the fluid --- */

/* Whether a fluid stands on something: a wall, a body, other fluid or a buffer. */
static bool stands(const struct point_index *of, int fluid, const double down[2])
{
    const double dp = of->scene->top.dp;
    for (int64_t k = 0; k < of->n; k++) {
        if (of->bit[k] != POINT_FLUID || of->section[k] != fluid) continue;
        const double at[2] = {of->x[k] + dp * down[0], of->y[k] + dp * down[1]};
        const int64_t below = point_index_at(of, at, 0.7 * dp, POINT_ANY);
        if (below >= 0 && (of->bit[below] != POINT_FLUID || of->section[below] != fluid))
            return true;
    }
    return false;
}

/* Extent of a fluid along gravity, m. */
static double depth_of(const struct point_index *of, int fluid, const double down[2])
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int64_t k = 0; k < of->n; k++) {
        if (of->bit[k] != POINT_FLUID || of->section[k] != fluid) continue;
        const double at = of->x[k] * down[0] + of->y[k] * down[1];
        low = min2(low, at);
        high = max2(high, at);
    }
    return high - low + of->scene->top.dp;
}

/* The size of gravity without its part along periodic directions, in which it drives a flow, and its
 * direction. */
static double borne_gravity(const struct scene *s, double down[2])
{
    double g[2];
    for (int c = 0; c < 2; c++) g[c] = scene_periodic(s, c) ? 0 : s->top.gravity[c];
    const double size = elementary_hypot(g[0], g[1]);
    for (int c = 0; c < 2; c++) down[c] = size > 0 ? g[c] / size : 0;
    return size;
}

static void warn_of_weight(const struct sampler *g, const struct point_index *of, int fluid)
{
    const struct scene *const s = g->scene;
    const struct scene_fluid *const f = &s->fluid[fluid];
    double down[2];
    const double size = borne_gravity(s, down);
    if (size == 0 || f->pressure.e[0]) return;
    const bool held = stands(of, fluid, down);
    const double pressure = f->density * size * depth_of(of, fluid, down);
    char place[LOCATION_TEXT];
    scene_location(s, f->common.line, place);
    if (!held && !isnan(f->surface) && s->top.gravity[1] < 0)
        diag_warn(g->diag,
                  "%s: [fluid %s] has a `surface`, but stands on nothing: it begins with up to "
                  "%.3g Pa at its lower end and will spout there; move it to the floor, or leave "
                  "out `surface`",
                  place, f->common.name, pressure);
    const bool at_rest = isnan(f->surface) && !f->velocity.e[0] && !(s->relax.tolerance > 0);
    if (held && at_rest && scene_open_count(s) == 0)
        diag_warn(
            g->diag,
            "%s: [fluid %s] begins without the pressure of its weight, so it collapses onto "
            "its floor and its pressure swings between 0 and twice its %.3g Pa; give it its %s",
            place, f->common.name, pressure,
            s->top.gravity[1] < 0 && s->top.gravity[0] == 0 ? "`surface`, or `pressure`"
                                                            : "`pressure`");
}

/* --- motions --- */

enum { TIMES = 256 };

/* The largest speed of the corners of a body's box with a motion. */
static double largest_speed(const struct scene *s, int motion, const double low[2],
                            const double high[2], double *time)
{
    double largest = 0;
    for (int n = 0; n <= TIMES; n++) {
        const double t = s->top.end_time * n / TIMES;
        const struct motion_state m = motion_at(s, motion, t);
        for (int corner = 0; corner < 4; corner++) {
            const struct motion_point p =
                motion_of_point(&m, corner & 1 ? low[0] : high[0], corner & 2 ? low[1] : high[1]);
            const double speed = elementary_hypot(p.v[0], p.v[1]);
            if (speed > largest) largest = speed, *time = t;
        }
    }
    return largest;
}

static void warn_of_motion(const struct sampler *g, enum kind kind, int section,
                           const struct scene_section_common *common, const char *name)
{
    const struct scene *const s = g->scene;
    const struct scene_points *const p = &s->points[kind];
    const int motion = *name ? scene_find_motion(s, name) : -1;
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, time = 0;
    if (motion < 0) return;
    for (int64_t k = 0; k < p->n; k++) {
        if (p->body[k] != section || (kind == KIND_SOLID && !p->clamped[k])) continue;
        low[0] = min2(low[0], p->x[k]), high[0] = max2(high[0], p->x[k]);
        low[1] = min2(low[1], p->y[k]), high[1] = max2(high[1], p->y[k]);
    }
    const double speed = low[0] <= high[0] ? largest_speed(s, motion, low, high, &time) : 0;
    g->scene->given_speed = max2(s->given_speed, speed);
    if (!(speed > SPEED_WARNING * s->c0)) return;
    char place[LOCATION_TEXT];
    scene_location(s, s->motion[motion].common.line, place);
    diag_warn(g->diag,
              "%s: [motion %s] moves [%s %s] at up to %.3g m/s at t = %.3g s, above %g of the "
              "fluid's speed of sound, %.3g m/s: fluid in its way is compressed, and a guard may "
              "stop the run; check the unit (angles are in radians), or use sound_speed = %.3g "
              "or more",
              place, s->motion[motion].common.name, kind_names[kind], common->name, speed, time,
              SPEED_WARNING, s->c0, 10 * speed);
}

enum err geometry_warn_of_start(struct sampler *g)
{
    const struct scene *const s = g->scene;
    struct point_index points;
    if (s->n_fluid == 0) return ERR_OK;
    TRY(point_index_create(&points, g));
    for (int k = 0; k < s->n_fluid; k++) {
        warn_of_gap(g, &points, k);
        warn_of_weight(g, &points, k);
    }
    for (int k = 0; k < s->n_wall; k++)
        warn_of_motion(g, KIND_WALL, k, &s->wall[k].common, s->wall[k].motion);
    for (int k = 0; k < s->n_solid; k++)
        warn_of_motion(g, KIND_SOLID, k, &s->solid[k].common, s->solid[k].clamp_motion);
    return ERR_OK;
}
