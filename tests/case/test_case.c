/* SPDX-License-Identifier: MIT
 * What a good case file means: defaults, constants, --set, inheritance, the effective case. */
#include "expr/expr.h"
#include "case/params.h"
#include "geometry/scene_points.h"
#include "unity.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static struct scene scene, again;
static struct diag diag;
static const char effective[] = "test_case.tmp";

void setUp(void) { diag = (struct diag){0}; }

void tearDown(void)
{
    scene_free(&scene);
    scene_free(&again);
    remove(effective);
}

static void parse(const char *text, int n_sets, const char *const *sets)
{
    diag = (struct diag){0};
    scene_free(&scene);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK,
                                  scene_load_text(&scene, text, "x.cfg", n_sets, sets, &diag),
                                  diag.text);
}

#define TOP "dp = 1 mm\nend_time = 1 s\n"
#define BLOCK                                                                                  \
    "[solid a]\nshape = box 0, 0, 10 mm, 20 mm\ndensity = 1 g/cm^3\nyoung = 1 MPa\npoisson = " \
    "0.3\n"

static void test_defaults(void)
{
    parse(TOP BLOCK, 0, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(0.001, scene.top.dp);
    TEST_ASSERT_EQUAL_INT(INTEGRATOR_LEAPFROG, scene.top.integrator);
    TEST_ASSERT_EQUAL_DOUBLE(1.35, scene.numerics.h_over_dp);
    TEST_ASSERT_EQUAL_DOUBLE(1.35e-3, scene.h);
    TEST_ASSERT_EQUAL_INT(40, scene.numerics.verlet_reset);
    TEST_ASSERT_EQUAL_INT(MULTIRATE_AUTO, scene.numerics.multirate);
    TEST_ASSERT_EQUAL_INT(1, scene.n_solid);
    TEST_ASSERT_EQUAL_STRING("a", scene.solid[0].common.name);
    TEST_ASSERT_EQUAL_INT(3, scene.solid[0].common.line);
    TEST_ASSERT_EQUAL_DOUBLE(1000, scene.solid[0].density);
    TEST_ASSERT_EQUAL_DOUBLE(50, scene.solid[0].hourglass);
    TEST_ASSERT_EQUAL_INT(1, scene.solid[0].gravity);
    TEST_ASSERT_NULL(scene.solid[0].velocity.e[0]);
    TEST_ASSERT_EQUAL_INT64(200, scene.points[2].n);
    TEST_ASSERT_EQUAL_DOUBLE(0, scene.c0);
}

static const char derived[] = "title = \"a # b\"   # comment\ndp = t/n\nend_time = 2*T\n"
                              "gravity = 0, -g\n[constants]\nL = 4*t\nt = 4 mm\nn = 4\n"
                              "g = 9.81 m/s^2\nT = sqrt(L/g)\n" BLOCK "velocity = 0, x/L*dp/T\n";

static void test_constants_in_any_order(void)
{
    parse(derived, 0, NULL);
    TEST_ASSERT_EQUAL_STRING("a # b", scene.top.title);
    TEST_ASSERT_EQUAL_DOUBLE(0.001, scene.top.dp);
    TEST_ASSERT_EQUAL_DOUBLE(-9.81, scene.top.gravity[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 2 * sqrt(0.016 / 9.81), scene.top.end_time);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.5 * 0.001 / sqrt(0.016 / 9.81),
                              expr_at(scene.solid[0].velocity.e[1], 0.008, 0));
}

/* A length that was written without its unit is a length in other expressions, too. */
static void test_a_key_gives_its_unit(void)
{
    parse("dp = 0.001\nend_time = 1 s\n[constants]\nL = 4*dp + 6 mm\n[solid a]\n"
          "shape = box 0, 0, L, 20 mm\ndensity = 1000\nyoung = 1 MPa\npoisson = 0.3\n",
          0, NULL);
    TEST_ASSERT_EQUAL_INT64(200, scene.points[2].n);
}

static void test_pairs_of_names(void)
{
    char name[2][SCENE_TEXT];
    TEST_ASSERT_TRUE(scene_pair("\ta , b c ", name));
    TEST_ASSERT_EQUAL_STRING("a", name[0]);
    TEST_ASSERT_EQUAL_STRING("b c", name[1]);
    static const char *const bad[] = {"a", "a, b, c", "a,", ",b", "  , b", "a,  "};
    for (size_t k = 0; k < COUNT_OF(bad); k++)
        TEST_ASSERT_FALSE_MESSAGE(scene_pair(bad[k], name), bad[k]);
}

/* The buffer is as deep as the kernel reaches and one particle more: h = 1.35 dp needs four of
 * them. */
static void test_depth_of_an_open_boundary(void)
{
    parse("dp = 1 mm\nend_time = 1 s\n[fluid w]\nshape = box 0, 0, 20 mm, 20 mm\n"
          "sound_speed = 20\n[numerics]\nh_over_dp = 1.35\n[inflow in]\nfrom = 0, 20 mm\nto = 0, "
          "0\nspeed = 0.1\n",
          0, NULL);
    const struct scene_open o = scene_open_at(&scene, 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 4e-3, o.depth);
}

static void test_a_path_that_is_too_long(void)
{
    static char path[sizeof scene.path + 1];
    memset(path, 'p', sizeof scene.path);
    char message[96];
    snprintf(message, sizeof message, "the path of the case file is longer than %d bytes",
             (int)sizeof scene.path - 1);
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, scene_load_text(&scene, "", path, 0, NULL, &diag));
    TEST_ASSERT_EQUAL_STRING(message, diag.text);
}

