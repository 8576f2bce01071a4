/* SPDX-License-Identifier: MIT */
#include "output/publish.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/files.h"

static bool sync_file(const char *path)
{
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    const bool ok = fd >= 0 && fsync(fd) == 0;
    if (fd >= 0) close(fd);
    return ok;
}

static bool swap(const struct publishing *p)
{
    char old[PATH_BYTES];
    if (snprintf(old, sizeof old, "%s.old", p->spare) >= PATH_BYTES) return false;
    unlink(old);
    const bool linked = link(p->path, old) == 0;
    if (rename(p->spare, p->path) != 0) return false;
    if (linked) rename(old, p->spare);
    return true;
}

static enum err place(struct publishing *p)
{
    if (!sync_file(p->spare) || !swap(p))
        return diag_fail(&p->diag, ERR_IO, "%s: cannot be put in place: %s", p->path,
                         strerror(errno));
    return directory_sync(p->folder, &p->diag);
}

static void *publish_thread(void *publishing)
{
    struct publishing *const p = publishing;
    p->diag.code = place(p);
    return NULL;
}

void placing_begin(struct publishing *p, const char *folder, const char *path, const char *spare)
{
    *p = (struct publishing){.folder = folder, .path = path, .spare = spare, .begun = true};
    /* Signals are for the threads that were there before. */
    sigset_t all, were;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &were);
    p->threaded = pthread_create(&p->thread, NULL, publish_thread, p) == 0;
    pthread_sigmask(SIG_SETMASK, &were, NULL);
    if (!p->threaded) publish_thread(p);
}

enum err publishing_end(struct publishing *p, struct diag *d)
{
    if (!p->begun) return ERR_OK;
    if (p->threaded) pthread_join(p->thread, NULL);
    p->begun = false;
    return p->diag.code ? diag_fail(d, p->diag.code, "%s", p->diag.text) : ERR_OK;
}
