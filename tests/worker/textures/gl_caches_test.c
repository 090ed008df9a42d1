// SPDX-License-Identifier: Apache-2.0
#include "worker/textures/gl_caches.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "tests/support/assert_near.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "worker/gl/gl_functions.h"
#include "worker/gl/gl_program.h"
#include "worker/gl/gl_programs.h"
#include "worker/glsl/shader_sources.h"
#include "worker/glsl/texture_units.h"
#include "worker/picture/image.h"
#include "worker/render/gl_target.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// The sizes need more rows of groups than the first strips have, and groups that are not full.
enum { WIDTH = 19, HEIGHT = 83, DEPTH = 11, UNIT = TEXTURE_UNIT_LIGHTS };

struct stage {
    struct gl_context *context;
    struct gl_functions gl;
    struct gl_programs programs;
    struct gl_caches *caches;
};

static void open_stage(struct stage *stage, enum gl_backend backend)
{
    *stage = (struct stage){.context = gl_stage_open_context(backend)};
    assert_true(gl_functions_load(&stage->gl, stage->context, NULL));
    gl_programs_init(&stage->programs, &stage->gl);
    stage->caches = gl_caches_create(&stage->gl, &stage->programs);
}

static void close_stage(struct stage *stage)
{
    gl_caches_destroy(stage->caches);
    gl_programs_finish(&stage->programs);
    assert_int_equal(stage->gl.GetError(), GL_NO_ERROR);
    gl_context_destroy(stage->context);
}

static void evaluate_time(const void *source, double time, double value[static 9])
{
    (void)source;
    value[0] = time;
}

// Each texel holds its position and the frame's time.
static struct scene_cache cache_of(const char *body, int layers)
{
    struct scene_cache cache = {
        .name = "places", .unit = UNIT, .size = {WIDTH, HEIGHT, DEPTH}, .invocations = {WIDTH, HEIGHT, layers}};
    struct shader_assembly text;

    assert_true(scene_cache_begin(&cache, &text, NULL, NULL));
    frame_uniforms_add(&cache.uniforms,
                       (struct frame_value){.evaluate = evaluate_time, .max = 1e3, .meaning = "the time"}, "time_s");
    frame_uniforms_declare(&cache.uniforms, text.out);
    fprintf(
        text.out,
        "void main()\n{\n    frame_uniforms_read();\n    ivec3 at;\n    if (!cache_find_invocation(at)) return;\n%s}\n",
        body);
    assert_true(scene_cache_end(&cache, &text));
    return cache;
}

static const char of_rays[] =
    "    for (at.z = 0; at.z < 11; ++at.z)\n"
    "        imageStore(cache_image, at, vec4(dot(vec3(at), vec3(1.0, 100.0, 10000.0)) + time_s));\n";
static const char of_texels[] =
    "    imageStore(cache_image, at, vec4(dot(vec3(at), vec3(1.0, 100.0, 10000.0)) + time_s));\n";

static enum gl_caches_end bind_at(struct stage *stage, const struct scene_cache *caches, size_t count, double time,
                                  const char *files_hash, struct error *error)
{
    unsigned char blocks[2][64];
    const unsigned char *pointers[2] = {blocks[0], blocks[1]};

    for (size_t i = 0; i < count; i++) {
        assert_true(caches[i].uniforms.size_bytes <= sizeof blocks[i]);
        assert_true(frame_uniforms_pack(&caches[i].uniforms, &(struct frame_moment){.time = time}, blocks[i], NULL));
    }
    return gl_caches_bind(
        stage->caches,
        &(struct gl_caches_request){.caches = caches, .count = count, .blocks = pointers, .files_hash = files_hash},
        error);
}

