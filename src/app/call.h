/* SPDX-License-Identifier: MIT
 * One call of the public header: its options with the callbacks guarded, what it borrowed of the
 * host's thread, its result and sentence. */
#ifndef SPHFSI_TIME_CALL_H
#define SPHFSI_TIME_CALL_H

#include "base/threads.h"
#include "sphfsi.h"

struct call {
    struct sphfsi_options
        options; /* the host's; callbacks go through guards that have its settings */
    const struct sphfsi_options *given; /* by the host */
    struct host host;
    struct diag diag;
};

/* Checks the options, NULL too, and begins; on failure call_end is all that may follow. */
enum err call_begin(struct call *c, const char *name, const struct sphfsi_options *given)
    SPHFSI_CHECKED;

/* Gives the host its settings back. */
enum sphfsi_status call_end(struct call *c, enum err e);

/* The result of a failure or success, its sentence kept for sphfsi_error. */
enum sphfsi_status call_result(const struct diag *d, enum err e);

/* The failure of a function that was handed NULL. */
enum sphfsi_status call_without(const char *name, const char *what);

#endif
