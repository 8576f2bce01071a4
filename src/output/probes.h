/* SPDX-License-Identifier: MIT
 * Probes: the quantities of case/quantities.def, at a point, of a body, or of the fluid. */
#pragma once

#include "time/simulation.h"

struct probe_body {
    enum kind kind;
    int body; /* index of its section */
};

/* The time mean of a probe up to now; only doubles, so that a checkpoint takes them as such. */
struct probe_mean {
    double row;     /* number of the row that it is for; -1: none yet */
    double time;    /* s: end of the time that it covers so far */
    double covered; /* s */
    double sum[5];  /* integral over this time */
};

struct probe {
    const struct scene_probe *given;
    enum probe_target target;
    int columns, file, column; /* `column`: its first in the file */
    enum kind kind;            /* of the body: KIND_WALL of a rigid one */
    int body;                  /* its section among the solids, or rigid bodies; -1: none */
    int beam;                  /* that is measured; -1: none */
    struct beam_place place;   /* on it */
    int n_bodies;              /* of a force */
    struct probe_body *bodies;
    int spring;              /* of a reaction; -1: that of a body */
    int motion;              /* that carries the point of a probe on a wall; -1: none */
    struct probe_mean *mean; /* NULL: none */
    int n;                   /* particles of the interpolation at a material point */
    int32_t *particle;       /* of the solid */
    double *weight;          /* sum 1; reproduce linear fields */
};

/* Probes that are sampled at the same times share one file. */
struct probe_file {
    char name[SCENE_NAME + 16]; /* probes.csv, or probes_NAME.csv of one with its own interval */
    const char *header;         /* its columns joined by commas, "time_s" first */
    double interval;            /* s */
    int columns;
};

struct probes {
    int n, n_files;
    struct probe *probe;
    struct probe_file *file;
};

enum { PROBE_MAX_COLUMNS = 5, PROBE_COLUMN_TEXT = SCENE_NAME + 24 };

/* Finds the particles and weights of each probe, and the columns of each file; the arena owns the
 * memory. ERR_INPUT: a probe is too far from its body. */
enum err probes_create(struct probes *probes, const struct simulation *sim, struct arena *a,
                       struct diag *d) SPHFSI_CHECKED;

/* The present time, and values of the probes of a file, or of those with means only, in its
 * columns; their rates where these are known. */
void probes_sample(const struct probes *probes, struct simulation *sim, int file, bool means,
                   double *row, double *rate);

/* Name of a column of a probe, <probe>_<quantity>_<unit>; false: it has no such column. */
bool probe_column(const struct scene_probe *sp, int column, char *name, size_t size);

/* The values of probe k now, as many as it has columns; its mean so far, if it has one. */
void probes_values(const struct probes *probes, struct simulation *sim, int k, double *row);

/* --- fluid_sample.c: sampling the fluid --- */

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
