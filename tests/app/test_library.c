/* SPDX-License-Identifier: MIT
 * The library as other programs use it: own forces and motions, probes, several simulations in
 * several threads. */
#include "sphfsi.h"
#include "tiny.h"
#include "unity.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

static struct sphfsi_simulation *a, *b;

static struct sphfsi_simulation *create(const char *text, const char *set)
{
    struct sphfsi_simulation *s;
    const struct sphfsi_options o = {.case_text = text,
                                     .sets = &set,
                                     .n_sets = set != NULL,
                                     .threads = 1};
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_create(&s, &o), sphfsi_error());
    return s;
}

void setUp(void) {}

void tearDown(void)
{
    sphfsi_free(a);
    sphfsi_free(b);
    a = b = NULL;
}

static const double *field(struct sphfsi_simulation *s, enum sphfsi_kind kind, const char *name)
{
    struct sphfsi_view v;
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_field(s, kind, name, &v), sphfsi_error());
    return v.data;
}

static void same_field(enum sphfsi_kind kind, const char *name, double tolerance)
{
    const double *x = field(a, kind, name), *y = field(b, kind, name);
    for (int64_t i = 0; i < sphfsi_count(a, kind); i++)
        TEST_ASSERT_DOUBLE_WITHIN(tolerance, x[i], y[i]);
}

/* --- forces --- */

static int calls;

static void weight(void *context, const struct sphfsi_particles *p, double *ax, double *ay)
{
    const double *const g = context;
    calls++;
    for (int64_t i = 0; i < p->n; i++) {
        ax[i] += g[0];
        ay[i] += g[1];
    }
}

static const char beam[] =
    "dp = 2 mm\nend_time = 1\ngravity = 0, 0\n"
    "[solid beam]\nshape = box 0, 0, 40 mm, 8 mm\nclamp = box 0, 0, 6 mm, 8 mm\n"
    "density = 1000\nyoung = 1e5\npoisson = 0.3\n"
    "[numerics]\nfixed_step = 20 us\n";

/* A force that is a weight bends the beam as gravity does. */
static void beam_bends(const char *integrator)
{
    static double g[2] = {3, -9.81};
    a = create(beam, integrator);
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_set_force(a, SPHFSI_SOLID, weight, g));
    char heavy[600];
    snprintf(heavy, sizeof heavy, "%s", beam);
    memcpy(strstr(heavy, "gravity = 0, 0"), "gravity=3,-9.8", 14);
    g[1] = -9.8;
    b = create(heavy, integrator);
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_advance(a, 0.01));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_advance(b, 0.01));
    same_field(SPHFSI_SOLID, "ux", 1e-13);
    same_field(SPHFSI_SOLID, "uy", 1e-13);
    const double *uy = field(a, SPHFSI_SOLID, "uy");
    double least = 0;
    for (int64_t i = 0; i < sphfsi_count(a, SPHFSI_SOLID); i++) least = fmin(least, uy[i]);
    TEST_ASSERT_TRUE(least < -1e-4);
    tearDown();
}

static void a_weight_bends_a_beam(void)
{
    beam_bends("integrator=symplectic");
    beam_bends("integrator=verlet");
}

static const char drop[] = "dp = 2 mm\nend_time = 1\n"
                           "[fluid water]\nshape = box 0, 0, 20 mm, 20 mm\nsound_speed = 10\n"
                           "artificial_viscosity = 0.1\n"
                           "[domain]\nlower = -0.1, -0.1\nupper = 0.1, 0.1\n";

/* A drop in a uniform field of force falls freely. */
static void a_drop_falls(void)
{
    static double g[2] = {1, -5};
    a = create(drop, NULL);
    b = create(drop, NULL);
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_set_force(a, SPHFSI_FLUID, weight, g));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_advance(a, 0.05));
    const double *vx = field(a, SPHFSI_FLUID, "vx"), *vy = field(a, SPHFSI_FLUID, "vy");
    for (int64_t i = 0; i < sphfsi_count(a, SPHFSI_FLUID); i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.05, vx[i]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, -0.25, vy[i]);
    }
    /* Taken away it acts no more. */
    const int before = calls;
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_set_force(a, SPHFSI_FLUID, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_advance(a, 0.06));
    TEST_ASSERT_EQUAL_INT(before, calls);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0.05, field(a, SPHFSI_FLUID, "vx")[0]);
}

