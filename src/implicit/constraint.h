/* SPDX-License-Identifier: MIT
 * Hinges within implicit steps (T-90a). */
#pragma once

#include "implicit/implicit.h"

enum err constraint_create(struct implicit *implicit, const struct hinges *hinges, struct arena *a,
                           struct diag *d) SPHFSI_CHECKED;

/* What forces at the hinges do to their points, with the present factors. */
void constraint_factor(struct implicit *implicit, const struct hinges *hinges);

/* Where the points are sought for the time: there, or halfway from where they are. */
void constraint_begin(struct implicit *implicit, struct hinges *hinges,
                      const struct particles *particles, double time, bool middle);

/* Adds to the residual what the hinges' forces must be changed by, so that the solution leads the
 * points to their places. */
void constraint_solve(struct implicit *implicit, struct hinges *hinges,
                      const struct particles *particles);

/* After a step of dt: the hinges' forces and the velocities of their points, for their work. */
void constraint_end(const struct implicit *implicit, struct hinges *hinges,
                    const struct particles *particles, double dt);
