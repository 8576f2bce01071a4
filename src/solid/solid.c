/* SPDX-License-Identifier: MIT */
#include "solid/solid.h"

#include <math.h>
#include <string.h>

#include "solid/contact.h"
#include "solid/contact_friction.h"
#include "solid/loads.h"
#include "case/effects.h"
#include "case/params.h"
#include "solid/packed.h"
#include "solid/stencil.h"

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

/* Bodies joined directly or through others get the number of the first of them. */
static void join_bodies(struct solid *s, const struct scene *scene)
{
    for (int k = 0; k < s->n_bodies; k++) s->body[k].bond = k;
    for (int k = 0; k < s->n_bodies; k++) {
        if (!scene->solid[k].joined[0]) continue;
        const int a = s->body[k].bond,
                  b = s->body[scene_find_solid(scene, scene->solid[k].joined)].bond;
        for (int j = 0; j < s->n_bodies; j++)
            if (s->body[j].bond == a || s->body[j].bond == b) s->body[j].bond = a < b ? a : b;
    }
    for (int k = 0; k < s->n_bodies; k++)
        for (int j = 0; j < s->n_bodies; j++)
            s->body[k].mixed |=
                s->body[j].bond == s->body[k].bond && s->body[j].density * s->body[j].viscosity !=
                                                          s->body[k].density * s->body[k].viscosity;
}

/* Float resolves the displacement gradient of a rotation to 1e-7, beside strains that may be
 * smaller. Without damping the effect on the motion accumulates: a steel strip without viscosity
 * gained 4e-4 of its energy in 0.14 s. With alpha_s = 0.001 it gained as much as in double. */
#define DAMPED 0.01

/* The name of a body for which float is not sufficient; NULL: none. */
static const char *needs_double(const struct solid *s, const struct scene *scene,
                                const struct particles *p)
{
    /* NOLINTNEXTLINE(clang-analyzer-core.VLASize): a solid has bodies */
    bool held[s->n_bodies];
    memset(held, 0, sizeof held);
    for (int64_t i = 0; i < p->n; i++) {
        const int k = p->body[i];
        if (p->free[i] == 0 && scene_find_motion(scene, scene->solid[k].clamp_motion) < 0)
            held[s->body[k].bond] = true;
    }
    for (int k = 0; k < s->n_bodies; k++)
        if (!held[s->body[k].bond] || scene->solid[k].artificial_viscosity < DAMPED)
            return scene->solid[k].common.name;
    return NULL;
}

static const struct solid_sweeps *choose_sweeps(const struct solid *s, const struct scene *scene,
                                                const struct particles *p, struct diag *d)
{
    const int choice = scene->numerics.solid_precision;
    if (scene->top.precision == PRECISION_DOUBLE || choice == SOLID_PRECISION_DOUBLE)
        return &solid_sweeps_double;
    const char *const name = needs_double(s, scene, p);
    if (!name) return &solid_sweeps_mixed;
    if (choice == SOLID_PRECISION_AUTO) return &solid_sweeps_double;
    char place[LOCATION_TEXT];
    scene_location(scene, scene_line(scene, SECTION_numerics, 0, "solid_precision"), place);
    diag_warn(d,
              "%s: [numerics] solid_precision = single, but [solid %s] can turn freely or has an "
              "artificial_viscosity below %g: its stress may have an error of 1e-6 of Young's "
              "modulus, and it may gain energy; use auto",
              place, name, DAMPED);
    return &solid_sweeps_mixed;
}

enum err solid_create(struct solid *s, struct arena *a, const struct scene *scene,
                      struct particles *p, struct diag *d)
{
    memset(s, 0, sizeof *s);
    s->n_bodies = scene->n_solid;
    s->dp = INFINITY;
    s->coupled = p->groups & G_COUPLED;
    s->kick = solid_free_kick;
    s->body = arena_alloc(a, (size_t)s->n_bodies, sizeof *s->body, "bodies", d);
    if (!s->body) return ERR_MEMORY;
    s->paper_step = INFINITY;
    for (int k = 0; k < s->n_bodies; k++) {
        s->body[k] = body_of(scene, k);
        s->variational |= s->body[k].variational;
        s->kelvin_voigt |= s->body[k].damping_time > 0;
        s->mass_damped |= s->body[k].mass_damping > 0;
        s->paper_step =
            min2(s->paper_step, 0.6 * s->body[k].h / s->body[k].sound_speed); /* Eq. 29 */
        s->dp = min2(s->dp, s->body[k].dp);
    }
    join_bodies(s, scene);
    s->sweeps = choose_sweeps(s, scene, p, d);
    TRY(solid_packed_create(s, a, p, d));
    TRY(solid_stencil_create(s, a, p, d));
    for (int k = 0; k < (int)COUNT_OF(s->scratch); k++) {
        s->scratch[k] = arena_alloc(a, (size_t)p->n, sizeof(double), "search of the step", d);
        if (!s->scratch[k]) return ERR_MEMORY;
    }
    s->work_on = arena_alloc(a, (size_t)s->n_bodies, sizeof *s->work_on, "work on bodies", d);
    s->threads = p->n < SOLID_PARALLEL ? 1 : thread_count();
    return s->work_on ? ERR_OK : ERR_MEMORY;
}

