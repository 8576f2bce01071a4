/* SPDX-License-Identifier: MIT
 * Contact between checks: which pairs are listed, for how long the list holds, what is near, what a
 * clamp holds together. */
#include "contact_rig.h"
#include "time/advance.h"
#include "time/timestep.h"

#include <math.h>

static const char blocks[] =
    "dp = 1 cm\nend_time = 1\n[solid a]\nshape = box 0, 0, 0.04, 0.04\n" RUBBER
    "[solid b]\nlike = a\nshape = box 0.1, 0.1, 0.14, 0.14\n";

/* Moves body b, which is free, to overlap with body a by 2 mm, or back. */
static void overlap(bool overlaps)
{
    for (int64_t i = 0; i < p->n; i++)
        if (p->body[i] == 1) {
            p->ux[i] = overlaps ? -0.062 : 0;
            p->uy[i] = overlaps ? -0.1 : 0;
        }
}

static void test_near_until_apart(void)
{
    open_case(blocks);
    TEST_ASSERT_FALSE(contact_watch(c, p, 0, 1e-6, 1e-6));
    overlap(true);
    TEST_ASSERT_TRUE(contact_watch(c, p, 0, 1e-6, 1e-6));
    overlap(false);
    TEST_ASSERT_FALSE(contact_watch(c, p, 0, 1e-6, 1e-6));
}

/* Before the first check of a run, too, as often as it is asked for. */
static void test_energy_before_the_first_check(void)
{
    open_case(blocks);
    overlap(true);
    contact_forget(c, &rig.sim.particles[KIND_WALL]);
    const double energy = contact_energy(c, p, 0);
    TEST_ASSERT_TRUE(energy > 0);
    TEST_ASSERT_EQUAL_DOUBLE(energy, contact_energy(c, p, 0));
}

/* Two legs of one body, 12 m apart at dp = 1 m. */
static const char legs[] =
    "dp = 1\nend_time = 1\n[solid a]\nshape = polygon 0, 0; 20, 0; 20, 20; 16, 20; "
    "16, 4; 4, 4; 4, 20; 0, 20\n" RUBBER;

static void move_legs(double ux, double vx)
{
    for (int64_t i = 0; i < p->n; i++) {
        const int side = p->Y[i] < 4 ? 0 : p->X[i] < 10 ? 1 : -1;
        p->ux[i] = side * ux;
        p->vx[i] = side * vx;
    }
}

/* Points that may come within reach of each other until the next check are listed. */
static void test_fast_parts_are_listed_early(void)
{
    open_case(legs);
    contact_watch(c, p, 0, 1, 4);
    const int64_t at_rest = c->n_pairs;
    move_legs(0, 1);
    contact_watch(c, p, 0, 1, 4);
    TEST_ASSERT_TRUE(c->n_pairs > at_rest + 8);
}

/* A list is made anew once points of a body have moved by its margin. */
static void test_a_list_that_is_stale(void)
{
    open_case(legs);
    contact_forget(c, &rig.sim.particles[KIND_WALL]);
    contact_watch(c, p, 0, 1, 1);
    const int64_t apart = c->n_pairs;
    move_legs(5, 0);
    contact_watch(c, p, 0, 1e-6, 1e-6);
    TEST_ASSERT_TRUE(c->n_pairs > apart + 8);
}

/* The margin covers 1.5 times the way at the present speeds in all steps until the next check. */
static void test_margin_covers_the_steps(void)
{
    open_case(legs);
    move_legs(0, 1);
    contact_forget(c, &rig.sim.particles[KIND_WALL]);
    timestep_watch_contact(&rig.sim, 0, 1);
    const double one = c->margin;
    contact_forget(c, &rig.sim.particles[KIND_WALL]);
    timestep_watch_contact(&rig.sim, 0, 41);
    assert_near(1e-12, 40 * 1.5 * rig.sim.dt_lone_solid * 2, c->margin - one, "margin");
}

/* A post in a floor that moves with its clamp does not touch the floor; without the clamp it does.
 */
static void test_a_clamp_that_moves_with_its_wall(void)
{
    static const char post[] =
        "dp = 1 cm\nend_time = 1\n[motion m]\nx = 0.1*t\n"
        "[wall floor]\nshape = box -0.2, -0.03, 0.24, 0\nmotion = m\n"
        "[wall other]\nshape = box -0.2, -0.3, 0.24, -0.25\n"
        "[solid a]\nshape = box 0, -0.03, 0.04, 0.1\nclamp = box 0, -0.03, 0.04, 0\n" RUBBER;
    for (int held = 0; held < 2; held++) {
        rig_open(&rig, post, held ? "a.clamp_motion=m" : NULL, NULL);
        p = &rig.sim.particles[KIND_SOLID];
        c = &rig.sim.contact;
        TEST_ASSERT_EQUAL_INT(!held, timestep_watch_contact(&rig.sim, 0, 1));
    }
}

/* Positions of walls that rest come from the particles, as after a fork. */
static void test_walls_that_rest(void)
{
    open_case("dp = 1 cm\nend_time = 1\n[wall floor]\nshape = box -0.1, -0.03, 0.14, 0\n"
              "[solid a]\nshape = box 0, 0.01, 0.04, 0.1\n" RUBBER);
    const struct particles *const walls = &rig.sim.particles[KIND_WALL];
    TEST_ASSERT_TRUE(c->n_points > c->n_moving_points);
    double low = 0, high = -1;
    for (int64_t k = c->n_moving_points; k < c->n_points; k++)
        c->point[k].x[0] = c->point[k].x[1] = 7;
    contact_forget(c, walls);
    for (int64_t k = c->n_moving_points; k < c->n_points; k++) {
        TEST_ASSERT_TRUE(c->point[k].x[0] > -0.1 && c->point[k].x[0] < 0.14);
        low = fmin(low, c->point[k].x[1]);
        high = fmax(high, c->point[k].x[1]);
    }
    assert_near(1e-12, -0.025, low, "lowest");
    assert_near(1e-12, -0.005, high, "highest");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_near_until_apart);
    RUN_TEST(test_energy_before_the_first_check);
    RUN_TEST(test_fast_parts_are_listed_early);
    RUN_TEST(test_a_list_that_is_stale);
    RUN_TEST(test_margin_covers_the_steps);
    RUN_TEST(test_a_clamp_that_moves_with_its_wall);
    RUN_TEST(test_walls_that_rest);
    return UNITY_END();
}
