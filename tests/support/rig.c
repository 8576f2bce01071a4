/* SPDX-License-Identifier: MIT */
#include "rig.h"

#include "check/check.h"
#include "fluid/eos.h"
#include "geometry/scene_points.h"
#include "unity.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { MAX_SETS = 16 };

struct test_switches rig_switches;

/* Scenes of tests have the effects that they name, unless they choose a scheme. */
static const char *const plain_scheme = "scheme=paper";

void rig_open(struct rig *r, const char *text, ...)
{
    const char *sets[MAX_SETS];
    int n = 0;
    if (!strstr(text, "scheme = ")) sets[n++] = plain_scheme;
    va_list args;
    va_start(args, text);
    for (const char *set; (set = va_arg(args, const char *));) {
        TEST_ASSERT_TRUE(n < MAX_SETS);
        sets[n++] = set;
    }
    va_end(args);
    rig_close(r);
    enum err e = scene_load_text(&r->scene, text, "rig.cfg", n, sets, &r->diag);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, e, r->diag.text);
    r->scene_open = true;
    e = check_scene(&r->scene, &r->diag);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, e, r->diag.text);
    r->scene.test = rig_switches;
    e = simulation_create(&r->sim, &r->scene, &r->diag);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, e, r->diag.text);
    r->sim_open = true;
    rig_ignore_gains(r);
}

void rig_close(struct rig *r)
{
    if (r->sim_open) simulation_free(&r->sim);
    if (r->scene_open) scene_free(&r->scene);
    memset(r, 0, sizeof *r);
}

void rig_run(struct rig *r, double time)
{
    r->sim.evaluated = false; /* the test may have changed the state */
    while (r->sim.state.time < time) {
        const enum err e = simulation_step(&r->sim, time, &r->diag);
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, e, r->diag.text);
    }
}

void rig_steps(struct rig *r, int steps, double limit)
{
    r->sim.evaluated = false;
    for (int k = 0; k < steps; k++) {
        const enum err e = simulation_step(&r->sim, limit, &r->diag);
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, e, r->diag.text);
    }
}

void rig_refuses(const char *text, const char *why)
{
    struct scene scene;
    struct simulation sim;
    struct diag d = {0};
    const int n = strstr(text, "scheme = ") ? 0 : 1;
    enum err e = scene_load_text(&scene, text, "t.cfg", n, &plain_scheme, &d);
    if (e == ERR_OK) {
        e = check_scene(&scene, &d);
        if (e == ERR_OK) e = simulation_create(&sim, &scene, &d);
        scene_free(&scene);
    }
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_INPUT, e, d.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(d.text, why), d.text);
}

void rig_sort(struct rig *r)
{
    for (int kind = 0; kind < KIND_COUNT; kind++)
        if (r->sim.particles[kind].n)
            TEST_ASSERT_EQUAL_INT64(0, cells_sort(&r->sim.cells, (enum kind)kind,
                                                  &r->sim.particles[kind]));
    fluid_find_near(&r->sim.fluid, &r->sim.cells);
    r->sim.sorting.skin_left = 0;
}

double rig_pressure(const struct simulation *sim, int64_t i)
{
    return eos_pressure(sim->particles[KIND_FLUID].dens[i], sim->fluid.k.rho0, sim->fluid.k.c0);
}

void rig_evaluate(struct rig *r)
{
    double seconds[PHASE_COUNT] = {0};
    fluid_evaluate(&r->sim.fluid, r->sim.particles, &r->sim.cells, seconds);
    coupling_find_forces(&r->sim.coupling, r->sim.particles, &r->sim.cells);
}

void rig_one_thread(void) { thread_use(1); }

double noise(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-52 - 1;
}

void assert_near(double tolerance, double expected, double actual, const char *what)
{
    char text[256];
    const double difference = actual > expected ? actual - expected : expected - actual;
    snprintf(text, sizeof text, "%s: %.17g, not %.17g (off by %.3g, allowed %.3g)", what, actual,
             expected, difference, tolerance);
    TEST_ASSERT_TRUE_MESSAGE(difference <= tolerance, text);
}

void assert_at_most(double limit, double value, const char *what)
{
    char text[256];
    snprintf(text, sizeof text, "%s: %.17g, more than %.17g", what, value, limit);
    TEST_ASSERT_TRUE_MESSAGE(value <= limit, text);
}

void rig_ignore_gains(struct rig *r)
{
    /* The rounding of such a sum is above any gain. */
    for (int k = 0; k < ENERGY_ENTRIES; k++) r->sim.state.energy.entry[k].supplied = 1e30;
}
