/* SPDX-License-Identifier: MIT
 * Corrected gradients (L-10 to L-12): three particles with numbers worked out by hand, and linear fields
 * among disordered ones. */
#include "rig.h"
#include "unity.h"

#include <math.h>

static const char three[] = "dp = 0.8\nend_time = 1\nprecision = double\n"
                            "[numerics]\nh_over_dp = 1.25\nskin = 0.5\n"
                            "[domain]\nlower = -10, -10\nupper = 10, 10\n"
                            "[fluid w]\nshape = box 0, 0, 2.4, 0.8\nsound_speed = 10\n";

static const char block[] = "dp = 0.1\nend_time = 1\nprecision = double\n"
                            "[domain]\nlower = -2, -2\nupper = 4, 4\n"
                            "[fluid w]\nshape = box 0, 0, 2, 2\nsound_speed = 10\nshifting = 2\n";

static struct rig rig;
static struct particles *p;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

/* L-10 for a at the origin, with neighbours at (0.6, 0.8) and (0.8, -0.6) of the same density and distance,
 * so that the matrix is a multiple of 1. The differences D_1 and D_2 of a field give the gradient
 * (0.6 D_1 + 0.8 D_2, 0.8 D_1 - 0.6 D_2): of the pressure 1093.5759363181424 Pa (1.4, 0.2), of u -2 and -1,
 * of v 2 and 1. So dv/dt = -grad P/rho_a, and drho/dt = -1010 (-2 + 1). */
static void test_corrected_gradients_by_hand(void)
{
    rig_open(&rig, three, "w.shifting=2", "w.gradients=corrected", NULL);
    p = &rig.sim.kind[KIND_FLUID];
    TEST_ASSERT_EQUAL_INT64(3, p->n);
    const double x[3][2] = {{0, 0}, {0.6, 0.8}, {0.8, -0.6}}, v[3][2] = {{1, 0}, {-1, 2}, {0, 1}};
    for (int i = 0; i < 3; i++) {
        p->id[i] = i;
        p->x[i] = x[i][0];
        p->y[i] = x[i][1];
        p->vx[i] = v[i][0];
        p->vy[i] = v[i][1];
        p->dens[i] = i ? 0.02 : 0.01;
    }
    rig_sort(&rig);
    rig_evaluate(&rig);
    int64_t a = 0;
    while (p->id[a] != 0) a++;
    const double rise = 1093.5759363181424;
    assert_near(1e-10, 1.4 * rise, p->dp_dx[a], "dP/dx");
    assert_near(1e-10, 0.2 * rise, p->dp_dy[a], "dP/dy");
    assert_near(1e-14, 0.014, p->ddens_dx[a], "ddens/dx");
    assert_near(1e-14, -2, p->du_dx[a], "du/dx");
    assert_near(1e-14, -1, p->du_dy[a], "du/dy");
    assert_near(1e-14, 2, p->dv_dx[a], "dv/dx");
    assert_near(1e-14, 1, p->dv_dy[a], "dv/dy");
    assert_near(1e-12, -1.4 * rise / 1010, p->ax[a], "ax");
    assert_near(1e-12, -0.2 * rise / 1010, p->ay[a], "ay");
    assert_near(1e-10, 1010, 1000 * p->ddens[a], "drho");
}

/* Neighbours that all but lie on a line with the particle: the gradient is exact down to a determinant of a
 * thousandth of the trace squared, and 0 below, where it would be noise. Here that ratio is 0.08 and 6e-4. */
static void test_neighbours_almost_on_a_line(void)
{
    static const double height[] = {0.25, 0.02};
    for (int k = 0; k < 2; k++) {
        rig_open(&rig, three, "w.shifting=2", "w.gradients=corrected", NULL);
        p = &rig.sim.kind[KIND_FLUID];
        for (int i = 0; i < 3; i++) {
            p->id[i] = i;
            p->x[i] = 0.8 * (i - 1);
            p->y[i] = i == 1 ? 0 : height[k];
            p->vx[i] = 2 * p->x[i] - p->y[i];
            p->vy[i] = 3 * p->y[i];
            p->dens[i] = 0;
        }
        rig_sort(&rig);
        rig_evaluate(&rig);
        int64_t a = 0;
        while (p->id[a] != 1) a++;
        const double share = k == 0;
        assert_near(1e-12, 2 * share, p->du_dx[a], "du/dx");
        assert_near(1e-12, -share, p->du_dy[a], "du/dy");
        assert_near(1e-12, 0, p->dv_dx[a], "dv/dx");
        assert_near(1e-12, 3 * share, p->dv_dy[a], "dv/dy");
    }
}

