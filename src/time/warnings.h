/* SPDX-License-Identifier: MIT
 * What a simulation warns of before its first step. */
#ifndef SPHFSI_TIME_WARNINGS_H
#define SPHFSI_TIME_WARNINGS_H

#include "time/simulation.h"

/* What a scene may expect and does not ask for. */
void simulation_warn_of_scene(const struct simulation *s, struct diag *d);

/* Steps that are longer than what is sound; after the rate of the solid's steps has been chosen. */
void simulation_warn_of_steps(const struct simulation *s, struct diag *d);

#endif
