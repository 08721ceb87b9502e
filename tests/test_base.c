#include "test.h"

#include "base/effects.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/sort.h"
#include "sched/pace.h"

static void a_failure_carries_status_and_text(void **state) {
    (void)state;
    gneiss_error error = {0};
    assert_int_equal(gn_fail(&error, GNEISS_ERROR_INPUT, "radius %d", 7), GNEISS_ERROR_INPUT);
    assert_string_equal(error.message, "radius 7");
    assert_int_equal(gn_fail_context(&error, "a.txt:%d: ", 3), GNEISS_ERROR_INPUT);
    assert_string_equal(error.message, "a.txt:3: radius 7");
}

static void memory_is_aligned_and_zeroed(void **state) {
    (void)state;
    for (size_t size = 0; size < (size_t)9 << 20; size = 3 * size + 1) {
        unsigned char *block = gn_alloc(size);
        assert_non_null(block);
        assert_int_equal((uintptr_t)block % GN_ALIGNMENT, 0);
        for (size_t k = 0; k < size; k++)
            if (block[k]) fail_msg("byte %zu of %zu is not zero", k, size);
        gn_free(block);
    }
}

static void a_product_that_overflows_is_refused(void **state) {
    (void)state;
    assert_null(gn_alloc_array(SIZE_MAX / 4, 8));
    assert_null(gn_alloc(SIZE_MAX - 8));
}

static void every_effect_has_a_name(void **state) {
    (void)state;
    assert_string_equal(gn_effect_name(GN_FX_INDEX_SPACE), "space");
    assert_string_equal(gn_effect_name(GN_FX_INDEX_ENERGY), "energy");
    for (int k = 0; k < GN_EFFECT_COUNT; k++) assert_true(strlen(gn_effect_text(k)) > 5);
}

/* Rounds of unit work that take `alone` on one thread and `together` on all four; returns how many
 * were done on one. */
static int rounds_alone(gn_pace *pace, int rounds, double alone, double together, double waiting) {
    int count = 0;
    for (int k = 0; k < rounds; k++) {
        bool one = gn_pace_threads(pace) == 1;
        assert_true(one || gn_pace_threads(pace) == 4);
        count += one;
        gn_pace_note(pace, one ? alone : together, 1.0, one ? 0.0 : waiting);
    }
    return count;
}

static void threads_that_help_are_used(void **state) {
    (void)state;
    gn_pace pace = gn_pace_start(4, 4, 32, 1024);
    assert_int_equal(rounds_alone(&pace, 10000, 3.0, 1.0, 0.1), 0);
    pace = gn_pace_start(4, 4, 32,
                         1024); /* the waiting time is not known: trials become rarer and rarer */
    assert_in_range(rounds_alone(&pace, 10000, 3.0, 1.0, -1.0), 20, 80);
}

static void threads_that_slow_the_work_are_not_used(void **state) {
    (void)state;
    gn_pace pace = gn_pace_start(4, 4, 32, 1024);
    assert_in_range(rounds_alone(&pace, 10000, 1.0, 9.0, 0.6), 10000 - 32 - 80, 10000 - 33);
    /* the machine is quiet again */
    rounds_alone(&pace, 2000, 3.0, 1.0, 0.1);
    assert_int_equal(rounds_alone(&pace, 1000, 3.0, 1.0, 0.1), 0);
}

/* After a slow trial all threads are used for no longer than a few such trials. */
static void an_unlucky_trial_is_repeated_soon(void **state) {
    (void)state;
    gn_pace pace = gn_pace_start(4, 4, 32, 1 << 20);
    for (int unlucky = 0; unlucky < 6; unlucky++) { /* both choices take the same time */
        while (gn_pace_threads(&pace) == 4) gn_pace_note(&pace, 1.0, 1.0, 0.8);
        while (gn_pace_threads(&pace) == 1) gn_pace_note(&pace, 2.0, 1.0, 0.0);
    }
    assert_in_range(10000 - rounds_alone(&pace, 10000, 0.01, 1.0, 0.8), 32, 300);
}

/* One round on all threads may take as long as a hundred rounds on one. */
static void a_trial_of_all_threads_ends_when_it_is_lost(void **state) {
    (void)state;
    gn_pace pace = gn_pace_start(4, 32, 128, 32768);
    rounds_alone(&pace, 128 + 32, 1.0, 100.0, 0.9);
    assert_int_equal(gn_pace_threads(&pace), 1);
    assert_in_range(10000 - rounds_alone(&pace, 10000, 1.0, 100.0, 0.9), 5, 10);
}

static void one_thread_stays_one(void **state) {
    (void)state;
    gn_pace pace = gn_pace_start(1, 4, 32, 1024);
    for (int k = 0; k < 1000; k++) {
        assert_int_equal(gn_pace_threads(&pace), 1);
        gn_pace_note(&pace, 1.0, 1.0, 1.0);
    }
}

/* Numbers in disorder, of which many are equal if there are few different ones. */
static void a_ranked_number_is_that_of_the_sorted_numbers(void **state) {
    (void)state;
    enum { MOST = 40 };
    for (size_t count = 1; count <= MOST; count++)
        for (size_t different = 1; different <= MOST; different += 13)
            for (size_t rank = 0; rank < count; rank++) {
                double values[MOST], sorted[MOST];
                for (size_t k = 0; k < count; k++)
                    values[k] = sorted[k] = (double)((k * 7919 + count) % 104729 % different);
                gn_sort_numbers(sorted, count);
                assert_true(gn_ranked_number(values, count, rank) == sorted[rank]);
            }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_failure_carries_status_and_text),
        cmocka_unit_test(memory_is_aligned_and_zeroed),
        cmocka_unit_test(a_product_that_overflows_is_refused),
        cmocka_unit_test(every_effect_has_a_name),
        cmocka_unit_test(threads_that_help_are_used),
        cmocka_unit_test(threads_that_slow_the_work_are_not_used),
        cmocka_unit_test(an_unlucky_trial_is_repeated_soon),
        cmocka_unit_test(a_trial_of_all_threads_ends_when_it_is_lost),
        cmocka_unit_test(one_thread_stays_one),
        cmocka_unit_test(a_ranked_number_is_that_of_the_sorted_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
