/* SPDX-License-Identifier: MIT */
#include "output/snapshot.h"

#include "fluid/eos.h"
#include "output/snapshot_file.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { VTK_VERTEX = 1 };

/* --- a snapshot --- */

/* Cauchy's stress, in the order of the file: xx yy zz xy yz xz. */
static double stress_value(const double sigma[4], int column)
{
    static const int order[] = {0, 1, 3, 2};
    return column < (int)COUNT_OF(order) ? sigma[order[column]] : 0;
}

static double vector_value(double x, double y, int column)
{
    return column == 0 ? x : column == 1 ? y : 0;
}

/* Value of a dataset of points, of one particle, where it is floating. */
static double real_value(enum data what, const struct simulation *s, enum kind kind, int64_t i,
                         int column)
{
    const struct particles *p = &s->kind[kind];
    double sigma[4] = {0}, det = 1;
    const bool solid = kind == KIND_SOLID;
    if (solid && (what == D_STRESS || what == D_VON_MISES || what == D_DET_F || what == D_DENSITY))
        solid_cauchy(&s->solid, p, i, sigma, &det);
    switch (what) {
    case D_POINTS: return vector_value(p->x[i], p->y[i], column);
    case D_VELOCITY: return vector_value(p->vx[i], p->vy[i], column);
    case D_PRESSURE:
        if (kind == KIND_FLUID) return eos_pressure(p->dens[i], s->fluid.k.rho0, s->fluid.k.c0);
        return p->p ? p->p[i] : 0;
    case D_VON_MISES: return solid_von_mises(sigma);
    case D_DET_F: return det;
    case D_DENSITY:
        if (solid) return s->solid.body[p->body[i]].density / det;
        return p->dens ? s->scene->rho0 * (1 + p->dens[i]) : 0;
    case D_STRESS: return stress_value(sigma, column);
    case D_DISPLACEMENT:
        if (solid) return vector_value(p->ux[i], p->uy[i], column);
        return p->X ? vector_value(p->x[i] - p->X[i], p->y[i] - p->Y[i], column) : 0;
    default: return 0;
    }
}

static int64_t whole_value(enum data what, const struct simulation *s, enum kind kind, int64_t i)
{
    switch (what) {
    case D_KIND: return kind;
    case D_ID: return s->kind[kind].id[i];
    case D_BODY: return s->kind[kind].body[i];
    default: return VTK_VERTEX;
    }
}

/* What positions are rounded to beside fields in single precision, about 1e-6 dp, m: their last digits say
 * nothing, and packing them takes as long as packing all else. A power of two, so that they end in zeros. */
static double position_unit(const struct scene *scene)
{
    return ldexp(1, ilogb(scene->top.dp) - 20);
}

/* What a snapshot is made of. */
struct picture {
    const struct simulation *s;
    double unit; /* of positions, 0: not rounded */
};

static int64_t within(int64_t value, int64_t most)
{
    return value < 0 ? 0 : value > most ? most : value;
}

/* A snapshot_values: the particles of one kind after those of the other. */
static void values_of(const void *context, enum data what, int column, int64_t first, int64_t n,
                      void *values)
{
    const struct picture *const picture = context;
    const struct simulation *const s = picture->s;
    const double unit = what == D_POINTS ? picture->unit : 0;
    double *const real = values;
    int64_t *const whole = values;
    if (what == D_CONNECTIVITY || what == D_OFFSETS) { /* each point is a cell of its own */
        for (int64_t row = 0; row < n; row++) whole[row] = first + row;
        return;
    }
    const bool is_real = snapshot_file_real(what);
    int64_t row = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        const int64_t most = s->kind[kind].n, end = within(first + n, most);
        for (int64_t i = within(first, most); i < end; i++, row++) {
            if (!is_real) {
                whole[row] = whole_value(what, s, (enum kind)kind, i);
                continue;
            }
            const double value = real_value(what, s, (enum kind)kind, i, column);
            real[row] = unit > 0 ? nearbyint(value / unit) * unit : value;
        }
        first -= most;
    }
}

