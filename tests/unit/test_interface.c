/* SPDX-License-Identifier: MIT
 * The fluid's answer to a light structure within its sub-steps (T-35a, T-35b). */
#include "interface.h"
#include "rig.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

/* A light block in the middle of water, free to move, no gravity: nothing acts from outside. */
static const char block[] =
    "dp = 1 cm\nend_time = 1\nprecision = double\n"
    "[fluid water]\nshape = box 0, 0, 0.24, 0.24\nminus = box 0.1, 0.1, 0.14, 0.14\n"
    "sound_speed = 20\nartificial_viscosity = 0.1\ndensity_diffusion = 0.1\n"
    "[solid block]\nshape = box 0.1, 0.1, 0.14, 0.14\ndensity = 100\nyoung = 1e6\npoisson = 0.3\n"
    "velocity = 0.2, 0.1\n[domain]\nlower = -0.2, -0.2\nupper = 0.5, 0.5\n";

static struct rig rig;
static struct particles *fluid, *solid;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

static void open(const char *set, const char *another)
{
    rig_open(&rig, block, set, another, NULL);
    fluid = &rig.sim.kind[KIND_FLUID];
    solid = &rig.sim.kind[KIND_SOLID];
}

static void held(const char *set, const char *another)
{
    open(set, another);
    TEST_ASSERT_FALSE_MESSAGE(rig.sim.effects & FX_IMPEDANCE, set);
    rig_close(&rig);
}

static void answered(const char *set, const char *another)
{
    open(set, another);
    TEST_ASSERT_TRUE_MESSAGE(rig.sim.effects & FX_IMPEDANCE, set);
    rig_close(&rig);
}

/* No heavier than the fluid, or up to 1.5 times and three particles across; or by name. */
static void test_only_where_a_body_is_light(void)
{
    static const char three[] = "block.shape=box 0.1, 0.1, 0.13, 0.14";
    held("block.density=1001", NULL);
    held("block.density=1501", three);
    held("block.density=1500", "block.shape=polyline thickness 0.04: 0.1, 0.1; 0.14, 0.1");
    answered("block.density=1500", three);
    answered("block.density=1500", "block.shape=polyline thickness 0.03: 0.1, 0.1; 0.14, 0.1");
    answered("block.density=1500", "block.shape=circle 0.12, 0.12, 0.015");
    answered("block.density=1001", "numerics.interface=impedance");
    held("numerics.multirate=off", NULL);
    held("numerics.interface=held", NULL);
    open("numerics.interface=held", NULL);
    TEST_ASSERT_NULL(solid->owed_x);
    rig_close(&rig);
    open(NULL, NULL);
    TEST_ASSERT_TRUE(rig.sim.effects & FX_IMPEDANCE);
    assert_near(1e-12, 1000 * 20, rig.sim.solid.impedance, "rho0 c0");
}

/* Layers that are bonded to each other are as thick as both. */
static void test_not_where_thin_layers_are_bonded(void)
{
    rig_open(&rig, block, "block.density=1200", "block.shape=box 0.1, 0.1, 0.12, 0.14", NULL);
    TEST_ASSERT_TRUE(scene_is_light(&rig.scene, 0));
    rig_close(&rig);
    static char two[1024];
    snprintf(two, sizeof two, "%s%s", block,
             "[solid layer]\nlike = block\nshape = box 0.12, 0.1, 0.14, 0.14\njoined = block\n");
    rig_open(&rig, two, "block.density=1200", "block.shape=box 0.1, 0.1, 0.12, 0.14", NULL);
    TEST_ASSERT_FALSE(rig.sim.effects & FX_IMPEDANCE);
}

/* A pressure of 1 Pa everywhere presses with the force of the height on the middle of a straight side:
 * a column of particles across it has the surface dp, within the 1.7 % by which sums on the lattice
 * differ from integrals. */
static void test_surface_of_a_straight_side(void)
{
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\nprecision = double\n"
             "[fluid water]\nshape = box 0, 0, 0.24, 0.1\nsound_speed = 20\n"
             "[solid floor]\nshape = box 0, -0.04, 0.24, 0\ndensity = 100\nyoung = 1e6\n"
             "poisson = 0.3\n[domain]\nlower = -0.2, -0.2\nupper = 0.5, 0.5\n",
             NULL);
    solid = &rig.sim.kind[KIND_SOLID];
    rig_evaluate(&rig);
    double across = 0, along = 0;
    for (int64_t i = 0; i < solid->n; i++) {
        if (fabs(solid->X[i] - 0.115) > 0.004) continue;
        across += solid->wet_y[i];
        along += solid->wet_x[i];
    }
    assert_near(0.02 * 0.01, -0.01, across, "surface");
    assert_near(1e-12, 0, along, "along it");
}

