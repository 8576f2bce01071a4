/* SPDX-License-Identifier: MIT
 * The checkpoints in a folder, by their names: step-<steps>.ckpt. */
#ifndef SPHFSI_OUTPUT_CHECKPOINT_FILES_H
#define SPHFSI_OUTPUT_CHECKPOINT_FILES_H

#include "base/error.h"

#include <stdint.h>

enum { CHECKPOINT_NAME_TEXT = 32 };

void checkpoint_name(char name[CHECKPOINT_NAME_TEXT], int64_t steps);

/* Replaces *steps by the largest number of steps below it among the folder's checkpoints, or by -1.
 */
enum err checkpoint_next(const char *folder, int64_t *steps, struct diag *d) SPHFSI_CHECKED;

/* Removes all but the newest and the ones before it that are kept. */
enum err checkpoint_remove_older(const char *folder, int64_t newest, struct diag *d) SPHFSI_CHECKED;

#endif
