/* SPDX-License-Identifier: MIT
 * What buffers have from the fluid across their line and from what a boundary gives: pressures,
 * velocities, and the forces that hold them (T-50 to T-53). */
#include "fluid/open.h"

/* --- the fluid across a line --- */

/* Sums over the fluid around a point, weighted by the kernel without its norm. For pressures: of
 * the pressure, and of rho/rho0 times the vector back. For flows: of the velocity, of its products
 * with the vector to the particle, of that vector, and of its products. */
enum { S_W, S_P, S_GX, S_GY };
enum { S_U = S_W + 1, S_UX, S_UY, S_V, S_VX, S_VY, S_X, S_Y, S_XX, S_XY, S_YY, S_SUMS };

/* Adds up to four particles of a cell from i on, at (x, y) from the point; none of buffers. */
SPHFSI_INLINE void add_across(four_double sum[S_SUMS], bool flow, double inv_h,
                              const struct particles *particles, int32_t i, int count,
                              four_double x, four_double y)
{
    const four_long lane = {0, 1, 2, 3};
    const four_double r2 = x * x + y * y;
    const four_long seen = (four_long)(r2 < square(KERNEL_REACH / inv_h)) & (lane < count);
    if (!four_any(seen)) return;
    const int32_t *const open = &particles->open[i];
    const four_long of = {open[0], open[1], open[2], open[3]}, fluid = (four_long)(of == 0) & seen;
    const four_double q = four_sqrt(r2) * inv_h, t = 1 - 0.5 * q;
    const four_double w = (four_double)((four_long)(t * t * (t * t) * (2 * q + 1)) & fluid);
    const four_double wx = w * x, wy = w * y;
    sum[S_W] += w;
    if (!flow) {
        const four_double mass = 1 + FOUR(particles->dens, i);
        sum[S_P] += w * FOUR(particles->p, i);
        sum[S_GX] -= wx * mass;
        sum[S_GY] -= wy * mass;
        return;
    }
    const four_double u = FOUR(particles->vx, i), v = FOUR(particles->vy, i);
    sum[S_U] += w * u;
    sum[S_UX] += wx * u;
    sum[S_UY] += wy * u;
    sum[S_V] += w * v;
    sum[S_VX] += wx * v;
    sum[S_VY] += wy * v;
    sum[S_X] += wx;
    sum[S_Y] += wy;
    sum[S_XX] += wx * x;
    sum[S_XY] += wx * y;
    sum[S_YY] += wy * y;
}

/* The fluid within reach of a point, without the buffers. */
SPHFSI_INLINE void state_across(const struct open_boundaries *o, const double at[2], bool flow,
                                double sum[S_SUMS])
{
    const struct cells *const cells = o->cells;
    const struct particles *const particles = o->particles;
    const struct cell_list *const list = &cells->list[KIND_FLUID];
    const struct cell_window window = cells_window(cells, at, KERNEL_REACH * o->k->h);
    four_double s[S_SUMS] = {{0}};
    for (int m = 0; m < window.n[0] * window.n[1]; m++) {
        const int32_t cell = window_cell(cells, &window, m);
        if (cell < 0) continue;
        const double cx = cell_centre_x(cells, cell), cy = cell_centre_y(cells, cell);
        const double dx = cells_minimum_image(cells, 0, cx - at[0]) - cx,
                     dy = cells_minimum_image(cells, 1, cy - at[1]) - cy;
        for (int32_t n = 0, i = list->start[cell]; n < list->count[cell]; n += 4, i += 4)
            add_across(s, flow, 1 / o->k->h, particles, i, list->count[cell] - n,
                       FOUR(particles->x, i) + dx, FOUR(particles->y, i) + dy);
    }
    for (int m = 0; m < S_SUMS; m++) sum[m] = (s[m][0] + s[m][2]) + (s[m][1] + s[m][3]);
}

/* T-51: value of the fitted linear velocity at the point; the mean if no plane is spanned. */
static double linear_value(const double s[S_SUMS], int velocity)
{
    const double w = s[S_W], x = s[S_X] / w, y = s[S_Y] / w;
    const double xx = s[S_XX] / w - x * x, xy = s[S_XY] / w - x * y, yy = s[S_YY] / w - y * y;
    const double det = xx * yy - xy * xy, value = s[velocity] / w;
    if (!(det > 0.01 * square(xx + yy))) return value;
    const double cx = s[velocity + 1] / w - x * value, cy = s[velocity + 2] / w - y * value;
    return value - ((yy * x - xy * y) * cx + (xx * y - xy * x) * cy) / det;
}

/* Velocity along a direction of the fluid around a point; without fluid `otherwise`. */
static double flow_along(const struct open_boundaries *o, const double at[2], const double n[2],
                         double otherwise)
{
    double s[S_SUMS];
    state_across(o, at, true, s);
    if (!(s[S_W] > 0)) return otherwise;
    return linear_value(s, S_U) * n[0] + linear_value(s, S_V) * n[1];
}

/* --- fields of the buffers --- */

