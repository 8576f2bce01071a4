/* SPDX-License-Identifier: MIT */
#include "solid.h"

#include <math.h>
#include <string.h>

#include "material.h"
#include "smoothing.h"
#include "solid_stencil.h"

static struct solid_body body_of(const struct scene *scene, const struct scene_solid *c, double h)
{
    const double E = c->young, nu = c->poisson;
    const double bulk = E / (3 * (1 - 2 * nu));
    const double on = c->gravity ? 1 : 0;
    return (struct solid_body){
        .lambda = E * nu / ((1 + nu) * (1 - 2 * nu)),
        .mu = E / (2 * (1 + nu)),
        .density = c->density,
        .young = E,
        .mass = c->density * square(scene->top.dp),
        .sound_speed = sqrt(bulk / c->density), /* Eq. 29 */
        .viscosity = c->artificial_viscosity * sqrt(bulk / c->density) * h,
        .kappa = c->hourglass,
        .gravity = {on * scene->top.gravity[0], on * scene->top.gravity[1]},
        .law = c->law,
        .plane = c->plane,
        .symmetric = c->viscosity_form == VISCOSITY_SYMMETRIC,
    };
}

enum err solid_create(struct solid *s, struct arena *a, const struct scene *scene, struct particles *p,
                      struct diag *d)
{
    memset(s, 0, sizeof *s);
    s->n_bodies = scene->n_solid;
    s->h = scene->h;
    s->dp = scene->top.dp;
    s->coupled = p->groups & G_COUPLED;
    s->body = arena_alloc(a, (size_t)s->n_bodies, sizeof *s->body, "bodies", d);
    if (!s->body) return ERR_MEMORY;
    s->paper_step = INFINITY;
    for (int k = 0; k < s->n_bodies; k++) {
        s->body[k] = body_of(scene, &scene->solid[k], s->h);
        s->paper_step = min2(s->paper_step, 0.6 * s->h / s->body[k].sound_speed); /* Eq. 29 */
    }
    return solid_stencil_create(s, a, p, d);
}

/* Writes the first `lanes` lanes only: the rest belongs to the next pack. */
SPHFSI_INLINE void store_lanes(double *to, vwide value, int lanes)
{
    if (lanes == LANES_WIDE) {
        vstore_wide(to, value);
        return;
    }
    for (int l = 0; l < lanes; l++)
        to[l] = value[l];
}

/* L^-1 of the particles of a pack. */
SPHFSI_INLINE struct vtensor2 correction(const struct particles *p, int64_t i)
{
    const vwide xy = vload_wide(&p->Lxy[i]);
    return (struct vtensor2){vload_wide(&p->Lxx[i]), xy, xy, vload_wide(&p->Lyy[i])};
}

SPHFSI_INLINE struct vtensor2 load_gradient(const struct particles *p, int64_t i)
{
    return (struct vtensor2){vload_wide(&p->Uxx[i]), vload_wide(&p->Uxy[i]), vload_wide(&p->Uyx[i]),
                             vload_wide(&p->Uyy[i])};
}

/* Eq. 13b in displacements: U = F - I = sum of V_b (u_b - u_a) (L^-1 grad_0 W)^T. */
SPHFSI_INLINE struct vtensor2 displacement_gradient(const struct solid *s, const struct solid_pack *pack,
                                                    const struct particles *p)
{
    const vwide ux = vload_wide(&p->ux[pack->i]), uy = vload_wide(&p->uy[pack->i]);
    struct vtensor2 sum = {vset_wide(0), vset_wide(0), vset_wide(0), vset_wide(0)};
    const struct solid_slot *const end = s->slot + pack->first_slot + pack->n_slots;
    for (const struct solid_slot *slot = s->slot + pack->first_slot; slot < end; slot++) {
        const int64_t j = pack->i + slot->offset;
        const vwide gx = vload_wide(slot->gx), gy = vload_wide(slot->gy);
        const vwide dx = vload_wide(&p->ux[j]) - ux, dy = vload_wide(&p->uy[j]) - uy;
        sum.xx = vfma_wide(dx, gx, sum.xx);
        sum.xy = vfma_wide(dx, gy, sum.xy);
        sum.yx = vfma_wide(dy, gx, sum.yx);
        sum.yy = vfma_wide(dy, gy, sum.yy);
    }
    return vtensor2_mul(sum, correction(p, pack->i));
}

