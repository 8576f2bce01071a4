/* SPDX-License-Identifier: MIT
 * Where a particle finds its neighbours: in a tile of candidates copied once per cell, as the program
 * does it, or in a list of its own with a skin (Verlet 1967), as most codes do. The bare laws (Eqs. 1 and
 * 3b) over the same particles in single precision, one thread. Prints CSV; both ways give the same sums.
 *   bench_neighbours [--reps N] */
#include "base.h"
#include "morton.h"
#include "simd.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 316, N = SIDE * SIDE, TILE = 512, ROOM = 64, MAX_REPS = 99 };
#define H 1.35f   /* in spacings, as the case files have it */
#define SKIN 0.2f /* 0.15 h */
#define REACH (2 * H + SKIN)

enum field { X, Y, U, V, P, VOLUME, FIELDS };

static float field[FIELDS][N + TILE], rate[2][3][N]; /* by way: d ln rho/dt, ax, ay */
static int32_t first[(SIDE + 8) * (SIDE + 8)], count[(SIDE + 8) * (SIDE + 8)];
static int32_t *list, neighbours[N];
static int cells;

static float noise(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (float)((double)(*state >> 11) * 0x1p-53 - 0.5);
}

static int cell_of(int i)
{
    return (int)(field[Y][i] / REACH) * cells + (int)(field[X][i] / REACH);
}

