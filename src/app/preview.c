/* SPDX-License-Identifier: MIT
 * --preview: an SVG of the scene before it runs. */
#include "app/session.h"
#include "base/files.h"

#include <errno.h>
#include <stdlib.h>

/* Pixels: the longer side of the drawing, its margins, a line of text. */
enum { DRAWING = 1000, LEFT = 70, RIGHT = 30, HEAD = 60, FOOT = 52, LINE = 18 };

struct drawing {
    FILE *file;
    const struct scene *scene;
    struct box2 drawn, view; /* m: of all that has been drawn, of the picture */
    double scale;            /* pixels per m */
    int n_listed;            /* lines of the legend so far */
};

/* The palette of Okabe and Ito, for colour-blind readers. */
static const char *const fills[KIND_COUNT] = {"#56B4E9", "#999999", "#E69F00"};
static const enum section_id sections[KIND_COUNT] = {SECTION_fluid, SECTION_wall, SECTION_solid};
static const char moving[] = "#CC79A7", clamped[] = "#D55E00";
static const char style[] =
    "<style>text{font:13px sans-serif}.title{font-size:16px;font-weight:bold}"
    ".middle,.label{text-anchor:middle}.end,.number{text-anchor:end}"
    ".label{font-weight:bold;paint-order:stroke;stroke:#fff;stroke-width:4px}"
    ".body{fill:none;stroke-linecap:square}.frame,.tick{fill:none;stroke:#000;stroke-width:0.7}"
    ".mark{fill:#fff;stroke:#000;stroke-width:1.6}</style>\n";

struct pixel {
    double x, y;
};

static struct pixel pixel_of(struct drawing *g, double x, double y)
{
    box2_include(&g->drawn, x, y);
    return (struct pixel){LEFT + (x - g->view.low[0]) * g->scale,
                          HEAD + (g->view.high[1] - y) * g->scale};
}

