/* SPDX-License-Identifier: MIT
 * A call of the public header: its options, what it must give back to the calling program, its
 * result and message. A session: a scene and its simulation, opened with these options. */
#pragma once

#include "sphfsi.h"
#include "output/json.h"
#include "base/threads.h"
#include "time/simulation.h"

struct call {
    const struct sphfsi_options *given; /* by the calling program */
    struct sphfsi_options options;      /* the same with callbacks that restore its settings */
    struct host host;                   /* its settings: locale, threads */
    struct diag diag;
    struct diag warned; /* `more`: the warnings so far */
};

/* Checks the options, NULL too, and begins; on failure call_end is all that may follow. */
enum err call_begin(struct call *c, const char *name, const struct sphfsi_options *given)
    SPHFSI_CHECKED;

/* Gives the calling program its settings back. */
enum sphfsi_status call_end(struct call *c, enum err e);

/* The result of a failure or success, its sentence kept for sphfsi_error. */
enum sphfsi_status call_result(const struct diag *d, enum err e);

/* The failure of a function that was handed NULL. */
enum sphfsi_status call_null_argument(const char *name, const char *what);

struct session {
    struct scene scene;
    struct simulation simulation;
    double opening; /* CPU time of this thread to open it, s */
};

/* Reads the case, sets default intervals of [output], applies --until; then the number of threads
 * and the simulation at time zero. On failure nothing remains to be freed. */
enum err session_open(struct session *session, const struct sphfsi_options *o, struct diag *d)
    SPHFSI_CHECKED;
void session_close(struct session *session);

/* The name of the case: that of its file without folder and ending, `length` characters. */
const char *session_name(const struct sphfsi_options *o, int *length);

/* A diag whose warnings go to the message callback. */
struct diag session_diag(const struct sphfsi_options *o);

/* Sends one line to the user, through the message callback. */
void session_say(const struct sphfsi_options *o, const char *format, ...) SPHFSI_PRINTF(2, 3);
/* Says what --quiet shows, too: what was asked for, and how to go on. */
void session_result(const struct sphfsi_options *o, const char *format, ...) SPHFSI_PRINTF(2, 3);

/* Sends what `write` writes as one text through the message callback. */
typedef enum err json_writer(struct json *j, void *context, struct diag *d);
enum err session_json(const struct sphfsi_options *o, json_writer *write, void *context,
                      struct diag *d) SPHFSI_CHECKED;

/* An action on the scene of a case, or on its simulation. */
typedef enum err case_action(struct session *session, const struct sphfsi_options *o,
                             struct diag *d);

/* A whole call of the public header with the scene of a case, or the simulation at time zero. */
enum sphfsi_status call_of_case(const char *name, const struct sphfsi_options *given,
                                bool simulation, case_action *act);

/* --- what other files of this folder offer each other --- */

/* case_change.c: compares two effective cases line by line: the checkpoint's, `old`, and the
 * present one. A restart may change end_time and output. A fork may also change physics, but not
 * what the state depends on: particles, masses, sound speed, kernel, integrator. ERR_INPUT names
 * the first line that must not differ. */
enum err case_change_check(const char *old, const char *now, bool fork, struct diag *d)
    SPHFSI_CHECKED;

/* evidence.c: prints the error that the accuracy study lets expect of each body. */
void evidence_say(const struct scene *scene, const struct sphfsi_options *o);

/* manual.c: the example of a key: from src/app/data/key_examples.cfg, or its default, or "". */
struct param;
void manual_example(const struct param *param, char *text, size_t size);

/* --- forecast.c: the cost of a run, from trial steps and a run at a coarser spacing --- */

/* What a whole run will take. Wall times on this machine, idle, with the session's threads, s. */
struct forecast {
    double dt;                          /* mean, of the fluid, or of a solid without fluid, s */
    double steps;                       /* of the fluid, or of a solid without fluid */
    double substeps;                    /* of the solid */
    double evaluations;                 /* of the fluid */
    double fluid;                       /* per fluid particle and evaluation, walls included */
    double solid;                       /* per solid particle and step */
    double phase_fraction[PHASE_COUNT]; /* of the time of all steps */
    double rows;                        /* of probes and ledger */
    double files;                       /* of snapshots and checkpoints */
    double seconds;                     /* all, the opening of the session included */
    double memory, disk;                /* bytes; disk: at most, while it runs */
    double coarse_dp;                   /* spacing of the coarse run, m; 0: there was none */
};

/* Takes trial steps for 0.3 s, with the rows of a run, measures its files in memory, and runs the
 * scene that `o` describes once more, at a coarser spacing. The simulation is of no use then. */
enum err forecast_run(struct forecast *f, struct session *session, const struct sphfsi_options *o,
                      struct diag *d) SPHFSI_CHECKED;