static void stress_of_pack(const struct solid *s, const struct solid_pack *pack, struct particles *p)
{
    const int64_t i = pack->i;
    const struct vtensor2 U = displacement_gradient(s, pack, p);
    const struct vtensor2 A = vtensor2_mul(material_pk1(&s->body[pack->body], U), correction(p, i));
    store_lanes(&p->Uxx[i], U.xx, pack->lanes);
    store_lanes(&p->Uxy[i], U.xy, pack->lanes);
    store_lanes(&p->Uyx[i], U.yx, pack->lanes);
    store_lanes(&p->Uyy[i], U.yy, pack->lanes);
    store_lanes(&p->Axx[i], A.xx, pack->lanes);
    store_lanes(&p->Axy[i], A.xy, pack->lanes);
    store_lanes(&p->Ayx[i], A.yx, pack->lanes);
    store_lanes(&p->Ayy[i], A.yy, pack->lanes);
}

/* Particles a of a pack, as the pair laws see them. */
struct solid_receiver {
    vwide ux, uy, vx, vy;
    struct vtensor2 U, A; /* displacement gradient; P L^-1 */
    struct vtensor2 B;    /* J F^-T L^-1 of Eq. 14a */
};

/* J F^-T L^-1, the tensor of the viscous force (Eqs. 14a, 13a). */
SPHFSI_INLINE struct vtensor2 viscous_tensor(const struct particles *p, int64_t i, struct vtensor2 U)
{
    return vtensor2_mul(vtensor2_cof(deformation(U)), correction(p, i));
}

/* One slot's pairs: neighbours b and geometry. */
struct solid_pair {
    int64_t j;
    vwide gx, gy, X, Y, x, y; /* x_ab = X_ab + u_ab */
    vwide ux, uy;             /* u_ab */
    struct vtensor2 U_b;
};

SPHFSI_INLINE struct solid_pair pair_of(const struct solid_slot *slot, const struct particles *p, int64_t i,
                                        const struct solid_receiver *a)
{
    struct solid_pair q = {.j = i + slot->offset};
    q.gx = vload_wide(slot->gx);
    q.gy = vload_wide(slot->gy);
    q.X = vload_wide(slot->X);
    q.Y = vload_wide(slot->Y);
    q.ux = a->ux - vload_wide(&p->ux[q.j]);
    q.uy = a->uy - vload_wide(&p->uy[q.j]);
    q.x = q.X + q.ux;
    q.y = q.Y + q.uy;
    return q;
}

/* Eq. 13a: (P_a L_a^-1 + P_b L_b^-1) V_b grad_0 W. */
SPHFSI_INLINE void stress_force(const struct solid_pair *q, const struct particles *p,
                                const struct solid_receiver *a, vwide *fx, vwide *fy)
{
    const vwide xx = a->A.xx + vload_wide(&p->Axx[q->j]), xy = a->A.xy + vload_wide(&p->Axy[q->j]);
    const vwide yx = a->A.yx + vload_wide(&p->Ayx[q->j]), yy = a->A.yy + vload_wide(&p->Ayy[q->j]);
    *fx = vfma_wide(xx, q->gx, vfma_wide(xy, q->gy, *fx));
    *fy = vfma_wide(yx, q->gx, vfma_wide(yy, q->gy, *fy));
}

/* Eq. 14, over rho0: Pi_ab (J F^-T)_a L_a^-1 V_b grad_0 W for approaching pairs; in the symmetric form
 * with the mean of both particles' tensors, which makes it antisymmetric. */
SPHFSI_INLINE void viscous_force(const struct solid_pair *q, const struct particles *p,
                                 const struct solid_receiver *a, const struct solid_body *body, vwide eta2,
                                 vwide *fx, vwide *fy)
{
    const vwide vx = (a->vx - vload_wide(&p->vx[q->j])) * q->x + (a->vy - vload_wide(&p->vy[q->j])) * q->y;
    const vwide r2 = q->x * q->x + q->y * q->y;
    const vwide Pi = vmin_wide(vx, vset_wide(0)) * body->viscosity / (r2 + eta2);
    struct vtensor2 B = a->B;
    if (body->symmetric) {
        const struct vtensor2 B_b = viscous_tensor(p, q->j, q->U_b);
        B = (struct vtensor2){(B.xx + B_b.xx) * 0.5, (B.xy + B_b.xy) * 0.5, (B.yx + B_b.yx) * 0.5,
                              (B.yy + B_b.yy) * 0.5};
    }
    *fx = vfma_wide(Pi, vfma_wide(B.xx, q->gx, B.xy * q->gy), *fx);
    *fy = vfma_wide(Pi, vfma_wide(B.yx, q->gx, B.yy * q->gy), *fy);
}

