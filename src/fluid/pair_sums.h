/* SPDX-License-Identifier: MIT
 * Sums over the pairs of the fluid. A pair of clusters in the same chunk of cells is computed once.
 * The receivers' sums stay in registers. The candidates' sums are deferred until these clusters are
 * receivers. Included by fluid/sweep.h, once for each precision. */

/* What the receivers of a cluster sum over their candidates. */
struct cluster_sums {
    vreal of[ROWS][PARTS][SUMS];
    vreal approach; /* largest |v.xi|/(|xi|^2 + eta^2/h^2), m/s */
};

/* Adds pairs to the sums of their receivers, or to those deferred for fluid or dummies. */
SPHFSI_INLINE void add_pair_terms(vreal sum[SUMS], const struct pair_terms *e,
                                  struct pair_set effects, bool fluid)
{
    const struct pair *const q = &e->pair;
    sum[SUM_X] = vfma(e->radial, q->x, sum[SUM_X]);
    sum[SUM_Y] = vfma(e->radial, q->y, sum[SUM_Y]);
    sum[SUM_RATE] = vfma(e->rate, q->v_xi, sum[SUM_RATE]);
    if (fluid ? PAIR_HAS(effects, LAMINAR) : PAIR_HAS(effects, NO_SLIP)) {
        sum[SUM_X] = vfma(-e->laminar, q->u, sum[SUM_X]);
        sum[SUM_Y] = vfma(-e->laminar, q->v, sum[SUM_Y]);
    }
    if (fluid && PAIR_HAS(effects, DIFFUSION))
        sum[SUM_DIFFUSED] = vfma(e->diffusion_factor, e->dens_difference, sum[SUM_DIFFUSED]);
    if (PAIR_HAS(effects, SHIFTING)) law_concentration(q, sum);
}

/* Pairs with both volumes, as in struct pair_terms, and the pressure of the candidates. */
SPHFSI_INLINE struct pair pair_between(const struct receiver *a, uint32_t code, const real *b,
                                       vreal line, vreal filled)
{
    struct pair q = pair_load(a, code, b, a->volume * lane(b, PACKED_VOLUME), line, filled);
    q.p = lane(b, PACKED_P);
    return q;
}

/* Contributions of pairs of receivers and candidates; specialised sweeps have constant effects. */
SPHFSI_INLINE struct pair_terms pair_of_fluid(const struct receiver *a, uint32_t code,
                                              const real *b, const struct vector_constants *k,
                                              struct pair_set effects, vreal *approach)
{
    struct pair_terms e = {.pair = pair_between(a, code, b, vset(0), vset(0))};
    struct pair *const q = &e.pair;
    e.rate = law_continuity(q);
    vreal stress = law_pressure(a, q), inv;
    if (PAIR_HAS(effects, VISCOSITY)) {
        const vreal both = a->specific + lane(b, PACKED_SPECIFIC);
        const vreal factor = viscosity_factor(q, both, k);
        inv = factor * both;
        stress = law_viscosity(q, factor, stress);
    } else {
        inv = vset(1) / (q->r2 + k->eta2);
    }
    if (PAIR_HAS(effects, DIFFUSION)) {
        q->dens = lane(b, PACKED_DENS);
        if (PAIR_HAS(effects, ANTUONO)) {
            q->dens_x = lane(b, PACKED_SLOPE_X);
            q->dens_y = lane(b, PACKED_SLOPE_Y);
        }
        e.dens_difference = law_dens_difference(a, q, k, effects);
        e.diffusion_factor = law_diffusion_factor(q, inv, k, effects);
    }
    if (PAIR_HAS(effects, TENSILE)) stress = stress + law_tensile(a, q, k);
    e.radial = q->weight * stress;
    if (PAIR_HAS(effects, LAMINAR)) e.laminar = law_laminar(q, k);
    *approach = vmax(*approach, law_approach(q, inv));
    return e;
}

/* Numbers deferred for a cluster; and the position of one of the sums, with the first at `at`. */
SPHFSI_INLINE size_t deferred_stride(struct pair_set effects)
{
    return (size_t)pair_sum_count(effects.bits) * CLUSTER * CLUSTER;
}
#define DEFERRED(at, sum) ((at) + (int)(sum)*CLUSTER * CLUSTER)

/* The slot of a cluster of the chunk in the deferred sums, after the discard slot. */
SPHFSI_INLINE size_t deferred_slot(const struct chunk *chunk, size_t cluster)
{
    return cluster + 1 - (size_t)chunk->range.first;
}

