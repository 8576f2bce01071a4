/* SPDX-License-Identifier: MIT
 * Limits beyond which a state is invalid: what stopped a run, where, and what helps. */
#include <float.h>
#include <stdarg.h>

#include "time/guards.h"
#include "solid/loads.h"
#include "time/advance.h"
#include "time/timestep.h"

/* Values at which a warning is given; those of the fluid are in case/scene.h. */
#define DET_WARNING 0.2  /* det F */
#define STEP_WARNING 100 /* times the limit of the step */

struct finding {
    int64_t particle; /* -1: none found */
    const char *quantity;
    double value, limit;
};

/* The first particle, in order, whose speed or density exceeds its limit or is not a number. */
static struct finding find_invalid(const struct particles *particles, double speed_limit,
                                   double dens_limit)
{
    for (int64_t i = 0; i < particles->n; i++) {
        const double speed =
            sqrt(particles->vx[i] * particles->vx[i] + particles->vy[i] * particles->vy[i]);
        if (!(speed <= speed_limit)) return (struct finding){i, "speed (m/s)", speed, speed_limit};
        if (!isfinite(particles->x[i] + particles->y[i]))
            return (struct finding){i, "position (m)", particles->x[i] + particles->y[i], DBL_MAX};
        if (dens_limit > 0 && !(fabs(particles->dens[i]) <= dens_limit))
            return (struct finding){i, "rho/rho0 - 1", particles->dens[i], dens_limit};
    }
    return (struct finding){.particle = -1};
}

static enum err invalid(const struct simulation *sim, enum kind kind, struct finding f,
                        const char *cause, struct diag *d)
{
    const struct particles *const particles = &sim->particles[kind];
    char limit[48];
    snprintf(limit, sizeof limit, isfinite(f.value) ? "beyond the limit of %.3g" : "not finite",
             f.limit);
    return diag_fail(d, ERR_GUARD,
                     "%s, step %lld: %s particle %lld at (%.6g, %.6g) m has %s = %.6g, %s: %s",
                     time_text(sim).text, (long long)sim->state.steps, kind_names[kind],
                     (long long)particles->id[f.particle], particles->x[f.particle],
                     particles->y[f.particle], f.quantity, f.value, limit, cause);
}

/* Says a sentence about the present state, if `warned` is not set yet. */
static void SPHFSI_PRINTF(4, 5)
    warn_once(const struct simulation *sim, bool *warned, struct diag *d, const char *format, ...)
{
    char text[sizeof d->text];
    va_list arguments;
    if (*warned) return;
    *warned = true;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    diag_warn(d, "%s: %s", time_text(sim).text, text);
}

/* Whether any speed or density is invalid or NaN, from the extremes of the last step. */
static bool fluid_is_valid(struct simulation *sim)
{
    const struct extremes *const e = &sim->extremes;
    const double speed = sqrt(e->speed2);
    sim->state.dens_low = min2(sim->state.dens_low, e->dens_low);
    sim->state.dens_high = max2(sim->state.dens_high, e->dens_high);
    sim->state.speed_high = max2(sim->state.speed_high, speed);
    return e->nan_probe == 0 && speed <= sim->guard.speed_limit &&
           e->dens_high <= sim->guard.dens_limit && e->dens_low >= -sim->guard.dens_limit;
}

#define UNSTABLE                                                                             \
    "the fluid is unstable (a smaller cfl may help), sound_speed is too low for this flow, " \
    "or a wall or structure presses too hard on the fluid; for a soft or light structure a " \
    "longer damping_time may help"

/* Names the damping with which soft sheets stayed at rest in still water, if a beam has less. */
static bool find_soft_beam(struct simulation *sim, char help[64])
{
    const double time = 5 * sim->scene->h / sim->scene->c0;
    for (int k = 0; k < sim->scene->n_beam && sim->effects & FX_FLUID; k++)
        sim->guard.soft_beam |= sim->scene->beam[k].damping_time < time;
    if (sim->guard.soft_beam) snprintf(help, 64, "damping_time = %.2g s in each [beam]", time);
    return sim->guard.soft_beam;
}

/* Molteni's diffusion removes the excess density of a front's first particle, which then sinks into
 * the bed that the front runs over. */
#define ENTERED                                                                              \
    "probably because fluid particles entered a wall or solid earlier in the run; a larger " \
    "wall_repulsion or diffusion_form = antuono prevents that"

