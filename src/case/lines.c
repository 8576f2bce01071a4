/* SPDX-License-Identifier: MIT
 * Lines of a case file: sections, keys and their values as text; --set arguments. */
#include "case/case.h"

#include <ctype.h>

static bool blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

static char *trim(char *text)
{
    while (blank(*text)) text++;
    char *end = text + strlen(text);
    while (end > text && blank(end[-1])) *--end = '\0';
    return text;
}

static bool is_name(const char *text)
{
    if (!*text) return false;
    for (const char *c = text; *c; c++)
        if (!isalnum((unsigned char)*c) && *c != '_' && *c != '-') return false;
    return true;
}

static bool is_identifier(const char *text)
{
    const size_t length = slice_identifier(slice_of(text)).length;
    return length > 0 && !text[length];
}

/* Removes the comment from a value; text between quotes is unchanged, without its quotes. */
static const char *cut_value(char *value, const char **why)
{
    *why = NULL;
    value = trim(value);
    if (*value != '"') {
        char *comment = strchr(value, '#');
        if (comment) *comment = '\0';
        value = trim(value);
        if (!*value) *why = "has no value";
        return value;
    }
    char *close = strchr(value + 1, '"');
    if (!close) {
        *why = "has a quote that is not closed; end the text with \"";
        return value;
    }
    char *const rest = trim(close + 1);
    if (*rest && *rest != '#') *why = "has text after the closing quote; a comment begins with #";
    close[1] = '\0';
    return value;
}

static int find_section_id(const char *word)
{
    for (int id = SECTION_top + 1; id <= SECTION_constants; id++)
        if (strcmp(section_table[id].word, word) == 0) return id;
    return -1;
}

static enum err unknown_section(struct reader *r, int line, const char *word)
{
    struct nearest near = {0};
    for (int id = SECTION_top + 1; id <= SECTION_constants; id++)
        nearest_offer(&near, word, section_table[id].word);
    return bad_line(r, line, "unknown section [%.60s]%s", word,
                    near.name ? nearest_hint(&near) : "; --keys lists them");
}

static enum err add_section(struct reader *r, int line, int id, const char *name)
{
    const bool named = section_table[id].named;
    const char *const word = section_table[id].word;
    if (named && !*name) return bad_line(r, line, "[%s] needs a name: [%s NAME]", word, word);
    if (!named && *name) return bad_line(r, line, "[%s] takes no name", word);
    if (named && (!is_name(name) || strlen(name) >= SCENE_NAME))
        return bad_line(r, line, "[%s %.70s]: a name has up to %d letters, digits, _ and -", word,
                        name, SCENE_NAME - 1);
    int index = 0;
    for (int k = 0; k < r->n_sections; k++) {
        if (r->sections[k].id != id) continue;
        if (strcmp(r->sections[k].name, name) == 0)
            return bad_line(
                r, line, "[%s%s%s] is given twice, first in line %d; merge the two or rename one",
                word, named ? " " : "", name, r->sections[k].line);
        index++;
    }
    if (index == SCENE_MAX_SECTIONS)
        return bad_line(r, line, "more than %d [%s] sections are given; merge some of them",
                        SCENE_MAX_SECTIONS, word);
    r->sections[r->n_sections++] = (struct case_section){id, name, line, index};
    return ERR_OK;
}

static enum err read_header(struct reader *r, int line, char *text)
{
    char *close = strchr(text, ']');
    if (!close) return bad_line(r, line, "`[` without `]`; a section is [WORD] or [WORD NAME]");
    char *const rest = trim(close + 1);
    if (*rest && *rest != '#')
        return bad_line(r, line, "text after the section's `]`; a comment begins with #");
    *close = '\0';
    char *word = trim(text + 1), *name = word;
    while (*name && !blank(*name)) name++;
    if (*name) *name++ = '\0';
    const int id = find_section_id(word);
    if (id < 0) return unknown_section(r, line, word);
    return add_section(r, line, id, trim(name));
}

