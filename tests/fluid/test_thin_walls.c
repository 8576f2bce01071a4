/* SPDX-License-Identifier: MIT
 * Thin lines (T-110, T-111): walls of no thickness with fluid on both sides. */
#include "rig.h"
#include "geometry/motion.h"
#include "time/advance.h"
#include "time/energy.h"
#include "unity.h"

#include "fluid/fluid.h"

#include <math.h>

#define TOP "dp = 20 mm\nend_time = 9\ngravity = 0, -9.81\nscheme = standard\n"
#define LIKE "max_speed = 2\nmax_pressure = 4 kPa\n"
#define WATER(box) "[fluid water]\nshape = box " box "\nsurface = 0.4\n" LIKE
#define TANK "[wall tank]\nshape = polyline: -0.4, 0.6; -0.4, 0; 0.4, 0; 0.4, 0.6\n"
#define LINE "[wall line]\nshape = polyline: "
#define FORCE "[probe f]\nquantity = force\nbody = line\n"

static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

/* The present force on the wall number `body`. */
static void force_on(int body, double f[2])
{
    const struct particles *const walls = &rig.sim.particles[KIND_WALL];
    simulation_wall_forces(&rig.sim);
    f[0] = f[1] = 0;
    for (int64_t i = 0; i < walls->n; i++) {
        f[0] += walls->body[i] == body ? walls->fx[i] : 0;
        f[1] += walls->body[i] == body ? walls->fy[i] : 0;
    }
}

static double mean_square_speed(void)
{
    const struct particles *const fluid = &rig.sim.particles[KIND_FLUID];
    double sum = 0;
    for (int64_t i = 0; i < fluid->n; i++) sum += square(fluid->vx[i]) + square(fluid->vy[i]);
    return sum / (double)fluid->n;
}

/* Two levels: the difference of rho g H^2/2. */
static void test_force_of_two_levels(void)
{
    static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                              "integrator=leapfrog"};
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        double f[2], mean = 0;
        rig_open(&rig,
                 TOP WATER("-0.4, 0, 0, 0.4") "[fluid low]\nshape = box 0, 0, 0.4, 0.2\n" LIKE
                                              "surface = 0.2\n" TANK LINE "0, 0; 0, 0.6\n" FORCE,
                 integrators[k], NULL);
        force_on(1, f);
        const double expected = 0.5 * 1000 * 9.81 * (0.16 - 0.04);
        assert_near(0.01 * expected, expected, f[0], "force at the start");
        for (int n = 1; n <= 20; n++) {
            rig_run(&rig, 0.2 + 0.01 * n);
            force_on(1, f);
            mean += f[0] / 20;
        }
        assert_near(0.015 * expected, expected, mean, "mean force");
        assert_at_most(square(0.01), mean_square_speed(), "speed^2");
        const struct particles *const fluid = &rig.sim.particles[KIND_FLUID];
        for (int64_t i = 0; i < fluid->n; i++)
            TEST_ASSERT_TRUE((fluid->x[i] > 0) == (fluid->body[i] == 1));
    }
}

/* Water at rest stays so around a tip, a line that stands free and a cup, whose corners are of both
 * kinds; and nothing pushes these. Without T-110b their ends stir it. Beside a line that
 * is not along the lattice, particles begin out of order. */
static void test_water_at_rest(void)
{
    static const struct {
        const char *line;
        double speed;
    } scenes[] = {{"0, 0; 0, 0.2\n", 0.01},
                  {"-0.1, 0.16; 0.1, 0.16\n", 0.01},
                  {"-0.1, 0.5; -0.1, 0.16; 0.1, 0.16; 0.1, 0.3\n", 0.01},
                  {"-0.08, 0.1; 0.12, 0.2\n", 0.02}};
    for (size_t k = 0; k < COUNT_OF(scenes); k++) {
        char text[1000];
        double f[2];
        snprintf(text, sizeof text, "%s%s%s", TOP WATER("-0.4, 0, 0.4, 0.4") TANK LINE,
                 scenes[k].line, FORCE);
        rig_open(&rig, text, NULL);
        rig_run(&rig, 0.3);
        assert_at_most(square(scenes[k].speed), mean_square_speed(), scenes[k].line);
        force_on(1, f);
        assert_at_most(8, fabs(f[0]), scenes[k].line);
    }
}

