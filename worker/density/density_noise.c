// SPDX-License-Identifier: Apache-2.0
#include "core/job/job.h"
#include "worker/density/density_bake.h"
#include "worker/density/density_kind.h"
#include "worker/glsl/scene_anchor.h"
#include "worker/glsl/timeline_value.h"

#include <float.h>
#include <math.h>
#include <string.h>

// Baking pays from two octaves on: one octave is as fast as reading a grid. With seven cells for each lattice cell of
// the finest octave, a sum of five is exact to a hundredth of its standard deviation. Octaves with fewer cells are
// added to the grid's value.
enum { LEAST_BAKED_OCTAVES = 2 };
static const double CELLS_PER_LATTICE_CELL = 3.5;

// A point in lattice cells is q = frequency R (p - center) + offset. It is computed from a linear part and a shift, so
// that a centre costs the shader nothing.
static bool is_rotated(const struct scene_noise *noise)
{
    return !timeline_value_is_zero(&noise->angle);
}

static bool rotation_is_fixed(const struct scene_noise *noise)
{
    return timeline_is_constant(&noise->axis) && timeline_is_constant(&noise->angle);
}

static bool is_centered(const struct scene_density *density)
{
    return density->bounds.kind == SCENE_BOUNDS_NONE || timeline_value_is_zero(&density->bounds.center);
}

static bool is_shifted(const struct density_site *site)
{
    const struct scene_density *density = &site->source->density;

    return !is_centered(density) || !timeline_value_is_zero(&density->noise.offset) || scene_anchor_is_used(site->job);
}

// Finds R, column-major, by Rodrigues' formula.
static void find_rotation(const struct scene_noise *noise, double time, double value[static 9])
{
    double axis[9] = {0}, angle[9] = {0}, c, s;

    timeline_value_evaluate_unit(&noise->axis, time, axis);
    timeline_value_evaluate(&noise->angle, time, angle);
    c = cos(angle[0] * M_PI / 180);
    s = sin(angle[0] * M_PI / 180);
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            value[3 * column + row] = (1 - c) * axis[row] * axis[column] + (row == column ? c : 0);
    for (int i = 0; i < 3; ++i) {
        int next = (i + 1) % 3, last = (i + 2) % 3;

        value[3 * next + last] += s * axis[i];
        value[3 * last + next] -= s * axis[i];
    }
}

// Computes frequency R.
static void evaluate_rotation(const void *source, double time, double value[static 9])
{
    const struct scene_noise *noise = source;
    double frequency[9] = {0};

    timeline_value_evaluate(&noise->frequency, time, frequency);
    find_rotation(noise, time, value);
    for (int i = 0; i < 9; ++i)
        value[i] *= frequency[0];
}

// Computes frequency R, also of noise that is not rotated.
static void evaluate_linear(const void *source, double time, double value[static 9])
{
    const struct scene_density *density = source;

    if (is_rotated(&density->noise)) {
        evaluate_rotation(&density->noise, time, value);
        return;
    }
    timeline_value_evaluate(&density->noise.frequency, time, value);
    value[4] = value[8] = value[0];
    value[1] = value[2] = 0;
}

static void evaluate_shift(const void *source, double time, double value[static 9])
{
    const struct scene_density *density = source;
    double rotation[9] = {0}, center[9] = {0}, offset[9] = {0};

    evaluate_linear(density, time, rotation);
    if (density->bounds.kind != SCENE_BOUNDS_NONE) timeline_value_evaluate(&density->bounds.center, time, center);
    timeline_value_evaluate(&density->noise.offset, time, offset);
    for (int row = 0; row < 3; ++row)
        value[row] =
            offset[row] - rotation[row] * center[0] - rotation[3 + row] * center[1] - rotation[6 + row] * center[2];
}

static void evaluate_gain(const void *source, double time, double value[static 9])
{
    const struct scene_noise *noise = source;
    double lacunarity[9] = {0}, hurst[9] = {0};

    timeline_value_evaluate(&noise->lacunarity, time, lacunarity);
    timeline_value_evaluate(&noise->hurst, time, hurst);
    value[0] = pow(lacunarity[0], -hurst[0]);
}

static void evaluate_exponent(const void *source, double time, double value[static 9])
{
    const struct scene_noise *noise = source;
    double bias[9] = {0};

    timeline_value_evaluate(&noise->bias, time, bias);
    value[0] = (1 - bias[0]) / (1 + bias[0]);
}

