/* SPDX-License-Identifier: MIT
 * Hinges: the point stays in place to round-off, exact periods, momentum and energy, restart. */
#include "output/checkpoint.h"
#include "solid/hinges.h"
#include "time/energy.h"
#include "rig.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct rig rig;
static struct particles *p;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

#define TOP "dp = 1 cm\nend_time = 10\n"
#define STEEL "density = 1000\nyoung = 2e7\npoisson = 0.3\nlaw = svk\n"

/* The interpolated displacement at a hinge: of its own body less that of the other. */
static void moved(int hinge, double by[2])
{
    const struct hinges *const h = rig.sim.solid.hinges;
    by[0] = by[1] = 0;
    for (int64_t k = 0; k < h->n_nodes; k++) {
        if (h->node[k].hinge != hinge) continue;
        by[0] += h->node[k].weight * p->ux[h->node[k].particle];
        by[1] += h->node[k].weight * p->uy[h->node[k].particle];
    }
}

/* The angle of a body about its mean position. */
static double angle_of(int body)
{
    double X = 0, Y = 0, ux = 0, uy = 0, n = 0, across = 0, along = 0;
    for (int64_t i = 0; i < p->n; i++)
        if (p->body[i] == body) n++, X += p->X[i], Y += p->Y[i], ux += p->ux[i], uy += p->uy[i];
    for (int64_t i = 0; i < p->n; i++) {
        const double dX = p->X[i] - X / n, dY = p->Y[i] - Y / n;
        const double dx = dX + p->ux[i] - ux / n, dy = dY + p->uy[i] - uy / n;
        if (p->body[i] != body) continue;
        across += dX * dy - dY * dx;
        along += dX * dx + dY * dy;
    }
    return atan2(across, along);
}

/* The second time at which a pendulum of body 0 passes the angle from below. */
static double period(double middle)
{
    double before = angle_of(0), time = 0, first = -1;
    for (;;) {
        rig_steps(&rig, 1, 10);
        const double now = angle_of(0), at = rig.sim.state.time;
        if (before < middle && now >= middle) {
            const double crossing = time + (at - time) * (middle - before) / (now - before);
            if (first >= 0) return crossing - first;
            first = crossing;
        }
        before = now;
        time = at;
        TEST_ASSERT_TRUE(at < 9);
    }
}

/* A rod that is 4 or 5 particles wide swings by 0.1 about its middle line, about a point between
 * the particles and about one on its edge. */
static void test_period_of_a_pendulum(void)
{
    static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                              "integrator=leapfrog"};
    static const struct {
        double width, y;
    } rod[] = {{0.04, 0.283}, {0.05, 0.283}, {0.04, 0.3}, {0.05, 0.27}};
    for (int k = 0; k < 4; k++) {
        char text[1000];
        const double swing = 0.1, w = rod[k].width, length = 0.3, d = rod[k].y - length / 2;
        snprintf(text, sizeof text,
                 TOP "gravity = %.17g, %.17g\n[solid rod]\nshape = box %g, 0, %g, %g\n" STEEL
                     "hinge = 0, %g\n",
                 9.81 * sin(swing), -9.81 * cos(swing), -w / 2, w / 2, length, rod[k].y);
        RIG_OPEN_SOLID(text, integrators[k % 3]);
        const double inertia = (w * w + length * length) / 12 + d * d;
        const double small = 2 * PI * sqrt(inertia / (9.81 * d));
        const double expected = small * (1 + swing * swing / 16);
        assert_near(1e-3 * expected, expected, period(swing), "period");
        double by[2];
        moved(0, by);
        assert_near(1e-13, 0, by[0], "x of the hinge");
        assert_near(1e-13, 0, by[1], "y of the hinge");
    }
}

/* Two rods hinged to each other, the upper one in place, fall from the horizontal without damping:
 * their energy stays within 1e-4 of what they exchange. */
static void test_energy_of_a_double_pendulum(void)
{
    static const char text[] =
        TOP "gravity = 9.81, 0\n[contact none]\nenabled = off\n[solid a]\n"
            "shape = box -0.02, 0, 0.02, 0.2\n" STEEL "artificial_viscosity = 0\nhinge = 0, 0.183\n"
            "[solid b]\nlike = a\nshape = box -0.025, -0.2, 0.025, 0\nhinge = 0, 0, a\n";
    static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                              "integrator=leapfrog"};
    for (int k = 0; k < 3; k++) {
        RIG_OPEN_SOLID(text, integrators[k]);
        double highest = 0, worst = 0, by[2];
        for (int n = 1; n <= 40; n++) {
            rig_run(&rig, 0.02 * n);
            const struct ledger row = simulation_ledger(&rig.sim);
            highest = max2(highest, row.kinetic);
            worst = max2(worst, fabs(row.dissipated));
            for (int h = 0; h < 2; h++) {
                moved(h, by);
                assert_near(1e-13, 0, by[0], "x of the hinge");
                assert_near(1e-13, 0, by[1], "y of the hinge");
            }
        }
        assert_at_most(1e-4 * highest, worst, "energy");
    }
}

