/* SPDX-License-Identifier: MIT
 * Contact of beams with walls, rigid bodies and beams (T-106), within Newton's method. */
#include "beam/beam.h"
#include "base/segment.h"
#include "geometry/motion.h"
#include "geometry/outline.h"

/* A distance that counts as kept, over the particle spacing. */
#define KEPT 1e-9

/* A piece of a wall's or rigid body's outline at the start: a segment; a circle with a `radius`. */
struct beam_piece {
    int wall;
    double from[2], to[2], radius;
};

/* A pair that may touch: nodes with their weights, and a piece or corner of a wall, or none. */
struct beam_pair {
    int n, node[3];
    double part[3];
    double gap;          /* if no node and no rigid body moves, m */
    double moved;        /* by a wall with a [motion], along the normal, m */
    struct beam_row row; /* along the normal */
};

struct beam_contact {
    int n_pieces, n_walls, n_moving, n, most; /* n_moving: walls before the rigid bodies */
    struct beam_piece *piece;
    struct motion_state *begin, *end; /* [n_walls] of the step */
    double *layer;                    /* [n][n_wall] that stays between surfaces; NAN: no contact */
    struct beam_pair *pair;
    double *column;     /* [most][size] displacement of nodes and bodies by a unit of force */
    double *compliance; /* [most][most] along the normals of others */
    double *open;       /* [most] gap after the correction, m */
};

/* --- pieces --- */

static enum err add_piece(struct beam_contact *contact, int wall, const double from[2],
                          const double to[2], double radius, struct arena *a, struct diag *d)
{
    TRY(arena_more(a, &contact->piece, contact->n_pieces, "beams", d));
    contact->piece[contact->n_pieces++] =
        (struct beam_piece){wall, {from[0], from[1]}, {to[0], to[1]}, radius};
    return ERR_OK;
}

static enum err add_outlines(struct beam_contact *contact, int wall, const struct outlines *o,
                             struct arena *a, struct diag *d)
{
    for (int k = 0; k < o->n; k++) {
        const struct outline *const i = &o->item[k];
        if (!i->n) TRY(add_piece(contact, wall, i->centre, i->centre, i->radius, a, d));
        for (int j = 0; j < i->n; j++)
            TRY(add_piece(contact, wall, i->pt[j], i->pt[j + 1 < i->n ? j + 1 : 0], 0, a, d));
    }
    return ERR_OK;
}

static enum err create_pieces(struct beams *beams, struct arena *a, struct arena *temp,
                              struct diag *d)
{
    const struct scene *const scene = beams->scene;
    struct beam_contact *const contact = beams->contact;
    for (int w = 0; w < contact->n_walls; w++) {
        const struct shape_list *const shapes = &scene->wall[w].shape;
        struct body_outlines o;
        TRY(body_outlines_of(&o, scene, shapes, &scene->wall[w].minus, temp, d));
        TRY(add_outlines(contact, w, &o.add, a, d));
        TRY(add_outlines(contact, w, &o.minus, a, d));
        for (const struct shape *s = shapes->item; s < shapes->item + shapes->n; s++)
            for (int j = 0; s->thin && j + 1 < s->n; j++)
                TRY(add_piece(contact, w, s->pt[j], s->pt[j + 1], 0, a, d));
    }
    return ERR_OK;
}

static double half_of(const struct beams *beams, int beam)
{
    return scene_half_thickness(beams->beam[beam].given);
}

