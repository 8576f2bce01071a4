/* SPDX-License-Identifier: MIT
 * The account of energy by regions (T-46): gains are found after losses and beside other scenes,
 * and work on what is at rest is no gain. */
#include "time/energy.h"
#include "time/advance.h"
#include "rig.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define TANKS                                                                                   \
    "dp = 5 mm\nend_time = 1\ngravity = 0, -9.81\n[constants]\nx1 = 0.115\n"                    \
    "[fluid left]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\nartificial_viscosity = 0.02\n" \
    "density_diffusion = 0.1\nsurface = 0.1\n"                                                  \
    "[fluid right]\nlike = left\nshape = box x1, 0, x1 + 0.1, 0.1\n"                            \
    "[wall tank]\nshape = polyline thickness -0.02: 0, 0.2; 0, 0; 0.1, 0\n"                     \
    "shape = polyline thickness -0.02: x1, 0; x1 + 0.1, 0; x1 + 0.1, 0.2\n"                     \
    "[solid plate]\nshape = box 0.1, -0.02, x1, 0.12\nclamp = box 0.1, -0.02, x1, 0\n"          \
    "density = 1000\nyoung = 1e6\npoisson = 0.3\n"
/* A column that collapses, beside them. */
#define COLUMN                                                                 \
    "[fluid column]\nlike = left\nshape = box 2, 0, 2.1, 0.2\nsurface = 0.2\n" \
    "[wall other]\nshape = polyline thickness -0.02: 2, 0.3; 2, 0; 2.4, 0; 2.4, 0.3\n"

static struct rig rig;
static char warning[512];
static int warnings;

static void note(void *context, const char *text)
{
    (void)context;
    if (!strstr(text, "gained")) return;
    warnings++;
    snprintf(warning, sizeof warning, "%s", text);
}

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

static enum err go_on(double end)
{
    while (rig.sim.state.time < end) {
        const enum err e = simulation_step(&rig.sim, end, &rig.diag);
        if (e) return e;
    }
    return ERR_OK;
}

static enum err run(const char *text, const char *set, double end)
{
    rig_open(&rig, text, set, NULL);
    simulation_refresh(&rig.sim);
    energy_begin(&rig.sim);
    rig.diag = (struct diag){.warn = note};
    warnings = 0;
    return go_on(end);
}

static double region(enum kind kind, int section)
{
    return rig.sim.state.energy.entry[energy_entry(kind, section)].region;
}

/* Energy put into the plate after the column has lost much of its own: the plate's region is named,
 * the column's is another. */
static void test_gain_beside_a_collapse(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, run(TANKS COLUMN, NULL, 0.3));
    TEST_ASSERT_EQUAL_INT(0, warnings);
    TEST_ASSERT_TRUE(region(KIND_FLUID, 0) == region(KIND_FLUID, 1));
    TEST_ASSERT_TRUE(region(KIND_FLUID, 0) == region(KIND_SOLID, 0));
    TEST_ASSERT_TRUE(region(KIND_FLUID, 0) != region(KIND_FLUID, 2));
    struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++) particles->vx[i] += 0.1 * particles->free[i];
    TEST_ASSERT_TRUE(simulation_ledger(&rig.sim).dissipated > 0); /* of both together */
    TEST_ASSERT_EQUAL_INT(ERR_OK, go_on(rig.sim.state.time + 5e-3));
    TEST_ASSERT_EQUAL_INT(1, warnings);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warning, "fastest: [solid plate] at ("), warning);
    TEST_ASSERT_NULL(strstr(warning, "column"));
}

/* Regions that come near each other are one from then on, and what each has lost stays lost. */
static void test_regions_that_meet(void)
{
    static const char jets[] =
        "dp = 5 mm\nend_time = 1\n[fluid a]\nshape = box 0, 0, 0.05, 0.05\nsound_speed = 20\n"
        "velocity = 1, 0\nartificial_viscosity = 0.1\n[fluid b]\nlike = a\n"
        "shape = box 0.1, 0, 0.15, 0.05\nvelocity = 0, 0\n[domain]\nlower = -1, -1\nupper = 2, 2\n";
    TEST_ASSERT_EQUAL_INT(ERR_OK, run(jets, NULL, 0.02));
    TEST_ASSERT_TRUE(region(KIND_FLUID, 0) != region(KIND_FLUID, 1));
    struct energy_account *const a = &rig.sim.state.energy;
    const int other = energy_entry(KIND_FLUID, 1);
    const double lost = a->entry[0].lowest[TERM_ALL] + a->entry[other].lowest[TERM_ALL];
    a->entry[0].supplied += 1; /* a loss of one that the other does not know */
    TEST_ASSERT_EQUAL_INT(ERR_OK, go_on(0.1));
    TEST_ASSERT_TRUE(region(KIND_FLUID, 0) == region(KIND_FLUID, 1));
    TEST_ASSERT_EQUAL_INT(0, warnings);
    energy_find_gain(&rig.sim);
    assert_at_most(lost - 1, a->entry[0].lowest[TERM_ALL], "lowest of both");
    assert_at_most(a->now[TERM_FLUID], a->entry[0].lowest[TERM_FLUID], "lowest of the fluids");
    assert_at_most(-1, a->now[TERM_FLUID], "its value now");
}

