/* SPDX-License-Identifier: MIT
 * The sweeps of the solid for both precisions: solid/sweep_mixed.c and solid/sweep_double.c include
 * this file after base/real_float.h and base/real_double.h. A pack of particles goes through its
 * slots, one neighbour per lane at a time. Each particle is written by its own pack only. */
#include "solid/pair_laws.h"

/* Writes the lanes of a pack only: the memory behind it belongs to the next. */
SPHFSI_INLINE void store_packed(const struct solid *solid, int field, const struct solid_pack *pack,
                                vreal value)
{
    vput((real *)solid->packed[field] + pack->i, value, pack->lanes);
}

/* Four components from `field` on. The last pack of a body is stored in a function of its
 * own, which leaves the registers of the others alone. */
static __attribute__((noinline, cold)) void store_part(const struct solid *solid, int field,
                                                       const struct solid_pack *pack,
                                                       const struct vtensor2 *t)
{
    store_packed(solid, field, pack, t->xx);
    store_packed(solid, field + 1, pack, t->xy);
    store_packed(solid, field + 2, pack, t->yx);
    store_packed(solid, field + 3, pack, t->yy);
}

SPHFSI_INLINE void store_tensor(const struct solid *solid, int field, const struct solid_pack *pack,
                                struct vtensor2 t)
{
    if (pack->lanes < LANES) {
        const struct vtensor2 part = t;
        store_part(solid, field, pack, &part);
        return;
    }
    vstore((real *)solid->packed[field] + pack->i, t.xx);
    vstore((real *)solid->packed[field + 1] + pack->i, t.xy);
    vstore((real *)solid->packed[field + 2] + pack->i, t.yx);
    vstore((real *)solid->packed[field + 3] + pack->i, t.yy);
}

/* Adds a part to the stress of a pack. */
SPHFSI_INLINE void add_stress(const struct solid *solid, const struct solid_pack *pack,
                              struct vtensor2 more)
{
    const int64_t i = pack->i;
    store_tensor(solid, S_PXX, pack,
                 (struct vtensor2){packed_of(solid, S_PXX, i) + more.xx,
                                   packed_of(solid, S_PXY, i) + more.xy,
                                   packed_of(solid, S_PYX, i) + more.yx,
                                   packed_of(solid, S_PYY, i) + more.yy});
}

/* The slots of a pack: the weights of all slots in order, and the indices of its neighbours. */
#define SLOT_SIZE (SOLID_WEIGHTS * LANES)
#define EACH_SLOT(s, pack, slot, j)                                                         \
    const real *slot = (const real *)(s)->weight + (size_t)(pack)->first_slot * SLOT_SIZE;  \
    const int64_t *offset = (s)->offset + (pack)->first_slot, *const end =                  \
                                                                  offset + (pack)->n_slots; \
    for (int64_t j; offset < end && (j = (pack)->i + *offset, true); offset++, slot += SLOT_SIZE)

/* In double precision the packed fields are the particle fields. */
static void pack_motion(const struct solid *solid, struct particles *particles, int64_t first,
                        int64_t last)
{
    if (!SPLIT || first == last) return;
    real *const ux = solid->packed[S_UX], *const uy = solid->packed[S_UY],
                *const low_x = solid->packed[S_LOW_X], *const low_y = solid->packed[S_LOW_Y],
                *const vx = solid->packed[S_VX], *const vy = solid->packed[S_VY];
    const int64_t end = solid->pack[last - 1].i + solid->pack[last - 1].lanes;
#pragma omp simd
    for (int64_t i = solid->pack[first].i; i < end; i++) {
        ux[i] = (real)particles->ux[i];
        uy[i] = (real)particles->uy[i];
        low_x[i] = (real)(particles->ux[i] - (double)ux[i]);
        low_y[i] = (real)(particles->uy[i] - (double)uy[i]);
        vx[i] = (real)particles->vx[i];
        vy[i] = (real)particles->vy[i];
    }
}

/* Sums of the differences to the neighbours times G_ab^T. */
SPHFSI_INLINE void add_gradient(struct vtensor2 *sum, const real *slot, struct vvector2 between)
{
    const vreal Gx = weight_of(slot, W_GX), Gy = weight_of(slot, W_GY);
    sum->xx = vfma(between.x, Gx, sum->xx);
    sum->xy = vfma(between.x, Gy, sum->xy);
    sum->yx = vfma(between.y, Gx, sum->yx);
    sum->yy = vfma(between.y, Gy, sum->yy);
}

