/* SPDX-License-Identifier: MIT
 * The search for a state of rest before a run (T-78). */
#pragma once

#include "time/state.h"

/* A step of the search, whose clock is the state's time. Without motion for long enough the search
 * is over. ERR_GUARD: a guard, or no rest within relax.limit. */
enum err relax_step(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

/* Ends the search: the run begins with the present positions at rest; time, counts of steps and the
 * account of energy begin anew. */
void relax_end(struct simulation *sim);

/* All steps of the search. */
enum err relax_to_rest(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

enum { RELAX_TEXT = 320 };
/* Says how far the search has come. */
void relax_progress(const struct simulation *sim, char text[RELAX_TEXT]);
/* Says what was found and by which criterion. */
void relax_text(const struct simulation *sim, char text[RELAX_TEXT]);
