/* SPDX-License-Identifier: MIT
 * Chunks packed without HDF5 are what HDF5 reads; rows of points by any number of threads, in chunks that
 * snapshots share, and in files whose chunks are packed in another way. */
#include "output/snapshot_pack.h"

#include "output/snapshot_file.h"
#include "geometry/load.h"
#include "tiny.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>

enum { ROWS = 500 };

static hid_t file;
static int threads_before;

void setUp(void)
{
    const hid_t in_memory = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_fapl_core(in_memory, 1 << 16, false);
    file = H5Fcreate("memory", H5F_ACC_TRUNC, H5P_DEFAULT, in_memory);
    H5Pclose(in_memory);
    TEST_ASSERT_TRUE(file >= 0);
    threads_before = thread_count();
}

void tearDown(void)
{
    H5Fclose(file);
    thread_use(threads_before);
}

/* A dataset with chunks of ROWS rows and some columns. filters: s shuffle, d deflate, f a sum. */
static hid_t make_set(const char *name, hid_t type, const char *filters, hsize_t columns)
{
    const hsize_t size[2] = {ROWS, 2}, chunk[2] = {ROWS, columns};
    const hid_t how = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate_simple(2, size, NULL);
    H5Pset_chunk(how, 2, chunk);
    for (; *filters; filters++)
        (void)(*filters == 's'   ? H5Pset_shuffle(how)
               : *filters == 'd' ? H5Pset_deflate(how, 4)
                                 : H5Pset_fletcher32(how));
    const hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, how, H5P_DEFAULT);
    TEST_ASSERT_TRUE(set >= 0);
    H5Sclose(space);
    H5Pclose(how);
    return set;
}

static bool is_known(const char *name, hid_t type, const char *filters, hsize_t columns)
{
    const hid_t set = make_set(name, type, filters, columns);
    const bool known = packing_of(set, columns).known;
    H5Dclose(set);
    return known;
}

static void what_cannot_be_packed_is_known(void)
{
    TEST_ASSERT_TRUE(is_known("a", H5T_IEEE_F32LE, "sd", 1));
    TEST_ASSERT_TRUE(is_known("b", H5T_STD_I8LE, "", 1));
    TEST_ASSERT_FALSE(is_known("c", H5T_IEEE_F32LE, "sd", 2));
    TEST_ASSERT_FALSE(is_known("d", H5T_IEEE_F32LE, "ds", 1));
    TEST_ASSERT_FALSE(is_known("e", H5T_IEEE_F32LE, "sdf", 1));
    TEST_ASSERT_FALSE(is_known("f", H5T_IEEE_F32LE, "f", 1));
    TEST_ASSERT_FALSE(is_known("g", H5T_IEEE_F64BE, "sd", 1));
    TEST_ASSERT_FALSE(is_known("h", H5T_STD_I16LE, "sd", 1));
}

/* Values that end in nothing, as positions and indices do, or in noise: the latter would grow by packing. */
static void fill(bool real, bool noise, void *values)
{
    uint64_t bits = 88172645463325252u;
    for (int i = 0; i < ROWS; i++) {
        bits ^= bits << 13, bits ^= bits >> 7, bits ^= bits << 17;
        if (real)
            ((double *)values)[i] = noise ? 1e-300 * (double)bits * (double)bits : 0.25 * i;
        else
            ((int64_t *)values)[i] = noise ? (int64_t)bits : i / 4;
    }
}

static void a_chunk_comes_back(hid_t type, bool real, const char *filters, bool noise)
{
    static double values[ROWS], back[ROWS][2];
    static unsigned char room[ROWS * PACK_BYTES];
    const hid_t native = real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64;
    const hid_t set = make_set("x", type, filters, 1);
    const struct packing k = packing_of(set, 1);
    TEST_ASSERT_TRUE(k.known);
    for (hsize_t column = 0; column < 2; column++) {
        const hsize_t at[2] = {0, column};
        fill(real, noise, values);
        memcpy(room, values, sizeof values);
        const struct packed_chunk chunk = pack_chunk(&k, ROWS, room);
        TEST_ASSERT_NOT_NULL(chunk.bytes);
        TEST_ASSERT_TRUE(chunk.size <= ROWS * H5Tget_size(type));
        if (!noise) TEST_ASSERT_EQUAL_UINT(0, chunk.filters);
        TEST_ASSERT_TRUE(
            H5Dwrite_chunk(set, H5P_DEFAULT, chunk.filters, at, chunk.size, chunk.bytes) >= 0);
    }
    TEST_ASSERT_TRUE(H5Dread(set, native, H5S_ALL, H5S_ALL, H5P_DEFAULT, back) >= 0);
    for (int i = 0; i < ROWS; i++) {
        double expected = values[i];
        if (H5Tequal(type, H5T_NATIVE_FLOAT) > 0) expected = (double)(float)expected;
        for (int column = 0; column < 2; column++)
            TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&expected, &back[i][column], 8, filters);
    }
    H5Dclose(set);
    H5Ldelete(file, "x", H5P_DEFAULT);
}

static void chunks_come_back(void)
{
    static const char *const filters[] = {"", "s", "d", "sd"};
    for (int k = 0; k < 4; k++) {
        for (int noise = 0; noise < 2; noise++) {
            a_chunk_comes_back(H5T_NATIVE_DOUBLE, true, filters[k], noise);
            a_chunk_comes_back(H5T_NATIVE_FLOAT, true, filters[k], noise);
            a_chunk_comes_back(H5T_NATIVE_INT64, false, filters[k], noise);
        }
        a_chunk_comes_back(H5T_NATIVE_INT32, false, filters[k], false);
        a_chunk_comes_back(H5T_NATIVE_INT8, false, filters[k], false);
        a_chunk_comes_back(H5T_NATIVE_UINT8, false, filters[k], false);
    }
}

