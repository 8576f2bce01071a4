/* SPDX-License-Identifier: MIT
 * The expected error of a case, from what the accuracy study measured:
 * src/app/data/evidence.csv, which `make accuracy` writes. */
#include "app/actions.h"
#include "app/embedded.h"
#include "base/csv.h"
#include "case/params.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum evidence_column { SCENE, ACCURACY, CASE, ERROR, RESOLUTION, WHAT, PERCENT };

/* Least and largest error of the study's cases of a kind. Each counts at its finest resolution that
 * is no finer than n; `coarser`: n is less than all resolutions of a case. */
struct band {
    double low, high;
    bool coarser;
};

static struct band band_of(enum scene_kind kind, const char *accuracy, double n)
{
    const char first = kind == SCENE_SOLID ? 's' : kind == SCENE_FLUID ? 'f' : 'c';
    struct band band = {.low = (double)INFINITY};
    const char *before = "", *name, *line = embedded_text("src/app/data/evidence.csv");
    double best = (double)NAN;
    size_t length;
    for (; *line; line = csv_next_line(line)) {
        name = csv_field(line, ACCURACY, &length);
        if (*line != first || strlen(accuracy) != length || strncmp(name, accuracy, length) != 0)
            continue;
        const double resolution = strtod(csv_field(line, RESOLUTION, &length), NULL);
        name = csv_field(line, CASE, &length);
        if (strncmp(name, before, length + 1) != 0) { /* a case's rows are by resolution */
            band.low = fmin(band.low, best), band.high = fmax(band.high, best);
            band.coarser |= resolution > n;
            best = (double)NAN;
            before = name;
        }
        if (resolution <= n || isnan(best)) best = strtod(csv_field(line, PERCENT, &length), NULL);
    }
    band.low = fmin(band.low, best), band.high = fmax(band.high, best);
    return band;
}

/* Particles across the thinner side of a body, or over the height of the fluid. */
static double particles_across(const struct scene *scene, enum kind kind, int body)
{
    const struct scene_points *const p = &scene->points[kind];
    const struct scene_lattice *const l =
        kind == KIND_SOLID ? &scene->solid_lattice[body] : &scene->lattice;
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, at[2], n[2];
    for (int64_t i = 0; i < p->n; i++) {
        if (p->body[i] != body) continue;
        lattice_place(l, p->x[i], p->y[i], at);
        for (int c = 0; c < 2; c++) low[c] = min2(low[c], at[c]), high[c] = max2(high[c], at[c]);
    }
    for (int c = 0; c < 2; c++) n[c] = floor((high[c] - low[c]) / l->spacing[c] + 1.5);
    return kind == KIND_SOLID ? min2(n[0], n[1]) : n[1];
}

static void say_error(const struct scene *scene, enum kind kind, int body, const char *accuracy,
                      const struct sphfsi_options *o)
{
    const bool fluid = kind == KIND_FLUID;
    const enum scene_kind like = fluid ? SCENE_FLUID : scene->n_fluid ? SCENE_COUPLED : SCENE_SOLID;
    const double n = particles_across(scene, kind, body);
    const struct band band = band_of(like, accuracy, n);
    const char *const name =
        fluid ? scene->fluid[body].common.name : scene->solid[body].common.name;
    const bool moves = !fluid && scene->solid[body].clamp.n == 0 && !scene_is_bonded(scene, body);
    char low[32] = "";
    if (band.low < 0.9 * band.high) snprintf(low, sizeof low, "%.2g %% to ", band.low);
    if (moves || !isfinite(band.low))
        session_say(
            o,
            "  %s: %.0f particles across; error unknown, because docs/results/accuracy.md has no "
            "case of this kind",
            name, n);
    else if (band.coarser)
        session_say(o,
                    "  %s: %.0f particles across, fewer than in all cases of this kind in "
                    "docs/results/accuracy.md, so the error is not known; use a finer dp",
                    name, n);
    else
        session_say(o,
                    "  %s: %.0f particles %s about %s%.2g %% (cases of this kind, "
                    "docs/results/accuracy.md)",
                    name, n,
                    fluid ? "over its height: error of" : "across: error of the tip displacement",
                    low, band.high);
}

void evidence_say(const struct scene *scene, const struct sphfsi_options *o)
{
    /* The study runs the paper's scheme at accuracy = standard only. */
    const bool paper = scene->n_fluid && scene->top.scheme == SCHEME_PAPER;
    char accuracy[SCENE_NAME] = "paper";
    if (paper) {
        session_say(o, "expected error with scheme = paper, at accuracy = standard");
    } else {
        param_choice_name(param_find(SECTION_top, "accuracy"), scene->top.accuracy, accuracy);
        session_say(o, "expected error at accuracy = %s", accuracy);
    }
    for (int k = 0; k < scene->n_solid; k++) say_error(scene, KIND_SOLID, k, accuracy, o);
    for (int k = 0; k < scene->n_fluid && scene->n_solid == 0; k++)
        say_error(scene, KIND_FLUID, k, accuracy, o);
}
