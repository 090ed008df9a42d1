// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/gate.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static struct job make_job(void)
{
    return (struct job){.width_px = 24,
                        .height_px = 20,
                        .output = {.pixel = JOB_PIXEL_HALF, .has_depth = true},
                        .name = (char *)"smoke",
                        .hash = "0123456789abcdef0123456789abcdef"};
}

// Frame 7 of make_job, `spoilt` at channel G of pixel (3, 2).
static int make_measured_file(float spoilt, struct image_exr_rays rays, struct audit_result audit)
{
    struct image_exr_header header = {.compression = JOB_COMPRESSION_ZIP,
                                      .fps_numerator = 24,
                                      .fps_denominator = 1,
                                      .job_hash = "0123456789abcdef0123456789abcdef",
                                      .sequence_hash = "00000000000000000000000000000001",
                                      .job_name = "smoke",
                                      .rays = rays,
                                      .audit = audit,
                                      .frame = 7};
    struct image image;
    int fd = memfd_create("frame", MFD_CLOEXEC);

    assert_true(image_init(&image, 24, 20, true, false, NULL));
    for (int i = 0; i < 24 * 20; i++) {
        image.depth[i] = (float)i;
        for (int c = 0; c < 4; c++)
            image.rgba[i * 4 + c] = (float)(i % 5) * 0.25f;
    }
    image.rgba[(2 * 24 + 3) * 4 + 1] = spoilt;
    assert_true(image_exr_write(fd, &image, &header, 1, NULL));
    image_finish(&image);
    return fd;
}

static int make_file_with_rays(float spoilt, struct image_exr_rays rays)
{
    return make_measured_file(spoilt, rays, (struct audit_result){0});
}

static int make_file(float spoilt)
{
    return make_file_with_rays(spoilt, (struct image_exr_rays){0});
}

static int make_audited_file(double error, double error95, double tolerance)
{
    return make_measured_file(
        0, (struct image_exr_rays){0},
        (struct audit_result){
            .kind = AUDIT_REFERENCE, .error = error, .error95 = error95, .ray_count = 64, .tolerance = tolerance});
}

static void assert_refused(int fd, const struct job *job, int32_t frame, const char *reason)
{
    struct error error = {0};

    assert_false(gate_check(&(struct gate_params){.fd = fd, .job = job, .picture_hash = job->hash, .frame = frame},
                            NULL, &error));
    if (!strstr(error.message, reason)) fail_msg("expected \"%s\" in \"%s\"", reason, error.message);
    close(fd);
}

static void whole_frame_passes_and_is_described(void **state)
{
    struct job job = make_job();
    struct gate_result result;
    struct error error = {0};
    struct stat status;
    char hash[HASH_TEXT_SIZE];
    int fd = make_file(0.5f);

    if (!gate_check(
            &(struct gate_params){.fd = fd, .job = &job, .picture_hash = job.hash, .frame = 7, .thread_count = 2},
            &result, &error))
        fail_msg("%s", error.message);
    assert_int_equal(fstat(fd, &status), 0);
    assert_int_equal(result.file.inode, status.st_ino);
    assert_int_equal(result.file.size_bytes, status.st_size);
    assert_true(hash_file(fd, hash, NULL, NULL));
    assert_string_equal(result.file.hash, hash);
    close(fd);
}

static void values_that_are_not_finite_are_refused(void **state)
{
    struct job job = make_job();

    assert_refused(make_file(NAN), &job, 7, "channel G at pixel (3, 2) is NaN");
    assert_refused(make_file(INFINITY), &job, 7, "channel G at pixel (3, 2) is infinite");
    assert_refused(make_file(1e6f), &job, 7, "channel G at pixel (3, 2) is infinite");
}

// Channel `index` of the last pixel or, with `is_first`, of the first: R, G, B, A, Z, transmittance.R, .G, .B.
static float *find_value(struct image *image, int index, bool is_first)
{
    size_t pixel = is_first ? 0 : (size_t)image->width_px * (size_t)image->height_px - 1;

    if (index < 4) return image->rgba + 4 * pixel + index;
    return index == 4 ? image->depth + pixel : image->transmittance + 4 * pixel + (index - 5);
}

// A file of frame 7: black, all channels, with one value that is not finite.
static int make_spoilt_file(const struct job *job, int index, bool is_first)
{
    struct image_exr_header header = {.pixel = job->output.pixel,
                                      .compression = job->output.compression,
                                      .fps_numerator = 24,
                                      .fps_denominator = 1,
                                      .job_hash = job->hash,
                                      .frame = 7};
    int fd = memfd_create("frame", MFD_CLOEXEC);
    struct image image;

    assert_true(image_init(&image, job->width_px, job->height_px, true, true, NULL));
    for (int i = 0; i < job->width_px * job->height_px; i++) {
        image.depth[i] = 0;
        for (int c = 0; c < 4; c++)
            image.rgba[4 * i + c] = image.transmittance[4 * i + c] = 0;
    }
    *find_value(&image, index, is_first) = is_first ? NAN : -INFINITY;
    assert_true(image_exr_write(fd, &image, &header, 1, NULL));
    image_finish(&image);
    return fd;
}

