/* SPDX-License-Identifier: MIT
 * Sets up the fluid, runs the passes of an evaluation in order, and shifts particles. */
#include "fluid/fluid.h"
#include "base/threads.h"

static struct fluid_constants constants_of(const struct scene *scene)
{
    const struct scene_fluid *fluid = &scene->fluid[0];
    return (struct fluid_constants){
        .model = fluid,
        .h = scene->h,
        .c0 = scene->c0,
        .c_u = scene->c_u,
        .rho0 = scene->rho0,
        .mass = scene->rho0 * square(scene->top.dp),
        .dp = scene->top.dp,
        .second_moment = kernel_second_moment(scene->top.dp, scene->h),
        .shifting_speed = fluid->shifting_speed == SHIFTING_LARGEST ? scene->c0 / 10 : 0,
        .fills_domain =
            fluid->shifting_speed == SHIFTING_LARGEST || scene->domain.periodic == PERIODIC_XY,
        .gravity = {scene->top.gravity[0], scene->top.gravity[1]},
        .lowest_wall_pressure = scene->numerics.suction == SUCTION_ON ? -(double)INFINITY : 0,
    };
}

/* Packed fields that the effects need for a kind. */
static int packed_count(enum kind kind, effect_set effects)
{
    if (kind == KIND_FLUID && effects & FX_ANTUONO) return PACKED_SLOPE_FIELDS;
    if (kind == KIND_FLUID && effects & FX_VISCOSITY) return PACKED_VISCOUS_FIELDS;
    if (kind != KIND_FLUID && effects & FX_THIN) return PACKED_THIN_FIELDS;
    if (kind != KIND_FLUID && effects & FX_REPULSION) return PACKED_REPULSION_FIELDS;
    if (kind != KIND_FLUID && effects & FX_ONE_SIDED) return PACKED_ONE_SIDED_FIELDS;
    return kind != KIND_FLUID && effects & FX_NO_SLIP ? PACKED_NO_SLIP_FIELDS : PACKED_FIELDS;
}

static enum err packed_create(struct packed_fields *packed, struct arena *a, int64_t clusters,
                              size_t size, struct diag *d)
{
    if (clusters > CLUSTERS_MOST)
        return diag_fail(
            d, ERR_INPUT,
            "the case needs %lld clusters of particles, but the limit is %d; use a larger dp",
            (long long)clusters, CLUSTERS_MOST);
    packed->cluster = arena_alloc(a, (size_t)clusters, (size_t)(packed->n * CLUSTER) * size,
                                  "packed fields of the fluid", d);
    return packed->cluster ? cluster_boxes_create(&packed->boxes, a, clusters, d) : ERR_MEMORY;
}

/* Of each body: volumes of dummies, how near fluid may come, whether it moves, or fluid sticks. */
static enum err describe_bodies(struct fluid *fluid, struct arena *a, const struct scene *scene,
                                enum kind kind, struct diag *d)
{
    const bool wall = kind == KIND_WALL;
    const size_t n = (size_t)(wall ? scene->n_wall : scene->n_solid);
    TRY(arena_array(a, &fluid->volume[kind], n, "volumes", d));
    TRY(arena_array(a, &fluid->repulsion2[kind], n, "distances", d));
    TRY(arena_array(a, &fluid->moves[kind], n, "motions", d));
    for (int k = 0; k < (int)n; k++) {
        fluid->volume[kind][k] = wall ? 1 : square(scene_solid_dp(scene, k) / scene->top.dp);
        const double spacing = 0.5 * (1 + sqrt(fluid->volume[kind][k])) * fluid->k.dp;
        fluid->repulsion2[kind][k] = square(REPULSION_REACH * spacing / fluid->k.h) + ETA2;
        fluid->moves[kind][k] = !wall || scene->wall[k].motion[0] || k >= scene_beam_wall(scene, 0);
    }
    if (!(fluid->effects & FX_NO_SLIP)) return ERR_OK;
    TRY(arena_array(a, &fluid->sticks[kind], n, "walls", d));
    for (int k = 0; k < (int)n; k++)
        fluid->sticks[kind][k] = (wall ? scene->wall[k].slip : scene->solid[k].slip) == SLIP_NONE;
    return ERR_OK;
}

