/* SPDX-License-Identifier: MIT
 * What a checkpoint holds, for a reader of text. */
#ifndef SPHFSI_APP_INSPECT_H
#define SPHFSI_APP_INSPECT_H

#include "app/session.h"

/* Tells line by line, through the message callback. ERR_INPUT: the file is not a sound checkpoint. */
enum err inspect_file(const char *path, const struct sphfsi_options *o, struct diag *d)
    SPHFSI_CHECKED;

#endif
