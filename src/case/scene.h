/* SPDX-License-Identifier: MIT
 * What the user asked for: the case file as a struct (from case/params.def) and the points sampled from
 * its shapes. All memory belongs to the scene's arena. Units: SI. */
#ifndef SPHFSI_CASE_SCENE_H
#define SPHFSI_CASE_SCENE_H

#include "base/base.h"

enum { SCENE_TEXT = 256, SCENE_NAME = 64, SCENE_MAX_SECTIONS = 64 };

enum shape_kind { SHAPE_BOX, SHAPE_POLYGON, SHAPE_POLYLINE, SHAPE_CIRCLE };

struct shape {
    enum shape_kind kind;
    int n; /* points: box 2 (lower left, upper right), circle 1, else >= 2 */
    double (*pt)[2];
    double size; /* radius of a circle; thickness of a polyline, to the left of its direction if
                         positive, to the right if negative; else 0 */
    int line;
};

struct shape_list {
    int n;
    struct shape *item;
};

struct number_list {
    int n;
    double *value;
};

/* Up to two expressions in x and y, or in x, y and t, or one in t; see case/expr.h. NULL: not given. */
struct expr;
struct scene_expr {
    struct expr *e[2];
};

/* The name behind the section's word and the line it starts at. */
struct scene_section_common {
    char name[SCENE_NAME];
    int line;
};

/* One struct for each section of case/params.def, with a member for each of its keys. */
#define REAL(section, key, def, lo, hi, unit, meaning) double key;
#define INTEGER(section, key, def, lo, hi, meaning) int key;
#define CHOICE(section, key, def, names, meaning) int key;
#define TEXT(section, key, def, meaning) char key[SCENE_TEXT];
#define VECTOR(section, key, dx, dy, unit, meaning) double key[2];
#define TIME_VECTOR(section, key, dx, dy, unit, meaning) \
    double key[2];                                       \
    struct scene_expr key##_in_time;
#define FIELD_EXPR(section, key, count, unit, meaning) struct scene_expr key;
#define TIME_EXPR(section, key, unit, meaning) struct scene_expr key;
#define FLOW_EXPR(section, key, count, unit, meaning) struct scene_expr key;
#define SHAPES(section, key, meaning) struct shape_list key;
#define NUMBERS(section, key, unit, meaning) struct number_list key;
#define PARAMS_OF(section) ONLY_##section /* 0 where it is not defined */
#define PARAMS_KEEP

#define ONLY_top 1
struct scene_top {
    struct scene_section_common common;
#include "case/params.def"
};
#undef ONLY_top

#define ONLY_numerics 1
struct scene_numerics {
    struct scene_section_common common;
#include "case/params.def"
};
#undef ONLY_numerics

#define ONLY_domain 1
struct scene_domain {
    struct scene_section_common common;
#include "case/params.def"
};
#undef ONLY_domain

#define ONLY_output 1
struct scene_output {
    struct scene_section_common common;
#include "case/params.def"
};
#undef ONLY_output

#define ONLY_fluid 1
struct scene_fluid {
    struct scene_section_common common;
#include "case/params.def"
};
#undef ONLY_fluid

#define ONLY_wall 1
struct scene_wall {
    struct scene_section_common common;
#include "case/params.def"
};
#undef ONLY_wall

#define ONLY_solid 1
struct scene_solid {
    struct scene_section_common common;
#include "case/params.def"
};
#undef ONLY_solid

#define ONLY_contact 1
struct scene_contact {
    struct scene_section_common common;
#include "case/params.def"
};
#undef ONLY_contact

#define ONLY_load 1
struct scene_load {
    struct scene_section_common common;
#include "case/params.def"
};
#undef ONLY_load

#define ONLY_motion 1
struct scene_motion {
    struct scene_section_common common;
#include "case/params.def"
};
#undef ONLY_motion

#define ONLY_inflow 1
struct scene_inflow {
    struct scene_section_common common;
#include "case/params.def"
};
#undef ONLY_inflow

#define ONLY_outflow 1
struct scene_outflow {
    struct scene_section_common common;
#include "case/params.def"
};
#undef ONLY_outflow

#define ONLY_probe 1
struct scene_probe {
    struct scene_section_common common;
#include "case/params.def"
};
#undef ONLY_probe

