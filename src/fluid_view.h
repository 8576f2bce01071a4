/* SPDX-License-Identifier: MIT
 * How a cluster of particles looks at the clusters near it, and the pairs that it sees. A part of the sweeps'
 * text (fluid_sweep.h), once for each precision. */

_Static_assert((int)CLUSTER == (int)GROUP, "a group of lanes is a cluster");

/* Vectors that the candidates of a cluster take; sums over each are kept apart, so that they are the same as
 * where one is enough. */
enum { PARTS = (int)CLUSTER * (int)GROUPS / (int)LANES };

/* Vectors that the receivers of a cluster take. */
enum { ROWS = (int)CLUSTER / (int)GROUPS };

/* A field of the particles at b, in every group. */
#define lane(b, field) vfour((b) + (field)*CLUSTER)

/* What a cluster sees of one kind. */
struct view {
    const real *lanes;
    size_t stride; /* items of a cluster */
    const uint32_t *seen;
    int n; /* clusters */
};

/* For each cluster that is seen, and each of its parts. */
#define EACH_SEEN(see, k, part)        \
    for (int k = 0; k < (see)->n; k++) \
        for (int part = 0; part < PARTS; part++)

/* The candidates in a part of a cluster. */
SPHFSI_INLINE const real *candidates(const struct view *see, uint32_t seen, int part)
{
    return see->lanes + seen_number(seen) * see->stride + part * LANES;
}

/* The sums of the receivers over all candidates. */
SPHFSI_INLINE void total(const vreal sum[PARTS], real out[GROUPS])
{
    vsum_four(PARTS == 1 ? sum[0] : sum[0] + sum[PARTS - 1], out);
}

SPHFSI_INLINE void look_around(struct sight *sight, const struct fluid *f, const struct cells *c,
                               enum kind kind, int32_t cell)
{
    clusters_around(&sight->around[kind], &f->lanes[kind].boxes, c, kind, cell, f->k.h);
}

SPHFSI_INLINE struct view view_of(const struct lanes *lanes, const struct cluster_list *near)
{
    return (struct view){(const real *)lanes->cluster, (size_t)(lanes->n * CLUSTER), near->seen,
                         near->n};
}

/* What the cluster `own` of one kind sees of another, around whose cell it was looked. */
SPHFSI_INLINE struct view look_at(struct sight *sight, const struct fluid *f, enum kind kind,
                                  enum kind own, int32_t cluster)
{
    struct cluster_list *const near = &sight->near[kind];
    clusters_near(near, &sight->around[kind], &f->lanes[own].boxes, cluster);
    return view_of(&f->lanes[kind], near);
}

/* What the next cluster of a cell of fluid sees of the fluid outside of its share and ahead. */
SPHFSI_INLINE struct view look_ahead(struct sight *sight, const struct fluid *f)
{
    struct cluster_list *const near = &sight->near[KIND_FLUID];
    clusters_ahead_near(near, &sight->around[KIND_FLUID], &f->lanes[KIND_FLUID].boxes);
    return view_of(&f->lanes[KIND_FLUID], near);
}

/* Sides of the cells in units of h. */
struct cell_sides {
    real x, y;
};

static struct cell_sides cell_sides_of(const struct fluid *f, const struct cells *c)
{
    return (struct cell_sides){(real)(c->side[0] / f->k.h), (real)(c->side[1] / f->k.h)};
}

/* Particles a, one to each group of four lanes; with their places as seen from the centres of the three
 * columns and rows of cells around. */
struct receiver {
    vreal x[3], y[3], u, v, p, dens, volume;
    vreal slope_x, slope_y; /* h times the gradient of dens, where it is taken */
    vreal viscous;          /* -(1 + dens) times the constant `viscosity`, of its unit */
};

/* Pairs of each a with the candidates b, one to each lane of a group. */
struct pair {
    vreal x, y;    /* xi_ab */
    vreal r2;      /* |xi_ab|^2 */
    vreal u, v;    /* v_ab, m/s */
    vreal vx;      /* v_ab . xi_ab, m/s */
    vreal slope;   /* V_b/h^2 t^3; in the sums of the fluid times V_a/h^2 */
    vreal p, dens; /* of b */
    vreal slope_x, slope_y;
};

/* Receivers from their lanes on, as far as geometry goes. */
SPHFSI_INLINE struct receiver receiver_at(const struct cell_sides *sides, const real *own)
{
    struct receiver a;
    const vreal x = vspread(own + LANE_X * CLUSTER), y = vspread(own + LANE_Y * CLUSTER);
    const vreal side_x = vset(sides->x), side_y = vset(sides->y);
    a.x[0] = x + side_x;
    a.x[1] = x;
    a.x[2] = x - side_x;
    a.y[0] = y + side_y;
    a.y[1] = y;
    a.y[2] = y - side_y;
    /* cppcheck-suppress uninitvar ; the others are loaded by those sweeps that need them */
    return a;
}

/* How many particles the m-th cluster of a cell has. */
SPHFSI_INLINE int particles_in(const struct cell_list *list, int32_t cell, int32_t m)
{
    const int32_t rest = list->count[cell] - m * CLUSTER;
    return rest < CLUSTER ? rest : CLUSTER;
}

/* From candidates to receivers, in units of h. */
struct way {
    vreal x, y, length;
};

SPHFSI_INLINE struct way way_from(const struct receiver *a, uint32_t seen, const real *b)
{
    struct way d;
    d.x = a->x[seen_column(seen)] - lane(b, LANE_X);
    d.y = a->y[seen_row(seen)] - lane(b, LANE_Y);
    d.length = vsqrt(vfma(d.y, d.y, d.x * d.x));
    return d;
}

/* Geometry of the pairs, Eq. 5. */
SPHFSI_INLINE struct pair pair_load(const struct receiver *a, uint32_t seen, const real *b)
{
    struct pair q;
    q.x = a->x[seen_column(seen)] - lane(b, LANE_X);
    q.y = a->y[seen_row(seen)] - lane(b, LANE_Y);
    q.r2 = vfma(q.y, q.y, q.x * q.x);
    const vreal t = vmax(vset(0), vset(2) - vsqrt(q.r2));
    q.slope = lane(b, LANE_VOLUME) * (t * t * t);
    q.u = a->u - lane(b, LANE_U);
    q.v = a->v - lane(b, LANE_V);
    q.vx = vfma(q.v, q.y, q.u * q.x);
    /* cppcheck-suppress uninitvar ; p and dens are loaded by those laws that need them */
    return q;
}
