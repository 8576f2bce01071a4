/* SPDX-License-Identifier: MIT
 * Probes: exact values on states made by hand; names of columns; files. */
#include "case/params.h"
#include "output/probes.h"
#include "rig.h"
#include "tiny.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct rig rig;
static struct arena arena;
static struct probes probes;
static char text[4096];

/* The tiny scene with further lines behind it. */
static void open_with(const char *more, const char *set)
{
    snprintf(text, sizeof text, "%s%s", tiny_case, more);
    rig_open(&rig, text, "precision=double", set, NULL);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, probes_create(&probes, &rig.sim, &arena, &rig.diag),
                                  rig.diag.text);
}

void setUp(void) {}

void tearDown(void)
{
    rig_close(&rig);
    arena_free(&arena);
}

/* The values of the last probe of the scene. */
static const double *last_values(void)
{
    static double row[PROBE_MAX_COLUMNS];
    probes_values(&probes, &rig.sim, probes.n - 1, row);
    return row;
}

/* --- material points --- */

static void set_linear_field(void)
{
    struct particles *particles = &rig.sim.particles[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++) {
        particles->ux[i] = 0.5 + 2 * particles->X[i] - 3 * particles->Y[i];
        particles->uy[i] = -0.25 + particles->X[i] + 4 * particles->Y[i];
        particles->vx[i] = 10 * particles->ux[i];
        particles->vy[i] = 10 * particles->uy[i];
    }
}

static void weights_reproduce_linear_fields(const char *point)
{
    open_with("", point);
    set_linear_field();
    double row[8], rate[8];
    probes_sample(&probes, &rig.sim, 0, false, row, rate);
    const double *at = probes.probe[0].given->point;
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, 0.5 + 2 * at[0] - 3 * at[1], row[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, -0.25 + at[0] + 4 * at[1], row[2]);
    at = probes.probe[1].given->point;
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 10 * (0.5 + 2 * at[0] - 3 * at[1]), row[3]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 10 * (-0.25 + at[0] + 4 * at[1]), row[4]);
}

static void linear_at_the_corner(void) { weights_reproduce_linear_fields("M1.point=0.13, 0"); }

static void linear_inside(void) { weights_reproduce_linear_fields("M1.point=0.1171, 0.0613"); }

static void linear_on_a_particle(void) { weights_reproduce_linear_fields("M1.point=0.115, 0.055"); }

/* Stretches the gate along x by a share `e`. */
static void stretch(double e)
{
    struct particles *particles = &rig.sim.particles[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++) {
        particles->ux[i] = e * particles->X[i];
        particles->uy[i] = 0;
        particles->vx[i] = 3;
        particles->vy[i] = -4;
    }
}

static void stress_of_a_stretched_body(void)
{
    open_with("[probe S]\nquantity = stress\nbody = gate\npoint = 0.13, 0\n", "gate.law=svk");
    const double e = 0.01, E = e + 0.5 * e * e;
    stretch(e);
    const struct solid_body *b = &rig.sim.solid.body[0];
    const double xx = (1 + e) * (b->lambda + 2 * b->mu) * E, yy = b->lambda * E / (1 + e);
    const double *row = last_values();
    assert_near(1e-9 * xx, xx, row[0], "sxx");
    assert_near(1e-9 * xx, yy, row[1], "syy");
    assert_near(1e-9 * xx, yy, row[2], "szz");
    assert_near(1e-9 * xx, 0, row[3], "sxy");
    assert_near(1e-9 * xx, xx - yy, row[4], "von Mises");
}

static void energy_of_a_body(void)
{
    open_with("[solid post]\nlike = gate\nshape = box 0.3, 0, 0.33, 0.1\n"
              "[probe E]\nquantity = energy\nbody = gate\n",
              "gate.law=svk");
    const double e = 0.01, E = e + 0.5 * e * e, area = 0.03 * 0.15;
    stretch(e);
    const struct solid_body *b = &rig.sim.solid.body[0];
    const double *row = last_values();
    const double elastic = area * 0.5 * (b->lambda + 2 * b->mu) * E * E;
    assert_near(1e-9, 0.5 * 1100 * area * 25, row[0], "kinetic energy");
    assert_near(1e-9 * elastic, elastic, row[1], "elastic energy");
    assert_near(1e-9 * elastic, 0, row[2], "hourglass energy");
}

/* --- the fluid --- */

