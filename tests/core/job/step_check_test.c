// SPDX-License-Identifier: Apache-2.0
#include "core/job/step_check.h"

#include "tests/support/job_expect.h"
#include "tests/support/job_text.h"
#include "tests/support/json_edit.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define FOR_OBJECTS                                                                                                    \
    "quality.method: expected a method that renders objects (midpoint or, in homogeneous media, equiangular), got "

static void riemann_needs_an_end(void **state)
{
    char *open = json_edit_set(job_text_full, "camera.clip", NULL);
    char *text = json_edit_set(open, "quality", "{\"method\":\"riemann\",\"step\":0.1,\"light_steps\":4}");
    char *job;

    job_expect_refused(text, "quality.method: riemann needs camera.clip: it steps from the near to the far distance");
    job = json_edit_set(text, "camera.clip", "[0, 20001]");
    job_expect_refused(job,
                       "quality.step: expected at most 200000 steps along a ray, got 200010: 20001 m between the clip "
                       "distances in steps of 0.1 m");
    free(job);
    job = json_edit_set(text, "camera.clip", "[0, 0.04]");
    job_expect_refused(job, "quality.step: expected at most the 0.04 m between the clip distances, got 0.1");
    free(job);
    free(text);
    free(open);
}

static void shadow_rays_are_limited_too(void **state)
{
    char *text = json_edit_set(job_text_full, "quality.light_step", "1e-9");

    job_expect_refused(text,
                       "quality.light_step: expected at most 60000 steps along a ray, got 1119615243: 1.119615242 m "
                       "through scene.media[0] in steps of 1e-09 m");
    free(text);
}

// The first medium of job_text_noise without its bounds.
static char *open_noise(const char *clip, const char *lights)
{
    char *text = json_edit_set(job_text_noise, "scene.media[0].density.bounds", NULL);
    char *with_clip = json_edit_set(text, "camera.clip", clip);
    char *with_lights = json_edit_set(with_clip, "lights", lights);

    free(text);
    free(with_clip);
    return with_lights;
}

static void a_march_has_an_end(void **state)
{
    static const char point[] = "[{\"kind\":\"point\",\"intensity\":1,\"position\":[0,3,0]}]";
    static const char sun[] = "[{\"kind\":\"sun\",\"intensity\":1,\"direction\":[0,-3,0]}]";
    char *text = open_noise(NULL, point), *slab;
    struct job job;

    job_expect_refused(text,
                       "scene.media[0].density: expected bounds (a sphere or a box) or a camera.clip that ends: a "
                       "march through it has no end");
    free(text);
    text = open_noise(NULL, sun); // a clip would not end the sun's path
    job_expect_refused(text,
                       "scene.media[0].density: expected bounds (a sphere or a box): a march through it has no end");
    free(text);
    text = open_noise("[0, 9]", point);
    job = job_expect(text); // the light is 5 m from the camera: 14 m at most in steps of 0.1
    job_finish(&job);
    free(text);
    text = open_noise("[0, 2500]", "[{\"kind\":\"point\",\"intensity\":1,\"position\":[0,4000,4]}]");
    job_expect_refused(text, "quality.light_step: expected at most 60000 steps along a ray, got 65000: 6500 m through "
                             "scene.media[0] in steps of 0.1 m");
    free(text);
    text = open_noise("[0, 9]", sun);
    job_expect_refused(
        text,
        "scene.media[0].density: expected bounds (a sphere or a box): the path of lights[0] through it has no end");
    slab = json_edit_set(text, "scene.media[0].density.bounds", "{\"kind\":\"slab\",\"thickness\":60}");
    job = job_expect(slab);
    job_finish(&job);
    free(slab);
    slab = json_edit_set(text, "scene.media[0].density.bounds",
                         "{\"kind\":\"slab\",\"thickness\":6,\"normal\":[1,0.001,0]}");
    job_expect_refused(slab,
                       "quality.light_step: expected at most 60000 steps along a ray, got 60001: 6000.003 m through "
                       "scene.media[0] in steps of 0.1 m");
    free(slab);
    free(text);
}

