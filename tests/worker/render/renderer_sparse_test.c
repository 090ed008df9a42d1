// Sparse frames: what is traced has the bits of the whole frame, and the rest lies between.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/assert_near.h"
#include "tests/support/example_job.h"
#include "tests/support/gl_stage.h"
#include "tests/support/object_job.h"
#include "tests/support/shader_dir.h"
#include "tests/support/sparse_pair.h"
#include "worker/render/renderer.h"

#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 163, HEIGHT_PX = 91 }; // neither is a multiple of a stride

static const struct job_pixels usual = {.stride = 16, .threshold = 0.01};

struct variant {
    const char *job;
    struct job_quality quality;
    bool moves; // in an open shutter, the camera as well
};

static const struct variant variants[] = {
    {"cloud", {.method = JOB_METHOD_MIDPOINT, .step = 0.03, .light_step = 0.06, .samples = 1}, false},
    {"cloud", {.method = JOB_METHOD_CACHED, .step = 0.02, .light_grid = 16, .samples = 3}, true},
    {"noise", {.method = JOB_METHOD_GAUSS, .order = 2, .step = 0.2, .light_step = 0.3, .samples = 1}, false},
    {"scan", {.method = JOB_METHOD_PREINTEGRATED, .step_voxels = 3, .samples = 1}, false},
    {"fog", {.method = JOB_METHOD_EQUIANGULAR, .points = 4, .samples = 1}, false},
    {"sunset", {.method = JOB_METHOD_RIEMANN, .step = 4000, .light_steps = 4, .samples = 1}, false},
    {"glass",
     {.method = JOB_METHOD_EQUIANGULAR,
      .points = 1,
      .samples = 2,
      .max_depth = 3,
      .min_throughput = 0.01,
      .max_cut = 1.0},
     true},
};

static void load(struct job *job, const struct variant *variant)
{
    example_job_load(job, variant->job);
    example_job_shrink(job, WIDTH_PX, HEIGHT_PX, 2.0);
    job->output.has_depth = job->output.has_transmittance = true;
    job->quality = variant->quality;
    if (variant->quality.method == JOB_METHOD_RIEMANN) job->scene.camera.clip_far = 2e5;
    if (!variant->moves) return;
    job->scene.camera.shutter = 0.5;
    assert_int_equal(job->scene.camera.position.kind, TIMELINE_CONSTANT);
    job->scene.camera.position.kind = TIMELINE_LINEAR; // whose start is where the constant is
    for (int axis = 0; axis < 3; axis++)
        job->scene.camera.position.linear.rate[axis] = 0.2;
}

static size_t count_traced(const struct sparse_pair *pair)
{
    const struct image *full = &pair->full, *sparse = &pair->sparse;
    size_t traced = 0;

    for (size_t i = 0; i < (size_t)WIDTH_PX * HEIGHT_PX; i++) {
        if (sparse->doubts[i] != 0) continue;
        traced++;
        assert_memory_equal(sparse->rgba + 4 * i, full->rgba + 4 * i, 4 * sizeof(float));
        assert_memory_equal(sparse->transmittance + 4 * i, full->transmittance + 4 * i, 4 * sizeof(float));
        assert_memory_equal(sparse->depth + i, full->depth + i, sizeof(float));
        assert_memory_equal(sparse->cut + i, full->cut + i, sizeof(float));
    }
    return traced;
}

static double find_most(const struct image *image)
{
    double most = 0.0;

    for (size_t i = 0; i < (size_t)4 * WIDTH_PX * HEIGHT_PX; i++)
        if (i % 4 < 3) most = fmax(most, (double)image->rgba[i]);
    return most;
}

// No negative light, alpha and transmittance from 0 to 1, no light above the brightest.
static void assert_between(const struct sparse_pair *pair)
{
    const struct image *sparse = &pair->sparse;
    double most = find_most(&pair->full);

    for (size_t i = 0; i < (size_t)4 * WIDTH_PX * HEIGHT_PX; i++) {
        assert_true(sparse->rgba[i] >= 0 && (double)sparse->rgba[i] <= (i % 4 < 3 ? most : 1));
        assert_true(i % 4 == 3 || (sparse->transmittance[i] >= 0 && sparse->transmittance[i] <= 1));
        assert_true(sparse->depth[i / 4] >= 0 && sparse->cut[i / 4] >= 0);
        assert_true(isfinite(sparse->depth[i / 4]));
    }
}

