// SPDX-License-Identifier: Apache-2.0
#include "reference/density_noise.h"

#include "reference/perlin.h"

#include <math.h>
#include <stdbool.h>

enum { PIECE_LIMIT = 128, LOOK_LIMIT = 32, LOOKS_OF_SPAN = 2, ROOT_STEPS = 24 };

double density_noise_octave(struct vec3 q)
{
    double value;

    perlin_noise(1, &q.x, &q.y, &q.z, &value);
    return value;
}

// Rodrigues' formula; the rotation is counter-clockwise seen from the axis' tip.
static struct vec3 turned(struct vec3 v, struct vec3 axis, double angle_rad)
{
    double along = vec3_dot(axis, v) * (1.0 - cos(angle_rad));

    return vec3_add(vec3_scale(v, cos(angle_rad)),
                    vec3_add(vec3_scale(vec3_cross(axis, v), sin(angle_rad)), vec3_scale(axis, along)));
}

void density_noise_init(struct density_noise *noise, const struct density_noise_params *params)
{
    struct vec3 axis = vec3_normalize(params->axis);
    double angle_rad = params->angle_deg * M_PI / 180.0;

    // A rotation's rows are the images of the axes under its inverse.
    *noise = (struct density_noise){
        .octaves = params->octaves,
        .mode = params->mode,
        .frequency = params->frequency,
        .lacunarity = params->lacunarity,
        .gain = pow(params->lacunarity, -params->hurst),
        .exponent = (1.0 - params->bias) / (1.0 + params->bias),
        .offset = params->offset,
        .center = params->center,
        .row_x = turned((struct vec3){1.0, 0.0, 0.0}, axis, -angle_rad),
        .row_y = turned((struct vec3){0.0, 1.0, 0.0}, axis, -angle_rad),
        .row_z = turned((struct vec3){0.0, 0.0, 1.0}, axis, -angle_rad),
        .scale = params->scale,
    };
}

// The sums of the octaves at up to PERLIN_BATCH points, in lattice cells of the first.
static void sum_octaves(const struct density_noise *noise, size_t count, double q[3][PERLIN_BATCH], double *sums)
{
    double frequency = 1.0, weight = 1.0;

    for (size_t i = 0; i < count; i++)
        sums[i] = 0.0;
    for (int k = 0; k < noise->octaves; k++) {
        double scaled[3][PERLIN_BATCH], octave[PERLIN_BATCH];

        for (int a = 0; a < 3; a++)
            for (size_t i = 0; i < count; i++)
                scaled[a][i] = q[a][i] * frequency;
        perlin_noise(count, scaled[0], scaled[1], scaled[2], octave);
        for (size_t i = 0; i < count; i++)
            sums[i] += weight * (noise->mode == SCENE_NOISE_ABSOLUTE ? fabs(octave[i]) : octave[i]);
        frequency *= noise->lacunarity;
        weight *= noise->gain;
    }
}

// The same at one point, whose octaves are found together.
static double sum_octaves_at(const struct density_noise *noise, const double q[static 3])
{
    double scaled[3][PERLIN_BATCH], octaves[PERLIN_BATCH], frequency = 1.0, weight = 1.0, sum = 0.0;

    for (int k = 0; k < noise->octaves; k++) {
        for (int a = 0; a < 3; a++)
            scaled[a][k] = q[a] * frequency;
        frequency *= noise->lacunarity;
    }
    perlin_noise((size_t)noise->octaves, scaled[0], scaled[1], scaled[2], octaves);
    for (int k = 0; k < noise->octaves; k++) {
        sum += weight * (noise->mode == SCENE_NOISE_ABSOLUTE ? fabs(octaves[k]) : octaves[k]);
        weight *= noise->gain;
    }
    return sum;
}

static void find_few_bases(const struct density_noise *noise, size_t count, const struct vec3 *positions, double *bases)
{
    double q[3][PERLIN_BATCH];

    for (size_t i = 0; i < count; i++) {
        struct vec3 local = vec3_subtract(positions[i], noise->center);

        q[0][i] = vec3_dot(noise->row_x, local) * noise->frequency + noise->offset.x;
        q[1][i] = vec3_dot(noise->row_y, local) * noise->frequency + noise->offset.y;
        q[2][i] = vec3_dot(noise->row_z, local) * noise->frequency + noise->offset.z;
    }
    if (count == 1 && noise->octaves <= PERLIN_BATCH) {
        bases[0] = sum_octaves_at(noise, (const double[3]){q[0][0], q[1][0], q[2][0]});
    } else {
        sum_octaves(noise, count, q, bases);
    }
    for (size_t i = 0; i < count && noise->mode == SCENE_NOISE_REMAP; i++)
        bases[i] = 0.5 * (1.0 + bases[i]);
}

