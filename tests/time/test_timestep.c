/* SPDX-License-Identifier: MIT
 * The time step: its bounds by hand, output times hit exactly, sub-steps, and that the solid's
 * bound is the one that matters: stable below, unstable above. */
#include "check/check.h"
#include "rig.h"
#include "coupling/coupling.h"
#include "time/energy.h"
#include "time/timestep.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

static const char gate[] =
    "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n"
    "[fluid water]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\nsurface = 0.1\n"
    "artificial_viscosity = 0.05\ndensity_diffusion = 0.1\n"
    "[wall tank]\nshape = polyline thickness -0.03: 0, 0.2; 0, 0; 0.4, 0\n"
    "[solid gate]\nshape = box 0.1, 0, 0.13, 0.15\nclamp = box 0.1, 0.12, 0.13, 0.15\n"
    "density = 1100\nyoung = 4e6\npoisson = 0.4\n";
static const char block[] = "dp = 1 cm\nend_time = 1\n"
                            "[solid block]\nshape = box 0, 0, 0.04, 0.1\n"
                            "density = 1200\nyoung = 2e7\npoisson = 0.4\n";

static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

/* Eq. 28 with numbers put in: h = 0.0135 m, c0 = 20 m/s, cfl = 0.2, |a|^2 = 10000, approach 5 m/s:
 *   28a: 0.2 sqrt(0.0135/100) = 2.32379000772445e-3 s
 *   28b: 0.2 * 0.0135/25 = 1.08e-4 s; at rest 0.2 * 0.0135/20 = 1.35e-4 s. */
static void test_bounds_by_hand(void)
{
    rig_open(&rig, gate, "numerics.multirate=off", "integrator=symplectic", NULL);
    bool hits;
    rig.sim.fluid.extremes = (struct rate_extremes){10000, 5};
    rig.sim.dt_solid = 1;
    assert_near(1e-16, 1.08e-4, timestep_choose(&rig.sim, 10, &hits), "dt");
    TEST_ASSERT_FALSE(hits);
    assert_near(1e-15, 2.32379000772445e-3, rig.sim.dt_bound[BOUND_force], "Eq. 28a");
    assert_near(1e-18, 1.08e-4, rig.sim.dt_bound[BOUND_acoustic], "Eq. 28b");
    assert_near(1e-18, 1.35e-4, timestep_fluid_limit(&rig.sim), "Eq. 28b at rest");
    rig.sim.fluid.extremes = (struct rate_extremes){1e16, 5};
    assert_near(1e-15, 0.2 * sqrt(0.0135 / 1e8), timestep_choose(&rig.sim, 10, &hits),
                "force binds");
    rig.sim.dt_solid = 1e-7;
    TEST_ASSERT_TRUE(timestep_choose(&rig.sim, 10, &hits) == 1e-7);
    rig.sim.effects |= FX_MULTIRATE;
    assert_near(1e-15, 0.2 * sqrt(0.0135 / 1e8), timestep_choose(&rig.sim, 10, &hits),
                "the solid does not bind with sub-steps");
}

/* A sliver at the end is shared: within two steps of the limit both are equal. */
static void pull_down(void *context, double time, const struct particles *particles, double *ax,
                      double *ay)
{
    (void)context, (void)time, (void)ax;
    for (int64_t i = 0; i < particles->n; i++) ay[i] = -30;
}

/* A program's acceleration counts together with gravity: 40 m/s^2 in Eq. 28a. */
static void test_bound_with_a_push(void)
{
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\ngravity = 0, -10\n[domain]\nlower = -1, -1\nupper = 1, 1\n"
             "[fluid w]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\n",
             NULL);
    TEST_ASSERT_EQUAL_INT(ERR_OK, simulation_set_force_hook(&rig.sim, KIND_FLUID, pull_down, NULL,
                                                            &rig.diag));
    rig_steps(&rig, 1, 1);
    assert_near(1e-9, 1600, rig.sim.fluid.extremes.acceleration2, "|a|^2");
}

