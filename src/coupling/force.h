/* SPDX-License-Identifier: MIT
 * The force of the fluid on structures, and on walls that move or whose force is probed (Eq. 21b).
 * Included by force_mixed.c and force_double.c after the header of their precision. */
#include "coupling/coupling.h"
#include "fluid/neighbours.h"
/* After the definitions that they need. */
#include "fluid/pair_laws.h"

/* Adds sums over pairs, times a factor and the volume of each receiver, to its force. */
SPHFSI_INLINE void add_force(const vreal sum_x[PARTS], const vreal sum_y[PARTS], double factor,
                             const double *volume, double *fx, double *fy)
{
    real x[GROUPS], y[GROUPS];
    sum_lanes(sum_x, x);
    sum_lanes(sum_y, y);
    for (int g = 0; g < GROUPS; g++) {
        fx[g] += factor * volume[g] * (double)x[g];
        fy[g] += factor * volume[g] * (double)y[g];
    }
}

/* Minus the laminar force that sum_dummies adds to the fluid; s has the mirrored velocity. */
SPHFSI_INLINE void drag_force(const struct fluid *fluid, const struct neighbours *neighbours,
                              const struct receiver *s, const double *volume,
                              const struct vector_constants *k, double *fx, double *fy)
{
    vreal sum_x[PARTS] = {{0}}, sum_y[PARTS] = {{0}};
    EACH_CANDIDATE(neighbours, part, code, b)
    {
        const struct pair q = pair_load(s, code, b, lane(b, PACKED_VOLUME), s->line, s->filled);
        const vreal weight = law_laminar(&q, k);
        sum_x[part] = vfma(weight, q.u, sum_x[part]);
        sum_y[part] = vfma(weight, q.v, sum_y[part]);
    }
    add_force(sum_x, sum_y, -PAIR_SLOPE * fluid->k.h, volume, fx, fy);
}

/* Eq. 21b: force of the fluid on solid particles, V_s sum of V_f (P_s + P_f) grad W with opposite
 * sign, N/m per depth; equal and opposite to the fluid's sums. With `wetted` also the surface
 * per depth, m: the force of a pressure of 1 Pa on both sides of the pairs. */
SPHFSI_INLINE void fluid_force(const struct fluid *fluid, const struct neighbours *neighbours,
                               const struct receiver *s, const real *own, const double *volume,
                               const struct vector_constants *k, struct pair_set effects,
                               bool wetted, double *const force[2], double *const wet[2])
{
    struct surface surface = {.p = s->p};
    if (PAIR_HAS(effects, ONE_SIDED)) {
        surface.lift_x = vspread(own + PACKED_LIFT_X * CLUSTER);
        surface.lift_y = vspread(own + PACKED_LIFT_Y * CLUSTER);
    }
    if (PAIR_HAS(effects, REPULSION)) surface.near = vspread(own + PACKED_REPULSION2 * CLUSTER);
    vreal sum_x[PARTS] = {{0}}, sum_y[PARTS] = {{0}}, wet_x[PARTS] = {{0}}, wet_y[PARTS] = {{0}};
    EACH_CANDIDATE(neighbours, part, code, b)
    {
        const struct pair q = pair_load(s, code, b, lane(b, PACKED_VOLUME), s->line, s->filled);
        const vreal dens = PAIR_HAS(effects, ONE_SIDED) ? lane(b, PACKED_DENS) : vset(0),
                    g = q.weight *
                        law_surface(lane(b, PACKED_P), dens, -q.x, -q.y, &surface, &q, k, effects);
        sum_x[part] = vfma(g, q.x, sum_x[part]);
        sum_y[part] = vfma(g, q.y, sum_y[part]);
        if (!wetted) continue;
        wet_x[part] = vfma(q.weight, q.x, wet_x[part]);
        wet_y[part] = vfma(q.weight, q.y, wet_y[part]);
    }
    add_force(sum_x, sum_y, PAIR_SLOPE * fluid->k.h, volume, force[0], force[1]);
    if (wetted) add_force(wet_x, wet_y, 2 * PAIR_SLOPE * fluid->k.h, volume, wet[0], wet[1]);
}

