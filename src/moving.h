/* SPDX-License-Identifier: MIT
 * Walls that move: placed by their laws, sorted where they have moved, and left alone while they rest. */
#ifndef SPHFSI_MOVING_H
#define SPHFSI_MOVING_H

#include "cells.h"
#include "scene.h"

/* A wall section that has a motion; its particles are first ... end - 1. */
struct moving_body {
    int section, motion;
    int64_t first, end;
    struct motion_state placed; /* where it was put last, if `known` */
    bool known;
    bool rests; /* placed without velocity */
};

struct moving {
    int n;
    struct moving_body *body;
    bool moved;        /* any wall, since the last sorting */
    bool idle_is_work; /* numerics.idle = work: nothing is left alone */
};

enum err moving_create(struct moving *m, struct arena *a, const struct scene *s,
                       const struct particles *walls, struct diag *d) SPHFSI_CHECKED;

/* Puts moving walls where they are at a time, with their velocity and acceleration. */
void moving_place(struct moving *m, const struct scene *s, struct particles *walls, double time);

/* Sorts the walls again where any has moved since the last sorting. */
void moving_sort(struct moving *m, struct cells *c, struct particles *walls);

/* Largest speed, squared, and power that the walls give to the fluid, W/m. */
double moving_speed2(const struct moving *m, const struct particles *walls);
double moving_power(const struct moving *m, const struct particles *walls);

#endif
