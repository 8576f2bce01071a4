/* SPDX-License-Identifier: MIT
 * --preview: an SVG of the scene before it runs. */
#include "app/actions.h"

#include "base/files.h"
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
    struct box2 view; /* m */
    double scale;     /* pixels per m */
    int n_listed;     /* bodies and probes so far, which the legend numbers */
};

/* The palette of Okabe and Ito, for colour-blind readers. */
static const char *const fills[KIND_COUNT] = {"#56B4E9", "#999999", "#E69F00"};
static const char moving[] = "#CC79A7", clamped[] = "#D55E00";
static const char style[] =
    "<style>text{font:13px sans-serif}.title{font-size:16px;font-weight:bold}"
    ".middle,.label{text-anchor:middle}.end,.number{text-anchor:end}"
    ".label{font-weight:bold;paint-order:stroke;stroke:#fff;stroke-width:4px}"
    ".body{fill:none;stroke-linecap:square}.frame,.tick{fill:none;stroke:#000;stroke-width:0.7}"
    ".probe,.hinge{fill:#fff;stroke:#000;stroke-width:1.6}</style>\n";
static const enum section_id sections[KIND_COUNT] = {SECTION_fluid, SECTION_wall, SECTION_solid};

static double px(const struct drawing *g, double x)
{
    return LEFT + (x - g->view.low[0]) * g->scale;
}

static double py(const struct drawing *g, double y)
{
    return HEAD + (g->view.high[1] - y) * g->scale;
}

static void begin_text(const struct drawing *g, double x, double y, const char *class)
{
    fprintf(g->file, "<text x=\"%.1f\" y=\"%.1f\" class=\"%s\">", x, y, class);
}

static void end_text(const struct drawing *g) { fputs("</text>\n", g->file); }

/* Writes the next number at a point of the drawing in pixels, and begins its line of the legend. */
static void begin_legend(struct drawing *g, double x, double y)
{
    const double line = py(g, g->view.low[1]) + FOOT + LINE * ++g->n_listed;
    begin_text(g, x, y, "label");
    fprintf(g->file, "%d</text>\n", g->n_listed);
    begin_text(g, LEFT + 40, line, "number");
    fprintf(g->file, "%d</text>\n", g->n_listed);
    begin_text(g, LEFT + 50, line, "");
}

static void put_circle(const struct drawing *g, const char *class, const double at[2])
{
    fprintf(g->file, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"4\"/>\n", class,
            px(g, at[0]), py(g, at[1]));
}

/* A line with its ends, whose number stands at the first of them. */
static void put_line(struct drawing *g, const double from[2], const double to[2])
{
    fprintf(g->file, "<path class=\"probe\" d=\"M%.1f %.1fL%.1f %.1f\"/>\n", px(g, from[0]),
            py(g, from[1]), px(g, to[0]), py(g, to[1]));
    put_circle(g, "probe", from);
    put_circle(g, "probe", to);
}

/* --- bodies --- */

static double spacing(const struct scene *scene, enum kind kind, int body)
{
    return kind == KIND_SOLID ? scene->solid_lattice[body].dp : scene->top.dp;
}

/* Extends a box by the particles of a body; returns their number. */
static int64_t extend_box(const struct scene *scene, enum kind kind, int body, struct box2 *box)
{
    const struct scene_points *const p = &scene->points[kind];
    const double half = 0.5 * spacing(scene, kind, body);
    int64_t n = 0;
    for (int64_t i = 0; i < p->n; i++) {
        if (p->body[i] != body) continue;
        box2_include(box, p->x[i] - half, p->y[i] - half);
        box2_include(box, p->x[i] + half, p->y[i] + half);
        n++;
    }
    return n;
}

/* The particles of a body, clamped or not, as squares. Returns their number. */
static int64_t put_particles(const struct drawing *g, enum kind kind, int body, bool held,
                             const char *colour)
{
    const struct scene_points *const p = &g->scene->points[kind];
    int64_t n = 0;
    fprintf(g->file, "<path class=\"body\" stroke=\"%s\" stroke-width=\"%.2f\" d=\"", colour,
            spacing(g->scene, kind, body) * g->scale);
    for (int64_t i = 0; i < p->n; i++) {
        if (p->body[i] != body || (p->clamped && p->clamped[i]) != held ||
            (kind == KIND_WALL && scene_line_of(g->scene, i)))
            continue;
        fprintf(g->file, "M%.1f %.1fh.01", px(g, p->x[i]), py(g, p->y[i]));
        n++;
    }
    fputs("\"/>\n", g->file);
    return n;
}

/* The thin lines of a wall. */
static void put_lines(const struct drawing *g, int wall, const char *colour)
{
    for (int k = 0; k < g->scene->n_line; k++) {
        const struct scene_line *const line = &g->scene->line[k];
        if (line->wall != wall) continue;
        fprintf(g->file, "<path class=\"body\" stroke=\"%s\" stroke-width=\"3\" d=\"", colour);
        for (int j = 0; j < line->n; j++)
            fprintf(g->file, "%s%.1f %.1f", j ? "L" : "M", px(g, line->pt[j][0]),
                    py(g, line->pt[j][1]));
        fputs("\"/>\n", g->file);
    }
}

