/* SPDX-License-Identifier: MIT
 * One step of each integrator against Eqs. 22-27 written out, with the rates taken from the sweeps;
 * and motions that the schemes hold exactly. */
#include "coupling/coupling.h"
#include "time/advance.h"

#include "rig.h"
#include "unity.h"

#include <math.h>
#include <string.h>

static const char gate[] =
    "dp = 1 cm\nend_time = 1\ngravity = 0.3, -9.81\nprecision = double\n"
    "[numerics]\nskin = 1\nfixed_step = 1e-5\n"
    "[fluid water]\nshape = box 0, 0, 0.1, 0.1\nsound_speed = 20\nsurface = 0.1\n"
    "artificial_viscosity = 0.05\ndensity_diffusion = 0.1\n"
    "[wall tank]\nshape = polyline thickness -0.03: 0, 0.2; 0, 0; 0.4, 0\n"
    "[solid gate]\nshape = box 0.1, 0, 0.13, 0.15\nclamp = box 0.1, 0.12, 0.13, 0.15\n"
    "density = 1100\nyoung = 1e6\npoisson = 0.4\n[contact none]\nenabled = off\n";

enum { MOST = 128 };
struct memory {
    double x[MOST], y[MOST], u[MOST], v[MOST], d[MOST], ax[MOST], ay[MOST], rate[MOST];
};

static struct rig rig;
static struct particles *fluid, *solid;
static struct memory f0, f1, s0, s1;

void setUp(void) {}
void tearDown(void) { rig_close(&rig); }

/* Without the impedance of the interface, which tests/coupling/test_impulse.c has. */
static void open(const char *integrator, const char *rate)
{
    rig_open(&rig, gate, integrator, rate, NULL);
    rig.sim.coupling.impedance = 0;
    rig.sim.solid.apply_kick = solid_plain_kick;
    fluid = &rig.sim.particles[KIND_FLUID];
    solid = &rig.sim.particles[KIND_SOLID];
    TEST_ASSERT_TRUE(fluid->n <= MOST && solid->n <= MOST);
    uint64_t seed = 31;
    for (int64_t i = 0; i < fluid->n; i++) {
        fluid->vx[i] = 0.1 * noise(&seed);
        fluid->vy[i] = 0.1 * noise(&seed);
        fluid->dens[i] += 0.01 * noise(&seed);
        if (!fluid->vx_old) continue;
        fluid->vx_old[i] = fluid->vx[i];
        fluid->vy_old[i] = fluid->vy[i];
        fluid->dens_old[i] = fluid->dens[i];
    }
    for (int64_t i = 0; i < solid->n; i++) {
        solid->ux[i] = solid->free[i] * 1e-5 * noise(&seed);
        solid->uy[i] = solid->free[i] * 1e-5 * noise(&seed);
        solid->vx[i] = solid->wx[i] = solid->free[i] * 0.1 * noise(&seed);
        solid->vy[i] = solid->wy[i] = solid->free[i] * 0.1 * noise(&seed);
    }
    solid_set_positions(solid);
}

/* State and rates as they stand. */
static void take_fluid(struct memory *m)
{
    const size_t bytes = (size_t)fluid->n * sizeof(double);
    memcpy(m->x, fluid->x, bytes);
    memcpy(m->y, fluid->y, bytes);
    memcpy(m->u, fluid->vx, bytes);
    memcpy(m->v, fluid->vy, bytes);
    memcpy(m->d, fluid->dens, bytes);
    memcpy(m->ax, fluid->ax, bytes);
    memcpy(m->ay, fluid->ay, bytes);
    memcpy(m->rate, fluid->ddens, bytes);
}

static void put_fluid(const struct memory *m)
{
    const size_t bytes = (size_t)fluid->n * sizeof(double);
    memcpy(fluid->x, m->x, bytes);
    memcpy(fluid->y, m->y, bytes);
    memcpy(fluid->vx, m->u, bytes);
    memcpy(fluid->vy, m->v, bytes);
    memcpy(fluid->dens, m->d, bytes);
}

