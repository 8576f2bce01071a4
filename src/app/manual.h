/* SPDX-License-Identifier: MIT
 * Built-in documentation: keys, templates of cases, publications. */
#ifndef SPHFSI_APP_MANUAL_H
#define SPHFSI_APP_MANUAL_H

#include "app/session.h"

/* Prints every section and key with type, unit, default, range, meaning and example, in Markdown, line by
 * line through the message callback. */
void manual_keys(const struct sphfsi_options *o);

/* Writes the example of a key to `text`: from data/key_examples.cfg, or its default; "" if it has none. */
struct param;
void manual_example(const struct param *p, char *text, size_t size);

/* A commented case as a template, or NULL. manual_template_name: the k-th name, NULL at the end. */
const char *manual_template(const char *name);
const char *manual_template_name(int k);

/* Prints the publications of the methods that a scene uses, line by line. */
void manual_cite(const struct scene *s, effect_set effects, const struct sphfsi_options *o);

#endif
