// SPDX-License-Identifier: Apache-2.0
#include "core/job/scattering_check.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job_json.h"
#include "tests/support/job_expect.h"
#include "tests/support/job_text.h"
#include "tests/support/json_edit.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define LAMP "{\"kind\":\"point\",\"intensity\":1,\"position\":[0,3,0]}"
#define SPHERE "{\"kind\":\"sphere\",\"intensity\":1,\"position\":[0,3,0],\"radius\":1}"
#define DOME "{\"kind\":\"dome\",\"radiance\":1}"
#define BALL(coefficients)                                                                                             \
    "{\"density\":{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"sphere\",\"radius\":1}}," coefficients "}"
#define NOISE                                                                                                          \
    "{\"density\":{\"kind\":\"noise\",\"frequency\":2,\"bounds\":{\"kind\":\"sphere\",\"radius\":1}},\"sigma_s\":1}"
#define PATHS "{\"method\":\"paths\",\"paths\":16}"
#define GRID(method) "{\"method\":\"" method "\",\"step\":0.1,\"light_step\":0.1,\"scatter_grid\":16}"

// A job with this array of lights, these members of the scene, and this quality.
static char *job_with(const char *lights, const char *scene, const char *quality)
{
    return xasprintf("{\"version\":1,\"name\":\"x\",\"frames\":\"0-9\",\"fps\":1,\"resolution\":[32,18],\"camera\":{"
                     "\"position\":[0,0,4],\"target\":[0,0,0],\"fov\":40,\"clip\":[1,9]},\"lights\":[%s],"
                     "\"scene\":{%s},\"quality\":%s,\"output\":{\"path\":\"x/x.#.exr\"}}",
                     lights, scene, quality);
}

static void assert_refused(const char *lights, const char *scene, const char *quality, const char *expected)
{
    char *text = job_with(lights, scene, quality);

    job_expect_refused(text, expected);
    free(text);
}

// Takes what goes together, even where the worker does not render it yet.
static void assert_taken_text(const char *text)
{
    struct error error = {0};
    struct job job;

    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s: %s", error.message, text);
    job_finish(&job);
}

static void assert_taken(const char *lights, const char *scene, const char *quality)
{
    char *text = job_with(lights, scene, quality);

    assert_taken_text(text);
    free(text);
}

#define ALL "\"scattering\":{\"orders\":\"all\"},"
#define TWO "\"scattering\":{\"orders\":2},"
#define ONE "\"scattering\":{\"orders\":1},"
#define MEDIA(medium) "\"media\":[" medium "]"

static void what_goes_together_is_taken(void **state)
{
    static const char adaptive[] = "{\"method\":\"adaptive\",\"step\":0.1,\"light_step\":0.1,\"depth_step\":0.1,"
                                   "\"scatter_grid\":16,\"paths\":32}";
    static const char cached[] = "{\"method\":\"cached\",\"step\":0.1,\"light_grid\":16,\"scatter_grid\":4}";
    const char *const marches[] = {GRID("midpoint"), GRID("jittered"), GRID("gauss"), adaptive, cached};

    assert_taken_text(job_text_paths);
    assert_taken(LAMP, ALL MEDIA(NOISE), PATHS);
    assert_taken(LAMP, MEDIA(NOISE), PATHS);
    assert_taken(DOME, MEDIA(NOISE), PATHS);
    assert_taken(DOME "," LAMP, TWO MEDIA(NOISE), "{\"tolerance\":0.01}");
    assert_taken(LAMP, ALL MEDIA(NOISE), "\"draft\"");
    for (size_t i = 0; i < sizeof marches / sizeof marches[0]; i++) {
        assert_taken(LAMP, TWO MEDIA(NOISE), marches[i]);
        assert_taken(DOME, ALL MEDIA(NOISE), marches[i]);
    }
    assert_taken(LAMP, TWO MEDIA(BALL("\"sigma_s\":1")),
                 "{\"method\":\"equiangular\",\"points\":4,\"scatter_grid\":8}");
    assert_taken(LAMP, ONE MEDIA(BALL("\"sigma_s\":1")), "{\"method\":\"equiangular\",\"points\":4}");
}

static void a_scene_has_one_dome(void **state)
{
    assert_refused(LAMP "," DOME "," DOME, MEDIA(NOISE), PATHS, "lights[2].kind: expected one dome at most, got two");
}

static void a_visible_dome_takes_the_place_of_a_background(void **state)
{
    char *text = json_edit_set(job_text_paths, "background", "1"), *hidden;

    job_expect_refused(text, "lights[2].visible: not beside a background: both lie behind everything");
    hidden = json_edit_set(text, "lights[2].visible", "false");
    assert_taken_text(hidden);
    free(hidden);
    free(text);
}

