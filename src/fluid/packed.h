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

/* Pressure that acts on the neighbours of the four particles from i on: Tait's (T-3), and with an
 * acoustic damper (Fourtakas, Vacondio and Rogers 2025; T-9a) psi, of dens less its value with
 * delay. */
SPHFSI_INLINE four_double acting_pressure(const struct fluid *fluid,
                                          const struct particles *particles, int32_t i)
{
    const struct fluid_constants *const k = &fluid->k;
    const four_double dens = FOUR(particles->dens, i);
    const four_double pressure = k->c0 * k->c0 * k->rho0 / EOS_GAMMA * EOS_POWER(dens);
    if (!(fluid->effects & FX_DAMPER)) return pressure;
    return pressure + k->rho0 * square(k->c0) * (dens - FOUR(particles->dens_slow, i));
}

/* Packed fields of the particles from i on; if there are fewer than four, the rest belong to the
 * next cell. */
SPHFSI_INLINE void pack_cluster(const struct fluid *fluid, const struct particles *particles,
                                int32_t i, const double centre[2], real *out)
{
    const double inv_h = 1 / fluid->k.h, volume = fluid->k.mass / fluid->k.rho0 * square(inv_h);
    const four_double dens = FOUR(particles->dens, i);
    put_four(out, PACKED_X, (FOUR(particles->x, i) - centre[0]) * inv_h);
    put_four(out, PACKED_Y, (FOUR(particles->y, i) - centre[1]) * inv_h);
    put_four(out, PACKED_U, FOUR(particles->vx, i));
    put_four(out, PACKED_V, FOUR(particles->vy, i));
    const four_double specific = 1 / (1 + dens), own = volume * specific;
    put_four(out, PACKED_VOLUME, fluid->effects & FX_MASSES ? FOUR(particles->m, i) * own : own);
    if (fluid->effects & FX_VISCOSITY) put_four(out, PACKED_SPECIFIC, specific);
    put_four(out, PACKED_P, acting_pressure(fluid, particles, i));
    put_four(out, PACKED_DENS, dens);
}

SPHFSI_INLINE void pack_cell(const struct fluid *fluid, const struct particles *particles,
                             const struct cells *cells, int32_t cell)
{
    const struct cell_list *const list = &cells->kind[KIND_FLUID];
    const struct packed_fields *const packed = &fluid->packed[KIND_FLUID];
    const double centre[2] = {cell_centre_x(cells, cell), cell_centre_y(cells, cell)};
    const int32_t count = list->count[cell];
    for (int32_t first = 0; first < count; first += CLUSTER) {
        const size_t cluster = (size_t)list->cluster[cell] + (size_t)(first / CLUSTER);
        const int32_t own = count - first < CLUSTER ? count - first : CLUSTER;
        real *const out = cluster_packed(packed, cluster);
        pack_cluster(fluid, particles, list->start[cell] + first, centre, out);
        if (own < CLUSTER) cluster_close(out, packed->n, own);
        for (int32_t r = own; r < CLUSTER && fluid->effects & FX_VISCOSITY; r++)
            out[PACKED_SPECIFIC * CLUSTER + r] = 1; /* the sum of two is a divisor */
        cluster_box(&packed->boxes, cluster, out, own);
    }
}

static void SWEEP(packed)(struct fluid *fluid, struct particles kinds[KIND_COUNT],
                          const struct cells *cells)
{
    const int32_t n = cells->kind[KIND_FLUID].n_active;
#pragma omp parallel for schedule(static) num_threads(fluid->threads)
    for (int32_t k = 0; k < n; k++)
        pack_cell(fluid, &kinds[KIND_FLUID], cells, cells->kind[KIND_FLUID].active[k]);
}

/* V t^3 of the candidates. */
SPHFSI_INLINE vreal gradient_weight(const struct separation *r, const real *b)
{
    const vreal t = vmax(vset(0), vfma(vset((real)-0.5), r->length, vset(1)));
    return lane(b, PACKED_VOLUME) * (t * t * t);
}

/* Antuono et al. 2010, Eq. 4: the gradient of dens, exact for linear fields with any neighbours,
 * times h: (sum of V x_ab (x) grad W)^-1 applied to sum of V (dens_a - dens_b) grad W. If the
 * neighbours span no plane (a determinant below a thousandth of the trace squared) the inverse
 * is taken as 0. */
