/* SPDX-License-Identifier: MIT
 * The exchange between fluid and structure: what it knows, and its part of a step. README.md
 * tells the order. */
#pragma once

#include "fluid/fluid.h"
#include "solid/solid.h"

/* Eq. 21b for particles of a kind near fluid that can move, or for all of them (force.h). */
typedef void force_sweep(const struct fluid *fluid, struct particles *particles, enum kind kind,
                         const struct cells *cells, bool all);
extern force_sweep find_force_mixed, find_force_double;

/* All but `substeps` and `impedance` are set by its owner. */
struct coupling {
    const struct scene *scene;
    const struct fluid *fluid;
    struct solid *solid;
    struct particles *particles; /* of the solid */
    bool substeps;               /* the structure takes several steps in one of the fluid */
    double impedance;            /* rho0 c0, kg/(m^2 s); 0: without sub-steps */
    /* Of the integrator: the evaluation whose rates advance the fluid is this fraction of a
     * step after the step's start; the solid kicks in the middle of its drifts. */
    double ahead;
    bool centred;
    double lead; /* s: from the last evaluation to the middle of the structure's kicks */
    /* T-35b, s: time over which the fluid receives the interface impulse; of the run's state. */
    double *exchange_time;
};

/* After fluid_evaluate: the force of the fluid on structures, and on walls that move. */
void coupling_find_forces(const struct coupling *coupling, struct particles kinds[KIND_COUNT],
                          const struct cells *cells);

/* On all walls, also those at rest, which only output reads. */
void coupling_show_forces(const struct coupling *coupling, struct particles kinds[KIND_COUNT],
                          const struct cells *cells);

/* Sets whether there are sub-steps and an impedance; `effects` has what the bounds of the step
 * have decided. The exchange time begins with the fluid's longest step, or with that of a
 * checkpoint. */
void coupling_set_rate(struct coupling *coupling, effect_set effects, double longest);

/* --- a step of dt of the fluid --- */

/* With a predictor and sub-steps, before its evaluation: moves the structure ahead. */
void coupling_predict(struct coupling *coupling, double dt);

/* After the evaluation, whose rates act on the fluid for `kick`: n sub-steps of the structure.
 * `last` is the step before. Returns the largest displacement of a particle, m. */
double coupling_advance(struct coupling *coupling, double dt, int n, double kick, double last);
