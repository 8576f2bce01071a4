/* SPDX-License-Identifier: MIT
 * When particles are sorted into cells again, and what leaves the domain then. */
#include "time/advance.h"
#include "time/guards.h"
#include "time/timestep.h"

/* Energy that gravity adds to fluid that passes from a periodic side to the opposite one. */
static void add_crossings(struct simulation *sim)
{
    for (int axis = 0; axis < 2; axis++) {
        const double given = sim->fluid.k.mass * sim->scene->top.gravity[axis] *
                             (double)sim->cells.crossings[axis] *
                             (sim->scene->domain_upper[axis] - sim->scene->domain_lower[axis]);
        sim->state.periodic_energy += given;
        energy_supply(sim, KIND_FLUID, 0, given);
    }
}

void forget_fluid(struct particles *particles)
{
    double *const sums[] = {particles->p,  particles->dens,  particles->fx,
                            particles->fy, particles->wet_x, particles->wet_y};
    for (size_t k = 0; k < COUNT_OF(sums); k++) particles_clear(sums[k], particles->n);
}

/* Sets the cells' skin from a new measurement. The next evaluation uses the present state. The
 * predictor's second one is half a step later, in which two particles approach by a step of the
 * largest velocity; 1.1 leaves a margin for accelerations (T-30). */
void measure_skin(struct simulation *sim)
{
    const bool predicts = sim->integrator->rates_at > 0;
    const double moved = predicts ? 1.1 * timestep_fluid_limit(sim) * sqrt(sim->sorting.speed2) : 0;
    sim->sorting.skin_left = cells_skin_left(&sim->cells, KERNEL_REACH * sim->fluid.k.h + moved);
}

enum err sort_particles(struct simulation *sim, struct diag *d)
{
    struct particles *const fluid = &sim->particles[KIND_FLUID], *const solid =
                                                                     &sim->particles[KIND_SOLID];
    if (sim->effects & FX_WALL) forget_fluid(&sim->particles[KIND_WALL]);
    if (sim->effects & FX_COUPLING) forget_fluid(solid);
    if (sim->effects & FX_OPEN) TRY(open_exchange(&sim->open, d));
    const int64_t lost = cells_sort(&sim->cells, KIND_FLUID, fluid);
    if (lost && sim->state.lost == 0) guards_warn_of_loss(sim, fluid->n - lost, d);
    for (int64_t i = fluid->n - lost; i < fluid->n; i++) {
        const double energy = particle_energy(&sim->fluid.k, sim->scene->top.gravity, fluid, i);
        sim->state.lost_energy += energy;
        energy_supply(sim, KIND_FLUID, fluid->body[i], -energy);
    }
    if (sim->effects & FX_PERIODIC) add_crossings(sim);
    fluid->n -= lost;
    sim->state.lost += lost;
    if (sim->effects & FX_OPEN) TRY(open_list(&sim->open, d));
    if ((sim->effects & FX_WALL) && sim->state.sorts == 0)
        cells_sort(&sim->cells, KIND_WALL, &sim->particles[KIND_WALL]);
    else if (sim->effects & FX_MOTION)
        wall_motion_sort(&sim->wall_motion, &sim->cells, &sim->particles[KIND_WALL]);
    if (sim->effects & FX_COUPLING) cells_sort(&sim->cells, KIND_SOLID, solid);
    if (sim->effects & (FX_RIGID | FX_BEAM | FX_COUPLING)) guards_warn_of_leaving(sim, d);
    fluid_find_near(&sim->fluid, &sim->cells);
    sim->state.sorts++;
    const int32_t fullest = cells_fullest(&sim->cells);
    sim->cells_overfull = fullest > CELL_CAPACITY;
    measure_skin(sim);
    if (sim->cells_overfull && sim->state.steps == 0)
        return diag_fail(
            d, ERR_INPUT,
            "%d particles start in one cell of %.3g m, more than the limit of %d; use a smaller "
            "numerics.h_over_dp, or a dp of solids closer to that of the fluid",
            fullest, sim->cells.side[0], CELL_CAPACITY);
    if (sim->cells_overfull)
        return diag_fail(
            d, ERR_GUARD,
            "%s: %d particles have collapsed into one cell of %.3g m, where about twenty "
            "are usual, so the run is unstable; a smaller cfl or another sound_speed may help",
            time_text(sim).text, fullest, sim->cells.side[0]);
    return ERR_OK;
}

