/* SPDX-License-Identifier: MIT
 * The library as a guest of another program: that program's locale, threads and mistakes. */
#include "sphfsi.h"
#include "tiny.h"
#include "unity.h"

#include <locale.h>
#include <math.h>
#ifdef _OPENMP
#include <omp.h>
#endif
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct sphfsi_simulation *a, *b;

static struct sphfsi_simulation *create(const char *text, int threads)
{
    struct sphfsi_simulation *s;
    const struct sphfsi_options o = {.case_text = text, .threads = threads};
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_create(&s, &o), sphfsi_error());
    return s;
}

void setUp(void) {}

void tearDown(void)
{
    sphfsi_free(a);
    sphfsi_free(b);
    a = b = NULL;
    setlocale(LC_ALL, "C");
}

/* --- locale --- */

static const char comma_locale[] = "comment_char %\nescape_char /\n"
                                   "LC_NUMERIC\ndecimal_point \"<U002C>\"\n"
                                   "thousands_sep \"<U002E>\"\ngrouping 3;3\nEND LC_NUMERIC\n";

/* A locale with a comma: a real one, else one made for the test. */
static bool use_comma(void)
{
    static const char *const known[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE"};
    for (size_t k = 0; k < sizeof known / sizeof known[0]; k++)
        if (setlocale(LC_ALL, known[k])) return true;
    char command[2000];
    FILE *const file = fopen(tiny_path("comma"), "w");
    if (!file) return false;
    fputs(comma_locale, file);
    fclose(file);
    snprintf(command, sizeof command, "localedef -c -i %s %s/xx_XX >%s 2>&1", tiny_path("comma"),
             tiny_folder(), tiny_path("localedef.log"));
    if (system(command) == -1) return false;
    setenv("LOCPATH", tiny_folder(), 1);
    return setlocale(LC_NUMERIC, "xx_XX");
}

static const char *one_and_a_half(void)
{
    static char text[16];
    snprintf(text, sizeof text, "%.1f", 1.5);
    return text;
}

static int said;

static void message_in_host(void *context, enum sphfsi_message kind, const char *text)
{
    (void)context, (void)kind;
    said++;
    TEST_ASSERT_EQUAL_STRING("1,5", one_and_a_half());
    TEST_ASSERT_NULL(strstr(text, "0,"));
}

static void progress_in_host(void *context, const struct sphfsi_progress *p)
{
    (void)context, (void)p;
    said++;
    TEST_ASSERT_EQUAL_STRING("1,5", one_and_a_half());
}

static struct sphfsi_options run_to(const char *name)
{
    return (struct sphfsi_options){.case_text = tiny_case,
                                   .threads = 1,
                                   .until = 0.0015,
                                   .out = tiny_path(name)};
}

static char *content(const char *folder, const char *name)
{
    static char text[2][1 << 16];
    static int which;
    char path[900];
    which = !which;
    snprintf(path, sizeof path, "%s/%s", tiny_path(folder), name);
    FILE *const file = fopen(path, "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    const size_t n = fread(text[which], 1, sizeof text[0] - 1, file);
    fclose(file);
    text[which][n] = '\0';
    return text[which];
}

static void numbers_have_a_point_in_any_locale(void)
{
    struct sphfsi_options o = run_to("point");
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_run(&o), sphfsi_error());
    if (!use_comma()) TEST_IGNORE_MESSAGE("no locale with a comma here, and none could be made");
    TEST_ASSERT_EQUAL_STRING("1,5", one_and_a_half());
    o = run_to("comma-run");
    o.message = message_in_host;
    o.progress = progress_in_host;
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_run(&o), sphfsi_error());
    TEST_ASSERT_TRUE(said > 0);
    TEST_ASSERT_EQUAL_STRING("1,5", one_and_a_half());
    static const char *const files[] = {"probes.csv", "ledger.csv", "case.cfg"};
    for (size_t k = 0; k < sizeof files / sizeof files[0]; k++)
        TEST_ASSERT_EQUAL_STRING_MESSAGE(content("point", files[k]), content("comma-run", files[k]),
                                         files[k]);
    TEST_ASSERT_NOT_NULL(strstr(content("comma-run", "summary.json"), "\"end_time\": 0.0015,"));
    o.restart = 1; /* reads its files again */
    o.until = 0.002;
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_run(&o), sphfsi_error());
    a = create(tiny_case, 1);
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_step(a, -0.5));
    TEST_ASSERT_NOT_NULL(strstr(sphfsi_error(), "-0.5 s"));
}

