/* SPDX-License-Identifier: MIT
 * Values of a case that are probably a mistake, whatever its shapes. */
#include "check/check.h"

#include <stdarg.h>

static void warn_of_fluid_keys(struct check *check, const struct scene_fluid *fluid)
{
    const struct scene *const scene = check->scene;
    const double least = 10 * max2(fluid->max_speed, sqrt(fluid->max_pressure / fluid->density));
    if (scene->c0 < least * (1 - 1e-9))
        warn_section(
            check, &fluid->common,
            "sound_speed = %g m/s is below the %g m/s of Eq. 3: the density will vary by more "
            "than 1 %%",
            scene->c0, least);
    if (!isnan(fluid->surface) && scene->top.gravity[1] == 0)
        warn_section(
            check, &fluid->common,
            "has a `surface`, but gravity has no vertical component at t = 0, so the initial "
            "pressure is zero");
    if (fluid != scene->fluid || fluid->shifting_speed != SHIFTING_LARGEST) return;
    if (fluid->shifting * scene->numerics.cfl > 5 * (1 + 1e-9))
        warn_section(check, &fluid->common,
                     "shifting = %g times numerics.cfl = %g is above 5, the stability limit of "
                     "shifting_speed = largest; reduce one of them",
                     fluid->shifting, scene->numerics.cfl);
}

/* L-6 gives the fluid at a surface the acceleration of the surface, also along it. */
static void warn_of_sliding(struct check *check)
{
    const struct scene *const scene = check->scene;
    if (scene->numerics.sides != SIDES_ONE || scene->n_fluid == 0) return;
    for (int k = 0; k < scene->n_solid + scene->n_wall; k++) {
        const struct body b = body_at(scene, k);
        if (b.slip != SLIP_FREE || (b.kind == KIND_WALL && !*b.motion)) continue;
        warn_at(check->diag, check->scene, key_line(scene, SECTION_numerics, 0, "sides"),
                "sides = one drags the fluid that slides along %s, as if the body were larger "
                "by a spacing all round: the added mass of a cylinder of 10 spacings is 40 %% too "
                "large; use sides = both, or slip = none",
                section_title(b.common).text);
    }
}

static void warn_of_motion_of_nothing(struct check *check, const struct scene_motion *motion)
{
    const struct scene *const scene = check->scene;
    bool named = false, moves = false;
    for (const struct param *key = param_table; key < param_table + PARAM_COUNT; key++) {
        const bool own = key->section == SECTION_motion && param_expr(key, motion, 0);
        moves |= own && !expr_is_number(param_expr(key, motion, 0));
        for (int k = 0; key->kind == SECTION_motion && k < section_count(scene, key->section);
             k++) {
            const char *const section = section_at(scene, key->section, k);
            named |= strcmp(section + key->offset, motion->common.name) == 0;
        }
    }
    if (!named)
        warn_section(check, &motion->common,
                     "moves nothing: name it by `motion` of a [wall] or [beam], by `clamp_motion` "
                     "of a [solid] or by `hinge_motion` of a [rigid]");
    else if (!moves)
        warn_section(check, &motion->common,
                     "moves nothing, unless a program sets it: x, y and turn are displacements as "
                     "expressions in t, for example y = 1.5 m/s*t");
}

/* A table in time that still changes at its last row, while the run goes on. */
static void warn_of_table(struct check *check, const struct param *key, int k, int component)
{
    const struct scene *const scene = check->scene;
    const void *const section = section_at(scene, key->section, k);
    const struct scene_motion *const motion = key->section == SECTION_motion ? section : NULL;
    const struct expr *const e = param_expr(key, section, component);
    const double last = e && key->scope & EXPR_IN_TIME ? expr_table_end(e, key->scope) : HUGE_VAL,
                 end = last + (motion ? motion->start : 0), until = scene->top.end_time;
    if (end >= (motion ? min2(until, motion->stop) : until) * (1 - 1e-9)) return;
    warn_at(check->diag, scene, key_line(scene, key->section, k, key->key),
            "%s%s%s = %.200s: its table ends at t = %.6g s, before end_time = %.6g s, and its last "
            "two rows differ: %s; continue the table, end it at rest, or use end_time = %.6g s",
            key->section ? section_title(section).text : "", key->section ? " " : "", key->key,
            expr_source(e), end, until,
            motion ? "the motion stops there within a step" : "the last value stays from there on",
            end);
}