static void traced_pixels_have_the_frame_s_bits(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());

    (void)state;
    for (size_t i = 0; i < sizeof variants / sizeof *variants; i++) {
        struct sparse_pair pair;
        struct job job;
        size_t traced;

        load(&job, &variants[i]);
        sparse_pair_render(stage.renderer, &job, 0, usual, &pair);
        assert_null(pair.full.doubts);
        assert_near(pair.full_result.traced, 1, 0);
        assert_non_null(pair.sparse.doubts);
        traced = count_traced(&pair);
        assert_near(pair.sparse_result.traced, (double)traced / (WIDTH_PX * HEIGHT_PX), 1e-12);
        assert_between(&pair);
        print_message("%s: %.1f %% traced, error %.2e\n", variants[i].job, 100 * pair.sparse_result.traced,
                      sparse_pair_error(&pair));
        assert_true(pair.sparse_result.traced < 0.95);
        sparse_pair_finish(&pair);
        job_finish(&job);
    }
    gl_stage_close(stage);
}

// Rays and cut rays of pixels that were interpolated are those of their neighbours.
static void rays_are_counted_as_in_the_frame(void **state)
{
    const struct variant *glass = &variants[sizeof variants / sizeof *variants - 1];
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct sparse_pair pair;
    struct job job;

    (void)state;
    load(&job, glass);
    sparse_pair_render(stage.renderer, &job, 0, (struct job_pixels){8, 0.3}, &pair);
    print_message("%.1f %% traced: %.4f rays a pixel, %.4f in the frame; %.2e cut, %.2e in the frame\n",
                  100 * pair.sparse_result.traced, pair.sparse_result.ray_counts.rays, pair.full_result.ray_counts.rays,
                  pair.sparse_result.ray_counts.cut_throughput, pair.full_result.ray_counts.cut_throughput);
    assert_true(pair.full_result.ray_counts.is_known && pair.sparse_result.ray_counts.is_known);
    assert_true(pair.sparse_result.traced < 0.6);
    assert_near(pair.sparse_result.ray_counts.rays / pair.full_result.ray_counts.rays, 1, 0.01);
    assert_near(pair.sparse_result.ray_counts.cut_rays / pair.full_result.ray_counts.cut_rays, 1, 0.05);
    assert_near(pair.sparse_result.ray_counts.cut_throughput / pair.full_result.ray_counts.cut_throughput, 1, 0.05);
    sparse_pair_finish(&pair);
    job_finish(&job);
    gl_stage_close(stage);
}

// Where nothing moves, a pixel's centre stands for its samples wherever the picture is smooth.
static void smooth_pixels_take_their_centre_alone(void **state)
{
    static const struct variant cloud = {
        "cloud", {.method = JOB_METHOD_CACHED, .step = 0.02, .light_grid = 16, .samples = 9}, false};
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct sparse_pair pair;
    struct renderer_result result;
    struct image moving;
    struct job job;
    double edges, error;

    (void)state;
    load(&job, &cloud);
    sparse_pair_render(stage.renderer, &job, 0, usual, &pair);
    edges = (double)count_traced(&pair) / (WIDTH_PX * HEIGHT_PX); // with the bits of all samples
    error = sparse_pair_error(&pair);
    job.scene.camera.shutter = 0.01;
    moving = sparse_pair_frame(stage.renderer, &job, 0, usual, &result);
    print_message("%.1f %% of the samples, %.1f %% of the pixels are edges, error %.2e; in an open shutter %.1f %%\n",
                  100 * pair.sparse_result.traced, 100 * edges, error, 100 * result.traced);
    assert_true(edges > 0.02 && edges < pair.sparse_result.traced);
    assert_true(pair.sparse_result.traced < edges + 1.0 / 9.0);
    assert_true(pair.sparse_result.traced < 0.6 * result.traced);
    assert_true(error < 0.0004);
    assert_between(&pair);
    image_finish(&moving);
    sparse_pair_finish(&pair);
    job_finish(&job);
    gl_stage_close(stage);
}

