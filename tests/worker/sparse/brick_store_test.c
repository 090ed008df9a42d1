// SPDX-License-Identifier: Apache-2.0
#include "worker/sparse/brick_store.h"

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/scene/scene.h"
#include "tests/support/nanovdb_maker.h"
#include "tests/support/temp_folder.h"
#include "worker/sparse/brick_atlas.h"
#include "worker/volume/volume_memory.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

static float value_of(const int voxel[3])
{
    return 1;
}

// Writes a grid of `side` active voxels along x, so that files differ.
static void write_grid(const char *path, int side)
{
    struct nanovdb_params params = {
        .name = "density", .map = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, .max = {side - 1, 0, 0}, .value = value_of};
    struct nanovdb_made made;
    struct error error = {{0}};

    nanovdb_make(&made, &params);
    if (!file_write_atomic(path, made.bytes, made.size_bytes, &error)) fail_msg("%s", error.message);
    free(made.bytes);
}

static int side_of(const struct brick_volume *volume)
{
    return volume->atlas->voxel_max[0] - volume->atlas->voxel_min[0] + 1;
}

static const struct brick_volume *take(struct brick_store *store, const char *path)
{
    struct error error = {{0}};
    const struct brick_volume *volume = brick_store_take(store, &(struct brick_source){.path = path}, &error);

    if (!volume) fail_msg("%s", error.message);
    return volume;
}

static void a_file_is_read_as_it_is_now(void **state)
{
    struct brick_store *store = brick_store_create();
    const char *path = temp_folder_path(state, "a.nvdb");
    const struct brick_volume *volume;
    char hash[HASH_TEXT_SIZE];

    write_grid(path, 3);
    volume = take(store, path);
    assert_int_equal(side_of(volume), 3);
    memcpy(hash, volume->hash, sizeof hash);
    brick_store_release(store, volume);
    write_grid(path, 5);
    volume = take(store, path);
    assert_int_equal(side_of(volume), 5);
    assert_string_not_equal(volume->hash, hash);
    brick_store_release(store, volume);
    brick_store_destroy(store);
}

// Waits until a file counts as settled, two seconds after it was written.
static void what_is_at_hand_is_not_read_again(void **state)
{
    struct brick_store *store = brick_store_create();
    const char *path = temp_folder_path(state, "a.nvdb");
    const struct brick_volume *first, *second;

    write_grid(path, 3);
    nanosleep(&(struct timespec){2, 300000000}, NULL);
    first = take(store, path);
    second = take(store, path);
    assert_ptr_equal(first, second);
    brick_store_release(store, first);
    brick_store_release(store, second);
    second = take(store, path);
    assert_ptr_equal(first, second);
    brick_store_release(store, second);
    // A file that was read ahead is the same object when it is taken.
    brick_store_expect(store, &(struct brick_source){.path = path});
    second = take(store, path);
    assert_ptr_equal(first, second);
    brick_store_release(store, second);
    brick_store_destroy(store);
}

static void files_read_ahead_are_there_when_taken(void **state)
{
    struct brick_store *store = brick_store_create();

    for (int i = 0; i < 6; ++i) {
        char name[] = "0.nvdb";

        name[0] = (char)('0' + i);
        write_grid(temp_folder_path(state, name), 2 + i);
    }
    for (int i = 0; i < 6; ++i) {
        char name[] = "0.nvdb", next[] = "0.nvdb";
        const struct brick_volume *volume;

        name[0] = (char)('0' + i);
        next[0] = (char)('0' + (i + 1) % 6);
        volume = take(store, temp_folder_path(state, name));
        brick_store_expect(store, &(struct brick_source){.path = temp_folder_path(state, next)});
        assert_int_equal(side_of(volume), 2 + i);
        brick_store_release(store, volume);
    }
    brick_store_destroy(store); // while one may still be read
}

// A failure while reading ahead is not kept.
static void a_file_that_was_missing_ahead_may_be_there_later(void **state)
{
    struct brick_store *store = brick_store_create();
    const char *path = temp_folder_path(state, "late.nvdb");
    const struct brick_volume *volume;
    struct error error = {{0}};

    brick_store_expect(store, &(struct brick_source){.path = path});
    assert_null(brick_store_take(store, &(struct brick_source){.path = path}, &error));
    assert_non_null(strstr(error.message, "late.nvdb: cannot open: No such file"));
    brick_store_expect(store, &(struct brick_source){.path = path});
    nanosleep(&(struct timespec){0, 100000000}, NULL);
    write_grid(path, 4);
    volume = take(store, path);
    assert_int_equal(side_of(volume), 4);
    brick_store_release(store, volume);
    brick_store_destroy(store);
}

