/* SPDX-License-Identifier: MIT */
#include "snapshot.h"

#include <errno.h>
#include <fcntl.h>
#include <hdf5.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* How the rows of a dataset grow with a snapshot of n points. */
enum growth { BY_STEP, BY_POINT, BY_POINT_AND_ONE };

enum data {
    D_POINTS_COUNT,
    D_CELLS_COUNT,
    D_IDS_COUNT,
    D_TIME,
    D_PARTS_BEFORE,
    D_PARTS,
    D_POINTS_BEFORE,
    D_CELLS_BEFORE,
    D_IDS_BEFORE,
    D_POINTS,
    D_CONNECTIVITY,
    D_OFFSETS,
    D_TYPES,
    D_VELOCITY,
    D_DENSITY,
    D_PRESSURE,
    D_KIND,
    D_ID,
    D_BODY,
    D_STRESS,
    D_VON_MISES,
    D_DISPLACEMENT,
    D_DET_F,
    D_COUNT
};

enum item { F64, F32, I64, I32, I8, U8 };

/* The datasets below /VTKHDF. Values are handed to HDF5 as double where the file holds a floating
 * type and as int64 otherwise; HDF5 converts. */
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
    [D_VELOCITY] = {"PointData/velocity", BY_POINT, F32, 3},
    [D_DENSITY] = {"PointData/density", BY_POINT, F32, 1},
    [D_PRESSURE] = {"PointData/pressure", BY_POINT, F32, 1},
    [D_KIND] = {"PointData/kind", BY_POINT, I8, 1},
    [D_ID] = {"PointData/id", BY_POINT, I64, 1},
    [D_BODY] = {"PointData/body", BY_POINT, I32, 1},
    [D_STRESS] = {"PointData/stress", BY_POINT, F32, 6},
    [D_VON_MISES] = {"PointData/von_mises", BY_POINT, F32, 1},
    [D_DISPLACEMENT] = {"PointData/displacement", BY_POINT, F32, 3},
    [D_DET_F] = {"PointData/det_F", BY_POINT, F32, 1},
};

enum {
    MAX_WIDTH = 6,
    VTK_VERTEX = 1,
    COPY_ROWS = 1 << 16,
    STEP_CHUNK = 128,
    POINT_CHUNK = 1 << 14
};
static const unsigned deflate_level = 2;

static hid_t file_type(enum item item)
{
    switch (item) {
    case F64: return H5T_IEEE_F64LE;
    case F32: return H5T_IEEE_F32LE;
    case I64: return H5T_STD_I64LE;
    case I32: return H5T_STD_I32LE;
    case I8: return H5T_STD_I8LE;
    case U8: break;
    }
    return H5T_STD_U8LE;
}

static hid_t memory_type(const struct column *c)
{
    return c->item == F64 || c->item == F32 ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64;
}

/* --- one dataset --- */

static bool create_dataset(hid_t root, const struct column *c)
{
    const hsize_t width = (hsize_t)c->width;
    const hsize_t size[2] = {0, width}, most[2] = {H5S_UNLIMITED, width};
    const hsize_t chunk[2] = {c->growth == BY_STEP ? STEP_CHUNK : POINT_CHUNK, width};
    const int rank = c->width > 1 ? 2 : 1;
    const hid_t space = H5Screate_simple(rank, size, most);
    const hid_t how = H5Pcreate(H5P_DATASET_CREATE);
    bool ok = space >= 0 && how >= 0 && H5Pset_chunk(how, rank, chunk) >= 0;
    if (ok && c->growth != BY_STEP && H5Zfilter_avail(H5Z_FILTER_DEFLATE) > 0)
        ok = H5Pset_shuffle(how) >= 0 && H5Pset_deflate(how, deflate_level) >= 0;
    const hid_t set =
        ok ? H5Dcreate2(root, c->name, file_type(c->item), space, H5P_DEFAULT, how, H5P_DEFAULT)
           : -1;
    ok = set >= 0 && H5Dclose(set) >= 0;
    H5Pclose(how);
    H5Sclose(space);
    return ok;
}