static const struct scene_open *project(const struct open_boundaries *o, int64_t i, double *in,
                                        double on_line[2])
{
    const struct scene_open *const b = open_boundary(o, i);
    const double x[] = {o->particles->x[i], o->particles->y[i]};
    double along;
    scene_open_place(b, x, in, &along);
    for (int c = 0; c < 2; c++) on_line[c] = x[c] - *in * b->inward[c];
    return b;
}

enum err open_copy(struct open_boundaries *o, int n, struct arena *a, struct diag *d)
{
    for (int m = 0; m < OPEN_TIMES; m++) {
        struct scene_open *const at = &o->at[n][m];
        *at = o->boundary[n];
        if (at->speed) TRY(expr_copy(&at->speed, at->speed, a, d));
        for (int c = 0; c < 2 && at->velocity[c]; c++)
            TRY(expr_copy(&at->velocity[c], at->velocity[c], a, d));
    }
    return ERR_OK;
}

/* Functions of time alone are then evaluated once instead of once a particle. The rate of a given
 * velocity is that over the time in which sound crosses h. */
static void fix_times(struct open_boundaries *o, double time)
{
    o->time[OPEN_BEFORE] = max2(0, time - 0.5 * o->k->h / o->k->c0);
    o->time[OPEN_AFTER] = o->time[OPEN_BEFORE] + o->k->h / o->k->c0;
    o->time[OPEN_NOW] = time;
    for (int k = 0; k < o->n * OPEN_TIMES; k++) {
        const struct scene_open *const b = &o->boundary[k / OPEN_TIMES],
                                       *const at = &o->at[k / OPEN_TIMES][k % OPEN_TIMES];
        const double t = o->time[k % OPEN_TIMES];
        if (b->speed) expr_fix_time(at->speed, b->speed, t);
        for (int c = 0; c < 2 && b->velocity[c]; c++)
            expr_fix_time(at->velocity[c], b->velocity[c], t);
    }
}

/* A buffer particle's pressure from the fluid at its mirror image in the line (T-52), and with a
 * given pressure its velocity from the fluid around its projection on the line (T-51): velocities
 * that varied along the normal would compress the buffer, because it has none along the line. With
 * a given velocity: the pressure that T-10 gives a wall with that velocity (T-50). Without fluid
 * there its fields do not change. */
static void mirror_fields(const struct open_boundaries *o, struct open_member *m)
{
    const struct fluid_constants *const k = o->k;
    const struct particles *const particles = o->particles;
    const int32_t i = m->particle;
    const struct scene_open *const at = o->at[particles->open[i] - 1]; /* times are fixed in it */
    double in, on_line[2], mirror[2], v[2], a[2], s[S_SUMS];
    const struct scene_open *const b = project(o, i, &in, on_line);
    for (int c = 0; c < 2; c++) mirror[c] = on_line[c] + fabs(in) * b->inward[c];
    state_across(o, mirror, false, s);
    const double w = s[S_W];
    if (b->kind == OPEN_PRESSURE) {
        m->v[0] = particles->vx[i];
        m->v[1] = particles->vy[i];
        m->p = w > 0 ? s[S_P] / w : (double)NAN;
        const double normal = flow_along(o, on_line, b->inward, (double)NAN);
        if (isnan(normal)) return;
        for (int c = 0; c < 2; c++) m->v[c] = normal * b->inward[c];
        return;
    }
    scene_open_velocity(&at[OPEN_NOW], on_line, 0, m->v);
    m->p = eos_pressure(particles->dens[i], k->rho0, k->c0);
    if (!(w > 0)) return;
    scene_open_velocity(&at[OPEN_BEFORE], on_line, 0, v);
    scene_open_velocity(&at[OPEN_AFTER], on_line, 0, a);
    for (int c = 0; c < 2; c++) a[c] = (a[c] - v[c]) / (o->time[OPEN_AFTER] - o->time[OPEN_BEFORE]);
    const double from[2] = {particles->x[i] - mirror[0], particles->y[i] - mirror[1]};
    m->p = (s[S_P] + k->rho0 * ((k->gravity[0] - a[0]) * (s[S_GX] + w * from[0]) +
                                (k->gravity[1] - a[1]) * (s[S_GY] + w * from[1]))) /
           w;
}

/* The given pressure at a point of the line, Pa. */
static double given_pressure(const struct scene_open *b, const struct fluid_constants *k,
                             const double on_line[2], double time)
{
    if (b->pressure) return expr_at_time(b->pressure, on_line[0], on_line[1], time);
    return max2(0, -k->rho0 * k->gravity[1] * (b->level - on_line[1]));
}

/* T-52: pressure of a buffer particle that makes it `given` on the line; no tension at the end. */
static double odd_pressure(const struct scene_open *b, double given, double mirrored)
{
    if (isnan(mirrored)) return given;
    const double odd = 2 * given - mirrored;
    return b->pressure ? odd : max2(0, odd);
}

/* The mean flow out of the fluid through each boundary that uses it, a spacing in front of the line
 * and at fixed points: particles that come and go would add noise. */
