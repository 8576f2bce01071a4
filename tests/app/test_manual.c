/* SPDX-License-Identifier: MIT
 * What the program says of itself is true: examples are accepted, templates run, sources fit the
 * scene. */
#include "case/effects.h"
#include "app/session.h"
#include "app/embedded.h"
#include "base/csv.h"
#include "check/check.h"
#include "case/params.h"
#include "geometry/scene_points.h"
#include "rig.h"
#include "tiny.h"
#include "unity.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct diag diag;
static int warnings;

static void on_warning(void *context, const char *text)
{
    (void)context;
    (void)text;
    warnings++;
}

void setUp(void)
{
    diag = (struct diag){.warn = on_warning};
    warnings = 0;
}

void tearDown(void) {}

/* --- examples of keys --- */

/* Two sections of each kind, so that `like` and references between them have something to name; the
 * examples go into the second. */
static const char scene_text[] =
    "dp = 2 mm\nend_time = 1\ngravity = 0, -9.81\n"
    "[fluid water]\nshape = box 0.2, 0, 0.3, 0.1\nmax_speed = 3\n"
    "[fluid more]\nlike = water\nshape = box 0.3, 0, 0.4, 0.1\n"
    "[wall floor]\nshape = box -10 mm, -8 mm, 1.1, -4 mm\n"
    "[wall more]\nshape = box 1.12, 0, 1.15, 10 mm\n"
    "[motion lift]\n[motion more]\n"
    "[inflow more]\nfrom = 0.2, 0.1\nto = 0.2, 0\nspeed = 1\n"
    "[outflow more]\nfrom = 0.3, 0.1\nto = 0.2, 0.1\npressure = 0\n"
    "[solid post]\nshape = box 0.5, 0, 0.52, 0.1\ndensity = 1000\nyoung = 1e6\npoisson = 0.3\n"
    "[solid more]\nlike = post\nshape = box 0.7, 0, 0.72, 0.1\n"
    "[rigid raft]\nshape = box 0.85, 0, 0.95, 0.1\ndensity = 500\n"
    "[rigid barge]\nshape = box 0.85, 0.2, 0.95, 0.3\ndensity = 500\n"
    "[damping more]\nto = 1, 1\nrate = 1\n"
    "[table more]\nfile = lift.csv\ncolumn = 2\n"
    "[spring more]\nbody = raft\nto = 1, 1\nstiffness = 1\n"
    "[probe tip]\nbody = post\npoint = 0.51, 0.1\n"
    "[probe more]\nbody = post\npoint = 0.51, 0.1\n"
    "[contact more]\n[load more]\nbody = post\nshape = box 0.5, 0, 0.52, 10 mm\nforce = 1, 0\n"
    "[reference more]\nprobe = tip_dx_m\nformula = 0\n";

/* Beams are beside no fluid. */
static const char beam_text[] =
    "dp = 2 mm\nend_time = 1\n[wall floor]\nshape = box 0.9, 0, 1.1, 4 mm\n[motion lift]\n"
    "[beam plate]\nshape = polyline: 0, 1; 1, 1\nthickness = 1 mm\nyoung = 1e6\nmass = 1\n"
    "[beam more]\nshape = polyline: 0, 0; 1, 0\nclamp = 0.5, 0\nthickness = 1 mm\n"
    "young = 1e6\ndensity = 1000\n"
    "[load more]\nbody = more\nshape = box 0, -0.1, 1, 0.1\nforce = 1, 0\n";

static bool is(const struct param *param, const char *section, const char *key)
{
    return strcmp(section_table[param->section].word, section) == 0 && strcmp(param->key, key) == 0;
}

/* Keys that mean something only beside another one, or at a place of this scene. */
static const char *companion(const struct param *param)
{
    if (is(param, "domain", "lower")) return "domain.upper=2.5,1";
    if (is(param, "domain", "upper")) return "domain.lower=-0.2,-0.1";
    if (is(param, "solid", "minus") || is(param, "solid", "clamp"))
        return "solid more.shape=box 0, 0, 20 mm, 0.1 m";
    if (is(param, "solid", "joined")) return "solid more.shape=box 0.52, 0, 0.54, 0.1";
    if (is(param, "solid", "clamp_motion")) return "solid more.clamp=box 0.7, 0, 0.72, 10 mm";
    if (is(param, "rigid", "minus")) return "rigid raft.shape=box 0.2, 0.3, 0.6, 0.5";
    if (strncmp(param->key, "hinge_", 6) == 0) return "rigid raft.hinge=0.9, 0";
    if (is(param, "probe", "body")) return "probe more.point=0.51,0.1";
    if (is(param, "probe", "point")) return "probe more.quantity=pressure";
    if (is(param, "probe", "to")) return "probe more.quantity=flux";
    if (is(param, "probe", "on")) return "probe more.quantity=pressure";
    if (is(param, "probe", "average")) return "probe more.interval=0.01";
    if (is(param, "reference", "file")) return "reference more.label=x";
    if (is(param, "inflow", "absorb")) return "inflow more.pressure=1";
    return NULL;
}

