/* SPDX-License-Identifier: MIT
 * The state of a run in memory: what it carries from step to step, and `struct simulation`,
 * which all files of this folder work on. */
#ifndef SPHFSI_TIME_STATE_H
#define SPHFSI_TIME_STATE_H

#include "coupling/coupling.h"
#include "fluid/open.h"
#include "fluid/wall_motion.h"
#include "particles/cells.h"
#include "solid/contact.h"
#include "solid/loads.h"

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
    /* Of regions, at their first section: the lowest value of each term, the energy that
     * dummies could return then, and the largest available energy since then; the lowest
     * potential energy. */
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

struct simulation;

/* Extremes of density (rho/rho0 - 1) and squared speed ((m/s)^2). The maxima may skip values that
 * are not numbers; the NaN probe is zero if there are none. */
struct extremes {
    double dens_low, dens_high, speed2, nan_probe;
};

/* Accelerations from outside, added to those of the model by a program that uses the library. */
typedef void external_function(void *context, double time, const struct particles *p, double *ax,
                               double *ay);
struct external {
    external_function *at; /* NULL: none */
    void *context;
    double *ax, *ay; /* m/s^2 */
};

/* What differs between the time integrators of Sec. 2.4. */
struct integrator {
    /* One step of fluid, walls and structures, which ends no later than t_limit. */
    void (*step)(struct simulation *sim, double t_limit);
    /* One step of a solid without fluid; NULL: by solid_advance. */
    void (*solid_step)(struct simulation *sim, double dt);
    double largest_cfl; /* up to it the fluid is stable */
    /* T-33b: a decay of density or velocity at a rate m is followed up to m dt of these. */
    double density_decay, velocity_decay;
    unsigned fluid_groups; /* fields that it needs beside those of its effect */
    double ahead;    /* the rates that advance the fluid are found this fraction of a step ahead */
    bool centred;    /* the solid kicks in the middle of its drifts, else before them */
    bool alternates; /* carries on two solutions, by turns */
};

struct simulation {
    const struct scene *scene; /* borrowed; outlives the simulation */
    const struct integrator *integrator;
    struct arena arena;
    struct particles kind[KIND_COUNT]; /* fluid, wall, solid */
    struct cells cells;
    struct fluid fluid; /* model and sweeps of fluid, walls and coupling; unused without fluid */
    struct wall_motion wall_motion; /* walls that move; unused where none does */
    struct open open;               /* open boundaries; unused without any */
    struct solid solid;             /* model of the solid; unused without one */
    struct coupling coupling;       /* of fluid and solid; unused without both */
    struct contact contact;         /* of the solid; unused without it */
    struct loads loads;             /* of the solid; unused without loads and moving clamps */
    effect_set effects;             /* bits of case/effects.h */
    struct state state;
    double dt_bound[BOUND_COUNT]; /* bounds found at the last step, s; INFINITY where none */
    double dt_solid;              /* stable step of the solid times its safety, s */
    double dt_lone_solid;         /* the same as if there were no contact */
    int substeps;                 /* solid steps in the last fluid step */
    double phase_seconds[PHASE_COUNT];
    struct extremes extremes; /* of the fluid */
    double speed2;            /* of the fastest particle of any kind, squared, (m/s)^2 */
    double solid_max_move;    /* of a solid particle in the last step, m (not with symplectic) */
    double shifted;      /* largest shift of a fluid particle in the last step, m; 0: no shifting */
    double skin_left;    /* distance that two particles may move until a sorting is due, m */
    bool evaluated;      /* rates, pressures and the fluid's force are those of the present state */
    bool cells_overfull; /* more particles in a cell than the sweeps support: no evaluations */
    bool gravity_varies; /* with time */
    int uneven; /* the output, from 1, that has no such grid with those before it; 0: none */
    double output_grid; /* s, of all frequent outputs; 0: none is needed (T-34d) */
    struct {
        int64_t n;
        double *value;
    } carried; /* by probes from step to step (output/probes.h): checkpointed, not hashed */
    struct guard guard;
    struct external external[KIND_COUNT]; /* of fluid and solid */
    struct gain gain;                     /* of the last check of the account */
    bool checked;                         /* the guards have yet to read it */
};

/* "t = 0.1 s" for a message; while rest is sought (T-78), how long it has been sought. */
struct time_text {
    char text[64];
};
struct time_text time_text(const struct simulation *sim);

/* Adds the time since `since` to a phase and returns the present time. */
double phase_add(struct simulation *sim, enum phase phase, double since);

#endif
