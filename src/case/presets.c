/* SPDX-License-Identifier: MIT
 * Defaults that follow from `scheme` and `accuracy`. */
#include "case/case.h"

enum { ANY = -1 };

/* Before the case's gravity is read. */
static enum scene_kind kind_of_scene(const struct reader *r)
{
    const struct scene *const scene = r->scene;
    const struct entry *const e = case_entry(r, 0, "gravity");
    const bool heavy = e && e->value[strspn(e->value, "0., ")];
    if (!scene->n_fluid) return SCENE_SOLID;
    if (scene->n_solid) return SCENE_COUPLED;
    return scene->n_inflow && !heavy ? SCENE_STREAM : SCENE_FLUID;
}

enum {
    SOLID = 1u << SCENE_SOLID,
    FLUID = 1u << SCENE_FLUID,
    STREAM = 1u << SCENE_STREAM,
    COUPLED = 1u << SCENE_COUPLED,
    WET = FLUID | STREAM | COUPLED
};

/* A value in place of a default. A key of the case wins; where both set one, `accuracy` does. */
static const struct preset {
    bool of_scheme; /* chosen by `scheme`, not by `accuracy` */
    unsigned kinds; /* of scenes: bits by enum scene_kind */
    int choice;
    int integrator; /* that the case uses; ANY: whichever */
    enum section_id section;
    const char *key;
    double value;
} presets[] = {
    /* scheme: `paper` has no rows. See docs/notes/2026-11-23-fluid-scheme.md. */
    {true, FLUID, SCHEME_STANDARD, ANY, SECTION_numerics, "h_over_dp", 2},
    {true, STREAM, SCHEME_STANDARD, ANY, SECTION_numerics, "h_over_dp", 1.35},
    {true, COUPLED, SCHEME_STANDARD, ANY, SECTION_numerics, "h_over_dp", 1.5},
    {true, COUPLED, SCHEME_STANDARD, ANY, SECTION_numerics, "solid_h_over_dp", 1.35},
    {true, WET, SCHEME_STANDARD, ANY, SECTION_fluid, "density_diffusion", 0.1},
    {true, WET, SCHEME_STANDARD, ANY, SECTION_fluid, "diffusion_form", DIFFUSION_ANTUONO},
    {true, WET, SCHEME_STANDARD, ANY, SECTION_fluid, "diffusion_limiter", LIMITER_STRAIN},
    {true, FLUID | STREAM, SCHEME_STANDARD, ANY, SECTION_fluid, "acoustic_damper", 4},
    {true, WET, SCHEME_STANDARD, ANY, SECTION_fluid, "particle_mass", MASS_HYDROSTATIC},
    {true, WET, SCHEME_STANDARD, ANY, SECTION_fluid, "wall_repulsion", 0.3},
    {true, WET, SCHEME_STANDARD, ANY, SECTION_fluid, "wall_damping", 1},
    {true, SOLID, SCHEME_STANDARD, ANY, SECTION_solid, "law", LAW_NEO_HOOKEAN},
    {true, COUPLED, SCHEME_STANDARD, ANY, SECTION_solid, "law", LAW_NEO_HOOKEAN},
    /* accuracy: `standard` has no rows. With fluid no setting of the study was reliably more
     * accurate: there `fine` means a smaller dp. What each row buys: src/app/data/evidence.csv,
     * measured by the study of tools/report/accuracy.toml, where [preset] names the points that
     * stand for these rows. */
    {false, FLUID | STREAM, ACCURACY_DRAFT, INTEGRATOR_LEAPFROG, SECTION_numerics, "cfl", 0.5},
    {false, COUPLED, ACCURACY_DRAFT, ANY, SECTION_numerics, "sound_factor", 5},
    {false, SOLID, ACCURACY_FINE, ANY, SECTION_numerics, "h_over_dp", 1.8},
};

bool scheme_sets(enum scheme scheme, enum scene_kind kind, enum section_id section, const char *key,
                 double *value)
{
    for (size_t k = 0; k < COUNT_OF(presets); k++) {
        const struct preset *const row = &presets[k];
        if (!row->of_scheme || row->choice != (int)scheme || row->section != section) continue;
        if (!(row->kinds & 1u << kind) || strcmp(row->key, key) != 0) continue;
        *value = row->value;
        return true;
    }
    return false;
}

bool scene_scheme_sets(const struct scene *scene, enum section_id section, const char *key,
                       double *value)
{
    return scheme_sets((enum scheme)scene->top.scheme, scene->kind, section, key, value);
}

/* The value of a choice at the top of the file before it is read, which reports an invalid word. */
static int top_choice(const struct reader *r, const char *key)
{
    const struct param *const param = param_find(SECTION_top, key);
    int found = (int)param->number.value;
    for (int k = 0; k < r->n_entries; k++) {
        const struct entry *const e = &r->entries[k];
        const bool its = r->sections[e->section].id == SECTION_top && strcmp(e->key, key) == 0;
        for (int c = 0; its && *param_choice(param, c).text; c++)
            if (strcmp(e->value, param_choice(param, c).text) == 0) found = c;
    }
    return found;
}

void case_apply_presets(struct reader *r)
{
    const int accuracy = top_choice(r, "accuracy"), integrator = top_choice(r, "integrator"),
              scheme = top_choice(r, "scheme");
    r->scene->kind = kind_of_scene(r);
    for (size_t k = 0; k < COUNT_OF(presets); k++) {
        const struct preset *const row = &presets[k];
        if (!(row->kinds & 1u << r->scene->kind) ||
            row->choice != (row->of_scheme ? scheme : accuracy) ||
            (row->integrator != ANY && row->integrator != integrator))
            continue;
        for (int i = 0; i < section_count(r->scene, row->section); i++)
            param_set_number(param_find(row->section, row->key),
                             section_at(r->scene, row->section, i), row->value);
    }
}

/* Defaults that depend on the case. `cfl`: the largest step at which the integrator is accurate;
 * leapfrog is stable at twice the step of the article's (docs/performance.md). */
void case_apply_defaults(struct scene *scene)
{
    static const double cfl[] = {
        [INTEGRATOR_SYMPLECTIC] = 0.2, [INTEGRATOR_VERLET] = 0.2, [INTEGRATOR_LEAPFROG] = 0.4};
    struct scene_relax *const relax = &scene->relax;
    if (scene->numerics.cfl == 0) scene->numerics.cfl = cfl[scene->top.integrator];
    if (relax->common.line > 0 && !scene_given(scene, SECTION_relax, 0, "tolerance"))
        relax->tolerance = scene->n_fluid > 0 ? 0.02 : 0.001; /* water keeps slow currents */
}
