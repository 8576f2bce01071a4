/* SPDX-License-Identifier: MIT
 * Scenes that can be simulated but are probably a mistake: a tank without a bottom, a surface below
 * the water. Each gets a warning with the consequence and the remedy. Bodies: doubts_solid.c; open
 * boundaries: doubts_open.c; how the fluid begins: doubts_start.c. */
#include "geometry/sampling.h"
#include "base/elementary.h"

#include "case/case.h"

#include <math.h>

/* For each strip of width dp along gravity: the coordinate along gravity of the last wall or body
 * particle in it. */
struct supports {
    double along[2], across[2]; /* unit vectors: of gravity, and to its left */
    double low;                 /* coordinate across of the first strip, m */
    int64_t n;
    double *last; /* [n] */
};

static double dot(const double a[2], double x, double y) { return a[0] * x + a[1] * y; }

static int64_t strip_of(const struct supports *f, double dp, double x, double y)
{
    return (int64_t)floor((dot(f->across, x, y) - f->low) / dp);
}

static enum err find_supports(struct supports *f, const struct sampler *g, struct arena *a)
{
    const struct scene *const s = g->scene;
    const double dp = s->top.dp, size = elementary_hypot(s->top.gravity[0], s->top.gravity[1]);
    double low = HUGE_VAL, high = -HUGE_VAL;
    f->along[0] = s->top.gravity[0] / size;
    f->along[1] = s->top.gravity[1] / size;
    f->across[0] = -f->along[1];
    f->across[1] = f->along[0];
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int64_t k = 0; k < s->points[kind].n; k++) {
            const double at = dot(f->across, s->points[kind].x[k], s->points[kind].y[k]);
            low = min2(low, at);
            high = max2(high, at);
        }
    f->low = low - 1.5 * dp; /* one strip more on each side */
    f->n = (int64_t)((high - f->low) / dp) + 3;
    f->last = arena_alloc(a, (size_t)f->n, sizeof *f->last, "strips", g->diag);
    if (!f->last) return ERR_MEMORY;
    for (int64_t k = 0; k < f->n; k++) f->last[k] = -HUGE_VAL;
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++)
        for (int64_t k = 0; k < s->points[kind].n; k++) {
            const double x = s->points[kind].x[k], y = s->points[kind].y[k];
            double *const last = &f->last[strip_of(f, dp, x, y)];
            *last = max2(*last, dot(f->along, x, y));
        }
    return ERR_OK;
}

/* Fluid without a wall or body between it and the edge of the domain below falls out of the
 * scene. */
static enum err warn_of_missing_floor(struct sampler *g)
{
    const struct scene *const s = g->scene;
    const struct scene_points *const p = &s->points[KIND_FLUID];
    if (p->n == 0 || (s->top.gravity[0] == 0 && s->top.gravity[1] == 0)) return ERR_OK;
    if (s->domain.periodic != PERIODIC_NONE) return ERR_OK; /* it may enter again */
    struct supports f;
    TRY(find_supports(&f, g, &g->temp));
    int64_t falling = 0, first = -1;
    for (int64_t k = 0; k < p->n; k++) {
        const int64_t strip = strip_of(&f, s->top.dp, p->x[k], p->y[k]);
        const double at = dot(f.along, p->x[k], p->y[k]);
        bool held = false;
        for (int64_t m = strip - 1; m <= strip + 1; m++) held |= f.last[m] > at;
        falling += !held;
        if (!held && first < 0) first = k;
    }
    if (falling == 0) return ERR_OK;
    char place[LOCATION_TEXT];
    scene_location(s, s->fluid[p->body[first]].common.line, place);
    diag_warn(g->diag,
              "%s: %lld of %lld fluid particles, the first at (%.4g, %.4g) m, have no wall or body "
              "below them and will fall out of the domain; add a [wall] below them",
              place, (long long)falling, (long long)p->n, p->x[first], p->y[first]);
    return ERR_OK;
}

