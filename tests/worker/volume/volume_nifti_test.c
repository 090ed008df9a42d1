// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/volume.h"

#include "tests/support/temp_folder.h"
#include "tests/support/volume_check.h"
#include "tests/support/volume_maker.h"
#include "tests/support/volume_maker_nifti.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static const int size[3] = {5, 4, 3};
// Positions are single precision in the file: 1e-7 of about 10 mm.
static const double tolerance = 2e-9;

static struct volume *open_bytes(void **state, const struct volume_maker_nifti *nifti)
{
    struct volume_source source = {.path = temp_folder_path(state, "head.nii")};

    volume_maker_write(source.path, nifti->bytes, nifti->size_bytes);
    return volume_check_open(&source);
}

static void check_place(const struct volume *volume, const int index[3], double x_mm, double y_mm, double z_mm)
{
    volume_check_place(volume, index, (double[3]){x_mm / 1e3, y_mm / 1e3, z_mm / 1e3}, tolerance);
}

static void set_row(struct volume_maker_nifti *nifti, const char *row, double a, double b, double c, double d)
{
    const double numbers[4] = {a, b, c, d};

    for (size_t i = 0; i < 4; i++)
        volume_maker_nifti_set(nifti, row, i, numbers[i]);
}

// A quarter turn about z that also mirrors: i along -y, j along -x, k up.
static void set_sform(struct volume_maker_nifti *nifti)
{
    volume_maker_nifti_set(nifti, "sform_code", 0, 1);
    set_row(nifti, "srow_x", 0, -2, 0, 10);
    set_row(nifti, "srow_y", -3, 0, 0, 20);
    set_row(nifti, "srow_z", 0, 0, 4, -30);
}

static void every_version_type_and_byte_order(void **state)
{
    static const enum volume_type types[] = {VOLUME_UINT8,   VOLUME_FLOAT32, VOLUME_UINT16,  VOLUME_INT16,
                                             VOLUME_FLOAT32, VOLUME_FLOAT32, VOLUME_FLOAT32, VOLUME_FLOAT32,
                                             VOLUME_FLOAT32, VOLUME_FLOAT32};

    for (int stored = VOLUME_STORED_UINT8; stored <= VOLUME_STORED_FLOAT64; stored++)
        for (int version = 1; version <= 2; version++)
            for (int is_big_endian = 0; is_big_endian <= 1; is_big_endian++)
                for (int is_zipped = 0; is_zipped <= 1; is_zipped++) {
                    struct volume_source source = {.path = temp_folder_path(state, is_zipped ? "a.nii.gz" : "a.nii")};
                    struct volume_maker_nifti nifti;
                    struct volume *volume;

                    volume_maker_nifti_init(&nifti, version, is_big_endian, size, stored);
                    set_sform(&nifti);
                    (is_zipped ? volume_maker_write_gzip : volume_maker_write)(source.path, nifti.bytes,
                                                                               nifti.size_bytes);
                    volume = volume_check_open(&source);
                    assert_memory_equal(volume->size, size, sizeof size);
                    assert_int_equal(volume->type, types[stored]);
                    check_place(volume, (int[3]){4, 3, 2}, 4, 8, -22);
                    volume_check_voxels(volume);
                    volume_close(volume);
                    volume_maker_nifti_finish(&nifti);
                }
}

static void sform_goes_before_qform_before_pixdim(void **state)
{
    struct volume_maker_nifti nifti;
    struct volume *volume;

    volume_maker_nifti_init(&nifti, 1, false, size, VOLUME_STORED_UINT8);
    volume_maker_nifti_set(&nifti, "pixdim", 1, 2);
    volume_maker_nifti_set(&nifti, "qoffset_x", 0, 7);
    volume = open_bytes(state, &nifti);
    check_place(volume, (int[3]){4, 3, 2}, 8, 3, 2);
    volume_close(volume);

    volume_maker_nifti_set(&nifti, "qform_code", 0, 1);
    volume = open_bytes(state, &nifti);
    check_place(volume, (int[3]){4, 3, 2}, 15, 3, 2);
    volume_close(volume);

    set_sform(&nifti);
    volume = open_bytes(state, &nifti);
    check_place(volume, (int[3]){4, 0, 0}, 10, 8, -30);
    check_place(volume, (int[3]){0, 3, 0}, 4, 20, -30);
    check_place(volume, (int[3]){0, 0, 2}, 10, 20, -22);
    volume_close(volume);
    volume_maker_nifti_finish(&nifti);
}