/* For the fluid: the larger of both speeds, half a step of its acceleration, and its shift. */
void spend_skin(struct simulation *sim, double speed2_before)
{
    const double dt = sim->state.dt, speed = sqrt(max2(speed2_before, sim->extremes.speed2)),
                 moved = dt * (speed + 0.5 * dt * sqrt(sim->fluid.extremes.acceleration2)) +
                         sim->sorting.shifted;
    const double other = max2(sim->sorting.solid_move, sim->wall_motion.moved_most);
    for (int side = 0; side < 4; side++) sim->cells.list[KIND_FLUID].overhang[side] += moved;
    sim->sorting.skin_left -= moved + max2(moved, other);
    sim->wall_motion.moved_most = 0;
}

static void measure_overhangs(struct simulation *sim, enum kind first)
{
    const bool moves[] = {true, sim->wall_motion.moved, (sim->effects & FX_COUPLING) != 0};
    for (int kind = (int)first; kind < KIND_COUNT; kind++)
        if (moves[kind])
            cells_measure_overhang(&sim->cells, (enum kind)kind, &sim->particles[kind]);
    measure_skin(sim);
}

/* Where displacements are bounded, cells need not be measured at every step. The predictor moves
 * structures further than a step does: these are measured. Round-off is below the tolerance. */
bool sorting_due(struct simulation *sim)
{
    if (sim->effects & FX_OPEN && open_due(&sim->open)) return true;
    if (sim->integrator->rates_at > 0) measure_overhangs(sim, KIND_WALL);
    if (sim->sorting.skin_left > 1e-6 * sim->fluid.k.h) return false;
    measure_overhangs(sim, KIND_FLUID);
    return !(sim->sorting.skin_left > 0);
}

/* --- isolated particles, which the fluid does not resolve --- */

int simulation_count_near(const struct simulation *sim, double x, double y, int kinds)
{
    const double at[] = {x, y};
    struct cell_visit v =
        cells_visit(&sim->cells, sim->particles, 0, kinds, at, KERNEL_REACH * sim->fluid.k.h);
    int n = 0;
    while (cells_next(&v)) n++;
    return n;
}

void limit_isolated_tension(struct simulation *sim)
{
    /* T-45: what a water hammer at the speed that c0 is chosen for changes, and two thirds of
     * the guard's limit. Larger tension is not part of the flow. */
    const double factor = sim->scene->numerics.sound_factor;
    const double lowest = max2(-1 / factor, -2.0 / 3 * sim->guard.dens_limit);
    if (!(sim->extremes.dens_low < lowest)) return;
    struct particles *const particles = &sim->particles[KIND_FLUID];
    /* Particles within reach: a third of those inside the fluid, fewer than at a corner of it. */
    const double reach = KERNEL_REACH * sim->fluid.k.h / sim->scene->top.dp;
    const int most = (int)(PI / 3 * reach * reach);
    for (int64_t i = 0; i < particles->n; i++) {
        if (!(particles->dens[i] < lowest) ||
            simulation_count_near(sim, particles->x[i], particles->y[i], KIND_COUNT) > most)
            continue;
        particles->dens[i] = 0;
        if (particles->dens_slow) particles->dens_slow[i] = 0;
        if (particles->dens_old) particles->dens_old[i] = 0;
        if (particles->ddens_old) particles->ddens_old[i] = particles->ddens_older[i] = 0;
        sim->state.tension_limited++;
    }
}
