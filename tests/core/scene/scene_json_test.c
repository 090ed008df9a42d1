// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene_json.h"

#include "core/base/error.h"
#include "core/scene/scene.h"
#include "tests/support/job_text.h"
#include "tests/support/json_edit.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const struct scene_times TIMES = {{0.0, 10.0}, 0.04};

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

static struct scene scene_of(const char *text)
{
    struct scene scene;
    struct error error = {0};

    if (!read_scene(&scene, text, &error)) fail_msg("%s", error.message);
    return scene;
}

static void assert_refused(const char *document, const char *path, const char *value, const char *expected)
{
    char *text = json_edit_set(document, path, value);
    struct scene scene;
    struct error error = {0};

    if (read_scene(&scene, text, &error)) fail_msg("%s = %s is taken", path, value);
    assert_string_equal(error.message, expected);
    scene_finish(&scene);
    free(text);
}

static void assert_edit_refused(const char *path, const char *value, const char *expected)
{
    assert_refused(job_text_full, path, value, expected);
}

static void assert_noise_refused(const char *path, const char *value, const char *expected)
{
    assert_refused(job_text_noise, path, value, expected);
}

static void assert_vector(const double value[3], double x, double y, double z)
{
    assert_true(value[0] == x && value[1] == y && value[2] == z);
}

static void camera_is_read(void **state)
{
    struct scene scene = scene_of(job_text_full);
    const struct scene_camera *camera = &scene.camera;

    assert_int_equal(camera->position.kind, TIMELINE_ORBIT);
    assert_true(camera->position.orbit.radius == 3.0 && camera->position.orbit.height == 1.0);
    assert_true(camera->position.orbit.period == 10.0 && fabs(camera->position.orbit.phase_rad - M_PI / 4.0) < 1e-15);
    assert_vector(camera->position.orbit.axis, 0.0, 1.0, 0.0);
    assert_int_equal(camera->target.kind, TIMELINE_KEYS);
    assert_int_equal(camera->target.keys.interpolation, TIMELINE_INTERPOLATE_SMOOTH);
    assert_int_equal(camera->target.keys.count, 2);
    assert_true(camera->target.keys.keys[1].time == 1.0);
    assert_vector(camera->target.keys.keys[1].value, 0.5, 0.0, 0.0);
    assert_vector(camera->up.value, 0.5, 1.0, 0.0);
    assert_int_equal(camera->fov.kind, TIMELINE_LINEAR);
    assert_true(camera->fov.linear.start[0] == 40.0 && camera->fov.linear.rate[0] == 0.5);
    assert_true(camera->clip_near == 1.0 && camera->clip_far == 5.0 && camera->mirror);
    scene_finish(&scene);
}

static void camera_has_defaults(void **state)
{
    struct scene scene = scene_of("{\"camera\":{\"position\":{\"orbit\":{\"radius\":1,\"period\":-2}},"
                                  "\"target\":[0,0,0],\"fov\":50}}");

    assert_vector(scene.camera.up.value, 0.0, 1.0, 0.0);
    assert_int_equal(scene.camera.up.component_count, 3);
    assert_vector(scene.camera.position.orbit.axis, 0.0, 1.0, 0.0);
    assert_vector(scene.camera.position.orbit.center, 0.0, 0.0, 0.0);
    assert_true(scene.camera.clip_near == 0.0 && isinf(scene.camera.clip_far) && !scene.camera.mirror);
    assert_false(scene_is_constant(&scene));
    scene_finish(&scene);
}

