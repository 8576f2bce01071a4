/* SPDX-License-Identifier: MIT */
#include "output/due.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

double due_round(double time)
{
    char text[32];
    snprintf(text, sizeof text, "%.12g", time);
    return strtod(text, NULL);
}

double due_time(const struct due *u)
{
    return u->interval > 0 ? due_round((double)u->k * u->interval) : (double)INFINITY;
}

void due_pass(struct due *u, double time)
{
    const int64_t near = u->interval > 0 ? (int64_t)(time / u->interval) : 0;
    if (near > u->k) u->k = near;
    while (due_time(u) <= time) u->k++;
}
