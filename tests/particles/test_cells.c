/* SPDX-License-Identifier: MIT
 * The cell list against brute force. */
#include "particles/cells.h"

#include "rig.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = 1500 };
static const double lower[2] = {-0.3, 0.1}, upper[2] = {1.15, 0.92};
static const double reach = 0.0731, dp = 0.0304, stray = 0.02;

static struct arena arena;
static struct diag diag;
static struct particles kinds[KIND_COUNT];
static struct cells cells;
static int threads_before;

void setUp(void)
{
    diag = (struct diag){0};
    arena = (struct arena){0};
    threads_before = thread_count();
}

void tearDown(void)
{
    thread_use(threads_before);
    arena_free(&arena);
}

/* N particles of fluid and of walls, some of them beyond the edges or nowhere at all. */
static void scatter(bool with_lost)
{
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        TEST_ASSERT_EQUAL_INT(ERR_OK,
                              particles_create(&kinds[kind], &arena, kind == KIND_SOLID ? 0 : N,
                                               G_POINT, "test", &diag));
        kinds[kind].n = kinds[kind].capacity;
        uint64_t seed = (uint64_t)kind + 5;
        for (int64_t i = 0; i < kinds[kind].n; i++) {
            kinds[kind].x[i] = 0.425 + 0.72 * noise(&seed);
            kinds[kind].y[i] = 0.51 + 0.405 * noise(&seed);
            kinds[kind].vx[i] = (double)i;
            kinds[kind].id[i] = 10 * i + kind;
        }
    }
    if (with_lost) {
        kinds[KIND_FLUID].x[3] = upper[0] + 1e-9;
        kinds[KIND_FLUID].y[700] = lower[1] - 1e-9;
        kinds[KIND_FLUID].x[701] = (double)NAN;
        kinds[KIND_FLUID].y[1499] = (double)INFINITY;
        kinds[KIND_FLUID].x[1498] = -1e300;
        kinds[KIND_FLUID].x[17] = lower[0];
        kinds[KIND_FLUID].y[17] = lower[1];
    }
    TEST_ASSERT_EQUAL_INT(ERR_OK, cells_create(&cells, &arena, lower, upper, dp, reach, stray,
                                               kinds, &diag));
}

static int32_t at(enum kind kind, int32_t place)
{
    return cells.list[kind].order ? cells.list[kind].order[place] : place;
}

static bool adjacent(int32_t a, int32_t b)
{
    return abs(cell_x(&cells, a) - cell_x(&cells, b)) <= 1 &&
           abs(cell_y(&cells, a) - cell_y(&cells, b)) <= 1;
}

/* Four particles or eight, whatever is nearer to 1.6 times the reach; but three cells where they
 * fit a narrow domain: particles stray less. */
static void test_cells_hold_squares_of_the_lattice(void)
{
    scatter(false);
    for (int k = 0; k < 2; k++) TEST_ASSERT_TRUE(fabs(cells.side[k] - 4 * dp) < 0.3 * dp);
    struct cells wide;
    TEST_ASSERT_EQUAL_INT(ERR_OK, cells_create(&wide, &arena, lower, upper, 0.5 * dp, reach, stray,
                                               kinds, &diag));
    for (int k = 0; k < 2; k++) assert_near(0, cells.side[k], wide.side[k], "side");
    assert_near(1e-12, upper[0] - lower[0], cells.nx * cells.side[0], "width");
    assert_near(1e-12, upper[1] - lower[1], cells.ny * cells.side[1], "height");
    assert_near(0, stray, cells.skin, "stray");
    const double near[2] = {lower[0] + 3.3 * reach, lower[1] + 2.9 * reach};
    struct cells narrow;
    TEST_ASSERT_EQUAL_INT(ERR_OK, cells_create(&narrow, &arena, lower, near, dp, reach, stray,
                                               kinds, &diag));
    TEST_ASSERT_EQUAL_INT(3, narrow.nx);
    TEST_ASSERT_EQUAL_INT(2, narrow.ny);
    assert_near(1e-12, 0.5 * (narrow.side[0] - reach), narrow.skin, "stray");
}