static void test_set_comes_before_evaluation(void)
{
    parse(derived, 1, (const char *const[]){"n=2"});
    TEST_ASSERT_EQUAL_DOUBLE(0.002, scene.top.dp);
    TEST_ASSERT_EQUAL_INT64(50, scene.points[2].n);
    parse(derived, 1, (const char *const[]){"t = 8 mm"});
    TEST_ASSERT_EQUAL_DOUBLE(0.002, scene.top.dp);
    parse(derived, 2, (const char *const[]){"dp=1 mm", "dp=2 mm"});
    TEST_ASSERT_EQUAL_DOUBLE(0.002, scene.top.dp);
}

static void test_set_of_sections(void)
{
    static const char *const sets[] = {"a.young=2 MPa",      "solid a.poisson=0.4",
                                       "numerics.cfl = 0.1", "a.shape=box 0, 0, 10 mm, 10 mm",
                                       "constants.L=1 m",    "precision=double"};
    parse(derived, (int)COUNT_OF(sets), sets);
    TEST_ASSERT_EQUAL_DOUBLE(2e6, scene.solid[0].young);
    TEST_ASSERT_EQUAL_DOUBLE(0.4, scene.solid[0].poisson);
    TEST_ASSERT_EQUAL_DOUBLE(0.1, scene.numerics.cfl);
    TEST_ASSERT_EQUAL_INT(1, scene.solid[0].shape.n);
    TEST_ASSERT_EQUAL_INT64(100, scene.points[2].n);
    TEST_ASSERT_EQUAL_INT(PRECISION_DOUBLE, scene.top.precision);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 2 * sqrt(1 / 9.81), scene.top.end_time);
}

/* Leapfrog's step is twice as long, but with bodies of less than half of the fluid's density. */
static void test_default_cfl(void)
{
    static const char text[] =
        "dp = 1 cm\nend_time = 1\n[fluid water]\nshape = box 0, 0, 0.1, 0.1\n"
        "sound_speed = 20\n[solid floor]\nshape = box 0, -0.04, 0.1, 0\nyoung = 1e6\n"
        "poisson = 0.3\ndensity = 500\n";
    static const char *const sets[] = {"integrator=leapfrog", "floor.density=20",
                                       "numerics.cfl=0.3"};
    parse(text, 1, (const char *const[]){"integrator=symplectic"});
    TEST_ASSERT_EQUAL_DOUBLE(0.2, scene.numerics.cfl);
    parse(text, 2, sets);
    TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(0.4, scene.numerics.cfl, "whatever the density of a body");
    parse(text, 3, sets);
    TEST_ASSERT_EQUAL_DOUBLE(0.3, scene.numerics.cfl);
}

#define WATER "[fluid w]\nshape = box 0, 30 mm, 10 mm, 40 mm\nsound_speed = 20\n"