// The bases of the powers that are the densities, where they are positive.
static void find_bases(const struct density_noise *noise, size_t count, const struct vec3 *positions, double *bases)
{
    for (size_t i = 0; i < count; i += PERLIN_BATCH)
        find_few_bases(noise, count - i < PERLIN_BATCH ? count - i : PERLIN_BATCH, &positions[i], &bases[i]);
}

static double density_of(const struct density_noise *noise, double base)
{
    if (!(base > 0.0)) return 0.0;
    return noise->scale * (noise->exponent == 1.0 ? base : pow(base, noise->exponent));
}

static void find_densities(const void *field, size_t count, const struct vec3 *positions, double *densities)
{
    const struct density_noise *noise = field;

    find_bases(noise, count, positions, densities);
    for (size_t i = 0; i < count; i++)
        densities[i] = density_of(noise, densities[i]);
}

double density_noise(const struct density_noise *noise, struct vec3 position)
{
    double density;

    find_densities(noise, 1, &position, &density);
    return density;
}

static double at(const void *field, struct vec3 position)
{
    return density_noise(field, position);
}

// The sum of the octaves' weights, octave i counting growth^i times.
static double sum_weights(const struct density_noise *noise, double growth)
{
    double sum = 0.0, weight = 1.0;

    for (int k = 0; k < noise->octaves; k++) {
        sum += weight;
        weight *= noise->gain * growth;
    }
    return sum;
}

// Of the base along a line, per square metre: so much is rarely exceeded.
static double curvature_of(const struct density_noise *noise)
{
    // Of one octave, per square of a lattice cell: the curvature of 96 of 100 random points is smaller.
    const double of_octave = 6.0;

    return of_octave * noise->frequency * noise->frequency * sum_weights(noise, noise->lacunarity * noise->lacunarity);
}

// A stretch at whose ends the base has different signs.
struct crossing {
    double begin, end, base_at_begin, base_at_end;
};

// The zero of the base, on its positive side, to within a column of `tolerance`. By the Illinois method of false
// position: Dowell and Jarratt, BIT 11, 1971.
static double find_root(const struct density_noise *noise, const struct ray *ray, const struct crossing *crossing,
                        double tolerance)
{
    double at_begin = crossing->base_at_begin, at_end = crossing->base_at_end;
    double low = crossing->begin, high = crossing->end, sliver = (high - low) * 0x1p-24;
    bool is_rising = at_end > 0.0;

    for (int i = 0; i < ROOT_STEPS && high - low > sliver; i++) {
        double middle = low + (high - low) * at_begin / (at_begin - at_end), value;
        struct vec3 position;

        if ((high - low) * density_of(noise, fmax(at_begin, at_end)) <= tolerance) break;

        // Half a sliver beyond the zero, so that the other side moves too.
        middle = fmin(fmax(middle, low + 0.5 * sliver), high - 0.5 * sliver);
        position = ray_at(ray, middle);
        find_bases(noise, 1, &position, &value);
        if ((value > 0.0) == is_rising) {
            high = middle;
            at_end = value;
            at_begin *= 0.5;
        } else {
            low = middle;
            at_begin = value;
            at_end *= 0.5;
        }
    }
    return is_rising ? high : low;
}

// The number of parts, a power of two, of a stretch: in so short ones a bump between zeros at both ends has a column
// within the tolerance. LOOK_LIMIT at most.
static int count_looks(const struct density_noise *noise, double length, double tolerance)
{
    double curvature = curvature_of(noise);
    int count = 2;

    while (count < LOOK_LIMIT) {
        double width = length / count;

        // The mean height of a parabola over the width.
        if (width * density_of(noise, curvature * width * width / 12.0) <= tolerance) break;
        count *= 2;
    }
    return count;
}

// Appends the stretches of a piece where the base is positive, as seen at the ends of its parts.
static void append_positive(const struct density_noise *noise, const struct ray *ray, double begin, double end,
                            double tolerance, struct span_list *spans)
{
    int count = count_looks(noise, end - begin, tolerance);
    double distances[LOOK_LIMIT + 1], bases[LOOK_LIMIT + 1], from = begin;
    struct vec3 positions[LOOK_LIMIT + 1];

    for (int i = 0; i <= count; i++) {
        distances[i] = i == count ? end : begin + (end - begin) * ((double)i / count);
        positions[i] = ray_at(ray, distances[i]);
    }
    find_bases(noise, (size_t)count + 1, positions, bases);
    for (int i = 0; i < count; i++) {
        const struct crossing crossing = {distances[i], distances[i + 1], bases[i], bases[i + 1]};
        double root;

        if ((bases[i] > 0.0) == (bases[i + 1] > 0.0)) continue;
        root = find_root(noise, ray, &crossing, tolerance);
        if (bases[i] > 0.0) span_list_append(spans, from, root, NULL);
        from = root;
    }
    if (bases[count] > 0.0) span_list_append(spans, from, end, NULL);
}