/* Eqs. 15-16: e_ab = (F_a + F_b) X_ab/2 - x_ab, in displacements. */
SPHFSI_INLINE void hourglass_error(const struct solid_pair *q, const struct solid_receiver *a, vwide *ex,
                                   vwide *ey)
{
    *ex = ((a->U.xx + q->U_b.xx) * q->X + (a->U.xy + q->U_b.xy) * q->Y) * 0.5 - q->ux;
    *ey = ((a->U.yx + q->U_b.yx) * q->X + (a->U.yy + q->U_b.yy) * q->Y) * 0.5 - q->uy;
}

/* Eq. 17, over the mass of a: a force along x_ab. */
SPHFSI_INLINE void hourglass_force(const struct solid_pair *q, const struct solid_receiver *a, vwide stiffness,
                                   vwide *fx, vwide *fy)
{
    vwide ex, ey;
    hourglass_error(q, a, &ex, &ey);
    const vwide along = stiffness * vfma_wide(ex, q->x, ey * q->y) / vfma_wide(q->x, q->x, q->y * q->y);
    *fx = vfma_wide(along, q->x, *fx);
    *fy = vfma_wide(along, q->y, *fy);
}

SPHFSI_INLINE struct solid_receiver receiver_of(const struct particles *p, int64_t i)
{
    const struct vtensor2 U = load_gradient(p, i);
    return (struct solid_receiver){
        .ux = vload_wide(&p->ux[i]),
        .uy = vload_wide(&p->uy[i]),
        .vx = vload_wide(&p->vx[i]),
        .vy = vload_wide(&p->vy[i]),
        .U = U,
        .A = {vload_wide(&p->Axx[i]), vload_wide(&p->Axy[i]), vload_wide(&p->Ayx[i]),
              vload_wide(&p->Ayy[i])},
        .B = viscous_tensor(p, i, U),
    };
}

/* Sums of a pack; `viscous` and `hourglass` are constants where it is inlined. */
SPHFSI_INLINE void forces_of_slots(const struct solid *s, const struct solid_pack *pack,
                                   const struct particles *p, bool viscous, bool hourglass, vwide acc[2])
{
    const struct solid_body *const body = &s->body[pack->body];
    const struct solid_receiver a = receiver_of(p, pack->i);
    const vwide eta2 = vset_wide(0.01 * s->h * s->h);
    vwide sx = vset_wide(0), sy = vset_wide(0); /* stress, Pa/m */
    vwide ex = vset_wide(0), ey = vset_wide(0); /* viscous and hourglass, m/s^2 */
    const struct solid_slot *const end = s->slot + pack->first_slot + pack->n_slots;
    for (const struct solid_slot *slot = s->slot + pack->first_slot; slot < end; slot++) {
        struct solid_pair q = pair_of(slot, p, pack->i, &a);
        stress_force(&q, p, &a, &sx, &sy);
        if (hourglass || body->symmetric) q.U_b = load_gradient(p, q.j);
        if (viscous) viscous_force(&q, p, &a, body, eta2, &ex, &ey);
        if (hourglass) hourglass_force(&q, &a, vload_wide(slot->hourglass), &ex, &ey);
    }
    const double inv_density = 1 / body->density;
    acc[0] = sx * inv_density + ex;
    acc[1] = sy * inv_density + ey;
}

static void forces_of_pack(const struct solid *s, const struct solid_pack *pack, struct particles *p)
{
    const struct solid_body *const body = &s->body[pack->body];
    const int64_t i = pack->i;
    vwide acc[2];
    const bool viscous = body->viscosity > 0, hourglass = body->kappa > 0;
    if (viscous && hourglass)
        forces_of_slots(s, pack, p, true, true, acc);
    else
        forces_of_slots(s, pack, p, viscous, hourglass, acc);
    if (s->coupled) {
        acc[0] = acc[0] + vload_wide(&p->fx[i]) * (1 / body->mass);
        acc[1] = acc[1] + vload_wide(&p->fy[i]) * (1 / body->mass);
    }
    const vwide moves = vload_wide(&p->free[i]);
    store_lanes(&p->sx[i], (acc[0] + body->gravity[0]) * moves, pack->lanes);
    store_lanes(&p->sy[i], (acc[1] + body->gravity[1]) * moves, pack->lanes);
}

/* The loops over packs, for use inside a parallel region: each ends with all threads together. */
static void stress_loop(const struct solid *s, struct particles *p)
{
#pragma omp for schedule(static)
    for (int64_t k = 0; k < s->n_packs; k++)
        stress_of_pack(s, &s->pack[k], p);
}

