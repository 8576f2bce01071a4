/* SPDX-License-Identifier: MIT
 * The sweeps of the fluid, one text for both precisions: fluid_mixed.c and fluid_double.c define
 *   real, vreal, LANES, SWEEP(name), the verbs vload vstore vset vfma vmin vmax vabs vsqrt vsum vtop
 * and include it. Particles of a cell or two sweep a tile: the candidates of the cells around, copied
 * together so that full vectors can be loaded from it. Gather form: a particle sums its own neighbours
 * and writes only itself, so that the bits do not depend on the number of threads. */

#include <math.h>
#include <string.h>

#include "eos.h"
#include "fluid.h"
#include "smoothing.h"

#include "fluid_fx.h"
#include "fluid_tile.h"
/* After what it is written with. */
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

/* Eq. 19 in the form of Adami et al. 2012, Eq. 27: pressure of a wall or solid particle at (x, y),
 * with acceleration (ax, ay), from the fluid in the tile; 0 where no fluid is in reach. */
static double extrapolated_pressure(const struct fluid *f, const struct SWEEP(tile) * tile, real x,
                                    real y, double ax, double ay)
{
    vreal sum_w = vset(0), sum_p = vset(0), sum_x = vset(0), sum_y = vset(0);
    for (int j = 0; j < tile->n; j += LANES) {
        const vreal dx = vset(x) - vload(&tile->field[LANE_X][j]);
        const vreal dy = vset(y) - vload(&tile->field[LANE_Y][j]);
        const vreal q = vsqrt(vfma(dy, dy, dx * dx));
        const vreal t = vmax(vset(0), vfma(vset((real)-0.5), q, vset(1)));
        const vreal t2 = t * t, w = t2 * t2 * vfma(vset(2), q, vset(1));
        const vreal mass = w * (vset(1) + vload(&tile->field[LANE_DENS][j]));
        sum_w = sum_w + w;
        sum_p = vfma(w, vload(&tile->field[LANE_P][j]), sum_p);
        sum_x = vfma(mass, dx, sum_x);
        sum_y = vfma(mass, dy, sum_y);
    }
    const double weight = (double)vsum(sum_w);
    if (!(weight > 1e-12)) return 0;
    const double lift =
        (f->k.gravity[0] - ax) * (double)vsum(sum_x) + (f->k.gravity[1] - ay) * (double)vsum(sum_y);
    const double pressure = ((double)vsum(sum_p) + f->k.rho0 * f->k.h * lift) / weight;
    /* A particle alone on a wall meets nothing but its own pressure; pulled as well as pushed, its
     * bouncing grew on the gate's bed (dp = 1 mm) to 20 % of density and a third of c0. */
    return max2(f->k.lowest_wall_pressure, pressure);
}

/* Adami et al. 2012, Eqs. 22 and 23: twice the velocity (u, v) of a wall or solid particle less the
 * mean of the fluid's around it, so that between them the fluid moves with the surface. */
static void mirrored_velocity(const struct SWEEP(tile) * tile, real x, real y, double *u, double *v)
{
    vreal sum_w = vset(0), sum_u = vset(0), sum_v = vset(0);
    for (int j = 0; j < tile->n; j += LANES) {
        const vreal dx = vset(x) - vload(&tile->field[LANE_X][j]);
        const vreal dy = vset(y) - vload(&tile->field[LANE_Y][j]);
        const vreal q = vsqrt(vfma(dy, dy, dx * dx));
        const vreal t = vmax(vset(0), vfma(vset((real)-0.5), q, vset(1)));
        const vreal t2 = t * t, w = t2 * t2 * vfma(vset(2), q, vset(1));
        sum_w = sum_w + w;
        sum_u = vfma(w, vload(&tile->field[LANE_U][j]), sum_u);
        sum_v = vfma(w, vload(&tile->field[LANE_V][j]), sum_v);
    }
    const double weight = (double)vsum(sum_w);
    if (!(weight > 1e-12)) return;
    *u = 2 * *u - (double)vsum(sum_u) / weight;
    *v = 2 * *v - (double)vsum(sum_v) / weight;
}

