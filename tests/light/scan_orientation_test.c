// A scan is never shown mirrored, turned or shifted.
// SPDX-License-Identifier: Apache-2.0
// One bright voxel at a known position, stored by every convention, appears where a pinhole camera sees that position.
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/assert_near.h"
#include "tests/support/render_frame.h"
#include "tests/support/temp_folder.h"
#include "tests/support/volume_maker.h"
#include "tests/support/volume_maker_nifti.h"
#include "worker/picture/image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

enum { WIDTH = 64, HEIGHT = 48, FOV_DEG = 12, VOXELS = 9 * 7 * 5 };

// The bright voxel lies to the patient's left, in front of and above the origin. It is voxel (1, 5, 3) of those with
// sides of 2, 3 and 4 mm about the origin.
static const double marker[3] = {-0.006, 0.006, 0.004};
static const double cameras[][3] = {{0.02, 0.2, 0.03}, {0.2, -0.03, -0.02}};

// A voxel is 3 to 5 pixels wide; the tolerance allows for the perspective within it.
static const double tolerance_px = 0.25;

static void render(const char *path, const double camera[3], const char *keys, struct image *image)
{
    struct error error = {0};
    struct job job;
    char text[2048];

    snprintf(text, sizeof text,
             "{\"version\": 1, \"name\": \"scan\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [%d, %d],"
             "\"camera\": {\"position\": [%g, %g, %g], \"target\": [0, 0, 0], \"up\": [0, 0, 1], \"fov\": %d},"
             "\"scene\": {\"media\": [{\"density\": {\"kind\": \"grid\", \"file\": \"%s\"%s}, \"sigma_a\": 0,"
             "\"emission\": [1, 1, 1]}]}, \"quality\": {\"method\": \"midpoint\", \"step\": 0.0005},"
             "\"output\": {\"path\": \"a.####.exr\", \"aovs\": [\"Z\", \"transmittance\"]}}",
             WIDTH, HEIGHT, camera[0], camera[1], camera[2], FOV_DEG, path, keys);
    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    render_frame_zero(&job, image);
    job_finish(&job);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double product[3])
{
    for (int i = 0; i < 3; i++)
        product[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static void normalize(double v[3])
{
    double length = sqrt(dot(v, v));

    for (int i = 0; i < 3; i++)
        v[i] /= length;
}

// Projects the marker into pixels right of and below the picture's upper left corner, as the job format defines a
// camera.
static void project(const double camera[3], double pixel[2])
{
    const double up[3] = {0, 0, 1};
    double forward[3] = {-camera[0], -camera[1], -camera[2]};
    double to_marker[3] = {marker[0] - camera[0], marker[1] - camera[1], marker[2] - camera[2]};
    double right[3], image_up[3];
    double scale = HEIGHT / 2.0 / tan(FOV_DEG / 2.0 * acos(-1.0) / 180.0);

    normalize(forward);
    cross(forward, up, right);
    normalize(right);
    cross(right, forward, image_up);
    pixel[0] = WIDTH / 2.0 + scale * dot(to_marker, right) / dot(to_marker, forward);
    pixel[1] = HEIGHT / 2.0 - scale * dot(to_marker, image_up) / dot(to_marker, forward);
}

static void find_centroid(const struct image *image, double pixel[2])
{
    double sum = 0;

    pixel[0] = pixel[1] = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            double red = (double)image->rgba[4 * (y * WIDTH + x)];

            sum += red;
            pixel[0] += red * (x + 0.5);
            pixel[1] += red * (y + 0.5);
        }
    assert_true(sum > 0);
    pixel[0] /= sum;
    pixel[1] /= sum;
}

static void check_picture(const char *path, const char *keys)
{
    for (size_t i = 0; i < sizeof cameras / sizeof cameras[0]; i++) {
        struct image image;
        double expected[2], found[2];

        render(path, cameras[i], keys, &image);
        project(cameras[i], expected);
        find_centroid(&image, found);
        assert_near(found[0], expected[0], tolerance_px);
        assert_near(found[1], expected[1], tolerance_px);
        image_finish(&image);
    }
}

// A NIfTI file of `size` voxels, of which the one at `index` is bright.
static void init_nifti(struct volume_maker_nifti *nifti, bool is_big_endian, const int size[3], const int index[3])
{
    volume_maker_nifti_init(nifti, 1, is_big_endian, size, VOLUME_STORED_INT16);
    memset(nifti->bytes + 352, 0, sizeof(int16_t) * VOXELS);
    nifti->bytes[352 + sizeof(int16_t) * (size_t)(index[0] + size[0] * (index[1] + size[1] * index[2])) +
                 is_big_endian] = 200;
}

static void set_sform(struct volume_maker_nifti *nifti, const double rows[3][4])
{
    static const char *const names[] = {"srow_x", "srow_y", "srow_z"};

    volume_maker_nifti_set(nifti, "sform_code", 0, 1);
    for (size_t row = 0; row < 3; row++)
        for (size_t i = 0; i < 4; i++)
            volume_maker_nifti_set(nifti, names[row], i, rows[row][i]);
}

static void check_nifti(void **state, struct volume_maker_nifti *nifti)
{
    const char *path = temp_folder_path(state, "head.nii.gz");

    volume_maker_write_gzip(path, nifti->bytes, nifti->size_bytes);
    check_picture(path, "");
    volume_maker_nifti_finish(nifti);
}

static void nifti_whose_rows_run_right_or_left(void **state)
{
    const double to_right[3][4] = {{2, 0, 0, -8}, {0, 3, 0, -9}, {0, 0, 4, -8}};
    const double to_left[3][4] = {{-2, 0, 0, 8}, {0, 3, 0, -9}, {0, 0, 4, -8}};
    struct volume_maker_nifti nifti;

    init_nifti(&nifti, false, (int[3]){9, 7, 5}, (int[3]){1, 5, 3});
    set_sform(&nifti, to_right);
    check_nifti(state, &nifti);
    init_nifti(&nifti, true, (int[3]){9, 7, 5}, (int[3]){7, 5, 3});
    set_sform(&nifti, to_left);
    check_nifti(state, &nifti);
}

// The slices are sagittal: rows run up, columns to the right, slices to the front.
static void nifti_with_other_slices(void **state)
{
    const double rows[3][4] = {{0, 2, 0, -8}, {0, 0, 3, -9}, {4, 0, 0, -8}};
    struct volume_maker_nifti nifti;

    init_nifti(&nifti, false, (int[3]){5, 9, 7}, (int[3]){3, 1, 5});
    set_sform(&nifti, rows);
    check_nifti(state, &nifti);
}

static void nifti_with_a_left_handed_qform(void **state)
{
    struct volume_maker_nifti nifti;

    init_nifti(&nifti, false, (int[3]){9, 7, 5}, (int[3]){1, 5, 1});
    volume_maker_nifti_set(&nifti, "qform_code", 0, 1);
    volume_maker_nifti_set(&nifti, "pixdim", 0, -1);
    volume_maker_nifti_set(&nifti, "pixdim", 1, 2);
    volume_maker_nifti_set(&nifti, "pixdim", 2, 3);
    volume_maker_nifti_set(&nifti, "pixdim", 3, 4);
    volume_maker_nifti_set(&nifti, "qoffset_x", 0, -8);
    volume_maker_nifti_set(&nifti, "qoffset_y", 0, -9);
    volume_maker_nifti_set(&nifti, "qoffset_z", 0, 8);
    check_nifti(state, &nifti);
}

static void nrrd_in_every_medical_space(void **state)
{
    static const struct {
        const char *space;
        int index[3]; // the axes run as the space's name says
    } cases[] = {{"right-anterior-superior", {1, 5, 3}},
                 {"left-posterior-superior", {7, 1, 3}},
                 {"left-anterior-superior", {7, 5, 3}}};

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *path = temp_folder_path(state, "head.nrrd");
        char bytes[512 + VOXELS] = {0};
        int length = snprintf(bytes, 512,
                              "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 9 7 5\nencoding: raw\nspace: %s\n"
                              "space directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (-8,-9,-8)\n\n",
                              cases[i].space);

        bytes[length + cases[i].index[0] + 9 * (cases[i].index[1] + 7 * cases[i].index[2])] = (char)200;
        volume_maker_write(path, bytes, (size_t)length + VOXELS);
        check_picture(path, "");
    }
}

static void raw_about_the_origin(void **state)
{
    const char *path = temp_folder_path(state, "head_9x7x5xuint8.raw");
    char bytes[VOXELS] = {0};

    bytes[1 + 9 * (5 + 7 * 3)] = (char)200;
    volume_maker_write(path, bytes, sizeof bytes);
    check_picture(path, ", \"spacing\": [0.002, 0.003, 0.004]");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nifti_whose_rows_run_right_or_left),
        cmocka_unit_test(nifti_with_other_slices),
        cmocka_unit_test(nifti_with_a_left_handed_qform),
        cmocka_unit_test(nrrd_in_every_medical_space),
        cmocka_unit_test(raw_about_the_origin),
    };

    return cmocka_run_group_tests(tests, temp_folder_create, temp_folder_destroy);
}