#define ONLY_reference 1
struct scene_reference {
    struct scene_section_common common;
#include "case/params.def"
};
#undef ONLY_reference

#undef PARAMS_OF
#undef PARAMS_KEEP
#undef SECTION
#undef REAL
#undef INTEGER
#undef CHOICE
#undef TEXT
#undef VECTOR
#undef TIME_VECTOR
#undef FIELD_EXPR
#undef TIME_EXPR
#undef FLOW_EXPR
#undef SHAPES
#undef NUMBERS

/* Values of the CHOICE keys, in the order of their names in case/params.def. */
enum integrator { INTEGRATOR_SYMPLECTIC, INTEGRATOR_VERLET, INTEGRATOR_LEAPFROG };
enum precision { PRECISION_MIXED, PRECISION_DOUBLE };
enum scene_kind {
    SCENE_SOLID,
    SCENE_FLUID,
    SCENE_COUPLED,
    SCENE_EITHER
}; /* what presets are told apart by */
enum scheme { SCHEME_PAPER, SCHEME_STANDARD };
enum accuracy { ACCURACY_DRAFT, ACCURACY_STANDARD, ACCURACY_FINE };
enum solid_precision { SOLID_PRECISION_SINGLE, SOLID_PRECISION_DOUBLE, SOLID_PRECISION_AUTO };
enum multirate { MULTIRATE_OFF, MULTIRATE_ON, MULTIRATE_AUTO };
enum suction { SUCTION_OFF, SUCTION_ON };
enum sides { SIDES_BOTH, SIDES_ONE };
enum periodic { PERIODIC_NONE, PERIODIC_X, PERIODIC_Y, PERIODIC_XY }; /* bit 0: x, bit 1: y */
enum slip { SLIP_FREE, SLIP_NONE };
enum snapshot_failure { SNAPSHOT_FAILURE_STOP, SNAPSHOT_FAILURE_GO_ON };
enum snapshot_precision { SNAPSHOT_PRECISION_SINGLE, SNAPSHOT_PRECISION_DOUBLE };
enum shifting_speed { SHIFTING_OWN, SHIFTING_LARGEST };
enum diffusion_form { DIFFUSION_MOLTENI, DIFFUSION_FOURTAKAS, DIFFUSION_ANTUONO };
enum particle_mass { MASS_EQUAL, MASS_HYDROSTATIC };
enum law { LAW_PAPER, LAW_SVK, LAW_NEO_HOOKEAN };
enum plane { PLANE_STRAIN, PLANE_STRESS };
enum gradient_order { GRADIENT_LINEAR, GRADIENT_QUADRATIC };
enum hourglass_form { HOURGLASS_PRINTED, HOURGLASS_VARIATIONAL };
enum viscosity_form { VISCOSITY_PRINTED, VISCOSITY_SYMMETRIC };
enum motion_kind {
    MOTION_VELOCITY,
    MOTION_POLYNOMIAL,
    MOTION_TABLE,
    MOTION_SINE,
    MOTION_ROTATION,
    MOTION_EXPRESSION
};
enum probe_quantity {
#define QUANTITY(NAME, name, target, columns, meaning) PROBE_##NAME,
#include "case/quantities.def"
#undef QUANTITY
    PROBE_QUANTITIES
};
/* What a quantity looks at: a material point of a solid, a point in the fluid, either (by whether a
 * body is named), a solid, a solid or wall, all fluid, a line in the fluid. */
enum probe_target {
    TARGET_SOLID_POINT,
    TARGET_FLUID_POINT,
    TARGET_ANY_POINT,
    TARGET_SOLID,
    TARGET_BODY,
    TARGET_FLUID,
    TARGET_FLUID_LINE
};
enum probe_direction { DIRECTION_RIGHT, DIRECTION_LEFT, DIRECTION_UP, DIRECTION_DOWN };

/* Points sampled from the shapes of one kind. Solids: body after body, each in rows along its
 * longer side, so that neighbours in the lattice are mostly neighbours in memory. */
struct scene_points {
    int64_t n;
    double *x, *y;
    int32_t *body;    /* index of the section among those of its kind */
    uint8_t *clamped; /* solids: 1 where a clamp holds the particle; else NULL */
    int32_t *open;    /* fluid: open boundary whose buffer it belongs to, from 1, or 0; or NULL */
};

