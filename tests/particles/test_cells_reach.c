/* SPDX-License-Identifier: MIT
 * A sorting is called outgrown before any pair within reach leaves the cells that are searched. It
 * is not while all the fluid travels together. */
#include "rig.h"
#include "particles/kernel.h"
#include "unity.h"

#include <math.h>
#include <string.h>

static const char tank[] =
    "dp = 1 cm\nend_time = 10\nprecision = double\n[numerics]\nskin = 1\n"
    "[domain]\nlower = -1, -1\nupper = 1, 1\n[fluid w]\nshape = box -0.3, -0.3, 0.3, 0.3\n"
    "sound_speed = 20\n[wall bed]\nshape = box -0.3, -0.36, 0.3, -0.32\n"
    "[solid beam]\nshape = box 0.32, -0.3, 0.36, 0.3\ndensity = 1e3\nyoung = 1e6\npoisson = 0.3\n";

static struct rig rig;

void setUp(void) { rig_open(&rig, tank, NULL); }
void tearDown(void) { rig_close(&rig); }

static bool outgrown(void)
{
    for (int kind = 0; kind < KIND_COUNT; kind++)
        cells_measure_overhang(&rig.sim.cells, (enum kind)kind, &rig.sim.particles[kind]);
    return !(cells_skin_left(&rig.sim.cells, KERNEL_REACH * rig.sim.fluid.k.h) > 0);
}

/* Particles by squares of the size of the reach, without the cells under test. */
enum { SQUARES = 64 };
struct squares {
    int first[KIND_COUNT][SQUARES * SQUARES];
    int next[KIND_COUNT][8192];
};

static int square_of(double x, double reach)
{
    const double at = (x + 1.3) / reach;
    TEST_ASSERT_TRUE(at >= 1 && at < SQUARES - 1);
    return (int)at;
}

static void fill_squares(struct squares *q, double reach)
{
    memset(q->first, -1, sizeof q->first);
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const struct particles *const particles = &rig.sim.particles[kind];
        TEST_ASSERT_TRUE(particles->n <= 8192);
        for (int i = 0; i < (int)particles->n; i++) {
            int *const first = &q->first[kind][square_of(particles->y[i], reach) * SQUARES +
                                               square_of(particles->x[i], reach)];
            q->next[kind][i] = *first;
            *first = i;
        }
    }
}

/* Whether fluid particle i has a particle of the kind within reach in a cell that does not touch
 * its own. */
static bool unseen_by(const struct squares *q, int64_t i, int kind, double side, double reach)
{
    const struct cells *const cells = &rig.sim.cells;
    const struct particles *const a = &rig.sim.particles[KIND_FLUID], *const b =
                                                                          &rig.sim.particles[kind];
    const int at = square_of(a->y[i], side) * SQUARES + square_of(a->x[i], side);
    for (int k = 0; k < 9; k++)
        for (int j = q->first[kind][at + (k / 3 - 1) * SQUARES + k % 3 - 1]; j >= 0;
             j = q->next[kind][j]) {
            const int dx = cell_x(cells, a->cell[i]) - cell_x(cells, b->cell[j]);
            const int dy = cell_y(cells, a->cell[i]) - cell_y(cells, b->cell[j]);
            if (dx * dx <= 1 && dy * dy <= 1) continue;
            if (hypot(a->x[i] - b->x[j], a->y[i] - b->y[j]) < reach) return true;
        }
    return false;
}

/* Whether some fluid particle has any other within reach in a cell that does not touch its own. */
static bool pair_unseen(void)
{
    static struct squares squares;
    const double reach = KERNEL_REACH * rig.sim.fluid.k.h;
    const double side = reach > 0.045 ? reach : 0.045; /* so that they cover the domain */
    fill_squares(&squares, side);
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int64_t i = 0; i < rig.sim.particles[KIND_FLUID].n; i++)
            if (unseen_by(&squares, i, kind, side, reach)) return true;
    return false;
}

/* Particles wander at random until the sorting is called outgrown: up to then nothing is unseen,
 * and going on without sorting something is soon. */
static void test_no_pair_is_unseen(void)
{
    uint64_t seed = 5;
    int unseen_after = 0;
    for (int trial = 0; trial < 8; trial++) {
        rig_open(&rig, tank, NULL);
        const double step = 0.002 * (1 + trial % 4);
        int steps = 0;
        for (; steps < 200; steps++) {
            for (int kind = 0; kind < KIND_COUNT; kind += 2) /* fluid and solid */
                for (int64_t i = 0; i < rig.sim.particles[kind].n; i++) {
                    rig.sim.particles[kind].x[i] += step * noise(&seed);
                    rig.sim.particles[kind].y[i] += step * noise(&seed);
                }
            if (outgrown()) break;
            TEST_ASSERT_FALSE(pair_unseen());
        }
        TEST_ASSERT_TRUE(steps > 0 && steps < 200);
        for (int more = 0; more < 3 * steps + 3 && !pair_unseen(); more++)
            for (int64_t i = 0; i < rig.sim.particles[KIND_FLUID].n; i++)
                rig.sim.particles[KIND_FLUID].x[i] += step * noise(&seed);
        unseen_after += pair_unseen();
    }
    TEST_ASSERT_TRUE(unseen_after >= 4);
}

