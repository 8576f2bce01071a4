/* SPDX-License-Identifier: MIT
 * The neighbour clusters of a cluster of particles, and the pairs of both. Included by
 * fluid/sweep.h and coupling/force.h, once for each precision. */
#include "base/threads.h"

_Static_assert((int)CLUSTER == (int)GROUP, "a group of lanes is a cluster");

/* Vectors for the candidates of a cluster, with separate sums, equal to those of a wider one. */
enum { PARTS = (int)CLUSTER * (int)GROUPS / (int)LANES };

/* Vectors for the receivers of a cluster. */
enum { ROWS = (int)CLUSTER / (int)GROUPS };

/* A field of the particles at b, in every group. */
#define lane(b, field) vfour((b) + (field)*CLUSTER)

/* Four numbers at p. */
#define FOUR_REAL(p) (*(const four_real *)(const void *)(p))

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

/* Each part of the clusters, with its cluster's code; b: its packed candidates. */
#define EACH_CANDIDATE(neighbours, part, code, b)                                            \
    uint32_t code;                                                                           \
    const real *b;                                                                           \
    for (int m_ = 0; m_ < (neighbours)->n; m_++)                                             \
        for (int part = 0; part < PARTS && (code = (neighbours)->code[m_],                   \
                                           b = (neighbours)->packed + part * LANES +         \
                                               neighbour_number(code) * (neighbours)->items, \
                                           true);                                            \
             part++)

/* The sums of the receivers over all candidates. */
SPHFSI_INLINE void sum_lanes(const vreal sum[PARTS], real out[GROUPS])
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

/* Neighbours of the cluster `own` of one kind among another, from the clusters around its cell. */
SPHFSI_INLINE struct neighbours gather_clusters(struct neighbour_scratch *neighbour_scratch,
                                                const struct fluid *fluid, enum kind kind,
                                                enum kind own, int32_t cluster)
{
    struct cluster_list *const near = &neighbour_scratch->near[kind];
    cluster_list_build(near, &neighbour_scratch->around[kind], &fluid->packed[own].boxes, cluster);
    return neighbours_of(&fluid->packed[kind], near);
}

/* Neighbours of the next cluster of a fluid cell: fluid outside its chunk and ahead in it. */
SPHFSI_INLINE struct neighbours gather_clusters_ahead(struct neighbour_scratch *neighbour_scratch,
                                                      const struct fluid *fluid)
{
    struct cluster_list *const near = &neighbour_scratch->near[KIND_FLUID];
    cluster_list_build_half(near, &neighbour_scratch->around[KIND_FLUID],
                            &fluid->packed[KIND_FLUID].boxes);
    return neighbours_of(&fluid->packed[KIND_FLUID], near);
}

/* In units of h; the kernel ends at 2. */
#define FAR 1e9

/* A piece of a thin line, relative to a cell's centre in units of h; with the number of its line,
 * from 1, if it is the last of its pieces. */
struct near_piece {
    real from[2], to[2], line;
    real length, tip[2]; /* distance of `from` from the tips of the line along it; FAR: none */
};
_Static_assert(sizeof(struct near_piece) <= NEAR_PIECE_BYTES, "fluid_create allocates them");

