/* SPDX-License-Identifier: MIT
 * The sweeps of the fluid for both precisions: fluid/sweep_mixed.c and fluid/sweep_double.c include
 * this file after base/real_float.h and base/real_double.h. Four particles of a cell that are close
 * together form a cluster, which interacts with the clusters near it. A thread writes to its chunk
 * of cells only, and chunks do not depend on the number of threads; so neither do the bits. Each
 * lane of a group of four has its own sum over candidates, so the bits do not depend on the number
 * of groups in a vector. */
#include "fluid/fluid.h"
#include "fluid/neighbours.h"
/* After the definitions that they need. */
#include "fluid/pair_laws.h"
#include "fluid/packed.h"
#include "fluid/dummies.h"

/* A range of the fluid that a thread processes at a time. */
struct chunk {
    struct cluster_range range;
    real *deferred; /* scratch of the thread */
};

/* Largest values in a chunk, reduced over the SIMD lanes once. */
struct chunk_totals {
    vreal approach;
    four_double acceleration2;
};

#include "fluid/pair_sums.h"

/* A sum of a cluster as receivers, less (odd) or plus (even) what was deferred for it. */
SPHFSI_INLINE four_double odd_sum(const struct cluster_sums *s, real *deferred, enum pair_sum which)
{
    return own_sum(s, which) - take_deferred(DEFERRED(deferred, which));
}
SPHFSI_INLINE four_double even_sum(const struct cluster_sums *s, real *deferred,
                                   enum pair_sum which)
{
    return own_sum(s, which) + take_deferred(DEFERRED(deferred, which));
}

/* Writes the rates of `count` particles from i on: their sums times the factors that these lack. */
SPHFSI_INLINE void rates_store(const struct fluid *fluid, struct particles *particles, int32_t i,
                               int count, const struct cluster_sums *s, real *deferred,
                               const struct vector_constants *k, struct pair_set effects,
                               struct chunk_totals *largest)
{
    const four_double density =
        1 + FOUR(fluid->predict_by > 0 ? particles->dens_half : particles->dens, i);
    four_double per_volume = density; /* of the particle, in units of that at rest */
    four_double factor = k->acceleration + 0 * density;
    four_double rate = density * even_sum(s, deferred, SUM_RATE);
    if (PAIR_HAS(effects, MASSES)) { /* all sums contain the volume of the particle itself */
        const four_double inverse_mass = 1 / FOUR(particles->m, i);
        factor = factor * inverse_mass;
        per_volume = per_volume * inverse_mass;
    }
    const four_double fx_a = factor * odd_sum(s, deferred, SUM_X),
                      fy_a = factor * odd_sum(s, deferred, SUM_Y);
    const four_double ax = fx_a + fluid->k.gravity[0], ay = fy_a + fluid->k.gravity[1];
    if (PAIR_HAS(effects, DIFFUSION)) {
        const double diffusion =
            PAIR_HAS(effects, LIMITER) ? 2 * STRAIN_DIFFUSION : k->diffusion_factor;
        rate = rate + diffusion * odd_sum(s, deferred, SUM_DIFFUSED);
    }
    const four_double slope = k->kernel_slope * per_volume;
    const four_double ddens = -slope * rate, a2 = ax * ax + ay * ay;
    store_four(particles->ax + i, ax, count);
    store_four(particles->ay + i, ay, count);
    store_four(particles->ddens + i, ddens, count);
    if (count == CLUSTER)
        largest->acceleration2 = four_max(largest->acceleration2, a2);
    else
        for (int r = 0; r < count; r++)
            largest->acceleration2[r] = max2(largest->acceleration2[r], a2[r]);
    if (!(PAIR_HAS(effects, SHIFTING))) return;
    store_four(particles->grad_c_x + i, -slope * odd_sum(s, deferred, SUM_GRAD_C_X), count);
    store_four(particles->grad_c_y + i, -slope * odd_sum(s, deferred, SUM_GRAD_C_Y), count);
    store_four(particles->div_r + i, fluid->k.h * slope * even_sum(s, deferred, SUM_DIV_R), count);
}