#define INFLOW "[inflow in]\nfrom = 0, 40 mm\nto = 0, 30 mm\nspeed = 1\n"

/* What case/presets.c sets: for fluid alone, without gravity in a stream, and beside a solid. */
static void test_scheme(void)
{
    parse(TOP WATER, 0, NULL);
    TEST_ASSERT_EQUAL_INT(SCHEME_STANDARD, scene.top.scheme);
    TEST_ASSERT_TRUE(scene.numerics.h_over_dp == 2);
    TEST_ASSERT_TRUE(scene.fluid[0].density_diffusion == 0.1);
    TEST_ASSERT_EQUAL_INT(DIFFUSION_ANTUONO, scene.fluid[0].diffusion_form);
    TEST_ASSERT_EQUAL_INT(LIMITER_STRAIN, scene.fluid[0].diffusion_limiter);
    TEST_ASSERT_TRUE(scene.fluid[0].acoustic_damper == 4);
    TEST_ASSERT_EQUAL_INT(MASS_HYDROSTATIC, scene.fluid[0].particle_mass);
    TEST_ASSERT_TRUE(scene.fluid[0].wall_repulsion == 0.3);
    parse("gravity = 0, -9.81\n" TOP WATER INFLOW, 0, NULL);
    TEST_ASSERT_TRUE(scene.numerics.h_over_dp == 2);
    parse(TOP WATER INFLOW, 0, NULL);
    TEST_ASSERT_TRUE(scene.numerics.h_over_dp == 1.35);
    TEST_ASSERT_TRUE(scene.fluid[0].acoustic_damper == 4);
    parse("gravity = 0, 0.0\n" TOP WATER INFLOW, 0, NULL);
    TEST_ASSERT_TRUE(scene.numerics.h_over_dp == 1.35);
    parse(TOP WATER BLOCK, 0, NULL);
    TEST_ASSERT_TRUE(scene.numerics.h_over_dp == 1.5);
    TEST_ASSERT_TRUE(scene.fluid[0].acoustic_damper == 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1.35e-3, scene_solid_h(&scene, 0));
    TEST_ASSERT_EQUAL_INT(LAW_NEO_HOOKEAN, scene.solid[0].law);
    parse(TOP BLOCK, 0, NULL);
    TEST_ASSERT_TRUE(scene.numerics.h_over_dp == 1.35);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1.35e-3, scene_solid_h(&scene, 0));
    TEST_ASSERT_EQUAL_INT(LAW_NEO_HOOKEAN, scene.solid[0].law);
    parse("scheme = paper\n" TOP BLOCK, 0, NULL);
    TEST_ASSERT_EQUAL_INT(LAW_PAPER, scene.solid[0].law);
    parse("scheme = paper\n" TOP WATER, 0, NULL);
    TEST_ASSERT_TRUE(scene.numerics.h_over_dp == 1.35);
    TEST_ASSERT_TRUE(scene.fluid[0].density_diffusion == 0);
    TEST_ASSERT_TRUE(scene.fluid[0].wall_repulsion == 0);
    TEST_ASSERT_EQUAL_INT(MASS_EQUAL, scene.fluid[0].particle_mass);
}

/* A key that the case gives wins, and leaves no other key of the scheme in the way; the effective
 * case, which gives them all, is the same scene. */
static void test_a_key_wins_over_the_scheme(void)
{
    parse(TOP "[numerics]\nh_over_dp = 1.6\nsolid_h_over_dp = 1.8\n" WATER
              "density_diffusion = 0\nwall_repulsion = 0\n" BLOCK,
          0, NULL);
    TEST_ASSERT_TRUE(scene.numerics.h_over_dp == 1.6);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1.8e-3, scene_solid_h(&scene, 0));
    TEST_ASSERT_TRUE(scene.fluid[0].density_diffusion == 0);
    TEST_ASSERT_EQUAL_INT(ERR_OK, scene_write(&scene, effective, &diag));
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, scene_read(&again, NULL, effective, 0, NULL, &diag),
                                  diag.text);
    TEST_ASSERT_EQUAL_INT(SCHEME_STANDARD, again.top.scheme);
    TEST_ASSERT_TRUE(again.fluid[0].density_diffusion == 0);
    scene_free(&scene);
    TEST_ASSERT_EQUAL_INT(ERR_INPUT,
                          scene_read(&scene, TOP BLOCK "[numerics]\nsolid_h_over_dp = 0.5", "x.cfg",
                                     0, NULL, &diag));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, "too few neighbours"), diag.text);
}

