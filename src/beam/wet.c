/* SPDX-License-Identifier: MIT */
#include "beam/wet.h"
#include "base/elementary.h"
#include "particles/kernel.h"

#include <math.h>
#include <string.h>

static double impedance(const struct beams *beams) { return beams->scene->rho0 * beams->scene->c0; }

enum err beams_wet_create(struct beams *beams, struct arena *a, struct lines *lines,
                          struct particles *walls, double ahead, bool alternates, struct diag *d)
{
    static const char what[] = "beams";
    beams->ahead = ahead;
    beams->alternates = alternates;
    const size_t n = (size_t)beams->n_elements;
    beams->walls = walls;
    beams->added = arena_alloc(a, n, sizeof *beams->added, what, d);
    beams->line = arena_alloc(a, (size_t)beams->n, sizeof *beams->line, what, d);
    if (!beams->added || !beams->line) return ERR_MEMORY;
    for (int k = 0; k < lines->n; k++) {
        const int beam = lines->line[k].scene->wall - scene_beam_wall(beams->scene, 0);
        if (beam >= 0) beams->line[beam] = &lines->line[k];
    }
    /* Longer than any step. */
    for (int k = 0; k < beams->n_nodes; k++)
        beams->state[k].exchange = beams->scene->h / beams->scene->c0;
    beams_place(beams, 0);
    return ERR_OK;
}

/* --- the beam as the fluid sees it --- */

static void place_end(const struct beams *beams, const struct beam_element *e, int last,
                      double since, struct line_end *end)
{
    const struct beam_node *const node = &beams->node[e->node[last]];
    const struct beam_state *const s = &beams->state[e->node[last]];
    double x[3];
    for (int c = 0; c < 3; c++) x[c] = s->x[c] + since * s->w[c];
    const double cosine = elementary_cos(x[2]), sine = elementary_sin(x[2]);
    const double t[2] = {e->between[0] / e->length, e->between[1] / e->length};
    *end = (struct line_end){
        .x = {node->X[0] + x[0], node->X[1] + x[1]},
        .normal = {-(sine * t[0] + cosine * t[1]), cosine * t[0] - sine * t[1]},
        .v = {s->w[0], s->w[1]},
        .rate = s->w[2],
        .a = {s->a[0], s->a[1]},
        .angular_acceleration = s->a[2],
    };
}

/* The largest displacement of a dummy from one place of its end to the other, m. */
static double way_of(const struct beams *beams, const struct line_end *from,
                     const struct line_end *to)
{
    const double deep = KERNEL_REACH * beams->scene->h + beams->scene->top.dp;
    return elementary_hypot(to->x[0] - from->x[0], to->x[1] - from->x[1]) +
           2 * deep *
               elementary_hypot(to->normal[0] - from->normal[0], to->normal[1] - from->normal[1]);
}

double beams_place(struct beams *beams, double since)
{
    double way = 0;
    for (int k = 0; k < beams->n; k++) {
        const struct beam *const b = &beams->beam[k];
        struct thin_line *const line = beams->line[k];
        for (int m = b->first_element; m < b->end_element; m++)
            for (int last = 0; last < 2; last++) {
                struct line_end *const end = &line->end[2 * (m - b->first_element) + last],
                                       before = *end;
                place_end(beams, &beams->element[m], last, since, end);
                way = max2(way, way_of(beams, &before, end));
            }
        line_place(line, beams->walls);
    }
    return way;
}

/* --- exchange --- */

/* The nodes of the part of dummy j, and its element. */
static int element_of(const struct beams *beams, int beam, int64_t j)
{
    return beams->beam[beam].first_element + beams->line[beam]->scene->dummy[j].part;
}

static void add_dummy(struct beams *beams, int beam, int64_t j)
{
    const struct thin_line *const line = beams->line[beam];
    const struct particles *const p = beams->walls;
    const int64_t i = line->first + j;
    const int element = element_of(beams, beam, j), *const node = beams->element[element].node;
    const double wet = sqrt(square(p->wet_x[i]) + square(p->wet_y[i]));
    const double by = impedance(beams) / max2(wet, 1e-300);
    double force[6], normal[6];
    line_at_ends(line, j, p->fx[i], p->fy[i], force);
    for (int r = 0; r < 6; r++) beams->step[node[r / 3]].fluid[r % 3] += force[r];
    if (!(wet > 0)) return;
    line_at_ends(line, j, p->wet_x[i], p->wet_y[i], normal);
    for (int r = 0; r < 6; r++)
        for (int c = 0; c < 6; c++) beams->added[element][r][c] += by * normal[r] * normal[c];
}

