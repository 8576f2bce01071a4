/* SPDX-License-Identifier: MIT
 * The guards: a state that is not sound is found, and the sentence names particle, place, quantity.
 */
#include "time/energy.h"

#include "time/advance.h"
#include "time/guards.h"
#include "rig.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char scene[] =
    "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n"
    "[fluid water]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\nsurface = 0.1\n"
    "[wall tank]\nshape = polyline thickness -0.03: 0, 0.2; 0, 0; 0.4, 0\n"
    "[solid gate]\nshape = box 0.1, 0, 0.13, 0.15\nclamp = box 0.1, 0.12, 0.13, 0.15\n"
    "density = 1100\nyoung = 1e6\npoisson = 0.4\n";

static struct rig rig;
static char warning[512];
static int warnings;

static void note(void *context, const char *text)
{
    (void)context;
    warnings++;
    snprintf(warning, sizeof warning, "%s", text);
}

void setUp(void)
{
    warnings = 0;
    rig_open(&rig, scene, NULL);
    rig_steps(&rig, 3, 1);
    rig.diag = (struct diag){.warn = note};
}

void tearDown(void) { rig_close(&rig); }

/* The check after a step that has left the state as it stands. */
static enum err check(void)
{
    update_extremes(&rig.sim);
    return guards_check(&rig.sim, &rig.diag);
}

/* The sentence holds the particle's kind and number, its place, the quantity and the time. */
static void expect(enum kind kind, int64_t at, const char *quantity)
{
    const struct particles *const particles = &rig.sim.particles[kind];
    char text[128];
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, check());
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, rig.diag.code);
    snprintf(text, sizeof text, "%s particle %lld at (%.6g, %.6g) m", kind_names[kind],
             (long long)particles->id[at], particles->x[at], particles->y[at]);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, text), rig.diag.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, quantity), rig.diag.text);
    snprintf(text, sizeof text, "t = %.6g s, step %lld", rig.sim.state.time,
             (long long)rig.sim.state.steps);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, text), rig.diag.text);
}

static void test_a_sound_state_passes(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, check());
    TEST_ASSERT_EQUAL_INT(0, warnings);
}

static void test_nan_velocity_of_the_fluid(void)
{
    rig.sim.particles[KIND_FLUID].vy[37] = (double)NAN;
    expect(KIND_FLUID, 37, "speed");
}

/* The first particle that is wrong is named, though another was noticed. */
static void test_nan_position_of_the_fluid(void)
{
    rig.sim.particles[KIND_FLUID].vx[50] = (double)NAN;
    rig.sim.particles[KIND_FLUID].x[3] = (double)NAN;
    expect(KIND_FLUID, 3, "position (m)");
}

static void test_infinite_velocity_of_the_fluid(void)
{
    rig.sim.particles[KIND_FLUID].vx[99] = -(double)INFINITY;
    expect(KIND_FLUID, 99, "speed (m/s) = inf");
}

static void test_speed_of_sound_of_the_fluid(void)
{
    rig.sim.particles[KIND_FLUID].vx[12] = 19.9;
    TEST_ASSERT_EQUAL_INT(ERR_OK, check());
    rig.sim.particles[KIND_FLUID].vx[12] = 20.1;
    expect(KIND_FLUID, 12, "speed (m/s) = 20.1, beyond the limit of 20:");
}

static void test_density_of_the_fluid(void)
{
    struct particles *const particles = &rig.sim.particles[KIND_FLUID];
    particles->dens[5] = 0.29;
    particles->dens[6] = -0.29;
    TEST_ASSERT_EQUAL_INT(ERR_OK, check());
    assert_near(0, 0.29, rig.sim.state.dens_high, "highest density so far");
    assert_near(0, -0.29, rig.sim.state.dens_low, "lowest density so far");
    particles->dens[50] = 0.31;
    expect(KIND_FLUID, 50, "rho/rho0 - 1 = 0.31");
}

static void test_tension_and_nan_of_the_density(void)
{
    rig.sim.particles[KIND_FLUID].dens[50] = -0.31;
    expect(KIND_FLUID, 50, "rho/rho0 - 1 = -0.31");
    rig.diag = (struct diag){0};
    rig.sim.guard.warned_entered = true; /* then that is the likely cause */
    expect(KIND_FLUID, 50, "fluid particles entered a wall or solid earlier");
    rig.diag = (struct diag){0};
    rig.sim.particles[KIND_FLUID].dens[50] = (double)NAN;
    expect(KIND_FLUID, 50, "rho/rho0 - 1");
}

