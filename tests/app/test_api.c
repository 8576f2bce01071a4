/* SPDX-License-Identifier: MIT
 * The public header, used as a program would. */
#include "sphfsi.h"
#include "rig.h"
#include "tiny.h"
#include "unity.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static struct sphfsi_simulation *s;
static struct rig rig;
static int warnings, notes;

static void on_message(void *context, enum sphfsi_message kind, const char *text)
{
    (void)context, (void)text;
    *(kind == SPHFSI_WARNING ? &warnings : &notes) += 1;
}

static struct sphfsi_options tiny_options(void)
{
    return (struct sphfsi_options){.case_text = tiny_case, .message = on_message};
}

void setUp(void)
{
    const struct sphfsi_options o = tiny_options();
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_create(&s, &o), sphfsi_error());
}

void tearDown(void)
{
    sphfsi_free(s);
    s = NULL;
}

static void counts_and_times(void)
{
    TEST_ASSERT_TRUE(sphfsi_count(s, SPHFSI_FLUID) == 100);
    TEST_ASSERT_TRUE(sphfsi_count(s, SPHFSI_WALL) > 0 && sphfsi_count(s, SPHFSI_SOLID) == 45);
    TEST_ASSERT_TRUE(sphfsi_time(s) == 0 && sphfsi_end_time(s) == 0.02 && sphfsi_steps(s) == 0);
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_step(s, 1));
    TEST_ASSERT_TRUE(sphfsi_time(s) == sphfsi_time_step(s) && sphfsi_steps(s) == 1);
}

static void advance_hits_the_time(void)
{
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_advance(s, 0.00123));
    TEST_ASSERT_TRUE(sphfsi_time(s) == 0.00123);
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_advance(s, 0.00123));
    TEST_ASSERT_NOT_NULL(strstr(sphfsi_error(), "0.00123"));
}

static void fields_are_views(void)
{
    struct sphfsi_view x, id, again;
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_field(s, SPHFSI_FLUID, "x", &x));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_field(s, SPHFSI_FLUID, "x", &again));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_field(s, SPHFSI_FLUID, "id", &id));
    TEST_ASSERT_TRUE(x.data == again.data);
    TEST_ASSERT_TRUE(x.count == 100 && x.type == SPHFSI_DOUBLE && id.type == SPHFSI_INT64);
    TEST_ASSERT_EQUAL_STRING("m", x.unit);
    for (int64_t k = 0; k < x.count; k++) {
        const double at = ((const double *)x.data)[k];
        TEST_ASSERT_TRUE(at > 0 && at < 0.1);
    }
}

static void pressure_is_up_to_date(void)
{
    struct sphfsi_view p;
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_field(s, SPHFSI_FLUID, "p", &p));
    double most = 0;
    for (int64_t k = 0; k < p.count; k++)
        if (((const double *)p.data)[k] > most) most = ((const double *)p.data)[k];
    TEST_ASSERT_DOUBLE_WITHIN(30, 1000 * 9.81 * 0.095, most);
}

/* The default integrator exchanges its arrays of rates after each step. */
static void rates_are_up_to_date(void)
{
    struct sphfsi_view rate;
    double seen[100];
    for (int k = 0; k < 3; k++) TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_step(s, 1));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_field(s, SPHFSI_FLUID, "ddens", &rate));
    TEST_ASSERT_TRUE(rate.count == 100);
    memcpy(seen, rate.data, sizeof seen);
    sphfsi_hash(s); /* evaluates */
    TEST_ASSERT_EQUAL_MEMORY(seen, rate.data, sizeof seen);
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_step(s, 1));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_field(s, SPHFSI_FLUID, "ddens", &rate));
    TEST_ASSERT_TRUE(memcmp(seen, rate.data, sizeof seen) != 0);
}

/* The force on a structure is that of the fluid at the present positions, neither what the coupling
 * weighs nor that of the last step: as the sweeps find it in the same state. */