static void set_flow(double vx, double vy)
{
    struct particles *particles = &rig.sim.particles[KIND_FLUID];
    for (int64_t i = 0; i < particles->n; i++) {
        particles->vx[i] = vx;
        particles->vy[i] = vy;
        particles->dens[i] = 0;
    }
}

static void velocity_at_a_fixed_point(void)
{
    open_with("[probe U]\nquantity = velocity\npoint = 0.001, 0.037\n", NULL);
    set_flow(2, -0.5);
    assert_near(1e-14, 2, last_values()[0], "vx");
    assert_near(1e-14, -0.5, last_values()[1], "vy");
}

static void velocity_where_it_is_dry(void)
{
    open_with("[probe U]\nquantity = velocity\npoint = 0.3, 0.2\n", NULL);
    set_flow(2, -0.5);
    TEST_ASSERT_TRUE(last_values()[0] == 0 && last_values()[1] == 0);
}

static void pressure_is_hydrostatic_at_the_start(void)
{
    open_with("", NULL);
    double row[8], rate[8];
    probes_sample(&probes, &rig.sim, 0, false, row, rate);
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * 1000 * 9.81 * 0.1, 1000 * 9.81 * 0.08, row[5]);
}

static void pressure_is_a_mean_of_the_near_fluid(void)
{
    open_with("", "P.point=0.001, 0.03");
    struct particles *particles = &rig.sim.particles[KIND_FLUID];
    const double *const g = rig.sim.fluid.k.gravity;
    for (int64_t i = 0; i < particles->n; i++)
        particles->dens[i] = 1e-3, particles->ax[i] = g[0], particles->ay[i] = g[1];
    assert_near(1e-9, 400.0 * 1000 / 7 * (pow(1.001, 7) - 1),
                fluid_sample(&rig.sim, 0.001, 0.03).pressure, "pressure of equal density");
}

static void level_of_still_water(void)
{
    static const char *const x[] = {"L.point=0.05, 0.005", "L.point=0.0478, 0", "L.point=0.0005, 0",
                                    "L.point=0.099, 0"};
    for (size_t k = 0; k < COUNT_OF(x); k++) {
        open_with("[probe L]\nquantity = level\n", x[k]);
        assert_near(2e-4, 0.1, last_values()[0], x[k]); /* a fiftieth of dp */
        tearDown();
    }
}

static void level_of_a_dry_bed(void)
{
    open_with("[probe L]\nquantity = level\npoint = 0.3, 0\n", NULL);
    TEST_ASSERT_TRUE(last_values()[0] == 0);
}

/* Moves the last n fluid particles into a row at x, a spacing apart, and sorts. */
static void splash(int n, double x)
{
    struct particles *particles = &rig.sim.particles[KIND_FLUID];
    for (int k = 0; k < n; k++) {
        particles->x[particles->n - 1 - k] = x - 0.01 * k;
        particles->y[particles->n - 1 - k] = 0.005;
    }
    rig_sort(&rig);
}

static void front_without_single_drops(void)
{
    open_with("[probe F]\nquantity = front\n", NULL);
    assert_near(1e-15, 0.1, last_values()[0], "column");
    splash(2, 0.3);
    assert_near(1e-15, 0.1, last_values()[0], "column and a drop of two");
    splash(3, 0.3);
    assert_near(1e-15, 0.305, last_values()[0], "a tongue of three");
}

static void front_in_other_directions(void)
{
    static const char *const way[] = {"F.direction=left", "F.direction=up", "F.direction=down"};
    static const double edge[] = {0, 0.1, 0};
    for (size_t k = 0; k < COUNT_OF(way); k++) {
        open_with("[probe F]\nquantity = front\n", way[k]);
        assert_near(1e-15, edge[k], last_values()[0], way[k]);
        tearDown();
    }
}

static void flux_of_a_uniform_flow(void)
{
    open_with("[probe Q]\nquantity = flux\npoint = 0.0533, 0\nto = 0.0533, 0.2\n", NULL);
    set_flow(2, 5);
    assert_near(1e-14, 0.2, last_values()[0], "flux to the right of the way up");
    tearDown();
    open_with("[probe Q]\nquantity = flux\npoint = 0.0533, 0.05\nto = 0.0533, 0\n", NULL);
    set_flow(2, 5);
    assert_near(1e-14, -0.1, last_values()[0], "half of it, on the way down");
}

/* Hydrostatics on the left wall, rho g H/2 = 490.5 Pa over 0.1 m. The fluid within 2 h lies on one
 * side of both ends of the line, which cancels but for the surface. */
