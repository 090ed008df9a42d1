// SPDX-License-Identifier: Apache-2.0
#include "worker/process/encoder.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_read.h"
#include "core/wire/message.h"
#include "tests/support/temp_folder.h"
#include "worker/picture/image_exr.h"
#include "worker/process/options.h"
#include "worker/process/worker.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <sys/socket.h>

#include <cmocka.h>

enum { WIDTH = 8, HEIGHT = 4 };

// A grey picture of a job that states a tolerance of 0.01.
static struct picture *make_picture(struct worker *worker, const char *folder, struct audit_result audit)
{
    struct picture *picture = xcalloc(1, sizeof *picture);
    struct held_job *job = held_job_create();

    job->id = 7;
    job->epoch = 3;
    job->job = (struct job){.width_px = WIDTH,
                            .height_px = HEIGHT,
                            .fps_numerator = 24,
                            .fps_denominator = 1,
                            .quality = {.method = JOB_METHOD_AUTO, .tolerance = 0.01, .samples = 4},
                            .hash = "00000000000000000000000000000001"};
    assert_true(output_path_parse(&job->job.output.path, "a.####.exr", NULL));
    assignment_add_job(&worker->assignment, job);
    assert_true(assignment_add_frame(&worker->assignment, 7, 12, 1));
    *picture = (struct picture){.frame = assignment_start_frame(&worker->assignment),
                                .folder_fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC),
                                .method = JOB_METHOD_CACHED,
                                .step = 0.125,
                                .traced = 0.0625,
                                .audit = audit,
                                .sampling_error = 0.25,
                                .plan = "a grid of light pays",
                                .hash = "00000000000000000000000000000002"};
    assert_true(image_init(&picture->image, WIDTH, HEIGHT, false, false, NULL));
    for (int i = 0; i < WIDTH * HEIGHT * 4; i++)
        picture->image.rgba[i] = 0.5f;
    return picture;
}

// Has the encoder write one picture, and returns its message.
static struct message encode(const char *folder, struct audit_result audit, float spoilt)
{
    struct options options = {.encode_threads = 1};
    struct message message = {0};
    enum message_code code;
    struct worker worker;
    char text[4096];
    ssize_t length;
    int sockets[2];

    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets), 0);
    options.fd = sockets[0];
    assert_true(worker_init(&worker, &options));
    worker.rendered = make_picture(&worker, folder, audit);
    worker.rendered->image.rgba[5] = spoilt;
    worker.has_renderer_ended = true;
    worker.running_threads = 1;
    encoder_run(&worker);
    worker_finish(&worker);
    length = read(sockets[1], text, sizeof text);
    assert_true(length > 1);
    assert_true(message_decode(&message, text, (size_t)length - 1, &code, NULL));
    close(sockets[1]);
    return message;
}

static const char *text_of(const struct message *message, const char *key)
{
    struct json_node node = json_node_child(&message->body, key);
    const char *text = "";

    json_read_string(&node, &text, NULL);
    return text;
}

static double number_of(const struct message *message, const char *key)
{
    struct json_node node = json_node_child(&message->body, key);
    double number = -1;

    json_read_number(&node, 0, 1e9, &number, NULL);
    return number;
}

static const struct audit_result good = {.kind = AUDIT_REFERENCE,
                                         .is_pooled = true,
                                         .error = 0.0078125,
                                         .error95 = 0.015625,
                                         .ray_count = 64,
                                         .tolerance = 0.01,
                                         .seconds = 0.25};

static void audit_and_method_are_in_the_message_and_the_file(void **state)
{
    struct message message = encode(*state, good, 0.5f);
    struct image_exr_facts facts;
    int fd;

    assert_string_equal(message.method, "frame.finished");
    assert_string_equal(text_of(&message, "audit"), "reference");
    assert_true(number_of(&message, "measured_error") == 0.0078125 && number_of(&message, "error95") == 0.015625);
    assert_true(number_of(&message, "audit_rays") == 64 && number_of(&message, "audit_s") == 0.25);
    assert_string_equal(text_of(&message, "method"), "cached");
    assert_true(number_of(&message, "traced") == 0.0625);
    message_finish(&message);

    fd = open(temp_folder_path(state, "a.0012.exr.7.3.1.part"), O_RDONLY | O_CLOEXEC);
    assert_true(image_exr_read(fd, NULL, &facts, 1, NULL));
    close(fd);
    assert_int_equal(facts.audit.kind, AUDIT_REFERENCE);
    assert_true(facts.audit.is_pooled && facts.audit.error == 0.0078125 && facts.audit.tolerance == 0.01);
    assert_string_equal(facts.method, "cached");
    assert_true(facts.step == 0.125 && facts.sampling_error == 0.25 && facts.traced == 0.0625);
    assert_string_equal(facts.plan, "a grid of light pays");
    assert_string_equal(facts.job_hash, "00000000000000000000000000000002");
    assert_string_equal(facts.sequence_hash, "00000000000000000000000000000001");
}

static void assert_fails(void *const *state, struct audit_result audit, float spoilt, const char *why)
{
    struct message message = encode(*state, audit, spoilt);

    assert_string_equal(message.method, "frame.failed");
    if (!strstr(text_of(&message, "error"), why))
        fail_msg("expected \"%s\" in \"%s\"", why, text_of(&message, "error"));
    message_finish(&message);
    assert_int_not_equal(access(temp_folder_path(state, "a.0012.exr.7.3.1.part"), F_OK), 0);
}

static void no_file_of_a_frame_over_its_tolerance_is_left(void **state)
{
    struct audit_result missed = good;

    missed.error = 0.0101;
    assert_fails(state, missed, 0.5f, "marchd:error: expected at most 0.01 (tolerance), got 0.0101");
    assert_fails(state, (struct audit_result){0}, 0.5f, "marchd:error: expected the frame's measured error");
}

static void spoilt_values_are_counted_in_the_failure(void **state)
{
    assert_fails(state, good, 1e6f, "of the frame's values 0 are NaN, 0 infinite, 1 too large for half");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(audit_and_method_are_in_the_message_and_the_file, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(no_file_of_a_frame_over_its_tolerance_is_left, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(spoilt_values_are_counted_in_the_failure, temp_folder_create,
                                        temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
