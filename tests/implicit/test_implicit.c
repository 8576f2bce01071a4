/* SPDX-License-Identifier: MIT
 * Implicit steps of solids (T-90 to T-93): the factors and the tangent, what a step conserves, the
 * period, and the work of loads and clamps. */
#include "solid/solid.h"
#include "solid/hinges.h"
#include "rig.h"
#include "implicit/implicit.h"
#include "implicit/stress.h"
#include "time/energy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define IMPLICIT "[numerics]\nsolid_steps = implicit\n"

static struct rig rig;
static struct particles *p;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

/* --- factors --- */

enum { ROWS = 75, BAND = 20 };

/* A band with a row that begins far left, neither positive nor diagonally dominant. */
static void test_factors_solve(void)
{
    static double A[ROWS][ROWS], x[ROWS + ENVELOPE_ALIGN], b[ROWS + ENVELOPE_ALIGN];
    int64_t first[ROWS];
    struct envelope m;
    struct arena arena = {0};
    struct diag d = {0};
    uint64_t state = 7;
    for (int i = 0; i < ROWS; i++) first[i] = i == 60 ? 3 : i > BAND ? i - BAND : 0;
    TEST_ASSERT_EQUAL_INT(ERR_OK, envelope_create(&m, &arena, ROWS, first, &d));
    for (int i = 0; i < ROWS; i++)
        for (int k = (int)first[i]; k <= i; k++) {
            const double value = i == k ? (i % 3 ? 4 : -3) + noise(&state) : noise(&state);
            A[i][k] = A[k][i] = value;
            envelope_add(&m, i, k, 0.25 * value);
            envelope_add(&m, i, k, 0.75 * value);
        }
    for (int i = 0; i < ROWS; i++) x[i] = noise(&state);
    for (int i = 0; i < ROWS; i++)
        for (int k = 0; k < ROWS; k++) b[i] += A[i][k] * x[k];
    const int64_t negative = envelope_factor(&m);
    TEST_ASSERT_TRUE(negative > 0 && negative < ROWS);
    envelope_solve(&m, b);
    for (int i = 0; i < ROWS; i++) assert_near(1e-10, x[i], b[i], "x");
    /* A matrix without a solution. */
    envelope_clear(&m);
    TEST_ASSERT_EQUAL_INT64(-1, envelope_factor(&m));
    arena_free(&arena);
}

/* --- tangent --- */

static const char *const laws[] = {"bar.law=svk", "bar.law=neo_hookean", "bar.law=paper"};
static const char *const planes[] = {"bar.plane=strain", "bar.plane=stress"};

static const char bar[] =
    "dp = 1 cm\nend_time = 10\n" IMPLICIT
    "[solid bar]\nshape = box 0, 0, 0.23, 0.05\nclamp = box 0, 0, 0.02, 0.05\n"
    "density = 1100\nyoung = 2e6\npoisson = 0.4\nartificial_viscosity = 0\n"
    "mass_damping = 3\n";

/* A strain of some 10 % and a rotation, in a field that bends. */
static void deform(void)
{
    for (int64_t i = 0; i < p->n; i++) {
        const double x = max2(p->X[i] - 0.02, 0), y = p->Y[i];
        p->ux[i] = 0.08 * x - 2 * x * y;
        p->uy[i] = 1.5 * x * x + 0.1 * x * y;
    }
}

/* Accelerations at displacements moved by `factor` times a field without a pattern. */
static void forces_beside(double factor, const double *dx, const double *dy)
{
    for (int64_t i = 0; i < p->n; i++) {
        p->ux[i] += factor * dx[i];
        p->uy[i] += factor * dy[i];
    }
    solid_stress_and_forces(&rig.sim.solid, p, 0);
    for (int64_t i = 0; i < p->n; i++) {
        p->ux[i] -= factor * dx[i];
        p->uy[i] -= factor * dy[i];
    }
}

/* The factored matrix undoes inertia and the differences of the forces, for the laws that have an
 * energy. That of the article's law is only the symmetric part. */