static bool append_step_rows(hid_t root, double time, int64_t n, int64_t steps, int64_t points)
{
    int64_t before = points, part = steps, one = 1;
    return snapshot_file_append(root, D_TIME, &time) &&
           snapshot_file_append(root, D_POINTS_COUNT, &n) &&
           snapshot_file_append(root, D_CELLS_COUNT, &n) &&
           snapshot_file_append(root, D_IDS_COUNT, &n) &&
           snapshot_file_append(root, D_PARTS_BEFORE, &part) &&
           snapshot_file_append(root, D_PARTS, &one) &&
           snapshot_file_append(root, D_POINTS_BEFORE, &before) &&
           snapshot_file_append(root, D_CELLS_BEFORE, &before) &&
           snapshot_file_append(root, D_IDS_BEFORE, &before);
}

static int64_t count_points(const struct simulation *s)
{
    int64_t n = 0;
    for (int k = 0; k < KIND_COUNT; k++) n += s->kind[k].n;
    return n;
}

/* The most points that any snapshot has: fluid only ever leaves. */
static int64_t count_capacity(const struct simulation *s)
{
    int64_t n = 0;
    for (int k = 0; k < KIND_COUNT; k++) n += s->kind[k].capacity;
    return n;
}

static bool append_snapshot(const struct snapshot_layout *layout, hid_t file, struct simulation *s)
{
    int64_t rows[D_COUNT];
    const int64_t n = count_points(s), steps = snapshot_file_steps(file);
    const struct picture picture = {s, layout->doubles ? 0 : position_unit(s->scene)};
    const hid_t root = H5Gopen2(file, "VTKHDF", H5P_DEFAULT);
    const bool ok = root >= 0 && steps >= 0 && snapshot_file_rows(file, steps, rows) &&
                    append_step_rows(root, s->state.time, n, steps, rows[D_POINTS]) &&
                    snapshot_file_append_points(root, layout, n, values_of, &picture);
    H5Gclose(root);
    return ok && snapshot_file_set_steps(file, steps + 1);
}

/* --- files --- */

/* Opens the spare, or makes a new one: where there is none, where it is damaged, and where a reader
 * still holds it open from the time when it had the name. */
static hid_t open_spare(const struct snapshots *w, int64_t steps, int64_t points, hid_t named)
{
    hid_t file = access(w->spare, F_OK) == 0 ? H5Fopen(w->spare, H5F_ACC_RDWR, H5P_DEFAULT) : -1;
    int64_t rows[D_COUNT];
    const int64_t has = file >= 0 ? snapshot_file_steps(file) : -1;
    if (has >= 0 && has <= steps && snapshot_file_rows(file, has, rows)) return file;
    if (file >= 0) H5Fclose(file);
    unlink(w->spare);
    file = H5Fcreate(w->spare, H5F_ACC_EXCL, H5P_DEFAULT, H5P_DEFAULT);
    if (file >= 0 && !snapshot_file_lay_out(file, w->scene, w->version, points, named)) {
        H5Fclose(file);
        return -1;
    }
    return file;
}

static int64_t file_bytes(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 ? (int64_t)info.st_size : 0;
}

/* Claims the disk space that the spare can need: HDF5 does not survive a write that fails, it
 * crashes at the end of the program. It gives back what it does not use when it closes the file. */
static bool claim_space(const struct snapshots *w, int64_t points)
{
#if _POSIX_ADVISORY_INFO > 0
    const int64_t have = file_bytes(w->spare), named = file_bytes(w->path);
    const int64_t want = (have > named ? have : named) + snapshot_file_bytes(&w->layout, points);
    const int fd = file_open_no_follow(w->spare, O_WRONLY | O_CREAT);
    const int why = fd < 0 ? errno : posix_fallocate(fd, 0, (off_t)want);
    if (fd >= 0) close(fd);
    errno = why;
    return why == 0 || why == EOPNOTSUPP || why == EINVAL;
#else
    return true;
#endif
}

/* Brings the spare to the first `steps` snapshots of the named file (all of them: negative), then
 * appends one of `s`, unless that is NULL. */
