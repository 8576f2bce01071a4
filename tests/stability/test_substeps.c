/* SPDX-License-Identifier: MIT
 * Sub-steps that change in number feed oscillations which each number alone keeps (T-34b, T-34c).
 */
#include "rig.h"
#include "time/advance.h"
#include "time/timestep.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <string.h>

/* A drop beside a beam makes it a coupled scene. */
static const char coupled[] =
    "dp = 5 mm\nend_time = 1\ngravity = 0, -9.81\n"
    "[fluid drop]\nshape = box 0.05, 0.3, 0.06, 0.31\nsound_speed = 30\n"
    "[solid beam]\nshape = box 0, -0.02, 0.2, 0\nclamp = box 0, -0.02, 0.02, 0\n"
    "density = 1200\nyoung = 1e7\npoisson = 0.4\nartificial_viscosity = 0\n"
    "[domain]\nlower = -0.2, -0.3\nupper = 0.4, 0.4\n";

static struct rig rig;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

/* --- a scalar oscillator of frequency 1: u, and v in units of it --- */

struct oscillator {
    double u, v;
};

/* Drift, kick, drift (T-36), with the damping m; or, not centred, kick and drift (T-32). */
static struct oscillator step(struct oscillator o, double z, double m, bool centred)
{
    if (centred) o.u += 0.5 * z * o.v;
    o.v += z * (-o.u - m * o.v);
    o.u += (centred ? 0.5 : 1) * z * o.v;
    return o;
}

/* Factor a fluid step, of the largest eigenvalue, of fluid steps with these numbers of sub-steps.
 */
static double growth(const int *count, int rounds, double z, bool centred)
{
    struct oscillator a = {1, 0}, b = {0, 1};
    for (int r = 0; r < rounds; r++)
        for (int k = 0; k < count[r]; k++) {
            a = step(a, z / count[r], 0, centred);
            b = step(b, z / count[r], 0, centred);
        }
    const double half = 0.5 * (a.u + b.v), det = a.u * b.v - a.v * b.u;
    const double root = half * half > det ? sqrt(half * half - det) : 0;
    return pow(root > 0 ? fabs(half) + root : sqrt(det), 1.0 / rounds);
}

/* The sequence one, one, two sub-steps, each stable by itself. */
static void test_alternation_grows(void)
{
    static const int mixed[] = {1, 1, 2}, held[] = {2, 2, 2};
    assert_near(0.001, 1.259, growth(mixed, 3, 1.8, true), "centred, 1.8");
    assert_near(0.001, 1.374, growth(mixed, 3, 1.8, false), "not centred, 1.8");
    assert_near(0.0005, 1.030, growth(mixed, 3, 1.0, true), "centred, 1.0");
    assert_near(0.0005, 1.087, growth(mixed, 3, 1.0, false), "not centred, 1.0");
    assert_near(1e-12, 1, growth(held, 3, 1.8, true), "held, centred");
    assert_near(1e-12, 1, growth(held, 3, 1.8, false), "held, not centred");
}

/* What a step keeps: u^2 + (1 - z^2/4) v^2. */
static double kept(struct oscillator o, double z)
{
    return o.u * o.u + (1 - 0.25 * z * z) * o.v * o.v;
}

/* T-34b: over steps that change at random the logarithm of what is kept gains no more than the
 * changes of that of 1 - z^2/4 add up to, and a change alone reaches its share of it. */
static void test_gain_is_bounded_by_the_changes(void)
{
    uint64_t seed = 7;
    for (int run = 0; run < 100; run++) {
        struct oscillator o = {noise(&seed), noise(&seed)};
        double z = 1, bound = log(kept(o, z));
        for (int k = 0; k < 200; k++) {
            const double next = 1.2 + 0.6 * noise(&seed);
            bound += fabs(log((1 - 0.25 * next * next) / (1 - 0.25 * z * z)));
            z = next;
            o = step(o, z, 0, true);
            TEST_ASSERT_TRUE(log(kept(o, z)) <= bound + 1e-9);
        }
    }
    const struct oscillator fastest = {0, 1};
    const double ratio = kept(fastest, 0.9) / kept(fastest, 1.8);
    assert_near(1e-12, (1 - 0.2025) / (1 - 0.81), ratio, "a change");
}