static void test_the_last_two_steps_before_a_limit_are_equal(void)
{
    rig_open(&rig, gate, "numerics.fixed_step=1e-4", NULL);
    bool hits;
    TEST_ASSERT_TRUE(timestep_choose(&rig.sim, INFINITY, &hits) == 1e-4);
    TEST_ASSERT_FALSE(hits);
    TEST_ASSERT_TRUE(timestep_choose(&rig.sim, 2.5e-4, &hits) == 1e-4);
    TEST_ASSERT_FALSE(hits);
    TEST_ASSERT_TRUE(timestep_choose(&rig.sim, 1, &hits) == 1e-4);
    TEST_ASSERT_FALSE(hits);
    assert_near(1e-18, 0.75e-4, timestep_choose(&rig.sim, 1.5e-4, &hits), "half of what is left");
    TEST_ASSERT_FALSE(hits);
    TEST_ASSERT_TRUE(timestep_choose(&rig.sim, 0.9e-4, &hits) == 0.9e-4);
    TEST_ASSERT_TRUE(hits);
    TEST_ASSERT_TRUE(timestep_choose(&rig.sim, 1e-4, &hits) == 1e-4);
    TEST_ASSERT_TRUE(hits);
}

/* Of the longest step so far; shorter ones and a longer bound of the solid do not change them. */
static void test_substeps_cover_the_longest_step(void)
{
    static const struct {
        double dt;
        int n;
    } row[] = {{0.3e-5, 1}, {1e-5, 1}, {1.0001e-5, 2}, {13.5e-5, 14}, {2e-5, 14}, {14.5e-5, 15}};
    rig_open(&rig, gate, "numerics.multirate=on", NULL);
    rig.sim.dt_solid = 1e-5;
    rig.sim.solid.damping_max = 0;
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        TEST_ASSERT_EQUAL_INT(row[k].n, timestep_substeps(&rig.sim, row[k].dt));
        rig.sim.state.dt_max = fmax(rig.sim.state.dt_max, row[k].dt);
    }
    /* A step that has been taken counts whatever viscosity there is. */
    rig.sim.solid.damping_max = 1e9;
    rig.sim.state.time = 1;
    TEST_ASSERT_EQUAL_INT(15, timestep_substeps(&rig.sim, 1e-5));
    rig.sim.effects &= ~(effect_set)FX_MULTIRATE;
    TEST_ASSERT_EQUAL_INT(1, timestep_substeps(&rig.sim, 13.5e-5));
}

/* Sub-steps are chosen where the solid's step is the smaller, and only there. */
static void test_multirate_auto(void)
{
    rig_open(&rig, gate, NULL);
    TEST_ASSERT_TRUE(rig.sim.dt_solid < timestep_fluid_limit(&rig.sim));
    TEST_ASSERT_TRUE(rig.sim.effects & FX_MULTIRATE);
    rig_steps(&rig, 10, 1);
    TEST_ASSERT_TRUE(rig.sim.substeps > 1);
    TEST_ASSERT_TRUE(rig.sim.state.dt <= rig.sim.substeps * rig.sim.dt_solid);
    rig_open(&rig, gate, "gate.young=1e4", NULL);
    TEST_ASSERT_FALSE(rig.sim.effects & FX_MULTIRATE);
    rig_steps(&rig, 10, 1);
    TEST_ASSERT_EQUAL_INT64(rig.sim.state.steps, rig.sim.state.solid_substeps);
}

/* A bound belongs to its effect. With M = 0.98283048 of L-1, summed over the lattice,
 * nu = 1e-2 m^2/s allows 0.125 * 0.0135^2 M/0.01 s; no viscosity allows anything. */
static void test_viscous_bound_by_hand(void)
{
    bool hits;
    rig_open(&rig, gate, NULL);
    timestep_choose(&rig.sim, 10, &hits);
    TEST_ASSERT_TRUE(isinf(rig.sim.dt_bound[BOUND_viscous]));
    rig_open(&rig, gate, "water.laminar_viscosity=1e-2", NULL);
    timestep_choose(&rig.sim, 10, &hits);
    assert_near(1e-15, 2.2390106890714137e-3, rig.sim.dt_bound[BOUND_viscous], "0.125 M h^2/nu");
    rig_open(&rig, gate, "water.laminar_viscosity=10", NULL);
    assert_near(1e-18, 2.239010689071414e-6, timestep_fluid_limit(&rig.sim), "largest step");
    /* T-35g, a quarter of 0.9/gamma: 0.225 * 0.0135^2 M/(8.6 * 1e-2) s at the fluid's density. */
    rig_open(&rig, gate, "water.laminar_viscosity=1e-2", "gate.slip=none", "gate.density=1000",
             NULL);
    timestep_choose(&rig.sim, 10, &hits);
    assert_near(1e-15, 4.6863014422424945e-4, rig.sim.dt_bound[BOUND_viscous], "sticking");
}

