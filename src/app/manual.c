/* SPDX-License-Identifier: MIT
 * The reference of keys, from the same tables as the reader of cases; publications; templates of
 * cases. */
#include "app/session.h"
#include "app/embedded.h"
#include "base/csv.h"
#include "output/probes.h"

static bool pure(const struct param *param)
{
    return !param->unit || strcmp(param->unit, "1") == 0;
}

/* A number or the name of a choice. */
static void value_of(const struct param *param, double value, char *text, size_t size)
{
    if (param->type == PARAM_CHOICE)
        snprintf(text, size, "%s", param_choice(param, (int)value).text);
    else
        snprintf(text, size, "%g", value);
}

/* The default as in a case file; "" if there is none. */
static void default_of(const struct param *param, char *text, size_t size)
{
    const double value = param->number.value;
    const char *const space = pure(param) ? "" : " ", *const unit = pure(param) ? "" : param->unit;
    text[0] = '\0';
    switch (param->type) {
    case PARAM_REAL:
        if (!isnan(value))
            snprintf(text, size, "%g%s%s", value, value == 0 ? "" : space, value == 0 ? "" : unit);
        break;
    case PARAM_INTEGER:
    case PARAM_CHOICE: value_of(param, value, text, size); break;
    case PARAM_VECTOR:
        if (!isnan(param->vector_default[0]))
            snprintf(text, size, "%g, %g", param->vector_default[0], param->vector_default[1]);
        break;
    case PARAM_TEXT: snprintf(text, size, "%s", param->text_default); break;
    default: break;
    }
}

/* Whether a line is `key = ...`. */
static bool gives(const char *line, const char *key)
{
    const size_t length = strlen(key);
    return strncmp(line, key, length) == 0 && strncmp(line + length, " = ", 3) == 0;
}

void manual_example(const struct param *param, char *text, size_t size)
{
    const char *const word = section_table[param->section].word;
    const size_t length = strlen(word);
    bool inside = param->section == SECTION_top;
    const char *line = embedded_text("src/app/data/key_examples.cfg");
    for (; *line; line = csv_next_line(line)) {
        const int end = (int)strcspn(line, "\n");
        if (line[0] == '[')
            inside = strncmp(line + 1, word, length) == 0 && line[length + 1] == ']';
        if (!inside || !gives(line, param->key)) continue;
        const int value = (int)strlen(param->key) + 3;
        snprintf(text, size, "%.*s", end - value, line + value);
        return;
    }
    default_of(param, text, size);
}

static void param_type_text(const struct param *param, char *text, size_t size)
{
    static const char *const names[] = {
        [PARAM_REAL] = "number",
        [PARAM_INTEGER] = "whole number",
        [PARAM_CHOICE] = "choice",
        [PARAM_TEXT] = "text",
        [PARAM_VECTOR] = "two numbers",
        [PARAM_EXPR] = "expression",
        [PARAM_SHAPES] = "shape, may be repeated",
        [PARAM_HINGES] = "point, may be repeated",
    };
    static const char *const scopes[] = {"", " in x, y", " in t", " in x, y, t", " in e"};
    const char *const name = names[param->type];
    if (param->expr_offset)
        snprintf(text, size, "%s or expressions%s", name, scopes[param->scope]);
    else
        snprintf(text, size, "%s%s%s%s",
                 param->type == PARAM_EXPR && param->count == 2 ? "two " : "", name,
                 param->type == PARAM_EXPR && param->count == 2 ? "s" : "", scopes[param->scope]);
}

/* What the default scheme sets a key to in a kind of scene; false: it leaves the default. */
static const char *const kind_words[] = {"with solids", "with fluid", "with an inflow, no gravity",
                                         "with fluid and solids"};
static bool scheme_value(const struct param *param, int kind, char *text, size_t size)
{
    double value;
    const bool set =
        scheme_sets(SCHEME_STANDARD, (enum scene_kind)kind, param->section, param->key, &value);
    if (set) value_of(param, value, text, size);
    return set;
}

/* --- as text --- */