/* x, y of a solid's memory are displacements; ax, ay its acceleration. */
static void take_solid(struct memory *m)
{
    const size_t bytes = (size_t)solid->n * sizeof(double);
    memcpy(m->x, solid->ux, bytes);
    memcpy(m->y, solid->uy, bytes);
    memcpy(m->u, solid->vx, bytes);
    memcpy(m->v, solid->vy, bytes);
    memcpy(m->ax, solid->sx, bytes);
    memcpy(m->ay, solid->sy, bytes);
}

static void put_solid(const struct memory *m)
{
    const size_t bytes = (size_t)solid->n * sizeof(double);
    memcpy(solid->ux, m->x, bytes);
    memcpy(solid->uy, m->y, bytes);
    memcpy(solid->vx, m->u, bytes);
    memcpy(solid->vy, m->v, bytes);
}

static void rates(void)
{
    rig_evaluate(&rig);
    solid_stress(&rig.sim.solid, solid);
    solid_forces(&rig.sim.solid, solid);
}

/* Positions are held to 1e-16 m, velocities and densities to 1e-16 of some tenths; rates are
 * the same numbers, so that only the last digits of the sums may differ. */
static void compare(const struct memory *f, const struct memory *s)
{
    for (int64_t i = 0; i < fluid->n; i++) {
        assert_near(1e-15, f->x[i], fluid->x[i], "x of the fluid");
        assert_near(1e-15, f->y[i], fluid->y[i], "y of the fluid");
        assert_near(1e-14, f->u[i], fluid->vx[i], "vx of the fluid");
        assert_near(1e-14, f->v[i], fluid->vy[i], "vy of the fluid");
        assert_near(1e-15, f->d[i], fluid->dens[i], "dens of the fluid");
    }
    for (int64_t i = 0; i < solid->n; i++) {
        assert_near(1e-16, s->x[i], solid->ux[i], "ux of the solid");
        assert_near(1e-16, s->y[i], solid->uy[i], "uy of the solid");
        assert_near(1e-12, s->u[i], solid->vx[i], "vx of the solid");
        assert_near(1e-12, s->v[i], solid->vy[i], "vy of the solid");
        assert_near(1e-16, solid->X[i] + s->x[i], solid->x[i], "x of the solid");
    }
}

/* Eqs. 22-24 for fluid and solid at one rate. */
static void test_symplectic_step(void)
{
    open("integrator=symplectic", "numerics.multirate=off");
    const double dt = 1e-5;
    rates();
    take_fluid(&f0);
    take_solid(&s0);
    for (int64_t i = 0; i < fluid->n; i++) {
        fluid->x[i] += 0.5 * dt * f0.u[i];
        fluid->y[i] += 0.5 * dt * f0.v[i];
        fluid->vx[i] += 0.5 * dt * f0.ax[i];
        fluid->vy[i] += 0.5 * dt * f0.ay[i];
        fluid->dens[i] += 0.5 * dt * f0.rate[i];
    }
    for (int64_t i = 0; i < solid->n; i++) {
        solid->ux[i] += 0.5 * dt * s0.u[i];
        solid->uy[i] += 0.5 * dt * s0.v[i];
        solid->wx[i] = solid->vx[i] += 0.5 * dt * s0.ax[i];
        solid->wy[i] = solid->vy[i] += 0.5 * dt * s0.ay[i];
    }
    solid_set_positions(solid);
    rates();
    take_fluid(&f1);
    take_solid(&s1);
    for (int64_t i = 0; i < fluid->n; i++) {
        /* Eq. 24b with rho = rho0 (1 + d): eps = -(drho/rho) dt at the half step. */
        const double eps = -f1.rate[i] / (1 + f1.d[i]) * dt;
        f1.d[i] = (1 + f0.d[i]) * (2 - eps) / (2 + eps) - 1;
        f1.u[i] = f0.u[i] + dt * f1.ax[i];
        f1.v[i] = f0.v[i] + dt * f1.ay[i];
        f1.x[i] = f0.x[i] + 0.5 * dt * (f1.u[i] + f0.u[i]);
        f1.y[i] = f0.y[i] + 0.5 * dt * (f1.v[i] + f0.v[i]);
    }
    for (int64_t i = 0; i < solid->n; i++) {
        s1.u[i] = s0.u[i] + dt * s1.ax[i];
        s1.v[i] = s0.v[i] + dt * s1.ay[i];
        s1.x[i] = s0.x[i] + 0.5 * dt * (s1.u[i] + s0.u[i]);
        s1.y[i] = s0.y[i] + 0.5 * dt * (s1.v[i] + s0.v[i]);
        solid->wx[i] = s0.u[i];
        solid->wy[i] = s0.v[i];
    }
    put_fluid(&f0);
    put_solid(&s0);
    solid_set_positions(solid);
    rig_steps(&rig, 1, 1);
    TEST_ASSERT_TRUE(rig.sim.state.dt == dt);
    compare(&f1, &s1);
}

