/* SPDX-License-Identifier: MIT
 * For snapshot.c: the datasets of fields.vtkhdf, and appending to them with HDF5. */
#pragma once

#include "output/point_data.h"

#include <hdf5.h>

/* The datasets of a scene's file, and their precision and compression. */
struct snapshot_layout {
    bool has[D_COUNT];
    bool doubles; /* arrays of points are float64 */
    unsigned deflate;
};
struct snapshot_layout snapshot_file_layout(const struct scene *scene);

/* Creates the groups and empty datasets of a new file for snapshots of about n points. Chunks and
 * filters are those of the file `like`, so that its chunks can be copied; negative: none. */
bool snapshot_file_create(hid_t file, const struct scene *scene, const char *version, int64_t n,
                          hid_t like);

/* Number of snapshots; negative: it cannot be read. */
int64_t snapshot_file_steps(hid_t file);

/* Appends the present state to all datasets. */
bool snapshot_file_append(hid_t file, const struct snapshot_layout *layout,
                          const struct simulation *sim);

/* Reads the first n rows of a dataset. */
bool snapshot_file_first(hid_t file, enum data what, int64_t n, void *values);

/* Rows of every dataset in the first `steps` snapshots of a file; false: it has fewer. */
bool snapshot_file_rows(hid_t file, int64_t steps, int64_t rows[D_COUNT]);

/* Appends to `to` the snapshots it lacks of the first `steps` of `from`; both have equal chunks. */
bool snapshot_file_copy_missing(const struct snapshot_layout *layout, hid_t from, hid_t to,
                                int64_t steps);

/* Bytes of a point before compression; the most bytes that a snapshot of n points adds. */
int64_t snapshot_file_point_bytes(const struct snapshot_layout *layout);
int64_t snapshot_file_bytes(const struct snapshot_layout *layout, int64_t n);
