/* SPDX-License-Identifier: MIT
 * Static equilibrium of solids by Newton's method (T-78a): against the elastica and by hand, in
 * load steps, of bodies that nothing holds; and where the kinetic search takes over. */
#include "rig.h"
#include "time/simulation.h"
#include "unity.h"

#include <math.h>
#include <string.h>

static struct rig rig;
static struct particles *p;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

static void find(bool by_newton)
{
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, relax_to_rest(&rig.sim, &rig.diag), rig.diag.text);
    TEST_ASSERT_EQUAL_INT(by_newton, rig.sim.rest.found);
    TEST_ASSERT_EQUAL_INT(by_newton, rig.sim.state.relax_peaks == 0);
    TEST_ASSERT_EQUAL_DOUBLE(0, rig.sim.state.time);
}

/* What is left of the forces, over the weight of a particle. */
static double unbalanced(double weight)
{
    double most = 0;
    solid_stress(&rig.sim.solid, p);
    solid_forces(&rig.sim.solid, p);
    for (int64_t i = 0; i < p->n; i++)
        most = fmax(most, fmax(fabs(p->sx[i]), fabs(p->sy[i])) / weight);
    return most;
}

/* The cantilever of cases/verify/elastica.cfg, 10 across. */
static const char elastica[] =
    "dp = 2 mm\nend_time = 1\nprecision = double\n[numerics]\nlattice_origin = 0, -0.01\n"
    "[solid beam]\nshape = box -0.008, -0.01, 0.2, 0.01\nclamp = box -0.008, -0.01, 0, 0.01\n"
    "density = 1000\nyoung = 12*1000*9.81*0.2^3/(5*0.02^2)\npoisson = 0\nlaw = svk\n"
    "[load weight]\nbody = beam\nshape = box 0, -0.01, 0.2, 0.01\n"
    "force = 0, -1000*9.81*0.2*0.02*k\n[constants]\nk = 1\n[relax]\n";

static void tip(double at[2])
{
    for (int64_t i = 0; i < p->n; i++)
        if (p->X[i] > 0.198 && fabs(p->Y[i]) < 0.002)
            at[0] = p->ux[i] / 0.2, at[1] = p->uy[i] / 0.2;
}

/* Euler's elastica with w L^3/D = 5; the lattice bends over a length that is longer by half a
 * spacing, and shear adds 0.8 %. */
static void test_elastica(void)
{
    double at[2] = {0};
    RIG_OPEN_SOLID(elastica, NULL);
    find(true);
    tip(at);
    assert_near(0.01, -0.1533, at[0], "x");
    assert_near(0.012, -0.4959, at[1], "y");
    assert_at_most(1e-5, unbalanced(9.81), "left");
    TEST_ASSERT_TRUE(rig.sim.rest.corrections < 15 && rig.sim.rest.load_steps == 1);
}

/* A soft block is drawn out to twice its height, in several load steps. */
static void test_load_steps(void)
{
    double drawn = 0;
    char text[RELAX_TEXT];
    RIG_OPEN_SOLID("dp = 1 cm\nend_time = 1\nprecision = double\n[solid b]\n"
                   "shape = box 0, 0, 0.1, 0.12\nclamp = box 0, 0, 0.1, 0.02\ndensity = 1000\n"
                   "young = 1e5\npoisson = 0.4\nlaw = neo_hookean\n[load press]\nbody = b\n"
                   "shape = box 0, 0.09, 0.1, 0.12\nforce = 0, 20000\n[relax]\n",
                   NULL);
    find(true);
    for (int64_t i = 0; i < p->n; i++) drawn = fmax(drawn, p->uy[i]);
    TEST_ASSERT_TRUE(drawn > 0.1);
    assert_at_most(1e-5, unbalanced(20000 / 3.0), "left");
    TEST_ASSERT_TRUE(rig.sim.rest.load_steps > 1);
    relax_text(&rig.sim, text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, "Newton's method"), text);
}

#define FREE                                                                                  \
    "dp = 1 cm\nend_time = 1\nprecision = double\n[solid bar]\nshape = box 0, 0, 0.2, 0.04\n" \
    "density = 1000\nyoung = 1e6\npoisson = 0.3\nlaw = svk\n[relax]\n"

