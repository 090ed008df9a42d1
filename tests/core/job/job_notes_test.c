// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_notes.h"

#include "core/base/error.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static bool read(struct job_notes *notes, const char *text, struct error *error)
{
    struct cJSON *root;
    struct json_node document;
    bool ok;

    assert_true(json_parse(&root, text, strlen(text), NULL));
    document = json_node_root(root);
    *notes = (struct job_notes){0};
    ok = job_notes_from_json(notes, &document, error);
    json_delete(root);
    return ok;
}

static void notes_are_read_and_written(void **state)
{
    struct job_notes notes;
    struct json_writer writer = {0};
    char *line;

    assert_true(read(&notes, "{\"comment\":\"f\\u00fcr Ada\",\"tags\":[\"night\",\"shot 12\"]}", NULL));
    assert_string_equal(notes.comment, "f\xc3\xbcr Ada");
    line = job_notes_format_tags(&notes);
    assert_string_equal(line, "night, shot 12");
    free(line);
    json_write_begin_object(&writer);
    job_notes_write_members(&notes, &writer);
    json_write_end_object(&writer);
    assert_string_equal(writer.text, "{\"comment\":\"f\xc3\xbcr Ada\",\"tags\":[\"night\",\"shot 12\"]}");
    json_writer_finish(&writer);
    job_notes_finish(&notes);
    assert_true(read(&notes, "{}", NULL));
    assert_null(notes.comment);
    assert_null(job_notes_format_tags(&notes));
    job_notes_finish(&notes);
}

static void assert_refused(const char *text, const char *words)
{
    struct job_notes notes;
    struct error error = {0};

    assert_false(read(&notes, text, &error));
    job_notes_finish(&notes);
    if (!strstr(error.message, words)) fail_msg("expected \"%s\" in \"%s\"", words, error.message);
}

static void notes_have_limits(void **state)
{
    struct json_writer writer = {0};
    char text[JOB_COMMENT_LIMIT + 2];

    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = 0;
    json_write_begin_object(&writer);
    json_write_string_member(&writer, "comment", text);
    json_write_end_object(&writer);
    assert_refused(writer.text, "comment: expected 1 to 1000 printable bytes");
    json_writer_finish(&writer);
    assert_refused("{\"comment\":\"a\\u001bb\"}", "comment: expected 1 to 1000 printable bytes");
    assert_refused("{\"comment\":7}", "comment: expected a string, got 7");
    assert_refused("{\"tags\":\"night\"}", "tags: expected an array");
    assert_refused("{\"tags\":[\"a\",\"b,c\"]}", "tags[1]: expected 1 to 64 printable bytes without a comma");
    assert_refused("{\"tags\":[\"\"]}", "tags[0]: expected 1 to 64");
    assert_refused("{\"tags\":[\"a\",\"a\"]}", "tags[1]: \"a\" is there twice");
    assert_refused(
        "{\"tags\":[\"a\",\"b\",\"c\",\"d\",\"e\",\"f\",\"g\",\"h\",\"i\",\"j\",\"k\",\"l\",\"m\",\"n\",\"o\","
        "\"p\",\"q\"]}",
        "tags: expected an array of 0 to 16");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(notes_are_read_and_written),
        cmocka_unit_test(notes_have_limits),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
