/* SPDX-License-Identifier: MIT
 * Text files that the program carries: cases/templates and src/app/data, put into C by
 * tools/embed.sh. */
#pragma once

#include "base/base.h"

struct embedded_file {
    const char *name; /* from the top of the sources */
    const char *stem; /* without folder and ending */
    const char *text;
};
extern const struct embedded_file embedded_files[]; /* the last one has no name */

/* The text of a file that is one of them. */
SPHFSI_INLINE const char *embedded_text(const char *name)
{
    const struct embedded_file *file = embedded_files;
    while (strcmp(file->name, name) != 0) file++;
    return file->text;
}