static void add_point_map(struct frame_uniforms *uniforms, const struct density_site *site)
{
    const struct scene_density *density = &site->source->density;
    size_t i = site->medium;
    const struct scene_noise *noise = &density->noise;
    bool linear_is_fixed = timeline_is_constant(&noise->frequency) && rotation_is_fixed(noise);
    bool shift_is_fixed =
        timeline_is_constant(&noise->offset) &&
        ((is_centered(density) && !scene_anchor_is_used(site->job)) ||
         (linear_is_fixed && (is_centered(density) || timeline_is_constant(&density->bounds.center))));

    if (is_rotated(noise))
        frame_uniforms_add(uniforms,
                           (struct frame_value){.type = FRAME_VALUE_MAT3,
                                                .is_constant = linear_is_fixed,
                                                .evaluate = evaluate_rotation,
                                                .source = noise,
                                                .min = value_range_any.min,
                                                .max = value_range_any.max,
                                                .meaning = "density.frequency and rotate"},
                           "medium_%zu_rotation", i);
    else
        frame_uniforms_add(
            uniforms, timeline_value(&noise->frequency, FRAME_VALUE_FLOAT, value_range_positive, "density.frequency"),
            "medium_%zu_frequency", i);
    if (is_shifted(site))
        frame_uniforms_add(uniforms,
                           (struct frame_value){.type = FRAME_VALUE_VEC3,
                                                .is_constant = shift_is_fixed,
                                                .evaluate = evaluate_shift,
                                                .evaluate_linear = evaluate_linear,
                                                .source = density,
                                                .min = value_range_any.min,
                                                .max = value_range_any.max,
                                                .meaning = "density.offset and bounds.center"},
                           "medium_%zu_shift", i);
}

static void add_octaves(struct frame_uniforms *uniforms, const struct scene_noise *noise, size_t i)
{
    static const struct value_range lacunarities = {1, FLT_MAX};

    frame_uniforms_add(uniforms,
                       timeline_value(&noise->lacunarity, FRAME_VALUE_FLOAT, lacunarities, "density.lacunarity"),
                       "medium_%zu_lacunarity", i);
    if (timeline_value_is_zero(&noise->hurst)) return;
    frame_uniforms_add(uniforms,
                       (struct frame_value){.type = FRAME_VALUE_FLOAT,
                                            .is_constant = timeline_is_constant(&noise->lacunarity) &&
                                                           timeline_is_constant(&noise->hurst),
                                            .evaluate = evaluate_gain,
                                            .source = noise,
                                            .min = 0,
                                            .max = 1,
                                            .meaning = "density.lacunarity and H"},
                       "medium_%zu_gain", i);
}

// Adds the map from metres to lattice cells. Noise that is not rotated has the frequency itself.
static void add_lattice(struct frame_uniforms *uniforms, const struct density_site *site, bool has_frequency)
{
    const struct scene_noise *noise = &site->source->density.noise;

    if (has_frequency)
        frame_uniforms_add(
            uniforms, timeline_value(&noise->frequency, FRAME_VALUE_FLOAT, value_range_positive, "density.frequency"),
            "medium_%zu_frequency", site->medium);
    frame_uniforms_add(uniforms, timeline_value(&noise->offset, FRAME_VALUE_VEC3, value_range_any, "density.offset"),
                       "medium_%zu_offset", site->medium);
}

// Counts the octaves that have CELLS_PER_LATTICE_CELL cells of the grid for each cell of theirs.
static int count_resolved(const struct density_site *site, const struct density_bake *bake)
{
    const struct scene_noise *noise = &site->source->density.noise;
    struct timeline_span span = job_time_span(site->job);
    double least[3], frequency[3], lacunarity[3];
    int count = 0;

    timeline_find_bounds(&noise->frequency, span, least, frequency);
    timeline_find_bounds(&noise->lacunarity, span, least, lacunarity);
    while (count < noise->octaves &&
           frequency[0] * pow(lacunarity[0], count) * bake->cell_m * CELLS_PER_LATTICE_CELL <= 1)
        count++;
    return count;
}

static bool pays_baked(const struct density_site *site, const struct density_bake *bake)
{
    return count_resolved(site, bake) >= LEAST_BAKED_OCTAVES;
}

// Counts the octaves that are in the grid together; 0: none.
static int count_baked(const struct density_site *site)
{
    struct density_bake bake;

    return density_bake_find(&bake, site->job, site->medium) ? count_resolved(site, &bake) : 0;
}

// Noise that rotates stands still in axes that rotate with it.
static bool find_box(const struct density_site *site, double half_size[static 3])
{
    const struct scene_density *density = &site->source->density;
    double rotation[9], half[3];

    if (!density_bake_find_bounds(half_size, site)) return false;
    if (!is_rotated(&density->noise) || density->bounds.kind == SCENE_BOUNDS_SPHERE) return true;
    if (!rotation_is_fixed(&density->noise)) {
        half_size[0] = half_size[1] = half_size[2] = hypot(hypot(half_size[0], half_size[1]), half_size[2]);
        return true;
    }
    memcpy(half, half_size, sizeof half);
    find_rotation(&density->noise, 0, rotation);
    for (int row = 0; row < 3; ++row)
        half_size[row] =
            fabs(rotation[row]) * half[0] + fabs(rotation[3 + row]) * half[1] + fabs(rotation[6 + row]) * half[2];
    return true;
}

