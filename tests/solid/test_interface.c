/* SPDX-License-Identifier: MIT
 * The fluid's answer to a structure within its sub-steps (T-35a, T-35b). */
#include "time/integrators.h"
#include "solid/interface.h"
#include "rig.h"
#include "unity.h"

#include <math.h>
#include <string.h>

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

static void test_wherever_there_are_substeps(void)
{
    static const char *const single[] = {"numerics.multirate=off", "numerics.fixed_step=1e-9"};
    for (size_t k = 0; k < COUNT_OF(single); k++) {
        open(single[k], NULL);
        TEST_ASSERT_FALSE_MESSAGE(rig.sim.effects & FX_IMPEDANCE, single[k]);
        TEST_ASSERT_TRUE(rig.sim.solid.impedance == 0);
        rig_close(&rig);
    }
    static const char *const densities[] = {"block.density=100", "block.density=7800"};
    for (size_t k = 0; k < COUNT_OF(densities); k++) {
        open(densities[k], "block.young=1e8");
        TEST_ASSERT_TRUE_MESSAGE(rig.sim.effects & FX_IMPEDANCE, densities[k]);
        assert_near(1e-12, 1000 * 20, rig.sim.solid.impedance, "rho0 c0");
        rig_close(&rig);
    }
}

/* A pressure of 1 Pa everywhere presses with the force of the height on the middle of a straight
 * side: a column of particles across it has the surface dp, within the 1.7 % by which sums on the
 * lattice differ from integrals. */
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

/* Particle 0 with the surface (0.006, 0.008) m goes at (3, 4) m/s where the fluid uses (0, 1.25)
 * m/s; its normal for sub-steps of 1e-4 s. */
static void face_one(void)
{
    solid->wet_x[0] = 0.006;
    solid->wet_y[0] = 0.008;
    solid->vx[0] = 3;
    solid->vy[0] = 4;
    solid->wx[0] = 0;
    solid->wy[0] = 1.25;
    interface_begin(&rig.sim.solid, solid, 1e-4, 10);
}

static double along(void)
{
    const struct particles *const p = &rig.sim.kind[KIND_SOLID];
    return p->vx[0] * p->face_x[0] + p->vy[0] * p->face_y[0];
}

/* By hand: mass 100 * 1e-4 = 0.01 kg/m, rho0 c0 = 2e4, dt = 1e-4: k = 1e-4 * 2e4 * 0.01/0.01 = 2;
 * along the surface 0.6 * 3 + 0.8 * 2.75 = 4 m/s faster, of which 2/3 go: kick (-1.6, -6.4/3), of
 * which 0.01 is the impulse. */
static void test_kick_and_return_by_hand(void)
{
    static const char *const integrators[] = {"integrator=symplectic", "integrator=leapfrog"};
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        open(integrators[k], NULL);
        face_one();
        impedance_kick(solid, 0, along());
        assert_near(1e-12, 3 - 1.6, solid->vx[0], "vx");
        assert_near(1e-12, 4 - 6.4 / 3, solid->vy[0], "vy");
        /* At the mean velocity the impulse does the work that the kinetic energy shows. */
        assert_near(1e-12, 0.5 * (square(3 - 1.6) + square(4 - 6.4 / 3) - 25), solid->face_work[0],
                    "work");
        interface_end(&rig.sim.solid, solid);
        assert_near(1e-14, -0.016, solid->interface_impulse_x[0], "impulse, x");
        assert_near(1e-14, -0.064 / 3, solid->interface_impulse_y[0], "impulse, y");
        solid->fx[0] = 7;
        interface_begin(&rig.sim.solid, solid, 1e-4, 10);
        assert_near(1e-10, 7 + 0.02 * 0.016 / 1e-3, solid->fx[0], "fx");
        assert_near(1e-14, -0.016 * 0.98, solid->interface_impulse_x[0], "still to be returned, x");
        rig_close(&rig);
    }
    open(NULL, NULL);
}

/* By hand, of 20 times the fluid's density: k = 0.01, of which 1/101 go. A clamped particle has
 * no normal. */