static void what_is_wrong_names_the_file(void **state)
{
    struct brick_store *store = brick_store_create();
    const char *path = temp_folder_path(state, "bad.nvdb");
    struct brick_source source = {.path = path};
    struct error error = {{0}};

    assert_true(file_write_atomic(path, "NanoVDB", 7, &error));
    assert_null(brick_store_take(store, &source, &error));
    assert_non_null(strstr(error.message, "bad.nvdb: segment: expected 16 bytes at byte 0, got 7"));
    write_grid(path, 2);
    source.glow_name = "temperature";
    assert_null(brick_store_take(store, &source, &error));
    assert_non_null(strstr(error.message, "bad.nvdb: no grid is named \"temperature\"; there are \"density\" (float)"));
    brick_store_destroy(store);
}

// The same file with a transfer function where 1 has no opacity and one where 0 has some.
static void bricks_follow_the_transfer_function(void **state)
{
    static const struct scene_transfer_point hollow[] = {{0.5, {0, 0, 0, 0.5}}, {1, {0, 0, 0, 0}}},
                                             solid[] = {{0, {0, 0, 0, 0}}, {1, {0, 0, 0, 0.5}}};
    struct brick_store *store = brick_store_create();
    const char *path = temp_folder_path(state, "a.nvdb");
    struct error error = {{0}};
    const struct brick_volume *plain, *filled, *solid_too;

    write_grid(path, 64);
    plain = take(store, path);
    solid_too =
        brick_store_take(store, &(struct brick_source){.path = path, .points = solid, .point_count = 2}, &error);
    filled = brick_store_take(store, &(struct brick_source){.path = path, .points = hollow, .point_count = 2}, &error);
    assert_true(plain && filled && solid_too);
    assert_int_equal(solid_too->atlas->size_bytes, plain->atlas->size_bytes);
    assert_int_equal(filled->atlas->index[0][3], 0);
    assert_true(filled->atlas->size_bytes >= plain->atlas->size_bytes);
    brick_store_release(store, plain);
    brick_store_release(store, filled);
    brick_store_release(store, solid_too);
    brick_store_destroy(store);
}

// Opening a pipe would wait for a writer; reading more than the memory would end the process.
static void what_cannot_be_a_grid_is_not_waited_for(void **state)
{
    struct brick_store *store = brick_store_create();
    const char *pipe = temp_folder_path(state, "pipe.nvdb"), *huge = temp_folder_path(state, "huge.nvdb");
    struct brick_source source = {.path = pipe};
    struct error error = {{0}};

    assert_int_equal(mkfifo(pipe, 0600), 0);
    brick_store_expect(store, &source);
    alarm(600);
    assert_null(brick_store_take(store, &source, &error));
    alarm(0);
    assert_non_null(strstr(error.message, "pipe.nvdb: expected a file, got a pipe or a device"));
    source.path = huge;
    assert_true(file_write_atomic(huge, "", 0, &error));
    assert_int_equal(truncate(huge, volume_memory_limit() + 1), 0);
    assert_null(brick_store_take(store, &source, &error));
    assert_non_null(strstr(error.message, "huge.nvdb: needs "));
    assert_non_null(strstr(error.message, " GiB are available"));
    brick_store_destroy(store);
}

// Writes a script that stands in for nanovdb_convert.
static void write_converter(void **state, const char *body)
{
    const char *path = temp_folder_path(state, "nanovdb_convert");
    struct error error = {{0}};

    assert_true(file_write_atomic(path, body, strlen(body), &error));
    assert_int_equal(chmod(path, 0700), 0);
}

static void openvdb_files_go_through_the_converter(void **state)
{
    struct brick_store *store = brick_store_create();
    const char *path = temp_folder_path(state, "a.vdb");
    char *search = strdup(getenv("PATH")), *only_here = strdup(*state), *here = NULL;
    struct error error = {{0}};

    assert_true(asprintf(&here, "%s:%s", only_here, search) > 0);
    write_grid(path, 6);
    setenv("PATH", here, 1);
    write_converter(state, "#!/bin/sh\ncp \"$2\" \"$3\"\n");
    {
        const struct brick_volume *volume = take(store, path);

        assert_int_equal(side_of(volume), 6);
        brick_store_release(store, volume);
    }
    write_converter(state, "#!/bin/sh\nexit 3\n");
    assert_null(brick_store_take(store, &(struct brick_source){.path = path}, &error));
    assert_non_null(strstr(error.message, "a.vdb: nanovdb_convert failed with exit status 3"));
    remove(temp_folder_path(state, "nanovdb_convert"));
    setenv("PATH", only_here, 1);
    assert_null(brick_store_take(store, &(struct brick_source){.path = path}, &error));
    setenv("PATH", search, 1);
    assert_non_null(strstr(error.message, "install libnanovdb-tools"));
    brick_store_destroy(store);
    free(search);
    free(here);
    free(only_here);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_file_is_read_as_it_is_now, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(what_is_at_hand_is_not_read_again, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(files_read_ahead_are_there_when_taken, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_file_that_was_missing_ahead_may_be_there_later, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(what_is_wrong_names_the_file, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(bricks_follow_the_transfer_function, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(what_cannot_be_a_grid_is_not_waited_for, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(openvdb_files_go_through_the_converter, temp_folder_create,
                                        temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
