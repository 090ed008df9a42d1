// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_json.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/job/job.h"
#include "core/job/job_check.h"
#include "tests/support/folders.h"
#include "tests/support/job_expect.h"
#include "tests/support/job_text.h"
#include "tests/support/json_edit.h"

#include <glob.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void assert_edit_refused(const char *path, const char *value, const char *expected)
{
    job_expect_edit_refused(job_text_full, path, value, expected);
}

static void cloud_is_read_in_full(void **state)
{
    char *text = job_text_load("cloud.json");
    struct job job = job_expect(text);

    assert_string_equal(job.name, "cloud");
    assert_int_equal(frame_range_count(&job.frames), 240);
    assert_int_equal(job.fps_numerator, 24);
    assert_int_equal(job.fps_denominator, 1);
    assert_true(job.width_px == 1920 && job.height_px == 1080);
    assert_int_equal(job.quality.method, JOB_METHOD_AUTO);
    assert_true(job.quality.tolerance == 0.01);
    assert_string_equal(job.output.path.folder, "cloud");
    assert_string_equal(job.output.path.prefix, "cloud.");
    assert_int_equal(job.output.pixel, JOB_PIXEL_HALF);
    assert_int_equal(job.output.compression, JOB_COMPRESSION_ZIP);
    assert_true(job.output.has_depth && job.output.has_transmittance);
    assert_int_equal(job.output.existing, JOB_EXISTING_VERIFY);
    assert_int_equal(job.priority, 50);
    assert_int_equal(job.scene.medium_count, 1);
    assert_int_equal(job.scene.light_count, 1);
    assert_int_equal(strlen(job.hash), HASH_TEXT_SIZE - 1);
    job_finish(&job);
    free(text);
}

static void cloud_seed_is_read_in_full(void **state)
{
    char *text = job_text_load("cloud_seed.json");
    struct job job = job_expect(text);

    assert_int_equal(job.quality.method, JOB_METHOD_RIEMANN);
    assert_int_equal(job.quality.light_steps, 16);
    assert_true(job.quality.step == 0.01 && job.quality.min_transmittance == 0.01);
    assert_true(job.scene.camera.mirror);
    assert_int_equal(job.output.pixel, JOB_PIXEL_FLOAT);
    assert_false(job.output.has_depth || job.output.has_transmittance);
    job_finish(&job);
    free(text);
}

static void every_example_is_taken(void **state)
{
    glob_t examples;

    assert_int_equal(glob(PROJECT_ROOT "/jobs/*.json", 0, NULL, &examples), 0);
    assert_true(examples.gl_pathc > 2);
    for (size_t i = 0; i < examples.gl_pathc; i++) {
        const char *name = strrchr(examples.gl_pathv[i], '/') + 1;
        struct error error = {0};
        struct job job;
        char *text;

        if (strcmp(name, "schema.json") == 0) continue;
        text = job_text_load(name);
        if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s: %s", name, error.message);
        job_finish(&job);
        free(text);
    }
    globfree(&examples);
}

static void the_first_job_of_the_documentation_is_taken(void **state)
{
    static const char opening[] = "```json\n", closing[] = "```";
    char *page, *start, *end;
    size_t length;
    struct job job;

    assert_true(file_read_text(PROJECT_ROOT "/docs/job_format.md", JOB_DOCUMENT_LIMIT, &page, &length, NULL));
    start = strstr(page, opening);
    assert_non_null(start);
    start += strlen(opening);
    end = strstr(start, closing);
    assert_non_null(end);
    *end = '\0';
    job = job_expect(start);
    job_finish(&job);
    free(page);
}

