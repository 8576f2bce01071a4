/* SPDX-License-Identifier: MIT
 * Warnings of a simulation before its first step. */
#ifndef SPHFSI_TIME_WARNINGS_H
#define SPHFSI_TIME_WARNINGS_H

#include "time/state.h"

/* Steps longer than the stable one; to be called after the rate of the solid's steps has been
 * chosen. */
void simulation_warn_of_steps(const struct simulation *s, struct diag *d);

#endif
