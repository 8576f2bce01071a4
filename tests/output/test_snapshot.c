/* SPDX-License-Identifier: MIT
 * Snapshots: appended, dropped by a restart, kept when the copy in the making is damaged, held open
 * or cannot be written. Other readers of the file: test_snapshot_reader.py. */
#include "output/snapshot.h"
#include "output/point_data.h"
#include "geometry/scene_points.h"
#include "tiny.h"
#include "unity.h"

#include <hdf5.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static struct diag diag;
static struct scene scene;
static struct simulation simulation;
static struct snapshots writer;

/* HDF5 numbers identifiers of a kind in order: those between two of our own are the library's
 * user's. */
static hid_t next_number(bool of_list)
{
    const hid_t id = of_list ? H5Pcreate(H5P_DATASET_CREATE) : H5Screate(H5S_SCALAR);
    TEST_ASSERT_TRUE(id >= 0);
    if (of_list)
        H5Pclose(id);
    else
        H5Sclose(id);
    return id;
}

static hid_t first[2]; /* spaces, property lists */

/* Files, datasets, groups, types, attributes, and the spaces and property lists since setUp, that
 * HDF5 holds open. */
static int held(void)
{
    int n = (int)H5Fget_obj_count((hid_t)H5F_OBJ_ALL, H5F_OBJ_ALL);
    for (int k = 0; k < 2; k++)
        for (hid_t id = first[k] + 1, end = next_number(k == 1); id < end; id++)
            n += H5Iis_valid(id) > 0;
    return n;
}

static int held_before;

void setUp(void)
{
    for (int k = 0; k < 2; k++) first[k] = next_number(k == 1);
    held_before = held();
    diag = (struct diag){.code = ERR_OK};
    TEST_ASSERT_EQUAL_INT(ERR_OK, scene_load_text(&scene, tiny_case, "tiny.cfg", 0, NULL, &diag));
    TEST_ASSERT_EQUAL_INT(ERR_OK, simulation_create(&simulation, &scene, &diag));
}

void tearDown(void)
{
    snapshots_close(&writer);
    simulation_free(&simulation);
    scene_free(&scene);
    TEST_ASSERT_EQUAL_INT_MESSAGE(held_before, held(), "HDF5 holds something open");
}

static void begin(const char *folder)
{
    mkdir(folder, 0777);
    TEST_ASSERT_EQUAL_INT(ERR_OK, snapshots_create(&writer, folder, &scene, "1.2.3", &diag));
}

static void write_one(double time)
{
    simulation.state.time = time;
    simulation.particles[KIND_FLUID].x[0] = time;
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, snapshots_write(&writer, &simulation, &diag), diag.text);
}

/* Reads a whole dataset of doubles; returns its items. */
static hsize_t read_all(const char *name, double *values, size_t room)
{
    const hid_t file = H5Fopen(writer.path, H5F_ACC_RDONLY, H5P_DEFAULT);
    TEST_ASSERT_TRUE(file >= 0);
    const hid_t set = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(set);
    const hssize_t n = H5Sget_simple_extent_npoints(space);
    TEST_ASSERT_TRUE(n >= 0 && (size_t)n <= room);
    TEST_ASSERT_TRUE(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    H5Sclose(space);
    H5Dclose(set);
    H5Fclose(file);
    return (hsize_t)n;
}

/* The times are those, and each snapshot has its own position of its first particle. */
static void times_are(const double *expected, hsize_t n)
{
    static double times[16], x[16 * 3 * 1000];
    TEST_ASSERT_EQUAL_UINT(n, read_all("VTKHDF/Steps/Values", times, 16));
    const hsize_t items = read_all("VTKHDF/Points", x, COUNT_OF(x));
    for (hsize_t k = 0; k < n; k++) {
        TEST_ASSERT_TRUE(times[k] == expected[k]);
        TEST_ASSERT_TRUE(x[items / n * k] == expected[k]);
    }
}

static void snapshots_are_appended(void)
{
    begin(tiny_path("append"));
    for (int k = 0; k < 4; k++) write_one(0.5 * k);
    times_are((double[]){0, 0.5, 1, 1.5}, 4);
    snapshots_close(&writer);
    TEST_ASSERT_NOT_EQUAL(0, access(writer.spare, F_OK));
    struct stat info;
    stat(writer.path, &info);
    TEST_ASSERT_TRUE_MESSAGE(info.st_size < 200000, "claimed space was not given back");
}

static void a_restart_drops_later_ones(void)
{
    double last;
    begin(tiny_path("resume"));
    for (int k = 0; k < 4; k++) write_one(k);
    TEST_ASSERT_EQUAL_INT(ERR_OK, snapshots_resume(&writer, tiny_path("resume"), &scene, "1.2.3",
                                                   1.5, &last, &diag));
    TEST_ASSERT_TRUE(last == 1);
    times_are((double[]){0, 1}, 2);
    write_one(1.75);
    write_one(3.5);
    times_are((double[]){0, 1, 1.75, 3.5}, 4);
}

static void a_restart_without_the_file_begins_anew(void)
{
    double last;
    mkdir(tiny_path("gone"), 0777);
    TEST_ASSERT_EQUAL_INT(ERR_OK, snapshots_resume(&writer, tiny_path("gone"), &scene, "1.2.3", 9,
                                                   &last, &diag));
    TEST_ASSERT_TRUE(last == -1);
    write_one(9);
    times_are((double[]){9}, 1);
}

static void a_damaged_file_is_not_continued(void)
{
    double last;
    begin(tiny_path("damaged"));
    write_one(0);
    TEST_ASSERT_EQUAL_INT(0, truncate(writer.path, 3000));
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, snapshots_resume(&writer, tiny_path("damaged"), &scene,
                                                      "1.2.3", 9, &last, &diag));
    TEST_ASSERT_NOT_NULL(strstr(diag.text, "fields.vtkhdf"));
}

