/* SPDX-License-Identifier: MIT
 * Bodies that can be simulated but are probably a mistake: clamped all over, without a clamp, far too
 * soft or light. Each gets a warning with the consequence and the remedy. */
#include "geometry/point_index.h"
#include "base/elementary.h"

#include "case/case.h"
#include "case/effects.h"

#include <math.h>
#include <string.h>

/* Contact that a scene may need and that is not simulated. */
static void warn_of_contact(struct sampler *g)
{
    const struct scene *const s = g->scene;
    if (effects_of_scene(s) & FX_CONTACT || s->domain.periodic == PERIODIC_NONE || s->n_solid == 0)
        return;
    diag_warn(g->diag,
              "contact is not computed in a domain with periodic sides, so solids may pass through "
              "each other and through walls; periodic = none enables contact");
}

/* What keeps a body from falling. */
enum hold { LOOSE, STANDS, HELD };

/* Whether a particle of a body has a wall, or a body that does not fall itself, next below it. */
static bool stands(const struct point_index *of, const char *hold, int body)
{
    const struct scene *const s = of->scene;
    const double dp = s->top.dp, g = elementary_hypot(s->top.gravity[0], s->top.gravity[1]);
    for (int64_t k = 0; k < of->n && g > 0; k++) {
        if (of->kind[k] != KIND_SOLID || of->section[k] != body) continue;
        const double at[2] = {of->x[k] + dp * s->top.gravity[0] / g,
                              of->y[k] + dp * s->top.gravity[1] / g};
        const int64_t below = point_index_at(of, at, 0.9 * dp, POINT_BODY);
        if (below < 0) continue;
        if (of->kind[below] == KIND_WALL) return true;
        if (of->section[below] != body && hold[of->section[below]] != LOOSE) return true;
    }
    return false;
}

/* Clamps hold bodies, and bonds those that are joined to them. Others stand on walls and on bodies that do
 * not fall. */
static void find_holds(const struct point_index *of, char *hold)
{
    const struct scene *const s = of->scene;
    const bool meets = effects_of_scene(s) & FX_CONTACT;
    for (int k = 0; k < s->n_solid; k++) hold[k] = s->solid[k].clamp.n ? HELD : LOOSE;
    for (int round = 0; round < s->n_solid; round++)
        for (int k = 0; k < s->n_solid; k++) {
            if (hold[k] == LOOSE && meets && stands(of, hold, k)) hold[k] = STANDS;
            if (!s->solid[k].joined[0]) continue;
            const int to = scene_find_solid(s, s->solid[k].joined);
            hold[k] = hold[to] = hold[k] > hold[to] ? hold[k] : hold[to];
        }
}

static void warn_of_loose(const struct sampler *g, int body, enum hold hold)
{
    const struct scene *const s = g->scene;
    const struct scene_solid *const b = &s->solid[body];
    const bool falls = b->gravity && effects_of_scene(s) & FX_GRAVITY;
    bool loaded = false;
    char place[LOCATION_TEXT];
    for (int m = 0; m < s->n_load; m++) loaded |= scene_find_solid(s, s->load[m].body) == body;
    scene_location(s, b->common.line, place);
    if (falls && hold == LOOSE)
        diag_warn(g->diag,
                  "%s: [solid %s] has no clamp, and gravity acts on it, so it falls unless fluid "
                  "carries it; give it a `clamp`, or gravity = off",
                  place, b->common.name);
    else if (falls && s->n_fluid > 0)
        diag_warn(g->diag,
                  "%s: [solid %s] has no clamp and only stands on what is below it, so fluid may "
                  "move it; give it a `clamp` if it is fixed",
                  place, b->common.name);
    else if (loaded && hold == LOOSE)
        diag_warn(
            g->diag,
            "%s: [solid %s] has no clamp, and a [load] acts on it, so it is driven away unless "
            "something stops it; give it a `clamp`",
            place, b->common.name);
}

/* A body without a clamp moves away, which is seldom intended in a case with gravity or a load, unless it
 * begins with a velocity. */
static enum err warn_of_loose_bodies(struct sampler *g)
{
    const struct scene *const s = g->scene;
    struct point_index points;
    char *const hold = arena_alloc(&g->temp, (size_t)s->n_solid, sizeof *hold, "points", g->diag);
    if (!hold) return ERR_MEMORY;
    TRY(point_index_create(&points, g));
    find_holds(&points, hold);
    for (int k = 0; k < s->n_solid; k++)
        if (hold[k] != HELD && !s->solid[k].joined[0] && !s->solid[k].velocity.e[0])
            warn_of_loose(g, k, hold[k]);
    return ERR_OK;
}

/* Extent along gravity of a section's particles, times the size of gravity: the pressure of its weight over
 * its density. */
