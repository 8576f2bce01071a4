/* SPDX-License-Identifier: MIT
 * A wall on a spring, pushed by water: the program integrates the motion of the wall and passes it
 * to the library, which returns the force of the water.
 *
 *     cc spring_wall.c $(pkg-config --cflags --libs sphfsi) -o spring_wall && ./spring_wall
 *
 * The wall has mass m per depth, and a spring of stiffness k holds it against a column of water of
 * height H. In equilibrium the spring is compressed by rho g H^2/(2 k) = 14 mm. */
#include <sphfsi.h>

#include <stdio.h>

static const char scene[] = "title = Wall on a spring\n"
                            "dp = 5 mm\n"
                            "end_time = 1 s\n"
                            "gravity = 0, -9.81 m/s^2\n"
                            "[fluid water]\n"
                            "shape = box 0, 0, 0.2, 0.12\n"
                            "max_speed = 2 m/s\n"
                            "artificial_viscosity = 0.05\n"
                            "density_diffusion = 0.1\n"
                            "surface = 0.12\n"
                            "[wall tank]\n"
                            "shape = polyline thickness -20 mm: 0, 0.2; 0, 0; 0.4, 0\n"
                            "[wall piston]\n"
                            "shape = box 0.2, 0, 0.22, 0.2\n"
                            "motion = spring\n"
                            "[motion spring]\nx = 0*t\n" /* replaced by spring_motion */
                            "[domain]\n"
                            "lower = -0.03, -0.03\n"
                            "upper = 0.41, 0.4\n"
                            "[probe push]\n"
                            "quantity = force\n"
                            "body = piston\n";

struct wall {
    double mass, stiffness; /* kg/m, N/m^2 */
    double time, x, v, a;   /* s, m, m/s, m/s^2: after the last step */
};

/* The motion of the wall, extrapolated from the last step with constant acceleration. */
static void spring_motion(void *context, double time, double d[2], double v[2], double a[2])
{
    const struct wall *const w = context;
    const double t = time - w->time;
    d[0] = w->x + t * (w->v + 0.5 * t * w->a);
    v[0] = w->v + t * w->a;
    a[0] = w->a;
}

static int fail(void)
{
    fprintf(stderr, "%s\n", sphfsi_error());
    return 1;
}

int main(void)
{
    struct wall wall = {.mass = 20, .stiffness = 5000};
    struct sphfsi_simulation *s;
    const struct sphfsi_options options = {.case_text = scene};
    if (sphfsi_create(&s, &options)) return fail();
    if (sphfsi_set_motion(s, "spring", spring_motion, &wall)) return fail();

    double next = 0;
    puts("time_s,displacement_m,force_N_per_m");
    while (wall.time < 0.2) {
        double force[SPHFSI_PROBE_COLUMNS];
        if (sphfsi_step(s, sphfsi_end_time(s)) || sphfsi_probe(s, "push", force)) return fail();
        double d[2], v[2], a[2];
        spring_motion(&wall, sphfsi_time(s), d, v, a);
        wall.time = sphfsi_time(s);
        wall.x = d[0];
        wall.v = v[0];
        wall.a = (force[0] - wall.stiffness * wall.x) / wall.mass;
        if (wall.time < next) continue;
        printf("%.6f,%.6f,%.3f\n", wall.time, wall.x, force[0]);
        next += 0.01;
    }
    sphfsi_free(s);
    return 0;
}
