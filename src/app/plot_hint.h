/* SPDX-License-Identifier: MIT
 * The command that draws the probes of a run. */
#ifndef SPHFSI_APP_PLOT_HINT_H
#define SPHFSI_APP_PLOT_HINT_H

#include "app/session.h"

/* Says it: with the tool of the clone that the program lies in and the Python that its set-up has found,
 * else with the installed Python package. It works from the working directory. */
void say_plot_hint(const char *folder, const struct sphfsi_options *o);

#endif
