/* SPDX-License-Identifier: MIT */
#include "time/booking.h"

#include <math.h>
#include <string.h>

#include "fluid/eos.h"
#include "time/account.h"

/* Power of a fluid section, W/m: of all rates on its energy; of walls and structures; of sources
 * outside the scene. */
struct power {
    double total, touch, outer;
};

/* Sums in groups of eight over a fixed number of slices: the same order on every machine and with
 * any number of threads. */
enum { ABREAST = 8, SLICES = 16 };

/* P/rho^2 rho0: the rate at which the energy of compression changes with the density. `stiff`: c0^2/7. */
SPHFSI_INLINE double compression_rate(double d, double stiff)
{
    const double s = 1 + d;
    return stiff * eos_power(d) / (s * s);
}

/* The rate at which T-6 and T-7 change kinetic, potential and compression energy of a particle,
 * over its mass. */
SPHFSI_INLINE double rate_of(const struct particles *p, int64_t i, double stiff, double gx,
                             double gy)
{
    return p->vx[i] * (p->ax[i] - gx) + p->vy[i] * (p->ay[i] - gy) +
           compression_rate(p->dens[i], stiff) * p->ddens[i];
}

/* Acceleration from outside: of a program, and gravity beyond its value at t = 0. */
static double outer_power(const struct simulation *s, int64_t i, const double more[2])
{
    const struct particles *const p = &s->kind[KIND_FLUID];
    const struct external *const external = &s->external[KIND_FLUID];
    const double m = p->m ? p->m[i] : 1;
    double power = more[0] * p->vx[i] + more[1] * p->vy[i];
    if (external->at) power += external->ax[i] * p->vx[i] + external->ay[i] * p->vy[i];
    return m * s->fluid.k.mass * power;
}

/* One section and one mass: without indices. */
static struct power slice_power(const struct simulation *s, int64_t from, int64_t end)
{
    const struct particles p = s->kind[KIND_FLUID];
    const double gx = s->scene->top.gravity[0], gy = s->scene->top.gravity[1];
    const double stiff = square(s->fluid.k.c0) / EOS_GAMMA;
    double total[ABREAST] = {0}, touch[ABREAST] = {0};
    int64_t i = from;
    for (; i + ABREAST <= end; i += ABREAST)
#pragma omp simd
        for (int r = 0; r < ABREAST; r++) {
            total[r] += rate_of(&p, i + r, stiff, gx, gy);
            touch[r] += p.touch[i + r];
        }
    for (; i < end; i++) {
        total[0] += rate_of(&p, i, stiff, gx, gy);
        touch[0] += p.touch[i];
    }
    struct power sum = {0};
    for (int r = 0; r < ABREAST; r++) {
        sum.total += s->fluid.k.mass * total[r];
        sum.touch += touch[r];
    }
    return sum;
}

static void add_slice(const struct simulation *s, int64_t from, int64_t end, struct power *of)
{
    const struct particles *const p = &s->kind[KIND_FLUID];
    const double *const g = s->scene->top.gravity;
    const double more[2] = {s->fluid.k.gravity[0] - g[0], s->fluid.k.gravity[1] - g[1]};
    const bool outer = s->gravity_varies || s->external[KIND_FLUID].at;
    const double stiff = square(s->fluid.k.c0) / EOS_GAMMA;
    memset(of, 0, (size_t)s->scene->n_fluid * sizeof *of);
    if (s->scene->n_fluid == 1 && !p->m) {
        of[0] = slice_power(s, from, end);
    } else {
        for (int64_t i = from; i < end; i++) {
            of[p->body[i]].total +=
                (p->m ? p->m[i] : 1) * s->fluid.k.mass * rate_of(p, i, stiff, g[0], g[1]);
            of[p->body[i]].touch += p->touch[i];
        }
    }
    for (int64_t i = from; outer && i < end; i++) of[p->body[i]].outer += outer_power(s, i, more);
}