static void lights_are_read(void **state)
{
    struct scene scene = scene_of(job_text_full);

    assert_int_equal(scene.light_count, 3);
    assert_int_equal(scene.lights[0].kind, SCENE_LIGHT_POINT);
    assert_int_equal(scene.lights[0].falloff, SCENE_FALLOFF_INVERSE_SQUARE);
    assert_int_equal(scene.lights[0].intensity.component_count, 3);
    assert_vector(scene.lights[0].intensity.value, 10.0, 20.0, 30.0);
    assert_int_equal(scene.lights[1].kind, SCENE_LIGHT_SUN);
    assert_int_equal(scene.lights[1].intensity.component_count, 1);
    assert_true(scene.lights[1].intensity.lissajous.speed == 2.0);
    assert_int_equal(scene.lights[1].direction.keys.interpolation, TIMELINE_INTERPOLATE_HOLD);
    assert_int_equal(scene.lights[2].intensity.component_count, 3);
    assert_int_equal(scene.lights[2].intensity.keys.interpolation, TIMELINE_INTERPOLATE_LINEAR);
    assert_true(scene.has_background && scene.background.lissajous.speed == 1.0);
    assert_vector(scene.background.lissajous.phase_rad, 0.0, 0.0, 0.0);
    scene_finish(&scene);
}

static void falloff_none_is_read(void **state)
{
    char *text = json_edit_set(job_text_full, "lights[0].falloff", "\"none\"");
    struct scene scene = scene_of(text);

    assert_int_equal(scene.lights[0].falloff, SCENE_FALLOFF_NONE);
    scene_finish(&scene);
    free(text);
}

static void media_are_read(void **state)
{
    struct scene scene = scene_of(job_text_full);
    const struct scene_medium *medium = &scene.media[0];
    const struct scene_fold_fractal *fold_fractal = &medium->density.fold_fractal;

    assert_int_equal(scene.medium_count, 2);
    assert_int_equal(fold_fractal->iterations, 3);
    assert_true(fold_fractal->offset.value[0] == 0.05 && fold_fractal->exponent.value[0] == 1.5);
    assert_int_equal(fold_fractal->radius.kind, TIMELINE_KEYS);
    assert_true(fold_fractal->rotate_x_rad.value[0] == 0.3);
    assert_int_equal(fold_fractal->rotate_y_rad.kind, TIMELINE_LISSAJOUS);
    assert_true(fold_fractal->scale.linear.rate[0] == 1.0);
    assert_vector(medium->sigma_s.value, 1.0, 2.0, 3.0);
    assert_vector(medium->sigma_a.linear.rate, 0.0, 0.0, 0.1);
    assert_true(medium->has_emission && medium->emission.value[0] == 0.5);
    assert_int_equal(medium->lobe_count, 2);
    assert_true(medium->lobes[1].g.value[0] == -0.5 && medium->lobes[1].weight.value[0] == 0.75);
    assert_false(scene.media[1].has_emission);
    assert_int_equal(scene.media[1].sigma_s.component_count, 1);
    assert_true(scene.media[1].sigma_s.value[0] == 0.0 && scene.media[1].lobes[0].weight.value[0] == 1.0);
    scene_finish(&scene);
}

static void lissajous_stays_within_the_range_of_what_it_drives(void **state)
{
    assert_edit_refused("scene.media[0].phase[0].g",
                        "{\"lissajous\":{\"center\":0.5,\"amplitude\":-0.5,\"frequency_rad\":0}}",
                        "scene.media[0].phase[0].g: expected to stay in [-0.99999, 0.99999], got 0 to 1");
    assert_edit_refused("scene.media[0].sigma_s",
                        "{\"lissajous\":{\"center\":[2,2,1],\"amplitude\":[1,1,1.5],\"frequency_rad\":[1,1,1]}}",
                        "scene.media[0].sigma_s: expected to stay in [0, 1000000000], got -0.5 to 2.5");
}

static void linear_stays_within_the_range_over_the_frames(void **state)
{
    char *text = json_edit_set(job_text_full, "camera.fov", "{\"start\":10,\"rate\":16.9}");
    struct scene scene = scene_of(text);

    scene_finish(&scene);
    free(text);
    assert_edit_refused("camera.fov", "{\"start\":10,\"rate\":17}",
                        "camera.fov: expected to stay in (0, 180), got 10 to 180");
}

static void orbits_drive_positions_only(void **state)
{
    assert_edit_refused("camera.up", "{\"orbit\":{\"radius\":1,\"period\":1}}",
                        "camera.up: an orbit drives positions only");
    assert_edit_refused("scene.media[0].sigma_s", "{\"orbit\":{\"radius\":1,\"period\":1}}",
                        "scene.media[0].sigma_s: an orbit drives positions only");
}

