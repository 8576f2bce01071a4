/* SPDX-License-Identifier: MIT
 * The order of all checks of a scene. */
#include "check/check.h"

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
