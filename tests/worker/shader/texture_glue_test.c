// The generated text finds the colour on each shape of an object, from a file read as the worker reads it.
// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/texture_glue.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/assert_near.h"
#include "tests/support/png_maker.h"
#include "tests/support/shader_probe.h"
#include "tests/support/temp_folder.h"
#include "worker/gl/gl_functions.h"
#include "worker/model/scene_model.h"
#include "worker/scene/scene_inputs.h"
#include "worker/textures/gl_textures.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SPHERE, BOX, PLANE, SHAPE_COUNT, OBJECT = 2, FIRST_SHAPE = 3, MODULE_LIMIT = 16 };

// The object has shapes 3, 4 and 5.
static const char SHAPES[] =
    "RegionSphere shape_3() { return RegionSphere(vec3(10.0, 0.0, 0.0), 2.0); }\n"
    "RegionBox shape_4() { return RegionBox(vec3(0.0, 5.0, 0.0), vec3(1.0, 1.5, 2.0)); }\n"
    "RegionPlane shape_5() { return RegionPlane(vec3(0.5, -1.0, 0.25), vec3(0.0, 1.0, 0.0)); }\n";
static const char PROBE[] =
    "vec4 probe(int i)\n{\n    return vec4(object_2_texture(inputs[i].xyz, int(inputs[i].w)), 0.0);\n}\n";

// Red, green; blue, white.
static const unsigned char quarters[] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};

struct stage {
    struct job job;
    struct scene_inputs inputs;
    struct scene_files files;
    struct gl_textures *textures;
};

static struct stage stage;

static void open_stage(void **state, bool is_nearest)
{
    struct scene_object *object = &stage.job.scene.objects[OBJECT];
    static char path[512];
    struct error error = {{0}};

    snprintf(path, sizeof path, "%s", temp_folder_path(state, "quarters.png"));
    png_maker_write_rgb(path, 2, 2, quarters);
    stage = (struct stage){.files = {.hashes = file_hashes_create()}};
    stage.job.scene.object_count = OBJECT + 1;
    stage.job.scene.shape_count = FIRST_SHAPE + SHAPE_COUNT;
    *object = (struct scene_object){.first_shape = FIRST_SHAPE, .shape_count = SHAPE_COUNT, .is_union = true};
    object->material.texture = (struct scene_texture){.file = path, .size = {4, 2}, .is_nearest = is_nearest};
    stage.job.scene.shapes[FIRST_SHAPE + SPHERE].kind = SCENE_SHAPE_SPHERE;
    stage.job.scene.shapes[FIRST_SHAPE + BOX].kind = SCENE_SHAPE_BOX;
    stage.job.scene.shapes[FIRST_SHAPE + PLANE].kind = SCENE_SHAPE_PLANE;
    if (!scene_inputs_open(&stage.inputs, &stage.job, 0, &stage.files, NULL, &error)) fail_msg("%s", error.message);
}

static void close_stage(void)
{
    scene_inputs_finish(&stage.inputs);
    file_hashes_destroy(stage.files.hashes);
}

static void bind(const struct gl_functions *gl, void *user)
{
    struct error error = {{0}};

    stage.textures = gl_textures_create(gl);
    if (!gl_textures_bind(stage.textures, &stage.inputs, NULL, NULL, &error)) fail_msg("%s", error.message);
}

static void release(void *user)
{
    gl_textures_destroy(stage.textures);
}

static void probe(const float (*inputs)[4], size_t count, float (*outputs)[4])
{
    const char *modules[MODULE_LIMIT + 1] = {"math/constants.glsl", "region/span.glsl",  "region/sphere.glsl",
                                             "region/box.glsl",     "region/plane.glsl", "surface/sphere.glsl",
                                             "surface/box.glsl"};
    size_t module_count = 7, length = 0;
    char *body = NULL;
    FILE *out = open_memstream(&body, &length);

    for (const char *const *name = texture_glue_modules(&stage.job, OBJECT); *name; ++name)
        modules[module_count++] = *name;
    fputs(SHAPES, out);
    texture_glue_write(out, &(struct scene_model){.job = &stage.job, .inputs = &stage.inputs}, OBJECT);
    fputs(PROBE, out);
    fclose(out);
    shader_probe_run(&(struct shader_probe_params){.modules = modules,
                                                   .body = body,
                                                   .inputs = inputs,
                                                   .input_count = count,
                                                   .count = count,
                                                   .bind = bind,
                                                   .release = release},
                     outputs);
    free(body);
}

