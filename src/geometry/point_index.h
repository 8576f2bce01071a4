/* SPDX-License-Identifier: MIT
 * All points of a scene by cell: what lies at a place, also through periodic sides. */
#ifndef SPHFSI_GEOMETRY_POINT_INDEX_H
#define SPHFSI_GEOMETRY_POINT_INDEX_H

#include "base/point_grid.h"
#include "geometry/sampling.h"

/* Kinds of points, one bit each. */
enum { POINT_FLUID = 1, POINT_BODY = 2, POINT_BUFFER = 4, POINT_ANY = 7 };

struct point_index {
    const struct scene *scene;
    struct point_grid table;
    int64_t n;
    double *x, *y;
    int32_t *section; /* of fluid, walls and solids, each from 0 */
    uint8_t *kind;    /* enum kind */
    uint8_t *bit;     /* POINT_FLUID: but not of a buffer; POINT_BODY: of a wall or solid */
};

enum err point_index_create(struct point_index *to, struct sampler *g) SPHFSI_CHECKED;

/* A point of these kinds within a distance of at most dp; -1: none. */
int64_t point_index_at(const struct point_index *of, const double at[2], double within, int kinds);

/* Whether fluid somewhere has nothing beside it. */
bool point_index_surface(const struct point_index *of);

#endif