static int64_t count_rows(hid_t set)
{
    hsize_t size[2] = {0, 0};
    const hid_t space = H5Dget_space(set);
    const bool ok = space >= 0 && H5Sget_simple_extent_dims(space, size, NULL) >= 0;
    H5Sclose(space);
    return ok ? (int64_t)size[0] : -1;
}

/* Moves rows between memory and an open dataset. */
static bool move_rows(hid_t set, const struct column *c, int64_t first, int64_t n, void *values,
                      bool write)
{
    if (n == 0) return true;
    const int rank = c->width > 1 ? 2 : 1;
    const hsize_t at[2] = {(hsize_t)first, 0}, size[2] = {(hsize_t)n, (hsize_t)c->width};
    const hid_t in_file = H5Dget_space(set), in_memory = H5Screate_simple(rank, size, NULL);
    bool ok = in_file >= 0 && in_memory >= 0 &&
              H5Sselect_hyperslab(in_file, H5S_SELECT_SET, at, NULL, size, NULL) >= 0;
    if (ok && write)
        ok = H5Dwrite(set, memory_type(c), in_memory, in_file, H5P_DEFAULT, values) >= 0;
    else if (ok)
        ok = H5Dread(set, memory_type(c), in_memory, in_file, H5P_DEFAULT, values) >= 0;
    H5Sclose(in_memory);
    H5Sclose(in_file);
    return ok;
}

static bool append_rows(hid_t set, const struct column *c, int64_t n, void *values)
{
    const int64_t first = count_rows(set);
    const hsize_t size[2] = {(hsize_t)(first + n), (hsize_t)c->width};
    return first >= 0 && H5Dset_extent(set, size) >= 0 && move_rows(set, c, first, n, values, true);
}

static bool append(hid_t root, enum data what, int64_t n, void *values)
{
    const hid_t set = H5Dopen2(root, columns[what].name, H5P_DEFAULT);
    const bool ok = set >= 0 && append_rows(set, &columns[what], n, values);
    return (set < 0 || H5Dclose(set) >= 0) && ok;
}

/* --- a whole file --- */

static bool put_text(hid_t at, const char *name, const char *text)
{
    const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(type, text[0] ? strlen(text) : 1);
    const hid_t a = H5Acreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
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
    const hid_t a = H5Acreate2(at, name, file_type(item), space, H5P_DEFAULT, H5P_DEFAULT);
    const bool ok =
        a >= 0 && H5Awrite(a, item == F64 ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64, values) >= 0;
    H5Aclose(a);
    H5Sclose(space);
    return ok;
}

/* What VTK has no place for stands in a group of its own, which VTK ignores. */
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

