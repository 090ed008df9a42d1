// Settings that are applied when they are read again, and settings that need a restart.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "daemon/settings/options.h"
#include "daemon/settings/reload.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const struct options_surroundings user = {
    .home = "/home/ann", .current_folder = "/srv", .program_folder = "/opt/bin"};

// Parses the given arguments, up to NULL; the other options have their defaults.
static struct options read_options(const char *const *given)
{
    char *argv[16] = {(char[]){"marchd"}};
    struct options options;
    int argc = 1;

    for (; *given; given++)
        argv[argc++] = xstrdup(*given);
    assert_true(options_parse(&options, argc, argv, &user, NULL));
    while (argc > 1)
        free(argv[--argc]);
    return options;
}

#define OPTIONS(...) read_options((const char *const[]){__VA_ARGS__, NULL})

static void a_setting_that_may_change_is_applied_and_named(void **state)
{
    struct options held = OPTIONS("--log-level=info"),
                   fresh = OPTIONS("--log-level=debug", "--progress-limit=9", "--frame-limit=8", "--stop-timeout=4",
                                   "--max-attempts=7", "--admin-group=wheel", "--web-user=www", "--worker-memory=none",
                                   "--half-life=5", "--user-weight=ann=2", "--notify=chat:done"),
                   limits = OPTIONS("--user-jobs=1", "--user-frames=2", "--user-pixels=3", "--user-disk=4",
                                    "--keep-jobs=5", "--keep-days=6", "--keep-bytes=7", "--output-root=/a",
                                    "--output-root=/b", "--input-root=/c");
    struct reload_changes changes;

    reload_take(&held, &fresh, &changes);
    assert_string_equal(changes.waiting, "");
    assert_string_equal(
        changes.applied,
        "admin-group, web-user, max-attempts, stop-timeout, progress-limit, frame-limit, user-weight, notify, "
        "half-life, worker-memory, log-level");
    assert_int_equal(held.log_level, LOG_DEBUG);
    assert_int_equal(held.progress_limit_ms, 9000);
    assert_int_equal(held.frame_limit_ms, 8000);
    assert_int_equal(held.stop_timeout_ms, 4000);
    assert_int_equal(held.max_attempts, 7);
    assert_int_equal(held.worker_memory_bytes, -1);
    assert_string_equal(held.admin_group, "wheel");
    assert_string_equal(held.web_user, "www");
    assert_int_equal(held.half_life_ms, 5000);
    assert_true(user_weights_find(&held.user_weights, 1000, "ann") == 2);
    reload_take(&held, &limits, &changes);
    assert_int_equal(held.user_jobs, 1);
    assert_int_equal(held.user_frames, 2);
    assert_int_equal(held.user_pixels, 3);
    assert_int_equal(held.user_disk_bytes, 4);
    assert_int_equal(held.keep_jobs, 5);
    assert_int_equal(held.keep_ms, INT64_C(6) * 24 * 3600 * 1000);
    assert_int_equal(held.keep_bytes, 7);
    assert_int_equal(held.output_roots.count, 2);
    assert_string_equal(held.output_roots.paths[1], "/b");
    assert_string_equal(held.input_roots.paths[0], "/c");
    // A setting removed from the file gets its default again.
    assert_int_equal(held.log_level, LOG_INFO);
    assert_string_equal(held.admin_group, "marchd-admin");
    assert_int_equal(held.user_weights.count, 0);
    options_finish(&limits);
    options_finish(&fresh);
    options_finish(&held);
}

static void a_setting_that_needs_a_restart_is_named_and_kept(void **state)
{
    struct options held = OPTIONS("--workers=1", "--shader-dir=/s"),
                   fresh = OPTIONS("--workers=2", "--threads=3", "--state=/x", "--socket=/y", "--backend=egl",
                                   "--worker-program=/w", "--launch-socket=/l", "--sandbox=no");
    struct reload_changes changes;

    reload_take(&held, &fresh, &changes);
    assert_string_equal(changes.applied, "");
    assert_string_equal(changes.waiting,
                        "state, socket, workers, threads, backend, worker-program, shader-dir, launch-socket, sandbox");
    assert_int_equal(held.worker_count, 1);
    assert_int_equal(held.thread_count, 1);
    assert_true(held.has_sandbox);
    assert_string_equal(held.backend, "auto");
    assert_string_equal(held.shader_folder, "/s");
    assert_string_equal(held.worker_program, "/opt/bin/march-worker");
    assert_string_equal(held.state_folder, "/home/ann/.local/state/marchd");
    options_finish(&fresh);
    options_finish(&held);
}

static void the_same_settings_change_nothing(void **state)
{
    struct options held = OPTIONS("--input-root=/c", "--user-disk=4"),
                   fresh = OPTIONS("--input-root=/c", "--user-disk=4");
    struct reload_changes changes;

    reload_take(&held, &fresh, &changes);
    assert_string_equal(changes.applied, "");
    assert_string_equal(changes.waiting, "");
    options_finish(&fresh);
    options_finish(&held);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_setting_that_may_change_is_applied_and_named),
        cmocka_unit_test(a_setting_that_needs_a_restart_is_named_and_kept),
        cmocka_unit_test(the_same_settings_change_nothing),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
