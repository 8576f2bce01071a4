/* SPDX-License-Identifier: MIT */
#include "geometry/load.h"

static enum err sampled(struct scene *s, struct diag *d)
{
    const enum err err = scene_sample(s, d);
    if (err) scene_free(s);
    return err;
}

enum err scene_load(struct scene *s, const char *path, int n_sets, const char *const *sets,
                    struct diag *d)
{
    TRY(scene_read(s, path, n_sets, sets, d));
    return sampled(s, d);
}

enum err scene_load_text(struct scene *s, const char *text, const char *path, int n_sets,
                         const char *const *sets, struct diag *d)
{
    TRY(scene_parse(s, text, path, n_sets, sets, d));
    return sampled(s, d);
}
