/* SPDX-License-Identifier: MIT
 * Fluid on both sides of beams: each is a thin line (fluid/lines.h) with the nodes of the beam. */
#ifndef SPHFSI_BEAM_WET_H
#define SPHFSI_BEAM_WET_H

#include "beam/beam.h"
#include "fluid/lines.h"

/* Ties the beams to their lines. */
enum err beams_wet_create(struct beams *beams, struct arena *a, struct lines *lines,
                          struct particles *walls, struct diag *d) SPHFSI_CHECKED;

/* Sets the lines and their dummies to where the beams are `since` after the last step, which took
 * dt. Returns the largest displacement of a dummy, m. */
double beams_place(struct beams *beams, double since, double dt);

/* T-105: the fluid's force on the nodes and its resistance, for a step of dt. The rates of the last
 * evaluation act for `kick`. */
void beams_find_fluid(struct beams *beams, double dt, double kick);

/* After the step: the impulse and pressure that the fluid has still to receive, and the work of the
 * fluid. */
void beams_return_impulse(struct beams *beams, double dt, double kick);

#endif
