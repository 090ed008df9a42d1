// SPDX-License-Identifier: Apache-2.0
#include "core/json/json_read.h"

#include "core/base/error.h"
#include "core/json/json_write.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct cJSON *parse(const char *text)
{
    struct cJSON *root;
    struct error error = {0};

    if (!json_parse(&root, text, strlen(text), &error)) fail_msg("%s: %s", text, error.message);
    return root;
}

static void assert_refused(const char *text, const char *expected)
{
    struct cJSON *root;
    struct error error = {0};

    assert_false(json_parse(&root, text, strlen(text), &error));
    assert_null(root);
    assert_string_equal(error.message, expected);
}

static void values_are_read_by_type(void **state)
{
    struct cJSON *root = parse("{\"n\":1.5,\"i\":-3,\"b\":true,\"s\":\"x\\u00e9\",\"z\":null,\"a\":[],\"o\":{}}");
    struct json_node node = json_node_root(root);
    struct json_node n = json_node_child(&node, "n"), i = json_node_child(&node, "i"), b = json_node_child(&node, "b");
    struct json_node s = json_node_child(&node, "s"), z = json_node_child(&node, "z"), a = json_node_child(&node, "a");
    struct json_node o = json_node_child(&node, "o"), absent = json_node_child(&node, "N");
    double number;
    int64_t integer;
    bool value;
    const char *text;

    assert_true(json_read_number(&n, 0, 2, &number, NULL) && number == 1.5);
    assert_true(json_read_integer(&i, -3, 3, &integer, NULL) && integer == -3);
    assert_true(json_read_bool(&b, &value, NULL) && value);
    assert_true(json_read_string(&s, &text, NULL));
    assert_string_equal(text, "x\xc3\xa9");
    assert_int_equal(json_node_type(&z), JSON_NULL);
    assert_int_equal(json_node_type(&a), JSON_ARRAY);
    assert_int_equal(json_node_type(&o), JSON_OBJECT);
    assert_int_equal(json_node_type(&absent), JSON_ABSENT);
    assert_true(json_node_is_absent(&absent));
    assert_false(json_node_is_absent(&z));
    json_delete(root);
}

static void text_is_read_to_its_length_only(void **state)
{
    struct cJSON *root;

    assert_true(json_parse(&root, "12345", 2, NULL));
    assert_int_equal(json_node_type(&(struct json_node){.value = root}), JSON_NUMBER);
    json_delete(root);
    assert_false(json_parse(&root, "[1]", 2, NULL));
}

static void repeated_keys_are_refused_with_their_path(void **state)
{
    char *text = malloc(1 << 20);
    char *end = text;

    assert_refused("{\"a\":1,\"b\":2,\"a\":3}", "a: the key appears twice");
    assert_refused("{\"scene\":{\"media\":[{},{\"g\":1,\"\\u0067\":2}]}}", "scene.media[1].g: the key appears twice");
    assert_non_null(text);
    *end++ = '{';
    for (int i = 0; i < 20000; i++)
        end += sprintf(end, "\"key%d\":0,", i);
    strcpy(end, "\"key777\":1}");
    assert_refused(text, "key777: the key appears twice");
    strcpy(end, "\"KEY777\":1}");
    json_delete(parse(text));
    free(text);
}

