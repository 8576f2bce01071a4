/* SPDX-License-Identifier: MIT
 * Settings of the calling thread that the library changes during a call: the locale, since numbers in files
 * have a decimal point, and the number of threads of parallel regions. */
#ifndef SPHFSI_TIME_HOST_H
#define SPHFSI_TIME_HOST_H

#include "base/error.h"

#include <locale.h>
#if defined __APPLE__
#include <xlocale.h>
#endif

struct host {
    locale_t locale;
    int threads; /* of a parallel region */
};

/* Puts settings in effect for this thread; returns those that were. */
struct host host_use(struct host settings);

/* Puts the locale "C" in effect and, unless it is 0, a number of threads; what was goes to *before. */
enum err host_enter(struct host *before, int threads, struct diag *d) SPHFSI_CHECKED;

#endif
