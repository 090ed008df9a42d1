// Plays the daemon to the real worker, over a socketpair.
#include "core/error.h"
#include "core/job.h"
#include "core/job_json.h"
#include "core/message.h"
#include "core/message_stream.h"
#include "worker/gate.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

// Generous: sanitizers, and other processes on the same cores.
enum { MESSAGE_TIMEOUT_MS = 60 * 1000, EXIT_TIMEOUT_MS = 20 * 1000 };

struct child {
    pid_t pid;
    int fd;
    struct message_stream stream;
    char root[64];
    int exit_status; // of waitpid
};

static void start(struct child *child, const char *backend, const char *device)
{
    int fds[2];
    char number[16];

    *child = (struct child){.root = "/tmp/worker_process_test_XXXXXX"};
    assert_non_null(mkdtemp(child->root));
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, fds), 0);
    child->fd = fds[0];
    child->pid = fork();
    assert_true(child->pid >= 0);
    if (child->pid == 0) {
        fcntl(fds[1], F_SETFD, 0);
        snprintf(number, sizeof number, "%d", fds[1]);
        execl(PROGRAM_FOLDER "/march-worker", "march-worker", "--fd", number, "--backend", backend,
              device ? "--device" : NULL, device, NULL);
        _exit(127);
    }
    close(fds[1]);
}

