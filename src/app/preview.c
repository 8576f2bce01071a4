/* SPDX-License-Identifier: MIT */
#include "app/actions.h"

#include "case/params.h"
#include "particles/particles.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Pixels: the longer side of the drawing, its margins, a line of text. */
enum { DRAWING = 1000, LEFT = 70, RIGHT = 30, HEAD = 60, FOOT = 52, LINE = 18 };

struct drawing {
    FILE *file;
    const struct scene *scene;
    double low[2], high[2]; /* m */
    double scale;           /* pixels per m */
    int n_listed;           /* bodies and probes so far, which the legend numbers */
};

/* The palette of Okabe and Ito, for colour-blind readers. */
static const char *const fills[KIND_COUNT] = {"#56B4E9", "#999999", "#E69F00"};
static const char style[] =
    "<style>text{font:13px sans-serif}.title{font-size:16px;font-weight:bold}"
    ".middle,.label{text-anchor:middle}.end,.number{text-anchor:end}"
    ".label{font-weight:bold;paint-order:stroke;stroke:#fff;stroke-width:4px}"
    ".frame,.tick{fill:none;stroke:#000;stroke-width:0.7}.level{stroke:#000;stroke-dasharray:4 4}"
    ".probe{fill:#fff;stroke:#000;stroke-width:1.6}</style>\n"
    "<defs><pattern id=\"clamp\" width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\">"
    "<rect width=\"6\" height=\"6\" fill=\"#E69F00\"/>"
    "<path d=\"M0 6L6 0M-1 1L1 -1M5 7L7 5\" stroke=\"#000\"/></pattern></defs>\n";
static const enum section_id sections[KIND_COUNT] = {SECTION_fluid, SECTION_wall, SECTION_solid};

static double px(const struct drawing *g, double x) { return LEFT + (x - g->low[0]) * g->scale; }

static double py(const struct drawing *g, double y) { return HEAD + (g->high[1] - y) * g->scale; }

static double legend_y(const struct drawing *g)
{
    return py(g, g->low[1]) + FOOT + LINE * g->n_listed;
}

static void put_text(const struct drawing *g, double x, double y, const char *class,
                     const char *text)
{
    fprintf(g->file, "<text x=\"%.1f\" y=\"%.1f\" class=\"%s\">", x, y, class);
    for (; *text; text++)
        if (*text == '&' || *text == '<')
            fputs(*text == '&' ? "&amp;" : "&lt;", g->file);
        else
            fputc(*text, g->file);
    fputs("</text>\n", g->file);
}

/* Adds a line to the legend, and its number at a point of the drawing in pixels. */
static void list(struct drawing *g, double x, double y, const char *text)
{
    char number[16];
    snprintf(number, sizeof number, "%d", ++g->n_listed);
    put_text(g, x, y, "label", number);
    put_text(g, LEFT + 40, legend_y(g), "number", number);
    put_text(g, LEFT + 50, legend_y(g), "", text);
}

/* --- bodies --- */

static const struct scene_lattice *lattice_of(const struct scene *scene, enum kind kind, int body)
{
    return kind == KIND_SOLID ? &scene->solid_lattice[body] : &scene->lattice;
}

/* The particles of a body, clamped or not: one rectangle for neighbours that follow each other in a
 * row. */
static void put_particles(const struct drawing *g, enum kind kind, int body, int clamped)
{
    const struct scene_points *const p = &g->scene->points[kind];
    const struct scene_lattice *const l = lattice_of(g->scene, kind, body);
    const double gap = 0.01 * l->dp;
    double first[2] = {0}, last[2] = {0}, at[2] = {0}, to[2];
    bool open = false;
    for (int64_t i = 0; i <= p->n; i++) {
        const bool mine =
            i < p->n && p->body[i] == body && (p->clamped && p->clamped[i]) == clamped;
        if (mine) lattice_place(l, p->x[i], p->y[i], at);
        const bool follows = open && mine && fabs(at[1] - last[1]) < gap &&
                             fabs(at[0] - last[0] - l->spacing[0]) < gap;
        for (int k = 0; open && !follows && k < 4; k++) { /* round the corners */
            const double x =
                k == 1 || k == 2 ? last[0] + l->spacing[0] / 2 : first[0] - l->spacing[0] / 2;
            place_of_lattice(l, x, first[1] + (k / 2 - 0.5) * l->spacing[1], to);
            fprintf(g->file, "%c%.2f %.2f%s", k ? 'L' : 'M', px(g, to[0]), py(g, to[1]),
                    k == 3 ? "z" : "");
        }
        if (mine && !follows) memcpy(first, at, sizeof first);
        memcpy(last, at, sizeof last);
        open = mine;
    }
}

