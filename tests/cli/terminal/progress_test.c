// SPDX-License-Identifier: Apache-2.0
#include "cli/terminal/progress.h"

#include "cli/terminal/table.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const struct progress halfway = {
    .label = "#7 cloud", .state = "running", .total = 240, .done = 120, .seconds_per_frame = 1.5, .eta_s = 180};

static void assert_line(const struct progress *progress, int width, const char *expected)
{
    char *line = progress_format(progress, width, false);

    assert_string_equal(line, expected);
    free(line);
}

static void bar_shows_the_share_that_is_done(void **state)
{
    assert_line(&halfway, 64, "#7 cloud  [==========          ]  120/240  1.5 s/frame  ETA 3:00");
}

static void failed_frames_are_in_the_bar_even_if_few(void **state)
{
    struct progress progress = {
        .label = "a", .total = 1000, .done = 500, .failed = 1, .seconds_per_frame = -1, .eta_s = -1};

    assert_line(&progress, 45, "a  [==========x         ]  500/1000  1 failed");
}

static void waiting_job_says_why(void **state)
{
    struct progress progress = {.label = "a",
                                .state = "paused",
                                .total = 10,
                                .seconds_per_frame = -1,
                                .eta_s = 5,
                                .reason = "paused by its owner"};

    assert_line(&progress, 60, "a  [                            ]  0/10  paused by its owner");
}

static void state_and_reason_are_told_once(void **state)
{
    static const char *const rows[][3] = {
        {"canceled", "canceled by ann", "canceled by ann"},
        {"paused", "paused: output: full", "paused: output: full"},
        {"queued", "waits behind job 4", "queued: waits behind job 4"},
        {"succeeded", NULL, "succeeded"},
    };

    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        char *text = progress_format_state(rows[i][0], rows[i][1]);

        assert_string_equal(text, rows[i][2]);
        free(text);
    }
}

static void no_line_is_wider_than_asked_for(void **state)
{
    struct progress progress = halfway;

    progress.reason = "a reason that is rather long and has \xc3\xa9\xc3\xa8 in it";
    progress.state = "queued";
    progress.failed = 3;
    for (int width = 1; width < 200; width++) {
        char *line = progress_format(&progress, width, false);

        if (table_text_width(line) > (size_t)width) fail_msg("width %d: \"%s\"", width, line);
        free(line);
    }
}

static void full_bar_has_no_gap(void **state)
{
    struct progress progress = {.label = "a", .total = 3, .done = 3, .seconds_per_frame = -1, .eta_s = -1};

    assert_line(&progress, 30, "a  [====================]  3/3");
}

static void job_without_frames_is_no_division_by_zero(void **state)
{
    struct progress progress = {.label = "a", .seconds_per_frame = -1, .eta_s = -1};

    assert_line(&progress, 22, "a  [            ]  0/0");
}

static void colour_is_only_there_when_asked_for(void **state)
{
    char *plain = progress_format(&halfway, 80, false), *colored = progress_format(&halfway, 80, true);

    assert_null(strchr(plain, '\033'));
    assert_non_null(strstr(colored, "\033[32m"));
    free(plain);
    free(colored);
}

static void control_bytes_in_names_are_replaced(void **state)
{
    struct progress progress = {.label = "a\033b", .total = 1, .seconds_per_frame = -1, .eta_s = -1, .reason = "x\ny"};
    char *line = progress_format(&progress, 80, false);

    assert_null(strchr(line, '\033'));
    assert_null(strchr(line, '\n'));
    free(line);
}

static void assert_duration(double seconds, const char *expected)
{
    char *text = progress_format_duration(seconds);

    assert_string_equal(text, expected);
    free(text);
}

static void durations_read_as_clocks(void **state)
{
    assert_duration(0.04, "0.0 s");
    assert_duration(9.94, "9.9 s");
    assert_duration(42.4, "42 s");
    assert_duration(59.6, "1:00");
    assert_duration(3599, "59:59");
    assert_duration(7509, "2:05:09");
    assert_duration(90000, "1 d 01:00");
    assert_duration(1e300, "11574074074 d 01:46");
}

