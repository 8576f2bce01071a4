/* SPDX-License-Identifier: MIT
 * Number and index of OpenMP threads; one thread in a build without OpenMP. And the wall clock. */
#ifndef SPHFSI_BASE_THREADS_H
#define SPHFSI_BASE_THREADS_H

#include <stdint.h>

/* Threads of one core, at most. */
enum { THREADS_PER_CORE = 4 };

/* Threads of the next parallel region; sets that number. */
int thread_count(void);
void thread_use(int n);

/* Cores that this process may use, and how many of them are idle now, at least 1. The second takes some
 * milliseconds; where the system does not tell, all are idle. */
int thread_cores(void);
int thread_idle_cores(void);

/* Of `cores` that may be used on a machine of `online`, those idle while `running` threads run, this one
 * among them. */
int thread_idle_of(int cores, int online, int running);

/* Threads that n particles keep busy; the most that they may be asked to occupy. */
int thread_useful(int64_t n);
int thread_limit(int64_t n);

/* Inside a parallel region: its number of threads, and the index of the calling thread. */
int thread_team(void);
int thread_index(void);

/* Seconds of the monotonic clock. */
double wall_clock(void);

#endif