static void test_kicks_of_a_heavy_body(void)
{
    open("block.density=20000", "block.young=1e8");
    face_one();
    impedance_kick(solid, 0, along());
    assert_near(1e-12, 3 - 0.6 * 4 / 101, solid->vx[0], "vx");
    assert_near(1e-12, 4 - 0.8 * 4 / 101, solid->vy[0], "vy");
    impedance_kick(solid, 0, along());
    assert_near(1e-12, 3 - 0.6 * 4 * (1 - square(100 / 101.0)), solid->vx[0], "vx, twice");
    interface_end(&rig.sim.solid, solid);
    assert_near(1e-13, -2 * 0.6 * 4 * (1 - square(100 / 101.0)), solid->interface_impulse_x[0],
                "impulse, x");
    solid->free[0] = 0;
    face_one();
    impedance_kick(solid, 0, along());
    TEST_ASSERT_TRUE(solid->vx[0] == 3 && solid->vy[0] == 4);
}

/* Nothing depends on whether a body is lighter or heavier than the fluid: a millionth more of its
 * density moves a run by no more than that, whatever the integrator. */
static void test_law_is_continuous_at_the_fluids_density(void)
{
    static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                              "integrator=leapfrog"};
    static const char *const densities[2][2] = {{"block.density=1000", "block.density=1000.001"},
                                                {"block.density=500", "block.density=500.0005"}};
    for (size_t k = 0; k < COUNT_OF(integrators); k++)
        for (int pair = 0; pair < 2; pair++) {
            double x[2];
            for (int n = 0; n < 2; n++) {
                rig_open(&rig, block, integrators[k], densities[pair][n], "block.young=1e8",
                         "numerics.fixed_step=1e-4", NULL);
                solid = &rig.sim.kind[KIND_SOLID];
                rig_run(&rig, 0.02);
                x[n] = solid->ux[0];
                rig_close(&rig);
            }
            TEST_ASSERT_TRUE(fabs(x[0]) > 1e-3);
            assert_at_most(3e-6 * fabs(x[0]), fabs(x[1] - x[0]), integrators[k]);
        }
    open(NULL, NULL);
}

/* Sub-steps written out: kick, impedance, drift; centred ones begin and end with half a drift. */
static void substeps_by_hand(double dt, int n, bool centred)
{
    const double half = centred ? 0.5 * dt : 0;
    for (int64_t i = 0; i < solid->n; i++) {
        solid->ux[i] += half * solid->vx[i];
        solid->uy[i] += half * solid->vy[i];
    }
    for (int k = 1; k <= n; k++) {
        solid_stress(&rig.sim.solid, solid);
        solid_forces(&rig.sim.solid, solid);
        for (int64_t i = 0; i < solid->n; i++) {
            solid->vx[i] += dt * solid->sx[i];
            solid->vy[i] += dt * solid->sy[i];
            const double wet = hypot(solid->wet_x[i], solid->wet_y[i]);
            const double mass = 2000 * 1e-4, stiff = dt * 1000 * 20 * wet / mass;
            const double nx = wet > 0 ? solid->wet_x[i] / wet : 0,
                         ny = wet > 0 ? solid->wet_y[i] / wet : 0;
            const double faster =
                (solid->vx[i] - solid->wx[i]) * nx + (solid->vy[i] - solid->wy[i]) * ny;
            const double kick = -stiff / (1 + stiff) * faster;
            solid->vx[i] += kick * nx;
            solid->vy[i] += kick * ny;
            solid->interface_impulse_x[i] += mass * kick * nx;
            solid->interface_impulse_y[i] += mass * kick * ny;
            const double drift = k < n ? dt : dt - half;
            solid->ux[i] += drift * solid->vx[i];
            solid->uy[i] += drift * solid->vy[i];
        }
    }
}

static void twin(const char *integrator, bool centred)
{
    enum { FIELDS = 6, MOST = 32 };
    static double start[FIELDS][MOST], end[FIELDS][MOST];
    open(integrator, "block.density=2000");
    rig_steps(&rig, 30, 1);
    rig_evaluate(&rig);
    double *const field[FIELDS] = {solid->ux,
                                   solid->uy,
                                   solid->vx,
                                   solid->vy,
                                   solid->interface_impulse_x,
                                   solid->interface_impulse_y};
    const size_t bytes = (size_t)solid->n * sizeof(double);
    TEST_ASSERT_TRUE(solid->n <= MOST);
    for (int64_t i = 0; i < solid->n; i++)
        solid->interface_impulse_x[i] = solid->interface_impulse_y[i] = 0;
    for (int f = 0; f < FIELDS; f++) memcpy(start[f], field[f], bytes);
    const double dt = rig.sim.dt_solid;
    substeps_by_hand(dt, 5, centred);
    for (int f = 0; f < FIELDS; f++) memcpy(end[f], field[f], bytes);
    for (int f = 0; f < FIELDS; f++) memcpy(field[f], start[f], bytes);
    advance_solid(&rig.sim, 5 * dt, 5, centred);
    double impulse = 0;
    for (int64_t i = 0; i < solid->n; i++) {
        for (int f = 0; f < FIELDS; f++)
            assert_near(1e-13 * (f < 2 ? 1e-3 : 1), end[f][i], field[f][i], "a field");
        impulse = fmax(impulse, fabs(solid->interface_impulse_x[i]));
    }
    TEST_ASSERT_TRUE(impulse > 1e-9);
    rig_close(&rig);
}

