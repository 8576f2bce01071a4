/* SPDX-License-Identifier: MIT
 * From [beam] sections to nodes and elements, and what output asks of them. */
#include "beam/beam.h"
#include "base/segment.h"
#include "geometry/sampling.h"

static const char what[] = "beams";

/* --- lines --- */

static void count_elements(struct beams *beams)
{
    for (int k = 0; k < beams->n; k++) {
        struct beam *const b = &beams->beam[k];
        const struct shape *const line = b->given->shape.item;
        b->first_node = beams->n_nodes;
        b->first_element = beams->n_elements;
        for (int s = 0; s + 1 < line->n; s++)
            beams->n_elements +=
                scene_beam_parts(beams->scene, b->given, line->pt[s], line->pt[s + 1]);
        b->end_element = beams->n_elements;
        const double *const first = line->pt[0], *const last = line->pt[line->n - 1];
        const bool closed = line->n > 3 && first[0] == last[0] && first[1] == last[1];
        beams->n_nodes += b->end_element - b->first_element + !closed;
        b->end_node = beams->n_nodes;
    }
}

/* EA, GA, EI per depth: T-103b. */
static void stiffness_of(const struct scene_beam *b, double of[3])
{
    const double young = b->plane == PLANE_STRAIN ? b->young / (1 - square(b->poisson)) : b->young,
                 t = b->thickness, shear = 5.0 / 6 * b->young / (2 + 2 * b->poisson) * t;
    of[0] = isnan(b->axial_stiffness) ? young * t : b->axial_stiffness;
    of[1] = isnan(b->shear_stiffness) ? shear : b->shear_stiffness;
    of[2] = isnan(b->bending_stiffness) ? young * t * t * t / 12 : b->bending_stiffness;
}

/* T-103d: Gregory's quadrature of n equal elements, exact for cubic functions. */
static double weight_of(int k, int n)
{
    static const double ends[] = {3.0 / 8, 7.0 / 6, 23.0 / 24};
    const int last = n - k;
    if (n == 1) return 0.5;
    return 1 + (k < 3 ? ends[k] - 1 : 0) + (last < 3 ? ends[last] - 1 : 0);
}

/* The elements of one segment; returns its last node. */
static int place_segment(struct beams *beams, int beam, int from, const double a[2],
                         const double b[2], int *element)
{
    struct beam *const of = &beams->beam[beam];
    const struct scene_beam *const given = of->given;
    const int n = scene_beam_parts(beams->scene, given, a, b);
    const double length = elementary_hypot(b[0] - a[0], b[1] - a[1]) / n;
    const double mass = isnan(given->mass) ? given->density * given->thickness : given->mass;
    const double rotary = isnan(given->thickness) ? 0 : square(given->thickness) / 12;
    double stiffness[3];
    stiffness_of(given, stiffness);
    /* T-103c, MacNeal 1978. Without a shear stiffness it is rigid in shear. */
    const double bent = square(length) / (12 * stiffness[2]);
    stiffness[1] = 1 / (bent + (isnan(stiffness[1]) ? 0 : 1 / stiffness[1]));
    int node = from;
    for (int k = 0; k <= n; k++) {
        const int at = from + k < of->end_node ? from + k : of->first_node;
        struct beam_node *const to = &beams->node[at];
        to->beam = beam;
        for (int c = 0; c < 2; c++) to->X[c] = a[c] + (b[c] - a[c]) * k / n;
        to->length += k == 0 || k == n ? 0.5 * length : length;
        for (int c = 0; c < 3; c++)
            to->mass[c] += mass * length * weight_of(k, n) * (c < 2 ? 1 : rotary);
        if (k > 0) {
            struct beam_element *const e = &beams->element[(*element)++];
            *e = (struct beam_element){.node = {node, at},
                                       .between = {(b[0] - a[0]) / n, (b[1] - a[1]) / n},
                                       .length = length,
                                       .damping_time = given->damping_time};
            memcpy(e->stiffness, stiffness, sizeof stiffness);
        }
        node = at;
    }
    return node;
}

