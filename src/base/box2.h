/* SPDX-License-Identifier: MIT
 * The smallest box around points. */
#pragma once

#include "base/base.h"

struct box2 {
    double low[2], high[2];
};

/* A box around no point: low is above high. */
SPHFSI_INLINE struct box2 box2_empty(void)
{
    return (struct box2){{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
}

SPHFSI_INLINE void box2_include(struct box2 *b, double x, double y)
{
    b->low[0] = min2(b->low[0], x);
    b->low[1] = min2(b->low[1], y);
    b->high[0] = max2(b->high[0], x);
    b->high[1] = max2(b->high[1], y);
}

SPHFSI_INLINE bool box2_contains(const struct box2 *b, double x, double y)
{
    return x >= b->low[0] && x <= b->high[0] && y >= b->low[1] && y <= b->high[1];
}

SPHFSI_INLINE void box2_corner(const struct box2 *b, int corner, double at[2])
{
    at[0] = corner & 1 ? b->high[0] : b->low[0];
    at[1] = corner & 2 ? b->high[1] : b->low[1];
}

/* Whether the distance between two boxes along each axis is at most `reach`. */
SPHFSI_INLINE bool box2_near(const struct box2 *a, const struct box2 *b, double reach)
{
    bool near = true;
    for (int c = 0; c < 2; c++)
        near &= a->low[c] - b->high[c] <= reach && b->low[c] - a->high[c] <= reach;
    return near;
}
