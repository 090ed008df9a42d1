// Densities in the job's own GLSL: their light, their names, and how their mistakes are told.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job_json.h"
#include "reference/reference.h"
#include "tests/support/assert_near.h"
#include "tests/support/example_job.h"
#include "tests/support/gl_stage.h"
#include "tests/support/job_text.h"
#include "tests/support/json_edit.h"
#include "tests/support/render_frame.h"
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

enum { WIDTH_PX = 12, HEIGHT_PX = 8, PIXELS = WIDTH_PX * HEIGHT_PX };

// A medium whose text comes later, in a sphere of radius 1.
#define OWN(CENTER, MORE)                                                                                              \
    "{ \"density\": { \"kind\": \"glsl\", \"file\": \"/farm/clouds.glsl\", \"source\": \"?\", \"bounds\":"             \
    " { \"kind\": \"sphere\", \"center\": [" CENTER "], \"radius\": 1 } }," MORE " }"

static void parse(struct job *job, const char *media)
{
    struct error error = {{0}};
    char text[4096];

    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"own\", \"frames\": \"0\", \"fps\": 24, \"time_offset\": 0.5,"
             " \"resolution\": [%d, %d],"
             " \"camera\": { \"position\": [0.3, 0.5, 4], \"target\": [0, 0, 0], \"up\": [0, 1, 0], \"fov\": 34 },"
             " \"lights\": [ { \"kind\": \"sun\", \"intensity\": 3, \"direction\": [-1, -2, -0.5] } ],"
             " \"scene\": { \"media\": [ %s ] },"
             " \"quality\": { \"method\": \"midpoint\", \"step\": 0.01, \"light_step\": 0.02 },"
             " \"output\": { \"path\": \"own.####.exr\", \"aovs\": [\"Z\", \"transmittance\"] } }",
             WIDTH_PX, HEIGHT_PX, media);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

static void set_text(struct job *job, size_t medium, const char *text)
{
    struct scene_glsl *glsl = &job->scene.media[medium].density.glsl;

    free(glsl->source);
    glsl->source = xstrdup(text);
}

static double measure_error(const struct job *job, const struct still_inputs *inputs)
{
    static float values[4 * PIXELS];
    static double wanted[4 * PIXELS];
    static const struct integrate_accuracy accuracy = {.relative = 3e-4};
    struct reference_error error;
    struct still still;
    struct image image;

    render_frame_zero(job, &image);
    still_init_with_inputs(&still, job, job_frame_time(job, 0), inputs);
    assert_true(still.is_complete);
    for (int i = 0; i < PIXELS; ++i) {
        struct reference_pixel pixel = reference_measure_pixel(&still, i % WIDTH_PX, i / WIDTH_PX, &accuracy);

        for (int c = 0; c < 3; ++c)
            wanted[4 * i + c] = pixel.radiance[c];
        wanted[4 * i + 3] = pixel.alpha;
    }
    memcpy(values, image.rgba, sizeof values);
    image_finish(&image);
    error = reference_image_error(values, wanted, 4 * PIXELS);
    print_message("relative RMSE %.2e, largest error %.2e\n", error.relative_rmse, error.largest);
    return error.relative_rmse;
}

// jobs/custom.glsl again, in double precision.
static double custom_at(const void *context, struct vec3 p, double t)
{
    const double cells = 9, thickness = 0.28, angle = 0.8 * p.y + 0.25 * t;
    double x = cells * (cos(angle) * p.x - sin(angle) * p.z), y = cells * p.y - 0.6 * t;
    double z = cells * (sin(angle) * p.x + cos(angle) * p.z);

    (void)context;
    return (thickness - fabs(sin(x) * cos(z) + sin(y) * cos(x) + sin(z) * cos(y))) / cells;
}

static void the_example_is_its_twin(void **state)
{
    const struct still_inputs inputs = {.functions[0].at = custom_at};
    struct job job;

    example_job_load(&job, "custom");
    example_job_shrink(&job, WIDTH_PX, HEIGHT_PX, 3);
    job.quality.step = job.quality.light_step = 0.004;
    // The method is of second order in steps of a tenth of the shell's width; the shell's edge is a kink. The scene at
    // another time is off by 0.3.
    assert_true(measure_error(&job, &inputs) < 2e-3);
    job_finish(&job);
}

static void a_bound_on_its_growth_changes_no_light(void **state)
{
    struct image with, without;
    struct job job;

    example_job_load(&job, "custom");
    example_job_shrink(&job, WIDTH_PX, HEIGHT_PX, 3);
    render_frame_zero(&job, &with);
    // Nothing is stepped over, which takes more iterations.
    job.scene.media[0].density.glsl.lipschitz = 0;
    render_frame_zero(&job, &without);
    // Steps of a quarter of the shell's width lie elsewhere in it.
    for (int i = 0; i < 4 * PIXELS; ++i)
        assert_near(with.rgba[i], without.rgba[i], 0.02 * fmax(1, (double)without.rgba[i]));
    image_finish(&with);
    image_finish(&without);
    job_finish(&job);
}

