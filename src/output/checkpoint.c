/* SPDX-License-Identifier: MIT */
#include "output/checkpoint.h"
#include "output/checkpoint_files.h"
#include "output/ranges.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "checkpoints are little-endian");

enum { FORMAT = 8, BYTE_ORDER_MARK = 0x01020304, NAME_TEXT = 32 };

/* Owners of blocks: the kinds of particles, then these. */
enum { OWNER_STATE = KIND_COUNT, OWNER_CASE };

enum item { ITEM_DOUBLE, ITEM_INT64, ITEM_INT32, ITEM_BYTE, ITEM_COUNT };
static const size_t item_size[ITEM_COUNT] = {8, 8, 4, 1};

struct file_header {
    char magic[8];
    uint32_t format, byte_order;
    uint32_t header_size, block_header_size;
    uint32_t blocks, padding;
    uint64_t file_size;
    uint64_t case_hash;
    double time;
    int64_t steps;
    int64_t count[KIND_COUNT];
    char version[CHECKPOINT_VERSION_TEXT];
    uint64_t sum; /* checksum (base/hash.h) of the bytes before it */
};

struct block_header {
    char name[NAME_TEXT];
    uint32_t owner, item;
    uint64_t count;
    uint64_t payload_sum;
    uint64_t sum; /* of the bytes before it */
};

struct file_footer {
    char magic[8];
    uint64_t sum; /* of everything before the footer */
};

_Static_assert(sizeof(struct file_header) == 144 && sizeof(struct block_header) == 64 &&
                   sizeof(struct file_footer) == 16,
               "docs/formats.md gives these sizes");

/* Fields of moving walls only. */
enum { MOVING = G_REFERENCE | G_RATE | G_FORCE };

static const char magic[8] = "SPHFSICK", footer_magic[8] = "SPHFSIND";
static const char carried_name[] = "rows";

static uint64_t checksum(const void *bytes, size_t n) { return hash_bytes(HASH_START, bytes, n); }

static size_t padded(size_t n) { return (n + 7) / 8 * 8; }

/* --- capture --- */

static enum err reserve(struct image *m, size_t bytes, struct diag *d)
{
    if (m->capacity >= bytes) return ERR_OK;
    unsigned char *memory = realloc(m->bytes, bytes);
    if (!memory) return diag_fail(d, ERR_MEMORY, "checkpoint: no memory for %zu bytes", bytes);
    m->bytes = memory;
    m->capacity = bytes;
    return ERR_OK;
}

static enum item item_of(const char *type)
{
    if (strcmp(type, "double") == 0) return ITEM_DOUBLE;
    return strcmp(type, "int64_t") == 0 ? ITEM_INT64 : ITEM_INT32;
}

/* Appends a block to reserved memory; checkpoint_seal fills in the checksums. */
static void put_block(struct image *m, const char *name, unsigned owner, enum item item,
                      const void *data, size_t count)
{
    struct block_header head = {.owner = owner, .item = item, .count = count};
    snprintf(head.name, sizeof head.name, "%s", name);
    const size_t bytes = count * item_size[item];
    memcpy(m->bytes + m->size, &head, sizeof head);
    memset(m->bytes + m->size + sizeof head + bytes, 0, padded(bytes) - bytes);
    if (bytes) memcpy(m->bytes + m->size + sizeof head, data, bytes);
    m->size += sizeof head + padded(bytes);
}

/* State of a run beside its particles: blocks of numbers, what rows carry last. */
struct numbers {
    const char *name;
    enum item item;
    void *data;
    size_t count;
};

enum { MAX_NUMBERS = 64 };

