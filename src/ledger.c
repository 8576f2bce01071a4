/* SPDX-License-Identifier: MIT */
#include "ledger.h"

#include <math.h>

#include "eos.h"
#include "simulation.h"

static void add_fluid(const struct simulation *s, struct ledger *row)
{
    const struct particles *const p = &s->kind[KIND_FLUID];
    const struct fluid_constants *const k = &s->fluid.k;
    for (int64_t i = 0; i < p->n; i++) {
        row->kinetic += 0.5 * k->mass * (square(p->vx[i]) + square(p->vy[i]));
        row->potential -= k->mass * (k->gravity[0] * p->x[i] + k->gravity[1] * p->y[i]);
        row->internal += k->mass * eos_energy(p->dens[i], k->c0);
        row->momentum_x += k->mass * p->vx[i];
        row->momentum_y += k->mass * p->vy[i];
        row->dens_extreme = max2(row->dens_extreme, fabs(p->dens[i]));
    }
    row->mass += k->mass * (double)p->n;
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
        if (!p->owed_x) continue; /* the fluid has not got that yet (T-35b) */
        row->momentum_x -= p->owed_x[i];
        row->momentum_y -= p->owed_y[i];
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
    row.dissipated = s->state.energy_start + s->state.wall_work + s->state.carried -
                     s->state.lost_energy - row.kinetic - row.potential - row.internal -
                     row.elastic - row.hourglass - row.contact;
    return row;
}
