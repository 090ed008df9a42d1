// Spots: their shader modules against the twin, their light in media and on surfaces, in every method.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "reference/light.h"
#include "reference/span_list.h"
#include "tests/support/assert_near.h"
#include "tests/support/bias_check.h"
#include "tests/support/random.h"
#include "tests/support/render_frame.h"
#include "tests/support/shader_probe.h"
#include "tests/support/studio.h"
#include "tests/support/true_light.h"
#include "worker/picture/image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { COUNT = 256, VECTORS = 4 };

static float inputs[VECTORS * COUNT][4], outputs[COUNT][4];

static void put(size_t at, struct vec3 value, double w)
{
    inputs[at][0] = (float)value.x;
    inputs[at][1] = (float)value.y;
    inputs[at][2] = (float)value.z;
    inputs[at][3] = (float)w;
}

static struct vec3 vector_of(const float value[4])
{
    return (struct vec3){value[0], value[1], value[2]};
}

static struct vec3 random_vector(struct random *random, double size)
{
    double x = random_between(random, -size, size), y = random_between(random, -size, size);

    return (struct vec3){x, y, random_between(random, -size, size)};
}

// Input 4 i is the point and `inner`, 4 i + 1 the light's position and `outer`, 4 i + 2 its direction of travel,
// 4 i + 3 a ray's direction and its length.
static void put_spots(void)
{
    struct random random = {61};

    for (size_t i = 0; i < COUNT; i++) {
        double outer = i % 4 == 0 ? pow(10.0, random_between(&random, -3.0, -1.0)) : random_between(&random, 0.1, 1.57);
        struct vec3 position = random_vector(&random, 3.0), axis = vec3_normalize(random_vector(&random, 1.0));
        // In the cone or near it.
        struct vec3 beside = vec3_scale(random_vector(&random, 1.0), outer);
        struct vec3 point = vec3_add(position, vec3_scale(vec3_add(axis, beside), random_between(&random, 0.3, 3.0)));

        put(VECTORS * i, point, random_between(&random, 0.2, 0.9) * outer);
        put(VECTORS * i + 1, position, outer);
        put(VECTORS * i + 2, axis, 0.0);
        put(VECTORS * i + 3, vec3_normalize(random_vector(&random, 1.0)), random_between(&random, 0.01, 3.0));
    }
}

static void probe(const char *expression)
{
    static const char *const MODULES[] = {"math/constants.glsl",      "math/arc.glsl",
                                          "math/spectrum_rgb.glsl",   "light/sample.glsl",
                                          "light/point.glsl",         "light/spot.glsl",
                                          "light/point_segment.glsl", "light/spot_lit.glsl",
                                          "light/spot_segment.glsl",  NULL};
    char body[1024];

    snprintf(body, sizeof body,
             "vec4 probe(int i)\n{\n"
             "    vec4 point = inputs[4 * i], position = inputs[4 * i + 1], ray = inputs[4 * i + 3];\n"
             "    LightSpot spot = LightSpot(vec3(3.0, 0.5, 7.0), position.xyz, -inputs[4 * i + 2].xyz, point.w,\n"
             "                               position.w);\n"
             "    return %s;\n}\n",
             expression);
    shader_probe_run(&(struct shader_probe_params){.modules = MODULES,
                                                   .body = body,
                                                   .inputs = (const float(*)[4])inputs,
                                                   .input_count = VECTORS * COUNT,
                                                   .count = COUNT},
                     outputs);
}

static struct light spot_of(size_t i)
{
    return (struct light){.kind = SCENE_LIGHT_SPOT,
                          .falloff = SCENE_FALLOFF_INVERSE_SQUARE,
                          .intensity = {3.0, 0.5, 7.0},
                          .position = vector_of(inputs[VECTORS * i + 1]),
                          .direction = vec3_normalize(vector_of(inputs[VECTORS * i + 2])),
                          .inner = inputs[VECTORS * i][3],
                          .outer = inputs[VECTORS * i + 1][3]};
}

