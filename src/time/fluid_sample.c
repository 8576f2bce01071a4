/* SPDX-License-Identifier: MIT
 * Sampling the fluid: at a point, at its surface, at its front, through a line. */
#include "time/simulation.h"
#include "base/elementary.h"

#include <math.h>
#include <string.h>

#include "fluid/eos.h"
#include "particles/kernel.h"

/* Below a tenth of a full neighbourhood a point counts as dry. */
#define DRY 0.1

/* Called for particle i of a kind at distance r from the sampled point, within reach. */
typedef void visitor(const struct simulation *s, enum kind kind, int64_t i, double r, void *sums);

static void each_within(const struct simulation *s, enum kind kind, double x, double y,
                        double distance, visitor *visit, void *sums)
{
    const struct cells *const c = &s->cells;
    const struct cell_list *const list = &c->kind[kind];
    const struct particles *const p = &s->kind[kind];
    /* Cells that may hold particles within reach: these may have moved since they were sorted. */
    const double reach = distance + c->skin;
    int first[2], n[2];
    for (int axis = 0; axis < 2; axis++) {
        const int cells = axis ? c->ny : c->nx;
        const double at = ((axis ? y : x) - c->lower[axis]) / c->side[axis],
                     part = reach / c->side[axis];
        first[axis] = (int)max2(-1, min2(cells, floor(at - part)));
        n[axis] = (int)max2(-1, min2(cells, floor(at + part))) - first[axis] + 1;
        if (c->periodic[axis] && n[axis] > cells) n[axis] = cells;
    }
    for (int place = 0; place < n[0] * n[1]; place++) {
        const int32_t cell = cell_at(c, first[0] + place % n[0], first[1] + place / n[0]);
        if (cell < 0) continue;
        for (int32_t k = list->start[cell]; k < list->start[cell] + list->count[cell]; k++) {
            const int64_t i = list->order ? list->order[k] : k;
            const double dx = cells_minimum_image(c, 0, p->x[i] - x);
            const double dy = cells_minimum_image(c, 1, p->y[i] - y);
            const double r2 = square(dx) + square(dy);
            if (r2 < square(distance)) visit(s, kind, i, sqrt(r2), sums);
        }
    }
}

static void each_near(const struct simulation *s, enum kind kind, double x, double y,
                      visitor *visit, void *sums)
{
    each_within(s, kind, x, y, KERNEL_REACH * s->fluid.k.h, visit, sums);
}

/* The sums of a sample. */
struct sampling {
    struct sample sum;
    double x, y;
    double dx, dy;         /* to the place from the fluid within reach, m */
    double rho;            /* of this fluid, kg/m^3 */
    double ax, ay;         /* of this fluid, m/s^2 */
    double wall_x, wall_y; /* of walls and structures, m/s^2 */
};

static void add_to_sample(const struct simulation *s, enum kind kind, int64_t i, double r,
                          void *sums)
{
    struct sampling *const at = sums;
    const struct particles *const p = &s->kind[kind];
    const struct fluid_constants *const k = &s->fluid.k;
    const double w = kernel_w(r, k->h) * square(s->scene->top.dp);
    if (kind != KIND_FLUID) {
        at->sum.occupied += w;
        at->wall_x += w * (p->ax ? p->ax[i] : 0);
        at->wall_y += w * (p->ay ? p->ay[i] : 0);
        return;
    }
    at->sum.fill += w;
    at->sum.pressure += w * eos_pressure(p->dens[i], k->rho0, k->c0);
    at->sum.vx += w * p->vx[i];
    at->sum.vy += w * p->vy[i];
    at->dx += w * cells_minimum_image(&s->cells, 0, at->x - p->x[i]);
    at->dy += w * cells_minimum_image(&s->cells, 1, at->y - p->y[i]);
    at->rho += w * k->rho0 * (1 + p->dens[i]);
    at->ax += w * p->ax[i];
    at->ay += w * p->ay[i];
}

static void count_near(const struct simulation *s, enum kind kind, int64_t i, double r, void *sums)
{
    (void)kind;
    (void)i;
    *(int *)sums += r < KERNEL_REACH * s->fluid.k.h;
}

int simulation_near(const struct simulation *s, double x, double y)
{
    int n = 0;
    each_near(s, KIND_FLUID, x, y, count_near, &n);
    if (s->effects & FX_WALL) each_near(s, KIND_WALL, x, y, count_near, &n);
    if (s->effects & FX_COUPLING) each_near(s, KIND_SOLID, x, y, count_near, &n);
    return n;
}

/* L-7b without volumes and beta rho0 c0^2, 1/m^2: the integral of L-7 times the kernel's slope from r to
 * r0, by four points of Gauss. */
static double repulsion_held(double r, double r0, double h)
{
    static const double at[] = {0.069431844202973713, 0.330009478207571868, 0.669990521792428132,
                                0.930568155797026287};
    static const double weight[] = {0.173927422568726929, 0.326072577431273071,
                                    0.326072577431273071, 0.173927422568726929};
    double sum = 0;
    for (int g = 0; g < 4; g++) {
        const double x = r + at[g] * (r0 - r), eta2 = ETA2 * square(h);
        const double stress = (square(r0) + eta2) / (square(x) + eta2) - 1;
        sum -= weight[g] * stress * kernel_slope(x, h) * x;
    }
    return sum * (r0 - r);
}

