/* SPDX-License-Identifier: MIT
 * The buffers of open boundaries: their memory, the particles that they exchange with the fluid,
 * and the sums of what has come in. */
#include "fluid/open.h"
#include "base/hash.h"

/* Distance in spacings: fluid this far behind the line joins the buffer, a buffer particle this far
 * in front of it is relabelled without delay. Smaller oscillations create no copies. */
#define BAND 0.5

int64_t open_capacity(const struct scene *scene)
{
    double places = 1;
    int64_t n = scene->points[KIND_FLUID].n;
    for (int c = 0; c < 2; c++)
        places *= (scene->domain_upper[c] - scene->domain_lower[c]) / scene->top.dp;
    const double taken = (double)(n + scene->points[KIND_WALL].n);
    return n + n / 8 + (int64_t)min2(1e9, max2(0, places - taken));
}

enum err open_create(struct open_boundaries *o, struct arena *a, const struct scene *scene,
                     int64_t next_id, struct diag *d)
{
    static const char what[] = "open boundaries";
    const size_t n = (size_t)scene_open_count(scene);
    int64_t members = 0;
    for (int64_t i = 0; i < scene->points[KIND_FLUID].n; i++)
        members += scene->points[KIND_FLUID].open[i] > 0;
    o->n = (int)n;
    o->next_id = next_id;
    o->capacity = 4 * members + 64;
    const size_t capacity = (size_t)o->capacity;
    TRY(arena_array(a, &o->boundary, n, what, d));
    TRY(arena_array(a, &o->at, n, what, d));
    TRY(arena_array(a, &o->sum, n, what, d));
    TRY(arena_array(a, &o->count, n, what, d));
    TRY(arena_array(a, &o->rate, n, what, d));
    TRY(arena_array(a, &o->member, capacity, what, d));
    TRY(arena_array(a, &o->flow, capacity, what, d));
    for (int k = 0; k < o->n; k++) {
        o->boundary[k] = scene_open_at(scene, k);
        TRY(open_copy(o, k, a, d));
        o->sum[k][OPEN_MEAN_FLOW] = (double)NAN;
    }
    return ERR_OK;
}

/* Where a particle is relative to a line: in front of it on the side of the fluid, along it, and
 * the strip of the buffer, a spacing wide or nearly so, that it lies in. Every place on the line
 * belongs to one strip, so fluid that returns adds none. */
struct place {
    double in, along, strip;
};

/* Width of a strip, m. */
static double width_of(const struct open_boundaries *o, const struct scene_open *b)
{
    return b->length / max2(1, round(b->length / o->k->dp));
}

static struct place place_of(const struct open_boundaries *o, const struct scene_open *b, int64_t i)
{
    struct place at;
    scene_open_place(b, (const double[]){o->particles->x[i], o->particles->y[i]}, &at.in,
                     &at.along);
    at.strip = floor(at.along / width_of(o, b));
    return at;
}

/* Whether a place is in the buffer or in front of it. Its sides are walls, which do not count. */
static bool in_buffer(const struct open_boundaries *o, const struct scene_open *b,
                      const struct place *at)
{
    return at->in >= -b->depth - o->k->dp && at->along > 0 && at->along < b->length;
}

/* --- exchange --- */

bool open_due(const struct open_boundaries *o)
{
    bool due = false;
    for (int64_t m = 0; m < o->n_members; m++) {
        const int32_t i = o->member[m].particle;
        due |= place_of(o, open_boundary(o, i), i).in > BAND * o->k->dp;
    }
    return due;
}

/* Adds momentum and energy of a particle to the sums of its boundary, or takes them off. */
static void count_particle(struct open_boundaries *o, int64_t i, double sign)
{
    const struct particles *const particles = o->particles;
    double *const sum = o->sum[particles->open[i] - 1];
    sum[OPEN_MOMENTUM_X] += sign * particle_mass(o->k, particles, i) * particles->vx[i];
    sum[OPEN_MOMENTUM_Y] += sign * particle_mass(o->k, particles, i) * particles->vy[i];
    sum[OPEN_ENERGY] += sign * particle_energy(o->k, o->k->gravity, particles, i);
}

