// Coverage of error95, on hundreds of small frames, good and broken, whose true error is known.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/ball_job.h"
#include "tests/support/example_job.h"
#include "tests/support/flaw.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "worker/audit/audit.h"
#include "worker/audit/audit_estimate.h"
#include "worker/audit/audit_map.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 64, HEIGHT_PX = 36, PIXELS = WIDTH_PX * HEIGHT_PX, SMALL_WIDTH_PX = 16, SMALL_HEIGHT_PX = 9 };
enum { RAYS = AUDIT_RAYS_MIN, AUDITS = 25, FRAME_LIMIT = 600 };

// The relative error of the reference and of the file's rounding.
static const double RESOLUTION = 5e-4;

struct stage {
    struct gl_stage gl;
};

// A scene at one moment and its true light.
struct moment {
    struct job job;
    int32_t frame;
    struct truth_pixel *light; // owned; one of each pixel
};

struct picture {
    struct image image, finer, coarser;
    double error; // true relative error of the values as halves
};

// Results of the audits of one kind of frames.
struct tally {
    const char *name;
    int frames, audits, covered, badly_covered;
    double ratios[FRAME_LIMIT]; // error95 over the true error: the median of each frame's audits
};

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

static double quantile(const double *sorted, int count, double share)
{
    return sorted[(int)(share * (count - 1))];
}

static int set_stage(void **state)
{
    struct stage *stage = xcalloc(1, sizeof *stage);

    stage->gl = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    *state = stage;
    return 0;
}

static int clear_stage(void **state)
{
    struct stage *stage = *state;

    gl_stage_close(stage->gl);
    free(stage);
    return 0;
}

static void render(const struct stage *stage, const struct job *job, int32_t frame, int width_px, int height_px,
                   struct image *image)
{
    struct renderer_result result;
    struct error error = {{0}};
    struct job sized = *job;

    sized.width_px = width_px;
    sized.height_px = height_px;
    if (!image_init(image, width_px, height_px, job->output.has_depth, job->output.has_transmittance, &error) ||
        !renderer_render(stage->gl.renderer, &(struct renderer_frame){.job = &sized, .frame = frame, .image = image},
                         &result, &error))
        fail_msg("%s", error.message);
}

static struct job in_steps(const struct job *job, double factor)
{
    struct job changed = *job;
    struct job_quality *quality = &changed.quality;

    quality->step *= factor;
    quality->light_step *= factor;
    quality->step_voxels *= factor;
    quality->light_step_voxels *= factor;
    if (quality->points > 0) quality->points = (int)fmax(quality->points / factor, 1.0);
    return changed;
}

static void open_moment(struct moment *moment, int32_t frame)
{
    const struct integrate_accuracy accuracy = {.relative = 1e-3};
    struct pixel *all = xcalloc(PIXELS, sizeof *all);
    struct error error = {{0}};
    struct truth *truth;

    moment->frame = frame;
    moment->job.quality.samples = 1;
    moment->job.output.has_depth = moment->job.output.has_transmittance = false;
    moment->light = xcalloc(PIXELS, sizeof *moment->light);
    for (int i = 0; i < PIXELS; i++)
        all[i] = (struct pixel){i % WIDTH_PX, i / WIDTH_PX};
    truth = truth_open(&(struct truth_params){.job = &moment->job, .frame = frame}, &error);
    if (!truth) fail_msg("%s", error.message);
    truth_measure_many(
        truth, &(struct truth_many){.points = all, .pixels = moment->light, .count = PIXELS, .accuracy = &accuracy});
    truth_close(truth);
    free(all);
}

static void open_example(struct moment *moment, const char *name, double time, int32_t frame)
{
    example_job_load(&moment->job, name);
    example_job_shrink(&moment->job, WIDTH_PX, HEIGHT_PX, time);
    open_moment(moment, frame);
}

static struct timeline constant(double value)
{
    return (struct timeline){.component_count = 1, .value = {value}};
}

// A marched ball whose density falls off towards its rim, so that coarse steps show.
static void open_ball(struct moment *moment, double scale)
{
    ball_job_parse(&moment->job, "\"sigma_s\": [3, 2.1, 1.2], \"sigma_a\": 0.4",
                   BALL_JOB_POINT_LIGHT ", \"background\": 0.05, "
                                        "\"quality\": {\"method\": \"midpoint\", \"step\": 0.1, \"light_step\": 0.2}");
    moment->job.scene.media[0].density = (struct scene_density){
        .kind = SCENE_DENSITY_HOMOGENEOUS,
        .bounds = {.kind = SCENE_BOUNDS_SPHERE,
                   .center = {.component_count = 3},
                   .radius = constant(1.0),
                   .falloff = constant(0.6)},
        .homogeneous.scale = constant(scale),
    };
    moment->job.width_px = WIDTH_PX;
    moment->job.height_px = HEIGHT_PX;
    open_moment(moment, 0);
}

static void close_moment(struct moment *moment)
{
    free(moment->light);
    job_finish(&moment->job);
}