/* --- threads --- */

static int threads_offered(void)
{
#ifdef _OPENMP
    return omp_get_max_threads();
#else
    return 1;
#endif
}

static void threads_of_the_program_stay(void)
{
    const int before = threads_offered();
#ifdef _OPENMP
    omp_set_num_threads(3);
#endif
    const int own = threads_offered();
    a = create(tiny_case, 2);
    TEST_ASSERT_EQUAL_INT(own, threads_offered());
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_advance(a, 0.001));
    TEST_ASSERT_EQUAL_INT(own, threads_offered());
    struct sphfsi_options o = run_to("threads");
    o.threads = 2;
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_run(&o), sphfsi_error());
    TEST_ASSERT_EQUAL_INT(own, threads_offered());
    TEST_ASSERT_NOT_NULL(strstr(content("threads", "summary.json"),
                                own == 1 ? "\"threads\": 1," : "\"threads\": 2,"));
    o.threads = 1;
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_cite(&o), sphfsi_error());
    TEST_ASSERT_EQUAL_INT(own, threads_offered());
#ifdef _OPENMP
    omp_set_num_threads(before);
#endif
    (void)before;
}

/* A plate whose clamp and a wall that it touches follow motions of the program. */
static const char clapper[] =
    "dp = 2 mm\nend_time = 1\ngravity = 0, 0\n"
    "[solid plate]\nshape = box 0, 0, 12 mm, 60 mm\nclamp = box 0, 0, 12 mm, 8 mm\n"
    "clamp_motion = shake\ndensity = 1000\nyoung = 1e5\npoisson = 0.3\n"
    "[wall block]\nshape = box 12 mm, 50 mm, 20 mm, 58 mm\nmotion = push\n"
    "[motion shake]\nx = 1 mm*sin(40*pi*t)\n"
    "[motion push]\nx = -1 mm*sin(40*pi*t)\n"
    "[contact all]\n"
    "[domain]\nlower = -0.1, -0.1\nupper = 0.1, 0.2\n"
    "[numerics]\nfixed_step = 20 us\n";

struct caller {
    pthread_t thread;
    int calls, elsewhere, in_parallel, other_threads;
    double sign;
};

static void sine(void *context, double t, double d[2], double v[2], double acc[2])
{
    struct caller *const c = context;
    const double w = 2 * acos(-1.0) * 20;
    c->calls++;
    c->elsewhere += !pthread_equal(c->thread, pthread_self());
#ifdef _OPENMP
    c->in_parallel += omp_in_parallel();
    c->other_threads += omp_get_max_threads() != 3;
#endif
    d[0] = c->sign * 1e-3 * sin(w * t);
    v[0] = c->sign * 1e-3 * w * cos(w * t);
    acc[0] = -c->sign * 1e-3 * w * w * sin(w * t);
}

static void callbacks_are_on_the_callers_thread(void)
{
    struct caller shake = {.thread = pthread_self(), .sign = 1}, push = shake;
    push.sign = -1;
#ifdef _OPENMP
    const int before = threads_offered();
    omp_set_num_threads(3);
#endif
    a = create(clapper, 2);
    b = create(clapper, 2);
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_set_motion(a, "shake", sine, &shake));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_set_motion(a, "push", sine, &push));
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_advance(a, 0.01), sphfsi_error());
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_advance(b, 0.01), sphfsi_error());
#ifdef _OPENMP
    omp_set_num_threads(before);
#endif
    TEST_ASSERT_TRUE(shake.calls > 400 && push.calls > 400);
    TEST_ASSERT_EQUAL_INT(0, shake.elsewhere + push.elsewhere);
    TEST_ASSERT_EQUAL_INT(0, shake.in_parallel + push.in_parallel);
    TEST_ASSERT_EQUAL_INT(0, shake.other_threads + push.other_threads);
    struct sphfsi_view x, y;
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_field(a, SPHFSI_SOLID, "ux", &x));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_field(b, SPHFSI_SOLID, "ux", &y));
    for (int64_t i = 0; i < x.count; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, ((const double *)y.data)[i], ((const double *)x.data)[i]);
}

