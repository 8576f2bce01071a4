/* SPDX-License-Identifier: MIT
 * The effects of a scene as a set of bits, from effects.def. */
#ifndef SPHFSI_EFFECTS_H
#define SPHFSI_EFFECTS_H

#include "particles.h"
#include "scene.h"

enum effect {
#define EFFECT(name, key, equation, groups, kind, meaning) EFFECT_##name,
#include "effects.def"
#undef EFFECT
    EFFECT_COUNT
};

enum {
#define EFFECT(name, key, equation, groups, kind, meaning) FX_##name = 1 << EFFECT_##name,
#include "effects.def"
#undef EFFECT
};

/* One row of effects.def as data. */
struct effect_info {
    const char *name, *key, *equation, *meaning;
    unsigned groups;
    enum kind kind;
};
extern const struct effect_info effect_table[EFFECT_COUNT];

/* The set that a scene calls for. MULTIRATE is decided by the simulation, which knows the bounds. */
unsigned effects_of_scene(const struct scene *s);

/* Field groups that the set needs for particles of one kind with the scene's integrator. */
unsigned effects_groups(unsigned effects, enum kind kind, int integrator);

#endif
