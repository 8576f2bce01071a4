/* SPDX-License-Identifier: MIT
 * A case in several resolutions: the limit of each probe, the order of convergence, and the error band. */
#ifndef SPHFSI_APP_REFINE_H
#define SPHFSI_APP_REFINE_H

#include "sphfsi.h"

#include "base/base.h"

/* Convergence of one value over three resolutions. */
struct convergence {
    bool ordered;  /* monotone with an order of 0.5 or more; else there is no order */
    bool resolved; /* the band is not larger than the finest value; else the values have no limit */
    double order, extrapolated;
    double band;     /* of the finest value, in its unit */
    const char *why; /* why there is no order; "" if there is one */
};

/* `value`: finest first; dp grows by the factor `ratio`. */
struct convergence converge(const double value[3], double ratio);

/* Whether the runs differ in the last part of the time, n rows, by one error that falls with dp. Richardson
 * extrapolation assumes an error C(t) dp^p, so both differences are proportional to C(t) (Roache 1998); here
 * more than half of their squares has to be. Noise has none in common. */
bool errors_agree(const double *fine, const double *middle, const double *coarse, int64_t n);

/* Runs the case at dp * ratio^(runs - 1), ..., dp * ratio, dp in sub-folders of the run's folder, unless a
 * run is already finished. Prints the convergence of probes and energies over the three finest runs, and
 * writes it to refine.json. */
enum err refine_case(const struct sphfsi_options *o, int runs, double ratio, struct diag *d)
    SPHFSI_CHECKED;

#endif
