// Marches continued slice by slice: the picture equals that of one uninterrupted march, however short the slices.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "reference/reference.h"
#include "tests/support/example_job.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "tests/support/shader_variant.h"
#include "tests/support/temp_folder.h"
#include "worker/picture/image.h"
#include "worker/picture/pixel.h"
#include "worker/render/renderer.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 32, HEIGHT_PX = 18, PIXELS = WIDTH_PX * HEIGHT_PX };

struct counted {
    int calls;
};

static bool count_call(void *user, double done)
{
    struct counted *counted = user;

    (void)done;
    ++counted->calls;
    return true;
}

// The frame, or a list of its pixels.
static struct image render_pixels(const struct job *job, const char *shader_dir, const struct pixel *pixels, int count,
                                  int *calls)
{
    struct error error = {{0}};
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, shader_dir);
    struct renderer_result result;
    struct counted counted = {0};
    struct image image;

    assert_true(image_init(&image, pixels ? count : job->width_px, pixels ? 1 : job->height_px, true, true, &error));
    if (!renderer_render(stage.renderer,
                         &(struct renderer_frame){.job = job,
                                                  .frame = 0,
                                                  .pixels = pixels,
                                                  .pixel_count = (size_t)count,
                                                  .image = &image,
                                                  .on_progress = count_call,
                                                  .user = &counted},
                         &result, &error))
        fail_msg("%s", error.message);
    gl_stage_close(stage);
    *calls = counted.calls;
    return image;
}

static struct image render(const struct job *job, const char *shader_dir, int *calls)
{
    return render_pixels(job, shader_dir, NULL, 0, calls);
}

// A slice of a camera ray gets `iterations` iterations.
static void shorten_slices(void **state, const char *iterations)
{
    char to[64];

    snprintf(to, sizeof to, "MARCH_ITERATIONS = %s", iterations);
    // The limit is above what a shadow ray takes, below what a camera ray takes.
    shader_variant_write(state, "math/march.glsl", "MARCH_LIMIT = 60000", "MARCH_LIMIT = 150");
    shader_variant_write(state, "integrator/sliced.glsl", "MARCH_ITERATIONS = 20000", to);
}

struct variant {
    const char *job;
    struct job_quality quality;
};

static const struct variant variants[] = {
    {"cloud", {.method = JOB_METHOD_RIEMANN, .step = 0.0015, .light_steps = 40, .samples = 1}},
    {"cloud",
     {.method = JOB_METHOD_RIEMANN, .step = 0.0015, .light_steps = 40, .samples = 1, .min_transmittance = 0.01}},
    {"cloud", {.method = JOB_METHOD_MIDPOINT, .step = 0.001, .light_step = 0.02, .samples = 1}},
    {"cloud",
     {.method = JOB_METHOD_MIDPOINT,
      .step = 0.001,
      .light_step = 0.02,
      .samples = 3,
      .roulette_below = 0.5,
      .roulette_survive = 0.4}},
    {"cloud", {.method = JOB_METHOD_JITTERED, .step = 0.001, .light_step = 0.02, .samples = 2}},
    {"cloud", {.method = JOB_METHOD_ADAPTIVE, .step = 0.002, .light_step = 0.02, .depth_step = 0.05, .samples = 1}},
    {"noise", {.method = JOB_METHOD_MIDPOINT, .step = 0.01, .light_step = 0.1, .samples = 1}},
    {"noise", {.method = JOB_METHOD_GAUSS, .order = 2, .step = 0.01, .light_step = 0.1, .samples = 1}},
};

static void load(struct job *job, const struct variant *variant)
{
    example_job_load(job, variant->job);
    example_job_shrink(job, WIDTH_PX, HEIGHT_PX, 2.0);
    job->output.has_depth = job->output.has_transmittance = true;
    job->quality = variant->quality;
}

// Pictures are equal bit for bit, depths included, and also where rays end at random.
static void short_slices_make_the_same_picture(void **state)
{
    static const char *const iterations[] = {"7", "61"};

    for (size_t k = 0; k < sizeof iterations / sizeof *iterations; ++k) {
        shorten_slices(state, iterations[k]);
        for (size_t i = 0; i < sizeof variants / sizeof *variants; ++i) {
            struct image whole, sliced;
            struct job job;
            int whole_calls, sliced_calls;

            load(&job, &variants[i]);
            whole = render(&job, test_shader_dir(), &whole_calls);
            sliced = render(&job, *state, &sliced_calls);
            print_message("variant %zu: progress told %d times, in slices %d\n", i, whole_calls, sliced_calls);
            assert_true(sliced_calls > whole_calls + 2);
            assert_memory_equal(whole.rgba, sliced.rgba, 4 * PIXELS * sizeof(float));
            assert_memory_equal(whole.transmittance, sliced.transmittance, 4 * PIXELS * sizeof(float));
            assert_memory_equal(whole.depth, sliced.depth, PIXELS * sizeof(float));
            image_finish(&whole);
            image_finish(&sliced);
            job_finish(&job);
        }
    }
}