static void noise_is_not_deflated(void)
{
    static unsigned char room[ROWS * PACK_BYTES];
    const hid_t set = make_set("x", H5T_NATIVE_INT64, "sd", 1);
    const struct packing k = packing_of(set, 1);
    fill(false, true, room);
    const struct packed_chunk chunk = pack_chunk(&k, ROWS, room);
    TEST_ASSERT_EQUAL_UINT(2, chunk.filters); /* the second filter is left out */
    TEST_ASSERT_EQUAL_UINT(ROWS * 8, chunk.size);
    H5Dclose(set);
}

/* --- snapshots of made-up values --- */

static double real_of(int64_t row, int column, int step)
{
    return 0.125 * (double)(row * 7 + column + 1000 * step);
}
static int64_t whole_of(int64_t row, int step) { return (row + step) % 100; }

static void made_up(const void *context, enum data what, int column, int64_t first, int64_t n,
                    void *values)
{
    const int step = *(const int *)context;
    for (int64_t k = 0; k < n; k++) {
        const double real = real_of(first + k, column, step);
        const int64_t whole = whole_of(first + k, step);
        memcpy((char *)values + 8 * k, snapshot_file_real(what) ? (const void *)&real : &whole, 8);
    }
}

static const int64_t points[] = {150, 150, 143, 1, 90};

static void append_all(hid_t root, const struct snapshot_layout *layout)
{
    for (int step = 0; step < (int)COUNT_OF(points); step++)
        TEST_ASSERT_TRUE(snapshot_file_append_points(root, layout, points[step], made_up, &step));
}

static void all_is_there(const struct snapshot_layout *layout)
{
    static double values[6 * 600];
    for (int k = D_POINTS; k < D_COUNT; k++) {
        const int width = snapshot_file_width((enum data)k), extra = k == D_OFFSETS;
        int64_t total = 0, at = 0;
        if (!layout->has[k]) continue;
        for (int step = 0; step < (int)COUNT_OF(points); step++) total += points[step] + extra;
        TEST_ASSERT_TRUE(snapshot_file_first(file, (enum data)k, total, values));
        TEST_ASSERT_FALSE(snapshot_file_first(file, (enum data)k, total + 1, values));
        for (int step = 0; step < (int)COUNT_OF(points); step++)
            for (int64_t row = 0; row < points[step] + extra; row++)
                for (int column = 0; column < width; column++, at++) {
                    const double real = real_of(row, column, step);
                    const int64_t whole = whole_of(row, step);
                    TEST_ASSERT_EQUAL_MEMORY(snapshot_file_real((enum data)k) ? (const void *)&real
                                                                              : &whole,
                                             &values[at], 8);
                }
    }
}

static void snapshots_come_back(const char *compression, int threads)
{
    struct diag diag = {.code = ERR_OK};
    struct scene scene;
    TEST_ASSERT_EQUAL_INT(ERR_OK,
                          scene_load_text(&scene, tiny_case, "tiny.cfg", 1, &compression, &diag));
    thread_use(threads);
    /* Chunks for 60 points: of 64 rows, so that snapshots share them and have several. */
    TEST_ASSERT_TRUE(snapshot_file_create(file, &scene, "1.2.3", 60, -1));
    const struct snapshot_layout layout = snapshot_file_layout(&scene);
    const hid_t root = H5Gopen2(file, "VTKHDF", H5P_DEFAULT);
    append_all(root, &layout);
    H5Gclose(root);
    all_is_there(&layout);
    scene_free(&scene);
}

static void snapshots_come_back_from_one_thread(void)
{
    snapshots_come_back("output.snapshot_compression=2", 1);
}
static void snapshots_come_back_from_three(void)
{
    snapshots_come_back("output.snapshot_compression=2", 3);
}
static void snapshots_come_back_unpacked(void)
{
    snapshots_come_back("output.snapshot_compression=0", 2);
}

/* Someone has packed a file anew, in chunks of whole rows and with sums of its own. */
static void files_packed_otherwise_go_on(void)
{
    struct diag diag = {.code = ERR_OK};
    struct scene scene;
    TEST_ASSERT_EQUAL_INT(ERR_OK, scene_load_text(&scene, tiny_case, "tiny.cfg", 0, NULL, &diag));
    TEST_ASSERT_TRUE(snapshot_file_create(file, &scene, "1.2.3", 60, -1));
    const struct snapshot_layout layout = snapshot_file_layout(&scene);
    const hid_t root = H5Gopen2(file, "VTKHDF", H5P_DEFAULT);
    const hsize_t size[2] = {0, 3}, most[2] = {H5S_UNLIMITED, 3}, chunk[2] = {64, 3};
    const hid_t how = H5Pcreate(H5P_DATASET_CREATE), space = H5Screate_simple(2, size, most);
    H5Pset_chunk(how, 2, chunk);
    H5Pset_fletcher32(how);
    H5Ldelete(root, "PointData/velocity", H5P_DEFAULT);
    H5Dclose(H5Dcreate2(root, "PointData/velocity", H5T_IEEE_F32LE, space, H5P_DEFAULT, how,
                        H5P_DEFAULT));
    append_all(root, &layout);
    H5Sclose(space);
    H5Pclose(how);
    H5Gclose(root);
    all_is_there(&layout);
    scene_free(&scene);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_cannot_be_packed_is_known);
    RUN_TEST(chunks_come_back);
    RUN_TEST(noise_is_not_deflated);
    RUN_TEST(snapshots_come_back_from_one_thread);
    RUN_TEST(snapshots_come_back_from_three);
    RUN_TEST(snapshots_come_back_unpacked);
    RUN_TEST(files_packed_otherwise_go_on);
    return UNITY_END();
}