/* Eqs. 26 and 27 in the first step, Eq. 25 in the second, whose dt is half as long. */
static void test_verlet_steps(void)
{
    open("integrator=verlet", "numerics.multirate=off");
    const double dt[2] = {1e-5, 0.5e-5};
    take_fluid(&f0);
    struct memory *before = &f0, *now = &f1;
    for (int step = 0; step < 2; step++) {
        rates();
        take_fluid(now);
        take_solid(&s1);
        static struct memory next;
        next = *now;
        for (int64_t i = 0; i < fluid->n; i++) {
            const double kick = step ? dt[0] + dt[1] : dt[0];
            next.x[i] = now->x[i] + dt[step] * now->u[i] + 0.5 * dt[step] * dt[step] * now->ax[i];
            next.y[i] = now->y[i] + dt[step] * now->v[i] + 0.5 * dt[step] * dt[step] * now->ay[i];
            next.u[i] = (step ? before->u[i] : now->u[i]) + kick * now->ax[i];
            next.v[i] = (step ? before->v[i] : now->v[i]) + kick * now->ay[i];
            next.d[i] = (step ? before->d[i] : now->d[i]) + kick * now->rate[i];
        }
        for (int64_t i = 0; i < solid->n; i++) {
            s1.u[i] += dt[step] * s1.ax[i];
            s1.v[i] += dt[step] * s1.ay[i];
            s1.x[i] += dt[step] * s1.u[i];
            s1.y[i] += dt[step] * s1.v[i];
        }
        *before = *now;
        rig_steps(&rig, 1, step ? rig.sim.state.time + dt[1] : 1);
        TEST_ASSERT_TRUE(fabs(rig.sim.state.dt - dt[step]) < 1e-20);
        compare(&next, &s1);
    }
}

/* T-32a and T-32b written out over four steps, the last two half as long; the structure gets
 * what the fluid's velocity at whole steps gets (T-36a). */
static void test_leapfrog_steps(void)
{
    open("integrator=leapfrog", "numerics.multirate=off");
    static struct memory half;
    static double rate[5][MOST], last[2][MOST];
    take_fluid(&half);
    for (int64_t i = 0; i < fluid->n; i++) {
        fluid->vx_half[i] = fluid->vx[i];
        fluid->vy_half[i] = fluid->vy[i];
    }
    const double dt[5] = {0, 1e-5, 1e-5, 0.5e-5, 0.5e-5};
    for (int n = 1; n < 5; n++) {
        rates();
        take_fluid(&f1);
        take_solid(&s1);
        memcpy(rate[n], f1.rate, sizeof rate[n]);
        const double kick = 0.5 * (dt[n - 1] + dt[n]);
        for (int64_t i = 0; i < fluid->n; i++) {
            half.u[i] += kick * f1.ax[i];
            half.v[i] += kick * f1.ay[i];
            f1.x[i] += dt[n] * half.u[i];
            f1.y[i] += dt[n] * half.v[i];
            f1.u[i] = half.u[i] + 0.5 * dt[n] * f1.ax[i];
            f1.v[i] = half.v[i] + 0.5 * dt[n] * f1.ay[i];
            /* The mean of the parabola's slope and curvature terms over the step, Adams'
             * weights. */
            const double now = rate[n][i], old = rate[n > 1 ? n - 1 : 1][i],
                         older = rate[n > 2 ? n - 2 : 1][i];
            const double r = n > 1 ? dt[n] / dt[n - 1] : 1,
                         r_old = n > 2 ? dt[n - 1] / dt[n - 2] : 1;
            const double change = now - old, bend = change - r_old * (old - older);
            f1.d[i] += dt[n] * (now + change * r / 2 + bend * r * r * 5 / 12);
        }
        for (int64_t i = 0; i < solid->n; i++) {
            /* Drift, kick, drift, with the rates where the first drift ends. */
            solid->ux[i] += 0.5 * dt[n] * s1.u[i];
            solid->uy[i] += 0.5 * dt[n] * s1.v[i];
            double *const force[2] = {&solid->fx[i], &solid->fy[i]};
            for (int c = 0; c < 2; c++) {
                const double now = *force[c];
                *force[c] += 0.5 * dt[n - 1] / dt[n] * (now - last[c][i]);
                last[c][i] = now;
            }
        }
        solid_stress(&rig.sim.solid, solid);
        solid_forces(&rig.sim.solid, solid);
        static struct memory before;
        before = s1;
        take_solid(&s1);
        for (int64_t i = 0; i < solid->n; i++) {
            s1.u[i] = before.u[i] + dt[n] * s1.ax[i];
            s1.v[i] = before.v[i] + dt[n] * s1.ay[i];
            s1.x[i] += 0.5 * dt[n] * s1.u[i];
            s1.y[i] += 0.5 * dt[n] * s1.v[i];
        }
        put_solid(&before);
        rig_steps(&rig, 1, n > 2 ? rig.sim.state.time + dt[n] : 1);
        TEST_ASSERT_TRUE(fabs(rig.sim.state.dt - dt[n]) < 1e-18);
        compare(&f1, &s1);
    }
}

