/* SPDX-License-Identifier: MIT
 * The fluid at a point, at its surface, at its front, through a line: for probes. */
#pragma once

#include "time/advance.h"

/* The fluid at a fixed point, by the kernel over its particles within reach. Positions and
 * densities must be up to date, as they are between two steps; for the pressure accelerations
 * as well, as after simulation_refresh. */
struct sample {
    double fill;     /* sum V W of the fluid: about 1 inside it, 0.5 at its surface */
    double occupied; /* the same of walls and structures */
    double pressure; /* Pa, mean over the fluid, brought to the point (T-10a); 0 where dry */
    double vx, vy;   /* m/s, mean over the fluid; 0 where dry */
};
struct sample fluid_sample(const struct simulation *sim, double x, double y);

/* Height of the free surface above (x, y): the lowest height at which the water ends. y itself if
 * no water is within reach above it. */
double fluid_level(const struct simulation *sim, double x, double y);

/* Coordinate of the foremost fluid in a direction (enum probe_direction). Isolated groups of one or
 * two particles are ignored unless there is no other fluid. NAN if there is no fluid. */
double fluid_front(const struct simulation *sim, int direction);

/* Flow through the line from a to b, positive to the right of that direction, m^2/s per depth. */
double fluid_flux(const struct simulation *sim, const double a[2], const double b[2]);
/* Mean pressure along the line from a to b, Pa, by the midpoint rule over pieces of at most dp; and
 * its force on a surface with the fluid to the left of the line, N/m. */
void fluid_pressure_on(const struct simulation *sim, const double a[2], const double b[2],
                       double out[3]);
