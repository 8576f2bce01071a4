/* SPDX-License-Identifier: MIT
 * Walls as the fluid sees them: Eqs. 19-20 in the form of Adami et al. 2012, free slip.
 *
 * Pairs by hand: h = 1 m, m = 640 kg/m, rho0 = 1000 kg/m^3, c0 = 10 m/s; a fluid particle of rho =
 * 1010 (P = 1030.5050301001436 Pa) one metre above a wall particle: |grad W| = 0.3481514380135211.
 */
#include "rig.h"
#include "unity.h"

#include <math.h>

static const char pair[] = "dp = 0.8\nend_time = 1\nprecision = double\ngravity = 0, -9.81\n"
                           "[numerics]\nh_over_dp = 1.25\nskin = 0.5\n"
                           "[domain]\nlower = -10, -10\nupper = 10, 10\n"
                           "[fluid w]\nshape = box 0, 0, 0.8, 0.8\nsound_speed = 10\n"
                           "[wall plate]\nshape = box 0, -0.8, 0.8, 0\nmotion = m\n"
                           "[motion m]\n";

static struct rig rig;
static struct particles *fluid, *wall;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

static void place(double wall_acceleration, const char *set)
{
    rig_open(&rig, pair, set, NULL);
    fluid = &rig.sim.particles[KIND_FLUID];
    wall = &rig.sim.particles[KIND_WALL];
    TEST_ASSERT_TRUE(fluid->n == 1 && wall->n == 1);
    fluid->x[0] = wall->x[0] = 0;
    fluid->y[0] = 1;
    wall->y[0] = 0;
    fluid->dens[0] = 0.01;
    wall->ay[0] = wall_acceleration;
    rig_sort(&rig);
    rig_evaluate(&rig);
}

/* P_s = P_f + rho_f g 1 m = 1030.505 + 1010 * 9.81 = 10938.605030100143 Pa, whatever the weight;
 * rho_s = 1000 (7 P_s/1e5 + 1)^(1/7) = 1084.610808319408; and the fluid rises by
 * 640 (P_f + P_s)/(1010 rho_s) 0.34815 = 2.434527732452041 m/s^2 against g. */
static void test_pressure_below_a_particle(void)
{
    place(0, "w.density=1000");
    assert_near(1e-9, 10938.605030100143, wall->p[0], "P_s");
    assert_near(1e-13, 0.084610808319408, wall->dens[0], "rho_s/rho0 - 1");
    assert_near(1e-12, 2.434527732452041 - 9.81, fluid->ay[0], "ay");
    assert_near(1e-12, 0, fluid->ax[0], "ax");
    /* The wall's share of the pair: 640 kg/m times the acceleration, downwards. */
    assert_near(1e-9, -640 * 2.434527732452041, wall->fy[0], "force on the wall");
}

/* A wall that falls with 4 m/s^2 carries less: P_s = 1030.505 + 1010 * 5.81 = 6898.605030100144 Pa;
 * one in free fall carries the fluid's own pressure. */
static void test_acceleration_of_the_wall(void)
{
    place(-4, "w.density=1000");
    assert_near(1e-9, 6898.605030100144, wall->p[0], "P_s");
    assert_near(1e-13, 0.0579000814699364, wall->dens[0], "rho_s/rho0 - 1");
    place(-9.81, "w.density=1000");
    assert_near(1e-9, 1030.5050301001436, wall->p[0], "P_s");
}

/* Eq. 4a counts the wall's own velocity: v_ab = (0, -1.5), drho = 1010 * 640/1084.6108 * 1.5 *
 * 0.34815 = 311.2338838121733 kg/(m^3 s). */
static void test_velocity_of_the_wall(void)
{
    place(0, "w.density=1000");
    fluid->vy[0] = -1;
    wall->vy[0] = 0.5;
    rig_evaluate(&rig);
    assert_near(1e-10, 311.2338838121733, 1000 * fluid->ddens[0], "drho");
    assert_near(1e-14, 1.5 / 1.01, rig.sim.fluid.extremes.approach, "rate of approach");
}