static void place_nodes(struct beams *beams)
{
    int element = 0;
    for (int k = 0; k < beams->n; k++) {
        const struct shape *const line = beams->beam[k].given->shape.item;
        int node = beams->beam[k].first_node;
        for (int s = 0; s + 1 < line->n; s++)
            node = place_segment(beams, k, node, line->pt[s], line->pt[s + 1], &element);
    }
}

/* --- clamps, hinges, loads, springs --- */

/* Joined nodes have the unknowns of the last one of their chain: that of component c. */
static struct beam_node *owner_of(const struct beams *beams, int k, int c)
{
    while (beams->node[k].joined[c == 2] >= 0) k = beams->node[k].joined[c == 2];
    return &beams->node[k];
}

/* Joins a node, and all that it is joined to, to one of another beam. */
static enum err join(struct beams *beams, int k, const struct hinge_point *at, bool turns,
                     struct diag *d)
{
    struct beam_node *const node = &beams->node[k];
    const struct beam_place place =
        beam_find(beams, scene_find(beams->scene, SECTION_beam, at->other), node->X);
    const struct beam_element *const e = &beams->element[place.element];
    const int to = e->node[place.part > 0.5];
    const double *const X = beams->node[to].X;
    const double apart = elementary_hypot(X[0] - node->X[0], X[1] - node->X[1]);
    if (apart > 1e-6 * e->length)
        return fail_at(d, beams->scene, at->line,
                       "[beam %s] %s = %g, %g, %s: the nearest nodes of both beams are %.3g m "
                       "apart; give both lines a point there",
                       beams->beam[node->beam].given->common.name, turns ? "hinge" : "clamp",
                       at->at[0], at->at[1], at->other, apart);
    for (int c = 1; c < (turns ? 2 : 3); c++) {
        struct beam_node *const from = owner_of(beams, k, c), *const owner = owner_of(beams, to, c);
        if (from != owner) from->joined[c == 2] = (int)(owner - beams->node);
    }
    return ERR_OK;
}

/* Where several hold a place, they move alike: one that is held, and another hold. */
static enum err refuse_other_motion(const struct beams *beams, const struct beam_node *held,
                                    const struct beam_node *other, struct diag *d)
{
    const struct scene *const scene = beams->scene;
    const int movers[] = {other->mover, held->mover};
    struct section_title motion[2] = {{"no motion"}, {"no motion"}};
    if (held->unknown[0] >= 0 || movers[0] == movers[1]) return ERR_OK;
    for (int k = 0; k < 2; k++)
        if (movers[k] >= 0) motion[k] = section_title(&scene->motion[movers[k]].common);
    return fail_at(d, scene, other->line,
                   "[beam %s] is held at %g, %g with %s, but %s holds this point with %s; leave "
                   "one `clamp` or `hinge` out, or give both the same motion",
                   beams->beam[other->beam].given->common.name, other->X[0], other->X[1],
                   motion[0].text, scene_place(scene, held->line).text, motion[1].text);
}

/* Holds the node nearest to each point: its displacements, with clamps its rotation, too. */
static enum err hold(struct beams *beams, int beam, const struct hinge_list *list, bool turns,
                     struct diag *d)
{
    const struct scene_beam *const given = beams->beam[beam].given;
    for (int k = 0; k < list->n; k++) {
        const struct hinge_point *const at = &list->item[k];
        const struct beam_place place = beam_find(beams, beam, at->at);
        const struct beam_element *const e = &beams->element[place.element];
        if (place.distance > 0.5 * e->length)
            return fail_at(d, beams->scene, at->line,
                           "[beam %s] %s = %g, %g is %.3g m from the beam; move it onto its line",
                           given->common.name, turns ? "hinge" : "clamp", at->at[0], at->at[1],
                           place.distance);
        struct beam_node *const node = &beams->node[e->node[place.part > 0.5]];
        if (scene_find(beams->scene, SECTION_beam, at->other) >= 0) {
            TRY(join(beams, e->node[place.part > 0.5], at, turns, d));
            continue;
        }
        const int body = rigid_find(beams->scene, at->other);
        if (node->body >= 0 || (body >= 0 && node->unknown[0] < 0))
            return fail_at(d, beams->scene, at->line,
                           "[beam %s] %s = %g, %g, %s: another `clamp` or `hinge` holds this "
                           "point; where one is on a [rigid], it must be the only one",
                           given->common.name, turns ? "hinge" : "clamp", at->at[0], at->at[1],
                           at->other);
        const struct beam_node before = *node;
        node->body = body;
        node->pivots = turns;
        node->line = at->line;
        if (body >= 0) continue;
        const int wall = scene_find(beams->scene, SECTION_wall, at->other);
        node->mover = wall >= 0 ? scene_wall_motion(beams->scene, wall)
                                : scene_find(beams->scene, SECTION_motion, given->motion);
        TRY(refuse_other_motion(beams, &before, node, d));
        for (int c = 0; c < (turns ? 2 : 3); c++) node->unknown[c] = -1;
    }
    return ERR_OK;
}

