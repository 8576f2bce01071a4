/* SPDX-License-Identifier: MIT
 * The energy that dummies store by repelling fluid (L-7b). */
#include "fluid/fluid.h"

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

/* Repulsion of a dummy of a kind, times its volume, m^2. */
static double repulsion_of(const struct fluid *fluid, const struct cell_visit *v)
{
    const enum kind kind = (enum kind)v->kind;
    const double over = fluid_volume_of(fluid, kind, v->particles, v->i),
                 r0 = fluid_repels_from(fluid, kind, v->particles, v->i);
    if (!(v->r < r0)) return 0;
    return fluid_seen(fluid, v->cells, v->at, kind, v->i, v->x, v->y) * over * fluid->k.mass /
           (fluid->k.rho0 * (1 + v->particles->dens[v->i])) * repulsion_held(v->r, r0, fluid->k.h);
}

void fluid_repulsion_energy(const struct fluid *fluid, const struct particles kind[KIND_COUNT],
                            const struct cells *cells, double of[SCENE_MAX_SECTIONS])
{
    const struct particles *const particles = &kind[KIND_FLUID];
    const struct cell_list *const list = &cells->list[KIND_FLUID];
    const struct fluid_constants *const k = &fluid->k;
    const double most = fluid->effects & FX_THIN ? 1 : REPULSION_REACH; /* solids are finer */
    memset(of, 0, SCENE_MAX_SECTIONS * sizeof *of);
    for (int32_t n = 0; n < list->n_active; n++) {
        const int32_t cell = list->active[n];
        if (!fluid_near_dummies(fluid, cell)) continue;
        for (int32_t i = list->start[cell]; i < list->start[cell] + list->count[cell]; i++) {
            const double at[2] = {particles->x[i], particles->y[i]};
            double sum = 0;
            struct cell_visit v = cells_visit(cells, kind, KIND_WALL, KIND_COUNT, at, most * k->dp);
            while (cells_next(&v)) sum += repulsion_of(fluid, &v);
            of[particles->body[i]] += particle_mass(k, particles, i) / (1 + particles->dens[i]) *
                                      k->model->wall_repulsion * square(k->c_u) * sum;
        }
    }
}