static void pressure_on_a_face(void)
{
    open_with("[probe S]\nquantity = surface_pressure\npoint = 0, 0.1\nto = 0, 0\n", NULL);
    const double *row = last_values();
    assert_near(0.02 * 490.5, 490.5, row[0], "mean pressure");
    assert_near(0.02 * 49.05, -49.05, row[1], "force on the wall, away from the water");
    assert_near(1e-15, 0, row[2], "force along the wall");
    tearDown();
    /* Upwards, so that the water lies to the right. */
    open_with("[probe S]\nquantity = surface_pressure\npoint = 0, 0.01\nto = 0, 0.09\n", NULL);
    row = last_values();
    assert_near(0.02 * 490.5, 490.5, row[0], "mean pressure between the ends");
    assert_near(0.02 * 39.24, 39.24, row[1], "force on a surface with the water to its left");
    tearDown();
    open_with("[probe S]\nquantity = surface_pressure\npoint = 0.2, 0.02\nto = 0.3, 0.02\n", NULL);
    assert_near(0, 0, last_values()[0], "dry");
}

/* What walls and gate feel is what the fluid feels, with the sign reversed. */
static void forces_balance(void)
{
    open_with(
        "[probe T]\nquantity = force\nbody = tank\n[probe G]\nquantity = force\nbody = gate\n",
        "integrator=symplectic");
    rig_steps(&rig, 20, 1);
    double tank[3], gate[3], fluid[2] = {0};
    probes_values(&probes, &rig.sim, probes.n - 2, tank);
    probes_values(&probes, &rig.sim, probes.n - 1, gate);
    const struct particles *particles = &rig.sim.particles[KIND_FLUID];
    for (int64_t i = 0; i < particles->n; i++) {
        fluid[0] += 0.1 * particles->ax[i];
        fluid[1] += 0.1 * (particles->ay[i] + 9.81);
    }
    const double weight = 1000 * 9.81 * 0.01;
    assert_near(1e-5 * weight, -fluid[0], tank[0] + gate[0], "horizontal");
    assert_near(1e-5 * weight, -fluid[1], tank[1] + gate[1], "vertical");
    TEST_ASSERT_TRUE(gate[0] > 0.05 * weight && tank[1] < -0.1 * weight);
}

/* Moving the point by s changes the moment by -s x F. */
static void moment_about_a_point(void)
{
    open_with("[probe G]\nquantity = force\nbody = gate\npoint = 0.1, 0\n"
              "[probe H]\nquantity = force\nbody = gate\npoint = 0.3, 0.1\n",
              NULL);
    double g[3], h[3];
    probes_values(&probes, &rig.sim, probes.n - 2, g);
    probes_values(&probes, &rig.sim, probes.n - 1, h);
    assert_near(1e-11, g[2] - (0.2 * g[1] - 0.1 * g[0]), h[2], "moment");
    TEST_ASSERT_TRUE(g[2] < 0); /* the push to the right turns the gate clockwise about its foot */
}

static void walls_carry_forces_only_when_asked(void)
{
    open_with("", NULL);
    TEST_ASSERT_NULL(rig.sim.particles[KIND_WALL].fx);
    tearDown();
    open_with("[probe T]\nquantity = force\nbody = tank\n", NULL);
    TEST_ASSERT_NOT_NULL(rig.sim.particles[KIND_WALL].fx);
}

/* Of two files that are read at different times. */
static void walls_get_forces_only_for_rows_that_show_them(void)
{
    double row[1 + PROBE_MAX_COLUMNS], rate[1 + PROBE_MAX_COLUMNS];
    open_with("[probe T]\nquantity = force\nbody = tank\n"
              "[probe Q]\nquantity = pressure\npoint = 0.05, 0.05\ninterval = 1 ms\n",
              NULL);
    double *const fy = rig.sim.particles[KIND_WALL].fy;
    fy[0] = 7;
    probes_sample(&probes, &rig.sim, 1, false, row, rate);
    TEST_ASSERT_TRUE(fy[0] == 7);
    probes_sample(&probes, &rig.sim, 0, false, row, rate);
    TEST_ASSERT_FALSE(fy[0] == 7);
}

/* --- points that move, several bodies --- */

/* Density that differs from place to place. */
static void set_uneven_density(void)
{
    struct particles *particles = &rig.sim.particles[KIND_FLUID];
    for (int64_t i = 0; i < particles->n; i++)
        particles->dens[i] = 1e-2 * particles->x[i] + 3e-2 * particles->y[i];
}

