/* SPDX-License-Identifier: MIT
 * Data that depend on all points: the effective domain, probes, initial values. */
#include "geometry/sampling.h"
#include "base/elementary.h"
#include "geometry/motion.h"

static struct box2 box_of(const struct scene *scene, int kind, int body)
{
    const struct scene_points *p = &scene->points[kind];
    struct box2 box = box2_empty();
    for (int64_t k = 0; k < p->n; k++)
        if (p->body[k] == body) box2_include(&box, p->x[k], p->y[k]);
    return box;
}

static void include_motion(const struct scene *scene, int wall, struct box2 *box)
{
    enum { TIMES = 257 };
    const int motion = scene_wall_motion(scene, wall);
    if (motion < 0) return;
    const struct box2 start = box_of(scene, KIND_WALL, wall);
    if (start.low[0] > start.high[0]) return;
    for (int k = 0; k < TIMES; k++) {
        const struct motion_state m =
            motion_at(scene, motion, scene->top.end_time * k / (TIMES - 1));
        for (int corner = 0; corner < 4; corner++) {
            double at[2];
            box2_corner(&start, corner, at);
            const struct motion_point moved = motion_of_point(&m, at[0], at[1]);
            box2_include(box, moved.x[0], moved.x[1]);
        }
    }
}

/* All initial positions and those of prescribed motion. Around them the kernel's reach, or the size
 * of all solids, rigid bodies and beams, which may swing that far; above them the scene's height
 * once more. */
static void default_domain(struct scene *scene)
{
    struct box2 all = box2_empty(), bodies = all;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const struct scene_points *p = &scene->points[kind];
        for (int64_t k = 0; k < p->n; k++) {
            box2_include(&all, p->x[k], p->y[k]);
            if (kind == KIND_SOLID ||
                (kind == KIND_WALL && p->body[k] >= scene_rigid_wall(scene, 0)))
                box2_include(&bodies, p->x[k], p->y[k]);
        }
    }
    for (int k = 0; k < scene->n_wall; k++) include_motion(scene, k, &all);
    double margin = 2 * scene->h + scene->top.dp;
    for (int c = 0; c < 2; c++) margin = max2(margin, bodies.high[c] - bodies.low[c]);
    for (int c = 0; c < 2; c++) {
        scene->domain_lower[c] = all.low[c] - margin;
        scene->domain_upper[c] = all.high[c] + margin + (c == 1 ? all.high[1] - all.low[1] : 0);
    }
}

/* The sides of a periodic domain coincide: a point on the upper one moves to the lower one. */
static bool in_domain(const struct scene *scene, int axis, double x)
{
    const double upper = scene->domain_upper[axis];
    return x >= scene->domain_lower[axis] && (scene_periodic(scene, axis) ? x < upper : x <= upper);
}

static enum err given_domain(struct scene *scene, struct diag *d)
{
    const int line = scene->domain.common.line;
    for (int c = 0; c < 2; c++) {
        scene->domain_lower[c] = scene->domain.lower[c];
        scene->domain_upper[c] = scene->domain.upper[c];
        if (!(scene->domain.lower[c] < scene->domain.upper[c]))
            return fail_at(d, scene, line,
                           "[domain] lower must lie below and left of upper; here %c is %g and "
                           "%g m",
                           "xy"[c], scene -> domain.lower[c], scene->domain.upper[c]);
    }
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const struct scene_points *p = &scene->points[kind];
        for (int64_t k = 0; k < p->n; k++) {
            if (in_domain(scene, 0, p->x[k]) && in_domain(scene, 1, p->y[k])) continue;
            return fail_at(d, scene, line,
                           "a %s particle at (%g, %g) m lies outside [domain]; enlarge "
                           "[domain] or change the shape",
                           kind_names[kind], p->x[k], p->y[k]);
        }
    }
    return ERR_OK;
}

/* --- periodic sides --- */

/* The lattice must continue through the side without a seam. */
static enum err check_period(const struct scene *scene, int axis, struct diag *d)
{
    const double period = scene->domain.upper[axis] - scene->domain.lower[axis];
    const double n = period / scene->top.dp;
    if (fabs(n - round(n)) <= 1e-6) return ERR_OK;
    return fail_at(d, scene, scene->domain.common.line,
                   "[domain] periodic: the period in %c, %.9g m, is %.6g times dp = %g m and "
                   "must be a whole number of them; %.9g m would fit",
                   "xy"[axis], period, n, scene -> top.dp, round(n) * scene->top.dp);
}

/* Bodies are bonded within the domain only: a body through a periodic side would be cut there. */
static enum err check_span(const struct scene *scene, int axis, int body, struct diag *d)
{
    const struct box2 box = box_of(scene, KIND_SOLID, body);
    const double period = scene->domain.upper[axis] - scene->domain.lower[axis];
    const double gap = period - (box.high[axis] - box.low[axis]);
    if (gap >= 2 * scene->h) return ERR_OK;
    return fail_at(d, scene, scene->domain.common.line,
                   "[domain] periodic: [solid %s] and its own image in %c are %.3g m apart, "
                   "and solids are not bonded through a periodic side: at least 2 h = %.3g m are "
                   "needed",
                   scene->solid[body].common.name, "xy"[axis], gap, 2 * scene -> h);
}