/* Lists them; returns how many. */
static int list_numbers(struct simulation *sim, struct numbers list[MAX_NUMBERS])
{
    struct state *const state = &sim->state;
    struct open *const open = &sim->open;
    int n = 0;
#define STATE(type, name, low, high, unit, meaning) \
    list[n++] = (struct numbers){#name, item_of(#type), &state->name, 1};
#include "time/state.def"
#undef STATE
    list[n++] = (struct numbers){"bound_steps", ITEM_INT64, state->bound_steps, BOUND_COUNT};
    list[n++] = (struct numbers){"energy", ITEM_DOUBLE, &state->energy, ENERGY_NUMBERS};
    if (open->n > 0) {
        const size_t boundaries = (size_t)open->n;
        list[n++] = (struct numbers){"open_sum", ITEM_DOUBLE, open->sum, boundaries * OPEN_SUMS};
        list[n++] =
            (struct numbers){"open_count", ITEM_INT64, open->count, boundaries * OPEN_COUNTS};
        list[n++] = (struct numbers){"open_next_id", ITEM_INT64, &open->next_id, 1};
    }
    if (sim->carried.n > 0)
        list[n++] =
            (struct numbers){carried_name, ITEM_DOUBLE, sim->carried.value, (size_t)sim->carried.n};
    ASSERT(n <= MAX_NUMBERS);
    return n;
}

/* The most bytes of an image: of every block, including those of fields that are not kept. */
static size_t image_bytes(const struct simulation *sim, const struct numbers *list, int n,
                          size_t case_length)
{
    size_t bytes = sizeof(struct file_header) + sizeof(struct file_footer) + padded(case_length) +
                   2 * sizeof(int64_t) + (size_t)(n + 3) * sizeof(struct block_header);
    for (int k = 0; k < n; k++) bytes += padded(list[k].count * item_size[list[k].item]);
    for (int k = 0; k < KIND_COUNT; k++)
        for (int f = 0; f < field_count; f++)
            bytes +=
                sizeof(struct block_header) + padded((size_t)sim->kind[k].n * field_table[f].size);
    return bytes;
}

static uint32_t put_particles(struct image *m, const struct simulation *sim)
{
    uint32_t blocks = 0;
    for (int k = 0; k < KIND_COUNT; k++)
        for (int f = 0; f < field_count; f++) {
            const struct field_info *info = &field_table[f];
            const void *data = field_array(&sim->kind[k], info);
            if (!data || info->keep != KEEP_STATE) continue;
            put_block(m, info->name, (unsigned)k, item_of(info->type), data,
                      (size_t)sim->kind[k].n);
            blocks++;
        }
    return blocks;
}

enum err checkpoint_capture(struct image *m, struct simulation *sim, const char *case_text,
                            const char *version, struct diag *d)
{
    struct numbers list[MAX_NUMBERS];
    const int n = list_numbers(sim, list);
    const size_t case_length = strlen(case_text) + 1; /* with its 0 */
    TRY(reserve(m, image_bytes(sim, list, n, case_length), d));
    struct file_header head = {
        .format = FORMAT,
        .byte_order = BYTE_ORDER_MARK,
        .header_size = sizeof(struct file_header),
        .block_header_size = sizeof(struct block_header),
        .case_hash = checksum(case_text, case_length),
        .time = sim->state.time,
        .steps = sim->state.steps,
    };
    memcpy(head.magic, magic, sizeof magic);
    snprintf(head.version, sizeof head.version, "%s", version);
    for (int k = 0; k < KIND_COUNT; k++) head.count[k] = sim->kind[k].n;
    m->size = sizeof head;
    put_block(m, "case", OWNER_CASE, ITEM_BYTE, case_text, case_length);
    put_block(m, "snapshots_missed", OWNER_STATE, ITEM_INT64, &m->snapshots_missed, 1);
    put_block(m, "snapshot_of_end", OWNER_STATE, ITEM_INT64, &m->snapshot_of_end, 1);
    for (int k = 0; k < n; k++)
        put_block(m, list[k].name, OWNER_STATE, list[k].item, list[k].data, list[k].count);
    head.blocks = 3 + (uint32_t)n + put_particles(m, sim);
    const struct file_footer foot = {.sum = 0};
    memcpy(m->bytes + m->size, &foot, sizeof foot);
    m->size += sizeof foot;
    ASSERT(m->size <= m->capacity && m->size % 8 == 0);
    head.file_size = m->size;
    memcpy(m->bytes, &head, sizeof head);
    return ERR_OK;
}

/* --- blocks --- */

struct block {
    struct block_header head;
    size_t at, payload; /* offsets in the image */
};

/* Reads the header of the block at offset `at`; false if no whole block begins there. */
static bool block_at(const struct image *m, size_t at, struct block *b)
{
    const size_t end = m->size - sizeof(struct file_footer);
    if (at > end || end - at < sizeof b->head) return false;
    memcpy(&b->head, m->bytes + at, sizeof b->head);
    b->at = at;
    b->payload = at + sizeof b->head;
    const size_t rest = end - b->payload;
    if (b->head.item >= ITEM_COUNT || b->head.count > rest / item_size[b->head.item]) return false;
    return padded(b->head.count * item_size[b->head.item]) <= rest;
}

static size_t block_end(const struct block *b)
{
    return b->payload + padded(b->head.count * item_size[b->head.item]);
}

static size_t payload_bytes(const struct block *b)
{
    return b->head.count * item_size[b->head.item];
}

/* --- store --- */

void checkpoint_seal(struct image *m)
{
    struct block b;
    for (size_t at = sizeof(struct file_header); block_at(m, at, &b); at = block_end(&b)) {
        b.head.payload_sum = checksum(m->bytes + b.payload, payload_bytes(&b));
        b.head.sum = checksum(&b.head, offsetof(struct block_header, sum));
        memcpy(m->bytes + b.at, &b.head, sizeof b.head);
    }
    struct file_header head;
    memcpy(&head, m->bytes, sizeof head);
    head.sum = checksum(&head, offsetof(struct file_header, sum));
    memcpy(m->bytes, &head, sizeof head);
    struct file_footer foot = {.sum = checksum(m->bytes, m->size - sizeof foot)};
    memcpy(foot.magic, footer_magic, sizeof foot.magic);
    memcpy(m->bytes + m->size - sizeof foot, &foot, sizeof foot);
}

enum err checkpoint_store(struct image *m, const char *folder, char path[PATH_BYTES],
                          struct diag *d)
{
    struct atomic_file out;
    char name[NAME_TEXT];
    const struct image_info info = checkpoint_info(m);
    checkpoint_seal(m);
    checkpoint_name(name, info.steps);
    TRY(atomic_file_open(&out, folder, name, d));
    /* atomic_file_commit reports a short write, by ferror. */
    if (fwrite(m->bytes, 1, m->size, out.file) != m->size && !ferror(out.file)) {
        atomic_file_abandon(&out);
        return diag_fail(d, ERR_IO, "%s: cannot be written", out.path);
    }
    TRY(atomic_file_commit(&out, d));
    memcpy(path, out.path, PATH_BYTES);
    struct diag why = {.code = ERR_OK}; /* a failure to remove does not stop the run */
    if (checkpoint_remove_older(folder, info.steps, &why)) diag_warn(d, "%s", why.text);
    return ERR_OK;
}

/* --- read --- */

static enum err damaged(struct diag *d, const char *path, const char *what)
{
    return diag_fail(d, ERR_IO, "%s: is not a valid checkpoint: %s", path, what);
}

static enum err check_header(const struct image *m, const char *path, struct diag *d)
{
    struct file_header head;
    if (m->size < sizeof head + sizeof(struct file_footer))
        return damaged(d, path, "it is shorter than a header and a footer");
    memcpy(&head, m->bytes, sizeof head);
    if (memcmp(head.magic, magic, sizeof magic) != 0)
        return damaged(d, path, "its first 8 bytes are wrong");
    /* Before any checksum, since another byte order or format has other checksums. */
    if (head.byte_order == __builtin_bswap32(BYTE_ORDER_MARK))
        return diag_fail(d, ERR_IO,
                         "%s: has big-endian byte order, but this program reads little-endian; "
                         "continue the run on a big-endian machine",
                         path);
    if (head.byte_order != BYTE_ORDER_MARK) return damaged(d, path, "its byte-order mark is wrong");
    if (head.format != FORMAT)
        return diag_fail(d, ERR_IO,
                         "%s: has format %u, but this program reads format %d; continue the run "
                         "with version %.*s, which wrote the file (its bytes 88 to 135)",
                         path, head.format, FORMAT, (int)sizeof head.version - 1, head.version);
    if (head.header_size != sizeof head || head.block_header_size != sizeof(struct block_header) ||
        head.sum != checksum(&head, offsetof(struct file_header, sum)))
        return damaged(d, path, "its header is damaged");
    if (head.file_size != m->size) return damaged(d, path, "its length is wrong; it was cut short");
    return ERR_OK;
}

static enum err check_footer(const struct image *m, const char *path, struct diag *d)
{
    struct file_footer foot;
    memcpy(&foot, m->bytes + m->size - sizeof foot, sizeof foot);
    if (memcmp(foot.magic, footer_magic, sizeof foot.magic) != 0)
        return damaged(d, path, "its footer is damaged");
    if (foot.sum != checksum(m->bytes, m->size - sizeof foot))
        return damaged(d, path, "its checksum is wrong");
    return ERR_OK;
}

/* Every block is complete, has correct checksums and a terminated name; no bytes follow the last
 * block. */
static enum err check_blocks(const struct image *m, const char *path, struct diag *d)
{
    struct file_header head;
    memcpy(&head, m->bytes, sizeof head);
    size_t at = sizeof head;
    for (uint32_t k = 0; k < head.blocks; k++) {
        struct block b;
        if (!block_at(m, at, &b)) return damaged(d, path, "a block extends beyond its end");
        if (b.head.sum != checksum(&b.head, offsetof(struct block_header, sum)) ||
            !memchr(b.head.name, '\0', sizeof b.head.name))
            return damaged(d, path, "the header of a block is damaged");
        if (b.head.payload_sum != checksum(m->bytes + b.payload, payload_bytes(&b)))
            return diag_fail(d, ERR_IO, "%s: is not a valid checkpoint: block %s is damaged", path,
                             b.head.name);
        at = block_end(&b);
    }
    if (at != m->size - sizeof(struct file_footer))
        return damaged(d, path, "bytes follow its last block");
    return ERR_OK;
}

enum err checkpoint_check(const struct image *m, const char *name, struct diag *d)
{
    TRY(check_header(m, name, d));
    TRY(check_footer(m, name, d));
    return check_blocks(m, name, d);
}

enum err checkpoint_read(struct image *m, const char *path, struct diag *d)
{
    char *bytes;
    size_t size;
    TRY(file_read(path, &bytes, &size, d));
    checkpoint_free(m);
    m->bytes = (unsigned char *)bytes;
    m->size = m->capacity = size;
    return checkpoint_check(m, path, d);
}

enum err checkpoint_newest(struct image *m, const char *folder, char path[PATH_BYTES],
                           struct diag *d)
{
    char name[NAME_TEXT];
    int damaged_ones = 0;
    for (int64_t steps = INT64_MAX;; damaged_ones++) {
        struct diag why = {.code = ERR_OK};
        TRY(checkpoint_next(folder, &steps, d));
        if (steps < 0) break;
        checkpoint_name(name, steps);
        TRY(path_join(path, folder, name, d));
        const enum err e = checkpoint_read(m, path, &why);
        if (e == ERR_OK) return ERR_OK;
        /* Without memory nothing is known about this checkpoint. A restart from an older one would
         * remove it. */
        if (e == ERR_MEMORY) return diag_fail(d, e, "%s", why.text);
        diag_warn(d, "%s; the one before it is tried", why.text);
    }
    return diag_fail(d, ERR_IO, "%s: contains no %scheckpoint (step-*.ckpt) to restart from",
                     folder, damaged_ones ? "valid " : "");
}

enum err checkpoint_find(struct image *m, const char *at, char path[PATH_BYTES], struct diag *d)
{
    struct stat info;
    if (stat(at, &info) == 0 && S_ISDIR(info.st_mode)) return checkpoint_newest(m, at, path, d);
    snprintf(path, PATH_BYTES, "%s", at);
    return checkpoint_read(m, at, d);
}

static bool find_block(const struct image *m, const char *name, unsigned owner, struct block *b)
{
    for (size_t at = sizeof(struct file_header); block_at(m, at, b); at = block_end(b))
        if (b->head.owner == owner && strcmp(b->head.name, name) == 0) return true;
    return false;
}

struct image_info checkpoint_info(const struct image *m)
{
    struct file_header head;
    memcpy(&head, m->bytes, sizeof head);
    struct image_info info = {.time = head.time, .steps = head.steps, .case_text = ""};
    memcpy(info.count, head.count, sizeof info.count);
    memcpy(info.version, head.version, sizeof info.version - 1);
    struct block b;
    if (find_block(m, "case", OWNER_CASE, &b) && b.head.count > 0 &&
        m->bytes[b.payload + b.head.count - 1] == '\0')
        info.case_text = (const char *)m->bytes + b.payload;
    return info;
}

bool checkpoint_block(const struct image *m, size_t *at, struct block_info *info)
{
    static const char *const others[] = {"run", "case"};
    static const char *const types[ITEM_COUNT] = {"double", "int64", "int32", "byte"};
    struct block b;
    if (*at == 0) *at = sizeof(struct file_header);
    if (!block_at(m, *at, &b)) return false;
    const unsigned owner = b.head.owner;
    *info = (struct block_info){
        .owner = owner < KIND_COUNT    ? kind_names[owner]
                 : owner <= OWNER_CASE ? others[owner - KIND_COUNT]
                                       : "unknown",
        .name = (const char *)m->bytes + b.at,
        .type = types[b.head.item],
        .count = (int64_t)b.head.count,
        .item_bytes = item_size[b.head.item],
        .data = m->bytes + b.payload,
    };
    *at = block_end(&b);
    return true;
}

/* --- apply --- */

static enum err load_block(const struct image *m, const char *name, unsigned owner, enum item item,
                           size_t count, void *to, struct diag *d)
{
    struct block b;
    if (!find_block(m, name, owner, &b))
        return diag_fail(d, ERR_INPUT, "checkpoint: it has no block %s, which this case needs",
                         name);
    if (b.head.item != item || b.head.count != count)
        return diag_fail(d, ERR_INPUT,
                         "checkpoint: block %s holds %" PRIu64
                         " items of type %u, but this case needs %zu of type %u",
                         name, b.head.count, b.head.item, count, item);
    if (count) memcpy(to, m->bytes + b.payload, count * item_size[item]);
    return ERR_OK;
}

enum err checkpoint_snapshots(struct image *m, struct diag *d)
{
    TRY(load_block(m, "snapshots_missed", OWNER_STATE, ITEM_INT64, 1, &m->snapshots_missed, d));
    TRY(load_block(m, "snapshot_of_end", OWNER_STATE, ITEM_INT64, 1, &m->snapshot_of_end, d));
    TRY(range_check("snapshots_missed", (double)m->snapshots_missed, 0, COUNTS, d));
    return range_check("snapshot_of_end", (double)m->snapshot_of_end, 0, 1, d);
}

/* In a fork: sets a field that the run of the checkpoint did not have. Reference positions are the
 * present ones; all else is zero: velocities of a wall that was at rest, interface impulses, mean
 * forces, and gradients until they are found. */
static void set_missing_field(struct particles *particles, const struct field_info *info)
{
    void *const data = field_array(particles, info);
    const void *position = data == particles->X   ? particles->x
                           : data == particles->Y ? particles->y
                                                  : NULL;
    if (position)
        memcpy(data, position, (size_t)particles->n * info->size);
    else
        memset(data, 0, (size_t)particles->n * info->size);
}

static enum err load_particles(const struct image *m, struct particles *particles, enum kind kind,
                               int64_t n, bool fork, struct diag *d)
{
    if (n < 0 || n > particles->capacity)
        return diag_fail(d, ERR_INPUT,
                         "checkpoint: it has %" PRId64 " %s particles, but the case has %" PRId64,
                         n, kind_names[kind], particles->capacity);
    particles->n = n;
    for (int f = 0; f < field_count; f++) {
        const struct field_info *info = &field_table[f];
        void *data = field_array(particles, info);
        if (!data || info->keep != KEEP_STATE) continue;
        struct block b;
        const unsigned optional =
            kind == KIND_WALL
                ? MOVING
                : (unsigned)(G_WETTED | G_MEAN_FORCE | G_SLOPE | G_FRICTION | G_MATRIX);
        if (fork && (info->group & optional) && !find_block(m, info->name, kind, &b))
            set_missing_field(particles, info);
        else
            TRY(load_block(m, info->name, kind, item_of(info->type), (size_t)n, data, d));
    }
    return ERR_OK;
}

static enum err check_kind(const struct simulation *sim, enum kind kind, struct diag *d)
{
    const struct particles *particles = &sim->kind[kind];
    const int64_t cells = (int64_t)sim->cells.nx * sim->cells.ny;
    for (int64_t i = 0; i < particles->n; i++) {
        const int32_t cell = particles->cell[i];
        if (cell < -1 || cell >= cells)
            return diag_fail(d, ERR_INPUT,
                             "checkpoint: %s particle %" PRId64
                             " has cell number %d, but -1 (outside) to "
                             "%" PRId64 " are valid; the file is damaged or not of this case",
                             kind_names[kind], i, cell, cells - 1);
        if (cell < 0) continue;
        if (!cells_is_near(&sim->cells, cell, particles->x[i], particles->y[i]))
            return diag_fail(
                d, ERR_INPUT,
                "checkpoint: %s particle %" PRId64
                " at (%.6g, %.6g) m is too far from its cell, %d; the file is damaged or "
                "not of this case",
                kind_names[kind], i, particles->x[i], particles->y[i], cell);
    }
    return ERR_OK;
}

enum err checkpoint_check_cells(const struct simulation *sim, struct diag *d)
{
    for (int k = 0; k < KIND_COUNT; k++) TRY(check_kind(sim, (enum kind)k, d));
    return ERR_OK;
}

enum err checkpoint_load(const struct image *m, struct simulation *sim, bool fork, struct diag *d)
{
    const struct image_info info = checkpoint_info(m);
    for (int k = 0; k < KIND_COUNT; k++)
        TRY(load_particles(m, &sim->kind[k], (enum kind)k, info.count[k], fork, d));
    struct numbers list[MAX_NUMBERS];
    const int n = list_numbers(sim, list);
    for (int k = 0; k < n; k++) /* The probes of a fork may be others: they begin anew. */
        if (!fork || list[k].name != carried_name)
            TRY(load_block(m, list[k].name, OWNER_STATE, list[k].item, list[k].count, list[k].data,
                           d));
    return ranges_check(sim, d);
}

enum err checkpoint_apply(const struct image *m, struct simulation *sim, struct diag *d)
{
    TRY(checkpoint_load(m, sim, false, d));
    if (sim->effects & FX_FLUID) TRY(checkpoint_check_cells(sim, d));
    return simulation_resume(sim, d);
}

void checkpoint_free(struct image *m)
{
    free(m->bytes);
    *m = (struct image){0};
}
