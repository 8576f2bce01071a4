/* SPDX-License-Identifier: MIT */
#include "time/energy.h"

#include <math.h>
#include <string.h>

#include "fluid/eos.h"
#include "particles/kernel.h"
#include "implicit/implicit.h"
#include "time/evaluation.h"
#include "time/repulsion.h"

/* --- energies --- */

void energy_alternating(const struct simulation *sim, double of[SCENE_MAX_SECTIONS])
{
    const struct particles *const particles = &sim->kind[KIND_FLUID];
    const struct fluid_constants *const k = &sim->fluid.k;
    const double since = sim->state.dt;
    memset(of, 0, SCENE_MAX_SECTIONS * sizeof *of);
    for (int64_t i = 0; i < particles->n && particles->vx_old; i++) {
        if (particles->open && particles->open[i]) continue; /* set anew at each evaluation */
        const double u = particles->vx_old[i] + since * particles->ax[i],
                     v = particles->vy_old[i] + since * particles->ay[i];
        const double d = particles->dens_old[i] + since * particles->ddens[i];
        of[particles->body[i]] +=
            0.5 * particle_mass(k, particles, i) *
            (0.5 * (square(particles->vx[i]) + square(particles->vy[i]) - square(u) - square(v)) +
             eos_energy(particles->dens[i], k->c0) - eos_energy(d, k->c0));
    }
}

/* Of a section: its share of the ledger, and what only the account has. */
struct energies {
    struct ledger row;
    double dummies;     /* compression energy of dummies by their pressure */
    double repulsion;   /* of walls and structures, by L-7b */
    double alternating; /* by which Verlet's two solutions differ (T-46f) */
    double damper;      /* that the acoustic damper holds and has yet to dissipate (T-9a) */
    double scale;       /* of round-off: of all mass at the speed of sound */
};

static double without_potential(const struct ledger *row)
{
    return row->kinetic + row->internal + row->elastic + row->hourglass + row->contact;
}

static void add_energies(struct energies *sum, const struct energies *e)
{
    double *const to = (double *)sum;
    const double *const from = (const double *)e;
    for (size_t k = 0; k < sizeof *e / sizeof *from; k++) to[k] += from[k];
}

static void add_fluid(const struct simulation *sim, struct energies of[ENERGY_ENTRIES])
{
    const struct particles *const particles = &sim->kind[KIND_FLUID];
    const struct fluid_constants *const k = &sim->fluid.k;
    const double *const g = sim->scene->top.gravity;
    for (int64_t i = 0; i < particles->n; i++) {
        struct energies *const e = &of[energy_entry(KIND_FLUID, particles->body[i])];
        const double m = particle_mass(k, particles, i);
        e->row.kinetic += 0.5 * m * (square(particles->vx[i]) + square(particles->vy[i]));
        e->row.potential -= m * (g[0] * particles->x[i] + g[1] * particles->y[i]);
        e->row.internal += m * eos_energy(particles->dens[i], k->c0);
        e->row.momentum_x += m * particles->vx[i];
        e->row.momentum_y += m * particles->vy[i];
        e->row.mass += m;
        e->scale += m * square(k->c0);
        if (particles->dens_slow)
            e->damper += 0.5 * m * square(k->c0 * (particles->dens[i] - particles->dens_slow[i]));
    }
}

/* Returns the smallest det F. The first solid carries the energy of contact of all. */
static double add_solids(struct simulation *sim, struct energies *solid)
{
    const struct particles *const particles = &sim->kind[KIND_SOLID];
    double lowest = 1;
    for (int64_t i = 0; i < particles->n; i++) {
        struct ledger *const row = &solid[particles->body[i]].row;
        const struct solid_body *const b = &sim->solid.body[particles->body[i]];
        row->kinetic += 0.5 * b->mass * (square(particles->vx[i]) + square(particles->vy[i]));
        row->potential -=
            b->mass * (b->gravity[0] * particles->x[i] + b->gravity[1] * particles->y[i]);
        row->momentum_x += b->mass * particles->vx[i];
        row->momentum_y += b->mass * particles->vy[i];
        row->mass += b->mass;
        solid[particles->body[i]].scale += b->young * square(b->dp);
        if (!particles->interface_impulse_x)
            continue; /* the fluid has not received that yet (T-35b) */
        row->momentum_x -= particles->interface_impulse_x[i];
        row->momentum_y -= particles->interface_impulse_y[i];
    }
    for (int k = 0; k < sim->scene->n_solid; k++) {
        double det;
        solid_energy(&sim->solid, particles, k, &solid[k].row.elastic, &solid[k].row.hourglass,
                     &det);
        if (!(det >= lowest)) lowest = det; /* also one that is not a number */
    }
    if (sim->effects & FX_CONTACT)
        solid->row.contact = contact_energy(&sim->contact, particles, sim->state.time);
    return lowest;
}

