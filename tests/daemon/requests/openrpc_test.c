// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/openrpc.h"

#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "daemon/requests/methods.h"
#include "daemon/requests/shapes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

static void document_is_strict_json_without_a_key_twice(void **state)
{
    struct json_writer writer = {0};
    struct error error = {0};
    struct cJSON *root = NULL;

    openrpc_write(&writer);
    if (!json_parse(&root, writer.text, writer.length, &error)) fail_msg("%s", error.message);
    json_delete(root);
    json_writer_finish(&writer);
}

static void check_members(const struct member *members, const char *whose)
{
    for (; members && members->name; members++) {
        size_t length = strcspn(members->type, "[?");

        if (!members->meaning) fail_msg("%s.%s has no meaning", whose, members->name);
        if (strchr(members->meaning, '\n')) fail_msg("%s.%s: the meaning is no line", whose, members->name);
        if (members->fallback && !members->is_optional) fail_msg("%s.%s may be absent", whose, members->name);
        if (members->is_set && !members->names) fail_msg("%s.%s: a set of what?", whose, members->name);
        if (strspn(members->type + length, "[]?") != strlen(members->type + length))
            fail_msg("%s.%s: what is \"%s\"?", whose, members->name, members->type);
    }
}

static void each_method_is_found_by_its_own_row(void **state)
{
    struct methods_walk walk = {0};
    const struct method *method;
    size_t count = 0;

    while ((method = methods_next(&walk))) {
        const char *keys[METHOD_PARAM_LIMIT + 1];

        assert_ptr_equal(methods_find(method->name), method);
        assert_non_null(method->handle);
        check_members(method->params, method->name);
        check_members(method->result, method->name);
        methods_list_keys(method, keys);
        count++;
    }
    assert_true(count > 10 && count <= METHOD_LIMIT);
    assert_null(methods_find("job.sbumit"));
    assert_string_equal(methods_find_nearest("job.sbumit"), "job.submit");
}

static void shapes_are_found_by_their_whole_names(void **state)
{
    for (size_t i = 0; shapes[i]; i++) {
        assert_ptr_equal(shapes_find(shapes[i]->name, strlen(shapes[i]->name)), shapes[i]);
        check_members(shapes[i]->members, shapes[i]->name);
    }
    assert_ptr_equal(shapes_find("job[]", 3), &shape_job);
    assert_null(shapes_find("jo", 2));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(document_is_strict_json_without_a_key_twice),
                                       cmocka_unit_test(each_method_is_found_by_its_own_row),
                                       cmocka_unit_test(shapes_are_found_by_their_whole_names)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
