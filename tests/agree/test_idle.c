/* SPDX-License-Identifier: MIT
 * Work only where something happens: leaving dry and resting walls alone changes no bit. A dam
 * breaks behind a plate that is lifted and stops; another wall starts later; a gate stands far from
 * the water. */
#include "rig.h"
#include "unity.h"

#include <stdio.h>

static const char scene[] =
    "dp = 5 mm\nend_time = 1\ngravity = 0, -9.81\n[numerics]\nskin = 0.02\n"
    "[fluid water]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\nsurface = 0.1\n"
    "artificial_viscosity = 0.05\ndensity_diffusion = 0.1\n"
    "[wall tank]\nshape = polyline thickness -0.02: 0, 0.2; 0, 0; 0.6, 0; 0.6, 0.2\n"
    "[wall plate]\nshape = box 0.1, 0, 0.12, 0.15\nmotion = lift\n"
    "[wall late]\nshape = box 0.15, 0.2, 0.2, 0.22\nmotion = drop\n"
    "[motion lift]\ny = 3*t\nstop = 0.02\n"
    "[motion drop]\nx = 0.5*t\ny = -3*t\nstart = 0.03\nstop = 0.05\n"
    "[solid gate]\nshape = box 0.4, 0, 0.42, 0.15\nclamp = box 0.4, 0.13, 0.42, 0.15\n"
    "density = 1100\nyoung = 4e6\npoisson = 0.4\n";

static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

static uint64_t run(bool never_skip, const char *integrator, double time)
{
    rig_switches.never_skip = never_skip;
    rig_open(&rig, scene, integrator, NULL);
    rig_switches.never_skip = false;
    rig_run(&rig, time);
    return simulation_hash(&rig.sim);
}

static void compare(const char *integrator)
{
    const double times[] = {0.025, 0.055};
    for (int k = 0; k < 2; k++) {
        const uint64_t skipped = run(false, integrator, times[k]);
        const struct cell_list *const walls = &rig.sim.cells.list[KIND_WALL];
        TEST_ASSERT_TRUE(2 * rig.sim.fluid.n_near_fluid[KIND_WALL] < walls->n_active);
        TEST_ASSERT_TRUE(rig.sim.state.sorts > 10);
        const uint64_t worked = run(true, integrator, times[k]);
        TEST_ASSERT_EQUAL_INT32(walls->n_active, rig.sim.fluid.n_near_fluid[KIND_WALL]);
        TEST_ASSERT_EQUAL_HEX64(worked, skipped);
    }
}

static void test_symplectic(void) { compare("integrator=symplectic"); }

static void test_verlet(void) { compare("integrator=verlet"); }

/* Every wall particle is in the list once, in its cell, while one wall moves and after. */
static void test_walls_are_all_listed(void)
{
    rig_open(&rig, scene, NULL);
    for (int k = 0; k < 30; k++) {
        rig_steps(&rig, 10, 1);
        const struct cell_list *const list = &rig.sim.cells.list[KIND_WALL];
        const struct particles *const particles = &rig.sim.particles[KIND_WALL];
        int64_t seen = 0;
        for (int32_t m = 0; m < list->n_active; m++) {
            const int32_t cell = list->active[m];
            for (int32_t j = list->start[cell]; j < list->start[cell] + list->count[cell]; j++) {
                TEST_ASSERT_EQUAL_INT32(cell, particles->cell[list->order[j]]);
                seen++;
            }
        }
        TEST_ASSERT_EQUAL_INT64(particles->n, seen);
    }
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_symplectic);
    RUN_TEST(test_verlet);
    RUN_TEST(test_walls_are_all_listed);
    return UNITY_END();
}
