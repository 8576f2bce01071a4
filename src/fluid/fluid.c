/* SPDX-License-Identifier: MIT */
#include "fluid/fluid.h"

#include "fluid/eos.h"

#include <math.h>
#include <string.h>

static struct fluid_constants constants_of(const struct scene *s)
{
    const struct scene_fluid *fluid = &s->fluid[0];
    return (struct fluid_constants){
        .model = fluid,
        .h = s->h,
        .c0 = s->c0,
        .rho0 = s->rho0,
        .mass = s->rho0 * square(s->top.dp),
        .dp = s->top.dp,
        .shifting_speed = fluid->shifting_speed == SHIFTING_LARGEST ? s->c0 / 10 : 0,
        .fills_domain =
            fluid->shifting_speed == SHIFTING_LARGEST || s->domain.periodic == PERIODIC_XY,
        .gravity = {s->top.gravity[0], s->top.gravity[1]},
        .lowest_wall_pressure = s->numerics.suction == SUCTION_ON ? -(double)INFINITY : 0,
    };
}

/* Packed fields that the effects need for a kind. */
static int packed_count(enum kind kind, effect_set effects)
{
    if (kind == KIND_FLUID && effects & FX_ANTUONO) return PACKED_SLOPE_FIELDS;
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

static enum err note_slip(struct fluid *f, struct arena *a, const struct scene *s, struct diag *d)
{
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++) {
        const int n = kind == KIND_WALL ? s->n_wall : s->n_solid;
        bool *const sticks = arena_alloc(a, (size_t)n, sizeof *sticks, "walls", d);
        if (!sticks) return ERR_MEMORY;
        for (int k = 0; k < n; k++)
            sticks[k] = (kind == KIND_WALL ? s->wall[k].slip : s->solid[k].slip) == SLIP_NONE;
        f->sticks[kind] = sticks;
    }
    return ERR_OK;
}

/* One allocation for all threads; each thread writes to its own part first. */
static enum err neighbour_scratch_create(struct fluid *f, struct arena *a, int64_t clusters,
                                         struct diag *d)
{
    const int64_t most = CHUNK_CELLS * (CELL_CAPACITY / CLUSTER);
    const size_t places = 1 + (size_t)(clusters < most ? clusters : most);
    const size_t size =
        places * (size_t)pair_sums(f->effects) * CLUSTER * CLUSTER * f->sweeps->packed_item_size;
    f->thread_bytes = size + sizeof *f->neighbour_scratch;
    f->neighbour_scratch =
        arena_alloc(a, (size_t)f->threads, sizeof *f->neighbour_scratch, "neighbour clusters", d);
    unsigned char *const deferred = arena_alloc(a, (size_t)f->threads, size, "sums over pairs", d);
    if (!f->neighbour_scratch || !deferred) return ERR_MEMORY;
    for (int t = 0; t < f->threads; t++)
        f->neighbour_scratch[t].deferred = deferred + (size_t)t * size;
    return ERR_OK;
}

enum err fluid_create(struct fluid *f, struct arena *a, const struct scene *s, effect_set effects,
                      const struct particles kinds[KIND_COUNT], const struct cells *c,
                      struct diag *d)
{
    memset(f, 0, sizeof *f);
    f->k = constants_of(s);
    f->effects = effects;
    f->never_skip = s->test.never_skip;
    f->sweeps = s->top.precision == PRECISION_MIXED ? &fluid_sweeps_mixed : &fluid_sweeps_double;
    f->kernel = f->sweeps->kernels;
    while (f->kernel->effects != ANY_EFFECTS &&
           (s->test.generic_kernel || f->kernel->effects != (effects & (effect_set)PAIR_EFFECTS)))
        f->kernel++;
    f->threads = thread_count();
    for (int k = 0; k < KIND_COUNT; k++) f->packed[k].n = packed_count((enum kind)k, effects);
    TRY(neighbour_scratch_create(f, a, cells_clusters(c, kinds[KIND_FLUID].capacity), d));
    f->near_dummies = arena_alloc(a, (size_t)c->nx * (size_t)c->ny, sizeof *f->near_dummies,
                                  "cells near walls and structures", d);
    if (!f->near_dummies) return ERR_MEMORY;
    if (effects & FX_NO_SLIP) TRY(note_slip(f, a, s, d));
    for (int k = 0; k < KIND_COUNT; k++) {
        if (kinds[k].capacity == 0) continue;
        TRY(packed_create(&f->packed[k], a, cells_clusters(c, kinds[k].capacity),
                          f->sweeps->packed_item_size, d));
        if (k == KIND_FLUID) continue;
        f->near_fluid[k] = arena_alloc(a, (size_t)kinds[k].capacity, sizeof *f->near_fluid[k],
                                       "cells near fluid", d);
        if (!f->near_fluid[k]) return ERR_MEMORY;
        const int sections = k == KIND_WALL ? s->n_wall : s->n_solid;
        f->volume[k] = arena_alloc(a, (size_t)sections, sizeof(double), "volumes", d);
        if (!f->volume[k]) return ERR_MEMORY;
        for (int b = 0; b < sections; b++)
            f->volume[k][b] = k == KIND_WALL ? 1 : square(scene_solid_dp(s, b) / s->top.dp);
    }
    return ERR_OK;
}

/* The factor of the shift: Skillen et al. 2013, or the Mach number of 0.1 of Eq. 3 (Sun et al.
 * 2017). At the free surface, where the divergence of the positions falls from 2 to below 1.5, the
 * shift goes to zero as in Dominguez et al. 2022. */
