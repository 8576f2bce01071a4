/* SPDX-License-Identifier: MIT
 * The sweeps of the fluid for both precisions: fluid/sweep_mixed.c and fluid/sweep_double.c include
 * this file after base/real_float.h and base/real_double.h. Four particles of a cell that are close
 * together form a cluster, which interacts with the clusters near it. A thread writes to its chunk
 * of cells only, and chunks do not depend on the number of threads; so neither do the bits. Each
 * lane of a group of four has its own sum over candidates, so the bits do not depend on the number
 * of groups in a vector. */

#include <math.h>
#include <string.h>

#include "fluid/eos.h"
#include "fluid/fluid.h"
#include "particles/kernel.h"

#include "fluid/neighbours.h"
/* After the definitions that they need. */
#include "fluid/pair_laws.h"
#include "fluid/packed.h"

/* The kernel without its factor alpha_D, at distances of q h. */
SPHFSI_INLINE vreal kernel_of(vreal q)
{
    const vreal t = vmax(vset(0), vfma(vset((real)-0.5), q, vset(1))), t2 = t * t;
    return t2 * t2 * vfma(vset(2), q, vset(1));
}

/* Whether there is fluid within reach of a dummy, from the sum of the kernel over it. */
SPHFSI_INLINE bool has_fluid_near(real weight) { return (double)weight > 1e-12; }

#include "fluid/dummies.h"

/* A range of the fluid that a thread processes at a time. */
struct chunk {
    struct cluster_range range;
    real *deferred; /* scratch of the thread */
};

/* Of a chunk: largest values, reduced over the SIMD lanes once; and powers, of a single section in
 * four lanes, else of each section. */
struct chunk_totals {
    vreal approach;
    double acceleration2[CLUSTER];
    four_double power[FLUID_POWERS];
    double *power_on; /* [FLUID_POWERS][sections]; NULL: not wanted */
};

#include "fluid/pair_sums.h"

/* Stores the first `count` of four. */
SPHFSI_INLINE void store_four(double *to, four_double four, int count)
{
    if (count == CLUSTER)
        *(four_double_at *)to = four;
    else
        for (int r = 0; r < count; r++) to[r] = four[r];
}

/* A sum of `count` particles as receivers and candidates, which have its opposite. */
SPHFSI_INLINE four_double odd_sum(const struct cluster_sums *s, real *deferred, enum pair_sum which)
{
    return own_sum(s, which) - take_deferred(DEFERRED(deferred, which));
}
SPHFSI_INLINE four_double even_sum(const struct cluster_sums *s, real *deferred,
                                   enum pair_sum which)
{
    return own_sum(s, which) + take_deferred(DEFERRED(deferred, which));
}

/* Adds the power on `count` particles from i on, over their mean mass. */
SPHFSI_INLINE void add_power(const struct fluid *fluid, const struct particles *particles,
                             int32_t i, int count, enum fluid_power which, four_double power,
                             struct chunk_totals *top)
{
    if (fluid->sections == 1 && count == CLUSTER)
        top->power[which] += power;
    else
        for (int r = 0; r < count; r++)
            top->power_on[(int)which * fluid->sections + particles->body[i + r]] += power[r];
}

/* Writes the rates of `count` particles from i on, from their sums and the factors not included in
 * them. With `power` their pairs' (T-46a). */
SPHFSI_INLINE void rates_store(const struct fluid *fluid, struct particles *particles, int32_t i,
                               int count, const struct cluster_sums *s, real *deferred,
                               const struct vector_constants *k, struct pair_set fx, bool power,
                               struct chunk_totals *top)
{
    const four_double dens = FOUR(particles->dens, i);
    four_double full = 1 + dens, factor = k->acceleration + 0 * full;
    four_double rate = full * even_sum(s, deferred, SUM_RATE);
    if (PAIR_HAS(fx, MASSES)) { /* all sums contain the volume of the particle itself */
        const four_double inverse_mass = 1 / FOUR(particles->m, i);
        factor = factor * inverse_mass;
        full = full * inverse_mass;
    }
    const four_double fx_a = factor * odd_sum(s, deferred, SUM_X),
                      fy_a = factor * odd_sum(s, deferred, SUM_Y);
    const four_double ax = fx_a + fluid->k.gravity[0], ay = fy_a + fluid->k.gravity[1];
    if (PAIR_HAS(fx, DIFFUSION)) {
        const double mixing = PAIR_HAS(fx, LIMITER) ? 2 : k->mixing;
        rate = rate + mixing * odd_sum(s, deferred, SUM_MIXING);
    }
    full = k->slope * full;
    const four_double ddens = -full * rate, a2 = ax * ax + ay * ay;
    store_four(particles->ax + i, ax, count);
    store_four(particles->ay + i, ay, count);
    store_four(particles->ddens + i, ddens, count);
    for (int r = 0; r < count; r++) top->acceleration2[r] = max2(top->acceleration2[r], a2[r]);
    if (power) {
        const four_double on = FOUR(particles->vx, i) * fx_a + FOUR(particles->vy, i) * fy_a +
                               EOS_ENERGY_RATE(dens, fluid->k.c0) * ddens;
        add_power(fluid, particles, i, count, POWER_OF_PAIRS,
                  PAIR_HAS(fx, MASSES) ? FOUR(particles->m, i) * on : on, top);
    }
    if (!(PAIR_HAS(fx, SHIFTING))) return;
    store_four(particles->grad_c_x + i, -full * odd_sum(s, deferred, SUM_GRAD_C_X), count);
    store_four(particles->grad_c_y + i, -full * odd_sum(s, deferred, SUM_GRAD_C_Y), count);
    store_four(particles->div_r + i, fluid->k.h * full * even_sum(s, deferred, SUM_DIV_R), count);
}

