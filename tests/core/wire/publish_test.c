// SPDX-License-Identifier: Apache-2.0
#include "core/wire/publish.h"

#include "core/base/error.h"
#include "core/base/file.h"
#include "tests/support/temp_folder.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>

#include <cmocka.h>

static const char part[] = "x.0001.exr.1.1.1.part";
static const char name[] = "x.0001.exr";

static bool is_rename_silent;

// As a network file system whose answer was lost: it is done, and the second try finds nothing.
int renameat(int from_fd, const char *from, int to_fd, const char *to)
{
    int result = (int)syscall(SYS_renameat2, from_fd, from, to_fd, to, 0);

    if (result != 0 || !is_rename_silent) return result;
    errno = ENOENT;
    return -1;
}

static int open_folder(void *const *state)
{
    int fd = open(*state, O_RDONLY | O_DIRECTORY);

    assert_true(fd >= 0);
    return fd;
}

// Writes `text` to `file` and returns what a worker would report about it.
static struct published_file write_file(void *const *state, const char *file, const char *text)
{
    struct published_file written = {.size_bytes = strlen(text)};
    struct stat status;

    assert_true(file_write_atomic(temp_folder_path(state, file), text, strlen(text), NULL));
    assert_int_equal(stat(temp_folder_path(state, file), &status), 0);
    written.inode = status.st_ino;
    hash_bytes(text, strlen(text), written.hash);
    return written;
}

static bool exists(void *const *state, const char *file)
{
    struct stat status;

    return lstat(temp_folder_path(state, file), &status) == 0;
}

static void file_that_was_found_is_looked_at(void **state)
{
    struct published_file found = write_file(state, name, "picture"), other = write_file(state, part, "another");
    struct error error = {0};
    int fd = open_folder(state);

    found.inode = 0; // whatever it is
    assert_true(publish_check_found(fd, name, &found, NULL));
    assert_false(publish_check_found(fd, part, &found, &error)); // of that size
    assert_non_null(strstr(error.message, "expected a file with the hash"));
    other.size_bytes++;
    assert_false(publish_check_found(fd, part, &other, &error));
    assert_non_null(strstr(error.message, "expected a file of 8 bytes, got one of 7"));
    assert_false(publish_check_found(fd, "x.0002.exr", &found, &error));
    assert_int_equal(symlinkat(name, fd, "x.0003.exr"), 0);
    assert_false(publish_check_found(fd, "x.0003.exr", &found, &error));
    assert_int_equal(mkdirat(fd, "x.0004.exr", 0700), 0);
    found.size_bytes = 4096;
    assert_false(publish_check_found(fd, "x.0004.exr", &found, &error));
    close(fd);
}

static void part_gets_its_name(void **state)
{
    struct published_file expected = write_file(state, part, "picture");
    int fd = open_folder(state);
    char *text;

    assert_true(publish_file(fd, part, name, &expected, NULL));
    assert_true(publish_sync(fd, NULL));
    assert_false(exists(state, part));
    assert_true(file_read_text(temp_folder_path(state, name), 100, &text, NULL, NULL));
    assert_string_equal(text, "picture");
    free(text);
    close(fd);
}

static void rename_that_was_done_is_believed(void **state)
{
    struct published_file expected = write_file(state, part, "picture");
    struct error error = {0};
    int fd = open_folder(state);

    is_rename_silent = true;
    assert_true(publish_file(fd, part, name, &expected, &error));
    is_rename_silent = false;
    assert_true(exists(state, name));
    assert_false(exists(state, part));
    close(fd);
}

struct late_part {
    void *const *state;
    struct published_file file;
};

static void *write_later(void *argument)
{
    const struct late_part *late = argument;
    const struct timespec pause = {.tv_nsec = 50 * 1000 * 1000};

    nanosleep(&pause, NULL);
    (void)rename(temp_folder_path(late->state, "hidden"), temp_folder_path(late->state, part));
    return NULL;
}

static void part_that_is_seen_late_is_awaited(void **state)
{
    struct late_part late = {.state = state, .file = write_file(state, "hidden", "picture")};
    int fd = open_folder(state);
    pthread_t writer;
    bool is_published;

    publish_await(fd, part, &late.file, 0);
    assert_false(publish_file(fd, part, name, &late.file, NULL));
    write_file(state, part, "an older one");
    assert_int_equal(pthread_create(&writer, NULL, write_later, &late), 0);
    publish_await(fd, part, &late.file, 60 * 1000);
    is_published = publish_file(fd, part, name, &late.file, NULL);
    pthread_join(writer, NULL);
    assert_true(is_published);
    close(fd);
}

static void older_file_is_replaced(void **state)
{
    struct published_file expected = write_file(state, part, "new picture");
    int fd = open_folder(state);

    write_file(state, name, "old");
    assert_true(publish_file(fd, part, name, &expected, NULL));
    assert_int_equal(publish_settle(fd, part, name, &expected), PUBLISH_DONE);
    close(fd);
}

static void other_size_or_inode_is_refused(void **state)
{
    struct published_file expected = write_file(state, part, "picture");
    struct published_file wrong = expected;
    int fd = open_folder(state);
    struct error error = {0};

    wrong.size_bytes++;
    assert_false(publish_file(fd, part, name, &wrong, &error));
    assert_non_null(strstr(error.message, "of 8 bytes, got inode"));
    wrong = expected;
    wrong.inode++;
    assert_false(publish_file(fd, part, name, &wrong, NULL));
    assert_true(exists(state, part));
    assert_false(exists(state, name));
    close(fd);
}