/* Momentum and angular momentum about the origin. */
static void momentum(double of[3])
{
    of[0] = of[1] = of[2] = 0;
    for (int64_t i = 0; i < p->n; i++) {
        const double m = rig.sim.solid.body[p->body[i]].mass;
        of[0] += m * p->vx[i];
        of[1] += m * p->vy[i];
        of[2] += m * ((p->X[i] + p->ux[i]) * p->vy[i] - (p->Y[i] + p->uy[i]) * p->vx[i]);
    }
}

/* A free chain of three bodies keeps its momentum and angular momentum. The start loses only the
 * part of the given velocities that the hinges do not allow. */
static void test_momentum_of_a_chain(void)
{
    static const char text[] =
        TOP "[contact none]\nenabled = off\n[solid a]\nshape = box 0, 0, 0.1, 0.04\n" STEEL
            "artificial_viscosity = 0\nvelocity = 0, 1\n[solid b]\nlike = a\nshape = box 0.11, 0, "
            "0.2, 0.05\ndensity = 3000\n"
            "velocity = -y, x - 0.15\nhinge = 0.105, 0.023, a\n"
            "[solid c]\nlike = a\nshape = box 0.2, 0, 0.3, 0.03\nhinge = 0.2, 0.01, b\n";
    for (int k = 0; k < 2; k++) {
        double before[3], after[3];
        RIG_OPEN_SOLID(text, k ? "integrator=leapfrog" : "integrator=symplectic");
        momentum(before);
        TEST_ASSERT_TRUE(fabs(before[1]) > 1 && fabs(before[2]) > 0.1);
        rig_run(&rig, 0.1);
        momentum(after);
        for (int c = 0; c < 3; c++) assert_near(1e-11, before[c], after[c], "momentum");
        TEST_ASSERT_TRUE(fabs(angle_of(0) - angle_of(1)) > 0.1);
    }
}

/* A hanging rod, in a wall that moves sideways: the point moves with it, its force is the rate of
 * momentum, and its work is the energy of the rod. */
static void test_hinge_on_a_moving_wall(void)
{
    static const char text[] =
        TOP "gravity = 0, -9.81\n[contact none]\nenabled = off\n[wall top]\nshape = box -0.1, 0.2, "
            "0.1, 0.24\nmotion = m\n"
            "[motion m]\nx = t^2*(2 + t)\n[solid rod]\n"
            "shape = box -0.02, 0, 0.02, 0.2\n" STEEL "hinge = 0.003, 0.2, top\n";
    static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                              "integrator=leapfrog"};
    for (int k = 0; k < 3; k++) {
        double by[2], force[2] = {0, 0}, rate[2] = {0, 0};
        RIG_OPEN_SOLID(text, integrators[k]);
        rig_run(&rig, 0.2);
        moved(0, by);
        const double dt = rig.sim.dt_solid, x = 2 * square(0.2) + square(0.2) * 0.2;
        assert_near(10 * square(dt), x, by[0], "x of the hinge");
        assert_near(1e-13, 0, by[1], "y of the hinge");
        const struct ledger row = simulation_ledger(&rig.sim);
        TEST_ASSERT_TRUE(rig.sim.state.wall_work > 0.1);
        assert_at_most(2e-3 * rig.sim.state.wall_work, fabs(row.dissipated), "missing energy");
        const struct held_forces now = solid_held_forces(&rig.sim.solid, p, 0.2);
        for (int64_t i = 0; i < p->n; i++) {
            const double m = rig.sim.solid.body[0].mass;
            force[0] += now.held_x[i];
            force[1] += now.held_y[i] - 9.81 * m;
            rate[0] += m * now.ax[i];
            rate[1] += m * now.ay[i];
        }
        TEST_ASSERT_TRUE(force[0] > 1);
        for (int c = 0; c < 2; c++) assert_near(1e-8, rate[c], force[c], "force");
    }
}

/* A flap that turns on the floor under water, with sub-steps against the fluid's impedance. */
static const char flap[] =
    "dp = 1 cm\nend_time = 10\ngravity = 0, -9.81\n[fluid w]\nshape = box 0, 0, 0.1, 0.1\n"
    "surface = 0.1\nmax_speed = 1.5\n[wall tank]\n"
    "shape = polyline thickness 4 cm: 0.3, 0.3; 0.3, 0; 0, 0; 0, 0.3\n"
    "[solid flap]\nshape = box 0.1, 0, 0.12, 0.15\ndensity = 900\nyoung = 4e7\npoisson = 0.3\n"
    "hinge = 0.11, 0, tank\n";

