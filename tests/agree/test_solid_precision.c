/* SPDX-License-Identifier: MIT
 * Pairs of the solid in float against double: what float costs, that it does not grow with strain
 * going down or displacement going up, how it grows as a body turns, that both find the same step,
 * and where it is taken. */
#include "rig.h"
#include "solid/solid.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

static const char bar[] =
    "dp = 1 cm\nend_time = 1\n"
    "[solid bar]\nshape = box 0, 0, 0.3, 0.06\nclamp = box 0, 0, 0.02, 0.06\n"
    "density = 1100\nyoung = 2e6\npoisson = 0.4\nvelocity = 0, 20 s^-1*max(x, 0)\n";

static const char *const precisions[] = {"numerics.solid_precision=double",
                                         "numerics.solid_precision=single"};
static struct rig rig;
static struct particles *p;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

enum { MOST = 200 };
struct picture {
    double x[MOST], y[MOST];
};

static void take(struct picture *q, const double *x, const double *y)
{
    TEST_ASSERT_TRUE(p->n <= MOST);
    for (int64_t i = 0; i < p->n; i++) {
        q->x[i] = x[i];
        q->y[i] = y[i];
    }
}

/* Largest distance over the largest size. */
static double apart(const struct picture *a, const struct picture *b)
{
    double top = 0, size = 0;
    for (int64_t i = 0; i < p->n; i++) {
        top = fmax(top, hypot(a->x[i] - b->x[i], a->y[i] - b->y[i]));
        size = fmax(size, hypot(a->x[i], a->y[i]));
    }
    TEST_ASSERT_TRUE(size > 0);
    return top / size;
}

/* A bar bends until its end has gone by some 10 dp and swings back: 0.2 s, some 4000 steps. Forces
 * are off by 1e-6 of those of neighbours; they average out, and the motion differs by no more than
 * that. */
static void test_the_same_oscillation(void)
{
    static struct picture at[2];
    double energy[2], most = 0;
    for (int k = 0; k < 2; k++) {
        RIG_OPEN_SOLID(bar, precisions[k]);
        const double before = simulation_ledger(&rig.sim).kinetic;
        rig_run(&rig, 0.03);
        for (int64_t i = 0; i < p->n; i++) most = fmax(most, hypot(p->ux[i], p->uy[i]));
        rig_run(&rig, 0.2);
        take(&at[k], p->ux, p->uy);
        const struct ledger row = simulation_ledger(&rig.sim);
        energy[k] = (row.kinetic + row.elastic + row.hourglass) / before;
    }
    TEST_ASSERT_TRUE(most > 0.08);
    printf("bar after 0.2 s: mixed off by %.3g of its displacement, energy %.9f, double %.9f\n",
           apart(&at[0], &at[1]), energy[1], energy[0]);
    TEST_ASSERT_TRUE(energy[0] > 0.5 && apart(&at[0], &at[1]) > 0);
    assert_at_most(1e-5, apart(&at[0], &at[1]), "displacement");
    assert_near(1e-6, energy[0], energy[1], "energy");
}

static void evaluate(void)
{
    solid_stress(&rig.sim.solid, p);
    solid_forces(&rig.sim.solid, p);
}

static void deform(double strain, double shift)
{
    uint64_t seed = 3;
    for (int64_t i = 0; i < p->n; i++) {
        p->ux[i] = strain * (0.5 * p->X[i] - 0.3 * p->Y[i] + 1e-3 * noise(&seed)) + shift;
        p->uy[i] = strain * (0.4 * p->X[i] + 0.7 * p->Y[i] + 1e-3 * noise(&seed)) - 0.7 * shift;
        p->vx[i] = strain * noise(&seed);
        p->vy[i] = strain * noise(&seed);
    }
}

static double forces_apart(const char *law, const char *plane, double strain, double shift)
{
    static struct picture of[2];
    for (int k = 0; k < 2; k++) {
        RIG_OPEN_SOLID(bar, precisions[k], law, plane);
        deform(strain, k ? shift : 0);
        evaluate();
        take(&of[k], p->sx, p->sy);
    }
    return apart(&of[0], &of[1]);
}

/* Laws in U = F - I keep the digits of small strains, down to the 1e-9 of a stiff plate, and
 * differences of displacements in two parts those of a body that has gone a kilometre: 1e-13 m of
 * round-off of its position over strains of 0.1 over dp = 1e-10. A float alone would have 6e-5 m.
 */
static void test_small_strains_and_long_ways(void)
{
    const char *const laws[] = {"bar.law=paper", "bar.law=svk", "bar.law=neo_hookean"};
    const char *const planes[] = {"bar.plane=strain", "bar.plane=stress"};
    for (int k = 0; k < 6; k++) {
        for (double strain = 0.1; strain > 1e-10; strain *= 0.01)
            assert_at_most(2e-6, forces_apart(laws[k % 3], planes[k / 3], strain, 0), "strain");
        assert_at_most(2e-6, forces_apart(laws[k % 3], planes[k / 3], 0.1, 1000), "shift");
    }
}

/* The step is found by trying out small displacements and velocities, about the body at rest and
 * stretched by half, whose stress float must still tell from that of the base. */
