/* SPDX-License-Identifier: MIT
 * Packed fields of the fluid, and the renormalised gradient of its density. Included by
 * fluid/sweep.h, once for each precision. */

/* Fills a cluster after its first `count` particles. */
static void cluster_close(real *packed, int fields, int count)
{
    for (int r = count; r < CLUSTER; r++) {
        for (int m = 0; m < fields; m++) packed[m * CLUSTER + r] = 0;
        packed[PACKED_X * CLUSTER + r] = (real)FAR;
    }
}

/* The box around the first `count` particles of a cluster. */
SPHFSI_INLINE void cluster_box(const struct cluster_boxes *boxes, size_t cluster,
                               const real *packed, int count)
{
    const real *const x = packed + PACKED_X * CLUSTER, *const y = packed + PACKED_Y * CLUSTER;
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

SPHFSI_INLINE void put_four(real *packed, enum packed_field m, four_double four)
{
    *(four_real *)(void *)(packed + (int)m * CLUSTER) = __builtin_convertvector(four, four_real);
}

/* Stores the first `count` of four. */
SPHFSI_INLINE void store_four(double *to, four_double four, int count)
{
    if (count == CLUSTER)
        *(four_double_at *)to = four;
    else
        for (int r = 0; r < count; r++) to[r] = four[r];
}

/* Constants of packing. */
struct packing {
    double inv_h, volume;  /* 1/m; of a particle at rest, in units of h^2 */
    double tait, acoustic; /* factors of the pressure, Pa: c0^2 rho0/gamma, c0^2 rho0 */
    double gradient;       /* factor of the gradient of dens, m */
    double per_viscosity;  /* 1/(-2 alpha c0 rho0) of Eq. 7, m^2 s/kg */
    double predict_by;     /* s */
    effect_set effects;
    bool keeps_slopes;
};

SPHFSI_INLINE struct packing packing_of(const struct fluid *fluid)
{
    const struct fluid_constants *const k = &fluid->k;
    const double inv_h = 1 / k->h;
    return (struct packing){inv_h,
                            k->mass / k->rho0 * square(inv_h),
                            k->c0 * k->c0 * k->rho0 / EOS_GAMMA,
                            k->rho0 * square(k->c0),
                            -0.5 * k->h,
                            -0.5 / (k->model->artificial_viscosity * k->c0 * k->rho0),
                            fluid->predict_by,
                            fluid->effects,
                            fluid->effects & FX_ANTUONO && fluid->keeps_slopes};
}

/* Pressure that acts on the neighbours of the four particles from i on: Tait's (T-3), and with the
 * acoustic damper also P' = rho0 c0^2 (dens - dens_slow) (T-9a). */
SPHFSI_INLINE four_double acting_pressure(const struct packing *packing,
                                          const struct particles *particles, int32_t i,
                                          four_double dens)
{
    const four_double pressure = packing->tait * EOS_POWER(dens);
    if (!(packing->effects & FX_DAMPER)) return pressure;
    return pressure + packing->acoustic * (dens - FOUR(particles->dens_slow, i));
}

/* The gradients of dens of the particles from i on. */
SPHFSI_INLINE void pack_slopes(const struct packing *packing, const struct particles *particles,
                               int32_t i, real *out)
{
    put_four(out, PACKED_SLOPE_X, FOUR(particles->slope_x, i) * packing->gradient);
    put_four(out, PACKED_SLOPE_Y, FOUR(particles->slope_y, i) * packing->gradient);
}

/* Packed fields of the `count` particles from i on; the rest of four are of the next cell. */
SPHFSI_INLINE void pack_cluster(const struct packing *packing, const struct particles *particles,
                                int32_t i, int count, const double centre[2], real *out)
{
    four_double dens = FOUR(particles->dens, i), x = FOUR(particles->x, i),
                y = FOUR(particles->y, i), u = FOUR(particles->vx, i), v = FOUR(particles->vy, i);
    if (packing->predict_by > 0) {
        x = x + packing->predict_by * u; /* Eq. 22a */
        y = y + packing->predict_by * v;
        u = u + packing->predict_by * FOUR(particles->ax, i); /* Eq. 22b */
        v = v + packing->predict_by * FOUR(particles->ay, i);
        dens = dens + packing->predict_by * FOUR(particles->ddens, i); /* Eq. 24a */
        store_four(particles->dens_half + i, dens, count);
    }
    put_four(out, PACKED_X, (x - centre[0]) * packing->inv_h);
    put_four(out, PACKED_Y, (y - centre[1]) * packing->inv_h);
    put_four(out, PACKED_U, u);
    put_four(out, PACKED_V, v);
    const four_double specific = 1 / (1 + dens), own = packing->volume * specific;
    put_four(out, PACKED_VOLUME, packing->effects & FX_MASSES ? FOUR(particles->m, i) * own : own);
    if (packing->effects & FX_VISCOSITY)
        put_four(out, PACKED_SPECIFIC, specific * packing->per_viscosity);
    put_four(out, PACKED_P, acting_pressure(packing, particles, i, dens));
    put_four(out, PACKED_DENS, dens);
    if (packing->keeps_slopes) pack_slopes(packing, particles, i, out);
}

SPHFSI_INLINE void pack_cell(const struct fluid *fluid, const struct packing *packing,
                             const struct particles *particles, const struct cells *cells,
                             int32_t cell)
{
    const struct cell_list *const list = &cells->list[KIND_FLUID];
    const struct packed_fields *const packed = &fluid->packed[KIND_FLUID];
    const double centre[2] = {cell_centre_x(cells, cell), cell_centre_y(cells, cell)};
    const int32_t count = list->count[cell];
    for (int32_t first = 0; first < count; first += CLUSTER) {
        const size_t cluster = (size_t)list->cluster[cell] + (size_t)(first / CLUSTER);
        const int32_t own = count - first < CLUSTER ? count - first : CLUSTER;
        real *const out = cluster_packed(packed, cluster);
        pack_cluster(packing, particles, list->start[cell] + first, own, centre, out);
        if (own == CLUSTER) { /* a compile-time constant */
            cluster_box(&packed->boxes, cluster, out, CLUSTER);
            continue;
        }
        cluster_close(out, packed->n, own);
        for (int32_t r = own; r < CLUSTER && packing->effects & FX_VISCOSITY; r++)
            out[PACKED_SPECIFIC * CLUSTER + r] = -1; /* the sum of two is a divisor */
        cluster_box(&packed->boxes, cluster, out, own);
    }
}

static void SWEEP(pack)(struct fluid *fluid, struct particles kinds[KIND_COUNT],
                        const struct cells *cells)
{
    const int32_t n = cells->list[KIND_FLUID].n_active;
    const struct packing packing = packing_of(fluid);
#pragma omp parallel for schedule(static) num_threads(fluid->threads)
    for (int32_t k = 0; k < n; k++)
        pack_cell(fluid, &packing, &kinds[KIND_FLUID], cells, cells->list[KIND_FLUID].active[k]);
}

/* V t^3 of the candidates. */
SPHFSI_INLINE vreal gradient_weight(const struct separation *r, const real *b)
{
    const vreal t = vmax(vset(0), vfma(vset((real)-0.5), r->length, vset(1)));
    return lane(b, PACKED_VOLUME) * (t * t * t);
}

/* Sums over neighbours, V x_ab (x) grad W and V (dens_a - dens_b) grad W, less a common factor. */
enum { SLOPE_XX, SLOPE_XY, SLOPE_YY, SLOPE_X, SLOPE_Y, SLOPE_SUMS };

/* For the receivers from number r of a cluster on. */
SPHFSI_INLINE void sum_slopes(const struct neighbours *neighbours, const struct receiver *a, int r,
                              real out[SLOPE_SUMS][CLUSTER])
{
    vreal sum[SLOPE_SUMS][PARTS] = {{{0}}};
    EACH_CANDIDATE(neighbours, part, code, b)
    {
        const struct separation d = separation_from(a, code, b, false);
        const vreal w = weight_seen(a, &d, gradient_weight(&d, b));
        const vreal step = w * (a->dens - lane(b, PACKED_DENS));
        sum[SLOPE_XX][part] = vfma(w * d.x, d.x, sum[SLOPE_XX][part]);
        sum[SLOPE_XY][part] = vfma(w * d.x, d.y, sum[SLOPE_XY][part]);
        sum[SLOPE_YY][part] = vfma(w * d.y, d.y, sum[SLOPE_YY][part]);
        sum[SLOPE_X][part] = vfma(step, d.x, sum[SLOPE_X][part]);
        sum[SLOPE_Y][part] = vfma(step, d.y, sum[SLOPE_Y][part]);
    }
    for (int k = 0; k < SLOPE_SUMS; k++) sum_lanes(sum[k], &out[k][r]);
}

/* Antuono et al. 2010, Eq. 4: the gradient of dens, exact for linear fields with any neighbours,
 * times h: (sum of V x_ab (x) grad W)^-1 applied to sum of V (dens_a - dens_b) grad W. If the
 * neighbours span no plane (determinant below trace squared/1000) the inverse is 0. */
SPHFSI_INLINE void slopes_from(real sum[SLOPE_SUMS][CLUSTER], four_double slope[2])
{
    four_double s[SLOPE_SUMS];
    for (int k = 0; k < SLOPE_SUMS; k++) s[k] = four_widen(FOUR_REAL(sum[k]));
    const four_double xx = s[SLOPE_XX], xy = s[SLOPE_XY], yy = s[SLOPE_YY];
    const four_double det = xx * yy - xy * xy, trace = xx + yy;
    const four_long plane = (four_long)(det > 1e-3 * (trace * trace));
    const four_double x = (yy * s[SLOPE_X] - xy * s[SLOPE_Y]) / det,
                      y = (xx * s[SLOPE_Y] - xy * s[SLOPE_X]) / det;
    slope[0] = (four_double)((four_long)x & plane);
    slope[1] = (four_double)((four_long)y & plane);
}

SPHFSI_INLINE void slopes_of_cell(const struct fluid *fluid, struct particles *particles,
                                  const struct cells *cells, int32_t cell, bool thin)
{
    const struct cell_list *const list = &cells->list[KIND_FLUID];
    struct neighbour_scratch *const neighbour_scratch = &fluid->neighbour_scratch[thread_index()];
    const struct cell_sides sides = cell_sides_of(fluid, cells, cell, thin);
    gather_around_cell(neighbour_scratch, fluid, cells, KIND_FLUID, cell);
    for (int32_t m = 0; m < clusters_in(list, cell); m++) {
        const int32_t cluster = list->cluster[cell] + m, i = list->start[cell] + m * CLUSTER;
        const real *const own = cluster_packed(&fluid->packed[KIND_FLUID], (size_t)cluster);
        const struct neighbours neighbours =
            gather_clusters(neighbour_scratch, fluid, KIND_FLUID, KIND_FLUID, cluster);
        real sum[SLOPE_SUMS][CLUSTER];
        for (int r = 0; r < CLUSTER; r += GROUPS) {
            struct receiver a = receiver_at(&sides, own + r);
            a.dens = vspread(own + r + PACKED_DENS * CLUSTER);
            sum_slopes(&neighbours, &a, r, sum);
        }
        four_double slope[2];
        slopes_from(sum, slope);
        store_four(particles->slope_x + i, slope[0] / fluid->k.h, particles_in(list, cell, m));
        store_four(particles->slope_y + i, slope[1] / fluid->k.h, particles_in(list, cell, m));
    }
}

/* Packs the gradients, now that no other cell reads those fields. What the places behind a cell's
 * last particle get does not matter: they have no volume. */
SPHFSI_INLINE void pack_slopes_of_cell(const struct fluid *fluid, const struct packing *packing,
                                       const struct particles *particles, const struct cells *cells,
                                       int32_t cell)
{
    const struct cell_list *const list = &cells->list[KIND_FLUID];
    for (int32_t m = 0; m < clusters_in(list, cell); m++)
        pack_slopes(packing, particles, list->start[cell] + m * CLUSTER,
                    cluster_packed(&fluid->packed[KIND_FLUID], (size_t)(list->cluster[cell] + m)));
}

static void SWEEP(find_slopes)(struct fluid *fluid, struct particles kinds[KIND_COUNT],
                               const struct cells *cells)
{
    const struct cell_list *list = &cells->list[KIND_FLUID];
    struct particles *const particles = &kinds[KIND_FLUID];
    const struct packing packing = packing_of(fluid);
#pragma omp parallel for schedule(static) num_threads(fluid->threads)
    for (int32_t k = 0; k < list->n_active; k++)
        if (fluid->effects & FX_THIN)
            slopes_of_cell(fluid, particles, cells, list->active[k], true);
        else
            slopes_of_cell(fluid, particles, cells, list->active[k], false);
#pragma omp parallel for schedule(static) num_threads(fluid->threads)
    for (int32_t k = 0; k < list->n_active; k++)
        pack_slopes_of_cell(fluid, &packing, particles, cells, list->active[k]);
}
