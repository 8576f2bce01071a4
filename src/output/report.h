/* SPDX-License-Identifier: MIT
 * summary.json: parameters, progress, cost, conservation and extremes of a run. */
#pragma once

#include "output/json.h"
#include "output/probes.h"

/* What a summary holds besides the simulation itself. */
struct record {
    const char *exit_reason; /* "finished", "running", "guard", "input_output", "interrupted" */
    const char *message;     /* of a failure, or "" */
    const char *version;
    const char *restarted_from; /* checkpoint, or "" */
    const char *forked_from;    /* checkpoint of another run, or "" */
    int threads;
    double wall_seconds; /* of this process, from the first step on */
    double start_time;   /* s, simulated, at which this process began */
    int64_t start_particle_steps;
    struct ledger first, last;   /* at time zero and now */
    const struct probes *probes; /* of a finished run: their loads are written */
};

/* Writes summary.json to the folder of the run, atomically. */
enum err report_summary(const char *folder, struct simulation *sim, const struct record *r,
                        struct diag *d) SPHFSI_CHECKED;

/* Parts of the summary: values in effect; effects and the keys that need them; derived values. */
void report_parameters(struct json *j, const struct scene *scene);
void report_effects(struct json *j, const struct simulation *sim);
void report_derived(struct json *j, const struct scene *scene);

/* Particle steps (fluid and solid) per second of wall time of this process. */
double report_rate(const struct simulation *sim, const struct record *r);
