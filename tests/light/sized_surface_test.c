// Diffuse floors under domes and spheres, as random paths show them, against closed forms.
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/studio.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#define FLOOR                                                                                                          \
    "{\"kind\": \"plane\", \"point\": [0, 0, 0], \"material\": {\"kind\": \"diffuse\", \"albedo\": [0.9, 0.6, 0.3]}}"

static const double albedo[3] = {0.9, 0.6, 0.3};

static struct studio_scene floor_under(const char *lights, const char *quality)
{
    return (struct studio_scene){.width_px = 30,
                                 .height_px = 20,
                                 .camera = {.position = {0, 3, 4}, .target = {0, 0, -0.2}, .fov = 50},
                                 .lights = lights,
                                 .objects = FLOOR,
                                 .quality = quality};
}

// In light of radiance 1 from everywhere a floor is as bright as its albedo.
static void is_its_albedo(const struct ray *ray, struct studio_light *light, const void *user)
{
    for (size_t c = 0; c < 3; c++)
        light->radiance[c] = albedo[c];
    light->alpha = 1.0;
}

static void floor_in_uniform_light_shows_its_albedo(void **state)
{
    const struct studio_scene scene =
        floor_under("{\"kind\": \"dome\", \"radiance\": 1}", "\"method\": \"paths\", \"paths\": 4");

    // Directions are drawn by the cosine, which leaves no noise.
    studio_check(&scene, is_its_albedo, NULL, 1e-5, 1);
}

// The mean cosine of the light that a floor scatters from a uniform half of the sky is 2/3.
static void has_five_sixths(const struct ray *ray, struct studio_light *light, const void *user)
{
    static const double along[3] = {3, 1, 0}, against[3] = {0, 2, 6};

    for (size_t c = 0; c < 3; c++)
        light->radiance[c] = albedo[c] * (against[c] + (along[c] - against[c]) * 5.0 / 6.0);
}

static void floor_under_a_gradient_weighs_by_the_cosine(void **state)
{
    const struct studio_scene scene = floor_under("{\"kind\": \"dome\", \"gradient\": {\"along\": [3, 1, 0],"
                                                  " \"against\": [0, 2, 6], \"axis\": [0, 1, 0]}}",
                                                  "\"method\": \"paths\", \"paths\": 4096");

    // A direction's light varies by 0.35 at most about its mean of 0.3 to 2.3; five standard errors.
    studio_check(&scene, has_five_sixths, NULL, 5.0 * 0.9 / 64.0, 1);
}

// A sphere that is wholly above the floor lights it as a point does: its view factor is (r / d)^2 times the cosine.
static void is_lit_as_by_a_point(const struct ray *ray, struct studio_light *light, const void *user)
{
    static const double intensity[3] = {9, 12, 15};
    struct vec3 place = ray_at(ray, -ray->origin.y / ray->direction.y);
    struct vec3 way = vec3_subtract((struct vec3){0.7, 1.5, -0.4}, place);

    for (size_t c = 0; c < 3; c++)
        light->radiance[c] = albedo[c] / M_PI * intensity[c] * way.y / pow(vec3_length(way), 3.0);
}

static void floor_under_a_sphere_has_its_view_factor(void **state)
{
    const struct studio_scene scene = floor_under("{\"kind\": \"sphere\", \"intensity\": [9, 12, 15],"
                                                  " \"position\": [0.7, 1.5, -0.4], \"radius\": 0.8}",
                                                  "\"method\": \"paths\", \"paths\": 4096");

    // Cosines vary by a fifth of their mean within the sphere next to it, farther away by as much as they are: five
    // standard errors.
    studio_check(&scene, is_lit_as_by_a_point, NULL, 0.04, 1);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(floor_in_uniform_light_shows_its_albedo),
        cmocka_unit_test(floor_under_a_gradient_weighs_by_the_cosine),
        cmocka_unit_test(floor_under_a_sphere_has_its_view_factor),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // name pattern
    return cmocka_run_group_tests(tests, NULL, studio_close);
}
