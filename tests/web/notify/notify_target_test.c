// SPDX-License-Identifier: Apache-2.0
#include "web/notify/notify_target.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static void targets_are_read(void **state)
{
    struct notify_targets targets = {0};
    const struct notify_target *target;

    assert_true(notify_targets_add(&targets, "chat url=https://a.org/x?y=z secret=/s private=yes", NULL));
    assert_true(notify_targets_add(&targets, "mail command=/usr/bin/tell --to 'all of them'", NULL));
    target = notify_targets_find(&targets, "chat");
    assert_string_equal(target->url, "https://a.org/x?y=z");
    assert_string_equal(target->secret_file, "/s");
    assert_true(target->may_be_private);
    target = notify_targets_find(&targets, "mail");
    assert_null(target->url);
    assert_string_equal(target->arguments[0], "/usr/bin/tell");
    assert_string_equal(target->arguments[2], "all of them");
    assert_null(target->arguments[3]);
    assert_null(notify_targets_find(&targets, "chats"));
    notify_targets_finish(&targets);
}

static void a_wrong_target_is_told(void **state)
{
    static const char *const wrong[][2] = {
        {"", "expected a name"},
        {"a", "expected url=URL or command=PROGRAM"},
        {"a: url=https://b/", "expected a name"},
        {"a url=ftp://b/", "expected an address like https://HOST/PATH"},
        {"a url=https://b/ secret=c", "expected secret=/FILE or private=yes"},
        {"a url=https://b/ private=maybe", "expected secret=/FILE or private=yes"},
        {"a url=https://b/ size=3", "expected secret=/FILE or private=yes"},
        {"a command=tell", "expected an absolute path"},
        {"known url=https://b/", "the name is there twice"},
    };
    struct notify_targets targets = {0};

    assert_true(notify_targets_add(&targets, "known url=http://a/", NULL));
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        struct error error = {0};

        assert_false(notify_targets_add(&targets, wrong[i][0], &error));
        if (!strstr(error.message, wrong[i][1])) fail_msg("\"%s\": %s", wrong[i][0], error.message);
    }
    assert_int_equal(targets.count, 1);
    notify_targets_finish(&targets);
}

static void make_file(const char *path, const char *text, mode_t mode)
{
    int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);

    assert_true(fd >= 0);
    assert_int_equal(write(fd, text, strlen(text)), strlen(text));
    assert_int_equal(fchmod(fd, mode), 0);
    close(fd);
}

static void a_secret_that_others_can_read_is_none(void **state)
{
    char folder[] = "/tmp/notify_secret.XXXXXX", *path, *secret = NULL;
    struct error error = {0};
    size_t size = 0;

    assert_non_null(mkdtemp(folder));
    path = xasprintf("%s/secret", folder);
    make_file(path, "Jefe\n", 0640);
    if (!notify_secret_load(path, &secret, &size, &error)) fail_msg("%s", error.message);
    assert_int_equal(size, 4);
    assert_string_equal(secret, "Jefe");
    free(secret);
    for (mode_t bit = 1; bit <= 4; bit *= 2) {
        make_file(path, "Jefe", 0600 | bit);
        assert_false(notify_secret_load(path, &secret, &size, &error));
        assert_non_null(strstr(error.message, "expected one that lets only its owner write it"));
    }
    make_file(path, "Jefe", 0620);
    assert_false(notify_secret_load(path, &secret, &size, NULL));
    make_file(path, "", 0600);
    assert_false(notify_secret_load(path, &secret, &size, NULL));
    make_file(path, "\n", 0600);
    assert_false(notify_secret_load(path, &secret, &size, NULL));
    assert_false(notify_secret_load(folder, &secret, &size, NULL));
    unlink(path);
    assert_int_equal(mkfifo(path, 0600), 0);
    assert_false(notify_secret_load(path, &secret, &size, NULL));
    unlink(path);
    assert_false(notify_secret_load(path, &secret, &size, NULL));
    rmdir(folder);
    free(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(targets_are_read),
        cmocka_unit_test(a_wrong_target_is_told),
        cmocka_unit_test(a_secret_that_others_can_read_is_none),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