static void light_spot_is_its_twin(void **state)
{
    int faded = 0;

    put_spots();
    probe("vec4(light_spot(spot, point.xyz).irradiance, 0.0)");
    for (size_t i = 0; i < COUNT; i++) {
        struct light spot = spot_of(i);
        struct light_arrival arrival = light_arrive(&spot, vector_of(inputs[VECTORS * i]));
        double full = 3.0 / (arrival.distance * arrival.distance);
        // Positions of size 6 are rounded to 2^-22, which turns the way to the light by that over its length.
        double turned = 0x1p-21 / arrival.distance + 0x1p-20;

        for (int c = 0; c < 3; c++)
            assert_near(outputs[i][c], arrival.irradiance[c],
                        full * spot.intensity[c] / 3.0 * (2.0 * turned + 1.6 * turned / (spot.outer - spot.inner)));
        faded += arrival.irradiance[0] > 0.01 * full && arrival.irradiance[0] < 0.99 * full;
    }
    assert_true(faded > 20);
}

// The mean over a segment is the integral of the twin's share.
static void mean_over_a_segment_is_the_integral(void **state)
{
    enum { STEPS = 20000 };
    int partial = 0;

    put_spots();
    probe("vec4(light_spot_mean(spot, point.xyz - 0.5 * ray.w * ray.xyz, ray.xyz, ray.w))");
    for (size_t i = 0; i < COUNT; i++) {
        struct light spot = spot_of(i);
        struct vec3 way = vec3_normalize(vector_of(inputs[VECTORS * i + 3]));
        double length = inputs[VECTORS * i + 3][3], sum = 0.0;

        for (int k = 0; k < STEPS; k++) {
            struct vec3 point =
                vec3_add(vector_of(inputs[VECTORS * i]), vec3_scale(way, length * ((k + 0.5) / STEPS - 0.5)));
            struct light_arrival arrival = light_arrive(&spot, point);

            sum += arrival.irradiance[0] * arrival.distance * arrival.distance / 3.0 / STEPS;
        }
        // Simpson's rule on a rise that is no cubic of the distance.
        assert_near(outputs[i][0], sum, 0.05);
        partial += sum > 0.05 && sum < 0.95;
    }
    assert_true(partial > 50);
}

// Within the returned stretch the spot shines, outside of it it does not.
static void lit_stretch_is_where_it_shines(void **state)
{
    int lit = 0;

    put_spots();
    probe("vec4(light_spot_lit(spot, point.xyz, ray.xyz), 0.0, 0.0)");
    for (size_t i = 0; i < COUNT; i++) {
        struct light spot = spot_of(i);
        struct vec3 way = vec3_normalize(vector_of(inputs[VECTORS * i + 3]));
        double width = fmin(outputs[i][1], 10.0) - fmax(outputs[i][0], -10.0);

        lit += width > 0.0;
        for (int k = 0; k < 400; k++) {
            double at = -10.0 + 0.05 * k;
            struct vec3 point = vec3_add(vector_of(inputs[VECTORS * i]), vec3_scale(way, at));
            double share = light_arrive(&spot, point).irradiance[0] *
                           vec3_dot(vec3_subtract(point, spot.position), vec3_subtract(point, spot.position));

            // Next to an end rounding decides.
            if (fabs(at - outputs[i][0]) < 1e-3 || fabs(at - outputs[i][1]) < 1e-3) continue;
            assert_true((share > 0.0) == (at > outputs[i][0] && at < outputs[i][1]) || share < 1e-4);
        }
    }
    assert_true(lit > 100);
}

#define CAMERA "\"position\": [0.9, 0.7, -2.1], \"target\": [0.05, 0, 0], \"clip\": [0, 4]"
#define SPOT(inner, outer)                                                                                             \
    "{ \"kind\": \"spot\", \"intensity\": [1, 3, 2], \"position\": [0.9, 0.8, 0.2],"                                   \
    " \"direction\": [-1, -0.8, 0], \"inner\": " inner ", \"outer\": " outer " }"
#define SPOT_INSIDE                                                                                                    \
    "{ \"kind\": \"spot\", \"intensity\": [3, 2, 1], \"position\": [0.15, -0.05, 0.3],"                                \
    " \"direction\": [-1, 0.3, -0.2], \"inner\": 20, \"outer\": 50 }"
