/* SPDX-License-Identifier: MIT
 * Contact of solids: a pair by hand, momentum, energy, walls, restart. */
#include "output/checkpoint.h"
#include "rig.h"
#include "time/energy.h"
#include "time/timestep.h"
#include "unity.h"

#include <math.h>
#include <string.h>

static struct rig rig;
static struct particles *p;

void setUp(void) { rig_one_thread(); }
void tearDown(void) { rig_close(&rig); }

#define BLOCKS                                                                                    \
    "dp = 1 cm\nend_time = 1\nintegrator = symplectic\n[contact all]\n[solid a]\nshape = box 0, " \
    "0, 0.04, 0.04\ndensity = "                                                                   \
    "1000\n"                                                                                      \
    "young = 2e6\npoisson = 0.3\nartificial_viscosity = 0\nlaw = svk\n"                           \
    "[solid b]\nlike = a\nyoung = 1e6\ndensity = 2000\n"

static int64_t at(double X, double Y)
{
    for (int64_t i = 0; i < p->n; i++)
        if (fabs(p->X[i] - X) < 1e-9 && fabs(p->Y[i] - Y) < 1e-9) return i;
    TEST_FAIL_MESSAGE("no particle there");
    return -1;
}

static void evaluate(void)
{
    timestep_watch_contact(&rig.sim, rig.sim.state.time, 1);
    solid_stress(&rig.sim.solid, p);
    solid_forces(&rig.sim.solid, p);
}

/* What contact adds to the force on a particle, N/m. */
static void contact_force(int64_t i, double f[2])
{
    const double mass = rig.sim.solid.body[p->body[i]].mass;
    evaluate();
    f[0] = mass * p->sx[i];
    f[1] = mass * p->sy[i];
    rig.sim.solid.contact = NULL;
    solid_stress(&rig.sim.solid, p);
    solid_forces(&rig.sim.solid, p);
    f[0] -= mass * p->sx[i];
    f[1] -= mass * p->sy[i];
}

/* To the first body. */
static void give_velocity(double vx, double vy)
{
    for (int64_t i = 0; i < p->n; i++) {
        if (p->body[i]) continue;
        p->vx[i] = vx;
        p->vy[i] = vy;
    }
}

/* The same for the first body as a whole. */
static void force_on_first(double f[2])
{
    f[0] = f[1] = 0;
    for (int64_t i = 0; i < p->n; i++) {
        double part[2];
        if (p->body[i]) continue;
        contact_force(i, part);
        f[0] += part[0];
        f[1] += part[1];
    }
}

/* Corner to corner: one pair only, brought to 8 mm along x and 4 mm along y. r = sqrt(80) mm; each
 * corner is the end of two edges of the other one's body, so that both surfaces together push with
 * k r0 (r0/r - 1), r0 = 10 mm, k = 2 x 4/3e6 Pa, of 1e6 and 2e6 Pa in series. With velocities of
 * the whole body: the approach (v.x)/r through the damping, the rest through friction, which the
 * edges bear with both ends. */