static double weight_of(const struct scene *s, enum kind kind, int body)
{
    const struct scene_points *const p = &s->points[kind];
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int64_t k = 0; k < p->n; k++) {
        if (p->body[k] != body) continue;
        const double at = s->top.gravity[0] * p->x[k] + s->top.gravity[1] * p->y[k];
        low = min2(low, at);
        high = max2(high, at);
    }
    return max2(0, high - low);
}

/* Probable errors of units: a density in g/cm^3, a modulus in MPa without its unit. */
static void warn_of_light_bodies(struct sampler *g)
{
    const struct scene *const s = g->scene;
    enum { LIGHTEST_FOAM = 5 }; /* kg/m^3; polymer foams have 10 and more */
    for (int k = 0; k < s->n_solid; k++)
        if (s->solid[k].density < LIGHTEST_FOAM) {
            char place[LOCATION_TEXT];
            scene_location(s, s->solid[k].common.line, place);
            diag_warn(g->diag,
                      "%s: [solid %s] has a density of %.4g kg/m^3, less than any foam, so it has "
                      "hardly any inertia; rubber has about 1100 kg/m^3",
                      place, s->solid[k].common.name, s->solid[k].density);
        }
}

/* By L-1 the moment on a body that turns and sticks is too large by 2 mu A times its rate of turning. At low
 * Reynolds numbers it turns twice as fast in a shear as it should. */
static void warn_of_turning_bodies(struct sampler *g)
{
    const struct scene *const s = g->scene;
    double nu = 0;
    for (int k = 0; k < s->n_fluid; k++) nu = max2(nu, s->fluid[k].laminar_viscosity);
    for (int k = 0; k < s->n_solid && nu > 0; k++) {
        if (s->solid[k].slip != SLIP_NONE || s->solid[k].clamp.n > 0) continue;
        char place[LOCATION_TEXT];
        scene_location(s, s->solid[k].common.line, place);
        diag_warn(g->diag,
                  "%s: [solid %s] is free to turn and has slip = none: the viscous moment on it is "
                  "too large by 2 mu A times its rate of turning (mu = %.3g Pa s, A: its area). At "
                  "low Reynolds numbers it turns too fast, by up to two times; forces are right",
                  place, s->solid[k].common.name, nu * s->rho0);
    }
}

/* A body that its own weight or the water beside it compresses by more than a tenth of its modulus. */
static void warn_of_soft_bodies(struct sampler *g)
{
    const struct scene *const s = g->scene;
    double water = 0;
    for (int f = 0; f < s->n_fluid; f++) water = max2(water, s->rho0 * weight_of(s, KIND_FLUID, f));
    for (int c = 0; c < 2; c++)
        if (scene_periodic(s, c) && s->top.gravity[c] != 0) water = 0;
    for (int k = 0; k < s->n_solid; k++) {
        const struct scene_solid *const b = &s->solid[k];
        const double own = b->gravity ? b->density * weight_of(s, KIND_SOLID, k) : 0;
        const double pressure = max2(own, water);
        if (!(pressure > 0.1 * b->young)) continue;
        char place[LOCATION_TEXT];
        scene_location(s, b->common.line, place);
        diag_warn(g->diag,
                  "%s: [solid %s] is too soft for %s of %.3g Pa, which is %.2g times its `young` = "
                  "%.3g Pa: it may collapse and a guard stop the run; check the unit, such as MPa",
                  place, b->common.name,
                  own > water ? "its own weight" : "the pressure of the water", pressure,
                  pressure / b->young, b->young);
    }
}

/* Fewer rows than a body needs across (geometry/check.c). */
enum { RESOLVED_ROWS = 4 };

/* The clamped particles of all bodies, by cell. */
static enum err find_clamped(struct point_grid *t, struct sampler *g)
{
    const struct scene *const s = g->scene;
    const struct scene_points *const p = &s->points[KIND_SOLID];
    TRY(point_grid_create(t, (RESOLVED_ROWS + 0.5) * s->top.dp, p->n, p->x, p->y, &g->temp,
                          g->diag));
    for (int64_t k = 0; k < p->n; k++)
        if (p->clamped[k]) point_grid_insert(t, k);
    return ERR_OK;
}

/* Whether a free particle lies within so many rows of a clamped one of its body. */
static bool near_clamp(const struct point_grid *t, const struct scene_points *p, int64_t free,
                       int rows, double dp)
{
    struct point_visit v = point_grid_visit(t, p->x[free], p->y[free], (rows + 0.5) * dp);
    while (point_grid_next(t, &v))
        if (p->body[v.k] == p->body[free]) return true;
    return false;
}