static void assert_same(const struct image *image, const struct image *other)
{
    size_t count = (size_t)WIDTH_PX * HEIGHT_PX;

    assert_memory_equal(image->rgba, other->rgba, 4 * count * sizeof(float));
    assert_memory_equal(image->transmittance, other->transmittance, 4 * count * sizeof(float));
    assert_memory_equal(image->depth, other->depth, count * sizeof(float));
    assert_memory_equal(image->cut, other->cut, count * sizeof(float));
    assert_memory_equal(image->doubts, other->doubts, count);
}

// Of all bits, in text that children print. Fowler, Noll and Vo, 1991.
static uint64_t hash_image(const struct image *image)
{
    size_t count = (size_t)WIDTH_PX * HEIGHT_PX;
    const struct {
        const void *bytes;
        size_t size;
    } parts[] = {{image->rgba, 4 * count * sizeof(float)},
                 {image->transmittance, 4 * count * sizeof(float)},
                 {image->depth, count * sizeof(float)},
                 {image->cut, count * sizeof(float)},
                 {image->doubts, count}};
    uint64_t hash = 14695981039346656037u;

    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        for (size_t k = 0; k < parts[i].size; k++)
            hash = (hash ^ ((const unsigned char *)parts[i].bytes)[k]) * 1099511628211u;
    return hash;
}

static uint64_t hash_afresh(void)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct renderer_result result;
    struct image image;
    struct job job;
    uint64_t hash;

    load(&job, &variants[1]);
    image = sparse_pair_frame(stage.renderer, &job, 0, usual, &result);
    hash = hash_image(&image);
    image_finish(&image);
    job_finish(&job);
    gl_stage_close(stage);
    return hash;
}

// Tiles grow and shrink with the time that those before them took.
static void bits_do_not_depend_on_what_was_rendered_before(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct renderer_result result;
    struct image first, other, again, full;
    struct job job, fog;

    (void)state;
    load(&job, &variants[1]);
    load(&fog, &variants[4]);
    first = sparse_pair_frame(stage.renderer, &job, 0, usual, &result);
    for (int32_t frame = 1; frame < 4; frame++) {
        other = sparse_pair_frame(stage.renderer, frame == 2 ? &fog : &job, frame, usual, &result);
        image_finish(&other);
    }
    full = sparse_pair_frame(stage.renderer, &job, 0, (struct job_pixels){0}, &result);
    again = sparse_pair_frame(stage.renderer, &job, 0, usual, &result);
    assert_false(result.is_copy);
    assert_same(&first, &again);
    assert_true(hash_image(&first) == hash_afresh());
    image_finish(&first);
    image_finish(&again);
    image_finish(&full);
    job_finish(&job);
    job_finish(&fog);
    gl_stage_close(stage);
}

// In a process of its own, for GL counts its threads once.
static void bits_do_not_depend_on_the_number_of_threads(void **state)
{
    static const char *const counts[] = {"1", "3"};
    uint64_t hash = hash_afresh();

    (void)state;
    for (int i = 0; i < 2; i++) {
        char command[512], line[64] = "";
        FILE *child;

        snprintf(command, sizeof command, "LP_NUM_THREADS=%s '%s' hash", counts[i], program_invocation_name);
        child = popen(command, "r"); // NOLINT(cert-env33-c)
        assert_non_null(child);
        while (fgets(line, sizeof line, child) && strncmp(line, "hash ", 5) != 0)
            continue;
        assert_int_equal(pclose(child), 0);
        assert_true(strtoull(line + 5, NULL, 16) == hash);
    }
}

// Its program serves the frame after, and a full frame after a sparse one is not taken for a copy of it.
static void a_full_frame_after_a_sparse_one_is_whole(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct sparse_pair pair;
    struct renderer_result result;
    struct image again;
    struct job job;

    (void)state;
    load(&job, &variants[4]);
    sparse_pair_render(stage.renderer, &job, 0, usual, &pair);
    again = sparse_pair_frame(stage.renderer, &job, 0, (struct job_pixels){0}, &result);
    assert_memory_equal(again.rgba, pair.full.rgba, sizeof(float[4]) * WIDTH_PX * HEIGHT_PX);
    assert_near(result.traced, 1, 0);
    image_finish(&again);
    sparse_pair_finish(&pair);
    job_finish(&job);
    gl_stage_close(stage);
}

