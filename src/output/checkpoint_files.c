/* SPDX-License-Identifier: MIT */
#include "output/checkpoint_files.h"

#include "output/checkpoint.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <unistd.h>

enum { KEEP = 2 };

void checkpoint_name(char name[CHECKPOINT_NAME_TEXT], int64_t steps)
{
    snprintf(name, CHECKPOINT_NAME_TEXT, "step-%09" PRId64 ".ckpt", steps);
}

/* Steps in the name of a checkpoint, or -1 for other files, including other spellings of the
 * number. */
static int64_t steps_of(const struct dirent *entry)
{
    char name[CHECKPOINT_NAME_TEXT];
    int64_t steps;
    if (entry->d_type != DT_REG && entry->d_type != DT_LNK && entry->d_type != DT_UNKNOWN)
        return -1;
    if (sscanf(entry->d_name, "step-%18" SCNd64, &steps) != 1 || steps < 0) return -1;
    checkpoint_name(name, steps);
    return strcmp(entry->d_name, name) == 0 ? steps : -1;
}

/* Replaces *steps by the largest number of steps below it among the folder's checkpoints, or by -1.
 */
enum err checkpoint_next(const char *folder, int64_t *steps, struct diag *d)
{
    const int64_t limit = *steps;
    DIR *dir = opendir(folder);
    if (!dir) return diag_fail(d, ERR_IO, "%s: cannot be read: %s", folder, strerror(errno));
    *steps = -1;
    for (const struct dirent *entry; (entry = readdir(dir)) != NULL;) {
        const int64_t found = steps_of(entry);
        if (found > *steps && found < limit) *steps = found;
    }
    closedir(dir);
    return ERR_OK;
}

static enum err remove_checkpoint(const char *folder, int64_t steps, struct diag *d)
{
    char name[CHECKPOINT_NAME_TEXT], path[PATH_BYTES];
    checkpoint_name(name, steps);
    TRY(path_join(path, folder, name, d));
    if (unlink(path) != 0)
        return diag_fail(d, ERR_IO, "%s: cannot be removed: %s", path, strerror(errno));
    return ERR_OK;
}

enum err checkpoint_remove_older(const char *folder, int64_t newest, struct diag *d)
{
    int64_t steps = newest + 1;
    for (int kept = 0;; kept++) {
        TRY(checkpoint_next(folder, &steps, d));
        if (steps < 0) return ERR_OK;
        if (kept >= KEEP) TRY(remove_checkpoint(folder, steps, d));
    }
}

/* Removes unfinished checkpoints of killed runs. */
static void remove_parts(const char *folder)
{
    static const char end[] = ".ckpt.part";
    DIR *dir = opendir(folder);
    if (!dir) return;
    for (const struct dirent *entry; (entry = readdir(dir)) != NULL;) {
        const size_t length = strlen(entry->d_name);
        if (strncmp(entry->d_name, "step-", 5) == 0 && length > sizeof end &&
            strcmp(entry->d_name + length - (sizeof end - 1), end) == 0)
            unlinkat(dirfd(dir), entry->d_name, 0);
    }
    closedir(dir);
}

enum err checkpoint_remove_later(const char *folder, int64_t steps, struct diag *d)
{
    for (;;) {
        int64_t later = INT64_MAX;
        TRY(checkpoint_next(folder, &later, d));
        if (later <= steps) break;
        TRY(remove_checkpoint(folder, later, d));
    }
    remove_parts(folder);
    return ERR_OK;
}
