// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/base/file.h"
#include "daemon/settings/options.h"
#include "tests/support/folders.h"
#include "tests/support/temp_folder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

static const struct options_surroundings user = {
    .home = "/home/ann", .current_folder = "/srv", .program_folder = "/opt/bin"};
static const struct options_surroundings root = {
    .home = "/root", .current_folder = "/", .program_folder = "/usr/bin", .is_root = true};

#define PARSE(options, surroundings, ...)                                                                              \
    parse(options, surroundings, (char *[]){(char[]){"marchd"}, __VA_ARGS__, NULL}, NULL)
#define REFUSE(part, ...) refuse(part, (char *[]){(char[]){"marchd"}, __VA_ARGS__, NULL})

static bool parse(struct options *options, const struct options_surroundings *surroundings, char **argv,
                  struct error *error)
{
    int argc = 0;

    while (argv[argc])
        argc++;
    return options_parse(options, argc, argv, surroundings, error);
}

static void refuse(const char *part, char **argv)
{
    struct options options;
    struct error error = {0};

    assert_false(parse(&options, &user, argv, &error));
    if (!strstr(error.message, part)) fail_msg("expected \"%s\" in \"%s\"", part, error.message);
}

static void root_gets_the_system_folders(void **state)
{
    struct options options;

    assert_true(parse(&options, &root, (char *[]){(char[]){"marchd"}, NULL}, NULL));
    assert_string_equal(options.state_folder, "/var/lib/marchd");
    assert_string_equal(options.socket_path, "/run/marchd/marchd.sock");
    assert_string_equal(options.worker_program, "/usr/bin/march-worker");
    assert_int_equal(options.worker_count, 0);
    assert_int_equal(options.thread_count, 1);
    assert_int_equal(options.max_attempts, 3);
    assert_int_equal(options.progress_limit_ms, 120000);
    options_finish(&options);
}

static void a_user_gets_folders_of_their_own(void **state)
{
    struct options_surroundings surroundings = user;
    struct options options;

    assert_true(parse(&options, &surroundings, (char *[]){(char[]){"marchd"}, NULL}, NULL));
    assert_string_equal(options.state_folder, "/home/ann/.local/state/marchd");
    assert_string_equal(options.output_roots.paths[0], "/home/ann/marchd");
    options_finish(&options);
    surroundings.xdg_state_home = "/s";
    surroundings.xdg_runtime_dir = "/run/user/7";
    assert_true(parse(&options, &surroundings, (char *[]){(char[]){"marchd"}, NULL}, NULL));
    assert_string_equal(options.state_folder, "/s/marchd");
    assert_string_equal(options.socket_path, "/run/user/7/marchd.sock");
    options_finish(&options);
}

static void the_command_line_overrides_the_environment(void **state)
{
    struct options_surroundings surroundings = user;
    struct options options;

    surroundings.marchd_socket = "/env.sock";
    assert_true(parse(&options, &surroundings, (char *[]){(char[]){"marchd"}, NULL}, NULL));
    assert_string_equal(options.socket_path, "/env.sock");
    options_finish(&options);
    assert_true(PARSE(&options, &surroundings, (char[]){"--socket"}, (char[]){"/line.sock"}));
    assert_string_equal(options.socket_path, "/line.sock");
    options_finish(&options);
}

static void relative_paths_are_taken_from_the_current_folder(void **state)
{
    struct options options;

    assert_true(PARSE(&options, &user, (char[]){"--output-root=out/"}, (char[]){"--state"}, (char[]){"s"}));
    assert_string_equal(options.output_roots.paths[0], "/srv/out");
    assert_string_equal(options.state_folder, "/srv/s");
    options_finish(&options);
}