static void test_a_pair_by_hand(void)
{
    RIG_OPEN_SOLID(BLOCKS "shape = box 0.05, 0.05, 0.09, 0.09\n", "all.stiffness=2",
                   "all.damping=0.1", "all.friction=0.5");
    const int64_t a = at(0.035, 0.035), b = at(0.055, 0.055);
    for (int64_t i = 0; i < p->n; i++)
        if (p->body[i] == 1) {
            p->ux[i] = 0.008 - 0.02;
            p->uy[i] = 0.004 - 0.02;
        }
    const double r = sqrt(80e-6), x = -0.008 / r, y = -0.004 / r,
                 push = 8e6 / 3 * 0.01 * (0.01 / r - 1);
    double f[2];
    contact_force(a, f);
    assert_near(1e-9 * push, push * x, f[0], "fx");
    assert_near(1e-9 * push, push * y, f[1], "fy");
    contact_force(b, f);
    assert_near(1e-9 * push, -push * x, f[0], "fx on the other");

    /* m = 0.1 and 0.2 kg/m: m_ab = 1/15; critical = 2 sqrt(k m_ab). */
    const double critical = 2 * sqrt(8e6 / 45), vx = 0.3, vy = -0.1;
    give_velocity(vx, vy);
    const double along = vx * x + vy * y, n = push - 0.1 * critical * along;
    const double sx = vx - along * x, sy = vy - along * y, slip = hypot(sx, sy);
    const double drag = fmin(0.5 * n, 0.5 * critical * slip) / slip;
    TEST_ASSERT_TRUE(critical * slip < n); /* drag is that of the dashpot, not of friction */
    force_on_first(f);
    assert_near(1e-9 * push, n * x - drag * sx, f[0], "fx in motion");
    assert_near(1e-9 * push, n * y - drag * sy, f[1], "fy in motion");
    /* Fast apart: the dashpot may not pull. */
    give_velocity(1e3 * x, 1e3 * y);
    force_on_first(f);
    TEST_ASSERT_TRUE(fabs(f[0]) < 1e-9 * push && fabs(f[1]) < 1e-9 * push);
}

/* With a gap the same pair pushes from a spacing and the gap on: r0 = 20 mm. */
static void test_a_gap_by_hand(void)
{
    RIG_OPEN_SOLID(BLOCKS "shape = box 0.05, 0.05, 0.09, 0.09\n", "all.gap=dp");
    const int64_t a = at(0.035, 0.035);
    for (int64_t i = 0; i < p->n; i++)
        if (p->body[i] == 1) {
            p->ux[i] = 0.012 - 0.02;
            p->uy[i] = 0.014 - 0.02;
        }
    const double r = hypot(0.012, 0.014), push = 4e6 / 3 * 0.02 * (0.02 / r - 1);
    double f[2];
    contact_force(a, f);
    assert_near(1e-9 * push, -push * 0.012 / r, f[0], "fx");
    assert_near(1e-9 * push, -push * 0.014 / r, f[1], "fy");
}

/* What began nearer than the gap keeps the distance it began with. */
static void test_a_gap_spares_what_began_within(void)
{
    RIG_OPEN_SOLID("dp = 1 cm\nend_time = 1\n[contact all]\ngap = dp\n"
                   "[wall floor]\nshape = box -0.1, -0.03, 0.14, 0\n"
                   "[solid a]\nshape = box 0, 0, 0.04, 0.1\n"
                   "density = 1000\nyoung = 1e6\npoisson = 0.3\n",
                   NULL);
    const int64_t near = at(0.005, 0.005);
    double f[2];
    contact_force(near, f);
    TEST_ASSERT_TRUE(f[0] == 0 && f[1] == 0);
    p->uy[near] = -0.002;
    contact_force(near, f);
    TEST_ASSERT_TRUE(f[1] > 0);
}

/* With fluid and the standard scheme one layer of it fits between surfaces, unless a gap is given.
 */
static void test_fluid_keeps_a_layer(void)
{
    static const char scene[] =
        "dp = 1 cm\nend_time = 1\n[wall floor]\nshape = box -0.1, -0.03, 0.14, 0\n"
        "[solid a]\nshape = box 0, 0.05, 0.04, 0.1\ndensity = 1000\nyoung = 1e6\npoisson = 0.3\n"
        "dp = 5 mm\n";
    static const char fluid[] = "[fluid w]\nshape = box 0.06, 0, 0.1, 0.04\nsound_speed = 10\n";
    static const struct {
        const char *text, *set;
        double gap;
    } row[] = {{scene, "scheme=standard", 0},        {fluid, "scheme=standard", 0.01},
               {fluid, "scheme=paper", 0},           {"[contact all]\n", "scheme=standard", 0},
               {"[contact c]\ngap = 0\n", fluid, 0}, {"[contact c]\ngap = 0.002\n", fluid, 0.002}};
    char text[1024];
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        const bool two = row[k].set == fluid;
        snprintf(text, sizeof text, "%s%s%s", scene, k ? row[k].text : "", two ? fluid : "");
        rig_open(&rig, text, two ? "scheme=standard" : row[k].set, NULL);
        const int pair = rig.sim.contact.n_solids + rig.sim.contact.n_walls - 1;
        assert_near(1e-12, 0.0075 + row[k].gap, rig.sim.contact.law[pair].reach, row[k].set);
    }
}

