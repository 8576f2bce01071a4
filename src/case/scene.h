/* SPDX-License-Identifier: MIT
 * The content of a case file as a struct (from case/params.def) and the points sampled from its
 * shapes. All memory belongs to the scene's arena. Units: SI. */
#pragma once

#include "expr/expr.h"

/* Limits of weak compressibility above which runs warn: speed over c0, and |rho/rho0 - 1|. */
#define SPEED_WARNING 0.3
#define DENS_WARNING 0.1

enum { SCENE_TEXT = 256, SCENE_NAME = 64, SCENE_MAX_SECTIONS = 64 };

enum shape_kind { SHAPE_BOX, SHAPE_POLYGON, SHAPE_POLYLINE, SHAPE_CIRCLE };

struct shape {
    enum shape_kind kind;
    int n; /* points: box 2 (lower left, upper right), circle 1, else >= 2 */
    double (*pt)[2];
    double size; /* radius of a circle; thickness of a polyline, to the left of its direction if
                         positive, to the right if negative; else 0 */
    bool bare;   /* the side of a wall, drawn as a line without thickness (geometry/wall_lines.c) */
    bool thin;   /* a wall thinner than dp with fluid on both sides; `size` is its thickness */
    int line;
};

struct shape_list {
    int n;
    struct shape *item;
};

/* A point of a body that stays in place or on another section, as the case gives it. */
struct hinge_point {
    double at[2];
    char other[SCENE_NAME]; /* name of the section; empty: in place */
    int line;
};

struct hinge_list {
    int n;
    struct hinge_point *item;
};

/* Up to two expressions in x and y, or in x, y and t, or one in t. NULL: not given. */
struct scene_expr {
    struct expr *e[2];
};

/* The name after the section's word, and the line of its header; enum section_id of case/params.h
 * and its number among those of its kind. */
struct scene_section_common {
    char name[SCENE_NAME];
    int line, section, index;
};

/* One struct for each section of case/params.def, with a member for each of its keys. */
#define MEMBER_REAL(key) double key;
#define MEMBER_INTEGER(key) int key;
#define MEMBER_CHOICE(key) int key;
#define MEMBER_TEXT(key) char key[SCENE_TEXT];
#define MEMBER_VECTOR(key) double key[2];
#define MEMBER_TIME_VECTOR(key) \
    double key[2];              \
    struct scene_expr key##_in_time;
#define MEMBER_EXPR(key) struct scene_expr key;
#define MEMBER_SHAPES(key) struct shape_list key;
#define MEMBER_HINGES(key) struct hinge_list key;
#define PARAM(section, key, type, ...) MEMBER_##type(key)
/* clang-format off */
#define SECTION(section, ...) struct scene_##section { struct scene_section_common common;
#define END };
/* clang-format on */
#include "case/params.def"

/* Values of the CHOICE keys, in the order of their names in case/params.def. */
enum integrator_choice { INTEGRATOR_SYMPLECTIC, INTEGRATOR_VERLET, INTEGRATOR_LEAPFROG };
enum precision { PRECISION_MIXED, PRECISION_DOUBLE };
/* As presets need it. SCENE_STREAM: fluid enters through an [inflow], without gravity. */
enum scene_kind { SCENE_SOLID, SCENE_FLUID, SCENE_STREAM, SCENE_COUPLED, SCENE_KINDS };
enum scheme { SCHEME_PAPER, SCHEME_STANDARD };
enum accuracy { ACCURACY_DRAFT, ACCURACY_STANDARD, ACCURACY_FINE };
enum solid_precision { SOLID_PRECISION_SINGLE, SOLID_PRECISION_DOUBLE, SOLID_PRECISION_AUTO };
enum solid_steps { SOLID_STEPS_EXPLICIT, SOLID_STEPS_IMPLICIT, SOLID_STEPS_AUTO };
enum multirate { MULTIRATE_OFF, MULTIRATE_ON, MULTIRATE_AUTO };
enum suction { SUCTION_OFF, SUCTION_ON };
enum sides { SIDES_BOTH, SIDES_ONE };
enum periodic { PERIODIC_NONE, PERIODIC_X, PERIODIC_Y, PERIODIC_XY }; /* bit 0: x, bit 1: y */
enum slip { SLIP_FREE, SLIP_NONE };
enum snapshot_failure { SNAPSHOT_FAILURE_STOP, SNAPSHOT_FAILURE_GO_ON };
enum snapshot_precision { SNAPSHOT_PRECISION_SINGLE, SNAPSHOT_PRECISION_DOUBLE };
enum shifting_speed { SHIFTING_OWN, SHIFTING_LARGEST };
enum diffusion_form { DIFFUSION_MOLTENI, DIFFUSION_FOURTAKAS, DIFFUSION_ANTUONO };
enum diffusion_limiter { LIMITER_NONE, LIMITER_STRAIN };
enum particle_mass { MASS_EQUAL, MASS_HYDROSTATIC };
enum law { LAW_PAPER, LAW_SVK, LAW_NEO_HOOKEAN };
enum plane { PLANE_STRAIN, PLANE_STRESS };
enum gradient_order { GRADIENT_LINEAR, GRADIENT_QUADRATIC };
enum hourglass_form { HOURGLASS_PRINTED, HOURGLASS_VARIATIONAL };
enum viscosity_form { VISCOSITY_PRINTED, VISCOSITY_SYMMETRIC };
enum probe_quantity {
#define QUANTITY(NAME, ...) PROBE_##NAME,
#include "case/quantities.def"
    PROBE_QUANTITIES
};
/* What a quantity is measured of. */
enum probe_target {
    TARGET_SOLID_POINT, /* a material point of a solid or beam */
    TARGET_FLUID_POINT,
    TARGET_ANY_POINT, /* one of these, depending on `body` */
    TARGET_SOLID,
    TARGET_BODY,  /* solids and walls */
    TARGET_FLUID, /* all of it */
    TARGET_FLUID_LINE
};
/* The rows of case/quantities.def. */
extern const struct quantity_info {
    const char *name, *columns, *meaning;
    enum probe_target target;
} quantity_table[PROBE_QUANTITIES];

