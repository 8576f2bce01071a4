/* SPDX-License-Identifier: MIT
 * Swaps a finished file with the one of the final name, in a thread of its own, since syncing takes some
 * milliseconds. The file is synced before the swap and the folder after it, so that both files survive a
 * power failure. */
#ifndef SPHFSI_OUTPUT_PUBLISH_H
#define SPHFSI_OUTPUT_PUBLISH_H

#include <pthread.h>

#include "base/base.h"

/* A swap in progress; zeroed: none. */
struct publishing {
    const char *folder, *path, *spare;
    pthread_t thread;
    bool begun, threaded; /* in progress; by a thread (else it is already done) */
    struct diag diag;     /* of the swap */
};

/* Starts to swap the files `spare` and `path`. On a file system without hard links the old file is deleted.
 * The strings must remain valid until publish_end. */
void publish_begin(struct publishing *p, const char *folder, const char *path, const char *spare);

/* Waits for the swap, if one is in progress, and returns its result. */
enum err publish_end(struct publishing *p, struct diag *d);

#endif