static void add_rigid(const struct simulation *sim, struct energies *wall)
{
    for (int k = 0; k < sim->rigid.n; k++) {
        const struct rigid_energy e = rigid_energy(&sim->rigid, k, sim->state.dt);
        struct ledger *const row = &wall[scene_rigid_wall(sim->scene, k)].row;
        row->kinetic += e.kinetic;
        row->potential += e.potential;
        row->momentum_x += e.momentum[0];
        row->momentum_y += e.momentum[1];
        row->mass += e.mass;
    }
}

static double find_energies(struct simulation *sim, struct energies of[ENERGY_ENTRIES])
{
    memset(of, 0, ENERGY_ENTRIES * sizeof *of);
    if (sim->effects & FX_FLUID) add_fluid(sim, of);
    if (sim->effects & FX_RIGID) add_rigid(sim, &of[energy_entry(KIND_WALL, 0)]);
    return sim->effects & FX_SOLID ? add_solids(sim, &of[energy_entry(KIND_SOLID, 0)]) : 1;
}

struct ledger simulation_ledger(struct simulation *sim)
{
    struct energies of[ENERGY_ENTRIES], sum = {.scale = 0};
    const struct state *const state = &sim->state;
    const struct particles *const fluid = &sim->kind[KIND_FLUID];
    simulation_refresh(sim);
    const double det_low = find_energies(sim, of);
    for (int k = 0; k < ENERGY_ENTRIES; k++) add_energies(&sum, &of[k]);
    struct ledger row = sum.row;
    row.time = state->time;
    row.dt = state->dt;
    row.det_low = det_low;
    if (sim->solid.implicit) {
        row.newton_steps = sim->solid.implicit->iterations;
        row.newton_residual = sim->solid.implicit->residual;
    }
    row.dissipated = state->energy_start + state->wall_work + state->periodic_energy +
                     sim->solid.work + open_energy(&sim->open) - state->lost_energy -
                     without_potential(&row) - row.potential;
    for (int64_t i = 0; i < fluid->n; i++)
        row.dens_extreme = max2(row.dens_extreme, fabs(fluid->dens[i]));
    return row;
}

/* The energy of dummies, divided among the fluids as their compression energy is: a wall at rest
 * belongs to no region. */
static void add_dummies(const struct simulation *sim, struct energies *fluid)
{
    double dummies = 0, internal = 0;
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++) {
        const struct particles *const particles = &sim->kind[kind];
        for (int64_t i = 0; i < particles->n && particles->dens; i++)
            dummies += sim->fluid.volume[kind][particles->body[i]] *
                       eos_energy(particles->dens[i], sim->fluid.k.c0);
    }
    for (int k = 0; k < sim->scene->n_fluid; k++) internal += fluid[k].row.internal;
    for (int k = 0; k < sim->scene->n_fluid && internal > 0; k++)
        fluid[k].dummies = sim->fluid.k.mass * dummies * fluid[k].row.internal / internal;
}

static void find_all_energies(struct simulation *sim, struct energies of[ENERGY_ENTRIES])
{
    double repulsion[SCENE_MAX_SECTIONS] = {0}, alternating[SCENE_MAX_SECTIONS] = {0};
    struct energies *const fluid = &of[energy_entry(KIND_FLUID, 0)];
    find_energies(sim, of);
    if (sim->effects & FX_FLUID) add_dummies(sim, fluid);
    if (sim->effects & FX_REPULSION) repulsion_energy(sim, repulsion);
    if (sim->integrator->alternates) energy_alternating(sim, alternating);
    for (int k = 0; k < sim->scene->n_fluid; k++) {
        fluid[k].repulsion = repulsion[k];
        fluid[k].alternating = alternating[k];
    }
}

void energy_supply(struct simulation *sim, enum kind kind, int section, double work)
{
    if (sim->effects & FX_ENERGY_ACCOUNT)
        sim->state.energy.entry[energy_entry(kind, section)].supplied += work;
}

/* --- regions: sections that exchange energy with each other and with no others --- */

int energy_entries(const struct simulation *sim, int list[ENERGY_ENTRIES])
{
    int n = 0;
    for (int k = 0; k < sim->scene->n_solid; k++) list[n++] = energy_entry(KIND_SOLID, k);
    for (int k = 0; k < sim->scene->n_fluid; k++) list[n++] = energy_entry(KIND_FLUID, k);
    for (int k = 0; k < sim->wall_motion.n; k++)
        list[n++] = energy_entry(KIND_WALL, sim->wall_motion.body[k].section);
    return n;
}