/* T-33c at rest: 0.4 * 0.0135/(1.4142135623730951 * 20) s. */
static void test_damper_bound_by_hand(void)
{
    bool hits;
    rig_open(&rig, gate, "water.acoustic_damper=4", NULL);
    timestep_choose(&rig.sim, 10, &hits);
    assert_near(1e-17, 1.9091883092036783e-4, rig.sim.dt_bound[BOUND_damper], "0.4 h/(1.41 c0)");
}

/* T-33b, h/c0 = 0.0135/20 s: leapfrog 0.9 (6/11)/(6.5 * 0.5) and 0.9/(2.3 * 2) of it. */
static void test_decay_bounds_by_hand(void)
{
    bool hits;
    rig_open(&rig, gate, "water.density_diffusion=0.5", "water.artificial_viscosity=2", NULL);
    assert_near(1e-12, 0.15104895104895104 * 0.0135 / 20, timestep_fluid_limit(&rig.sim), "least");
    timestep_choose(&rig.sim, 10, &hits);
    assert_near(1e-12, 0.15104895104895104 * 0.0135 / 20, rig.sim.dt_bound[BOUND_diffusion],
                "diffusion");
    assert_near(1e-12, 0.1956521739130435 * 0.0135 / 20, rig.sim.dt_bound[BOUND_artificial],
                "artificial viscosity");
    rig_open(&rig, gate, "water.density_diffusion=0.5", "integrator=symplectic", NULL);
    assert_near(1e-12, 0.2 * 0.0135 / 20, timestep_fluid_limit(&rig.sim), "predictor-corrector");
}

/* L-8 with beta = 0.25: 1.35^2 * 0.0135/(8.1 * 0.5 * 20) = 3.0375e-4 s. */
static void test_repulsion_bound_by_hand(void)
{
    bool hits;
    rig_open(&rig, gate, NULL);
    timestep_choose(&rig.sim, 10, &hits);
    TEST_ASSERT_TRUE(isinf(rig.sim.dt_bound[BOUND_repulsion]));
    rig_open(&rig, gate, "water.wall_repulsion=0.25", NULL);
    timestep_choose(&rig.sim, 10, &hits);
    assert_near(1e-15, 3.0375e-4, rig.sim.dt_bound[BOUND_repulsion], "1/omega");
}

/* T-35d, h/c0 = 0.0135/20 s: at a fifth of the fluid's density b = 2/11, of the lightest of
 * the bodies. */
static void test_added_mass_bound_by_hand(void)
{
    static const char body[] = "[solid cork]\nlike = gate\nshape = box 0.2, 0.2, 0.24, 0.24\n"
                               "clamp = box 0.2, 0.2, 0.24, 0.24\ndensity = 200\n";
    char text[2048];
    snprintf(text, sizeof text, "%s%s", gate, body);
    const double b = 2.0 / 11, lag = 0.0135 / 20;
    static const struct {
        const char *integrator;
        double age, halves; /* of the acceleration in steps; of the extrapolated velocity */
    } row[] = {{"integrator=leapfrog", 0.5, 1},
               {"integrator=verlet", 0.5, 1},
               {"integrator=symplectic", 1, 2}};
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        rig_open(&rig, text, row[k].integrator, NULL);
        assert_near(1e-12 * lag,
                    lag * fmin(b / (1 + (row[k].age - 1) * b) / row[k].halves, 0.2 * (k ? 1 : 2)),
                    timestep_fluid_limit(&rig.sim), row[k].integrator);
    }
    /* At a single rate the structure has a velocity of its own, which is not extrapolated. */
    rig_open(&rig, text, "integrator=symplectic", "numerics.multirate=off", NULL);
    int first;
    assert_near(1e-12 * lag, lag * b, coupling_added_mass_step(&rig.sim.coupling, &first),
                "one rate");
    /* Of bodies that are equally light the first is named. */
    rig_open(&rig, text, "gate.density=200", NULL);
    int lightest;
    coupling_added_mass_step(&rig.sim.coupling, &lightest);
    TEST_ASSERT_EQUAL_INT(0, lightest);
    /* The step that it allows keeps the mean's weight at b. */
    rig_open(&rig, text, "cork.density=100", NULL);
    const double dt = timestep_fluid_limit(&rig.sim), mean = lag - 0.5 * dt;
    assert_near(1e-12, 2.0 / 21, dt / (dt + mean), "weight");
    /* A body of one spacing of the fluid is thinner than the layers of fluid on its sides: 0.02
     * over its area of 1e-3 by the extent of 0.0975. */
    snprintf(text, sizeof text, "%s%s", gate,
             "[solid reed]\nlike = gate\nshape = box 0.2, 0.2, 0.21, 0.3\n"
             "clamp = box 0.2, 0.2, 0.21, 0.21\ndensity = 200\ndp = 0.0025\n");
    rig_open(&rig, text, "integrator=leapfrog", NULL);
    assert_near(1e-9 * lag, lag / (5 * 1.95), timestep_fluid_limit(&rig.sim), "thin");
}