/* Bodies that begin nearer than a layer keep none, and a body has none to itself; a gap that is
 * given stays. */
static void test_no_layer_where_bodies_begin_near(void)
{
    static const char near[] =
        "dp = 1 cm\nend_time = 1\n[wall floor]\nshape = box -0.1, -0.03, 0.14, 0\n"
        "[wall lid]\nshape = box -0.1, 0.2, 0.14, 0.23\n"
        "[solid a]\nshape = box 0, 0.005, 0.04, 0.1\ndensity = 1000\nyoung = 1e6\npoisson = 0.3\n"
        "dp = 5 mm\n[fluid w]\nshape = box 0.06, 0, 0.1, 0.04\nsound_speed = 10\n";
    static const struct {
        const char *contact;
        double itself, floor, lid;
    } row[] = {
        {"", 0, 0, 0.01},
        {"[contact c]\ngap = 0.002\n", 0.002, 0.002, 0.002},
        {"[contact c]\nbetween = a, floor\ngap = 0.003\n[contact d]\nbetween = a, lid\n", -1, 0.003,
         0.01},
    };
    char text[1024];
    for (size_t k = 0; k < COUNT_OF(row); k++) {
        snprintf(text, sizeof text, "%s%s", near, row[k].contact);
        rig_open(&rig, text, "scheme=standard", NULL);
        const struct contact_law *const law = rig.sim.contact.law;
        if (row[k].itself >= 0)
            assert_near(1e-12, 0.005 + row[k].itself, law[0].reach, row[k].contact);
        assert_near(1e-12, 0.0075 + row[k].floor, law[1].reach, row[k].contact);
        assert_near(1e-12, 0.0075 + row[k].lid, law[2].reach, row[k].contact);
    }
}

/* Bodies that begin near each other keep the gap of the section of the two. */
static void test_the_gap_of_bodies_that_begin_near(void)
{
    static const char text[] =
        "dp = 1 cm\nend_time = 1\n[solid a]\nshape = box 0, 0, 0.04, 0.1\ndensity = 1000\n"
        "young = 1e6\npoisson = 0.3\n[solid b]\nlike = a\nshape = box 0.05, 0, 0.09, 0.1\n"
        "[fluid w]\nshape = box 0.2, 0, 0.3, 0.04\nsound_speed = 10\n"
        "[contact of_a]\nbetween = a, a\ngap = 0.002\n"
        "[contact of_b]\nbetween = b, b\ngap = 0.004\n"
        "[contact of_both]\nbetween = a, b\ngap = 0.003\n"
        "[solid c]\nlike = a\nshape = box 0.1, 0, 0.14, 0.1\n"
        "[contact of_last]\nbetween = c, b\ngap = 0.02\n";
    rig_open(&rig, text, "scheme=standard", NULL);
    const struct contact_law *const law = rig.sim.contact.law;
    assert_near(1e-12, 0.012, law[0].reach, "a with itself");
    assert_near(1e-12, 0.013, law[1].reach, "a with b");
    assert_near(1e-12, 0.013, law[3].reach, "b with a");
    assert_near(1e-12, 0.014, law[4].reach, "b with itself");
    assert_near(1e-12, 0.03, law[5].reach, "b with c");
    assert_near(1e-12, 0.03, law[7].reach, "c with b");
}

/* A post clamped in a floor does not touch the floor that holds it, however it bends there, until a
 * part of it
 * comes down that began further away than the kernel. */