/* A long channel has more columns than one digit of the sorting key tells apart. */
static void test_a_long_channel_is_sorted(void)
{
    const double end[2] = {lower[0] + 2000 * reach, lower[1] + 4 * reach};
    scatter(false);
    struct cells channel;
    struct particles *const particles = &kinds[KIND_FLUID];
    TEST_ASSERT_EQUAL_INT(ERR_OK, cells_create(&channel, &arena, lower, end, dp, reach, stray,
                                               kinds, &diag));
    uint64_t seed = 3;
    for (int64_t i = 0; i < particles->n; i++) {
        particles->x[i] = lower[0] + 1000 * reach * (1 + noise(&seed));
        particles->y[i] = lower[1] + 2 * reach * (1 + noise(&seed));
    }
    TEST_ASSERT_EQUAL_INT64(0, cells_sort(&channel, KIND_FLUID, particles));
    TEST_ASSERT_TRUE(channel.nx > 1000 && channel.ny < 4);
    int64_t listed = 0;
    for (int32_t cell = 0; cell < channel.nx * channel.ny; cell++)
        listed += channel.list[KIND_FLUID].count[cell];
    TEST_ASSERT_EQUAL_INT64(particles->n, listed);
}

/* Every pair closer than the reach lies in cells that touch, within a kind and across kinds. */
static void test_no_pair_is_missed(void)
{
    scatter(false);
    for (int kind = KIND_FLUID; kind <= KIND_WALL; kind++)
        TEST_ASSERT_EQUAL_INT64(0, cells_sort(&cells, (enum kind)kind, &kinds[kind]));
    int64_t pairs = 0;
    for (int ka = KIND_FLUID; ka <= KIND_WALL; ka++) {
        for (int kb = KIND_FLUID; kb <= KIND_WALL; kb++) {
            const struct particles *const a = &kinds[ka], *const b = &kinds[kb];
            for (int64_t i = 0; i < a->n; i++) {
                for (int64_t j = 0; j < b->n; j++) {
                    if (hypot(a->x[i] - b->x[j], a->y[i] - b->y[j]) >= reach) continue;
                    TEST_ASSERT_TRUE(adjacent(a->cell[i], b->cell[j]));
                    pairs++;
                }
            }
        }
    }
    TEST_ASSERT_TRUE(pairs > 10 * N);
}

/* The ranges of the active cells hold every particle once, each in the cell where it lies. */
static void check_cover(enum kind kind, int64_t inside)
{
    const struct cell_list *const list = &cells.list[kind];
    const struct particles *const particles = &kinds[kind];
    int32_t place = 0;
    int64_t total = 0;
    uint32_t last_key = 0;
    int32_t clusters = 0;
    for (int32_t k = 0; k < list->n_active; k++) {
        const int32_t cell = list->active[k];
        const uint32_t key =
            morton_key((uint32_t)cell_x(&cells, cell), (uint32_t)cell_y(&cells, cell));
        TEST_ASSERT_TRUE(k == 0 || key > last_key);
        last_key = key;
        TEST_ASSERT_EQUAL_INT32(place, list->start[cell]);
        TEST_ASSERT_TRUE(list->count[cell] > 0);
        TEST_ASSERT_EQUAL_INT32(clusters, list->cluster[cell]);
        clusters += clusters_in(list, cell);
        for (int32_t j = 0; j < list->count[cell]; j++, place++) {
            const int32_t i = at(kind, place);
            TEST_ASSERT_EQUAL_INT32(cell, particles->cell[i]);
            TEST_ASSERT_TRUE(fabs(particles->x[i] - cell_centre_x(&cells, cell)) <=
                             0.5001 * cells.side[0]);
            TEST_ASSERT_TRUE(fabs(particles->y[i] - cell_centre_y(&cells, cell)) <=
                             0.5001 * cells.side[1]);
        }
    }
    for (int32_t cell = 0; cell < cells.nx * cells.ny; cell++) total += list->count[cell];
    TEST_ASSERT_TRUE(clusters <= cells_clusters(&cells, inside));
    TEST_ASSERT_EQUAL_INT64(inside, place);
    TEST_ASSERT_EQUAL_INT64(inside, total);
}