static double ball_at(const void *context, struct vec3 p, double t)
{
    const double *center = context;

    return 0.8 + 0.1 * t - sqrt((p.x - center[0]) * (p.x - center[0]) + p.y * p.y + p.z * p.z);
}

// Each name clashes with the other text's, with one of ours, or with a built-in function.
#define CLASHING_TEXT(X)                                                                                               \
    "#define SCALE 1.0\n#define medium_column(x) (x)\n"                                                                \
    "struct Segment { vec3 center; };\nstruct MediaField { float x; };\n"                                              \
    "const Segment region = Segment(vec3(" X ", 0.0, 0.0)), media = region;\n"                                         \
    "float at = 0.0, light_0_direction;\n"                                                                             \
    "float segment(vec3 p);\n"                                                                                         \
    "float gather(float field) { return field; }\n"                                                                    \
    "float saturate(float x) { return clamp(x, 0.0, 1.0); }\n"                                                         \
    "float distance(vec3 a, vec3 b) { return length(a - b); }\n"                                                       \
    "float density(vec3 p, float t) {\n"                                                                               \
    "    at = segment(p);\n    float time_s = t, sigma_t = gather(at);\n"                                              \
    "    return SCALE * medium_column(0.8) + 0.1 * time_s - sigma_t;\n}\n"                                             \
    "float density(float field) { return -field; }\n"                                                                  \
    "float segment(vec3 p) { return distance(p, media.center) * saturate(2.0); }\n"                                    \
    "void main() {}\n"

static void names_of_two_texts_and_ours_do_not_meet(void **state)
{
    static const double centers[2][1] = {{-0.25}, {0.25}};
    const struct still_inputs inputs = {.functions = {{ball_at, centers[0]}, {ball_at, centers[1]}}};
    struct job job;

    parse(&job, OWN("-0.25, 0, 0", "\"sigma_s\": 2, \"sigma_a\": 1") "," OWN("0.25, 0, 0",
                                                                             "\"sigma_s\": [1, 2, 3], \"sigma_a\": 0"));
    set_text(&job, 0, CLASHING_TEXT("-0.25"));
    set_text(&job, 1, CLASHING_TEXT("0.25"));
    // Second order in steps of an eightieth of the radius, with a kink at the ball's edge.
    assert_true(measure_error(&job, &inputs) < 5e-4);
    job_finish(&job);
}

static void a_nan_is_told_with_its_pixel(void **state)
{
    static const char *const texts[] = {
        "float density(vec3 p, float t) { return p.x > 0.0 ? sqrt(min(p.x, 0.0) - 1.0) : 1.0; }",
        "float density(vec3 p, float t) { return p.x > 0.0 ? (p.x - p.x) / (p.x - p.x) : -1.0; }",
        "float density(vec3 p, float t) { return p.x > 0.0 ? 1.0 / (p.x - p.x) : 1.0; }",
    };

    for (size_t i = 0; i < sizeof texts / sizeof *texts; ++i) {
        struct error error = {{0}};
        struct image image;
        struct job job;

        parse(&job, OWN("0, 0, 0", "\"sigma_s\": 2, \"sigma_a\": 1"));
        job.scene.media[0].density.glsl.lipschitz = i == 1 ? 1 : 0;
        set_text(&job, 0, texts[i]);
        render_frame_zero(&job, &image);
        assert_false(image_is_finite(&image, false, &error));
        assert_non_null(strstr(error.message, "pixel ("));
        image_finish(&image);
        job_finish(&job);
    }
}

// Returns a renderer's message about a text.
static void render_and_fail(const char *text, enum renderer_fault fault, struct error *error)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    struct renderer_result result;
    struct image image;
    struct job job;

    parse(&job, OWN("0, 0, 0", "\"sigma_s\": 2, \"sigma_a\": 1"));
    job.width_px = job.height_px = 4;
    set_text(&job, 0, text);
    assert_true(image_init(&image, job.width_px, job.height_px, true, true, NULL));
    assert_false(renderer_render(stage.renderer, &(struct renderer_frame){.job = &job, .frame = 0, .image = &image},
                                 &result, error));
    assert_int_equal(result.fault, fault);
    image_finish(&image);
    job_finish(&job);
    gl_stage_close(stage);
}

static void assert_told(const char *text, const char *place, const char *words)
{
    struct error error = {{0}};

    render_and_fail(text, RENDERER_FAULT_JOB, &error);
    if (!strstr(error.message, place) || !strstr(error.message, words)) fail_msg("%s: %s", text, error.message);
    assert_null(strstr(error.message, "medium_0_own"));
}