static void missing_part_is_refused(void **state)
{
    struct published_file expected = {.inode = 1};
    int fd = open_folder(state);
    struct error error = {0};

    assert_false(publish_file(fd, part, name, &expected, &error));
    assert_string_equal(error.message, "cannot publish x.0001.exr.1.1.1.part: No such file or directory");
    close(fd);
}

static void link_in_place_of_the_part_is_refused(void **state)
{
    struct published_file expected = write_file(state, "real", "picture");
    int fd = open_folder(state);
    struct error error = {0};

    assert_int_equal(symlink("real", temp_folder_path(state, part)), 0);
    assert_false(publish_file(fd, part, name, &expected, &error));
    assert_string_equal(error.message, "x.0001.exr.1.1.1.part: expected a file, got a symbolic link");
    assert_int_equal(publish_settle(fd, part, name, &expected), PUBLISH_LOST);
    assert_false(exists(state, name));
    close(fd);
}

static void link_in_place_of_the_name_is_refused(void **state)
{
    struct published_file expected = write_file(state, part, "picture");
    int fd = open_folder(state);
    struct error error = {0};

    assert_int_equal(symlink(part, temp_folder_path(state, name)), 0);
    assert_false(publish_file(fd, part, name, &expected, &error));
    assert_string_equal(error.message, "x.0001.exr: expected a file or nothing, got a symbolic link");
    assert_int_equal(publish_settle(fd, part, name, &expected), PUBLISH_PENDING);
    assert_true(exists(state, part));
    close(fd);
}

static void folder_in_place_of_the_name_is_refused(void **state)
{
    struct published_file expected = write_file(state, part, "picture");
    int fd = open_folder(state);
    struct error error = {0};

    assert_int_equal(mkdir(temp_folder_path(state, name), 0700), 0);
    assert_false(publish_file(fd, part, name, &expected, &error));
    assert_string_equal(error.message, "x.0001.exr: expected a file or nothing, got something else");
    close(fd);
}

static void crash_before_the_rename_leaves_it_pending(void **state)
{
    struct published_file expected = write_file(state, part, "picture");
    int fd = open_folder(state);

    assert_int_equal(publish_settle(fd, part, name, &expected), PUBLISH_PENDING);
    write_file(state, name, "picture");
    assert_int_equal(publish_settle(fd, part, name, &expected), PUBLISH_PENDING);
    close(fd);
}

static void crash_after_the_rename_is_done(void **state)
{
    struct published_file expected = write_file(state, part, "picture");
    int fd = open_folder(state);

    assert_true(publish_file(fd, part, name, &expected, NULL));
    assert_int_equal(publish_settle(fd, part, name, &expected), PUBLISH_DONE);
    close(fd);
}

static void other_bytes_of_the_same_size_are_lost(void **state)
{
    struct published_file expected = write_file(state, part, "picture");
    int fd = open_folder(state);
    int written = open(temp_folder_path(state, part), O_WRONLY);

    assert_true(file_write_all(written, "PICTURE", 7, NULL));
    close(written);
    assert_int_equal(publish_settle(fd, part, name, &expected), PUBLISH_LOST);
    close(fd);
}

static void other_bytes_under_the_name_are_lost(void **state)
{
    struct published_file expected = write_file(state, part, "picture");
    int fd = open_folder(state);
    int written;

    assert_true(publish_file(fd, part, name, &expected, NULL));
    written = open(temp_folder_path(state, name), O_WRONLY);
    assert_true(file_write_all(written, "PICTURE", 7, NULL));
    close(written);
    assert_int_equal(publish_settle(fd, part, name, &expected), PUBLISH_LOST);
    close(fd);
}

static void neither_name_is_lost(void **state)
{
    struct published_file expected = {.inode = 1, .size_bytes = 7};
    int fd = open_folder(state);

    assert_int_equal(publish_settle(fd, part, name, &expected), PUBLISH_LOST);
    write_file(state, name, "another");
    assert_int_equal(publish_settle(fd, part, name, &expected), PUBLISH_LOST);
    close(fd);
}

int main(void)
{
#define WITH_FOLDER(test) cmocka_unit_test_setup_teardown(test, temp_folder_create, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        WITH_FOLDER(file_that_was_found_is_looked_at),
        WITH_FOLDER(part_gets_its_name),
        WITH_FOLDER(rename_that_was_done_is_believed),
        WITH_FOLDER(part_that_is_seen_late_is_awaited),
        WITH_FOLDER(older_file_is_replaced),
        WITH_FOLDER(other_size_or_inode_is_refused),
        WITH_FOLDER(missing_part_is_refused),
        WITH_FOLDER(link_in_place_of_the_part_is_refused),
        WITH_FOLDER(link_in_place_of_the_name_is_refused),
        WITH_FOLDER(folder_in_place_of_the_name_is_refused),
        WITH_FOLDER(crash_before_the_rename_leaves_it_pending),
        WITH_FOLDER(crash_after_the_rename_is_done),
        WITH_FOLDER(other_bytes_of_the_same_size_are_lost),
        WITH_FOLDER(other_bytes_under_the_name_are_lost),
        WITH_FOLDER(neither_name_is_lost),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