// A third of a turn about (1, 1, 1) takes x to y, y to z and z to x: (a, b, c, d) = (1, 1, 1, 1) / 2.
static void qform_turns_by_its_quaternion(void **state)
{
    struct volume_maker_nifti nifti;

    for (int qfac = -1; qfac <= 1; qfac++) {
        double k_side = qfac < 0 ? -4 : 4; // 0 counts as 1
        struct volume *volume;

        volume_maker_nifti_init(&nifti, 2 - (qfac == 0), qfac > 0, size, VOLUME_STORED_UINT8);
        volume_maker_nifti_set(&nifti, "qform_code", 0, 2);
        volume_maker_nifti_set(&nifti, "pixdim", 0, qfac);
        volume_maker_nifti_set(&nifti, "pixdim", 1, 2);
        volume_maker_nifti_set(&nifti, "pixdim", 2, 3);
        volume_maker_nifti_set(&nifti, "pixdim", 3, 4);
        volume_maker_nifti_set(&nifti, "quatern_b", 0, 0.5);
        volume_maker_nifti_set(&nifti, "quatern_c", 0, 0.5);
        volume_maker_nifti_set(&nifti, "quatern_d", 0, 0.5);
        volume_maker_nifti_set(&nifti, "qoffset_x", 0, -1);
        volume_maker_nifti_set(&nifti, "qoffset_y", 0, -2);
        volume_maker_nifti_set(&nifti, "qoffset_z", 0, -3);
        volume = open_bytes(state, &nifti);
        check_place(volume, (int[3]){0, 0, 0}, -1, -2, -3);
        check_place(volume, (int[3]){4, 0, 0}, -1, -2 + 8, -3);
        check_place(volume, (int[3]){0, 3, 0}, -1, -2, -3 + 9);
        check_place(volume, (int[3]){0, 0, 2}, -1 + 2 * k_side, -2, -3);
        volume_close(volume);
        volume_maker_nifti_finish(&nifti);
    }
}

// Half a turn about z is (0, 0, 0, 1), which single precision may write a little longer than 1.
static void half_turns_survive_rounding(void **state)
{
    struct volume_maker_nifti nifti;
    struct volume *volume;

    volume_maker_nifti_init(&nifti, 1, false, size, VOLUME_STORED_UINT8);
    volume_maker_nifti_set(&nifti, "qform_code", 0, 1);
    volume_maker_nifti_set(&nifti, "quatern_d", 0, 1.0000002);
    volume = open_bytes(state, &nifti);
    check_place(volume, (int[3]){4, 3, 2}, -4, -3, 2);
    volume_close(volume);
    volume_maker_nifti_finish(&nifti);
}

static void units_are_metres_millimetres_or_micrometres(void **state)
{
    static const double metres[] = {1e-3, 1, 1e-3, 1e-6};

    for (int unit = 0; unit <= 3; unit++) {
        struct volume_maker_nifti nifti;
        struct volume *volume;

        volume_maker_nifti_init(&nifti, 1, false, size, VOLUME_STORED_UINT8);
        volume_maker_nifti_set(&nifti, "xyzt_units", 0, unit + 8); // and seconds
        volume = open_bytes(state, &nifti);
        volume_check_place(volume, (int[3]){4, 3, 2}, (double[3]){4 * metres[unit], 3 * metres[unit], 2 * metres[unit]},
                           1e-7 * metres[unit]);
        volume_close(volume);
        volume_maker_nifti_finish(&nifti);
    }
}

static void slope_scales_unless_it_is_zero(void **state)
{
    static const double slopes[][4] = {{0, 5, 1, 0}, {2, -3, 2, -3}, {NAN, NAN, 1, 0}, {-0.5, 0, -0.5, 0}};

    for (size_t i = 0; i < sizeof slopes / sizeof slopes[0]; i++) {
        struct volume_maker_nifti nifti;
        struct volume *volume;

        volume_maker_nifti_init(&nifti, 1, false, size, VOLUME_STORED_INT16);
        volume_maker_nifti_set(&nifti, "scl_slope", 0, slopes[i][0]);
        volume_maker_nifti_set(&nifti, "scl_inter", 0, slopes[i][1]);
        volume = open_bytes(state, &nifti);
        assert_true(volume->slope == slopes[i][2] && volume->intercept == slopes[i][3]);
        volume_check_voxels(volume);
        volume_close(volume);
        volume_maker_nifti_finish(&nifti);
    }
}

