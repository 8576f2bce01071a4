/* SPDX-License-Identifier: MIT
 * Time series as CSV: a header, then rows, each written at once. */
#pragma once

#include "base/files.h"
#include "output/probes.h"

struct series {
    char path[PATH_BYTES];
    int fd; /* -1: not open */
    int columns;
};

/* The time, and all columns of all probes that a case may have. */
enum { SERIES_MAX_COLUMNS = 1 + SCENE_MAX_SECTIONS * PROBE_MAX_COLUMNS };

/* Starts the file with its header, column names joined by commas. */
enum err series_create(struct series *s, const char *folder, const char *name, const char *header,
                       struct diag *d) SPHFSI_CHECKED;

/* Continues a file of an earlier run: keeps the rows up to `time` and drops later and incomplete
 * ones. The header must be the same. `first` (or NULL) receives the values of the first row, `last`
 * the time of the last row kept, or -1. */
enum err series_resume(struct series *s, const char *folder, const char *name, const char *header,
                       double time, double *first, double *last, struct diag *d) SPHFSI_CHECKED;

/* Appends a row in one write; of a series that is not open it is formatted only. */
enum err series_row(struct series *s, const double *values, struct diag *d) SPHFSI_CHECKED;

/* Makes the rows survive a power failure; no effect on a series that is not open. */
enum err series_sync(const struct series *s, struct diag *d) SPHFSI_CHECKED;

void series_close(struct series *s);
