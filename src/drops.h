/* SPDX-License-Identifier: MIT
 * Drops that the fluid does not resolve. */
#ifndef SPHFSI_DROPS_H
#define SPHFSI_DROPS_H

#include "simulation.h"

/* T-45: takes the tension from fluid that is far below its reference density and has next to nothing around.
 * After a step, when cells are good. */
void drops_let_go(struct simulation *s);

#endif
