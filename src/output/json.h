/* SPDX-License-Identifier: MIT
 * Writes indented JSON. A number that is not finite becomes null. */
#pragma once

#include "base/base.h"

struct json {
    FILE *file;
    int depth;
    int filled; /* bit k: the open object or array of depth k has an item */
};

/* Names are NULL for the items of an array. `bracket`: '{' or '['. */
void json_open(struct json *j, const char *name, char bracket);
void json_close(struct json *j, char bracket);
void json_number(struct json *j, const char *name, double value);
void json_integer(struct json *j, const char *name, int64_t value);
void json_text(struct json *j, const char *name, const char *value);
/* An array of numbers in one line. */
void json_numbers(struct json *j, const char *name, const double *values, int n);
