/* SPDX-License-Identifier: MIT
 * A scene and its simulation, opened with the options of the public header. */
#ifndef SPHFSI_APP_SESSION_H
#define SPHFSI_APP_SESSION_H

#include "sphfsi.h"

#include "time/simulation.h"

struct session {
    struct scene scene;
    struct simulation simulation;
};

/* Reads the case, sets default intervals of [output], applies --until. On failure
 * nothing remains to be freed. */
enum err session_read(struct session *x, const struct sphfsi_options *o, struct diag *d)
    SPHFSI_CHECKED;

/* session_read, the number of threads, and the simulation at time zero. */
enum err session_open(struct session *x, const struct sphfsi_options *o, struct diag *d)
    SPHFSI_CHECKED;
void session_close(struct session *x);

/* The name of the case: that of its file without folder and ending, `length` characters. */
const char *session_name(const struct sphfsi_options *o, int *length);

/* A diag whose warnings go to the message callback. */
struct diag session_diag(const struct sphfsi_options *o);

/* Sends one line to the user, through the message callback. */
void session_say(const struct sphfsi_options *o, const char *format, ...) SPHFSI_PRINTF(2, 3);
/* The same for what --quiet shows, too: what was asked for, and how to go on. */
void session_result(const struct sphfsi_options *o, const char *format, ...) SPHFSI_PRINTF(2, 3);

#endif
