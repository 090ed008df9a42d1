// SPDX-License-Identifier: Apache-2.0
#include "cli/command/completion.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void write_ids(FILE *out, const char *verb)
{
    fprintf(out, "7\t%s\n", verb);
}

// The first column of the completions, a blank after each.
static void assert_offered(const char *expected, const char *const words[], size_t count)
{
    char *text = NULL, offered[4096] = "";
    size_t length;
    FILE *out = open_memstream(&text, &length);

    completion_write(out, words, count, write_ids);
    fclose(out);
    for (char *rest = text, *line; (line = strsep(&rest, "\n")) && *line;) {
        line[strcspn(line, "\t")] = '\0';
        strcat(strcat(offered, line), " ");
    }
    free(text);
    assert_string_equal(offered, expected);
}

#define WORDS(...) (const char *const[]){__VA_ARGS__}, sizeof((const char *const[]){__VA_ARGS__}) / sizeof(char *)

static void verbs_come_first(void **state)
{
    assert_offered("watch wait workers web ", WORDS("w"));
    assert_offered("", WORDS("nonsense", ""));
}

static void options_are_those_of_the_verb(void **state)
{
    assert_offered("--wait --watch ", WORDS("submit", "job.json", "--wa"));
    assert_offered("--state ", WORDS("frames", "--st"));
    assert_offered("", WORDS("show", "--st"));
    assert_offered(":json ", WORDS("validate", "--", "--se"));
}

static void values_are_those_of_the_option(void **state)
{
    assert_offered("paused ", WORDS("list", "--state", "pa"));
    assert_offered("skipped ", WORDS("frames", "7", "--state", "sk"));
    assert_offered("failed,skipped ", WORDS("frames", "7", "--state", "failed,sk"));
    assert_offered("--state=failed,skipped ", WORDS("frames", "--state=failed,sk"));
    assert_offered("auto egl osmesa software ", WORDS("render", "--backend", "="));
    assert_offered("admin ", WORDS("token", "create", "--scope", "ad"));
    assert_offered("egl ", WORDS("render", "--backend", "=", "e"));
    assert_offered("gauss ", WORDS("chart", "--methods", "g"));
    assert_offered(":files ", WORDS("preview", "--out", "x"));
    assert_offered(":folders ", WORDS("explain", "--shader-dir", ""));
    assert_offered("", WORDS("submit", "--priority", ""));
}

static void operands_are_what_the_verb_takes(void **state)
{
    assert_offered("7 ", WORDS("wait", "3", ""));
    assert_offered("7 ", WORDS("prio", "--socket", "/s", ""));
    assert_offered("", WORDS("prio", "7", ""));
    assert_offered("", WORDS("show", "7", ""));
    assert_offered("help ", WORDS("help", "he"));
    assert_offered("create ", WORDS("token", "c"));
    assert_offered("", WORDS("token", "revoke", ""));
    assert_offered("zsh ", WORDS("completion", "z"));
    assert_offered(":json ", WORDS("submit", "--wait", "jobs/"));
    assert_offered(":files ", WORDS("verify", ""));
    assert_offered("", WORDS("list", ""));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(verbs_come_first),
        cmocka_unit_test(options_are_those_of_the_verb),
        cmocka_unit_test(values_are_those_of_the_option),
        cmocka_unit_test(operands_are_what_the_verb_takes),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