/* One allocation for all threads; each thread writes to its own part first. */
static enum err neighbour_scratch_create(struct fluid *fluid, struct arena *a, int64_t clusters,
                                         struct diag *d)
{
    const int64_t largest = CHUNK_CELLS * (CELL_CAPACITY / CLUSTER);
    const size_t places = 1 + (size_t)(clusters < largest ? clusters : largest);
    const size_t size = places * (size_t)pair_sum_count(fluid->effects) * CLUSTER * CLUSTER *
                        fluid->sweeps->packed_item_size;
    fluid->thread_bytes = size + sizeof *fluid->neighbour_scratch;
    TRY(arena_array(a, &fluid->neighbour_scratch, fluid->threads, "neighbour clusters", d));
    unsigned char *deferred;
    TRY(arena_place(a, &deferred, (size_t)fluid->threads, size, "sums over pairs", d));
    for (int t = 0; t < fluid->threads; t++)
        fluid->neighbour_scratch[t].deferred = deferred + (size_t)t * size;
    for (int t = 0; t < fluid->threads && fluid->effects & FX_THIN; t++) {
        TRY(arena_place(a, &fluid->neighbour_scratch[t].pieces,
                        (size_t)(fluid->lines.n_pieces * CELLS_IMAGES), NEAR_PIECE_BYTES,
                        "thin walls", d));
    }
    return ERR_OK;
}

enum err fluid_create(struct fluid *fluid, struct arena *a, const struct scene *scene,
                      struct particles kinds[KIND_COUNT], const struct cells *cells, struct diag *d)
{
    const effect_set effects = fluid->effects;
    fluid->k = constants_of(scene);
    fluid->never_skip = scene->test.never_skip;
    fluid->sweeps =
        scene->top.precision == PRECISION_MIXED ? &fluid_sweeps_mixed : &fluid_sweeps_double;
    fluid->variant = fluid->sweeps->variants;
    while (fluid->variant->effects != ANY_EFFECTS &&
           (scene->test.generic_variant ||
            fluid->variant->effects != (effects & (effect_set)PAIR_EFFECTS)))
        fluid->variant++;
    fluid->threads = thread_count();
    if (effects & FX_THIN) TRY(lines_create(&fluid->lines, a, scene, &kinds[KIND_WALL], d));
    for (int k = 0; k < KIND_COUNT; k++) fluid->packed[k].n = packed_count((enum kind)k, effects);
    TRY(neighbour_scratch_create(fluid, a, cells_clusters(cells, kinds[KIND_FLUID].capacity), d));
    const int64_t n_cells = (int64_t)cells->nx * cells->ny, n_fluid = kinds[KIND_FLUID].capacity;
    TRY(arena_array(a, &fluid->around, n_cells < n_fluid ? n_cells : n_fluid,
                    "cells around those of fluid", d));
    for (int k = 0; k < KIND_COUNT; k++) {
        if (kinds[k].capacity == 0) continue;
        TRY(packed_create(&fluid->packed[k], a, cells_clusters(cells, kinds[k].capacity),
                          fluid->sweeps->packed_item_size, d));
        if (k == KIND_FLUID) continue;
        TRY(arena_array(a, &fluid->near_dummies[k], (size_t)cells->nx * (size_t)cells->ny,
                        "cells near walls and structures", d));
        TRY(arena_array(a, &fluid->near_fluid[k], kinds[k].capacity, "cells near fluid", d));
        TRY(describe_bodies(fluid, a, scene, (enum kind)k, d));
    }
    return ERR_OK;
}

/* The factor of the shift: Skillen et al. 2013, or the Mach number of 0.1 of Eq. 3 (Sun et al.
 * 2017). At the free surface, where the divergence of the positions falls from 2 to below 1.5, the
 * shift goes to zero as in Dominguez et al. 2022. */
double fluid_shift(const struct fluid *fluid, struct particles *particles, double dt)
{
    const double full = 2, none = 1.5, given = fluid->k.shifting_speed,
                 of_speed = given > 0 ? 0 : 1, fills = fluid->k.fills_domain ? 2 : 0,
                 size = -fluid->k.model->shifting * fluid->k.h * dt;
    /* Pointers of their own: gcc would gather what it loads through the structure. */
    const double *const cx = particles->grad_c_x, *const cy = particles->grad_c_y,
                        *const div_r = particles->div_r;
    const double *const vx = particles->vx, *const vy = particles->vy;
    double *const x = particles->x, *const y = particles->y, *const dens = particles->dens;
    double longest2 = 0;
#pragma omp parallel for simd schedule(static) num_threads(fluid->threads) reduction(max : longest2)
    for (int64_t i = 0; i < particles->n; i++) {
        const double fade = min2(1, max2(0, (div_r[i] - none) / (full - none)));
        const double speed = given + of_speed * sqrt(square(vx[i]) + square(vy[i]));
        const double step = size * speed * fade, dx = step * cx[i], dy = step * cy[i];
        x[i] += dx;
        y[i] += dy;
        dens[i] += fills * (1 + dens[i]) * (dx * cx[i] + dy * cy[i]); /* L-9 */
        longest2 = max2(longest2, dx * dx + dy * dy);
    }
    return sqrt(longest2);
}

