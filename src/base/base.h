/* SPDX-License-Identifier: MIT
 * Ground floor: errors that explain themselves, aligned memory that fails cleanly, wall clock. */
#ifndef SPHFSI_BASE_H
#define SPHFSI_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SPHFSI_INLINE static inline __attribute__((always_inline))
#define SPHFSI_API __attribute__((visibility("default")))
#define SPHFSI_PRINTF(fmt_index, args_index) __attribute__((format(printf, fmt_index, args_index)))
#define SPHFSI_CHECKED __attribute__((warn_unused_result))
#define COUNT_OF(array) (sizeof(array) / sizeof((array)[0]))

enum err {
#define ERROR(name, status, meaning) ERR_##name,
#include "base/errors.def"
#undef ERROR
};

/* Exit status and one-line meaning of an error, from base/errors.def. */
int err_status(enum err e);
const char *err_meaning(enum err e);

/* What went wrong, in one sentence for the user; filled by the function that fails. */
struct diag {
    enum err code;
    char text[1024];
    /* Receives warnings, one sentence each; NULL: they are dropped. */
    void (*warn)(void *context, const char *text);
    void *warn_context;
};

/* Records a failure (the first one stays) and returns its code: `return diag_fail(d, ERR_IO, ...)`. */
enum err diag_fail(struct diag *d, enum err code, const char *format, ...) SPHFSI_PRINTF(3, 4);
void diag_warn(struct diag *d, const char *format, ...) SPHFSI_PRINTF(2, 3);

/* Passes an error up to the caller. */
#define TRY(call)                     \
    do {                              \
        const enum err err_ = (call); \
        if (err_) return err_;        \
    } while (0)

/* Memory of one simulation: handed out in zeroed, 64-byte aligned pieces, freed as a whole.
 * A zeroed struct arena is a valid empty one. */
struct arena {
    struct arena_block *blocks;
    size_t bytes;  /* handed out so far */
    size_t pieces; /* handed out so far */
    size_t limit;  /* refuse beyond this many bytes; 0: no limit */
};

/* Zeroed memory for count items of the given size, or NULL with the sizes in d. Never NULL for
 * count == 0. A margin of ARENA_MARGIN readable, writable bytes lies before and after each piece,
 * so that a vector load may run over either end. */
void *arena_alloc(struct arena *a, size_t count, size_t size, const char *what, struct diag *d)
    SPHFSI_CHECKED;
void arena_free(struct arena *a);
enum { ARENA_ALIGN = 64, ARENA_MARGIN = 256 };

/* Rehearsal of failing memory: the n-th allocation from now fails (0: the next); negative: off. */
void arena_fail_after(long n);

/* Seconds of the monotonic clock. */
double wall_clock(void);

/* Threads a parallel region will use, 1 without OpenMP; asks for n of them. Threads of the region a call
 * is in, and the index of the calling one. */
int thread_count(void);
void thread_use(int n);
int thread_team(void);
int thread_index(void);

SPHFSI_INLINE double min2(double a, double b) { return a < b ? a : b; }
SPHFSI_INLINE double max2(double a, double b) { return a > b ? a : b; }
SPHFSI_INLINE double square(double a) { return a * a; }

#endif