static void test_the_same_step(void)
{
    const char *const laws[] = {"bar.law=paper", "bar.law=svk", "bar.law=neo_hookean"};
    for (int law = 0; law < 3; law++) {
        for (int stretched = 0; stretched < 2; stretched++) {
            double step[2], omega, damping;
            for (int k = 0; k < 2; k++) {
                RIG_OPEN_SOLID(bar, precisions[k], laws[law], "bar.damping_time=0.01 ms");
                for (int64_t i = 0; i < p->n; i++) p->ux[i] = stretched * 0.5 * p->X[i];
                step[k] = solid_stable_step(&rig.sim.solid, p, &omega, &damping);
                for (int64_t i = 0; i < p->n; i++)
                    TEST_ASSERT_TRUE(p->ux[i] == stretched * 0.5 * p->X[i]);
            }
            TEST_ASSERT_TRUE(step[0] > 0);
            assert_near(2e-3 * step[0], step[0], step[1], laws[law]);
        }
    }
}

/* A gradient has as much as the angle of a turn, of which float keeps 1e-7: stresses are off by
 * that times Young's modulus, and by kappa = 50 times as much of the hourglass error. */
static void test_turned_bodies(void)
{
    for (double angle = 0.01; angle < 4; angle *= 4) {
        double P[2][MOST] = {{0}}, top = 0;
        for (int k = 0; k < 2; k++) {
            RIG_OPEN_SOLID(bar, precisions[k]);
            for (int64_t i = 0; i < p->n; i++) {
                const double x = (1 + 1e-6) * p->X[i], y = p->Y[i];
                p->ux[i] = cos(angle) * x - sin(angle) * y - p->X[i];
                p->uy[i] = sin(angle) * x + cos(angle) * y - p->Y[i];
            }
            solid_stress(&rig.sim.solid, p);
            for (int64_t i = 0; i < p->n; i++) P[k][i] = p->Pxx[i];
        }
        for (int64_t i = 0; i < p->n; i++) top = fmax(top, fabs(P[1][i] - P[0][i]));
        printf("turned by %.2f rad: stress off by %.2g E\n", angle, top / 2e6);
        TEST_ASSERT_TRUE(top > 0);
        assert_at_most(2e-6 * angle * 2e6, top, "stress of a turned body");
    }
}

/* Float where every body is held at rest and damped; what is joined to a held body is held. */
static void test_where_float_is_taken(void)
{
#define BLOCK "[solid block]\ndensity = 1100\nyoung = 2e6\npoisson = 0.4\n"
    static const char free_block[] = BLOCK "shape = box 0.4, 0, 0.5, 0.06\n";
    static const char joined[] = BLOCK "shape = box 0.3, 0, 0.4, 0.06\njoined = bar\n";
    static const char moved[] = "clamp_motion = way\n[motion way]\nx = 1 mm*sin(2*pi*t)\n";
    const struct {
        const char *more, *set;
        bool single;
    } cases[] = {
        {"", NULL, true},
        {"", "bar.artificial_viscosity=0.009", false},
        {"", "bar.artificial_viscosity=0.01", true},
        {"", "precision=double", false},
        {free_block, NULL, false},
        {joined, NULL, true},
        {joined, "block.artificial_viscosity=0", false},
        {moved, NULL, false},
        {moved, "numerics.solid_precision=single", true},
        {"", "numerics.solid_precision=double", false},
    };
    for (size_t k = 0; k < COUNT_OF(cases); k++) {
        char text[1024];
        snprintf(text, sizeof text, "%s%s", bar, cases[k].more);
        RIG_OPEN_SOLID(text, cases[k].set);
        const struct solid_sweeps *const expected =
            cases[k].single ? &solid_sweeps_mixed : &solid_sweeps_double;
        snprintf(text, sizeof text, "row %zu: %s", k, rig.sim.solid.sweeps->name);
        TEST_ASSERT_TRUE_MESSAGE(rig.sim.solid.sweeps == expected, text);
    }
}

/* What the sweeps work on is what the particles have, those of a clamp that moves among them, after
 * each step. */
static void test_lanes_follow_the_particles(void)
{
    static const char moved[] = "clamp_motion = way\n[motion way]\n"
                                "x = 5 cm*sin(2000*pi*t)\ny = 3 cm*sin(2000*pi*t)\n";
    char text[1024];
    snprintf(text, sizeof text, "%s%s", bar, moved);
    RIG_OPEN_SOLID(text, precisions[1], "integrator=leapfrog");
    const struct solid *const solid = &rig.sim.solid;
    for (int step = 0; step < 5; step++) {
        solid_advance(&rig.sim.solid, p, 1e-5, 1);
        for (int64_t i = 0; i < p->n; i++) {
            const double x = solid_get(solid, solid->packed[S_UX], i) +
                             solid_get(solid, solid->packed[S_LOW_X], i),
                         y = solid_get(solid, solid->packed[S_UY], i) +
                             solid_get(solid, solid->packed[S_LOW_Y], i);
            assert_near(1e-14 * (1e-3 + fabs(p->ux[i])), p->ux[i], x, "ux");
            assert_near(1e-14 * (1e-3 + fabs(p->uy[i])), p->uy[i], y, "uy");
            TEST_ASSERT_TRUE(solid_get(solid, solid->packed[S_VX], i) == (double)(float)p->vx[i]);
            TEST_ASSERT_TRUE(solid_get(solid, solid->packed[S_VY], i) == (double)(float)p->vy[i]);
        }
    }
    TEST_ASSERT_TRUE(fabs(p->ux[0]) > 1e-3);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_same_oscillation);
    RUN_TEST(test_small_strains_and_long_ways);
    RUN_TEST(test_turned_bodies);
    RUN_TEST(test_the_same_step);
    RUN_TEST(test_where_float_is_taken);
    RUN_TEST(test_lanes_follow_the_particles);
    return UNITY_END();
}
