/* SPDX-License-Identifier: MIT */
#include "time/repulsion.h"

#include <math.h>
#include <string.h>

#include "particles/kernel.h"

/* L-7b without volumes and beta rho0 c0^2, 1/m^2: the integral of L-7 times the kernel's slope
 * from r to r0, by four points of Gauss. */
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

struct repulsion {
    const struct simulation *sim;
    enum kind kind; /* of the dummies */
    double sum;
};

/* Adds that of a dummy at the distance r, times its volume, m^2. */
static void add_repulsion(void *context, int64_t i, double x, double y, double r)
{
    struct repulsion *const at = context;
    const struct fluid *const fluid = &at->sim->fluid;
    const struct particles *const particles = &at->sim->kind[at->kind];
    (void)x, (void)y;
    const double over = fluid->volume[at->kind][particles->body[i]];
    const double r0 = REPULSION_REACH * 0.5 * (1 + sqrt(over)) * fluid->k.dp;
    if (r < r0)
        at->sum += over * fluid->k.mass / (fluid->k.rho0 * (1 + particles->dens[i])) *
                   repulsion_held(r, r0, fluid->k.h);
}

void repulsion_energy(const struct simulation *sim, double of[SCENE_MAX_SECTIONS])
{
    const struct particles *const particles = &sim->kind[KIND_FLUID];
    const struct cell_list *const list = &sim->cells.kind[KIND_FLUID];
    const struct fluid_constants *const k = &sim->fluid.k;
    const double reach = REPULSION_REACH * k->dp; /* solids are as fine as the fluid, or finer */
    memset(of, 0, SCENE_MAX_SECTIONS * sizeof *of);
    for (int32_t n = 0; n < list->n_active; n++) {
        const int32_t cell = list->active[n];
        if (!sim->fluid.near_dummies[cell]) continue;
        for (int32_t i = list->start[cell]; i < list->start[cell] + list->count[cell]; i++) {
            struct repulsion at = {.sim = sim};
            for (int kind = KIND_WALL; kind < KIND_COUNT; kind++) {
                if (!sim->cells.kind[kind].n_active) continue;
                at.kind = (enum kind)kind;
                cells_each_near(&sim->cells, at.kind, &sim->kind[kind],
                                (double[]){particles->x[i], particles->y[i]}, reach, add_repulsion,
                                &at);
            }
            of[particles->body[i]] += particle_mass(k, particles, i) / (1 + particles->dens[i]) *
                                      k->model->wall_repulsion * square(k->c0) * at.sum;
        }
    }
}
