/* SPDX-License-Identifier: MIT
 * When an output is due. */
#ifndef SPHFSI_APP_DUE_H
#define SPHFSI_APP_DUE_H

#include "base/base.h"

/* An output on the grid k * interval of simulated time. */
struct due {
    double interval; /* s; 0: never */
    int64_t k;       /* next one */
    double written;  /* time of the last one; -1: none */
};

/* Begins at `time`, with `written` as it is; `again`: a restart, which does not repeat what lies before. */
void due_begin(struct due *u, double interval, double time, bool again);

double due_time(const struct due *u);
/* At the end of a run everything is due that was not just written. */
bool due_now(const struct due *u, double time, bool at_end);
void due_pass(struct due *u, double time);

/* The time up to which a restart keeps what is written. A row off its grid stands there because a run
 * ended; one that does not end there does not write it. */
double due_kept_until(double interval, double time);

#endif
