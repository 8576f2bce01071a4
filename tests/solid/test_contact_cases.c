/* SPDX-License-Identifier: MIT
 * Contact against what is known: restitution, Coulomb's friction, a stack, a pressed disc, bodies
 * that nothing lets through. */
#include "rig.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct rig rig;
static struct particles *p;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

/* Mean of a field of a body. */
static double mean(int body, const double *field)
{
    double sum = 0, n = 0;
    for (int64_t i = 0; i < p->n; i++) {
        if (p->body[i] != body) continue;
        sum += field[i];
        n++;
    }
    return sum / n;
}

/* Steps until `time` or until a guard stops the run; returns whether one did. */
static bool stopped(double time)
{
    while (rig.sim.state.time < time) {
        const enum err e = simulation_step(&rig.sim, time, &rig.diag);
        if (e) {
            TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_GUARD, e, rig.diag.text);
            return true;
        }
    }
    return false;
}

/* A disc without damping meets a floor at a tenth of its speed of sound: what is missing of its
 * energy afterwards is the error of the time integration, and its momentum is turned round. It goes
 * on ringing: the restitution is 0.948 by finite elements of the same equations
 * (cases/reference/contact.py). */
static void test_restitution_of_a_disc(void)
{
    RIG_OPEN_SOLID("dp = 5 mm\nend_time = 1\n[wall floor]\nshape = box -0.1, -0.02, 0.1, 0\n"
                   "[solid disc]\nshape = circle 0, 0.051, 0.05\ndensity = 1000\nyoung = 1 MPa\n"
                   "poisson = 0.3\nlaw = neo_hookean\nartificial_viscosity = 0\n"
                   "velocity = 0, -3\n",
                   NULL);
    const double before = simulation_ledger(&rig.sim).kinetic;
    rig_run(&rig, 0.03);
    const struct ledger row = simulation_ledger(&rig.sim);
    const double back = mean(0, p->vy);
    TEST_ASSERT_TRUE(row.contact == 0 && back > 0);
    assert_at_most(2e-4 * before, fabs(row.dissipated), "energy that does not close");
    assert_near(0.005, 0.948, back / 3, "restitution");
    assert_at_most(1e-3, fabs(mean(0, p->vx)), "speed along the floor");
}

/* A block slides on a floor and comes to rest by friction after v^2/(2 mu g) = 85 mm. */
static void test_sliding_block(void)
{
    RIG_OPEN_SOLID("dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n"
                   "[wall floor]\nshape = box -0.1, -0.03, 0.4, 0\n"
                   "[solid block]\nshape = box 0, 0, 0.12, 0.04\ndensity = 1000\nyoung = 1 MPa\n"
                   "poisson = 0.3\nvelocity = 0.5, 0\n[contact all]\nfriction = 0.15\n",
                   NULL);
    rig_run(&rig, 0.5);
    const double exact = 0.25 / (2 * 0.15 * 9.81);
    assert_near(0.02 * exact, exact, mean(0, p->ux), "way until it rests");
    assert_at_most(1e-3, fabs(mean(0, p->vx)), "speed at the end");
}

/* A block on a slope of `slope` for `time` seconds; returns how far it has gone down. */
static double way_down_a_slope(double slope, double friction, double time)
{
    char gravity[96], rubs[32];
    const double norm = 9.81 / sqrt(1 + slope * slope);
    snprintf(gravity, sizeof gravity, "gravity=%.9g, %.9g", slope * norm, -norm);
    snprintf(rubs, sizeof rubs, "all.friction=%.9g", friction);
    RIG_OPEN_SOLID("dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n"
                   "[wall floor]\nshape = box -0.1, -0.03, 0.6, 0\n"
                   "[solid block]\nshape = box 0, 0, 0.12, 0.04\ndensity = 1000\nyoung = 1 MPa\n"
                   "poisson = 0.3\n[contact all]\ndamping = 0.5\n",
                   gravity, rubs);
    rig_run(&rig, time);
    return mean(0, p->ux);
}

/* Coulomb: below the angle of friction a block stays, above it goes down with g (sin - mu cos). At
 * first it bounces, since it begins without weight on the floor, and slides a little. */