static enum err check_fluid(struct simulation *sim, struct diag *d)
{
    if (!fluid_is_valid(sim)) {
        const struct finding f = find_invalid(&sim->particles[KIND_FLUID], sim->guard.speed_limit,
                                              sim->guard.dens_limit);
        const char *cause = sim->guard.warned_entered ? ENTERED : UNSTABLE;
        char help[64] = "", text[200];
        if (find_soft_beam(sim, help) && !sim->guard.warned_entered) cause = text;
        snprintf(text, sizeof text,
                 "%s may help a soft beam, a smaller cfl does not; or sound_speed is too low",
                 help);
        if (f.particle >= 0) return invalid(sim, KIND_FLUID, f, cause, d);
    }
    if (sim->state.speed_high > SPEED_WARNING * sim->scene->c0)
        warn_once(sim, &sim->guard.warned_speed, d,
                  "the fluid's speed of %.4g m/s is above %g of the speed of sound, %.4g "
                  "m/s, so the fluid is not weakly compressible; a higher sound_speed may help",
                  sim->state.speed_high, SPEED_WARNING, sim->scene->c0);
    const double dens = max2(sim->state.dens_high, -sim->state.dens_low);
    if (dens > DENS_WARNING)
        warn_once(sim, &sim->guard.warned_dens, d,
                  "the fluid's density deviates by %.3g %% from its reference. 1 %% is "
                  "usual, and the run stops at %g %%; a higher sound_speed may help",
                  100 * dens, 100 * sim->guard.dens_limit);
    return ERR_OK;
}

/* Overlaps in spacings. The law is infinite at 1, which the step bound excludes. */
#define OVERLAP_WARNING 0.5
#define OVERLAP_LIMIT 0.98

bool guards_contact_hard(const struct simulation *sim)
{
    return sim->solid.contact && sim->contact.deepest.overlap >= OVERLAP_WARNING;
}

bool guards_strain_due(const struct simulation *sim)
{
    const bool now = !(sim->effects & FX_FLUID) || sim->state.steps % CHECK_INTERVAL == 0 ||
                     guards_contact_hard(sim);
    return sim->effects & FX_SOLID && now;
}

/* det F of every particle, from displacement gradients as of the last stress evaluation. */
static struct finding smallest_det(const struct particles *particles)
{
    struct finding f = {-1, "det F", (double)INFINITY, 0};
    for (int64_t i = 0; i < particles->n; i++) {
        const double det = (1 + particles->Uxx[i]) * (1 + particles->Uyy[i]) -
                           particles->Uxy[i] * particles->Uyx[i];
        if (isnan(det)) return (struct finding){i, "det F", det, 0}; /* no comparison finds it */
        if (!(det >= f.value)) f = (struct finding){i, "det F", det, 0};
    }
    return f;
}

/* The first particle faster than the first one of its body by ten times the speed of sound. */
static struct finding too_fast(const struct simulation *sim, const struct particles *particles)
{
    for (int64_t i = 0, first = 0; i < particles->n; i++) {
        if (particles->body[i] != particles->body[first]) first = i;
        const double speed2 = square(particles->vx[i] - particles->vx[first]) +
                              square(particles->vy[i] - particles->vy[first]);
        const double limit = 10 * sim->solid.body[particles->body[i]].sound_speed;
        if (!(speed2 <= square(limit)))
            return (struct finding){i, "speed relative to the first particle of its body (m/s)",
                                    sqrt(speed2), limit};
    }
    return (struct finding){.particle = -1};
}

static enum err check_contact(struct simulation *sim, struct diag *d)
{
    const struct contact_depth *const at = &sim->contact.deepest;
    if (sim->contact.list_full)
        return diag_fail(d, ERR_MEMORY,
                         "%s: no memory for all pairs in contact; a larger dp needs less",
                         time_text(sim).text);
    if (at->overlap < OVERLAP_WARNING) return ERR_OK;
    const struct section_title one = section_title(contact_section(&sim->contact, at->body)),
                               other = section_title(contact_section(&sim->contact, at->other));
    sim->guard.case_at_fault = at->overlap >= OVERLAP_LIMIT;
    if (sim->guard.case_at_fault)
        return diag_fail(
            d, ERR_GUARD,
            "%s, step %lld: %s and %s overlap by %.3g particle spacings near (%.6g, %.6g) "
            "m, the limit of contact; a larger stiffness in [contact], a stiffer body or a slower "
            "motion may help",
            time_text(sim).text, (long long)sim->state.steps, one.text, other.text, at->overlap,
            at->x, at->y);
    warn_once(sim, &sim->guard.warned_contact, d,
              "%s and %s overlap by %.3g particle spacings near (%.6g, %.6g) m: a larger stiffness "
              "in [contact] or a smaller dp reduces this; the run stops at an overlap of 1",
              one.text, other.text, at->overlap, at->x, at->y);
    return ERR_OK;
}