static void test_what_a_clamp_holds_does_not_touch(void)
{
    RIG_OPEN_SOLID("dp = 1 cm\nend_time = 1\n"
                   "[wall floor]\nshape = box -0.2, -0.03, 0.24, 0\n"
                   "[solid a]\nshape = box 0, -0.03, 0.04, 0.1\nclamp = box 0, -0.03, 0.04, 0\n"
                   "density = 1000\nyoung = 1e6\npoisson = 0.3\n",
                   NULL);
    TEST_ASSERT_FALSE(timestep_watch_contact(&rig.sim, 0, 1));
    p->ux[at(0.005, 0.005)] = -0.006;
    TEST_ASSERT_FALSE(timestep_watch_contact(&rig.sim, 0, 1));
    const int64_t tip = at(0.005, 0.095);
    p->ux[tip] = -0.1;
    p->uy[tip] = -0.092;
    double f[2];
    contact_force(tip, f);
    TEST_ASSERT_TRUE(f[1] > 0 && rig.sim.contact.near);
}

/* Of a body's own surface those particles push each other that began further apart than the kernel
 * reaches. */
static void test_a_body_touches_itself(void)
{
    RIG_OPEN_SOLID("dp = 1 cm\nend_time = 1\n[solid a]\nshape = box 0, 0, 0.2, 0.03\n"
                   "density = 1000\nyoung = 1e6\npoisson = 0.3\nhourglass = 0\n",
                   NULL);
    TEST_ASSERT_FALSE(timestep_watch_contact(&rig.sim, 0, 1));
    const int64_t end = at(0.195, 0.025);
    p->ux[end] = -0.09;
    p->uy[end] = 0.008;
    double f[2];
    contact_force(end, f);
    /* Half of E r0 (r0/r - 1), r = 8 mm, by the edges below, and what the points below do to its
     * own. */
    TEST_ASSERT_TRUE(f[1] > 0.5 * 1e6 * 0.01 * (1 / 0.8 - 1));
    rig_open(&rig,
             "dp = 1 cm\nend_time = 1\n[solid a]\nshape = box 0, 0, 0.2, 0.03\n"
             "density = 1000\nyoung = 1e6\npoisson = 0.3\n[contact own]\nbetween = a, a\n"
             "enabled = off\n",
             NULL);
    TEST_ASSERT_FALSE(rig.sim.effects & FX_CONTACT);
}

struct sums {
    double mx, my, energy, kinetic, contact;
};

static struct sums sums(void)
{
    const struct ledger row = simulation_ledger(&rig.sim);
    return (struct sums){row.momentum_x, row.momentum_y,
                         row.kinetic + row.elastic + row.hourglass + row.contact, row.kinetic,
                         row.contact};
}

/* Two blocks fly at each other, off centre, and come apart again: momentum to round-off; energy to
 * the error of the time integration, measured 0.13 %, of which contact stores a quarter in between;
 * after it no overlap is left, and the blocks go the other way. */
static void test_collision(void)
{
    RIG_OPEN_SOLID(BLOCKS "shape = box 0.05, 0.01, 0.09, 0.05\nvelocity = -1, 0\n",
                   "a.velocity=1, 0.2", "precision=double");
    const struct sums before = sums();
    double most = 0, drift = 0, leak = 0;
    while (rig.sim.state.time < 0.05) {
        rig_run(&rig, rig.sim.state.time + 2e-4);
        const struct sums now = sums();
        most = fmax(most, now.contact);
        drift = fmax(drift, fabs(now.energy / before.energy - 1));
        leak = fmax(leak, hypot(now.mx - before.mx, now.my - before.my));
    }
    assert_at_most(0.002, drift, "change of energy");
    assert_at_most(1e-13 * hypot(before.mx, before.my), leak, "change of momentum");

    TEST_ASSERT_TRUE(most > 0.2 * before.energy);
    TEST_ASSERT_TRUE(sums().contact == 0);
    double va = 0, vb = 0;
    for (int64_t i = 0; i < p->n; i++) *(p->body[i] ? &vb : &va) += p->vx[i] / 16;
    TEST_ASSERT_TRUE(va < -0.5 && va < vb);
}