static void test_slope(void)
{
    const double held[2] = {way_down_a_slope(0.28, 0.3, 1), way_down_a_slope(0.28, 0.3, 3)};
    assert_at_most(5e-4, held[0], "way before it rests on the floor");
    assert_at_most(1e-6, fabs(held[1] - held[0]), "creep in 2 s");
    const double down = way_down_a_slope(0.6, 0.3, 0.3);
    const double exact = 0.5 * 9.81 * (0.6 - 0.3) / sqrt(1.36) * square(0.3);
    assert_near(0.03 * exact, exact, down, "way");
}

/* What a sliding block loses is friction's work. What the springs of friction hold when it has come
 * to rest is in the account. */
static void test_energy_of_friction(void)
{
    RIG_OPEN_SOLID("dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n"
                   "[wall floor]\nshape = box -0.1, -0.03, 0.4, 0\n"
                   "[solid block]\nshape = box 0, 0, 0.12, 0.04\ndensity = 1000\nyoung = 1 MPa\n"
                   "poisson = 0.3\nartificial_viscosity = 0\n[contact all]\nfriction = 0.5\n",
                   NULL);
    const int64_t n = p->n;
    for (int64_t i = 0; i < n; i++) p->ux[i] += 1e-6; /* no particle begins where it sticks */
    rig_run(&rig, 0.2);
    const double from = simulation_ledger(&rig.sim).dissipated;
    for (int64_t i = 0; i < n; i++) p->vx[i] += 0.01;
    const double given = 0.5 * 4.8 * 1e-4;
    double least = INFINITY;
    for (int row = 1; row <= 100; row++) {
        rig_run(&rig, 0.2 + row * 2e-4);
        least = fmin(least, simulation_ledger(&rig.sim).dissipated - from + given);
    }
    assert_at_most(0.01 * given, -least, "energy gained");
}

/* Three blocks on each other, the upper ones not above each other, sink by their strain and by dp
 * p/E at each interface, and stay there. Their weight grows over 0.5 s; or it acts at once, and
 * they rock first. The dashpots of contact damp that: they do not resist bodies that turn together.
 */
static void stack_at_rest(const char *gravity, double settled, double creep)
{
    char text[600];
    snprintf(text, sizeof text,
             "dp = 1 cm\nend_time = 1\ngravity = 0, %s\n"
             "[wall floor]\nshape = box -0.1, -0.03, 0.2, 0\n"
             "[solid a]\nshape = box 0, 0, 0.08, 0.05\ndensity = 1000\nyoung = 1 MPa\n"
             "poisson = 0.3\n"
             "[solid b]\nlike = a\nshape = box 0.013, 0.05, 0.083, 0.1\n"
             "[solid c]\nlike = a\nshape = box -0.004, 0.1, 0.076, 0.15\n"
             "[contact all]\nfriction = 0.5\ndamping = 0.5\n",
             gravity);
    RIG_OPEN_SOLID(text, NULL);
    rig_run(&rig, settled);
    double x[3], y[3];
    for (int k = 0; k < 3; k++) {
        x[k] = mean(k, p->ux);
        y[k] = mean(k, p->uy);
        assert_at_most(1e-4, fabs(x[k]), "sideways");
        assert_at_most(1.5e-4, fabs(y[k]), "sinking");
    }
    rig_run(&rig, settled + 5);
    for (int k = 0; k < 3; k++) {
        assert_at_most(creep, hypot(mean(k, p->ux) - x[k], mean(k, p->uy) - y[k]), "creep in 5 s");
        assert_at_most(creep, hypot(mean(k, p->vx), mean(k, p->vy)), "speed");
    }
}

static void test_stack_at_rest(void)
{
    stack_at_rest("-9.81", 15, 1e-5);
    stack_at_rest("-9.81*min(1, t/0.5)", 8, 1e-6);
}

/* A block meets a wall of four particles, end on, from slow to seven times its speed of sound:
 * either it is thrown back, or the run stops and says why. No particle gets behind the wall's
 * surface. */
