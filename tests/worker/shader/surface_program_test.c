// Shaders of scenes with objects: what they contain, and what they do not.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "tests/support/object_job.h"
#include "tests/support/shader_text.h"
#include "tests/support/temp_folder.h"
#include "worker/shader/scene_program.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

#define ROUGH ", \"roughness\": 0.1"
#define SMOKE ", \"interior\": {\"sigma_s\": 1, \"sigma_a\": 0.5}"
#define FOG                                                                                                            \
    "\"media\": [{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"sphere\", \"center\": [0, 0, 0],"  \
    " \"radius\": 3}}, \"sigma_s\": 0.1, \"sigma_a\": 0.1}], "
#define OBJECTS(list) "\"objects\": [" list "]"

static void assemble(struct scene_program *program, struct job *job, const char *scene, const char *rest)
{
    struct error error = {{0}};

    object_job_parse(job, scene, rest);
    if (!scene_program_init(program, job, NULL, NULL, &error)) fail_msg("%s", error.message);
}

static void release(struct scene_program *program, struct job *job)
{
    scene_program_finish(program);
    job_finish(job);
}

static void without_objects_there_are_no_surfaces(void **state)
{
    struct scene_program program;
    struct job job;

    assemble(&program, &job, FOG OBJECTS(""), OBJECT_JOB_LIGHT ", " OBJECT_JOB_QUALITY);
    shader_text_assert_lacks(&program, "surface");
    shader_text_assert_lacks(&program, "shape_");
    shader_text_assert_lacks(&program, "path");
    shader_text_assert_lacks(&program, "Path");
    shader_text_assert_lacks(&program, "media_spans_in");
    release(&program, &job);
}

static void diffuse_objects_end_rays(void **state)
{
    struct scene_program program;
    struct job job;

    assemble(&program, &job, OBJECTS(OBJECT_JOB_FLOOR(OBJECT_JOB_GREY)), OBJECT_JOB_LIGHT ", " OBJECT_JOB_QUALITY);
    shader_text_assert_has(&program, "#define Spectrum float");
    shader_text_assert_has(&program, "surface_lit(");
    shader_text_assert_lacks(&program, "#define Spectrum vec3");
    shader_text_assert_lacks(&program, "path_send");
    shader_text_assert_lacks(&program, "path_wait");
    shader_text_assert_lacks(&program, "out vec4 paths");
    shader_text_assert_lacks(&program, "fresnel");
    shader_text_assert_lacks(&program, "random");
    shader_text_assert_lacks(&program, "Media");
    assert_false(program.model.features.has_paths);
    release(&program, &job);
}

static void without_lights_diffuse_objects_are_black(void **state)
{
    struct scene_program program;
    struct job job;

    assemble(&program, &job, OBJECTS(OBJECT_JOB_FLOOR("\"kind\": \"diffuse\", \"albedo\": [1, 0, 0]")),
             OBJECT_JOB_QUALITY);
    shader_text_assert_has(&program, "#define Spectrum float");
    shader_text_assert_lacks(&program, "albedo");
    shader_text_assert_lacks(&program, "shadow(");
    shader_text_assert_lacks(&program, "light_");
    release(&program, &job);
}

static void mirrors_send_one_ray_on(void **state)
{
    struct scene_program program;
    struct job job;

    assemble(&program, &job, OBJECTS(OBJECT_JOB_BALL(OBJECT_JOB_MIRROR)), OBJECT_JOB_LIGHT ", " OBJECT_JOB_QUALITY);
    shader_text_assert_has(&program, "bool path_is_waiting");
    shader_text_assert_has(&program, "out vec4 paths");
    shader_text_assert_lacks(&program, "path_parked");
    shader_text_assert_lacks(&program, "fresnel");
    shader_text_assert_lacks(&program, "snell");
    shader_text_assert_lacks(&program, "rough_");
    shader_text_assert_lacks(&program, "random");
    shader_text_assert_lacks(&program, "light_");
    release(&program, &job);
}

static void glass_sends_two_rays_on(void **state)
{
    struct scene_program program;
    struct job job;

    assemble(&program, &job, OBJECTS(OBJECT_JOB_BALL(OBJECT_JOB_GLASS)), OBJECT_JOB_QUALITY);
    shader_text_assert_has(&program, "path_parked");
    shader_text_assert_has(&program, "fresnel_exact(");
    shader_text_assert_lacks(&program, "fresnel_schlick");
    shader_text_assert_lacks(&program, "surface_box");
    shader_text_assert_lacks(&program, "region_plane");
    shader_text_assert_lacks(&program, "random");
    release(&program, &job);
    assemble(&program, &job, OBJECTS(OBJECT_JOB_BALL(OBJECT_JOB_GLASS ", \"fresnel\": \"none\"" ROUGH)),
             OBJECT_JOB_QUALITY);
    shader_text_assert_lacks(&program, "path_parked");
    shader_text_assert_lacks(&program, "fresnel_exact");
    shader_text_assert_has(&program, "fresnel_none(");
    shader_text_assert_has(&program, "rough_normal(");
    shader_text_assert_has(&program, "random_start(");
    release(&program, &job);
}