/* Adds that of a dummy at the distance r, times its volume, m^2. */
static void add_repulsion(const struct simulation *s, enum kind kind, int64_t i, double r,
                          void *sums)
{
    const struct particles *const p = &s->kind[kind];
    const struct fluid *const f = &s->fluid;
    const double over = f->volume[kind][p->body[i]];
    const double r0 = REPULSION_REACH * 0.5 * (1 + sqrt(over)) * f->k.dp;
    if (r < r0)
        *(double *)sums +=
            over * f->k.mass / (f->k.rho0 * (1 + p->dens[i])) * repulsion_held(r, r0, f->k.h);
}

void simulation_repulsion(const struct simulation *s, double of[SCENE_MAX_SECTIONS])
{
    const struct particles *const p = &s->kind[KIND_FLUID];
    const struct cell_list *const list = &s->cells.kind[KIND_FLUID];
    const struct fluid_constants *const k = &s->fluid.k;
    const double reach = REPULSION_REACH * k->dp; /* solids are as fine as the fluid, or finer */
    memset(of, 0, SCENE_MAX_SECTIONS * sizeof *of);
    for (int32_t n = 0; n < list->n_active; n++) {
        const int32_t cell = list->active[n];
        if (!s->fluid.near_dummies[cell]) continue;
        for (int32_t i = list->start[cell]; i < list->start[cell] + list->count[cell]; i++) {
            double sum = 0;
            for (int kind = KIND_WALL; kind < KIND_COUNT; kind++)
                if (s->cells.kind[kind].n_active)
                    each_within(s, (enum kind)kind, p->x[i], p->y[i], reach, add_repulsion, &sum);
            of[p->body[i]] += (p->m ? p->m[i] : 1) * k->mass / (1 + p->dens[i]) * k->repulsion *
                              square(k->c0) * sum;
        }
    }
}

/* T-10a: from the mean over the fluid to a place beside it. */
static double rise_to_place(const struct simulation *s, const struct sampling *at, double mean)
{
    const double air = max2(0, 1 - at->sum.fill - at->sum.occupied),
                 missing = at->sum.occupied + air;
    if (missing <= 0) return 0;
    const double ax = (at->wall_x + air * mean * at->ax) / missing,
                 ay = (at->wall_y + air * mean * at->ay) / missing;
    const double *const g = s->fluid.k.gravity;
    return square(mean) * at->rho * ((g[0] - ax) * at->dx + (g[1] - ay) * at->dy);
}

struct sample simulation_sample(const struct simulation *s, double x, double y)
{
    struct sampling at = {.x = x, .y = y};
    struct sample *const sum = &at.sum;
    if (!(s->effects & FX_FLUID)) return *sum;
    each_near(s, KIND_FLUID, x, y, add_to_sample, &at);
    if (s->effects & FX_WALL) each_near(s, KIND_WALL, x, y, add_to_sample, &at);
    if (s->effects & FX_COUPLING) each_near(s, KIND_SOLID, x, y, add_to_sample, &at);
    const double mean = sum->fill > DRY ? 1 / sum->fill : 0;
    sum->pressure = mean * sum->pressure + rise_to_place(s, &at, mean);
    sum->vx *= mean;
    sum->vy *= mean;
    return *sum;
}

double simulation_pressure_at(const struct simulation *s, double x, double y)
{
    return simulation_sample(s, x, y).pressure;
}

/* The water's volume fraction of the space outside walls and structures. */
static double wetness(const struct simulation *s, double x, double y)
{
    const struct sample at = simulation_sample(s, x, y);
    return at.fill / max2(1 - at.occupied, 0.05);
}

/* T-79, Gibbs' dividing surface: the height at which water that is full below and absent above has the
 * volume of that within reach. Unlike the height of half wetness it does not move when rows near the
 * surface do, while their mean height stays. `y` is the last wet height below the surface. */
static double dividing_surface(const struct simulation *s, double x, double y, double step)
{
    const int reach = (int)(KERNEL_REACH * s->fluid.k.h / step);
    const double at_y = wetness(s, x, y);
    double level = y, before = at_y;
    for (int k = 1; k <= reach; k++) {
        const double now = wetness(s, x, y + k * step);
        if (now > 0.5) break; /* other water above */
        level += 0.5 * (before + now) * step;
        before = now;
    }
    before = at_y;
    for (int k = 1; k <= reach; k++) {
        const double now = wetness(s, x, y - k * step);
        if (now <= 0.5) break; /* below a thin layer */
        level -= (1 - 0.5 * (before + now)) * step;
        before = now;
    }
    return level;
}

