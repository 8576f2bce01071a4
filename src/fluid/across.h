/* SPDX-License-Identifier: MIT
 * The fluid across the line of an open boundary: its pressure and velocity at a point. */
#ifndef SPHFSI_FLUID_ACROSS_H
#define SPHFSI_FLUID_ACROSS_H

#include "base/simd.h"
#include "fluid/fluid.h"
#include "particles/kernel.h"

/* Sums of the kernel, without its norm, over the fluid around a point: of pressure and velocity; of
 * the vector to the particles and its products; of rho/rho0 times the vector back. */
/* clang-format off */
#define ACROSS(SUM) \
    SUM(w) SUM(p_w) SUM(u) SUM(v) SUM(x) SUM(y) SUM(xx) SUM(xy) SUM(yy) \
    SUM(ux) SUM(uy) SUM(vx) SUM(vy) SUM(mass_x) SUM(mass_y)
/* clang-format on */
struct across {
#define SUM(name) double name;
    ACROSS(SUM)
#undef SUM
};
struct across_four {
#define SUM(name) four_double name;
    ACROSS(SUM)
#undef SUM
};

/* Adds up to four particles of a cell from i on, at vectors (x, y) from the point. */
SPHFSI_INLINE void add_across(struct across_four *s, double inv_h,
                              const struct particles *particles, int32_t i, int count,
                              four_double x, four_double y)
{
    const four_long lane = {0, 1, 2, 3};
    const four_double r2 = x * x + y * y;
    const four_long seen = (four_long)(r2 < square(KERNEL_REACH / inv_h)) & (lane < count);
    if (!(seen[0] | seen[1] | seen[2] | seen[3])) return;
    const four_double q = four_sqrt(r2) * inv_h, t = 1 - 0.5 * q;
    four_double w = t * t * (t * t) * (2 * q + 1);
    for (int r = 0; r < CLUSTER; r++)
        w[r] = seen[r] && particles->open[i + r] == 0 ? w[r] : 0; /* not the buffers */
    const four_double u = FOUR(particles->vx, i), v = FOUR(particles->vy, i), wx = w * x,
                      wy = w * y, mass = 1 + FOUR(particles->dens, i);
    s->w += w;
    s->p_w += w * FOUR(particles->p, i);
    s->u += w * u;
    s->v += w * v;
    s->x += wx;
    s->y += wy;
    s->xx += wx * x;
    s->xy += wx * y;
    s->yy += wy * y;
    s->ux += wx * u;
    s->uy += wy * u;
    s->vx += wx * v;
    s->vy += wy * v;
    s->mass_x -= wx * mass;
    s->mass_y -= wy * mass;
}

/* The fluid within reach of a point, without the buffers. */
SPHFSI_INLINE struct across state_across(const struct fluid_constants *k,
                                         const struct particles *particles,
                                         const struct cells *cells, const double at[2])
{
    const struct cell_list *const list = &cells->kind[KIND_FLUID];
    const struct cell_window window = cells_window(cells, at, KERNEL_REACH * k->h);
    struct across_four s = {.w = {0}};
    for (int m = 0; m < window.n[0] * window.n[1]; m++) {
        const int32_t cell = window_cell(cells, &window, m);
        if (cell < 0) continue;
        const double cx = cell_centre_x(cells, cell), cy = cell_centre_y(cells, cell);
        const double dx = cells_minimum_image(cells, 0, cx - at[0]) - cx,
                     dy = cells_minimum_image(cells, 1, cy - at[1]) - cy;
        for (int32_t n = 0, i = list->start[cell]; n < list->count[cell]; n += 4, i += 4)
            add_across(&s, 1 / k->h, particles, i, list->count[cell] - n,
                       FOUR(particles->x, i) + dx, FOUR(particles->y, i) + dy);
    }
    struct across sum;
#define SUM(name) sum.name = (s.name[0] + s.name[2]) + (s.name[1] + s.name[3]);
    ACROSS(SUM)
#undef SUM
    return sum;
}

/* T-51: the value at the point of the linear field fitted to the sums; their mean if the particles
 * span no plane. */
SPHFSI_INLINE double linear_value(const struct across *s, double mean, double with_x, double with_y)
{
    const double x = s->x / s->w, y = s->y / s->w;
    const double xx = s->xx / s->w - x * x, xy = s->xy / s->w - x * y, yy = s->yy / s->w - y * y;
    const double det = xx * yy - xy * xy, value = mean / s->w;
    if (!(det > 0.01 * square(xx + yy))) return value;
    const double cx = with_x / s->w - x * value, cy = with_y / s->w - y * value;
    return value - ((yy * x - xy * y) * cx + (xx * y - xy * x) * cy) / det;
}

#endif