static void test_cells_cover_all_in_morton_order(void)
{
    scatter(false);
    for (int kind = KIND_FLUID; kind <= KIND_WALL; kind++) {
        cells_sort(&cells, (enum kind)kind, &kinds[kind]);
        check_cover((enum kind)kind, N);
    }
    /* Walls keep their places in memory, the fluid moves as whole particles. */
    for (int64_t i = 0; i < N; i++) {
        TEST_ASSERT_EQUAL_INT64(10 * i + KIND_WALL, kinds[KIND_WALL].id[i]);
        TEST_ASSERT_TRUE(kinds[KIND_FLUID].vx[i] == (double)(kinds[KIND_FLUID].id[i] / 10));
    }
}

/* Sixteen particles on a lattice, given in any order, are the four squares of four. */
static void test_clusters_of_a_lattice_are_squares(void)
{
    scatter(false);
    struct particles *const particles = &kinds[KIND_WALL];
    const double x = cell_centre_x(&cells, cells.nx + 1), y = cell_centre_y(&cells, cells.nx + 1);
    particles->n = 16;
    for (int i = 0; i < 16; i++) {
        const int place = 7 * i % 16;
        particles->x[i] = x + 0.01 * (place % 4 - 1.5);
        particles->y[i] = y + 0.01 * (place / 4 - 1.5);
    }
    cells_sort(&cells, KIND_WALL, particles);
    const struct cell_list *const list = &cells.list[KIND_WALL];
    TEST_ASSERT_EQUAL_INT32(1, list->n_active);
    for (int k = 0; k < 16; k++) {
        const int32_t i = list->order[k], first = list->order[k / CLUSTER * CLUSTER];
        assert_at_most(0.0100001, fabs(particles->x[i] - particles->x[first]),
                       "width of a cluster");
        assert_at_most(0.0100001, fabs(particles->y[i] - particles->y[first]),
                       "height of a cluster");
    }
}

/* The k-d tree written plainly, with the library's sort. */
static const struct particles *compared;
static int compared_axis;

static int compare(const void *a, const void *b)
{
    const int32_t i = *(const int32_t *)a, j = *(const int32_t *)b;
    const double *const at[2] = {compared->x, compared->y};
    for (int k = 0; k < 2; k++) {
        const double *const v = at[k ? 1 - compared_axis : compared_axis];
        if (v[i] != v[j]) return v[i] < v[j] ? -1 : 1;
    }
    return compared->id[i] < compared->id[j] ? -1 : 1;
}

static void tree_by_library(int32_t *i, int n)
{
    const double *const at[2] = {compared->x, compared->y};
    double extent[2];
    if (n <= CLUSTER) return;
    for (int axis = 0; axis < 2; axis++) {
        double low = at[axis][i[0]], high = low;
        for (int k = 1; k < n; k++) {
            low = fmin(low, at[axis][i[k]]);
            high = fmax(high, at[axis][i[k]]);
        }
        extent[axis] = high - low;
    }
    compared_axis = extent[1] > extent[0];
    qsort(i, (size_t)n, sizeof *i, compare);
    const int half = (n + 3) / 4 / 2 * 4;
    tree_by_library(i, half);
    tree_by_library(i + half, n - half);
}

/* At places of few values, so that many are equal. */
static void test_order_is_that_of_the_tree(void)
{
    scatter(false);
    struct particles *const particles = &kinds[KIND_WALL];
    const double side = 0.01, x = cell_centre_x(&cells, cells.nx + 1),
                 y = cell_centre_y(&cells, cells.nx + 1);
    uint64_t seed = 9;
    for (int n = CLUSTER + 1; n <= 67; n += 3) {
        int32_t expected[67];
        particles->n = n;
        for (int i = 0; i < n; i++) {
            particles->x[i] = x + side * floor(1.9 * noise(&seed));
            particles->y[i] =
                n % 2 ? y + side * noise(&seed) : y + side * floor(1.9 * noise(&seed));
            particles->id[i] = (7 * i) % 71;
            expected[i] = i;
        }
        cells_sort(&cells, KIND_WALL, particles);
        TEST_ASSERT_EQUAL_INT32(1, cells.list[KIND_WALL].n_active);
        compared = particles;
        tree_by_library(expected, n);
        TEST_ASSERT_EQUAL_INT32_ARRAY(expected, cells.list[KIND_WALL].order, n);
    }
}

