// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_beyond.h"

#include "core/base/error.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "core/scene/scene.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static const struct job_beyond MEASURED = {.is_known = true, .error = 0.6512, .error95 = 0.6789};

static void assert_describes(const struct job_beyond *beyond, int orders, const char *expected)
{
    char text[JOB_BEYOND_TEXT_SIZE];

    job_beyond_describe(beyond, orders, text);
    assert_string_equal(text, expected);
}

static void a_sentence_says_it(void **state)
{
    const struct job_beyond unknown = {.why = "a density has no known bound"};

    assert_describes(&MEASURED, 1,
                     "single scattering leaves out 65 % of the picture's light, at most 68 %; "
                     "scene.scattering.orders \"all\" models it");
    assert_describes(&MEASURED, 3,
                     "3 orders of scattering leave out 65 % of the picture's light, at most 68 %; "
                     "scene.scattering.orders \"all\" models it");
    assert_describes(&(struct job_beyond){.is_known = true, .error = 0.978, .error95 = 1.0}, 1,
                     "single scattering leaves out 98 % of the picture's light, at most 100 %; "
                     "scene.scattering.orders \"all\" models it");
    assert_describes(&unknown, 1,
                     "how much light single scattering leaves out is not known: a density has no known bound");
    assert_describes(&(struct job_beyond){0}, SCENE_ORDERS_ALL, "");
}

static void shares_have_two_digits_and_all_of_100(void **state)
{
    static const double shares[] = {0.0, 0.00123, 0.6512, 0.9949, 0.9951, 1.0};
    static const char *const texts[] = {"0", "0.12", "65", "99", "99.5", "100"};

    for (size_t i = 0; i < sizeof shares / sizeof *shares; i++) {
        char text[JOB_BEYOND_PERCENT_SIZE];

        job_beyond_percent(shares[i], text);
        assert_string_equal(text, texts[i]);
    }
}

static bool read(const char *text, struct job_beyond *beyond, struct error *error)
{
    struct cJSON *tree;
    struct json_node root;
    bool ok;

    assert_true(json_parse(&tree, text, strlen(text), NULL));
    root = json_node_root(tree);
    ok = job_beyond_read(beyond, &root, error);
    json_delete(tree);
    return ok;
}

static void assert_survives(const struct job_beyond *beyond)
{
    struct json_writer writer = {0};
    struct job_beyond found;

    json_write_begin_object(&writer);
    job_beyond_write(beyond, &writer);
    json_write_end_object(&writer);
    assert_true(read(writer.text, &found, NULL));
    assert_memory_equal(&found, beyond, sizeof found);
    json_writer_finish(&writer);
}

static void json_keeps_it(void **state)
{
    struct job_beyond unknown = {0}, found;

    strcpy(unknown.why, "paths follow diffuse surfaces only");
    assert_survives(&MEASURED);
    assert_survives(&unknown);
    assert_survives(&(struct job_beyond){0});
    assert_true(read("{\"beyond\":null}", &found, NULL));
    assert_false(job_beyond_is_told(&found));
}

static void assert_refuses(const char *text, const char *expected)
{
    struct job_beyond found;
    struct error error = {{0}};

    assert_false(read(text, &found, &error));
    if (!strstr(error.message, expected)) fail_msg("\"%s\" does not name %s", error.message, expected);
    assert_false(job_beyond_is_told(&found));
}

static void wrong_json_is_refused(void **state)
{
    assert_refuses("{\"beyond\":3}", "beyond");
    assert_refuses("{\"beyond\":{}}", "beyond.error");
    assert_refuses("{\"beyond\":{\"error\":0.5}}", "beyond.error95");
    assert_refuses("{\"beyond\":{\"error\":1.5,\"error95\":2}}", "beyond.error");
    assert_refuses("{\"beyond\":{\"error\":0.5,\"error95\":0.4}}", "beyond.error95");
    assert_refuses("{\"beyond\":{\"error\":0.5,\"error95\":0.6,\"why\":\"no\"}}", "beyond.why");
    assert_refuses("{\"beyond\":{\"why\":\"\"}}", "beyond.why");
    assert_refuses("{\"beyond\":{\"why\":\"no\",\"more\":1}}", "more");
}

static void only_what_is_known_is_over_a_tolerance(void **state)
{
    const struct job_beyond unknown = {.error = 0.5, .why = "no"};

    assert_true(job_beyond_is_over(&MEASURED, 0.01));
    assert_false(job_beyond_is_over(&MEASURED, 0.7));
    assert_false(job_beyond_is_over(&MEASURED, 0.0));
    assert_false(job_beyond_is_over(&unknown, 0.01));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sentence_says_it),
        cmocka_unit_test(shares_have_two_digits_and_all_of_100),
        cmocka_unit_test(json_keeps_it),
        cmocka_unit_test(wrong_json_is_refused),
        cmocka_unit_test(only_what_is_known_is_over_a_tolerance),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
