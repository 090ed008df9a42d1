// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"

#include <inttypes.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const float HALF_LARGEST = 65504.0f;

static bool fail_memory(int width_px, int height_px, struct error *error)
{
    error_set(error, "image: no memory for %d x %d pixels", width_px, height_px);
    return false;
}

bool image_init(struct image *image, int width_px, int height_px, bool has_depth, bool has_transmittance,
                struct error *error)
{
    size_t count;

    *image = (struct image){0};
    if (width_px < 1 || width_px > IMAGE_SIDE_LIMIT || height_px < 1 || height_px > IMAGE_SIDE_LIMIT) {
        error_set(error, "image: expected sides from 1 to %d pixels, got %d x %d", IMAGE_SIDE_LIMIT, width_px,
                  height_px);
        return false;
    }
    count = (size_t)width_px * (size_t)height_px;
    image->width_px = width_px;
    image->height_px = height_px;
    image->rgba = malloc(count * 4 * sizeof *image->rgba);
    if (has_transmittance) image->transmittance = malloc(count * 4 * sizeof *image->transmittance);
    if (has_depth) image->depth = malloc(count * sizeof *image->depth);
    if (!image->rgba || (has_transmittance && !image->transmittance) || (has_depth && !image->depth)) {
        image_finish(image);
        return fail_memory(width_px, height_px, error);
    }
    alloc_prefer_large_pages(image->rgba, count * 4 * sizeof *image->rgba);
    alloc_prefer_large_pages(image->transmittance, count * 4 * sizeof *image->transmittance);
    alloc_prefer_large_pages(image->depth, count * sizeof *image->depth);
    return true;
}

bool image_ask_cut(struct image *image, struct error *error)
{
    size_t count = (size_t)image->width_px * (size_t)image->height_px;

    if (!image->cut) image->cut = malloc(count * sizeof *image->cut);
    return image->cut || fail_memory(image->width_px, image->height_px, error);
}

bool image_init_for_job(struct image *image, const struct job *job, struct error *error)
{
    return image_init(image, job->width_px, job->height_px, job->output.has_depth, job->output.has_transmittance,
                      error);
}

void image_finish(struct image *image)
{
    free(image->rgba);
    free(image->transmittance);
    free(image->depth);
    free(image->cut);
    free(image->doubts);
    *image = (struct image){0};
}

bool image_copy(struct image *to, const struct image *from, struct error *error)
{
    size_t count = (size_t)from->width_px * (size_t)from->height_px;

    if (!to->rgba && !image_init(to, from->width_px, from->height_px, from->depth, from->transmittance, error))
        return false;
    memcpy(to->rgba, from->rgba, 4 * count * sizeof *to->rgba);
    if (from->depth) memcpy(to->depth, from->depth, count * sizeof *to->depth);
    if (from->transmittance) memcpy(to->transmittance, from->transmittance, 4 * count * sizeof *to->transmittance);
    return true;
}

bool image_fits(const struct image *image, int width_px, int height_px, bool has_depth, bool has_transmittance)
{
    return image->rgba && image->width_px == width_px && image->height_px == height_px &&
           (image->depth != NULL) == has_depth && (image->transmittance != NULL) == has_transmittance;
}

static bool is_within(float value, float largest)
{
    return fabsf(value) <= largest; // false for NaN
}

// Has no early exit and compares magnitudes as integers, so that it vectorizes. The bits of positive floats are in the
// order of their values; infinity and NaN are the largest. The difference to the limit is negative for what exceeds it.
static bool row_is_within(const float *row, size_t count, float largest)
{
    int32_t signs = 0, limit;

    memcpy(&limit, &largest, sizeof limit);
    for (size_t i = 0; i < count; i++) {
        int32_t bits;

        memcpy(&bits, row + i, sizeof bits);
        signs |= limit - (bits & INT32_MAX);
    }
    return signs >= 0;
}

struct plane {
    const float *values;
    size_t components; // values a pixel
    size_t used;       // of the components
    const char *names[4];
    bool half;
};

