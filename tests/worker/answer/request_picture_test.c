// Asks a fenced worker without GL for pictures of a folder in which strangers put what they like.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/file.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_worker.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

enum { FILE_LIMIT = 1 << 20, WIDTH = 64, HEIGHT = 33 };

static const char *at(const struct test_worker *child, const char *name)
{
    void *const state[] = {(void *)child->root};

    return temp_folder_path(state, name);
}

static void write_frame(const char *path)
{
    struct image_exr_header header = {.compression = JOB_COMPRESSION_ZIP,
                                      .fps_numerator = 24,
                                      .fps_denominator = 1,
                                      .job_name = "ash",
                                      .job_hash = "00000000000000000000000000000001",
                                      .frame = 7};
    int fd = open(path, O_CREAT | O_RDWR | O_CLOEXEC, 0600);
    struct image image;

    assert_true(image_init(&image, WIDTH, HEIGHT, true, false, NULL));
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        for (int c = 0; c < 4; c++)
            image.rgba[i * 4 + c] = (float)(i % 5) * 0.125f;
        image.depth[i] = 1.0f;
    }
    assert_true(image_exr_write(fd, &image, &header, 1, NULL));
    image_finish(&image);
    close(fd);
}

// A worker that may read films/a and write made/, and nothing else.
static void start(struct test_worker *child)
{
    const char *const options[] = {"--backend", "none", "--fenced", "--memory", "1000000000", NULL};
    struct message message;

    test_worker_start_with(child, options);
    assert_int_equal(mkdir(at(child, "films"), 0700), 0);
    assert_int_equal(mkdir(at(child, "films/a"), 0700), 0);
    assert_int_equal(mkdir(at(child, "films/b"), 0700), 0);
    assert_int_equal(mkdir(at(child, "made"), 0700), 0);
    write_frame(at(child, "films/a/1.exr"));
    write_frame(at(child, "films/b/1.exr"));
    test_worker_say(child,
                    "{\"jsonrpc\":\"2.0\",\"method\":\"worker.fence\",\"params\":{\"inputs\":[{\"place\":\"the frame\","
                    "\"root\":\"%s/films\",\"folder\":\"a\",\"path\":\"%s/films/a/1.exr\"}],"
                    "\"output\":{\"root\":\"%s/made\",\"folder\":\"\"},\"closed\":[],\"converter\":false}}",
                    child->root, child->root, child->root);
    message = test_worker_expect(child, "worker.ready");
    message_finish(&message);
}

static void finish(struct test_worker *child)
{
    test_worker_say(child, "{\"jsonrpc\":\"2.0\",\"method\":\"worker.exit\"}");
    assert_int_equal(test_worker_finish(child), 0);
}

// `more` of "/" asks for a PNG beside the frames.
static struct message ask(struct test_worker *child, const char *method, const char *file, const char *more)
{
    struct message message;

    test_worker_say(child,
                    "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"%s\",\"params\":{\"file\":\"%s/films/%s\","
                    "\"out\":\"%s/%s/1.png\"%s}}",
                    method, child->root, file, child->root, *more == '/' ? "films/a" : "made",
                    *more == '/' ? "" : more);
    for (;;) {
        if (!test_worker_hear(child, &message)) fail_msg("%s of %s: expected an answer, got the end", method, file);
        if (message.kind != MESSAGE_NOTIFICATION) return message;
        message_finish(&message);
    }
}

static void expect_refused(struct test_worker *child, const char *file, const char *more, int code, const char *reason)
{
    struct message message = ask(child, "worker.picture", file, more);

    if (message.kind != MESSAGE_ERROR) fail_msg("%s: expected an error, got a picture", file);
    if (message.code != code || !strstr(message.text, reason))
        fail_msg("%s: expected %d with \"%s\", got %d: %s", file, code, reason, message.code, message.text);
    message_finish(&message);
    assert_int_equal(access(at(child, "made/1.png"), F_OK), -1);
}

static void picture_and_header_are_made_inside_the_fence(void **state)
{
    struct json_node attributes, name;
    struct test_worker child;
    struct message message;
    const char *text;

    start(&child);
    message = ask(&child, "worker.picture", "a/1.exr", ",\"size\":16");
    assert_int_equal(message.kind, MESSAGE_RESULT);
    assert_int_equal(test_worker_integer_of(&message, "width_px"), 16);
    assert_int_equal(test_worker_integer_of(&message, "height_px"), 8);
    assert_int_equal(test_worker_integer_of(&message, "file_width_px"), WIDTH);
    message_finish(&message);
    assert_int_equal(access(at(&child, "made/1.png"), R_OK), 0);
    message = ask(&child, "worker.header", "a/1.exr", "");
    assert_int_equal(test_worker_integer_of(&message, "height_px"), HEIGHT);
    attributes = json_node_child(&message.body, "attributes");
    name = json_node_child(&attributes, "marchd:name");
    assert_true(json_read_string(&name, &text, NULL));
    assert_string_equal(text, "ash");
    message_finish(&message);
    finish(&child);
}

