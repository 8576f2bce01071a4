/* SPDX-License-Identifier: MIT
 * Where the threads of a parallel region meet every few microseconds: OpenMP's own barrier costs as much
 * as the share of a small body between two of them. */
#ifndef SPHFSI_MEETING_H
#define SPHFSI_MEETING_H

#include <sched.h>
#ifdef _OPENMP
#include <omp.h>
#endif

#include "base.h"

/* Zeroed memory is a valid one. Each word has a cache line of its own, since all threads spin on `turn`. */
struct meeting {
    _Alignas(64) uint32_t arrived;
    _Alignas(64) uint32_t turn;
};

/* Leaves the core to its other half for a moment. */
SPHFSI_INLINE void relax(void)
{
#if defined __x86_64__
    __builtin_ia32_pause();
#elif defined __aarch64__
    __asm__ volatile("yield");
#endif
}

/* Returns when all threads of the region have come, with what each has written before. A thread whose
 * partners do not run gives its core away instead of spinning on. */
SPHFSI_INLINE void meet(struct meeting *m)
{
#ifdef _OPENMP
    enum { SPINS = 4000 };
    const uint32_t threads = (uint32_t)omp_get_num_threads();
    if (threads == 1) return;
    const uint32_t turn = __atomic_load_n(&m->turn, __ATOMIC_RELAXED);
    if (__atomic_add_fetch(&m->arrived, 1, __ATOMIC_ACQ_REL) == threads) {
        __atomic_store_n(&m->arrived, 0, __ATOMIC_RELAXED);
        __atomic_store_n(&m->turn, turn + 1, __ATOMIC_RELEASE);
        return;
    }
    int spins = 0;
    while (__atomic_load_n(&m->turn, __ATOMIC_ACQUIRE) == turn) {
        if (spins < SPINS) {
            spins++;
            relax();
        } else {
            sched_yield();
        }
    }
#else
    (void)m;
#endif
}

#endif
