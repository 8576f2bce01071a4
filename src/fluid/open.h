/* SPDX-License-Identifier: MIT
 * Open boundaries (T-50 to T-54): buffers of particles behind a line that fluid passes. Other
 * particles treat them as fluid. With a given velocity they get their pressure from the fluid
 * across the line, with a given pressure their velocity. A buffer particle that crosses the line
 * becomes fluid, and a copy of it starts at the far end of the buffer. Fluid that crosses the line
 * joins the buffer, and is removed at its far end; at once if the buffer brings fluid in there. */
#pragma once

#include "fluid/fluid.h"

/* Mass, momentum and energy that have entered through a boundary, less those that have left:
 * carried from step to step. The mean flow is outward, m/s; NAN before the first evaluation. */
enum open_sum { OPEN_MOMENTUM_X, OPEN_MOMENTUM_Y, OPEN_ENERGY, OPEN_MEAN_FLOW, OPEN_SUMS };
/* Particles that were created and removed. */
enum open_count { OPEN_ENTERED, OPEN_LEFT, OPEN_COUNTS };

/* Action of a boundary on its buffer at the last evaluation. */
struct open_rate {
    double force[2]; /* N/m */
    double power;    /* W/m */
    double flow;     /* mean velocity out of the fluid, m/s */
};

/* Before, after and at the time of an evaluation. */
enum open_time { OPEN_BEFORE, OPEN_AFTER, OPEN_NOW, OPEN_TIMES };

/* A particle of a buffer: pressure and velocity of the fluid across the line, or given ones. */
struct open_member {
    int32_t particle;
    double p, v[2];
};

struct open_boundaries {
    const struct fluid_constants *k; /* of the fluid; its particles and cells */
    struct particles *particles;
    const struct cells *cells;
    int n;
    struct scene_open *boundary;
    struct scene_open (
        *at)[OPEN_TIMES]; /* the same with velocities that are fixed at these times: */
    double time[OPEN_TIMES];
    double (*sum)[OPEN_SUMS];
    int64_t (*count)[OPEN_COUNTS];
    int64_t next_id;
    struct open_rate *rate;
    int64_t n_members, capacity;
    bool warned;                /* of fluid that ran back and is removed */
    struct open_member *member; /* of all buffers, in the order of memory */
    double *flow;               /* along a line, m/s */
};

/* Number of fluid particles, in all, that a scene with open boundaries has memory for. */
int64_t open_capacity(const struct scene *scene);

/* `o` knows the fluid: k, particles and cells. */
enum err open_create(struct open_boundaries *o, struct arena *a, const struct scene *scene,
                     int64_t next_id, struct diag *d) SPHFSI_CHECKED;

/* The boundary whose buffer a particle belongs to. */
SPHFSI_INLINE const struct scene_open *open_boundary(const struct open_boundaries *o, int64_t i)
{
    return &o->boundary[o->particles->open[i] - 1];
}

/* --- open_fields.c --- */

/* Copies of boundary n for each time. */
enum err open_copy(struct open_boundaries *o, int n, struct arena *a, struct diag *d)
    SPHFSI_CHECKED;

/* Before an evaluation: sets velocities and densities of the buffers at a time, from the fluid
 * alone. `counts`: the state is that between two steps, and its change counts in the account. */
void open_set(struct open_boundaries *o, double time, bool counts);

/* After it: neither forces nor shifts move buffers; the rates store the constraint forces. */
void open_hold(struct open_boundaries *o);

/* After a step: impulse and work of the last rates, and the mean flow. */
void open_add_work(struct open_boundaries *o, double dt);

/* --- open.c --- */

/* Whether a buffer particle is so far inside the fluid that it must be relabelled. */
bool open_due(const struct open_boundaries *o);

/* Before a sorting: relabels, creates and removes particles. */
enum err open_exchange(struct open_boundaries *o, struct diag *d) SPHFSI_CHECKED;

/* After a sorting: finds the particles of the buffers. */
enum err open_list(struct open_boundaries *o, struct diag *d) SPHFSI_CHECKED;

/* Energy brought in through all of them, J/m. */
double open_energy(const struct open_boundaries *o);

/* Resets the sums. */
void open_forget(struct open_boundaries *o);

/* FNV-1a hash of the data carried from step to step, continuing from h. */
uint64_t open_hash(const struct open_boundaries *o, uint64_t h);
