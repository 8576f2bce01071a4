/* SPDX-License-Identifier: MIT
 * Steps that are unstable, and settings that make a run slow. */
#include "check/check.h"
#include "time/timestep.h"

/* The largest cfl of an integrator is that up to which a falling column of water was found stable
 * (tests/stability/column.cfg); the analysis in docs/theory.md gives the same for leapfrog.
 * fixed_step is used unchanged, even if the run then becomes unstable. */
static void warn_of_unstable_step(const struct simulation *sim, struct diag *d)
{
    const struct scene *const scene = sim->scene;
    const double fixed = scene->numerics.fixed_step, limit = sim->integrator->largest_cfl;
    const bool shared =
        sim->effects & FX_SOLID && !(sim->effects & FX_MULTIRATE) && !sim->solid.implicit;
    const bool fluid = sim->effects & FX_FLUID;
    /* C_CFL of Eq. 28b at rest for the largest step, whatever bound sets it. */
    const double courant = fluid ? timestep_fluid_limit(sim) * sim->fluid.k.c0 / sim->fluid.k.h : 0;
    char given[64];
    if (fixed > 0)
        snprintf(given, sizeof given, "numerics.fixed_step = %g s (C_CFL = %.3g)", fixed, courant);
    else
        snprintf(given, sizeof given, "numerics.cfl = %g", scene->numerics.cfl);
    if (courant > limit * (1 + 1e-9))
        diag_warn(d,
                  "%s is above %g, the stability limit of this integrator, so the fluid may become "
                  "unstable and a guard may stop the run; use a smaller value",
                  given, limit);
    if (shared && fixed > sim->solid.stable_step)
        diag_warn(d,
                  "numerics.fixed_step = %g s exceeds the solid's stable step of %.4g s, so the "
                  "run will become unstable; use a smaller value, or 0 for automatic steps",
                  fixed, sim->solid.stable_step);
    if (!(sim->effects & FX_COUPLING) || !(fixed > 0)) return;
    int lightest;
    const double bound = coupling_added_mass_step(&sim->coupling, &lightest);
    const struct scene_solid *const b = &scene->solid[lightest];
    if (fixed > bound)
        warn_at(d, scene, b->common.line,
                "[solid %s], %.3g times as dense as the fluid, may gain energy with "
                "numerics.fixed_step = %g s; use at most %.3g s, or 0 for automatic steps",
                b->common.name, b->density / scene->rho0, fixed, bound);
}

static void warn_of_damping(const struct simulation *sim, struct diag *d)
{
    const double free = solid_step_of(square(sim->solid.omega_max), 0);
    if (sim->particles[KIND_SOLID].n == 0 || sim->solid.implicit ||
        !(sim->solid.stable_step < 0.5 * free))
        return;
    for (int k = 0; k < sim->scene->n_solid; k++) {
        const struct scene_solid *const body = &sim->scene->solid[k];
        if (!(body->damping_time > 0)) continue;
        warn_at(d, sim->scene, key_line(sim->scene, SECTION_solid, k, "damping_time"),
                "[solid %s] damping_time = %g s makes the steps of the solid %.3g times shorter; a "
                "shorter damping_time allows longer steps",
                body->common.name, body->damping_time, free / sim->solid.stable_step);
    }
}

/* Bounds below a tenth of the step that sound waves would allow. */
static void warn_of_bounds(const struct simulation *sim, struct diag *d)
{
    static const struct {
        enum bound bound;
        enum section_id section;
        const char *key, *change;
    } owner[] = {{BOUND_diffusion, SECTION_fluid, "density_diffusion", "smaller"},
                 {BOUND_artificial, SECTION_fluid, "artificial_viscosity", "smaller"},
                 {BOUND_repulsion, SECTION_fluid, "wall_repulsion", "smaller"},
                 {BOUND_viscous, SECTION_fluid, "laminar_viscosity", "smaller"},
                 {BOUND_zone, SECTION_damping, "rate", "smaller"},
                 {BOUND_spring, SECTION_spring, "stiffness", "smaller"},
                 {BOUND_fixed, SECTION_numerics, "fixed_step", "larger"}};
    const struct scene *const scene = sim->scene;
    const double acoustic = scene->numerics.cfl * sim->fluid.k.h / sim->fluid.k.c0;
    for (size_t k = 0; k < COUNT_OF(owner); k++) {
        const double bound = sim->dt_bound[owner[k].bound];
        if (!(bound > 0 && bound < 0.1 * acoustic)) continue;
        warn_at(d, scene, key_line(scene, owner[k].section, 0, owner[k].key),
                "%s limits the time step to %.3g s, while sound waves would allow %.3g times as "
                "much. The run becomes longer by this factor; a %s %s may help",
                owner[k].key, bound, acoustic / bound, owner[k].change, owner[k].key);
    }
}

void check_simulation(const struct simulation *sim, struct diag *d)
{
    warn_of_unstable_step(sim, d);
    warn_of_damping(sim, d);
    if (sim->effects & FX_FLUID) warn_of_bounds(sim, d);
}
