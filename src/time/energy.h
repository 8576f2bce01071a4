/* SPDX-License-Identifier: MIT
 * The energy of a run: the rows of ledger.csv, and the account of work (T-46), which finds energy
 * that nothing supplied. The account is the effect ENERGY_ACCOUNT: without it, the functions that
 * add to it do nothing. */
#pragma once

#include "time/state.h"

/* Present energies, momentum and extremes; calls simulation_refresh. */
struct ledger simulation_ledger(struct simulation *sim);

/* The ledger and the account begin with the present state. */
void energy_begin(struct simulation *sim);

/* Energy that a section gets at once. */
void energy_supply(struct simulation *sim, enum kind kind, int section, double work);

/* After an evaluation at the present state, from which a step of dt starts: counts the work of its
 * forces over half of the last step and half of this one, and tests for gains in between if that is
 * due. */
void energy_of_step(struct simulation *sim, double dt);

/* After an evaluation: counts the work of its forces over dt. */
void energy_of_evaluation(struct simulation *sim, double dt);

/* After n kicks of the solid within dt from x0, y0, vx0, vy0: the work of the fluid, of the
 * impedance and of a program's accelerations. `centred`: kicks in the middle of drifts. */
void energy_of_solid(struct simulation *sim, double dt, int n, bool centred);

/* The work on a rigid body or a beam in a step: by the fluid; by motions and loads from outside,
 * which the ledger has, too; and by other bodies. */
void energy_of_body(struct simulation *sim, int wall, double received, double driven,
                    double passed);

/* After a step: work of moving walls, clamps, loads and of gravity that varies (T-70), all of which
 * the ledger has, too. */
void energy_after_step(struct simulation *sim);

/* Tests the present state for gains if that is due. */
void energy_test_due(struct simulation *sim);

/* The gain of a region that is the largest fraction of its available energy. Gradients and the
 * pressure of dummies must be up to date. */
struct energy_gain energy_find_gain(struct simulation *sim);

/* Reads the last test of the account: warns once if a region has gained energy, and fails if the
 * gain is nine tenths of its available energy. */
enum err energy_guard(struct simulation *sim, struct diag *d) SPHFSI_CHECKED;
