// SPDX-License-Identifier: Apache-2.0
#include "core/scene/object_json.h"

#include "core/base/file.h"
#include "core/job/job_json.h"
#include "tests/support/folders.h"
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

static void assert_edit_refused(const char *path, const char *value, const char *expected)
{
    job_expect_edit_refused(job_text_objects, path, value, expected);
}

static void assert_value(const struct timeline *timeline, double value)
{
    assert_int_equal(timeline->kind, TIMELINE_CONSTANT);
    assert_int_equal(timeline->component_count, 1);
    assert_true(timeline->value[0] == value);
}

static void assert_vector(const struct timeline *timeline, double x, double y, double z)
{
    assert_int_equal(timeline->kind, TIMELINE_CONSTANT);
    assert_int_equal(timeline->component_count, 3);
    assert_true(timeline->value[0] == x && timeline->value[1] == y && timeline->value[2] == z);
}

static void shapes_are_read(void **state)
{
    struct job job = job_expect(job_text_objects);
    const struct scene *scene = &job.scene;

    assert_int_equal(scene->object_count, 6);
    assert_int_equal(scene->shape_count, 8);
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(scene->objects[i].first_shape, i);
        assert_int_equal(scene->objects[i].shape_count, 1);
        assert_false(scene->objects[i].is_union);
    }
    assert_int_equal(scene->shapes[0].kind, SCENE_SHAPE_PLANE);
    assert_vector(&scene->shapes[0].center, 0.0, -1.0, 0.0);
    assert_vector(&scene->shapes[0].normal, 0.5, 2.0, 0.0);
    assert_int_equal(scene->shapes[1].kind, SCENE_SHAPE_SPHERE);
    assert_int_equal(scene->shapes[1].center.kind, TIMELINE_ORBIT);
    assert_int_equal(scene->shapes[1].radius.kind, TIMELINE_LINEAR);
    assert_int_equal(scene->shapes[2].kind, SCENE_SHAPE_BOX);
    assert_vector(&scene->shapes[2].center, 2.0, 0.0, 0.0);
    assert_vector(&scene->shapes[2].size, 1.0, 2.0, 3.0);
    assert_true(scene->objects[4].is_union);
    assert_int_equal(scene->objects[4].first_shape, 4);
    assert_int_equal(scene->objects[4].shape_count, 3);
    assert_int_equal(scene->shapes[4].kind, SCENE_SHAPE_SPHERE);
    assert_int_equal(scene->shapes[5].kind, SCENE_SHAPE_BOX);
    assert_int_equal(scene->shapes[6].kind, SCENE_SHAPE_PLANE);
    assert_vector(&scene->shapes[6].center, 0.0, -9.0, 0.0);
    assert_vector(&scene->shapes[6].normal, 0.0, 1.0, 0.0);
    assert_int_equal(scene->objects[5].first_shape, 7);
    job_finish(&job);
}

static void materials_are_read(void **state)
{
    struct job job = job_expect(job_text_objects);
    const struct scene_material *floor = &job.scene.objects[0].material, *glass = &job.scene.objects[1].material;
    const struct scene_material *mirror = &job.scene.objects[2].material, *chalk = &job.scene.objects[3].material;

    assert_int_equal(floor->kind, SCENE_MATERIAL_DIFFUSE);
    assert_vector(&floor->albedo, 0.5, 0.75, 1.0);
    assert_int_equal(floor->specular.kind, TIMELINE_KEYS);
    assert_int_equal(floor->fresnel, SCENE_FRESNEL_SCHLICK);
    assert_value(&floor->ior, 1.25);
    assert_value(&floor->f0, 0.125);
    assert_value(&floor->f90, 0.75);
    assert_true(floor->has_f0);
    assert_value(&floor->roughness, 0.25);
    assert_int_equal(glass->kind, SCENE_MATERIAL_DIELECTRIC);
    assert_int_equal(glass->ior.kind, TIMELINE_LINEAR);
    assert_int_equal(glass->fresnel, SCENE_FRESNEL_SCHLICK);
    assert_false(glass->has_f0);
    assert_value(&glass->f90, 0.5);
    assert_value(&glass->roughness, 0.125);
    assert_int_equal(mirror->kind, SCENE_MATERIAL_MIRROR);
    assert_vector(&mirror->reflectance, 1.0, 0.5, 0.25);
    assert_value(&mirror->roughness, 0.5);
    assert_int_equal(chalk->kind, SCENE_MATERIAL_DIFFUSE);
    assert_value(&chalk->albedo, 1.0);
    job_finish(&job);
}

