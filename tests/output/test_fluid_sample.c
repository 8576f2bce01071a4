/* SPDX-License-Identifier: MIT
 * Values of the fluid at points and lines: by hand in water at rest, and the same in a scene
 * that is moved anywhere, mirrored, or periodic. */
#include "output/probes.h"
#include "rig.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Water 0.4 m wide and 0.2 m deep, and a splash of one particle beside it, with its lower left
 * corner at a place. */
static const char tank[] =
    "dp = 1 cm\nend_time = 1\ngravity = 0, -10\n[constants]\nX = %g\nY = %g\n"
    "[fluid w]\nshape = box X, Y, X + 0.4, Y + 0.2\nshape = box X + 0.6, Y, X + 0.61, Y + 0.01\n"
    "sound_speed = 30\nsurface = Y + 0.2\nvelocity = 2, 3\n"
    "[wall tank]\nshape = polyline thickness -0.04: X, Y + 0.3; X, Y; X + 0.7, Y; X + 0.7, Y + "
    "0.3\n";

static const double places[][2] = {{0, 0}, {-5, -7}, {3, -0.31}, {-0.2, 0.11}, {100, 200}};
static struct rig rig;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

static void open_at(double x, double y)
{
    char text[1000];
    snprintf(text, sizeof text, tank, x, y);
    rig_open(&rig, text, NULL);
    rig_evaluate(&rig);
}

static void test_anywhere(void)
{
    for (size_t k = 0; k < COUNT_OF(places); k++) {
        const double x = places[k][0], y = places[k][1];
        open_at(x, y);
        const struct simulation *const sim = &rig.sim;
        const struct sample in = fluid_sample(sim, x + 0.2, y + 0.1);
        assert_near(0.01, 1, in.fill, "fill");
        assert_near(1e-12, 0, in.occupied, "occupied");
        assert_near(0.02 * 1000, 1000, in.pressure, "pressure at half depth");
        assert_near(1e-12, 2, in.vx, "vx");
        assert_near(1e-12, 3, in.vy, "vy");
        const struct sample air = fluid_sample(sim, x + 0.2, y + 0.25);
        assert_near(0, 0, air.fill + air.pressure + air.vx + air.vy, "air");
        assert_near(0.05, 1, fluid_sample(sim, x + 0.2, y - 0.02).occupied, "wall");
        /* Above water, from any point in it, below it within reach, and where there is none. */
        assert_near(0.002, y + 0.2, fluid_level(sim, x + 0.2, y + 0.05), "level");
        assert_near(0.002, y + 0.2, fluid_level(sim, x + 0.2, y + 0.195), "level from the surface");
        assert_near(0, y + 0.21, fluid_level(sim, x + 0.2, y + 0.21), "level of air");
        assert_near(1e-9, x + 0.4, fluid_front(sim, DIRECTION_RIGHT), "front to the right");
        assert_near(1e-9, x, fluid_front(sim, DIRECTION_LEFT), "front to the left");
        assert_near(1e-9, y + 0.2, fluid_front(sim, DIRECTION_UP), "front up");
        assert_near(1e-9, y, fluid_front(sim, DIRECTION_DOWN), "front down");
        /* Through a line across half the depth, to the right of its direction; and through none. */
        const double low[2] = {x + 0.2, y + 0.05}, high[2] = {x + 0.2, y + 0.15};
        const double left[2] = {x + 0.1, y + 0.1}, right[2] = {x + 0.3, y + 0.1};
        assert_near(0.01 * 0.2, 2 * 0.1, fluid_flux(sim, low, high), "flux across");
        assert_near(0.01 * 0.2, -2 * 0.1, fluid_flux(sim, high, low), "flux, line turned round");
        assert_near(0.01 * 0.6, -3 * 0.2, fluid_flux(sim, left, right), "flux up");
        double of[3];
        fluid_pressure_on(sim, left, right, of);
        assert_near(20, 1000, of[0], "mean pressure on a line");
        assert_near(1e-9, 0, of[1], "force along the line");
        assert_near(0.02 * 200, -1000 * 0.2, of[2], "force of the fluid above the line");
    }
}

