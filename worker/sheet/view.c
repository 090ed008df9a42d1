// SPDX-License-Identifier: Apache-2.0
#include "worker/sheet/view.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "worker/picture/image_exr.h"
#include "worker/picture/image_png_quick.h"
#include "worker/picture/srgb_table.h"
#include "worker/sheet/exposure.h"
#include "worker/sheet/view_channel.h"
#include "worker/sheet/view_shrink.h"

#include <math.h>
#include <stdlib.h>

static const double FAR_GREY = 64.0 / 255; // of depth

struct view {
    const struct view_params *params; // borrowed
    struct view_channel channel;
    struct view_shrink shrink;
    struct exposure *exposure; // owned; NULL: none is chosen
    float near, far;           // of the lines so far; near over far: none has a depth
    int width_px;              // of the file
};

static void note_luminance(struct view *view, const float *values)
{
    size_t width = (size_t)view->width_px;

    for (size_t x = 0; x < width; x++) {
        const float *value = values + x;

        exposure_add(view->exposure, view->channel.kind == VIEW_GREY
                                         ? value[0]
                                         : exposure_luminance(value[0], value[width], value[2 * width]));
    }
}

static void note_depth(struct view *view, const float *values)
{
    for (int x = 0; x < view->width_px; x++) {
        if (!(values[x] > 0) || !isfinite(values[x])) continue;
        view->near = fminf(view->near, values[x]);
        view->far = fmaxf(view->far, values[x]);
    }
}

static void on_line(void *user, int row, const float *values)
{
    struct view *view = user;

    if (view->exposure) note_luminance(view, values);
    if (view->channel.kind == VIEW_DEPTH) note_depth(view, values);
    view_shrink_add_line(&view->shrink, row, values, (size_t)view->width_px);
}

// The part, and how large it is shown.
static bool lay_out(struct view *view, const struct image_exr_facts *facts, enum view_fault *fault, struct error *error)
{
    const struct view_params *params = view->params;
    int width = params->width_px ? params->width_px : facts->width_px - params->x;
    int height = params->height_px ? params->height_px : facts->height_px - params->y;
    struct view_part part = {params->x, params->y, width, height};

    *fault = VIEW_FAULT_PARAMS;
    if (part.x < 0 || part.y < 0 || width < 1 || height < 1 || width > facts->width_px - part.x ||
        height > facts->height_px - part.y) {
        error_set(error, "the part of %d x %d pixels at %d, %d: expected one inside the picture of %d x %d", width,
                  height, part.x, part.y, facts->width_px, facts->height_px);
        return false;
    }
    if (!view_channel_find(&view->channel, params->fd, params->channel, error)) return false;
    *fault = VIEW_FAULT_FILE;
    return view_shrink_init(&view->shrink, &part, params->size_px ? params->size_px : VIEW_SIZE_LIMIT,
                            view->channel.kind == VIEW_DEPTH  ? VIEW_SHRINK_DEPTH
                            : view->channel.kind == VIEW_GREY ? VIEW_SHRINK_ONE
                                                              : VIEW_SHRINK_THREE,
                            error);
}

// What holds for the whole picture is found in all lines, even if few are shown.
static bool read_lines(struct view *view, const struct image_exr_facts *facts, struct error *error)
{
    bool is_whole = view->exposure || view->channel.kind == VIEW_DEPTH;
    struct image_exr_lines lines = {.width_px = facts->width_px,
                                    .height_px = facts->height_px,
                                    .first_row = is_whole ? 0 : view->shrink.part.y,
                                    .row_count = is_whole ? facts->height_px : view->shrink.part.height_px,
                                    .on_line = on_line,
                                    .user = view};

    for (int i = 0; i < IMAGE_EXR_LINES_CHANNELS; i++)
        lines.channels[i] = view->channel.names[i];
    return image_exr_read_lines(view->params->fd, &lines, error);
}

static unsigned char encode_depth(const struct view *view, float depth)
{
    double span = 1.0 / (double)view->near - 1.0 / (double)view->far, at = 1.0;

    if (!(depth > 0)) return 0;
    if (span > 0) at = (1.0 / (double)depth - 1.0 / (double)view->far) / span;
    return (unsigned char)lround(255.0 * (FAR_GREY + (1.0 - FAR_GREY) * fmin(fmax(at, 0.0), 1.0)));
}

static bool write_png(struct view *view, double stops, enum view_fault *fault, struct error *error)
{
    const struct view_shrink *shrink = &view->shrink;
    size_t count = (size_t)shrink->width_px * (size_t)shrink->height_px;
    unsigned char *rgb = malloc(count * 3);
    struct srgb_table table;
    float gain = (float)exp2(stops);
    bool ok;

    if (!rgb) {
        error_set(error, "no memory for %d x %d pixels", shrink->width_px, shrink->height_px);
        return false;
    }
    srgb_table_init(&table);
    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < 3; c++) {
            float value = view_shrink_value(shrink, i, c);

            rgb[3 * i + c] =
                view->channel.kind == VIEW_DEPTH ? encode_depth(view, value) : srgb_table_encode(&table, value * gain);
        }
    *fault = VIEW_FAULT_OUTPUT;
    ok = image_png_quick_write(view->params->out, rgb, shrink->width_px, shrink->height_px, error);
    free(rgb);
    return ok;
}

static double find_stops(const struct view *view)
{
    if (view->exposure) return exposure_choose(view->exposure);
    return view->params->has_exposure ? view->params->exposure : 0.0;
}

static bool draw(struct view *view, const struct image_exr_facts *facts, struct view_result *result,
                 enum view_fault *fault, struct error *error)
{
    bool is_depth = view->channel.kind == VIEW_DEPTH, has_depth;

    if (!is_depth && !view->params->has_exposure && view->channel.is_light)
        view->exposure = xcalloc(1, sizeof *view->exposure);
    view->near = INFINITY;
    view->far = -INFINITY;
    if (!read_lines(view, facts, error)) return false;
    has_depth = is_depth && view->near <= view->far;
    *result = (struct view_result){.width_px = view->shrink.width_px,
                                   .height_px = view->shrink.height_px,
                                   .file_width_px = facts->width_px,
                                   .file_height_px = facts->height_px,
                                   .exposure = is_depth ? NAN : find_stops(view),
                                   .near = has_depth ? (double)view->near : NAN,
                                   .far = has_depth ? (double)view->far : NAN};
    return write_png(view, is_depth ? 0.0 : result->exposure, fault, error);
}

bool view_write(const struct view_params *params, struct view_result *result, enum view_fault *fault,
                struct error *error)
{
    struct view view = {.params = params};
    struct image_exr_facts facts;
    bool ok;

    *fault = VIEW_FAULT_FILE;
    if (!image_exr_read(params->fd, NULL, &facts, 1, error)) return false;
    view.width_px = facts.width_px;
    ok = lay_out(&view, &facts, fault, error) && draw(&view, &facts, result, fault, error);
    view_channel_finish(&view.channel);
    view_shrink_finish(&view.shrink);
    free(view.exposure);
    return ok;
}
