// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_notify.h"

#include "core/base/error.h"
#include "core/json/json_read.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum {
    DONE = 1U << JOB_NOTIFY_DONE,
    FAILED = 1U << JOB_NOTIFY_FAILED,
    WAITING = 1U << JOB_NOTIFY_WAITING,
    MISSED = 1U << JOB_NOTIFY_MISSED
};

static bool read(struct job_notify *notify, const char *text, struct error *error)
{
    struct cJSON *root;
    struct json_node document;
    bool ok;

    assert_true(json_parse(&root, text, strlen(text), NULL));
    document = json_node_root(root);
    *notify = (struct job_notify){0};
    ok = job_notify_from_json(notify, &document, error);
    json_delete(root);
    return ok;
}

static void rules_are_read(void **state)
{
    struct job_notify notify;

    assert_true(read(&notify,
                     "{\"notify\":[{\"on\":[\"done\",\"missed\"],\"to\":\"chat\"},"
                     "{\"on\":[\"failed\",\"waiting\"],\"webhook\":\"https://example.org/a?b=@c\"}]}",
                     NULL));
    assert_int_equal(notify.count, 2);
    assert_int_equal(notify.rules[0].on, DONE | MISSED);
    assert_string_equal(notify.rules[0].to, "chat");
    assert_null(notify.rules[0].webhook);
    assert_int_equal(notify.rules[1].on, FAILED | WAITING);
    assert_null(notify.rules[1].to);
    assert_string_equal(notify.rules[1].webhook, "https://example.org/a?b=@c");
    job_notify_finish(&notify);
    assert_int_equal(notify.count, 0);
    assert_true(read(&notify, "{}", NULL));
    assert_int_equal(notify.count, 0);
    job_notify_finish(&notify);
}

static void a_wrong_rule_is_told_with_its_place(void **state)
{
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"{\"notify\":{}}", "notify: expected an array"},
        {"{\"notify\":[{\"on\":[\"done\"]}]}", "notify[0]: expected one of \"to\" and \"webhook\""},
        {"{\"notify\":[{\"on\":[\"done\"],\"to\":\"a\",\"webhook\":\"https://a\"}]}", "notify[0]: expected one of"},
        {"{\"notify\":[{\"to\":\"a\"}]}", "notify[0].on: "},
        {"{\"notify\":[{\"on\":[],\"to\":\"a\"}]}", "notify[0].on: "},
        {"{\"notify\":[{\"on\":[\"ready\"],\"to\":\"a\"}]}", "notify[0].on[0]: "},
        {"{\"notify\":[{\"on\":[\"done\",\"done\"],\"to\":\"a\"}]}", "notify[0].on[1]: \"done\" is there twice"},
        {"{\"notify\":[{\"on\":[\"done\"],\"to\":\"-a\"}]}", "notify[0].to: expected a target's name"},
        {"{\"notify\":[{\"on\":[\"done\"],\"to\":\"a:b\"}]}", "notify[0].to: expected a target's name"},
        {"{\"notify\":[{\"on\":[\"done\"],\"webhook\":\"ftp://a/b\"}]}", "notify[0].webhook: expected an address"},
        {"{\"notify\":[{\"on\":[\"done\"],\"webhook\":\"http://me:pw@a/b\"}]}", "notify[0].webhook: expected an"},
        {"{\"notify\":[{\"on\":[\"done\"],\"webhook\":\"http://a/b c\"}]}", "notify[0].webhook: expected an"},
        {"{\"notify\":[{\"on\":[\"done\"],\"webhook\":\"http://\"}]}", "notify[0].webhook: expected an"},
        {"{\"notify\":[{\"on\":[\"done\"],\"to\":\"a\",\"for\":1}]}", "notify[0]: unknown key \"for\""},
    };

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct job_notify notify;
        struct error error = {0};

        assert_false(read(&notify, cases[i].text, &error));
        if (!strstr(error.message, cases[i].message)) fail_msg("%s: \"%s\"", cases[i].text, error.message);
        job_notify_finish(&notify);
    }
}

static void rules_have_a_limit(void **state)
{
    struct job_notify notify = {0};
    char text[1024] = "{\"notify\":[";

    for (int i = 0; i <= JOB_NOTIFY_LIMIT; i++)
        strcat(text, i == 0 ? "{\"on\":[\"done\"],\"to\":\"a\"}" : ",{\"on\":[\"done\"],\"to\":\"a\"}");
    strcat(text, "]}");
    assert_false(read(&notify, text, NULL));
    job_notify_finish(&notify);
    for (int i = 0; i < JOB_NOTIFY_LIMIT; i++)
        assert_true(job_notify_parse(&notify, "a:done", NULL));
    assert_false(job_notify_parse(&notify, "a:done", NULL));
    job_notify_finish(&notify);
}

static void settings_name_rules_in_one_word(void **state)
{
    static const char *const wrong[] = {"chat", "chat:", ":done", "chat:done,", "chat:ready", "a b:done", ""};
    struct job_notify notify = {0};
    struct error error = {0};

    assert_true(job_notify_parse(&notify, "chat:done,failed", NULL));
    assert_true(job_notify_parse(&notify, "night-shift:waiting", NULL));
    assert_int_equal(notify.count, 2);
    assert_string_equal(notify.rules[0].to, "chat");
    assert_int_equal(notify.rules[0].on, DONE | FAILED);
    assert_int_equal(notify.rules[1].on, WAITING);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        assert_false(job_notify_parse(&notify, wrong[i], &error));
        assert_non_null(strstr(error.message, "expected NAME:EVENT,EVENT"));
    }
    assert_int_equal(notify.count, 2);
    job_notify_finish(&notify);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rules_are_read),
        cmocka_unit_test(a_wrong_rule_is_told_with_its_place),
        cmocka_unit_test(rules_have_a_limit),
        cmocka_unit_test(settings_name_rules_in_one_word),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
