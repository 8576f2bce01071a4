/* SPDX-License-Identifier: MIT */
#include "geometry/load.h"

/* A case with wrong values is told of its geometry, too, as far as that does not depend on them. Warnings
 * may come from what is missing. */
static enum err refused(struct scene *s, enum scene_rest rest, enum err e, struct diag *d)
{
    if (rest == REST_NOTHING) return e;
    if (d) {
        void (*const warn)(void *, const char *) = d->warn;
        d->warn = NULL;
        scene_check_rest(s, rest, d);
        d->warn = warn;
    }
    scene_free(s);
    return e;
}

static enum err sampled(struct scene *s, struct diag *d)
{
    const enum err err = scene_sample(s, d);
    if (err) scene_free(s);
    return err;
}

enum err scene_load(struct scene *s, const char *path, int n_sets, const char *const *sets,
                    struct diag *d)
{
    enum scene_rest rest;
    const enum err e = scene_read(s, path, n_sets, sets, &rest, d);
    return e ? refused(s, rest, e, d) : sampled(s, d);
}

enum err scene_load_text(struct scene *s, const char *text, const char *path, int n_sets,
                         const char *const *sets, struct diag *d)
{
    enum scene_rest rest;
    const enum err e = scene_parse(s, text, path, n_sets, sets, &rest, d);
    return e ? refused(s, rest, e, d) : sampled(s, d);
}