static void test_flap_in_water(void)
{
    static const char *const runs[][2] = {
        {"integrator=symplectic", "numerics.multirate=on"},
        {"integrator=verlet", "numerics.multirate=on"},
        {"integrator=leapfrog", "numerics.multirate=on"},
        {"integrator=symplectic", "numerics.multirate=off"},
    };
    for (int k = 0; k < 4; k++) {
        double by[2];
        RIG_OPEN_SOLID(flap, runs[k][0], runs[k][1]);
        rig_run(&rig, 0.05);
        moved(0, by);
        assert_near(1e-14, 0, by[0], "x of the hinge");
        assert_near(1e-14, 0, by[1], "y of the hinge");
        assert_near(0.001, -0.066, angle_of(0), "angle");
    }
}

/* About the centre of a particle it is what a clamp of this particle is, to the energy account. */
static void test_hinge_and_clamp_of_one_particle(void)
{
    static const char *const held[] = {"hinge = 0.115, 0.005\n",
                                       "clamp = circle 0.115, 0.005, 0.6*dp\n"};
    struct ledger row[2];
    double angle[2];
    for (int k = 0; k < 2; k++) {
        char text[1000];
        const char *const tail = strstr(flap, "[solid flap]");
        snprintf(text, sizeof text,
                 "%.*s[solid flap]\nshape = box 0.1, 0, 0.13, 0.15\ndensity = 900\nyoung = 4e7\n"
                 "poisson = 0.3\n%s",
                 (int)(tail - flap), flap, held[k]);
        RIG_OPEN_SOLID(text, NULL);
        rig_run(&rig, 0.05);
        row[k] = simulation_ledger(&rig.sim);
        angle[k] = angle_of(0);
    }
    assert_near(1e-3 * fabs(angle[1]), angle[1], angle[0], "angle");
    assert_near(1e-3 * row[1].kinetic, row[1].kinetic, row[0].kinetic, "kinetic energy");
    assert_near(1e-3 * row[1].kinetic, row[1].dissipated, row[0].dissipated, "missing energy");
}

static void test_restart_and_threads(void)
{
    struct checkpoint image = {0};
    RIG_OPEN_SOLID(flap, NULL);
    rig_run(&rig, 0.01);
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_capture(&image, &rig.sim, "case", "test", &rig.diag));
    checkpoint_seal(&image);
    rig_run(&rig, 0.02);
    const uint64_t whole = simulation_hash(&rig.sim);
    RIG_OPEN_SOLID(flap, NULL);
    rig.sim.solid.threads = 3;
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, checkpoint_apply(&image, &rig.sim, &rig.diag),
                                  rig.diag.text);
    rig_run(&rig, 0.02);
    TEST_ASSERT_EQUAL_HEX64(whole, simulation_hash(&rig.sim));
    checkpoint_free(&image);
}

/* Two hinges on one body hold its angle, though both are between the same particles. */
static void test_two_hinges_hold_a_body(void)
{
    RIG_OPEN_SOLID(TOP "gravity = 9.81, 0\n[solid rod]\nshape = box -0.02, 0, 0.02, 0.2\n" STEEL
                       "hinge = 0, 0.19\nhinge = 0.004, 0.172\n",
                   NULL);
    double by[2];
    rig_run(&rig, 0.1);
    for (int h = 0; h < 2; h++) {
        moved(h, by);
        assert_near(1e-13, 0, by[0], "x of the hinge");
        assert_near(1e-13, 0, by[1], "y of the hinge");
    }
    assert_at_most(0.05, fabs(angle_of(0)), "angle");
}

static void test_bad_input(void)
{
#define ROD TOP "[solid rod]\nshape = box -0.02, 0, 0.02, 0.2\n" STEEL
    rig_refuses(ROD "hinge = 0.032, 0.1\n", "is not on [solid rod]");
    rig_refuses(ROD "hinge = 0\n", "`X, Y` or `X, Y, NAME` is expected");
    rig_refuses(ROD "hinge = 0, 0.1, rood\n", "did you mean `rod`");
    rig_refuses(ROD "hinge = 0, 0.1, rod\n", "cannot be hinged to itself");
    rig_refuses(ROD "hinge = 0, 0.1\nhinge = 0, 0.1\n", "holds nothing that could move");
    rig_refuses(ROD "clamp = box -0.02, 0, 0.02, 0.2\nhinge = 0, 0.1\n",
                "holds nothing that could move");
    rig_refuses(ROD "[solid b]\nlike = rod\nshape = box 0.02, 0, 0.06, 0.2\njoined = rod\n"
                    "hinge = 0.02, 0.1, rod\n",
                "to which it is joined");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_period_of_a_pendulum);
    RUN_TEST(test_energy_of_a_double_pendulum);
    RUN_TEST(test_momentum_of_a_chain);
    RUN_TEST(test_hinge_on_a_moving_wall);
    RUN_TEST(test_flap_in_water);
    RUN_TEST(test_hinge_and_clamp_of_one_particle);
    RUN_TEST(test_restart_and_threads);
    RUN_TEST(test_two_hinges_hold_a_body);
    RUN_TEST(test_bad_input);
    return UNITY_END();
}