/* --- fields --- */

static double sum_of(enum sphfsi_kind kind, const char *name)
{
    struct sphfsi_view v;
    double sum = 0;
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_field(a, kind, name, &v), sphfsi_error());
    for (int64_t i = 0; i < v.count; i++) sum += ((const double *)v.data)[i];
    return sum;
}

static void the_force_of_the_fluid_is_that_of_now(void)
{
    static const char force[] = "\n[probe F]\nquantity = force\nbody = gate\n";
    char text[4096];
    double F[SPHFSI_PROBE_COLUMNS];
    snprintf(text, sizeof text, "%s%s", tiny_case, force);
    a = create(text, 1);
    for (int k = 0; k < 40; k++) {
        TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_step(a, 1));
        const double fx = sum_of(SPHFSI_SOLID, "fx"), fy = sum_of(SPHFSI_SOLID, "fy");
        TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_probe(a, "F", F), sphfsi_error());
        TEST_ASSERT_TRUE(fabs(F[0]) > 1);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9 * fabs(F[0]), F[0], fx);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9 * fabs(F[0]), F[1], fy);
    }
}

static void fields_are_listed(void)
{
    static const char *const of_files[] = {"velocity", "density",   "pressure",     "stress",
                                           "id",       "von_mises", "displacement", "det_F"};
    a = create(tiny_case, 1);
    b = create(tiny_case, 1);
    int found = 0;
    for (int k = 0; k < 20; k++) {
        TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_step(a, 1));
        TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_step(b, 1));
        for (int kind = 0; kind < 3; kind++) {
            const char *name;
            for (int n = 0; (name = sphfsi_field_name(a, (enum sphfsi_kind)kind, n)); n++) {
                struct sphfsi_view v;
                TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK,
                                              sphfsi_field(a, (enum sphfsi_kind)kind, name, &v),
                                              name);
                TEST_ASSERT_TRUE(v.data && v.count == sphfsi_count(a, (enum sphfsi_kind)kind));
                for (size_t f = 0; f < sizeof of_files / sizeof of_files[0]; f++)
                    found += kind == SPHFSI_SOLID && strcmp(name, of_files[f]) == 0;
            }
        }
    }
    TEST_ASSERT_EQUAL_INT(20 * (int)(sizeof of_files / sizeof of_files[0]), found);
    TEST_ASSERT_TRUE(sphfsi_hash(a) == sphfsi_hash(b)); /* looking changes nothing */
}

static void fields_of_files_have_their_values(void)
{
    struct sphfsi_view velocity, vx, density, dens;
    a = create(tiny_case, 1);
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_advance(a, 0.002));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_field(a, SPHFSI_FLUID, "velocity", &velocity));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_field(a, SPHFSI_FLUID, "vx", &vx));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_field(a, SPHFSI_FLUID, "density", &density));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_field(a, SPHFSI_FLUID, "dens", &dens));
    TEST_ASSERT_EQUAL_INT(3, velocity.components);
    TEST_ASSERT_EQUAL_INT(1, vx.components);
    TEST_ASSERT_EQUAL_STRING("kg/m^3", density.unit);
    for (int64_t i = 0; i < vx.count; i++) {
        TEST_ASSERT_TRUE(((const double *)velocity.data)[3 * i] == ((const double *)vx.data)[i]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1000 * (1 + ((const double *)dens.data)[i]),
                                  ((const double *)density.data)[i]);
    }
    TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, sphfsi_field(a, SPHFSI_FLUID, "stress", &velocity));
    TEST_ASSERT_NULL(sphfsi_field_name(a, SPHFSI_FLUID, 1000));
}

/* --- mistakes --- */

static struct sphfsi_simulation *inside;
static enum sphfsi_status answer[6];

static void call_back(void *context, const struct sphfsi_particles *p, double *ax, double *ay)
{
    double values[SPHFSI_PROBE_COLUMNS];
    struct sphfsi_view v;
    (void)context, (void)ax, (void)ay;
    answer[0] = sphfsi_free(inside);
    answer[1] = sphfsi_step(inside, 1);
    answer[2] = sphfsi_field(inside, SPHFSI_FLUID, "p", &v);
    answer[3] = sphfsi_probe(inside, "M1", values);
    answer[4] = sphfsi_set_force(inside, SPHFSI_FLUID, NULL, NULL);
    answer[5] = sphfsi_advance(inside, 1);
    TEST_ASSERT_TRUE(sphfsi_hash(inside) == 0);
    TEST_ASSERT_TRUE(sphfsi_count(inside, SPHFSI_FLUID) == p->n && sphfsi_time(inside) >= 0);
}

