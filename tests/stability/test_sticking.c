/* SPDX-License-Identifier: MIT
 * A body that sticks to a viscous fluid, with sub-steps (T-35g). */
#include <math.h>

#include "rig.h"
#include "unity.h"

/* A free cylinder of the fluid's density between walls that shear the fluid. */
static const char shear[] =
    "dp = 1 mm\nend_time = 1\n[constants]\nR = 6 mm\n[fluid oil]\n"
    "shape = box -20 mm, -15 mm, 20 mm, 15 mm\nminus = circle 0, 0, R\nmax_speed = 0.1\n"
    "laminar_viscosity = 1e-3\nvelocity = 2*y, 0\npressure = 20\n"
    "[wall top]\nshape = box -20 mm, 15 mm, 20 mm, 19 mm\nslip = none\nmotion = right\n"
    "[wall bottom]\nshape = box -20 mm, -19 mm, 20 mm, -15 mm\nslip = none\nmotion = left\n"
    "[motion right]\nx = 30 mm/s*t\n[motion left]\nx = -30 mm/s*t\n"
    "[solid cyl]\nshape = circle 0, 0, R\ndensity = 1000\nyoung = 200 kPa\npoisson = 0.3\nslip = "
    "none\n"
    "[contact none]\nenabled = off\n[domain]\nlower = -20 mm, -25 mm\nupper = 20 mm, 25 mm\n"
    "periodic = x\n";

static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

static void moves_with_the_fluid(const char *set)
{
    rig_open(&rig, shear, set, NULL);
    TEST_ASSERT_TRUE(rig.sim.effects & FX_MULTIRATE);
    rig_run(&rig, 0.1);
    TEST_ASSERT_TRUE(rig.sim.substeps > 1);
    const struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++)
        TEST_ASSERT_TRUE(hypot(particles->vx[i], particles->vy[i]) < 0.03);
}

static void test_a_free_cylinder(void) { moves_with_the_fluid(NULL); }

static void test_a_finer_one(void) { moves_with_the_fluid("cyl.dp=0.5 mm"); }

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_free_cylinder);
    RUN_TEST(test_a_finer_one);
    return UNITY_END();
}