/* The box around the cells of a body, in the axes of its lattice. */
static void find_box(const struct scene_points *p, int body, const struct scene_lattice *l,
                     double low[2], double high[2])
{
    double at[2];
    for (int64_t i = 0; i < p->n; i++)
        for (int c = 0; c < 2 && p->body[i] == body; c++) {
            lattice_place(l, p->x[i], p->y[i], at);
            low[c] = min2(low[c], at[c] - l->spacing[c] / 2);
            high[c] = max2(high[c], at[c] + l->spacing[c] / 2);
        }
}

static void describe_solid(const struct scene *scene, int body, FILE *to)
{
    const struct scene_solid *const solid = &scene->solid[body];
    const struct scene_points *const p = &scene->points[KIND_SOLID];
    const double error = scene->solid_lattice[body].area_error;
    long long clamped = 0;
    for (int64_t i = 0; i < p->n; i++) clamped += p->body[i] == body && p->clamped && p->clamped[i];
    fprintf(to, "; %g kg/m^3, E %.4g Pa, nu %g; ", solid->density, solid->young, solid->poisson);
    if (clamped) fprintf(to, "%lld clamped (hatched)", clamped);
    if (solid->joined[0]) fprintf(to, "%sbonded to %s", clamped ? ", " : "", solid->joined);
    const bool held = clamped || solid->joined[0];
    if (solid->hinge.n)
        fprintf(to, "%s%d hinge%s (rings)", held ? ", " : "", solid->hinge.n,
                solid->hinge.n > 1 ? "s" : "");
    else if (!held)
        fputs("nothing clamped", to);
    if (fabs(error) >= 5e-5) fprintf(to, "; area %+.2f %%", 100 * error);
}

static void describe_body(const struct scene *scene, enum kind kind, int body, int64_t n, FILE *to)
{
    const struct scene_section_common *const common = section_at(scene, sections[kind], body);
    const struct scene_lattice *const l = lattice_of(scene, kind, body);
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    find_box(&scene->points[kind], body, l, low, high);
    fprintf(to, "%s %s: %.4g x %.4g m", kind_names[kind], common->name, n ? high[0] - low[0] : 0,
            n ? high[1] - low[1] : 0);
    if (l->angle != 0) fprintf(to, " at %.4g degrees", l->angle * (180 / PI));
    fprintf(to, ", %lld particles", (long long)n);
    if (l->dp != scene->top.dp) fprintf(to, " of %.4g x %.4g m", l->spacing[0], l->spacing[1]);
    if (kind == KIND_FLUID) fprintf(to, "; %g kg/m^3, c0 %.4g m/s", scene->rho0, scene->c0);
    if (kind == KIND_WALL)
        fprintf(to, scene->wall[body].motion[0] ? "; moved by %s" : "; at rest",
                scene->wall[body].motion);
    if (kind == KIND_SOLID) describe_solid(scene, body, to);
}