/* Eq. 13b in displacements: U = F - I = sum of (u_b - u_a) G_ab^T. */
static void stress_of_packs(const struct solid *solid, struct particles *particles, int64_t first,
                            int64_t last)
{
    (void)particles;
    for (int64_t k = first; k < last; k++) {
        const struct solid_pack *const pack = &solid->pack[k];
        const struct solid_body *const body = &solid->body[pack->body];
        const struct placed a = placed_at(solid, pack->i);
        struct vtensor2 sum = {vset(0), vset(0), vset(0), vset(0)};
        EACH_SLOT(solid, pack, slot, j)
        add_gradient(&sum, slot, displacement_between(solid, &a, j));
        const struct vtensor2 U = {-sum.xx, -sum.xy, -sum.yx, -sum.yy};
        store_tensor(solid, S_UXX, pack, U);
        if (!body->variational) store_tensor(solid, S_PXX, pack, material_pk1(body, U));
    }
}

/* Kelvin and Voigt: a viscous second Piola-Kirchhoff stress is added to the elastic one, tau C :
 * dE/dt with the tangent C of Eq. 10, dE/dt = sym(F^T dF/dt) and dF/dt = sum of (v_b - v_a)
 * G_ab^T. P gains F times it. */
static void damping_of_pack(const struct solid *solid, const struct solid_pack *pack)
{
    const struct solid_body *const body = &solid->body[pack->body];
    const struct solid_receiver a = receiver_of(solid, pack->i);
    const struct vtensor2 F = deformation(a.U);
    struct vtensor2 rate = {vset(0), vset(0), vset(0), vset(0)}; /* -dF/dt */
    EACH_SLOT(solid, pack, slot, j) add_gradient(&rate, slot, velocity_between(solid, a.v, j));
    const vreal shear =
        (F.xx * rate.xy + F.yx * rate.yy + F.xy * rate.xx + F.yy * rate.yx) * (real)0.5;
    const struct vtensor2 strain_rate = {F.xx * rate.xx + F.yx * rate.yx, shear, shear,
                                         F.xy * rate.xy + F.yy * rate.yy};
    const double tau = body->damping_time;
    add_stress(solid, pack,
               vtensor2_mul(F, hooke(strain_rate, -tau * plane_lambda(body), -tau * body->mu)));
}

static void damping_of_packs(const struct solid *solid, struct particles *particles, int64_t first,
                             int64_t last)
{
    (void)particles;
    for (int64_t k = first; k < last; k++)
        if (solid->body[solid->pack[k].body].damping_time > 0)
            damping_of_pack(solid, &solid->pack[k]);
}

/* What the loop over the slots of a pack sums; constants after inlining. */
struct slot_laws {
    bool stress, viscous, mixed, symmetric, hourglass, variational;
};

SPHFSI_INLINE struct solid_sums sum_slots(const struct solid *solid, const struct solid_pack *pack,
                                          const struct solid_receiver *a, struct slot_laws laws)
{
    const struct solid_body *const body = &solid->body[pack->body];
    const vreal eta2 = vset((real)(0.01 * body->h * body->h)), zero = vset(0);
    struct solid_sums sums = {zero, zero, zero,
                              zero, zero, zero,
                              zero, zero, {zero, zero, zero, zero}};
    EACH_SLOT(solid, pack, slot, j)
    {
        if (laws.stress) stress_force(solid, slot, j, &sums);
        if (!laws.viscous && !laws.hourglass) continue;
        struct solid_pair q = pair_of(solid, slot, j, a);
        if (laws.hourglass || laws.symmetric) q.U_b = load_gradient(solid, j);
        if (laws.viscous) {
            vreal Pi = viscous_pressure(solid, &q, a, eta2);
            if (laws.mixed) Pi = Pi * mean_viscosity(solid, pack->i, j, body);
            viscous_force(&q, Pi, laws.symmetric, &sums);
        }
        if (laws.hourglass && laws.variational) hourglass_variational(&q, a, &sums);
        if (laws.hourglass && !laws.variational) hourglass_printed(&q, a, &sums);
    }
    return sums;
}