// Extensions are between the header and the voxels; some writers store 0 when there are none.
static void voxels_begin_at_their_offset(void **state)
{
    for (int version = 1; version <= 2; version++)
        for (int is_zipped = 0; is_zipped <= 1; is_zipped++) {
            struct volume_source source = {.path = temp_folder_path(state, is_zipped ? "a.nii.gz" : "a.nii")};
            size_t least = version == 1 ? 352 : 544;
            unsigned char bytes[544 + 5000 + 60] = {0};
            struct volume_maker_nifti nifti;
            struct volume *volume;

            volume_maker_nifti_init(&nifti, version, false, size, VOLUME_STORED_UINT8);
            volume_maker_nifti_set(&nifti, "vox_offset", 0, (double)least + 5000);
            memcpy(bytes, nifti.bytes, least);
            memcpy(bytes + least + 5000, nifti.bytes + least, 60);
            (is_zipped ? volume_maker_write_gzip : volume_maker_write)(source.path, bytes, least + 5000 + 60);
            volume = volume_check_open(&source);
            volume_check_voxels(volume);
            volume_close(volume);

            volume_maker_nifti_set(&nifti, "vox_offset", 0, 0);
            (is_zipped ? volume_maker_write_gzip : volume_maker_write)(source.path, nifti.bytes, nifti.size_bytes);
            volume = volume_check_open(&source);
            volume_check_voxels(volume);
            volume_close(volume);
            volume_maker_nifti_finish(&nifti);
        }
}

// The voxels' directions and the grid's middle, here (7, 14, -26) mm, stay.
static void spacing_overrides_the_sides(void **state)
{
    struct volume_source source = {.path = temp_folder_path(state, "a.nii"), .spacing = {0.1, 0.2, 0.3}};
    struct volume_maker_nifti nifti;
    struct volume *volume;

    volume_maker_nifti_init(&nifti, 1, false, size, VOLUME_STORED_UINT8);
    set_sform(&nifti);
    volume_maker_write(source.path, nifti.bytes, nifti.size_bytes);
    volume = volume_check_open(&source);
    check_place(volume, (int[3]){2, 0, 1}, 7 + 300, 14, -26);
    check_place(volume, (int[3]){2, 3, 1}, 7 - 300, 14, -26);
    check_place(volume, (int[3]){0, 0, 0}, 7 + 300, 14 + 200, -26 - 300);
    volume_close(volume);
    volume_maker_nifti_finish(&nifti);
}

static void bad_fields_are_named(void **state)
{
    static const struct {
        const char *field;
        size_t index;
        double number;
        const char *expected;
    } cases[] = {
        {"sizeof_hdr", 0, 349, "expected NIfTI's header size, 348 or 540, in the first 4 bytes, got 349"},
        {"dim", 0, 2, "dim[0]: expected 3 dimensions, got 2"},
        {"dim", 0, 8, "dim[0]: expected 3 dimensions, got 8"},
        {"dim", 1, 0, "dim: expected at least 1 voxel along i, got 0"},
        {"dim", 3, -3, "dim: expected at least 1 voxel along k, got -3"},
        {"dim", 3, 4, "expected 5 x 4 x 4 voxels of int16, 160 bytes, got 120 bytes"},
        {"datatype", 0, 128, "datatype: expected real numbers of 8 to 64 bits, got RGB24"},
        {"datatype", 0, 3, "datatype: 3 is none of the standard's"},
        {"datatype", 0, 2, "bitpix: expected 8 for uint8, got 16"},
        {"pixdim", 2, 0, "pixdim[2]: expected a voxel's side above 0, got 0"},
        {"pixdim", 3, -1, "pixdim[3]: expected a voxel's side above 0, got -1"},
        {"pixdim", 1, NAN, "pixdim[1]: expected a voxel's side above 0, got nan"},
        {"xyzt_units", 0, 4, "xyzt_units: expected a length"},
        {"vox_offset", 0, 16, "vox_offset: expected a whole number of at least"},
        {"vox_offset", 0, 1e9, "bytes to skip, got "},
        {"scl_slope", 0, INFINITY, "scl_slope, scl_inter: expected numbers from 1e-30 to 1e30 in size, got inf, 0"},
        {"sform_code", 0, 1, "srow: expected a voxel's side along i"},
    };

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        for (int version = 1; version <= 2; version++) {
            struct volume_source source = {.path = temp_folder_path(state, "bad.nii")};
            struct volume_maker_nifti nifti;

            volume_maker_nifti_init(&nifti, version, i % 2, size, VOLUME_STORED_INT16);
            volume_maker_nifti_set(&nifti, cases[i].field, cases[i].index, cases[i].number);
            volume_maker_write(source.path, nifti.bytes, nifti.size_bytes);
            volume_check_refused(&source, NULL, cases[i].expected);
            volume_maker_nifti_finish(&nifti);
        }
}