static enum err check_solid(struct simulation *sim, struct diag *d)
{
    const struct particles *const particles = &sim->particles[KIND_SOLID];
    const struct finding fast = too_fast(sim, particles);
    if (fast.particle >= 0)
        return invalid(sim, KIND_SOLID, fast,
                       "this is ten times the speed of sound of the material. The solid is "
                       "unstable (a smaller solid_safety may help) or far too soft for its load",
                       d);
    if (sim->solid.contact) TRY(check_contact(sim, d));
    if (!guards_strain_due(sim)) return ERR_OK;
    const struct finding det = smallest_det(particles);
    sim->state.det_low = min2(sim->state.det_low, det.value);
    if (!(det.value > 0))
        return invalid(sim, KIND_SOLID, det,
                       "the material is inverted; a smaller dp, more hourglass control or a "
                       "stiffer law may help",
                       d);
    if (det.value < DET_WARNING)
        warn_once(
            sim, &sim->guard.warned_det, d,
            "solid particle %lld at (%.6g, %.6g) m is compressed to det F = %.3g. At 0 "
            "the material is inverted and the run stops; a smaller dp or a stiffer law may help",
            (long long)particles->id[det.particle], particles->x[det.particle],
            particles->y[det.particle], det.value);
    return ERR_OK;
}

/* What may keep a bound from falling further. */
static const char *step_remedy(const struct simulation *sim, enum bound bound)
{
    if (bound == BOUND_spring ||
        (bound == BOUND_solid && sim->scene->n_spring > 0 && sim->scene->n_solid == 0))
        return "a softer [spring], or a `force` that is less steep, may help";
    if (bound != BOUND_solid && bound != BOUND_contact)
        return "a smaller cfl or a higher sound_speed may help";
    if (sim->effects & FX_FLUID && sim->scene->numerics.multirate == MULTIRATE_OFF)
        return "numerics.multirate = auto gives the solid steps of its own";
    return "a smaller dp or a stiffer body may help";
}

/* Steps that become too small, and sub-steps that become too many. */
static enum err check_step(struct simulation *sim, struct diag *d)
{
    const double limit = sim->guard.step_limit;
    const enum bound bound = timestep_binding(sim);
    const double dt = sim->dt_bound[bound]; /* whatever limit the caller has given */
    if (sim->substeps > SUBSTEPS_MOST)
        return diag_fail(
            d, ERR_GUARD,
            "%s: the stable step of the solid has fallen to %.3g s, %d sub-steps per step, "
            "because its material is being crushed or torn; a smaller dp may help",
            time_text(sim).text, sim->dt_solid, sim->substeps);
    if (dt > STEP_WARNING * limit) return ERR_OK;
    if (dt < limit)
        return diag_fail(d, ERR_GUARD,
                         "%s: the time step has fallen to %.3g s, limited by the bound `%s`; %s",
                         time_text(sim).text, dt, bound_table[bound].name, step_remedy(sim, bound));
    warn_once(
        sim, &sim->guard.warned_step, d,
        "the time step has fallen to %.3g s, limited by the bound `%s`; the run stops at %.3g s; "
        "%s",
        dt, bound_table[bound].name, limit, step_remedy(sim, bound));
    return ERR_OK;
}