struct faults {
    int64_t nan_count, infinite_count, large_count;
    // The first fault.
    const char *channel; // NULL: there is none
    size_t x, y;
    float value;
};

static void count_fault(struct faults *faults, const char *channel, size_t x, size_t y, float value)
{
    if (isnan(value))
        faults->nan_count++;
    else if (isinf(value))
        faults->infinite_count++;
    else
        faults->large_count++;
    if (faults->channel) return;
    faults->channel = channel;
    faults->x = x;
    faults->y = y;
    faults->value = value;
}

static void count_row(struct faults *faults, const struct plane *plane, size_t width, size_t y)
{
    float largest = plane->half ? HALF_LARGEST : 3.40282347e38f;
    const float *row = plane->values + y * width * plane->components;

    // A value that belongs to no channel only causes a second check of the row.
    if (row_is_within(row, width * plane->components, largest)) return;
    for (size_t i = 0; i < width * plane->components; i++) {
        size_t component = i % plane->components;

        if (component < plane->used && !is_within(row[i], largest))
            count_fault(faults, plane->names[component], i / plane->components, y, row[i]);
    }
}

static void report(const struct faults *faults, struct error *error)
{
    char counts[128];

    snprintf(counts, sizeof counts,
             "of the frame's values %" PRId64 " are NaN, %" PRId64 " infinite, %" PRId64 " too large for half",
             faults->nan_count, faults->infinite_count, faults->large_count);
    if (isfinite(faults->value))
        error_set(error,
                  "channel %s at pixel (%zu, %zu) is %g: half holds at most 65504, ask for \"pixel\": \"float\"; %s",
                  faults->channel, faults->x, faults->y, (double)faults->value, counts);
    else
        error_set(error, "channel %s at pixel (%zu, %zu) is %s: expected a finite number; %s", faults->channel,
                  faults->x, faults->y, isnan(faults->value) ? "NaN" : "infinite", counts);
}

static struct faults find_faults(const struct image *image, bool half, int first_row, int row_count)
{
    const struct plane planes[] = {
        {image->rgba, 4, 4, {"R", "G", "B", "A"}, half},
        {image->transmittance, 4, 3, {"transmittance.R", "transmittance.G", "transmittance.B"}, half},
        {image->depth, 1, 1, {"Z"}, false},
    };
    struct faults faults = {0};

    for (size_t i = 0; i < sizeof planes / sizeof planes[0]; i++)
        for (int y = first_row; planes[i].values && y < first_row + row_count; y++)
            count_row(&faults, &planes[i], (size_t)image->width_px, (size_t)y);
    return faults;
}

bool image_is_finite(const struct image *image, bool half, struct error *error)
{
    struct faults faults = find_faults(image, half, 0, image->height_px);

    if (!faults.channel) return true;
    report(&faults, error);
    return false;
}

bool image_rows_are_finite(const struct image *image, bool half, int first_row, int row_count)
{
    return !find_faults(image, half, first_row, row_count).channel;
}

// Compares each pixel with the next one. Sets `bits` to those of the first.
static bool are_equal(const float *pixels, size_t count, size_t components, uint32_t *bits)
{
    if (!pixels) return true;
    memcpy(bits, pixels, components * sizeof *pixels);
    return memcmp(pixels, pixels + components, (count - 1) * components * sizeof *pixels) == 0;
}

static const float *skip(const float *plane, size_t count)
{
    return plane ? plane + count : NULL;
}

bool image_rows_are_constant(const struct image *image, int first_row, int row_count, struct image_pixel *pixel)
{
    size_t first = (size_t)first_row * (size_t)image->width_px, count = (size_t)row_count * (size_t)image->width_px;

    *pixel = (struct image_pixel){0};
    return are_equal(skip(image->rgba, 4 * first), count, 4, pixel->rgba) &&
           are_equal(skip(image->transmittance, 4 * first), count, 4, pixel->transmittance) &&
           are_equal(skip(image->depth, first), count, 1, &pixel->depth);
}
