/* SPDX-License-Identifier: MIT */
#include "particles/clusters.h"

#include "particles/kernel.h"

/* Covers the rounding of boxes and positions in single precision. */
#define REACH_MARGIN 1.001

enum err cluster_boxes_create(struct cluster_boxes *b, struct arena *a, int64_t n, struct diag *d)
{
    for (int k = 0; k < BOX_SIDES; k++) {
        b->side[k] = arena_alloc(a, (size_t)n, sizeof *b->side[k], "clusters", d);
        if (!b->side[k]) return ERR_MEMORY;
    }
    return ERR_OK;
}

#define FAR_AWAY 1e18f

/* Appends the clusters of a cell, one of 3 x 3 whose middle one is in column 1, row 1, with sides
 * in units of h; `half` is NEIGHBOUR_HALF or 0. It copies eight at a time: a
 * cell has four or five, so wider vectors would only store more padding. */
SPHFSI_INLINE void append(struct neighbour_clusters *s, const struct cluster_boxes *boxes,
                          const struct cell_list *list, int32_t cell, const float side[2],
                          int column, int row, uint32_t half)
{
    const float dx = (float)(column - 1) * side[0], dy = (float)(row - 1) * side[1];
    const int32_t first = list->cluster[cell], count = clusters_in(list, cell);
    const eight_word ramp = {0, 1, 2, 3, 4, 5, 6, 7};
    const eight_word word =
        ramp * neighbour_code(1, 0, 0) + (neighbour_code(first, column, row) | half);
    ASSERT(s->n + count <= CLUSTERS_AROUND);
    for (int m = 0; m < count; m += 8) {
        const int to = s->n + m;
        for (int k = 0; k < BOX_SIDES; k++)
            *(eight_float_at *)&s->side[k][to] =
                *(const eight_float_at *)&boxes->side[k][first + m] + (k < BOX_DOWN ? dx : dy);
        *(eight_word_at *)&s->code[to] = word + neighbour_code(m, 0, 0);
    }
    s->n += count;
}

/* The rest of the last vector is filled with boxes out of everything's reach. */
void neighbour_clusters_collect(struct neighbour_clusters *s, const struct cluster_boxes *boxes,
                                const struct cells *cells, enum kind kind, int32_t cell, double h,
                                struct cluster_range range)
{
    const struct cell_list *const list = &cells->kind[kind];
    const float side[] = {(float)(cells->side[0] / h), (float)(cells->side[1] / h)};
    int x[3];
    for (int column = 0; column < 3; column++)
        x[column] = cells_wrap(cells, 0, cell_x(cells, cell) + column - 1);
    s->n = 0;
    for (int row = 0; row < 3; row++) {
        const int y = cells_wrap(cells, 1, cell_y(cells, cell) + row - 1);
        for (int column = 0; column < 3 && y >= 0; column++) {
            const int32_t other = y * cells->nx + x[column];
            if (x[column] < 0 || list->count[other] == 0) continue;
            const int32_t first = list->cluster[other];
            const bool inside = first >= range.first && first < range.end;
            if (inside && first <= list->cluster[cell]) continue;
            append(s, boxes, list, other, side, column, row, inside ? NEIGHBOUR_HALF : 0);
        }
    }
    const bool half = range.end > range.first;
    if (half) append(s, boxes, list, cell, side, 1, 1, NEIGHBOUR_HALF);
    s->n -= half;
    for (int k = 0; k < BOX_SIDES; k++) vstore_float(&s->side[k][s->n], vset_float(FAR_AWAY));
}

/* Appends the collected clusters whose box is within reach of the box of `cluster`. */
SPHFSI_INLINE void append_near(struct cluster_list *near, const struct neighbour_clusters *s,
                               const struct cluster_boxes *boxes, size_t cluster)
{
    const vfloat none = vset_float(0), left = vset_float(boxes->side[BOX_LEFT][cluster]),
                 right = vset_float(boxes->side[BOX_RIGHT][cluster]),
                 down = vset_float(boxes->side[BOX_DOWN][cluster]),
                 up = vset_float(boxes->side[BOX_UP][cluster]);
    const float reach2 = (float)square(REACH_MARGIN * KERNEL_REACH);
    int n = near->n;
    for (int k = 0; k < s->n; k += LANES_FLOAT) {
        const vfloat dx = vmax_float(none, vmax_float(vload_float(&s->side[BOX_LEFT][k]) - right,
                                                      left - vload_float(&s->side[BOX_RIGHT][k])));
        const vfloat dy = vmax_float(none, vmax_float(vload_float(&s->side[BOX_DOWN][k]) - up,
                                                      down - vload_float(&s->side[BOX_UP][k])));
        n += vkeep_below(&near->code[n], &s->code[k], vfma_float(dy, dy, dx * dx), reach2);
    }
    near->n = n;
}

void cluster_list_build(struct cluster_list *near, const struct neighbour_clusters *s,
                        const struct cluster_boxes *boxes, int32_t cluster)
{
    near->n = 0;
    append_near(near, s, boxes, (size_t)cluster);
}

void cluster_list_build_half(struct cluster_list *near, struct neighbour_clusters *s,
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
