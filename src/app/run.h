/* SPDX-License-Identifier: MIT
 * A run from its case to its files: outputs, restart, requests, failures. */
#ifndef SPHFSI_APP_RUN_H
#define SPHFSI_APP_RUN_H

#include "base/files.h"
#include "app/session.h"

/* Implements sphfsi_run. */
enum err run_case(const struct sphfsi_options *o, struct diag *d) SPHFSI_CHECKED;

/* The folder of a run: from the options, or named after the case. */
enum err run_dir_of_case(const struct sphfsi_options *o, char path[PATH_BYTES], struct diag *d)
    SPHFSI_CHECKED;

#endif