static void failures_name_the_path(void **state)
{
    struct cJSON *root = parse("{\"scene\":{\"media\":[0,{\"phase\":[{\"g\":\"x\"}]}],\"odd key\":1}}");
    struct json_node node = json_node_root(root);
    struct json_node scene = json_node_child(&node, "scene"), media = json_node_child(&scene, "media");
    struct json_node medium = json_node_element(&media, 1), phase = json_node_child(&medium, "phase");
    struct json_node lobe = json_node_element(&phase, 0), g = json_node_child(&lobe, "g");
    struct json_node odd = json_node_child(&scene, "odd key"), beyond = json_node_element(&media, 2);
    struct json_node below = json_node_child(&beyond, "deep");
    struct error error = {0};

    assert_false(json_read_number(&g, -1, 1, &(double){0}, &error));
    assert_string_equal(error.message, "scene.media[1].phase[0].g: expected a number from -1 to 1, got \"x\"");
    assert_false(json_read_bool(&odd, &(bool){0}, &error));
    assert_string_equal(error.message, "scene[\"odd key\"]: expected true or false, got 1");
    assert_false(json_read_bool(&beyond, &(bool){0}, &error));
    assert_string_equal(error.message, "scene.media[2]: expected true or false, got nothing");
    assert_true(json_node_is_absent(&below));
    json_fail(&below, &error, "%s", "why");
    assert_string_equal(error.message, "scene.media[2].deep: why");
    json_fail(&node, &error, "why");
    assert_string_equal(error.message, "why");
    node.key = "params";
    json_fail(&scene, &error, "why");
    assert_string_equal(error.message, "params.scene: why");
    assert_false(json_fail(&scene, NULL, "why"));
    json_delete(root);
}

static void values_in_messages_are_short_and_harmless(void **state)
{
    struct cJSON *root =
        parse("[[1,2],{\"a\":1},\"\\u001b[31m\\n\",\"aaaaaaaaaabbbbbbbbbbccccccccccddddddddd\xc3\xa9zzz\",null]");
    static const char *const shown[] = {"an array of 2", "an object", "\"\\u001b[31m\\n\"",
                                        "\"aaaaaaaaaabbbbbbbbbbccccccccccddddddddd...\"", "null"};
    struct json_node node = json_node_root(root), element = {0};
    struct error error = {0};
    char expected[128];

    while (json_node_next(&node, &element)) {
        snprintf(expected, sizeof expected, "[%zu]: expected a cat, got %s", element.index, shown[element.index]);
        json_fail_expected(&element, &error, "a cat");
        assert_string_equal(error.message, expected);
    }
    json_delete(root);
}

static void hostile_keys_do_not_hide_the_message(void **state)
{
    char *text = malloc(8000);
    struct cJSON *root;
    struct error error = {0};
    int at = 0;

    assert_non_null(text);
    for (int i = 0; i < 30; i++)
        at += sprintf(text + at, "{\"%0200d\\n\":", i);
    at += sprintf(text + at, "5");
    for (int i = 0; i < 30; i++)
        text[at++] = '}';
    assert_true(json_parse(&root, text, (size_t)at, &error));
    {
        struct json_node nodes[31] = {json_node_root(root)};

        for (int i = 0; i < 30; i++)
            assert_true(json_node_next(&nodes[i], &nodes[i + 1]));
        assert_false(json_read_bool(&nodes[30], &(bool){0}, &error));
    }
    assert_non_null(strstr(error.message, ": expected true or false, got 5"));
    assert_null(strchr(error.message, '\n'));
    json_delete(root);
    free(text);
}

static void ranges_are_closed(void **state)
{
    struct cJSON *root = parse("[0,1,1.0000001,-0.5,3]");
    struct json_node node = json_node_root(root);
    struct json_node elements[5];
    struct error error = {0};
    double number;

    for (size_t i = 0; i < 5; i++)
        elements[i] = json_node_element(&node, i);
    assert_true(json_read_number(&elements[0], 0, 1, &number, NULL));
    assert_true(json_read_number(&elements[1], 0, 1, &number, NULL));
    assert_false(json_read_number(&elements[2], 0, 1, &number, &error));
    assert_string_equal(error.message, "[2]: expected a number from 0 to 1, got 1.0000001");
    assert_false(json_read_number(&elements[3], 0, (double)INFINITY, &number, &error));
    assert_string_equal(error.message, "[3]: expected a number of at least 0, got -0.5");
    assert_false(json_read_number(&elements[4], (double)-INFINITY, 2, &number, &error));
    assert_string_equal(error.message, "[4]: expected a number of at most 2, got 3");
    json_delete(root);
}