static void light_grids_need_bounds(void **state)
{
    static const char quality[] = "{\"method\":\"cached\",\"step\":0.1,\"light_grid\":32}";
    static const char objects[] = "[{\"kind\":\"plane\",\"point\":[0,-9,0],\"material\":{\"kind\":\"mirror\"}}]";
    char *text = json_edit_set(job_text_noise, "quality", quality), *open, *slab;
    struct job job = job_expect(text);

    (void)state;
    job_finish(&job);
    open = json_edit_set(text, "scene.media[1].density.bounds", NULL);
    job_expect_refused(open,
                       "scene.media[1].density: expected bounds (a sphere or a box): with cached each light has a grid "
                       "around it");
    free(open);
    slab = json_edit_set(text, "scene.media[1].density.bounds", "{\"kind\":\"slab\",\"thickness\":1}");
    job_expect_refused(slab,
                       "scene.media[1].density: expected bounds (a sphere or a box): with cached each light has a grid "
                       "around it");
    open = json_edit_set(slab, "lights", "[]"); // without lights there is no grid
    job = job_expect(open);
    job_finish(&job);
    free(open);
    free(slab);
    slab = json_edit_set(text, "scene.objects", objects);
    job_expect_refused(slab, FOR_OBJECTS "cached");
    free(slab);
    free(text);
}

static void light_grids_of_paths_need_lamps_and_varying_media_that_end(void **state)
{
    static const char quality[] = "{\"method\":\"paths\",\"paths\":8,\"light_grid\":32}";
    static const char floor[] =
        "[{\"kind\":\"plane\",\"point\":[0,-9,0],\"material\":{\"kind\":\"diffuse\",\"albedo\":1}}]";
    char *text = json_edit_set(job_text_paths, "quality", quality),
         *edited = json_edit_set(text, "scene.objects", floor);
    struct job job = job_expect(edited);

    (void)state;
    job_finish(&job);
    free(edited);
    edited = json_edit_set(text, "lights", "[{\"kind\":\"dome\",\"radiance\":1}]");
    job_expect_refused(edited, "quality.light_grid: only for a sun, a point or a spot: paths lead to other lights");
    free(edited);
    edited = json_edit_set(text, "scene.media[0].density",
                           "{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"sphere\",\"radius\":1}}");
    job_expect_refused(edited, "quality.light_grid: only where a density varies: what reaches others is known exactly");
    free(edited);
    edited = json_edit_set(text, "scene.media[0].density.bounds", "{\"kind\":\"slab\",\"thickness\":1}");
    job_expect_refused(edited,
                       "scene.media[0].density: expected bounds (a sphere or a box): with a light_grid each light has "
                       "a grid around it");
    free(edited);
    free(text);
}

static void light_grids_have_four_channels(void **state)
{
    static const char quality[] = "{\"method\":\"cached\",\"step\":0.1,\"light_grid\":32}";
    static const char cloud[] =
        "{\"density\":{\"kind\":\"noise\",\"frequency\":1,\"bounds\":{\"kind\":\"sphere\",\"radius\":1}},"
        "\"sigma_s\":1}";
    char *text = json_edit_set(job_text_noise, "quality", quality);

    (void)state;
    for (size_t count = 4; count <= 5; count++) {
        char media[1024] = "[", *many;

        for (size_t i = 0; i < count; i++)
            snprintf(media + strlen(media), sizeof media - strlen(media), "%s%s", i > 0 ? "," : "", cloud);
        strcat(media, "]");
        many = json_edit_set(text, "scene.media", media);
        if (count == 4) {
            struct job job = job_expect(many);

            job_finish(&job);
        } else {
            job_expect_refused(many, "quality.method: expected at most 4 media whose density varies with cached");
        }
        free(many);
    }
    free(text);
}

// Closed forms need no steps, however far a ray goes.
static void even_media_need_no_end(void **state)
{
    static const char quality[] = "{\"method\":\"midpoint\",\"step\":1e-6}";
    char *text = json_edit_set(job_text_fog, "camera.clip", NULL);
    char *dark = json_edit_set(text, "lights", NULL), *marched = json_edit_set(dark, "quality", quality), *lit;
    struct job job = job_expect(text);

    job_finish(&job);
    job = job_expect(marched);
    assert_true(job.quality.light_step == 0.0);
    job_finish(&job);
    lit = json_edit_set(text, "quality", quality);
    job_expect_refused(lit, "scene.media[0].density: expected bounds (a sphere or a box) or a camera.clip that ends: a "
                            "march through it has no end");
    free(lit);
    free(marched);
    free(dark);
    free(text);
}