/* Free slip: neither viscosity nor diffusion between fluid and walls. */
static void test_walls_slip_freely(void)
{
    double ay[2], ddens[2];
    for (int k = 0; k < 2; k++) {
        place(0, k ? "w.artificial_viscosity=0.5" : "w.artificial_viscosity=0");
        fluid->vy[0] = -1;
        fluid->vx[0] = 3;
        rig_evaluate(&rig);
        TEST_ASSERT_TRUE(fluid->ax[0] == 0);
        ay[k] = fluid->ay[0];
        place(0, k ? "w.density_diffusion=0.5" : "w.density_diffusion=0");
        ddens[k] = fluid->ddens[0];
    }
    TEST_ASSERT_TRUE(ay[0] == ay[1]);
    TEST_ASSERT_TRUE(ddens[0] == ddens[1]);
    TEST_ASSERT_TRUE(ddens[0] == 0);
}

/* No slip: the fluid, v = (3, -1), is all that the wall, v = (0.5, 0.25), sees, so that the
 * mirrored velocity is 2 (0.5, 0.25) - (3, -1), and the difference to the fluid's is 2 (2.5,
 * -1.25). With nu = 0.3 m^2/s and M = 0.966540345811312 the factor of L-1 is 600 * 640/(1010 *
 * 1084.6108) 0.3481514/M = 0.12626533307786328 1/s. What drags the fluid pulls at the wall. */
static void test_fluid_sticks_to_a_wall(void)
{
    double ay[2], fy[2];
    for (int sticks = 0; sticks < 2; sticks++) {
        rig_open(&rig, pair, sticks ? "plate.slip=none" : "plate.slip=free",
                 "w.laminar_viscosity=0.3", NULL);
        fluid = &rig.sim.particles[KIND_FLUID];
        wall = &rig.sim.particles[KIND_WALL];
        fluid->x[0] = wall->x[0] = wall->y[0] = 0;
        fluid->y[0] = 1;
        fluid->dens[0] = 0.01;
        fluid->vx[0] = 3;
        fluid->vy[0] = -1;
        wall->vx[0] = 0.5;
        wall->vy[0] = 0.25;
        rig_sort(&rig);
        rig_evaluate(&rig);
        const double drag = sticks ? 5 * 0.12626533307786328 : 0;
        assert_near(1e-13, -drag, fluid->ax[0], "ax");
        assert_near(1e-10, 640 * drag, wall->fx[0], "drag on the wall");
        ay[sticks] = fluid->ay[0];
        fy[sticks] = wall->fy[0];
    }
    assert_near(1e-13, 2.5 * 0.12626533307786328, ay[1] - ay[0], "ay");
    assert_near(1e-9, -640 * 2.5 * 0.12626533307786328, fy[1] - fy[0], "force on the wall");
}

/* Repulsion of a fluid particle 0.4 m, half a spacing, above the wall's, beta = 0.1: |grad W| =
 * 35/(4 pi) 0.4 0.8^3 = 0.57041 1/m^3, and 0.1 * 1e5 ((0.64^2 + 0.01)/(0.4^2 + 0.01) - 1) =
 * 14682.35 Pa, the same on both. Nothing at 0.65 m. A quarter where the largest speed is known to
 * be a twentieth of the speed of sound. */
static void test_a_wall_pushes_back(void)
{
    double ay[3], fy[3];
    for (int far = 0; far < 2; far++) {
        for (int k = 0; k < 3; k++) {
            rig_open(&rig, pair, k ? "w.wall_repulsion=0.1" : "w.wall_repulsion=0",
                     k == 2 ? "w.max_speed=0.5" : NULL, NULL);
            fluid = &rig.sim.particles[KIND_FLUID];
            wall = &rig.sim.particles[KIND_WALL];
            fluid->x[0] = wall->x[0] = wall->y[0] = 0;
            fluid->y[0] = far ? 0.65 : 0.4;
            rig_sort(&rig);
            rig_evaluate(&rig);
            ay[k] = fluid->ay[0];
            fy[k] = wall->fy[0];
        }
        const double slope = 35 / (4 * 3.14159265358979323846) * 0.4 * 0.8 * 0.8 * 0.8;
        const double push = 1e4 * ((0.64 * 0.64 + 0.01) / (0.4 * 0.4 + 0.01) - 1);
        const double force = far ? 0 : 0.64 * 0.64 / (1 + wall->dens[0]) * slope * push;
        TEST_ASSERT_TRUE(far || force > 3e3);
        assert_near(1e-12 * (1 + force), force / 640, ay[1] - ay[0], "ay");
        assert_near(1e-12 * (1 + force), -force, fy[1] - fy[0], "force on the wall");
        assert_near(1e-12 * (1 + force), force / 4, fy[0] - fy[2], "at twice the speed of sound");
    }
}

