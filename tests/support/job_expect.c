// SPDX-License-Identifier: Apache-2.0
#include "tests/support/job_expect.h"

#include "core/base/error.h"
#include "core/job/job_check.h"
#include "core/job/job_json.h"
#include "core/json/json_read.h"
#include "tests/support/json_edit.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

struct job job_expect(const char *text)
{
    struct error error = {0};
    struct job job;

    if (!job_parse(&job, text, strlen(text), JOB_EXPECT_ROOT, &error)) fail_msg("%s", error.message);
    return job;
}

void job_expect_refused(const char *text, const char *expected)
{
    struct job job = {.priority = 7};
    struct error error = {0};

    if (job_parse(&job, text, strlen(text), JOB_EXPECT_ROOT, &error)) fail_msg("taken, not \"%s\"", expected);
    assert_string_equal(error.message, expected);
    assert_null(job.name);
    assert_int_equal(job.priority, 0);
    assert_false(job_parse(&job, text, strlen(text), JOB_EXPECT_ROOT, NULL));
}

void job_expect_edit_refused(const char *text, const char *path, const char *value, const char *expected)
{
    char *edited = json_edit_set(text, path, value);

    job_expect_refused(edited, expected);
    free(edited);
}

void job_expect_no_inputs(const char *text, const char *expected)
{
    struct cJSON *root = NULL;
    struct job job = job_expect(text);
    struct json_node document;
    struct error error = {0};

    assert_true(json_parse(&root, text, strlen(text), NULL));
    document = json_node_root(root);
    assert_int_equal(job_check_inputs(&job, &document, &error), !expected);
    assert_string_equal(error.message, expected ? expected : "");
    json_delete(root);
    job_finish(&job);
}
