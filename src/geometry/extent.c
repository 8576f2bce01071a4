/* SPDX-License-Identifier: MIT
 * Data that depend on all points: the effective domain, probes, initial values. */
#include "geometry/sampling.h"
#include "base/elementary.h"

#include "case/case.h"

#include <math.h>

static void include(double low[2], double high[2], const double point[2])
{
    for (int c = 0; c < 2; c++) {
        low[c] = min2(low[c], point[c]);
        high[c] = max2(high[c], point[c]);
    }
}

/* The box of a kind's points, including the displacement of moving walls. */
static void include_points(const struct scene *s, int kind, double low[2], double high[2])
{
    const struct scene_points *p = &s->points[kind];
    for (int64_t k = 0; k < p->n; k++) include(low, high, (const double[]){p->x[k], p->y[k]});
}

static void include_motion(const struct scene *s, int wall, double low[2], double high[2])
{
    enum { TIMES = 257 };
    const int motion = scene_find_motion(s, s->wall[wall].motion);
    if (motion < 0) return;
    double at_low[2] = {HUGE_VAL, HUGE_VAL}, at_high[2] = {-HUGE_VAL, -HUGE_VAL};
    const struct scene_points *p = &s->points[KIND_WALL];
    for (int64_t k = 0; k < p->n; k++)
        if (p->body[k] == wall) include(at_low, at_high, (const double[]){p->x[k], p->y[k]});
    if (at_low[0] > at_high[0]) return;
    for (int k = 0; k < TIMES; k++) {
        const struct motion_state m = motion_at(s, motion, s->top.end_time * k / (TIMES - 1));
        for (int corner = 0; corner < 4; corner++) {
            const double x = corner & 1 ? at_high[0] : at_low[0];
            const double y = corner & 2 ? at_high[1] : at_low[1];
            include(low, high, motion_of_point(&m, x, y).x);
        }
    }
}

/* All initial positions and those of prescribed motion. Around them the kernel's reach, or the size
 * of the largest solid, which may swing that far; above them the scene's height once more. */
static void default_domain(struct scene *s)
{
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    double solid_low[2] = {HUGE_VAL, HUGE_VAL}, solid_high[2] = {-HUGE_VAL, -HUGE_VAL};
    for (int kind = 0; kind < KIND_COUNT; kind++) include_points(s, kind, low, high);
    include_points(s, KIND_SOLID, solid_low, solid_high);
    for (int k = 0; k < s->n_wall; k++) include_motion(s, k, low, high);
    double margin = 2 * s->h + s->top.dp;
    for (int c = 0; c < 2 && s->points[KIND_SOLID].n; c++)
        margin = max2(margin, solid_high[c] - solid_low[c]);
    const double height = high[1] - low[1];
    for (int c = 0; c < 2; c++) {
        s->domain_lower[c] = low[c] - margin;
        s->domain_upper[c] = high[c] + margin + (c == 1 ? height : 0);
    }
}

/* The two sides of a periodic domain coincide: a point on the upper one is moved to the lower
 * one. */
static bool in_domain(const struct scene *s, int axis, double x)
{
    const double upper = s->domain_upper[axis];
    return x >= s->domain_lower[axis] && (scene_periodic(s, axis) ? x < upper : x <= upper);
}

static enum err given_domain(struct scene *s, struct diag *d)
{
    char place[LOCATION_TEXT];
    scene_location(s, s->domain.common.line, place);
    for (int c = 0; c < 2; c++) {
        s->domain_lower[c] = s->domain.lower[c];
        s->domain_upper[c] = s->domain.upper[c];
        if (!(s->domain.lower[c] < s->domain.upper[c]))
            return diag_add(d, ERR_INPUT,
                            "%s: [domain] lower must lie below and left of upper; here "
                            "%c is %g and %g m",
                            place, "xy"[c], s -> domain.lower[c], s->domain.upper[c]);
    }
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const struct scene_points *p = &s->points[kind];
        for (int64_t k = 0; k < p->n; k++) {
            if (in_domain(s, 0, p->x[k]) && in_domain(s, 1, p->y[k])) continue;
            return diag_add(d, ERR_INPUT,
                            "%s: a %s particle at (%g, %g) m lies outside [domain]; enlarge "
                            "[domain] or change the shape",
                            place, kind_names[kind], p->x[k], p->y[k]);
        }
    }
    return ERR_OK;
}

