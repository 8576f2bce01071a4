/* SPDX-License-Identifier: MIT
 * A case in several resolutions: what each probe converges to, and how far the finest run is off. */
#ifndef SPHFSI_APP_REFINE_H
#define SPHFSI_APP_REFINE_H

#include "sphfsi.h"

#include "base/base.h"

/* What three resolutions say of one value. */
struct convergence {
    bool ordered; /* monotone with an order of 0.5 or more; else there is no order */
    double order, extrapolated;
    double band;     /* of the finest value, in its unit */
    const char *why; /* there is no order; "" where there is */
};

/* `value` finest first, dp growing by `ratio`. */
struct convergence converge(const double value[3], double ratio);

/* Runs dp * ratio^(runs - 1), ..., dp * ratio, dp in sub-folders of the run's folder, those that are not
 * finished yet, and says what the finest three tell of the probes and of the ledger's energies;
 * refine.json holds the same. */
enum err refine_case(const struct sphfsi_options *o, int runs, double ratio, struct diag *d)
    SPHFSI_CHECKED;

#endif
