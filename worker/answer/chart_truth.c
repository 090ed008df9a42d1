// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/chart_truth.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "worker/picture/audit_result.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE_LIMIT = 256 * 1024 * 1024 };

void chart_truth_finish(struct chart_truth *truth)
{
    free(truth->pixels);
    *truth = (struct chart_truth){0};
}

bool chart_truth_save(const struct chart_truth *truth, const char *path, struct error *error)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    bool ok;

    if (!out) abort();
    fprintf(out, "marchd-truth 1 %s %s %zu\n", truth->scene, truth->kind, truth->count);
    for (size_t i = 0; i < truth->count; i++) {
        const struct chart_truth_pixel *pixel = &truth->pixels[i];

        fprintf(out, "%d %d %.9g %.12g %.12g %.12g %.6g\n", pixel->x, pixel->y, pixel->weight, pixel->rgb[0],
                pixel->rgb[1], pixel->rgb[2], pixel->variance);
    }
    fclose(out);
    ok = file_write_atomic(path, text, size, error);
    if (!ok) error_prefix(error, "%s", path);
    free(text);
    return ok;
}

static bool read_pixels(struct chart_truth *truth, const char *text)
{
    truth->pixels = xcalloc(truth->count + 1, sizeof *truth->pixels);
    for (size_t i = 0; i < truth->count; i++) {
        struct chart_truth_pixel *pixel = &truth->pixels[i];

        text = strchr(text, '\n');
        if (!text) return false;
        text++;
        if (sscanf(text, "%d %d %lf %lf %lf %lf %lf", &pixel->x, &pixel->y, &pixel->weight, &pixel->rgb[0],
                   &pixel->rgb[1], &pixel->rgb[2], &pixel->variance) != 7)
            return false;
    }
    return true;
}

bool chart_truth_load(struct chart_truth *truth, const char *path, const char *scene, struct error *error)
{
    char *text = NULL;
    size_t length;
    bool ok = false;

    *truth = (struct chart_truth){0};
    if (!file_read_text(path, SIZE_LIMIT, &text, &length, error)) {
        error_prefix(error, "%s", path);
        return false;
    }
    if (sscanf(text, "marchd-truth 1 %32s %15s %zu\n", truth->scene, truth->kind, &truth->count) != 3 ||
        truth->count > length / 8)
        error_set(error, "%s: expected the truth of a chart", path);
    else if (strcmp(truth->scene, scene) != 0)
        error_set(error, "%s: it is the truth of another picture", path);
    else if (!read_pixels(truth, text))
        error_set(error, "%s: expected %zu pixels, got fewer", path, truth->count);
    else
        ok = true;
    if (!ok) chart_truth_finish(truth);
    free(text);
    return ok;
}

struct chart_error chart_truth_compare(const struct chart_truth *truth, const struct image *image, enum job_pixel pixel)
{
    struct chart_error error = {0};
    double squares = 0, light = 0, weights = 0, brightest = 0;

    for (size_t i = 0; i < truth->count; i++) {
        const struct chart_truth_pixel *at = &truth->pixels[i];
        double square = -at->variance;

        if (at->x < 0 || at->y < 0 || at->x >= image->width_px || at->y >= image->height_px) continue;
        weights += 3 * at->weight;
        for (size_t c = 0; c < 3; c++) {
            size_t value = 4 * ((size_t)at->y * (size_t)image->width_px + (size_t)at->x) + c;
            double difference = image_exr_stored(image->rgba[value], pixel) - at->rgb[c];

            if (!isfinite(difference)) return (struct chart_error){INFINITY, INFINITY};
            square += difference * difference;
            light += at->weight * at->rgb[c] * at->rgb[c];
            error.largest = fmax(error.largest, fabs(difference));
            brightest = fmax(brightest, fabs(at->rgb[c]));
        }
        squares += at->weight * square;
    }
    if (weights > 0) error.relative_rmse = sqrt(fmax(squares, 0) / (brightest < AUDIT_BLACK ? weights : light));
    return error;
}
