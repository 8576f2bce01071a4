/* SPDX-License-Identifier: MIT
 * The sweeps of the fluid, one text for both precisions: fluid_mixed.c and fluid_double.c define
 *   real, vreal, four_real, LANES, GROUPS, SWEEP(name), the verbs vset vfma vmin vmax vabs vsqrt vtop vfour
 *   vspread vsum_four
 * and include it. Four particles of a cell that lie close together, a cluster, look at the clusters near
 * them. Gather form: a particle sums its own neighbours and writes only itself, so that the bits do not
 * depend on the number of threads; and each lane of a group of four sums its own candidates, so that they
 * do not depend on how many groups a vector holds. */

#include <math.h>
#include <string.h>

#include "eos.h"
#include "fluid.h"
#include "smoothing.h"

#include "fluid_view.h"
/* After what they are written with. */
#include "fluid_fx.h"
#include "fluid_lanes.h"

#define ETA2 0.01           /* (eta/h)^2 */
#define REPULSION_REACH 0.8 /* r0 of fx_repulsion over the mean spacing of fluid and dummy */

static struct lane_constants constants_of_sweep(const struct fluid *f)
{
    const struct fluid_constants *const fk = &f->k;
    const double per_c2 = fk->h / square(fk->c0);
    return (struct lane_constants){
        .viscosity = vset((real)sqrt(2 * fk->alpha * fk->c0 * fk->rho0)),
        .laminar = vset((real)(2 * fk->nu * fk->rho0 / fk->h)),
        .tensile = vset((real)fk->tensile),
        .close = vset((real)(kernel_w(0, fk->h) / kernel_w(fk->dp, fk->h))),
        .repulsion = vset((real)(fk->repulsion * fk->rho0 * square(fk->c0))),
        .lowest = vset((real)fk->lowest_wall_pressure),
        .gx = vset((real)(fk->gravity[0] * per_c2)),
        .gy = vset((real)(fk->gravity[1] * per_c2)),
        .eta2 = vset((real)ETA2),
    };
}

/* The kernel without its factor alpha_D, at distances of q h. */
SPHFSI_INLINE vreal kernel_of(vreal q)
{
    const vreal t = vmax(vset(0), vfma(vset((real)-0.5), q, vset(1))), t2 = t * t;
    return t2 * t2 * vfma(vset(2), q, vset(1));
}

/* Whether there is fluid in reach of a dummy, by the sum of the kernel over it. */
SPHFSI_INLINE bool seen_at_all(real weight) { return (double)weight > 1e-12; }

#include "fluid_dummies.h"

/* Sums over the fluid that is seen; fx is a constant where the kernel is stamped. */
SPHFSI_INLINE void sum_fluid(const struct view *see, const struct receiver *a,
                             const struct lane_constants *k, unsigned fx, struct sums sums[PARTS])
{
    EACH_SEEN(see, m, part) {
        const uint32_t seen = see->seen[m];
        const real *const b = candidates(see, seen, part);
        struct sums *const s = &sums[part];
        struct pair q = pair_load(a, seen, b);
        q.p = lane(b, LANE_P);
        fx_continuity(&q, s);
        vreal stress = fx_pressure(a, &q), inv;
        if (fx & (FX_VISCOSITY | FX_DIFFUSION)) {
            q.dens = lane(b, LANE_DENS);
            if (fx & FX_ANTUONO) {
                q.slope_x = lane(b, LANE_SLOPE_X);
                q.slope_y = lane(b, LANE_SLOPE_Y);
            }
            vreal both;
            const vreal damping = pair_damping(a, &q, k, &both);
            inv = damping * both;
            if (fx & FX_VISCOSITY) stress = fx_viscosity(a, &q, damping, k, stress);
            if (fx & FX_DIFFUSION) fx_diffusion(a, &q, inv, k, fx, s);
        } else {
            inv = vset(1) / (q.r2 + k->eta2);
        }
        if (fx & FX_TENSILE) stress = stress + fx_tensile(a, &q, k);
        if (fx & FX_LAMINAR) {
            const vreal weight = fx_laminar(&q, inv, k);
            s->ax = s->ax - weight * q.u;
            s->ay = s->ay - weight * q.v;
        }
        if (fx & FX_SHIFTING) fx_crowd(&q, s);
        fx_approach(&q, inv, s);
        const vreal g = q.slope * stress;
        s->ax = vfma(g, q.x, s->ax);
        s->ay = vfma(g, q.y, s->ay);
    }
}

