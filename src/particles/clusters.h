/* SPDX-License-Identifier: MIT
 * Cluster pair lists, as in Pall and Hess (2013): which clusters of four particles are within
 * reach of each other, by their bounding boxes. Boxes follow the present positions; an older
 * sort makes them larger, but never misses a pair. */
#pragma once

#include "particles/cells.h"
#include "particles/kernel.h"
#include "base/simd.h"

enum {
    BOX_LEFT,
    BOX_RIGHT,
    BOX_DOWN,
    BOX_UP,
    BOX_SIDES,
    CLUSTERS_AROUND = 9 * CELL_CAPACITY / CLUSTER
};

/* Bounding box of each cluster, relative to its cell's centre, in units of h. */
struct cluster_boxes {
    float *side[BOX_SIDES]; /* [clusters] */
};

/* A neighbour cluster in one word: its number, and the column and row of its cell among 3 x 3,
 * where (1, 1) is the cell of the receiving cluster. A flag says that the pair is in the half
 * list (neighbour_clusters_collect with a range). */
enum { CLUSTERS_MOST = 1 << 27, NEIGHBOUR_HALF = 1 << 4 };
SPHFSI_INLINE uint32_t neighbour_code(int32_t cluster, int column, int row)
{
    ASSERT(cluster >= 0 && cluster < CLUSTERS_MOST && column >= 0 && column < 3 && row >= 0 &&
           row < 3);
    return (uint32_t)cluster << 5 | (uint32_t)row << 2 | (uint32_t)column;
}
SPHFSI_INLINE size_t neighbour_number(uint32_t code) { return code >> 5; }
SPHFSI_INLINE unsigned neighbour_column(uint32_t code) { return code & 3; }
SPHFSI_INLINE unsigned neighbour_row(uint32_t code) { return code >> 2 & 3; }
SPHFSI_INLINE bool neighbour_is_half(uint32_t code) { return code >> 4 & 1; }

/* Clusters of one kind, first to end - 1. */
struct cluster_range {
    int32_t first, end;
};

/* The clusters of the active cells first to end - 1; first < end. */
SPHFSI_INLINE struct cluster_range clusters_of(const struct cell_list *list, int32_t first,
                                               int32_t end)
{
    const int32_t last = list->active[end - 1];
    return (struct cluster_range){list->cluster[list->active[first]],
                                  list->cluster[last] + clusters_in(list, last)};
}

/* The clusters of one kind in 3 x 3 cells; boxes relative to the middle cell's centre. */
struct neighbour_clusters {
    _Alignas(64) float side[BOX_SIDES][CLUSTERS_AROUND + LANES_FLOAT];
    _Alignas(64) uint32_t code[CLUSTERS_AROUND + LANES_FLOAT];
    int n;
};

/* The neighbour clusters of one cluster. */
struct cluster_list {
    _Alignas(64) uint32_t code[1 + CLUSTERS_AROUND + LANES_FLOAT];
    int n;
};

/* Allocates the boxes of n clusters. */
enum err cluster_boxes_create(struct cluster_boxes *b, struct arena *a, int64_t n, struct diag *d)
    SPHFSI_CHECKED;

/* The cells with clusters, of 3 x 3: the code of the first cluster of each, and their number. */
struct cells_around {
    uint32_t code[10];
    uint8_t count[10], n;
    bool half; /* the last one is the cell in the middle, whose clusters are served one by one */
};

_Static_assert(CELL_CAPACITY / CLUSTER <= UINT8_MAX, "a number of clusters fits into a byte");

/* Finds those around `cell`. Those within `range` (whole cells; empty: none) only if they are
 * behind it: each pair of these is listed once, flagged NEIGHBOUR_HALF, and serves both clusters.
 * Valid until the next sort. */
void cells_around_find(struct cells_around *around, const struct cells *cells, enum kind kind,
                       int32_t cell, struct cluster_range range);

/* Collects their clusters. */
void neighbour_clusters_copy(struct neighbour_clusters *s, const struct cluster_boxes *boxes,
                             const struct cells_around *around, const struct cells *cells,
                             double h);

/* Finds and collects them at once. */
void neighbour_clusters_collect(struct neighbour_clusters *s, const struct cluster_boxes *boxes,
                                const struct cells *cells, enum kind kind, int32_t cell, double h,
                                struct cluster_range range);

/* Covers the rounding of boxes and positions in single precision. */
#define REACH_MARGIN 1.001
#define FAR_AWAY 1e18f

/* Appends the collected clusters whose box is within reach of the box of `cluster`. */
SPHFSI_INLINE void append_near(struct cluster_list *near, const struct neighbour_clusters *s,
                               const struct cluster_boxes *boxes, size_t cluster)
{
    const vfloat none = vset_float(0), left = vset_float(boxes->side[BOX_LEFT][cluster]),
                 right = vset_float(boxes->side[BOX_RIGHT][cluster]),
                 down = vset_float(boxes->side[BOX_DOWN][cluster]),
                 up = vset_float(boxes->side[BOX_UP][cluster]);
    const float reach2 = (float)square(REACH_MARGIN * KERNEL_REACH);
    const int collected = s->n;
    int n = near->n;
    for (int k = 0; k < collected; k += LANES_FLOAT) {
        const vfloat dx = vmax_float(none, vmax_float(vload_float(&s->side[BOX_LEFT][k]) - right,
                                                      left - vload_float(&s->side[BOX_RIGHT][k])));
        const vfloat dy = vmax_float(none, vmax_float(vload_float(&s->side[BOX_DOWN][k]) - up,
                                                      down - vload_float(&s->side[BOX_UP][k])));
        n += vkeep_below(&near->code[n], &s->code[k], vfma_float(dy, dy, dx * dx), reach2);
    }
    near->n = n;
}

/* Lists the collected clusters within reach (2h) of the box of `cluster`. */
SPHFSI_INLINE void cluster_list_build(struct cluster_list *near, const struct neighbour_clusters *s,
                                      const struct cluster_boxes *boxes, int32_t cluster)
{
    near->n = 0;
    append_near(near, s, boxes, (size_t)cluster);
}

/* With a range: each call serves the next cluster of the cell, the last one first: first itself (no
 * flag), then its neighbours. */
SPHFSI_INLINE void cluster_list_build_half(struct cluster_list *near, struct neighbour_clusters *s,
                                           const struct cluster_boxes *boxes)
{
    const uint32_t own = s->code[s->n];
    near->code[0] = own & ~(uint32_t)NEIGHBOUR_HALF;
    near->n = 1;
    append_near(near, s, boxes, neighbour_number(own));
    /* Removes the next own cluster from the collection. Here and not at the next call: a vector
     * load right after this scalar store would stall. */
    if (s->n-- > 0) s->side[BOX_LEFT][s->n] = FAR_AWAY;
}