static void find_powers(const struct simulation *s, struct power of[SCENE_MAX_SECTIONS])
{
    const int64_t n = s->kind[KIND_FLUID].n;
    struct power part[SLICES][SCENE_MAX_SECTIONS];
    memset(of, 0, SCENE_MAX_SECTIONS * sizeof *of);
#pragma omp parallel for schedule(static) num_threads(s->fluid.threads)
    for (int m = 0; m < SLICES; m++) add_slice(s, n * m / SLICES, n * (m + 1) / SLICES, part[m]);
    for (int m = 0; m < SLICES; m++)
        for (int k = 0; k < s->scene->n_fluid; k++) {
            of[k].total += part[m][k].total;
            of[k].touch += part[m][k].touch;
            of[k].outer += part[m][k].outer;
        }
    for (int k = 0; k < s->open.n && s->effects & FX_OPEN; k++)
        of[0].outer += s->open.rate[k].power;
}

/* Power of the fluid's force on structures at the velocity that the fluid uses. */
static void find_delivered(const struct simulation *s, double of[SCENE_MAX_SECTIONS])
{
    const struct particles *const p = &s->kind[KIND_SOLID];
    memset(of, 0, SCENE_MAX_SECTIONS * sizeof *of);
    for (int64_t i = 0; i < p->n && s->effects & FX_COUPLING; i++)
        of[p->body[i]] += p->fx[i] * p->wx[i] + p->fy[i] * p->wy[i];
}

/* The rates of the last evaluation over dt. */
static void integrate(struct account *a, const struct simulation *s, const struct power *power,
                      const double *delivered, double dt)
{
    for (int k = 0; k < s->scene->n_fluid; k++) {
        const int entry = account_entry(KIND_FLUID, k);
        const struct power *const now = &power[k];
        a->put[entry] += dt * now->total;
        a->spent[entry] += dt * (now->total - now->touch - now->outer);
        a->dummies[entry] += dt * now->touch;
    }
    for (int k = 0; k < s->scene->n_solid; k++) {
        const int entry = account_entry(KIND_SOLID, k);
        a->dummies[entry] += dt * delivered[k];
        a->exchange[entry] -= dt * delivered[k];
    }
    for (int k = 0; k < s->wall_motion.n; k++) {
        const struct moving_wall *const b = &s->wall_motion.body[k];
        a->dummies[account_entry(KIND_WALL, b->section)] -=
            dt * moving_body_power(b, &s->kind[KIND_WALL]);
    }
}

static void note_step(struct account *a, const struct simulation *s, const struct power *power,
                      double dt)
{
    for (int k = 0; k < s->scene->n_fluid; k++)
        account_step(a, SOURCE_FLUID, account_entry(KIND_FLUID, k), dt * power[k].total);
}

/* Energy that open boundaries have brought in other than by their constraint. */
static void take_open(struct simulation *s)
{
    struct account *const a = &s->state.account;
    if (!(s->effects & FX_OPEN)) return;
    const double now = open_energy(&s->open);
    a->put[account_entry(KIND_FLUID, 0)] += now - a->open;
    a->open = now;
}

void book_open(struct simulation *s) { s->state.account.open = open_energy(&s->open); }

/* Steps and time between two checks. A check costs about two steps of a solid. */
enum { CHECK_STEPS = 32, SOLID_ONLY_CHECK_STEPS = 256 };
#define CHECK_TIME 2.5e-3

static void check_account(struct simulation *s)
{
    if (s->effects & FX_SOLID) solid_stress(&s->solid, &s->kind[KIND_SOLID]);
    s->gain = account_gain(s);
    s->checked = true;
    s->state.account.checked_at = s->state.time;
}

static bool overdue(const struct simulation *s)
{
    return s->state.time - s->state.account.checked_at >= CHECK_TIME;
}

void book_check(struct simulation *s)
{
    take_open(s);
    if (s->state.steps % CHECK_STEPS == 0 || overdue(s)) check_account(s);
}

void book_check_solid_only(struct simulation *s, int64_t steps_before)
{
    if (s->state.steps / SOLID_ONLY_CHECK_STEPS > steps_before / SOLID_ONLY_CHECK_STEPS ||
        overdue(s))
        check_account(s);
}

void book_step(struct simulation *s, double dt)
{
    struct account *const a = &s->state.account;
    struct power power[SCENE_MAX_SECTIONS];
    double delivered[SCENE_MAX_SECTIONS];
    find_powers(s, power);
    find_delivered(s, delivered);
    integrate(a, s, power, delivered, a->pending);
    note_step(a, s, power, dt);
    book_check(s);
    a->pending = 0.5 * dt;
    integrate(a, s, power, delivered, a->pending);
}

