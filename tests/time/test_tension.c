/* SPDX-License-Identifier: MIT
 * Drops of a few particles, which tension would bind to each other for ever (T-45). */
#include "time/advance.h"

#include "output/checkpoint.h"
#include "time/energy.h"
#include "rig.h"
#include "unity.h"

#include <math.h>
#include <string.h>

/* A block of water, three particles apart from it, and three more beside a wall. */
static const char scene[] =
    "dp = 1 mm\nend_time = 1\n"
    "[fluid water]\nshape = box 0, 0, 20 mm, 20 mm\nshape = box 40 mm, 40 mm, 43 mm, 41 mm\n"
    "shape = box 60 mm, 0, 63 mm, 1 mm\nsound_speed = 28\nartificial_viscosity = 0.03\n"
    "density_diffusion = 0.1\n[wall floor]\nshape = box 55 mm, -4 mm, 68 mm, 0\n"
    "[domain]\nlower = -20 mm, -20 mm\nupper = 100 mm, 100 mm\n";

static struct rig rig;
static struct particles *fluid;

void setUp(void)
{
    rig_open(&rig, scene, NULL);
    fluid = &rig.sim.particles[KIND_FLUID];
}

void tearDown(void) { rig_close(&rig); }

static int64_t at(double x, double y)
{
    for (int64_t i = 0; i < fluid->n; i++)
        if (hypot(fluid->x[i] - x, fluid->y[i] - y) < 1e-6) return i;
    TEST_FAIL_MESSAGE("no particle there");
    return -1;
}

static double after(int64_t i, double dens)
{
    fluid->dens[i] = dens;
    update_extremes(&rig.sim);
    limit_isolated_tension(&rig.sim);
    return fluid->dens[i];
}

/* The kernel reaches over 22 particles within the fluid; a third of that, 7, and less are a
 * drop. */
static void test_which_particles_are_isolated(void)
{
    const int64_t drop = at(41.5e-3, 40.5e-3);
    TEST_ASSERT_EQUAL_INT(3, simulation_count_near(&rig.sim, fluid->x[drop], fluid->y[drop],
                                                   KIND_COUNT));
    assert_near(0, 0, after(drop, -0.2), "in a drop");
    assert_near(0, -0.09, after(drop, -0.09), "in a drop, little tension");
    assert_near(0, 0.2, after(drop, 0.2), "in a drop, pressure");
    assert_near(0, -0.2, after(at(10.5e-3, 10.5e-3), -0.2), "within the fluid");
    assert_near(0, -0.2, after(at(0.5e-3, 0.5e-3), -0.2), "in a corner of it");
    assert_near(0, -0.2, after(at(61.5e-3, 0.5e-3), -0.2), "beside a wall");
}

static void test_verlet_forgets_as_well(void)
{
    rig_open(&rig, scene, "integrator=verlet", NULL);
    fluid = &rig.sim.particles[KIND_FLUID];
    const int64_t drop = at(41.5e-3, 40.5e-3);
    fluid->dens_old[drop] = -0.19;
    assert_near(0, 0, after(drop, -0.2), "dens");
    assert_near(0, 0, fluid->dens_old[drop], "dens of the previous step");
}

/* By leapfrog the rates that made it sink are forgotten: the next step does not go on with them. */
static void test_leapfrog_forgets_its_rates(void)
{
    rig_open(&rig, scene, "integrator=leapfrog", NULL);
    fluid = &rig.sim.particles[KIND_FLUID];
    rig_steps(&rig, 6, 1);
    const int64_t drop = at(41.5e-3, 40.5e-3);
    fluid->ddens_old[drop] = fluid->ddens_older[drop] = -500;
    assert_near(0, 0, after(drop, -0.2), "dens");
    rig_steps(&rig, 1, 1);
    assert_near(1e-6, 0, fluid->dens[drop], "a step on");
    TEST_ASSERT_EQUAL_INT64(1, rig.sim.state.tension_limited);
}

/* A water hammer at the speed that c0 is chosen for: with sound_factor = 20 a twentieth; with
 * 5 and less a fifth, which the guard leaves. */
static void test_limit_follows_the_sound_factor(void)
{
    static const struct {
        const char *factor;
        double above, below;
    } row[] = {{"numerics.sound_factor=40", -0.0249, -0.0251},
               {"numerics.sound_factor=20", -0.0499, -0.0501},
               {"numerics.sound_factor=10", -0.099, -0.101},
               {"numerics.sound_factor=5", -0.199, -0.201},
               {"numerics.sound_factor=4", -0.199, -0.201}};
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        rig_open(&rig, scene, row[k].factor, "water.sound_speed=0", "water.max_speed=1", NULL);
        fluid = &rig.sim.particles[KIND_FLUID];
        const int64_t drop = at(41.5e-3, 40.5e-3);
        assert_near(0, row[k].above, after(drop, row[k].above), row[k].factor);
        assert_near(0, 0, after(drop, row[k].below), row[k].factor);
    }
}

