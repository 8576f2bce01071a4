/* SPDX-License-Identifier: MIT
 * Laws of the exchange between fluid and structure (coupling/README.md): T-35e of solids, beams and
 * rigid bodies; T-35c and T-36a of solids and beams. Rigid bodies have T-98 instead. */
#pragma once

#include "base/base.h"

/* T-35e: the time in which the fluid receives an impulse, after a step of dt. */
SPHFSI_INLINE double exchange_time_after(double before, double dt) { return max2(dt, before - dt); }

/* T-35c: weight of a step of dt in the mean acceleration of a structure. The time of the mean is
 * less by the acceleration's age, in steps, but a quarter at least. */
SPHFSI_INLINE double acceleration_weight(double time, double age, double dt)
{
    return dt / (dt + max2(0.25 * time, time - age * dt));
}

/* T-36a: weights of the force, of its mean and of that before, and of the force in the mean. */
struct force_weights {
    double force, mean, before, newest;
};

/* Times in steps: `received`, for which the fluid gets this force; `lead`, from the evaluation to
 * the middle of the structure's kicks. With `alternates` forces of two solutions are averaged. */
SPHFSI_INLINE struct force_weights force_weights(double received, double lead, bool alternates)
{
    return (struct force_weights){received, lead, received + lead - 1, alternates ? 0.5 : 1};
}

/* The force in the middle of the structure's kicks; `part` of it is extrapolated. */
SPHFSI_INLINE double extrapolated_force(const struct force_weights *weights, double force,
                                        double part, bool first, double *mean)
{
    const double before = first ? part : *mean;
    *mean = before + weights->newest * (part - before);
    return weights->force * force + weights->mean * *mean - weights->before * before;
}
