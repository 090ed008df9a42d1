// SPDX-License-Identifier: Apache-2.0
#include "tests/support/true_light.h"

#include "core/base/alloc.h"
#include "core/job/job.h"
#include "tests/support/load_grid.h"
#include "tests/support/load_texture.h"
#include "tests/support/render_frame.h"
#include "worker/picture/image.h"
#include "worker/picture/ray_counts.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// Planes of values, all pixels of one after all of the other.
enum { RADIANCE = 0, TRANSMITTANCE = 3, ALPHA = 6, DEPTH = 7, PLANES = 8 };

struct comparison {
    size_t count;  // of pixels
    float *seen;   // owned
    double *truth; // owned
};

static void note_seen(struct comparison *comparison, const struct image *image)
{
    size_t count = comparison->count;

    for (size_t i = 0; i < count; ++i) {
        for (size_t c = 0; c < 3; ++c) {
            comparison->seen[RADIANCE * count + 3 * i + c] = image->rgba[4 * i + c];
            comparison->seen[TRANSMITTANCE * count + 3 * i + c] = image->transmittance[4 * i + c];
        }
        comparison->seen[ALPHA * count + i] = image->rgba[4 * i + 3];
        comparison->seen[DEPTH * count + i] = image->depth[i];
    }
}

static void note_truth(struct comparison *comparison, size_t i, const struct reference_pixel *pixel, double depth)
{
    size_t count = comparison->count;

    for (size_t c = 0; c < 3; ++c) {
        comparison->truth[RADIANCE * count + 3 * i + c] = pixel->radiance[c];
        comparison->truth[TRANSMITTANCE * count + 3 * i + c] = pixel->transmittance[c];
    }
    comparison->truth[ALPHA * count + i] = pixel->alpha;
    comparison->truth[DEPTH * count + i] = depth;
}

static void measure(const struct job *job, struct comparison *comparison, struct true_rays *rays)
{
    struct still *still = xcalloc(1, sizeof *still);
    struct still_inputs inputs;

    load_grid_inputs(&inputs, job, 0);
    load_texture_inputs(&inputs, job);
    still_init_with_inputs(still, job, job_frame_time(job, 0), &inputs);
    for (size_t i = 0; i < comparison->count; ++i) {
        int x = (int)(i % (size_t)job->width_px), y = (int)(i / (size_t)job->width_px);
        struct reference_pixel pixel = reference_measure_pixel(still, x, y, NULL);

        note_truth(comparison, i, &pixel, reference_measure_depth(still, x, y));
        rays->count += pixel.ray_count / (double)comparison->count;
        rays->cut_count += pixel.cut_count / (double)comparison->count;
        rays->cut_throughput += pixel.cut_throughput / (double)comparison->count;
        rays->cut_by_depth += pixel.cut_by_depth / (double)comparison->count;
    }
    load_texture_finish(&inputs);
    load_grid_finish(&inputs);
    free(still);
}

// Measures, or takes from `kept` what was measured before.
static void find_truth(const struct job *job, struct comparison *comparison, struct true_rays *rays,
                       struct true_light_truth *kept)
{
    size_t size_bytes = PLANES * comparison->count * sizeof *comparison->truth;

    if (kept && kept->planes) {
        assert_int_equal(kept->pixel_count, comparison->count);
        memcpy(comparison->truth, kept->planes, size_bytes);
        *rays = kept->rays;
        return;
    }
    measure(job, comparison, rays);
    if (!kept) return;
    *kept = (struct true_light_truth){xmalloc(size_bytes), comparison->count, *rays};
    memcpy(kept->planes, comparison->truth, size_bytes);
}

static struct reference_error find_error(const struct comparison *comparison, size_t plane, size_t plane_count)
{
    return reference_image_error(comparison->seen + plane * comparison->count,
                                 comparison->truth + plane * comparison->count, plane_count * comparison->count);
}

