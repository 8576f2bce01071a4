/* SPDX-License-Identifier: MIT
 * What fields.vtkhdf says of a particle. Here and not in snapshot.h, so that programs that only
 * read fields build without HDF5. */
#pragma once

#include "time/simulation.h"

/* The datasets below /VTKHDF, in the order of the table in output/snapshot_file.c. */
enum data {
    D_POINTS_COUNT,
    D_TIME,
    D_PARTS_BEFORE,
    D_PARTS,
    D_POINTS_BEFORE,
    D_POINTS,
    D_CONNECTIVITY,
    D_OFFSETS,
    D_TYPES,
#define POINTDATA(NAME, ...) D_##NAME,
#include "case/pointdata.def"
    D_COUNT,
    D_FIRST_POINTDATA = D_TYPES + 1
};

/* Value of one particle in a floating dataset; simulation_refresh comes first. */
double snapshot_value(enum data what, const struct simulation *sim, enum kind kind, int64_t i,
                      int column);
