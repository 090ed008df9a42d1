// SPDX-License-Identifier: Apache-2.0
#include "core/scene/density_json.h"

#include "core/scene/bounds_json.h"
#include "core/scene/glsl_json.h"
#include "core/scene/grid_json.h"
#include "core/scene/scene.h"
#include "core/scene/scene_reader.h"

static const struct timeline_limits EXPONENT = {.components = 1, .min = 0.0, .max = 100.0, .excludes_min = true};
static const struct timeline_limits FREQUENCY = {.components = 1, .min = 0.0, .max = 1e9, .excludes_min = true};
static const struct timeline_limits LACUNARITY = {.components = 1, .min = 1.0, .max = 100.0};
static const struct timeline_limits HURST = {.components = 1, .min = 0.0, .max = 10.0};
// Beyond it a density is 0 or without end nearly everywhere: the exponent is from 1 / 1999 to 1999.
static const struct timeline_limits BIAS = {.components = 1, .min = -0.999, .max = 0.999};
static const struct timeline_limits LATTICE = {.components = 3, .min = -1e9, .max = 1e9};

static bool read_fold_fractal(const struct scene_reader *reader, struct scene_fold_fractal *fold_fractal)
{
    static const char *const keys[] = {"kind",         "bounds",       "iterations", "offset", "radius",
                                       "rotate_x_rad", "rotate_y_rad", "exponent",   "scale",  NULL};
    struct json_node iterations = json_node_child(reader->object, "iterations");
    int64_t count;

    if (!json_check_keys(reader->object, keys, reader->error) ||
        !json_read_integer(&iterations, 1, SCENE_ITERATION_LIMIT, &count, reader->error))
        return false;
    fold_fractal->iterations = (int)count;
    return scene_reader_read(reader, "offset", &SCENE_LENGTH, &fold_fractal->offset) &&
           scene_reader_read(reader, "radius", &SCENE_LENGTH, &fold_fractal->radius) &&
           scene_reader_read_or(reader, "rotate_x_rad", &SCENE_ANGLE, 0.0, &fold_fractal->rotate_x_rad) &&
           scene_reader_read_or(reader, "rotate_y_rad", &SCENE_ANGLE, 0.0, &fold_fractal->rotate_y_rad) &&
           scene_reader_read(reader, "exponent", &EXPONENT, &fold_fractal->exponent) &&
           scene_reader_read(reader, "scale", &SCENE_SCALE, &fold_fractal->scale);
}

static bool read_homogeneous(const struct scene_reader *reader, struct scene_homogeneous *homogeneous)
{
    static const char *const keys[] = {"kind", "bounds", "scale", NULL};

    return json_check_keys(reader->object, keys, reader->error) &&
           scene_reader_read_or(reader, "scale", &SCENE_SCALE, 1.0, &homogeneous->scale);
}

static bool read_rotation(const struct scene_reader *noise_reader, struct scene_noise *noise)
{
    static const char *const keys[] = {"axis", "angle", NULL};
    struct json_node object = json_node_child(noise_reader->object, "rotate");
    struct scene_reader reader = {&object, noise_reader->span, noise_reader->error};

    if (json_node_is_absent(&object))
        return scene_reader_read_direction(&reader, "axis", &noise->axis) &&
               scene_reader_read_or(&reader, "angle", &SCENE_ANGLE, 0.0, &noise->angle);
    return json_check_object(&object, reader.error) && json_check_keys(&object, keys, reader.error) &&
           scene_reader_read_direction(&reader, "axis", &noise->axis) &&
           scene_reader_read(&reader, "angle", &SCENE_ANGLE, &noise->angle);
}

static bool read_noise(const struct scene_reader *reader, struct scene_noise *noise)
{
    static const char *const keys[] = {"kind", "bounds", "frequency", "octaves", "lacunarity", "H",
                                       "bias", "mode",   "offset",    "rotate",  "scale",      NULL};
    static const char *const modes[] = {"remap", "clip", "absolute", NULL};
    struct json_node octaves = json_node_child(reader->object, "octaves");
    int64_t count = 1;
    int mode = SCENE_NOISE_REMAP;

    if (!json_check_keys(reader->object, keys, reader->error) ||
        (!json_node_is_absent(&octaves) &&
         !json_read_integer(&octaves, 1, SCENE_OCTAVE_LIMIT, &count, reader->error)) ||
        !scene_reader_read_choice(reader, "mode", modes, &mode))
        return false;
    noise->octaves = (int)count;
    noise->mode = (enum scene_noise_mode)mode;
    return scene_reader_read(reader, "frequency", &FREQUENCY, &noise->frequency) &&
           scene_reader_read_or(reader, "lacunarity", &LACUNARITY, 2.0, &noise->lacunarity) &&
           scene_reader_read_or(reader, "H", &HURST, 1.0, &noise->hurst) &&
           scene_reader_read_or(reader, "bias", &BIAS, 0.0, &noise->bias) &&
           scene_reader_read_or(reader, "offset", &LATTICE, 0.0, &noise->offset) && read_rotation(reader, noise) &&
           scene_reader_read_or(reader, "scale", &SCENE_SCALE, 1.0, &noise->scale);
}

// The zero value of the kind comes first: what is read until a failure is all that scene_finish has to free.
static bool read_kind(const struct scene_reader *reader, struct scene_density *density)
{
    switch (density->kind) {
    case SCENE_DENSITY_FOLD_FRACTAL:
        density->fold_fractal = (struct scene_fold_fractal){0};
        return read_fold_fractal(reader, &density->fold_fractal);
    case SCENE_DENSITY_HOMOGENEOUS:
        density->homogeneous = (struct scene_homogeneous){0};
        return read_homogeneous(reader, &density->homogeneous);
    case SCENE_DENSITY_NOISE:
        density->noise = (struct scene_noise){0};
        return read_noise(reader, &density->noise);
    case SCENE_DENSITY_GRID:
        density->grid = (struct scene_grid){0};
        return grid_from_json(&density->grid, reader);
    case SCENE_DENSITY_GLSL:
        density->glsl = (struct scene_glsl){0};
        return glsl_from_json(&density->glsl, reader);
    }
    return false;
}

bool density_from_json(struct scene_density *density, const struct scene_reader *medium)
{
    static const char *const kinds[] = {"fold_fractal", "homogeneous", "noise", "grid", "glsl", NULL};
    struct json_node object = json_node_child(medium->object, "density"), kind = json_node_child(&object, "kind");
    struct scene_reader reader = {&object, medium->span, medium->error};
    int choice;

    if (!json_check_object(&object, reader.error) || !json_read_enum(&kind, kinds, &choice, reader.error)) return false;
    density->kind = (enum scene_density_kind)choice;
    return read_kind(&reader, density) && bounds_from_json(&density->bounds, &reader);
}
