// SPDX-License-Identifier: Apache-2.0
#include "reference/transmittance.h"

#include "reference/gauss.h"

#include <math.h>
#include <stdbool.h>

enum { HALVING_LIMIT = 24 };

// The optical depth that counts as dark: exp(-40) is below any accuracy.
static const double DARK_DEPTH = 40.0;
// In metres: a medium that is not dark by then counts as clear.
static const double FARTHEST = 0x1p60;

// One smooth stretch of a ray through a field.
struct stretch {
    bool is_loose; // one agreement of halvings is enough
    double (*at)(const void *field, struct vec3 position);
    const void *field;
    struct ray ray;
};

struct cell {
    double begin, end; // m along the ray
};

static double column_of_cell(const struct stretch *stretch, struct cell cell)
{
    double length = cell.end - cell.begin, sum = 0.0;

    for (int i = 0; i < GAUSS_NODES; i++) {
        sum +=
            GAUSS_WEIGHT[i] * stretch->at(stretch->field, ray_at(&stretch->ray, cell.begin + GAUSS_NODE[i] * length));
    }
    return sum * length;
}

// Halves the cell, whose column is `whole`, until two halvings in a row change little and the error that the second
// leaves is within the tolerance. One alone may agree by accident. Where the field is smooth, a halving divides the
// error by at least 2^4. The actual factor follows from `change_before`, the change of the cell that this one is half
// of; negative: there was none.
static double refine(const struct stretch *stretch, struct cell cell, double whole, double change_before,
                     double tolerance, int halvings_left)
{
    double middle = 0.5 * (cell.begin + cell.end);
    struct cell left = {cell.begin, middle}, right = {middle, cell.end};
    double left_column = column_of_cell(stretch, left), right_column = column_of_cell(stretch, right);
    double change = fabs(left_column + right_column - whole);
    double quotient = fmin(fmax(change_before / change, 1.0), 16.0);
    bool agreed_before = stretch->is_loose || (change_before >= 0.0 && change_before <= 16.0 * tolerance);

    if (halvings_left == 0 || (agreed_before && change <= tolerance * quotient)) return left_column + right_column;
    return refine(stretch, left, left_column, change, tolerance, halvings_left - 1) +
           refine(stretch, right, right_column, change, tolerance, halvings_left - 1);
}

static double integrate_column(const struct density *density, const struct ray *ray, double near, double far,
                               double tolerance, bool is_loose)
{
    struct span_list spans = {0};
    double column = 0.0;

    if (density->column) return near < far ? density->column(density->field, ray, near, far) : 0.0;
    density->spans(density->field, ray, near, far, &spans);
    for (size_t i = 0; i < spans.count; i++) {
        const struct span *span = &spans.spans[i];
        struct stretch stretch = {is_loose, density->at, density->field, *ray};
        struct cell cell;

        if (density->at_image) {
            stretch.at = density->at_image;
            stretch.ray = span->image;
        }
        cell = (struct cell){span->begin, span->end};
        column += refine(&stretch, cell, column_of_cell(&stretch, cell), -1.0, tolerance / (double)spans.count,
                         HALVING_LIMIT);
    }
    span_list_finish(&spans);
    return column;
}

double transmittance_density_column(const struct density *density, const struct ray *ray, double near, double far,
                                    double tolerance)
{
    return integrate_column(density, ray, near, far, tolerance, false);
}

static bool is_endless(const struct density *density, const struct ray *ray)
{
    return density->reach && isinf(density->reach(density->field, ray)) && density->reach(density->field, ray) > 0.0;
}

// Doubles the distance along an endless ray until its column is dark, and writes the distance to `end`.
static double follow_to_darkness(const struct density *density, const struct ray *ray, double near, double enough,
                                 double tolerance, double *end)
{
    double column = 0.0, length = 1.0;

    *end = near;
    while (column < enough && length < FARTHEST) {
        column += transmittance_density_column(density, ray, *end, *end + length, tolerance);
        *end += length;
        length *= 2.0;
    }
    return column;
}

// The smallest extinction above 0 per unit of density; INFINITY when there is none.
static double least_extinction(const struct medium *medium)
{
    double least = INFINITY;

    for (int c = 0; c < 3; c++) {
        double sigma_t = medium->sigma_s[c] + medium->sigma_a[c];

        if (sigma_t > 0.0) least = fmin(least, sigma_t);
    }
    return least;
}

static double find_column(const struct medium *medium, const struct ray *ray, double near, double far, double tolerance,
                          bool is_loose)
{
    const struct density *density = &medium->density;
    double end;

    if (isinf(far) && !density->column && is_endless(density, ray)) {
        return follow_to_darkness(density, ray, near, DARK_DEPTH / least_extinction(medium), tolerance, &end);
    }
    return integrate_column(density, ray, near, far, tolerance, is_loose);
}

void transmittance(const struct medium *media, size_t medium_count, const struct ray *ray, double near, double far,
                   double optical_depth_tolerance, double share[static 3])
{
    double optical_depth[3] = {0.0, 0.0, 0.0};

    for (size_t m = 0; m < medium_count; m++) {
        const struct medium *medium = &media[m];
        double sigma_t[3], largest = 0.0, column;

        for (int c = 0; c < 3; c++) {
            sigma_t[c] = medium->sigma_s[c] + medium->sigma_a[c];
            largest = fmax(largest, sigma_t[c]);
        }
        if (largest == 0.0) continue;
        column = find_column(medium, ray, near, far, optical_depth_tolerance / (largest * (double)medium_count),
                             optical_depth_tolerance >= TRANSMITTANCE_LOOSE);
        for (int c = 0; c < 3; c++) {
            // The column may be infinite, but a coefficient of 0 still attenuates nothing.
            if (sigma_t[c] > 0.0) optical_depth[c] += sigma_t[c] * column;
        }
    }
    for (int c = 0; c < 3; c++)
        share[c] = exp(-optical_depth[c]);
}

static double last_end(const struct density *density, const struct ray *ray, double near)
{
    struct span_list spans = {0};
    double last = near;

    density->spans(density->field, ray, near, INFINITY, &spans);
    if (spans.count > 0) last = spans.spans[spans.count - 1].end;
    span_list_finish(&spans);
    return last;
}

double transmittance_reach(const struct medium *media, size_t medium_count, const struct ray *ray, double near,
                           double far)
{
    double dark = near, last = near;
    bool has_endless = false;

    if (!isinf(far)) return far;
    for (size_t m = 0; m < medium_count; m++) {
        if (is_endless(&media[m].density, ray)) {
            double end, enough = DARK_DEPTH / least_extinction(&media[m]);

            has_endless = true;
            follow_to_darkness(&media[m].density, ray, near, enough, 1e-3, &end);
            dark = fmax(dark, end);
        } else {
            last = fmax(last, last_end(&media[m].density, ray, near));
        }
    }
    return has_endless ? fmax(dark, last) : far;
}