/* Receivers of the fluid from their packed fields. */
SPHFSI_INLINE struct receiver fluid_at(const struct cell_sides *sides, const real *own,
                                       struct pair_set effects)
{
    struct receiver a = receiver_at(sides, own);
    a.u = vspread(own + PACKED_U * CLUSTER);
    a.v = vspread(own + PACKED_V * CLUSTER);
    a.p = vspread(own + PACKED_P * CLUSTER);
    a.dens = vspread(own + PACKED_DENS * CLUSTER);
    a.volume = vspread(own + PACKED_VOLUME * CLUSTER);
    if (PAIR_HAS(effects, VISCOSITY)) a.specific = vspread(own + PACKED_SPECIFIC * CLUSTER);
    if (PAIR_HAS(effects, ANTUONO)) {
        a.dens_x = vspread(own + PACKED_SLOPE_X * CLUSTER);
        a.dens_y = vspread(own + PACKED_SLOPE_Y * CLUSTER);
    }
    return a;
}

/* A cluster of `count` particles from i on. */
SPHFSI_INLINE void rates_of_cluster(const struct fluid *fluid, struct particles *particles,
                                    int32_t i, int count, int32_t cluster,
                                    const struct neighbours neighbours[KIND_COUNT],
                                    const struct cell_sides *sides,
                                    const struct vector_constants *k, struct pair_set effects,
                                    const struct chunk *chunk, struct chunk_totals *largest)
{
    const real *const own = cluster_packed(&fluid->packed[KIND_FLUID], (size_t)cluster);
    struct receiver a[ROWS];
    for (int row = 0; row < ROWS; row++) a[row] = fluid_at(sides, own + row * GROUPS, effects);
    struct cluster_sums s = {.approach = largest->approach};
    sum_fluid(&neighbours[KIND_FLUID], a, k, effects, chunk, &s);
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++)
        if (neighbours[kind].n) sum_dummies(&neighbours[kind], a, k, effects, &s);
    largest->approach = s.approach;
    real *const deferred =
        chunk->deferred + deferred_slot(chunk, (size_t)cluster) * deferred_stride(effects);
    if (count == CLUSTER) /* a compile-time constant */
        rates_store(fluid, particles, i, CLUSTER, &s, deferred, k, effects, largest);
    else
        rates_store(fluid, particles, i, count, &s, deferred, k, effects, largest);
}

/* Asks for the packed fields and boxes around the n-th active cell while the one before is
 * computed. Scenes larger than the second cache would wait for each of them; no stream in memory
 * predicts them. The cell itself is last in the list; earlier cells have already loaded it. */
SPHFSI_INLINE void prefetch_around(const struct fluid *fluid, int32_t n)
{
    enum { LINE = 64 }; /* bytes */
    const struct packed_fields *const packed = &fluid->packed[KIND_FLUID];
    const struct cells_around *const around = &fluid->around[n];
    const size_t bytes = (size_t)(packed->n * CLUSTER) * sizeof(real);
    for (int k = 0; k < around->n - around->half; k++) {
        const size_t first = neighbour_number(around->code[k]);
        const real *const from = cluster_packed(packed, first);
        for (int side = 0; side < BOX_SIDES; side++)
            __builtin_prefetch(&packed->boxes.side[side][first]);
        for (size_t at = 0; at < around->count[k] * bytes; at += LINE)
            __builtin_prefetch((const char *)from + at);
    }
}

