/* SPDX-License-Identifier: MIT
 * Sums over the pairs of the fluid. A pair of clusters in the same chunk of cells is computed once.
 * The receivers' sums stay in registers. The candidates' sums are deferred until these clusters are
 * receivers. Included by fluid/sweep.h, once for each precision. */

/* Vectors of sums of a cluster's receivers. */
typedef vreal of_cluster[ROWS][PARTS];

/* What the receivers of a cluster sum over their candidates. */
struct cluster_sums {
    of_cluster ax, ay, rate, mixing, grad_c_x, grad_c_y, div_r;
    vreal approach; /* largest |v.xi|/(|xi|^2 + eta^2/h^2), m/s */
};

SPHFSI_INLINE void add_concentration(struct cluster_sums *s, int row, int part,
                                     const struct exchange *e)
{
    s->grad_c_x[row][part] = s->grad_c_x[row][part] + e->grad_c_x;
    s->grad_c_y[row][part] = s->grad_c_y[row][part] + e->grad_c_y;
    s->div_r[row][part] = s->div_r[row][part] + e->div_r;
}

/* Adds the contributions of pairs to their receivers. */
SPHFSI_INLINE void add_exchange(struct cluster_sums *s, int row, int part, const struct exchange *e,
                                struct pair_set fx)
{
    s->ax[row][part] = s->ax[row][part] + e->ax;
    s->ay[row][part] = s->ay[row][part] + e->ay;
    s->rate[row][part] = s->rate[row][part] + e->rate;
    if (PAIR_HAS(fx, DIFFUSION)) s->mixing[row][part] = s->mixing[row][part] + e->mixing;
    if (PAIR_HAS(fx, SHIFTING)) add_concentration(s, row, part, e);
}

/* Pairs with the volumes of both sides, as an exchange has them, and the pressure of the
 * candidates. */
SPHFSI_INLINE struct pair pair_between(const struct receiver *a, uint32_t code, const real *b)
{
    struct pair q = pair_load(a, code, b);
    q.slope = q.slope * a->volume;
    q.p = lane(b, PACKED_P);
    return q;
}

/* Contributions of pairs of receivers and candidates; fx is a constant in specialised kernels. */
SPHFSI_INLINE struct exchange pair_of_fluid(const struct receiver *a, uint32_t code, const real *b,
                                            const struct vector_constants *k, struct pair_set fx,
                                            vreal *approach)
{
    struct exchange e;
    struct pair q = pair_between(a, code, b);
    e.rate = fx_continuity(&q);
    vreal stress = fx_pressure(a, &q), inv;
    if (PAIR_HAS(fx, VISCOSITY) || PAIR_HAS(fx, DIFFUSION)) {
        q.dens = lane(b, PACKED_DENS);
        if (PAIR_HAS(fx, ANTUONO)) {
            q.slope_x = lane(b, PACKED_SLOPE_X);
            q.slope_y = lane(b, PACKED_SLOPE_Y);
        }
        vreal both;
        const vreal damping = pair_damping(a, &q, k, &both);
        inv = damping * both;
        if (PAIR_HAS(fx, VISCOSITY)) stress = fx_viscosity(a, &q, damping, k, stress);
        if (PAIR_HAS(fx, DIFFUSION)) e.mixing = fx_diffusion(a, &q, inv, k, fx);
    } else {
        inv = vset(1) / (q.r2 + k->eta2);
    }
    if (PAIR_HAS(fx, TENSILE)) stress = stress + fx_tensile(a, &q, k);
    const vreal radial = q.slope * stress;
    e.ax = radial * q.x;
    e.ay = radial * q.y;
    if (PAIR_HAS(fx, LAMINAR)) {
        const vreal weight = fx_laminar(&q, inv, k);
        e.ax = e.ax - weight * q.u;
        e.ay = e.ay - weight * q.v;
    }
    if (PAIR_HAS(fx, SHIFTING)) fx_concentration(&q, &e);
    *approach = vmax(*approach, fx_approach(&q, inv));
    /* cppcheck-suppress uninitvar ; sums of effects that are off are not read */
    return e;
}

/* Numbers deferred for a cluster; and the position of one of the sums, with the first at `at`. */
SPHFSI_INLINE size_t deferred_stride(struct pair_set fx)
{
    return (size_t)pair_sums(fx.fx) * CLUSTER * CLUSTER;
}
#define DEFERRED(at, sum) ((at) + (int)(sum)*CLUSTER * CLUSTER)

/* The slot of a cluster of the chunk in the deferred sums, after the discard slot. */
SPHFSI_INLINE size_t deferred_slot(const struct chunk *chunk, size_t cluster)
{
    return cluster + 1 - (size_t)chunk->range.first;
}

SPHFSI_INLINE void defer_add(real *at, vreal more) { vstore(at, vload(at) + more); }

