/* SPDX-License-Identifier: MIT
 * Bodies that are probably a mistake: clamped all over, without a clamp, far too soft, light or
 * fast. */
#include "check/check.h"

/* --- what holds a body --- */

enum support { LOOSE, STANDS, HELD };

/* Whether a particle of a body has a wall, or a body that does not fall itself, next below it. */
static bool stands_on(const struct check *check, const char *support, int body)
{
    const struct points *const p = &check->points;
    const double *const gravity = check->scene->top.gravity;
    const double size = elementary_hypot(gravity[0], gravity[1]);
    if (size == 0) return false;
    const double down[2] = {gravity[0] / size, gravity[1] / size};
    for (int64_t k = 0; k < p->n; k++) {
        if (p->kind[k] != KIND_SOLID || p->section[k] != body) continue;
        const int64_t below = point_beside(check, k, down, 0.9, POINT_BODY);
        if (below < 0) continue;
        if (p->kind[below] == KIND_WALL) return true;
        if (p->section[below] != body && support[p->section[below]] != LOOSE) return true;
    }
    return false;
}

/* Whether a body has a hinge to another one, or to what is not a body (-1). */
static bool hinge_to(const struct scene *scene, int body, int other)
{
    const struct hinge_list *const hinges = &scene->solid[body].hinge;
    for (int k = 0; k < hinges->n; k++)
        if (scene_find(scene, SECTION_solid, hinges->item[k].other) == other) return true;
    return false;
}

/* A body without a clamp moves away, which is seldom intended in a case with gravity or a load,
 * unless it begins with a velocity. Clamps support bodies, and bonds those that are joined to them.
 * Others stand on walls and on bodies that do not fall. */
static enum err warn_of_loose_bodies(struct check *check)
{
    const struct scene *const scene = check->scene;
    const effect_set effects = effects_of_scene(scene);
    char *support;
    TRY(arena_array(&check->shapes.temp, &support, scene->n_solid, "check", check->diag));
    for (int k = 0; k < scene->n_solid; k++)
        support[k] = scene->solid[k].clamp.n || hinge_to(scene, k, -1) ? HELD : LOOSE;
    for (int round = 0; round < scene->n_solid; round++)
        for (int k = 0; k < scene->n_solid; k++) {
            if (support[k] == LOOSE && effects & FX_CONTACT && stands_on(check, support, k))
                support[k] = STANDS;
            const int joined = scene_find(scene, SECTION_solid, scene->solid[k].joined);
            for (int to = 0; to < scene->n_solid; to++)
                if (to == joined || hinge_to(scene, k, to))
                    support[k] = support[to] = support[k] > support[to] ? support[k] : support[to];
        }
    for (int k = 0; k < scene->n_solid; k++) {
        const struct scene_solid *const b = &scene->solid[k];
        const bool falls = b->gravity && effects & FX_GRAVITY;
        bool loaded = false, lost = false; /* `like` copies no regions */
        if (support[k] == HELD || b->joined[0]) continue;
        for (int m = 0; m < k; m++)
            lost |=
                strcmp(scene->solid[m].common.name, b->like) == 0 && scene->solid[m].clamp.n > 0;
        for (int m = 0; m < scene->n_load; m++)
            loaded |= scene_find(scene, SECTION_solid, scene->load[m].body) == k;
        const char *const why =
            lost               ? "`like` does not copy one, so it moves freely"
            : b->velocity.e[0] ? NULL
            : falls && support[k] == LOOSE
                ? "gravity acts on it, so it falls unless fluid carries it"
            : falls && scene->n_fluid > 0
                ? "it only stands on what is below it, so fluid may move it"
            : loaded && support[k] == LOOSE
                ? "a [load] acts on it, so it is driven away unless something stops it"
                : NULL;
        if (why)
            warn_section(check, &b->common,
                         "has no clamp, and %s; give it a `clamp` if it is fixed%s", why,
                         falls ? ", or gravity = off" : "");
    }
    return ERR_OK;
}

/* --- clamps --- */

static void warn_of_full_clamp(struct check *check, int body)
{
    const struct scene_points *const p = &check->scene->points[KIND_SOLID];
    long long all = 0, held = 0;
    for (int64_t k = 0; k < p->n; k++) {
        all += p->body[k] == body;
        held += p->body[k] == body && p->clamped[k];
    }
    if (held > 0 && held == all)
        warn_at(check->diag, check->scene, key_line(check->scene, SECTION_solid, body, "clamp"),
                "`clamp` holds all %lld particles of [solid %s], so it cannot deform; make the "
                "clamp smaller, or use a [wall], which is faster",
                all, check->scene->solid[body].common.name);
}

/* Whether a clamped particle of the body touches a particle of the wall. */
static bool is_clamped_to(const struct check *check, int body, int wall)
{
    const struct scene_points *const p = &check->scene->points[KIND_SOLID];
    for (int64_t k = 0; k < p->n; k++) {
        if (p->body[k] != body || !p->clamped[k]) continue;
        struct point_visit v =
            point_grid_visit(&check->points.grid, p->x[k], p->y[k], 1.5 * check->scene->top.dp);
        while (point_grid_next(&check->points.grid, &v))
            if (check->points.kind[v.k] == KIND_WALL && check->points.section[v.k] == wall)
                return true;
    }
    return false;
}

