/* SPDX-License-Identifier: MIT
 * Contact of solids with each other, with walls and with themselves: a surface particle and the
 * line through the surface particles opposite repel each other (docs/theory.md, Contact). */
#ifndef SPHFSI_SOLID_CONTACT_H
#define SPHFSI_SOLID_CONTACT_H

#include "solid/types.h"

/* Laws and surfaces of solids and walls. */
enum err contact_create(struct contact *c, struct arena *a, const struct scene *scene,
                        const struct solid *s, const struct particles *solid, struct diag *d)
    SPHFSI_CHECKED;

/* Examines the state before a step of at most `longest`: whether surfaces may touch within the time
 * `span`, what contact adds to the solid's eigenvalues, and the longest step in which nothing
 * passes. The results do not depend on earlier calls. By one thread; returns `near`. */
bool contact_watch(struct contact *c, const struct particles *p, double time, double longest,
                   double span);

/* The state has been replaced, and walls at rest may be elsewhere: discards all that is known of
 * it. */
void contact_forget(struct contact *c, const struct particles *walls);

/* Adds the accelerations of contact to sx, sy, with walls at their positions at `time`. Inside a
 * parallel region all threads call it together. */
void contact_forces(struct contact *c, const struct solid *s, struct particles *p, double time);

/* Lets the places slide to which friction holds points, after the forces of a step. By one thread. */
void contact_slide(struct contact *c, struct particles *p);

/* Energy of contact, J/m, with walls at their positions at `time`. */
double contact_energy(struct contact *c, const struct particles *p, double time);

/* "[solid a]" or "[wall b]" of a body, walls after solids. */
enum { CONTACT_NAME = 160 };
void contact_name(const struct contact *c, int body, char text[CONTACT_NAME]);

/* --- internal to the files of contact --- */

/* The surfaces of solids and walls: points, edges, weights (solid/contact_surface.c). */
enum err contact_find_surface(struct contact *c, struct arena *a, const struct particles *solid,
                              struct diag *d) SPHFSI_CHECKED;

/* Positions by cell (solid/contact_search.c): memory for n; inserts those of `item`, or 0 to n - 1
 * if it is NULL; calls `found` for each within reach of (x, y). */
enum err contact_grid_create(struct contact_grid *g, struct arena *a, int64_t n, struct diag *d)
    SPHFSI_CHECKED;
void contact_grid_fill(struct contact_grid *g, int64_t n, const uint8_t *skip);
typedef void contact_visit(void *context, int32_t item);
void contact_grid_find(const struct contact_grid *g, double x, double y, double reach,
                       contact_visit *found, void *context);

/* Lists every pair nearer than its reach and margin, by point and edge. */
void contact_list(struct contact *c);

/* Moves points to their positions in the state, those of moving walls to `time`. Lists the pairs
 * again if some point has left the margin. All threads together. */
void contact_place(struct contact *c, const struct particles *p, double time);

/* Friction (solid/contact_friction.c): its memory, also for a list of `most` pairs; adds its forces to those
 * of the pairs; its energy, J/m; its part of the step bound, from the pairs of one point. */
enum err contact_friction_create(struct contact *c, struct arena *a, struct diag *d) SPHFSI_CHECKED;
bool contact_friction_grow(struct contact *c, int64_t most, struct diag *d);
void contact_rub(struct contact *c, struct particles *p);
double contact_friction_energy(struct contact *c, const struct particles *p);
void contact_watch_friction(struct contact *c, const struct particles *p, int64_t first,
                            int64_t end);

/* How much further than half a spacing the outlines of the shapes are from the surface points. */
enum err contact_find_outer(struct contact *c, struct arena *a, struct diag *d) SPHFSI_CHECKED;

/* The law of a point and an edge; not on: they do not interact. */
struct contact_law contact_pair_law(const struct contact *c, int32_t point, int32_t edge);

/* Distance below which a point and an end of an edge repel each other (T-61b). At least half a spacing
 * remains for the overlap. */
SPHFSI_INLINE double contact_reach(const struct contact *c, const struct contact_law *law,
                                   int32_t point, int32_t end)
{
    const double outer = max2(c->outer[point] + c->outer[end], -0.5 * law->spacing);
    return min2(law->began, law->reach + outer);
}

/* A place on an edge: 0 to 1 from a to b, the vector from there to the point, and the reach there. */
struct contact_foot {
    double at, x, y, distance, reach;
    double least_reach; /* of both ends: R of T-61c, the overlap at which the law is infinite, m */
};
/* The nearest place, without a reach; the place where the distance less the reach is smallest. */
struct contact_foot contact_nearest(const struct contact *c, int32_t point, int32_t edge);
struct contact_foot contact_foot(const struct contact *c, const struct contact_law *law,
                                 int32_t point, int32_t edge);

/* r of T-61c: the least reach less the overlap, m. */
SPHFSI_INLINE double contact_left(const struct contact_foot *f)
{
    return f->distance - (f->reach - f->least_reach);
}

/* Whether both parts of a pair belong to one group. */
SPHFSI_INLINE enum contact_with contact_with(const struct contact *c, int32_t point, int32_t edge)
{
    return c->group[point] == c->group[c->edge[edge].a] ? CONTACT_SELF : CONTACT_OTHER;
}

#endif
