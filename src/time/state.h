/* SPDX-License-Identifier: MIT
 * What a run carries from step to step beside its particles: scalars, the account of energy, limits of the
 * guards. */
#ifndef SPHFSI_TIME_STATE_H
#define SPHFSI_TIME_STATE_H

#include "case/scene.h"
#include "particles/particles.h"

/* An entry for each [fluid], [wall] and [solid] section, one kind after the other. */
enum { ACCOUNT_ENTRIES = KIND_COUNT * SCENE_MAX_SECTIONS };

/* Energies in J/m. */
struct account {
    /* Of sections: energy at the start, work from outside since then, and the largest work of a
     * step. */
    double put[ACCOUNT_ENTRIES], step_work[ACCOUNT_ENTRIES];
    /* Of regions, at their first section: the most that has been dissipated so far, and the largest
     * energy in play since then. */
    double high[ACCOUNT_ENTRIES], play[ACCOUNT_ENTRIES];
    double region[ACCOUNT_ENTRIES]; /* the first section of the region that a section belongs to */
};
enum { ACCOUNT_NUMBERS = sizeof(struct account) / sizeof(double) };

struct guard {
    double dens_limit;  /* |rho/rho0 - 1| */
    double speed_limit; /* m/s: at the speed of sound no flow is weakly compressible */
    double step_limit;  /* s: a smaller step stops the run */
    bool warned_speed, warned_dens, warned_det, warned_step, warned_crossing, warned_energy,
        warned_contact;
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
