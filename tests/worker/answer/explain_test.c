// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/explain.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/hash.h"
#include "core/job/job_beyond.h"
#include "core/job/job_json.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "tests/support/ball_job.h"
#include "tests/support/example_job.h"
#include "tests/support/object_job.h"
#include "tests/support/png_maker.h"
#include "tests/support/temp_folder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

struct explanation {
    struct json_writer writer;
    struct cJSON *root;
    struct json_node node;
};

static void explain(struct explanation *explanation, const struct job *job)
{
    const struct explain_params params = {.job = job, .beyond = &(struct job_beyond){0}};
    struct error error = {{0}};

    *explanation = (struct explanation){0};
    if (!explain_write(&params, &explanation->writer, &error) ||
        !json_parse(&explanation->root, explanation->writer.text, explanation->writer.length, &error))
        fail_msg("%s", error.message);
    explanation->node = json_node_root(explanation->root);
}

static void explanation_finish(struct explanation *explanation)
{
    json_delete(explanation->root);
    json_writer_finish(&explanation->writer);
}

// The reason that `list` gives for `feature`, or NULL when the list lacks it.
static const char *find_why(const struct explanation *explanation, const char *list, const char *feature)
{
    struct json_node array = json_node_child(&explanation->node, list), entry = {0};

    assert_int_equal(json_node_type(&array), JSON_ARRAY);
    while (json_node_next(&array, &entry)) {
        struct json_node name = json_node_child(&entry, "feature"), reason = json_node_child(&entry, "why");
        const char *text = NULL, *why = NULL;

        assert_true(json_read_string(&name, &text, NULL) && json_read_string(&reason, &why, NULL));
        assert_true(why[0] != '\0');
        if (strcmp(text, feature) == 0) return why;
    }
    return NULL;
}

static void assert_modelled(const struct explanation *explanation, const char *feature)
{
    if (!find_why(explanation, "modelled", feature)) fail_msg("expected \"%s\" to be modelled", feature);
    assert_null(find_why(explanation, "not_modelled", feature));
}

static void assert_not_modelled(const struct explanation *explanation, const char *feature)
{
    if (!find_why(explanation, "not_modelled", feature)) fail_msg("expected \"%s\" not to be modelled", feature);
    assert_null(find_why(explanation, "modelled", feature));
}

static void the_cloud_is_explained(void **state)
{
    struct explanation explanation;
    struct job job;

    example_job_load(&job, "cloud");
    explain(&explanation, &job);
    assert_modelled(&explanation, "medium 0");
    assert_modelled(&explanation, "medium 0: scattering");
    assert_modelled(&explanation, "light 0");
    assert_modelled(&explanation, "shadows");
    assert_modelled(&explanation, "marching");
    assert_modelled(&explanation, "marching to lights");
    assert_modelled(&explanation, "depth");
    assert_not_modelled(&explanation, "medium 0: bounds");
    assert_not_modelled(&explanation, "medium 0: closed form");
    assert_modelled(&explanation, "motion of light_0_position");
    assert_modelled(&explanation, "motion of medium_0_rotation");
    assert_not_modelled(&explanation, "medium 0: absorption");
    assert_not_modelled(&explanation, "medium 0: emission");
    assert_not_modelled(&explanation, "colour");
    assert_not_modelled(&explanation, "background");
    assert_not_modelled(&explanation, "multiple scattering");
    explanation_finish(&explanation);
    job_finish(&job);
}

static void a_grid_of_the_density_is_explained(void **state)
{
    struct explanation explanation;
    struct job job;

    example_job_load(&job, "noise");
    job.quality.method = JOB_METHOD_CACHED;
    job.quality.light_grid = 8;
    job.quality.density_grid = 100;
    explain(&explanation, &job);
    assert_non_null(strstr(find_why(&explanation, "modelled", "medium 0: baked"), "101 x 101 x 101"));
    explanation_finish(&explanation);
    job_finish(&job);
}

