// SPDX-License-Identifier: Apache-2.0
#include "tests/support/schema_agreement.h"

#include "core/base/alloc.h"
#include "core/scene/scene.h"
#include "tests/support/job_text.h"
#include "tests/support/json_edit.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void schema_and_code_agree_on_every_change_of_cloud(void **state)
{
    char *text = job_text_load("cloud.json");

    schema_agreement_check_places(text, "");
    free(text);
}

// The other values are those of cloud.json.
static void schema_and_code_agree_on_changes_of_a_tolerance(void **state)
{
    char *text = json_edit_set(job_text_full, "quality", "{\"method\":\"auto\",\"tolerance\":0.125,\"samples\":2}");

    schema_agreement_check_places(text, "quality");
    free(text);
}

static void schema_and_code_agree_on_changes_of_cloud_seeds_quality(void **state)
{
    char *text = job_text_load("cloud_seed.json");

    schema_agreement_check_places(text, "quality");
    free(text);
}

static void schema_and_code_agree_on_every_change_of_a_job_with_every_key(void **state)
{
    schema_agreement_check_places(job_text_full, "");
}

static void schema_and_code_agree_on_limits_of_counts(void **state)
{
    static const struct {
        const char *path, *element;
        size_t limit;
    } lists[] = {
        {"lights", "{\"kind\":\"point\",\"intensity\":1,\"position\":[1,1,1]}", SCENE_LIGHT_LIMIT},
        {"scene.media[0].phase", "{\"g\":0,\"weight\":0.125}", SCENE_LOBE_LIMIT},
        {"scene.media",
         "{\"density\":{\"kind\":\"fold_fractal\",\"iterations\":1,\"offset\":0,\"radius\":1,\"exponent\":1,\"scale\":"
         "1},"
         "\"sigma_s\":1}",
         SCENE_MEDIUM_LIMIT},
    };

    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
        char *list = xasprintf("[%s]", lists[i].element);

        for (size_t count = 1; count <= lists[i].limit + 1; count++) {
            char *longer = xasprintf("[%s,%s", lists[i].element, list + 1);
            char *text = json_edit_set(job_text_full, lists[i].path, list);
            struct schema_verdicts verdicts = schema_agreement_judge(text);

            if (count > lists[i].limit) assert_false(verdicts.code);
            schema_agreement_assert(text, lists[i].path);
            free(text);
            free(list);
            list = longer;
        }
        free(list);
    }
}

static void each_cross_rule_is_beyond_the_schema(void **state)
{
    for (const struct cross_rule *rule = schema_cross_rules; rule->name; rule++) {
        char *edited, *text = xstrdup(job_text_full);
        struct schema_verdicts verdicts;

        if (strncmp(rule->name, "the camera", 10) == 0 || strncmp(rule->name, "up is", 5) == 0) {
            edited = json_edit_set(text, "camera.target", "[0.25, 0, 0]");
            free(text);
            text = json_edit_set(edited, "camera.up", "[-0.25, 3, 0]");
            free(edited);
        }
        if (strncmp(rule->name, "half keeps", 10) == 0) {
            edited = json_edit_set(text, "output.pixel", "\"half\"");
            free(text);
            text = edited;
        }
        if (strncmp(rule->name, "a march", 7) == 0 || strncmp(rule->name, "riemann", 7) == 0) {
            edited = json_edit_set(text, "camera.clip", NULL);
            free(text);
            text = edited;
        }
        if (strncmp(rule->name, "equiangular is for the even", 27) == 0) {
            edited = json_edit_set(text, "quality", "{\"method\":\"equiangular\",\"points\":1}");
            free(text);
            text = edited;
        }
        if (strncmp(rule->name, "riemann", 7) == 0) {
            edited = text;
            text = json_edit_set(edited, "quality", "{\"method\":\"riemann\",\"step\":0.1,\"light_steps\":2}");
            free(edited);
        }
        edited = json_edit_set(text, rule->example.path, rule->example.value);
        verdicts = schema_agreement_judge(edited);
        if (!verdicts.schema || verdicts.code || schema_agreement_find_rule(verdicts.error.message) != rule)
            fail_msg("%s: schema %d, code %d: %s", rule->name, verdicts.schema, verdicts.code, verdicts.error.message);
        free(edited);
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(schema_and_code_agree_on_every_change_of_cloud),
        cmocka_unit_test(schema_and_code_agree_on_changes_of_cloud_seeds_quality),
        cmocka_unit_test(schema_and_code_agree_on_changes_of_a_tolerance),
        cmocka_unit_test(schema_and_code_agree_on_every_change_of_a_job_with_every_key),
        cmocka_unit_test(schema_and_code_agree_on_limits_of_counts),
        cmocka_unit_test(each_cross_rule_is_beyond_the_schema),
    };

    return cmocka_run_group_tests(tests, schema_agreement_load, schema_agreement_drop);
}