/* Linear fields among disordered particles: no viscous force, the rate of their divergence, and the same
 * fields after a shift, also half a step behind (leapfrog). */
static void test_shift_keeps_linear_fields(void)
{
    rig_open(&rig, block, "w.gradients=corrected", "w.laminar_viscosity=0.1",
             "w.shifting_speed=largest", "w.acoustic_damper=4", NULL);
    p = &rig.sim.kind[KIND_FLUID];
    uint64_t seed = 5;
    for (int64_t i = 0; i < p->n; i++) {
        p->x[i] += 0.02 * noise(&seed);
        p->y[i] += 0.02 * noise(&seed);
        p->dens[i] = 0.01 + 0.02 * p->x[i] - 0.03 * p->y[i];
        p->dens_slow[i] = p->dens[i] - 0.001;
        p->vx[i] = p->vx_half[i] = 1 + 2 * p->x[i] - p->y[i];
        p->vy[i] = p->vy_half[i] = 3 * p->x[i] + 0.5 * p->y[i];
    }
    rig_sort(&rig);
    rig_evaluate(&rig);
    for (int64_t i = 0; i < p->n; i++) {
        assert_near(1e-12, -(1 + p->dens[i]) * 2.5, p->ddens[i], "rate of dens");
        assert_near(1e-9, 0, hypot(p->lap_u[i], p->lap_v[i]), "Laplacian");
        /* The pair force vanishes as well, so only the pressure is left. */
        const double rho = 1000 * (1 + p->dens[i]);
        assert_near(1e-9, -p->dp_dx[i] / rho, p->ax[i], "ax");
    }
    TEST_ASSERT_TRUE(fluid_shift(&rig.sim.fluid, p, 0.01) > 1e-4);
    for (int64_t i = 0; i < p->n; i++) {
        assert_near(1e-13, 0.01 + 0.02 * p->x[i] - 0.03 * p->y[i], p->dens[i], "dens");
        assert_near(1e-13, 0.001, p->dens[i] - p->dens_slow[i], "dens over the damper's");
        assert_near(1e-12, 1 + 2 * p->x[i] - p->y[i], p->vx[i], "u");
        assert_near(1e-12, 3 * p->x[i] + 0.5 * p->y[i], p->vy_half[i], "v half a step behind");
    }
}

/* What corrected gradients cannot be used with. */
static void test_refusals(void)
{
#define CORRECTED                                                                   \
    "dp = 0.1\nend_time = 1\n[fluid w]\nshape = box 0, 0, 1, 1\nsound_speed = 10\n" \
    "laminar_viscosity = 0.1\ngradients = corrected\n"
#define SHIFTED CORRECTED "shifting = 2\n"
#define WALL "[wall bed]\nshape = box 0, -0.3, 1, 0\n"
    rig_refuses(CORRECTED, "needs SHIFTING (fluid.shifting > 0): with corrected gradients nothing "
                           "else keeps particles apart");
    rig_refuses(SHIFTED "surface = 1\n", "[fluid w] has gradients = corrected, which is for fluid "
                                         "without a free surface: use gradients = plain");
    rig_refuses(SHIFTED WALL, "[wall bed] has slip = free; gradients = corrected of [fluid w] need "
                              "the velocity behind a wall: use slip = none or gradients = plain");
    rig_refuses(SHIFTED WALL "slip = none\n[probe f]\nquantity = force\nbody = bed\n",
                "the force on a wall is not known");
    rig_refuses(SHIFTED WALL "slip = none\nmotion = m\n[motion m]\nvelocity = 1, 0\n",
                "the work of a wall is not known");
    rig_refuses(SHIFTED "[numerics]\nsides = one\n" WALL "slip = none\n", "use sides = both");
    rig_refuses(SHIFTED "[solid s]\nshape = box 1, 0, 1.3, 1\ndensity = 1000\nyoung = 1e6\n"
                        "poisson = 0.3\n",
                "the force on a structure is not known");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_corrected_gradients_by_hand);
    RUN_TEST(test_neighbours_almost_on_a_line);
    RUN_TEST(test_shift_keeps_linear_fields);
    RUN_TEST(test_refusals);
    return UNITY_END();
}
