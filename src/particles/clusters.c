/* SPDX-License-Identifier: MIT
 * Boxes of clusters, and the search of clusters within reach. */
#include "particles/clusters.h"

enum err cluster_boxes_create(struct cluster_boxes *b, struct arena *a, int64_t n, struct diag *d)
{
    for (int k = 0; k < BOX_SIDES; k++) TRY(arena_array(a, &b->side[k], n, "clusters", d));
    return ERR_OK;
}

void cells_around_find(struct cells_around *around, const struct cells *cells, enum kind kind,
                       int32_t cell, struct cluster_range range)
{
    const struct cell_list *const list = &cells->list[kind];
    const int cx = cell_x(cells, cell), cy = cell_y(cells, cell);
    int n = 0;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) {
            const int32_t other = cell_at(cells, cx + column - 1, cy + row - 1);
            if (other < 0 || list->count[other] == 0) continue;
            const int32_t first = list->cluster[other];
            const bool inside = first >= range.first && first < range.end;
            if (inside && first <= list->cluster[cell]) continue;
            around->code[n] = neighbour_code(first, column, row) | (inside ? NEIGHBOUR_HALF : 0);
            around->count[n++] = (uint8_t)clusters_in(list, other);
        }
    around->half = range.end > range.first;
    if (around->half) {
        around->code[n] = neighbour_code(list->cluster[cell], 1, 1) | NEIGHBOUR_HALF;
        around->count[n++] = (uint8_t)clusters_in(list, cell);
    }
    around->n = (uint8_t)n;
}

/* Copies eight clusters at a time: a cell has four or five, so wider vectors would only store more
 * padding. The rest of the last vector is filled with boxes out of everything's reach. */
void neighbour_clusters_copy(struct neighbour_clusters *s, const struct cluster_boxes *boxes,
                             const struct cells_around *around, const struct cells *cells, double h)
{
    const struct cluster_boxes box = *boxes; /* for the compiler, the stores may change it */
    const float side_x = (float)(cells->side[0] / h), side_y = (float)(cells->side[1] / h);
    const float x[] = {-side_x, 0, side_x}, y[] = {-side_y, 0, side_y};
    const eight_word ramp = {0, 1, 2, 3, 4, 5, 6, 7};
    int n = 0;
    for (int k = 0; k < around->n; k++) {
        const uint32_t code = around->code[k];
        const float dx = x[neighbour_column(code)], dy = y[neighbour_row(code)];
        const eight_word word = ramp * neighbour_code(1, 0, 0) + code;
        ASSERT(n + around->count[k] <= CLUSTERS_AROUND);
        for (int m = 0; m < around->count[k]; m += 8) {
            const size_t from = neighbour_number(code) + (size_t)m;
            for (int side = 0; side < BOX_SIDES; side++)
                *(eight_float_at *)&s->side[side][n + m] =
                    *(const eight_float_at *)&box.side[side][from] + (side < BOX_DOWN ? dx : dy);
            *(eight_word_at *)&s->code[n + m] = word + neighbour_code(m, 0, 0);
        }
        n += around->count[k];
    }
    n -= around->half;
    for (int k = 0; k < BOX_SIDES; k++) vstore_float(&s->side[k][n], vset_float(FAR_AWAY));
    s->n = n;
}

void neighbour_clusters_collect(struct neighbour_clusters *s, const struct cluster_boxes *boxes,
                                const struct cells *cells, enum kind kind, int32_t cell, double h,
                                struct cluster_range range)
{
    struct cells_around around;
    cells_around_find(&around, cells, kind, cell, range);
    neighbour_clusters_copy(s, boxes, &around, cells, h);
}
