/* SPDX-License-Identifier: MIT
 * The mean of a structure's acceleration that the fluid uses (T-14, T-35c). */
#ifndef SPHFSI_TIME_FILTER_H
#define SPHFSI_TIME_FILTER_H

#include "time/simulation.h"

/* Time of the mean, s: sound crosses h in it, and the fluid cannot follow anything faster. The
 * acceleration fed back by Eq. 19 contains oscillations of single particles and acts on the fluid's
 * force a step late. Without a mean the gate became unstable: within 400 steps with sub-steps,
 * within 4000 at a single rate. */
SPHFSI_INLINE double smoothing_lag(const struct simulation *s)
{
    return s->fluid.k.h / s->fluid.k.c0;
}

/* Age of that acceleration in steps, beyond the age due to the mean. It is the mean over a step,
 * half a step old at its end, and half a step older at the corrector. Three quarters more are from
 * measurement (docs/theory.md, Sec. 7). */
SPHFSI_INLINE double filter_lead(const struct simulation *s)
{
    return s->scene->top.integrator == INTEGRATOR_SYMPLECTIC ? 1.75 : 1.25;
}

/* Time over which the interface velocity is extrapolated, in half steps (T-35): from the middle of a step
 * to its end, and to the corrector half a step later. At a single rate `symplectic` extrapolates
 * nothing. */
SPHFSI_INLINE double extrapolated_halves(const struct simulation *s)
{
    const bool corrector = s->scene->top.integrator == INTEGRATOR_SYMPLECTIC;
    return corrector && s->effects & FX_MULTIRATE ? 2 : 1;
}

/* The time of the mean after a step of dt with sub-steps, s: reduced by that age, to a quarter at
 * least. */
SPHFSI_INLINE double fluid_eval_lag(const struct simulation *s, double dt)
{
    const double lag = smoothing_lag(s);
    return max2(0.25 * lag, lag - filter_lead(s) * dt);
}

/* Weight of a new value after dt in a mean over smoothing_lag. */
SPHFSI_INLINE double filter_weight(const struct simulation *s, double dt)
{
    return dt / (dt + smoothing_lag(s));
}

#endif