/* The forces on the `count` particles at `index` of a cluster with the packed fields `own`. */
SPHFSI_INLINE void force_on_cluster(const struct fluid *fluid, struct particles *particles,
                                    const int32_t *index, int count, const real *own,
                                    const struct neighbours *neighbours,
                                    const struct cell_sides *sides,
                                    const struct vector_constants *k, effect_set effects,
                                    bool wetted)
{
    double force_x[CLUSTER] = {0}, force_y[CLUSTER] = {0}, wet_x[CLUSTER] = {0},
           wet_y[CLUSTER] = {0}, drag_x[CLUSTER] = {0}, drag_y[CLUSTER] = {0};
    for (int r = 0; r < CLUSTER && neighbours->n; r += GROUPS, own += GROUPS) {
        struct receiver s = dummy_at(sides, own);
        s.u = vspread(own + PACKED_U * CLUSTER);
        s.v = vspread(own + PACKED_V * CLUSTER);
        s.p = vspread(own + PACKED_P * CLUSTER);
        double volume[GROUPS];
        for (int g = 0; g < GROUPS; g++) volume[g] = (double)own[PACKED_VOLUME * CLUSTER + g];
        fluid_force(fluid, neighbours, &s, own, volume, k, (struct pair_set){effects}, wetted,
                    (double *[]){&force_x[r], &force_y[r]}, (double *[]){&wet_x[r], &wet_y[r]});
        if (!(effects & FX_NO_SLIP)) continue;
        s.u = vspread(own + PACKED_MIRROR_U * CLUSTER);
        s.v = vspread(own + PACKED_MIRROR_V * CLUSTER);
        for (int g = 0; g < GROUPS; g++) volume[g] *= (double)own[PACKED_STICKS * CLUSTER + g];
        drag_force(fluid, neighbours, &s, volume, k, &drag_x[r], &drag_y[r]);
    }
    for (int r = 0; r < count; r++) {
        particles->fx[index[r]] = force_x[r] + drag_x[r];
        particles->fy[index[r]] = force_y[r] + drag_y[r];
        particles->drag_x[index[r]] = drag_x[r];
        particles->drag_y[index[r]] = drag_y[r];
        if (!wetted) continue;
        particles->wet_x[index[r]] = wet_x[r];
        particles->wet_y[index[r]] = wet_y[r];
    }
}

SPHFSI_INLINE void force_on_cell(const struct fluid *fluid, struct particles *particles,
                                 enum kind kind, const struct cells *cells, int32_t cell, bool all,
                                 const struct vector_constants *k, effect_set effects, bool wetted,
                                 bool thin)
{
    const struct cell_list *const list = &cells->list[kind];
    struct neighbour_scratch *const scratch = &fluid->neighbour_scratch[thread_index()];
    const struct cell_sides sides = cell_sides_of(fluid, cells, cell, thin);
    bool gathered = false;
    for (int32_t m = 0; m < clusters_in(list, cell); m++) {
        const int32_t cluster = list->cluster[cell] + m,
                      *const index = &list->order[list->start[cell] + m * CLUSTER];
        const int count = particles_in(list, cell, m);
        if (!all && !dummies_move(fluid, kind, particles, index, count)) continue;
        if (!gathered) gather_around_cell(scratch, fluid, cells, KIND_FLUID, cell);
        gathered = true;
        const struct neighbours neighbours =
            gather_clusters(scratch, fluid, KIND_FLUID, kind, cluster);
        force_on_cluster(fluid, particles, index, count,
                         cluster_packed(&fluid->packed[kind], (size_t)cluster), &neighbours, &sides,
                         k, effects, wetted);
    }
}

void SWEEP(find_force)(const struct fluid *fluid, struct particles *particles, enum kind kind,
                       const struct cells *cells, bool all)
{
    const struct vector_constants k = constants_of_sweep(fluid);
    const effect_set effects = fluid->effects & (effect_set)SURFACE_EFFECTS;
    /* T-35a, T-95 */
    const bool wetted = fluid->effects & (kind == KIND_SOLID ? FX_IMPEDANCE : FX_RIGID | FX_BEAM);
    const int32_t *const cell = fluid->near_fluid[kind], n = fluid->n_near_fluid[kind];
#pragma omp parallel for schedule(static) num_threads(fluid->threads)
    for (int32_t m = 0; m < n; m++)
        if (effects & FX_THIN)
            force_on_cell(fluid, particles, kind, cells, cell[m], all, &k, effects, wetted, true);
        else if (effects)
            force_on_cell(fluid, particles, kind, cells, cell[m], all, &k, effects, wetted, false);
        else /* pressure alone */
            force_on_cell(fluid, particles, kind, cells, cell[m], all, &k, 0, wetted, false);
}
