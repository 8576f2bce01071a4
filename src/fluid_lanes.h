/* SPDX-License-Identifier: MIT
 * What the fluid brings to the sweeps: its lanes, and the renormalised gradient of its density. A part of the
 * sweeps' text (fluid_sweep.h), once for each precision. */

/* In units of h; the kernel ends at 2. */
#define FAR 1e9

/* The lanes of a cluster; those of its field m are lanes + m CLUSTER. */
SPHFSI_INLINE real *cluster_lanes(const struct lanes *lanes, size_t cluster)
{
    return (real *)lanes->cluster + cluster * (size_t)(lanes->n * CLUSTER);
}

/* Ends a cluster behind its first `count` particles. */
static void cluster_close(real *lanes, int fields, int count)
{
    for (int r = count; r < CLUSTER; r++) {
        for (int m = 0; m < fields; m++) lanes[m * CLUSTER + r] = 0;
        lanes[LANE_X * CLUSTER + r] = (real)FAR;
    }
}

/* The box around the first `count` particles of a cluster. */
SPHFSI_INLINE void cluster_box(const struct cluster_boxes *boxes, size_t cluster, const real *lanes,
                               int count)
{
    const real *const x = lanes + LANE_X * CLUSTER, *const y = lanes + LANE_Y * CLUSTER;
    real low[2] = {x[0], y[0]}, high[2] = {x[0], y[0]};
    for (int r = 1; r < count; r++) {
        low[0] = x[r] < low[0] ? x[r] : low[0];
        low[1] = y[r] < low[1] ? y[r] : low[1];
        high[0] = x[r] > high[0] ? x[r] : high[0];
        high[1] = y[r] > high[1] ? y[r] : high[1];
    }
    boxes->side[BOX_LEFT][cluster] = (float)low[0];
    boxes->side[BOX_RIGHT][cluster] = (float)high[0];
    boxes->side[BOX_DOWN][cluster] = (float)low[1];
    boxes->side[BOX_UP][cluster] = (float)high[1];
}

/* Four values of a field, as those of a lane. */
#define FOUR(field, i) ((four_double) * (const four_double_at *)&(field)[i])

SPHFSI_INLINE void put_four(real *lanes, enum lane_field m, four_double four)
{
    *(four_real *)(void *)(lanes + (int)m * CLUSTER) = __builtin_convertvector(four, four_real);
}

/* Lanes of the particles from i on; where they are fewer than four, the rest are of the next cell. Their
 * pressures are handed over: those of the next cell may be another thread's, which is finding them. */
SPHFSI_INLINE void fluid_lanes(const struct fluid *f, const struct particles *p, int32_t i,
                               four_double pressure, const double centre[2], real *out)
{
    const double inv_h = 1 / f->k.h, volume = f->k.mass / f->k.rho0 * square(inv_h);
    const four_double dens = FOUR(p->dens, i);
    put_four(out, LANE_X, (FOUR(p->x, i) - centre[0]) * inv_h);
    put_four(out, LANE_Y, (FOUR(p->y, i) - centre[1]) * inv_h);
    put_four(out, LANE_U, FOUR(p->vx, i));
    put_four(out, LANE_V, FOUR(p->vy, i));
    put_four(out, LANE_VOLUME, volume / (1 + dens));
    put_four(out, LANE_P, pressure);
    put_four(out, LANE_DENS, dens);
}

static void lanes_of_cell(const struct fluid *f, const struct particles *p, const struct cells *c,
                          int32_t cell)
{
    const struct cell_list *const list = &c->kind[KIND_FLUID];
    const struct lanes *const lanes = &f->lanes[KIND_FLUID];
    const double centre[2] = {cell_centre_x(c, cell), cell_centre_y(c, cell)};
    const size_t first = (size_t)list->cluster[cell];
    const int32_t full = list->count[cell] / CLUSTER, rest = list->count[cell] % CLUSTER;
    for (int32_t m = 0; m < full; m++) {
        const int32_t i = list->start[cell] + m * CLUSTER;
        real *const out = cluster_lanes(lanes, first + (size_t)m);
        fluid_lanes(f, p, i, FOUR(p->p, i), centre, out);
        cluster_box(&lanes->boxes, first + (size_t)m, out, CLUSTER);
    }
    if (rest == 0) return;
    const int32_t last = list->start[cell] + full * CLUSTER;
    four_double pressure = {0};
    for (int r = 0; r < rest; r++) pressure[r] = p->p[last + r];
    real *const out = cluster_lanes(lanes, first + (size_t)full);
    fluid_lanes(f, p, last, pressure, centre, out);
    cluster_close(out, lanes->n, rest);
    cluster_box(&lanes->boxes, first + (size_t)full, out, rest);
}

/* Pressure by the equation of state, then lanes, of some cells in a row. */
static void lanes_of_row(const struct fluid *f, const struct particles *p, const struct cells *c,
                         int32_t from, int32_t to)
{
    const struct cell_list *const list = &c->kind[KIND_FLUID];
    const double rho0 = f->k.rho0, c0 = f->k.c0;
    const int64_t end = list->start[list->active[to - 1]] + list->count[list->active[to - 1]];
#pragma omp simd
    for (int64_t i = list->start[list->active[from]]; i < end; i++)
        p->p[i] = eos_pressure(p->dens[i], rho0, c0);
    for (int32_t k = from; k < to; k++) lanes_of_cell(f, p, c, list->active[k]);
}

