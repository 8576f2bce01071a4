/* SPDX-License-Identifier: MIT
 * The expected error of a case, from problems with known answers: src/app/data/evidence.csv, which
 * `make accuracy` and `make coverage` write. */
#include "app/session.h"
#include "app/embedded.h"
#include "base/csv.h"
#include "geometry/sampling.h"

#include <stdlib.h>

enum evidence_column { SCENE, ACCURACY, CASE, ERROR, RESOLUTION, WHAT, PERCENT };
enum { MAX_ERRORS = 256 };

/* The errors of all problems of a kind, each at its finest resolution that is no finer than n; the
 * smallest first. The rows of a problem are by resolution. */
static int known_errors(enum scene_kind kind, const char *accuracy, double n,
                        double error[MAX_ERRORS])
{
    const char first = kind == SCENE_SOLID ? 's' : kind == SCENE_FLUID ? 'f' : 'c';
    const char *before = "", *line = embedded_text("src/app/data/evidence.csv");
    size_t length, before_length = 0;
    int count = 0;
    for (; *line && count < MAX_ERRORS; line = csv_next_line(line)) {
        const char *const name = csv_field(line, ACCURACY, &length);
        if (*line != first || strlen(accuracy) != length || strncmp(name, accuracy, length) != 0 ||
            strtod(csv_field(line, RESOLUTION, &length), NULL) > n)
            continue;
        const char *const problem = csv_field(line, CASE, &length);
        length = (size_t)(csv_field(line, RESOLUTION, &length) - problem);
        count -= length == before_length && strncmp(problem, before, length) == 0;
        before = problem;
        before_length = length;
        error[count++] = strtod(csv_field(line, PERCENT, &length), NULL);
    }
    qsort(error, (size_t)count, sizeof *error, geometry_ascending);
    return count;
}

/* Particles across the thinner side of a body, or over the height of the fluid. */
static double particles_across(const struct scene *scene, enum kind kind, int body)
{
    const struct scene_points *const p = &scene->points[kind];
    const struct scene_lattice *const l =
        kind == KIND_SOLID ? &scene->solid_lattice[body] : &scene->lattice;
    struct box2 box = box2_empty();
    double at[2], n[2];
    for (int64_t i = 0; i < p->n; i++) {
        if (p->body[i] != body) continue;
        lattice_place(l, p->x[i], p->y[i], at);
        box2_include(&box, at[0], at[1]);
    }
    for (int c = 0; c < 2; c++) n[c] = floor((box.high[c] - box.low[c]) / l->spacing[c] + 1.5);
    return kind == KIND_SOLID ? min2(n[0], n[1]) : n[1];
}

/* One more such problem has at most the k-th error of m with probability k/(m + 1): Wilks 1941. */
static void say_error(const struct scene *scene, enum kind kind, int body, const char *accuracy,
                      const struct sphfsi_options *o)
{
    const bool fluid = kind == KIND_FLUID;
    const enum scene_kind like = fluid ? SCENE_FLUID : scene->n_fluid ? SCENE_COUPLED : SCENE_SOLID;
    const double n = particles_across(scene, kind, body);
    double error[MAX_ERRORS];
    const bool moves = !fluid && scene->solid[body].clamp.n == 0 && !scene_is_bonded(scene, body);
    const int m = moves ? 0 : known_errors(like, accuracy, n, error);
    const int k = (int)min2(m, ceil(0.9 * (m + 1)));
    const char *const name =
        fluid ? scene->fluid[body].common.name : scene->solid[body].common.name;
    char text[120] =
        "error unknown: docs/results/coverage.md has no similar problem at so coarse a resolution";
    if (m > 0)
        snprintf(text, sizeof text,
                 "error of at most %.2g %% in %.0f of 100 cases (by %d errors of similar "
                 "problems in docs/results/coverage.md)",
                 error[k - 1], 100.0 * k / (m + 1), m);
    session_say(o, "  %s: %.0f particles %s: %s", name, n, fluid ? "high" : "across", text);
}

void evidence_say(const struct scene *scene, const struct sphfsi_options *o)
{
    /* The study runs the article's scheme at accuracy = standard only. */
    const bool paper = scene->n_fluid && scene->top.scheme == SCHEME_PAPER;
    const struct choice_name chosen =
        param_choice(param_find(SECTION_top, "accuracy"), scene->top.accuracy);
    const char *const accuracy = paper ? "paper" : chosen.text;
    session_say(o, "expected error %sat accuracy = %s", paper ? "with scheme = paper, " : "",
                paper ? "standard" : accuracy);
    for (int k = 0; k < scene->n_solid; k++) say_error(scene, KIND_SOLID, k, accuracy, o);
    if (scene->n_solid) return;
    for (int k = 0; k < scene->n_fluid; k++) say_error(scene, KIND_FLUID, k, accuracy, o);
}