/* L-7a: the same pair, where the fluid falls at 3 m/s and the wall rises at 1 m/s.
 * With u = 4 * 0.4/sqrt(0.4^2 + 0.01) = 3.8806 m/s, 1000 * 10 u (0.4196/0.17 - 1) Pa come with it.
 * Nothing where they part. */
static void test_a_wall_resists_approach(void)
{
    double ay[2], fy[2];
    for (int part = 0; part < 2; part++) {
        for (int k = 0; k < 2; k++) {
            rig_open(&rig, pair, "w.wall_repulsion=0.1",
                     k ? "w.wall_damping=1" : "w.wall_damping=0", NULL);
            fluid = &rig.sim.particles[KIND_FLUID];
            wall = &rig.sim.particles[KIND_WALL];
            fluid->x[0] = wall->x[0] = wall->y[0] = 0;
            fluid->y[0] = 0.4;
            fluid->vy[0] = part ? 3 : -3;
            wall->vy[0] = part ? -1 : 1;
            rig_sort(&rig);
            rig_evaluate(&rig);
            ay[k] = fluid->ay[0];
            fy[k] = wall->fy[0];
        }
        const double slope = 35 / (4 * 3.14159265358979323846) * 0.4 * 0.8 * 0.8 * 0.8;
        const double u = 4 * 0.4 / sqrt(0.4 * 0.4 + 0.01);
        const double push = 1e4 * u * ((0.64 * 0.64 + 0.01) / (0.4 * 0.4 + 0.01) - 1);
        const double force = part ? 0 : 0.64 * 0.64 / (1 + wall->dens[0]) * slope * push;
        TEST_ASSERT_TRUE(part || force > 1e4);
        assert_near(1e-12 * (1 + force), force / 640, ay[1] - ay[0], "ay");
        assert_near(1e-12 * (1 + force), -force, fy[1] - fy[0], "force on the wall");
    }
}

/* One particle of fluid is all that the wall sees: whose pressure it has makes no difference, not
 * to one that pulls either. */
static void test_one_particle_has_one_side(void)
{
    for (int k = 0; k < 2; k++) {
        double ay[2], fy[2];
        for (int one = 0; one < 2; one++) {
            rig_open(&rig, pair, one ? "numerics.sides=one" : "numerics.sides=both",
                     k ? "numerics.suction=on" : "numerics.suction=off", NULL);
            fluid = &rig.sim.particles[KIND_FLUID];
            wall = &rig.sim.particles[KIND_WALL];
            fluid->x[0] = wall->x[0] = wall->y[0] = 0;
            fluid->y[0] = 1;
            fluid->dens[0] = k ? -0.03 : 0.01;
            wall->ay[0] = 5;
            rig_sort(&rig);
            rig_evaluate(&rig);
            ay[one] = fluid->ay[0];
            fy[one] = wall->fy[0];
        }
        assert_near(1e-12, ay[0], ay[1], "ay");
        assert_near(1e-9, fy[0], fy[1], "force on the wall");
    }
}

/* Two particles of fluid, one on each side of a wall of one particle, P_f = 1030.505 Pa on one and
 * 0 on the other, without gravity. With the mean of both on the wall the one without pressure is
 * pushed away by 515 Pa of it; with its own it is left alone, and the other is pushed with 2 P_f.
 */