/* Adds the contributions of pairs to their candidates. */
SPHFSI_INLINE void defer_sum(real *at, const struct exchange *e, struct pair_set fx)
{
    defer_add(DEFERRED(at, SUM_X), e->ax);
    defer_add(DEFERRED(at, SUM_Y), e->ay);
    defer_add(DEFERRED(at, SUM_RATE), e->rate);
    if (PAIR_HAS(fx, DIFFUSION)) defer_add(DEFERRED(at, SUM_MIXING), e->mixing);
    if (!(PAIR_HAS(fx, SHIFTING))) return;
    defer_add(DEFERRED(at, SUM_GRAD_C_X), e->grad_c_x);
    defer_add(DEFERRED(at, SUM_GRAD_C_Y), e->grad_c_y);
    defer_add(DEFERRED(at, SUM_DIV_R), e->div_r);
}

/* Sums over neighbouring fluid. Candidates that are not ahead in the chunk add to the discard
 * slot. */
SPHFSI_INLINE void sum_fluid(const struct neighbours *neighbours, const struct receiver a[ROWS],
                             const struct vector_constants *k, struct pair_set fx,
                             const struct chunk *chunk, struct cluster_sums *sums)
{
    for (int m = 0; m < neighbours->n; m++)
        for (int part = 0; part < PARTS; part++) {
            const uint32_t code = neighbours->code[m];
            const real *const b = candidates(neighbours, code, part);
            const size_t place =
                deferred_slot(chunk, neighbour_number(code)) * neighbour_is_half(code);
            real *const at = chunk->deferred + place * deferred_stride(fx) + part * LANES;
            for (int row = 0; row < ROWS; row++) {
                const struct exchange e = pair_of_fluid(&a[row], code, b, k, fx, &sums->approach);
                add_exchange(sums, row, part, &e, fx);
                defer_sum(at + row * GROUPS * CLUSTER, &e, fx);
            }
        }
}

/* With walls and structures: pressure and continuity, and laminar viscosity where the fluid
 * sticks. */
SPHFSI_INLINE struct exchange pair_of_dummy(const struct receiver *a, uint32_t code, const real *b,
                                            const struct vector_constants *k, struct pair_set fx,
                                            vreal *approach)
{
    struct exchange e;
    struct pair q = pair_between(a, code, b);
    e.rate = PAIR_HAS(fx, ONE_SIDED) ? fx_one_sided_rate(&q) : fx_continuity(&q);
    const vreal inv = vset(1) / (q.r2 + k->eta2);
    vreal stress = fx_pressure(a, &q);
    if (PAIR_HAS(fx, ONE_SIDED))
        stress = stress + fx_one_sided(a->p, a->dens, q.x, q.y, lane(b, PACKED_LIFT_X),
                                       lane(b, PACKED_LIFT_Y), k);
    if (PAIR_HAS(fx, REPULSION)) stress = stress + fx_repulsion(lane(b, PACKED_NEAR), inv, k);
    if (PAIR_HAS(fx, WALL_DAMPING))
        stress = stress + fx_wall_damping(lane(b, PACKED_NEAR), inv, q.vx, k);
    const vreal radial = q.slope * stress;
    e.ax = radial * q.x;
    e.ay = radial * q.y;
    if (PAIR_HAS(fx, NO_SLIP)) {
        const vreal weight = lane(b, PACKED_STICKS) * fx_laminar(&q, inv, k);
        e.ax = e.ax - weight * (a->u - lane(b, PACKED_MIRROR_U));
        e.ay = e.ay - weight * (a->v - lane(b, PACKED_MIRROR_V));
    }
    if (PAIR_HAS(fx, SHIFTING)) fx_concentration(&q, &e);
    *approach = vmax(*approach, fx_approach(&q, inv));
    /* cppcheck-suppress uninitvar ; sums of effects that are off are not read */
    return e;
}

/* Sums over neighbouring walls or structures; the forces on these have a sweep of their own. */
SPHFSI_INLINE void sum_dummies(const struct neighbours *neighbours, const struct receiver a[ROWS],
                               const struct vector_constants *k, struct pair_set fx,
                               struct cluster_sums *sums)
{
    const struct pair_set rest = {fx.fx & ~(effect_set)PAIR_DIFFUSION};
    for (int m = 0; m < neighbours->n; m++)
        for (int part = 0; part < PARTS; part++) {
            const uint32_t code = neighbours->code[m];
            const real *const b = candidates(neighbours, code, part);
            for (int row = 0; row < ROWS; row++) {
                const struct exchange e = pair_of_dummy(&a[row], code, b, k, fx, &sums->approach);
                add_exchange(sums, row, part, &e, rest);
            }
        }
}

/* A sum of the particles of a cluster as receivers. */
SPHFSI_INLINE four_double own_sum(const of_cluster own)
{
    real sum[CLUSTER];
    for (int row = 0; row < ROWS; row++) total(own[row], sum + row * GROUPS);
    return __builtin_convertvector(*(const four_real *)(const void *)sum, four_double);
}

/* The same sum of the contributions deferred for them; resets it to zero for the next chunk. */
SPHFSI_INLINE four_double take_deferred(real *at)
{
    four_real *const by = (four_real *)(void *)at; /* [receiver] */
    const four_real sum = (by[0] + by[2]) + (by[1] + by[3]);
    memset(at, 0, CLUSTER * CLUSTER * sizeof *at);
    return __builtin_convertvector(sum, four_double);
}