static void add_values(struct frame_uniforms *uniforms, const struct density_site *site)
{
    const struct scene_density *density = &site->source->density;
    const struct scene_noise *noise = &density->noise;
    int baked = count_baked(site);

    add_point_map(uniforms, site);
    if (baked > 0) {
        density_bake_add_values(uniforms, site);
        add_lattice(uniforms, site, is_rotated(noise));
    }
    if (noise->octaves > 1 && baked < noise->octaves) add_octaves(uniforms, noise, site->medium);
    if (!timeline_value_is_zero(&noise->bias))
        frame_uniforms_add(uniforms,
                           (struct frame_value){.type = FRAME_VALUE_FLOAT,
                                                .is_constant = timeline_is_constant(&noise->bias),
                                                .evaluate = evaluate_exponent,
                                                .source = noise,
                                                .min = 1e-6,
                                                .max = 1e6,
                                                .meaning = "(1 - density.bias) / (1 + density.bias)"},
                           "medium_%zu_exponent", site->medium);
    frame_uniforms_add(uniforms,
                       timeline_value(&noise->scale, FRAME_VALUE_FLOAT, value_range_not_negative, "density.scale"),
                       "medium_%zu_scale", site->medium);
}

static bool is_zero(const struct scene_density *density)
{
    return timeline_value_is_zero(&density->noise.scale);
}

static const char *const *modules(const struct density_site *site)
{
    static const char *const names[][2][4] = {
        [SCENE_NOISE_REMAP] = {{"density/noise.glsl", "density/noise_remap.glsl"},
                               {"density/noise.glsl", "density/noise_remap.glsl", "density/noise_bias.glsl"}},
        [SCENE_NOISE_CLIP] = {{"density/noise.glsl", "density/noise_clip.glsl"},
                              {"density/noise.glsl", "density/noise_clip.glsl", "density/noise_bias.glsl"}},
        [SCENE_NOISE_ABSOLUTE] = {{"density/noise.glsl", "density/noise_absolute.glsl"},
                                  {"density/noise.glsl", "density/noise_absolute.glsl", "density/noise_bias.glsl"}},
    };
    const struct scene_noise *noise = &site->source->density.noise;

    return names[noise->mode][!timeline_value_is_zero(&noise->bias)];
}

// The finest octaves that a job may ask for exceed the range of floats, where a difference is NaN.
static bool may_overflow(const struct density_site *site)
{
    const double farthest = 1e9; // m from the centre; also lattice cells of offset
    const struct scene_noise *noise = &site->source->density.noise;
    struct timeline_span span = job_time_span(site->job);
    double least[3], frequency[3], lacunarity[3];

    timeline_find_bounds(&noise->frequency, span, least, frequency);
    timeline_find_bounds(&noise->lacunarity, span, least, lacunarity);
    return farthest * (frequency[0] + 1) * pow(lacunarity[0], noise->octaves - 1) > 1e37;
}

static void write_power(FILE *out, const char *type, const char *name, const char *value, size_t medium, int power)
{
    fprintf(out, "    %s %s = medium_%zu_%s", type, name, medium, value);
    for (int k = 1; k < power; ++k)
        fprintf(out, " * medium_%zu_%s", medium, value);
    fputs(";\n", out);
}

// Writes octaves from `first` to before `end`, added to `sum`, which exists unless they are the first; q is the point
// of octave 0. Octaves are unrolled: a loop costs a fifth more, and uses up iterations that the driver allows the
// marches around it.
static void write_octaves(FILE *out, const struct density_site *site, int first, int end)
{
    const struct scene_noise *noise = &site->source->density.noise;
    const char *octave =
        noise->mode == SCENE_NOISE_ABSOLUTE ? "density_noise_absolute(density_noise(q))" : "density_noise(q)";
    bool has_gain = !timeline_value_is_zero(&noise->hurst), is_clamped = may_overflow(site);
    size_t i = site->medium;

    if (first == 0) fprintf(out, "    float sum = %s;\n", octave);
    for (int k = first == 0 ? 1 : first; k < end; ++k) {
        if (k == first) {
            write_power(out, "float", "scale", "lacunarity", i, k);
            if (has_gain) write_power(out, "float", "gain", "gain", i, k);
        }
        fprintf(out, k == first ? "    q *= scale;\n" : "    q *= medium_%zu_lacunarity;\n", i);
        if (is_clamped) fputs("    q = clamp(q, -1e30, 1e30);\n", out);
        if (has_gain && k > first)
            fprintf(out, k == 1 ? "    float gain = medium_%zu_gain;\n" : "    gain *= medium_%zu_gain;\n", i);
        fprintf(out, "    sum += %s%s;\n", has_gain ? "gain * " : "", octave);
    }
    fputs("    return sum;\n}\n", out);
}

