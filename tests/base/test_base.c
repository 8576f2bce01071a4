/* SPDX-License-Identifier: MIT
 * Ground floor: errors, memory that fails cleanly. */
#define _GNU_SOURCE /* RUSAGE_THREAD */
#include "base/threads.h"

#include "unity.h"

#include <string.h>
#include <sys/resource.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#ifdef _OPENMP
#include <omp.h>
#endif

static struct arena arena;
static struct diag diag;
static char warning[64];

static void note(void *context, const char *text)
{
    (void)context;
    strncpy(warning, text, sizeof warning - 1);
}

void setUp(void)
{
    diag = (struct diag){0};
    arena = (struct arena){0};
}

void tearDown(void)
{
    arena_fail_after(-1);
    arena_free(&arena);
}

static void test_exit_status_of_errors(void)
{
    TEST_ASSERT_EQUAL_INT(0, err_status(ERR_OK));
    TEST_ASSERT_EQUAL_INT(1, err_status(ERR_INPUT));
    TEST_ASSERT_EQUAL_INT(2, err_status(ERR_GUARD));
    TEST_ASSERT_EQUAL_INT(2, err_status(ERR_IO));
    TEST_ASSERT_EQUAL_INT(2, err_status(ERR_MEMORY));
    TEST_ASSERT_EQUAL_INT(130, err_status(ERR_INTERRUPT));
}

static void test_the_first_failure_stays(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_IO, diag_fail(&diag, ERR_IO, "first %d", 1));
    TEST_ASSERT_EQUAL_INT(ERR_GUARD, diag_fail(&diag, ERR_GUARD, "second"));
    TEST_ASSERT_EQUAL_INT(ERR_IO, diag.code);
    TEST_ASSERT_EQUAL_STRING("first 1", diag.text);
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, diag_fail(NULL, ERR_INPUT, "nobody listens"));
}

static void test_long_sentences_are_cut(void)
{
    char text[4000];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    diag_fail(&diag, ERR_INPUT, "%s", text);
    TEST_ASSERT_EQUAL_UINT64(sizeof diag.text - 1, strlen(diag.text));
}

/* Further errors are kept whole or not at all. */
static void test_more_errors_are_kept_while_there_is_room(void)
{
    char text[sizeof diag.more / 2];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 2] = '\0';
    diag_more(&diag, text);
    diag_more(&diag, text + 1);
    TEST_ASSERT_EQUAL_UINT64(sizeof diag.more - 3, strlen(diag.more));
    diag_more(&diag, "ab");
    TEST_ASSERT_EQUAL_UINT64(sizeof diag.more - 3, strlen(diag.more));
    diag_more(&diag, "a");
    TEST_ASSERT_EQUAL_UINT64(sizeof diag.more - 1, strlen(diag.more));
    TEST_ASSERT_EQUAL_STRING("a\n", diag.more + sizeof diag.more - 3);
}

static void test_warnings_go_to_the_listener(void)
{
    diag_warn(&diag, "dropped");
    diag.warn = note;
    diag_warn(&diag, "kept %d", 7);
    TEST_ASSERT_EQUAL_STRING("kept 7", warning);
    TEST_ASSERT_EQUAL_INT(ERR_OK, diag.code);
}

static void test_pieces_are_zero_aligned_and_have_margins(void)
{
    for (size_t count = 0; count < 200; count += 7) {
        unsigned char *const piece = arena_alloc(&arena, count, 3, "bytes", &diag);
        TEST_ASSERT_NOT_NULL(piece);
        TEST_ASSERT_EQUAL_UINT64(0, (size_t)piece % ARENA_ALIGN);
        for (size_t k = 0; k < 3 * count; k++) TEST_ASSERT_EQUAL_INT(0, piece[k]);
        /* Readable and writable beyond both ends; a sanitizer or the next free would object. */
        memset(piece - ARENA_MARGIN, 0x55, ARENA_MARGIN);
        memset(piece + 3 * count, 0x55, ARENA_MARGIN);
    }
}

/* Arrays of a loop that began at the same line of a page would share few lines of the first cache.
 */
static void test_large_pieces_begin_at_different_lines(void)
{
    enum { PIECES = 20 };
    size_t line[PIECES];
    for (int k = 0; k < PIECES; k++) {
        line[k] = (uintptr_t)arena_alloc(&arena, 1 << 20, 1, "piece", &diag) % 4096 / ARENA_ALIGN;
        for (int m = 0; m < k; m++) TEST_ASSERT_NOT_EQUAL(line[m], line[k]);
    }
}

