/* SPDX-License-Identifier: MIT
 * For snapshot_file.c: compresses chunks in the format of HDF5's filters. HDF5 itself would use one thread.
 */
#ifndef SPHFSI_OUTPUT_SNAPSHOT_PACK_H
#define SPHFSI_OUTPUT_SNAPSHOT_PACK_H

#include "base/base.h"

#include <hdf5.h>

/* Item type and filters of a dataset. */
struct packing {
    /* pack_chunk supports chunks of one column, the item types in its list, and the filters byte shuffle and
     * deflate, each of them optional, in this order. */
    bool known;
    int item; /* index in that list */
    bool shuffled;
    int level;     /* of deflate; 0: none */
    uint32_t skip; /* filter mask of a chunk without deflate */
};

/* The packing of an open dataset with chunks of so many columns. */
struct packing packing_of(hid_t set, hsize_t columns);

enum { PACK_BYTES = 16 }; /* of the buffer, for each value */

struct packed_chunk {
    const void *bytes; /* in the buffer; NULL: failed */
    size_t size;
    uint32_t filters; /* filter mask of the chunk, as HDF5 stores it */
};

/* Packs the n values at the start of the buffer, double or int64_t; they are overwritten. */
struct packed_chunk pack_chunk(const struct packing *k, int64_t n, void *buffer);

#endif