/* Times to be hit are hit to the bit, no step is longer than its bound, and the books agree. */
static void run_through_times(const char *integrator, const char *rate)
{
    rig_open(&rig, gate, integrator, rate, NULL);
    const double times[] = {1e-4, 1.0000001e-4, 0.00123456789, 0.003, 0.0030001};
    double dt_min = INFINITY, dt_max = 0, sum = 0;
    int64_t steps = 0, substeps = 0, booked = 0;
    for (int k = 0; k < (int)COUNT_OF(times); k++) {
        while (rig.sim.state.time < times[k]) {
            rig_steps(&rig, 1, times[k]);
            const struct state *const st = &rig.sim.state;
            for (int b = 0; b < BOUND_COUNT; b++)
                TEST_ASSERT_TRUE(st->dt <= rig.sim.dt_bound[b] * (1 + 1e-12));
            TEST_ASSERT_TRUE(st->dt <= rig.sim.substeps * rig.sim.dt_solid * (1 + 1e-12));
            dt_min = fmin(dt_min, st->dt);
            dt_max = fmax(dt_max, st->dt);
            sum += st->dt;
            steps++;
            substeps += rig.sim.substeps;
        }
        TEST_ASSERT_TRUE(rig.sim.state.time == times[k]);
    }
    const struct state *const st = &rig.sim.state;
    TEST_ASSERT_EQUAL_INT64(steps, st->steps);
    TEST_ASSERT_EQUAL_INT64(substeps, st->solid_substeps);
    TEST_ASSERT_TRUE(st->dt_min == dt_min && st->dt_max == dt_max);
    const struct particles *const all = rig.sim.particles;
    TEST_ASSERT_EQUAL_INT64(steps * (all[KIND_FLUID].n + all[KIND_SOLID].n), st->particle_steps);
    for (int b = 0; b < BOUND_COUNT; b++) booked += st->bound_steps[b];
    TEST_ASSERT_EQUAL_INT64(steps, booked);
    assert_near(1e-15, times[4], sum, "sum of the steps");
}

static void test_output_times_are_hit_exactly(void)
{
    run_through_times("integrator=symplectic", "numerics.multirate=on");
    run_through_times("integrator=symplectic", "numerics.multirate=off");
    run_through_times("integrator=verlet", "numerics.multirate=on");
    run_through_times("integrator=verlet", "numerics.multirate=off");
}

static void test_a_lone_solid_hits_its_times_in_batches(void)
{
    for (int integrator = 0; integrator < 2; integrator++) {
        rig_open(&rig, block, integrator ? "integrator=verlet" : "integrator=symplectic", NULL);
        const double bound = rig.sim.dt_solid;
        const double times[] = {0.3 * bound, 7.5 * bound, 1000.25 * bound};
        for (int k = 0; k < 3; k++) {
            rig_run(&rig, times[k]);
            TEST_ASSERT_TRUE(rig.sim.state.time == times[k]);
            TEST_ASSERT_TRUE(rig.sim.state.dt_max <= bound);
        }
        TEST_ASSERT_EQUAL_INT64(1 + 8 + 993, rig.sim.state.steps);
        TEST_ASSERT_EQUAL_INT64(rig.sim.state.steps, rig.sim.state.solid_substeps);
        rig_open(&rig, block, integrator ? "integrator=verlet" : "integrator=symplectic", NULL);
        TEST_ASSERT_EQUAL_INT(ERR_OK, simulation_step(&rig.sim, 15.5 * bound, &rig.diag));
        assert_near(1e-12 * bound, 15.5 / 16 * bound, rig.sim.state.dt, "a short batch");
        rig_open(&rig, block, "numerics.fixed_step=1e-6", NULL);
        rig_run(&rig, 1e-4);
        TEST_ASSERT_EQUAL_INT64(100, rig.sim.state.steps);
        TEST_ASSERT_EQUAL_INT64(100, rig.sim.state.bound_steps[BOUND_fixed]);
    }
}

