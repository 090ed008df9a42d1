// SPDX-License-Identifier: Apache-2.0
#include "worker/sheet/preview.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"
#include "worker/picture/image_png.h"
#include "worker/picture/srgb.h"
#include "worker/sheet/exposure.h"
#include "worker/sheet/pixel_font.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    TILE_WIDTH_PX = 320,
    GAP_PX = 2, // between tiles
    GAP_GREY = 48,
    SHEET_SIDE_LIMIT = 32768
};
static const double SHEET_SHAPE = 1.5; // width to height

// `facts` may be NULL.
static bool read_file(const char *path, struct image *image, struct image_exr_facts *facts, struct error *error)
{
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    bool ok = false;

    if (fd < 0) {
        error_set_errno(error, errno, "%s", path);
        return false;
    }
    ok = image_exr_read(fd, image, facts, 1, error);
    if (!ok) error_prefix(error, "%s", path);
    close(fd);
    return ok;
}

// The input pixels [first, end) of a row or column that one output pixel covers, with their shares.
struct span {
    int first, end;
    double start, stop; // in input pixels
};

static struct span make_span(int index, int count, int input_count)
{
    struct span span = {.start = (double)index * input_count / count,
                        .stop = (double)(index + 1) * input_count / count};

    span.first = (int)span.start;
    span.end = (int)ceil(span.stop);
    if (span.end > input_count) span.end = input_count;
    return span;
}

static double span_weight(const struct span *span, int at)
{
    return fmin(span->stop, at + 1.0) - fmax(span->start, at);
}

// Averages linear light over each tile pixel's area. Premultiplied colour over black needs no change.
static void shrink(const struct image *image, float *tile, int width, int height)
{
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            struct span rows = make_span(y, height, image->height_px), columns = make_span(x, width, image->width_px);
            double sum[3] = {0}, weight_sum = 0;

            for (int j = rows.first; j < rows.end; j++)
                for (int i = columns.first; i < columns.end; i++) {
                    const float *pixel = image->rgba + ((size_t)j * (size_t)image->width_px + (size_t)i) * 4;
                    double weight = span_weight(&rows, j) * span_weight(&columns, i);

                    for (int c = 0; c < 3; c++)
                        sum[c] += weight * (double)pixel[c];
                    weight_sum += weight;
                }
            for (int c = 0; c < 3; c++)
                *tile++ = (float)(sum[c] / weight_sum);
        }
}

struct sheet {
    const struct preview_params *params; // borrowed
    int columns, rows;
    int tile_width, tile_height;
    int image_width, image_height; // the same in every file
    float *tiles;                  // owned; 3 a pixel
    unsigned char *rgb;            // owned
    int width, height;
};

static int choose_columns(const struct sheet *sheet)
{
    int best_columns = 1;
    int count = (int)sheet->params->file_count;
    double best = INFINITY;

    for (int columns = 1; columns <= count; columns++) {
        int rows = (count + columns - 1) / columns;
        double shape = (double)columns * sheet->tile_width / ((double)rows * sheet->tile_height);
        double distance = fabs(log(shape / SHEET_SHAPE));

        if (distance >= best) continue;
        best = distance;
        best_columns = columns;
    }
    return best_columns;
}

// Finds the layout from the first image.
static bool lay_out(struct sheet *sheet, const struct image *image, struct error *error)
{
    const struct preview_params *params = sheet->params;
    int64_t width, height;

    sheet->image_width = image->width_px;
    sheet->image_height = image->height_px;
    sheet->tile_width = params->tile_width_px ? params->tile_width_px : TILE_WIDTH_PX;
    sheet->tile_height = (int)lround((double)sheet->tile_width * image->height_px / image->width_px);
    if (sheet->tile_height < 1) sheet->tile_height = 1;
    sheet->columns = params->columns;
    if (sheet->columns > (int)params->file_count) sheet->columns = (int)params->file_count;
    if (sheet->columns < 1) sheet->columns = choose_columns(sheet);
    sheet->rows = (int)((params->file_count + (size_t)sheet->columns - 1) / (size_t)sheet->columns);
    width = (int64_t)sheet->columns * (sheet->tile_width + GAP_PX) - GAP_PX;
    height = (int64_t)sheet->rows * (sheet->tile_height + GAP_PX) - GAP_PX;
    if (width > SHEET_SIDE_LIMIT || height > SHEET_SIDE_LIMIT) {
        error_set(error, "a sheet of %lld x %lld pixels: expected sides up to %d; fewer files or a smaller tile",
                  (long long)width, (long long)height, SHEET_SIDE_LIMIT);
        return false;
    }
    sheet->width = (int)width;
    sheet->height = (int)height;
    sheet->tiles =
        malloc(params->file_count * (size_t)sheet->tile_width * (size_t)sheet->tile_height * 3 * sizeof *sheet->tiles);
    sheet->rgb = malloc((size_t)width * (size_t)height * 3);
    if (sheet->tiles && sheet->rgb) {
        memset(sheet->rgb, GAP_GREY, (size_t)width * (size_t)height * 3);
        return true;
    }
    error_set(error, "no memory for a sheet of %d x %d pixels", sheet->width, sheet->height);
    return false;
}

static bool check_size(const char *path, const struct image *image, int width, int height, struct error *error)
{
    if (image->width_px == width && image->height_px == height) return true;
    error_set(error, "%s: expected %d x %d pixels as in the first file, got %d x %d", path, width, height,
              image->width_px, image->height_px);
    return false;
}