static void light_of_many_directions_needs_random_paths(void **state)
{
    static const char message[] = "lights[1].kind: its light comes from many directions, and needs quality.method "
                                  "\"paths\", or scene.scattering.orders above 1";
    static const char *const qualities[] = {"{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1}",
                                            "{\"method\":\"cached\",\"step\":0.1,\"light_grid\":16}",
                                            "{\"method\":\"tracking\",\"estimator\":\"ratio\"}", "{\"tolerance\":0.01}",
                                            "\"draft\""};

    for (size_t i = 0; i < sizeof qualities / sizeof qualities[0]; i++) {
        assert_refused(LAMP "," DOME, MEDIA(NOISE), qualities[i], message);
        assert_refused(LAMP ",{\"kind\":\"sphere\",\"intensity\":1,\"position\":[0,3,0],\"radius\":1}",
                       ONE MEDIA(NOISE), qualities[i], message);
    }
}

static void methods_that_show_one_order_say_so(void **state)
{
#define EXPECTED                                                                                                       \
    "quality.method: expected one that shows light scattered more than once (paths, or another march with a "          \
    "scatter_grid), got "
    assert_refused(LAMP, TWO MEDIA(NOISE), "{\"method\":\"riemann\",\"step\":0.1,\"light_steps\":4}",
                   EXPECTED "riemann");
    assert_refused(LAMP, TWO MEDIA(NOISE), GRID("preintegrated"), EXPECTED "preintegrated");
    assert_refused(LAMP, ALL MEDIA(NOISE), "{\"method\":\"tracking\",\"estimator\":\"delta\"}", EXPECTED "tracking");
#undef EXPECTED
}

static void a_march_of_several_orders_needs_a_scatter_grid(void **state)
{
    static const char message[] = "quality.scatter_grid: expected a number of cells, which a march needs where light "
                                  "scatters more than once (or quality.method \"paths\"), got nothing";

    assert_refused(LAMP, TWO MEDIA(NOISE), "{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1}", message);
    assert_refused(LAMP, ALL MEDIA(BALL("\"sigma_s\":1")), "{\"method\":\"equiangular\",\"points\":4}", message);
}

static void a_scatter_grid_needs_several_orders(void **state)
{
    static const char message[] = "quality.scatter_grid: only where light scatters more than once: scene.scattering";

    assert_refused(LAMP, MEDIA(NOISE), GRID("midpoint"), message);
    assert_refused(LAMP, ONE MEDIA(NOISE), GRID("gauss"), message);
}

#define SOLID(material)                                                                                                \
    "\"objects\":[{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1,\"material\":{" material "}}]"
#define END                                                                                                            \
    ": not with random paths, which end at what reflects or refracts as a mirror does: they are those of "             \
    "quality.method \"paths\" and of scene.scattering.orders above 1"

static void random_paths_end_at_mirrors_and_glass(void **state)
{
    static const char march[] = "{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1,\"scatter_grid\":8}";
    static const char mirror[] = SOLID("\"kind\":\"mirror\""), glass[] = SOLID("\"kind\":\"dielectric\",\"ior\":1.5");
    static const char shiny[] = SOLID("\"kind\":\"diffuse\",\"albedo\":1,\"specular\":{\"keys\":[[0,0],[5,0.5]]}");
    static const char *const orders[] = {"", TWO, ALL}, *const qualities[] = {PATHS, march, "{}"};

    for (size_t i = 0; i < 3; i++) {
        for (size_t k = 0; k < 3; k++) {
            char *scenes[] = {xasprintf("%s%s", orders[i], mirror), xasprintf("%s%s", orders[i], glass),
                              xasprintf("%s%s", orders[i], shiny)};

            // A march of one order has no random paths, nor has a plan for one.
            if (i > 0 || k == 0) {
                assert_refused(LAMP, scenes[0], qualities[k], "scene.objects[0].material.kind" END);
                assert_refused(LAMP, scenes[1], qualities[k], "scene.objects[0].material.kind" END);
                assert_refused(LAMP, scenes[2], qualities[k], "scene.objects[0].material.specular" END);
            }
            for (size_t s = 0; s < 3; s++)
                free(scenes[s]);
        }
    }
    assert_taken(LAMP, mirror, "{}");
    assert_taken(LAMP, TWO SOLID("\"kind\":\"diffuse\",\"albedo\":1"), PATHS);
    assert_taken(LAMP, TWO SOLID("\"kind\":\"diffuse\",\"albedo\":1,\"specular\":0"), PATHS);
}

#define GLSL(majorant)                                                                                                 \
    "{\"density\":{\"kind\":\"glsl\",\"source\":\"float density(vec3 p, float t) { return 1.0; }\",\"bounds\":{"       \
    "\"kind\":\"sphere\",\"radius\":1}" majorant "},\"sigma_s\":1}"

