/* SPDX-License-Identifier: MIT */
#include "check/check.h"

#include "case/params.h"

#include <stdarg.h>
#include <stdio.h>

void warn_section(const struct check *check, const struct scene_section_common *section,
                  const char *key, const char *format, ...)
{
    char text[sizeof check->diag->text], title[TITLE_TEXT];
    int line = section->line;
    if (key)
        line = scene_line(check->scene, (enum section_id)section->section, section->index, key);
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    warn_at(check->diag, check->scene, line, "%s %s", section_title(section, title), text);
}

enum err check_scene(struct scene *scene, struct diag *d)
{
    struct check check = {.scene = scene, .diag = d, .shapes = {.scene = scene, .diag = d}};
    warn_of_values(&check);
    enum err e = geometry_draw(&check.shapes);
    if (!e) e = list_points(&check);
    if (!e) e = refuse_beams(&check);
    if (!e) e = warn_of_shapes(&check);
    if (!e) e = warn_of_fluid(&check);
    if (!e) e = warn_of_solids(&check);
    arena_free(&check.shapes.temp);
    return e;
}
