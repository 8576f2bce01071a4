/* SPDX-License-Identifier: MIT
 * Which changes of a case a restart or a fork accepts. */
#ifndef SPHFSI_APP_CASE_CHANGE_H
#define SPHFSI_APP_CASE_CHANGE_H

#include "base/base.h"

/* Compares two effective cases line by line: the checkpoint's, `old`, and the present one. A
 * restart may change end_time and output. A fork may also change physics, but not what the state
 * depends on: particles, masses, sound speed, kernel, integrator. ERR_INPUT names the first line
 * that must not differ. */
enum err change_for_restart(const char *old, const char *now, struct diag *d) SPHFSI_CHECKED;
enum err change_for_fork(const char *old, const char *now, struct diag *d) SPHFSI_CHECKED;

#endif
