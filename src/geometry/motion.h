/* SPDX-License-Identifier: MIT
 * Gravity and motions of a scene at a time. */
#pragma once

#include "case/scene.h"

/* Gravity at a time, m/s^2: top.gravity, the value at t = 0, or its expressions in t if given. */
void scene_gravity_at(const struct scene *scene, double t, double g[2]);
bool scene_gravity_varies(const struct scene *scene);

struct motion_state motion_at(const struct scene *scene, int motion_index, double time);

/* Position, velocity and acceleration (x, v and a) of a point with a motion, initially at (X, Y).
 * Used for all prescribed motion: walls for the fluid and for contact, and clamps. */
struct motion_point {
    double x[2], v[2], a[2];
};
struct motion_point motion_of_point(const struct motion_state *m, double X, double Y);

/* The initial place of a point that is now at x. */
void motion_initial(const struct motion_state *m, const double x[2], double X[2]);