static void bad_directions_are_refused(void **state)
{
    struct volume_source source = {.path = temp_folder_path(state, "bad.nii")};
    struct volume_maker_nifti nifti;

    volume_maker_nifti_init(&nifti, 1, false, size, VOLUME_STORED_UINT8);
    set_sform(&nifti);
    set_row(&nifti, "srow_z", -3, 0, 0, 1);
    set_row(&nifti, "srow_y", -3, 0, 0, 1);
    set_row(&nifti, "srow_x", -3, 1, 1, 1);
    volume_maker_write(source.path, nifti.bytes, nifti.size_bytes);
    volume_check_refused(&source, NULL, "srow: the directions of the three axes lie in one plane");
    set_row(&nifti, "srow_z", 0, NAN, 0, 1);
    volume_maker_write(source.path, nifti.bytes, nifti.size_bytes);
    volume_check_refused(&source, NULL, "srow: expected finite numbers for the voxels' positions, got nan");
    volume_maker_nifti_set(&nifti, "sform_code", 0, 0);
    volume_maker_nifti_set(&nifti, "qform_code", 0, 1);
    volume_maker_nifti_set(&nifti, "quatern_b", 0, 1.1);
    volume_maker_write(source.path, nifti.bytes, nifti.size_bytes);
    volume_check_refused(&source, NULL, "quatern_b, c, d: expected a length of at most 1, got (1.1, 0, 0)");
    volume_maker_nifti_finish(&nifti);
}

static void more_than_one_volume_is_refused(void **state)
{
    struct volume_source source = {.path = temp_folder_path(state, "a.nii")};
    struct volume_maker_nifti nifti;

    volume_maker_nifti_init(&nifti, 1, false, size, VOLUME_STORED_UINT8);
    volume_maker_nifti_set(&nifti, "dim", 0, 4);
    volume_maker_nifti_set(&nifti, "dim", 4, 1);
    volume_close(open_bytes(state, &nifti));
    volume_maker_nifti_set(&nifti, "dim", 4, 3);
    volume_maker_write(source.path, nifti.bytes, nifti.size_bytes);
    volume_check_refused(&source, NULL, "dim[4]: expected one volume, got 3");
    volume_maker_nifti_finish(&nifti);
}

static void other_files_are_refused_with_a_hint(void **state)
{
    struct volume_source source = {.path = temp_folder_path(state, "a.hdr")};
    struct volume_maker_nifti nifti;

    volume_check_refused(&source, NULL, "join them into one .nii");
    source.path = temp_folder_path(state, "a.nii");
    volume_maker_nifti_init(&nifti, 1, false, size, VOLUME_STORED_UINT8);
    volume_maker_write_gzip(source.path, nifti.bytes, nifti.size_bytes);
    volume_check_refused(&source, NULL, "is compressed by gzip: its name must end in .nii.gz");
    nifti.bytes[345] = 'x';
    volume_maker_write(source.path, nifti.bytes, nifti.size_bytes);
    volume_check_refused(&source, NULL, "magic \"n+1\" at byte 344, got something else");
    memcpy(nifti.bytes + 344, "ni1", 4);
    volume_maker_write(source.path, nifti.bytes, nifti.size_bytes);
    volume_check_refused(&source, NULL, "join them into one .nii");
    volume_maker_write(source.path, nifti.bytes, 100);
    volume_check_refused(&source, NULL, "ends after 100 bytes");
    volume_maker_nifti_finish(&nifti);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_version_type_and_byte_order),
        cmocka_unit_test(sform_goes_before_qform_before_pixdim),
        cmocka_unit_test(qform_turns_by_its_quaternion),
        cmocka_unit_test(half_turns_survive_rounding),
        cmocka_unit_test(units_are_metres_millimetres_or_micrometres),
        cmocka_unit_test(slope_scales_unless_it_is_zero),
        cmocka_unit_test(voxels_begin_at_their_offset),
        cmocka_unit_test(spacing_overrides_the_sides),
        cmocka_unit_test(bad_fields_are_named),
        cmocka_unit_test(bad_directions_are_refused),
        cmocka_unit_test(more_than_one_volume_is_refused),
        cmocka_unit_test(other_files_are_refused_with_a_hint),
    };

    return cmocka_run_group_tests(tests, temp_folder_create, temp_folder_destroy);
}