static void describe_solid(const struct scene_solid *solid, int64_t n_clamped, FILE *to)
{
    fprintf(to, "; %g kg/m^3, E %.4g Pa, nu %g", solid->density, solid->young, solid->poisson);
    if (n_clamped) fprintf(to, "; %lld clamped (dark)", (long long)n_clamped);
    if (solid->joined[0]) fprintf(to, "; bonded to %s", solid->joined);
    if (solid->hinge.n) fprintf(to, "; hinges: %d (rings)", solid->hinge.n);
    if (!n_clamped && !solid->joined[0] && !solid->hinge.n) fputs("; nothing clamped", to);
}

static void put_body(struct drawing *g, enum kind kind, int body)
{
    const struct scene *const scene = g->scene;
    const struct scene_points *const p = &scene->points[kind];
    const struct scene_section_common *const common = section_at(scene, sections[kind], body);
    const char *const motion = kind == KIND_WALL ? scene->wall[body].motion : "";
    const int rigid = common->section == SECTION_rigid ? common->index : -1;
    struct box2 box = box2_empty();
    const int64_t n = extend_box(scene, kind, body, &box);
    put_particles(g, kind, body, false, motion[0] ? moving : fills[kind]);
    if (kind == KIND_WALL) put_lines(g, body, motion[0] ? moving : fills[kind]);
    const int64_t n_clamped = put_particles(g, kind, body, true, clamped);
    for (int k = 0; kind == KIND_SOLID && k < scene->solid[body].hinge.n; k++)
        put_circle(g, "hinge", scene->solid[body].hinge.item[k].at);
    if (rigid >= 0 && scene->rigid[rigid].hinge.n)
        put_circle(g, "hinge", scene->rigid[rigid].hinge.item[0].at);
    int64_t i = 0, before = n / 2; /* the number stands at the middle one of the particles */
    while (i < p->n && (p->body[i] != body || before-- > 0)) i++;
    begin_legend(g, n ? px(g, p->x[i]) : -99, n ? py(g, p->y[i]) + 4 : 0);
    fprintf(g->file, "%s %s: %.4g x %.4g m, %lld particles", section_table[common->section].word,
            common->name, n ? box.high[0] - box.low[0] : 0, n ? box.high[1] - box.low[1] : 0,
            (long long)n);
    if (kind == KIND_FLUID) fprintf(g->file, "; %g kg/m^3, c0 %.4g m/s", scene->rho0, scene->c0);
    if (rigid >= 0)
        fprintf(g->file, "; %.4g kg/m, moves by itself", scene->rigid_mass[rigid].mass);
    else if (kind == KIND_WALL)
        fprintf(g->file, motion[0] ? "; moved by %s" : "; at rest", motion);
    if (kind == KIND_SOLID) describe_solid(&scene->solid[body], n_clamped, g->file);
    end_text(g);
}

/* --- probes, axes --- */

/* The points of a probe: two of a line, one, or none. */
static int find_points(const struct scene_probe *probe, double at[2][2])
{
    const enum probe_target target = scene_probe_target(probe);
    memcpy(at[0], probe->point, sizeof at[0]);
    memcpy(at[1], probe->to, sizeof at[1]);
    if (target == TARGET_FLUID_LINE) return 2;
    return target == TARGET_SOLID_POINT || target == TARGET_FLUID_POINT;
}

static void put_probe(struct drawing *g, const struct scene_probe *probe)
{
    char quantity[SCENE_NAME];
    double at[2][2];
    const int n = find_points(probe, at);
    if (n == 2) put_line(g, at[0], at[1]);
    if (n == 1) put_circle(g, "probe", at[0]);
    param_choice_name(param_find(SECTION_probe, "quantity"), probe->quantity, quantity);
    begin_legend(g, n ? px(g, at[0][0]) + 8 : -99, n ? py(g, at[0][1]) - 5 : 0);
    fprintf(g->file, "probe %s: %s%s%s", probe->common.name, quantity, probe->body[0] ? " of " : "",
            probe->body);
    if (n == 1) fprintf(g->file, " at (%g, %g) m", at[0][0], at[0][1]);
    if (n == 2)
        fprintf(g->file, " from (%g, %g) to (%g, %g) m", at[0][0], at[0][1], at[1][0], at[1][1]);
    end_text(g);
}

/* The line of a spring or of a zone of damping. */
static void put_section(struct drawing *g, const char *word, const char *name, const double from[2],
                        const double to[2])
{
    put_line(g, from, to);
    begin_legend(g, px(g, from[0]) + 8, py(g, from[1]) - 5);
    fprintf(g->file, "%s %s: from (%g, %g) to (%g, %g) m", word, name, from[0], from[1], to[0],
            to[1]);
    end_text(g);
}

