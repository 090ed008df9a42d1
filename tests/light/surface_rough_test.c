// Rough mirrors and rough glass: the same means as from other random numbers, and the same numbers on both backends.
// SPDX-License-Identifier: Apache-2.0
#include "core/job/job.h"
#include "reference/reference.h"
#include "tests/support/assert_near.h"
#include "tests/support/optics.h"
#include "tests/support/random.h"
#include "tests/support/studio.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#define ROUGH_FLOOR(roughness)                                                                                         \
    "{\"kind\": \"plane\", \"point\": [0, 0, 0], \"material\": {\"kind\": \"mirror\", \"roughness\": " #roughness "}}"
// The slab absorbs the more, the flatter a ray crosses it.
#define CEILING                                                                                                        \
    "{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"slab\", \"center\": [0, 2, 0], \"normal\": "   \
    "[0, 1, "                                                                                                          \
    "0], \"thickness\": 1}}, \"sigma_a\": [0.3, 1, 3]}"

static struct vec3 random_normal(struct random *random, const struct ray *ray, double roughness)
{
    for (int i = 0; i < 16; ++i) {
        double height = random_between(random, -1, 1), angle = random_between(random, 0, 2 * acos(-1.0));
        double across = sqrt(1 - height * height);
        struct vec3 shift = {across * cos(angle), height, across * sin(angle)};
        struct vec3 normal = vec3_normalize(vec3_add((struct vec3){0, 1, 0}, vec3_scale(shift, roughness)));

        if (normal.y > 0 && vec3_dot(normal, ray->direction) < 0) return normal;
    }
    return (struct vec3){0, 1, 0};
}

// Mean of the light that is reflected, or that passes a boundary with that `eta`, and mean of its square.
static void estimate_light(const struct ray *ray, double roughness, double eta, double mean[3], double square[3])
{
    static const double sigma[3] = {0.3, 1, 3};
    struct random random = {77};
    enum { COUNT = 40000 };

    for (int i = 0; i < COUNT; ++i) {
        struct vec3 normal = random_normal(&random, ray, roughness);
        struct vec3 onwards = optics_reflect(ray->direction, normal);

        if (eta > 0.0) assert_true(optics_refract(ray->direction, normal, eta, 1.0, &onwards));
        for (int c = 0; c < 3; ++c) {
            // A ray that would enter the floor, or stay outside of it, goes as far in the opposite direction.
            double light = exp(-sigma[c] / fabs(onwards.y));

            mean[c] += light / COUNT;
            square[c] += light * light / COUNT;
        }
    }
}

static void check_roughness(const char *objects, double roughness, double eta)
{
    enum { SAMPLES = 64, PIXELS = 64 };
    const struct studio_scene scene = {.width_px = 8,
                                       .height_px = 8,
                                       // The directions of all pixels are the same within a thousandth.
                                       .camera = {.position = {0, 0.5, 0}, .target = {0, 0, 0.6}, .fov = 0.02},
                                       .background = "1",
                                       .media = CEILING,
                                       .objects = objects,
                                       .quality = "\"method\": \"equiangular\", \"points\": 4, \"samples\": 64"};
    struct ray ray = studio_ray(&scene, 4, 4);
    double mean[3] = {0, 0, 0}, square[3] = {0, 0, 0};
    struct studio_picture picture;

    estimate_light(&ray, roughness, eta, mean, square);
    studio_shoot(&scene, &picture);
    for (int c = 0; c < 3; ++c) {
        double seen = 0.0, deviation = sqrt((square[c] - mean[c] * mean[c]) / (SAMPLES * PIXELS) * 1.2);

        for (int i = 0; i < PIXELS; ++i)
            seen += picture.image.rgba[4 * i + c] / PIXELS;
        assert_near(seen, mean[c], 4.5 * deviation + 1e-3 * mean[c] * roughness + 1e-4 * mean[c]);
    }
    studio_finish(&picture);
}

static void rough_mirrors_reflect_as_random_normals(void **state)
{
    studio_use(*(enum gl_backend *)*state);
    check_roughness(ROUGH_FLOOR(0.2), 0.2, 0.0);
    check_roughness(ROUGH_FLOOR(1), 1, 0.0);
}

// The slab absorbs the more, the less a ray is refracted.
#define ROUGH_WATER(roughness)                                                                                         \
    "{\"kind\": \"plane\", \"point\": [0, 0, 0], \"material\": {\"kind\": \"dielectric\", \"ior\": 2.5, \"fresnel\": " \
    "\"none\", \"roughness\": " #roughness                                                                             \
    ", \"interior\": {\"sigma_a\": [0.3, 1, 3], \"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": "      \
    "\"slab\", \"center\": [0, -2, 0], \"normal\": [0, 1, 0], \"thickness\": 1}}}}}"

static void rough_water_refracts_as_random_normals(void **state)
{
    (void)state;
    check_roughness(ROUGH_WATER(0.3), 0.3, 0.4);
    check_roughness(ROUGH_WATER(1), 1, 0.4);
}

static void nothing_behind(const struct ray *ray, struct studio_light *light, const void *user)
{
    (void)ray, (void)user;
    studio_set_color(light->transmittance, 0.0);
}

