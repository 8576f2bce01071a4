/* SPDX-License-Identifier: MIT
 * Corrected gradients of pressure, density and velocity (L-10; Negi and Ramachandran 2022): exact for
 * linear fields with any neighbours, but without conservation of momentum. Included by fluid/sweep.h,
 * once for each precision. */

/* Sums over neighbours, for a gradient that is the inverse of the first three applied to those of
 * the differences of a field. */
enum gradient_sum {
    OF_XX,
    OF_XY,
    OF_YY,
    OF_P,
    OF_DENS = OF_P + 2,
    OF_U = OF_DENS + 2,
    OF_V = OF_U + 2,
    GRADIENT_SUMS = OF_V + 2
};

/* Adds V t^3 xi xi, the matrix whose inverse makes gradients exact for linear fields, to the first
 * three sums. */
SPHFSI_INLINE void add_moments(vreal sum[][PARTS], int part, vreal wx, vreal wy,
                               const struct separation *r)
{
    sum[OF_XX][part] = vfma(wx, r->x, sum[OF_XX][part]);
    sum[OF_XY][part] = vfma(wx, r->y, sum[OF_XY][part]);
    sum[OF_YY][part] = vfma(wy, r->y, sum[OF_YY][part]);
}

/* Adds V (f_a - f_b) t^3 xi, of which grad W is a multiple, to the sums of a field. */
SPHFSI_INLINE void add_difference(vreal sum[][PARTS], int field, int part, vreal wx, vreal wy,
                                  vreal difference)
{
    sum[field][part] = vfma(wx, difference, sum[field][part]);
    sum[field + 1][part] = vfma(wy, difference, sum[field + 1][part]);
}

/* Adds the sums over one kind. Walls have the mirrored velocity, since the fluid sticks to them. */
SPHFSI_INLINE void gradient_add(const struct neighbours *neighbours, const struct receiver *a,
                                bool mirrored, double sums[GRADIENT_SUMS][GROUPS])
{
    vreal sum[GRADIENT_SUMS][PARTS] = {{{0}}};
    const int u = mirrored ? PACKED_MIRROR_U : PACKED_U, v = mirrored ? PACKED_MIRROR_V : PACKED_V;
    for (int k = 0; k < neighbours->n; k++)
        for (int part = 0; part < PARTS; part++) {
            const uint32_t code = neighbours->code[k];
            const real *const b = candidates(neighbours, code, part);
            const struct separation r = separation_from(a, code, b);
            const vreal w = gradient_weight(&r, b), wx = w * r.x, wy = w * r.y;
            add_moments(sum, part, wx, wy, &r);
            add_difference(sum, OF_P, part, wx, wy, a->p - lane(b, PACKED_P));
            add_difference(sum, OF_DENS, part, wx, wy, a->dens - lane(b, PACKED_DENS));
            add_difference(sum, OF_U, part, wx, wy, a->u - lane(b, u));
            add_difference(sum, OF_V, part, wx, wy, a->v - lane(b, v));
        }
    for (int m = 0; m < GRADIENT_SUMS; m++) {
        real of[GROUPS];
        total(sum[m], of);
        for (int g = 0; g < GROUPS; g++) sums[m][g] += (double)of[g];
    }
}

/* The gradient of the field from its sums. */
SPHFSI_INLINE void gradient_store(const struct moments *m, double sums[GRADIENT_SUMS][GROUPS],
                                  int field, int g, double h, double *x, double *y)
{
    double slope[2];
    moments_solve(m, sums[field][g], sums[field + 1][g], slope);
    *x = slope[0] / h;
    *y = slope[1] / h;
}

