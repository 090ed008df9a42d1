// Densities that are baked into grids: their light against the converged integral.
// SPDX-License-Identifier: Apache-2.0
// A grid may serve several frames, and not every density is baked.
#include "worker/density/density_bake.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job_json.h"
#include "reference/reference.h"
#include "tests/support/assert_near.h"
#include "tests/support/example_job.h"
#include "tests/support/gl_stage.h"
#include "tests/support/render_frame.h"
#include "tests/support/shader_dir.h"
#include "tests/support/true_light.h"
#include "worker/density/density_fill.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"
#include "worker/shader/scene_program.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 16, HEIGHT_PX = 12, PIXELS = WIDTH_PX * HEIGHT_PX };

#define NOISE "\"kind\": \"noise\", \"frequency\": 1.5, \"offset\": [3.7, 1.2, 8.4], \"lacunarity\": 2, \"H\": 0.4"
#define TURNING ", \"rotate\": { \"axis\": [1, 2, -1], \"angle\": { \"start\": 25, \"rate\": 400 } }"
#define TURNED ", \"rotate\": { \"axis\": [1, 2, -1], \"angle\": 25 }"
#define BALL ", \"bounds\": { \"kind\": \"sphere\", \"center\": [0.1, 0, 0], \"radius\": 1, \"falloff\": 0.2 }"
#define BOX ", \"bounds\": { \"kind\": \"box\", \"center\": [0.1, 0, 0], \"size\": [2, 0.8, 1.4] }"
#define OWN "\"kind\": \"glsl\", \"file\": \"/farm/clouds.glsl\", \"source\": \"?\""

// A medium that glows and absorbs: of what is seen, all is in the density along camera rays.
static void parse(struct job *job, const char *density, int cells)
{
    struct error error = {{0}};
    char text[2048];

    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"baked\", \"frames\": \"0-3\", \"fps\": 24, \"resolution\": [%d, %d],"
             " \"camera\": { \"position\": [0.3, 0.5, 4], \"target\": [0, 0, 0], \"up\": [0, 1, 0], \"fov\": 34, "
             "\"clip\": [0, 9] },"
             " \"scene\": { \"media\": [ { \"density\": { %s }, \"sigma_a\": [3, 2, 1], \"emission\": [1, 2, 3] } ] },"
             " \"quality\": { \"method\": \"midpoint\", \"step\": 0.01 },"
             " \"output\": { \"path\": \"own.####.exr\", \"aovs\": [\"Z\", \"transmittance\"] } }",
             WIDTH_PX, HEIGHT_PX, density);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    job->quality.method = JOB_METHOD_CACHED;
    job->quality.density_grid = cells;
}

static void set_text(struct job *job, const char *text)
{
    struct scene_glsl *glsl = &job->scene.media[0].density.glsl;

    free(glsl->source);
    glsl->source = xstrdup(text);
}

static void assert_true_light(const char *density, int cells, double tolerance)
{
    struct density_bake bake;
    struct true_light light;
    struct job job;

    parse(&job, density, cells);
    assert_true(density_bake_find(&bake, &job, 0));
    light = true_light_compare(&job, GL_BACKEND_SOFTWARE);
    assert_true(true_light_is_within(&light, tolerance));
    job_finish(&job);
}

// With ten cells for each of the finest octave's, twice what is left; samples kept as they are would leave 3e-3.
static const double noise_tolerance = 1.5e-3;
// With four, where edges of the clipped sum matter most.
static const double coarse_tolerance = 8e-3;

static void noise_is_the_converged_light(void **state)
{
    assert_true_light(NOISE ", \"octaves\": 4, \"mode\": \"clip\", \"scale\": 4" TURNING BALL, 176, noise_tolerance);
    assert_true_light(NOISE ", \"octaves\": 3, \"mode\": \"remap\", \"bias\": -0.3, \"scale\": 2" BALL, 96,
                      noise_tolerance);
}

