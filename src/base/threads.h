/* SPDX-License-Identifier: MIT
 * Number and index of OpenMP threads; one thread in a build without OpenMP. And the wall clock. */
#ifndef SPHFSI_BASE_THREADS_H
#define SPHFSI_BASE_THREADS_H

/* Threads of the next parallel region; sets that number. */
int thread_count(void);
void thread_use(int n);

/* Inside a parallel region: its number of threads, and the index of the calling thread. */
int thread_team(void);
int thread_index(void);

/* Seconds of the monotonic clock. */
double wall_clock(void);

#endif
