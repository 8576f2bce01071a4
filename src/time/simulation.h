/* SPDX-License-Identifier: MIT
 * A run in memory: from a scene to its state at time zero, and step by step onward. Contains
 * no file names and no command lines. */
#pragma once

#include "time/energy.h"

/* Builds the state at time zero of a scene, or arrays for a checkpoint. Frees all if it fails. */
enum err simulation_create(struct simulation *sim, const struct scene *scene, struct diag *d)
    SPHFSI_CHECKED;
void simulation_free(struct simulation *sim);

/* Most steps of a call: SOLID_BATCH of solids without fluid that nothing else needs singly. */
enum { SOLID_BATCH = 16 };
int simulation_batch(const struct simulation *sim);

/* Advances by one time step, or by up to simulation_batch, ending at t_limit (> time) at the
 * latest. INFINITY: the physics alone sets the step. The observer sees the state before and after.
 * ERR_GUARD: the state is invalid; d has the message. */
enum err simulation_step(struct simulation *sim, double t_limit, struct diag *d) SPHFSI_CHECKED;

/* After the STATE fields, n of each kind and sim->state have been loaded from a checkpoint:
 * rebuilds everything derived. The next step gives the same bits as in the uninterrupted run. */
enum err simulation_resume(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

/* Hash of every STATE field and state scalar but those of the energy account, which measures the
 * run and does not act on it; calls simulation_refresh. */
uint64_t simulation_hash(struct simulation *sim);

/* Registers `f`, which adds accelerations to the particles of a kind (fluid or solid) from the
 * next evaluation on. It is called at each evaluation of the fluid, for sub-steps too. */
enum err simulation_set_force_hook(struct simulation *sim, enum kind kind, force_hook_function *f,
                                   void *context, struct diag *d) SPHFSI_CHECKED;

/* --- evaluation.c --- */

/* Brings DERIVED fields that output uses up to date without changing the state. */
void simulation_refresh(struct simulation *sim);

/* As simulation_refresh, and finds the force on all walls: a step needs it on moving ones only. */
void simulation_wall_forces(struct simulation *sim);

/* --- sorting.c --- */

/* Particles within the kernel's reach of a point, of the first `kinds` kinds. */
int simulation_count_near(const struct simulation *sim, double x, double y, int kinds);

/* --- relax.c: the search for a state of rest before a run (T-78) --- */

/* A step of the search, whose clock is the state's time. Without motion for long enough the search
 * is over. ERR_GUARD: a guard, or no rest within relax.limit. */
enum err relax_step(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

/* Ends the search: the run begins at rest in the present positions; time and account begin anew. */
void relax_end(struct simulation *sim);

/* All steps of the search. */
enum err relax_to_rest(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

enum { RELAX_TEXT = 320 };
/* Says how far the search has come. */
void relax_progress(const struct simulation *sim, char text[RELAX_TEXT]);
/* Says what was found and by which criterion. */
void relax_text(const struct simulation *sim, char text[RELAX_TEXT]);
