// SPDX-License-Identifier: Apache-2.0
#include "core/scene/density_rules.h"
#include "core/scene/scene_reader.h"

#include <math.h>

static const struct timeline_limits EXPONENT = {.components = 1, .min = 0.0, .max = 100.0, .excludes_min = true};

static bool read(struct scene_density *density, const struct scene_reader *reader)
{
    struct scene_fold_fractal *fold_fractal = &density->fold_fractal;
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

static void visit_timelines(struct scene_density *density, timeline_visitor *visit, void *user)
{
    struct scene_fold_fractal *fold_fractal = &density->fold_fractal;

    visit("offset", &fold_fractal->offset, user);
    visit("radius", &fold_fractal->radius, user);
    visit("rotate_x", &fold_fractal->rotate_x_rad, user);
    visit("rotate_y", &fold_fractal->rotate_y_rad, user);
    visit("exponent", &fold_fractal->exponent, user);
    visit("scale", &fold_fractal->scale, user);
}

static void write_hash_text(const struct scene_density *density, FILE *text)
{
    fprintf(text, " iterations %d", density->fold_fractal.iterations);
}

static double find_diameter(const struct scene_density *density, struct timeline_span span)
{
    const struct scene_fold_fractal *fold_fractal = &density->fold_fractal;

    return 2.0 * (timeline_find_largest(&fold_fractal->radius, span) +
                  fold_fractal->iterations * sqrt(3.0) * timeline_find_largest(&fold_fractal->offset, span));
}

const struct density_rules density_rules_fold_fractal = {
    .name = "fold_fractal",
    .read = read,
    .visit = visit_timelines,
    .write_hash_text = write_hash_text,
    .find_diameter = find_diameter,
};
