/* SPDX-License-Identifier: MIT
 * The energy account by regions: sections that exchange energy with each other and with no others.
 * */
#ifndef SPHFSI_TIME_ACCOUNT_H
#define SPHFSI_TIME_ACCOUNT_H

#include "time/state.h"

/* Whether an account read from a file is valid. */
enum err account_check(const struct account *a, struct diag *d) SPHFSI_CHECKED;

/* Where a section is. */
int account_entry(enum kind kind, int section);

/* Starts the account with the present energies. Gradients and the pressure of dummies must be up
 * to date. */
void account_begin(struct simulation *s);

/* Adds the work done on a section in a step. */
void account_work(struct account *a, enum account_source source, enum kind kind, int section,
                  double work);

/* T-46f: half of the energy by which the present state of each fluid section differs from the last but one,
 * which Verlet carries on as a solution of its own. Rates must be up to date. */
void account_alternating(const struct simulation *s, double of[SCENE_MAX_SECTIONS]);

/* Notes the work of a step: its change bounds the error of the sums over steps. */
void account_step(struct account *a, enum account_source source, int entry, double work);

/* Bodies that have touched in this step belong to one region from now on: they may part before the
 * next check. */
void account_touch(struct simulation *s);

/* Checks the regions. Gradients and the pressure of dummies must be up to date. Returns the gain
 * that is the largest fraction of the available energy. One within the error of the sums counts as
 * none. */
struct gain account_gain(struct simulation *s);

/* Writes the names of a region's sections, "[solid plate], [fluid left]"; returns their number. */
enum { ACCOUNT_TEXT = 160 };
int account_name(const struct simulation *s, int entry, char text[ACCOUNT_TEXT]);

/* The fastest particle of a region; false if none moves. */
bool account_fastest(const struct simulation *s, int entry, double at[2]);

#endif
