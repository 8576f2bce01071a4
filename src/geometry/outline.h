/* SPDX-License-Identifier: MIT
 * Outlines of shapes, and which stretches of a horizontal line they cover. */
#ifndef SPHFSI_GEOMETRY_OUTLINE_H
#define SPHFSI_GEOMETRY_OUTLINE_H

#include "case/scene.h"

/* One closed piece: a polygon, or a circle (n == 0). */
struct outline {
    int n;
    double (*pt)[2];
    double centre[2], radius;
    double low[2], high[2]; /* bounding box */
};

/* A region: the union of some shapes, less others. */
struct outlines {
    int n;
    struct outline *item;
    int *shape; /* index of the shape that a piece belongs to */
};

/* Cuts the shapes into pieces: a polyline into one quadrilateral for each segment, with mitred
 * joints, so that neighbours share an edge. */
enum err outlines_of(struct outlines *o, const struct scene *s, const struct shape_list *list,
                     struct arena *a, struct diag *d) SPHFSI_CHECKED;

/* The stretches [from[0], from[1]), [from[2], from[3]) ... of the line at height y that lie inside;
 * returns how many numbers. `from` has room for max(n, 2). Neighbours that share an edge neither
 * overlap nor leave a gap: an edge is intersected with the same arithmetic from both sides. */
int outline_crossings(const struct outline *o, double y, double *from);
/* Room that outline_crossings needs for any piece. */
int outlines_capacity(const struct outlines *o);

bool outline_contains(const struct outline *o, double x, double y, double *scratch);

#endif
