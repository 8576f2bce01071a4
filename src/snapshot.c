/* SPDX-License-Identifier: MIT */
#include "snapshot.h"

#include "snapshot_file.h"

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

/* Values of a dataset of points, of one particle, where they are floating. */
static void real_values(enum data what, const struct simulation *s, enum kind kind, int64_t i,
                        double v[SNAPSHOT_WIDTH])
{
    const struct particles *p = &s->kind[kind];
    double sigma[4] = {0}, det = 1;
    const bool solid = kind == KIND_SOLID;
    if (solid && (what == D_STRESS || what == D_VON_MISES || what == D_DET_F || what == D_DENSITY))
        solid_cauchy(&s->solid, p, i, sigma, &det);
    memset(v, 0, SNAPSHOT_WIDTH * sizeof *v);
    switch (what) {
    case D_POINTS: v[0] = p->x[i], v[1] = p->y[i]; break;
    case D_VELOCITY: v[0] = p->vx[i], v[1] = p->vy[i]; break;
    case D_PRESSURE: v[0] = p->p ? p->p[i] : 0; break;
    case D_VON_MISES: v[0] = solid_von_mises(sigma); break;
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

/* What positions are rounded to beside fields in single precision, about 1e-6 dp, m: their last digits say
 * nothing, and packing them takes as long as packing all else. A power of two, so that they end in zeros. */
static double position_unit(const struct scene *scene)
{
    return ldexp(1, ilogb(scene->top.dp) - 20);
}

/* Fills the buffer, 8 bytes an item, with what the dataset gets; returns its rows. */
static int64_t gather(const struct snapshot_layout *layout, enum data what,
                      const struct simulation *s, void *buffer)
{
    const double unit = position_unit(s->scene);
    const bool rounded = what == D_POINTS && !layout->doubles;
    const int width = snapshot_file_width(what);
    const bool real = snapshot_file_real(what);
    int64_t row = 0;
    for (int kind = 0; kind < KIND_COUNT; kind++)
        for (int64_t i = 0; i < s->kind[kind].n; i++, row++) {
            double v[SNAPSHOT_WIDTH];
            if (real) {
                real_values(what, s, (enum kind)kind, i, v);
                for (int k = 0; rounded && k < 2; k++) v[k] = nearbyint(v[k] / unit) * unit;
                memcpy((double *)buffer + row * width, v, (size_t)width * sizeof *v);
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
    return snapshot_file_append(root, D_TIME, 1, &time) &&
           snapshot_file_append(root, D_POINTS_COUNT, 1, &n) &&
           snapshot_file_append(root, D_CELLS_COUNT, 1, &n) &&
           snapshot_file_append(root, D_IDS_COUNT, 1, &n) &&
           snapshot_file_append(root, D_PARTS_BEFORE, 1, &part) &&
           snapshot_file_append(root, D_PARTS, 1, &one) &&
           snapshot_file_append(root, D_POINTS_BEFORE, 1, &before) &&
           snapshot_file_append(root, D_CELLS_BEFORE, 1, &before) &&
           snapshot_file_append(root, D_IDS_BEFORE, 1, &before);
}

static int64_t count_points(const struct simulation *s)
{
    int64_t n = 0;
    for (int k = 0; k < KIND_COUNT; k++) n += s->kind[k].n;
    return n;
}

/* The most points that any snapshot has: fluid only ever leaves. */
static int64_t count_room(const struct simulation *s)
{
    int64_t n = 0;
    for (int k = 0; k < KIND_COUNT; k++) n += s->kind[k].capacity;
    return n;
}

static bool append_snapshot(const struct snapshot_layout *layout, hid_t file, struct simulation *s)
{
    int64_t rows[D_COUNT];
    const int64_t n = count_points(s);
    const int64_t steps = snapshot_file_steps(file);
    void *buffer = malloc((size_t)(n + 1) * SNAPSHOT_WIDTH * 8);
    const hid_t root = H5Gopen2(file, "VTKHDF", H5P_DEFAULT);
    bool ok = buffer && root >= 0 && steps >= 0 && snapshot_file_rows(file, steps, rows) &&
              append_step_rows(root, s->state.time, n, steps, rows[D_POINTS]);
    for (int k = D_POINTS; ok && k < D_COUNT; k++) {
        if (!layout->has[k]) continue;
        const int64_t count = gather(layout, (enum data)k, s, buffer);
        ok = snapshot_file_append(root, (enum data)k, count, buffer);
    }
    H5Gclose(root);
    free(buffer);
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
    const int fd = folder_open_file(w->spare, O_WRONLY | O_CREAT);
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
    const int64_t points = s ? count_points(s) : 0, room = s ? count_room(s) : 0;
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
    pthread_mutex_lock(&turn);
    w->layout = snapshot_file_layout(scene);
    pthread_mutex_unlock(&turn);
    w->version = version;
    TRY(folder_join(w->folder, folder, ".", d));
    TRY(folder_join(w->path, folder, "fields.vtkhdf", d));
    return folder_join(w->spare, folder, "fields.vtkhdf.spare", d);
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
