/* SPDX-License-Identifier: MIT
 * What a run carries from step to step beside its particles: scalars, the account of energy, limits of the
 * guards. */
#ifndef SPHFSI_TIME_STATE_H
#define SPHFSI_TIME_STATE_H

#include "case/scene.h"
#include "particles/particles.h"

/* An entry for each [fluid], [wall] and [solid] section, one kind after the other. */
enum { ACCOUNT_ENTRIES = KIND_COUNT * SCENE_MAX_SECTIONS };

/* Terms of the account, J/m. Each is negative in an exact solution, or zero (T-46). */
enum account_term {
    TERM_FLUID,       /* what the fluid's energy gains beyond the work of all its rates */
    TERM_DISSIPATION, /* work of viscosity, diffusion, shifting and T-45 */
    TERM_INTERFACE,   /* work on structures less what the fluid delivers */
    TERM_SOLID,       /* what the solid's energy gains beyond the work on it */
    TERM_RESTARTS,    /* what Verlet's Euler steps add (Eq. 26) */
    TERM_ALL,         /* these, and the work of dummies */
    ACCOUNT_TERMS
};

/* Work of a step on a section. */
enum account_source { SOURCE_FLUID, SOURCE_OUTSIDE, ACCOUNT_SOURCES };

/* Energies in J/m. */
struct account {
    /* Of sections: energy at the start and all work since then; the work of the last step,
     * by the fluid's rates or its force and from outside; the largest change of either
     * from step to step. */
    double put[ACCOUNT_ENTRIES], last[ACCOUNT_SOURCES][ACCOUNT_ENTRIES];
    double step_work[ACCOUNT_ENTRIES];
    double spent[ACCOUNT_ENTRIES];    /* TERM_DISSIPATION of fluids */
    double restarts[ACCOUNT_ENTRIES]; /* TERM_RESTARTS of fluids */
    double dummies[ACCOUNT_ENTRIES]; /* work of dummies on the fluid beyond that on the structure */
    double exchange[ACCOUNT_ENTRIES]; /* TERM_INTERFACE of solids, with the work still to return */
    /* Of regions, at their first section: the lowest value of each term, the energy that dummies
     * could return then, and the largest available energy since then; the lowest potential energy. */
    double low[ACCOUNT_TERMS][ACCOUNT_ENTRIES], available[ACCOUNT_TERMS][ACCOUNT_ENTRIES];
    double lowest[ACCOUNT_ENTRIES];
    double region[ACCOUNT_ENTRIES]; /* the first section of the region that a section belongs to */
    /* The most that any region has gained by each term, the error of the sums included, and the
     * largest available energy of any, J/m. */
    double most[ACCOUNT_TERMS], top;
    double now[ACCOUNT_TERMS]; /* sums over all sections at the last check */
    double pending;            /* s, from the last evaluation counted to the present state */
    double open;       /* energy that open boundaries have brought in as far as it is counted */
    double checked_at; /* time of the last check, s */
};

/* What a region has gained, J/m. */
struct gain {
    int entry; /* first section of the region; -1: no region has gained energy */
    enum account_term term;
    double all;       /* gain of all terms together over the available energy */
    double energy;    /* beyond the lowest value of the term */
    double available; /* largest available energy since then */
    double kinetic, internal, elastic, hourglass; /* of the region now */
};
enum { ACCOUNT_NUMBERS = sizeof(struct account) / sizeof(double) };

struct guard {
    double dens_limit;  /* |rho/rho0 - 1| */
    double speed_limit; /* m/s: at the speed of sound no flow is weakly compressible */
    double step_limit;  /* s: a smaller step stops the run */
    bool warned_speed, warned_dens, warned_det, warned_step, warned_crossing, warned_energy,
        warned_contact, warned_voids;
    bool case_at_fault; /* what stopped the run would stop it with shorter steps, too */
};

enum bound {
#define BOUND(name, effect, source) BOUND_##name,
#include "time/bounds.def"
#undef BOUND
    BOUND_COUNT
};
/* Their names and sources, from time/bounds.def. */
extern const char *const bound_names[BOUND_COUNT];
extern const char *const bound_sources[BOUND_COUNT];

/* Scalars carried from step to step, from time/state.def. */
struct state {
#define STATE(type, name, low, high, unit, meaning) type name;
#include "time/state.def"
#undef STATE
    int64_t bound_steps[BOUND_COUNT]; /* steps that each bound has limited */
    struct account account;           /* of energy, by regions */
};

#endif
