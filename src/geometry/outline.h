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

/* Turns pieces into the axes of a lattice at `angle`; the shapes themselves stay as they are. */
enum err outlines_turn(struct outlines *o, double angle, struct arena *a, struct diag *d)
    SPHFSI_CHECKED;

/* The stretches of the line at height y that are inside `add` and not inside `minus` (NULL: none), as
 * outline_crossings gives them, merged where they touch. `to` and `scratch` each hold outlines_ends of
 * both. */
int outlines_union(const struct outlines *add, const struct outlines *minus, double y, double *to,
                   double *scratch);
/* The most numbers that outline_crossings returns for all pieces together. */
int outlines_ends(const struct outlines *o);

/* Area of `add` less `minus`, by lines no more than `step` apart. */
enum err outlines_area(const struct outlines *add, const struct outlines *minus, double step,
                       double *area, struct arena *a, struct diag *d) SPHFSI_CHECKED;

bool outline_contains(const struct outline *o, double x, double y, double *scratch);

#endif
