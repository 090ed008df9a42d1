// SPDX-License-Identifier: Apache-2.0
#include "cli/job/job_notify_set.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void assert_set(const char *document, const char *rule, const char *expected)
{
    char *text = xstrdup(document);
    struct error error = {0};

    if (!job_notify_set(&text, rule, &error)) fail_msg("%s", error.message);
    assert_string_equal(text, expected);
    free(text);
}

static void a_rule_joins_those_of_the_job(void **state)
{
    assert_set("{\"name\":\"a\"}", "chat:failed,done",
               "{\"name\":\"a\",\"notify\":[{\"on\":[\"done\",\"failed\"],\"to\":\"chat\"}]}");
    assert_set("{\"notify\":[]}", "chat:done", "{\"notify\":[{\"on\":[\"done\"],\"to\":\"chat\"}]}");
    assert_set("{\"notify\":[{\"on\":[\"done\"],\"to\":\"mail\"}]}", "chat:missed",
               "{\"notify\":[{\"on\":[\"done\"],\"to\":\"mail\"},{\"on\":[\"missed\"],\"to\":\"chat\"}]}");
}

static void a_wrong_rule_leaves_the_document(void **state)
{
    char *text = xstrdup("{}");
    struct error error = {0};

    assert_false(job_notify_set(&text, "chat", &error));
    assert_non_null(strstr(error.message, "--notify: expected NAME:EVENT,EVENT"));
    assert_string_equal(text, "{}");
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_rule_joins_those_of_the_job),
        cmocka_unit_test(a_wrong_rule_leaves_the_document),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
