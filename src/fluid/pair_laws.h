/* SPDX-License-Identifier: MIT
 * One inline function for each law between two particles of the fluid, over a vector of pairs. The
 * text is compiled once for float and once for double lanes: the including file defines `real`,
 * `vreal`, the vector functions of base/simd.h and lane(). Lengths are in units of h: with
 * xi = x/h and t = max(0, 2 - |xi|)
 *   grad_a W_ab = -(PAIR_SLOPE/h^3) t^3 xi_ab.
 * So every sum is to be multiplied by -PAIR_SLOPE/h. It has the volumes of both particles, so it is
 * divided by that of its own. The clamp of t removes pairs beyond the support without a mask. Only
 * commutative sums and odd differences are used: exchanging a and b flips the sign of a force and
 * nothing else. */

#define PAIR_SLOPE (KERNEL_SLOPE / 8)

/* (C_delta l/h)^2 of Meringolo et al. 2019 with C_delta = 6 and the reach of the kernel, l = 2h. */
#define STRAIN_DIFFUSION (6 * KERNEL_REACH * 6 * KERNEL_REACH)

/* The contribution of a pair to its receiver: factors of xi, v and v.xi, whose products the sums
 * take with one rounding. The candidate gets the opposite, except for the rate and div_r, which are
 * even. With the volumes of both, over h^4. */
struct pair_terms {
    struct pair pair;
    vreal radial;           /* of xi in the forces, Pa */
    vreal laminar;          /* of -v in the forces, kg/(m^2 s) */
    vreal rate;             /* of v.xi in the rate, 1 */
    vreal dens_difference;  /* that diffuses, 1 */
    vreal diffusion_factor; /* its factor in Eq. 6, without 2/(1 + dens_a) and, unless limited,
                               delta c0 */
};

/* Constants of the sweep, in all SIMD lanes. */
struct vector_constants {
    vreal laminar;         /* 2 nu rho0/(M h) of L-1, kg/(m^2 s) */
    vreal tensile, close;  /* epsilon, 1/W(dp) in the units of law_tensile */
    vreal repulsion;       /* beta rho0 c_u^2 of law_repulsion, Pa */
    vreal wall_damping;    /* zeta rho0 c0 of law_wall_damping, Pa s/m */
    vreal lowest;          /* pressure of walls and structures, Pa */
    vreal gx, gy;          /* g h/c0^2: slope of the hydrostatic density, 1 */
    vreal diffusion_limit; /* delta c0/STRAIN_DIFFUSION, m/s */
    vreal eta2;            /* (eta/h)^2 = 0.01 */
    /* Factors of the sums in the rates: the slope of the kernel over the volume of a particle, with
     * 1/rho0 in that of forces; and of Eq. 6. */
    double kernel_slope, acceleration, diffusion_factor;
};

SPHFSI_INLINE struct vector_constants constants_of_sweep(const struct fluid *fluid)
{
    const struct fluid_constants *const fk = &fluid->k;
    const double per_c2 = fk->h / square(fk->c0);
    const double slope = PAIR_SLOPE * fk->h / (fk->mass / fk->rho0);
    return (struct vector_constants){
        .laminar =
            vset((real)(2 * fk->model->laminar_viscosity * fk->rho0 / (fk->second_moment * fk->h))),
        .tensile = vset((real)fk->model->tensile_control),
        .close = vset((real)(kernel_w(0, fk->h) / kernel_w(fk->dp, fk->h))),
        .repulsion = vset((real)(fk->model->wall_repulsion * fk->rho0 * square(fk->c_u))),
        .wall_damping = vset((real)(fk->model->wall_damping * fk->rho0 * fk->c0)),
        .lowest = vset((real)fk->lowest_wall_pressure),
        .gx = vset((real)(fk->gravity[0] * per_c2)),
        .gy = vset((real)(fk->gravity[1] * per_c2)),
        .diffusion_limit = vset((real)(fk->model->density_diffusion * fk->c0 / STRAIN_DIFFUSION)),
        .eta2 = vset((real)ETA2),
        .kernel_slope = slope,
        .acceleration = slope / fk->rho0,
        .diffusion_factor = 2 * fk->model->density_diffusion * fk->c0,
    };
}

/* Eq. 4a: factor of v.xi in the sum of V_b v_ab . grad W. */
SPHFSI_INLINE vreal law_continuity(const struct pair *q) { return q->weight; }

