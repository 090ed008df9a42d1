// Audits of light above order 1, by random paths and by grids: how often error95 is above the true error.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "core/job/plan_json.h"
#include "tests/support/flaw.h"
#include "tests/support/gl_stage.h"
#include "tests/support/random_job.h"
#include "tests/support/temp_folder.h"
#include "worker/audit/audit.h"
#include "worker/audit/audit_map.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"
#include "worker/plan/scatter_evidence.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 24, HEIGHT_PX = 14, PIXELS = WIDTH_PX * HEIGHT_PX, STRATUM_LIMIT = 12 };
// Nothing but a black light moves: all frames show the same light, and share no random number.
enum { FRAME = 13, OTHER_FRAME = 14, POOL_FRAME = 15 };
enum { SOLIDS_EVERY = 3 };  // scenes that paths alone show
enum { SIMILAR_AFTER = 4 }; // scatterings
enum { FEW_STRIDE = 4 };    // px, where most are interpolated

static const double TRUTH_SHARE = 0.3, TRUTH_FLOOR = 0.1; // the truth's accuracy relative to the tolerance, as audits'
static const double COVERED = 0.93;
static const double TELLABLE =
    0.2;                        // the smallest true error, relative to the tolerance, with which estimates are compared
static const double OFF = 1.25; // a factor by which the RMS of estimates may differ from the true error
// Fewer audits say nothing.
enum { JUDGED = 20 };

struct stratum {
    char name[32];
    int pictures, audits, covered, over, passed;
    int known;      // audits of errors that the truth can tell
    double ratios;  // sum of the logarithms of error95 over the true error
    double squares; // sum of the squares of the estimate over the true one
};

struct campaign {
    struct gl_stage gl;
    struct stratum strata[STRATUM_LIMIT];
    int stratum_count, audit_count, seed;
    double tolerance; // of all scenes; 0: 10 and 3 %, by turns
    bool has_other_ways;
};

struct sight {
    struct job job;
    double tolerance;
    struct truth *audited;     // of FRAME: what audits compare with
    struct truth_pixel *light; // owned; of OTHER_FRAME, one of each pixel
};

static void add(struct campaign *campaign, const char *name, const struct stratum *of)
{
    struct stratum *stratum = campaign->strata;

    while (stratum < campaign->strata + campaign->stratum_count && strcmp(stratum->name, name) != 0)
        stratum++;
    if (stratum == campaign->strata + campaign->stratum_count) {
        assert_true(campaign->stratum_count++ < STRATUM_LIMIT);
        snprintf(stratum->name, sizeof stratum->name, "%s", name);
    }
    stratum->pictures++;
    stratum->audits += of->audits;
    stratum->covered += of->covered;
    stratum->over += of->over;
    stratum->passed += of->passed;
    stratum->known += of->known;
    stratum->ratios += of->ratios;
    stratum->squares += of->squares;
}

static void parse(struct sight *sight, const char *volume, uint64_t seed)
{
    struct error error = {{0}};
    char *text = random_job_write(&(struct random_job){.volume = volume,
                                                       .seed = seed,
                                                       .quality = "{\"tolerance\": 0.03}",
                                                       .width_px = WIDTH_PX,
                                                       .height_px = HEIGHT_PX,
                                                       .scatters = true,
                                                       .has_solids = seed % SOLIDS_EVERY == 0});

    if (!job_parse(&sight->job, text, strlen(text), NULL, &error)) fail_msg("%s\n%s", error.message, text);
    free(text);
}

static struct truth *open_truth(const struct job *job, int32_t frame)
{
    struct error error = {{0}};
    struct truth *truth = truth_open(&(struct truth_params){.job = job, .frame = frame}, &error);

    if (!truth) fail_msg("%s", error.message);
    return truth;
}

// Mean square of the light, the noise of the truth taken out.
static double find_power(const struct sight *sight)
{
    double sum = 0.0;

    for (int i = 0; i < 3 * PIXELS; i++)
        sum += pow(sight->light[i / 3].rgb[i % 3], 2) - pow(sight->light[i / 3].half[i % 3], 2);
    return fmax(sum / (3 * PIXELS), 0.0);
}

