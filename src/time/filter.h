/* SPDX-License-Identifier: MIT
 * The mean of a structure's acceleration that the fluid uses (T-14, T-35c). */
#ifndef SPHFSI_TIME_FILTER_H
#define SPHFSI_TIME_FILTER_H

#include "time/simulation.h"

/* The acceleration that Eq. 19 feeds back holds oscillations of single particles and acts on the
 * fluid's own force with the delay of a step: as it is, it blew the gate up, with sub-steps
 * within 400 steps and at a single rate within 4000. The fluid cannot follow anything faster than
 * sound crosses h, so it uses the mean over that time, s. */
SPHFSI_INLINE double smoothing_lag(const struct simulation *s)
{
    return s->fluid.k.h / s->fluid.k.c0;
}

/* Steps by which that acceleration is older than the mean alone would make it: half a step goes
 * by until the end of the step that it is the mean of, and half a step more until the corrector;
 * three quarters more by measurement (docs/theory.md, Sec. 7). */
SPHFSI_INLINE double filter_lead(const struct simulation *s)
{
    return s->scene->top.integrator == INTEGRATOR_SYMPLECTIC ? 1.75 : 1.25;
}

/* The time of the mean after a step of dt with sub-steps, s: less by that age, at least a quarter. */
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
