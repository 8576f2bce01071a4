/* SPDX-License-Identifier: MIT
 * Compares neighbour searches: cluster pair lists, full or, as in the program, half lists in chunks
 * of cells; a tile of candidates copied once per cell; and a neighbour list per particle with a
 * skin (Verlet 1967). The laws are Eqs. 1 and 3b, in single precision, on one thread, for the same
 * particles. Prints CSV; the sums of all methods agree but for rounding. bench_neighbours [--reps
 * N] */
#include "base/threads.h"
#include "fluid/fluid.h"
#include "particles/cells.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 316, N = SIDE * SIDE, TILE = 512, MOST_NEIGHBOURS = 64, MAX_REPS = 99 };
#define H 1.35f   /* in spacings, as the case files have it */
#define SKIN 0.2f /* 0.15 h */
#define REACH (2 * H + SKIN)

enum field { X, Y, U, V, P, VOLUME, FIELDS };
enum method { BY_TILE, BY_LIST, BY_CLUSTER, BY_CHUNK, METHODS };

static float field[FIELDS][N + TILE], rate[METHODS][3][N]; /* d ln rho/dt, ax, ay */
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

/* A perturbed lattice with a flow, in Morton order of the cells. */
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

/* Contributions of a vector of pairs to the three sums of a particle, or of one particle per group.
 */
SPHFSI_INLINE void pairs(const vfloat *me, vfloat x, vfloat y, vfloat u, vfloat v, vfloat p,
                         vfloat volume, vfloat more[3])
{
    const vfloat dx = me[X] - x, dy = me[Y] - y;
    const vfloat q = vsqrt_float(vfma_float(dy, dy, dx * dx)) * (1 / H);
    const vfloat t = vmax_float(vset_float(0), vfma_float(vset_float(-0.5f), q, vset_float(1)));
    const vfloat slope = t * t * t * volume;
    const vfloat stress = slope * (me[P] + p);
    more[0] = slope * vfma_float(me[U] - u, dx, (me[V] - v) * dy);
    more[1] = stress * dx;
    more[2] = stress * dy;
}

SPHFSI_INLINE void add_pairs(const vfloat *me, vfloat x, vfloat y, vfloat u, vfloat v, vfloat p,
                             vfloat volume, vfloat sum[3])
{
    vfloat more[3];
    pairs(me, x, y, u, v, p, volume, more);
    for (int k = 0; k < 3; k++) sum[k] = sum[k] + more[k];
}

static void store(enum method method, int i, const vfloat sum[3])
{
    for (int k = 0; k < 3; k++) {
        float group[GROUPS_FLOAT];
        vsum_four_float(sum[k], group);
        rate[method][k][i] = group[0];
        for (int g = 1; g < GROUPS_FLOAT; g++) rate[method][k][i] += group[g];
    }
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
            vfloat me[FIELDS];
            for (int f = 0; f < FIELDS; f++) me[f] = vset_float(field[f][i]);
            vfloat sum[3] = {{0}, {0}, {0}};
            for (int j = 0; j < n; j += LANES_FLOAT)
                add_pairs(me, vload_float(&tile[X][j]), vload_float(&tile[Y][j]),
                          vload_float(&tile[U][j]), vload_float(&tile[V][j]),
                          vload_float(&tile[P][j]), vload_float(&tile[VOLUME][j]), sum);
            store(BY_TILE, i, sum);
        }
    }
}

