/* SPDX-License-Identifier: MIT
 * What the buffers of open boundaries take from the fluid, against sums over all particles, with
 * noise in every field: T-50, T-51. */
#include "fluid/eos.h"
#include "particles/kernel.h"
#include "rig.h"
#include "unity.h"

#include <math.h>

static struct rig rig;
static struct particles *p;

void tearDown(void) { rig_close(&rig); }

/* The inflow's velocity grows by 2 m/s^2; gravity is oblique; the lines end near the edge of the
 * domain. */
void setUp(void)
{
    rig_one_thread();
    rig_open(&rig,
             "dp = 0.05\nend_time = 10\ngravity = 3, -9\n[domain]\nlower = -0.4, -0.11\n"
             "upper = 1.4, 0.61\n[fluid w]\nshape = box 0, 0, 1, 0.5\n"
             "sound_speed = 10\nvelocity = 1, 0\n[wall plates]\nshape = box -0.4, -0.1, 1.4, 0\n"
             "shape = box -0.4, 0.5, 1.4, 0.6\n[inflow left]\nfrom = 0, 0.5\nto = 0, 0\n"
             "speed = 1 + 2*t\n[outflow right]\nfrom = 1, 0\nto = 1, 0.5\npressure = 200\n",
             NULL);
    p = &rig.sim.particles[KIND_FLUID];
    uint64_t seed = 5;
    for (int64_t i = 0; i < p->n; i++) {
        p->dens[i] = 0.02 * noise(&seed);
        p->vx[i] = 1 + 0.5 * noise(&seed);
        p->vy[i] = 0.5 * noise(&seed);
    }
}

/* The fluid around a point: weighted sums of 1, x, y, xx, xy, yy with x from the point, and of a
 * field with 1, x, y. */
struct fit {
    double w, x, y, xx, xy, yy, f, fx, fy;
};

static struct fit around(const double at[2], double (*field)(int64_t i))
{
    struct fit s = {0};
    for (int64_t i = 0; i < p->n; i++) {
        if (p->open[i]) continue;
        const double x = p->x[i] - at[0], y = p->y[i] - at[1];
        const double w = kernel_w(hypot(x, y), rig.sim.fluid.k.h), f = field(i);
        s.w += w, s.x += w * x, s.y += w * y;
        s.xx += w * x * x, s.xy += w * x * y, s.yy += w * y * y;
        s.f += w * f, s.fx += w * f * x, s.fy += w * f * y;
    }
    return s;
}

/* The value at the point of the plane with the least weighted squares of differences: Cramer's
 * rule. */
static double plane(const struct fit *s)
{
    const double det = s->w * (s->xx * s->yy - s->xy * s->xy) -
                       s->x * (s->x * s->yy - s->xy * s->y) + s->y * (s->x * s->xy - s->xx * s->y);
    return (s->f * (s->xx * s->yy - s->xy * s->xy) - s->x * (s->fx * s->yy - s->xy * s->fy) +
            s->y * (s->fx * s->xy - s->xx * s->fy)) /
           det;
}

static double pressure_of(int64_t i) { return eos_pressure(p->dens[i], 1000, 10); }
static double u_of(int64_t i) { return p->vx[i]; }

static double wall_at[2];
/* T-10: the pressure that a wall at that place, with an acceleration of 2 along x, gets from a
 * particle. */
static double wall_pressure_of(int64_t i)
{
    return pressure_of(i) + 1000 * (1 + p->dens[i]) *
                                ((3 - 2) * (wall_at[0] - p->x[i]) - 9 * (wall_at[1] - p->y[i]));
}

/* Pressures are those at the mirror image, velocities those at the line. From the mirror to the
 * buffer's particle the fluid has the density at rest. */
static void test_buffers_see_the_fluid_across_the_line(void)
{
    struct open_boundaries *const o = &rig.sim.open;
    open_set(o, 0.5, false);
    int seen[2] = {0};
    for (int64_t m = 0; m < o->n_members; m++) {
        const int32_t i = o->member[m].particle;
        const bool inflow = p->open[i] == 1;
        const double line = inflow ? 0 : 1, mirror[2] = {2 * line - p->x[i], p->y[i]};
        wall_at[0] = mirror[0], wall_at[1] = mirror[1];
        const struct fit s = around(mirror, inflow ? wall_pressure_of : pressure_of);
        if (!(s.w > 0)) continue;
        seen[!inflow]++;
        const double more = inflow ? 1000 * (3 - 2) * (p->x[i] - mirror[0]) : 0;
        assert_near(1e-8, s.f / s.w + more, o->member[m].p, "pressure");
        if (inflow) continue;
        const struct fit u = around((const double[]){line, p->y[i]}, u_of);
        assert_near(1e-9, plane(&u), o->member[m].v[0], "velocity along x");
        assert_near(1e-12, 0, o->member[m].v[1], "velocity along y");
    }
    TEST_ASSERT_TRUE(seen[0] >= 30 && seen[1] >= 30);
}

/* Momentum and energy that the buffers get are booked. */
static void test_what_is_set_is_booked(void)
{
    struct open_boundaries *const o = &rig.sim.open;
    const struct fluid_constants *const k = &rig.sim.fluid.k;
    double want[2][3] = {{0}};
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int64_t m = 0; m < o->n_members; m++) {
            const int32_t i = o->member[m].particle;
            double *const sum = want[p->open[i] - 1];
            sum[0] += sign * k->mass * p->vx[i];
            sum[1] += sign * k->mass * p->vy[i];
            sum[2] += sign * k->mass *
                      (0.5 * (square(p->vx[i]) + square(p->vy[i])) + eos_energy(p->dens[i], 10));
        }
        if (sign < 0) open_set(o, 0.5, true);
    }
    for (int n = 0; n < 2; n++) {
        TEST_ASSERT_TRUE(fabs(want[n][2]) > 0.1);
        assert_near(1e-9, want[n][0], o->sum[n][OPEN_MOMENTUM_X], "momentum x");
        assert_near(1e-9, want[n][1], o->sum[n][OPEN_MOMENTUM_Y], "momentum y");
        assert_near(1e-9, want[n][2], o->sum[n][OPEN_ENERGY], "energy");
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_buffers_see_the_fluid_across_the_line);
    RUN_TEST(test_what_is_set_is_booked);
    return UNITY_END();
}