static bool fill_spare(const struct snapshots *w, int64_t steps, struct simulation *s)
{
    const int64_t points = s ? count_points(s) : 0, room = s ? count_capacity(s) : 0;
    struct stat info;
    if (lstat(w->spare, &info) == 0 && !S_ISREG(info.st_mode)) unlink(w->spare);
    if (!claim_space(w, room)) return false;
    const bool is_named = access(w->path, F_OK) == 0;
    const hid_t named = is_named ? H5Fopen(w->path, H5F_ACC_RDONLY, H5P_DEFAULT) : -1;
    if (steps < 0) steps = named >= 0 ? snapshot_file_steps(named) : 0;
    const hid_t file = named >= 0 || !is_named ? open_spare(w, steps, points, named) : -1;
    const bool ok = file >= 0 &&
                    (named < 0 || snapshot_file_catch_up(&w->layout, named, file, steps)) &&
                    (!s || append_snapshot(&w->layout, file, s));
    if (named >= 0) H5Fclose(named);
    return (file < 0 || H5Fclose(file) >= 0) && ok;
}

/* HDF5 is mostly built for one thread: simulations in several take turns. */
static pthread_mutex_t turn = PTHREAD_MUTEX_INITIALIZER;

/* HDF5 prints what fails unless told otherwise; the setting belongs to the program, so it is put
 * back. */
struct quiet {
    H5E_auto2_t report;
    void *context;
};

static struct quiet quiet_begin(void)
{
    struct quiet q = {NULL, NULL};
    pthread_mutex_lock(&turn);
    H5Eget_auto2(H5E_DEFAULT, &q.report, &q.context);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    return q;
}

static void quiet_end(struct quiet q)
{
    H5Eset_auto2(H5E_DEFAULT, q.report, q.context);
    pthread_mutex_unlock(&turn);
}

/* Leaves the filled spare to be put in place. */
static enum err update(struct snapshots *w, int64_t steps, struct simulation *s, struct diag *d)
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
    placing_begin(&w->publishing, w->folder, w->path, w->spare);
    return ERR_OK;
}

enum err snapshots_create(struct snapshots *w, const char *folder, const struct scene *scene,
                          const char *version, struct diag *d)
{
    w->scene = scene;
    pthread_mutex_lock(&turn);
    w->layout = snapshot_file_layout(scene);
    pthread_mutex_unlock(&turn);
    w->version = version;
    TRY(path_join(w->folder, folder, ".", d));
    TRY(path_join(w->path, folder, "fields.vtkhdf", d));
    return path_join(w->spare, folder, "fields.vtkhdf.spare", d);
}

/* How many snapshots the named file holds, and how many of them up to `time`; the time of the last
 * of these. errno is ENOMEM where it is memory that is missing. */
static bool count_snapshots(const struct snapshots *w, double time, int64_t *all, int64_t *keep,
                            double *last)
{
    const hid_t file = H5Fopen(w->path, H5F_ACC_RDONLY, H5P_DEFAULT);
    *all = file >= 0 ? snapshot_file_steps(file) : -1;
    double *times = *all >= 0 ? malloc((size_t)(*all + 1) * sizeof *times) : NULL;
    const bool ok = times && snapshot_file_first(file, D_TIME, *all, times);
    for (*keep = 0; ok && *keep < *all && times[*keep] <= time; ++*keep) *last = times[*keep];
    const int why = *all >= 0 && !times ? ENOMEM : 0;
    free(times);
    if (file >= 0) H5Fclose(file);
    errno = why;
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
    const int why = errno;
    quiet_end(q);
    if (!counted && why == ENOMEM)
        return diag_fail(d, ERR_MEMORY, "%s: no memory to look at its snapshots", w->path);
    if (!counted)
        return diag_fail(d, ERR_INPUT,
                         "%s: cannot be read as snapshots; move it away to go on "
                         "without it",
                         w->path);
    if (keep == all) return ERR_OK;
    TRY(update(w, keep, NULL, d));
    TRY(snapshots_settle(w, d));
    unlink(w->spare);
    return ERR_OK;
}

enum err snapshots_settle(struct snapshots *w, struct diag *d)
{
    return publishing_end(&w->publishing, d);
}

enum err snapshots_write(struct snapshots *w, struct simulation *s, struct diag *d)
{
    TRY(snapshots_settle(w, d));
    simulation_refresh(s);
    return update(w, -1, s, d);
}

void snapshots_close(struct snapshots *w)
{
    struct diag unheard = {.code = ERR_OK};
    const enum err e = snapshots_settle(w, &unheard);
    (void)e;
    if (w->spare[0]) unlink(w->spare);
}