/* The structure as the fluid saw it at its last evaluation (no push: all are zero). */
static struct memory seen;
static void look(void *context, double time, const struct particles *particles, double *ax,
                 double *ay)
{
    (void)context, (void)time, (void)ax, (void)ay;
    const size_t bytes = (size_t)particles->n * sizeof(double);
    memcpy(seen.x, particles->x, bytes);
    memcpy(seen.y, particles->y, bytes);
    memcpy(seen.u, particles->wx, bytes);
    memcpy(seen.v, particles->wy, bytes);
    memcpy(seen.ax, particles->ax, bytes);
    memcpy(seen.ay, particles->ay, bytes);
}

static void look_at_places(void *context, double time, const struct particles *particles,
                           double *ax, double *ay)
{
    (void)context, (void)time, (void)ax, (void)ay;
    memcpy(seen.x, particles->x, (size_t)particles->n * sizeof(double));
    memcpy(seen.y, particles->y, (size_t)particles->n * sizeof(double));
}

/* A lone solid is shown to a program where it is in the middle of its step, for Verlet at its
 * start. */
static void test_a_lone_solid_as_a_program_sees_it(void)
{
    static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                              "integrator=leapfrog"};
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig,
                 "dp = 1 cm\nend_time = 1\n[solid a]\nshape = box 0, 0, 0.06, 0.04\n"
                 "density = 1100\nyoung = 1e6\npoisson = 0.4\nvelocity = 3, -2\n",
                 integrators[k], NULL);
        solid = &rig.sim.particles[KIND_SOLID];
        TEST_ASSERT_EQUAL(ERR_OK, simulation_set_force_hook(&rig.sim, KIND_SOLID, look_at_places,
                                                            NULL, &rig.diag));
        for (int step = 0; step < 3; step++) {
            const double start = rig.sim.state.time;
            rig_steps(&rig, 1, 1);
            const double half = strstr(integrators[k], "verlet") ? 0 : 0.5 * rig.sim.state.dt;
            for (int64_t i = 0; i < solid->n; i++) {
                assert_near(1e-12, solid->X[i] + 3 * (start + half), seen.x[i], integrators[k]);
                assert_near(1e-12, solid->Y[i] - 2 * (start + half), seen.y[i], integrators[k]);
            }
        }
    }
}

/* T-35 for one component: u, v, w of the particle when a step starts, u1, v1 after it; a is the
 * mean acceleration of T-14, with a lag shorter by `less` steps, and b that of the last steps.
 * Advances a, b and w. */