static void a_damaged_copy_is_made_anew(void)
{
    begin(tiny_path("spare"));
    for (int k = 0; k < 3; k++) {
        write_one(k);
        if (k > 0) TEST_ASSERT_EQUAL_INT(0, truncate(writer.spare, 100 + 3000 * k));
    }
    write_one(3);
    times_are((double[]){0, 1, 2, 3}, 4);
}

/* A viewer keeps the file open over two snapshots: its file becomes the copy in the making. */
static void an_open_reader_does_no_harm(void)
{
    begin(tiny_path("reader"));
    write_one(0);
    write_one(1);
    const hid_t viewer = H5Fopen(writer.path, H5F_ACC_RDONLY, H5P_DEFAULT);
    TEST_ASSERT_TRUE(viewer >= 0);
    for (int k = 2; k < 5; k++) write_one(k);
    H5Fclose(viewer);
    times_are((double[]){0, 1, 2, 3, 4}, 5);
}

static void what_cannot_be_written_is_named(void)
{
    begin(tiny_path("lost"));
    rmdir(tiny_path("lost"));
    TEST_ASSERT_EQUAL_INT(ERR_IO, snapshots_write(&writer, &simulation, &diag));
    TEST_ASSERT_NOT_NULL(strstr(diag.text, "lost/fields.vtkhdf"));
}

static void a_place_that_is_taken_is_named(void)
{
    begin(tiny_path("taken"));
    mkdir(writer.path, 0777);
    mkdir(tiny_path("taken/fields.vtkhdf/kept"), 0777);
    TEST_ASSERT_EQUAL_INT(ERR_IO, snapshots_write(&writer, &simulation, &diag));
    TEST_ASSERT_NOT_NULL(strstr(diag.text, "taken/fields.vtkhdf"));
    diag.code = ERR_OK;
}

static void fewer_particles_are_fewer_points(void)
{
    static double counts[4];
    begin(tiny_path("fewer"));
    write_one(0);
    simulation.particles[KIND_FLUID].n -= 7;
    TEST_ASSERT_EQUAL_INT(ERR_OK, snapshots_write(&writer, &simulation, &diag));
    TEST_ASSERT_EQUAL_UINT(2, read_all("VTKHDF/NumberOfPoints", counts, 4));
    TEST_ASSERT_TRUE(counts[0] - counts[1] == 7);
}

/* Whether a dataset is in the file, and the bytes of one of its items. */
static size_t item_bytes(const char *name)
{
    const hid_t file = H5Fopen(writer.path, H5F_ACC_RDONLY, H5P_DEFAULT);
    size_t bytes = 0;
    if (H5Lexists(file, name, H5P_DEFAULT) > 0) {
        const hid_t set = H5Dopen2(file, name, H5P_DEFAULT), type = H5Dget_type(set);
        bytes = H5Tget_size(type);
        H5Tclose(type);
        H5Dclose(set);
    }
    H5Fclose(file);
    return bytes;
}

static void open_with(const char *const *sets, int n)
{
    tearDown();
    diag = (struct diag){.code = ERR_OK};
    TEST_ASSERT_EQUAL_INT(ERR_OK, scene_load_text(&scene, tiny_case, "tiny.cfg", n, sets, &diag));
    TEST_ASSERT_EQUAL_INT(ERR_OK, simulation_create(&simulation, &scene, &diag));
}

