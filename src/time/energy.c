/* SPDX-License-Identifier: MIT */
#include "time/energy.h"
#include "geometry/motion.h"
#include "time/advance.h"

/* --- energies --- */

/* Of a section or region: its share of the ledger, and what only the account has. Doubles only. */
struct energies {
    struct ledger row;
    double dummies;   /* compression energy of dummies by their pressure */
    double repulsion; /* of walls and structures, by L-7b */
    double damper;    /* that the acoustic damper holds and has yet to dissipate (T-9a) */
    double waiting; /* work that the fluid has still to receive from a body: the impulse that waits
                       (T-35b) at the velocity that the fluid uses */
    double term[ENERGY_TERMS];
    double tolerance; /* below which a gain is an error of the sums */
};

/* Round-off of sums, and of strains and speeds, whose squares are energies (T-46). */
#define ROUND_OFF 1e-9

static double without_potential(const struct energies *e)
{
    const struct ledger *const row = &e->row;
    return row->kinetic + row->internal + row->elastic + row->hourglass + row->contact +
           e->repulsion + e->damper;
}

static void add_energies(struct energies *sum, const struct energies *e)
{
    double *const to = (double *)sum;
    const double *const from = (const double *)e;
    for (size_t k = 0; k < sizeof *e / sizeof *from; k++) to[k] += from[k];
}

static void add_particle(struct ledger *row, const struct particles *particles, int64_t i, double m,
                         const double g[2])
{
    row->kinetic += 0.5 * m * (square(particles->vx[i]) + square(particles->vy[i]));
    row->potential -= m * (g[0] * particles->x[i] + g[1] * particles->y[i]);
    row->momentum_x += m * particles->vx[i];
    row->momentum_y += m * particles->vy[i];
    row->mass += m;
}

static void add_fluid(const struct simulation *sim, struct energies of[ENERGY_ENTRIES])
{
    const struct particles *const particles = &sim->kind[KIND_FLUID];
    const struct fluid_constants *const k = &sim->fluid.k;
    for (int64_t i = 0; i < particles->n; i++) {
        struct energies *const e = &of[energy_entry(KIND_FLUID, particles->body[i])];
        const double m = particle_mass(k, particles, i);
        add_particle(&e->row, particles, i, m, sim->scene->top.gravity);
        e->row.internal += m * eos_energy(particles->dens[i], k->c0);
        e->tolerance += m * square(ROUND_OFF * k->c0);
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
        struct energies *const e = &solid[particles->body[i]];
        const struct solid_body *const b = &sim->solid.body[particles->body[i]];
        add_particle(&e->row, particles, i, b->mass, b->gravity);
        e->tolerance += b->young * square(ROUND_OFF * b->dp);
        if (!particles->interface_impulse_x) continue;
        const double x = particles->interface_impulse_x[i], y = particles->interface_impulse_y[i];
        e->row.momentum_x -= x;
        e->row.momentum_y -= y;
        e->waiting += x * particles->wx[i] + y * particles->wy[i];
    }
    for (int k = 0; k < sim->scene->n_solid; k++) {
        double det;
        solid_energy(&sim->solid, particles, k, &solid[k].row.elastic, &solid[k].row.hourglass,
                     &det);
        if (!(det >= lowest)) lowest = det; /* also one that is not a number */
    }
    if (sim->effects & FX_CONTACT)
        solid->row.contact =
            contact_energy(&sim->contact, particles, scene_time(sim, sim->state.time));
    return lowest;
}

/* Rigid bodies and beams, whose sections follow those of the other walls. */
static void add_bodies(const struct simulation *sim, struct energies *body)
{
    for (int k = 0; k < sim->rigid.n + sim->beams.n; k++) {
        const struct body_energy e = k < sim->rigid.n ? rigid_energy(&sim->rigid, k, sim->state.dt)
                                                      : beam_energy(&sim->beams, k - sim->rigid.n);
        struct ledger *const row = &body[k].row;
        row->kinetic = e.kinetic;
        row->potential = e.potential;
        row->elastic = e.elastic;
        row->momentum_x = e.momentum[0];
        row->momentum_y = e.momentum[1];
        row->mass = e.mass;
        body[k].waiting = e.waiting;
    }
}

