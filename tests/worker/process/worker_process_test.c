// Plays the daemon to the real worker, over a socketpair.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/test_worker.h"
#include "worker/audit/gate.h"
#include "worker/picture/image_exr.h"

#include <dirent.h>
#include <fcntl.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

static void format_document(char *text, size_t size, int width, int height, double step, const char *existing)
{
    snprintf(
        text, size,
        "{\"version\":1,\"name\":\"test\",\"frames\":\"10-99\",\"fps\":24,\"resolution\":[%d,%d],"
        "\"camera\":{\"position\":[0,0,-2],\"target\":[0,0,0],\"up\":[0,1,0],\"fov\":8,\"clip\":[1.0,2.2]},"
        "\"lights\":[{\"kind\":\"point\",\"falloff\":\"none\",\"intensity\":19.6,\"position\":[1.5,1,-1]}],"
        "\"scene\":{\"media\":[{\"density\":{\"kind\":\"fold_fractal\",\"iterations\":8,\"offset\":0.06,"
        "\"radius\":0.15,\"rotate_x_rad\":{\"start\":0,\"rate\":-0.2},\"rotate_y_rad\":{\"start\":0,\"rate\":-0.1},"
        "\"exponent\":1.3,\"scale\":10},\"sigma_s\":64,\"sigma_a\":0}]},"
        "\"quality\":{\"method\":\"riemann\",\"step\":%g,\"light_steps\":8},"
        "\"output\":{\"path\":\"test/test.####.exr\",\"existing\":\"%s\"}}",
        width, height, step, existing);
}

static void say_job(const struct test_worker *child, int id, int width, int height, double step, const char *existing)
{
    char document[2048], folder[128];

    snprintf(folder, sizeof folder, "%s/test", child->root);
    (void)mkdir(folder, 0700); // the worker does not make it; a test may have put something else there
    format_document(document, sizeof document, width, height, step, existing);
    test_worker_say(child,
                    "{\"jsonrpc\":\"2.0\",\"method\":\"worker.job\",\"params\":{\"job\":%d,\"epoch\":3,\"root\":\"%s\","
                    "\"owner\":\"ada\",\"node\":\"big-7\",\"document\":%s}}",
                    id, child->root, document);
}

static void say_assign(const struct test_worker *child, int id, const char *frames)
{
    test_worker_say(child, "{\"jsonrpc\":\"2.0\",\"method\":\"worker.assign\",\"params\":{\"job\":%d,\"frames\":%s}}",
                    id, frames);
}

static void say_exit(const struct test_worker *child)
{
    test_worker_say(child, "{\"jsonrpc\":\"2.0\",\"method\":\"worker.exit\"}");
}

static int count_files(const struct test_worker *child)
{
    char path[128];
    DIR *folder;
    int count = 0;

    snprintf(path, sizeof path, "%s/test", child->root);
    folder = opendir(path);
    if (!folder) return 0;
    while (readdir(folder))
        count++;
    closedir(folder);
    return count - 2;
}

static double number_of(const struct message *message, const char *key)
{
    struct json_node node = json_node_child(&message->body, key);
    double number = -1;

    assert_true(json_read_number(&node, 0, 1e9, &number, NULL));
    return number;
}

