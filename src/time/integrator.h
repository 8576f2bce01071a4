/* SPDX-License-Identifier: MIT
 * The time integrators, each a file of its own. */
#ifndef SPHFSI_TIME_INTEGRATOR_H
#define SPHFSI_TIME_INTEGRATOR_H

#include "time/state.h"

extern const struct integrator integrator_symplectic; /* Eqs. 22-24 */
extern const struct integrator integrator_verlet;     /* Eqs. 25-27 */
extern const struct integrator integrator_leapfrog;   /* T-32a, T-32b */

#endif