/* A line that stands on another one: each side has its own pressure. */
static void test_two_lines_that_meet(void)
{
    double f[2];
    rig_open(&rig,
             TOP WATER("-0.4, 0.1, 0, 0.4") "[fluid right]\nshape = box 0, 0.1, 0.4, 0.24\n" LIKE
                                            "surface = 0.24\n[fluid below]\nshape = box -0.4, 0, "
                                            "0.4, 0.1\npressure = 9810*(0.3 - y)\n" LIKE TANK LINE
                                            "-0.4, 0.1; 0.4, 0.1\n[wall post]\nshape = polyline: "
                                            "0, 0.1; 0, 0.5\n" FORCE,
             NULL);
    rig_run(&rig, 0.2);
    force_on(2, f);
    const double post = 0.5 * 9810 * (square(0.3) - square(0.14));
    assert_near(0.02 * post, post, f[0], "post");
    force_on(1, f);
    const double up = 9810 * 0.2 * 0.8, down = 9810 * (0.3 + 0.14) * 0.4;
    assert_near(0.02 * down, up - down, f[1], "shelf");
    assert_at_most(square(0.02), mean_square_speed(), "speed^2");
}

/* What crosses the line x = 0, which moves with `motion`, below `top` within a step. */
static int crossings(double top, bool first)
{
    const struct particles *const fluid = &rig.sim.particles[KIND_FLUID];
    const double place = rig.sim.fluid.lines.line[0].end[0].x[0];
    static int8_t side[20000];
    int n = 0;
    for (int64_t i = 0; i < fluid->n; i++) {
        const int8_t now = fluid->x[i] > place ? 1 : -1, before = side[fluid->id[i]];
        n += !first && now != before && fluid->y[i] < top;
        side[fluid->id[i]] = now;
    }
    return n;
}

/* A piston between two volumes: what it takes from one level it adds to the other. */
static void test_a_piston(void)
{
    rig_open(&rig,
             TOP WATER("-0.4, 0, 0.4, 0.4") TANK LINE "0, 0; 0, 0.7\nmotion = m\n[motion m]\n"
                                                      "x = -0.04*cos(2*pi*t)\n" FORCE,
             NULL);
    while (rig.sim.state.time < 0.5) {
        rig_steps(&rig, 1, 9);
        TEST_ASSERT_EQUAL_INT(0, crossings(1, rig.sim.state.steps == 1));
    }
    const struct particles *const fluid = &rig.sim.particles[KIND_FLUID];
    double mean[2] = {0}, n[2] = {0};
    for (int64_t i = 0; i < fluid->n; i++) {
        const int right = fluid->x[i] > rig.sim.fluid.lines.line[0].end[0].x[0];
        mean[right] += fluid->y[i];
        n[right]++;
    }
    TEST_ASSERT_EQUAL_DOUBLE(n[0], n[1]);
    TEST_ASSERT_TRUE(mean[1] / n[1] - mean[0] / n[0] > 0.02);
}

/* A line that goes 0.1 m deeper between two halves of the water displaces none of it (T-110c). With
 * the motion of the dummies along the line in the rates the water gained 2.84 J/m. */
static void test_a_line_slides_into_water(void)
{
    rig_open(&rig,
             TOP WATER("-0.4, 0, 0.4, 0.4") TANK LINE "0, 0.7; 0, 0.2\nmotion = m\n[motion m]\n"
                                                      "y = 0.05*cos(2*pi*t)\n" FORCE,
             NULL);
    const double start = simulation_ledger(&rig.sim).potential;
    rig_run(&rig, 0.5);
    assert_at_most(0.3, fabs(simulation_ledger(&rig.sim).potential - start), "potential energy");
}