static void frame_times_are_offset_plus_frame_over_fps(void **state)
{
    static const struct {
        const char *fps;
        int64_t numerator, denominator;
    } rates[] = {{"24", 24, 1},     {"23.976", 2997, 125}, {"[24000,1001]", 24000, 1001},
                 {"[50,2]", 25, 1}, {"0.5", 1, 2},         {"0.000001", 1, 1000000},
                 {"1000", 1000, 1}, {"29.97", 2997, 100},  {"[1,1e9]", 1, 1000000000}};

    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        char *text = json_edit_set(job_text_full, "fps", rates[i].fps);
        char *still = json_edit_set(text, "camera.fov", "40");
        char *plain = json_edit_set(still, "scene", NULL);
        struct job job = job_expect(plain);

        assert_int_equal(job.fps_numerator, rates[i].numerator);
        assert_int_equal(job.fps_denominator, rates[i].denominator);
        assert_true(job_frame_time(&job, 0) == 0.5);
        assert_true(job_frame_time(&job, 9) == 0.5 + 9.0 * (double)rates[i].denominator / (double)rates[i].numerator);
        job_finish(&job);
        free(plain);
        free(still);
        free(text);
    }
}

static void time_span_holds_all_frames(void **state)
{
    char *text = json_edit_set(job_text_full, "frames", "\"30-11x5,100,3\"");
    struct job job = job_expect(text);
    struct timeline_span span = job_time_span(&job);

    assert_true(span.first == job_frame_time(&job, 3));
    assert_true(span.last == job_frame_time(&job, 100));
    job_finish(&job);
    free(text);
}

static void absent_keys_have_their_defaults(void **state)
{
    struct job job = job_expect("{\"version\":1,\"name\":\"x\",\"frames\":\"3\",\"fps\":24,\"resolution\":[2,1],"
                                "\"camera\":{\"position\":[0,0,1],\"target\":[0,0,0],\"fov\":50},"
                                "\"quality\":{\"method\":\"midpoint\",\"step\":1,\"light_step\":1},"
                                "\"output\":{\"path\":\"#.exr\"}}");

    assert_true(job.time_offset == 0.0);
    assert_int_equal(job.priority, JOB_PRIORITY_DEFAULT);
    assert_int_equal(job.output.compression, JOB_COMPRESSION_ZIP);
    assert_int_equal(job.output.pixel, JOB_PIXEL_HALF);
    assert_int_equal(job.output.existing, JOB_EXISTING_VERIFY);
    assert_false(job.scene.has_background);
    assert_int_equal(job.scene.light_count + job.scene.medium_count, 0);
    assert_true(isinf(job.scene.camera.clip_far));
    job_finish(&job);
}

