// SPDX-License-Identifier: Apache-2.0
#include "cli/job/json_set.h"

#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const char document[] = "{\"name\":\"a\",\"camera\":{\"position\":[0,0,-2]},\"media\":[{\"s\":1},{\"s\":2}]}";

static void assert_edited(const char *text, const char *assignment, const char *expected)
{
    struct error error = {0};
    char *edited = json_set(text, assignment, &error);

    if (!edited) fail_msg("%s: %s", assignment, error.message);
    assert_string_equal(edited, expected);
    free(edited);
}

static void assert_refused(const char *assignment, const char *expected)
{
    struct error error = {0};

    assert_null(json_set(document, assignment, &error));
    assert_string_equal(error.message, expected);
    assert_null(json_set(document, assignment, NULL));
}

static void value_at_a_path_is_replaced_and_the_rest_stays(void **state)
{
    assert_edited(document, "media[1].s=32",
                  "{\"name\":\"a\",\"camera\":{\"position\":[0,0,-2]},\"media\":[{\"s\":1},{\"s\":32}]}");
    assert_edited(document, "camera.position=[0,0,-3]",
                  "{\"name\":\"a\",\"camera\":{\"position\":[0,0,-3]},\"media\":[{\"s\":1},{\"s\":2}]}");
    assert_edited(document, "camera.position[2]=-4",
                  "{\"name\":\"a\",\"camera\":{\"position\":[0,0,-4]},\"media\":[{\"s\":1},{\"s\":2}]}");
}

static void value_that_is_no_json_is_a_string(void **state)
{
    assert_edited("{\"a\":1}", "a=0-239x10", "{\"a\":\"0-239x10\"}");
    assert_edited("{\"a\":1}", "a=", "{\"a\":\"\"}");
    assert_edited("{\"a\":1}", "a=say \"x=y\"", "{\"a\":\"say \\\"x=y\\\"\"}");
    assert_edited("{\"a\":1}", "a=\"7\"", "{\"a\":\"7\"}");
}

static void number_in_place_of_a_string_is_its_text(void **state)
{
    assert_edited("{\"frames\":\"0-9\"}", "frames=48", "{\"frames\":\"48\"}");
    assert_edited("{\"frames\":\"0-9\"}", "frames=[48]", "{\"frames\":[48]}");
    assert_edited("{\"fps\":24}", "fps=48", "{\"fps\":48}");
}

// Orders of scattering are "all" or a number.
static void number_in_place_of_a_name_is_a_number(void **state)
{
    assert_edited("{\"scene\":{\"scattering\":{\"orders\":\"all\"}}}", "scene.scattering.orders=3",
                  "{\"scene\":{\"scattering\":{\"orders\":3}}}");
    assert_edited("{\"scene\":{\"scattering\":{\"orders\":3}}}", "scene.scattering.orders=all",
                  "{\"scene\":{\"scattering\":{\"orders\":\"all\"}}}");
    assert_edited("{\"orders\":\"all\"}", "orders=3", "{\"orders\":\"3\"}");
}

static void missing_keys_are_added_with_what_leads_to_them(void **state)
{
    assert_edited("{}", "quality.step=0.5", "{\"quality\":{\"step\":0.5}}");
    assert_edited("{\"a\":1}", "media[0].g=0.5", "{\"a\":1,\"media\":[{\"g\":0.5}]}");
}

static void index_equal_to_the_count_appends(void **state)
{
    assert_edited("{\"a\":[1,2]}", "a[2]=3", "{\"a\":[1,2,3]}");
    assert_edited("{\"a\":[]}", "a[0].b=3", "{\"a\":[{\"b\":3}]}");
}

static void nested_arrays_are_reached(void **state)
{
    assert_edited("{\"keys\":[[0,1],[1,5]]}", "keys[1][0]=2", "{\"keys\":[[0,1],[2,5]]}");
}

static void member_is_taken_with_its_value(void **state)
{
    char *value = NULL, *rest = json_take(document, "media[1].s", &value);

    assert_string_equal(rest, "{\"name\":\"a\",\"camera\":{\"position\":[0,0,-2]},\"media\":[{\"s\":1},{}]}");
    assert_string_equal(value, "2");
    free(rest);
    free(value);
    value = NULL;
    for (int i = 0; i < 4; i++)
        assert_null(json_take(document, (const char *[]){"media[1]", "media[2].s", "camera.up", "name.s"}[i], &value));
    assert_null(value);
}

static void wrong_paths_are_named(void **state)
{
    assert_refused("media[3].s=1", "media[3]: the array has 2 elements, index 2 would append");
    assert_refused("name.x=1", "name.x: its parent is no object");
    assert_refused("camera[0]=1", "camera[0]: its parent is no array");
    assert_refused("new[1]=1", "new[1]: the array has no elements, only [0] can be added");
    assert_refused("media", "\"media\": expected PATH=VALUE");
}

static void malformed_paths_are_refused(void **state)
{
    static const char *const paths[] = {"=1",      ".a=1",   "a.=1", "a..b=1",  "a[=1",         "a[]=1",
                                        "a[-1]=1", "a[x]=1", "a]=1", "a[0]b=1", "a[99999999]=1"};

    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        struct error error = {0};

        if (json_set(document, paths[i], &error)) fail_msg("%s was taken", paths[i]);
        assert_non_null(strstr(error.message, "expected a path such as"));
    }
}

static void path_deeper_than_json_may_be_is_refused(void **state)
{
    char assignment[256] = "a";
    struct error error = {0};

    for (int i = 0; i < 40; i++)
        strcat(assignment, ".a");
    strcat(assignment, "=1");
    assert_null(json_set("{}", assignment, &error));
    assert_non_null(strstr(error.message, "levels"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(value_at_a_path_is_replaced_and_the_rest_stays),
        cmocka_unit_test(value_that_is_no_json_is_a_string),
        cmocka_unit_test(number_in_place_of_a_string_is_its_text),
        cmocka_unit_test(number_in_place_of_a_name_is_a_number),
        cmocka_unit_test(missing_keys_are_added_with_what_leads_to_them),
        cmocka_unit_test(index_equal_to_the_count_appends),
        cmocka_unit_test(nested_arrays_are_reached),
        cmocka_unit_test(member_is_taken_with_its_value),
        cmocka_unit_test(wrong_paths_are_named),
        cmocka_unit_test(malformed_paths_are_refused),
        cmocka_unit_test(path_deeper_than_json_may_be_is_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