static void no_channel_and_no_pixel_is_left_out(void **state)
{
    static const char *const names[] = {
        "R", "G", "B", "A", "Z", "transmittance.R", "transmittance.G", "transmittance.B"};
    struct job job = make_job();
    char reason[64];

    job.output.has_transmittance = true;
    for (int compression = JOB_COMPRESSION_NONE; compression <= JOB_COMPRESSION_PIZ; compression++)
        for (int i = 0; i < 2 * 2 * 8; i++) {
            bool is_first = i % 2;

            job.output.compression = (enum job_compression)compression;
            job.output.pixel = i / 2 % 2 ? JOB_PIXEL_HALF : JOB_PIXEL_FLOAT;
            snprintf(reason, sizeof reason, "channel %s at pixel %s is %s", names[i / 4],
                     is_first ? "(0, 0)" : "(23, 19)", is_first ? "NaN" : "infinite");
            assert_refused(make_spoilt_file(&job, i / 4, is_first), &job, 7, reason);
        }
}

static void frame_of_another_number_is_refused(void **state)
{
    struct job job = make_job();

    assert_refused(make_file(0), &job, 8, "marchd:frame: expected 8, got 7");
}

static void frame_of_another_job_is_refused(void **state)
{
    struct job job = make_job();

    job.hash[0] = 'f';
    assert_refused(make_file(0), &job, 7,
                   "rendered from an older version of this job (marchd:jobHash: expected f123456789abcdef");
    job.name = (char *)"fire";
    assert_refused(make_file(0), &job, 7, "rendered from another job, \"smoke\" (marchd:jobHash: expected");
}

static void frame_of_other_inputs_is_refused(void **state)
{
    struct gate_params params = {.fd = make_file(0), .picture_hash = "f", .frame = 7};
    struct job job = make_job();
    struct error error;

    params.job = &job;
    memcpy(job.hash, "00000000000000000000000000000001", HASH_TEXT_SIZE);
    assert_false(gate_check(&params, NULL, &error));
    assert_non_null(strstr(error.message, "rendered before a file that its job reads was changed"));
    close(params.fd);
}

static void frame_of_another_shape_is_refused(void **state)
{
    struct job job = make_job();

    job.width_px = 23;
    assert_refused(make_file(0), &job, 7, "size: expected 23 x 20, got 24 x 20");
    job = make_job();
    job.output.pixel = JOB_PIXEL_FLOAT;
    assert_refused(make_file(0), &job, 7, "pixel: expected float, got half");
    job = make_job();
    job.output.has_depth = false;
    assert_refused(make_file(0), &job, 7, "expected no Z");
    job = make_job();
    job.output.has_transmittance = true;
    assert_refused(make_file(0), &job, 7, "expected transmittance");
}

static void frame_with_too_much_cut_is_refused(void **state)
{
    struct job job = make_job();

    job.quality.max_cut = 0.125;
    job.scene.object_count = 1;
    job.scene.objects[0].material.kind = SCENE_MATERIAL_DIELECTRIC;
    assert_refused(make_file_with_rays(0, (struct image_exr_rays){.is_known = true, .cut_share = 0.25}), &job, 7,
                   "marchd:cutShare: expected at most 0.125 (max_cut), got 0.25: a larger max_depth or a smaller "
                   "min_throughput cuts fewer rays");
    assert_refused(make_file_with_rays(0, (struct image_exr_rays){.is_known = true, .cut_share = NAN}), &job, 7,
                   "marchd:cutShare: expected at most 0.125 (max_cut)");
    assert_refused(make_file(0), &job, 7, "marchd:cutShare: expected what rays cut by max_depth and min_throughput");
}

static void frame_with_little_cut_passes(void **state)
{
    const struct image_exr_rays rays = {.is_known = true, .cut_share = 0.125};
    struct job job = make_job();
    int fd = make_file_with_rays(0, rays);

    job.quality.max_cut = 0.125;
    job.scene.object_count = 1;
    job.scene.objects[0].material.kind = SCENE_MATERIAL_DIELECTRIC;
    assert_true(
        gate_check(&(struct gate_params){.fd = fd, .job = &job, .picture_hash = job.hash, .frame = 7}, NULL, NULL));
    close(fd);
}

