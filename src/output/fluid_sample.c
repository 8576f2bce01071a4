/* SPDX-License-Identifier: MIT
 * Sampling the fluid: at a point, at its surface, at its front, through a line. */
#include "output/probes.h"

/* Below a tenth of a full neighbourhood a point counts as dry. */
#define DRY 0.1

/* The sums of a sample. */
struct sampling {
    struct sample sum;
    double dx, dy;         /* to the place from the fluid within reach, m */
    double rho;            /* of this fluid, kg/m^3 */
    double ax, ay;         /* of this fluid, m/s^2 */
    double wall_x, wall_y; /* of walls and structures, m/s^2 */
};

static void add_to_sample(struct sampling *at, const struct fluid *fluid,
                          const struct cell_visit *v)
{
    const struct particles *const particles = v->particles;
    const struct fluid_constants *const k = &fluid->k;
    const int64_t i = v->i;
    const double w = fluid_seen(fluid, v->cells, v->at, (enum kind)v->kind, i, v->x, v->y) *
                     kernel_w(v->r, k->h) * square(k->dp);
    if (v->kind != KIND_FLUID) {
        const double occupied = w * fluid_volume_of(fluid, (enum kind)v->kind, particles, i);
        at->sum.occupied += occupied;
        at->wall_x += occupied * (particles->ax ? particles->ax[i] : 0);
        at->wall_y += occupied * (particles->ay ? particles->ay[i] : 0);
        return;
    }
    at->sum.fill += w;
    at->sum.pressure += w * eos_pressure(particles->dens[i], k->rho0, k->c0);
    at->sum.vx += w * particles->vx[i];
    at->sum.vy += w * particles->vy[i];
    at->dx -= w * v->x;
    at->dy -= w * v->y;
    at->rho += w * k->rho0 * (1 + particles->dens[i]);
    at->ax += w * particles->ax[i];
    at->ay += w * particles->ay[i];
}

/* T-10a: from the mean over the fluid to a place beside it. */
static double rise_to_place(const struct simulation *sim, const struct sampling *at, double mean)
{
    const double air = max2(0, 1 - at->sum.fill - at->sum.occupied),
                 missing = at->sum.occupied + air;
    if (missing <= 0) return 0;
    const double ax = (at->wall_x + air * mean * at->ax) / missing,
                 ay = (at->wall_y + air * mean * at->ay) / missing;
    const double *const g = sim->fluid.k.gravity;
    return square(mean) * at->rho * ((g[0] - ax) * at->dx + (g[1] - ay) * at->dy);
}

struct sample fluid_sample(const struct simulation *sim, double x, double y)
{
    struct sampling at = {.dx = 0};
    struct sample *const sum = &at.sum;
    const double place[2] = {x, y};
    if (!(sim->effects & FX_FLUID)) return *sum;
    struct cell_visit v = cells_visit(&sim->cells, sim->particles, 0, KIND_COUNT, place,
                                      KERNEL_REACH * sim->fluid.k.h);
    while (cells_next(&v)) add_to_sample(&at, &sim->fluid, &v);
    const double mean = sum->fill > DRY ? 1 / sum->fill : 0;
    sum->pressure = mean * sum->pressure + rise_to_place(sim, &at, mean);
    sum->vx *= mean;
    sum->vy *= mean;
    return *sum;
}

/* The water's volume fraction of the space outside walls and structures. */
static double wetness(const struct simulation *sim, double x, double y)
{
    const struct sample at = fluid_sample(sim, x, y);
    return at.fill / max2(1 - at.occupied, 0.05);
}

/* T-79, Gibbs' dividing surface: the height at which water that is full below and absent above has
 * the volume of that within reach. Unlike the height of half wetness it does not move when rows
 * near the surface do, while their mean height stays. `y` is the last wet height. */
static double dividing_surface(const struct simulation *sim, double x, double y, double step)
{
    const int reach = (int)(KERNEL_REACH * sim->fluid.k.h / step);
    const double at_y = wetness(sim, x, y);
    double level = y;
    for (int up = 1; up >= 0; up--) {
        double before = at_y;
        for (int k = 1; k <= reach; k++) {
            const double now = wetness(sim, x, up ? y + k * step : y - k * step);
            if ((now > 0.5) == up) break; /* other water above, or below a thin layer */
            level += (0.5 * (before + now) - !up) * step;
            before = now;
        }
    }
    return level;
}