void warn_of_speed(struct check *check, int line, double speed, const char *format, ...)
{
    struct scene *const scene = check->scene;
    char what[4 * SCENE_NAME];
    va_list list;
    va_start(list, format);
    vsnprintf(what, sizeof what, format, list);
    va_end(list);
    scene->given_speed = max2(scene->given_speed, speed);
    if (scene->n_fluid > 0 && speed > SPEED_WARNING * scene->c0)
        warn_at(check->diag, check->scene, line,
                "%s up to %.3g m/s, above %g of the fluid's speed of sound, %.3g m/s. The fluid is "
                "not weakly compressible then, and a guard may stop the run; check the units "
                "(angles are in radians), or use sound_speed = %.3g or more",
                what, speed, SPEED_WARNING, scene->c0, 10 * speed);
}

/* Where the guards would warn of the flow itself (time/guards.c), the user is warned before the
 * run: a pressure P changes the density by P/(rho0 c0^2) in Eq. 2. T-53 lets sound out up to a
 * wavelength of c0 absorb/4, and the mean flow follows within `absorb`. */
static void warn_of_open(struct check *check, const struct scene_open *open)
{
    const struct scene *const scene = check->scene;
    const double wave = scene->c0 * open->absorb / 4, reach = 2 * scene->h,
                 largest = scene_open_range(scene, open).largest,
                 stiffness = scene->rho0 * square(scene->c0);
    if (open->kind == OPEN_VELOCITY) {
        warn_of_speed(check, open->common->line, largest, "%s gives the fluid",
                      section_title(open->common).text);
        return;
    }
    if (largest > DENS_WARNING * stiffness)
        warn_section(
            check, open->common,
            "gives the fluid up to %.4g Pa, which changes its density by about %.2g %%; 1 %% "
            "is usual, and the run stops at 30 %%; use sound_speed = %.3g or more",
            largest, 100 * largest / stiffness, sqrt(largest / (0.01 * scene->rho0)));
    if (open->absorb > 0 && wave < reach)
        warn_at(
            check->diag, scene,
            key_line(scene, (enum section_id)open->common->section, open->common->index, "absorb"),
            "%s absorb = %g s lets only waves shorter than c0 absorb/4 = %.3g m pass, but "
            "the fluid resolves none shorter than 2 h = %.3g m. So sound is reflected; absorb = "
            "4 L/c0 lets waves up to the length L pass",
            section_title(open->common).text, open->absorb, wave, reach);
}

void warn_of_values(struct check *check)
{
    const struct scene *const scene = check->scene;
    for (int k = 0; k < scene->n_fluid; k++) warn_of_fluid_keys(check, &scene->fluid[k]);
    warn_of_sliding(check);
    for (int k = 0; k < scene->n_motion - scene->n_rigid; k++)
        warn_of_motion_of_nothing(check, &scene->motion[k]);
    for (const struct param *key = param_table; key < param_table + PARAM_COUNT; key++)
        for (int k = 0; k < section_count(scene, key->section); k++)
            for (int c = 0; c < key->count; c++) warn_of_table(check, key, k, c);
    for (int k = 0; k < scene_open_count(scene); k++) {
        const struct scene_open open = scene_open_at(scene, k);
        if (k == 0 && scene->fluid[0].density_diffusion == 0)
            warn_section(check, open.common,
                         "adjoins fluid without density_diffusion, so pressure noise grows at this "
                         "boundary; use density_diffusion = 0.1");
        warn_of_open(check, &open);
    }
}
