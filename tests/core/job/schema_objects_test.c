// A program of its own beside schema_test: the two run at the same time.
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

#include <cmocka.h>

static void schema_and_code_agree_on_every_change_of_objects(void **state)
{
    schema_agreement_check_places(job_text_objects, "scene.objects");
}

static void schema_and_code_agree_on_every_change_of_paths(void **state)
{
    schema_agreement_check_places(job_text_objects, "quality");
}

static void schema_and_code_agree_on_limits_of_objects(void **state)
{
    static const char object[] =
        "{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1,\"material\":{\"kind\":\"mirror\"}}";
    static const char shape[] = "{\"kind\":\"box\",\"center\":[0,0,0],\"size\":[1,1,1]}";
    char *objects = xasprintf("[%s]", object), *shapes = xasprintf("[%s]", shape);

    for (size_t count = 1; count <= SCENE_SHAPE_LIMIT + 1; count++) {
        char *longer = xasprintf("[%s,%s", object, objects + 1), *more = xasprintf("[%s,%s", shape, shapes + 1);
        char *scene =
            xasprintf("{\"objects\":[{\"kind\":\"union\",\"of\":%s,\"material\":{\"kind\":\"mirror\"}}]}", shapes);
        char *text = json_edit_set(job_text_objects, "scene.objects", objects);
        char *one = json_edit_set(job_text_objects, "scene", scene);

        assert_int_equal(schema_agreement_judge(text).code, count <= SCENE_OBJECT_LIMIT);
        schema_agreement_assert(text, "scene.objects");
        assert_int_equal(schema_agreement_judge(one).code, count <= SCENE_SHAPE_LIMIT);
        schema_agreement_assert(one, "scene.objects[0].of");
        free(one);
        free(text);
        free(scene);
        free(objects);
        free(shapes);
        objects = longer;
        shapes = more;
    }
    free(objects);
    free(shapes);
}

// Rules that changes of a single value do not reach.
static void schema_and_code_agree_on_keys_that_join(void **state)
{
    static const char *const edits[][2] = {
        {"scene.objects[4].of", "[{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1}]"},
        {"scene.objects[0].material", "{\"kind\":\"diffuse\",\"albedo\":1,\"roughness\":0.5}"},
        {"scene.objects[0].material", "{\"kind\":\"diffuse\",\"albedo\":1,\"specular\":1,\"f0\":0.5}"},
        {"scene.objects[0].material", "{\"kind\":\"diffuse\",\"specular\":1}"},
        {"scene.objects[1].material.interior", "{\"density\":{\"kind\":\"grid\",\"file\":\"a.nvdb\"},"
                                               "\"blackbody\":{\"grid\":\"t\",\"kelvin\":1}}"},
        {"scene.objects[1].material.interior", "{\"blackbody\":{\"grid\":\"t\",\"kelvin\":1}}"},
        {"scene.objects[1].material.interior", "{\"phase\":[{\"g\":0}]}"},
    };

    for (size_t i = 0; i < sizeof edits / sizeof edits[0]; i++) {
        char *text = json_edit_set(job_text_objects, edits[i][0], edits[i][1]);

        schema_agreement_assert(text, edits[i][1]);
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(schema_and_code_agree_on_every_change_of_objects),
        cmocka_unit_test(schema_and_code_agree_on_every_change_of_paths),
        cmocka_unit_test(schema_and_code_agree_on_limits_of_objects),
        cmocka_unit_test(schema_and_code_agree_on_keys_that_join),
    };

    return cmocka_run_group_tests(tests, schema_agreement_load, schema_agreement_drop);
}
