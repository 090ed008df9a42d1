// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/picture_cache.h"

#include "core/base/error.h"
#include "core/base/file.h"
#include "tests/support/temp_folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/stat.h>
#include <time.h>

#include <cmocka.h>

enum { BODY = 1000, FILE_BYTES = BODY + 512 };

static void open_cache(void **state, struct picture_cache *cache, uint64_t limit)
{
    struct error error = {0};

    if (!picture_cache_open(cache, *state, limit, &error)) fail_msg("%s", error.message);
}

static const char *format_key(int number)
{
    static char key[HASH_TEXT_SIZE];

    snprintf(key, sizeof key, "%04x%028d", (unsigned)number % 3, number); // few buckets
    return key;
}

// What a worker made: BODY bytes of a letter.
static void make(void **state, int number)
{
    char body[BODY];

    memset(body, 'a' + number % 26, sizeof body);
    assert_true(file_replace(temp_folder_path(state, "work/made"), body, sizeof body, NULL));
}

static void put(void **state, struct picture_cache *cache, int number)
{
    struct picture_file file;
    struct error error = {0};
    int work_fd;

    (void)mkdir(temp_folder_path(state, "work"), 0700);
    work_fd = open(temp_folder_path(state, "work"), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    make(state, number);
    if (!picture_cache_take(cache, format_key(number), "{\"width_px\":5}", work_fd, "made", &file, &error))
        fail_msg("%s", error.message);
    assert_int_equal(file.body_bytes, BODY);
    picture_file_close(&file);
    close(work_fd);
    assert_int_equal(access(temp_folder_path(state, "work/made"), F_OK), -1);
}

static bool has(struct picture_cache *cache, int number)
{
    struct picture_file file;
    char body[BODY];

    if (!picture_cache_find(cache, format_key(number), &file)) return false;
    assert_int_equal(file.body_bytes, BODY);
    assert_string_equal(file.facts, "{\"width_px\":5}");
    assert_int_equal(pread(file.fd, body, BODY, 0), BODY);
    for (int i = 0; i < BODY; i++)
        assert_int_equal(body[i], 'a' + number % 26);
    picture_file_close(&file);
    return true;
}

static int count_files(void **state)
{
    DIR *folder = opendir(*state);
    struct dirent *entry;
    int count = 0;

    while ((entry = readdir(folder)))
        count += entry->d_type == DT_REG;
    closedir(folder);
    return count;
}

static void what_was_put_in_is_found_and_nothing_else(void **state)
{
    struct picture_cache cache;

    open_cache(state, &cache, 1 << 20);
    for (int i = 0; i < 20; i++)
        put(state, &cache, i);
    for (int i = 0; i < 20; i++)
        assert_true(has(&cache, i));
    assert_false(has(&cache, 20));
    put(state, &cache, 5); // again
    assert_true(has(&cache, 5));
    assert_int_equal(cache.bytes, 20 * FILE_BYTES);
    picture_cache_close(&cache);
}

static void least_recently_used_goes_first_and_the_limit_holds(void **state)
{
    struct picture_cache cache;

    open_cache(state, &cache, 4 * FILE_BYTES);
    for (int i = 0; i < 4; i++)
        put(state, &cache, i);
    assert_true(has(&cache, 0));
    put(state, &cache, 4);
    assert_true(has(&cache, 0));
    assert_false(has(&cache, 1));
    assert_int_equal(count_files(state), 4);
    picture_cache_close(&cache);
    open_cache(state, &cache, 2 * FILE_BYTES); // the limit was lowered
    assert_int_equal(count_files(state), 2);
    assert_true(has(&cache, 0) && has(&cache, 4)); // the order outlives the program
    picture_cache_close(&cache);
}

static void picture_larger_than_the_cache_is_given_and_not_kept(void **state)
{
    struct picture_cache cache;

    open_cache(state, &cache, FILE_BYTES - 1);
    put(state, &cache, 1);
    assert_false(has(&cache, 1));
    assert_int_equal(count_files(state), 0);
    picture_cache_close(&cache);
}

static void what_is_removed_stays_readable_until_it_is_closed(void **state)
{
    struct picture_cache cache;
    struct picture_file file;
    char byte;

    open_cache(state, &cache, FILE_BYTES);
    put(state, &cache, 1);
    assert_true(picture_cache_find(&cache, format_key(1), &file));
    put(state, &cache, 2);
    assert_false(has(&cache, 1));
    assert_int_equal(pread(file.fd, &byte, 1, BODY - 1), 1);
    assert_int_equal(byte, 'b');
    picture_file_close(&file);
    picture_cache_close(&cache);
}

// As a kill, a crash of the machine or a stranger might leave the folder.
static void half_and_changed_files_are_no_pictures(void **state)
{
    struct picture_cache cache;
    char path[512];
    int fd;

    open_cache(state, &cache, 1 << 20);
    for (int i = 0; i < 4; i++)
        put(state, &cache, i);
    picture_cache_close(&cache);
    assert_int_equal(truncate(temp_folder_path(state, format_key(0)), BODY), 0);
    assert_int_equal(truncate(temp_folder_path(state, format_key(1)), 5), 0);
    fd = open(temp_folder_path(state, format_key(2)), O_WRONLY | O_CLOEXEC);
    assert_int_equal(pwrite(fd, "\0\0\0", 3, 500), 3);
    close(fd);
    assert_true(file_replace(temp_folder_path(state, "stranger"), "x", 1, NULL));
    snprintf(path, sizeof path, "%s", temp_folder_path(state, format_key(9)));
    assert_int_equal(symlink("/etc/passwd", path), 0);
    open_cache(state, &cache, 1 << 20);
    assert_false(has(&cache, 0) || has(&cache, 1) || has(&cache, 2) || has(&cache, 9));
    assert_true(has(&cache, 3));
    assert_int_equal(count_files(state), 1);
    assert_int_equal(cache.bytes, FILE_BYTES);
    picture_cache_close(&cache);
}

static void what_is_no_file_is_not_taken(void **state)
{
    struct picture_cache cache;
    struct picture_file file;
    int work_fd;

    open_cache(state, &cache, 1 << 20);
    assert_int_equal(mkdir(temp_folder_path(state, "work"), 0700), 0);
    work_fd = open(temp_folder_path(state, "work"), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    assert_int_equal(symlink("/etc/passwd", temp_folder_path(state, "work/link")), 0);
    assert_int_equal(mkfifo(temp_folder_path(state, "work/pipe"), 0600), 0);
    assert_true(file_replace(temp_folder_path(state, "work/empty"), "", 0, NULL));
    assert_false(picture_cache_take(&cache, format_key(1), "{}", work_fd, "link", &file, NULL));
    assert_false(picture_cache_take(&cache, format_key(1), "{}", work_fd, "pipe", &file, NULL));
    assert_false(picture_cache_take(&cache, format_key(1), "{}", work_fd, "empty", &file, NULL));
    assert_false(picture_cache_take(&cache, format_key(1), "{}", work_fd, "none", &file, NULL));
    assert_int_equal(file.fd, -1);
    close(work_fd);
    picture_cache_close(&cache);
}

int main(int argc, char *argv[])
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, temp_folder_create, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        TEST(what_was_put_in_is_found_and_nothing_else),
        TEST(least_recently_used_goes_first_and_the_limit_holds),
        TEST(picture_larger_than_the_cache_is_given_and_not_kept),
        TEST(what_is_removed_stays_readable_until_it_is_closed),
        TEST(half_and_changed_files_are_no_pictures),
        TEST(what_is_no_file_is_not_taken),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
