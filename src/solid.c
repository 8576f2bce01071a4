/* SPDX-License-Identifier: MIT */
#include "solid.h"

#include <math.h>
#include <string.h>

#include "contact.h"
#include "drive.h"
#include "interface.h"
#include "material.h"
#include "meeting.h"
#include "smoothing.h"
#include "solid_fx.h"
#include "solid_stencil.h"

static struct solid_body body_of(const struct scene *scene, int k)
{
    const struct scene_solid *const c = &scene->solid[k];
    const double dp = scene_solid_dp(scene, k), h = scene->numerics.h_over_dp * dp;
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
        .gravity = {on * scene->top.gravity[0], on * scene->top.gravity[1]},
        .law = c->law,
        .plane = c->plane,
        .gradient = c->gradient,
        .symmetric = c->viscosity_form == VISCOSITY_SYMMETRIC,
        .variational = c->hourglass > 0 && c->hourglass_form == HOURGLASS_VARIATIONAL,
    };
}

/* Bodies that are joined, directly or by way of others, get the number of the first of them. */
static void join_bodies(struct solid *s, const struct scene *scene, struct particles *p)
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
    if (!p->drag) return;
    for (int64_t i = 0; i < p->n; i++)
        p->drag[i] = s->body[p->body[i]].density * s->body[p->body[i]].viscosity;
}

/* All threads where each has enough packs between two barriers to outweigh them, or one: a team that shrinks
 * costs more than it saves, since libgomp ends the threads left over and starts others for the next. */
static int useful_threads(const struct solid *s)
{
    enum { PACKS_PER_THREAD = 24 };
    return s->n_packs >= (int64_t)PACKS_PER_THREAD * thread_count() ? thread_count() : 1;
}

/* Eq. 17 has no potential: its operator is not symmetric, and some shapes have modes that grow at a rate
 * that does not depend on the step (tests/stability/test_step_bound.c). */
static void warn_of_flutter(const struct solid_body *b, const char *name, struct diag *d)
{
    const bool quadratic = b->gradient == GRADIENT_QUADRATIC;
    if (b->variational || !(b->kappa > (quadratic ? 0 : 10))) return;
    diag_warn(
        d,
        "[solid %s] hourglass_form = printed with %s has growing modes at any time step%s; take "
        "hourglass_form = variational%s",
        name, quadratic ? "gradient = quadratic" : "hourglass above 10",
        quadratic ? "" : " on some shapes", quadratic ? ", or gradient = linear" : "");
}

enum err solid_create(struct solid *s, struct arena *a, const struct scene *scene,
                      struct particles *p, struct diag *d)
{
    memset(s, 0, sizeof *s);
    s->n_bodies = scene->n_solid;
    s->dp = INFINITY;
    s->coupled = p->groups & G_COUPLED;
    s->body = arena_alloc(a, (size_t)s->n_bodies, sizeof *s->body, "bodies", d);
    if (!s->body) return ERR_MEMORY;
    s->paper_step = INFINITY;
    for (int k = 0; k < s->n_bodies; k++) {
        s->body[k] = body_of(scene, k);
        warn_of_flutter(&s->body[k], scene->solid[k].common.name, d);
        s->variational |= s->body[k].variational;
        s->kelvin_voigt |= s->body[k].damping_time > 0;
        s->paper_step =
            min2(s->paper_step, 0.6 * s->body[k].h / s->body[k].sound_speed); /* Eq. 29 */
        s->dp = min2(s->dp, s->body[k].dp);
    }
    join_bodies(s, scene, p);
    TRY(solid_stencil_create(s, a, p, d));
    for (int k = 0; k < s->n_bodies; k++)
        if (scene->solid[k].joined[0] && !s->body[k].touches)
            return diag_fail(d, ERR_INPUT,
                             "[solid %s] is joined to [solid %s], but lies more than 2 h = %g m "
                             "away from it",
                             scene->solid[k].common.name, scene->solid[k].joined,
                             KERNEL_REACH * s->body[k].h);
    for (int k = 0; k < (int)COUNT_OF(s->scratch); k++) {
        s->scratch[k] = arena_alloc(a, (size_t)p->n, sizeof(double), "search of the step", d);
        if (!s->scratch[k]) return ERR_MEMORY;
    }
    s->meeting = arena_alloc(a, 1, sizeof *s->meeting, "meeting point of the threads", d);
    if (!s->meeting) return ERR_MEMORY;
    s->threads = useful_threads(s);
    return ERR_OK;
}

