/* SPDX-License-Identifier: MIT
 * Fluid that is probably a mistake: a tank without a bottom, water without the pressure of its
 * weight, a surface below the water, speeds near that of sound, probes where there is no fluid. */
#include "check/check.h"

static double dot(const double a[2], double x, double y) { return a[0] * x + a[1] * y; }

/* --- nothing below the fluid --- */

/* Fluid without a wall or body between it and the edge of the domain below falls out of the scene.
 * For each strip of width dp along gravity, `last` is how far down its walls and bodies reach. */
static enum err warn_of_missing_floor(struct check *check)
{
    const struct scene *const scene = check->scene;
    const struct points *const p = &check->points;
    const double *const gravity = scene->top.gravity, dp = scene->top.dp;
    const double size = elementary_hypot(gravity[0], gravity[1]);
    if (size == 0 || scene->domain.periodic != PERIODIC_NONE)
        return ERR_OK; /* it may enter again */
    const double along[2] = {gravity[0] / size, gravity[1] / size},
                 across[2] = {-along[1], along[0]};
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int64_t k = 0; k < p->n; k++) {
        low = min2(low, dot(across, p->x[k], p->y[k]));
        high = max2(high, dot(across, p->x[k], p->y[k]));
    }
    low -= 1.5 * dp; /* one strip more on each side */
    const int64_t n = (int64_t)((high - low) / dp) + 3;
    double *last;
    TRY(arena_array(&check->shapes.temp, &last, n, "check", check->diag));
    for (int64_t k = 0; k < n; k++) last[k] = -HUGE_VAL;
    long long falling = 0, all = 0;
    int64_t first = -1;
    for (int fluid = 0; fluid < 2; fluid++)
        for (int64_t k = 0; k < p->n; k++) {
            const double at = dot(along, p->x[k], p->y[k]);
            double *const strip = &last[(int64_t)floor((dot(across, p->x[k], p->y[k]) - low) / dp)];
            if ((p->bit[k] != POINT_BODY) != fluid) continue;
            if (!fluid) *strip = max2(*strip, at);
            const bool falls = fluid && max2(max2(strip[-1], strip[0]), strip[1]) <= at;
            if (falls && falling++ == 0) first = k;
            all += fluid;
        }
    if (falling > 0)
        warn_at(check->diag, check->scene, scene->fluid[p->section[first]].common.line,
                "%lld of %lld fluid particles, the first at (%.4g, %.4g) m, have no wall or body "
                "below them and will fall out of the domain; add a [wall] below them",
                falling, all, p->x[first], p->y[first]);
    return ERR_OK;
}

/* --- `surface`: gravity along -y, and water up to that height --- */

/* Fluid with nothing above it, a spacing or more below the surface, begins under pressure. */
static void warn_of_surface(struct check *check, int f)
{
    const struct scene *const scene = check->scene;
    const struct points *const p = &check->points;
    const struct scene_fluid *const fluid = &scene->fluid[f];
    const double dp = scene->top.dp, up[2] = {0, 0.9};
    double top = -HUGE_VAL, lowest = HUGE_VAL;
    int64_t above = 0;
    if (scene->top.gravity[1] > 0)
        warn_section(
            check, &fluid->common,
            "has a `surface`, but gravity points upwards, by %.3g m/s^2 at t = 0; gravity that "
            "points down has a negative second component",
            scene->top.gravity[1]);
    for (int64_t k = 0; k < p->n; k++) {
        if (p->bit[k] != POINT_FLUID || p->section[k] != f) continue;
        above += p->y[k] > fluid->surface;
        top = max2(top, p->y[k] + 0.5 * dp);
        if (p->y[k] + 1.5 * dp < min2(fluid->surface, lowest + dp) &&
            point_beside(check, k, up, 0.75, POINT_ANY) < 0)
            lowest = p->y[k] + 0.5 * dp;
    }
    if (above > 0)
        warn_section(
            check, &fluid->common,
            "reaches up to y = %.4g m, above its `surface = %.4g m`: %lld particles begin with "
            "a pressure below zero; `surface` is the height of the free surface",
            top, fluid->surface, (long long)above);
    if (isfinite(lowest) && scene->top.gravity[1] < 0)
        warn_section(
            check, &fluid->common,
            "ends at y = %.4g m, below its `surface = %.4g m`: the pressure there begins with "
            "%.3g Pa and drives a jet; `surface` is the height of the free surface, one for "
            "each [fluid]",
            lowest, fluid->surface,
            -fluid->density * scene->top.gravity[1] * (fluid->surface - lowest));
}