/* A dam break against a baffle: water passes over its tip only. */
static void test_a_dam_break(void)
{
    rig_open(&rig,
             TOP WATER("-0.4, 0, -0.16, 0.4") TANK "[wall line]\nshape = polyline thickness 0: 0, "
                                                   "0; 0, 0.2\n" FORCE,
             NULL);
    double largest = 0, f[2];
    while (rig.sim.state.time < 0.6) {
        rig_steps(&rig, 1, 9);
        TEST_ASSERT_EQUAL_INT(0, crossings(0.2 - rig.sim.fluid.k.h, rig.sim.state.steps == 1));
        if (rig.sim.state.steps % 10) continue;
        force_on(1, f);
        largest = max2(largest, f[0]);
    }
    TEST_ASSERT_TRUE(largest > 300);
}

/* T-110e: dummies in air have their full weight near a tip, too: shallow water pushes a line that
 * ends a spacing above it. With T-110b for these dummies the force was 8 % too small. */
static void test_a_tip_in_air(void)
{
    double f[2];
    rig_open(&rig,
             TOP "[fluid water]\nshape = box -0.4, 0, 0, 0.1\nsurface = 0.1\n" LIKE TANK
                 "[wall line]\nshape = polyline thickness 0: 0, 0; 0, 0.12\n" FORCE,
             NULL);
    force_on(1, f);
    const double expected = 0.5 * 9810 * square(0.1);
    assert_near(0.03 * expected, expected, f[0], "force");
}

/* T-110b: what passes between two places beside a line falls with the distance from its tip; the
 * energy of repulsion (L-7b) has these weights, too. With all of it for dummies that are hardly
 * seen, water that runs over a tip seemed to gain 1.5 % of its energy. */
static void test_what_is_seen_past_a_tip(void)
{
    rig_open(&rig,
             TOP "[fluid water]\nshape = box -0.4, 0, -0.16, 0.4\nsurface = 0.4\n"
                 "sound_speed = 40\n" TANK "[wall line]\nshape = polyline thickness 0: 0, 0; 0, "
                 "0.1\n",
             NULL);
    const double reach = KERNEL_REACH * rig.sim.fluid.k.h, way[2] = {0.02, 0};
    for (double part = -0.4; part < 1.5; part += 0.25) {
        const double from[2] = {-0.01, 0.1 - part * reach}, seen = max2(0, min2(1, part));
        for (int own = 0; own < 2; own++)
            for (double filled = 0; filled <= 1; filled += 0.5)
                assert_near(1e-6,
                            !own       ? 1 - seen
                            : part < 0 ? 0
                                       : 1 - filled * (1 - seen),
                            lines_seen(&rig.sim.fluid.lines, &rig.sim.cells, reach, from, way, own,
                                       filled),
                            "weight");
    }
    rig_run(&rig, 0.3);
    const struct energy_account *const account = &rig.sim.state.energy;
    assert_at_most(0.003 * account->largest_available, account->most[TERM_FLUID], "gain");
}

/* T-111b: what passes below an end that leaves a wall, and below one that turns there or moves with
 * the wall: nothing, as none of it opens. */
static void test_an_end_leaves_its_wall(void)
{
    static const struct {
        const char *line, *tank, *motion;
        bool leaves;
    } scenes[] = {{"motion = m\n", "", "y = t*0.02", true},
                  {"", "motion = m\n", "y = -t*0.02", true},
                  {"motion = m\n", "motion = m\n", "y = t*0.02", false},
                  {"motion = m\n", "", "centre = 0, 0.001\nturn = 0.1*t", false}};
    for (size_t k = 0; k < COUNT_OF(scenes); k++) {
        char text[1000];
        snprintf(text, sizeof text, "%s%s%s%s%s[motion m]\n%s\n", TOP WATER("-0.4, 0, 0, 0.4") TANK,
                 scenes[k].tank, "[wall line]\nshape = polyline thickness 0: 0, 0.3; 0, 0.001\n",
                 scenes[k].line, FORCE, scenes[k].motion);
        rig_open(&rig, text, NULL);
        const struct thin_line *const line = &rig.sim.fluid.lines.line[0];
        const double reach = KERNEL_REACH * rig.sim.fluid.k.h, way[2] = {0.01, 0};
        for (double rise = 0; rise < 2; rise += 0.25) {
            rig.sim.state.time = rise;
            place_moving_walls(&rig.sim, rise);
            const double from[2] = {-0.005, line->end[1].x[1] - 0.002};
            const double seen = rise > 0 && scenes[k].leaves ? min2(1, rise + 0.002 / reach) : 0;
            assert_near(1e-6, seen,
                        lines_seen(&rig.sim.fluid.lines, &rig.sim.cells, reach, from, way, 0, 1),
                        scenes[k].motion);
        }
    }
}