static void frame_over_its_tolerance_is_refused(void **state)
{
    struct job job = make_job();

    job.quality.tolerance = 0.01;
    assert_refused(make_audited_file(0.0101, 0.02, 0.01), &job, 7,
                   "marchd:error: expected at most 0.01 (tolerance), got 0.0101");
    assert_refused(make_audited_file(0.006, 0.02, 0.005), &job, 7, "expected at most 0.005 (tolerance), got 0.006");
    assert_refused(make_audited_file(NAN, 0.02, 0.01), &job, 7, "marchd:error: expected at most 0.01");
    assert_refused(make_audited_file(0.001, INFINITY, 0.01), &job, 7, "marchd:error95");
    job.quality.tolerance = 0.0;
    assert_refused(make_audited_file(0.0101, 0.02, 0.01), &job, 7, "expected at most 0.01 (tolerance), got 0.0101");
    assert_refused(make_audited_file(0.0101, 0.02, NAN), &job, 7, "marchd:error: expected at most nan");
}

static int make_missed_file(double error)
{
    return make_measured_file(
        0, (struct image_exr_rays){0},
        (struct audit_result){
            .kind = AUDIT_REFERENCE, .error = error, .error95 = 0.04, .tolerance = 0.01, .is_missed = true});
}

static bool passes(int fd, const struct job *job, bool accepts_missed)
{
    bool passed = gate_check(
        &(struct gate_params){
            .fd = fd, .job = job, .picture_hash = job->hash, .frame = 7, .accepts_missed = accepts_missed},
        NULL, NULL);

    close(fd);
    return passed;
}

static void missed_frame_passes_only_where_the_job_publishes_it(void **state)
{
    struct job job = make_job();

    job.quality.tolerance = 0.01;
    assert_false(passes(make_missed_file(0.02), &job, true));
    job.quality.on_miss = JOB_ON_MISS_PUBLISH;
    assert_true(passes(make_missed_file(0.02), &job, true));
    assert_false(passes(make_missed_file(NAN), &job, true));
    assert_false(passes(make_missed_file(INFINITY), &job, true));
    assert_false(passes(make_audited_file(0.02, 0.04, 0.01), &job, true));
    assert_refused(make_missed_file(0.02), &job, 7,
                   "marchd:missed: expected an error of at most 0.01 (tolerance), got 0.02");
}

static void frame_without_an_audit_is_refused_where_a_tolerance_is_stated(void **state)
{
    struct job job = make_job();

    job.quality.tolerance = 0.01;
    assert_refused(make_file(0), &job, 7,
                   "marchd:error: expected the frame's measured error, at most 0.01 (tolerance), got nothing");
}

static void frame_within_its_tolerance_passes(void **state)
{
    struct job job = make_job();
    int fd = make_audited_file(0.0078125, 0.015625, 0.0078125);
    struct gate_result result;

    job.quality.tolerance = 0.01;
    assert_true(
        gate_check(&(struct gate_params){.fd = fd, .job = &job, .picture_hash = job.hash, .frame = 7}, &result, NULL));
    assert_int_equal(result.facts.audit.kind, AUDIT_REFERENCE);
    assert_true(result.facts.audit.error95 == 0.015625);
    close(fd);
}

static void cut_or_foreign_file_is_refused(void **state)
{
    struct job job = make_job();
    int cut = make_file(0), foreign = memfd_create("text", MFD_CLOEXEC);
    struct stat status;

    assert_int_equal(fstat(cut, &status), 0);
    assert_int_equal(ftruncate(cut, status.st_size - 1), 0);
    assert_refused(cut, &job, 7, "line 16");
    assert_int_equal(write(foreign, "not an image", 12), 12);
    assert_refused(foreign, &job, 7, "");
    assert_refused(memfd_create("empty", MFD_CLOEXEC), &job, 7, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_frame_passes_and_is_described),
        cmocka_unit_test(values_that_are_not_finite_are_refused),
        cmocka_unit_test(no_channel_and_no_pixel_is_left_out),
        cmocka_unit_test(frame_of_another_number_is_refused),
        cmocka_unit_test(frame_of_another_job_is_refused),
        cmocka_unit_test(frame_of_other_inputs_is_refused),
        cmocka_unit_test(frame_of_another_shape_is_refused),
        cmocka_unit_test(cut_or_foreign_file_is_refused),
        cmocka_unit_test(frame_with_too_much_cut_is_refused),
        cmocka_unit_test(frame_with_little_cut_passes),
        cmocka_unit_test(frame_over_its_tolerance_is_refused),
        cmocka_unit_test(frame_without_an_audit_is_refused_where_a_tolerance_is_stated),
        cmocka_unit_test(frame_within_its_tolerance_passes),
        cmocka_unit_test(missed_frame_passes_only_where_the_job_publishes_it),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
