/* SPDX-License-Identifier: MIT
 * Internal to scene_sample: regions (geometry/sampling.c), their overlaps (geometry/overlap.c),
 * data of all points together (geometry/extent.c). */
#pragma once

#include "case/case.h"
#include "particles/particles.h"
#include "geometry/outline.h"

/* Offset of a centre for tests, in spacings. The two components differ so that a slanted edge
 * through a row of centres does not pass exactly through them either. */
#define NUDGE_X 1e-6
#define NUDGE_Y 0.618e-6

/* Parts per spacing that edges are divided into, to place points beside them. */
enum { EDGE_PARTS = 8 };

/* The region of one section. Its shapes are in the axes of its lattice. */
struct region {
    enum kind kind;
    int body; /* index of the section */
    const struct scene_section_common *common;
    const struct shape_list *list, *minus_list;
    struct outlines add, minus;
    struct scene_lattice lattice;
    struct box2 box;        /* of the shapes */
    int64_t n, n_clamped;   /* points inside, and those that a clamp holds */
    int64_t n_hinged;       /* of the latter those in a hinge */
    struct outlines clamps; /* of a solid */
    bool *layered;          /* [add.n]: whether a piece is sampled in layers (geometry/layers.c) */
    bool has_layers;
};

struct sampler {
    struct scene *scene;
    struct diag *diag;
    struct arena temp;
    int n_regions;
    struct region *regions; /* solids, walls, fluids: in order of priority */
    int problems;           /* found so far */
};

/* A position in the axes of a lattice; and the inverse. */
SPHFSI_INLINE void lattice_place(const struct scene_lattice *l, double x, double y, double at[2])
{
    const bool turned = l->angle != 0;
    at[0] = turned ? x * l->turn[0] + y * l->turn[1] : x;
    at[1] = turned ? y * l->turn[0] - x * l->turn[1] : y;
}
SPHFSI_INLINE void place_of_lattice(const struct scene_lattice *l, double x, double y, double at[2])
{
    const bool turned = l->angle != 0;
    at[0] = turned ? x * l->turn[0] - y * l->turn[1] : x;
    at[1] = turned ? x * l->turn[1] + y * l->turn[0] : y;
}

/* A place in the axes of a region's lattice, with the rounding of centres. */
SPHFSI_INLINE void geometry_place(const struct region *region, double x, double y, double at[2])
{
    lattice_place(&region->lattice, x, y, at);
    at[0] += NUDGE_X * region->lattice.spacing[0];
    at[1] += NUDGE_Y * region->lattice.spacing[1];
}

/* The first index of a row or column of the lattice with its centre at or beyond x. */
SPHFSI_INLINE int64_t geometry_index(const struct region *region, int c, double x)
{
    const struct scene_lattice *const l = &region->lattice;
    return (int64_t)ceil((x - l->origin[c]) / l->spacing[c] - 0.5 - NUDGE_X);
}

/* The place of a position in cells of a lattice; and the inverse. */
SPHFSI_INLINE void cell_of_place(const struct scene_lattice *l, double x, double y, double cell[2])
{
    lattice_place(l, x, y, cell);
    for (int c = 0; c < 2; c++) cell[c] = (cell[c] - l->origin[c]) / l->spacing[c];
}
SPHFSI_INLINE void place_of_cell(const struct scene_lattice *l, const double cell[2], double at[2])
{
    place_of_lattice(l, l->origin[0] + cell[0] * l->spacing[0],
                     l->origin[1] + cell[1] * l->spacing[1], at);
}

/* All points, region after region. */
struct samples {
    int64_t n;
    double *x, *y;
    int32_t *region;
    uint8_t *clamped;
};

/* Walls with faces off the lattice (geometry/layers.c): sets region->layered of such pieces. */
enum err geometry_choose_layered(struct sampler *sampler, struct region *region) SPHFSI_CHECKED;
/* Adds their layers, then of the lattice's points `layered` in them those behind the layers, all in
 * the axes of the lattice; the points of other pieces, from index `from` on, are there. */
enum err geometry_lay_layers(struct sampler *sampler, const struct region *region, int64_t from,
                             const struct samples *layered, struct samples *to) SPHFSI_CHECKED;

/* Adds a point. */
SPHFSI_INLINE enum err geometry_sample(struct sampler *sampler, const struct region *region,
                                       double x, double y, struct samples *to)
{
    struct arena *const a = &sampler->temp;
    const size_t n = (size_t)to->n;
    TRY(arena_more(a, &to->x, n, "sampling", sampler->diag));
    TRY(arena_more(a, &to->y, n, "sampling", sampler->diag));
    TRY(arena_more(a, &to->region, n, "sampling", sampler->diag));
    TRY(arena_more(a, &to->clamped, n, "sampling", sampler->diag));
    to->x[n] = x;
    to->y[n] = y;
    to->region[n] = (int32_t)(region - sampler->regions);
    to->n++;
    return ERR_OK;
}