/* A point of a wall has fluid on one side of it only. Its pressure is that at the wall, not
 * that in the middle of the fluid within reach, here 0.6 spacings away. */
static void test_pressure_at_a_wall(void)
{
    for (size_t k = 0; k < COUNT_OF(places); k++) {
        const double x = places[k][0], y = places[k][1];
        open_at(x, y);
        const struct simulation *const sim = &rig.sim;
        struct particles *const particles = &rig.sim.particles[KIND_FLUID];
        for (int64_t i = 0; i < particles->n; i++) particles->ax[i] = particles->ay[i] = 0;
        const double floor = fluid_sample(sim, x + 0.2, y).pressure,
                     side = fluid_sample(sim, x, y + 0.1).pressure;
        assert_near(0.005 * 2000, 2000, floor, "floor");
        assert_near(0.005 * 2000, 2000, fluid_sample(sim, x, y).pressure, "corner");
        assert_near(0.005 * 2000, 1000, side, "side");
        assert_near(0.005 * 2000, 50, fluid_sample(sim, x + 0.2, y + 0.195).pressure, "surface");
        /* Beside air the slope is that of the fluid's acceleration, here none: the mean over
         * the fluid. */
        for (int64_t i = 0; i < particles->n; i++) particles->ay[i] = -10;
        TEST_ASSERT_TRUE(fluid_sample(sim, x + 0.2, y + 0.195).pressure > 70);
        assert_near(0.001 * floor, floor, fluid_sample(sim, x + 0.2, y).pressure, "floor at rest");
        tearDown();
    }
}

/* Walls that are accelerated: no weight on a floor that falls freely, as much more on one that
 * rises. */
static void test_pressure_at_a_moving_wall(void)
{
    double floor[3];
    for (int k = 0; k < 3; k++) {
        char text[1200];
        snprintf(text, sizeof text, tank, 0.0, 0.0);
        const size_t end = strlen(text);
        snprintf(text + end, sizeof text - end, "motion = m\n[motion m]\ny = %d*t^2\n",
                 5 * (k - 1));
        rig_open(&rig, text, NULL);
        rig_evaluate(&rig);
        floor[k] = fluid_sample(&rig.sim, 0.2, 0).pressure;
        tearDown();
    }
    assert_near(0.005 * 2000, 2000, floor[1], "at rest");
    TEST_ASSERT_TRUE(floor[1] - floor[0] > 50);
    assert_near(0.02 * 60, floor[1] - floor[0], floor[2] - floor[1], "as much more");
}

/* The flux is one of volume: a tenth more density, a tenth less volume. */
static void test_flux_of_denser_water(void)
{
    const double from[2] = {0.2, 0.05}, to[2] = {0.2, 0.15};
    open_at(0, 0);
    struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    for (int64_t i = 0; i < particles->n; i++) particles->dens[i] = 0;
    const double flux = fluid_flux(&rig.sim, from, to);
    for (int64_t i = 0; i < particles->n; i++) particles->dens[i] = 0.1;
    assert_near(1e-12, flux / 1.1, fluid_flux(&rig.sim, from, to), "flux");
}

/* Water up to the top of the domain, and a surface just above it: the level is that of the
 * water, not that of the domain. */
static void test_level_at_the_top_of_the_domain(void)
{
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\n[domain]\nlower = -0.1, -0.1\nupper = 0.5, 0.2\n"
             "[fluid w]\nshape = box 0, 0, 0.4, 0.2\nsound_speed = 30\n",
             NULL);
    struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    for (int k = 0; k < 5; k++) {
        const double rise = 0.0005 * k;
        for (int64_t i = 0; i < particles->n; i++) particles->y[i] += k ? 0.0005 : 0;
        rig_evaluate(&rig);
        assert_near(0.0007, 0.2 + rise, fluid_level(&rig.sim, 0.2, 0.1), "level");
    }
}