/* The mirror image of what sum_dummies adds to the fluid by laminar viscosity, as in fluid_force; s has
 * the mirrored velocity. */
static void drag_force(const struct fluid *f, const struct SWEEP(tile) * tile,
                       const struct receiver *s, double volume, const struct lane_constants *k,
                       double force[2])
{
    vreal sum_x = vset(0), sum_y = vset(0);
    for (int j = 0; j < tile->n; j += LANES) {
        const struct pair q =
            pair_load(s, &tile->field[LANE_X][j], &tile->field[LANE_Y][j], &tile->field[LANE_U][j],
                      &tile->field[LANE_V][j], &tile->field[LANE_VOLUME][j]);
        const vreal weight = fx_laminar(&q, vset(1) / (q.r2 + k->eta2), k);
        sum_x = vfma(weight, q.u, sum_x);
        sum_y = vfma(weight, q.v, sum_y);
    }
    const double scale = PAIR_SLOPE * f->k.h * volume;
    force[0] -= scale * (double)vsum(sum_x);
    force[1] -= scale * (double)vsum(sum_y);
}

/* What a dummy's forces take beyond its pressure, each where it is called for. */
struct SWEEP(surface) {
    real lift[2]; /* rho0 h (g - a), of fx_one_sided */
    real near;    /* of fx_repulsion */
};

/* Eq. 21b: force of the fluid in the tile on a solid particle, V_s sum of V_f (P_s + P_f) grad W with
 * the sign reversed; N/m per depth. The mirror image of what the fluid particles sum. */
SPHFSI_INLINE void fluid_force(const struct fluid *f, const struct SWEEP(tile) * tile,
                               const struct receiver *s, const struct SWEEP(surface) * own,
                               double volume, const struct lane_constants *k, unsigned fx,
                               double force[2])
{
    vreal sum_x = vset(0), sum_y = vset(0);
    for (int j = 0; j < tile->n; j += LANES) {
        struct pair q =
            pair_load(s, &tile->field[LANE_X][j], &tile->field[LANE_Y][j], &tile->field[LANE_U][j],
                      &tile->field[LANE_V][j], &tile->field[LANE_VOLUME][j]);
        q.p = vload(&tile->field[LANE_P][j]);
        vreal stress = fx_pressure(s, &q);
        if (fx & FX_ONE_SIDED)
            stress = q.p + fx_one_sided(q.p, vload(&tile->field[LANE_DENS][j]), -q.x, -q.y,
                                        vset(own->lift[0]), vset(own->lift[1]), k);
        if (fx & FX_REPULSION)
            stress = stress + fx_repulsion(vset(own->near), vset(1) / (q.r2 + k->eta2), k);
        const vreal g = q.slope * stress;
        sum_x = vfma(g, q.x, sum_x);
        sum_y = vfma(g, q.y, sum_y);
    }
    const double scale = PAIR_SLOPE * f->k.h * volume;
    force[0] = scale * (double)vsum(sum_x);
    force[1] = scale * (double)vsum(sum_y);
}

/* The surface per depth, m, on which a pressure of 1 Pa on both sides of the pair would press. */
static void wetted_surface(const struct fluid *f, const struct SWEEP(tile) * tile,
                           const struct receiver *s, double volume, double surface[2])
{
    vreal sum_x = vset(0), sum_y = vset(0);
    for (int j = 0; j < tile->n; j += LANES) {
        const struct pair q =
            pair_load(s, &tile->field[LANE_X][j], &tile->field[LANE_Y][j], &tile->field[LANE_U][j],
                      &tile->field[LANE_V][j], &tile->field[LANE_VOLUME][j]);
        sum_x = vfma(q.slope, q.x, sum_x);
        sum_y = vfma(q.slope, q.y, sum_y);
    }
    const double scale = 2 * PAIR_SLOPE * f->k.h * volume;
    surface[0] = scale * (double)vsum(sum_x);
    surface[1] = scale * (double)vsum(sum_y);
}