static enum err find_load(struct beams *beams, int section, struct arena *temp, struct diag *d)
{
    const struct scene *const scene = beams->scene;
    const struct scene_load *const from = &scene->load[section];
    const int beam = scene_find(scene, SECTION_beam, from->body), first = beams->n_loads;
    struct outlines o;
    double length = 0;
    if (beam < 0) return ERR_OK;
    TRY(outlines_of(&o, scene, &from->shape, temp, d));
    for (int k = beams->beam[beam].first_node; k < beams->beam[beam].end_node; k++) {
        /* An edge counts as in the sampling of bodies. */
        const double x = beams->node[k].X[0] + NUDGE_X * scene->top.dp,
                     y = beams->node[k].X[1] + NUDGE_Y * scene->top.dp;
        if (outlines_find(&o, x, y) < 0) continue;
        beams->load[beams->n_loads++] =
            (struct beam_load){.section = section, .node = k, .length = beams->node[k].length};
        length += beams->node[k].length;
    }
    for (int k = first; k < beams->n_loads; k++)
        beams->load[k].part = beams->load[k].length / length;
    if (beams->n_loads > first) return ERR_OK;
    return fail_at(d, scene, from->common.line,
                   "[load %s] contains no node of [beam %s]; nodes are up to %.3g m apart; move or "
                   "enlarge its `shape`",
                   from->common.name, from->body,
                   beams->element[beams->beam[beam].first_element].length);
}

static enum err create_springs(struct beams *beams, struct arena *a, struct diag *d)
{
    const struct scene *const scene = beams->scene;
    beams->n_springs = scene->n_spring;
    beams->spring = arena_alloc(a, (size_t)scene->n_spring, sizeof *beams->spring, "springs", d);
    if (!beams->spring) return ERR_MEMORY;
    for (int k = 0; k < scene->n_spring; k++) {
        const struct scene_spring *const given = &scene->spring[k];
        const int beam = scene_find(scene, SECTION_beam, given->body);
        beams->spring[k] = (struct beam_spring){.given = given, .node = -1};
        if (beam < 0) continue;
        const struct beam_place place = beam_find(beams, beam, given->from);
        const struct beam_element *const e = &beams->element[place.element];
        const int node = e->node[place.part > 0.5];
        const double *const X = beams->node[node].X;
        if (place.distance > 0.5 * e->length)
            return fail_at(d, scene, key_line(scene, SECTION_spring, k, "from"),
                           "[spring %s] from = %g, %g is %.3g m from [beam %s]; move it onto its "
                           "line",
                           given->common.name, given->from[0], given->from[1], place.distance,
                           given->body);
        beams->spring[k].node = node;
        beams->spring[k].length = isnan(given->length)
                                      ? elementary_hypot(X[0] - given->to[0], X[1] - given->to[1])
                                      : given->length;
    }
    return ERR_OK;
}

/* --- unknowns --- */

/* What holds one of them holds all. */
static enum err share_holds(struct beams *beams, struct diag *d)
{
    for (int k = 0; k < beams->n_nodes; k++)
        for (int c = 0; c < 3; c++) {
            struct beam_node *const to = owner_of(beams, k, c);
            const struct beam_node *const from = &beams->node[k];
            if (from->unknown[c] >= 0 || to == from) continue;
            if (c == 0) TRY(refuse_other_motion(beams, to, from, d));
            to->unknown[c] = -1;
            to->mover = from->mover;
            to->line = from->line;
        }
    return ERR_OK;
}

