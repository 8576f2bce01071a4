/* SPDX-License-Identifier: MIT
 * Walls with faces that are not along the lattice: particles in layers that follow the faces. */
#ifndef SPHFSI_GEOMETRY_LAYERS_H
#define SPHFSI_GEOMETRY_LAYERS_H

#include "base/point_grid.h"
#include "geometry/sampling.h"

/* Faces from which layers are measured. A polyline has its own, on the drawn side, and layers
 * through all of its thickness. All other shapes have one common set, and layers as deep as the
 * kernel's reach. */
struct face_set {
    struct point_grid grid; /* the exposed parts of the faces */
    double spacing, depth;  /* of layers; down to which they go, m */
    int first, end;         /* pieces */
};

struct layers {
    struct sampler *g;
    const struct region *region;
    double dp;
    int n_sets;
    struct face_set *set;
    struct point_grid points; /* of the region: of its lattice, of its layers */
    int64_t first;            /* those of the layers start here */
};

/* Sets region->layered for the pieces that need layers. */
enum err layers_find(struct sampler *sampler, struct region *region) SPHFSI_CHECKED;

/* Starts with the faces of the pieces that need layers. */
enum err layers_create(struct layers *l, struct sampler *sampler, const struct region *region)
    SPHFSI_CHECKED;
/* Adds a point of the lattice of the other pieces. */
enum err layers_take(struct layers *l, double x, double y) SPHFSI_CHECKED;
/* Creates all layers. */
enum err layers_trace(struct layers *l) SPHFSI_CHECKED;
/* Adds a point of the lattice behind the last layer, if there is space for it. */
enum err layers_fill(struct layers *l, double x, double y) SPHFSI_CHECKED;

#endif
