/* SPDX-License-Identifier: MIT
 * Contact of beams with walls, rigid bodies, other beams and themselves, without friction: a force
 * in the step that keeps their distance at its end (T-106). */
#pragma once

#include "beam/beam.h"

enum { BEAM_TOUCHES = 512 }; /* places that may touch at a time */

enum err beams_contact_create(struct beams *beams, struct arena *a, struct diag *d) SPHFSI_CHECKED;

/* Finds the places of a step of dt from a time on that may touch, for the displacements of its
 * first guess. No force acts there yet. */
void beams_find_touches(struct beams *beams, double time, double dt);

/* Adds the forces of contact to those of the nodes (`touch` of struct beam_step). */
void beams_add_touches(struct beams *beams);

/* Whether the present displacements keep all distances. */
bool beams_keep_apart(const struct beams *beams);

/* Adds to `unknown`, the correction without a change of the forces, what they change. The matrix
 * has its factors. false: there are no such forces, as of a matrix that is not positive. */
bool beams_correct_touches(struct beams *beams);

/* After the step: the work of walls that push, and the forces on rigid bodies. */
void beams_finish_touches(struct beams *beams, double time, double dt);

/* A particle of a solid within `reach` of the middle of a beam, and this beam; -1: none. Solids and
 * beams have no contact. */
int64_t beams_find_solid(const struct beams *beams, const struct particles *solid, double reach,
                         int *beam);
