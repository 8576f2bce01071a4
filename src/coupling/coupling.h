/* SPDX-License-Identifier: MIT
 * The exchange between fluid and structure: what it knows, and its part of a step. The order
 * of a step is in README.md. */
#pragma once

#include "fluid/exchange.h"
#include "fluid/fluid.h"
#include "solid/solid.h"

/* Eq. 21b for particles of a kind near fluid that can move, or for all of them (force.h). */
typedef void force_sweep(const struct fluid *fluid, struct particles *particles, enum kind kind,
                         const struct cells *cells, bool all);
extern force_sweep find_force_mixed, find_force_double;

/* All but `multirate`, `impedance` and `lead` are set by its owner. */
struct coupling {
    const struct scene *scene;
    const struct fluid *fluid;
    struct solid *solid;
    struct particles *particles; /* of the solid */
    bool multirate;              /* the structure takes several steps in one of the fluid */
    double impedance;            /* rho0 c0, kg/(m^2 s); 0: without sub-steps */
    double rates_at; /* of the integrator: when its rates are taken, in steps after the start */
    bool alternates; /* of the integrator: two solutions, which share forces and impulses */
    double lead;     /* s: from the last evaluation to the middle of the structure's kicks */
    /* T-35b, s: time over which the fluid receives the interface impulse; of the run's state. */
    double *exchange_time;
};

/* After fluid_evaluate: the force of the fluid on structures, and on walls that move. */
void coupling_find_forces(const struct coupling *coupling, struct particles kinds[KIND_COUNT],
                          const struct cells *cells);

/* Finds the force on all walls, including those at rest; only output needs it. */
void coupling_find_wall_forces(const struct coupling *coupling, struct particles kinds[KIND_COUNT],
                               const struct cells *cells);

/* Sets whether there are sub-steps and an impedance; `effects` has what the bounds of the step have
 * decided. The exchange time begins with the fluid's longest step, or a checkpoint's. */
void coupling_set_rate(struct coupling *coupling, effect_set effects, double longest);

/* --- a step of dt of the fluid --- */

/* Moves the structure ahead, before the evaluation of a predictor with sub-steps. */
void coupling_predict(struct coupling *coupling, double dt);

/* After the evaluation, whose rates act for `rates_time`: n sub-steps of the structure.
 * `first_step`: the run has taken no step yet. Returns the largest displacement of a particle, m.
 */
double coupling_advance(struct coupling *coupling, double dt, int n, double rates_time,
                        bool first_step);

/* --- velocity and acceleration of a structure for the fluid (T-14, T-35) --- */

/* Time over which the acceleration is averaged, s: sound crosses h in it, and the fluid cannot
 * follow anything faster. The acceleration fed back by Eq. 19 contains oscillations of single
 * particles and acts on the fluid's force a step late. Without a mean the gate became
 * unstable: within 400 steps with sub-steps, within 4000 at a single rate. */
SPHFSI_INLINE double averaging_time(const struct coupling *coupling)
{
    return coupling->fluid->k.h / coupling->fluid->k.c0;
}

/* Age of that acceleration in steps, beyond the age due to averaging. It is the mean over a
 * step, half a step old at its end, and half a step older at the corrector of `symplectic`. */
SPHFSI_INLINE double acceleration_age(const struct coupling *coupling)
{
    return 0.5 + coupling->rates_at;
}

/* Time over which the velocity is extrapolated, in half steps (T-35): from the middle of a
 * step to its end, and to the corrector half a step later. At a single rate `symplectic`
 * extrapolates nothing, and has the bounds of the other integrators. */
SPHFSI_INLINE double extrapolated_halves(const struct coupling *coupling)
{
    return coupling->multirate ? 1 + 2 * coupling->rates_at : 1;
}

/* Weight of the acceleration of a step of dt in the mean. */
SPHFSI_INLINE double coupling_acceleration_weight(const struct coupling *coupling, double dt)
{
    return acceleration_weight(averaging_time(coupling), acceleration_age(coupling), dt);
}

/* Single rate: position and velocity of the structure; `weight` of the acceleration in the mean. */
void coupling_move_at_single_rate(struct coupling *coupling, double weight);

/* --- impulse.c: impedance of the fluid in sub-steps, and the impulse (T-35a to T-35e) --- */

/* impulse_begin finds the wetted normals for sub-steps of dt; 0: for an implicit step. impulse_end
 * finds the impulse of the sub-steps, and the pressure that gives it to the fluid. */
void impulse_begin(struct coupling *coupling, double dt);
void impulse_end(struct coupling *coupling);

/* A kick and drift of sub-steps with T-35a. */
solid_kick impedance_kick;

/* T-35b: after an evaluation whose rates act for `rates_time`. */
void impulse_return(struct coupling *coupling, double rates_time);

/* T-35e: the exchange time follows the steps, here one of dt. */
void impulse_set_time(struct coupling *coupling, double dt);

/* Particle i and the fluid have no impulse to exchange. */
void impulse_clear(struct particles *particles, int64_t i);

/* --- bounds of the time step that the exchange sets --- */

/* T-35d: largest step with the acceleration of the lightest body as the fluid uses it, s. */
double coupling_added_mass_step(const struct coupling *coupling, int *lightest);

/* T-35g: largest step with viscous drag at corners that fluid sticks to, s; INFINITY without. */
double coupling_drag_step(const struct coupling *coupling);