/* What a body has besides its stress. */
static struct slot_laws pair_laws(const struct solid_body *body)
{
    return (struct slot_laws){.viscous = body->viscosity > 0 || body->mixed,
                              .mixed = body->mixed,
                              .symmetric = body->symmetric,
                              .hourglass = body->kappa > 0,
                              .variational = body->variational};
}

/* Acceleration by pairs: the viscous force multiplied by J F^-T, and that of hourglass control. */
SPHFSI_INLINE struct vvector2 pairs_acceleration(const struct solid_body *body,
                                                 const struct solid_receiver *a,
                                                 const struct solid_sums *s)
{
    const struct vtensor2 cof = vtensor2_cof(deformation(a->U));
    const real viscosity =
        (real)((body->mixed ? 1 : body->viscosity) * (body->symmetric ? 0.5 : 1));
    return (struct vvector2){s->ax + (cof.xx * s->viscous_x + cof.xy * s->viscous_y + s->turned_x) *
                                         viscosity,
                             s->ay + (cof.yx * s->viscous_x + cof.yy * s->viscous_y + s->turned_y) *
                                         viscosity};
}

/* The variational form adds to the stress before neighbours sum it: in a pass of its own. */
static void pairs_of_pack(const struct solid *solid, const struct solid_pack *pack)
{
    const struct solid_body *const body = &solid->body[pack->body];
    const struct solid_receiver a = receiver_of(solid, pack->i);
    const struct slot_laws laws = pair_laws(body);
    struct solid_sums sums;
    /* The default has a specialised loop; the other combinations branch at run time. */
    if (laws.viscous && laws.symmetric && !laws.mixed)
        sums = sum_slots(solid, pack, &a, (struct slot_laws){false, true, false, true, true, true});
    else
        sums = sum_slots(solid, pack, &a, laws);
    const struct vvector2 acc = pairs_acceleration(body, &a, &sums);
    store_packed(solid, S_PAIRS_X, pack, acc.x);
    store_packed(solid, S_PAIRS_Y, pack, acc.y);
    const real half = (real)(0.5 * body->density);
    const struct vtensor2 P = material_pk1(body, a.U);
    store_tensor(solid, S_PXX, pack,
                 (struct vtensor2){P.xx + sums.pull.xx * half, P.xy + sums.pull.xy * half,
                                   P.yx + sums.pull.yx * half, P.yy + sums.pull.yy * half});
}

static void pairs_of_packs(const struct solid *solid, struct particles *particles, int64_t first,
                           int64_t last)
{
    (void)particles;
    for (int64_t k = first; k < last; k++)
        if (solid->body[solid->pack[k].body].variational) pairs_of_pack(solid, &solid->pack[k]);
}

/* Eq. 13a with the neighbours' part of the stress in `sums`. The particle's own part is P_a
 * times the sum of G_ab, zero inside a lattice. */
SPHFSI_INLINE struct vvector2 total_acceleration(const struct solid *solid,
                                                 const struct solid_pack *pack,
                                                 const struct solid_sums *sums,
                                                 struct vvector2 pairs)
{
    const int64_t i = pack->i;
    const vreal Gx = packed_of(solid, S_GX, i), Gy = packed_of(solid, S_GY, i);
    const vreal own_x = vfma(packed_of(solid, S_PXX, i), Gx, packed_of(solid, S_PXY, i) * Gy);
    const vreal own_y = vfma(packed_of(solid, S_PYX, i), Gx, packed_of(solid, S_PYY, i) * Gy);
    const real inv_density = (real)(1 / solid->body[pack->body].density);
    return (struct vvector2){(sums->stress_x + own_x) * inv_density + pairs.x,
                             (sums->stress_y + own_y) * inv_density + pairs.y};
}

/* The acceleration by stress in a variational body, whose forces of pairs are known. */
SPHFSI_INLINE struct vvector2 stress_acceleration(const struct solid *solid,
                                                  const struct solid_pack *pack)
{
    const vreal zero = vset(0);
    struct solid_sums sums = {.stress_x = zero, .stress_y = zero};
    EACH_SLOT(solid, pack, slot, j) stress_force(solid, slot, j, &sums);
    return total_acceleration(solid, pack, &sums,
                              (struct vvector2){packed_of(solid, S_PAIRS_X, pack->i),
                                                packed_of(solid, S_PAIRS_Y, pack->i)});
}