static enum err check_periodic(const struct scene *scene, struct diag *d)
{
    if (scene->domain.periodic == PERIODIC_NONE) return ERR_OK;
    const int line = scene->domain.common.line;
    if (scene->lattice.angle != 0)
        return fail_at(d, scene, line,
                       "[domain] periodic: numerics.lattice_angle = %g rad would leave a seam "
                       "at the sides; it must be 0",
                       scene->numerics.lattice_angle);
    for (int axis = 0; axis < 2; axis++) {
        if (!scene_periodic(scene, axis)) continue;
        if (scene->domain.lower[axis] >= scene->domain.upper[axis])
            return fail_at(d, scene, line, "[domain] periodic needs `lower` and `upper`");
        TRY(check_period(scene, axis, d));
        for (int k = 0; k < scene->n_solid; k++) TRY(check_span(scene, axis, k, d));
    }
    return ERR_OK;
}

/* --- probes --- */

/* Checks the point of a probe in or on a solid. */
static enum err check_body_probe(struct sampler *sampler, const struct scene_probe *probe, int body)
{
    const struct scene *scene = sampler->scene;
    const struct scene_points *p = &scene->points[KIND_SOLID];
    double nearest = HUGE_VAL;
    for (int64_t k = 0; k < p->n; k++)
        if (p->body[k] == body)
            nearest = min2(nearest,
                           elementary_hypot(p->x[k] - probe->point[0], p->y[k] - probe->point[1]));
    /* A corner of a body is sqrt(1/2) dp from its particle's centre. */
    const double dp = scene_solid_dp(scene, body), outside = nearest - sqrt(0.5) * dp;
    if (outside <= 0.5 * dp) return ERR_OK;
    return geometry_refuse(sampler, probe->common.line,
                           "[probe %s] point (%g, %g) lies about %.3g m outside of [solid %s]",
                           probe->common.name, probe->point[0], probe->point[1], outside,
                           scene->solid[body].common.name);
}

static enum err check_place(struct sampler *sampler, const struct scene_probe *probe,
                            const char *key, const double at[2])
{
    const struct scene *scene = sampler->scene;
    bool inside = true;
    for (int c = 0; c < 2; c++)
        inside &= at[c] >= scene->domain_lower[c] && at[c] <= scene->domain_upper[c];
    if (inside) return ERR_OK;
    return geometry_refuse(
        sampler, probe->common.line,
        "[probe %s] %s (%g, %g) lies outside of the domain, (%g, %g) to (%g, %g) m",
        probe->common.name, key, at[0], at[1], scene->domain_lower[0], scene->domain_lower[1],
        scene->domain_upper[0], scene->domain_upper[1]);
}

static enum err check_probes(struct sampler *sampler)
{
    const struct scene *scene = sampler->scene;
    for (int k = 0; k < scene->n_probe; k++) {
        const struct scene_probe *probe = &scene->probe[k];
        const enum probe_target target = scene_probe_target(probe);
        const bool line = probe->quantity == PROBE_SURFACE_PRESSURE;
        const int body = scene_find(scene, SECTION_solid,
                                    target == TARGET_SOLID_POINT ? probe->body : probe->on);
        if (body >= 0) TRY(check_body_probe(sampler, probe, body));
        if (target == TARGET_FLUID_POINT || line)
            TRY(check_place(sampler, probe, "point", probe->point));
        if (line) TRY(check_place(sampler, probe, "to", probe->to));
    }
    return ERR_OK;
}

/* --- initial values --- */

static enum err check_field(struct sampler *sampler, const struct scene_expr *field, int kind,
                            int body, const struct scene_section_common *common, const char *key)
{
    const struct scene_points *p = &sampler->scene->points[kind];
    for (int c = 0; c < 2 && field->e[c]; c++) {
        for (int64_t k = 0; k < p->n; k++) {
            if (p->body[k] != body || isfinite(expr_at(field->e[c], p->x[k], p->y[k]))) continue;
            return geometry_refuse(sampler, common->line,
                                   "[%s %s] %s is not finite at (%g, %g) m; change the expression",
                                   kind_names[kind], common->name, key, p->x[k], p->y[k]);
        }
    }
    return ERR_OK;
}

static enum err check_fields(struct sampler *sampler)
{
    const struct scene *scene = sampler->scene;
    for (int k = 0; k < scene->n_fluid; k++) {
        const struct scene_fluid *f = &scene->fluid[k];
        TRY(check_field(sampler, &f->velocity, KIND_FLUID, k, &f->common, "velocity"));
        TRY(check_field(sampler, &f->pressure, KIND_FLUID, k, &f->common, "pressure"));
    }
    for (int k = 0; k < scene->n_solid; k++)
        TRY(check_field(sampler, &scene->solid[k].velocity, KIND_SOLID, k, &scene->solid[k].common,
                        "velocity"));
    return ERR_OK;
}

enum err geometry_extent(struct sampler *sampler)
{
    struct scene *scene = sampler->scene;
    const struct scene_domain *dom = &scene->domain;
    TRY(check_periodic(scene, sampler->diag));
    if (dom->lower[0] == dom->upper[0] && dom->lower[1] == dom->upper[1])
        default_domain(scene);
    else
        TRY(given_domain(scene, sampler->diag));
    TRY(check_probes(sampler));
    return check_fields(sampler);
}
