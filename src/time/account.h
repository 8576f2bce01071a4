/* SPDX-License-Identifier: MIT
 * What the account of work (T-46) carries from step to step, and what it finds. */
#pragma once

#include "case/scene.h"
#include "particles/particles.h"

/* An entry for each [fluid], [wall] and [solid] section, one kind after the other. */
enum { ENERGY_ENTRIES = KIND_COUNT * SCENE_MAX_SECTIONS };
SPHFSI_INLINE int energy_entry(enum kind kind, int section)
{
    return (int)kind * SCENE_MAX_SECTIONS + section;
}

/* Terms of the account, J/m. None of them grows in an exact solution (T-46). */
enum energy_term {
    TERM_FLUID,     /* what the fluid's energy gains beyond the work on it */
    TERM_INTERFACE, /* work on structures less what the fluid delivers */
    TERM_SOLID,     /* what the solid's energy gains beyond the work on it */
    TERM_ALL,       /* their sum: beyond the work at the boundaries of a region */
    ENERGY_TERMS
};

/* Energies of a section, or of a region at its first section, J/m. */
struct energy_entry {
    double region;     /* first section of its region; -1: no entry, as of walls at rest */
    double supplied;   /* energy at the start and all work since; of driven walls: on the fluid */
    double from_fluid; /* work on a body, at the velocity that the fluid uses */
    double received;   /* by a body, from the fluid (T-46c) */
    /* `supplied` after the last step, work of that step, and its largest change from step to step,
     * which bounds the error of the sums over steps. */
    double supplied_before, last_work, work_change;
    /* In a region: each term's lowest value, and since then the largest available energy; the
     * lowest potential. */
    double lowest[ENERGY_TERMS], available[ENERGY_TERMS], lowest_potential;
};

/* Saved in checkpoints and not hashed: doubles only. */
struct energy_account {
    struct energy_entry entry[ENERGY_ENTRIES];
    double most[ENERGY_TERMS]; /* that a region has gained by each term, J/m */
    double largest_available;  /* energy of any region, J/m */
    double now[ENERGY_TERMS];  /* sums over all sections at the last test, J/m; for tests */
    double pending;            /* time that the last evaluation still counts for, s */
    double through_open;       /* energy through open boundaries as far as it is counted, J/m */
    double tested_at, tested_steps; /* time and steps at the last test */
};
enum { ENERGY_NUMBERS = sizeof(struct energy_account) / sizeof(double) };

/* What a region has gained, J/m. */
struct energy_gain {
    int entry; /* first section of the region; -1: no region has gained energy */
    enum energy_term term;
    double share;     /* of the available energy; 0: no gain */
    double all;       /* gain of all terms together over the available energy */
    double energy;    /* beyond the lowest value of the term */
    double available; /* largest available energy since then */
    bool found;       /* the guards have yet to read it */
};
