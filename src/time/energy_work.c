/* SPDX-License-Identifier: MIT
 * What each step adds to the account of energy: the work of all rates as the integrator applies
 * them (T-46a to T-46c). */
#include <math.h>
#include <string.h>

#include "fluid/eos.h"
#include "time/energy.h"
#include "time/state.h"

static struct energy_entry *entry_of(struct simulation *sim, enum kind kind, int section)
{
    return &sim->state.energy.entry[energy_entry(kind, section)];
}

static bool keeps_account(const struct simulation *sim) { return sim->effects & FX_ENERGY_ACCOUNT; }

/* --- rates --- */

/* Power of the rates of the last evaluation, W/m: of all pairs on a fluid, of walls and structures
 * on it, and of sources outside the scene; of the fluid's force on structures at the velocity that
 * it uses. */
struct powers {
    const double *pairs, *bodies;
    double outside[SCENE_MAX_SECTIONS], on_structure[SCENE_MAX_SECTIONS];
};

/* Of a program, of gravity beyond its value at t = 0, and of the constraint at open boundaries. */
static void find_outside_power(const struct simulation *sim, double of[SCENE_MAX_SECTIONS])
{
    const struct particles *const particles = &sim->kind[KIND_FLUID];
    const struct external *const external = &sim->external[KIND_FLUID];
    const struct fluid_constants *const k = &sim->fluid.k;
    const double gx = k->gravity[0] - sim->scene->top.gravity[0],
                 gy = k->gravity[1] - sim->scene->top.gravity[1];
    if (sim->gravity_varies || external->at)
        for (int64_t i = 0; i < particles->n; i++) {
            const double ax = gx + (external->at ? external->ax[i] : 0),
                         ay = gy + (external->at ? external->ay[i] : 0);
            of[particles->body[i]] +=
                particle_mass(k, particles, i) * (ax * particles->vx[i] + ay * particles->vy[i]);
        }
    for (int b = 0; b < sim->open.n && sim->effects & FX_OPEN; b++)
        of[0] += sim->open.rate[b].power;
}

static void find_powers(const struct simulation *sim, struct powers *power)
{
    const struct particles *const solid = &sim->kind[KIND_SOLID];
    memset(power, 0, sizeof *power);
    power->pairs = sim->fluid.power + POWER_OF_PAIRS * sim->fluid.sections;
    power->bodies = sim->fluid.power + POWER_OF_BODIES * sim->fluid.sections;
    find_outside_power(sim, power->outside);
    for (int64_t i = 0; i < solid->n && sim->effects & FX_COUPLING; i++)
        power->on_structure[solid->body[i]] +=
            solid->fx[i] * solid->wx[i] + solid->fy[i] * solid->wy[i];
}

static void integrate(struct simulation *sim, const struct powers *power, double dt)
{
    for (int k = 0; k < sim->scene->n_fluid; k++) {
        struct energy_entry *const e = entry_of(sim, KIND_FLUID, k);
        e->supplied += dt * (power->pairs[k] + power->outside[k]);
        e->dissipated += dt * (power->pairs[k] - power->bodies[k]);
        e->dummies += dt * power->bodies[k];
    }
    for (int k = 0; k < sim->scene->n_solid; k++) {
        struct energy_entry *const e = entry_of(sim, KIND_SOLID, k);
        e->dummies += dt * power->on_structure[k];
        e->interface -= dt * power->on_structure[k];
    }
    for (int k = 0; k < sim->wall_motion.n; k++) {
        const struct moving_wall *const wall = &sim->wall_motion.body[k];
        struct energy_entry *const e = entry_of(sim, KIND_WALL, wall->section);
        const double work = dt * moving_wall_power(wall, &sim->kind[KIND_WALL]);
        e->dummies -= work;
        if (wall->free) e->interface += work;
    }
}

/* The work of a step: its change bounds the error of the sums over steps. */
static void note_work(struct energy_entry *e, enum work_source source, double work)
{
    e->work_change = max2(e->work_change, fabs(work - e->last_work[source]));
    e->last_work[source] = work;
}

