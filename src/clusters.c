/* SPDX-License-Identifier: MIT */
#include "clusters.h"

#include "smoothing.h"

/* A margin for the rounding of boxes and of what lies in them. */
#define REACH_MARGIN 1.001

enum err cluster_boxes_create(struct cluster_boxes *b, struct arena *a, int64_t n, struct diag *d)
{
    for (int k = 0; k < BOX_SIDES; k++) {
        b->side[k] = arena_alloc(a, (size_t)n, sizeof *b->side[k], "clusters", d);
        if (!b->side[k]) return ERR_MEMORY;
    }
    return ERR_OK;
}

/* Appends `count` clusters of one cell from `first` on; `seen` is the word for cluster 0 there. */
static void append(struct surroundings *s, const struct cluster_boxes *boxes, int32_t first,
                   int32_t count, uint32_t seen, float dx, float dy)
{
    const vfloat shift_x = vset_float(dx), shift_y = vset_float(dy);
    for (int m = 0; m < count; m += LANES_FLOAT) {
        for (int k = 0; k < BOX_SIDES; k++)
            vstore_float(&s->side[k][s->n + m], vload_float(&boxes->side[k][first + m]) +
                                                    (k < BOX_DOWN ? shift_x : shift_y));
        vstore_ramp(&s->seen[s->n + m], seen + seen_cluster(first + m, 0, 0),
                    seen_cluster(1, 0, 0));
    }
    s->n += count;
}

void clusters_around(struct surroundings *s, const struct cluster_boxes *boxes,
                     const struct cells *c, enum kind kind, int32_t cell, double h)
{
    const struct cell_list *const list = &c->kind[kind];
    const float side_x = (float)(c->side[0] / h), side_y = (float)(c->side[1] / h);
    const int cx = cell_x(c, cell), cy = cell_y(c, cell);
    int columns[3];
    for (int column = 0; column < 3; column++) columns[column] = cells_place(c, 0, cx + column - 1);
    s->n = 0;
    for (int row = 0; row < 3; row++) {
        const int y = cells_place(c, 1, cy + row - 1);
        for (int column = 0; column < 3 && y >= 0; column++) {
            const int32_t other = y * c->nx + columns[column];
            if (columns[column] < 0 || list->count[other] == 0) continue;
            append(s, boxes, list->cluster[other], clusters_in(list, other),
                   seen_cluster(0, column, row), (float)(column - 1) * side_x,
                   (float)(row - 1) * side_y);
        }
    }
    for (int k = 0; k < BOX_SIDES; k++) vstore_float(&s->side[k][s->n], vset_float(1e18f));
}

void clusters_near(struct cluster_list *near, const struct surroundings *s,
                   const struct cluster_boxes *boxes, int32_t cluster)
{
    const vfloat none = vset_float(0), left = vset_float(boxes->side[BOX_LEFT][cluster]),
                 right = vset_float(boxes->side[BOX_RIGHT][cluster]),
                 down = vset_float(boxes->side[BOX_DOWN][cluster]),
                 up = vset_float(boxes->side[BOX_UP][cluster]);
    const float reach2 = (float)square(REACH_MARGIN * KERNEL_REACH);
    int n = 0;
    for (int k = 0; k < s->n; k += LANES_FLOAT) {
        const vfloat dx = vmax_float(none, vmax_float(vload_float(&s->side[BOX_LEFT][k]) - right,
                                                      left - vload_float(&s->side[BOX_RIGHT][k])));
        const vfloat dy = vmax_float(none, vmax_float(vload_float(&s->side[BOX_DOWN][k]) - up,
                                                      down - vload_float(&s->side[BOX_UP][k])));
        n += vkeep_below(&near->seen[n], &s->seen[k], vfma_float(dy, dy, dx * dx), reach2);
    }
    near->n = n;
}
