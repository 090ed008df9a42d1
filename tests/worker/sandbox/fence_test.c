// SPDX-License-Identifier: Apache-2.0
#include "worker/sandbox/fence.h"

#include "core/base/error.h"
#include "core/wire/message.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static bool read_line(struct fence *fence, const char *method, const char *params, struct error *error)
{
    char line[1024];
    struct message message = {0};
    enum message_code code;
    bool ok;

    snprintf(line, sizeof line, "{\"jsonrpc\":\"2.0\",\"method\":\"%s\",\"params\":%s}", method, params);
    assert_true(message_decode(&message, line, strlen(line), &code, error));
    ok = fence_read(fence, &message, error);
    message_finish(&message);
    return ok;
}

#define OUTPUT "\"output\":{\"root\":\"/srv/out\",\"folder\":\"a\"}"
#define INPUT "{\"place\":\"p\",\"root\":\"/srv/in\",\"folder\":\"b\",\"path\":\"/srv/in/b/c.raw\"}"

static void all_of_it_is_read(void **state)
{
    struct fence fence;

    assert_true(read_line(&fence, "worker.fence",
                          "{\"inputs\":[" INPUT "]," OUTPUT ",\"closed\":[\"/s\",\"/t\"],\"converter\":true}", NULL));
    assert_int_equal(fence.job.input_count, 1);
    assert_string_equal(fence.job.inputs[0].place, "p");
    assert_string_equal(fence.job.inputs[0].root, "/srv/in");
    assert_string_equal(fence.job.inputs[0].folder, "b");
    assert_string_equal(fence.job.inputs[0].path, "/srv/in/b/c.raw");
    assert_string_equal(fence.job.output_root, "/srv/out");
    assert_string_equal(fence.job.output_folder, "a");
    assert_int_equal(fence.closed.count, 2);
    assert_string_equal(fence.closed.paths[1], "/t");
    assert_true(fence.has_converter);
    fence_finish(&fence);
}

static void other_jobs_are_read(void **state)
{
    struct fence fence;

    assert_true(read_line(&fence, "worker.fence",
                          "{\"inputs\":[]," OUTPUT ",\"others\":[{\"inputs\":[" INPUT
                          "],\"output\":{\"root\":\"/srv/out\","
                          "\"folder\":\"b\"}},{\"inputs\":[]," OUTPUT "}],\"closed\":[],\"converter\":false}",
                          NULL));
    assert_int_equal(fence.other_count, 2);
    assert_string_equal(fence.others[0].inputs[0].path, "/srv/in/b/c.raw");
    assert_string_equal(fence.others[0].output_folder, "b");
    assert_int_equal(fence.others[1].input_count, 0);
    assert_string_equal(fence.others[1].output_folder, "a");
    fence_finish(&fence);
}

static void assert_refused(const char *method, const char *params, const char *words)
{
    struct error error = {0};
    struct fence fence;

    assert_false(read_line(&fence, method, params, &error));
    if (!strstr(error.message, words)) fail_msg("expected \"%s\" in \"%s\"", words, error.message);
    assert_int_equal(fence.job.input_count, 0);
    assert_null(fence.job.output_root);
}

static void what_is_no_fence_is_refused(void **state)
{
    assert_refused("worker.job", "{}", "expected worker.fence, got worker.job");
    assert_refused("worker.fence", "{}", "inputs");
    assert_refused("worker.fence", "{\"inputs\":[]," OUTPUT ",\"closed\":[]}", "converter");
    assert_refused("worker.fence",
                   "{\"inputs\":[]," OUTPUT ",\"others\":[{\"inputs\":[]}],\"closed\":[],\"converter\":false}",
                   "others[0].output");
    assert_refused("worker.fence",
                   "{\"inputs\":[{\"place\":\"p\",\"root\":\"in\",\"folder\":\"\",\"path\":\"/x\"}]," OUTPUT
                   ",\"closed\":[],\"converter\":false}",
                   "an absolute path");
    assert_refused("worker.fence",
                   "{\"inputs\":[],\"output\":{\"root\":\"/o\",\"folder\":\"/etc\"},\"closed\":[],\"converter\":false}",
                   "a relative path");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_of_it_is_read),
        cmocka_unit_test(other_jobs_are_read),
        cmocka_unit_test(what_is_no_fence_is_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