/* Adds pairs of fluid to the sums deferred for their candidates. */
SPHFSI_INLINE void defer_pair_terms(real *at, const struct pair_terms *e, struct pair_set effects)
{
    vreal sum[SUMS];
    for (int k = 0; k < pair_sum_count(effects.bits); k++) sum[k] = vload(DEFERRED(at, k));
    add_pair_terms(sum, e, effects, true);
    for (int k = 0; k < pair_sum_count(effects.bits); k++) vstore(DEFERRED(at, k), sum[k]);
}

/* Sums over neighbouring fluid. Candidates not ahead in the chunk add to the discard slot. */
SPHFSI_INLINE void sum_fluid(const struct neighbours *neighbours, const struct receiver a[ROWS],
                             const struct vector_constants *k, struct pair_set effects,
                             const struct chunk *chunk, struct cluster_sums *sums)
{
    EACH_CANDIDATE(neighbours, part, code, b)
    {
        const size_t place = deferred_slot(chunk, neighbour_number(code)) * neighbour_is_half(code);
        real *const at = chunk->deferred + place * deferred_stride(effects) + part * LANES;
        for (int row = 0; row < ROWS; row++) {
            const struct pair_terms e =
                pair_of_fluid(&a[row], code, b, k, effects, &sums->approach);
            add_pair_terms(sums->of[row][part], &e, effects, true);
            defer_pair_terms(at + row * GROUPS * CLUSTER, &e, effects);
        }
    }
}

/* With walls and structures: pressure, continuity, and laminar viscosity where the fluid sticks. */
SPHFSI_INLINE struct pair_terms pair_of_dummy(const struct receiver *a, uint32_t code,
                                              const real *b, const struct vector_constants *k,
                                              struct pair_set effects, vreal *approach)
{
    const vreal line = PAIR_HAS(effects, THIN) ? lane(b, PACKED_LINE) : vset(0);
    const vreal filled = PAIR_HAS(effects, THIN) ? lane(b, PACKED_FILLED) : vset(0);
    struct pair_terms e = {.pair = pair_between(a, code, b, line, filled)};
    struct pair *const q = &e.pair;
    e.rate = PAIR_HAS(effects, ONE_SIDED) ? law_one_sided_rate(q) : law_continuity(q);
    struct surface s = {.p = q->p};
    if (PAIR_HAS(effects, ONE_SIDED))
        s.lift_x = lane(b, PACKED_LIFT_X), s.lift_y = lane(b, PACKED_LIFT_Y);
    if (PAIR_HAS(effects, REPULSION)) s.near = lane(b, PACKED_REPULSION2);
    e.radial = q->weight * law_surface(a->p, a->dens, q->x, q->y, &s, q, k, effects);
    *approach = vmax(*approach, law_approach(q, vset(1) / (q->r2 + k->eta2)));
    if (PAIR_HAS(effects, THIN)) law_sliding(q, lane(b, PACKED_ALONG_X), lane(b, PACKED_ALONG_Y));
    if (PAIR_HAS(effects, NO_SLIP)) {
        e.laminar = lane(b, PACKED_STICKS) * law_laminar(q, k);
        q->u = a->u - lane(b, PACKED_MIRROR_U);
        q->v = a->v - lane(b, PACKED_MIRROR_V);
    }
    return e;
}

/* Sums over neighbouring walls or structures; the forces on these have a sweep of their own. */
SPHFSI_INLINE void sum_dummies(const struct neighbours *neighbours, const struct receiver a[ROWS],
                               const struct vector_constants *k, struct pair_set effects,
                               struct cluster_sums *sums)
{
    EACH_CANDIDATE(neighbours, part, code, b)
    {
        for (int row = 0; row < ROWS; row++) {
            const struct pair_terms e =
                pair_of_dummy(&a[row], code, b, k, effects, &sums->approach);
            add_pair_terms(sums->of[row][part], &e, effects, false);
        }
    }
}

/* A sum of the particles of a cluster as receivers. */
SPHFSI_INLINE four_double own_sum(const struct cluster_sums *s, enum pair_sum which)
{
    real sum[CLUSTER];
    for (int row = 0; row < ROWS; row++) {
        vreal parts[PARTS];
        for (int part = 0; part < PARTS; part++) parts[part] = s->of[row][part][which];
        sum_lanes(parts, sum + row * GROUPS);
    }
    return four_widen(FOUR_REAL(sum));
}

/* The sum of the contributions deferred for receivers; resets it to zero for the next chunk. */
SPHFSI_INLINE four_double take_deferred(real *at)
{
    four_real *const sums = (four_real *)(void *)at; /* [receiver] */
    const four_real sum = (sums[0] + sums[2]) + (sums[1] + sums[3]);
    memset(at, 0, CLUSTER * CLUSTER * sizeof *at);
    return four_widen(sum);
}