/* The clusters around a cell of each kind, and the neighbours of its m-th cluster among them. */
SPHFSI_INLINE void gradients_of_cell(const struct fluid *f, struct particles *p,
                                     const struct cells *c, int32_t cell)
{
    const struct cell_list *const list = &c->kind[KIND_FLUID];
    struct neighbour_scratch *const scratch = &f->neighbour_scratch[thread_index()];
    const struct cell_sides sides = cell_sides_of(f, c);
    const bool walls = f->near_dummies[cell] && f->n_near_fluid[KIND_WALL];
    gather_around_cell(scratch, f, c, KIND_FLUID, cell);
    if (walls) gather_around_cell(scratch, f, c, KIND_WALL, cell);
    for (int32_t m = 0; m < clusters_in(list, cell); m++) {
        const int32_t cluster = list->cluster[cell] + m, i = list->start[cell] + m * CLUSTER;
        const int count = particles_in(list, cell, m);
        const struct neighbours fluid =
            gather_clusters(scratch, f, KIND_FLUID, KIND_FLUID, cluster);
        const struct neighbours wall =
            walls ? gather_clusters(scratch, f, KIND_WALL, KIND_FLUID, cluster)
                  : (struct neighbours){.n = 0};
        for (int r = 0; r < count; r += GROUPS) {
            const real *const own = cluster_packed(&f->packed[KIND_FLUID], (size_t)cluster) + r;
            struct receiver a = receiver_at(&sides, own);
            a.u = vspread(own + PACKED_U * CLUSTER);
            a.v = vspread(own + PACKED_V * CLUSTER);
            a.p = vspread(own + PACKED_P * CLUSTER);
            a.dens = vspread(own + PACKED_DENS * CLUSTER);
            double sums[GRADIENT_SUMS][GROUPS] = {{0}};
            gradient_add(&fluid, &a, false, sums);
            if (wall.n) gradient_add(&wall, &a, true, sums);
            for (int g = 0; g < GROUPS && r + g < count; g++) {
                const struct moments of =
                    moments_of(sums[OF_XX][g], sums[OF_XY][g], sums[OF_YY][g]);
                const int32_t n = i + r + g;
                const double h = f->k.h;
                gradient_store(&of, sums, OF_P, g, h, &p->dp_dx[n], &p->dp_dy[n]);
                gradient_store(&of, sums, OF_DENS, g, h, &p->ddens_dx[n], &p->ddens_dy[n]);
                gradient_store(&of, sums, OF_U, g, h, &p->du_dx[n], &p->du_dy[n]);
                gradient_store(&of, sums, OF_V, g, h, &p->dv_dx[n], &p->dv_dy[n]);
            }
        }
    }
}

/* h times the gradients of the velocity, for the Laplacian and for the pairs. */
SPHFSI_INLINE void pack_gradients(const struct fluid *f, const struct particles *p,
                                  const struct cells *c, int32_t cell)
{
    const struct cell_list *const list = &c->kind[KIND_FLUID];
    for (int32_t m = 0; m < list->count[cell]; m++) {
        const int32_t i = list->start[cell] + m;
        real *const own = cluster_packed(&f->packed[KIND_FLUID],
                                         (size_t)list->cluster[cell] + (size_t)m / CLUSTER) +
                          m % CLUSTER;
        own[PACKED_DU_DX * CLUSTER] = (real)(p->du_dx[i] * f->k.h);
        own[PACKED_DU_DY * CLUSTER] = (real)(p->du_dy[i] * f->k.h);
        own[PACKED_DV_DX * CLUSTER] = (real)(p->dv_dx[i] * f->k.h);
        own[PACKED_DV_DY * CLUSTER] = (real)(p->dv_dy[i] * f->k.h);
    }
}

/* L-11: the Laplacian of the velocity as the divergence of its gradient, over the fluid alone, as
 * walls have no gradient. */
