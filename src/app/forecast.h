/* SPDX-License-Identifier: MIT
 * What a run will cost: steps from the bounds of the time step, time from a calibration of the scene's own
 * kernels on this machine. */
#ifndef SPHFSI_APP_FORECAST_H
#define SPHFSI_APP_FORECAST_H

#include "app/session.h"

/* What a step costs here, in seconds of one thread, and what it consists of. */
struct unit_costs {
    double fluid;                       /* of a fluid particle and evaluation, with all around it */
    double solid;                       /* of a solid particle and step */
    double evaluations;                 /* of the fluid in a step */
    double phase_fraction[PHASE_COUNT]; /* of a step's time */
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

/* Opens a session for one thread, since two that wait for each other on a busy machine measure its other
 * work; `threads`: those that a run would take. Closing brings them back. */
enum err forecast_open(struct session *x, const struct sphfsi_options *o, int *threads,
                       struct diag *d) SPHFSI_CHECKED;
void forecast_close(struct session *x, int threads);

/* The costs from about a second of the scene's own first steps, the least of several repeats, unless this
 * machine and program have measured such a scene before: a cache below $XDG_CACHE_HOME or ~/.cache that may
 * be missing or broken. Takes steps of the simulation. */
enum err forecast_calibrate(struct unit_costs *c, struct simulation *s, struct diag *d)
    SPHFSI_CHECKED;

/* Says what error the study has found with the scene's `accuracy`, in cases of its kind. */
void forecast_say_errors(const struct scene *s, const struct sphfsi_options *o);

/* The same where the case names its `accuracy`. */
void forecast_say_preset(const struct scene *s, const struct sphfsi_options *o);

/* The whole run of the scene, or of the same with dp times `scale`. */
struct forecast forecast_run(const struct unit_costs *c, const struct simulation *s, int threads,
                             double scale);

#endif