/* Sums over walls and structures: pressure and continuity, and laminar viscosity where the fluid sticks. */
SPHFSI_INLINE void sum_dummies(const struct view *see, const struct receiver *a,
                               const struct lane_constants *k, unsigned fx, struct sums sums[PARTS])
{
    EACH_SEEN(see, m, part) {
        const uint32_t seen = see->seen[m];
        const real *const b = candidates(see, seen, part);
        struct sums *const s = &sums[part];
        struct pair q = pair_load(a, seen, b);
        q.p = lane(b, LANE_P);
        fx_continuity(&q, s);
        const vreal inv = vset(1) / (q.r2 + k->eta2);
        if (fx & FX_NO_SLIP) {
            const vreal weight = lane(b, LANE_STICKS) * fx_laminar(&q, inv, k);
            s->ax = s->ax - weight * (a->u - lane(b, LANE_MIRROR_U));
            s->ay = s->ay - weight * (a->v - lane(b, LANE_MIRROR_V));
        }
        if (fx & FX_SHIFTING) fx_crowd(&q, s);
        fx_approach(&q, inv, s);
        vreal stress = fx_pressure(a, &q);
        if (fx & FX_ONE_SIDED)
            stress = a->p + fx_one_sided(a->p, a->dens, q.x, q.y, lane(b, LANE_LIFT_X),
                                         lane(b, LANE_LIFT_Y), k);
        if (fx & FX_REPULSION) stress = stress + fx_repulsion(lane(b, LANE_NEAR), inv, k);
        const vreal g = q.slope * stress;
        s->ax = vfma(g, q.x, s->ax);
        s->ay = vfma(g, q.y, s->ay);
    }
}

/* Joins the sums over the parts of clusters in the first. */
SPHFSI_INLINE void sums_join(struct sums s[PARTS])
{
    for (int part = 1; part < PARTS; part++) {
        s[0].ax = s[0].ax + s[part].ax;
        s[0].ay = s[0].ay + s[part].ay;
        s[0].rate = s[0].rate + s[part].rate;
        s[0].mixing = s[0].mixing + s[part].mixing;
        s[0].crowd_x = s[0].crowd_x + s[part].crowd_x;
        s[0].crowd_y = s[0].crowd_y + s[part].crowd_y;
        s[0].spread = s[0].spread + s[part].spread;
        s[0].approach = vmax(s[0].approach, s[part].approach);
    }
}

/* Writes the rates of `count` particles from i on: the factors that the sums lack. */
SPHFSI_INLINE void rates_store(const struct fluid_constants *k, struct particles *p, int32_t i,
                               int count, const struct sums *s, unsigned fx,
                               struct fluid_extremes *top)
{
    real sum_x[GROUPS], sum_y[GROUPS], rate[GROUPS], mixing[GROUPS] = {0};
    vsum_four(s->ax, sum_x);
    vsum_four(s->ay, sum_y);
    vsum_four(s->rate, rate);
    if (fx & FX_DIFFUSION) vsum_four(s->mixing, mixing);
    const double slope = PAIR_SLOPE / k->h, mix = 2 * k->delta * k->c0;
    double ax[GROUPS], ay[GROUPS], ddens[GROUPS];
    for (int g = 0; g < count; g++) {
        const double full = 1 + p->dens[i + g], per_mass = slope / (k->rho0 * full);
        ax[g] = per_mass * (double)sum_x[g] + k->gravity[0];
        ay[g] = per_mass * (double)sum_y[g] + k->gravity[1];
        ddens[g] = -slope * (full * (double)rate[g] + mix * (double)mixing[g]);
    }
    double highest = top->acceleration2;
    for (int g = 0; g < count; g++) {
        p->ax[i + g] = ax[g];
        p->ay[i + g] = ay[g];
        p->ddens[i + g] = ddens[g];
        highest = max2(highest, ax[g] * ax[g] + ay[g] * ay[g]);
    }
    top->acceleration2 = highest;
}