/* Ticks at 1, 2 or 5 times a power of ten, some eight on the longer side. */
static void put_axes(const struct drawing *g)
{
    const double x0 = px(g, g->view.low[0]), y0 = py(g, g->view.low[1]);
    const double raw = DRAWING / g->scale / 8, power = pow(10, floor(log10(raw)));
    const double digit = raw / power;
    const double step = power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
    fprintf(g->file, "<rect class=\"frame\" x=\"%.1f\" y=\"%d\" width=\"%.1f\" height=\"%.1f\"/>\n",
            x0, HEAD, px(g, g->view.high[0]) - x0, y0 - HEAD);
    for (int c = 0; c < 2; c++)
        for (double k = ceil(g->view.low[c] / step); k * step <= g->view.high[c]; k++) {
            const double x = c ? x0 : px(g, k * step), y = c ? py(g, k * step) : y0;
            fprintf(g->file, "<path class=\"tick\" d=\"M%.1f %.1f%s\"/>\n", x, y, c ? "h-6" : "v6");
            begin_text(g, c ? x - 9 : x, c ? y + 4 : y + 19, c ? "end" : "middle");
            fprintf(g->file, "%.6g</text>\n", k == 0 ? 0 : k * step);
        }
}

static void find_view(struct drawing *g)
{
    const struct scene *const scene = g->scene;
    double at[2][2];
    g->view = box2_empty();
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int k = 0; k < section_count(scene, sections[kind]); k++)
            extend_box(scene, (enum kind)kind, k, &g->view);
    for (int k = 0; k < scene->n_probe; k++)
        for (int i = 0; i < find_points(&scene->probe[k], at); i++)
            box2_include(&g->view, at[i][0], at[i][1]);
    const double longer = max2(g->view.high[0] - g->view.low[0], g->view.high[1] - g->view.low[1]);
    const double pad = max2(2 * scene->top.dp, 0.02 * longer);
    for (int c = 0; c < 2; c++) g->view.low[c] -= pad, g->view.high[c] += pad;
    g->scale = DRAWING / (longer + 2 * pad);
}

static void put_head(const struct drawing *g)
{
    const struct scene *const scene = g->scene;
    const int lines = scene->n_fluid + scene->n_wall + scene->n_solid + scene->n_probe +
                      scene->n_spring + scene->n_damping;
    const int width = LEFT + DRAWING + RIGHT;
    const double height = py(g, g->view.low[1]) + FOOT + lines * LINE + 20;
    fprintf(g->file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%.0f\">\n"
            "%s<rect width=\"%d\" height=\"%.0f\" fill=\"#fff\"/>\n",
            width, height, style, width, height);
    begin_text(g, LEFT, 22, "title");
    for (const char *c = scene->top.title[0] ? scene->top.title : scene->path; *c; c++)
        if (*c == '&' || *c == '<')
            fputs(*c == '&' ? "&amp;" : "&lt;", g->file);
        else
            fputc(*c, g->file);
    end_text(g);
    begin_text(g, LEFT, 42, "");
    fprintf(g->file,
            "Lengths in m; dp %g m, h %g m, gravity (%g, %g) m/s^2, %g s; domain (%.4g, %.4g) to "
            "(%.4g, %.4g)",
            scene->top.dp, scene->h, scene->top.gravity[0], scene->top.gravity[1],
            scene->top.end_time, scene->domain_lower[0], scene->domain_lower[1],
            scene->domain_upper[0], scene->domain_upper[1]);
    end_text(g);
}

static enum err draw(struct session *session, const struct sphfsi_options *o, const char *unused,
                     struct diag *d)
{
    static const enum kind order[KIND_COUNT] = {KIND_WALL, KIND_FLUID, KIND_SOLID};
    const struct scene *const scene = &session->scene;
    char path[PATH_BYTES];
    int length;
    const char *const name = session_name(o, &length);
    (void)unused;
    if (o->out)
        snprintf(path, sizeof path, "%s", o->out);
    else
        snprintf(path, sizeof path, "preview-%.*s.svg", length, name);
    struct drawing g = {.scene = scene, .file = fopen(path, "w")};
    if (!g.file) return diag_fail(d, ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
    find_view(&g);
    put_head(&g);
    for (int k = 0; k < KIND_COUNT; k++)
        for (int body = 0; body < section_count(scene, sections[order[k]]); body++)
            put_body(&g, order[k], body);
    put_axes(&g);
    for (int k = 0; k < scene->n_spring; k++)
        put_section(&g, "spring", scene->spring[k].common.name, scene->spring[k].from,
                    scene->spring[k].to);
    for (int k = 0; k < scene->n_damping; k++)
        put_section(&g, "damping", scene->damping[k].common.name, scene->damping[k].from,
                    scene->damping[k].to);
    for (int k = 0; k < scene->n_probe; k++) put_probe(&g, &scene->probe[k]);
    fputs("</svg>\n", g.file);
    const bool failed = ferror(g.file);
    if (fclose(g.file) != 0 || failed)
        return diag_fail(d, ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
    session_say(o, "%s: picture of the case at the start; open it in a browser", path);
    return ERR_OK;
}

enum sphfsi_status sphfsi_preview(const struct sphfsi_options *options)
{
    return call_of_case("preview", options, false, draw, NULL);
}
