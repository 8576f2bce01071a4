/* SPDX-License-Identifier: MIT
 * Templates of cases. */
#include "app/manual.h"

#include <string.h>

static const struct {
    const char *name, *text;
} templates[] = {
#define TEMPLATE(name, meaning, text) {#name, text},
#include "app/templates.def"
#undef TEMPLATE
};

const char *manual_template_name(int k)
{
    return k < (int)COUNT_OF(templates) ? templates[k].name : NULL;
}

const char *manual_template(const char *name)
{
    for (size_t k = 0; k < COUNT_OF(templates); k++)
        if (strcmp(templates[k].name, name) == 0) return templates[k].text;
    return NULL;
}