// Balls of 3 px between the lattice's points, before a dark background.
static void small_things_between_points_are_seen(void **state)
{
    static const char *const scenes[] = {
        "\"objects\": [{\"kind\": \"sphere\", \"center\": [0.2, 0.18, 0], \"radius\": 0.042, \"material\": "
        "{" OBJECT_JOB_GREY "}}]",
        "\"objects\": [{\"kind\": \"box\", \"center\": [0.2, 0.18, 0], \"size\": [0.08, 0.08, 0.08], "
        "\"material\": {" OBJECT_JOB_GREY "}}]",
        "\"media\": [{\"emission\": 50, \"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": "
        "\"sphere\", "
        "\"center\": [0.2, 0.18, 0], \"radius\": 0.042}}}]",
        "\"media\": [{\"emission\": 50, \"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": "
        "\"sphere\", "
        "\"center\": [0.2, 0.18, 0], \"radius\": 0.042, \"falloff\": 0.02}}}]",
    };
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());

    (void)state;
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        struct sparse_pair pair;
        struct job job;
        int seen = 0;

        object_job_parse(&job, scenes[i], OBJECT_JOB_LIGHT ", \"background\": 0.1, " OBJECT_JOB_QUALITY);
        job.width_px = WIDTH_PX;
        job.height_px = HEIGHT_PX;
        sparse_pair_render(stage.renderer, &job, 0, usual, &pair);
        for (int k = 0; k < WIDTH_PX * HEIGHT_PX; k++) {
            if (pair.full.rgba[4 * k] == 0.1f) continue;
            seen++;
            assert_true(k % WIDTH_PX % 16 != 0 && k / WIDTH_PX % 16 != 0);
            assert_int_equal(pair.sparse.doubts[k], 0);
        }
        assert_in_range(seen, 4, 16);
        assert_near(sparse_pair_error(&pair), 0, 0);
        assert_true(pair.sparse_result.traced < 0.1);
        sparse_pair_finish(&pair);
        job_finish(&job);
    }
    gl_stage_close(stage);
}

// Light and depth tell nothing of it: the floor is black, and only its colours are wanted.
static void a_horizon_is_sharp_whatever_the_threshold(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct sparse_pair pair;
    struct job job;
    int dark = 0;

    (void)state;
    object_job_parse(&job,
                     "\"objects\": [{\"kind\": \"plane\", \"point\": [0, -1.5, 0], \"normal\": [0.5, 1, 0], "
                     "\"material\": {" OBJECT_JOB_GREY "}}]",
                     "\"background\": 0.1, " OBJECT_JOB_QUALITY);
    job.width_px = WIDTH_PX;
    job.height_px = HEIGHT_PX;
    job.output.has_depth = job.output.has_transmittance = false;
    sparse_pair_render(stage.renderer, &job, 0, (struct job_pixels){16, 1}, &pair);
    for (int i = 0; i < WIDTH_PX * HEIGHT_PX; i++) {
        dark += pair.full.rgba[4 * i] == 0;
        // A cubic between two points of one side has a sixteenth of each point beyond.
        assert_near(pair.sparse.rgba[4 * i], pair.full.rgba[4 * i], 0.1 * 2.1 / 16);
    }
    assert_in_range(dark, WIDTH_PX * HEIGHT_PX / 5, WIDTH_PX * HEIGHT_PX * 4 / 5);
    sparse_pair_finish(&pair);
    job_finish(&job);
    gl_stage_close(stage);
}

