/* SPDX-License-Identifier: MIT
 * The energy of a run: the rows of ledger.csv, and the account, which follows the work of all rates
 * and finds energy that nothing supplied (T-46). The account is the effect ENERGY_ACCOUNT: without
 * it, the functions that add to it do nothing. */
#ifndef SPHFSI_TIME_ENERGY_H
#define SPHFSI_TIME_ENERGY_H

#include "time/state.h"

/* Present energies, momentum and extremes; calls simulation_refresh. */
struct ledger simulation_ledger(struct simulation *sim);

/* Entries of solids, fluids and moving walls; returns their number. Walls at rest belong to no
 * region. */
int energy_entries(const struct simulation *sim, int list[ENERGY_ENTRIES]);

/* The first entry of the region that an entry belongs to. */
SPHFSI_INLINE int energy_region(const struct energy_account *account, int entry)
{
    return (int)account->entry[entry].region;
}

/* The ledger and the account begin with the present state. */
void energy_begin(struct simulation *sim);

/* Whether an account read from a checkpoint is valid. */
enum err energy_check_saved(const struct energy_account *account, struct diag *d) SPHFSI_CHECKED;

/* Work on a section that no rate does. */
void energy_supply(struct simulation *sim, enum kind kind, int section, double work);

/* After an evaluation at the present state, from which a step of dt starts: counts its rates over
 * half of the last step and half of this one, and tests for gains in between if that is due. */
void energy_of_step(struct simulation *sim, double dt);

/* After an evaluation in the middle of a step of dt: counts its rates over the step. */
void energy_of_midpoint(struct simulation *sim, double dt);

/* Before an Euler step of Verlet, after energy_of_step: the solution that it discards (T-46f). */
void energy_of_restart(struct simulation *sim);

/* After n kicks of the solid within dt from x0, y0, vx0, vy0: the work of the fluid, of the
 * impedance and of a program's accelerations. `centred`: kicks in the middle of drifts. */
void energy_of_solid(struct simulation *sim, double dt, int n, bool centred);

/* What a shift of particles adds to the energy of each fluid section is dissipated, J/m. */
void energy_of_shift(struct simulation *sim, const double gain[SCENE_MAX_SECTIONS]);

/* T-45: the compression energy of fluid particle i, whose density is about to be set to zero, is
 * dissipated. */
void energy_drop_density(struct simulation *sim, int64_t i);

/* After a step: work of moving walls, clamps, loads and of gravity that varies (T-70), all of which
 * the ledger has, too. */
void energy_after_step(struct simulation *sim);

/* T-46f: half of the energy by which the present state of each fluid section differs from the last
 * but one, which Verlet carries on as a solution of its own. Rates must be up to date. */
void energy_alternating(const struct simulation *sim, double of[SCENE_MAX_SECTIONS]);

/* The work of the fluid on rigid bodies in a step. */
void energy_of_rigid(struct simulation *sim);

/* Bodies that have exchanged a force belong to one region from now on. */
void energy_join_touching(struct simulation *sim);

/* Tests the present state for gains if that is due. */
void energy_test_due(struct simulation *sim);

/* The gain of a region that is the largest fraction of its available energy. Gradients and the
 * pressure of dummies must be up to date. */
struct energy_gain energy_find_gain(struct simulation *sim);

#endif
