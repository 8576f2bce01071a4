/* SPDX-License-Identifier: MIT
 * Effects, memory, time step and cost of a scene. */
#ifndef SPHFSI_APP_EXPLAIN_H
#define SPHFSI_APP_EXPLAIN_H

#include "app/session.h"

/* Prints them line by line, through the message callback. Takes some steps in memory to measure the cost;
 * writes no file but the cache of costs. */
enum err explain_session(struct session *x, int threads, const struct sphfsi_options *o,
                         struct diag *d) SPHFSI_CHECKED;

/* The same as one text in JSON. */
enum err explain_data(struct session *x, int threads, const struct sphfsi_options *o,
                      struct diag *d) SPHFSI_CHECKED;

#endif
