/* SPDX-License-Identifier: MIT
 * What makes a run slow that the case could do without. */
#ifndef SPHFSI_APP_SLOW_H
#define SPHFSI_APP_SLOW_H

#include "app/session.h"

/* Warns, with the line, of output intervals below the time step, of a damping_time that shortens the
 * solid's step, and of a bound a tenth of the acoustic one. After the first step, which finds the bounds. */
void slow_warn(const struct simulation *s, struct diag *d);

#endif
