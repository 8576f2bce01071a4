/* SPDX-License-Identifier: MIT
 * Clocks, the number of threads that a step uses, and the locale during a call. */
#include "base/threads.h"

#include <pthread.h>
#include <time.h>
#ifdef _OPENMP
#include <omp.h>
#else /* one thread */
static int omp_get_max_threads(void) { return 1; }
static int omp_get_num_procs(void) { return 1; }
static int omp_get_num_threads(void) { return 1; }
static int omp_get_thread_num(void) { return 0; }
static void omp_set_num_threads(int n) { (void)n; }
#endif

static double seconds_of(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

double wall_clock(void) { return seconds_of(CLOCK_MONOTONIC); }
double thread_clock(void) { return seconds_of(CLOCK_THREAD_CPUTIME_ID); }

static _Thread_local clockid_t clock_of_phases = CLOCK_MONOTONIC;

double phase_clock(void) { return seconds_of(clock_of_phases); }

void phase_clock_use(bool of_thread)
{
    clock_of_phases = of_thread ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC;
}

int thread_count(void) { return omp_get_max_threads(); }

void thread_use(int n) { omp_set_num_threads(n); }

int thread_cores(void) { return omp_get_num_procs(); }

/* Two threads were 1.25 times as fast as one where each had 400 particles, 1.6 times with 1300,
 * 1.8 times with 3000 (docs/results/accuracy.md, "Forecast against reality"). */
int thread_useful(int64_t n)
{
    enum { PARTICLES = 1000 };
    return (int)(n < 2 * PARTICLES ? 1 : n / PARTICLES < INT16_MAX ? n / PARTICLES : INT16_MAX);
}

/* A thread has at least one vector of particles, 16 in float. */
int thread_limit(int64_t n)
{
    enum { PARTICLES = 16 };
    const int64_t most = n / PARTICLES, cores = (int64_t)THREADS_PER_CORE * thread_cores();
    return (int)(most < 1 ? 1 : most < cores ? most : cores);
}

int team_next(struct team *team, double seconds)
{
    /* A block is long against the time slice of a scheduler, by which a busy core delays a team. */
    static const double block_seconds = 0.02, pause_in_trials = 50, slower = 1.5;
    team->seconds += seconds;
    team->steps++;
    if (team->most == 1 || team->seconds < block_seconds || team->steps < 2) return team->now;
    const double each = team->seconds / team->steps, spent = team->seconds;
    team->seconds = team->steps = 0;
    if (team->settled == 0) { /* the first block touches memory for the first time */
        team->settled = HUGE_VAL;
        team->last = each;
        return team->now;
    }
    if (team->now != team->chosen) { /* a trial ends */
        if (each < team->each) {
            team->chosen = team->now;
            team->last = each;
        }
        team->settled = min2(each, team->each);
        team->wait = pause_in_trials * spent;
        return team->now = team->chosen;
    }
    team->each = min2(each, team->last); /* a pause of the machine delays a single block */
    team->last = each;
    team->wait -= spent;
    if (team->wait <= 0 || each > slower * team->settled)
        team->now = team->chosen == 1 ? team->most : 1;
    return team->now;
}

void team_begin(struct team *team, int most)
{
    *team = (struct team){.most = most, .now = most, .chosen = most};
}

int thread_team(void) { return omp_get_num_threads(); }

int thread_index(void) { return omp_get_thread_num(); }

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
