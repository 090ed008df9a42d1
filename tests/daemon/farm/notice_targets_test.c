// SPDX-License-Identifier: Apache-2.0
#include "daemon/farm/notice_targets.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void assert_refused(const struct notice_targets *targets, const struct job_notify *notify, const char *message)
{
    struct error error = {0};

    assert_false(notice_targets_check(targets, notify, &error));
    assert_string_equal(error.message, message);
}

static void rules_name_targets_that_are_there(void **state)
{
    struct notice_targets targets = {0};
    struct job_notify notify = {0};

    assert_true(job_notify_parse(&notify, "chat:done", NULL));
    assert_true(job_notify_parse(&notify, "mial:done", NULL));
    assert_true(notice_targets_check(&targets, &notify, NULL)); // nobody knows
    targets.is_known = true;
    assert_refused(&targets, &notify, "notify[0].to: there is no target \"chat\": the farm has none");
    notice_targets_add(&targets, "chat");
    assert_refused(&targets, &notify, "notify[1].to: there is no target \"mial\" in the settings of march-web");
    notice_targets_add(&targets, "mail");
    assert_refused(&targets, &notify, "notify[1].to: there is no target \"mial\", did you mean \"mail\"?");
    notice_targets_add(&targets, "mial");
    assert_true(notice_targets_check(&targets, &notify, NULL));
    job_notify_finish(&notify);
    notice_targets_finish(&targets);
}

static void addresses_are_refused_where_they_are_not_allowed(void **state)
{
    struct notice_targets targets = {.is_known = true};
    struct job_notify notify = {.rules = {{.on = 1, .webhook = xstrdup("https://example.org/")}}, .count = 1};

    assert_refused(&targets, &notify,
                   "notify[0].webhook: jobs of this farm may not name addresses: name a target with \"to\"");
    targets.has_webhooks = true;
    assert_true(notice_targets_check(&targets, &notify, NULL));
    job_notify_finish(&notify);
    notice_targets_finish(&targets);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rules_name_targets_that_are_there),
        cmocka_unit_test(addresses_are_refused_where_they_are_not_allowed),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
