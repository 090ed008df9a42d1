// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/volume.h"

#include "tests/support/temp_folder.h"
#include "tests/support/volume_check.h"
#include "tests/support/volume_maker.h"

#include <setjmp.h>
#include <stdarg.h>
#include <sys/stat.h>

#include <cmocka.h>

static const int size[3] = {5, 4, 3};
static const double tolerance = 1e-15; // rounding of sums of a few numbers below 0.1

#define BYTES "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 4 3\nencoding: raw\n"

// Writes `header` and then the bytes 0 to 59 of volume_maker_value, or `voxels`.
static struct volume_source write_nrrd(void **state, const char *header, const void *voxels, size_t voxel_bytes)
{
    struct volume_source source = {.path = temp_folder_path(state, "a.nrrd")};
    size_t length = strlen(header);
    unsigned char *bytes = malloc(length + voxel_bytes);

    memcpy(bytes, header, length);
    memcpy(bytes + length, voxels, voxel_bytes);
    volume_maker_write(source.path, bytes, length + voxel_bytes);
    free(bytes);
    return source;
}

static struct volume_source write_bytes(void **state, const char *header)
{
    size_t voxel_bytes;
    unsigned char *voxels = volume_maker_voxels(size, VOLUME_STORED_UINT8, false, &voxel_bytes);
    struct volume_source source = write_nrrd(state, header, voxels, voxel_bytes);

    free(voxels);
    return source;
}

static void check_place(void **state, const char *header, const int index[3], double x, double y, double z)
{
    struct volume_source source = write_bytes(state, header);
    struct volume *volume = volume_check_open(&source);

    volume_check_place(volume, index, (double[3]){x, y, z}, tolerance);
    volume_check_voxels(volume);
    volume_close(volume);
}

static void refuse(void **state, const char *header, const char *expected)
{
    struct volume_source source = write_bytes(state, header);

    volume_check_refused(&source, NULL, expected);
}

static void every_type_in_both_byte_orders_and_encodings(void **state)
{
    static const struct {
        const char *name;
        enum volume_stored stored;
        enum volume_type type;
    } cases[] = {
        {"signed char", VOLUME_STORED_INT8, VOLUME_FLOAT32},    {"int8_t", VOLUME_STORED_INT8, VOLUME_FLOAT32},
        {"Unsigned Char", VOLUME_STORED_UINT8, VOLUME_UINT8},   {"uint8", VOLUME_STORED_UINT8, VOLUME_UINT8},
        {"short", VOLUME_STORED_INT16, VOLUME_INT16},           {"signed short int", VOLUME_STORED_INT16, VOLUME_INT16},
        {"ushort", VOLUME_STORED_UINT16, VOLUME_UINT16},        {"uint16_t", VOLUME_STORED_UINT16, VOLUME_UINT16},
        {"int", VOLUME_STORED_INT32, VOLUME_FLOAT32},           {"unsigned int", VOLUME_STORED_UINT32, VOLUME_FLOAT32},
        {"long long int", VOLUME_STORED_INT64, VOLUME_FLOAT32}, {"ulonglong", VOLUME_STORED_UINT64, VOLUME_FLOAT32},
        {"float", VOLUME_STORED_FLOAT32, VOLUME_FLOAT32},       {"double", VOLUME_STORED_FLOAT64, VOLUME_FLOAT32},
    };

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        for (int is_big_endian = 0; is_big_endian <= 1; is_big_endian++)
            for (int is_zipped = 0; is_zipped <= 1; is_zipped++) {
                size_t voxel_bytes, zipped_bytes;
                unsigned char *voxels = volume_maker_voxels(size, cases[i].stored, is_big_endian, &voxel_bytes);
                unsigned char *zipped = volume_maker_gzip(voxels, voxel_bytes, &zipped_bytes);
                struct volume_source source;
                struct volume *volume;
                char header[256];

                snprintf(header, sizeof header,
                         "NRRD0005\ntype: %s\ndimension: 3\nsizes: 5 4 3\nendian: %s\nencoding: %s\n\n", cases[i].name,
                         is_big_endian ? "big" : "little", is_zipped ? "gzip" : "raw");
                source = write_nrrd(state, header, is_zipped ? zipped : voxels, is_zipped ? zipped_bytes : voxel_bytes);
                volume = volume_check_open(&source);
                assert_memory_equal(volume->size, size, sizeof size);
                assert_int_equal(volume->type, cases[i].type);
                assert_true(volume->slope == 1.0 && volume->intercept == 0.0);
                volume_check_voxels(volume);
                volume_close(volume);
                free(zipped);
                free(voxels);
            }
}