/* The packs of a thread in a parallel region. Each particle is written by one thread and sums over
 * its neighbours in the order of its slots, so the bits do not depend on the threads. */
struct chunk {
    const struct solid *s;
    struct particles *p;
    int64_t first, last;
};

static struct chunk chunk_of(const struct solid *s, struct particles *p)
{
    const int64_t threads = thread_team(), me = thread_index();
    return (struct chunk){s, p, s->n_packs * me / threads, s->n_packs * (me + 1) / threads};
}

static void sweep(const struct chunk *own, solid_sweep *f)
{
    f(own->s, own->p, own->first, own->last);
}

static void stress_sweeps(const struct chunk *own, bool displaced)
{
    const struct solid *const s = own->s;
    if (displaced || s->kelvin_voigt) sweep(own, s->sweeps->stress);
    if (s->variational) {
#pragma omp barrier
        sweep(own, s->sweeps->pairs);
    }
    if (s->kelvin_voigt) sweep(own, s->sweeps->damping);
#pragma omp barrier
}

/* The particles of the next packs that are of one body. */
struct run {
    const struct solid_body *body;
    int64_t first, end;
};

static struct run next_run(const struct solid *s, int64_t *pack, int64_t last)
{
    const struct solid_pack *const from = &s->pack[*pack], *to = from;
    while (++*pack < last && s->pack[*pack].body == from->body) to = &s->pack[*pack];
    return (struct run){&s->body[from->body], from->i, to->i + to->lanes};
}

/* Forces other than those of neighbours; clamped particles do not move. */
static void add_own_forces(const struct solid *s, struct particles *p, int64_t first, int64_t last)
{
    double *const sx = p->sx, *const sy = p->sy, *const free = p->free;
    const double *const *const external = s->external;
    for (int64_t k = first; k < last;) {
        const struct run run = next_run(s, &k, last);
        const double per_mass = 1 / run.body->mass;
        const double gx = run.body->gravity[0], gy = run.body->gravity[1];
        for (int64_t i = run.first; i < run.end && s->coupled; i++) {
            sx[i] += p->fx[i] * per_mass;
            sy[i] += p->fy[i] * per_mass;
        }
        for (int64_t i = run.first; i < run.end && external[0]; i++) {
            sx[i] += external[0][i];
            sy[i] += external[1][i];
        }
#pragma omp simd
        for (int64_t i = run.first; i < run.end; i++) {
            sx[i] = (sx[i] + gx) * free[i];
            sy[i] = (sy[i] + gy) * free[i];
        }
    }
}

/* T-77: acceleration by mass-proportional damping. */
static void add_mass_damping(const struct solid *s, struct particles *p, int64_t first,
                             int64_t last)
{
    for (int64_t k = first; k < last;) {
        const struct run run = next_run(s, &k, last);
        const double beta = run.body->mass_damping;
        for (int64_t i = run.first; i < run.end; i++) {
            p->sx[i] += p->free[i] * (-beta * p->vx[i]);
            p->sy[i] += p->free[i] * (-beta * p->vy[i]);
        }
    }
}

static void force_sweeps(const struct chunk *own)
{
    sweep(own, own->s->sweeps->forces);
    sweep(own, add_own_forces);
    if (FX_MASS_DAMPING != 0 && own->s->mass_damped) sweep(own, add_mass_damping);
#pragma omp barrier
}

/* By all threads together. */
static void vary_gravity(const struct solid *s, struct particles *p, double time)
{
    double g[2];
    scene_gravity_at(s->gravity, time, g);
    const double more[2] = {g[0] - s->gravity->top.gravity[0], g[1] - s->gravity->top.gravity[1]};
#pragma omp for schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        const double on = s->gravity->solid[p->body[i]].gravity * p->free[i];
        p->sx[i] += on * more[0];
        p->sy[i] += on * more[1];
    }
}

/* Whether prescribed motion may call a function of the program, which belongs to the calling
 * thread. */
SPHFSI_INLINE bool calls_program(const struct solid *s)
{
    return s->calls_out && (s->contact || s->loads);
}

/* Actions from outside the solid, each a pass of its own. */
static void outer_forces(const struct solid *s, struct particles *p, double time)
{
    if (s->contact) {
        const double start = wall_clock();
        contact_forces(s->contact, p, time);
#pragma omp master
        s->contact->seconds += wall_clock() - start;
    }
    if (s->gravity) vary_gravity(s, p, time);
    if (s->loads) {
#pragma omp single
        loads_forces(s->loads, s, p, time);
    }
}

