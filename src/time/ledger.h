/* SPDX-License-Identifier: MIT
 * The ledger: energies, momentum, extremes. */
#ifndef SPHFSI_TIME_LEDGER_H
#define SPHFSI_TIME_LEDGER_H

#include "time/state.h"

/* One row of ledger.csv. Per depth. */
struct ledger {
    double time, kinetic, potential, internal, elastic, hourglass, contact, dissipated;
    double momentum_x, momentum_y, mass, dens_extreme, det_low, dt;
};

/* The columns of struct ledger with their units, in order: LEDGER(name, unit, meaning). */
/* clang-format off */
#define LEDGER_COLUMNS(LEDGER)                                                                    \
    LEDGER(time, "s", "simulated time")                                                           \
    LEDGER(kinetic, "J_per_m", "kinetic energy of fluid and solid")                               \
    LEDGER(potential, "J_per_m", "potential energy in gravity at t = 0, relative to the origin")  \
    LEDGER(internal, "J_per_m", "compression energy of the fluid")                                \
    LEDGER(elastic, "J_per_m", "strain energy of the solid")                                      \
    LEDGER(hourglass, "J_per_m", "energy of the hourglass force")                                 \
    LEDGER(contact, "J_per_m", "energy of the contact forces")                                    \
    LEDGER(dissipated, "J_per_m", "energy at the start plus external work, minus all of the above") \
    LEDGER(momentum_x, "Ns_per_m", "momentum of fluid and solid, x")                              \
    LEDGER(momentum_y, "Ns_per_m", "momentum of fluid and solid, y")                              \
    LEDGER(mass, "kg_per_m", "mass of fluid and solid")                                           \
    LEDGER(dens_extreme, "1", "current largest |rho/rho0 - 1| of the fluid")                      \
    LEDGER(det_low, "1", "current smallest det F")                                                \
    LEDGER(dt, "s", "last time step")
/* clang-format on */

/* Present energy, momentum and extremes; calls simulation_refresh. */
struct ledger simulation_ledger(struct simulation *sim);

#endif
