/* SPDX-License-Identifier: MIT
 * A simulation built from a case given as text, numbers without a pattern, and comparisons that
 * print both values. */
#ifndef RIG_H
#define RIG_H

#include "time/simulation.h"

/* A zeroed rig is a valid closed one. */
struct rig {
    struct scene scene;
    struct simulation sim;
    struct diag diag;
    bool scene_open, sim_open;
};

/* Taken over by every simulation that rig_open creates. */
extern struct test_switches rig_switches;

/* Parses the case with the --set arguments that follow, up to NULL, and creates the simulation; the
 * test fails with the sentence if either does. A rig in use is closed first. */
void rig_open(struct rig *r, const char *text, ...) __attribute__((sentinel));
void rig_close(struct rig *r);

/* For tests of solids, which have a `rig` and its solid particles `p`. */
#define RIG_OPEN_SOLID(text, ...)                \
    do {                                         \
        rig_open(&rig, text, __VA_ARGS__, NULL); \
        p = &rig.sim.particles[KIND_SOLID];      \
    } while (0)

/* Steps until the time is reached exactly; the test fails if a guard stops the run. */
void rig_run(struct rig *r, double time);
/* Takes `steps` time steps (batches of a lone solid), none of which ends beyond `limit`. */
void rig_steps(struct rig *r, int steps, double limit);
/* Fails unless the case is bad input, with `why` in its message. */
void rig_refuses(const char *text, const char *why);

/* Sorts all particles into cells anew, after a test has moved them. */
void rig_sort(struct rig *r);
/* One evaluation of the fluid's rates, the walls' pressures and the fluid's force on solids. */
void rig_evaluate(struct rig *r);
/* Tait's pressure of a fluid particle, Pa. */
double rig_pressure(const struct simulation *sim, int64_t i);

/* Tests of small scenes run beside each other, and a barrier of threads that share a core costs
 * more than the work: one thread from here on. */
void rig_one_thread(void);

/* The next of a fixed sequence of numbers, evenly spread over [-1, 1). */
double noise(uint64_t *state);

/* Fails with both values unless |actual - expected| <= tolerance. */
void assert_near(double tolerance, double expected, double actual, const char *what);
/* Fails with both values unless value <= limit. */
void assert_at_most(double limit, double value, const char *what);

/* Tests put energy into the state: no gain of energy stops a run that a rig has opened, unless the
 * account begins again (energy_begin). */
void rig_ignore_gains(struct rig *r);

#endif
