/* SPDX-License-Identifier: MIT
 * What may change between the case of a checkpoint and the one that goes on from it. */
#ifndef SPHFSI_APP_CASE_CHANGE_H
#define SPHFSI_APP_CASE_CHANGE_H

#include "base/base.h"

/* Compares two effective cases, line by line. A restart may change the end, the output and the
 * threads. A fork may change all but what the state is made of: its particles, masses and the
 * integrator's memory. ERR_INPUT names the first line that may not differ. */
enum err change_for_restart(const char *then, const char *now, struct diag *d) SPHFSI_CHECKED;
enum err change_for_fork(const char *then, const char *now, struct diag *d) SPHFSI_CHECKED;

#endif