/* T-35c: the share of a step in a mean over the time in which sound crosses h, less the age of the
 * acceleration. */
static double mean_weight(const struct beams *beams, double dt)
{
    const double time = beams->scene->h / beams->scene->c0;
    return dt / (dt + max2(0.25 * time, time - (1 + beams->ahead) * dt));
}

/* T-36a: the force in the middle of the step, with all that the fluid gets for `kick`. */
static void extrapolate(struct beams *beams, const struct beam_times *times)
{
    const double impulse = times->kick / times->dt, now = 0.5 - beams->ahead,
                 before = impulse + now - 1, weight = beams->alternates ? 0.5 : 1;
    for (int k = 0; k < beams->n_nodes; k++)
        for (int c = 0; c < 3; c++) {
            double *const force = &beams->step[k].fluid[c], *const mean =
                                                                &beams->state[k].pushed[c];
            const double old = times->last > 0 ? *mean : *force;
            *mean = old + weight * (*force - old);
            *force = impulse * *force + now * *mean - before * old;
        }
}

void beams_find_fluid(struct beams *beams, const struct beam_times *times)
{
    for (int k = 0; k < beams->n_nodes; k++) {
        const struct beam_state *const now = &beams->state[k];
        for (int c = 0; c < 3; c++) beams->step[k].fluid[c] = -now->impulse[c] / now->exchange;
    }
    memset(beams->added, 0, (size_t)beams->n_elements * sizeof *beams->added);
    for (int k = 0; k < beams->n; k++)
        for (int64_t j = 0; j < beams->line[k]->scene->n_dummies; j++) add_dummy(beams, k, j);
    extrapolate(beams, times);
}

/* T-105b: the pressure that gives the fluid the impulse: `left` of that before, and a new one in
 * the time T_e. */
static void add_pressure(struct beams *beams, int beam, int64_t j, double left, double part)
{
    const struct thin_line *const line = beams->line[beam];
    struct particles *const p = beams->walls;
    const int64_t i = line->first + j;
    const int *const node = beams->element[element_of(beams, beam, j)].node;
    const double wet = sqrt(square(p->wet_x[i]) + square(p->wet_y[i]));
    double normal[6], along = 0;
    line_at_ends(line, j, p->wet_x[i], p->wet_y[i], normal);
    for (int r = 0; r < 6 && wet > 0; r++)
        along += normal[r] / wet * beams->step[node[r / 3]].faster[r % 3];
    p->interface_pressure[i] =
        left * p->interface_pressure[i] - 2 * part * impedance(beams) * along;
}

void beams_return_impulse(struct beams *beams, const struct beam_times *times)
{
    const double dt = times->dt, before = beams->state[0].exchange, after = max2(dt, before - dt),
                 left = 1 - times->kick / before;
    const double weight = mean_weight(beams, dt);
    for (int k = 0; k < beams->n_nodes; k++) {
        struct beam_state *const now = &beams->state[k];
        struct beam_step *const s = &beams->step[k];
        now->exchange = after;
        for (int c = 0; c < 3; c++) {
            now->impulse[c] = left * now->impulse[c] - dt * s->resisted[c];
            beams->beam[beams->node[k].beam].received += (s->fluid[c] - s->resisted[c]) * s->d[c];
            now->w[c] = s->d[c] / dt;
            s->faster[c] = now->w[c] - s->w[c];
            now->a[c] += weight * (s->faster[c] / (0.5 * (times->last + dt)) - now->a[c]);
        }
    }
    for (int k = 0; k < beams->n; k++)
        for (int64_t j = 0; j < beams->line[k]->scene->n_dummies; j++)
            add_pressure(beams, k, j, left * before / after, dt / after);
}
