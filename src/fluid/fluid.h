/* SPDX-License-Identifier: MIT
 * The fluid's model and its sweeps: one evaluation of all rates of fluid and walls. */
#pragma once

#include "particles/clusters.h"
#include "case/effects.h"
#include "fluid/eos.h"
#include "fluid/thin_lines.h"

#define ETA2 0.01 /* (eta/h)^2 */
/* r0 of law_repulsion over the mean spacing of fluid and dummy. It is 1 for a thin line, so that no
 * particle passes between two dummies to the other side. */
#define REPULSION_REACH 0.8

/* Constants of the fluid, SI. */
struct fluid_constants {
    const struct scene_fluid *model; /* coefficients of the effects, as the case has them */
    double h, c0, rho0;
    double c_u;  /* of L-7 */
    double mass; /* of a fluid particle per depth, rho0 dp^2; also hydrodynamic mass of dummies */
    double dp;   /* particle spacing, m */
    double second_moment;  /* M of L-1, 1 */
    double shifting_speed; /* m/s, the same for all particles; 0: each particle's own speed */
    bool fills_domain; /* the fluid has no free surface: a shift takes the density along (L-9) */
    double gravity[2];
    double lowest_wall_pressure; /* Pa, least pressure of dummies; -INFINITY: no limit */
};

/* Mass of a fluid particle over that of most, and per depth, kg/m. */
SPHFSI_INLINE double relative_mass(const struct particles *particles, int64_t i)
{
    return particles->m ? particles->m[i] : 1;
}
SPHFSI_INLINE double particle_mass(const struct fluid_constants *k,
                                   const struct particles *particles, int64_t i)
{
    return k->mass * relative_mass(particles, i);
}

/* Kinetic energy of a particle, potential energy in gravity g, compression energy (T-5), J/m. */
SPHFSI_INLINE double particle_energy(const struct fluid_constants *k, const double g[2],
                                     const struct particles *particles, int64_t i)
{
    return particle_mass(k, particles, i) *
           (0.5 * (square(particles->vx[i]) + square(particles->vy[i])) - g[0] * particles->x[i] -
            g[1] * particles->y[i] + eos_energy(particles->dens[i], k->c0));
}

/* Largest values over all fluid particles of the last evaluation; order-free maxima. */
struct rate_extremes {
    double acceleration2; /* |a|^2 */
    double approach;      /* max |h v.x/(r^2 + eta^2)| of Eq. 28b, m/s */
};

/* Packed copies that the sweeps read: positions relative to the cell's centre in units of h, volume
 * in units of h^2, the rest in SI; float in mixed, double in double precision. */
enum packed_field {
    PACKED_X,
    PACKED_Y,
    PACKED_U,
    PACKED_V,
    PACKED_VOLUME,
    PACKED_P,
    PACKED_DENS,
    PACKED_FIELDS,
    /* Of walls and solids, where fluid sticks to some of them: the mirrored velocity (Adami et al.
     * 2012, Eq. 23) and its weight: 1 or 2 (L-6b), or 0 where it slips. */
    PACKED_MIRROR_U = PACKED_FIELDS,
    PACKED_MIRROR_V,
    PACKED_STICKS,
    PACKED_NO_SLIP_FIELDS,
    /* Of walls and solids with one-sided pressure (L-6): rho0 h (g - a), Pa. */
    PACKED_LIFT_X = PACKED_NO_SLIP_FIELDS,
    PACKED_LIFT_Y,
    PACKED_ONE_SIDED_FIELDS,
    /* Of walls and solids with repulsion: (r0^2 + eta^2)/h^2 of law_repulsion. */
    PACKED_REPULSION2 = PACKED_ONE_SIDED_FIELDS,
    PACKED_REPULSION_FIELDS,
    /* Of walls and solids, with thin lines: the line that has to lie between (T-110), or 0; the
     * share phi of its place that fluid fills. The direction in which fluid slides along it, times
     * the root of phi (T-110c). */
    PACKED_LINE = PACKED_REPULSION_FIELDS,
    PACKED_FILLED,
    PACKED_ALONG_X,
    PACKED_ALONG_Y,
    PACKED_THIN_FIELDS,
    /* Of the fluid, with artificial viscosity: rho0/rho over -2 alpha c0 rho0 (Eq. 7), m^2 s/kg;
     * where density diffuses by Antuono et al. 2010: the gradient of dens, times -h/2. */
    PACKED_SPECIFIC = PACKED_FIELDS,
    PACKED_VISCOUS_FIELDS,
    PACKED_SLOPE_X = PACKED_VISCOUS_FIELDS,
    PACKED_SLOPE_Y,
    PACKED_SLOPE_FIELDS,
    PACKED_MOST = PACKED_THIN_FIELDS
};