SPHFSI_INLINE void crowd_store(const struct fluid_constants *k, struct particles *p, int32_t i,
                               int count, const struct sums *s)
{
    real x[GROUPS], y[GROUPS], spread[GROUPS];
    vsum_four(s->crowd_x, x);
    vsum_four(s->crowd_y, y);
    vsum_four(s->spread, spread);
    for (int g = 0; g < count; g++) {
        p->crowd_x[i + g] = -PAIR_SLOPE / k->h * (double)x[g];
        p->crowd_y[i + g] = -PAIR_SLOPE / k->h * (double)y[g];
        p->spread[i + g] = PAIR_SLOPE * (double)spread[g];
    }
}

/* Receivers of the fluid from their lanes on. */
SPHFSI_INLINE struct receiver fluid_at(const struct cell_sides *sides, const real *own,
                                       const struct lane_constants *k, unsigned fx)
{
    struct receiver a = receiver_at(sides, own);
    a.u = vspread(own + LANE_U * CLUSTER);
    a.v = vspread(own + LANE_V * CLUSTER);
    a.p = vspread(own + LANE_P * CLUSTER);
    a.dens = vspread(own + LANE_DENS * CLUSTER);
    if (fx & FX_VISCOSITY) a.viscous = -vfma(k->viscosity, a.dens, k->viscosity);
    if (fx & FX_ANTUONO) {
        a.slope_x = vspread(own + LANE_SLOPE_X * CLUSTER);
        a.slope_y = vspread(own + LANE_SLOPE_Y * CLUSTER);
    }
    return a;
}

/* A cluster of `count` particles from i on. */
SPHFSI_INLINE void rates_of_cluster(const struct fluid *f, struct particles *p, int32_t i,
                                    int count, const real *own, const struct view see[KIND_COUNT],
                                    const struct cell_sides *sides, const struct lane_constants *k,
                                    unsigned fx, vreal *approach, struct fluid_extremes *top)
{
    for (int r = 0; r < count; r += GROUPS) {
        const struct receiver a = fluid_at(sides, own + r, k, fx);
        const int here = count - r < GROUPS ? count - r : GROUPS;
        struct sums s[PARTS] = {{.approach = *approach}};
        sum_fluid(&see[KIND_FLUID], &a, k, fx, s);
        for (int kind = KIND_WALL; kind < KIND_COUNT; kind++)
            if (see[kind].n) sum_dummies(&see[kind], &a, k, fx, s);
        sums_join(s);
        *approach = s[0].approach;
        if (here == GROUPS) /* a number that the compiler knows */
            rates_store(&f->k, p, i + r, GROUPS, s, fx, top);
        else
            rates_store(&f->k, p, i + r, here, s, fx, top);
        if (fx & FX_SHIFTING) crowd_store(&f->k, p, i + r, here, s);
    }
}

SPHFSI_INLINE void rates_of_cell(const struct fluid *f, struct particles *p, const struct cells *c,
                                 int32_t cell, const struct lane_constants *k, unsigned fx,
                                 vreal *approach, struct fluid_extremes *top)
{
    const struct cell_list *const list = &c->kind[KIND_FLUID];
    struct sight *const sight = &f->sight[thread_index()];
    const struct cell_sides sides = cell_sides_of(f, c);
    bool around[KIND_COUNT];
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        around[kind] = kind == KIND_FLUID || (f->near_dummies[cell] && f->n_near_fluid[kind]);
        if (around[kind]) look_around(sight, f, c, (enum kind)kind, cell);
    }
    for (int32_t m = 0; m < clusters_in(list, cell); m++) {
        const int32_t cluster = list->cluster[cell] + m;
        struct view see[KIND_COUNT];
        for (int kind = 0; kind < KIND_COUNT; kind++)
            see[kind] = around[kind] ? look_at(sight, f, (enum kind)kind, KIND_FLUID, cluster)
                                     : (struct view){.n = 0};
        rates_of_cluster(f, p, list->start[cell] + m * CLUSTER, particles_in(list, cell, m),
                         cluster_lanes(&f->lanes[KIND_FLUID], (size_t)cluster), see, &sides, k, fx,
                         approach, top);
    }
}