static void unite(struct energy_account *account, int one, int other)
{
    const int a = energy_region(account, one), b = energy_region(account, other);
    const int first = a < b ? a : b, second = a < b ? b : a;
    struct energy_entry *const to = &account->entry[first], *const from = &account->entry[second];
    if (a == b) return;
    for (int t = 0; t < ENERGY_TERMS; t++) {
        to->lowest[t] += from->lowest[t];
        to->available[t] += from->available[t];
    }
    to->lowest_potential += from->lowest_potential;
    for (int k = 0; k < ENERGY_ENTRIES; k++)
        if (energy_region(account, k) == second) account->entry[k].region = first;
}

/* The smallest box around a section's particles: lowest x and y, and highest x and y with changed
 * sign. */
struct section_box {
    double low[4];
};

static void find_boxes(const struct simulation *sim, struct section_box box[ENERGY_ENTRIES])
{
    for (int k = 0; k < ENERGY_ENTRIES; k++)
        for (int side = 0; side < 4; side++) box[k].low[side] = (double)INFINITY;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const struct particles *const particles = &sim->kind[kind];
        for (int64_t i = 0; i < particles->n; i++) {
            const double at[] = {particles->x[i], particles->y[i], -particles->x[i],
                                 -particles->y[i]};
            double *const low = box[energy_entry((enum kind)kind, particles->body[i])].low;
            for (int side = 0; side < 4; side++) low[side] = min2(low[side], at[side]);
        }
    }
}

static bool are_near(const struct section_box *a, const struct section_box *b, double reach)
{
    bool near = true;
    for (int side = 0; side < 4; side++) near &= a->low[side] + b->low[(side + 2) % 4] <= reach;
    return near;
}

/* A fluid and another section whose boxes are within the kernel's reach of each other belong to one
 * region from now on. */
static void join_neighbours(struct simulation *sim)
{
    int list[ENERGY_ENTRIES];
    const int n = energy_entries(sim, list), first_wall = energy_entry(KIND_WALL, 0);
    struct energy_account *const account = &sim->state.energy;
    struct section_box box[ENERGY_ENTRIES];
    bool apart = false;
    for (int k = 1; k < n; k++)
        apart |= energy_region(account, list[k]) != energy_region(account, list[0]);
    if (!apart) return;
    find_boxes(sim, box);
    for (int j = 0; j < n; j++)
        for (int k = 0; k < j; k++)
            if ((list[j] < first_wall || list[k] < first_wall) &&
                are_near(&box[list[j]], &box[list[k]], KERNEL_REACH * sim->scene->h))
                unite(account, list[j], list[k]);
}

/* Sections that belong together at any distance: joined bodies; all bodies once any is in contact,
 * since the energy of contact is a single number; all sections of a domain that is periodic or has
 * open boundaries. */
static void join_distant(struct simulation *sim, bool contact)
{
    int list[ENERGY_ENTRIES];
    const int n = energy_entries(sim, list);
    struct energy_account *const account = &sim->state.energy;
    for (int j = 0; j < sim->scene->n_solid; j++)
        for (int k = 0; k < j; k++)
            if (contact || sim->solid.body[j].bond == sim->solid.body[k].bond)
                unite(account, energy_entry(KIND_SOLID, j), energy_entry(KIND_SOLID, k));
    for (int k = 1; k < n && sim->effects & (FX_PERIODIC | FX_OPEN); k++)
        unite(account, list[0], list[k]);
}

/* Bodies that have exchanged a force in this step: they may part before the next test. */
void energy_join_touching(struct simulation *sim)
{
    if (!(sim->effects & FX_CONTACT) || !sim->contact.touched) return;
    sim->contact.touched = false;
    join_distant(sim, true);
}

/* --- terms --- */

/* Work that the fluid has still to receive from a body: the impulse that waits (T-35b) at the
 * velocity that the fluid uses. */
static void find_waiting_work(const struct simulation *sim, double of[ENERGY_ENTRIES])
{
    const struct particles *const particles = &sim->kind[KIND_SOLID];
    memset(of, 0, ENERGY_ENTRIES * sizeof *of);
    for (int k = 0; k < sim->rigid.n; k++)
        of[energy_entry(KIND_WALL, scene_rigid_wall(sim->scene, k))] =
            rigid_energy(&sim->rigid, k, sim->state.dt).waiting;
    for (int64_t i = 0; i < particles->n && particles->interface_impulse_x; i++)
        of[energy_entry(KIND_SOLID, particles->body[i])] +=
            particles->interface_impulse_x[i] * particles->wx[i] +
            particles->interface_impulse_y[i] * particles->wy[i];
}