static void slopes_of(const struct neighbours *neighbours, const struct receiver *a,
                      double slope[GROUPS][2])
{
    vreal xx[PARTS] = {{0}}, xy[PARTS] = {{0}}, yy[PARTS] = {{0}}, dx[PARTS] = {{0}},
          dy[PARTS] = {{0}};
    for (int k = 0; k < neighbours->n; k++)
        for (int part = 0; part < PARTS; part++) {
            const uint32_t code = neighbours->code[k];
            const real *const b = candidates(neighbours, code, part);
            const struct separation r = separation_from(a, code, b);
            const vreal w = weight_seen(a, &r, gradient_weight(&r, b));
            const vreal step = w * (a->dens - lane(b, PACKED_DENS));
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
        const double a_xx = (double)A[g], a_xy = (double)B[g], a_yy = (double)C[g],
                     x = (double)U[g], y = (double)V[g];
        const double det = a_xx * a_yy - square(a_xy);
        const bool plane = det > 1e-3 * square(a_xx + a_yy);
        slope[g][0] = plane ? (a_yy * x - a_xy * y) / det : 0;
        slope[g][1] = plane ? (a_xx * y - a_xy * x) / det : 0;
    }
}

static void slopes_of_cell(const struct fluid *fluid, struct particles *particles,
                           const struct cells *cells, int32_t cell)
{
    const struct cell_list *const list = &cells->kind[KIND_FLUID];
    struct neighbour_scratch *const neighbour_scratch = &fluid->neighbour_scratch[thread_index()];
    const struct cell_sides sides = cell_sides_of(fluid, cells, cell);
    gather_around_cell(neighbour_scratch, fluid, cells, KIND_FLUID, cell);
    for (int32_t m = 0; m < clusters_in(list, cell); m++) {
        const int32_t cluster = list->cluster[cell] + m, i = list->start[cell] + m * CLUSTER;
        const int count = particles_in(list, cell, m);
        const struct neighbours neighbours =
            gather_clusters(neighbour_scratch, fluid, KIND_FLUID, KIND_FLUID, cluster);
        for (int r = 0; r < count; r += GROUPS) {
            const real *const own = cluster_packed(&fluid->packed[KIND_FLUID], (size_t)cluster) + r;
            struct receiver a = receiver_at(&sides, own);
            a.dens = vspread(own + PACKED_DENS * CLUSTER);
            double slope[GROUPS][2];
            slopes_of(&neighbours, &a, slope);
            for (int g = 0; g < GROUPS && r + g < count; g++) {
                particles->slope_x[i + r + g] = slope[g][0] / fluid->k.h;
                particles->slope_y[i + r + g] = slope[g][1] / fluid->k.h;
            }
        }
    }
}

/* Packs the gradients, now that no other cell reads those fields. What the places behind a cell's
 * last particle get does not matter: they have no volume. */
SPHFSI_INLINE void pack_slopes(const struct fluid *fluid, const struct particles *particles,
                               const struct cells *cells, int32_t cell)
{
    const struct cell_list *const list = &cells->kind[KIND_FLUID];
    for (int32_t m = 0; m < clusters_in(list, cell); m++) {
        const int32_t i = list->start[cell] + m * CLUSTER;
        real *const own =
            cluster_packed(&fluid->packed[KIND_FLUID], (size_t)(list->cluster[cell] + m));
        put_four(own, PACKED_SLOPE_X, FOUR(particles->slope_x, i) * fluid->k.h);
        put_four(own, PACKED_SLOPE_Y, FOUR(particles->slope_y, i) * fluid->k.h);
    }
}

static void SWEEP(slopes)(struct fluid *fluid, struct particles kinds[KIND_COUNT],
                          const struct cells *cells)
{
    const struct cell_list *list = &cells->kind[KIND_FLUID];
    struct particles *const particles = &kinds[KIND_FLUID];
#pragma omp parallel for schedule(static) num_threads(fluid->threads)
    for (int32_t k = 0; k < (fluid->keeps_slopes ? 0 : list->n_active); k++)
        slopes_of_cell(fluid, particles, cells, list->active[k]);
#pragma omp parallel for schedule(static) num_threads(fluid->threads)
    for (int32_t k = 0; k < list->n_active; k++)
        pack_slopes(fluid, particles, cells, list->active[k]);
}
