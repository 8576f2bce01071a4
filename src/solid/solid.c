/* SPDX-License-Identifier: MIT
 * Sets up a solid, finds its stress and forces, and takes its explicit sub-steps. */
#include "solid/contact.h"
#include "solid/hinges.h"
#include "solid/loads.h"
#include "base/threads.h"

static struct solid_body body_of(const struct scene *scene, int k)
{
    const struct scene_solid *const c = &scene->solid[k];
    const double dp = scene_solid_dp(scene, k), h = scene_solid_h(scene, k);
    const double E = c->young, nu = c->poisson, on = c->gravity ? 1 : 0;
    const double bulk = E / (3 * (1 - 2 * nu));
    return (struct solid_body){
        .dp = dp,
        .h = h,
        .lambda = E * nu / ((1 + nu) * (1 - 2 * nu)),
        .mu = E / (2 * (1 + nu)),
        .density = c->density,
        .young = E,
        .mass = c->density * square(dp),
        .sound_speed = sqrt(bulk / c->density), /* Eq. 29 */
        .viscosity = c->artificial_viscosity * sqrt(bulk / c->density) * h,
        .kappa = c->hourglass,
        .damping_time = c->damping_time,
        .mass_damping = c->mass_damping,
        .gravity = {on * scene->top.gravity[0], on * scene->top.gravity[1]},
        .law = c->law,
        .plane = c->plane,
        .gradient = c->gradient,
        .symmetric = c->viscosity_form == VISCOSITY_SYMMETRIC,
        .variational = c->hourglass > 0 && c->hourglass_form == HOURGLASS_VARIATIONAL,
    };
}

static void join_bodies(struct solid *solid, const struct scene *scene)
{
    int bond[SCENE_MAX_SECTIONS];
    scene_bonds(scene, bond);
    for (int k = 0; k < solid->n_bodies; k++) solid->body[k].bond = bond[k];
    for (int k = 0; k < solid->n_bodies; k++)
        for (int j = 0; j < solid->n_bodies; j++)
            solid->body[k].mixed |= solid->body[j].bond == solid->body[k].bond &&
                                    solid->body[j].density * solid->body[j].viscosity !=
                                        solid->body[k].density * solid->body[k].viscosity;
}

double solid_thickness(const struct solid *solid, const struct particles *particles, int bond)
{
    struct box2 box = box2_empty();
    double area = 0;
    for (int64_t i = 0; i < particles->n; i++) {
        const struct solid_body *const body = &solid->body[particles->body[i]];
        if (bond != SOLID_ALL && body->bond != bond) continue;
        box2_include(&box, particles->X[i], particles->Y[i]);
        area += square(body->dp);
    }
    return area / max2(box.high[0] - box.low[0], box.high[1] - box.low[1]);
}

/* Whether a body can turn freely, or has hardly any artificial viscosity, so that float is not
 * sufficient. Float resolves the displacement gradient of a rotation to 1e-7, relative to strains
 * that may be smaller. Without damping the effect on the motion accumulates: a steel strip without
 * viscosity gained 4e-4 of its energy in 0.14 s. With alpha_s = 0.001 it gained as much as in
 * double; ten times that is required. */
static bool needs_double(const struct solid *solid, const struct scene *scene,
                         const struct particles *particles)
{
    bool held[SCENE_MAX_SECTIONS] = {false};
    for (int64_t i = 0; i < particles->n; i++) {
        const int k = particles->body[i];
        if (particles->free[i] == 0 &&
            scene_find(scene, SECTION_motion, scene->solid[k].clamp_motion) < 0)
            held[solid->body[k].bond] = true;
    }
    for (int k = 0; k < solid->n_bodies; k++)
        if (!held[solid->body[k].bond] || scene->solid[k].artificial_viscosity < 0.01) return true;
    return false;
}

/* The packed fields that the scene needs. In double precision those of the particles serve. */
static enum err packed_create(struct solid *solid, struct arena *a,
                              const struct particles *particles, struct diag *d)
{
    double *const field[SOLID_PACKED_FIELDS] = {
        [S_UX] = particles->ux,   [S_UY] = particles->uy,   [S_VX] = particles->vx,
        [S_VY] = particles->vy,   [S_UXX] = particles->Uxx, [S_UXY] = particles->Uxy,
        [S_UYX] = particles->Uyx, [S_UYY] = particles->Uyy, [S_PXX] = particles->Pxx,
        [S_PXY] = particles->Pxy, [S_PYX] = particles->Pyx, [S_PYY] = particles->Pyy,
    };
    bool mixed = false;
    for (int k = 0; k < solid->n_bodies; k++) mixed |= solid->body[k].mixed;
    for (int k = 0; k < SOLID_PACKED_FIELDS; k++) {
        if ((k == S_PAIRS_X || k == S_PAIRS_Y) && !solid->variational) continue;
        if ((k == S_LOW_X || k == S_LOW_Y) && solid->sweeps->size == sizeof(double)) continue;
        if (k == S_VISCOSITY && !mixed) continue;
        solid->packed[k] = field[k];
        if (field[k] && solid->sweeps->size == sizeof(double)) continue;
        TRY(arena_place(a, &solid->packed[k], (size_t)particles->n, solid->sweeps->size,
                        "packed fields of the solid", d));
    }
    for (int64_t i = 0; solid->packed[S_VISCOSITY] && i < particles->n; i++) {
        const struct solid_body *const b = &solid->body[particles->body[i]];
        solid_set(solid, solid->packed[S_VISCOSITY], i, b->density * b->viscosity);
    }
    return ERR_OK;
}

