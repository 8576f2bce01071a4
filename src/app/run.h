/* SPDX-License-Identifier: MIT
 * A run from its case to its files: outputs, restart, requests, failures. */
#ifndef SPHFSI_APP_RUN_H
#define SPHFSI_APP_RUN_H

#include "base/files.h"
#include "app/session.h"

/* Implements sphfsi_run. */
enum err run_case(const struct sphfsi_options *o, struct diag *d) SPHFSI_CHECKED;

#endif