static void find_flow(struct open_boundaries *o)
{
    for (int n = 0; n < o->n; n++) {
        const struct scene_open *const b = &o->boundary[n];
        const double out[] = {-b->inward[0], -b->inward[1]};
        const int places = (int)max2(1, min2((double)o->capacity, round(b->length / o->k->dp)));
        double sum = 0;
        if (!(b->absorb > 0)) continue;
#pragma omp parallel for schedule(static)
        for (int i = 0; i < places; i++) {
            const double along = (i + 0.5) * b->length / places;
            double x[2];
            for (int c = 0; c < 2; c++)
                x[c] = b->from[c] + along * b->along[c] + o->k->dp * b->inward[c];
            o->flow[i] = flow_along(o, x, out, 0);
        }
        for (int i = 0; i < places; i++) sum += o->flow[i];
        o->rate[n].flow = sum / places;
        if (isnan(o->sum[n][OPEN_MEAN_FLOW])) o->sum[n][OPEN_MEAN_FLOW] = o->rate[n].flow;
    }
}

static void set_particle(const struct open_boundaries *o, const struct open_member *m, double time)
{
    const struct fluid_constants *const k = o->k;
    const struct particles *const particles = o->particles;
    const int32_t i = m->particle;
    const int number = particles->open[i] - 1;
    double pressure = m->p, in, on_line[2];
    const struct scene_open *const b = project(o, i, &in, on_line);
    if (b->kind == OPEN_PRESSURE) {
        double given = given_pressure(b, k, on_line, time);
        if (b->absorb > 0) /* T-53 */
            given += k->rho0 * k->c0 * (o->rate[number].flow - o->sum[number][OPEN_MEAN_FLOW]);
        pressure = odd_pressure(b, given, pressure);
    }
    particles->dens[i] = eos_dens(pressure, k->rho0, k->c0);
    if (particles->dens_slow) particles->dens_slow[i] = particles->dens[i];
    double *const velocity[][2] = {{particles->vx, particles->vy},
                                   {particles->vx_half, particles->vy_half},
                                   {particles->vx_old, particles->vy_old}};
    for (int c = 0; c < 2; c++)
        for (int n = 0; n < 3; n++)
            if (velocity[n][c]) velocity[n][c][i] = m->v[c];
}

void open_set(struct open_boundaries *o, double time, bool counts)
{
    const struct fluid_constants *const k = o->k;
    const struct particles *const particles = o->particles;
    fix_times(o, time);
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++)
        particles->p[i] = eos_pressure(particles->dens[i], k->rho0, k->c0);
#pragma omp parallel for schedule(static)
    for (int64_t m = 0; m < o->n_members; m++) mirror_fields(o, &o->member[m]);
    find_flow(o);
    for (int64_t m = 0; m < o->n_members; m++) {
        const int32_t i = o->member[m].particle;
        const double u = particles->vx[i], v = particles->vy[i],
                     energy = particle_energy(k, k->gravity, particles, i);
        set_particle(o, &o->member[m], time);
        if (!counts) continue;
        double *const sum = o->sum[particles->open[i] - 1];
        sum[OPEN_MOMENTUM_X] += particle_mass(k, particles, i) * (particles->vx[i] - u);
        sum[OPEN_MOMENTUM_Y] += particle_mass(k, particles, i) * (particles->vy[i] - v);
        sum[OPEN_ENERGY] += particle_energy(k, k->gravity, particles, i) - energy;
    }
}

void open_hold(struct open_boundaries *o)
{
    const struct particles *const particles = o->particles;
    for (int n = 0; n < o->n; n++) o->rate[n].force[0] = o->rate[n].force[1] = o->rate[n].power = 0;
    for (int64_t m = 0; m < o->n_members; m++) {
        const int32_t i = o->member[m].particle;
        struct open_rate *const r = &o->rate[particles->open[i] - 1];
        const double mass = particle_mass(o->k, particles, i);
        r->force[0] -= mass * particles->ax[i];
        r->force[1] -= mass * particles->ay[i];
        r->power -=
            mass * (particles->ax[i] * particles->vx[i] + particles->ay[i] * particles->vy[i]);
        particles->ax[i] = particles->ay[i] = 0;
        if (particles->div_r) particles->div_r[i] = 0; /* no shift */
    }
}

void open_add_work(struct open_boundaries *o, double dt)
{
    for (int k = 0; k < o->n; k++) {
        double *const sum = o->sum[k];
        sum[OPEN_MOMENTUM_X] += dt * o->rate[k].force[0];
        sum[OPEN_MOMENTUM_Y] += dt * o->rate[k].force[1];
        sum[OPEN_ENERGY] += dt * o->rate[k].power;
        if (!(o->boundary[k].absorb > 0)) continue;
        sum[OPEN_MEAN_FLOW] +=
            dt / (o->boundary[k].absorb + dt) * (o->rate[k].flow - sum[OPEN_MEAN_FLOW]);
    }
}