struct shown {
    double x, w, a; /* what the evaluation at `on` within the step is to see */
};
static struct shown show(double u, double v, double u1, double v1, double *w, double *a, double *b,
                         double on, double dt, double less)
{
    const double lag = 0.0135 / 20 - less * dt;
    const struct shown s = {u + on * (*w + 0.5 * on * *b), *w + on * *b, *a};
    *a += dt / (dt + lag) * ((v1 - v) / dt - *a);
    *b += ((v1 - v) / dt - *b) / 5;
    *w = (u1 - u) / dt + 0.5 * dt * *b; /* from the middle of the step to its end */
    return s;
}

/* With sub-steps the fluid sees the structure carried on to the instant of the evaluation,
 * `ahead` steps on, with an acceleration that follows the mean over about h/c0 (T-35, T-14),
 * shorter by `less` steps. */
static void see_substeps(const char *integrator, double ahead, double less)
{
    open(integrator, "numerics.multirate=on");
    rig.sim.dt_solid = 0.3e-5;
    TEST_ASSERT_EQUAL(ERR_OK,
                      simulation_set_force_hook(&rig.sim, KIND_SOLID, look, NULL, &rig.diag));
    static double a[2][MOST], b[2][MOST], w[2][MOST];
    memset(a, 0, sizeof a);
    memset(b, 0, sizeof b);
    memcpy(w[0], solid->wx, (size_t)solid->n * sizeof *w[0]);
    memcpy(w[1], solid->wy, (size_t)solid->n * sizeof *w[1]);
    for (int step = 0; step < 4; step++) {
        take_solid(&s0);
        rig_steps(&rig, 1, 1);
        const double dt = rig.sim.state.dt;
        TEST_ASSERT_EQUAL_INT(4, rig.sim.substeps);
        for (int64_t i = 0; i < solid->n; i++) {
            const struct shown x = show(s0.x[i], s0.u[i], solid->ux[i], solid->vx[i], &w[0][i],
                                        &a[0][i], &b[0][i], ahead * dt, dt, less);
            const struct shown y = show(s0.y[i], s0.v[i], solid->uy[i], solid->vy[i], &w[1][i],
                                        &a[1][i], &b[1][i], ahead * dt, dt, less);
            assert_near(1e-15, solid->X[i] + x.x, seen.x[i], "x seen");
            assert_near(1e-15, solid->Y[i] + y.x, seen.y[i], "y seen");
            assert_near(1e-10, x.w, seen.u[i], "wx seen");
            assert_near(1e-10, y.w, seen.v[i], "wy seen");
            const double tolerance = 1e-10 * (1 + fabs(x.a) + fabs(y.a));
            assert_near(tolerance, x.a, seen.ax[i], "ax seen");
            assert_near(tolerance, y.a, seen.ay[i], "ay seen");
            assert_near(1e-10, w[0][i], solid->wx[i], "wx");
            assert_near(1e-10, w[1][i], solid->wy[i], "wy");
        }
    }
    for (int64_t i = 0; i < solid->n; i++) {
        const double tolerance = 1e-10 * (1 + fabs(a[0][i]) + fabs(a[1][i]));
        assert_near(tolerance, a[0][i], solid->ax[i], "ax");
        assert_near(tolerance, a[1][i], solid->ay[i], "ay");
    }
}

static void test_fluid_sees_the_mean_of_substeps_carried_on(void)
{
    see_substeps("integrator=symplectic", 0.5, 1);
    see_substeps("integrator=verlet", 0, 0.5);
    see_substeps("integrator=leapfrog", 0, 0.5);
}

static void four_steps_of_eq_27(double dt)
{
    for (int k = 0; k < 4; k++) {
        solid_stress(&rig.sim.solid, solid);
        solid_forces(&rig.sim.solid, solid);
        for (int64_t i = 0; i < solid->n; i++) {
            solid->vx[i] += dt * solid->sx[i];
            solid->vy[i] += dt * solid->sy[i];
            solid->ux[i] += dt * solid->vx[i];
            solid->uy[i] += dt * solid->vy[i];
        }
    }
}

/* Four sub-steps of Eq. 27 are four steps of Eq. 27 with the fluid's force held: in the first
 * step that of the evaluation, later that of the middle of the kicks, 3/8 of a step on, by the
 * change of its mean, of which the last force is a half (T-36a). */