static void fog_is_explained(void **state)
{
    struct explanation explanation;
    struct job job;

    example_job_load(&job, "fog");
    explain(&explanation, &job);
    assert_string_equal(find_why(&explanation, "modelled", "medium 0"), "homogeneous density");
    assert_string_equal(find_why(&explanation, "modelled", "medium 0: bounds"), "a box");
    assert_string_equal(find_why(&explanation, "modelled", "medium 0: phase function"), "Henyey-Greenstein");
    assert_modelled(&explanation, "medium 0: closed form");
    assert_modelled(&explanation, "placed points");
    assert_not_modelled(&explanation, "medium 0: falloff");
    assert_not_modelled(&explanation, "medium 0: transfer function");
    assert_not_modelled(&explanation, "medium 0: blackbody");
    assert_not_modelled(&explanation, "medium 1: scattering");
    assert_not_modelled(&explanation, "marching");
    assert_not_modelled(&explanation, "marching to lights");
    explanation_finish(&explanation);
    job_finish(&job);
}

static void a_light_that_nothing_scatters_is_not_modelled(void **state)
{
    struct explanation explanation;
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_POINT_LIGHT ", " BALL_JOB_MIDPOINT);
    explain(&explanation, &job);
    assert_not_modelled(&explanation, "light 0");
    assert_not_modelled(&explanation, "shadows");
    assert_not_modelled(&explanation, "frames that differ");
    assert_modelled(&explanation, "extinction");
    explanation_finish(&explanation);
    job_finish(&job);
}

// A plan's numbers are uniforms, so that plans share a program.
static void numbers_of_a_plan_are_no_motion(void **state)
{
    struct explanation explanation;
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_POINT_LIGHT ", " BALL_JOB_MIDPOINT);
    job.quality.tolerance = 0.01;
    job.quality.min_transmittance = 0.001;
    explain(&explanation, &job);
    assert_not_modelled(&explanation, "frames that differ");
    assert_null(find_why(&explanation, "modelled", "motion of quality_step"));
    explanation_finish(&explanation);
    job_finish(&job);
}

static bool names_module(const struct explanation *explanation, const char *name)
{
    struct json_node array = json_node_child(&explanation->node, "modules"), entry = {0};

    while (json_node_next(&array, &entry)) {
        const char *text = NULL;

        assert_true(json_read_string(&entry, &text, NULL));
        if (strcmp(text, name) == 0) return true;
    }
    return false;
}

static void the_shader_is_shown_with_its_modules_and_hash(void **state)
{
    struct json_node shader, hash, bytes;
    struct explanation explanation;
    const char *text = NULL, *digits = NULL;
    struct job job;
    int64_t size;

    example_job_load(&job, "cloud_seed");
    explain(&explanation, &job);
    shader = json_node_child(&explanation.node, "shader");
    hash = json_node_child(&explanation.node, "shader_hash");
    bytes = json_node_child(&explanation.node, "uniform_bytes");
    assert_true(json_read_string(&shader, &text, NULL));
    assert_non_null(strstr(text, "void main()"));
    assert_true(json_read_string(&hash, &digits, NULL));
    assert_int_equal(strlen(digits), HASH_TEXT_SIZE - 1);
    assert_true(json_read_integer(&bytes, 0, 1 << 16, &size, NULL));
    assert_int_equal(size, 80);
    assert_true(names_module(&explanation, "integrator/riemann.glsl"));
    assert_true(names_module(&explanation, "phase/henyey_greenstein.glsl"));
    assert_false(names_module(&explanation, "integrator/midpoint.glsl"));
    assert_false(names_module(&explanation, "math/segment.glsl"));
    explanation_finish(&explanation);
    job_finish(&job);
}

