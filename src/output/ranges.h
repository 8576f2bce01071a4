/* SPDX-License-Identifier: MIT
 * Ranges of the numbers in a checkpoint. */
#ifndef SPHFSI_OUTPUT_RANGES_H
#define SPHFSI_OUTPUT_RANGES_H

#include "time/simulation.h"

/* What counters may hold in a checkpoint. */
#define COUNTS 0x1p62
/* Beyond what any number of a run is. */
#define FINITE 1e300

/* Refuses a number that was read and that no run can hold, with its name and value. */
enum err range_check(const char *name, double value, double low, double high, struct diag *d)
    SPHFSI_CHECKED;

/* The same for all that a simulation carries from step to step. */
enum err ranges_check(const struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

#endif