/* Fluid alone that moves as one: nothing to be done until it strays too far. */
static void test_common_motion_is_free(void)
{
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\n[domain]\nlower = -1, -1\nupper = 1, 1\n"
             "[fluid w]\nshape = box -0.3, -0.3, 0.3, 0.3\nsound_speed = 20\n",
             NULL);
    const double stray = rig.sim.cells.skin, h = rig.sim.fluid.k.h;
    assert_near(1e-12,
                min2(rig.sim.scene->numerics.skin * h,
                     0.5 * (rig.sim.cells.side[0] - KERNEL_REACH * h)),
                stray, "stray");
    struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    double way = 0;
    while (!outgrown() && way < 10 * stray) {
        for (int64_t i = 0; i < particles->n; i++) particles->x[i] += 0.1 * stray;
        way += 0.1 * stray;
    }
    TEST_ASSERT_TRUE(way >= stray);
    assert_at_most(1.1 * stray + rig.sim.scene->top.dp, way, "way gone");
    TEST_ASSERT_FALSE(pair_unseen());
}

/* Two blobs that jump towards each other over more than a cell. */
static void test_leap_is_noticed(void)
{
    struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    TEST_ASSERT_FALSE(outgrown());
    for (int64_t i = 0; i < particles->n; i++)
        if (particles->x[i] < -0.2) particles->x[i] += 0.4;
    TEST_ASSERT_TRUE(outgrown());
}

/* A block that falls at a still tank: it comes over a whole cell towards fluid that hardly moves.
 */
static const char falling[] =
    "dp = 1 cm\nend_time = 10\nprecision = double\ngravity = 0, -9.81\n"
    "[domain]\nlower = -0.3, -0.3\nupper = 0.3, 0.7\n"
    "[fluid w]\nshape = box -0.2, -0.15, 0.2, 0\nsound_speed = 20\nsurface = 0\n"
    "artificial_viscosity = 0.05\ndensity_diffusion = 0.1\n"
    "[wall tank]\nshape = polyline thickness -0.04: -0.2, 0.6; -0.2, -0.15; 0.2, -0.15; 0.2, 0.6\n"
    "[solid beam]\nshape = box -0.05, 0.1, 0.05, 0.2\ndensity = 1500\nyoung = 1 MPa\n"
    "poisson = 0.35\nvelocity = 0, -3\n";

/* The skin that is left after each step against what measuring finds; and the same scene with a
 * measuring at each step, which must sort when this one does and end with its bits. */
static void check_room(const char *scene, const char *integrator, const char *more, int steps,
                       int least_unmeasured)
{
    struct simulation *const sim = &rig.sim;
    uint64_t hash[2];
    int64_t sorts[2];
    for (int measured = 0; measured < 2; measured++) {
        rig_open(&rig, scene, integrator, more, "beam.artificial_viscosity=0.05", "gravity=0, -10",
                 "numerics.skin=0.15", NULL);
        int unmeasured = 0;
        for (int step = 0; step < steps; step++) {
            if (measured) sim->sorting.skin_left = 0;
            rig_steps(&rig, 1, 10);
            if (measured) continue;
            const double left = sim->sorting.skin_left;
            for (int kind = 0; kind < KIND_COUNT; kind++)
                cells_measure_overhang(&sim->cells, (enum kind)kind, &sim->particles[kind]);
            const double found = cells_skin_left(&sim->cells, KERNEL_REACH * sim->fluid.k.h);
            assert_at_most(found + 1e-12, left, "skin left");
            const bool looks = step % 20 == 0;
            TEST_ASSERT_FALSE(looks && pair_unseen());
            unmeasured += left < found - 1e-12;
        }
        if (!measured) assert_at_most(unmeasured, least_unmeasured, "steps without measuring");
        hash[measured] = simulation_hash(sim);
        sorts[measured] = sim->state.sorts;
    }
    TEST_ASSERT_EQUAL_INT64(sorts[1], sorts[0]);
    TEST_ASSERT_EQUAL_HEX64(hash[1], hash[0]);
    TEST_ASSERT_TRUE(sorts[0] > 1);
}

