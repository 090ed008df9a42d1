// SPDX-License-Identifier: Apache-2.0
#include "reference/density_noise.h"

#include <math.h>
#include <stdbool.h>

enum { PIECE_LIMIT = 128, HALVING_LIMIT = 5, ROOT_STEPS = 24 };

// Perlin's table.
static const unsigned char PERMUTATION[256] = {
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103, 30,  69,  142,
    8,   99,  37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,  197, 62,  94,  252, 219, 203,
    117, 35,  11,  32,  57,  177, 33,  88,  237, 149, 56,  87,  174, 20,  125, 136, 171, 168, 68,  175, 74,  165,
    71,  134, 139, 48,  27,  166, 77,  146, 158, 231, 83,  111, 229, 122, 60,  211, 133, 230, 220, 105, 92,  41,
    55,  46,  245, 40,  244, 102, 143, 54,  65,  25,  63,  161, 1,   216, 80,  73,  209, 76,  132, 187, 208, 89,
    18,  169, 200, 196, 135, 130, 116, 188, 159, 86,  164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250,
    124, 123, 5,   202, 38,  147, 118, 126, 255, 82,  85,  212, 207, 206, 59,  227, 47,  16,  58,  17,  182, 189,
    28,  42,  223, 183, 170, 213, 119, 248, 152, 2,   44,  154, 163, 70,  221, 153, 101, 155, 167, 43,  172, 9,
    129, 22,  39,  253, 19,  98,  108, 110, 79,  113, 224, 232, 178, 185, 112, 104, 218, 246, 97,  228, 251, 34,
    242, 193, 238, 210, 144, 12,  191, 179, 162, 241, 81,  51,  145, 235, 249, 14,  239, 107, 49,  192, 214, 31,
    181, 199, 106, 157, 184, 84,  204, 176, 115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,  222, 114,
    67,  29,  24,  72,  243, 141, 128, 195, 78,  66,  215, 61,  156, 180,
};

