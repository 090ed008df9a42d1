// Asks for pictures of files that strangers write, of the real worker and of workers that do what they like.
// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/pictures.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/path_list.h"
#include "tests/support/folders.h"
#include "tests/support/temp_folder.h"
#include "web/pictures/picture_query.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <semaphore.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <cmocka.h>

#define WORKER PROGRAM_FOLDER "/march-worker"

enum { SOON_MS = 200, LATE_MS = 600000, FILE_LIMIT = 1 << 20 };

struct stage {
    void **state; // the folder
    struct pictures *pictures;
    struct path_list roots;
    sem_t answers;
};

static void on_answers(void *user)
{
    sem_post(user);
}

static void make_frame(void **state, const char *name, const char *setting)
{
    char *command = xasprintf("%s/exr-make %s %s", PROGRAM_FOLDER, temp_folder_path(state, name), setting);

    assert_int_equal(system(command), 0);
    free(command);
}

static void start(struct stage *stage, void **state, const char *worker, int limit_ms)
{
    struct pictures_params params = {.worker = worker,
                                     .cache_bytes = 1 << 20,
                                     .worker_bytes = 1000 * 1000 * 1000,
                                     .limit_ms = limit_ms,
                                     .maker_count = 2,
                                     .on_answers = on_answers,
                                     .user = &stage->answers};
    struct error error = {0};

    *stage = (struct stage){.state = state};
    sem_init(&stage->answers, 0, 0);
    (void)mkdir(temp_folder_path(state, "films"), 0700);
    (void)mkdir(temp_folder_path(state, "films/a"), 0700);
    (void)mkdir(temp_folder_path(state, "cache"), 0700);
    path_list_add(&stage->roots, xstrdup(temp_folder_path(state, "films")));
    if (access(temp_folder_path(state, "films/a/1.exr"), F_OK) != 0) make_frame(state, "films/a/1.exr", "frame=7");
    params.cache_folder = temp_folder_path(state, "cache");
    stage->pictures = pictures_create(&params, &error);
    if (!stage->pictures) fail_msg("%s", error.message);
}

static void stop(struct stage *stage)
{
    pictures_destroy(stage->pictures);
    path_list_finish(&stage->roots);
    sem_destroy(&stage->answers);
}

static struct picture_ask *ask(struct stage *stage, const char *path, const char *text, const char *known)
{
    bool is_header = !strcmp(text, "header");
    char copy[128], *rest = copy;
    const char *pairs[8];
    size_t count = 0;
    struct picture_query query;
    struct picture_question question = {
        .query = &query, .subject = temp_folder_path(stage->state, path), .roots = &stage->roots, .known = known};

    snprintf(copy, sizeof copy, "%s", is_header ? "" : text);
    while (*copy && rest)
        pairs[count++] = strsep(&rest, "&");
    assert_true(picture_query_parse(&query, is_header ? "/frame/1/1.json" : "/frame/1/1.png", pairs, count, NULL));
    return pictures_ask(stage->pictures, &question, stage);
}

static struct picture_ask *hear(struct stage *stage)
{
    struct picture_ask *answered;

    while (!(answered = pictures_take_answer(stage->pictures)))
        while (sem_wait(&stage->answers) != 0)
            assert_int_equal(errno, EINTR);
    assert_ptr_equal(picture_ask_user(answered), stage);
    return answered;
}

static struct picture_ask *expect(struct stage *stage, const char *path, const char *text, enum picture_status status,
                                  const char *reason)
{
    struct picture_ask *asked = ask(stage, path, text, NULL);
    struct picture_answer answer;

    assert_ptr_equal(hear(stage), asked);
    answer = picture_ask_answer(asked);
    if (answer.status != status || (reason && !strstr(answer.reason ? answer.reason : "", reason)))
        fail_msg("%s?%s: expected %d with \"%s\", got %d: %s", path, text, status, reason ? reason : "",
                 (int)answer.status, answer.reason ? answer.reason : "nothing");
    return asked;
}

static void expect_refused(struct stage *stage, const char *path, const char *text, enum picture_status status,
                           const char *reason)
{
    picture_ask_free(expect(stage, path, text, status, reason));
}

static char *read_body(struct picture_ask *asked, size_t *count)
{
    struct picture_file *file = picture_ask_answer(asked).file;
    char *body = xcalloc(1, (size_t)file->body_bytes + 1);

    *count = (size_t)file->body_bytes;
    assert_int_equal(pread(file->fd, body, *count, 0), *count);
    return body;
}

static int count_in(void **state, const char *folder)
{
    DIR *entries = opendir(temp_folder_path(state, folder));
    int count = 0;

    while (readdir(entries))
        count++;
    closedir(entries);
    return count - 2;
}