enum probe_direction { DIRECTION_RIGHT, DIRECTION_LEFT, DIRECTION_UP, DIRECTION_DOWN };

/* Points sampled from the shapes of one kind. Solids: body after body, each in rows along its
 * longer side, so that lattice neighbours are mostly adjacent in memory. */
struct scene_points {
    int64_t n;
    double *x, *y;
    int32_t *body;    /* index of the section among those of its kind */
    uint8_t *clamped; /* solids: 1 if a clamp holds the particle; otherwise NULL */
    double *volume;   /* walls: of a particle, over dp^2, if there are thin lines; otherwise NULL */
    int32_t *open; /* fluid: the open boundary, from 1, whose buffer it belongs to, or 0; or NULL */
};

/* The lattice that a region is sampled on. Cell (i, j) has its centre at origin + ((i, j) + 1/2)
 * spacing in axes rotated by `angle`. */
struct scene_lattice {
    double angle;      /* rad */
    double turn[2];    /* its cosine and sine */
    double origin[2];  /* m, in the rotated axes */
    double spacing[2]; /* m */
    double dp;         /* m: the root of a cell's area, which is the volume of a particle */
    bool fitted;       /* to edges that are not a whole number of dp apart */
    double area;       /* of the shapes of a solid where no clamp holds it, m^2 */
    double area_error; /* of the particles there, relative to it */
    bool area_free;    /* clamps hold a part */
};

/* A dummy of a thin line: beside its part of that number, at a fraction `along` of it, `off` to the
 * left of the line and `beyond` the place in its direction, m. */
struct line_dummy {
    int32_t part;
    bool same_side; /* of the line as the fluid that sees it (T-110f) */
    double along, off, beyond;
    double width;  /* of its row, over dp */
    double inside; /* part of it that lies within the thickness */
};

/* A thin line (T-110): n points, with n - 1 parts between them. */
struct scene_thin_line {
    int wall, n;
    double (*pt)[2];
    double extend[2];         /* how far it continues into a wall beyond its ends, m */
    int into[2];              /* this wall */
    double (*seen)[2];        /* its points, the first and the last one moved by that */
    double longest;           /* its longest part, m */
    double half;              /* half its thickness, m: the faces are so far from it */
    bool tip[2];              /* whether fluid can flow round its ends, once they have left it */
    int64_t first, n_dummies; /* among the particles of walls */
    struct line_dummy *dummy; /* [n_dummies] */
};

/* Mass of a rigid body, kg/m, its moment of inertia, kg m, and its centre of mass, m. */
struct rigid_mass {
    double mass, inertia, centre[2];
};

/* A named constant, evaluated. */
struct scene_constant {
    char name[SCENE_NAME];
    double value;
    struct dim dim;
};

/* A key given by the case, not a default. */
struct scene_given {
    int section, index; /* enum section_id of case/params.h, and the section's index */
    const char *key;
    int line; /* 0: by --set */
};

/* Set by tests after reading a case and before creating its simulation; neither changes a bit. */
struct test_switches {
    bool generic_variant; /* the generic sweep of the fluid also if there is a specialised one */
    bool never_skip;      /* visit dry walls, place and sort walls at rest */
};