static void test_like_inherits_values_but_no_regions(void)
{
    parse(TOP BLOCK "law = svk\nclamp = box 0, 0, 10 mm, 5 mm\n"
                    "[solid b]\nlike = a\nyoung = 3 MPa\nshape = box 20 mm, 0, 30 mm, 20 mm\n",
          0, NULL);
    TEST_ASSERT_EQUAL_INT(LAW_SVK, scene.solid[1].law);
    TEST_ASSERT_EQUAL_DOUBLE(3e6, scene.solid[1].young);
    TEST_ASSERT_EQUAL_DOUBLE(1000, scene.solid[1].density);
    TEST_ASSERT_EQUAL_INT(1, scene.solid[1].shape.n);
    TEST_ASSERT_EQUAL_INT(0, scene.solid[1].clamp.n);
    TEST_ASSERT_EQUAL_STRING("b", scene.solid[1].common.name);
}

static void test_like_of_rigid_bodies_and_beams(void)
{
    parse(TOP "[rigid a]\ndensity = 500\nspin = 2\ncentre = 3 mm, 4 mm\nhinge = 5 mm, 5 mm\n"
              "shape = box 0, 0, 10 mm, 10 mm\n"
              "[rigid b]\nlike = a\nshape = box 20 mm, 0, 30 mm, 10 mm\n"
              "[beam c]\nyoung = 1e6\nthickness = 1 mm\ndensity = 900\nclamp = 0, 50 mm\n"
              "shape = polyline: 0, 50 mm; 0.1, 50 mm\n"
              "[beam d]\nlike = c\nmass = 0.8\nshape = polyline: 0, 90 mm; 0.1, 90 mm\n",
          0, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(500, scene.rigid[1].density);
    TEST_ASSERT_EQUAL_DOUBLE(2, scene.rigid[1].spin);
    TEST_ASSERT_TRUE(isnan(scene.rigid[1].centre[0]) && scene.rigid[1].hinge.n == 0);
    TEST_ASSERT_EQUAL_DOUBLE(1e6, scene.beam[1].young);
    TEST_ASSERT_TRUE(isnan(scene.beam[1].density) && scene.beam[1].mass == 0.8);
    TEST_ASSERT_EQUAL_INT(0, scene.beam[1].clamp.n);
}

/* Given density, mass, young or thickness determine what the other section states of its own. */
static void test_like_drops_what_given_values_determine(void)
{
    parse(TOP "[rigid a]\nmass = 0.05\ninertia = 3\nshape = box 0, 0, 10 mm, 10 mm\n"
              "[rigid b]\nlike = a\ndensity = 500\nshape = box 20 mm, 0, 30 mm, 10 mm\n"
              "[rigid c]\nlike = a\nmass = 0.1\nshape = box 40 mm, 0, 50 mm, 10 mm\n"
              "[rigid d]\nlike = a\nspin = 1\nshape = box 60 mm, 0, 70 mm, 10 mm\n"
              "[beam e]\naxial_stiffness = 1e6\nbending_stiffness = 50\nshear_stiffness = 1e5\n"
              "mass = 30\nshape = polyline: 0, 50 mm; 0.1, 50 mm\n"
              "[beam f]\nlike = e\nyoung = 1e9\nthickness = 1 mm\nshear_stiffness = 7\n"
              "shape = polyline: 0, 90 mm; 0.1, 90 mm\n"
              "[beam g]\nlike = f\nthickness = 2 mm\nshape = polyline: 0, 0.2; 0.1, 0.2\n",
          0, NULL);
    TEST_ASSERT_TRUE(isnan(scene.rigid[1].inertia) && isnan(scene.rigid[1].mass));
    TEST_ASSERT_TRUE(isnan(scene.rigid[2].inertia));
    TEST_ASSERT_TRUE(scene.rigid[3].inertia == 3 && scene.rigid[3].mass == 0.05);
    const struct scene_beam *const f = &scene.beam[1];
    TEST_ASSERT_TRUE(isnan(f->axial_stiffness) && isnan(f->bending_stiffness));
    TEST_ASSERT_TRUE(f->shear_stiffness == 7 && f->mass == 30);
    TEST_ASSERT_TRUE(isnan(scene.beam[2].shear_stiffness) && scene.beam[2].young == 1e9);
}

/* Keys of hinges and clamps are inherited by a section that has such points of its own. */
static void test_like_and_the_keys_of_supports(void)
{
    parse(TOP "[motion m]\nx = 0.1*t\n"
              "[rigid a]\ndensity = 500\nhinge = 5 mm, 5 mm\nhinge_stiffness = 10\n"
              "hinge_damping = 2\nhinge_friction = 1\nshape = box 0, 0, 10 mm, 10 mm\n"
              "[rigid b]\nlike = a\nshape = box 20 mm, 0, 30 mm, 10 mm\n"
              "[rigid c]\nlike = a\nhinge = 45 mm, 0\nshape = box 40 mm, 0, 50 mm, 10 mm\n"
              "[beam d]\nyoung = 1e6\nthickness = 1 mm\ndensity = 900\nclamp = 0, 50 mm\n"
              "motion = m\nshape = polyline: 0, 50 mm; 0.1, 50 mm\n"
              "[beam e]\nlike = d\nshape = polyline: 0, 90 mm; 0.1, 90 mm\n"
              "[beam f]\nlike = d\nhinge = 0, 0.2\nshape = polyline: 0, 0.2; 0.1, 0.2\n"
              "[solid g]\nshape = box 0, 0.3, 10 mm, 0.32\ndensity = 1000\nyoung = 1 MPa\n"
              "poisson = 0.3\nclamp = box 0, 0.3, 10 mm, 0.305\nclamp_motion = m\n"
              "[solid h]\nlike = g\nshape = box 20 mm, 0.3, 30 mm, 0.32\n",
          0, NULL);
    const struct scene_rigid *const b = &scene.rigid[1], *const c = &scene.rigid[2];
    TEST_ASSERT_TRUE(b->hinge_stiffness == 0 && b->hinge_damping == 0 && b->hinge_friction == 0);
    TEST_ASSERT_TRUE(c->hinge_stiffness == 10 && c->hinge_damping == 2 && c->hinge_friction == 1);
    TEST_ASSERT_EQUAL_STRING("", scene.beam[1].motion);
    TEST_ASSERT_EQUAL_STRING("m", scene.beam[2].motion);
    TEST_ASSERT_EQUAL_STRING("", scene.solid[1].clamp_motion);
}

static void test_sound_speed_follows_eq_3(void)
{
    parse(TOP "[fluid w]\nshape = box 0, 0, 9 mm, 9 mm\nmax_speed = 2 m/s\nmax_pressure = 9 kPa\n",
          0, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(30, scene.c0);
    TEST_ASSERT_EQUAL_DOUBLE(1000, scene.rho0);
}

static void test_line_ends_and_marks_of_other_systems(void)
{
    parse("\xEF\xBB\xBF"
          "dp = 1 mm\r\nend_time = 1 s\r\n[solid a]\r\nshape = box 0, 0, 5 mm, 5 mm\r\n"
          "density = 1\r\nyoung = 1\r\npoisson = 0\r",
          0, NULL);
    TEST_ASSERT_EQUAL_INT64(25, scene.points[2].n);
}

/* --- the effective case --- */

static void same_expressions(const struct scene_expr *a, const struct scene_expr *b)
{
    for (int c = 0; c < 2; c++) {
        TEST_ASSERT_EQUAL_INT(a->e[c] != NULL, b->e[c] != NULL);
        for (int k = 0; a->e[c] && k < 20; k++)
            TEST_ASSERT_TRUE(expr_at(a->e[c], 0.01 * k, 0.02 * k) ==
                             expr_at(b->e[c], 0.01 * k, 0.02 * k));
    }
}

static void same_shapes(const struct shape_list *a, const struct shape_list *b)
{
    TEST_ASSERT_EQUAL_INT(a->n, b->n);
    for (int k = 0; k < a->n; k++) {
        const struct shape *p = &a->item[k], *q = &b->item[k];
        TEST_ASSERT_TRUE(p->kind == q->kind && p->n == q->n && p->size == q->size);
        TEST_ASSERT_EQUAL_MEMORY(p->pt, q->pt, (size_t)p->n * sizeof *p->pt);
    }
}

static void same_hinges(const struct hinge_list *a, const struct hinge_list *b)
{
    TEST_ASSERT_EQUAL_INT(a->n, b->n);
    for (int k = 0; k < a->n; k++) {
        TEST_ASSERT_EQUAL_MEMORY(a->item[k].at, b->item[k].at, sizeof a->item[k].at);
        TEST_ASSERT_EQUAL_STRING(a->item[k].other, b->item[k].other);
    }
}

static void same_value(const struct param *param, const char *mine, const char *its)
{
    const void *a = mine + param->offset, *b = its + param->offset;
    if (strstr(param->key, "file")) return;      /* the same file, seen from another folder */
    if (strcmp(param->key, "like") == 0) return; /* the effective case has its values instead */
    switch (param->type) {
    case PARAM_REAL: TEST_ASSERT_EQUAL_MEMORY_MESSAGE(a, b, sizeof(double), param->key); break;
    case PARAM_VECTOR:
        if (param->expr_offset)
            same_expressions((const void *)(mine + param->expr_offset),
                             (const void *)(its + param->expr_offset));
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(a, b, 2 * sizeof(double), param->key);
        break;
    case PARAM_INTEGER:
    case PARAM_CHOICE: TEST_ASSERT_EQUAL_MEMORY_MESSAGE(a, b, sizeof(int), param->key); break;
    case PARAM_TEXT: TEST_ASSERT_EQUAL_STRING_MESSAGE(a, b, param->key); break;
    case PARAM_EXPR: same_expressions(a, b); break;
    case PARAM_SHAPES: same_shapes(a, b); break;
    case PARAM_HINGES: same_hinges(a, b); break;
    }
}

static void same_points(const struct scene_points *a, const struct scene_points *b)
{
    TEST_ASSERT_EQUAL_INT64(a->n, b->n);
    if (!a->n) return;
    const size_t n = (size_t)a->n;
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->x, b->x, n * sizeof *a->x));
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->y, b->y, n * sizeof *a->y));
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->body, b->body, n * sizeof *a->body));
    if (a->clamped) TEST_ASSERT_EQUAL_INT(0, memcmp(a->clamped, b->clamped, n));
}