/* The last two probes see the same. */
static void last_two_agree(const char *what)
{
    double a[PROBE_MAX_COLUMNS] = {0}, b[PROBE_MAX_COLUMNS] = {0};
    probes_values(&probes, &rig.sim, probes.n - 2, a);
    probes_values(&probes, &rig.sim, probes.n - 1, b);
    TEST_ASSERT_TRUE(a[0] != 0);
    for (int c = 0; c < PROBE_MAX_COLUMNS; c++) assert_near(1e-12 * fabs(a[0]), a[c], b[c], what);
}

static void a_point_rides_on_a_solid(void)
{
    open_with("[probe F]\nquantity = pressure\npoint = 0.08, 0.06\n"
              "[probe R]\nquantity = pressure\non = gate\npoint = 0.1, 0.05\n",
              NULL);
    struct particles *particles = &rig.sim.particles[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++)
        particles->ux[i] = -0.2 * particles->X[i], particles->uy[i] = 0.2 * particles->Y[i];
    set_uneven_density();
    last_two_agree("pressure at a point of a stretched solid");
}

static void a_point_rides_on_a_wall(void)
{
    static const int quantity[] = {PROBE_PRESSURE, PROBE_LEVEL, PROBE_VELOCITY};
    for (size_t k = 0; k < COUNT_OF(quantity); k++) {
        open_with("[wall flap]\nshape = box 0.3, 0, 0.33, 0.1\nmotion = swing\n"
                  "[motion swing]\nturn = 1.5707963267948966*t\n"
                  "centre = 0.1, 0\n"
                  "[probe F]\nquantity = pressure\npoint = 0.06, 0.03\n"
                  "[probe R]\nquantity = pressure\non = flap\npoint = 0.13, 0.04\n",
                  NULL);
        for (int p = probes.n - 2; p < probes.n; p++) rig.scene.probe[p].quantity = quantity[k];
        set_flow(2, -0.5);
        set_uneven_density();
        rig.sim.state.time = 1; /* a quarter turn */
        last_two_agree("at a point of a turned wall");
        tearDown();
    }
}

static void a_line_rides_on_a_wall(void)
{
    open_with("[wall flap]\nshape = box 0.3, 0, 0.33, 0.1\nmotion = swing\n"
              "[motion swing]\nturn = 1.5707963267948966*t\ncentre = 0.1, 0\n"
              "[probe F]\nquantity = surface_pressure\npoint = 0.06, 0.03\nto = 0.03, 0.05\n"
              "[probe R]\nquantity = surface_pressure\non = flap\npoint = 0.13, 0.04\n"
              "to = 0.15, 0.07\n",
              NULL);
    set_uneven_density();
    rig.sim.state.time = 1; /* a quarter turn */
    last_two_agree("on a line of a turned wall");
}

static void force_on_several_bodies(void)
{
    open_with("[probe T]\nquantity = force\nbody = tank\npoint = 0.1, 0\n"
              "[probe G]\nquantity = force\nbody = gate\npoint = 0.1, 0\n"
              "[probe B]\nquantity = force\nbody = gate , tank\npoint = 0.1, 0\n",
              NULL);
    double one[3], two[3], both[3];
    probes_values(&probes, &rig.sim, probes.n - 3, one);
    probes_values(&probes, &rig.sim, probes.n - 2, two);
    probes_values(&probes, &rig.sim, probes.n - 1, both);
    for (int c = 0; c < 3; c++) {
        TEST_ASSERT_TRUE(one[c] != 0 && two[c] != 0);
        assert_near(1e-10, one[c] + two[c], both[c], "sum of both");
    }
}

/* The three of a list are three. */
static void force_on_three_bodies(void)
{
    open_with("[wall one]\nshape = box 0.2, 0.2, 0.23, 0.23\n[wall two]\nshape = box 0.3, 0.3, "
              "0.33, 0.33\n"
              "[probe B]\nquantity = force\nbody = gate, one, two\npoint = 0.1, 0\n",
              NULL);
    const struct probe *const all = &probes.probe[probes.n - 1];
    TEST_ASSERT_EQUAL_INT(3, all->n_bodies);
    for (int k = 0; k < 2; k++) {
        TEST_ASSERT_EQUAL_INT(KIND_WALL, all->bodies[1 + k].kind);
        TEST_ASSERT_EQUAL_STRING(k ? "two" : "one",
                                 rig.scene.wall[all->bodies[1 + k].body].common.name);
    }
}

