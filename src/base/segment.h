/* SPDX-License-Identifier: MIT
 * A point and a segment: the geometry of contact of solids and beams. */
#pragma once

#include "base/base.h"

/* A place on a segment: 0 to 1 from start to end, and the vector from there to the point. */
struct segment_foot {
    double part, offset[2], distance;
};

/* The place where the distance to the point less a reach is smallest, if the reach rises by `rise`
 * from start to end (T-61c); 0: the nearest place. */
SPHFSI_INLINE struct segment_foot segment_foot(const double at[2], const double from[2],
                                               const double to[2], double rise)
{
    const double ex = to[0] - from[0], ey = to[1] - from[1], length2 = ex * ex + ey * ey;
    const double px = at[0] - from[0], py = at[1] - from[1];
    struct segment_foot f = {.offset = {px, py}};
    if (length2 > 0) f.part = (px * ex + py * ey) / length2;
    if (length2 > rise * rise)
        f.part += fabs(px * ey - py * ex) / length2 * rise / sqrt(length2 - rise * rise);
    else if (rise != 0)
        f.part = rise > 0;
    f.part = min2(1, max2(0, f.part));
    /* At an end: bitwise equal to the result of a segment that begins there. */
    if (f.part == 1) {
        f.offset[0] = at[0] - to[0];
        f.offset[1] = at[1] - to[1];
    } else if (f.part > 0) {
        f.offset[0] -= f.part * ex;
        f.offset[1] -= f.part * ey;
    }
    f.distance = sqrt(f.offset[0] * f.offset[0] + f.offset[1] * f.offset[1]);
    return f;
}
