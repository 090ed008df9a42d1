// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/volume.h"

#include "core/base/error.h"
#include "tests/support/assert_near.h"
#include "tests/support/temp_folder.h"
#include "tests/support/volume_check.h"
#include "tests/support/volume_maker.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <sys/stat.h>

#include <cmocka.h>

static const int size[3] = {5, 4, 3};

static void name_says_size_and_type(void **state)
{
    static const struct {
        const char *name;
        enum volume_stored stored;
        enum volume_type type;
    } cases[] = {
        {"ball_5x4x3xuint8.raw", VOLUME_STORED_UINT8, VOLUME_UINT8},
        {"2x2x2xuint8 7_5x4x3_uint16.RAW", VOLUME_STORED_UINT16, VOLUME_UINT16},
        {"ball_5x4x3xint16.raw", VOLUME_STORED_INT16, VOLUME_INT16},
        {"ball_5x4x3_float32.raw", VOLUME_STORED_FLOAT32, VOLUME_FLOAT32},
    };

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct volume_source source = {.path = temp_folder_path(state, cases[i].name)};
        struct volume *volume;

        volume_maker_write_raw(source.path, size, cases[i].stored, false);
        volume = volume_check_open(&source);
        assert_memory_equal(volume->size, size, sizeof size);
        assert_int_equal(volume->type, cases[i].type);
        volume_check_voxels(volume);
        volume_close(volume);
    }
}

static void keys_win_over_the_name(void **state)
{
    struct volume_source source = {
        .path = temp_folder_path(state, "9x9x9xuint8.raw"),
        .raw = {.size = {5, 4, 3}, .type = SCENE_VOXEL_INT16, .has_type = true, .is_big_endian = true, .skip_bytes = 7},
    };
    size_t size_bytes;
    unsigned char *voxels = volume_maker_voxels(size, VOLUME_STORED_INT16, true, &size_bytes);
    unsigned char bytes[7 + 120];
    struct volume *volume;

    assert_int_equal(size_bytes, 120);
    memset(bytes, 0xee, 7);
    memcpy(bytes + 7, voxels, 120);
    volume_maker_write(source.path, bytes, sizeof bytes);
    volume = volume_check_open(&source);
    volume_check_voxels(volume);
    volume_close(volume);
    free(voxels);
}

static void longest_side_is_a_metre_about_the_origin(void **state)
{
    struct volume_source source = {.path = temp_folder_path(state, "5x4x3xuint8.raw")};
    const double expected[12] = {0.2, 0, 0, -0.4, 0, 0.2, 0, -0.3, 0, 0, 0.2, -0.2};
    const double spaced[12] = {2, 0, 0, -4, 0, 3, 0, -4.5, 0, 0, 4, -4};
    struct volume *volume;

    volume_maker_write_raw(source.path, size, VOLUME_STORED_UINT8, false);
    volume = volume_check_open(&source);
    for (int i = 0; i < 12; i++)
        assert_near(volume->index_to_world[i], expected[i], 1e-15);
    volume_close(volume);

    memcpy(source.spacing, ((double[3]){2, 3, 4}), sizeof source.spacing);
    volume = volume_check_open(&source);
    for (int i = 0; i < 12; i++) // the rounding of 0.2's multiples
        assert_near(volume->index_to_world[i], spaced[i], 1e-14);
    volume_close(volume);
}

static void bad_files_are_refused(void **state)
{
    struct volume_source source = {.path = temp_folder_path(state, "x_5x4x3xuint8.raw")};
    const char *other = temp_folder_path(state, "other.raw");

    volume_check_refused(&source, NULL, "cannot open: No such file");
    mkdir(source.path, 0777);
    volume_check_refused(&source, NULL, "got a folder");
    rmdir(source.path);
    mkfifo(source.path, 0666);
    volume_check_refused(&source, NULL, "got a pipe or a device");
    unlink(source.path);
    volume_maker_write(source.path, "0123456789", 10);
    volume_check_refused(&source, NULL, "expected 5 x 4 x 3 voxels of uint8, 60 bytes, got 10 bytes");
    source.spacing[0] = -1;
    volume_maker_write_raw(source.path, size, VOLUME_STORED_UINT8, false);
    volume_check_refused(&source, NULL, "spacing: expected sides of voxels above 0 m, got -1 along i");
    source.path = other;
    volume_check_refused(&source, NULL, "expected \"size\" or a name");
}

