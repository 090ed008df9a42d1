// SPDX-License-Identifier: Apache-2.0
#include "core/job/quality_json.h"

#include "core/base/error.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "tests/support/job_expect.h"
#include "tests/support/job_text.h"
#include "tests/support/json_edit.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void qualities_are_read(void **state)
{
    struct job noise = job_expect(job_text_noise), fog = job_expect(job_text_fog);

    assert_int_equal(noise.quality.method, JOB_METHOD_MIDPOINT);
    assert_true(noise.quality.step == 0.05 && noise.quality.light_step == 0.1 && noise.quality.step_voxels == 0.0);
    assert_true(noise.quality.roulette_below == 0.125 && noise.quality.roulette_survive == 0.5);
    assert_int_equal(noise.quality.samples, 4);
    assert_int_equal(fog.quality.method, JOB_METHOD_EQUIANGULAR);
    assert_int_equal(fog.quality.points, 8);
    assert_int_equal(fog.quality.samples, 2);
    // Frames 1 to 9 at 25 a second, and half a frame of shutter.
    assert_true(fabs(job_time_span(&fog).last - 0.38) < 1e-15);
    job_finish(&noise);
    job_finish(&fog);
}

// They have the parameters of midpoint.
static void jittered_and_preintegrated_are_read(void **state)
{
    static const char *const names[] = {"\"jittered\"", "\"preintegrated\""};
    static const enum job_method methods[] = {JOB_METHOD_JITTERED, JOB_METHOD_PREINTEGRATED};

    for (int i = 0; i < 2; i++) {
        char *traced = json_edit_set(job_text_noise, "quality.pixels", NULL);
        char *text = json_edit_set(traced, "quality.method", names[i]);
        struct job job = job_expect(text);

        assert_int_equal(job.quality.method, methods[i]);
        assert_true(job.quality.step == 0.05 && job.quality.light_step == 0.1 && job.quality.roulette_below == 0.125);
        assert_memory_equal(job_method_name(job.quality.method), names[i] + 1, strlen(names[i]) - 2);
        job_finish(&job);
        free(text);
        free(traced);
    }
}

static void pixels_that_are_traced_are_read(void **state)
{
    char *with_stride = json_edit_set(job_text_noise, "quality.pixels.stride", NULL);
    char *every = json_edit_set(job_text_noise, "quality.pixels", NULL);
    struct job job = job_expect(job_text_noise), by_default = job_expect(with_stride), all = job_expect(every);

    assert_int_equal(job.quality.pixels.stride, 8);
    assert_true(job.quality.pixels.threshold == 0.01);
    assert_int_equal(by_default.quality.pixels.stride, JOB_STRIDE_DEFAULT);
    assert_int_equal(all.quality.pixels.stride, 0);
    assert_string_not_equal(job.hash, by_default.hash);
    assert_string_not_equal(job.hash, all.hash);
    job_finish(&job);
    job_finish(&by_default);
    job_finish(&all);
    free(with_stride);
    free(every);
}

static void steps_by_depth_and_by_rule_are_read(void **state)
{
    char *text = json_edit_set(job_text_noise, "quality",
                               "{\"method\":\"adaptive\",\"step\":0.5,\"light_step\":1,\"depth_step\":0.125}");
    struct job adaptive = job_expect(text), gauss;

    assert_int_equal(adaptive.quality.method, JOB_METHOD_ADAPTIVE);
    assert_true(adaptive.quality.step == 0.5 && adaptive.quality.depth_step == 0.125);
    free(text);
    text = json_edit_set(job_text_noise, "quality", "{\"method\":\"gauss\",\"step\":0.5,\"light_step\":1,\"order\":3}");
    gauss = job_expect(text);
    assert_int_equal(gauss.quality.method, JOB_METHOD_GAUSS);
    assert_int_equal(gauss.quality.order, 3);
    job_finish(&gauss);
    free(text);
    text = json_edit_set(job_text_noise, "quality", "{\"method\":\"gauss\",\"step\":0.5,\"light_step\":1}");
    gauss = job_expect(text);
    assert_int_equal(gauss.quality.order, 2);
    job_finish(&gauss);
    free(text);
    job_finish(&adaptive);
}

