/* SPDX-License-Identifier: MIT */
#include "twin.h"

#include "unity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Wendland C2 in two dimensions, and dW/dr. */
static double kernel(double r, double h)
{
    const double q = r / h;
    return q >= 2 ? 0 : 7 / (4 * pi * h * h) * pow(1 - q / 2, 4) * (2 * q + 1);
}

static double kernel_derivative(double r, double h)
{
    const double q = r / h;
    return q >= 2 ? 0 : -7 / (4 * pi * h * h) * 5 * q * pow(1 - q / 2, 3) / h;
}

/* Eq. 2 and its inverse, Eq. 20. */
static double tait(const struct twin *t, double rho)
{
    return t->c0 * t->c0 * t->rho0 / 7 * (pow(rho / t->rho0, 7) - 1);
}

/* Fourtakas et al. 2025 (T-9a): what the density less its value with delay adds to the pressure. */
static void state_of(const struct twin *t, struct twin_point *f)
{
    f->p_state = tait(t, f->rho);
    f->p = f->p_state;
    if (t->damped) f->p += t->c0 * t->c0 * (f->rho - f->rho_slow);
}

static double tait_inverse(const struct twin *t, double p)
{
    return t->rho0 * pow(p * 7 / (t->c0 * t->c0 * t->rho0) + 1, 1.0 / 7);
}

/* M of L-1: - sum of V x . grad W/2 over a square lattice. */
static double second_moment(double dp, double h)
{
    double sum = 0;
    for (int i = -5; i <= 5; i++)
        for (int j = -5; j <= 5; j++) {
            const double r = dp * hypot(i, j), q = r / h;
            if (q < 2) sum += dp * dp * r * r / 2 * 35 / (4 * M_PI * pow(h, 4)) * pow(1 - q / 2, 3);
        }
    return sum;
}

void twin_copy(struct twin *t, const struct simulation *sim)
{
    const struct scene *const scene = sim->scene;
    const struct scene_fluid *const f = &scene->fluid[0];
    const double dp = scene->top.dp, h = scene->numerics.h_over_dp * dp;
    *t = (struct twin){.suction = scene->numerics.suction == SUCTION_ON,
                       .h = h,
                       .mass = f->density * scene->top.dp * scene->top.dp,
                       .c0 = f->sound_speed,
                       .rho0 = f->density,
                       .alpha = f->artificial_viscosity,
                       .delta = f->density_diffusion,
                       .nu = f->laminar_viscosity / second_moment(dp, h),
                       .tensile = f->tensile_control,
                       .repulsion = f->wall_repulsion,
                       .one_sided = scene->numerics.sides == SIDES_ONE,
                       .wall_damping = f->wall_damping,
                       .damped = f->acoustic_damper > 0,
                       .dp = scene->top.dp,
                       .g = {scene->top.gravity[0], scene->top.gravity[1]},
                       .renormalised = f->diffusion_form == DIFFUSION_ANTUONO,
                       .strained = f->diffusion_limiter == LIMITER_STRAIN,
                       .hydrostatic = f->diffusion_form == DIFFUSION_FOURTAKAS,
                       .filled = f->particle_mass == MASS_HYDROSTATIC};
    for (int axis = 0; axis < 2; axis++)
        if (scene->domain.periodic & 1 << axis)
            t->period[axis] = scene->domain.upper[axis] - scene->domain.lower[axis];
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const struct particles *const particles = &sim->particles[kind];
        t->n[kind] = particles->n;
        t->point[kind] = calloc((size_t)particles->n + 1, sizeof *t->point[kind]);
        TEST_ASSERT_NOT_NULL(t->point[kind]);
        for (int64_t i = 0; i < particles->n; i++) {
            struct twin_point *const q = &t->point[kind][i];
            *q = (struct twin_point){.x = particles->x[i],
                                     .y = particles->y[i],
                                     .u = particles->vx[i],
                                     .v = particles->vy[i]};
            q->m = t->mass * (kind == KIND_FLUID && particles->m ? particles->m[i] : 1);
            if (kind == KIND_FLUID) q->rho = t->rho0 + t->rho0 * particles->dens[i];
            if (kind == KIND_FLUID && particles->dens_slow)
                q->rho_slow = t->rho0 + t->rho0 * particles->dens_slow[i];
            if (kind == KIND_WALL) q->sticks = scene->wall[particles->body[i]].slip == SLIP_NONE;
            if (kind == KIND_SOLID) q->sticks = scene->solid[particles->body[i]].slip == SLIP_NONE;
            if (kind == KIND_SOLID) q->u = particles->wx[i];
            if (kind == KIND_SOLID) q->v = particles->wy[i];
            if (kind != KIND_FLUID && particles->ax) q->ax = particles->ax[i];
            if (kind != KIND_FLUID && particles->ay) q->ay = particles->ay[i];
        }
    }
}

