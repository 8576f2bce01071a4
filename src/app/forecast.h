/* SPDX-License-Identifier: MIT
 * The cost of a run: trial steps of this scene on this machine give the time of each, a run of the
 * same scene at a coarser spacing gives their number and by how much they become slower. */
#pragma once

#include "app/session.h"

/* Of the whole run. Wall times on this machine, idle, with the threads of the session, s. */
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
 * scene that `o` describes once more, at a coarser spacing. Leaves the simulation in a state of no
 * meaning. */
enum err forecast_run(struct forecast *f, struct session *session, const struct sphfsi_options *o,
                      struct diag *d) SPHFSI_CHECKED;