// Frames state the settings that a job could: --plan-of reads them.
static void paths_of_objects_are_written_as_they_are_read(void **state)
{
    char *with_object = json_edit_set(job_text_noise, "scene.objects",
                                      "[{\"kind\":\"plane\",\"point\":[0,-2,0],\"material\":{\"kind\":\"diffuse\","
                                      "\"albedo\":0.5}}]");
    char *text = json_edit_set(with_object, "quality", "{\"method\":\"paths\",\"paths\":64}"), *written;
    struct job job = job_expect(text), again;
    struct json_writer writer = {0};

    quality_to_json(&writer, &job, &job.quality);
    written = json_edit_set(with_object, "quality", writer.text);
    again = job_expect(written);
    assert_int_equal(again.quality.method, JOB_METHOD_PATHS);
    assert_int_equal(again.quality.paths, 64);
    json_writer_finish(&writer);
    job_finish(&again);
    job_finish(&job);
    free(written);
    free(text);
    free(with_object);
}

static void tracking_is_read(void **state)
{
    char *text =
        json_edit_set(job_text_noise, "quality", "{\"method\":\"tracking\",\"estimator\":\"ratio\",\"samples\":3}");
    struct job ratio = job_expect(text), jackknife;

    assert_int_equal(ratio.quality.method, JOB_METHOD_TRACKING);
    assert_int_equal(ratio.quality.estimator, JOB_ESTIMATOR_RATIO);
    assert_true(job_quality_has_majorants(&ratio.quality) && ratio.quality.step == 0.0);
    free(text);
    text = json_edit_set(job_text_noise, "quality",
                         "{\"method\":\"tracking\",\"estimator\":\"jackknife\",\"step\":0.5,\"light_step\":0.25}");
    jackknife = job_expect(text);
    assert_int_equal(jackknife.quality.estimator, JOB_ESTIMATOR_JACKKNIFE);
    assert_false(job_quality_has_majorants(&jackknife.quality));
    assert_true(jackknife.quality.step == 0.5 && jackknife.quality.light_step == 0.25);
    free(text);
    job_finish(&ratio);
    job_finish(&jackknife);
}

static void cached_is_read(void **state)
{
    char *text =
        json_edit_set(job_text_noise, "quality",
                      "{\"method\":\"cached\",\"step\":0.05,\"light_grid\":64,\"density_grid\":32,\"samples\":3}");
    struct job job = job_expect(text);

    (void)state;
    assert_int_equal(job.quality.method, JOB_METHOD_CACHED);
    assert_int_equal(job.quality.light_grid, 64);
    assert_int_equal(job.quality.density_grid, 32);
    assert_int_equal(job.quality.samples, 3);
    assert_true(job.quality.step == 0.05 && job.quality.light_step == 0.0);
    job_finish(&job);
    free(text);
}

// What is read, whether or not it is rendered.
static struct job_quality read_quality(const char *quality)
{
    char *text = json_edit_set(job_text_paths, "quality", quality);
    struct error error = {0};
    struct cJSON *root = NULL;
    struct json_node document;
    struct job_quality read;

    assert_true(json_parse(&root, text, strlen(text), NULL));
    document = json_node_root(root);
    if (!quality_from_json(&read, &document, &error)) fail_msg("%s", error.message);
    json_delete(root);
    free(text);
    return read;
}

static void random_paths_are_read(void **state)
{
    struct job_quality quality = read_quality("{\"method\":\"paths\",\"paths\":1048576,\"samples\":3}");

    assert_int_equal(quality.method, JOB_METHOD_PATHS);
    assert_int_equal(quality.paths, JOB_PATH_LIMIT);
    assert_int_equal(quality.samples, 3);
    assert_int_equal(quality.scatter_grid, 0);
    assert_true(job_quality_states_method(&quality) && !job_method_takes_steps(quality.method));
}

static void paths_of_a_part_of_the_pixels_are_read(void **state)
{
    struct job_quality quality =
        read_quality("{\"method\":\"paths\",\"paths\":4096,\"step\":0.5,\"pixels\":{\"stride\":8,\"threshold\":0.01}}");

    assert_true(quality.paths == 4096 && quality.step == 0.5 && quality.pixels.stride == 8);
    quality = read_quality("{\"method\":\"paths\",\"paths\":4096,\"step\":0.5}");
    assert_true(quality.step == 0.5 && quality.pixels.stride == 0);
    assert_int_equal(quality.light_grid, 0);
}

static void light_grids_of_paths_are_read(void **state)
{
    assert_int_equal(read_quality("{\"method\":\"paths\",\"paths\":64,\"light_grid\":48}").light_grid, 48);
    assert_int_equal(read_quality("{\"method\":\"paths\",\"paths\":64,\"light_grid\":0}").light_grid, 0);
    job_expect_edit_refused(job_text_paths, "quality.light_grid", "3",
                            "quality.light_grid: expected 0 or 4 to 512 cells, got 3");
    job_expect_edit_refused(job_text_paths, "quality.light_grid", "513",
                            "quality.light_grid: expected an integer from 0 to 512, got 513");
}