/* Writes the first `lanes` lanes only: the rest belongs to the next pack. */
SPHFSI_INLINE void store_lanes(double *to, vdouble value, int lanes)
{
    if (lanes == LANES_DOUBLE) {
        vstore_double(to, value);
        return;
    }
    for (int l = 0; l < lanes; l++) to[l] = value[l];
}

/* Eq. 13b for any field (u, v), such as the displacement: U = F - I = sum of (u_b - u_a) G_ab^T. */
SPHFSI_INLINE struct vtensor2 gradient_of(const struct solid *s, const struct solid_pack *pack,
                                          const double *u, const double *v)
{
    const vdouble ux = vload_double(&u[pack->i]), uy = vload_double(&v[pack->i]);
    struct vtensor2 sum = {vset_double(0), vset_double(0), vset_double(0), vset_double(0)};
    const struct solid_slot *const end = s->slot + pack->first_slot + pack->n_slots;
    for (const struct solid_slot *slot = s->slot + pack->first_slot; slot < end; slot++) {
        const int64_t j = pack->i + slot->offset;
        const vdouble Gx = vload_double(slot->Gx), Gy = vload_double(slot->Gy);
        const vdouble dx = vload_double(&u[j]) - ux, dy = vload_double(&v[j]) - uy;
        sum.xx = vfma_double(dx, Gx, sum.xx);
        sum.xy = vfma_double(dx, Gy, sum.xy);
        sum.yx = vfma_double(dy, Gx, sum.yx);
        sum.yy = vfma_double(dy, Gy, sum.yy);
    }
    return sum;
}

static void stress_of_pack(const struct solid *s, const struct solid_pack *pack,
                           struct particles *p)
{
    const int64_t i = pack->i;
    const struct vtensor2 U = gradient_of(s, pack, p->ux, p->uy);
    const struct vtensor2 P = material_pk1(&s->body[pack->body], U);
    store_lanes(&p->Uxx[i], U.xx, pack->lanes);
    store_lanes(&p->Uxy[i], U.xy, pack->lanes);
    store_lanes(&p->Uyx[i], U.yx, pack->lanes);
    store_lanes(&p->Uyy[i], U.yy, pack->lanes);
    store_lanes(&p->Pxx[i], P.xx, pack->lanes);
    store_lanes(&p->Pxy[i], P.xy, pack->lanes);
    store_lanes(&p->Pyx[i], P.yx, pack->lanes);
    store_lanes(&p->Pyy[i], P.yy, pack->lanes);
}

/* Kelvin and Voigt: beside the elastic second Piola-Kirchhoff stress a viscous one, tau C : dE/dt with the
 * tangent C of Eq. 10, dE/dt = sym(F^T dF/dt) and dF/dt = sum of (v_b - v_a) G_ab^T. P gains F times it. */
static void damping_stress(const struct solid *s, const struct solid_pack *pack,
                           struct particles *p)
{
    const struct solid_body *const body = &s->body[pack->body];
    const int64_t i = pack->i;
    const struct vtensor2 F = deformation(load_gradient(p, i));
    const struct vtensor2 rate = gradient_of(s, pack, p->vx, p->vy);
    const vdouble shear = (F.xx * rate.xy + F.yx * rate.yy + F.xy * rate.xx + F.yy * rate.yx) * 0.5;
    const struct vtensor2 strain_rate = {F.xx * rate.xx + F.yx * rate.yx, shear, shear,
                                         F.xy * rate.xy + F.yy * rate.yy};
    const double tau = body->damping_time;
    const struct vtensor2 P =
        vtensor2_mul(F, hooke(strain_rate, tau * plane_lambda(body), tau * body->mu));
    store_lanes(&p->Pxx[i], vload_double(&p->Pxx[i]) + P.xx, pack->lanes);
    store_lanes(&p->Pxy[i], vload_double(&p->Pxy[i]) + P.xy, pack->lanes);
    store_lanes(&p->Pyx[i], vload_double(&p->Pyx[i]) + P.yx, pack->lanes);
    store_lanes(&p->Pyy[i], vload_double(&p->Pyy[i]) + P.yy, pack->lanes);
}

/* What the loop over the slots of a pack sums; constants where it is inlined. */
struct slot_laws {
    bool stress, viscous, mixed, symmetric, hourglass, variational;
};

