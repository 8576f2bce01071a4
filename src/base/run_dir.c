/* SPDX-License-Identifier: MIT */
#include "base/run_dir.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static const char lock_name[] = ".lock";

/* Nothing outside of the folder is written, so a link that lies there is not written through. */
int run_dir_open_file(const char *path, int flags)
{
    return open(path, flags | O_NOFOLLOW | O_CLOEXEC, 0666);
}

const char *run_dir_why(int error)
{
    return error == ELOOP ? "it is a symbolic link, which is not written through" : strerror(error);
}

enum err path_join(char path[RUN_DIR_PATH], const char *folder, const char *name, struct diag *d)
{
    const int length = snprintf(path, RUN_DIR_PATH, "%s/%s", folder, name);
    if (length >= 0 && length < RUN_DIR_PATH) return ERR_OK;
    return diag_fail(d, ERR_INPUT,
                     "%.80s.../%s: the path has %d characters, at most %d are possible", folder,
                     name, length, RUN_DIR_PATH - 1);
}

static bool ends_with(const char *text, const char *end)
{
    const size_t n = strlen(text), m = strlen(end);
    return n >= m && strcmp(text + n - m, end) == 0;
}

static bool is_result(const char *name)
{
    static const char *const results[] = {"summary.json", "probes.csv", "ledger.csv",
                                          "fields.vtkhdf", "case.cfg"};
    for (size_t k = 0; k < COUNT_OF(results); k++)
        if (strcmp(name, results[k]) == 0) return true;
    return ends_with(name, ".ckpt");
}

/* Name of a result in the folder, or false. */
static bool find_result(DIR *dir, char name[256])
{
    for (const struct dirent *entry; (entry = readdir(dir)) != NULL;)
        if (is_result(entry->d_name)) {
            snprintf(name, 256, "%s", entry->d_name);
            return true;
        }
    return false;
}

enum err run_dir_check(const char *path, enum run_dir_use use, struct diag *d)
{
    DIR *dir = opendir(path);
    if (!dir && errno == ENOENT && use == RUN_DIR_FRESH) return ERR_OK;
    if (!dir && errno == ENOENT)
        return diag_fail(d, ERR_INPUT, "%s: there is no such folder, so no run to restart", path);
    if (!dir)
        return diag_fail(d, ERR_INPUT, "%s: cannot be used as the folder of a run: %s", path,
                         strerror(errno));
    char name[256];
    const bool found = find_result(dir, name);
    closedir(dir);
    if (found && use == RUN_DIR_FRESH)
        return diag_fail(d, ERR_INPUT,
                         "%s: holds a run already (%s), which is not overwritten; continue it with "
                         "--restart, choose another folder with --out, or remove it",
                         path, name);
    return ERR_OK;
}

/* mkdir -p. */
static enum err make_directories(const char *path, struct diag *d)
{
    char part[RUN_DIR_PATH];
    snprintf(part, sizeof part, "%s", path);
    for (char *at = part + 1;; at++) {
        if (*at != '/' && *at != '\0') continue;
        const char end = *at;
        *at = '\0';
        struct stat info;
        if (mkdir(part, 0777) != 0 && (stat(part, &info) != 0 || !S_ISDIR(info.st_mode)))
            return diag_fail(d, ERR_INPUT, "%s: cannot make the folder%s%s: %s", path,
                             end ? " above it, " : "", end ? part : "", strerror(errno));
        *at = end;
        if (!end) return ERR_OK;
    }
}

static enum err lock_busy(const struct run_dir *f, int fd, struct diag *d)
{
    char owner[32] = "";
    const ssize_t got = read(fd, owner, sizeof owner - 1);
    owner[got > 0 ? strcspn(owner, "\n") : 0] = '\0';
    return diag_fail(d, ERR_INPUT,
                     "%s: another run (process %s) is writing there; wait for it, or "
                     "choose another folder with --out",
                     f->path, owner[0] ? owner : "unknown");
}

/* Locks the file that has the name now: one that its owner unlinked after we opened it, while it
 * ended, is tried again. */
static enum err lock_run_dir(struct run_dir *f, struct diag *d)
{
    char path[RUN_DIR_PATH];
    TRY(path_join(path, f->path, lock_name, d));
    for (;;) {
        const int fd = run_dir_open_file(path, O_RDWR | O_CREAT);
        if (fd < 0)
            return diag_fail(d, ERR_INPUT, "%s: cannot be written: %s", path, run_dir_why(errno));
        if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
            const int why = errno;
            const enum err e = why == EWOULDBLOCK ? lock_busy(f, fd, d) : ERR_OK;
            close(fd);
            if (!e)
                diag_warn(d, "%s: cannot be locked (%s); see that no second run writes there",
                          f->path, strerror(why));
            return e;
        }
        struct stat mine, named;
        if (fstat(fd, &mine) == 0 && stat(path, &named) == 0 && mine.st_ino == named.st_ino) {
            if (ftruncate(fd, 0) != 0 || dprintf(fd, "%ld\n", (long)getpid()) < 0)
                diag_warn(d, "%s: cannot write the process number: %s", path, strerror(errno));
            f->lock = fd;
            return ERR_OK;
        }
        close(fd);
    }
}