static void SWEEP(lanes)(const struct fluid *f, struct particles kinds[KIND_COUNT],
                         const struct cells *c)
{
    enum { ROW = 16 }; /* what a row reads stays in the first cache */
    const int32_t n = c->kind[KIND_FLUID].n_active;
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (int32_t k = 0; k < n; k += ROW)
        lanes_of_row(f, &kinds[KIND_FLUID], c, k, k + ROW < n ? k + ROW : n);
}

/* Antuono et al. 2010, Eq. 4: the gradient of dens that is exact for linear fields whatever the neighbours,
 * (sum of V x_ab (x) grad W)^-1 applied to sum of V (dens_a - dens_b) grad W, times h. Where the neighbours
 * span no plane (a determinant below a thousandth of the trace squared) it is taken as zero. */
static void slopes_of(const struct view *see, const struct receiver *a, double slope[GROUPS][2])
{
    vreal xx[PARTS] = {{0}}, xy[PARTS] = {{0}}, yy[PARTS] = {{0}}, dx[PARTS] = {{0}},
          dy[PARTS] = {{0}};
    EACH_SEEN(see, k, part) {
        const uint32_t seen = see->seen[k];
        const real *const b = candidates(see, seen, part);
        const struct way r = way_from(a, seen, b);
        const vreal t = vmax(vset(0), vfma(vset((real)-0.5), r.length, vset(1)));
        const vreal w = lane(b, LANE_VOLUME) * (t * t * t);
        const vreal step = w * (a->dens - lane(b, LANE_DENS));
        xx[part] = vfma(w * r.x, r.x, xx[part]);
        xy[part] = vfma(w * r.x, r.y, xy[part]);
        yy[part] = vfma(w * r.y, r.y, yy[part]);
        dx[part] = vfma(step, r.x, dx[part]);
        dy[part] = vfma(step, r.y, dy[part]);
    }
    real A[GROUPS], B[GROUPS], C[GROUPS], U[GROUPS], V[GROUPS];
    total(xx, A);
    total(xy, B);
    total(yy, C);
    total(dx, U);
    total(dy, V);
    for (int g = 0; g < GROUPS; g++) {
        const double det = (double)A[g] * (double)C[g] - square((double)B[g]);
        const bool good = det > 1e-3 * square((double)A[g] + (double)C[g]);
        slope[g][0] = good ? ((double)C[g] * (double)U[g] - (double)B[g] * (double)V[g]) / det : 0;
        slope[g][1] = good ? ((double)A[g] * (double)V[g] - (double)B[g] * (double)U[g]) / det : 0;
    }
}

static void slopes_of_cell(const struct fluid *f, struct particles *p, const struct cells *c,
                           int32_t cell)
{
    const struct cell_list *const list = &c->kind[KIND_FLUID];
    struct sight *const sight = &f->sight[thread_index()];
    const struct cell_sides sides = cell_sides_of(f, c);
    look_around(sight, f, c, KIND_FLUID, cell);
    for (int32_t m = 0; m < clusters_in(list, cell); m++) {
        const int32_t cluster = list->cluster[cell] + m, i = list->start[cell] + m * CLUSTER;
        const int count = particles_in(list, cell, m);
        const struct view see = look_at(sight, f, KIND_FLUID, KIND_FLUID, cluster);
        for (int r = 0; r < count; r += GROUPS) {
            const real *const own = cluster_lanes(&f->lanes[KIND_FLUID], (size_t)cluster) + r;
            struct receiver a = receiver_at(&sides, own);
            a.dens = vspread(own + LANE_DENS * CLUSTER);
            double slope[GROUPS][2];
            slopes_of(&see, &a, slope);
            for (int g = 0; g < GROUPS && r + g < count; g++) {
                p->slope_x[i + r + g] = slope[g][0] / f->k.h;
                p->slope_y[i + r + g] = slope[g][1] / f->k.h;
            }
        }
    }
}

static void SWEEP(slopes)(const struct fluid *f, struct particles kinds[KIND_COUNT],
                          const struct cells *c)
{
    const struct cell_list *list = &c->kind[KIND_FLUID];
    struct particles *const p = &kinds[KIND_FLUID];
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (int32_t k = 0; k < list->n_active; k++) slopes_of_cell(f, p, c, list->active[k]);
        /* Now that no other cell reads them. */
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (int32_t k = 0; k < list->n_active; k++) {
        const int32_t cell = list->active[k];
        for (int32_t m = 0; m < list->count[cell]; m++) {
            const int32_t i = list->start[cell] + m;
            real *const own =
                cluster_lanes(&f->lanes[KIND_FLUID], (size_t)(list->cluster[cell] + m / CLUSTER)) +
                m % CLUSTER;
            own[LANE_SLOPE_X * CLUSTER] = (real)(p->slope_x[i] * f->k.h);
            own[LANE_SLOPE_Y * CLUSTER] = (real)(p->slope_y[i] * f->k.h);
        }
    }
}