static bool read_tiles(struct sheet *sheet, struct exposure *exposure, struct error *error)
{
    const struct preview_params *params = sheet->params;

    for (size_t i = 0; i < params->file_count; i++) {
        struct image image;
        bool ok;

        if (!read_file(params->files[i], &image, NULL, error)) return false;
        ok = i > 0 ? check_size(params->files[i], &image, sheet->image_width, sheet->image_height, error)
                   : lay_out(sheet, &image, error);
        if (ok) {
            exposure_add_image(exposure, &image);
            shrink(&image, sheet->tiles + i * (size_t)sheet->tile_width * (size_t)sheet->tile_height * 3,
                   sheet->tile_width, sheet->tile_height);
        }
        image_finish(&image);
        if (!ok) return false;
    }
    return true;
}

static void draw_tile(struct sheet *sheet, size_t index, float gain)
{
    const struct preview_params *params = sheet->params;
    const float *tile = sheet->tiles + index * (size_t)sheet->tile_width * (size_t)sheet->tile_height * 3;
    int left = (int)(index % (size_t)sheet->columns) * (sheet->tile_width + GAP_PX);
    int top = (int)(index / (size_t)sheet->columns) * (sheet->tile_height + GAP_PX);
    int scale = sheet->tile_width >= TILE_WIDTH_PX / 2 ? 2 : 1;

    for (int y = 0; y < sheet->tile_height; y++) {
        unsigned char *row = sheet->rgb + ((size_t)(top + y) * (size_t)sheet->width + (size_t)left) * 3;

        for (int i = 0; i < sheet->tile_width * 3; i++)
            row[i] = srgb_encode_byte(*tile++ * gain);
    }
    if (params->labels && params->labels[index]) {
        char *label = xasprintf("%.*s", pixel_font_count(sheet->tile_width, scale), params->labels[index]);

        pixel_font_draw(sheet->rgb, sheet->width, sheet->height, left,
                        top + sheet->tile_height - pixel_font_height(scale), scale, label);
        free(label);
    }
}

bool preview_write_sheet(const struct preview_params *params, struct preview_result *result, struct error *error)
{
    struct sheet sheet = {.params = params};
    struct exposure *exposure = xcalloc(1, sizeof *exposure);
    bool ok = read_tiles(&sheet, exposure, error);

    if (ok) {
        *result =
            (struct preview_result){.exposure = params->has_exposure ? params->exposure : exposure_choose(exposure),
                                    .width_px = sheet.width,
                                    .height_px = sheet.height};
        for (size_t i = 0; i < params->file_count; i++)
            draw_tile(&sheet, i, (float)exp2(result->exposure));
        ok = image_png_write(params->out, sheet.rgb, sheet.width, sheet.height, error);
    }
    free(exposure);
    free(sheet.tiles);
    free(sheet.rgb);
    return ok;
}

static bool choose_exposure(const struct preview_params *params, double *stops, struct error *error)
{
    struct exposure *exposure;
    bool ok = true;

    *stops = params->exposure;
    if (params->has_exposure) return true;
    exposure = xcalloc(1, sizeof *exposure);
    for (size_t i = 0; i < params->file_count && ok; i++) {
        struct image image;

        ok = read_file(params->files[i], &image, NULL, error);
        if (!ok) break;
        exposure_add_image(exposure, &image);
        image_finish(&image);
    }
    *stops = exposure_choose(exposure);
    free(exposure);
    return ok;
}

void preview_format_name(size_t index, char name[static PREVIEW_NAME_SIZE])
{
    snprintf(name, PREVIEW_NAME_SIZE, "%06zu.png", index);
}

static bool write_frame(const struct image *image, float gain, const char *folder, size_t index, struct error *error)
{
    size_t count = (size_t)image->width_px * (size_t)image->height_px;
    unsigned char *rgb = malloc(count * 3);
    char name[PREVIEW_NAME_SIZE];
    char *path;
    bool ok;

    if (!rgb) {
        error_set(error, "no memory for %d x %d pixels", image->width_px, image->height_px);
        return false;
    }
    for (size_t i = 0; i < count * 3; i++)
        rgb[i] = srgb_encode_byte(image->rgba[i / 3 * 4 + i % 3] * gain);
    preview_format_name(index, name);
    path = xasprintf("%s/%s", folder, name);
    ok = image_png_write(path, rgb, image->width_px, image->height_px, error);
    free(path);
    free(rgb);
    return ok;
}

bool preview_write_frames(const struct preview_params *params, struct preview_result *result, struct error *error)
{
    *result = (struct preview_result){0};
    if (!choose_exposure(params, &result->exposure, error)) return false;
    for (size_t i = 0; i < params->file_count; i++) {
        struct image_exr_facts facts;
        struct image image;
        bool ok;

        if (!read_file(params->files[i], &image, &facts, error)) return false;
        if (i == 0) {
            result->fps_numerator = facts.fps_numerator;
            result->fps_denominator = facts.fps_denominator;
            result->width_px = image.width_px;
            result->height_px = image.height_px;
        }
        ok = check_size(params->files[i], &image, result->width_px, result->height_px, error) &&
             write_frame(&image, (float)exp2(result->exposure), params->out, i, error);
        image_finish(&image);
        if (!ok) return false;
    }
    return true;
}