/* The lattice that a region is sampled on. Cell (i, j) has its centre at origin + ((i, j) + 1/2) spacing in
 * axes that are turned by `angle`. */
struct scene_lattice {
    double angle;      /* rad */
    double turn[2];    /* its cosine and sine */
    double origin[2];  /* m, in the turned axes */
    double spacing[2]; /* m */
    double dp;         /* m: the root of a cell's area, which a particle stands for */
    bool fitted;       /* to edges that are no whole number of dp apart */
    double area;       /* of the shapes, m^2; solids */
};

/* A place in the axes of a lattice; and the other way round. */
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

/* A table, loaded from its file: n rows of a time and two values. n == 0: none. */
struct scene_table {
    int n;
    double *t, *x, *y;
    double *vx, *vy; /* of a motion: slopes at the rows, so that the velocity is continuous */
};

/* A named constant, evaluated. plain: it was written without a unit. */
struct scene_constant {
    char name[SCENE_NAME];
    double value;
    bool plain;
    double m, kg, s; /* powers of its unit */
};

/* A key that the case gives, as opposed to a default. */
struct scene_given {
    int section, index; /* enum section_id of case/params.h, and which of them */
    const char *key;
    int line; /* 0: by --set */
};

/* Set by tests, between reading a case and creating its simulation; neither changes a bit. */
struct test_switches {
    bool generic_kernel; /* the fluid's kernel that decides at run time, where a stamped one fits */
    bool work_on_idle;   /* visit dry walls, place and sort resting ones */
};

/* A scene: every section, every value in effect. Unnamed sections are single, named ones arrays. */
struct scene {
    char path[4096];    /* of the case file */
    struct arena arena; /* owns everything below */
#define SCENE_MEMBER_0(section) struct scene_##section section;
#define SCENE_MEMBER_1(section)      \
    struct scene_##section *section; \
    int n_##section;
#define SECTION(section, named) SCENE_MEMBER_##named(section)
#include "case/params.def"
    struct scene_contact contact_default; /* of bodies that no section is about */
    int n_constants;
    struct scene_constant *constant;
    int n_given;
    struct scene_given *given;
    struct test_switches test;
    struct scene_table *motion_data; /* [n_motion] */
    struct scene_table gravity_data;
    struct motion_hook *motion_hook; /* [n_motion]; NULL: none */
    struct scene_points points[3];   /* by enum kind of particles/particles.h: fluid, wall, solid */
    struct scene_lattice lattice, *solid_lattice; /* of fluid and walls; [n_solid] */
    double h, c0,
        rho0; /* smoothing length; speed of sound and density of the fluid (0: no fluid) */
    double domain_lower[2], domain_upper[2]; /* in effect */
    bool off_lattice; /* a shape does not fit the lattice: its size depends on dp */
};

/* Reads and checks a case file; geometry/load.h samples its points as well. `sets` are the --set arguments
 * ("key=value" or "section.key=value"; a named section is section NAME: "solid gate.young=1e6" or
 * "gate.young=1e6"). On success the caller frees with scene_free; on failure nothing remains to be freed. */
enum err scene_read(struct scene *s, const char *path, int n_sets, const char *const *sets,
                    struct diag *d) SPHFSI_CHECKED;
/* The same from text in memory; `path` names it in messages and anchors relative file names. */
enum err scene_parse(struct scene *s, const char *text, const char *path, int n_sets,
                     const char *const *sets, struct diag *d) SPHFSI_CHECKED;
void scene_free(struct scene *s);

/* Whether opposite sides of the domain along an axis are joined. */
SPHFSI_INLINE bool scene_periodic(const struct scene *s, int axis)
{
    return s->domain.periodic >> axis & 1;
}