void solid_use_threads(struct solid *solid, const struct particles *particles, int n)
{
    /* Else the loops of several threads would be shorter than the barriers between them. */
    enum { WORTH_THREADS = 2048 };
    if (particles->n >= WORTH_THREADS) solid->threads = n;
}

enum err solid_create(struct solid *solid, struct arena *a, const struct scene *scene,
                      struct particles *particles, bool implicit, struct diag *d)
{
    memset(solid, 0, sizeof *solid);
    solid->n_bodies = scene->n_solid;
    solid->dp = INFINITY;
    solid->coupled = particles->groups & G_COUPLED;
    solid->apply_kick = solid_plain_kick;
    TRY(arena_array(a, &solid->body, solid->n_bodies, "bodies", d));
    solid->acoustic_step = INFINITY;
    for (int k = 0; k < solid->n_bodies; k++) {
        solid->body[k] = body_of(scene, k);
        solid->variational |= solid->body[k].variational;
        solid->kelvin_voigt |= solid->body[k].damping_time > 0;
        solid->acoustic_step =
            min2(solid->acoustic_step,
                 0.6 * solid->body[k].h / solid->body[k].sound_speed); /* Eq. 29 */
        solid->dp = min2(solid->dp, solid->body[k].dp);
    }
    join_bodies(solid, scene);
    for (int k = 0; k < solid->n_bodies; k++)
        solid->body[k].thickness = solid_thickness(solid, particles, solid->body[k].bond);
    const int choice = scene->numerics.solid_precision;
    const bool in_double =
        scene->top.precision == PRECISION_DOUBLE || choice == SOLID_PRECISION_DOUBLE || implicit ||
        (choice == SOLID_PRECISION_AUTO && needs_double(solid, scene, particles));
    solid->sweeps = in_double ? &solid_sweeps_double : &solid_sweeps_mixed;
    TRY(packed_create(solid, a, particles, d));
    TRY(solid_stencil_create(solid, a, particles, d));
    for (int k = 0; k < (int)COUNT_OF(solid->scratch); k++)
        TRY(arena_array(a, &solid->scratch[k], particles->n, "search of the step", d));
    TRY(arena_array(a, &solid->work_on, solid->n_bodies, "work on bodies", d));
    solid->threads = 1;
    solid_use_threads(solid, particles, thread_count());
    return ERR_OK;
}

/* The packs of a thread in a parallel region. Each particle is written by one thread and sums over
 * its neighbours in the order of its slots, so the bits do not depend on the threads. */
struct pack_range {
    const struct solid *s;
    struct particles *p;
    int64_t first, last;
};

static struct pack_range packs_of_thread(const struct solid *solid, struct particles *particles)
{
    const int64_t threads = thread_team(), me = thread_index();
    return (struct pack_range){solid, particles, solid->n_packs * me / threads,
                               solid->n_packs * (me + 1) / threads};
}

static void sweep(const struct pack_range *own, solid_sweep *f)
{
    f(own->s, own->p, own->first, own->last);
}

static void stress_sweeps(const struct pack_range *own, bool displaced)
{
    const struct solid *const solid = own->s;
    if (displaced || solid->kelvin_voigt) sweep(own, solid->sweeps->stress);
    if (solid->variational) {
#pragma omp barrier
        sweep(own, solid->sweeps->pairs);
    }
    if (solid->kelvin_voigt) sweep(own, solid->sweeps->kelvin_voigt);
    if (solid->implicit_stress) sweep(own, solid->implicit_stress);
#pragma omp barrier
}

