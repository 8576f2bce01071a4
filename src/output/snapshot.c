/* SPDX-License-Identifier: MIT
 * Appends snapshots to a spare copy that then replaces the file, also after a restart. */
#include "output/snapshot.h"
#include "base/threads.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* Points of this snapshot, or the most of any. */
static int64_t count_points(const struct simulation *sim, bool most)
{
    int64_t n = 0;
    for (int k = 0; k < KIND_COUNT; k++)
        n += most ? sim->particles[k].capacity : sim->particles[k].n;
    return n;
}

/* Opens the spare; creates it if there is none, it is damaged, or a reader still locks it. */
static hid_t open_spare(const struct snapshots *w, int64_t steps, int64_t points, hid_t named)
{
    hid_t file = access(w->spare, F_OK) == 0 ? H5Fopen(w->spare, H5F_ACC_RDWR, H5P_DEFAULT) : -1;
    int64_t rows[D_COUNT];
    const int64_t has = file >= 0 ? snapshot_file_steps(file) : -1;
    if (has >= 0 && has <= steps && snapshot_file_rows(file, has, rows)) return file;
    if (file >= 0) H5Fclose(file);
    unlink(w->spare);
    file = H5Fcreate(w->spare, H5F_ACC_EXCL, H5P_DEFAULT, H5P_DEFAULT);
    if (file >= 0 && !snapshot_file_create(file, w->scene, w->version, points, named)) {
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

/* Reserves the disk space that the spare can need: after a failed write HDF5 crashes at the end of
 * the program. HDF5 truncates the file to its real size when it closes it. */
static bool reserve_space(const struct snapshots *w, int64_t points)
{
#if _POSIX_ADVISORY_INFO > 0
    const int64_t spare = file_bytes(w->spare), named = file_bytes(w->path);
    const int64_t want = (spare > named ? spare : named) + snapshot_file_bytes(&w->layout, points);
    const int fd = file_open_no_follow(w->spare, O_WRONLY | O_CREAT);
    const int why = fd < 0 ? errno : posix_fallocate(fd, 0, (off_t)want);
    if (fd >= 0) close(fd);
    errno = why;
    return why == 0 || why == EOPNOTSUPP || why == EINVAL;
#else
    return true;
#endif
}

/* Copies to the spare what it lacks of the first `steps` snapshots of the named file (negative: of
 * all), then appends a snapshot of `sim`, unless that is NULL. */
static bool fill_spare(const struct snapshots *w, int64_t steps, struct simulation *sim)
{
    const int64_t points = sim ? count_points(sim, false) : 0,
                  most = sim ? count_points(sim, true) : 0;
    struct stat info;
    if (lstat(w->spare, &info) == 0 && !S_ISREG(info.st_mode)) unlink(w->spare);
    if (!reserve_space(w, most)) return false;
    const bool is_named = access(w->path, F_OK) == 0;
    const hid_t named = is_named ? H5Fopen(w->path, H5F_ACC_RDONLY, H5P_DEFAULT) : -1;
    if (steps < 0) steps = named >= 0 ? snapshot_file_steps(named) : 0;
    const hid_t file = named >= 0 || !is_named ? open_spare(w, steps, points, named) : -1;
    const bool ok = file >= 0 &&
                    (named < 0 || snapshot_file_copy_missing(&w->layout, named, file, steps)) &&
                    (!sim || snapshot_file_append(file, &w->layout, sim));
    if (named >= 0) H5Fclose(named);
    return (file < 0 || H5Fclose(file) >= 0) && ok;
}

/* HDF5 is seldom built thread-safe: simulations in several threads of a program exclude each other.
 * H5E_BEGIN_TRY turns off HDF5's own messages, which may be the user's, for its block. */
static pthread_mutex_t hdf5_mutex = PTHREAD_MUTEX_INITIALIZER;

static bool sync_file(const char *path)
{
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    const bool ok = fd >= 0 && fsync(fd) == 0;
    if (fd >= 0) close(fd);
    return ok;
}

/* Swaps the names of both files. The spare is synced before and the folder after the swap, so that
 * a power failure leaves a complete file. Without hard links the old file is deleted. */
static enum err swap_with_spare(const struct snapshots *w, struct diag *d)
{
    char old[PATH_BYTES];
    TRY(path_join(old, w->folder, "fields.vtkhdf.spare.old", d));
    unlink(old);
    const bool linked = link(w->path, old) == 0;
    if (!sync_file(w->spare) || rename(w->spare, w->path) != 0)
        return diag_fail(d, ERR_IO, "%s: cannot be replaced by %s: %s", w->path, w->spare,
                         strerror(errno));
    if (linked) rename(old, w->spare);
    return directory_sync(w->folder, d);
}

/* Fills the spare and swaps it with the named file. */
static enum err update(struct snapshots *w, int64_t steps, struct simulation *sim, struct diag *d)
{
    bool filled;
    int why;
    pthread_mutex_lock(&hdf5_mutex);
    errno = 0;
    H5E_BEGIN_TRY
    {
        filled = fill_spare(w, steps, sim);
        why = errno;
    }
    H5E_END_TRY
    pthread_mutex_unlock(&hdf5_mutex);
    if (!filled) {
        unlink(w->spare);
        return diag_fail(d, ERR_IO,
                         "%s: a snapshot cannot be written: %s; those before it are kept", w->path,
                         why ? strerror(why) : "HDF5 reports a failure");
    }
    return swap_with_spare(w, d);
}

enum err snapshots_create(struct snapshots *w, const char *folder, const struct scene *scene,
                          const char *version, struct diag *d)
{
    w->scene = scene;
    pthread_mutex_lock(&hdf5_mutex);
    w->layout = snapshot_file_layout(scene);
    pthread_mutex_unlock(&hdf5_mutex);
    w->version = version;
    TRY(path_join(w->folder, folder, ".", d));
    TRY(path_join(w->path, folder, "fields.vtkhdf", d));
    return path_join(w->spare, folder, "fields.vtkhdf.spare", d);
}

/* Counts the snapshots of the named file, and those up to `time`; `last`: the time of the last of
 * these. errno is ENOMEM if memory is missing. */
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
        diag_warn(d, "%s: does not exist; snapshots start at %.6g s", w->path, time);
        return ERR_OK;
    }
    int64_t all, keep;
    bool counted;
    int why;
    pthread_mutex_lock(&hdf5_mutex);
    H5E_BEGIN_TRY
    {
        counted = count_snapshots(w, time, &all, &keep, last);
        why = errno;
    }
    H5E_END_TRY
    pthread_mutex_unlock(&hdf5_mutex);
    if (!counted && why == ENOMEM)
        return diag_fail(d, ERR_MEMORY, "%s: no memory to count its snapshots", w->path);
    if (!counted)
        return diag_fail(d, ERR_INPUT,
                         "%s: cannot be read as snapshots; move it to another folder to continue "
                         "without it",
                         w->path);
    if (keep == all) return ERR_OK;
    TRY(update(w, keep, NULL, d));
    unlink(w->spare);
    return ERR_OK;
}

