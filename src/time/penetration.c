/* SPDX-License-Identifier: MIT
 * Fluid inside a wall or a solid: fluid particles at the places of the body's own particles. */
#include "time/penetration.h"

#include <math.h>

/* Distance from a particle of a body, in spacings, below which a fluid particle is inside. Fluid at
 * rest is one spacing from the particles at the surface; under high pressure it comes as close as a
 * half. */
#define TAKEN 0.35

/* Whether (x, y) is that close to particle i of a kind, in spacings of its body's reference
 * configuration: the body has rotated and stretched since the start. */
static bool takes(const struct simulation *sim, enum kind kind, int64_t i, double x, double y)
{
    const struct particles *const particles = &sim->kind[kind];
    const double dx = cells_minimum_image(&sim->cells, 0, x - particles->x[i]),
                 dy = cells_minimum_image(&sim->cells, 1, y - particles->y[i]);
    if (kind != KIND_SOLID) return dx * dx + dy * dy < square(TAKEN * sim->scene->top.dp);
    const double xx = 1 + particles->Uxx[i], xy = particles->Uxy[i], yx = particles->Uyx[i],
                 yy = 1 + particles->Uyy[i];
    /* F^-1 times det F: no division. */
    const double X = yy * dx - xy * dy, Y = xx * dy - yx * dx;
    return X * X + Y * Y <
           square(TAKEN * sim->solid.body[particles->body[i]].dp * (xx * yy - xy * yx));
}

/* Whether a wall particle in the cell can be that close to (x, y). At rest the wall particle is in
 * it. */
static bool wall_near(const struct simulation *sim, int32_t cell, double x, double y)
{
    const struct cells *const cells = &sim->cells;
    const double reach = TAKEN * sim->scene->top.dp + (sim->effects & FX_MOTION ? cells->skin : 0);
    return fabs(cells_minimum_image(cells, 0, x - cell_centre_x(cells, cell))) <
               0.5 * cells->side[0] + reach &&
           fabs(cells_minimum_image(cells, 1, y - cell_centre_y(cells, cell))) <
               0.5 * cells->side[1] + reach;
}

/* Whether (x, y) is that close to a wall or solid particle of one cell. */
static bool taken(const struct simulation *sim, int32_t cell, double x, double y)
{
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++) {
        const struct cell_list *const list = &sim->cells.kind[kind];
        if (list->n_active == 0 || list->count[cell] == 0) continue;
        if (kind == KIND_WALL && !wall_near(sim, cell, x, y)) continue;
        for (int32_t j = list->start[cell]; j < list->start[cell] + list->count[cell]; j++)
            if (takes(sim, (enum kind)kind, list->order[j], x, y)) return true;
    }
    return false;
}

int64_t penetration_count(const struct simulation *sim, int64_t *first)
{
    const struct cells *const cells = &sim->cells;
    const struct cell_list *const fluid = &cells->kind[KIND_FLUID];
    const struct particles *const particles = &sim->kind[KIND_FLUID];
    int64_t count = 0, lowest = INT64_MAX;
#pragma omp parallel for schedule(static) reduction(+ : count) reduction(min : lowest)
    for (int32_t k = 0; k < fluid->n_active; k++) {
        const int32_t cell = fluid->active[k];
        if (!sim->fluid.near_dummies[cell]) continue;
        int32_t near[9];
        int n = 0;
        for (int m = 0; m < 9; m++) {
            const int32_t other =
                cell_at(cells, cell_x(cells, cell) + m % 3 - 1, cell_y(cells, cell) + m / 3 - 1);
            int32_t bodies = 0;
            for (int kind = KIND_WALL; other >= 0 && kind < KIND_COUNT; kind++)
                if (sim->kind[kind].n) bodies += cells->kind[kind].count[other];
            if (bodies) near[n++] = other;
        }
        for (int32_t i = fluid->start[cell]; n && i < fluid->start[cell] + fluid->count[cell];
             i++) {
            bool inside = false;
            for (int m = 0; m < n && !inside; m++)
                inside = taken(sim, near[m], particles->x[i], particles->y[i]);
            count += inside;
            if (inside && i < lowest) lowest = i;
        }
    }
    *first = count ? lowest : -1;
    return count;
}
