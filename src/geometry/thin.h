/* SPDX-License-Identifier: MIT
 * What thin lines separate (T-110), as they are drawn. */
#pragma once

#include "base/elementary.h"
#include "case/scene.h"

/* T-110: whether a connection crosses a piece of a line, from the sides on which the ends of each
 * lie of the other, for numbers and vectors. Pieces with a common point have the same side for
 * it. */
#define CROSSES(here, there, from, to) \
    ((((here) < 0) ^ ((there) < 0)) & (((from) < 0) ^ ((to) < 0)))

/* The piece from a to b; `to` is the connection, which begins at the origin. */
SPHFSI_INLINE bool crosses_piece(const double to[2], const double a[2], const double b[2])
{
    const double from_a = to[0] * a[1] - to[1] * a[0], from_b = to[0] * b[1] - to[1] * b[0],
                 here = a[0] * b[1] - a[1] * b[0];
    return CROSSES(here, here + from_a - from_b, from_a, from_b);
}

/* A straight part of a line; a place relative to it: along it and to its left, m. */
struct line_part {
    const double *from, *to;
    double length, t[2]; /* direction */
};
SPHFSI_INLINE struct line_part line_part(const double from[2], const double to[2])
{
    const double x = to[0] - from[0], y = to[1] - from[1], length = elementary_hypot(x, y);
    return (struct line_part){from, to, length, {x / length, y / length}};
}
SPHFSI_INLINE void relative_to_part(const struct line_part *part, const double at[2], double to[2])
{
    const double x = at[0] - part->from[0], y = at[1] - part->from[1];
    to[0] = x * part->t[0] + y * part->t[1];
    to[1] = part->t[0] * y - part->t[1] * x;
}
SPHFSI_INLINE void place_on_part(const struct line_part *part, double along, double left,
                                 double at[2])
{
    at[0] = part->from[0] + along * part->t[0] - left * part->t[1];
    at[1] = part->from[1] + along * part->t[1] + left * part->t[0];
}

/* The first line that a connection crosses an odd number of times, from 1; 0: none. */
int geometry_between(const struct scene *scene, const double from[2], const double to[2]);
/* Moves a place beside a line that is nearer to its face than `gap`, or behind it, to this distance
 * from the face; returns whether it did. Without a thickness the line is the face. */
bool geometry_keep_off(const struct scene *scene, double gap, double at[2]);
/* Distance of a place from the nearest line, m; INFINITY: there are none. `left` of it by so much.
 */
double geometry_line_distance(const struct scene *scene, const double at[2], double *left);
