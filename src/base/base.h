/* SPDX-License-Identifier: MIT
 * What every file uses: compiler attributes and functions of scalars, errors, memory. */
#pragma once

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

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

/* The least whole number not below a ratio, where an excess of 1e-9 of it counts as rounding. */
SPHFSI_INLINE double whole_parts(double ratio) { return ceil(ratio * (1 - 1e-9)); }

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