/* Clusters of particles thrown at random are hardly wider than squares with room for four of them.
 */
static void test_clusters_are_compact(void)
{
    scatter(false);
    cells_sort(&cells, KIND_FLUID, &kinds[KIND_FLUID]);
    const struct cell_list *const list = &cells.list[KIND_FLUID];
    const struct particles *const particles = &kinds[KIND_FLUID];
    double sum = 0;
    int full = 0;
    for (int32_t k = 0; k < list->n_active; k++) {
        const int32_t start = list->start[list->active[k]], n = list->count[list->active[k]];
        for (int32_t j = start; j + CLUSTER <= start + n; j += CLUSTER, full++) {
            double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
            for (int r = 0; r < CLUSTER; r++) {
                low[0] = fmin(low[0], particles->x[j + r]),
                high[0] = fmax(high[0], particles->x[j + r]);
                low[1] = fmin(low[1], particles->y[j + r]),
                high[1] = fmax(high[1], particles->y[j + r]);
            }
            sum += 0.5 * (high[0] - low[0] + high[1] - low[1]);
        }
    }
    TEST_ASSERT_TRUE(full > N / CLUSTER - list->n_active);
    const double square = sqrt(CLUSTER * 1.44 * 0.81 / N);
    assert_at_most(0.8 * square, sum / full, "mean side of a cluster");
}

/* Particles beyond the edges, NaN and infinities come last, none is lost from the list of them; the
 * lower left corner itself lies inside. */
static void test_lost_particles_come_last(void)
{
    scatter(true);
    TEST_ASSERT_EQUAL_INT64(5, cells_sort(&cells, KIND_FLUID, &kinds[KIND_FLUID]));
    check_cover(KIND_FLUID, N - 5);
    const int64_t lost[] = {30, 7000, 7010, 14980, 14990};
    for (int k = 0; k < 5; k++) {
        TEST_ASSERT_EQUAL_INT64(lost[k], kinds[KIND_FLUID].id[N - 5 + k]);
        TEST_ASSERT_EQUAL_INT32(-1, kinds[KIND_FLUID].cell[N - 5 + k]);
    }
    /* Taken out, the rest sorts to the same again. */
    const uint64_t before = particles_hash(&kinds[KIND_FLUID], 0);
    kinds[KIND_FLUID].n -= 5;
    TEST_ASSERT_EQUAL_INT64(0, cells_sort(&cells, KIND_FLUID, &kinds[KIND_FLUID]));
    check_cover(KIND_FLUID, N - 5);
    kinds[KIND_FLUID].n += 5;
    TEST_ASSERT_EQUAL_HEX64(before, particles_hash(&kinds[KIND_FLUID], 0));
}

static uint64_t hash_after(int threads, uint64_t shuffle)
{
    thread_use(threads);
    arena_free(&arena);
    scatter(true);
    struct particles *const particles = &kinds[KIND_FLUID];
    static int32_t order[N];
    static double scratch[N];
    for (int32_t i = 0; i < N; i++) order[i] = i;
    for (int32_t i = N - 1; shuffle && i > 0; i--) {
        const int32_t j = (int32_t)((noise(&shuffle) + 1) / 2 * i), kept = order[i];
        order[i] = order[j];
        order[j] = kept;
    }
    particles_permute(particles, order, N, scratch);
    /* The list forgets an earlier sorting of particles elsewhere. */
    const double x = particles->x[0];
    particles->x[0] = 0.5;
    cells_sort(&cells, KIND_FLUID, particles);
    for (int64_t i = 0; i < N; i++)
        if (particles->x[i] == 0.5) particles->x[i] = x;
    cells_sort(&cells, KIND_FLUID, particles);
    check_cover(KIND_FLUID, N - 5);
    return particles_hash(particles, 0);
}

static void test_order_does_not_depend_on_threads_or_history(void)
{
    const uint64_t expected = hash_after(1, 0);
    const int threads[] = {1, 2, 3, 8};
    for (int k = 0; k < 4; k++)
        for (uint64_t shuffle = 0; shuffle < 3; shuffle++)
            TEST_ASSERT_EQUAL_HEX64(expected, hash_after(threads[k], shuffle));
}