SPHFSI_INLINE struct solid_sums sum_slots(const struct solid *s, const struct solid_pack *pack,
                                          const struct particles *p, const struct solid_receiver *a,
                                          struct slot_laws laws)
{
    const struct solid_body *const body = &s->body[pack->body];
    const vdouble eta2 = vset_double(0.01 * body->h * body->h), zero = vset_double(0);
    struct solid_sums sums = {zero, zero, zero,
                              zero, zero, zero,
                              zero, zero, {zero, zero, zero, zero}};
    const struct solid_slot *const end = s->slot + pack->first_slot + pack->n_slots;
    for (const struct solid_slot *slot = s->slot + pack->first_slot; slot < end; slot++) {
        if (laws.stress) stress_force(slot, p, pack->i + slot->offset, &sums);
        if (!laws.viscous && !laws.hourglass) continue;
        struct solid_pair q = pair_of(slot, p, pack->i, a);
        if (laws.hourglass || laws.symmetric) q.U_b = load_gradient(p, q.j);
        if (laws.viscous) {
            vdouble Pi = viscous_pressure(&q, p, a, eta2);
            if (laws.mixed) Pi = Pi * mean_viscosity(&q, p, pack->i, body);
            viscous_force(&q, Pi, laws.symmetric, &sums);
        }
        if (laws.hourglass && laws.variational) hourglass_variational(&q, a, &sums);
        if (laws.hourglass && !laws.variational) hourglass_printed(&q, a, &sums);
    }
    return sums;
}

/* What a body has beside its stress. */
static struct slot_laws pair_laws(const struct solid_body *body)
{
    return (struct slot_laws){.viscous = body->viscosity > 0 || body->mixed,
                              .mixed = body->mixed,
                              .symmetric = body->symmetric,
                              .hourglass = body->kappa > 0,
                              .variational = body->variational};
}

/* Acceleration by the forces of pairs: the viscous one turned by J F^-T, and that of hourglass control. */
SPHFSI_INLINE void pairs_acceleration(const struct solid_body *body, const struct solid_receiver *a,
                                      const struct solid_sums *s, vdouble acc[2])
{
    const struct vtensor2 cof = vtensor2_cof(deformation(a->U));
    const double viscosity = (body->mixed ? 1 : body->viscosity) * (body->symmetric ? 0.5 : 1);
    acc[0] = s->ax + (cof.xx * s->viscous_x + cof.xy * s->viscous_y + s->turned_x) * viscosity;
    acc[1] = s->ay + (cof.yx * s->viscous_x + cof.yy * s->viscous_y + s->turned_y) * viscosity;
}

/* Of a body with the variational form: it adds to the stress, which has to be whole before neighbours sum
 * it, so that pairs have a pass of their own. */
static void pairs_of_pack(const struct solid *s, const struct solid_pack *pack, struct particles *p)
{
    const struct solid_body *const body = &s->body[pack->body];
    const int64_t i = pack->i;
    const struct solid_receiver a = receiver_of(p, i);
    const struct slot_laws laws = pair_laws(body);
    struct solid_sums sums;
    /* The default is stamped; the others are decided as they go. */
    if (laws.viscous && laws.symmetric && !laws.mixed)
        sums = sum_slots(s, pack, p, &a, (struct slot_laws){false, true, false, true, true, true});
    else
        sums = sum_slots(s, pack, p, &a, laws);
    vdouble acc[2];
    pairs_acceleration(body, &a, &sums, acc);
    store_lanes(&p->pairs_x[i], acc[0], pack->lanes);
    store_lanes(&p->pairs_y[i], acc[1], pack->lanes);
    const double half = 0.5 * body->density;
    store_lanes(&p->Pxx[i], vload_double(&p->Pxx[i]) + sums.pull.xx * half, pack->lanes);
    store_lanes(&p->Pxy[i], vload_double(&p->Pxy[i]) + sums.pull.xy * half, pack->lanes);
    store_lanes(&p->Pyx[i], vload_double(&p->Pyx[i]) + sums.pull.yx * half, pack->lanes);
    store_lanes(&p->Pyy[i], vload_double(&p->Pyy[i]) + sums.pull.yy * half, pack->lanes);
}

