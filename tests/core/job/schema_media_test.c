// A program of its own beside schema_test: the two run at the same time.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "core/scene/file_format.h"
#include "tests/support/job_text.h"
#include "tests/support/json_edit.h"
#include "tests/support/schema_agreement.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

static void check_text(const char *text)
{
    schema_agreement_check_places(text, "camera.shutter");
    schema_agreement_check_places(text, "scene");
    schema_agreement_check_places(text, "quality");
}

static void schema_and_code_agree_on_every_change_of_noise(void **state)
{
    check_text(job_text_noise);
}

static void schema_and_code_agree_on_every_change_of_cached(void **state)
{
    char *text = json_edit_set(job_text_noise, "quality",
                               "{\"method\":\"cached\",\"step\":0.05,\"light_grid\":64,\"depth_step\":0.1,\"density_"
                               "grid\":32,\"min_transmittance\":0.01,"
                               "\"samples\":2}");

    schema_agreement_check_places(text, "quality");
    free(text);
}

static void schema_and_code_agree_on_every_change_of_fog(void **state)
{
    check_text(job_text_fog);
}

static void schema_and_code_agree_on_every_change_of_grid(void **state)
{
    check_text(job_text_grid);
}

static void schema_and_code_agree_on_every_change_of_glsl(void **state)
{
    check_text(job_text_glsl);
}

// The patterns of names in the schema have the endings too.
static void schema_and_code_take_files_of_every_format(void **state)
{
    for (size_t i = 0; i < file_format_count; i++) {
        bool is_image = file_formats[i].content == FILE_IMAGE;
        char *value =
            xasprintf(is_image ? "\"a%s\"" : "{\"sigma_a\":1,\"density\":{\"kind\":\"grid\",\"file\":\"a%s\"}}",
                      file_formats[i].ending);
        char *text = is_image ? json_edit_set(job_text_objects, "scene.objects[3].material.texture.file", value)
                              : json_edit_set(job_text_grid, "scene.media[2]", value);
        struct schema_verdicts verdicts = schema_agreement_judge(text);

        if (!verdicts.schema || !verdicts.code)
            fail_msg("%s: schema %d, code %d: %s", file_formats[i].ending, verdicts.schema, verdicts.code,
                     verdicts.error.message);
        free(text);
        free(value);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(schema_and_code_agree_on_every_change_of_noise),
        cmocka_unit_test(schema_and_code_agree_on_every_change_of_cached),
        cmocka_unit_test(schema_and_code_agree_on_every_change_of_fog),
        cmocka_unit_test(schema_and_code_agree_on_every_change_of_grid),
        cmocka_unit_test(schema_and_code_agree_on_every_change_of_glsl),
        cmocka_unit_test(schema_and_code_take_files_of_every_format),
    };

    return cmocka_run_group_tests(tests, schema_agreement_load, schema_agreement_drop);
}