static void wrong_timelines_are_refused_by_place(void **state)
{
    assert_edit_refused("camera.fov", "\"wide\"", "camera.fov: expected a number in (0, 180), got \"wide\"");
    assert_edit_refused(
        "camera.target", "[1,2]",
        "camera.target: expected three numbers [x, y, z] in [-1000000000, 1000000000], got an array of 2");
    assert_edit_refused("lights[0].intensity", "[1,-2,3]",
                        "lights[0].intensity[1]: expected a number in [0, 1e+15], got -2");
    assert_edit_refused("lights[0].intensity", "true",
                        "lights[0].intensity: expected a number or [r, g, b] in [0, 1e+15], got true");
    assert_edit_refused("camera.target.keys", "[[0,[0,0,0]],[0,[1,0,0]]]",
                        "camera.target.keys[1][0]: expected a time after that of the key before it (0), got 0");
    assert_edit_refused("camera.target.keys", "[[0]]",
                        "camera.target.keys[0]: expected [time, value], got an array of 1");
    assert_edit_refused("camera.target.keys", "[]",
                        "camera.target.keys: expected an array of 1 to 10000, got an array of 0");
    assert_edit_refused(
        "camera.target.interpolation", "\"smoth\"",
        "camera.target.interpolation: expected one of \"linear\",\"smooth\",\"hold\", got \"smoth\", did "
        "you mean \"smooth\"?");
    assert_edit_refused("camera.position.orbit.period", "0",
                        "camera.position.orbit.period: expected a number of seconds that is not 0, got 0");
    assert_edit_refused("camera.position.orbit.axis", "[0,0,0]",
                        "camera.position.orbit.axis: expected a vector whose length is not 0, got one of 0");
    assert_edit_refused("camera.fov", "{}",
                        "camera.fov: expected start and rate, lissajous, keys or orbit, got an object");
    assert_edit_refused(
        "lights[1].intensity.lissajous.amplitude", "[1,1,1]",
        "lights[1].intensity.lissajous.amplitude: expected a number in [-1e+15, 1e+15], got an array of "
        "3");
}

static void wrong_media_are_refused_by_place(void **state)
{
    assert_edit_refused("scene.media[1].sigma_a", NULL,
                        "scene.media[1]: expected sigma_s, sigma_a, emission or blackbody, got none of them");
    assert_edit_refused("scene.media[0].density.kind", "\"fold_factal\"",
                        "scene.media[0].density.kind: expected one of "
                        "\"fold_fractal\",\"homogeneous\",\"noise\",\"grid\",\"glsl\", got "
                        "\"fold_factal\", did you mean \"fold_fractal\"?");
    assert_edit_refused("scene.media[0].density.exponent", "0",
                        "scene.media[0].density.exponent: expected a number in (0, 100], got 0");
    assert_edit_refused("scene.media[0].density.iterations", "2.5",
                        "scene.media[0].density.iterations: expected an integer from 1 to 32, got 2.5");
    assert_edit_refused("scene.media[0].phase", "[]",
                        "scene.media[0].phase: expected an array of 1 to 8, got an array of 0");
    // Rounded to float this is 1, where the phase function is 0 almost everywhere.
    assert_edit_refused("scene.media[0].phase[0].g", "0.99999999",
                        "scene.media[0].phase[0].g: expected a number in [-0.99999, 0.99999], got 0.99999999");
}