/* Energy of the block `steps` steps after a shake of 1 cm/s of every particle by itself;
 * infinity if a guard stops it. */
static double energy_after(int steps, double *start)
{
    struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    uint64_t seed = 5;
    for (int64_t i = 0; i < particles->n; i++) {
        particles->vx[i] = 0.01 * noise(&seed);
        particles->vy[i] = 0.01 * noise(&seed);
    }
    struct ledger row = simulation_ledger(&rig.sim);
    *start = row.kinetic;
    const double fixed = rig.scene.numerics.fixed_step;
    const double end = steps * (fixed > 0 ? fixed : rig.sim.dt_solid);
    while (rig.sim.state.time < end)
        if (simulation_step(&rig.sim, end, &rig.diag)) return (double)INFINITY;
    row = simulation_ledger(&rig.sim);
    return row.kinetic + row.elastic + row.hourglass;
}

static const char *const kappas[] = {"block.hourglass=0", "block.hourglass=10",
                                     "block.hourglass=50"};
static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet"};

/* At the full bound, with the viscosity of the paper, a shaken block comes to rest but for its
 * rigid motion and its slowest modes. */
static void test_stable_at_the_bound(void)
{
    for (int k = 0; k < 6; k++) {
        double start;
        rig_open(&rig, block, kappas[k / 2], integrators[k % 2], "numerics.solid_safety=1", NULL);
        assert_at_most(0.2, energy_after(2000, &start) / start, kappas[k / 2]);
    }
}

/* Without any viscosity nothing takes energy out, and at the default safety nothing puts it in: the
 * modified energy that a symplectic scheme keeps differs from the energy by a factor of at most
 * 1/(1 - (w dt/2)^2) = 1/(1 - 0.9^2) = 5.3. The printed hourglass force has no energy and is tried
 * with the paper's gradient. */
static void test_stable_without_viscosity_at_the_default_safety(void)
{
    for (int k = 0; k < 6; k++) {
        double start;
        rig_open(&rig, block, kappas[k / 2], integrators[k % 2], "block.artificial_viscosity=0",
                 NULL);
        assert_at_most(5.3, energy_after(4000, &start) / start, kappas[k / 2]);
        rig_open(&rig, block, kappas[k / 2], integrators[k % 2], "block.artificial_viscosity=0",
                 "block.gradient=linear",
                 k / 2 ? "block.hourglass_form=printed" : "block.hourglass_form=variational", NULL);
        assert_at_most(5.3, energy_after(4000, &start) / start, "printed");
    }
}

/* At 1.6 times the bound it blows up: the bound is not just cautious. */
static void test_unstable_beyond_the_bound(void)
{
    for (int k = 0; k < 6; k++) {
        rig_open(&rig, block, kappas[k / 2], NULL);
        char step[64];
        snprintf(step, sizeof step, "numerics.fixed_step=%.17g", 1.6 * rig.sim.solid.stable_step);
        rig_open(&rig, block, kappas[k / 2], integrators[k % 2], step, NULL);
        double start;
        TEST_ASSERT_TRUE_MESSAGE(energy_after(200, &start) > 1e3 * start, kappas[k / 2]);
    }
}

/* Springs bound the step, not c_s: Eq. 29 by hand, 0.6 h/sqrt(K/rho) with K = E/(3 (1 - 2 nu)) =
 * 3.333e7 Pa: 0.6 * 0.0135/166.6667 = 4.86e-5 s; and the bound falls as kappa grows. */
static void test_bound_knows_the_hourglass_springs(void)
{
    double last = INFINITY;
    for (int k = 0; k < 3; k++) {
        rig_open(&rig, block, kappas[k], NULL);
        assert_near(1e-16, 4.86e-5, rig.sim.solid.acoustic_step, "Eq. 29");
        TEST_ASSERT_TRUE(rig.sim.solid.stable_step < last);
        TEST_ASSERT_TRUE(rig.sim.dt_solid == 0.9 * rig.sim.solid.stable_step);
        last = rig.sim.solid.stable_step;
    }
}

