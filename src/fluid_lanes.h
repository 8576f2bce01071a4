/* SPDX-License-Identifier: MIT
 * What the fluid brings to the sweeps: its lanes, and the renormalised gradient of its density. A part of the
 * sweeps' text (fluid_sweep.h), once for each precision. */

/* Lanes of the fluid that do not depend on its cells, with the pressure by the equation of state; for use
 * inside a parallel region. */
static void lanes_of_state(const struct fluid *f, struct particles *p)
{
    const double rho0 = f->k.rho0, c0 = f->k.c0, volume = f->k.mass / rho0 * square(1 / f->k.h);
    real *const *const out = (real *const *)(const void *)f->lanes[KIND_FLUID].field;
    real *const u = out[LANE_U], *const v = out[LANE_V], *const V = out[LANE_VOLUME];
    real *const pressure = out[LANE_P], *const dens = out[LANE_DENS];
#pragma omp for simd schedule(static) nowait
    for (int64_t i = 0; i < p->n; i++) {
        p->p[i] = eos_pressure(p->dens[i], rho0, c0);
        u[i] = (real)p->vx[i];
        v[i] = (real)p->vy[i];
        V[i] = (real)(volume / (1 + p->dens[i]));
        pressure[i] = (real)p->p[i];
        dens[i] = (real)p->dens[i];
    }
}

static void place_in_cell(const struct fluid *f, const struct particles *p, const struct cells *c,
                          int32_t cell)
{
    const struct cell_list *list = &c->kind[KIND_FLUID];
    const double centre_x = cell_centre_x(c, cell), centre_y = cell_centre_y(c, cell);
    const double inv_h = 1 / f->k.h;
    real *const *const out = (real *const *)(const void *)f->lanes[KIND_FLUID].field;
    for (int32_t i = list->start[cell]; i < list->start[cell] + list->count[cell]; i++) {
        out[LANE_X][i] = (real)((p->x[i] - centre_x) * inv_h);
        out[LANE_Y][i] = (real)((p->y[i] - centre_y) * inv_h);
    }
}

static void SWEEP(lanes)(const struct fluid *f, struct particles kinds[KIND_COUNT],
                         const struct cells *c)
{
    const struct cell_list *list = &c->kind[KIND_FLUID];
#pragma omp parallel num_threads(f->threads)
    {
        lanes_of_state(f, &kinds[KIND_FLUID]);
#pragma omp for schedule(static)
        for (int32_t k = 0; k < list->n_active; k++)
            place_in_cell(f, &kinds[KIND_FLUID], c, list->active[k]);
    }
}

/* Antuono et al. 2010, Eq. 4: the gradient of dens that is exact for linear fields whatever the neighbours,
 * (sum of V x_ab (x) grad W)^-1 applied to sum of V (dens_a - dens_b) grad W, times h. Where the neighbours
 * span no plane (a determinant below a thousandth of the trace squared) it is taken as zero. */
static void slope_of(const struct SWEEP(tile) * tile, real x, real y, real dens, double slope[2])
{
    vreal xx = vset(0), xy = vset(0), yy = vset(0), dx = vset(0), dy = vset(0);
    for (int j = 0; j < tile->n; j += LANES) {
        const vreal rx = vset(x) - vload(&tile->field[LANE_X][j]);
        const vreal ry = vset(y) - vload(&tile->field[LANE_Y][j]);
        const vreal q = vsqrt(vfma(ry, ry, rx * rx));
        const vreal t = vmax(vset(0), vfma(vset((real)-0.5), q, vset(1)));
        const vreal w = vload(&tile->field[LANE_VOLUME][j]) * (t * t * t);
        const vreal step = w * (vset(dens) - vload(&tile->field[LANE_DENS][j]));
        xx = vfma(w * rx, rx, xx);
        xy = vfma(w * rx, ry, xy);
        yy = vfma(w * ry, ry, yy);
        dx = vfma(step, rx, dx);
        dy = vfma(step, ry, dy);
    }
    const double a = (double)vsum(xx), b = (double)vsum(xy), c = (double)vsum(yy);
    const double u = (double)vsum(dx), v = (double)vsum(dy), det = a * c - b * b;
    const bool good = det > 1e-3 * square(a + c);
    slope[0] = good ? (c * u - b * v) / det : 0;
    slope[1] = good ? (a * v - b * u) / det : 0;
}

static void SWEEP(slopes)(const struct fluid *f, struct particles kinds[KIND_COUNT],
                          const struct cells *c)
{
    const struct cell_list *list = &c->kind[KIND_FLUID];
    struct particles *const p = &kinds[KIND_FLUID];
    real *const *const lane = (real *const *)(const void *)f->lanes[KIND_FLUID].field;
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (int32_t k = 0; k < list->n_active; k++) {
        const int32_t cell = list->active[k];
        struct SWEEP(tile) *const tile = thread_tile(f, 0);
        tile->fields = LANE_FIELDS;
        tile_around(tile, f, c, KIND_FLUID, cell);
        for (int32_t i = list->start[cell]; i < list->start[cell] + list->count[cell]; i++) {
            double slope[2];
            slope_of(tile, lane[LANE_X][i], lane[LANE_Y][i], lane[LANE_DENS][i], slope);
            p->slope_x[i] = slope[0] / f->k.h;
            p->slope_y[i] = slope[1] / f->k.h;
        }
    }
    /* Now that no other cell reads them. */
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (int64_t i = 0; i < p->n; i++) {
        lane[LANE_SLOPE_X][i] = (real)(p->slope_x[i] * f->k.h);
        lane[LANE_SLOPE_Y][i] = (real)(p->slope_y[i] * f->k.h);
    }
}
