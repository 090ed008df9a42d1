// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/ray_counts.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/picture/image.h"

static void keep_most(struct ray_counts_peak *most, double value, int x_px, int y_px)
{
    if (value > most->value) *most = (struct ray_counts_peak){value, x_px, y_px};
}

void ray_counts_add_pixel(struct ray_counts *counts, const float paths[static 4], int x_px, int y_px)
{
    counts->cut_throughput += paths[0];
    counts->cut_rays += paths[1];
    counts->rays += paths[2];
    counts->cut_by_depth += paths[3];
    keep_most(&counts->most_cut, paths[0], x_px, y_px);
    keep_most(&counts->most_rays, paths[2], x_px, y_px);
}

void ray_counts_add_row(struct ray_counts *counts, const float *paths, int width_px, int y_px)
{
    for (int x = 0; x < width_px; ++x)
        ray_counts_add_pixel(counts, paths + 4 * (size_t)x, x, y_px);
}

void ray_counts_find_means(struct ray_counts *counts, int64_t pixel_count, int sample_count)
{
    double sample_total = (double)pixel_count * sample_count;

    counts->cut_throughput /= sample_total;
    counts->cut_rays /= sample_total;
    counts->rays /= sample_total;
    counts->cut_by_depth /= sample_total;
    counts->most_cut.value /= sample_count;
    counts->most_rays.value /= sample_count;
}

void ray_counts_find_share(struct ray_counts *counts, const struct image *image)
{
    size_t count = (size_t)image->width_px * (size_t)image->height_px;
    double brightest = 0.0, sum = 0.0, share = counts->cut_throughput;

    counts->cut_share = share;
    if (share == 0.0) return;
    for (size_t i = 0; i < count; ++i)
        for (size_t channel = 0; channel < 3; ++channel) {
            double value = image->rgba[4 * i + channel];

            sum += value;
            if (value > brightest) brightest = value;
        }
    if (brightest > 0.0) share *= brightest * (3.0 * (double)count) / sum;
    counts->cut_share = share > 1.0 ? 1.0 : share; // NaN stays
}

// Names the limit to relax: the one whose part is too large by itself, else the one with the larger part.
static const char *remedy(double by_depth, double by_throughput, double max_cut)
{
    if (by_depth > max_cut && by_throughput > max_cut) return "a larger max_depth and a smaller min_throughput";
    return by_depth >= by_throughput ? "a larger max_depth" : "a smaller min_throughput";
}

bool ray_counts_check(const struct ray_counts *counts, const struct job_quality *quality, struct error *error)
{
    double depth_part = counts->cut_throughput > 0.0 ? counts->cut_by_depth / counts->cut_throughput : 0.0;
    double by_depth = depth_part * counts->cut_share, by_throughput = (1.0 - depth_part) * counts->cut_share;

    if (!counts->is_known || counts->cut_share <= quality->max_cut) return true;
    error_set(
        error,
        "quality: cut rays may have taken %.3g %% of the light, max_cut allows %.3g %%; max_depth %d cut %.3g %%, "
        "min_throughput %g cut %.3g %%, most at pixel (%d, %d); expected %s, or a max_cut %s %.3g",
        100.0 * counts->cut_share, 100.0 * quality->max_cut, quality->max_depth, 100.0 * by_depth,
        quality->min_throughput, 100.0 * by_throughput, counts->most_cut.x_px, counts->most_cut.y_px,
        remedy(by_depth, by_throughput, quality->max_cut), counts->cut_share < 1.0 ? "above" : "of", counts->cut_share);
    return false;
}