static void integers_are_whole_and_exact(void **state)
{
    struct cJSON *root = parse("[9007199254740992,9007199254740994,1.5,1e3,\"7\",-1]");
    struct json_node node = json_node_root(root);
    struct json_node elements[6];
    struct error error = {0};
    int64_t integer;

    for (size_t i = 0; i < 6; i++)
        elements[i] = json_node_element(&node, i);
    assert_true(json_read_integer(&elements[0], 0, INT64_MAX, &integer, NULL));
    assert_true(integer == INT64_C(9007199254740992));
    assert_false(json_read_integer(&elements[1], 0, INT64_MAX, &integer, NULL));
    assert_false(json_read_integer(&elements[2], 0, 10, &integer, &error));
    assert_string_equal(error.message, "[2]: expected an integer from 0 to 10, got 1.5");
    assert_true(json_read_integer(&elements[3], 0, 1000, &integer, NULL));
    assert_int_equal(integer, 1000);
    assert_false(json_read_integer(&elements[4], INT64_MIN, INT64_MAX, &integer, &error));
    assert_string_equal(error.message, "[4]: expected an integer, got \"7\"");
    assert_false(json_read_integer(&elements[5], 0, INT64_MAX, &integer, &error));
    assert_string_equal(error.message, "[5]: expected an integer of at least 0, got -1");
    json_delete(root);
}

static void enum_suggests_the_nearest_name(void **state)
{
    static const char *const names[] = {"none", "rle", "zips", "zip", NULL};
    struct cJSON *root = parse("[\"zip\",\"zpi\",\"lossless\",5]");
    struct json_node node = json_node_root(root);
    struct json_node elements[4];
    struct error error = {0};
    int choice = -1;

    for (size_t i = 0; i < 4; i++)
        elements[i] = json_node_element(&node, i);
    assert_true(json_read_enum(&elements[0], names, &choice, NULL));
    assert_int_equal(choice, 3);
    assert_false(json_read_enum(&elements[1], names, &choice, &error));
    assert_string_equal(error.message,
                        "[1]: expected one of \"none\",\"rle\",\"zips\",\"zip\", got \"zpi\", did you mean \"zip\"?");
    assert_false(json_read_enum(&elements[2], names, &choice, &error));
    assert_string_equal(error.message, "[2]: expected one of \"none\",\"rle\",\"zips\",\"zip\", got \"lossless\"");
    assert_false(json_read_enum(&elements[3], names, &choice, &error));
    assert_string_equal(error.message, "[3]: expected one of \"none\",\"rle\",\"zips\",\"zip\", got 5");
    json_delete(root);
}

static void unknown_keys_are_refused_with_a_suggestion(void **state)
{
    static const char *const names[] = {"camera", "lights", NULL}, *const kinds[] = {"kind", "radius", NULL};
    struct cJSON *root = parse("{\"a\":{\"camera\":1},\"b\":{\"camrea\":1},\"c\":{\"x\\ny\":1},\"d\":5,"
                               "\"e\":{\"kind\":\"a\\nb\",\"x\":1},\"f\":{\"method\":5,\"kind\":1}}");
    struct json_node node = json_node_root(root);
    struct json_node a = json_node_child(&node, "a"), b = json_node_child(&node, "b"), c = json_node_child(&node, "c");
    struct json_node d = json_node_child(&node, "d"), e = json_node_child(&node, "e"), f = json_node_child(&node, "f");
    struct error error = {0};

    assert_true(json_check_keys(&a, names, NULL));
    assert_false(json_check_keys(&b, names, &error));
    assert_string_equal(error.message, "b: unknown key \"camrea\", did you mean \"camera\"?");
    assert_false(json_check_keys(&c, names, &error));
    assert_string_equal(error.message, "c: unknown key \"x\\ny\"; known: camera, lights");
    assert_false(json_check_keys(&e, kinds, &error));
    assert_string_equal(error.message, "e: unknown key \"x\" beside kind \"a\\nb\"; known: kind, radius");
    assert_false(json_check_keys(&e, names, &error));
    assert_string_equal(error.message, "e: unknown key \"kind\"; known: camera, lights");
    assert_false(json_check_keys(&f, kinds, &error));
    assert_string_equal(error.message, "f: unknown key \"method\"; known: kind, radius");
    assert_false(json_check_object(&d, &error));
    assert_string_equal(error.message, "d: expected an object, got 5");
    json_delete(root);
}

