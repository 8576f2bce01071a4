/* SPDX-License-Identifier: MIT
 * What a scene would simulate and what it would cost. */
#ifndef SPHFSI_APP_EXPLAIN_H
#define SPHFSI_APP_EXPLAIN_H

#include "app/session.h"

/* Tells line by line, through the message callback; takes a few steps in memory to know the cost,
 * and writes nothing. */
enum err explain_session(struct session *x, int threads, const struct sphfsi_options *o,
                         struct diag *d) SPHFSI_CHECKED;

#endif
