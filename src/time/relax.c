/* SPDX-License-Identifier: MIT
 * The search for a state of rest (T-78) by kinetic damping: where the kinetic energy has passed a
 * maximum, all velocities are set to zero. Its steps are those of a run, with forces at t = 0. */
#include "time/simulation.h"

static double kinetic_energy(const struct simulation *sim)
{
    const struct particles *const f = &sim->particles[KIND_FLUID], *const particles =
                                                                       &sim->particles[KIND_SOLID];
    double fluid = 0, solid = 0;
    for (int64_t i = 0; i < f->n; i++)
        fluid += relative_mass(f, i) * (square(f->vx[i]) + square(f->vy[i]));
    for (int64_t i = 0; i < particles->n; i++)
        solid += sim->solid.body[particles->body[i]].mass *
                 (square(particles->vx[i]) + square(particles->vy[i]));
    return 0.5 * (sim->fluid.k.mass * fluid + solid);
}

/* With `verlet` a solid's velocity is half a step behind its position: at rest it is that of half a
 * step before. Zero instead would put energy into the fastest modes. */
static void clear_solid_velocities(struct simulation *sim)
{
    struct particles *const particles = &sim->particles[KIND_SOLID];
    const double back = -0.5 * sim->state.dt / sim->substeps;
    particles_clear(particles->vx, particles->n);
    particles_clear(particles->vy, particles->n);
    particles_clear(particles->wx, particles->n);
    particles_clear(particles->wy, particles->n);
    if (sim->solid.centred || sim->substeps == 0 || particles->n == 0) return;
    solid_stress(&sim->solid, particles);
    solid_forces(&sim->solid, particles);
    for (int64_t i = 0; i < particles->n; i++) {
        particles->vx[i] = back * particles->sx[i];
        particles->vy[i] = back * particles->sy[i];
    }
}

/* The integrators' memories of earlier steps end with the motion. */
static void clear_velocities(struct simulation *sim)
{
    const struct particles *const f = &sim->particles[KIND_FLUID];
    double *const of_fluid[] = {f->vx,     f->vy,     f->vx_half,   f->vy_half,
                                f->vx_old, f->vy_old, f->ddens_old, f->ddens_older};
    for (size_t k = 0; k < COUNT_OF(of_fluid); k++) particles_clear(of_fluid[k], f->n);
    if (sim->effects & FX_SOLID) clear_solid_velocities(sim);
    sim->state.verlet_count = 0; /* the next step is an Euler step */
    sim->state.relax_kinetic = 0;
    sim->evaluated = false;
}

void relax_end(struct simulation *sim)
{
    const struct state found = sim->state;
    clear_velocities(sim);
    sim->state = (struct state){
        .sorts = found.sorts,
        .particle_steps = found.particle_steps,
        .lost = found.lost,
        .det_low = 1,
        .solid_stiffening = found.solid_stiffening,
        .solid_slowing = found.solid_slowing,
        .substeps_held = found.substeps_held,
        .exchange_time = found.exchange_time,
        .relax_time = found.time,
        .relax_quiet_since = found.relax_quiet_since,
        .relax_peaks = found.relax_peaks,
    };
    solid_place_clamps(&sim->solid, &sim->particles[KIND_SOLID], 0);
    energy_begin(sim);
}

/* T-78: judges the motion after a step of the search. */
static void test_for_rest(struct simulation *sim)
{
    struct state *const st = &sim->state;
    const double energy = kinetic_energy(sim), before = st->relax_kinetic;
    st->relax_kinetic = energy;
    st->relax_peak_most = max2(st->relax_peak_most, energy);
    const double tolerated = square(sim->scene->relax.tolerance) * st->relax_peak_most;
    if (energy > tolerated) st->relax_quiet_since = st->time;
    if (before > tolerated && energy < before) {
        clear_velocities(sim);
        st->relax_peak_last = before;
        st->relax_peaks++;
        st->relax_swing_most = max2(st->relax_swing_most, st->time - st->relax_peak_time);
        st->relax_peak_time = st->relax_quiet_since = st->time;
    }
    const bool never = st->relax_peak_most == 0;
    const double still = st->time - st->relax_quiet_since;
    if (never || (st->relax_peaks > 0 && still > 2 * st->relax_swing_most)) relax_end(sim);
}

/* T-78: what has moved further than the size of the domain since the last peak, by its mean
 * velocity now and an even acceleration, meets nothing; nor does fluid that has left. */
