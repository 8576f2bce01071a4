/* SPDX-License-Identifier: MIT
 * The energy account by regions: sections that exchange energy with each other and with no others.
 * */
#ifndef SPHFSI_TIME_ACCOUNT_H
#define SPHFSI_TIME_ACCOUNT_H

#include "time/simulation.h"

/* Whether an account read from a file is valid. */
enum err account_check(const struct account *a, struct diag *d) SPHFSI_CHECKED;

/* What a region has gained, J/m. */
struct gain {
    int entry; /* first section of the region; -1: no region has gained energy */
    double energy,
        play;   /* since its dissipation was largest, and the largest energy in play since then */
    double net; /* beyond all energy supplied from outside */
    double kinetic, internal, elastic, hourglass; /* in play in the region now */
};

/* Where a section is. */
int account_entry(enum kind kind, int section);

/* Starts the account with the present energies. */
void account_begin(struct simulation *s, const struct ledger *now);

/* Adds the work done on a section from outside in a step. */
void account_work(struct account *a, enum kind kind, int section, double work);

/* Checks the regions at a row of the ledger. Returns the one whose gain is the largest fraction of
 * its energy in play. A gain within the rounding error of the sums counts as none. */
struct gain account_look(struct simulation *s, const struct ledger *now);

/* Writes the names of a region's sections, "[solid plate], [fluid left]". */
enum { ACCOUNT_TEXT = 160 };
void account_name(const struct simulation *s, int entry, char text[ACCOUNT_TEXT]);

/* The fastest particle of a region; false if none moves. */
bool account_fastest(const struct simulation *s, int entry, double at[2]);

#endif