void twin_free(struct twin *t)
{
    for (int kind = 0; kind < KIND_COUNT; kind++) free(t->point[kind]);
    memset(t, 0, sizeof *t);
}

/* a less b, to the nearest image of b. */
static double apart(const struct twin *t, int axis, double a, double b)
{
    const double d = a - b, L = t->period[axis];
    return L > 0 ? remainder(d, L) : d;
}

/* Eqs. 19 and 20, and 22 and 23 of Adami et al. 2012, for one wall or solid particle. */
static void extrapolate(const struct twin *t, struct twin_point *s)
{
    double sum_w = 0, sum = 0, size = 0, sum_u = 0, sum_v = 0;
    for (int64_t k = 0; k < t->n[KIND_FLUID]; k++) {
        const struct twin_point *const f = &t->point[KIND_FLUID][k];
        const double dx = apart(t, 0, s->x, f->x), dy = apart(t, 1, s->y, f->y);
        const double w = kernel(sqrt(dx * dx + dy * dy), t->h);
        const double lift = f->rho * ((t->g[0] - s->ax) * dx + (t->g[1] - s->ay) * dy);
        sum_w += w;
        sum_u += f->u * w;
        sum_v += f->v * w;
        sum += (f->p + lift) * w;
        size += (fabs(f->p) + fabs(lift)) * w;
    }
    s->weight = sum_w / kernel(0, t->h);
    s->mu = sum_w > 0 && !t->one_sided ? 2 * s->u - sum_u / sum_w : s->u;
    s->mv = sum_w > 0 && !t->one_sided ? 2 * s->v - sum_v / sum_w : s->v;
    s->p = sum_w > 0 ? sum / sum_w : 0;
    if (!t->suction && s->p < 0) s->p = 0;
    s->size_p = sum_w > 0 ? size / sum_w : 0;
    s->rho = tait_inverse(t, s->p);
    if (t->filled) s->m = t->mass * s->rho / t->rho0;
}

/* Antuono et al. 2010, Eqs. 4 and 5. */
static void renormalised_gradient(const struct twin *t, struct twin_point *a)
{
    double L[2][2] = {{0}}, s[2] = {0};
    for (int64_t k = 0; k < t->n[KIND_FLUID]; k++) {
        const struct twin_point *const b = &t->point[KIND_FLUID][k];
        const double d[2] = {apart(t, 0, b->x, a->x), apart(t, 1, b->y, a->y)};
        const double r = hypot(d[0], d[1]);
        if (r >= 2 * t->h || r == 0) continue;
        const double slope = kernel_derivative(r, t->h) / r * b->m / b->rho;
        for (int i = 0; i < 2; i++) {
            s[i] -= (b->rho - a->rho) * slope * d[i];
            for (int j = 0; j < 2; j++) L[i][j] -= d[i] * slope * d[j];
        }
    }
    const double det = L[0][0] * L[1][1] - L[0][1] * L[1][0];
    if (det < 1e-3 * (L[0][0] + L[1][1]) * (L[0][0] + L[1][1])) return;
    a->sx = (L[1][1] * s[0] - L[0][1] * s[1]) / det;
    a->sy = (L[0][0] * s[1] - L[1][0] * s[0]) / det;
}