static void example_is_accepted(const struct param *param)
{
    char example[SCENE_TEXT], set[2 * SCENE_TEXT], text[4096];
    struct scene scene;
    manual_example(param, example, sizeof example);
    if (!example[0]) return;
    const char *const word = section_table[param->section].word;
    /* All fluid is of one kind, so that what the first is given the second takes over. */
    const bool first =
        param->section == SECTION_fluid && param->type != PARAM_SHAPES && param->type != PARAM_TEXT;
    if (param->section == SECTION_top)
        snprintf(set, sizeof set, "%s=%s", param->key, example);
    else
        snprintf(set, sizeof set, "%s%s.%s=%s", word,
                 !section_table[param->section].named ? ""
                 : first                              ? " water"
                 : is(param, "rigid", "like")         ? " barge"
                 : param->section == SECTION_rigid    ? " raft"
                                                      : " more",
                 param->key, example);
    const char *sets[] = {set, companion(param)};
    const bool beam = param->section == SECTION_beam || is(param, "load", "moment");
    snprintf(text, sizeof text, "%s", beam ? beam_text : scene_text);
    if (is(param, "beam", "mass")) *strstr(text, "density") = '#';
    /* Of the two ways to give a reference one is to go, as `body` is where the fluid is probed. */
    if (is(param, "reference", "file")) *strstr(text, "formula") = '#';
    if (is(param, "inflow", "velocity") || is(param, "inflow", "pressure") ||
        is(param, "inflow", "absorb"))
        *strstr(text, "speed = 1") = '#';
    if (is(param, "outflow", "velocity") || is(param, "outflow", "speed") ||
        is(param, "outflow", "level"))
        *strstr(text, "pressure = 0") = '#';
    if (is(param, "rigid", "mass")) *strstr(strstr(text, "[rigid raft]"), "density") = '#';
    if (is(param, "spring", "force")) *strstr(text, "stiffness") = '#';
    if (is(param, "load", "traction")) *strstr(text, "force") = '#';
    if (is(param, "probe", "point") || is(param, "probe", "to") || is(param, "probe", "on"))
        memset(strstr(strstr(text, "[probe more]"), "body = post"), ' ', 11);
    diag.code = ERR_OK;
    const enum err e = scene_load_text(&scene, text, "examples.cfg", sets[1] ? 2 : 1, sets, &diag);
    char why[2048];
    snprintf(why, sizeof why, "%s: %s", set, diag.text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, e, why);
    scene_free(&scene);
}

static void every_example_is_accepted(void)
{
    FILE *const table = fopen("lift.csv", "w"); /* which an example names */
    TEST_ASSERT_NOT_NULL(table);
    fputs("0, 0, 0\n1, 0, 0.1\n", table);
    fclose(table);
    for (int k = 0; k < PARAM_COUNT; k++) example_is_accepted(&param_table[k]);
    remove("lift.csv");
}

/* --- traps --- */

/* Regions are not taken over by `like`, and a clamp is one. */
static void a_copy_without_its_clamp_is_warned_of(void)
{
    static const char posts[] =
        "dp = 2 mm\nend_time = 1\n"
        "[solid left]\nshape = box 0, 0, 20 mm, 0.1\nclamp = box 0, 0, 20 mm, 8 mm\n"
        "density = 1000\nyoung = 1e6\npoisson = 0.3\n"
        "[solid right]\nlike = left\nshape = box 0.1, 0, 0.12, 0.1\n";
    const char *const mended = "right.clamp=box 0.1, 0, 0.12, 8 mm";
    struct scene scene;
    TEST_ASSERT_EQUAL_INT(ERR_OK, scene_load_text(&scene, posts, "posts.cfg", 0, NULL, &diag));
    TEST_ASSERT_EQUAL_INT(ERR_OK, check_scene(&scene, &diag));
    scene_free(&scene);
    TEST_ASSERT_EQUAL_INT(1, warnings);
    TEST_ASSERT_EQUAL_INT(ERR_OK, scene_load_text(&scene, posts, "posts.cfg", 1, &mended, &diag));
    TEST_ASSERT_EQUAL_INT(ERR_OK, check_scene(&scene, &diag));
    scene_free(&scene);
    TEST_ASSERT_EQUAL_INT(1, warnings);
}