static void finished_frame_is_a_part_file_that_passes_the_gate(void **state)
{
    struct image_exr_facts facts;
    struct test_worker child;
    struct message message;
    struct gate_result found;
    struct error error = {0};
    struct job job;
    char document[2048], path[256];
    int fd;

    test_worker_start_renderer(&child);
    say_job(&child, 7, 33, 20, 0.02, "verify");
    say_assign(&child, 7, "[[10,1],[12,4]]");
    test_worker_expect_frame(&child, "frame.finished", 10);
    message = test_worker_expect(&child, "frame.finished");
    assert_int_equal(count_files(&child), 2);
    snprintf(path, sizeof path, "%s/test/test.0012.exr.7.3.4.part", child.root);
    fd = open(path, O_RDONLY | O_CLOEXEC);
    assert_true(fd >= 0);
    format_document(document, sizeof document, 33, 20, 0.02, "verify");
    assert_true(job_parse(&job, document, strlen(document), child.root, NULL));
    if (!gate_check(&(struct gate_params){.fd = fd, .job = &job, .picture_hash = job.hash, .frame = 12}, &found,
                    &error))
        fail_msg("%s", error.message);
    assert_int_equal(strtoull(test_worker_text_of(&message, "inode"), NULL, 10), found.file.inode);
    assert_int_equal(test_worker_integer_of(&message, "size_bytes"), found.file.size_bytes);
    assert_string_equal(test_worker_text_of(&message, "hash"), found.file.hash);
    assert_true(image_exr_read(fd, NULL, &facts, 1, NULL));
    assert_true(facts.render_seconds > 0 && number_of(&message, "encode_s") > 0);
    assert_true(number_of(&message, "render_s") == facts.render_seconds);
    assert_true(pread(fd, document, sizeof document, 0) == (ssize_t)sizeof document);
    assert_non_null(memmem(document, sizeof document, "big-7", 5));
    job_finish(&job);
    close(fd);
    message_finish(&message);
    say_exit(&child);
    assert_int_equal(test_worker_finish(&child), 0);
}

static void bad_document_fails_each_of_its_frames(void **state)
{
    struct test_worker child;

    test_worker_start_renderer(&child);
    test_worker_say(&child,
                    "{\"jsonrpc\":\"2.0\",\"method\":\"worker.job\",\"params\":{\"job\":1,\"epoch\":1,\"root\":\"%s\","
                    "\"owner\":\"ada\",\"document\":{\"version\":1,\"frames\":5}}}",
                    child.root);
    say_assign(&child, 1, "[[1,1],[2,1]]");
    test_worker_expect_failure(&child, 1, "job", "name: expected a string");
    test_worker_expect_failure(&child, 2, "job", "name: expected a string");
    say_exit(&child);
    assert_int_equal(test_worker_finish(&child), 0);
}

static void say_drop(const struct test_worker *child, int id, bool running)
{
    test_worker_say(child, "{\"jsonrpc\":\"2.0\",\"method\":\"worker.drop\",\"params\":{\"job\":%d,\"running\":%s}}",
                    id, running ? "true" : "false");
}

// The worker is at its first frame, 20, for seconds.
static void start_long_job(struct test_worker *child, const char *frames)
{
    test_worker_start_renderer(child);
    say_job(child, 1, 2048, 2048, 0.002, "verify");
    say_assign(child, 1, frames);
    test_worker_expect_frame(child, "frame.started", 20);
}

// The next message about this frame; heartbeats and phases are skipped.
static void expect_next(struct test_worker *child, const char *method, int frame)
{
    struct message message;

    do
        assert_true(test_worker_hear(child, &message));
    while ((!strcmp(message.method, "worker.beat") || !strcmp(message.method, "frame.phase")) &&
           (message_finish(&message), true));
    assert_string_equal(message.method, method);
    assert_int_equal(test_worker_integer_of(&message, "frame"), frame);
    message_finish(&message);
}

static void dropped_frame_is_given_back_while_it_renders(void **state)
{
    struct test_worker child;
    struct message message;

    start_long_job(&child, "[[20,1],[21,1]]");
    message = test_worker_expect(&child, "frame.phase");
    assert_int_equal(test_worker_integer_of(&message, "frame"), 20);
    message_finish(&message);
    say_drop(&child, 1, true);
    expect_next(&child, "frame.dropped", 21);
    expect_next(&child, "frame.dropped", 20);
    assert_int_equal(count_files(&child), 0);
    say_exit(&child);
    assert_int_equal(test_worker_finish(&child), 0);
}