static void force_on_solids_is_the_present_one(void)
{
    static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                              "integrator=leapfrog"};
    for (size_t k = 0; k < sizeof integrators / sizeof *integrators; k++) {
        tearDown();
        struct sphfsi_options o = tiny_options();
        const char *const sets[] = {"scheme=paper", integrators[k]};
        o.sets = sets;
        o.n_sets = 2;
        TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_create(&s, &o));
        rig_open(&rig, tiny_case, integrators[k], NULL);
        for (int step = 0; step < 40; step++) {
            TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_step(s, 1));
            rig_steps(&rig, 1, 1);
        }
        struct sphfsi_view x;
        TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_field(s, SPHFSI_FLUID, "x", &x));
        TEST_ASSERT_TRUE(sphfsi_time(s) == rig.sim.state.time);
        for (int64_t i = 0; i < x.count; i++)
            TEST_ASSERT_TRUE(((const double *)x.data)[i] == rig.sim.particles[KIND_FLUID].x[i]);
        const struct particles *const particles = &rig.sim.particles[KIND_SOLID];
        double before[64], changed = 0, top = 0;
        TEST_ASSERT_TRUE(particles->n <= 64);
        for (int64_t i = 0; i < particles->n; i++) before[i] = particles->fx[i];
        rig_evaluate(&rig);
        struct sphfsi_view fx, fy;
        TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_field(s, SPHFSI_SOLID, "fx", &fx));
        TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_field(s, SPHFSI_SOLID, "fy", &fy));
        for (int64_t i = 0; i < particles->n; i++) {
            TEST_ASSERT_TRUE(((const double *)fx.data)[i] == particles->fx[i]);
            TEST_ASSERT_TRUE(((const double *)fy.data)[i] == particles->fy[i]);
            changed = fmax(changed, fabs(particles->fx[i] - before[i]));
            top = fmax(top, fabs(particles->fx[i]));
        }
        TEST_ASSERT_TRUE(top > 1 && changed > 1e-6 * top);
        rig_close(&rig);
    }
}

/* A scene without motions, probes, walls or fluid has none to name. */
static void what_is_not_there_has_no_nearest(void)
{
    static const char text[] = "dp = 1 cm\nend_time = 1\n[solid a]\nshape = box 0, 0, 0.1, 0.05\n"
                               "density = 1000\nyoung = 1e6\npoisson = 0.3\n";
    const struct sphfsi_options o = {.case_text = text, .threads = 1};
    double values[SPHFSI_PROBE_COLUMNS];
    tearDown();
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_create(&s, &o));
    TEST_ASSERT_NULL(sphfsi_field_name(s, SPHFSI_FLUID, 0));
    TEST_ASSERT_NOT_NULL(sphfsi_field_name(s, SPHFSI_SOLID, 0));
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_probe(s, "P", values));
    TEST_ASSERT_EQUAL_STRING("probe: the case has no [probe P]", sphfsi_error());
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_set_motion(s, "m", NULL, NULL));
    TEST_ASSERT_EQUAL_STRING("motion: the case has no [motion m]", sphfsi_error());
    TEST_ASSERT_NULL(sphfsi_template("xyzxyzxyz"));
    TEST_ASSERT_NULL(strstr(sphfsi_error(), "nearest"));
    TEST_ASSERT_EQUAL_INT(128 + 15, sphfsi_exit_status(SPHFSI_INTERRUPT, 15));
    TEST_ASSERT_EQUAL_INT(sphfsi_exit_status(SPHFSI_INTERRUPT, 0),
                          sphfsi_exit_status(SPHFSI_INTERRUPT, 128));
}

static char explained[20000];

static void keep_note(void *context, enum sphfsi_message kind, const char *text)
{
    (void)context;
    if (kind == SPHFSI_NOTE) snprintf(explained, sizeof explained, "%s", text);
}

/* Scenes of one kind: only a solid has a step of its own. */
static void lone_bodies_are_explained(void)
{
    static const char *const texts[] = {
        "dp = 1 cm\nend_time = 1e-4\n[fluid w]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\n",
        "dp = 1 cm\nend_time = 1e-4\n[solid a]\nshape = box 0, 0, 0.1, 0.05\ndensity = 1000\n"
        "young = 1e6\npoisson = 0.3\n"};
    for (int k = 0; k < 2; k++) {
        struct sphfsi_options o = {.case_text = texts[k], .threads = 1, .message = keep_note};
        TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_explain_json(&o), sphfsi_error());
        const bool found = strstr(explained, "\"solid_time_step\"") != NULL;
        TEST_ASSERT_EQUAL_INT_MESSAGE(k == 1, found, explained);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(explained, "\"time_step_bound\""), explained);
    }
}

static void an_unknown_field_names_the_nearest(void)
{
    struct sphfsi_view v;
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_field(s, SPHFSI_FLUID, "denz", &v));
    TEST_ASSERT_NOT_NULL(strstr(sphfsi_error(), "dens"));
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_field(s, SPHFSI_FLUID, "ux", &v));
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_field(s, (enum sphfsi_kind)7, "x", &v));
}