/* Sums with walls and structures. With `power` also theirs on `count` particles from i on: what
 * they add in T-6 and T-7 to kinetic and compression energy and to that of the damper. */
SPHFSI_INLINE void sum_bodies(const struct fluid *fluid, const struct particles *particles,
                              int32_t i, int count, const struct neighbours neighbours[KIND_COUNT],
                              const struct receiver a[ROWS], const struct vector_constants *k,
                              struct pair_set fx, bool power, struct cluster_sums *s,
                              struct chunk_totals *top)
{
    struct cluster_sums with = *s;
    if (!neighbours[KIND_WALL].n && !neighbours[KIND_SOLID].n) return;
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++)
        if (neighbours[kind].n) sum_dummies(&neighbours[kind], a, k, fx, s);
    if (!power) return;
    for (int row = 0; row < ROWS; row++)
        for (int part = 0; part < PARTS; part++)
            for (int m = SUM_X; m <= SUM_RATE; m++)
                with.of[row][part][m] = s->of[row][part][m] - with.of[row][part][m];
    const four_double on =
        FOUR(particles->vx, i) * own_sum(&with, SUM_X) +
        FOUR(particles->vy, i) * own_sum(&with, SUM_Y) -
        acting_pressure(fluid, particles, i, fluid->effects) * own_sum(&with, SUM_RATE);
    add_power(fluid, particles, i, count, POWER_OF_BODIES, k->acceleration * on, top);
}

/* Receivers of the fluid from their packed fields. */
SPHFSI_INLINE struct receiver fluid_at(const struct cell_sides *sides, const real *own,
                                       struct pair_set fx)
{
    struct receiver a = receiver_at(sides, own);
    a.u = vspread(own + PACKED_U * CLUSTER);
    a.v = vspread(own + PACKED_V * CLUSTER);
    a.p = vspread(own + PACKED_P * CLUSTER);
    a.dens = vspread(own + PACKED_DENS * CLUSTER);
    a.volume = vspread(own + PACKED_VOLUME * CLUSTER);
    if (PAIR_HAS(fx, VISCOSITY)) a.specific = vspread(own + PACKED_SPECIFIC * CLUSTER);
    if (PAIR_HAS(fx, ANTUONO)) {
        a.slope_x = vspread(own + PACKED_SLOPE_X * CLUSTER);
        a.slope_y = vspread(own + PACKED_SLOPE_Y * CLUSTER);
    }
    return a;
}

/* A cluster of `count` particles from i on. */
SPHFSI_INLINE void rates_of_cluster(const struct fluid *fluid, struct particles *particles,
                                    int32_t i, int count, int32_t cluster,
                                    const struct neighbours neighbours[KIND_COUNT],
                                    const struct cell_sides *sides,
                                    const struct vector_constants *k, struct pair_set fx,
                                    bool power, const struct chunk *chunk, struct chunk_totals *top)
{
    const real *const own = cluster_packed(&fluid->packed[KIND_FLUID], (size_t)cluster);
    struct receiver a[ROWS];
    for (int row = 0; row < ROWS; row++) a[row] = fluid_at(sides, own + row * GROUPS, fx);
    struct cluster_sums s = {.approach = top->approach};
    sum_fluid(&neighbours[KIND_FLUID], a, k, fx, chunk, &s);
    sum_bodies(fluid, particles, i, count, neighbours, a, k, fx, power, &s, top);
    top->approach = s.approach;
    real *const deferred =
        chunk->deferred + deferred_slot(chunk, (size_t)cluster) * deferred_stride(fx);
    if (count == CLUSTER) /* a compile-time constant */
        rates_store(fluid, particles, i, CLUSTER, &s, deferred, k, fx, power, top);
    else
        rates_store(fluid, particles, i, count, &s, deferred, k, fx, power, top);
}