static void forces_loop(const struct solid *s, struct particles *p)
{
#pragma omp for schedule(static)
    for (int64_t k = 0; k < s->n_packs; k++)
        forces_of_pack(s, &s->pack[k], p);
}

static void kick_and_drift(struct particles *p, double kick, double drift)
{
#pragma omp for schedule(static)
    for (int64_t i = 0; i < p->n; i++) {
        p->vx[i] += kick * p->sx[i];
        p->vy[i] += kick * p->sy[i];
        p->ux[i] += drift * p->vx[i];
        p->uy[i] += drift * p->vy[i];
    }
}

void solid_stress(const struct solid *s, struct particles *p)
{
#pragma omp parallel
    stress_loop(s, p);
}

void solid_forces(const struct solid *s, struct particles *p)
{
#pragma omp parallel
    forces_loop(s, p);
}

void solid_advance(const struct solid *s, struct particles *p, double dt, int n, bool centred)
{
    const double first = centred ? 0.5 * dt : 0;
#pragma omp parallel
    {
        if (centred) kick_and_drift(p, 0, first);
        for (int k = 0; k < n; k++) {
            stress_loop(s, p);
            forces_loop(s, p);
            kick_and_drift(p, dt, k + 1 < n ? dt : dt - first);
        }
    }
}

void solid_cauchy(const struct solid *s, const struct particles *p, int64_t i, double sigma[4], double *det)
{
    const struct solid_body *const b = &s->body[p->body[i]];
    const struct vtensor2 U = {vset_wide(p->Uxx[i]), vset_wide(p->Uxy[i]), vset_wide(p->Uyx[i]),
                               vset_wide(p->Uyy[i])};
    const struct vtensor2 F = deformation(U);
    double thickness, sigma_zz;
    material_across(b, U, &thickness, &sigma_zz);
    const struct vtensor2 PF = vtensor2_mul_t(material_pk1(b, U), F);
    const double J = vtensor2_det(F)[0] * thickness;
    sigma[0] = PF.xx[0] / J;
    sigma[1] = PF.yy[0] / J;
    sigma[2] = 0.5 * (PF.xy[0] + PF.yx[0]) / J;
    sigma[3] = sigma_zz;
    *det = J;
}

/* Energy of the hourglass force of a pack, J/m: half of force (Eq. 17) times the stretch of the pair, and
 * half of that since each pair is met twice. The force has no potential of its own, since it leaves out
 * how e_ab depends on F; for small strains this is the work it takes. */
static vwide hourglass_energy(const struct solid *s, const struct solid_pack *pack, const struct particles *p)
{
    const struct solid_receiver a = receiver_of(p, pack->i);
    vwide sum = vset_wide(0);
    for (int m = pack->first_slot; m < pack->first_slot + pack->n_slots; m++) {
        const struct solid_slot *const slot = &s->slot[m];
        struct solid_pair q = pair_of(slot, p, pack->i, &a);
        q.U_b = load_gradient(p, q.j);
        vwide ex, ey;
        hourglass_error(&q, &a, &ex, &ey);
        const vwide x2 = q.x * q.x + q.y * q.y, x = vsqrt_wide(x2), X = vsqrt_wide(q.X * q.X + q.Y * q.Y);
        const vwide stretch = ((2.0 * q.X + q.ux) * q.ux + (2.0 * q.Y + q.uy) * q.uy) / (x + X);
        sum = sum - vload_wide(slot->hourglass) * (ex * q.x + ey * q.y) / x * stretch;
    }
    return sum * (0.25 * s->body[pack->body].mass);
}

void solid_energy(const struct solid *s, const struct particles *p, double *elastic, double *hourglass,
                  double *det_low)
{
    *elastic = *hourglass = 0;
    *det_low = INFINITY;
    for (int64_t k = 0; k < s->n_packs; k++) {
        const struct solid_pack *const pack = &s->pack[k];
        const struct solid_body *const b = &s->body[pack->body];
        const struct vtensor2 U = load_gradient(p, pack->i);
        const vwide stored = material_energy(b, U), det = vtensor2_det(deformation(U));
        const vwide locked = b->kappa > 0 ? hourglass_energy(s, pack, p) : vset_wide(0);
        for (int l = 0; l < pack->lanes; l++) {
            *elastic += stored[l] * square(s->dp);
            *hourglass += locked[l];
            *det_low = min2(*det_low, det[l]);
        }
    }
}