// Facets would refract flat rays up again in a medium thinner than air, if nothing kept them inside: the ink would not
// be met.
static void refracted_rays_enter_the_medium(void **state)
{
    const struct studio_scene scene = {
        .width_px = 8,
        .height_px = 8,
        .camera = {.position = {0, 0.1, 0}, .target = {0, 0, 1}, .fov = 2},
        .objects = "{\"kind\": \"plane\", \"point\": [0, 0, 0], \"material\": {\"kind\": \"dielectric\", \"ior\": 0.5, "
                   "\"fresnel\": \"none\", \"roughness\": 1, \"interior\": {\"sigma_a\": 10000}}}",
        .quality = "\"method\": \"equiangular\", \"points\": 4, \"samples\": 64, \"max_cut\": 1"};

    (void)state;
    studio_check(&scene, nothing_behind, NULL, 1e-6, 1);
}

#define LAMP "{\"kind\": \"point\", \"position\": [1.5, 2, 1], \"intensity\": [9, 8, 7]}"
#define ROUGH_THINGS                                                                                                   \
    "{\"kind\": \"plane\", \"point\": [0, -1, 0], \"material\": {\"kind\": \"diffuse\", \"albedo\": 0.7, "             \
    "\"specular\": "                                                                                                   \
    "0.5, \"roughness\": 0.3}}, {\"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 0.9, \"material\": "         \
    "{\"kind\": "                                                                                                      \
    "\"dielectric\", \"ior\": 1.4, \"roughness\": 0.2, \"interior\": {\"sigma_a\": [0.2, 0.5, 1]}}}"

static struct studio_scene rough_things(const char *quality)
{
    return (struct studio_scene){.width_px = 6,
                                 .height_px = 5,
                                 .camera = {.position = {0.2, 0.5, 4}, .fov = 40},
                                 .lights = LAMP,
                                 .background = "[0.5, 1, 2]",
                                 .objects = ROUGH_THINGS,
                                 .quality = quality};
}

enum { SAMPLES = 256 }; // samples a pixel

static struct reference_pixel measure_reference(const struct job *job, int x_px, int y_px, struct random *random)
{
    struct reference_sample samples[SAMPLES];

    for (size_t i = 0; i < SAMPLES; ++i)
        samples[i] = (struct reference_sample){.x = random_between(random, 0, 1),
                                               .y = random_between(random, 0, 1),
                                               .seed = (uint64_t)random_between(random, 1, 1e15)};
    return reference_measure_samples(job, NULL, x_px, y_px, samples, SAMPLES, NULL);
}

// Each pixel's deviation is as large as random errors make it, and so is the mean of all of them.
static void rough_glass_is_on_average_that_of_the_reference(void **state)
{
    const struct studio_scene scene =
        rough_things("\"method\": \"equiangular\", \"points\": 4, \"samples\": 256, \"max_depth\": 5, \"max_cut\": 1");
    double squares = 0.0, sum = 0.0, variance = 0.0;
    int count = 3 * scene.width_px * scene.height_px;
    struct random random = {4711};
    struct studio_picture picture;
    struct job job = {0};

    (void)state;
    studio_parse(&job, &scene);
    studio_render(&job, 0, &picture);
    for (int i = 0; i < count / 3; ++i) {
        struct reference_pixel pixel = measure_reference(&job, i % scene.width_px, i / scene.width_px, &random);

        for (int c = 0; c < 3; ++c) {
            // Renderer and reference take equally many samples.
            double deviation = sqrt(2.0) * pixel.radiance_error[c] + 1e-4;
            double off = picture.image.rgba[4 * i + c] - pixel.radiance[c];

            squares += pow(off / deviation, 2) / count;
            sum += off;
            variance += deviation * deviation;
        }
    }
    print_message("mean square of deviations %.2f, of all together %.2f\n", squares, sum * sum / variance);
    assert_true(squares < 1.4);
    // The colours of a pixel are correlated.
    assert_near(sum, 0.0, 3.5 * sqrt(3.0 * variance));
    studio_finish(&picture);
    job_finish(&job);
}

static void random_numbers_are_alike_on_both_backends(void **state)
{
    const struct studio_scene scene =
        rough_things("\"method\": \"equiangular\", \"points\": 4, \"samples\": 3, \"max_depth\": 5, \"max_cut\": 1");
    struct studio_picture pictures[2];

    (void)state;
    studio_shoot(&scene, &pictures[0]);
    studio_close(NULL);
    studio_use(GL_BACKEND_EGL);
    studio_shoot(&scene, &pictures[1]);
    studio_use(GL_BACKEND_SOFTWARE);
    for (int i = 0; i < 4 * scene.width_px * scene.height_px; ++i)
        assert_true(pictures[0].image.rgba[i] == pictures[1].image.rgba[i]);
    studio_finish(&pictures[0]);
    studio_finish(&pictures[1]);
}

int main(int argument_count, char **arguments)
{
    static enum gl_backend software = GL_BACKEND_SOFTWARE, egl = GL_BACKEND_EGL;
    const struct CMUnitTest tests[] = {
        {"rough_mirrors_reflect_as_dice_do_egl", rough_mirrors_reflect_as_random_normals, NULL, NULL, &egl},
        {"rough_mirrors_reflect_as_dice_do_software", rough_mirrors_reflect_as_random_normals, NULL, NULL, &software},
        cmocka_unit_test(rough_water_refracts_as_random_normals),
        cmocka_unit_test(refracted_rays_enter_the_medium),
        cmocka_unit_test(rough_glass_is_on_average_that_of_the_reference),
        cmocka_unit_test(random_numbers_are_alike_on_both_backends),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, studio_close);
}