/* Lists the pieces that a connection from a place in a cell may cross; returns their number. */
static int near_pieces(const struct fluid *fluid, const struct cells *cells, int32_t cell,
                       struct near_piece *out)
{
    const double centre[2] = {cell_centre_x(cells, cell), cell_centre_y(cells, cell)},
                 reach = KERNEL_REACH * fluid->k.h + cells->skin, inv_h = 1 / fluid->k.h;
    int n = 0;
    for (int k = 0; k < fluid->lines.n; k++) {
        const struct thin_line *const line = &fluid->lines.line[k];
        const int before = n;
        for (int m = 0; m < CELLS_IMAGES; m++) {
            double shift[2], low[2], high[2];
            if (!cells_image(cells, m, shift)) continue;
            for (int c = 0; c < 2; c++) {
                shift[c] -= centre[c];
                low[c] = -0.5 * cells->side[c] - reach - shift[c];
                high[c] = 0.5 * cells->side[c] + reach - shift[c];
            }
            if (line->box.low[0] > high[0] || line->box.high[0] < low[0] ||
                line->box.low[1] > high[1] || line->box.high[1] < low[1])
                continue;
            for (int j = 0; j < line->n_pieces; j++) {
                const double *const a = line->piece[j].from, *const b = line->piece[j].to;
                if (line->piece[j].length == 0 || min2(a[0], b[0]) > high[0] ||
                    max2(a[0], b[0]) < low[0] || min2(a[1], b[1]) > high[1] ||
                    max2(a[1], b[1]) < low[1])
                    continue;
                struct near_piece *const p = &out[n++];
                *p = (struct near_piece){.from = {(real)((a[0] + shift[0]) * inv_h),
                                                  (real)((a[1] + shift[1]) * inv_h)},
                                         .to = {(real)((b[0] + shift[0]) * inv_h),
                                                (real)((b[1] + shift[1]) * inv_h)},
                                         .length = (real)(line->piece[j].length * inv_h)};
                for (int last = 0; last < 2; last++)
                    p->tip[last] =
                        line->tip[last]
                            ? (real)(fabs(line->piece[j].start - last * line->length) * inv_h)
                            : (real)FAR;
            }
        }
        if (n > before) out[n - 1].line = (real)(k + 1);
    }
    return n;
}

/* Sides of the cells in units of h, and the thin lines near one. */
struct cell_sides {
    real x, y;
    int n_pieces;
    const struct near_piece *piece;
};

/* `thin`, a constant: whether there are thin lines at all. */
SPHFSI_INLINE struct cell_sides cell_sides_of(const struct fluid *fluid, const struct cells *cells,
                                              int32_t cell, bool thin)
{
    struct near_piece *const piece = thin ? fluid->neighbour_scratch[thread_index()].pieces : NULL;
    return (struct cell_sides){(real)(cells->side[0] / fluid->k.h),
                               (real)(cells->side[1] / fluid->k.h),
                               thin ? near_pieces(fluid, cells, cell, piece) : 0, piece};
}

/* Particles a, one in each group of four lanes; with their positions relative to the centres of the
 * three columns and rows of cells around. */
struct receiver {
    vreal x[3], y[3], u, v, p, dens, volume;
    vreal dens_x, dens_y; /* -h/2 times the gradient of dens, if it is used */
    vreal specific;       /* of PACKED_SPECIFIC, with artificial viscosity */
    vreal line, filled;   /* of a dummy: the line that has to lie between, or 0; and the share phi
                             of its place that fluid of its own side fills (T-110c) */
    int n_pieces;         /* of thin lines near its cell */
    const struct near_piece *piece; /* NULL: the scene has no thin lines */
};

/* Pairs of each a with the candidates b, one in each lane of a group. */
struct pair {
    vreal x, y;    /* xi_ab */
    vreal r2;      /* |xi_ab|^2 */
    vreal u, v;    /* v_ab, m/s */
    vreal v_xi;    /* v_ab . xi_ab, m/s */
    vreal weight;  /* V_b/h^2 t^3; in the sums of the fluid times V_a/h^2 */
    vreal p, dens; /* of b */
    vreal dens_x, dens_y;
};

