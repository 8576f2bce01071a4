/* SPDX-License-Identifier: MIT
 * Zones in which the fluid is damped, so that waves leave (T-101). */
#pragma once

#include "fluid/fluid.h"

struct damping_zones {
    int n;
    double *taken; /* [n] energy so far, J/m: saved */
    double *power; /* [n] at the last evaluation, W/m */
    double *block; /* sums over blocks of particles, in a fixed order */
};

enum err damping_create(struct damping_zones *damping, struct arena *a, const struct scene *scene,
                        int64_t particles, struct diag *d) SPHFSI_CHECKED;

/* Adds the force of all zones to the accelerations of an evaluation, and finds its power. */
void damping_add(struct damping_zones *damping, const struct scene *scene,
                 const struct fluid_constants *k, struct particles *particles);

/* After a step: the energy that its evaluation has taken in dt. */
void damping_book(struct damping_zones *damping, double dt);

/* Energy that all zones have taken so far, J/m. */
double damping_energy(const struct damping_zones *damping);