static void test_tangent_is_the_difference_of_forces(void)
{
    enum { MOST = 200 };
    const double dt = 2e-3, small = 1e-7;
    for (int k = 0; k < 4; k++) {
        double dx[MOST], dy[MOST], up[2][MOST];
        uint64_t state = 11;
        RIG_OPEN_SOLID(bar, laws[k / 2], planes[k % 2]);
        struct implicit *const by = rig.sim.solid.implicit;
        TEST_ASSERT_TRUE(p->n <= MOST);
        deform();
        for (int64_t i = 0; i < p->n; i++) {
            p->matrix_ux[i] = p->ux[i];
            p->matrix_uy[i] = p->uy[i];
            p->matrix_dt[i] = dt;
            dx[i] = 0.01 * p->free[i] * noise(&state);
            dy[i] = 0.01 * p->free[i] * noise(&state);
        }
        implicit_resume(&rig.sim.solid, p);
        TEST_ASSERT_TRUE(by->factored);
        forces_beside(small, dx, dy);
        memcpy(up[0], p->sx, (size_t)p->n * sizeof(double));
        memcpy(up[1], p->sy, (size_t)p->n * sizeof(double));
        forces_beside(-small, dx, dy);
        for (int64_t i = 0; i < p->n; i++) {
            if (by->order[i] < 0) continue;
            const double mass = rig.sim.solid.body[0].mass, rate = 2 / dt * (2 / dt + 3);
            double *const r = &by->unknown[2 * by->order[i]];
            r[0] = mass * (rate * dx[i] - (up[0][i] - p->sx[i]) / (2 * small));
            r[1] = mass * (rate * dy[i] - (up[1][i] - p->sy[i]) / (2 * small));
        }
        envelope_solve(&by->matrix, by->unknown);
        for (int64_t i = 0; i < p->n; i++) {
            if (by->order[i] < 0) continue;
            assert_near(1e-8, dx[i], by->unknown[2 * by->order[i]], "x");
            assert_near(1e-8, dy[i], by->unknown[2 * by->order[i] + 1], "y");
        }
    }
}

/* The rates of all laws by hand against central differences, whose error is below 1e-9 of the
 * modulus; at 40 % of strain and none. */
static void test_stress_rates_are_differences_of_stress(void)
{
    const double small = 1e-6;
    for (int k = 0; k < 6; k++)
        for (int big = 0; big < 2; big++)
            for (int c = 0; c < 3; c++) {
                RIG_OPEN_SOLID(bar, laws[k / 2], planes[k % 2]);
                const struct solid_body *const body = &rig.sim.solid.body[0];
                const double at[4] = {0.4 * big, 0.1 * big, 0.1 * big, -0.2 * big},
                             rate[4] = {c == 0, 0.5 * (c == 2), 0.5 * (c == 2), c == 1};
                struct vtensor2 E[3];
                for (int n = 0; n < 3; n++) {
                    double e[4];
                    for (int m = 0; m < 4; m++) e[m] = at[m] + (n - 1) * small * rate[m];
                    E[n] = (struct vtensor2){vset(e[0]), vset(e[1]), vset(e[2]), vset(e[3])};
                }
                const struct vtensor2 low = stress_of_strain(body, E[0]),
                                      high = stress_of_strain(body, E[2]);
                const struct vtensor2 found =
                    stress_rate(body, E[1], stress_of_strain(body, E[1]),
                                (struct vtensor2){vset(rate[0]), vset(rate[1]), vset(rate[2]),
                                                  vset(rate[3])});
                const double per = 1 / (2 * small), limit = 2e-9 * body->young;
                assert_near(limit, (high.xx[0] - low.xx[0]) * per, found.xx[0], laws[k / 2]);
                assert_near(limit, (high.xy[0] - low.xy[0]) * per, found.xy[0], laws[k / 2]);
                assert_near(limit, (high.yy[0] - low.yy[0]) * per, found.yy[0], laws[k / 2]);
            }
}

