/* SPDX-License-Identifier: MIT
 * What is said of energy that a region has gained, and when the run stops (T-46). */
#include "time/energy.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "case/params.h"
#include "time/timestep.h"

/* Fraction of its available energy that a region may gain without a warning; the time for which a
 * gain below a tenth lasts before it counts, s: while a run starts, little energy is available. */
#define GAIN_WARNING 0.01
#define GAIN_COUNTS_NOW 0.1
#define GAIN_LASTS 2.5e-3
/* An oscillation at the default solid_safety shows up to 1/(1 - 0.9^2) = 5.3 times its energy
 * and is stable; four fifths of what it shows count as gain. An unstable run exceeds any such
 * fraction. */
#define GAIN_LIMIT 0.9

static const char *const sources[] = {
    [TERM_FLUID] = "the fluid or at its boundaries",
    [TERM_INTERFACE] = "the exchange between fluid and structure",
    [TERM_SOLID] = "the solid's stress or time integration",
};

/* What may help. The work of dummies does not depend on the step: fluid that is resolved better
 * makes it less. */
enum { REMEDY = 256 };
static void write_remedy(const struct simulation *sim, enum energy_term term, char text[REMEDY])
{
    double half;
    const struct scene_numerics *const n = &sim->scene->numerics;
    const char *const key = timestep_shorter(sim, &half);
    const bool fluid = term == TERM_FLUID,
               substeps = sim->effects & FX_COUPLING && sim->effects & FX_MULTIRATE &&
                          !(n->fixed_step > 0),
               /* between bodies that meet the layer of fluid may be too thin */
        gap = fluid && sim->effects & FX_CONTACT && sim->contact.near,
               /* without weight nothing holds fluid at a wall that moves back */
        suction = fluid && !(sim->effects & FX_GRAVITY) && n->suction == SUCTION_OFF;
    bool paper = false; /* its law has no potential, and gains energy at any step */
    for (int k = 0; k < sim->scene->n_solid; k++) paper |= sim->scene->solid[k].law == LAW_PAPER;
    snprintf(text, REMEDY, "%snumerics.%s = %.3g%s%s%s%s", fluid ? "a smaller dp or " : "", key,
             half, gap ? " or a larger gap in [contact]" : "",
             suction ? " or numerics.suction = on" : "",
             substeps ? " or numerics.multirate = off" : "",
             term == TERM_SOLID && paper ? " or law = neo_hookean or svk" : "");
}

/* The names of a region's sections, "[fluid left], [solid plate]"; returns their number. */
enum { REGION_NAME = 160 };
static int write_region_name(const struct simulation *sim, int region, char text[REGION_NAME])
{
    static const enum section_id id[KIND_COUNT] = {SECTION_fluid, SECTION_wall, SECTION_solid};
    size_t used = 0;
    int names = 0;
    text[0] = '\0';
    for (int k = 0; k < ENERGY_ENTRIES && used < REGION_NAME; k++) {
        if (sim->state.energy.entry[k].region != region) continue;
        const struct scene_section_common *const common =
            section_at(sim->scene, id[k / SCENE_MAX_SECTIONS], k % SCENE_MAX_SECTIONS);
        used += (size_t)snprintf(text + used, REGION_NAME - used, "%s[%s %s]", used ? ", " : "",
                                 section_table[common->section].word, common->name);
        names++;
    }
    return names;
}

/* The fastest particle of a region; false if none moves. */
static bool find_fastest(const struct simulation *sim, int region, double at[2])
{
    double top = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const struct particles *const particles = &sim->kind[kind];
        for (int64_t i = 0; i < particles->n && kind != KIND_WALL; i++) {
            const double speed2 = square(particles->vx[i]) + square(particles->vy[i]);
            const int entry = energy_entry((enum kind)kind, particles->body[i]);
            if (!(speed2 > top) || sim->state.energy.entry[entry].region != region) continue;
            top = speed2;
            at[0] = particles->x[i];
            at[1] = particles->y[i];
        }
    }
    return top > 0;
}

static void write_gain(const struct simulation *sim, const struct energy_gain *g, char text[400])
{
    char name[REGION_NAME];
    double at[2] = {0, 0};
    const bool one = write_region_name(sim, g->entry, name) == 1;
    const int used = snprintf(text, 400,
                              "%s: %s %s gained %.3g J/m of energy that nothing supplied "
                              "(available: %.3g J/m), in %s",
                              time_text(sim).text, name, one ? "has" : "have", g->energy,
                              g->available, sources[g->term]);
    if (find_fastest(sim, g->entry, at) && used > 0 && used < 400)
        snprintf(text + used, 400 - (size_t)used, "; fastest at (%.4g, %.4g) m", at[0], at[1]);
}

enum err energy_guard(struct simulation *sim, struct diag *d)
{
    const struct energy_gain g = sim->gain;
    const double time = sim->state.time;
    char text[400], remedy[REMEDY];
    if (!sim->gain.found) return ERR_OK;
    sim->gain.found = false;
    const double share = g.share;
    if (share <= GAIN_WARNING) sim->state.gain_since = time;
    if (g.entry < 0) return ERR_OK;
    const bool lasts = time - sim->state.gain_since >= GAIN_LASTS;
    if (share > GAIN_WARNING && share < GAIN_COUNTS_NOW && !lasts) return ERR_OK;
    sim->state.gain = max2(sim->state.gain, g.energy);
    sim->state.gain_share = max2(sim->state.gain_share, share);
    if (share <= GAIN_WARNING) return ERR_OK;
    write_gain(sim, &g, text);
    write_remedy(sim, g.term, remedy);
    /* A gain at the interface may be less than what the rest loses. */
    if ((g.term == TERM_INTERFACE ? g.all : share) > GAIN_LIMIT)
        return diag_fail(d, ERR_GUARD, "%s. The run is unstable; %s may help", text, remedy);
    if (!sim->guard.warned_energy)
        diag_warn(d, "%s. The results may be invalid; %s may help", text, remedy);
    sim->guard.warned_energy = true;
    return ERR_OK;
}
