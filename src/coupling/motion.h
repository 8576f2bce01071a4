/* SPDX-License-Identifier: MIT
 * The motion of a structure that the fluid uses: velocity wx, wy and acceleration ax, ay
 * (T-14, T-35). */
#pragma once

#include "coupling/coupling.h"

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
    return 0.5 + coupling->ahead;
}

/* Time over which the velocity is extrapolated, in half steps (T-35): from the middle of a
 * step to its end, and to the corrector half a step later. At a single rate `symplectic`
 * extrapolates nothing. */
SPHFSI_INLINE double extrapolated_halves(const struct coupling *coupling)
{
    return coupling->substeps ? 1 + 2 * coupling->ahead : 1;
}

/* Averaging time after a step of dt, s: reduced by that age, to a quarter at least. */
SPHFSI_INLINE double reduced_averaging_time(const struct coupling *coupling, double dt)
{
    const double time = averaging_time(coupling);
    return max2(0.25 * time, time - acceleration_age(coupling) * dt);
}

/* T-35: after sub-steps in a step of dt. */
void motion_after_substeps(struct coupling *coupling, double dt);

/* T-35, with sub-steps: position and velocity `half` ahead. */
void motion_ahead(struct coupling *coupling, double half);

/* Single rate: position and velocity of the structure; a share `weight` of the present acceleration
 * enters the mean. */
void motion_at_single_rate(struct coupling *coupling, double weight);
