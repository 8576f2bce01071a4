/* SPDX-License-Identifier: MIT
 * What the accuracy study measured: src/app/data/evidence.csv, which `make accuracy` writes. */
#ifndef SPHFSI_APP_EVIDENCE_H
#define SPHFSI_APP_EVIDENCE_H

#include "app/session.h"

enum { EVIDENCE_TEXT = 96 };

struct evidence {
    enum scene_kind kind;
    char accuracy[EVIDENCE_TEXT]; /* draft, standard, fine; paper: that scheme, standard */
    char name[EVIDENCE_TEXT], error[EVIDENCE_TEXT];
    char what[EVIDENCE_TEXT]; /* that `resolution` counts */
    double resolution, percent;
};

/* The first row; then reads the row at `rest` and steps behind it: false at the end. */
const char *evidence_first(void);
bool evidence_next(const char **rest, struct evidence *row);

/* Prints the error that the study (docs/accuracy.md) lets expect of each body at its resolution. */
void evidence_say(const struct scene *scene, const struct sphfsi_options *o);

/* The same, if the case names its `accuracy`. */
void evidence_say_preset(const struct scene *scene, const struct sphfsi_options *o);

#endif