static void random_paths_need_a_majorant(void **state)
{
    static const char message[] = "scene.media[0].density.majorant: expected an upper bound of density(), which random "
                                  "paths need, got nothing";

    assert_refused(LAMP, MEDIA(GLSL("")), PATHS, message);
    assert_refused(LAMP, TWO MEDIA(GLSL("")), PATHS, message);
    assert_refused(LAMP, TWO MEDIA(GLSL("")), GRID("midpoint"), message);
    assert_refused(LAMP, TWO MEDIA(GLSL("")), "{\"tolerance\":0.1}", message);
    assert_taken(LAMP, TWO MEDIA(GLSL(",\"majorant\":1")), PATHS);
    assert_taken(LAMP, MEDIA(GLSL("")), "{\"tolerance\":0.1}");
}

#define OPEN(coefficients) "{\"density\":{\"kind\":\"homogeneous\"}," coefficients "}"
#define OPEN_NOISE "{\"density\":{\"kind\":\"noise\",\"frequency\":1},\"sigma_s\":1}"

static void light_that_never_ends_is_refused(void **state)
{
    static const char message[] =
        "scene.media[0].density: expected bounds, or a sigma_a of at least 0.0001 times sigma_s: where hardly anything "
        "absorbs light and nothing ends, it scatters without end";
    static const char glow[] =
        "scene.media[0].density: expected bounds, or a sigma_a above 0: light that a medium without end emits and does "
        "not absorb has no limit";

    assert_refused(LAMP, ALL MEDIA(OPEN("\"sigma_s\":1")), PATHS, message);
    assert_refused(LAMP, TWO MEDIA(OPEN_NOISE), PATHS, message);
    assert_refused(LAMP, ALL MEDIA(OPEN("\"sigma_s\":1,\"sigma_a\":[0.1,0,0.1]")), PATHS, message);
    assert_refused(LAMP, ALL MEDIA(OPEN("\"sigma_s\":1,\"sigma_a\":{\"keys\":[[0,1],[5,0]]}")), PATHS, message);
    assert_refused(LAMP, ALL MEDIA(OPEN("\"sigma_s\":1,\"sigma_a\":1e-9")), PATHS, message);
    assert_refused(LAMP, ALL MEDIA(OPEN("\"sigma_s\":[1,1,200],\"sigma_a\":0.01")), PATHS, message);
    assert_refused(LAMP, ALL MEDIA(OPEN("\"emission\":1")), PATHS, glow);
    assert_refused(LAMP, MEDIA(OPEN("\"emission\":1,\"sigma_a\":[1,0,1]")), PATHS, glow);
    assert_taken(LAMP, MEDIA(OPEN("\"emission\":1,\"sigma_a\":1")), PATHS);
    assert_taken(LAMP, MEDIA(OPEN("\"emission\":0")), PATHS);
    assert_taken(LAMP, ALL MEDIA(OPEN("\"sigma_s\":1,\"sigma_a\":0.01")), PATHS);
    assert_taken(LAMP, ALL MEDIA(OPEN("\"sigma_a\":1")), PATHS);
    assert_taken(LAMP, MEDIA(OPEN("\"sigma_s\":1")), PATHS);
    assert_taken(LAMP, ALL MEDIA(BALL("\"sigma_s\":1")), PATHS);
}

static void marches_go_to_no_light_of_many_directions(void **state)
{
    static const char ball[] = MEDIA("{\"density\":{\"kind\":\"noise\",\"frequency\":2,\"bounds\":{\"kind\":"
                                     "\"sphere\",\"radius\":1}},\"sigma_s\":1}");
    static const char quality[] = "{\"method\":\"midpoint\",\"step\":0.1,\"scatter_grid\":8}";
    static const char nodes[] =
        "lights[0].kind: not rendered yet by this method: only paths, or a scatter_grid from the "
        "lights, show it";
    static const char glowing[] = TWO MEDIA("{\"density\":{\"kind\":\"noise\",\"frequency\":2,\"bounds\":{\"kind\":"
                                            "\"sphere\",\"radius\":1}},\"sigma_s\":1,\"emission\":1}");
    static const char dark[] = TWO MEDIA("{\"density\":{\"kind\":\"noise\",\"frequency\":2,\"bounds\":{\"kind\":"
                                         "\"sphere\",\"radius\":1}},\"sigma_s\":1,\"emission\":0}");
    char *scene = xasprintf("%s%s", TWO, ball);

    assert_taken(DOME, scene, quality);
    assert_taken(SPHERE, scene, quality);
    assert_refused(SPHERE, scene,
                   "{\"method\":\"midpoint\",\"step\":0.1,\"scatter_grid\":8,\"scatter_from\":\"nodes\"}", nodes);
    assert_refused(SPHERE, glowing, quality, nodes);
    assert_taken(SPHERE, dark, quality);
    assert_refused(
        LAMP, glowing,
        "{\"method\":\"cached\",\"step\":0.1,\"light_grid\":8,\"scatter_grid\":8,\"scatter_from\":\"lights\"}",
        "quality.scatter_from: not where media emit, whose light comes from the nodes alone");
    assert_refused(DOME ",{\"kind\":\"sun\",\"intensity\":1,\"direction\":[1,0,0]}", scene, quality,
                   "quality.light_step: expected a number of metres, as light marches through media, got nothing");
    free(scene);
}

