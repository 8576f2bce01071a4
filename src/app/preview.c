/* SPDX-License-Identifier: MIT */
#include "app/preview.h"

#include "case/params.h"
#include "particles/particles.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Pixels: the drawing, its margins, a line of text, the width of a letter. */
enum { DRAWING = 1000, LEFT = 70, RIGHT = 30, HEAD = 60, FOOT = 52, LINE = 18, LETTER = 7 };
enum { MAX_LABELS = 256 };

struct box {
    double x0, y0, x1, y1;
};

struct drawing {
    FILE *file;
    const struct scene *s;
    struct box view; /* m */
    double scale;    /* pixels per m */
    int n_labels;
    struct box label[MAX_LABELS]; /* pixels, rectangles of the labels so far */
};

/* The palette of Okabe and Ito, for colour-blind readers. */
static const char *const fills[KIND_COUNT] = {"#56B4E9", "#999999", "#E69F00"};

static double px(const struct drawing *g, double x) { return LEFT + (x - g->view.x0) * g->scale; }

static double py(const struct drawing *g, double y) { return HEAD + (g->view.y1 - y) * g->scale; }

static void put_escaped(FILE *file, const char *text)
{
    for (; *text; text++) {
        if (*text == '&')
            fputs("&amp;", file);
        else if (*text == '<')
            fputs("&lt;", file);
        else
            fputc(*text, file);
    }
}

static void put_text(const struct drawing *g, double x, double y, const char *class,
                     const char *text)
{
    fprintf(g->file, "<text x=\"%.1f\" y=\"%.1f\" class=\"%s\">", x, y, class);
    put_escaped(g->file, text);
    fputs("</text>\n", g->file);
}

/* --- labels --- */

static bool overlaps_label(const struct drawing *g, struct box b)
{
    for (int k = 0; k < g->n_labels; k++) {
        const struct box *o = &g->label[k];
        if (b.x0 < o->x1 && b.x1 > o->x0 && b.y0 < o->y1 && b.y1 > o->y0) return true;
    }
    return false;
}

/* Writes a name next to a point in pixels, moved up or down until it overlaps no other. */
static void put_label(struct drawing *g, double x, double y, const char *name)
{
    const double width = LETTER * (double)strlen(name) + 6;
    if (x + width > LEFT + DRAWING + RIGHT) x -= width + 10;
    struct box b = {x, y - 10, x + width, y + 4};
    for (int k = 1; k < 16 && overlaps_label(g, b); k++) {
        const int row = (k + 1) / 2; /* 1, 1, 2, 2, ...: alternately above and below */
        const double shift = (k % 2 ? 15 : -15) * row;
        b.y0 = y - 10 + shift;
        b.y1 = y + 4 + shift;
    }
    if (g->n_labels < MAX_LABELS) g->label[g->n_labels++] = b;
    put_text(g, x, b.y1 - 4, "label", name);
}

/* --- bodies as rows of particles --- */

struct lattice_site {
    int64_t row, column; /* of the lattice of the body */
};

static int compare_sites(const void *a, const void *b)
{
    const struct lattice_site *const p = a, *const q = b;
    if (p->row != q->row) return p->row < q->row ? -1 : 1;
    return p->column < q->column ? -1 : p->column > q->column;
}

static const struct scene_lattice *lattice_of(const struct scene *s, enum kind kind, int body)
{
    return kind == KIND_SOLID ? &s->solid_lattice[body] : &s->lattice;
}

/* A rectangle with its lower left corner in the axes of a lattice. */
static void put_rectangle(const struct drawing *g, const struct scene_lattice *l, double x,
                          double y, double wide, double high)
{
    double at[4][2];
    for (int k = 0; k < 4; k++)
        place_of_lattice(l, x + (k == 1 || k == 2 ? wide : 0), y + (k > 1 ? high : 0), at[k]);
    fprintf(g->file, "M%.2f %.2fL%.2f %.2fL%.2f %.2fL%.2f %.2fz", px(g, at[0][0]), py(g, at[0][1]),
            px(g, at[1][0]), py(g, at[1][1]), px(g, at[2][0]), py(g, at[2][1]), px(g, at[3][0]),
            py(g, at[3][1]));
}

