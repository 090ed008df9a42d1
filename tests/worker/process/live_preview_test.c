// SPDX-License-Identifier: Apache-2.0
#include "worker/process/live_preview.h"

#include "core/base/clock.h"
#include "core/base/log.h"
#include "tests/support/temp_folder.h"
#include "worker/picture/image.h"
#include "worker/picture/picture_level.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

enum { SIDE = 64 };

static float light[4 * SIDE * SIDE];
static const struct image image = {.width_px = SIDE, .height_px = SIDE, .rgba = light};
static const struct picture_level level = {
    .rgba = light, .stride = 1, .columns = SIDE, .rows = SIDE, .width_px = SIDE, .height_px = SIDE};

// Whether the file was written since the last call.
static bool was_shown(const char *path)
{
    bool is_there = access(path, F_OK) == 0;

    if (is_there) unlink(path);
    return is_there;
}

static void levels_that_follow_too_soon_are_left_out(void **state)
{
    const char *path = temp_folder_path(state, "live.png");
    struct live_preview preview = {0};
    double start_s = clock_now_s(), end_s;

    live_preview_show_level(&preview, path, &level);
    end_s = clock_now_s();
    assert_true(was_shown(path));
    assert_true(preview.next_s > end_s && preview.next_s <= end_s + 20 * (end_s - start_s));
    preview.next_s = end_s + 3600; // whatever the machine does meanwhile
    live_preview_show_level(&preview, path, &level);
    assert_false(was_shown(path));
    live_preview_show_final(&preview, path, &image);
    assert_true(was_shown(path));
    preview.next_s = end_s;
    live_preview_show_level(&preview, path, &level);
    assert_true(was_shown(path));
}

static void levels_wait_for_the_picture_before(void **state)
{
    const char *path = temp_folder_path(state, "live.png");
    struct live_preview preview = {0};

    live_preview_expect_final(&preview, path);
    live_preview_show_level(&preview, path, &level);
    assert_false(was_shown(path));
    live_preview_show_final(&preview, path, &image);
    assert_true(was_shown(path));
    live_preview_show_level(&preview, path, &level);
    assert_false(was_shown(path));
    live_preview_end_final(&preview);
    live_preview_show_level(&preview, path, &level);
    assert_true(was_shown(path));
}

static void nothing_is_shown_without_a_path(void **state)
{
    struct live_preview preview = {0};

    (void)state;
    live_preview_show_level(&preview, NULL, &level);
    live_preview_expect_final(&preview, NULL);
    live_preview_show_final(&preview, NULL, &image);
    assert_false(preview.is_final_due || preview.has_failed);
    assert_true(preview.next_s == 0);
}

static int warning_count;

static void count_warnings(enum log_level of_line, const struct log_subject *subject, const char *line)
{
    (void)subject, (void)line;
    warning_count += of_line == LOG_WARN;
}

static void failures_in_a_row_are_told_once(void **state)
{
    const char *folder = temp_folder_path(state, "later"), *path = temp_folder_path(state, "later/live.png");
    struct live_preview preview = {0};

    warning_count = 0;
    log_set_sink(count_warnings);
    live_preview_show_final(&preview, path, &image);
    live_preview_show_final(&preview, path, &image);
    assert_int_equal(warning_count, 1);
    assert_int_equal(mkdir(folder, 0777), 0);
    live_preview_show_final(&preview, path, &image);
    assert_true(was_shown(path));
    assert_int_equal(rmdir(folder), 0);
    live_preview_show_final(&preview, path, &image);
    assert_int_equal(warning_count, 2);
    log_set_sink(NULL);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(levels_that_follow_too_soon_are_left_out, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(levels_wait_for_the_picture_before, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test(nothing_is_shown_without_a_path),
        cmocka_unit_test_setup_teardown(failures_in_a_row_are_told_once, temp_folder_create, temp_folder_destroy),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