static void absent_keys_of_materials_have_defaults(void **state)
{
    char *plain = json_edit_set(job_text_objects, "scene.objects[0].material", "{\"kind\":\"diffuse\",\"albedo\":0.5}");
    char *bare = json_edit_set(plain, "scene.objects[2].material", "{\"kind\":\"mirror\"}");
    char *shiny =
        json_edit_set(bare, "scene.objects[3].material", "{\"kind\":\"diffuse\",\"albedo\":0,\"specular\":1}");
    char *text = json_edit_set(shiny, "scene.objects[1].material", "{\"kind\":\"dielectric\",\"ior\":1.25}");
    struct job job = job_expect(text);
    const struct scene_object *objects = job.scene.objects;

    assert_value(&objects[0].material.specular, 0.0);
    assert_null(objects[0].material.texture.file);
    assert_value(&objects[2].material.reflectance, 1.0);
    assert_value(&objects[2].material.roughness, 0.0);
    assert_int_equal(objects[3].material.fresnel, SCENE_FRESNEL_EXACT);
    assert_value(&objects[3].material.ior, 1.5);
    assert_value(&objects[3].material.roughness, 0.0);
    assert_value(&objects[1].material.ior, 1.25);
    assert_int_equal(objects[1].material.fresnel, SCENE_FRESNEL_EXACT);
    assert_value(&objects[1].material.f90, 1.0);
    assert_false(objects[1].material.has_f0);
    job_finish(&job);
    free(text);
    free(shiny);
    free(bare);
    free(plain);
}

static void textures_are_read(void **state)
{
    struct job job = job_expect(job_text_objects);
    const struct scene_texture *tiles = &job.scene.objects[0].material.texture;
    const struct scene_texture *globe = &job.scene.objects[3].material.texture;
    const struct scene_texture *union_image = &job.scene.objects[4].material.texture;

    assert_string_equal(tiles->file, "/data/tiles.PNG");
    assert_true(tiles->size[0] == 2.0 && tiles->size[1] == 0.5);
    assert_true(tiles->is_nearest && tiles->is_linear);
    assert_string_equal(globe->file, "globe.png");
    assert_true(globe->size[0] == 0.0 && globe->size[1] == 0.0);
    assert_true(!globe->is_nearest && !globe->is_linear);
    assert_string_equal(union_image->file, "wood.exr");
    assert_true(union_image->size[0] == 0.25 && union_image->size[1] == 0.0);
    assert_true(!union_image->is_nearest && union_image->is_linear);
    job_finish(&job);
}

static void interiors_come_behind_the_media(void **state)
{
    struct job job = job_expect(job_text_objects);
    const struct scene *scene = &job.scene;
    char place[64];

    assert_int_equal(scene->medium_count, 3);
    assert_int_equal(scene->media[0].owner, 0);
    assert_int_equal(scene->media[1].owner, 2);
    assert_int_equal(scene->media[1].density.kind, SCENE_DENSITY_HOMOGENEOUS);
    assert_value(&scene->media[1].density.homogeneous.scale, 1.0);
    assert_int_equal(scene->media[1].density.bounds.kind, SCENE_BOUNDS_NONE);
    assert_vector(&scene->media[1].sigma_a, 0.75, 0.125, 0.25);
    assert_int_equal(scene->media[2].owner, 6);
    assert_int_equal(scene->media[2].density.kind, SCENE_DENSITY_NOISE);
    scene_format_medium_place(scene, 0, place, sizeof place);
    assert_string_equal(place, "scene.media[0]");
    scene_format_medium_place(scene, 2, place, sizeof place);
    assert_string_equal(place, "scene.objects[5].material.interior");
    job_finish(&job);
}

static void objects_may_be_all_that_there_is(void **state)
{
    char *text = json_edit_set(job_text_objects, "scene.media", NULL);
    struct job job = job_expect(text);

    assert_int_equal(job.scene.media[0].owner, 2);
    assert_int_equal(job.scene.medium_count, 2);
    job_finish(&job);
    free(text);
}

static void paths_are_read(void **state)
{
    char *plain =
        json_edit_set(job_text_objects, "quality", "{\"method\":\"midpoint\",\"step\":0.5,\"light_step\":0.5}");
    struct job job = job_expect(job_text_objects), defaults = job_expect(plain);

    assert_int_equal(job.quality.max_depth, 3);
    assert_true(job.quality.min_throughput == 0.0625 && job.quality.max_cut == 0.25);
    assert_int_equal(defaults.quality.max_depth, 8);
    assert_true(defaults.quality.min_throughput == 0.001 && defaults.quality.max_cut == 0.01);
    job_finish(&job);
    job_finish(&defaults);
    free(plain);
}

