#include "tests/support/stability.h"

#include "core/alloc.h"
#include "core/error.h"
#include "core/job_json.h"
#include "reference/reference.h"
#include "tests/support/shader_dir.h"
#include "worker/gl_context.h"
#include "worker/image.h"
#include "worker/renderer.h"
#include "worker/truth.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Odd, so that one ray goes through the middle.
enum { WIDTH_PX = 13, HEIGHT_PX = 9, PIXELS = WIDTH_PX * HEIGHT_PX };

#define STEP 0.05

const struct stability_sweep stability_sweeps[] = {
    {"extinction times the step, before a background as bright as the medium",
     "furnace",
     {1e-3, 1e-2, 0.1, 0.5, 1, 2, 10, 100, 1000},
     9},
    {"optical depth of a lit medium", "depth", {1e-6, 1e-4, 1e-2, 1, 10, 100, 1000, 1e4}, 8},
    {"g, the light behind the medium", "forward", {-0.999, -0.99, -0.9, 0, 0.9, 0.99, 0.999}, 7},
    {"g, the light behind the camera", "backward", {-0.999, -0.99, -0.9, 0, 0.9, 0.99, 0.999}, 7},
    {"distance of a light in the medium from a camera ray, m", "inside", {0.3, 0.1, 0.03, 1e-2, 1e-3, 1e-4, 1e-6}, 7},
    {"distance of a light from the camera, m", "camera", {1, 0.1, 1e-2, 1e-3, 1e-4, 1e-6, 0}, 7},
    {"distance of a light from the medium, m", "far", {1, 10, 100, 1e3, 1e4, 1e5, 1e6}, 7},
    {"thickness of a shell over the step, of optical depth 1 throughout", "shell", {10, 2, 1, 0.5, 0.1, 1e-2, 1e-3}, 7},
    {"distance of everything from the origin, m", "origin", {0, 100, 1e3, 1e4, 1e5, 1e6, 1e8}, 7},
    {"irradiance of the light", "bright", {1, 1e3, 1e4, 1e5, 1e6, 1e9, 1e12}, 7},
};
const size_t stability_sweep_count = sizeof stability_sweeps / sizeof *stability_sweeps;

const struct stability_method stability_methods[] = {
    {"riemann", "\"method\":\"riemann\",\"step\":0.05,\"light_steps\":32", false},
    {"midpoint", "\"method\":\"midpoint\",\"step\":0.05,\"light_step\":0.05", false},
    {"jittered", "\"method\":\"jittered\",\"step\":0.05,\"light_step\":0.05", false},
    {"adaptive", "\"method\":\"adaptive\",\"step\":0.05,\"light_step\":0.05,\"depth_step\":0.1", false},
    {"gauss", "\"method\":\"gauss\",\"step\":0.05,\"light_step\":0.05,\"order\":3", false},
    {"equiangular", "\"method\":\"equiangular\",\"points\":16", true},
    {"cached", "\"method\":\"cached\",\"step\":0.05,\"light_grid\":64", false},
};
const size_t stability_method_count = sizeof stability_methods / sizeof *stability_methods;

// The scene at one value.
struct setup {
    double sigma_s, sigma_a, emission, g, background, irradiance, shift;
    double light[3];
    double thickness; // m; 0: a ball of radius 1, else a box so thin
    bool is_inverse_square;
};

static struct setup setup_of(const struct stability_sweep *sweep, double value)
{
    struct setup setup = {.sigma_s = 1, .irradiance = 1, .light = {2, 1.5, 2}};
    const char *slug = sweep->slug;

