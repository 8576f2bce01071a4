/* SPDX-License-Identifier: MIT
 * A file takes the name of another, and neither is broken at any moment, not by a power cut either: the file
 * is synced before, the folder after. A thread of its own waits for the disk, some milliseconds each time. */
#ifndef SPHFSI_OUTPUT_PUBLISH_H
#define SPHFSI_OUTPUT_PUBLISH_H

#include <pthread.h>

#include "base/base.h"

/* A zeroed one has nothing under way. */
struct publishing {
    const char *folder, *path, *spare;
    pthread_t thread;
    bool begun, threaded; /* whether something is to be waited for, and whether by a thread */
    struct diag diag;     /* the thread's */
};

/* Begins to give the spare the name `path`; the file that has it becomes the spare. Where a file system has
 * no links the old one is gone. The texts stay the caller's, and as they are until the end. */
void placing_begin(struct publishing *p, const char *folder, const char *path, const char *spare);

/* Waits for it and says how it went; nothing under way: well. */
enum err publishing_end(struct publishing *p, struct diag *d);

#endif
