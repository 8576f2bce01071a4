/* SPDX-License-Identifier: MIT
 * A growing set of points in a hash table of square cells. */
#ifndef SPHFSI_GEOMETRY_GRID_H
#define SPHFSI_GEOMETRY_GRID_H

#include "geometry/sampling.h"

struct point_grid {
    int64_t n, capacity;
    double (*pt)[2];
    int32_t *next, *head; /* index + 1; 0: none */
    uint64_t mask;
    double side; /* of a cell; set it first */
};

enum err grid_add(struct point_grid *t, struct sampler *g, double x, double y) SPHFSI_CHECKED;
/* Whether a point of the set is nearer than `distance`. */
bool grid_any_within(const struct point_grid *t, double x, double y, double distance);

#endif