/* Three particles as a splash in the sluice gate's tank left them at 1.35 s: on top of each
 * other, each on its way around the others. Their density sank until a guard stopped the run at
 * 1.41 s. */
static void test_a_clump_does_not_end_a_run(void)
{
    static const double place[3][2] = {{3.6e-6, 19.3e-6}, {0.7e-6, 17.6e-6}, {-4.3e-6, -36.9e-6}};
    static const double speed[3][2] = {{-0.475, 0.098}, {-0.444, 0.019}, {0.919, -0.117}};
    for (int k = 0; k < 3; k++) {
        const int64_t i = at((40.5 + k) * 1e-3, 40.5e-3);
        fluid->x[i] = 41.5e-3 + place[k][0];
        fluid->y[i] = 40.5e-3 + place[k][1];
        fluid->vx[i] = fluid->vx_half[i] = speed[k][0];
        fluid->vy[i] = fluid->vy_half[i] = speed[k][1];
        fluid->dens[i] = -0.174;
    }
    rig_sort(&rig);
    rig_run(&rig, 0.2);
    TEST_ASSERT_TRUE(rig.sim.extremes.dens_low > -0.1);
}

/* Three particles that fly apart, so that their density sinks until it is reset. */
static void open_drop(const char *integrator, const char *cfl)
{
    rig_open(&rig, scene, integrator, cfl, NULL);
    fluid = &rig.sim.particles[KIND_FLUID];
    for (int k = 0; k < 3; k++) {
        const int64_t i = at((40.5 + k) * 1e-3, 40.5e-3);
        fluid->vx[i] = 6.0 * (k - 1);
        if (fluid->vx_half) fluid->vx_half[i] = fluid->vx[i];
        fluid->dens[i] = -0.08;
    }
    simulation_refresh(&rig.sim);
    energy_begin(&rig.sim);
}

/* The run, cut after so many steps, and what a restart makes of it 30 steps later. */
static void assert_same_after_restart(const char *integrator, int cut)
{
    struct simulation again;
    struct checkpoint image = {0};
    open_drop(integrator, "numerics.cfl=0.05");
    rig_steps(&rig, cut, 1);
    TEST_ASSERT_EQUAL_INT(ERR_OK, simulation_create(&again, &rig.scene, &rig.diag));
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_capture(&image, &rig.sim, "", "1", &rig.diag));
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, checkpoint_apply(&image, &again, &rig.diag),
                                  rig.diag.text);
    for (int k = 0; k < 30; k++) {
        TEST_ASSERT_EQUAL_INT(ERR_OK, simulation_step(&rig.sim, 1, &rig.diag));
        TEST_ASSERT_EQUAL_INT(ERR_OK, simulation_step(&again, 1, &rig.diag));
    }
    const struct ledger whole = simulation_ledger(&rig.sim), later = simulation_ledger(&again);
    TEST_ASSERT_TRUE(rig.sim.state.tension_limited >= 3);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&rig.sim.state.energy, &again.state.energy,
                                     sizeof again.state.energy, integrator);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&whole, &later, sizeof later, integrator);
    TEST_ASSERT_TRUE_MESSAGE(simulation_hash(&rig.sim) == simulation_hash(&again), integrator);
    simulation_free(&again);
    checkpoint_free(&image);
}

/* Cut before a reset, just after it, where the density is zero and its old rates are
 * forgotten, and a step later: the same bits of state, account and ledger. */
static void test_restart_at_a_reset(void)
{
    static const char *const integrators[] = {"integrator=leapfrog", "integrator=symplectic",
                                              "integrator=verlet"};
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        int first = 0, last = 0;
        open_drop(integrators[k], "numerics.cfl=0.05");
        for (int n = 1; rig.sim.state.tension_limited < 3; n++) {
            rig_steps(&rig, 1, 1);
            if (!first && rig.sim.state.tension_limited > 0) first = n;
            last = n;
        }
        TEST_ASSERT_TRUE(first > 1 && last < first + 25);
        printf("%s: resets after steps %d to %d\n", integrators[k], first, last);
        for (int cut = first - 1; cut <= first + 1; cut++)
            assert_same_after_restart(integrators[k], cut);
        assert_same_after_restart(integrators[k], last);
    }
}

int main(void)
{
    UNITY_BEGIN();
    rig_one_thread();
    RUN_TEST(test_which_particles_are_isolated);
    RUN_TEST(test_verlet_forgets_as_well);
    RUN_TEST(test_leapfrog_forgets_its_rates);
    RUN_TEST(test_limit_follows_the_sound_factor);
    RUN_TEST(test_a_clump_does_not_end_a_run);
    RUN_TEST(test_restart_at_a_reset);
    return UNITY_END();
}