static void note_fluid_work(struct simulation *sim, const struct powers *power, double dt)
{
    for (int k = 0; k < sim->scene->n_fluid; k++)
        note_work(entry_of(sim, KIND_FLUID, k), WORK_OF_FLUID,
                  dt * (power->pairs[k] + power->outside[k]));
}

void energy_of_step(struct simulation *sim, double dt)
{
    struct energy_account *const account = &sim->state.energy;
    struct powers power;
    if (!keeps_account(sim)) return;
    find_powers(sim, &power);
    integrate(sim, &power, account->pending);
    note_fluid_work(sim, &power, dt);
    energy_test_due(sim);
    account->pending = 0.5 * dt;
    integrate(sim, &power, account->pending);
}

void energy_of_midpoint(struct simulation *sim, double dt)
{
    struct powers power;
    if (!keeps_account(sim)) return;
    find_powers(sim, &power);
    integrate(sim, &power, dt);
    note_fluid_work(sim, &power, dt);
}

/* --- Verlet --- */

void energy_of_restart(struct simulation *sim)
{
    double lost[SCENE_MAX_SECTIONS];
    if (!keeps_account(sim)) return;
    energy_alternating(sim, lost);
    for (int k = 0; k < sim->scene->n_fluid; k++) {
        struct energy_entry *const e = entry_of(sim, KIND_FLUID, k);
        e->supplied += lost[k];
        e->restarts += lost[k];
    }
}

/* --- changes at once --- */

static void dissipate(struct simulation *sim, int section, double loss)
{
    struct energy_entry *const e = entry_of(sim, KIND_FLUID, section);
    e->supplied -= loss;
    e->dissipated -= loss;
}

void energy_of_shift(struct simulation *sim, const double gain[SCENE_MAX_SECTIONS])
{
    for (int k = 0; k < sim->scene->n_fluid; k++) dissipate(sim, k, -gain[k]);
}

/* The rates of the last step have changed the density over the whole step, and half of this is
 * still to be counted. That half will have no pressure: its work is counted here. By Verlet what is
 * counted half a step before is the mean of both solutions' (T-46f). */
void energy_drop_density(struct simulation *sim, int64_t i)
{
    const struct particles *const particles = &sim->kind[KIND_FLUID];
    const double c0 = sim->fluid.k.c0, d = particles->dens[i];
    if (!keeps_account(sim)) return;
    const double rate = particles->ddens_old ? particles->ddens_old[i] : particles->ddens[i];
    const double half = sim->state.energy.pending * rate * EOS_ENERGY_RATE(d, c0);
    const double held = particles->dens_old
                            ? 0.5 * (eos_energy(d, c0) + eos_energy(particles->dens_old[i], c0))
                            : eos_energy(d, c0) - half;
    dissipate(sim, particles->body[i], particle_mass(&sim->fluid.k, particles, i) * held);
}

/* --- the solid, and work from outside --- */

void energy_of_solid(struct simulation *sim, double dt, int n, bool centred)
{
    if (!keeps_account(sim)) return;
    const struct particles *const particles = &sim->kind[KIND_SOLID];
    const double *const *const external = sim->solid.external;
    /* Work is done over the displacement by the mean velocities of the kicks (T-46c). Drifts after
     * the kicks are longer by half a kick of the change of velocity. */
    const double late = centred ? 0 : 0.5 * dt / n;
    double fluid[SCENE_MAX_SECTIONS] = {0}, outside[SCENE_MAX_SECTIONS] = {0};
    for (int64_t i = 0; i < particles->n; i++) {
        if (particles->free[i] == 0) continue;
        const double mass = sim->solid.body[particles->body[i]].mass;
        const double ux =
            particles->ux[i] - particles->x0[i] - late * (particles->vx[i] - particles->vx0[i]);
        const double uy =
            particles->uy[i] - particles->y0[i] - late * (particles->vy[i] - particles->vy0[i]);
        fluid[particles->body[i]] += particles->fx[i] * ux + particles->fy[i] * uy;
        if (sim->coupling.impedance > 0)
            fluid[particles->body[i]] += mass * particles->face_work[i]; /* T-35a */
        if (external[0])
            outside[particles->body[i]] += mass * (external[0][i] * ux + external[1][i] * uy);
    }
    for (int k = 0; k < sim->scene->n_solid; k++) {
        struct energy_entry *const e = entry_of(sim, KIND_SOLID, k);
        e->supplied += fluid[k] + outside[k];
        e->interface += fluid[k];
        note_work(e, WORK_OF_FLUID, fluid[k] + outside[k]);
    }
}

