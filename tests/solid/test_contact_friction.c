/* SPDX-License-Identifier: MIT
 * Friction in contact makes no energy and turns nothing by itself (T-62c, T-62d). */
#include "contact_rig.h"
#include "time/advance.h"
#include "time/timestep.h"
#include "time/energy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define BODY RUBBER "law = neo_hookean\nartificial_viscosity = 0\n"
#define TOP "dp = 1 cm\nend_time = 10\n"
#define FLOOR TOP "[wall floor]\nshape = box -0.2, -0.03, 0.2, 0\n"

/* What the last solid of a scene rubs against. */
static const struct {
    const char *name, *text;
} scenes[] = {
    {"block on a floor", FLOOR "[solid a]\nshape = box -0.03, 0, 0.03, 0.04\n" BODY},
    {"disc on a floor", FLOOR "[solid a]\nshape = circle 0, 0.05, 0.05\n" BODY},
    {"block on a peg", TOP "[wall peg]\nshape = box -0.005, -0.01, 0.005, 0\n"
                           "[solid a]\nshape = box -0.033, 0, 0.037, 0.04\n" BODY},
    {"block on a corner", TOP "[wall edge]\nshape = box -0.03, -0.03, 0.002, 0\n"
                              "[solid a]\nshape = box -0.01, 0, 0.04, 0.04\n" BODY},
    {"disc on a body", TOP "[solid b]\nshape = box -0.1, -0.03, 0.1, 0\n" BODY
                           "[solid a]\nshape = circle 0, 0.05, 0.05\n" BODY},
    {"disc on a disc", TOP "[solid b]\nshape = circle 0.03, -0.0454, 0.05\n" BODY
                           "[solid a]\nshape = circle 0, 0.05, 0.05\n" BODY},
};

struct force {
    double x, y;
};
static struct force force[1024];

/* Of contact on each particle, N/m. */
static void find_forces(void)
{
    TEST_ASSERT_TRUE(p->n <= (int64_t)COUNT_OF(force));
    timestep_watch_contact(&rig.sim, rig.sim.state.time, 1);
    struct contact *const on = rig.sim.solid.contact;
    for (int k = 0; k < 2; k++) {
        rig.sim.solid.contact = k ? NULL : on;
        solid_stress(&rig.sim.solid, p);
        solid_forces(&rig.sim.solid, p);
        for (int64_t i = 0; i < p->n; i++) {
            const double mass = rig.sim.solid.body[p->body[i]].mass;
            force[i] =
                k ? (struct force){force[i].x - mass * p->sx[i], force[i].y - mass * p->sy[i]}
                  : (struct force){mass * p->sx[i], mass * p->sy[i]};
        }
    }
    rig.sim.solid.contact = on;
}

/* Moves the last body to where it is turned by `angle`, shifted by (x, y) and sheared. */
static void put(double x, double y, double angle, double shear)
{
    for (int64_t i = 0; i < p->n; i++) {
        if (p->body[i] != rig.scene.n_solid - 1) continue;
        const double X = p->X[i] + shear * p->Y[i], Y = p->Y[i];
        p->ux[i] = x + cos(angle) * X - sin(angle) * Y - p->X[i];
        p->uy[i] = y + sin(angle) * X + cos(angle) * Y - Y;
    }
}

static double energy(void)
{
    c->known = false;
    return contact_energy(c, p, 0);
}

static void open_scene(const char *text, double friction)
{
    char whole[3000];
    snprintf(whole, sizeof whole, "%s[contact all]\nfriction = %g\n", text, friction);
    open_case(whole);
}

/* The last body's forces along the path from one place to another, J/m per unit of the path. */
static double power_of(const double from[4], const double to[4], double size)
{
    double sum = 0;
    static struct force before[COUNT_OF(force)];
    put(from[0], from[1], from[2], from[3]);
    for (int64_t i = 0; i < p->n; i++) before[i] = (struct force){p->ux[i], p->uy[i]};
    put(to[0], to[1], to[2], to[3]);
    for (int64_t i = 0; i < p->n; i++)
        sum += force[i].x * (p->ux[i] - before[i].x) + force[i].y * (p->uy[i] - before[i].y);
    return sum / size;
}

