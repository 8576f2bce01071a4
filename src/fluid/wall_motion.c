/* SPDX-License-Identifier: MIT
 * Moves the particles of walls, and finds the power that this takes. */
#include "fluid/wall_motion.h"
#include "geometry/motion.h"

enum err wall_motion_create(struct wall_motion *m, struct arena *a, const struct scene *scene,
                            const struct particles *walls, struct diag *d)
{
    m->never_skip = scene->test.never_skip;
    TRY(arena_array(a, &m->wall, scene->n_wall, "moving walls", d));
    for (int k = 0; k < scene->n_wall; k++) {
        const int motion = scene_wall_motion(scene, k);
        if (motion < 0 && k < scene_beam_wall(scene, 0)) continue;
        int64_t first = 0;
        while (first < walls->n && walls->body[first] != k) first++;
        int64_t end = first;
        while (end < walls->n && walls->body[end] == k) end++;
        m->wall[m->n++] = (struct moving_wall){.section = k,
                                               .motion = motion,
                                               .first = first,
                                               .end = end,
                                               .driven = k < scene_rigid_wall(scene, 0)};
    }
    return ERR_OK;
}

/* Returns the largest displacement of a particle, m. */
static double place_body(const struct moving_wall *b, struct particles *particles)
{
    double moved2 = 0;
#pragma omp parallel for schedule(static) reduction(max : moved2)
    for (int64_t i = b->first; i < b->end; i++) {
        const struct motion_point at =
            motion_of_point(&b->placed, particles->X[i], particles->Y[i]);
        moved2 =
            max2(moved2, square(at.x[0] - particles->x[i]) + square(at.x[1] - particles->y[i]));
        particles->x[i] = at.x[0];
        particles->y[i] = at.x[1];
        particles->vx[i] = at.v[0];
        particles->vy[i] = at.v[1];
        particles->ax[i] = at.a[0];
        particles->ay[i] = at.a[1];
    }
    return sqrt(moved2);
}

void wall_motion_apply(struct wall_motion *m, const struct scene *scene, struct particles *walls,
                       double time)
{
    double most = 0;
    for (int k = 0; k < m->n; k++) {
        struct moving_wall *const b = &m->wall[k];
        m->moved |= b->motion < 0;
        if (b->motion < 0) continue;
        const struct motion_state now = motion_at(scene, b->motion, time);
        /* NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): bits are meant, of doubles only */
        if (b->known && memcmp(&now, &b->placed, sizeof now) == 0 && !m->never_skip) continue;
        b->placed = now;
        b->known = true;
        b->rests = now.v[0] == 0 && now.v[1] == 0 && now.rate == 0;
        m->moved = true;
        most = max2(most, place_body(b, walls));
    }
    m->moved_most += most;
}

void wall_motion_sort(struct wall_motion *m, struct cells *cells, struct particles *walls)
{
    if (m->never_skip || m->moved) cells_sort(cells, KIND_WALL, walls);
    m->moved = false;
}

double wall_motion_speed2(const struct wall_motion *m, const struct particles *walls)
{
    double largest = 0;
    for (int k = 0; k < m->n; k++) {
        const struct moving_wall *const b = &m->wall[k];
        if (b->rests) continue;
#pragma omp parallel for schedule(static) reduction(max : largest)
        for (int64_t i = b->first; i < b->end; i++)
            largest = max2(largest, walls->vx[i] * walls->vx[i] + walls->vy[i] * walls->vy[i]);
    }
    return largest;
}

double moving_wall_power(const struct moving_wall *b, const struct particles *walls)
{
    if (b->rests) return 0;
    double power = 0;
    for (int64_t i = b->first; i < b->end; i++)
        power -= walls->fx[i] * walls->vx[i] + walls->fy[i] * walls->vy[i];
    return power;
}

double wall_motion_power(const struct wall_motion *m, const struct particles *walls)
{
    double power = 0;
    for (int k = 0; k < m->n; k++)
        if (m->wall[k].driven) power += moving_wall_power(&m->wall[k], walls);
    return power;
}
