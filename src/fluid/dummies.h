/* SPDX-License-Identifier: MIT
 * Walls and structures in the fluid's sweeps: pressures and mirrored velocities from the
 * fluid around them. Included by fluid/sweep.h, once for each precision. */

/* Sum of the kernel over the fluid within reach of a dummy, below which there is none. */
#define LEAST_WEIGHT 1e-12

/* The kernel without its factor alpha_D, at distances of q h. */
SPHFSI_INLINE vreal kernel_of(vreal q)
{
    const vreal t = vmax(vset(0), vfma(vset((real)-0.5), q, vset(1))), t2 = t * t;
    return t2 * t2 * vfma(vset(2), q, vset(1));
}

/* Sums over the fluid within reach of wall or solid particles: of the kernel, and times it of the
 * pressure and of rho/rho0 times the vector from the fluid. */
struct sums_around {
    real w[CLUSTER], p[CLUSTER], x[CLUSTER], y[CLUSTER];
};

/* For the receivers from number r on. */
SPHFSI_INLINE void sum_around(const struct neighbours *neighbours, const struct receiver *s, int r,
                              struct sums_around *sum)
{
    vreal sum_w[PARTS] = {{0}}, sum_p[PARTS] = {{0}}, sum_x[PARTS] = {{0}}, sum_y[PARTS] = {{0}};
    EACH_CANDIDATE(neighbours, part, code, b)
    {
        const struct separation d = separation_from(s, code, b, false);
        const vreal w = weight_seen(s, &d, kernel_of(d.length));
        const vreal mass = w * (vset(1) + lane(b, PACKED_DENS));
        sum_w[part] = sum_w[part] + w;
        sum_p[part] = vfma(w, lane(b, PACKED_P), sum_p[part]);
        sum_x[part] = vfma(mass, d.x, sum_x[part]);
        sum_y[part] = vfma(mass, d.y, sum_y[part]);
    }
    sum_lanes(sum_w, &sum->w[r]);
    sum_lanes(sum_p, &sum->p[r]);
    sum_lanes(sum_x, &sum->x[r]);
    sum_lanes(sum_y, &sum->y[r]);
}

/* Eq. 19 in the form of Adami et al. 2012, Eq. 27: pressure of wall or solid particles with
 * accelerations (ax, ay) from the fluid within reach; 0 if there is none. A particle alone on a
 * wall interacts with its own pressure only. With suction as well as pressure its bouncing grew on
 * the gate's bed (dp = 1 mm) to 20 % of density and a third of c0. */
SPHFSI_INLINE four_double extrapolated_pressure(const struct fluid_constants *k,
                                                const struct sums_around *sum, four_double ax,
                                                four_double ay)
{
    const four_double w = four_widen(FOUR_REAL(sum->w));
    const four_double lift = (k->gravity[0] - ax) * four_widen(FOUR_REAL(sum->x)) +
                             (k->gravity[1] - ay) * four_widen(FOUR_REAL(sum->y));
    const four_double mean = (four_widen(FOUR_REAL(sum->p)) + k->rho0 * k->h * lift) / w;
    const four_double lowest = k->lowest_wall_pressure + 0 * w; /* NaN at w = 0 is masked */
    return (four_double)((four_long)four_max(lowest, mean) & (w > LEAST_WEIGHT));
}

/* Adami et al. 2012, Eqs. 22 and 23: twice the velocities (u, v) of wall or solid particles less
 * the mean of the fluid around. Halfway between both the velocity is the surface's. */