/* The particles of a body, clamped or not, by their cells; false: some are not at the middle of a cell. */
static bool collect(const struct scene_points *p, int body, int clamped,
                    const struct scene_lattice *l, struct lattice_site *site, int64_t *n)
{
    bool all = true;
    *n = 0;
    for (int64_t i = 0; i < p->n; i++) {
        if (p->body[i] != body || (p->clamped && p->clamped[i]) != clamped) continue;
        double at[2], cell[2];
        lattice_place(l, p->x[i], p->y[i], at);
        for (int c = 0; c < 2; c++) {
            const double cells = (at[c] - l->origin[c]) / l->spacing[c] - 0.5;
            cell[c] = round(cells);
            all &= fabs(cells - cell[c]) < 0.01;
        }
        site[(*n)++] = (struct lattice_site){(int64_t)cell[1], (int64_t)cell[0]};
    }
    if (all) qsort(site, (size_t)*n, sizeof *site, compare_sites);
    return all;
}

/* One rectangle for each row of neighbours, in one path. */
static void put_rows(const struct drawing *g, const struct scene_lattice *l,
                     const struct lattice_site *site, int64_t n)
{
    for (int64_t k = 0, end; k < n; k = end) {
        for (end = k + 1; end < n && site[end].row == site[k].row &&
                          site[end].column == site[end - 1].column + 1;
             end++) {
        }
        put_rectangle(g, l, l->origin[0] + (double)site[k].column * l->spacing[0],
                      l->origin[1] + (double)site[k].row * l->spacing[1],
                      (double)(end - k) * l->spacing[0], l->spacing[1]);
    }
}

/* One rectangle for each particle that lies on no lattice. */
static void put_singles(const struct drawing *g, const struct scene_lattice *l,
                        const struct scene_points *p, int body, int clamped)
{
    for (int64_t i = 0; i < p->n; i++) {
        if (p->body[i] != body || (p->clamped && p->clamped[i]) != clamped) continue;
        double at[2];
        lattice_place(l, p->x[i], p->y[i], at);
        put_rectangle(g, l, at[0] - 0.5 * l->spacing[0], at[1] - 0.5 * l->spacing[1], l->spacing[0],
                      l->spacing[1]);
    }
}