static void drop_takes_what_it_names_and_no_more(void **state)
{
    struct test_worker child;

    test_worker_start_renderer(&child);
    say_job(&child, 1, 256, 256, 0.002, "verify");
    say_assign(&child, 1, "[[20,1],[21,1]]");
    expect_next(&child, "frame.started", 20);
    say_job(&child, 2, 33, 20, 0.02, "overwrite");
    say_assign(&child, 2, "[[30,1]]");
    say_drop(&child, 1, false);
    expect_next(&child, "frame.dropped", 21);
    expect_next(&child, "frame.rendered", 20);
    // The encoder may be done with frame 20 before or after the renderer begins the next.
    test_worker_expect_frame(&child, "frame.finished", 20);
    test_worker_expect_frame(&child, "frame.finished", 30);
    say_exit(&child);
    assert_int_equal(test_worker_finish(&child), 0);
}

static void frame_dropped_while_it_is_written_leaves_no_file(void **state)
{
    struct test_worker child;

    test_worker_start_renderer(&child);
    say_job(&child, 1, 2048, 2048, 1.0, "verify");
    say_assign(&child, 1, "[[20,1]]");
    expect_next(&child, "frame.started", 20);
    expect_next(&child, "frame.rendered", 20);
    while (count_files(&child) == 0)
        nanosleep(&(struct timespec){.tv_nsec = 1000 * 1000}, NULL);
    say_drop(&child, 1, true);
    expect_next(&child, "frame.dropped", 20);
    assert_int_equal(count_files(&child), 0);
    say_exit(&child);
    assert_int_equal(test_worker_finish(&child), 0);
}

// One sample per ray takes less time than writing the picture.
static void frames_rendered_faster_than_written_are_all_written(void **state)
{
    struct test_worker child;

    test_worker_start_renderer(&child);
    say_job(&child, 1, 1024, 1024, 1.0, "verify");
    say_assign(&child, 1, "[[20,1],[21,1],[22,1],[23,1],[24,1]]");
    for (int frame = 20; frame < 25; frame++)
        test_worker_expect_frame(&child, "frame.finished", frame);
    assert_int_equal(count_files(&child), 5);
    say_exit(&child);
    assert_int_equal(test_worker_finish(&child), 0);
}

static void part_file_that_is_there_is_not_touched(void **state)
{
    struct test_worker child;
    char path[256];
    struct stat status;
    int fd;

    test_worker_start_renderer(&child);
    say_job(&child, 1, 33, 20, 0.02, "verify");
    snprintf(path, sizeof path, "%s/test/test.0010.exr.1.3.1.part", child.root);
    fd = open(path, O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
    assert_true(fd >= 0);
    close(fd);
    say_assign(&child, 1, "[[10,1]]");
    test_worker_expect_failure(&child, 10, "frame", "File exists");
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_size, 0);
    say_exit(&child);
    assert_int_equal(test_worker_finish(&child), 0);
}

static void worker_ends_when_its_parent_goes_away_mid_render(void **state)
{
    struct test_worker child;

    start_long_job(&child, "[[20,1],[21,1]]");
    shutdown(child.fd, SHUT_RDWR);
    assert_int_not_equal(test_worker_finish(&child), -1);
}

static void exit_and_sigterm_finish_what_is_started(void **state)
{
    for (int is_signal = 0; is_signal < 2; is_signal++) {
        struct test_worker child;

        test_worker_start_renderer(&child);
        say_job(&child, 1, 64, 64, 0.02, "verify");
        say_assign(&child, 1, "[[20,1],[21,1],[22,1],[23,1]]");
        test_worker_expect_frame(&child, "frame.started", 20);
        if (is_signal)
            kill(child.pid, SIGTERM);
        else
            say_exit(&child);
        // The number of frames started by then varies; each is finished or dropped.
        for (int ended = 0; ended < 4;) {
            struct message message;

            assert_true(test_worker_hear(&child, &message));
            ended += !strcmp(message.method, "frame.finished") || !strcmp(message.method, "frame.dropped");
            assert_string_not_equal(message.method, "frame.failed");
            message_finish(&message);
        }
        assert_int_equal(test_worker_finish(&child), 0);
    }
}