/* Returns the smallest det F. */
static double find_energies(struct simulation *sim, struct energies of[ENERGY_ENTRIES])
{
    memset(of, 0, ENERGY_ENTRIES * sizeof *of);
    if (sim->effects & FX_FLUID) add_fluid(sim, of);
    add_bodies(sim, &of[energy_entry(KIND_WALL, scene_rigid_wall(sim->scene, 0))]);
    return sim->effects & FX_SOLID ? add_solids(sim, &of[energy_entry(KIND_SOLID, 0)]) : 1;
}

struct ledger simulation_ledger(struct simulation *sim)
{
    struct energies of[ENERGY_ENTRIES], sum = {.tolerance = 0};
    const struct state *const state = &sim->state;
    const struct particles *const fluid = &sim->kind[KIND_FLUID];
    simulation_refresh(sim);
    const double det_low = find_energies(sim, of);
    for (int k = 0; k < ENERGY_ENTRIES; k++) add_energies(&sum, &of[k]);
    struct ledger row = sum.row;
    row.time = state->time;
    row.dt = state->dt;
    row.det_low = det_low;
    const struct implicit *const by = sim->solid.implicit;
    row.newton_steps = max2(sim->beams.iterations, by ? by->iterations : 0);
    row.newton_residual = max2(sim->beams.residual, by ? by->residual : 0);
    row.dissipated = state->energy_start + state->wall_work + state->periodic_energy +
                     sim->solid.work + open_energy(&sim->open) - state->lost_energy - row.kinetic -
                     row.internal - row.elastic - row.hourglass - row.contact - row.potential;
    row.damped = damping_energy(&sim->damping);
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

/* Also those of the account. */
static void find_all_energies(struct simulation *sim, struct energies of[ENERGY_ENTRIES])
{
    double repulsion[SCENE_MAX_SECTIONS] = {0};
    struct energies *const fluid = &of[energy_entry(KIND_FLUID, 0)];
    find_energies(sim, of);
    if (sim->effects & FX_FLUID) add_dummies(sim, fluid);
    if (sim->effects & FX_REPULSION)
        fluid_repulsion_energy(&sim->fluid, sim->kind, &sim->cells, repulsion);
    for (int k = 0; k < sim->scene->n_fluid; k++) fluid[k].repulsion = repulsion[k];
}

/* --- work --- */

static struct energy_entry *entry_of(struct simulation *sim, enum kind kind, int section)
{
    return &sim->state.energy.entry[energy_entry(kind, section)];
}

static bool keeps_account(const struct simulation *sim) { return sim->effects & FX_ENERGY_ACCOUNT; }

void energy_supply(struct simulation *sim, enum kind kind, int section, double work)
{
    if (!keeps_account(sim)) return;
    entry_of(sim, kind, section)->supplied += work;
    entry_of(sim, kind, section)->noted += work;
}

/* Work in dt by the last evaluation: on the fluid by a program, by the constraint at open
 * boundaries and by moving walls; on structures by the fluid's force, at the velocity that the
 * fluid uses. */
void energy_of_evaluation(struct simulation *sim, double dt)
{
    if (!keeps_account(sim)) return;
    const struct particles *const fluid = &sim->kind[KIND_FLUID], *const solid =
                                                                      &sim->kind[KIND_SOLID];
    const struct external *const external = &sim->external[KIND_FLUID];
    for (int64_t i = 0; i < fluid->n && external->at; i++)
        entry_of(sim, KIND_FLUID, fluid->body[i])->supplied +=
            dt * particle_mass(&sim->fluid.k, fluid, i) *
            (external->ax[i] * fluid->vx[i] + external->ay[i] * fluid->vy[i]);
    for (int b = 0; b < sim->open.n && sim->effects & FX_OPEN; b++)
        entry_of(sim, KIND_FLUID, 0)->supplied += dt * sim->open.rate[b].power;
    for (int b = 0; b < sim->wall_motion.n; b++) {
        const struct moving_wall *const wall = &sim->wall_motion.body[b];
        struct energy_entry *const e = entry_of(sim, KIND_WALL, wall->section);
        const double work = dt * moving_wall_power(wall, &sim->kind[KIND_WALL]);
        if (wall->free)
            e->given -= work;
        else
            e->supplied += work;
    }
    for (int64_t i = 0; i < solid->n && sim->effects & FX_COUPLING; i++)
        entry_of(sim, KIND_SOLID, solid->body[i])->given +=
            dt * (solid->fx[i] * solid->wx[i] + solid->fy[i] * solid->wy[i]);
}

void energy_of_solid(struct simulation *sim, double dt, int n, bool centred)
{
    if (!keeps_account(sim)) return;
    const struct particles *const particles = &sim->kind[KIND_SOLID];
    const double *const *const external = sim->solid.external;
    /* Work is done over the displacement by the mean velocities of the kicks (T-46c). Drifts after
     * the kicks are longer by half a kick of the change of velocity. */
    const double late = centred ? 0 : 0.5 * dt / n;
    for (int64_t i = 0; i < particles->n; i++) {
        if (particles->free[i] == 0) continue;
        struct energy_entry *const e = entry_of(sim, KIND_SOLID, particles->body[i]);
        const double mass = sim->solid.body[particles->body[i]].mass;
        const double ux =
            particles->ux[i] - particles->x0[i] - late * (particles->vx[i] - particles->vx0[i]);
        const double uy =
            particles->uy[i] - particles->y0[i] - late * (particles->vy[i] - particles->vy0[i]);
        double work = particles->fx[i] * ux + particles->fy[i] * uy;
        if (sim->coupling.impedance > 0) work += mass * particles->face_work[i]; /* T-35a */
        e->received += work;
        if (external[0]) work += mass * (external[0][i] * ux + external[1][i] * uy);
        e->supplied += work;
    }
}

void energy_of_body(struct simulation *sim, int wall, double received, double driven, double passed)
{
    struct energy_entry *const e = entry_of(sim, KIND_WALL, wall);
    sim->state.wall_work += driven;
    if (!keeps_account(sim)) return;
    e->supplied += received + driven + passed;
    e->received += received;
}

/* T-70: work in the last step of gravity beyond its value at t = 0, with the value at mid-step. The
 * ledger has the potential energy of the value at t = 0. */
static double gravity_work(struct simulation *sim)
{
    double g[2], work = 0;
    scene_gravity_at(sim->scene, scene_time(sim, sim->state.time - 0.5 * sim->state.dt), g);
    for (int c = 0; c < 2; c++) g[c] = sim->state.dt * (g[c] - sim->scene->top.gravity[c]);
    const struct particles *const fluid = &sim->kind[KIND_FLUID], *const particles =
                                                                      &sim->kind[KIND_SOLID];
    for (int64_t i = 0; i < fluid->n; i++) {
        const double m = particle_mass(&sim->fluid.k, fluid, i);
        const double done = m * (g[0] * fluid->vx[i] + g[1] * fluid->vy[i]);
        energy_supply(sim, KIND_FLUID, fluid->body[i], done);
        work += done;
    }
    for (int64_t i = 0; i < particles->n; i++) {
        const int body = particles->body[i];
        const double done = sim->scene->solid[body].gravity * particles->free[i] *
                            sim->solid.body[body].mass *
                            (g[0] * particles->vx[i] + g[1] * particles->vy[i]);
        energy_supply(sim, KIND_SOLID, body, done);
        work += done;
    }
    for (int k = 0; k < sim->rigid.n; k++) {
        const double *const v = sim->rigid.state[k].v;
        const double done = sim->rigid.body[k].given->gravity * sim->rigid.body[k].mass[0] *
                            (g[0] * v[0] + g[1] * v[1]);
        energy_supply(sim, KIND_WALL, scene_rigid_wall(sim->scene, k), done);
        work += done;
    }
    return work;
}

/* --- regions: sections that exchange energy with each other and with no others --- */

static int region_of(const struct energy_account *account, int entry)
{
    return (int)account->entry[entry].region;
}

static void merge_regions(struct energy_account *account, int one, int other)
{
    const int a = region_of(account, one), b = region_of(account, other);
    const int first = a < b ? a : b, second = a < b ? b : a;
    if (first < 0 || first == second) return;
    struct energy_entry *const to = &account->entry[first], *const from = &account->entry[second];
    for (int t = 0; t < ENERGY_TERMS; t++) {
        to->lowest[t] += from->lowest[t];
        to->available[t] += from->available[t];
    }
    to->lowest_potential += from->lowest_potential;
    for (int k = 0; k < ENERGY_ENTRIES; k++)
        if (region_of(account, k) == second) account->entry[k].region = first;
}

/* The energy of contact is a single number: all bodies belong together once any have touched. */
static void join_bodies(struct simulation *sim)
{
    const int first = energy_entry(KIND_SOLID, 0);
    for (int k = first + 1; k < ENERGY_ENTRIES; k++) merge_regions(&sim->state.energy, first, k);
    for (int k = 0; k < sim->rigid.n; k++)
        merge_regions(&sim->state.energy, first,
                      energy_entry(KIND_WALL, scene_rigid_wall(sim->scene, k)));
}

/* Beams are one system of equations, from the start. Rigid bodies from the section `from` on belong
 * to them once a beam has pushed one: the work of these forces is within the region. */
static void join_beams(struct simulation *sim, int from)
{
    const int first = scene_beam_wall(sim->scene, 0);
    for (int k = from; k < sim->scene->n_wall && sim->beams.n; k++)
        merge_regions(&sim->state.energy, energy_entry(KIND_WALL, first),
                      energy_entry(KIND_WALL, k));
}

/* Sections whose boxes are within the kernel's reach of each other belong together from now on; all
 * sections do in a domain that is periodic or has open boundaries. */
static void join_neighbours(struct simulation *sim)
{
    struct energy_account *const account = &sim->state.energy;
    const bool all = sim->effects & (FX_PERIODIC | FX_OPEN);
    struct box2 box[ENERGY_ENTRIES];
    for (int k = 0; k < ENERGY_ENTRIES; k++) box[k] = box2_empty();
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const struct particles *const particles = &sim->kind[kind];
        for (int64_t i = 0; i < particles->n && !all; i++)
            box2_include(&box[energy_entry((enum kind)kind, particles->body[i])], particles->x[i],
                         particles->y[i]);
    }
    for (int j = 0; j < ENERGY_ENTRIES; j++)
        for (int k = 0; k < j && region_of(account, j) >= 0; k++)
            if (all || box2_near(&box[j], &box[k], KERNEL_REACH * sim->scene->h))
                merge_regions(account, j, k);
}