/* A block rests on a floor: the floor carries its weight, and particles overlap by dp p/(2 E) on
 * the mean, as half a spacing of the block, p = rho g H = 400 Pa. After 40 ms of damped ringing the
 * force is the weight to 1 %. */
static void test_block_on_a_floor(void)
{
    RIG_OPEN_SOLID(
        "dp = 1 cm\nend_time = 1\ngravity = 0, -10\n[contact all]\ndamping = 1\n"
        "[wall floor]\nshape = box -0.1, -0.03, 0.2, 0\n"
        "[solid a]\nshape = box 0, 0, 0.06, 0.04\ndensity = 1000\nyoung = 1e6\npoisson = 0.3\n"
        "artificial_viscosity = 1\n",
        NULL);
    rig_run(&rig, 0.3);
    double carried = 0, overlap = 0;
    for (int64_t i = 0; i < p->n; i++) {
        double f[2];
        if (p->Y[i] > 0.01) continue;
        contact_force(i, f);
        carried += f[1];
        overlap -= p->uy[i] / 6;
        TEST_ASSERT_TRUE(p->uy[i] > -5e-6);
    }
    assert_near(0.24, 24, carried, "force of the floor");
    assert_near(0.01 * 2e-6, 2e-6, overlap, "overlap");
}

/* A wall that comes down at 10 mm/s presses a block of 4 cm by 1 mm onto the floor: what the wall
 * has done is what strain and contact hold. Eight particles across: at four the ends of the block,
 * which hourglass control makes stiffer, are half of it, and store 4 % more. */
static const char press[] = "dp = 1 cm\nend_time = 1\n[contact all]\n"
                            "[wall floor]\nshape = box -0.1, -0.03, 0.2, 0\n"
                            "[wall plate]\nshape = box -0.1, 0.04, 0.2, 0.07\nmotion = down\n"
                            "[motion down]\ny = -10 mm/s*t\n"
                            "[solid a]\nshape = box 0, 0, 0.06, 0.04\ndensity = 1000\nyoung = "
                            "1e6\npoisson = 0\nlaw = svk\ndp = 5 mm\n";

static void test_work_of_a_moving_wall(void)
{
    const char *const integrators[] = {"integrator=symplectic", "integrator=verlet"};
    for (int k = 0; k < 2; k++) {
        RIG_OPEN_SOLID(press, integrators[k]);
        rig_run(&rig, 0.1);
        const struct ledger row = simulation_ledger(&rig.sim);
        /* The block of its full height: two contacts stand for half a spacing each. The strain is
         * 1/40: measured -0.5 %. */
        const double stiffness = 0.06 * 1e6 / 0.04;
        const double exact = 0.5 * stiffness * square(1e-3);
        assert_near(0.01 * exact, exact, row.elastic + row.contact, "stored");
        assert_at_most(0.003 * row.elastic, fabs(row.dissipated), "missing energy");
        TEST_ASSERT_TRUE(row.contact > 0.1 * row.elastic);
    }
}

/* Bodies that never meet move as without contact, to the bit, at one step size. */
static void test_out_of_reach_changes_no_bit(void)
{
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        RIG_OPEN_SOLID(BLOCKS "shape = box 0.1, 0, 0.14, 0.04\nvelocity = 0, 1\n",
                       "numerics.fixed_step=2e-5", "a.artificial_viscosity=0.1");
        if (k) rig.sim.solid.contact = NULL;
        for (int64_t i = 0; i < p->n; i++) p->ux[i] = 1e-4 * sin(100 * p->X[i] + 70 * p->Y[i]);
        rig_run(&rig, 0.005);
        hash[k] = particles_hash(p, 1);
    }
    TEST_ASSERT_EQUAL_HEX64(hash[0], hash[1]);
}