double simulation_level(const struct simulation *s, double x, double y)
{
    const double step = 0.25 * s->scene->top.dp,
                 top = s->cells.lower[1] + s->cells.ny * s->cells.side[1];
    const int reach = (int)(KERNEL_REACH * s->fluid.k.h / step), most = (int)((top - y) / step) + 1;
    bool wet = wetness(s, x, y) > 0.5;
    for (int k = 1; k <= most && (wet || k <= reach); k++) {
        const bool now = wetness(s, x, y + k * step) > 0.5;
        if (wet && !now) return dividing_surface(s, x, y + (k - 1) * step, step);
        wet = now;
    }
    return wet ? top : y;
}

struct neighbour_count {
    int64_t self;
    int neighbours;
};

static void count_neighbour(const struct simulation *s, enum kind kind, int64_t i, double r,
                            void *sums)
{
    struct neighbour_count *const count = sums;
    (void)kind;
    if (i != count->self && r < KERNEL_REACH * s->fluid.k.h) count->neighbours++;
}

/* The thinnest tongue of water is a row of particles; the first of them has two others within
 * reach. */
static bool belongs_together(const struct simulation *s, int64_t i)
{
    const struct particles *const p = &s->kind[KIND_FLUID];
    struct neighbour_count count = {i, 0};
    each_near(s, KIND_FLUID, p->x[i], p->y[i], count_neighbour, &count);
    return count.neighbours >= 2;
}

double simulation_front(const struct simulation *s, int direction)
{
    const struct particles *const p = &s->kind[KIND_FLUID];
    const bool vertical = direction == DIRECTION_UP || direction == DIRECTION_DOWN;
    const double sign = direction == DIRECTION_RIGHT || direction == DIRECTION_UP ? 1 : -1;
    const double *const coordinate = vertical ? p->y : p->x;
    double foremost = -(double)INFINITY, any = -(double)INFINITY;
    for (int64_t i = 0; i < p->n; i++) {
        const double ahead = sign * coordinate[i];
        any = max2(any, ahead);
        if (ahead > foremost && belongs_together(s, i)) foremost = ahead;
    }
    if (p->n == 0) return (double)NAN;
    /* The water ends half a spacing beyond the last particle's centre. */
    return sign * ((isfinite(foremost) ? foremost : any) + 0.5 * s->scene->top.dp);
}

/* A line, and how many of a particle's images on each side of the nearest one it may meet. */
struct flux_line {
    double length, along[2], period[2];
    int images[2];
};

static struct flux_line flux_line(const struct simulation *s, const double a[2], const double b[2])
{
    struct flux_line line = {.length = elementary_hypot(b[0] - a[0], b[1] - a[1])};
    for (int c = 0; c < 2; c++) {
        line.along[c] = (b[c] - a[c]) / line.length;
        line.period[c] = s->scene->domain_upper[c] - s->scene->domain_lower[c];
        if (scene_periodic(s->scene, c))
            line.images[c] = 1 + (int)ceil(fabs(b[c] - a[c]) / line.period[c]);
    }
    return line;
}

/* The bell's sum over a particle's images at the place (x, y) from the line's first end. */
static double images_at_line(const struct flux_line *line, double reach, double x, double y)
{
    const double tx = line->along[0], ty = line->along[1];
    double sum = 0;
    for (int i = -line->images[0]; i <= line->images[0]; i++)
        for (int j = -line->images[1]; j <= line->images[1]; j++) {
            const double X = x + i * line->period[0], Y = y + j * line->period[1];
            const double along = X * tx + Y * ty, across = X * ty - Y * tx;
            if (along < 0 || along > line->length || fabs(across) >= reach) continue;
            sum += 0.5 / reach * (1 + elementary_cos(PI * across / reach));
        }
    return sum;
}

double simulation_flux(const struct simulation *s, const double a[2], const double b[2])
{
    const struct particles *const p = &s->kind[KIND_FLUID];
    const struct flux_line line = flux_line(s, a, b);
    const double tx = line.along[0], ty = line.along[1];
    /* The mean over a strip, weighted by a cosine bell of area 1. One spacing to either side is the least
     * for which its sum over a lattice is exact. A wider strip would miss what flows into an opening
     * round its edge. */
    const double dp = s->scene->top.dp, reach = dp;
    double sum = 0;
    for (int64_t i = 0; i < p->n; i++) {
        const double x = cells_minimum_image(&s->cells, 0, p->x[i] - a[0]);
        const double y = cells_minimum_image(&s->cells, 1, p->y[i] - a[1]);
        const double bell = images_at_line(&line, reach, x, y);
        if (bell == 0) continue;
        const double m = p->m ? p->m[i] : 1;
        sum += bell * m * square(dp) / (1 + p->dens[i]) * (p->vx[i] * ty - p->vy[i] * tx);
    }
    return sum;
}

void simulation_pressure_on(const struct simulation *s, const double a[2], const double b[2],
                            double out[3])
{
    const double dx = b[0] - a[0], dy = b[1] - a[1];
    const int n = (int)max2(1, ceil(elementary_hypot(dx, dy) / s->scene->top.dp - 1e-9));
    double sum = 0;
    for (int k = 0; k < n; k++) {
        const double at = (k + 0.5) / n;
        sum += simulation_pressure_at(s, a[0] + at * dx, a[1] + at * dy);
    }
    out[0] = sum / n;
    out[1] = out[0] * dy;
    out[2] = -out[0] * dx;
}