static void publish(const struct test_worker *child, int frame)
{
    char part[256], name[256];

    snprintf(part, sizeof part, "%s/test/test.%04d.exr.1.3.1.part", child->root, frame);
    snprintf(name, sizeof name, "%s/test/test.%04d.exr", child->root, frame);
    assert_int_equal(rename(part, name), 0);
}

static void frame_that_is_there_is_skipped_redone_or_refused(void **state)
{
    struct test_worker child;
    char name[256], other[256];

    test_worker_start_renderer(&child);
    say_job(&child, 1, 33, 20, 0.02, "verify");
    say_assign(&child, 1, "[[10,1]]");
    test_worker_expect_frame(&child, "frame.finished", 10);
    publish(&child, 10);
    say_assign(&child, 1, "[[10,2]]");
    test_worker_expect_frame(&child, "frame.skipped", 10);
    // A link to the same picture does not count as the picture.
    snprintf(name, sizeof name, "%s/test/test.0010.exr", child.root);
    snprintf(other, sizeof other, "%s/test/other.exr", child.root);
    assert_int_equal(rename(name, other), 0);
    assert_int_equal(symlink("other.exr", name), 0);
    say_assign(&child, 1, "[[10,3]]");
    test_worker_expect_frame(&child, "frame.finished", 10);
    assert_int_equal(rename(other, name), 0);
    say_job(&child, 2, 33, 20, 0.01, "verify");
    say_assign(&child, 2, "[[10,1]]");
    test_worker_expect_frame(&child, "frame.finished", 10);
    say_job(&child, 3, 33, 20, 0.02, "overwrite");
    say_assign(&child, 3, "[[10,1]]");
    test_worker_expect_frame(&child, "frame.finished", 10);
    say_job(&child, 4, 33, 20, 0.02, "fail");
    say_assign(&child, 4, "[[10,1]]");
    test_worker_expect_failure(&child, 10, "frame", "test.0010.exr exists");
    say_exit(&child);
    assert_int_equal(test_worker_finish(&child), 0);
}

static void unreachable_output_is_the_outputs_fault(void **state)
{
    struct test_worker child;
    char path[128];
    int fd;

    test_worker_start_renderer(&child);
    snprintf(path, sizeof path, "%s/test", child.root);
    fd = open(path, O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
    assert_true(fd >= 0);
    close(fd);
    say_job(&child, 1, 33, 20, 0.02, "verify");
    say_assign(&child, 1, "[[10,1]]");
    test_worker_expect_failure(&child, 10, "output", "not a folder");
    say_exit(&child);
    assert_int_equal(test_worker_finish(&child), 0);
}

static void file_that_cannot_be_written_whole_is_removed_and_the_outputs_fault(void **state)
{
    struct test_worker child;

    test_worker_start_renderer(&child);
    assert_int_equal(prlimit(child.pid, RLIMIT_FSIZE, &(struct rlimit){2000, 2000}, NULL), 0);
    say_job(&child, 1, 64, 64, 0.02, "verify");
    say_assign(&child, 1, "[[20,1]]");
    test_worker_expect_failure(&child, 20, "output", "File too large");
    assert_int_equal(count_files(&child), 0);
    say_exit(&child);
    assert_int_equal(test_worker_finish(&child), 0);
}

static void worker_without_a_device_says_so(void **state)
{
    struct test_worker child;
    struct message message;

    test_worker_start(&child, "egl", "999");
    message = test_worker_expect(&child, "worker.failed");
    assert_true(test_worker_text_of(&message, "error")[0]);
    message_finish(&message);
    assert_int_equal(test_worker_finish(&child), 1);
}

static void wrong_options_and_messages_end_the_worker(void **state)
{
    static const char *const lines[] = {
        "nonsense", "{\"jsonrpc\":\"2.0\",\"method\":\"worker.dance\"}",
        "{\"jsonrpc\":\"2.0\",\"method\":\"worker.assign\",\"params\":{\"job\":1,\"frames\":[[1,1]]}}",
        "{\"jsonrpc\":\"2.0\",\"method\":\"worker.drop\",\"params\":{}}"};
    struct test_worker child;

    test_worker_start(&child, "vulkan", NULL);
    assert_int_equal(test_worker_finish(&child), 2);
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        struct message message;

        test_worker_start(&child, "none", NULL);
        message = test_worker_expect(&child, "worker.ready");
        message_finish(&message);
        test_worker_say(&child, "%s", lines[i]);
        assert_int_equal(test_worker_finish(&child), 1);
    }
}

