/* SPDX-License-Identifier: MIT
 * The cost of a run. The bounds of the time step give the number of steps; trial steps of this
 * scene on this machine give the time of each. */
#pragma once

#include "app/session.h"

/* Wall times on this machine with the threads of the session, s. */
struct unit_costs {
    double fluid;                       /* per fluid particle and evaluation, walls included */
    double solid;                       /* per solid particle and step */
    double evaluations;                 /* of the fluid per step */
    double phase_fraction[PHASE_COUNT]; /* of the time of a step */
    double rows;                        /* of probes and ledger over the whole run */
    double snapshots;                   /* all of the run */
    double opening;                     /* of the session, which the caller knows */
};

struct forecast {
    double dt;           /* of the fluid, or of a solid without fluid, s */
    double steps;        /* of the fluid, or of a solid without fluid */
    double substeps;     /* of the solid */
    double evaluations;  /* of the fluid */
    double seconds;      /* wall time on an idle machine */
    double memory, disk; /* bytes; disk: at most, while it runs */
};

/* Measures the scene's first steps for 0.3 s, then its outputs and disordered fluid. Leaves the
 * simulation in a state of no meaning. */
enum err forecast_measure(struct unit_costs *c, struct simulation *sim, struct diag *d)
    SPHFSI_CHECKED;

/* The cost of the whole run. */
struct forecast forecast_run(const struct unit_costs *c, const struct simulation *sim);
