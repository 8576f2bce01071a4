/* SPDX-License-Identifier: MIT
 * The n-th call of HDF5 fails, for every n of the first snapshot of a run, and every seventh of the
 * second, a later one and a restart, in which each dataset takes the same dozen of calls. Either
 * the snapshot is complete all the same, or the failure is said; those before it stay, the next one
 * is written, and HDF5 holds nothing open. The linker puts these between the program and the
 * library:
 * --wrap: H5Fopen H5Fcreate H5Fclose H5Gcreate2 H5Gopen2 H5Acreate2 H5Aopen H5Aread H5Awrite
 * --wrap: H5Dcreate2 H5Dopen2 H5Dclose H5Dread H5Dwrite H5Dread_chunk H5Dwrite_chunk H5Dset_extent
 * --wrap: H5Dget_space H5Dget_create_plist H5Dget_type H5Dget_chunk_storage_size H5Lcreate_hard
 * --wrap: H5Pcreate H5Pset_chunk H5Pset_shuffle H5Pset_deflate H5Pget_chunk H5Pget_nfilters
 * --wrap: H5Pget_filter2 H5Tcopy H5Tset_size H5Screate H5Screate_simple H5Sselect_hyperslab
 * --wrap: H5Sget_simple_extent_dims malloc realloc */
#include "output/snapshot.h"
#include "geometry/scene_points.h"
#include "rig.h"
#include "tiny.h"
#include "unity.h"

#include <hdf5.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static long countdown = -1;
static bool hit;
static const char *which;

static bool fails(const char *name)
{
    if (countdown < 0 || countdown-- > 0) return false;
    which = name;
    return hit = true;
}

#define FAILS(type, name, parameters, arguments, failure) \
    type __real_##name parameters;                        \
    type __wrap_##name parameters;                        \
    type __wrap_##name parameters { return fails(#name) ? (failure) : __real_##name arguments; }
FAILS(hid_t, H5Fopen, (const char *a, unsigned b, hid_t c), (a, b, c), -1)
FAILS(hid_t, H5Fcreate, (const char *a, unsigned b, hid_t c, hid_t d), (a, b, c, d), -1)
FAILS(hid_t, H5Gcreate2, (hid_t a, const char *b, hid_t c, hid_t d, hid_t e), (a, b, c, d, e), -1)
FAILS(hid_t, H5Gopen2, (hid_t a, const char *b, hid_t c), (a, b, c), -1)
FAILS(hid_t, H5Acreate2, (hid_t a, const char *b, hid_t c, hid_t d, hid_t e, hid_t f),
      (a, b, c, d, e, f), -1)
FAILS(hid_t, H5Aopen, (hid_t a, const char *b, hid_t c), (a, b, c), -1)
FAILS(herr_t, H5Aread, (hid_t a, hid_t b, void *c), (a, b, c), -1)
FAILS(herr_t, H5Awrite, (hid_t a, hid_t b, const void *c), (a, b, c), -1)
FAILS(hid_t, H5Dcreate2, (hid_t a, const char *b, hid_t c, hid_t d, hid_t e, hid_t f, hid_t g),
      (a, b, c, d, e, f, g), -1)
FAILS(hid_t, H5Dopen2, (hid_t a, const char *b, hid_t c), (a, b, c), -1)
FAILS(herr_t, H5Dread, (hid_t a, hid_t b, hid_t c, hid_t d, hid_t e, void *f), (a, b, c, d, e, f),
      -1)
FAILS(herr_t, H5Dwrite, (hid_t a, hid_t b, hid_t c, hid_t d, hid_t e, const void *f),
      (a, b, c, d, e, f), -1)
FAILS(herr_t, H5Dread_chunk, (hid_t a, hid_t b, const hsize_t *c, uint32_t *d, void *e),
      (a, b, c, d, e), -1)
FAILS(herr_t, H5Dwrite_chunk,
      (hid_t a, hid_t b, uint32_t c, const hsize_t *d, size_t e, const void *f), (a, b, c, d, e, f),
      -1)
FAILS(herr_t, H5Dset_extent, (hid_t a, const hsize_t b[]), (a, b), -1)
FAILS(hid_t, H5Dget_space, (hid_t a), (a), -1)
FAILS(hid_t, H5Dget_create_plist, (hid_t a), (a), -1)
FAILS(hid_t, H5Dget_type, (hid_t a), (a), -1)
FAILS(herr_t, H5Dget_chunk_storage_size, (hid_t a, const hsize_t *b, hsize_t *c), (a, b, c), -1)
FAILS(herr_t, H5Lcreate_hard, (hid_t a, const char *b, hid_t c, const char *d, hid_t e, hid_t f),
      (a, b, c, d, e, f), -1)
