/* SPDX-License-Identifier: MIT */
#include "geometry/load.h"

static enum err sampled(struct scene *scene, struct diag *d)
{
    const enum err err = scene_sample(scene, d);
    if (err) scene_free(scene);
    return err;
}

enum err scene_load(struct scene *scene, const char *path, int n_sets, const char *const *sets,
                    struct diag *d)
{
    TRY(scene_read(scene, path, n_sets, sets, d));
    return sampled(scene, d);
}

enum err scene_load_text(struct scene *scene, const char *text, const char *path, int n_sets,
                         const char *const *sets, struct diag *d)
{
    TRY(scene_parse(scene, text, path, n_sets, sets, d));
    return sampled(scene, d);
}