/* L-1: what viscosity adds, by the factor x . grad W/r^2. */
static void laminar_pair(const struct twin *t, struct twin_point *a, const struct twin_point *b,
                         bool mirrored, double factor)
{
    const double image = mirrored && t->one_sided ? 2 : 1; /* b has 2 v_b - v_a */
    const double c = image * b->m * 2 * t->nu * t->rho0 / (a->rho * b->rho) * factor;
    a->ax += c * (a->u - (mirrored ? b->mu : b->u));
    a->ay += c * (a->v - (mirrored ? b->mv : b->v));
    a->size_a += fabs(c) * (hypot(a->u, a->v) + hypot(b->u, b->v));
}

/* P_s and P_f in the forces between a fluid particle and a wall or solid one, with what keeps them
 * apart. */
static double surface_pressure(const struct twin *t, const struct twin_point *f,
                               const struct twin_point *s)
{
    const double dx = apart(t, 0, s->x, f->x), dy = apart(t, 1, s->y, f->y);
    double own = f->p + f->rho * ((t->g[0] - s->ax) * dx + (t->g[1] - s->ay) * dy);
    if (!t->suction && own < 0) own = 0;
    const double near = 0.8 * t->dp, eta2 = 0.01 * t->h * t->h;
    const double closer = (near * near + eta2) / (dx * dx + dy * dy + eta2) - 1;
    const double du = f->u - s->u, dv = f->v - s->v;
    const double approach = fmax(0, -(dx * -du + dy * -dv) / sqrt(dx * dx + dy * dy + eta2));
    return f->p + (t->one_sided ? own : s->p) +
           t->rho0 * t->c0 * (t->repulsion * t->c0 + t->wall_damping * approach) * fmax(closer, 0);
}

/* What a fluid particle a feels of b (Eqs. 4, 6, 7, 21a); b of a wall or solid slips freely. */
static void fluid_pair(struct twin *t, struct twin_point *a, const struct twin_point *b, bool slip)
{
    const double dx = apart(t, 0, a->x, b->x), dy = apart(t, 1, a->y, b->y);
    const double r = sqrt(dx * dx + dy * dy);
    if (r >= 2 * t->h || r == 0) return;
    const double gx = kernel_derivative(r, t->h) * dx / r; /* Eq. 5 */
    const double gy = kernel_derivative(r, t->h) * dy / r;
    const double du = a->u - b->u, dv = a->v - b->v, vx = du * dx + dv * dy;
    const double eta2 = 0.01 * t->h * t->h, V = b->m / b->rho;
    double Pi = 0, psi = 0;
    if (!slip && vx < 0)
        Pi = -t->alpha * t->c0 / (0.5 * (a->rho + b->rho)) * t->h * vx / (r * r + eta2);
    if (!slip) {
        double step = b->rho - a->rho;
        /* The hydrostatic density of b less that of a, for a small change of density. */
        if (t->hydrostatic) step -= t->rho0 * (t->g[0] * -dx + t->g[1] * -dy) / (t->c0 * t->c0);
        step += 0.5 * ((a->sx + b->sx) * dx + (a->sy + b->sy) * dy);
        psi = 2 * step / (r * r + eta2);
    }
    const double pressure = slip ? surface_pressure(t, a, b) : a->p + b->p;
    const double factor = -b->m * (pressure / (a->rho * b->rho) + Pi);
    /* The image in b has 2 v_b - v_a. */
    const double mirrored = slip && t->one_sided ? 2 : 1;
    const double moved = mirrored * a->rho * V * (du * gx + dv * gy);
    double diffusivity = t->delta * t->h * t->c0;
    /* (C_delta l)^2 times the strain rate along the line of the pair. */
    if (t->strained)
        diffusivity = fmin(diffusivity, pow(6 * 2 * t->h, 2) * fabs(vx) / (r * r + eta2));
    const double diffused = diffusivity * V * psi * (-dx * gx - dy * gy);
    if (!slip && t->tensile > 0) {
        const double f = kernel(r, t->h) / kernel(t->dp, t->h);
        const double pull = fmax(-a->p, 0) + fmax(-b->p, 0);
        const double push = -b->m * t->tensile * pull * pow(f, 4) / (a->rho * b->rho);
        a->ax += push * gx;
        a->ay += push * gy;
        a->size_a += fabs(push) * hypot(gx, gy);
    }
    a->ax += factor * gx;
    a->ay += factor * gy;
    if (!slip || b->sticks) laminar_pair(t, a, b, slip, (dx * gx + dy * gy) / (r * r));
    a->cx += V * gx;
    a->cy += V * gy;
    a->div_r -= V * (dx * gx + dy * gy);
    a->drho += moved + diffused;
    a->size_a += b->m *
                 ((fabs(a->p) + fabs(b->p) + fabs(pressure)) / (a->rho * b->rho) + fabs(Pi)) *
                 hypot(gx, gy);
    a->size_drho += mirrored * a->rho * V * (fabs(du * gx) + fabs(dv * gy)) + fabs(diffused);
    t->top_approach = fmax(t->top_approach, fabs(t->h * vx / (r * r + eta2)));
}