static void test_nothing_passes(void)
{
    static const char *const speeds[] = {"bullet.velocity=5, 0", "bullet.velocity=20, 0",
                                         "bullet.velocity=50, 0", "bullet.velocity=200, 0"};
    for (int k = 0; k < 4; k++) {
        RIG_OPEN_SOLID("dp = 5 mm\nend_time = 1\n[wall target]\nshape = box 0, -0.1, 0.02, 0.2\n"
                       "[solid bullet]\nshape = box -0.11, 0, -0.01, 0.06\ndensity = 1200\n"
                       "young = 1 MPa\npoisson = 0.3\nlaw = neo_hookean\n",
                       speeds[k]);
        const bool gave_up = stopped(0.02);
        TEST_ASSERT_TRUE(!gave_up || k >= 2);
        double front = -1;
        for (int64_t i = 0; i < p->n; i++) front = fmax(front, p->X[i] + p->ux[i]);
        assert_at_most(0.0025, front, "front");
        TEST_ASSERT_TRUE(gave_up || mean(0, p->vx) < 0);
    }
}

/* A rod and a square of three particles across at 200 m/s, end on and corner on, meet a wall or a
 * held strip of three particles, from soft ones to ones whose sound is ten times as fast. None is
 * behind the outermost particles, or, where the run stops, less than a spacing. The stiff ones
 * bounce and gain no energy: the account knows that they have touched the strip between two of its
 * checks. */
static void test_nothing_passes_three_particles(void)
{
    static const char *const targets[] = {
        "[wall target]\nshape = box 0, -0.1, 0.015, 0.2\n",
        "[solid target]\nlike = bullet\nshape = box 0, -0.1, 0.015, 0.2\nvelocity = 0, 0\n"
        "clamp = box 0, -0.1, 0.015, -0.08\nclamp = box 0, 0.18, 0.015, 0.2\n"};
    static const char *const bullets[] = {
        "box -0.13, 0, -0.015, 0.015\n", "box -0.03, 0, -0.015, 0.015\n",
        "polygon -0.06, 0; -0.04, -0.02; -0.02, 0; -0.04, 0.02\nlattice_angle = 45 deg\n"};
    static const char *const stiff[] = {"bullet.young=1 MPa", "bullet.young=20 MPa",
                                        "bullet.young=5 GPa"};
    for (int n = 0; n < 18; n++) {
        char text[800];
        snprintf(
            text, sizeof text,
            "dp = 5 mm\nend_time = 1\n[solid bullet]\nshape = %sdensity = 1200\nyoung = 1 MPa\n"
            "poisson = 0.3\nlaw = neo_hookean\nvelocity = 200, 0\n%s"
            "[domain]\nlower = -0.9, -0.9\nupper = 0.9, 0.9\n",
            bullets[n / 6], targets[n / 3 % 2]);
        RIG_OPEN_SOLID(text, stiff[n % 3]);
        const bool gave_up = stopped(5e-4);
        TEST_ASSERT_TRUE_MESSAGE(!gave_up || n % 3 < 2, rig.diag.text);
        for (int64_t i = 0; i < p->n; i++) {
            if (p->body[i] != 0) continue;
            /* The face of the target is where its own particles near this height are. */
            double face = 0.0025;
            for (int64_t k = 0; k < p->n; k++)
                if (p->body[k] == 1 && fabs(p->Y[k] + p->uy[k] - p->Y[i] - p->uy[i]) < 0.0075)
                    face = fmax(face, p->X[k] + p->ux[k]);
            snprintf(text, sizeof text, "scene %d: m behind the face", n);
            assert_at_most(gave_up ? 0.005 : 0, p->X[i] + p->ux[i] - face, text);
        }
    }
}

/* A plate of one particle has no inside: a block comes to it from either side, bounces, and no
 * point counts as having passed the surface. */
