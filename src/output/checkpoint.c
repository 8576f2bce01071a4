/* SPDX-License-Identifier: MIT
 * The format of checkpoints: blocks under one checksum, their files, and how they are loaded. */
#include "output/checkpoint.h"
#include "base/hash.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "checkpoints are little-endian");

enum { FORMAT = 14, BYTE_ORDER_MARK = 0x01020304, NAME_TEXT = 32 };
enum { KEEP = 2 }; /* checkpoints in the folder of a run */

/* Owners of blocks: the kinds of particles, then these. */
enum { OWNER_RUN = KIND_COUNT, OWNER_CASE };

static const size_t item_size[ITEM_COUNT] = {8, 8, 4, 1};
static const char *const item_name[ITEM_COUNT] = {"double", "int64", "int32", "byte"};

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
};

struct block_header {
    char name[NAME_TEXT];
    uint32_t owner, item;
    uint64_t count;
};

struct file_footer {
    char magic[8];
    uint64_t sum; /* checksum (base/hash.h) of everything before the footer */
};

_Static_assert(sizeof(struct file_header) == 136 && sizeof(struct block_header) == 48 &&
                   sizeof(struct file_footer) == 16,
               "docs/formats.md gives these sizes");

static const char magic[8] = "SPHFSICK", footer_magic[8] = "SPHFSIND";

static uint64_t checksum(const void *bytes, size_t n) { return hash_bytes(HASH_START, bytes, n); }

static size_t padded(size_t n) { return (n + 7) / 8 * 8; }

static enum err reserve(struct checkpoint *m, size_t bytes, struct diag *d)
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

/* --- what a checkpoint has --- */

/* What a fork, whose case may have other fields and outputs, does with a block. */
enum in_fork { FORK_LOADS, FORK_LOADS_IF_THERE, FORK_SKIPS };

/* A block of a file in the memory of the program, and the range of its numbers. */
struct part {
    const char *name;
    unsigned owner;
    enum item item;
    void *data;
    size_t count;
    enum in_fork in_fork;
    double low, high; /* low = -INFINITY: any numbers, and NAN */
};

enum { MAX_PARTS = 512 };

struct parts {
    int n;
    struct part item[MAX_PARTS];
};

static void add_part(struct parts *list, struct part part)
{
    ASSERT(list->n < MAX_PARTS);
    list->item[list->n++] = part;
}

/* A part of the run itself. */
static void add_run(struct parts *list, const char *name, enum item item, void *data, size_t count,
                    double low, double high)
{
    if (count > 0)
        add_part(list, (struct part){name, OWNER_RUN, item, data, count, FORK_LOADS, low, high});
}