/* Whether fluid b, of 3 x 3 particles, is in the region of fluid a, of 10 x 10 in 0 to 0.05 m, when
 * its box begins there. */
static bool meets(double x, double y)
{
    char text[512];
    snprintf(text, sizeof text,
             "dp = 5 mm\nend_time = 1\n[numerics]\nh_over_dp = 1.5\n[fluid a]\n"
             "shape = box 0, 0, 0.05, 0.05\nsound_speed = 20\n[fluid b]\nlike = a\n"
             "shape = box %g, %g, %g, %g\n[domain]\nlower = -1, -1\nupper = 2, 2\n",
             x, y, x + 0.015, y + 0.015);
    TEST_ASSERT_EQUAL_INT(ERR_OK, run(text, NULL, 1e-3));
    energy_find_gain(&rig.sim);
    return region(KIND_FLUID, 0) == region(KIND_FLUID, 1);
}

/* On each side: at a distance of two spacings within the kernel's reach of three, at four not. */
static void test_regions_meet_on_any_side(void)
{
    for (int gap = 1; gap <= 3; gap += 2) {
        const double after = 0.05 + gap * 0.005, before = -0.015 - gap * 0.005;
        TEST_ASSERT_EQUAL_INT(gap == 1, meets(after, 0.02));
        TEST_ASSERT_EQUAL_INT(gap == 1, meets(before, 0.02));
        TEST_ASSERT_EQUAL_INT(gap == 1, meets(0.02, after));
        TEST_ASSERT_EQUAL_INT(gap == 1, meets(0.02, before));
    }
}

/* Bodies are apart until any are near each other, in contact, or joined. */
static void test_bodies_in_contact_are_one_region(void)
{
    static const char bodies[] =
        "dp = 1 cm\nend_time = 1\n[solid a]\nshape = box 0, 0, 0.04, 0.04\ndensity = 1000\n"
        "young = 1e6\npoisson = 0.3\n[solid b]\nlike = a\nshape = box 0.07, 0, 0.11, 0.04\n"
        "[solid c]\nlike = a\nshape = box 0.11, 0, 0.15, 0.04\njoined = b\n";
    rig_open(&rig, bodies, NULL);
    TEST_ASSERT_TRUE(region(KIND_SOLID, 0) != region(KIND_SOLID, 1));
    TEST_ASSERT_TRUE(region(KIND_SOLID, 1) == region(KIND_SOLID, 2));
    struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++)
        if (particles->body[i]) particles->ux[i] = -0.032;
    contact_forget(&rig.sim.contact, &rig.sim.particles[KIND_WALL]);
    energy_begin(&rig.sim);
    TEST_ASSERT_TRUE(region(KIND_SOLID, 0) == region(KIND_SOLID, 1));
    TEST_ASSERT_TRUE(region(KIND_SOLID, 0) == region(KIND_SOLID, 2));
}

/* A strip under its weight that folds, by the paper's law, which has no stored energy. */
static void test_gain_after_a_loss(void)
{
    static const char strip[] =
        "dp = 5 mm\nend_time = 1\ngravity = 0, -9.81\n[solid strip]\nshape = box 0, 0, 0.5, 0.02\n"
        "shape = box 0, -0.3, 0.02, 0\nshape = box 0, -0.32, 0.3, -0.3\n"
        "clamp = box 0, -0.32, 0.02, 0.02\ndensity = 1000\nyoung = 30 kPa\npoisson = 0.3\n";
    TEST_ASSERT_EQUAL_INT(ERR_OK, run(strip, NULL, 0.7));
    TEST_ASSERT_EQUAL_INT(2, warnings); /* of 1 % and of twice as much */
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(warning, "fastest: [solid strip] at ("), warning);
    TEST_ASSERT_TRUE(simulation_ledger(&rig.sim).dissipated > 0);
}