/* --- what a step conserves --- */

static double angular_momentum(void)
{
    double sum = 0;
    for (int64_t i = 0; i < p->n; i++)
        sum += rig.sim.solid.body[p->body[i]].mass * (p->x[i] * p->vy[i] - p->y[i] * p->vx[i]);
    return sum;
}

static double energy(void)
{
    const struct ledger row = simulation_ledger(&rig.sim);
    return row.kinetic + row.elastic + row.hourglass + row.potential;
}

/* A free bar that turns by some 60 degrees and is stretched by a tenth, in steps of 15 times the
 * explicit one. */
static void test_free_bodies_keep_energy_and_momentum(void)
{
    static const char *const free_bar =
        "dp = 1 cm\nend_time = 10\n" IMPLICIT "fixed_step = 2 ms\n"
        "[solid bar]\nshape = box -0.12, -0.03, 0.12, 0.03\ndensity = 1100\nyoung = 2e6\n"
        "poisson = 0.4\nartificial_viscosity = 0\n"
        "velocity = 3 - 15*y + 5*x, 1 + 15*x\n[contact none]\nenabled = off\n";
    for (int k = 0; k < 6; k++) {
        char what[80];
        RIG_OPEN_SOLID(free_bar, laws[k / 2], planes[k % 2]);
        TEST_ASSERT_TRUE(rig.sim.solid.stable_step < 2e-3 / 15);
        const double energy_before = energy(), turning = angular_momentum();
        const struct ledger before = simulation_ledger(&rig.sim);
        rig_run(&rig, 0.08);
        const struct ledger after = simulation_ledger(&rig.sim);
        snprintf(what, sizeof what, "%s, %s", laws[k / 2], planes[k % 2]);
        TEST_ASSERT_TRUE_MESSAGE(after.elastic > 1e-4 * before.kinetic, what);
        /* The article's law has no energy (T-41a). */
        assert_near((k < 4 ? 2e-6 : 1e-3) * energy_before, energy_before, energy(), what);
        assert_near(1e-6 * before.momentum_x, before.momentum_x, after.momentum_x, what);
        assert_near(1e-6 * before.momentum_x, before.momentum_y, after.momentum_y, what);
        assert_near(1e-6 * turning, turning, angular_momentum(), what);
    }
}

/* --- period --- */

/* The first mode of a cantilever of length 0.2 m, roughly. */
static const char cantilever[] =
    "dp = 5 mm\nend_time = 100\n" IMPLICIT
    "[solid plate]\nshape = box -0.02, -0.01, 0.2, 0.01\nclamp = box -0.02, -0.01, 0, 0.01\n"
    "density = 1000\nyoung = 2e6\npoisson = 0.4\nlaw = svk\nartificial_viscosity = 0\n"
    "velocity = 0, 20*max(x, 0)^2\n";

static double tip(void)
{
    double y = 0;
    for (int64_t i = 0; i < p->n; i++)
        if (p->X[i] > 0.197 && fabs(p->Y[i]) < 0.005) y = p->uy[i];
    return y;
}

/* Mean period over `count` passages of the tip through its place at rest. */
static double period_of(int count)
{
    double first = 0, before = tip(), time = 0;
    for (int seen = 0; seen <= count;) {
        const double last = time;
        rig_steps(&rig, 1, 100);
        time = rig.sim.state.time;
        const double now = tip();
        if (before < 0 && now >= 0) {
            const double at = last + (time - last) * before / (before - now);
            if (seen++ == 0) first = at;
            if (seen == count + 1) return (at - first) / count;
        }
        before = now;
    }
    return 0;
}

/* 20 times the explicit step: period within 0.2 %, energy over 100 periods within 0.1 %. The period
 * of small oscillations that sets the step of its own is that of the motion. */
