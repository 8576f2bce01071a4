/* SPDX-License-Identifier: MIT
 * The expected error of a case, from what the accuracy study measured. */
#include "app/evidence.h"

#include "app/embedded.h"
#include "base/csv.h"
#include "case/params.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void read_field(const char *line, int k, char field[EVIDENCE_TEXT])
{
    size_t length = 0;
    const char *const start = csv_field(line, k, &length);
    snprintf(field, EVIDENCE_TEXT, "%.*s", (int)length, start ? start : "");
}

const char *evidence_first(void)
{
    const char *text = embedded_text("src/app/data/evidence.csv");
    while (*text == '#') text = csv_next_line(text);
    return csv_next_line(text); /* behind the names of the columns */
}

bool evidence_next(const char **rest, struct evidence *row)
{
    char field[EVIDENCE_TEXT];
    if (!**rest) return false;
    read_field(*rest, 0, field);
    row->kind = field[0] == 's' ? SCENE_SOLID : field[0] == 'f' ? SCENE_FLUID : SCENE_COUPLED;
    read_field(*rest, 1, row->accuracy);
    read_field(*rest, 2, row->name);
    read_field(*rest, 3, row->error);
    read_field(*rest, 4, field);
    row->resolution = strtod(field, NULL);
    read_field(*rest, 5, row->what);
    read_field(*rest, 6, field);
    row->percent = strtod(field, NULL);
    *rest = csv_next_line(*rest);
    return true;
}

/* Least and largest error of the study's cases of a kind, each at its finest resolution that is no
 * finer than n; `coarser`: than all of a case. */
struct band {
    double low, high;
    bool coarser;
};

static struct band band_of(enum scene_kind kind, const char *accuracy, double n)
{
    struct band band = {.low = (double)INFINITY};
    char before[EVIDENCE_TEXT] = "";
    double best = -1;
    struct evidence row;
    for (const char *rest = evidence_first(); evidence_next(&rest, &row);) {
        if (row.kind != kind || strcmp(row.accuracy, accuracy) != 0) continue;
        if (strcmp(before, row.name) != 0) {
            if (best >= 0) band.low = min2(band.low, best), band.high = max2(band.high, best);
            snprintf(before, sizeof before, "%s", row.name);
            best = -1;
            band.coarser |= row.resolution > n;
        }
        if (row.resolution <= n || best < 0) best = row.percent;
    }
    if (best >= 0) band.low = min2(band.low, best), band.high = max2(band.high, best);
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
    const enum scene_kind like = kind == KIND_FLUID ? SCENE_FLUID
                                 : scene->n_fluid   ? SCENE_COUPLED
                                                    : SCENE_SOLID;
    const double n = particles_across(scene, kind, body);
    const struct band band = band_of(like, accuracy, n);
    const char *const name =
        kind == KIND_FLUID ? scene->fluid[body].common.name : scene->solid[body].common.name;
    char range[64];
    snprintf(range, sizeof range, band.low < 0.9 * band.high ? "%.2g %% to %.2g %%" : "%.2g %%",
             band.low, band.high);
    const bool moves =
        kind == KIND_SOLID && scene->solid[body].clamp.n == 0 && !scene_is_bonded(scene, body);
    if (moves || !isfinite(band.low))
        session_say(
            o,
            "  %s: %.0f particles across; error unknown, because docs/accuracy.md has no case of "
            "this kind",
            name, n);
    else if (band.coarser)
        session_say(o,
                    "  %s: %.0f particles across, fewer than in all cases of this kind in "
                    "docs/accuracy.md, so the error is not known; use a finer dp",
                    name, n);
    else if (kind == KIND_FLUID)
        session_say(o,
                    "  %s: %.0f particles over its height: error of about %s (cases of this kind, "
                    "docs/accuracy.md)",
                    name, n, range);
    else
        session_say(o,
                    "  %s: %.0f particles across: error of the tip displacement about %s (cases of "
                    "this kind, docs/accuracy.md)",
                    name, n, range);
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

void evidence_say_preset(const struct scene *scene, const struct sphfsi_options *o)
{
    if (scene_given(scene, SECTION_top, 0, "accuracy")) evidence_say(scene, o);
}
