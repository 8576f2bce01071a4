/* SPDX-License-Identifier: MIT
 * What a run says at its end: cost, losses, energy, differences from references; and how a stopped
 * one goes on. */
#ifndef SPHFSI_APP_CLOSING_H
#define SPHFSI_APP_CLOSING_H

#include "app/session.h"
#include "output/report.h"

void closing_say(const struct sphfsi_options *o, const struct simulation *s,
                 const struct record *r);

/* Prints how a stopped run continues: after a guard from the checkpoint with steps half as long, or, where
 * these would stop it again, what it takes once the case is changed; else a restart. */
void closing_say_next(const struct sphfsi_options *o, const struct simulation *s,
                      const char *checkpoint, bool guard);

#endif