/* A copy of a particle that enters, in the middle of its strip, at `in` before the line. */
static enum err make_copy(struct open_boundaries *o, int64_t i, double in, struct diag *d)
{
    struct particles *const particles = o->particles;
    const struct scene_open *const b = open_boundary(o, i);
    if (particles->n == particles->capacity)
        return diag_fail(
            d, ERR_GUARD,
            "%s has brought in so much fluid that the limit of %lld particles is reached, "
            "because more fluid enters than leaves; a larger [domain] or an [outflow] may help",
            section_title(b->common).text, (long long)particles->capacity);
    const int64_t to = particles->n++;
    const struct place at = place_of(o, b, i);
    const double middle = (at.strip + 0.5) * width_of(o, b) - at.along,
                 aside = fabs(middle) > 1e-6 * o->k->dp ? middle : 0; /* not for rounding */
    particles_copy(particles, i, to);
    particles->id[to] = o->next_id++;
    particles->x[to] += (in - at.in) * b->inward[0] + aside * b->along[0];
    particles->y[to] += (in - at.in) * b->inward[1] + aside * b->along[1];
    o->count[particles->open[i] - 1][OPEN_ENTERED]++;
    count_particle(o, to, 1);
    return ERR_OK;
}

/* T-54: fills the strip behind a particle that enters, but not above the level. Compressed fluid
 * has smaller distances: density times velocity flows in. Particles from `fresh` on are new. */
static enum err fill_strip(struct open_boundaries *o, int64_t i, int64_t fresh, struct diag *d)
{
    const struct particles *const particles = o->particles;
    const struct scene_open *const b = open_boundary(o, i);
    const struct place own = place_of(o, b, i);
    const double spacing = o->k->dp / (1 + particles->dens[i]);
    if (particles->y[i] > b->level) return ERR_OK; /* NAN: none */
    double last = own.in;
    for (int64_t m = 0; m < o->n_members + particles->n - fresh; m++) {
        const int64_t j = m < o->n_members ? o->member[m].particle : fresh + m - o->n_members;
        const struct place at = place_of(o, b, j);
        if (particles->open[j] == particles->open[i] && at.strip == own.strip)
            last = min2(last, at.in);
    }
    for (double in = last - spacing; in >= -b->depth; in -= spacing) TRY(make_copy(o, i, in, d));
    return ERR_OK;
}

/* Whether the buffer has no space for fluid that has come in: above its level, or close to a
 * buffer particle that moves inward. Two particles in one place would burst apart. */
static bool strip_is_full(const struct open_boundaries *o, int64_t i)
{
    const struct particles *const particles = o->particles;
    const struct scene_open *const b = open_boundary(o, i);
    const struct place own = place_of(o, b, i);
    bool full = particles->y[i] > b->level; /* it runs off over the inflow; NAN: none */
    for (int64_t m = 0; m < o->n_members && !full; m++) {
        const int64_t j = o->member[m].particle;
        const struct place at = place_of(o, b, j);
        full = particles->open[j] == particles->open[i] && at.strip == own.strip &&
               fabs(at.in - own.in) < BAND * o->k->dp &&
               particles->vx[j] * b->inward[0] + particles->vy[j] * b->inward[1] > 0;
    }
    return full && b->kind == OPEN_VELOCITY;
}

/* The boundary whose buffer contains fluid particle i, from 1; 0: none. */
static int32_t buffer_at(const struct open_boundaries *o, int64_t i)
{
    for (int k = 0; k < o->n; k++) {
        const struct place at = place_of(o, &o->boundary[k], i);
        if (at.in < -BAND * o->k->dp && in_buffer(o, &o->boundary[k], &at)) return k + 1;
    }
    return 0;
}

