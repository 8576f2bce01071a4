/* SPDX-License-Identifier: MIT */
#include "fluid/open.h"

#include "base/hash.h"
#include "base/simd.h"
#include "expr/expr.h"
#include "particles/kernel.h"

#include <math.h>

/* Distance in spacings: fluid this far behind the line joins the buffer, a buffer particle this
 * far in front of it is relabelled without delay. Fluid that oscillates about the line by less
 * creates no copies. */
#define BAND 0.5

static const struct scene_open *boundary_of(const struct open *o, const struct particles *particles,
                                            int64_t i)
{
    return &o->boundary[particles->open[i] - 1];
}

/* Where a particle is: in front of the line on the side of the fluid, and along the line; and its
 * projection on the line. */
struct place {
    double in, along, on_line[2];
};

static struct place place_of(const struct scene_open *b, const struct particles *particles,
                             int64_t i)
{
    const double x[] = {particles->x[i], particles->y[i]};
    struct place at;
    scene_open_place(b, x, &at.in, &at.along);
    for (int c = 0; c < 2; c++) at.on_line[c] = x[c] - at.in * b->inward[c];
    return at;
}

int64_t open_places(const struct scene *scene)
{
    double places = 1;
    int64_t n = scene->points[KIND_FLUID].n;
    for (int c = 0; c < 2; c++)
        places *= (scene->domain_upper[c] - scene->domain_lower[c]) / scene->top.dp;
    const double taken = (double)(n + scene->points[KIND_WALL].n);
    return n + n / 8 + (int64_t)min2(1e9, max2(0, places - taken));
}

/* Boundary n at each time, with expressions of its own. */
static enum err copy_boundary(struct open *o, int n, struct arena *a, struct diag *d)
{
    const struct scene_open *const b = &o->boundary[n];
    for (int m = 0; m < OPEN_TIMES; m++) {
        struct open_moment *const at = &o->at[n][m];
        *at = (struct open_moment){.boundary = *b};
        if (b->speed) TRY(expr_copy(&at->speed, b->speed, a, d));
        for (int c = 0; c < 2 && b->velocity[c]; c++)
            TRY(expr_copy(&at->velocity[c], b->velocity[c], a, d));
        at->boundary.speed = at->speed;
        for (int c = 0; c < 2; c++) at->boundary.velocity[c] = at->velocity[c];
    }
    return ERR_OK;
}

/* The times at which an evaluation takes the given velocities. Their rate is that over the time
 * in which sound crosses h. */
static void find_times(const struct fluid_constants *k, double time, double t[OPEN_TIMES])
{
    t[OPEN_BEFORE] = max2(0, time - 0.5 * k->h / k->c0);
    t[OPEN_AFTER] = t[OPEN_BEFORE] + k->h / k->c0;
    t[OPEN_NOW] = time;
}

/* Functions of time alone are then evaluated once a step instead of once a particle. */
static void fix_times(struct open *o, const struct fluid_constants *k, double time)
{
    double t[OPEN_TIMES];
    find_times(k, time, t);
    for (int n = 0; n < o->n; n++)
        for (int m = 0; m < OPEN_TIMES; m++) {
            const struct scene_open *const b = &o->boundary[n];
            struct open_moment *const at = &o->at[n][m];
            if (b->speed) expr_fix_time(at->speed, b->speed, t[m]);
            for (int c = 0; c < 2 && b->velocity[c]; c++)
                expr_fix_time(at->velocity[c], b->velocity[c], t[m]);
        }
}

enum err open_create(struct open *o, struct arena *a, const struct scene *scene, int64_t next_id,
                     struct diag *d)
{
    const size_t n = (size_t)scene_open_count(scene);
    int64_t members = 0;
    for (int64_t i = 0; i < scene->points[KIND_FLUID].n; i++)
        members += scene->points[KIND_FLUID].open[i] > 0;
    o->n = (int)n;
    o->next_id = next_id;
    o->capacity = 4 * members + 64;
    o->boundary = arena_alloc(a, n, sizeof *o->boundary, "open boundaries", d);
    o->at = arena_alloc(a, n, sizeof *o->at, "open boundaries", d);
    o->sum = arena_alloc(a, n, sizeof *o->sum, "open boundaries", d);
    o->count = arena_alloc(a, n, sizeof *o->count, "open boundaries", d);
    o->rate = arena_alloc(a, n, sizeof *o->rate, "open boundaries", d);
    const size_t capacity = (size_t)o->capacity;
    o->member = arena_alloc(a, capacity, sizeof *o->member, "open boundaries", d);
    o->flow = arena_alloc(a, capacity, sizeof *o->flow, "open boundaries", d);
    if (!o->flow || !o->boundary || !o->at || !o->sum || !o->count || !o->rate || !o->member)
        return ERR_MEMORY;
    for (int k = 0; k < o->n; k++) {
        o->boundary[k] = scene_open_at(scene, k);
        TRY(copy_boundary(o, k, a, d));
        o->sum[k][OPEN_MEAN_FLOW] = (double)NAN;
    }
    return ERR_OK;
}