/* The volume of the water decides its level, not the heights of single rows; also where it is
 * shallow, and beside a wall. */
static void test_level_of_volume(void)
{
    open_at(0, 0);
    const struct simulation *const sim = &rig.sim;
    struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    const double dp = sim->scene->top.dp;
    for (int64_t i = 0; i < particles->n; i++) {
        if (particles->y[i] > 0.2 - dp)
            particles->y[i] -= 0.15 * dp;
        else if (particles->y[i] > 0.2 - 2 * dp)
            particles->y[i] += 0.15 * dp;
    }
    const double along[] = {0.2, 0.2031, 0.25, 0.0, 0.012};
    for (size_t k = 0; k < COUNT_OF(along); k++)
        assert_near(0.03 * dp, 0.2, fluid_level(sim, along[k], 0.05), "level over two rows");
    for (int64_t i = 0; i < particles->n; i++)
        if (particles->y[i] > 3 * dp) particles->y[i] = 9;
    for (size_t k = 0; k < COUNT_OF(along); k++)
        assert_near(0.03 * dp, 3 * dp, fluid_level(sim, along[k], dp), "level of a layer");
}

/* Water that moves within a spacing of a line alone passes it as if all did. */
static void test_flux_is_that_at_the_line(void)
{
    open_at(0, 0);
    struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    for (int64_t i = 0; i < particles->n; i++)
        if (fabs(particles->x[i] - 0.2) > rig.sim.scene->top.dp) particles->vx[i] = 0;
    const double low[2] = {0.2, 0.05}, high[2] = {0.2, 0.15};
    assert_near(0.01 * 0.2, 2 * 0.1, fluid_flux(&rig.sim, low, high), "flux");
}

/* Water without a surface in both directions: nothing differs at the sides. */
static void test_across_periodic_sides(void)
{
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\n[fluid w]\nshape = box 0, -0.3, 0.3, 0\nsound_speed = 30\n"
             "velocity = 1, 0\n[domain]\nlower = 0, -0.3\nupper = 0.3, 0\nperiodic = xy\n",
             NULL);
    rig_evaluate(&rig);
    const struct sample middle = fluid_sample(&rig.sim, 0.15, -0.15);
    const double ends[][2] = {{0, -0.15}, {0.3, -0.15}, {0.15, 0}, {0.15, -0.3}, {0.3, 0}};
    for (size_t k = 0; k < COUNT_OF(ends); k++) {
        const struct sample at = fluid_sample(&rig.sim, ends[k][0], ends[k][1]);
        assert_near(1e-9, middle.fill, at.fill, "fill");
        assert_near(1e-9, middle.vx, at.vx, "vx");
    }
    assert_near(1e-9, 0, fluid_level(&rig.sim, 0.15, -0.2), "water up to the top");
    /* Lines over the whole period, from any side, in it or on it, and over two of them. */
    static const double lines[][4] = {{0.01, 0, 0.01, -0.3},     {0.01, -0.3, 0.01, 0},
                                      {0, -0.15, 0, 0.15},       {0.15, -0.1, 0.15, -0.4},
                                      {0.0533, -0.3, 0.0533, 0}, {0.1, 0, 0.1, -0.6}};
    for (size_t k = 0; k < COUNT_OF(lines); k++)
        assert_near(1e-9, lines[k][3] - lines[k][1], fluid_flux(&rig.sim, lines[k], lines[k] + 2),
                    "flux over the period");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_anywhere);
    RUN_TEST(test_pressure_at_a_wall);
    RUN_TEST(test_pressure_at_a_moving_wall);
    RUN_TEST(test_flux_of_denser_water);
    RUN_TEST(test_level_at_the_top_of_the_domain);
    RUN_TEST(test_level_of_volume);
    RUN_TEST(test_flux_is_that_at_the_line);
    RUN_TEST(test_across_periodic_sides);
    return UNITY_END();
}