static void put_body(struct drawing *g, enum kind kind, int body)
{
    const struct scene_points *const p = &g->scene->points[kind];
    const bool moves = kind == KIND_WALL && g->scene->wall[body].motion[0];
    const char *const fill = moves ? "#CC79A7" : fills[kind];
    char text[1024] = "";
    int64_t n = 0, middle = -1; /* the particle nearest to the middle of the body */
    double sum[2] = {0}, nearest = HUGE_VAL;
    for (int64_t i = 0; i < p->n; i++)
        if (p->body[i] == body) n++, sum[0] += p->x[i], sum[1] += p->y[i];
    for (int64_t i = 0; i < p->n; i++) {
        const double away = hypot(p->x[i] - sum[0] / (double)n, p->y[i] - sum[1] / (double)n);
        if (p->body[i] == body && away < nearest) nearest = away, middle = i;
    }
    FILE *const to = fmemopen(text, sizeof text, "w");
    if (to) describe_body(g->scene, kind, body, n, to);
    if (to) fclose(to);
    fprintf(g->file, "<path fill=\"%s\" d=\"", fill);
    put_particles(g, kind, body, false);
    fputs("\"/>\n<path fill=\"url(#clamp)\" stroke=\"#000\" stroke-width=\"0.3\" d=\"", g->file);
    put_particles(g, kind, body, true);
    fprintf(g->file, "\"/>\n<rect x=\"%d\" y=\"%.1f\" width=\"12\" height=\"12\" fill=\"%s\"/>\n",
            LEFT, legend_y(g) + LINE - 11, fill);
    const struct hinge_list none = {0}, *const hinges = kind == KIND_SOLID
                                                            ? &g->scene->solid[body].hinge
                                                            : &none;
    for (int k = 0; k < hinges->n; k++)
        fprintf(g->file,
                "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4\" fill=\"none\" stroke=\"#000\"/>\n",
                px(g, hinges->item[k].at[0]), py(g, hinges->item[k].at[1]));
    list(g, middle < 0 ? -99 : px(g, p->x[middle]), middle < 0 ? 0 : py(g, p->y[middle]) + 4, text);
}

/* --- probes, axes --- */

static bool has_position(const struct scene_probe *probe)
{
    const enum probe_target target = scene_probe_target(probe);
    return target == TARGET_SOLID_POINT || target == TARGET_FLUID_POINT ||
           target == TARGET_FLUID_LINE;
}

static void put_probe(struct drawing *g, const struct scene_probe *probe)
{
    char quantity[SCENE_NAME], place[128] = "", text[1024];
    const bool line = scene_probe_target(probe) == TARGET_FLUID_LINE, here = has_position(probe);
    const double *const a = probe->point, *const b = probe->to;
    const double x = px(g, a[0]), y = py(g, a[1]);
    if (line) {
        fprintf(g->file, "<path class=\"probe\" d=\"M%.1f %.1fL%.1f %.1f\"/>\n", x, y, px(g, b[0]),
                py(g, b[1]));
        snprintf(place, sizeof place, " from (%g, %g) to (%g, %g) m", a[0], a[1], b[0], b[1]);
    } else if (here) {
        snprintf(place, sizeof place, " at (%g, %g) m", a[0], a[1]);
    }
    if (here && probe->quantity == PROBE_LEVEL)
        fprintf(g->file, "<path class=\"level\" d=\"M%.1f %.1fV%d\"/>\n", x, y, HEAD);
    if (here)
        fprintf(g->file,
                "<circle class=\"probe\" cx=\"%.1f\" cy=\"%.1f\" r=\"4\"/>\n"
                "<circle class=\"probe\" cx=\"%d\" cy=\"%.1f\" r=\"4\"/>\n",
                x, y, LEFT + 6, legend_y(g) + LINE - 5);
    param_choice_name(param_find(SECTION_probe, "quantity"), probe->quantity, quantity);
    snprintf(text, sizeof text, "probe %s: %s%s%s%s%s%s", probe->common.name, quantity,
             probe->body[0] ? " of " : "", probe->body, place, probe->on[0] ? ", moves with " : "",
             probe->on);
    list(g, here ? x + 8 : -99, y - 5, text);
}