/* An [inflow] or [outflow]: the buffer lies behind the line, its rows a spacing apart. */
struct scene_open {
    enum { OPEN_VELOCITY, OPEN_PRESSURE } kind;
    const struct scene_section_common *common;
    bool inflow;
    double from[2], along[2]; /* one end; unit vector to the other end */
    double inward[2];         /* unit vector into the fluid */
    double length, depth;     /* m */
    double level, absorb;     /* m, NAN: none; s */
    const struct expr *speed; /* along `inward` times `sense`; NULL: not given */
    const struct expr *velocity[2], *pressure;
    double sense; /* 1 for an [inflow], -1 for an [outflow] */
};
/* The section number k, those of [inflow] first. */
struct scene_open scene_open_at(const struct scene *s, int k);
int scene_open_count(const struct scene *s);
/* How far a point lies from the line on the side of the fluid, and how far along it, m. */
SPHFSI_INLINE void scene_open_place(const struct scene_open *o, const double x[2], double *in,
                                    double *along)
{
    const double d[2] = {x[0] - o->from[0], x[1] - o->from[1]};
    *in = d[0] * o->inward[0] + d[1] * o->inward[1];
    *along = d[0] * o->along[0] + d[1] * o->along[1];
}
/* The velocity that is given at a point of the line and a time, m/s. */
void scene_open_velocity(const struct scene_open *o, const double x[2], double time, double v[2]);

/* Value of an expression at a point; of one in t at x = t (case/expr.h has the grammar). */
double scene_expr_at(const struct expr *e, double x, double y);
/* Value of an expression in x, y and t. */
double scene_expr_at_time(const struct expr *e, double x, double y, double t);

/* Writes the effective case, every value and default spelled out in SI units; parsing it again gives
 * an equal scene. */
enum err scene_write(const struct scene *s, const char *path, struct diag *d) SPHFSI_CHECKED;

/* Prescribed motion: displacement from the initial place, velocity and acceleration at a time; and the
 * angle about a centre with its first two derivatives. */
struct motion_state {
    double d[2], v[2], a[2];
    double centre[2], angle, rate, angular_acceleration;
    double turn[2]; /* cosine and sine of the angle */
};
struct motion_hook { /* a motion that a program with the library prescribes instead */
    void (*at)(void *context, double time, double d[2], double v[2], double a[2]);
    void *context;
};
/* Gravity at a time, m/s^2: top.gravity, or what stands in its place where it is given as expressions in t,
 * and the table of top.gravity_file. top.gravity itself is that at t = 0 without the table. */
void scene_gravity_at(const struct scene *s, double t, double g[2]);
bool scene_gravity_varies(const struct scene *s);

struct motion_state motion_at(const struct scene *s, int motion_index, double time);

/* Where a motion puts a point that began at (X, Y): x, v and a. Whatever is driven, a wall for the fluid or
 * for contact, a clamp, is there. */
struct motion_point {
    double x[2], v[2], a[2];
};
struct motion_point motion_of_point(const struct motion_state *m, double X, double Y);

/* C_CFL of Eq. 28 where none is given: that of the paper, and that of leapfrog, whose step may be twice as
 * long (docs/performance.md). */
#define CFL_PAPER 0.2
#define CFL_LEAPFROG 0.4

/* Index of a named section, or -1. */
int scene_find_motion(const struct scene *s, const char *name);
int scene_find_solid(const struct scene *s, const char *name);
/* Spacing of a solid's particles, m: that of its lattice, once it is sampled. */
double scene_solid_dp(const struct scene *s, int solid);
/* Its smoothing length, m. */
double scene_solid_h(const struct scene *s, int solid);
/* Whether a solid is bonded to another: its thickness is not its own. */
bool scene_is_bonded(const struct scene *s, int solid);
int scene_find_wall(const struct scene *s, const char *name);

/* Whether the snapshots of a scene have a field of case/pointdata.def. */
bool scene_snapshot_has(const struct scene *s, const char *field);

/* What a probe looks at; TARGET_ANY_POINT is resolved. */
enum probe_target scene_probe_target(const struct scene_probe *probe);

/* The section that says how two bodies meet, walls behind solids, a body and itself the same; NULL: they do
 * not. */
const struct scene_contact *scene_contact_of(const struct scene *s, int a, int b);

/* The k-th name of a list with commas between them, without blanks around it; false: there are fewer. */
bool scene_listed(const char *list, int k, char name[SCENE_TEXT]);

/* The two names of `a, b`; false: it is something else. */
bool scene_pair(const char *text, char name[2][SCENE_TEXT]);

/* FILE:LINE, the path cut short if it is very long; line 0: --set. */
enum { LOCATION_TEXT = 300 };
void scene_location(const struct scene *s, int line, char place[LOCATION_TEXT]);
/* A file name as the case file gives it, seen from the working directory; false: too long. */
bool scene_file(const struct scene *s, const char *name, char *path, size_t size);

#endif