static bool lay_out(hid_t file, const struct scene *scene, const char *program)
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
    for (int k = 0; ok && k < D_COUNT; k++) ok = create_dataset(root, &columns[k]);
    /* All arrays of points are read from the same place: their offsets are one dataset. */
    for (int k = D_VELOCITY; ok && k < D_COUNT; k++) {
        char link[64];
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

static int64_t read_steps(hid_t file)
{
    int64_t n = -1;
    return move_steps(file, &n, false) ? n : -1;
}

static bool write_steps(hid_t file, int64_t n) { return move_steps(file, &n, true); }

/* Reads the first n rows of a dataset of one column. */
static bool read_first(hid_t file, enum data what, int64_t n, void *values)
{
    char name[96];
    snprintf(name, sizeof name, "VTKHDF/%s", columns[what].name);
    const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    const bool ok =
        set >= 0 && count_rows(set) >= n && move_rows(set, &columns[what], 0, n, values, false);
    H5Dclose(set);
    return ok;
}

/* --- catching up --- */

/* Rows of every dataset in the first `steps` snapshots of a file; false: it does not hold them. */
static bool count_until(hid_t file, int64_t steps, int64_t rows[D_COUNT])
{
    int64_t points = 0;
    int64_t *n = malloc((size_t)(steps + 1) * sizeof *n);
    const bool ok = n && read_first(file, D_POINTS_COUNT, steps, n);
    for (int64_t k = 0; ok && k < steps; k++) points += n[k];
    free(n);
    for (int k = 0; k < D_COUNT; k++)
        rows[k] = columns[k].growth == BY_STEP
                      ? steps
                      : points + (columns[k].growth == BY_POINT_AND_ONE ? steps : 0);
    return ok;
}

static bool copy_rows(hid_t from, hid_t to, const struct column *c, int64_t until, void *buffer)
{
    char name[96];
    snprintf(name, sizeof name, "VTKHDF/%s", c->name);
    const hid_t source = H5Dopen2(from, name, H5P_DEFAULT),
                target = H5Dopen2(to, name, H5P_DEFAULT);
    bool ok = source >= 0 && target >= 0 && count_rows(source) >= until;
    int64_t at = ok ? count_rows(target) : until;
    for (int64_t n; ok && at < until; at += n) {
        n = until - at < COPY_ROWS ? until - at : COPY_ROWS;
        ok = move_rows(source, c, at, n, buffer, false) && append_rows(target, c, n, buffer);
    }
    H5Dclose(source);
    return (target < 0 || H5Dclose(target) >= 0) && ok;
}

/* Appends to `to` what it lacks of the first `steps` snapshots of `from`. */
static bool catch_up(hid_t from, hid_t to, int64_t steps)
{
    int64_t rows[D_COUNT];
    void *buffer = malloc((size_t)COPY_ROWS * MAX_WIDTH * 8);
    bool ok = buffer && count_until(from, steps, rows);
    for (int k = 0; ok && k < D_COUNT; k++) ok = copy_rows(from, to, &columns[k], rows[k], buffer);
    free(buffer);
    return ok && write_steps(to, steps);
}

/* --- a snapshot --- */

static double von_mises(const double s[4])
{
    return sqrt(0.5 * (square(s[0] - s[1]) + square(s[1] - s[3]) + square(s[3] - s[0])) +
                3 * square(s[2]));
}

/* Values of a dataset of points, of one particle, where they are floating. */
static void real_values(enum data what, const struct simulation *s, enum kind kind, int64_t i,
                        double v[MAX_WIDTH])
{
    const struct particles *p = &s->kind[kind];
    double sigma[4] = {0}, det = 1;
    const bool solid = kind == KIND_SOLID;
    if (solid && (what == D_STRESS || what == D_VON_MISES || what == D_DET_F || what == D_DENSITY))
        solid_cauchy(&s->solid, p, i, sigma, &det);
    memset(v, 0, MAX_WIDTH * sizeof *v);
    switch (what) {
    case D_POINTS: v[0] = p->x[i], v[1] = p->y[i]; break;
    case D_VELOCITY: v[0] = p->vx[i], v[1] = p->vy[i]; break;
    case D_PRESSURE: v[0] = p->p ? p->p[i] : 0; break;
    case D_VON_MISES: v[0] = von_mises(sigma); break;
    case D_DET_F: v[0] = det; break;
    case D_DENSITY:
        v[0] = solid     ? s->solid.body[p->body[i]].density / det
               : p->dens ? s->scene->rho0 * (1 + p->dens[i])
                         : 0;
        break;
    case D_STRESS: v[0] = sigma[0], v[1] = sigma[1], v[2] = sigma[3], v[3] = sigma[2]; break;
    case D_DISPLACEMENT:
        if (solid)
            v[0] = p->ux[i], v[1] = p->uy[i];
        else if (p->X)
            v[0] = p->x[i] - p->X[i], v[1] = p->y[i] - p->Y[i];
        break;
    default: break;
    }
}

static int64_t whole_value(enum data what, const struct simulation *s, enum kind kind, int64_t i,
                           int64_t row)
{
    switch (what) {
    case D_TYPES: return VTK_VERTEX;
    case D_KIND: return kind;
    case D_ID: return s->kind[kind].id[i];
    case D_BODY: return s->kind[kind].body[i];
    default: return row; /* each point is a cell of its own */
    }
}

/* Fills the buffer, 8 bytes an item, with what the dataset gets; returns its rows. */
static int64_t gather(enum data what, const struct simulation *s, void *buffer)
{
    const struct column *c = &columns[what];
    const bool real = memory_type(c) == H5T_NATIVE_DOUBLE;
    int64_t row = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int64_t i = 0; i < s->kind[kind].n; i++, row++) {
            double v[MAX_WIDTH];
            if (real) {
                real_values(what, s, (enum kind)kind, i, v);
                memcpy((double *)buffer + row * c->width, v, (size_t)c->width * sizeof *v);
            } else {
                ((int64_t *)buffer)[row] = whole_value(what, s, (enum kind)kind, i, row);
            }
        }
    if (what == D_OFFSETS) {
        ((int64_t *)buffer)[row] = row;
        row++;
    }
    return row;
}