SPHFSI_INLINE void mirrored_velocity(const struct neighbours *neighbours, const struct receiver *s,
                                     double *u, double *v)
{
    vreal sum_w[PARTS] = {{0}}, sum_u[PARTS] = {{0}}, sum_v[PARTS] = {{0}};
    EACH_CANDIDATE(neighbours, part, code, b)
    {
        const struct separation d = separation_from(s, code, b, false);
        const vreal w = weight_seen(s, &d, kernel_of(d.length));
        sum_w[part] = sum_w[part] + w;
        sum_u[part] = vfma(w, lane(b, PACKED_U), sum_u[part]);
        sum_v[part] = vfma(w, lane(b, PACKED_V), sum_v[part]);
    }
    real weight[GROUPS], fluid_u[GROUPS], fluid_v[GROUPS];
    sum_lanes(sum_w, weight);
    sum_lanes(sum_u, fluid_u);
    sum_lanes(sum_v, fluid_v);
    for (int g = 0; g < GROUPS; g++) {
        if (!((double)weight[g] > LEAST_WEIGHT)) continue;
        u[g] = 2 * u[g] - (double)fluid_u[g] / (double)weight[g];
        v[g] = 2 * v[g] - (double)fluid_v[g] / (double)weight[g];
    }
}

/* The particles of a cluster: their number and their indices in the arrays. */
struct dummy_cluster {
    enum kind kind;
    int count;
    const int32_t *index; /* [count] */
    size_t cluster;
    real *packed;
};

/* Copies a field of the particles of a cluster, or zeros if it is NULL. */
SPHFSI_INLINE void gather(const struct dummy_cluster *d, const double *field, double out[CLUSTER])
{
    memset(out, 0, CLUSTER * sizeof *out);
    if (!field) return;
    for (int r = 0; r < d->count; r++) out[r] = field[d->index[r]];
}

/* The velocity of a structure that the fluid uses. Walls have none unless a motion moves them. */
SPHFSI_INLINE void gather_velocity(const struct fluid *fluid, const struct dummy_cluster *d,
                                   const struct particles *particles, double u[CLUSTER],
                                   double v[CLUSTER])
{
    const bool moves = fluid->effects & FX_MOTION, solid = d->kind == KIND_SOLID;
    gather(d, solid ? particles->wx : moves ? particles->vx : NULL, u);
    gather(d, solid ? particles->wy : moves ? particles->vy : NULL, v);
}

SPHFSI_INLINE void scatter(const struct dummy_cluster *d, const double in[CLUSTER], double *field)
{
    for (int r = 0; r < d->count; r++) field[d->index[r]] = in[r];
}

/* Lanes without particles get zeros, hence no volume. */
SPHFSI_INLINE void pack_four(const struct dummy_cluster *d, const double in[CLUSTER],
                             enum packed_field m)
{
    put_four(d->packed, m, (four_double) * (const four_double_at *)in);
}

/* Packs positions of dummies and their bounding box. */
SPHFSI_INLINE void place_dummies(const struct fluid *fluid, const struct particles *particles,
                                 const struct cells *cells, int32_t cell,
                                 const struct dummy_cluster *d, const struct cell_sides *sides)
{
    const double inv_h = 1 / fluid->k.h;
    for (int r = 0; r < d->count; r++) {
        const int32_t i = d->index[r];
        const double x =
            cells_minimum_image(cells, 0, particles->x[i] - cell_centre_x(cells, cell));
        const double y =
            cells_minimum_image(cells, 1, particles->y[i] - cell_centre_y(cells, cell));
        d->packed[PACKED_X * CLUSTER + r] = (real)(x * inv_h);
        d->packed[PACKED_Y * CLUSTER + r] = (real)(y * inv_h);
    }
    cluster_close(d->packed, fluid->packed[d->kind].n, d->count);
    for (int r = 0; r < d->count && sides->piece; r++)
        d->packed[PACKED_LINE * CLUSTER + r] = (real)fluid_line_before(fluid, d->kind, d->index[r]);
    cluster_box(&fluid->packed[d->kind].boxes, d->cluster, d->packed, d->count);
}

