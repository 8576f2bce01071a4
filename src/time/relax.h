/* SPDX-License-Identifier: MIT
 * The search for a state of rest before a run (T-78). */
#ifndef SPHFSI_TIME_RELAX_H
#define SPHFSI_TIME_RELAX_H

#include "time/state.h"

/* Whether the scene asks for a state of rest that has not been found yet. */
bool relax_due(const struct simulation *sim);

/* A step of the search; the clock stays at 0. Without motion for long enough the search is over and
 * the account of energy begins anew. ERR_GUARD: a guard, or no rest within relax.limit. */
enum err relax_step(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

/* All steps of the search. */
enum err relax_to_rest(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

enum { RELAX_TEXT = 320 };
/* Says how far the search has come. */
void relax_progress(const struct simulation *sim, char text[RELAX_TEXT]);
/* Says what was found and by which criterion. */
void relax_text(const struct simulation *sim, char text[RELAX_TEXT]);

#endif
