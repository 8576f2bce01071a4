/* SPDX-License-Identifier: MIT
 * The folder of a run: created once, locked while a run writes to it. */
#include "base/files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static const char lock_name[] = ".lock";

static bool is_result(const char *name)
{
    static const char *const results[] = {"summary.json", "probes.csv", "ledger.csv",
                                          "fields.vtkhdf", "case.cfg"};
    static const char checkpoint[] = ".ckpt";
    const size_t length = strlen(name), ending = sizeof checkpoint - 1;
    for (size_t k = 0; k < COUNT_OF(results); k++)
        if (strcmp(name, results[k]) == 0) return true;
    return length >= ending && strcmp(name + length - ending, checkpoint) == 0;
}

enum err run_dir_check(const char *path, enum run_dir_use use, struct diag *d)
{
    enum { LONGEST = PATH_BYTES - 301 }; /* names of files follow */
    if (!*path || strlen(path) > LONGEST)
        return diag_fail(d, ERR_INPUT,
                         "folder of the run: the path has %zu characters, but 1 to %d are allowed",
                         strlen(path), LONGEST);
    DIR *dir = opendir(path);
    if (!dir && errno == ENOENT && use == RUN_DIR_FRESH) return ERR_OK;
    if (!dir && errno == ENOENT)
        return diag_fail(d, ERR_INPUT, "%s: there is no such folder, so there is no run to restart",
                         path);
    if (!dir)
        return diag_fail(d, ERR_INPUT, "%s: cannot be used as the folder of a run: %s", path,
                         strerror(errno));
    char name[256] = "";
    for (const struct dirent *entry; !*name && (entry = readdir(dir)) != NULL;)
        if (is_result(entry->d_name)) snprintf(name, sizeof name, "%s", entry->d_name);
    closedir(dir);
    if (*name && use == RUN_DIR_FRESH)
        return diag_fail(
            d, ERR_INPUT,
            "%s: contains the results of a run (%s), which are not overwritten; continue it with "
            "--restart, choose another folder with --out, or remove it",
            path, name);
    return ERR_OK;
}

/* mkdir -p. `made`: length of the first part of the path that was made; 0: none. */
static enum err make_directories(const char *path, size_t *made, struct diag *d)
{
    char part[PATH_BYTES];
    snprintf(part, sizeof part, "%s", path);
    for (char *at = part + 1;; at++) {
        if (*at != '/' && *at != '\0') continue;
        const char end = *at;
        *at = '\0';
        struct stat info;
        const bool is_new = mkdir(part, 0777) == 0;
        if (is_new && *made == 0) *made = (size_t)(at - part);
        if (!is_new && (stat(part, &info) != 0 || !S_ISDIR(info.st_mode)))
            return diag_fail(d, ERR_INPUT, "%s: cannot make the folder%s%s: %s", path,
                             end ? " above it, " : "", end ? part : "", strerror(errno));
        *at = end;
        if (!end) return ERR_OK;
    }
}

static enum err fail_locked(const struct run_dir *dir, int fd, struct diag *d)
{
    char owner[32] = "";
    const ssize_t got = read(fd, owner, sizeof owner - 1);
    owner[got > 0 ? strcspn(owner, "\n") : 0] = '\0';
    return diag_fail(d, ERR_INPUT,
                     "%s: another run (process %s) is writing there; wait for it, or "
                     "choose another folder with --out",
                     dir->path, owner[0] ? owner : "unknown");
}

/* Locks the lock file. Its owner may unlink it, when it ends, after it was opened here: then the
 * lock is on a file without a name, and the loop tries again. */
static enum err lock_run_dir(struct run_dir *dir, struct diag *d)
{
    char path[PATH_BYTES];
    TRY(path_join(path, dir->path, lock_name, d));
    for (;;) {
        const int fd = file_open_no_follow(path, O_RDWR | O_CREAT);
        if (fd < 0)
            return diag_fail(d, ERR_INPUT, "%s: cannot be written: %s", path,
                             file_error_text(errno));
        if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
            const int why = errno;
            const enum err e = why == EWOULDBLOCK ? fail_locked(dir, fd, d) : ERR_OK;
            close(fd);
            if (!e)
                diag_warn(d, "%s: cannot be locked (%s); make sure that no second run writes there",
                          dir->path, strerror(why));
            return e;
        }
        struct stat mine, named;
        const bool opened = fstat(fd, &mine) == 0, there = opened && stat(path, &named) == 0;
        if (!there && (!opened || errno != ENOENT)) {
            diag_fail(d, ERR_IO, "%s: cannot be looked up: %s", path, strerror(errno));
            close(fd);
            return ERR_IO;
        }
        if (there && mine.st_ino == named.st_ino) {
            if (ftruncate(fd, 0) != 0 || dprintf(fd, "%ld\n", (long)getpid()) < 0)
                diag_warn(d,
                          "%s: cannot write the process ID, so a second run cannot say which "
                          "process holds the folder: %s",
                          path, strerror(errno));
            dir->lock = fd;
            return ERR_OK;
        }
        close(fd);
    }
}

enum err run_dir_open(struct run_dir *dir, const char *path, enum run_dir_use use, struct diag *d)
{
    dir->lock = -1;
    dir->made = 0;
    TRY(run_dir_check(path, use, d));
    memcpy(dir->path, path, strlen(path) + 1);
    for (char *last = dir->path + strlen(path) - 1; last > dir->path && *last == '/'; last--)
        *last = '\0';
    if (use == RUN_DIR_FRESH) TRY(make_directories(dir->path, &dir->made, d));
    TRY(lock_run_dir(dir, d));
    /* Another run may have started and ended between the check and the lock. */
    const enum err e = run_dir_check(path, use, d);
    if (e) run_dir_close(dir);
    return e;
}

void run_dir_close(struct run_dir *dir)
{
    if (dir->lock < 0) return;
    char path[PATH_BYTES];
    if (path_join(path, dir->path, lock_name, NULL) == ERR_OK) unlink(path);
    close(dir->lock);
    dir->lock = -1;
}

void run_dir_withdraw(struct run_dir *dir)
{
    char path[PATH_BYTES];
    run_dir_close(dir);
    snprintf(path, sizeof path, "%s", dir->path);
    size_t n = strlen(path);
    while (dir->made > 0 && n >= dir->made && rmdir(path) == 0) {
        while (n > 0 && path[n - 1] != '/') n--;
        while (n > 0 && path[n - 1] == '/') n--;
        path[n] = '\0';
    }
}