/* Ticks at 1, 2 or 5 times a power of ten, some eight on the longer side. */
static void put_axes(const struct drawing *g)
{
    static const struct {
        const char *path, *class;
        double dx, dy;
    } axis[2] = {{"v6", "middle", 0, 19}, {"h-6", "end", -9, 4}};
    const double x0 = px(g, g->low[0]), y0 = py(g, g->low[1]);
    const double raw = DRAWING / g->scale / 8, power = pow(10, floor(log10(raw))),
                 digit = raw / power;
    const double step = power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
    fprintf(g->file, "<rect class=\"frame\" x=\"%.1f\" y=\"%d\" width=\"%.1f\" height=\"%.1f\"/>\n",
            x0, HEAD, px(g, g->high[0]) - x0, y0 - HEAD);
    for (int c = 0; c < 2; c++)
        for (double k = ceil(g->low[c] / step); k * step <= g->high[c]; k++) {
            const double x = c ? x0 : px(g, k * step), y = c ? py(g, k * step) : y0;
            char text[32];
            snprintf(text, sizeof text, "%.6g", k == 0 ? 0 : k * step);
            fprintf(g->file, "<path class=\"tick\" d=\"M%.1f %.1f%s\"/>\n", x, y, axis[c].path);
            put_text(g, x + axis[c].dx, y + axis[c].dy, axis[c].class, text);
        }
    put_text(g, 0.5 * (x0 + px(g, g->high[0])), y0 + 38, "middle", "x (m)");
    put_text(g, x0 - 9, HEAD - 8, "end", "y (m)");
}

static void find_view(struct drawing *g)
{
    const struct scene *const scene = g->scene;
    const struct scene_lattice upright = {.spacing = {0, 0}};
    for (int c = 0; c < 2; c++) g->low[c] = HUGE_VAL, g->high[c] = -HUGE_VAL;
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int k = 0; k < section_count(scene, sections[kind]); k++)
            find_box(&scene->points[kind], k, &upright, g->low, g->high);
    for (int k = 0; k < scene->n_probe; k++)
        for (int c = 0; c < 2 && has_position(&scene->probe[k]); c++) {
            const struct scene_probe *const probe = &scene->probe[k];
            const bool line = scene_probe_target(probe) == TARGET_FLUID_LINE;
            const double a = probe->point[c], b = line ? probe->to[c] : a;
            g->low[c] = min2(g->low[c], min2(a, b));
            g->high[c] = max2(g->high[c], max2(a, b));
        }
    const double wide = g->high[0] - g->low[0], tall = g->high[1] - g->low[1];
    const double pad = max2(2 * scene->top.dp, 0.02 * max2(wide, tall));
    for (int c = 0; c < 2; c++) g->low[c] -= pad, g->high[c] += pad;
    g->scale = DRAWING / (max2(wide, tall) + 2 * pad);
}

static void put_head(const struct drawing *g)
{
    const struct scene *const scene = g->scene;
    const int lines = scene->n_fluid + scene->n_wall + scene->n_solid + scene->n_probe;
    const double width = LEFT + DRAWING + RIGHT, height = legend_y(g) + lines * LINE + 20;
    char text[256];
    fprintf(g->file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" "
            "viewBox=\"0 0 %.0f %.0f\">\n"
            "%s<rect width=\"%.0f\" height=\"%.0f\" fill=\"#fff\"/>\n",
            width, height, width, height, style, width, height);
    put_text(g, LEFT, 22, "title", scene->top.title[0] ? scene->top.title : scene->path);
    snprintf(text, sizeof text,
             "dp %g m, h %g m, gravity (%g, %g) m/s^2, %g s; domain (%.4g, %.4g) to (%.4g, %.4g) m",
             scene->top.dp, scene->h, scene->top.gravity[0], scene->top.gravity[1],
             scene->top.end_time, scene->domain_lower[0], scene->domain_lower[1],
             scene->domain_upper[0], scene->domain_upper[1]);
    put_text(g, LEFT, 42, "", text);
}

enum err preview_draw(const struct scene *scene, const char *path, struct diag *d)
{
    static const enum kind order[KIND_COUNT] = {KIND_WALL, KIND_FLUID, KIND_SOLID};
    struct drawing g = {.scene = scene, .file = fopen(path, "w")};
    bool ok = g.file != NULL;
    if (ok) {
        find_view(&g);
        put_head(&g);
        for (int k = 0; k < KIND_COUNT; k++)
            for (int body = 0; body < section_count(scene, sections[order[k]]); body++)
                put_body(&g, order[k], body);
        put_axes(&g);
        for (int k = 0; k < scene->n_probe; k++) put_probe(&g, &scene->probe[k]);
        fputs("</svg>\n", g.file);
        ok = !ferror(g.file);
        ok = fclose(g.file) == 0 && ok;
    }
    return ok ? ERR_OK : diag_fail(d, ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
}
