/* SPDX-License-Identifier: MIT
 * Checkpoints: the whole state of a run in one file. A restart from it gives the same bits as an
 * uninterrupted run. docs/formats.md describes the file byte by byte. */
#pragma once

#include "base/files.h"
#include "time/simulation.h"

/* A checkpoint in memory. A zeroed struct is an empty one. */
struct checkpoint {
    unsigned char *bytes;
    size_t size, capacity;
    /* Captured with the state: snapshots missed so far; 1: there is a snapshot of this state only
     * because the run ended with it. */
    int64_t snapshots_missed, snapshot_of_end;
};

enum { CHECKPOINT_VERSION_TEXT = 48 };

/* The most that counters of a checkpoint may hold; beyond what any number of a run is. */
#define COUNTS 0x1p62
#define FINITE 1e300

/* Contents of the header of a valid checkpoint. */
struct checkpoint_info {
    double time;
    int64_t steps, count[KIND_COUNT];
    char version[CHECKPOINT_VERSION_TEXT]; /* of the program that wrote it */
    const char *case_text;                 /* effective case; points into it */
};

/* Copies the state into it; its old contents are lost. */
enum err checkpoint_capture(struct checkpoint *m, struct simulation *sim, const char *case_text,
                            const char *version, struct diag *d) SPHFSI_CHECKED;

/* Writes it to the folder as step-NNNNNNNNN.ckpt, `path`; keeps the two newest. */
enum err checkpoint_store(struct checkpoint *m, const char *folder, char path[PATH_BYTES],
                          struct diag *d) SPHFSI_CHECKED;

/* Writes the checksum; checkpoint_store calls it. */
void checkpoint_seal(struct checkpoint *m);

/* Checks all lengths and the checksum; `name` is for messages. ERR_IO: it is damaged. */
enum err checkpoint_check(const struct checkpoint *m, const char *name, struct diag *d)
    SPHFSI_CHECKED;

/* Reads a file and checks it. */
enum err checkpoint_read(struct checkpoint *m, const char *path, struct diag *d) SPHFSI_CHECKED;

/* Reads the newest valid checkpoint of a folder; warns of each damaged one that is newer. */
enum err checkpoint_newest(struct checkpoint *m, const char *folder, char path[PATH_BYTES],
                           struct diag *d) SPHFSI_CHECKED;

/* Reads a file, or the newest valid checkpoint of a folder; `path` is where it is. */
enum err checkpoint_find(struct checkpoint *m, const char *at, char path[PATH_BYTES],
                         struct diag *d) SPHFSI_CHECKED;

struct checkpoint_info checkpoint_info(const struct checkpoint *m);

enum item { ITEM_DOUBLE, ITEM_INT64, ITEM_INT32, ITEM_BYTE, ITEM_COUNT };

/* A block of a checkpoint, into which the pointers point. */
struct block {
    const char *owner, *name;
    unsigned owner_number;
    enum item item;
    int64_t count;
    size_t bytes;
    const unsigned char *data;
};

/* The block at offset *at (0: the first one), which advances. false: no whole one is there. */
bool checkpoint_block(const struct checkpoint *m, size_t *at, struct block *b);

/* Loads the state of a valid checkpoint, without derived fields. With `fork`, a wall that moves
 * only in the new case is loaded as at rest. Used by the two functions below. */
enum err checkpoint_load(struct checkpoint *m, struct simulation *sim, bool fork, struct diag *d)
    SPHFSI_CHECKED;

/* Whether each particle is in or near the cell that it was loaded with. ERR_INPUT: another grid. */
enum err checkpoint_check_cells(const struct simulation *sim, struct diag *d) SPHFSI_CHECKED;

/* Loads a valid checkpoint into a new simulation of the same case, and recomputes derived fields.
 */
enum err checkpoint_apply(struct checkpoint *m, struct simulation *sim, struct diag *d)
    SPHFSI_CHECKED;

/* As checkpoint_apply, for a case with other physics. Particles are sorted again if the grid
 * changes; a motion continues from the position of its wall; dissipation counts from now. */
enum err checkpoint_fork(struct checkpoint *m, struct simulation *sim, struct diag *d)
    SPHFSI_CHECKED;

/* Removes checkpoints of more than `newest` steps, all but two others, and unfinished ones. */
enum err checkpoint_remove_others(const char *folder, int64_t newest, struct diag *d)
    SPHFSI_CHECKED;

void checkpoint_free(struct checkpoint *m);
