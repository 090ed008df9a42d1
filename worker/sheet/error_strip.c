// SPDX-License-Identifier: Apache-2.0
#include "worker/sheet/error_strip.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "worker/picture/image.h"
#include "worker/picture/image_png.h"
#include "worker/picture/srgb.h"
#include "worker/sheet/exposure.h"
#include "worker/sheet/pixel_font.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    TILE_WIDTH_MAX = 480, // of larger pictures only some pixels are shown
    GAP_PX = 4,
    GREY = 40,
    BAR_HEIGHT_PX = 12,
    PAIRS_A_ROW = 2,
    SHEET_PIXEL_LIMIT = 64 * 1024 * 1024
};

// The quantile of the differences that gets the brightest colour.
static const double SCALE_SHARE = 0.98, LEAST_SCALE = 1e-6, ROUNDING = 1e-3;

struct strip {
    const struct error_strip_params *params;
    int tile_width, tile_height, width, height, font_scale;
    double rms, scale, gain;
    unsigned char *rgb; // owned
};

static size_t pixel_at(const struct image *image, int x, int y, const struct strip *strip)
{
    int column = (int)((int64_t)x * image->width_px / strip->tile_width);
    int row = (int)((int64_t)y * image->height_px / strip->tile_height);

    return 4 * ((size_t)row * (size_t)image->width_px + (size_t)column);
}

// The difference, relative to the truth's RMS.
static double difference(const struct strip *strip, const struct image *image, size_t at)
{
    const float *seen = &image->rgba[at], *truth = &strip->params->truth.image->rgba[at];
    double sum = 0;

    for (int c = 0; c < 3; c++)
        sum += (double)seen[c] - truth[c];
    return sum / (3 * strip->rms);
}

static double find_rms(const struct image *image)
{
    size_t count = (size_t)image->width_px * (size_t)image->height_px;
    double sum = 0;

    for (size_t i = 0; i < 4 * count; i++)
        if (i % 4 < 3) sum += (double)image->rgba[i] * image->rgba[i];
    return fmax(sqrt(sum / (3 * (double)count)), 1e-12);
}

static int compare(const void *a, const void *b)
{
    double left = *(const double *)a, right = *(const double *)b;

    return left < right ? -1 : left > right;
}

// Rounds up to 1, 2 or 5 times a power of ten.
static double round_up(double value)
{
    double decade = pow(10, floor(log10(value)));

    for (int i = 0; i < 3; i++) {
        static const double steps[] = {1, 2, 5};

        if (value <= steps[i] * decade * (1 + ROUNDING)) return steps[i] * decade;
    }
    return 10 * decade;
}

// Finds one scale for all maps from the differences in the tiles.
static double choose_scale(const struct strip *strip)
{
    const struct error_strip_params *params = strip->params;
    size_t tile = (size_t)strip->tile_width * (size_t)strip->tile_height, count = 0;
    double *all = xcalloc(tile * params->count + 1, sizeof *all), scale;

    for (size_t i = 0; i < params->count; i++)
        for (size_t k = 0; k < tile; k++) {
            const struct image *image = params->pictures[i].image;
            double apart = difference(
                strip, image,
                pixel_at(image, (int)(k % (size_t)strip->tile_width), (int)(k / (size_t)strip->tile_width), strip));

            if (isfinite(apart) && apart != 0) all[count++] = fabs(apart);
        }
    qsort(all, count, sizeof *all, compare);
    scale = count ? all[(size_t)(SCALE_SHARE * (double)(count - 1))] : LEAST_SCALE;
    free(all);
    return round_up(fmax(scale, LEAST_SCALE));
}

// Colours a `value` in [-1, 1] of the scale. Values beyond have the colour of the end; NaN is white.
static void put_signed(unsigned char *rgb, double value)
{
    static const double warm[] = {1.0, 0.62, 0.18}, cold[] = {0.25, 0.62, 1.0};
    const double *color = value > 0 ? warm : cold;
    double amount = fmin(fabs(value), 1);

    for (int c = 0; c < 3; c++)
        rgb[c] = isnan(value) ? 255 : (unsigned char)lround(255 * pow(amount, 0.75) * color[c]);
}

static unsigned char *row_of(const struct strip *strip, int left, int y)
{
    return strip->rgb + 3 * ((size_t)y * (size_t)strip->width + (size_t)left);
}

static void put_label(const struct strip *strip, int left, int top, int width, const char *label)
{
    char *text = xasprintf("%.*s", pixel_font_count(width, strip->font_scale), label);

    pixel_font_draw(strip->rgb, strip->width, strip->height, left, top, strip->font_scale, text);
    free(text);
}