/* Without viscosity the step for contact stays after two blocks have come apart; with it, it grows
 * again (T-62e). */
static void test_the_step_after_a_collision(void)
{
    for (int k = 0; k < 2; k++) {
        RIG_OPEN_SOLID(BLOCKS "shape = box 0.06, 0, 0.1, 0.04\nvelocity = -1, 0\n",
                       "a.velocity=1, 0", k ? "a.artificial_viscosity=0.2" : "precision=double",
                       k ? "b.artificial_viscosity=0.2" : "precision=double");
        const struct simulation *const sim = &rig.sim;
        rig_run(&rig, 1e-3);
        TEST_ASSERT_TRUE(!sim->solid.contact && sim->dt_solid == sim->dt_lone_solid);
        while (sim->state.time < 0.05) {
            rig_run(&rig, sim->state.time + 1e-3);
            TEST_ASSERT_TRUE(!sim->solid.contact || sim->dt_solid < sim->dt_lone_solid);
        }
        TEST_ASSERT_TRUE(!sim->solid.contact && sim->state.short_steps_needed_at > 0);
        TEST_ASSERT_TRUE(k == (sim->dt_solid == sim->dt_lone_solid));
    }
}

/* Number of threads, looking at the run, and where partners were looked for last change no bit. */
static void test_same_bits(void)
{
    uint64_t hash[4];
    for (int k = 0; k < 4; k++) {
        RIG_OPEN_SOLID(BLOCKS "shape = box 0.042, 0.011, 0.082, 0.051\nvelocity = -2, 0\n"
                              "[wall floor]\nshape = box -0.1, -0.03, 0.2, 0\n",
                       "a.velocity=1, -0.5", "all.friction=0.3", "all.damping=0.1");
        if (k == 1) rig.sim.solid.threads = 3;
        double most = 0;
        for (int n = 0; n < 40; n++) {
            rig_run(&rig, rig.sim.state.time + 2e-4);
            most = fmax(most, contact_energy(&rig.sim.contact, p, rig.sim.state.time));
            if (k == 2) simulation_ledger(&rig.sim);
            if (k == 3) rig.sim.contact.known = false;
        }
        TEST_ASSERT_TRUE(most > 0);
        hash[k] = simulation_hash(&rig.sim);
    }
    for (int k = 1; k < 4; k++) TEST_ASSERT_EQUAL_HEX64(hash[0], hash[k]);
}

static void test_restart(void)
{
    static const char text[] = BLOCKS "shape = box 0.042, 0.011, 0.082, 0.051\nvelocity = -2, 0\n";
    const char *const integrators[] = {"integrator=symplectic", "integrator=verlet"};
    for (int k = 0; k < 2; k++) {
        struct checkpoint image = {0};
        RIG_OPEN_SOLID(text, integrators[k], "all.friction=0.3");
        rig_run(&rig, 0.003);
        TEST_ASSERT_TRUE(sums().contact > 0);
        TEST_ASSERT_EQUAL_INT(ERR_OK,
                              checkpoint_capture(&image, &rig.sim, "case", "test", &rig.diag));
        checkpoint_seal(&image);
        rig_run(&rig, 0.006);
        const uint64_t whole = simulation_hash(&rig.sim);
        RIG_OPEN_SOLID(text, integrators[k], "all.friction=0.3");
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, checkpoint_apply(&image, &rig.sim, &rig.diag),
                                      rig.diag.text);
        rig_run(&rig, 0.006);
        TEST_ASSERT_EQUAL_HEX64(whole, simulation_hash(&rig.sim));
        checkpoint_free(&image);
    }
}

/* A drop hits a block, the block hits another: with the solid's sub-steps momentum goes through
 * fluid and contact to the round-off of the fluid's pairs in single precision. */