/* The box around a body's cells, in the axes of a lattice. */
static struct box body_box(const struct scene_points *p, int body, const struct scene_lattice *l,
                           int64_t *n)
{
    struct box b = {HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    const double dx = l->spacing[0], dy = l->spacing[1];
    *n = 0;
    for (int64_t i = 0; i < p->n; i++) {
        if (p->body[i] != body) continue;
        double at[2];
        lattice_place(l, p->x[i], p->y[i], at);
        b.x0 = min2(b.x0, at[0] - dx / 2), b.x1 = max2(b.x1, at[0] + dx / 2);
        b.y0 = min2(b.y0, at[1] - dy / 2), b.y1 = max2(b.y1, at[1] + dy / 2);
        ++*n;
    }
    return b;
}

static const enum section_id sections[KIND_COUNT] = {SECTION_fluid, SECTION_wall, SECTION_solid};

static const char *body_name(const struct scene *s, enum kind kind, int body)
{
    const struct scene_section_common *common = section_at(s, sections[kind], body);
    return common->name;
}

static void put_body(struct drawing *g, enum kind kind, int body, struct lattice_site *site)
{
    const struct scene_points *const p = &g->s->points[kind];
    const bool moves = kind == KIND_WALL && g->s->wall[body].motion[0];
    char style[64];
    snprintf(style, sizeof style, "fill=\"%s\"", moves ? "#CC79A7" : fills[kind]);
    for (int clamped = 0; clamped < 2; clamped++) {
        const struct scene_lattice *const l = lattice_of(g->s, kind, body);
        int64_t n;
        const bool rows = collect(p, body, clamped, l, site, &n);
        if (n == 0) continue;
        fprintf(g->file, "<path %s d=\"",
                clamped ? "fill=\"url(#clamp)\" stroke=\"#000\" stroke-width=\"0.3\"" : style);
        if (rows)
            put_rows(g, l, site, n);
        else
            put_singles(g, l, p, body, clamped);
        fputs("\"/>\n", g->file);
    }
}

/* Writes a name: in the middle of a fluid, next to the particle in the middle of a body. */
static void name_body(struct drawing *g, enum kind kind, int body)
{
    const struct scene_points *const p = &g->s->points[kind];
    int64_t n, at = 0;
    double nearest = HUGE_VAL;
    const struct scene_lattice upright = {.spacing = {g->s->top.dp, g->s->top.dp}};
    const struct box b = body_box(p, body, &upright, &n);
    if (n == 0) return;
    for (int64_t i = 0; i < p->n; i++) {
        const double away = hypot(p->x[i] - 0.5 * (b.x0 + b.x1), p->y[i] - 0.5 * (b.y0 + b.y1));
        if (p->body[i] != body || away >= nearest) continue;
        nearest = away;
        at = i;
    }
    const char *name = body_name(g->s, kind, body);
    const bool inside = kind == KIND_FLUID;
    const double wide = LETTER * (double)strlen(name);
    if (inside)
        put_label(g, 0.5 * (px(g, b.x0) + px(g, b.x1) - wide), 0.5 * (py(g, b.y0) + py(g, b.y1)),
                  name);
    else
        put_label(g, px(g, p->x[at]) + 6, py(g, p->y[at]) + 4, name);
}

/* --- probes --- */

static bool has_position(const struct scene_probe *probe)
{
    const enum probe_target target = scene_probe_target(probe);
    return target == TARGET_SOLID_POINT || target == TARGET_FLUID_POINT ||
           target == TARGET_FLUID_LINE;
}

static void put_probe(struct drawing *g, const struct scene_probe *probe)
{
    const double x = px(g, probe->point[0]), y = py(g, probe->point[1]);
    if (!has_position(probe)) return;
    if (scene_probe_target(probe) == TARGET_FLUID_LINE)
        fprintf(g->file, "<path class=\"probe\" d=\"M%.1f %.1fL%.1f %.1f\"/>\n", x, y,
                px(g, probe->to[0]), py(g, probe->to[1]));
    if (probe->quantity == PROBE_LEVEL)
        fprintf(g->file, "<path class=\"level\" d=\"M%.1f %.1fV%d\"/>\n", x, y, HEAD);
    fprintf(g->file, "<circle class=\"probe\" cx=\"%.1f\" cy=\"%.1f\" r=\"4\"/>\n", x, y);
    put_label(g, x + 7, y - 5, probe->common.name);
}

/* --- axes --- */

/* 1, 2 or 5 times a power of ten, for some eight ticks. */
static double tick_step(double length)
{
    const double raw = length / 8, power = pow(10, floor(log10(raw))), digit = raw / power;
    return power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
}

static void put_axes(const struct drawing *g)
{
    const struct box *v = &g->view;
    const double x0 = px(g, v->x0), x1 = px(g, v->x1), y0 = py(g, v->y0), y1 = py(g, v->y1);
    const double step = tick_step(max2(v->x1 - v->x0, v->y1 - v->y0));
    char text[32];
    fprintf(g->file,
            "<rect class=\"frame\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n", x0,
            y1, x1 - x0, y0 - y1);
    for (double k = ceil(v->x0 / step); k * step <= v->x1; k++) {
        const double x = px(g, k * step);
        fprintf(g->file, "<path class=\"tick\" d=\"M%.1f %.1fv6\"/>\n", x, y0);
        snprintf(text, sizeof text, "%.6g", k == 0 ? 0 : k * step);
        put_text(g, x, y0 + 19, "middle", text);
    }
    for (double k = ceil(v->y0 / step); k * step <= v->y1; k++) {
        const double y = py(g, k * step);
        fprintf(g->file, "<path class=\"tick\" d=\"M%.1f %.1fh-6\"/>\n", x0, y);
        snprintf(text, sizeof text, "%.6g", k == 0 ? 0 : k * step);
        put_text(g, x0 - 9, y + 4, "end", text);
    }
    put_text(g, 0.5 * (x0 + x1), y0 + 38, "middle", "x (m)");
    put_text(g, x0 - 9, y1 - 8, "end", "y (m)");
}

/* --- the list below --- */

static const double degrees = 180 / PI;

static int describe(const struct scene *s, enum kind kind, int body, char *text, size_t size)
{
    int64_t n;
    const struct scene_lattice *const l = lattice_of(s, kind, body);
    const struct box b = body_box(&s->points[kind], body, l, &n);
    int at = snprintf(text, size, "%s %s: %.4g x %.4g m", kind_names[kind],
                      body_name(s, kind, body), n ? b.x1 - b.x0 : 0, n ? b.y1 - b.y0 : 0);
    if (l->angle != 0)
        at += snprintf(text + at, size - (size_t)at, " at %.4g degrees", l->angle * degrees);
    at += snprintf(text + at, size - (size_t)at, ", %lld particles", (long long)n);
    if (l->dp != s->top.dp)
        at += snprintf(text + at, size - (size_t)at, " of %.4g x %.4g m", l->spacing[0],
                       l->spacing[1]);
    char *const rest = text + at;
    const size_t left = size - (size_t)at;
    if (kind == KIND_FLUID) return snprintf(rest, left, "; %g kg/m^3, c0 %.4g m/s", s->rho0, s->c0);
    if (kind == KIND_WALL) {
        const char *const motion = s->wall[body].motion;
        return snprintf(rest, left, motion[0] ? "; moved by %s" : "; at rest", motion);
    }
    const struct scene_solid *const m = &s->solid[body];
    const struct scene_points *const p = &s->points[KIND_SOLID];
    int64_t clamped = 0;
    for (int64_t i = 0; i < p->n; i++) clamped += p->body[i] == body && p->clamped && p->clamped[i];
    const int written =
        snprintf(rest, left, "; %g kg/m^3, E %.4g Pa, nu %g; ", m->density, m->young, m->poisson);
    char clamps[48] = "", bond[sizeof m->joined + 16] = "";
    if (clamped) snprintf(clamps, sizeof clamps, "%lld clamped (hatched)", (long long)clamped);
    if (m->joined[0]) snprintf(bond, sizeof bond, "bonded to %s", m->joined);
    const char *const held = clamped || m->joined[0] ? "" : "nothing clamped";
    char area[32] = "";
    if (fabs(l->area_error) >= 5e-5)
        snprintf(area, sizeof area, "; area %+.2f %%", 100 * l->area_error);
    return snprintf(rest + written, left - (size_t)written, "%s%s%s%s%s", held, clamps,
                    clamped && m->joined[0] ? ", " : "", bond, area);
}

static void describe_probe(const struct scene_probe *p, char *text, size_t size)
{
    char quantity[SCENE_NAME], place[128] = "";
    param_choice_name(param_find(SECTION_probe, "quantity"), p->quantity, quantity);
    if (scene_probe_target(p) == TARGET_FLUID_LINE)
        snprintf(place, sizeof place, " from (%g, %g) to (%g, %g) m", p->point[0], p->point[1],
                 p->to[0], p->to[1]);
    else if (has_position(p))
        snprintf(place, sizeof place, " at (%g, %g) m", p->point[0], p->point[1]);
    snprintf(text, size, "probe %s: %s%s%s%s%s%s", p->common.name, quantity,
             p->body[0] ? " of " : "", p->body, place, p->on[0] ? ", moves with " : "", p->on);
}

static void put_list(const struct drawing *g, double y)
{
    char text[1024];
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int k = 0; k < section_count(g->s, sections[kind]); k++, y += LINE) {
            const bool moves = kind == KIND_WALL && g->s->wall[k].motion[0];
            fprintf(g->file, "<rect x=\"%d\" y=\"%.1f\" width=\"12\" height=\"12\" fill=\"%s\"/>\n",
                    LEFT, y - 11, moves ? "#CC79A7" : fills[kind]);
            describe(g->s, (enum kind)kind, k, text, sizeof text);
            put_text(g, LEFT + 20, y, "", text);
        }
    for (int k = 0; k < g->s->n_probe; k++, y += LINE) {
        if (has_position(&g->s->probe[k]))
            fprintf(g->file, "<circle class=\"probe\" cx=\"%d\" cy=\"%.1f\" r=\"4\"/>\n", LEFT + 6,
                    y - 5);
        describe_probe(&g->s->probe[k], text, sizeof text);
        put_text(g, LEFT + 20, y, "", text);
    }
}