/* While places do not slide, the force is the derivative of the energy, but for the turn of the
 * normals since the last step (T-62c), here of up to 0.001. What two bodies do to each other is
 * opposite and turns nothing. */
static void test_force_of_the_energy(void)
{
    static const double step = 1e-7;
    for (size_t k = 0; k < COUNT_OF(scenes); k++) {
        double rubs = 0, off = 0;
        open_scene(scenes[k].text, 10);
        put(0, -0.003, 0.02, 0);
        for (int n = 0; n < 2; n++) {
            find_forces();
            contact_slide(c, p);
        }
        const double here[4] = {1e-4, -0.003, 0.0203, 0.0007};
        put(here[0], here[1], here[2], here[3]);
        find_forces();
        double x = 0, y = 0, turn = 0, largest = 0;
        for (int64_t i = 0; i < p->n; i++) {
            x += force[i].x;
            y += force[i].y;
            turn += (p->X[i] + p->ux[i]) * force[i].y - (p->Y[i] + p->uy[i]) * force[i].x;
            largest = fmax(largest, hypot(force[i].x, force[i].y));
            rubs += force[i].x * (p->body[i] == rig.scene.n_solid - 1);
        }
        if (rig.scene.n_solid == 2) {
            assert_at_most(1e-12 * largest, hypot(x, y), scenes[k].name);
            assert_at_most(1e-13 * largest, fabs(turn), scenes[k].name);
        }
        for (int m = 0; m < 4; m++) {
            double low[4], high[4], change = 0;
            for (int j = 0; j < 4; j++) {
                low[j] = here[j] - (j == m ? step : 0);
                high[j] = here[j] + (j == m ? step : 0);
            }
            put(high[0], high[1], high[2], high[3]);
            change += energy();
            put(low[0], low[1], low[2], low[3]);
            change -= energy();
            /* A turn or shear of 1 moves the contact by less than 0.1 m. */
            const double arm = m < 2 ? 1 : 0.1;
            off = fmax(off, fabs(power_of(low, high, 2 * step) + change / (2 * step)) / arm);
        }
        TEST_ASSERT_TRUE_MESSAGE(fabs(rubs) > 10, scenes[k].name);
        assert_at_most(0.002 * fabs(rubs), off, scenes[k].name);
    }
}

/* A closed path along which the last body slides, turns, leaves and comes back. */
static void on_the_path(double at, double where[4])
{
    const double turn = 2 * 3.14159265358979323846 * at;
    where[0] = 4e-3 * sin(turn);
    where[1] = -1.2e-3 + 1e-3 * cos(2 * turn + 0.5);
    where[2] = 0.1 * sin(turn + 1);
    where[3] = 0.02 * sin(2 * turn);
}

/* Work of contact along the path less what is stored, J/m: what it makes. */
static double made_on_the_path(int steps, double *most)
{
    double made = 0, where[4], before[4];
    *most = 0;
    for (int n = 0; n <= 2 * steps; n++) {
        on_the_path((double)n / steps, where);
        if (n > 0) made += 0.5 * power_of(before, where, 1);
        put(where[0], where[1], where[2], where[3]);
        find_forces();
        if (n > 0) made += 0.5 * power_of(before, where, 1);
        contact_slide(c, p);
        *most = fmax(*most, energy());
        for (int j = 0; j < 4; j++) before[j] = where[j];
        if (n == 0) made += energy();
    }
    return made - energy();
}

/* Two rounds of a body along a closed path never return more than was put in; without friction as
 * much. */
static void test_closed_path(void)
{
    static const double friction[] = {0, 0.3, 3};
    for (size_t k = 0; k < COUNT_OF(scenes); k++) {
        for (int f = 0; f < 3; f++) {
            double most;
            open_scene(scenes[k].text, friction[f]);
            const double made = made_on_the_path(800, &most);
            if (f == 0)
                assert_at_most(2e-4 * most, fabs(made), scenes[k].name);
            else
                assert_at_most(-0.1 * most, made, scenes[k].name);
        }
    }
}