/* Packs what law_one_sided needs of dummies. */
SPHFSI_INLINE void pack_lift(const struct fluid *fluid, const struct particles *particles,
                             const struct dummy_cluster *d)
{
    const double lift = fluid->k.rho0 * fluid->k.h;
    double ax[CLUSTER], ay[CLUSTER];
    gather(d, particles->ax, ax);
    gather(d, particles->ay, ay);
    put_four(d->packed, PACKED_LIFT_X, lift * (fluid->k.gravity[0] - FOUR(ax, 0)));
    put_four(d->packed, PACKED_LIFT_Y, lift * (fluid->k.gravity[1] - FOUR(ay, 0)));
}

/* Packs the range of repulsion (law_repulsion). */
SPHFSI_INLINE void pack_repulsion(const struct fluid *fluid, const struct particles *particles,
                                  const struct dummy_cluster *d, bool thin)
{
    double repulsion2[CLUSTER] = {0};
    for (int r = 0; r < d->count; r++)
        repulsion2[r] = fluid->repulsion2[d->kind][particles->body[d->index[r]]];
    for (int r = 0; r < d->count && thin; r++)
        if (fluid_line_of(fluid, d->kind, d->index[r]))
            repulsion2[r] =
                square(fluid_repels_from(fluid, d->kind, particles, d->index[r]) / fluid->k.h) +
                ETA2;
    pack_four(d, repulsion2, PACKED_REPULSION2);
}

/* Packs mirrored velocities where the fluid sticks; elsewhere the body's own velocity. With
 * one-sided pressure a particle's own image has 2 v_s - v_a: v_s with twice the weight (L-6b). */
SPHFSI_INLINE void pack_mirrored_velocity(const struct fluid *fluid,
                                          const struct particles *particles,
                                          const struct dummy_cluster *d,
                                          const struct neighbours *neighbours,
                                          const struct cell_sides *sides)
{
    const bool own_image = fluid->effects & FX_ONE_SIDED;
    double sticks[CLUSTER] = {0}, u[CLUSTER], v[CLUSTER], mirror_u[CLUSTER], mirror_v[CLUSTER];
    gather_velocity(fluid, d, particles, u, v);
    memcpy(mirror_u, u, sizeof mirror_u);
    memcpy(mirror_v, v, sizeof mirror_v);
    for (int r = 0; r < CLUSTER && neighbours->n && !own_image; r += GROUPS) {
        const struct receiver s = dummy_at(sides, d->packed + r);
        mirrored_velocity(neighbours, &s, &mirror_u[r], &mirror_v[r]);
    }
    for (int r = 0; r < d->count; r++) {
        const bool clings = neighbours->n && fluid->sticks[d->kind][particles->body[d->index[r]]];
        sticks[r] = clings ? 1 + own_image : 0;
        if (sticks[r] != 0) continue;
        mirror_u[r] = u[r];
        mirror_v[r] = v[r];
    }
    pack_four(d, mirror_u, PACKED_MIRROR_U);
    pack_four(d, mirror_v, PACKED_MIRROR_V);
    pack_four(d, sticks, PACKED_STICKS);
}

/* T-110c: the share of the place of dummies that fluid of their own side fills: all of it where the
 * kernel sees half; and the direction in which fluid slides along their line, times its root. */
SPHFSI_INLINE void pack_filled(const struct fluid *fluid, const struct dummy_cluster *d,
                               const struct neighbours *neighbours, const struct cell_sides *sides)
{
    double t[CLUSTER][2] = {{0}};
    real filled[CLUSTER] = {0};
    for (int r = 0; r < CLUSTER && neighbours->n; r += GROUPS) {
        const struct receiver s = receiver_at(sides, d->packed + r);
        vreal sum[PARTS] = {{0}};
        EACH_CANDIDATE(neighbours, part, code, b)
        {
            const struct separation at = separation_from(&s, code, b, true);
            const vreal volume = lane(b, PACKED_VOLUME);
            sum[part] = vfma(volume, weight_seen(&s, &at, kernel_of(at.length)), sum[part]);
        }
        sum_lanes(sum, &filled[r]);
    }
    for (int r = 0; r < d->count; r++) {
        const int32_t line = fluid_line_before(fluid, d->kind, d->index[r]);
        const double inside = line ? fluid_line_dummy(fluid, d->kind, d->index[r])->inside : 0,
                     wet = (1 - inside) * min2(1, 2 * KERNEL_NORM * (double)filled[r]),
                     phi = inside + wet, part = sqrt(wet);
        if (line) line_slides(&fluid->lines.line[line - 1], d->index[r], t[r]);
        if (line) fluid->lines.filled[d->index[r]] = phi;
        d->packed[PACKED_FILLED * CLUSTER + r] = (real)phi;
        d->packed[PACKED_ALONG_X * CLUSTER + r] = (real)(part * t[r][0]);
        d->packed[PACKED_ALONG_Y * CLUSTER + r] = (real)(part * t[r][1]);
    }
}