/* --- density, weight --- */

/* Probable errors of units: a density in g/cm^3, as of water with 1 instead of 1000 kg/m^3. A
 * weakly compressible fluid stays within 1 % of its density (Monaghan 1994). Its own weight
 * compresses it by g H/c0^2, unless gravity is along a periodic side. */
static void warn_of_density(struct check *check, int f)
{
    enum { LIGHTEST_LIQUID = 100 }; /* kg/m^3; hydrogen has 71, all others have more */
    const struct scene *const scene = check->scene;
    const struct scene_fluid *const fluid = &scene->fluid[f];
    if (fluid->density < LIGHTEST_LIQUID)
        warn_section(
            check, &fluid->common,
            "has a density of %.4g kg/m^3, less than any liquid, so its forces will be small; "
            "water has 1000 kg/m^3",
            fluid->density);
    for (int axis = 0; axis < 2; axis++)
        if (scene_periodic(scene, axis) && scene->top.gravity[axis] != 0) return;
    const double fall = extent_along(scene, KIND_FLUID, f, scene->top.gravity);
    if (fall > 0.01 * square(scene->c0))
        warn_section(
            check, &fluid->common,
            "is compressed by %.2g %% under its own weight, because its speed of sound is only "
            "%.3g m/s; a `max_speed` of %.3g m/s or more keeps it below 1 %%",
            100 * fall / square(scene->c0), scene->c0, sqrt(fall));
}

/* Whether a fluid stands on something: a wall, a body, other fluid or a buffer. */
static bool stands(const struct check *check, int fluid, const double down[2])
{
    const struct points *const p = &check->points;
    for (int64_t k = 0; k < p->n; k++) {
        if (p->bit[k] != POINT_FLUID || p->section[k] != fluid) continue;
        const int64_t below = point_beside(check, k, down, 0.7, POINT_ANY);
        if (below >= 0 && (p->bit[below] != POINT_FLUID || p->section[below] != fluid)) return true;
    }
    return false;
}

/* Water that begins without the pressure of its weight, or with that above a missing bottom. */
static void warn_of_weight(struct check *check, int fluid)
{
    const struct scene *const scene = check->scene;
    const struct scene_fluid *const f = &scene->fluid[fluid];
    double down[2]; /* without the part along periodic sides, in which gravity drives a flow */
    for (int axis = 0; axis < 2; axis++)
        down[axis] = scene_periodic(scene, axis) ? 0 : scene->top.gravity[axis];
    const double size = elementary_hypot(down[0], down[1]);
    if (size == 0 || f->pressure.e[0]) return;
    for (int axis = 0; axis < 2; axis++) down[axis] /= size;
    const bool held = stands(check, fluid, down);
    const double depth = extent_along(scene, KIND_FLUID, fluid, down) + scene->top.dp;
    const double pressure = f->density * size * depth;
    if (!held && !isnan(f->surface) && scene->top.gravity[1] < 0)
        warn_section(
            check, &f->common,
            "has a `surface`, but nothing to stand on: the pressure at its lower end begins with "
            "up to %.3g Pa and drives a jet; move the fluid to the floor, or leave out `surface`",
            pressure);
    const bool at_rest = isnan(f->surface) && !f->velocity.e[0] && !(scene->relax.tolerance > 0);
    const bool upright = scene->top.gravity[1] < 0 && scene->top.gravity[0] == 0;
    if (held && at_rest && scene_open_count(scene) == 0)
        warn_section(
            check, &f->common,
            "begins without the pressure of its weight, %.3g Pa, so it falls onto its floor "
            "and its pressure oscillates between 0 and twice this value; add %s",
            pressure, upright ? "`surface`, or `pressure`" : "`pressure`");
}

