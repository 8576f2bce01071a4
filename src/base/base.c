/* SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE /* madvise */
#include "base/base.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#ifdef __linux__
#include <sys/mman.h>
#endif
#ifdef _OPENMP
#include <omp.h>
#endif

static const struct {
    int status;
    const char *meaning;
} error_rows[] = {
#define ERROR(name, status, meaning) {status, meaning},
#include "base/errors.def"
#undef ERROR
};

int err_status(enum err e) { return error_rows[e].status; }

const char *err_meaning(enum err e) { return error_rows[e].meaning; }

enum err diag_fail(struct diag *d, enum err code, const char *format, ...)
{
    if (d && d->code == ERR_OK) {
        va_list args;
        va_start(args, format);
        vsnprintf(d->text, sizeof d->text, format, args);
        va_end(args);
        d->code = code;
    }
    return code;
}

void diag_warn(struct diag *d, const char *format, ...)
{
    if (!d || !d->warn) return;
    char text[sizeof d->text];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    d->warn(d->warn_context, text);
}

struct arena_block {
    struct arena_block *next;
};

/* The header takes a whole aligned unit, so that the piece behind the margin stays aligned. */
enum { BLOCK_HEADER = ARENA_ALIGN };

/* The system places large pieces at the start of a page: all arrays would begin at the same lines of the
 * first cache, which has room for eight of them there, and loops run through more. So each begins some lines
 * further into its page than the one before. */
enum { STAGGER_STEP = 3 * ARENA_ALIGN, STAGGER_RANGE = 4096 };

/* Pieces ask for large pages as far as they fill them: loops over a million particles read some
 * twenty arrays beside each other, more pages of 4 kB than a core keeps addresses of. */
enum { LARGE_PAGE = 1 << 21 };

/* What does not fill a page of that size stays in small ones, so that no memory is taken beyond what is asked
 * for. A system that has none goes on without. */
static void ask_for_large_pages(unsigned char *raw, size_t bytes)
{
#ifdef MADV_HUGEPAGE
    const size_t lead = -(uintptr_t)raw & (LARGE_PAGE - 1);
    if (bytes > lead + LARGE_PAGE)
        madvise(raw + lead, (bytes - lead) & ~(size_t)(LARGE_PAGE - 1), MADV_HUGEPAGE);
#else
    (void)raw;
    (void)bytes;
#endif
}

static long fail_countdown = -1;

void arena_fail_after(long n) { fail_countdown = n; }

static bool rehearsed_failure(void)
{
    if (fail_countdown < 0) return false;
    return fail_countdown-- == 0;
}

/* Sets memory to zero, each thread a part like its share of the loops over it: the system lays a page into
 * the memory next to the core that touches it first. */
static void first_touch(unsigned char *raw, size_t bytes)
{
    enum { WORTH_SHARING = 1 << 20 };
    const int threads = bytes < WORTH_SHARING ? 1 : thread_count();
    const size_t part = bytes / (size_t)threads + 1;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (int t = 0; t < threads; t++) {
        const size_t from = (size_t)t * part < bytes ? (size_t)t * part : bytes;
        memset(raw + from, 0, part < bytes - from ? part : bytes - from);
    }
}

void *arena_alloc(struct arena *a, size_t count, size_t size, const char *what, struct diag *d)
{
    const size_t overhead = BLOCK_HEADER + 2 * (size_t)ARENA_MARGIN;
    if (size && count > (SIZE_MAX - overhead - ARENA_ALIGN) / size) {
        diag_fail(d, ERR_MEMORY, "%s: %zu items of %zu bytes are more than memory can address",
                  what, count, size);
        return NULL;
    }
    const size_t want = (count * size + ARENA_ALIGN - 1) / ARENA_ALIGN * ARENA_ALIGN;
    if (a->limit && (want > a->limit || a->bytes > a->limit - want)) {
        diag_fail(d, ERR_MEMORY,
                  "%s: %.3g GB would raise the run to %.3g GB, more than the %.3g GB it may use",
                  what, 1e-9 * (double)want, 1e-9 * (double)(a->bytes + want),
                  1e-9 * (double)a->limit);
        return NULL;
    }
    const size_t stagger = a->pieces++ * STAGGER_STEP % STAGGER_RANGE;
    const size_t all = want + overhead + stagger;
    /* Those that fill large pages begin with one. */
    const size_t align = all >= 2 * (size_t)LARGE_PAGE ? LARGE_PAGE : ARENA_ALIGN;
    unsigned char *const raw =
        rehearsed_failure() ? NULL : aligned_alloc(align, (all + align - 1) / align * align);
    if (!raw) {
        diag_fail(d, ERR_MEMORY, "%s: no memory for %zu bytes (%zu in use)", what, want, a->bytes);
        return NULL;
    }
    ask_for_large_pages(raw, all);
    first_touch(raw, all);
    struct arena_block *block = (struct arena_block *)(void *)raw;
    block->next = a->blocks;
    a->blocks = block;
    a->bytes += want;
    return raw + BLOCK_HEADER + ARENA_MARGIN + stagger;
}

void arena_free(struct arena *a)
{
    while (a->blocks) {
        struct arena_block *next = a->blocks->next;
        free(a->blocks);
        a->blocks = next;
    }
    a->bytes = a->pieces = 0;
}

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