/* Bodies that turn together do not rub: the dashpot of friction sees no motion between them. */
static void test_bodies_that_turn_together(void)
{
    static struct force before[COUNT_OF(force)];
    for (int turns = 0; turns < 2; turns++) {
        open_scene(scenes[4].text, 0.5);
        put(0, -0.003, 0.02, 0);
        find_forces();
        contact_slide(c, p);
        for (int64_t i = 0; i < p->n && turns; i++) {
            p->vx[i] = 1 - 20 * (p->Y[i] + p->uy[i]);
            p->vy[i] = -2 + 20 * (p->X[i] + p->ux[i]);
        }
        find_forces();
        for (int64_t i = 0; i < p->n; i++) {
            const double size = 100;
            if (turns)
                assert_at_most(1e-12 * size,
                               hypot(force[i].x - before[i].x, force[i].y - before[i].y),
                               "force by the turn");
            before[i] = force[i];
        }
    }
}

/* A point that slides rubs with the friction times its normal force, of which it gets its part
 * where a wall's point presses an edge. */
static void test_each_point_rubs_by_its_own_load(void)
{
    static struct force normal[COUNT_OF(force)];
    static const int scene[] = {0, 2};
    for (size_t k = 0; k < COUNT_OF(scene); k++) {
        double most = 0, load = 0;
        open_scene(scenes[scene[k]].text, 0.3);
        put(0, -0.003, 0, 0);
        for (int slides = 0; slides < 2; slides++) {
            for (int64_t i = 0; i < p->n; i++) p->vx[i] = slides ? 100 : 0;
            find_forces();
            for (int64_t i = 0; i < p->n; i++) {
                const struct force f = force[i];
                const double n = hypot(normal[i].x, normal[i].y);
                if (slides)
                    most = fmax(most, fabs(hypot(f.x - normal[i].x, f.y - normal[i].y) - 0.3 * n));
                else
                    load = fmax(load, hypot(f.x, f.y));
            }
            for (int64_t i = 0; i < p->n && !slides; i++) normal[i] = force[i];
        }
        assert_at_most(1e-9 * load, most, scenes[scene[k]].name);
    }
}

/* A spring stretched beyond the slider counts with what the slider bears: f^2/(2 k), of the
 * stiffness in shear of both halves. */
static void test_energy_of_the_slider(void)
{
    static const double stiffness = 2e6 / 2.6;
    double whole[2], exact = 0;
    for (int rubs = 0; rubs < 2; rubs++) {
        open_scene(scenes[0].text, rubs ? 0.1 : 0);
        put(0, -0.003, 0, 0);
        find_forces();
        contact_slide(c, p);
        put(0.005, -0.003, 0, 0);
        if (!rubs) find_forces();
        for (int64_t i = 0; i < p->n && !rubs; i++)
            exact += 0.005 * (force[i].x * force[i].x + force[i].y * force[i].y) / stiffness;
        whole[rubs] = energy();
    }
    assert_near(1e-9 * exact, exact, whole[1] - whole[0], "energy");
}

/* What the run has gained at most since its energy was least, in parts of the kinetic energy at the
 * start. */
static double gain_until(double time)
{
    const double start = simulation_ledger(&rig.sim).kinetic;
    double least = INFINITY, most = 0;
    while (rig.sim.state.time < time) {
        rig_run(&rig, fmin(time, rig.sim.state.time + 5e-4));
        const struct ledger row = simulation_ledger(&rig.sim);
        const double now = row.kinetic + row.potential + row.elastic + row.hourglass + row.contact;
        least = fmin(least, now);
        most = fmax(most, now - least);
    }
    return most / start;
}

/* A disc that rolls on a floor, for a sixth of a turn: measured 5e-6. With places that the points
 * of the floor borrowed from those of the disc it was 6e-3, with any step. */
static void test_rolling_disc(void)
{
    for (int k = 0; k < 2; k++) {
        open_scene("dp = 5 mm\nend_time = 1\ngravity = 0, -9.81\n"
                   "[wall floor]\nshape = box -0.2, -0.02, 1, 0\n"
                   "[solid disc]\nshape = circle 0, 0.05, 0.05\n" BODY
                   "velocity = 0.18*y/0.05, -0.18*x/0.05\n",
                   k ? 1 : 0.3);
        assert_at_most(2e-5, gain_until(0.3), "gain");
    }
}