static void every_value_is_read(void **state)
{
    struct options options;

    assert_true(PARSE(&options, &user, (char[]){"--workers=7"}, (char[]){"--threads=2"}, (char[]){"--backend=egl"},
                      (char[]){"--max-attempts=5"}, (char[]){"--stop-timeout=1.5"}, (char[]){"--log-level=debug"}));
    assert_int_equal(options.worker_count, 7);
    assert_int_equal(options.thread_count, 2);
    assert_string_equal(options.backend, "egl");
    assert_int_equal(options.max_attempts, 5);
    assert_int_equal(options.stop_timeout_ms, 1500);
    assert_int_equal(options.log_level, LOG_DEBUG);
    options_finish(&options);
}

static void wrong_values_are_named(void **state)
{
    REFUSE("--workers: expected \"auto\", \"none\" or a whole number from 1 to 1024, got \"0\"",
           (char[]){"--workers=0"});
    REFUSE("--threads: expected a whole number", (char[]){"--threads=two"});
    REFUSE("--max-attempts: expected a whole number from 1 to 100, got \"1e3\"", (char[]){"--max-attempts=1e3"});
    REFUSE("--stop-timeout: expected seconds", (char[]){"--stop-timeout=-1"});
    REFUSE("--stop-timeout: expected seconds", (char[]){"--stop-timeout=nan"});
    REFUSE("--backend: expected auto, egl, osmesa or software", (char[]){"--backend=vulkan"});
    REFUSE("--log-level: expected", (char[]){"--log-level=loud"});
    REFUSE("--state: expected a path", (char[]){"--state="});
    REFUSE("--nothing: there is no such option", (char[]){"--nothing"});
    REFUSE("--socket: expected a value", (char[]){"--socket"});
    REFUSE("stray: expected options only", (char[]){"stray"});
}

static void help_and_version_need_nothing_else(void **state)
{
    struct options_surroundings nowhere = {.current_folder = "/", .program_folder = "/"};
    struct options options;

    assert_true(PARSE(&options, &nowhere, (char[]){"--help"}));
    assert_true(options.wants_help);
    options_finish(&options);
    assert_true(PARSE(&options, &nowhere, (char[]){"--version"}));
    assert_true(options.wants_version);
    options_finish(&options);
}

static char *write_config(void **state, const char *text)
{
    char *path = (char *)(uintptr_t)temp_folder_path(state, "marchd.conf");

    assert_true(file_write_atomic(path, text, strlen(text), NULL));
    return path;
}

static void a_file_is_overridden_by_all_else(void **state)
{
    char *path =
        write_config(state, "# a farm\n\n  workers = 7\r\nthreads=3\nsocket = /file.sock\n\tlog-level = debug");
    struct options_surroundings surroundings = user;
    struct options options;

    assert_true(PARSE(&options, &surroundings, (char[]){"--threads"}, (char[]){"5"}, (char[]){"--config"}, path));
    assert_int_equal(options.worker_count, 7);
    assert_int_equal(options.thread_count, 5);
    assert_int_equal(options.log_level, LOG_DEBUG);
    assert_string_equal(options.socket_path, "/file.sock");
    options_finish(&options);
    surroundings.marchd_socket = "/env.sock";
    surroundings.config_path = path;
    surroundings.is_root = true;
    assert_true(parse(&options, &surroundings, (char *[]){(char[]){"marchd"}, NULL}, NULL));
    assert_int_equal(options.thread_count, 3);
    assert_string_equal(options.socket_path, "/env.sock");
    options_finish(&options);
}

static void only_a_named_file_must_exist(void **state)
{
    struct options_surroundings surroundings = root;
    struct options options;

    surroundings.config_path = "/no/such/file";
    assert_true(parse(&options, &surroundings, (char *[]){(char[]){"marchd"}, NULL}, NULL));
    options_finish(&options);
    REFUSE("/no/such/file", (char[]){"--config"}, (char[]){"/no/such/file"});
}