/* After a restart the list comes from the cells that are stored with the particles. */
static void test_resume_rebuilds_the_same_list(void)
{
    scatter(false);
    for (int kind = KIND_FLUID; kind <= KIND_WALL; kind++) {
        cells_sort(&cells, (enum kind)kind, &kinds[kind]);
        /* Particles have moved on since the sorting; the list must not notice. */
        for (int64_t i = 0; i < N; i++) kinds[kind].x[i] += 0.05;
        struct cells fresh;
        TEST_ASSERT_EQUAL_INT(ERR_OK, cells_create(&fresh, &arena, lower, upper, dp, reach, stray,
                                                   kinds, &diag));
        cells_rebuild(&fresh, (enum kind)kind, &kinds[kind]);
        const struct cell_list *const a = &cells.list[kind], *const b = &fresh.list[kind];
        TEST_ASSERT_EQUAL_INT32(a->n_active, b->n_active);
        TEST_ASSERT_EQUAL_INT32_ARRAY(a->active, b->active, a->n_active);
        TEST_ASSERT_EQUAL_INT32_ARRAY(a->count, b->count, cells.nx * cells.ny);
        for (int32_t k = 0; k < a->n_active; k++)
            TEST_ASSERT_EQUAL_INT32(a->start[a->active[k]], b->start[a->active[k]]);
        if (a->order) TEST_ASSERT_EQUAL_INT32_ARRAY(a->order, b->order, N);
    }
}

static void test_a_domain_of_too_many_cells_is_refused(void)
{
    const double far[2] = {1e6, 1};
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, cells_create(&cells, &arena, lower, far, 0.004, 0.01, stray,
                                                  kinds, &diag));
    TEST_ASSERT_TRUE(diag.text[0]);
}

/* Any number of threads, up to the most there can be, and more threads than particles. */
static void test_threads_share_whole_cells(void)
{
    enum { POINTS = 600 };
    static uint64_t key[POINTS], alone[POINTS], pair[POINTS];
    scatter(false);
    uint64_t seed = 3;
    for (int k = 0; k < POINTS; k++) key[k] = (uint64_t)(4 * (noise(&seed) + 1));
    int n = 0;
    for (uint64_t cell = 0; cell < 8; cell++)
        for (int k = 0; k < POINTS; k++)
            if (key[k] == cell)
                pair[n++] = (cell ? cell : UINT32_MAX) << 32 | (uint32_t)(POINTS - 1 - k);
    memcpy(alone, pair, sizeof pair);
    static uint64_t given[POINTS];
    memcpy(given, pair, sizeof pair);
    cells_order(alone, POINTS, &kinds[KIND_FLUID], 1);
    TEST_ASSERT_TRUE(memcmp(alone, given, sizeof alone) != 0);
    for (int threads = 2; threads <= CELLS_SORT_THREADS; threads += threads < 8 ? 1 : 31) {
        memcpy(pair, given, sizeof pair);
        cells_order(pair, POINTS, &kinds[KIND_FLUID], threads);
        TEST_ASSERT_EQUAL_MEMORY(alone, pair, sizeof pair);
    }
    for (int size = 1; size < 4; size++) {
        memcpy(pair, given, sizeof pair);
        memcpy(alone, given, sizeof pair);
        cells_order(alone, size, &kinds[KIND_FLUID], 1);
        cells_order(pair, size, &kinds[KIND_FLUID], CELLS_SORT_THREADS);
        TEST_ASSERT_EQUAL_MEMORY(alone, pair, sizeof pair);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_cells_hold_squares_of_the_lattice);
    RUN_TEST(test_a_long_channel_is_sorted);
    RUN_TEST(test_no_pair_is_missed);
    RUN_TEST(test_clusters_of_a_lattice_are_squares);
    RUN_TEST(test_order_is_that_of_the_tree);
    RUN_TEST(test_clusters_are_compact);
    RUN_TEST(test_cells_cover_all_in_morton_order);
    RUN_TEST(test_lost_particles_come_last);
    RUN_TEST(test_order_does_not_depend_on_threads_or_history);
    RUN_TEST(test_resume_rebuilds_the_same_list);
    RUN_TEST(test_a_domain_of_too_many_cells_is_refused);
    RUN_TEST(test_threads_share_whole_cells);
    return UNITY_END();
}
