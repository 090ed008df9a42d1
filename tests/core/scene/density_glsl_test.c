// SPDX-License-Identifier: Apache-2.0
#include "core/scene/density_rules.h"

#include "core/base/alloc.h"
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

#define PLACE "scene.media[0].density"

static void assert_edit_refused(const char *path, const char *value, const char *expected)
{
    job_expect_edit_refused(job_text_glsl, path, value, expected);
}

static void glsl_is_read(void **state)
{
    struct job job = job_expect(job_text_glsl);
    const struct scene_glsl *glsl = &job.scene.media[0].density.glsl, *unread = &job.scene.media[1].density.glsl;

    assert_string_equal(glsl->file, "/data/custom.glsl");
    assert_string_equal(glsl->source, "float density(vec3 p, float t)\n{\n    return 0.5 - length(p);\n}\n");
    assert_true(glsl->lipschitz == 1.0 && glsl->majorant == 4.0 && glsl->scale.value[0] == 2.0);
    assert_null(unread->source);
    assert_true(unread->lipschitz == 0.0 && unread->scale.value[0] == 1.0);
    assert_true(scene_density_is_sequence(&job.scene.media[0].density));
    job_finish(&job);
}

static void wrong_densities_are_refused_by_place(void **state)
{
    assert_edit_refused(PLACE ".bounds", NULL,
                        PLACE ".bounds: expected bounds, as the extent of GLSL code is unknown, got nothing");
    assert_edit_refused(PLACE ".lipschitz", "0", PLACE ".lipschitz: expected a number from 1e-09 to 1000000000, got 0");
    assert_edit_refused(PLACE ".majorant", "0", PLACE ".majorant: expected a number from 1e-09 to 1000000000, got 0");
    assert_edit_refused("quality", "{\"method\":\"tracking\",\"estimator\":\"ratio\"}",
                        "scene.media[1].density.majorant: expected an upper bound of density(), which the estimators "
                        "delta and ratio need, got nothing");
    assert_edit_refused(PLACE ".file", "\"a.#.glsl\"", PLACE ".file: expected one file, not one a frame");
    assert_edit_refused(PLACE, "{\"kind\":\"glsl\",\"bounds\":{\"kind\":\"sphere\",\"radius\":1}}",
                        PLACE ": expected file or source, got none of them");
    assert_edit_refused(PLACE ".source", "\"\"", PLACE ".source: expected 1 to 65536 bytes of GLSL, got 0");
}

static void directives_that_reach_out_are_refused_by_line(void **state)
{
    assert_edit_refused(PLACE ".source", "\"#version 450\\n\"",
                        PLACE ".source: custom.glsl:1: #version is not for densities");
    assert_edit_refused(PLACE ".source", "\"\\n\\n \\t# extension all : enable\"",
                        PLACE ".source: custom.glsl:3: #extension is not for densities");
    assert_edit_refused(PLACE ".source", "\"//\\r\\n#include \\\"a\\\"\"",
                        PLACE ".source: custom.glsl:2: #include is not for densities");
    assert_edit_refused(PLACE ".source", "\"#line 7\"", PLACE ".source: custom.glsl:1: #line is not for densities");
}

static void other_directives_are_the_users_own(void **state)
{
    char *text = json_edit_set(job_text_glsl, PLACE ".source", "\"#define R 1\\n// #version\\n#if R\\n#endif\"");
    struct job job = job_expect(text);

    job_finish(&job);
    free(text);
}

static void a_text_has_a_limit(void **state)
{
    char *source = xcalloc(1, 2 * SCENE_GLSL_SIZE_LIMIT + 3), *text;
    struct job job;

    memset(source + 1, ' ', SCENE_GLSL_SIZE_LIMIT);
    source[0] = source[1 + SCENE_GLSL_SIZE_LIMIT] = '"';
    text = json_edit_set(job_text_glsl, PLACE ".source", source);
    job = job_expect(text);
    job_finish(&job);
    free(text);
    source[1 + SCENE_GLSL_SIZE_LIMIT] = ' ';
    source[2 + SCENE_GLSL_SIZE_LIMIT] = '"';
    assert_edit_refused(PLACE ".source", source, PLACE ".source: expected 1 to 65536 bytes of GLSL, got 65537");
    for (int i = 0; i < SCENE_GLSL_LINE_LIMIT; i++)
        memcpy(source + 1 + 2 * i, "\\n", 2);
    strcpy(source + 1 + 2 * SCENE_GLSL_LINE_LIMIT, "\"");
    assert_edit_refused(PLACE ".source", source, PLACE ".source: expected at most 5000 lines");
    free(source);
}

static void elsewhere_only_whole_jobs_can_be_read(void **state)
{
    char *relative = json_edit_set(job_text_glsl, "scene.media[1].density.source", "\"float\"");
    char *absolute = json_edit_set(job_text_glsl, "scene.media[1].density.file", "\"/a.glsl\"");
    char *whole = json_edit_set(relative, "scene.media[1].density.file", NULL);

    job_expect_no_inputs(relative, "scene.media[1].density.file: expected an absolute path, got \"a.glsl\"");
    job_expect_no_inputs(absolute, "scene.media[1].density.source: expected the text of the file, got nothing");
    job_expect_no_inputs(whole, NULL);
    job_expect_no_inputs(job_text_grid, "scene.media[2].density.file: expected an absolute path, got \"still.nvdb\"");
    job_expect_no_inputs(job_text_noise, NULL);
    free(whole);
    free(absolute);
    free(relative);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(glsl_is_read),
        cmocka_unit_test(wrong_densities_are_refused_by_place),
        cmocka_unit_test(directives_that_reach_out_are_refused_by_line),
        cmocka_unit_test(other_directives_are_the_users_own),
        cmocka_unit_test(a_text_has_a_limit),
        cmocka_unit_test(elsewhere_only_whole_jobs_can_be_read),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