/* A paddle touches water at rest, and clamps begin to move bodies at rest. */
static void test_work_on_what_rests(void)
{
    static const char paddle[] =
        "dp = 5 mm\nend_time = 1\n[constants]\nspeed = 0.5\n[fluid water]\nshape = box 0, 0, 0.2, "
        "0.1\n"
        "sound_speed = 20\nartificial_viscosity = 0.02\n[wall bed]\nshape = box -0.4, -0.02, 0.6, "
        "0\n"
        "[wall paddle]\nshape = box -0.03, 0.01, -0.01, 0.12\nmotion = m\n[motion m]\n"
        "x = speed*t\n";
    static const char beam[] =
        "dp = 5 mm\nend_time = 1\n[solid beam]\nshape = box 0, 0, 0.02, 0.2\n"
        "clamp = box 0, 0, 0.02, 0.02\nclamp_motion = m\ndensity = 1000\n"
        "young = 1 MPa\npoisson = 0.3\n[motion m]\nx = 2.5*t^3\n";
    static const char *const integrators[] = {"integrator=leapfrog", "integrator=symplectic",
                                              "integrator=verlet"};
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        TEST_ASSERT_EQUAL_INT(ERR_OK, run(paddle, integrators[k], 0.05));
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, warnings, warning);
        assert_at_most(-1e-4, -rig.sim.state.wall_work, "work");
        TEST_ASSERT_EQUAL_INT(ERR_OK, run(beam, integrators[k], 0.05));
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, warnings, warning);
        assert_at_most(-1e-4, -rig.sim.state.wall_work, "work");
    }
}

/* Velocities of a solid are half a step behind with `verlet`. A domino that settles on a floor, and
 * a bar that rings without viscosity, gain nothing; what is put into them is found as it is. */
static void test_velocities_half_a_step_behind(void)
{
    static const char domino[] =
        "dp = 10 mm\nend_time = 1\ngravity = 0, -9.81\n[numerics]\nsolid_safety = 0.99\n"
        "[wall floor]\nshape = box -0.1, -0.04, 0.2, 0\n[solid d]\nshape = box 0, 0, 0.02, 0.1\n"
        "young = 10 MPa\ndensity = 1000\npoisson = 0.3\n";
    static const char bar[] =
        "dp = 10 mm\nend_time = 1\n[solid bar]\nshape = box 0, 0, 0.05, 0.2\nyoung = 1 MPa\n"
        "clamp = box 0, 0, 0.05, 0.02\ndensity = 1000\npoisson = 0.3\nlaw = svk\n"
        "artificial_viscosity = 0\nvelocity = 2*y, 0\n";
    const struct energy_account *const account = &rig.sim.state.energy;
    TEST_ASSERT_EQUAL_INT(ERR_OK, run(domino, "integrator=verlet", 0.025));
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, warnings, warning);
    assert_at_most(1e-12, account->most[TERM_SOLID], "gain of the domino");
    TEST_ASSERT_EQUAL_INT(ERR_OK, run(bar, "integrator=verlet", 0.1));
    assert_at_most(1e-5 * account->largest_available, account->most[TERM_SOLID], "gain of the bar");
    const double kinetic = simulation_ledger(&rig.sim).kinetic;
    struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++)
        particles->vx[i] += 0.02 * particles->Y[i] * particles->free[i];
    const double put = simulation_ledger(&rig.sim).kinetic - kinetic;
    TEST_ASSERT_TRUE(put > 0.001 * account->largest_available);
    TEST_ASSERT_EQUAL_INT(ERR_OK, go_on(0.11));
    assert_near(0.05 * put, put, account->most[TERM_SOLID], "gain that was put in");
}

/* A body at rest in which particles have moved at random, by a fraction of their spacing. */
static struct energy_gain gain_of_noise(double fraction)
{
    static const char rest[] =
        "dp = 5 mm\nend_time = 1\n[solid block]\nshape = box 0, 0, 0.06, 0.06\n"
        "density = 1000\nyoung = 1e5\npoisson = 0.3\n";
    TEST_ASSERT_EQUAL_INT(ERR_OK, run(rest, NULL, 0.01));
    struct particles *const particles = &rig.sim.particles[KIND_SOLID];
    uint64_t seed = 1;
    for (int64_t i = 0; i < particles->n; i++) particles->ux[i] += 5e-3 * fraction * noise(&seed);
    solid_stress(&rig.sim.solid, particles);
    return energy_find_gain(&rig.sim);
}

/* Round-off of positions, as of two bodies in contact that begin at rest without gravity, is no
 * gain. */
static void test_round_off_is_no_gain(void)
{
    TEST_ASSERT_EQUAL_INT(-1, gain_of_noise(1e-14).entry);
    TEST_ASSERT_EQUAL_INT(energy_entry(KIND_SOLID, 0), gain_of_noise(1e-6).entry);
}