static void test_long_steps_keep_the_period(void)
{
    RIG_OPEN_SOLID(cantilever, "plate.law=svk", "numerics.fixed_step=1e-5",
                   "numerics.solid_steps=explicit", "numerics.solid_precision=double");
    const double stable = rig.sim.solid.stable_step, exact = period_of(4);
    char step[60];
    snprintf(step, sizeof step, "numerics.fixed_step=%.17g", 20 * stable);
    RIG_OPEN_SOLID(cantilever, step);
    const double before = energy(), found = period_of(4);
    assert_near(2e-3 * exact, exact, found, "period");
    rig_run(&rig, 100 * exact);
    assert_near(1e-5 * before, before, energy(), "energy");
    RIG_OPEN_SOLID(cantilever, "plate.law=svk");
    assert_near(0.02 * exact, exact, rig.sim.solid.implicit->period, "of small oscillations");
    assert_near(1e-12, rig.sim.solid.implicit->period / 100, rig.sim.dt_solid, "step");
}

/* A free bar: 22.373 sqrt(EI/(m L^4)), with E/(1 - nu^2); thin, so that shear adds little. */
static void test_period_of_a_free_bar(void)
{
    RIG_OPEN_SOLID("dp = 5 mm\nend_time = 1\n" IMPLICIT
                   "[solid bar]\nshape = box 0, 0, 1, 0.04\ndensity = 1000\nyoung = 2e6\n"
                   "poisson = 0\n",
                   "bar.law=svk");
    const double omega = 22.373 * sqrt(2e6 / 1000 / 12) * 0.04;
    assert_near(0.02 * 2 * M_PI / omega, 2 * M_PI / omega, rig.sim.solid.implicit->period,
                "period");
}

/* --- actions from outside --- */

static const char moved[] =
    "dp = 1 cm\nend_time = 10\ngravity = 2*sin(9*t), -9.81\n" IMPLICIT "fixed_step = 2 ms\n"
    "[solid bar]\nshape = box 0, 0, 0.24, 0.04\nclamp = box 0, 0, 0.03, 0.04\n"
    "clamp_motion = shake\ndensity = 1100\nyoung = 2e6\npoisson = 0.4\nlaw = neo_hookean\n"
    "artificial_viscosity = 0\n"
    "[motion shake]\nx = 0.01*t^2\ny = 0.005*(1 - cos(20*t))\n"
    "[load pull]\nbody = bar\nshape = box 0.22, 0, 0.24, 0.04\nforce = 5, 8\nhistory = sin(7*t)\n";

/* What loads, moving clamps and gravity in time give is what the body has gained. The work of the
 * variable part of gravity is summed with the velocities at the ends of steps (T-70). */
static void test_work_closes_the_account(void)
{
    RIG_OPEN_SOLID(moved, "gravity=0, -9.81");
    rig_run(&rig, 0.4);
    struct ledger row = simulation_ledger(&rig.sim);
    TEST_ASSERT_TRUE(row.elastic > 0.01 && fabs(rig.sim.state.wall_work) > 0.01);
    assert_near(2e-6 * fabs(rig.sim.state.wall_work), 0, row.dissipated, "dissipated");
    RIG_OPEN_SOLID(moved, "bar.damping_time=1 ms");
    rig_run(&rig, 0.4);
    row = simulation_ledger(&rig.sim);
    TEST_ASSERT_TRUE(row.dissipated > 0);
}

/* The first mode decays as with explicit steps. */
static void test_damping_is_that_of_explicit_steps(void)
{
    const double period = 0.26;
    static const char *const ways[] = {"plate.damping_time=0.2 ms", "plate.mass_damping=0.3"};
    for (int k = 0; k < 2; k++) {
        double loss[2];
        for (int explicit = 0; explicit < 2; explicit ++) {
            RIG_OPEN_SOLID(cantilever, ways[k], "plate.velocity=0, 2*max(x, 0)^2",
                           explicit ? "numerics.solid_steps=explicit" : "title=implicit");
            rig_run(&rig, 2 * period); /* faster modes have decayed, as far as they do */
            const double before = energy();
            rig_run(&rig, 4 * period);
            loss[explicit] = log(energy() / before);
        }
        TEST_ASSERT_TRUE(loss[1] < -0.02);
        assert_near(0.02 * -loss[1], loss[1], loss[0], ways[k]);
    }
}