/* Particles out of order around a tip, a corner and a junction: the forces of fluid and walls have
 * no sum. */
static void test_action_and_reaction(void)
{
    static const char *const precision[] = {"precision=double", "precision=mixed"};
    for (int k = 0; k < 2; k++) {
        uint64_t seed = 5;
        double sum[2] = {0}, size = 0;
        rig_open(&rig,
                 "dp = 20 mm\nend_time = 9\nscheme = standard\n[domain]\nlower = -1, -1\nupper = "
                 "1, 1\n" WATER("-0.2, -0.2, 0.2, 0.2") LINE
                 "-0.1, 0.03; 0.02, 0; 0.06, 0.1\n"
                 "shape = polyline: 0.02, 0; 0.01, -0.1\n" FORCE,
                 precision[k], NULL);
        struct particles *const fluid = &rig.sim.particles[KIND_FLUID];
        for (int64_t i = 0; i < fluid->n; i++) {
            fluid->x[i] += 0.005 * noise(&seed);
            fluid->y[i] += 0.005 * noise(&seed);
            fluid->vx[i] = noise(&seed);
            fluid->vy[i] = noise(&seed);
            fluid->dens[i] = 0.01 + 0.01 * noise(&seed);
        }
        rig_sort(&rig);
        rig_evaluate(&rig);
        force_on(0, sum);
        for (int64_t i = 0; i < fluid->n; i++) {
            const double m = particle_mass(&rig.sim.fluid.k, fluid, i);
            sum[0] += m * fluid->ax[i];
            sum[1] += m * fluid->ay[i];
            size += m * hypot(fluid->ax[i], fluid->ay[i]);
        }
        for (int c = 0; c < 2; c++) assert_near((k ? 1e-6 : 1e-13) * size, 0, sum[c], precision[k]);
    }
}

/* T-111: dummies follow a wall as its other particles do, and hand over their force and moment. */
static void test_places_and_loads(void)
{
    rig_open(&rig,
             TOP WATER("-0.4, 0, 0.4, 0.4") TANK LINE
             "-0.05, 0.15; 0.05, 0.2; 0.05, 0.3\nmotion = m\n[motion m]\n"
             "centre = 0.1, 0.1\nturn = t*(0.5 + 2*t)\n",
             NULL);
    struct particles *const walls = &rig.sim.particles[KIND_WALL];
    const struct thin_line *const line = &rig.sim.fluid.lines.line[0];
    const struct motion_state motion = motion_at(&rig.scene, 0, 0.3);
    rig_run(&rig, 0.1);
    line_follow(&rig.sim.fluid.lines.line[0], &motion);
    line_place(&rig.sim.fluid.lines.line[0], walls, false);
    double sum[3] = {0}, load[6], handed[3] = {0};
    for (int64_t j = line->first; j < walls->n; j++) {
        const struct motion_point at = motion_of_point(&motion, walls->X[j], walls->Y[j]);
        assert_near(1e-12, at.x[0], walls->x[j], "x");
        assert_near(1e-12, at.x[1], walls->y[j], "y");
        assert_near(1e-12, at.v[0], walls->vx[j], "vx");
        assert_near(1e-12, at.v[1], walls->vy[j], "vy");
        assert_near(1e-11, at.a[0], walls->ax[j], "ax");
        assert_near(1e-11, at.a[1], walls->ay[j], "ay");
        sum[0] += walls->fx[j];
        sum[1] += walls->fy[j];
        sum[2] += walls->x[j] * walls->fy[j] - walls->y[j] * walls->fx[j];
    }
    TEST_ASSERT_EQUAL_INT64(walls->n - line->first, line->given->n_dummies);
    for (int64_t j = 0; j < line->given->n_dummies; j++) {
        line_at_ends(line, j, walls->fx[line->first + j], walls->fy[line->first + j], load);
        for (int last = 0; last < 2; last++) {
            const double *const f = load + 3 * last,
                                *const at = line->end[2 * line->given->dummy[j].part + last].x;
            handed[0] += f[0];
            handed[1] += f[1];
            handed[2] += f[2] + at[0] * f[1] - at[1] * f[0];
        }
    }
    for (int c = 0; c < 3; c++) assert_near(1e-9, sum[c], handed[c], "load");
    TEST_ASSERT_TRUE(fabs(sum[0]) > 1);
}

