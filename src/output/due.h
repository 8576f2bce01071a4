/* SPDX-License-Identifier: MIT
 * The times of an output: the multiples of its interval. */
#ifndef SPHFSI_OUTPUT_DUE_H
#define SPHFSI_OUTPUT_DUE_H

#include <stdint.h>

/* Rounds a time to 12 digits, so that the times k * interval of several outputs are equal where
 * they should be and do not differ by round-off. */
double due_round(double time);

struct due {
    double interval; /* s; 0: never */
    int64_t k;       /* of the next time */
};

double due_time(const struct due *u);
/* Moves on to the first time after `time`. */
void due_pass(struct due *u, double time);

#endif
