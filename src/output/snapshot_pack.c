/* SPDX-License-Identifier: MIT */
#include "output/snapshot_pack.h"

#include <string.h>
#include <zlib.h>

/* Item types of datasets, and the types of their values in memory. */
#define ITEMS(ITEM)                          \
    ITEM(double, double, H5T_NATIVE_DOUBLE)  \
    ITEM(float, double, H5T_NATIVE_FLOAT)    \
    ITEM(int64_t, int64_t, H5T_NATIVE_INT64) \
    ITEM(int32_t, int64_t, H5T_NATIVE_INT32) \
    ITEM(int8_t, int64_t, H5T_NATIVE_INT8)   \
    ITEM(uint8_t, int64_t, H5T_NATIVE_UINT8)

/* Conversion in place: an item is not larger than its value in memory. */
#define ITEM(type, value, native)                                                  \
    static void value##_to_##type(void *values, int64_t n)                         \
    {                                                                              \
        for (int64_t i = 0; i < n; i++) {                                          \
            value v;                                                               \
            memcpy(&v, (char *)values + i * (int64_t)sizeof v, sizeof v);          \
            const type item = (type)v;                                             \
            memcpy((char *)values + i * (int64_t)sizeof item, &item, sizeof item); \
        }                                                                          \
    }
ITEMS(ITEM)
#undef ITEM

static const struct item {
    size_t bytes;
    void (*convert)(void *values, int64_t n);
} items[] = {
#define ITEM(type, value, native) {sizeof(type), value##_to_##type},
    ITEMS(ITEM)
#undef ITEM
};

static int item_of(hid_t type)
{
    int k = 0, found = -1;
#define ITEM(t, value, native)                              \
    if (found < 0 && H5Tequal(type, native) > 0) found = k; \
    k++;
    ITEMS(ITEM)
#undef ITEM
    return found;
}

/* Reads the k-th filter of the pipeline; false if pack_chunk does not support it there. */
static bool read_filter(struct packing *p, hid_t how, unsigned k)
{
    unsigned flags, values[8] = {0};
    size_t n = COUNT_OF(values);
    switch (H5Pget_filter2(how, k, &flags, &n, values, 0, NULL, NULL)) {
    case H5Z_FILTER_SHUFFLE: p->shuffled = true; return k == 0;
    case H5Z_FILTER_DEFLATE:
        p->level = (int)values[0];
        p->skip = 1U << k;
        return p->level > 0 && p->level <= Z_BEST_COMPRESSION;
    default: return false;
    }
}

struct packing packing_of(hid_t set, hsize_t columns)
{
    struct packing p = {.item = -1};
    const hid_t how = H5Dget_create_plist(set), type = H5Dget_type(set);
    if (type >= 0) p.item = item_of(type);
    const int filters = how >= 0 ? H5Pget_nfilters(how) : -1;
    p.known = p.item >= 0 && columns == 1 && filters >= 0 && filters <= 2;
    for (int k = 0; p.known && k < filters; k++)
        p.known = p.level == 0 && read_filter(&p, how, (unsigned)k);
    if (type >= 0) H5Tclose(type);
    if (how >= 0) H5Pclose(how);
    return p;
}

/* HDF5's byte shuffle: the first bytes of all items, then the second ones, and so on. */
#define SHUFFLE(type)                                                          \
    static void shuffle_##type(const void *from, unsigned char *to, int64_t n) \
    {                                                                          \
        for (size_t b = 0; b < sizeof(type); b++, to += n)                     \
            for (int64_t i = 0; i < n; i++) {                                  \
                type item;                                                     \
                memcpy(&item, (const type *)from + i, sizeof item);            \
                to[i] = (unsigned char)(item >> 8 * b);                        \
            }                                                                  \
    }
SHUFFLE(uint32_t)
SHUFFLE(uint64_t)

struct packed_chunk pack_chunk(const struct packing *k, int64_t n, void *buffer)
{
    const struct item *const item = &items[k->item];
    unsigned char *from = buffer, *to = from + n * PACK_BYTES / 2;
    const size_t size = (size_t)n * item->bytes;
    item->convert(from, n);
    if (k->shuffled && item->bytes > 1) {
        (item->bytes == 4 ? shuffle_uint32_t : shuffle_uint64_t)(from, to, n);
        from = to;
        to = buffer;
    }
    if (k->level == 0) return (struct packed_chunk){from, size, 0};
    uLongf packed = (uLongf)size;
    const int status = compress2(to, &packed, from, (uLong)size, k->level);
    if (status == Z_BUF_ERROR)
        return (struct packed_chunk){from, size, k->skip}; /* it would grow */
    return (struct packed_chunk){status == Z_OK ? to : NULL, packed, 0};
}