enum err beams_contact_create(struct beams *beams, struct arena *a, struct diag *d)
{
    static const char what[] = "contact of beams";
    const struct scene *const scene = beams->scene;
    struct beam_contact *const contact = arena_alloc(a, 1, sizeof *contact, what, d);
    beams->contact = contact;
    if (!contact) return ERR_MEMORY;
    contact->n_walls = scene_beam_wall(scene, 0);
    contact->n_moving = scene_rigid_wall(scene, 0);
    contact->most = (int)min2(BEAM_PAIRS, 3.0 * beams->n_nodes);
    const size_t n = (size_t)contact->n_walls, most = (size_t)contact->most;
    TRY(arena_array(a, &contact->begin, n, what, d));
    TRY(arena_array(a, &contact->end, n, what, d));
    TRY(arena_array(a, &contact->layer, beams->n * scene->n_wall, what, d));
    TRY(arena_array(a, &contact->pair, most, what, d));
    TRY(arena_array(a, &contact->column, most * (size_t)beams->size, what, d));
    TRY(arena_array(a, &contact->compliance, most * most, what, d));
    TRY(arena_array(a, &contact->open, most, what, d));
    for (int k = 0; k < beams->n; k++)
        for (int w = 0; w < scene->n_wall; w++) {
            const struct scene_contact *const from =
                scene_contact_of(scene, scene->n_solid + scene_beam_wall(scene, k),
                                 scene->n_solid + w);
            contact->layer[k * scene->n_wall + w] =
                from ? scene_contact_gap(scene, from) : (double)NAN;
        }
    for (int k = 0; k < beams->n_nodes; k++) /* none with a body that it is joined to */
        if (beams->node[k].body >= 0)
            contact->layer[beams->node[k].beam * scene->n_wall +
                           scene_rigid_wall(scene, beams->node[k].body)] = (double)NAN;
    struct arena temp = {.limit = a->limit};
    const enum err e = create_pieces(beams, a, &temp, d);
    arena_free(&temp);
    return e;
}

/* --- pairs --- */

/* The nearest place of a segment, or of a circle with a `radius`: the normal there. */
struct beam_near {
    double part, normal[2], distance;
};

static struct beam_near nearest_of(const double at[2], const double from[2], const double to[2],
                                   double radius)
{
    const struct segment_foot foot = segment_foot(at, from, to, 0);
    const double sign = foot.distance < radius ? -1 : 1;
    struct beam_near near = {.part = foot.part, .distance = sign * (foot.distance - radius)};
    for (int c = 0; c < 2 && foot.distance > 0; c++)
        near.normal[c] = sign * foot.offset[c] / foot.distance;
    return near;
}

static void node_now(const struct beams *beams, int k, double x[2])
{
    for (int c = 0; c < 2; c++) x[c] = beams->node[k].X[c] + beams->state[k].x[c];
}

/* T-106: the least distance. Surfaces that begin nearer than their layer keep none, and what
 * begins nearer than the thickness keeps that distance. */
static double least_distance(double thick, double layer, double at_start)
{
    return at_start < thick + layer ? min2(thick, at_start) : thick + layer;
}

/* What the present displacements of nodes and body add to a gap. */
static double along_pair(const struct beams *beams, const struct beam_pair *t)
{
    double sum = -beam_row_moved(beams, &t->row);
    for (int k = 0; k < t->n; k++)
        for (int c = 0; c < 2; c++) sum += t->part[k] * t->row.e[c] * beams->step[t->node[k]].d[c];
    return sum;
}

/* Adds a pair at a place of a wall (-1: of a beam) that the first guess brings within 0.1 dp. */
static void add_pair(struct beams *beams, struct beam_pair *t, int wall, const double at[2])
{
    struct beam_contact *const contact = beams->contact;
    const double reach = 0.1 * beams->scene->top.dp;
    bool held = wall < contact->n_moving;
    t->row.body = held ? -1 : wall - contact->n_moving;
    if (!held) motion_initial(&contact->begin[wall], at, t->row.X);
    beam_row_aim(beams, &t->row);
    for (int k = 0; k < t->n; k++)
        for (int c = 0; c < 2; c++) held &= beams->node[t->node[k]].unknown[c] < 0;
    if (held || t->gap + min2(0, along_pair(beams, t)) > reach || t->gap > beams->scene->top.dp)
        return;
    if (t->row.e[0] == 0 && t->row.e[1] == 0) return;
    beams->crowded |= contact->n == contact->most;
    if (contact->n < contact->most) contact->pair[contact->n++] = *t;
}

