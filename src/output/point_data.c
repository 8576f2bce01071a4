/* SPDX-License-Identifier: MIT
 * The value of each field of a snapshot for one particle. */
#include "output/point_data.h"

static double vector_value(double x, double y, int column)
{
    return column == 0 ? x : column == 1 ? y : 0;
}

/* A value of a beam at the place on its line that dummy i lies behind. */
static double beam_value(enum data what, const struct simulation *sim, const struct thin_line *line,
                         int64_t i)
{
    const int beam = line->given->wall - scene_beam_wall(sim->scene, 0);
    const struct line_dummy *const dummy = &line->given->dummy[i - line->first];
    double section[4]; /* in the order of the data from the axial force on */
    if (beam < 0) return 0;
    if (what == D_THICKNESS) return sim->scene->beam[beam].thickness;
    const struct beam_place place = {sim->beams.beam[beam].first_element + dummy->part,
                                     dummy->along, 0};
    beam_section_force(&sim->beams, &place, section);
    return section[what - D_AXIAL_FORCE];
}

double snapshot_value(enum data what, const struct simulation *sim, enum kind kind, int64_t i,
                      int column)
{
    const struct particles *particles = &sim->particles[kind];
    static const int order[] = {0, 1, 3, 2}; /* of a stress in the file: xx yy zz xy yz xz */
    double sigma[4] = {0}, det = 1;
    const bool solid = kind == KIND_SOLID;
    const struct thin_line *const lines = sim->fluid.lines.line;
    const bool of_beam = what >= D_THICKNESS && what <= D_CURVATURE;
    const int32_t line = what == D_POINTS || of_beam ? fluid_line_of(&sim->fluid, kind, i) : 0;
    if (solid && (what == D_STRESS || what == D_VON_MISES || what == D_DET_F || what == D_DENSITY))
        solid_cauchy(&sim->solid, particles, i, sigma, &det);
    if (of_beam) return line > 0 ? beam_value(what, sim, &lines[line - 1], i) : 0;
    switch (what) {
    case D_POINTS:
        if (line > 0) {
            double foot[2];
            line_foot(&lines[line - 1], i - lines[line - 1].first, foot);
            return vector_value(foot[0], foot[1], column);
        }
        return vector_value(particles->x[i], particles->y[i], column);
    case D_VELOCITY: return vector_value(particles->vx[i], particles->vy[i], column);
    case D_PRESSURE:
        if (kind == KIND_FLUID)
            return eos_pressure(particles->dens[i], sim->fluid.k.rho0, sim->fluid.k.c0);
        return particles->p ? particles->p[i] : 0;
    case D_VON_MISES: return solid_von_mises(sigma);
    case D_DET_F: return det;
    case D_DENSITY:
        if (solid) return sim->solid.body[particles->body[i]].density / det;
        return particles->dens ? sim->scene->rho0 * (1 + particles->dens[i]) : 0;
    case D_STRESS: return column < (int)COUNT_OF(order) ? sigma[order[column]] : 0;
    case D_DISPLACEMENT:
        if (solid) return vector_value(particles->ux[i], particles->uy[i], column);
        return particles->X ? vector_value(particles->x[i] - particles->X[i],
                                           particles->y[i] - particles->Y[i], column)
                            : 0;
    default: return 0;
    }
}
