/* SPDX-License-Identifier: MIT
 * The folder of a run: created, locked against a second run, and never overwritten. */
#pragma once

#include "base/files.h"

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

/* Creates the folder and its parents, checks it as run_dir_check does, and locks it until
 * run_dir_close or the end of the process. */
enum err run_dir_open(struct run_dir *dir, const char *path, enum run_dir_use use, struct diag *d)
    SPHFSI_CHECKED;
void run_dir_close(struct run_dir *dir);
/* Closes it, and removes the folders that run_dir_open has made, as far as they are empty. */
void run_dir_withdraw(struct run_dir *dir);
