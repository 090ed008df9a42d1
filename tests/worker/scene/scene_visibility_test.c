// Media that a frame shows nothing of cost nothing, and no others are left out.
// SPDX-License-Identifier: Apache-2.0
#include "worker/scene/scene_visibility.h"

#include "core/base/error.h"
#include "core/job/job_json.h"
#include "tests/support/random.h"
#include "worker/render/renderer.h"
#include "worker/scene/camera_view.h"
#include "worker/scene/media_extent.h"
#include "worker/scene/scene_inputs.h"
#include "worker/shader/scene_program.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { TEXT_SIZE = 2048, COLUMNS = 24, ROWS = 14, SCENES = 400, POINTS = 12 };

#define NEAR_BALL                                                                                                      \
    "{\"density\":{\"kind\":\"noise\",\"frequency\":2,\"octaves\":2,\"H\":1,\"bounds\":{\"kind\":\"sphere\","          \
    "\"center\":[0,0,0],\"radius\":1}},\"sigma_s\":2}"

static void parse_with(struct job *job, const char *lights, const char *camera, const char *media, const char *quality)
{
    char text[TEXT_SIZE];
    struct error error = {{0}};

    snprintf(text, sizeof text,
             "{\"version\":1,\"name\":\"sight\",\"frames\":\"0-9\",\"fps\":1,\"resolution\":[%d,%d],\"camera\":{%s},"
             "\"lights\":[%s],\"scene\":{\"media\":[%s]},\"quality\":{%s},\"output\":{\"path\":\"a.####.exr\"}}",
             COLUMNS, ROWS, camera, lights, media, quality);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s\n%s", error.message, text);
}

static void parse(struct job *job, const char *lights, const char *camera, const char *media)
{
    parse_with(job, lights, camera, media, "\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1");
}

static char *text_of_frame(const struct job *job, int32_t frame)
{
    struct scene_files files;
    struct scene_inputs inputs;
    struct scene_program program;
    struct error error = {{0}};
    char *text;

    scene_files_init(&files);
    if (!scene_inputs_open(&inputs, job, frame, &files, NULL, &error)) fail_msg("%s", error.message);
    scene_visibility_find(job, &inputs, frame, inputs.is_unneeded);
    if (!scene_program_init(&program, job, &inputs, NULL, &error)) fail_msg("%s", error.message);
    text = strdup(program.fragment);
    scene_program_finish(&program);
    scene_inputs_finish(&inputs);
    scene_files_finish(&files);
    return text;
}

#define CAMERA "\"position\":[0,0,4],\"target\":[0,0,0],\"fov\":40"
#define SUN "{\"kind\":\"sun\",\"direction\":[0,-1,0],\"intensity\":1}"

static void a_medium_outside_the_view_adds_no_code(void **state)
{
    static const char *const aside =
        NEAR_BALL ",{\"density\":{\"kind\":\"noise\",\"frequency\":3,\"octaves\":3,\"H\":1,\"bounds\":{\"kind\":"
                  "\"sphere\",\"center\":{\"keys\":[[0,[9,0,0]],[5,[9,0,0]],[6,[2.2,0,0]]]},\"radius\":1}},"
                  "\"sigma_a\":5}";
    struct job alone, both;
    char *without, *out_of_view, *in_view;

    (void)state;
    parse(&alone, SUN, CAMERA, NEAR_BALL);
    parse(&both, SUN, CAMERA, aside);
    without = text_of_frame(&alone, 0);
    out_of_view = text_of_frame(&both, 5);
    in_view = text_of_frame(&both, 6);
    assert_string_equal(out_of_view, without);
    assert_non_null(strstr(in_view, "medium_1_"));
    free(without);
    free(out_of_view);
    free(in_view);
    job_finish(&alone);
    job_finish(&both);
}

static void a_medium_that_casts_a_shadow_stays(void **state)
{
    static const char *const above =
        NEAR_BALL ",{\"density\":{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"sphere\",\"center\":[0,9,0],"
                  "\"radius\":1}},\"sigma_a\":5}";
    struct job job;
    char *text;

    (void)state;
    parse(&job, SUN, CAMERA, above);
    text = text_of_frame(&job, 0);
    assert_non_null(strstr(text, "medium_1_"));
    free(text);
    job_finish(&job);
    parse(&job, "{\"kind\":\"point\",\"position\":[0,-3,0],\"intensity\":1}", CAMERA, above);
    text = text_of_frame(&job, 0);
    assert_null(strstr(text, "medium_1_"));
    free(text);
    job_finish(&job);
}

struct vector {
    double at[3];
};

static bool meets(const struct scene_ball *ball, struct vector from, struct vector ray, double end)
{
    double along = 0, square = 0, nearest = 0;

    for (int i = 0; i < 3; ++i) {
        along += (ball->center[i] - from.at[i]) * ray.at[i];
        square += ray.at[i] * ray.at[i];
    }
    along = fmin(fmax(along / square, 0), end);
    for (int i = 0; i < 3; ++i)
        nearest += pow(from.at[i] + along * ray.at[i] - ball->center[i], 2);
    return nearest < ball->radius * ball->radius;
}

static struct vector random_vector(struct random *random, double reach)
{
    struct vector vector;

    for (int i = 0; i < 3; ++i)
        vector.at[i] = random_between(random, -reach, reach);
    return vector;
}

static struct vector ray_of(const struct camera_view *view, int column, int row)
{
    double x = (2 * column + 1.0) / COLUMNS - 1, y = 1 - (2 * row + 1.0) / ROWS;
    struct vector ray;

