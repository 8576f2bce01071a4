/* SPDX-License-Identifier: MIT
 * A tiny scene with every kind of particle, and a folder for a test's files. */
#ifndef TINY_H
#define TINY_H

/* Water 0.1 m x 0.1 m at dp = 1 cm behind an elastic gate; all probes. */
extern const char tiny_case[];

/* A fresh folder below $TMPDIR or /tmp; removed with all its files at exit. */
const char *tiny_folder(void);

/* A file in it: valid until the next call but three. */
const char *tiny_path(const char *name);

/* Removes a folder with all that is in it. */
void tiny_remove(const char *path);

#endif