static void a_callback_may_not_use_its_simulation(void)
{
    a = inside = create(tiny_case, 1);
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_set_force(a, SPHFSI_FLUID, call_back, NULL));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_step(a, 1));
    for (int k = 0; k < 6; k++) TEST_ASSERT_EQUAL_INT(SPHFSI_INPUT, answer[k]);
    TEST_ASSERT_NOT_NULL(strstr(sphfsi_error(), "in use by another call"));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_set_force(a, SPHFSI_FLUID, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_step(a, 1));
}

static void uniform(void *context, const struct sphfsi_particles *p, double *ax, double *ay)
{
    const double *const g = context;
    for (int64_t i = 0; i < p->n; i++) {
        ax[i] += g[0];
        ay[i] += g[1];
    }
}

/* What was found when somebody looked is not taken for what holds with a new force. */
static void a_force_holds_from_the_next_step(void)
{
    static struct sphfsi_view p;
    a = create(tiny_case, 1);
    b = create(tiny_case, 1);
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_field(a, SPHFSI_FLUID, "p", &p));
    static const double g[2] = {5, 0};
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK,
                          sphfsi_set_force(a, SPHFSI_FLUID, uniform, (void *)(uintptr_t)g));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK,
                          sphfsi_set_force(b, SPHFSI_FLUID, uniform, (void *)(uintptr_t)g));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_step(a, 1));
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_step(b, 1));
    TEST_ASSERT_TRUE(sphfsi_hash(a) == sphfsi_hash(b));
}

