/* SPDX-License-Identifier: MIT
 * A scene and its simulation, opened as the options of the public header ask. */
#ifndef SPHFSI_APP_SESSION_H
#define SPHFSI_APP_SESSION_H

#include "sphfsi.h"

#include "time/simulation.h"

struct session {
    struct scene scene;
    struct simulation simulation;
};

/* Reads the case, settles what output.* and --until leave open, sets the number of threads. On
 * failure nothing remains to be freed. */
enum err session_read(struct session *x, const struct sphfsi_options *o, struct diag *d)
    SPHFSI_CHECKED;

/* session_read, and the simulation at time zero. */
enum err session_open(struct session *x, const struct sphfsi_options *o, struct diag *d)
    SPHFSI_CHECKED;
void session_close(struct session *x);

/* A diag whose warnings go to the message callback. */
struct diag session_diag(const struct sphfsi_options *o);

/* A line for the user, through the message callback. */
void session_say(const struct sphfsi_options *o, const char *format, ...) SPHFSI_PRINTF(2, 3);

/* A time as it is meant: without the last bits that arithmetic left, so that the grids of several
 * outputs, which k * interval may miss differently, meet in one number. */
double session_time(double time);

#endif