/* --- periodic sides --- */

/* The lattice must continue through the side without a seam. */
static enum err check_period(const struct scene *s, int axis, const char *place, struct diag *d)
{
    const double period = s->domain.upper[axis] - s->domain.lower[axis];
    const double n = period / s->top.dp;
    if (fabs(n - round(n)) <= 1e-6) return ERR_OK;
    return diag_add(d, ERR_INPUT,
                    "%s: [domain] periodic: the period in %c, %.9g m, is %.6g times dp = %g m and "
                    "must be a whole number of them; %.9g m would fit",
                    place, "xy"[axis], period, n, s -> top.dp, round(n) * s->top.dp);
}

/* Bodies are bonded within the domain only: a body through a periodic side would be cut there. */
static enum err check_span(const struct scene *s, int axis, int body, const char *place,
                           struct diag *d)
{
    const struct scene_points *p = &s->points[KIND_SOLID];
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int64_t k = 0; k < p->n; k++) {
        if (p->body[k] != body) continue;
        low = min2(low, axis ? p->y[k] : p->x[k]);
        high = max2(high, axis ? p->y[k] : p->x[k]);
    }
    const double gap = s->domain.upper[axis] - s->domain.lower[axis] - (high - low);
    if (gap >= 2 * s->h) return ERR_OK;
    return diag_add(d, ERR_INPUT,
                    "%s: [domain] periodic: [solid %s] and its own image in %c are %.3g m apart, "
                    "and solids are not bonded through a periodic side: at least 2 h = %.3g m are "
                    "needed",
                    place, s->solid[body].common.name, "xy"[axis], gap, 2 * s -> h);
}

static enum err check_periodic(const struct scene *s, struct diag *d)
{
    if (s->domain.periodic == PERIODIC_NONE) return ERR_OK;
    char place[LOCATION_TEXT];
    scene_location(s, s->domain.common.line, place);
    if (s->lattice.angle != 0)
        return diag_add(d, ERR_INPUT,
                        "%s: [domain] periodic: numerics.lattice_angle = %g rad would leave a seam "
                        "at the sides; it must be 0",
                        place, s->numerics.lattice_angle);
    for (int axis = 0; axis < 2; axis++) {
        if (!scene_periodic(s, axis)) continue;
        if (s->domain.lower[axis] >= s->domain.upper[axis])
            return diag_add(d, ERR_INPUT, "%s: [domain] periodic needs `lower` and `upper`", place);
        TRY(check_period(s, axis, place, d));
        for (int k = 0; k < s->n_solid; k++) TRY(check_span(s, axis, k, place, d));
    }
    return ERR_OK;
}

/* --- probes --- */

static enum err check_body_probe(const struct sampler *g, const struct scene_probe *probe)
{
    const struct scene *s = g->scene;
    const struct scene_points *p = &s->points[KIND_SOLID];
    const int body = scene_find_solid(s, probe->body);
    double nearest = HUGE_VAL;
    for (int64_t k = 0; k < p->n; k++)
        if (p->body[k] == body)
            nearest = min2(nearest,
                           elementary_hypot(p->x[k] - probe->point[0], p->y[k] - probe->point[1]));
    /* A corner of a body is sqrt(1/2) dp from its particle's centre. */
    const double dp = scene_solid_dp(s, body), outside = nearest - sqrt(0.5) * dp;
    if (outside <= 0.5 * dp) return ERR_OK;
    char place[LOCATION_TEXT];
    scene_location(s, probe->common.line, place);
    return diag_add(g->diag, ERR_INPUT,
                    "%s: [probe %s] point (%g, %g) lies about %.3g m outside of "
                    "[solid %s]",
                    place, probe->common.name, probe->point[0], probe->point[1], outside,
                    probe->body);
}