/* A plate between waters rings at its wet frequency, whatever its steps. */
static void test_frequency_under_water(void)
{
    static const char plate[] =
        "scheme = paper\ndp = 5 mm\nend_time = 1\ngravity = 0, -9.81\n[fluid left]\n"
        "shape = box 0, 0, 0.1, 0.1\nsound_speed = 20\nsurface = 0.1\n"
        "artificial_viscosity = 0.1\ndensity_diffusion = 0.1\ndiffusion_form = fourtakas\n"
        "[fluid right]\nlike = left\nshape = box 0.12, 0, 0.22, 0.1\n[wall tank]\n"
        "shape = polyline thickness -0.02: 0, 0.2; 0, 0; 0.1, 0\n"
        "shape = polyline thickness -0.02: 0.12, 0; 0.22, 0; 0.22, 0.2\n[solid plate]\n"
        "shape = box 0.1, -0.02, 0.12, 0.12\nclamp = box 0.1, -0.02, 0.12, 0\n"
        "density = 2700\nyoung = 4e8\npoisson = 0.3\nvelocity = 0.2*(max(y, 0)/0.12)^2, 0\n";
    double period[2];
    for (int k = 0; k < 2; k++) {
        double passed[4], before = 0, last = 0;
        int n = 0;
        RIG_OPEN_SOLID(plate,
                       k ? "numerics.solid_steps=implicit" : "numerics.solid_steps=explicit");
        while (n < 4) {
            double now = 0;
            rig_steps(&rig, 1, 1);
            for (int64_t i = 0; i < p->n; i++)
                if (p->X[i] < 0.105 && p->Y[i] > 0.115) now = p->ux[i];
            if (before < 0 && now >= 0)
                passed[n++] = last + (rig.sim.state.time - last) * before / (before - now);
            before = now;
            last = rig.sim.state.time;
        }
        period[k] = (passed[3] - passed[0]) / 3;
        TEST_ASSERT_TRUE(k ? rig.sim.substeps == 1 : rig.sim.substeps > 30);
    }
    assert_near(0.002 * period[0], period[0], period[1], "period");
}

/* Bodies of different stiffness that are joined keep energy and momentum as one does. */
static void test_joined_bodies(void)
{
    RIG_OPEN_SOLID("dp = 1 cm\nend_time = 10\n" IMPLICIT "fixed_step = 1 ms\n"
                   "[solid a]\nshape = box -0.12, 0, 0, 0.06\ndensity = 1100\nyoung = 2e6\n"
                   "poisson = 0.4\nlaw = svk\nartificial_viscosity = 0\n"
                   "velocity = 3 - 15*y + 5*x, 1 + 15*x\n"
                   "[solid b]\nlike = a\nshape = box 0, 0, 0.12, 0.06\nyoung = 8e6\n"
                   "joined = a\n[contact none]\nenabled = off\n",
                   "title=joined");
    const double before = energy();
    const struct ledger start = simulation_ledger(&rig.sim);
    rig_run(&rig, 0.08);
    const struct ledger end = simulation_ledger(&rig.sim);
    TEST_ASSERT_TRUE(end.elastic > 1e-4 * start.kinetic);
    assert_near(2e-6 * before, before, energy(), "energy");
    assert_near(1e-6 * start.momentum_x, start.momentum_x, end.momentum_x, "x");
    assert_near(1e-6 * start.momentum_x, start.momentum_y, end.momentum_y, "y");
}