static void noise_and_bounds_are_read(void **state)
{
    struct scene scene = scene_of(job_text_noise);
    const struct scene_noise *noise = &scene.media[0].density.noise;
    const struct scene_bounds *sphere = &scene.media[0].density.bounds, *box = &scene.media[1].density.bounds;

    assert_int_equal(scene.media[0].density.kind, SCENE_DENSITY_NOISE);
    assert_int_equal(noise->octaves, 5);
    assert_int_equal(noise->mode, SCENE_NOISE_CLIP);
    assert_true(noise->frequency.value[0] == 3.0 && noise->lacunarity.value[0] == 2.5);
    assert_true(noise->hurst.value[0] == 0.75 && noise->bias.value[0] == -0.25 && noise->scale.value[0] == 6.0);
    assert_vector(noise->offset.linear.rate, 0.0, 0.0, 0.5);
    assert_vector(noise->axis.value, 1.0, 1.0, 0.0);
    assert_true(noise->angle.linear.start[0] == -3.0);
    assert_int_equal(sphere->kind, SCENE_BOUNDS_SPHERE);
    assert_int_equal(sphere->center.kind, TIMELINE_ORBIT);
    assert_true(sphere->radius.value[0] == 1.5 && sphere->falloff.value[0] == 0.25);
    assert_int_equal(box->kind, SCENE_BOUNDS_BOX);
    assert_vector(box->size.value, 1.0, 2.0, 3.0);
    assert_vector(box->center.value, 1.0, 0.0, 0.0);
    scene_finish(&scene);
}

static void noise_has_defaults(void **state)
{
    struct scene scene = scene_of(job_text_noise);
    const struct scene_noise *noise = &scene.media[1].density.noise;

    assert_int_equal(noise->octaves, 1);
    assert_int_equal(noise->mode, SCENE_NOISE_ABSOLUTE);
    assert_true(noise->lacunarity.value[0] == 2.0 && noise->hurst.value[0] == 1.0 && noise->bias.value[0] == 0.0);
    assert_true(noise->scale.value[0] == 1.0 && noise->angle.value[0] == 0.0);
    assert_vector(noise->offset.value, 0.0, 0.0, 0.0);
    assert_int_equal(noise->offset.component_count, 3);
    assert_vector(noise->axis.value, 0.0, 1.0, 0.0);
    scene_finish(&scene);
}

static void homogeneous_media_are_read(void **state)
{
    struct scene scene = scene_of(job_text_fog);
    const struct scene_density *slab = &scene.media[0].density, *everywhere = &scene.media[1].density;

    assert_int_equal(slab->kind, SCENE_DENSITY_HOMOGENEOUS);
    assert_int_equal(slab->homogeneous.scale.kind, TIMELINE_KEYS);
    assert_int_equal(slab->bounds.kind, SCENE_BOUNDS_SLAB);
    assert_vector(slab->bounds.normal.value, 0.5, 2.0, 0.0);
    assert_true(slab->bounds.thickness.value[0] == 2.0 && slab->bounds.falloff.value[0] == 0.0);
    assert_int_equal(everywhere->bounds.kind, SCENE_BOUNDS_NONE);
    assert_true(everywhere->homogeneous.scale.value[0] == 1.0);
    assert_int_equal(scene.media[0].lobes[0].kind, SCENE_LOBE_RAYLEIGH);
    assert_int_equal(scene.media[0].lobes[0].g.component_count, 1);
    scene_finish(&scene);
}

// Values are checked until the shutter closes: 10 s, and 0.04 s for each frame of shutter.
static void values_stay_in_range_while_the_shutter_is_open(void **state)
{
    char *text = json_edit_set(job_text_full, "camera.fov", "{\"start\":10,\"rate\":16.9}"), *open;
    struct scene scene = scene_of(text);
    struct error error = {0};

    assert_true(scene.camera.shutter == 0.0);
    scene_finish(&scene);
    open = json_edit_set(text, "camera.shutter", "2");
    assert_false(read_scene(&scene, open, &error));
    assert_string_equal(error.message, "camera.fov: expected to stay in (0, 180), got 10 to 180.352");
    scene_finish(&scene);
    free(open);
    free(text);
}

static void homogeneous_without_falloff_is_even(void **state)
{
    char *text = json_edit_set(job_text_fog, "scene.media[0].density.bounds.falloff", "1e-6");
    struct scene even = scene_of(job_text_fog), soft = scene_of(text), noise = scene_of(job_text_noise);

    assert_true(scene_density_is_even(&even.media[0].density));
    assert_true(scene_density_is_even(&even.media[1].density));
    assert_false(scene_density_is_even(&soft.media[0].density));
    assert_false(scene_density_is_even(&noise.media[1].density));
    scene_finish(&even);
    scene_finish(&soft);
    scene_finish(&noise);
    free(text);
}

