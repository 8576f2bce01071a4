/* SPDX-License-Identifier: MIT
 * Contact at the outline of the shapes (T-61b): how far it is from the surface points, and that
 * forces on points and edges are those of a potential where both are not parallel. */
#include "contact_rig.h"
#include "time/advance.h"
#include "time/timestep.h"
#include "time/energy.h"

#include <math.h>
#include <stdio.h>

/* On lattices that fit, whatever pieces the outline is made of. */
static void test_nothing_is_added_on_a_lattice_that_fits(void)
{
    open_case("dp = 1 cm\nend_time = 1\n[wall floor]\nshape = box -0.1, -0.03, 0.2, 0\n"
              "[solid a]\nshape = box 0, 0.1, 0.05, 0.2\nshape = box 0.03, 0.1, 0.1, 0.15\n"
              "minus = box 0.06, 0.1, 0.08, 0.13\n" RUBBER
              "[solid b]\nlike = a\nshape = box 0.1, 0.1, 0.15, 0.15\njoined = a\n");
    for (int64_t k = 0; k < c->n_points; k++) TEST_ASSERT_TRUE(c->point[k].inset == 0);
    TEST_ASSERT_TRUE(c->max_inset == 0);
}

static void test_outline_of_a_disc(void)
{
    open_case("dp = 5 mm\nend_time = 1\n[solid disc]\nshape = circle 0, 0.06, 0.05\n"
              "minus = circle 0, 0.06, 0.022\n" RUBBER);
    bool within = false, without = false;
    for (int64_t k = 0; k < c->n_points; k++) {
        const double r = hypot(c->point[k].X[0], c->point[k].X[1] - 0.06);
        const double depth = fmin(0.05 - r, r - 0.022);
        assert_near(1e-12, depth - 0.0025, c->point[k].inset, "outline");
        within |= c->point[k].inset > 1e-4;
        without |= c->point[k].inset < -1e-4;
    }
    TEST_ASSERT_TRUE(within && without);
}

/* A body that is no multiple of the spacing: faces of two of them touch where they are drawn. */
static void test_faces_touch_where_they_are_drawn(void)
{
    open_case("dp = 1 cm\nend_time = 1\n[solid a]\nshape = box 0, 0, 0.1, 0.044\n" RUBBER
              "[solid b]\nlike = a\nshape = box 0, 0.05, 0.1, 0.1\n");
    for (int64_t i = 0; i < p->n; i++)
        if (p->body[i] == 1) p->uy[i] = -0.006 + 1e-6;
    TEST_ASSERT_TRUE(timestep_watch_contact(&rig.sim, 0, 1));
    TEST_ASSERT_TRUE(contact_energy(c, p, 0) == 0);
    for (int64_t i = 0; i < p->n; i++)
        if (p->body[i] == 1) p->uy[i] -= 2e-6;
    TEST_ASSERT_TRUE(contact_energy(c, p, 0) > 0);
}

/* Where a clamped body stands in a wall, no outline is near. */
static void test_no_outline_near(void)
{
    open_case("dp = 1 cm\nend_time = 1\n[wall floor]\nshape = box -0.1, -0.06, 0.1, 0\n"
              "[solid a]\nshape = box -0.02, -0.05, 0.02, 0.1\nclamp = box -1, -1, 1, 0\n" RUBBER);
    for (int64_t k = 0; k < c->n_points; k++) TEST_ASSERT_TRUE(c->point[k].inset == 0);
}

/* Flat faces, the lattice of one of which is turned, touch with all points at once, and both
 * together are as stiff as faces on one lattice: 40 points carry 0.86 to 1.17 times 1 N/m
 * (measured). */
static void test_turned_faces_touch_at_once(void)
{
    open_case("dp = 5 mm\nend_time = 1\n[solid a]\nshape = box 0, 0, 0.2, 0.05\n" RUBBER
              "[solid b]\nlike = a\nshape = box -0.1, 0.06, 0.3, 0.11\nlattice_angle = 0.5\n");
    const double overlap = 1e-6, each = 1e6 * overlap;
    for (int64_t i = 0; i < p->n; i++)
        if (p->body[i] == 1) p->uy[i] = -0.01 - overlap;
    TEST_ASSERT_TRUE(timestep_watch_contact(&rig.sim, 0, 1));
    for (int64_t i = 0; i < p->n; i++) p->sx[i] = p->sy[i] = 0;
    contact_forces(c, p, 0);
    double sum = 0;
    for (int64_t i = 0; i < p->n; i++) {
        if (p->body[i] == 1 || p->Y[i] < 0.045) continue;
        const double force = -rig.sim.solid.body[0].mass * p->sy[i];
        assert_near(0.25 * each, each, force, "force on a point");
        sum += force;
    }
    assert_near(0.01 * 40 * each, 40 * each, sum, "force on the face");
}