double fluid_shift(const struct fluid *f, struct particles *p, double dt)
{
    const double full = 2, none = 1.5;
    double longest2 = 0;
#pragma omp parallel for schedule(static) num_threads(f->threads) reduction(max : longest2)
    for (int64_t i = 0; i < p->n; i++) {
        const double fade = min2(1, max2(0, (p->div_r[i] - none) / (full - none)));
        const double speed = f->k.shifting_speed > 0
                                 ? f->k.shifting_speed
                                 : sqrt(p->vx[i] * p->vx[i] + p->vy[i] * p->vy[i]);
        if (p->open && p->open[i]) continue; /* T-50: the motion of buffers is given */
        const double size = -f->k.model->shifting * f->k.h * speed * dt * fade;
        const double dx = size * p->grad_c_x[i], dy = size * p->grad_c_y[i];
        p->x[i] += dx;
        p->y[i] += dy;
        if (f->k.fills_domain) /* L-9 */
            p->dens[i] += 2 * (1 + p->dens[i]) * (dx * p->grad_c_x[i] + dy * p->grad_c_y[i]);
        longest2 = max2(longest2, dx * dx + dy * dy);
    }
    return sqrt(longest2);
}

/* T-9b by backward Euler. */
void fluid_follow_density(const struct fluid *f, struct particles *p, double dt)
{
    const double share = dt / (dt + f->k.model->acoustic_damper * f->k.h / f->k.c0);
#pragma omp parallel for simd schedule(static) num_threads(f->threads)
    for (int64_t i = 0; i < p->n; i++) p->dens_slow[i] += share * (p->dens[i] - p->dens_slow[i]);
}

/* Marks the nine cells around a cell of walls or structures; returns whether any of them contains
 * fluid. */
static bool mark_around(struct fluid *f, const struct cells *c, int32_t cell)
{
    const int cx = cell_x(c, cell), cy = cell_y(c, cell);
    bool fluid = false;
    for (int y = cy - 1; y <= cy + 1; y++) {
        for (int x = cx - 1; x <= cx + 1; x++) {
            const int32_t other = cell_at(c, x, y);
            if (other < 0) continue;
            f->near_dummies[other] = true;
            fluid |= c->kind[KIND_FLUID].count[other] > 0;
        }
    }
    return fluid;
}

void fluid_find_near(struct fluid *f, const struct cells *c)
{
    memset(f->near_dummies, 0, (size_t)c->nx * (size_t)c->ny * sizeof *f->near_dummies);
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++) {
        const struct cell_list *list = &c->kind[kind];
        int32_t n = 0;
        for (int32_t k = 0; k < list->n_active; k++)
            if (mark_around(f, c, list->active[k]) || f->never_skip)
                f->near_fluid[kind][n++] = list->active[k];
        f->n_near_fluid[kind] = n;
    }
    f->walls_placed = false;
}

int32_t fluid_fullest_cell(const struct cells *c)
{
    int32_t most = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int32_t k = 0; k < c->kind[kind].n_active; k++)
            if (c->kind[kind].count[c->kind[kind].active[k]] > most)
                most = c->kind[kind].count[c->kind[kind].active[k]];
    return most;
}

static void pass_pack(struct fluid *f, struct particles kinds[KIND_COUNT], const struct cells *c)
{
    f->sweeps->packed(f, kinds, c);
}

static void pass_slope(struct fluid *f, struct particles kinds[KIND_COUNT], const struct cells *c)
{
    f->sweeps->slopes(f, kinds, c);
}

static void pass_wall(struct fluid *f, struct particles kinds[KIND_COUNT], const struct cells *c)
{
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++)
        if (f->n_near_fluid[kind]) f->sweeps->dummies(f, kinds, c, (enum kind)kind);
    f->walls_placed = !(f->effects & FX_MOTION) && !f->never_skip;
}

/* The fluid's rates, chunk by chunk. */
static void pass_fluid(struct fluid *f, struct particles kinds[KIND_COUNT], const struct cells *c)
{
    const int32_t n_active = c->kind[KIND_FLUID].n_active, chunks = fluid_chunk_count(n_active);
    double acceleration2 = 0, approach = 0;
#pragma omp parallel for schedule(static) num_threads(f->threads) \
    reduction(max                                                 \
              : acceleration2, approach)
    for (int32_t m = 0; m < chunks; m++) {
        const int32_t first = fluid_chunk_start(n_active, m),
                      end = fluid_chunk_start(n_active, m + 1);
        if (first == end) continue;
        struct fluid_extremes top = {acceleration2, approach};
        f->kernel->rates(f, &kinds[KIND_FLUID], c, first, end, &top);
        acceleration2 = top.acceleration2;
        approach = top.approach;
    }
    f->extremes = (struct fluid_extremes){acceleration2, approach};
}

/* The passes of an evaluation, in order; phase_table says which scenes have them. */
static const struct pass {
    enum phase phase;
    void (*run)(struct fluid *f, struct particles kinds[KIND_COUNT], const struct cells *c);
} passes[] = {
    {PHASE_packed, pass_pack},
    {PHASE_slope, pass_slope},
    {PHASE_wall, pass_wall},
    {PHASE_fluid, pass_fluid},
};

void fluid_evaluate(struct fluid *f, struct particles kinds[KIND_COUNT], const struct cells *c,
                    double phase_seconds[PHASE_COUNT])
{
    double since = wall_clock();
    for (size_t k = 0; k < COUNT_OF(passes); k++) {
        if (!phase_runs(passes[k].phase, f->effects)) continue;
        passes[k].run(f, kinds, c);
        const double now = wall_clock();
        phase_seconds[passes[k].phase] += now - since;
        since = now;
    }
}

void fluid_show(const struct fluid *f, struct particles *p)
{
    for (int64_t i = 0; i < p->n; i++) p->p[i] = eos_pressure(p->dens[i], f->k.rho0, f->k.c0);
}