static void order_and_limit_of_frames_are_read(void **state)
{
    static const char opening[] = "{\"version\":1,\"name\":\"x\",\"frames\":\"1-9\",\"fps\":24,\"resolution\":[2,1],"
                                  "\"camera\":{\"position\":[0,0,1],\"target\":[0,0,0],\"fov\":50},"
                                  "\"quality\":{\"method\":\"midpoint\",\"step\":1,\"light_step\":1},"
                                  "\"output\":{\"path\":\"#.exr\"},";
    static const char *const wrong[][2] = {
        {"\"order\":[1]", "order[0]: expected \"first\", \"last\", \"middle\" or a whole number n from 2"},
        {"\"order\":[2,\"end\"]", "order[1]: expected one of"},
        {"\"order\":[2,2,2,2,2,2,2,2,2]", "order: expected"},
        {"\"order\":\"first\"", "order: expected"},
        {"\"frame_limit\":0", "frame_limit: expected"},
        {"\"pool\":\"\"", "pool: expected a pool's name or tag"},
        {"\"pool\":\"a b\"", "pool: expected a pool's name or tag"},
        {"\"pool\":\"a,b\"", "pool: expected a pool's name or tag"},
        {"\"after\":3", "after: expected an array of jobs' ids, or an object"},
        {"\"after\":[0]", "after[0]: expected an integer"},
        {"\"after\":[1.5]", "after[0]: expected an integer"},
        {"\"after\":[4,5,4]", "after[2]: job 4 is there twice"},
        {"\"after\":{}", "after.jobs: expected"},
        {"\"after\":{\"jobs\":[1],\"when\":\"failed\"}", "after.when: expected one of"},
        {"\"after\":{\"jobs\":[1],\"who\":1}", "after: unknown key \"who\""}};
    struct job job =
        job_expect("{\"version\":1,\"name\":\"x\",\"frames\":\"1-9\",\"fps\":24,\"resolution\":[2,1],"
                   "\"camera\":{\"position\":[0,0,1],\"target\":[0,0,0],\"fov\":50},"
                   "\"quality\":{\"method\":\"midpoint\",\"step\":1,\"light_step\":1},"
                   "\"output\":{\"path\":\"#.exr\"},\"order\":[\"last\",4,\"middle\",\"first\"],\"frame_limit\":1.5,"
                   "\"pool\":\"gpu-2\",\"after\":{\"jobs\":[3,9007199254740992],\"when\":\"over\"}}");

    assert_int_equal(job.order.count, 4);
    assert_int_equal(job.order.stages[0], FRAME_ORDER_LAST);
    assert_int_equal(job.order.stages[1], 4);
    assert_int_equal(job.order.stages[2], FRAME_ORDER_MIDDLE);
    assert_int_equal(job.order.stages[3], FRAME_ORDER_FIRST);
    assert_true(job.frame_limit == 1.5);
    assert_string_equal(job.pool, "gpu-2");
    assert_int_equal(job.after.count, 2);
    assert_int_equal(job.after.ids[1], INT64_C(1) << 53);
    assert_true(job.after.takes_any_end);
    job_finish(&job);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        char *text = xasprintf("%s%s}", opening, wrong[i][0]);
        struct error error = {0};

        assert_false(job_parse(&job, text, strlen(text), NULL, &error));
        if (!strstr(error.message, wrong[i][1])) fail_msg("%s", error.message);
        free(text);
    }
}

static void each_required_key_is_named_when_it_is_missing(void **state)
{
    assert_edit_refused("version", NULL, "version: expected 1, got nothing");
    assert_edit_refused("name", NULL, "name: expected a string, got nothing");
    assert_edit_refused("frames", NULL, "frames: expected a string, got nothing");
    assert_edit_refused("fps", NULL,
                        "fps: expected a number in (0, 1000] with at most 6 decimals, or [numerator, denominator], got "
                        "nothing");
    assert_edit_refused("resolution", NULL, "resolution: expected [width, height] in pixels, got nothing");
    assert_edit_refused("camera", NULL, "camera: expected an object, got nothing");
    assert_edit_refused("camera.fov", NULL, "camera.fov: expected a number in (0, 180), got nothing");
    assert_edit_refused("quality.light_step", NULL,
                        "quality.light_step: expected a number of metres, as light marches through media, got nothing");
    assert_edit_refused("output", NULL, "output: expected an object, got nothing");
    assert_edit_refused("output.path", NULL, "output.path: expected a string, got nothing");
    assert_edit_refused("scene.media[0].density", NULL, "scene.media[0].density: expected an object, got nothing");
}

static void wrong_values_are_refused_by_place(void **state)
{
    assert_edit_refused("version", "2", "version: expected 1, got 2");
    assert_edit_refused("frames", "\"1..9\"", "frames: expected \"1-100x2\", got \"1..9\"");
    assert_edit_refused("resolution", "[16385, 1]", "resolution[0]: expected an integer from 1 to 16384, got 16385");
    assert_edit_refused("resolution", "[16384, 4097]",
                        "resolution: expected at most 67108864 pixels in all, got 67125248");
    assert_edit_refused("scene.media[0].phase[1].g", "1.2",
                        "scene.media[0].phase[1].g: expected a number in [-0.99999, 0.99999], got 1.2");
    assert_edit_refused("scene.media[0].phase[1].weight", "0.7",
                        "scene.media[0].phase: expected weights that sum to 1, got a sum of 0.95 at frame 1");
    assert_edit_refused("camera.fov", "{\"start\":179.9,\"rate\":1}",
                        "camera.fov: expected to stay in (0, 180), got 180.4417083 to 180.775375");
    assert_edit_refused("camera.clip", "[2, 1]", "camera.clip: expected near < far, got 2 and 1");
    assert_edit_refused("output.path", "\"../x.#.exr\"", "output.path: \"..\" is not allowed in a path");
    assert_edit_refused("output.path", "\"/x.#.exr\"",
                        "output.path: expected a path below \"/srv/out\", got \"/x.#.exr\"");
    assert_edit_refused("quality.step", "0.000005",
                        "quality.step: expected at most 200000 steps along a ray, got 223924: 1.119615242 m through "
                        "scene.media[0] in steps of 5e-06 m");
    assert_edit_refused("quality.light_steps", "8",
                        "quality: unknown key \"light_steps\", did you mean \"light_step\"?");
    assert_edit_refused("lights[1].falloff", "\"none\"",
                        "lights[1]: unknown key \"falloff\" beside kind \"sun\"; known: kind, intensity, direction");
}