/* By cluster in cell order, consecutively: each field of its four particles in a row. Missing
 * particles of a cell's last cluster are far away and have no volume. */
struct packed_fields {
    int n;         /* fields in use */
    void *cluster; /* [clusters][n][CLUSTER] */
    struct cluster_boxes boxes;
};

struct fluid;

/* The fluid's rates (Eqs. 4, 6, 7, 21a) in active cells first to end - 1, and their extremes. */
typedef void fluid_rates(const struct fluid *fluid, struct particles *particles,
                         const struct cells *cells, int32_t first, int32_t end,
                         struct rate_extremes *largest);

/* The sweeps for a set of pair effects. */
struct fluid_variant {
    const char *name;
    effect_set effects; /* ANY_EFFECTS: generic */
    fluid_rates *rates;
};
#define ANY_EFFECTS (~(effect_set)0)

/* A pass over all kinds. */
typedef void fluid_pass(struct fluid *fluid, struct particles kinds[KIND_COUNT],
                        const struct cells *cells);

/* The sweeps of one precision. */
struct fluid_sweeps {
    size_t packed_item_size;
    fluid_pass *pack;        /* pressure by the equation of state, and packed fields of the fluid */
    fluid_pass *find_slopes; /* renormalised, of the fluid's density, and its packed fields */
    /* Pressure and density of wall or solid particles near fluid (Eqs. 19-20), and their packed
     * fields. The fluid's force on them: coupling/force.h. */
    void (*update_dummies)(const struct fluid *f, struct particles kinds[KIND_COUNT],
                           const struct cells *c, enum kind kind);
    const struct fluid_variant *variants; /* the generic one is the last */
};
extern const struct fluid_sweeps fluid_sweeps_mixed, fluid_sweeps_double;

/* The fluid's active cells are swept in chunks: a pair within one is computed once for both of its
 * particles. The order of sums follows from the chunks, so their number depends on the number n of
 * cells only. A chunk has at most 128 cells. The number of chunks is a multiple of 24, which most
 * numbers of threads divide; fewer cells make do with a multiple of 8, or with 4, because pairs
 * across chunks are computed twice. */
enum { CHUNK_CELLS = 128 };
SPHFSI_INLINE int32_t fluid_chunk_count(int32_t n)
{
    const int32_t full = (n + CHUNK_CELLS - 1) / CHUNK_CELLS, unit = full > 24  ? 24
                                                                     : full > 2 ? 8
                                                                                : 4;
    return (full + unit - 1) / unit * unit;
}

/* The first cell of the m-th chunk; chunks may be empty. */
SPHFSI_INLINE int32_t fluid_chunk_start(int32_t n, int32_t m)
{
    return (int32_t)((int64_t)n * m / fluid_chunk_count(n));
}

/* Sums over pairs: of forces, of Eq. 4a, of Eq. 6, and for shifting; and their number. */
enum pair_sum { SUM_X, SUM_Y, SUM_RATE, SUM_DIFFUSED, SUM_GRAD_C_X, SUM_GRAD_C_Y, SUM_DIV_R, SUMS };
SPHFSI_INLINE int pair_sum_count(effect_set effects)
{
    return effects & FX_SHIFTING ? SUMS : effects & FX_DIFFUSION ? SUM_DIFFUSED + 1 : SUM_RATE + 1;
}