/* --- the fluid across a line --- */

/* Sums of the kernel, without its norm, over the fluid around a point: of pressure and velocity,
 * which times the vector to the particles; of that vector and its products; of rho/rho0 times the
 * vector back. */
enum { S_W, S_P, S_U, S_UX, S_UY, S_V, S_VX, S_VY, S_X, S_Y, S_XX, S_XY, S_YY, S_GX, S_GY, S_SUMS };

/* Adds up to four particles of a cell from i on, at vectors (x, y) from the point. */
SPHFSI_INLINE void add_across(four_double sum[S_SUMS], double inv_h,
                              const struct particles *particles, int32_t i, int count,
                              four_double x, four_double y)
{
    const four_long lane = {0, 1, 2, 3};
    const four_double r2 = x * x + y * y;
    const four_long seen = (four_long)(r2 < square(KERNEL_REACH / inv_h)) & (lane < count);
    if (!(seen[0] | seen[1] | seen[2] | seen[3])) return;
    const four_double q = four_sqrt(r2) * inv_h, t = 1 - 0.5 * q;
    four_double w = t * t * (t * t) * (2 * q + 1);
    for (int r = 0; r < CLUSTER; r++)
        w[r] = seen[r] && particles->open[i + r] == 0 ? w[r] : 0; /* not the buffers */
    const four_double u = FOUR(particles->vx, i), v = FOUR(particles->vy, i), wx = w * x,
                      wy = w * y, mass = 1 + FOUR(particles->dens, i);
    sum[S_W] += w;
    sum[S_P] += w * FOUR(particles->p, i);
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
    sum[S_GX] -= wx * mass;
    sum[S_GY] -= wy * mass;
}

/* The fluid within reach of a point, without the buffers. */
static void state_across(const struct fluid_constants *k, const struct particles *particles,
                         const struct cells *cells, const double at[2], double sum[S_SUMS])
{
    const struct cell_list *const list = &cells->kind[KIND_FLUID];
    const struct cell_window window = cells_window(cells, at, KERNEL_REACH * k->h);
    four_double s[S_SUMS] = {{0}};
    for (int m = 0; m < window.n[0] * window.n[1]; m++) {
        const int32_t cell = window_cell(cells, &window, m);
        if (cell < 0) continue;
        const double cx = cell_centre_x(cells, cell), cy = cell_centre_y(cells, cell);
        const double dx = cells_minimum_image(cells, 0, cx - at[0]) - cx,
                     dy = cells_minimum_image(cells, 1, cy - at[1]) - cy;
        for (int32_t n = 0, i = list->start[cell]; n < list->count[cell]; n += 4, i += 4)
            add_across(s, 1 / k->h, particles, i, list->count[cell] - n, FOUR(particles->x, i) + dx,
                       FOUR(particles->y, i) + dy);
    }
    for (int m = 0; m < S_SUMS; m++) sum[m] = (s[m][0] + s[m][2]) + (s[m][1] + s[m][3]);
}

/* T-51: the value at the point of the linear field fitted to the sums of a velocity; their mean if
 * the particles span no plane. */
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
static double flow_along(const struct fluid_constants *k, const struct particles *particles,
                         const struct cells *cells, const double at[2], const double n[2],
                         double otherwise)
{
    double s[S_SUMS];
    state_across(k, particles, cells, at, s);
    if (!(s[S_W] > 0)) return otherwise;
    return linear_value(s, S_U) * n[0] + linear_value(s, S_V) * n[1];
}

/* --- fields of the buffers --- */