/* The component along y, averaged over the run, by the midpoint rule. */
static double mean_gravity(const struct scene *s)
{
    enum { TIMES = 1000 };
    double sum = 0, gravity[2];
    if (!scene_gravity_varies(s)) return s->top.gravity[1];
    for (int n = 0; n < TIMES; n++) {
        scene_gravity_at(s, s->top.end_time * (n + 0.5) / TIMES, gravity);
        sum += gravity[1];
    }
    return sum / TIMES;
}

/* Gravity at t = 0 sets the initial pressure. Later a moment of upward gravity is no doubt: a tank may be
 * shaken. */
static void warn_of_upward_gravity(struct sampler *g, const struct scene_fluid *fluid)
{
    char place[LOCATION_TEXT];
    const double mean = mean_gravity(g->scene);
    if (g->scene->top.gravity[1] <= 0 && mean > 0) {
        scene_location(g->scene, fluid->common.line, place);
        diag_warn(
            g->diag,
            "%s: `surface`, but gravity points upwards on average, by %.3g m/s^2 over the run: "
            "the water will rise from its tank; gravity that points down has a negative "
            "second component",
            place, mean);
    }
    if (!(g->scene->top.gravity[1] > 0)) return;
    scene_location(g->scene, fluid->common.line, place);
    diag_warn(g->diag,
              "%s: `surface` with upward gravity: the initial pressure decreases with depth, and "
              "the water will be torn apart; for gravity that points down, use gravity = 0, -9.81",
              place);
}

static void warn_of_low_surface(struct sampler *g, int f)
{
    const struct scene *const s = g->scene;
    const struct scene_points *const p = &s->points[KIND_FLUID];
    const struct scene_fluid *const fluid = &s->fluid[f];
    int64_t above = 0;
    double top = -HUGE_VAL;
    for (int64_t k = 0; k < p->n; k++) {
        if (p->body[k] != f || (p->open && p->open[k] > 0)) continue;
        above += p->y[k] > fluid->surface;
        top = max2(top, p->y[k] + 0.5 * s->top.dp);
    }
    if (above == 0) return;
    char place[LOCATION_TEXT];
    scene_location(s, fluid->common.line, place);
    diag_warn(g->diag,
              "%s: [fluid %s] reaches up to y = %.4g m, above its `surface = %.4g m`: %lld "
              "particles begin with a pressure below zero; `surface` is the height of the free "
              "surface",
              place, fluid->common.name, top, fluid->surface, (long long)above);
}

/* The lowest free particle of a fluid whose column of width dp ends more than one spacing below its
 * `surface`, with nothing above it; its height, or infinity. */
static enum err lowest_free(struct sampler *g, int f, double *y)
{
    const struct scene *const s = g->scene;
    const struct scene_points *const p = &s->points[KIND_FLUID];
    const double dp = s->top.dp;
    double low = HUGE_VAL, high = -HUGE_VAL;
    *y = HUGE_VAL;
    for (int64_t k = 0; k < p->n; k++)
        if (p->body[k] == f) low = min2(low, p->x[k]), high = max2(high, p->x[k]);
    if (low > high) return ERR_OK;
    const int64_t n = (int64_t)((high - low) / dp) + 2;
    double *const top = arena_alloc(&g->temp, (size_t)n, sizeof *top, "columns", g->diag);
    if (!top) return ERR_MEMORY;
    for (int64_t m = 0; m < n; m++) top[m] = -HUGE_VAL;
    for (int64_t k = 0; k < p->n; k++) {
        const int64_t m = (int64_t)((p->x[k] - low) / dp + 0.5);
        if (p->body[k] == f) top[m] = max2(top[m], p->y[k]);
    }
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int64_t k = 0; k < s->points[kind].n; k++) {
            const double over = s->points[kind].y[k];
            const double at = (s->points[kind].x[k] - low) / dp + 0.5;
            if (at < -1 || at > (double)n) continue;
            for (int64_t m = (int64_t)floor(at - 0.25); m <= (int64_t)floor(at + 0.25); m++)
                if (m >= 0 && m < n && over > top[m] && over < top[m] + 1.6 * dp)
                    top[m] = HUGE_VAL; /* covered */
        }
    for (int64_t m = 0; m < n; m++)
        if (top[m] > -HUGE_VAL && top[m] + 1.5 * dp < s->fluid[f].surface) *y = min2(*y, top[m]);
    return ERR_OK;
}