#define REFUSED(call)                                                 \
    do {                                                              \
        TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_INPUT, (call), #call);   \
        TEST_ASSERT_TRUE_MESSAGE(strlen(sphfsi_error()) > 10, #call); \
    } while (0)

static void null_is_refused(void)
{
    struct sphfsi_simulation *none = NULL;
    struct sphfsi_view v;
    double values[SPHFSI_PROBE_COLUMNS];
    const struct sphfsi_options o = {.case_text = tiny_case}, empty = {0};
    a = create(tiny_case, 1);
    REFUSED(sphfsi_create(NULL, &o));
    REFUSED(sphfsi_create(&none, NULL));
    REFUSED(sphfsi_create(&none, &empty));
    REFUSED(sphfsi_step(NULL, 1));
    REFUSED(sphfsi_step(a, (double)NAN));
    REFUSED(sphfsi_advance(NULL, 1));
    REFUSED(sphfsi_advance(a, (double)NAN));
    REFUSED(sphfsi_advance(a, (double)INFINITY));
    REFUSED(sphfsi_field(NULL, SPHFSI_FLUID, "x", &v));
    REFUSED(sphfsi_field(a, SPHFSI_FLUID, NULL, &v));
    REFUSED(sphfsi_field(a, SPHFSI_FLUID, "x", NULL));
    REFUSED(sphfsi_field(a, (enum sphfsi_kind)(-1), "x", &v));
    REFUSED(sphfsi_probe(NULL, "M1", values));
    REFUSED(sphfsi_probe(a, NULL, values));
    REFUSED(sphfsi_probe(a, "M1", NULL));
    REFUSED(sphfsi_set_force(NULL, SPHFSI_FLUID, NULL, NULL));
    REFUSED(sphfsi_set_force(a, (enum sphfsi_kind)9, NULL, NULL));
    REFUSED(sphfsi_set_motion(NULL, "x", NULL, NULL));
    REFUSED(sphfsi_set_motion(a, NULL, NULL, NULL));
    REFUSED(sphfsi_run(NULL));
    REFUSED(sphfsi_run(&empty));
    REFUSED(sphfsi_explain(NULL));
    REFUSED(sphfsi_explain_json(NULL));
    REFUSED(sphfsi_effective(NULL, "/dev/null"));
    REFUSED(sphfsi_effective(&o, NULL));
    REFUSED(sphfsi_preview(NULL));
    REFUSED(sphfsi_cite(NULL));
    REFUSED(sphfsi_keys(NULL));
    REFUSED(sphfsi_keys_json(NULL));
    REFUSED(sphfsi_inspect(NULL, &o));
    REFUSED(sphfsi_inspect("/dev/null", NULL));
    TEST_ASSERT_NULL(none);
}

static void what_is_out_of_range_has_an_answer(void)
{
    static const char *const one[] = {NULL};
    struct sphfsi_options o = {.case_text = tiny_case, .n_sets = 1};
    struct sphfsi_simulation *none;
    REFUSED(sphfsi_create(&none, &o));
    o.sets = one;
    REFUSED(sphfsi_create(&none, &o));
    o.n_sets = -1;
    REFUSED(sphfsi_create(&none, &o));
    TEST_ASSERT_EQUAL_INT(2, sphfsi_exit_status((enum sphfsi_status)99, 0));
    TEST_ASSERT_EQUAL_INT(2, sphfsi_exit_status((enum sphfsi_status)(-1), 0));
    TEST_ASSERT_EQUAL_INT(130, sphfsi_exit_status(SPHFSI_INTERRUPT, -5));
    TEST_ASSERT_NULL(sphfsi_template_name(-1));
    TEST_ASSERT_NULL(sphfsi_template_name(1000000));
    TEST_ASSERT_NULL(sphfsi_template(NULL));
    TEST_ASSERT_TRUE(isnan(sphfsi_time(NULL)) && isnan(sphfsi_end_time(NULL)) &&
                     isnan(sphfsi_time_step(NULL)) && isnan(sphfsi_next_output(NULL)));
    TEST_ASSERT_TRUE(sphfsi_steps(NULL) == 0 && sphfsi_count(NULL, SPHFSI_FLUID) == 0 &&
                     sphfsi_hash(NULL) == 0);
    TEST_ASSERT_NULL(sphfsi_field_name(NULL, SPHFSI_FLUID, 0));
    a = create(tiny_case, 1);
    TEST_ASSERT_NULL(sphfsi_field_name(a, SPHFSI_FLUID, -1));
    TEST_ASSERT_NULL(sphfsi_field_name(a, (enum sphfsi_kind)3, 0));
    TEST_ASSERT_TRUE(sphfsi_count(a, (enum sphfsi_kind)3) == 0);
}

static char json[1 << 16];
static void keep_json(void *context, enum sphfsi_message kind, const char *text)
{
    (void)context;
    if (kind == SPHFSI_NOTE) snprintf(json, sizeof json, "%s", text);
}

static void explain_is_data_too(void)
{
    static const char *const sets[] = {"fluid water.density=50"};
    const struct sphfsi_options o = {
        .case_text = tiny_case, .threads = 1, .message = keep_json, .sets = sets, .n_sets = 1};
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_explain_json(&o), sphfsi_error());
    TEST_ASSERT_TRUE(json[0] == '{');
    const char *const warnings = strstr(json, "\"warnings\": [");
    TEST_ASSERT_NOT_NULL(warnings);
    TEST_ASSERT_NOT_NULL(strstr(warnings, "less than any liquid"));
    TEST_ASSERT_NOT_NULL(strstr(json, "\"fluid\": 100"));
    TEST_ASSERT_NOT_NULL(strstr(json, "\"effects\": "));
    TEST_ASSERT_NOT_NULL(strstr(json, "\"wall_seconds\": "));
    TEST_ASSERT_EQUAL_STRING("}\n", json + strlen(json) - 2);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(numbers_have_a_point_in_any_locale);
    RUN_TEST(threads_of_the_program_stay);
    RUN_TEST(callbacks_are_on_the_callers_thread);
    RUN_TEST(the_force_of_the_fluid_is_that_of_now);
    RUN_TEST(fields_are_listed);
    RUN_TEST(fields_of_files_have_their_values);
    RUN_TEST(a_callback_may_not_use_its_simulation);
    RUN_TEST(a_force_holds_from_the_next_step);
    RUN_TEST(null_is_refused);
    RUN_TEST(what_is_out_of_range_has_an_answer);
    RUN_TEST(explain_is_data_too);
    return UNITY_END();
}