// Sets the truth of the worst pixel to its value in the picture, so that it no longer counts.
static void pass_over_worst(struct comparison *comparison)
{
    static const size_t FIRST[] = {RADIANCE, TRANSMITTANCE, ALPHA, DEPTH}, EACH[] = {3, 3, 1, 1};
    size_t worst = 0;
    double most = 0.0;

    for (size_t k = 0; k < sizeof FIRST / sizeof *FIRST; ++k) {
        struct reference_error error = find_error(comparison, FIRST[k], EACH[k]);

        if (error.relative_rmse <= most) continue;
        most = error.relative_rmse;
        worst = error.largest_index / EACH[k];
    }
    for (size_t k = 0; k < sizeof FIRST / sizeof *FIRST; ++k) {
        for (size_t c = 0; c < EACH[k]; ++c) {
            size_t at = FIRST[k] * comparison->count + EACH[k] * worst + c;

            comparison->truth[at] = comparison->seen[at];
        }
    }
}

static void print(const struct true_light *light)
{
    print_message("relative RMSE of radiance %.2e (largest %.2e at %zu), transmittance %.2e, alpha %.2e, depth %.2e\n",
                  light->radiance.relative_rmse, light->radiance.largest, light->radiance.largest_index / 3,
                  light->transmittance.relative_rmse, light->alpha.relative_rmse, light->depth.relative_rmse);
    if (light->rays_seen.count == 0.0) return;
    print_message("rays %.4f (truly %.4f), cut %.4f (%.4f), of throughput %.6f (%.6f)\n", light->rays_seen.count,
                  light->rays_true.count, light->rays_seen.cut_count, light->rays_true.cut_count,
                  light->rays_seen.cut_throughput, light->rays_true.cut_throughput);
}

static struct true_light compare(const struct job *job, enum gl_backend backend, size_t stray_count,
                                 struct true_light_truth *kept)
{
    struct comparison comparison = {.count = (size_t)job->width_px * (size_t)job->height_px};
    struct true_light light = {0};
    struct ray_counts counts;
    struct image image;

    comparison.seen = xcalloc(PLANES * comparison.count, sizeof *comparison.seen);
    comparison.truth = xcalloc(PLANES * comparison.count, sizeof *comparison.truth);
    render_frame_counting_rays(backend, job, &image, &counts);
    note_seen(&comparison, &image);
    find_truth(job, &comparison, &light.rays_true, kept);
    light.rays_seen = (struct true_rays){counts.rays, counts.cut_rays, counts.cut_throughput, counts.cut_by_depth};
    if (!counts.is_known) light.rays_true = (struct true_rays){0};
    for (size_t i = 0; i < stray_count; ++i)
        pass_over_worst(&comparison);
    light.radiance = find_error(&comparison, RADIANCE, 3);
    light.transmittance = find_error(&comparison, TRANSMITTANCE, 3);
    light.alpha = find_error(&comparison, ALPHA, 1);
    light.depth = find_error(&comparison, DEPTH, 1);
    print(&light);
    image_finish(&image);
    free(comparison.seen);
    free(comparison.truth);
    return light;
}

struct true_light true_light_compare(const struct job *job, enum gl_backend backend)
{
    return compare(job, backend, 0, NULL);
}

struct true_light true_light_compare_but(const struct job *job, enum gl_backend backend, size_t stray_count)
{
    return compare(job, backend, stray_count, NULL);
}

struct true_light true_light_compare_with(const struct job *job, enum gl_backend backend,
                                          struct true_light_truth *truth)
{
    return compare(job, backend, 0, truth);
}

void true_light_truth_finish(struct true_light_truth *truth)
{
    free(truth->planes);
    *truth = (struct true_light_truth){.planes = NULL};
}

bool true_light_is_within(const struct true_light *light, double tolerance)
{
    return light->radiance.relative_rmse <= tolerance && light->transmittance.relative_rmse <= tolerance &&
           light->alpha.relative_rmse <= tolerance;
}