static enum err warn_of_high_surface(struct sampler *g, int f)
{
    const struct scene *const s = g->scene;
    const struct scene_fluid *const fluid = &s->fluid[f];
    double y;
    if (!(s->top.gravity[1] < 0)) return ERR_OK;
    TRY(lowest_free(g, f, &y));
    if (!isfinite(y)) return ERR_OK;
    const double top = y + 0.5 * s->top.dp;
    char place[LOCATION_TEXT];
    scene_location(s, fluid->common.line, place);
    diag_warn(g->diag,
              "%s: [fluid %s] has a free surface at y = %.4g m, below its `surface = %.4g m`: it "
              "begins there with a pressure of %.3g Pa and will spout; `surface` is the height of "
              "the free surface, and a [fluid] for each height has its own",
              place, fluid->common.name, top, fluid->surface,
              -fluid->density * s->top.gravity[1] * (fluid->surface - top));
    return ERR_OK;
}

/* The hydrostatic start of `surface` assumes gravity along -y and water up to that height. */
static enum err warn_of_surface(struct sampler *g)
{
    for (int f = 0; f < g->scene->n_fluid; f++) {
        if (isnan(g->scene->fluid[f].surface)) continue;
        warn_of_upward_gravity(g, &g->scene->fluid[f]);
        warn_of_low_surface(g, f);
        TRY(warn_of_high_surface(g, f));
    }
    return ERR_OK;
}

/* Probable errors of units: a density in g/cm^3, as of water with 1 instead of 1000 kg/m^3. */
static void warn_of_density(struct sampler *g)
{
    const struct scene *const s = g->scene;
    enum {
        LIGHTEST_LIQUID = 100
    }; /* kg/m^3; liquid hydrogen has 71, all other liquids have more */
    for (int f = 0; f < s->n_fluid; f++)
        if (s->fluid[f].density < LIGHTEST_LIQUID) {
            char place[LOCATION_TEXT];
            scene_location(s, s->fluid[f].common.line, place);
            diag_warn(g->diag,
                      "%s: [fluid %s] has a density of %.4g kg/m^3, less than any liquid, so its "
                      "forces will be small; water has 1000 kg/m^3",
                      place, s->fluid[f].common.name, s->fluid[f].density);
        }
}

/* A weakly compressible fluid stays within 1 % of its density (Monaghan 1994); its own weight compresses
 * it by g H/c0^2. */
static void warn_of_soft_fluid(struct sampler *g)
{
    const struct scene *const s = g->scene;
    const struct scene_points *const p = &s->points[KIND_FLUID];
    const double *const gravity = s->top.gravity;
    for (int c = 0; c < 2; c++)
        if (scene_periodic(s, c) && gravity[c] != 0) return; /* it carries no weight */
    for (int f = 0; f < s->n_fluid; f++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int64_t k = 0; k < p->n; k++) {
            if (p->body[k] != f) continue;
            low = min2(low, dot(gravity, p->x[k], p->y[k]));
            high = max2(high, dot(gravity, p->x[k], p->y[k]));
        }
        const double compression = (high - low) / square(s->c0);
        if (!(compression > 0.01)) continue;
        char place[LOCATION_TEXT];
        scene_location(s, s->fluid[f].common.line, place);
        diag_warn(
            g->diag,
            "%s: [fluid %s] is compressed by %.2g %% under its own weight, because its speed "
            "of sound is only %.3g m/s; a `max_speed` of %.3g m/s or more keeps it below 1 %%",
            place, s->fluid[f].common.name, 100 * compression, s->c0, sqrt(high - low));
    }
}