static void test_the_limit_refuses_and_says_what(void)
{
    arena.limit = 1000;
    TEST_ASSERT_NOT_NULL(arena_alloc(&arena, 64, 8, "first", &diag));
    TEST_ASSERT_EQUAL_UINT64(512, arena.bytes);
    TEST_ASSERT_NULL(arena_alloc(&arena, 64, 8, "the second", &diag));
    TEST_ASSERT_EQUAL_INT(ERR_MEMORY, diag.code);
    TEST_ASSERT_NOT_NULL(strstr(diag.text, "the second"));
    TEST_ASSERT_EQUAL_UINT64(512, arena.bytes);
    arena.limit = 1024; /* full to the last byte */
    TEST_ASSERT_NOT_NULL(arena_alloc(&arena, 64, 8, "the third", &diag));
    TEST_ASSERT_EQUAL_UINT64(1024, arena.bytes);
}

static void test_sizes_that_overflow_are_refused(void)
{
    TEST_ASSERT_NULL(arena_alloc(&arena, SIZE_MAX / 4, 8, "too many", &diag));
    TEST_ASSERT_EQUAL_INT(ERR_MEMORY, diag.code);
    diag = (struct diag){0};
    TEST_ASSERT_NULL(arena_alloc(&arena, SIZE_MAX, 1, "too many", &diag));
    TEST_ASSERT_EQUAL_INT(ERR_MEMORY, diag.code);
    TEST_ASSERT_EQUAL_UINT64(0, arena.bytes);
}

static void test_rehearsed_failure_hits_once(void)
{
    arena_fail_after(1);
    TEST_ASSERT_NOT_NULL(arena_alloc(&arena, 1, 8, "first", &diag));
    TEST_ASSERT_NULL(arena_alloc(&arena, 1, 8, "second", &diag));
    TEST_ASSERT_NOT_NULL(arena_alloc(&arena, 1, 8, "third", &diag));
    TEST_ASSERT_NOT_NULL(strstr(diag.text, "second"));
}

#if defined _OPENMP && defined RUSAGE_THREAD
/* Pages that either of two threads has touched first. */
static void count_touched(long touched[2])
{
#pragma omp parallel num_threads(2)
    {
        struct rusage usage;
        getrusage(RUSAGE_THREAD, &usage);
        touched[omp_get_thread_num()] = usage.ru_minflt;
    }
}
#endif

/* On a machine of several sockets memory lies where it is first touched. */
static void test_large_memory_is_first_touched_by_shares(void)
{
#if defined _OPENMP && defined RUSAGE_THREAD
    const int before = omp_get_max_threads();
    long first[2] = {0}, touched[2] = {-1, -1};
    omp_set_num_threads(2);
#ifdef PR_SET_THP_DISABLE
    prctl(PR_SET_THP_DISABLE, 1, 0, 0, 0); /* pages of one size can be counted */
#endif
    count_touched(first);
    const double *const piece = arena_alloc(&arena, 8 << 20, sizeof *piece, "piece", &diag);
    count_touched(touched);
#ifdef PR_SET_THP_DISABLE
    prctl(PR_SET_THP_DISABLE, 0, 0, 0, 0);
#endif
    omp_set_num_threads(before);
    if (touched[1] < 0) TEST_IGNORE_MESSAGE("one thread");
    TEST_ASSERT_NOT_NULL(piece);
    for (size_t k = 0; k < 8 << 20; k += 511) TEST_ASSERT_TRUE(piece[k] == 0);
    TEST_ASSERT_TRUE(piece[(8 << 20) - 1] == 0);
    const long one = touched[0] - first[0], other = touched[1] - first[1];
    TEST_ASSERT_TRUE(other > 8);
    TEST_ASSERT_TRUE(other > one / 2 && one > other / 2);
#else
    TEST_IGNORE_MESSAGE("one thread");
#endif
}

static void test_freed_arenas_can_be_used_again(void)
{
    TEST_ASSERT_NOT_NULL(arena_alloc(&arena, 100, 8, "piece", &diag));
    arena_free(&arena);
    TEST_ASSERT_EQUAL_UINT64(0, arena.bytes);
    TEST_ASSERT_NULL(arena.blocks);
    TEST_ASSERT_NOT_NULL(arena_alloc(&arena, 100, 8, "piece", &diag));
}