static void round_trip(void)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, scene_write(&scene, effective, &diag), diag.text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, scene_load_text(&again, NULL, effective, 0, NULL, &diag),
                                  diag.text);
    for (int id = 0; id < SECTION_COUNT; id++) {
        const int n = section_count(&scene, (enum section_id)id);
        TEST_ASSERT_EQUAL_INT(n, section_count(&again, (enum section_id)id));
        for (int k = 0; k < n * PARAM_COUNT; k++) {
            const struct param *param = &param_table[k % PARAM_COUNT];
            if ((int)param->section == id)
                same_value(param, section_at(&scene, param->section, k / PARAM_COUNT),
                           section_at(&again, param->section, k / PARAM_COUNT));
        }
    }
    for (int kind = 0; kind < 3; kind++) same_points(&scene.points[kind], &again.points[kind]);
    TEST_ASSERT_TRUE(scene.h == again.h && scene.c0 == again.c0 && scene.rho0 == again.rho0);
    TEST_ASSERT_EQUAL_MEMORY(scene.domain_upper, again.domain_upper, sizeof scene.domain_upper);
    TEST_ASSERT_EQUAL_MEMORY(scene.domain_lower, again.domain_lower, sizeof scene.domain_lower);
    scene_free(&again);
}

static void test_every_kind_of_value_comes_back(void)
{
    parse("title = \"# quoted \"\ndp = 1 mm/3\nend_time = 1/3\n"
          "gravity = a*sin(3*t), -29/3\n[constants]\na = 1/3\nb = sqrt(2 m)\n"
          "r = 2 m/3 m\n[domain]\nlower = -1, -1\nupper = 1, 1\n"
          "[fluid w]\nshape = circle 5 mm, 5 mm, pi*1 mm\nsurface = 1 cm\nsound_speed = 20/7\n"
          "velocity = a*x/1 s, b^2/1 s*r\n[fluid v]\nlike = w\npressure = 1 Pa*y\n"
          "shape = box 0, 10 mm, 10 mm, 20 mm\n[wall b]\nmotion = m\n"
          "shape = polyline thickness 4 mm: -9 mm, -9 mm; 20 mm, -9 mm\n"
          "shape = polygon -9 mm, -9 mm; -20 mm, -9 mm; -20 mm, 20 mm\n"
          "[motion m]\nx = t*(1/3 + t*(2/7 + 1e-300*t))\nstop = 1/9\n",
          0, NULL);
    round_trip();
}