/* Eq. 4b and 21a, pressure: P_a + P_b, still to be multiplied by the weight of the pair. */
SPHFSI_INLINE vreal law_pressure(const struct receiver *a, const struct pair *q)
{
    return a->p + q->p;
}

/* -2 alpha c0 rho0/((|xi|^2 + eta^2)(rho0/rho_a + rho0/rho_b)), kg/(m^2 s). `both` is the sum of
 * the densities there over -2 alpha c0 rho0. The result times `both` is 1/(|xi|^2 + eta^2), which
 * other laws use: one division serves all. */
SPHFSI_INLINE vreal viscosity_factor(const struct pair *q, vreal both,
                                     const struct vector_constants *k)
{
    return vset(1) / ((q->r2 + k->eta2) * both);
}

/* Eq. 7: rho_a rho_b Pi_ab, Pa, added to the pair's stress; acts on approaching pairs only. With
 * rho_a rho_b/(rho_a + rho_b) = rho0/(rho0/rho_a + rho0/rho_b). */
SPHFSI_INLINE vreal law_viscosity(const struct pair *q, vreal factor, vreal stress)
{
    return vfma(vmin(q->v_xi, vset(0)), factor, stress);
}

/* Monaghan 2000, Sec. 3: tension repels by epsilon (|P_a| + |P_b|) (W_ab/W(dp))^4, Pa. */
SPHFSI_INLINE vreal law_tensile(const struct receiver *a, const struct pair *q,
                                const struct vector_constants *k)
{
    const vreal r = vsqrt(q->r2);
    const vreal t = vmax(vset(0), vfma(vset((real)-0.5), r, vset(1)));
    const vreal f = k->close * (t * t) * (t * t) * vfma(vset(2), r, vset(1)), f2 = f * f;
    const vreal tension = vmin(a->p, vset(0)) + vmin(q->p, vset(0));
    return -(k->tensile * tension) * (f2 * f2);
}

/* T-110c: fluid slides along a thin line. In its rate a dummy has the velocity of the fluid in the
 * direction t of the line; t = 0: a dummy that is no part of it. */
SPHFSI_INLINE void law_sliding(struct pair *q, vreal tx, vreal ty)
{
    q->v_xi = q->v_xi - vfma(q->v, ty, q->u * tx) * vfma(q->y, ty, q->x * tx);
}

/* As in Zhang, Rezavand and Hu 2021 a dummy has the pressure p of the fluid particle itself, plus
 * the hydrostatic difference in the frame of the dummy: Eq. 19 with this particle alone. (x, y) is
 * its position relative to the dummy over h, `lift` rho0 h (g - a) of the dummy. */
SPHFSI_INLINE vreal law_one_sided(vreal p, vreal dens, vreal x, vreal y, vreal lift_x, vreal lift_y,
                                  const struct vector_constants *k)
{
    return vmax(k->lowest, p - (vset(1) + dens) * vfma(lift_y, y, lift_x * x));
}

/* L-6a: a fluid particle meets its own pressure and its mirror image, which has the velocity
 * 2 v_s - v_a. The work of both parts of the pressure then goes into compression. */
SPHFSI_INLINE vreal law_one_sided_rate(const struct pair *q) { return vset(2) * law_continuity(q); }

/* Used in place of the boundary force of Monaghan 1994, between fluid and dummies nearer than r0: a
 * pressure beta rho0 c_u^2 ((r0^2 + eta^2)/(r^2 + eta^2) - 1), Pa; r0_2 = (r0^2 + eta^2)/h^2,
 * inv = h^2/(r^2 + eta^2). */
SPHFSI_INLINE vreal law_repulsion(vreal r0_2, vreal inv, const struct vector_constants *k)
{
    return k->repulsion * vmax(vset(0), vfma(r0_2, inv, vset(-1)));
}

/* The repulsion of a pair that approaches at a speed u: zeta rho0 c0 u, the pressure of the
 * one-sided Riemann problem of Zhang, Hu and Adams 2017, in place of beta rho0 c_u^2. */
SPHFSI_INLINE vreal law_wall_damping(vreal r0_2, vreal inv, vreal v_xi,
                                     const struct vector_constants *k)
{
    const vreal speed = -(vmin(v_xi, vset(0)) * vsqrt(inv));
    return k->wall_damping * speed * vmax(vset(0), vfma(r0_2, inv, vset(-1)));
}

