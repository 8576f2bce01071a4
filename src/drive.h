/* SPDX-License-Identifier: MIT
 * What pushes a solid from outside by prescription: loads on a part of a body, and clamps that move. */
#ifndef SPHFSI_DRIVE_H
#define SPHFSI_DRIVE_H

#include "solid.h"

/* One [load] section: its particles are `first` to `end` of the list. */
struct drive_load {
    int section;
    int64_t first, end;
};

struct drive {
    const struct scene *scene;
    int n_loads;
    struct drive_load *load;
    int64_t n_loaded;
    int32_t *loaded;
    double *fx, *fy; /* [n_loaded] before the factor of time, N/m */
    double *factor;  /* [n_loads] now */
    /* Particles of clamps that move; their `free` is 1, so that they feel what they resist. */
    int64_t n_held;
    int32_t *held;
    double *held_power;          /* [n_held] of the clamp, W/m */
    struct motion_state *motion; /* [n_solid] now */
};

/* Finds the particles that loads and moving clamps act on. */
enum err drive_create(struct drive *v, struct arena *a, const struct scene *scene,
                      const struct solid *s, struct particles *p, struct diag *d) SPHFSI_CHECKED;

/* Puts the particles of moving clamps where they are at a time, with their velocity. By one thread. */
void drive_place(struct drive *v, struct particles *p, double time);

/* Takes their faces (interface.h) from the particles of moving clamps: they answer to the clamp, not to the
 * fluid. By one thread. */
void drive_turn_away(const struct drive *v, struct particles *p);

/* Adds the loads to sx, sy; gives the particles of moving clamps the acceleration of their motion. By
 * one thread, after all other forces. */
void drive_forces(struct drive *v, const struct solid *s, struct particles *p, double time);

/* Work of loads and moving clamps over a kick of dt with the last forces, J/m, from the velocities before
 * it: the change of kinetic energy that they have caused, exactly. */
double drive_work(const struct drive *v, const struct particles *p, const double *vx,
                  const double *vy, double dt);

#endif