// A scattering in similar media stands for several: they cannot be counted.
static void similar_media_are_for_all_orders(void **state)
{
    static const char ball[] = MEDIA("{\"density\":{\"kind\":\"noise\",\"frequency\":2,\"bounds\":{\"kind\":"
                                     "\"sphere\",\"radius\":1}},\"sigma_s\":1}");
    static const char quality[] = "{\"method\":\"midpoint\",\"step\":0.1,\"scatter_grid\":8,\"similar_after\":2}";
    char *two = xasprintf("%s%s", TWO, ball), *all = xasprintf("\"scattering\":{\"orders\":\"all\"},%s", ball);

    assert_refused(
        DOME, two, quality,
        "quality.similar_after: only where scene.scattering.orders is \"all\": a scattering in similar media "
        "is several");
    assert_taken(DOME, all, quality);
    free(all);
    free(two);
}

// The grid is a box around what scatters, which has to end.
static void a_grid_is_around_media_that_end(void **state)
{
    static const char slab[] = MEDIA("{\"density\":{\"kind\":\"noise\",\"frequency\":2,\"bounds\":{\"kind\":"
                                     "\"slab\",\"thickness\":1}},\"sigma_s\":1,\"sigma_a\":1}");
    char *scene = xasprintf("%s%s", TWO, slab);

    assert_refused(DOME, scene, "{\"method\":\"midpoint\",\"step\":0.1,\"scatter_grid\":8}",
                   "scene.media[0].density: expected bounds of a sphere or a box: a scatter_grid is a box around what "
                   "scatters");
    assert_taken(DOME, scene, "{\"method\":\"paths\",\"paths\":8}");
    free(scene);
}

static void a_spots_cones_are_one_in_the_other(void **state)
{
    char *text = json_edit_set(job_text_paths, "lights[0].inner", "30"), *wide;

    assert_taken_text(text); // as wide at the first moment, and narrower later
    wide = json_edit_set(text, "lights[0].outer", "{\"keys\":[[0,40],[0.25,20]]}");
    job_expect_refused(wide, "lights[0].inner: expected at most outer, 24 degrees, got 30 at frame 5");
    free(wide);
    job_expect_edit_refused(text, "lights[0].outer", "20",
                            "lights[0].inner: expected at most outer, 20 degrees, got 30 at frame 1");
    free(text);
}

static void a_domes_axis_has_a_length_at_all_times(void **state)
{
    static const char crossing[] = "{\"start\":[-0.2,0,0],\"rate\":[1,0,0]}";
    char *axis = xasprintf("{\"along\":1,\"against\":2,\"axis\":%s}", crossing);
    char *dome = xasprintf("{\"kind\":\"dome\",\"gradient\":%s}", axis);

    job_expect_edit_refused(job_text_paths, "lights[2].rotate.axis", crossing,
                            "lights[2].rotate.axis: expected a vector whose length is not 0, got one of 0 at frame 5");
    job_expect_edit_refused(
        job_text_paths, "lights[2]", dome,
        "lights[2].gradient.axis: expected a vector whose length is not 0, got one of 0 at frame 5");
    free(dome);
    free(axis);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_goes_together_is_taken),
        cmocka_unit_test(a_scene_has_one_dome),
        cmocka_unit_test(a_visible_dome_takes_the_place_of_a_background),
        cmocka_unit_test(light_of_many_directions_needs_random_paths),
        cmocka_unit_test(methods_that_show_one_order_say_so),
        cmocka_unit_test(a_march_of_several_orders_needs_a_scatter_grid),
        cmocka_unit_test(a_scatter_grid_needs_several_orders),
        cmocka_unit_test(random_paths_end_at_mirrors_and_glass),
        cmocka_unit_test(random_paths_need_a_majorant),
        cmocka_unit_test(light_that_never_ends_is_refused),
        cmocka_unit_test(marches_go_to_no_light_of_many_directions),
        cmocka_unit_test(similar_media_are_for_all_orders),
        cmocka_unit_test(a_grid_is_around_media_that_end),
        cmocka_unit_test(a_spots_cones_are_one_in_the_other),
        cmocka_unit_test(a_domes_axis_has_a_length_at_all_times),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