static void picture_is_made_once_and_then_known(void **state)
{
    struct picture_ask *first, *second;
    struct stage stage;
    char *body, *again, key[HASH_TEXT_SIZE + 2];
    size_t count, count_again;

    start(&stage, state, WORKER, LATE_MS);
    first = expect(&stage, "films/a/1.exr", "size=8&exposure=0.5", PICTURE_READY, NULL);
    assert_string_equal(picture_ask_answer(first).file->facts,
                        "{\"width_px\":8,\"height_px\":5,\"file_width_px\":16,\"file_height_px\":9,\"exposure\":0.5}");
    body = read_body(first, &count);
    assert_memory_equal(body, "\x89PNG", 4);
    assert_int_equal(count_in(state, "cache"), 3); // and two folders of makers
    assert_int_equal(count_in(state, "cache/work-0") + count_in(state, "cache/work-1"), 0);
    stop(&stage);
    // Another program finds it, and this one's worker cannot make any.
    start(&stage, state, "/bin/false", LATE_MS);
    second = expect(&stage, "films/a/1.exr", "exposure=0.5&size=8&channel=color", PICTURE_READY, NULL);
    again = read_body(second, &count_again);
    assert_true(count == count_again && !memcmp(body, again, count));
    assert_string_equal(picture_ask_answer(first).key, picture_ask_answer(second).key);
    snprintf(key, sizeof key, "\"%s\"", picture_ask_answer(first).key);
    picture_ask_free(second);
    second = ask(&stage, "films/a/1.exr", "exposure=0.5&size=8", key);
    assert_ptr_equal(hear(&stage), second);
    assert_int_equal(picture_ask_answer(second).status, PICTURE_KNOWN);
    picture_ask_free(second);
    // What is asked otherwise, or of another version of the file, is another picture.
    expect_refused(&stage, "films/a/1.exr", "exposure=0.5&size=9", PICTURE_FAULT, NULL);
    make_frame(state, "films/a/1.exr", "frame=7");
    expect_refused(&stage, "films/a/1.exr", "exposure=0.5&size=8", PICTURE_FAULT, NULL);
    picture_ask_free(first);
    free(body);
    free(again);
    stop(&stage);
}

static void header_is_json(void **state)
{
    struct picture_ask *asked;
    struct stage stage;
    size_t count;
    char *body;

    start(&stage, state, WORKER, LATE_MS);
    asked = expect(&stage, "films/a/1.exr", "header", PICTURE_READY, NULL);
    body = read_body(asked, &count);
    assert_memory_equal(body, "{\"width_px\":16,\"height_px\":9,", 29);
    assert_non_null(strstr(body, "\"marchd:frame\":7"));
    assert_int_equal(body[count - 1], '}');
    free(body);
    picture_ask_free(asked);
    stop(&stage);
}

static void what_is_no_frame_is_refused_with_the_reason(void **state)
{
    struct stage stage;
    char *bytes;
    size_t size;

    start(&stage, state, WORKER, LATE_MS);
    assert_int_equal(mkdir(temp_folder_path(state, "other"), 0700), 0);
    make_frame(state, "other/1.exr", "");
    assert_int_equal(symlink(temp_folder_path(state, "other/1.exr"), temp_folder_path(state, "films/a/link.exr")), 0);
    assert_int_equal(symlink("1.exr", temp_folder_path(state, "films/a/near.exr")), 0);
    assert_int_equal(symlink(temp_folder_path(state, "other"), temp_folder_path(state, "films/b")), 0);
    assert_int_equal(mkfifo(temp_folder_path(state, "films/a/pipe.exr"), 0600), 0);
    assert_true(file_read_text(temp_folder_path(state, "films/a/1.exr"), FILE_LIMIT, &bytes, &size, NULL));
    assert_true(file_replace(temp_folder_path(state, "films/a/short.exr"), bytes, size / 2, NULL));
    assert_true(file_replace(temp_folder_path(state, "films/a/text.exr"), "not a picture", 13, NULL));
    assert_true(file_replace(temp_folder_path(state, "films/a/empty.exr"), "", 0, NULL));
    expect_refused(&stage, "films/a/none.exr", "", PICTURE_ABSENT, "not there");
    expect_refused(&stage, "films/none/1.exr", "", PICTURE_ABSENT, "not there");
    expect_refused(&stage, "other/1.exr", "", PICTURE_ABSENT, "below an output root");
    expect_refused(&stage, "films/../other/1.exr", "", PICTURE_UNREADABLE, "by no link");
    expect_refused(&stage, "films/a/link.exr", "", PICTURE_UNREADABLE, "by no link");
    expect_refused(&stage, "films/a/near.exr", "", PICTURE_UNREADABLE, "by no link");
    expect_refused(&stage, "films/b/1.exr", "", PICTURE_UNREADABLE, "by no link");
    expect_refused(&stage, "films/a/pipe.exr", "", PICTURE_UNREADABLE, "regular file");
    expect_refused(&stage, "films/a", "", PICTURE_UNREADABLE, "regular file");
    expect_refused(&stage, "films/a/short.exr", "", PICTURE_UNREADABLE, "");
    expect_refused(&stage, "films/a/text.exr", "header", PICTURE_UNREADABLE, "");
    expect_refused(&stage, "films/a/empty.exr", "", PICTURE_UNREADABLE, "");
    expect_refused(&stage, "films/a/1.exr", "channel=albedo", PICTURE_WRONG, "expected one of color, A, B, G, R");
    expect_refused(&stage, "films/a/1.exr", "x=16", PICTURE_WRONG, "inside the picture of 16 x 9");
    picture_ask_free(expect(&stage, "films/a/1.exr", "", PICTURE_READY, NULL));
    free(bytes);
    stop(&stage);
}