// The same voxel in three spaces with different axes.
static void spaces_turn_to_right_anterior_superior(void **state)
{
#define DIRECTIONS "space directions: (0,2,0) (0,0,3) (4,0,0)\nspace origin: (10,20,30)\n\n"
    const int index[3] = {4, 3, 2};

    // (10 + 4 * 2, 20 + 2 * 4, 30 + 3 * 3) mm along the space's axes
    check_place(state, BYTES "space: right-anterior-superior\n" DIRECTIONS, index, 0.018, 0.028, 0.039);
    check_place(state, BYTES "space: LPS\n" DIRECTIONS, index, -0.018, -0.028, 0.039);
    check_place(state, BYTES "space: left-posterior-superior\n" DIRECTIONS, index, -0.018, -0.028, 0.039);
    check_place(state, BYTES "space: LAS\n" DIRECTIONS, index, -0.018, 0.028, 0.039);
    check_place(state, BYTES "space: scanner-xyz\n" DIRECTIONS, index, 0.018, 0.028, 0.039);
    check_place(state, BYTES "space: 3D-right-handed\n" DIRECTIONS, index, 18, 28, 39);
    check_place(state, BYTES "space: 3D-left-handed\n" DIRECTIONS, index, 18, 28, -39);
    check_place(state, BYTES "space dimension: 3\n" DIRECTIONS, index, 18, 28, 39);
    check_place(state, BYTES "space: LPS\nspace units: \"cm\" \"m\" \"\"\n" DIRECTIONS, index, -0.18, -28, 0.039);
#undef DIRECTIONS
}

static void without_an_origin_the_middle_is_the_worlds(void **state)
{
    check_place(state, BYTES "space: LPS\nspace directions: (0,2,0) (0,0,3) (4,0,0)\n\n", (int[3]){4, 3, 2}, -0.004,
                -0.004, 0.0045);
    check_place(state, BYTES "spacings: 2 3 4\n\n", (int[3]){4, 3, 2}, 4, 4.5, 4);
    check_place(state, BYTES "spacings: 2 3 4\nunits: \"mm\" \"cm\" \"um\"\n\n", (int[3]){4, 3, 2}, 0.004, 0.045, 4e-6);
    check_place(state, BYTES "spacings: 2 3 4\nspace: RAS\n\n", (int[3]){4, 3, 2}, 0.004, 0.0045, 0.004);
    check_place(state, BYTES "spacings: nan nan nan\n\n", (int[3]){4, 3, 2}, 0.4, 0.3, 0.2);
    check_place(state, BYTES "\n", (int[3]){4, 3, 2}, 0.4, 0.3, 0.2);
}

static void comments_keys_and_line_ends(void **state)
{
    check_place(state,
                "NRRD0001\r\n# sizes: 9 9 9\r\ncontent: a: b\r\nsizes:  5\t4 3 \r\nTYPE: uchar\r\ndimension: 3\r\n"
                "sizes:=1 1 1\r\nhttp://x:=y\r\nencoding: RAW\r\nspacings: 1 1 1\r\nkinds: domain space ???\r\n\r\n",
                (int[3]){4, 3, 2}, 2, 1.5, 1);
}

static void detached_header_lies_beside_its_voxels(void **state)
{
    const char *header =
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 5 4 3\nencoding: raw\nline skip: 1\nbyte skip: 2\n"
        "data file: voxels/a 1.bin";
    struct volume_source source = {.path = temp_folder_path(state, "a.nhdr")};
    const char *path = temp_folder_path(state, "voxels/a 1.bin");
    unsigned char bytes[5 + 60] = "x\r\nyz";
    size_t voxel_bytes;
    unsigned char *voxels = volume_maker_voxels(size, VOLUME_STORED_UINT8, false, &voxel_bytes);
    struct volume *volume;

    volume_maker_write(source.path, header, strlen(header));
    volume_check_refused(&source, NULL, "/voxels/a 1.bin: cannot open: No such file");
    mkdir(temp_folder_path(state, "voxels"), 0777);
    memcpy(bytes + 5, voxels, voxel_bytes);
    volume_maker_write(path, bytes, sizeof bytes);
    volume = volume_check_open(&source);
    volume_check_voxels(volume);
    volume_close(volume);
    volume_maker_write(path, bytes, sizeof bytes - 1);
    volume_check_refused(&source, NULL, "a 1.bin: expected 5 x 4 x 3 voxels of uint8, 60 bytes, got 59 bytes");
    free(voxels);
}