/* --- all layers --- */

static void widen(struct box *v, double x, double y)
{
    v->x0 = min2(v->x0, x), v->x1 = max2(v->x1, x);
    v->y0 = min2(v->y0, y), v->y1 = max2(v->y1, y);
}

static struct box find_view(const struct scene *s)
{
    struct box v = {HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int64_t i = 0; i < s->points[kind].n; i++)
            widen(&v, s->points[kind].x[i], s->points[kind].y[i]);
    for (int k = 0; k < s->n_probe; k++) {
        const enum probe_target target = scene_probe_target(&s->probe[k]);
        if (target == TARGET_FLUID_LINE) widen(&v, s->probe[k].to[0], s->probe[k].to[1]);
        if (target == TARGET_FLUID_LINE || target == TARGET_FLUID_POINT)
            widen(&v, s->probe[k].point[0], s->probe[k].point[1]);
    }
    const double pad = max2(2 * s->top.dp, 0.02 * max2(v.x1 - v.x0, v.y1 - v.y0));
    return (struct box){v.x0 - pad, v.y0 - pad, v.x1 + pad, v.y1 + pad};
}

static void put_head(const struct drawing *g, double width, double height)
{
    const struct scene *s = g->s;
    char text[256];
    fprintf(g->file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" "
            "viewBox=\"0 0 %.0f %.0f\">\n",
            width, height, width, height);
    fputs("<style>text{font:13px sans-serif}.title{font-size:16px;font-weight:bold}"
          ".middle{text-anchor:middle}.end{text-anchor:end}"
          ".label{paint-order:stroke;stroke:#fff;stroke-width:4px;stroke-linejoin:round}"
          ".frame{fill:none;stroke:#000;stroke-width:0.7}.tick{stroke:#000;stroke-width:0.7}"
          ".probe{fill:#fff;stroke:#000;stroke-width:1.6}"
          ".level{stroke:#000;stroke-dasharray:4 4}</style>\n"
          "<defs><pattern id=\"clamp\" width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\">"
          "<rect width=\"6\" height=\"6\" fill=\"#E69F00\"/>"
          "<path d=\"M0 6L6 0M-1 1L1 -1M5 7L7 5\" stroke=\"#000\"/></pattern></defs>\n",
          g->file);
    fprintf(g->file, "<rect width=\"%.0f\" height=\"%.0f\" fill=\"#fff\"/>\n", width, height);
    put_text(g, LEFT, 22, "title", s->top.title[0] ? s->top.title : s->path);
    snprintf(text, sizeof text,
             "dp %g m, h %g m, gravity (%g, %g) m/s^2, %g s; domain (%.4g, %.4g) to (%.4g, %.4g) m",
             s->top.dp, s->h, s->top.gravity[0], s->top.gravity[1], s->top.end_time,
             s->domain_lower[0], s->domain_lower[1], s->domain_upper[0], s->domain_upper[1]);
    put_text(g, LEFT, 42, "", text);
}

