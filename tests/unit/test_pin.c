/* SPDX-License-Identifier: MIT
 * Threads keep a core each where a run has all of them, and only there. */
#define _GNU_SOURCE /* sched_getaffinity */
#include "base.h"

#include "unity.h"

#include <sched.h>
#include <stdlib.h>

#if defined _OPENMP && defined __linux__

static const char *const decides[] = {"OMP_PROC_BIND", "OMP_PLACES", "GOMP_CPU_AFFINITY",
                                      "KMP_AFFINITY"};
static cpu_set_t all;
static int threads_before;

void setUp(void)
{
    for (size_t k = 0; k < COUNT_OF(decides); k++) unsetenv(decides[k]);
    TEST_ASSERT_EQUAL_INT(0, sched_getaffinity(0, sizeof all, &all));
    threads_before = thread_count();
}

void tearDown(void)
{
    thread_use(CPU_COUNT(&all));
#pragma omp parallel
    sched_setaffinity(0, sizeof all, &all);
    thread_use(threads_before);
}

/* Cores that the threads of a region may run on: of each by itself, and of all together. */
static int cores_of_threads(cpu_set_t *together)
{
    int most = 0;
    CPU_ZERO(together);
#pragma omp parallel
    {
        cpu_set_t own;
        CPU_ZERO(&own);
        sched_getaffinity(0, sizeof own, &own);
#pragma omp critical
        {
            most = CPU_COUNT(&own) > most ? CPU_COUNT(&own) : most;
            CPU_OR(together, together, &own);
        }
    }
    return most;
}

static void test_each_of_all_threads_keeps_a_core(void)
{
    cpu_set_t together;
    thread_use(CPU_COUNT(&all));
    thread_pin();
    TEST_ASSERT_EQUAL_INT(1, cores_of_threads(&together));
    TEST_ASSERT_TRUE(CPU_EQUAL(&all, &together));
}

/* Two runs of half the threads each would meet on the same cores. */
static void test_other_numbers_of_threads_wander(void)
{
    const int cores = CPU_COUNT(&all), numbers[] = {cores - 1, cores + 1};
    for (size_t k = 0; k < COUNT_OF(numbers); k++) {
        if (numbers[k] < 1) continue;
        cpu_set_t together;
        thread_use(numbers[k]);
        thread_pin();
        TEST_ASSERT_EQUAL_INT(cores, cores_of_threads(&together));
    }
}

static void test_the_environment_decides(void)
{
    for (size_t k = 0; k < COUNT_OF(decides); k++) {
        cpu_set_t together;
        thread_use(CPU_COUNT(&all));
        setenv(decides[k], "false", 1);
        thread_pin();
        unsetenv(decides[k]);
        TEST_ASSERT_EQUAL_INT(CPU_COUNT(&all), cores_of_threads(&together));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_of_all_threads_keeps_a_core);
    RUN_TEST(test_other_numbers_of_threads_wander);
    RUN_TEST(test_the_environment_decides);
    return UNITY_END();
}

#else

void setUp(void) {}
void tearDown(void) {}

static void test_there_is_nothing_to_pin(void) { thread_pin(); }

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_there_is_nothing_to_pin);
    return UNITY_END();
}

#endif
