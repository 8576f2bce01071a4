/* SPDX-License-Identifier: MIT
 * What the program says of itself: its keys, templates of cases, the sources of its methods. */
#ifndef SPHFSI_APP_MANUAL_H
#define SPHFSI_APP_MANUAL_H

#include "app/session.h"

/* Every section and key with type, unit, default, range, meaning and example, in Markdown, line by line
 * through the message callback. */
void manual_keys(const struct sphfsi_options *o);

/* The example of a key, written to `text`: that of app/examples.def, or its default; "" if it has none. */
struct param;
void manual_example(const struct param *p, char *text, size_t size);

/* A commented case to start from, or NULL. `template_name` gives the k-th name, NULL at the end. */
const char *manual_template(const char *name);
const char *manual_template_name(int k);

/* The references of what a scene uses, line by line through the message callback. */
void manual_cite(const struct scene *s, effect_set effects, const struct sphfsi_options *o);

#endif