/* Acceleration by stress and the forces of pairs. */
static void own_acceleration(const struct solid *s, const struct solid_pack *pack,
                             const struct particles *p, vdouble acc[2])
{
    const struct solid_body *const body = &s->body[pack->body];
    const int64_t i = pack->i;
    const struct solid_receiver a = receiver_of(p, i);
    struct slot_laws laws = pair_laws(body);
    laws.stress = true;
    struct solid_sums sums;
    if (laws.variational) {
        sums = sum_slots(s, pack, p, &a, (struct slot_laws){.stress = true});
        acc[0] = vload_double(&p->pairs_x[i]);
        acc[1] = vload_double(&p->pairs_y[i]);
    } else {
        /* The paper's combination is stamped. */
        if (laws.viscous && laws.hourglass && !laws.symmetric && !laws.mixed)
            sums = sum_slots(s, pack, p, &a,
                             (struct slot_laws){true, true, false, false, true, false});
        else
            sums = sum_slots(s, pack, p, &a, laws);
        pairs_acceleration(body, &a, &sums, acc);
    }
    /* Eq. 13a: the own part of the stress is P_a times the sum of G_ab, which vanishes inside a lattice. */
    const vdouble Gx = vload_double(&p->Gx[i]), Gy = vload_double(&p->Gy[i]);
    const vdouble own_x = vfma_double(vload_double(&p->Pxx[i]), Gx, vload_double(&p->Pxy[i]) * Gy);
    const vdouble own_y = vfma_double(vload_double(&p->Pyx[i]), Gx, vload_double(&p->Pyy[i]) * Gy);
    const double inv_density = 1 / body->density;
    acc[0] = (sums.stress_x + own_x) * inv_density + acc[0];
    acc[1] = (sums.stress_y + own_y) * inv_density + acc[1];
}

static void forces_of_pack(const struct solid *s, const struct solid_pack *pack,
                           struct particles *p)
{
    const struct solid_body *const body = &s->body[pack->body];
    const int64_t i = pack->i;
    vdouble acc[2];
    own_acceleration(s, pack, p, acc);
    if (s->coupled) {
        acc[0] = acc[0] + vload_double(&p->fx[i]) * (1 / body->mass);
        acc[1] = acc[1] + vload_double(&p->fy[i]) * (1 / body->mass);
    }
    if (s->push[0]) {
        acc[0] = acc[0] + vload_double(&s->push[0][i]);
        acc[1] = acc[1] + vload_double(&s->push[1][i]);
    }
    const vdouble moves = vload_double(&p->free[i]);
    store_lanes(&p->sx[i], (acc[0] + body->gravity[0]) * moves, pack->lanes);
    store_lanes(&p->sy[i], (acc[1] + body->gravity[1]) * moves, pack->lanes);
}

/* The loops over packs, for use inside a parallel region: each ends with all threads together. */
static void stress_loop(const struct solid *s, struct particles *p)
{
#pragma omp for schedule(static) nowait
    for (int64_t k = 0; k < s->n_packs; k++) stress_of_pack(s, &s->pack[k], p);
    meet(s->meeting);
    if (s->kelvin_voigt) {
#pragma omp for schedule(static) nowait
        for (int64_t k = 0; k < s->n_packs; k++)
            if (s->body[s->pack[k].body].damping_time > 0) damping_stress(s, &s->pack[k], p);
        meet(s->meeting);
    }
    if (s->variational) {
#pragma omp for schedule(static) nowait
        for (int64_t k = 0; k < s->n_packs; k++)
            if (s->body[s->pack[k].body].variational) pairs_of_pack(s, &s->pack[k], p);
        meet(s->meeting);
    }
}

static void forces_loop(const struct solid *s, struct particles *p)
{
#pragma omp for schedule(static) nowait
    for (int64_t k = 0; k < s->n_packs; k++) forces_of_pack(s, &s->pack[k], p);
    meet(s->meeting);
}

/* What acts on the solid from outside, each a pass of its own. */
static void outer_forces(const struct solid *s, struct particles *p, double time)
{
    if (s->contact) {
        const double start = wall_clock();
        contact_forces(s->contact, s, p, time);
#pragma omp master
        s->contact->seconds += wall_clock() - start;
    }
    if (s->drive) {
#pragma omp single
        drive_forces(s->drive, s, p, time);
    }
}

static void kick_and_drift(const struct solid *s, struct particles *p, double kick, double drift)
{
#pragma omp for simd schedule(static) nowait
    for (int64_t i = 0; i < p->n; i++) {
        p->vx[i] += kick * p->sx[i];
        p->vy[i] += kick * p->sy[i];
        p->ux[i] += drift * p->vx[i];
        p->uy[i] += drift * p->vy[i];
    }
    meet(s->meeting);
}

void solid_stress(const struct solid *s, struct particles *p)
{
#pragma omp parallel num_threads(s->threads)
    stress_loop(s, p);
}