/* No fluid interacts with walls at places that are not numbers, and no other message says so. */
static enum err check_motion(struct simulation *sim, struct diag *d)
{
    for (int k = 0; k < sim->wall_motion.n; k++) {
        const struct moving_wall *const b = &sim->wall_motion.wall[k];
        const struct motion_state *const m = &b->placed;
        const double sum = m->d[0] + m->d[1] + m->v[0] + m->v[1] + m->a[0] + m->a[1] + m->angle +
                           m->rate + m->angular_acceleration;
        if (isfinite(sum)) continue;
        const struct scene_motion *const motion = &sim->scene->motion[b->motion];
        sim->guard.case_at_fault = true;
        return diag_fail(
            d, ERR_GUARD,
            "%s: %s: [motion %s] gives [wall %s] a displacement of (%g, %g) m, a velocity "
            "of (%g, %g) m/s and an acceleration of (%g, %g) m/s^2; all must be finite, so change "
            "its expression or table there",
            scene_place(sim->scene, motion->common.line).text, time_text(sim).text,
            motion->common.name, sim->scene->wall[b->section].common.name, m->d[0], m->d[1],
            m->v[0], m->v[1], m->a[0], m->a[1]);
    }
    return ERR_OK;
}

/* Steps between two sums, which cost a pass; a share above what sampling and density change. */
enum { VOIDS_INTERVAL = 256 };
#define VOIDS_SHARE 0.01

/* In a full channel fluid is missing only where its pressure has fallen below zero: voids. */
static void check_voids(struct simulation *sim, struct diag *d)
{
    const struct scene *const scene = sim->scene;
    const struct particles *const particles = &sim->particles[KIND_FLUID];
    const double area = square(scene->top.dp);
    double volume = 0, margin = 0; /* a buffer has a row more or less */
    if (!scene->full || sim->guard.warned_voids || sim->state.steps % VOIDS_INTERVAL) return;
    for (int64_t i = 0; i < particles->n; i++)
        volume += area * relative_mass(particles, i) / (1 + particles->dens[i]);
    for (int k = 0; k < scene_open_count(scene); k++)
        margin += scene->top.dp * scene_open_at(scene, k).length;
    const double start = area * (double)scene->points[KIND_FLUID].n, missing = start - volume;
    if (!(missing > VOIDS_SHARE * start + margin)) return;
    warn_once(sim, &sim->guard.warned_voids, d,
              "%.2g %% of the channel is empty: voids have opened where the pressure of the "
              "fluid fell below zero, and the flow around them is wrong. Only differences of "
              "pressure matter here, so raise the `pressure` of the open boundaries by about rho "
              "v^2/2 = %.3g Pa (v: largest speed so far)",
              100 * missing / start, 0.5 * scene->rho0 * square(sim->state.speed_high));
}

/* --- rigid bodies inside walls and each other --- */

/* Distance from a particle of another body, in spacings, below which a particle of a rigid body is
 * inside. No place of a square lattice is further than 0.71 from its particles. Bodies that touch
 * are one spacing apart. */
#define RIGID_INSIDE 0.75

/* A particle of a wall, or of a rigid body numbered above k, inside of rigid body k; -1: none. */
static int64_t find_entered(const struct simulation *sim, int k)
{
    const struct particles *const p = &sim->particles[KIND_WALL];
    const struct moving_wall *const b = sim->rigid.body[k].wall;
    const double inside = RIGID_INSIDE * sim->scene->top.dp;
    struct box2 box = box2_empty();
    for (int64_t i = b->first; i < b->end; i++) box2_include(&box, p->x[i], p->y[i]);
    for (int64_t j = 0; j < p->n; j++) {
        const int walls = scene_rigid_wall(sim->scene, 0);
        const bool behind = p->body[j] > b->section &&
                            p->body[j] < scene_beam_wall(sim->scene, 0) &&
                            !rigid_share_hinge(&sim->rigid, k, p->body[j] - walls);
        const bool other = p->body[j] < walls || behind;
        const struct box2 place = {{p->x[j], p->y[j]}, {p->x[j], p->y[j]}};
        if (!other || !box2_near(&place, &box, inside)) continue;
        for (int64_t i = b->first; i < b->end; i++)
            if (square(p->x[i] - p->x[j]) + square(p->y[i] - p->y[j]) < square(inside)) return j;
    }
    return -1;
}

