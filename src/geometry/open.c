/* SPDX-License-Identifier: MIT
 * Buffers of [inflow] and [outflow] sections: rows of particles behind the line, a spacing
 * apart. */
#include "geometry/sampling.h"
#include "base/point_grid.h"

/* Largest distance of a fluid particle from its expected position, in spacings. */
#define NEXT_TO 1.5

static enum err refuse(const struct sampler *sampler, const struct scene_open *o, const char *what,
                       const double x[2], const char *mend)
{
    return fail_at(sampler->diag, sampler->scene, o->common->line, "%s %s at (%.6g, %.6g) m: %s",
                   section_title(o->common).text, what, x[0], x[1], mend);
}

/* Whether a point lies in a boundary's buffer, and further from its edges than round-off. */
static bool in_buffer(const struct scene *scene, const struct scene_open *o, const double x[2])
{
    const double nothing = 1e-6 * scene->top.dp;
    double in, along;
    scene_open_place(o, x, &in, &along);
    return in < -nothing && in > nothing - o->depth && along > nothing &&
           along < o->length - nothing;
}

/* Positions across the line and rows behind it. */
struct lattice {
    int across, rows;
    double step; /* m, along the line */
};

static struct lattice lattice_of(const struct scene *scene, const struct scene_open *o)
{
    const double most = 1e9; /* more than is accepted, but an integer */
    struct lattice l = {(int)min2(most, max2(1, round(o->length / scene->top.dp))),
                        (int)round(o->depth / scene->top.dp), 0};
    l.step = o->length / l.across;
    return l;
}

/* Position i of row j; row -1 is the first one inside the fluid. False: above the water. */
static bool lattice_point(const struct scene *scene, const struct scene_open *o,
                          const struct lattice *l, int i, int j, double x[2])
{
    const double along = (i + 0.5) * l->step, in = -(j + 0.5) * scene->top.dp;
    for (int c = 0; c < 2; c++) x[c] = o->from[c] + along * o->along[c] + in * o->inward[c];
    return isnan(o->level) || x[1] < o->level;
}

/* Fluid behind the line at the start, and a line without fluid at it. */
static enum err check_fluid(struct sampler *sampler, const struct scene_open *o)
{
    const struct scene_points *const p = &sampler->scene->points[KIND_FLUID];
    const struct lattice l = lattice_of(sampler->scene, o);
    const double near = NEXT_TO * sampler->scene->top.dp;
    struct point_grid fluid;
    TRY(point_grid_create(&fluid, near, p->n, p->x, p->y, &sampler->temp, sampler->diag));
    for (int64_t k = 0; k < p->n; k++) {
        const double x[2] = {p->x[k], p->y[k]};
        if (p->open[k] == 0 && in_buffer(sampler->scene, o, x))
            return refuse(sampler, o, "has fluid behind its line", x,
                          "end the fluid's shape at the line, or change `side`");
        point_grid_insert(&fluid, k);
    }
    int wet = 0, places = 0;
    double x[2] = {o->from[0], o->from[1]};
    for (int i = 0; i < l.across; i++) {
        if (!lattice_point(sampler->scene, o, &l, i, -1, x)) continue;
        places++;
        wet += point_grid_any(&fluid, x[0], x[1], near);
    }
    if (places > 0 && 2 * wet >= places) return ERR_OK;
    return refuse(sampler, o, "has no fluid along its line", x,
                  "the shape of the fluid must begin at the line; change `side` if the fluid lies "
                  "on the other side");
}

/* What else lies where a buffer particle does. */
static enum err check_buffer_point(const struct sampler *sampler, const struct scene_open *o,
                                   int number, const double x[2])
{
    for (int r = 0; r < sampler->n_regions; r++) {
        const struct region *const region = &sampler->regions[r];
        if (region->kind == KIND_FLUID || !geometry_covers_strictly(region, x[0], x[1])) continue;
        char what[sizeof(struct section_title) + 16];
        snprintf(what, sizeof what, "lies in %s", section_title(region->common).text);
        return refuse(sampler, o, what, x,
                      region->kind == KIND_WALL
                          ? "shorten the line, or cut an opening in the wall with `minus`"
                          : "move the line");
    }
    for (int k = 0; k < number; k++) {
        const struct scene_open other = scene_open_at(sampler->scene, k);
        if (in_buffer(sampler->scene, &other, x))
            return refuse(sampler, o, "overlaps another open boundary", x, "move one of the two");
    }
    return ERR_OK;
}

static enum err append(struct sampler *sampler, int number, const struct scene_open *o)
{
    struct scene *const scene = sampler->scene;
    struct scene_points *const p = &scene->points[KIND_FLUID];
    const struct lattice l = lattice_of(scene, o);
    const int64_t before = p->n;
    TRY(check_fluid(sampler, o));
    for (int j = 0; j < l.rows; j++)
        for (int i = 0; i < l.across; i++) {
            double x[2];
            if (!lattice_point(scene, o, &l, i, j, x)) continue;
            TRY(check_buffer_point(sampler, o, number, x));
            p->x[p->n] = x[0];
            p->y[p->n] = x[1];
            p->body[p->n] = 0;
            p->open[p->n] = number + 1;
            p->n++;
        }
    return p->n > before ? ERR_OK
                         : refuse(sampler, o, "is above its level", o->from, "raise `level`");
}

enum err geometry_open(struct sampler *sampler)
{
    struct scene *const scene = sampler->scene;
    struct scene_points *const p = &scene->points[KIND_FLUID];
    int64_t more = 0;
    if (scene->n_fluid == 0 || scene_open_count(scene) == 0) return ERR_OK;
    for (int k = 0; k < scene_open_count(scene); k++) {
        const struct scene_open o = scene_open_at(scene, k);
        const struct lattice l = lattice_of(scene, &o);
        if ((double)l.across * l.rows > 1e8)
            return refuse(sampler, &o, "has a buffer for more than 1e8 particles", o.from,
                          "use a larger dp or a shorter line");
        more += (int64_t)l.across * l.rows;
    }
    const struct scene_points from = *p;
    const size_t n = (size_t)from.n;
    TRY(geometry_points(sampler, KIND_FLUID, from.n + more, true, p));
    memcpy(p->x, from.x, n * sizeof *p->x);
    memcpy(p->y, from.y, n * sizeof *p->y);
    memcpy(p->body, from.body, n * sizeof *p->body);
    p->n = from.n;
    for (int k = 0; k < scene_open_count(scene); k++) {
        const struct scene_open o = scene_open_at(scene, k);
        TRY(geometry_go_on(sampler, append(sampler, k, &o)));
    }
    return ERR_OK;
}