static bool append_step_rows(hid_t root, double time, int64_t n, int64_t steps, int64_t points)
{
    int64_t before = points, part = steps, one = 1;
    return append(root, D_TIME, 1, &time) && append(root, D_POINTS_COUNT, 1, &n) &&
           append(root, D_CELLS_COUNT, 1, &n) && append(root, D_IDS_COUNT, 1, &n) &&
           append(root, D_PARTS_BEFORE, 1, &part) && append(root, D_PARTS, 1, &one) &&
           append(root, D_POINTS_BEFORE, 1, &before) && append(root, D_CELLS_BEFORE, 1, &before) &&
           append(root, D_IDS_BEFORE, 1, &before);
}

static bool append_snapshot(hid_t file, struct simulation *s)
{
    int64_t n = 0, rows[D_COUNT];
    for (int k = 0; k < KIND_COUNT; k++) n += s->kind[k].n;
    const int64_t steps = read_steps(file);
    void *buffer = malloc((size_t)(n + 1) * MAX_WIDTH * 8);
    const hid_t root = H5Gopen2(file, "VTKHDF", H5P_DEFAULT);
    bool ok = buffer && root >= 0 && steps >= 0 && count_until(file, steps, rows) &&
              append_step_rows(root, s->state.time, n, steps, rows[D_POINTS]);
    for (int k = D_POINTS; ok && k < D_COUNT; k++) {
        const int64_t count = gather((enum data)k, s, buffer);
        ok = append(root, (enum data)k, count, buffer);
    }
    H5Gclose(root);
    free(buffer);
    return ok && write_steps(file, steps + 1);
}

/* --- files --- */

/* Opens the spare, or makes a new one: where there is none, where it is damaged, and where a reader
 * still holds it open from the time when it had the name. */
static hid_t open_spare(const struct snapshots *w, int64_t steps)
{
    hid_t file = access(w->spare, F_OK) == 0 ? H5Fopen(w->spare, H5F_ACC_RDWR, H5P_DEFAULT) : -1;
    int64_t rows[D_COUNT];
    const int64_t has = file >= 0 ? read_steps(file) : -1;
    if (has >= 0 && has <= steps && count_until(file, has, rows)) return file;
    if (file >= 0) H5Fclose(file);
    unlink(w->spare);
    file = H5Fcreate(w->spare, H5F_ACC_EXCL, H5P_DEFAULT, H5P_DEFAULT);
    if (file >= 0 && !lay_out(file, w->scene, w->version)) {
        H5Fclose(file);
        return -1;
    }
    return file;
}

/* Brings the spare to the first `steps` snapshots of the named file (all of them: negative), then
 * appends one of `s`, unless that is NULL. */
static bool fill_spare(const struct snapshots *w, int64_t steps, struct simulation *s)
{
    const hid_t named =
        access(w->path, F_OK) == 0 ? H5Fopen(w->path, H5F_ACC_RDONLY, H5P_DEFAULT) : -1;
    if (steps < 0) steps = named >= 0 ? read_steps(named) : 0;
    bool ok = access(w->path, F_OK) != 0 || named >= 0;
    const hid_t file = ok ? open_spare(w, steps) : -1;
    ok = file >= 0 && (named < 0 || catch_up(named, file, steps)) &&
         (!s || append_snapshot(file, s));
    if (named >= 0) H5Fclose(named);
    return (file < 0 || H5Fclose(file) >= 0) && ok;
}

static bool sync_file(const char *path)
{
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    const bool ok = fd >= 0 && fsync(fd) == 0;
    if (fd >= 0) close(fd);
    return ok;
}