/* Packs new positions and velocities for the sweeps immediately. */
static void pack_motion(const struct chunk *own)
{
    sweep(own, own->s->sweeps->pack_motion);
#pragma omp barrier
}

void solid_free_kick(const struct particles *p, int64_t first, int64_t end, double kick,
                     double drift)
{
#pragma omp simd
    for (int64_t i = first; i < end; i++) {
        p->vx[i] += kick * p->sx[i];
        p->vy[i] += kick * p->sy[i];
        p->ux[i] += drift * p->vx[i];
        p->uy[i] += drift * p->vy[i];
    }
}

static void kick_and_drift(const struct chunk *own, solid_kick *f, double kick, double drift)
{
    const struct particles *const p = own->p;
    const struct solid_pack *const pack = own->s->pack;
    const int64_t end = own->last < own->s->n_packs ? pack[own->last].i : p->n;
    const int64_t first = own->first < own->last ? pack[own->first].i : end;
    f(p, first, end, kick, drift);
    pack_motion(own);
}

void solid_stress(struct solid *s, struct particles *p)
{
#pragma omp parallel num_threads(s->threads)
    {
        const struct chunk own = chunk_of(s, p);
        pack_motion(&own);
        stress_sweeps(&own, true);
        sweep(&own, s->sweeps->write_stress);
    }
}

void solid_operator(struct solid *s, struct particles *p, bool displaced)
{
#pragma omp parallel num_threads(s->threads)
    {
        const struct chunk own = chunk_of(s, p);
        pack_motion(&own);
        stress_sweeps(&own, displaced);
        sweep(&own, s->sweeps->forces);
#pragma omp barrier
#pragma omp for schedule(static)
        for (int64_t i = 0; i < p->n; i++) {
            p->sx[i] *= p->free[i];
            p->sy[i] *= p->free[i];
        }
    }
}

void solid_forces(const struct solid *s, struct particles *p)
{
#pragma omp parallel num_threads(s->threads) if (!calls_program(s))
    {
        const struct chunk own = chunk_of(s, p);
        force_sweeps(&own);
        outer_forces(s, p, s->time);
    }
}

void solid_book_work(struct solid *s, struct particles *p, const double *vx, const double *vy,
                     double dt)
{
    if (s->contact) {
        contact_slide(s->contact, p);
        const double work = dt * s->contact->power;
        s->work += work;
        s->work_on[0] += work;
    }
    if (s->loads) s->work += loads_work(s->loads, p, vx, vy, dt, s->work_on);
}

void solid_place_clamps(const struct solid *s, struct particles *p, double time)
{
    if (s->loads) loads_place_clamps(s->loads, p, time);
}

/* Between the sub-steps: all threads together. */
static void place_clamps(const struct chunk *own, double time)
{
    const struct solid *const s = own->s;
    if (!s->loads) return;
#pragma omp single
    loads_place_clamps(s->loads, own->p, time);
    pack_motion(own);
}

/* The sub-steps of solid_advance by one of its threads. */
static void substeps(struct solid *s, struct particles *p, double dt, int n, bool centred)
{
    const struct chunk chunk = chunk_of(s, p), *const own = &chunk;
    const double first = centred ? 0.5 * dt : 0;
    kick_and_drift(own, solid_free_kick, 0, first);
    if (centred) place_clamps(own, s->time + first);
    for (int k = 0; k < n; k++) {
        stress_sweeps(own, true);
        force_sweeps(own);
        outer_forces(s, p, s->time + k * dt + first);
        if (s->contact || s->loads) {
#pragma omp single
            solid_book_work(s, p, p->vx, p->vy, dt);
        }
        const double drift = k + 1 < n ? dt : dt - first;
        kick_and_drift(own, s->kick, dt, drift);
        place_clamps(own, k + 1 < n ? s->time + (k + 1) * dt + first : s->time + n * dt);
    }
}

void solid_advance(struct solid *s, struct particles *p, double dt, int n, bool centred)
{
#pragma omp parallel num_threads(s->threads) if (!calls_program(s))
    substeps(s, p, dt, n, centred);
    s->time += n * dt;
}

double solid_set_positions(struct particles *p)
{
    double moved2 = 0;
#pragma omp parallel for simd schedule(static) reduction(max : moved2)
    for (int64_t i = 0; i < p->n; i++) {
        const double x = p->X[i] + p->ux[i], y = p->Y[i] + p->uy[i];
        moved2 = max2(moved2, square(x - p->x[i]) + square(y - p->y[i]));
        p->x[i] = x;
        p->y[i] = y;
    }
    return sqrt(moved2);
}

void solid_show(const struct solid *s, struct particles *p)
{
#pragma omp parallel num_threads(s->threads)
    {
        const struct chunk own = chunk_of(s, p);
        sweep(&own, s->sweeps->write_stress);
    }
}