/* Eq. 21b: what a solid particle feels of the fluid, as a force. */
static void solid_force(const struct twin *t, struct twin_point *s)
{
    for (int64_t k = 0; k < t->n[KIND_FLUID]; k++) {
        const struct twin_point *const f = &t->point[KIND_FLUID][k];
        const double dx = apart(t, 0, s->x, f->x), dy = apart(t, 1, s->y, f->y);
        const double r = sqrt(dx * dx + dy * dy);
        if (r >= 2 * t->h) continue;
        const double slope = kernel_derivative(r, t->h) / r;
        const double pressure = surface_pressure(t, f, s);
        const double factor = -s->m * f->m * pressure / (s->rho * f->rho);
        s->fx += factor * slope * dx;
        s->fy += factor * slope * dy;
        if (s->sticks) {
            const double drag = (t->one_sided ? 2 : 1) * s->m * f->m * 2 * t->nu * t->rho0 /
                                (s->rho * f->rho) * slope;
            s->fx += drag * (s->mu - f->u);
            s->fy += drag * (s->mv - f->v);
            s->size_f += fabs(drag) * (hypot(s->mu, s->mv) + hypot(f->u, f->v));
        }
        s->size_f += fabs(s->m * f->m / (s->rho * f->rho) * slope * r) *
                     (fabs(s->p) + fabs(f->p) + fabs(pressure));
    }
}

void twin_evaluate(struct twin *t)
{
    for (int64_t i = 0; i < t->n[KIND_FLUID]; i++) state_of(t, &t->point[KIND_FLUID][i]);
    for (int64_t i = 0; t->renormalised && !t->given_slopes && i < t->n[KIND_FLUID]; i++)
        renormalised_gradient(t, &t->point[KIND_FLUID][i]);
    for (int kind = KIND_WALL; kind < KIND_COUNT; kind++)
        for (int64_t i = 0; i < t->n[kind]; i++) extrapolate(t, &t->point[kind][i]);
    for (int64_t i = 0; i < t->n[KIND_FLUID]; i++) {
        struct twin_point *const a = &t->point[KIND_FLUID][i];
        for (int kind = 0; kind < KIND_COUNT; kind++)
            for (int64_t k = 0; k < t->n[kind]; k++)
                fluid_pair(t, a, &t->point[kind][k], kind != KIND_FLUID);
        a->ax += t->g[0];
        a->ay += t->g[1];
        t->top_acceleration = fmax(t->top_acceleration, hypot(a->ax, a->ay));
    }
    for (int64_t i = 0; i < t->n[KIND_SOLID]; i++) solid_force(t, &t->point[KIND_SOLID][i]);
}