/* Removes the particles that have left their buffers, and those that found no space in one. */
static void end_particles(struct open_boundaries *o)
{
    struct particles *const particles = o->particles;
    int64_t kept = 0;
    for (int64_t i = 0; i < particles->n; i++) {
        bool ends = particles->open[i] < 0; /* found no space */
        if (ends) particles->open[i] = -particles->open[i];
        if (particles->open[i]) {
            const struct place at = place_of(o, open_boundary(o, i), i);
            ends |= !in_buffer(o, open_boundary(o, i), &at);
        }
        if (ends) {
            o->count[particles->open[i] - 1][OPEN_LEFT]++;
            count_particle(o, i, -1);
            continue;
        }
        if (kept < i) particles_copy(particles, i, kept);
        kept++;
    }
    particles->n = kept;
}

/* Marks fluid that is to be removed. The given velocity is then not all that passes the line. */
static void mark_returned(struct open_boundaries *o, int64_t i, struct diag *d)
{
    const struct particles *const particles = o->particles;
    const struct scene_open *const b = open_boundary(o, i);
    if (!o->warned)
        diag_warn(d,
                  "%s fluid runs back over the line at (%.4g, %.4g) m and is removed, so "
                  "less flows in than given. A higher `level`, a slower start or a line further "
                  "away may help",
                  section_title(b->common).text, particles->x[i], particles->y[i]);
    o->warned = true;
    particles->open[i] = -particles->open[i];
}

enum err open_exchange(struct open_boundaries *o, struct diag *d)
{
    struct particles *const particles = o->particles;
    const int64_t n = particles->n; /* copies follow behind */
    enum err e = ERR_OK;
    for (int64_t i = 0; i < n && !e; i++) {
        if (particles->open[i] == 0) {
            particles->open[i] = buffer_at(o, i);
            if (particles->open[i] && strip_is_full(o, i)) mark_returned(o, i, d);
            continue;
        }
        const struct scene_open *const b = open_boundary(o, i);
        const struct place at = place_of(o, b, i);
        if (at.in <= 0 || !in_buffer(o, b, &at)) continue;
        e = fill_strip(o, i, n, d);
        particles->open[i] = 0;
    }
    end_particles(o);
    return e;
}

enum err open_list(struct open_boundaries *o, struct diag *d)
{
    const struct particles *const particles = o->particles;
    o->n_members = 0;
    for (int64_t i = 0; i < particles->n; i++) {
        if (particles->open[i] == 0) continue;
        if (particles->open[i] < 0 || particles->open[i] > o->n)
            return diag_fail(
                d, ERR_INPUT,
                "checkpoint: fluid particle %lld belongs to open boundary %d, but the case has "
                "only %d; restore the [inflow] and [outflow] sections of the checkpoint",
                (long long)particles->id[i], (int)particles->open[i], o->n);
        if (o->n_members == o->capacity)
            return diag_fail(d, ERR_GUARD,
                             "the buffers of the open boundaries contain four times as many "
                             "particles as at the start. Fluid collects in them; a smaller dp or a "
                             "line further from the disturbance may help");
        o->member[o->n_members++].particle = (int32_t)i;
    }
    return ERR_OK;
}

double open_energy(const struct open_boundaries *o)
{
    double sum = 0;
    for (int k = 0; k < o->n; k++) sum += o->sum[k][OPEN_ENERGY];
    return sum;
}

void open_forget(struct open_boundaries *o)
{
    for (int k = 0; k < o->n; k++)
        o->sum[k][OPEN_MOMENTUM_X] = o->sum[k][OPEN_MOMENTUM_Y] = o->sum[k][OPEN_ENERGY] = 0;
}

uint64_t open_hash(const struct open_boundaries *o, uint64_t h)
{
    h = hash_bytes(h, o->sum, (size_t)o->n * sizeof *o->sum);
    h = hash_bytes(h, o->count, (size_t)o->n * sizeof *o->count);
    return hash_bytes(h, &o->next_id, sizeof o->next_id);
}