static void array_counts_are_checked(void **state)
{
    struct cJSON *root = parse("[[],[1,2,3],{\"a\":1}]");
    struct json_node node = json_node_root(root);
    struct json_node none = json_node_element(&node, 0), three = json_node_element(&node, 1);
    struct json_node object = json_node_element(&node, 2);
    struct error error = {0};

    assert_true(json_check_array(&three, 3, 3, NULL));
    assert_true(json_check_array(&none, 0, SIZE_MAX, NULL));
    assert_false(json_check_array(&none, 3, 3, &error));
    assert_string_equal(error.message, "[0]: expected an array of 3, got an array of 0");
    assert_false(json_check_array(&three, 1, 2, &error));
    assert_string_equal(error.message, "[1]: expected an array of 1 to 2, got an array of 3");
    assert_false(json_check_array(&object, 1, SIZE_MAX, &error));
    assert_string_equal(error.message, "[2]: expected an array of at least 1, got an object");
    json_delete(root);
}

static void format_round_trips(void **state)
{
    static const char text[] = "{\"a\":[1,2.5,-0.1,true,false,null,\"x\\n\xc3\xa9\",{}],\"b\":{\"c\":[]},\"\":1e-300}";
    struct cJSON *root = parse(text);
    struct json_node node = json_node_root(root);
    char *formatted = json_node_format(&node);

    assert_string_equal(formatted, text);
    free(formatted);
    json_delete(root);
}

static void members_are_walked_in_order(void **state)
{
    struct cJSON *root = parse("{\"b\":1,\"a\":[],\"c\":3}");
    struct json_node node = json_node_root(root), child = {0};
    struct json_node empty = json_node_child(&node, "a");
    char keys[4] = "";

    while (json_node_next(&node, &child))
        strcat(keys, child.key);
    assert_string_equal(keys, "bac");
    assert_int_equal(json_node_count(&node), 3);
    child = (struct json_node){0};
    assert_false(json_node_next(&empty, &child));
    json_delete(root);
}

static void large_arrays_are_walked_in_linear_time(void **state)
{
    enum { COUNT = 100 * 1000 };
    struct json_writer writer = {0};
    struct cJSON *root = NULL;
    struct json_node node, element = {0};
    size_t count = 0;

    json_write_begin_array(&writer);
    for (int i = 0; i < COUNT; i++)
        json_write_integer(&writer, i);
    json_write_end_array(&writer);
    assert_true(json_parse(&root, writer.text, writer.length, NULL));
    node = json_node_root(root);
    for (; json_node_next(&node, &element); count++) {
        int64_t integer = -1;

        assert_true(json_read_integer(&element, 0, COUNT, &integer, NULL));
        assert_true(integer == (int64_t)count && element.index == count);
    }
    assert_int_equal(count, COUNT);
    json_delete(root);
    json_writer_finish(&writer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_read_by_type),
        cmocka_unit_test(text_is_read_to_its_length_only),
        cmocka_unit_test(repeated_keys_are_refused_with_their_path),
        cmocka_unit_test(failures_name_the_path),
        cmocka_unit_test(values_in_messages_are_short_and_harmless),
        cmocka_unit_test(hostile_keys_do_not_hide_the_message),
        cmocka_unit_test(ranges_are_closed),
        cmocka_unit_test(integers_are_whole_and_exact),
        cmocka_unit_test(enum_suggests_the_nearest_name),
        cmocka_unit_test(unknown_keys_are_refused_with_a_suggestion),
        cmocka_unit_test(array_counts_are_checked),
        cmocka_unit_test(format_round_trips),
        cmocka_unit_test(members_are_walked_in_order),
        cmocka_unit_test(large_arrays_are_walked_in_linear_time),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
