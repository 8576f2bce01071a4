/* SPDX-License-Identifier: MIT */
#include "particles/clusters.h"

enum err cluster_boxes_create(struct cluster_boxes *b, struct arena *a, int64_t n, struct diag *d)
{
    for (int k = 0; k < BOX_SIDES; k++) {
        b->side[k] = arena_alloc(a, (size_t)n, sizeof *b->side[k], "clusters", d);
        if (!b->side[k]) return ERR_MEMORY;
    }
    return ERR_OK;
}

/* The clusters of a cell, one of 3 x 3 whose middle one is in column 1, row 1. */
struct cell_clusters {
    int32_t first, count;
    int column, row;
    uint32_t half; /* NEIGHBOUR_HALF or 0 */
};

/* Writes their boxes, moved by (dx, dy), and codes from item n on; returns the number of items. It
 * copies eight at a time: a cell has four or five, so wider vectors would only store more
 * padding. */
SPHFSI_INLINE int append(struct neighbour_clusters *s, int n, const struct cluster_boxes *boxes,
                         const struct cell_clusters *of, float dx, float dy)
{
    const eight_word ramp = {0, 1, 2, 3, 4, 5, 6, 7};
    const eight_word word = ramp * neighbour_code(1, 0, 0) +
                            (neighbour_code(of->first, of->column, of->row) | of->half);
    ASSERT(n + of->count <= CLUSTERS_AROUND);
    for (int m = 0; m < of->count; m += 8) {
        for (int k = 0; k < BOX_SIDES; k++)
            *(eight_float_at *)&s->side[k][n + m] =
                *(const eight_float_at *)&boxes->side[k][of->first + m] + (k < BOX_DOWN ? dx : dy);
        *(eight_word_at *)&s->code[n + m] = word + neighbour_code(m, 0, 0);
    }
    return n + of->count;
}

/* The rest of the last vector is filled with boxes out of everything's reach. What the loops read
 * is copied first: for the compiler, the stores of append may change everything else. */
void neighbour_clusters_collect(struct neighbour_clusters *s, const struct cluster_boxes *boxes,
                                const struct cells *cells, enum kind kind, int32_t cell, double h,
                                struct cluster_range range)
{
    const struct cluster_boxes box = *boxes;
    const int32_t *const count = cells->kind[kind].count, *const cluster =
                                                              cells->kind[kind].cluster;
    const float side_x = (float)(cells->side[0] / h), side_y = (float)(cells->side[1] / h);
    const int32_t own = cluster[cell], nx = cells->nx;
    const int cx = cell_x(cells, cell), cy = cell_y(cells, cell);
    const int x[] = {cells_wrap(cells, 0, cx - 1), cx, cells_wrap(cells, 0, cx + 1)},
              y[] = {cells_wrap(cells, 1, cy - 1), cy, cells_wrap(cells, 1, cy + 1)};
    int n = 0;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) {
            if (x[column] < 0 || y[row] < 0) continue;
            const int32_t other = y[row] * nx + x[column];
            if (count[other] == 0) continue;
            const bool inside = cluster[other] >= range.first && cluster[other] < range.end;
            if (inside && cluster[other] <= own) continue;
            const struct cell_clusters of = {cluster[other], clusters_of_count(count[other]),
                                             column, row, inside ? NEIGHBOUR_HALF : 0};
            n = append(s, n, &box, &of, (float)(column - 1) * side_x, (float)(row - 1) * side_y);
        }
    const bool half = range.end > range.first;
    const struct cell_clusters of = {own, clusters_of_count(count[cell]), 1, 1, NEIGHBOUR_HALF};
    if (half) n = append(s, n, &box, &of, 0, 0) - 1;
    for (int k = 0; k < BOX_SIDES; k++) vstore_float(&s->side[k][n], vset_float(FAR_AWAY));
    s->n = n;
}