static void file_that_may_not_be_read_says_whose_matter_that_is(void **state)
{
    struct stage stage;

    if (geteuid() == 0) {
        print_message("root may read every file\n");
        skip();
    }
    start(&stage, state, WORKER, LATE_MS);
    assert_int_equal(chmod(temp_folder_path(state, "films/a/1.exr"), 0), 0);
    expect_refused(&stage, "films/a/1.exr", "", PICTURE_FORBIDDEN, "march-web may not read it");
    stop(&stage);
}

static const char *write_worker(void **state, const char *words)
{
    static char path[512];
    char *text = xasprintf("#!/bin/sh\n%s\n", words);

    snprintf(path, sizeof path, "%s", temp_folder_path(state, "worker"));
    assert_true(file_replace(path, text, strlen(text), NULL));
    assert_int_equal(chmod(path, 0700), 0);
    free(text);
    return path;
}

#define ANSWER "echo '{\"jsonrpc\":\"2.0\",\"id\":1,\"result\":{\"width_px\":1}}' >&3"

// A worker that a file took over may do all of this.
static void worker_that_fails_or_lies_gives_an_error_and_nothing_else(void **state)
{
    static const struct {
        const char *words, *reason;
        enum picture_status status;
    } workers[] = {
        {"exit 3", "ended with status 3", PICTURE_FAULT},
        {"exit 12", "more memory", PICTURE_FAULT},
        {"kill -SEGV $$", "signal 11", PICTURE_FAULT},
        {"echo nonsense >&3; exit 0", "status 0", PICTURE_FAULT},
        {"head -c 5000000 /dev/zero >&3; sleep 100000", "", PICTURE_FAULT},
        {"echo '{\"jsonrpc\":\"2.0\",\"id\":1,\"result\":7}' >&3; sleep 100000", "no answer", PICTURE_FAULT},
        {"echo '{\"jsonrpc\":\"2.0\",\"id\":1,' >&3; sleep 100000", "", PICTURE_FAULT},
        {ANSWER "; sleep 100000", "made no picture", PICTURE_FAULT},
        {"ln -s /etc/passwd ../cache/work-0/made; ln -s /etc/passwd ../cache/work-1/made; " ANSWER "; sleep 100000",
         "made no picture", PICTURE_FAULT},
        {"exec 3>&-; sleep 100000", "signal 9", PICTURE_FAULT},
        {"while :; do echo '{\"jsonrpc\":\"2.0\",\"method\":\"worker.beat\"}'; sleep 0.01; done >&3", "longer than",
         PICTURE_SLOW},
    };

    for (size_t i = 0; i < sizeof workers / sizeof workers[0]; i++) {
        struct stage stage;

        start(&stage, state, write_worker(state, workers[i].words),
              workers[i].status == PICTURE_SLOW ? SOON_MS : LATE_MS);
        assert_int_equal(chdir(temp_folder_path(state, "films")), 0);
        expect_refused(&stage, "films/a/1.exr", "", workers[i].status, workers[i].reason);
        assert_int_equal(count_in(state, "cache"), 2);
        stop(&stage);
        assert_int_equal(waitpid(-1, NULL, WNOHANG), -1); // none is left
        assert_int_equal(errno, ECHILD);
    }
    assert_int_equal(chdir("/"), 0);
}

