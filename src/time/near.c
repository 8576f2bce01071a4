/* SPDX-License-Identifier: MIT */
#include "time/near.h"

#include <math.h>
#include <string.h>

#include "particles/kernel.h"

void each_within(const struct simulation *sim, enum kind kind, double x, double y, double distance,
                 visitor *visit, void *sums)
{
    const struct cells *const c = &sim->cells;
    const struct cell_list *const list = &c->kind[kind];
    const struct particles *const p = &sim->kind[kind];
    /* Cells that may hold particles within reach: these may have moved since they were sorted. */
    const double reach = distance + c->skin;
    int first[2], n[2];
    for (int axis = 0; axis < 2; axis++) {
        const int cells = axis ? c->ny : c->nx;
        const double at = ((axis ? y : x) - c->lower[axis]) / c->side[axis],
                     part = reach / c->side[axis];
        first[axis] = (int)max2(-1, min2(cells, floor(at - part)));
        n[axis] = (int)max2(-1, min2(cells, floor(at + part))) - first[axis] + 1;
        if (c->periodic[axis] && n[axis] > cells) n[axis] = cells;
    }
    for (int place = 0; place < n[0] * n[1]; place++) {
        const int32_t cell = cell_at(c, first[0] + place % n[0], first[1] + place / n[0]);
        if (cell < 0) continue;
        for (int32_t k = list->start[cell]; k < list->start[cell] + list->count[cell]; k++) {
            const int64_t i = list->order ? list->order[k] : k;
            const double dx = cells_minimum_image(c, 0, p->x[i] - x);
            const double dy = cells_minimum_image(c, 1, p->y[i] - y);
            const double r2 = square(dx) + square(dy);
            if (r2 < square(distance)) visit(sim, kind, i, sqrt(r2), sums);
        }
    }
}

static void count_near(const struct simulation *sim, enum kind kind, int64_t i, double r,
                       void *sums)
{
    (void)sim, (void)kind, (void)i, (void)r;
    *(int *)sums += 1;
}

int particles_near(const struct simulation *sim, double x, double y)
{
    int n = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++)
        if (sim->cells.kind[kind].n_active)
            each_within(sim, (enum kind)kind, x, y, KERNEL_REACH * sim->fluid.k.h, count_near, &n);
    return n;
}

/* L-7b without volumes and beta rho0 c0^2, 1/m^2: the integral of L-7 times the kernel's slope from r to
 * r0, by four points of Gauss. */
static double repulsion_held(double r, double r0, double h)
{
    static const double at[] = {0.069431844202973713, 0.330009478207571868, 0.669990521792428132,
                                0.930568155797026287};
    static const double weight[] = {0.173927422568726929, 0.326072577431273071,
                                    0.326072577431273071, 0.173927422568726929};
    double sum = 0;
    for (int g = 0; g < 4; g++) {
        const double x = r + at[g] * (r0 - r), eta2 = ETA2 * square(h);
        const double stress = (square(r0) + eta2) / (square(x) + eta2) - 1;
        sum -= weight[g] * stress * kernel_slope(x, h) * x;
    }
    return sum * (r0 - r);
}

/* Adds that of a dummy at the distance r, times its volume, m^2. */
static void add_repulsion(const struct simulation *sim, enum kind kind, int64_t i, double r,
                          void *sums)
{
    const struct particles *const p = &sim->kind[kind];
    const struct fluid *const f = &sim->fluid;
    const double over = f->volume[kind][p->body[i]];
    const double r0 = REPULSION_REACH * 0.5 * (1 + sqrt(over)) * f->k.dp;
    if (r < r0)
        *(double *)sums +=
            over * f->k.mass / (f->k.rho0 * (1 + p->dens[i])) * repulsion_held(r, r0, f->k.h);
}

void repulsion_energy(const struct simulation *sim, double of[SCENE_MAX_SECTIONS])
{
    const struct particles *const p = &sim->kind[KIND_FLUID];
    const struct cell_list *const list = &sim->cells.kind[KIND_FLUID];
    const struct fluid_constants *const k = &sim->fluid.k;
    const double reach = REPULSION_REACH * k->dp; /* solids are as fine as the fluid, or finer */
    memset(of, 0, SCENE_MAX_SECTIONS * sizeof *of);
    for (int32_t n = 0; n < list->n_active; n++) {
        const int32_t cell = list->active[n];
        if (!sim->fluid.near_dummies[cell]) continue;
        for (int32_t i = list->start[cell]; i < list->start[cell] + list->count[cell]; i++) {
            double sum = 0;
            for (int kind = KIND_WALL; kind < KIND_COUNT; kind++)
                if (sim->cells.kind[kind].n_active)
                    each_within(sim, (enum kind)kind, p->x[i], p->y[i], reach, add_repulsion, &sum);
            of[p->body[i]] += (p->m ? p->m[i] : 1) * k->mass / (1 + p->dens[i]) * k->repulsion *
                              square(k->c0) * sum;
        }
    }
}