/* A number between -1 and 1 of its own for each particle and component. */
static double jitter(int64_t i, int k) { return sin(12.9898 * (double)i + 78.233 * k + 1); }

/* Two discs whose outlines are nowhere parallel to the edges between their particles. */
static void press_discs(void)
{
    open_case("dp = 5 mm\nend_time = 1\n[solid a]\nshape = circle 0, 0, 0.03\n" RUBBER
              "artificial_viscosity = 0\nlattice_angle = 0.3\n"
              "[solid b]\nlike = a\nshape = circle 0.065, 0.01, 0.031\nlattice_angle = 0.1\n");
    for (int64_t i = 0; i < p->n; i++) {
        p->ux[i] = (p->body[i] ? -0.0065 : 0) + 2e-4 * jitter(i, 0);
        p->uy[i] = 2e-4 * jitter(i, 1);
    }
}

static double energy(void) { return contact_energy(c, p, 0); }

static void test_forces_of_a_potential(void)
{
    press_discs();
    TEST_ASSERT_TRUE(timestep_watch_contact(&rig.sim, 0, 1));
    const int64_t n = p->n;
    for (int64_t i = 0; i < n; i++) p->sx[i] = p->sy[i] = 0;
    contact_forces(c, p, 0);
    double *const u[2] = {p->ux, p->uy}, *const f[2] = {p->sx, p->sy};
    double largest = 0, sum[2] = {0}, moment = 0;
    int pressed = 0;
    for (int64_t i = 0; i < n; i++) {
        const double mass = rig.sim.solid.body[p->body[i]].mass;
        for (int k = 0; k < 2; k++) {
            const double at = u[k][i], step = 1e-9;
            u[k][i] = at + step;
            const double above = energy();
            u[k][i] = at - step;
            const double below = energy();
            u[k][i] = at;
            largest = fmax(largest, fabs(mass * f[k][i]));
            pressed += f[k][i] != 0;
            sum[k] += mass * f[k][i];
            char text[64];
            snprintf(text, sizeof text, "force on particle %d", (int)i);
            assert_near(1e-4, -(above - below) / (2 * step), mass * f[k][i], text);
        }
        moment += mass * ((p->X[i] + p->ux[i]) * p->sy[i] - (p->Y[i] + p->uy[i]) * p->sx[i]);
    }
    TEST_ASSERT_TRUE(pressed >= 8 && largest > 1);
    assert_at_most(1e-12 * largest, hypot(sum[0], sum[1]), "sum of the forces");
    assert_at_most(1e-13 * largest, fabs(moment), "their moment");
}

/* Without damping discs come apart with the energy that they had. */
static void test_discs_keep_their_energy(void)
{
    open_case(
        "dp = 5 mm\nend_time = 1\nprecision = double\n[solid a]\nshape = circle 0, 0, 0.03\n" RUBBER
        "artificial_viscosity = 0\nlaw = neo_hookean\nlattice_angle = 0.3\nvelocity = 1, 0\n"
        "[solid b]\nlike = a\nshape = circle 0.065, 0.02, 0.031\nlattice_angle = 0.1\n"
        "velocity = -1, 0\n");
    const struct ledger before = simulation_ledger(&rig.sim);
    double most = 0;
    while (rig.sim.state.time < 0.03) {
        rig_run(&rig, rig.sim.state.time + 1e-3);
        const struct ledger row = simulation_ledger(&rig.sim);
        most = fmax(most, row.contact);
        assert_at_most(2e-3 * before.kinetic, fabs(row.dissipated), "energy that does not close");
    }
    TEST_ASSERT_TRUE(most > 0.02 * before.kinetic);
    TEST_ASSERT_TRUE(simulation_ledger(&rig.sim).contact == 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_nothing_is_added_on_a_lattice_that_fits);
    RUN_TEST(test_outline_of_a_disc);
    RUN_TEST(test_faces_touch_where_they_are_drawn);
    RUN_TEST(test_no_outline_near);
    RUN_TEST(test_turned_faces_touch_at_once);
    RUN_TEST(test_forces_of_a_potential);
    RUN_TEST(test_discs_keep_their_energy);
    return UNITY_END();
}