static void worker_is_fenced_in_with_one_file_and_a_folder_of_its_own(void **state)
{
    struct stage stage;
    char *words = xasprintf("head -n 1 <&3 >%s; exit 3", temp_folder_path(state, "fence"));
    char *text, *expected;

    start(&stage, state, write_worker(state, words), LATE_MS);
    expect_refused(&stage, "films/a/1.exr", "", PICTURE_FAULT, "status 3");
    assert_true(file_read_text(temp_folder_path(state, "fence"), FILE_LIMIT, &text, NULL, NULL));
    // Of an input's root itself a fence opens only the files of the input's name.
    expected = xasprintf("\"params\":{\"inputs\":[{\"place\":\"the frame\",\"root\":\"%s/films/a\",\"folder\":\"\","
                         "\"path\":\"%s/films/a/1.exr\"}],\"output\":{\"root\":\"%s/cache/work-",
                         (char *)*state, (char *)*state, (char *)*state);
    if (!strstr(text, expected)) fail_msg("expected %s, got %s", expected, text);
    free(expected);
    free(text);
    free(words);
    stop(&stage);
}

static void fault_is_not_tried_again_at_once(void **state)
{
    struct stage stage;
    char *words = xasprintf("echo >>%s; exit 3", temp_folder_path(state, "starts"));
    struct stat status;

    start(&stage, state, write_worker(state, words), LATE_MS);
    for (int i = 0; i < 5; i++)
        expect_refused(&stage, "films/a/1.exr", "", PICTURE_FAULT, "status 3");
    assert_int_equal(stat(temp_folder_path(state, "starts"), &status), 0);
    assert_int_equal(status.st_size, 1);
    free(words);
    stop(&stage);
}

// Two pictures are being made when a third is asked for and given up; the workers end when the file `go` is there.
static void who_goes_away_is_not_waited_for(void **state)
{
    struct picture_ask *first, *second, *third, *same;
    struct stage stage;
    char *go = xstrdup(temp_folder_path(state, "go"));
    char *words =
        xasprintf("echo >>%s; until [ -e %s ]; do sleep 0.01; done; exit 3", temp_folder_path(state, "starts"), go);
    struct stat status = {0};

    start(&stage, state, write_worker(state, words), LATE_MS);
    first = ask(&stage, "films/a/1.exr", "size=1", NULL);
    second = ask(&stage, "films/a/1.exr", "size=2", NULL);
    while (status.st_size < 2) {
        usleep(1000);
        (void)stat(temp_folder_path(state, "starts"), &status);
    }
    third = ask(&stage, "films/a/1.exr", "size=3", NULL);
    same = ask(&stage, "films/a/1.exr", "size=1", NULL);
    usleep(20000); // most times they wait by then; it makes no difference to the result
    pictures_drop(stage.pictures, third);
    pictures_drop(stage.pictures, second);
    assert_true(file_replace(go, "x", 1, NULL));
    for (int i = 0; i < 2; i++) {
        struct picture_ask *answered = hear(&stage);

        assert_true(answered == first || answered == same);
        assert_int_equal(picture_ask_answer(answered).status, PICTURE_FAULT);
        picture_ask_free(answered);
    }
    assert_int_equal(stat(temp_folder_path(state, "starts"), &status), 0);
    assert_int_equal(status.st_size, 2);
    free(words);
    free(go);
    stop(&stage);
}

static void too_many_questions_are_refused_and_the_rest_is_forgotten_at_the_end(void **state)
{
    struct stage stage;
    int busy = 0;

    start(&stage, state, write_worker(state, "sleep 100000"), LATE_MS);
    for (int i = 0; i < 1000; i++) {
        char text[32];

        snprintf(text, sizeof text, "exposure=%d.%d", i % 50, i);
        ask(&stage, "films/a/1.exr", text, NULL);
    }
    // One user may wait for 64 pictures.
    for (; busy < 1000 - 64; busy++) {
        struct picture_ask *answered = hear(&stage);

        assert_int_equal(picture_ask_answer(answered).status, PICTURE_BUSY);
        picture_ask_free(answered);
    }
    assert_null(pictures_take_answer(stage.pictures));
    stop(&stage);
}

int main(int argc, char *argv[])
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, temp_folder_create, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        TEST(picture_is_made_once_and_then_known),
        TEST(header_is_json),
        TEST(what_is_no_frame_is_refused_with_the_reason),
        TEST(file_that_may_not_be_read_says_whose_matter_that_is),
        TEST(worker_that_fails_or_lies_gives_an_error_and_nothing_else),
        TEST(worker_is_fenced_in_with_one_file_and_a_folder_of_its_own),
        TEST(fault_is_not_tried_again_at_once),
        TEST(who_goes_away_is_not_waited_for),
        TEST(too_many_questions_are_refused_and_the_rest_is_forgotten_at_the_end),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
