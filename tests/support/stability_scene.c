// SPDX-License-Identifier: Apache-2.0
#include "tests/support/stability_scene.h"

#include "core/base/alloc.h"
#include "tests/support/stability.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STEP 0.05

// The scene at one value.
struct setup {
    double sigma_s, sigma_a, emission, g, background, irradiance, shift;
    double light[3];
    double thickness; // m; 0: a ball of radius 1, else a box so thin
    bool is_inverse_square;
};

static bool is_slug(const struct stability_sweep *sweep, const char *slug)
{
    return strcmp(sweep->slug, slug) == 0;
}

static void put(double place[3], double x, double y, double z)
{
    place[0] = x;
    place[1] = y;
    place[2] = z;
}

static struct setup setup_of(const struct stability_sweep *sweep, double value)
{
    struct setup setup = {.sigma_s = 1, .irradiance = 1, .light = {2, 1.5, 2}};

    if (is_slug(sweep, "furnace")) {
        setup = (struct setup){.sigma_a = value / STEP, .emission = value / STEP, .background = 1, .light = {9, 9, 9}};
    } else if (is_slug(sweep, "depth")) {
        setup.sigma_s = value / 2;
    } else if (is_slug(sweep, "forward") || is_slug(sweep, "backward")) {
        setup.g = value;
        put(setup.light, 0.3, 0.2, is_slug(sweep, "forward") ? -4 : 6);
    } else if (is_slug(sweep, "inside")) {
        put(setup.light, value, 0, 0.1);
        setup.is_inverse_square = true;
    } else if (is_slug(sweep, "camera")) {
        put(setup.light, 0, value, 4);
        setup.is_inverse_square = true;
    } else if (is_slug(sweep, "far")) {
        put(setup.light, 0.6 * (1 + value), 0.8 * (1 + value), 0);
    } else if (is_slug(sweep, "shell")) {
        setup.thickness = value * STEP;
        setup.sigma_s = 1 / setup.thickness;
    } else if (is_slug(sweep, "origin")) {
        setup.shift = value;
    } else if (is_slug(sweep, "bright")) {
        setup.irradiance = value;
    } else if (is_slug(sweep, "flicker")) {
        setup.sigma_s = 2;
        setup.light[0] += value;
    }
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
    size_t count;
    double numbers[NUMBERS][STABILITY_POINT_LIMIT + 1];
    double vectors[VECTORS][3 * (STABILITY_POINT_LIMIT + 1)];
};

static void fill(struct columns *columns, const struct setup *setup)
{
    const double numbers[NUMBERS] = {
        setup->sigma_s, setup->sigma_a, setup->emission, setup->g, setup->background, setup->irradiance, 1};
    const double vectors[VECTORS][3] = {{0, 0, 4},
                                        {0, 0, 0},
                                        {setup->light[0], setup->light[1], setup->light[2]},
                                        {0, 0, 0},
                                        {1.6, 1.6, setup->thickness}};
    size_t i = columns->count++;

    for (int k = 0; k < NUMBERS; k++)
        columns->numbers[k][i] = numbers[k];
    for (int k = 0; k < VECTORS; k++)
        for (int axis = 0; axis < 3; axis++)
            columns->vectors[k][3 * i + (size_t)axis] =
                vectors[k][axis] + (k == SIZE ? 0 : setup->shift * (axis == 0 ? 1 : 0.25));
}

static void write_number(FILE *out, const struct columns *columns, int which)
{
    static const char *const keys[] = {"sigma_s", "sigma_a", "emission", "g", "background", "intensity", "radius"};

    write_keys(out, keys[which], columns->numbers[which], columns->count, 1);
}

static void write_vector(FILE *out, const struct columns *columns, const char *key, int which)
{
    write_keys(out, key, columns->vectors[which], columns->count, 3);
}

static void write_even(FILE *out, const struct columns *columns, bool is_shell, const struct stability_method *method)
{
    fputs("\"kind\":\"homogeneous\",\"bounds\":{", out);
    write_vector(out, columns, "center", CENTER);
    if (is_shell)
        write_vector(out, columns, "size", SIZE);
    else
        write_number(out, columns, RADIUS);
    fprintf(out, "\"kind\":\"%s\",\"falloff\":%g}", is_shell ? "box" : "sphere",
            method->wants_even ? 0.0
            : is_shell         ? 1e-5
                               : 0.3);
}

// Opacity in a shell of so much of the values' range, of an optical depth of some 0.75 whatever it is.
static void write_transfer(FILE *out, double width)
{
    fprintf(out,
            ",\"unit_distance\":%.17g,\"transfer_function\":[[0,1,1,1,0],[%.17g,1,1,1,0],[0.5,1,0.8,0.6,0.9],"
            "[%.17g,1,1,1,0],[1,1,1,1,0]]",
            width, 0.5 - 0.5 * width, 0.5 + 0.5 * width);
}

// A shell of slope 20 around a hollow; `too_low`: by what its promise is.
static void write_code(FILE *out, double too_low)
{
    fprintf(out,
            "\"kind\":\"glsl\",\"source\":\"float density(vec3 p, float t) { return 20.0 * (0.12 - abs(length(p) - "
            "0.7)); }\",\"lipschitz\":%.17g,\"bounds\":{\"kind\":\"sphere\",\"radius\":1}",
            20 / too_low);
}

