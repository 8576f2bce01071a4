/* SPDX-License-Identifier: MIT
 * What nearly every file uses: compiler attributes and functions of scalars, errors, memory,
 * hashes, threads. */
#pragma once

#include <assert.h>
#include <locale.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#if defined __APPLE__
#include <xlocale.h>
#endif

#define SPHFSI_INLINE static inline __attribute__((always_inline))
#define SPHFSI_PRINTF(fmt_index, args_index) __attribute__((format(printf, fmt_index, args_index)))
#define SPHFSI_CHECKED __attribute__((warn_unused_result))
#define COUNT_OF(array) (sizeof(array) / sizeof((array)[0]))

/* An invariant that no input can break; release builds (NDEBUG) do not evaluate it. */
#ifdef NDEBUG
#define ASSERT(condition) ((void)sizeof(condition))
#else
#define ASSERT(condition) assert(condition)
#endif

#define PI 3.14159265358979323846

SPHFSI_INLINE double min2(double a, double b) { return a < b ? a : b; }
SPHFSI_INLINE double max2(double a, double b) { return a > b ? a : b; }
SPHFSI_INLINE double square(double a) { return a * a; }

/* --- errors: a code for the program, one sentence for the user --- */

enum err {
    ERR_OK,
    ERR_INPUT,    /* the case, a file it names, or the command line is wrong; nothing was started */
    ERR_MEMORY,   /* not enough */
    ERR_IO,       /* a file could not be written or read */
    ERR_GUARD,    /* a guard stopped the run: the numerical state is no longer valid */
    ERR_INTERRUPT /* stopped by a signal */
};

/* Exit status of the program for an error. */
int err_status(enum err e);

/* The first failure, and the receiver of warnings. */
struct diag {
    enum err code;
    char text[1024]; /* one sentence: what, where, which value, what to do */
    /* Receives warnings, one sentence each; NULL: warnings are dropped. */
    void (*warn)(void *context, const char *text);
    void *warn_context;
    char more[8192]; /* further failures of the same input, a sentence a line */
};

/* Records a failure unless d holds one; returns `code`: `return diag_fail(d, ERR_IO, ...)`. */
enum err diag_fail(struct diag *d, enum err code, const char *format, ...) SPHFSI_PRINTF(3, 4);
/* As diag_fail, but where d holds a failure already, the sentence is added to `more`. */
enum err diag_add(struct diag *d, enum err code, const char *format, ...) SPHFSI_PRINTF(3, 4);
/* Failures so far. */
int diag_count(const struct diag *d);
void diag_warn(struct diag *d, const char *format, ...) SPHFSI_PRINTF(2, 3);
/* Adds a sentence to `more`; one that does not fit is left out. */
void diag_more(struct diag *d, const char *text);

/* The least whole number not below a ratio, where an excess of 1e-9 of it counts as rounding. */
SPHFSI_INLINE double whole_parts(double ratio) { return ceil(ratio * (1 - 1e-9)); }

/* Returns from the caller if the call fails. */
#define TRY(call)                     \
    do {                              \
        const enum err err_ = (call); \
        if (err_) return err_;        \
    } while (0)

/* --- the memory of one simulation: zeroed, 64-byte aligned arrays that are freed together --- */

enum {
    ARENA_ALIGN = 64,  /* bytes */
    ARENA_MARGIN = 256 /* readable and writable bytes before and after each array */
};

/* A zeroed struct arena is a valid empty one. */
struct arena {
    struct arena_block *blocks;
    size_t bytes;  /* allocated so far */
    size_t pieces; /* arrays allocated so far */
    size_t limit;  /* largest allowed `bytes`; 0: no limit */
};

/* Allocates `count` zeroed items of `size` bytes; NULL, with the sizes in d, if that fails. Never
 * NULL for count == 0. A vector load or store may cross either end by ARENA_MARGIN bytes. */
void *arena_alloc(struct arena *a, size_t count, size_t size, const char *what, struct diag *d)
    SPHFSI_CHECKED;
/* As arena_alloc, for the pointer that `to` points at. */
enum err arena_place(struct arena *a, void *to, size_t count, size_t size, const char *what,
                     struct diag *d) SPHFSI_CHECKED;
/* Gives a list of n items, at which `to` points, a place for one more: a larger copy if it is full,
 * as it is at powers of two. The list begins as NULL. */
enum err arena_grow(struct arena *a, void *to, size_t n, size_t size, const char *what,
                    struct diag *d) SPHFSI_CHECKED;
/* arena_place and arena_grow for items of the type that *to points at. */
#define arena_array(a, to, n, what, d) arena_place(a, to, (size_t)(n), sizeof **(to), what, d)
#define arena_more(a, to, n, what, d) arena_grow(a, to, (size_t)(n), sizeof **(to), what, d)
void arena_free(struct arena *a);

/* For tests: makes the n-th allocation from now fail (0: the next); negative: none. */
void arena_fail_after(long n);

/* --- FNV-1a hashes (Fowler, Noll and Vo), 64 bits --- */

/* Every step is invertible: one changed byte always changes the hash. */
#define HASH_START UINT64_C(0xcbf29ce484222325)
#define HASH_PRIME UINT64_C(0x100000001b3)

/* Continues hash h with n bytes; begin with HASH_START. */
SPHFSI_INLINE uint64_t hash_bytes(uint64_t h, const void *bytes, size_t n)
{
    const unsigned char *const b = bytes;
    for (size_t k = 0; k < n; k++) h = (h ^ b[k]) * HASH_PRIME;
    return h;
}

/* Slot of cell (i, j) of an unbounded grid in a hash table with mask + 1 slots, a power of two. */
SPHFSI_INLINE uint32_t hash_cell(int64_t i, int64_t j, uint32_t mask)
{
    uint64_t key = (uint64_t)i * 0x9E3779B97F4A7C15u ^ (uint64_t)j * 0xC2B2AE3D27D4EB4Fu;
    key ^= key >> 29;
    key *= 0xBF58476D1CE4E5B9u;
    return (uint32_t)(key >> 32) & mask;
}

/* --- threads, of which a build without OpenMP has one; the clock; settings of a thread --- */

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
/* Adds the time since `since` to that of a phase; returns the present time. */
SPHFSI_INLINE double phase_end(double *seconds, double since)
{
    const double now = phase_clock();
    *seconds += now - since;
    return now;
}
void phase_clock_use(bool of_thread);

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
