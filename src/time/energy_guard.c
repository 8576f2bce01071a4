/* SPDX-License-Identifier: MIT
 * What is said of energy that a region has gained, and when the run stops (T-46). */
#include "time/energy.h"
#include "time/advance.h"

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

/* What has the most speed in a region: "[solid gate] at (0.1, 0.2) m", or the region's first
 * section where it has no particles. */
enum { PLACE = sizeof(struct section_title) + 64 };
static void write_fastest(const struct simulation *sim, int region, char text[PLACE])
{
    static const enum section_id id[KIND_COUNT] = {SECTION_fluid, SECTION_wall, SECTION_solid};
    double top = -1, x = 0, y = 0;
    int fastest = region;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const struct particles *const particles = &sim->kind[kind];
        for (int64_t i = 0; i < particles->n; i++) {
            const double speed2 = square(particles->vx[i]) + square(particles->vy[i]);
            const int own = energy_entry((enum kind)kind, particles->body[i]);
            if (!(speed2 > top) || sim->state.energy.entry[own].region != region) continue;
            top = speed2;
            fastest = own;
            x = particles->x[i];
            y = particles->y[i];
        }
    }
    const void *const section =
        section_at(sim->scene, id[fastest / SCENE_MAX_SECTIONS], fastest % SCENE_MAX_SECTIONS);
    const int used = snprintf(text, PLACE, "%s", section_title(section).text);
    if (top >= 0) snprintf(text + used, PLACE - (size_t)used, " at (%.4g, %.4g) m", x, y);
}

enum err energy_guard(struct simulation *sim, struct diag *d)
{
    const struct energy_gain g = sim->gain;
    const double time = sim->state.time;
    char place[PLACE], text[600], remedy[REMEDY];
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
    write_fastest(sim, g.entry, place);
    snprintf(text, sizeof text,
             "%s: the run has gained %.3g J/m of energy that nothing supplied (available: %.3g "
             "J/m), in %s; fastest: %s",
             time_text(sim).text, g.energy, g.available, sources[g.term], place);
    write_remedy(sim, g.term, remedy);
    /* A gain at the interface may be less than what the rest loses. */
    if ((g.term == TERM_INTERFACE ? g.all : share) > GAIN_LIMIT)
        return diag_fail(d, ERR_GUARD, "%s. The run is unstable; %s may help", text, remedy);
    if (!sim->guard.warned_energy)
        diag_warn(d, "%s. The results may be invalid; %s may help", text, remedy);
    sim->guard.warned_energy = true;
    return ERR_OK;
}
