// Acts as the daemon for a real worker that is fenced for one job: it renders its own files and reaches no others.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/file.h"
#include "core/job/root_marker.h"
#include "core/wire/worker_status.h"
#include "tests/support/fence_places.h"
#include "tests/support/folders.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_worker.h"
#include "tests/support/volume_maker.h"
#include "worker/sandbox/sanitizer.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#define SEEDS PROJECT_ROOT "/tests/fuzz/seeds/"

// Writes the start of a message; its body follows.
#define ROOT_ID "0123456789abcdef0123456789abcdef"
#define SAY(method) "{\"jsonrpc\":\"2.0\",\"method\":\"" method "\",\"params\":"

enum { COPY_LIMIT = 64 << 20 };

static const char *at(const struct test_worker *child, const char *name)
{
    void *const state[] = {(void *)child->root};

    return temp_folder_path(state, name);
}

// Starts a worker that waits for its fence. Inputs are in in/ann/; no job may read the secret beside in/.
static void start(struct test_worker *child, const char *backend)
{
    const char *const options[] = {"--backend", backend, "--fenced", "--memory", "2000000000", NULL};

    test_worker_start_with(child, options);
    assert_int_equal(mkdir(at(child, "in"), 0700), 0);
    assert_int_equal(mkdir(at(child, "in/ann"), 0700), 0);
    assert_int_equal(mkdir(at(child, "out"), 0700), 0);
    assert_int_equal(mkdir(at(child, "out/a"), 0700), 0);
    volume_maker_write(at(child, "out/" ROOT_MARKER_NAME), "root " ROOT_ID "\n", strlen("root " ROOT_ID "\n"));
    volume_maker_write_raw(at(child, "secret_5x4x3xuint8.raw"), (int[]){5, 4, 3}, VOLUME_STORED_UINT8, false);
}

static void copy(const struct test_worker *child, const char *from, const char *name)
{
    char *bytes;
    size_t size_bytes;

    if (!file_read_text(from, COPY_LIMIT, &bytes, &size_bytes, NULL)) fail_msg("cannot read %s", from);
    volume_maker_write(at(child, name), bytes, size_bytes);
    free(bytes);
}

static void say_fence(const struct test_worker *child, const char *name, bool has_converter)
{
    test_worker_say(child,
                    SAY("worker.fence") "{\"inputs\":[{\"place\":\"the grid\",\"root\":\"%s/in\",\"folder\":\"ann\","
                                        "\"path\":\"%s/in/ann/%s\"}],\"output\":{\"root\":\"%s/out\","
                                        "\"root_id\":\"" ROOT_ID "\",\"folder\":\"a\"},"
                                        "\"closed\":[],\"converter\":%s}}",
                    child->root, child->root, name, child->root, has_converter ? "true" : "false");
}

// Skips the test where there is no context of this kind.
static void expect_ready(struct test_worker *child, const char *sandbox)
{
    struct message message;

    assert_true(test_worker_hear(child, &message));
    if (!strcmp(message.method, "worker.failed") && strstr(test_worker_text_of(&message, "error"), "no GL context")) {
        print_message("%s\n", test_worker_text_of(&message, "error"));
        message_finish(&message);
        test_worker_finish(child);
        skip();
    }
    assert_string_equal(message.method, "worker.ready");
    if (!strstr(test_worker_text_of(&message, "sandbox"), sandbox))
        fail_msg("expected %s, got %s", sandbox, test_worker_text_of(&message, "sandbox"));
    message_finish(&message);
}