static enum err read_entry(struct reader *r, int line, char *text)
{
    char *equals = strchr(text, '=');
    const char *const comment = strchr(text, '#');
    if (!equals || (comment && comment < equals))
        return bad_line(r, line, "`%.40s` is neither `key = value` nor `[section]`", text);
    *equals = '\0';
    const char *const key = trim(text);
    if (!is_identifier(key) || strlen(key) >= SCENE_NAME)
        return bad_line(r, line,
                        "`%.40s` is not a valid key: a key has up to %d letters, digits and _", key,
                        SCENE_NAME - 1);
    const char *why;
    const char *const value = cut_value(equals + 1, &why);
    if (why) return bad_line(r, line, "`%s` %s", key, why);
    if (!r->in_unknown_section)
        r->entries[r->n_entries++] =
            (struct entry){.section = r->n_sections - 1, .line = line, .key = key, .value = value};
    return ERR_OK;
}

static enum err read_line(struct reader *r, int line, char *text)
{
    for (const char *c = text; *c; c++)
        if ((unsigned char)*c < ' ' && !blank(*c))
            return bad_line(r, line, "control byte %d; a case file is plain text", *c);
    text = trim(text);
    if (!*text || *text == '#') return ERR_OK;
    if (*text != '[') return read_entry(r, line, text);
    const enum err err = read_header(r, line, text);
    r->in_unknown_section = err != ERR_OK;
    return err;
}

/* --- --set --- */

const struct entry *case_entry(const struct reader *r, int section, const char *key)
{
    for (int k = 0; k < r->n_entries; k++)
        if (r->entries[k].section == section && strcmp(r->entries[k].key, key) == 0)
            return &r->entries[k];
    return NULL;
}

/* Whether a section has a key: one of case/params.def, or a constant of the file. */
static bool takes_key(const struct reader *r, int section, const char *key)
{
    const int id = r->sections[section].id;
    return id == SECTION_constants ? case_entry(r, section, key) != NULL
                                   : param_find((enum section_id)id, key) != NULL;
}

/* Whether "solid gate", "gate", "numerics" or "" (top and constants) names a section. */
static bool means_section(const struct case_section *s, const char *prefix)
{
    if (!*prefix) return s->id == SECTION_top || s->id == SECTION_constants;
    const char *const word = section_table[s->id].word;
    if (!*s->name) return s->id != SECTION_top && strcmp(word, prefix) == 0;
    if (strcmp(s->name, prefix) == 0) return true;
    const size_t length = strlen(word);
    if (strncmp(prefix, word, length) != 0 || !blank(prefix[length])) return false;
    while (blank(prefix[length])) prefix++;
    return strcmp(prefix + length, s->name) == 0;
}

/* --set can also set keys of an unnamed section that the file does not contain. */
static enum err add_missing(struct reader *r, const char *prefix)
{
    const int id = *prefix ? find_section_id(prefix) : -1;
    if (id < 0 || id == SECTION_constants || section_table[id].named) return ERR_OK;
    for (int k = 0; k < r->n_sections; k++)
        if (r->sections[k].id == id) return ERR_OK;
    return add_section(r, 0, id, "");
}

static const char *name_of(const struct case_section *s)
{
    return *s->name ? s->name : section_table[s->id].word;
}

/* A key of --set that no section of this prefix has: what it may be, or where it belongs. */
static enum err unknown_in_set(struct reader *r, const char *prefix, int id)
{
    const struct entry *const e = r->entry;
    struct nearest near = {0};
    for (int k = 0; k < r->n_sections && !*prefix; k++)
        if (takes_key(r, k, e->key))
            return bad_entry(r, "unknown key or constant `%.60s`; write `%s.%s`", e->key,
                             name_of(&r->sections[k]), e->key);
    for (int k = 0; k < r->n_entries; k++)
        if (r->sections[r->entries[k].section].id == SECTION_constants &&
            (!*prefix || id == SECTION_constants))
            nearest_offer(&near, e->key, r->entries[k].key);
    const char *const hint = param_hint((enum section_id)id, e->key, &near);
    return bad_entry(r, "unknown %s `%.60s`%s", *prefix || *hint ? "key" : "key or constant",
                     e->key, hint);
}