/* A chain of springs by hand is not at hand; but frequencies scale: with E by 4 the step
 * halves, with dp by 2 it doubles (all else in proportion). Power iteration does the same
 * rounds: to round-off. */
static void test_bound_scales_as_it_must(void)
{
    rig_open(&rig, block, "block.artificial_viscosity=0", NULL);
    const double step = rig.sim.solid.stable_step;
    rig_open(&rig, block, "block.artificial_viscosity=0", "block.young=8e7", NULL);
    assert_near(1e-6, 0.5, rig.sim.solid.stable_step / step, "E by 4");
    rig_open(&rig,
             "dp = 2 cm\nend_time = 1\n[solid block]\nshape = box 0, 0, 0.08, 0.2\n"
             "density = 1200\nyoung = 2e7\npoisson = 0.4\nartificial_viscosity = 0\n",
             NULL);
    assert_near(1e-6, 2, rig.sim.solid.stable_step / step, "dp by 2");
}

/* The bound of a body that is stretched by 1 % and pulls at its ends, and the stiffness at 20
 * % in both directions, are near those of the body at rest: not the forces count but their
 * changes. */
static void test_bound_of_a_stretched_block(void)
{
    for (int much = 0; much < 2; much++) {
        rig_open(&rig, block, "block.law=svk", NULL);
        struct particles *const particles = &rig.sim.particles[KIND_SOLID];
        const double share = much ? 0.2 : 0.01, before = rig.sim.solid.omega_max;
        for (int64_t i = 0; i < particles->n; i++) {
            particles->ux[i] = share * particles->X[i];
            particles->uy[i] = much * share * particles->Y[i];
        }
        solid_stress(&rig.sim.solid, particles);
        const double stiffening = solid_stiffening(&rig.sim.solid, particles);
        TEST_ASSERT_TRUE(much ? stiffening > 1 && stiffening < 5 : stiffening == 1);
        double omega, damping;
        solid_stable_step(&rig.sim.solid, particles, &omega, &damping);
        if (!much) assert_near(0.1 * before, before, omega, "frequency");
    }
}

static int warned;
static void count_warning(void *context, const char *text)
{
    (void)context, (void)text;
    warned++;
}

/* A fixed step is too long for a solid that takes the same steps, and for nothing else. */
static void test_warning_of_a_fixed_step(void)
{
    static const char water[] =
        "dp = 1 cm\nend_time = 1\n[numerics]\nfixed_step = 1e-4\n[fluid w]\n"
        "shape = box 0, 0, 0.1, 0.1\nsound_speed = 20\n";
    struct diag diag = {.warn = count_warning};
    for (int k = 0; k < 2; k++) {
        rig_open(&rig, k ? block : water, k ? "numerics.fixed_step=1" : NULL, NULL);
        warned = 0;
        check_simulation(&rig.sim, &diag);
        TEST_ASSERT_EQUAL_INT(k, warned);
    }
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_bounds_by_hand);
    RUN_TEST(test_viscous_bound_by_hand);
    RUN_TEST(test_damper_bound_by_hand);
    RUN_TEST(test_decay_bounds_by_hand);
    RUN_TEST(test_repulsion_bound_by_hand);
    RUN_TEST(test_added_mass_bound_by_hand);
    RUN_TEST(test_bound_with_a_push);
    RUN_TEST(test_the_last_two_steps_before_a_limit_are_equal);
    RUN_TEST(test_substeps_cover_the_longest_step);
    RUN_TEST(test_multirate_auto);
    RUN_TEST(test_output_times_are_hit_exactly);
    RUN_TEST(test_a_lone_solid_hits_its_times_in_batches);
    RUN_TEST(test_stable_at_the_bound);
    RUN_TEST(test_stable_without_viscosity_at_the_default_safety);
    RUN_TEST(test_unstable_beyond_the_bound);
    RUN_TEST(test_bound_knows_the_hourglass_springs);
    RUN_TEST(test_bound_scales_as_it_must);
    RUN_TEST(test_bound_of_a_stretched_block);
    RUN_TEST(test_warning_of_a_fixed_step);
    return UNITY_END();
}