static void fields_and_precision_are_chosen(void)
{
    static const char *const sets[] = {"output.snapshot_fields=velocity stress",
                                       "output.snapshot_precision=double",
                                       "output.snapshot_compression=0"};
    static double v[3 * 3000];
    double last;
    open_with(sets, 3);
    begin(tiny_path("chosen"));
    simulation.particles[KIND_FLUID].vx[0] = 1.0 / 3;
    for (int k = 0; k < 3; k++) write_one(k);
    TEST_ASSERT_EQUAL_INT(ERR_OK, snapshots_resume(&writer, tiny_path("chosen"), &scene, "1.2.3", 1,
                                                   &last, &diag));
    write_one(16.0 / 3);
    times_are((double[]){0, 1, 16.0 / 3}, 3);
    TEST_ASSERT_EQUAL_UINT(8, item_bytes("VTKHDF/PointData/velocity"));
    TEST_ASSERT_EQUAL_UINT(8, item_bytes("VTKHDF/PointData/stress"));
    TEST_ASSERT_EQUAL_UINT(8, item_bytes("VTKHDF/PointData/id"));
    TEST_ASSERT_EQUAL_UINT(0, item_bytes("VTKHDF/PointData/pressure"));
    TEST_ASSERT_EQUAL_UINT(0, item_bytes("VTKHDF/Steps/PointDataOffsets/pressure"));
    read_all("VTKHDF/PointData/velocity", v, COUNT_OF(v));
    TEST_ASSERT_TRUE(v[0] == 1.0 / 3);
    /* Positions 24, Connectivity 8, Offsets 8, Types 1, velocity 24, stress 48, kind 1, id 8, body
     * 4 */
    TEST_ASSERT_EQUAL_INT(126, (int)snapshot_file_point_bytes(&writer.layout));
}

static void positions_are_rounded_beside_single_precision(void)
{
    static double points[3 * 1000];
    const double x = 1.0 / 3;
    begin(tiny_path("rounded"));
    write_one(x);
    read_all("VTKHDF/Points", points, COUNT_OF(points));
    TEST_ASSERT_DOUBLE_WITHIN(ldexp(scene.top.dp, -21), x, points[0]);
    const double units = ldexp(points[0], 20 - ilogb(scene.top.dp));
    TEST_ASSERT_TRUE_MESSAGE(points[0] != x && units == nearbyint(units), "not rounded");
}

static void everything_in_single_precision_unless_chosen(void)
{
    begin(tiny_path("all"));
    write_one(0);
    TEST_ASSERT_EQUAL_UINT(4, item_bytes("VTKHDF/PointData/velocity"));
    TEST_ASSERT_EQUAL_UINT(4, item_bytes("VTKHDF/PointData/det_F"));
    TEST_ASSERT_EQUAL_UINT(8, item_bytes("VTKHDF/Points"));
}

/* rho0/det F, with stretches of 1.1 and 0.95. */
static void density_of_a_stretched_solid(void)
{
    struct particles *const particles = &simulation.particles[KIND_SOLID];
    for (int64_t i = 0; i < particles->n; i++) {
        particles->ux[i] = 0.1 * particles->X[i];
        particles->uy[i] = -0.05 * particles->Y[i];
    }
    solid_stress(&simulation.solid, particles);
    for (int64_t i = 0; i < particles->n; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.1 * 0.95,
                                  snapshot_value(D_DET_F, &simulation, KIND_SOLID, i, 0));
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, scene.solid[0].density / (1.1 * 0.95),
                                  snapshot_value(D_DENSITY, &simulation, KIND_SOLID, i, 0));
    }
}

int main(void)
{
    H5open();
    UNITY_BEGIN();
    RUN_TEST(density_of_a_stretched_solid);
    RUN_TEST(snapshots_are_appended);
    RUN_TEST(a_restart_drops_later_ones);
    RUN_TEST(a_restart_without_the_file_begins_anew);
    RUN_TEST(a_damaged_file_is_not_continued);
    RUN_TEST(a_damaged_copy_is_made_anew);
    RUN_TEST(an_open_reader_does_no_harm);
    RUN_TEST(what_cannot_be_written_is_named);
    RUN_TEST(a_place_that_is_taken_is_named);
    RUN_TEST(fewer_particles_are_fewer_points);
    RUN_TEST(fields_and_precision_are_chosen);
    RUN_TEST(positions_are_rounded_beside_single_precision);
    RUN_TEST(everything_in_single_precision_unless_chosen);
    return UNITY_END();
}