void solid_forces(const struct solid *s, struct particles *p)
{
#pragma omp parallel num_threads(s->threads)
    {
        forces_loop(s, p);
        outer_forces(s, p, s->time);
    }
}

void solid_book_work(struct solid *s, const struct particles *p, const double *vx, const double *vy,
                     double dt)
{
    if (s->contact) s->work += dt * contact_power(s->contact);
    if (s->drive) s->work += drive_work(s->drive, p, vx, vy, dt);
}

void solid_place_driven(const struct solid *s, struct particles *p, double time)
{
    if (s->drive) drive_place(s->drive, p, time);
}

/* Between the sub-steps: all threads together. */
static void place_driven(const struct solid *s, struct particles *p, double time)
{
    if (!s->drive) return;
#pragma omp single
    drive_place(s->drive, p, time);
}

static void book_work(struct solid *s, const struct particles *p, double dt)
{
    if (!s->contact && !s->drive) return;
#pragma omp single
    solid_book_work(s, p, p->vx, p->vy, dt);
}

void solid_advance(struct solid *s, struct particles *p, double dt, int n, bool centred)
{
    const double first = centred ? 0.5 * dt : 0;
#pragma omp parallel num_threads(s->threads)
    {
        if (s->impedance > 0) interface_return(p, n * dt);
        if (centred) {
            kick_and_drift(s, p, 0, first);
            place_driven(s, p, s->time + first);
        }
        for (int k = 0; k < n; k++) {
            stress_loop(s, p);
            forces_loop(s, p);
            outer_forces(s, p, s->time + k * dt + first);
            book_work(s, p, dt);
            const double drift = k + 1 < n ? dt : dt - first;
            kick_and_drift(s, p, dt, s->impedance > 0 ? 0 : drift);
            if (s->impedance > 0) {
                interface_answer(s, p, dt);
                kick_and_drift(s, p, 0, drift);
            }
            place_driven(s, p, k + 1 < n ? s->time + (k + 1) * dt + first : s->time + n * dt);
        }
    }
    s->time += n * dt;
}

/* Energy of the hourglass force of a pack, J/m, half of it since each pair is met twice. Variational: the
 * sum of k |e|^2/2. The printed force has no potential, since it leaves out how e_ab depends on F: half of
 * force times stretch of the pair, which is the work it takes for small strains. */
static vdouble hourglass_energy(const struct solid *s, const struct solid_pack *pack,
                                const struct particles *p)
{
    const struct solid_receiver a = receiver_of(p, pack->i);
    vdouble sum = vset_double(0);
    for (int m = pack->first_slot; m < pack->first_slot + pack->n_slots; m++) {
        const struct solid_slot *const slot = &s->slot[m];
        struct solid_pair q = pair_of(slot, p, pack->i, &a);
        q.U_b = load_gradient(p, q.j);
        vdouble ex, ey;
        hourglass_error(&q, &a, &ex, &ey);
        if (s->body[pack->body].variational) {
            sum = sum + 0.5 * vload_double(slot->half_k) * (ex * ex + ey * ey);
            continue;
        }
        const vdouble x2 = q.x * q.x + q.y * q.y, x = vsqrt_double(x2),
                      X = vsqrt_double(q.X * q.X + q.Y * q.Y);
        const vdouble stretch = ((2.0 * q.X + q.ux) * q.ux + (2.0 * q.Y + q.uy) * q.uy) / (x + X);
        sum = sum - vload_double(slot->half_k) * (ex * q.x + ey * q.y) / x * stretch;
    }
    return sum * (0.25 * s->body[pack->body].mass);
}

void solid_energy(const struct solid *s, const struct particles *p, int body, double *elastic,
                  double *hourglass, double *det_low)
{
    *elastic = *hourglass = 0;
    *det_low = INFINITY;
    for (int64_t k = 0; k < s->n_packs; k++) {
        const struct solid_pack *const pack = &s->pack[k];
        if (body != SOLID_ALL && pack->body != body) continue;
        const struct solid_body *const b = &s->body[pack->body];
        const struct vtensor2 U = load_gradient(p, pack->i);
        const vdouble stored = material_energy(b, U), det = vtensor2_det(deformation(U));
        const vdouble locked = b->kappa > 0 ? hourglass_energy(s, pack, p) : vset_double(0);
        for (int l = 0; l < pack->lanes; l++) {
            *elastic += stored[l] * square(b->dp);
            *hourglass += locked[l];
            if (!(det[l] >= *det_low)) *det_low = det[l];
        }
    }
}