static void expect_answer(struct test_worker *child, struct message *message, int id)
{
    do {
        assert_true(test_worker_hear(child, message));
        if (message->kind != MESSAGE_NOTIFICATION) break;
        message_finish(message);
    } while (true);
    assert_int_equal(atoi(message->id), id);
}

static void requests_are_answered_without_a_context(void **state)
{
    struct test_worker child;
    struct message message;
    char document[2048];

    test_worker_start(&child, "none", NULL);
    message = test_worker_expect(&child, "worker.ready");
    assert_string_equal(test_worker_text_of(&message, "backend"), "none");
    message_finish(&message);
    format_document(document, sizeof document, 32, 32, 0.02, "verify");
    test_worker_say(
        &child,
        "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"worker.explain\",\"params\":{\"root\":\"/out\",\"document\":%s}}",
        document);
    expect_answer(&child, &message, 1);
    assert_int_equal(message.kind, MESSAGE_RESULT);
    assert_non_null(strstr(test_worker_text_of(&message, "shader"), "fold_fractal"));
    message_finish(&message);
    test_worker_say(
        &child,
        "{\"jsonrpc\":\"2.0\",\"id\":2,\"method\":\"worker.explain\",\"params\":{\"document\":{\"version\":9}}}");
    expect_answer(&child, &message, 2);
    assert_int_equal(message.kind, MESSAGE_ERROR);
    assert_int_equal(message.code, MESSAGE_CODE_PARAMS);
    message_finish(&message);
    test_worker_say(&child,
                    "{\"jsonrpc\":\"2.0\",\"id\":3,\"method\":\"worker.preview\",\"params\":{\"files\":[\"/nowhere/"
                    "a.exr\"],\"out\":\"x\"}}");
    expect_answer(&child, &message, 3);
    assert_int_equal(message.kind, MESSAGE_ERROR);
    assert_non_null(strstr(message.text, "/nowhere/a.exr: No such file"));
    message_finish(&message);
    test_worker_say(&child, "{\"jsonrpc\":\"2.0\",\"id\":4,\"method\":\"worker.dance\"}");
    expect_answer(&child, &message, 4);
    assert_int_equal(message.code, MESSAGE_CODE_NO_METHOD);
    message_finish(&message);
    say_exit(&child);
    assert_int_equal(test_worker_finish(&child), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finished_frame_is_a_part_file_that_passes_the_gate),
        cmocka_unit_test(bad_document_fails_each_of_its_frames),
        cmocka_unit_test(dropped_frame_is_given_back_while_it_renders),
        cmocka_unit_test(drop_takes_what_it_names_and_no_more),
        cmocka_unit_test(frame_dropped_while_it_is_written_leaves_no_file),
        cmocka_unit_test(frames_rendered_faster_than_written_are_all_written),
        cmocka_unit_test(part_file_that_is_there_is_not_touched),
        cmocka_unit_test(worker_ends_when_its_parent_goes_away_mid_render),
        cmocka_unit_test(exit_and_sigterm_finish_what_is_started),
        cmocka_unit_test(frame_that_is_there_is_skipped_redone_or_refused),
        cmocka_unit_test(unreachable_output_is_the_outputs_fault),
        cmocka_unit_test(file_that_cannot_be_written_whole_is_removed_and_the_outputs_fault),
        cmocka_unit_test(worker_without_a_device_says_so),
        cmocka_unit_test(wrong_options_and_messages_end_the_worker),
        cmocka_unit_test(requests_are_answered_without_a_context),
    };

    signal(SIGPIPE, SIG_IGN);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
