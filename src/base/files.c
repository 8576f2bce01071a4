/* SPDX-License-Identifier: MIT
 * Reads files whole, and replaces them under a temporary name that is synced and renamed. */
#include "base/files.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

enum err path_join(char path[PATH_BYTES], const char *folder, const char *name, struct diag *d)
{
    const int length = snprintf(path, PATH_BYTES, "%s/%s", folder, name);
    if (length >= 0 && length < PATH_BYTES) return ERR_OK;
    return diag_fail(d, ERR_INPUT,
                     "%.80s.../%s: the path has %d characters, but at most %d are allowed", folder,
                     name, length, PATH_BYTES - 1);
}

int file_open_no_follow(const char *path, int flags)
{
    return open(path, flags | O_NOFOLLOW | O_CLOEXEC, 0666);
}

const char *file_error_text(int error)
{
    return error == ELOOP ? "it is a symbolic link, and files are not written through links"
                          : strerror(error);
}

enum err directory_sync(const char *path, struct diag *d)
{
    const int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0)
        return diag_fail(d, ERR_IO, "%s: cannot open the folder: %s", path, strerror(errno));
    /* EINVAL: the file system cannot sync folders. */
    const bool failed = fsync(fd) != 0 && errno != EINVAL;
    const int why = errno;
    close(fd);
    return failed ? diag_fail(d, ERR_IO, "%s: cannot sync the folder: %s", path, strerror(why))
                  : ERR_OK;
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
    /* O_NONBLOCK: opening a pipe would wait for its writer. */
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

enum err text_read(const char *path, const char *shown, const char *what, char **text,
                   struct diag *d)
{
    struct diag why = {.code = ERR_OK};
    size_t size;
    const enum err e = file_read(path, text, &size, &why);
    if (e) return diag_fail(d, e == ERR_MEMORY ? e : ERR_INPUT, "%s", why.text);
    const size_t length = strlen(*text);
    if (length == size) return ERR_OK;
    int line = 1;
    for (size_t k = 0; k < length; k++) line += (*text)[k] == '\n';
    const bool wide = strncmp(*text, "\xFF\xFE", 2) == 0 || strncmp(*text, "\xFE\xFF", 2) == 0;
    diag_fail(d, ERR_INPUT, "%s:%d: a byte of value 0; %s is plain text%s", shown, line, what,
              wide ? ", not UTF-16: save it as UTF-8" : "");
    free(*text);
    *text = NULL;
    return ERR_INPUT;
}

enum err atomic_file_open(struct atomic_file *out, const char *folder, const char *name,
                          struct diag *d)
{
    char part_name[300];
    snprintf(part_name, sizeof part_name, "%s.part", name);
    out->file = NULL;
    TRY(path_join(out->path, folder, name, d));
    TRY(path_join(out->part, folder, part_name, d));
    unlink(out->part); /* a killed run may have left one */
    const int fd = file_open_no_follow(out->part, O_WRONLY | O_CREAT | O_EXCL);
    out->file = fd >= 0 ? fdopen(fd, "wb") : NULL;
    if (out->file) return ERR_OK;
    diag_fail(d, ERR_IO, "%s: cannot be written: %s", out->part, file_error_text(errno));
    if (fd >= 0) close(fd);
    return ERR_IO;
}

void atomic_file_abandon(struct atomic_file *out)
{
    if (!out->file) return;
    fclose(out->file);
    unlink(out->part);
    out->file = NULL;
}

enum err atomic_file_commit(struct atomic_file *out, struct diag *d)
{
    ASSERT(out->file);
    errno = 0;
    if (ferror(out->file) || fflush(out->file) != 0 || fsync(fileno(out->file)) != 0) {
        const int why = errno ? errno : EIO;
        atomic_file_abandon(out);
        return diag_fail(d, ERR_IO, "%s: cannot be written: %s", out->path, strerror(why));
    }
    const bool closed = fclose(out->file) == 0;
    out->file = NULL;
    if (!closed || rename(out->part, out->path) != 0) {
        const int why = errno;
        unlink(out->part);
        return diag_fail(d, ERR_IO, "%s: cannot be replaced by %s: %s", out->path, out->part,
                         strerror(why));
    }
    char folder[PATH_BYTES];
    snprintf(folder, sizeof folder, "%s", out->path);
    *strrchr(folder, '/') = '\0';
    return directory_sync(folder, d);
}
