/* SPDX-License-Identifier: MIT
 * Sums energies and work over regions, finds gains, and says what may help. */
#include "time/simulation.h"
#include "time/timestep.h"

/* Share of a section or region in the ledger, and what only the account has. Doubles only. */
struct energies {
    struct ledger row;
    double dummies;     /* compression energy of dummies by their pressure */
    double repulsion;   /* of walls and structures, by L-7b */
    double damper;      /* that the acoustic damper holds and has yet to dissipate (T-9a) */
    double undelivered; /* work that the fluid has still to receive from a body: that of the
                       interface impulse (T-35b), at the velocity that the fluid uses */
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

static void add_fluid(const struct simulation *sim, struct energies energy[ENERGY_ENTRIES])
{
    const struct particles *const particles = &sim->particles[KIND_FLUID];
    const struct fluid_constants *const k = &sim->fluid.k;
    for (int64_t i = 0; i < particles->n; i++) {
        struct energies *const e = &energy[energy_entry(KIND_FLUID, particles->body[i])];
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
    const struct particles *const particles = &sim->particles[KIND_SOLID];
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
        e->undelivered += x * particles->wx[i] + y * particles->wy[i];
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

/* Kicks at the start of a step (T-32) leave velocities half a step behind positions: adds the work
 * of the forces that have a potential in this half step (T-46h). Stresses are up to date. */
static void add_late_work(struct simulation *sim, struct energies *solid)
{
    struct particles *const particles = &sim->particles[KIND_SOLID];
    struct solid alone = sim->solid; /* without forces whose work is booked; overwrites sx and sy */
    if (alone.centred || sim->substeps == 0) return;
    const double half = 0.5 * sim->state.dt / sim->substeps;
    alone.coupled = false;
    alone.force_hook = NULL;
    alone.gravity_scene = NULL;
    alone.loads = NULL;
    alone.hinges = NULL;
    solid_forces(&alone, particles);
    for (int64_t i = 0; i < particles->n; i++)
        solid[particles->body[i]].row.kinetic +=
            half * sim->solid.body[particles->body[i]].mass *
            (particles->sx[i] * particles->vx[i] + particles->sy[i] * particles->vy[i]);
}

/* Rigid bodies and beams, whose sections follow those of the other walls. */
static void add_bodies(const struct simulation *sim, struct energies *body)
{
    for (int k = 0; k < sim->rigid.n + sim->beams.n; k++) {
        const struct body_energy e = k < sim->rigid.n ? rigid_energy(&sim->rigid, k, sim->state.dt)
                                                      : beam_energy(&sim->beams, k - sim->rigid.n);
        body[k] = (struct energies){.row = {.kinetic = e.kinetic,
                                            .potential = e.potential,
                                            .elastic = e.elastic,
                                            .momentum_x = e.momentum[0],
                                            .momentum_y = e.momentum[1],
                                            .mass = e.mass},
                                    .undelivered = e.undelivered};
    }
}

/* The energy of dummies, divided among fluids as theirs of compression: a wall has no region. */
static void add_dummies(const struct simulation *sim, struct energies *fluid)
{
    double dummies = 0, internal = 0;
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++) {
        const struct particles *const particles = &sim->particles[kind];
        for (int64_t i = 0; i < particles->n && particles->dens; i++)
            dummies += fluid_volume_of(&sim->fluid, kind, particles, i) *
                       eos_energy(particles->dens[i], sim->fluid.k.c0);
    }
    for (int k = 0; k < sim->scene->n_fluid; k++) internal += fluid[k].row.internal;
    for (int k = 0; k < sim->scene->n_fluid && internal > 0; k++)
        fluid[k].dummies = sim->fluid.k.mass * dummies * fluid[k].row.internal / internal;
}

static bool keeps_account(const struct simulation *sim) { return sim->effects & FX_ENERGY_ACCOUNT; }

/* Returns the smallest det F. */
static double find_energies(struct simulation *sim, struct energies energy[ENERGY_ENTRIES])
{
    double repulsion[SCENE_MAX_SECTIONS] = {0};
    memset(energy, 0, ENERGY_ENTRIES * sizeof *energy);
    if (sim->effects & FX_FLUID) add_fluid(sim, energy);
    if (sim->effects & FX_FLUID && keeps_account(sim)) add_dummies(sim, energy);
    if (sim->effects & FX_REPULSION && keeps_account(sim))
        fluid_repulsion_energy(&sim->fluid, sim->particles, &sim->cells, repulsion);
    for (int k = 0; k < sim->scene->n_fluid; k++) energy[k].repulsion = repulsion[k];
    add_bodies(sim, &energy[energy_entry(KIND_WALL, scene_rigid_wall(sim->scene, 0))]);
    return sim->effects & FX_SOLID ? add_solids(sim, &energy[energy_entry(KIND_SOLID, 0)]) : 1;
}

struct ledger simulation_ledger(struct simulation *sim)
{
    struct energies energy[ENERGY_ENTRIES], sum = {.tolerance = 0};
    const struct state *const state = &sim->state;
    const struct particles *const fluid = &sim->particles[KIND_FLUID];
    simulation_refresh(sim);
    const double det_low = find_energies(sim, energy);
    for (int k = 0; k < ENERGY_ENTRIES; k++) add_energies(&sum, &energy[k]);
    struct ledger row = sum.row;
    row.time = state->time;
    row.dt = state->dt;
    row.det_low = det_low;
    const struct implicit *const implicit = sim->solid.implicit;
    row.newton_steps = max2(sim->beams.iterations, implicit ? implicit->iterations : 0);
    row.newton_residual = max2(sim->beams.residual, implicit ? implicit->residual : 0);
    row.dissipated = state->energy_start + state->wall_work + state->periodic_energy +
                     sim->solid.work + open_energy(&sim->open) - state->lost_energy - row.kinetic -
                     row.internal - row.elastic - row.hourglass - row.contact - row.potential;
    row.damped = damping_energy(&sim->zones);
    for (int64_t i = 0; i < fluid->n; i++)
        row.dens_extreme = max2(row.dens_extreme, fabs(fluid->dens[i]));
    return row;
}

/* --- work --- */

static struct energy_entry *entry_of(struct simulation *sim, enum kind kind, int section)
{
    return &sim->state.energy.entry[energy_entry(kind, section)];
}

void energy_supply(struct simulation *sim, enum kind kind, int section, double work)
{
    if (!keeps_account(sim)) return;
    entry_of(sim, kind, section)->supplied += work;
    entry_of(sim, kind, section)->supplied_before += work;
}

/* Work in dt by the last evaluation. On the fluid: by a program, by the constraint at open
 * boundaries and by moving walls. On structures: by the fluid's force, at the velocity that the
 * fluid uses. */
void energy_book_evaluation(struct simulation *sim, double dt)
{
    if (!keeps_account(sim)) return;
    const struct particles *const fluid = &sim->particles[KIND_FLUID];
    const struct particles *const solid = &sim->particles[KIND_SOLID];
    const struct force_hook *const hook = &sim->force_hook[KIND_FLUID];
    for (int64_t i = 0; i < fluid->n && hook->accelerate; i++)
        entry_of(sim, KIND_FLUID, fluid->body[i])->supplied +=
            dt * particle_mass(&sim->fluid.k, fluid, i) *
            (hook->ax[i] * fluid->vx[i] + hook->ay[i] * fluid->vy[i]);
    for (int b = 0; b < sim->open.n && sim->effects & FX_OPEN; b++)
        entry_of(sim, KIND_FLUID, 0)->supplied += dt * sim->open.rate[b].power;
    for (int b = 0; b < sim->wall_motion.n; b++) {
        const struct moving_wall *const wall = &sim->wall_motion.wall[b];
        struct energy_entry *const e = entry_of(sim, KIND_WALL, wall->section);
        const double work = dt * moving_wall_power(wall, &sim->particles[KIND_WALL]);
        *(wall->driven ? &e->supplied : &e->from_fluid) += wall->driven ? work : -work;
    }
    if (!(sim->effects & FX_COUPLING)) return;
    for (int64_t i = 0; i < solid->n; i++)
        entry_of(sim, KIND_SOLID, solid->body[i])->from_fluid +=
            dt * (solid->fx[i] * solid->wx[i] + solid->fy[i] * solid->wy[i]);
}

void energy_book_solid(struct simulation *sim, double dt, int n)
{
    if (!keeps_account(sim)) return;
    const struct particles *const particles = &sim->particles[KIND_SOLID];
    const struct force_hook *const hook = sim->solid.force_hook;
    /* Work is done over the displacement by the mean velocities of the kicks (T-46c). Drifts after
     * the kicks are longer by half a kick of the change of velocity. */
    const double lag = sim->solid.centred ? 0 : 0.5 * dt / n;
    for (int64_t i = 0; i < particles->n; i++) {
        if (particles->free[i] == 0) continue;
        struct energy_entry *const e = entry_of(sim, KIND_SOLID, particles->body[i]);
        const double mass = sim->solid.body[particles->body[i]].mass;
        const double ux =
            particles->ux[i] - particles->ux0[i] - lag * (particles->vx[i] - particles->vx0[i]);
        const double uy =
            particles->uy[i] - particles->uy0[i] - lag * (particles->vy[i] - particles->vy0[i]);
        double work = particles->fx[i] * ux + particles->fy[i] * uy;
        if (sim->coupling.impedance > 0) work += mass * particles->face_work[i]; /* T-35a */
        e->received += work;
        if (hook) work += mass * (hook->ax[i] * ux + hook->ay[i] * uy);
        e->supplied += work;
    }
}

void energy_book_body(struct simulation *sim, int wall, double received, double driven,
                      double passed)
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
    const struct scene *const scene = sim->scene;
    double g[2], sum = 0;
    scene_gravity_at(scene, scene_time(sim, sim->state.time - 0.5 * sim->state.dt), g);
    for (int c = 0; c < 2; c++) g[c] = sim->state.dt * (g[c] - scene->top.gravity[c]);
    for (int solid = 0; solid < 2; solid++) {
        const enum kind kind = solid ? KIND_SOLID : KIND_FLUID;
        const struct particles *const p = &sim->particles[kind];
        for (int64_t i = 0; i < p->n; i++) {
            const int b = p->body[i];
            const double m = solid ? scene->solid[b].gravity * p->free[i] * sim->solid.body[b].mass
                                   : particle_mass(&sim->fluid.k, p, i);
            const double work = m * (g[0] * p->vx[i] + g[1] * p->vy[i]);
            energy_supply(sim, kind, b, work);
            sum += work;
        }
    }
    for (int k = 0; k < sim->rigid.n; k++) {
        const struct rigid_body *const b = &sim->rigid.body[k];
        const double *const v = sim->rigid.state[k].v;
        const double work = b->given->gravity * b->mass[0] * (g[0] * v[0] + g[1] * v[1]);
        energy_supply(sim, KIND_WALL, scene_rigid_wall(scene, k), work);
        sum += work;
    }
    return sum;
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

/* Sections of a kind belong to the region of an entry from now on. */
static void join(struct simulation *sim, int entry, enum kind kind, int from, int end)
{
    for (int k = from; k < end; k++)
        merge_regions(&sim->state.energy, entry, energy_entry(kind, k));
}

/* The energy of contact is a single number: all bodies belong together once any have touched. */
static void join_bodies(struct simulation *sim)
{
    const int first = energy_entry(KIND_SOLID, 0), rigid = scene_rigid_wall(sim->scene, 0);
    join(sim, first, KIND_SOLID, 1, sim->scene->n_solid);
    join(sim, first, KIND_WALL, rigid, rigid + sim->rigid.n);
}

/* Beams are one system of equations, from the start. Rigid bodies from the section `from` on belong
 * to them once a beam has pushed one: the work of these forces is within the region. */
static void join_beams(struct simulation *sim, int from)
{
    const int first = energy_entry(KIND_WALL, scene_beam_wall(sim->scene, 0));
    join(sim, first, KIND_WALL, from, sim->scene->n_wall);
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
        const struct particles *const particles = &sim->particles[kind];
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
        *work += sim->state.dt * wall_motion_power(&sim->wall_motion, &sim->particles[KIND_WALL]);
    *work += sim->solid.work;
    sim->solid.work = 0;
    damping_book(&sim->zones, sim->state.dt);
    if (sim->gravity_varies) *work += gravity_work(sim);
    if (!keeps_account(sim)) return;
    sim->state.energy.through_open = open_energy(&sim->open);
    for (int k = 0; k < sim->solid.n_bodies; k++) {
        entry_of(sim, KIND_SOLID, k)->supplied += sim->solid.work_on[k];
        sim->solid.work_on[k] = 0;
    }
    for (int k = 0; k < ENERGY_ENTRIES; k++) {
        struct energy_entry *const e = &sim->state.energy.entry[k];
        const double done = e->supplied - e->supplied_before;
        e->work_change = max2(e->work_change, fabs(done - e->last_work));
        e->last_work = done;
        e->supplied_before = e->supplied;
    }
    if (sim->contact.touched) join_bodies(sim); /* they may part before the test */
    if (sim->beams.has_pushed_body) join_beams(sim, scene_rigid_wall(sim->scene, 0));
    sim->contact.touched = sim->beams.has_pushed_body = false;
}

void energy_begin(struct simulation *sim)
{
    struct energy_account *const account = &sim->state.energy;
    struct energies energy[ENERGY_ENTRIES];
    const int sections[] = {sim->scene->n_fluid, 0, sim->scene->n_solid};
    memset(account, 0, sizeof *account);
    sim->state.energy_start -= simulation_ledger(sim).dissipated;
    if (!keeps_account(sim)) return;
    find_energies(sim, energy);
    account->through_open = open_energy(&sim->open);
    account->tested_at = sim->state.time;
    account->tested_steps = (double)sim->state.steps;
    for (int k = 0; k < ENERGY_ENTRIES; k++) {
        struct energy_entry *const e = &account->entry[k];
        e->region = k % SCENE_MAX_SECTIONS < sections[k / SCENE_MAX_SECTIONS] ? k : -1;
        e->received = energy[k].undelivered;
        e->supplied = e->supplied_before = without_potential(&energy[k]) + energy[k].row.potential;
        e->lowest_potential = energy[k].row.potential;
        e->lowest[TERM_FLUID] = e->lowest[TERM_ALL] = energy[k].dummies;
        for (int t = 0; t < ENERGY_TERMS; t++) e->available[t] = without_potential(&energy[k]);
    }
    for (int k = 0; k < sim->wall_motion.n; k++) {
        const int wall = energy_entry(KIND_WALL, sim->wall_motion.wall[k].section);
        account->entry[wall].region = wall;
    }
    join_beams(sim, scene_beam_wall(sim->scene, 0));
    join_neighbours(sim);
    if (energy[energy_entry(KIND_SOLID, 0)].row.contact > 0) join_bodies(sim);
}

/* --- the test for gains --- */

/* The largest fraction that a region has gained by a term, if none has gained a larger one. */
static void find_gain_of_region(struct energy_account *account, int entry,
                                const struct energies *region, double driven,
                                struct energy_gain *worst)
{
    struct energy_entry *const e = &account->entry[entry];
    e->lowest_potential = min2(e->lowest_potential, region->row.potential);
    const double active =
        driven + without_potential(region) + region->row.potential - e->lowest_potential;
    account->largest_available = max2(account->largest_available, active);
    double gained = 0;
    for (int t = 0; t < ENERGY_TERMS; t++) {
        /* Dummies may return what they hold. */
        const double now = region->term[t],
                     base = now + (t == TERM_FLUID || t == TERM_ALL ? region->dummies : 0);
        e->available[t] = base <= e->lowest[t] ? active : max2(e->available[t], active);
        e->lowest[t] = min2(e->lowest[t], base);
        gained = now - e->lowest[t];
        account->most[t] = max2(account->most[t], gained);
        gained -= region->tolerance;
        const double share = e->available[t] > 0 ? gained / e->available[t] : (double)INFINITY;
        if (t != TERM_ALL && gained > 0 && share > worst->share)
            *worst = (struct energy_gain){entry, (enum energy_term)t, .share = share,
                                          .energy = gained, .available = e->available[t]};
    }
    if (worst->entry == entry) worst->all = max2(0, gained / e->available[TERM_ALL]);
}

struct energy_gain energy_find_gain(struct simulation *sim)
{
    struct energy_account *const account = &sim->state.energy;
    struct energies energy[ENERGY_ENTRIES], sum[ENERGY_ENTRIES] = {0};
    struct energy_gain worst = {.entry = -1};
    const int first_wall = energy_entry(KIND_WALL, 0);
    /* Energy of a flow at a tenth of the speed of sound (Eq. 3), which open boundaries drive.
     * Compared with it the energy of a start from rest says nothing. */
    const double flow = 0.5 * sim->fluid.k.mass * square(0.1 * sim->fluid.k.c0);
    const double driven = sim->effects & FX_OPEN ? flow * (double)sim->particles[KIND_FLUID].n : 0;
    find_energies(sim, energy);
    if (sim->effects & FX_SOLID) add_late_work(sim, &energy[energy_entry(KIND_SOLID, 0)]);
    join_neighbours(sim);
    memset(account->now, 0, sizeof account->now);
    for (int k = 0; k < ENERGY_ENTRIES; k++) {
        const int region = region_of(account, k);
        if (region < 0) continue;
        const struct energy_entry *const e = &account->entry[k];
        double *const term = energy[k].term;
        const bool body = k >= first_wall && energy[k].row.mass > 0; /* not a driven wall */
        /* T-46: own energy less the work on it. What a body was given, the fluid has lost: the work
         * on the fluid is -from_fluid. What it received beyond that is a gain of the interface, but
         * for an impulse that the fluid has still to receive. */
        term[body ? TERM_SOLID : TERM_FLUID] =
            without_potential(&energy[k]) + energy[k].row.potential - e->supplied;
        if (body) term[TERM_FLUID] = e->from_fluid;
        if (body) term[TERM_INTERFACE] = e->received - e->from_fluid - energy[k].undelivered;
        term[TERM_ALL] = term[TERM_FLUID] + term[TERM_INTERFACE] + term[TERM_SOLID];
        energy[k].tolerance +=
            e->work_change + ROUND_OFF * (fabs(e->supplied) + fabs(energy[k].row.potential));
        add_energies(&sum[region], &energy[k]);
        for (int t = 0; t < ENERGY_TERMS; t++) account->now[t] += term[t];
    }
    for (int k = 0; k < ENERGY_ENTRIES; k++)
        if (region_of(account, k) == k) find_gain_of_region(account, k, &sum[k], driven, &worst);
    return worst;
}

/* Steps and time between two tests (docs/theory/guards.md). A test costs two steps of a solid. */
enum { TEST_STEPS = 64, SOLID_ONLY_TEST_STEPS = 256 };
#define TEST_TIME 2.5e-3

static bool test_is_due(const struct simulation *sim)
{
    const struct energy_account *const account = &sim->state.energy;
    const int interval = sim->effects & FX_FLUID ? TEST_STEPS : SOLID_ONLY_TEST_STEPS;
    return (double)sim->state.steps - account->tested_steps >= interval ||
           sim->state.time - account->tested_at >= TEST_TIME;
}

void energy_book_exchange(struct simulation *sim)
{
    const double open = open_energy(&sim->open);
    energy_supply(sim, KIND_FLUID, 0, open - sim->state.energy.through_open);
    sim->state.energy.through_open = open;
}

void energy_test_if_due(struct simulation *sim)
{
    struct energy_account *const account = &sim->state.energy;
    if (!keeps_account(sim) || !test_is_due(sim)) return;
    if (sim->effects & FX_SOLID) solid_stress(&sim->solid, &sim->particles[KIND_SOLID]);
    sim->gain = energy_find_gain(sim);
    sim->gain.found = true;
    account->tested_at = sim->state.time;
    account->tested_steps = (double)sim->state.steps;
}

void energy_book_step(struct simulation *sim, double dt)
{
    double *const pending = &sim->state.energy.pending;
    if (test_is_due(sim)) {
        energy_book_evaluation(sim, *pending);
        *pending = 0;
    }
    energy_book_exchange(sim);
    energy_test_if_due(sim);
    energy_book_evaluation(sim, *pending + 0.5 * dt);
    *pending = 0.5 * dt;
}

/* --- what is said of a gain, and when the run stops --- */

/* Fraction of its available energy that a region may gain without a warning. A gain above a tenth
 * counts immediately, a smaller one after it has lasted a time, s: while a run starts, little
 * energy is available (docs/theory/guards.md). */
#define GAIN_WARNING 0.01
#define GAIN_COUNTS_NOW 0.1
#define GAIN_LASTS 2.5e-3
/* An oscillation at the default solid_safety shows up to 1/(1 - 0.9^2) = 5.3 times its energy and
 * is stable; four fifths of what it shows count as gain. An unstable run exceeds any. */
#define GAIN_LIMIT 0.9
enum { TEXT = 320 };

/* What may help. The work of dummies does not depend on the step: finer fluid makes it less. */
static void write_remedy(const struct simulation *sim, enum energy_term term, char text[TEXT])
{
    double half;
    const struct scene_numerics *const n = &sim->scene->numerics;
    const char *const key = timestep_key_to_halve(sim, &half);
    const bool fluid = term == TERM_FLUID, held = n->fixed_step > 0;
    /* Between bodies that meet the layer of fluid may be too thin. */
    const bool gap = fluid && sim->effects & FX_CONTACT && sim->contact.near;
    /* Without weight nothing holds fluid at a wall that moves back. */
    const bool suction = fluid && !(sim->effects & FX_GRAVITY) && n->suction == SUCTION_OFF;
    bool paper = false; /* its law has no potential, and gains energy at any step */
    for (int k = 0; k < sim->scene->n_solid; k++) paper |= sim->scene->solid[k].law == LAW_PAPER;
    snprintf(text, TEXT, "%snumerics.%s = %.3g%s%s%s%s", fluid ? "a smaller dp or " : "", key, half,
             gap ? " or a larger gap in [contact]" : "", suction ? " or numerics.suction = on" : "",
             sim->effects & FX_MULTIRATE && !held ? " or numerics.multirate = off" : "",
             term == TERM_SOLID && paper ? " or law = neo_hookean or svk" : "");
}

/* What is fastest in a region: "[solid gate] at (0.1, 0.2) m", or its first section. */
static void write_fastest(const struct simulation *sim, int region, char text[TEXT])
{
    static const enum section_id id[KIND_COUNT] = {SECTION_fluid, SECTION_wall, SECTION_solid};
    double top = -1, x = 0, y = 0;
    int fastest = region;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const struct particles *const particles = &sim->particles[kind];
        for (int64_t i = 0; i < particles->n; i++) {
            const double speed2 = square(particles->vx[i]) + square(particles->vy[i]);
            const int own = energy_entry((enum kind)kind, particles->body[i]);
            if (!(speed2 > top) || sim->state.energy.entry[own].region != region) continue;
            top = speed2, fastest = own;
            x = particles->x[i], y = particles->y[i];
        }
    }
    const void *const section =
        section_at(sim->scene, id[fastest / SCENE_MAX_SECTIONS], fastest % SCENE_MAX_SECTIONS);
    const int used = snprintf(text, TEXT, "%s", section_title(section).text);
    if (top >= 0) snprintf(text + used, TEXT - (size_t)used, " at (%.4g, %.4g) m", x, y);
}

enum err energy_guard(struct simulation *sim, struct diag *d)
{
    const struct energy_gain g = sim->gain;
    const double time = sim->state.time;
    const char *const source = g.term == TERM_FLUID   ? "the fluid or at its boundaries"
                               : g.term == TERM_SOLID ? "the solid's stress or time integration"
                                                      : "the exchange between fluid and structure";
    char place[TEXT], text[2 * TEXT], remedy[TEXT];
    sim->gain.found = false;
    if (g.found && g.share <= GAIN_WARNING) sim->state.gain_since = time;
    const bool counts = g.share <= GAIN_WARNING || g.share >= GAIN_COUNTS_NOW ||
                        time - sim->state.gain_since >= GAIN_LASTS;
    if (!g.found || g.entry < 0 || !counts) return ERR_OK;
    sim->state.gain = max2(sim->state.gain, g.energy);
    sim->state.gain_share = max2(sim->state.gain_share, g.share);
    if (g.share <= GAIN_WARNING) return ERR_OK;
    write_fastest(sim, g.entry, place);
    snprintf(text, sizeof text,
             "%s: the run has gained %.3g J/m of energy that nothing supplied (available: %.3g "
             "J/m), in %s; fastest: %s",
             time_text(sim).text, g.energy, g.available, source, place);
    write_remedy(sim, g.term, remedy);
    /* A gain at the interface may be less than what the rest loses. */
    if ((g.term == TERM_INTERFACE ? g.all : g.share) > GAIN_LIMIT)
        return diag_fail(d, ERR_GUARD, "%s. The run is unstable; %s may help", text, remedy);
    if (g.share < 2 * sim->guard.warned_gain) return ERR_OK;
    sim->guard.warned_gain = g.share;
    diag_warn(d, "%s. The results may be invalid; %s may help", text, remedy);
    return ERR_OK;
}