static void test_substeps_by_hand(void)
{
    twin("integrator=verlet", false);
    twin("integrator=leapfrog", true);
    twin("integrator=symplectic", true);
    open(NULL, NULL);
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
        sum += part - solid->interface_impulse_x[i];
        *size += fabs(part);
    }
    return sum;
}

/* Momentum of fluid, structure and interface impulse together is conserved. */
static void test_momentum_closes(void)
{
    open("integrator=symplectic", NULL);
    double size;
    const double start = momentum(&size);
    rig_steps(&rig, 200, 1);
    const double end = momentum(&size);
    double impulse = 0;
    for (int64_t i = 0; i < solid->n; i++) impulse += fabs(solid->interface_impulse_x[i]);
    TEST_ASSERT_TRUE(impulse > 1e-6 * size);
    assert_near(1e-11 * size, start, end, "momentum");
}

/* Water that leaves a light wall takes nothing of what is impulse along: once a particle is dry, its
 * force is what it is given back, which fades. */
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
    double impulse = 0;
    for (int64_t i = 0; i < solid->n; i++)
        impulse = fmax(impulse, fabs(solid->interface_impulse_x[i]));
    rig_run(&rig, 0.2);
    TEST_ASSERT_TRUE(impulse > 0);
    const double kept = impulse * pow(0.98, 300);
    for (int64_t i = 0; i < solid->n; i++) {
        TEST_ASSERT_TRUE(solid->wet_x[i] == 0);
        assert_at_most(kept, fabs(solid->interface_impulse_x[i]), "impulse");
        assert_at_most(0.02 * kept / rig.sim.state.dt, fabs(solid->fx[i]),
                       "force of what is given back");
    }
}

/* Particles of a moving clamp have no interface impulse; their neighbours have. */
static void test_moving_clamps_owe_nothing(void)
{
    rig_open(
        &rig,
        "dp = 1 cm\nend_time = 1\n[fluid water]\nshape = box 0, 0, 0.24, 0.1\nsound_speed = 20\n"
        "[solid floor]\nshape = box 0, -0.04, 0.24, 0\ndensity = 2000\nyoung = 1e7\npoisson = 0.3\n"
        "clamp = box 0, -0.04, 0.1, 0\nclamp_motion = shake\n"
        "[motion shake]\nkind = polynomial\npoly_y = 0, 5\n"
        "[domain]\nlower = -0.2, -0.2\nupper = 0.5, 0.5\n",
        NULL);
    TEST_ASSERT_TRUE(rig.sim.effects & FX_IMPEDANCE);
    solid = &rig.sim.kind[KIND_SOLID];
    rig_steps(&rig, 20, 1);
    double most = 0, wet = 0;
    for (int64_t i = 0; i < solid->n; i++) {
        const double impulse = hypot(solid->interface_impulse_x[i], solid->interface_impulse_y[i]);
        most = fmax(most, impulse);
        if (solid->X[i] > 0.1) continue;
        wet = fmax(wet, hypot(solid->wet_x[i], solid->wet_y[i]));
        TEST_ASSERT_TRUE(impulse == 0);
    }
    TEST_ASSERT_TRUE(most > 0 && wet > 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_wherever_there_are_substeps);
    RUN_TEST(test_surface_of_a_straight_side);
    RUN_TEST(test_kick_and_return_by_hand);
    RUN_TEST(test_kicks_of_a_heavy_body);
    RUN_TEST(test_law_is_continuous_at_the_fluids_density);
    RUN_TEST(test_substeps_by_hand);
    RUN_TEST(test_momentum_closes);
    RUN_TEST(test_dry_particles_owe_less_and_less);
    RUN_TEST(test_moving_clamps_owe_nothing);
    return UNITY_END();
}
