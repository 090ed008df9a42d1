// Log lines: their contents, and the sink.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/log.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static struct {
    int count;
    enum log_level level;
    struct log_subject subject;
    char line[LOG_LINE_SIZE];
} heard;

static void hear(enum log_level level, const struct log_subject *subject, const char *line)
{
    heard.count++;
    heard.level = level;
    heard.subject = *subject;
    strcpy(heard.line, line);
}

static int start_hearing(void **state)
{
    (void)state;
    memset(&heard, 0, sizeof heard);
    log_set_level(LOG_INFO);
    log_set_sink(hear);
    return 0;
}

static int stop_hearing(void **state)
{
    (void)state;
    log_set_sink(NULL);
    return 0;
}

static void a_sink_hears_level_line_and_subject(void **state)
{
    log_about(LOG_WARN, &(struct log_subject){.job = 7, .frame = -3, .attempt = 2, .worker = 1, .owner = "ann"},
              "%s again", "tried");
    assert_int_equal(heard.level, LOG_WARN);
    assert_string_equal(heard.line, "tried again");
    assert_int_equal(heard.subject.job, 7);
    assert_int_equal(heard.subject.frame, -3);
    assert_int_equal(heard.subject.attempt, 2);
    assert_int_equal(heard.subject.worker, 1);
    assert_string_equal(heard.subject.owner, "ann");
    log_error("nobody's");
    assert_int_equal(heard.subject.job, 0);
    assert_null(heard.subject.owner);
}

static void lines_below_the_level_are_not_said(void **state)
{
    log_debug("quiet");
    log_about(LOG_DEBUG, &(struct log_subject){.job = 1}, "quiet");
    assert_int_equal(heard.count, 0);
    log_set_level(LOG_DEBUG);
    log_debug("loud");
    assert_int_equal(heard.count, 1);
}

static void terminals_get_no_orders(void **state)
{
    log_info("a\033[2Jb\rc\x7f\xc2\x9b"
             "d \xc3\xa9\t\xc2\xb5\n\n");
    assert_string_equal(heard.line, "a?[2Jb?c???d \xc3\xa9\t\xc2\xb5");
    log_info("cut off \xc2");
    assert_string_equal(heard.line, "cut off \xc2");
}

static void long_lines_are_cut(void **state)
{
    static char text[2 * LOG_LINE_SIZE];

    memset(text, 'x', sizeof text - 1);
    log_info("%s", text);
    assert_int_equal(strlen(heard.line), LOG_LINE_SIZE - 1);
}

static void no_text_looks_like_a_line_of_ours(void **state)
{
    char text[4 * LOG_LINE_SIZE], *begin = text;
    FILE *file = tmpfile();
    int kept = dup(STDERR_FILENO);

    log_set_sink(NULL);
    assert_true(dup2(fileno(file), STDERR_FILENO) >= 0);
    log_info("job \"%s\"", "x\n12:00:00.000 error: forged");
    memset(text, '\n', LOG_LINE_SIZE);
    text[LOG_LINE_SIZE - 2] = 'x';
    text[LOG_LINE_SIZE - 1] = '\0';
    log_info("%s", text);
    assert_true(dup2(kept, STDERR_FILENO) >= 0);
    close(kept);
    rewind(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    assert_non_null(strstr(text, " info: job \"x\n\t12:00:00.000 error: forged\"\n"));
    // Two lines start at the margin; all others are indented.
    for (int lines = 0; *begin; begin = strchr(begin, '\n') + 1) {
        if (*begin != '\t') lines++;
        assert_in_range(lines, 1, 2);
        assert_non_null(strchr(begin, '\n'));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_sink_hears_level_line_and_subject, start_hearing, stop_hearing),
        cmocka_unit_test_setup_teardown(lines_below_the_level_are_not_said, start_hearing, stop_hearing),
        cmocka_unit_test_setup_teardown(terminals_get_no_orders, start_hearing, stop_hearing),
        cmocka_unit_test_setup_teardown(long_lines_are_cut, start_hearing, stop_hearing),
        cmocka_unit_test_setup_teardown(no_text_looks_like_a_line_of_ours, start_hearing, stop_hearing),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
