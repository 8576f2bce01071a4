/* SPDX-License-Identifier: MIT */
#include "app/due.h"

#include <math.h>

#include "app/session.h"

double due_time(const struct due *u)
{
    return u->interval > 0 ? session_time((double)u->k * u->interval) : (double)INFINITY;
}

bool due_now(const struct due *u, double time, bool at_end)
{
    return due_time(u) <= time || (at_end && u->written < time);
}

void due_pass(struct due *u, double time)
{
    u->written = time;
    while (due_time(u) <= time) u->k++;
}

void due_begin(struct due *u, double interval, double time, bool restart)
{
    u->interval = interval;
    u->k = interval > 0 ? (int64_t)(time / interval) : 0;
    while (restart && due_time(u) < time) u->k++;
    /* A run that stopped at the time of an output may have written it or not. */
    u->k += due_time(u) <= u->written;
}

double due_kept_until(double interval, double time)
{
    if (interval == 0 || session_time(round(time / interval) * interval) == time) return time;
    return nextafter(time, -1);
}