static void test_pressure_behind_a_wall_is_not_felt(void)
{
    double ay[2][2];
    for (int one = 0; one < 2; one++) {
        rig_open(&rig, pair, one ? "numerics.sides=one" : "numerics.sides=both", "gravity=0, 0",
                 "w.shape=box 0, 0, 0.8, 1.6", NULL);
        fluid = &rig.sim.particles[KIND_FLUID];
        wall = &rig.sim.particles[KIND_WALL];
        TEST_ASSERT_TRUE(fluid->n == 2 && wall->n == 1);
        for (int i = 0; i < 2; i++) {
            fluid->x[i] = 0;
            fluid->y[i] = fluid->id[i] ? -1.1 : 1.1;
            fluid->dens[i] = fluid->id[i] ? 0 : 0.01;
        }
        wall->x[0] = wall->y[0] = 0;
        rig_sort(&rig);
        rig_evaluate(&rig);
        for (int i = 0; i < 2; i++) ay[one][fluid->id[i]] = fluid->ay[i];
        assert_near(1e-9, -640 * (ay[one][0] + ay[one][1]), wall->fy[0], "force on the wall");
    }
    TEST_ASSERT_TRUE(ay[0][1] < -0.05 && ay[1][1] == 0);
    assert_near(1e-12, 2 / 1.5, ay[1][0] / ay[0][0], "push on the other");
}

/* Where the first wall particle began. */
static double wall_at(int axis)
{
    const struct particles *const particles = &rig.sim.particles[KIND_WALL];
    return axis ? particles->Y[0] : particles->X[0];
}

static void test_dry_walls_have_no_pressure(void)
{
    place(0, "w.density=1000");
    fluid->y[0] = 2.0001;
    rig_sort(&rig);
    rig_evaluate(&rig);
    TEST_ASSERT_TRUE(wall->p[0] == 0 && wall->dens[0] == 0 && wall->fy[0] == 0);
    TEST_ASSERT_TRUE(fluid->ay[0] == -9.81);
}

/* Below still water the extrapolation is exact but for the lift's own density: P_s = rho0 g (H -
 * y_s) within the largest dens, g H/c0^2 = 2.5e-5. */
static void test_hydrostatic_pressure_continues_into_the_wall(void)
{
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\nprecision = double\n"
             "[fluid w]\nshape = box 0, 0, 0.2, 0.1\nsurface = 0.1\nsound_speed = 200\n"
             "[wall w]\nshape = box -0.03, -0.03, 0.23, 0\nshape = box -0.03, 0, 0, 0.1\n",
             NULL);
    rig_evaluate(&rig);
    wall = &rig.sim.particles[KIND_WALL];
    int64_t wet = 0;
    for (int64_t i = 0; i < wall->n; i++) {
        if (wall->p[i] == 0) continue;
        wet++;
        const double exact = 1000 * 9.81 * (0.1 - wall->y[i]);
        assert_near(2.5e-5 * 1000 * 9.81 * 0.13, exact, wall->p[i], "P_s");
    }
    TEST_ASSERT_TRUE(wet > 50);
}

/* A moving wall is where its motion says, to the last bit, at every stage that ends a step. */
static void test_moving_walls_follow_their_motion(void)
{
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n"
             "[fluid w]\nshape = box 0, 0, 0.1, 0.05\nsurface = 0.05\nsound_speed = 20\n"
             "[wall w]\nshape = box -0.04, 0, 0, 0.1\nmotion = m\n"
             "[wall floor]\nshape = box -0.04, -0.04, 0.14, 0\n"
             "[motion m]\nx = t*(0.1 + 2*t)\n",
             NULL);
    wall = &rig.sim.particles[KIND_WALL];
    rig_run(&rig, 0.01);
    rig_evaluate(&rig);
    simulation_refresh(&rig.sim);
    for (int64_t i = 0; i < wall->n; i++) {
        const bool moves = wall->body[i] == 0;
        assert_near(1e-15, wall->X[i] + (moves ? 0.1 * 0.01 + 2 * 1e-4 : 0), wall->x[i], "x");
        assert_near(1e-15, moves ? 0.1 + 4 * 0.01 : 0, wall->vx[i], "vx");
        assert_near(1e-15, moves ? 4 : 0, wall->ax[i], "ax");
        TEST_ASSERT_TRUE(wall->y[i] == wall->Y[i] && wall->vy[i] == 0);
    }
}

