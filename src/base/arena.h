/* SPDX-License-Identifier: MIT
 * The memory of one simulation: zeroed, 64-byte aligned arrays that are freed together. */
#pragma once

#include "base/error.h"

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

/* Allocates `count` zeroed items of `size` bytes; NULL, with the sizes in d, if that fails.
 * Never NULL for count == 0. A vector load or store may cross either end of the array by up to
 * ARENA_MARGIN bytes. */
void *arena_alloc(struct arena *a, size_t count, size_t size, const char *what, struct diag *d)
    SPHFSI_CHECKED;
/* The same for the pointer that `to` points at. */
enum err arena_place(struct arena *a, void *to, size_t count, size_t size, const char *what,
                     struct diag *d) SPHFSI_CHECKED;
/* Gives a list of n items, at which `to` points, a place for one more: a larger copy if it is full,
 * as it is at powers of two. The list begins as NULL. */
enum err arena_grow(struct arena *a, void *to, size_t n, size_t size, const char *what,
                    struct diag *d) SPHFSI_CHECKED;
/* Both for items of the type that *to points at. */
#define arena_array(a, to, n, what, d) arena_place(a, to, (size_t)(n), sizeof **(to), what, d)
#define arena_more(a, to, n, what, d) arena_grow(a, to, (size_t)(n), sizeof **(to), what, d)
void arena_free(struct arena *a);

/* For tests: makes the n-th allocation from now fail (0: the next); negative: none. */
void arena_fail_after(long n);