/* Receivers from their packed fields: geometry only. */
SPHFSI_INLINE struct receiver receiver_at(const struct cell_sides *sides, const real *own)
{
    struct receiver a;
    a.n_pieces = sides->n_pieces;
    a.piece = sides->piece;
    a.line = vset(0);
    a.filled = vset(0);
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

/* Dummies as receivers: of thin lines, too. */
SPHFSI_INLINE struct receiver dummy_at(const struct cell_sides *sides, const real *own)
{
    struct receiver a = receiver_at(sides, own);
    if (a.piece) a.line = vspread(own + PACKED_LINE * CLUSTER);
    if (a.piece) a.filled = vspread(own + PACKED_FILLED * CLUSTER);
    return a;
}

SPHFSI_INLINE vreal vpick(vmask mask, vreal yes, vreal no)
{
    return (vreal)(((vmask)yes & mask) | ((vmask)no & ~mask));
}

/* T-110, T-110b, T-110e, for vectors; `lines_seen` has them for one connection in double precision.
 * How much of a pair with the separation (x, y) is seen. `line`, `filled`: of the
 * dummy that is one of it. `opaque`: lines are so near their tips, too. */
SPHFSI_INLINE vreal visible(const struct receiver *a, vreal x, vreal y, vreal line, vreal filled,
                            bool opaque)
{
    vreal clear = vset(1), seen = vset(0), passes = vset(1);
    vmask odd = {0};
    for (int m = 0; m < a->n_pieces; m++) {
        const struct near_piece *const p = &a->piece[m];
        const vreal from_x = vset(p->from[0]) - a->x[1], from_y = vset(p->from[1]) - a->y[1],
                    to_x = vset(p->to[0]) - a->x[1], to_y = vset(p->to[1]) - a->y[1];
        const vreal from = x * from_y - y * from_x, to = x * to_y - y * to_x,
                    here = from_x * to_y - from_y * to_x, there = here - from + to;
        const vmask crosses = CROSSES(here, there, from, to);
        vreal past_tip = vset(0); /* T-110b, over the kernel's reach */
        if (!opaque && (p->tip[0] < 2 || p->tip[1] - p->length < 2)) {
            const vreal along = vset(p->length) * from / (from - to);
            const vreal from_tip = vmin(vset(p->tip[0]) + along, vset(p->tip[1]) - along);
            past_tip = vmax(vset(0), vset(1) - vset((real)0.5) * from_tip);
        }
        odd ^= crosses;
        passes = vpick(crosses, vmin(passes, past_tip), passes);
        if (p->line == 0) continue;
        passes = vpick(odd, passes, vset(1));
        const vreal behind = vpick(odd, vset(1) - filled * passes, vset(0));
        seen = vpick(line == p->line, clear * behind, seen);
        clear = clear * passes;
        passes = vset(1);
        odd ^= odd;
    }
    return vpick(line == 0, clear, seen);
}

/* Vector from candidates to receivers, in units of h; and how much of these is seen, if there are
 * lines. What is hidden is out of reach for all laws. */
SPHFSI_INLINE void separate(const struct receiver *a, uint32_t code, const real *b, vreal line,
                            vreal filled, bool opaque, vreal *x, vreal *y, vreal *seen)
{
    *x = a->x[neighbour_column(code)] - lane(b, PACKED_X);
    *y = a->y[neighbour_row(code)] - lane(b, PACKED_Y);
    if (!a->piece) return;
    *seen = visible(a, *x, *y, line, filled, opaque);
    *x = vpick(*seen == 0, vset((real)FAR), *x);
}

struct separation {
    vreal x, y, length, seen;
};

SPHFSI_INLINE struct separation separation_from(const struct receiver *a, uint32_t code,
                                                const real *b, bool opaque)
{
    struct separation d;
    separate(a, code, b, a->line, a->filled, opaque, &d.x, &d.y, &d.seen);
    d.length = vsqrt(vfma(d.y, d.y, d.x * d.x));
    return d;
}

/* A weight of the pairs, as far as they are seen. */
SPHFSI_INLINE vreal weight_seen(const struct receiver *a, const struct separation *d, vreal weight)
{
    return a->piece ? weight * d->seen : weight;
}

/* Geometry of the pairs, Eq. 5, weighted by the volume; and with their dummy, or none (T-110). */
SPHFSI_INLINE struct pair pair_load(const struct receiver *a, uint32_t code, const real *b,
                                    vreal volume, vreal line, vreal filled)
{
    struct pair q;
    vreal seen = vset(1);
    separate(a, code, b, line, filled, false, &q.x, &q.y, &seen);
    q.r2 = vfma(q.y, q.y, q.x * q.x);
    const vreal t = vmax(vset(0), vset(2) - vsqrt(q.r2));
    q.weight = (volume * t) * (t * t);
    if (a->piece) q.weight = q.weight * seen;
    q.u = a->u - lane(b, PACKED_U);
    q.v = a->v - lane(b, PACKED_V);
    q.v_xi = vfma(q.v, q.y, q.u * q.x);
    /* cppcheck-suppress uninitvar ; p and dens are loaded by the laws that need them */
    return q;
}