    for (int i = 0; i < 3; ++i)
        ray.at[i] = view->forward[i] + x * view->half_width * view->right[i] + y * view->half_height * view->up[i];
    return ray;
}

// Finds whether shadow rays from points of the visible ball meet the other one.
static bool shades(const struct scene_ball *ball, const struct scene_ball *seen, const struct scene_light *light,
                   struct random *random)
{
    for (int k = 0; k < POINTS; ++k) {
        struct vector from = random_vector(random, seen->radius / sqrt(3.0)), ray;

        timeline_evaluate(light->kind == SCENE_LIGHT_SUN ? &light->direction : &light->position, 0, ray.at);
        for (int i = 0; i < 3; ++i) {
            from.at[i] += seen->center[i];
            ray.at[i] = light->kind == SCENE_LIGHT_SUN ? -ray.at[i] : ray.at[i] - from.at[i];
        }
        if (meets(ball, from, ray, light->kind == SCENE_LIGHT_SUN ? INFINITY : 1)) return true;
    }
    return false;
}

// A medium beside the line to a lamp's middle is on the way to its edge; on the way to a dome every medium is.
static void a_medium_before_a_part_of_a_large_light_stays(void **state)
{
    static const char *const lights[] = {"{\"kind\":\"sphere\",\"intensity\":1,\"position\":[0,6,0],\"radius\":4}",
                                         "{\"kind\":\"dome\",\"radiance\":1}"};
    static const char *const media =
        NEAR_BALL ",{\"density\":{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"sphere\","
                  "\"center\":[3,3,0],\"radius\":0.5}},\"sigma_a\":5}";

    (void)state;
    for (size_t i = 0; i < 2; ++i) {
        bool is_unneeded[SCENE_MEDIUM_LIMIT];
        struct job job;

        parse_with(&job, lights[i], CAMERA, media, "\"method\":\"paths\",\"paths\":4");
        scene_visibility_find(&job, NULL, 0, is_unneeded);
        assert_false(is_unneeded[0]);
        assert_false(is_unneeded[1]);
        job_finish(&job);
    }
}

static void parse_random(struct job *job, struct random *random)
{
    struct vector eye = random_vector(random, 5), target = random_vector(random, 2), light = random_vector(random, 5);
    char media[TEXT_SIZE / 2] = "", camera[256], lights[256];
    size_t used = 0;

    for (int i = 0; i < 3; ++i) {
        struct vector center = random_vector(random, 4);

        used += (size_t)snprintf(media + used, sizeof media - used,
                                 "%s{\"density\":{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"sphere\",\"center\":"
                                 "[%g,%g,%g],\"radius\":%g}},\"sigma_s\":1}",
                                 i > 0 ? "," : "", center.at[0], center.at[1], center.at[2],
                                 random_between(random, 0.1, 2.0));
    }
    snprintf(camera, sizeof camera, "\"position\":[%g,%g,%g],\"target\":[%g,%g,%g],\"fov\":%g", eye.at[0], eye.at[1],
             eye.at[2], target.at[0], target.at[1], target.at[2], random_between(random, 5, 90));
    snprintf(lights, sizeof lights, "{\"kind\":\"%s\":[%g,%g,%g],\"intensity\":1}",
             random_between(random, 0, 1) < 0.5 ? "point\",\"position" : "sun\",\"direction", light.at[0], light.at[1],
             light.at[2]);
    parse(job, lights, camera, media);
}

static void whatever_is_met_is_kept(void **state)
{
    struct random random = {20020};
    int left_out = 0, kept_for_shadows = 0;

    (void)state;
    for (int scene = 0; scene < SCENES; ++scene) {
        struct job job;
        struct scene_inputs inputs = {0};
        struct scene_ball balls[3];
        struct camera_view view;
        bool is_unneeded[SCENE_MEDIUM_LIMIT], is_seen[3] = {false, false, false};

        parse_random(&job, &random);
        scene_visibility_find(&job, &inputs, 0, is_unneeded);
        assert_true(camera_view_init(&view, &job.scene.camera, 0, COLUMNS, ROWS, NULL));
        for (size_t i = 0; i < 3; ++i) {
            struct vector eye;

            memcpy(eye.at, view.position, sizeof eye.at);
            balls[i] = media_extent_ball(&job, &inputs, i, 0);
            for (int k = 0; k < COLUMNS * ROWS; ++k)
                is_seen[i] |= meets(&balls[i], eye, ray_of(&view, k % COLUMNS, k / COLUMNS), INFINITY);
            if (is_seen[i]) assert_false(is_unneeded[i]);
            left_out += is_unneeded[i];
        }
        for (size_t i = 0; i < 9; ++i)
            if (is_seen[i / 3] && shades(&balls[i % 3], &balls[i / 3], &job.scene.lights[0], &random)) {
                assert_false(is_unneeded[i % 3]);
                kept_for_shadows += !is_seen[i % 3];
            }
        job_finish(&job);
    }
    printf("%d of %d media left out, %d kept for their shadows alone\n", left_out, 3 * SCENES, kept_for_shadows);
    assert_true(left_out > SCENES / 2);
    assert_true(kept_for_shadows > SCENES / 40);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_medium_outside_the_view_adds_no_code),
        cmocka_unit_test(a_medium_that_casts_a_shadow_stays),
        cmocka_unit_test(a_medium_before_a_part_of_a_large_light_stays),
        cmocka_unit_test(whatever_is_met_is_kept),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