static enum err check_place(const struct sampler *g, const struct scene_probe *probe,
                            const char *key, const double at[2])
{
    const struct scene *s = g->scene;
    bool inside = true;
    for (int c = 0; c < 2; c++)
        inside &= at[c] >= s->domain_lower[c] && at[c] <= s->domain_upper[c];
    if (inside) return ERR_OK;
    char place[LOCATION_TEXT];
    scene_location(s, probe->common.line, place);
    return diag_add(g->diag, ERR_INPUT,
                    "%s: [probe %s] %s (%g, %g) lies outside of the domain, "
                    "(%g, %g) to (%g, %g) m",
                    place, probe->common.name, key, at[0], at[1], s->domain_lower[0],
                    s->domain_lower[1], s->domain_upper[0], s->domain_upper[1]);
}

static enum err check_probes(struct sampler *g)
{
    const struct scene *s = g->scene;
    for (int k = 0; k < s->n_probe; k++) {
        const struct scene_probe *probe = &s->probe[k];
        const enum probe_target target = scene_probe_target(probe);
        const bool line = probe->quantity == PROBE_SURFACE_PRESSURE;
        if (target == TARGET_SOLID_POINT) TRY(geometry_go_on(g, check_body_probe(g, probe)));
        if (target == TARGET_FLUID_POINT || line)
            TRY(geometry_go_on(g, check_place(g, probe, "point", probe->point)));
        if (line) TRY(geometry_go_on(g, check_place(g, probe, "to", probe->to)));
    }
    return ERR_OK;
}

/* --- initial values --- */

static enum err check_field(const struct sampler *g, const struct scene_expr *field, int kind,
                            int body, const struct scene_section_common *common, const char *key)
{
    const struct scene_points *p = &g->scene->points[kind];
    for (int c = 0; c < 2 && field->e[c]; c++) {
        for (int64_t k = 0; k < p->n; k++) {
            if (p->body[k] != body || isfinite(scene_expr_at(field->e[c], p->x[k], p->y[k])))
                continue;
            char place[LOCATION_TEXT];
            scene_location(g->scene, common->line, place);
            return diag_add(g->diag, ERR_INPUT,
                            "%s: [%s %s] %s is not finite at (%g, %g) m; change the expression",
                            place, kind_names[kind], common->name, key, p->x[k], p->y[k]);
        }
    }
    return ERR_OK;
}

static enum err check_fields(struct sampler *g)
{
    const struct scene *s = g->scene;
    for (int k = 0; k < s->n_fluid; k++) {
        const struct scene_fluid *f = &s->fluid[k];
        TRY(geometry_go_on(g, check_field(g, &f->velocity, KIND_FLUID, k, &f->common, "velocity")));
        TRY(geometry_go_on(g, check_field(g, &f->pressure, KIND_FLUID, k, &f->common, "pressure")));
    }
    for (int k = 0; k < s->n_solid; k++)
        TRY(geometry_go_on(g, check_field(g, &s->solid[k].velocity, KIND_SOLID, k,
                                          &s->solid[k].common, "velocity")));
    return ERR_OK;
}

enum err geometry_extent(struct sampler *g)
{
    struct scene *s = g->scene;
    const struct scene_domain *dom = &s->domain;
    TRY(check_periodic(s, g->diag));
    if (dom->lower[0] == dom->upper[0] && dom->lower[1] == dom->upper[1])
        default_domain(s);
    else
        TRY(given_domain(s, g->diag));
    TRY(check_probes(g));
    return check_fields(g);
}