/* Cells that a thread takes at once. */
enum { CELLS_AT_ONCE = 4 };

/* A share of the active cells. Stamped outside of any parallel region: the compiler turns the body of a
 * region into a function of its own before it can see that fx is a constant. */
typedef void SWEEP(share)(const struct fluid *f, struct particles *p, const struct cells *c,
                          int32_t first, int32_t end, const struct lane_constants *k,
                          struct fluid_extremes *top);

#define VARIANT(variant, set)                                                                      \
    static void SWEEP(share_##variant)(const struct fluid *f, struct particles *p,                 \
                                       const struct cells *c, int32_t first, int32_t end,          \
                                       const struct lane_constants *k, struct fluid_extremes *top) \
    {                                                                                              \
        const struct lane_constants constants = *k;                                                \
        vreal approach = vset(0); /* over all receivers: the lanes are searched once a share */    \
        for (int32_t m = first; m < end; m++)                                                      \
            rates_of_cell(f, p, c, c->kind[KIND_FLUID].active[m], &constants, (set), &approach,    \
                          top);                                                                    \
        top->approach = max2(top->approach, (double)vtop(approach));                               \
    }
#include "variants.def"
VARIANT(any, f->effects &PAIR_EFFECTS)
#undef VARIANT

static void all_shares(struct fluid *f, struct particles kinds[KIND_COUNT], const struct cells *c,
                       SWEEP(share) * share)
{
    const int32_t n_active = c->kind[KIND_FLUID].n_active;
    const int32_t shares = (n_active + CELLS_AT_ONCE - 1) / CELLS_AT_ONCE;
    const struct lane_constants k = constants_of_sweep(f);
    double acceleration2 = 0, approach = 0;
#pragma omp parallel for schedule(static) num_threads(f->threads) \
    reduction(max                                                 \
              : acceleration2, approach)
    for (int32_t m = 0; m < shares; m++) {
        const int32_t first = m * CELLS_AT_ONCE;
        const int32_t end = first + CELLS_AT_ONCE < n_active ? first + CELLS_AT_ONCE : n_active;
        struct fluid_extremes top = {acceleration2, approach};
        share(f, &kinds[KIND_FLUID], c, first, end, &k, &top);
        acceleration2 = top.acceleration2;
        approach = top.approach;
    }
    f->extremes = (struct fluid_extremes){acceleration2, approach};
}

#define VARIANT(variant, set)                                                                \
    static void SWEEP(rates_##variant)(struct fluid * f, struct particles kinds[KIND_COUNT], \
                                       const struct cells *c)                                \
    {                                                                                        \
        all_shares(f, kinds, c, SWEEP(share_##variant));                                     \
    }
#include "variants.def"
VARIANT(any, ANY_EFFECTS)
#undef VARIANT

#define SWEEPS_ROW(variant, set)                                                         \
    {                                                                                    \
#variant " (" SWEEP_LABEL ")", (set), sizeof(real), SWEEP(lanes), SWEEP(slopes), \
            SWEEP(dummies), SWEEP(rates_##variant)                                       \
    }

/* The generic kernel stands last. */
const struct fluid_sweeps SWEEP(fluid_sweeps)[] = {
#define VARIANT(variant, set) SWEEPS_ROW(variant, set),
#include "variants.def"
#undef VARIANT
    SWEEPS_ROW(any, ANY_EFFECTS),
};
