#include "worker/volume.h"

#include "tests/support/assert_near.h"
#include "tests/support/temp_folder.h"
#include "tests/support/volume_check.h"
#include "tests/support/volume_maker.h"

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(name_says_size_and_type),
        cmocka_unit_test(keys_win_over_the_name),
        cmocka_unit_test(longest_side_is_a_metre_about_the_origin),
        cmocka_unit_test(bad_files_are_refused),
    };

    return cmocka_run_group_tests(tests, temp_folder_create, temp_folder_destroy);
}