void energy_of_rigid(struct simulation *sim)
{
    for (int k = 0; k < sim->rigid.n && keeps_account(sim); k++) {
        struct energy_entry *const e = entry_of(sim, KIND_WALL, scene_rigid_wall(sim->scene, k));
        e->supplied += sim->rigid.body[k].work;
        e->interface += sim->rigid.body[k].work;
        note_work(e, WORK_OF_FLUID, sim->rigid.body[k].work);
    }
}

/* T-70: work in the last step of gravity beyond its value at t = 0, with the value at mid-step. The
 * ledger has the potential energy of the value at t = 0. */
static double gravity_work(struct simulation *sim)
{
    double g[2], px = 0, py = 0;
    const double *const start = sim->scene->top.gravity;
    const double dt = sim->state.dt;
    scene_gravity_at(sim->scene, sim->state.time - 0.5 * dt, g);
    const double gx = g[0] - start[0], gy = g[1] - start[1];
    const struct particles *const fluid = &sim->kind[KIND_FLUID], *const particles =
                                                                      &sim->kind[KIND_SOLID];
    for (int64_t i = 0; i < fluid->n; i++) {
        px += sim->fluid.k.mass * fluid->vx[i];
        py += sim->fluid.k.mass * fluid->vy[i];
    }
    for (int64_t i = 0; i < particles->n; i++) {
        const double mass = sim->scene->solid[particles->body[i]].gravity * particles->free[i] *
                            sim->solid.body[particles->body[i]].mass;
        px += mass * particles->vx[i];
        py += mass * particles->vy[i];
        energy_supply(sim, KIND_SOLID, particles->body[i],
                      dt * mass * (gx * particles->vx[i] + gy * particles->vy[i]));
    }
    for (int k = 0; k < sim->rigid.n; k++) {
        if (!sim->rigid.body[k].given->gravity) continue;
        const double *const v = sim->rigid.state[k].v, mass = sim->rigid.body[k].mass[0];
        px += mass * v[0];
        py += mass * v[1];
        energy_supply(sim, KIND_WALL, scene_rigid_wall(sim->scene, k),
                      dt * mass * (gx * v[0] + gy * v[1]));
    }
    return dt * (gx * px + gy * py);
}

void energy_after_step(struct simulation *sim)
{
    double *const work = &sim->state.wall_work;
    if (sim->effects & FX_MOTION && sim->effects & FX_FLUID)
        *work += sim->state.dt * wall_motion_power(&sim->wall_motion, &sim->kind[KIND_WALL]);
    if (sim->effects & FX_OPEN) sim->state.energy.open = open_energy(&sim->open);
    *work += sim->solid.work;
    sim->solid.work = 0;
    for (int k = 0; k < sim->solid.n_bodies && keeps_account(sim); k++) {
        energy_supply(sim, KIND_SOLID, k, sim->solid.work_on[k]);
        note_work(entry_of(sim, KIND_SOLID, k), WORK_FROM_OUTSIDE, sim->solid.work_on[k]);
        sim->solid.work_on[k] = 0;
    }
    if (sim->gravity_varies) *work += gravity_work(sim);
    energy_join_touching(sim);
}
