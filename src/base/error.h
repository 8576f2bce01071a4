/* SPDX-License-Identifier: MIT
 * Errors: a code for the program, one sentence for the user. */
#pragma once

#include "base/macros.h"

enum err {
    ERR_OK,
    ERR_INPUT,    /* the case, a file it names, or the command line is wrong; nothing was started */
    ERR_MEMORY,   /* not enough */
    ERR_IO,       /* a file could not be written or read */
    ERR_GUARD,    /* a guard stopped the run: the numerical state is no longer valid */
    ERR_INTERRUPT /* stopped by a signal */
};

/* Exit status of the program for an error. */
int err_status(enum err e);

/* The first failure, and the receiver of warnings. */
struct diag {
    enum err code;
    char text[1024]; /* one sentence: what, where, which value, what to do */
    /* Receives warnings, one sentence each; NULL: warnings are dropped. */
    void (*warn)(void *context, const char *text);
    void *warn_context;
    char more[8192]; /* further failures of the same input, a sentence a line */
};

/* Records a failure unless d holds one already; returns `code`: `return diag_fail(d, ERR_IO,
 * ...)`. */
enum err diag_fail(struct diag *d, enum err code, const char *format, ...) SPHFSI_PRINTF(3, 4);
/* The same, but where d holds a failure already, the sentence is added to `more`. */
enum err diag_add(struct diag *d, enum err code, const char *format, ...) SPHFSI_PRINTF(3, 4);
/* Failures so far. */
int diag_count(const struct diag *d);
void diag_warn(struct diag *d, const char *format, ...) SPHFSI_PRINTF(2, 3);
/* Adds a sentence to `more`; one that does not fit is left out. */
void diag_more(struct diag *d, const char *text);

/* Returns from the caller if the call fails. */
#define TRY(call)                     \
    do {                              \
        const enum err err_ = (call); \
        if (err_) return err_;        \
    } while (0)