// False where all is black.
static bool find_light(struct sight *sight)
{
    struct truth *truth = open_truth(&sight->job, OTHER_FRAME);
    struct pixel all[PIXELS];
    struct integrate_accuracy accuracy = {.relative = 10.0, .floor = AUDIT_BLACK};
    struct truth_many many = {.points = all, .count = PIXELS, .accuracy = &accuracy};

    for (int i = 0; i < PIXELS; i++)
        all[i] = (struct pixel){i % WIDTH_PX, i / WIDTH_PX};
    many.pixels = sight->light = xcalloc(PIXELS, sizeof *sight->light);
    truth_measure_many(truth, &many);
    accuracy = (struct integrate_accuracy){.relative = TRUTH_SHARE * sight->tolerance,
                                           .floor = fmax(TRUTH_FLOOR * sqrt(find_power(sight)), AUDIT_BLACK)};
    truth_measure_many(truth, &many);
    truth_close(truth);
    return find_power(sight) > AUDIT_BLACK * AUDIT_BLACK;
}

static void render_at(const struct campaign *campaign, const struct job *job, int32_t frame, struct image *image)
{
    struct renderer_result result;
    struct error error = {{0}};

    if (!image_init_for_job(image, job, &error) ||
        !renderer_render(campaign->gl.renderer, &(struct renderer_frame){.job = job, .frame = frame, .image = image},
                         &result, &error))
        fail_msg("%s", error.message);
}

static void render(const struct campaign *campaign, const struct job *job, struct image *image)
{
    render_at(campaign, job, FRAME, image);
}

// The products of the differences to both halves of the truth, so that its noise counts nothing.
static double find_error(const struct sight *sight, const struct image *image)
{
    double apart = 0.0;

    for (int i = 0; i < 3 * PIXELS; i++) {
        const struct truth_pixel *known = &sight->light[i / 3];
        double off = image_exr_stored(image->rgba[4 * (i / 3) + i % 3], sight->job.output.pixel) - known->rgb[i % 3];

        apart += (off * off - known->half[i % 3] * known->half[i % 3]) / (3 * PIXELS);
    }
    return sqrt(fmax(apart, 0.0) / find_power(sight));
}

// What a plan leaves: pixels, evenly spread, of another frame in the same quality.
static void fill_pool(const struct campaign *campaign, const struct sight *sight, const struct job *drawn,
                      struct audit_pool *pool)
{
    struct pixel points[PLAN_JSON_SAMPLE_LIMIT];
    struct truth_pixel light[PLAN_JSON_SAMPLE_LIMIT];
    struct truth *truth = open_truth(&sight->job, POOL_FRAME);
    const struct integrate_accuracy accuracy = audit_accuracy(sight->tolerance, find_power(sight));
    size_t count = 0;
    struct image image;

    render_at(campaign, drawn, POOL_FRAME, &image);
    for (int i = 0; i < PIXELS; i++)
        if (i % 4 > 0 && count < PLAN_JSON_SAMPLE_LIMIT) points[count++] = (struct pixel){i % WIDTH_PX, i / WIDTH_PX};
    truth_measure_many(truth,
                       &(struct truth_many){.points = points, .pixels = light, .count = count, .accuracy = &accuracy});
    *pool = (struct audit_pool){0};
    scatter_evidence_add(&image, points, light, count, drawn->output.pixel, pool);
    image_finish(&image);
    truth_close(truth);
}

static const char *way_of(const struct job_quality *quality)
{
    if (quality->pixels.stride > 0) return "few pixels";
    if (quality->similar_after > 0) return "similar media";
    if (quality->scatter_from == JOB_SCATTER_FROM_LIGHTS) return "particles";
    return job_method_name(quality->method);
}

// Audits the picture several times, each time in other pixels. `pool` may be NULL.
static void audit_picture(struct campaign *campaign, const struct sight *sight, const struct job *drawn,
                          const struct image *image, const struct audit_pool *pool, const char *kind)
{
    double truly = find_error(sight, image);
    struct stratum own = {.audits = campaign->audit_count};
    char name[32];

    for (int i = 0; i < campaign->audit_count; i++) {
        struct job job = *drawn;
        struct audit_result result;

        snprintf(job.hash, sizeof job.hash, "audit %d of %s", i, kind); // draws follow from it
        assert_true(audit_frame(&(struct audit_params){.job = &job,
                                                       .frame = FRAME,
                                                       .image = image,
                                                       .truth = sight->audited,
                                                       .pool = pool,
                                                       .tolerance = sight->tolerance},
                                &result));
        own.covered += result.error95 >= truly;
        own.over += truly > sight->tolerance;
        own.passed += truly > sight->tolerance && result.error + result.spread <= sight->tolerance;
        if (truly < TELLABLE * sight->tolerance) continue;
        own.known++;
        own.squares += pow(result.error / truly, 2.0);
        own.ratios += log(fmax(result.error95, 1e-9) / truly);
    }
    add(campaign, kind, &own);
    if (!pool) {
        snprintf(name, sizeof name, "by %s", way_of(&drawn->quality));
        add(campaign, name, &own);
        snprintf(name, sizeof name, "of %g %%", 100.0 * sight->tolerance);
        add(campaign, name, &own);
    }
    if (10 * own.covered < 9 * own.audits)
        printf("scene %d by %s, %s: truly %.2e of %g; the bound holds in %d of %d\n", campaign->seed,
               way_of(&drawn->quality), kind, truly, sight->tolerance, own.covered, own.audits);
}

