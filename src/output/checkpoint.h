/* SPDX-License-Identifier: MIT
 * Checkpoints: the whole state of a run in one file, from which it goes on without a changed bit.
 * docs/formats.md describes the file byte by byte. */
#ifndef SPHFSI_OUTPUT_CHECKPOINT_H
#define SPHFSI_OUTPUT_CHECKPOINT_H

#include "base/files.h"
#include "time/simulation.h"

/* A checkpoint in memory. A zeroed struct is an empty one. */
struct image {
    unsigned char *bytes;
    size_t size, capacity;
};

enum { CHECKPOINT_VERSION_TEXT = 48 };

/* What a valid image says of itself. */
struct image_info {
    double time;
    int64_t steps, count[KIND_COUNT];
    char version[CHECKPOINT_VERSION_TEXT]; /* of the program that wrote it */
    const char *case_text;                 /* effective case; lies in the image */
};

/* Copies the state into the image, replacing what it held. */
enum err checkpoint_capture(struct image *m, const struct simulation *s, const char *case_text,
                            const char *version, struct diag *d) SPHFSI_CHECKED;

/* Writes it to the folder under a name made of its steps, and removes all but the last two. `path`
 * receives where. */
enum err checkpoint_store(struct image *m, const char *folder, char path[PATH_BYTES],
                          struct diag *d) SPHFSI_CHECKED;

/* Fills in the sums of an image; checkpoint_store does so itself. */
void checkpoint_seal(struct image *m);

/* Checks every length and sum of the bytes; `name` stands for them in messages. ERR_IO says what is
 * wrong. */
enum err checkpoint_check(const struct image *m, const char *name, struct diag *d) SPHFSI_CHECKED;

/* Reads a file and checks it. */
enum err checkpoint_read(struct image *m, const char *path, struct diag *d) SPHFSI_CHECKED;

/* Reads the newest valid one of a folder; a warning for each damaged one it passes over. */
enum err checkpoint_newest(struct image *m, const char *folder, char path[PATH_BYTES],
                           struct diag *d) SPHFSI_CHECKED;

struct image_info checkpoint_info(const struct image *m);

/* A block of a valid image, for those who list them. */
struct block_info {
    const char *owner, *name, *type;
    int64_t count;
    size_t item_bytes;
    const void *data; /* lies in the image */
};

/* The block at `at` (0: the first one), which moves on to the next; false: there is none more. */
bool checkpoint_block(const struct image *m, size_t *at, struct block_info *info);

/* The state of a valid image, without what follows from it. fork: a wall that moves only in this case
 * is taken as at rest so far. Used by the two below. */
enum err checkpoint_load(const struct image *m, struct simulation *s, bool fork, struct diag *d)
    SPHFSI_CHECKED;

/* Loads a valid image into a simulation that simulation_create made from the same case, and brings
 * the rest up to date by simulation_resume. */
enum err checkpoint_apply(const struct image *m, struct simulation *s, struct diag *d)
    SPHFSI_CHECKED;

/* The same where the case has other physics: particles are sorted anew, since the grid may be another
 * one; a motion must go on where its wall stands; dissipation is counted from here on. */
enum err checkpoint_fork(const struct image *m, struct simulation *s, struct diag *d)
    SPHFSI_CHECKED;

/* Removes checkpoints of more steps than these: they belong to a future that is run anew. And those
 * that runs which were killed have left unfinished. */
enum err checkpoint_forget_later(const char *folder, int64_t steps, struct diag *d) SPHFSI_CHECKED;

void checkpoint_free(struct image *m);

#endif