/* Whether the point is in walls or solids, more than half a spacing from their faces, i.e. deeper than the
 * outermost particle reaches. */
static bool is_buried(const struct sampler *g, const double at[2])
{
    const double side = 0.5 * g->scene->top.dp;
    for (int corner = 0; corner < 4; corner++) {
        const double x = at[0] + (corner & 1 ? side : -side),
                     y = at[1] + (corner & 2 ? side : -side);
        bool covered = false;
        for (int k = 0; k < g->n_regions && !covered; k++)
            covered = g->regions[k].kind != KIND_FLUID && geometry_covers(g, &g->regions[k], x, y);
        if (!covered) return false;
    }
    return true;
}

/* How far a point lies above all fluid, against gravity, m. */
static double height_above(const struct scene *s, const double at[2])
{
    const struct scene_points *const p = &s->points[KIND_FLUID];
    const double *const g = s->top.gravity, size = elementary_hypot(g[0], g[1]);
    double least = HUGE_VAL;
    for (int64_t k = 0; k < p->n; k++)
        least = min2(least, dot(g, p->x[k] - at[0], p->y[k] - at[1]) / size);
    return least;
}

/* Whether nothing but gravity drives the fluid, so that it rises above its top by splashes only. */
static bool only_falls(const struct scene *s)
{
    bool falls = s->n_inflow == 0 && s->n_outflow == 0 && s->n_motion == 0 &&
                 !scene_gravity_varies(s) && (s->top.gravity[0] != 0 || s->top.gravity[1] != 0);
    for (int k = 0; k < s->n_fluid; k++) falls &= !s->fluid[k].velocity.e[0];
    return falls && s->points[KIND_FLUID].n > 0;
}

/* A value at a point is a mean over the fluid within 2 h. */
static void warn_of_buried_probe(struct sampler *g, const struct scene_probe *probe)
{
    const struct scene *const s = g->scene;
    char place[LOCATION_TEXT], quantity[SCENE_NAME];
    scene_location(s, probe->common.line, place);
    param_choice_name(param_find(SECTION_probe, "quantity"), probe->quantity, quantity);
    if (probe->quantity == PROBE_LEVEL)
        diag_warn(g->diag,
                  "%s: [probe %s] point = %g, %g lies inside a wall or solid, where there is no "
                  "fluid, so its level is that of the point; move it to the face",
                  place, probe->common.name, probe->point[0], probe->point[1]);
    else
        diag_warn(g->diag,
                  "%s: [probe %s] point = %g, %g lies inside a wall or solid, where there is no "
                  "fluid: its %s is that of fluid within 2 h = %g m, or 0; move it to the face",
                  place, probe->common.name, probe->point[0], probe->point[1], quantity, 2 * s->h);
}

/* Whether a wall has a part within half a spacing of a point along each axis. */
static bool wall_is_at(const struct sampler *g, int wall, const double at[2])
{
    const double side = 0.5 * g->scene->top.dp;
    for (int k = 0; k < g->n_regions; k++)
        for (int corner = 0; corner < 4; corner++)
            if (g->regions[k].kind == KIND_WALL && g->regions[k].body == wall &&
                geometry_covers(g, &g->regions[k], at[0] + (corner & 1 ? side : -side),
                                at[1] + (corner & 2 ? side : -side)))
                return true;
    return false;
}

enum { TIMES = 16 };

/* The k-th of some times in the run, s. By the golden ratio, so that no period divides them. */
static double time_in_run(const struct scene *s, int k)
{
    const double part = 0.6180339887498949 * k;
    return s->top.end_time * (part - floor(part));
}