/* Energy that the work on a section changes. */
static double own_energy(const struct energies *e)
{
    return without_potential(&e->row) + e->row.potential - e->alternating;
}

static void find_terms(const struct simulation *sim, const struct energies of[ENERGY_ENTRIES],
                       double terms[ENERGY_ENTRIES][ENERGY_TERMS])
{
    const int first_wall = energy_entry(KIND_WALL, 0);
    double waiting[ENERGY_ENTRIES];
    find_waiting_work(sim, waiting);
    for (int k = 0; k < ENERGY_ENTRIES; k++) {
        const struct energy_entry *const e = &sim->state.energy.entry[k];
        const bool body = k >= first_wall;
        double *const term = terms[k];
        memset(term, 0, ENERGY_TERMS * sizeof *term);
        term[body ? TERM_SOLID : TERM_FLUID] = own_energy(&of[k]) - e->supplied;
        term[TERM_DISSIPATION] = e->dissipated + of[k].damper;
        if (body) term[TERM_INTERFACE] = e->interface - waiting[k];
        term[TERM_RESTARTS] = e->restarts;
        for (int t = 0; t < TERM_ALL; t++) term[TERM_ALL] += term[t];
        term[TERM_ALL] += e->dummies + of[k].repulsion;
    }
}

void energy_begin(struct simulation *sim)
{
    struct energy_account *const account = &sim->state.energy;
    struct energies of[ENERGY_ENTRIES];
    double waiting[ENERGY_ENTRIES];
    memset(account, 0, sizeof *account);
    sim->state.energy_start -= simulation_ledger(sim).dissipated;
    if (!(sim->effects & FX_ENERGY_ACCOUNT)) return;
    find_all_energies(sim, of);
    find_waiting_work(sim, waiting);
    account->open = sim->effects & FX_OPEN ? open_energy(&sim->open) : 0;
    account->tested_at = sim->state.time;
    account->tested_steps = (double)sim->state.steps;
    for (int k = 0; k < ENERGY_ENTRIES; k++) {
        struct energy_entry *const e = &account->entry[k];
        const double available = without_potential(&of[k].row) + of[k].repulsion;
        e->supplied = own_energy(&of[k]);
        e->lowest_potential = of[k].row.potential;
        for (int t = 0; t < ENERGY_TERMS; t++) e->available[t] = available;
        e->lowest[TERM_ALL] = of[k].dummies + of[k].damper + of[k].repulsion;
        e->lowest[TERM_DISSIPATION] = of[k].damper;
        e->interface = waiting[k];
        e->region = k;
    }
    join_distant(sim, of[energy_entry(KIND_SOLID, 0)].row.contact > 0);
}

enum err energy_check_saved(const struct energy_account *account, struct diag *d)
{
    for (int k = 0; k < ENERGY_ENTRIES; k++)
        if (!(account->entry[k].region >= 0 && account->entry[k].region <= k))
            return diag_fail(d, ERR_INPUT,
                             "checkpoint: section %d refers to region %g, which does not exist; "
                             "the file is damaged or not of this case",
                             k, account->entry[k].region);
    return ERR_OK;
}

/* --- the test for gains --- */

/* Round-off of sums, and of strains and speeds, whose squares are energies (T-46). */
#define ROUND_OFF 1e-9

/* Sums over the sections of a region. */
struct region {
    int entry;
    struct energies energies;
    double term[ENERGY_TERMS];
    double tolerance; /* below which a gain is an error of the sums */
    /* Of a flow at a tenth of the speed of sound (Eq. 3), which open boundaries drive. Beside it
     * the energy at the start from rest says nothing. */
    double driven;
};

static struct region sum_region(const struct simulation *sim, int entry, const struct energies *of,
                                double terms[ENERGY_ENTRIES][ENERGY_TERMS])
{
    const struct energy_account *const account = &sim->state.energy;
    struct region sum = {.entry = entry};
    for (int k = 0; k < ENERGY_ENTRIES; k++) {
        const struct energy_entry *const e = &account->entry[k];
        if (energy_region(account, k) != entry) continue;
        add_energies(&sum.energies, &of[k]);
        for (int t = 0; t < ENERGY_TERMS; t++) sum.term[t] += terms[k][t];
        sum.tolerance += e->work_change +
                         ROUND_OFF * (fabs(e->supplied) + fabs(of[k].row.potential)) +
                         square(ROUND_OFF) * of[k].scale;
    }
    if (sim->effects & FX_OPEN)
        sum.driven = 0.5 * sim->fluid.k.mass * (double)sim->kind[KIND_FLUID].n *
                     square(0.1 * sim->fluid.k.c0);
    return sum;
}

