/* SPDX-License-Identifier: MIT
 * Positions of surface points, the distance of a point and an edge, and the list of near ones. */
#ifndef SPHFSI_SOLID_CONTACT_SEARCH_H
#define SPHFSI_SOLID_CONTACT_SEARCH_H

#include "solid/types.h"

/* Loads of a pair: on the point and on both ends of the edge. */
enum { CONTACT_LOADS = 3 };

/* Memory for a list of so many pairs; keeps those listed. */
enum err contact_list_resize(struct contact *contact, int64_t max_pairs, struct diag *d)
    SPHFSI_CHECKED;

/* Lists every pair nearer than its reach and margin, by point and edge. */
void contact_list(struct contact *contact);

/* Moves points to their positions in the state, those of moving walls to `time`; `stale` if some
 * point has left the margin. All threads together. */
void contact_place(struct contact *contact, const struct particles *particles, double time);

/* The law of a point and an edge; not on: they do not interact. */
struct contact_law contact_pair_law(const struct contact *contact, int32_t point, int32_t edge);

/* Distance below which a point and an end of an edge repel each other (T-61b). At least half a
 * spacing remains for the overlap. */
SPHFSI_INLINE double contact_reach(const struct contact *contact, const struct contact_law *law,
                                   int32_t point, int32_t end)
{
    const double outer = max2(contact->outer[point] + contact->outer[end], -0.5 * law->spacing);
    return min2(law->initial, law->reach + outer);
}

/* A place on an edge: 0 to 1 from a to b, the vector from there to the point, and the reach
 * there. */
struct contact_foot {
    double at, x, y, distance, reach;
    double min_reach; /* of both ends: R of T-61c, the overlap at which the law is infinite, m */
};
/* The nearest place, without a reach; the place where the distance less the reach is smallest. */
struct contact_foot contact_nearest(const struct contact *contact, int32_t point, int32_t edge);
struct contact_foot contact_foot(const struct contact *contact, const struct contact_law *law,
                                 int32_t point, int32_t edge);

/* r of T-61c: the least reach less the overlap, m. */
SPHFSI_INLINE double contact_clearance(const struct contact_foot *f)
{
    return f->distance - (f->reach - f->min_reach);
}

/* Whether both parts of a pair belong to one group. */
SPHFSI_INLINE enum contact_with contact_with(const struct contact *contact, int32_t point,
                                             int32_t edge)
{
    return contact->group[point] == contact->group[contact->edge[edge].a] ? CONTACT_SELF
                                                                          : CONTACT_OTHER;
}

#endif
