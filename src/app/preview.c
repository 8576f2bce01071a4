/* SPDX-License-Identifier: MIT
 * --preview: an SVG of the scene before it runs. */
#include "app/session.h"
#include "base/files.h"

#include <errno.h>

/* Pixels: the longer side of the drawing, its margin, a line of text. */
enum { DRAWING = 1000, MARGIN = 70, LINE = 18 };

struct drawing {
    FILE *file;
    const struct scene *scene;
    struct box2 view;       /* m */
    double scale;           /* pixels per m */
    int n_listed, n_placed; /* lines of the legend, numbers in the drawing so far */
    double x[8 * SCENE_MAX_SECTIONS], y[8 * SCENE_MAX_SECTIONS]; /* of the numbers, pixels */
};

/* Colours are those of Okabe and Ito, for colour-blind readers. */
static const char style[] =
    "<style>svg{background:#fff}text{font:13px sans-serif}.title{font:bold 16px sans-serif}"
    ".middle,.label{text-anchor:middle}.end{text-anchor:end}.label{font-weight:bold;"
    "paint-order:stroke;stroke:#fff;stroke-width:4px}path{stroke:#000;fill:none}"
    ".point{stroke-width:9;stroke-linecap:round}.line{stroke-width:3}.grid{stroke-width:0.4}"
    ".body{stroke-linecap:square}.fluid{stroke:#56B4E9}.wall{stroke:#999999}"
    ".solid{stroke:#E69F00}.moving{stroke:#CC79A7}.clamped{stroke:#D55E00}</style>\n";

/* Pixels from the left of the sheet (axis 0) or from its top. */
static double px(const struct drawing *g, int axis, double at)
{
    return MARGIN + (axis ? g->view.high[1] - at : at - g->view.low[0]) * g->scale;
}

static void put_text(struct drawing *g, double x, double y, const char *class, const char *text)
{
    fprintf(g->file, "<text x=\"%.1f\" y=\"%.1f\" class=\"%s\">", x, y, class);
    for (char one[2] = ""; (one[0] = *text); text++)
        fputs(*one == '&' ? "&amp;" : *one == '<' ? "&lt;" : one, g->file);
    fputs("</text>\n", g->file);
}

/* `width` of the stroke, m; 0: that of its class. */
static void put_path(struct drawing *g, const char *class, const char *of, double width, int n,
                     double (*pt)[2])
{
    fprintf(g->file, "<path class=\"%s %s\" ", class, of);
    if (width > 0) fprintf(g->file, "style=\"stroke-width:%.2f\" ", max2(1, width * g->scale));
    fputs("d=\"", g->file);
    for (int k = 0; k < n; k++) {
        fprintf(g->file, "%c%.1f %.1f", k ? 'L' : 'M', px(g, 0, pt[k][0]), px(g, 1, pt[k][1]));
        box2_include(&g->view, pt[k][0], pt[k][1]);
    }
    fputs("h.01\"/>\n", g->file);
}

/* A line of the legend, and its number beside a place. Places whose numbers overlap share one. */
static void put_legend(struct drawing *g, const double *place,
                       const struct scene_section_common *of, const char *what)
{
    char number[16] = "", text[300];
    if (place) {
        const double x = px(g, 0, place[0]) - 10, y = px(g, 1, place[1]) + 13;
        int k = 0;
        while (k < g->n_placed && hypot(x - g->x[k], y - g->y[k]) >= LINE) k++;
        snprintf(number, sizeof number, "%d", k + 1);
        if (k == g->n_placed) put_text(g, g->x[k] = x, g->y[k] = y, "label", number), g->n_placed++;
    }
    snprintf(text, sizeof text, "%s  %s %s%s%s", number, section_table[of->section].word, of->name,
             *what ? ": " : "", what);
    put_text(g, MARGIN, px(g, 1, g->view.low[1]) + MARGIN + LINE * ++g->n_listed, "", text);
}

/* The particles of a body, held by a clamp or not, but those of thin lines, as squares. Returns
 * whether there are any, and the place of the last one. */
static bool put_particles(struct drawing *g, enum kind kind, int body, bool held, const char *class,
                          double place[2])
{
    const struct scene_points *const p = &g->scene->points[kind];
    const double side = kind == KIND_SOLID ? g->scene->solid_lattice[body].dp : g->scene->top.dp;
    bool any = false;
    fprintf(g->file, "<path class=\"body %s\" stroke-width=\"%.2f\" d=\"", class, side * g->scale);
    for (int64_t i = 0; i < p->n; i++) {
        const bool thin = kind == KIND_WALL && scene_thin_line_of(g->scene, i);
        if (p->body[i] != body || (p->clamped && p->clamped[i]) != held || thin) continue;
        box2_include(&g->view, p->x[i], p->y[i]);
        fprintf(g->file, "M%.1f %.1fh.01", px(g, 0, p->x[i]), px(g, 1, p->y[i]));
        place[0] = p->x[i], place[1] = p->y[i];
        any = true;
    }
    fputs("\"/>\n", g->file);
    return any;
}