/* --- strain, pose, acceleration, reaction --- */

/* Turns the gate about the origin by an angle after stretching it along x by a share, and shifts
 * it. */
static void set_pose(double angle, double e, const double shift[2])
{
    struct particles *particles = &rig.sim.particles[KIND_SOLID];
    const double c = cos(angle), s = sin(angle);
    for (int64_t i = 0; i < particles->n; i++) {
        const double x = (1 + e) * particles->X[i], y = particles->Y[i];
        particles->ux[i] = c * x - s * y + shift[0] - particles->X[i];
        particles->uy[i] = s * x + c * y + shift[1] - particles->Y[i];
    }
}

static void strain_of_a_turned_body(void)
{
    static const double shift[2] = {0.01, 0.02};
    open_with("[probe E]\nquantity = strain\nbody = gate\npoint = 0.13, 0\n", NULL);
    set_pose(0.7, 0.01, shift);
    assert_near(1e-10, 0.01 + 0.5e-4, last_values()[0], "Exx");
    assert_near(1e-10, 0, last_values()[1], "Eyy");
    assert_near(1e-10, 0, last_values()[2], "Exy");
    struct particles *particles = &rig.sim.particles[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++)
        particles->ux[i] = 0.02 * particles->Y[i], particles->uy[i] = 0;
    assert_near(1e-10, 0.01, last_values()[2], "Exy of a shear");
    assert_near(1e-10, 0.5 * 4e-4, last_values()[1], "Eyy of a shear");
}

static void pose_of_a_turned_body(void)
{
    static const double shift[2] = {-0.3, 0.05};
    open_with("[solid post]\nlike = gate\nshape = box 0.3, 0, 0.33, 0.1\n"
              "[probe Q]\nquantity = pose\nbody = gate\n",
              NULL);
    set_pose(-2.5, 0, shift);
    const double c = cos(-2.5), s = sin(-2.5), x = 0.115, y = 0.075;
    assert_near(1e-12, c * x - s * y + shift[0], last_values()[0], "x");
    assert_near(1e-12, s * x + c * y + shift[1], last_values()[1], "y");
    assert_near(1e-12, -2.5, last_values()[2], "angle");
}

static void acceleration_of_a_falling_body(void)
{
    open_with("[solid stone]\nlike = gate\nshape = box 0.3, 0.2, 0.33, 0.3\n"
              "[probe A]\nquantity = acceleration\nbody = stone\npoint = 0.31, 0.25\n"
              "[probe C]\nquantity = acceleration\nbody = gate\npoint = 0.115, 0.145\n",
              NULL);
    double fall[2], held[2];
    probes_values(&probes, &rig.sim, probes.n - 2, fall);
    probes_values(&probes, &rig.sim, probes.n - 1, held);
    assert_near(1e-12, 0, fall[0], "ax");
    assert_near(1e-12, -9.81, fall[1], "ay");
    assert_near(1e-12, 0, held[0], "ax in the clamp");
    assert_near(1e-12, 0, held[1], "ay in the clamp");
}

/* Newton's second law of the whole body: the reaction is what fluid, gravity and load leave. */
static void reaction_balances(const char *set)
{
    open_with("[motion shake]\nx = 0.001*sin(40*pi*t + 1)\ny = 0.0005*sin(40*pi*t + 1)\n"
              "[load pull]\nbody = gate\nshape = box 0.1, 0, 0.13, 0.15\nforce = 3, 1\n"
              "[contact none]\nenabled = off\n[probe R]\nquantity = reaction\nbody = gate\n",
              set);
    rig_steps(&rig, 40, 1);
    const uint64_t before = simulation_hash(&rig.sim);
    double got[3];
    memcpy(got, last_values(), sizeof got);
    TEST_ASSERT_TRUE(before == simulation_hash(&rig.sim));
    struct particles *particles = &rig.sim.particles[KIND_SOLID];
    const double mass = rig.sim.solid.body[0].mass;
    const struct held_forces now = solid_held_forces(&rig.sim.solid, particles, rig.sim.state.time);
    double x = -3, y = -1;
    for (int64_t i = 0; i < particles->n; i++) {
        x += mass * now.ax[i] - particles->fx[i];
        y += mass * (now.ay[i] + 9.81) - particles->fy[i];
    }
    assert_near(1e-6 * fabs(x), x, got[0], "fx");
    assert_near(1e-6 * fabs(y), y, got[1], "fy");
    TEST_ASSERT_TRUE(fabs(got[0]) > 1 && fabs(got[1]) > 1 && got[2] != 0);
}