// Puts a mistake of the scene into the picture.
static void spoil_light(const struct stage *stage, const struct moment *moment, const struct job *job, enum flaw flaw,
                        struct image *image)
{
    struct image other;
    struct job spoilt;

    if (!flaw_spoil_light(flaw, job, moment->frame, &spoilt)) return;
    render(stage, &spoilt, moment->frame, WIDTH_PX, HEIGHT_PX, &other);
    flaw_mix(flaw, &other, image);
    image_finish(&other);
}

static double find_error(const struct moment *moment, const struct image *image)
{
    struct audit_map map;
    double errors = 0.0, light = 0.0;

    audit_map_init(&map, &(struct audit_map_params){.image = image, .pixel = JOB_PIXEL_HALF});
    for (int i = 0; i < PIXELS; i++) {
        struct pixel at = {i % WIDTH_PX, i / WIDTH_PX};

        errors +=
            audit_map_compare(&map, at, NULL, &moment->light[i]).square * audit_map_density(&map, at) * map.mean_square;
        for (int c = 0; c < 3; c++)
            light += moment->light[i].rgb[c] * moment->light[i].rgb[c] / 3.0;
    }
    audit_map_finish(&map);
    return sqrt(errors / light);
}

static void make_picture(const struct stage *stage, const struct moment *moment, double steps, enum flaw flaw,
                         struct picture *picture)
{
    struct job used = in_steps(&moment->job, flaw == FLAW_COARSE ? 3.0 * steps : steps), halved = in_steps(&used, 0.5);

    render(stage, &used, moment->frame, WIDTH_PX, HEIGHT_PX, &picture->image);
    render(stage, &used, moment->frame, SMALL_WIDTH_PX, SMALL_HEIGHT_PX, &picture->coarser);
    render(stage, &halved, moment->frame, SMALL_WIDTH_PX, SMALL_HEIGHT_PX, &picture->finer);
    spoil_light(stage, moment, &used, flaw, &picture->image);
    flaw_spoil_values(flaw, &picture->image);
    picture->error = find_error(moment, &picture->image);
}

static void finish_picture(struct picture *picture)
{
    image_finish(&picture->image);
    image_finish(&picture->finer);
    image_finish(&picture->coarser);
}

static void map_picture(struct audit_map *map, const struct picture *picture)
{
    audit_map_init(map, &(struct audit_map_params){.image = &picture->image,
                                                   .pixel = JOB_PIXEL_HALF,
                                                   .finer = &picture->finer,
                                                   .coarser = &picture->coarser,
                                                   .is_own = true});
}

static void draw_samples(const struct audit_map *map, const struct moment *moment, int seed, size_t count,
                         struct audit_samples *samples)
{
    struct pixel points[RAYS];

    audit_map_draw(map, &moment->job, seed, 0, count, points);
    for (size_t i = 0; i < count; i++) {
        const struct truth_pixel *light = &moment->light[points[i].y * WIDTH_PX + points[i].x];
        struct audit_sample sample = audit_map_compare(map, points[i], NULL, light);

        audit_samples_append(samples, &sample);
    }
}

static void note_frame(struct tally *tally, const struct picture *picture, double *bounds, int covered)
{
    qsort(bounds, AUDITS, sizeof *bounds, compare);
    assert_true(tally->frames < FRAME_LIMIT);
    tally->ratios[tally->frames++] = quantile(bounds, AUDITS, 0.5) / picture->error;
    tally->audits += AUDITS;
    tally->covered += covered;
    if (covered < 0.95 * AUDITS) tally->badly_covered++;
}

// Audits one frame AUDITS times, each time on other pixels. Without a pool (both NULL) the frame is judged by itself.
static void audit_picture(struct tally *tally, const struct moment *moment, const struct picture *picture,
                          const struct moment *pool_moment, const struct picture *pool_picture)
{
    struct audit_map map, pool_map = {.change = -1.0};
    double bounds[AUDITS];
    int covered = 0;

    map_picture(&map, picture);
    if (pool_picture) map_picture(&pool_map, pool_picture);
    for (int i = 0; i < AUDITS; i++) {
        struct audit_samples own = {0}, pool = {0};
        struct audit_evidence evidence = {
            .own = &own, .change = map.change, .pool_change = pool_map.change, .resolution = RESOLUTION};
        struct audit_verdict verdict;

        draw_samples(&map, moment, i, pool_picture ? AUDIT_RAYS_POOLED : RAYS, &own);
        if (pool_picture) {
            draw_samples(&pool_map, pool_moment, 1000 + i, RAYS, &pool);
            evidence.pool = &pool;
        }
        verdict = audit_estimate(&evidence);
        if (pool_picture && !verdict.is_pooled) { // the frame is unlike the pool, and is judged by itself
            audit_samples_finish(&own);
            draw_samples(&map, moment, i, RAYS, &own);
            verdict = audit_estimate(&evidence);
        }
        bounds[i] = verdict.error95;
        covered += verdict.error95 >= picture->error;
        audit_samples_finish(&own);
        audit_samples_finish(&pool);
    }
    note_frame(tally, picture, bounds, covered);
    audit_map_finish(&map);
    audit_map_finish(&pool_map);
}

