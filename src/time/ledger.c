/* SPDX-License-Identifier: MIT */
#include "time/ledger.h"

#include <math.h>
#include <string.h>

#include "fluid/eos.h"
#include "time/evaluation.h"

/* Sums over the fluid in groups of eight, so that their order is the same on every machine. */
enum { ABREAST = 8 };
struct fluid_sums {
    double speed2[ABREAST], height[ABREAST], energy[ABREAST];
    double vx[ABREAST], vy[ABREAST], mass[ABREAST], extreme[ABREAST];
};

SPHFSI_INLINE void sum_particle(struct fluid_sums *s, int r, const struct particles *p, int64_t i,
                                const struct fluid_constants *k, const double g[2])
{
    const double vx = p->vx[i], vy = p->vy[i], dens = p->dens[i], m = p->m ? p->m[i] : 1;
    s->speed2[r] += m * (square(vx) + square(vy));
    s->height[r] -= m * (g[0] * p->x[i] + g[1] * p->y[i]);
    s->energy[r] += m * eos_energy(dens, k->c0);
    s->vx[r] += m * vx;
    s->vy[r] += m * vy;
    s->mass[r] += m;
    s->extreme[r] = max2(s->extreme[r], fabs(dens));
}

static void add_fluid(const struct simulation *s, struct ledger *row)
{
    const struct particles *const p = &s->kind[KIND_FLUID];
    const struct fluid_constants *const k = &s->fluid.k;
    const double g[2] = {s->scene->top.gravity[0], s->scene->top.gravity[1]};
    struct fluid_sums sums;
    memset(&sums, 0, sizeof sums);
    int64_t i = 0;
    for (; i + ABREAST <= p->n; i += ABREAST)
#pragma omp simd
        for (int r = 0; r < ABREAST; r++) sum_particle(&sums, r, p, i + r, k, g);
    for (; i < p->n; i++) sum_particle(&sums, 0, p, i, k, g);
    double mass = 0;
    for (int r = 0; r < ABREAST; r++) {
        row->kinetic += 0.5 * k->mass * sums.speed2[r];
        row->potential += k->mass * sums.height[r];
        row->internal += k->mass * sums.energy[r];
        row->momentum_x += k->mass * sums.vx[r];
        row->momentum_y += k->mass * sums.vy[r];
        mass += sums.mass[r];
        row->dens_extreme = max2(row->dens_extreme, sums.extreme[r]);
    }
    row->mass += k->mass * mass;
}

static void add_solid(const struct simulation *s, struct ledger *row)
{
    const struct particles *const p = &s->kind[KIND_SOLID];
    for (int64_t i = 0; i < p->n; i++) {
        const struct solid_body *const b = &s->solid.body[p->body[i]];
        row->kinetic += 0.5 * b->mass * (square(p->vx[i]) + square(p->vy[i]));
        row->potential -= b->mass * (b->gravity[0] * p->x[i] + b->gravity[1] * p->y[i]);
        row->momentum_x += b->mass * p->vx[i];
        row->momentum_y += b->mass * p->vy[i];
        row->mass += b->mass;
        if (!p->interface_impulse_x) continue; /* the fluid has not received that yet (T-35b) */
        row->momentum_x -= p->interface_impulse_x[i];
        row->momentum_y -= p->interface_impulse_y[i];
    }
    solid_energy(&s->solid, p, SOLID_ALL, &row->elastic, &row->hourglass, &row->det_low);
}

struct ledger simulation_ledger(struct simulation *s)
{
    simulation_refresh(s);
    struct ledger row = {.time = s->state.time, .det_low = 1, .dt = s->state.dt};
    if (s->effects & FX_FLUID) add_fluid(s, &row);
    if (s->effects & FX_SOLID) add_solid(s, &row);
    if (s->effects & FX_CONTACT)
        row.contact = contact_energy(&s->contact, &s->kind[KIND_SOLID], s->state.time);
    row.dissipated = s->state.energy_start + s->state.wall_work + s->state.periodic_energy +
                     open_energy(&s->open) - s->state.lost_energy - row.kinetic - row.potential -
                     row.internal - row.elastic - row.hourglass - row.contact;
    return row;
}
