/* SPDX-License-Identifier: MIT
 * The finest resolution that a given time allows. */
#ifndef SPHFSI_APP_BUDGET_H
#define SPHFSI_APP_BUDGET_H

#include "app/session.h"

/* Prints the cost of a few round spacings, and the finest one that runs within `seconds` of wall time on so
 * many threads. Advances the simulation by some steps. */
enum err budget_session(struct session *x, int threads, double seconds,
                        const struct sphfsi_options *o, struct diag *d) SPHFSI_CHECKED;

#endif
