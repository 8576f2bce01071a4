/* SPDX-License-Identifier: MIT
 * The cost of a run: the number of steps from the bounds of the time step, the time of a step from a
 * measurement of this scene on this machine. */
#ifndef SPHFSI_APP_FORECAST_H
#define SPHFSI_APP_FORECAST_H

#include "app/session.h"

/* Cost of a step on this machine, in seconds of one thread. */
struct unit_costs {
    double fluid;                       /* per fluid particle and evaluation, walls included */
    double solid;                       /* per solid particle and step */
    double evaluations;                 /* of the fluid per step */
    double phase_fraction[PHASE_COUNT]; /* of the time of a step */
    double rows;                        /* of probes and ledger over the whole run, s */
    bool cached;                        /* from an earlier calibration */
};

struct forecast {
    double dt;           /* of the fluid, or of a lone solid, s */
    double steps;        /* of the fluid, or of a lone solid */
    double substeps;     /* of the solid */
    double evaluations;  /* of the fluid */
    double particles;    /* fluid and solid */
    double seconds;      /* wall time on an idle machine */
    double memory, disk; /* bytes; disk: at most, while it runs */
};

/* Opens a session for one thread: on a busy machine several threads would measure the waiting for each other.
 * `threads`: the number that a run would use; forecast_close sets it again. */
enum err forecast_open(struct session *x, const struct sphfsi_options *o, int *threads,
                       struct diag *d) SPHFSI_CHECKED;
void forecast_close(struct session *x, int threads);

/* Measures about a second of the scene's first steps, and takes the least of several repeats. Costs of steps
 * come from a cache below $XDG_CACHE_HOME or ~/.cache, if it has a scene of the same kind; those of rows are
 * always measured. Advances the simulation by some steps. */
enum err forecast_calibrate(struct unit_costs *c, struct simulation *s, struct diag *d)
    SPHFSI_CHECKED;

/* Prints the error that the study (docs/accuracy.md) lets expect of each body at its resolution. */
void forecast_say_errors(const struct scene *s, const struct sphfsi_options *o);

/* The same, if the case names its `accuracy`. */
void forecast_say_preset(const struct scene *s, const struct sphfsi_options *o);

/* The cost of the whole run, with dp times `scale`. */
struct forecast forecast_run(const struct unit_costs *c, const struct simulation *s, int threads,
                             double scale);

#endif
