/* SPDX-License-Identifier: MIT
 * Bounds of the time step that the exchange sets: what one side does, the other side follows a step
 * later. */
#include "coupling/coupling.h"

/* Largest added mass over a particle's own mass, for a body of the fluid's density (T-35d).
 * Measured; results are as good from 1.5 to 2.75 (docs/theory.md). */
#define ADDED_MASS 2

/* T-35d: the fluid's density over that of a body, which has less mass where it is thinner than the
 * layers of fluid on both sides. */
static double added_mass(const struct coupling *coupling, const struct solid_body *body)
{
    const double layers = 2 * coupling->scene->top.dp;
    return coupling->scene->rho0 / body->density * max2(1, layers / body->thickness);
}

double coupling_added_mass_step(const struct coupling *coupling, int *lightest)
{
    const struct solid_body *const body = coupling->solid->body;
    *lightest = 0;
    for (int k = 1; k < coupling->solid->n_bodies; k++)
        if (added_mass(coupling, &body[k]) > added_mass(coupling, &body[*lightest])) *lightest = k;
    const double b = 2 / (1 + ADDED_MASS * added_mass(coupling, &body[*lightest]));
    return averaging_time(coupling) * b /
           ((1 + (acceleration_age(coupling) - 1) * b) * extrapolated_halves(coupling));
}

/* Viscosity stops the particles at the corner of a structure at a rate that is held over a
 * step of the fluid. */
double coupling_drag_step(const struct coupling *coupling)
{
    const struct scene *const scene = coupling->scene;
    const struct fluid_constants *const fluid = &coupling->fluid->k;
    double rate = 0;
    for (int k = 0; k < coupling->solid->n_bodies; k++) {
        if (scene->solid[k].slip != SLIP_NONE) continue;
        const double finer = scene->top.dp / scene_solid_dp(scene, k);
        rate = max2(rate, 8.6 * finer * fluid->model->laminar_viscosity * scene->rho0 /
                              (square(fluid->h) * coupling->solid->body[k].density));
    }
    return rate > 0 ? 0.9 / (2 * (1 + extrapolated_halves(coupling)) * rate) : (double)INFINITY;
}
