/* SPDX-License-Identifier: MIT */
#include "effects.h"

const struct effect_info effect_table[EFFECT_COUNT] = {
#define EFFECT(name, key, equation, groups, kind, meaning) \
    {#name, key, equation, meaning, groups, KIND_##kind},
#include "effects.def"
#undef EFFECT
};

static bool fluid_sticks(const struct scene *s)
{
    bool sticks = false;
    for (int k = 0; k < s->n_wall; k++) sticks |= s->wall[k].slip == SLIP_NONE;
    for (int k = 0; k < s->n_solid; k++) sticks |= s->solid[k].slip == SLIP_NONE;
    return sticks;
}

static unsigned fluid_effects(const struct scene *s)
{
    if (s->n_fluid == 0) return 0;
    unsigned fx = FX_FLUID;
    const struct scene_fluid *f = &s->fluid[0];
    if (f->artificial_viscosity > 0) fx |= FX_VISCOSITY;
    if (f->density_diffusion > 0) fx |= FX_DIFFUSION;
    if (f->density_diffusion > 0 && f->diffusion_form == DIFFUSION_FOURTAKAS) fx |= FX_FOURTAKAS;
    if (s->domain.periodic != PERIODIC_NONE) fx |= FX_PERIODIC;
    if (f->laminar_viscosity > 0) fx |= FX_LAMINAR;
    if (fluid_sticks(s)) fx |= FX_NO_SLIP;
    if (s->n_wall > 0) fx |= FX_WALL;
    for (int k = 0; k < s->n_wall; k++)
        if (s->wall[k].motion[0]) fx |= FX_MOTION;
    return fx;
}

static unsigned solid_effects(const struct scene *s)
{
    if (s->n_solid == 0) return 0;
    unsigned fx = FX_SOLID;
    for (int k = 0; k < s->n_solid; k++) {
        if (s->solid[k].hourglass > 0) fx |= FX_HOURGLASS;
        if (s->solid[k].artificial_viscosity > 0) fx |= FX_SOLID_VISCOSITY;
        if (s->solid[k].joined[0]) fx |= FX_JOINED;
    }
    return fx;
}

unsigned effects_of_scene(const struct scene *s)
{
    unsigned fx = fluid_effects(s) | solid_effects(s);
    if (s->top.gravity[0] != 0 || s->top.gravity[1] != 0) fx |= FX_GRAVITY;
    if ((fx & FX_FLUID) && (fx & FX_SOLID)) fx |= FX_COUPLING;
    return fx;
}

unsigned effects_groups(unsigned effects, enum kind kind, int integrator)
{
    unsigned groups = 0;
    for (int k = 0; k < EFFECT_COUNT; k++)
        if ((effects & (1u << k)) && effect_table[k].kind == kind) groups |= effect_table[k].groups;
    if (!groups) return 0;
    if (kind == KIND_FLUID && integrator == INTEGRATOR_VERLET) groups |= G_VERLET;
    if (kind == KIND_FLUID && integrator == INTEGRATOR_SYMPLECTIC)
        groups |= G_STAGE | G_STAGE_FLUID;
    if (kind == KIND_SOLID) groups |= G_STAGE;
    return groups;
}