/* A point of a wall where it is at the start and the end of the step. */
static void place_wall(const struct beam_contact *contact, int wall, const double X[2],
                       double now[2], double moved[2])
{
    const struct motion_point from = motion_of_point(&contact->begin[wall], X[0], X[1]),
                              to = motion_of_point(&contact->end[wall], X[0], X[1]);
    for (int c = 0; c < 2; c++) {
        now[c] = from.x[c];
        moved[c] = to.x[c] - from.x[c];
    }
}

static void pair_piece(struct beams *beams, int k, const struct beam_piece *piece)
{
    const struct beam_contact *const contact = beams->contact;
    const int beam = beams->node[k].beam;
    const double layer = contact->layer[beam * beams->scene->n_wall + piece->wall];
    double x[2], from[2], to[2], moved[2][2];
    if (isnan(layer)) return;
    node_now(beams, k, x);
    place_wall(contact, piece->wall, piece->from, from, moved[0]);
    place_wall(contact, piece->wall, piece->to, to, moved[1]);
    const struct beam_near now = nearest_of(x, from, to, piece->radius);
    if (now.distance > half_of(beams, beam) + layer + beams->scene->top.dp) return;
    const double at_start =
        nearest_of(beams->node[k].X, piece->from, piece->to, piece->radius).distance;
    struct beam_pair t = {.n = 1, .node = {k}, .part = {1}};
    for (int c = 0; c < 2; c++) {
        t.row.e[c] = now.normal[c];
        t.moved += t.row.e[c] * ((1 - now.part) * moved[0][c] + now.part * moved[1][c]);
    }
    t.gap = max2(0, now.distance - least_distance(half_of(beams, beam), layer, at_start)) - t.moved;
    add_pair(beams, &t, piece->wall, x);
}

/* Whether a node is nearer along the beam of an element than half of a circle of this diameter: a
 * bend as sharp as the thickness allows keeps them apart, and a wider one brings them nearer. */
static bool in_bend(const struct beams *beams, int element, int k, double diameter)
{
    const struct beam *const beam = &beams->beam[beams->node[k].beam];
    const int at = beam->first_element + k - beam->first_node, /* the element that begins at k */
        from = at > element ? element + 1 : at, to = at > element ? at : element;
    double along = 0;
    if (element < beam->first_element || element >= beam->end_element) return false;
    for (int m = from; m < to && along < 0.5 * PI * diameter; m++)
        along += beams->element[m].length;
    return along < 0.5 * PI * diameter;
}

/* A point with an element: of a wall, or node k of a beam. */
static void pair_element(struct beams *beams, int element, int wall, const double X[2], int k)
{
    const struct beam_contact *const contact = beams->contact;
    const int *const node = beams->element[element].node, beam = beams->node[node[0]].beam;
    const int n_wall = beams->scene->n_wall,
              other = k < 0 ? wall : scene_beam_wall(beams->scene, beams->node[k].beam);
    const double layer = contact->layer[beam * n_wall + other];
    const double thick = half_of(beams, beam) + (k < 0 ? 0 : half_of(beams, beams->node[k].beam));
    double at[2], from[2], to[2], moved[2] = {0};
    if (isnan(layer) || node[0] == k || node[1] == k) return;
    if (k < 0)
        place_wall(contact, wall, X, at, moved);
    else
        node_now(beams, k, at);
    node_now(beams, node[0], from);
    node_now(beams, node[1], to);
    const struct beam_near now = nearest_of(at, from, to, 0);
    if (now.distance > thick + layer + beams->scene->top.dp) return;
    if (k >= 0 && in_bend(beams, element, k, thick + layer)) return;
    const double at_start =
        nearest_of(X, beams->node[node[0]].X, beams->node[node[1]].X, 0).distance;
    struct beam_pair t = {.n = k < 0 ? 2 : 3,
                          .node = {node[0], node[1], k < 0 ? 0 : k},
                          .part = {1 - now.part, now.part, -1},
                          .row.e = {-now.normal[0], -now.normal[1]}};
    for (int c = 0; c < 2; c++) t.moved += t.row.e[c] * moved[c];
    t.gap = max2(0, now.distance - least_distance(thick, layer, at_start)) - t.moved;
    add_pair(beams, &t, wall, at);
}

