/* SPDX-License-Identifier: MIT
 * Which clusters of particles lie within reach of each other, by the boxes around them. Boxes are those of
 * where the particles are now: that they were put together when they were last sorted decides how tight the
 * boxes are, and never who is seen. */
#ifndef SPHFSI_PARTICLES_CLUSTERS_H
#define SPHFSI_PARTICLES_CLUSTERS_H

#include "particles/cells.h"
#include "base/simd.h"

enum {
    BOX_LEFT,
    BOX_RIGHT,
    BOX_DOWN,
    BOX_UP,
    BOX_SIDES,
    CLUSTERS_AROUND = 9 * CELL_CAPACITY / CLUSTER
};

/* Smallest and largest coordinates in each cluster, from its cell's centre in units of h. */
struct cluster_boxes {
    float *side[BOX_SIDES]; /* [clusters] */
};

/* A cluster seen from another cell, in one word: its number, the column and row of its cell, 1 being the
 * seeing cell's own, and whether it is ahead (clusters_ahead_around). */
SPHFSI_INLINE uint32_t neighbour_code(int32_t cluster, int column, int row)
{
    return (uint32_t)cluster << 5 | (uint32_t)row << 2 | (uint32_t)column;
}
SPHFSI_INLINE size_t neighbour_number(uint32_t code) { return code >> 5; }
SPHFSI_INLINE unsigned neighbour_column(uint32_t code) { return code & 3; }
SPHFSI_INLINE unsigned neighbour_row(uint32_t code) { return code >> 2 & 3; }
SPHFSI_INLINE bool neighbour_is_ahead(uint32_t code) { return code >> 4 & 1; }
enum { CLUSTERS_MOST = 1 << 27, SEEN_AHEAD = 1 << 4 };

/* Clusters of one kind, first to end - 1. */
struct cluster_range {
    int32_t first, end;
};

/* The clusters of active cells first to end - 1, of which there is one at least. */
SPHFSI_INLINE struct cluster_range clusters_of(const struct cell_list *list, int32_t first,
                                               int32_t end)
{
    const int32_t last = list->active[end - 1];
    return (struct cluster_range){list->cluster[list->active[first]],
                                  list->cluster[last] + clusters_in(list, last)};
}

/* The clusters of one kind in the nine cells around one: their boxes, from that cell's centre. */
struct surroundings {
    _Alignas(64) float side[BOX_SIDES][CLUSTERS_AROUND + LANES_FLOAT];
    _Alignas(64) uint32_t code[CLUSTERS_AROUND + LANES_FLOAT];
    int n;
};

/* Those of them that a cluster has to look at. */
struct cluster_list {
    _Alignas(64) uint32_t code[1 + CLUSTERS_AROUND + LANES_FLOAT];
    int n;
};

/* Room for the boxes of n clusters. */
enum err cluster_boxes_create(struct cluster_boxes *b, struct arena *a, int64_t n, struct diag *d)
    SPHFSI_CHECKED;

/* Looks around a cell. */
void clusters_around(struct surroundings *s, const struct cluster_boxes *boxes,
                     const struct cells *c, enum kind kind, int32_t cell, double h);

/* Lists the clusters around that lie within reach (2h) of a box. */
void clusters_near(struct cluster_list *near, const struct surroundings *s,
                   const struct cluster_boxes *boxes, int32_t cluster);

/* The same with each pair of clusters in a range of whole cells seen once: a cell sees those in later cells
 * of the range (ahead), and all that are outside of it. Its own clusters come in turn, the last one first:
 * each call lists what the next one sees, itself, which is not ahead, and of its cell those still to come. */
void clusters_ahead_around(struct surroundings *s, const struct cluster_boxes *boxes,
                           const struct cells *c, enum kind kind, int32_t cell, double h,
                           struct cluster_range range);
void clusters_ahead_near(struct cluster_list *near, struct surroundings *s,
                         const struct cluster_boxes *boxes);

#endif