static void what_is_asked_wrongly_is_the_askers_fault(void **state)
{
    struct test_worker child;

    start(&child);
    expect_refused(&child, "a/1.exr", ",\"channel\":\"albedo\"", MESSAGE_CODE_PARAMS, "expected one of color, A, B");
    expect_refused(&child, "a/1.exr", ",\"x\":60,\"width\":5", MESSAGE_CODE_PARAMS, "inside the picture of 64 x 33");
    expect_refused(&child, "a/1.exr", ",\"size\":4097", MESSAGE_CODE_PARAMS, "size");
    expect_refused(&child, "a/1.exr", ",\"exposure\":1e9", MESSAGE_CODE_PARAMS, "exposure");
    finish(&child);
}

static void other_folders_and_links_stay_closed(void **state)
{
    struct test_worker child;

    start(&child);
    assert_int_equal(symlink(at(&child, "films/b/1.exr"), at(&child, "films/a/link.exr")), 0);
    assert_int_equal(symlink("1.exr", at(&child, "films/a/near.exr")), 0);
    assert_int_equal(symlink(at(&child, "films/b"), at(&child, "films/a/folder")), 0);
    assert_int_equal(mkfifo(at(&child, "films/a/pipe.exr"), 0600), 0);
    expect_refused(&child, "a/link.exr", "", MESSAGE_CODE_INTERNAL, "cannot be opened");
    expect_refused(&child, "a/near.exr", "", MESSAGE_CODE_INTERNAL, "cannot be opened");
    expect_refused(&child, "a/pipe.exr", "", MESSAGE_CODE_INTERNAL, "no regular file");
    expect_refused(&child, "a", "", MESSAGE_CODE_INTERNAL, "no regular file");
    expect_refused(&child, "b/1.exr", "", MESSAGE_CODE_INTERNAL, "Permission denied");
    expect_refused(&child, "a/folder/1.exr", "", MESSAGE_CODE_INTERNAL, "Permission denied");
    expect_refused(&child, "a/none.exr", "", MESSAGE_CODE_INTERNAL, "No such file");
    expect_refused(&child, "a/1.exr", "/", MESSAGE_CODE_STORE, "Permission denied");
    finish(&child);
}

static void write_text(const char *path, const char *bytes, size_t count)
{
    assert_true(file_replace(path, bytes, count, NULL));
}

// Each prefix of a good file, and the file with bytes of its header and its pixels changed one after another.
static void damaged_files_are_refused_or_shown_and_the_worker_lives(void **state)
{
    struct test_worker child;
    size_t size, refused = 0, shown = 0;
    char *bytes;

    start(&child);
    assert_true(file_read_text(at(&child, "films/a/1.exr"), FILE_LIMIT, &bytes, &size, NULL));
    for (size_t i = 0; i < 400; i++) {
        bool is_short = i < 100;
        size_t place = is_short ? size * i / 100 : (size - 1) * (i - 100) / 300;
        struct message message;

        bytes[place] ^= (char)0xff;
        write_text(at(&child, "films/a/bad.exr"), bytes, is_short ? place : size);
        bytes[place] ^= (char)0xff;
        message = ask(&child, i % 2 ? "worker.header" : "worker.picture", "a/bad.exr", "");
        refused += message.kind == MESSAGE_ERROR;
        shown += message.kind == MESSAGE_RESULT;
        message_finish(&message);
    }
    assert_true(refused > 100 && refused + shown == 400);
    free(bytes);
    finish(&child);
}

// dataWindow's upper corner is overwritten: the header then asks for a picture that no file of this size has.
static void huge_sides_are_refused(void **state)
{
    static const int32_t sides[][2] = {{2000000000, 2000000000}, {16384, 5}, {16383, 16383}, {-5, -5}};
    struct test_worker child;
    size_t size;
    char *bytes, *window;

    start(&child);
    assert_true(file_read_text(at(&child, "films/a/1.exr"), FILE_LIMIT, &bytes, &size, NULL));
    window = memmem(bytes, size, "dataWindow\0box2i", 16);
    assert_non_null(window);
    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++) {
        memcpy(window + 17 + 4 + 8, sides[i], sizeof sides[i]);
        write_text(at(&child, "films/a/huge.exr"), bytes, size);
        expect_refused(&child, "a/huge.exr", "", MESSAGE_CODE_INTERNAL, "");
    }
    free(bytes);
    finish(&child);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(picture_and_header_are_made_inside_the_fence),
        cmocka_unit_test(what_is_asked_wrongly_is_the_askers_fault),
        cmocka_unit_test(other_folders_and_links_stay_closed),
        cmocka_unit_test(damaged_files_are_refused_or_shown_and_the_worker_lives),
        cmocka_unit_test(huge_sides_are_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
