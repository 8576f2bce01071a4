/* SPDX-License-Identifier: MIT
 * The memory of a simulation: blocks that are allocated one by one and freed together. */
#include "base/threads.h"

#include <stdlib.h>
#ifdef __linux__
#include <sys/mman.h>
#endif

struct arena_block {
    struct arena_block *next;
};

/* The header fills one aligned unit, so that the array after the margin stays aligned. */
enum { BLOCK_HEADER = ARENA_ALIGN };
_Static_assert(sizeof(struct arena_block) <= BLOCK_HEADER && ARENA_MARGIN % ARENA_ALIGN == 0,
               "arrays are aligned");

/* malloc starts large arrays at the same offset in a page. Loops over many arrays would then evict
 * each other from the first-level cache. Each array starts STAGGER_STEP bytes later instead. */
enum { STAGGER_STEP = 3 * ARENA_ALIGN, STAGGER_RANGE = 4096 };

enum { LARGE_PAGE = 1 << 21 };

/* Asks for large pages where the array fills them. Loops over a million particles read some
 * twenty arrays at once: with 4 kB pages that exceeds the TLB. The remainder stays in small
 * pages, so that no memory is wasted. Without support by the system nothing happens. */
static void request_large_pages(unsigned char *raw, size_t bytes)
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

/* Zeroes the memory in parallel, split among the threads as in a static loop: on NUMA machines
 * the system places a page near the core that first touches it. */
static void first_touch(unsigned char *raw, size_t bytes)
{
    enum { PARALLEL_FROM = 1 << 20 };
    const int threads = bytes < PARALLEL_FROM ? 1 : thread_count();
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
        diag_fail(d, ERR_MEMORY,
                  "%s: %zu items of %zu bytes exceed the address space; use a larger dp", what,
                  count, size);
        return NULL;
    }
    const size_t want = (count * size + ARENA_ALIGN - 1) / ARENA_ALIGN * ARENA_ALIGN;
    if (a->limit && (want > a->limit || a->bytes > a->limit - want)) {
        diag_fail(d, ERR_MEMORY,
                  "%s: needs %.3g GB, so the run would use %.3g GB, more than the limit of %.3g "
                  "GB; use a larger dp",
                  what, 1e-9 * (double)want, 1e-9 * (double)(a->bytes + want),
                  1e-9 * (double)a->limit);
        return NULL;
    }
    const size_t stagger = a->pieces++ * STAGGER_STEP % STAGGER_RANGE;
    const size_t total = want + overhead + stagger;
    const size_t align = total >= 2 * (size_t)LARGE_PAGE ? LARGE_PAGE : ARENA_ALIGN;
    const bool injected = fail_countdown >= 0 && fail_countdown-- == 0;
    unsigned char *const raw =
        injected ? NULL : aligned_alloc(align, (total + align - 1) / align * align);
    if (!raw) {
        diag_fail(d, ERR_MEMORY, "%s: no memory for %zu bytes (%zu in use)", what, want, a->bytes);
        return NULL;
    }
    request_large_pages(raw, total);
    first_touch(raw, total);
    struct arena_block *block = (struct arena_block *)(void *)raw;
    block->next = a->blocks;
    a->blocks = block;
    a->bytes += want;
    unsigned char *const array = raw + BLOCK_HEADER + ARENA_MARGIN + stagger;
    ASSERT((uintptr_t)array % ARENA_ALIGN == 0 && array + want + ARENA_MARGIN <= raw + total);
    return array;
}

enum err arena_place(struct arena *a, void *to, size_t count, size_t size, const char *what,
                     struct diag *d)
{
    void *const array = arena_alloc(a, count, size, what, d);
    memcpy(to, &array, sizeof array);
    return array ? ERR_OK : ERR_MEMORY;
}

enum err arena_grow(struct arena *a, void *to, size_t n, size_t size, const char *what,
                    struct diag *d)
{
    void *items, *more;
    memcpy(&items, to, sizeof items);
    if (n & (n - 1)) return ERR_OK;
    TRY(arena_place(a, &more, 2 * n + 1, size, what, d));
    if (n) memcpy(more, items, n * size);
    memcpy(to, &more, sizeof more);
    return ERR_OK;
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
