/* SPDX-License-Identifier: MIT */
#include "base/threads.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>
#ifdef _OPENMP
#include <omp.h>
#endif

double wall_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int thread_count(void)
{
#ifdef _OPENMP
    return omp_get_max_threads();
#else
    return 1;
#endif
}

void thread_use(int n)
{
#ifdef _OPENMP
    omp_set_num_threads(n);
#else
    (void)n;
#endif
}

int thread_cores(void)
{
#ifdef _OPENMP
    return omp_get_num_procs();
#else
    return 1;
#endif
}

/* Threads that run or wait for a core on the whole machine, this one among them; 0: unknown. */
static int running_threads(void)
{
    int running = 0;
    FILE *const file = fopen("/proc/loadavg", "r");
    if (!file) return 0;
    if (fscanf(file, "%*s %*s %*s %d/", &running) != 1) running = 0;
    fclose(file);
    return running;
}

static int compare_counts(const void *a, const void *b)
{
    const int x = *(const int *)a, y = *(const int *)b;
    return (x > y) - (x < y);
}

int thread_idle_of(int cores, int online, int running)
{
    const int idle = online - (running > 0 ? running - 1 : 0);
    return idle < 1 ? 1 : idle < cores ? idle : cores;
}

int thread_idle_cores(void)
{
    enum { SAMPLES = 7 }; /* their median: many threads run for a moment only */
    int seen[SAMPLES];
    const struct timespec pause = {.tv_nsec = 2000000};
    for (int k = 0; k < SAMPLES; k++) {
        if (k) nanosleep(&pause, NULL);
        seen[k] = running_threads();
    }
    qsort(seen, SAMPLES, sizeof *seen, compare_counts);
    return thread_idle_of(thread_cores(), (int)sysconf(_SC_NPROCESSORS_ONLN), seen[SAMPLES / 2]);
}

/* Two threads were 1.25 times as fast as one where each had 400 particles, 1.6 times with 1300,
 * 1.8 times with 3000 (docs/accuracy.md, "Forecast against reality"). */
int thread_useful(int64_t n)
{
    enum { PARTICLES = 1000 };
    return (int)(n < 2 * PARTICLES ? 1 : n / PARTICLES < INT16_MAX ? n / PARTICLES : INT16_MAX);
}

/* With fewer particles a thread has not one vector of them. */
int thread_limit(int64_t n)
{
    enum { PARTICLES = 16 };
    const int64_t most = n / PARTICLES, cores = (int64_t)THREADS_PER_CORE * thread_cores();
    return (int)(most < 1 ? 1 : most < cores ? most : cores);
}

int thread_team(void)
{
#ifdef _OPENMP
    return omp_get_num_threads();
#else
    return 1;
#endif
}

int thread_index(void)
{
#ifdef _OPENMP
    return omp_get_thread_num();
#else
    return 0;
#endif
}

static locale_t c_locale; /* kept until the program ends */
static pthread_once_t once = PTHREAD_ONCE_INIT;

static void make_c_locale(void) { c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0); }

struct host host_use(struct host settings)
{
    const struct host before = {uselocale(settings.locale), thread_count()};
    if (settings.threads != before.threads) thread_use(settings.threads);
    return before;
}

enum err host_enter(struct host *before, int threads, struct diag *d)
{
    pthread_once(&once, make_c_locale);
    if (!c_locale) return diag_fail(d, ERR_MEMORY, "no memory for the locale \"C\"");
    *before = host_use((struct host){c_locale, threads > 0 ? threads : thread_count()});
    return ERR_OK;
}