/* Forces but those of neighbours, for the packs of a body at a time; what is clamped stays. */
static void add_own_forces(const struct solid *solid, struct particles *particles, int64_t first,
                           int64_t last)
{
    double *const sx = particles->sx, *const sy = particles->sy, *const free = particles->free;
    const struct force_hook *const hook = solid->force_hook;
    for (int64_t k = first, next; k < last; k = next) {
        const struct solid_body *const body = &solid->body[solid->pack[k].body];
        for (next = k + 1; next < last && solid->pack[next].body == solid->pack[k].body;) next++;
        const int64_t from = solid->pack[k].i,
                      end = solid->pack[next - 1].i + solid->pack[next - 1].lanes;
        const double per_mass = 1 / body->mass, gx = body->gravity[0], gy = body->gravity[1];
        for (int64_t i = from; i < end && solid->coupled; i++) {
            sx[i] += particles->fx[i] * per_mass;
            sy[i] += particles->fy[i] * per_mass;
        }
        for (int64_t i = from; i < end && hook; i++) {
            sx[i] += hook->ax[i];
            sy[i] += hook->ay[i];
        }
#pragma omp simd
        for (int64_t i = from; i < end; i++) {
            sx[i] = (sx[i] + gx) * free[i];
            sy[i] = (sy[i] + gy) * free[i];
        }
        const double beta = body->mass_damping; /* T-77 */
        for (int64_t i = from; FX_MASS_DAMPING != 0 && beta > 0 && i < end; i++) {
            sx[i] += free[i] * (-beta * particles->vx[i]);
            sy[i] += free[i] * (-beta * particles->vy[i]);
        }
    }
}

static void force_sweeps(const struct pack_range *own)
{
    sweep(own, own->s->sweeps->forces);
    sweep(own, add_own_forces);
#pragma omp barrier
}

/* By all threads together. */
static void vary_gravity(const struct solid *solid, struct particles *particles, double time)
{
    double g[2];
    scene_gravity_at(solid->gravity_scene, time, g);
    const double more[2] = {g[0] - solid->gravity_scene->top.gravity[0],
                            g[1] - solid->gravity_scene->top.gravity[1]};
#pragma omp for schedule(static)
    for (int64_t i = 0; i < particles->n; i++) {
        const struct scene_solid *const body = &solid->gravity_scene->solid[particles->body[i]];
        const double on = body->gravity * particles->free[i];
        particles->sx[i] += on * more[0];
        particles->sy[i] += on * more[1];
    }
}

/* Whether a motion may call a function of the program, which belongs to the calling thread. */
SPHFSI_INLINE bool calls_program(const struct solid *solid)
{
    return solid->calls_out && (solid->contact || solid->loads || solid->hinges);
}

/* Actions from outside; hinges last, against all others. dt: of the kick that follows, or 0. */
static void outer_forces(const struct solid *solid, struct particles *particles, double time,
                         double dt)
{
    if (solid->contact) {
        const double start = phase_clock();
        contact_forces(solid->contact, particles, time);
#pragma omp master
        solid->contact->seconds += phase_clock() - start;
    }
    if (solid->gravity_scene) vary_gravity(solid, particles, time);
    if (solid->loads) {
#pragma omp single
        loads_forces(solid->loads, solid, particles, time);
    }
    if (FX_HINGE != 0 && solid->hinges) {
#pragma omp single
        hinges_forces(solid->hinges, particles, time, dt,
                      dt > 0 && solid->apply_kick != solid_plain_kick);
    }
}

/* Packs new positions and velocities for the sweeps immediately. */
static void pack_all_motion(const struct pack_range *own)
{
    sweep(own, own->s->sweeps->pack_motion);
#pragma omp barrier
}

void solid_plain_kick(const struct particles *particles, int64_t first, int64_t end,
                      double kick_time, double drift, double next)
{
#pragma omp simd
    for (int64_t i = first; i < end; i++) {
        particles->vx[i] += kick_time * particles->sx[i];
        particles->vy[i] += kick_time * particles->sy[i];
        particles->ux[i] = particles->ux[i] + drift * particles->vx[i] + next * particles->vx[i];
        particles->uy[i] = particles->uy[i] + drift * particles->vy[i] + next * particles->vy[i];
    }
}

static void kick_and_drift(const struct pack_range *own, solid_kick *f, double kick_time,
                           double drift, double next)
{
    const struct particles *const particles = own->p;
    const struct solid_pack *const pack = own->s->pack;
    const int64_t end = own->last < own->s->n_packs ? pack[own->last].i : particles->n;
    const int64_t first = own->first < own->last ? pack[own->first].i : end;
    f(particles, first, end, kick_time, drift, next);
    pack_all_motion(own);
}

void solid_stress(struct solid *solid, struct particles *particles)
{
#pragma omp parallel num_threads(solid->threads)
    {
        const struct pack_range own = packs_of_thread(solid, particles);
        pack_all_motion(&own);
        stress_sweeps(&own, true);
        sweep(&own, solid->sweeps->write_stress);
    }
}

