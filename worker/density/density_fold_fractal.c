// SPDX-License-Identifier: Apache-2.0
#include "worker/density/density_kind.h"
#include "worker/glsl/scene_anchor.h"
#include "worker/glsl/timeline_value.h"

#include <math.h>
#include <string.h>

// The share by which rounding to float may shrink the support.
static const double support_margin = 1 + 1e-6;

static bool is_zero(const struct scene_density *density)
{
    return timeline_value_is_zero(&density->fold_fractal.scale);
}

// Rotates about x first, then about y; column-major.
static void evaluate_rotation(const void *source, double time, double value[static 9])
{
    const struct scene_fold_fractal *fractal = source;
    double x[9] = {0}, y[9] = {0};

    timeline_value_evaluate(&fractal->rotate_x_rad, time, x);
    timeline_value_evaluate(&fractal->rotate_y_rad, time, y);
    {
        double cx = cos(x[0]), sx = sin(x[0]), cy = cos(y[0]), sy = sin(y[0]);
        double rotation[9] = {cy, 0, -sy, sy * sx, cx, cy * sx, sy * cx, -sx, cy * cx};

        memcpy(value, rotation, sizeof rotation);
    }
}

static void evaluate_support_radius(const void *source, double time, double value[static 9])
{
    const struct scene_fold_fractal *fractal = source;
    double offset[9] = {0}, radius[9] = {0};

    timeline_value_evaluate(&fractal->offset, time, offset);
    timeline_value_evaluate(&fractal->radius, time, radius);
    value[0] = fmax((radius[0] + fractal->iterations * sqrt(3) * fabs(offset[0])) * support_margin, 0);
}

static void add_computed(struct frame_uniforms *uniforms, const struct scene_fold_fractal *fractal, size_t i)
{
    frame_uniforms_add(uniforms,
                       (struct frame_value){.type = FRAME_VALUE_MAT3,
                                            .is_constant = timeline_is_constant(&fractal->rotate_x_rad) &&
                                                           timeline_is_constant(&fractal->rotate_y_rad),
                                            .evaluate = evaluate_rotation,
                                            .source = fractal,
                                            .min = -1,
                                            .max = 1,
                                            .meaning = "density.rotate_x_rad and rotate_y_rad"},
                       "medium_%zu_rotation", i);
    frame_uniforms_add(uniforms,
                       (struct frame_value){.type = FRAME_VALUE_FLOAT,
                                            .is_constant = timeline_is_constant(&fractal->offset) &&
                                                           timeline_is_constant(&fractal->radius),
                                            .evaluate = evaluate_support_radius,
                                            .source = fractal,
                                            .min = value_range_not_negative.min,
                                            .max = value_range_not_negative.max,
                                            .meaning = "density.offset and radius"},
                       "medium_%zu_support_radius", i);
}

static void add_values(struct frame_uniforms *uniforms, const struct density_site *site)
{
    static const struct value_range exponents = {1e-6, 1e6};
    const struct scene_fold_fractal *fractal = &site->source->density.fold_fractal;
    size_t i = site->medium;

    add_computed(uniforms, fractal, i);
    frame_uniforms_add(uniforms, timeline_value(&fractal->offset, FRAME_VALUE_FLOAT, value_range_any, "density.offset"),
                       "medium_%zu_offset", i);
    frame_uniforms_add(uniforms, timeline_value(&fractal->radius, FRAME_VALUE_FLOAT, value_range_any, "density.radius"),
                       "medium_%zu_radius", i);
    frame_uniforms_add(uniforms, timeline_value(&fractal->exponent, FRAME_VALUE_FLOAT, exponents, "density.exponent"),
                       "medium_%zu_exponent", i);
    frame_uniforms_add(uniforms,
                       timeline_value(&fractal->scale, FRAME_VALUE_FLOAT, value_range_not_negative, "density.scale"),
                       "medium_%zu_scale", i);
}

static const char *const *modules(const struct density_site *site)
{
    static const char *const names[] = {"density/fold_fractal.glsl", "region/sphere.glsl", NULL};

    (void)site;
    return names;
}

static void write(FILE *out, const struct density_site *site)
{
    static const char *const members[] = {"rotation", "offset", "radius", "exponent", "scale"};
    bool is_anchored = scene_anchor_is_used(site->job);
    size_t i = site->medium;

    fprintf(out, "DensityFoldFractal medium_%zu_fold_fractal()\n{\n    return DensityFoldFractal(%d", i,
            site->source->density.fold_fractal.iterations);
    for (size_t k = 0; k < sizeof members / sizeof *members; ++k)
        fprintf(out, ", medium_%zu_%s", i, members[k]);
    fprintf(out, ");\n}\nvec2 medium_%zu_support(vec3 origin, vec3 direction)\n{\n", i);
    fprintf(out, "    return region_sphere_span(RegionSphere(%s, medium_%zu_support_radius), origin, direction);\n",
            is_anchored ? "-scene_anchor" : "vec3(0.0)", i);
    fprintf(out, "}\nfloat medium_%zu_field(vec3 p)\n{\n", i);
    fprintf(out, "    return density_fold_fractal_distance(medium_%zu_fold_fractal(), p%s);\n", i,
            is_anchored ? " + scene_anchor" : "");
    fprintf(out, "}\nfloat medium_%zu_density(float field)\n{\n", i);
    fprintf(out, "    return density_fold_fractal_at(medium_%zu_fold_fractal(), field);\n", i);
    fprintf(out, "}\nfloat medium_%zu_distance(float field)\n{\n    return field;\n}\n", i);
}

// The distance is 1-Lipschitz: within `own` metres of p it is above distance - own.
static void write_most(FILE *out, const struct density_site *site)
{
    size_t i = site->medium;

    fprintf(
        out,
        "float medium_%zu_most(MediaRay ray, float at, inout float extent)\n{\n"
        "    float distance = medium_%zu_field(ray.origin + at * ray.direction);\n    float own = max(0.1 * "
        "medium_%zu_radius, -distance);\n"
        "    extent = min(extent, max(own, distance));\n    return medium_%zu_density(min(distance - own, 0.0));\n}\n",
        i, i, i, i);
}

const struct density_kind density_kind_fold_fractal = {
    .name = "fold_fractal",
    .field_type = "float",
    .has_support = true,
    .is_zero_outside = true,
    .takes_anchor = true,
    .is_zero = is_zero,
    .add_values = add_values,
    .modules = modules,
    .write = write,
    .write_most = write_most,
};
