/* SPDX-License-Identifier: MIT
 * --preview: an SVG of the scene before it runs. */
#include "app/session.h"

#include "base/files.h"
#include "case/params.h"

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

static void put_text(const struct drawing *g, double x, double y, const char *class,
                     const char *text)
{
    fprintf(g->file, "<text x=\"%.1f\" y=\"%.1f\" class=\"%s\">", x, y, class);
    for (const char *c = text; *c; c++)
        if (*c == '&' || *c == '<')
            fputs(*c == '&' ? "&amp;" : "&lt;", g->file);
        else
            fputc(*c, g->file);
    fputs("</text>\n", g->file);
}

/* A number in the drawing, in pixels, and its line in the legend. */
static void put_legend(struct drawing *g, double x, double y, const char *text)
{
    const double line = py(g, g->view.low[1]) + FOOT + LINE * ++g->n_listed;
    char number[16];
    snprintf(number, sizeof number, "%d", g->n_listed);
    put_text(g, x, y, "label", number);
    put_text(g, LEFT + 40, line, "number", number);
    put_text(g, LEFT + 50, line, "", text);
}

static void put_path(const struct drawing *g, const char *class, int n, const double (*pt)[2],
                     const char *colour)
{
    fprintf(g->file, "<path class=\"%s\" stroke=\"%s\" stroke-width=\"3\" d=\"", class, colour);
    for (int k = 0; k < n; k++)
        fprintf(g->file, "%c%.1f %.1f", k ? 'L' : 'M', px(g, pt[k][0]), py(g, pt[k][1]));
    fputs("\"/>\n", g->file);
}

static void put_circle(const struct drawing *g, const char *class, const double at[2])
{
    fprintf(g->file, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"4\"/>\n", class,
            px(g, at[0]), py(g, at[1]));
}

/* --- bodies --- */

/* The particles of a body, clamped or not, as squares, without those of thin lines. Returns their
 * number, and extends the box by them. */
static int64_t put_particles(const struct drawing *g, enum kind kind, int body, bool held,
                             const char *colour, struct box2 *box)
{
    const struct scene *const scene = g->scene;
    const struct scene_points *const p = &scene->points[kind];
    const double side = kind == KIND_SOLID ? scene->solid_lattice[body].dp : scene->top.dp;
    int64_t n = 0;
    fprintf(g->file, "<path class=\"body\" stroke=\"%s\" stroke-width=\"%.2f\" d=\"", colour,
            side * g->scale);
    for (int64_t i = 0; i < p->n; i++) {
        if (p->body[i] != body || (p->clamped && p->clamped[i]) != held ||
            (kind == KIND_WALL && scene_line_of(scene, i)))
            continue;
        box2_include(box, p->x[i] - 0.5 * side, p->y[i] - 0.5 * side);
        box2_include(box, p->x[i] + 0.5 * side, p->y[i] + 0.5 * side);
        fprintf(g->file, "M%.1f %.1fh.01", px(g, p->x[i]), py(g, p->y[i]));
        n++;
    }
    fputs("\"/>\n", g->file);
    return n;
}

/* The thin lines of a wall, or the line of a beam, with or without fluid. Extends a box by them;
 * returns the middle point of the last, NULL: none. Draws them, unless there is no colour. */
static const double *put_lines(const struct drawing *g, int wall, const char *colour,
                               struct box2 *box)
{
    const int beam = wall - scene_beam_wall(g->scene, 0);
    const struct shape_list *const list =
        beam < 0 ? &g->scene->wall[wall].shape : &g->scene->beam[beam].shape;
    const double *middle = NULL;
    for (int k = 0; k < list->n; k++) {
        const struct shape *const line = &list->item[k];
        if (beam < 0 && !line->thin) continue;
        if (colour) put_path(g, "body", line->n, (const double(*)[2])line->pt, colour);
        for (int j = 0; j < line->n; j++) box2_include(box, line->pt[j][0], line->pt[j][1]);
        middle = line->pt[line->n / 2];
    }
    return middle;
}

/* The number of a body stands at the middle one of its particles, or else of its line. */
static void put_body_legend(struct drawing *g, const struct scene_points *p, int body,
                            const double *middle, const char *text)
{
    int64_t n = 0, k = 0;
    for (int64_t i = 0; i < p->n; i++) n += p->body[i] == body;
    for (int64_t before = n / 2; n && (p->body[k] != body || before-- > 0);) k++;
    const double x = n ? p->x[k] : middle ? middle[0] : 0, y = n ? p->y[k] : middle ? middle[1] : 0;
    put_legend(g, n || middle ? px(g, x) : -99, n || middle ? py(g, y) + 4 : 0, text);
}