static void say_key(const struct param *param, const struct sphfsi_options *o)
{
    const bool number = param->type == PARAM_REAL || param->type == PARAM_INTEGER,
               choice = param->type == PARAM_CHOICE;
    char type[64], range[128] = "", fallback[SCENE_TEXT], meaning[768], value[SCENE_NAME];
    param_type_text(param, type, sizeof type);
    default_of(param, fallback, sizeof fallback);
    snprintf(meaning, sizeof meaning, "%s", param->meaning);
    for (int k = 0; k < SCENE_KINDS; k++)
        if (scheme_value(param, k, value, sizeof value))
            snprintf(meaning + strlen(meaning), sizeof meaning - strlen(meaning), "; %s: %s",
                     kind_words[k], value);
    if (number)
        snprintf(range, sizeof range, " %s %g, %s %g",
                 param->low.open ? ">" : ">=", param->low.value,
                 param->high.open ? "<" : "<=", param->high.value);
    session_say(o, "  %s%s%s: %s%s%s%s%s: %s", param->key, *fallback ? " = " : "", fallback,
                choice ? param->choices : type, pure(param) ? "" : ", ",
                pure(param) ? "" : param->unit, range, param->number.needed ? ", needed" : "",
                meaning);
}

enum sphfsi_status sphfsi_keys(const struct sphfsi_options *options)
{
    struct call c;
    const enum err e = call_begin(&c, "keys", options);
    const struct sphfsi_options *const o = &c.options;
    for (int k = 0; k < PARAM_COUNT && !e; k++) {
        const enum section_id id = param_table[k].section;
        const struct section_info *const info = &section_table[id];
        if (k == 0 || id != param_table[k - 1].section)
            session_say(o, "[%s%s] %s", info->word, info->named ? " NAME" : "", info->meaning);
        say_key(&param_table[k], o);
    }
    if (!e) session_say(o, "Quantities of a probe, and their columns");
    for (int k = 0; k < PROBE_QUANTITIES && !e; k++)
        session_say(o, "  %s (%s): %s", quantity_table[k].name, quantity_table[k].columns,
                    quantity_table[k].meaning);
    return call_end(&c, e);
}

/* --- as JSON --- */

static void write_range(struct json *j, const struct param *param)
{
    if (param->type == PARAM_CHOICE) {
        json_open(j, "choices", '[');
        for (int k = 0; *param_choice(param, k).text; k++)
            json_text(j, NULL, param_choice(param, k).text);
        json_close(j, ']');
    } else if (param->type == PARAM_REAL || param->type == PARAM_INTEGER) {
        json_number(j, param->low.open ? "exclusiveMinimum" : "minimum", param->low.value);
        json_number(j, param->high.open ? "exclusiveMaximum" : "maximum", param->high.value);
    }
}

/* The default as a text of a case, and what the default scheme sets instead by kind of scene. */
static void write_default(struct json *j, const struct param *param)
{
    char text[SCENE_TEXT], name[SCENE_NAME];
    default_of(param, text, sizeof text);
    if (param->number.needed)
        json_integer(j, "needed", 1);
    else if (text[0])
        json_text(j, "default", text);
    for (int k = 0; k < SCENE_KINDS; k++) {
        snprintf(name, sizeof name, "default %s", kind_words[k]);
        if (scheme_value(param, k, text, sizeof text)) json_text(j, name, text);
    }
}

static void write_key(struct json *j, const struct param *param)
{
    char type[64], text[SCENE_TEXT];
    param_type_text(param, type, sizeof type);
    json_open(j, param->key, '{');
    json_text(j, "type", type);
    if (!pure(param)) json_text(j, "unit", param->unit);
    write_range(j, param);
    write_default(j, param);
    json_text(j, "meaning", param->meaning);
    manual_example(param, text, sizeof text);
    json_text(j, "example", text);
    json_close(j, '}');
}

static void write_section(struct json *j, enum section_id id)
{
    json_open(j, section_table[id].word, '{');
    json_text(j, "meaning", section_table[id].meaning);
    json_integer(j, "named", section_table[id].named);
    json_open(j, "keys", '{');
    for (int k = 0; k < PARAM_COUNT; k++)
        if (param_table[k].section == id) write_key(j, &param_table[k]);
    json_close(j, '}');
    json_close(j, '}');
}

static enum err write_keys(struct json *j, void *unused, struct diag *d)
{
    (void)unused, (void)d;
    json_open(j, NULL, '{');
    json_open(j, "sections", '{');
    for (int id = 0; id < SECTION_COUNT; id++) write_section(j, (enum section_id)id);
    json_close(j, '}');
    json_open(j, "quantities", '{');
    for (int k = 0; k < PROBE_QUANTITIES; k++) {
        json_open(j, quantity_table[k].name, '{');
        json_integer(j, "target", quantity_table[k].target);
        json_text(j, "columns", quantity_table[k].columns);
        json_text(j, "meaning", quantity_table[k].meaning);
        json_close(j, '}');
    }
    json_close(j, '}');
    json_open(j, "effects", '{');
    for (int k = 0; k < EFFECT_COUNT; k++) {
        json_open(j, effect_table[k].name, '{');
        json_text(j, "enabled_by", effect_table[k].key);
        json_text(j, "meaning", effect_table[k].meaning);
        json_text(j, "source", effect_table[k].equation);
        json_close(j, '}');
    }
    json_close(j, '}');
    json_close(j, '}');
    return ERR_OK;
}