// Lists are cut and continued as frames are, in squares instead of rows.
static void short_slices_make_the_same_list(void **state)
{
    struct pixel pixels[PIXELS / 3];

    for (int i = 0; i < PIXELS / 3; ++i)
        pixels[i] = (struct pixel){(7 * i + 3) % WIDTH_PX, (5 * i + 1) % HEIGHT_PX};
    shorten_slices(state, "7");
    for (size_t i = 0; i < sizeof variants / sizeof *variants; ++i) {
        struct image whole, list;
        struct job job;
        int whole_calls, list_calls;

        load(&job, &variants[i]);
        whole = render(&job, test_shader_dir(), &whole_calls);
        list = render_pixels(&job, *state, pixels, PIXELS / 3, &list_calls);
        assert_true(list_calls > whole_calls + 2);
        for (int k = 0; k < PIXELS / 3; ++k) {
            int at = pixels[k].y * WIDTH_PX + pixels[k].x;

            assert_memory_equal(&list.rgba[4 * k], &whole.rgba[4 * at], 4 * sizeof(float));
            assert_memory_equal(&list.transmittance[4 * k], &whole.transmittance[4 * at], 4 * sizeof(float));
            assert_memory_equal(&list.depth[k], &whole.depth[at], sizeof(float));
        }
        image_finish(&whole);
        image_finish(&list);
        job_finish(&job);
    }
}

// And so are the lists of a sparse frame.
static void short_slices_make_the_same_sparse_picture(void **state)
{
    shorten_slices(state, "7");
    for (size_t i = 0; i < sizeof variants / sizeof *variants; i += 3) {
        struct image whole, sliced;
        struct job job;
        int whole_calls, sliced_calls;

        load(&job, &variants[i]);
        job.quality.pixels = (struct job_pixels){.stride = 4, .threshold = 0.3};
        whole = render(&job, test_shader_dir(), &whole_calls);
        sliced = render(&job, *state, &sliced_calls);
        assert_true(sliced_calls > whole_calls + 2);
        assert_non_null(memchr(whole.doubts, 1, PIXELS)); // some pixels are interpolated
        assert_memory_equal(whole.doubts, sliced.doubts, PIXELS);
        assert_memory_equal(whole.rgba, sliced.rgba, 4 * PIXELS * sizeof(float));
        assert_memory_equal(whole.transmittance, sliced.transmittance, 4 * PIXELS * sizeof(float));
        assert_memory_equal(whole.depth, sliced.depth, PIXELS * sizeof(float));
        image_finish(&whole);
        image_finish(&sliced);
        job_finish(&job);
    }
}

static double find_error(const struct job_quality *quality)
{
    static double truth[3 * PIXELS];
    static bool is_known;
    const struct variant variant = {"cloud", *quality};
    float seen[3 * PIXELS];
    struct reference_error error;
    struct image image;
    struct still still;
    struct job job;
    int calls;

    load(&job, &variant);
    still_init(&still, &job, 2.0);
    for (int i = 0; i < PIXELS && !is_known; ++i)
        memcpy(
            truth + 3 * i,
            reference_measure_pixel(&still, i % WIDTH_PX, i / WIDTH_PX, &(struct integrate_accuracy){.relative = 1e-3})
                .radiance,
            3 * sizeof *truth);
    is_known = true;
    image = render(&job, test_shader_dir(), &calls);
    for (int i = 0; i < PIXELS; ++i)
        memcpy(seen + 3 * i, image.rgba + 4 * i, 3 * sizeof *seen);
    image_finish(&image);
    job_finish(&job);
    error = reference_image_error(seen, truth, 3 * PIXELS);
    print_message("%.2e of the light\n", error.relative_rmse);
    return error.relative_rmse;
}

// The method is of first order: halving the steps of both sums, along the ray and towards the light, halves the error.
// The finer two methods take 14 and 60 times the iterations that software GL runs at once.
static void fine_sums_converge(void **state)
{
    double coarse = find_error(
        &(struct job_quality){.method = JOB_METHOD_RIEMANN, .step = 0.005, .light_steps = 512, .samples = 1});
    double fine = find_error(
        &(struct job_quality){.method = JOB_METHOD_RIEMANN, .step = 0.0025, .light_steps = 1024, .samples = 1});

    assert_true(fine < 7e-3);
    assert_true(fine < 0.65 * coarse);
    assert_true(find_error(&(struct job_quality){
                    .method = JOB_METHOD_MIDPOINT, .step = 0.002, .light_step = 0.002, .samples = 1}) < 4e-4);
}

int main(int argument_count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(short_slices_make_the_same_picture, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(short_slices_make_the_same_list, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(short_slices_make_the_same_sparse_picture, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test(fine_sums_converge),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