static void put_all(struct drawing *g, struct lattice_site *site)
{
    const int rows = g->s->n_fluid + g->s->n_wall + g->s->n_solid + g->s->n_probe;
    const double bottom = py(g, g->view.y0) + FOOT;
    put_head(g, LEFT + DRAWING + RIGHT, bottom + rows * LINE + 20);
    static const enum kind order[KIND_COUNT] = {KIND_WALL, KIND_FLUID, KIND_SOLID};
    for (int k = 0; k < KIND_COUNT; k++)
        for (int body = 0; body < section_count(g->s, sections[order[k]]); body++)
            put_body(g, order[k], body, site);
    put_axes(g);
    for (int k = 0; k < g->s->n_probe; k++) put_probe(g, &g->s->probe[k]);
    for (int k = 0; k < KIND_COUNT; k++)
        for (int body = 0; body < section_count(g->s, sections[order[k]]); body++)
            name_body(g, order[k], body);
    put_list(g, bottom + LINE);
    fputs("</svg>\n", g->file);
}

enum err preview_draw(const struct scene *s, const char *path, struct diag *d)
{
    int64_t most = 1;
    for (int kind = 0; kind < KIND_COUNT; kind++)
        most = most > s->points[kind].n ? most : s->points[kind].n;
    struct lattice_site *const site = malloc((size_t)most * sizeof *site);
    if (!site)
        return diag_fail(d, ERR_MEMORY, "%s: no memory for %lld particles", path, (long long)most);
    struct drawing g = {.s = s, .view = find_view(s), .file = fopen(path, "w")};
    /* The longer side of the scene gets DRAWING pixels. */
    g.scale = DRAWING / max2(g.view.x1 - g.view.x0, g.view.y1 - g.view.y0);
    bool ok = g.file != NULL;
    if (ok) {
        put_all(&g, site);
        ok = !ferror(g.file);
        ok = fclose(g.file) == 0 && ok;
    }
    free(site);
    return ok ? ERR_OK : diag_fail(d, ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
}