static void test_velocity_of_the_solid(void)
{
    rig.sim.particles[KIND_SOLID].vx[20] = (double)NAN;
    expect(KIND_SOLID, 20, "speed");
    rig.sim.particles[KIND_SOLID].vx[20] = 11 * rig.sim.solid.body[0].sound_speed;
    rig.diag = (struct diag){0};
    expect(KIND_SOLID, 20, "speed");
}

/* A body as a whole may be as fast as it will. */
static void test_velocity_of_a_body(void)
{
    struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++) {
        particles->vx[i] = 30 * rig.sim.solid.body[0].sound_speed;
        particles->vy[i] = -particles->vx[i];
    }
    TEST_ASSERT_EQUAL_INT(ERR_OK, check());
}

/* A particle pushed through its neighbours turns the material inside out; found within 64 steps,
 * where the gradient is checked_at at, and in a lone solid after every batch. */
static void test_inverted_solid(void)
{
    struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    int64_t at = 0;
    for (int64_t i = 0; i < particles->n; i++)
        if (hypot(particles->X[i] - 0.115, particles->Y[i] - 0.055) < 1e-6) at = i;
    particles->Uxx[at] = -1.5;
    rig.sim.state.steps = 64;
    expect(KIND_SOLID, at, "det F");
    particles->Uxx[at] = (double)NAN;
    rig.diag = (struct diag){0};
    expect(KIND_SOLID, at, "det F");
}

/* The guards judge the gradients of the displacements as of the last sub-step, not those of the
 * start. */
static void test_lone_solid_is_judged_as_it_is(void)
{
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\n[solid bar]\nshape = box 0, 0, 0.2, 0.05\n"
             "clamp = box 0, 0, 0.02, 0.05\ndensity = 1100\nyoung = 1e6\npoisson = 0.3\n"
             "velocity = -4 s^-1*x, 0\n",
             NULL);
    struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    double lowest = 1;
    for (int step = 0; step < 20; step++) {
        rig_steps(&rig, 1, 1);
        const double found = rig.sim.state.det_low;
        solid_stress(&rig.sim.solid, particles);
        for (int64_t i = 0; i < particles->n; i++)
            lowest = min2(lowest, (1 + particles->Uxx[i]) * (1 + particles->Uyy[i]) -
                                      particles->Uxy[i] * particles->Uyx[i]);
        TEST_ASSERT_TRUE(lowest < 1);
        assert_near(0.1 * (1 - lowest), lowest, found, "smallest det F");
    }
}

static void test_lone_solid_turned_inside_out(void)
{
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\n[solid block]\nshape = box 0, 0, 0.06, 0.06\n"
             "density = 1000\nyoung = 1e6\npoisson = 0.3\nlaw = svk\n",
             NULL);
    struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++) particles->ux[i] = -1.9 * particles->X[i];
    const enum err e = simulation_step(&rig.sim, 1e-9, &rig.diag);
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, e);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, "solid particle"), rig.diag.text);
}

/* A step whose bound shrinks below 1e-4 of the fluid's limit has collapsed; one cut short by the
 * caller's limit has not. */
static void test_collapsed_step(void)
{
    rig.sim.state.dt = 1e-9;
    TEST_ASSERT_EQUAL_INT(ERR_OK, check());
    rig.sim.dt_bound[BOUND_force] = 1e-9;
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, check());
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, "time step has fallen"), rig.diag.text);
}

/* Beyond 0.3 c0 one warning, not one a step. */
static void test_one_warning_for_fast_fluid(void)
{
    rig.sim.particles[KIND_FLUID].vx[12] = 6.5;
    for (int k = 0; k < 3; k++) TEST_ASSERT_EQUAL_INT(ERR_OK, check());
    TEST_ASSERT_EQUAL_INT(1, warnings);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warning, "6.5"), warning);
}

/* Fluid where the tank's particles are: one particle is a warning, once, more than a few are the
 * end. In the solid as well, where it has moved. */