void solid_gradient(const struct solid *solid, struct particles *particles)
{
#pragma omp parallel num_threads(solid->threads)
    {
        const struct pack_range own = packs_of_thread(solid, particles);
        pack_all_motion(&own);
        sweep(&own, solid->sweeps->stress);
    }
}

void solid_stress_and_forces(const struct solid *solid, struct particles *particles, double time)
{
#pragma omp parallel num_threads(solid->threads) if (!calls_program(solid))
    {
        const struct pack_range own = packs_of_thread(solid, particles);
        pack_all_motion(&own);
        stress_sweeps(&own, true);
        force_sweeps(&own);
        outer_forces(solid, particles, time, 0);
    }
}

void solid_pair_forces(struct solid *solid, struct particles *particles, bool displaced)
{
#pragma omp parallel num_threads(solid->threads)
    {
        const struct pack_range own = packs_of_thread(solid, particles);
        pack_all_motion(&own);
        stress_sweeps(&own, displaced);
        sweep(&own, solid->sweeps->forces);
#pragma omp barrier
#pragma omp for schedule(static)
        for (int64_t i = 0; i < particles->n; i++) {
            particles->sx[i] *= particles->free[i];
            particles->sy[i] *= particles->free[i];
        }
    }
}

void solid_forces(const struct solid *solid, struct particles *particles)
{
#pragma omp parallel num_threads(solid->threads) if (!calls_program(solid))
    {
        const struct pack_range own = packs_of_thread(solid, particles);
        force_sweeps(&own);
        outer_forces(solid, particles, solid->time, 0);
    }
}

void solid_finish_kick(struct solid *solid, struct particles *particles, const double *vx,
                       const double *vy, double dt)
{
    if (solid->contact) {
        struct contact *const contact = solid->contact;
        contact_slide(contact, particles);
        if (contact->rigid) rigid_kick(contact->rigid, contact->time, dt);
        const double work = dt * contact->power;
        solid->work += work;
        solid->work_on[0] += work;
    }
    if (solid->loads)
        solid->work += loads_work(solid->loads, particles, vx, vy, dt, solid->work_on);
    if (solid->hinges) solid->work += hinges_work(solid->hinges, vx, vy, dt, solid->work_on);
}

void solid_place_clamps(const struct solid *solid, struct particles *particles, double time)
{
    if (solid->loads) loads_place_clamps(solid->loads, particles, time);
}

/* Between the sub-steps: all threads together. */
static void place_clamps(const struct pack_range *own, double time)
{
    const struct solid *const solid = own->s;
    if (!solid->loads) return;
#pragma omp single
    loads_place_clamps(solid->loads, own->p, time);
    pack_all_motion(own);
}

/* The sub-steps of solid_advance by one of its threads. */
static void substeps(struct solid *solid, struct particles *particles, double dt, int n)
{
    const struct pack_range packs = packs_of_thread(solid, particles), *const own = &packs;
    const double first = solid->centred ? 0.5 * dt : 0;
    double time = solid->time;
    kick_and_drift(own, solid_plain_kick, 0, 0, first);
    if (solid->centred) place_clamps(own, time + first);
    for (int k = 0; k < n; k++) {
        const bool last = k + 1 == n;
        stress_sweeps(own, true);
        force_sweeps(own);
        outer_forces(solid, particles, time + first, dt);
        if (solid->contact || solid->loads || solid->hinges) {
#pragma omp single
            solid_finish_kick(solid, particles, particles->vx, particles->vy, dt);
        }
        kick_and_drift(own, solid->apply_kick, dt, dt - first, last ? 0 : first);
        time += dt;
        place_clamps(own, last ? time : time + first);
    }
}

void solid_advance(struct solid *solid, struct particles *particles, double dt, int n)
{
#pragma omp parallel num_threads(solid->threads) if (!calls_program(solid))
    substeps(solid, particles, dt, n);
    for (int k = 0; k < n; k++) solid->time += dt; /* as in the steps */
}

double solid_set_positions(struct particles *particles)
{
    double moved2 = 0;
#pragma omp parallel for simd schedule(static) reduction(max : moved2)
    for (int64_t i = 0; i < particles->n; i++) {
        const double x = particles->X[i] + particles->ux[i], y = particles->Y[i] + particles->uy[i];
        moved2 = max2(moved2, square(x - particles->x[i]) + square(y - particles->y[i]));
        particles->x[i] = x;
        particles->y[i] = y;
    }
    return sqrt(moved2);
}

void solid_write_stress(const struct solid *solid, struct particles *particles)
{
#pragma omp parallel num_threads(solid->threads)
    {
        const struct pack_range own = packs_of_thread(solid, particles);
        sweep(&own, solid->sweeps->write_stress);
    }
}