static void try_quality(struct campaign *campaign, const struct sight *sight, const struct job_quality *quality)
{
    static const enum flaw flaws[] = {FLAW_SPOT, FLAW_DIM, FLAW_CONSTANT, FLAW_LIGHT_GONE};
    enum flaw flaw = flaws[campaign->seed / SOLIDS_EVERY % 4];
    struct job drawn = sight->job, spoilt;
    struct audit_pool pool = {0};
    struct image image, other;

    drawn.quality = *quality;
    render(campaign, &drawn, &image);
    if (quality->scatter_grid > 0) fill_pool(campaign, sight, &drawn, &pool);
    audit_picture(campaign, sight, &drawn, &image, NULL, "as drawn");
    if (quality->scatter_grid > 0) audit_picture(campaign, sight, &drawn, &image, &pool, "pooled");
    if (flaw_spoil_light(flaw, &drawn, FRAME, &spoilt)) {
        render(campaign, &spoilt, &other);
        flaw_mix(flaw, &other, &image);
        image_finish(&other);
    }
    flaw_spoil_values(flaw, &image);
    audit_picture(campaign, sight, &drawn, &image, NULL, "broken");
    if (quality->scatter_grid > 0) audit_picture(campaign, sight, &drawn, &image, &pool, "pooled, broken");
    audit_pool_finish(&pool);
    image_finish(&image);
}

static double try_error(const struct campaign *campaign, const struct sight *sight, const struct job_quality *quality)
{
    struct job drawn = sight->job;
    struct image image;
    double error;

    drawn.quality = *quality;
    render(campaign, &drawn, &image);
    error = find_error(sight, &image);
    image_finish(&image);
    return error;
}

// So many paths that their noise is around the tolerance: where a wrong bound matters. Once also in few pixels.
static void try_paths(struct campaign *campaign, const struct sight *sight)
{
    struct job_quality quality = {.method = JOB_METHOD_PATHS, .samples = 1, .paths = 64, .max_cut = 1.0};
    double error = try_error(campaign, sight, &quality);

    for (int i = 0; i < 2; i++) {
        double wanted = (i == 0 ? 0.7 : 1.4) * sight->tolerance;

        quality.paths = (int)fmin(fmax(64.0 * pow(error / wanted, 2.0), 1.0), 20000.0);
        try_quality(campaign, sight, &quality);
    }
    quality.step = 0.02; // of the march of what is seen
    quality.pixels = (struct job_pixels){.stride = FEW_STRIDE, .threshold = sight->tolerance};
    try_quality(campaign, sight, &quality);
}

static bool emits(const struct scene *scene)
{
    bool emits = false;

    for (size_t i = 0; i < scene->medium_count; i++)
        emits |= scene->media[i].has_emission || scene->media[i].blackbody.grid_name;
    return emits;
}

// The same grid, filled in other ways.
static void try_other_ways(struct campaign *campaign, const struct sight *sight, const struct job_quality *grid)
{
    struct job_quality quality = *grid;

    quality.scatter_from = JOB_SCATTER_FROM_LIGHTS;
    if (!emits(&sight->job.scene)) try_quality(campaign, sight, &quality);
    quality.scatter_from = JOB_SCATTER_FROM_NODES;
    quality.similar_after = SIMILAR_AFTER;
    if (sight->job.scene.orders == SCENE_ORDERS_ALL) try_quality(campaign, sight, &quality);
}