static void samples_and_shutter_are_explained(void **state)
{
    struct explanation explanation;
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    explain(&explanation, &job);
    assert_not_modelled(&explanation, "antialiasing");
    assert_not_modelled(&explanation, "motion blur");
    assert_false(names_module(&explanation, "math/random.glsl"));
    assert_false(names_module(&explanation, "camera/pixel_samples.glsl"));
    explanation_finish(&explanation);
    job.quality.samples = 4;
    job.scene.camera.shutter = 0.5;
    explain(&explanation, &job);
    assert_modelled(&explanation, "antialiasing");
    assert_not_modelled(&explanation, "motion blur");
    assert_not_modelled(&explanation, "frames that differ");
    assert_true(names_module(&explanation, "math/random.glsl"));
    assert_true(names_module(&explanation, "camera/pixel_samples.glsl"));
    explanation_finish(&explanation);
    job_finish(&job);
    example_job_load(&job, "cloud");
    job.scene.camera.shutter = 0.5;
    explain(&explanation, &job);
    assert_not_modelled(&explanation, "motion blur");
    explanation_finish(&explanation);
    job.quality.samples = 2;
    explain(&explanation, &job);
    assert_modelled(&explanation, "motion blur");
    explanation_finish(&explanation);
    job_finish(&job);
}

static void the_users_own_text_is_named(void **state)
{
    struct explanation explanation;
    struct job job;

    example_job_load(&job, "custom");
    explain(&explanation, &job);
    assert_string_equal(find_why(&explanation, "modelled", "medium 0"), "glsl density of custom.glsl");
    assert_true(names_module(&explanation, "custom.glsl"));
    assert_true(names_module(&explanation, "density/own.glsl"));
    explanation_finish(&explanation);
    job_finish(&job);
}

// A floor with a tiled image, and a ball with the same image around it.
static void textures_are_explained(void **state)
{
    static const unsigned char rgb[6] = {0};
    const char *path = temp_folder_path(state, "image.png");
    struct explanation explanation;
    struct error error = {{0}};
    struct job job;
    char text[2048];

    png_maker_write_rgb(path, 2, 1, rgb);
    snprintf(
        text, sizeof text,
        "{ \"version\": 1, \"name\": \"floor\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [8, 8],"
        " \"camera\": { \"position\": [0, 0, 3], \"target\": [0, 0, 0], \"up\": [0, 1, 0], \"fov\": 20 },"
        " \"lights\": [ { \"kind\": \"sun\", \"direction\": [0, -1, 0], \"intensity\": 1 } ],"
        " \"scene\": { \"objects\": [ { \"kind\": \"plane\", \"point\": [0, -1, 0], \"material\": {"
        " \"kind\": \"diffuse\", \"texture\": { \"file\": \"%s\", \"size\": 3 } } },"
        " { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 1, \"material\": { \"kind\": \"diffuse\","
        " \"texture\": { \"file\": \"%s\", \"filter\": \"nearest\", \"color_space\": \"linear\" } } } ] },"
        " \"quality\": { \"method\": \"midpoint\", \"step\": 0.1 }, \"output\": { \"path\": \"floor.####.exr\" } }",
        path, path);
    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    explain(&explanation, &job);
    assert_string_equal(find_why(&explanation, "modelled", "object 0: texture"),
                        "2 x 1 pixels, decoded from sRGB, filtered linearly, in tiles of 3 x 1.5 m");
    assert_string_equal(find_why(&explanation, "modelled", "object 1: texture"),
                        "2 x 1 pixels, taken as linear light, unfiltered");
    explanation_finish(&explanation);
    job_finish(&job);
}

static void assert_pixels_explained(const struct job *job, const char *list, const char *why)
{
    struct explanation explanation;

    explain(&explanation, job);
    assert_string_equal(find_why(&explanation, list, "pixels"), why);
    explanation_finish(&explanation);
}

static void traced_pixels_are_explained(void **state)
{
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_S_1, BALL_JOB_MIDPOINT ", " BALL_JOB_POINT_LIGHT);
    assert_pixels_explained(&job, "not_modelled", "every pixel is traced: quality has no pixels");
    job.quality.pixels = (struct job_pixels){.stride = 16, .threshold = 0.01};
    assert_pixels_explained(&job, "modelled", "every 16th, refined where doubt exceeds 0.01");
    job.quality.pixels.stride = 32;
    assert_pixels_explained(&job, "modelled", "every 32nd, refined where doubt exceeds 0.01");
    job.quality.pixels = (struct job_pixels){0};
    job.quality.method = JOB_METHOD_JITTERED;
    assert_pixels_explained(&job, "not_modelled",
                            "every pixel is traced: jittered has random numbers of its own in each pixel");
    job_finish(&job);
}

