/* SPDX-License-Identifier: MIT
 * A spin barrier, for threads that synchronise every few microseconds: OpenMP's own barrier would cost as
 * much as the work between two of them. */
#ifndef SPHFSI_BASE_BARRIER_H
#define SPHFSI_BASE_BARRIER_H

#include <sched.h>

#include "base/base.h"

/* Zeroed memory is a valid barrier. Each word has its own cache line, since all threads spin on `turn`. */
struct spin_barrier {
    _Alignas(64) uint32_t arrived;
    _Alignas(64) uint32_t turn;
};

/* Yields execution units to the core's other hardware thread. */
SPHFSI_INLINE void spin_pause(void)
{
#if defined __x86_64__
    __builtin_ia32_pause();
#elif defined __aarch64__
    __asm__ volatile("yield");
#endif
}

/* Returns when the counter `word` has reached `value`; writes that preceded the increment are then visible.
 * After SPINS rounds it yields, since the other threads may be waiting for this core. */
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

/* Returns when all threads of the region have called it; their earlier writes are then visible. */
SPHFSI_INLINE void barrier_wait(struct spin_barrier *b)
{
    const uint32_t threads = (uint32_t)thread_team();
    if (threads == 1) return;
    const uint32_t turn = __atomic_load_n(&b->turn, __ATOMIC_RELAXED);
    const uint32_t arrived = __atomic_add_fetch(&b->arrived, 1, __ATOMIC_ACQ_REL);
    ASSERT(arrived <= threads);
    if (arrived == threads) {
        __atomic_store_n(&b->arrived, 0, __ATOMIC_RELAXED);
        __atomic_store_n(&b->turn, turn + 1, __ATOMIC_RELEASE);
    } else {
        barrier_wait_for(&b->turn, turn + 1);
    }
}

#endif