static void reaction_of_a_clamp_at_rest(void) { reaction_balances(NULL); }

static void reaction_of_a_moving_clamp(void) { reaction_balances("gate.clamp_motion=shake"); }

/* --- columns and files --- */

static void columns_are_named(void)
{
    open_with("", NULL);
    TEST_ASSERT_EQUAL_INT(1, probes.n_files);
    TEST_ASSERT_EQUAL_STRING("probes.csv", probes.file[0].name);
    TEST_ASSERT_EQUAL_STRING("time_s,M1_dx_m,M1_dy_m,V_vx_m_per_s,V_vy_m_per_s,P_p_Pa",
                             probes.file[0].header);
    TEST_ASSERT_EQUAL_INT(6, probes.file[0].columns);
}

static void an_interval_of_its_own_makes_a_file(void)
{
    open_with("[probe fast]\nquantity = stress\nbody = gate\npoint = 0.13, 0\ninterval = 10 us\n"
              "[probe front]\nquantity = front\n",
              NULL);
    TEST_ASSERT_EQUAL_INT(2, probes.n_files);
    TEST_ASSERT_EQUAL_STRING("probes_fast.csv", probes.file[1].name);
    TEST_ASSERT_EQUAL_STRING("time_s,fast_sxx_Pa,fast_syy_Pa,fast_szz_Pa,fast_sxy_Pa,fast_mises_Pa",
                             probes.file[1].header);
    TEST_ASSERT_TRUE(probes.file[1].interval == 1e-5 && probes.file[0].interval == 1e-4);
    TEST_ASSERT_NULL(strstr(probes.file[0].header, "fast"));
    TEST_ASSERT_NOT_NULL(strstr(probes.file[0].header, ",front_front_m"));
}

/* quantity_table and the choice in case/params.def are the same list. */
static void every_quantity_has_its_name(void)
{
    const struct param *param = param_find(SECTION_probe, "quantity");
    size_t length = 0;
    for (int k = 0; k < PROBE_QUANTITIES; k++) {
        TEST_ASSERT_EQUAL_STRING(quantity_table[k].name, param_choice(param, k).text);
        length += strlen(quantity_table[k].name) + 1;
    }
    TEST_ASSERT_EQUAL_INT((int)length - 1, (int)strlen(param->choices));
}

int main(void)
{
    UNITY_BEGIN();
    rig_one_thread();
    RUN_TEST(linear_at_the_corner);
    RUN_TEST(linear_inside);
    RUN_TEST(linear_on_a_particle);
    RUN_TEST(stress_of_a_stretched_body);
    RUN_TEST(energy_of_a_body);
    RUN_TEST(velocity_at_a_fixed_point);
    RUN_TEST(velocity_where_it_is_dry);
    RUN_TEST(pressure_is_hydrostatic_at_the_start);
    RUN_TEST(pressure_is_a_mean_of_the_near_fluid);
    RUN_TEST(level_of_still_water);
    RUN_TEST(level_of_a_dry_bed);
    RUN_TEST(front_without_single_drops);
    RUN_TEST(front_in_other_directions);
    RUN_TEST(flux_of_a_uniform_flow);
    RUN_TEST(pressure_on_a_face);
    RUN_TEST(forces_balance);
    RUN_TEST(moment_about_a_point);
    RUN_TEST(walls_carry_forces_only_when_asked);
    RUN_TEST(walls_get_forces_only_for_rows_that_show_them);
    RUN_TEST(a_point_rides_on_a_solid);
    RUN_TEST(a_point_rides_on_a_wall);
    RUN_TEST(a_line_rides_on_a_wall);
    RUN_TEST(force_on_several_bodies);
    RUN_TEST(force_on_three_bodies);
    RUN_TEST(strain_of_a_turned_body);
    RUN_TEST(pose_of_a_turned_body);
    RUN_TEST(acceleration_of_a_falling_body);
    RUN_TEST(reaction_of_a_clamp_at_rest);
    RUN_TEST(reaction_of_a_moving_clamp);
    RUN_TEST(columns_are_named);
    RUN_TEST(an_interval_of_its_own_makes_a_file);
    RUN_TEST(every_quantity_has_its_name);
    return UNITY_END();
}
