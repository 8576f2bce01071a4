/* SPDX-License-Identifier: MIT
 * The account of energy by regions: sections that exchange energy with each other, and with no others. */
#ifndef SPHFSI_TIME_ACCOUNT_H
#define SPHFSI_TIME_ACCOUNT_H

#include "time/simulation.h"

/* Whether an account that has been read is one. */
enum err account_check(const struct account *a, struct diag *d) SPHFSI_CHECKED;

/* What a region has gained, J/m. */
struct gain {
    int entry;           /* first of the region; -1: none has gained anything */
    double energy, play; /* since it had lost most; and the largest energy in play meanwhile */
    double net;          /* beyond all that it was given */
    double kinetic, internal, elastic, hourglass; /* of the region now */
};

/* Where a section stands. */
int account_entry(enum kind kind, int section);

/* Begins with the energies as they are. */
void account_begin(struct simulation *s, const struct ledger *now);

/* Books work on a section from outside, in a step. */
void account_work(struct account *a, enum kind kind, int section, double work);

/* Looks at the regions at a row of the ledger; the one whose gain is the largest share. Gains within what the
 * sums of work and energy can be off are none. */
struct gain account_look(struct simulation *s, const struct ledger *now);

/* Names the sections of a region, "[solid plate], [fluid left]". */
enum { ACCOUNT_TEXT = 160 };
void account_name(const struct simulation *s, int entry, char text[ACCOUNT_TEXT]);

/* The fastest particle of a region; false where none moves. */
bool account_fastest(const struct simulation *s, int entry, double at[2]);

#endif