static void put_hinges(const struct drawing *g, const struct hinge_list *list)
{
    for (int k = 0; k < list->n; k++) put_circle(g, "hinge", list->item[k].at);
}

static void put_body(struct drawing *g, enum kind kind, int body)
{
    const struct scene *const scene = g->scene;
    const struct scene_section_common *const common = section_at(scene, sections[kind], body);
    const struct scene_solid *const solid = kind == KIND_SOLID ? &scene->solid[body] : NULL;
    const struct scene_beam *const beam = &scene->beam[common->index];
    const char *const motion = kind == KIND_WALL ? scene->wall[body].motion : "";
    const char *const colour = motion[0] ? moving : fills[kind];
    struct box2 box = box2_empty();
    char text[400], more[240] = "";
    const int64_t n = put_particles(g, kind, body, false, colour, &box);
    const int64_t held = put_particles(g, kind, body, true, clamped, &box);
    const double *middle = NULL; /* of its last thin line */
    if (kind == KIND_WALL) middle = put_lines(g, body, colour, &box);
    if (solid) put_hinges(g, &solid->hinge);
    if (common->section == SECTION_rigid) put_hinges(g, &scene->rigid[common->index].hinge);
    if (kind == KIND_FLUID)
        snprintf(more, sizeof more, "%g kg/m^3, c0 %.4g m/s", scene->rho0, scene->c0);
    else if (common->section == SECTION_rigid)
        snprintf(more, sizeof more, "%.4g kg/m, moves freely",
                 scene->rigid_mass[common->index].mass);
    else if (common->section == SECTION_beam)
        snprintf(more, sizeof more, "%g m thick, %g kg/m^3, E %.4g Pa, nu %g", beam->thickness,
                 beam->density, beam->young, beam->poisson);
    else if (solid)
        snprintf(more, sizeof more, "%g kg/m^3, E %.4g Pa, nu %g; %lld clamped (dark)%s%.64s",
                 solid->density, solid->young, solid->poisson, (long long)held,
                 solid->joined[0] ? "; bonded to " : "", solid->joined);
    else
        snprintf(more, sizeof more, motion[0] ? "moved by %s" : "at rest", motion);
    snprintf(text, sizeof text, "%s %s: %.4g x %.4g m, %lld particles; %s",
             section_table[common->section].word, common->name, max2(0, box.high[0] - box.low[0]),
             max2(0, box.high[1] - box.low[1]), (long long)(n + held), more);
    put_body_legend(g, &scene->points[kind], body, middle, text);
}

/* --- what has one or two points: probes, springs, zones of damping --- */

static int points_of_probe(const struct scene_probe *probe)
{
    const enum probe_target target = scene_probe_target(probe);
    if (target == TARGET_FLUID_LINE) return 2;
    return target == TARGET_SOLID_POINT || target == TARGET_FLUID_POINT;
}

static void put_mark(struct drawing *g, const struct scene_section_common *common, const char *what,
                     int n, const double from[2], const double to[2])
{
    const double ends[2][2] = {{from[0], from[1]}, {to[0], to[1]}};
    char text[2 * SCENE_NAME + SCENE_TEXT], place[160] = "";
    if (n == 2) put_path(g, "probe", 2, ends, "#000");
    for (int k = 0; k < n; k++) put_circle(g, "probe", ends[k]);
    if (n == 1) snprintf(place, sizeof place, " at (%g, %g) m", from[0], from[1]);
    if (n == 2)
        snprintf(place, sizeof place, " from (%g, %g) to (%g, %g) m", from[0], from[1], to[0],
                 to[1]);
    snprintf(text, sizeof text, "%s %s: %s%s", section_table[common->section].word, common->name,
             what, place);
    put_legend(g, n ? px(g, from[0]) + 8 : -99, n ? py(g, from[1]) - 5 : 0, text);
}

static void put_marks(struct drawing *g)
{
    const struct scene *const scene = g->scene;
    for (int k = 0; k < scene->n_spring; k++)
        put_mark(g, &scene->spring[k].common, scene->spring[k].body, 2, scene->spring[k].from,
                 scene->spring[k].to);
    for (int k = 0; k < scene->n_damping; k++)
        put_mark(g, &scene->damping[k].common, "zone", 2, scene->damping[k].from,
                 scene->damping[k].to);
    for (int k = 0; k < scene->n_probe; k++) {
        const struct scene_probe *const probe = &scene->probe[k];
        char quantity[SCENE_NAME], what[SCENE_NAME + SCENE_TEXT];
        param_choice_name(param_find(SECTION_probe, "quantity"), probe->quantity, quantity);
        snprintf(what, sizeof what, "%s%s%.60s", quantity, probe->body[0] ? " of " : "",
                 probe->body);
        put_mark(g, &probe->common, what, points_of_probe(probe), probe->point, probe->to);
    }
}