enum { RED, GREEN, BLUE, WHITE };

static void assert_color(const float output[4], int wanted)
{
    for (int c = 0; c < 3; ++c)
        assert_near(output[c], wanted == WHITE || wanted == c ? 1 : 0, 0);
}

// Points of the four quarters of a tile, on each shape and each face, as one sees it from outside.
static void each_shape_has_its_own_image(void **state)
{
    static const struct {
        float at[4]; // and the shape
        int color;
    } cases[] = {
        {{0.5f - 1, -1, 0.25f - 0.5f, 5}, RED},
        {{0.5f + 1, -1, 0.25f - 0.5f, 5}, GREEN},
        {{0.5f - 1, -1, 0.25f + 0.5f, 5}, BLUE},
        {{0.5f + 1, -1, 0.25f + 0.5f, 5}, WHITE},
        {{0.5f + 3, -1, 0.25f - 0.5f, 5}, RED},
        {{0.5f - 1, -1, 0.25f + 1.5f, 5}, RED}, // the next tiles
        {{-0.5f, 5.5f, 2, 4}, RED},
        {{0.5f, 5.5f, 2, 4}, GREEN}, // faces +z, -z, +x, -x, +y, -y
        {{0.5f, 5.5f, -2, 4}, RED},
        {{-0.5f, 4.5f, -2, 4}, WHITE},
        {{1, 5.5f, 0.5f, 4}, RED},
        {{1, 4.5f, 0.5f, 4}, BLUE},
        {{-1, 5.5f, -0.5f, 4}, RED},
        {{-1, 5.5f, 0.5f, 4}, GREEN},
        {{-0.5f, 6.5f, -0.5f, 4}, RED},
        {{-0.5f, 6.5f, 0.5f, 4}, BLUE},
        {{0.5f, 3.5f, -0.5f, 4}, RED},
        {{-0.5f, 3.5f, -0.5f, 4}, GREEN},
        {{9, 1, 1.414f, 3}, RED},
        {{11, 1, 1.414f, 3}, GREEN},
        {{9, -1, 1.414f, 3}, BLUE},
        {{11, -1, 1.414f, 3}, WHITE},
        {{11, -1, 1.414f, 0}, WHITE}, // another object's shape: as on the first
    };
    enum { COUNT = sizeof cases / sizeof cases[0] };
    float inputs[COUNT][4], outputs[COUNT][4];

    open_stage(state, true);
    for (size_t i = 0; i < COUNT; ++i)
        memcpy(inputs[i], cases[i].at, sizeof inputs[i]);
    probe((const float(*)[4])inputs, COUNT, outputs);
    for (size_t i = 0; i < COUNT; ++i)
        assert_color(outputs[i], cases[i].color);
    close_stage();
}

// In the middle of the tile all four meet.
static void linear_filter_mixes(void **state)
{
    static const float inputs[1][4] = {{0.5f, -1, 0.25f, 5}};
    float outputs[1][4];

    open_stage(state, false);
    probe(inputs, 1, outputs);
    for (int c = 0; c < 3; ++c)
        assert_near(outputs[0][c], 0.5, 1e-6);
    close_stage();
}

static bool has_module(const char *name)
{
    for (const char *const *at = texture_glue_modules(&stage.job, OBJECT); *at; ++at)
        if (strcmp(*at, name) == 0) return true;
    return false;
}

static void only_what_is_used_is_there(void **state)
{
    struct scene_object *object = &stage.job.scene.objects[OBJECT];

    open_stage(state, false);
    assert_true(has_module("texture/linear.glsl") && !has_module("texture/nearest.glsl"));
    assert_true(has_module("texture/plane.glsl") && has_module("texture/sphere.glsl"));
    object->shape_count = 1;
    assert_true(!has_module("texture/plane.glsl") && has_module("texture/sphere.glsl"));
    object->first_shape += 1;
    object->material.texture.is_nearest = true;
    assert_true(has_module("texture/plane.glsl") && !has_module("texture/sphere.glsl"));
    assert_true(!has_module("texture/linear.glsl") && has_module("texture/nearest.glsl"));
    close_stage();
}

int main(int argc, char *argv[])
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, temp_folder_create, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        TEST(each_shape_has_its_own_image),
        TEST(linear_filter_mixes),
        TEST(only_what_is_used_is_there),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
