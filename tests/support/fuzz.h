/* SPDX-License-Identifier: MIT
 * What the fuzzers call, each with bytes that may be anything. tests/fuzz links one of them with
 * libFuzzer, tests/fault/test_corpus.c replays the kept inputs in any build. All return 0. */
#ifndef FUZZ_H
#define FUZZ_H

#include <stddef.h>
#include <stdint.h>

int fuzz_case(const uint8_t *data, size_t size);       /* a case file */
int fuzz_expr(const uint8_t *data, size_t size);       /* the value of a key, in x and y */
int fuzz_motion(const uint8_t *data, size_t size);     /* the table of a motion */
int fuzz_reference(const uint8_t *data, size_t size);  /* a reference, and the probes of a run */
int fuzz_series(const uint8_t *data, size_t size);     /* the rows of a run that is continued */
int fuzz_checkpoint(const uint8_t *data, size_t size); /* a checkpoint; see fuzz.c */

/* Where a seed of the checkpoint fuzzer is written. 0: done. */
int fuzz_write_checkpoint(const char *path, int steps);

#endif