/* The m-th cluster of dummies in a cell. */
SPHFSI_INLINE struct dummy_cluster dummies_at(const struct fluid *fluid, const struct cells *cells,
                                              enum kind kind, int32_t cell, int32_t m)
{
    const struct cell_list *const list = &cells->list[kind];
    const size_t cluster = (size_t)list->cluster[cell] + (size_t)m;
    return (struct dummy_cluster){kind, particles_in(list, cell, m),
                                  &list->order[list->start[cell] + m * CLUSTER], cluster,
                                  cluster_packed(&fluid->packed[kind], cluster)};
}

/* Pressure of dummies from the fluid within reach. */
SPHFSI_INLINE void dummies_pressure(const struct fluid *fluid, const struct particles *particles,
                                    const struct dummy_cluster *d,
                                    const struct neighbours *neighbours,
                                    const struct cell_sides *sides, double pressure[CLUSTER])
{
    struct sums_around sum;
    double ax[CLUSTER], ay[CLUSTER];
    gather(d, particles->ax, ax);
    gather(d, particles->ay, ay);
    for (int r = 0; r < CLUSTER; r += GROUPS) {
        const struct receiver s = dummy_at(sides, d->packed + r);
        sum_around(neighbours, &s, r, &sum);
    }
    *(four_double_at *)pressure = extrapolated_pressure(&fluid->k, &sum, FOUR(ax, 0), FOUR(ay, 0));
}

/* Packs velocity, volume, pressure and density of dummies. Eqs. 19-21 with each dummy's volume: a
 * solid may be finer. */
SPHFSI_INLINE void dummies_state(const struct fluid *fluid, const struct particles *particles,
                                 const struct dummy_cluster *d, const double pressure[CLUSTER],
                                 const double dens[CLUSTER], bool thin)
{
    const double mean = fluid->k.mass / fluid->k.rho0 * square(1 / fluid->k.h);
    double u[CLUSTER], v[CLUSTER], volume[CLUSTER] = {0}, acting[CLUSTER];
    gather_velocity(fluid, d, particles, u, v);
    /* On their side of a pair: the pressure of T-10, or none where the fluid's own takes its place
     * (L-6); and on a structure that of the interface impulse (T-35b). */
    gather(d,
           d->kind == KIND_SOLID || fluid->effects & (FX_RIGID | FX_BEAM)
               ? particles->interface_pressure
               : NULL,
           acting);
    if (!(fluid->effects & FX_ONE_SIDED)) *(four_double_at *)acting += FOUR(pressure, 0);
    for (int r = 0; r < d->count; r++)
        volume[r] = mean * (thin ? fluid_volume_of(fluid, d->kind, particles, d->index[r])
                                 : fluid->volume[d->kind][particles->body[d->index[r]]]);
    /* At rest, particles whose masses fit their density fill a cell at any depth: so do dummies. */
    if (!(fluid->effects & FX_MASSES)) *(four_double_at *)volume /= 1 + FOUR(dens, 0);
    pack_four(d, u, PACKED_U);
    pack_four(d, v, PACKED_V);
    pack_four(d, volume, PACKED_VOLUME);
    pack_four(d, acting, PACKED_P);
    pack_four(d, dens, PACKED_DENS);
}