static void test_a_plate_of_one_particle(void)
{
    static const char *const starts[] = {"y0=0.01", "y0=-0.035"};
    for (int k = 0; k < 2; k++) {
        RIG_OPEN_SOLID("dp = 5 mm\nend_time = 1\n[constants]\ny0 = 0\n[wall plate]\n"
                       "shape = box -0.1, -0.005, 0.1, 0\n[solid block]\n"
                       "shape = box 0.0025, y0, 0.0225, y0 + 0.02\ndensity = 1000\nyoung = 1 MPa\n"
                       "poisson = 0.3\n",
                       starts[k], k == 0 ? "block.velocity=0, -1" : "block.velocity=0, 1");
        double deepest = 0;
        for (int row = 1; row <= 200; row++) {
            rig_run(&rig, row * 1e-4);
            deepest = fmax(deepest, rig.sim.contact.deepest.overlap);
        }
        assert_at_most(-0.01, -deepest, "touched");
        assert_at_most(0.5, deepest, "depth");
        TEST_ASSERT_TRUE(mean(0, p->vy) * (k == 0 ? 1 : -1) > 0.5);
    }
}

/* Strips of three particles meet corner on corner. */
static void test_corner_on_corner(void)
{
    RIG_OPEN_SOLID("dp = 5 mm\nend_time = 1\n"
                   "[solid a]\nshape = box 0, 0, 0.1, 0.015\ndensity = 1000\nyoung = 1 MPa\n"
                   "poisson = 0.3\nlaw = neo_hookean\nvelocity = 5, 1\n"
                   "[solid b]\nlike = a\nshape = box 0.11, 0.017, 0.21, 0.032\nvelocity = -5, -1\n",
                   NULL);
    rig_run(&rig, 0.02);
    double nearest = 1;
    for (int64_t i = 0; i < p->n; i++)
        for (int64_t k = 0; k < i; k++)
            if (p->body[i] != p->body[k])
                nearest = fmin(nearest, hypot(p->X[i] + p->ux[i] - p->X[k] - p->ux[k],
                                              p->Y[i] + p->uy[i] - p->Y[k] - p->uy[k]));
    TEST_ASSERT_TRUE(nearest > 0.0025);
}

/* A wall comes down on a clamped beam, bends it, and carries its end along. */
static void test_wall_on_a_beam(void)
{
    RIG_OPEN_SOLID("dp = 5 mm\nend_time = 1\n[wall ram]\nshape = box 0.1, 0.02, 0.14, 0.04\n"
                   "motion = down\n[motion down]\ny = -0.5*t\n"
                   "[solid beam]\nshape = box 0, 0, 0.14, 0.02\nclamp = box 0, 0, 0.03, 0.02\n"
                   "density = 1000\nyoung = 1 MPa\npoisson = 0.3\n",
                   NULL);
    rig_run(&rig, 0.05);
    for (int64_t i = 0; i < p->n; i++)
        if (p->X[i] > 0.13 && p->Y[i] > 0.015) assert_at_most(-0.024, p->uy[i], "end of the beam");
}

/* A wall that is driven into a body that cannot move stops the run, by name. */
static void test_wall_into_a_clamp(void)
{
    RIG_OPEN_SOLID("dp = 5 mm\nend_time = 1\n[wall ram]\nshape = box 0, 0.03, 0.04, 0.05\n"
                   "motion = down\n[motion down]\ny = -0.5*t\n"
                   "[solid block]\nshape = box 0, 0, 0.04, 0.02\nclamp = box 0, 0, 0.04, 0.02\n"
                   "density = 1000\nyoung = 1 MPa\npoisson = 0.3\n",
                   NULL);
    TEST_ASSERT_TRUE(stopped(0.1));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, "[wall ram]"), rig.diag.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, "[solid block]"), rig.diag.text);
    /* Surfaces meet after 10 mm; one spacing of overlap is 5 mm more. */
    assert_near(2e-4, 0.015, rig.sim.state.time * 0.5, "way of the wall");
}

/* Line contact: half of the width 2 b over which a disc of radius R touches a flat under a load P
 * per depth, and how much its centre comes nearer to the flat (Johnson, Contact Mechanics, 1985,
 * Eqs. 4.43 and 5.57). */
