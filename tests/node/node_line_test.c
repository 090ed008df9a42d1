// SPDX-License-Identifier: Apache-2.0
#include "node/node_line.h"

#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static void assert_line(const char *text, enum node_word word, int worker, const char *rest)
{
    struct node_line line;
    struct error error = {0};

    assert_true(node_line_read(&line, text, strlen(text), &error));
    assert_int_equal(line.word, word);
    assert_int_equal(line.worker, worker);
    assert_int_equal(line.length, strlen(rest));
    assert_memory_equal(line.rest, rest, line.length);
}

static void lines_are_read(void **state)
{
    assert_line("beat", NODE_BEAT, NODE_NO_WORKER, "");
    assert_line("beat ", NODE_BEAT, NODE_NO_WORKER, "");
    assert_line("marchd-node {\"protocol\":1}", NODE_HELLO, NODE_NO_WORKER, "{\"protocol\":1}");
    assert_line("from 12 {\"a b\":1}", NODE_FROM, 12, "{\"a b\":1}");
    assert_line("kill 0", NODE_KILL, 0, "");
}

static void what_is_written_is_read(void **state)
{
    for (int word = 0; word < NODE_WORD_COUNT; word++) {
        char text[NODE_LINE_HEAD_SIZE + 8];
        size_t length = node_line_write_head(text, (enum node_word)word, 2147483639);
        struct node_line line;

        assert_true(length < NODE_LINE_HEAD_SIZE);
        memcpy(text + length, "rest 1", 7);
        assert_true(node_line_read(&line, text, length + 6, NULL));
        assert_int_equal(line.word, word);
        assert_memory_equal(line.rest, "rest 1", 6);
    }
}

static void other_lines_are_refused(void **state)
{
    static const char *const texts[] = {"",      "hello",    "be",      "beats",       "from",
                                        "from ", "from x {", "from -1", "from 1x {}",  "kill 99999999999999999999",
                                        " beat", "BEAT",     "from  1", "Welcome, 1!", "from 2147483648 {}"};

    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        struct node_line line;
        struct error error = {0};

        assert_false(node_line_read(&line, texts[i], strlen(texts[i]), &error));
        assert_non_null(strstr(error.message, "expected"));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_are_read),
        cmocka_unit_test(what_is_written_is_read),
        cmocka_unit_test(other_lines_are_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