/* The spare takes the name in one move, the file that had it becomes the spare. Where a file system
 * has no links the old one is gone, and the next spare is made anew. */
static bool swap(const struct snapshots *w)
{
    char old[FOLDER_PATH];
    if (snprintf(old, sizeof old, "%s.old", w->spare) >= FOLDER_PATH) return false;
    unlink(old);
    const bool linked = link(w->path, old) == 0;
    if (rename(w->spare, w->path) != 0) return false;
    if (linked) rename(old, w->spare);
    return true;
}

/* HDF5 prints what fails unless told otherwise; the setting belongs to the program, so it is put
 * back. */
struct quiet {
    H5E_auto2_t report;
    void *context;
};

static struct quiet quiet_begin(void)
{
    struct quiet q = {NULL, NULL};
    H5Eget_auto2(H5E_DEFAULT, &q.report, &q.context);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    return q;
}

static void quiet_end(struct quiet q) { H5Eset_auto2(H5E_DEFAULT, q.report, q.context); }

static enum err update(const struct snapshots *w, int64_t steps, struct simulation *s,
                       struct diag *d)
{
    const struct quiet q = quiet_begin();
    errno = 0;
    const bool filled = fill_spare(w, steps, s);
    const int why = errno;
    quiet_end(q);
    if (!filled) {
        unlink(w->spare);
        return diag_fail(d, ERR_IO,
                         "%s: a snapshot cannot be written: %s; those before it are kept", w->path,
                         why ? strerror(why) : "HDF5 reports a failure");
    }
    if (!sync_file(w->spare) || !swap(w))
        return diag_fail(d, ERR_IO, "%s: cannot be put in place: %s", w->path, strerror(errno));
    return folder_sync(w->folder, d);
}

enum err snapshots_create(struct snapshots *w, const char *folder, const struct scene *scene,
                          const char *version, struct diag *d)
{
    w->scene = scene;
    w->version = version;
    TRY(folder_join(w->folder, folder, ".", d));
    TRY(folder_join(w->path, folder, "fields.vtkhdf", d));
    return folder_join(w->spare, folder, "fields.vtkhdf.spare", d);
}

/* How many snapshots the named file holds, and how many of them up to `time`; the time of the last
 * of these. */
static bool count_snapshots(const struct snapshots *w, double time, int64_t *all, int64_t *keep,
                            double *last)
{
    const hid_t file = H5Fopen(w->path, H5F_ACC_RDONLY, H5P_DEFAULT);
    *all = file >= 0 ? read_steps(file) : -1;
    double *times = *all >= 0 ? malloc((size_t)(*all + 1) * sizeof *times) : NULL;
    const bool ok = times && read_first(file, D_TIME, *all, times);
    for (*keep = 0; ok && *keep < *all && times[*keep] <= time; ++*keep) *last = times[*keep];
    free(times);
    if (file >= 0) H5Fclose(file);
    return ok;
}

enum err snapshots_resume(struct snapshots *w, const char *folder, const struct scene *scene,
                          const char *version, double time, double *last, struct diag *d)
{
    TRY(snapshots_create(w, folder, scene, version, d));
    *last = -1;
    unlink(w->spare);
    if (access(w->path, F_OK) != 0) {
        diag_warn(d, "%s: is not there; snapshots begin anew", w->path);
        return ERR_OK;
    }
    int64_t all, keep;
    const struct quiet q = quiet_begin();
    const bool counted = count_snapshots(w, time, &all, &keep, last);
    quiet_end(q);
    if (!counted)
        return diag_fail(d, ERR_INPUT,
                         "%s: cannot be read as snapshots; move it away to go on "
                         "without it",
                         w->path);
    if (keep == all) return ERR_OK;
    TRY(update(w, keep, NULL, d));
    unlink(w->spare);
    return ERR_OK;
}

enum err snapshots_write(struct snapshots *w, struct simulation *s, struct diag *d)
{
    simulation_refresh(s);
    return update(w, -1, s, d);
}

void snapshots_close(struct snapshots *w)
{
    if (w->spare[0]) unlink(w->spare);
}