static void test_fluid_inside_of_bodies(void)
{
    struct particles *const particles = &rig.sim.particles[KIND_FLUID],
                            *const solid = &rig.sim.particles[KIND_SOLID];
    for (int64_t i = 0; i < solid->n; i++) solid->x[i] += 0.02;
    rig.sim.state.steps = 64;
    rig_sort(&rig);
    TEST_ASSERT_EQUAL_INT(ERR_OK, guards_check_entered(&rig.sim, &rig.diag));
    TEST_ASSERT_EQUAL_INT(0, warnings);
    particles->x[3] = solid->x[30] + 0.003;
    particles->y[3] = solid->y[30];
    const int64_t id = particles->id[3];
    rig_sort(&rig);
    for (int k = 0; k < 3; k++)
        TEST_ASSERT_EQUAL_INT(ERR_OK, guards_check_entered(&rig.sim, &rig.diag));
    TEST_ASSERT_EQUAL_INT(1, warnings);
    char text[64];
    snprintf(text, sizeof text, "fluid particle %lld at", (long long)id);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warning, text), warning);
    for (int k = 0; k < 5; k++) {
        particles->x[10 + k] = 0.005 + 0.01 * k;
        particles->y[10 + k] = -0.013;
    }
    rig_sort(&rig);
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, guards_check_entered(&rig.sim, &rig.diag));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, "6 fluid particles have entered"),
                                 rig.diag.text);
}

static int only_region(void)
{
    return (int)rig.sim.state.energy.entry[energy_entry(KIND_SOLID, 0)].region;
}

/* Checks the account after lowering what a term of the only region has been at least by a share of
 * its available energy; without what dummies could return. */
static enum err check_with_gain(enum energy_term term, double share)
{
    struct energy_account *const a = &rig.sim.state.energy;
    simulation_refresh(&rig.sim);
    energy_find_gain(&rig.sim);
    if (term == TERM_FLUID) a->entry[only_region()].lowest[term] = a->now[term];
    a->entry[only_region()].lowest[term] -= share * a->entry[only_region()].available[term];
    rig.sim.gain = energy_find_gain(&rig.sim);
    rig.sim.gain.found = true;
    rig.sim.state.gain_since = rig.sim.state.time - 3e-3;
    return energy_guard(&rig.sim, &rig.diag);
}

/* A gain of a hundredth is a warning, and so is twice what the last one said; nine tenths are the
 * end, but not at the interface as long as all terms together lose energy. */
static void test_energy_that_is_gained(void)
{
    simulation_refresh(&rig.sim);
    energy_begin(&rig.sim);
    TEST_ASSERT_EQUAL_INT(ERR_OK, check_with_gain(TERM_INTERFACE, 0.009));
    TEST_ASSERT_EQUAL_INT(0, warnings);
    TEST_ASSERT_EQUAL_INT(ERR_OK, check_with_gain(TERM_INTERFACE, 0.002));
    TEST_ASSERT_EQUAL_INT(1, warnings);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(warning, "in the exchange between fluid and structure; fastest: [solid gate] at ("),
        warning);
    assert_near(1e-4, 0.011, rig.sim.state.gain_share, "largest share");
    TEST_ASSERT_EQUAL_INT(ERR_OK, check_with_gain(TERM_INTERFACE, 0.01));
    TEST_ASSERT_EQUAL_INT(1, warnings);
    TEST_ASSERT_EQUAL_INT(ERR_OK, check_with_gain(TERM_INTERFACE, 0.5));
    TEST_ASSERT_EQUAL_INT(2, warnings);
    TEST_ASSERT_EQUAL_INT(ERR_OK, check_with_gain(TERM_INTERFACE, 0.4));
    TEST_ASSERT_EQUAL_INT(2, warnings);
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, check_with_gain(TERM_FLUID, 0.95));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, "in the fluid or at its boundaries"),
                                 rig.diag.text);
}

/* Below a tenth it has to last for 2.5 ms; above, it counts at once. */
static void test_a_gain_that_lasts(void)
{
    const struct {
        double share, since;
        int warned;
    } seen[] = {{0.09, 0, 0}, {0.09, 2e-3, 0}, {0.09, 3e-3, 1}, {0.11, 0, 1}};
    for (size_t k = 0; k < COUNT_OF(seen); k++) {
        warnings = 0;
        rig.sim.guard.warned_gain = 0;
        rig.sim.gain = (struct energy_gain){.entry = 0, .share = seen[k].share};
        rig.sim.gain.found = true;
        rig.sim.state.gain_since = rig.sim.state.time - seen[k].since;
        TEST_ASSERT_EQUAL_INT(ERR_OK, energy_guard(&rig.sim, &rig.diag));
        TEST_ASSERT_EQUAL_INT(seen[k].warned, warnings);
    }
    rig.sim.gain.share = 0.005;
    rig.sim.gain.found = true;
    rig.sim.state.gain_since = 0;
    TEST_ASSERT_EQUAL_INT(ERR_OK, energy_guard(&rig.sim, &rig.diag));
    TEST_ASSERT_TRUE(rig.sim.state.gain_since == rig.sim.state.time);
}

