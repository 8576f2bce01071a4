/* SPDX-License-Identifier: MIT
 * The finest resolution that a given time allows. */
#ifndef SPHFSI_APP_BUDGET_H
#define SPHFSI_APP_BUDGET_H

#include "app/session.h"

/* Says what a few round spacings would cost and which is the finest within the wall time
 * with so many threads. Takes steps of the
 * simulation. */
enum err budget_session(struct session *x, int threads, double seconds,
                        const struct sphfsi_options *o, struct diag *d) SPHFSI_CHECKED;

#endif
