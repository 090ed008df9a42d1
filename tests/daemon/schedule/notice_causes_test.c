// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/notice_causes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const int64_t START = 1000 * 1000, HOUR = 3600 * 1000;

static void a_hold_is_told_once_while_it_lasts(void **state)
{
    struct notice_told told = {0};

    assert_int_equal(notice_causes_note(&told, NOTICE_HELD, false, START), NOTICE_NOTHING);
    assert_int_equal(notice_causes_note(&told, NOTICE_HELD, true, START), NOTICE_TELL);
    assert_int_equal(notice_causes_note(&told, NOTICE_HELD, true, START + 10 * HOUR), NOTICE_NOTHING);
    assert_int_equal(notice_causes_note(&told, NOTICE_HELD, false, START + 10 * HOUR), NOTICE_FORGET);
    assert_int_equal(notice_causes_note(&told, NOTICE_HELD, false, START + 10 * HOUR), NOTICE_NOTHING);
    // Somebody resumed it, and the fault is there again.
    assert_int_equal(notice_causes_note(&told, NOTICE_HELD, true, START + 10 * HOUR + 1), NOTICE_TELL);
}

static void a_root_that_flickers_is_not_told(void **state)
{
    struct notice_told told = {0};

    for (int64_t now = START; now < START + HOUR; now += 15000) {
        assert_int_equal(notice_causes_note(&told, NOTICE_ROOT, true, now), NOTICE_NOTHING);
        assert_int_equal(notice_causes_note(&told, NOTICE_ROOT, true, now + 9000), NOTICE_NOTHING);
        assert_int_equal(notice_causes_note(&told, NOTICE_ROOT, false, now + 10000), NOTICE_NOTHING);
    }
}

static void a_root_that_stays_away_is_told_once(void **state)
{
    struct notice_told told = {0};

    assert_int_equal(notice_causes_note(&told, NOTICE_ROOT, true, START), NOTICE_NOTHING);
    assert_int_equal(notice_causes_note(&told, NOTICE_ROOT, true, START + 19999), NOTICE_NOTHING);
    assert_int_equal(notice_causes_note(&told, NOTICE_ROOT, true, START + 20000), NOTICE_TELL);
    assert_int_equal(notice_causes_note(&told, NOTICE_ROOT, true, START + 5 * HOUR), NOTICE_NOTHING);
}

static void a_root_that_comes_and_goes_is_told_once_an_hour(void **state)
{
    struct notice_told told = {0};
    int tells = 0;

    for (int64_t now = START; now < START + 4 * HOUR; now += 60 * 1000) {
        notice_causes_note(&told, NOTICE_ROOT, true, now);
        tells += notice_causes_note(&told, NOTICE_ROOT, true, now + 30 * 1000) == NOTICE_TELL;
        notice_causes_note(&told, NOTICE_ROOT, false, now + 40 * 1000);
    }
    assert_int_equal(tells, 4);
}

static void after_a_restart_what_was_told_is_not_told_again(void **state)
{
    struct notice_told told = {.told_ms = START, .is_on = true}; // as it is stored

    assert_int_equal(notice_causes_note(&told, NOTICE_ROOT, true, START + 2 * HOUR), NOTICE_NOTHING);
    assert_int_equal(notice_causes_note(&told, NOTICE_ROOT, false, START + 2 * HOUR), NOTICE_FORGET);
}

static void a_clock_that_is_set_back_silences_nothing(void **state)
{
    struct notice_told told = {.since_ms = START + 9 * HOUR, .told_ms = START + 9 * HOUR};

    assert_int_equal(notice_causes_note(&told, NOTICE_ROOT, true, START), NOTICE_NOTHING);
    assert_int_equal(notice_causes_note(&told, NOTICE_ROOT, true, START + 20000), NOTICE_TELL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hold_is_told_once_while_it_lasts),
        cmocka_unit_test(a_root_that_flickers_is_not_told),
        cmocka_unit_test(a_root_that_stays_away_is_told_once),
        cmocka_unit_test(a_root_that_comes_and_goes_is_told_once_an_hour),
        cmocka_unit_test(after_a_restart_what_was_told_is_not_told_again),
        cmocka_unit_test(a_clock_that_is_set_back_silences_nothing),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