/* A loss by one term does not hide a gain by another. */
static void test_terms_apart(void)
{
    static const char *const names[] = {[TERM_FLUID] = "the fluid or at its boundaries",
                                        [TERM_INTERFACE] = "exchange",
                                        [TERM_SOLID] = "the solid's"};
    for (int t = 0; t < TERM_ALL; t++) {
        simulation_refresh(&rig.sim);
        energy_begin(&rig.sim);
        rig.sim.guard.warned_gain = 0;
        rig.sim.state.energy.entry[0].supplied += 3;
        TEST_ASSERT_EQUAL_INT(ERR_OK, check_with_gain((enum energy_term)t, 0.02));
        TEST_ASSERT_EQUAL_INT(t + 1, warnings);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warning, names[t]), warning);
        TEST_ASSERT_TRUE(!strstr(warning, "; a smaller dp ") == (t != TERM_FLUID));
    }
}

/* Where bodies meet in water, the layer between them may be too thin. */
static void test_a_gain_between_bodies(void)
{
    for (int near = 0; near < 2; near++) {
        warnings = 0;
        rig.sim.guard.warned_gain = 0;
        rig.sim.effects |= FX_CONTACT;
        rig.sim.contact.near = near;
        rig.sim.gain = (struct energy_gain){.term = TERM_FLUID, .share = 0.2};
        rig.sim.gain.found = true;
        TEST_ASSERT_EQUAL_INT(ERR_OK, energy_guard(&rig.sim, &rig.diag));
        TEST_ASSERT_NOT_NULL_MESSAGE(
            strstr(
                warning,
                near ? "; a smaller dp or numerics.cfl = 0.2 or a larger gap in [contact] or "
                       "numerics.multirate = off may help"
                     : "; a smaller dp or numerics.cfl = 0.2 or numerics.multirate = off may help"),
            warning);
    }
    rig.sim.guard.warned_gain = 0;
    rig.sim.effects &= ~(effect_set)FX_GRAVITY;
    rig.sim.gain = (struct energy_gain){.term = TERM_FLUID, .share = 0.2};
    rig.sim.contact.near = false;
    rig.sim.gain.found = true;
    TEST_ASSERT_EQUAL_INT(ERR_OK, energy_guard(&rig.sim, &rig.diag));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warning,
                                        "; a smaller dp or numerics.cfl = 0.2 or numerics.suction "
                                        "= on or numerics.multirate = off may"),
                                 warning);
}

static void advises(const char *text, const char *what, const char *set, const char *another)
{
    rig_open(&rig, text, set, another, NULL);
    rig_steps(&rig, 1, 1);
    rig_steps(&rig, 1, rig.sim.state.time + 1e-9); /* a short step before an output says nothing */
    simulation_refresh(&rig.sim);
    energy_begin(&rig.sim);
    rig.sim.particles[rig.sim.effects & FX_FLUID ? KIND_FLUID : KIND_SOLID].vx[0] = 5;
    rig.diag = (struct diag){.warn = note};
    simulation_refresh(&rig.sim);
    rig.sim.gain = energy_find_gain(&rig.sim);
    rig.sim.gain.found = true;
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, energy_guard(&rig.sim, &rig.diag));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, what), rig.diag.text);
}

/* A setting that is named does something in the run. */
static void test_what_may_help_is_said(void)
{
    static const char water[] =
        "dp = 1 cm\nend_time = 1\n[fluid water]\nshape = box 0, 0, 0.1, 0.1\n"
        "sound_speed = 20\n";
    static const char bar[] = "dp = 1 cm\nend_time = 1\n[solid bar]\nshape = box 0, 0, 0.3, 0.05\n"
                              "density = 1100\nyoung = 1e6\npoisson = 0.4\n";
    static const char fixed[] = "numerics.fixed_step=1e-4", small[] = "numerics.fixed_step=1e-5";
    advises(water, "; a smaller dp or numerics.cfl = 0.2 or numerics.suction = on may help", NULL,
            NULL);
    advises(water,
            "; a smaller dp or numerics.fixed_step = 5e-05 or numerics.suction = on may help",
            fixed, NULL);
    advises(bar, "; numerics.solid_safety = 0.45 or law = neo_hookean or svk may help", NULL, NULL);
    advises(bar, "; numerics.fixed_step = 5e-06 or law = neo_hookean or svk may help", small, NULL);
    advises(bar, "; numerics.solid_safety = 0.45 may help", "bar.law=svk", NULL);
    advises(scene,
            "; a smaller dp or numerics.cfl = 0.2 or a larger gap in [contact] or "
            "numerics.multirate = off may help",
            "gate.young=1e8", NULL);
    advises(scene,
            "; a smaller dp or numerics.solid_safety = 0.45 or a larger gap in [contact] may help",
            "numerics.multirate=off", NULL);
    advises(scene,
            "; a smaller dp or numerics.fixed_step = 5e-05 or a larger gap in [contact] may help",
            "gate.young=1e8", fixed);
    /* 0.125 M h^2/nu with h = 1.35 cm, M = 0.983: half of it, as no key but fixed_step shortens
     * it. */
    advises(water,
            "; a smaller dp or numerics.fixed_step = 2.24e-05 or numerics.suction = on may help",
            "water.laminar_viscosity=0.5", NULL);
}

