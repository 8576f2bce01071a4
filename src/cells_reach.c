/* SPDX-License-Identifier: MIT
 * How long a sorting stays good. Pairs in cells that do not touch are never looked at; they can only have
 * come within reach of each other if both, together, hang over their cells' edges by more than the skin.
 * That is a matter of where the particles are, not of how fast anything moves: a body of fluid that travels
 * as a whole seldom needs sorting. How fast things move only says when to measure again. */
#include <math.h>

#include "cells.h"

enum { LEFT, RIGHT, DOWN, UP };

/* A cell without particles. */
static const struct overhang nothing = {{-1e30, -1e30, -1e30, -1e30}};

static void widen(struct overhang *o, const struct overhang *by)
{
    for (int k = 0; k < 4; k++) o->by[k] = max2(o->by[k], by->by[k]);
}

static struct overhang overhang_of(const struct cells *c, const struct cell_list *list,
                                   const struct particles *p, int32_t cell)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int32_t k = list->start[cell]; k < list->start[cell] + list->count[cell]; k++) {
        const int32_t i = list->order ? list->order[k] : k;
        low[0] = min2(low[0], p->x[i]);
        high[0] = max2(high[0], p->x[i]);
        low[1] = min2(low[1], p->y[i]);
        high[1] = max2(high[1], p->y[i]);
    }
    const double left = c->lower[0] + cell_x(c, cell) * c->side[0],
                 bottom = c->lower[1] + cell_y(c, cell) * c->side[1];
    return (struct overhang){{left - low[0], high[0] - left - c->side[0], bottom - low[1],
                              high[1] - bottom - c->side[1]}};
}

void cells_measure(struct cells *c, enum kind kind, const struct particles *p)
{
    const struct cell_list *const list = &c->kind[kind];
    double left = nothing.by[LEFT], right = left, down = left, up = left;
#pragma omp parallel for schedule(static) reduction(max : left, right, down, up)
    for (int32_t k = 0; k < list->n_active; k++) {
        const struct overhang o = overhang_of(c, list, p, list->active[k]);
        list->overhang[list->active[k]] = o;
        left = max2(left, o.by[LEFT]);
        right = max2(right, o.by[RIGHT]);
        down = max2(down, o.by[DOWN]);
        up = max2(up, o.by[UP]);
    }
    c->kind[kind].most = (struct overhang){{left, right, down, up}};
}

/* Largest overhang towards `cell`, which lies to the side `to`, of whatever kind in the five cells there. */
static double overhang_across(const struct cells *c, int32_t cell, int to)
{
    const int away = to == LEFT || to == DOWN ? -2 : 2;
    double most = nothing.by[LEFT];
    for (int along = -2; along <= 2; along++) {
        const bool x = to == LEFT || to == RIGHT;
        const int32_t other =
            cell_at(c, cell_x(c, cell) + (x ? away : along), cell_y(c, cell) + (x ? along : away));
        if (other < 0) continue;
        for (int kind = 0; kind < KIND_COUNT; kind++)
            if (c->kind[kind].count && c->kind[kind].count[other])
                most = max2(most, c->kind[kind].overhang[other].by[to ^ 1]);
    }
    return most;
}

double cells_room(const struct cells *c, double reach)
{
    const struct cell_list *const fluid = &c->kind[KIND_FLUID];
    struct overhang all = nothing;
    for (int kind = 0; kind < KIND_COUNT; kind++)
        if (c->kind[kind].n_active) widen(&all, &c->kind[kind].most);
    double room = INFINITY;
    bool close[4], any = false;
    for (int to = 0; to < 4; to++) {
        const double side = c->side[to / 2], skin = side - reach,
                     sum = fluid->most.by[to] + all.by[to ^ 1];
        if (!(sum < skin + side)) return 0; /* even a cell further */
        close[to] = sum > skin;
        any |= close[to];
        room = min2(room, CELLS_ASTRAY * side - fluid->most.by[to]);
        room = min2(room, close[to] ? skin + side - sum : skin - sum);
    }
    if (!any) return room;
#pragma omp parallel for schedule(static) reduction(min : room)
    for (int32_t k = 0; k < fluid->n_active; k++) {
        const int32_t cell = fluid->active[k];
        for (int to = 0; to < 4; to++) {
            const double skin = c->side[to / 2] - reach, own = fluid->overhang[cell].by[to];
            if (!close[to]) continue;
            const double most =
                own + all.by[to ^ 1] > skin ? overhang_across(c, cell, to) : all.by[to ^ 1];
            room = min2(room, skin - (own + most));
        }
    }
    return room;
}
