/* SPDX-License-Identifier: MIT
 * Files: paths, whole-file reads, and atomic replacement (a reader sees the old file or the new
 * one). */
#pragma once

#include "base/base.h"

enum { PATH_BYTES = 4096 };

/* Writes "folder/name" to `path`. ERR_INPUT if that exceeds PATH_BYTES. */
enum err path_join(char path[PATH_BYTES], const char *folder, const char *name, struct diag *d)
    SPHFSI_CHECKED;

/* As open(), but ELOOP on a symbolic link, which must not redirect the output of a run. */
int file_open_no_follow(const char *path, int flags);

/* strerror(), except that ELOOP is explained as file_open_no_follow means it. */
const char *file_error_text(int error);

/* Makes renames and removals in a folder survive a power failure. */
enum err directory_sync(const char *path, struct diag *d) SPHFSI_CHECKED;

/* Reads a whole file; `bytes` is malloc'd and followed by a 0 that `size` does not count. */
enum err file_read(const char *path, char **bytes, size_t *size, struct diag *d) SPHFSI_CHECKED;

/* Reads a whole text file, ending with a 0; `shown` is its name in messages, `what` says what it
 * should be. Any failure but of memory is ERR_INPUT. */
enum err text_read(const char *path, const char *shown, const char *what, char **text,
                   struct diag *d) SPHFSI_CHECKED;

/* A file that is written as PATH.part and renamed to PATH when complete. */
struct atomic_file {
    char path[PATH_BYTES], part[PATH_BYTES];
    FILE *file; /* open for writing; NULL: closed */
};

enum err atomic_file_open(struct atomic_file *out, const char *folder, const char *name,
                          struct diag *d) SPHFSI_CHECKED;
/* Flushes, syncs, closes and renames. On failure it removes the part and keeps the old file. */
enum err atomic_file_commit(struct atomic_file *out, struct diag *d) SPHFSI_CHECKED;
void atomic_file_abandon(struct atomic_file *out);

/* --- run_dir.c: the folder of a run: created, locked, never overwritten --- */

enum run_dir_use {
    RUN_DIR_FRESH,   /* must not hold results */
    RUN_DIR_CONTINUE /* must exist */
};

struct run_dir {
    char path[PATH_BYTES];
    int lock;    /* descriptor of the lock file; -1: none */
    size_t made; /* length of the first part of the path that was made; 0: all were there */
};

/* Whether the folder may be used so; changes nothing. */
enum err run_dir_check(const char *path, enum run_dir_use use, struct diag *d) SPHFSI_CHECKED;

/* Creates the folder, checks it as run_dir_check does, and locks it until run_dir_close. */
enum err run_dir_open(struct run_dir *dir, const char *path, enum run_dir_use use, struct diag *d)
    SPHFSI_CHECKED;
void run_dir_close(struct run_dir *dir);
/* Closes it, and removes the folders that run_dir_open has made, as far as they are empty. */
void run_dir_withdraw(struct run_dir *dir);
