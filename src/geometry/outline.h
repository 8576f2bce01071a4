/* SPDX-License-Identifier: MIT
 * Outlines of shapes, and the intervals of a horizontal line inside them. */
#pragma once

#include "base/box2.h"
#include "case/scene.h"

/* One closed piece: a polygon, or a circle (n == 0). */
struct outline {
    int n;
    double (*pt)[2];
    double centre[2], radius;
    struct box2 box;
};

/* A region: the union of some shapes, minus others. */
struct outlines {
    int n; /* none of a thin line */
    struct outline *item;
    int *shape;      /* index of the shape that a piece belongs to; -1: a beam */
    struct box2 box; /* of all pieces */
};

/* For qsort: by the number that an item begins with. */
int geometry_ascending(const void *a, const void *b);

/* The area of a polygon, positive if its points turn counter-clockwise. */
double polygon_area(int n, double (*const pt)[2]);

/* Cuts the shapes into pieces: a polyline into one quadrilateral for each segment, with mitred
 * joints, so that neighbours share an edge. */
enum err outlines_of(struct outlines *o, const struct scene *scene, const struct shape_list *list,
                     struct arena *a, struct diag *d) SPHFSI_CHECKED;

/* Adds a piece, for which there is memory. */
void outlines_add(struct outlines *o, const struct outline *piece, int shape);

/* The region of a section. */
struct body_outlines {
    struct outlines add, minus;
};
enum err body_outlines_of(struct body_outlines *o, const struct scene *scene,
                          const struct shape_list *shape, const struct shape_list *minus,
                          struct arena *a, struct diag *d) SPHFSI_CHECKED;
bool body_outlines_contain(const struct body_outlines *o, double x, double y);

/* Rotates pieces into the axes of a lattice at `angle`; the shapes themselves do not change. */
enum err outlines_turn(struct outlines *o, double angle, struct arena *a, struct diag *d)
    SPHFSI_CHECKED;

/* The intervals [to[0], to[1]), [to[2], to[3]) ... of the line at height y inside `add` and not
 * inside `minus` (NULL: none), merged where they touch; returns the count of numbers. `to` and
 * `scratch` each hold outlines_ends of both. */
int outlines_union(const struct outlines *add, const struct outlines *minus, double y, double *to,
                   double *scratch);
/* The largest count of ends of intervals on a line inside the pieces, each for itself. */
int outlines_ends(const struct outlines *o);

/* Integrals over `add` less `minus` by lines at most `step` apart, exact for polygons that are
 * apart. */
struct moments {
    double area, x, y, xx, yy; /* of 1, x, y, x^2 and y^2 */
};
enum err outlines_moments(const struct outlines *add, const struct outlines *minus, double step,
                          struct moments *of, struct arena *a, struct diag *d) SPHFSI_CHECKED;

bool outline_contains(const struct outline *o, double x, double y);
/* The first piece that has a point inside, or -1. */
int outlines_find(const struct outlines *o, double x, double y);
/* Whether an edge of any piece is at most `reach` away. */
bool outlines_edge_within(const struct outlines *o, double x, double y, double reach);
