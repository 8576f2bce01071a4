/* SPDX-License-Identifier: MIT
 * Writes JSON, indented. A number that JSON cannot say becomes null. */
#ifndef SPHFSI_OUTPUT_JSON_H
#define SPHFSI_OUTPUT_JSON_H

#include <stdint.h>
#include <stdio.h>

struct json {
    FILE *file;
    int depth;
    int filled; /* bit by depth: something stands there already */
};

/* A name of NULL: an item of an array. */
void json_open(struct json *j, const char *name, char bracket);
void json_close(struct json *j, char bracket);
void json_number(struct json *j, const char *name, double value);
void json_integer(struct json *j, const char *name, int64_t value);
void json_text(struct json *j, const char *name, const char *value);
/* An array of numbers in one line. */
void json_numbers(struct json *j, const char *name, const double *values, int n);

#endif
