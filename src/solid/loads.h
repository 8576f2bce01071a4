/* SPDX-License-Identifier: MIT
 * Loads on a part of a solid body, and clamps that move. */
#pragma once

#include "solid/solid.h"

/* One [load] section: its particles are `first` to `end` of the list. */
struct load_region {
    int section;
    int64_t first, end;
    double share;  /* of a particle in the force; or the length of surface that it represents, m */
    double factor; /* of time, now */
    bool varies;   /* with time, beyond `history` */
};

struct loaded {
    int32_t particle;
    double f[2]; /* before the factor of time, N/m */
};

struct loads {
    const struct scene *scene;
    int n_loads;
    struct load_region *load;
    int64_t n_loaded;
    struct loaded *loaded;
    /* Particles of clamps that move; their `free` is 1, so that they record the force on them. */
    int64_t n_held;
    int32_t *held;
    double *held_power;          /* [n_held] of the clamp, W/m, */
    double *held_rise;           /* and the rate at which its acceleration changes that, W/(m s) */
    struct motion_state *motion; /* [n_solid] now */
    int infinite;                /* a [load], counted from 1, whose force was not finite; 0: none */
    bool released; /* loads_forces leaves the particles of moving clamps the forces on them */
};

/* Gives a solid its loads and moving clamps: finds their particles. */
enum err loads_create(struct solid *solid, struct arena *a, const struct scene *scene,
                      struct particles *particles, struct diag *d) SPHFSI_CHECKED;

/* Finds what the clamps do at a time. */
void loads_move(struct loads *v, double time);

/* The motion of particle i of a clamp. */
SPHFSI_INLINE struct motion_point loads_motion(const struct loads *v,
                                               const struct particles *particles, int64_t i)
{
    return motion_of_point(&v->motion[particles->body[i]], particles->X[i], particles->Y[i]);
}

/* Sets position and velocity of the particles of moving clamps at a time. By one thread. */
void loads_place_clamps(struct loads *v, struct particles *particles, double time);

/* Adds the loads to sx, sy; sets the acceleration of the particles of moving clamps to that of
 * their motion. By one thread, after all other forces. */
void loads_forces(struct loads *v, const struct solid *solid, struct particles *particles,
                  double time);

/* Work of loads and moving clamps over a kick of dt with the last forces, J/m, from the velocities
 * before it: the change of kinetic energy that they cause. Adds each body's to `on`. */
double loads_work(const struct loads *v, const struct particles *particles, const double *vx,
                  const double *vy, double dt, double *on);
