/* SPDX-License-Identifier: MIT
 * Probes: weights that reproduce linear fields, also at a corner of the body; names of columns. */
#include "probes.h"
#include "tiny.h"
#include "unity.h"

#include <math.h>
#include <string.h>

static struct diag diag;
static struct scene scene;
static struct simulation simulation;
static struct arena arena;
static struct probes probes;

static enum err open_with(int n, const char *const *sets)
{
    diag = (struct diag){.code = ERR_OK};
    TEST_ASSERT_EQUAL_INT(ERR_OK, scene_parse(&scene, tiny_case, "tiny.cfg", n, sets, &diag));
    TEST_ASSERT_EQUAL_INT(ERR_OK, simulation_create(&simulation, &scene, &diag));
    return probes_create(&probes, &simulation, &arena, &diag);
}

void setUp(void) {}

void tearDown(void)
{
    simulation_free(&simulation);
    scene_free(&scene);
    arena_free(&arena);
}

static void set_linear_field(void)
{
    struct particles *p = &simulation.kind[KIND_SOLID];
    for (int64_t i = 0; i < p->n; i++) {
        p->ux[i] = 0.5 + 2 * p->X[i] - 3 * p->Y[i];
        p->uy[i] = -0.25 + p->X[i] + 4 * p->Y[i];
        p->vx[i] = 10 * p->ux[i];
        p->vy[i] = 10 * p->uy[i];
    }
}

static void weights_reproduce_linear_fields(const char *point)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, open_with(1, &point));
    set_linear_field();
    double row[8];
    probes_sample(&probes, &simulation, row);
    const double *at = probes.probe[0].point;
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, 0.5 + 2 * at[0] - 3 * at[1], row[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, -0.25 + at[0] + 4 * at[1], row[2]);
    at = probes.probe[1].point;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 10 * (0.5 + 2 * at[0] - 3 * at[1]), row[3]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 10 * (-0.25 + at[0] + 4 * at[1]), row[4]);
}

static void linear_at_the_corner(void) { weights_reproduce_linear_fields("M1.point=0.13, 0"); }

static void linear_inside(void) { weights_reproduce_linear_fields("M1.point=0.1171, 0.0613"); }

static void linear_on_a_particle(void) { weights_reproduce_linear_fields("M1.point=0.115, 0.055"); }

static void columns_are_named(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, open_with(0, NULL));
    TEST_ASSERT_EQUAL_STRING("time_s,M1_dx_m,M1_dy_m,V_vx_m_per_s,V_vy_m_per_s,P_p_Pa",
                             probes_header(&scene, &arena, &diag));
    TEST_ASSERT_EQUAL_INT(6, probes.columns);
}

static void pressure_is_hydrostatic_at_the_start(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, open_with(0, NULL));
    double row[8];
    probes_sample(&probes, &simulation, row);
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * 1000 * 9.81 * 0.1, 1000 * 9.81 * 0.08, row[5]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(linear_at_the_corner);
    RUN_TEST(linear_inside);
    RUN_TEST(linear_on_a_particle);
    RUN_TEST(columns_are_named);
    RUN_TEST(pressure_is_hydrostatic_at_the_start);
    return UNITY_END();
}
