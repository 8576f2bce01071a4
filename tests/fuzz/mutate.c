/* SPDX-License-Identifier: MIT
 * libFuzzer's mutator for checkpoints: it keeps the frame of header, blocks and footer whole and
 * puts the sums right, so that what it changes reaches the reader behind them. */
#include "output/checkpoint.h"

#include <stdlib.h>
#include <string.h>

/* docs/formats.md */
enum { HEADER = 136, BLOCK = 48, FOOTER = 16, MAX_BLOCKS = 128 };
enum { AT_BLOCKS = 24, AT_SIZE = 32, AT_COUNTS = 64, AT_OWNER = 32, AT_ITEM = 36, AT_ITEMS = 40 };

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed);

static unsigned dice;

static unsigned pick(unsigned below)
{
    dice = dice * 1664525u + 1013904223u;
    return (dice >> 8) % below;
}

static uint64_t word_at(const uint8_t *p)
{
    uint64_t word;
    memcpy(&word, p, sizeof word);
    return word;
}

static size_t payload(const uint8_t *block)
{
    static const size_t item_size[] = {8, 8, 4, 1};
    uint32_t item;
    memcpy(&item, block + AT_ITEM, sizeof item);
    const uint64_t items = word_at(block + AT_ITEMS);
    if (item >= 4 || items > 1u << 20) return SIZE_MAX;
    return (items * item_size[item] + 7) / 8 * 8;
}

/* Offsets of the blocks, the end behind the last one. -1: the frame is broken. */
static int find_blocks(const uint8_t *data, size_t size, size_t at[MAX_BLOCKS + 1])
{
    int n = 0;
    size_t here = HEADER;
    if (size < HEADER + FOOTER) return -1;
    while (here + BLOCK <= size - FOOTER && n < MAX_BLOCKS) {
        const size_t bytes = payload(data + here);
        if (bytes > size - FOOTER - here - BLOCK) return -1;
        at[n++] = here;
        here += BLOCK + bytes;
    }
    at[n] = here;
    return here == size - FOOTER && n > 0 ? n : -1;
}

/* A number on which readers stumble. */
static void odd_number(uint8_t *p, size_t bytes)
{
    static const double odd[] = {0,     -0.0, 1,         -1,      1e-320,   1e-9, 1e9,    1e18,
                                 1e300, -1e9, 0.0 / 0.0, 1 / 0.0, -1 / 0.0, 0.5,  1e-300, -1e300};
    static const int64_t whole[] = {0,         1,         -1,        2,      INT64_MAX,
                                    INT64_MIN, INT32_MAX, INT32_MIN, 1000000};
    if (bytes == 8 && pick(2)) {
        memcpy(p, &odd[pick(sizeof odd / sizeof *odd)], 8);
    } else {
        const int64_t value = whole[pick(sizeof whole / sizeof *whole)];
        memcpy(p, &value, bytes);
    }
}

static size_t remove_block(uint8_t *data, size_t size, const size_t *at, int k)
{
    memmove(data + at[k], data + at[k + 1], size - at[k + 1]);
    return size - (at[k + 1] - at[k]);
}

static size_t repeat_block(uint8_t *data, size_t size, size_t max_size, const size_t *at, int k,
                           int to)
{
    const size_t bytes = at[k + 1] - at[k];
    uint8_t copy[8192];
    if (size + bytes > max_size || bytes > sizeof copy) return size;
    memcpy(copy, data + at[k], bytes);
    memmove(data + at[to] + bytes, data + at[to], size - at[to]);
    memcpy(data + at[to], copy, bytes);
    return size + bytes;
}

static void change_payload(uint8_t *data, const size_t *at, int k)
{
    uint8_t *const p = data + at[k] + BLOCK;
    const size_t bytes = at[k + 1] - at[k] - BLOCK;
    if (bytes == 0) return;
    if (pick(3)) {
        odd_number(p + 8 * pick((unsigned)(bytes / 8)), 8);
    } else {
        LLVMFuzzerMutate(p, bytes, bytes);
    }
}

/* The counts of the header and of the file follow from the blocks, unless they are what is changed.
 */
static void put_right(uint8_t *data, size_t size, bool counts)
{
    size_t at[MAX_BLOCKS + 1];
    const int n = find_blocks(data, size, at);
    const uint32_t blocks = (uint32_t)(n < 0 ? 0 : n);
    const uint64_t length = size;
    if (counts && n > 0) memcpy(data + AT_BLOCKS, &blocks, sizeof blocks);
    memcpy(data + AT_SIZE, &length, sizeof length);
    struct checkpoint m = {.bytes = data, .size = size, .capacity = size};
    checkpoint_seal(&m);
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed)
{
    size_t at[MAX_BLOCKS + 1];
    dice = seed;
    const int n = find_blocks(data, size, at);
    if (n < 0 || pick(20) == 0) return LLVMFuzzerMutate(data, size, max_size);
    bool counts = true;
    for (unsigned times = 1 + pick(3); times > 0; times--) {
        const int blocks = find_blocks(data, size, at);
        if (blocks < 1) break;
        const int k = (int)pick((unsigned)blocks), to = (int)pick((unsigned)blocks);
        switch (pick(10)) {
        case 0: size = remove_block(data, size, at, k); break;
        case 1: size = repeat_block(data, size, max_size, at, k, to); break;
        case 2: data[at[k] + AT_OWNER] = (uint8_t)pick(6); break;
        case 3: memcpy(data + at[k], data + at[to], AT_OWNER); break; /* the name of another one */
        case 4:
            odd_number(data + AT_COUNTS + 8 * pick(3), 8);
            counts = pick(2);
            break;
        case 5: odd_number(data + 8 * pick(HEADER / 8), 8); break;
        default: change_payload(data, at, k); break;
        }
    }
    put_right(data, size, counts);
    return size;
}
