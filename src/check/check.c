/* SPDX-License-Identifier: MIT */
#include "check/check.h"

enum err check_scene(struct scene *scene, struct diag *d)
{
    struct check c = {.scene = scene, .diag = d, .shapes = {.scene = scene, .diag = d}};
    warn_of_values(&c);
    enum err e = geometry_draw(&c.shapes);
    if (!e) e = list_points(&c);
    if (!e) e = warn_of_shapes(&c);
    if (!e) e = warn_of_fluid(&c);
    if (!e) e = warn_of_solids(&c);
    arena_free(&c.shapes.temp);
    return e;
}