/* Whether a wall at a point is elsewhere at one of these times. A lid that slides along itself, or
 * a drum that turns about its axis, is not. */
static bool wall_leaves(const struct sampler *g, int wall, const double at[2])
{
    const struct scene *const s = g->scene;
    const int motion = scene_find_motion(s, s->wall[wall].motion);
    for (int k = 1; k <= TIMES && motion >= 0; k++) {
        const struct motion_state m = motion_at(s, motion, time_in_run(s, k));
        const double x = at[0] - m.centre[0] - m.d[0], y = at[1] - m.centre[1] - m.d[1];
        const double c = m.angle == 0 ? 1 : m.turn[0], sn = m.angle == 0 ? 0 : m.turn[1];
        const double before[2] = {m.centre[0] + c * x + sn * y, m.centre[1] - sn * x + c * y};
        if (!wall_is_at(g, wall, before)) return true;
    }
    return false;
}

/* The wall that is at a point now and leaves it, unless one that stays is there too; -1: none. */
static int leaving_wall(const struct sampler *g, const double at[2])
{
    int found = -1;
    for (int k = 0; k < g->scene->n_wall; k++) {
        if (!wall_is_at(g, k, at)) continue;
        if (!wall_leaves(g, k, at)) return -1;
        found = k;
    }
    return found;
}

/* The pressure at a wall that moves away is hardly meant to be that of the place where it once was. */
static void warn_of_fixed_probe(struct sampler *g, const struct scene_probe *probe)
{
    const bool face = probe->quantity == PROBE_SURFACE_PRESSURE;
    if ((probe->quantity != PROBE_PRESSURE && !face) || *probe->on) return;
    int wall = -1;
    for (int k = face ? 1 : 0; k < (face ? 4 : 1) && wall < 0; k++) {
        const double at[2] = {probe->point[0] + 0.25 * k * (probe->to[0] - probe->point[0]),
                              probe->point[1] + 0.25 * k * (probe->to[1] - probe->point[1])};
        if (!is_buried(g, at)) wall = leaving_wall(g, at);
    }
    if (wall < 0) return;
    char place[LOCATION_TEXT];
    scene_location(g->scene, probe->common.line, place);
    const char *const name = g->scene->wall[wall].common.name;
    diag_warn(g->diag,
              "%s: [probe %s] begins at [wall %s], which moves away, but stays where it is; "
              "`on = %s` moves it along",
              place, probe->common.name, name, name);
}

/* Whether a motion turns at one of these times. */
static bool turns(const struct scene *s, int motion)
{
    for (int k = 1; k <= TIMES; k++)
        if (motion_at(s, motion, time_in_run(s, k)).angle != 0) return true;
    return false;
}

/* L-1 leaves a moment of 2 mu A times the rate of turning, of either sign, on what turns and sticks. */
static void warn_of_moment(struct sampler *g, const struct scene_probe *probe)
{
    const struct scene *const s = g->scene;
    double nu = 0;
    for (int k = 0; k < s->n_fluid; k++) nu = max2(nu, s->fluid[k].laminar_viscosity);
    char name[SCENE_TEXT];
    for (int k = 0; nu > 0 && probe->quantity == PROBE_FORCE && scene_listed(probe->body, k, name);
         k++) {
        const int wall = scene_find_wall(s, name);
        const int motion = wall < 0 ? -1 : scene_find_motion(s, s->wall[wall].motion);
        if (motion < 0 || s->wall[wall].slip != SLIP_NONE) continue;
        if (!turns(s, motion)) continue;
        char place[LOCATION_TEXT];
        scene_location(s, probe->common.line, place);
        diag_warn(g->diag,
                  "%s: [probe %s] the moment on [wall %s], which turns with slip = none, is off by "
                  "2 mu A times its rate of turning: mu = %.3g Pa s, A = the area that it "
                  "encloses. The moment needs this correction; forces are right",
                  place, probe->common.name, name, nu * s->rho0);
    }
}

