// SPDX-License-Identifier: Apache-2.0
#include "reference/density_fold_fractal.h"

#include <math.h>
#include <stdbool.h>

static const double SQRT_3 = 1.7320508075688772;

void density_fold_fractal_init(struct density_fold_fractal *fractal, const struct density_fold_fractal_params *params)
{
    *fractal = (struct density_fold_fractal){
        .iterations = params->iterations,
        .offset = params->offset,
        .radius = params->radius,
        .exponent = params->exponent,
        .scale = params->scale,
        .cos_x = cos(params->rotate_x_rad),
        .sin_x = sin(params->rotate_x_rad),
        .cos_y = cos(params->rotate_y_rad),
        .sin_y = sin(params->rotate_y_rad),
    };
}

static struct vec3 rotate(const struct density_fold_fractal *fractal, struct vec3 p)
{
    double y = p.y * fractal->cos_x - p.z * fractal->sin_x;
    double z = p.y * fractal->sin_x + p.z * fractal->cos_x;

    return (struct vec3){p.x * fractal->cos_y + z * fractal->sin_y, y, -p.x * fractal->sin_y + z * fractal->cos_y};
}

// Reflects (a, b) to (-b, -a) when a + b < 0: both lose a + b.
static void reflect(double *a, double *b)
{
    double sum = *a + *b;
    double excess = sum < 0.0 ? sum : 0.0;

    *a -= excess;
    *b -= excess;
}

double density_fold_fractal_distance(const struct density_fold_fractal *fractal, struct vec3 position)
{
    struct vec3 p = position;

    for (int i = 0; i < fractal->iterations; i++) {
        p = rotate(fractal, p);
        reflect(&p.x, &p.y);
        reflect(&p.y, &p.z);
        reflect(&p.z, &p.x);
        p.x -= fractal->offset;
        p.y -= fractal->offset;
        p.z -= fractal->offset;
    }
    return vec3_length(p) - fractal->radius;
}

static double density_at_depth(const struct density_fold_fractal *fractal, double depth)
{
    return depth > 0.0 ? fractal->scale * pow(depth, fractal->exponent) : 0.0;
}

double density_fold_fractal(const struct density_fold_fractal *fractal, struct vec3 position)
{
    return density_at_depth(fractal, -density_fold_fractal_distance(fractal, position));
}

double density_fold_fractal_most(const struct density_fold_fractal *fractal, const struct box *box)
{
    double depth = fractal->radius, radius = box_radius(box);

    // The depth grows by no more than the way: the distance is Lipschitz with constant 1.
    if (!isinf(radius)) depth = fmin(depth, radius - density_fold_fractal_distance(fractal, box->center));
    return density_at_depth(fractal, depth);
}

double density_fold_fractal_folded(const struct density_fold_fractal *fractal, struct vec3 image)
{
    return density_at_depth(fractal, fractal->radius - vec3_length(image));
}

// After i folds, each remaining offset brings a point nearer to the origin by at most sqrt(3) |offset|.
static double bound_after(const struct density_fold_fractal *fractal, int folds_done)
{
    return fractal->radius + (fractal->iterations - folds_done) * SQRT_3 * fabs(fractal->offset);
}

double density_fold_fractal_bound(const struct density_fold_fractal *fractal)
{
    return bound_after(fractal, 0);
}

// The image of a ray's stretch under the folds so far: again straight.
struct piece {
    double begin, end;
    struct ray image;
};

// Cuts the piece down to where it lies within `radius` of the origin; false when nothing is left.
static bool clip_to_sphere(struct piece *piece, double radius)
{
    double middle = -vec3_dot(piece->image.origin, piece->image.direction);
    struct vec3 nearest = vec3_add(piece->image.origin, vec3_scale(piece->image.direction, middle));
    double half_squared = radius * radius - vec3_dot(nearest, nearest);
    double half;

    if (half_squared <= 0.0) return false;
    half = sqrt(half_squared);
    piece->begin = fmax(piece->begin, middle - half);
    piece->end = fmin(piece->end, middle + half);
    return piece->begin < piece->end;
}

// Cuts the piece at its point nearest to the origin, where the distance changes sharply: both sides are then smooth.
static void append_piece(const struct piece *piece, struct span_list *spans)
{
    double nearest = -vec3_dot(piece->image.origin, piece->image.direction);
    double cut = fmin(fmax(nearest, piece->begin), piece->end);

    span_list_append(spans, piece->begin, cut, &piece->image);
    span_list_append(spans, cut, piece->end, &piece->image);
}

// Permutes the coordinates' names, so that every fold is at x + y = 0. Three permutations restore them.
static struct vec3 turn_names(struct vec3 v)
{
    return (struct vec3){v.y, v.z, v.x};
}

static struct vec3 reflect_xy(struct vec3 v)
{
    return (struct vec3){-v.y, -v.x, v.z};
}

static void fold_piece(const struct density_fold_fractal *fractal, struct piece piece, int reflections_done,
                       struct span_list *spans);

static void fold_side(const struct density_fold_fractal *fractal, struct piece piece, int reflections_done,
                      struct span_list *spans)
{
    struct vec3 middle = ray_at(&piece.image, 0.5 * (piece.begin + piece.end));

    if (middle.x + middle.y < 0.0) {
        piece.image.origin = reflect_xy(piece.image.origin);
        piece.image.direction = reflect_xy(piece.image.direction);
    }
    piece.image.origin = turn_names(piece.image.origin);
    piece.image.direction = turn_names(piece.image.direction);
    if (reflections_done % 3 == 2) {
        struct vec3 shift = {fractal->offset, fractal->offset, fractal->offset};

        piece.image.origin = vec3_subtract(piece.image.origin, shift);
    }
    fold_piece(fractal, piece, reflections_done + 1, spans);
}

static void fold_piece(const struct density_fold_fractal *fractal, struct piece piece, int reflections_done,
                       struct span_list *spans)
{
    double sum, slope, cut;
    struct piece before, after;

    if (reflections_done % 3 == 0) {
        if (!clip_to_sphere(&piece, bound_after(fractal, reflections_done / 3))) return;
        if (reflections_done == 3 * fractal->iterations) {
            append_piece(&piece, spans);
            return;
        }
        piece.image.origin = rotate(fractal, piece.image.origin);
        piece.image.direction = rotate(fractal, piece.image.direction);
    }
    sum = piece.image.origin.x + piece.image.origin.y;
    slope = piece.image.direction.x + piece.image.direction.y;
    cut = slope != 0.0 ? -sum / slope : piece.begin;
    if (!(piece.begin < cut && cut < piece.end)) {
        fold_side(fractal, piece, reflections_done, spans);
        return;
    }
    before = after = piece;
    before.end = after.begin = cut;
    fold_side(fractal, before, reflections_done, spans);
    fold_side(fractal, after, reflections_done, spans);
}

void density_fold_fractal_spans(const struct density_fold_fractal *fractal, const struct ray *ray, double near,
                                double far, struct span_list *spans)
{
    struct piece whole = {near, far, *ray};

    fold_piece(fractal, whole, 0, spans);
}