/* A scene: all sections and values in effect. Unnamed sections are structs, named ones arrays. */
struct scene {
    char path[4096];    /* of the case file */
    struct arena arena; /* owns everything below */
#define SCENE_MEMBER_0(section) struct scene_##section section;
#define SCENE_MEMBER_1(section)      \
    struct scene_##section *section; \
    int n_##section;
#define SECTION(section, named, text) SCENE_MEMBER_##named(section)
#define END
#include "case/params.def"
    enum scene_kind kind;
    struct scene_contact contact_default; /* for bodies without a section of their own */
    int n_constants;
    struct scene_constant *constant;
    int n_given;
    struct scene_given *given;
    struct test_switches test;
    struct expr_table *function;     /* [n_table] */
    struct motion_hook *motion_hook; /* [n_motion]; NULL: none */
    /* [n_rigid]; a [rigid] is the wall and the motion of its number from the end of these. */
    struct rigid_motion *rigid_motion;
    struct rigid_mass *rigid_mass; /* [n_rigid], by sampling */
    int n_thin;
    struct scene_thin_line *thin;  /* by sampling, in the order of the walls */
    struct scene_points points[3]; /* by enum kind of particles/particles.h: fluid, wall, solid */
    struct scene_lattice lattice, *solid_lattice; /* of fluid and walls; [n_solid] */
    double h;                                     /* smoothing length */
    double c0, rho0;    /* speed of sound and density of the fluid; 0: no fluid */
    double c_u;         /* of L-7: at most c0; ten times the largest speed of Eq. 3, if known */
    double given_speed; /* largest that walls, open boundaries and the start give it, m/s */
    double domain_lower[2], domain_upper[2]; /* in effect */
    bool full;        /* there are open boundaries and, at the start, no free surface */
    bool settled;     /* fluid near edges off its lattice (T-80) */
    bool off_lattice; /* a shape does not fit the lattice: its sampled size depends on dp */
};

/* Reads and checks a case, from text in memory or NULL: the file; messages use `path`, and file
 * names are relative to it. geometry/scene_points.h also samples its points. `sets` are the --set
 * arguments ("key=value" or "section.key=value"; a named section is section NAME:
 * "solid gate.young=1e6" or "gate.young=1e6"). After success scene_free is due. */
enum err scene_read(struct scene *scene, const char *text, const char *path, int n_sets,
                    const char *const *sets, struct diag *d) SPHFSI_CHECKED;
void scene_free(struct scene *scene);

/* Whether opposite sides of the domain along an axis are joined. */
SPHFSI_INLINE bool scene_periodic(const struct scene *scene, int axis)
{
    return scene->domain.periodic >> axis & 1;
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
    struct expr *speed;       /* along `inward` times `sense`; NULL: not given */
    struct expr *velocity[2], *pressure;
    double sense; /* 1 for an [inflow], -1 for an [outflow] */
};
/* The section number k, those of [inflow] first. */
struct scene_open scene_open_at(const struct scene *scene, int k);
int scene_open_count(const struct scene *scene);
/* Distance of a point from the line, on the fluid's side, and its coordinate along it, m. */
SPHFSI_INLINE void scene_open_place(const struct scene_open *o, const double x[2], double *in,
                                    double *along)
{
    const double d[2] = {x[0] - o->from[0], x[1] - o->from[1]};
    *in = d[0] * o->inward[0] + d[1] * o->inward[1];
    *along = d[0] * o->along[0] + d[1] * o->along[1];
}
/* The given velocity at a point of the line and a time, m/s. */
void scene_open_velocity(const struct scene_open *o, const double x[2], double time, double v[2]);

/* Extremes over its line and the run of the velocity or pressure that a boundary gives. */
struct scene_open_range {
    double forth, back; /* m/s: largest part of a velocity along `sense` and against it */
    double largest;     /* amount, m/s or Pa */
    bool infinite;
    double x[2], time; /* where and when */
};
struct scene_open_range scene_open_range(const struct scene *scene, const struct scene_open *o);

/* The flow that a given velocity brings into the fluid at a time, per depth, m^2/s. */
double scene_open_flow(const struct scene_open *o, double time);

/* Writes the effective case, all values in SI units; reading it again gives an equal scene. */
enum err scene_write(const struct scene *scene, const char *path, struct diag *d) SPHFSI_CHECKED;

/* Energy and momentum of a rigid body or beam; `undelivered`: work that is due to the fluid. */
struct body_energy {
    double kinetic, potential, elastic, momentum[2], mass, undelivered;
};

/* The elastic force of a spring at an elongation, N/m, and its slope, N/m^2, per depth; the part
 * `taut` of its mean between two elongations. */
double spring_force(const struct scene_spring *spring, double e);
double spring_slope(const struct scene_spring *spring, double e);
double spring_mean(const struct scene_spring *spring, double from, double to, double taut);
/* Whether force and slope are finite numbers. */
bool spring_is_finite(const struct scene_spring *spring, double e);
/* Adds its elastic energy. That of a force law is a potential, of arbitrary zero and sign. */
void spring_add_energy(const struct scene_spring *spring, double e, struct body_energy *sum);