static void share_unknowns(struct beams *beams)
{
    for (int k = 0; k < beams->n_nodes; k++)
        for (int c = 0; c < 3; c++) {
            const struct beam_node *const to = owner_of(beams, k, c);
            beams->node[k].unknown[c] = to->unknown[c];
            beams->node[k].mover = c == 0 ? to->mover : beams->node[k].mover;
        }
}

/* A joint on a rigid body is all that holds its unknown. */
static enum err refuse_held_twice(const struct beams *beams, struct diag *d)
{
    for (int k = 0; k < beams->n_nodes; k++) {
        const struct beam_node *const node = &beams->node[k];
        bool twice = node->body >= 0 && node->unknown[0] < 0;
        for (int j = 0; j < k; j++)
            twice |= node->body >= 0 && beams->node[j].body >= 0 &&
                     node->unknown[0] == beams->node[j].unknown[0];
        if (twice)
            return fail_at(d, beams->scene, node->line,
                           "more than one `clamp` or `hinge` holds the beams that are joined at "
                           "%g, %g; where one is on a [rigid], it must be the only one",
                           node->X[0], node->X[1]);
    }
    return ERR_OK;
}

static enum err number_unknowns(struct beams *beams, struct arena *a, struct arena *temp,
                                struct diag *d)
{
    int64_t n = 0;
    TRY(share_holds(beams, d));
    for (int k = 0; k < beams->n_nodes; k++)
        for (int c = 0; c < 3; c++) {
            const struct beam_node *const node = &beams->node[k];
            if (node->unknown[c] >= 0 && node->joined[c == 2] < 0) beams->node[k].unknown[c] = n++;
        }
    share_unknowns(beams);
    TRY(refuse_held_twice(beams, d));
    int64_t *const first = arena_alloc(temp, (size_t)n, sizeof *first, what, d);
    if (!first) return ERR_MEMORY;
    for (int64_t k = 0; k < n; k++) first[k] = k;
    for (int m = 0; m < beams->n_elements; m++)
        for (int r = 0; r < 6; r++)
            for (int c = 0; c < 6; c++) {
                const int *const node = beams->element[m].node;
                const int64_t row = beams->node[node[r / 3]].unknown[r % 3],
                              column = beams->node[node[c / 3]].unknown[c % 3];
                if (row >= 0 && column >= 0 && column < first[row]) first[row] = column;
            }
    return envelope_create(&beams->matrix, a, n, first, d);
}

static enum err set_start(struct beams *beams, struct diag *d)
{
    for (int k = 0; k < beams->n_nodes; k++) {
        const struct beam_node *const node = &beams->node[k];
        const struct scene_beam *const given = beams->beam[node->beam].given;
        double *const v = beams->state[k].v;
        for (int c = 0; c < 2; c++)
            v[c] = beams->state[k].w[c] =
                given->velocity.e[c] && node->unknown[c] >= 0
                    ? expr_at(given->velocity.e[c], node->X[0], node->X[1])
                    : 0;
        if (!isfinite(v[0] + v[1]))
            return fail_at(d, beams->scene, given->common.line,
                           "[beam %s] velocity is not finite at (%g, %g) m; change the expression",
                           given->common.name, node->X[0], node->X[1]);
    }
    return ERR_OK;
}

static enum err create_all(struct beams *beams, struct arena *a, struct arena *temp, struct diag *d)
{
    const struct scene *const scene = beams->scene;
    const size_t n = (size_t)beams->n_nodes;
    TRY(arena_array(a, &beams->node, n, what, d));
    TRY(arena_array(a, &beams->state, n, what, d));
    TRY(arena_array(a, &beams->step, n, what, d));
    TRY(arena_array(a, &beams->element, beams->n_elements, what, d));
    TRY(arena_array(a, &beams->start, beams->n_elements, what, d));
    TRY(arena_array(a, &beams->load, n * (size_t)scene->n_load, what, d));
    for (size_t k = 0; k < n; k++) {
        struct beam_node *const node = &beams->node[k];
        node->mover = node->joined[0] = node->joined[1] = node->body = -1;
    }
    place_nodes(beams);
    for (int k = 0; k < beams->n; k++) {
        TRY(hold(beams, k, &beams->beam[k].given->hinge, true, d));
        TRY(hold(beams, k, &beams->beam[k].given->clamp, false, d));
    }
    for (int k = 0; k < scene->n_load; k++) TRY(find_load(beams, k, temp, d));
    TRY(number_unknowns(beams, a, temp, d));
    TRY(set_start(beams, d));
    TRY(create_springs(beams, a, d));
    TRY(beams_bodies_create(beams, a, d));
    TRY(beams_joints_create(beams, a, d));
    return beams_contact_create(beams, a, d);
}