/* A wall or structure: pressure, lift, and the range of law_repulsion. */
struct surface {
    vreal p, lift_x, lift_y, near;
};

/* The stress between fluid of pressure p and a surface, Pa: the same for both. (x, y) is the place
 * of the fluid relative to the surface, over h. */
SPHFSI_INLINE vreal law_surface(vreal p, vreal dens, vreal x, vreal y, const struct surface *s,
                                const struct pair *q, const struct vector_constants *k,
                                struct pair_set effects)
{
    const vreal inv = vset(1) / (q->r2 + k->eta2);
    vreal stress = p + s->p; /* Eq. 21a */
    if (PAIR_HAS(effects, ONE_SIDED))
        stress = stress + law_one_sided(p, dens, x, y, s->lift_x, s->lift_y, k);
    if (PAIR_HAS(effects, REPULSION)) stress = stress + law_repulsion(s->near, inv, k);
    if (PAIR_HAS(effects, WALL_DAMPING))
        stress = stress + law_wall_damping(s->near, inv, q->v_xi, k);
    return stress;
}

/* L-1: Morris et al. 1997, Eq. 22, in volumes and with the same dynamic viscosity nu rho0
 * everywhere:
 *   rho_a dv_a/dt = sum of V_b 2 nu rho0/M x_ab . grad W/|x|^2 v_ab.
 * The factor of -v_ab. This kernel's gradient needs no division by |x|^2. */
SPHFSI_INLINE vreal law_laminar(const struct pair *q, const struct vector_constants *k)
{
    return k->laminar * q->weight;
}

/* Eq. 28b: the pair's rate of approach or separation. */
SPHFSI_INLINE vreal law_approach(const struct pair *q, vreal inv) { return vabs(q->v_xi * inv); }

/* L-5b: the diffusivity over h and STRAIN_DIFFUSION. It is delta c0, but at most (C_delta l)^2/h
 * times the rate of strain of the pair along its line (Meringolo et al. 2019). */
SPHFSI_INLINE vreal law_limiter(const struct pair *q, vreal inv, const struct vector_constants *k)
{
    return vmin(law_approach(q, inv), k->diffusion_limit);
}

/* Eq. 6: D_a = 2 delta h c0 rho0 sum of V_b (dens_a - dens_b) x_ab . grad W/(|x|^2 + eta^2). The
 * difference that diffuses: with FOURTAKAS (Fourtakas et al. 2019, Eq. 10, linearised) without its
 * hydrostatic part, g . x_ba/c0^2; with ANTUONO (Antuono et al. 2010, Eq. 3) without its linear
 * part, by the mean of both particles' gradients. */
SPHFSI_INLINE vreal law_dens_difference(const struct receiver *a, const struct pair *q,
                                        const struct vector_constants *k, struct pair_set effects)
{
    vreal difference = a->dens - q->dens;
    if (PAIR_HAS(effects, FOURTAKAS)) difference = difference - vfma(k->gy, q->y, k->gx * q->x);
    if (PAIR_HAS(effects, ANTUONO))
        difference =
            vfma(a->dens_y + q->dens_y, q->y, vfma(a->dens_x + q->dens_x, q->x, difference));
    return difference;
}

/* The factor of the density diffusion. */
SPHFSI_INLINE vreal law_diffusion_factor(const struct pair *q, vreal inv,
                                         const struct vector_constants *k, struct pair_set effects)
{
    const vreal factor = q->weight * (q->r2 * inv);
    return PAIR_HAS(effects, LIMITER) ? factor * law_limiter(q, inv, k) : factor;
}

/* Lind et al. 2012, Eq. 20: grad C = sum of V_b grad W; divergence - sum of V_b x_ab . grad W. */
SPHFSI_INLINE void law_concentration(const struct pair *q, vreal sum[SUMS])
{
    sum[SUM_GRAD_C_X] = vfma(q->weight, q->x, sum[SUM_GRAD_C_X]);
    sum[SUM_GRAD_C_Y] = vfma(q->weight, q->y, sum[SUM_GRAD_C_Y]);
    sum[SUM_DIV_R] = vfma(q->weight, q->r2, sum[SUM_DIV_R]);
}
