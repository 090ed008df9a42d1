// SPDX-License-Identifier: Apache-2.0
#include "core/scene/light_rules.h"

#include "core/base/error.h"
#include "core/scene/scene_json.h"
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

#define SPOT "lights[0]"
#define SPHERE "lights[1]"
#define DOME "lights[2]"

static const struct scene_times TIMES = {{0.0, 10.0}, 0.04};
static const char gradient[] = "{\"kind\":\"dome\",\"gradient\":{\"along\":[1,2,3],\"against\":0.5,\"axis\":[1,0,0]}}";
static const char even[] = "{\"kind\":\"dome\",\"radiance\":{\"start\":1,\"rate\":0.5}}";

static bool read_scene(struct scene *scene, const char *text, struct error *error)
{
    struct cJSON *root = NULL;
    struct json_node document;
    bool ok;

    if (!json_parse(&root, text, strlen(text), error)) fail_msg("%s: %s", error->message, text);
    document = json_node_root(root);
    ok = scene_from_json(scene, &document, &TIMES, error);
    json_delete(root);
    return ok;
}

// The scene of job_text_paths with `value` at `path`; NULL: as it is.
static struct scene scene_with(const char *path, const char *value)
{
    char *text = path ? json_edit_set(job_text_paths, path, value) : strdup(job_text_paths);
    struct error error = {0};
    struct scene scene;

    if (!read_scene(&scene, text, &error)) fail_msg("%s", error.message);
    free(text);
    return scene;
}

static void assert_refused(const char *path, const char *value, const char *expected)
{
    char *text = json_edit_set(job_text_paths, path, value);
    struct error error = {0};
    struct scene scene;

    if (read_scene(&scene, text, &error)) fail_msg("%s = %s is taken", path, value ? value : "nothing");
    assert_string_equal(error.message, expected);
    scene_finish(&scene);
    free(text);
}

static void assert_at(const struct timeline *timeline, double time, double x, double y, double z)
{
    double value[3] = {0};

    timeline_evaluate(timeline, time, value);
    assert_true(value[0] == x && (timeline->component_count == 1 || (value[1] == y && value[2] == z)));
}

static void spot_has_a_cone(void **state)
{
    struct scene scene = scene_with(NULL, NULL);
    const struct scene_light *spot = &scene.lights[0];

    assert_int_equal(spot->kind, SCENE_LIGHT_SPOT);
    assert_at(&spot->intensity, 0.0, 1.0, 2.0, 3.0);
    assert_at(&spot->direction, 0.0, 0.0, -2.0, 0.0);
    assert_at(&spot->inner, 1.0, 11.0, 0.0, 0.0);
    assert_at(&spot->outer, 1.0, 40.0, 0.0, 0.0);
    assert_int_equal(spot->position.kind, TIMELINE_ORBIT);
    scene_finish(&scene);
}

static void sphere_has_a_radius(void **state)
{
    struct scene scene = scene_with(NULL, NULL);

    assert_int_equal(scene.lights[1].kind, SCENE_LIGHT_SPHERE);
    assert_at(&scene.lights[1].intensity, 0.0, 4.0, 0.0, 0.0);
    assert_at(&scene.lights[1].radius, 2.0, 0.5, 0.0, 0.0);
    scene_finish(&scene);
}

