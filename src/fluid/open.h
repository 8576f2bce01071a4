/* SPDX-License-Identifier: MIT
 * Open boundaries (T-50 to T-54): buffers of particles behind a line that fluid passes. To all others they
 * are fluid. Where the velocity is given they take their pressure from the fluid across the line, where the
 * pressure is given their velocity. One that crosses the line becomes fluid, and a copy of it begins at the
 * far end of the buffer; fluid that crosses it joins the buffer, and ends at the far end. */
#ifndef SPHFSI_FLUID_OPEN_H
#define SPHFSI_FLUID_OPEN_H

#include "fluid/fluid.h"

/* What has come in through a boundary, less what has gone: carried from step to step. The mean flow is
 * that out of the fluid, m/s; NAN before the first evaluation. */
enum open_sum { OPEN_MOMENTUM_X, OPEN_MOMENTUM_Y, OPEN_ENERGY, OPEN_MEAN_FLOW, OPEN_SUMS };
/* Particles that were made and ended. */
enum open_count { OPEN_ENTERED, OPEN_LEFT, OPEN_COUNTS };

/* What a boundary does to its buffer, as of the last evaluation. */
struct open_rate {
    double force[2]; /* N/m */
    double power;    /* W/m */
    double flow;     /* mean velocity out of the fluid, m/s */
};

struct open {
    int n;
    struct scene_open *boundary;
    double (*sum)[OPEN_SUMS];
    int64_t (*count)[OPEN_COUNTS];
    int64_t next_id;
    struct open_rate *rate;
    int64_t n_members, capacity;
    int32_t *member;                  /* particles of all buffers, in the order of memory */
    double *seen_p, *seen_u, *seen_v; /* [n_members]: the fluid across the line */
    double *flow;                     /* along a line, m/s */
};

/* Places for fluid that a scene with open boundaries may need in all. */
int64_t open_places(const struct scene *s);

enum err open_create(struct open *o, struct arena *a, const struct scene *s, int64_t next_id,
                     struct diag *d) SPHFSI_CHECKED;

/* Before an evaluation: gives the buffers their velocities and densities at a time, which follow from the
 * fluid alone. `book`: the state is that between two steps, and what it gains counts. */
void open_set(struct open *o, const struct fluid_constants *k, struct particles *p,
              const struct cells *c, double time, bool book);

/* After it: buffers do not answer to forces; what holds them is kept in the rates. */
void open_hold(struct open *o, const struct fluid_constants *k, struct particles *p);

/* After a step: impulse and work of the last rates, and the mean flow. */
void open_book(struct open *o, double dt);

/* Whether a particle of a buffer has come so far into the fluid that it is to be relabelled. */
bool open_due(const struct open *o, const struct particles *p, double dp);

/* Before a sorting: relabels, makes and ends particles. */
enum err open_exchange(struct open *o, const struct fluid_constants *k, struct particles *p,
                       struct diag *d) SPHFSI_CHECKED;

/* After a sorting: finds the particles of the buffers. */
enum err open_list(struct open *o, const struct particles *p, struct diag *d) SPHFSI_CHECKED;

/* Energy brought in through all of them, J/m. */
double open_energy(const struct open *o);

/* Begins the sums anew. */
void open_forget(struct open *o);

/* FNV-1a hash of what is carried from step to step, continuing from h. */
uint64_t open_hash(const struct open *o, uint64_t h);

#endif
