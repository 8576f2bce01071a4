/* SPDX-License-Identifier: MIT
 * fields.vtkhdf: snapshots of all particles in the VTKHDF layout, readable by ParaView and h5py. */
#pragma once

#include "base/files.h"
#include "output/snapshot_file.h"

/* Two files alternate, so that a reader always finds a complete one: a snapshot is appended to the
 * spare file, then the two swap names. The spare, one snapshot older, is completed first. */
struct snapshots {
    char folder[PATH_BYTES], path[PATH_BYTES], spare[PATH_BYTES];
    const struct scene *scene;
    struct snapshot_layout layout;
    const char *version; /* of the program */
};

/* Starts without snapshots; or continues with those up to `time`; `last`: of the last, or -1. */
enum err snapshots_create(struct snapshots *w, const char *folder, const struct scene *scene,
                          const char *version, struct diag *d) SPHFSI_CHECKED;
enum err snapshots_resume(struct snapshots *w, const char *folder, const struct scene *scene,
                          const char *version, double time, double *last, struct diag *d)
    SPHFSI_CHECKED;

/* Appends a snapshot and waits until it is on the disk. */
enum err snapshots_write(struct snapshots *w, struct simulation *sim, struct diag *d)
    SPHFSI_CHECKED;

/* CPU time of this thread for a snapshot in memory and its copy to a spare, s; 0: it failed. */
double snapshots_seconds(struct simulation *sim);

/* Removes the spare. */
void snapshots_close(struct snapshots *w);
