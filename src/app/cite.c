/* SPDX-License-Identifier: MIT
 * The publications of the methods that a scene uses. */
#include "case/effects.h"
#include "app/manual.h"

enum citation {
#define CITATION(key, text) CITATION_##key,
#include "app/citations.def"
    CITATION_COUNT
};

static const char *const texts[CITATION_COUNT] = {
#define CITATION(key, text) text,
#include "app/citations.def"
};

static bool any_law(const struct scene *s, int law)
{
    bool any = false;
    for (int k = 0; k < s->n_solid; k++) any |= s->solid[k].law == law;
    return any;
}

/* Whether some probe interpolates in a solid. */
static bool probes_material(const struct scene *s)
{
    bool any = false;
    for (int k = 0; k < s->n_probe; k++)
        any |= scene_probe_target(&s->probe[k]) == TARGET_SOLID_POINT;
    return any;
}

void manual_cite(const struct scene *s, effect_set fx, const struct sphfsi_options *o)
{
    bool used[CITATION_COUNT] = {false};
#define CITE(condition, key) used[CITATION_##key] |= (condition) != 0;
#include "app/citations.def"
    for (int k = 0; k < CITATION_COUNT; k++)
        if (used[k]) session_say(o, "%s", texts[k]);
    if (s->top.source[0]) session_say(o, "The scene: %s", s->top.source);
}
