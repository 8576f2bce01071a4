/* SPDX-License-Identifier: MIT
 * Thin lines (T-110): walls thinner than a particle with fluid on both sides. Particles that a line
 * separates do not interact; behind the line each side has dummies of its own. The nodes of a line
 * may move in any way; its dummies follow them, and hand their forces back. */
#pragma once

#include "base/box2.h"
#include "geometry/thin.h"
#include "particles/cells.h"

/* An end of a part of a line. Parts that meet have one each: they turn together, or form a
 * corner. */
struct line_end {
    double x[2], normal[2]; /* unit vector to the left */
    double v[2], rate;      /* rate: of the normal's angle */
    double a[2], angular_acceleration;
};

struct thin_line {
    const struct scene_thin_line *given;
    int64_t first;        /* number of its first dummy among the particles of walls */
    struct line_end *end; /* [2 * parts]: those of part k are 2k and 2k + 1 */
    int n_pieces;
    struct line_piece {
        double from[2], to[2], start, length; /* start: along the line, m */
    } * piece; /* its parts between its extensions, which may have no length */
    double length;
    struct box2 box;
    const struct moving_wall *follows, *starts_at[2]; /* walls; NULL: at rest, or none */
    double extend[2]; /* how far it continues into a wall beyond its ends, m (T-111b) */
    bool tip[2];      /* whether it ends there: fluid may flow round it */
    bool bends;       /* of a beam */
    double dp;
    /* The rigid motion that the fluid sees along a beam (T-111a): with the rate of turning and its
     * rate. `mass_over_inertia`: the mass over the moment of inertia, 1/m^2. */
    struct line_carrier {
        double x[2], v[2], a[2], spin, spin_rate, mass_over_inertia;
    } carrier;
};

struct lines {
    int n, n_pieces; /* of all lines */
    struct thin_line *line;
    int32_t *of_wall; /* [particles of walls]: 1 + number of the line that a dummy belongs to, or
                         0 */
    double *filled;   /* [particles of walls]: phi of T-110c */
    const double *volume; /* [particles of walls], over dp^2 */
};

enum err lines_create(struct lines *lines, struct arena *a, const struct scene *scene,
                      struct particles *walls, struct diag *d) SPHFSI_CHECKED;

/* Moves a line's ends as a wall with that motion. */
void line_follow(struct thin_line *line, const struct motion_state *motion);

/* Sets a line and its dummies from its ends. A dummy is tied to both ends of its part, as if it
 * were rigid with each, by linear shape functions (T-111). Ends leave walls (T-111b) by places of
 * the state alone: those of a predictor differ from a wall's by its error. */
void line_place(struct thin_line *line, struct particles *walls, bool predicted);

/* The place on the line that its dummy number j lies behind. */
void line_foot(const struct thin_line *line, int64_t j, double at[2]);

/* What a vector at dummy number j does to the ends of its part by the same functions: the vector
 * and its moment about the end. */
void line_at_ends(const struct thin_line *line, int64_t j, double x, double y, double to[6]);

/* The direction of the line at its dummy number j. */
void line_tangent(const struct thin_line *line, int64_t j, double t[2]);

/* T-110c: the direction in which fluid slides past particle i of the walls, a dummy of the line;
 * left as it is on a line without tips (T-110d), beyond a corner, and beyond an end that
 * begins at a wall. */
void line_slides(const struct thin_line *line, int64_t i, double t[2]);

/* T-110, T-110e: how much of each other two places see, of which the second is a dummy of the line
 * `own`, from 1, with the share phi, `filled`; 0: of none. `offset`: the second place less the
 * first, `from`; `reach` of the kernel, m. */
double lines_seen(const struct lines *lines, const struct cells *cells, double reach,
                  const double from[2], const double offset[2], int32_t own, double filled);
