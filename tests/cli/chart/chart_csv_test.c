// SPDX-License-Identifier: Apache-2.0
#include "cli/chart/chart_csv.h"

#include "cli/chart/chart_points.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "tests/support/temp_folder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const struct chart_facts facts = {.name = "fog, \"thick\"",
                                         .scene = "0123456789abcdef0123456789abcdef",
                                         .frame = 7,
                                         .width_px = 320,
                                         .height_px = 180,
                                         .backend = "osmesa",
                                         .renderer = "llvmpipe (LLVM 15, 256 bits)"};

static void add_points(struct chart_points *points)
{
    points->facts = facts;
    chart_points_add(points, &(struct chart_point){.series = "gauss 2",
                                                   .rung = 3,
                                                   .quality = xstrdup("{\"method\":\"gauss\",\"order\":2}"),
                                                   .outcome = CHART_MEASURED,
                                                   .seconds = 0.125,
                                                   .repeats = 3,
                                                   .timer = "wall",
                                                   .error = 0.0625,
                                                   .largest_error = 2,
                                                   .truth = "reference",
                                                   .pixels = 400});
    chart_points_add(points, &(struct chart_point){.series = "riemann",
                                                   .rung = 9,
                                                   .quality = xstrdup("{}"),
                                                   .outcome = CHART_REFUSED,
                                                   .reason = "needs, say,\n\"clip\""});
}

static void what_is_saved_is_loaded(void **state)
{
    struct chart_points points = {0}, loaded = {.facts = facts};
    const char *path = temp_folder_path(state, "chart.csv");
    struct error error = {{0}};

    add_points(&points);
    assert_true(chart_csv_save(&points, path, &error));
    assert_true(chart_csv_load(&loaded, path, &error));
    assert_int_equal(loaded.count, 2);
    for (size_t i = 0; i < 2; i++) {
        const struct chart_point *a = &points.list[i], *b = &loaded.list[i];

        assert_string_equal(a->series, b->series);
        assert_string_equal(a->quality, b->quality);
        assert_string_equal(a->timer, b->timer);
        assert_string_equal(a->truth, b->truth);
        assert_string_equal(a->reason, b->reason);
        assert_int_equal(a->rung, b->rung);
        assert_int_equal(a->outcome, b->outcome);
        assert_int_equal(a->repeats, b->repeats);
        assert_int_equal(a->pixels, b->pixels);
        assert_float_equal(a->seconds, b->seconds, 0);
        assert_float_equal(a->error, b->error, 0);
        assert_float_equal(a->largest_error, b->largest_error, 0);
    }
    chart_points_finish(&points);
    chart_points_finish(&loaded);
}

static void no_file_is_no_points(void **state)
{
    struct chart_points loaded = {.facts = facts};
    const char *path = temp_folder_path(state, "chart.csv");
    struct error error = {{0}};

    assert_true(chart_csv_load(&loaded, path, &error));
    assert_int_equal(loaded.count, 0);
}

static void assert_refused(void **state, const struct chart_facts *others, const char *text, const char *word)
{
    struct chart_points points = {0}, loaded = {.facts = *others};
    const char *path = temp_folder_path(state, "chart.csv");
    struct error error = {{0}};

    add_points(&points);
    unlink(path);
    assert_true(text ? file_write_atomic(path, text, strlen(text), &error) : chart_csv_save(&points, path, &error));
    assert_false(chart_csv_load(&loaded, path, &error));
    assert_non_null(strstr(error.message, word));
    assert_non_null(strstr(error.message, "chart.csv"));
    chart_points_finish(&points);
    chart_points_finish(&loaded);
}

static void points_of_another_picture_are_refused(void **state)
{
    struct chart_facts others = facts;

    others.frame = 8;
    assert_refused(state, &others, NULL, "another scene");
    others = facts;
    others.scene[0] = 'f';
    assert_refused(state, &others, NULL, "another scene");
    others = facts;
    others.height_px = 181;
    assert_refused(state, &others, NULL, "another scene");
    others = facts;
    others.renderer[0] = 'L';
    assert_refused(state, &others, NULL, "another scene");
}

static void other_files_are_refused(void **state)
{
    assert_refused(state, &facts, "", "other columns");
    assert_refused(state, &facts, "a,b\r\n1,2\r\n", "other columns");
}

static void half_a_line_is_refused(void **state)
{
    struct chart_points points = {0};
    const char *path = temp_folder_path(state, "chart.csv");
    char *text = NULL;
    struct error error = {{0}};
    size_t length;

    add_points(&points);
    assert_true(chart_csv_save(&points, path, &error));
    assert_true(file_read_text(path, 1 << 20, &text, &length, &error));
    for (size_t cut = 1; cut < 60; cut++) {
        text[length - cut] = 0;
        if (text[length - cut - 1] != '\n') assert_refused(state, &facts, text, "got another line after");
    }
    free(text);
    chart_points_finish(&points);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(what_is_saved_is_loaded, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(no_file_is_no_points, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(points_of_another_picture_are_refused, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(other_files_are_refused, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(half_a_line_is_refused, temp_folder_create, temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