static void check_rigid(struct simulation *sim, struct diag *d)
{
    const struct particles *const p = &sim->particles[KIND_WALL];
    if (sim->guard.warned_rigid || sim->state.steps % CHECK_INTERVAL) return;
    for (int k = 0; k < sim->rigid.n; k++) {
        const int64_t at = find_entered(sim, k);
        if (at < 0) continue;
        const int other = p->body[at];
        warn_once(sim, &sim->guard.warned_rigid, d,
                  "[rigid %s] has entered %s near (%.6g, %.6g) m and passes through: contact ends "
                  "a quarter of a spacing below the surface, and does not act at a hinge; hold the "
                  "body by `guide`, `hinge` or a [spring], or use a smaller `fixed_step`",
                  sim->scene->rigid[k].common.name,
                  section_title(&sim->scene->wall[other].common).text, p->x[at], p->y[at]);
        return;
    }
}

/* A gap over dp. Hinges are met to round-off, unless they contradict each other or contact. */
#define HINGE_GAP 1e-3

static enum err check_touches(struct simulation *sim, struct diag *d)
{
    if (!sim->rigid.crowded) return ERR_OK;
    sim->guard.case_at_fault = true;
    return diag_fail(d, ERR_GUARD,
                     "%s: rigid bodies and walls touch at more places than the memory holds: every "
                     "corner within dp of an outline is one; draw polygons with fewer points, and "
                     "discs as `circle`",
                     time_text(sim).text);
}

static enum err check_hinges(struct simulation *sim, struct diag *d)
{
    int k = 0;
    const double gap = rigid_hinge_gap(&sim->rigid, &k), dp = sim->scene->top.dp;
    if (gap < HINGE_GAP * dp) return ERR_OK;
    sim->guard.case_at_fault = true;
    return diag_fail(
        d, ERR_GUARD,
        "%s: points that a hinge of [rigid %s] joins are %.2g m apart, or a driven angle is off by "
        "as much: a closed chain or contact leaves no solution; leave out a "
        "`hinge_motion` or a hinge",
        time_text(sim).text, sim->scene->rigid[k].common.name, gap);
}

/* A beam and a solid do not see each other. */
static void check_beams_in_solids(struct simulation *sim, struct diag *d)
{
    const struct particles *const solid = &sim->particles[KIND_SOLID];
    int beam;
    if (sim->guard.warned_beam_in_solid || sim->state.steps % CHECK_INTERVAL) return;
    const int64_t i = beams_find_solid(&sim->beams, solid, 0.5 * sim->solid.dp, &beam);
    if (i < 0) return;
    warn_once(sim, &sim->guard.warned_beam_in_solid, d,
              "[beam %s] has met [solid %s] near (%.6g, %.6g) m and passes through, since beams "
              "and solids have no contact; make the solid a [rigid] or the beam a [solid]",
              sim->scene->beam[beam].common.name, sim->scene->solid[solid->body[i]].common.name,
              solid->x[i], solid->y[i]);
}

/* Beyond the elongations that the case was checked for. */
static enum err check_springs(struct simulation *sim, struct diag *d)
{
    const struct scene *const scene = sim->scene;
    for (int k = 0; k < scene->n_spring; k++) {
        const struct scene_spring *const s = &scene->spring[k];
        const bool of_beam = scene_find(scene, SECTION_beam, s->body) >= 0;
        const double e =
            of_beam ? sim->beams.spring[k].elongation : sim->rigid.spring[k].elongation;
        if (!isfinite(e) || spring_is_finite(s, e)) continue;
        sim->guard.case_at_fault = true;
        return diag_fail(d, ERR_GUARD,
                         "%s: %s: [spring %s] has a force of %g N/m with a slope of %g N/m^2 at e "
                         "= %.6g m; both must be finite, so change `force`: min(e, E) in place "
                         "of e keeps the force of E above E",
                         scene_place(scene, key_line(scene, SECTION_spring, k, "force")).text,
                         time_text(sim).text, s->common.name, spring_force(s, e),
                         spring_slope(s, e), e);
    }
    return ERR_OK;
}

static enum err check_loads(struct simulation *sim, struct diag *d)
{
    const struct loads *const on_solids = sim->solid.loads;
    const int k = on_solids && on_solids->infinite ? on_solids->infinite : sim->beams.infinite;
    if (k == 0) return ERR_OK;
    const struct scene_section_common *const load = &sim->scene->load[k - 1].common;
    sim->guard.case_at_fault = true;
    return diag_fail(d, ERR_GUARD,
                     "%s: %s: [load %s] gives a force that is not finite; change its expression",
                     scene_place(sim->scene, load->line).text, time_text(sim).text, load->name);
}

