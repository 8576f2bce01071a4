/* SPDX-License-Identifier: MIT
 * Evaluations of the rates. */
#ifndef SPHFSI_TIME_EVALUATION_H
#define SPHFSI_TIME_EVALUATION_H

#include "time/state.h"

/* One evaluation of the fluid's rates and of the fluid's force on the solid, with walls at their
 * positions at `time`. */
void evaluate_fluid(struct simulation *sim, double time);

/* The same for the state at the start of a step. Not repeated if output has just evaluated it. The
 * acoustic damper's density then follows, once a step (T-9b); an evaluation for output changes
 * nothing. */
void evaluate_start(struct simulation *sim);

/* Calls the accelerations of the program that uses the library, for a kind at a time. */
void find_external(struct simulation *sim, enum kind kind, double time);

/* Sets position, velocity and acceleration of moving walls at a time. */
void move_walls(struct simulation *sim, double time);

/* Brings DERIVED fields that output uses (pressure of wall and solid; displacement gradient) up to
 * date without changing the state. */
void simulation_refresh(struct simulation *sim);

#endif
