// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/picture_query.h"

#include "core/base/error.h"
#include "core/json/json_write.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

// Splits a text at its ampersands, as a server does.
static bool parse(struct picture_query *query, const char *path, const char *text, struct error *error)
{
    char copy[512], *rest = copy;
    const char *pairs[16];
    size_t count = 0;

    snprintf(copy, sizeof copy, "%s", text ? text : "");
    while (text && rest)
        pairs[count++] = strsep(&rest, "&");
    return picture_query_parse(query, path, pairs, count, error);
}

static void path_names_job_frame_and_form(void **state)
{
    struct picture_query query;

    assert_true(parse(&query, "/frame/7/12.png", NULL, NULL));
    assert_true(query.job == 7 && query.frame == 12 && query.form == PICTURE_FORM_PNG);
    assert_false(query.has_exposure);
    assert_true(parse(&query, "/frame/9007199254740992/0012.json", NULL, NULL));
    assert_true(query.job == INT64_C(1) << 53 && query.frame == 12 && query.form == PICTURE_FORM_HEADER);
    assert_true(parse(&query, "/job/7/explain", NULL, NULL));
    assert_true(query.job == 7 && query.frame == 0 && query.form == PICTURE_FORM_EXPLANATION);
}

static void other_paths_are_refused(void **state)
{
    static const char *const paths[] = {"/frame/",
                                        "/frame/7",
                                        "/frame/7/",
                                        "/frame/7/.png",
                                        "/frame/7/1.exr",
                                        "/frame/-7/1.png",
                                        "/frame/7/1.png/",
                                        "/frame/7/1.pngx",
                                        "/frame//1.png",
                                        "/frame/7//1.png",
                                        "/frame/7/1",
                                        "/frame/0x7/1.png",
                                        "/frame/ 7/1.png",
                                        "/frame/7/../1.png",
                                        "/frame/7/99999999999.png",
                                        "/frame/99999999999999999999/1.png",
                                        "frame/7/1.png",
                                        "/job/",
                                        "/job/7",
                                        "/job/7/",
                                        "/job//explain",
                                        "/job/7/explain/",
                                        "/job/-7/explain",
                                        "/job/7/1.png",
                                        "/frame/7/explain",
                                        ""};

    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
        struct picture_query query;
        struct error error = {0};

        if (parse(&query, paths[i], NULL, &error)) fail_msg("%s is taken", paths[i]);
        assert_string_equal(error.message, strncmp(paths[i], "/job/", 5)
                                               ? "expected /frame/JOB/N.png or /frame/JOB/N.json"
                                               : "expected /job/JOB/explain");
    }
}

static void values_are_read_and_written_in_one_order(void **state)
{
    struct json_writer writer = {0};
    struct picture_query query;

    assert_true(parse(&query, "/frame/7/1.png", "size=512&h=5&w=4&y=3&x=0&exposure=-1.5&channel=diffuse.R", NULL));
    json_write_begin_object(&writer);
    picture_query_write(&query, &writer);
    json_write_end_object(&writer);
    assert_string_equal(writer.text, "{\"channel\":\"diffuse.R\",\"exposure\":-1.5,\"y\":3,\"width\":4,\"height\":5,"
                                     "\"size\":512}");
    json_writer_finish(&writer);
}

static void colour_is_what_is_shown_without_a_channel(void **state)
{
    struct picture_query query;

    assert_true(parse(&query, "/frame/7/1.png", "channel=color", NULL));
    assert_string_equal(query.channel, "");
}

static void wrong_values_are_refused_by_name(void **state)
{
    static const struct {
        const char *text, *reason;
    } wrong[] = {{"exposure=", "exposure: expected"},
                 {"exposure=nan", "exposure: expected"},
                 {"exposure=inf", "exposure: expected"},
                 {"exposure=0x1", "exposure: expected"},
                 {"exposure=61", "exposure: expected"},
                 {"exposure=1,5", "exposure: expected"},
                 {"x=-1", "x: expected"},
                 {"x=16385", "x: expected"},
                 {"w=0", "w: expected"},
                 {"h=1e3", "h: expected"},
                 {"size=4097", "size: expected a number of pixels from 1 to 4096"},
                 {"size=5&size=5", "size: expected once"},
                 {"channel=", "channel: expected"},
                 {"channel=\n", "channel: expected"},
                 {"channel=\xe2\x80\xae", "channel: expected"},
                 {"channel=\xff", "channel: expected"},
                 {"channel", "expected channel, exposure"},
                 {"=5", "expected channel, exposure"},
                 {"out=/etc/passwd", "expected channel, exposure"},
                 {"file=/etc/passwd", "expected channel, exposure"},
                 {"x=1&&y=2", "expected channel, exposure"}};

    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        struct picture_query query;
        struct error error = {0};

        if (parse(&query, "/frame/7/1.png", wrong[i].text, &error)) fail_msg("%s is taken", wrong[i].text);
        if (strncmp(error.message, wrong[i].reason, strlen(wrong[i].reason)) != 0)
            fail_msg("%s: expected \"%s\", got \"%s\"", wrong[i].text, wrong[i].reason, error.message);
    }
}

static void long_names_are_refused(void **state)
{
    char text[8 + PICTURE_CHANNEL_LIMIT + 2] = "channel=";
    struct picture_query query;

    memset(text + 8, 'a', PICTURE_CHANNEL_LIMIT);
    assert_true(parse(&query, "/frame/7/1.png", text, NULL));
    text[8 + PICTURE_CHANNEL_LIMIT] = 'a';
    assert_false(parse(&query, "/frame/7/1.png", text, NULL));
}

static void only_a_picture_has_parts(void **state)
{
    struct picture_query query;

    assert_false(parse(&query, "/frame/7/1.json", "x=5", NULL));
    assert_false(parse(&query, "/job/7/explain", "x=5", NULL));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(path_names_job_frame_and_form),
        cmocka_unit_test(other_paths_are_refused),
        cmocka_unit_test(values_are_read_and_written_in_one_order),
        cmocka_unit_test(colour_is_what_is_shown_without_a_channel),
        cmocka_unit_test(wrong_values_are_refused_by_name),
        cmocka_unit_test(long_names_are_refused),
        cmocka_unit_test(only_a_picture_has_parts),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