/* A tank that moves and the clamp of a body in it that does not, or not in the same way. */
static void warn_of_other_motions(struct check *check, int body)
{
    const struct scene_solid *const b = &check->scene->solid[body];
    for (int wall = 0; wall < check->scene->n_wall; wall++) {
        const struct scene_wall *const w = &check->scene->wall[wall];
        if (strcmp(b->clamp_motion, w->motion) == 0 || !is_clamped_to(check, body, wall)) continue;
        warn_at(check->diag, check->scene, b->common.line,
                "the clamp of [solid %s] %s%s but touches [wall %s], which %s%s, so the two will "
                "overlap or part; `%s = %s` moves both",
                b->common.name, b->clamp_motion[0] ? "has the motion " : "is at rest",
                b->clamp_motion, w->common.name, w->motion[0] ? "moves" : "is at rest",
                w->motion[0] && b->clamp_motion[0] ? " differently" : "",
                w->motion[0] ? "clamp_motion" : "motion",
                w->motion[0] ? w->motion : b->clamp_motion);
    }
}

/* --- material --- */

/* Mostly units are wrong: a density in g/cm^3, a modulus in MPa without its unit. */
static void warn_of_material(struct check *check, int body)
{
    enum { LIGHTEST_FOAM = 5 }; /* kg/m^3; polymer foams have 10 and more */
    const struct scene *const scene = check->scene;
    const struct scene_solid *const b = &scene->solid[body];
    if (b->density < LIGHTEST_FOAM)
        warn_section(
            check, &b->common,
            "has a density of %.4g kg/m^3, less than any foam, so it has hardly any inertia; "
            "rubber has about 1100 kg/m^3",
            b->density);
    /* The body is loaded by its own weight or by the water beside it. */
    double water = 0;
    for (int f = 0; f < scene->n_fluid; f++)
        water = max2(water, scene->rho0 * extent_along(scene, KIND_FLUID, f, scene->top.gravity));
    for (int axis = 0; axis < 2; axis++)
        if (scene_periodic(scene, axis) && scene->top.gravity[axis] != 0) water = 0;
    const double weight = extent_along(scene, KIND_SOLID, body, scene->top.gravity);
    const double own = b->gravity ? b->density * weight : 0, pressure = max2(own, water);
    if (pressure > 0.1 * b->young)
        warn_section(
            check, &b->common,
            "is too soft for %s of %.3g Pa, which is %.2g times its `young` = %.3g Pa: it may "
            "collapse and a guard stop the run; check the unit, such as MPa",
            own > water ? "its own weight" : "the pressure of the water", pressure,
            pressure / b->young, b->young);
    /* Where such a body meets another, no wave carries the load away. */
    const double speed = start_speed(scene, KIND_SOLID, body, &b->velocity);
    const double sound = sqrt(b->young / b->density);
    if (speed > sound)
        warn_at(check->diag, scene, key_line(scene, SECTION_solid, body, "velocity"),
                "[solid %s] begins with up to %.4g m/s, faster than waves in it, "
                "sqrt(young/density) = %.3g m/s: an impact crushes it and a guard stops the run; "
                "check the units of `velocity`, `young` and `density`",
                b->common.name, speed, sound);
}

/* Eq. 17 has no potential: its operator is not symmetric, and some modes grow at a rate that does
 * not depend on the step (tests/stability/test_step_bound.c). */
static void warn_of_flutter(const struct check *check, int body)
{
    const struct scene_solid *const b = &check->scene->solid[body];
    const bool quadratic = b->gradient == GRADIENT_QUADRATIC;
    if (b->hourglass_form == HOURGLASS_VARIATIONAL || !(b->hourglass > (quadratic ? 0 : 10)))
        return;
    warn_section(
        check, &b->common,
        "hourglass_form = printed with %s is unstable at any time step%s; use hourglass_form = "
        "variational%s",
        quadratic ? "gradient = quadratic" : "hourglass above 10",
        quadratic ? "" : " on some shapes", quadratic ? ", or gradient = linear" : "");
}

enum err warn_of_solids(struct check *check)
{
    const struct scene *const scene = check->scene;
    if (scene->n_solid == 0) return ERR_OK;
    if (!(effects_of_scene(scene) & FX_CONTACT) && scene->domain.periodic != PERIODIC_NONE)
        diag_warn(check->diag,
                  "contact is not computed in a domain with periodic sides, so solids may pass "
                  "through each other and through walls; periodic = none enables contact");
    TRY(warn_of_loose_bodies(check));
    for (int k = 0; k < scene->n_solid; k++) {
        warn_of_full_clamp(check, k);
        warn_of_other_motions(check, k);
        warn_of_material(check, k);
        warn_of_flutter(check, k);
    }
    return ERR_OK;
}
