/* SPDX-License-Identifier: MIT
 * Judges a scene before it runs: what can be simulated but is probably a mistake, or costs more
 * time than it needs. Each warning has the consequence and the remedy. What cannot be simulated is
 * refused where it is read or sampled, beams in beams.c. */
#pragma once

#include "geometry/sampling.h"
#include "time/simulation.h"

/* Warns of a scene that has been sampled, and completes it: off_lattice, full and given_speed, and
 * the default of `shifting` and `shifting_speed` in a full channel with bodies that stick. */
enum err check_scene(struct scene *scene, struct diag *d) SPHFSI_CHECKED;

/* Warns of steps that are unstable or much too short: to be called after a step. */
void check_simulation(const struct simulation *sim, struct diag *d);

/* --- within this folder --- */

/* Kinds of points, one bit each: fluid without that of buffers; walls and solids; buffers. */
enum { POINT_FLUID = 1, POINT_BODY = 2, POINT_BUFFER = 4, POINT_ANY = 7 };

/* All points of a scene by cell. */
struct points {
    struct point_grid grid;
    int64_t n;
    double *x, *y;
    int32_t *section; /* of fluid, walls and solids, each from 0 */
    uint8_t *kind;    /* enum kind */
    uint8_t *bit;
};

struct check {
    struct scene *scene;
    struct diag *diag;
    struct sampler shapes; /* as drawn; its arena holds all memory of the check */
    struct points points;
};

/* A solid, wall, rigid body or beam. */
struct body {
    const struct scene_section_common *common;
    const char *motion; /* of its clamps or of it all, or "" */
    int slip;           /* enum slip */
    enum kind kind;
    int index; /* among the points of this kind */
};
/* The k-th body of a scene, walls after solids. */
struct body body_at(const struct scene *scene, int k);

enum err list_points(struct check *check) SPHFSI_CHECKED;
/* The region of walls or solids that covers a place as drawn, or -1. */
int drawn_at(const struct check *check, double x, double y);
/* The first point of these kinds near a place, through periodic sides too; -1: none. */
int64_t point_at(const struct check *check, const double at[2], double within, int kinds);
/* The point of these kinds that is next to point k in a direction, or -1. */
int64_t point_beside(const struct check *check, int64_t k, const double toward[2], double within,
                     int kinds);
/* Extent of a section's points along a vector times its length, without buffers; 0: none. */
double extent_along(const struct scene *scene, enum kind kind, int section, const double along[2]);
/* The largest initial velocity of a section's points, m/s. */
double start_speed(const struct scene *scene, enum kind kind, int section,
                   const struct scene_expr *velocity);

/* A warning that begins with the place of a section and its title. */
#define warn_section(check, section, format, ...)                         \
    warn_at((check)->diag, (check)->scene, (section)->line, "%s " format, \
            section_title(section).text, ##__VA_ARGS__)
/* Takes note of a speed that the case gives the fluid, and warns if it is near that of sound. */
void warn_of_speed(struct check *check, int line, double speed, const char *format, ...)
    SPHFSI_PRINTF(4, 5);
void warn_of_values(struct check *check);
enum err refuse_beams(const struct check *check) SPHFSI_CHECKED;
enum err warn_of_shapes(struct check *check) SPHFSI_CHECKED;
enum err warn_of_fluid(struct check *check) SPHFSI_CHECKED;
enum err warn_of_solids(struct check *check) SPHFSI_CHECKED;