void energy_after_step(struct simulation *sim)
{
    double *const work = &sim->state.wall_work;
    if (sim->effects & FX_MOTION && sim->effects & FX_FLUID)
        *work += sim->state.dt * wall_motion_power(&sim->wall_motion, &sim->kind[KIND_WALL]);
    *work += sim->solid.work;
    sim->solid.work = 0;
    damping_book(&sim->damping, sim->state.dt);
    if (sim->gravity_varies) *work += gravity_work(sim);
    if (!keeps_account(sim)) return;
    if (sim->effects & FX_OPEN) sim->state.energy.open = open_energy(&sim->open);
    for (int k = 0; k < sim->solid.n_bodies; k++) {
        entry_of(sim, KIND_SOLID, k)->supplied += sim->solid.work_on[k];
        sim->solid.work_on[k] = 0;
    }
    for (int k = 0; k < ENERGY_ENTRIES; k++) {
        struct energy_entry *const e = &sim->state.energy.entry[k];
        const double done = e->supplied - e->noted;
        e->work_change = max2(e->work_change, fabs(done - e->last_work));
        e->last_work = done;
        e->noted = e->supplied;
    }
    if (sim->contact.touched) join_bodies(sim); /* they may part before the test */
    if (sim->beams.pushed) join_beams(sim, scene_rigid_wall(sim->scene, 0));
    sim->contact.touched = sim->beams.pushed = false;
}

