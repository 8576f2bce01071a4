/* SPDX-License-Identifier: MIT
 * The publications of the methods that a scene uses: src/app/data/citations.txt. */
#include "app/embedded.h"
#include "app/actions.h"
#include "case/effects.h"

#include <stdio.h>

static bool any_law(const struct scene *scene, int law)
{
    bool any = false;
    for (int k = 0; k < scene->n_solid; k++) any |= scene->solid[k].law == law;
    return any;
}

/* Whether some probe interpolates in a solid. */
static bool probes_material(const struct scene *scene)
{
    bool any = false;
    for (int k = 0; k < scene->n_probe; k++)
        any |= scene_probe_target(&scene->probe[k]) == TARGET_SOLID_POINT;
    return any;
}

/* Prints the source of a key, which is on a line of its own behind it. */
static void say_source(const char *key, const struct sphfsi_options *o)
{
    const size_t length = strlen(key);
    const char *line = embedded_text("src/app/data/citations.txt");
    while (strncmp(line, key, length) != 0 || line[length] != ':') line += strcspn(line, "\n") + 1;
    line += length + 2;
    session_say(o, "%.*s", (int)strcspn(line, "\n"), line);
}

void manual_cite(const struct scene *scene, effect_set fx, const struct sphfsi_options *o)
{
    const bool contact = fx & (FX_CONTACT | FX_CONTACT_WALL);
    const int shifting = fx & FX_SHIFTING ? scene->fluid[0].shifting_speed : -1;
    const struct {
        const char *key;
        bool used;
    } source[] = {
        {"paper", true},
        {"wendland", true},
        {"monaghan_1994", fx & FX_FLUID},
        {"monaghan_gingold", fx & FX_VISCOSITY},
        {"molteni", fx & FX_DIFFUSION},
        {"fourtakas", fx & FX_FOURTAKAS},
        {"fourtakas_2025", fx & FX_DAMPER},
        {"zhang_2017", fx & FX_WALL_DAMPING},
        {"adami", fx & (FX_WALL | FX_MOTION | FX_COUPLING | FX_NO_SLIP)},
        {"bonet", fx & FX_SOLID},
        {"ganzenmueller", fx & FX_HOURGLASS},
        {"belytschko", fx & FX_SOLID},
        {"oconnor", fx & FX_SOLID_VISCOSITY},
        {"bonet_wood", any_law(scene, LAW_SVK) || any_law(scene, LAW_NEO_HOOKEAN)},
        {"dualsphysics", scene->top.integrator == INTEGRATOR_SYMPLECTIC},
        {"morris", fx & FX_LAMINAR},
        {"durran", fx & FX_LEAPFROG},
        {"verlet", scene->top.integrator == INTEGRATOR_VERLET},
        {"lancaster", probes_material(scene)},
        {"skillen", shifting == SHIFTING_OWN},
        {"sun", shifting == SHIFTING_LARGEST},
        {"antuono", fx & (FX_ANTUONO | FX_MASSES)},
        {"meringolo", fx & FX_LIMITER},
        {"zhang_2021", fx & FX_ONE_SIDED},
        {"monaghan_2000", fx & FX_TENSILE},
        {"banks", fx & FX_IMPEDANCE},
        {"colagrossi", scene->packed},
        {"lind", scene->packed || fx & FX_SHIFTING},
        {"zhang", fx & FX_KELVIN_VOIGT},
        {"cundall", contact},
        {"edelsbrunner", contact},
        {"li_2020", contact},
        {"barnes", fx & FX_RELAX},
        {"rayleigh", fx & FX_MASS_DAMPING},
    };
    for (size_t k = 0; k < COUNT_OF(source); k++)
        if (source[k].used) say_source(source[k].key, o);
    if (scene->top.source[0]) session_say(o, "The scene: %s", scene->top.source);
}
