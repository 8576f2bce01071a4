/* SPDX-License-Identifier: MIT
 * The law of a point and an edge in contact (T-61, T-62). */
#ifndef SPHFSI_SOLID_CONTACT_LAW_H
#define SPHFSI_SOLID_CONTACT_LAW_H

#include <math.h>

#include "base/elementary.h"
#include "solid/contact_search.h"
#include "solid/contact_surface.h"

/* Each surface of a pair of bodies carries half of the force: the points of each act on the edges
 * of the other. */
#define CONTACT_HALF 0.5

/* Constants of a point and an edge. */
struct contact_constants {
    double min_reach; /* R of T-61c, the overlap at which the energy is infinite, m */
    double stiffness; /* force per overlap at first contact, N/m per depth */
    double damping;   /* N s/m */
    double friction;
    double tangential_damping; /* of the spring of friction, N s/m */
};

SPHFSI_INLINE double contact_mass(const struct contact *contact, int body)
{
    return body < contact->n_solids ? contact->solid->body[body].mass : (double)INFINITY;
}

/* A point represents its own part of the outline. Damping as a fraction of 2 sqrt(k m), with the
 * mass m of the pair, m_a m_b/(m_a + m_b). */
SPHFSI_INLINE struct contact_constants contact_constants_of(const struct contact *contact,
                                                            const struct contact_law *law,
                                                            int32_t point, int32_t edge,
                                                            double min_reach)
{
    const int a = contact->body[point], b = contact->body[contact->edge[edge].a];
    const double k = law->stiffness * contact->width[point] / law->spacing;
    const double mass = 1 / (1 / contact_mass(contact, a) + 1 / contact_mass(contact, b)),
                 critical = 2 * sqrt(k * mass);
    return (struct contact_constants){
        .min_reach = min_reach,
        .stiffness = CONTACT_HALF * k,
        .damping = CONTACT_HALF * law->damping * critical,
        .friction = law->friction,
        .tangential_damping = law->friction > 0 ? CONTACT_HALF * 0.5 * critical : 0,
    };
}

/* T-61: k R^2 (r/R - 1 - ln(r/R)), infinite where the overlap is R, the least reach; r =
 * contact_clearance. */
SPHFSI_INLINE double elastic_energy(const struct contact_constants *q, double r)
{
    if (!(r < q->min_reach)) return 0;
    const double s = r / q->min_reach;
    return q->stiffness * square(q->min_reach) * (s - 1 - elementary_log(s));
}

/* The derivative of the potential, k R (R/r - 1), and its second derivative, k (R/r)^2. */
SPHFSI_INLINE double elastic_force(const struct contact_constants *q, double r)
{
    return q->stiffness * q->min_reach * (q->min_reach / r - 1);
}
SPHFSI_INLINE double elastic_stiffness(const struct contact_constants *q, double r)
{
    return q->stiffness * square(q->min_reach / min2(r, q->min_reach));
}

/* Component k of a vector's part across the direction n. */
SPHFSI_INLINE double across(const double n[2], const double v[2], int k)
{
    return v[k] - (v[0] * n[0] + v[1] * n[1]) * n[k];
}

/* Velocity of a point relative to the nearest place on an edge. */
SPHFSI_INLINE void relative_velocity(const struct contact *contact, int32_t point, int32_t edge,
                                     double s, double v[2])
{
    const int32_t a = contact->edge[edge].a, b = contact->edge[edge].b;
    v[0] = contact->vx[point] - ((1 - s) * contact->vx[a] + s * contact->vx[b]);
    v[1] = contact->vy[point] - ((1 - s) * contact->vy[a] + s * contact->vy[b]);
}

/* To a solid's particle, or to the power of moving walls. */
SPHFSI_INLINE void contact_add_force(struct contact *contact, struct particles *particles,
                                     int32_t point, const double f[2])
{
    if (point >= contact->n_solid_points) {
        contact->power -= f[0] * contact->vx[point] + f[1] * contact->vy[point];
        return;
    }
    const int32_t i = contact->index[point];
    const double per_mass = particles->free[i] / contact->solid->body[contact->body[point]].mass;
    particles->sx[i] += f[0] * per_mass;
    particles->sy[i] += f[1] * per_mass;
}

/* A part of the rows of T-62a, of a point of a solid. */
SPHFSI_INLINE void contact_add_row(struct contact *contact, const struct particles *particles,
                                   int32_t point, double weight, double stiffness, double damping)
{
    if (point >= contact->n_solid_points) return;
    const double per_mass =
        particles->free[contact->index[point]] / contact->solid->body[contact->body[point]].mass;
    contact->row[point] += weight * stiffness * per_mass;
    contact->row_damping[point] += weight * damping * per_mass;
}

#endif