static void laplacian_of(const struct neighbours *neighbours, const struct receiver *a,
                         const struct velocity_gradient *own, double laplacian[GROUPS][2])
{
    enum { U_XX = OF_P, U_XY, U_YY, V_XX, V_XY, V_YY, ALL };
    vreal sum[ALL][PARTS] = {{{0}}};
    for (int k = 0; k < neighbours->n; k++)
        for (int part = 0; part < PARTS; part++) {
            const uint32_t code = neighbours->code[k];
            const real *const b = candidates(neighbours, code, part);
            const struct separation r = separation_from(a, code, b);
            const vreal w = gradient_weight(&r, b), wx = w * r.x, wy = w * r.y;
            const vreal u_x = own->u_x - lane(b, PACKED_DU_DX),
                        u_y = own->u_y - lane(b, PACKED_DU_DY),
                        v_x = own->v_x - lane(b, PACKED_DV_DX),
                        v_y = own->v_y - lane(b, PACKED_DV_DY);
            add_moments(sum, part, wx, wy, &r);
            sum[U_XX][part] = vfma(u_x, wx, sum[U_XX][part]);
            sum[U_XY][part] = sum[U_XY][part] + vfma(u_x, wy, u_y * wx);
            sum[U_YY][part] = vfma(u_y, wy, sum[U_YY][part]);
            sum[V_XX][part] = vfma(v_x, wx, sum[V_XX][part]);
            sum[V_XY][part] = sum[V_XY][part] + vfma(v_x, wy, v_y * wx);
            sum[V_YY][part] = vfma(v_y, wy, sum[V_YY][part]);
        }
    real of[ALL][GROUPS];
    for (int m = 0; m < ALL; m++) total(sum[m], of[m]);
    for (int g = 0; g < GROUPS; g++) {
        const struct moments m =
            moments_of((double)of[OF_XX][g], (double)of[OF_XY][g], (double)of[OF_YY][g]);
        laplacian[g][0] =
            moments_trace(&m, (double)of[U_XX][g], (double)of[U_XY][g], (double)of[U_YY][g]);
        laplacian[g][1] =
            moments_trace(&m, (double)of[V_XX][g], (double)of[V_XY][g], (double)of[V_YY][g]);
    }
}

SPHFSI_INLINE void laplacians_of_cell(const struct fluid *f, struct particles *p,
                                      const struct cells *c, int32_t cell)
{
    const struct cell_list *const list = &c->kind[KIND_FLUID];
    struct neighbour_scratch *const scratch = &f->neighbour_scratch[thread_index()];
    const struct cell_sides sides = cell_sides_of(f, c);
    gather_around_cell(scratch, f, c, KIND_FLUID, cell);
    for (int32_t m = 0; m < clusters_in(list, cell); m++) {
        const int32_t cluster = list->cluster[cell] + m, i = list->start[cell] + m * CLUSTER;
        const int count = particles_in(list, cell, m);
        const struct neighbours near = gather_clusters(scratch, f, KIND_FLUID, KIND_FLUID, cluster);
        for (int r = 0; r < count; r += GROUPS) {
            const real *const own = cluster_packed(&f->packed[KIND_FLUID], (size_t)cluster) + r;
            const struct receiver a = receiver_at(&sides, own);
            const struct velocity_gradient gradient = gradient_at(own);
            double laplacian[GROUPS][2];
            laplacian_of(&near, &a, &gradient, laplacian);
            for (int g = 0; g < GROUPS && r + g < count; g++) {
                p->lap_u[i + r + g] = laplacian[g][0] / square(f->k.h);
                p->lap_v[i + r + g] = laplacian[g][1] / square(f->k.h);
            }
        }
    }
}

static void SWEEP(gradients)(const struct fluid *f, struct particles kinds[KIND_COUNT],
                             const struct cells *c)
{
    const struct cell_list *const list = &c->kind[KIND_FLUID];
    struct particles *const p = &kinds[KIND_FLUID];
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (int32_t k = 0; k < list->n_active; k++) gradients_of_cell(f, p, c, list->active[k]);
    if (!(f->effects & FX_LAMINAR)) return;
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (int32_t k = 0; k < list->n_active; k++) pack_gradients(f, p, c, list->active[k]);
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (int32_t k = 0; k < list->n_active; k++) laplacians_of_cell(f, p, c, list->active[k]);
}