static void forces_act_on_what_is_there(void)
{
    a = create(drop, NULL);
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_set_force(a, SPHFSI_SOLID, weight, NULL));
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_set_force(a, SPHFSI_WALL, weight, NULL));
    TEST_ASSERT_NOT_NULL(strstr(sphfsi_error(), "not on wall"));
}

/* --- motions --- */

static const char piston[] =
    "dp = 5 mm\nend_time = 1\ngravity = 0, -9.81\n"
    "[fluid water]\nshape = box 0, 0, 0.1, 0.05\nmax_speed = 1\nsurface = 0.05\n"
    "[wall floor]\nshape = box -0.1, -20 mm, 0.3, 0\n"
    "[wall piston]\nshape = box -20 mm, 0, 0, 0.1\nmotion = push\n"
    "[motion push]\nx = t*(0.2 + 1.5*t)\n"
    "[probe P]\nquantity = force\nbody = piston\n"
    "[domain]\nlower = -0.2, -0.1\nupper = 0.4, 0.3\n";

static void pushing(void *context, double t, double d[2], double v[2], double acc[2])
{
    (void)context;
    d[0] = t * (0.2 + 1.5 * t);
    v[0] = 0.2 + 3 * t;
    acc[0] = 3;
}

static void a_motion_of_the_program(void)
{
    a = create(piston, "motion push.x=0");
    b = create(piston, NULL);
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_set_motion(a, "push", pushing, NULL));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_advance(a, 0.02));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_advance(b, 0.02));
    same_field(SPHFSI_WALL, "x", 1e-12);
    double force[2][SPHFSI_PROBE_COLUMNS];
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_probe(a, "P", force[0]));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_probe(b, "P", force[1]));
    TEST_ASSERT_TRUE(force[1][0] < -5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, force[1][0], force[0][0]);
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_set_motion(a, "pusch", pushing, NULL));
    TEST_ASSERT_NOT_NULL(strstr(sphfsi_error(), "did you mean `push`"));
}

static void lost_after_a_while(void *context, double t, double d[2], double v[2], double acc[2])
{
    pushing(context, t, d, v, acc);
    if (t > 0.01) d[0] = (double)NAN;
}

/* The fluid would not feel a wall that is nowhere, and go on. */
static void a_motion_to_nowhere_is_stopped(void)
{
    a = create(piston, NULL);
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_set_motion(a, "push", lost_after_a_while, NULL));
    TEST_ASSERT_EQUAL_INT(SPHFSI_GUARD, sphfsi_advance(a, 0.02));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(sphfsi_error(), "[motion push] gives [wall piston]"),
                                 sphfsi_error());
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.01, sphfsi_time(a));
}

static void an_unknown_probe_names_the_nearest(void)
{
    double values[SPHFSI_PROBE_COLUMNS];
    a = create(tiny_case, NULL);
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_probe(a, "M2", values));
    TEST_ASSERT_NOT_NULL(strstr(sphfsi_error(), "did you mean `M1`"));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_probe(a, "P", values));
    TEST_ASSERT_DOUBLE_WITHIN(30, 1000 * 9.81 * 0.08, values[0]);
}

/* --- threads --- */

enum { WORKERS = 2 };

struct worker {
    pthread_t thread;
    char folder[600];
    const char *set;
    uint64_t hash[2];
    enum sphfsi_status status;
};

/* A run with all its files, and a simulation stepped beside another thread's. */
static void *work(void *context)
{
    struct worker *const w = context;
    struct sphfsi_simulation *s;
    const struct sphfsi_options o = {
        .case_text = tiny_case, .sets = &w->set, .n_sets = 1, .threads = 1, .out = w->folder};
    w->status = sphfsi_run(&o);
    for (int k = 0; k < 2 && !w->status; k++) {
        w->status = sphfsi_create(&s, &o);
        if (!w->status) w->status = sphfsi_advance(s, 0.003);
        w->hash[k] = w->status ? 0 : sphfsi_hash(s);
        sphfsi_free(s);
    }
    return NULL;
}