// Absolute values have creases, which no cell shows.
static void turbulence_is_the_converged_light(void **state)
{
    assert_true_light(NOISE ", \"octaves\": 3, \"mode\": \"absolute\", \"scale\": 2" TURNED BALL, 96, 1e-2);
}

// A grid that knows two octaves of five.
static void octaves_too_fine_for_the_grid_are_added(void **state)
{
    assert_true_light(NOISE ", \"octaves\": 5, \"mode\": \"clip\", \"scale\": 4" TURNING BALL, 48, coarse_tolerance);
}

// The corners of the box lie far out in the grid's axes.
static void a_turned_box_lies_in_its_grid(void **state)
{
    assert_true_light(NOISE ", \"octaves\": 3, \"mode\": \"clip\", \"scale\": 4" TURNED BOX, 120, noise_tolerance);
    assert_true_light(NOISE ", \"octaves\": 3, \"mode\": \"clip\", \"scale\": 4" TURNING BOX, 150, noise_tolerance);
}

static double waves_at(const void *context, struct vec3 p, double t)
{
    (void)context;
    return sin(3 * p.x + 2 * t) * cos(2 * p.y) * cos(4 * p.z) + 0.2;
}

// The function has waves half a metre long; the sides of its grid differ.
static void own_code_is_its_twin(void **state)
{
    static const struct still_inputs inputs = {.functions[0].at = waves_at};
    static const char text[] = "float density(vec3 p, float t)\n{\n"
                               "    return sin(3.0 * p.x + 2.0 * t) * cos(2.0 * p.y) * cos(4.0 * p.z) + 0.2;\n}\n";
    struct job job;

    for (int has_bound = 0; has_bound < 2; has_bound++) {
        struct image image;
        struct still still;
        double square = 0, difference = 0;

        parse(&job, OWN BOX ", \"scale\": 2", 60);
        set_text(&job, text);
        job.time_offset = 0.3;
        job.scene.media[0].density.glsl.lipschitz = has_bound ? 5.4 : 0;
        render_frame_zero(&job, &image);
        still_init_with_inputs(&still, &job, job_frame_time(&job, 0), &inputs);
        for (int i = 0; i < PIXELS; i++) {
            struct reference_pixel pixel = reference_measure_pixel(&still, i % WIDTH_PX, i / WIDTH_PX, NULL);

            for (int c = 0; c < 3; c++) {
                square += pixel.radiance[c] * pixel.radiance[c];
                difference += pow(pixel.radiance[c] - (double)image.rgba[4 * i + c], 2);
            }
        }
        print_message("relative RMSE %.2e\n", sqrt(difference / square));
        // Fifteen cells to the shortest wave; samples kept as they are would leave 9e-4.
        assert_true(sqrt(difference / square) < 1.5e-4);
        image_finish(&image);
        job_finish(&job);
    }
}

// The lamp is in the cloud, and in view at the second of these times.
static void the_example_is_the_converged_light(void **state)
{
    static const double times[] = {0.4, 1.7};

    for (size_t i = 0; i < 2; i++) {
        struct true_light light;
        struct job job;

        example_job_load(&job, "noise");
        example_job_shrink(&job, 12, 7, times[i]);
        job.quality = (struct job_quality){
            .method = JOB_METHOD_CACHED, .step = 0.03, .light_grid = 128, .density_grid = 128, .samples = 1};
        light = true_light_compare(&job, GL_BACKEND_SOFTWARE);
        assert_true(true_light_is_within(&light, 1e-2));
        job_finish(&job);
    }
}

static int64_t render(struct gl_stage *stage, const struct job *job, int32_t frame, struct image *image)
{
    struct error error = {{0}};
    struct renderer_result result;

    if (!image_init(image, job->width_px, job->height_px, true, true, &error) ||
        !renderer_render(stage->renderer, &(struct renderer_frame){.job = job, .frame = frame, .image = image}, &result,
                         &error))
        fail_msg("%s", error.message);
    return result.cache_fills;
}