// Random paths end as they are absorbed, so several orders of scattering need no bounds without a method.
static void several_orders_need_no_end(void **state)
{
    char *open = json_edit_set(job_text_noise, "scene.media",
                               "[{\"density\":{\"kind\":\"noise\",\"frequency\":1},\"sigma_s\":1,\"sigma_a\":1}]");
    char *one = json_edit_set(open, "camera.clip", NULL),
         *planned = json_edit_set(one, "quality", "{\"tolerance\":0.1}");
    char *all = json_edit_set(planned, "scene.scattering", "{\"orders\":\"all\"}"), *marched;
    struct job job = job_expect(all);

    (void)state;
    job_finish(&job);
    marched =
        json_edit_set(all, "quality", "{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1,\"scatter_grid\":8}");
    job_expect_refused(planned,
                       "scene.media[0].density: expected bounds (a sphere or a box) or a camera.clip that ends: "
                       "a march through it has no end");
    job_expect_refused(marched, "scene.media[0].density: expected bounds of a sphere or a box: a scatter_grid is a box "
                                "around what scatters");
    free(marched);
    free(all);
    free(planned);
    free(one);
    free(open);
}

static void equiangular_is_for_even_media(void **state)
{
    char *text = json_edit_set(job_text_fog, "scene.media[0].density.bounds.falloff", "0.5");
    char *noise = json_edit_set(job_text_noise, "quality", "{\"method\":\"equiangular\",\"points\":8}");

    job_expect_refused(text, "scene.media[0].density.bounds.falloff: expected 0, which equiangular needs, got 0.5");
    job_expect_refused(noise,
                       "scene.media[0].density.kind: expected \"homogeneous\", which equiangular needs everywhere, "
                       "got \"noise\"");
    free(text);
    free(noise);
}

static void equiangular_points_are_limited_along_a_ray(void **state)
{
    char lights[2048] = "[", expected[128];
    char *medium, *lit, *text;

    for (int i = 0; i < 16; ++i)
        strcat(lights, i == 0 ? "{\"kind\":\"sun\",\"intensity\":1,\"direction\":[0,-1,0]}"
                              : ",{\"kind\":\"sun\",\"intensity\":1,\"direction\":[0,-1,0]}");
    strcat(lights, "]");
    medium = json_edit_set(job_text_fog, "scene.media",
                           "[{\"density\":{\"kind\":\"homogeneous\"},\"sigma_s\":1},{\"density\":{\"kind\":"
                           "\"homogeneous\"},\"sigma_a\":1},"
                           "{\"density\":{\"kind\":\"homogeneous\"},\"sigma_a\":1}]");
    lit = json_edit_set(medium, "lights", lights);
    // Three media cut a ray into five intervals at most.
    text = json_edit_set(lit, "quality", "{\"method\":\"equiangular\",\"points\":751}");
    snprintf(expected, sizeof expected, "quality.points: expected at most %d with 16 lights and 3 media, got 751",
             60000 / (16 * 5));
    job_expect_refused(text, expected);
    free(text);
    text = json_edit_set(lit, "quality", "{\"method\":\"equiangular\",\"points\":750}");
    {
        struct job job = job_expect(text);

        job_finish(&job);
    }
    free(text);
    free(lit);
    free(medium);
}

// job_text_objects without camera.clip and with another last object.
static char *last_object(const char *object)
{
    char *open = json_edit_set(job_text_objects, "camera.clip", NULL);
    char *text = json_edit_set(open, "scene.objects[5]", object);

    free(open);
    return text;
}

#define GLASS "\"material\":{\"kind\":\"dielectric\",\"ior\":1.5,\"interior\":{\"sigma_s\":1,\"density\":" NOISE "}}"
#define NOISE "{\"kind\":\"noise\",\"frequency\":2}"

static void assert_steps_through_interior(const char *object, const char *length)
{
    char *text = last_object(object), *fine = json_edit_set(text, "quality.light_step", "1e-6"), expected[256];
    struct job job = job_expect(text);

    job_finish(&job);
    snprintf(expected, sizeof expected,
             "quality.light_step: expected at most 60000 steps along a ray, got %s000000: %s m through "
             "scene.objects[5].material.interior in steps of 1e-06 m",
             length, length);
    job_expect_refused(fine, expected);
    free(fine);
    free(text);
}

static void an_interior_ends_with_its_object(void **state)
{
    char *text = last_object("{\"kind\":\"plane\",\"point\":[0,0,0]," GLASS "}");

    assert_steps_through_interior("{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":3.5," GLASS "}", "7");
    assert_steps_through_interior("{\"kind\":\"box\",\"center\":[0,0,0],\"size\":[2,3,6]," GLASS "}", "7");
    assert_steps_through_interior("{\"kind\":\"union\",\"of\":[{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1},"
                                  "{\"kind\":\"box\",\"center\":[9,0,0],\"size\":[2,3,6]}]," GLASS "}",
                                  "9");
    job_expect_refused(text, "scene.objects[5].material.interior.density: expected bounds (a sphere or a box) or a "
                             "camera.clip that ends: a march through it has no end");
    free(text);
}

