/* SPDX-License-Identifier: MIT
 * The CSV files of probes and ledger: rows are appended, and cut off where a restart begins. */
#include "output/rows.h"
#include "base/csv.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

/* One write() per row, so that a killed run leaves complete rows. */
static enum err append(struct series *s, const char *text, size_t length, struct diag *d)
{
    const ssize_t written = write(s->fd, text, length);
    if (written == (ssize_t)length) return ERR_OK;
    diag_fail(d, ERR_IO, "%s: cannot be written: %s", s->path,
              strerror(written < 0 ? errno : ENOSPC));
    if (written > 0 && ftruncate(s->fd, lseek(s->fd, 0, SEEK_END) - written) != 0)
        diag_warn(d, "%s: ends in an incomplete row, which a restart drops", s->path);
    return ERR_IO;
}

static enum err begin(struct series *s, const char *folder, const char *name, const char *header,
                      struct diag *d)
{
    s->fd = -1;
    s->columns = slice_count(slice_of(header), ',');
    return path_join(s->path, folder, name, d);
}

enum err series_create(struct series *s, const char *folder, const char *name, const char *header,
                       struct diag *d)
{
    TRY(begin(s, folder, name, header, d));
    s->fd = file_open_no_follow(s->path, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND);
    if (s->fd < 0)
        return diag_fail(d, ERR_IO, "%s: cannot be written: %s", s->path, file_error_text(errno));
    TRY(append(s, header, strlen(header), d));
    return append(s, "\n", 1, d);
}

/* Length of the rows up to `time` from `at` on; a row without a newline is incomplete. */
static size_t rows_until(const char *at, double time, const char **first, double *last)
{
    const char *const start = at;
    for (const char *end; (end = strchr(at, '\n')) != NULL; at = end + 1) {
        char *stop;
        const double t = strtod(at, &stop);
        if (stop == at || !(t <= time)) break;
        if (!*first) *first = at;
        *last = t;
    }
    return (size_t)(at - start);
}

static enum err read_first(struct series *s, const char *row, double *first, struct diag *d)
{
    for (int k = 0; k < s->columns; k++) {
        char *stop = NULL;
        first[k] = row ? strtod(row, &stop) : 0;
        if (!row || stop == row)
            return diag_fail(d, ERR_IO, "%s: has no complete first row of %d numbers", s->path,
                             s->columns);
        row = stop + (*stop == ',');
    }
    return ERR_OK;
}

static enum err cut(struct series *s, const char *bytes, const char *header, double time,
                    double *first, double *last, struct diag *d)
{
    const size_t length = strlen(header);
    if (strncmp(bytes, header, length) != 0 || bytes[length] != '\n')
        return diag_fail(d, ERR_IO, "%s: has the columns '%.*s', but this case writes '%s'",
                         s->path, (int)strcspn(bytes, "\n"), bytes, header);
    const char *row = NULL;
    *last = -1;
    const size_t keep = length + 1 + rows_until(bytes + length + 1, time, &row, last);
    if (first) TRY(read_first(s, row, first, d));
    s->fd = file_open_no_follow(s->path, O_WRONLY | O_APPEND);
    if (s->fd < 0 || ftruncate(s->fd, (off_t)keep) != 0)
        return diag_fail(d, ERR_IO, "%s: cannot be written: %s", s->path, file_error_text(errno));
    return ERR_OK;
}

enum err series_resume(struct series *s, const char *folder, const char *name, const char *header,
                       double time, double *first, double *last, struct diag *d)
{
    TRY(begin(s, folder, name, header, d));
    char *bytes;
    size_t size;
    TRY(file_read(s->path, &bytes, &size, d));
    const enum err e = cut(s, bytes, header, time, first, last, d);
    free(bytes);
    return e;
}

enum err series_row(struct series *s, const double *values, struct diag *d)
{
    char row[SERIES_MAX_COLUMNS * NUMBER_TEXT];
    size_t length = 0;
    for (int k = 0; k < s->columns; k++) {
        length += (size_t)number_text(row + length, values[k]);
        row[length++] = k + 1 < s->columns ? ',' : '\n';
    }
    return s->fd < 0 ? ERR_OK : append(s, row, length, d);
}

enum err series_sync(const struct series *s, struct diag *d)
{
    /* EINVAL: a pipe or another file that cannot be synced. */
    if (s->fd < 0 || fsync(s->fd) == 0 || errno == EINVAL) return ERR_OK;
    return diag_fail(d, ERR_IO, "%s: cannot be synced: %s", s->path, strerror(errno));
}

void series_close(struct series *s)
{
    if (s->fd >= 0) close(s->fd);
    s->fd = -1;
}