double fluid_level(const struct simulation *sim, double x, double y)
{
    const double step = 0.25 * sim->scene->top.dp,
                 top = sim->cells.lower[1] + sim->cells.ny * sim->cells.side[1];
    const int reach = (int)(KERNEL_REACH * sim->fluid.k.h / step),
              most = (int)((top - y) / step) + 1;
    bool wet = wetness(sim, x, y) > 0.5;
    for (int k = 1; k <= most && (wet || k <= reach); k++) {
        const bool now = wetness(sim, x, y + k * step) > 0.5;
        if (wet && !now) return dividing_surface(sim, x, y + (k - 1) * step, step);
        wet = now;
    }
    return wet ? top : y;
}

double fluid_front(const struct simulation *sim, int direction)
{
    const struct particles *const particles = &sim->particles[KIND_FLUID];
    const bool vertical = direction == DIRECTION_UP || direction == DIRECTION_DOWN;
    const double sign = direction == DIRECTION_RIGHT || direction == DIRECTION_UP ? 1 : -1;
    const double *const coordinate = vertical ? particles->y : particles->x;
    double foremost = -(double)INFINITY, any = -(double)INFINITY;
    for (int64_t k = 0; k < particles->n; k++) {
        /* Memory follows the coordinates: from the front on few particles are tested. */
        const int64_t i = sign > 0 ? particles->n - 1 - k : k;
        const double ahead = sign * coordinate[i];
        any = max2(any, ahead);
        /* The thinnest tongue is a row of particles, of which the first has two within reach. */
        if (ahead > foremost &&
            simulation_count_near(sim, particles->x[i], particles->y[i], KIND_FLUID + 1) >= 3)
            foremost = ahead;
    }
    if (particles->n == 0) return (double)NAN;
    /* The water ends half a spacing beyond the last particle's centre. */
    return sign * ((isfinite(foremost) ? foremost : any) + 0.5 * sim->scene->top.dp);
}

/* The mean over a strip, weighted by a cosine bell of area 1. One spacing to either side is the
 * least for which its sum over a lattice is exact. A wider strip would miss what flows into an
 * opening round its edge. */
double fluid_flux(const struct simulation *sim, const double a[2], const double b[2])
{
    const struct particles *const particles = &sim->particles[KIND_FLUID];
    const double length = elementary_hypot(b[0] - a[0], b[1] - a[1]), reach = sim->scene->top.dp,
                 tx = (b[0] - a[0]) / length, ty = (b[1] - a[1]) / length;
    double sum = 0, shift[2];
    for (int64_t i = 0; i < particles->n; i++)
        for (int image = 0; image < CELLS_IMAGES; image++) {
            if (!cells_image(&sim->cells, image, shift)) continue;
            const double x = particles->x[i] - a[0] + shift[0],
                         y = particles->y[i] - a[1] + shift[1];
            const double along = x * tx + y * ty, across = x * ty - y * tx;
            if (along < 0 || along > length || fabs(across) >= reach) continue;
            const double bell = 0.5 / reach * (1 + elementary_cos(PI * across / reach));
            sum += bell * relative_mass(particles, i) * square(reach) / (1 + particles->dens[i]) *
                   (particles->vx[i] * ty - particles->vy[i] * tx);
        }
    return sum;
}

void fluid_pressure_on(const struct simulation *sim, const double a[2], const double b[2],
                       double out[3])
{
    const double dx = b[0] - a[0], dy = b[1] - a[1];
    const int n = (int)max2(1, ceil(elementary_hypot(dx, dy) / sim->scene->top.dp - 1e-9));
    double sum = 0;
    for (int k = 0; k < n; k++) {
        const double at = (k + 0.5) / n;
        sum += fluid_sample(sim, a[0] + at * dx, a[1] + at * dy).pressure;
    }
    out[0] = sum / n;
    out[1] = out[0] * dy;
    out[2] = -out[0] * dx;
}