/* Warnings that come before the limits, once each. */
static void test_warnings_before_the_end(void)
{
    rig.sim.particles[KIND_FLUID].dens[50] = 0.15;
    rig.sim.particles[KIND_SOLID].Uxx[7] = -0.9;
    rig.sim.state.steps = 64;
    for (int k = 0; k < BOUND_COUNT; k++) rig.sim.dt_bound[k] = (double)INFINITY;
    rig.sim.dt_bound[2] = 50 * rig.sim.guard.step_limit;
    for (int k = 0; k < 3; k++) TEST_ASSERT_EQUAL_INT(ERR_OK, check());
    TEST_ASSERT_EQUAL_INT(3, warnings);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warning, "the time step has fallen"), warning);
    char text[64];
    snprintf(text, sizeof text, "limited by the bound `%s`", bound_table[2].name);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warning, text), warning);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warning, "a smaller cfl"), warning);
    /* Neither cfl nor sound_speed changes the step of a solid. */
    rig.sim.dt_bound[2] = (double)INFINITY;
    rig.sim.dt_bound[BOUND_contact] = 50 * rig.sim.guard.step_limit;
    rig.sim.guard.warned_step = false;
    TEST_ASSERT_EQUAL_INT(ERR_OK, check());
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warning, "limited by the bound `contact`"), warning);
    TEST_ASSERT_NULL_MESSAGE(strstr(warning, "a smaller cfl"), warning);
}

/* A full channel from which fluid is missing; not one with a surface, nor at a step between checks.
 */
static void test_voids_in_a_full_channel(void)
{
    static const char channel[] =
        "dp = 1 cm\nend_time = 1\n[fluid w]\nshape = box 0, 0, 0.5, 0.1\nmax_speed = 1\n"
        "density_diffusion = 0.1\nvelocity = 0.5, 0\n[wall w]\nshape = box -0.1, -0.04, 0.6, 0\n"
        "shape = box -0.1, %g, 0.6, 0.14\n[inflow i]\nfrom = 0, 0.1\nto = 0, 0\nspeed = 0.5\n"
        "[outflow o]\nfrom = 0.5, 0\nto = 0.5, 0.1\npressure = 0\n";
    for (int open = 0; open < 2; open++) {
        char text[sizeof channel + 20];
        snprintf(text, sizeof text, channel, open ? 0.12 : 0.1);
        rig_open(&rig, text, NULL);
        rig_steps(&rig, 1, 1);
        rig.diag = (struct diag){.warn = note};
        struct particles *const particles = &rig.sim.particles[KIND_FLUID];
        const int64_t n = particles->n;
        for (int k = 0; k < 3; k++) {
            particles->n = k == 0 ? n - n / 50 : n - n / 10; /* a row of the buffers is no void */
            rig.sim.state.steps = k == 1 ? 511 : 512;
            warnings = 0;
            TEST_ASSERT_EQUAL_INT(ERR_OK, guards_check(&rig.sim, &rig.diag));
            TEST_ASSERT_EQUAL_INT_MESSAGE(k == 2 && !open, warnings, warning);
        }
        particles->n = n;
    }
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warning, "of the channel is empty: voids"), warning);
}

/* One of the two warnings does not suppress the other. */
static void test_beams_warn_of_both(void)
{
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\n[solid block]\nshape = box 0, 0, 0.1, 0.1\n"
             "density = 1000\nyoung = 1e6\npoisson = 0.3\n"
             "[beam bar]\nshape = polyline: -0.1, 0.2; 0.2, 0.2\nthickness = 1 cm\n"
             "density = 1000\nyoung = 1e6\npoisson = 0.3\n",
             NULL);
    rig_steps(&rig, 1, 1);
    rig.diag = (struct diag){.warn = note};
    rig.sim.state.steps = 16;
    rig.sim.beams.crowded = true;
    rig.sim.particles[KIND_SOLID].y[0] = 0.2;
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, check(), rig.diag.text);
    TEST_ASSERT_EQUAL_INT(2, warnings);
}

