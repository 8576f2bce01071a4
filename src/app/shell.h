/* SPDX-License-Identifier: MIT
 * Words of a shell command. */
#ifndef SPHFSI_APP_SHELL_H
#define SPHFSI_APP_SHELL_H

#include "base/files.h"

enum { QUOTED_BYTES = 4 * PATH_BYTES };

/* A text as one word of a shell, quoted where necessary. */
void shell_quote(char out[QUOTED_BYTES], const char *text);

#endif