static enum err check_newton(struct simulation *sim, struct diag *d)
{
    const bool solid = sim->solid.implicit && sim->solid.implicit->failed;
    char help[64] = "a smaller fixed_step";
    if (!solid && !sim->beams.failed) return ERR_OK;
    if (!solid) find_soft_beam(sim, help);
    return diag_fail(d, ERR_GUARD,
                     "%s: Newton's method finds no solution for the implicit step of the %s, %.3g "
                     "s, nor for shorter steps (residual: %.2g of the largest force); %s or %s may "
                     "help",
                     time_text(sim).text, solid ? "solid" : "beams", sim->state.dt,
                     solid ? sim->solid.implicit->residual : sim->beams.residual, help,
                     solid ? "solid_steps = explicit"
                           : "an `element` shorter than sqrt(EI/N), with the axial force N,");
}

enum err guards_check(struct simulation *sim, struct diag *d)
{
    TRY(check_springs(sim, d));
    if (sim->effects & (FX_LOAD | FX_BEAM)) TRY(check_loads(sim, d));
    TRY(check_newton(sim, d));
    if (sim->beams.crowded)
        warn_once(sim, &sim->guard.warned_beams, d,
                  "beams touch at more than %d places, and at further ones they pass through; use "
                  "a larger `element`",
                  BEAM_PAIRS);
    if (sim->effects & FX_BEAM && sim->effects & FX_SOLID) check_beams_in_solids(sim, d);
    if (sim->effects & FX_MOTION) TRY(check_motion(sim, d));
    if (sim->effects & FX_RIGID) TRY(check_touches(sim, d));
    if (sim->effects & FX_RIGID) TRY(check_hinges(sim, d));
    if (sim->effects & FX_RIGID) check_rigid(sim, d);
    if (sim->effects & FX_FLUID) TRY(check_fluid(sim, d));
    if (!(sim->effects & FX_MOTION)) check_voids(sim, d);
    if (sim->effects & FX_SOLID) TRY(check_solid(sim, d));
    TRY(energy_guard(sim, d));
    return check_step(sim, d);
}

void guards_warn_of_loss(const struct simulation *sim, int64_t first, struct diag *d)
{
    const struct particles *const particles = &sim->particles[KIND_FLUID];
    diag_warn(d,
              "%s: fluid particle %lld has left the domain at (%.6g, %.6g) m and is removed: its "
              "mass and pressure will be missing; a [wall] in its way "
              "or a larger [domain] keeps it",
              time_text(sim).text, (long long)particles->id[first], particles->x[first],
              particles->y[first]);
}

/* The side of the domain that a point is furthest beyond. */
static const char *side_beyond(const struct scene *scene, const double at[2])
{
    static const char *const names[2][2] = {{"left", "right"}, {"lower", "upper"}};
    const char *side = "";
    double furthest = -(double)INFINITY;
    for (int k = 0; k < 4; k++) {
        const int c = k / 2;
        const double beyond =
            k % 2 ? at[c] - scene->domain_upper[c] : scene->domain_lower[c] - at[c];
        if (scene_periodic(scene, c) || !(beyond > furthest)) continue;
        furthest = beyond;
        side = names[c][k % 2];
    }
    return side;
}

/* Driven walls may leave, as lifted gates do. */
void guards_warn_of_leaving(struct simulation *sim, struct diag *d)
{
    const struct scene *const scene = sim->scene;
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++) {
        const struct particles *const p = &sim->particles[kind];
        for (int64_t first = 0, end = 0; first < p->n; first = end) {
            const int body = p->body[first];
            bool inside = kind == KIND_WALL && body < scene_rigid_wall(scene, 0);
            for (; end < p->n && p->body[end] == body; end++) inside |= p->cell[end] >= 0;
            if (inside) continue;
            warn_once(sim, &sim->guard.warned_left[energy_entry((enum kind)kind, body)], d,
                      "%s has left the domain by its %s side, and takes no part in the flow from "
                      "then on unless it comes back; a larger [domain] keeps it",
                      section_title(kind == KIND_SOLID ? &scene->solid[body].common
                                                       : &scene->wall[body].common)
                          .text,
                      side_beyond(scene, (double[]){p->x[first], p->y[first]}));
        }
    }
}

