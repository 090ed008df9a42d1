// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/explanation.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/path_list.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"
#include "tests/support/job_text.h"
#include "tests/support/json_edit.h"
#include "tests/support/temp_folder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

struct stage {
    struct path_list roots;
    struct explanation explanation;
    char *document; // of a job that reads `file`
    char *file;
};

static void write_file(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");

    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

static void begin_with(struct stage *stage, void **state, const char *name)
{
    char *cloud = job_text_load("cloud.json"), *value;

    *stage = (struct stage){.file = xstrdup(temp_folder_path(state, name))};
    (void)mkdir(temp_folder_path(state, "in"), 0700);
    (void)mkdir(temp_folder_path(state, "in/mine"), 0700);
    path_list_add(&stage->roots, xstrdup(temp_folder_path(state, "in")));
    value = xasprintf("{\"kind\":\"grid\",\"file\":\"%s\"%s}", stage->file,
                      strstr(name, ".raw") ? ",\"size\":[8,8,8],\"type\":\"uint8\",\"spacing\":[1,1,1]" : "");
    stage->document = json_edit_set(cloud, "scene.media[0].density", value);
    free(value);
    free(cloud);
    stage->explanation =
        (struct explanation){.document = stage->document, .worker = "/bin/true", .roots = &stage->roots};
}

static void begin(struct stage *stage, void **state)
{
    begin_with(stage, state, "in/mine/v.raw");
}

static void end(struct stage *stage)
{
    path_list_finish(&stage->roots);
    free(stage->document);
    free(stage->file);
}

static enum picture_status try_key(const struct stage *stage, char text[static HASH_TEXT_SIZE], struct error *error)
{
    struct explanation_key key;
    enum picture_status status = explanation_key_begin(&key, &stage->explanation, error);

    if (status == PICTURE_READY) {
        while (explanation_key_root(&key))
            explanation_key_look(&key);
        explanation_key_make(&key, text);
    }
    explanation_key_finish(&key);
    return status;
}

static void make_key(const struct stage *stage, char key[static HASH_TEXT_SIZE])
{
    struct error error = {0};

    if (try_key(stage, key, &error) != PICTURE_READY) fail_msg("%s", error.message);
}

static void key_changes_with_document_file_and_worker(void **state)
{
    char absent[HASH_TEXT_SIZE], there[HASH_TEXT_SIZE], again[HASH_TEXT_SIZE], key[HASH_TEXT_SIZE];
    struct stage stage;

    begin(&stage, state);
    make_key(&stage, absent);
    write_file(stage.file, "voxels");
    make_key(&stage, there);
    make_key(&stage, again);
    assert_string_not_equal(there, absent);
    assert_string_equal(again, there);
    write_file(stage.file, "more voxels");
    make_key(&stage, key);
    assert_string_not_equal(key, there);
    stage.explanation.worker = "/bin/false";
    make_key(&stage, again);
    assert_string_not_equal(again, key);
    stage.explanation.document = job_text_full;
    make_key(&stage, key);
    assert_string_not_equal(again, key);
    end(&stage);
}

static void write_header(const struct stage *stage, const char *data)
{
    char *text = xasprintf("NRRD0004\n# a comment\ntype: uchar\n%s\nencoding: raw\n\n", data);

    write_file(stage->file, text);
    free(text);
}

// The voxels lie beside the header, which stays as it is.
static void key_changes_with_the_file_that_a_header_names(void **state)
{
    static const char *const fields[] = {"data file: ", "datafile:", "Data File:   "};

    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        char absent[HASH_TEXT_SIZE], there[HASH_TEXT_SIZE], again[HASH_TEXT_SIZE], key[HASH_TEXT_SIZE];
        char line[512];
        struct stage stage;

        begin_with(&stage, state, i == 1 ? "in/mine/v.nrrd" : "in/mine/v.nhdr");
        snprintf(line, sizeof line, "%s%s \t\r", fields[i],
                 i == 2 ? temp_folder_path(state, "in/mine/v.data") : "v.data");
        write_header(&stage, line);
        make_key(&stage, absent);
        write_file(temp_folder_path(state, "in/mine/v.data"), "voxels");
        make_key(&stage, there);
        make_key(&stage, again);
        assert_string_not_equal(there, absent);
        assert_string_equal(again, there);
        write_file(temp_folder_path(state, "in/mine/v.data"), "more voxels");
        make_key(&stage, key);
        assert_string_not_equal(key, there);
        assert_int_equal(unlink(temp_folder_path(state, "in/mine/v.data")), 0);
        end(&stage);
    }
}