static void put_body(struct drawing *g, enum kind kind, int body,
                     const struct scene_section_common *common)
{
    const enum section_id id = (enum section_id)common->section;
    const bool moves = kind == KIND_WALL && *g->scene->wall[body].motion;
    const struct shape_list *const lines =
        (const void *)((const char *)common + param_find(id, "shape")->offset);
    const char *const class = moves ? "moving" : kind_names[kind];
    double place[2] = {g->view.low[0], g->view.low[1]};
    for (const struct shape *line = lines->item; line < lines->item + lines->n; line++) {
        if (id != SECTION_beam && !line->thin) continue;
        const double thickness = id == SECTION_beam ? g->scene->beam[common->index].thickness : 0;
        put_path(g, "line", class, thickness, line->n, line->pt);
        memcpy(place, line->pt[line->n / 2], sizeof place);
    }
    const bool held = put_particles(g, kind, body, true, "clamped", place);
    put_particles(g, kind, body, false, class, place);
    put_legend(g, place, common, held ? "clamped where dark" : "");
}

/* Marks a section that has one or two points, as far as the case gives them. */
static void put_mark(struct drawing *g, const struct scene_section_common *common)
{
    const enum section_id id = (enum section_id)common->section;
    const struct scene_probe *const probe = id == SECTION_probe ? (const void *)common : NULL;
    const char *const keys[] = {probe ? "point" : "from", "to"};
    double end[2][2];
    int n = 0;
    for (size_t k = 0; k < COUNT_OF(keys); k++) {
        if (!scene_given(g->scene, id, common->index, keys[k])) continue;
        memcpy(end[n], (const char *)common + param_find(id, keys[k])->offset, sizeof end[n]);
        put_path(g, "point", "", 0, 1, &end[n++]);
    }
    put_path(g, "line", "", 0, n, end);
    put_legend(g, n > 0 ? end[0] : NULL, common, probe ? quantity_table[probe->quantity].name : "");
}

static void put_sections(struct drawing *g)
{
    static const enum section_id id[] = {SECTION_fluid,   SECTION_wall,    SECTION_solid,
                                         SECTION_spring,  SECTION_damping, SECTION_inflow,
                                         SECTION_outflow, SECTION_probe};
    g->n_listed = g->n_placed = 0;
    for (size_t s = 0; s < COUNT_OF(id); s++)
        for (int k = 0; k < section_count(g->scene, id[s]); k++) {
            const struct scene_section_common *of = section_at(g->scene, id[s], k);
            of = section_at(g->scene, (enum section_id)of->section, of->index); /* of a [rigid] */
            if (s < KIND_COUNT) /* in the order of enum kind */
                put_body(g, (enum kind)s, k, of);
            else
                put_mark(g, of);
        }
}

/* A grid at 1, 2 or 5 times a power of ten, at most twelve lines on the longer side. */
static void put_grid(struct drawing *g)
{
    const double least = DRAWING / g->scale / 12, power = pow(10, ceil(log10(least)));
    const double step = power * (least < 0.2 * power ? 0.2 : least < 0.5 * power ? 0.5 : 1);
    char text[32];
    for (int c = 0; c < 2; c++)
        for (double k = ceil(g->view.low[c] / step); k * step <= g->view.high[c]; k++) {
            double end[2][2];
            memcpy(end, &g->view, sizeof end);
            end[0][c] = end[1][c] = k == 0 ? 0 : k * step;
            put_path(g, "grid", "", 0, 2, end);
            snprintf(text, sizeof text, "%.6g m", end[0][c]);
            put_text(g, px(g, 0, end[0][0]) - (c ? 9 : 0), px(g, 1, end[0][1]) + (c ? 4 : 19),
                     c ? "end" : "middle", text);
        }
}

/* Once all has been drawn, which gives the view. */
static void put_picture(struct drawing *g)
{
    struct box2 *const view = &g->view;
    const double longer = max2(view->high[0] - view->low[0], view->high[1] - view->low[1]);
    const double pad = max2(3 * g->scene->top.dp, 0.02 * longer);
    for (int c = 0; c < 2; c++) view->low[c] -= pad, view->high[c] += pad;
    g->scale = DRAWING / (longer + 2 * pad);
    fprintf(g->file, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%.0f\">\n%s",
            DRAWING + 2 * MARGIN, px(g, 1, view->low[1]) + MARGIN + LINE * (g->n_listed + 1),
            style);
    put_text(g, MARGIN, 42, "title", *g->scene->top.title ? g->scene->top.title : g->scene->path);
    put_grid(g);
    put_sections(g);
    fputs("</svg>\n", g->file);
}

static enum err draw_case(struct session *session, const struct sphfsi_options *o, struct diag *d)
{
    char path[PATH_BYTES];
    int length;
    const char *const name = session_name(o, &length);
    struct drawing g = {.scene = &session->scene, .view = box2_empty()};
    snprintf(path, sizeof path, "preview-%.*s.svg", length, name);
    if (o->out) snprintf(path, sizeof path, "%s", o->out);
    g.file = fopen(path, "w");
    if (g.file) put_sections(&g), g.file = freopen(path, "w", g.file);
    if (g.file) put_picture(&g);
    const bool ok = g.file && !ferror(g.file);
    if ((g.file && fclose(g.file) != 0) || !ok)
        return diag_fail(d, ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
    session_say(o, "%s: picture of the case at the start; open it in a browser", path);
    return ERR_OK;
}

enum sphfsi_status sphfsi_preview(const struct sphfsi_options *options)
{
    return call_of_case("preview", options, false, draw_case);
}