static void say(const struct child *child, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void say(const struct child *child, const char *format, ...)
{
    va_list arguments;

    va_start(arguments, format);
    assert_true(vdprintf(child->fd, format, arguments) > 0);
    va_end(arguments);
    assert_int_equal(write(child->fd, "\n", 1), 1);
}

// False at the end of the stream.
static bool hear(struct child *child, struct message *message)
{
    const char *line;
    size_t length, room;
    enum message_code code;
    struct error error = {0};

    while (!(line = message_stream_next(&child->stream, &length, &error))) {
        struct pollfd ready = {.fd = child->fd, .events = POLLIN};
        char *bytes = message_stream_reserve(&child->stream, &room);
        ssize_t count;

        if (poll(&ready, 1, MESSAGE_TIMEOUT_MS) != 1) fail_msg("the worker says nothing");
        count = recv(child->fd, bytes, room, 0);
        if (count <= 0) return false;
        message_stream_commit(&child->stream, (size_t)count);
    }
    if (!message_decode(message, line, length, &code, &error)) fail_msg("%s", error.message);
    return true;
}

// The next message of this method; those in between may be beats and what frames pass through only.
static struct message expect(struct child *child, const char *method)
{
    static const char *const passed_over[] = {"worker.beat", "frame.started", "frame.rendered"};
    struct message message;

    for (;;) {
        bool is_passed_over = false;

        if (!hear(child, &message)) fail_msg("expected %s, got the end", method);
        if (message.kind == MESSAGE_NOTIFICATION && !strcmp(message.method, method)) return message;
        for (size_t i = 0; i < sizeof passed_over / sizeof passed_over[0]; i++)
            is_passed_over |= message.kind == MESSAGE_NOTIFICATION && !strcmp(message.method, passed_over[i]);
        if (!is_passed_over) fail_msg("expected %s, got %s", method, message.method ? message.method : "an answer");
        message_finish(&message);
    }
}

static int64_t integer_of(const struct message *message, const char *key)
{
    struct json_node node = json_node_child(&message->body, key);
    int64_t integer = -1;

    assert_true(json_read_integer(&node, 0, INT64_MAX, &integer, NULL));
    return integer;
}

static const char *text_of(const struct message *message, const char *key)
{
    struct json_node node = json_node_child(&message->body, key);
    const char *text = "";

    assert_true(json_read_string(&node, &text, NULL));
    return text;
}

static void expect_frame(struct child *child, const char *method, int frame)
{
    struct message message = expect(child, method);

    assert_int_equal(integer_of(&message, "frame"), frame);
    message_finish(&message);
}

static void expect_failure(struct child *child, int frame, const char *fault, const char *reason)
{
    struct message message = expect(child, "frame.failed");

    assert_int_equal(integer_of(&message, "frame"), frame);
    assert_string_equal(text_of(&message, "fault"), fault);
    if (!strstr(text_of(&message, "error"), reason))
        fail_msg("expected \"%s\" in \"%s\"", reason, text_of(&message, "error"));
    message_finish(&message);
}

static void remove_folder(const char *path)
{
    DIR *folder = opendir(path);
    struct dirent *entry;
    char inner[512];

    assert_non_null(folder);
    while ((entry = readdir(folder))) {
        if (!strcmp(entry->d_name, ".") || !strcmp(entry->d_name, "..")) continue;
        snprintf(inner, sizeof inner, "%s/%s", path, entry->d_name);
        if (unlink(inner) < 0) remove_folder(inner);
    }
    closedir(folder);
    rmdir(path);
}

// Waits for the worker to end by itself and returns its exit status, -1 when it did not or a signal ended it.
static int finish(struct child *child)
{
    int status = 0;
    pid_t ended = 0;

    for (int waited_ms = 0; waited_ms < EXIT_TIMEOUT_MS && !ended; waited_ms += 10) {
        ended = waitpid(child->pid, &status, WNOHANG);
        if (!ended) nanosleep(&(struct timespec){.tv_nsec = 10 * 1000 * 1000}, NULL);
    }
    if (!ended) {
        kill(child->pid, SIGKILL);
        waitpid(child->pid, &status, 0);
    }
    close(child->fd);
    message_stream_finish(&child->stream);
    remove_folder(child->root);
    return ended && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// Without OSMesa there is nothing to test here.
static void start_renderer(struct child *child)
{
    struct message message;

    start(child, "osmesa", NULL);
    assert_true(hear(child, &message));
    if (!strcmp(message.method, "worker.failed")) {
        print_message("no OSMesa: %s\n", text_of(&message, "error"));
        message_finish(&message);
        finish(child);
        skip();
    }
    assert_string_equal(message.method, "worker.ready");
    assert_string_equal(text_of(&message, "backend"), "osmesa");
    assert_int_equal(integer_of(&message, "pid"), child->pid);
    message_finish(&message);
}

static void format_document(char *text, size_t size, int width, int height, double step, const char *existing)
{
    snprintf(
        text, size,
        "{\"version\":1,\"name\":\"test\",\"frames\":\"10-99\",\"fps\":24,\"resolution\":[%d,%d],"
        "\"camera\":{\"position\":[0,0,-2],\"target\":[0,0,0],\"up\":[0,1,0],\"fov\":53.13,\"clip\":[1.0,2.2]},"
        "\"lights\":[{\"kind\":\"point\",\"falloff\":\"none\",\"intensity\":19.6,\"position\":[1.5,1,-1]}],"
        "\"scene\":{\"media\":[{\"density\":{\"kind\":\"fold_fractal\",\"iterations\":8,\"offset\":0.06,"
        "\"radius\":0.15,\"rotate_x_rad\":{\"start\":0,\"rate\":-0.2},\"rotate_y_rad\":{\"start\":0,\"rate\":-0.1},"
        "\"exponent\":1.3,\"scale\":10},\"sigma_s\":64,\"sigma_a\":0}]},"
        "\"quality\":{\"method\":\"riemann\",\"step\":%g,\"light_steps\":8},"
        "\"output\":{\"path\":\"test/test.####.exr\",\"existing\":\"%s\"}}",
        width, height, step, existing);
}

static void say_job(const struct child *child, int id, int width, int height, double step, const char *existing)
{
    char document[2048];

    format_document(document, sizeof document, width, height, step, existing);
    say(child,
        "{\"jsonrpc\":\"2.0\",\"method\":\"worker.job\",\"params\":{\"job\":%d,\"epoch\":3,\"root\":\"%s\","
        "\"owner\":\"ada\",\"document\":%s}}",
        id, child->root, document);
}

static void say_assign(const struct child *child, int id, const char *frames)
{
    say(child, "{\"jsonrpc\":\"2.0\",\"method\":\"worker.assign\",\"params\":{\"job\":%d,\"frames\":%s}}", id, frames);
}

static void say_exit(const struct child *child)
{
    say(child, "{\"jsonrpc\":\"2.0\",\"method\":\"worker.exit\"}");
}

static int count_files(const struct child *child)
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

static void finished_frame_is_a_part_file_that_passes_the_gate(void **state)
{
    struct child child;
    struct message message;
    struct published_file file;
    struct error error = {0};
    struct job job;
    char document[2048], path[256];
    int fd;

    start_renderer(&child);
    say_job(&child, 7, 33, 20, 0.02, "verify");
    say_assign(&child, 7, "[[10,1],[12,4]]");
    expect_frame(&child, "frame.finished", 10);
    message = expect(&child, "frame.finished");
    assert_int_equal(count_files(&child), 2);
    snprintf(path, sizeof path, "%s/test/test.0012.exr.7.3.4.part", child.root);
    fd = open(path, O_RDONLY | O_CLOEXEC);
    assert_true(fd >= 0);
    format_document(document, sizeof document, 33, 20, 0.02, "verify");
    assert_true(job_parse(&job, document, strlen(document), child.root, NULL));
    if (!gate_check(&(struct gate_params){.fd = fd, .job = &job, .frame = 12}, &file, &error))
        fail_msg("%s", error.message);
    assert_int_equal(strtoull(text_of(&message, "inode"), NULL, 10), file.inode);
    assert_int_equal(integer_of(&message, "size_bytes"), file.size_bytes);
    assert_string_equal(text_of(&message, "hash"), file.hash);
    job_finish(&job);
    close(fd);
    message_finish(&message);
    say_exit(&child);
    assert_int_equal(finish(&child), 0);
}

static void bad_document_fails_each_of_its_frames(void **state)
{
    struct child child;

    start_renderer(&child);
    say(&child,
        "{\"jsonrpc\":\"2.0\",\"method\":\"worker.job\",\"params\":{\"job\":1,\"epoch\":1,\"root\":\"%s\","
        "\"owner\":\"ada\",\"document\":{\"version\":1,\"frames\":5}}}",
        child.root);
    say_assign(&child, 1, "[[1,1],[2,1]]");
    expect_failure(&child, 1, "job", "name: expected a string");
    expect_failure(&child, 2, "job", "name: expected a string");
    say_exit(&child);
    assert_int_equal(finish(&child), 0);
}

// Some minutes of work, of which the tests wait for seconds at most.
static void start_long_job(struct child *child, const char *frames)
{
    start_renderer(child);
    say_job(child, 1, 2048, 2048, 0.002, "verify");
    say_assign(child, 1, frames);
    expect_frame(child, "frame.started", 20);
}

static void dropped_frame_is_given_back_while_it_renders(void **state)
{
    struct child child;

    start_long_job(&child, "[[20,1],[21,1]]");
    say(&child, "{\"jsonrpc\":\"2.0\",\"method\":\"worker.drop\",\"params\":{\"job\":1,\"running\":true}}");
    expect_frame(&child, "frame.dropped", 21);
    expect_frame(&child, "frame.dropped", 20);
    assert_int_equal(count_files(&child), 0);
    say_exit(&child);
    assert_int_equal(finish(&child), 0);
}

static void worker_ends_when_its_parent_goes_away_mid_render(void **state)
{
    struct child child;

    start_long_job(&child, "[[20,1],[21,1]]");
    shutdown(child.fd, SHUT_RDWR);
    assert_int_not_equal(finish(&child), -1);
}

static void exit_and_sigterm_finish_what_is_started(void **state)
{
    for (int is_signal = 0; is_signal < 2; is_signal++) {
        struct child child;

        start_renderer(&child);
        say_job(&child, 1, 64, 64, 0.02, "verify");
        say_assign(&child, 1, "[[20,1],[21,1],[22,1],[23,1]]");
        expect_frame(&child, "frame.started", 20);
        if (is_signal)
            kill(child.pid, SIGTERM);
        else
            say_exit(&child);
        // How many were started by then is chance; each is finished or given back.
        for (int ended = 0; ended < 4;) {
            struct message message;

            assert_true(hear(&child, &message));
            ended += !strcmp(message.method, "frame.finished") || !strcmp(message.method, "frame.dropped");
            assert_string_not_equal(message.method, "frame.failed");
            message_finish(&message);
        }
        assert_int_equal(finish(&child), 0);
    }
}

static void publish(const struct child *child, int frame)
{
    char part[256], name[256];

    snprintf(part, sizeof part, "%s/test/test.%04d.exr.1.3.1.part", child->root, frame);
    snprintf(name, sizeof name, "%s/test/test.%04d.exr", child->root, frame);
    assert_int_equal(rename(part, name), 0);
}

static void frame_that_is_there_is_skipped_redone_or_refused(void **state)
{
    struct child child;

    start_renderer(&child);
    say_job(&child, 1, 33, 20, 0.02, "verify");
    say_assign(&child, 1, "[[10,1]]");
    expect_frame(&child, "frame.finished", 10);
    publish(&child, 10);
    say_assign(&child, 1, "[[10,2]]");
    expect_frame(&child, "frame.skipped", 10);
    say_job(&child, 2, 33, 20, 0.01, "verify");
    say_assign(&child, 2, "[[10,1]]");
    expect_frame(&child, "frame.finished", 10);
    say_job(&child, 3, 33, 20, 0.02, "overwrite");
    say_assign(&child, 3, "[[10,1]]");
    expect_frame(&child, "frame.finished", 10);
    say_job(&child, 4, 33, 20, 0.02, "fail");
    say_assign(&child, 4, "[[10,1]]");
    expect_failure(&child, 10, "frame", "test.0010.exr exists");
    say_exit(&child);
    assert_int_equal(finish(&child), 0);
}

static void unreachable_output_is_the_outputs_fault(void **state)
{
    struct child child;
    char path[128];
    int fd;

    start_renderer(&child);
    snprintf(path, sizeof path, "%s/test", child.root);
    fd = open(path, O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
    assert_true(fd >= 0);
    close(fd);
    say_job(&child, 1, 33, 20, 0.02, "verify");
    say_assign(&child, 1, "[[10,1]]");
    expect_failure(&child, 10, "output", "not a folder");
    say_exit(&child);
    assert_int_equal(finish(&child), 0);
}

static void file_that_cannot_be_written_whole_is_removed_and_the_outputs_fault(void **state)
{
    struct child child;

    start_renderer(&child);
    assert_int_equal(prlimit(child.pid, RLIMIT_FSIZE, &(struct rlimit){2000, 2000}, NULL), 0);
    say_job(&child, 1, 64, 64, 0.02, "verify");
    say_assign(&child, 1, "[[20,1]]");
    expect_failure(&child, 20, "output", "File too large");
    assert_int_equal(count_files(&child), 0);
    say_exit(&child);
    assert_int_equal(finish(&child), 0);
}

static void worker_without_a_device_says_so(void **state)
{
    struct child child;
    struct message message;

    start(&child, "egl", "999");
    message = expect(&child, "worker.failed");
    assert_true(text_of(&message, "error")[0]);
    message_finish(&message);
    assert_int_equal(finish(&child), 1);
}

static void wrong_options_and_messages_end_the_worker(void **state)
{
    static const char *const lines[] = {
        "nonsense", "{\"jsonrpc\":\"2.0\",\"method\":\"worker.dance\"}",
        "{\"jsonrpc\":\"2.0\",\"method\":\"worker.assign\",\"params\":{\"job\":1,\"frames\":[[1,1]]}}",
        "{\"jsonrpc\":\"2.0\",\"method\":\"worker.drop\",\"params\":{}}"};
    struct child child;

    start(&child, "vulkan", NULL);
    assert_int_equal(finish(&child), 2);
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        struct message message;

        start(&child, "none", NULL);
        message = expect(&child, "worker.ready");
        message_finish(&message);
        say(&child, "%s", lines[i]);
        assert_int_equal(finish(&child), 1);
    }
}

static void expect_answer(struct child *child, struct message *message, int id)
{
    do {
        assert_true(hear(child, message));
        if (message->kind != MESSAGE_NOTIFICATION) break;
        message_finish(message);
    } while (true);
    assert_int_equal(atoi(message->id), id);
}

static void requests_are_answered_without_a_context(void **state)
{
    struct child child;
    struct message message;
    char document[2048];

    start(&child, "none", NULL);
    message = expect(&child, "worker.ready");
    assert_string_equal(text_of(&message, "backend"), "none");
    message_finish(&message);
    format_document(document, sizeof document, 32, 32, 0.02, "verify");
    say(&child,
        "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"worker.explain\",\"params\":{\"root\":\"/out\",\"document\":%s}}",
        document);
    expect_answer(&child, &message, 1);
    assert_int_equal(message.kind, MESSAGE_RESULT);
    assert_non_null(strstr(text_of(&message, "shader"), "fold_fractal"));
    message_finish(&message);
    say(&child,
        "{\"jsonrpc\":\"2.0\",\"id\":2,\"method\":\"worker.explain\",\"params\":{\"document\":{\"version\":9}}}");
    expect_answer(&child, &message, 2);
    assert_int_equal(message.kind, MESSAGE_ERROR);
    assert_int_equal(message.code, MESSAGE_CODE_PARAMS);
    message_finish(&message);
    say(&child, "{\"jsonrpc\":\"2.0\",\"id\":3,\"method\":\"worker.preview\",\"params\":{\"files\":[\"/nowhere/"
                "a.exr\"],\"out\":\"x\"}}");
    expect_answer(&child, &message, 3);
    assert_int_equal(message.kind, MESSAGE_ERROR);
    assert_non_null(strstr(message.text, "/nowhere/a.exr: No such file"));
    message_finish(&message);
    say(&child, "{\"jsonrpc\":\"2.0\",\"id\":4,\"method\":\"worker.dance\"}");
    expect_answer(&child, &message, 4);
    assert_int_equal(message.code, MESSAGE_CODE_NO_METHOD);
    message_finish(&message);
    say_exit(&child);
    assert_int_equal(finish(&child), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finished_frame_is_a_part_file_that_passes_the_gate),
        cmocka_unit_test(bad_document_fails_each_of_its_frames),
        cmocka_unit_test(dropped_frame_is_given_back_while_it_renders),
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