/* Water in a tank that turns quickly by a quarter and back lags behind, but none of it gets through
 * the walls, which do work on it. */
static void test_a_turning_tank_holds_its_water(void)
{
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n"
             "[fluid w]\nshape = box 0, 0, 0.2, 0.1\nsurface = 0.1\nsound_speed = 30\n"
             "artificial_viscosity = 0.1\ndensity_diffusion = 0.1\n"
             "[wall tank]\nshape = box -0.04, -0.04, 0.24, 0\nshape = box -0.04, 0.3, 0.24, 0.34\n"
             "shape = box -0.04, 0, 0, 0.3\nshape = box 0.2, 0, 0.24, 0.3\nmotion = roll\n"
             "[motion roll]\ncentre = 0.1, 0\nturn = -0.4*cos(4*pi*t)\n",
             NULL);
    fluid = &rig.sim.particles[KIND_FLUID];
    const int64_t n = fluid->n;
    rig_run(&rig, 0.25);
    TEST_ASSERT_EQUAL_INT64(n, fluid->n);
    const double c = cos(0.8), s = sin(0.8); /* the other turning point; seen from the tank ... */
    for (int64_t i = 0; i < n; i++) {
        const double dx = fluid->x[i] - 0.1, dy = fluid->y[i];
        const double x = c * dx + s * dy + 0.1, y = -s * dx + c * dy;
        /* ... within its faces, but for a quarter of dp: the wall's own particles begin at half of
         * it. */
        TEST_ASSERT_TRUE(x > -0.0025 && x < 0.2025 && y > -0.0025 && y < 0.3025);
    }
    TEST_ASSERT_TRUE(rig.sim.state.wall_work != 0);
    assert_near(1e-15, 0.1 + c * (wall_at(0) - 0.1) - s * wall_at(1),
                rig.sim.particles[KIND_WALL].x[0], "x of a wall particle");
}

/* A box of 0.2 m in water at rest is carried by the weight of what it displaces, to the error of
 * the sums at its edges, also where the water is compressed by 1 %. */
static void test_a_body_at_rest_is_carried(void)
{
    rig_open(&rig,
             "dp = 10 mm\nend_time = 1\ngravity = 0, -9.81\n[numerics]\nh_over_dp = 2\n"
             "[fluid w]\nshape = box 0, 0, 0.6, 0.6\nminus = box 0.2, 0.2, 0.4, 0.4\n"
             "surface = 0.6\nsound_speed = 20\nparticle_mass = hydrostatic\n"
             "[wall tank]\nshape = polyline: 0, 0.8; 0, 0; 0.6, 0; 0.6, 0.8\n"
             "[wall box]\nshape = box 0.2, 0.2, 0.4, 0.4\n"
             "[probe lift]\nquantity = force\nbody = box\npoint = 0.3, 0.3\n",
             NULL);
    simulation_wall_forces(&rig.sim);
    wall = &rig.sim.particles[KIND_WALL];
    double force = 0;
    for (int64_t i = 0; i < wall->n; i++)
        if (wall->body[i] == 1) force += wall->fy[i];
    assert_near(0.002 * 392.4, 392.4, force, "lift");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_pressure_below_a_particle);
    RUN_TEST(test_acceleration_of_the_wall);
    RUN_TEST(test_velocity_of_the_wall);
    RUN_TEST(test_walls_slip_freely);
    RUN_TEST(test_fluid_sticks_to_a_wall);
    RUN_TEST(test_a_wall_pushes_back);
    RUN_TEST(test_a_wall_resists_approach);
    RUN_TEST(test_one_particle_has_one_side);
    RUN_TEST(test_pressure_behind_a_wall_is_not_felt);
    RUN_TEST(test_dry_walls_have_no_pressure);
    RUN_TEST(test_hydrostatic_pressure_continues_into_the_wall);
    RUN_TEST(test_moving_walls_follow_their_motion);
    RUN_TEST(test_a_turning_tank_holds_its_water);
    RUN_TEST(test_a_body_at_rest_is_carried);
    return UNITY_END();
}