// Gradients towards the middles of a cube's edges; four of the twelve come twice.
static const double GRADIENT[16][3] = {
    {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}, //
    {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, //
    {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1}, //
    {1, 1, 0}, {0, -1, 1}, {-1, 1, 0}, {0, -1, -1},
};

// The table's entry for any integer, by its remainder.
static int permuted(int number)
{
    return PERMUTATION[(unsigned)number % 256];
}

static double smooth(double t)
{
    return ((6.0 * t - 15.0) * t + 10.0) * t * t * t;
}

// Along one axis: the lattice points on either side, the distance from the lower one and the weight of the upper one.
struct sides {
    int point;
    double away, weight;
};

static struct sides sides_of(double coordinate)
{
    double whole = floor(coordinate), part = coordinate - whole;
    // Exact: 256 is a power of two.
    int point = (int)(whole - 256.0 * floor(whole / 256.0));

    return (struct sides){point, part, smooth(part)};
}

static double ramp(int point, double x, double y, double z)
{
    const double *gradient = GRADIENT[permuted(point) % 16];

    return gradient[0] * x + gradient[1] * y + gradient[2] * z;
}

// The interpolated values of the two corners of an edge along z.
static double blend_edge(int column, const struct sides *z, double x, double y)
{
    double below = ramp(column + z->point, x, y, z->away);
    double above = ramp(column + z->point + 1, x, y, z->away - 1.0);

    return below + z->weight * (above - below);
}

static double blend_face(int plane, const struct sides *y, const struct sides *z, double x)
{
    double below = blend_edge(permuted(plane + y->point), z, x, y->away);
    double above = blend_edge(permuted(plane + y->point + 1), z, x, y->away - 1.0);

    return below + y->weight * (above - below);
}

double density_noise_octave(struct vec3 q)
{
    struct sides x = sides_of(q.x), y = sides_of(q.y), z = sides_of(q.z);
    double below = blend_face(permuted(x.point), &y, &z, x.away);
    double above = blend_face(permuted(x.point + 1), &y, &z, x.away - 1.0);

    return below + x.weight * (above - below);
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

static double sum_of_octaves(const struct density_noise *noise, struct vec3 q)
{
    double sum = 0.0, frequency = 1.0, weight = 1.0;

    for (int k = 0; k < noise->octaves; k++) {
        double octave = density_noise_octave(vec3_scale(q, frequency));

        if (noise->mode == SCENE_NOISE_ABSOLUTE) octave = fabs(octave);
        sum += weight * octave;
        frequency *= noise->lacunarity;
        weight *= noise->gain;
    }
    return sum;
}

// The base of the power that is the density, where it is positive.
static double base(const struct density_noise *noise, struct vec3 position)
{
    struct vec3 local = vec3_subtract(position, noise->center);
    struct vec3 image = {vec3_dot(noise->row_x, local), vec3_dot(noise->row_y, local), vec3_dot(noise->row_z, local)};
    double sum = sum_of_octaves(noise, vec3_add(vec3_scale(image, noise->frequency), noise->offset));

    return noise->mode == SCENE_NOISE_REMAP ? 0.5 * (1.0 + sum) : sum;
}

double density_noise(const struct density_noise *noise, struct vec3 position)
{
    double value = base(noise, position);

    if (!(value > 0.0)) return 0.0;
    return noise->scale * (noise->exponent == 1.0 ? value : pow(value, noise->exponent));
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

// A Lipschitz constant of the base, per metre.
static double steepness_of(const struct density_noise *noise)
{
    // Of one octave, per lattice cell. Not proven: the steepest of ten million random points was 3.39.
    const double of_octave = 4.0;

    return of_octave * noise->frequency * sum_weights(noise, noise->lacunarity) *
           (noise->mode == SCENE_NOISE_REMAP ? 0.5 : 1.0);
}

// An upper bound of the base: eight ramps, each below 2 in its cell, with weights that sum to 1.
static double highest_of(const struct density_noise *noise)
{
    return 2.0 * sum_weights(noise, 1.0);
}

struct search {
    const struct density_noise *noise;
    const struct ray *ray;
    double steepness;
    double highest;         // upper bound of the base's absolute value
    double last, last_base; // the last evaluated distance, where the next stretch often begins
    double begin;           // of the searched piece
    struct span_list *spans;
};

static double base_at(struct search *search, double distance)
{
    if (distance != search->last) {
        search->last_base = base(search->noise, ray_at(search->ray, distance));
        search->last = distance;
    }
    return search->last_base;
}

// Appends a stretch, joined with the one before where they meet within a piece.
static void append(const struct search *search, double begin, double end)
{
    struct span_list *spans = search->spans;

    if (spans->count > 0 && spans->spans[spans->count - 1].end == begin && begin > search->begin) {
        spans->spans[spans->count - 1].end = end;
    } else {
        span_list_append(spans, begin, end, NULL);
    }
}

// The zero of the base, on its positive side, by the Illinois method of false position: Dowell and Jarratt, BIT 11,
// 1971.
static double find_root(struct search *search, double begin, double at_begin, double end, double at_end)
{
    bool is_rising = at_end > 0.0;
    double low = begin, high = end, sliver = (end - begin) * 0x1p-24;

    for (int i = 0; i < ROOT_STEPS && high - low > sliver; i++) {
        double middle = low + (high - low) * at_begin / (at_begin - at_end), value;

        // Half a sliver beyond the zero, so that the other side moves too.
        middle = fmin(fmax(middle, low + 0.5 * sliver), high - 0.5 * sliver);
        value = base_at(search, middle);
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

// Appends the positive side of a stretch so short that the base passes 0 at most once.
static void append_side(struct search *search, double begin, double end)
{
    double at_begin = base_at(search, begin), at_end = base_at(search, end), root;

    if ((at_begin > 0.0) == (at_end > 0.0)) {
        if (at_begin > 0.0) append(search, begin, end);
        return;
    }
    root = find_root(search, begin, at_begin, end, at_end);
    search->last = end;
    search->last_base = at_end;
    if (at_begin > 0.0) {
        append(search, begin, root);
    } else {
        append(search, root, end);
    }
}

// Finds all positive stretches. Where the base at a stretch's middle is farther from 0 than it can change within the
// stretch, there is no zero; other stretches are halved, because a bump between two nodes would be missed at any
// accuracy.
static void find_positive(struct search *search, double begin, double end, int halvings_left)
{
    double middle = 0.5 * (begin + end), reach = search->steepness * 0.5 * (end - begin), value = 0.0;
    // No value is farther from 0 than `highest`.
    bool is_sampled = halvings_left > 0 && reach <= search->highest;

    if (is_sampled) value = base(search->noise, ray_at(search->ray, middle));
    if (is_sampled && fabs(value) >= reach) {
        if (value > 0.0) append(search, begin, end);
    } else if (halvings_left == 0) {
        append_side(search, begin, end);
    } else {
        find_positive(search, begin, middle, halvings_left - 1);
        find_positive(search, middle, end, halvings_left - 1);
    }
}

// Cuts long stretches: a rule of few nodes could miss all features of many cells.
static void find_spans(const void *field, const struct ray *ray, double near, double far, struct span_list *spans)
{
    const struct density_noise *noise = field;
    struct search search = {.noise = noise,
                            .ray = ray,
                            .steepness = steepness_of(noise),
                            .highest = highest_of(noise),
                            .last = NAN,
                            .spans = spans};
    double half_cell = 0.5 / noise->frequency;
    double pieces = isfinite(far - near) ? fmin(ceil((far - near) / half_cell), PIECE_LIMIT) : 1.0;

    if (noise->scale == 0.0) return;
    for (int i = 0; i < (int)pieces; i++) {
        double begin = i == 0 ? near : near + (far - near) * (i / pieces);
        double end = i + 1 == (int)pieces ? far : near + (far - near) * ((i + 1) / pieces);

        if (noise->mode == SCENE_NOISE_CLIP) {
            search.begin = begin;
            find_positive(&search, begin, end, HALVING_LIMIT);
        } else {
            span_list_append(spans, begin, end, NULL);
        }
    }
}

static double find_reach(const void *field, const struct ray *ray)
{
    return ((const struct density_noise *)field)->scale > 0.0 ? INFINITY : 0.0;
}

struct density density_noise_field(const struct density_noise *noise)
{
    return (struct density){.field = noise, .at = at, .spans = find_spans, .reach = find_reach};
}