static void assert_two_hinges_hold(void)
{
    const struct hinges *const hinges = rig.sim.solid.hinges;
    double off[4] = {0};
    for (int64_t k = 0; k < hinges->n_nodes; k++) {
        const struct hinge_node *const node = &hinges->node[k];
        off[2 * node->hinge] += node->weight * p->ux[node->particle];
        off[2 * node->hinge + 1] += node->weight * p->uy[node->particle];
    }
    for (int k = 0; k < 4; k++) assert_near(1e-12, 0, off[k], "hinge");
}

/* Two bars, hinged to each other and the first to a point, fall from the horizontal: the points
 * stay where they must, and energy is kept while they turn by more than 90 degrees. */
static void test_double_pendulum(void)
{
    RIG_OPEN_SOLID("dp = 1 cm\nend_time = 10\ngravity = 0, -9.81\n" IMPLICIT "fixed_step = 1 ms\n"
                   "[solid a]\nshape = box 0, 0, 0.3, 0.04\nhinge = 0.02, 0.02\n"
                   "density = 1000\nyoung = 2e6\npoisson = 0.3\nlaw = svk\n"
                   "artificial_viscosity = 0\n[solid b]\nshape = box 0.31, 0, 0.61, 0.04\n"
                   "hinge = 0.305, 0.02, a\ndensity = 1000\nyoung = 2e6\npoisson = 0.3\n"
                   "law = svk\nartificial_viscosity = 0\n[contact none]\nenabled = off\n",
                   "title=double");
    TEST_ASSERT_TRUE(rig.sim.solid.stable_step < 1e-4);
    const double before = energy();
    double lowest = 0;
    rig_run(&rig, 0.5);
    assert_two_hinges_hold();
    for (int64_t i = 0; i < p->n; i++) lowest = min2(lowest, p->uy[i]);
    const struct ledger row = simulation_ledger(&rig.sim);
    TEST_ASSERT_TRUE(lowest < -0.4 && row.kinetic > 1);
    assert_near(1e-5 * row.kinetic, before, energy(), "energy");
    /* Where hinges have no solution with the factors, the step finds new ones. It is not halved. */
    const double dt = *p->matrix_dt;
    for (int k = 0; k < 16; k++) rig.sim.solid.implicit->flexibility[k] *= -1;
    rig_steps(&rig, 1, 1);
    assert_near(0.1 * dt, dt, *p->matrix_dt, "step of the factors");
    assert_two_hinges_hold();
}

/* A bar on a wall that moves: the hinge does the work that the bar gains, and it moves as with
 * explicit steps. */
static void test_hinge_on_a_moving_wall(void)
{
    static const char text[] =
        "dp = 1 cm\nend_time = 10\ngravity = 0, -9.81\n" IMPLICIT
        "[solid bar]\nshape = box 0, 0, 0.04, 0.3\nhinge = 0.02, 0.29, arm\ndensity = 1000\n"
        "young = 2e6\npoisson = 0.3\nlaw = svk\nartificial_viscosity = 0\n"
        "[wall arm]\nshape = box 0, 0.32, 0.04, 0.36\nmotion = shake\n[contact none]\n"
        "enabled = off\n[motion shake]\nx = 0.05*(1 - cos(8*t))\ny = 0\n";
    double at[2] = {0}, work[2] = {0};
    for (int explicit = 0; explicit < 2; explicit ++) {
        RIG_OPEN_SOLID(text,
                       explicit ? "numerics.solid_steps=explicit" : "numerics.fixed_step=1 ms",
                       "numerics.solid_precision=double");
        const double before = energy();
        rig_run(&rig, 0.6);
        for (int64_t i = 0; i < p->n; i++)
            if (p->Y[i] < 0.01 && p->X[i] < 0.01) at[explicit] = p->ux[i];
        work[explicit] = rig.sim.state.wall_work;
        assert_near(5e-3 * fabs(work[explicit]), energy() - before, work[explicit], "work");
    }
    TEST_ASSERT_TRUE(fabs(work[1]) > 0.05);
    assert_near(1e-3, at[1], at[0], "where it swings");
    assert_near(0.02 * fabs(work[1]), work[1], work[0], "work of both");
}