enum err snapshots_write(struct snapshots *w, struct simulation *sim, struct diag *d)
{
    simulation_refresh(sim);
    return update(w, -1, sim, d);
}

double snapshots_seconds(struct simulation *sim)
{
    double seconds = 0;
    const int64_t n = count_points(sim, false);
    simulation_refresh(sim);
    pthread_mutex_lock(&hdf5_mutex);
    H5E_BEGIN_TRY
    {
        const struct snapshot_layout layout = snapshot_file_layout(sim->scene);
        const hid_t memory = H5Pcreate(H5P_FILE_ACCESS);
        H5Pset_fapl_core(memory, 1 << 20, false);
        const hid_t file = H5Fcreate("memory", H5F_ACC_TRUNC, H5P_DEFAULT, memory),
                    spare = H5Fcreate("spare", H5F_ACC_TRUNC, H5P_DEFAULT, memory);
        bool ok = snapshot_file_create(file, sim->scene, "", n, -1) &&
                  snapshot_file_create(spare, sim->scene, "", n, file);
        const double begin = thread_clock();
        ok = ok && snapshot_file_append(file, &layout, sim) &&
             snapshot_file_copy_missing(&layout, file, spare, 1);
        H5Fclose(file);
        H5Fclose(spare);
        if (ok) seconds = thread_clock() - begin;
        H5Pclose(memory);
    }
    H5E_END_TRY
    pthread_mutex_unlock(&hdf5_mutex);
    return seconds;
}

void snapshots_close(struct snapshots *w)
{
    if (w->spare[0]) unlink(w->spare);
}