FAILS(hid_t, H5Pcreate, (hid_t a), (a), -1)
FAILS(herr_t, H5Pset_chunk, (hid_t a, int b, const hsize_t c[]), (a, b, c), -1)
FAILS(herr_t, H5Pset_shuffle, (hid_t a), (a), -1)
FAILS(herr_t, H5Pset_deflate, (hid_t a, unsigned b), (a, b), -1)
FAILS(int, H5Pget_chunk, (hid_t a, int b, hsize_t c[]), (a, b, c), -1)
FAILS(int, H5Pget_nfilters, (hid_t a), (a), -1)
FAILS(H5Z_filter_t, H5Pget_filter2,
      (hid_t a, unsigned b, unsigned *c, size_t *d, unsigned e[], size_t f, char g[], unsigned *h),
      (a, b, c, d, e, f, g, h), -1)
FAILS(hid_t, H5Tcopy, (hid_t a), (a), -1)
FAILS(herr_t, H5Tset_size, (hid_t a, size_t b), (a, b), -1)
FAILS(hid_t, H5Screate, (H5S_class_t a), (a), -1)
FAILS(hid_t, H5Screate_simple, (int a, const hsize_t b[], const hsize_t c[]), (a, b, c), -1)
FAILS(herr_t, H5Sselect_hyperslab,
      (hid_t a, H5S_seloper_t b, const hsize_t c[], const hsize_t d[], const hsize_t e[],
       const hsize_t f[]),
      (a, b, c, d, e, f), -1)
FAILS(int, H5Sget_simple_extent_dims, (hid_t a, hsize_t b[], hsize_t c[]), (a, b, c), -1)
FAILS(void *, malloc, (size_t a), (a), NULL)
FAILS(void *, realloc, (void *a, size_t b), (a, b), NULL)
/* What is closed is closed even if HDF5 says that it could not write it. */
FAILS(herr_t, H5Fclose, (hid_t a), (a), (__real_H5Fclose(a), -1))
FAILS(herr_t, H5Dclose, (hid_t a), (a), (__real_H5Dclose(a), -1))

static struct diag diag;
static struct scene scene;
static struct simulation simulation;
static struct snapshots writer;
static char message[1280];

/* Integers as well as reals, one column and several, and a title. */
static const char *const sets[] = {"output.snapshot_fields=velocity"};

void setUp(void)
{
    diag = (struct diag){.code = ERR_OK};
    TEST_ASSERT_EQUAL_INT(ERR_OK, scene_load_text(&scene, tiny_case, "tiny.cfg", 1, sets, &diag));
    TEST_ASSERT_EQUAL_INT(ERR_OK, simulation_create(&simulation, &scene, &diag));
}

void tearDown(void)
{
    countdown = -1;
    snapshots_close(&writer);
    simulation_free(&simulation);
    scene_free(&scene);
}

static enum err write_one(double time)
{
    struct particles *const particles = &simulation.particles[KIND_FLUID];
    simulation.state.time = time;
    for (int64_t i = 0; i < particles->n; i++) {
        particles->x[i] = 0.001 * (double)i + 0.125 * time;
        particles->vy[i] = 0.25 * time;
        particles->id[i] = (int64_t)(8 * time) + i;
    }
    return snapshots_write(&writer, &simulation, &diag);
}

/* Reads all of a dataset, at most `most` items. */
static hsize_t read_all(const char *name, double *values, size_t most)
{
    const hid_t file = H5Fopen(writer.path, H5F_ACC_RDONLY, H5P_DEFAULT);
    TEST_ASSERT_TRUE_MESSAGE(file >= 0, message);
    const hid_t set = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(set);
    const hssize_t n = H5Sget_simple_extent_npoints(space);
    TEST_ASSERT_TRUE_MESSAGE(n >= 0 && (size_t)n <= most, message);
    TEST_ASSERT_TRUE_MESSAGE(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                                     values) >= 0,
                             message);
    H5Sclose(space);
    H5Dclose(set);
    H5Fclose(file);
    return (hsize_t)n;
}

static void text_is(const char *at, const char *name, const char *expected)
{
    char text[256] = "";
    const hid_t file = H5Fopen(writer.path, H5F_ACC_RDONLY, H5P_DEFAULT);
    const hid_t a = H5Aopen_by_name(file, at, name, H5P_DEFAULT, H5P_DEFAULT),
                type = H5Aget_type(a);
    TEST_ASSERT_TRUE_MESSAGE(H5Tget_size(type) < sizeof text && H5Aread(a, type, text) >= 0,
                             message);
    TEST_ASSERT_EQUAL_STRING_MESSAGE(expected, text, message);
    H5Tclose(type);
    H5Aclose(a);
    H5Fclose(file);
}