// The first grid within the tolerance, and one before it.
static void try_grids(struct campaign *campaign, const struct sight *sight)
{
    static const struct {
        int cells, paths;
    } rungs[] = {{4, 16}, {4, 64}, {6, 128}, {8, 256}, {11, 512}, {16, 512}, {22, 1024}};
    enum { COUNT = sizeof rungs / sizeof rungs[0] };
    struct job_quality quality = {
        .method = JOB_METHOD_CACHED, .samples = 1, .step = 0.04, .light_grid = 32, .max_cut = 1.0};
    int i = 0;

    for (; i < COUNT; i++) {
        quality.scatter_grid = rungs[i].cells;
        quality.paths = rungs[i].paths;
        if (i + 1 == COUNT || try_error(campaign, sight, &quality) <= sight->tolerance) break;
    }
    try_quality(campaign, sight, &quality);
    if (campaign->has_other_ways) try_other_ways(campaign, sight, &quality);
    if (i == 0) return;
    quality.scatter_grid = rungs[i - 1].cells;
    quality.paths = rungs[i - 1].paths;
    try_quality(campaign, sight, &quality);
}

static void try_scene(struct campaign *campaign, const char *volume, uint64_t seed)
{
    struct sight sight = {.tolerance = campaign->tolerance > 0.0 ? campaign->tolerance : seed % 2 ? 0.1 : 0.03};

    campaign->seed = (int)seed;
    parse(&sight, volume, seed);
    if (find_light(&sight)) {
        sight.audited = open_truth(&sight.job, FRAME);
        try_paths(campaign, &sight);
        if (seed % SOLIDS_EVERY != 0) try_grids(campaign, &sight);
        truth_close(sight.audited);
    }
    free(sight.light);
    job_finish(&sight.job);
}

static void report(const struct campaign *campaign)
{
    printf("%-16s %8s %8s %12s %15s %16s %12s\n", "audits", "pictures", "audits", "bound holds", "error over true",
           "error95 over it", "over: pass");
    for (int i = 0; i < campaign->stratum_count; i++) {
        const struct stratum *stratum = &campaign->strata[i];

        printf("%-16s %8d %8d %10.2f %% %15.2f %16.2f %5d / %5d\n", stratum->name, stratum->pictures, stratum->audits,
               100.0 * stratum->covered / stratum->audits, sqrt(stratum->squares / stratum->known),
               exp(stratum->ratios / stratum->known), stratum->passed, stratum->over);
    }
}

struct range {
    uint64_t first, last;
    int audit_count;
    double tolerance;
    bool has_other_ways; // to fill grids
};

static void try_range(const struct range *range, const char *volume)
{
    struct campaign campaign = {.gl = gl_stage_open(GL_BACKEND_SOFTWARE, NULL),
                                .audit_count = range->audit_count,
                                .tolerance = range->tolerance,
                                .has_other_ways = range->has_other_ways};

    random_job_write_volume(volume);
    for (uint64_t seed = range->first; seed <= range->last; seed++)
        try_scene(&campaign, volume, seed);
    report(&campaign);
    gl_stage_close(campaign.gl);
    assert_true(campaign.stratum_count > 0);
    for (int i = 0; i < campaign.stratum_count; i++) {
        const struct stratum *stratum = &campaign.strata[i];

        if (stratum->audits >= JUDGED && stratum->covered < COVERED * stratum->audits)
            fail_msg("%s: the bound holds too seldom", stratum->name);
        // What a frame shares with others says little of it where it is broken in few pixels.
        if (strcmp(stratum->name, "pooled, broken") != 0 && stratum->known >= JUDGED &&
            fabs(log(stratum->squares / stratum->known)) > 2.0 * log(OFF))
            fail_msg("%s: the estimates are off", stratum->name);
    }
}

// One scene tells a wrong bound from a right one; bench/coverage has many.
static void bounds_hold(void **state)
{
    try_range(&(struct range){.first = 2, .last = 2, .audit_count = 8, .tolerance = 0.1},
              temp_folder_path(state, "random.nrrd"));
}

static struct range asked; // from the command line

static void bounds_hold_where_asked(void **state)
{
    try_range(&asked, temp_folder_path(state, "random.nrrd"));
}

// Two or three arguments: the first and the last seed of the scenes, and a tolerance.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(bounds_hold, temp_folder_create, temp_folder_destroy),
    };
    const struct CMUnitTest by_hand[] = {
        cmocka_unit_test_setup_teardown(bounds_hold_where_asked, temp_folder_create, temp_folder_destroy),
    };

    if (argc < 3) return cmocka_run_group_tests(tests, NULL, NULL);
    asked = (struct range){strtoull(argv[1], NULL, 10), strtoull(argv[2], NULL, 10), 10,
                           argc > 3 ? strtod(argv[3], NULL) : 0.0, true};
    return cmocka_run_group_tests(by_hand, NULL, NULL);
}