static void list_run(struct parts *list, struct checkpoint *m, struct simulation *sim)
{
    struct state *const state = &sim->state;
    struct open_boundaries *const open = &sim->open;
    const size_t n_open = (size_t)open->n;
    add_part(list, (struct part){"snapshots_missed", OWNER_RUN, ITEM_INT64, &m->snapshots_missed, 1,
                                 FORK_SKIPS, 0, COUNTS});
    add_part(list, (struct part){"snapshot_of_end", OWNER_RUN, ITEM_INT64, &m->snapshot_of_end, 1,
                                 FORK_SKIPS, 0, 1});
#define STATE(type, name, low, high, unit, meaning) \
    add_run(list, #name, item_of(#type), &state->name, 1, low, high);
#include "time/state.def"
#undef STATE
    add_run(list, "bound_steps", ITEM_INT64, state->bound_steps, BOUND_COUNT, 0, COUNTS);
    add_run(list, "energy", ITEM_DOUBLE, &state->energy, ENERGY_NUMBERS, -FINITE, FINITE);
    add_run(list, "open_sum", ITEM_DOUBLE, open->sum, n_open * OPEN_SUMS, -INFINITY, FINITE);
    add_run(list, "open_count", ITEM_INT64, open->count, n_open * OPEN_COUNTS, 0, COUNTS);
    add_run(list, "open_next_id", ITEM_INT64, &open->next_id, n_open > 0, 0, COUNTS);
    add_run(list, "zones", ITEM_DOUBLE, sim->zones.taken, (size_t)sim->zones.n, 0, FINITE);
    add_run(list, "rigid", ITEM_DOUBLE, sim->rigid.state, (size_t)sim->rigid.n * RIGID_NUMBERS,
            -FINITE, FINITE);
    add_run(list, "beams", ITEM_DOUBLE, sim->beams.state, (size_t)sim->beams.n_nodes * BEAM_NUMBERS,
            -FINITE, FINITE);
    if (sim->carried.n > 0)
        add_part(list, (struct part){"rows", OWNER_RUN, ITEM_DOUBLE, sim->carried.value,
                                     (size_t)sim->carried.n, FORK_SKIPS, -INFINITY, FINITE});
}

/* All state, in the order of the file. */
static void list_parts(struct parts *list, struct checkpoint *m, struct simulation *sim)
{
    static const unsigned new_in_fork[KIND_COUNT] = {
        [KIND_FLUID] = G_WETTED | G_MEAN_FORCE | G_SPLIT_IMPULSE | G_SLOPE | G_FRICTION | G_MATRIX,
        [KIND_SOLID] = G_WETTED | G_MEAN_FORCE | G_SPLIT_IMPULSE | G_SLOPE | G_FRICTION | G_MATRIX,
        [KIND_WALL] = G_REFERENCE | G_RATE | G_FORCE, /* those of moving walls */
    };
    const int sections[KIND_COUNT] = {sim->scene->n_fluid, sim->scene->n_wall, sim->scene->n_solid};
    list->n = 0;
    list_run(list, m, sim);
    for (unsigned k = 0; k < KIND_COUNT; k++)
        for (int f = 0; f < field_count; f++) {
            const size_t count = (size_t)sim->particles[k].n;
            const struct field_info *const info = &field_table[f];
            void *const data = field_array(&sim->particles[k], info);
            if (!data || info->keep != KEEP_STATE) continue;
            struct part part = {info->name, k,     item_of(info->type), data, count, FORK_LOADS,
                                -FINITE,    FINITE};
            if (info->group & new_in_fork[k]) part.in_fork = FORK_LOADS_IF_THERE;
            if (data == sim->particles[k].body) part.low = 0, part.high = sections[k] - 1;
            add_part(list, part);
        }
}

/* --- capture --- */

/* Appends a block to reserved memory. */
static void put_block(struct checkpoint *m, const struct part *part)
{
    struct block_header head = {.owner = part->owner, .item = part->item, .count = part->count};
    snprintf(head.name, sizeof head.name, "%s", part->name);
    const size_t bytes = part->count * item_size[part->item];
    memcpy(m->bytes + m->size, &head, sizeof head);
    memset(m->bytes + m->size + sizeof head + bytes, 0, padded(bytes) - bytes);
    if (bytes) memcpy(m->bytes + m->size + sizeof head, part->data, bytes);
    m->size += sizeof head + padded(bytes);
}

enum err checkpoint_capture(struct checkpoint *m, struct simulation *sim, const char *case_text,
                            const char *version, struct diag *d)
{
    struct parts list;
    list_parts(&list, m, sim);
    const struct part text = {.name = "case",
                              .owner = OWNER_CASE,
                              .item = ITEM_BYTE,
                              .data = (void *)(uintptr_t)case_text,
                              .count = strlen(case_text) + 1};
    struct file_header head = {
        .format = FORMAT,
        .byte_order = BYTE_ORDER_MARK,
        .header_size = sizeof(struct file_header),
        .block_header_size = sizeof(struct block_header),
        .blocks = 1 + (uint32_t)list.n,
        .case_hash = checksum(case_text, text.count),
        .time = sim->state.time,
        .steps = sim->state.steps,
    };
    const struct file_footer foot = {.sum = 0};
    head.file_size =
        sizeof head + sizeof foot + head.blocks * sizeof(struct block_header) + padded(text.count);
    for (int k = 0; k < list.n; k++)
        head.file_size += padded(list.item[k].count * item_size[list.item[k].item]);
    TRY(reserve(m, head.file_size, d));
    memcpy(head.magic, magic, sizeof magic);
    snprintf(head.version, sizeof head.version, "%s", version);
    for (int k = 0; k < KIND_COUNT; k++) head.count[k] = sim->particles[k].n;
    memcpy(m->bytes, &head, sizeof head);
    m->size = sizeof head;
    put_block(m, &text);
    for (int k = 0; k < list.n; k++) put_block(m, &list.item[k]);
    memcpy(m->bytes + m->size, &foot, sizeof foot);
    m->size += sizeof foot;
    return ERR_OK;
}

/* --- blocks --- */

bool checkpoint_block(const struct checkpoint *m, size_t *at, struct block *b)
{
    static const char *const others[] = {"run", "case"};
    const size_t begin = *at ? *at : sizeof(struct file_header);
    const size_t end = m->size - sizeof(struct file_footer);
    struct block_header head;
    if (begin > end || end - begin < sizeof head) return false;
    memcpy(&head, m->bytes + begin, sizeof head);
    const size_t rest = end - begin - sizeof head;
    if (head.item >= ITEM_COUNT || head.count > rest / item_size[head.item] ||
        !memchr(head.name, '\0', sizeof head.name))
        return false;
    const size_t bytes = head.count * item_size[head.item];
    if (padded(bytes) > rest) return false;
    *b = (struct block){
        .owner = head.owner < KIND_COUNT    ? kind_names[head.owner]
                 : head.owner <= OWNER_CASE ? others[head.owner - KIND_COUNT]
                                            : "unknown",
        .name = (const char *)m->bytes + begin,
        .owner_number = head.owner,
        .item = head.item,
        .count = (int64_t)head.count,
        .bytes = bytes,
        .data = m->bytes + begin + sizeof head,
    };
    *at = begin + sizeof head + padded(bytes);
    return true;
}

static bool find_block(const struct checkpoint *m, const char *name, unsigned owner,
                       struct block *b)
{
    for (size_t at = 0; checkpoint_block(m, &at, b);)
        if (b->owner_number == owner && strcmp(b->name, name) == 0) return true;
    return false;
}

/* --- files of a folder --- */

static void name_file(char name[NAME_TEXT], int64_t steps)
{
    snprintf(name, NAME_TEXT, "step-%09" PRId64 ".ckpt", steps);
}

/* Steps in the name of a checkpoint; -1: of other files, and other spellings of the number. */
static int64_t steps_of(const struct dirent *entry)
{
    char name[NAME_TEXT];
    int64_t steps;
    if (entry->d_type != DT_REG && entry->d_type != DT_LNK && entry->d_type != DT_UNKNOWN)
        return -1;
    if (sscanf(entry->d_name, "step-%18" SCNd64, &steps) != 1 || steps < 0) return -1;
    name_file(name, steps);
    return strcmp(entry->d_name, name) == 0 ? steps : -1;
}

/* Replaces *steps by the next smaller number of steps of the folder's checkpoints, or by -1. */
static enum err next_file(const char *folder, int64_t *steps, struct diag *d)
{
    const int64_t limit = *steps;
    DIR *dir = opendir(folder);
    if (!dir) return diag_fail(d, ERR_IO, "%s: cannot be read: %s", folder, strerror(errno));
    *steps = -1;
    for (const struct dirent *entry; (entry = readdir(dir)) != NULL;) {
        const int64_t found = steps_of(entry);
        if (found > *steps && found < limit) *steps = found;
    }
    closedir(dir);
    return ERR_OK;
}

/* Removes unfinished checkpoints of killed runs. */
static void remove_unfinished(const char *folder)
{
    static const char end[] = ".ckpt.part";
    DIR *dir = opendir(folder);
    if (!dir) return;
    for (const struct dirent *entry; (entry = readdir(dir)) != NULL;) {
        const size_t length = strlen(entry->d_name);
        if (strncmp(entry->d_name, "step-", 5) == 0 && length > sizeof end &&
            strcmp(entry->d_name + length - (sizeof end - 1), end) == 0)
            unlinkat(dirfd(dir), entry->d_name, 0);
    }
    closedir(dir);
}

enum err checkpoint_remove_others(const char *folder, int64_t newest, struct diag *d)
{
    char name[NAME_TEXT], path[PATH_BYTES];
    int kept = 0;
    remove_unfinished(folder);
    for (int64_t steps = INT64_MAX;;) {
        TRY(next_file(folder, &steps, d));
        if (steps < 0) return ERR_OK;
        if (steps <= newest && ++kept <= KEEP) continue;
        name_file(name, steps);
        TRY(path_join(path, folder, name, d));
        if (unlink(path) != 0)
            return diag_fail(d, ERR_IO, "%s: cannot be removed: %s", path, strerror(errno));
    }
}

/* --- store --- */

void checkpoint_seal(struct checkpoint *m)
{
    struct file_footer foot = {.sum = checksum(m->bytes, m->size - sizeof foot)};
    memcpy(foot.magic, footer_magic, sizeof foot.magic);
    memcpy(m->bytes + m->size - sizeof foot, &foot, sizeof foot);
}

enum err checkpoint_store(struct checkpoint *m, const char *folder, char path[PATH_BYTES],
                          struct diag *d)
{
    struct atomic_file out;
    char name[NAME_TEXT];
    const struct checkpoint_info info = checkpoint_info(m);
    checkpoint_seal(m);
    name_file(name, info.steps);
    TRY(atomic_file_open(&out, folder, name, d));
    /* atomic_file_commit reports a short write, by ferror. */
    if (fwrite(m->bytes, 1, m->size, out.file) != m->size && !ferror(out.file)) {
        atomic_file_abandon(&out);
        return diag_fail(d, ERR_IO, "%s: cannot be written", out.path);
    }
    TRY(atomic_file_commit(&out, d));
    memcpy(path, out.path, PATH_BYTES);
    struct diag why = {.code = ERR_OK}; /* a failure to remove does not stop the run */
    if (checkpoint_remove_others(folder, info.steps, &why)) diag_warn(d, "%s", why.text);
    return ERR_OK;
}

/* --- read --- */

static enum err damaged(struct diag *d, const char *path, const char *what)
{
    return diag_fail(d, ERR_IO, "%s: is not a valid checkpoint: %s", path, what);
}

static enum err check_header(const struct checkpoint *m, const char *path, struct diag *d)
{
    struct file_header head;
    if (m->size < sizeof head + sizeof(struct file_footer))
        return damaged(d, path, "it is shorter than a header and a footer");
    memcpy(&head, m->bytes, sizeof head);
    if (memcmp(head.magic, magic, sizeof magic) != 0)
        return damaged(d, path, "its first 8 bytes are wrong");
    /* Before the checksum, since another format has another one. */
    if (head.byte_order != BYTE_ORDER_MARK) return damaged(d, path, "its byte-order mark is wrong");
    if (head.format != FORMAT)
        return diag_fail(d, ERR_IO,
                         "%s: has format %u, but this program reads format %d; continue the run "
                         "with version %.*s, which wrote the file (its bytes 88 to 135)",
                         path, head.format, FORMAT, (int)sizeof head.version - 1, head.version);
    if (head.file_size != m->size) return damaged(d, path, "its length is wrong; it was cut short");
    return ERR_OK;
}

enum err checkpoint_check(const struct checkpoint *m, const char *name, struct diag *d)
{
    struct file_footer foot;
    struct block b;
    size_t at = 0;
    TRY(check_header(m, name, d));
    memcpy(&foot, m->bytes + m->size - sizeof foot, sizeof foot);
    if (memcmp(foot.magic, footer_magic, sizeof foot.magic) != 0 ||
        foot.sum != checksum(m->bytes, m->size - sizeof foot))
        return damaged(d, name, "its checksum is wrong");
    while (checkpoint_block(m, &at, &b)) continue;
    if (at != m->size - sizeof foot) return damaged(d, name, "its blocks do not fill it");
    return ERR_OK;
}

enum err checkpoint_read(struct checkpoint *m, const char *path, struct diag *d)
{
    char *bytes;
    size_t size;
    TRY(file_read(path, &bytes, &size, d));
    checkpoint_free(m);
    m->bytes = (unsigned char *)bytes;
    m->size = m->capacity = size;
    return checkpoint_check(m, path, d);
}

enum err checkpoint_newest(struct checkpoint *m, const char *folder, char path[PATH_BYTES],
                           struct diag *d)
{
    char name[NAME_TEXT];
    int damaged_ones = 0;
    for (int64_t steps = INT64_MAX;; damaged_ones++) {
        struct diag why = {.code = ERR_OK};
        TRY(next_file(folder, &steps, d));
        if (steps < 0) break;
        name_file(name, steps);
        TRY(path_join(path, folder, name, d));
        const enum err e = checkpoint_read(m, path, &why);
        if (e == ERR_OK) return ERR_OK;
        /* Without memory this one may be valid. A restart from an older one would remove it. */
        if (e == ERR_MEMORY) return diag_fail(d, e, "%s", why.text);
        diag_warn(d, "%s; trying the checkpoint before it", why.text);
    }
    return diag_fail(d, ERR_IO, "%s: contains no %scheckpoint (step-*.ckpt)", folder,
                     damaged_ones ? "valid " : "");
}

enum err checkpoint_find(struct checkpoint *m, const char *at, char path[PATH_BYTES],
                         struct diag *d)
{
    struct stat info;
    if (stat(at, &info) == 0 && S_ISDIR(info.st_mode)) return checkpoint_newest(m, at, path, d);
    snprintf(path, PATH_BYTES, "%s", at);
    return checkpoint_read(m, at, d);
}

struct checkpoint_info checkpoint_info(const struct checkpoint *m)
{
    struct file_header head;
    memcpy(&head, m->bytes, sizeof head);
    struct checkpoint_info info = {.time = head.time, .steps = head.steps, .case_text = ""};
    memcpy(info.count, head.count, sizeof info.count);
    memcpy(info.version, head.version, sizeof info.version - 1);
    struct block b;
    if (find_block(m, "case", OWNER_CASE, &b) && b.bytes > 0 && b.data[b.bytes - 1] == '\0')
        info.case_text = (const char *)b.data;
    return info;
}

static double number_of(const struct block *b, int64_t k)
{
    double number;
    int64_t whole;
    int32_t small;
    const unsigned char *const at = b->data + (size_t)k * item_size[b->item];
    switch (b->item) {
    case ITEM_DOUBLE: memcpy(&number, at, sizeof number); return number;
    case ITEM_INT64: memcpy(&whole, at, sizeof whole); return (double)whole;
    case ITEM_INT32: memcpy(&small, at, sizeof small); return small;
    default: return *at;
    }
}

/* --- apply --- */

/* A checksum does not protect from a file that was made wrong. */
static enum err load_part(const struct checkpoint *m, const struct part *part, struct diag *d)
{
    struct block b;
    if (!find_block(m, part->name, part->owner, &b))
        return diag_fail(d, ERR_INPUT, "checkpoint: it has no block %s, which this case needs",
                         part->name);
    if (b.item != part->item || b.count != (int64_t)part->count)
        return diag_fail(d, ERR_INPUT,
                         "checkpoint: block %s holds %" PRId64
                         " items of type %s, but this case needs %zu of type %s",
                         part->name, b.count, item_name[b.item], part->count,
                         item_name[part->item]);
    for (int64_t k = 0; k < b.count && isfinite(part->low); k++) {
        const double number = number_of(&b, k);
        if (number >= part->low && number <= part->high) continue;
        return diag_fail(d, ERR_INPUT,
                         "checkpoint: %s of %s, item %" PRId64
                         ", is %g, outside the valid range %g to %g; the file is damaged or of "
                         "another case",
                         part->name, b.owner, k, number, part->low, part->high);
    }
    if (b.bytes) memcpy(part->data, b.data, b.bytes);
    return ERR_OK;
}

/* Numbers with a narrower range, such as what divides the step of a solid. */
static enum err check_state(const struct simulation *sim, struct diag *d)
{
    const struct state *const state = &sim->state;
    bool valid =
        !(sim->effects & FX_SOLID) || min2(state->solid_stiffening, state->solid_slowing) >= 1e-9;
    for (int k = 0; k < ENERGY_ENTRIES; k++)
        valid &= state->energy.entry[k].region >= -1 && state->energy.entry[k].region <= k &&
                 state->energy.entry[k].work_change >= 0;
    return valid ? ERR_OK
                 : diag_fail(d, ERR_INPUT,
                             "checkpoint: the account of energy, solid_stiffening or "
                             "solid_slowing are invalid; the file is damaged");
}

/* Sets a field that the run of the checkpoint did not have. Reference positions are the present
 * ones; all else is zero: velocities of a wall that was at rest, interface impulses, mean forces,
 * and gradients until they are found. */
static void set_missing(const struct particles *particles, const struct part *part)
{
    const void *position = part->data == particles->X   ? particles->x
                           : part->data == particles->Y ? particles->y
                                                        : NULL;
    const size_t bytes = part->count * item_size[part->item];
    if (position)
        memcpy(part->data, position, bytes);
    else
        memset(part->data, 0, bytes);
}

enum err checkpoint_load(struct checkpoint *m, struct simulation *sim, bool fork, struct diag *d)
{
    const struct checkpoint_info info = checkpoint_info(m);
    struct parts list;
    struct block b;
    for (int k = 0; k < KIND_COUNT; k++) {
        const int64_t n = info.count[k], most = sim->particles[k].capacity;
        if (n < 0 || n > most)
            return diag_fail(d, ERR_INPUT,
                             "checkpoint: it has %" PRId64 " %s particles, but the case has "
                             "%" PRId64,
                             n, kind_names[k], most);
        sim->particles[k].n = n;
    }
    list_parts(&list, m, sim);
    for (const struct part *part = list.item; part < list.item + list.n; part++) {
        if (fork && part->in_fork == FORK_SKIPS) continue;
        if (fork && part->in_fork == FORK_LOADS_IF_THERE &&
            !find_block(m, part->name, part->owner, &b))
            set_missing(&sim->particles[part->owner], part);
        else
            TRY(load_part(m, part, d));
    }
    return check_state(sim, d);
}

enum err checkpoint_check_cells(const struct simulation *sim, struct diag *d)
{
    const int64_t cells = (int64_t)sim->cells.nx * sim->cells.ny;
    for (int k = 0; k < KIND_COUNT; k++)
        for (int64_t i = 0; i < sim->particles[k].n; i++) {
            const struct particles *const particles = &sim->particles[k];
            const int32_t cell = particles->cell[i];
            const bool known = cell >= -1 && cell < cells;
            if (known &&
                (cell < 0 || cells_is_near(&sim->cells, cell, particles->x[i], particles->y[i])))
                continue;
            return diag_fail(d, ERR_INPUT,
                             "checkpoint: %s particle %" PRId64 " at (%.6g, %.6g) m %s cell %d, of "
                             "-1 (outside) to %" PRId64 "; the file is damaged or of another case",
                             kind_names[k], i, particles->x[i], particles->y[i],
                             known ? "is too far from its" : "has no", cell, cells - 1);
        }
    return ERR_OK;
}

enum err checkpoint_apply(struct checkpoint *m, struct simulation *sim, struct diag *d)
{
    TRY(checkpoint_load(m, sim, false, d));
    if (sim->effects & FX_FLUID) TRY(checkpoint_check_cells(sim, d));
    return simulation_resume(sim, d);
}

void checkpoint_free(struct checkpoint *m)
{
    free(m->bytes);
    *m = (struct checkpoint){0};
}