// A measured error has the light that cut rays carried.
static void a_tolerance_allows_every_cut_unless_one_is_stated(void **state)
{
    static const struct {
        const char *quality;
        double max_cut;
    } cases[] = {{"{}", 1.0},
                 {"{\"tolerance\":0.02}", 1.0},
                 {"{\"method\":\"auto\",\"max_depth\":3}", 1.0},
                 {"{\"tolerance\":0.02,\"max_cut\":0.01}", 0.01}};

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        char *text = json_edit_set(job_text_objects, "quality", cases[i].quality);
        struct job job = job_expect(text);

        assert_true(job.quality.max_cut == cases[i].max_cut);
        job_finish(&job);
        free(text);
    }
}

#define OBJECT(index) "scene.objects[" #index "]"
#define MATERIAL(index) OBJECT(index) ".material"

static void wrong_objects_are_refused_by_place(void **state)
{
    assert_edit_refused("scene.objects", "{}", "scene.objects: expected an array of 0 to 16, got an object");
    assert_edit_refused(OBJECT(0) ".kind", "\"cube\"",
                        OBJECT(0) ".kind: expected one of \"sphere\",\"box\",\"plane\",\"union\", got \"cube\"");
    assert_edit_refused(OBJECT(0) ".pointt", "1", OBJECT(0) ": unknown key \"pointt\", did you mean \"point\"?");
    assert_edit_refused(OBJECT(0) ".point", NULL,
                        OBJECT(0) ".point: expected three numbers [x, y, z] in [-1000000000, 1000000000], got nothing");
    assert_edit_refused(OBJECT(0) ".normal", "[0,0,0]",
                        OBJECT(0) ".normal: expected a vector whose length is not 0, got one of 0");
    assert_edit_refused(OBJECT(0) ".normal", "{\"keys\":[[0,[0,1,0]],[0.24,[0,-1,0]]]}",
                        OBJECT(0) ".normal: expected a vector whose length is not 0, got one of 0 at frame 3");
    assert_edit_refused(OBJECT(1) ".radius", "0", OBJECT(1) ".radius: expected a number in (0, 1000000000], got 0");
    assert_edit_refused(
        OBJECT(2) ".center", NULL,
        OBJECT(2) ".center: expected three numbers [x, y, z] in [-1000000000, 1000000000], got nothing");
    assert_edit_refused(OBJECT(2) ".size[1]", "0", OBJECT(2) ".size[1]: expected a number in (0, 1000000000], got 0");
    assert_edit_refused(OBJECT(4) ".of", "[]", OBJECT(4) ".of: expected an array of 1 to 32, got an array of 0");
    assert_edit_refused(OBJECT(4) ".of[1].kind", "\"union\"",
                        OBJECT(4) ".of[1].kind: expected one of \"sphere\",\"box\",\"plane\", got \"union\"");
    assert_edit_refused(
        OBJECT(4) ".of[0].material", "{\"kind\":\"mirror\"}",
        OBJECT(4) ".of[0]: unknown key \"material\" beside kind \"sphere\"; known: kind, center, radius");
    assert_edit_refused(OBJECT(4) ".of[2].normal", "{\"keys\":[[0,[0,1,0]],[0.24,[0,-1,0]]]}",
                        OBJECT(4) ".of[2].normal: expected a vector whose length is not 0, got one of 0 at frame 3");
    assert_edit_refused(OBJECT(4) ".center", "[0,0,0]",
                        OBJECT(4) ": unknown key \"center\" beside kind \"union\"; known: material, kind, of");
}

