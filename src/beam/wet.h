/* SPDX-License-Identifier: MIT
 * Fluid on both sides of beams: each is a thin line (fluid/lines.h) with the nodes of the beam. */
#pragma once

#include "beam/beam.h"
#include "fluid/lines.h"

/* Ties the beams to their lines. `ahead`, `alternates`: as of the integrator (time/state.h). */
enum err beams_wet_create(struct beams *beams, struct arena *a, struct lines *lines,
                          struct particles *walls, double ahead, bool alternates, struct diag *d)
    SPHFSI_CHECKED;

/* Sets the lines and their dummies to where the beams are `since` after the last step. Returns the
 * largest displacement of a dummy, m. */
double beams_place(struct beams *beams, double since);

/* T-105: the fluid's force on the nodes and its resistance, for a step. */
void beams_find_fluid(struct beams *beams, const struct beam_times *times);

/* After the step: the impulse and pressure that the fluid has still to receive, the motion that it
 * uses, and its work. */
void beams_return_impulse(struct beams *beams, const struct beam_times *times);
