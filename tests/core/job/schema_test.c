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

static void schema_and_code_agree_on_changes_of_lights_and_paths(void **state)
{
    static const char even[] = "{\"kind\":\"dome\",\"radiance\":{\"start\":[1,1,1],\"rate\":[1,0,0]},\"visible\":true}";
    static const char gradient[] =
        "{\"kind\":\"dome\",\"gradient\":{\"along\":1,\"against\":[0,1,2],\"axis\":[1,0,0]}}";
    static const char march[] =
        "{\"method\":\"midpoint\",\"step\":0.1,\"light_step\":0.1,\"scatter_grid\":16,\"paths\":9}";
    char *text = json_edit_set(job_text_paths, "quality", march);

    schema_agreement_check_places(job_text_paths, "lights");
    schema_agreement_check_places(job_text_paths, "scene.scattering");
    schema_agreement_check_places(job_text_paths, "quality");
    schema_agreement_check_places(text, "quality");
    free(text);
    text =
        json_edit_set(job_text_paths, "quality", "{\"method\":\"paths\",\"paths\":64,\"light_grid\":32,\"step\":0.1}");
    schema_agreement_check_places(text, "quality");
    free(text);
    text = json_edit_set(job_text_paths, "lights[2]", even);
    schema_agreement_check_places(text, "lights[2]");
    free(text);
    text = json_edit_set(job_text_paths, "lights[2]", gradient);
    schema_agreement_check_places(text, "lights[2]");
    free(text);
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

static void set(char **text, const char *path, const char *value)
{
    char *edited = json_edit_set(*text, path, value);

    free(*text);
    *text = edited;
}

static bool begins(const struct cross_rule *rule, const char *words)
{
    return strncmp(rule->name, words, strlen(words)) == 0;
}

// A job with every key that breaks the rule after one more edit. Owned by the caller.
static char *text_for(const struct cross_rule *rule)
{
    char *text = xstrdup(job_text_full);

    if (begins(rule, "the camera") || begins(rule, "up is")) {
        set(&text, "camera.target", "[0.25, 0, 0]");
        set(&text, "camera.up", "[-0.25, 3, 0]");
    }
    if (begins(rule, "half keeps")) set(&text, "output.pixel", "\"half\"");
    if (begins(rule, "a march") || begins(rule, "riemann")) set(&text, "camera.clip", NULL);
    if (begins(rule, "equiangular is for the even")) set(&text, "quality", "{\"method\":\"equiangular\",\"points\":1}");
    if (begins(rule, "riemann") || begins(rule, "methods of one order"))
        set(&text, "quality", "{\"method\":\"riemann\",\"step\":0.1,\"light_steps\":2}");
    if (begins(rule, "a box")) set(&text, "quality", "{\"method\":\"equiangular\",\"points\":1,\"scatter_grid\":8}");
    return text;
}

static void each_cross_rule_is_beyond_the_schema(void **state)
{
    for (const struct cross_rule *rule = schema_cross_rules; rule->name; rule++) {
        char *text;
        struct schema_verdicts verdicts;

        if (!rule->example.path) continue;
        text = text_for(rule);
        set(&text, rule->example.path, rule->example.value);
        verdicts = schema_agreement_judge(text);
        if (!verdicts.schema || verdicts.code || schema_agreement_find_rule(verdicts.error.message) != rule)
            fail_msg("%s: schema %d, code %d: %s", rule->name, verdicts.schema, verdicts.code, verdicts.error.message);
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
        cmocka_unit_test(schema_and_code_agree_on_changes_of_lights_and_paths),
        cmocka_unit_test(schema_and_code_agree_on_limits_of_counts),
        cmocka_unit_test(each_cross_rule_is_beyond_the_schema),
    };

    return cmocka_run_group_tests(tests, schema_agreement_load, schema_agreement_drop);
}