/* A side of the tank that is a thin line from the very end of the floor: none escapes below it. */
static void test_a_side_at_the_end_of_a_floor(void)
{
    static const char *const sides[] = {
        "[wall side]\nshape = polyline thickness 0: 0.4, 0; 0.4, 0.6\n",
        "[beam side]\nshape = polyline: 0.4, 0; 0.4, 0.6\nclamp = 0.4, 0\ndensity = 1200\n"
        "thickness = 4 mm\nyoung = 3e10\n"};
    for (int k = 0; k < 2; k++) {
        char text[1024];
        snprintf(text, sizeof text, "%s%s%s", TOP WATER("-0.4, 0, 0.4, 0.4"),
                 "[wall tank]\nshape = polyline: -0.4, 0.6; -0.4, 0; 0.4, 0\n", sides[k]);
        rig_open(&rig, text, NULL);
        rig_run(&rig, 0.3);
        for (int64_t i = 0; i < rig.sim.particles[KIND_FLUID].n; i++) {
            assert_at_most(0, -rig.sim.particles[KIND_FLUID].y[i], "depth");
            assert_at_most(k ? 0.41 : 0.4, rig.sim.particles[KIND_FLUID].x[i], "x"); /* it bends */
        }
        assert_at_most(0.005, rig.sim.state.gain_share, "gain");
    }
}

static void test_what_is_refused(void)
{
    rig_refuses(TOP "[fluid w]\nsound_speed = 20\nshape = polyline thickness 0: 0, 0; 1, 0\n",
                "the thickness must be at most 1e9 m, and 0 only in a `shape` of a [wall] or "
                "[rigid]");
    rig_refuses(TOP WATER("-0.4, 0, 0.4, 0.4") LINE
                "0, 0; 0, 0.2\n[solid s]\nshape = box 1, 0, 1.1, 0.1\ndensity = 1000\nyoung = 1 "
                "MPa\npoisson = 0.3\n",
                "this line of [wall line] has no thickness, so [solid s] cannot touch it; give it "
                "a thickness, or switch their contact off: [contact] between = s, line and "
                "enabled = off");
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_force_of_two_levels);
    RUN_TEST(test_water_at_rest);
    RUN_TEST(test_two_lines_that_meet);
    RUN_TEST(test_a_piston);
    RUN_TEST(test_a_line_slides_into_water);
    RUN_TEST(test_a_dam_break);
    RUN_TEST(test_a_tip_in_air);
    RUN_TEST(test_what_is_seen_past_a_tip);
    RUN_TEST(test_an_end_leaves_its_wall);
    RUN_TEST(test_action_and_reaction);
    RUN_TEST(test_places_and_loads);
    RUN_TEST(test_a_side_at_the_end_of_a_floor);
    RUN_TEST(test_what_is_refused);
    return UNITY_END();
}