/* The motion of a wall; -1: none, also of wall -1. */
int scene_wall_motion(const struct scene *scene, int wall);

/* Prescribed motion: displacement from the initial position, velocity and acceleration at a time;
 * and the angle about a centre with its first two derivatives. */
struct motion_state {
    double d[2], v[2], a[2];
    double centre[2], angle, rate, angular_acceleration;
    double turn[2]; /* cosine and sine of the angle */
};
struct motion_hook { /* a function of a program with the library, used instead */
    void (*move)(void *context, double time, double d[2], double v[2], double a[2]);
    void *context;
};
/* The present motion of a rigid body: of the simulation of the scene that was moved last. */
struct rigid_motion {
    double time;
    struct motion_state now; /* its velocity and accelerations continue it */
};
/* The wall of a rigid body, and of a beam: the last ones, in this order. */
SPHFSI_INLINE int scene_rigid_wall(const struct scene *scene, int rigid)
{
    return scene->n_wall - scene->n_beam - scene->n_rigid + rigid;
}
SPHFSI_INLINE int scene_beam_wall(const struct scene *scene, int beam)
{
    return scene->n_wall - scene->n_beam + beam;
}
/* The motion of a rigid body. */
SPHFSI_INLINE int scene_rigid_motion(const struct scene *scene, int rigid)
{
    return scene->n_motion - scene->n_rigid + rigid;
}
/* The thin line that a particle of a wall is a dummy of, from 1; 0: none. */
SPHFSI_INLINE int scene_thin_line_of(const struct scene *scene, int64_t wall_particle)
{
    for (int k = 0; k < scene->n_thin; k++)
        if (wall_particle >= scene->thin[k].first &&
            wall_particle < scene->thin[k].first + scene->thin[k].n_dummies)
            return k + 1;
    return 0;
}
/* Elements of a beam from a to b. */
int scene_beam_parts(const struct scene *scene, const struct scene_beam *beam, const double a[2],
                     const double b[2]);
/* Spacing of a solid's particles, m: that of its lattice after sampling. */
double scene_solid_dp(const struct scene *scene, int solid);
/* Smoothing length of a solid, m. */
double scene_solid_h(const struct scene *scene, int solid);
/* Gives solids that are bonded, directly or through others, the number of the first of them. */
void scene_bonds(const struct scene *scene, int bond[SCENE_MAX_SECTIONS]);
/* Whether a solid is bonded to another: then the whole is thicker than it. */
bool scene_is_bonded(const struct scene *scene, int solid);

/* Whether the snapshots of a scene have a field of case/pointdata.def. */
bool scene_snapshot_has(const struct scene *scene, const char *field);

/* Target of a probe; TARGET_ANY_POINT is resolved. */
enum probe_target scene_probe_target(const struct scene_probe *probe);

/* The contact section of two bodies or of one with itself, walls after solids; NULL: no contact. */
const struct scene_contact *scene_contact_of(const struct scene *scene, int a, int b);

/* Half the thickness of a beam, m; 0: one of which only stiffness and mass are given. */
SPHFSI_INLINE double scene_half_thickness(const struct scene_beam *beam)
{
    return isnan(beam->thickness) ? 0 : 0.5 * beam->thickness;
}

/* The gap that it keeps, m: by default one layer of fluid with fluid and the standard scheme. */
double scene_contact_gap(const struct scene *scene, const struct scene_contact *c);

/* Name k of a list with commas, or word k of one with blanks or commas; false: there are fewer. */
bool scene_listed(const char *list, int k, char name[SCENE_TEXT]);
bool scene_word(const char *list, int k, char word[SCENE_TEXT]);
/* The two names of `a, b`; false: the text has another form. */
bool scene_pair(const char *text, char name[2][SCENE_TEXT]);

/* FILE:LINE, with a very long path shortened; 0: --set; LINE_NONE: FILE. See key_line, too. */
enum { LINE_NONE = -1 };
struct scene_place {
    char text[300];
};
struct scene_place scene_place(const struct scene *scene, int line);
/* A warning, and an ERR_INPUT by diag_add, that begin with the place of a line. */
#define warn_at(d, scene, line, format, ...) \
    diag_warn(d, "%s: " format, scene_place(scene, line).text, ##__VA_ARGS__)
#define fail_at(d, scene, line, format, ...) \
    diag_add(d, ERR_INPUT, "%s: " format, scene_place(scene, line).text, ##__VA_ARGS__)
/* A file name of the case file, relative to the working directory; false: too long. */
bool scene_file(const struct scene *scene, const char *name, char *path, size_t size);