static struct box2 box_of(const struct beams *beams, int beam)
{
    struct box2 box = box2_empty();
    for (int k = beams->beam[beam].first_node; k < beams->beam[beam].end_node; k++) {
        double x[2];
        node_now(beams, k, x);
        box2_include(&box, x[0], x[1]);
    }
    return box;
}

/* Nodes of beam b with elements of beam a. */
static void pair_beams(struct beams *beams, int a, int b)
{
    const struct scene *const scene = beams->scene;
    const double layer = beams->contact->layer[a * scene->n_wall + scene_beam_wall(scene, b)];
    const struct box2 of_a = box_of(beams, a), of_b = box_of(beams, b);
    const double reach = half_of(beams, a) + half_of(beams, b) + layer + scene->top.dp;
    if (isnan(layer) || !box2_near(&of_a, &of_b, reach)) return;
    for (int k = beams->beam[b].first_node; k < beams->beam[b].end_node; k++)
        for (int m = beams->beam[a].first_element; m < beams->beam[a].end_element; m++)
            pair_element(beams, m, -1, beams->node[k].X, k);
}

void beams_find_pairs(struct beams *beams, double time, double dt)
{
    struct beam_contact *const contact = beams->contact;
    const struct scene *const scene = beams->scene;
    for (int w = 0; w < contact->n_moving; w++) {
        const int mover = scene_wall_motion(scene, w);
        contact->begin[w] = motion_at(scene, mover, time);
        contact->end[w] = motion_at(scene, mover, time + dt);
    }
    for (int k = 0; k < beams->n_bodies; k++) {
        const int w = contact->n_moving + k;
        contact->begin[w] = contact->end[w] = rigid_placed(beams->rigid, k, beams->body[k].x);
    }
    contact->n = 0;
    for (int f = 0; f < contact->n_pieces; f++) {
        const struct beam_piece *const piece = &contact->piece[f];
        for (int k = 0; k < beams->n_nodes; k++) pair_piece(beams, k, piece);
        for (int m = 0; m < beams->n_elements && piece->radius == 0; m++)
            pair_element(beams, m, piece->wall, piece->from, -1);
    }
    for (int a = 0; a < beams->n; a++)
        for (int b = 0; b < beams->n; b++) pair_beams(beams, a, b);
}

/* --- forces --- */

void beams_add_pairs(struct beams *beams)
{
    for (int j = 0; j < beams->contact->n; j++) {
        struct beam_pair *const t = &beams->contact->pair[j];
        beam_row_push(beams, &t->row);
        for (int k = 0; k < t->n; k++)
            for (int c = 0; c < 2; c++)
                beams->step[t->node[k]].touch[c] += t->part[k] * t->row.e[c] * t->row.force;
    }
}

bool beams_keep_apart(const struct beams *beams)
{
    const struct beam_contact *const contact = beams->contact;
    const double kept = KEPT * beams->scene->top.dp;
    for (int j = 0; j < contact->n; j++) {
        const struct beam_pair *const t = &contact->pair[j];
        if (t->gap + along_pair(beams, t) < -kept) return false;
        if (!beam_row_settled(beams, &t->row, kept)) return false;
    }
    return true;
}

/* What a vector of displacements adds to a gap. */
static double along_unknowns(const struct beams *beams, const struct beam_pair *t,
                             const double *vector)
{
    double sum = -beam_row_moved_by(beams, &t->row, vector);
    for (int k = 0; k < t->n; k++)
        for (int c = 0; c < 2; c++) {
            const int64_t row = beams->node[t->node[k]].unknown[c];
            if (row >= 0) sum += t->part[k] * t->row.e[c] * vector[row];
        }
    return sum;
}

