// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_program.h"

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/job/job_json.h"
#include "tests/support/ball_job.h"
#include "tests/support/example_job.h"
#include "tests/support/folders.h"
#include "tests/support/shader_text.h"
#include "tests/support/temp_folder.h"
#include "worker/gl/gl_program.h"
#include "worker/scene/scene_inputs.h"

#include <glob.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

static const char *const lights[] = {
    "",
    "\"lights\": [{\"kind\": \"point\", \"intensity\": [1, 2, 3], \"position\": {\"orbit\": {\"center\": [0, 0, 0],"
    " \"radius\": 3, \"period\": 2}}}, {\"kind\": \"sun\", \"direction\": [0, -1, 0], \"intensity\": 2}],",
    "\"lights\": [{\"kind\": \"point\", \"falloff\": \"none\", \"intensity\": {\"start\": 1, \"rate\": 0.5},"
    " \"position\": [2, 1, 2]}],",
};
static const char *const media[] = {
    BALL_JOB_SIGMA_A_1,
    BALL_JOB_SIGMA_S_1,
    "\"sigma_s\": 0, \"sigma_a\": 0, \"emission\": [1, 0.5, 0]",
    ("\"sigma_s\": [1, 2, 3], \"sigma_a\": 0.5, \"emission\": 1, \"phase\": [{\"g\": 0.9, \"weight\": 0.25},"
     " {\"g\": {\"start\": 0, \"rate\": 0.01}, \"weight\": 0.5}, {\"g\": 0, \"weight\": 0.25}]"),
    "\"sigma_s\": 0, \"sigma_a\": 0",
};
static const char *const backgrounds[] = {"", "\"background\": 0.5,", "\"background\": [0, 0, 1],"};
static const char *const qualities[] = {BALL_JOB_MIDPOINT, BALL_JOB_RIEMANN};

static void assemble(struct scene_program *program, struct job *job, const char *medium, const char *rest)
{
    struct error error = {{0}};

    ball_job_parse(job, medium, rest);
    if (!scene_program_init(program, job, NULL, NULL, &error)) fail_msg("%s", error.message);
}

static void release(struct scene_program *program, struct job *job)
{
    scene_program_finish(program);
    job_finish(job);
}

static void a_scene_without_lights_has_no_shadow_code(void **state)
{
    struct scene_program program;
    struct job job;

    assemble(&program, &job, BALL_JOB_SIGMA_S_1, BALL_JOB_MIDPOINT);
    shader_text_assert_lacks(&program, "transmittance_");
    shader_text_assert_lacks(&program, "MediaColumn");
    shader_text_assert_lacks(&program, "phase");
    shader_text_assert_lacks(&program, "light_");
    shader_text_assert_lacks(&program, "LightSample");
    shader_text_assert_lacks(&program, "sigma_s");
    release(&program, &job);
}