static void rough_surfaces_have_every_pixel_traced(void **state)
{
    struct job job;

    object_job_parse(&job, "\"objects\": [" OBJECT_JOB_FLOOR(OBJECT_JOB_MIRROR ", \"roughness\": 0.25") "]",
                     OBJECT_JOB_QUALITY);
    assert_pixels_explained(&job, "not_modelled",
                            "every pixel is traced: a rough surface has random numbers of its own in each pixel");
    job_finish(&job);
}

static void a_missing_camera_view_is_an_error(void **state)
{
    struct error error = {{0}};
    struct json_writer writer = {0};
    struct job job;
    const struct explain_params params = {.job = &job, .beyond = &(struct job_beyond){0}};

    ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    job.scene.camera.target = job.scene.camera.position;
    assert_false(explain_write(&params, &writer, &error));
    assert_non_null(strstr(error.message, "camera.target"));
    assert_int_equal(writer.length, 0);
    json_writer_finish(&writer);
    job_finish(&job);
}

static void objects_are_explained(void **state)
{
    struct explanation explanation;
    struct job job;

    object_job_parse(&job,
                     "\"objects\": [" OBJECT_JOB_FLOOR(OBJECT_JOB_GREY) ", " OBJECT_JOB_BALL(OBJECT_JOB_GLASS) "]",
                     OBJECT_JOB_LIGHT ", " OBJECT_JOB_QUALITY);
    explain(&explanation, &job);
    assert_string_equal(find_why(&explanation, "modelled", "light 0"), "a point light that surfaces show");
    assert_string_equal(find_why(&explanation, "modelled", "object 0"), "1 shape, diffuse");
    assert_string_equal(find_why(&explanation, "modelled", "object 1"),
                        "1 shape, dielectric: rays are refracted, exact Fresnel share reflected");
    assert_modelled(&explanation, "surfaces");
    assert_modelled(&explanation, "paths");
    assert_not_modelled(&explanation, "caustics");
    assert_true(names_module(&explanation, "path/stack.glsl"));
    explanation_finish(&explanation);
    job_finish(&job);
}

static void an_interior_says_whose_it_is(void **state)
{
    struct explanation explanation;
    struct job job;

    object_job_parse(&job,
                     "\"objects\": [" OBJECT_JOB_FLOOR(OBJECT_JOB_GREY) ", " OBJECT_JOB_BALL(
                         OBJECT_JOB_GLASS
                         ", \"interior\": {\"sigma_a\": 1}") "],"
                                                             "\"media\": [{\"sigma_a\": 1, \"density\": {\"kind\": "
                                                             "\"homogeneous\"}}]",
                     "\"quality\": {\"method\": \"midpoint\", \"step\": 1}");
    explain(&explanation, &job);
    assert_null(find_why(&explanation, "modelled", "medium 0: interior"));
    assert_string_equal(find_why(&explanation, "modelled", "medium 1: interior"), "it fills object 1 and nothing else");
    explanation_finish(&explanation);
    job_finish(&job);
}

static void objects_that_end_every_ray_need_no_paths(void **state)
{
    struct explanation explanation;
    struct job job;

    object_job_parse(&job, "\"objects\": [" OBJECT_JOB_FLOOR(OBJECT_JOB_GREY) "]", OBJECT_JOB_QUALITY);
    explain(&explanation, &job);
    assert_modelled(&explanation, "surfaces");
    assert_not_modelled(&explanation, "paths");
    assert_not_modelled(&explanation, "shadows");
    assert_not_modelled(&explanation, "light between surfaces");
    assert_null(find_why(&explanation, "not_modelled", "caustics"));
    explanation_finish(&explanation);
    job_finish(&job);
}

static void diffuse_surfaces_send_paths_on_above_order_1(void **state)
{
    struct explanation explanation;
    struct job job;

    object_job_parse(&job,
                     "\"scattering\": {\"orders\": 2}, \"objects\": [" OBJECT_JOB_FLOOR(
                         OBJECT_JOB_GREY) "], \"media\": [{\"sigma_s\": 1, \"density\": {\"kind\": \"homogeneous\", "
                                          "\"bounds\": {\"kind\": \"sphere\", \"radius\": 1}}}]",
                     OBJECT_JOB_LIGHT ", \"quality\": {\"method\": \"paths\", \"paths\": 1}");
    explain(&explanation, &job);
    assert_string_equal(find_why(&explanation, "modelled", "light between surfaces"),
                        "random paths go on from diffuse ones");
    explanation_finish(&explanation);
    job_finish(&job);
}