/* One kick by hand: mass 100 * 1e-4 = 0.01 kg/m, surface (0.006, 0.008) m, impedance 2e4, dt = 1e-4:
 * k = 1e-4 * 2e4 * 0.01/0.01 = 2; velocity (3, 4) m/s where the fluid saw (0, 1.25): along the surface
 * 0.6 * 3 + 0.8 * 2.75 = 4 m/s faster, of which 2/3 go: kick (-1.6, -2.13333), owed 0.01 of it. */
static void test_answer_and_return_by_hand(void)
{
    open(NULL, NULL);
    solid->wet_x[0] = 0.006;
    solid->wet_y[0] = 0.008;
    solid->vx[0] = 3;
    solid->vy[0] = 4;
    solid->wx[0] = 0;
    solid->wy[0] = 1.25;
    interface_answer(&rig.sim.solid, solid, 1e-4);
    assert_near(1e-12, 3 - 1.6, solid->vx[0], "vx");
    assert_near(1e-12, 4 - 1.6 * 4 / 3, solid->vy[0], "vy");
    assert_near(1e-14, -0.016, solid->owed_x[0], "owed, x");
    assert_near(1e-14, -0.016 * 4 / 3, solid->owed_y[0], "owed, y");
    solid->fx[0] = 7;
    interface_return(solid, 1e-3);
    assert_near(1e-10, 7 + 0.02 * 0.016 / 1e-3, solid->fx[0], "fx");
    assert_near(1e-14, -0.016 * 0.98, solid->owed_x[0], "still owed, x");
}

static double momentum(double *size)
{
    double sum = 0;
    *size = 0;
    for (int64_t i = 0; i < fluid->n; i++) {
        sum += rig.sim.fluid.k.mass * fluid->vx[i];
        *size += rig.sim.fluid.k.mass * fabs(fluid->vx[i]);
    }
    for (int64_t i = 0; i < solid->n; i++) {
        const double part = rig.sim.solid.body[0].mass * solid->vx[i];
        sum += part - solid->owed_x[i];
        *size += fabs(part);
    }
    return sum;
}

/* Fluid, structure and what the structure owes the fluid: nothing is lost. */
static void test_momentum_closes(void)
{
    open("integrator=symplectic", NULL);
    double size;
    const double start = momentum(&size);
    rig_steps(&rig, 200, 1);
    const double end = momentum(&size);
    double owed = 0;
    for (int64_t i = 0; i < solid->n; i++) owed += fabs(solid->owed_x[i]);
    TEST_ASSERT_TRUE(owed > 1e-6 * size);
    assert_near(1e-11 * size, start, end, "momentum");
}

/* Water that leaves a light wall takes nothing of what is owed along: once a particle is dry, its force is
 * what it is given back, which fades. */
static void test_dry_particles_owe_less_and_less(void)
{
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\nprecision = double\n"
             "[fluid water]\nshape = box 0, 0, 0.1, 0.2\nsound_speed = 20\nvelocity = -1, 0\n"
             "[solid wall]\nshape = box 0.1, 0, 0.13, 0.2\nclamp = box 0.1, 0, 0.13, 0.03\n"
             "density = 100\nyoung = 1e6\npoisson = 0.3\nvelocity = -0.5, 0\n"
             "[domain]\nlower = -1, -0.2\nupper = 0.5, 0.5\n",
             NULL);
    solid = &rig.sim.kind[KIND_SOLID];
    rig_run(&rig, 0.02);
    double owed = 0;
    for (int64_t i = 0; i < solid->n; i++) owed = fmax(owed, fabs(solid->owed_x[i]));
    rig_run(&rig, 0.2);
    TEST_ASSERT_TRUE(owed > 0);
    const double kept = owed * pow(0.98, 300);
    for (int64_t i = 0; i < solid->n; i++) {
        TEST_ASSERT_TRUE(solid->wet_x[i] == 0);
        assert_at_most(kept, fabs(solid->owed_x[i]), "owed");
        assert_at_most(0.02 * kept / rig.sim.state.dt, fabs(solid->fx[i]),
                       "force of what is given back");
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_only_where_a_body_is_light);
    RUN_TEST(test_not_where_thin_layers_are_bonded);
    RUN_TEST(test_surface_of_a_straight_side);
    RUN_TEST(test_answer_and_return_by_hand);
    RUN_TEST(test_momentum_closes);
    RUN_TEST(test_dry_particles_owe_less_and_less);
    return UNITY_END();
}