static void test_the_clock_goes_forward(void)
{
    const double start = wall_clock();
    TEST_ASSERT_TRUE(wall_clock() >= start);
    TEST_ASSERT_TRUE(thread_count() >= 1);
    TEST_ASSERT_EQUAL_INT(0, thread_index());
}

static void test_threads_follow_particles(void)
{
    TEST_ASSERT_EQUAL_INT(1, thread_useful(0));
    TEST_ASSERT_EQUAL_INT(1, thread_useful(1999));
    TEST_ASSERT_EQUAL_INT(2, thread_useful(2000));
    TEST_ASSERT_EQUAL_INT(50, thread_useful(50999));
    TEST_ASSERT_EQUAL_INT(INT16_MAX, thread_useful(INT64_MAX));
    TEST_ASSERT_EQUAL_INT(1, thread_limit(0));
    TEST_ASSERT_EQUAL_INT(THREADS_PER_CORE * thread_cores(), thread_limit(INT64_MAX));
}

/* Seconds that a team spends in `span` seconds, where a step takes as long as given for one thread
 * and for all; its mean number of steps in a second. */
static double steps_per_second(struct team *team, double span, double one, double all)
{
    double spent = 0;
    int64_t steps = 0;
    for (; spent < span; steps++) {
        const double seconds = team->now == 1 ? one : all;
        spent += seconds;
        team_next(team, seconds);
    }
    return (double)steps / spent;
}

static void test_a_team_keeps_the_faster_number_of_threads(void)
{
    struct team team;
    team_begin(&team, 1);
    TEST_ASSERT_EQUAL_INT(1, team_next(&team, 1));
    team_begin(&team, 8);
    /* On an idle machine trials cost at most 2 %. */
    TEST_ASSERT_TRUE(steps_per_second(&team, 100, 4e-4, 1e-4) > 0.97 / 1e-4);
    TEST_ASSERT_EQUAL_INT(8, team.chosen);
    /* A single slow step, however long, changes nothing. */
    TEST_ASSERT_TRUE(steps_per_second(&team, 0.1, 4e-4, 1e-4) > 0.9 / 1e-4);
    team_next(&team, 0.1);
    TEST_ASSERT_TRUE(steps_per_second(&team, 0.5, 4e-4, 1e-4) > 0.9 / 1e-4);
    TEST_ASSERT_EQUAL_INT(8, team.chosen);
    /* Another program delays the team by a factor of 40: one thread within two blocks. */
    TEST_ASSERT_TRUE(steps_per_second(&team, 0.2, 4e-4, 4e-3) > 0.5 / 4e-4);
    TEST_ASSERT_EQUAL_INT(1, team.chosen);
    TEST_ASSERT_TRUE(steps_per_second(&team, 100, 4e-4, 4e-3) > 0.97 / 4e-4);
    /* It ends: the next trial finds the team faster. */
    steps_per_second(&team, 2, 4e-4, 1e-4);
    TEST_ASSERT_EQUAL_INT(8, team.chosen);
    /* Steps that are long against a block: two of them are a trial. */
    TEST_ASSERT_TRUE(steps_per_second(&team, 5000, 4, 1) > 0.9);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_large_pieces_begin_at_different_lines);
    RUN_TEST(test_exit_status_of_errors);
    RUN_TEST(test_the_first_failure_stays);
    RUN_TEST(test_long_sentences_are_cut);
    RUN_TEST(test_more_errors_are_kept_while_there_is_room);
    RUN_TEST(test_warnings_go_to_the_listener);
    RUN_TEST(test_pieces_are_zero_aligned_and_have_margins);
    RUN_TEST(test_the_limit_refuses_and_says_what);
    RUN_TEST(test_sizes_that_overflow_are_refused);
    RUN_TEST(test_rehearsed_failure_hits_once);
    RUN_TEST(test_large_memory_is_first_touched_by_shares);
    RUN_TEST(test_freed_arenas_can_be_used_again);
    RUN_TEST(test_the_clock_goes_forward);
    RUN_TEST(test_threads_follow_particles);
    RUN_TEST(test_a_team_keeps_the_faster_number_of_threads);
    return UNITY_END();
}
