/* SPDX-License-Identifier: MIT
 * Guards: limits beyond which a state is not sound. */
#ifndef SPHFSI_MONITOR_H
#define SPHFSI_MONITOR_H

#include "base.h"

/* The solid's deformation is looked at every so many steps of the fluid: it takes a pass of its own. At a
 * tenth of the speed of sound neighbours close in by a third of their distance in that time. */
enum { LOOK_INTERVAL = 16 };

struct guard {
    double dens_limit;  /* |rho/rho0 - 1| */
    double speed_limit; /* m/s: at the speed of sound nothing is weakly compressible */
    double step_limit;  /* s: a step below this has collapsed */
    bool warned_speed, warned_energy;
};

struct simulation;
struct ledger;

/* Warns once where a ledger shows that energy has come from nowhere. */
void monitor_energy(struct simulation *s, const struct ledger *row, struct diag *d);

/* Checks the state after a step. ERR_GUARD with a sentence that names particle, place, time, quantity
 * and likely cause; warns once where trouble is near. */
enum err monitor_check(struct simulation *s, struct diag *d) SPHFSI_CHECKED;

#endif