static void wrong_length_says_what_would_fit(void **state)
{
    struct volume_source source = {
        .path = temp_folder_path(state, "a.raw"),
        .raw = {.size = {5, 4, 3}, .type = SCENE_VOXEL_UINT8, .has_type = true},
    };
    static const char bytes[128];

    volume_maker_write(source.path, bytes, 120);
    volume_check_refused(
        &source, NULL,
        "60 bytes, got 120 bytes, type uint16 would fit, type int16 would fit, size [5, 4, 6] would fit, "
        "skip_bytes 60 would fit");
    volume_maker_write(source.path, bytes, 40);
    volume_check_refused(&source, NULL, "60 bytes, got 40 bytes, size [5, 4, 2] would fit");
    volume_maker_write(source.path, bytes, 70);
    source.raw.skip_bytes = 3;
    volume_check_refused(&source, NULL, "60 bytes, got 67 bytes, skip_bytes 10 would fit");
    source.raw.skip_bytes = 71;
    volume_check_refused(&source, NULL, "expected at least the 71 bytes to skip, got 70");
}

static void absurd_names_and_numbers_are_refused(void **state)
{
    struct volume_source source = {.path = temp_folder_path(state, "a_0x4x3xuint8.raw")};

    volume_check_refused(&source, NULL, "the name's size: expected at least 1 voxel along i, got 0");
    source.path = temp_folder_path(state, "a_99999999999999999999x99999999999x3xuint8.raw");
    volume_check_refused(&source, NULL, "the name's size: expected fewer than 2^31 voxels");
    source.path = temp_folder_path(state, "a_2048x1024x1024_uint8.raw");
    volume_check_refused(&source, NULL, "the name's size: expected fewer than 2^31 voxels, got 2048 x 1024 x 1024");
    source.path = temp_folder_path(state, "a_5x4x3_float64.raw");
    volume_check_refused(&source, NULL, "expected \"type\" (uint8, uint16, int16 or float32)");
    source.path = temp_folder_path(state, "a_5x4x3xuint8.vol");
    volume_check_refused(&source, NULL, "expected a name that ends in .raw, .nrrd, .nhdr, .nii or .nii.gz");
    source.path = temp_folder_path(state, "a.nrrd");
    source.raw.skip_bytes = 3;
    volume_check_refused(&source, NULL, "size, type, byte_order and skip_bytes are for raw files; a .nrrd file");
}

static void infinite_voxels_are_named(void **state)
{
    struct volume_source source = {.path = temp_folder_path(state, "a_5x4x3xfloat32.raw")};
    float voxels[60] = {0};

    voxels[47] = -INFINITY;
    voxels[48] = NAN;
    volume_maker_write(source.path, voxels, sizeof voxels);
    volume_check_refused(&source, NULL, "voxel (2, 1, 2) is no finite number");
    voxels[47] = 3e38F;
    volume_maker_write(source.path, voxels, sizeof voxels);
    volume_check_refused(&source, NULL, "voxel (3, 1, 2) is no finite number");
}

static void files_that_change_meanwhile_are_noticed(void **state)
{
    struct volume_source source = {.path = temp_folder_path(state, "a_5x4x3xuint8.raw")};
    struct volume *volume;
    struct error error = {0};
    char values[60];

    volume_maker_write_raw(source.path, size, VOLUME_STORED_UINT8, false);
    volume = volume_check_open(&source);
    assert_true(volume_read(volume, 1, values, &error));
    assert_int_equal(truncate(source.path, 20), 0);
    // The first slice came with the rest of the file in one read.
    assert_false(volume_read(volume, 2, values + 20, &error));
    assert_non_null(strstr(error.message, "changed while it was read"));
    volume_close(volume);

    volume_maker_write_raw(source.path, size, VOLUME_STORED_UINT8, false);
    volume = volume_check_open(&source);
    assert_int_equal(truncate(source.path, 20), 0);
    assert_false(volume_read(volume, 3, values, &error));
    assert_non_null(strstr(error.message, "ends after 20 bytes, before its last voxel"));
    volume_close(volume);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(name_says_size_and_type),
        cmocka_unit_test(keys_win_over_the_name),
        cmocka_unit_test(longest_side_is_a_metre_about_the_origin),
        cmocka_unit_test(bad_files_are_refused),
        cmocka_unit_test(wrong_length_says_what_would_fit),
        cmocka_unit_test(absurd_names_and_numbers_are_refused),
        cmocka_unit_test(infinite_voxels_are_named),
        cmocka_unit_test(files_that_change_meanwhile_are_noticed),
    };

    return cmocka_run_group_tests(tests, temp_folder_create, temp_folder_destroy);
}