/* Bytes of struct near_piece (fluid/neighbours.h) in double precision. */
enum { NEAR_PIECE_BYTES = 8 * sizeof(double) };

/* Neighbour clusters of a cell and of a cluster: scratch memory of a thread. */
struct neighbour_scratch {
    struct neighbour_clusters around[KIND_COUNT];
    struct cluster_list near[KIND_COUNT];
    /* [1 + clusters of a chunk][sums][receiver][candidate]: deferred sums of the clusters as
     * candidates. Zero between evaluations, but for the first, the discard slot. */
    void *deferred;
    void *pieces; /* of thin lines near a cell: struct near_piece of fluid/neighbours.h */
};

struct fluid {
    struct fluid_constants k;
    effect_set effects;                  /* of the simulation, which this layer does not know */
    bool never_skip;                     /* visit dry walls, place resting ones; set by tests */
    double *volume[KIND_COUNT];          /* [sections] of a dummy at rest over that of fluid */
    double *repulsion2[KIND_COUNT];      /* [sections]: (r0^2 + eta^2)/h^2 of law_repulsion */
    bool *moves[KIND_COUNT];             /* [sections]: structures, and walls that have a motion */
    const struct fluid_sweeps *sweeps;   /* of the precision */
    const struct fluid_variant *variant; /* for the effects */
    struct packed_fields packed[KIND_COUNT];
    int32_t
        *near_fluid[KIND_COUNT]; /* walls and solids: cells with fluid within reach, Morton order */
    int32_t n_near_fluid[KIND_COUNT];
    struct lines lines; /* thin lines; unused without any */
    /* s: the sweeps pack the state predicted by so much (Eqs. 22, 24a), of which the particles keep
     * only dens, as dens_half; 0: the present one. */
    double predict_by;
    bool keeps_slopes; /* L-5a: the gradients of dens are those of an earlier evaluation */
    bool walls_placed; /* packed positions of walls at rest are valid */
    struct cells_around *around;    /* [active cells of fluid]: those behind, and of other chunks */
    bool *near_dummies[KIND_COUNT]; /* [cells]: walls or solids in the nine cells around */
    bool *sticks[KIND_COUNT];       /* by body: whether fluid sticks to it; with NO_SLIP */
    struct neighbour_scratch *neighbour_scratch; /* [threads] */
    size_t thread_bytes;                         /* memory of each thread */
    int threads;
    struct rate_extremes extremes;
};

/* Whether any of some dummies of a kind can move. */
SPHFSI_INLINE bool dummies_move(const struct fluid *fluid, enum kind kind,
                                const struct particles *particles, const int32_t *index, int count)
{
    if (kind == KIND_SOLID || !(fluid->effects & FX_MOTION)) return kind == KIND_SOLID;
    for (int r = 0; r < count; r++)
        if (fluid->moves[kind][particles->body[index[r]]]) return true;
    return false;
}

/* Whether there are walls or solids in the nine cells around a cell of fluid; of any kind. */
SPHFSI_INLINE bool fluid_near_kind(const struct fluid *fluid, enum kind kind, int32_t cell)
{
    return fluid->n_near_fluid[kind] && fluid->near_dummies[kind][cell];
}
SPHFSI_INLINE bool fluid_near_dummies(const struct fluid *fluid, int32_t cell)
{
    return fluid_near_kind(fluid, KIND_WALL, cell) || fluid_near_kind(fluid, KIND_SOLID, cell);
}

/* Chooses sweeps and variant, allocates packed fields and scratch; only effects are set before. */
enum err fluid_create(struct fluid *fluid, struct arena *a, const struct scene *scene,
                      struct particles kinds[KIND_COUNT], const struct cells *cells, struct diag *d)
    SPHFSI_CHECKED;

/* Moves particles by A h times a speed times dt, down the gradient of their concentration at the
 * last evaluation. The speed is their own or c0/10 (`shifting_speed`). Those at the free surface
 * stay. Returns the largest shift, m. */