static double *column_of(const struct beams *beams, int j)
{
    return &beams->contact->column[j * beams->size];
}

static void find_compliance(struct beams *beams)
{
    struct beam_contact *const contact = beams->contact;
    for (int j = 0; j < contact->n; j++) {
        const struct beam_pair *const t = &contact->pair[j];
        double *const column = column_of(beams, j);
        memset(column, 0, (size_t)beams->size * sizeof *column);
        for (int k = 0; k < t->n; k++)
            for (int c = 0; c < 2; c++) {
                const int64_t row = beams->node[t->node[k]].unknown[c];
                if (row >= 0) column[row] += t->part[k] * t->row.e[c];
            }
        envelope_solve(&beams->matrix, column);
        beam_row_move(beams, &t->row, column);
        beams_resist_joints(beams, column);
        for (int i = 0; i < contact->n; i++)
            contact->compliance[(size_t)i * (size_t)contact->most + (size_t)j] =
                along_unknowns(beams, &contact->pair[i], column);
    }
}

/* Projected Gauss-Seidel, in the order of the pairs: no force pulls. */
bool beams_correct_pairs(struct beams *beams)
{
    enum { TURNS = 1000 };
    struct beam_contact *const contact = beams->contact;
    double largest = (double)INFINITY, first = 0;
    if (contact->n == 0) return true;
    find_compliance(beams);
    for (int j = 0; j < contact->n; j++)
        contact->open[j] = contact->pair[j].gap + along_pair(beams, &contact->pair[j]) +
                           along_unknowns(beams, &contact->pair[j], beams->unknown);
    for (int turn = 0; turn < TURNS && largest > 0.1 * KEPT * beams->scene->top.dp; turn++) {
        largest = 0;
        for (int j = 0; j < contact->n; j++) {
            struct beam_pair *const t = &contact->pair[j];
            const double own = contact->compliance[(size_t)j * (size_t)contact->most + (size_t)j];
            const double force = own > 0 ? max2(0, t->row.force - contact->open[j] / own) : 0,
                         more = force - t->row.force;
            t->row.force = force;
            largest = max2(largest, fabs(more) * own);
            for (int i = 0; i < contact->n && more != 0; i++)
                contact->open[i] +=
                    more * contact->compliance[(size_t)i * (size_t)contact->most + (size_t)j];
            for (int64_t r = 0; r < beams->size && more != 0; r++)
                beams->unknown[r] += more * column_of(beams, j)[r];
        }
        if (turn == 0) first = largest;
    }
    return largest <= first;
}

void beams_finish_pairs(struct beams *beams, double dt)
{
    const struct beam_contact *const contact = beams->contact;
    for (int j = 0; j < contact->n; j++) {
        const struct beam_pair *const t = &contact->pair[j];
        beams->beam[beams->node[t->node[0]].beam].driven += t->row.force * t->moved;
        for (int c = 0; c < 3 && t->row.body >= 0; c++)
            beams->body[t->row.body].push[c] -= dt * t->row.force * t->row.along[c];
    }
}

int64_t beams_find_solid(const struct beams *beams, const struct particles *solid, double reach,
                         int *beam)
{
    for (*beam = 0; *beam < beams->n; ++*beam) {
        const struct beam *const b = &beams->beam[*beam];
        const struct box2 box = box_of(beams, *beam);
        const double most = reach + half_of(beams, *beam);
        for (int64_t i = 0; i < solid->n; i++) {
            const double at[2] = {solid->x[i], solid->y[i]};
            const struct box2 place = {{at[0], at[1]}, {at[0], at[1]}};
            if (!box2_near(&place, &box, most)) continue;
            for (int m = b->first_element; m < b->end_element; m++) {
                double from[2], to[2];
                node_now(beams, beams->element[m].node[0], from);
                node_now(beams, beams->element[m].node[1], to);
                if (segment_foot(at, from, to, 0).distance < most) return i;
            }
        }
    }
    return -1;
}