static void test_with_fluid(void)
{
    RIG_OPEN_SOLID(
        BLOCKS "shape = box 0.041, 0, 0.081, 0.04\n"
               "[fluid drop]\nshape = box -0.05, 0, 0, 0.04\nsound_speed = 12\nvelocity = 1, 0\n"
               "[domain]\nlower = -0.2, -0.1\nupper = 0.3, 0.15\n",
        "numerics.multirate=on");
    rig.sim.coupling.impedance = 0; /* no interface impulse to be returned */
    rig.sim.solid.apply_kick = solid_plain_kick;
    const struct sums before = sums();
    double most = 0;
    while (rig.sim.state.time < 0.02) {
        rig_run(&rig, rig.sim.state.time + 1e-3);
        most = fmax(most, sums().contact);
    }
    TEST_ASSERT_TRUE(most > 0 && rig.sim.state.solid_substeps > 2 * rig.sim.state.steps);
    const struct sums after = sums();
    assert_at_most(1e-6 * before.mx, hypot(after.mx - before.mx, after.my - before.my), "momentum");
    double vb = 0;
    for (int64_t i = 0; i < p->n; i++) vb += p->body[i] == 1 ? p->vx[i] / 16 : 0;
    TEST_ASSERT_TRUE(vb > 0.1);
}

/* Contact's part of the step is told apart from the solid's: by hand, 2 k/m for two surfaces face
 * to face (T-62a), and without contact the solid's bound alone. So is its time. */
static void test_bound_and_phase_of_its_own(void)
{
    rig_open(&rig, BLOCKS "shape = box 0.04, 0, 0.08, 0.04\n", NULL);
    const struct simulation *const sim = &rig.sim;
    const double modulus = 4e6 / 3;
    TEST_ASSERT_TRUE(timestep_watch_contact(&rig.sim, 0, 1));
    /* Of all surfaces those of the first block with itself have the shortest period (T-62e). */
    const double resolved = 0.9 * 0.4 / sqrt(2 * 2e6 / 0.1);
    assert_near(1e-15, resolved, sim->dt_solid, "bound");
    assert_near(1e-15, 0.9 * solid_step_of(square(sim->solid.omega_max), sim->solid.damping_max),
                sim->dt_lone_solid, "bound of the solid alone");
    TEST_ASSERT_TRUE(resolved < sim->dt_lone_solid);
    TEST_ASSERT_TRUE(sim->dt_solid < 0.99 * sim->dt_lone_solid);
    /* Where the distance is half of the reach the contact is four times as stiff; the next edges,
     * at 1.118 of the reach, are near enough to count as at its beginning. */
    p = &rig.sim.particles[KIND_SOLID];
    for (int64_t i = 0; i < p->n; i++) p->ux[i] = p->body[i] ? -0.005 : 0;
    TEST_ASSERT_TRUE(timestep_watch_contact(&rig.sim, 0, 1));
    assert_near(1e-6 * 5 * 2 * modulus / 0.1, (4 + 1) * 2 * modulus / 0.1, sim->contact.omega2,
                "contact's part");
    for (int64_t i = 0; i < p->n; i++) p->ux[i] = p->body[i] ? -0.008 : 0;
    TEST_ASSERT_TRUE(timestep_watch_contact(&rig.sim, 0, 1));
    const double omega2 = square(sim->solid.omega_max) + sim->contact.omega2;
    TEST_ASSERT_TRUE(sim->dt_solid < resolved);
    assert_near(1e-15, 0.9 * solid_step_of(omega2, sim->solid.damping_max), sim->dt_solid,
                "bound of an overlap");
    memset(p->ux, 0, (size_t)p->n * sizeof *p->ux);
    rig.sim.contact.seconds = 0; /* of the calls above, which are no part of a phase */
    rig_steps(&rig, 10, 1);
    TEST_ASSERT_EQUAL_INT64(sim->state.steps, sim->state.bound_steps[BOUND_contact]);
    TEST_ASSERT_TRUE(sim->dt_bound[BOUND_contact] == sim->dt_solid);
    TEST_ASSERT_TRUE(sim->dt_bound[BOUND_solid] == sim->dt_lone_solid);
    TEST_ASSERT_TRUE(sim->phase_seconds[PHASE_contact] > 0 && sim->phase_seconds[PHASE_solid] > 0);
    TEST_ASSERT_TRUE(sim->contact.seconds == 0);
    rig_open(&rig, BLOCKS "shape = box 0.2, 0, 0.24, 0.04\n", NULL);
    rig_steps(&rig, 10, 1);
    TEST_ASSERT_TRUE(sim->dt_solid == sim->dt_lone_solid && isinf(sim->dt_bound[BOUND_contact]));
    TEST_ASSERT_EQUAL_INT64(sim->state.steps, sim->state.bound_steps[BOUND_solid]);
}