// An absorbing interior needs no march; the lights of the floor do not make it take steps.
static void interiors_that_only_absorb_are_not_marched(void **state)
{
    struct scene_program program;
    struct job job;

    assemble(&program, &job,
             OBJECTS(OBJECT_JOB_FLOOR(OBJECT_JOB_GREY) ", " OBJECT_JOB_BALL(
                 OBJECT_JOB_GLASS ", \"interior\": {\"sigma_s\": 0, \"sigma_a\": 0.5}")),
             OBJECT_JOB_LIGHT ", " OBJECT_JOB_QUALITY);
    shader_text_assert_has(&program, "integrator_stretches(");
    shader_text_assert_has(&program, "transmittance_closed(");
    shader_text_assert_has(&program, "region == 2 ? span_meet(spans.medium_0, piece)");
    shader_text_assert_lacks(&program, "integrator_midpoint");
    release(&program, &job);
}

static const char *const materials[] = {
    OBJECT_JOB_GREY,
    "\"kind\": \"diffuse\", \"albedo\": [0.5, 0.2, 0.1], \"specular\": 0.3, \"fresnel\": \"schlick\"",
    OBJECT_JOB_GREY ", \"specular\": 1, \"fresnel\": \"none\"" ROUGH,
    OBJECT_JOB_MIRROR,
    "\"kind\": \"mirror\", \"reflectance\": [1, 0.5, 0.2]" ROUGH,
    OBJECT_JOB_GLASS,
    OBJECT_JOB_GLASS SMOKE,
    OBJECT_JOB_GLASS ", \"fresnel\": \"schlick\", \"f0\": 0.1, \"f90\": 0.9" SMOKE ROUGH,
    OBJECT_JOB_GLASS ", \"fresnel\": \"none\"",
};
enum { MATERIALS = sizeof materials / sizeof *materials };

static void assemble_combination(void **state, size_t index)
{
    static const char *const media[] = {"", FOG};
    static const char *const lights[] = {"", OBJECT_JOB_LIGHT ", "};
    static const char *const methods[] = {OBJECT_JOB_QUALITY,
                                          "\"quality\": {\"method\": \"equiangular\", \"points\": 8, \"samples\": 2}"};
    const char *first = materials[index % MATERIALS], *second = materials[index / MATERIALS % MATERIALS];
    size_t rest = index / MATERIALS / MATERIALS;
    struct scene_program program;
    struct job job;
    char scene[2048], others[512];

    snprintf(
        scene, sizeof scene,
        "%s\"objects\": [{\"kind\": \"box\", \"center\": [0, 0, 0], \"size\": [1, 1, 1], \"material\": {%s}},"
        " {\"kind\": \"union\", \"of\": [{\"kind\": \"plane\", \"point\": [0, 0, 0]}, {\"kind\": \"sphere\","
        " \"center\": [0, 1, 0], \"radius\": 0.5}, {\"kind\": \"box\", \"center\": [0, 0, 0], \"size\": [9, 1, 1]}],"
        " \"material\": {%s}}]",
        media[rest % 2], first, second);
    snprintf(others, sizeof others, "%s%s%s", lights[rest / 2 % 2], rest % 3 == 0 ? "" : "\"background\": [1, 0, 0], ",
             methods[rest / 4 % 2]);
    assemble(&program, &job, scene, others);
    shader_text_keep(state, &program, index);
    release(&program, &job);
}

static void every_combination_of_materials_is_valid_glsl(void **state)
{
    // Each pair of materials occurs once; the other settings alternate.
    for (size_t i = 0; i < (size_t)MATERIALS * MATERIALS; ++i)
        assemble_combination(state, i + (size_t)MATERIALS * MATERIALS * (i % 8));
    shader_text_assert_valid(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_objects_there_are_no_surfaces),
        cmocka_unit_test(diffuse_objects_end_rays),
        cmocka_unit_test(without_lights_diffuse_objects_are_black),
        cmocka_unit_test(mirrors_send_one_ray_on),
        cmocka_unit_test(glass_sends_two_rays_on),
        cmocka_unit_test(interiors_that_only_absorb_are_not_marched),
        cmocka_unit_test_setup_teardown(every_combination_of_materials_is_valid_glsl, temp_folder_create,
                                        temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
