/* SPDX-License-Identifier: MIT
 * Inside of scene_sample: regions (geometry/sampling.c), how they meet (geometry/overlap.c), what
 * follows from the points as a whole (geometry/extent.c). */
#ifndef SPHFSI_GEOMETRY_SAMPLING_H
#define SPHFSI_GEOMETRY_SAMPLING_H

#include "particles/particles.h"
#include "geometry/outline.h"

/* What one section covers. Lattice point (i, j) is the centre origin + ((i, j) + 1/2) dp. */
struct region {
    enum kind kind;
    int body; /* index of the section */
    const char *name;
    int line;
    const struct shape_list *list;
    struct outlines add, minus;
    double dp; /* of its lattice, m */
    double origin[2];
    double low[2], high[2];     /* bounding box of the shapes */
    int64_t first[2], count[2]; /* lattice points that the box spans */
    int64_t n;                  /* points inside */
};

struct sampler {
    struct scene *scene;
    struct diag *diag;
    struct arena temp;
    int n_regions;
    struct region *regions; /* solids, walls, fluids: who comes first takes the place */
    unsigned char *mask;    /* of a row */
    double *scratch;        /* crossings of a line */
};

/* All points, region after region. */
struct samples {
    int64_t n;
    double *x, *y;
    int32_t *region;
    uint8_t *clamped;
};

enum err geometry_sample(struct sampler *g, struct samples *p) SPHFSI_CHECKED;

/* Edges off the lattice, thin walls and bodies, gaps too narrow for a particle. */
enum err geometry_check_regions(struct sampler *g) SPHFSI_CHECKED;

/* Applies the rules of overlap and stores the points that remain in the scene. */
enum err geometry_merge(struct sampler *g, const struct samples *p) SPHFSI_CHECKED;

/* Domain in effect; probes inside of what they probe; initial values finite. */
enum err geometry_extent(struct sampler *g) SPHFSI_CHECKED;

/* Warns of scenes that can be simulated and are hardly meant (geometry/doubts.c). */
enum err geometry_warn_of_doubts(struct sampler *g) SPHFSI_CHECKED;

#endif