/* The n-th active cell. */
SPHFSI_INLINE void rates_of_cell(const struct fluid *fluid, struct particles *particles,
                                 const struct cells *cells, int32_t n,
                                 const struct vector_constants *k, struct pair_set effects,
                                 const struct chunk *chunk, struct chunk_totals *largest)
{
    const struct cell_list *const list = &cells->list[KIND_FLUID];
    const int32_t cell = list->active[n];
    struct neighbour_scratch *const neighbour_scratch = &fluid->neighbour_scratch[thread_index()];
    const struct cell_sides sides = cell_sides_of(fluid, cells, cell, PAIR_HAS(effects, THIN));
    bool around[KIND_COUNT] = {false};
    if (n + 1 < list->n_active) prefetch_around(fluid, n + 1);
    neighbour_clusters_copy(&neighbour_scratch->around[KIND_FLUID],
                            &fluid->packed[KIND_FLUID].boxes, &fluid->around[n], cells, fluid->k.h);
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++) {
        around[kind] = fluid_near_kind(fluid, (enum kind)kind, cell);
        if (around[kind])
            gather_around_cell(neighbour_scratch, fluid, cells, (enum kind)kind, cell);
    }
    /* In the order of the clusters ahead. */
    for (int32_t m = clusters_in(list, cell) - 1; m >= 0; m--) {
        const int32_t cluster = list->cluster[cell] + m;
        struct neighbours neighbours[KIND_COUNT];
        neighbours[KIND_FLUID] = gather_clusters_ahead(neighbour_scratch, fluid);
        for (int kind = KIND_WALL; kind < KIND_COUNT; kind++)
            neighbours[kind] = around[kind] ? gather_clusters(neighbour_scratch, fluid,
                                                              (enum kind)kind, KIND_FLUID, cluster)
                                            : (struct neighbours){.n = 0};
        rates_of_cluster(fluid, particles, list->start[cell] + m * CLUSTER,
                         particles_in(list, cell, m), cluster, neighbours, &sides, k, effects,
                         chunk, largest);
    }
}

/* A chunk of the active cells, first to end - 1. */
SPHFSI_INLINE void rates_of_chunk(const struct fluid *fluid, struct particles *particles,
                                  const struct cells *cells, int32_t first, int32_t end,
                                  const struct vector_constants *k, struct pair_set effects,
                                  struct rate_extremes *largest)
{
    const struct cell_list *const list = &cells->list[KIND_FLUID];
    const struct chunk chunk = {clusters_of(list, first, end),
                                fluid->neighbour_scratch[thread_index()].deferred};
    struct chunk_totals here = {.acceleration2 = {0}};
    for (int32_t m = first; m < end; m++)
        rates_of_cell(fluid, particles, cells, m, k, effects, &chunk, &here);
    largest->approach = max2(largest->approach, (double)vtop(here.approach));
    for (int r = 0; r < CLUSTER; r++)
        largest->acceleration2 = max2(largest->acceleration2, here.acceleration2[r]);
}

/* Variants are compiled outside of any parallel region: the compiler makes the body of a region a
 * separate function before it can see that effects is a constant. */
#define VARIANT(variant, set)                                                                     \
    static void SWEEP(rates_##variant)(const struct fluid *fluid, struct particles *particles,    \
                                       const struct cells *cells, int32_t first, int32_t end,     \
                                       struct rate_extremes *largest)                             \
    {                                                                                             \
        const struct vector_constants k = constants_of_sweep(fluid);                              \
        rates_of_chunk(fluid, particles, cells, first, end, &k, (struct pair_set){set}, largest); \
    }
#include "fluid/variants.def"
VARIANT(any, fluid->effects &(effect_set)PAIR_EFFECTS)
#undef VARIANT

static const struct fluid_variant SWEEP(variants)[] = {
#define VARIANT(variant, set) {#variant " (" SWEEP_LABEL ")", (set), SWEEP(rates_##variant)},
#include "fluid/variants.def"
    VARIANT(any, ANY_EFFECTS)
#undef VARIANT
};

#define VARIANT(variant, set) \
    _Static_assert(((set) & ~(effect_set)PAIR_EFFECTS) == 0, "pair effects: case/effects.def");
#include "fluid/variants.def"
#undef VARIANT

const struct fluid_sweeps SWEEP(fluid_sweeps) = {sizeof(real), SWEEP(pack), SWEEP(find_slopes),
                                                 SWEEP(update_dummies), SWEEP(variants)};
