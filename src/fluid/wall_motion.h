/* SPDX-License-Identifier: MIT
 * Walls that move: sorted if they have moved, skipped while they rest. */
#pragma once

#include "fluid/fluid.h"

/* A wall section that has a motion; its particles are first ... end - 1. */
struct moving_wall {
    int section, motion; /* motion -1: of a beam, which places its particles */
    int64_t first, end;
    struct motion_state placed; /* its last position, if `known` */
    bool known;
    bool rests;  /* placed without velocity */
    bool driven; /* by a [motion]: its power on the fluid is work from outside */
};

struct wall_motion {
    int n;
    struct moving_wall *wall;
    bool moved;        /* any wall, since the last sorting */
    double moved_most; /* m; no particle moved further since it was last set to 0 */
    bool never_skip;   /* nothing is skipped; set by tests */
};

enum err wall_motion_create(struct wall_motion *m, struct arena *a, const struct scene *scene,
                            const struct particles *walls, struct diag *d) SPHFSI_CHECKED;

/* Sets position, velocity and acceleration of moving walls at a time. */
void wall_motion_apply(struct wall_motion *m, const struct scene *scene, struct particles *walls,
                       double time);

/* Sorts the walls again if any has moved since the last sorting. */
void wall_motion_sort(struct wall_motion *m, struct cells *cells, struct particles *walls);

/* Largest squared speed; power on the fluid of all walls with a given motion, and of one, W/m. */
double wall_motion_speed2(const struct wall_motion *m, const struct particles *walls);
double wall_motion_power(const struct wall_motion *m, const struct particles *walls);
double moving_wall_power(const struct moving_wall *b, const struct particles *walls);

/* Finds the moving walls that lines follow, and those at which they begin (T-111b). */
void lines_tie(struct lines *lines, const struct wall_motion *m);