enum sphfsi_status sphfsi_keys_json(const struct sphfsi_options *options)
{
    struct call c;
    enum err e = call_begin(&c, "keys", options);
    if (!e) e = session_json(&c.options, write_keys, NULL, &c.diag);
    return call_end(&c, e);
}

/* --- publications: src/app/data/citations.txt --- */

/* Conditions on a scene that are no effects. */
static bool meets_condition(const struct scene *scene, effect_set effects, const char *word)
{
    const int shifted = effects & FX_SHIFTING ? scene->fluid[0].shifting_speed : -1;
    bool hyperelastic = false, probed = false;
    for (int k = 0; k < scene->n_solid; k++) hyperelastic |= scene->solid[k].law != LAW_PAPER;
    for (int k = 0; k < scene->n_probe; k++)
        probed |= scene_probe_target(&scene->probe[k]) == TARGET_SOLID_POINT &&
                  scene_find(scene, SECTION_solid, scene->probe[k].body) >= 0;
    const struct {
        const char *word;
        bool met;
    } condition[] = {
        {"ALWAYS", true},
        {"HYPERELASTIC", hyperelastic},
        {"SETTLED", scene->settled},
        {"PROBED_MATERIAL", probed},
        {"SHIFTED_BY_OWN_SPEED", shifted == SHIFTING_OWN},
        {"SHIFTED_BY_LARGEST_SPEED", shifted == SHIFTING_LARGEST},
        {"SYMPLECTIC", scene->top.integrator == INTEGRATOR_SYMPLECTIC},
    };
    bool met = false;
    for (size_t k = 0; k < COUNT_OF(condition); k++)
        met |= condition[k].met && strcmp(condition[k].word, word) == 0;
    for (int k = 0; k < EFFECT_COUNT; k++)
        met |= effects & EFFECT_BIT(k) && strcmp(effect_table[k].name, word) == 0;
    return met;
}

static enum err cite(struct session *session, const struct sphfsi_options *o, struct diag *d)
{
    (void)d;
    const struct scene *const scene = &session->scene;
    const effect_set effects = effects_of_scene(scene);
    const char *line = embedded_text("src/app/data/citations.txt");
    for (; *line; line = csv_next_line(line)) {
        const int end = (int)strcspn(line, "\n"), head = (int)strcspn(line, ":\n");
        char words[SCENE_TEXT], word[SCENE_TEXT];
        bool used = false;
        snprintf(words, sizeof words, "%.*s", head, line);
        for (int k = 0; *line != '#' && scene_word(words, k, word); k++)
            used |= meets_condition(scene, effects, word);
        if (used) session_say(o, "%.*s", end - head - 2, line + head + 2);
    }
    if (scene->top.source[0]) session_say(o, "The scene: %s", scene->top.source);
    return ERR_OK;
}

enum sphfsi_status sphfsi_cite(const struct sphfsi_options *options)
{
    return call_of_case("cite", options, false, cite);
}

/* --- templates of cases: the files of cases/templates --- */

static bool is_template(const struct embedded_file *file)
{
    static const char folder[] = "cases/templates/";
    return strncmp(file->name, folder, sizeof folder - 1) == 0;
}

const char *sphfsi_template_name(int k)
{
    for (const struct embedded_file *file = embedded_files; k >= 0 && file->name; file++)
        if (is_template(file) && k-- == 0) return file->stem;
    return NULL;
}

const char *sphfsi_template(const char *name)
{
    struct diag d = {.code = ERR_OK};
    struct nearest near = {0};
    char list[256] = "";
    if (!name) return call_null_argument("template", "name"), NULL;
    for (const struct embedded_file *file = embedded_files; file->name; file++) {
        if (!is_template(file)) continue;
        if (strcmp(file->stem, name) == 0) return file->text;
        const size_t at = strlen(list);
        snprintf(list + at, sizeof list - at, "%s%s", at ? ", " : "", file->stem);
        nearest_offer(&near, name, file->stem);
    }
    call_result(&d, diag_fail(&d, ERR_INPUT, "there is no template '%.60s'%s; known: %s", name,
                              nearest_hint(&near), list));
    return NULL;
}