// Renders one frame of `scene`.
static void say_frame(const struct test_worker *child, const char *scene)
{
    test_worker_say(child,
                    SAY("worker.job") "{\"job\":1,\"epoch\":1,\"root\":\"%s/out\",\"root_id\":\"" ROOT_ID
                                      "\",\"owner\":\"ada\",\"document\":"
                                      "{\"version\":1,\"name\":\"test\",\"frames\":\"1-2\",\"fps\":24,"
                                      "\"resolution\":[16,9],\"camera\":{\"position\":[0,0,9],\"target\":[0,0,0],"
                                      "\"fov\":30},\"background\":[1,1,1],\"scene\":{%s},"
                                      "\"quality\":{\"method\":\"midpoint\",\"step\":0.1},"
                                      "\"output\":{\"path\":\"a/test.####.exr\"}}}}",
                    child->root, scene);
    test_worker_say(child, SAY("worker.assign") "{\"job\":1,\"frames\":[[1,1]]}}");
}

static void say_grid(const struct test_worker *child, const char *name)
{
    char *scene;

    assert_true(asprintf(&scene, "\"media\":[{\"density\":{\"kind\":\"grid\",\"file\":\"%s/%s\"},\"emission\":1}]",
                         child->root, name) > 0);
    say_frame(child, scene);
    free(scene);
}

static void expect_frame_and_end(struct test_worker *child)
{
    struct message message = test_worker_expect(child, "frame.finished");

    message_finish(&message);
    test_worker_say(child, "{\"jsonrpc\":\"2.0\",\"method\":\"worker.exit\"}");
    assert_int_equal(test_worker_finish(child), 0);
}

// A file that was written more than 2.1 s ago is complete: then no frame of the job can be rendered.
static void let_files_settle(void)
{
    sleep(3);
}

static void expect_denial_and_end(struct test_worker *child, const char *fault)
{
    test_worker_expect_failure(child, 1, fault, "Permission denied");
    test_worker_say(child, "{\"jsonrpc\":\"2.0\",\"method\":\"worker.exit\"}");
    assert_int_equal(test_worker_finish(child), 0);
}

static void assert_grid_is_shown(const char *backend, const char *from, const char *name)
{
    struct test_worker child;
    char path[256];

    start(&child, backend);
    snprintf(path, sizeof path, "in/ann/%s", name);
    copy(&child, from, path);
    say_fence(&child, name, false);
    expect_ready(&child, "seccomp");
    say_grid(&child, path);
    expect_frame_and_end(&child);
}

static void every_kind_of_grid_is_shown(void **state)
{
    assert_grid_is_shown("software", SEEDS "volume_nifti/version_1", "a.nii");
    assert_grid_is_shown("software", SEEDS "volume_nifti/gzip", "a.nii.gz");
    assert_grid_is_shown("software", SEEDS "volume_nrrd/raw", "a.nrrd");
    assert_grid_is_shown("software", PROJECT_ROOT "/jobs/smoke/smoke.0001.nvdb", "a.nvdb");
}

static void egl_shows_it_too(void **state)
{
    assert_grid_is_shown("egl", SEEDS "volume_nifti/gzip", "a.nii.gz");
}

static void the_converter_is_run(void **state)
{
    struct test_worker child;
    char *command;

    if (system("command -v nanovdb_convert >/dev/null") != 0) {
        print_message("nanovdb_convert is not installed\n");
        skip();
    }
    start(&child, "software");
    assert_true(asprintf(&command, "nanovdb_convert -f %s/jobs/smoke/smoke.0001.nvdb %s/in/ann/a.vdb >/dev/null",
                         PROJECT_ROOT, child.root) > 0);
    assert_int_equal(system(command), 0);
    free(command);
    say_fence(&child, "a.vdb", true);
    expect_ready(&child, "seccomp");
    say_grid(&child, "in/ann/a.vdb");
    expect_frame_and_end(&child);
}

static void textures_are_read(void **state)
{
    struct test_worker child;
    char *scene;

    start(&child, "software");
    copy(&child, PROJECT_ROOT "/jobs/textures/floor.png", "in/ann/floor.png");
    say_fence(&child, "floor.png", false);
    expect_ready(&child, "seccomp");
    assert_true(asprintf(&scene,
                         "\"objects\":[{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1,\"material\":"
                         "{\"kind\":\"diffuse\",\"texture\":{\"file\":\"%s/in/ann/floor.png\"}}}]",
                         child.root) > 0);
    say_frame(&child, scene);
    free(scene);
    expect_frame_and_end(&child);
}