static void wrong_materials_are_refused_by_place(void **state)
{
    assert_edit_refused(MATERIAL(0), NULL, MATERIAL(0) ": expected an object, got nothing");
    assert_edit_refused(MATERIAL(0) ".kind", "\"glass\"",
                        MATERIAL(0) ".kind: expected one of \"diffuse\",\"mirror\",\"dielectric\", got \"glass\"");
    assert_edit_refused(MATERIAL(0) ".albedo", "1.5", MATERIAL(0) ".albedo: expected a number in [0, 1], got 1.5");
    assert_edit_refused(MATERIAL(0) ".specular", NULL, MATERIAL(0) ".fresnel: only beside specular");
    assert_edit_refused(MATERIAL(0) ".fresnel", "\"exact\"", MATERIAL(0) ".f0: only beside a fresnel of \"schlick\"");
    assert_edit_refused(MATERIAL(0) ".f0", "1.5", MATERIAL(0) ".f0: expected a number in [0, 1], got 1.5");
    assert_edit_refused(MATERIAL(1) ".ior", NULL, MATERIAL(1) ".ior: expected a number in [0.1, 10], got nothing");
    assert_edit_refused(MATERIAL(1) ".ior", "11", MATERIAL(1) ".ior: expected a number in [0.1, 10], got 11");
    assert_edit_refused(MATERIAL(1) ".albedo", "1",
                        MATERIAL(1) ": unknown key \"albedo\" beside kind \"dielectric\"; known: kind, ior, fresnel, "
                                    "f0, f90, roughness, interior");
    assert_edit_refused(
        MATERIAL(2) ".interior", "{\"sigma_a\":1}",
        MATERIAL(2) ": unknown key \"interior\" beside kind \"mirror\"; known: kind, reflectance, roughness");
    assert_edit_refused(MATERIAL(2) ".reflectence", "1",
                        MATERIAL(2) ": unknown key \"reflectence\", did you mean \"reflectance\"?");
    assert_edit_refused(MATERIAL(3) ".texture", NULL,
                        MATERIAL(3) ".albedo: expected a number or [r, g, b] in [0, 1], got nothing");
    assert_edit_refused(MATERIAL(3) ".roughness", "0.5", MATERIAL(3) ".roughness: only beside specular");
}

static void wrong_textures_are_refused_by_place(void **state)
{
    assert_edit_refused(MATERIAL(0) ".texture.file", NULL, MATERIAL(0) ".texture.file: expected a string, got nothing");
    assert_edit_refused(MATERIAL(0) ".texture.file", "\"a.jpg\"",
                        MATERIAL(0) ".texture.file: expected a name that ends in .png or .exr, got \"a.jpg\"");
    assert_edit_refused(MATERIAL(0) ".texture.file", "\"a.#.png\"",
                        MATERIAL(0) ".texture.file: expected one file, not one a frame");
    assert_edit_refused(MATERIAL(0) ".texture.file", "\"\"", MATERIAL(0) ".texture.file: expected a file's path");
    assert_edit_refused(MATERIAL(0) ".texture.size", NULL,
                        MATERIAL(0) ".texture.size: expected a tile's size in metres, a number or [across, up], got "
                                    "nothing");
    assert_edit_refused(MATERIAL(0) ".texture.size[1]", "0",
                        MATERIAL(0) ".texture.size[1]: expected a number from 1e-09 to 1000000000, got 0");
    assert_edit_refused(MATERIAL(3) ".texture.size", "1",
                        MATERIAL(3) ".texture.size: not on spheres: a texture goes around them once");
    assert_edit_refused(MATERIAL(4) ".texture.filter", "\"cubic\"",
                        MATERIAL(4) ".texture.filter: expected one of \"linear\",\"nearest\", got \"cubic\"");
    assert_edit_refused(MATERIAL(4) ".texture.colour_space", "\"srgb\"",
                        MATERIAL(4) ".texture: unknown key \"colour_space\", did you mean \"color_space\"?");
}

static void wrong_interiors_are_refused_by_place(void **state)
{
    assert_edit_refused(MATERIAL(1) ".interior", "{}",
                        MATERIAL(1) ".interior: expected sigma_s, sigma_a, emission or blackbody, got none of them");
    assert_edit_refused(MATERIAL(1) ".interior.phase", "[{\"g\":0,\"weight\":0.5}]",
                        MATERIAL(1) ".interior.phase: expected weights that sum to 1, got a sum of 0.5 at frame 1");
    assert_edit_refused(MATERIAL(5) ".interior.density", "1",
                        MATERIAL(5) ".interior.density: expected an object, got 1");
}

// A list of `count` times `element`, owned by the caller.
static char *repeat(const char *element, size_t count)
{
    char *list = NULL;
    size_t size = 0;
    FILE *text = open_memstream(&list, &size);

    assert_non_null(text);
    for (size_t i = 0; i < count; i++)
        fprintf(text, "%s%s", i == 0 ? "[" : ",", element);
    fprintf(text, "]");
    assert_int_equal(fclose(text), 0);
    return list;
}

static void media_and_interiors_are_counted_together(void **state)
{
    char *media = repeat("{\"density\":{\"kind\":\"homogeneous\"},\"sigma_a\":1}", SCENE_MEDIUM_LIMIT - 1);

    assert_edit_refused("scene.media", media, MATERIAL(5) ".interior: expected at most 8 media, interiors among them");
    free(media);
}

