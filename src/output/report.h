/* SPDX-License-Identifier: MIT
 * summary.json: parameters, progress, cost, conservation and extremes of a run. */
#pragma once

#include "output/json.h"
#include "output/probes.h"

/* --- reference.c: reference curves of a case, and deviations of probes from them --- */

/* Values over time; `t` is malloc'd and holds all. */
struct curve {
    int n;
    double *t, *value;
};

/* Reads the complete rows of a column; after the values are `spare` times as many zeros. */
enum err curve_read(struct curve *curve, const char *path, int column, size_t spare, struct diag *d)
    SPHFSI_CHECKED;

/* Deviation of a probe from a reference, in units of the column. A peak is the first local extremum
 * within 0.5 % of the largest magnitude; NAN: none. */
struct score {
    int points;                /* compared; 0: the times of run and reference do not overlap */
    double rms, largest, mean; /* of probe - reference; largest: of its magnitude */
    double peak, peak_time;
    double peak_reference, peak_time_reference; /* of the reference */
    double probe_mean;
    double scale; /* largest magnitude of the reference */
};

/* One [reference] section. */
struct reference {
    const struct scene_reference *from;
    int file, column;  /* of probes.csv, or of another file of probes */
    int n;             /* rows of the file, in the order of time; 1: constant; 0: a formula */
    double *t, *value; /* [n] */
    struct score score;
};

struct references {
    int n;
    struct reference *item;
    bool scored;
};

/* Reads the files of the scene's references, and finds the column of each in the headers of the n
 * files of probes. ERR_INPUT: a file is missing or malformed, or no such column exists. */
enum err references_open(struct references *r, const struct scene *scene, int n,
                         const struct probe_file *files, struct arena *a, struct diag *d)
    SPHFSI_CHECKED;

/* Compares the file of probes that has its column with a reference. One with several rows is
 * compared at its times, the probe being linear between its own; others at those. */
enum err reference_score(struct reference *r, const char *probes_csv, struct diag *d)
    SPHFSI_CHECKED;

/* Writes the scores as an object, by name. */
void references_write(struct json *j, const struct references *r);

/* Writes one line for the user. */
void reference_line(const struct reference *r, char *text, size_t size);

/* What a summary holds besides the simulation itself. */
struct record {
    const char *exit_reason; /* "finished", "running", "guard", "input_output", "interrupted" */
    const char *message;     /* of a failure, or "" */
    const char *version;
    const char *restarted_from; /* checkpoint, or "" */
    const char *forked_from;    /* checkpoint of another run, or "" */
    int64_t snapshots_missed;   /* not written, with [output] snapshot_failure = go_on */
    int threads;
    double wall_seconds; /* of this process, from the first step on */
    double start_time;   /* s, simulated, at which this process began */
    int64_t start_particle_steps;
    struct ledger first, last; /* at time zero and now */
    const struct references *references;
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
