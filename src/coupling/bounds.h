/* SPDX-License-Identifier: MIT
 * Bounds of the time step that the exchange sets. */
#pragma once

#include "coupling/coupling.h"

/* T-35d: largest step with the acceleration of the lightest body as the fluid uses it, s. */
double coupling_added_mass_step(const struct coupling *coupling, int *lightest);

/* T-35g: largest step with the viscous drag at the corners of structures that fluid sticks to,
 * s; INFINITY without any. */
double coupling_drag_step(const struct coupling *coupling);
