// SPDX-License-Identifier: Apache-2.0
#include "tests/support/stability.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job_json.h"
#include "reference/reference.h"
#include "tests/support/shader_dir.h"
#include "tests/support/stability_scene.h"
#include "tests/support/stability_sparse.h"
#include "tests/support/temp_folder.h"
#include "worker/audit/truth.h"
#include "worker/gl/gl_context.h"
#include "worker/picture/image.h"
#include "worker/plan/tolerance.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH_PX = STABILITY_WIDTH_PX, HEIGHT_PX = STABILITY_HEIGHT_PX, PIXELS = WIDTH_PX * HEIGHT_PX };

const struct stability_sweep stability_sweeps[] = {
    {.name = "extinction times the step, before a background as bright as the medium",
     .slug = "furnace",
     .values = {1e-3, 1e-2, 0.1, 0.5, 1, 2, 10, 100, 1000},
     .count = 9},
    {.name = "optical depth of a lit medium",
     .slug = "depth",
     .values = {1e-6, 1e-4, 1e-2, 1, 10, 100, 1000, 1e4},
     .count = 8},
    {.name = "g, the light behind the medium",
     .slug = "forward",
     .values = {-0.999, -0.99, -0.9, 0, 0.9, 0.99, 0.999},
     .count = 7},
    {.name = "g, the light behind the camera",
     .slug = "backward",
     .values = {-0.999, -0.99, -0.9, 0, 0.9, 0.99, 0.999},
     .count = 7},
    {.name = "distance of a light in the medium from a camera ray, m",
     .slug = "inside",
     .values = {0.3, 0.1, 0.03, 1e-2, 1e-3, 1e-4, 1e-6},
     .count = 7},
    {.name = "distance of a light from the camera, m",
     .slug = "camera",
     .values = {1, 0.1, 1e-2, 1e-3, 1e-4, 1e-6, 0},
     .count = 7},
    {.name = "distance of a light from the medium, m",
     .slug = "far",
     .values = {1, 10, 100, 1e3, 1e4, 1e5, 1e6},
     .count = 7},
    {.name = "thickness of a shell over the step, of optical depth 1 throughout",
     .slug = "shell",
     .values = {10, 2, 1, 0.5, 0.1, 1e-2, 1e-3},
     .count = 7},
    {.name = "distance of everything from the origin, m",
     .slug = "origin",
     .values = {0, 100, 1e3, 1e4, 1e5, 1e6, 1e8},
     .count = 7},
    {.name = "voxels along the view of 1.6 m",
     .slug = "side",
     .values = {1, 2, 3, 8, 64},
     .count = 5,
     .quick_count = 3,
     .is_apart = true,
     .is_grid = true},
    {.name = "edge of a voxel across the view over the one along it",
     .slug = "aspect",
     .values = {0.1, 1, 10, 100},
     .count = 4,
     .quick_count = 3,
     .is_apart = true,
     .is_grid = true},
    {.name = "share of the values' range that a transfer function shows",
     .slug = "transfer",
     .values = {0.3, 0.1, 0.03, 1e-2, 1e-3},
     .count = 5,
     .is_apart = true,
     .is_grid = true},
    {.name = "how many times too low a lipschitz is, of a shell around a hollow",
     .slug = "lipschitz",
     .values = {1, 2, 10, 100},
     .count = 4,
     .is_apart = true},
    {.name = "flicker: false change from frame to frame as a light moves so far, m",
     .slug = "flicker",
     .values = {1e-6, 1e-4, 1e-2, 0.1},
     .count = 4,
     .is_change = true},
    {.name = "irradiance of the light", .slug = "bright", .values = {1, 1e3, 1e4, 1e5, 1e6, 1e9, 1e12}, .count = 7},
    {.name = "width of a filament, px", .slug = "filament", .values = {16, 8, 4, 2, 1}, .count = 5, .is_sparse = true},
    {.name = "width of a lone voxel, px",
     .slug = "speck",
     .values = {16, 8, 4, 2, 1},
     .count = 5,
     .quick_count = 4, // the smallest is missed by plans, whose steps are longer
     .is_sparse = true},
    {.name = "width of a glint in a mirror, px",
     .slug = "glint",
     .values = {16, 8, 4, 2, 1},
     .count = 5,
     .quick_count = 3, // no plan and no audit sees smaller ones
     .is_sparse = true},
    {.name = "period of a checker, px",
     .slug = "checker",
     .values = {64, 32, 16, 8, 4, 2},
     .count = 6,
     .is_sparse = true},
    {.name = "flicker of sparse pixels as a light moves so far, m",
     .slug = "blink",
     .values = {1e-4, 1e-3, 1e-2, 0.1},
     .count = 4,
     .is_change = true,
     .is_sparse = true},
    {.name = "flicker of sparse pixels as the camera moves so far, px",
     .slug = "pan",
     .values = {0.01, 0.1, 1, 10},
     .count = 4,
     .is_change = true,
     .is_sparse = true},
};
const size_t stability_sweep_count = sizeof stability_sweeps / sizeof *stability_sweeps;