/* Effects that walls and structures have code of their own for: without them it is stamped out. */
#define SURFACE_EFFECTS (FX_NO_SLIP | FX_ONE_SIDED | FX_REPULSION | FX_IMPEDANCE)

/* One wall or solid particle i at place `place` of the cell order. */
SPHFSI_INLINE void dummy_update(const struct fluid *f, struct particles *p, enum kind kind,
                                int32_t place, int32_t i, const struct cells *c, int32_t cell,
                                const struct SWEEP(tile) * tile, const struct SWEEP(box) * box,
                                const struct lane_constants *k, unsigned fx)
{
    const bool grips = fx & FX_NO_SLIP;
    const double inv_h = 1 / f->k.h;
    const double from_centre_x = cells_short_way(c, 0, p->x[i] - cell_centre_x(c, cell));
    const double from_centre_y = cells_short_way(c, 1, p->y[i] - cell_centre_y(c, cell));
    const bool solid = kind == KIND_SOLID;
    const double *const u = solid ? p->wx : p->vx, *const v = solid ? p->wy : p->vy;
    real *const *const out = (real *const *)(const void *)f->lanes[kind].field;
    const real x = (real)(from_centre_x * inv_h), y = (real)(from_centre_y * inv_h);
    const bool alone = !f->idle_is_work && out_of_reach(box, x, y);
    p->p[i] =
        alone ? 0
              : extrapolated_pressure(f, tile, x, y, p->ax ? p->ax[i] : 0, p->ax ? p->ay[i] : 0);
    p->dens[i] = alone ? 0 : eos_dens(p->p[i], f->k.rho0, f->k.c0);
    out[LANE_X][place] = x;
    out[LANE_Y][place] = y;
    out[LANE_U][place] = (real)u[i];
    out[LANE_V][place] = (real)v[i];
    /* Eqs. 19-21 with the volume of each dummy itself: a solid may be finer than the fluid. */
    const double volume = f->k.mass / f->k.rho0 * square(inv_h) * f->volume[kind][p->body[i]];
    out[LANE_VOLUME][place] = (real)(volume / (1 + p->dens[i]));
    out[LANE_P][place] = (real)p->p[i];
    out[LANE_DENS][place] = (real)p->dens[i];
    const bool sticks = grips && f->sticks[kind][p->body[i]] && !alone;
    struct receiver s = {.x = vset(x), .y = vset(y), .p = vset(out[LANE_P][place])};
    if (grips) {
        double mirror_u = u[i], mirror_v = v[i];
        if (sticks) mirrored_velocity(tile, x, y, &mirror_u, &mirror_v);
        out[LANE_MIRROR_U][place] = (real)mirror_u;
        out[LANE_MIRROR_V][place] = (real)mirror_v;
        out[LANE_STICKS][place] = sticks;
        s.u = vset((real)mirror_u);
        s.v = vset((real)mirror_v);
    }
    struct SWEEP(surface) own = {{0, 0}, 0};
    if (fx & FX_ONE_SIDED) {
        const double a[2] = {p->ax ? p->ax[i] : 0, p->ay ? p->ay[i] : 0};
        for (int axis = 0; axis < 2; axis++) {
            own.lift[axis] = (real)(f->k.rho0 * f->k.h * (f->k.gravity[axis] - a[axis]));
            out[LANE_LIFT_X + axis][place] = own.lift[axis];
        }
    }
    if (fx & FX_REPULSION) {
        const double spacing = 0.5 * (1 + sqrt(f->volume[kind][p->body[i]])) * f->k.dp;
        own.near = (real)(square(REPULSION_REACH * spacing * inv_h) + ETA2);
        out[LANE_NEAR][place] = own.near;
    }
    if (!p->fx) return;
    double force[2] = {0, 0};
    if (!alone) fluid_force(f, tile, &s, &own, (double)out[LANE_VOLUME][place], k, fx, force);
    if (sticks) drag_force(f, tile, &s, (double)out[LANE_VOLUME][place], k, force);
    p->fx[i] = force[0];
    p->fy[i] = force[1];
    if (!p->wet_x || !(fx & FX_IMPEDANCE)) return;
    if (!alone) wetted_surface(f, tile, &s, (double)out[LANE_VOLUME][place], force);
    p->wet_x[i] = force[0];
    p->wet_y[i] = force[1];
}