_Static_assert(CELL_CAPACITY % EOS_BLOCK == 0, "a cell's dummies fill whole blocks");

/* Pressures and state of the dummies of a cell: zeros where no fluid is near. */
SPHFSI_INLINE void dummies_of_cell(const struct fluid *fluid, struct particles *particles,
                                   enum kind kind, const struct cells *cells, int32_t cell,
                                   bool thin)
{
    struct neighbour_scratch *const neighbour_scratch = &fluid->neighbour_scratch[thread_index()];
    const struct cell_sides sides = cell_sides_of(fluid, cells, cell, thin);
    const int32_t clusters = clusters_in(&cells->list[kind], cell);
    static const double none[CLUSTER] = {0};
    double pressure[CELL_CAPACITY], dens[CELL_CAPACITY]; /* of the clusters near fluid */
    int32_t wet[CELL_CAPACITY / CLUSTER], n = 0;
    gather_around_cell(neighbour_scratch, fluid, cells, KIND_FLUID, cell);
    for (int32_t m = 0; m < clusters; m++) {
        const struct dummy_cluster d = dummies_at(fluid, cells, kind, cell, m);
        const bool moves = dummies_move(fluid, kind, particles, d.index, d.count);
        if (moves || !fluid->walls_placed) place_dummies(fluid, particles, cells, cell, &d, &sides);
        const struct neighbours neighbours =
            gather_clusters(neighbour_scratch, fluid, KIND_FLUID, kind, (int32_t)d.cluster);
        if (fluid->effects & FX_ONE_SIDED) pack_lift(fluid, particles, &d);
        if (fluid->effects & FX_REPULSION) pack_repulsion(fluid, particles, &d, thin);
        if (thin) pack_filled(fluid, &d, &neighbours, &sides);
        if (fluid->effects & FX_NO_SLIP)
            pack_mirrored_velocity(fluid, particles, &d, &neighbours, &sides);
        if (neighbours.n > 0) {
            dummies_pressure(fluid, particles, &d, &neighbours, &sides, &pressure[n * CLUSTER]);
            wet[n++] = m;
            continue;
        }
        scatter(&d, none, particles->p);
        scatter(&d, none, particles->dens);
        if (moves) dummies_state(fluid, particles, &d, none, none, thin);
    }
    for (int32_t m = n * CLUSTER; m % EOS_BLOCK; m++) pressure[m] = 0;
    for (int32_t m = 0; m < n * CLUSTER; m += EOS_BLOCK)
        eos_dens_of_block(&pressure[m], fluid->k.rho0, fluid->k.c0, &dens[m]);
    for (int32_t m = 0; m < n; m++) {
        const struct dummy_cluster d = dummies_at(fluid, cells, kind, cell, wet[m]);
        scatter(&d, &pressure[m * CLUSTER], particles->p);
        scatter(&d, &dens[m * CLUSTER], particles->dens);
        dummies_state(fluid, particles, &d, &pressure[m * CLUSTER], &dens[m * CLUSTER], thin);
    }
}

static void SWEEP(update_dummies)(const struct fluid *fluid, struct particles kinds[KIND_COUNT],
                                  const struct cells *cells, enum kind kind)
{
    struct particles *const particles = &kinds[kind];
    const int32_t *const cell = fluid->near_fluid[kind], n = fluid->n_near_fluid[kind];
    /* A loop each: in one the registers that thin lines need would slow the other scenes. */
    if (fluid->effects & FX_THIN) {
#pragma omp parallel for schedule(static) num_threads(fluid->threads)
        for (int32_t k = 0; k < n; k++)
            dummies_of_cell(fluid, particles, kind, cells, cell[k], true);
        return;
    }
#pragma omp parallel for schedule(static) num_threads(fluid->threads)
    for (int32_t k = 0; k < n; k++) dummies_of_cell(fluid, particles, kind, cells, cell[k], false);
}