static void shapes_of_all_objects_are_counted_together(void **state)
{
    char *shapes = repeat("{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1}", SCENE_SHAPE_LIMIT - 4);
    char *most = repeat("{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1}", SCENE_SHAPE_LIMIT - 5);
    char *sized = json_edit_set(job_text_objects, MATERIAL(4) ".texture.size", NULL);
    char *text = json_edit_set(sized, OBJECT(4) ".of", most), *longer = json_edit_set(sized, OBJECT(4) ".of", shapes);
    struct job job = job_expect(text);

    assert_int_equal(job.scene.shape_count, SCENE_SHAPE_LIMIT);
    job_expect_refused(longer, OBJECT(5) ": expected at most 32 shapes in all");
    job_finish(&job);
    free(longer);
    free(text);
    free(sized);
    free(most);
    free(shapes);
}

static void path_keys_are_for_scenes_with_objects(void **state)
{
    static const char *const keys[] = {"max_depth", "min_throughput", "max_cut"};

    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        char path[64], expected[96], *text;

        snprintf(path, sizeof path, "quality.%s", keys[i]);
        snprintf(expected, sizeof expected, "%s: only for scenes with objects", path);
        text = json_edit_set(job_text_full, path, i == 0 ? "1" : "0.5");
        job_expect_refused(text, expected);
        free(text);
    }
}

static void wrong_path_keys_are_refused(void **state)
{
    assert_edit_refused("quality.max_depth", "0", "quality.max_depth: expected an integer from 1 to 32, got 0");
    assert_edit_refused("quality.max_depth", "33", "quality.max_depth: expected an integer from 1 to 32, got 33");
    assert_edit_refused("quality.min_throughput", "1", "quality.min_throughput: expected a number in [0, 1), got 1");
    assert_edit_refused("quality.max_cut", "1.5", "quality.max_cut: expected a number from 0 to 1, got 1.5");
}

static void elsewhere_only_absolute_paths_can_be_read(void **state)
{
    char *globe = json_edit_set(job_text_objects, MATERIAL(3) ".texture.file", "\"/globe.png\"");
    char *wood = json_edit_set(globe, MATERIAL(4) ".texture.file", "\"/wood.exr\"");
    char *smoke = json_edit_set(wood, MATERIAL(5) ".interior.density", "{\"kind\":\"grid\",\"file\":\"a.nii\"}");

    job_expect_no_inputs(job_text_objects, MATERIAL(3) ".texture.file: expected an absolute path, got \"globe.png\"");
    job_expect_no_inputs(globe, MATERIAL(4) ".texture.file: expected an absolute path, got \"wood.exr\"");
    job_expect_no_inputs(smoke, MATERIAL(5) ".interior.density.file: expected an absolute path, got \"a.nii\"");
    job_expect_no_inputs(wood, NULL);
    free(smoke);
    free(wood);
    free(globe);
}

static void the_objects_of_the_documentation_are_taken(void **state)
{
    static const char opening[] = "```json\n\"objects\": ";
    char *page, *start, *end, *text;
    size_t length;
    struct job job;

    assert_true(file_read_text(PROJECT_ROOT "/docs/job_format.md", JOB_DOCUMENT_LIMIT, &page, &length, NULL));
    start = strstr(page, opening);
    assert_non_null(start);
    start += strlen(opening);
    end = strstr(start, "```");
    assert_non_null(end);
    *end = 0;
    text = json_edit_set(job_text_objects, "scene.objects", start);
    job = job_expect(text);
    assert_int_equal(job.scene.object_count, 3);
    job_finish(&job);
    free(text);
    free(page);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shapes_are_read),
        cmocka_unit_test(materials_are_read),
        cmocka_unit_test(absent_keys_of_materials_have_defaults),
        cmocka_unit_test(textures_are_read),
        cmocka_unit_test(interiors_come_behind_the_media),
        cmocka_unit_test(objects_may_be_all_that_there_is),
        cmocka_unit_test(paths_are_read),
        cmocka_unit_test(a_tolerance_allows_every_cut_unless_one_is_stated),
        cmocka_unit_test(wrong_objects_are_refused_by_place),
        cmocka_unit_test(wrong_materials_are_refused_by_place),
        cmocka_unit_test(wrong_textures_are_refused_by_place),
        cmocka_unit_test(wrong_interiors_are_refused_by_place),
        cmocka_unit_test(media_and_interiors_are_counted_together),
        cmocka_unit_test(shapes_of_all_objects_are_counted_together),
        cmocka_unit_test(path_keys_are_for_scenes_with_objects),
        cmocka_unit_test(wrong_path_keys_are_refused),
        cmocka_unit_test(elsewhere_only_absolute_paths_can_be_read),
        cmocka_unit_test(the_objects_of_the_documentation_are_taken),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