// How many grids frames 0 to 3 took; the last picture is that of a renderer that saw no other frame.
static int64_t count_fills(const struct job *job)
{
    int64_t count = 0;
    struct gl_stage stage, fresh;
    struct image image, alone;

    stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    for (int32_t frame = 0; frame < 4; frame++) {
        count += render(&stage, job, frame, &image);
        if (frame < 3) image_finish(&image);
    }
    fresh = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    assert_int_equal(render(&fresh, job, 3, &alone), DENSITY_FILL_CACHES);
    assert_memory_equal(image.rgba, alone.rgba, sizeof(float[4]) * PIXELS);
    image_finish(&image);
    image_finish(&alone);
    gl_stage_close(fresh);
    gl_stage_close(stage);
    return count / DENSITY_FILL_CACHES;
}

static int64_t count_noise_fills(const char *more)
{
    char density[512];
    struct job job;
    int64_t count;

    snprintf(density, sizeof density, "%s, \"octaves\": 3%s", NOISE, more);
    parse(&job, density, 64);
    count = count_fills(&job);
    job_finish(&job);
    return count;
}

static void noise_that_turns_and_fades_is_baked_once(void **state)
{
    assert_int_equal(count_noise_fills(TURNING BALL), 1);
    assert_int_equal(
        count_noise_fills(", \"bias\": { \"start\": 0, \"rate\": 1 }, \"scale\": { \"start\": 1, \"rate\": 9 }"
                          ", \"bounds\": { \"kind\": \"sphere\", \"radius\": { \"start\": 0.7, \"rate\": 1 },"
                          " \"center\": { \"start\": [0, 0, 0], \"rate\": [1, 0, 2] } }"),
        1);
}

static void noise_that_changes_is_baked_anew(void **state)
{
    struct job job;

    parse(&job, NOISE ", \"octaves\": 3" BALL, 64);
    job.scene.media[0].density.noise.offset =
        (struct timeline){.kind = TIMELINE_LINEAR, .component_count = 3, .linear.rate = {1, 0, 0}};
    assert_int_equal(count_fills(&job), 4);
    job_finish(&job);
}

static int64_t count_own_fills(const char *text)
{
    struct job job;
    int64_t count;

    parse(&job, OWN BALL, 24);
    set_text(&job, text);
    count = count_fills(&job);
    job_finish(&job);
    return count;
}

static void own_code_is_baked_anew_where_it_uses_its_time(void **state)
{
    assert_int_equal(count_own_fills("float density(vec3 p, float t) { return 1.0 - length(p); }"), 1);
    assert_int_equal(count_own_fills("float at(float t) { return t; }\n"
                                     "float density(vec3 p, float when);\n"
                                     "float density(vec3 p, float t) { { return at(1.0) - length(p); } }"),
                     1);
    assert_int_equal(count_own_fills("float density(vec3 p, float t) { return 1.0 + t - length(p); }"), 4);
    assert_int_equal(
        count_own_fills("float density(vec3 p, float unused);\n"
                        "float density(vec3 p, in float t) { if (p.x > 9.0) { return 1.0; } return 1.0 + t; }"),
        4);
    assert_int_equal(count_own_fills("#define NOW t\nfloat density(vec3 p, float t) { return 1.0 + NOW; }"), 4);
}

// Outside of the ball there is no root.
static void own_code_need_not_hold_outside_its_bounds(void **state)
{
    struct image image;
    struct job job;

    parse(&job, OWN ", \"bounds\": { \"kind\": \"sphere\", \"radius\": 1 }", 30);
    set_text(&job, "float density(vec3 p, float t) { return 2.0 + sqrt(1.0 - dot(p, p)) * 0.0; }");
    render_frame_zero(&job, &image);
    for (int i = 0; i < 4 * PIXELS; i++)
        assert_true(isfinite(image.rgba[i]));
    assert_true(image.rgba[4 * (PIXELS / 2 + WIDTH_PX / 2)] > 0.1f);
    image_finish(&image);
    job_finish(&job);
}