enum err beams_create(struct beams *beams, struct arena *a, const struct scene *scene,
                      struct diag *d)
{
    *beams = (struct beams){.n = scene->n_beam, .scene = scene};
    TRY(arena_array(a, &beams->beam, beams->n, what, d));
    for (int k = 0; k < beams->n; k++) beams->beam[k].given = &scene->beam[k];
    count_elements(beams);
    struct arena temp = {.limit = a->limit};
    const enum err e = create_all(beams, a, &temp, d);
    arena_free(&temp);
    return e;
}

/* --- for output --- */

struct beam_place beam_find(const struct beams *beams, int beam, const double at[2])
{
    struct beam_place best = {.distance = HUGE_VAL};
    for (int k = beams->beam[beam].first_element; k < beams->beam[beam].end_element; k++) {
        const struct beam_element *const e = &beams->element[k];
        const struct segment_foot f =
            segment_foot(at, beams->node[e->node[0]].X, beams->node[e->node[1]].X, 0);
        if (f.distance < best.distance) best = (struct beam_place){k, f.part, f.distance};
    }
    return best;
}

static void strain_of(const struct beams *beams, int element, double strain[3])
{
    const struct beam_element *const e = &beams->element[element];
    const double *const q[2] = {beams->state[e->node[0]].x, beams->state[e->node[1]].x};
    double turn[2];
    beam_strain(e, q, strain, turn);
}

void beam_section_force(const struct beams *beams, const struct beam_place *place, double out[4])
{
    const struct beam_element *const e = &beams->element[place->element];
    double strain[3];
    strain_of(beams, place->element, strain);
    for (int i = 0; i < 3; i++) out[i] = e->stiffness[i] * strain[i];
    /* The shear force is constant within an element, and the moment falls by it (T-103c). */
    out[2] -= out[1] * (place->part - 0.5) * e->length;
    out[3] = out[2] / e->stiffness[2];
}

void beam_reaction(const struct beams *beams, int beam, const double about[2], double out[3])
{
    out[0] = out[1] = out[2] = 0;
    for (int k = beams->beam[beam].first_node; k < beams->beam[beam].end_node; k++) {
        const double *const f = beams->state[k].reaction;
        const double x = beams->node[k].X[0] + beams->state[k].x[0] - about[0],
                     y = beams->node[k].X[1] + beams->state[k].x[1] - about[1];
        out[0] += f[0];
        out[1] += f[1];
        out[2] += f[2] + x * f[1] - y * f[0];
    }
}

struct body_energy beam_energy(const struct beams *beams, int beam)
{
    const struct beam *const b = &beams->beam[beam];
    const double *const g = beams->scene->top.gravity;
    struct body_energy sum = {0};
    beam_add_spring_energy(beams, beam, &sum);
    for (int k = b->first_node; k < b->end_node; k++) {
        const struct beam_node *const node = &beams->node[k];
        const struct beam_state *const s = &beams->state[k];
        for (int c = 0; c < 3; c++) {
            sum.kinetic += 0.5 * node->mass[c] * square(s->v[c]);
            sum.undelivered += s->impulse[c] * s->w[c];
        }
        for (int c = 0; c < 2; c++) {
            sum.momentum[c] += node->mass[c] * s->v[c] - s->impulse[c];
            if (b->given->gravity) sum.potential -= node->mass[c] * g[c] * (node->X[c] + s->x[c]);
        }
        sum.mass += node->mass[0];
    }
    for (int k = b->first_element; k < b->end_element; k++) {
        const struct beam_element *const e = &beams->element[k];
        double strain[3];
        strain_of(beams, k, strain);
        for (int i = 0; i < 3; i++)
            sum.elastic += 0.5 * e->length * e->stiffness[i] * square(strain[i]);
    }
    return sum;
}
