/* SPDX-License-Identifier: MIT
 * Drops that the fluid does not resolve. */
#ifndef SPHFSI_TIME_ISOLATED_H
#define SPHFSI_TIME_ISOLATED_H

#include "time/simulation.h"

/* T-45: takes the tension from fluid that is far below its reference density and has next to nothing around.
 * After a step, when cells are good. */
void limit_isolated_tension(struct simulation *s);

#endif