#define SUN "{ \"kind\": \"sun\", \"intensity\": [0.5, 1, 2], \"direction\": [1, -2, 0.5] }"
#define COLORS                                                                                                         \
    "\"sigma_s\": [0.4, 0.8, 1.6], \"sigma_a\": [0.5, 0.2, 0],"                                                        \
    " \"phase\": [ { \"g\": 0.6, \"weight\": 0.4 }, { \"kind\": \"rayleigh\", \"weight\": 0.6 } ]"
#define BOX                                                                                                            \
    "{ \"density\": { \"kind\": \"homogeneous\", \"scale\": 2,"                                                        \
    " \"bounds\": { \"kind\": \"box\", \"center\": [0.1, -0.1, 0.2], \"size\": [1.1, 0.7, 0.9] } }, " COLORS " }"
#define SMOKE                                                                                                          \
    "{ \"density\": { \"kind\": \"noise\", \"frequency\": 2, \"scale\": 4, \"bounds\": { \"kind\": \"sphere\", "       \
    "\"center\": [0, 0, 0], \"radius\": 0.6, \"falloff\": 0.2 } }, " COLORS " }"
#define EQUIANGULAR "\"method\": \"equiangular\", \"points\": 16"

static double error_of(const char *lights, const char *scene, const char *quality)
{
    struct error error = {{0}};
    struct true_light light;
    struct job job;
    char text[4096];

    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"spot\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [24, 16],"
             " \"camera\": { " CAMERA ", \"up\": [0.1, 1, 0], \"fov\": 40 }, \"lights\": [ %s ],"
             " \"scene\": { %s }, \"quality\": { %s }, \"output\": { \"path\": \"spot.####.exr\" } }",
             lights, scene, quality);
    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    light = true_light_compare(&job, GL_BACKEND_SOFTWARE);
    job_finish(&job);
    return light.radiance.relative_rmse;
}

#define MEDIA(media) "\"media\": [ " media " ]"

// Points are placed where the spot shines: 16 of them follow its edges, soft ones and a sharp one.
static void placed_points_find_the_cone(void **state)
{
    assert_true(error_of(SPOT("10", "20"), MEDIA(BOX), EQUIANGULAR) < 1e-3);
    assert_true(error_of(SPOT("2", "3"), MEDIA(BOX), EQUIANGULAR) < 1e-3);
    assert_true(error_of(SPOT("15", "15"), MEDIA(BOX), EQUIANGULAR) < 1e-3);
    assert_true(error_of(SPOT("60", "90"), MEDIA(BOX), EQUIANGULAR) < 1e-3);
    assert_true(error_of(SPOT_INSIDE ", " SUN, MEDIA(BOX), EQUIANGULAR) < 1e-3);
}

static void marches_show_the_beam(void **state)
{
    static const struct {
        const char *quality;
        double error;
    } methods[] = {
        {"\"method\": \"midpoint\", \"step\": 0.02, \"light_step\": 0.02", 4e-3},
        {"\"method\": \"gauss\", \"step\": 0.05, \"light_step\": 0.05, \"order\": 3", 3e-4},
        {"\"method\": \"cached\", \"step\": 0.02, \"light_grid\": 96", 4e-3},
        {"\"method\": \"adaptive\", \"depth_step\": 0.02, \"step\": 0.05, \"light_step\": 0.02", 4e-3},
        {"\"method\": \"jittered\", \"step\": 0.02, \"light_step\": 0.02", 8e-3},
        // Sums of first order.
        {"\"method\": \"riemann\", \"step\": 0.002, \"light_steps\": 64", 3e-2},
    };

    for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
        assert_true(error_of(SPOT("10", "20"), MEDIA(SMOKE), methods[k].quality) < methods[k].error);
        assert_true(error_of(SPOT_INSIDE, MEDIA(SMOKE), methods[k].quality) < methods[k].error);
    }
}