/* --- terms --- */

static void find_terms(const struct simulation *sim, struct energies of[ENERGY_ENTRIES])
{
    const int first_wall = energy_entry(KIND_WALL, 0);
    for (int k = 0; k < ENERGY_ENTRIES; k++) {
        const struct energy_entry *const e = &sim->state.energy.entry[k];
        const double gained = without_potential(&of[k]) + of[k].row.potential - e->supplied;
        double *const term = of[k].term;
        const bool body = k >= first_wall && of[k].row.mass > 0; /* not a wall that is driven */
        term[body ? TERM_SOLID : TERM_FLUID] = gained;
        if (body) term[TERM_FLUID] = e->given;
        if (body) term[TERM_INTERFACE] = e->received - e->given - of[k].waiting;
        term[TERM_ALL] = term[TERM_FLUID] + term[TERM_INTERFACE] + term[TERM_SOLID];
        of[k].tolerance +=
            e->work_change + ROUND_OFF * (fabs(e->supplied) + fabs(of[k].row.potential));
    }
}

void energy_begin(struct simulation *sim)
{
    struct energy_account *const account = &sim->state.energy;
    struct energies of[ENERGY_ENTRIES];
    const int sections[] = {sim->scene->n_fluid, 0, sim->scene->n_solid};
    memset(account, 0, sizeof *account);
    sim->state.energy_start -= simulation_ledger(sim).dissipated;
    if (!keeps_account(sim)) return;
    find_all_energies(sim, of);
    account->open = sim->effects & FX_OPEN ? open_energy(&sim->open) : 0;
    account->tested_at = sim->state.time;
    account->tested_steps = (double)sim->state.steps;
    for (int k = 0; k < ENERGY_ENTRIES; k++) {
        struct energy_entry *const e = &account->entry[k];
        e->region = k % SCENE_MAX_SECTIONS < sections[k / SCENE_MAX_SECTIONS] ? k : -1;
        e->received = of[k].waiting;
        e->supplied = e->noted = without_potential(&of[k]) + of[k].row.potential;
        e->lowest_potential = of[k].row.potential;
        e->lowest[TERM_FLUID] = e->lowest[TERM_ALL] = of[k].dummies;
        for (int t = 0; t < ENERGY_TERMS; t++) e->available[t] = without_potential(&of[k]);
    }
    for (int k = 0; k < sim->wall_motion.n; k++) {
        const int wall = energy_entry(KIND_WALL, sim->wall_motion.body[k].section);
        account->entry[wall].region = wall;
    }
    join_beams(sim, scene_beam_wall(sim->scene, 0));
    join_neighbours(sim);
    if (of[energy_entry(KIND_SOLID, 0)].row.contact > 0) join_bodies(sim);
}