// The job names another file than its fence does. No daemon sends that, but a worker that is taken over would open it.
static void file_of_another_job_stays_closed(void **state)
{
    struct test_worker child;

    fence_places_skip_without_landlock();
    start(&child, "software");
    copy(&child, SEEDS "volume_nifti/gzip", "in/ann/a.nii.gz");
    say_fence(&child, "a.nii.gz", false);
    expect_ready(&child, "landlock");
    let_files_settle();
    say_grid(&child, "secret_5x4x3xuint8.raw");
    expect_denial_and_end(&child, "job");
}

static void start_header(struct test_worker *child, const char *data_file)
{
    char *header;

    start(child, "software");
    volume_maker_write_raw(at(child, "in/ann/beside.raw"), (int[]){5, 4, 3}, VOLUME_STORED_UINT8, false);
    assert_true(asprintf(&header, "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 4 3\nencoding: raw\ndata file: %s%s\n",
                         data_file[0] == '/' ? child->root : "", data_file) > 0);
    volume_maker_write(at(child, "in/ann/a.nhdr"), header, strlen(header));
    free(header);
    say_fence(child, "a.nhdr", false);
    expect_ready(child, "seccomp");
    let_files_settle();
    say_grid(child, "in/ann/a.nhdr");
}

static void header_reads_the_file_beside_it(void **state)
{
    struct test_worker child;

    start_header(&child, "beside.raw");
    expect_frame_and_end(&child);
}

static void assert_header_is_refused(const char *data_file)
{
    struct test_worker child;

    start_header(&child, data_file);
    expect_denial_and_end(&child, "job");
}

static void headers_read_no_files_outside_their_folder(void **state)
{
    fence_places_skip_without_landlock();
    assert_header_is_refused("/secret_5x4x3xuint8.raw");
    assert_header_is_refused("../../secret_5x4x3xuint8.raw");
}

static void link_of_a_sequence_that_leads_out_fails_its_frame(void **state)
{
    struct test_worker child;

    fence_places_skip_without_landlock();
    start(&child, "software");
    assert_int_equal(symlink("../../secret_5x4x3xuint8.raw", at(&child, "in/ann/s01_5x4x3xuint8.raw")), 0);
    say_fence(&child, "s##_5x4x3xuint8.raw", false);
    expect_ready(&child, "landlock");
    say_grid(&child, "in/ann/s##_5x4x3xuint8.raw");
    expect_denial_and_end(&child, "frame");
}

static void expect_unable(struct test_worker *child, const char *fault, const char *words)
{
    struct message message = test_worker_expect(child, "worker.failed");

    assert_string_equal(test_worker_text_of(&message, "fault"), fault);
    if (!strstr(test_worker_text_of(&message, "error"), words))
        fail_msg("expected \"%s\" in \"%s\"", words, test_worker_text_of(&message, "error"));
    message_finish(&message);
    assert_int_equal(test_worker_finish(child), 1);
}

static void links_that_lead_out_end_the_worker(void **state)
{
    struct test_worker child;

    start(&child, "software");
    assert_int_equal(symlink("../../secret_5x4x3xuint8.raw", at(&child, "in/ann/a_5x4x3xuint8.raw")), 0);
    say_fence(&child, "a_5x4x3xuint8.raw", false);
    expect_unable(&child, "job", "leads out of");
    start(&child, "software");
    assert_int_equal(rmdir(at(&child, "out/a")), 0);
    assert_int_equal(symlink("../in", at(&child, "out/a")), 0);
    copy(&child, SEEDS "volume_nifti/gzip", "in/ann/a.nii.gz");
    say_fence(&child, "a.nii.gz", false);
    expect_unable(&child, "output", "symbolic link");
}