/* T-9b by backward Euler. */
void fluid_follow_density(const struct fluid *fluid, struct particles *particles, double dt)
{
    const double fraction = dt / (dt + fluid->k.model->acoustic_damper * fluid->k.h / fluid->k.c0);
#pragma omp parallel for simd schedule(static) num_threads(fluid->threads)
    for (int64_t i = 0; i < particles->n; i++)
        particles->dens_slow[i] += fraction * (particles->dens[i] - particles->dens_slow[i]);
}

/* Marks the nine cells around a cell of walls or structures; returns whether any has fluid. */
static bool mark_around(const struct cells *cells, int32_t cell, bool *near_dummies)
{
    const int cx = cell_x(cells, cell), cy = cell_y(cells, cell);
    bool wet = false;
    for (int y = cy - 1; y <= cy + 1; y++) {
        for (int x = cx - 1; x <= cx + 1; x++) {
            const int32_t other = cell_at(cells, x, y);
            if (other < 0) continue;
            near_dummies[other] = true;
            wet |= cells->list[KIND_FLUID].count[other] > 0;
        }
    }
    return wet;
}

/* The cells around those of fluid, chunk by chunk. */
static void find_around(struct fluid *fluid, const struct cells *cells)
{
    const struct cell_list *const list = &cells->list[KIND_FLUID];
    const int32_t chunks = fluid_chunk_count(list->n_active);
#pragma omp parallel for schedule(static)
    for (int32_t m = 0; m < chunks; m++) {
        const int32_t first = fluid_chunk_start(list->n_active, m),
                      end = fluid_chunk_start(list->n_active, m + 1);
        if (first == end) continue;
        const struct cluster_range range = clusters_of(list, first, end);
        for (int32_t n = first; n < end; n++)
            cells_around_find(&fluid->around[n], cells, KIND_FLUID, list->active[n], range);
    }
}

void fluid_find_near(struct fluid *fluid, const struct cells *cells)
{
    find_around(fluid, cells);
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++) {
        const struct cell_list *list = &cells->list[kind];
        bool *const near_dummies = fluid->near_dummies[kind];
        int32_t n = 0;
        if (!near_dummies) continue;
        memset(near_dummies, 0, (size_t)cells->nx * (size_t)cells->ny * sizeof *near_dummies);
        for (int32_t k = 0; k < list->n_active; k++)
            if (mark_around(cells, list->active[k], near_dummies) || fluid->never_skip)
                fluid->near_fluid[kind][n++] = list->active[k];
        fluid->n_near_fluid[kind] = n;
    }
    fluid->walls_placed = false;
}

void fluid_evaluate(struct fluid *fluid, struct particles kinds[KIND_COUNT],
                    const struct cells *cells, double phase_seconds[PHASE_COUNT])
{
    double since = phase_clock();
    fluid->sweeps->pack(fluid, kinds, cells);
    since = phase_end(&phase_seconds[PHASE_packed], since);
    if (fluid->effects & FX_ANTUONO) {
        if (!fluid->keeps_slopes) fluid->sweeps->find_slopes(fluid, kinds, cells);
        since = phase_end(&phase_seconds[PHASE_slope], since);
    }
    if (fluid->effects & (FX_WALL | FX_COUPLING)) {
        for (int kind = KIND_WALL; kind < KIND_COUNT; kind++)
            if (fluid->n_near_fluid[kind])
                fluid->sweeps->update_dummies(fluid, kinds, cells, (enum kind)kind);
        fluid->walls_placed = !fluid->never_skip;
        since = phase_end(&phase_seconds[PHASE_wall], since);
    }
    const int32_t n_active = cells->list[KIND_FLUID].n_active, chunks = fluid_chunk_count(n_active);
    double acceleration2 = 0, approach = 0;
#pragma omp parallel for schedule(static) num_threads(fluid->threads) \
    reduction(max                                                     \
              : acceleration2, approach)
    for (int32_t m = 0; m < chunks; m++) {
        const int32_t first = fluid_chunk_start(n_active, m),
                      end = fluid_chunk_start(n_active, m + 1);
        if (first == end) continue;
        struct rate_extremes largest = {acceleration2, approach};
        fluid->variant->rates(fluid, &kinds[KIND_FLUID], cells, first, end, &largest);
        acceleration2 = largest.acceleration2;
        approach = largest.approach;
    }
    fluid->extremes = (struct rate_extremes){acceleration2, approach};
    phase_end(&phase_seconds[PHASE_fluid], since);
}

void fluid_write_pressure(const struct fluid *fluid, struct particles *particles)
{
    for (int64_t i = 0; i < particles->n; i++)
        particles->p[i] = eos_pressure(particles->dens[i], fluid->k.rho0, fluid->k.c0);
}