/* --- the test for gains --- */

/* The term of a region that has gained the largest fraction. */
static struct energy_gain gain_of_region(struct energy_account *account, int entry,
                                         const struct energies *region, double driven)
{
    struct energy_entry *const at = &account->entry[entry];
    struct energy_gain worst = {.entry = -1};
    at->lowest_potential = min2(at->lowest_potential, region->row.potential);
    const double active =
        driven + without_potential(region) + region->row.potential - at->lowest_potential;
    account->largest_available = max2(account->largest_available, active);
    double gained = 0;
    for (int t = 0; t < ENERGY_TERMS; t++) {
        /* Dummies may return what they hold. */
        const double now = region->term[t],
                     base = now + (t == TERM_FLUID || t == TERM_ALL ? region->dummies : 0);
        at->available[t] = base <= at->lowest[t] ? active : max2(at->available[t], active);
        at->lowest[t] = min2(at->lowest[t], base);
        gained = now - at->lowest[t];
        account->most[t] = max2(account->most[t], gained);
        gained -= region->tolerance;
        const double share = at->available[t] > 0 ? gained / at->available[t] : (double)INFINITY;
        if (t != TERM_ALL && gained > 0 && share > worst.share)
            worst = (struct energy_gain){entry, (enum energy_term)t, .share = share,
                                         .energy = gained, .available = at->available[t]};
    }
    worst.all = max2(0, gained / at->available[TERM_ALL]);
    return worst;
}