const struct stability_method stability_methods[] = {
    {.name = "riemann", .quality = "\"method\":\"riemann\",\"step\":0.05,\"light_steps\":32"},
    {.name = "midpoint", .quality = "\"method\":\"midpoint\",\"step\":0.05,\"light_step\":0.05"},
    {.name = "jittered", .quality = "\"method\":\"jittered\",\"step\":0.05,\"light_step\":0.05"},
    {.name = "adaptive", .quality = "\"method\":\"adaptive\",\"step\":0.05,\"light_step\":0.05,\"depth_step\":0.1"},
    {.name = "gauss", .quality = "\"method\":\"gauss\",\"step\":0.05,\"light_step\":0.05,\"order\":3"},
    {.name = "equiangular", .quality = "\"method\":\"equiangular\",\"points\":16", .wants_even = true},
    {.name = "cached", .quality = "\"method\":\"cached\",\"step\":0.05,\"light_grid\":64"},
    {.name = "preintegrated", .quality = "\"method\":\"preintegrated\",\"step\":0.05", .only = "transfer"},
    {.name = "tracking", .quality = "\"method\":\"tracking\",\"estimator\":\"ratio\"", .only = "furnace"},
    {.name = "pixels 16", .pixels = {.stride = 16, .threshold = 0.01}},
    {.name = "pixels 4", .pixels = {.stride = 4, .threshold = 0.01}},
    {.name = "auto", .quality = "\"tolerance\":0.01", .tolerance = 0.01},
};
const size_t stability_method_count = sizeof stability_methods / sizeof *stability_methods;

struct stability_sweep stability_quick(const struct stability_sweep *sweep)
{
    struct stability_sweep quick = *sweep;

    if (sweep->quick_count > 0) quick.count = sweep->quick_count;
    return quick;
}

bool stability_concerns(const struct stability_sweep *sweep, const struct stability_method *method)
{
    bool is_grid = sweep->is_grid || stability_scene_twin(sweep);

    if (sweep->is_sparse) return method->pixels.stride > 0 || method->tolerance > 0;
    if (method->pixels.stride > 0) return false;
    return method->only ? strcmp(method->only, sweep->slug) == 0 : !(method->wants_even && is_grid);
}

// What renders, for a sweep and a method.
struct stand {
    const struct stability_method *method;
    const struct stability_sweep *sweep;
    struct renderer *renderer;
    struct tolerance *tolerance;
    int64_t serial; // of the job
};

static bool render(const struct stand *stand, const struct job *job, int32_t frame, struct image *image,
                   struct error *error)
{
    struct renderer_result result;
    struct tolerance_result kept;

    if (!(stand->method->tolerance > 0))
        return renderer_render(stand->renderer, &(struct renderer_frame){.job = job, .frame = frame, .image = image},
                               &result, error);
    return tolerance_render(
        stand->tolerance,
        &(struct tolerance_params){.job = job, .serial = stand->serial, .frame = frame, .image = image}, &kept, error);
}

// What a sweep's pictures should show, which most methods share.
struct known {
    const char *slug;
    size_t count;
    double values[STABILITY_POINT_LIMIT + 1]; // one more is before any of them: 0
    double rgb[STABILITY_POINT_LIMIT + 1][3 * PIXELS];
};

static bool measure_truth(const struct stand *stand, const struct job *job, int32_t frame, double *rgb)
{
    const struct still_function functions[SCENE_MEDIUM_LIMIT] = {{.at = stability_scene_twin(stand->sweep)}};
    const struct integrate_accuracy rough = {.relative = 1e-3};
    struct pixel places[PIXELS];
    struct truth_pixel pixels[PIXELS];
    struct error error = {{0}};
    struct truth *truth =
        truth_open(&(struct truth_params){.job = job, .frame = frame, .functions = functions}, &error);

    if (!truth) {
        printf("%s\n", error.message);
        return false;
    }
    for (int i = 0; i < PIXELS; i++)
        places[i] = (struct pixel){i % WIDTH_PX, i / WIDTH_PX};
    truth_measure_many(truth, &(struct truth_many){.points = places,
                                                   .pixels = pixels,
                                                   .count = PIXELS,
                                                   .accuracy = stand->sweep->is_apart ? &rough : NULL});
    for (size_t i = 0; i < PIXELS; i++)
        memcpy(rgb + 3 * i, pixels[i].rgb, sizeof pixels[i].rgb);
    truth_close(truth);
    return true;
}

static const double *find_truth(const struct stand *stand, const struct job *job, int32_t frame, double value)
{
    static struct known all[2];
    struct known *known = &all[stand->method->wants_even];
    size_t i = 0;

    if (known->slug != stand->sweep->slug) *known = (struct known){.slug = stand->sweep->slug};
    while (i < known->count && known->values[i] != value)
        i++;
    if (i < known->count) return known->rgb[i];
    if (!measure_truth(stand, job, frame, known->rgb[i])) return NULL;
    known->values[known->count++] = value;
    return known->rgb[i];
}