static void names_take_128_printable_bytes(void **state)
{
    static const char *const wrong[] = {"\"\"", "\"a\\nb\"", "\"\\u007f\"", "\"\\u0085\"", "7", "null"};
    char name[160], *text;
    struct job job;

    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        text = json_edit_set(job_text_full, "name", wrong[i]);
        assert_false(job_parse(&job, text, strlen(text), NULL, NULL));
        free(text);
    }
    memset(name, 'n', sizeof name);
    name[0] = name[129] = '"';
    name[130] = '\0';
    text = json_edit_set(job_text_full, "name", name);
    job = job_expect(text);
    assert_int_equal(strlen(job.name), JOB_NAME_LIMIT);
    job_finish(&job);
    free(text);
    name[129] = 'n';
    name[130] = '"';
    name[131] = '\0';
    text = json_edit_set(job_text_full, "name", name);
    assert_false(job_parse(&job, text, strlen(text), NULL, NULL));
    free(text);
}

static void names_are_what_people_see(void **state)
{
    static const struct {
        const char *key, *value, *wrong; // wrong: NULL: nothing is
    } cases[] = {{"name", "\"caf\u00e9 \u6620\u50cf\"", NULL},
                 {"name", "\"a\u202egpj\"", "name: U+202E is not allowed: "},
                 {"name", "\"a\u200bb\"", "name: U+200B is not allowed: "},
                 {"comment", "\"a\u202egpj\"", "comment: U+202E is not allowed: "},
                 {"tags", "[\"a\", \"b\u200b\"]", "tags: U+200B is not allowed: "},
                 {"output.path", "\"a\u2066/x.####.exr\"", "output.path: U+2066 is not allowed: "},
                 {"output.path", "\"a/x\ufeff.####.exr\"", "output.path: U+FEFF is not allowed: "},
                 {"output.path", "\"a/x.####.\u00ad.exr\"", "output.path: U+00AD is not allowed: "}};

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char *text = json_edit_set(job_text_full, cases[i].key, cases[i].value);
        struct job job = job_expect(text); // a job of the store with such a name is still read
        struct error error = {0};

        assert_int_equal(job_check_names(&job, &error), cases[i].wrong == NULL);
        if (cases[i].wrong) assert_memory_equal(error.message, cases[i].wrong, strlen(cases[i].wrong));
        job_finish(&job);
        free(text);
    }
}

static void absolute_paths_lie_below_the_root(void **state)
{
    char *text = json_edit_set(job_text_full, "output.path", "\"/srv/out/a/b.#.exr\"");
    struct error error = {0};
    struct job job = job_expect(text);

    assert_string_equal(job.output.path.folder, "a");
    job_finish(&job);
    assert_false(job_parse(&job, text, strlen(text), NULL, &error));
    assert_string_equal(error.message, "output.path: expected a relative path, got \"/srv/out/a/b.#.exr\"");
    free(text);
}