#define SPARSE_PATHS "\"method\":\"paths\",\"paths\":8,\"pixels\":{\"threshold\":0.1}"

static void scatter_grids_are_read(void **state)
{
    struct job_quality quality =
        read_quality("{\"method\":\"midpoint\",\"step\":1,\"light_step\":1,\"scatter_grid\":256,\"paths\":8}");

    assert_true(quality.scatter_grid == 256 && quality.paths == 8);
    quality = read_quality("{\"method\":\"cached\",\"step\":1,\"light_grid\":16,\"scatter_grid\":4}");
    assert_true(quality.scatter_grid == 4 && quality.paths == JOB_PATH_DEFAULT);
    assert_int_equal(quality.scatter_from, JOB_SCATTER_FROM_ANY);
    quality = read_quality(
        "{\"method\":\"cached\",\"step\":1,\"light_grid\":16,\"scatter_grid\":4,\"scatter_from\":\"lights\"}");
    assert_int_equal(quality.scatter_from, JOB_SCATTER_FROM_LIGHTS);
    quality = read_quality(
        "{\"method\":\"cached\",\"step\":1,\"light_grid\":16,\"scatter_grid\":4,\"scatter_from\":\"nodes\"}");
    assert_true(quality.scatter_from == JOB_SCATTER_FROM_NODES && quality.similar_after == 0);
    quality = read_quality("{\"method\":\"cached\",\"step\":1,\"light_grid\":16,\"scatter_grid\":4,"
                           "\"scatter_from\":\"nodes\",\"similar_after\":3}");
    assert_int_equal(quality.similar_after, 3);
    quality = read_quality("{\"method\":\"cached\",\"step\":1,\"light_grid\":16}");
    assert_true(quality.scatter_grid == 0 && quality.paths == 0);
}

static void wrong_random_paths_are_refused_by_place(void **state)
{
    static const char march[] = "{\"method\":\"midpoint\",\"step\":1,\"light_step\":1,\"scatter_grid\":16}";
    char *text = json_edit_set(job_text_paths, "quality", march);

    job_expect_edit_refused(job_text_paths, "quality.paths", "0",
                            "quality.paths: expected an integer from 1 to 1048576, got 0");
    job_expect_edit_refused(job_text_paths, "quality.paths", "1048577",
                            "quality.paths: expected an integer from 1 to 1048576, got 1048577");
    job_expect_edit_refused(job_text_paths, "quality.paths", NULL,
                            "quality.paths: expected an integer from 1 to 1048576, got nothing");
    job_expect_edit_refused(job_text_paths, "quality.order", "2",
                            "quality: unknown key \"order\" beside method \"paths\"; known: method, paths, "
                            "light_grid, samples, pixels, step, step_voxels, max_cut");
    job_expect_edit_refused(text, "quality.scatter_grid", "3",
                            "quality.scatter_grid: expected an integer from 4 to 256, got 3");
    job_expect_edit_refused(text, "quality.scatter_grid", "257",
                            "quality.scatter_grid: expected an integer from 4 to 256, got 257");
    job_expect_edit_refused(text, "quality.paths", "0", "quality.paths: expected an integer from 1 to 1048576, got 0");
    job_expect_edit_refused(job_text_noise, "quality.paths", "4", "quality.paths: only beside scatter_grid");
    job_expect_edit_refused(job_text_noise, "quality.scatter_from", "\"nodes\"",
                            "quality.scatter_from: only beside scatter_grid");
    job_expect_edit_refused(text, "quality.scatter_from", "\"sun\"",
                            "quality.scatter_from: expected one of \"lights\",\"nodes\", got \"sun\"");
    job_expect_edit_refused(text, "quality",
                            "{\"method\":\"cached\",\"step\":1,\"light_grid\":16,\"scatter_grid\":4,"
                            "\"scatter_from\":\"lights\",\"similar_after\":2}",
                            "quality.similar_after: not beside scatter_from \"lights\"");
    job_expect_edit_refused(job_text_noise, "quality.similar_after", "3",
                            "quality.similar_after: only beside scatter_grid");
    job_expect_edit_refused(job_text_noise, "quality", "{\"paths\":4}",
                            "quality.paths: only beside a method; without one, the planner chooses it");
    free(text);
}

static void assert_tolerance(const char *quality, double tolerance, int samples)
{
    char *text = json_edit_set(job_text_noise, "quality", quality);
    struct job job = job_expect(text);

    assert_int_equal(job.quality.method, JOB_METHOD_AUTO);
    assert_true(job.quality.tolerance == tolerance && job.quality.step == 0.0 && job.quality.light_step == 0.0);
    assert_int_equal(job.quality.samples, samples);
    job_finish(&job);
    free(text);
}