/* Surfaces near each other: explicit sub-steps until they part. */
static void test_contact_is_explicit(void)
{
    RIG_OPEN_SOLID("dp = 1 cm\nend_time = 1\n" IMPLICIT
                   "[solid ball]\nshape = circle 0, 0.1, 0.05\ndensity = 1000\nyoung = 1e6\n"
                   "poisson = 0.3\nvelocity = 0, -1\nlaw = svk\n"
                   "[wall floor]\nshape = box -0.1, -0.03, 0.1, 0\n",
                   "ball.artificial_viscosity=0");
    bool touched = false;
    const double before = energy();
    TEST_ASSERT_TRUE(implicit_is_next(&rig.sim.solid));
    for (int k = 0; k < 20000 && rig.sim.state.time < 0.2; k++) {
        rig_steps(&rig, 1, 0.2);
        touched |= !implicit_is_next(&rig.sim.solid);
    }
    TEST_ASSERT_TRUE(touched && implicit_is_next(&rig.sim.solid));
    double up = 0;
    for (int64_t i = 0; i < p->n; i++) up += p->vy[i] / (double)p->n;
    TEST_ASSERT_TRUE(up > 0.5);
    assert_near(0.03 * before, before, energy(), "energy");
}

/* A step that cannot be solved stops the run with its reason. */
static void test_a_step_without_solution_stops(void)
{
    RIG_OPEN_SOLID("dp = 5 mm\nend_time = 100\n" IMPLICIT "fixed_step = 0.1\n"
                   "[solid plate]\nshape = box -0.02, -0.01, 0.2, 0.01\n"
                   "clamp = box -0.02, -0.01, 0, 0.01\ndensity = 1000\nyoung = 2e6\n"
                   "poisson = 0.4\nlaw = neo_hookean\n"
                   "[load press]\nbody = plate\nshape = box 0.19, -0.01, 0.2, 0.01\n"
                   "force = -1e7, 0\n",
                   "title=crushed");
    enum err e = ERR_OK;
    for (int k = 0; k < 3 && !e; k++) e = simulation_step(&rig.sim, 100, &rig.diag);
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, e);
    TEST_ASSERT_NOT_NULL(strstr(rig.diag.text, "implicit step"));
}

static void test_refused(void)
{
    static const char solid[] =
        "dp = 1 cm\nend_time = 1\n[solid bar]\nshape = box 0, 0, 0.2, 0.04\n"
        "density = 1000\nyoung = 1e6\npoisson = 0\n%s\n[numerics]\nsolid_steps = implicit\n%s\n%s";
    static const struct {
        const char *body, *numerics, *more, *why;
    } row[] = {
        {"hourglass_form = printed", "", "", "hourglass_form = printed"},
        {"", "solid_precision = single", "", "solid_precision"},
        {"", "multirate = off", "[fluid water]\nshape = box 0, 0.1, 0.2, 0.2\nsound_speed = 20\n",
         "multirate"},
    };
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        char text[600];
        snprintf(text, sizeof text, solid, row[k].body, row[k].numerics, row[k].more);
        rig_refuses(text, row[k].why);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_factors_solve);
    RUN_TEST(test_stress_rates_are_differences_of_stress);
    RUN_TEST(test_tangent_is_the_difference_of_forces);
    RUN_TEST(test_free_bodies_keep_energy_and_momentum);
    RUN_TEST(test_long_steps_keep_the_period);
    RUN_TEST(test_period_of_a_free_bar);
    RUN_TEST(test_work_closes_the_account);
    RUN_TEST(test_damping_is_that_of_explicit_steps);
    RUN_TEST(test_frequency_under_water);
    RUN_TEST(test_joined_bodies);
    RUN_TEST(test_double_pendulum);
    RUN_TEST(test_hinge_on_a_moving_wall);
    RUN_TEST(test_contact_is_explicit);
    RUN_TEST(test_a_step_without_solution_stops);
    RUN_TEST(test_refused);
    return UNITY_END();
}
