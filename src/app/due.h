/* SPDX-License-Identifier: MIT
 * The times at which an output is written. */
#ifndef SPHFSI_APP_DUE_H
#define SPHFSI_APP_DUE_H

#include "base/base.h"

/* An output at the times k * interval. */
struct due {
    double interval; /* s; 0: never */
    int64_t k;       /* of the next output */
    double written;  /* time of the last output; -1: none */
};

/* Starts at `time`; `written` must be set. `restart`: outputs before `time` are not repeated. */
void due_begin(struct due *u, double interval, double time, bool restart);

double due_time(const struct due *u);
/* Whether to write now; at the end of a run always, unless it was written at this time. */
bool due_now(const struct due *u, double time, bool at_end);
/* Records an output at `time` and moves on to the next. */
void due_pass(struct due *u, double time);

/* The time up to which a restart at `time` keeps rows. The last row of a run may be between two
 * multiples of the interval; a restart drops it, as an uninterrupted run would not have it. */
double due_kept_until(double interval, double time);

#endif
