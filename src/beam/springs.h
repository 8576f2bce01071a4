/* SPDX-License-Identifier: MIT
 * Springs and mooring lines from a beam to a place, in the step by Newton's method (T-108). */
#pragma once

#include "beam/beam.h"

/* Adds their forces for the present displacements to `touch` of struct beam_step, and the
 * derivative to the matrix. */
void beams_add_springs(struct beams *beams, double dt);

/* Adds half of their stiffnesses to the matrix, as beams and springs are at the start; lines that
 * only pull as if they were taut. */
void beams_stiffen(struct beams *beams);

/* --- for output --- */

/* Energy of the springs of a beam, J/m. */
double beam_spring_energy(const struct beams *beams, int beam);

/* The force of a [spring] at its end `to`; false: it is not of a beam. */
bool beam_spring_force(const struct beams *beams, int spring, double force[2]);