static void geometry_without_a_picture_is_refused(void **state)
{
    char *still = json_edit_set(job_text_full, "camera.position", "[0, 3, 0]");
    char *text = json_edit_set(still, "camera.target", "[0, 3, 0]");
    char *other;

    job_expect_refused(text, "camera.target: expected a point other than camera.position, got the same at frame 1");
    free(text);
    text = json_edit_set(still, "camera.target", "[0, 0, 0]");
    other = json_edit_set(text, "camera.up", "[0, -2, 0]");
    job_expect_refused(other,
                       "camera.up: expected a direction that is not along the view, got a parallel one at frame 1");
    free(other);
    other = json_edit_set(text, "camera.up", "[0, 0, 0]");
    job_expect_refused(other, "camera.up: expected a vector whose length is not 0, got one of 0");
    free(other);
    free(text);
    free(still);
}

// A direction that reverses may be 0 between two frames.
static void a_direction_is_checked_at_the_frames(void **state)
{
    char *text = json_edit_set(job_text_full, "lights[1].direction", "{\"start\":[0.5,0,0],\"rate\":[-0.5,0,0]}");
    char *at_frame = json_edit_set(text, "fps", "2");
    struct job job;

    job_expect_refused(at_frame,
                       "lights[1].direction: expected a vector whose length is not 0, got one of 0 at frame 1");
    free(at_frame);
    at_frame = json_edit_set(text, "fps", "2.5");
    free(text);
    text = json_edit_set(at_frame, "scene", NULL);
    job = job_expect(text);
    job_finish(&job);
    free(at_frame);
    free(text);
}

static void unknown_keys_are_refused_with_the_nearest(void **state)
{
    char *text = json_edit_rename(job_text_full, "camera.target", "tagret");

    job_expect_refused(text, "camera: unknown key \"tagret\", did you mean \"target\"?");
    free(text);
    text = json_edit_rename(job_text_full, "camera.position.orbit", "obrit");
    job_expect_refused(text, "camera.position: unknown key \"obrit\", did you mean \"orbit\"?");
    free(text);
}

static void what_is_no_job_is_refused(void **state)
{
    static const char nan_job[] = "{\"version\": NaN}";
    char *large = xcalloc(1, JOB_DOCUMENT_LIMIT + 2);
    struct error error = {0};
    struct job job;

    job_expect_refused("[]", "expected an object, got an array of 0");
    job_expect_refused("{}", "version: expected 1, got nothing");
    assert_false(job_parse(&job, nan_job, strlen(nan_job), NULL, NULL));
    assert_false(job_parse(&job, "", 0, NULL, NULL));
    memset(large, ' ', JOB_DOCUMENT_LIMIT + 1);
    assert_false(job_parse(&job, large, JOB_DOCUMENT_LIMIT + 1, NULL, &error));
    assert_string_equal(error.message, "expected a job of at most 4000000 bytes, got 4000001");
    free(large);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cloud_is_read_in_full),
        cmocka_unit_test(cloud_seed_is_read_in_full),
        cmocka_unit_test(every_example_is_taken),
        cmocka_unit_test(the_first_job_of_the_documentation_is_taken),
        cmocka_unit_test(frame_times_are_offset_plus_frame_over_fps),
        cmocka_unit_test(time_span_holds_all_frames),
        cmocka_unit_test(absent_keys_have_their_defaults),
        cmocka_unit_test(order_and_limit_of_frames_are_read),
        cmocka_unit_test(each_required_key_is_named_when_it_is_missing),
        cmocka_unit_test(wrong_values_are_refused_by_place),
        cmocka_unit_test(names_take_128_printable_bytes),
        cmocka_unit_test(names_are_what_people_see),
        cmocka_unit_test(absolute_paths_lie_below_the_root),
        cmocka_unit_test(geometry_without_a_picture_is_refused),
        cmocka_unit_test(a_direction_is_checked_at_the_frames),
        cmocka_unit_test(unknown_keys_are_refused_with_the_nearest),
        cmocka_unit_test(what_is_no_job_is_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