// One noisy ball, lit by a lamp, whose light scatters so often.
static struct job scattered_job(const char *orders, const char *quality)
{
    char *text =
        xasprintf("{\"version\":1,\"name\":\"x\",\"frames\":\"0\",\"fps\":1,\"resolution\":[8,8],\"camera\":{"
                  "\"position\":[0,0,4],\"target\":[0,0,0],\"fov\":40},\"lights\":[{\"kind\":\"point\","
                  "\"intensity\":1,\"position\":[0,3,0]}],\"scene\":{\"scattering\":{\"orders\":%s},\"media\":"
                  "[{\"density\":{\"kind\":\"noise\",\"frequency\":2,\"bounds\":{\"kind\":\"sphere\",\"radius\":"
                  "1}},\"sigma_s\":1}]},\"quality\":%s,\"output\":{\"path\":\"x.#.exr\"}}",
                  orders, quality);
    struct error error = {{0}};
    struct job job;

    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    free(text);
    return job;
}

static void assert_scattering(const char *orders, const char *quality, const char *list, const char *why)
{
    struct job job = scattered_job(orders, quality);
    struct explanation explanation;

    explain(&explanation, &job);
    assert_string_equal(find_why(&explanation, list, "multiple scattering"), why);
    explanation_finish(&explanation);
    job_finish(&job);
}

static void orders_of_scattering_are_told(void **state)
{
    static const char paths[] = "{\"method\":\"paths\",\"paths\":16}";
    static const char march[] =
        "{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1,\"scatter_grid\":8,\"paths\":5}";

    assert_scattering("8", paths, "modelled", "light is scattered up to 8 times, along 16 random paths a pixel");
    assert_scattering("\"all\"", paths, "modelled",
                      "light is scattered any number of times, by all orders, along 16 random paths a pixel");
    assert_scattering("2", march, "modelled",
                      "light is scattered up to 2 times; beyond once by a grid of 8 cells, 5 random paths a node");
    assert_scattering("1", paths, "not_modelled", "light is scattered once at most");
}

static void random_paths_do_not_march(void **state)
{
    struct job job = scattered_job("8", "{\"method\":\"paths\",\"paths\":16}");
    struct explanation explanation;

    explain(&explanation, &job);
    assert_modelled(&explanation, "random paths");
    assert_modelled(&explanation, "tracking to lights");
    assert_not_modelled(&explanation, "marching");
    assert_null(find_why(&explanation, "not_modelled", "marching to lights"));
    explanation_finish(&explanation);
    job_finish(&job);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_cloud_is_explained),
        cmocka_unit_test(a_grid_of_the_density_is_explained),
        cmocka_unit_test(fog_is_explained),
        cmocka_unit_test(a_light_that_nothing_scatters_is_not_modelled),
        cmocka_unit_test(numbers_of_a_plan_are_no_motion),
        cmocka_unit_test(the_shader_is_shown_with_its_modules_and_hash),
        cmocka_unit_test(samples_and_shutter_are_explained),
        cmocka_unit_test(the_users_own_text_is_named),
        cmocka_unit_test_setup_teardown(textures_are_explained, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test(objects_are_explained),
        cmocka_unit_test(an_interior_says_whose_it_is),
        cmocka_unit_test(objects_that_end_every_ray_need_no_paths),
        cmocka_unit_test(diffuse_surfaces_send_paths_on_above_order_1),
        cmocka_unit_test(traced_pixels_are_explained),
        cmocka_unit_test(rough_surfaces_have_every_pixel_traced),
        cmocka_unit_test(orders_of_scattering_are_told),
        cmocka_unit_test(random_paths_do_not_march),
        cmocka_unit_test(a_missing_camera_view_is_an_error),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