/* --- fluid inside a wall or a solid: at the places of the body's own particles --- */

/* Distance from a particle of a body, in spacings, below which a fluid particle is inside. Fluid at
 * rest is one spacing from the particles at the surface; under high pressure half of that. */
#define TAKEN 0.35

/* Whether a place is that close to a particle, in spacings of a solid's reference configuration:
 * the solid has rotated and stretched since the start. */
static bool inside_body(const struct simulation *sim, double x, double y)
{
    const double at[2] = {x, y}, taken = TAKEN * sim->scene->top.dp;
    /* A stretched particle of a solid reaches further. */
    const double reach = sim->particles[KIND_SOLID].n > 0 ? KERNEL_REACH * sim->scene->h : taken;
    struct cell_visit v =
        cells_visit(&sim->cells, sim->particles, KIND_WALL, KIND_COUNT, at, reach);
    while (cells_next(&v)) {
        const struct particles *const p = v.particles;
        const struct line_dummy *const dummy =
            fluid_line_dummy(&sim->fluid, (enum kind)v.kind, v.i);
        double limit = taken * (dummy ? dummy->same_side * dummy->width : 1);
        if (v.kind == KIND_SOLID) {
            const double xx = 1 + p->Uxx[v.i], xy = p->Uxy[v.i], yx = p->Uyx[v.i],
                         yy = 1 + p->Uyy[v.i];
            /* F^-1 times det F: no division. */
            v.r = sqrt(square(yy * v.x - xy * v.y) + square(xx * v.y - yx * v.x));
            limit = TAKEN * sim->solid.body[p->body[v.i]].dp * fabs(xx * yy - xy * yx);
        }
        if (v.r < limit) return true;
    }
    return false;
}

int64_t guards_count_entered(const struct simulation *sim, int64_t *first)
{
    const struct cell_list *const fluid = &sim->cells.list[KIND_FLUID];
    const struct particles *const particles = &sim->particles[KIND_FLUID];
    int64_t count = 0, lowest = INT64_MAX;
#pragma omp parallel for schedule(static) reduction(+ : count) reduction(min : lowest)
    for (int32_t k = 0; k < fluid->n_active; k++) {
        const int32_t cell = fluid->active[k];
        if (!fluid_near_dummies(&sim->fluid, cell)) continue;
        for (int32_t i = fluid->start[cell]; i < fluid->start[cell] + fluid->count[cell]; i++) {
            if (!inside_body(sim, particles->x[i], particles->y[i])) continue;
            count++;
            if (i < lowest) lowest = i;
        }
    }
    *first = count ? lowest : -1;
    return count;
}

/* Tolerated stray particles: a fraction of the fluid, and this number for any amount of fluid. */
#define ENTERED_SHARE 0.01
enum { ENTERED_LEAST = 3, ENTERED_INTERVAL = 2 * CHECK_INTERVAL };

enum err guards_check_entered(struct simulation *sim, struct diag *d)
{
    if (!(sim->effects & (FX_WALL | FX_COUPLING)) || sim->state.steps % ENTERED_INTERVAL)
        return ERR_OK;
    int64_t first;
    const int64_t count = guards_count_entered(sim, &first);
    const struct particles *const particles = &sim->particles[KIND_FLUID];
    if (count == 0) return ERR_OK;
    sim->state.entered = sim->state.entered > count ? sim->state.entered : count;
    if (count > ENTERED_LEAST && (double)count > ENTERED_SHARE * (double)particles->n)
        return diag_fail(
            d, ERR_GUARD,
            "%s, step %lld: %lld fluid particles have entered a wall or solid, the first "
            "is %lld at (%.6g, %.6g) m with speed = %.4g m/s; a larger wall_repulsion, a "
            "thickness of three particles or a higher sound_speed may help",
            time_text(sim).text, (long long)sim->state.steps, (long long)count,
            (long long)particles->id[first], particles->x[first], particles->y[first],
            elementary_hypot(particles->vx[first], particles->vy[first]));
    warn_once(sim, &sim->guard.warned_entered, d,
              "fluid particle %lld at (%.6g, %.6g) m has entered a wall or solid; the run stops "
              "when more than 1 %% of the fluid has; a larger wall_repulsion may keep it out",
              (long long)particles->id[first], particles->x[first], particles->y[first]);
    return ERR_OK;
}