/* Points *to at n zeroed items, which last until the scene is sampled. */
#define geometry_array(sampler, to, n) \
    arena_array(&(sampler)->temp, to, n, "sampling", (sampler)->diag)

/* Turns ERR_INPUT, whose message is in the diag, into ERR_OK, so that the next section is checked
 * too; not after CASE_MAX_PROBLEMS of them, with those of values. scene_sample returns the error
 * before code that needs valid input. */
SPHFSI_INLINE enum err geometry_go_on(struct sampler *sampler, enum err e)
{
    sampler->problems += e == ERR_INPUT;
    return e == ERR_INPUT && sampler->diag && diag_count(sampler->diag) < CASE_MAX_PROBLEMS ? ERR_OK
                                                                                            : e;
}

/* A problem of a line of the case, so treated. */
#define geometry_refuse(sampler, line, ...) \
    geometry_go_on(sampler, fail_at((sampler)->diag, (sampler)->scene, line, __VA_ARGS__))

/* Gives the lines of a wall their thickness, once the outlines of the fluid are known. */
enum err geometry_thicken(struct sampler *sampler, const struct region *wall) SPHFSI_CHECKED;

/* The thin lines of all walls and their dummies (geometry/thin.c), once walls have outlines. */
enum err geometry_thin(struct sampler *sampler) SPHFSI_CHECKED;
/* A particle of the wall into which a line goes on, and which it cuts, has a part on each side
 * (T-110g). Sets places and volumes over dp^2; returns the number of parts: 1 or 2. */
int geometry_cut(const struct scene *scene, enum kind kind, int body, double x, double y,
                 double to[2][3]);
/* Appends the dummies of a wall's lines to its particles. */
void geometry_thin_store(struct scene *scene, int wall);

/* Sets every region's lattice, from shapes before rotation, and the scene's lattices. */
enum err geometry_choose_lattices(struct sampler *sampler) SPHFSI_CHECKED;

/* Whether a clamp is so small a circle that it is meant as a hinge. */
bool geometry_is_hinge(const struct shape *clamp, double dp);

/* Marks the particles of a solid, from index `from` on, that its clamps hold. */
enum err geometry_clamp(struct sampler *sampler, struct region *region, int64_t from,
                        struct samples *samples) SPHFSI_CHECKED;

/* Refuses bodies of one row of particles, and finds the area that a body's particles cover. */
enum err geometry_check_bodies(struct sampler *sampler) SPHFSI_CHECKED;
/* Smallest number of rows or columns of its lattice across a body. */
double geometry_rows_across(const struct region *region);

/* The regions of a scene that has been sampled, for questions about places. */
enum err geometry_draw(struct sampler *sampler) SPHFSI_CHECKED;

/* Memory for n points of a kind; `open`: also for their open boundary. */
enum err geometry_points(struct sampler *sampler, enum kind kind, int64_t n, bool open,
                         struct scene_points *to) SPHFSI_CHECKED;

/* Applies the rules of overlap and stores the points that remain in the scene. */
enum err geometry_merge(struct sampler *sampler, const struct samples *samples) SPHFSI_CHECKED;

/* Settles fluid near edges off its lattice, with `scheme = standard` (geometry/settle.c). */
enum err geometry_settle(struct sampler *sampler) SPHFSI_CHECKED;

/* The piece of a region at a place in the axes of its lattice, or -1. */
SPHFSI_INLINE int geometry_piece_at(const struct region *region, double u, double v)
{
    if (!box2_contains(&region->add.box, u, v) || outlines_find(&region->minus, u, v) >= 0)
        return -1;
    return outlines_find(&region->add, u, v);
}
/* Whether a region has a point inside, with the rounding of its particles. */
bool geometry_covers(const struct region *region, double x, double y);
/* Whether a point lies in a region, and further from its edges than round-off. */
bool geometry_covers_strictly(const struct region *region, double x, double y);

/* Fills the buffers of open boundaries. */
enum err geometry_open(struct sampler *sampler) SPHFSI_CHECKED;

/* Adds the beams, with their thickness, to what is cut out of a fluid. */
enum err geometry_subtract_beams(struct sampler *sampler, struct outlines *minus) SPHFSI_CHECKED;

/* Mass, centre and inertia of a rigid body from its shapes, which are not yet rotated. */
enum err geometry_rigid_mass(struct sampler *sampler, int rigid, const struct region *region)
    SPHFSI_CHECKED;

/* Effective domain; probes inside their bodies; initial values finite. */
enum err geometry_extent(struct sampler *sampler) SPHFSI_CHECKED;

/* Bodies that are bonded touch (geometry/bodies.c). */
enum err geometry_check_joined(struct sampler *sampler) SPHFSI_CHECKED;