static void compare(const struct image *image, const double *truth, struct stability_point *point, float *seen)
{
    double sum = 0.0, true_sum = 0.0;

    for (size_t i = 0; i < 3 * PIXELS; i++) {
        seen[i] = image->rgba[i / 3 * 4 + i % 3];
        sum += seen[i];
        true_sum += truth[i];
    }
    point->is_finite = image_is_finite(image, false, NULL);
    point->fits_half = image_is_finite(image, true, NULL);
    point->gain = true_sum > 0.0 ? sum / true_sum - 1.0 : sum;
    point->error = reference_image_error(seen, truth, 3 * PIXELS).relative_rmse;
}

static void refuse(struct stability_point *points, size_t count, const char *reason)
{
    for (size_t i = 0; i < count; i++) {
        points[i].is_refused = true;
        snprintf(points[i].reason, sizeof points[i].reason, "%.*s", (int)sizeof points[i].reason - 1, reason);
    }
}

struct picture {
    float seen[3 * PIXELS];
    double truth[3 * PIXELS];
};

// By how much `now` changes since `then` that it should not, of its light.
static double find_change(const struct picture *then, const struct picture *now)
{
    double apart = 0.0, light = 0.0;

    for (int i = 0; i < 3 * PIXELS; i++) {
        double seen = (double)now->seen[i] - (double)then->seen[i], known = now->truth[i] - then->truth[i];

        apart += (seen - known) * (seen - known);
        light += now->truth[i] * now->truth[i];
    }
    return sqrt(apart / light);
}

// Frames of a job, one for each of `values`; in a sweep of changes after one that they are changes since.
static bool measure_frames(const struct stand *stand, const struct job *job, const double *values, size_t count,
                           struct stability_point *points)
{
    size_t first = stand->sweep->is_change ? 1 : 0;
    struct picture then = {0}, now = {0};
    struct error error = {{0}};
    struct image image = {0};
    bool ok = image_init(&image, WIDTH_PX, HEIGHT_PX, false, false, &error);

    for (size_t i = 0; ok && i < count + first; i++) {
        bool is_base = i < first;
        struct stability_point base, *point = is_base ? &base : &points[i - first];
        const double *truth;

        if (!render(stand, job, (int32_t)i, &image, &error)) {
            refuse(is_base ? points : point, is_base ? count : 1, error.message);
            if (is_base) break;
            continue;
        }
        truth = find_truth(stand, job, (int32_t)i, is_base ? 0.0 : values[i - first]);
        ok = truth != NULL;
        if (!ok) break;
        memcpy(now.truth, truth, sizeof now.truth);
        compare(&image, truth, point, now.seen);
        if (is_base) then = now;
        if (!is_base && first > 0) point->error = find_change(&then, &now);
    }
    image_finish(&image);
    return ok;
}

static bool measure_job(const struct stand *stand, const double *values, size_t count, const char *folder,
                        struct stability_point *points)
{
    double all[STABILITY_POINT_LIMIT + 1] = {0};
    size_t first = stand->sweep->is_change ? 1 : 0;
    struct error error = {{0}};
    struct job job = {0};
    bool ok = true;
    char *text;

    memcpy(all + first, values, count * sizeof *values);
    stability_scene_write_voxels(stand->sweep, values[0], folder);
    text = stability_scene_write(stand->sweep, stand->method, all, count + first, folder);
    if (job_parse(&job, text, strlen(text), NULL, &error))
        ok = measure_frames(stand, &job, values, count, points);
    else
        refuse(points, count, error.message);
    job_finish(&job);
    free(text);
    return ok;
}

static bool measure_small(struct gl_context *context, const struct stability_sweep *sweep,
                          const struct stability_method *method, struct stability_point *points)
{
    struct stand stand = {
        .method = method, .sweep = sweep, .renderer = renderer_create(context, test_shader_dir()), .serial = 1};
    // Planned as farms do: by itself, not by what goes through other values.
    bool is_apart = sweep->is_apart || method->tolerance > 0;
    size_t together = is_apart ? 1 : sweep->count;
    void *folder = NULL;
    bool ok = true;

    if (temp_folder_create(&folder) != 0) abort();
    memset(points, 0, sweep->count * sizeof *points);
    stand.tolerance = tolerance_create(stand.renderer);
    for (size_t i = 0; ok && i < sweep->count; i += together) {
        ok = measure_job(&stand, sweep->values + i, together, folder, points + i);
        stand.serial++;
    }
    tolerance_destroy(stand.tolerance);
    renderer_destroy(stand.renderer);
    if (temp_folder_destroy(&folder) != 0) ok = false;
    return ok;
}

bool stability_measure(struct gl_context *context, const struct stability_sweep *sweep,
                       const struct stability_method *method, struct stability_point *points)
{
    return sweep->is_sparse ? stability_sparse_measure(context, sweep, method, points)
                            : measure_small(context, sweep, method, points);
}
