/* SPDX-License-Identifier: MIT
 * Hashes of bytes and of cells. */
#pragma once

#include "base/base.h"

/* FNV-1a (Fowler, Noll and Vo), 64 bits. Every step is invertible: one changed byte always changes
 * the hash. */
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