static void mistakes_are_told_with_file_and_line(void **state)
{
    assert_told("// A cloud.\nfloat density(vec3 p, float t)\n{\n    return nothing_here;\n}\n", "clouds.glsl:4",
                "nothing_here");
    assert_told("float noise(vec3 p) { return p.x; }\nfloat density(vec3 p, float t)\n{\n    return noise(p.xy);\n}",
                "clouds.glsl:4", "noise");
    assert_told("float density(vec3 p, float t) { return 1.0 }", "clouds.glsl:1", "");
    assert_told("float density(vec3 p) { return 1.0; }", "clouds.glsl:1: density",
                "expected \"float density(vec3 p, float t)\", got \"float density(vec3)\"");
    assert_told("\nvec3 density(vec3 p, float t) { return p; }", "clouds.glsl:2: density", "got \"vec3 density");
    assert_told("float density(vec3 p, float t);", "clouds.glsl:1: density", "body");
    assert_told("float dense(vec3 p, float t) { return 1.0; }", "clouds.glsl: expected a function", "density");
    assert_told("float density;\n", "clouds.glsl:1: density", "got");
    assert_told("#version 450\nfloat density(vec3 p, float t) { return 1.0; }", "clouds.glsl:1: #version", "");
    assert_told("#error too thin\nfloat density(vec3 p, float t) { return 1.0; }", "clouds.glsl:1", "too thin");
}

// Software GL ends such a loop by itself, and with it all others of the pixel.
static void a_loop_without_end_is_not_taken_for_a_picture(void **state)
{
    struct error error = {{0}};

    render_and_fail("float density(vec3 p, float t)\n{\n    while (true) p += 1.0;\n    return p.x;\n}\n",
                    RENDERER_FAULT_ENDLESS, &error);
    if (!strstr(error.message, "iterations of its loops")) fail_msg("%s", error.message);
    if (!strstr(error.message, "short loops in clouds.glsl")) fail_msg("%s", error.message);
}

static void the_text_is_a_module_of_its_own(void **state)
{
    struct error error = {{0}};
    struct scene_program program;
    bool is_found = false;
    struct job job;

    parse(&job, OWN("0, 0, 0", "\"sigma_s\": 2, \"sigma_a\": 1"));
    set_text(&job, 0, "float density(vec3 p, float t) { return 1.0; }");
    if (!scene_program_init(&program, &job, NULL, NULL, &error)) fail_msg("%s", error.message);
    for (size_t i = 0; i < program.module_count; ++i)
        is_found |= strcmp(program.module_names[i], "clouds.glsl") == 0;
    assert_true(is_found);
    assert_non_null(strstr(program.fragment, "\nfloat density(vec3 p, float t) { return 1.0; }\n"));
    scene_program_finish(&program);
    job_finish(&job);
}

static void a_text_without_a_file_is_told_by_its_place(void **state)
{
    struct error error = {{0}};
    struct scene_program program;
    struct job job;

    parse(&job, OWN("0, 0, 0", "\"sigma_s\": 2, \"sigma_a\": 1") "," OWN("0, 0, 0", "\"sigma_s\": 2, \"sigma_a\": 1"));
    set_text(&job, 0, "float density(vec3 p, float t) { return 1.0; }");
    set_text(&job, 1, "\nfloat density(vec3 p) { return 1.0; }");
    free(job.scene.media[1].density.glsl.file);
    job.scene.media[1].density.glsl.file = NULL;
    assert_false(scene_program_init(&program, &job, NULL, NULL, &error));
    if (!strstr(error.message, "scene.media[1].density.source:2: ")) fail_msg("%s", error.message);
    scene_program_finish(&program);
    job_finish(&job);
}

static void a_text_of_an_interior_is_told_by_its_object(void **state)
{
    char *text = json_edit_set(job_text_glsl, "scene",
                               "{\"objects\":[{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1,\"material\":{"
                               "\"kind\":\"mirror\"}},{\"kind\":\"sphere\",\"center\":[3,0,0],\"radius\":1,"
                               "\"material\":{\"kind\":\"dielectric\",\"ior\":1.5,\"interior\":{\"sigma_a\":1,"
                               "\"density\":{\"kind\":\"glsl\",\"source\":\"\\nfloat density(vec3 p) { return 1.0; }\","
                               "\"bounds\":{\"kind\":\"sphere\",\"radius\":1}}}}}]}");
    struct error error = {{0}};
    struct scene_program program;
    struct job job;

    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    assert_false(scene_program_init(&program, &job, NULL, NULL, &error));
    if (!strstr(error.message, "scene.objects[1].material.interior.density.source:2: ")) fail_msg("%s", error.message);
    scene_program_finish(&program);
    job_finish(&job);
    free(text);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_example_is_its_twin),
        cmocka_unit_test(a_bound_on_its_growth_changes_no_light),
        cmocka_unit_test(names_of_two_texts_and_ours_do_not_meet),
        cmocka_unit_test(a_nan_is_told_with_its_pixel),
        cmocka_unit_test(mistakes_are_told_with_file_and_line),
        cmocka_unit_test(a_loop_without_end_is_not_taken_for_a_picture),
        cmocka_unit_test(the_text_is_a_module_of_its_own),
        cmocka_unit_test(a_text_without_a_file_is_told_by_its_place),
        cmocka_unit_test(a_text_of_an_interior_is_told_by_its_object),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