// A lamp in a thin fog, whose light has a peak without an end, at any place between the points.
static void the_peak_around_a_lamp_is_traced(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());

    (void)state;
    for (int i = 0; i < 4; i++) {
        struct sparse_pair pair;
        struct job job;
        size_t peak = 0;

        object_job_parse(
            &job,
            "\"media\": [{\"sigma_s\": 5e-5, \"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": "
            "\"sphere\", \"radius\": 3}}}]",
            OBJECT_JOB_LIGHT ", \"background\": 0.1, "
                             "\"quality\": {\"method\": \"equiangular\", \"points\": 8}");
        job.width_px = WIDTH_PX;
        job.height_px = HEIGHT_PX;
        job.scene.lights[0].position = (struct timeline){
            .kind = TIMELINE_CONSTANT, .component_count = 3, .value = {0.11 + 0.13 * i, 0.21 + 0.07 * i, 0}};
        sparse_pair_render(stage.renderer, &job, 0, usual, &pair);
        for (size_t k = 0; k < (size_t)WIDTH_PX * HEIGHT_PX; k++)
            if (pair.full.rgba[4 * k] > pair.full.rgba[4 * peak]) peak = k;
        assert_int_equal(pair.sparse.doubts[peak], 0);
        assert_true(sparse_pair_error(&pair) < usual.threshold);
        assert_true(pair.sparse_result.traced < 0.4);
        sparse_pair_finish(&pair);
        job_finish(&job);
    }
    gl_stage_close(stage);
}

struct levels {
    const struct image *full;
    int strides[8];
    int count;
    struct image last;
};

static void on_level(void *user, const struct picture_level *level)
{
    struct levels *levels = user;
    int stride = level->stride;

    assert_true(levels->count < 8);
    assert_int_equal(level->width_px, WIDTH_PX);
    assert_int_equal(level->height_px, HEIGHT_PX);
    assert_int_equal(level->columns, (WIDTH_PX - 1 + stride - 1) / stride + 1);
    assert_int_equal(level->rows, (HEIGHT_PX - 1 + stride - 1) / stride + 1);
    for (int y = 0; levels->count == 0 && y * stride < HEIGHT_PX; y++)
        for (int x = 0; x * stride < WIDTH_PX; x++)
            assert_memory_equal(level->rgba + 4 * (y * level->columns + x),
                                levels->full->rgba + 4 * stride * (y * WIDTH_PX + x), sizeof(float[4]));
    if (stride == 1) {
        assert_true(image_init(&levels->last, WIDTH_PX, HEIGHT_PX, false, false, NULL));
        memcpy(levels->last.rgba, level->rgba, sizeof(float[4]) * WIDTH_PX * HEIGHT_PX);
    }
    levels->strides[levels->count++] = stride;
}

// Whoever looks at them changes no bit.
static void levels_are_shown_from_coarse_to_whole(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct levels levels = {0};
    struct renderer_result result;
    struct sparse_pair pair;
    struct image image;
    struct job job;

    (void)state;
    load(&job, &variants[0]);
    sparse_pair_render(stage.renderer, &job, 0, usual, &pair);
    job.quality.pixels = usual;
    levels.full = &pair.full;
    assert_true(image_init_for_job(&image, &job, NULL));
    assert_true(renderer_render(
        stage.renderer, &(struct renderer_frame){.job = &job, .image = &image, .on_level = on_level, .user = &levels},
        &result, NULL));
    assert_int_equal(levels.count, 5);
    for (int i = 0; i < 5; i++)
        assert_int_equal(levels.strides[i], 16 >> i);
    assert_memory_equal(levels.last.rgba, image.rgba, sizeof(float[4]) * WIDTH_PX * HEIGHT_PX);
    assert_memory_equal(image.rgba, pair.sparse.rgba, sizeof(float[4]) * WIDTH_PX * HEIGHT_PX);
    image_finish(&levels.last);
    image_finish(&image);
    sparse_pair_finish(&pair);
    job_finish(&job);
    gl_stage_close(stage);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(traced_pixels_have_the_frame_s_bits),
        cmocka_unit_test(rays_are_counted_as_in_the_frame),
        cmocka_unit_test(smooth_pixels_take_their_centre_alone),
        cmocka_unit_test(bits_do_not_depend_on_what_was_rendered_before),
        cmocka_unit_test(bits_do_not_depend_on_the_number_of_threads),
        cmocka_unit_test(a_full_frame_after_a_sparse_one_is_whole),
        cmocka_unit_test(small_things_between_points_are_seen),
        cmocka_unit_test(a_horizon_is_sharp_whatever_the_threshold),
        cmocka_unit_test(the_peak_around_a_lamp_is_traced),
        cmocka_unit_test(levels_are_shown_from_coarse_to_whole),
    };

    if (argc > 1 && strcmp(argv[1], "hash") == 0) {
        printf("hash %llx\n", (unsigned long long)hash_afresh());
        return 0;
    }
    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
