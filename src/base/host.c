/* SPDX-License-Identifier: MIT */
#include "base/host.h"

#include "base/threads.h"

#include <pthread.h>

static locale_t plain; /* kept until the program ends */
static pthread_once_t once = PTHREAD_ONCE_INIT;

static void make_plain(void) { plain = newlocale(LC_ALL_MASK, "C", (locale_t)0); }

struct host host_use(struct host settings)
{
    const struct host before = {uselocale(settings.locale), thread_count()};
    if (settings.threads != before.threads) thread_use(settings.threads);
    return before;
}

enum err host_enter(struct host *before, int threads, struct diag *d)
{
    pthread_once(&once, make_plain);
    if (!plain) return diag_fail(d, ERR_MEMORY, "no memory for the locale \"C\"");
    *before = host_use((struct host){plain, threads > 0 ? threads : thread_count()});
    return ERR_OK;
}