// Their frames' mean is the true light.
static void random_flights_show_the_beam(void **state)
{
    static const char *const qualities[] = {
        "\"method\": \"tracking\", \"estimator\": \"delta\"",
        "\"method\": \"tracking\", \"estimator\": \"ratio\"",
        "\"method\": \"paths\", \"paths\": 4",
    };
    struct bias_check_scene scene = {
        .media = SMOKE, .lights = SPOT("20", "50") ",", .quality = qualities[0], .background = "0"};
    static double truth[BIAS_CHECK_VALUES];

    bias_check_find_truth(&scene, truth);
    for (size_t k = 0; k < sizeof qualities / sizeof *qualities; k++) {
        struct bias_check_errors errors;

        scene.quality = qualities[k];
        errors = bias_check_measure(&scene, truth, 400);
        assert_true(fabs(errors.sigmas) < 4.0);
        assert_true(fabs(errors.bias) < 0.05);
    }
}

// Most rays cross the beam in less than a step.
static void marches_show_a_beam_that_is_thinner_than_a_step(void **state)
{
    assert_true(
        error_of(SPOT("1", "2"), MEDIA(SMOKE), "\"method\": \"midpoint\", \"step\": 0.1, \"light_step\": 0.02") < 5e-2);
}

// A floor under a spot that turns from frame to frame, and wanders, and widens.
struct turning {
    struct vec3 position, direction;
    double inner_deg, outer_deg;
};

static void lambert(const struct ray *ray, struct studio_light *light, const void *user)
{
    static const double albedo[3] = {0.9, 0.6, 0.3}, intensity[3] = {9, 12, 15};
    const struct turning *spot = user;
    struct vec3 place = ray_at(ray, -ray->origin.y / ray->direction.y), way = vec3_subtract(place, spot->position);
    double distance = vec3_length(way), degree = M_PI / 180.0;
    double angle = acos(vec3_dot(way, vec3_normalize(spot->direction)) / distance) / degree;
    double s = fmin(fmax((spot->outer_deg - angle) / (spot->outer_deg - spot->inner_deg), 0.0), 1.0);

    for (size_t c = 0; c < 3; c++)
        light->radiance[c] = albedo[c] / M_PI * intensity[c] * s * s * (3.0 - 2.0 * s) * -way.y / pow(distance, 3.0);
    light->alpha = 1.0;
}

#define MOVING(start, rate) "{\"start\": " start ", \"rate\": " rate "}"

static void floor_has_the_irradiance_of_a_moving_spot(void **state)
{
    const struct studio_scene scene = {
        .width_px = 60,
        .height_px = 40,
        .camera = {.position = {0, 3, 4}, .target = {0, 0, -0.2}, .fov = 50},
        .lights = "{\"kind\": \"spot\", \"intensity\": [9, 12, 15],"
                  "\"position\": " MOVING("[0.7, 2.5, -0.4]", "[-2.4, 0, 0]") ", \"direction\": " MOVING(
                      "[0.3, -1, 0.1]", "[0, 0, 2.4]") ", \"inner\": " MOVING("10", "24") ", \"outer\": 35}",
        .objects = "{\"kind\": \"plane\", \"point\": [0, 0, 0], \"material\": {\"kind\": \"diffuse\", "
                   "\"albedo\": [0.9, 0.6, 0.3]}}",
        .frames = "0-10"};
    struct job job;

    (void)state;
    studio_parse(&job, &scene);
    for (int frame = 0; frame <= 10; frame += 5) {
        const struct turning spot = {.position = {0.7 - 0.1 * frame, 2.5, -0.4},
                                     .direction = {0.3, -1, 0.1 + 0.1 * frame},
                                     .inner_deg = 10 + frame,
                                     .outer_deg = 35};
        struct studio_picture picture;

        studio_render(&job, frame, &picture);
        // The share rises by 1 over 15 degrees and more, of which a position's rounding is 1e-6.
        studio_expect(&scene, &picture, lambert, &spot, 1e-5, 1);
        studio_finish(&picture);
    }
    job_finish(&job);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(light_spot_is_its_twin),
        cmocka_unit_test(mean_over_a_segment_is_the_integral),
        cmocka_unit_test(lit_stretch_is_where_it_shines),
        cmocka_unit_test(floor_has_the_irradiance_of_a_moving_spot),
        cmocka_unit_test(placed_points_find_the_cone),
        cmocka_unit_test(marches_show_the_beam),
        cmocka_unit_test(random_flights_show_the_beam),
        cmocka_unit_test(marches_show_a_beam_that_is_thinner_than_a_step),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // name pattern
    return cmocka_run_group_tests(tests, NULL, studio_close);
}