static void byte_skip_counts_unzipped_bytes_or_from_the_end(void **state)
{
    unsigned char bytes[7 + 60] = "1234567";
    size_t voxel_bytes, zipped_bytes;
    unsigned char *voxels = volume_maker_voxels(size, VOLUME_STORED_UINT8, false, &voxel_bytes);
    unsigned char *zipped;
    struct volume_source source;
    struct volume *volume;

    memcpy(bytes + 7, voxels, voxel_bytes);
    source = write_nrrd(state, BYTES "byte skip: -1\n\n", bytes, sizeof bytes);
    volume = volume_check_open(&source);
    volume_check_voxels(volume);
    volume_close(volume);

    zipped = volume_maker_gzip(bytes, sizeof bytes, &zipped_bytes);
    source = write_nrrd(state, "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 4 3\nencoding: gz\nbyte skip: 7\n\n",
                        zipped, zipped_bytes);
    volume = volume_check_open(&source);
    volume_check_voxels(volume);
    volume_close(volume);
    source = write_nrrd(state, "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 4 3\nencoding: gz\nbyte skip: -1\n\n",
                        zipped, zipped_bytes);
    volume_check_refused(&source, NULL, "byte skip: expected a whole number of at least 0");
    free(zipped);
    free(voxels);
}

static void bad_headers_name_the_place(void **state)
{
    static const char *const cases[][2] = {
        {"NRRD9999\n\n", "line 1: expected NRRD's magic"},
        {"", "line 1: expected NRRD's magic"},
        {"NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 5 4 3\n\n",
         "dimension: expected 3 (one number a voxel), got \"4\""},
        {"NRRD0004\ntype: uchar\nsizes: 5 4 3\n\n", "dimension: expected 3 (one number a voxel), got nothing"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 4\n\n", "sizes: expected 3 whole numbers, got \"5 4\""},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 4 3.5\n\n", "sizes: expected 3 whole numbers, got \"5 4 3.5\""},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 4 3 2\n\n", "sizes: expected 3 whole numbers"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 0 3\n\n", "sizes: expected at least 1 voxel along j, got 0"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2048 1024 1024\n\n", "sizes: expected fewer than 2^31 voxels"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 99999999999999999999 1 1\n\n", "sizes: expected 3 whole numbers"},
        {"NRRD0004\ntype: block\ndimension: 3\nsizes: 5 4 3\n\n", "type: expected a number type"},
        {"NRRD0004\ntype: short\ndimension: 3\nsizes: 5 4 3\n\n",
         "endian: expected \"little\" or \"big\", got nothing"},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 4 3\nencoding: bzip2\n\n",
         "encoding: expected \"raw\" or \"gzip\", got \"bzip2\""},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 4 3\nencoding: ascii\n\n", "got \"ascii\""},
        {"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 4 3\nencoding: hex\n\n", "got \"hex\""},
        {BYTES "sizes: 5 4 3\n\n", "line 6: \"sizes\" is given already in line 4"},
        {BYTES "spacing: 5 4 3\n\n", "line 6: unknown field \"spacing\", did you mean \"spacings\"?"},
        {BYTES "hello\n\n", "line 6: expected \"field: text\""},
        {BYTES "kinds: RGB-color domain domain\n\n",
         "kinds: expected \"domain\" or \"space\" for each axis, got \"RGB-color"},
        {BYTES "spacings: 1 -1 1\n\n", "spacings: expected 3 numbers above 0, got \"1 -1 1\""},
        {BYTES "spacings: 1 0 1\n\n", "spacings: expected 3 numbers above 0"},
        {BYTES "spacings: nan 1 1\n\n", "spacings: expected 3 numbers above 0"},
        {BYTES "spacings: 1 1 1e300\n\n", "expected a voxel's side along k between 1e-12 m and 1e12 m"},
        {BYTES "spacings: 1 1\n\n", "spacings: expected 3 numbers, got \"1 1\""},
        {BYTES "spacings: 1 1 1\nunits: \"mm\" \"mm\" \"parsec\"\n\n", "units: expected three of \"m\""},
        {BYTES "axis mins: 0 0 0\naxis maxs: 1 1 1\n\n", "spacings: expected the voxels' sides"},
        {BYTES "space directions: (1,0,0) (0,1,0) (0,0,1)\n\n", "space: expected a name"},
        {BYTES "space: LPS\nspace directions: (1,0,0) (0,1,0) none\n\n", "space directions: expected three vectors"},
        {BYTES "space: LPS\nspace directions: (1,0,0) (0,1,0) (1,1,0)\n\n",
         "space directions: the directions of the three axes"},
        {BYTES "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,nan)\n\n",
         "space directions: expected finite numbers"},
        {BYTES "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (1,2)\n\n",
         "space origin: expected a vector"},
        {BYTES "space: LPST\n\n", "space: expected a space of three dimensions"},
        {BYTES "space dimension: 2\n\n", "space dimension: expected 3, got \"2\""},
        {BYTES "space: LPS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspacings: 1 1 1\n\n",
         "spacings: not allowed beside"},
        {BYTES "data file: LIST\na\nb\n", "line 7: expected \"field: text\""},
        {BYTES "data file: LIST\n\n", "data file: expected one file (neither LIST nor a pattern), got \"LIST\""},
        {BYTES "data file: a%03d.raw 1 3 1\n\n", "data file: expected one file"},
        {BYTES "line skip: 99\n\n", "line skip: the file ends"},
        {BYTES "line skip: -1\n\n", "line skip: expected a whole number"},
        {BYTES "byte skip: -2\n\n", "byte skip: expected a whole number"},
        {BYTES "byte skip: 1\n\n", "expected 5 x 4 x 3 voxels of uint8, 60 bytes, got 59 bytes"},
        {BYTES "\n\n", "expected 5 x 4 x 3 voxels of uint8, 60 bytes, got 61 bytes"},
        {BYTES "content: \x01\x02\n\n\n", "60 bytes, got 61 bytes"},
    };

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        refuse(state, cases[i][0], cases[i][1]);
}