double fluid_shift(const struct fluid *fluid, struct particles *particles, double dt);

/* The density that the acoustic damper remembers moves towards the present one. */
void fluid_follow_density(const struct fluid *fluid, struct particles *particles, double dt);

/* After sorting: finds the cells around those of fluid, the cells of walls and solids that have
 * fluid within reach, and the reverse. */
void fluid_find_near(struct fluid *fluid, const struct cells *cells);

/* One evaluation: pressures, dummies, rates. The cells must have skin left (cells_skin_left). The
 * time of each pass is added to phase_seconds. */
void fluid_evaluate(struct fluid *fluid, struct particles kinds[KIND_COUNT],
                    const struct cells *cells, double phase_seconds[PHASE_COUNT]);

/* The thin line that particle i of a kind is a dummy of, from 1; 0: none. */
SPHFSI_INLINE int32_t fluid_line_of(const struct fluid *fluid, enum kind kind, int64_t i)
{
    return fluid->effects & FX_THIN && kind == KIND_WALL ? fluid->lines.of_wall[i] : 0;
}

/* The dummy of a thin line that particle i is; NULL: it is on no line. */
SPHFSI_INLINE const struct line_dummy *fluid_line_dummy(const struct fluid *fluid, enum kind kind,
                                                        int64_t i)
{
    const int32_t of = fluid_line_of(fluid, kind, i);
    if (!of) return NULL;
    const struct thin_line *const line = &fluid->lines.line[of - 1];
    return &line->given->dummy[i - line->first];
}

/* The line that has to lie between fluid and particle i of a kind, from 1; 0: none. */
SPHFSI_INLINE int32_t fluid_line_before(const struct fluid *fluid, enum kind kind, int64_t i)
{
    const struct line_dummy *const dummy = fluid_line_dummy(fluid, kind, i);
    return dummy && !dummy->same_side ? fluid_line_of(fluid, kind, i) : 0;
}

/* Volume of particle i of walls or solids, at rest, over that of a fluid particle. */
SPHFSI_INLINE double fluid_volume_of(const struct fluid *fluid, enum kind kind,
                                     const struct particles *particles, int64_t i)
{
    return fluid->effects & FX_THIN && kind == KIND_WALL ? fluid->lines.volume[i]
                                                         : fluid->volume[kind][particles->body[i]];
}

/* r0 of L-7, m. A particle that has passed a line would be pushed on by the other side. */
SPHFSI_INLINE double fluid_repels_from(const struct fluid *fluid, enum kind kind,
                                       const struct particles *particles, int64_t i)
{
    const struct line_dummy *const dummy = fluid_line_dummy(fluid, kind, i);
    const double width = dummy ? dummy->width : sqrt(fluid->volume[kind][particles->body[i]]);
    return (fluid_line_before(fluid, kind, i) ? 1 : REPULSION_REACH) * 0.5 * (1 + width) *
           fluid->k.dp;
}

/* The share of the connection from a place to particle i of a kind, (x, y) away, that no thin line
 * blocks (T-110). */
SPHFSI_INLINE double fluid_seen(const struct fluid *fluid, const struct cells *cells,
                                const double from[2], enum kind kind, int64_t i, double x, double y)
{
    if (!(fluid->effects & FX_THIN)) return 1;
    const int32_t own = fluid_line_before(fluid, kind, i);
    return lines_seen(&fluid->lines, cells, KERNEL_REACH * fluid->k.h, from, (const double[]){x, y},
                      own, own ? fluid->lines.filled[i] : 0);
}

/* repulsion.c: energy stored by walls and structures that repel each section (L-7b), J/m. */
void fluid_repulsion_energy(const struct fluid *fluid, const struct particles kind[KIND_COUNT],
                            const struct cells *cells, double of[SCENE_MAX_SECTIONS]);

/* Writes the pressure of each fluid particle to `p`; only output needs it. */
void fluid_write_pressure(const struct fluid *fluid, struct particles *particles);
