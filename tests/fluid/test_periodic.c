/* SPDX-License-Identifier: MIT
 * Periodic sides: what leaves comes in opposite, and nothing tells where the side is.
 *
 * The pair of test_fluid.c through a side: h = 1 m, m = 640 kg/m, c0 = 10 m/s, x_ab = (0.6, 0.8),
 * rho = 1010 and 1020 kg/m^3: 0.6822899792818219 m/s^2 apart. */
#include "output/probes.h"
#include "time/energy.h"
#include "rig.h"
#include "unity.h"

#include <math.h>

static const char pair[] = "dp = 0.8\nend_time = 1\nprecision = double\n"
                           "[numerics]\nh_over_dp = 1.25\nskin = 0.5\n"
                           "[domain]\nlower = -10, -8\nupper = 10, 8\nperiodic = xy\n"
                           "[fluid w]\nshape = box 0, 0, 1.6, 0.8\nsound_speed = 10\n";

#define WATER                                                                    \
    "dp = 1 cm\nend_time = 10\nprecision = double\ngravity = 1, -9.81\n"         \
    "[domain]\nlower = -0.1, -0.1\nupper = 0.2, 0.3\nperiodic = x\n"             \
    "[fluid w]\nshape = box -0.1, 0, 0.2, 0.1\nminus = box 0.1, 0, 0.14, 0.05\n" \
    "sound_speed = 20\nsurface = 0.1\nartificial_viscosity = 0.1\n"              \
    "density_diffusion = 0.1\n[fluid w2]\nlike = w\nshape = box 0, 0.1, 0.05, 0.12\n"
static const char water[] = WATER;
static const char channel[] = WATER "[wall bed]\nshape = box -0.1, -0.04, 0.2, 0\n"
                                    "[wall sill]\nshape = box 0.1, 0, 0.14, 0.05\nmotion = drift\n"
                                    "[motion drift]\nx = 0.5*t\n";

static struct rig rig;
static struct particles *p;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

static int64_t index_of(const struct particles *particles, int64_t id)
{
    for (int64_t i = 0; i < particles->n; i++)
        if (particles->id[i] == id) return i;
    TEST_FAIL_MESSAGE("a particle is missing");
    return -1;
}

static void pair_through(double ax, double ay, double bx, double by)
{
    rig_open(&rig, pair, NULL);
    p = &rig.sim.particles[KIND_FLUID];
    TEST_ASSERT_EQUAL_INT64(2, p->n);
    const double x[2] = {ax, bx}, y[2] = {ay, by}, dens[2] = {0.01, 0.02};
    for (int64_t i = 0; i < 2; i++) {
        p->id[i] = i;
        p->x[i] = x[i];
        p->y[i] = y[i];
        p->dens[i] = dens[i];
    }
    rig_sort(&rig);
    rig_evaluate(&rig);
    const int64_t a = index_of(p, 0), b = index_of(p, 1);
    assert_near(1e-12, 0.6 * 0.6822899792818219, p->ax[a], "ax of a");
    assert_near(1e-12, 0.8 * 0.6822899792818219, p->ay[a], "ay of a");
    assert_near(1e-12, -0.6 * 0.6822899792818219, p->ax[b], "ax of b");
    assert_near(1e-12, -0.8 * 0.6822899792818219, p->ay[b], "ay of b");
}

static void test_pair_through_the_sides(void)
{
    pair_through(-9.7, 0.4, 9.7, -0.4); /* in x */
    pair_through(0.3, -7.6, -0.3, 7.6); /* in y */
    pair_through(-9.7, -7.6, 9.7, 7.6); /* through the corner */
    pair_through(10.3, 0.4, 9.7, -0.4); /* a has left and comes in opposite */
    assert_near(1e-14, -9.7, p->x[index_of(p, 0)], "x of a");
}

/* Fluid that leaves is not lost, and what gravity along the period gives it is accounted for. */
static void test_free_fall_round_the_period(void)
{
    rig_open(&rig, water, "domain.periodic=xy", "gravity=3, -4", "w.surface=-1",
             "w.artificial_viscosity=0", "end_time=2", NULL);
    p = &rig.sim.particles[KIND_FLUID];
    rig_sort(&rig);
    const int64_t n = p->n;
    for (int64_t i = 0; i < n; i++) p->dens[i] = 0;
    rig.sim.state.energy_start = simulation_ledger(&rig.sim).potential;
    rig_run(&rig, 0.4);
    TEST_ASSERT_EQUAL_INT64(n, p->n);
    TEST_ASSERT_EQUAL_INT64(0, rig.sim.state.lost);
    TEST_ASSERT_TRUE(rig.sim.state.periodic_energy > 0);
    const struct ledger row = simulation_ledger(&rig.sim);
    assert_near(1e-4 * row.kinetic, 0.5 * row.mass * square(0.4 * 5), row.kinetic, "kinetic");
    assert_at_most(1e-4 * row.kinetic, fabs(row.dissipated), "energy not accounted for");
}

