/* SPDX-License-Identifier: MIT */
#include "output/snapshot_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Rows that a snapshot of n points adds to a dataset: 1, n, n + 1. */
enum growth { BY_STEP, BY_POINT, BY_POINT_AND_ONE };

enum item { F64, REAL, I64, I32, I8, U8 }; /* REAL: float32 or float64 */

/* The datasets below /VTKHDF. In memory their values are double (floating types) or int64; HDF5
 * converts. */
static const struct column {
    const char *name;
    enum growth growth;
    enum item item;
    int width;
} columns[D_COUNT] = {
    [D_POINTS_COUNT] = {"NumberOfPoints", BY_STEP, I64, 1},
    [D_CELLS_COUNT] = {"NumberOfCells", BY_STEP, I64, 1},
    [D_IDS_COUNT] = {"NumberOfConnectivityIds", BY_STEP, I64, 1},
    [D_TIME] = {"Steps/Values", BY_STEP, F64, 1},
    [D_PARTS_BEFORE] = {"Steps/PartOffsets", BY_STEP, I64, 1},
    [D_PARTS] = {"Steps/NumberOfParts", BY_STEP, I64, 1},
    [D_POINTS_BEFORE] = {"Steps/PointOffsets", BY_STEP, I64, 1},
    [D_CELLS_BEFORE] = {"Steps/CellOffsets", BY_STEP, I64, 1},
    [D_IDS_BEFORE] = {"Steps/ConnectivityIdOffsets", BY_STEP, I64, 1},
    [D_POINTS] = {"Points", BY_POINT, F64, 3},
    [D_CONNECTIVITY] = {"Connectivity", BY_POINT, I64, 1},
    [D_OFFSETS] = {"Offsets", BY_POINT_AND_ONE, I64, 1},
    [D_TYPES] = {"Types", BY_POINT, U8, 1},
#define POINTDATA(NAME, name, item, width, choice) \
    [D_##NAME] = {"PointData/" #name, BY_POINT, item, width},
#include "case/pointdata.def"
};

enum {
    STEP_CHUNK = 128,
    POINT_CHUNK_LEAST = 64,
    POINT_CHUNK_MOST = 1 << 17,
    METADATA_BYTES = 1 << 18 /* more than headers and chunk indices grow by with a snapshot */
};

static hid_t file_type(enum item item, bool doubles)
{
    switch (item) {
    case F64: return H5T_IEEE_F64LE;
    case REAL: return doubles ? H5T_IEEE_F64LE : H5T_IEEE_F32LE;
    case I64: return H5T_STD_I64LE;
    case I32: return H5T_STD_I32LE;
    case I8: return H5T_STD_I8LE;
    case U8: break;
    }
    return H5T_STD_U8LE;
}

static bool is_real(enum item item) { return item == F64 || item == REAL; }

static hid_t memory_type(const struct column *c)
{
    return is_real(c->item) ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64;
}

struct snapshot_layout snapshot_file_layout(const struct scene *scene)
{
    struct snapshot_layout layout = {.doubles = scene->output.snapshot_precision ==
                                                SNAPSHOT_PRECISION_DOUBLE,
                                     .deflate = H5Zfilter_avail(H5Z_FILTER_DEFLATE) > 0
                                                    ? (unsigned)scene->output.snapshot_compression
                                                    : 0};
    for (int k = 0; k < D_COUNT; k++) layout.has[k] = true;
#define POINTDATA(NAME, name, item, width, choice) \
    layout.has[D_##NAME] = !(choice) || scene_snapshot_has(scene, #name);
#include "case/pointdata.def"
    return layout;
}

/* --- one dataset --- */

/* Rows of a chunk: those of a snapshot, or of one of its equal parts if it exceeds
 * POINT_CHUNK_MOST. Chunks that two snapshots share would be compressed twice, so a number of parts
 * that divides the rows is sought.
 */
static int64_t chunk_rows(const struct column *c, int64_t n)
{
    if (c->growth == BY_STEP) return STEP_CHUNK;
    const int64_t rows = n + (c->growth == BY_POINT_AND_ONE);
    const int64_t least = (rows + POINT_CHUNK_MOST - 1) / POINT_CHUNK_MOST;
    if (rows < POINT_CHUNK_LEAST) return POINT_CHUNK_LEAST;
    for (int64_t parts = least; parts <= 4 * least; parts++)
        if (rows % parts == 0) return rows / parts;
    return (rows + least - 1) / least;
}

/* Rows and columns of the chunks of an open dataset. */
static bool size_of_chunk(hid_t set, hsize_t size[2])
{
    size[0] = size[1] = 1;
    const hid_t how = H5Dget_create_plist(set);
    const bool ok = how >= 0 && H5Pget_chunk(how, 2, size) > 0;
    if (how >= 0) H5Pclose(how);
    return ok;
}

/* Creation properties of a dataset for snapshots of about n points. Each component has its own
 * chunks, since values of one component compress better than interleaved ones. */
static hid_t layout_of(const struct snapshot_layout *layout, const struct column *c, int64_t n)
{
    const hsize_t chunk[2] = {(hsize_t)chunk_rows(c, n), 1};
    const hid_t how = H5Pcreate(H5P_DATASET_CREATE);
    if (how >= 0) H5Pset_chunk(how, c->width > 1 ? 2 : 1, chunk);
    if (how >= 0 && c->growth != BY_STEP && layout->deflate > 0) {
        H5Pset_shuffle(how);
        H5Pset_deflate(how, layout->deflate);
    }
    return how;
}

/* Creation properties of the dataset in another file, including filters, so that compressed chunks
 * can be copied. Negative: no such file. */
static hid_t layout_in(hid_t file, const struct column *c)
{
    char name[96];
    snprintf(name, sizeof name, "VTKHDF/%s", c->name);
    const hid_t set = file >= 0 ? H5Dopen2(file, name, H5P_DEFAULT) : -1;
    const hid_t how = set >= 0 ? H5Dget_create_plist(set) : -1;
    if (set >= 0) H5Dclose(set);
    return how;
}

/* Creates a dataset and closes `how`. */
static bool create_dataset(hid_t root, const struct snapshot_layout *layout, const struct column *c,
                           hid_t how)
{
    const hsize_t width = (hsize_t)c->width;
    const hsize_t size[2] = {0, width}, most[2] = {H5S_UNLIMITED, width};
    const hid_t space = H5Screate_simple(c->width > 1 ? 2 : 1, size, most);
    const hid_t set = space >= 0 && how >= 0
                          ? H5Dcreate2(root, c->name, file_type(c->item, layout->doubles), space,
                                       H5P_DEFAULT, how, H5P_DEFAULT)
                          : -1;
    if (how >= 0) H5Pclose(how);
    H5Sclose(space);
    return set >= 0 && H5Dclose(set) >= 0;
}

static int64_t count_rows(hid_t set)
{
    hsize_t size[2] = {0, 0};
    const hid_t space = H5Dget_space(set);
    const bool ok = space >= 0 && H5Sget_simple_extent_dims(space, size, NULL) >= 0;
    H5Sclose(space);
    return ok ? (int64_t)size[0] : -1;
}

/* A rectangle of a dataset: rows and columns. */
struct block {
    int64_t row, rows;
    int column, columns;
};

/* Reads or writes a block of an open dataset of a column. */
static bool move_block(hid_t set, const struct column *c, struct block b, hid_t type, void *values,
                       bool write)
{
    if (b.rows == 0) return true;
    const int rank = c->width > 1 ? 2 : 1;
    const hsize_t at[2] = {(hsize_t)b.row, (hsize_t)b.column};
    const hsize_t size[2] = {(hsize_t)b.rows, (hsize_t)b.columns};
    const hid_t in_file = H5Dget_space(set), in_memory = H5Screate_simple(rank, size, NULL);
    bool ok = in_file >= 0 && in_memory >= 0 &&
              H5Sselect_hyperslab(in_file, H5S_SELECT_SET, at, NULL, size, NULL) >= 0;
    if (ok && write)
        ok = H5Dwrite(set, type, in_memory, in_file, H5P_DEFAULT, values) >= 0;
    else if (ok)
        ok = H5Dread(set, type, in_memory, in_file, H5P_DEFAULT, values) >= 0;
    H5Sclose(in_memory);
    H5Sclose(in_file);
    return ok;
}

/* Extends a dataset by n rows; returns the first of them, or a negative number. */
static int64_t add_rows(hid_t set, const struct column *c, int64_t n)
{
    const int64_t first = count_rows(set);
    const hsize_t size[2] = {(hsize_t)(first + n), (hsize_t)c->width};
    return first >= 0 && H5Dset_extent(set, size) >= 0 ? first : -1;
}

bool snapshot_file_append(hid_t root, enum data what, void *value)
{
    const struct column *const c = &columns[what];
    const hid_t set = H5Dopen2(root, c->name, H5P_DEFAULT);
    const int64_t first = set >= 0 ? add_rows(set, c, 1) : -1;
    const bool ok = first >= 0 &&
                    move_block(set, c, (struct block){first, 1, 0, 1}, memory_type(c), value, true);
    return (set < 0 || H5Dclose(set) >= 0) && ok;
}

/* --- rows of points --- */

/* Converts values in place to their type in the file; HDF5 would allocate and clear a buffer for
 * each column. An item is not larger than its value in memory. */
static void narrow(char *values, int64_t n, enum item item, bool doubles)
{
    for (int64_t i = 0; i < n; i++) {
        double real;
        int64_t integer;
        memcpy(&real, values + i * (int64_t)sizeof real, sizeof real);
        memcpy(&integer, values + i * (int64_t)sizeof integer, sizeof integer);
        const float single = (float)real;
        const int32_t wide = (int32_t)integer;
        if (item == REAL && !doubles)
            memcpy(values + i * (int64_t)sizeof single, &single, sizeof single);
        else if (item == I32)
            memcpy(values + i * (int64_t)sizeof wide, &wide, sizeof wide);
        else if (item == I8 || item == U8)
            values[i] = (char)integer;
    }
}

/* Appends n rows to a dataset, one column at a time, in which HDF5 compresses them. */
static bool append_rows(hid_t root, const struct snapshot_layout *layout, enum data what, int64_t n,
                        snapshot_values *values_of, const void *context, void *values)
{
    const struct column *const c = &columns[what];
    const hid_t set = layout->has[what] ? H5Dopen2(root, c->name, H5P_DEFAULT) : -1;
    if (set < 0) return !layout->has[what];
    const int64_t first = add_rows(set, c, n);
    bool ok = first >= 0;
    for (int column = 0; ok && column < c->width; column++) {
        values_of(context, what, column, n, values);
        narrow(values, n, c->item, layout->doubles);
        ok = move_block(set, c, (struct block){first, n, column, 1},
                        file_type(c->item, layout->doubles), values, true);
    }
    return H5Dclose(set) >= 0 && ok;
}

bool snapshot_file_append_points(hid_t root, const struct snapshot_layout *layout, int64_t n,
                                 snapshot_values *values_of, const void *context)
{
    void *const values = malloc((size_t)(n + 1) * sizeof(double));
    bool ok = values != NULL;
    for (int k = D_POINTS; ok && k < D_COUNT; k++)
        ok = append_rows(root, layout, (enum data)k, n + (columns[k].growth == BY_POINT_AND_ONE),
                         values_of, context, values);
    free(values);
    return ok;
}

/* --- a whole file --- */

static bool put_text(hid_t at, const char *name, const char *text)
{
    const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    const bool sized = H5Tset_size(type, text[0] ? strlen(text) : 1) >= 0;
    const hid_t a = sized ? H5Acreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT) : -1;
    const bool ok = a >= 0 && H5Awrite(a, type, text) >= 0;
    H5Aclose(a);
    H5Sclose(space);
    H5Tclose(type);
    return ok;
}

static bool put_numbers(hid_t at, const char *name, enum item item, const void *values, int n)
{
    const hsize_t size = (hsize_t)n;
    const hid_t space = n > 1 ? H5Screate_simple(1, &size, NULL) : H5Screate(H5S_SCALAR);
    const hid_t a = H5Acreate2(at, name, file_type(item, true), space, H5P_DEFAULT, H5P_DEFAULT);
    const bool ok =
        a >= 0 && H5Awrite(a, item == F64 ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64, values) >= 0;
    H5Aclose(a);
    H5Sclose(space);
    return ok;
}

/* Attributes outside the VTKHDF layout, in the group /sphfsi, which VTK ignores. */
static bool put_case(hid_t file, const struct scene *scene, const char *version)
{
    const hid_t group = H5Gcreate2(file, "sphfsi", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const bool ok = group >= 0 && put_text(group, "title", scene->top.title) &&
                    put_text(group, "version", version) &&
                    put_text(group, "kinds", "0 fluid, 1 wall, 2 solid") &&
                    put_text(group, "stress", "Cauchy: xx yy zz xy yz xz, Pa") &&
                    put_numbers(group, "dp", F64, &scene->top.dp, 1) &&
                    put_numbers(group, "h", F64, &scene->h, 1) &&
                    put_numbers(group, "c0", F64, &scene->c0, 1);
    H5Gclose(group);
    return ok;
}

bool snapshot_file_create(hid_t file, const struct scene *scene, const char *program, int64_t n,
                          hid_t like)
{
    static const char *const groups[] = {"Steps", "PointData", "Steps/PointDataOffsets"};
    const int64_t version[2] = {2, 0}, none = 0;
    const hid_t root = H5Gcreate2(file, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    bool ok = root >= 0 && put_numbers(root, "Version", I64, version, 2) &&
              put_text(root, "Type", "UnstructuredGrid") && put_case(file, scene, program);
    for (size_t k = 0; ok && k < COUNT_OF(groups); k++) {
        const hid_t group = H5Gcreate2(root, groups[k], H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        ok = group >= 0 && (k > 0 || put_numbers(group, "NSteps", I64, &none, 1));
        H5Gclose(group);
    }
    const struct snapshot_layout layout = snapshot_file_layout(scene);
    for (int k = 0; ok && k < D_COUNT; k++) {
        if (!layout.has[k]) continue;
        const hid_t how = layout_in(like, &columns[k]);
        ok = create_dataset(root, &layout, &columns[k],
                            how >= 0 ? how : layout_of(&layout, &columns[k], n));
    }
    /* All arrays of points have the same offsets: hard links to one dataset. */
    for (int k = D_FIRST_POINTDATA; ok && k < D_COUNT; k++) {
        char link[64];
        if (!layout.has[k]) continue;
        snprintf(link, sizeof link, "Steps/PointDataOffsets/%s", strchr(columns[k].name, '/') + 1);
        ok = H5Lcreate_hard(root, columns[D_POINTS_BEFORE].name, root, link, H5P_DEFAULT,
                            H5P_DEFAULT) >= 0;
    }
    H5Gclose(root);
    return ok;
}

/* Reads or writes the number of snapshots. */
static bool move_steps(hid_t file, int64_t *n, bool write)
{
    const hid_t group = H5Gopen2(file, "VTKHDF/Steps", H5P_DEFAULT);
    const hid_t a = group >= 0 ? H5Aopen(group, "NSteps", H5P_DEFAULT) : -1;
    const bool ok =
        a >= 0 && (write ? H5Awrite(a, H5T_NATIVE_INT64, n) : H5Aread(a, H5T_NATIVE_INT64, n)) >= 0;
    if (a >= 0) H5Aclose(a);
    if (group >= 0) H5Gclose(group);
    return ok;
}

int64_t snapshot_file_steps(hid_t file)
{
    int64_t n = -1;
    return move_steps(file, &n, false) ? n : -1;
}

bool snapshot_file_set_steps(hid_t file, int64_t n) { return move_steps(file, &n, true); }

bool snapshot_file_first(hid_t file, enum data what, int64_t n, void *values)
{
    char name[96];
    snprintf(name, sizeof name, "VTKHDF/%s", columns[what].name);
    const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    const bool ok = set >= 0 && count_rows(set) >= n &&
                    move_block(set, &columns[what], (struct block){0, n, 0, columns[what].width},
                               memory_type(&columns[what]), values, false);
    H5Dclose(set);
    return ok;
}

/* --- copying snapshots --- */

bool snapshot_file_rows(hid_t file, int64_t steps, int64_t rows[D_COUNT])
{
    int64_t points = 0;
    int64_t *n = malloc((size_t)(steps + 1) * sizeof *n);
    const bool ok = n && snapshot_file_first(file, D_POINTS_COUNT, steps, n);
    for (int64_t k = 0; ok && k < steps; k++) points += n[k];
    free(n);
    for (int k = 0; k < D_COUNT; k++)
        rows[k] = columns[k].growth == BY_STEP
                      ? steps
                      : points + (columns[k].growth == BY_POINT_AND_ONE ? steps : 0);
    return ok;
}

struct chunk_buffer {
    void *bytes;
    size_t size;
};

/* Copies the chunk that begins at a row and a column, compressed as it is. */
static bool copy_chunk(hid_t source, hid_t target, hsize_t row, hsize_t column,
                       struct chunk_buffer *b)
{
    const hsize_t at[2] = {row, column};
    hsize_t bytes = 0;
    uint32_t filters = 0;
    if (H5Dget_chunk_storage_size(source, at, &bytes) < 0) return false;
    if (bytes > b->size) {
        void *const more = realloc(b->bytes, bytes);
        if (!more) return false;
        b->bytes = more;
        b->size = bytes;
    }
    return bytes > 0 && H5Dread_chunk(source, H5P_DEFAULT, at, &filters, b->bytes) >= 0 &&
           H5Dwrite_chunk(target, H5P_DEFAULT, filters, at, bytes, b->bytes) >= 0;
}

/* Appends to `target` the rows it lacks of the first `until` of `source`. A chunk that is partly
 * filled in `target` is replaced. */
static bool copy_rows(hid_t source, hid_t target, int64_t width, int64_t until,
                      struct chunk_buffer *b)
{
    const hsize_t size[2] = {(hsize_t)until, (hsize_t)width};
    const int64_t at = count_rows(target);
    hsize_t chunk[2], own[2];
    if (at < 0 || count_rows(source) < until || !size_of_chunk(source, chunk) ||
        !size_of_chunk(target, own) || memcmp(chunk, own, sizeof own) != 0)
        return false;
    bool ok = at >= until || H5Dset_extent(target, size) >= 0;
    for (hsize_t row = (hsize_t)at - (hsize_t)at % chunk[0]; at < until && row < size[0];
         row += chunk[0])
        for (hsize_t column = 0; ok && column < size[1]; column += chunk[1])
            ok = copy_chunk(source, target, row, column, b);
    return ok;
}

static bool copy_dataset(hid_t from, hid_t to, const struct column *c, int64_t until,
                         struct chunk_buffer *b)
{
    char name[96];
    snprintf(name, sizeof name, "VTKHDF/%s", c->name);
    const hid_t source = H5Dopen2(from, name, H5P_DEFAULT),
                target = H5Dopen2(to, name, H5P_DEFAULT);
    const bool ok = source >= 0 && target >= 0 && copy_rows(source, target, c->width, until, b);
    if (source >= 0) H5Dclose(source);
    return (target < 0 || H5Dclose(target) >= 0) && ok;
}

bool snapshot_file_copy_missing(const struct snapshot_layout *layout, hid_t from, hid_t to,
                                int64_t steps)
{
    int64_t rows[D_COUNT];
    struct chunk_buffer buffer = {0};
    bool ok = snapshot_file_rows(from, steps, rows);
    for (int k = 0; ok && k < D_COUNT; k++)
        ok = !layout->has[k] || copy_dataset(from, to, &columns[k], rows[k], &buffer);
    free(buffer.bytes);
    return ok && snapshot_file_set_steps(to, steps);
}

int snapshot_file_width(enum data what) { return columns[what].width; }

bool snapshot_file_real(enum data what) { return is_real(columns[what].item); }

int64_t snapshot_file_point_bytes(const struct snapshot_layout *layout)
{
    int64_t bytes = 0;
    for (int k = 0; k < D_COUNT; k++)
        if (layout->has[k] && columns[k].growth != BY_STEP)
            bytes += (int64_t)H5Tget_size(file_type(columns[k].item, layout->doubles)) *
                     columns[k].width;
    return bytes;
}

/* The rows, and the last chunk of each dataset a second time, since HDF5 moves it when it grows.
 * METADATA_BYTES covers datasets that grow by one row per snapshot. */
int64_t snapshot_file_bytes(const struct snapshot_layout *layout, int64_t n)
{
    return snapshot_file_point_bytes(layout) * (n + 1 + chunk_rows(&columns[D_POINTS], n)) +
           METADATA_BYTES;
}