static void test_substeps_without_end(void)
{
    rig.sim.substeps = 10001;
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, check());
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, "10001 sub-steps"), rig.diag.text);
}

/* A load without a value, at a particle or node or from a time on, is no fault of the solver or of
 * another load there. */
static void test_a_load_that_is_not_finite(void)
{
    static const char beam[] = "dp = 5 cm\nend_time = 1\n[beam b]\nshape = polyline: 0, 0; 1, 0\n"
                               "thickness = 1 cm\nyoung = 1e7\ndensity = 1000\n"
                               "[load l]\nshape = box 0, -1, 2, 2\nbody = b\n",
                      solid[] = "dp = 5 cm\nend_time = 1\n[solid b]\nshape = box 0, 0, 1, 0.2\n"
                                "young = 1e7\ndensity = 1000\npoisson = 0\n"
                                "[load l]\nshape = box 0, -1, 2, 2\nbody = b\n";
    static const struct {
        const char *text, *keys, *at;
    } each[] = {{beam, "force = 0, 1/(x - 0.5)\n", "rig.cfg:8: t = "},
                {beam, "traction = 0, log(0.02 - t)\n", "rig.cfg:8: t = 0.02"},
                {beam, "moment = 1\nhistory = sqrt(0.02 - t)\n", "rig.cfg:8: t = 0.02"},
                {solid, "force = 0, 1/(x - 0.525)\n", "rig.cfg:8: t = "},
                {solid, "force = 0, sqrt(0.02 - t)\n", "rig.cfg:8: t = 0.02"}};
    for (size_t k = 0; k < COUNT_OF(each); k++) {
        char text[500];
        rig_close(&rig);
        snprintf(text, sizeof text, "%s%s%s", each[k].text, each[k].keys,
                 "[load good]\nshape = box 0, -1, 2, 2\nbody = b\nforce = 1, 0\n");
        rig_open(&rig, text, NULL);
        enum err e = ERR_OK;
        for (int n = 0; n < 1000 && !e; n++) e = simulation_step(&rig.sim, 1, &rig.diag);
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_GUARD, e, each[k].keys);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, each[k].at), rig.diag.text);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, "[load l] gives a force that is not"),
                                     rig.diag.text);
    }
}

/* In a run: a velocity that is not a number is found by the step that meets it. */
static void test_a_run_stops_at_once(void)
{
    rig.sim.particles[KIND_FLUID].vx[40] = (double)NAN;
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, simulation_step(&rig.sim, 1, &rig.diag));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(rig.diag.text, "fluid particle"), rig.diag.text);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_sound_state_passes);
    RUN_TEST(test_nan_velocity_of_the_fluid);
    RUN_TEST(test_nan_position_of_the_fluid);
    RUN_TEST(test_infinite_velocity_of_the_fluid);
    RUN_TEST(test_speed_of_sound_of_the_fluid);
    RUN_TEST(test_density_of_the_fluid);
    RUN_TEST(test_tension_and_nan_of_the_density);
    RUN_TEST(test_velocity_of_the_solid);
    RUN_TEST(test_velocity_of_a_body);
    RUN_TEST(test_inverted_solid);
    RUN_TEST(test_lone_solid_is_judged_as_it_is);
    RUN_TEST(test_lone_solid_turned_inside_out);
    RUN_TEST(test_collapsed_step);
    RUN_TEST(test_one_warning_for_fast_fluid);
    RUN_TEST(test_fluid_inside_of_bodies);
    RUN_TEST(test_energy_that_is_gained);
    RUN_TEST(test_a_gain_that_lasts);
    RUN_TEST(test_terms_apart);
    RUN_TEST(test_a_gain_between_bodies);
    RUN_TEST(test_what_may_help_is_said);
    RUN_TEST(test_warnings_before_the_end);
    RUN_TEST(test_voids_in_a_full_channel);
    RUN_TEST(test_beams_warn_of_both);
    RUN_TEST(test_substeps_without_end);
    RUN_TEST(test_a_load_that_is_not_finite);
    RUN_TEST(test_a_run_stops_at_once);
    return UNITY_END();
}
