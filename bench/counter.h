/* SPDX-License-Identifier: MIT
 * Counts instructions of this thread in user space, if machine and system allow it. */
#ifndef SPHFSI_BENCH_COUNTER_H
#define SPHFSI_BENCH_COUNTER_H

#include "base/base.h"

#ifdef __linux__
#include <linux/perf_event.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Descriptor of the counter; -1: none (as on many virtual machines). */
static int counter_open(void)
{
    struct perf_event_attr what;
    memset(&what, 0, sizeof what);
    what.type = PERF_TYPE_HARDWARE;
    what.size = sizeof what;
    what.config = PERF_COUNT_HW_INSTRUCTIONS;
    what.exclude_kernel = 1;
    what.exclude_hv = 1;
    return (int)syscall(SYS_perf_event_open, &what, 0, -1, -1, 0);
}

/* Instructions since counter_open; negative: not readable. */
static double counter_read(int counter)
{
    uint64_t count;
    return counter >= 0 && read(counter, &count, sizeof count) == (ssize_t)sizeof count
               ? (double)count
               : -1;
}
#else
static int counter_open(void) { return -1; }
static double counter_read(int counter)
{
    (void)counter;
    return -1;
}
#endif

#endif