struct energy_gain energy_find_gain(struct simulation *sim)
{
    struct energy_account *const account = &sim->state.energy;
    struct energies of[ENERGY_ENTRIES], sum[ENERGY_ENTRIES] = {0};
    struct energy_gain worst = {.entry = -1};
    /* Of a flow at a tenth of the speed of sound (Eq. 3), which open boundaries drive. Beside it
     * the energy at the start from rest says nothing. */
    const double flow = 0.5 * sim->fluid.k.mass * square(0.1 * sim->fluid.k.c0);
    const double driven = sim->effects & FX_OPEN ? flow * (double)sim->kind[KIND_FLUID].n : 0;
    find_all_energies(sim, of);
    find_terms(sim, of);
    join_neighbours(sim);
    memset(account->now, 0, sizeof account->now);
    for (int k = 0; k < ENERGY_ENTRIES; k++) {
        if (region_of(account, k) < 0) continue;
        add_energies(&sum[region_of(account, k)], &of[k]);
        for (int t = 0; t < ENERGY_TERMS; t++) account->now[t] += of[k].term[t];
    }
    for (int k = 0; k < ENERGY_ENTRIES; k++) {
        if (region_of(account, k) != k) continue;
        const struct energy_gain gain = gain_of_region(account, k, &sum[k], driven);
        if (gain.share > worst.share) worst = gain;
    }
    return worst;
}

/* Steps and time between two tests. A test costs about two steps of a solid. */
enum { TEST_STEPS = 64, SOLID_ONLY_TEST_STEPS = 256 };
#define TEST_TIME 2.5e-3

static bool test_is_due(const struct simulation *sim)
{
    const struct energy_account *const account = &sim->state.energy;
    const int interval = sim->effects & FX_FLUID ? TEST_STEPS : SOLID_ONLY_TEST_STEPS;
    return (double)sim->state.steps - account->tested_steps >= interval ||
           sim->state.time - account->tested_at >= TEST_TIME;
}

void energy_test_due(struct simulation *sim)
{
    struct energy_account *const account = &sim->state.energy;
    if (!keeps_account(sim)) return;
    if (sim->effects & FX_OPEN) { /* brought in other than by the constraint */
        const double now = open_energy(&sim->open);
        energy_supply(sim, KIND_FLUID, 0, now - account->open);
        account->open = now;
    }
    if (!test_is_due(sim)) return;
    if (sim->effects & FX_SOLID) solid_stress(&sim->solid, &sim->kind[KIND_SOLID]);
    sim->gain = energy_find_gain(sim);
    sim->gain.found = true;
    account->tested_at = sim->state.time;
    account->tested_steps = (double)sim->state.steps;
}

void energy_of_step(struct simulation *sim, double dt)
{
    struct energy_account *const account = &sim->state.energy;
    if (test_is_due(sim)) {
        energy_of_evaluation(sim, account->pending);
        account->pending = 0;
    }
    energy_test_due(sim);
    energy_of_evaluation(sim, account->pending + 0.5 * dt);
    account->pending = 0.5 * dt;
}