static void a_mistake_in_own_code_is_told(void **state)
{
    struct error error = {{0}};
    struct renderer_result result;
    struct gl_stage stage;
    struct image image;
    struct job job;

    parse(&job, OWN BALL, 24);
    set_text(&job, "float density(vec3 p, float t)\n{\n    return nothing;\n}\n");
    stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    assert_true(image_init(&image, job.width_px, job.height_px, true, true, NULL));
    assert_false(renderer_render(stage.renderer, &(struct renderer_frame){.job = &job, .frame = 0, .image = &image},
                                 &result, &error));
    assert_int_equal(result.fault, RENDERER_FAULT_JOB);
    assert_non_null(strstr(error.message, "clouds.glsl:3"));
    image_finish(&image);
    gl_stage_close(stage);
    job_finish(&job);
}

static void assert_not_baked(const char *density, int cells)
{
    struct density_bake bake;
    struct scene_program program;
    struct job job;

    parse(&job, density, cells);
    assert_false(density_bake_find(&bake, &job, 0));
    assert_true(scene_program_init(&program, &job, NULL, test_shader_dir(), NULL));
    assert_int_equal(program.cache_count, 0);
    scene_program_finish(&program);
    job_finish(&job);
}

static void what_gains_nothing_is_not_baked(void **state)
{
    assert_not_baked(NOISE ", \"octaves\": 1" BALL, 64);
    assert_not_baked(NOISE ", \"octaves\": 4" BALL, 16); // a cell for each cell of the second octave
    assert_not_baked(NOISE ", \"octaves\": 4" BALL, 0);
    assert_not_baked(
        NOISE ", \"octaves\": 4, \"bounds\": { \"kind\": \"slab\", \"normal\": [0, 0, 1], \"thickness\": 1 }", 64);
    assert_not_baked("\"kind\": \"homogeneous\"" BALL, 64);
}

static void both_backends_show_the_same(void **state)
{
    struct gl_stage software, egl;
    struct image a, b;
    struct job job;

    parse(&job, NOISE ", \"octaves\": 4, \"mode\": \"clip\", \"scale\": 4" TURNING BALL, 100);
    egl = gl_stage_open(GL_BACKEND_EGL, test_shader_dir());
    software = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    render(&software, &job, 1, &a);
    render(&egl, &job, 1, &b);
    for (int i = 0; i < 4 * PIXELS; i++)
        assert_near(a.rgba[i], b.rgba[i], 1e-3); // a GPU's filter has weights of 8 bits
    image_finish(&a);
    image_finish(&b);
    gl_stage_close(egl);
    gl_stage_close(software);
    job_finish(&job);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_is_the_converged_light),
        cmocka_unit_test(turbulence_is_the_converged_light),
        cmocka_unit_test(octaves_too_fine_for_the_grid_are_added),
        cmocka_unit_test(a_turned_box_lies_in_its_grid),
        cmocka_unit_test(own_code_is_its_twin),
        cmocka_unit_test(the_example_is_the_converged_light),
        cmocka_unit_test(noise_that_turns_and_fades_is_baked_once),
        cmocka_unit_test(noise_that_changes_is_baked_anew),
        cmocka_unit_test(own_code_is_baked_anew_where_it_uses_its_time),
        cmocka_unit_test(own_code_need_not_hold_outside_its_bounds),
        cmocka_unit_test(a_mistake_in_own_code_is_told),
        cmocka_unit_test(what_gains_nothing_is_not_baked),
        cmocka_unit_test(both_backends_show_the_same),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // name pattern
    return cmocka_run_group_tests(tests, NULL, NULL);
}