// Appends a piece in so short spans that their nodes see where an octave passes 0 and back.
static void append_kinked(const struct density_noise *noise, double begin, double end, double tolerance,
                          struct span_list *spans)
{
    int parts = (count_looks(noise, end - begin, tolerance) + LOOKS_OF_SPAN - 1) / LOOKS_OF_SPAN;

    for (int i = 0; i < parts; i++) {
        span_list_append(spans, begin + (end - begin) * ((double)i / parts),
                         i + 1 == parts ? end : begin + (end - begin) * ((double)(i + 1) / parts), NULL);
    }
}

// Cuts long stretches: a rule of few nodes could miss all features of many cells.
static void find_rough_spans(const void *field, const struct ray *ray, double near, double far, double tolerance,
                             struct span_list *spans)
{
    const struct density_noise *noise = field;
    double half_cell = 0.5 / noise->frequency;
    double pieces = isfinite(far - near) ? fmin(ceil((far - near) / half_cell), PIECE_LIMIT) : 1.0;

    if (noise->scale == 0.0) return;
    for (int i = 0; i < (int)pieces; i++) {
        double begin = i == 0 ? near : near + (far - near) * (i / pieces);
        double end = i + 1 == (int)pieces ? far : near + (far - near) * ((i + 1) / pieces);

        switch (noise->mode) {
        case SCENE_NOISE_CLIP:
            append_positive(noise, ray, begin, end, tolerance / pieces, spans);
            break;
        case SCENE_NOISE_ABSOLUTE:
            append_kinked(noise, begin, end, tolerance / pieces, spans);
            break;
        case SCENE_NOISE_REMAP:
            span_list_append(spans, begin, end, NULL);
            break;
        }
    }
}

static void find_spans(const void *field, const struct ray *ray, double near, double far, struct span_list *spans)
{
    find_rough_spans(field, ray, near, far, 0.0, spans);
}

static double find_reach(const void *field, const struct ray *ray)
{
    return ((const struct density_noise *)field)->scale > 0.0 ? INFINITY : 0.0;
}

// The most that an octave's absolute value can be, and its slope per lattice cell: the greatest sums over a cell's
// corners that gradients of any direction allow, rounded up.
static const double OCTAVE_MOST = 1.037, OCTAVE_SLOPE_MOST = 4.0;

// Each octave is no greater than its value at the centre and its slope allow, and never above OCTAVE_MOST.
static double find_most(const void *field, const struct box *box)
{
    const struct density_noise *noise = field;
    struct vec3 local = vec3_subtract(box->center, noise->center);
    const struct vec3 rows[3] = {noise->row_x, noise->row_y, noise->row_z};
    const double offsets[3] = {noise->offset.x, noise->offset.y, noise->offset.z};
    double frequency = 1.0, weight = 1.0, sum = 0.0, q[3], radius = box_radius(box) * noise->frequency;

    for (int a = 0; a < 3; a++)
        q[a] = vec3_dot(rows[a], local) * noise->frequency + offsets[a];
    for (int k = 0; k < noise->octaves; k++) {
        double most = OCTAVE_MOST, room = OCTAVE_SLOPE_MOST * radius * frequency;

        if (room < 2.0 * OCTAVE_MOST) {
            double value = density_noise_octave((struct vec3){q[0] * frequency, q[1] * frequency, q[2] * frequency});

            most = fmin(most, (noise->mode == SCENE_NOISE_ABSOLUTE ? fabs(value) : value) + room);
        }
        sum += weight * most;
        frequency *= noise->lacunarity;
        weight *= noise->gain;
    }
    return density_of(noise, noise->mode == SCENE_NOISE_REMAP ? 0.5 * (1.0 + sum) : sum);
}

struct density density_noise_field(const struct density_noise *noise)
{
    return (struct density){.field = noise,
                            .at = at,
                            .at_many = find_densities,
                            .spans = find_spans,
                            .rough_spans = find_rough_spans,
                            .reach = find_reach,
                            .most = find_most};
}