static double code_at(const void *context, struct vec3 p, double t)
{
    (void)context;
    (void)t;
    return 20.0 * (0.12 - fabs(vec3_length(p) - 0.7));
}

density_function_at *stability_scene_twin(const struct stability_sweep *sweep)
{
    return is_slug(sweep, "lipschitz") ? code_at : NULL;
}

static void write_medium(FILE *out, const struct stability_sweep *sweep, const struct stability_method *method,
                         const struct columns *columns, double value, const char *folder)
{
    if (!is_slug(sweep, "transfer")) {
        write_number(out, columns, SIGMA_S);
        write_number(out, columns, SIGMA_A);
        write_number(out, columns, EMISSION);
        fputs("\"phase\":[{", out);
        write_number(out, columns, G);
        fputs("\"weight\":1}],", out);
    }
    fputs("\"density\":{", out);
    if (is_slug(sweep, "lipschitz"))
        write_code(out, value);
    else if (sweep->is_grid)
        fprintf(out, "\"kind\":\"grid\",\"file\":\"%s/voxels.nrrd\",\"center\":[0,0,0]", folder);
    else
        write_even(out, columns, setup_of(sweep, value).thickness > 0, method);
    if (is_slug(sweep, "transfer")) write_transfer(out, value);
    fputs("}", out);
}

char *stability_scene_write(const struct stability_sweep *sweep, const struct stability_method *method,
                            const double *values, size_t count, const char *folder)
{
    struct columns columns = {0};
    struct setup first = setup_of(sweep, values[0]);
    char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);

    if (!out) abort();
    for (size_t i = 0; i < count; i++) {
        struct setup setup = setup_of(sweep, values[i]);

        fill(&columns, &setup);
    }
    fprintf(out, "{\"version\":1,\"name\":\"%s\",\"frames\":\"0-%zu\",\"fps\":1,\"resolution\":[%d,%d],", sweep->slug,
            count - 1, STABILITY_WIDTH_PX, STABILITY_HEIGHT_PX);
    write_number(out, &columns, BACKGROUND);
    fputs("\"camera\":{", out);
    write_vector(out, &columns, "position", EYE);
    write_vector(out, &columns, "target", TARGET);
    fputs("\"fov\":26,\"clip\":[2.5,5.5]},", out);
    if (!is_slug(sweep, "transfer")) {
        fputs("\"lights\":[{\"kind\":\"point\",", out);
        write_vector(out, &columns, "position", LIGHT);
        write_number(out, &columns, IRRADIANCE);
        fprintf(out, "\"falloff\":\"%s\"}],", first.is_inverse_square ? "inverse_square" : "none");
    }
    fputs("\"scene\":{\"media\":[{", out);
    write_medium(out, sweep, method, &columns, values[0], folder);
    fprintf(out, "}]},\"quality\":{%s},\"output\":{\"path\":\"a.####.exr\",\"pixel\":\"float\"}}", method->quality);
    fclose(out);
    return text;
}

// How many voxels there are along each side of 1.6 m.
static void find_size(const struct stability_sweep *sweep, double value, int size[3])
{
    int even = is_slug(sweep, "transfer") ? 24 : is_slug(sweep, "aspect") ? 4 : 8;

    for (int axis = 0; axis < 3; axis++)
        size[axis] = even;
    if (is_slug(sweep, "side")) size[2] = (int)value;
    if (is_slug(sweep, "aspect") && value >= 1) size[2] = (int)lround(even * value);
    if (is_slug(sweep, "aspect") && value < 1) size[0] = (int)lround(even / value);
}

// Of a cone, whose shells of like values are balls, or of something soft.
static float voxel_at(const struct stability_sweep *sweep, const double p[3])
{
    double square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];

    return (float)(is_slug(sweep, "transfer") ? fmax(1 - sqrt(square), 0) : exp(-2 * square));
}

void stability_scene_write_voxels(const struct stability_sweep *sweep, double value, const char *folder)
{
    const double SIDE = 1.6;
    int size[3], at[3];
    char path[512];
    FILE *out;

    if (!sweep->is_grid) return;
    find_size(sweep, value, size);
    snprintf(path, sizeof path, "%s/voxels.nrrd", folder);
    out = fopen(path, "wb");
    if (!out) abort();
    fprintf(out,
            "NRRD0004\ntype: float\ndimension: 3\nsizes: %d %d %d\nspacings: %.17g %.17g %.17g\nunits: \"m\" \"m\" "
            "\"m\"\nendian: little\nencoding: raw\n\n",
            size[0], size[1], size[2], SIDE / size[0], SIDE / size[1], SIDE / size[2]);
    for (at[2] = 0; at[2] < size[2]; at[2]++)
        for (at[1] = 0; at[1] < size[1]; at[1]++)
            for (at[0] = 0; at[0] < size[0]; at[0]++) {
                double p[3];
                float voxel;

                for (int axis = 0; axis < 3; axis++)
                    p[axis] = SIDE * ((at[axis] + 0.5) / size[axis] - 0.5);
                voxel = voxel_at(sweep, p);
                fwrite(&voxel, sizeof voxel, 1, out);
            }
    fclose(out);
}