// Samples the texture in a fragment shader: one row of pixels for each layer and row.
static void read_texels(struct stage *stage, struct image *image)
{
    static const char fragment[] = "#version 450 core\n"
                                   "layout(binding = 48) uniform sampler3D places;\n"
                                   "layout(location = 0) out vec4 color;\n"
                                   "void main()\n{\n"
                                   "    ivec2 p = ivec2(gl_FragCoord.xy);\n"
                                   "    color = texelFetch(places, ivec3(p.x, p.y % 83, p.y / 83), 0);\n"
                                   "}\n";
    const struct gl_functions *gl = &stage->gl;
    char *vertex = shader_sources_load(test_shader_dir(), "fullscreen.vert", NULL);
    static const char *const names[] = {"test"};
    struct gl_target target = {0};
    unsigned vertex_array, program;

    program = gl_program_create(
        gl,
        &(struct gl_program_params){.vertex = vertex, .fragment = fragment, .module_names = names, .module_count = 1},
        NULL);
    assert_true(program != 0);
    assert_true(image_init(image, WIDTH, HEIGHT * DEPTH, false, false, NULL));
    assert_true(gl_target_init(&target, gl, &(struct gl_target_params){.image = image, .pass_count = 1}, NULL));
    gl->CreateVertexArrays(1, &vertex_array);
    gl->BindVertexArray(vertex_array);
    gl_target_begin(&target);
    gl->UseProgram(program);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
    gl_target_read(&target, NULL, image, NULL);
    gl_target_finish(&target);
    gl->DeleteVertexArrays(1, &vertex_array);
    gl->DeleteProgram(program);
    free(vertex);
}

static void assert_places(struct stage *stage, double time)
{
    struct image image;

    read_texels(stage, &image);
    for (int row = 0; row < HEIGHT * DEPTH; row++)
        for (int x = 0; x < WIDTH; x++) {
            double expected = x + 100.0 * (row % HEIGHT) + 10000.0 * (row / HEIGHT) + time;

            assert_near(image.rgba[4 * ((size_t)row * WIDTH + (size_t)x)], expected, 0.01);
        }
    image_finish(&image);
}

static void check_every_texel(enum gl_backend backend, const char *body, int layers)
{
    struct stage stage;
    struct scene_cache cache = cache_of(body, layers);

    open_stage(&stage, backend);
    for (int time = 1; time < 4; time++) { // strips grow from time to time
        assert_int_equal(bind_at(&stage, &cache, 1, time, "", NULL), GL_CACHES_BOUND);
        assert_places(&stage, time);
    }
    close_stage(&stage);
    scene_cache_finish(&cache);
}

static void every_texel_is_filled(void **state)
{
    (void)state;
    check_every_texel(GL_BACKEND_SOFTWARE, of_rays, 1);
    check_every_texel(GL_BACKEND_SOFTWARE, of_texels, DEPTH);
}

static void every_texel_is_filled_on_egl(void **state)
{
    (void)state;
    check_every_texel(GL_BACKEND_EGL, of_rays, 1);
    check_every_texel(GL_BACKEND_EGL, of_texels, DEPTH);
}

enum { PARTS = 5 * WIDTH };

// Part n is done when n % 5 turns have gone on with it; texel n counts them, and texel n of the next row who finished
// it. Every seventh has nothing to do.
static struct scene_cache cache_of_parts(void)
{
    struct scene_cache cache = {.name = "places",
                                .unit = UNIT,
                                .size = {WIDTH, HEIGHT, DEPTH},
                                .invocations = {SCENE_CACHE_GROUP_SIDE, 4 * SCENE_CACHE_GROUP_SIDE, 1},
                                .takes_turns = true,
                                .part_count = PARTS};
    struct shader_assembly text;

    assert_true(scene_cache_begin(&cache, &text, NULL, NULL));
    fprintf(text.out,
            "void main()\n{\n"
            "    for (int i = 0; i < 3; ++i) {\n"
            "        uint number = cache_take();\n"
            "        if (number >= %uu) return;\n"
            "        ivec3 at = ivec3(number %% %uu, number / %uu, 0);\n"
            "        float done = imageLoad(cache_image, at).r;\n"
            "        if (number %% 7u == 0u || done > float(number %% 5u)) continue;\n"
            "        imageStore(cache_image, at, vec4(done + 1.0));\n"
            "        imageStore(cache_image, at + ivec3(0, 5, 0), vec4(done == float(number %% 5u) ? number : 0u));\n"
            "        if (done < float(number %% 5u)) cache_leave(number);\n"
            "    }\n}\n",
            PARTS, WIDTH, WIDTH);
    assert_true(scene_cache_end(&cache, &text));
    return cache;
}

static void assert_parts(struct stage *stage)
{
    struct image image;

    read_texels(stage, &image);
    for (unsigned i = 0; i < PARTS; i++) {
        bool is_idle = i % 7 == 0;

        assert_float_equal(image.rgba[4 * (size_t)i], is_idle ? 0.0 : i % 5 + 1.0, 0.0);
        assert_float_equal(image.rgba[4 * (size_t)(i + PARTS)], is_idle ? 0.0 : (double)i, 0.0);
    }
    image_finish(&image);
}