static void wrong_noise_and_bounds_are_refused_by_place(void **state)
{
    assert_noise_refused("scene.media[0].density.frequency", "0",
                         "scene.media[0].density.frequency: expected a number in (0, 1000000000], got 0");
    assert_noise_refused("scene.media[0].density.bias", "1",
                         "scene.media[0].density.bias: expected a number in [-0.999, 0.999], got 1");
    assert_noise_refused("scene.media[0].density.octaves", "17",
                         "scene.media[0].density.octaves: expected an integer from 1 to 16, got 17");
    assert_noise_refused("scene.media[0].density.rotate", "{\"axis\":[0,1,0]}",
                         "scene.media[0].density.rotate.angle: expected a number in [-1000000000, 1000000000], "
                         "got nothing");
    assert_noise_refused("scene.media[0].density.bounds.radius", "0",
                         "scene.media[0].density.bounds.radius: expected a number in (0, 1000000000], got 0");
    assert_noise_refused("scene.media[1].density.bounds.size", "[1,-1,1]",
                         "scene.media[1].density.bounds.size[1]: expected a number in (0, 1000000000], got -1");
    assert_noise_refused("scene.media[1].density.bounds.radius", "1",
                         "scene.media[1].density.bounds: unknown key \"radius\" beside kind \"box\"; known: kind, "
                         "center, size, falloff");
    assert_noise_refused("scene.media[0].density.bounds.kind", "\"cone\"",
                         "scene.media[0].density.bounds.kind: expected one of \"sphere\",\"box\",\"slab\", got "
                         "\"cone\"");
    assert_noise_refused("scene.media[0].phase[0].g", "0",
                         "scene.media[0].phase[0]: unknown key \"g\" beside kind \"rayleigh\"; known: kind, weight");
    assert_noise_refused("scene.media[0].density.iterations", "3",
                         "scene.media[0].density: unknown key \"iterations\" beside kind \"noise\"; known: kind, "
                         "bounds, frequency, octaves, lacunarity, H, bias, mode, offset, rotate, scale");
    assert_noise_refused("camera.shutter", "-1", "camera.shutter: expected a number from 0 to 1000, got -1");
}

static void a_still_scene_is_constant(void **state)
{
    char *text = job_text_load("cloud.json");
    char *still_light = json_edit_set(text, "lights[0].position", "[1,1,1]");
    char *still_x = json_edit_set(still_light, "scene.media[0].density.rotate_x_rad", "0");
    char *still = json_edit_set(still_x, "scene.media[0].density.rotate_y_rad", "0");
    struct scene moving = scene_of(still_x), constant = scene_of(still);

    assert_false(scene_is_constant(&moving));
    assert_true(scene_is_constant(&constant));
    scene_finish(&moving);
    scene_finish(&constant);
    free(still);
    free(still_x);
    free(still_light);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(camera_is_read),
        cmocka_unit_test(camera_has_defaults),
        cmocka_unit_test(lights_are_read),
        cmocka_unit_test(falloff_none_is_read),
        cmocka_unit_test(media_are_read),
        cmocka_unit_test(lissajous_stays_within_the_range_of_what_it_drives),
        cmocka_unit_test(linear_stays_within_the_range_over_the_frames),
        cmocka_unit_test(orbits_drive_positions_only),
        cmocka_unit_test(wrong_timelines_are_refused_by_place),
        cmocka_unit_test(wrong_media_are_refused_by_place),
        cmocka_unit_test(noise_and_bounds_are_read),
        cmocka_unit_test(noise_has_defaults),
        cmocka_unit_test(homogeneous_media_are_read),
        cmocka_unit_test(values_stay_in_range_while_the_shutter_is_open),
        cmocka_unit_test(homogeneous_without_falloff_is_even),
        cmocka_unit_test(wrong_noise_and_bounds_are_refused_by_place),
        cmocka_unit_test(a_still_scene_is_constant),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
