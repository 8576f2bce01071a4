/* SPDX-License-Identifier: MIT
 * The folder of a run: made, locked against a second run, never overwritten; and files that are
 * written beside and renamed, so that a reader sees the old one or the new one. */
#ifndef SPHFSI_BASE_RUN_DIR_H
#define SPHFSI_BASE_RUN_DIR_H

#include "base/base.h"

#include <stdio.h>

enum { RUN_DIR_PATH = 4096 };

enum run_dir_use {
    RUN_DIR_FRESH,   /* refuse a folder that holds results */
    RUN_DIR_CONTINUE /* it must exist */
};

struct run_dir {
    char path[RUN_DIR_PATH];
    int lock; /* descriptor of the locked file; -1: none */
};

/* Writes "folder/name" to `path`. ERR_INPUT if that is longer than a path may be. */
enum err path_join(char path[RUN_DIR_PATH], const char *folder, const char *name, struct diag *d)
    SPHFSI_CHECKED;

/* Whether the folder may be used so; looks only, changes nothing. */
enum err run_dir_check(const char *path, enum run_dir_use use, struct diag *d) SPHFSI_CHECKED;

/* Makes the folder and those above it, checks as run_dir_check, and locks it until run_dir_close or
 * the end of the process, however that comes. */
enum err run_dir_open(struct run_dir *f, const char *path, enum run_dir_use use, struct diag *d)
    SPHFSI_CHECKED;
void run_dir_close(struct run_dir *f);

/* Opens a file of a run's folder to write it, as open does; ELOOP if it is a symbolic link. */
int run_dir_open_file(const char *path, int flags);

/* strerror, but for that. */
const char *run_dir_why(int error);

/* Makes renames and removals in the folder last through a power cut. */
enum err run_dir_sync(const char *path, struct diag *d) SPHFSI_CHECKED;

/* A file being written beside the one it will replace. */
struct atomic_file {
    char path[RUN_DIR_PATH], part[RUN_DIR_PATH];
    FILE *file;
};

enum err atomic_file_open(struct atomic_file *b, const char *folder, const char *name,
                          struct diag *d) SPHFSI_CHECKED;
/* Flushes, syncs, closes and renames; on failure removes what was written and leaves the old file. */
enum err atomic_file_commit(struct atomic_file *b, struct diag *d) SPHFSI_CHECKED;
void atomic_file_abandon(struct atomic_file *b);

/* Reads a whole file; `bytes` is malloc'd, followed by a 0 that is not counted in `size`. */
enum err file_read(const char *path, char **bytes, size_t *size, struct diag *d) SPHFSI_CHECKED;

#endif