/* Work, losses and energies of the regions add up to the ledger's. */
static void test_regions_add_up(void)
{
    static const char two[] =
        "dp = 1 cm\nend_time = 1\ngravity = 0, -9.81\n"
        "[solid a]\nshape = box 0, 0, 0.2, 0.04\nclamp = box 0, 0, 0.04, 0.04\nclamp_motion = m\n"
        "density = 1000\nyoung = 1e6\npoisson = 0.3\n[solid b]\nlike = a\n"
        "shape = box 1, 0, 1.2, 0.04\nclamp = box 1, 0, 1.04, 0.04\n[load pull]\nbody = b\n"
        "shape = box 1.1, 0, 1.2, 0.04\nforce = 0, 5\n[motion m]\nx = 0.2*t\ny = 0.1*t\n";
    TEST_ASSERT_EQUAL_INT(ERR_OK, run(two, NULL, 0.1));
    TEST_ASSERT_TRUE(region(KIND_SOLID, 0) != region(KIND_SOLID, 1));
    const struct ledger row = simulation_ledger(&rig.sim);
    double put = 0;
    for (int k = 0; k < 2; k++)
        put += rig.sim.state.energy.entry[energy_entry(KIND_SOLID, k)].supplied;
    assert_near(1e-12 * fabs(put), rig.sim.state.energy_start + rig.sim.state.wall_work, put,
                "put");
    TEST_ASSERT_TRUE(fabs(row.dissipated) < 1);
}

static void quicken(struct particles *particles, double factor)
{
    for (int64_t i = 0; i < particles->n; i++) {
        particles->vx[i] *= factor;
        if (particles->vx_half) particles->vx_half[i] *= factor;
        if (particles->vx_old) particles->vx_old[i] *= factor;
    }
}

/* Multiplies the energy of a block in flight by e in the time 1/rate, from `start` on. Returns the
 * time from a gain of 1 % until it is named, by a warning or a stop, s. */
static double time_to_name(const char *block, const char *integrator, double rate, double start)
{
    const double call = 1e-4;
    double reached = 0, time = start;
    TEST_ASSERT_EQUAL_INT(ERR_OK, run(block, integrator, start));
    for (enum err e = ERR_OK; !e && warnings == 0;) {
        e = simulation_step(&rig.sim, time + call, &rig.diag);
        const double dt = rig.sim.state.time - time;
        time += dt;
        quicken(&rig.sim.particles[KIND_FLUID], 1 + 0.5 * rate * dt);
        quicken(&rig.sim.particles[KIND_SOLID], 1 + 0.5 * rate * dt);
        if (reached == 0 && rate * (time - start) > 0.01) reached = time;
    }
    TEST_ASSERT_TRUE(reached > 0);
    return time - reached;
}

/* A gain is named within 5 ms of 1 %, however fast it grows, and not before. */
static void test_a_gain_is_named_in_time(void)
{
    static const char *const blocks[] = {
        "dp = 5 mm\nend_time = 10\n[solid block]\nshape = box 0, 0, 0.05, 0.05\ndensity = 1000\n"
        "young = 1e6\npoisson = 0.3\nvelocity = 2, 0\n[domain]\nlower = -1, -1\nupper = 9, 1\n",
        "dp = 5 mm\nend_time = 10\n[fluid block]\nshape = box 0, 0, 0.05, 0.05\nsound_speed = 20\n"
        "velocity = 2, 0\nartificial_viscosity = 0.02\n[domain]\nlower = -1, -1\nupper = 9, 1\n"};
    static const char *const integrators[] = {"integrator=leapfrog", "integrator=symplectic",
                                              "integrator=verlet"};
    double longest = 0;
    for (size_t b = 0; b < COUNT_OF(blocks); b++)
        for (size_t k = 0; k < COUNT_OF(integrators); k++)
            for (double rate = 0.1; rate < 2e4; rate *= 10)
                for (double start = 10e-3; start < 13e-3; start += 0.7e-3)
                    longest = max2(longest, time_to_name(blocks[b], integrators[k], rate, start));
    assert_at_most(5e-3, longest, "time until a gain is named");
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_gain_beside_a_collapse);
    RUN_TEST(test_regions_that_meet);
    RUN_TEST(test_regions_meet_on_any_side);
    RUN_TEST(test_bodies_in_contact_are_one_region);
    RUN_TEST(test_gain_after_a_loss);
    RUN_TEST(test_work_on_what_rests);
    RUN_TEST(test_velocities_half_a_step_behind);
    RUN_TEST(test_round_off_is_no_gain);
    RUN_TEST(test_regions_add_up);
    RUN_TEST(test_a_gain_is_named_in_time);
    return UNITY_END();
}