static void simulations_in_two_threads(void)
{
    static const char *const sets[WORKERS] = {"gate.young=1e6", "gate.young=3e6"};
    struct worker w[WORKERS] = {0};
    for (int k = 0; k < WORKERS; k++) {
        w[k].set = sets[k];
        snprintf(w[k].folder, sizeof w[k].folder, "%s/thread%d", tiny_folder(), k);
        TEST_ASSERT_EQUAL_INT(0, pthread_create(&w[k].thread, NULL, work, &w[k]));
    }
    for (int k = 0; k < WORKERS; k++) pthread_join(w[k].thread, NULL);
    for (int k = 0; k < WORKERS; k++) {
        TEST_ASSERT_EQUAL_INT(SPHFSI_OK, w[k].status);
        a = create(tiny_case, sets[k]);
        TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_advance(a, 0.003));
        TEST_ASSERT_TRUE(sphfsi_hash(a) == w[k].hash[0] && w[k].hash[0] == w[k].hash[1]);
        tearDown();
    }
    TEST_ASSERT_FALSE(w[0].hash[0] == w[1].hash[0]);
}

/* The sentence of a failure belongs to its thread. */
static void *fail_here(void *context)
{
    const struct sphfsi_options o = {.case_path = "/nowhere.cfg"};
    *(int *)context = strlen(sphfsi_error()) == 0 && sphfsi_create(&b, &o) == SPHFSI_INPUT;
    return NULL;
}

static void errors_belong_to_their_thread(void)
{
    pthread_t thread;
    int fresh = 0;
    const struct sphfsi_options o = {.case_path = "/elsewhere.cfg"};
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_create(&a, &o));
    TEST_ASSERT_EQUAL_INT(0, pthread_create(&thread, NULL, fail_here, &fresh));
    pthread_join(thread, NULL);
    TEST_ASSERT_EQUAL_INT(1, fresh);
    TEST_ASSERT_NOT_NULL(strstr(sphfsi_error(), "/elsewhere.cfg"));
}

/* --- what is refused --- */

/* After a guard the state can be read, not stepped. */
static void a_stopped_simulation_stays_as_it_is(void)
{
    a = create(tiny_case, "numerics.fixed_step=5e-3");
    enum sphfsi_status e = SPHFSI_OK;
    while (e == SPHFSI_OK) e = sphfsi_step(a, 1);
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_GUARD, e, sphfsi_error());
    const double time = sphfsi_time(a);
    const int64_t steps = sphfsi_steps(a);
    const uint64_t hash = sphfsi_hash(a);
    TEST_ASSERT_EQUAL_INT(SPHFSI_GUARD, sphfsi_step(a, 1));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(sphfsi_error(),
                                        "step: this simulation was stopped because its "
                                        "state is not valid"),
                                 sphfsi_error());
    TEST_ASSERT_EQUAL_INT(SPHFSI_GUARD, sphfsi_advance(a, 1));
    TEST_ASSERT_TRUE(sphfsi_time(a) == time && sphfsi_steps(a) == steps && sphfsi_hash(a) == hash);
    TEST_ASSERT_NOT_NULL(field(a, SPHFSI_FLUID, "x"));
}

static void refused(enum sphfsi_status status, const char *why)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_INPUT, status, why);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(sphfsi_error(), why), sphfsi_error());
}

static void options_out_of_range_are_refused(void)
{
    static char long_path[6000];
    const double until[] = {-1, 1.1e9, (double)NAN};
    struct sphfsi_options o = {.case_text = tiny_case, .threads = 1};
    for (int k = 0; k < 3; k++) {
        o.until = until[k];
        refused(sphfsi_create(&a, &o), "must be above 0 and at most 1e9 seconds");
    }
    o.until = 0;
    o.threads = -1;
    refused(sphfsi_create(&a, &o), "threads = -1: use 1 or more");
    o.threads = 1;
    memset(long_path, 'a', sizeof long_path - 1);
    o.out = long_path;
    refused(sphfsi_run(&o), "folder of the run: the path has 5999 characters");
    o.out = "";
    refused(sphfsi_run(&o), "folder of the run: the path has 0 characters");
    o.out = NULL;
    o.case_path = "/tmp/..cfg";
    refused(sphfsi_run(&o), "/tmp/..cfg: '.' cannot be the name of the folder of results");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_weight_bends_a_beam);
    RUN_TEST(a_drop_falls);
    RUN_TEST(forces_act_on_what_is_there);
    RUN_TEST(a_motion_of_the_program);
    RUN_TEST(a_motion_to_nowhere_is_stopped);
    RUN_TEST(an_unknown_probe_names_the_nearest);
    RUN_TEST(simulations_in_two_threads);
    RUN_TEST(errors_belong_to_their_thread);
    RUN_TEST(a_stopped_simulation_stays_as_it_is);
    RUN_TEST(options_out_of_range_are_refused);
    return UNITY_END();
}