static int cases_of_folder(const char *name)
{
    DIR *folder = opendir(name);
    int n = 0;
    for (struct dirent *e; folder && (e = readdir(folder)) != NULL;) {
        const size_t length = strlen(e->d_name);
        if (length < 4 || strcmp(e->d_name + length - 4, ".cfg") != 0) continue;
        char path[300];
        snprintf(path, sizeof path, "%s/%.250s", name, e->d_name);
        scene_free(&scene);
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, scene_load_text(&scene, NULL, path, 0, NULL, &diag),
                                      diag.text);
        round_trip();
        n++;
    }
    if (folder) closedir(folder);
    return n;
}

static void test_shipped_cases_come_back(void)
{
    const int n = cases_of_folder("cases");
    if (n == 0) TEST_IGNORE_MESSAGE("run from the top folder");
    TEST_ASSERT_TRUE(n >= 6);
    TEST_ASSERT_TRUE(cases_of_folder("cases/verify") >= 6);
}

static void test_files_are_found_from_the_effective_case(void)
{
    FILE *file = fopen("test_case_motion.tmp", "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs("0 0\n1 1\n", file);
    fclose(file);
    parse(TOP BLOCK "[wall w]\nshape = box 20 mm, 0, 30 mm, 20 mm\nmotion = m\n"
                    "[motion m]\nx = way(t)\n[table way]\nfile = ./test_case_motion.tmp\n",
          0, NULL);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, scene_write(&scene, "tests/test_case.tmp", &diag),
                                  diag.text);
    const enum err err = scene_load_text(&again, NULL, "tests/test_case.tmp", 0, NULL, &diag);
    remove("tests/test_case.tmp");
    remove("test_case_motion.tmp");
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, err, diag.text);
    TEST_ASSERT_EQUAL_STRING("../test_case_motion.tmp", again.table[0].file);
}