static void write_field(FILE *out, const struct density_site *site)
{
    const struct scene_density *density = &site->source->density;
    const struct scene_noise *noise = &density->noise;
    int baked = count_baked(site);
    size_t i = site->medium;

    if (baked > 0) density_bake_write_lookup(out, site);
    fprintf(out, "float medium_%zu_field(vec3 p)\n{\n    vec3 q = medium_%zu_%s * p", i, i,
            is_rotated(noise) ? "rotation" : "frequency");
    if (is_shifted(site)) fprintf(out, " + medium_%zu_shift", i);
    fputs(";\n", out);
    if (baked > 0)
        fprintf(out, "    float sum = medium_%zu_baked((q - medium_%zu_offset) / medium_%zu_frequency);\n", i, i, i);
    write_octaves(out, site, baked, noise->octaves);
}

static void write(FILE *out, const struct density_site *site)
{
    static const char *const shapes[] = {[SCENE_NOISE_REMAP] = "density_noise_remap(field)",
                                         [SCENE_NOISE_CLIP] = "density_noise_clip(field)",
                                         [SCENE_NOISE_ABSOLUTE] = "field"};
    const struct scene_density *density = &site->source->density;
    bool has_bias = !timeline_value_is_zero(&density->noise.bias);
    const char *shape = shapes[density->noise.mode];
    size_t i = site->medium;

    write_field(out, site);
    fprintf(out, "float medium_%zu_density(float field)\n{\n    return medium_%zu_scale * ", i, i);
    if (has_bias)
        fprintf(out, "density_noise_bias(%s, medium_%zu_exponent);\n}\n", shape, i);
    else
        fprintf(out, "%s;\n}\n", shape);
    fprintf(out, "float medium_%zu_distance(float field)\n{\n    return %s > 0.0 ? -1.0 : 0.0;\n}\n", i, shape);
}

static void add_baked_values(struct frame_uniforms *uniforms, const struct density_site *site)
{
    add_lattice(uniforms, site, true);
    add_octaves(uniforms, &site->source->density.noise, site->medium);
}

// Writes the sum of octaves, which is smooth. The steps from there to a density have edges, and come after the lookup.
static void write_baked(FILE *out, const struct density_site *site)
{
    size_t i = site->medium;

    fprintf(out, "float medium_%zu_baked(vec3 p)\n{\n    vec3 q = medium_%zu_frequency * p + medium_%zu_offset;\n", i,
            i, i);
    write_octaves(out, site, 0, count_baked(site));
}

// The bound adds the largest value of each octave. One octave is below 1.0364, the largest value in a cell of Perlin's
// twelve gradients.
static void evaluate_majorant(const void *source, double time, double value[static 9])
{
    const double largest = 1.04;
    const struct scene_noise *noise = source;
    double gain[9] = {0}, exponent[9] = {0}, scale[9] = {0}, sum = 0, share = largest;

    evaluate_gain(noise, time, gain);
    evaluate_exponent(noise, time, exponent);
    timeline_value_evaluate(&noise->scale, time, scale);
    for (int k = 0; k < noise->octaves; ++k, share *= gain[0])
        sum += share;
    value[0] = scale[0] * pow(noise->mode == SCENE_NOISE_REMAP ? 0.5 + 0.5 * sum : sum, exponent[0]);
}

static void add_majorant(struct frame_uniforms *uniforms, const struct density_site *site)
{
    const struct scene_noise *noise = &site->source->density.noise;

    frame_uniforms_add(uniforms,
                       (struct frame_value){.type = FRAME_VALUE_FLOAT,
                                            .is_constant = timeline_is_constant(&noise->lacunarity) &&
                                                           timeline_is_constant(&noise->hurst) &&
                                                           timeline_is_constant(&noise->bias) &&
                                                           timeline_is_constant(&noise->scale),
                                            .evaluate = evaluate_majorant,
                                            .source = noise,
                                            .min = value_range_not_negative.min,
                                            .max = value_range_not_negative.max,
                                            .meaning = "density.scale, octaves, H, lacunarity and bias"},
                       "medium_%zu_majorant", site->medium);
}

const struct density_kind density_kind_noise = {
    .name = "noise",
    .field_type = "float",
    .is_zero = is_zero,
    .add_values = add_values,
    .modules = modules,
    .write = write,
    .add_majorant = add_majorant,
    .find_box = find_box,
    .pays_baked = pays_baked,
    .add_baked_values = add_baked_values,
    .write_baked = write_baked,
};