/* --- templates --- */

static void every_template_runs(void)
{
    TEST_ASSERT_NOT_NULL(sphfsi_template_name(0));
    for (int k = 0; sphfsi_template_name(k); k++) {
        const char *name = sphfsi_template_name(k);
        struct session x;
        const struct sphfsi_options o = {.case_text = sphfsi_template(name)};
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, session_open(&x, &o, &diag), diag.text);
        for (int step = 0; step < 3; step++)
            TEST_ASSERT_EQUAL_INT_MESSAGE(
                ERR_OK, simulation_step(&x.simulation, x.scene.top.end_time, &diag), diag.text);
        session_close(&x);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, warnings, name);
    }
}

/* --new prints the file, byte by byte. */
static void every_template_is_its_file(void)
{
    for (int k = 0; sphfsi_template_name(k); k++) {
        static char text[1 << 14];
        char path[128];
        snprintf(path, sizeof path, "cases/templates/%s.cfg", sphfsi_template_name(k));
        FILE *const file = fopen(path, "r");
        TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
        text[fread(text, 1, sizeof text - 1, file)] = '\0';
        fclose(file);
        TEST_ASSERT_EQUAL_STRING(text, sphfsi_template(sphfsi_template_name(k)));
    }
}

static void an_unknown_template_names_the_known(void)
{
    TEST_ASSERT_NULL(sphfsi_template("dambreak"));
    TEST_ASSERT_NOT_NULL(strstr(sphfsi_error(), "did you mean `dam_break`"));
    TEST_ASSERT_NOT_NULL(strstr(sphfsi_error(), "cantilever"));
}

/* --- what the study measured --- */

static void evidence_has_numbers_in_every_row(void)
{
    const char *line = embedded_text("src/app/data/evidence.csv");
    int n = 0, kinds = 0;
    while (*line == '#') line = csv_next_line(line);
    for (line = csv_next_line(line); *line; line = csv_next_line(line), n++) {
        size_t length[7];
        const char *field[7];
        for (int k = 0; k < 7; k++) {
            field[k] = csv_field(line, k, &length[k]);
            TEST_ASSERT_NOT_NULL_MESSAGE(field[k], line);
            TEST_ASSERT_GREATER_THAN(0, length[k]);
        }
        TEST_ASSERT_TRUE_MESSAGE(strtod(field[4], NULL) > 1 && strtod(field[6], NULL) > 0, line);
        bool known = false;
        static const char *const accuracies[] = {"draft", "standard", "fine", "paper"};
        for (size_t k = 0; k < COUNT_OF(accuracies); k++)
            known |= strlen(accuracies[k]) == length[1] &&
                     strncmp(field[1], accuracies[k], length[1]) == 0;
        TEST_ASSERT_TRUE_MESSAGE(known, line);
        kinds |= *line == 's' ? 1 : *line == 'f' ? 2 : *line == 'c' ? 4 : 8;
    }
    TEST_ASSERT_GREATER_THAN(10, n);
    TEST_ASSERT_EQUAL_INT(7, kinds);
}

/* --- messages --- */

static char said[1 << 16];

static void on_message(void *context, enum sphfsi_message kind, const char *line)
{
    (void)context;
    if (kind == SPHFSI_NOTE && strlen(said) + strlen(line) + 2 < sizeof said)
        strcat(strcat(said, line), "\n");
}

static void sources_fit_the_scene(void)
{
    struct sphfsi_options o = {.case_text = tiny_case, .message = on_message};
    said[0] = '\0';
    TEST_ASSERT_EQUAL_INT(SPHFSI_OK, sphfsi_cite(&o));
    TEST_ASSERT_NOT_NULL(strstr(said, "Ganzenm"));
    TEST_ASSERT_NULL(strstr(said, "Fourtakas, G., Dominguez"));
    TEST_ASSERT_NULL(strstr(said, "Verlet, L."));
    static const char *const sets[] = {"fluid water.diffusion_form=fourtakas", "integrator=verlet",
                                       "gate.hourglass=0"};
    o.sets = sets;
    o.n_sets = 3;
    said[0] = '\0';
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_cite(&o), sphfsi_error());
    TEST_ASSERT_NULL(strstr(said, "Ganzenm"));
    TEST_ASSERT_NOT_NULL(strstr(said, "Fourtakas, G., Dominguez"));
    TEST_ASSERT_NOT_NULL(strstr(said, "Verlet, L."));
}

