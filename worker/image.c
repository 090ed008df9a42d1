#include "worker/image.h"

#include "core/error.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const float HALF_LARGEST = 65504.0f;

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
        error_set(error, "image: no memory for %d x %d pixels", width_px, height_px);
        return false;
    }
    return true;
}

void image_finish(struct image *image)
{
    free(image->rgba);
    free(image->transmittance);
    free(image->depth);
    *image = (struct image){0};
}

static bool is_within(float value, float largest)
{
    return fabsf(value) <= largest; // false for NaN
}

// No early exit inside a row, so that it vectorizes.
static bool row_is_within(const float *row, size_t width, size_t components, size_t used, float largest)
{
    int outside = 0;

    for (size_t x = 0; x < width; x++)
        for (size_t i = 0; i < used; i++)
            outside |= !is_within(row[x * components + i], largest);
    return !outside;
}

static void report(const char *channel, size_t x, size_t y, float value, bool half, struct error *error)
{
    if (isfinite(value) && half)
        error_set(error, "channel %s at pixel (%zu, %zu) is %g: half holds at most 65504, ask for \"pixel\": \"float\"",
                  channel, x, y, (double)value);
    else
        error_set(error, "channel %s at pixel (%zu, %zu) is %s: expected a finite number", channel, x, y,
                  isnan(value) ? "NaN" : "infinite");
}

struct plane {
    const float *values;
    size_t components; // a pixel
    size_t used;       // of them
    const char *names[4];
    bool half;
};

static bool plane_is_finite(const struct plane *plane, size_t width, size_t height, struct error *error)
{
    float largest = plane->half ? HALF_LARGEST : 3.40282347e38f;

    for (size_t y = 0; y < height; y++) {
        const float *row = plane->values + y * width * plane->components;

        if (row_is_within(row, width, plane->components, plane->used, largest)) continue;
        for (size_t i = 0; i < width * plane->components; i++) {
            size_t component = i % plane->components;

            if (component >= plane->used || is_within(row[i], largest)) continue;
            report(plane->names[component], i / plane->components, y, row[i], plane->half, error);
            return false;
        }
    }
    return true;
}

bool image_is_finite(const struct image *image, bool half, struct error *error)
{
    struct plane planes[] = {
        {image->rgba, 4, 4, {"R", "G", "B", "A"}, half},
        {image->transmittance, 4, 3, {"transmittance.R", "transmittance.G", "transmittance.B"}, half},
        {image->depth, 1, 1, {"Z"}, false},
    };

    for (size_t i = 0; i < sizeof planes / sizeof planes[0]; i++) {
        if (!planes[i].values) continue;
        if (!plane_is_finite(&planes[i], (size_t)image->width_px, (size_t)image->height_px, error)) return false;
    }
    return true;
}