/* By id, so that the order of the cells does not matter; those of the fluid begin at 0. */
static void disorder(struct particles *q, uint64_t *seed)
{
    for (int64_t k = 0; k < q->n; k++) {
        const int64_t i = index_of(q, k);
        q->x[i] += 0.002 * noise(seed);
        q->y[i] += 0.002 * noise(seed);
        q->vx[i] = noise(seed);
        q->vy[i] = noise(seed);
        q->dens[i] = 0.01 + 0.01 * noise(seed);
    }
}

/* All particles by a part of the period: the same accelerations, of each to the round-off of the
 * largest term, c0^2 dens/dp = 8e2 m/s^2. Walls as well: the one that moves is carried as it is. */
static void shift_by(double dx, double dy, double tolerance, const char *precision)
{
    enum { MOST = 400 };
    static double ax[MOST], ay[MOST], rate[MOST];
    for (int shifted = 0; shifted < 2; shifted++) {
        rig_open(&rig, channel, precision, dy != 0 ? "domain.periodic=xy" : "domain.periodic=x",
                 NULL);
        p = &rig.sim.particles[KIND_FLUID];
        TEST_ASSERT_TRUE(p->n > 250 && p->n <= MOST);
        uint64_t seed = 7;
        disorder(p, &seed);
        for (int kind = 0; kind < KIND_SOLID && shifted; kind++) {
            for (int64_t i = 0; i < rig.sim.particles[kind].n; i++) {
                rig.sim.particles[kind].x[i] += dx;
                rig.sim.particles[kind].y[i] += dy;
            }
        }
        rig_sort(&rig);
        rig_evaluate(&rig);
        for (int64_t k = 0; k < p->n; k++) {
            const int64_t i = index_of(p, k);
            if (shifted) {
                assert_near(tolerance, ax[k], p->ax[i], "ax");
                assert_near(tolerance, ay[k], p->ay[i], "ay");
                assert_near(tolerance, rate[k], p->ddens[i], "rate of density");
            }
            ax[k] = p->ax[i];
            ay[k] = p->ay[i];
            rate[k] = p->ddens[i];
        }
    }
}

static void test_places_are_equal(void)
{
    shift_by(0.37 * 0.3, 0, 1e-10, "precision=double");
    shift_by(-0.11, 0.17, 1e-10, "precision=double");
    shift_by(0.6, 0, 1e-10, "precision=double"); /* round and round again */
    shift_by(0.37 * 0.3, 0, 1e-2, "precision=mixed");
}

/* In a box with all sides joined nothing but the particles themselves can take momentum. */
static void test_momentum_of_a_periodic_box(void)
{
    rig_open(&rig, water, "domain.periodic=xy", "gravity=0, 0", "w.surface=-1", NULL);
    p = &rig.sim.particles[KIND_FLUID];
    uint64_t seed = 5;
    disorder(p, &seed);
    rig_sort(&rig);
    rig_evaluate(&rig);
    double sum_x = 0, sum_y = 0, size = 0;
    for (int64_t i = 0; i < p->n; i++) {
        sum_x += p->ax[i];
        sum_y += p->ay[i];
        size += hypot(p->ax[i], p->ay[i]);
    }
    TEST_ASSERT_TRUE(size > 1);
    assert_near(1e-13 * size, 0, sum_x, "sum of forces, x");
    assert_near(1e-13 * size, 0, sum_y, "sum of forces, y");
}

/* A wall that drifts through the side keeps its fluid: pressures and count. */
static void test_moving_wall_goes_through_the_side(void)
{
    rig_open(&rig, channel, "gravity=0, -9.81", NULL);
    p = &rig.sim.particles[KIND_FLUID];
    const int64_t n = p->n;
    rig_run(&rig,
            0.3); /* the sill goes by half a period: from 0.1 ... 0.14 through the side at 0.2 */
    TEST_ASSERT_EQUAL_INT64(n, p->n);
    simulation_refresh(&rig.sim);
    const struct particles *const w = &rig.sim.particles[KIND_WALL];
    int64_t wet = 0, beyond = 0;
    for (int64_t i = 0; i < w->n; i++) {
        if (w->body[i] != 1) continue;
        beyond += w->x[i] > 0.2;
        wet += w->p[i] > 200; /* some way below the surface */
    }
    TEST_ASSERT_TRUE(beyond > 0);
    TEST_ASSERT_TRUE(wet > 5);
    /* The probe meets the same fluid from both ends of the period. */
    const double left = fluid_sample(&rig.sim, -0.1, 0.03).pressure;
    TEST_ASSERT_TRUE(left > 0);
    assert_near(1e-9 * left, left, fluid_sample(&rig.sim, 0.2, 0.03).pressure, "pressure");
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_pair_through_the_sides);
    RUN_TEST(test_free_fall_round_the_period);
    RUN_TEST(test_places_are_equal);
    RUN_TEST(test_momentum_of_a_periodic_box);
    RUN_TEST(test_moving_wall_goes_through_the_side);
    return UNITY_END();
}