/* A free bar that is pulled at both ends stretches by F L/(E A), without a clamp. */
static void test_a_free_bar_in_balance(void)
{
    double left = 0, right = 0, sum = 0;
    RIG_OPEN_SOLID(FREE "[load a]\nbody = bar\nshape = box 0, 0, 0.01, 0.04\nforce = -100, 0\n"
                        "[load b]\nbody = bar\nshape = box 0.19, 0, 0.2, 0.04\nforce = 100, 0\n",
                   "bar.poisson=0");
    find(true);
    for (int64_t i = 0; i < p->n; i++) {
        if (p->X[i] < 0.06) left = p->ux[i];
        if (p->X[i] < 0.15) right = p->ux[i];
        sum += p->ux[i];
    }
    const double exact = 9e-2 * 100 / (1e6 * 0.04); /* svk is stiffer by 1.5 times the strain */
    assert_near(0.002 * exact, exact * (1 - 1.5 * 100 / (1e6 * 0.04)), right - left, "pull");
    assert_near(1e-6, 0, sum, "mean");
}

static void test_what_nothing_holds(void)
{
    RIG_OPEN_SOLID(FREE, "gravity=0, -9.81");
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, relax_to_rest(&rig.sim, &rig.diag));
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(rig.diag.text, "nothing holds [solid bar] against a force of (0, -78.5) N/m"),
        rig.diag.text);
    TEST_ASSERT_TRUE(rig.sim.guard.case_at_fault);
}

/* What comes to lie on a wall, what would meet it on the way, and what has no energy, moves to rest
 * as it does beside fluid. */
static void test_the_kinetic_search_takes_over(void)
{
#define SHELF "[wall shelf]\nshape = box 0.1, -0.08, 0.3, -0.04\n"
    static const char held[] =
        "gravity = 0, -9.81\ndp = 1 cm\nend_time = 1\n[solid bar]\nshape = box 0, 0, 0.3, 0.02\n"
        "clamp = box 0, 0, 0.03, 0.02\ndensity = 1000\nyoung = 3e5\npoisson = 0.3\nlaw = svk\n";
    RIG_OPEN_SOLID(FREE "[wall floor]\nshape = box -0.1, -0.05, 0.3, -0.002\n", "gravity=0, -9.81");
    find(false);
    char text[1000];
    for (int k = 0; k < 3; k++) {
        strcat(strcpy(text, held), k == 0 ? "[relax]\n" SHELF : "[relax]\n");
        RIG_OPEN_SOLID(text, k == 1 ? "bar.hourglass_form=printed" : "title=none");
        find(k == 2);
    }
    double lowest = 0;
    for (int64_t i = 0; i < p->n; i++) lowest = fmin(lowest, p->uy[i]);
    TEST_ASSERT_TRUE(lowest < -0.08); /* through the place of the shelf */
}

/* A beam on two hinges, without a clamp, sags by 5 w L^4/(384 EI) and the shear's 1.2 w L^2/(8 G
 * A); the hinges keep its axis from shortening, which holds it up by less than a percent. */
static void test_beam_on_hinges(void)
{
    RIG_OPEN_SOLID("dp = 5 mm\nend_time = 1\nprecision = double\ngravity = 0, -0.05\n"
                   "[solid bar]\nshape = box 0, 0, 0.6, 0.04\nhinge = 0, 0.02\nhinge = 0.6, 0.02\n"
                   "density = 1000\nyoung = 1e6\npoisson = 0\nlaw = svk\n[relax]\n",
                   NULL);
    double sag = 0;
    const double w = 0.05 * 1000 * 0.04,
                 exact = 5 * w * pow(0.6, 4) / (384 * 1e6 * pow(0.04, 3) / 12) +
                         1.2 * w * 0.36 / (8 * 0.5e6 * 0.04);
    find(true);
    for (int64_t i = 0; i < p->n; i++)
        if (fabs(p->X[i] - 0.3) < 0.005) sag = -p->uy[i];
    assert_near(0.02 * exact, exact, sag, "sag");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_elastica);
    RUN_TEST(test_load_steps);
    RUN_TEST(test_a_free_bar_in_balance);
    RUN_TEST(test_beam_on_hinges);
    RUN_TEST(test_what_nothing_holds);
    RUN_TEST(test_the_kinetic_search_takes_over);
    return UNITY_END();
}