static void check_parts(enum gl_backend backend)
{
    struct stage stage;
    struct scene_cache cache = cache_of_parts();

    open_stage(&stage, backend);
    for (int i = 0; i < 3; i++) {
        char files[2] = {(char)('a' + i)};

        cache.reads_files = true;
        assert_int_equal(gl_caches_bind(stage.caches,
                                        &(struct gl_caches_request){.caches = &cache,
                                                                    .count = 1,
                                                                    .blocks = &(const unsigned char *){NULL},
                                                                    .files_hash = files},
                                        NULL),
                         GL_CACHES_BOUND);
        assert_int_equal(gl_caches_count_fills(stage.caches), i + 1);
        assert_parts(&stage);
    }
    close_stage(&stage);
    scene_cache_finish(&cache);
}

static void every_part_is_done_to_its_end(void **state)
{
    (void)state;
    check_parts(GL_BACKEND_SOFTWARE);
}

static void every_part_is_done_to_its_end_on_egl(void **state)
{
    (void)state;
    check_parts(GL_BACKEND_EGL);
}

static void what_stays_is_not_filled_again(void **state)
{
    struct stage stage;
    struct scene_cache cache = cache_of(of_rays, 1);

    (void)state;
    open_stage(&stage, GL_BACKEND_SOFTWARE);
    for (int i = 0; i < 3; i++)
        assert_int_equal(bind_at(&stage, &cache, 1, 1, i == 2 ? "other" : "", NULL), GL_CACHES_BOUND);
    assert_int_equal(gl_caches_count_fills(stage.caches), 1);
    bind_at(&stage, &cache, 1, 2, "", NULL);
    bind_at(&stage, &cache, 1, 1, "", NULL); // the first texture is still kept
    assert_int_equal(gl_caches_count_fills(stage.caches), 2);
    assert_places(&stage, 1);
    cache.reads_files = true;
    bind_at(&stage, &cache, 1, 1, "one", NULL);
    bind_at(&stage, &cache, 1, 1, "two", NULL);
    assert_int_equal(gl_caches_count_fills(stage.caches), 4);
    cache.size[2]++;
    bind_at(&stage, &cache, 1, 1, "two", NULL);
    assert_int_equal(gl_caches_count_fills(stage.caches), 5);
    close_stage(&stage);
    scene_cache_finish(&cache);
}

// Writes a program that doubles the values of another cache's texture.
static void write_reading(struct scene_cache *cache)
{
    struct shader_assembly text;

    free(cache->text);
    assert_true(scene_cache_begin(cache, &text, NULL, NULL));
    fputs("layout(binding = 48) uniform sampler3D places;\n"
          "void main()\n{\n    ivec3 at;\n    if (!cache_find_invocation(at)) return;\n"
          "    imageStore(cache_image, at, 2.0 * texelFetch(places, at, 0));\n}\n",
          text.out);
    assert_true(scene_cache_end(cache, &text));
}

static void make_pair(struct scene_cache caches[2])
{
    caches[0] = cache_of(of_rays, 1);
    caches[1] = cache_of("    imageStore(cache_image, at, vec4(7.0));\n", DEPTH);
    frame_uniforms_finish(&caches[1].uniforms); // its values do not depend on time
    write_reading(&caches[1]);
    caches[1].unit = UNIT + 1;
}

static void a_cache_follows_the_one_that_it_reads(void **state)
{
    struct stage stage;
    struct scene_cache caches[2];

    (void)state;
    open_stage(&stage, GL_BACKEND_SOFTWARE);
    make_pair(caches);
    bind_at(&stage, caches, 2, 1, "", NULL);
    bind_at(&stage, caches, 2, 2, "", NULL);
    assert_int_equal(gl_caches_count_fills(stage.caches), 3);
    caches[1].reads = 1;
    bind_at(&stage, caches, 2, 3, "", NULL);
    assert_int_equal(gl_caches_count_fills(stage.caches), 5);
    bind_at(&stage, caches, 2, 4, "", NULL);
    assert_int_equal(gl_caches_count_fills(stage.caches), 7);
    caches[1].unit = UNIT; // the unit that the test samples
    bind_at(&stage, &caches[1], 1, 4, "", NULL);
    for (size_t i = 0; i < 2; i++)
        scene_cache_finish(&caches[i]);
    close_stage(&stage);
}