/* Indices within the reach, padded to whole vectors with a distant particle of zero volume. */
static void build_lists(void)
{
    for (int i = 0; i < N; i++) {
        int32_t *const mine = &list[(size_t)i * MOST_NEIGHBOURS];
        int n = 0;
        const int cx = cell_of(i) % cells, cy = cell_of(i) / cells;
        for (int y = cy > 0 ? cy - 1 : 0; y <= cy + 1 && y < cells; y++)
            for (int x = cx > 0 ? cx - 1 : 0; x <= cx + 1 && x < cells; x++)
                for (int j = first[y * cells + x]; j < first[y * cells + x] + count[y * cells + x];
                     j++) {
                    const float dx = field[X][i] - field[X][j], dy = field[Y][i] - field[Y][j];
                    if (dx * dx + dy * dy < REACH * REACH && n < MOST_NEIGHBOURS) mine[n++] = j;
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
        const int32_t *const mine = &list[(size_t)i * MOST_NEIGHBOURS];
        vfloat me[FIELDS];
        for (int f = 0; f < FIELDS; f++) me[f] = vset_float(field[f][i]);
        vfloat sum[3] = {{0}, {0}, {0}};
        for (int k = 0; k < neighbours[i]; k += LANES_FLOAT)
            add_pairs(me, gather(field[X], &mine[k]), gather(field[Y], &mine[k]),
                      gather(field[U], &mine[k]), gather(field[V], &mine[k]),
                      gather(field[P], &mine[k]), gather(field[VOLUME], &mine[k]), sum);
        store(BY_LIST, i, sum);
    }
}

/* The program's cells and clusters, with packed fields. */
static struct arena arena;
static struct particles kinds[KIND_COUNT];
static struct cells grid;
static struct cluster_boxes boxes;
static float *packed; /* [clusters][FIELDS][CLUSTER] */
static int64_t full_pairs, half_pairs;

static enum err clusters_create(struct diag *d)
{
    const double lower[2] = {-0.5, -0.5}, upper[2] = {SIDE + 0.5, SIDE + 0.5};
    struct particles *const particles = &kinds[KIND_FLUID];
    TRY(particles_create(particles, &arena, N, G_POINT, "bench", d));
    particles->n = N;
    for (int i = 0; i < N; i++)
        particles->x[i] = (double)field[X][i], particles->y[i] = (double)field[Y][i],
        particles->id[i] = i;
    TRY(cells_create(&grid, &arena, lower, upper, 1, 2 * (double)H, 0.75 * (double)H, kinds, d));
    TRY(cluster_boxes_create(&boxes, &arena, cells_clusters(&grid, N), d));
    packed = arena_alloc(&arena, (size_t)cells_clusters(&grid, N),
                         sizeof *packed * FIELDS * CLUSTER, "packed fields", d);
    return packed ? ERR_OK : ERR_MEMORY;
}

static void sort_clusters(void) { cells_sort(&grid, KIND_FLUID, &kinds[KIND_FLUID]); }

static void fill_clusters(void)
{
    const struct cell_list *const listed = &grid.list[KIND_FLUID];
    const struct particles *const particles = &kinds[KIND_FLUID];
    for (int32_t k = 0; k < listed->n_active; k++) {
        const int32_t cell = listed->active[k];
        const double centre[2] = {cell_centre_x(&grid, cell), cell_centre_y(&grid, cell)};
        for (int32_t m = 0; m < clusters_in(listed, cell) * CLUSTER; m++) {
            const int32_t cluster = listed->cluster[cell] + m / CLUSTER,
                          i = listed->start[cell] + m;
            float *const out = packed + cluster * FIELDS * CLUSTER + m % CLUSTER;
            const bool is = m < listed->count[cell];
            for (int f = 0; f < FIELDS; f++) out[f * CLUSTER] = is ? field[f][particles->id[i]] : 0;
            out[X * CLUSTER] = is ? (float)(particles->x[i] - centre[0]) : 1e9f;
            out[Y * CLUSTER] = is ? (float)(particles->y[i] - centre[1]) : 0;
            if (!is) continue;
            const float at[2] = {out[X * CLUSTER] / H, out[Y * CLUSTER] / H};
            for (int side = 0; side < BOX_SIDES; side++) {
                float *const box = &boxes.side[side][cluster];
                const float place = at[side / 2];
                if (m % CLUSTER == 0 || (side % 2 ? place > *box : place < *box)) *box = place;
            }
        }
    }
}

/* Particles of a cluster from the r-th on, one per group, and their positions relative to the 3 x 3
 * cells. */
SPHFSI_INLINE void receivers_of(int32_t cluster, int r, vfloat me[FIELDS], vfloat x[3], vfloat y[3])
{
    const float *const own = packed + cluster * FIELDS * CLUSTER + r;
    for (int f = 0; f < FIELDS; f++) me[f] = vspread_float(own + f * CLUSTER);
    for (int k = 0; k < 3; k++) x[k] = me[X] - (float)(k - 1) * (float)grid.side[0];
    for (int k = 0; k < 3; k++) y[k] = me[Y] - (float)(k - 1) * (float)grid.side[1];
}

/* The receivers of a cluster from the r-th on. */
static void sweep_receivers(const struct cluster_list *near, int32_t at, int32_t cluster, int r)
{
    vfloat me[FIELDS], x[3], y[3], sum[3] = {{0}, {0}, {0}};
    receivers_of(cluster, r, me, x, y);
    for (int k = 0; k < near->n; k++) {
        const uint32_t code = near->code[k];
        const float *const b = packed + neighbour_number(code) * FIELDS * CLUSTER;
        me[X] = x[neighbour_column(code)], me[Y] = y[neighbour_row(code)];
        add_pairs(me, vfour_float(b + X * CLUSTER), vfour_float(b + Y * CLUSTER),
                  vfour_float(b + U * CLUSTER), vfour_float(b + V * CLUSTER),
                  vfour_float(b + P * CLUSTER), vfour_float(b + VOLUME * CLUSTER), sum);
    }
    for (int k = 0; k < 3; k++) {
        float out[GROUPS_FLOAT];
        vsum_four_float(sum[k], out);
        for (int g = 0; g < GROUPS_FLOAT && at + g < N; g++)
            rate[BY_CLUSTER][k][kinds[KIND_FLUID].id[at + g]] = out[g];
    }
}

/* In order: the padding that the last cluster of a cell writes is overwritten by the next cell. */
static void sweep_clusters(void)
{
    static struct neighbour_clusters around;
    static struct cluster_list near;
    const struct cell_list *const listed = &grid.list[KIND_FLUID];
    full_pairs = 0;
    for (int32_t k = 0; k < listed->n_active; k++) {
        const int32_t cell = listed->active[k];
        neighbour_clusters_collect(&around, &boxes, &grid, KIND_FLUID, cell, (double)H,
                                   (struct cluster_range){0});
        for (int32_t m = 0; m < clusters_in(listed, cell); m++) {
            cluster_list_build(&near, &around, &boxes, listed->cluster[cell] + m);
            full_pairs += near.n * CLUSTER * CLUSTER;
            for (int r = 0; r < CLUSTER; r += GROUPS_FLOAT)
                sweep_receivers(&near, listed->start[cell] + m * CLUSTER + r,
                                listed->cluster[cell] + m, r);
        }
    }
}

/* Deferred sums of the clusters of a chunk: [cluster][sum][receiver][candidate]; cluster 0 is
 * discarded. */
static float deferred[1 + CHUNK_CELLS * CELL_CAPACITY / CLUSTER][3][CLUSTER][CLUSTER];

/* The receivers of a cluster from the r-th on. Pairs of the half list serve both particles, so both
 * volumes are factors. */
static void chunk_receivers(const struct cluster_list *near, size_t before, int32_t cluster, int r,
                            vfloat sum[3])
{
    vfloat me[FIELDS], x[3], y[3], more[3];
    receivers_of(cluster, r, me, x, y);
    for (int k = 0; k < near->n; k++) {
        const uint32_t code = near->code[k];
        const float *const b = packed + neighbour_number(code) * FIELDS * CLUSTER;
        me[X] = x[neighbour_column(code)], me[Y] = y[neighbour_row(code)];
        pairs(me, vfour_float(b + X * CLUSTER), vfour_float(b + Y * CLUSTER),
              vfour_float(b + U * CLUSTER), vfour_float(b + V * CLUSTER),
              vfour_float(b + P * CLUSTER), me[VOLUME] * vfour_float(b + VOLUME * CLUSTER), more);
        const size_t place = (neighbour_number(code) - before) * neighbour_is_half(code);
        for (int m = 0; m < 3; m++) {
            float *const at = deferred[place][m][r];
            sum[m] = sum[m] + more[m];
            vstore_float(at, vload_float(at) + more[m]);
        }
    }
}

/* Adds the deferred sums of the m-th cluster of a cell to its own sums. */
static void chunk_cluster(const struct cluster_list *near, size_t before, int32_t cell, int32_t m)
{
    const struct cell_list *const listed = &grid.list[KIND_FLUID];
    const int32_t cluster = listed->cluster[cell] + m, i = listed->start[cell] + m * CLUSTER;
    float own[3][CLUSTER];
    for (int r = 0; r < CLUSTER; r += GROUPS_FLOAT) {
        vfloat sum[3] = {{0}, {0}, {0}};
        chunk_receivers(near, before, cluster, r, sum);
        for (int k = 0; k < 3; k++) vsum_four_float(sum[k], &own[k][r]);
    }
    for (int k = 0; k < 3; k++) {
        float(*const left)[CLUSTER] = deferred[(size_t)cluster - before][k];
        const float sign = k == 0 ? 1 : -1;
        for (int r = 0; r < CLUSTER && m * CLUSTER + r < listed->count[cell]; r++)
            rate[BY_CHUNK][k][kinds[KIND_FLUID].id[i + r]] =
                (own[k][r] + sign * ((left[0][r] + left[2][r]) + (left[1][r] + left[3][r]))) /
                packed[(cluster * FIELDS + VOLUME) * CLUSTER + r];
        memset(left, 0, sizeof deferred[0][0]);
    }
}

static void sweep_chunks(void)
{
    static struct neighbour_clusters around;
    static struct cluster_list near;
    const struct cell_list *const listed = &grid.list[KIND_FLUID];
    const int32_t n = listed->n_active;
    half_pairs = 0;
    for (int32_t chunk = 0; chunk < fluid_chunk_count(n); chunk++) {
        const int32_t begin = fluid_chunk_start(n, chunk), end = fluid_chunk_start(n, chunk + 1);
        if (begin == end) continue;
        const struct cluster_range range = clusters_of(listed, begin, end);
        for (int32_t k = begin; k < end; k++) {
            const int32_t cell = listed->active[k];
            neighbour_clusters_collect(&around, &boxes, &grid, KIND_FLUID, cell, (double)H, range);
            for (int32_t m = clusters_in(listed, cell) - 1; m >= 0; m--) {
                cluster_list_build_half(&near, &around, &boxes);
                half_pairs += near.n * CLUSTER * CLUSTER;
                chunk_cluster(&near, (size_t)range.first - 1, cell, m);
            }
        }
    }
}

static int compare_double(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void measure(const char *method, const char *part, void (*run)(void), int reps)
{
    double sample[MAX_REPS];
    run();
    for (int r = 0; r < reps; r++) {
        const double start = wall_clock();
        run();
        sample[r] = 1e9 * (wall_clock() - start) / N;
    }
    qsort(sample, (size_t)reps, sizeof *sample, compare_double);
    printf("neighbours,%s,%d,1,%s,ns/particle,%.4g,%.4g,%.4g\n", method, N, part, sample[reps / 2],
           sample[0], sample[reps - 1]);
}

static void say(const char *method, const char *what, const char *unit, double value)
{
    printf("neighbours,%s,%d,1,%s,%s,%.4g,%.4g,%.4g\n", method, N, what, unit, value, value, value);
}

int main(int argc, char **argv)
{
    const int asked = argc > 2 && strcmp(argv[1], "--reps") == 0 ? atoi(argv[2]) : 5;
    const int reps = asked < 1 ? 1 : asked < MAX_REPS ? asked : MAX_REPS;
    list = aligned_alloc(64, sizeof *list * MOST_NEIGHBOURS * N);
    if (!list) return 1;
    place();
    struct diag diag = {0};
    if (clusters_create(&diag)) return 1;
    measure("tile", "copy and sweep", sweep_tiles, reps);
    measure("list", "build", build_lists, reps);
    measure("list", "sweep", sweep_lists, reps);
    measure("cluster", "sort", sort_clusters, reps);
    measure("cluster", "fill", fill_clusters, reps);
    measure("cluster", "list and sweep", sweep_clusters, reps);
    measure("chunk", "list and sweep", sweep_chunks, reps);
    double off = 0, top = 0, mean = 0;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < N; i++) {
            const double tile = (double)rate[BY_TILE][k][i];
            for (int method = 1; method < METHODS; method++)
                off = fmax(off, fabs(tile - (double)rate[method][k][i]));
            top = fmax(top, fabs(tile));
        }
    for (int i = 0; i < N; i++) mean += (double)neighbours[i] / N;
    say("list", "entries", "1/particle", mean);
    say("cluster", "pairs", "1/particle", (double)full_pairs / N);
    say("chunk", "pairs", "1/particle", (double)half_pairs / N);
    say("all", "largest difference", "of the largest", off / top);
    arena_free(&arena);
    free(list);
    return 0;
}
