/* SPDX-License-Identifier: MIT
 * libFuzzer's entry to the function TARGET of tests/support/fuzz.h; `make fuzz` links it. */
#include "fuzz.h"

#include "case/scene.h"
#include "geometry/scene_points.h"

#include <math.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) { return TARGET(data, size); }

/* Linked in front of scene_sample (--wrap): a case of a billion particles is a slow one, not a
 * wrong one, so shapes that are more than a few dozen spacings wide are not sampled. */
enum err __real_scene_sample(struct scene *scene, struct diag *d);
enum err __wrap_scene_sample(struct scene *scene, struct diag *d);

static bool wide(const struct scene *scene, const struct shape_list *list)
{
    for (int k = 0; k < list->n; k++) {
        const struct shape *shape = &list->item[k];
        if (!(fabs(shape->size) < 40 * scene->top.dp) || shape->n > 64) return true;
        for (int i = 0; i < shape->n; i++)
            for (int c = 0; c < 2; c++)
                if (!(fabs(shape->pt[i][c] - shape->pt[0][c]) < 40 * scene->top.dp)) return true;
    }
    return list->n > 16;
}

enum err __wrap_scene_sample(struct scene *scene, struct diag *d)
{
    bool large = scene->n_fluid + scene->n_wall + scene->n_solid > 16;
    for (int k = 0; k < scene->n_fluid && !large; k++) large = wide(scene, &scene->fluid[k].shape);
    for (int k = 0; k < scene->n_wall && !large; k++) large = wide(scene, &scene->wall[k].shape);
    for (int k = 0; k < scene->n_solid && !large; k++) large = wide(scene, &scene->solid[k].shape);
    if (large) return diag_fail(d, ERR_INPUT, "too large for the fuzzer");
    return __real_scene_sample(scene, d);
}
