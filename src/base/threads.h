/* SPDX-License-Identifier: MIT
 * Threads, of which a build without OpenMP has one; the clock; settings of a thread. */
#pragma once

#include "base/base.h"

#include <locale.h>
#if defined __APPLE__
#include <xlocale.h>
#endif

/* Threads of one core, at most. */
enum { THREADS_PER_CORE = 4 };

/* Threads of the next parallel region; sets that number. */
int thread_count(void);
void thread_use(int n);

/* Cores that this process may use. */
int thread_cores(void);

/* Threads that n particles keep busy; the most that they may be asked to occupy. */
int thread_useful(int64_t n);
int thread_limit(int64_t n);

/* The choice between one thread and all by the time that steps take: a thread without a core, on a
 * machine that other programs use, delays all others. Now and then some steps use the other number;
 * the faster one stays. Bits do not depend on it. */
struct team {
    int most, now, chosen; /* threads to use at most, in the next step, and between trials */
    int steps;             /* of the present block */
    double seconds;        /* of the present block */
    double last, each;     /* s a step of `chosen`: in its last block, in the faster of two */
    double settled;        /* the same at the last trial */
    double wait;           /* s until the next trial */
};

void team_begin(struct team *team, int most);

/* Adds a step of that many seconds; returns the number of threads for the next one. */
int team_next(struct team *team, double seconds);

/* Inside a parallel region: its number of threads, and the index of the calling thread. */
int thread_team(void);
int thread_index(void);

/* Seconds of the monotonic clock; and those that this thread has had a core. */
double wall_clock(void);
double thread_clock(void);

/* The clock of phases of steps in this thread: the first of both, or the second one, which is
 * slower to read but does not go on while other programs have the core. */
double phase_clock(void);
void phase_clock_use(bool of_thread);

/* Adds the time since `since` to that of a phase; returns the present time. */
SPHFSI_INLINE double phase_end(double *seconds, double since)
{
    const double now = phase_clock();
    *seconds += now - since;
    return now;
}

/* Settings of the calling thread that the library changes during a call: the locale, since numbers
 * in files have a decimal point, and the number of threads of parallel regions. */
struct host {
    locale_t locale;
    int threads;
};

/* Puts settings in effect for this thread; returns those that were. */
struct host host_use(struct host settings);

/* Sets the locale "C" and, unless it is 0, a number of threads; what was goes to *before. */
enum err host_enter(struct host *before, int threads, struct diag *d) SPHFSI_CHECKED;