static void test_substeps_are_steps_with_the_force_held(void)
{
    open("integrator=verlet", "numerics.multirate=on");
    rig.sim.dt_solid = 0.3e-5;
    static double f[2][MOST], old[2][MOST];
    memset(old, 0, sizeof old);
    const double dt = 1e-5;
    for (int step = 0; step < 3; step++) {
        rates();
        take_solid(&s0);
        double most = 0;
        for (int64_t i = 0; i < solid->n; i++) {
            double *const force[2] = {&solid->fx[i], &solid->fy[i]};
            for (int c = 0; c < 2; c++) {
                f[c][i] = *force[c];
                if (step == 0) old[c][i] = f[c][i];
                const double change = 0.5 * (f[c][i] - old[c][i]);
                const double more = 0.375 * change;
                *force[c] += more;
                old[c][i] += change;
                most = fmax(most, fabs(more) / (1e-9 + fabs(f[c][i])));
            }
        }
        TEST_ASSERT_TRUE(step == 0 ? most == 0 : most > 1e-3);
        four_steps_of_eq_27(dt / 4);
        take_solid(&s1);
        put_solid(&s0);
        memcpy(solid->fx, f[0], (size_t)solid->n * sizeof *f[0]);
        memcpy(solid->fy, f[1], (size_t)solid->n * sizeof *f[1]);
        rig_steps(&rig, 1, 1);
        TEST_ASSERT_EQUAL_INT(4, rig.sim.substeps);
        for (int64_t i = 0; i < solid->n; i++) {
            assert_near(1e-17, s1.x[i], solid->ux[i], "ux");
            assert_near(1e-17, s1.y[i], solid->uy[i], "uy");
            assert_near(1e-12, s1.u[i], solid->vx[i], "vx");
            assert_near(1e-12, s1.v[i], solid->vy[i], "vy");
        }
    }
}

/* A particle that has fallen dry gives the part of the force back that it had in advance. */
static void test_the_force_on_a_dry_particle_ends(void)
{
    open("integrator=verlet", "numerics.multirate=on");
    rig.sim.dt_solid = 0.3e-5;
    rates();
    rig_steps(&rig, 1, 1);
    int64_t dry = 0;
    while (dry < solid->n && solid->Y[dry] < 0.14) dry++;
    TEST_ASSERT_TRUE(dry < solid->n && solid->fx[dry] == 0);
    solid->mean_fx[dry] = 1;
    for (double mean = 0.5; mean > 0.1; mean /= 2) {
        rig_steps(&rig, 1, 1);
        assert_near(1e-15, -0.375 * mean, solid->fx[dry], "force");
        assert_near(1e-15, mean, solid->mean_fx[dry], "mean");
    }
}

/* Where the middle of the kicks is the time at which the force is found, it is not extrapolated. */
static void test_the_force_is_carried_only_to_where_it_is_used(void)
{
    static const char *const integrators[] = {"integrator=verlet", "integrator=leapfrog"};
    static const char *const rates_of[] = {"numerics.multirate=on", "numerics.multirate=off"};
    for (int k = 0; k < 4; k++) {
        open(integrators[k / 2], rates_of[k % 2]);
        TEST_ASSERT_TRUE(rig.sim.effects & FX_FORCE_EXTRAPOLATION);
        TEST_ASSERT_TRUE(!(rig.sim.effects & FX_SPLIT_IMPULSE) == (k != 0));
        rig_close(&rig);
    }
    open("integrator=verlet", "numerics.multirate=off"); /* kicks at the start (Eq. 27) */
    rig_steps(&rig, 1, 1);
    TEST_ASSERT_TRUE(rig.sim.coupling.lead == 0);
    rig_close(&rig);
    open("integrator=symplectic", "numerics.multirate=on");
    TEST_ASSERT_FALSE(rig.sim.effects & FX_FORCE_EXTRAPOLATION);
    TEST_ASSERT_NULL(solid->mean_fx);
}

/* However long the step, the acceleration that the fluid sees is a mean over a quarter of h/c0
 * at least. */
