/* SPDX-License-Identifier: MIT
 * --inspect: the contents of a checkpoint as text. */
#include "app/session.h"

#include "output/checkpoint.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void say_head(const char *path, const struct image *m, const struct sphfsi_options *o)
{
    const struct image_info info = checkpoint_info(m);
    session_say(o, "%s: a valid checkpoint of %zu bytes, written by sphfsi %s", path, m->size,
                info.version);
    session_say(o, "  time %.9g s, %lld steps", info.time, (long long)info.steps);
    for (int k = 0; k < KIND_COUNT; k++)
        session_say(o, "  %-6s %10lld particles", kind_names[k], (long long)info.count[k]);
}

/* Smallest and largest of a field, or the value of a scalar. */
static void say_values(const struct block *b, char text[96])
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    int64_t odd = 0;
    for (int64_t k = 0; k < b->count; k++) {
        const double value = checkpoint_number(b, k);
        odd += !isfinite(value);
        low = value < low ? value : low;
        high = value > high ? value : high;
    }
    text[0] = '\0';
    if (odd)
        snprintf(text, 96, "%lld of them not finite", (long long)odd);
    else if (b->count == 1)
        snprintf(text, 96, "%.9g", low);
    else if (b->count > 1)
        snprintf(text, 96, "%.6g to %.6g", low, high);
}

static void say_blocks(const struct image *m, const struct sphfsi_options *o)
{
    static const char *const types[ITEM_COUNT] = {"double", "int64", "int32", "byte"};
    struct block b;
    session_say(o, "blocks: owner, name, items, type, values");
    for (size_t at = 0; checkpoint_block(m, &at, &b);) {
        char values[96] = "the effective case, below";
        if (strcmp(b.owner, "case") != 0) say_values(&b, values);
        session_say(o, "  %-6s %-18s %10lld %-6s %s", b.owner, b.name, (long long)b.count,
                    types[b.item], values);
    }
}

static void say_case(const char *text, const struct sphfsi_options *o)
{
    session_say(o, "case:");
    while (*text) {
        const int length = (int)strcspn(text, "\n");
        session_say(o, "%.*s", length, text);
        text += length + (text[length] == '\n');
    }
}

static enum err inspect_file(const char *path, const struct sphfsi_options *o, struct diag *d)
{
    struct image m = {0};
    char file[PATH_BYTES];
    const enum err e = checkpoint_find(&m, path, file, d);
    if (!e) {
        say_head(file, &m, o);
        say_blocks(&m, o);
        say_case(checkpoint_info(&m).case_text, o);
    }
    checkpoint_free(&m);
    if (e == ERR_IO) d->code = ERR_INPUT;
    return d->code;
}

enum sphfsi_status sphfsi_inspect(const char *file, const struct sphfsi_options *options)
{
    struct call c;
    if (!file) return call_null_argument("inspect", "file");
    enum err e = call_begin(&c, "inspect", options);
    if (!e) e = inspect_file(file, &c.options, &c.diag);
    return call_end(&c, e);
}
