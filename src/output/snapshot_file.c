/* SPDX-License-Identifier: MIT
 * Calls of HDF5: creates, appends to and copies the datasets. */
#include "output/snapshot_file.h"

#include <stdlib.h>

/* Rows that a snapshot of n points adds to a dataset: 1, n, n + 1. */
enum growth { BY_STEP, BY_POINT, BY_POINT_AND_ONE };

enum number_type { F64, REAL, I64, I32, I8, U8 }; /* REAL: float32 or float64 */

/* The datasets. In memory their values are double or int64; HDF5 converts. */
static const struct column {
    const char *name;
    enum growth growth;
    enum number_type item;
    int width;
} columns[D_COUNT] = {
    [D_POINTS_COUNT] = {"VTKHDF/NumberOfPoints", BY_STEP, I64, 1},
    [D_TIME] = {"VTKHDF/Steps/Values", BY_STEP, F64, 1},
    [D_PARTS_BEFORE] = {"VTKHDF/Steps/PartOffsets", BY_STEP, I64, 1},
    [D_PARTS] = {"VTKHDF/Steps/NumberOfParts", BY_STEP, I64, 1},
    [D_POINTS_BEFORE] = {"VTKHDF/Steps/PointOffsets", BY_STEP, I64, 1},
    [D_POINTS] = {"VTKHDF/Points", BY_POINT, F64, 3},
    [D_CONNECTIVITY] = {"VTKHDF/Connectivity", BY_POINT, I64, 1},
    [D_OFFSETS] = {"VTKHDF/Offsets", BY_POINT_AND_ONE, I64, 1},
    [D_TYPES] = {"VTKHDF/Types", BY_POINT, U8, 1},
#define POINTDATA(NAME, name, item, width, ...) \
    [D_##NAME] = {"VTKHDF/PointData/" #name, BY_POINT, item, width},
#include "case/pointdata.def"
};

enum {
    STEP_CHUNK = 128,
    POINT_CHUNK_LEAST = 64,
    POINT_CHUNK_MOST = 1 << 17,
    CONVERTED_BYTES = 1 << 14, /* of HDF5's buffer, which it clears at each write */
    METADATA_BYTES = 1 << 18   /* more than headers and chunk indices grow by with a snapshot */
};

static hid_t file_type(enum number_type item, bool doubles)
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

static bool is_real(enum number_type item) { return item == F64 || item == REAL; }

static int rank_of(const struct column *c) { return c->width > 1 ? 2 : 1; }

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
#define POINTDATA(NAME, name, item, width, choice, unit) \
    layout.has[D_##NAME] =                               \
        !(choice) || (scene_snapshot_has(scene, #name) && ((choice) == 1 || scene->n_beam > 0));
#include "case/pointdata.def"
    return layout;
}

/* --- its values --- */

/* The source of a snapshot. */
struct source {
    const struct simulation *sim;
    double unit; /* to which positions are rounded; 0: not rounded */
    int64_t n, steps_before, points_before;
};

static int64_t integer_value(enum data what, const struct simulation *sim, enum kind kind,
                             int64_t i)
{
    switch (what) {
    case D_KIND: return kind;
    case D_ID: return sim->particles[kind].id[i];
    case D_BODY: return sim->particles[kind].body[i];
    default: return 1; /* VTK_VERTEX */
    }
}

/* The values of one column, double or int64_t; rows are the particles, kind by kind. */
static void values_of(const struct source *source, enum data what, int column, int64_t n,
                      void *values)
{
    const struct simulation *const sim = source->sim;
    const double unit = what == D_POINTS ? source->unit : 0;
    double *real = values;
    int64_t *integer = values;
    switch (what) {
    case D_TIME: *real = simulation_time(sim); return;
    case D_PARTS_BEFORE: *integer = source->steps_before; return;
    case D_PARTS: *integer = 1; return;
    case D_POINTS_BEFORE: *integer = source->points_before; return;
    case D_POINTS_COUNT: *integer = source->n; return;
    case D_CONNECTIVITY:
    case D_OFFSETS: /* each point is a VTK cell */
        for (int64_t row = 0; row < n; row++) integer[row] = row;
        return;
    default: break;
    }
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int64_t i = 0; i < sim->particles[kind].n; i++) {
            if (!is_real(columns[what].item)) {
                *integer++ = integer_value(what, sim, (enum kind)kind, i);
                continue;
            }
            const double value = snapshot_value(what, sim, (enum kind)kind, i, column);
            *real++ = unit > 0 ? nearbyint(value / unit) * unit : value;
        }
}

/* --- one dataset --- */

/* Rows of a chunk: those of a snapshot, or of one of its equal parts if there are more than
 * POINT_CHUNK_MOST. Chunks that two snapshots share would be compressed twice. */
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

/* Creates a dataset for snapshots of about n points. Each component has its own chunks, since
 * values of one component compress better than interleaved ones. Chunks and filters are those of
 * the file `like`, if there is one, so that compressed chunks can be copied. HDF5 refuses a
 * negative identifier, so failures of the calls before need no test. */
static bool create_dataset(hid_t file, const struct snapshot_layout *layout, const struct column *c,
                           int64_t n, hid_t like)
{
    const hsize_t width = (hsize_t)c->width, chunk[2] = {(hsize_t)chunk_rows(c, n), 1};
    const hsize_t size[2] = {0, width}, most[2] = {H5S_UNLIMITED, width};
    const hid_t space = H5Screate_simple(rank_of(c), size, most);
    const hid_t other = H5Dopen2(like, c->name, H5P_DEFAULT);
    const hid_t how = like >= 0 ? H5Dget_create_plist(other) : H5Pcreate(H5P_DATASET_CREATE);
    if (like < 0) {
        H5Pset_chunk(how, rank_of(c), chunk);
        if (c->growth != BY_STEP && layout->deflate > 0) {
            H5Pset_shuffle(how);
            H5Pset_deflate(how, layout->deflate);
        }
    }
    const hid_t set = H5Dcreate2(file, c->name, file_type(c->item, layout->doubles), space,
                                 H5P_DEFAULT, how, H5P_DEFAULT);
    H5Pclose(how);
    H5Dclose(other);
    H5Sclose(space);
    return H5Dclose(set) >= 0;
}

static int64_t count_rows(hid_t set)
{
    hsize_t size[2] = {0, 0};
    const hid_t space = H5Dget_space(set);
    const bool ok = H5Sget_simple_extent_dims(space, size, NULL) >= 0;
    H5Sclose(space);
    return ok ? (int64_t)size[0] : -1;
}

/* Appends n rows to a dataset, one column at a time, in which HDF5 compresses them. The rank in
 * memory is that of the file: otherwise HDF5 moves one item at a time. */
static bool append_rows(hid_t file, hid_t how, const struct column *c, int64_t n,
                        const struct source *source, void *values)
{
    const hid_t set = H5Dopen2(file, c->name, H5P_DEFAULT);
    const int64_t first = count_rows(set);
    const hsize_t all[2] = {(hsize_t)(first + n), (hsize_t)c->width}, size[2] = {(hsize_t)n, 1};
    bool ok = first >= 0 && H5Dset_extent(set, all) >= 0;
    const hid_t in_file = H5Dget_space(set), in_memory = H5Screate_simple(rank_of(c), size, NULL);
    for (int column = 0; ok && n > 0 && column < c->width; column++) {
        const hsize_t at[2] = {(hsize_t)first, (hsize_t)column};
        values_of(source, (enum data)(c - columns), column, n, values);
        ok = H5Sselect_hyperslab(in_file, H5S_SELECT_SET, at, NULL, size, NULL) >= 0 &&
             H5Dwrite(set, memory_type(c), in_memory, in_file, how, values) >= 0;
    }
    H5Sclose(in_memory);
    H5Sclose(in_file);
    return H5Dclose(set) >= 0 && ok;
}

bool snapshot_file_first(hid_t file, enum data what, int64_t n, void *values)
{
    const struct column *const c = &columns[what];
    const hsize_t none[2] = {0, 0}, size[2] = {(hsize_t)n, (hsize_t)c->width};
    const hid_t set = H5Dopen2(file, c->name, H5P_DEFAULT), in_file = H5Dget_space(set);
    const hid_t in_memory = H5Screate_simple(rank_of(c), size, NULL);
    const bool ok = count_rows(set) >= n &&
                    H5Sselect_hyperslab(in_file, H5S_SELECT_SET, none, NULL, size, NULL) >= 0 &&
                    H5Dread(set, memory_type(c), in_memory, in_file, H5P_DEFAULT, values) >= 0;
    H5Sclose(in_memory);
    H5Sclose(in_file);
    H5Dclose(set);
    return ok || (n == 0 && set >= 0);
}

/* --- a whole file --- */

static bool put_text(hid_t group, const char *name, const char *text)
{
    const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    const bool sized = H5Tset_size(type, text[0] ? strlen(text) : 1) >= 0;
    const hid_t a = H5Acreate2(group, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    const bool ok = sized && H5Awrite(a, type, text) >= 0;
    H5Aclose(a);
    H5Sclose(space);
    H5Tclose(type);
    return ok;
}

static bool put_numbers(hid_t group, const char *name, enum number_type item, const void *values,
                        int n)
{
    const hsize_t size = (hsize_t)n;
    const hid_t space = n > 1 ? H5Screate_simple(1, &size, NULL) : H5Screate(H5S_SCALAR);
    const hid_t a = H5Acreate2(group, name, file_type(item, true), space, H5P_DEFAULT, H5P_DEFAULT);
    const bool ok = H5Awrite(a, item == F64 ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64, values) >= 0;
    H5Aclose(a);
    H5Sclose(space);
    return ok;
}

/* Attributes; those outside the VTKHDF layout are in the group /sphfsi, which VTK ignores. */
static bool put_attributes(hid_t file, const struct scene *scene, const char *program)
{
    const int64_t version[2] = {2, 0}, none = 0;
    const hid_t root = H5Gopen2(file, "VTKHDF", H5P_DEFAULT);
    const hid_t steps = H5Gopen2(file, "VTKHDF/Steps", H5P_DEFAULT);
    const hid_t own = H5Gopen2(file, "sphfsi", H5P_DEFAULT);
    const bool ok =
        put_numbers(root, "Version", I64, version, 2) &&
        put_text(root, "Type", "UnstructuredGrid") && put_numbers(steps, "NSteps", I64, &none, 1) &&
        put_text(own, "title", scene->top.title) && put_text(own, "version", program) &&
        put_text(own, "kinds", "0 fluid, 1 wall, 2 solid") &&
        put_text(own, "stress", "Cauchy: xx yy zz xy yz xz, Pa") &&
        put_numbers(own, "dp", F64, &scene->top.dp, 1) &&
        put_numbers(own, "h", F64, &scene->h, 1) && put_numbers(own, "c0", F64, &scene->c0, 1);
    H5Gclose(own);
    H5Gclose(steps);
    H5Gclose(root);
    return ok;
}

/* A second name of a dataset: a hard link. */
static bool put_link(hid_t file, enum data what, const char *group, const char *name)
{
    char link[64];
    snprintf(link, sizeof link, "%s/%s", group, name);
    return H5Lcreate_hard(file, columns[what].name, file, link, H5P_DEFAULT, H5P_DEFAULT) >= 0;
}

bool snapshot_file_create(hid_t file, const struct scene *scene, const char *program, int64_t n,
                          hid_t like)
{
    static const char *const groups[] = {"VTKHDF", "VTKHDF/Steps", "VTKHDF/PointData",
                                         "VTKHDF/Steps/PointDataOffsets", "sphfsi"};
    const struct snapshot_layout layout = snapshot_file_layout(scene);
    bool ok = true;
    for (size_t k = 0; ok && k < COUNT_OF(groups); k++)
        ok = H5Gclose(H5Gcreate2(file, groups[k], H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)) >= 0;
    ok = ok && put_attributes(file, scene, program);
    for (int k = 0; ok && k < D_COUNT; k++)
        ok = !layout.has[k] || create_dataset(file, &layout, &columns[k], n, like);
    /* Each point is a cell, and all arrays of points have the same offsets. */
    ok = ok && put_link(file, D_POINTS_COUNT, "VTKHDF", "NumberOfCells") &&
         put_link(file, D_POINTS_COUNT, "VTKHDF", "NumberOfConnectivityIds") &&
         put_link(file, D_POINTS_BEFORE, groups[1], "CellOffsets") &&
         put_link(file, D_POINTS_BEFORE, groups[1], "ConnectivityIdOffsets");
    for (int k = D_FIRST_POINTDATA; ok && k < D_COUNT; k++)
        ok = !layout.has[k] ||
             put_link(file, D_POINTS_BEFORE, groups[3], strrchr(columns[k].name, '/') + 1);
    return ok;
}

/* Reads or writes the number of snapshots. */
static bool move_steps(hid_t file, int64_t *n, bool write)
{
    const hid_t group = H5Gopen2(file, "VTKHDF/Steps", H5P_DEFAULT);
    const hid_t a = H5Aopen(group, "NSteps", H5P_DEFAULT);
    const herr_t e = write ? H5Awrite(a, H5T_NATIVE_INT64, n) : H5Aread(a, H5T_NATIVE_INT64, n);
    H5Aclose(a);
    H5Gclose(group);
    return e >= 0;
}

int64_t snapshot_file_steps(hid_t file)
{
    int64_t n = -1;
    return move_steps(file, &n, false) ? n : -1;
}

static bool set_steps(hid_t file, int64_t n) { return move_steps(file, &n, true); }

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

bool snapshot_file_append(hid_t file, const struct snapshot_layout *layout,
                          const struct simulation *sim)
{
    static const int64_t more[] = {[BY_STEP] = 1, [BY_POINT] = 0, [BY_POINT_AND_ONE] = 1};
    struct source of = {.sim = sim, .steps_before = snapshot_file_steps(file)};
    int64_t before[D_COUNT];
    if (of.steps_before < 0 || !snapshot_file_rows(file, of.steps_before, before)) return false;
    of.points_before = before[D_POINTS];
    for (int k = 0; k < KIND_COUNT; k++) of.n += sim->particles[k].n;
    /* With single-precision fields, positions are rounded to a power of two near 1e-6 dp. Bits
     * below carry no information, and take as long to compress as all other fields. */
    of.unit = layout->doubles ? 0 : ldexp(1, ilogb(sim->scene->top.dp) - 20);
    void *const values = malloc((size_t)(of.n + 1) * sizeof(double));
    const hid_t how = H5Pcreate(H5P_DATASET_XFER);
    bool ok = values && H5Pset_buffer(how, CONVERTED_BYTES, NULL, NULL) >= 0;
    for (int k = 0; ok && k < D_COUNT; k++) {
        const struct column *const c = &columns[k];
        const int64_t rows = more[c->growth] + (c->growth == BY_STEP ? 0 : of.n);
        ok = !layout->has[k] || append_rows(file, how, c, rows, &of, values);
    }
    H5Pclose(how);
    free(values);
    return ok && set_steps(file, of.steps_before + 1);
}

/* Copies the chunk that begins at a row and a column, compressed as it is. */
static bool copy_chunk(hid_t source, hid_t target, hsize_t row, hsize_t column)
{
    const hsize_t at[2] = {row, column};
    hsize_t bytes = 0;
    uint32_t filters = 0;
    if (H5Dget_chunk_storage_size(source, at, &bytes) < 0 || bytes == 0) return false;
    void *const chunk = malloc(bytes);
    const bool ok = chunk && H5Dread_chunk(source, H5P_DEFAULT, at, &filters, chunk) >= 0 &&
                    H5Dwrite_chunk(target, H5P_DEFAULT, filters, at, bytes, chunk) >= 0;
    free(chunk);
    return ok;
}

/* Appends what `to` lacks of the first `until` rows of `from`; replaces partly filled chunks. */
static bool copy_rows(hid_t from, hid_t to, const struct column *c, int64_t until)
{
    const hid_t source = H5Dopen2(from, c->name, H5P_DEFAULT);
    const hid_t target = H5Dopen2(to, c->name, H5P_DEFAULT), how = H5Dget_create_plist(target);
    const hsize_t size[2] = {(hsize_t)until, (hsize_t)c->width};
    const int64_t at = count_rows(target);
    hsize_t chunk[2] = {1, 1};
    bool ok = at >= 0 && count_rows(source) >= until && H5Pget_chunk(how, 2, chunk) > 0 &&
              (at >= until || H5Dset_extent(target, size) >= 0);
    for (hsize_t row = ok ? (hsize_t)at - (hsize_t)at % chunk[0] : 0;
         ok && at < until && row < size[0]; row += chunk[0])
        for (hsize_t column = 0; ok && column < size[1]; column += chunk[1])
            ok = copy_chunk(source, target, row, column);
    H5Pclose(how);
    H5Dclose(source);
    return H5Dclose(target) >= 0 && ok;
}

bool snapshot_file_copy_missing(const struct snapshot_layout *layout, hid_t from, hid_t to,
                                int64_t steps)
{
    int64_t rows[D_COUNT];
    bool ok = snapshot_file_rows(from, steps, rows);
    for (int k = 0; ok && k < D_COUNT; k++)
        ok = !layout->has[k] || copy_rows(from, to, &columns[k], rows[k]);
    return ok && set_steps(to, steps);
}

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