void book_restart(struct simulation *s)
{
    struct account *const a = &s->state.account;
    double lost[SCENE_MAX_SECTIONS];
    account_alternating(s, lost);
    for (int k = 0; k < s->scene->n_fluid; k++) {
        const int entry = account_entry(KIND_FLUID, k);
        a->put[entry] += lost[k];
        a->restarts[entry] += lost[k];
    }
}

void book_midpoint(struct simulation *s, double dt)
{
    struct power power[SCENE_MAX_SECTIONS];
    double delivered[SCENE_MAX_SECTIONS];
    find_powers(s, power);
    find_delivered(s, delivered);
    integrate(&s->state.account, s, power, delivered, dt);
    note_step(&s->state.account, s, power, dt);
}

void book_solid(struct simulation *s, double dt, int n, bool centred)
{
    struct account *const a = &s->state.account;
    const struct particles *const p = &s->kind[KIND_SOLID];
    const double *const *const external = s->solid.external;
    /* Work is done over the displacement by the mean velocities of the kicks (T-46c). Drifts after the
     * kicks are longer by half a kick of the change of velocity. */
    const double late = centred ? 0 : 0.5 * dt / n;
    double fluid[SCENE_MAX_SECTIONS] = {0}, outer[SCENE_MAX_SECTIONS] = {0};
    for (int64_t i = 0; i < p->n; i++) {
        if (p->free[i] == 0) continue;
        const double mass = s->solid.body[p->body[i]].mass;
        const double ux = p->ux[i] - p->x0[i] - late * (p->vx[i] - p->vx0[i]);
        const double uy = p->uy[i] - p->y0[i] - late * (p->vy[i] - p->vy0[i]);
        fluid[p->body[i]] += p->fx[i] * ux + p->fy[i] * uy;
        if (s->coupling.impedance > 0) fluid[p->body[i]] += mass * p->face_work[i]; /* T-35a */
        if (external[0]) outer[p->body[i]] += mass * (external[0][i] * ux + external[1][i] * uy);
    }
    for (int k = 0; k < s->scene->n_solid; k++) {
        account_work(a, SOURCE_FLUID, KIND_SOLID, k, fluid[k] + outer[k]);
        a->exchange[account_entry(KIND_SOLID, k)] += fluid[k];
    }
}

struct fluid_energy book_before(const struct simulation *s)
{
    const struct particles *const p = &s->kind[KIND_FLUID];
    const struct fluid_constants *const k = &s->fluid.k;
    const double *const g = s->scene->top.gravity;
    struct fluid_energy e = {{0}};
    for (int64_t i = 0; i < p->n; i++)
        e.section[p->body[i]] += (p->m ? p->m[i] : 1) * k->mass *
                                 (eos_energy(p->dens[i], k->c0) - g[0] * p->x[i] - g[1] * p->y[i]);
    return e;
}

void book_change(struct simulation *s, const struct fluid_energy *before)
{
    const struct fluid_energy after = book_before(s);
    for (int k = 0; k < s->scene->n_fluid; k++) {
        const int entry = account_entry(KIND_FLUID, k);
        const double change = after.section[k] - before->section[k];
        s->state.account.put[entry] += change;
        s->state.account.spent[entry] += change;
    }
}

/* The rates of the last step have changed the density over the whole step, and half of this is still to be
 * counted. That half will have no pressure: its work is counted here. By Verlet what is counted half a step
 * before is the mean of both solutions' (T-46f). */
void book_reset(struct simulation *s, int64_t i)
{
    const struct particles *const p = &s->kind[KIND_FLUID];
    struct account *const a = &s->state.account;
    const double c0 = s->fluid.k.c0, d = p->dens[i];
    const double rate = p->ddens_old ? p->ddens_old[i] : p->ddens[i];
    const double half = a->pending * rate * compression_rate(d, square(c0) / EOS_GAMMA);
    const double held = p->dens_old ? 0.5 * (eos_energy(d, c0) + eos_energy(p->dens_old[i], c0))
                                    : eos_energy(d, c0) - half;
    const double loss = (p->m ? p->m[i] : 1) * s->fluid.k.mass * held;
    const int entry = account_entry(KIND_FLUID, p->body[i]);
    a->put[entry] -= loss;
    a->spent[entry] -= loss;
}