static void test_least_lag_of_what_the_fluid_sees(void)
{
    open("integrator=leapfrog", "numerics.multirate=on");
    const double lag = 0.0135 / 20, brief = 1e-5;
    assert_near(1e-15, lag - 0.5 * brief,
                brief / coupling_acceleration_weight(&rig.sim.coupling, brief) - brief,
                "a short step");
    assert_near(1e-15, lag / 4,
                2 * lag / coupling_acceleration_weight(&rig.sim.coupling, 2 * lag) - 2 * lag,
                "a long one");
}

/* A block of fluid without pressure falls: v = g t and y = g t^2/2 are exact for every scheme,
 * whatever the steps; here they vary as output times cut them. */
static void test_free_fall_with_uneven_steps(void)
{
    static const char drop[] = "dp = 1 cm\nend_time = 1\ngravity = 0, -10\nprecision = double\n"
                               "[fluid water]\nshape = box 0, 0.1, 0.05, 0.15\nsound_speed = 20\n"
                               "density_diffusion = 0.1\n[domain]\nlower = -1, -1\nupper = 1, 1\n";
    static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                              "integrator=leapfrog"};
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig, drop, integrators[k], NULL);
        fluid = &rig.sim.particles[KIND_FLUID];
        for (double t = 0.0007; t < 0.02; t += 0.00085) {
            rig_run(&rig, t);
            rig_run(&rig, t + 0.00015);
        }
        const double t = rig.sim.state.time;
        TEST_ASSERT_TRUE(rig.sim.state.dt_max > 1.2 * rig.sim.state.dt_min);
        for (int64_t i = 0; i < fluid->n; i++) {
            const double start = 0.105 + 0.01 * (double)(fluid->id[i] / 5);
            assert_near(1e-13, -10 * t, fluid->vy[i], "vy");
            assert_near(1e-13, -5 * t * t, fluid->y[i] - start, "fall");
            assert_near(1e-13, 0, fluid->vx[i], "vx");
            assert_near(1e-13, 0, fluid->dens[i], "dens");
        }
    }
}

/* T-9b once a step, whatever the number of evaluations: in water of an even density the excess
 * of the damper falls by tau/(tau + dt) a step. The step before the first one is 0. */
static void test_the_damper_follows_once_a_step(void)
{
    static const char *const integrators[] = {"integrator=symplectic", "integrator=verlet",
                                              "integrator=leapfrog"};
    for (size_t k = 0; k < COUNT_OF(integrators); k++) {
        rig_open(&rig,
                 "dp = 1 cm\nend_time = 1\nprecision = double\n[numerics]\nfixed_step = 1e-4\n"
                 "[fluid w]\nshape = box 0, 0, 0.2, 0.2\nsound_speed = 20\nacoustic_damper = 4\n"
                 "[domain]\nlower = 0, 0\nupper = 0.2, 0.2\nperiodic = xy\n",
                 integrators[k], NULL);
        const struct fluid_constants *const c = &rig.sim.fluid.k;
        struct particles *const particles = &rig.sim.particles[KIND_FLUID];
        for (int64_t i = 0; i < particles->n; i++) particles->dens[i] = 0.01;
        rig_steps(&rig, 4, 1);
        const double tau = 4 * c->h / c->c0, kept = tau / (tau + 1e-4);
        for (int64_t i = 0; i < particles->n; i++)
            assert_near(1e-12, 0.01 * kept * kept * kept,
                        particles->dens[i] - particles->dens_slow[i], integrators[k]);
        rig_close(&rig);
    }
}

int main(void)
{
    rig_one_thread();
    UNITY_BEGIN();
    RUN_TEST(test_symplectic_step);
    RUN_TEST(test_verlet_steps);
    RUN_TEST(test_leapfrog_steps);
    RUN_TEST(test_a_lone_solid_as_a_program_sees_it);
    RUN_TEST(test_fluid_sees_the_mean_of_substeps_carried_on);
    RUN_TEST(test_substeps_are_steps_with_the_force_held);
    RUN_TEST(test_the_force_on_a_dry_particle_ends);
    RUN_TEST(test_the_force_is_carried_only_to_where_it_is_used);
    RUN_TEST(test_least_lag_of_what_the_fluid_sees);
    RUN_TEST(test_free_fall_with_uneven_steps);
    RUN_TEST(test_the_damper_follows_once_a_step);
    return UNITY_END();
}