static void without_a_method_there_is_a_tolerance(void **state)
{
    assert_tolerance(NULL, 0.01, 1);
    assert_tolerance("{}", 0.01, 1);
    assert_tolerance("{\"tolerance\":0.125}", 0.125, 1);
    assert_tolerance("{\"method\":\"auto\",\"tolerance\":0.0002,\"samples\":4}", 2e-4, 4);
}

static void a_draft_is_one_word(void **state)
{
    char *text = json_edit_set(job_text_noise, "quality", "\"draft\"");
    struct job job = job_expect(text), exact = job_expect(job_text_noise);

    assert_int_equal(job.quality.method, JOB_METHOD_DRAFT);
    assert_true(job.quality.is_draft && !exact.quality.is_draft);
    assert_false(job_quality_states_method(&job.quality));
    assert_int_equal(job.quality.samples, 1);
    assert_true(job.quality.tolerance == 0.0 && job.quality.max_cut == 1.0);
    assert_string_not_equal(job.hash, exact.hash);
    job_finish(&exact);
    job_finish(&job);
    free(text);
}

static void wrong_qualities_are_refused_by_place(void **state)
{
    static const struct {
        const char *path, *value, *expected;
    } edits[] = {
        {"quality", "\"daft\"", "quality: expected one of \"draft\", got \"daft\", did you mean \"draft\"?"},
        {"quality", "{\"method\":\"draft\"}",
         "quality.method: expected one of \"riemann\",\"midpoint\",\"equiangular\",\"jittered\",\"adaptive\",\"gauss\","
         "\"cached\",\"preintegrated\",\"tracking\",\"paths\",\"auto\", got \"draft\""},
        {"quality.roulette.below", "0", "quality.roulette.below: expected a number in (0, 1], got 0"},
        {"quality.roulette.survive", "1", "quality.roulette.survive: expected a number in (0, 1), got 1"},
        {"quality.roulette.survive", NULL, "quality.roulette.survive: expected a number from 0 to 1, got nothing"},
        {"quality.pixels", "{}", "quality.pixels.threshold: expected a number from 1e-06 to 1, got nothing"},
        {"quality.pixels.threshold", "0", "quality.pixels.threshold: expected a number from 1e-06 to 1, got 0"},
        {"quality.pixels.stride", "12", "quality.pixels.stride: expected a power of two, got 12"},
        {"quality.pixels.stride", "128", "quality.pixels.stride: expected an integer from 2 to 64, got 128"},
        {"quality.pixels.size", "2", "quality.pixels: unknown key \"size\"; known: stride, threshold"},
        {"quality.max_cut", "0.5", "quality.max_cut: not beside pixels: only the cut rays of traced pixels are known"},
        {"quality.method", "\"jittered\"",
         "quality.pixels: not with jittered, which has random numbers of its own in each pixel"},
        {"quality", "{\"tolerance\":0.01,\"pixels\":{\"threshold\":0.01}}",
         "quality.pixels: only beside a method; without one, the planner chooses it"},
        {"quality", "{" SPARSE_PATHS "}",
         "quality.step: expected a number of metres, of the march beside paths of a part of the pixels, got nothing"},
        {"quality", "{" SPARSE_PATHS ",\"step\":1e-6}",
         "quality.step: expected at most 200000 steps along a ray, got 3000000: 3 m through scene.media[0] in steps of "
         "1e-06 m"},
        {"quality", "{" SPARSE_PATHS ",\"step\":1,\"max_cut\":0.5}",
         "quality.max_cut: not beside pixels: only the cut rays of traced pixels are known"},
        {"quality.samples", "0", "quality.samples: expected an integer from 1 to 1024, got 0"},
        {"quality.points", "3",
         "quality: unknown key \"points\" beside method \"midpoint\"; known: method, step, step_voxels, light_step, "
         "light_step_voxels, min_transmittance, scatter_grid, scatter_from, similar_after, paths, roulette, pixels, "
         "samples, max_depth, "
         "min_throughput, max_cut"},
        {"quality.step_voxels", "1", "quality.step_voxels: expected step or step_voxels, got both"},
        {"quality.light_step_voxels", "1",
         "quality.light_step_voxels: expected light_step or light_step_voxels, got both"},
        {"quality", "{\"method\":\"midpoint\",\"step_voxels\":1,\"light_step\":1}",
         "quality.step_voxels: expected a density of kind \"grid\", whose voxels it counts, got none"},
        {"quality", "{\"method\":\"adaptive\",\"step\":1,\"light_step\":1}",
         "quality.depth_step: expected a number from 0.0001 to 100, got nothing"},
        {"quality", "{\"method\":\"gauss\",\"step\":1,\"light_step\":1,\"order\":5}",
         "quality.order: expected an integer from 2 to 4, got 5"},
        {"quality", "{\"method\":\"tracking\"}",
         "quality.estimator: expected one of \"delta\",\"ratio\",\"debiased\",\"jackknife\", got nothing"},
        {"quality", "{\"method\":\"tracking\",\"estimator\":\"delta\",\"step\":1}",
         "quality: unknown key \"step\" beside method \"tracking\"; known: method, estimator, roulette, samples, "
         "pixels"},
        {"quality", "{\"method\":\"tracking\",\"estimator\":\"debiased\"}",
         "quality.step: expected a number from 1e-09 to 1000000000, got nothing"},
        {"quality", "{\"method\":\"tracking\",\"estimator\":\"debiased\",\"step\":1}",
         "quality.light_step: expected a number of metres, as light marches through media, got nothing"},
        {"quality.tolerance", "0.1",
         "quality: unknown key \"tolerance\" beside method \"midpoint\"; known: method, step, step_voxels, light_step, "
         "light_step_voxels, min_transmittance, scatter_grid, scatter_from, similar_after, paths, roulette, pixels, "
         "samples, max_depth, "
         "min_throughput, max_cut"},
        {"quality.on_miss", "\"publish\"",
         "quality: unknown key \"on_miss\" beside method \"midpoint\"; known: method, step, step_voxels, light_step, "
         "light_step_voxels, min_transmittance, scatter_grid, scatter_from, similar_after, paths, roulette, pixels, "
         "samples, max_depth, "
         "min_throughput, max_cut"},
        {"quality", "{\"on_miss\":\"keep\"}", "quality.on_miss: expected one of \"fail\",\"publish\", got \"keep\""},
        {"quality", "{\"tolerance\":5}",
         "quality.tolerance: expected a number from 0.0001 to 0.5, got 5, did you mean 0.05 (5 %)?"},
        {"quality", "{\"tolerance\":0.6}", "quality.tolerance: expected a number from 0.0001 to 0.5, got 0.6"},
        {"quality", "{\"tolerance\":0.1,\"step\":1}",
         "quality.step: only beside a method; without one, the planner chooses it"},
        {"quality", "{\"tolerance\":0.00015}",
         "quality.tolerance: expected at least 0.0002 with half pixels, whose rounding errs as much, got 0.00015; "
         "output.pixel \"float\" errs less"},
        {"quality", "{\"light_grid\":64}",
         "quality.light_grid: only beside a method; without one, the planner chooses it"},
        {"quality", "{\"method\":\"cached\",\"step\":1,\"light_grid\":3}",
         "quality.light_grid: expected an integer from 4 to 512, got 3"},
        {"quality", "{\"method\":\"cached\",\"step\":1,\"light_grid\":64,\"light_step\":1}",
         "quality: unknown key \"light_step\", did you mean \"light_grid\"?"},
        {"quality", "{\"method\":\"equiangular\"}", "quality.points: expected an integer from 1 to 1000, got nothing"},
        {"quality", "{\"method\":\"riemann\",\"step\":0.1,\"light_steps\":4,\"roulette\":{}}",
         "quality: unknown key \"roulette\" beside method \"riemann\"; known: method, step, light_steps, "
         "min_transmittance, samples, pixels"},
    };

    for (size_t i = 0; i < sizeof edits / sizeof edits[0]; i++)
        job_expect_edit_refused(job_text_noise, edits[i].path, edits[i].value, edits[i].expected);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(qualities_are_read),
        cmocka_unit_test(jittered_and_preintegrated_are_read),
        cmocka_unit_test(pixels_that_are_traced_are_read),
        cmocka_unit_test(steps_by_depth_and_by_rule_are_read),
        cmocka_unit_test(without_a_method_there_is_a_tolerance),
        cmocka_unit_test(paths_of_objects_are_written_as_they_are_read),
        cmocka_unit_test(tracking_is_read),
        cmocka_unit_test(cached_is_read),
        cmocka_unit_test(random_paths_are_read),
        cmocka_unit_test(paths_of_a_part_of_the_pixels_are_read),
        cmocka_unit_test(light_grids_of_paths_are_read),
        cmocka_unit_test(scatter_grids_are_read),
        cmocka_unit_test(wrong_random_paths_are_refused_by_place),
        cmocka_unit_test(a_draft_is_one_word),
        cmocka_unit_test(wrong_qualities_are_refused_by_place),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