/* --- the rule --- */

/* The solid's bound over its least at a time, in fluid steps: a square wave, a sine, or noise held.
 */
enum wave { SQUARE, SINE, RANDOM, WAVES };

static double bound_at(enum wave wave, double phase, double depth, uint64_t *seed)
{
    if (wave == RANDOM) return 1 + depth * 0.5 * (1 + noise(seed));
    const double s = wave == SINE ? 0.5 * (1 + sin(2 * M_PI * phase)) : fmod(phase, 1) < 0.5;
    return 1 + depth * s;
}

/* Largest energy of the oscillator, over its first, while the bound moves for 4000 fluid steps.
 * `always`: the least number at each step. */
static double top_energy(enum wave wave, double period, double most, double m, bool always)
{
    struct oscillator o = {1, 0};
    uint64_t seed = 11;
    double top = 1, of_wave = 1;
    const double limit = timestep_fluid_limit(&rig.sim);
    rig.sim.state.substeps_held = 0;
    rig.sim.state.time = 0;
    /* A fluid step is `most` of the least bound; by the largest one the oscillator is at 0.9 of its
     * own. */
    const double least = limit / most, depth = 1.2, w = 1.8 / (least * (1 + depth));
    rig.sim.solid.damping_max = m * w;
    for (int k = 0; k < 4000; k++) {
        if (wave != RANDOM || k % (int)period == 0)
            of_wave = bound_at(wave, k / period, depth, &seed);
        rig.sim.dt_solid = least * of_wave;
        const int n = always ? (int)ceil(limit / rig.sim.dt_solid * (1 - 1e-9))
                             : timestep_substeps(&rig.sim, limit);
        TEST_ASSERT_TRUE(limit / n <= rig.sim.dt_solid * (1 + 1e-8));
        for (int j = 0; j < n; j++) o = step(o, w * limit / n, 0.5 * m, true);
        rig.sim.state.time += limit;
        top = fmax(top, o.u * o.u + o.v * o.v);
        if (!(top < 1e12)) return top;
    }
    return top;
}

/* The bound moves at 24 rates, by a factor of 2.2, with 1.1 to 9 sub-steps at its least. Without
 * viscosity the oscillation is as it was within 1/(1 - 0.9^2); with it, it gains no more than one
 * change gives. */
static void test_moving_bound_does_not_feed(void)
{
    rig_open(&rig, coupled, NULL);
    rig.sim.effects |= FX_MULTIRATE;
    static const double counts[] = {1.1, 1.9, 2.1, 3.7, 9};
    int fed = 0;
    for (int wave = 0; wave < WAVES; wave++)
        for (size_t c = 0; c < COUNT_OF(counts); c++)
            for (double period = 1; period < 1000; period *= 1.37) {
                const enum wave w = (enum wave)wave;
                fed += top_energy(w, period, counts[c], 0, true) > 1e6;
                assert_at_most(5.3, top_energy(w, period, counts[c], 0, false),
                               "without viscosity");
                assert_at_most(5.3 * 5.3, top_energy(w, period, counts[c], 0.05, false), "with it");
            }
    assert_at_most(-40, -fed, "grids at which the least number at each step feeds it");
}