// No disk but the header's is asked, and a pipe in a header's place is not waited for.
static void file_that_a_header_names_elsewhere_is_not_looked_at(void **state)
{
    char before[HASH_TEXT_SIZE], after[HASH_TEXT_SIZE], line[512];
    struct stage stage;

    begin_with(&stage, state, "in/mine/v.nhdr");
    snprintf(line, sizeof line, "data file: %s", temp_folder_path(state, "v.data"));
    write_header(&stage, line);
    make_key(&stage, before);
    write_file(temp_folder_path(state, "v.data"), "voxels");
    make_key(&stage, after);
    assert_string_equal(after, before);
    assert_int_equal(unlink(stage.file), 0);
    assert_int_equal(mkfifo(stage.file, 0600), 0);
    make_key(&stage, after);
    assert_string_not_equal(after, before);
    end(&stage);
}

static void file_below_no_root_is_refused(void **state)
{
    char key[HASH_TEXT_SIZE] = "";
    struct error error = {0};
    struct stage stage;

    begin(&stage, state);
    path_list_finish(&stage.roots);
    path_list_add(&stage.roots, xstrdup(temp_folder_path(state, "other")));
    assert_int_equal(try_key(&stage, key, &error), PICTURE_FORBIDDEN);
    assert_non_null(strstr(error.message, "scene.media[0].density.file"));
    end(&stage);
}

static void what_is_no_job_is_refused(void **state)
{
    static const char *const documents[] = {"", "{", "[]", "{\"version\":1}", "nonsense"};
    char key[HASH_TEXT_SIZE] = "";
    struct stage stage;

    begin(&stage, state);
    for (size_t i = 0; i < sizeof documents / sizeof documents[0]; i++) {
        struct json_writer words = {0};
        struct error error = {0};

        stage.explanation.document = documents[i];
        assert_int_equal(try_key(&stage, key, &error), PICTURE_UNREADABLE);
        assert_true(error.message[0]);
        assert_false(explanation_write(&stage.explanation, "/cache/work-0", &words, NULL));
        json_writer_finish(&words);
    }
    end(&stage);
}

static void expect_text(const struct json_node *object, const char *key, const char *expected)
{
    struct json_node node = json_node_child(object, key);
    const char *text = NULL;

    assert_true(json_read_string(&node, &text, NULL));
    assert_string_equal(text, expected);
}

// The folder below its root, as a farm's worker gets it; and no more than the maker's own folder to write into.
static void fence_has_the_folders_of_the_job(void **state)
{
    struct json_writer words = {0};
    struct json_node inputs, input, output, closed, first;
    const char *text = NULL;
    enum message_code code;
    struct message message;
    struct stage stage;

    begin(&stage, state);
    assert_true(explanation_write(&stage.explanation, "/var/cache/web/work-0", &words, NULL));
    assert_true(message_decode(&message, words.text, strcspn(words.text, "\n"), &code, NULL));
    assert_string_equal(message.method, "worker.fence");
    inputs = json_node_child(&message.body, "inputs");
    assert_int_equal(json_node_count(&inputs), 1);
    input = json_node_element(&inputs, 0);
    expect_text(&input, "root", stage.roots.paths[0]);
    expect_text(&input, "folder", "mine");
    expect_text(&input, "path", stage.file);
    output = json_node_child(&message.body, "output");
    expect_text(&output, "root", "/var/cache/web/work-0");
    closed = json_node_child(&message.body, "closed");
    first = json_node_element(&closed, 0);
    assert_true(json_read_string(&first, &text, NULL));
    assert_string_equal(text, "/var/cache/web");
    message_finish(&message);
    json_writer_finish(&words);
    end(&stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(key_changes_with_document_file_and_worker, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(key_changes_with_the_file_that_a_header_names, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(file_that_a_header_names_elsewhere_is_not_looked_at, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(file_below_no_root_is_refused, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(what_is_no_job_is_refused, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(fence_has_the_folders_of_the_job, temp_folder_create, temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