    if (strcmp(slug, "furnace") == 0)
        setup = (struct setup){.sigma_a = value / STEP, .emission = value / STEP, .background = 1, .light = {9, 9, 9}};
    else if (strcmp(slug, "depth") == 0)
        setup.sigma_s = value / 2;
    else if (strcmp(slug, "forward") == 0 || strcmp(slug, "backward") == 0) {
        setup.g = value;
        memcpy(setup.light, (double[]){0.3, 0.2, strcmp(slug, "forward") == 0 ? -4 : 6}, sizeof setup.light);
    } else if (strcmp(slug, "inside") == 0) {
        memcpy(setup.light, (double[]){value, 0, 0.1}, sizeof setup.light);
        setup.is_inverse_square = true;
    } else if (strcmp(slug, "camera") == 0) {
        memcpy(setup.light, (double[]){0, value, 4}, sizeof setup.light);
        setup.is_inverse_square = true;
    } else if (strcmp(slug, "far") == 0)
        memcpy(setup.light, (double[]){0.6 * (1 + value), 0.8 * (1 + value), 0}, sizeof setup.light);
    else if (strcmp(slug, "shell") == 0) {
        setup.thickness = value * STEP;
        setup.sigma_s = 1 / setup.thickness;
    } else if (strcmp(slug, "origin") == 0)
        setup.shift = value;
    else
        setup.irradiance = value;
    return setup;
}

// Numbers that move from frame to frame, so that one program serves a sweep; in `size` values a frame.
static void write_keys(FILE *out, const char *key, const double *values, size_t frames, size_t size)
{
    fprintf(out, "\"%s\":{\"keys\":[", key);
    for (size_t i = 0; i < frames; i++) {
        fprintf(out, "%s[%zu,%s", i > 0 ? "," : "", i, size > 1 ? "[" : "");
        for (size_t k = 0; k < size; k++)
            fprintf(out, "%s%.17g", k > 0 ? "," : "", values[size * i + k]);
        fprintf(out, "%s]", size > 1 ? "]" : "");
    }
    fputs("],\"interpolation\":\"hold\"},", out);
}

enum { NUMBERS = 7, SIGMA_S = 0, SIGMA_A, EMISSION, G, BACKGROUND, IRRADIANCE, RADIUS };
enum { VECTORS = 5, EYE = 0, TARGET, LIGHT, CENTER, SIZE };

struct columns {
    double numbers[NUMBERS][STABILITY_POINT_LIMIT];
    double vectors[VECTORS][3 * STABILITY_POINT_LIMIT];
};

static void fill(struct columns *columns, const struct setup *setup, size_t i)
{
    const double numbers[NUMBERS] = {
        setup->sigma_s, setup->sigma_a, setup->emission, setup->g, setup->background, setup->irradiance, 1};
    const double vectors[VECTORS][3] = {{0, 0, 4},
                                        {0, 0, 0},
                                        {setup->light[0], setup->light[1], setup->light[2]},
                                        {0, 0, 0},
                                        {1.6, 1.6, setup->thickness}};

    for (int k = 0; k < NUMBERS; k++)
        columns->numbers[k][i] = numbers[k];
    for (int k = 0; k < VECTORS; k++)
        for (int axis = 0; axis < 3; axis++)
            columns->vectors[k][3 * i + (size_t)axis] =
                vectors[k][axis] + (k == SIZE ? 0 : setup->shift * (axis == 0 ? 1 : 0.25));
}

static char *write_job(const struct stability_sweep *sweep, const struct stability_method *method)
{
    static const char *const number_keys[] = {"sigma_s",    "sigma_a",   "emission", "g",
                                              "background", "intensity", "radius"};
    struct columns columns;
    struct setup first = setup_of(sweep, sweep->values[0]);
    bool is_shell = first.thickness > 0;
    char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);

    if (!out) abort();
    for (size_t i = 0; i < sweep->count; i++) {
        struct setup setup = setup_of(sweep, sweep->values[i]);

        fill(&columns, &setup, i);
    }
