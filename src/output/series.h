/* SPDX-License-Identifier: MIT
 * Time series as CSV: a header, then rows that are complete once they can be seen. */
#ifndef SPHFSI_OUTPUT_SERIES_H
#define SPHFSI_OUTPUT_SERIES_H

#include "base/files.h"

struct series {
    char path[PATH_BYTES];
    int fd; /* -1: not open */
    int columns;
};

enum { SERIES_NUMBER = 32, SERIES_MAX_COLUMNS = 256 };

/* Starts the file with its header, column names joined by commas. */
enum err series_create(struct series *s, const char *folder, const char *name, const char *header,
                       struct diag *d) SPHFSI_CHECKED;

/* Goes on with a file that a run left: keeps the rows up to `time`, drops later and torn ones. The
 * header must be the same. `first` (may be NULL) receives the values of the first row, `columns` of
 * them, `last` the time of the last row kept. */
enum err series_resume(struct series *s, const char *folder, const char *name, const char *header,
                       double time, double *first, double *last, struct diag *d) SPHFSI_CHECKED;

/* Appends a row in one write. */
enum err series_row(struct series *s, const double *values, struct diag *d) SPHFSI_CHECKED;

/* Makes the rows last through a power cut. A series that is not open has none. */
enum err series_sync(const struct series *s, struct diag *d) SPHFSI_CHECKED;

void series_close(struct series *s);

/* The shortest text that reads back as the same number; "nan", "inf" as C spells them. */
int series_number(char text[SERIES_NUMBER], double value);

#endif
