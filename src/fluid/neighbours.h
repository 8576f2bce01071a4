/* SPDX-License-Identifier: MIT
 * The neighbour clusters of a cluster of particles, and the pairs of both. Included by
 * fluid/sweep.h and coupling/force.h, once for each precision. */

_Static_assert((int)CLUSTER == (int)GROUP, "a group of lanes is a cluster");

/* Vectors for the candidates of a cluster. Sums over each are kept separate, so that they equal
 * those with one wider vector. */
enum { PARTS = (int)CLUSTER * (int)GROUPS / (int)LANES };

/* Vectors for the receivers of a cluster. */
enum { ROWS = (int)CLUSTER / (int)GROUPS };

/* A field of the particles at b, in every group. */
#define lane(b, field) vfour((b) + (field)*CLUSTER)

/* The packed fields of a cluster; those of its field m are at packed + m CLUSTER. */
SPHFSI_INLINE real *cluster_packed(const struct packed_fields *packed, size_t cluster)
{
    return (real *)packed->cluster + cluster * (size_t)(packed->n * CLUSTER);
}

/* The neighbour clusters of one kind. */
struct neighbours {
    const real *packed;
    size_t items; /* items of a cluster */
    const uint32_t *code;
    int n; /* clusters */
};

/* The candidates in a part of a cluster. */
SPHFSI_INLINE const real *candidates(const struct neighbours *neighbours, uint32_t code, int part)
{
    return neighbours->packed + neighbour_number(code) * neighbours->items + part * LANES;
}

/* The sums of the receivers over all candidates. */
SPHFSI_INLINE void total(const vreal sum[PARTS], real out[GROUPS])
{
    vsum_four(PARTS == 1 ? sum[0] : sum[0] + sum[PARTS - 1], out);
}

SPHFSI_INLINE void gather_around_cell(struct neighbour_scratch *neighbour_scratch,
                                      const struct fluid *fluid, const struct cells *cells,
                                      enum kind kind, int32_t cell)
{
    neighbour_clusters_collect(&neighbour_scratch->around[kind], &fluid->packed[kind].boxes, cells,
                               kind, cell, fluid->k.h, (struct cluster_range){0});
}

SPHFSI_INLINE struct neighbours neighbours_of(const struct packed_fields *packed,
                                              const struct cluster_list *near)
{
    return (struct neighbours){(const real *)packed->cluster, (size_t)(packed->n * CLUSTER),
                               near->code, near->n};
}

/* The neighbours of the cluster `own` of one kind among another kind, from the clusters collected
 * around its cell. */
SPHFSI_INLINE struct neighbours gather_clusters(struct neighbour_scratch *neighbour_scratch,
                                                const struct fluid *fluid, enum kind kind,
                                                enum kind own, int32_t cluster)
{
    struct cluster_list *const near = &neighbour_scratch->near[kind];
    cluster_list_build(near, &neighbour_scratch->around[kind], &fluid->packed[own].boxes, cluster);
    return neighbours_of(&fluid->packed[kind], near);
}

/* The neighbours of the next cluster of a fluid cell: fluid outside its chunk and fluid ahead in
 * it. */
SPHFSI_INLINE struct neighbours gather_clusters_ahead(struct neighbour_scratch *neighbour_scratch,
                                                      const struct fluid *fluid)
{
    struct cluster_list *const near = &neighbour_scratch->near[KIND_FLUID];
    cluster_list_build_half(near, &neighbour_scratch->around[KIND_FLUID],
                            &fluid->packed[KIND_FLUID].boxes);
    return neighbours_of(&fluid->packed[KIND_FLUID], near);
}

/* Sides of the cells in units of h. */
struct cell_sides {
    real x, y;
};

SPHFSI_INLINE struct cell_sides cell_sides_of(const struct fluid *fluid, const struct cells *cells)
{
    return (struct cell_sides){(real)(cells->side[0] / fluid->k.h),
                               (real)(cells->side[1] / fluid->k.h)};
}

/* Particles a, one in each group of four lanes; with their positions relative to the centres of the
 * three columns and rows of cells around. */
struct receiver {
    vreal x[3], y[3], u, v, p, dens, volume;
    vreal slope_x, slope_y; /* h times the gradient of dens, if it is used */
    vreal specific;         /* rho0/rho, with artificial viscosity */
};

/* Pairs of each a with the candidates b, one in each lane of a group. */
struct pair {
    vreal x, y;    /* xi_ab */
    vreal r2;      /* |xi_ab|^2 */
    vreal u, v;    /* v_ab, m/s */
    vreal vx;      /* v_ab . xi_ab, m/s */
    vreal slope;   /* V_b/h^2 t^3; in the sums of the fluid times V_a/h^2 */
    vreal p, dens; /* of b */
    vreal slope_x, slope_y;
};

/* Receivers from their packed fields: geometry only. */
SPHFSI_INLINE struct receiver receiver_at(const struct cell_sides *sides, const real *own)
{
    struct receiver a;
    const vreal x = vspread(own + PACKED_X * CLUSTER), y = vspread(own + PACKED_Y * CLUSTER);
    const vreal side_x = vset(sides->x), side_y = vset(sides->y);
    a.x[0] = x + side_x;
    a.x[1] = x;
    a.x[2] = x - side_x;
    a.y[0] = y + side_y;
    a.y[1] = y;
    a.y[2] = y - side_y;
    /* cppcheck-suppress uninitvar ; the other fields are loaded by the sweeps that need them */
    return a;
}

/* Number of particles in the m-th cluster of a cell. */
SPHFSI_INLINE int particles_in(const struct cell_list *list, int32_t cell, int32_t m)
{
    const int32_t rest = list->count[cell] - m * CLUSTER;
    return rest < CLUSTER ? rest : CLUSTER;
}

/* Vector from candidates to receivers, in units of h. */
struct separation {
    vreal x, y, length;
};

SPHFSI_INLINE struct separation separation_from(const struct receiver *a, uint32_t code,
                                                const real *b)
{
    struct separation d;
    d.x = a->x[neighbour_column(code)] - lane(b, PACKED_X);
    d.y = a->y[neighbour_row(code)] - lane(b, PACKED_Y);
    d.length = vsqrt(vfma(d.y, d.y, d.x * d.x));
    return d;
}

/* Geometry of the pairs, Eq. 5. */
SPHFSI_INLINE struct pair pair_load(const struct receiver *a, uint32_t code, const real *b)
{
    struct pair q;
    q.x = a->x[neighbour_column(code)] - lane(b, PACKED_X);
    q.y = a->y[neighbour_row(code)] - lane(b, PACKED_Y);
    q.r2 = vfma(q.y, q.y, q.x * q.x);
    const vreal t = vmax(vset(0), vset(2) - vsqrt(q.r2));
    q.slope = lane(b, PACKED_VOLUME) * (t * t * t);
    q.u = a->u - lane(b, PACKED_U);
    q.v = a->v - lane(b, PACKED_V);
    q.vx = vfma(q.v, q.y, q.u * q.x);
    /* cppcheck-suppress uninitvar ; p and dens are loaded by the laws that need them */
    return q;
}