/* --- the sheet --- */

/* Ticks at 1, 2 or 5 times a power of ten, some eight on the longer side. */
static void put_axes(const struct drawing *g)
{
    const double x0 = px(g, g->view.low[0]), y0 = py(g, g->view.low[1]);
    const double raw = DRAWING / g->scale / 8, power = pow(10, floor(log10(raw)));
    const double digit = raw / power;
    const double step = power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
    char text[32];
    fprintf(g->file, "<rect class=\"frame\" x=\"%.1f\" y=\"%d\" width=\"%.1f\" height=\"%.1f\"/>\n",
            x0, HEAD, px(g, g->view.high[0]) - x0, y0 - HEAD);
    for (int c = 0; c < 2; c++)
        for (double k = ceil(g->view.low[c] / step); k * step <= g->view.high[c]; k++) {
            const double x = c ? x0 : px(g, k * step), y = c ? py(g, k * step) : y0;
            fprintf(g->file, "<path class=\"tick\" d=\"M%.1f %.1f%s\"/>\n", x, y, c ? "h-6" : "v6");
            snprintf(text, sizeof text, "%.6g", k == 0 ? 0 : k * step);
            put_text(g, c ? x - 9 : x, c ? y + 4 : y + 19, c ? "end" : "middle", text);
        }
}

static void find_view(struct drawing *g)
{
    const struct scene *const scene = g->scene;
    g->view = box2_empty();
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int64_t i = 0; i < scene->points[kind].n; i++)
            box2_include(&g->view, scene->points[kind].x[i], scene->points[kind].y[i]);
    for (int k = 0; k < scene->n_wall; k++) put_lines(g, k, NULL, &g->view);
    for (int k = 0; k < scene->n_probe; k++)
        for (int n = points_of_probe(&scene->probe[k]); n > 0; n--) {
            const double *const at = n == 2 ? scene->probe[k].to : scene->probe[k].point;
            box2_include(&g->view, at[0], at[1]);
        }
    const double longer = max2(g->view.high[0] - g->view.low[0], g->view.high[1] - g->view.low[1]);
    const double pad = max2(3 * scene->top.dp, 0.02 * longer);
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
    char text[300], domain[120] = "";
    if (scene->domain_lower[0] <= scene->domain_upper[0]) /* else there are only beams */
        snprintf(domain, sizeof domain, "; domain (%.4g, %.4g) to (%.4g, %.4g)",
                 scene->domain_lower[0], scene->domain_lower[1], scene->domain_upper[0],
                 scene->domain_upper[1]);
    fprintf(g->file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%.0f\">\n"
            "%s<rect width=\"%d\" height=\"%.0f\" fill=\"#fff\"/>\n",
            width, height, style, width, height);
    put_text(g, LEFT, 22, "title", scene->top.title[0] ? scene->top.title : scene->path);
    snprintf(text, sizeof text, "Lengths in m; dp %g m, h %g m, gravity (%g, %g) m/s^2, %g s%s",
             scene->top.dp, scene->h, scene->top.gravity[0], scene->top.gravity[1],
             scene->top.end_time, domain);
    put_text(g, LEFT, 42, "", text);
}

static enum err draw(struct session *session, const struct sphfsi_options *o, struct diag *d)
{
    static const enum kind order[KIND_COUNT] = {KIND_WALL, KIND_FLUID, KIND_SOLID};
    char path[PATH_BYTES];
    int length;
    const char *const name = session_name(o, &length);
    if (o->out)
        snprintf(path, sizeof path, "%s", o->out);
    else
        snprintf(path, sizeof path, "preview-%.*s.svg", length, name);
    struct drawing g = {.scene = &session->scene, .file = fopen(path, "w")};
    if (!g.file) return diag_fail(d, ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
    find_view(&g);
    put_head(&g);
    for (int k = 0; k < KIND_COUNT; k++)
        for (int body = 0; body < section_count(g.scene, sections[order[k]]); body++)
            put_body(&g, order[k], body);
    put_axes(&g);
    put_marks(&g);
    fputs("</svg>\n", g.file);
    const bool failed = ferror(g.file);
    if (fclose(g.file) != 0 || failed)
        return diag_fail(d, ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
    session_say(o, "%s: picture of the case at the start; open it in a browser", path);
    return ERR_OK;
}

enum sphfsi_status sphfsi_preview(const struct sphfsi_options *options)
{
    return call_of_case("preview", options, false, draw);
}