static void dome_shows_an_image_that_is_scaled_and_turned(void **state)
{
    struct scene scene = scene_with(NULL, NULL);
    const struct scene_dome *dome = &scene.lights[2].dome;

    assert_int_equal(scene.lights[2].kind, SCENE_LIGHT_DOME);
    assert_int_equal(dome->kind, SCENE_DOME_FILE);
    assert_string_equal(dome->image.file, "/data/noon.exr");
    assert_true(dome->image.is_linear && dome->image.is_radiance && !dome->image.is_nearest && dome->is_visible);
    assert_at(&scene.lights[2].intensity, 0.0, 1.0, 0.5, 0.25);
    assert_at(&dome->axis, 0.0, 0.0, 1.0, 0.5);
    assert_at(&dome->angle, 2.0, 40.0, 0.0, 0.0);
    scene_finish(&scene);
    scene = scene_with(DOME, "{\"kind\":\"dome\",\"file\":\"a.EXR\"}");
    assert_at(&scene.lights[2].intensity, 0.0, 1.0, 0.0, 0.0);
    assert_at(&scene.lights[2].dome.axis, 0.0, 0.0, 1.0, 0.0);
    assert_at(&scene.lights[2].dome.angle, 0.0, 0.0, 0.0, 0.0);
    assert_false(scene.lights[2].dome.is_visible);
    scene_finish(&scene);
}

static void dome_is_even_or_has_a_gradient(void **state)
{
    struct scene scene = scene_with(DOME, even);

    assert_int_equal(scene.lights[2].dome.kind, SCENE_DOME_RADIANCE);
    assert_at(&scene.lights[2].intensity, 2.0, 2.0, 0.0, 0.0);
    assert_null(scene.lights[2].dome.image.file);
    scene_finish(&scene);
    scene = scene_with(DOME, gradient);
    assert_int_equal(scene.lights[2].dome.kind, SCENE_DOME_GRADIENT);
    assert_at(&scene.lights[2].intensity, 0.0, 1.0, 2.0, 3.0);
    assert_at(&scene.lights[2].dome.opposite, 0.0, 0.5, 0.0, 0.0);
    assert_at(&scene.lights[2].dome.axis, 0.0, 1.0, 0.0, 0.0);
    scene_finish(&scene);
    scene = scene_with(DOME, "{\"kind\":\"dome\",\"gradient\":{\"along\":1,\"against\":0}}");
    assert_at(&scene.lights[2].dome.axis, 0.0, 0.0, 1.0, 0.0);
    scene_finish(&scene);
}

static void orders_are_a_number_or_all(void **state)
{
    struct scene scene = scene_with(NULL, NULL);

    assert_int_equal(scene.orders, 8);
    scene_finish(&scene);
    scene = scene_with("scene.scattering.orders", "\"all\"");
    assert_int_equal(scene.orders, SCENE_ORDERS_ALL);
    scene_finish(&scene);
    scene = scene_with("scene.scattering.orders", "1000");
    assert_int_equal(scene.orders, 1000);
    scene_finish(&scene);
    scene = scene_with("scene.scattering", NULL);
    assert_int_equal(scene.orders, 1);
    scene_finish(&scene);
}

static void wrong_orders_are_refused_by_place(void **state)
{
    static const char place[] = "scene.scattering.orders", range[] = "expected an integer from 1 to 1000, got ";
    char message[128];

    snprintf(message, sizeof message, "%s: %s0", place, range);
    assert_refused(place, "0", message);
    snprintf(message, sizeof message, "%s: %s1001", place, range);
    assert_refused(place, "1001", message);
    snprintf(message, sizeof message, "%s: %s1.5", place, range);
    assert_refused(place, "1.5", message);
    snprintf(message, sizeof message, "%s: %snothing", place, range);
    assert_refused(place, NULL, message);
    assert_refused(place, "\"every\"",
                   "scene.scattering.orders: expected an integer from 1 to 1000 or \"all\", got \"every\"");
    assert_refused("scene.scattering", "8", "scene.scattering: expected an object, got 8");
    assert_refused("scene.scattering.order", "8", "scene.scattering: unknown key \"order\", did you mean \"orders\"?");
}

