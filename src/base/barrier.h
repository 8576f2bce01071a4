/* SPDX-License-Identifier: MIT
 * Where the threads of a parallel region meet every few microseconds: OpenMP's own barrier costs as much
 * as the share of a small body between two of them. */
#ifndef SPHFSI_BASE_BARRIER_H
#define SPHFSI_BASE_BARRIER_H

#include <sched.h>

#include "base/base.h"

/* Zeroed memory is a valid one. Each word has a cache line of its own, since all threads spin on `turn`. */
struct spin_barrier {
    _Alignas(64) uint32_t arrived;
    _Alignas(64) uint32_t turn;
};

/* Leaves the core to its other half for a moment. */
SPHFSI_INLINE void spin_pause(void)
{
#if defined __x86_64__
    __builtin_ia32_pause();
#elif defined __aarch64__
    __asm__ volatile("yield");
#endif
}

/* Returns when the word, which counts up, has come to a value, with what was written before. A thread whose
 * partners do not run gives its core away instead of spinning on. */
SPHFSI_INLINE void barrier_wait_for(const uint32_t *word, uint32_t value)
{
    enum { SPINS = 4000 };
    int spins = 0;
    while ((int32_t)(__atomic_load_n(word, __ATOMIC_ACQUIRE) - value) < 0) {
        if (spins < SPINS) {
            spins++;
            spin_pause();
        } else {
            sched_yield();
        }
    }
}

/* Returns when all threads of the region have come, with what each has written before. */
SPHFSI_INLINE void barrier_wait(struct spin_barrier *m)
{
    const uint32_t threads = (uint32_t)thread_team();
    if (threads == 1) return;
    const uint32_t turn = __atomic_load_n(&m->turn, __ATOMIC_RELAXED);
    if (__atomic_add_fetch(&m->arrived, 1, __ATOMIC_ACQ_REL) == threads) {
        __atomic_store_n(&m->arrived, 0, __ATOMIC_RELAXED);
        __atomic_store_n(&m->turn, turn + 1, __ATOMIC_RELEASE);
    } else {
        barrier_wait_for(&m->turn, turn + 1);
    }
}

#endif
