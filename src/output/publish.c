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

static void *publish_thread(void *publishing)
{
    struct publishing *const p = publishing;
    enum err e = ERR_OK;
    if (!sync_file(p->spare) || !swap(p))
        e = diag_fail(&p->diag, ERR_IO, "%s: cannot be replaced by %s: %s", p->path, p->spare,
                      strerror(errno));
    else
        e = directory_sync(p->folder, &p->diag);
    p->diag.code = e;
    return NULL;
}

void publish_begin(struct publishing *p, const char *folder, const char *path, const char *spare)
{
    ASSERT(!p->begun);
    *p = (struct publishing){.folder = folder, .path = path, .spare = spare, .begun = true};
    /* The new thread inherits a mask that blocks all signals: other threads receive them. */
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    p->threaded = pthread_create(&p->thread, NULL, publish_thread, p) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (!p->threaded) publish_thread(p);
}

enum err publish_end(struct publishing *p, struct diag *d)
{
    if (!p->begun) return ERR_OK;
    if (p->threaded) pthread_join(p->thread, NULL);
    p->begun = false;
    return p->diag.code ? diag_fail(d, p->diag.code, "%s", p->diag.text) : ERR_OK;
}