SPHFSI_INLINE void rates_of_cell(const struct fluid *fluid, struct particles *particles,
                                 const struct cells *cells, int32_t cell,
                                 const struct vector_constants *k, struct pair_set fx, bool power,
                                 const struct chunk *chunk, struct chunk_totals *top)
{
    const struct cell_list *const list = &cells->kind[KIND_FLUID];
    struct neighbour_scratch *const neighbour_scratch = &fluid->neighbour_scratch[thread_index()];
    const struct cell_sides sides = cell_sides_of(fluid, cells);
    bool around[KIND_COUNT] = {false};
    neighbour_clusters_collect(&neighbour_scratch->around[KIND_FLUID],
                               &fluid->packed[KIND_FLUID].boxes, cells, KIND_FLUID, cell,
                               fluid->k.h, chunk->range);
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++) {
        around[kind] = fluid->near_dummies[cell] && fluid->n_near_fluid[kind];
        if (around[kind])
            gather_around_cell(neighbour_scratch, fluid, cells, (enum kind)kind, cell);
    }
    for (int32_t m = clusters_in(list, cell) - 1; m >= 0;
         m--) { /* in the order of the clusters ahead */
        const int32_t cluster = list->cluster[cell] + m;
        struct neighbours neighbours[KIND_COUNT];
        neighbours[KIND_FLUID] = gather_clusters_ahead(neighbour_scratch, fluid);
        for (int kind = KIND_WALL; kind < KIND_COUNT; kind++)
            neighbours[kind] = around[kind] ? gather_clusters(neighbour_scratch, fluid,
                                                              (enum kind)kind, KIND_FLUID, cluster)
                                            : (struct neighbours){.n = 0};
        rates_of_cluster(fluid, particles, list->start[cell] + m * CLUSTER,
                         particles_in(list, cell, m), cluster, neighbours, &sides, k, fx, power,
                         chunk, top);
    }
}

/* A chunk of the active cells, first to end - 1; `power`: NULL or those of its sections. */
SPHFSI_INLINE void rates_of_chunk(const struct fluid *fluid, struct particles *particles,
                                  const struct cells *cells, int32_t first, int32_t end,
                                  const struct vector_constants *k, struct pair_set fx,
                                  struct fluid_extremes *top, double *power)
{
    const struct cell_list *const list = &cells->kind[KIND_FLUID];
    const struct chunk chunk = {clusters_of(list, first, end),
                                fluid->neighbour_scratch[thread_index()].deferred};
    struct chunk_totals here = {.power_on = power};
    for (int m = 0; m < FLUID_POWERS * fluid->sections && power; m++) power[m] = 0;
    for (int32_t m = first; m < end; m++)
        rates_of_cell(fluid, particles, cells, list->active[m], k, fx, power, &chunk, &here);
    top->approach = max2(top->approach, (double)vtop(here.approach));
    for (int r = 0; r < CLUSTER; r++) {
        top->acceleration2 = max2(top->acceleration2, here.acceleration2[r]);
        for (int m = 0; m < FLUID_POWERS && power; m++)
            power[m * fluid->sections] += here.power[m][r];
    }
}

/* Kernels are compiled outside of any parallel region: the compiler makes the body of a region a
 * separate function before it can see that fx is a constant. */
#define RATES(name, set, power)                                                              \
    static void SWEEP(name)(const struct fluid *fluid, struct particles *particles,          \
                            const struct cells *cells, int32_t first, int32_t end,           \
                            struct fluid_extremes *top, double *on)                          \
    {                                                                                        \
        const struct vector_constants k = constants_of_sweep(fluid);                         \
        rates_of_chunk(fluid, particles, cells, first, end, &k, (struct pair_set){set}, top, \
                       (power) ? on : NULL);                                                 \
    }
#define VARIANT(variant, set)          \
    RATES(rates_##variant, set, false) \
    RATES(power_##variant, set, FX_ENERGY_ACCOUNT != 0)
#include "fluid/variants.def"
VARIANT(any, fluid->effects &(effect_set)PAIR_EFFECTS)
#undef VARIANT
#undef RATES

static const struct fluid_kernel SWEEP(kernels)[] = {
#define VARIANT(variant, set) \
    {#variant " (" SWEEP_LABEL ")", (set), SWEEP(rates_##variant), SWEEP(power_##variant)},
#include "fluid/variants.def"
    VARIANT(any, ANY_EFFECTS)
#undef VARIANT
};

#define VARIANT(variant, set) \
    _Static_assert(((set) & ~(effect_set)PAIR_EFFECTS) == 0, "pair effects: case/effects.def");
#include "fluid/variants.def"
#undef VARIANT

const struct fluid_sweeps SWEEP(fluid_sweeps) = {sizeof(real), SWEEP(packed), SWEEP(slopes),
                                                 SWEEP(dummies), SWEEP(kernels)};