static enum err check_held(const struct simulation *sim, const struct particles *particles,
                           int body, const struct scene_section_common *common, struct diag *d)
{
    const double *const low = sim->scene->domain_lower, *const high = sim->scene->domain_upper;
    const double size = elementary_hypot(high[0] - low[0], high[1] - low[1]),
                 since = sim->state.time - sim->state.relax_peak_time;
    double n = 0, vx = 0, vy = 0;
    for (int64_t i = 0; i < particles->n; i++) {
        if (body >= 0 && particles->body[i] != body) continue;
        n++;
        vx += particles->vx[i];
        vy += particles->vy[i];
    }
    if (n > 0 && !(0.5 * since * elementary_hypot(vx, vy) / n > size)) return ERR_OK;
    return diag_fail(d, ERR_GUARD,
                     "%s: [relax]: %s has moved further than the size of the domain, %.3g m: "
                     "nothing holds it, so there is no state of rest; put a [wall] below it, give "
                     "a body a `clamp`, or leave [relax] out",
                     scene_place(sim->scene, common->line).text, section_title(common).text, size);
}

/* T-78a: solids without fluid, at once; if that fails, they move as with fluid. */
static enum err find_equilibrium(struct simulation *sim, struct diag *d)
{
    struct particles *const particles = &sim->particles[KIND_SOLID];
    sim->guard.case_at_fault = true; /* a body that nothing holds */
    TRY(equilibrium_find(&sim->rest, &sim->solid, particles, sim->scene,
                         sim->effects & FX_CONTACT ? &sim->contact : NULL, d));
    sim->guard.case_at_fault = false;
    if (!sim->rest.found) return ERR_OK;
    solid_set_positions(particles);
    relax_end(sim);
    return ERR_OK;
}

/* Whether the search has taken so long that it finds no rest: ERR_GUARD. */
static enum err check_limit(const struct simulation *sim, struct diag *d)
{
    const struct state *const st = &sim->state;
    const double longest = st->relax_swing_most, limit = sim->scene->relax.limit;
    if (st->relax_peaks == 0 || st->time < limit * longest) return ERR_OK;
    return diag_fail(
        d, ERR_GUARD,
        "[relax]: no state of rest within %.3g s (`limit` = %g times the longest time of %.3g s "
        "between two peaks of kinetic energy): the speed is still %.2g of its largest value; a "
        "larger tolerance or limit, `mass_damping` in a [solid]%s may help",
        st->time, limit, longest, sqrt(st->relax_peak_last / st->relax_peak_most),
        sim->effects & FX_FLUID && sim->scene->top.scheme == SCHEME_PAPER
            ? " or `scheme = standard`, which keeps water still,"
            : "");
}

enum err relax_step(struct simulation *sim, struct diag *d)
{
    const struct scene *const scene = sim->scene;
    const bool first = sim->state.time == 0;
    if (first && !(sim->effects & FX_FLUID)) TRY(find_equilibrium(sim, d));
    if (!sim->state.seeks_rest) return ERR_OK;
    if (first) /* clamps at rest */
        solid_place_clamps(&sim->solid, &sim->particles[KIND_SOLID], scene_time(sim, 0));
    TRY(simulation_step(sim, (double)INFINITY, d));
    sim->guard.case_at_fault = true; /* for what follows */
    if (scene->n_fluid)
        TRY(check_held(sim, &sim->particles[KIND_FLUID], -1, &scene->fluid[0].common, d));
    for (int b = 0; b < scene->n_solid; b++)
        TRY(check_held(sim, &sim->particles[KIND_SOLID], b, &scene->solid[b].common, d));
    test_for_rest(sim);
    if (sim->state.seeks_rest) TRY(check_limit(sim, d));
    sim->guard.case_at_fault = false;
    return ERR_OK;
}

enum err relax_to_rest(struct simulation *sim, struct diag *d)
{
    while (sim->state.seeks_rest) TRY(relax_step(sim, d));
    return ERR_OK;
}

void relax_progress(const struct simulation *sim, char text[RELAX_TEXT])
{
    const struct state *const st = &sim->state;
    const double share =
        st->relax_peak_most > 0 ? sqrt(st->relax_kinetic / st->relax_peak_most) : 0;
    snprintf(text, RELAX_TEXT,
             "seeking rest: after %.3g s and %lld peaks of kinetic energy the speed is %.2g of its "
             "largest value, tolerance = %g",
             st->time, (long long)st->relax_peaks, share, sim->scene->relax.tolerance);
}

void relax_text(const struct simulation *sim, char text[RELAX_TEXT])
{
    const struct state *const st = &sim->state;
    if (sim->rest.load_steps > 0)
        snprintf(text, RELAX_TEXT,
                 "at rest: Newton's method found static equilibrium by %d corrections in %d load "
                 "step%s",
                 sim->rest.corrections, sim->rest.load_steps, sim->rest.load_steps > 1 ? "s" : "");
    else if (st->relax_peaks == 0)
        snprintf(text, RELAX_TEXT, "nothing moves: the state at the start is one of rest");
    else
        snprintf(
            text, RELAX_TEXT,
            "at rest after %.3g s and %lld peaks of kinetic energy: over the last %.3g s, twice "
            "the longest time between two peaks, the speed stayed below %g of its largest value",
            st->relax_time, (long long)st->relax_peaks, st->relax_time - st->relax_quiet_since,
            sim->scene->relax.tolerance);
}