#define NUMBER(which) write_keys(out, number_keys[which], columns.numbers[which], sweep->count, 1)
#define VECTOR(key, which) write_keys(out, key, columns.vectors[which], sweep->count, 3)
    fprintf(out, "{\"version\":1,\"name\":\"%s\",\"frames\":\"0-%zu\",\"fps\":1,\"resolution\":[%d,%d],", sweep->slug,
            sweep->count - 1, WIDTH_PX, HEIGHT_PX);
    NUMBER(BACKGROUND);
    fputs("\"camera\":{", out);
    VECTOR("position", EYE);
    VECTOR("target", TARGET);
    fputs("\"fov\":26,\"clip\":[2.5,5.5]},\"lights\":[{\"kind\":\"point\",", out);
    VECTOR("position", LIGHT);
    NUMBER(IRRADIANCE);
    fprintf(out, "\"falloff\":\"%s\"}],\"scene\":{\"media\":[{", first.is_inverse_square ? "inverse_square" : "none");
    NUMBER(SIGMA_S);
    NUMBER(SIGMA_A);
    NUMBER(EMISSION);
    fputs("\"phase\":[{", out);
    NUMBER(G);
    fprintf(out, "\"weight\":1}],\"density\":{\"kind\":\"homogeneous\",\"bounds\":{\"kind\":\"%s\",",
            is_shell ? "box" : "sphere");
    VECTOR("center", CENTER);
    if (is_shell)
        VECTOR("size", SIZE);
    else
        NUMBER(RADIUS);
    fprintf(out, "\"falloff\":%g}}}]},\"quality\":{%s},\"output\":{\"path\":\"a.####.exr\",\"pixel\":\"float\"}}",
            method->wants_even ? 0.0
            : is_shell         ? 1e-5
                               : 0.3,
            method->quality);
    fclose(out);
    return text;
}

// What is true, or a refusal in every point of the sweep.
static bool measure_truth(struct truth *truth, int32_t frame, double *rgb)
{
    struct error error = {{0}};

    if (!truth_seek(truth, frame, &error)) {
        printf("%s\n", error.message);
        return false;
    }
    for (int i = 0; i < PIXELS; i++) {
        struct truth_pixel pixel = truth_measure(truth, i % WIDTH_PX, i / WIDTH_PX, NULL);

        memcpy(rgb + 3 * (size_t)i, pixel.rgb, sizeof pixel.rgb);
    }
    return true;
}

static void compare(const struct image *image, const double *truth, struct stability_point *point)
{
    float seen[3 * PIXELS];
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

static bool measure_points(struct gl_context *context, const struct job *job, size_t count,
                           struct stability_point *points)
{
    struct renderer *renderer = renderer_create(context, test_shader_dir());
    struct error error = {{0}};
    struct truth *truth = truth_open(&(struct truth_params){.job = job}, &error);
    struct image image = {0};
    bool ok = truth && image_init(&image, WIDTH_PX, HEIGHT_PX, false, false, &error);

    if (!ok) printf("%s\n", error.message);
    for (size_t i = 0; ok && i < count; i++) {
        struct renderer_result result;
        double rgb[3 * PIXELS];

        if (!renderer_render(renderer, job, (int32_t)i, &image, NULL, NULL, &result, &error)) {
            refuse(&points[i], 1, error.message);
            continue;
        }
        ok = measure_truth(truth, (int32_t)i, rgb);
        if (ok) compare(&image, rgb, &points[i]);
    }
    image_finish(&image);
    truth_close(truth);
    renderer_destroy(renderer);
    return ok;
}

bool stability_measure(struct gl_context *context, const struct stability_sweep *sweep,
                       const struct stability_method *method, struct stability_point *points)
{
    char *text = write_job(sweep, method);
    struct error error = {{0}};
    struct job job = {0};
    bool ok = true;

    memset(points, 0, sweep->count * sizeof *points);
    if (job_parse(&job, text, strlen(text), NULL, &error))
        ok = measure_points(context, &job, sweep->count, points);
    else
        refuse(points, sweep->count, error.message);
    job_finish(&job);
    free(text);
    return ok;
}