/* Whether a gain is the larger fraction of the available energy. */
static bool exceeds(const struct energy_gain *g, const struct energy_gain *other)
{
    return other->entry < 0 || g->energy * other->available > other->energy * g->available;
}

/* The term of a region that has gained the largest fraction. A gain of all terms together is
 * attributed to the largest of them, if that is half of it; the rest is the work of dummies. */
static struct energy_gain gain_of_region(struct energy_account *account,
                                         const struct region *region)
{
    const struct energies *const e = &region->energies;
    struct energy_entry *const at = &account->entry[region->entry];
    struct energy_gain worst = {.entry = -1, .available = 1};
    double gained[ENERGY_TERMS];
    int largest = TERM_FLUID;
    at->lowest_potential = min2(at->lowest_potential, e->row.potential);
    const double active = region->driven + without_potential(&e->row) + e->repulsion +
                          e->row.potential - at->lowest_potential;
    account->largest_available = max2(account->largest_available, active);
    for (int t = 0; t < ENERGY_TERMS; t++) {
        /* Dummies may return what they hold. */
        const double now = region->term[t], base = now + (t == TERM_ALL ? e->dummies : 0);
        at->available[t] = base <= at->lowest[t] ? active : max2(at->available[t], active);
        at->lowest[t] = min2(at->lowest[t], base);
        gained[t] = now - at->lowest[t] - region->tolerance;
        account->most[t] = max2(account->most[t], gained[t] + region->tolerance);
        const struct energy_gain gain = {region->entry, (enum energy_term)t, 0,
                                         gained[t],     at->available[t],    e->row};
        if (gained[t] > 0 && exceeds(&gain, &worst)) worst = gain;
        if (t != TERM_ALL && gained[t] > gained[largest]) largest = t;
    }
    worst.all = max2(0, gained[TERM_ALL] / at->available[TERM_ALL]);
    if (worst.term == TERM_ALL && gained[largest] >= 0.5 * worst.energy)
        worst.term = (enum energy_term)largest;
    return worst;
}

struct energy_gain energy_find_gain(struct simulation *sim)
{
    struct energy_account *const account = &sim->state.energy;
    struct energies of[ENERGY_ENTRIES];
    double terms[ENERGY_ENTRIES][ENERGY_TERMS];
    struct energy_gain worst = {.entry = -1, .available = 1};
    int list[ENERGY_ENTRIES];
    const int n = energy_entries(sim, list);
    find_all_energies(sim, of);
    join_distant(sim, of[energy_entry(KIND_SOLID, 0)].row.contact > 0);
    join_neighbours(sim);
    find_terms(sim, of, terms);
    memset(account->now, 0, sizeof account->now);
    for (int m = 0; m < n; m++) {
        const int k = list[m];
        for (int t = 0; t < ENERGY_TERMS; t++) account->now[t] += terms[k][t];
        if (energy_region(account, k) != k) continue;
        const struct region region = sum_region(sim, k, of, terms);
        const struct energy_gain gain = gain_of_region(account, &region);
        if (gain.entry >= 0 && exceeds(&gain, &worst)) worst = gain;
    }
    return worst;
}

/* Steps and time between two tests. A test costs about two steps of a solid. */
enum { TEST_STEPS = 64, SOLID_ONLY_TEST_STEPS = 256 };
#define TEST_TIME 2.5e-3

void energy_test_due(struct simulation *sim)
{
    struct energy_account *const account = &sim->state.energy;
    const double time = sim->state.time;
    const int interval = sim->effects & FX_FLUID ? TEST_STEPS : SOLID_ONLY_TEST_STEPS;
    if (!(sim->effects & FX_ENERGY_ACCOUNT)) return;
    if (sim->effects & FX_OPEN) { /* brought in other than by the constraint */
        const double now = open_energy(&sim->open);
        energy_supply(sim, KIND_FLUID, 0, now - account->open);
        account->open = now;
    }
    if ((double)sim->state.steps - account->tested_steps < interval &&
        !(time - account->tested_at >= TEST_TIME))
        return;
    if (sim->effects & FX_SOLID) solid_stress(&sim->solid, &sim->kind[KIND_SOLID]);
    sim->gain = energy_find_gain(sim);
    sim->gain_found = true;
    account->tested_at = time;
    account->tested_steps = (double)sim->state.steps;
}