/* Finds the only section with the key among those that the prefix of --set means. */
static enum err find_target(struct reader *r, const char *prefix, int *target)
{
    const struct entry *const e = r->entry;
    struct nearest near = {0};
    int meant = -1;
    TRY(add_missing(r, prefix));
    *target = -1;
    for (int k = 0; k < r->n_sections; k++) {
        const struct case_section *const s = &r->sections[k];
        if (*prefix && s->id != SECTION_top) nearest_offer(&near, prefix, name_of(s));
        if (*s->name && strcmp(section_table[s->id].word, prefix) == 0 &&
            (!near.name || near.distance > 0))
            near = (struct nearest){.name = s->name};
        if (!means_section(s, prefix)) continue;
        if (meant < 0) meant = s->id;
        if (!takes_key(r, k, e->key)) continue;
        const struct case_section *const first = *target < 0 ? NULL : &r->sections[*target];
        if (first)
            return bad_entry(r,
                             "[%s %s] and [%s %s] both have `%s`; write for example \"%s %s.%s\"",
                             section_table[first->id].word, first->name, section_table[s->id].word,
                             s->name, e->key, section_table[*first->name ? first->id : s->id].word,
                             *first->name ? first->name : s->name, e->key);
        *target = k;
    }
    if (*target >= 0) return ERR_OK;
    if (meant >= 0) return unknown_in_set(r, prefix, meant);
    return bad_entry(r,
                     near.name ? "there is no section `%.60s`%s"
                               : "the case has no section `%.60s`%s",
                     prefix, nearest_hint(&near));
}

/* Replaces the file's entry for the key (all entries of a list of shapes). */
static void put_entry(struct reader *r, struct entry e)
{
    int kept = 0;
    for (int k = 0; k < r->n_entries; k++)
        if (r->entries[k].section != e.section || strcmp(r->entries[k].key, e.key) != 0)
            r->entries[kept++] = r->entries[k];
    r->entries[kept] = e;
    r->n_entries = kept + 1;
}

static enum err apply_set(struct reader *r, const char *set)
{
    struct entry e = {.set = set, .key = ""};
    r->entry = &e;
    const size_t bytes = strlen(set) + 1;
    char *copy = arena_alloc(&r->temp, bytes, 1, "--set", r->diag);
    if (!copy) return ERR_MEMORY;
    memcpy(copy, set, bytes);
    for (const char *c = copy; *c; c++)
        if ((unsigned char)*c < ' ' && *c != '\t') return bad_entry(r, "control byte %d", *c);
    char *value = strchr(copy, '=');
    if (!value) return bad_entry(r, "write key=value or section.key=value");
    *value++ = '\0';
    char *key = trim(copy), *prefix = copy + strlen(copy);
    char *const dot = strrchr(key, '.');
    if (dot) {
        *dot = '\0';
        prefix = trim(key);
        key = trim(dot + 1);
    }
    if (!is_identifier(key) || strlen(key) >= SCENE_NAME || (dot && !*prefix))
        return bad_entry(r, "write key=value or section.key=value");
    e.key = key;
    const char *why;
    e.value = cut_value(value, &why);
    if (why) return bad_entry(r, "`%s` %s", key, why);
    TRY(find_target(r, prefix, &e.section));
    put_entry(r, e);
    return ERR_OK;
}

/* --- all --- */

enum err case_split(struct reader *r, const char *text, int n_sets, const char *const *sets)
{
    int n_lines = 1;
    for (const char *c = text; *c; c++) n_lines += *c == '\n';
    if (n_lines > CASE_MAX_LINES)
        return bad_line(r, CASE_MAX_LINES, "the case file has more than %d lines", CASE_MAX_LINES);
    const size_t capacity = (size_t)n_lines + (size_t)n_sets + 1;
    r->entries = arena_alloc(&r->temp, capacity, sizeof *r->entries, "case file", r->diag);
    r->sections = arena_alloc(&r->temp, capacity, sizeof *r->sections, "case file", r->diag);
    const size_t bytes = strlen(text) + 1;
    char *copy = arena_alloc(&r->temp, bytes, 1, "case file", r->diag);
    if (!r->entries || !r->sections || !copy) return ERR_MEMORY;
    memcpy(copy, text, bytes);
    if (strncmp(copy, "\xEF\xBB\xBF", 3) == 0) copy += 3; /* a byte-order mark */
    r->sections[r->n_sections++] = (struct case_section){SECTION_top, "", 1, 0};
    int line = 1;
    for (char *next; copy; copy = next, line++) {
        next = strchr(copy, '\n');
        if (next) *next++ = '\0';
        const enum err err = read_line(r, line, copy);
        if (err) r->incomplete = true;
        TRY(case_go_on(r, err));
    }
    for (int k = 0; k < n_sets; k++) TRY(case_go_on(r, apply_set(r, sets[k])));
    return ERR_OK;
}
