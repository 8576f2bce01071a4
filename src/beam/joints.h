/* SPDX-License-Identifier: MIT
 * Clamps and hinges of beams on rigid bodies: forces that are unknowns of the step beside the
 * displacements (T-107). */
#pragma once

#include "beam/beam.h"

enum err beams_joints_create(struct beams *beams, struct arena *a, struct diag *d) SPHFSI_CHECKED;

/* Of the whole step from a time on, which follows as one part or several: the motion of the bodies
 * without the beams; after it, what they have had. */
void beams_take_bodies(struct beams *beams, double time, const struct beam_times *times);
void beams_return_bodies(struct beams *beams, double dt);

/* A part dt of the step: velocities that the joints allow, and no forces yet. */
void beams_begin_joints(struct beams *beams, double time, double dt);

/* Adds the forces of the joints to those of the nodes (`touch` of struct beam_step). */
void beams_add_joints(struct beams *beams);

/* Whether the present displacements of nodes and bodies agree. */
bool beams_stay_joined(const struct beams *beams);

/* Changes forces and bodies, and adds to `unknown`, the correction without a change of the forces,
 * what they change. The matrix has its factors. */
void beams_correct_joints(struct beams *beams);

/* A displacement of the nodes by forces without the bodies, of the last correction: adds what the
 * joints change. */
void beams_resist_joints(const struct beams *beams, double *unknown);

/* After a part of the step. */
void beams_finish_joints(struct beams *beams, double dt);