static void assert_pace(double seconds, const char *expected)
{
    char *text = progress_format_pace(seconds);

    assert_string_equal(text, expected);
    free(text);
}

static void paces_have_no_exponent(void **state)
{
    assert_pace(0, "<0.001");
    assert_pace(8.2e-5, "<0.001");
    assert_pace(0.00273, "0.00273");
    assert_pace(6.414, "6.41");
    assert_pace(999.4, "999");
    assert_pace(999.6, "1000");
    assert_pace(1234.4, "1234");
}

// Draws to a file instead of a terminal.
static void plain_display_repeats_nothing_that_did_not_change(void **state)
{
    struct progress progress = halfway;
    struct progress_display display;
    char text[512] = "";
    FILE *out = tmpfile();

    assert_non_null(out);
    progress_display_init(&display, out);
    assert_false(display.is_live);
    progress_display_draw(&display, &progress, 1, 1000, false);
    progress_display_draw(&display, &progress, 1, 60000, false);
    progress.done = 121;
    progress_display_draw(&display, &progress, 1, 61000, false); // within the 5 s
    progress_display_draw(&display, &progress, 1, 66000, false);
    rewind(out);
    assert_true(fread(text, 1, sizeof text - 1, out) > 0);
    assert_string_equal(text, "#7 cloud: 120/240  1.5 s/frame  ETA 3:00\n#7 cloud: 121/240  1.5 s/frame  ETA 3:00\n");
    fclose(out);
}

static void plain_display_tells_at_once_that_a_job_is_held(void **state)
{
    struct progress jobs[] = {halfway, halfway};
    struct progress_display display;
    char text[512] = "";
    FILE *out = tmpfile();

    assert_non_null(out);
    progress_display_init(&display, out);
    progress_display_draw(&display, jobs, 2, 1000, false);
    jobs[1].state = "paused";
    jobs[1].reason = "paused by ann";
    progress_display_draw(&display, jobs, 2, 1001, false);
    progress_display_draw(&display, jobs, 2, 1002, false); // no news
    rewind(out);
    for (int i = 0; i < 4; i++)
        assert_non_null(fgets(text, sizeof text, out));
    assert_string_equal(text, "#7 cloud: 120/240  1.5 s/frame  paused by ann\n");
    assert_null(fgets(text, sizeof text, out));
    fclose(out);
}

static void live_display_draws_over_its_own_lines(void **state)
{
    struct progress_display display = {.out = tmpfile(), .is_live = true};
    const struct progress jobs[] = {halfway, halfway};
    char text[1024] = "";

    assert_non_null(display.out);
    progress_display_draw(&display, jobs, 2, 0, true);
    progress_display_draw(&display, jobs, 1, 50, false); // too early to be drawn
    assert_int_equal(display.lines, 2);
    progress_display_draw(&display, jobs, 1, 100, false);
    assert_int_equal(display.lines, 1);
    rewind(display.out);
    assert_true(fread(text, 1, sizeof text - 1, display.out) > 0);
    assert_non_null(strstr(text, "\033[2A\r\033[J#7 cloud"));
    fclose(display.out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bar_shows_the_share_that_is_done),
        cmocka_unit_test(failed_frames_are_in_the_bar_even_if_few),
        cmocka_unit_test(waiting_job_says_why),
        cmocka_unit_test(state_and_reason_are_told_once),
        cmocka_unit_test(no_line_is_wider_than_asked_for),
        cmocka_unit_test(full_bar_has_no_gap),
        cmocka_unit_test(job_without_frames_is_no_division_by_zero),
        cmocka_unit_test(colour_is_only_there_when_asked_for),
        cmocka_unit_test(control_bytes_in_names_are_replaced),
        cmocka_unit_test(durations_read_as_clocks),
        cmocka_unit_test(paces_have_no_exponent),
        cmocka_unit_test(plain_display_repeats_nothing_that_did_not_change),
        cmocka_unit_test(plain_display_tells_at_once_that_a_job_is_held),
        cmocka_unit_test(live_display_draws_over_its_own_lines),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