static double legend_line(const struct drawing *g, int k)
{
    return HEAD + (g->view.high[1] - g->view.low[1]) * g->scale + FOOT + LINE * k;
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

static void put_path(struct drawing *g, const char *class, int n, double (*pt)[2],
                     const char *colour)
{
    fprintf(g->file, "<path class=\"%s\" stroke=\"%s\" stroke-width=\"3\" d=\"", class, colour);
    for (int k = 0; k < n; k++) {
        const struct pixel at = pixel_of(g, pt[k][0], pt[k][1]);
        fprintf(g->file, "%c%.1f %.1f", k ? 'L' : 'M', at.x, at.y);
    }
    fputs("\"/>\n", g->file);
}

static void put_circle(struct drawing *g, const double place[2])
{
    const struct pixel at = pixel_of(g, place[0], place[1]);
    fprintf(g->file, "<circle class=\"mark\" cx=\"%.1f\" cy=\"%.1f\" r=\"4\"/>\n", at.x, at.y);
}

/* A line of the legend, and its number at a place in the drawing or `beside` it, in pixels. */
static void put_legend(struct drawing *g, const double place[2], int beside,
                       const struct scene_section_common *of, const char *what)
{
    const double line = legend_line(g, ++g->n_listed);
    char number[16], text[300];
    snprintf(text, sizeof text, "%s %s: %s", section_table[of->section].word, of->name, what);
    snprintf(number, sizeof number, "%d", g->n_listed);
    put_text(g, LEFT + 40, line, "number", number);
    put_text(g, LEFT + 50, line, "", text);
    if (!place) return;
    const struct pixel at = pixel_of(g, place[0], place[1]);
    put_text(g, at.x + beside, at.y + 4 - beside, "label", number);
}

/* The particles of a body, held by a clamp or not, as squares, without those of thin lines. Returns
 * their number, extends the box by them and finds the place of the middle one. */
static int64_t put_particles(struct drawing *g, enum kind kind, int body, bool held,
                             const char *colour, struct box2 *box, double middle[2])
{
    const struct scene *const scene = g->scene;
    const struct scene_points *const p = &scene->points[kind];
    const double side = kind == KIND_SOLID ? scene->solid_lattice[body].dp : scene->top.dp;
    int64_t n = 0, first = 0, last = 0;
    fprintf(g->file, "<path class=\"body\" stroke=\"%s\" stroke-width=\"%.2f\" d=\"", colour,
            side * g->scale);
    for (int64_t i = 0; i < p->n; i++) {
        if (p->body[i] != body || (p->clamped && p->clamped[i]) != held ||
            (kind == KIND_WALL && scene_line_of(scene, i)))
            continue;
        const struct pixel at = pixel_of(g, p->x[i], p->y[i]);
        box2_include(box, p->x[i] - 0.5 * side, p->y[i] - 0.5 * side);
        box2_include(box, p->x[i] + 0.5 * side, p->y[i] + 0.5 * side);
        fprintf(g->file, "M%.1f %.1fh.01", at.x, at.y);
        if (n++ == 0) first = i;
        last = i;
    }
    fputs("\"/>\n", g->file);
    if (n > 0) middle[0] = p->x[(first + last) / 2], middle[1] = p->y[(first + last) / 2];
    return n;
}

static void put_body(struct drawing *g, enum kind kind, int body)
{
    const struct scene *const scene = g->scene;
    const struct scene_section_common *common = section_at(scene, sections[kind], body);
    const struct scene_wall *const wall = kind == KIND_WALL ? &scene->wall[body] : NULL;
    common = section_at(scene, (enum section_id)common->section, common->index); /* of a [rigid] */
    const bool beam = common->section == SECTION_beam;
    const char *const colour = wall && *wall->motion ? moving : fills[kind];
    const struct shape_list *const lines = beam   ? &scene->beam[common->index].shape
                                           : wall ? &wall->shape
                                                  : NULL;
    struct box2 box = box2_empty();
    double middle[2] = {0, 0};
    char text[160], more[40] = "";
    const int64_t held = put_particles(g, kind, body, true, clamped, &box, middle),
                  n = held + put_particles(g, kind, body, false, colour, &box, middle);
    for (int k = 0; lines && k < lines->n; k++) {
        const struct shape *const line = &lines->item[k];
        if (!beam && !line->thin) continue;
        put_path(g, "body", line->n, line->pt, colour);
        for (int j = 0; j < line->n; j++) box2_include(&box, line->pt[j][0], line->pt[j][1]);
        if (n == 0) memcpy(middle, line->pt[line->n / 2], sizeof middle);
    }
    for (const struct param *key = param_table; key < param_table + PARAM_COUNT; key++) {
        const struct hinge_list *const list = (const void *)((const char *)common + key->offset);
        if (key->section != (enum section_id)common->section || key->type != PARAM_HINGES) continue;
        for (int k = 0; k < list->n; k++) put_circle(g, list->item[k].at);
    }
    if (held > 0) snprintf(more, sizeof more, ", %lld clamped (dark)", (long long)held);
    const bool drawn = box.low[0] <= box.high[0];
    snprintf(text, sizeof text, "%.4g x %.4g m, %lld particles%s",
             max2(0, box.high[0] - box.low[0]), max2(0, box.high[1] - box.low[1]), (long long)n,
             more);
    put_legend(g, drawn ? middle : NULL, 0, common, text);
}

/* What has one or two points, as far as the case gives them. */
static void put_mark(struct drawing *g, const struct scene_section_common *common)
{
    const enum section_id id = (enum section_id)common->section;
    const bool probe = id == SECTION_probe;
    const char *const keys[2] = {probe ? "point" : "from", "to"};
    const int quantity = probe ? ((const struct scene_probe *)(const void *)common)->quantity : 0;
    double end[2][2];
    char text[SCENE_NAME + 100] = "";
    int n = 0;
    if (probe) snprintf(text, sizeof text, "%s", quantity_table[quantity].name);
    for (int k = 0; k < 2; k++)
        if (scene_given(g->scene, id, common->index, keys[k])) {
            memcpy(end[n], (const char *)common + param_find(id, keys[k])->offset, sizeof end[0]);
            put_circle(g, end[n]);
            snprintf(text + strlen(text), 50, "%s(%g, %g) m",
                     n       ? " to "
                     : *text ? " at "
                             : "at ",
                     end[n][0], end[n][1]);
            n++;
        }
    if (n == 2) put_path(g, "mark", 2, end, "#000");
    put_legend(g, n > 0 ? end[0] : NULL, 8, common, text);
}

static void put_sections(struct drawing *g)
{
    static const enum kind kinds[] = {KIND_WALL, KIND_FLUID, KIND_SOLID};
    static const enum section_id marks[] = {SECTION_spring, SECTION_damping, SECTION_inflow,
                                            SECTION_outflow, SECTION_probe};
    for (size_t s = 0; s < COUNT_OF(kinds); s++)
        for (int k = 0; k < section_count(g->scene, sections[kinds[s]]); k++)
            put_body(g, kinds[s], k);
    for (size_t s = 0; s < COUNT_OF(marks); s++)
        for (int k = 0; k < section_count(g->scene, marks[s]); k++)
            put_mark(g, section_at(g->scene, marks[s], k));
}

/* Ticks at 1, 2 or 5 times a power of ten, some eight on the longer side. */
static void put_axes(struct drawing *g)
{
    const struct pixel low = pixel_of(g, g->view.low[0], g->view.low[1]),
                       high = pixel_of(g, g->view.high[0], g->view.high[1]);
    const double raw = DRAWING / g->scale / 8, power = pow(10, floor(log10(raw)));
    const double digit = raw / power;
    const double step = power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
    char text[32];
    fprintf(g->file, "<rect class=\"frame\" x=\"%.1f\" y=\"%d\" width=\"%.1f\" height=\"%.1f\"/>\n",
            low.x, HEAD, high.x - low.x, low.y - HEAD);
    for (int c = 0; c < 2; c++)
        for (double k = ceil(g->view.low[c] / step); k * step <= g->view.high[c]; k++) {
            const struct pixel at =
                pixel_of(g, c ? g->view.low[0] : k * step, c ? k * step : g->view.low[1]);
            fprintf(g->file, "<path class=\"tick\" d=\"M%.1f %.1f%s\"/>\n", at.x, at.y,
                    c ? "h-6" : "v6");
            snprintf(text, sizeof text, "%.6g", k == 0 ? 0 : k * step);
            put_text(g, c ? at.x - 9 : at.x, c ? at.y + 4 : at.y + 19, c ? "end" : "middle", text);
        }
}

/* The size of the sheet and the view, once all has been drawn. */
static void put_head(struct drawing *g)
{
    const struct scene *const scene = g->scene;
    const struct box2 all = g->drawn;
    const double longer = max2(all.high[0] - all.low[0], all.high[1] - all.low[1]);
    const double pad = max2(3 * scene->top.dp, 0.02 * longer);
    char text[300];
    for (int c = 0; c < 2; c++)
        g->view.low[c] = all.low[c] - pad, g->view.high[c] = all.high[c] + pad;
    g->scale = DRAWING / (longer + 2 * pad);
    fprintf(g->file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%.0f\">\n"
            "%s<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
            LEFT + DRAWING + RIGHT, legend_line(g, g->n_listed + 1), style);
    put_text(g, LEFT, 22, "title", scene->top.title[0] ? scene->top.title : scene->path);
    snprintf(text, sizeof text, "Lengths in m; dp %g m, h %g m, gravity (%g, %g) m/s^2, %g s",
             scene->top.dp, scene->h, scene->top.gravity[0], scene->top.gravity[1],
             scene->top.end_time);
    put_text(g, LEFT, 42, "", text);
}

/* The scene is drawn twice: what is drawn first gives the view of the second drawing. */
static enum err draw_case(struct session *session, const struct sphfsi_options *o, struct diag *d)
{
    char path[PATH_BYTES], *first = NULL;
    size_t size;
    int length;
    const char *const name = session_name(o, &length);
    if (o->out)
        snprintf(path, sizeof path, "%s", o->out);
    else
        snprintf(path, sizeof path, "preview-%.*s.svg", length, name);
    struct drawing g = {.scene = &session->scene, .drawn = box2_empty(), .scale = 1};
    g.file = open_memstream(&first, &size);
    if (!g.file) return diag_fail(d, ERR_MEMORY, "preview: no memory");
    put_sections(&g);
    fclose(g.file);
    free(first);
    g.file = fopen(path, "w");
    if (!g.file) return diag_fail(d, ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
    put_head(&g);
    g.n_listed = 0;
    put_sections(&g);
    put_axes(&g);
    fputs("</svg>\n", g.file);
    const bool failed = ferror(g.file);
    if (fclose(g.file) != 0 || failed)
        return diag_fail(d, ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
    session_say(o, "%s: picture of the case at the start; open it in a browser", path);
    return ERR_OK;
}

enum sphfsi_status sphfsi_preview(const struct sphfsi_options *options)
{
    return call_of_case("preview", options, false, draw_case);
}
