/* SPDX-License-Identifier: MIT */
#include "snapshot_place.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "folder.h"

static bool sync_file(const char *path)
{
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    const bool ok = fd >= 0 && fsync(fd) == 0;
    if (fd >= 0) close(fd);
    return ok;
}

static bool swap(const struct placing *p)
{
    char old[FOLDER_PATH];
    if (snprintf(old, sizeof old, "%s.old", p->spare) >= FOLDER_PATH) return false;
    unlink(old);
    const bool linked = link(p->path, old) == 0;
    if (rename(p->spare, p->path) != 0) return false;
    if (linked) rename(old, p->spare);
    return true;
}

static enum err place(struct placing *p)
{
    if (!sync_file(p->spare) || !swap(p))
        return diag_fail(&p->diag, ERR_IO, "%s: cannot be put in place: %s", p->path,
                         strerror(errno));
    return folder_sync(p->folder, &p->diag);
}

static void *place_beside(void *placing)
{
    struct placing *const p = placing;
    p->diag.code = place(p);
    return NULL;
}

void placing_begin(struct placing *p, const char *folder, const char *path, const char *spare)
{
    *p = (struct placing){.folder = folder, .path = path, .spare = spare, .begun = true};
    /* Signals are for the threads that were there before. */
    sigset_t all, were;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &were);
    p->beside = pthread_create(&p->thread, NULL, place_beside, p) == 0;
    pthread_sigmask(SIG_SETMASK, &were, NULL);
    if (!p->beside) place_beside(p);
}

enum err placing_end(struct placing *p, struct diag *d)
{
    if (!p->begun) return ERR_OK;
    if (p->beside) pthread_join(p->thread, NULL);
    p->begun = false;
    return p->diag.code ? diag_fail(d, p->diag.code, "%s", p->diag.text) : ERR_OK;
}