static void every_key_is_listed(void)
{
    const struct sphfsi_options o = {.message = on_message};
    said[0] = '\0';
    sphfsi_keys(&o);
    for (int k = 0; k < PARAM_COUNT; k++) {
        char row[100];
        snprintf(row, sizeof row, "\n  %s", param_table[k].key);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, row), row);
    }
    static const char *const rows[] = {"  poisson: number >= 0, < 0.5, needed: ",
                                       "  speed: expression in x, y, t, m/s: ",
                                       "  velocity: two expressions in x, y, t, m/s: ",
                                       "  velocity: two expressions in x, y, m/s: ",
                                       "  integrator = leapfrog: symplectic|verlet|leapfrog: "};
    for (size_t k = 0; k < COUNT_OF(rows); k++)
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, rows[k]), rows[k]);
}

/* --- the picture --- */

static void preview_shows_the_scene(void)
{
    char more[4096];
    snprintf(more, sizeof more,
             "%s[probe flow_through]\nquantity = flux\npoint = 0.05, 0\nto = 0.05, 0.1\n",
             tiny_case);
    const struct sphfsi_options o = {.case_text = more,
                                     .out = tiny_path("p.svg"),
                                     .message = on_message};
    said[0] = '\0';
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_preview(&o), sphfsi_error());
    TEST_ASSERT_NOT_NULL(strstr(said, "p.svg"));
    FILE *file = fopen(tiny_path("p.svg"), "r");
    static char svg[1 << 16];
    svg[fread(svg, 1, sizeof svg - 1, file)] = '\0';
    fclose(file);
    TEST_ASSERT_NOT_NULL(strstr(svg, "tiny \"quoted\""));
    TEST_ASSERT_NOT_NULL(strstr(svg, "fluid water<"));
    TEST_ASSERT_NOT_NULL(strstr(svg, "solid gate: clamped where dark"));
    TEST_ASSERT_NOT_NULL(strstr(svg, "probe flow_through: flux"));
    TEST_ASSERT_NOT_NULL(strstr(svg, "</svg>"));
}

/* A body is drawn with particles of its own spacing. */
static void preview_shows_particles_as_they_are(void)
{
    const struct sphfsi_options o = {
        .case_text = "dp = 2 mm\nend_time = 1\n"
                     "[solid thin]\nshape = box 0, 0, 10 mm, 70 mm\ndp = 1.25 mm\n"
                     "density = 1000\nyoung = 1e6\npoisson = 0.3\n"
                     "[solid slanted]\nlike = thin\n"
                     "shape = polygon 0.2, 0; 0.23, 40 mm; 0.222, 46 mm; 0.192, 6 mm\n",
        .out = tiny_path("c.svg"),
        .message = on_message};
    TEST_ASSERT_EQUAL_INT_MESSAGE(SPHFSI_OK, sphfsi_preview(&o), sphfsi_error());
    FILE *file = fopen(tiny_path("c.svg"), "r");
    static char svg[1 << 16];
    svg[fread(svg, 1, sizeof svg - 1, file)] = '\0';
    fclose(file);
    size_t squares = 0;
    for (const char *at = strstr(svg, "body "); (at = strstr(at, "h.01")); at++) squares++;
    TEST_ASSERT_EQUAL_UINT64(448 + 320, squares);
}

static void preview_to_nowhere_is_reported(void)
{
    const struct sphfsi_options o = {.case_text = tiny_case, .out = "/nowhere/p.svg"};
    TEST_ASSERT_EQUAL_INT(SPHFSI_IO, sphfsi_preview(&o));
    TEST_ASSERT_NOT_NULL(strstr(sphfsi_error(), "/nowhere/p.svg: cannot be written"));
}

int main(void)
{
    UNITY_BEGIN();
    rig_one_thread();
    RUN_TEST(every_example_is_accepted);
    RUN_TEST(a_copy_without_its_clamp_is_warned_of);
    RUN_TEST(every_template_runs);
    RUN_TEST(every_template_is_its_file);
    RUN_TEST(an_unknown_template_names_the_known);
    RUN_TEST(evidence_has_numbers_in_every_row);
    RUN_TEST(sources_fit_the_scene);
    RUN_TEST(every_key_is_listed);
    RUN_TEST(preview_shows_the_scene);
    RUN_TEST(preview_shows_particles_as_they_are);
    RUN_TEST(preview_to_nowhere_is_reported);
    return UNITY_END();
}