/* Fluid that faces a wall or body across a gap of one particle, not upwards. The dummies of a beam
 * lie on both sides of its line, so they say nothing of a gap. */
static void warn_of_start_gap(struct check *check, int fluid)
{
    enum { FEW = 3 }; /* particles at a corner or a curved face */
    static const double sides[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    const struct points *const p = &check->points;
    const double dp = check->scene->top.dp;
    const int beams_from = scene_beam_wall(check->scene, 0);
    int64_t n = 0, first = -1, body = -1;
    for (int64_t k = 0; k < p->n; k++) {
        if (p->bit[k] != POINT_FLUID || p->section[k] != fluid) continue;
        for (int side = 0; side < 4; side++) {
            const double *const to = sides[side];
            if (dot(to, check->scene->top.gravity[0], check->scene->top.gravity[1]) < 0) continue;
            if (point_beside(check, k, to, 0.9, POINT_ANY) >= 0) continue;
            const double after[2] = {p->x[k] + 2 * dp * to[0], p->y[k] + 2 * dp * to[1]};
            const int64_t found = point_at(check, after, 0.7 * dp, POINT_ANY);
            if (found < 0 || p->bit[found] != POINT_BODY) continue;
            if (p->kind[found] == KIND_WALL && p->section[found] >= beams_from) continue;
            if (n++ == 0) first = k, body = found;
        }
    }
    if (n <= FEW) return;
    const int walls_from = p->kind[body] == KIND_WALL ? check->scene->n_solid : 0;
    const struct body other = body_at(check->scene, walls_from + p->section[body]);
    warn_section(check, &check->scene->fluid[fluid].common,
                 "begins one dp = %.3g m away from %s at (%.4g, %.4g) m and will hit it; "
                 "let their shapes touch, or leave a gap of 2 dp or more",
                 dp, section_title(other.common).text, p->x[first], p->y[first]);
}

/* --- speeds near that of sound --- */

/* Largest speed and acceleration of the corners of the box around a wall or a body's clamps. */
static void warn_of_motion(struct check *check, const struct body *b)
{
    enum { TIMES = 256 };
    struct scene *const scene = check->scene;
    const struct scene_points *const p = &scene->points[b->kind];
    const int motion = scene_find(scene, SECTION_motion, b->motion);
    struct box2 box = box2_empty();
    double largest = 0, sharpest = 0;
    for (int64_t k = 0; k < p->n; k++)
        if (p->body[k] == b->index && (b->kind != KIND_SOLID || p->clamped[k]))
            box2_include(&box, p->x[k], p->y[k]);
    if (motion < 0 || box.low[0] > box.high[0]) return;
    for (int n = 0; n <= TIMES; n++) {
        const double t = scene->top.end_time * n / TIMES;
        const struct motion_state m = motion_at(scene, motion, t);
        for (int corner = 3; corner >= 0; corner--) {
            double at[2];
            box2_corner(&box, corner, at);
            const struct motion_point moved = motion_of_point(&m, at[0], at[1]);
            largest = max2(largest, elementary_hypot(moved.v[0], moved.v[1]));
            sharpest = max2(sharpest, elementary_hypot(moved.a[0], moved.a[1]));
        }
    }
    const double step = scene->numerics.fixed_step > 0 ? scene->numerics.fixed_step
                                                       : scene->numerics.cfl * scene->h / scene->c0;
    if (scene->n_fluid > 0 && sharpest * step > largest)
        warn_at(check->diag, scene, scene->motion[motion].common.line,
                "[motion %s] changes its velocity of %.3g m/s within %.2g s, but a time step is "
                "about %.2g s; use a slower change, or a smaller step (numerics.cfl, fixed_step)",
                scene->motion[motion].common.name, largest, largest / sharpest, step);
    warn_of_speed(check, scene->motion[motion].common.line, largest, "[motion %s] moves %s at",
                  scene->motion[motion].common.name, section_title(b->common).text);
}

/* --- open boundaries --- */

/* Fluid in front of the line beyond its end, and neither wall nor buffer behind the line there; or
 * a wall in front of it that does not continue beside the buffer. */
static void warn_of_end(struct check *check, const struct scene_open *o, bool last)
{
    const double dp = check->scene->top.dp, beyond = last ? dp : -dp;
    double end[2], front[2], behind[2], back[2], buffer[2];
    for (int axis = 0; axis < 2; axis++) {
        end[axis] = o->from[axis] + (last ? o->length * o->along[axis] : 0);
        front[axis] = end[axis] + 0.5 * (beyond * o->along[axis] + dp * o->inward[axis]);
        behind[axis] = front[axis] - dp * o->inward[axis];
        back[axis] = front[axis] - o->depth * o->inward[axis];
        buffer[axis] = back[axis] - beyond * o->along[axis];
    }
    if (point_at(check, front, 0.75 * dp, POINT_FLUID) >= 0 &&
        point_at(check, behind, 0.8 * dp, POINT_ANY) < 0)
        warn_section(
            check, o->common,
            "ends inside the fluid at (%.4g, %.4g) m: fluid beyond this end flows past the line "
            "and is lost; add a [wall], or let the line end at a wall or at the surface",
            end[0], end[1]);
    if (point_at(check, front, 0.8 * dp, POINT_BODY) >= 0 &&
        point_at(check, buffer, 0.8 * dp, POINT_BUFFER) >= 0 &&
        point_at(check, back, 1.5 * dp, POINT_BODY) < 0)
        warn_section(check, o->common,
                     "leaks beside its buffer at (%.4g, %.4g) m, where the wall or body beside the "
                     "line ends; extend that wall or body to %.3g m behind the line",
                     end[0], end[1], o->depth);
}

/* Without a level the buffer fills the whole line, also above the fluid within 2 dp of it. */
static void warn_of_level(struct check *check, const struct scene_open *o)
{
    const struct points *const p = &check->points;
    const double dp = check->scene->top.dp;
    double buffer = -HUGE_VAL, fluid = -HUGE_VAL;
    for (int64_t k = 0; k < p->n; k++) {
        double in, along;
        if (p->bit[k] == POINT_BODY) continue;
        scene_open_place(o, (const double[]){p->x[k], p->y[k]}, &in, &along);
        if (along < 0 || along > o->length || in < -o->depth || in > 2 * dp) continue;
        double *const top = p->bit[k] == POINT_BUFFER ? &buffer : &fluid;
        *top = max2(*top, p->y[k] + 0.5 * dp);
    }
    if (!(check->scene->top.gravity[1] < 0) || !isnan(o->level) || !(buffer > fluid + 1.5 * dp))
        return;
    warn_at(
        check->diag, check->scene, o->common->line,
        "the line of %s lets fluid pass up to y = %.4g m, but the surface of the fluid "
        "beside it is at y = %.4g m. Above the surface fluid %s; `level = %.4g m` prevents this",
        section_title(o->common).text, buffer, fluid, o->inflow ? "falls in" : "stands still",
        fluid);
}

/* Given velocities hold exactly, whatever the pressure. In a full channel they must balance:
 * within a hundredth of the fluid's volume, at all times. */
static void warn_of_balance(struct check *check)
{
    enum { TIMES = 256 };
    const struct scene *const scene = check->scene;
    const int n_open = scene_open_count(scene);
    const double step = scene->top.end_time / TIMES;
    double volume = 0, more = 0;
    if (!scene->full) return;
    for (int k = 0; k < n_open; k++)
        if (scene_open_at(scene, k).kind != OPEN_VELOCITY) return;
    for (int64_t k = 0; k < check->points.n; k++)
        volume += check->points.bit[k] == POINT_FLUID ? square(scene->top.dp) : 0;
    int n = 0;
    for (; n < TIMES && fabs(more) <= 0.01 * volume; n++)
        for (int k = 0; k < n_open; k++) {
            const struct scene_open o = scene_open_at(scene, k);
            more += step * scene_open_flow(&o, (n + 0.5) * step);
        }
    if (fabs(more) <= 0.01 * volume) return;
    const struct scene_open o = scene_open_at(scene, n_open - 1);
    warn_section(
        check, o.common,
        "is one of the open boundaries whose velocities let %.3g m^2 more %s than %s by t = "
        "%.3g s, %.2g %% of the fluid. There is no free surface, so %s; give one boundary a "
        "`pressure` instead of a velocity",
        fabs(more), more > 0 ? "in" : "out", more > 0 ? "out" : "in", n * step,
        100 * fabs(more) / volume,
        more > 0 ? "the pressure rises until a guard stops the run" : "voids open");
}

/* Whether fluid somewhere has nothing beside it. */
static bool has_surface(const struct check *check)
{
    static const double sides[4][2] = {{-1.2, 0}, {1.2, 0}, {0, -1.2}, {0, 1.2}};
    for (int64_t k = 0; k < check->points.n; k++)
        if (check->points.bit[k] == POINT_FLUID)
            for (int side = 0; side < 4; side++)
                if (point_beside(check, k, sides[side], 1, POINT_ANY) < 0) return true;
    return false;
}

/* --- probes --- */

/* Whether a point is more than half a spacing inside of walls or solids. */
static bool is_buried(const struct check *check, const double at[2])
{
    const double side = 0.5 * check->scene->top.dp;
    for (int corner = 0; corner < 4; corner++)
        if (drawn_at(check, at[0] + (corner & 1 ? side : -side),
                     at[1] + (corner & 2 ? side : -side)) < 0)
            return false;
    return true;
}

/* A value at a point is a mean over the fluid within 2 h. */
static void warn_of_dry_probe(struct check *check, const struct scene_probe *probe)
{
    const struct scene *const scene = check->scene;
    const double *const at = probe->point;
    if (scene_probe_target(probe) != TARGET_FLUID_POINT || !is_buried(check, at)) return;
    char value[SCENE_NAME + 80] = "its value is the height of the point";
    if (probe->quantity != PROBE_LEVEL)
        snprintf(value, sizeof value, "its %s comes from fluid within 2 h = %g m, or is 0",
                 quantity_table[probe->quantity].name, 2 * scene->h);
    warn_section(check, &probe->common,
                 "point = %g, %g lies inside a wall or solid, where there is no fluid, so %s; move "
                 "it to the face",
                 at[0], at[1], value);
}

/* L-1 leaves a moment of 2 mu A times the rate of turning, of either sign, on what turns and
 * sticks. At low Reynolds numbers a free body turns twice as fast in a shear as it should. */
static void warn_of_turning(struct check *check)
{
    const struct scene *const scene = check->scene;
    double nu = 0;
    for (int k = 0; k < scene->n_fluid; k++) nu = max2(nu, scene->fluid[k].laminar_viscosity);
    if (nu == 0) return;
    for (int k = 0; k < scene->n_solid + scene->n_wall; k++) {
        const struct body b = body_at(scene, k);
        const bool solid = b.kind == KIND_SOLID;
        const int motion = solid ? -1 : scene_find(scene, SECTION_motion, b.motion);
        const struct scene_motion *const m = motion < 0 ? NULL : &scene->motion[motion];
        const bool turns = solid ? scene->solid[k].clamp.n == 0 : m && m->turn.e[0];
        bool asked = solid;
        char name[SCENE_TEXT];
        if (!solid)
            for (int p = 0; p < scene->n_probe; p++)
                for (int n = 0; scene_listed(scene->probe[p].body, n, name); n++)
                    asked |= scene->probe[p].quantity == PROBE_FORCE &&
                             strcmp(name, b.common->name) == 0;
        if (turns && asked && b.slip == SLIP_NONE)
            warn_section(
                check, b.common,
                "%s with slip = none: the viscous moment on it is off by 2 mu A omega (mu = "
                "%.3g Pa s, A: area of the body, omega: angular velocity); forces are right%s",
                solid ? "is free to turn" : "turns", nu * scene->rho0,
                solid ? ", but at low Reynolds numbers it turns up to twice as fast as it should"
                      : "");
    }
}

/* --- drift of the mean pressure --- */

/* Without a free surface the volume is given, and nothing takes back the pressure that a shift
 * makes. In a channel, periodic in x, it rose by 0.4, 0.75 and 1.1 % of rho c0^2 with `shifting`
 * 0.5, 2 and 8. Without walls, where L-9 holds for all particles, it did not rise. */
static void warn_of_drift(struct check *check)
{
    const struct scene *const scene = check->scene;
    const int periodic = scene->domain.periodic;
    if ((periodic != PERIODIC_X && periodic != PERIODIC_Y) || has_surface(check)) return;
    for (int k = 0; k < scene->n_fluid; k++)
        if (scene->fluid[k].shifting > 0)
            warn_section(
                check, &scene->fluid[k].common,
                "fills its periodic domain, so its mean pressure drifts with `shifting`, by about "
                "1 %% of rho c0^2 = %.3g Pa; use differences of pressure, or a smaller `shifting`",
                scene->rho0 * square(scene->c0));
}

/* --- flow past bodies that stick --- */

/* Particles follow streamlines, which part before a body and leave gaps beside it. In
 * cases/verify/cylinder.cfg (Re = 20) the particles within half a diameter are 14 % too few at
 * t = 10 D/U, and their pressures are off those of their neighbours by 29 % of rho U^2. With
 * shifting it is 1 and 5 %. A free surface would not bear it: a viscous jet on a plate that sticks
 * breaks up. So it is the default without one; at most at the limit of warn_of_fluid_keys. */
static void shift_in_streams(struct scene *scene)
{
    if (!scene->full || !(effects_of_scene(scene) & FX_NO_SLIP)) return;
    for (int k = 0; k < scene->n_fluid; k++)
        if (scene_given(scene, SECTION_fluid, k, "shifting")) return;
    for (int k = 0; k < scene->n_fluid; k++) {
        scene->fluid[k].shifting = min2(10, 5 / scene->numerics.cfl);
        scene->fluid[k].shifting_speed = SHIFTING_LARGEST;
    }
}

enum err warn_of_fluid(struct check *check)
{
    struct scene *const scene = check->scene;
    if (scene->n_fluid == 0) return ERR_OK;
    for (int f = 0; f < scene->n_fluid; f++) {
        if (!isnan(scene->fluid[f].surface)) warn_of_surface(check, f);
        warn_of_density(check, f);
        warn_of_start_gap(check, f);
        warn_of_weight(check, f);
        warn_of_speed(check, key_line(scene, SECTION_fluid, f, "velocity"),
                      start_speed(scene, KIND_FLUID, f, &scene->fluid[f].velocity),
                      "[fluid %s] begins with", scene->fluid[f].common.name);
    }
    for (int k = 0; k < scene->n_solid + scene->n_wall; k++) {
        const struct body b = body_at(scene, k);
        warn_of_motion(check, &b);
    }
    scene->full = scene_open_count(scene) > 0 && !has_surface(check);
    for (int k = 0; k < scene_open_count(scene); k++) {
        const struct scene_open o = scene_open_at(scene, k);
        for (int last = 0; last < 2; last++) warn_of_end(check, &o, last);
        warn_of_level(check, &o);
    }
    if (scene->full) warn_of_balance(check);
    for (int k = 0; k < scene->n_probe; k++) warn_of_dry_probe(check, &scene->probe[k]);
    warn_of_turning(check);
    warn_of_drift(check);
    shift_in_streams(scene);
    return warn_of_missing_floor(check);
}