/* Cells are not measured while no particle can have gone far enough: what is taken off their skin
 * is never less than what is found by measuring them. (With symplectic they always are.) */
static void test_skin_left_is_never_overstated(void)
{
    check_room(tank, "integrator=leapfrog", "dp=2cm", 600, 100);
    check_room(tank, "integrator=leapfrog", "w.shifting=2", 200, 20);
    check_room(tank, "integrator=verlet", "dp=2cm", 600, 100);
    check_room(falling, "integrator=verlet", "numerics.multirate=off", 300, 20);
    check_room(falling, "integrator=leapfrog", "dp=1cm", 150, 20);
    check_room(falling, "integrator=verlet", "dp=1cm", 150, 20);
}

/* Whether any pair was unseen when the rates were found: at the middle of a step, too. */
static bool missed;
static int evaluations;

static void look(void *context, double time, const struct particles *particles, double *ax,
                 double *ay)
{
    (void)context, (void)time, (void)particles, (void)ax, (void)ay;
    missed |= pair_unseen();
    evaluations++;
}

/* A drop and another, or a solid, fly at each other over the cell in the middle, and leave their
 * own cells at the same time. The predictor of symplectic is half a step ahead of the state whose
 * cells were measured. */
static void check_midpoints(const char *scene, enum kind kind, bool upright)
{
    for (int k = 0; k < 10; k++) {
        rig_open(&rig, scene, NULL);
        TEST_ASSERT_TRUE(rig.sim.cells.nx % 2 && rig.sim.cells.ny % 2);
        missed = false;
        evaluations = 0;
        TEST_ASSERT_EQUAL_INT(ERR_OK, simulation_set_force_hook(&rig.sim, KIND_FLUID, look, NULL,
                                                                &rig.diag));
        struct particles *const a = &rig.sim.particles[KIND_FLUID], *const b =
                                                                        &rig.sim.particles[kind];
        double *const from = upright ? a->y : a->x, *const to = upright ? b->y : b->x,
                      *const moved = upright ? b->uy : b->ux;
        int64_t facing = b->n - 1;
        const double shift = 0.0001 * k; /* some come within reach in the first half of a step */
        from[0] -= shift;
        for (int64_t i = kind == KIND_FLUID; i < b->n; i++) {
            to[i] += shift;
            if (kind == KIND_SOLID) moved[i] += shift;
            if (to[i] < to[facing]) facing = i;
        }
        assert_near(1e-12, -from[0], to[facing], "place");
        while (to[facing] - from[0] > 0.5 * KERNEL_REACH * rig.sim.fluid.k.h)
            rig_steps(&rig, 1, 10);
        TEST_ASSERT_EQUAL_INT64(2 * rig.sim.state.steps, evaluations);
        TEST_ASSERT_FALSE(missed);
    }
}

#define DROPS                                                                  \
    "dp = 1 cm\nend_time = 1\nintegrator = symplectic\n[numerics]\nskin = 1\n" \
    "[domain]\nlower = -0.3, -0.3\nupper = 0.3, 0.3\n[fluid a]\nsound_speed = 20\n"
#define BLOCK "[solid b]\ndensity = 1000\nyoung = 1e5\npoisson = 0.3\n"

static void test_no_pair_is_unseen_at_the_midpoint(void)
{
    check_midpoints(DROPS "shape = box -0.11, 0, -0.1, 0.01\nvelocity = 5, 0\n"
                          "[fluid b]\nlike = a\nshape = box 0.1, 0, 0.11, 0.01\nvelocity = -5, 0\n",
                    KIND_FLUID, false);
    check_midpoints(DROPS "shape = box 0, -0.11, 0.01, -0.1\nvelocity = 0, 5\n"
                          "[fluid b]\nlike = a\nshape = box 0, 0.1, 0.01, 0.11\nvelocity = 0, -5\n",
                    KIND_FLUID, true);
    check_midpoints(DROPS "shape = box -0.11, 0, -0.1, 0.01\nvelocity = 5, 0\n" BLOCK
                          "shape = box 0.1, 0, 0.12, 0.02\nvelocity = -5, 0\n",
                    KIND_SOLID, false);
    check_midpoints(DROPS "shape = box 0, -0.11, 0.01, -0.1\nvelocity = 0, 5\n" BLOCK
                          "shape = box 0, 0.1, 0.02, 0.12\nvelocity = 0, -5\n",
                    KIND_SOLID, true);
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_no_pair_is_unseen);
    RUN_TEST(test_common_motion_is_free);
    RUN_TEST(test_leap_is_noticed);
    RUN_TEST(test_skin_left_is_never_overstated);
    RUN_TEST(test_no_pair_is_unseen_at_the_midpoint);
    return UNITY_END();
}