static void warn_of_fluid_probes(struct sampler *g)
{
    const struct scene *const s = g->scene;
    for (int k = 0; k < s->n_probe; k++) {
        const struct scene_probe *const probe = &s->probe[k];
        warn_of_fixed_probe(g, probe);
        warn_of_moment(g, probe);
        if (scene_probe_target(probe) != TARGET_FLUID_POINT) continue;
        if (is_buried(g, probe->point)) {
            warn_of_buried_probe(g, probe);
            continue;
        }
        if (probe->quantity != PROBE_PRESSURE || !only_falls(s)) continue;
        if (height_above(s, probe->point) <= 2 * s->h) continue;
        char place[LOCATION_TEXT];
        scene_location(s, probe->common.line, place);
        diag_warn(g->diag,
                  "%s: [probe %s] point = %g, %g lies in the air, above all fluid, so its "
                  "pressure is 0 unless a splash reaches it; move it into the fluid",
                  place, probe->common.name, probe->point[0], probe->point[1]);
    }
}

/* Whether walls enclose the fluid where the domain is not periodic, and particles cover all between
 * them: then there is no free surface. */
static bool is_filled(const struct scene *s)
{
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, n = 0, area = 1;
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++)
        for (int64_t k = 0; k < s->points[kind].n; k++, n++) {
            const double at[2] = {s->points[kind].x[k], s->points[kind].y[k]};
            for (int c = 0; c < 2; c++)
                low[c] = min2(low[c], at[c]), high[c] = max2(high[c], at[c]);
        }
    const struct scene_points *const p = &s->points[KIND_FLUID];
    for (int c = 0; c < 2; c++) {
        if (scene_periodic(s, c)) low[c] = s->domain_lower[c], high[c] = s->domain_upper[c];
        for (int64_t k = 0; k < p->n; k++)
            if ((c ? p->y[k] : p->x[k]) < low[c] || (c ? p->y[k] : p->x[k]) > high[c]) return false;
        area *= high[c] - low[c] + (scene_periodic(s, c) ? 0 : s->top.dp);
    }
    return (n + (double)p->n) * square(s->top.dp) > 0.99 * area;
}

/* Without a free surface the volume is given, and nothing takes back the pressure that a shift makes.
 * In a channel, periodic in x, it rose by 0.4, 0.75 and 1.1 % of rho c0^2 with `shifting` 0.5, 2 and 8;
 * without walls, where L-9 holds for all particles, it did not. */
static void warn_of_drift(struct sampler *g)
{
    const struct scene *const s = g->scene;
    const bool one_way = s->domain.periodic == PERIODIC_X || s->domain.periodic == PERIODIC_Y;
    if (!one_way || !is_filled(s)) return;
    for (int k = 0; k < s->n_fluid; k++) {
        const struct scene_fluid *const fluid = &s->fluid[k];
        if (!(fluid->shifting > 0)) continue;
        char place[LOCATION_TEXT];
        scene_location(s, fluid->common.line, place);
        diag_warn(
            g->diag,
            "%s: [fluid %s] fills its periodic domain, so its mean pressure drifts with "
            "`shifting`, by about 1 %% of rho c0^2 = %.3g Pa; use differences of pressure, or "
            "a smaller `shifting`",
            place, fluid->common.name, s->rho0 * square(s->c0));
    }
}

enum err geometry_warn_of_doubts(struct sampler *g)
{
    TRY(warn_of_surface(g));
    warn_of_density(g);
    warn_of_soft_fluid(g);
    TRY(geometry_warn_of_bodies(g));
    TRY(geometry_warn_of_open(g));
    TRY(geometry_warn_of_start(g));
    warn_of_fluid_probes(g);
    warn_of_drift(g);
    return warn_of_missing_floor(g);
}
