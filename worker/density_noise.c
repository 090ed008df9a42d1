#include "core/job.h"
#include "worker/density_kind.h"
#include "worker/timeline_value.h"

#include <float.h>
#include <math.h>

// Where a point lies in the noise, in lattice cells: q = frequency R (p - center) + offset, taken apart into a linear part
// and what is added, so that a centre costs the shader nothing.
static bool is_turned(const struct scene_noise *noise)
{
    return !timeline_value_is_zero(&noise->angle);
}

static bool is_centered(const struct scene_density *density)
{
    return density->bounds.kind == SCENE_BOUNDS_NONE || timeline_value_is_zero(&density->bounds.center);
}

static bool is_shifted(const struct scene_density *density)
{
    return !is_centered(density) || !timeline_value_is_zero(&density->noise.offset);
}

// frequency R, column-major; Rodrigues' formula.
static void evaluate_turn(const void *source, double time, double value[static 9])
{
    const struct scene_noise *noise = source;
    double frequency[9] = {0}, axis[9] = {0}, angle[9] = {0}, c, s;

    timeline_value_evaluate(&noise->frequency, time, frequency);
    timeline_value_evaluate_unit(&noise->axis, time, axis);
    timeline_value_evaluate(&noise->angle, time, angle);
    c = cos(angle[0] * M_PI / 180);
    s = sin(angle[0] * M_PI / 180);
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            value[3 * column + row] = frequency[0] * ((1 - c) * axis[row] * axis[column] + (row == column ? c : 0));
    for (int i = 0; i < 3; ++i) {
        int next = (i + 1) % 3, last = (i + 2) % 3;
        double sine = frequency[0] * s * axis[i];

        value[3 * next + last] += sine;
        value[3 * last + next] -= sine;
    }
}

static void evaluate_shift(const void *source, double time, double value[static 9])
{
    const struct scene_density *density = source;
    double turn[9] = {0}, center[9] = {0}, offset[9] = {0};

    if (is_turned(&density->noise)) {
        evaluate_turn(&density->noise, time, turn);
    } else {
        timeline_value_evaluate(&density->noise.frequency, time, turn);
        turn[4] = turn[8] = turn[0];
        turn[1] = turn[2] = 0;
    }
    if (density->bounds.kind != SCENE_BOUNDS_NONE) timeline_value_evaluate(&density->bounds.center, time, center);
    timeline_value_evaluate(&density->noise.offset, time, offset);
    for (int row = 0; row < 3; ++row)
        value[row] = offset[row] - turn[row] * center[0] - turn[3 + row] * center[1] - turn[6 + row] * center[2];
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

static void add_place(struct frame_uniforms *uniforms, const struct scene_density *density, size_t i)
{
    const struct scene_noise *noise = &density->noise;
    bool turn_is_fixed = timeline_is_constant(&noise->frequency) && timeline_is_constant(&noise->axis) &&
                         timeline_is_constant(&noise->angle);
    bool shift_is_fixed = timeline_is_constant(&noise->offset) &&
                          (is_centered(density) || (turn_is_fixed && timeline_is_constant(&density->bounds.center)));

    if (is_turned(noise))
        frame_uniforms_add(uniforms,
                           (struct frame_value){.type = FRAME_VALUE_MAT3,
                                                .is_constant = turn_is_fixed,
                                                .evaluate = evaluate_turn,
                                                .source = noise,
                                                .min = value_range_any.min,
                                                .max = value_range_any.max,
                                                .meaning = "density.frequency and rotate"},
                           "medium_%zu_turn", i);
    else
        frame_uniforms_add(
            uniforms, timeline_value(&noise->frequency, FRAME_VALUE_FLOAT, value_range_positive, "density.frequency"),
            "medium_%zu_frequency", i);
    if (is_shifted(density))
        frame_uniforms_add(uniforms,
                           (struct frame_value){.type = FRAME_VALUE_VEC3,
                                                .is_constant = shift_is_fixed,
                                                .evaluate = evaluate_shift,
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

static void add_values(struct frame_uniforms *uniforms, const struct density_site *site)
{
    const struct scene_density *density = &site->source->density;
    const struct scene_noise *noise = &density->noise;

    add_place(uniforms, density, site->medium);
    if (noise->octaves > 1) add_octaves(uniforms, noise, site->medium);
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

// The finest octaves that a job may ask for go beyond floats, where a difference is no number.
static bool may_overflow(const struct density_site *site)
{
    const double farthest = 1e9; // m from the centre, and lattice cells of offset
    const struct scene_noise *noise = &site->source->density.noise;
    struct timeline_span span = job_time_span(site->job);
    double least[3], frequency[3], lacunarity[3];

    timeline_find_bounds(&noise->frequency, span, least, frequency);
    timeline_find_bounds(&noise->lacunarity, span, least, lacunarity);
    return farthest * (frequency[0] + 1) * pow(lacunarity[0], noise->octaves - 1) > 1e37;
}

// Octaves are written out one by one: as a loop they cost a fifth more, and turns of the marches around them.
static void write_field(FILE *out, const struct density_site *site)
{
    const struct scene_density *density = &site->source->density;
    const struct scene_noise *noise = &density->noise;
    const char *octave =
        noise->mode == SCENE_NOISE_ABSOLUTE ? "density_noise_absolute(density_noise(q))" : "density_noise(q)";
    bool has_gain = !timeline_value_is_zero(&noise->hurst), is_clamped = may_overflow(site);
    size_t i = site->medium;

    fprintf(out, "float medium_%zu_field(vec3 p)\n{\n    vec3 q = medium_%zu_%s * p", i, i,
            is_turned(noise) ? "turn" : "frequency");
    if (is_shifted(density)) fprintf(out, " + medium_%zu_shift", i);
    fprintf(out, ";\n    float sum = %s;\n", octave);
    for (int k = 1; k < noise->octaves; ++k) {
        fprintf(out, "    q *= medium_%zu_lacunarity;\n", i);
        if (is_clamped) fputs("    q = clamp(q, -1e30, 1e30);\n", out);
        if (has_gain)
            fprintf(out, k == 1 ? "    float gain = medium_%zu_gain;\n" : "    gain *= medium_%zu_gain;\n", i);
        fprintf(out, "    sum += %s%s;\n", has_gain ? "gain * " : "", octave);
    }
    fputs("    return sum;\n}\n", out);
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

const struct density_kind density_kind_noise = {
    .name = "noise",
    .field_type = "float",
    .is_zero = is_zero,
    .add_values = add_values,
    .modules = modules,
    .write = write,
};