SPHFSI_INLINE void dummies_of_cell(const struct fluid *f, struct particles *p, enum kind kind,
                                   const struct cells *c, int32_t cell, unsigned fx)
{
    const struct cell_list *list = &c->kind[kind];
    struct SWEEP(tile) *const tile = thread_tile(f, 0);
    tile->fields = f->lanes[KIND_FLUID].n;
    const struct SWEEP(box) box = box_of_tile(tile, tile_around(tile, f, c, KIND_FLUID, cell));
    const struct lane_constants k =
        fx & SURFACE_EFFECTS ? constants_of_sweep(f) : (struct lane_constants){0};
    for (int32_t j = list->start[cell]; j < list->start[cell] + list->count[cell]; j++)
        dummy_update(f, p, kind, j, list->order[j], c, cell, tile, &box, &k, fx);
}

static void SWEEP(dummies)(const struct fluid *f, struct particles kinds[KIND_COUNT],
                           const struct cells *c, enum kind kind)
{
#pragma omp parallel for schedule(dynamic, 8) num_threads(f->threads)
    for (int32_t k = 0; k < f->n_near_fluid[kind]; k++) {
        const int32_t cell = f->near_fluid[kind][k];
        if (f->effects & SURFACE_EFFECTS)
            dummies_of_cell(f, &kinds[kind], kind, c, cell, f->effects);
        else
            dummies_of_cell(f, &kinds[kind], kind, c, cell, 0);
    }
}