static void test_writing_where_nothing_can_be_written(void)
{
    parse(TOP BLOCK, 0, NULL);
    TEST_ASSERT_EQUAL_INT(ERR_IO, scene_write(&scene, "no/such/folder/x.cfg", &diag));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_defaults);
    RUN_TEST(test_constants_in_any_order);
    RUN_TEST(test_a_key_gives_its_unit);
    RUN_TEST(test_pairs_of_names);
    RUN_TEST(test_depth_of_an_open_boundary);
    RUN_TEST(test_a_path_that_is_too_long);
    RUN_TEST(test_set_comes_before_evaluation);
    RUN_TEST(test_set_of_sections);
    RUN_TEST(test_default_cfl);
    RUN_TEST(test_scheme);
    RUN_TEST(test_a_key_wins_over_the_scheme);
    RUN_TEST(test_like_inherits_values_but_no_regions);
    RUN_TEST(test_like_of_rigid_bodies_and_beams);
    RUN_TEST(test_like_drops_what_given_values_determine);
    RUN_TEST(test_like_and_the_keys_of_supports);
    RUN_TEST(test_sound_speed_follows_eq_3);
    RUN_TEST(test_line_ends_and_marks_of_other_systems);
    RUN_TEST(test_every_kind_of_value_comes_back);
    RUN_TEST(test_shipped_cases_come_back);
    RUN_TEST(test_files_are_found_from_the_effective_case);
    RUN_TEST(test_writing_where_nothing_can_be_written);
    return UNITY_END();
}