static void put_picture(const struct strip *strip, int left, int top, const struct error_strip_picture *picture)
{
    for (int y = 0; y < strip->tile_height; y++)
        for (int x = 0; x < strip->tile_width; x++) {
            const float *value = &picture->image->rgba[pixel_at(picture->image, x, y, strip)];

            for (int c = 0; c < 3; c++)
                row_of(strip, left + x, top + y)[c] = srgb_encode_byte(value[c] * (float)strip->gain);
        }
    put_label(strip, left, top + strip->tile_height - pixel_font_height(strip->font_scale), strip->tile_width,
              picture->label);
}

static void put_map(const struct strip *strip, int left, int top, const struct image *image)
{
    for (int y = 0; y < strip->tile_height; y++)
        for (int x = 0; x < strip->tile_width; x++)
            put_signed(row_of(strip, left + x, top + y),
                       difference(strip, image, pixel_at(image, x, y, strip)) / strip->scale);
}

static void put_bar(const struct strip *strip)
{
    int top = strip->height - pixel_font_height(strip->font_scale) - BAR_HEIGHT_PX;
    char text[96];

    for (int y = 0; y < BAR_HEIGHT_PX; y++)
        for (int x = 0; x < strip->tile_width; x++)
            put_signed(row_of(strip, x, top + y), 2.0 * x / (strip->tile_width - 1) - 1);
    snprintf(text, sizeof text, "-%g TO %g OF THE RMS", strip->scale, strip->scale);
    put_label(strip, 0, top + BAR_HEIGHT_PX, strip->width, text);
}

static bool lay_out(struct strip *strip, struct error *error)
{
    const struct image *image = strip->params->truth.image;
    int pairs = (int)strip->params->count + 1, rows = (pairs + PAIRS_A_ROW - 1) / PAIRS_A_ROW;
    int columns = 2 * (pairs < PAIRS_A_ROW ? pairs : PAIRS_A_ROW);

    strip->tile_width = image->width_px < TILE_WIDTH_MAX ? image->width_px : TILE_WIDTH_MAX;
    strip->tile_height = (int)lround((double)strip->tile_width * image->height_px / image->width_px);
    if (strip->tile_height < 1) strip->tile_height = 1;
    strip->font_scale = strip->tile_width >= 300 ? 2 : 1;
    strip->width = columns * (strip->tile_width + GAP_PX) - GAP_PX;
    strip->height = rows * (strip->tile_height + GAP_PX) + BAR_HEIGHT_PX + pixel_font_height(strip->font_scale);
    if ((int64_t)strip->width * strip->height > SHEET_PIXEL_LIMIT) {
        error_set(error, "expected a sheet of at most %d pixels, got %d x %d", SHEET_PIXEL_LIMIT, strip->width,
                  strip->height);
        return false;
    }
    strip->rgb = xmalloc(3 * (size_t)strip->width * (size_t)strip->height);
    memset(strip->rgb, GREY, 3 * (size_t)strip->width * (size_t)strip->height);
    return true;
}

static void put_pairs(const struct strip *strip)
{
    const struct error_strip_params *params = strip->params;

    for (size_t i = 0; i <= params->count; i++) {
        int left = (int)(i % PAIRS_A_ROW) * 2 * (strip->tile_width + GAP_PX);
        int top = (int)(i / PAIRS_A_ROW) * (strip->tile_height + GAP_PX);

        put_picture(strip, left, top, i < params->count ? &params->pictures[i] : &params->truth);
        if (i < params->count) put_map(strip, left + strip->tile_width + GAP_PX, top, params->pictures[i].image);
    }
}

bool error_strip_write(const struct error_strip_params *params, struct error_strip_result *result, struct error *error)
{
    struct strip strip = {.params = params};
    struct exposure *exposure = xcalloc(1, sizeof *exposure);
    bool ok;

    exposure_add_image(exposure, params->truth.image);
    strip.gain = exp2(exposure_choose(exposure));
    free(exposure);
    if (!lay_out(&strip, error)) return false;
    strip.rms = find_rms(params->truth.image);
    strip.scale = choose_scale(&strip);
    put_pairs(&strip);
    put_bar(&strip);
    *result = (struct error_strip_result){strip.width, strip.height, strip.scale};
    ok = image_png_write(params->out, strip.rgb, strip.width, strip.height, error);
    free(strip.rgb);
    return ok;
}