static void root_that_is_another_one_is_told(void **state)
{
    struct test_worker child;

    start(&child, "software");
    assert_int_equal(unlink(at(&child, "out/" ROOT_MARKER_NAME)), 0);
    copy(&child, SEEDS "volume_nifti/gzip", "in/ann/a.nii.gz");
    say_fence(&child, "a.nii.gz", false);
    expect_unable(&child, "root", "has no " ROOT_MARKER_NAME);

    start(&child, "software");
    copy(&child, SEEDS "volume_nifti/gzip", "in/ann/a.nii.gz");
    say_fence(&child, "a.nii.gz", false);
    expect_ready(&child, "seccomp");
    assert_int_equal(unlink(at(&child, "out/" ROOT_MARKER_NAME)), 0);
    say_grid(&child, "in/ann/a.nii.gz");
    test_worker_expect_failure(&child, 1, "root", "has no " ROOT_MARKER_NAME);
    test_worker_say(&child, "{\"jsonrpc\":\"2.0\",\"method\":\"worker.exit\"}");
    assert_int_equal(test_worker_finish(&child), 0);
}

static void nothing_is_done_without_a_fence(void **state)
{
    struct test_worker child;

    start(&child, "software");
    say_grid(&child, "secret_5x4x3xuint8.raw");
    expect_unable(&child, "worker", "expected worker.fence");
}

// Processor seconds of the worker processes that have ended.
static double ended_processes_s(void)
{
    struct rusage used;

    assert_int_equal(getrusage(RUSAGE_CHILDREN, &used), 0);
    return (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
           1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

// Thirty doublings of a line of GLSL make the compiler run out of its own memory, not of the machine's.
static void source_that_grows_without_end_ends_the_worker(void **state)
{
    static const char words[] = "\"media\":[{\"density\":{\"kind\":\"glsl\",\"bounds\":{\"kind\":\"sphere\",\"center\":"
                                "[0,0,0],\"radius\":1},\"source\":\"#define A0 +p.x+p.y+p.z+p.x\\n%sfloat density(vec3 "
                                "p,float t){return 0.0 A30;}\"},\"emission\":1}]";
    char lines[2048] = "", *scene;
    struct test_worker child;
    struct message message;
    double began_s;
    int status;

    if (IS_SANITIZED) {
        print_message("the address sanitizer needs more memory than there would be\n");
        skip();
    }
    for (int i = 1, length = 0; i <= 30; i++)
        length += snprintf(lines + length, sizeof lines - (size_t)length, "#define A%d A%d A%d\\n", i, i - 1, i - 1);
    began_s = ended_processes_s();
    start(&child, "software");
    copy(&child, SEEDS "volume_nifti/gzip", "in/ann/a.nii.gz");
    say_fence(&child, "a.nii.gz", false);
    expect_ready(&child, "seccomp");
    assert_true(asprintf(&scene, words, lines) > 0);
    say_frame(&child, scene);
    free(scene);
    // The worker dies, and before that it reports only that it lives, has begun, and what it is about.
    while (test_worker_hear(&child, &message)) {
        if (strcmp(message.method, "worker.beat") != 0 && strcmp(message.method, "frame.phase") != 0)
            assert_string_equal(message.method, "frame.started");
        message_finish(&message);
    }
    status = test_worker_finish(&child);
    assert_int_equal(status, WORKER_STATUS_MEMORY);
    assert_true(ended_processes_s() - began_s < 60.0);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_grid_is_shown),
        cmocka_unit_test(egl_shows_it_too),
        cmocka_unit_test(the_converter_is_run),
        cmocka_unit_test(textures_are_read),
        cmocka_unit_test(file_of_another_job_stays_closed),
        cmocka_unit_test(header_reads_the_file_beside_it),
        cmocka_unit_test(headers_read_no_files_outside_their_folder),
        cmocka_unit_test(link_of_a_sequence_that_leads_out_fails_its_frame),
        cmocka_unit_test(links_that_lead_out_end_the_worker),
        cmocka_unit_test(root_that_is_another_one_is_told),
        cmocka_unit_test(nothing_is_done_without_a_fence),
        cmocka_unit_test(source_that_grows_without_end_ends_the_worker),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