static void wrong_input_makes_nothing(void)
{
    struct sphfsi_simulation *none = s;
    struct sphfsi_options o = tiny_options();
    o.case_text = "dp = -1\n";
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_create(&none, &o));
    TEST_ASSERT_NULL(none);
    TEST_ASSERT_TRUE(strlen(sphfsi_error()) > 0);
    o = (struct sphfsi_options){.case_path = "/nowhere.cfg"};
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_create(&none, &o));
    TEST_ASSERT_NOT_NULL(strstr(sphfsi_error(), "/nowhere.cfg"));
    o = (struct sphfsi_options){0};
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_create(&none, &o));
    o = tiny_options();
    o.threads = -1;
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_create(&none, &o));
    sphfsi_free(NULL);
}

static void the_same_input_gives_the_same_bits(void)
{
    struct sphfsi_simulation *twin;
    const struct sphfsi_options o = tiny_options();
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_create(&twin, &o));
    sphfsi_advance(s, 0.002);
    TEST_ASSERT_FALSE(sphfsi_hash(s) == sphfsi_hash(twin));
    sphfsi_advance(twin, 0.002);
    TEST_ASSERT_TRUE(sphfsi_hash(s) == sphfsi_hash(twin));
    sphfsi_free(twin);
}

static int calls, finished;
static void on_progress(void *context, const struct sphfsi_progress *p)
{
    (void)context;
    TEST_ASSERT_TRUE((p->time >= p->end_time || !p->finished) && p->bound != NULL);
    const double done = p->time - p->start_time, left = fmax(0, p->end_time - p->time);
    if (done > 0)
        TEST_ASSERT_DOUBLE_WITHIN(1e-9 * p->wall_seconds / done, p->wall_seconds * left / done,
                                  p->seconds_left);
    calls++;
    finished += p->finished;
}

/* The text of a file of the run, up to 64 KiB of it. */
static const char *content(const char *path)
{
    static char text[1 << 16];
    FILE *const file = fopen(path, "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    return text;
}

static void a_run_writes_its_files(void)
{
    static const char *const names[] = {"summary.json", "probes.csv", "ledger.csv", "case.cfg",
                                        "fields.vtkhdf"};
    struct sphfsi_options o = tiny_options();
    o.out = tiny_path("run");
    o.until = 0.004;
    o.progress = on_progress;
    o.progress_interval = 1e-9;
    notes = 0;
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_run(&o), sphfsi_error());
    TEST_ASSERT_TRUE(calls > 10 && finished == 1 && notes > 0);
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        char path[600];
        struct stat info;
        snprintf(path, sizeof path, "%s/%s", tiny_path("run"), names[k]);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, stat(path, &info), path);
        TEST_ASSERT_TRUE(info.st_size > 0);
    }
    TEST_ASSERT_NOT_NULL(strstr(content(tiny_path("run/probes.csv")), "\n0,"));
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_run(&o));
}

static int checkpoints(const char *folder)
{
    int n = 0;
    DIR *const all = opendir(folder);
    TEST_ASSERT_NOT_NULL(all);
    for (const struct dirent *one; (one = readdir(all));) n += strstr(one->d_name, ".ckpt") != NULL;
    closedir(all);
    return n;
}

/* Within an hour there is one call, the last, and no checkpoint but that at the end. No phase took
 * a negative time. */
static void nothing_is_due_within_an_hour(void)
{
    const char *const sets[] = {"output.checkpoint_minutes=60"};
    struct sphfsi_options o = tiny_options();
    o.out = tiny_path("hour");
    o.until = 0.002;
    o.sets = sets;
    o.n_sets = 1;
    o.progress = on_progress;
    o.progress_interval = 3600;
    calls = 0;
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_run(&o), sphfsi_error());
    TEST_ASSERT_EQUAL_INT(1, calls);
    TEST_ASSERT_EQUAL_INT(1, checkpoints(tiny_path("hour")));
    const char *const text = content(tiny_path("hour/summary.json"));
    const char *const phases = strstr(text, "\"phase_seconds\"");
    TEST_ASSERT_NOT_NULL(phases);
    const char *const end = strchr(phases, '}');
    int n = 0;
    for (const char *at = strchr(phases, '{'); at && at < end; at = strchr(at + 1, ','), n++) {
        double seconds;
        TEST_ASSERT_EQUAL_INT(1, sscanf(at + 1, " \"%*[a-z_]\": %lf", &seconds));
        TEST_ASSERT_TRUE(seconds >= 0);
    }
    TEST_ASSERT_TRUE(n > 3);
}

