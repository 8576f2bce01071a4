/* SPDX-License-Identifier: MIT
 * What files of this folder offer each other beside the functions of the public header. */
#ifndef SPHFSI_APP_ACTIONS_H
#define SPHFSI_APP_ACTIONS_H

#include "app/session.h"
#include "output/report.h"

/* case_change.c: compares two effective cases line by line: the checkpoint's, `old`, and the
 * present one. A restart may change end_time and output. A fork may also change physics, but not
 * what the state depends on: particles, masses, sound speed, kernel, integrator. ERR_INPUT names
 * the first line that must not differ. */
enum err case_change_check(const char *old, const char *now, bool fork, struct diag *d)
    SPHFSI_CHECKED;

/* evidence.c: prints the error that the accuracy study lets expect of each body. */
void evidence_say(const struct scene *scene, const struct sphfsi_options *o);

/* manual.c: writes the example of a key to `text`: from src/app/data/key_examples.cfg, or its
 * default; "". */
struct param;
void manual_example(const struct param *param, char *text, size_t size);

#endif