static void errors_of_a_file_name_the_line(void **state)
{
    static const char *const cases[][2] = {
        {"workers = 2\nwokers = 3\n", "marchd.conf:2: wokers: there is no such setting, did you mean workers?"},
        {"\n\nworkers\n", "marchd.conf:3: expected KEY = VALUE, got \"workers\""},
        {"workers = many\n", "marchd.conf:1: --workers: expected"},
        {"state = here\n", "marchd.conf:1: --state: expected an absolute path"},
        {"state =\n", "marchd.conf:1: --state: expected a path"},
        {"config = /a\n", "marchd.conf:1: config: there is no such setting"},
        {"help = 1\n", "marchd.conf:1: help: there is no such setting"},
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        REFUSE(cases[i][1], (char[]){"--config"}, write_config(state, cases[i][0]));
}

static void keep_mistake(void *list, const char *mistake)
{
    path_list_add(list, strdup(mistake));
}

static void a_mistake_of_a_file_hides_no_other(void **state)
{
    char *path = write_config(state, "workers = many\nthreads = 2\nlog-level = loud\n\nno such line\n");
    char *argv[] = {(char[]){"marchd"}, (char[]){"--config"}, path, (char[]){"--check-config"}, NULL};
    struct path_list found = {0};
    struct options options;
    struct error error;

    assert_false(options_read(&options, 4, argv, &user, keep_mistake, &found));
    assert_int_equal(found.count, 3);
    assert_non_null(strstr(found.paths[0], "marchd.conf:1: --workers: expected"));
    assert_non_null(strstr(found.paths[1], "marchd.conf:3: --log-level: expected"));
    assert_non_null(strstr(found.paths[2], "marchd.conf:5: expected KEY = VALUE"));
    assert_null(options.config_file);
    path_list_finish(&found);
    // Whoever wants one sentence is told of the others.
    assert_false(options_parse(&options, 4, argv, &user, &error));
    assert_non_null(strstr(error.message, "marchd.conf:1: --workers"));
    assert_non_null(strstr(error.message, "(and 2 more: marchd --check-config)"));
}

static void a_check_is_an_option_and_no_setting(void **state)
{
    char *path = write_config(state, "threads = 2\n");
    struct options options;

    assert_true(PARSE(&options, &user, (char[]){"--check-config"}, (char[]){"--config"}, path));
    assert_true(options.wants_check);
    assert_string_equal(options.config_file, path);
    options_finish(&options);
    REFUSE("marchd.conf:1: check-config: there is no such setting", (char[]){"--config"},
           write_config(state, "check-config = yes\n"));
}

static void a_user_has_a_file_of_their_own(void **state)
{
    struct options_surroundings surroundings = user;
    struct options options;

    write_config(state, "threads = 3\n");
    assert_int_equal(mkdir(temp_folder_path(state, ".config"), 0700), 0);
    assert_true(file_write_atomic(temp_folder_path(state, ".config/marchd.conf"), "threads = 5\n", 12, NULL));
    surroundings.home = *state;
    surroundings.xdg_config_home = *state;
    assert_true(parse(&options, &surroundings, (char *[]){(char[]){"marchd"}, NULL}, NULL));
    assert_int_equal(options.thread_count, 3);
    options_finish(&options);
    // A relative folder does not count, as the XDG Base Directory Specification has it.
    surroundings.xdg_config_home = "here";
    assert_true(parse(&options, &surroundings, (char *[]){(char[]){"marchd"}, NULL}, NULL));
    assert_int_equal(options.thread_count, 5);
    options_finish(&options);
    // The system's daemon reads the system's file alone.
    assert_true(PARSE(&options, &surroundings, (char[]){"--system"}));
    assert_int_equal(options.thread_count, 1);
    assert_null(options.config_file);
    options_finish(&options);
}

// Uncomments each setting, and counts them.
static size_t uncomment(char *text)
{
    size_t count = 0;

    for (char *line = text; line; line = strchr(line, '\n')) {
        line += *line == '\n';
        if (line[0] != '#' || line[1] == ' ' || strncmp(line, "#shader-dir", 11) == 0 ||
            strncmp(line, "#user-weight", 12) == 0 || strncmp(line, "#pool", 5) == 0 ||
            strncmp(line, "#notify", 7) == 0 || strncmp(line, "#launch-socket", 14) == 0)
            continue;
        line[0] = ' ';
        count++;
    }
    return count;
}

static void assert_same_paths(const struct path_list *told, const struct path_list *held)
{
    assert_int_equal(told->count, held->count);
    for (size_t i = 0; i < told->count; i++)
        assert_string_equal(told->paths[i], held->paths[i]);
}

static void the_shipped_file_has_the_defaults(void **state)
{
    struct options told, held;
    char *text, *path;

    assert_true(file_read_text(PROJECT_ROOT "/deploy/marchd.conf", 1 << 16, &text, NULL, NULL));
    path = write_config(state, text);
    assert_true(PARSE(&told, &root, (char[]){"--config"}, path));
    options_finish(&told);
    assert_int_equal(uncomment(text), 27);
    path = write_config(state, text);
    assert_true(PARSE(&told, &user, (char[]){"--config"}, path));
    assert_true(parse(&held, &root, (char *[]){(char[]){"marchd"}, NULL}, NULL));
    assert_string_equal(told.state_folder, held.state_folder);
    assert_string_equal(told.socket_path, held.socket_path);
    assert_string_equal(told.worker_program, held.worker_program);
    assert_string_equal(told.backend, held.backend);
    assert_int_equal(told.worker_count, held.worker_count);
    assert_int_equal(told.thread_count, held.thread_count);
    assert_int_equal(told.max_attempts, held.max_attempts);
    assert_int_equal(told.progress_limit_ms, held.progress_limit_ms);
    assert_int_equal(told.stop_timeout_ms, held.stop_timeout_ms);
    assert_int_equal(told.log_level, held.log_level);
    assert_same_paths(&told.output_roots, &held.output_roots);
    assert_same_paths(&told.input_roots, &held.input_roots);
    assert_string_equal(told.admin_group, held.admin_group);
    assert_string_equal(told.web_user, held.web_user);
    assert_int_equal(told.user_jobs, held.user_jobs);
    assert_int_equal(told.user_frames, held.user_frames);
    assert_int_equal(told.user_pixels, held.user_pixels);
    assert_int_equal(told.user_disk_bytes, held.user_disk_bytes);
    assert_int_equal(told.keep_jobs, held.keep_jobs);
    assert_int_equal(told.keep_ms, held.keep_ms);
    assert_int_equal(told.keep_bytes, held.keep_bytes);
    assert_int_equal(told.frame_limit_ms, held.frame_limit_ms);
    assert_int_equal(told.half_life_ms, held.half_life_ms);
    assert_int_equal(told.longest_wait_ms, held.longest_wait_ms);
    assert_int_equal(told.worker_memory_bytes, held.worker_memory_bytes);
    assert_int_equal(told.has_sandbox, held.has_sandbox);
    options_finish(&held);
    options_finish(&told);
    free(text);
}

static void amounts_have_suffixes(void **state)
{
    struct options options;

    assert_true(PARSE(&options, &user, (char[]){"--user-jobs=20"}, (char[]){"--user-frames=3K"},
                      (char[]){"--user-pixels=500G"}, (char[]){"--user-disk=2T"}, (char[]){"--worker-memory=4G"},
                      (char[]){"--sandbox=no"}, (char[]){"--admin-group=wheel"}));
    assert_int_equal(options.user_jobs, 20);
    assert_int_equal(options.user_frames, 3000);
    assert_int_equal(options.user_pixels, 500 * INT64_C(1000000000));
    assert_int_equal(options.user_disk_bytes, INT64_C(2) << 40);
    assert_int_equal(options.worker_memory_bytes, INT64_C(4) << 30);
    assert_false(options.has_sandbox);
    assert_string_equal(options.admin_group, "wheel");
    assert_string_equal(options.web_user, "marchd-web");
    options_finish(&options);
    assert_true(PARSE(&options, &user, (char[]){"--web-user=www"}));
    assert_string_equal(options.web_user, "www");
    options_finish(&options);
    assert_true(PARSE(&options, &user, (char[]){"--web-user="}));
    assert_string_equal(options.web_user, "");
    options_finish(&options);
    assert_true(PARSE(&options, &user, (char[]){"--user-jobs=none"}, (char[]){"--worker-memory=none"}));
    assert_int_equal(options.user_jobs, 0);
    assert_int_equal(options.worker_memory_bytes, -1);
    options_finish(&options);
    assert_true(
        PARSE(&options, &user, (char[]){"--keep-jobs=2K"}, (char[]){"--keep-days=0.5"}, (char[]){"--keep-bytes=3G"}));
    assert_int_equal(options.keep_jobs, 2000);
    assert_int_equal(options.keep_ms, 12 * 3600 * 1000);
    assert_int_equal(options.keep_bytes, INT64_C(3) << 30);
    options_finish(&options);
    REFUSE("--keep-jobs: expected \"none\"", (char[]){"--keep-jobs=0"});
    REFUSE("--keep-days: expected \"none\" or a number of days", (char[]){"--keep-days=0"});
    REFUSE("--keep-days: expected \"none\" or a number of days", (char[]){"--keep-days=30d"});
    REFUSE("--keep-days: expected \"none\" or a number of days", (char[]){"--keep-days=nan"});
    REFUSE("--keep-bytes: expected \"none\"", (char[]){"--keep-bytes=-1"});
    REFUSE("--user-jobs: expected \"none\"", (char[]){"--user-jobs=0"});
    REFUSE("--user-disk: expected \"none\"", (char[]){"--user-disk=2TB"});
    REFUSE("--user-disk: expected \"none\"", (char[]){"--user-disk=9999999999T"});
    REFUSE("--user-pixels: expected \"none\"", (char[]){"--user-pixels=-1"});
    REFUSE("--worker-memory: expected", (char[]){"--worker-memory=all"});
    REFUSE("--sandbox: expected yes or no", (char[]){"--sandbox=maybe"});
    REFUSE("--admin-group: expected", (char[]){"--admin-group="});
}

static void weights_add_up_within_one_source(void **state)
{
    char *path = write_config(state, "user-weight = ann=2\nuser-weight = 1003=0.5\nhalf-life = 60\n");
    struct options options;

    assert_true(PARSE(&options, &user, (char[]){"--config"}, path, (char[]){"--longest-wait=7"}));
    assert_true(user_weights_find(&options.user_weights, 1000, "ann") == 2);
    assert_true(user_weights_find(&options.user_weights, 1003, "ben") == 0.5);
    assert_true(user_weights_find(&options.user_weights, 1004, "carl") == 1);
    assert_int_equal(options.half_life_ms, 60000);
    assert_int_equal(options.longest_wait_ms, 7000);
    options_finish(&options);
    assert_true(PARSE(&options, &user, (char[]){"--config"}, path, (char[]){"--user-weight=carl=3"},
                      (char[]){"--user-weight=carl=4"}));
    assert_true(user_weights_find(&options.user_weights, 1000, "ann") == 1);
    assert_true(user_weights_find(&options.user_weights, 1004, "carl") == 4);
    options_finish(&options);
    REFUSE("--user-weight: expected NAME=NUMBER from 0.01 to 100, as in anna=2, got \"ann\"",
           (char[]){"--user-weight=ann"});
    REFUSE("--user-weight: expected", (char[]){"--user-weight=ann=0"});
    REFUSE("--user-weight: expected", (char[]){"--user-weight==2"});
}

static void rules_of_notices_add_up_within_one_source(void **state)
{
    char *path = write_config(state, "notify = chat:done\nnotify = mail:failed,waiting\n");
    struct options options;

    assert_true(PARSE(&options, &user, (char[]){"--config"}, path));
    assert_int_equal(options.notify.count, 2);
    assert_string_equal(options.notify.rules[1].to, "mail");
    options_finish(&options);
    assert_true(PARSE(&options, &user, (char[]){"--config"}, path, (char[]){"--notify=chat:missed"}));
    assert_int_equal(options.notify.count, 1);
    assert_int_equal(options.notify.rules[0].on, 1U << JOB_NOTIFY_MISSED);
    options_finish(&options);
    REFUSE("--notify: expected NAME:EVENT,EVENT", (char[]){"--notify=chat"});
}

static void roots_add_up_within_one_source(void **state)
{
    char *path = write_config(state, "output-root = /file/a\noutput-root = /file/b\ninput-root = /file/in\n");
    struct options options;

    assert_true(PARSE(&options, &user, (char[]){"--config"}, path, (char[]){"--input-root=in"},
                      (char[]){"--input-root=/line/"}));
    assert_int_equal(options.output_roots.count, 2);
    assert_string_equal(options.output_roots.paths[0], "/file/a");
    assert_string_equal(options.output_roots.paths[1], "/file/b");
    assert_int_equal(options.input_roots.count, 2);
    assert_string_equal(options.input_roots.paths[0], "/srv/in");
    assert_string_equal(options.input_roots.paths[1], "/line");
    options_finish(&options);
}

static void a_system_daemon_need_not_be_root(void **state)
{
    char *path = write_config(state, "workers = 3\n");
    struct options_surroundings surroundings = user;
    struct options options;

    surroundings.config_path = path;
    assert_true(PARSE(&options, &surroundings, (char[]){"--system"}));
    assert_string_equal(options.state_folder, "/var/lib/marchd");
    assert_string_equal(options.socket_path, "/run/marchd/marchd.sock");
    assert_string_equal(options.output_roots.paths[0], "/srv/marchd");
    assert_int_equal(options.worker_count, 3);
    options_finish(&options);
    // The daemon of a user does not read the system's file.
    assert_true(parse(&options, &surroundings, (char *[]){(char[]){"marchd"}, NULL}, NULL));
    assert_int_equal(options.worker_count, 0);
    assert_string_equal(options.input_roots.paths[0], "/");
    options_finish(&options);
}

static void without_a_home_the_folders_must_be_given(void **state)
{
    struct options_surroundings nowhere = {.current_folder = "/", .program_folder = "/"};
    struct options options;
    struct error error;

    assert_false(parse(&options, &nowhere, (char *[]){(char[]){"marchd"}, NULL}, &error));
    assert_non_null(strstr(error.message, "--state"));
    assert_true(PARSE(&options, &nowhere, (char[]){"--state=/s"}, (char[]){"--output-root=/o"}));
    assert_string_equal(options.socket_path, "/s/marchd.sock");
    options_finish(&options);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(root_gets_the_system_folders),
        cmocka_unit_test(a_user_gets_folders_of_their_own),
        cmocka_unit_test(the_command_line_overrides_the_environment),
        cmocka_unit_test(relative_paths_are_taken_from_the_current_folder),
        cmocka_unit_test(every_value_is_read),
        cmocka_unit_test(wrong_values_are_named),
        cmocka_unit_test(help_and_version_need_nothing_else),
        cmocka_unit_test_setup_teardown(a_file_is_overridden_by_all_else, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test(only_a_named_file_must_exist),
        cmocka_unit_test_setup_teardown(errors_of_a_file_name_the_line, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_mistake_of_a_file_hides_no_other, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_check_is_an_option_and_no_setting, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_user_has_a_file_of_their_own, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(the_shipped_file_has_the_defaults, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test(amounts_have_suffixes),
        cmocka_unit_test_setup_teardown(weights_add_up_within_one_source, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(rules_of_notices_add_up_within_one_source, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(roots_add_up_within_one_source, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_system_daemon_need_not_be_root, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test(without_a_home_the_folders_must_be_given),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