static void headers_that_never_end(void **state)
{
    struct volume_source source = {.path = temp_folder_path(state, "a.nrrd")};
    size_t length = 70 * 1024;
    char *text = malloc(2 * 1024 * 1024);

    memcpy(text, "NRRD0001\n# ", 11);
    memset(text + 11, 'x', length);
    volume_maker_write(source.path, text, length);
    volume_check_refused(&source, NULL, "line 2: longer than 64 KiB");
    for (size_t i = 11; i < 2 * 1024 * 1024; i++)
        text[i] = i % 1000 < 998 ? '#' : '\n' - (i % 1000 == 999 ? '\n' - '#' : 0);
    volume_maker_write(source.path, text, 2 * 1024 * 1024);
    volume_check_refused(&source, NULL, "the header is longer than 1 MiB");
    volume_maker_write(source.path, BYTES, sizeof BYTES - 1);
    volume_check_refused(&source, NULL, "expected an empty line and the voxels behind the header");
    volume_maker_write(source.path, BYTES, sizeof BYTES);
    volume_check_refused(&source, NULL, "line 6: expected text, got a zero byte");
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_type_in_both_byte_orders_and_encodings),
        cmocka_unit_test(spaces_turn_to_right_anterior_superior),
        cmocka_unit_test(without_an_origin_the_middle_is_the_worlds),
        cmocka_unit_test(comments_keys_and_line_ends),
        cmocka_unit_test(detached_header_lies_beside_its_voxels),
        cmocka_unit_test(byte_skip_counts_unzipped_bytes_or_from_the_end),
        cmocka_unit_test(bad_headers_name_the_place),
        cmocka_unit_test(headers_that_never_end),
    };

    return cmocka_run_group_tests(tests, temp_folder_create, temp_folder_destroy);
}