static void a_light_that_nothing_scatters_adds_no_code(void **state)
{
    struct scene_program dark, lit;
    struct job dark_job, lit_job;

    assemble(&dark, &dark_job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    assemble(&lit, &lit_job, BALL_JOB_SIGMA_A_1, BALL_JOB_POINT_LIGHT ", " BALL_JOB_MIDPOINT);
    assert_string_equal(dark.fragment, lit.fragment);
    assert_string_equal(dark.hash, lit.hash);
    release(&dark, &dark_job);
    release(&lit, &lit_job);
}

static void what_is_not_asked_for_is_not_written(void **state)
{
    struct scene_program program;
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    job.output.has_depth = job.output.has_transmittance = false;
    assert_true(scene_program_init(&program, &job, NULL, NULL, NULL));
    shader_text_assert_lacks(&program, "depth_half");
    shader_text_assert_lacks(&program, "out float depth");
    shader_text_assert_lacks(&program, "out vec4 transmittance");
    shader_text_assert_lacks(&program, "emission");
    shader_text_assert_lacks(&program, "background");
    shader_text_assert_has(&program,
                           "uniform FrameUniforms {\n    float quality_step;\n    float quality_min_transmittance;\n}");
    release(&program, &job);
}

static void lobes_that_weigh_nothing_or_lean_nowhere_cost_nothing(void **state)
{
    struct scene_program program;
    struct job job;

    assemble(&program, &job, BALL_JOB_SIGMA_S_1 ", \"phase\": [{\"g\": 0.7, \"weight\": 0}, {\"g\": 0, \"weight\": 1}]",
             BALL_JOB_POINT_LIGHT ", " BALL_JOB_MIDPOINT);
    shader_text_assert_lacks(&program, "henyey_greenstein");
    shader_text_assert_lacks(&program, "medium_0_lobe_0");
    shader_text_assert_lacks(&program, "medium_0_lobe_1_g");
    shader_text_assert_has(&program, "return medium_0_lobe_1_weight * phase_isotropic();");
    release(&program, &job);
}

static void emission_alone_has_no_extinction(void **state)
{
    struct scene_program program;
    struct job job;

    assemble(&program, &job, media[2], BALL_JOB_POINT_LIGHT ", " BALL_JOB_MIDPOINT);
    shader_text_assert_lacks(&program, "sigma_t");
    shader_text_assert_lacks(&program, "gathered.transmittance");
    shader_text_assert_lacks(&program, "segment(");
    shader_text_assert_has(&program, "medium_0_emission");
    release(&program, &job);
}

// The ball's medium with another density.
static void assemble_density(struct scene_program *program, struct job *job, const char *density, const char *medium,
                             const char *rest)
{
    struct error error = {{0}};
    char text[2048];

    snprintf(text, sizeof text,
             "{\"version\": 1, \"name\": \"even\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [48, 32],"
             " \"camera\": {\"position\": [0, 0, 4], \"target\": [0, 0, 0], \"up\": [0, 1, 0], \"fov\": 40, \"clip\": "
             "[1, 8]}, \"scene\": {\"media\": [{\"density\": {%s}, %s}]},"
             " \"output\": {\"path\": \"even.####.exr\", \"aovs\": [\"Z\", \"transmittance\"]}, %s}",
             density, medium, rest);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    if (!scene_program_init(program, job, NULL, NULL, &error)) fail_msg("%s", error.message);
}

#define EVEN_BALL "\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 1"
#define EQUIANGULAR "\"quality\": {\"method\": \"equiangular\", \"points\": 8}"

static void even_media_without_light_are_not_marched(void **state)
{
    struct scene_program program;
    struct job job;

    assemble_density(&program, &job, EVEN_BALL "}", BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    shader_text_assert_has(&program, "integrator_stretches(");
    shader_text_assert_has(&program, "#define Spectrum float");
    shader_text_assert_lacks(&program, "#define Spectrum vec3");
    shader_text_assert_lacks(&program, "march_was_cut");
    shader_text_assert_lacks(&program, "MARCH_LIMIT");
    shader_text_assert_lacks(&program, "span_has(spans");
    shader_text_assert_lacks(&program, "_share");
    shader_text_assert_lacks(&program, "smoothstep");
    release(&program, &job);
}

static void even_media_cast_shadows_without_a_march(void **state)
{
    struct scene_program program;
    struct job job;

    assemble_density(&program, &job, EVEN_BALL "}", BALL_JOB_SIGMA_S_1, BALL_JOB_POINT_LIGHT ", " BALL_JOB_MIDPOINT);
    shader_text_assert_has(&program, "transmittance_closed(");
    shader_text_assert_lacks(&program, "transmittance_midpoint(");
    shader_text_assert_lacks(&program, "media_column_add");
    shader_text_assert_has(&program, "integrator_midpoint(");
    release(&program, &job);
    assemble_density(&program, &job, EVEN_BALL "}", BALL_JOB_SIGMA_S_1, BALL_JOB_POINT_LIGHT ", " EQUIANGULAR);
    shader_text_assert_has(&program, "placement_angle_at(");
    shader_text_assert_lacks(&program, "placement_transmittance_at(");
    shader_text_assert_lacks(&program, "march_was_cut");
    release(&program, &job);
}

static void jittered_marches_draw_and_stretches_do_not(void **state)
{
    static const char jittered[] = "\"quality\": {\"method\": \"jittered\", \"step\": 0.05, \"light_step\": 0.05}";
    struct scene_program program;
    struct job job;
    char rest[512];

    snprintf(rest, sizeof rest, BALL_JOB_POINT_LIGHT ", %s", jittered);
    assemble(&program, &job, BALL_JOB_SIGMA_S_1, rest);
    shader_text_assert_has(&program, "integrator_jittered(IntegratorJittered(quality_step)");
    shader_text_assert_has(&program, "transmittance_jittered(TransmittanceJittered(quality_light_step)");
    shader_text_assert_has(&program, "random_start(pixel");
    shader_text_assert_lacks(&program, "_midpoint(");
    release(&program, &job);
    assemble_density(&program, &job, EVEN_BALL "}", BALL_JOB_SIGMA_A_1, jittered);
    shader_text_assert_has(&program, "integrator_stretches(");
    shader_text_assert_lacks(&program, "random_");
    release(&program, &job);
}

static void a_falloff_alone_is_smoothed(void **state)
{
    struct scene_program program;
    struct job job;

    assemble_density(&program, &job, EVEN_BALL ", \"falloff\": 0.2}", BALL_JOB_SIGMA_S_1,
                     BALL_JOB_POINT_LIGHT ", " BALL_JOB_MIDPOINT);
    shader_text_assert_has(&program, "smoothstep");
    shader_text_assert_has(&program, "field.medium_0_share * medium_0_density(");
    shader_text_assert_has(&program, "transmittance_midpoint(");
    release(&program, &job);
}

static void a_medium_without_density_costs_nothing(void **state)
{
    struct scene_program program;
    struct job job;

    assemble_density(&program, &job, EVEN_BALL "}, \"scale\": 0", BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    shader_text_assert_lacks(&program, "medium_0");
    shader_text_assert_lacks(&program, "region_");
    shader_text_assert_lacks(&program, "camera_");
    release(&program, &job);
}

static void rayleigh_is_there_when_a_lobe_is(void **state)
{
    struct scene_program program;
    struct job job;

    assemble(&program, &job, BALL_JOB_SIGMA_S_1 ", \"phase\": [{\"kind\": \"rayleigh\"}]",
             BALL_JOB_POINT_LIGHT ", " BALL_JOB_MIDPOINT);
    shader_text_assert_has(&program, "phase_rayleigh(dot(incoming, outgoing))");
    shader_text_assert_lacks(&program, "henyey_greenstein");
    release(&program, &job);
}

static void only_what_moves_is_a_uniform(void **state)
{
    struct scene_program program;
    struct job job;
    float bytes[64];

    example_job_load(&job, "cloud");
    assert_true(scene_program_init(&program, &job, NULL, NULL, NULL));
    shader_text_assert_has(&program, "    mat3 medium_0_rotation;\n    vec3 light_0_position;\n    float "
                                     "quality_step;\n    float quality_light_step;\n    float "
                                     "quality_min_transmittance;\n} frame;");
    shader_text_assert_has(&program, "const float medium_0_offset = 0.0599999987;");
    assert_int_equal(program.uniforms.size_bytes, 80);
    assert_true(frame_uniforms_pack(&program.uniforms, &(struct frame_moment){.time = 2}, bytes, NULL));
    // -0.4 and -0.2 rad after two seconds; the second column of Ry Rx, then the light.
    assert_true(bytes[4] == (float)(sin(-0.2) * sin(-0.4)));
    assert_true(bytes[5] == (float)cos(-0.4));
    assert_true(bytes[12] == (float)(1.5 * sin(3.1 * 0.2 * 2 + 0.2)));
    release(&program, &job);
}

static void a_moving_value_out_of_range_is_refused_with_its_time(void **state)
{
    struct error error = {{0}};
    struct scene_program program;
    struct job job;
    float bytes[64];

    assemble(&program, &job, media[3],
             "\"lights\": [{\"kind\": \"sun\", \"direction\": [0, -1, 0], \"intensity\": 2}], " BALL_JOB_MIDPOINT);
    assert_true(frame_uniforms_pack(&program.uniforms, &(struct frame_moment){.time = 50}, bytes, &error));
    assert_false(frame_uniforms_pack(&program.uniforms, &(struct frame_moment){.time = 150}, bytes, &error));
    assert_non_null(strstr(error.message, "phase.g"));
    assert_non_null(strstr(error.message, "got 1.5 at t = 150 s"));
    release(&program, &job);
}

static void each_module_is_emitted_once(void **state)
{
    struct scene_program program;
    struct job job;
    char rest[1024];

    snprintf(rest, sizeof rest, "%s%s", lights[1], BALL_JOB_MIDPOINT);
    assemble(&program, &job, media[3], rest);
    for (size_t i = 1; i < program.module_count; ++i) {
        char line[32];
        const char *first;

        snprintf(line, sizeof line, "#line %zu %zu\n", i * SHADER_ASSEMBLY_LINE_STRIDE + 1, i);
        first = strstr(program.fragment, line);
        assert_non_null(first);
        assert_null(strstr(first + 1, line));
        for (size_t k = 0; k < i; ++k)
            assert_string_not_equal(program.module_names[i], program.module_names[k]);
    }
    release(&program, &job);
}

static void generated_lines_are_those_of_the_whole_text(void **state)
{
    struct scene_program program;
    struct job job;
    size_t line = 1, found = 0;

    assemble(&program, &job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    for (const char *at = program.fragment; at; at = strchr(at, '\n'), at = at ? at + 1 : NULL, ++line) {
        size_t named = 0, module = 1;

        if (sscanf(at, "#line %zu %zu", &named, &module) == 2 && module == 0) {
            assert_int_equal(named, line + 1);
            ++found;
        }
    }
    assert_true(found > 1);
    release(&program, &job);
}

static void every_example_is_valid_glsl(void **state)
{
    glob_t found;

    assert_int_equal(glob(PROJECT_ROOT "/jobs/*.json", 0, NULL, &found), 0);
    for (size_t i = 0; i < found.gl_pathc; ++i) {
        char name[256];
        struct scene_inputs inputs = {0};
        struct scene_program program;
        struct error error = {{0}};
        struct job job;

        snprintf(name, sizeof name, "%s", strrchr(found.gl_pathv[i], '/') + 1);
        *strrchr(name, '.') = '\0';
        if (strcmp(name, "schema") == 0) continue;
        example_job_load(&job, name);
        if (scene_inputs_open(&inputs, &job, frame_range_at(&job.frames, 0), NULL, NULL, &error)) {
            if (!scene_program_init(&program, &job, &inputs, NULL, &error)) fail_msg("%s", error.message);
            shader_text_keep(state, &program, i);
            scene_program_finish(&program);
        } else {
            print_message("without %s: %s\n", name, error.message);
        }
        scene_inputs_finish(&inputs);
        job_finish(&job);
    }
    shader_text_assert_valid(state);
    globfree(&found);
}

static void every_combination_of_features_is_valid_glsl(void **state)
{
    for (size_t i = 0; i < 5 * 3 * 3 * 2 * 2; ++i) {
        struct scene_program program;
        struct job job;
        char rest[1024];

        snprintf(rest, sizeof rest, "%s%s%s", lights[i / 5 % 3], backgrounds[i / 15 % 3], qualities[i / 45 % 2]);
        ball_job_parse(&job, media[i % 5], rest);
        job.output.has_depth = job.output.has_transmittance = i / 90 == 0;
        assert_true(scene_program_init(&program, &job, NULL, NULL, NULL));
        shader_text_keep(state, &program, i);
        release(&program, &job);
    }
    shader_text_assert_valid(state);
}

static void every_region_and_method_is_valid_glsl(void **state)
{
    static const char *const densities[] = {
        "\"kind\": \"homogeneous\"",
        EVEN_BALL "}",
        "\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"box\", \"center\": [0, 0, 0], \"size\": [1, 2, 3]}",
        ("\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"slab\", \"center\": [0, 0, 0], \"thickness\": 1,"
         " \"normal\": {\"start\": [0, 1, 0], \"rate\": [0.1, 0, 0]}}"),
        EVEN_BALL ", \"falloff\": 0.5}",
        ("\"kind\": \"fold_fractal\", \"iterations\": 2, \"offset\": 0, \"radius\": 1, \"exponent\": 1, \"scale\": 1,"
         " \"bounds\": {\"kind\": \"box\", \"center\": [0, 0, 0], \"size\": [1, 2, 3], \"falloff\": 0.1}"),
    };
    static const char *const methods[] = {BALL_JOB_MIDPOINT, BALL_JOB_RIEMANN, EQUIANGULAR};

    for (size_t i = 0; i < 6 * 3 * 5 * 3; ++i) {
        size_t density = i % 6, method = i / 90;
        struct scene_program program;
        struct job job;
        char rest[1024];

        // Equiangular needs even media, and a Riemann sum an end towards the sun.
        if ((method == 2 && density > 3) || (method == 1 && (density == 0 || density == 3))) continue;
        snprintf(rest, sizeof rest, "%s%s", lights[i / 6 % 3], methods[method]);
        assemble_density(&program, &job, densities[density], media[i / 18 % 5], rest);
        shader_text_keep(state, &program, i);
        release(&program, &job);
    }
    shader_text_assert_valid(state);
}

static void a_module_folder_overrides_what_it_has(void **state)
{
    static const char text[] = "// Mine.\nstruct RegionSphere { vec3 center; float radius; };\n";
    struct scene_program program;
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_A_1, BALL_JOB_MIDPOINT);
    assert_int_equal(mkdir(temp_folder_path(state, "region"), 0700), 0);
    assert_true(file_write_atomic(temp_folder_path(state, "region/sphere.glsl"), text, sizeof text - 1, NULL));
    assert_true(scene_program_init(&program, &job, NULL, *state, NULL));
    shader_text_assert_has(&program, "// Mine.");
    shader_text_assert_has(&program, "density_fold_fractal_at");
    release(&program, &job);
}

// The ball is 2 m wide. Walks have a grid of their own for each light, since midpoint marches to it.
static void walks_see_as_much_detail_as_the_march(void **state)
{
    static const struct {
        double light_step;
        int cells;
    } cases[] = {{0.5, 48}, {0.05, 48}, {0.03, 64}, {0.02, 96}, {0.001, 192}};
    struct scene_program program;
    struct job job;

    (void)state;
    ball_job_parse(&job, BALL_JOB_SIGMA_S_1, BALL_JOB_POINT_LIGHT ", " BALL_JOB_MIDPOINT);
    job.scene.orders = SCENE_ORDERS_ALL;
    job.quality.scatter_grid = 8;
    job.quality.paths = 4;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        job.quality.light_step = cases[i].light_step;
        assert_true(scene_program_init(&program, &job, NULL, NULL, NULL));
        assert_int_equal(program.walked->quality.light_grid, cases[i].cells);
        scene_program_finish(&program);
    }
    // Grids of two lights together are no larger than that of one.
    job.scene.lights[1] = job.scene.lights[0];
    job.scene.light_count = 2;
    assert_true(scene_program_init(&program, &job, NULL, NULL, NULL));
    assert_int_equal(program.walked->quality.light_grid, 128);
    scene_program_finish(&program);
    job.scene.light_count = 1;
    job_finish(&job);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scene_without_lights_has_no_shadow_code),
        cmocka_unit_test(a_light_that_nothing_scatters_adds_no_code),
        cmocka_unit_test(what_is_not_asked_for_is_not_written),
        cmocka_unit_test(lobes_that_weigh_nothing_or_lean_nowhere_cost_nothing),
        cmocka_unit_test(emission_alone_has_no_extinction),
        cmocka_unit_test(even_media_without_light_are_not_marched),
        cmocka_unit_test(even_media_cast_shadows_without_a_march),
        cmocka_unit_test(jittered_marches_draw_and_stretches_do_not),
        cmocka_unit_test(a_falloff_alone_is_smoothed),
        cmocka_unit_test(a_medium_without_density_costs_nothing),
        cmocka_unit_test(rayleigh_is_there_when_a_lobe_is),
        cmocka_unit_test(only_what_moves_is_a_uniform),
        cmocka_unit_test(a_moving_value_out_of_range_is_refused_with_its_time),
        cmocka_unit_test(each_module_is_emitted_once),
        cmocka_unit_test(generated_lines_are_those_of_the_whole_text),
        cmocka_unit_test_setup_teardown(every_example_is_valid_glsl, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(every_combination_of_features_is_valid_glsl, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(every_region_and_method_is_valid_glsl, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test(walks_see_as_much_detail_as_the_march),
        cmocka_unit_test_setup_teardown(a_module_folder_overrides_what_it_has, temp_folder_create, temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
