/* SPDX-License-Identifier: MIT
 * Text tables: rows of numbers, or fields with commas between them. */
#pragma once

#include "base/base.h"

/* The line after the one at `at`, or the end of the text. */
const char *csv_next_line(const char *at);

/* Writes a number with as many digits as give back the same bits; "nan" and "inf" as in C. */
enum { NUMBER_TEXT = 32 };
int number_text(char text[NUMBER_TEXT], double value);

/* Field k of a line, without its quotes; NULL: there are fewer. A comma in quotes is part of a
 * field. */
const char *csv_field(const char *line, int k, size_t *length);

/* A table of numbers with a comma, a semicolon or blanks between them. What follows a # is a
 * comment. Names of the columns may come before the first row. Lines end with LF, CR or both. */
enum { CSV_COLUMNS = 32 };
struct csv {
    const char *path;    /* as in messages */
    const char *columns; /* their names as in messages, such as "time (s), value (SI)" */
    int n;               /* their number, CSV_COLUMNS at most */
    bool more;           /* further columns are skipped */
    double limit;        /* largest magnitude of a number */
    char *text;          /* malloc'd */
    const char *at;      /* the next line */
    int line;            /* number of the last line read */
    int lines;           /* of the whole text: at least the number of rows */
    bool begun;          /* names or a row were read */
    struct diag *diag;
};

/* Reads the file into text. ERR_INPUT: it cannot be read, is no text, or is too long. */
enum err csv_open(struct csv *c, const char *file) SPHFSI_CHECKED;
/* 1: a row of n numbers; 0: the end; -1: failed, in the diag. */
int csv_row(struct csv *c, double *row);
void csv_close(struct csv *c);