/* Acceleration by stress and the forces of pairs. */
SPHFSI_INLINE struct vvector2 own_acceleration(const struct solid *solid,
                                               const struct solid_pack *pack)
{
    const struct solid_body *const body = &solid->body[pack->body];
    const int64_t i = pack->i;
    const struct solid_receiver a = receiver_of(solid, i);
    struct slot_laws laws = pair_laws(body);
    laws.stress = true;
    struct solid_sums sums;
    /* The article's combination has a specialised loop. */
    if (laws.viscous && laws.hourglass && !laws.symmetric && !laws.mixed)
        sums =
            sum_slots(solid, pack, &a, (struct slot_laws){true, true, false, false, true, false});
    else
        sums = sum_slots(solid, pack, &a, laws);
    return total_acceleration(solid, pack, &sums, pairs_acceleration(body, &a, &sums));
}

static void forces_of_packs(const struct solid *solid, struct particles *particles, int64_t first,
                            int64_t last)
{
    for (int64_t k = first; k < last; k++) {
        const struct solid_pack *const pack = &solid->pack[k];
        const struct vvector2 acc = solid->body[pack->body].variational
                                        ? stress_acceleration(solid, pack)
                                        : own_acceleration(solid, pack);
        vwiden(&particles->sx[pack->i], acc.x, pack->lanes);
        vwiden(&particles->sy[pack->i], acc.y, pack->lanes);
    }
}

/* In double precision the packed fields are the particle fields. */
static void write_stress(const struct solid *solid, struct particles *particles, int64_t first,
                         int64_t last)
{
    if (!SPLIT) return;
    double *const to[] = {particles->Uxx, particles->Uxy, particles->Uyx, particles->Uyy,
                          particles->Pxx, particles->Pxy, particles->Pyx, particles->Pyy};
    for (int64_t k = first; k < last; k++)
        for (int c = 0; c < (int)COUNT_OF(to); c++)
            vwiden(&to[c][solid->pack[k].i], packed_of(solid, S_UXX + c, solid->pack[k].i),
                   solid->pack[k].lanes);
}

/* Energy of the hourglass force, J/m; half of it, since each pair occurs twice. Variational: the
 * sum of k |e|^2/2. The printed force omits how e_ab depends on F and has no potential: half of
 * force times stretch of the pair, its work for small strains. */
static void hourglass(const struct solid *solid, const struct solid_pack *pack, double *energy)
{
    const struct solid_receiver a = receiver_of(solid, pack->i);
    vreal sum = vset(0);
    EACH_SLOT(solid, pack, slot, j)
    {
        struct solid_pair q = pair_of(solid, slot, j, &a);
        q.U_b = load_gradient(solid, j);
        vreal ex, ey;
        hourglass_error(&q, &a, &ex, &ey);
        const vreal half_k = weight_of(slot, W_HALF_K);
        if (solid->body[pack->body].variational) {
            sum = sum + (real)0.5 * half_k * (ex * ex + ey * ey);
            continue;
        }
        const vreal x = vsqrt(q.x * q.x + q.y * q.y), X = vsqrt(q.X * q.X + q.Y * q.Y);
        const vreal stretch =
            (((real)2 * q.X + q.u.x) * q.u.x + ((real)2 * q.Y + q.u.y) * q.u.y) / (x + X);
        sum = sum - half_k * (ex * q.x + ey * q.y) / x * stretch;
    }
    vwiden(energy, sum * (real)(0.25 * solid->body[pack->body].mass), pack->lanes);
}

const struct solid_sweeps SWEEP(solid_sweeps) = {
    .name = SWEEP_LABEL,
    .lanes = LANES,
    .size = sizeof(real),
    .pack_motion = pack_motion,
    .stress = stress_of_packs,
    .pairs = pairs_of_packs,
    .kelvin_voigt = damping_of_packs,
    .forces = forces_of_packs,
    .write_stress = write_stress,
    .hourglass = hourglass,
};
