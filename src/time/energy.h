/* SPDX-License-Identifier: MIT
 * The energy of a run: a row of ledger.csv, and the account of work (T-46). */
#pragma once

#include "time/state.h"

/* The columns of ledger.csv with their units, in order: LEDGER(name, unit, meaning). Per depth. */
#define LEDGER_COLUMNS(LEDGER)                                                            \
    LEDGER(time, "s", "simulated time")                                                   \
    LEDGER(kinetic, "J_per_m", "kinetic energy of fluid and solid")                       \
    LEDGER(potential, "J_per_m",                                                          \
           "in gravity at t = 0, relative to the origin; and of springs with a `force`")  \
    LEDGER(internal, "J_per_m", "compression energy of the fluid")                        \
    LEDGER(elastic, "J_per_m", "strain energy of solids and beams, and of springs")       \
    LEDGER(hourglass, "J_per_m", "energy of the hourglass force")                         \
    LEDGER(contact, "J_per_m", "energy of the contact forces")                            \
    LEDGER(dissipated, "J_per_m",                                                         \
           "energy at the start plus external work, minus all of the above")              \
    LEDGER(momentum_x, "Ns_per_m", "momentum of fluid and solid, x")                      \
    LEDGER(momentum_y, "Ns_per_m", "momentum of fluid and solid, y")                      \
    LEDGER(mass, "kg_per_m", "mass of fluid and solid")                                   \
    LEDGER(dens_extreme, "1", "current largest |rho/rho0 - 1| of the fluid")              \
    LEDGER(det_low, "1", "current smallest det F")                                        \
    LEDGER(dt, "s", "last time step")                                                     \
    LEDGER(newton_steps, "1", "corrections of Newton's method in the last implicit step") \
    LEDGER(newton_residual, "1",                                                          \
           "residual of the last implicit step, over the largest force of a particle")    \
    LEDGER(damped, "J_per_m", "the part of `dissipated` that [damping] zones have taken")

struct ledger {
#define LEDGER(name, unit, meaning) double name;
    LEDGER_COLUMNS(LEDGER)
#undef LEDGER
};

/* Present energies, momentum and extremes; calls simulation_refresh. */
struct ledger simulation_ledger(struct simulation *sim);

/* The ledger and the account begin with the present state. */
void energy_begin(struct simulation *sim);

/* --- the account of work (T-46), which finds energy that nothing supplied. Without the effect
 * ENERGY_ACCOUNT the functions that add to it do nothing. --- */

/* Energy that a section gets at once. */
void energy_supply(struct simulation *sim, enum kind kind, int section, double work);

/* energy_book_evaluation adds, after an evaluation, the work of its forces over dt.
 * energy_book_step adds, before a step of dt, that work for half of the last step and half of this
 * one. Between the two it tests for gains if that is due. */
void energy_book_evaluation(struct simulation *sim, double dt);
void energy_book_step(struct simulation *sim, double dt);

/* Before the test: what buffers have exchanged since the last step, other than by forces. */
void energy_book_exchange(struct simulation *sim);

/* After n kicks of the solid within dt from ux0, uy0, vx0, vy0: the work on it. */
void energy_book_solid(struct simulation *sim, double dt, int n);

/* The work on a rigid body or a beam in a step: by the fluid; by motions and loads from outside,
 * which the ledger has, too; and by other bodies. */
void energy_book_body(struct simulation *sim, int wall, double received, double driven,
                      double passed);

/* After a step: work of moving walls, clamps, loads, varying gravity (T-70), as in the ledger. */
void energy_after_step(struct simulation *sim);

/* Tests the present state for gains if that is due: for the gain of a region that is the largest
 * fraction of its available energy. Gradients and the pressure of dummies must be up to date. */
void energy_test_if_due(struct simulation *sim);
struct energy_gain energy_find_gain(struct simulation *sim);

/* Reads the last test: warns once of a gain, and fails above 0.9 of the available energy. */
enum err energy_guard(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;
