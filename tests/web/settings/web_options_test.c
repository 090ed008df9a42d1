// SPDX-License-Identifier: Apache-2.0
#include "web/settings/web_options.h"

#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static const struct web_surroundings ann = {.home = "/home/ann",
                                            .xdg_runtime_dir = "/run/user/1000",
                                            .current_folder = "/current",
                                            .program_folder = "/usr/bin",
                                            .data_folder = "/usr/share"};

struct mistakes {
    char text[4096];
    int count;
};

static void on_mistake(void *user, const char *mistake)
{
    struct mistakes *mistakes = user;

    strncat(mistakes->text, mistake, sizeof mistakes->text - strlen(mistakes->text) - 2);
    strcat(mistakes->text, "\n");
    mistakes->count++;
}

// `line`: options, divided by blanks.
static bool read_options(struct web_options *options, struct mistakes *mistakes,
                         const struct web_surroundings *surroundings, const char *line)
{
    char text[1024], *rest = text, *argv[16] = {(char *)"march-web"}, *word;
    int argc = 1;

    strcpy(text, line);
    while ((word = strsep(&rest, " ")))
        if (*word) argv[argc++] = word;
    *mistakes = (struct mistakes){0};
    return web_options_read(options, argc, argv, surroundings, on_mistake, mistakes);
}

// Writes a file and puts its path in place of the X's.
static void write_file(char *path, const char *text)
{
    int fd = mkstemp(path);

    assert_int_equal(write(fd, text, strlen(text)), strlen(text));
    close(fd);
}

static void without_options_it_listens_on_this_machine_alone(void **state)
{
    struct mistakes mistakes;
    struct web_options options;

    (void)state;
    assert_true(read_options(&options, &mistakes, &ann, ""));
    assert_string_equal(options.listen, "127.0.0.1:8470");
    assert_string_equal(options.socket_path, "/run/user/1000/marchd.sock");
    assert_string_equal(options.page_folder, "/usr/share/marchd/page");
    assert_string_equal(options.document_folder, "/usr/share/marchd");
    assert_int_equal(options.origin_count, 0);
    assert_int_equal(options.buffer_bytes, 256 * 1024 * 1024);
    assert_int_equal(options.send_time_ms, 300 * 1000);
    web_options_finish(&options);
    assert_true(read_options(&options, &mistakes, &ann, "--system"));
    assert_string_equal(options.socket_path, "/run/marchd/marchd.sock");
    web_options_finish(&options);
}

static void the_line_goes_before_the_environment_and_the_file(void **state)
{
    struct web_surroundings surroundings = ann;
    struct mistakes mistakes;
    struct web_options options;
    char path[] = "/tmp/web_options_test.XXXXXX", line[256];

    (void)state;
    write_file(path, "# a comment\nsocket = /file.sock\nlisten = 127.0.0.1:1\norigin = https://a\norigin = https://b\n"
                     "connections = 7\n");
    surroundings.marchd_socket = "/environment.sock";
    snprintf(line, sizeof line, "--config %s --listen 127.0.0.1:2 --page-dir page/", path);
    assert_true(read_options(&options, &mistakes, &surroundings, line));
    assert_string_equal(options.socket_path, "/environment.sock");
    assert_string_equal(options.listen, "127.0.0.1:2");
    assert_string_equal(options.page_folder, "/current/page");
    assert_int_equal(options.connection_limit, 7);
    assert_int_equal(options.origin_count, 2);
    web_options_finish(&options);
    snprintf(line, sizeof line, "--config %s --origin https://c", path);
    assert_true(read_options(&options, &mistakes, &surroundings, line));
    assert_int_equal(options.origin_count, 1);
    assert_string_equal(options.origins[0], "https://c");
    web_options_finish(&options);
    unlink(path);
}

static void each_mistake_of_a_file_is_told_with_its_line(void **state)
{
    struct mistakes mistakes;
    struct web_options options;
    char path[] = "/tmp/web_options_test.XXXXXX", line[256];

    (void)state;
    write_file(path, "socket = relative\nno setting\nlistens = x\nconnections = 0\nlog-level = loud\n");
    snprintf(line, sizeof line, "--config %s", path);
    assert_false(read_options(&options, &mistakes, &ann, line));
    assert_int_equal(mistakes.count, 5);
    assert_non_null(strstr(mistakes.text, ":1: --socket: expected an absolute path, got \"relative\""));
    assert_non_null(strstr(mistakes.text, ":2: expected KEY = VALUE"));
    assert_non_null(strstr(mistakes.text, ":3: listens: there is no such setting, did you mean listen?"));
    assert_non_null(strstr(mistakes.text, ":4: --connections: expected a whole number from 1 to"));
    assert_non_null(strstr(mistakes.text, ":5: --log-level: expected debug, info, warning or error"));
    unlink(path);
}

static void wrong_words_of_the_command_line_are_refused(void **state)
{
    static const char *const lines[] = {"--nothing", "--listen", "operand", "--config /nowhere/march-web.conf"};
    struct mistakes mistakes;
    struct web_options options;

    (void)state;
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        assert_false(read_options(&options, &mistakes, &ann, lines[i]));
        assert_int_equal(mistakes.count, 1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_options_it_listens_on_this_machine_alone),
        cmocka_unit_test(the_line_goes_before_the_environment_and_the_file),
        cmocka_unit_test(each_mistake_of_a_file_is_told_with_its_line),
        cmocka_unit_test(wrong_words_of_the_command_line_are_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