/* Rate of the given velocity at a point of the line, over the time in which sound crosses h. */
static void given_acceleration(const struct open_moment at[OPEN_TIMES],
                               const struct fluid_constants *k, const double x[2], double time,
                               double a[2])
{
    double t[OPEN_TIMES], v[2];
    find_times(k, time, t);
    scene_open_velocity(&at[OPEN_BEFORE].boundary, x, t[OPEN_BEFORE], v);
    scene_open_velocity(&at[OPEN_AFTER].boundary, x, t[OPEN_AFTER], a);
    for (int c = 0; c < 2; c++) a[c] = (a[c] - v[c]) / (t[OPEN_AFTER] - t[OPEN_BEFORE]);
}

/* A buffer particle's pressure from the fluid at its mirror image in the line (T-52), and with a
 * given pressure its velocity, from the fluid around its projection on the line (T-51): velocities
 * that varied along the normal would compress the buffer, because it has none along the line. With
 * a given velocity: the pressure that T-10 gives a wall with that velocity (T-50). Without fluid
 * there its fields do not change. */
static void mirror_fields(const struct open *o, struct open_member *m,
                          const struct fluid_constants *k, const struct particles *particles,
                          const struct cells *cells, double time)
{
    const int32_t i = m->particle;
    const struct scene_open *const b = boundary_of(o, particles, i);
    const struct place at = place_of(b, particles, i);
    double mirror[2], a[2], s[S_SUMS];
    for (int c = 0; c < 2; c++) mirror[c] = at.on_line[c] + fabs(at.in) * b->inward[c];
    state_across(k, particles, cells, mirror, s);
    const double w = s[S_W];
    m->v[0] = particles->vx[i];
    m->v[1] = particles->vy[i];
    if (b->kind == OPEN_PRESSURE) {
        m->p = w > 0 ? s[S_P] / w : (double)NAN;
        const double normal = flow_along(k, particles, cells, at.on_line, b->inward, (double)NAN);
        for (int c = 0; c < 2 && !isnan(normal); c++) m->v[c] = normal * b->inward[c];
        return;
    }
    m->p = eos_pressure(particles->dens[i], k->rho0, k->c0);
    if (!(w > 0)) return;
    given_acceleration(o->at[particles->open[i] - 1], k, at.on_line, time, a);
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

/* T-52: pressure of a buffer particle such that it is `given` on the line; no tension at the end of
 * the water. */
static double odd_pressure(const struct scene_open *b, double given, double mirrored)
{
    if (isnan(mirrored)) return given;
    const double odd = 2 * given - mirrored;
    return b->pressure ? odd : max2(0, odd);
}

/* Velocity out of the fluid a spacing in front of the line, at fixed points: particles that come
 * and go would add noise. */
static double flow_at(const struct scene_open *b, const struct fluid_constants *k,
                      const struct particles *particles, const struct cells *cells, double along)
{
    const double out[] = {-b->inward[0], -b->inward[1]};
    double x[2];
    for (int c = 0; c < 2; c++) x[c] = b->from[c] + along * b->along[c] + k->dp * b->inward[c];
    return flow_along(k, particles, cells, x, out, 0);
}

/* The mean flow out of the fluid through each boundary that uses it. */
static void find_flow(struct open *o, const struct fluid_constants *k,
                      const struct particles *particles, const struct cells *cells)
{
    for (int n = 0; n < o->n; n++) {
        const struct scene_open *const b = &o->boundary[n];
        const int places = (int)max2(1, min2((double)o->capacity, round(b->length / k->dp)));
        double sum = 0;
        if (!(b->absorb > 0)) continue;
#pragma omp parallel for schedule(static)
        for (int i = 0; i < places; i++)
            o->flow[i] = flow_at(b, k, particles, cells, (i + 0.5) * b->length / places);
        for (int i = 0; i < places; i++) sum += o->flow[i];
        o->rate[n].flow = sum / places;
        if (isnan(o->sum[n][OPEN_MEAN_FLOW])) o->sum[n][OPEN_MEAN_FLOW] = o->rate[n].flow;
    }
}

/* Adds momentum and energy of a particle to the sums of its boundary, or takes them off. */
static void count_particle(struct open *o, const struct fluid_constants *k,
                           const struct particles *particles, int64_t i, double sign)
{
    double *const sum = o->sum[particles->open[i] - 1];
    sum[OPEN_MOMENTUM_X] += sign * particle_mass(k, particles, i) * particles->vx[i];
    sum[OPEN_MOMENTUM_Y] += sign * particle_mass(k, particles, i) * particles->vy[i];
    sum[OPEN_ENERGY] += sign * particle_energy(k, k->gravity, particles, i);
}

static void set_particle(const struct open *o, const struct open_member *m,
                         const struct fluid_constants *k, struct particles *particles, double time)
{
    const int32_t i = m->particle;
    const int number = particles->open[i] - 1;
    const struct scene_open *const b = &o->boundary[number];
    const struct place at = place_of(b, particles, i);
    double v[2] = {m->v[0], m->v[1]}, pressure = m->p;
    if (b->kind == OPEN_PRESSURE) {
        double given = given_pressure(b, k, at.on_line, time);
        if (b->absorb > 0) /* T-53 */
            given += k->rho0 * k->c0 * (o->rate[number].flow - o->sum[number][OPEN_MEAN_FLOW]);
        pressure = odd_pressure(b, given, pressure);
    } else {
        scene_open_velocity(&o->at[number][OPEN_NOW].boundary, at.on_line, time, v);
    }
    particles->dens[i] = eos_dens(pressure, k->rho0, k->c0);
    if (particles->dens_slow) particles->dens_slow[i] = particles->dens[i];
    double *const velocity[][2] = {{particles->vx, particles->vy},
                                   {particles->vx_half, particles->vy_half},
                                   {particles->vx_old, particles->vy_old}};
    for (int c = 0; c < 2; c++)
        for (int n = 0; n < 3; n++)
            if (velocity[n][c]) velocity[n][c][i] = v[c];
}

void open_set(struct open *o, const struct fluid_constants *k, struct particles *particles,
              const struct cells *cells, double time, bool counts)
{
    fix_times(o, k, time);
#pragma omp parallel for simd schedule(static)
    for (int64_t i = 0; i < particles->n; i++)
        particles->p[i] = eos_pressure(particles->dens[i], k->rho0, k->c0);
#pragma omp parallel for schedule(static)
    for (int64_t m = 0; m < o->n_members; m++)
        mirror_fields(o, &o->member[m], k, particles, cells, time);
    find_flow(o, k, particles, cells);
    for (int64_t m = 0; m < o->n_members; m++) {
        const int32_t i = o->member[m].particle;
        const double u = particles->vx[i], v = particles->vy[i],
                     energy = particle_energy(k, k->gravity, particles, i);
        set_particle(o, &o->member[m], k, particles, time);
        if (!counts) continue;
        double *const sum = o->sum[particles->open[i] - 1];
        sum[OPEN_MOMENTUM_X] += particle_mass(k, particles, i) * (particles->vx[i] - u);
        sum[OPEN_MOMENTUM_Y] += particle_mass(k, particles, i) * (particles->vy[i] - v);
        sum[OPEN_ENERGY] += particle_energy(k, k->gravity, particles, i) - energy;
    }
}

void open_hold(struct open *o, const struct fluid_constants *k, struct particles *particles)
{
    for (int n = 0; n < o->n; n++) o->rate[n].force[0] = o->rate[n].force[1] = o->rate[n].power = 0;
    for (int64_t m = 0; m < o->n_members; m++) {
        const int32_t i = o->member[m].particle;
        struct open_rate *const r = &o->rate[particles->open[i] - 1];
        r->force[0] -= particle_mass(k, particles, i) * particles->ax[i];
        r->force[1] -= particle_mass(k, particles, i) * particles->ay[i];
        r->power -= particle_mass(k, particles, i) *
                    (particles->ax[i] * particles->vx[i] + particles->ay[i] * particles->vy[i]);
        particles->ax[i] = particles->ay[i] = 0;
    }
}

void open_add_work(struct open *o, double dt)
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

/* --- exchange --- */

bool open_due(const struct open *o, const struct particles *particles, double dp)
{
    bool due = false;
    for (int64_t m = 0; m < o->n_members; m++) {
        const int32_t i = o->member[m].particle;
        due |= place_of(boundary_of(o, particles, i), particles, i).in > BAND * dp;
    }
    return due;
}

/* Of the strips of a buffer: one spacing or nearly so. */
static double strip_width(const struct scene_open *b, double dp)
{
    return b->length / max2(1, round(b->length / dp));
}

/* From a place on the line to the middle of its strip; 0 but for rounding. */
static double aside_of(const struct scene_open *b, double along, double dp)
{
    const double width = strip_width(b, dp), aside = (floor(along / width) + 0.5) * width - along;
    return fabs(aside) > 1e-6 * dp ? aside : 0;
}

/* A copy of a particle that enters, in the middle of its strip, at `in` before the line. */
static enum err make_copy(struct open *o, const struct fluid_constants *k,
                          struct particles *particles, int64_t i, double in, struct diag *d)
{
    const int number = particles->open[i] - 1;
    const struct scene_open *const b = &o->boundary[number];
    if (particles->n == particles->capacity)
        return diag_fail(
            d, ERR_GUARD,
            "[%s %s] has brought in so much fluid that the limit of %lld particles is reached, "
            "because more fluid enters than leaves; a larger [domain] or an [outflow] may help",
            b->word, b->common->name, (long long)particles->capacity);
    const int64_t to = particles->n++;
    const struct place at = place_of(b, particles, i);
    const double aside = aside_of(b, at.along, k->dp);
    particles_copy(particles, i, to);
    particles->id[to] = o->next_id++;
    particles->x[to] += (in - at.in) * b->inward[0] + aside * b->along[0];
    particles->y[to] += (in - at.in) * b->inward[1] + aside * b->along[1];
    o->count[number][OPEN_ENTERED]++;
    count_particle(o, k, particles, to, 1);
    return ERR_OK;
}

/* The strip of a buffer, one spacing wide along the normal, that a place lies in. Every place on
 * the line belongs to one strip, so fluid that returns adds none. */
static int strip_of(const struct scene_open *b, const struct place *at, double dp)
{
    return (int)floor(at->along / strip_width(b, dp));
}

/* Distance of the last particle in the strip of i from the line. Particles from `fresh` on are
 * new. */
static double last_of_strip(const struct open *o, const struct particles *particles, int64_t i,
                            int64_t fresh, double dp)
{
    const struct scene_open *const b = boundary_of(o, particles, i);
    const struct place own = place_of(b, particles, i);
    double last = own.in;
    for (int64_t m = 0; m < o->n_members + particles->n - fresh; m++) {
        const int64_t j = m < o->n_members ? o->member[m].particle : fresh + m - o->n_members;
        const struct place at = place_of(b, particles, j);
        if (particles->open[j] == particles->open[i] &&
            strip_of(b, &at, dp) == strip_of(b, &own, dp))
            last = min2(last, at.in);
    }
    return last;
}

/* T-54: fills the strip behind a particle that enters, but not above the level. Compressed
 * fluid has smaller distances: the inflow is its density times its velocity. */
static enum err fill_strip(struct open *o, const struct fluid_constants *k,
                           struct particles *particles, int64_t i, int64_t fresh, struct diag *d)
{
    const struct scene_open *const b = boundary_of(o, particles, i);
    const double spacing = k->dp / (1 + particles->dens[i]);
    if (particles->y[i] > b->level) return ERR_OK; /* NAN: none */
    double in = last_of_strip(o, particles, i, fresh, k->dp) - spacing;
    for (; in >= -b->depth; in -= spacing) TRY(make_copy(o, k, particles, i, in, d));
    return ERR_OK;
}

/* Whether the buffer has no space for fluid that has come in: above its level, or close to a
 * buffer particle that moves inward. Two particles in one place would burst apart. */
static bool strip_is_full(const struct open *o, const struct particles *particles, int64_t i,
                          double dp)
{
    const struct scene_open *const b = boundary_of(o, particles, i);
    const struct place own = place_of(b, particles, i);
    bool full = particles->y[i] > b->level; /* it runs off over the inflow; NAN: none */
    for (int64_t m = 0; m < o->n_members && !full; m++) {
        const int64_t j = o->member[m].particle;
        const struct place at = place_of(b, particles, j);
        full = particles->open[j] == particles->open[i] &&
               strip_of(b, &at, dp) == strip_of(b, &own, dp) && fabs(at.in - own.in) < BAND * dp &&
               particles->vx[j] * b->inward[0] + particles->vy[j] * b->inward[1] > 0;
    }
    return full && b->kind == OPEN_VELOCITY;
}

/* Whether a place is in the buffer or in front of it. The sides of the buffer are walls, which do
 * not affect its motion. */
static bool in_buffer(const struct scene_open *b, const struct place *at, double dp)
{
    return at->in >= -b->depth - dp && at->along > 0 && at->along < b->length;
}

/* The boundary whose buffer contains fluid particle i, from 1; 0: none. */
static int32_t buffer_at(const struct open *o, const struct particles *particles, int64_t i,
                         double dp)
{
    for (int k = 0; k < o->n; k++) {
        const struct scene_open *const b = &o->boundary[k];
        const struct place at = place_of(b, particles, i);
        if (at.in < -BAND * dp && in_buffer(b, &at, dp)) return k + 1;
    }
    return 0;
}

/* Removes the particles that have left their buffers, and those that found no space in one. */
static void end_particles(struct open *o, const struct fluid_constants *k,
                          struct particles *particles)
{
    int64_t kept = 0;
    for (int64_t i = 0; i < particles->n; i++) {
        bool ends = particles->open[i] < 0; /* found no space */
        if (ends) particles->open[i] = -particles->open[i];
        if (particles->open[i]) {
            const struct place at = place_of(boundary_of(o, particles, i), particles, i);
            ends |= !in_buffer(boundary_of(o, particles, i), &at, k->dp);
        }
        if (ends) {
            o->count[particles->open[i] - 1][OPEN_LEFT]++;
            count_particle(o, k, particles, i, -1);
            continue;
        }
        if (kept < i) particles_copy(particles, i, kept);
        kept++;
    }
    particles->n = kept;
}

/* Marks fluid that is to be removed. The given velocity is then not all that passes the line. */
static void mark_returned(struct open *o, struct particles *particles, int64_t i, struct diag *d)
{
    const struct scene_open *const b = boundary_of(o, particles, i);
    if (!o->warned)
        diag_warn(
            d,
            "[%s %s] fluid runs back over the line at (%.4g, %.4g) m and is removed: less "
            "flows in than is given; a higher `level`, a slower start or a further line may help",
            b->word, b->common->name, particles->x[i], particles->y[i]);
    o->warned = true;
    particles->open[i] = -particles->open[i];
}

enum err open_exchange(struct open *o, const struct fluid_constants *k, struct particles *particles,
                       struct diag *d)
{
    const int64_t n = particles->n; /* copies follow behind */
    enum err e = ERR_OK;
    for (int64_t i = 0; i < n && !e; i++) {
        if (particles->open[i] == 0) {
            particles->open[i] = buffer_at(o, particles, i, k->dp);
            if (particles->open[i] && strip_is_full(o, particles, i, k->dp))
                mark_returned(o, particles, i, d);
            continue;
        }
        const struct scene_open *const b = boundary_of(o, particles, i);
        const struct place at = place_of(b, particles, i);
        if (at.in <= 0 || !in_buffer(b, &at, k->dp)) continue;
        e = fill_strip(o, k, particles, i, n, d);
        particles->open[i] = 0;
    }
    end_particles(o, k, particles);
    return e;
}

enum err open_list(struct open *o, const struct particles *particles, struct diag *d)
{
    o->n_members = 0;
    for (int64_t i = 0; i < particles->n; i++) {
        if (particles->open[i] == 0) continue;
        if (particles->open[i] < 0 || particles->open[i] > o->n)
            return diag_fail(
                d, ERR_INPUT,
                "checkpoint: fluid particle %lld belongs to open boundary %d, but the case has "
                "only %d; restore the [inflow] and [outflow] sections of the checkpoint",
                (long long)particles->id[i], (int)particles->open[i], o->n);
        if (o->n_members == o->capacity)
            return diag_fail(d, ERR_GUARD,
                             "the buffers of the open boundaries contain four times as many "
                             "particles as at the start. Fluid collects in them; a finer dp or a "
                             "line further from the disturbance may help");
        o->member[o->n_members++].particle = (int32_t)i;
    }
    return ERR_OK;
}

double open_energy(const struct open *o)
{
    double sum = 0;
    for (int k = 0; k < o->n; k++) sum += o->sum[k][OPEN_ENERGY];
    return sum;
}

void open_forget(struct open *o)
{
    for (int k = 0; k < o->n; k++)
        o->sum[k][OPEN_MOMENTUM_X] = o->sum[k][OPEN_MOMENTUM_Y] = o->sum[k][OPEN_ENERGY] = 0;
}

uint64_t open_hash(const struct open *o, uint64_t h)
{
    h = hash_bytes(h, o->sum, (size_t)o->n * sizeof *o->sum);
    h = hash_bytes(h, o->count, (size_t)o->n * sizeof *o->count);
    return hash_bytes(h, &o->next_id, sizeof o->next_id);
}