/* More at once; fewer after the viscosity has had its time, which without it never comes. */
static void test_number_is_held(void)
{
    rig_open(&rig, coupled, NULL);
    rig.sim.effects |= FX_MULTIRATE;
    struct state *const st = &rig.sim.state;
    const double limit = timestep_fluid_limit(&rig.sim);
    st->substeps_held = 0;
    rig.sim.dt_solid = limit / 3.5;
    TEST_ASSERT_EQUAL_INT(4, timestep_substeps(&rig.sim, limit));
    rig.sim.dt_solid = limit / 6;
    TEST_ASSERT_EQUAL_INT(6, timestep_substeps(&rig.sim, limit));
    rig.sim.dt_solid = limit / 2.5;
    rig.sim.solid.damping_max = 0;
    st->time += 1e6;
    TEST_ASSERT_EQUAL_INT(6, timestep_substeps(&rig.sim, limit));
    /* As long as six are needed, the time of the viscosity has not begun. */
    rig.sim.solid.damping_max = 2 / limit;
    rig.sim.dt_solid = limit / 6;
    st->time += 1e6;
    TEST_ASSERT_EQUAL_INT(6, timestep_substeps(&rig.sim, limit));
    rig.sim.dt_solid = limit / 2.5;
    st->time += 2.31 * limit;
    TEST_ASSERT_EQUAL_INT(6, timestep_substeps(&rig.sim, limit));
    /* From 6 to 3 at 0.9: root^2 = (1.9 * 0.55)/(0.1 * 1.45), root - 1/root = 2.312. */
    st->time = st->short_steps_needed_at + 2.32 * limit;
    TEST_ASSERT_EQUAL_INT(3, timestep_substeps(&rig.sim, limit));
    rig.sim.dt_solid = limit;
    rig.sim.effects &= ~(effect_set)FX_MULTIRATE;
    TEST_ASSERT_EQUAL_INT(1, timestep_substeps(&rig.sim, limit));
}

/* --- a run --- */

/* Water falls onto a post whose bound is below the fluid's largest step and above its smallest: the
 * step wavers, the number does not, and hourglass energy is that of a single rate. */
static const char post[] =
    "dp = 4 mm\nend_time = 1\ngravity = 0, -9.81\n"
    "[fluid water]\nshape = box 0, 0, 0.1, 0.2\nsound_speed = 30\nsurface = 0.2\n"
    "artificial_viscosity = 0.02\ndensity_diffusion = 0.1\nwall_repulsion = 0.1\n"
    "[wall tank]\nshape = polyline thickness -4*dp: 0, 0.3; 0, 0; 0.3, 0; 0.3, 0.3\n"
    "[solid post]\nshape = box 0.16, -4*dp, 0.18, 0.08\nclamp = box 0.16, -4*dp, 0.18, 0\n"
    "density = 2500\nyoung = 1.9 MPa\npoisson = 0\nlaw = paper\n";

static double mean_hourglass(const char *multirate, double *least, double *most)
{
    rig_open(&rig, post, multirate, NULL);
    *least = INFINITY;
    *most = 0;
    double sum = 0;
    for (int row = 1; row <= 300; row++) {
        rig_run(&rig, row * 1e-3);
        const double dt = rig.sim.state.dt;
        *least = fmin(*least, dt);
        *most = fmax(*most, dt);
        sum += simulation_ledger(&rig.sim).hourglass;
        if (!strcmp(multirate, "numerics.multirate=on"))
            TEST_ASSERT_EQUAL_INT64(2 * rig.sim.state.steps, rig.sim.state.solid_substeps);
    }
    return sum / 300;
}

static void test_steps_that_waver_keep_their_number(void)
{
    double least, most;
    const double single = mean_hourglass("numerics.multirate=off", &least, &most);
    const double held = mean_hourglass("numerics.multirate=on", &least, &most);
    const double ratio = timestep_fluid_limit(&rig.sim) / rig.sim.dt_solid;
    TEST_ASSERT_TRUE(ratio > 1 && ratio < 2 && least < rig.sim.dt_solid && most > rig.sim.dt_solid);
    assert_at_most(1.1 * single, held, "hourglass energy beside a single rate's");
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_alternation_grows);
    RUN_TEST(test_gain_is_bounded_by_the_changes);
    RUN_TEST(test_moving_bound_does_not_feed);
    RUN_TEST(test_number_is_held);
    RUN_TEST(test_steps_that_waver_keep_their_number);
    return UNITY_END();
}
