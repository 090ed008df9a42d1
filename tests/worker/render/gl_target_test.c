// SPDX-License-Identifier: Apache-2.0
#include "worker/render/gl_target.h"

#include "core/base/error.h"
#include "tests/support/assert_near.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "worker/gl/gl_functions.h"
#include "worker/gl/gl_program.h"
#include "worker/glsl/shader_sources.h"
#include "worker/picture/image.h"
#include "worker/picture/ray_counts.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

// More rows than are read at once, and no multiple of that.
enum { WIDTH_PX = 37, HEIGHT_PX = 53, PASSES = 3 };

// Each of a pixel's counts depends on its position.
static const char fragment[] = "#version 450 core\n"
                               "layout(location = 0) out vec4 color;\n"
                               "layout(location = 1) out vec4 transmittance;\n"
                               "layout(location = 2) out vec4 depth;\n"
                               "layout(location = 3) out vec4 paths;\n"
                               "void main()\n{\n"
                               "    vec2 p = floor(gl_FragCoord.xy);\n"
                               "    color = vec4(1.0, 2.0, 3.0, 1.0);\n"
                               "    transmittance = vec4(0.5);\n"
                               "    depth = vec4(7.0, 1.0, 0.0, 0.0);\n"
                               "    paths = vec4(p == vec2(5.0, 40.0) ? 3.0 : 0.25, p.x, 1.0 + p.y + (p == vec2(36.0, "
                               "52.0) ? 100.0 : 0.0), 0.125);\n"
                               "}\n";

struct stage {
    struct gl_context *context;
    struct gl_functions gl;
    unsigned program, vertex_array;
};

static struct stage open_stage(enum gl_backend backend)
{
    static const char *const names[] = {"test"};
    struct error error = {{0}};
    struct stage stage = {.context = gl_stage_open_context(backend)};
    char *vertex;

    assert_true(gl_functions_load(&stage.gl, stage.context, NULL));
    vertex = shader_sources_load(test_shader_dir(), "fullscreen.vert", &error);
    stage.program = gl_program_create(
        &stage.gl,
        &(struct gl_program_params){.vertex = vertex, .fragment = fragment, .module_names = names, .module_count = 1},
        &error);
    if (!stage.program) fail_msg("%s", error.message);
    stage.gl.CreateVertexArrays(1, &stage.vertex_array);
    stage.gl.BindVertexArray(stage.vertex_array);
    stage.gl.UseProgram(stage.program);
    free(vertex);
    return stage;
}

static void close_stage(struct stage *stage)
{
    stage->gl.DeleteVertexArrays(1, &stage->vertex_array);
    stage->gl.DeleteProgram(stage->program);
    gl_context_destroy(stage->context);
}

static struct ray_counts draw(struct stage *stage, struct image *image, int pass_count, bool has_paths)
{
    const struct gl_target_params params = {.image = image, .pass_count = pass_count, .has_paths = has_paths};
    struct gl_target target = {0};
    struct ray_counts counts = {0};

    assert_true(gl_target_init(&target, &stage->gl, &params, NULL));
    gl_target_begin(&target);
    for (int i = 0; i < pass_count; ++i)
        stage->gl.DrawArrays(GL_TRIANGLES, 0, 3);
    gl_target_read(&target, NULL, image, &counts);
    assert_int_equal(stage->gl.GetError(), GL_NO_ERROR);
    gl_target_finish(&target);
    return counts;
}

static void assert_counts(const struct ray_counts *counts)
{
    const double pixels = WIDTH_PX * HEIGHT_PX;

    assert_true(counts->is_known);
    assert_near(counts->cut_throughput, 0.25 + 2.75 / pixels, 1e-12);
    assert_near(counts->cut_rays, (WIDTH_PX - 1) / 2.0, 1e-12);
    assert_near(counts->rays, (HEIGHT_PX + 1) / 2.0 + 100.0 / pixels, 1e-12);
    assert_near(counts->cut_by_depth, 0.125, 1e-12);
    assert_near(counts->most_cut.value, 3, 0);
    assert_int_equal(counts->most_cut.x_px, 5);
    assert_int_equal(counts->most_cut.y_px, 40);
    assert_near(counts->most_rays.value, HEIGHT_PX + 100, 0);
    assert_int_equal(counts->most_rays.x_px, 36);
    assert_int_equal(counts->most_rays.y_px, 52);
}

static void assert_counts_rays(enum gl_backend backend)
{
    struct stage stage = open_stage(backend);
    const int passes[] = {1, PASSES};

    for (int i = 0; i < 2; ++i)
        for (int pictures = 0; pictures < 2; ++pictures) {
            struct image image;
            struct ray_counts counts;

            assert_true(image_init(&image, WIDTH_PX, HEIGHT_PX, pictures, pictures, NULL));
            counts = draw(&stage, &image, passes[i], true);
            assert_counts(&counts);
            assert_near(image.rgba[4 * 100 + 1], 2, 0);
            if (pictures) assert_near(image.transmittance[4 * 100], 0.5, 0);
            if (pictures) assert_near(image.depth[100], 7, 0);
            image_finish(&image);
        }
    close_stage(&stage);
}

static void rays_are_counted_in_software(void **state)
{
    assert_counts_rays(GL_BACKEND_SOFTWARE);
}

static void rays_are_counted_on_egl(void **state)
{
    assert_counts_rays(GL_BACKEND_EGL);
}

static void nothing_is_counted_where_there_are_no_paths(void **state)
{
    struct stage stage = open_stage(GL_BACKEND_SOFTWARE);
    struct ray_counts counts;
    struct image image;

    assert_true(image_init(&image, WIDTH_PX, HEIGHT_PX, true, true, NULL));
    counts = draw(&stage, &image, 1, false);
    assert_false(counts.is_known);
    assert_near(image.depth[100], 7, 0);
    image_finish(&image);
    close_stage(&stage);
}

static void paths_need_a_target_of_their_own(void **state)
{
    struct stage stage = open_stage(GL_BACKEND_SOFTWARE);
    struct gl_target_params params = {.pass_count = 1, .has_paths = true};
    struct gl_target target = {0};
    struct image image;

    assert_true(image_init(&image, WIDTH_PX, HEIGHT_PX, true, false, NULL));
    params.image = &image;
    assert_true(gl_target_init(&target, &stage.gl, &params, NULL));
    assert_true(gl_target_fits(&target, &params));
    params.has_paths = false;
    assert_false(gl_target_fits(&target, &params));
    params = (struct gl_target_params){.image = &image, .pass_count = 2, .has_paths = true};
    assert_false(gl_target_fits(&target, &params));
    gl_target_finish(&target);
    image_finish(&image);
    close_stage(&stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_are_counted_in_software),
        cmocka_unit_test(rays_are_counted_on_egl),
        cmocka_unit_test(nothing_is_counted_where_there_are_no_paths),
        cmocka_unit_test(paths_need_a_target_of_their_own),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
