/* SPDX-License-Identifier: MIT
 * The folder of a run: made, locked against a second run, never overwritten; and files that are
 * written beside and renamed, so that a reader sees the old one or the new one. */
#ifndef SPHFSI_FOLDER_H
#define SPHFSI_FOLDER_H

#include "base.h"

#include <stdio.h>

enum { FOLDER_PATH = 4096 };

enum folder_use {
    FOLDER_FRESH,   /* refuse a folder that holds results */
    FOLDER_CONTINUE /* it must exist */
};

struct folder {
    char path[FOLDER_PATH];
    int lock; /* descriptor of the locked file; -1: none */
};

/* Writes "folder/name" to `path`. ERR_INPUT if that is longer than a path may be. */
enum err folder_join(char path[FOLDER_PATH], const char *folder, const char *name, struct diag *d)
    SPHFSI_CHECKED;

/* Whether the folder may be used so; looks only, changes nothing. */
enum err folder_check(const char *path, enum folder_use use, struct diag *d) SPHFSI_CHECKED;

/* Makes the folder and those above it, checks as folder_check, and locks it until folder_close or
 * the end of the process, however that comes. */
enum err folder_open(struct folder *f, const char *path, enum folder_use use, struct diag *d)
    SPHFSI_CHECKED;
void folder_close(struct folder *f);

/* Opens a file of a run's folder to write it, as open does; ELOOP if it is a symbolic link. */
int folder_open_file(const char *path, int flags);

/* strerror, but for that. */
const char *folder_why(int error);

/* Makes renames and removals in the folder last through a power cut. */
enum err folder_sync(const char *path, struct diag *d) SPHFSI_CHECKED;

/* A file being written beside the one it will replace. */
struct beside {
    char path[FOLDER_PATH], part[FOLDER_PATH];
    FILE *file;
};

enum err beside_open(struct beside *b, const char *folder, const char *name, struct diag *d)
    SPHFSI_CHECKED;
/* Flushes, syncs, closes and renames; on failure removes what was written and leaves the old file. */
enum err beside_commit(struct beside *b, struct diag *d) SPHFSI_CHECKED;
void beside_abandon(struct beside *b);

/* Reads a whole file; `bytes` is malloc'd, followed by a 0 that is not counted in `size`. */
enum err file_read(const char *path, char **bytes, size_t *size, struct diag *d) SPHFSI_CHECKED;

#endif