static void a_path_that_is_too_long(void)
{
    static char path[4096];
    memset(path, 'p', 3900);
    struct sphfsi_options o = tiny_options();
    o.out = path;
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_run(&o));
    TEST_ASSERT_EQUAL_STRING(
        "folder of the run: the path has 3900 characters, but 1 to 3795 are allowed",
        sphfsi_error());
    o.out = "";
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_run(&o));
    TEST_ASSERT_NOT_NULL(strstr(sphfsi_error(), "0 characters"));
}

/* The hash that a run's summary has, as its 16 digits. */
static void hash_of_run(const char *folder, char hash[17])
{
    char path[600], text[8192] = "";
    snprintf(path, sizeof path, "%s/summary.json", folder);
    FILE *const file = fopen(path, "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    const char *const at = strstr(text, "\"state_hash\"");
    TEST_ASSERT_NOT_NULL(at);
    TEST_ASSERT_EQUAL_INT(1, sscanf(at, "\"state_hash\": \"%16[0-9a-f]\"", hash));
}

static void steps_without_a_limit_have_the_bits_of_a_run(void)
{
    struct sphfsi_options o = tiny_options();
    char of_run[17] = "", here[17];
    o.out = tiny_path("bits");
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_run(&o), sphfsi_error());
    hash_of_run(o.out, of_run);
    while (sphfsi_time(s) < sphfsi_end_time(s)) {
        const double next = sphfsi_next_output(s);
        TEST_ASSERT_TRUE(next > sphfsi_time(s) && next <= sphfsi_end_time(s));
        TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_step(s, INFINITY));
    }
    snprintf(here, sizeof here, "%016llx", (unsigned long long)sphfsi_hash(s));
    TEST_ASSERT_EQUAL_STRING(of_run, here);
}

static void probes_have_names(void)
{
    TEST_ASSERT_EQUAL_STRING("M1", sphfsi_probe_name(s, 0));
    TEST_ASSERT_EQUAL_STRING("M1_dx_m", sphfsi_probe_column(s, 0, 0));
    TEST_ASSERT_EQUAL_STRING("M1_dy_m", sphfsi_probe_column(s, 0, 1));
    TEST_ASSERT_NULL(sphfsi_probe_column(s, 0, 2));
    TEST_ASSERT_NULL(sphfsi_probe_column(s, 0, -1));
    TEST_ASSERT_EQUAL_STRING("P_p_Pa", sphfsi_probe_column(s, 2, 0));
    TEST_ASSERT_NULL(sphfsi_probe_name(s, -1));
    TEST_ASSERT_NULL(sphfsi_probe_name(s, 1000));
    TEST_ASSERT_NULL(sphfsi_probe_column(s, 1000, 0));
    TEST_ASSERT_NULL(sphfsi_probe_name(NULL, 0));
    TEST_ASSERT_NULL(sphfsi_probe_column(NULL, 0, 0));
}

static void a_request_stops_a_run(void)
{
    struct sphfsi_requests requests = {.stop = 15};
    struct sphfsi_options o = tiny_options();
    o.out = tiny_path("stopped");
    o.requests = &requests;
    TEST_ASSERT_EQUAL_INT(SPHFSI_INTERRUPT, sphfsi_run(&o));
    TEST_ASSERT_EQUAL_INT(143, sphfsi_exit_status(SPHFSI_INTERRUPT, 15));
    requests.stop = 0;
    o.restart = 1;
    o.until = 0.001;
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_run(&o), sphfsi_error());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(counts_and_times);
    RUN_TEST(advance_hits_the_time);
    RUN_TEST(fields_are_views);
    RUN_TEST(pressure_is_up_to_date);
    RUN_TEST(rates_are_up_to_date);
    RUN_TEST(force_on_solids_is_the_present_one);
    RUN_TEST(what_is_not_there_has_no_nearest);
    RUN_TEST(lone_bodies_are_explained);
    RUN_TEST(an_unknown_field_names_the_nearest);
    RUN_TEST(wrong_input_makes_nothing);
    RUN_TEST(the_same_input_gives_the_same_bits);
    RUN_TEST(a_run_writes_its_files);
    RUN_TEST(nothing_is_due_within_an_hour);
    RUN_TEST(a_path_that_is_too_long);
    RUN_TEST(steps_without_a_limit_have_the_bits_of_a_run);
    RUN_TEST(probes_have_names);
    RUN_TEST(a_request_stops_a_run);
    return UNITY_END();
}