/* How many rows of particles beside its clamps a body has free; RESOLVED_ROWS: these or more. */
static int free_rows(const struct scene *s, const struct point_grid *clamped, int body)
{
    const struct scene_points *const p = &s->points[KIND_SOLID];
    const double dp = scene_solid_dp(s, body);
    int rows = 0;
    for (int64_t k = 0; k < p->n && rows < RESOLVED_ROWS; k++)
        while (p->body[k] == body && !p->clamped[k] && rows < RESOLVED_ROWS &&
               !near_clamp(clamped, p, k, rows, dp))
            rows++;
    return rows;
}

static void warn_of_few_rows(struct sampler *g, int body, int rows, int64_t free, int64_t all)
{
    const struct scene *const s = g->scene;
    char place[LOCATION_TEXT];
    scene_location(s, scene_line(s, SECTION_solid, body, "clamp"), place);
    if (rows == 1)
        diag_warn(g->diag,
                  "%s: `clamp` leaves only %lld of %lld particles of [solid %s] free, all of them "
                  "beside clamped ones: they move, but the body can neither bend nor stretch as "
                  "drawn; make the clamp smaller, or use a finer dp",
                  place, (long long)free, (long long)all, s->solid[body].common.name);
    else
        diag_warn(g->diag,
                  "%s: `clamp` leaves only %d rows of particles of [solid %s] free, so what bends "
                  "or stretches there is inaccurate; make the clamp smaller, or use a finer dp, "
                  "for %d rows or more",
                  place, rows, s->solid[body].common.name, RESOLVED_ROWS);
}

static enum err warn_of_full_clamps(struct sampler *g)
{
    const struct scene *const s = g->scene;
    const struct scene_points *const p = &s->points[KIND_SOLID];
    struct point_grid table;
    TRY(find_clamped(&table, g));
    for (int body = 0; body < s->n_solid; body++) {
        int64_t all = 0, clamped = 0;
        for (int64_t k = 0; k < p->n; k++) {
            all += p->body[k] == body;
            clamped += p->body[k] == body && p->clamped[k];
        }
        if (all == 0 || clamped == 0) continue;
        const int rows = free_rows(s, &table, body);
        if (rows >= RESOLVED_ROWS || (rows > 0 && scene_is_bonded(s, body))) continue;
        if (rows > 0) {
            warn_of_few_rows(g, body, rows, all - clamped, all);
            continue;
        }
        char place[LOCATION_TEXT];
        scene_location(s, scene_line(s, SECTION_solid, body, "clamp"), place);
        diag_warn(g->diag,
                  "%s: `clamp` covers all %lld particles of [solid %s], so it cannot deform; make "
                  "the clamp smaller, or use a [wall], which is faster",
                  place, (long long)all, s->solid[body].common.name);
    }
    return ERR_OK;
}

/* Whether a clamped particle of the body touches a particle of the wall. */
static bool clamped_to(const struct scene *s, int body, int wall)
{
    const struct scene_points *const p = &s->points[KIND_SOLID], *const w = &s->points[KIND_WALL];
    const double reach = square(1.5 * s->top.dp);
    for (int64_t k = 0; k < p->n; k++) {
        if (p->body[k] != body || !p->clamped[k]) continue;
        for (int64_t m = 0; m < w->n; m++)
            if (w->body[m] == wall && square(p->x[k] - w->x[m]) + square(p->y[k] - w->y[m]) < reach)
                return true;
    }
    return false;
}

/* A tank that moves and the clamp of a body in it that does not, or not in the same way. */
static void warn_of_other_motions(struct sampler *g)
{
    const struct scene *const s = g->scene;
    for (int body = 0; body < s->n_solid; body++) {
        const struct scene_solid *const b = &s->solid[body];
        for (int wall = 0; wall < s->n_wall; wall++) {
            const struct scene_wall *const w = &s->wall[wall];
            if (strcmp(b->clamp_motion, w->motion) == 0 || !clamped_to(s, body, wall)) continue;
            char place[LOCATION_TEXT];
            scene_location(s, b->common.line, place);
            diag_warn(g->diag,
                      "%s: the clamp of [solid %s] %s%s but touches [wall %s], which %s%s, so "
                      "the two will overlap or part; `%s = %s` moves both",
                      place, b->common.name, b->clamp_motion[0] ? "has the motion " : "is at rest",
                      b->clamp_motion, w->common.name, w->motion[0] ? "moves" : "is at rest",
                      w->motion[0] && b->clamp_motion[0] ? " otherwise" : "",
                      w->motion[0] ? "clamp_motion" : "motion",
                      w->motion[0] ? w->motion : b->clamp_motion);
        }
    }
}

enum err geometry_warn_of_bodies(struct sampler *g)
{
    warn_of_contact(g);
    if (g->scene->n_solid > 0) TRY(warn_of_loose_bodies(g));
    warn_of_light_bodies(g);
    warn_of_turning_bodies(g);
    warn_of_soft_bodies(g);
    TRY(warn_of_full_clamps(g));
    warn_of_other_motions(g);
    return ERR_OK;
}
