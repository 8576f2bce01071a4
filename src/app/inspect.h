/* SPDX-License-Identifier: MIT
 * The contents of a checkpoint as text. */
#ifndef SPHFSI_APP_INSPECT_H
#define SPHFSI_APP_INSPECT_H

#include "app/session.h"

/* Prints those of a file, or of the newest valid checkpoint in the folder of a run, line by line through the
 * message callback. ERR_INPUT: there is no valid checkpoint. */
enum err inspect_file(const char *path, const struct sphfsi_options *o, struct diag *d)
    SPHFSI_CHECKED;

#endif
