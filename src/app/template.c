/* SPDX-License-Identifier: MIT
 * Templates of cases: the files of cases/templates. */
#include "app/embedded.h"
#include "app/manual.h"

static bool is_template(const struct embedded_file *file)
{
    static const char folder[] = "cases/templates/";
    return strncmp(file->name, folder, sizeof folder - 1) == 0;
}

const char *manual_template_name(int k)
{
    for (const struct embedded_file *file = embedded_files; file->name; file++)
        if (is_template(file) && k-- == 0) return file->stem;
    return NULL;
}

const char *manual_template(const char *name)
{
    for (const struct embedded_file *file = embedded_files; file->name; file++)
        if (is_template(file) && strcmp(file->stem, name) == 0) return file->text;
    return NULL;
}