static void report(struct tally *tally)
{
    qsort(tally->ratios, (size_t)tally->frames, sizeof *tally->ratios, compare);
    print_message("%-34s %3d frames, %5d audits: error95 holds in %.2f %%, in less than 95 %% for %d frames; "
                  "error95 over the true error: median %.2f, 90 %% below %.2f\n",
                  tally->name, tally->frames, tally->audits, 100.0 * tally->covered / tally->audits,
                  tally->badly_covered, quantile(tally->ratios, tally->frames, 0.5),
                  quantile(tally->ratios, tally->frames, 0.9));
}

static const double STEPS[] = {1.0, 2.0, 4.0, 8.0};
enum { STEPS_COUNT = sizeof STEPS / sizeof *STEPS };

// Frames of two moments of a scene: each moment's good frame is the other's pool.
struct tallies {
    struct tally alone[FLAW_COUNT], pooled[FLAW_COUNT];
};

static void audit_scene(const struct stage *stage, struct moment moments[static 2], struct tallies *tallies)
{
    for (int s = 0; s < STEPS_COUNT; s++) {
        struct picture whole[2], picture;

        for (int m = 0; m < 2; m++)
            make_picture(stage, &moments[m], STEPS[s], FLAW_NONE, &whole[m]);
        for (int i = 0; i < 2 * FLAW_COUNT; i++) {
            int m = i % 2, flaw = i / 2;

            make_picture(stage, &moments[m], STEPS[s], (enum flaw)flaw, &picture);
            audit_picture(&tallies->alone[flaw], &moments[m], &picture, NULL, NULL);
            audit_picture(&tallies->pooled[flaw], &moments[m], &picture, &moments[1 - m], &whole[1 - m]);
            finish_picture(&picture);
        }
        finish_picture(&whole[0]);
        finish_picture(&whole[1]);
    }
    close_moment(&moments[0]);
    close_moment(&moments[1]);
}

// Returns the sum over all frames with a flaw.
static struct tally report_all(struct tally tallies[static FLAW_COUNT], const char *name)
{
    static struct tally broken;

    broken = (struct tally){.name = "all broken ones"};
    print_message("%s:\n", name);
    for (int flaw = 0; flaw < FLAW_COUNT; flaw++) {
        struct tally *tally = &tallies[flaw];

        tally->name = flaw_names[flaw];
        report(tally);
        if (flaw == FLAW_NONE) continue;
        memcpy(broken.ratios + broken.frames, tally->ratios, (size_t)tally->frames * sizeof *tally->ratios);
        broken.frames += tally->frames;
        broken.audits += tally->audits;
        broken.covered += tally->covered;
        broken.badly_covered += tally->badly_covered;
    }
    report(&broken);
    return broken;
}

static double covered_share(const struct tally *tally)
{
    return (double)tally->covered / tally->audits;
}

static void error95_holds(void **state)
{
    struct tallies *tallies = xcalloc(1, sizeof *tallies);
    struct tally alone, pooled;
    struct moment moments[2];

    open_example(&moments[0], "fog", 1.4, 0);
    open_example(&moments[1], "fog", 1.8, 0);
    audit_scene(*state, moments, tallies);
    open_example(&moments[0], "sunset", 2.0, 0);
    open_example(&moments[1], "sunset", 7.0, 0);
    audit_scene(*state, moments, tallies);
    open_example(&moments[0], "smoke", 0.0, 6);
    open_example(&moments[1], "smoke", 0.0, 8);
    audit_scene(*state, moments, tallies);
    open_ball(&moments[0], 1.0);
    open_ball(&moments[1], 1.4);
    audit_scene(*state, moments, tallies);
    alone = report_all(tallies->alone, "by themselves");
    pooled = report_all(tallies->pooled, "with a pool of good frames");
    assert_true(tallies->alone[FLAW_NONE].frames + alone.frames >= 200);
    assert_true(covered_share(&tallies->alone[FLAW_NONE]) >= 0.95);
    assert_true(covered_share(&tallies->pooled[FLAW_NONE]) >= 0.95);
    assert_true(covered_share(&alone) >= 0.95);
    assert_true(covered_share(&pooled) >= 0.95);
    for (int flaw = 0; flaw < FLAW_COUNT; flaw++)
        assert_true(covered_share(&tallies->alone[flaw]) >= 0.93 && covered_share(&tallies->pooled[flaw]) >= 0.93);
    // A loose bound is of no use: good frames would be rendered again.
    assert_true(quantile(tallies->alone[FLAW_NONE].ratios, tallies->alone[FLAW_NONE].frames, 0.5) < 2.5);
    assert_true(quantile(alone.ratios, alone.frames, 0.5) < 3.0);
    free(tallies);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(error95_holds)};

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, set_stage, clear_stage);
}