enum err run_dir_open(struct run_dir *f, const char *path, enum run_dir_use use, struct diag *d)
{
    f->lock = -1;
    const size_t length = strlen(path);
    if (length == 0 || length >= sizeof f->path - 64)
        return diag_fail(d, ERR_INPUT,
                         "folder of the run: the path has %zu characters, from 1 to "
                         "%zu are possible",
                         length, sizeof f->path - 65);
    memcpy(f->path, path, length + 1);
    if (use == RUN_DIR_FRESH) TRY(make_directories(path, d));
    TRY(run_dir_check(path, use, d));
    TRY(lock_run_dir(f, d));
    /* Another run may have come and gone between the look and the lock. */
    const enum err e = run_dir_check(path, use, d);
    if (e) run_dir_close(f);
    return e;
}

void run_dir_close(struct run_dir *f)
{
    if (f->lock < 0) return;
    char path[RUN_DIR_PATH];
    if (path_join(path, f->path, lock_name, NULL) == ERR_OK) unlink(path);
    close(f->lock);
    f->lock = -1;
}

enum err run_dir_sync(const char *path, struct diag *d)
{
    const int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0)
        return diag_fail(d, ERR_IO, "%s: cannot open the folder: %s", path, strerror(errno));
    /* Some file systems do not sync folders and say EINVAL; there is nothing better to do there. */
    const bool failed = fsync(fd) != 0 && errno != EINVAL;
    const int why = errno;
    close(fd);
    return failed ? diag_fail(d, ERR_IO, "%s: cannot sync the folder: %s", path, strerror(why))
                  : ERR_OK;
}

enum err atomic_file_open(struct atomic_file *b, const char *folder, const char *name,
                          struct diag *d)
{
    char part_name[300];
    snprintf(part_name, sizeof part_name, "%s.part", name);
    b->file = NULL;
    TRY(path_join(b->path, folder, name, d));
    TRY(path_join(b->part, folder, part_name, d));
    unlink(b->part); /* of a run that was killed, or a link */
    const int fd = run_dir_open_file(b->part, O_WRONLY | O_CREAT | O_EXCL);
    b->file = fd >= 0 ? fdopen(fd, "wb") : NULL;
    if (b->file) return ERR_OK;
    diag_fail(d, ERR_IO, "%s: cannot be written: %s", b->part, run_dir_why(errno));
    if (fd >= 0) close(fd);
    return ERR_IO;
}

void atomic_file_abandon(struct atomic_file *b)
{
    if (!b->file) return;
    fclose(b->file);
    unlink(b->part);
    b->file = NULL;
}

enum err atomic_file_commit(struct atomic_file *b, struct diag *d)
{
    errno = 0;
    if (ferror(b->file) || fflush(b->file) != 0 || fsync(fileno(b->file)) != 0) {
        const int why = errno ? errno : EIO;
        atomic_file_abandon(b);
        return diag_fail(d, ERR_IO, "%s: cannot be written: %s", b->path, strerror(why));
    }
    const bool closed = fclose(b->file) == 0;
    b->file = NULL;
    if (!closed || rename(b->part, b->path) != 0) {
        const int why = errno;
        unlink(b->part);
        return diag_fail(d, ERR_IO, "%s: cannot be put in place: %s", b->path, strerror(why));
    }
    char folder[RUN_DIR_PATH];
    snprintf(folder, sizeof folder, "%s", b->path);
    *strrchr(folder, '/') = '\0';
    return run_dir_sync(folder, d);
}

static enum err read_open(FILE *file, const char *path, char **bytes, size_t *size, struct diag *d)
{
    struct stat info;
    if (fstat(fileno(file), &info) != 0)
        return diag_fail(d, ERR_IO, "%s: cannot be read: %s", path, strerror(errno));
    if (!S_ISREG(info.st_mode)) return diag_fail(d, ERR_IO, "%s: is not a file", path);
    const size_t want = (size_t)info.st_size;
    char *memory = malloc(want + 1);
    if (!memory) return diag_fail(d, ERR_MEMORY, "%s: no memory for its %zu bytes", path, want);
    if (fread(memory, 1, want, file) != want) {
        free(memory);
        return diag_fail(d, ERR_IO, "%s: ends before its %zu bytes, or cannot be read", path, want);
    }
    memory[want] = '\0';
    *bytes = memory;
    *size = want;
    return ERR_OK;
}

enum err file_read(const char *path, char **bytes, size_t *size, struct diag *d)
{
    /* Opening a pipe would wait for whoever writes to it. */
    const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    FILE *file = fd >= 0 ? fdopen(fd, "rb") : NULL;
    if (!file) {
        const enum err e = errno == ENOMEM ? ERR_MEMORY : ERR_IO;
        diag_fail(d, e, "%s: cannot be read: %s", path, strerror(errno));
        if (fd >= 0) close(fd);
        return e;
    }
    const enum err e = read_open(file, path, bytes, size, d);
    fclose(file);
    return e;
}
