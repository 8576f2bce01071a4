/* SPDX-License-Identifier: MIT
 * Inside of snapshot: chunks as they lie in a file, packed without HDF5, which uses one thread. */
#ifndef SPHFSI_OUTPUT_SNAPSHOT_PACK_H
#define SPHFSI_OUTPUT_SNAPSHOT_PACK_H

#include "base/base.h"

#include <hdf5.h>

/* How the values of a dataset lie in its chunks. */
struct packing {
    bool
        known; /* by pack_chunk: chunks of one column, an item of the list there, a byte shuffle or none,
                     * deflate or none after it */
    int item; /* of that list */
    bool shuffled;
    int level;     /* of deflate; 0: not deflated */
    uint32_t skip; /* bit of the mask of filters that says: not deflated */
};

/* Of an open dataset with chunks of so many columns. */
struct packing packing_of(hid_t set, hsize_t columns);

enum { PACK_ROOM = 16 }; /* bytes of room for a value */

struct packed_chunk {
    const void *bytes; /* in the room that was given; NULL: it failed */
    size_t size;
    uint32_t filters; /* the mask that HDF5 keeps with the chunk */
};

/* Packs the n values of a chunk, double or int64_t, with which `room` begins; they are lost. */
struct packed_chunk pack_chunk(const struct packing *k, int64_t n, void *room);

#endif