static void a_step_is_there_while_another_is_filled(void **state)
{
    struct stage stage;
    struct scene_cache caches[2];
    struct image image;

    (void)state;
    open_stage(&stage, GL_BACKEND_SOFTWARE);
    make_pair(caches);
    caches[0].is_step = true;
    caches[1].reads = 1;
    caches[1].unit = UNIT; // the other cache replaces the intermediate one
    bind_at(&stage, caches, 2, 1, "", NULL);
    bind_at(&stage, caches, 2, 1, "", NULL);
    assert_int_equal(gl_caches_count_fills(stage.caches), 2);
    read_texels(&stage, &image);
    assert_near(image.rgba[4], 2.0 * (1 + 1), 0.01); // the texel at (1, 0, 0)
    image_finish(&image);
    bind_at(&stage, caches, 2, 2, "", NULL);
    assert_int_equal(gl_caches_count_fills(stage.caches), 4);
    bind_at(&stage, caches, 1, 2, "", NULL); // no cache reads it
    assert_int_equal(gl_caches_count_fills(stage.caches), 4);
    caches[0].is_step = false;
    bind_at(&stage, caches, 1, 2, "", NULL); // its texture was not kept
    assert_int_equal(gl_caches_count_fills(stage.caches), 5);
    for (size_t i = 0; i < 2; i++)
        scene_cache_finish(&caches[i]);
    close_stage(&stage);
}

static void a_program_that_does_not_compile_is_told_by_its_module(void **state)
{
    struct stage stage;
    struct scene_cache cache = cache_of("    nonsense();\n", 1);
    struct error error = {{0}};

    (void)state;
    open_stage(&stage, GL_BACKEND_SOFTWARE);
    assert_int_equal(bind_at(&stage, &cache, 1, 1, "", &error), GL_CACHES_REFUSED);
    assert_non_null(strstr(error.message, "generated:"));
    close_stage(&stage);
    scene_cache_finish(&cache);
}

static void what_has_no_room_is_refused_before_it_is_made(void **state)
{
    struct stage stage;
    struct scene_cache cache = cache_of(of_rays, 1);
    struct error error = {{0}};

    (void)state;
    open_stage(&stage, GL_BACKEND_SOFTWARE);
    cache.size[0] = cache.size[1] = cache.size[2] = 16384; // 16 TiB
    assert_int_equal(bind_at(&stage, &cache, 1, 1, "", &error), GL_CACHES_REFUSED);
    assert_non_null(strstr(error.message, "quality: the grids of a frame: "));
    assert_non_null(strstr(error.message, " GiB are available"));
    close_stage(&stage);
    scene_cache_finish(&cache);
}

static bool stop_at_second(void *user)
{
    int *count = user;

    return ++*count < 2;
}

static void filling_can_be_stopped(void **state)
{
    struct stage stage;
    struct scene_cache cache = cache_of(of_rays, 1);
    unsigned char block[16] = {0};
    const unsigned char *blocks[] = {block};
    int count = 0;
    const struct gl_caches_request request = {
        .caches = &cache, .count = 1, .blocks = blocks, .files_hash = "", .on_strip = stop_at_second, .user = &count};

    (void)state;
    open_stage(&stage, GL_BACKEND_SOFTWARE);
    assert_int_equal(gl_caches_bind(stage.caches, &request, NULL), GL_CACHES_STOPPED);
    assert_int_equal(count, 2);
    assert_int_equal(gl_caches_count_fills(stage.caches), 0);
    assert_int_equal(bind_at(&stage, &cache, 1, 0, "", NULL), GL_CACHES_BOUND); // the half-filled texture was dropped
    assert_int_equal(gl_caches_count_fills(stage.caches), 1);
    close_stage(&stage);
    scene_cache_finish(&cache);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_texel_is_filled),
        cmocka_unit_test(every_texel_is_filled_on_egl),
        cmocka_unit_test(every_part_is_done_to_its_end),
        cmocka_unit_test(every_part_is_done_to_its_end_on_egl),
        cmocka_unit_test(what_stays_is_not_filled_again),
        cmocka_unit_test(a_cache_follows_the_one_that_it_reads),
        cmocka_unit_test(a_step_is_there_while_another_is_filled),
        cmocka_unit_test(a_program_that_does_not_compile_is_told_by_its_module),
        cmocka_unit_test(what_has_no_room_is_refused_before_it_is_made),
        cmocka_unit_test(filling_can_be_stopped),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