static void wrong_lights_are_refused_by_place(void **state)
{
    static const struct {
        const char *path, *value, *message;
    } cases[] = {
        {SPOT ".inner", NULL, SPOT ".inner: expected a number in [0, 90], got nothing"},
        {SPOT ".outer", NULL, SPOT ".outer: expected a number in (0, 90], got nothing"},
        {SPOT ".outer", "0", SPOT ".outer: expected a number in (0, 90], got 0"},
        {SPOT ".outer", "90.5", SPOT ".outer: expected a number in (0, 90], got 90.5"},
        {SPOT ".inner", "-1", SPOT ".inner: expected a number in [0, 90], got -1"},
        {SPOT ".direction", "[0,0,0]", SPOT ".direction: expected a vector whose length is not 0, got one of 0"},
        {SPOT ".direction", NULL,
         SPOT ".direction: expected three numbers [x, y, z] in [-1000000000, 1000000000], got nothing"},
        {SPOT ".position", NULL,
         SPOT ".position: expected three numbers [x, y, z] in [-1000000000, 1000000000], got nothing"},
        {SPOT ".intensity", "-1", SPOT ".intensity: expected a number in [0, 1e+15], got -1"},
        {SPOT ".radius", "1",
         SPOT
         ": unknown key \"radius\" beside kind \"spot\"; known: kind, intensity, position, direction, inner, outer"},
        {SPHERE ".radius", "0", SPHERE ".radius: expected a number in (0, 1000000000], got 0"},
        {SPHERE ".radius", NULL, SPHERE ".radius: expected a number in (0, 1000000000], got nothing"},
        {SPHERE ".direction", "[0,1,0]",
         SPHERE ": unknown key \"direction\" beside kind \"sphere\"; known: kind, intensity, position, radius"},
        {DOME ".file", "\"a.png\"", DOME ".file: expected a name that ends in .exr, got \"a.png\""},
        {DOME ".file", "\"a.#.exr\"", DOME ".file: expected one file, not one a frame"},
        {DOME ".file", "3", DOME ".file: expected a string, got 3"},
        {DOME ".radiance", "1", DOME ": expected one of radiance, gradient and file, got two"},
        {DOME ".visible", "1", DOME ".visible: expected true or false, got 1"},
        {DOME ".scale", "-1", DOME ".scale: expected a number in [0, 1e+15], got -1"},
        {DOME ".rotate.angle", NULL, DOME ".rotate.angle: expected a number in [-1000000000, 1000000000], got nothing"},
        {DOME ".rotate.angel", "1", DOME ".rotate: unknown key \"angel\", did you mean \"angle\"?"},
        {DOME ".rotate", "90", DOME ".rotate: expected an object, got 90"},
        {DOME ".file", NULL, DOME ": expected one of radiance, gradient and file, got none"},
        {DOME, "{\"kind\":\"dome\"}", DOME ": expected one of radiance, gradient and file, got none"},
        {DOME, "{\"kind\":\"dome\",\"radiance\":1,\"scale\":2}",
         DOME ": unknown key \"scale\" beside kind \"dome\"; known: kind, radiance, visible"},
        {DOME, "{\"kind\":\"dome\",\"gradient\":1}", DOME ".gradient: expected an object, got 1"},
        {DOME, "{\"kind\":\"dome\",\"gradient\":{\"along\":1}}",
         DOME ".gradient.against: expected a number or [r, g, b] in [0, 1e+15], got nothing"},
    };

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        assert_refused(cases[i].path, cases[i].value, cases[i].message);
}

static void file_of_a_dome_is_absolute_for_a_daemon(void **state)
{
    char *text = json_edit_set(job_text_paths, DOME ".file", "\"noon.exr\"");

    job_expect_no_inputs(job_text_paths, NULL);
    job_expect_no_inputs(text, DOME ".file: expected an absolute path, got \"noon.exr\"");
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spot_has_a_cone),
        cmocka_unit_test(sphere_has_a_radius),
        cmocka_unit_test(dome_shows_an_image_that_is_scaled_and_turned),
        cmocka_unit_test(dome_is_even_or_has_a_gradient),
        cmocka_unit_test(orders_are_a_number_or_all),
        cmocka_unit_test(wrong_orders_are_refused_by_place),
        cmocka_unit_test(wrong_lights_are_refused_by_place),
        cmocka_unit_test(file_of_a_dome_is_absolute_for_a_daemon),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
