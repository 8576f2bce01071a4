/* SPDX-License-Identifier: MIT
 * Probes: displacement or velocity of a material point of a solid, pressure at a fixed point. */
#ifndef SPHFSI_PROBES_H
#define SPHFSI_PROBES_H

#include "simulation.h"

struct probe {
    int quantity;      /* enum probe_quantity */
    double point[2];   /* m, in the initial configuration */
    int n;             /* particles that carry it */
    int32_t *particle; /* of the solid */
    double *weight;    /* sum 1; reproduce linear fields */
};

struct probes {
    int n, columns;
    bool pressure; /* one of them is a pressure */
    struct probe *probe;
};

/* Finds the particles that carry each probe and their weights; memory is the arena's. ERR_INPUT: a
 * probe without its body, or too far from it. */
enum err probes_create(struct probes *p, const struct simulation *s, struct arena *a,
                       struct diag *d) SPHFSI_CHECKED;

/* The columns of probes.csv joined by commas, "time_s" first; in the arena. */
const char *probes_header(const struct scene *scene, struct arena *a, struct diag *d);

/* One row: the time, then each probe's values. */
void probes_sample(const struct probes *p, struct simulation *s, double *row);

#endif