/* The file holds the snapshots of these times, complete. */
static void times_are(const double *expected, hsize_t n)
{
    static double value[4 * 3 * 2000];
    const int64_t fluid = simulation.particles[KIND_FLUID].n;
    TEST_ASSERT_EQUAL_UINT_MESSAGE(n, read_all("VTKHDF/Steps/Values", value, 8), message);
    for (hsize_t k = 0; k < n; k++) TEST_ASSERT_TRUE_MESSAGE(value[k] == expected[k], message);
    static const struct {
        const char *name;
        int width, column;
        double first, per_time, tolerance;
    } sought[] = {{"VTKHDF/Points", 3, 0, 0.001, 0.125, 1e-7},
                  {"VTKHDF/PointData/velocity", 3, 1, 0, 0.25, 0},
                  {"VTKHDF/PointData/id", 1, 0, 1, 8, 0}};
    for (size_t s = 0; s < COUNT_OF(sought); s++) {
        const hsize_t rows =
            read_all(sought[s].name, value, COUNT_OF(value)) / (hsize_t)sought[s].width;
        for (hsize_t k = 0; k < n; k++)
            for (int64_t i = 0; i < fluid; i++) {
                const hsize_t at = (rows / n * k + (hsize_t)i) * (hsize_t)sought[s].width;
                const double found = value[at + (hsize_t)sought[s].column];
                const double right = sought[s].first * (double)i + sought[s].per_time * expected[k];
                TEST_ASSERT_TRUE_MESSAGE(found >= right - sought[s].tolerance &&
                                             found <= right + sought[s].tolerance,
                                         message);
            }
    }
    text_is("VTKHDF", "Type", "UnstructuredGrid");
    text_is("sphfsi", "title", scene.top.title);
    text_is("sphfsi", "version", "1.2.3");
}

/* Drops all snapshots but the first. */
static enum err go_on(const char *folder)
{
    double last;
    return snapshots_resume(&writer, folder, &scene, "1.2.3", 0.5, &last, &diag);
}

/* With so many snapshots in the file, each call of the next one fails once, or each of a restart.
 */
static void calls_fail(hsize_t before, bool restart, int stride)
{
    static const double times[] = {0, 1, 2, 3};
    char folder[PATH_BYTES];
    long n = 0, tried = 0, said = 0;
    for (hit = true; hit; n += stride) {
        TEST_ASSERT_TRUE(n < 20000);
        snprintf(folder, sizeof folder, "%s", tiny_path("calls"));
        TEST_ASSERT_EQUAL_INT(0, mkdir(folder, 0777));
        TEST_ASSERT_EQUAL_INT(ERR_OK, snapshots_create(&writer, folder, &scene, "1.2.3", &diag));
        for (hsize_t k = 0; k < before; k++)
            TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, write_one(times[k]), diag.text);
        diag = (struct diag){.code = ERR_OK};
        if (restart) snapshots_close(&writer);
        hit = false;
        tried++;
        countdown = n;
        enum err e = restart ? go_on(folder) : write_one(times[before]);
        countdown = -1;
        snprintf(message, sizeof message, "%d before, call %ld (%s): %s", (int)before, n, which,
                 diag.text);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, H5Fget_obj_count((hid_t)H5F_OBJ_ALL, H5F_OBJ_ALL),
                                      message);
        TEST_ASSERT_TRUE_MESSAGE(hit || !e, message);
        said += e != ERR_OK;
        if (e) {
            TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, "fields.vtkhdf: "), message);
            if (before) times_are(times, before);
            diag = (struct diag){.code = ERR_OK};
            e = restart ? go_on(folder) : write_one(times[before]);
            TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, e, message);
        }
        times_are(times, restart ? 1 : before + 1);
        snapshots_close(&writer);
        tiny_remove(folder);
    }
    printf("%ld failing calls, %ld of them said\n", tried - 1, said);
    TEST_ASSERT_TRUE(said > tried / 2);
}

static void of_the_first_snapshot(void) { calls_fail(0, false, 1); }
static void of_the_second(void) { calls_fail(1, false, 7); }
static void of_a_later_one(void) { calls_fail(2, false, 7); }
static void of_a_restart(void) { calls_fail(3, true, 7); }

int main(void)
{
    if (!getenv("TMPDIR") && access("/dev/shm", W_OK) == 0) setenv("TMPDIR", "/dev/shm", 0);
    rig_one_thread();
    H5open();
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    UNITY_BEGIN();
    RUN_TEST(of_the_first_snapshot);
    RUN_TEST(of_the_second);
    RUN_TEST(of_a_later_one);
    RUN_TEST(of_a_restart);
    return UNITY_END();
}