static double approach(double load, double R, double young, double poisson)
{
    const double plane = young / (1 - poisson * poisson), b = sqrt(4 * load * R / (M_PI * plane));
    return load / (M_PI * plane) * (2 * log(4 * R / b) - 1);
}

/* A disc between a floor and a plate that comes down slowly: by 1.00 and 2.20 spacings, of which
 * the loads are those of 0.995 and 2.22 (measured). */
static void test_line_contact(void)
{
    RIG_OPEN_SOLID("dp = 2.5 mm\nend_time = 1\n[wall floor]\nshape = box -0.05, -0.01, 0.05, 0\n"
                   "[wall plate]\nshape = box -0.05, 0.1, 0.05, 0.11\nmotion = down\n"
                   "[motion down]\ny = -0.05*t\n"
                   "[solid disc]\nshape = circle 0, 0.05, 0.05\ndensity = 1000\nyoung = 1 MPa\n"
                   "poisson = 0.3\nartificial_viscosity = 0.5\n",
                   NULL);
    double load[2], gone[2];
    for (int k = 0; k < 2; k++) {
        rig_run(&rig, k ? 0.1 : 0.04);
        const double work = rig.sim.state.wall_work, from = rig.sim.state.time;
        rig_run(&rig, from + 0.02);
        load[k] = (rig.sim.state.wall_work - work) / (0.05 * 0.02);
        gone[k] = 0.05 * (from + 0.01);
    }
    const double exact[2] = {2 * approach(load[0], 0.05, 1e6, 0.3),
                             2 * approach(load[1], 0.05, 1e6, 0.3)};
    assert_near(0.05 * 2.5e-3, exact[1], gone[1], "indentation");
    assert_near(0.03 * (exact[1] - exact[0]), exact[1] - exact[0], gone[1] - gone[0],
                "indentation between two loads");
}

/* Two arms, one above the other, fold onto each other under gravity. After 2 s the upper one lies
 * still. No particle of one arm gets behind the other, and the account of energy loses no more than
 * viscosity takes. */
static void test_strip_that_folds(void)
{
    RIG_OPEN_SOLID("dp = 1 cm\nend_time = 2\ngravity = 0, -9.81\n"
                   "[solid strip]\nshape = box 0, 0, 0.5, 0.04\nshape = box 0, -0.12, 0.04, 0\n"
                   "shape = box 0, -0.16, 0.5, -0.12\nclamp = box 0, -0.16, 0.5, -0.12\n"
                   "density = 1000\nyoung = 50 kPa\npoisson = 0.3\nlaw = neo_hookean\n"
                   "artificial_viscosity = 0.1\n",
                   NULL);
    double highest = 0;
    while (rig.sim.state.time < 2) {
        rig_run(&rig, rig.sim.state.time + 0.01);
        highest = fmax(highest, contact_energy(&rig.sim.contact, p, rig.sim.state.time));
    }
    TEST_ASSERT_TRUE(highest > 0);
    double lowest = 1;
    for (int64_t i = 0; i < p->n; i++)
        if (p->Y[i] > 0 && p->X[i] > 0.1) lowest = fmin(lowest, p->Y[i] + p->uy[i]);
    /* The lower arm ends at -0.12 m: the last centre of the upper one lies half a spacing above. */
    assert_near(0.005, -0.115, lowest, "lowest particle of the upper arm");
    assert_at_most(0.02 * simulation_ledger(&rig.sim).elastic,
                   -simulation_ledger(&rig.sim).dissipated, "energy gained");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_restitution_of_a_disc);
    RUN_TEST(test_sliding_block);
    RUN_TEST(test_slope);
    RUN_TEST(test_energy_of_friction);
    RUN_TEST(test_stack_at_rest);
    RUN_TEST(test_nothing_passes);
    RUN_TEST(test_nothing_passes_three_particles);
    RUN_TEST(test_a_plate_of_one_particle);
    RUN_TEST(test_corner_on_corner);
    RUN_TEST(test_wall_on_a_beam);
    RUN_TEST(test_wall_into_a_clamp);
    RUN_TEST(test_line_contact);
    RUN_TEST(test_strip_that_folds);
    return UNITY_END();
}