static void test_bad_input(void)
{
#define TWO                                                                               \
    BLOCKS "shape = box 0.05, 0, 0.09, 0.04\n[wall w]\nshape = box 0, -0.1, 0.1, -0.05\n" \
           "[wall v]\nshape = box 0.2, -0.1, 0.3, -0.05\n[contact c]\n"
    rig_refuses(TWO "between = a\n", "two names");
    rig_refuses(TWO "between = a, bb\n",
                "between = bb: there is no [solid] or [wall] of that name");
    rig_refuses(TWO "between = w, v\n", "one of the two must be a [solid]");
    rig_refuses(TWO "stiffness = 0\n", "stiffness");
    rig_refuses("dp = 1 cm\nend_time = 1\n[fluid f]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 10\n"
                "[contact c]\n",
                "needs a [solid]");
}

/* Sections that name bodies hold for those only, and differ from one that names nobody. */
static void test_between(void)
{
    RIG_OPEN_SOLID(TWO "between = b, w\nstiffness = 3\n", NULL);
    const struct contact_law *const law = rig.sim.contact.law; /* [a, b][a, b, w, v] */
    /* Half a spacing of each body in series; a wall is rigid. */
    assert_near(1e-6, 4e6 / 3, law[0 * 4 + 1].stiffness, "two bodies");
    assert_near(1e-6, 2 * 2e6, law[0 * 4 + 2].stiffness, "body and wall");
    assert_near(1e-6, 3 * 2 * 1e6, law[1 * 4 + 2].stiffness, "body and wall of the section");
    assert_near(1e-6, 2 * 1e6, law[1 * 4 + 3].stiffness, "body and another wall");
    TEST_ASSERT_TRUE(law[0].on);
    RIG_OPEN_SOLID(BLOCKS
                   "shape = box 0.05, 0, 0.09, 0.04\n[wall w]\nshape = box 0, -0.1, 0.1, -0.05\n"
                   "[contact others]\nenabled = off\n",
                   "all.between=a, b");
    TEST_ASSERT_TRUE(rig.sim.particles[KIND_WALL].n == 0 && rig.sim.contact.n_walls == 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_pair_by_hand);
    RUN_TEST(test_a_gap_by_hand);
    RUN_TEST(test_a_gap_spares_what_began_within);
    RUN_TEST(test_fluid_keeps_a_layer);
    RUN_TEST(test_no_layer_where_bodies_begin_near);
    RUN_TEST(test_the_gap_of_bodies_that_begin_near);
    RUN_TEST(test_what_a_clamp_holds_does_not_touch);
    RUN_TEST(test_a_body_touches_itself);
    RUN_TEST(test_collision);
    RUN_TEST(test_block_on_a_floor);
    RUN_TEST(test_work_of_a_moving_wall);
    RUN_TEST(test_out_of_reach_changes_no_bit);
    RUN_TEST(test_the_step_after_a_collision);
    RUN_TEST(test_same_bits);
    RUN_TEST(test_restart);
    RUN_TEST(test_with_fluid);
    RUN_TEST(test_bound_and_phase_of_its_own);
    RUN_TEST(test_bad_input);
    RUN_TEST(test_between);
    return UNITY_END();
}