static int compare_key(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* A shaken lattice with a flow, along Morton's curve through the cells. */
static void place(void)
{
    static float raw[FIELDS][N];
    static uint64_t key[N];
    uint64_t state = 1;
    cells = (int)(SIDE / REACH) + 1;
    for (int i = 0; i < N; i++) {
        raw[X][i] = (float)(i % SIDE) + 0.5f + 0.3f * noise(&state);
        raw[Y][i] = (float)i / SIDE + 0.3f * noise(&state);
        raw[Y][i] = fminf(fmaxf(raw[Y][i], 0), SIDE - 0.01f);
        raw[U][i] = sinf(raw[Y][i] / 50), raw[V][i] = cosf(raw[X][i] / 50);
        raw[P][i] = (SIDE - raw[Y][i]) / SIDE, raw[VOLUME][i] = 1 + 0.01f * noise(&state);
        const uint32_t cx = (uint32_t)(raw[X][i] / REACH), cy = (uint32_t)(raw[Y][i] / REACH);
        key[i] = (uint64_t)morton_key(cx, cy) << 32 | (uint32_t)i;
    }
    qsort(key, N, sizeof *key, compare_key);
    for (int i = 0; i < N; i++)
        for (int f = 0; f < FIELDS; f++) field[f][i] = raw[f][(uint32_t)key[i]];
    for (int i = 0; i < N; i++)
        if (count[cell_of(i)]++ == 0) first[cell_of(i)] = i;
}

/* What a pack of pairs adds to the three sums of a particle. */
SPHFSI_INLINE void add_pairs(const float *me, vfloat x, vfloat y, vfloat u, vfloat v, vfloat p,
                             vfloat volume, vfloat sum[3])
{
    const vfloat dx = me[X] - x, dy = me[Y] - y;
    const vfloat q = vsqrt_float(vfma_float(dy, dy, dx * dx)) * (1 / H);
    const vfloat t = vmax_float(vset_float(0), vfma_float(vset_float(-0.5f), q, vset_float(1)));
    const vfloat slope = t * t * t * volume;
    const vfloat stress = slope * (me[P] + p);
    sum[0] = vfma_float(slope, vfma_float(me[U] - u, dx, (me[V] - v) * dy), sum[0]);
    sum[1] = vfma_float(stress, dx, sum[1]);
    sum[2] = vfma_float(stress, dy, sum[2]);
}

static void keep(int way, int i, const vfloat sum[3])
{
    for (int k = 0; k < 3; k++) rate[way][k][i] = vsum_float(sum[k]);
}

static void sweep_tiles(void)
{
    static float tile[FIELDS][TILE];
    for (int cell = 0; cell < cells * cells; cell++) {
        if (!count[cell]) continue;
        int n = 0;
        for (int dy = -1; dy <= 1; dy++) {
            for (int dx = -1; dx <= 1; dx++) {
                const int cx = cell % cells + dx, cy = cell / cells + dy;
                if (cx < 0 || cy < 0 || cx >= cells || cy >= cells) continue;
                const int other = cy * cells + cx;
                for (int f = 0; f < FIELDS; f++)
                    memcpy(&tile[f][n], &field[f][first[other]],
                           (size_t)count[other] * sizeof(float));
                n += count[other];
            }
        }
        for (int l = 0; l < LANES_FLOAT; l++) tile[X][n + l] = 1e6f, tile[VOLUME][n + l] = 0;
        for (int i = first[cell]; i < first[cell] + count[cell]; i++) {
            float me[FIELDS];
            for (int f = 0; f < FIELDS; f++) me[f] = field[f][i];
            vfloat sum[3] = {{0}, {0}, {0}};
            for (int j = 0; j < n; j += LANES_FLOAT)
                add_pairs(me, vload_float(&tile[X][j]), vload_float(&tile[Y][j]),
                          vload_float(&tile[U][j]), vload_float(&tile[V][j]),
                          vload_float(&tile[P][j]), vload_float(&tile[VOLUME][j]), sum);
            keep(0, i, sum);
        }
    }
}

/* Indices within the reach, filled up to whole packs with a particle far away that weighs nothing. */
static void build_lists(void)
{
    for (int i = 0; i < N; i++) {
        int32_t *const mine = &list[(size_t)i * ROOM];
        int n = 0;
        const int cx = cell_of(i) % cells, cy = cell_of(i) / cells;
        for (int y = cy > 0 ? cy - 1 : 0; y <= cy + 1 && y < cells; y++)
            for (int x = cx > 0 ? cx - 1 : 0; x <= cx + 1 && x < cells; x++)
                for (int j = first[y * cells + x]; j < first[y * cells + x] + count[y * cells + x];
                     j++) {
                    const float dx = field[X][i] - field[X][j], dy = field[Y][i] - field[Y][j];
                    if (dx * dx + dy * dy < REACH * REACH && n < ROOM) mine[n++] = j;
                }
        neighbours[i] = n;
        while (n % LANES_FLOAT) mine[n++] = N;
    }
}

SPHFSI_INLINE vfloat gather(const float *from, const int32_t *index)
{
#ifdef SIMD_AVX512
    return (vfloat)_mm512_i32gather_ps(_mm512_loadu_si512(index), from, 4);
#elif defined SIMD_AVX2
    return (vfloat)_mm256_i32gather_ps(from, _mm256_loadu_si256((const __m256i *)index), 4);
#else
    vfloat a;
    for (int l = 0; l < LANES_FLOAT; l++) a[l] = from[index[l]];
    return a;
#endif
}

static void sweep_lists(void)
{
    field[X][N] = 1e6f, field[VOLUME][N] = 0;
    for (int i = 0; i < N; i++) {
        const int32_t *const mine = &list[(size_t)i * ROOM];
        float me[FIELDS];
        for (int f = 0; f < FIELDS; f++) me[f] = field[f][i];
        vfloat sum[3] = {{0}, {0}, {0}};
        for (int k = 0; k < neighbours[i]; k += LANES_FLOAT)
            add_pairs(me, gather(field[X], &mine[k]), gather(field[Y], &mine[k]),
                      gather(field[U], &mine[k]), gather(field[V], &mine[k]),
                      gather(field[P], &mine[k]), gather(field[VOLUME], &mine[k]), sum);
        keep(1, i, sum);
    }
}

static int compare_double(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void measure(const char *way, const char *part, void (*run)(void), int reps)
{
    double sample[MAX_REPS];
    run();
    for (int r = 0; r < reps; r++) {
        const double start = wall_clock();
        run();
        sample[r] = 1e9 * (wall_clock() - start) / N;
    }
    qsort(sample, (size_t)reps, sizeof *sample, compare_double);
    printf("neighbours,%s,%d,1,%s,ns/particle,%.4g,%.4g,%.4g\n", way, N, part, sample[reps / 2],
           sample[0], sample[reps - 1]);
}

int main(int argc, char **argv)
{
    const int asked = argc > 2 && strcmp(argv[1], "--reps") == 0 ? atoi(argv[2]) : 5;
    const int reps = asked < 1 ? 1 : asked < MAX_REPS ? asked : MAX_REPS;
    list = aligned_alloc(64, sizeof *list * ROOM * N);
    if (!list) return 1;
    place();
    measure("tile", "copy and sweep", sweep_tiles, reps);
    measure("list", "build", build_lists, reps);
    measure("list", "sweep", sweep_lists, reps);
    double off = 0, top = 0, mean = 0;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < N; i++) {
            off = fmax(off, fabs((double)rate[0][k][i] - (double)rate[1][k][i]));
            top = fmax(top, fabs((double)rate[0][k][i]));
        }
    for (int i = 0; i < N; i++) mean += (double)neighbours[i] / N;
    printf("neighbours,list,%d,1,entries,1/particle,%.4g,%.4g,%.4g\n", N, mean, mean, mean);
    printf("neighbours,both,%d,1,largest difference,of the largest,%.3g,%.3g,%.3g\n", N, off / top,
           off / top, off / top);
    free(list);
    return 0;
}
