/* SPDX-License-Identifier: MIT
 * Morton (Z-order) keys: cells close to each other in the plane have close keys. */
#ifndef SPHFSI_PARTICLES_MORTON_H
#define SPHFSI_PARTICLES_MORTON_H

#include "base/base.h"

/* Largest number of cells along an axis: 16 bits each. */
enum { MORTON_CELLS = 1 << 16 };

/* Spreads the low 16 bits of v to the even bits. */
SPHFSI_INLINE uint32_t morton_spread(uint32_t v)
{
    v = (v | (v << 8)) & 0x00ff00ffu;
    v = (v | (v << 4)) & 0x0f0f0f0fu;
    v = (v | (v << 2)) & 0x33333333u;
    return (v | (v << 1)) & 0x55555555u;
}

SPHFSI_INLINE uint32_t morton_key(uint32_t cx, uint32_t cy)
{
    return morton_spread(cx) | (morton_spread(cy) << 1);
}

#endif
