/* SPDX-License-Identifier: MIT
 * Effects, memory, time step and cost of a scene. */
#ifndef SPHFSI_APP_EXPLAIN_H
#define SPHFSI_APP_EXPLAIN_H

#include "app/session.h"

/* Prints them line by line, through the message callback. Takes some steps in memory to measure the cost. */
enum err explain_session(struct session *x, const struct sphfsi_options *o, struct diag *d)
    SPHFSI_CHECKED;

/* Warnings on their way to the caller, kept for explain_data, one a line. */
struct heard {
    void (*message)(void *context, enum sphfsi_message kind, const char *text);
    void *context;
    char *text;
    size_t n;
};
/* Keeps the warnings of the options from now on. The caller frees `text`. */
void heard_begin(struct heard *h, struct sphfsi_options *o);

/* The same as one text in JSON, with the warnings that were heard. */
enum err explain_data(struct session *x, const struct heard *h, const struct sphfsi_options *o,
                      struct diag *d) SPHFSI_CHECKED;

#endif