// The bounds of an interior may be smaller than its object.
static void an_interior_ends_with_its_bounds(void **state)
{
    char *text = last_object("{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":3.5," GLASS "}");
    char *bounded = json_edit_set(text, "scene.objects[5].material.interior.density.bounds",
                                  "{\"kind\":\"sphere\",\"radius\":0.5}");
    char *fine = json_edit_set(bounded, "quality.light_step", "1e-6");

    job_expect_refused(fine, "quality.light_step: expected at most 60000 steps along a ray, got 1000000: 1 m through "
                             "scene.objects[5].material.interior in steps of 1e-06 m");
    free(fine);
    free(bounded);
    free(text);
}

// Surfaces are lit also beyond camera.clip, within which media count.
static void light_marches_to_all_that_it_lights(void **state)
{
    static const char slab[] = "[{\"sigma_s\":1,\"density\":{\"kind\":\"noise\",\"frequency\":2,\"bounds\":{\"kind\":"
                               "\"slab\",\"thickness\":2}}}]";
    char *foggy = json_edit_set(job_text_objects, "scene.media", slab);
    char *floor = json_edit_set(foggy, "scene.objects",
                                "[{\"kind\":\"plane\",\"point\":[0,-1,0],\"material\":{\"kind\":\"diffuse\","
                                "\"albedo\":1}}]");
    char *mirror = json_edit_set(floor, "scene.objects[0].material", "{\"kind\":\"mirror\"}");
    char *far =
        json_edit_set(floor, "scene.objects[0]",
                      "{\"kind\":\"sphere\",\"center\":[0,-6002,0],\"radius\":1,\"material\":{\"kind\":\"diffuse\","
                      "\"albedo\":1}}");
    struct job job = job_expect(mirror);

    job_finish(&job);
    job_expect_refused(
        floor,
        "scene.media[0].density: expected bounds (a sphere or a box): the path of lights[0] through it has no end");
    job_expect_refused(far, "quality.light_step: expected at most 60000 steps along a ray, got 60060: 6006 m through "
                            "scene.media[0] in steps of 0.1 m");
    free(far);
    free(mirror);
    free(floor);
    free(foggy);
}

static void methods_without_objects_name_those_with(void **state)
{
    char *text = json_edit_set(job_text_objects, "quality", "{\"method\":\"riemann\",\"step\":0.1,\"light_steps\":4}");

    job_expect_refused(text, FOR_OBJECTS "riemann");
    free(text);
    text = json_edit_set(job_text_objects, "quality", "{\"method\":\"tracking\",\"estimator\":\"ratio\"}");
    job_expect_refused(text, FOR_OBJECTS "tracking");
    free(text);
}

static void equiangular_takes_even_interiors(void **state)
{
    char *noise = json_edit_set(job_text_objects, "quality", "{\"method\":\"equiangular\",\"points\":8}");
    char *text = json_edit_set(noise, "scene.objects[5].material.interior.density", NULL);
    struct job job = job_expect(text);

    job_finish(&job);
    job_expect_refused(noise,
                       "scene.objects[5].material.interior.density.kind: expected \"homogeneous\", which equiangular "
                       "needs everywhere, got \"noise\"");
    free(text);
    free(noise);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(riemann_needs_an_end),
        cmocka_unit_test(shadow_rays_are_limited_too),
        cmocka_unit_test(a_march_has_an_end),
        cmocka_unit_test(light_grids_need_bounds),
        cmocka_unit_test(light_grids_have_four_channels),
        cmocka_unit_test(light_grids_of_paths_need_lamps_and_varying_media_that_end),
        cmocka_unit_test(even_media_need_no_end),
        cmocka_unit_test(several_orders_need_no_end),
        cmocka_unit_test(equiangular_is_for_even_media),
        cmocka_unit_test(equiangular_points_are_limited_along_a_ray),
        cmocka_unit_test(an_interior_ends_with_its_object),
        cmocka_unit_test(an_interior_ends_with_its_bounds),
        cmocka_unit_test(light_marches_to_all_that_it_lights),
        cmocka_unit_test(methods_without_objects_name_those_with),
        cmocka_unit_test(equiangular_takes_even_interiors),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