/* Two boxes and two discs in a box, all thrown and spun, meet each other and the walls. What is
 * gained is the error of the time integration, measured 2.7e-4, and falls with the step; it was
 * 3e-3 with any step. */
static double thrown(int seed, double safety)
{
    char text[2000];
    int n = snprintf(text, sizeof text,
                     "dp = 1 cm\nend_time = 1\n[wall box]\nshape = box -0.04, -0.04, 0.34, 0.34\n"
                     "minus = box 0, 0, 0.3, 0.3\n[numerics]\nsolid_safety = %g\n",
                     safety);
    srand((unsigned)seed);
    for (int k = 0; k < 4; k++) {
        const double x = 0.08 + 0.14 * (k % 2), y = 0.08 + 0.14 * (k / 2);
        double r[3];
        for (int j = 0; j < 3; j++) r[j] = 2 * (double)rand() / RAND_MAX - 1;
        n += snprintf(text + n, sizeof text - (size_t)n, "[solid s%d]\nshape = ", k);
        n += k % 2 ? snprintf(text + n, sizeof text - (size_t)n, "circle %g, %g, 0.04\n", x, y)
                   : snprintf(text + n, sizeof text - (size_t)n, "box %g, %g, %g, %g\n", x - 0.03,
                              y - 0.04, x + 0.03, y + 0.04);
        n += snprintf(text + n, sizeof text - (size_t)n,
                      BODY "velocity = %g - %g*(y - %g), %g + %g*(x - %g)\n", 3 * r[0], 60 * r[2],
                      y, 3 * r[1], 60 * r[2], x);
    }
    open_scene(text, 0.3);
    return gain_until(0.15);
}

/* One throw is a draw: 1.6e-4 to 5e-4. */
static void test_thrown_bodies_gain_no_energy(void)
{
    enum { THROWS = 12 };
    double gain = 0, finer = 0;
    for (int seed = 1; seed <= THROWS; seed++) {
        gain += thrown(seed, 0.9) / THROWS;
        finer += thrown(seed, 0.3) / THROWS;
    }
    assert_at_most(3e-4, gain, "mean gain");
    assert_at_most(gain / 3, finer, "mean gain with a third of the step");
}

/* What friction adds to the bound of the step where two faces lie on each other (T-62a): the
 * stiffness in shear of a layer is 1/(2 (1 + nu)) of that in compression. A point opposite an end
 * of an edge acts on that end with the weight sqrt(2), on the other with 1. One point of the face
 * is an end of the edges of three points. A wall does not move. */
static void test_bound_of_friction(void)
{
    static const char *const text[] = {FLOOR "[solid a]\nshape = box 0, 0, 0.06, 0.04\n" BODY,
                                       TOP "[solid b]\nshape = box 0, -0.04, 0.06, 0\n" BODY
                                           "[solid a]\nshape = box 0, 0, 0.06, 0.04\n" BODY};
    static const double mass = 0.1, shear = 1 / 2.6;
    const double rows = (2 + sqrt(2)) * (3 + sqrt(2));
    const double stiffness[] = {shear * 2e6, 0.5 * shear * 1e6 * rows};
    const double grip[] = {sqrt(2e6 * mass), 0.5 * sqrt(1e6 * 0.5 * mass) * rows};
    for (int k = 0; k < 2; k++) {
        double omega2[2], damping[2];
        for (int rubs = 0; rubs < 2; rubs++) {
            open_scene(text[k], rubs ? 0.5 : 0);
            timestep_watch_contact(&rig.sim, 0, 1);
            omega2[rubs] = c->omega2;
            damping[rubs] = c->damping;
        }
        assert_near(1e-9 * omega2[1], stiffness[k] / mass, omega2[1] - omega2[0], "stiffness");
        assert_near(1e-9 * damping[1], grip[k] / mass, damping[1] - damping[0], "damping");
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_force_of_the_energy);
    RUN_TEST(test_closed_path);
    RUN_TEST(test_bodies_that_turn_together);
    RUN_TEST(test_each_point_rubs_by_its_own_load);
    RUN_TEST(test_energy_of_the_slider);
    RUN_TEST(test_rolling_disc);
    RUN_TEST(test_thrown_bodies_gain_no_energy);
    RUN_TEST(test_bound_of_friction);
    return UNITY_END();
}
