/* SPDX-License-Identifier: MIT
 * How long a cell list stays valid. Sweeps visit pairs in neighbouring cells only. Two particles
 * of other cells can be within reach only if their overhangs add up to more than the cells' side
 * exceeds the reach. */
#include <math.h>

#include "particles/cells.h"

enum { LEFT, RIGHT, DOWN, UP };

static struct overhang overhang_of(const struct cells *cells, const struct cell_list *list,
                                   const struct particles *particles, int32_t cell)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int32_t k = list->start[cell]; k < list->start[cell] + list->count[cell]; k++) {
        const int32_t i = list->order ? list->order[k] : k;
        low[0] = min2(low[0], particles->x[i]);
        high[0] = max2(high[0], particles->x[i]);
        low[1] = min2(low[1], particles->y[i]);
        high[1] = max2(high[1], particles->y[i]);
    }
    const double left = cells->lower[0] + cell_x(cells, cell) * cells->side[0],
                 bottom = cells->lower[1] + cell_y(cells, cell) * cells->side[1];
    return (struct overhang){{left - low[0], high[0] - left - cells->side[0], bottom - low[1],
                              high[1] - bottom - cells->side[1]}};
}

void cells_measure_overhang(struct cells *cells, enum kind kind, const struct particles *particles)
{
    struct cell_list *const list = &cells->kind[kind];
    double left = -INFINITY, right = left, down = left, up = left;
#pragma omp parallel for schedule(static) reduction(max : left, right, down, up)
    for (int32_t k = 0; k < list->n_active; k++) {
        const struct overhang o = overhang_of(cells, list, particles, list->active[k]);
        left = max2(left, o.side[LEFT]);
        right = max2(right, o.side[RIGHT]);
        down = max2(down, o.side[DOWN]);
        up = max2(up, o.side[UP]);
    }
    list->most = (struct overhang){{left, right, down, up}};
}

double cells_skin_left(const struct cells *cells, double reach)
{
    const struct overhang *const fluid = &cells->kind[KIND_FLUID].most;
    double left = INFINITY;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        if (!cells->kind[kind].n_active) continue;
        const struct overhang *const other = &cells->kind[kind].most;
        for (int to = LEFT; to <= UP; to++) { /* to ^ 1: the opposite side */
            const double excess = cells->side[to / 2] - reach;
            left = min2(left, cells->skin - other->side[to]);
            left = min2(left, excess - (fluid->side[to] + other->side[to ^ 1]));
        }
    }
    return left;
}
