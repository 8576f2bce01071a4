/* SPDX-License-Identifier: MIT
 * Probes: the quantities of case/quantities.def, at a point, of a body, or of the fluid. */
#pragma once

#include "time/simulation.h"

struct probe_body {
    enum kind kind;
    int body; /* index of its section */
};

/* The time mean of a probe, up to now; all numbers are double so that a checkpoint takes them as
 * they are. */
struct probe_mean {
    double row;     /* number of the row that it is for; -1: none yet */
    double time;    /* s: end of the time that it covers so far */
    double covered; /* s */
    double sum[5];  /* integral over this time */
};

struct probe {
    int quantity; /* enum probe_quantity */
    enum probe_target target;
    int columns, file, column; /* `column`: its first in the file */
    int direction;             /* enum probe_direction */
    enum kind kind;            /* of the body: KIND_WALL of a rigid one */
    int body;                  /* its section among the solids, or rigid bodies; -1: none */
    int beam;                  /* that is measured; -1: none */
    struct beam_place place;   /* on it */
    int n_bodies;              /* of a force */
    struct probe_body *bodies;
    int spring;              /* of a reaction; -1: that of a body */
    int motion;              /* that carries the point of a probe on a wall; -1: none */
    double point[2];         /* m, in the initial configuration */
    double to[2];            /* m */
    double average;          /* s; 0: none */
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
