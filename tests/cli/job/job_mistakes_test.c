// SPDX-License-Identifier: Apache-2.0
#include "cli/job/job_mistakes.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/job_text.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void assert_found(const char *document, const char *const expected[], size_t expected_count)
{
    struct error first = {0}, *found;
    struct job job;
    size_t count;

    assert_false(job_parse(&job, document, strlen(document), "/", &first));
    found = job_mistakes_find(document, &first, &count);
    for (size_t i = 0; i < expected_count; i++) {
        size_t k = 0;

        while (k < count && !strstr(found[k].message, expected[i]))
            k++;
        if (k == count) fail_msg("nothing says \"%s\"", expected[i]);
    }
    if (count != expected_count) fail_msg("%zu mistakes, the last: %s", count, found[count - 1].message);
    assert_string_equal(found[0].message, first.message);
    free(found);
}

static void each_member_tells_its_mistake(void **state)
{
    static const char *const expected[] = {
        "unknown key \"qualty\", did you mean \"quality\"?",
        "name: expected 1 to 128 printable bytes",
        "fps: expected",
        "camera.fov: expected",
        "camera: unknown key \"sutter\"",
        "lights[1].intensity: expected",
        "scene.media[1].sigma_s: expected",
        "scene.media[2].density.kind: ",
        "scene: unknown key \"mdia\"",
        "output.existing: expected one of",
        "resolution: expected",
        "quality.tolerance: expected a number from 0.0001 to 0.5, got 5, did you mean 0.05",
    };

    assert_found(
        "{\"version\":1,\"name\":\"\",\"frames\":\"1-9\",\"fps\":0,\"qualty\":7,\"camera\":{\"position\":[0,0,4],"
        "\"target\":[0,0,0],\"fov\":200,\"sutter\":1},\"lights\":[{\"kind\":\"sun\",\"intensity\":1,"
        "\"direction\":[0,1,0]},{\"kind\":\"point\",\"intensity\":-1,\"position\":[0,1,0]}],\"scene\":{\"mdia\":1,"
        "\"media\":[{\"sigma_s\":1,\"density\":{\"kind\":\"homogeneous\"}},{\"sigma_s\":-1,\"density\":{\"kind\":"
        "\"homogeneous\"}},{\"sigma_s\":1,\"density\":{\"kind\":\"clod\"}}]},\"output\":{\"path\":\"a/a.#.exr\","
        "\"existing\":\"keep\"},\"quality\":{\"tolerance\":5}}",
        expected, sizeof expected / sizeof expected[0]);
}

static void one_member_tells_several_mistakes(void **state)
{
    static const char *const expected[] = {
        "lights[0].intensity: expected",
        "lights[0].position[1]: expected a number",
        "scene.media[0]: unknown key \"sigma_t\"",
        "scene.media[0].density.octaves: expected",
        "scene.media[0].density.frequency: expected",
        "scene.media[0].density.bounds.radius: expected",
        "scene.media[0].sigma_a: expected",
        "scene.media[0].phase[0].g: expected",
        "scene.media[1].density.kind: expected one of",
        "scene.media[1].density.iterations: expected",
        "quality.step: expected",
        "quality: unknown key \"lightstep\", did you mean \"light_step\"?",
        "output.pixel: expected one of",
        "output.compression: expected one of",
    };

    assert_found(
        "{\"version\":1,\"name\":\"x\",\"frames\":\"1-9\",\"fps\":24,\"resolution\":[64,32],\"camera\":{\"position\":"
        "[0,0,4],\"target\":[0,0,0],\"fov\":40},\"lights\":[{\"kind\":\"point\",\"intensity\":-1,\"position\":"
        "[0,\"1\",0]}],\"scene\":{\"media\":[{\"sigma_s\":1,\"sigma_t\":2,\"sigma_a\":-2,\"phase\":[{\"g\":1}],"
        "\"density\":{\"kind\":\"noise\",\"frequency\":-2,\"octaves\":0,\"bounds\":{\"kind\":\"sphere\",\"radius\":0}}}"
        ","
        "{\"sigma_s\":1,\"density\":{\"kind\":\"fold_fractl\",\"iterations\":99,\"offset\":0.06,\"radius\":0.1,"
        "\"exponent\":1,\"scale\":10}}]},\"quality\":{\"method\":\"midpoint\",\"step\":-1,\"lightstep\":0.1},"
        "\"output\":"
        "{\"path\":\"a/a.#.exr\",\"pixel\":\"hlf\",\"compression\":\"lzw\"}}",
        expected, sizeof expected / sizeof expected[0]);
}

static void what_is_right_is_not_blamed(void **state)
{
    const char *const texts[] = {job_text_full, job_text_noise, job_text_fog,
                                 job_text_grid, job_text_glsl,  job_text_objects};
    static const char *const expected[] = {"version: expected 1, got 7"};

    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        char *text = strdup(texts[i]), *version = strstr(text, "\"version\":1");

        version[strlen("\"version\":")] = '7';
        assert_found(text, expected, 1);
        free(text);
    }
}

// Nobody knows what a method or a kind was to be, nor then what may stand beside it.
static void a_wrong_choice_blames_nothing_beside_it(void **state)
{
    static const char *const expected[] = {"lights[0].kind: expected one of", "quality.method: expected one of"};

    assert_found(
        "{\"version\":1,\"name\":\"x\",\"frames\":\"1-9\",\"fps\":24,\"resolution\":[64,32],\"camera\":{\"position\":"
        "[0,0,4],\"target\":[0,0,0],\"fov\":40},\"lights\":[{\"kind\":\"laser\",\"intensity\":1,\"direction\":"
        "[0,1,0]}],\"scene\":{\"media\":[{\"sigma_s\":1,\"density\":{\"kind\":\"homogeneous\"}}]},\"quality\":"
        "{\"method\":\"nonsense\",\"step\":0.1},\"output\":{\"path\":\"a/a.#.exr\"}}",
        expected, sizeof expected / sizeof expected[0]);
}

// A spot is at most as narrow inside as outside: what is wrong outside says nothing about that.
static void what_stands_beside_a_mistake_is_not_blamed(void **state)
{
    static const char *const expected[] = {"lights[0].outer: expected a number in (0, 90], got 91"};

    assert_found(
        "{\"version\":1,\"name\":\"x\",\"frames\":\"1-9\",\"fps\":24,\"resolution\":[64,32],\"camera\":{\"position\":"
        "[0,0,4],\"target\":[0,0,0],\"fov\":40},\"lights\":[{\"kind\":\"spot\",\"intensity\":1,\"position\":[0,2,0],"
        "\"direction\":[0,-1,0],\"inner\":20,\"outer\":91}],\"scene\":{\"media\":[{\"sigma_s\":1,\"density\":{\"kind\":"
        "\"homogeneous\",\"bounds\":{\"kind\":\"sphere\",\"radius\":1}}}]},\"output\":{\"path\":\"a/a.#.exr\"}}",
        expected, sizeof expected / sizeof expected[0]);
}

static void a_document_that_is_no_object_is_one_mistake(void **state)
{
    static const char *const expected[] = {"expected an object"};

    assert_found("[1,2]", expected, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_member_tells_its_mistake),
        cmocka_unit_test(one_member_tells_several_mistakes),
        cmocka_unit_test(what_is_right_is_not_blamed),
        cmocka_unit_test(a_wrong_choice_blames_nothing_beside_it),
        cmocka_unit_test(what_stands_beside_a_mistake_is_not_blamed),
        cmocka_unit_test(a_document_that_is_no_object_is_one_mistake),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
