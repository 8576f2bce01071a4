/* SPDX-License-Identifier: MIT
 * Rows of probes and of the ledger at uniform times, interpolated between the states of a run on
 * both sides of each time; means of probes over time. No step depends on them. */
#pragma once

#include "base/files.h"
#include "output/probes.h"

#include <signal.h>

/* --- series.c: time series as CSV: a header, then rows, each written at once --- */

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

/* --- times of outputs: the multiples of an interval --- */

/* Rounds a time to 12 digits, so that times of several outputs do not differ by round-off. */
double due_round(double time);

struct due {
    double interval; /* s; 0: never */
    int64_t k;       /* of the next time */
};

double due_time(const struct due *u);
/* Moves on to the first time after `time`. */
void due_pass(struct due *u, double time);

/* --- rows --- */

/* The rows of a file. Before the last state and at it: the columns, of which the first is the time,
 * s (-1: that state was not read), and their rates (NAN: not known). */
struct rows {
    const char *name, *header;
    int file;       /* of probes; -1: the ledger */
    int columns;    /* with the time */
    double window;  /* s: the longest `average` of its probes */
    struct due due; /* of the rows after the first */
    double next;    /* s: time of the next row */
    bool *angle;    /* [columns]: rad, from -pi to pi */
    double *before, *before_rate, *now, *now_rate;
    bool whole; /* `now` has all columns, not only what means need */
    struct series series;
};

/* All files of a run, the ledger last. */
struct row_files {
    struct probes *probes;
    bool ledger;                       /* and all rows; false: means only */
    double end;                        /* s: no row is later; the last step passes it */
    const volatile sig_atomic_t *stop; /* no longer 0: a restart writes the rest; or NULL */
    int n;
    struct rows *file;
};

/* Lists the files, or without `ledger` only what the means of probes need. What a restart needs of
 * them becomes the simulation's `carried`. Rows of other files are only formatted. */
enum err rows_create(struct row_files *r, struct probes *p, struct simulation *sim, bool ledger,
                     struct arena *a, struct diag *d) SPHFSI_CHECKED;

/* Creates the files, whose first row will be of the time; or continues those of an earlier run
 * after the time, and reads the first row of the ledger. */
enum err rows_start(struct row_files *r, const char *folder, double time, struct diag *d)
    SPHFSI_CHECKED;
enum err rows_resume(struct row_files *r, const char *folder, double time, struct ledger *first,
                     struct diag *d) SPHFSI_CHECKED;

/* Lets the rows and means follow the simulation from its present state on. */
void rows_follow(struct row_files *r, struct simulation *sim);

/* Makes all rows survive a power failure. */
enum err rows_sync(const struct row_files *r, struct diag *d) SPHFSI_CHECKED;
void rows_close(struct row_files *r);
