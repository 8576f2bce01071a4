/* SPDX-License-Identifier: MIT
 * fields.vtkhdf: snapshots of all particles in the VTKHDF layout, which ParaView and h5py open. */
#ifndef SPHFSI_OUTPUT_SNAPSHOT_H
#define SPHFSI_OUTPUT_SNAPSHOT_H

#include "base/files.h"
#include "time/simulation.h"
#include "output/snapshot_file.h"
#include "output/publish.h"

/* A snapshot is appended to a spare copy, which then takes the name; so the file with the name is
 * whole at any moment, and the other one lags a snapshot behind and is caught up first. */
struct snapshots {
    char folder[PATH_BYTES], path[PATH_BYTES], spare[PATH_BYTES];
    const struct scene *scene;
    struct snapshot_layout layout;
    const char *version; /* of the program */
    struct publishing publishing;
};

/* Begins with no snapshot, or goes on with those up to `time`; `last` is the time of the last one,
 * -1 if there is none. */
enum err snapshots_create(struct snapshots *w, const char *folder, const struct scene *scene,
                          const char *version, struct diag *d) SPHFSI_CHECKED;
enum err snapshots_resume(struct snapshots *w, const char *folder, const struct scene *scene,
                          const char *version, double time, double *last, struct diag *d)
    SPHFSI_CHECKED;

/* Appends one. It has its place in the file with the name when snapshots_settle or the next call comes
 * back: the disk is waited for beside the simulation. */
enum err snapshots_write(struct snapshots *w, struct simulation *s, struct diag *d) SPHFSI_CHECKED;
enum err snapshots_settle(struct snapshots *w, struct diag *d) SPHFSI_CHECKED;

/* Settles, and removes the spare. */
void snapshots_close(struct snapshots *w);

#endif
