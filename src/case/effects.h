/* SPDX-License-Identifier: MIT
 * The effects of a scene as a set of bits, from case/effects.def. */
#pragma once

#include "case/params.h"
#include "particles/particles.h"

enum effect {
#define EFFECT(name, ...) EFFECT_##name,
#include "case/effects.def"
    EFFECT_COUNT
};

/* A set of effects: bit EFFECT_x stands for x. */
typedef uint64_t effect_set;
_Static_assert(EFFECT_COUNT <= 64, "a set of effects has 64 bits");
#define EFFECT_BIT(effect) ((effect_set)1 << (effect))

/* -DSPHFSI_WITHOUT=OUT_LAMINAR+OUT_NO_SLIP excludes effects from the program: their bits become 0,
 * and the compiler removes their code. For tests/agree/test_absence.py. */
enum {
#define EFFECT(name, ...) OUT_##name = (uint64_t)1 << EFFECT_##name,
#include "case/effects.def"
};
#ifndef SPHFSI_WITHOUT
#define SPHFSI_WITHOUT 0
#endif

enum {
#define EFFECT(name, ...) FX_##name = (uint64_t)1 << EFFECT_##name & ~(uint64_t)(SPHFSI_WITHOUT),
#include "case/effects.def"
};

/* PAIR_x: FX_x of an effect that has a law in the pair sums by the column `pairs`. PAIR_EFFECTS:
 * all of them; SURFACE_EFFECTS: those of walls and structures. */
#define PAIR_NONE(name)
#define PAIR_WITH_FLUID(name) PAIR_##name = FX_##name,
#define PAIR_WITH_SURFACE(name) PAIR_##name = FX_##name,
enum { PAIRS_NONE, PAIRS_WITH_FLUID, PAIRS_WITH_SURFACE };
enum {
#define EFFECT(name, when, key, equation, groups, kind, pairs, ...) PAIR_##pairs(name)
#include "case/effects.def"
    SURFACE_EFFECTS = (uint64_t)0
#define EFFECT(name, when, key, equation, groups, kind, pairs, ...) \
    | (PAIRS_##pairs == PAIRS_WITH_SURFACE ? (uint64_t)FX_##name : 0)
#include "case/effects.def"
    ,
    PAIR_EFFECTS = (uint64_t)0
#define EFFECT(name, when, key, equation, groups, kind, pairs, ...) \
    | (PAIRS_##pairs != PAIRS_NONE ? (uint64_t)FX_##name : 0)
#include "case/effects.def"
};

/* The effects of a pair sum, a type of its own: FX_x cannot be tested in it, and PAIR_HAS(set, x)
 * does not compile unless the column `pairs` has x. So PAIR_EFFECTS masks no law. That no bit is
 * without a law is tested in tests/agree/test_kernels.c. */
struct pair_set {
    effect_set bits;
};
#define PAIR_HAS(set, name) (((set).bits & PAIR_##name) != 0)

/* Open boundaries of either kind. */
#define FX_OPEN (FX_INFLOW | FX_OUTFLOW)

/* One row of case/effects.def as data. */
struct effect_info {
    const char *name, *key, *equation, *meaning;
    unsigned groups;
    enum kind kind;
};
extern const struct effect_info effect_table[EFFECT_COUNT];

/* Where the scene activates an effect. */
struct effect_source {
    enum section_id section;
    int index;
    const char *key; /* "": the section itself */
};

/* Whether the scene activates an effect, and where it does first. */
bool effect_enabled(const struct scene *scene, enum effect effect, struct effect_source *source);

/* "line 12: [wall bed] slip", or "--set: ...". */
struct source_text {
    char text[300];
};
struct source_text effect_source_text(const struct scene *scene,
                                      const struct effect_source *source);

/* The effects of a scene. The simulation, which has the bounds, decides on MULTIRATE. */
effect_set effects_of_scene(const struct scene *scene);

#define FX_ALWAYS (~(effect_set)0)

/* The timed parts of a step, in order: PHASE(name, when, meaning). */
/* clang-format off */
#define PHASES(PHASE)                                                            \
    PHASE(sort, FX_FLUID, "sorting particles into cells")                        \
    PHASE(open, FX_OPEN, "buffers of open boundaries")                           \
    PHASE(packed, FX_FLUID, "equation of state and packed copies of the fields") \
    PHASE(slope, FX_ANTUONO, "gradients of the density")                         \
    PHASE(wall, FX_WALL | FX_COUPLING,                                           \
          "pressure and velocity of walls and structures for the fluid, "        \
          "and its force on them")                                               \
    PHASE(fluid, FX_FLUID, "forces on fluid particles")                          \
    PHASE(shift, FX_SHIFTING, "particle shifting")                               \
    PHASE(solid, FX_SOLID, "deformation, stress and forces of the solid")        \
    PHASE(contact, FX_CONTACT, "search for contact and contact forces")          \
    PHASE(update, FX_ALWAYS, "time integration, bounds, guards")                 \
    PHASE(output, FX_ALWAYS, "probes, ledger, snapshots, checkpoints")
/* clang-format on */
enum phase {
#define PHASE(name, ...) PHASE_##name,
    PHASES(PHASE)
#undef PHASE
        PHASE_COUNT
};
struct phase_info {
    const char *name, *meaning;
    effect_set when; /* runs if any of these effects is on */
};
extern const struct phase_info phase_table[PHASE_COUNT];
SPHFSI_INLINE bool phase_runs(enum phase phase, effect_set effects)
{
    return phase_table[phase].when == FX_ALWAYS || phase_table[phase].when & effects;
}

/* Field groups that the set needs for particles of one kind. */
unsigned effects_groups(effect_set effects, enum kind kind);