/* Sums over the fluid in a range of the tile; fx is a constant where the kernel is stamped. */
SPHFSI_INLINE void sum_fluid(const struct SWEEP(tile) * tile, const struct SWEEP(range) * range,
                             const struct receiver *a, const struct lane_constants *k, unsigned fx,
                             struct sums *s)
{
    vreal before = s->approach;
    for (int j = range->first; j < range->end; j += LANES) {
        before = s->approach;
        struct pair q =
            pair_load(a, &tile->field[LANE_X][j], &tile->field[LANE_Y][j], &tile->field[LANE_U][j],
                      &tile->field[LANE_V][j], &tile->field[LANE_VOLUME][j]);
        q.p = vload(&tile->field[LANE_P][j]);
        fx_continuity(&q, s);
        vreal stress = fx_pressure(a, &q), inv;
        if (fx & (FX_VISCOSITY | FX_DIFFUSION)) {
            q.dens = vload(&tile->field[LANE_DENS][j]);
            if (fx & FX_ANTUONO) {
                q.slope_x = vload(&tile->field[LANE_SLOPE_X][j]);
                q.slope_y = vload(&tile->field[LANE_SLOPE_Y][j]);
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
    s->approach = vmax(s->approach * range->used, before);
}

/* Sums over walls and structures: pressure and continuity, and laminar viscosity where the fluid sticks. */
SPHFSI_INLINE void sum_dummies(const struct SWEEP(tile) * tile, const struct SWEEP(range) * range,
                               const struct receiver *a, const struct lane_constants *k,
                               unsigned fx, struct sums *s)
{
    vreal before = s->approach;
    for (int j = range->first; j < range->end; j += LANES) {
        before = s->approach;
        struct pair q =
            pair_load(a, &tile->field[LANE_X][j], &tile->field[LANE_Y][j], &tile->field[LANE_U][j],
                      &tile->field[LANE_V][j], &tile->field[LANE_VOLUME][j]);
        q.p = vload(&tile->field[LANE_P][j]);
        fx_continuity(&q, s);
        const vreal inv = vset(1) / (q.r2 + k->eta2);
        if (fx & FX_NO_SLIP) {
            const vreal weight = vload(&tile->field[LANE_STICKS][j]) * fx_laminar(&q, inv, k);
            s->ax = s->ax - weight * (a->u - vload(&tile->field[LANE_MIRROR_U][j]));
            s->ay = s->ay - weight * (a->v - vload(&tile->field[LANE_MIRROR_V][j]));
        }
        if (fx & FX_SHIFTING) fx_crowd(&q, s);
        fx_approach(&q, inv, s);
        vreal stress = fx_pressure(a, &q);
        if (fx & FX_ONE_SIDED)
            stress =
                a->p + fx_one_sided(a->p, a->dens, q.x, q.y, vload(&tile->field[LANE_LIFT_X][j]),
                                    vload(&tile->field[LANE_LIFT_Y][j]), k);
        if (fx & FX_REPULSION)
            stress = stress + fx_repulsion(vload(&tile->field[LANE_NEAR][j]), inv, k);
        const vreal g = q.slope * stress;
        s->ax = vfma(g, q.x, s->ax);
        s->ay = vfma(g, q.y, s->ay);
    }
    s->approach = vmax(s->approach * range->used, before);
}

/* The factors that the sums lack. */
SPHFSI_INLINE void rates_store(const struct fluid_constants *k, struct particles *p, int32_t i,
                               const struct sums *s, struct fluid_extremes *top)
{
    const double dens = p->dens[i], slope = PAIR_SLOPE / k->h;
    const double ax = slope / (k->rho0 * (1 + dens)) * (double)vsum(s->ax) + k->gravity[0];
    const double ay = slope / (k->rho0 * (1 + dens)) * (double)vsum(s->ay) + k->gravity[1];
    p->ax[i] = ax;
    p->ay[i] = ay;
    p->ddens[i] = -slope * (1 + dens) * (double)vsum(s->rate);
    top->acceleration2 = max2(top->acceleration2, ax * ax + ay * ay);
}

SPHFSI_INLINE void crowd_store(const struct fluid_constants *k, struct particles *p, int32_t i,
                               const struct sums *s)
{
    p->crowd_x[i] = -PAIR_SLOPE / k->h * (double)vsum(s->crowd_x);
    p->crowd_y[i] = -PAIR_SLOPE / k->h * (double)vsum(s->crowd_y);
    p->spread[i] = PAIR_SLOPE * (double)vsum(s->spread);
}

/* What the particles of a cell have to sum over: ranges of tiles whose centre lies `left` of the cell's, in
 * units of h. */
struct SWEEP(near) {
    const struct SWEEP(tile) * fluid, *dummies;
    struct SWEEP(range) in_fluid, in_dummies;
    real left;
};

SPHFSI_INLINE void rates_of_cell(const struct fluid *f, struct particles *p,
                                 const struct cell_list *list, int32_t cell,
                                 const struct SWEEP(near) * near, const struct lane_constants *k,
                                 unsigned fx, vreal *approach, struct fluid_extremes *top)
{
    const real *const *const own = (const real *const *)(const void *)f->lanes[KIND_FLUID].field;
    for (int32_t i = list->start[cell]; i < list->start[cell] + list->count[cell]; i++) {
        struct receiver a = {.x = vset(own[LANE_X][i] + near->left),
                             .y = vset(own[LANE_Y][i]),
                             .u = vset(own[LANE_U][i]),
                             .v = vset(own[LANE_V][i]),
                             .p = vset(own[LANE_P][i]),
                             .dens = vset(own[LANE_DENS][i])};
        if (fx & FX_VISCOSITY) a.viscous = -vfma(k->viscosity, a.dens, k->viscosity);
        if (fx & FX_ANTUONO) {
            a.slope_x = vset(own[LANE_SLOPE_X][i]);
            a.slope_y = vset(own[LANE_SLOPE_Y][i]);
        }
        struct sums s = {.approach = *approach};
        sum_fluid(near->fluid, &near->in_fluid, &a, k, fx, &s);
        sum_dummies(near->dummies, &near->in_dummies, &a, k, fx, &s);
        *approach = s.approach;
        if (fx & FX_DIFFUSION)
            s.rate =
                vfma(vset((real)(2 * f->k.delta * f->k.c0 / (1 + p->dens[i]))), s.mixing, s.rate);
        rates_store(&f->k, p, i, &s, top);
        if (fx & FX_SHIFTING) crowd_store(&f->k, p, i, &s);
    }
}

/* Cells side by side share tiles: two of them take four columns instead of six, and each sums over three. */
SPHFSI_INLINE void rates_of_strip(const struct fluid *f, struct particles *p, const struct cells *c,
                                  int32_t cell, int n_cells, const struct lane_constants *k,
                                  unsigned fx, vreal *approach, struct fluid_extremes *top)
{
    struct SWEEP(tile) *const tile = thread_tile(f, 0), *const dummies = thread_tile(f, 1);
    const struct SWEEP(place) place = place_of(f, c, cell);
    tile->fields = f->lanes[KIND_FLUID].n;
    dummies->fields = f->lanes[KIND_WALL].n;
    int from[STRIP_CELLS + 3] = {0}, dummies_from[STRIP_CELLS + 3] = {0};
    bool near_dummies = false;
    for (int m = 0; m < n_cells; m++) near_dummies |= f->near_dummies[cell + m];
    for (int d = 0; d < n_cells + 2; d++) {
        from[d + 1] = tile_column(tile, from[d], f, c, KIND_FLUID, &place, d - 1);
        dummies_from[d + 1] = dummies_from[d];
        for (int kind = KIND_WALL; near_dummies && kind < KIND_COUNT; kind++)
            if (f->n_near_fluid[kind])
                dummies_from[d + 1] =
                    tile_column(dummies, dummies_from[d + 1], f, c, (enum kind)kind, &place, d - 1);
    }
    tile_close(tile, from[n_cells + 2]);
    tile_close(dummies, dummies_from[n_cells + 2]);
    for (int m = 0; m < n_cells; m++) {
        const struct SWEEP(near)
            near = {.fluid = tile,
                    .dummies = dummies,
                    .in_fluid = range_of(from[m], from[m + 3]),
                    .in_dummies = range_of(dummies_from[m], dummies_from[m + 3]),
                    .left = (real)m * place.side_x};
        rates_of_cell(f, p, &c->kind[KIND_FLUID], cell + m, &near, k, fx, approach, top);
    }
}

/* How many of the active cells from the m-th to before the end lie side by side. */
static int strip_cells(const struct cells *c, int32_t m, int32_t end)
{
    const int32_t *const active = c->kind[KIND_FLUID].active;
    int n = 1;
    while (n < STRIP_CELLS && m + n < end && active[m + n] == active[m] + n &&
           cell_x(c, active[m + n]) > 0)
        n++;
    return n;
}

/* Cells that a thread takes at once. */
enum { CELLS_AT_ONCE = 16 };

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
        for (int32_t m = first, n; m < end; m += n) {                                              \
            n = strip_cells(c, m, end);                                                            \
            rates_of_strip(f, p, c, c->kind[KIND_FLUID].active[m], n, &constants, (set),           \
                           &approach, top);                                                        \
        }                                                                                          \
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

#define SWEEPS_ROW(variant, set)                                                                   \
    {                                                                                              \
#variant " (" SWEEP_LABEL ")", (set), sizeof(real), sizeof(struct SWEEP(tile)),            \
            sizeof *((struct SWEEP(tile) *)0)->field, SWEEP(lanes), SWEEP(slopes), SWEEP(dummies), \
            SWEEP(rates_##variant)                                                                 \
    }

/* The generic kernel stands last. */
const struct fluid_sweeps SWEEP(fluid_sweeps)[] = {
#define VARIANT(variant, set) SWEEPS_ROW(variant, set),
#include "variants.def"
#undef VARIANT
    SWEEPS_ROW(any, ANY_EFFECTS),
};
