// SPDX-License-Identifier: Apache-2.0
#include "reference/transmittance.h"

#include "reference/column.h"

#include <math.h>
#include <stdbool.h>

// The optical depth that counts as dark: exp(-40) is below any accuracy.
static const double DARK_DEPTH = 40.0;
// In metres: a medium that is not dark by then counts as clear.
static const double FARTHEST = 0x1p60;

double transmittance_density_column(const struct density *density, const struct ray *ray, double near, double far,
                                    double tolerance)
{
    return column_integrate(density, ray, near, far, &(struct column_accuracy){.error = tolerance});
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

static double find_column(const struct medium *medium, const struct ray *ray, double near, double far,
                          const struct column_accuracy *accuracy)
{
    const struct density *density = &medium->density;
    double end;

    if (isinf(far) && !density->column && is_endless(density, ray)) {
        return follow_to_darkness(density, ray, near, DARK_DEPTH / least_extinction(medium), accuracy->error, &end);
    }
    return column_integrate(density, ray, near, far, accuracy);
}

void transmittance_within(const struct medium *media, size_t medium_count, const struct ray *ray, double near,
                          double far, const struct transmittance_accuracy *accuracy, double share[static 3])
{
    double optical_depth[3] = {0.0, 0.0, 0.0}, count = (double)medium_count;

    for (size_t m = 0; m < medium_count; m++) {
        const struct medium *medium = &media[m];
        struct column_accuracy own = {.sigma_min = INFINITY};
        double sigma_t[3], column, passed;

        for (int c = 0; c < 3; c++) {
            sigma_t[c] = medium->sigma_s[c] + medium->sigma_a[c];
            own.sigma_min = fmin(own.sigma_min, sigma_t[c]);
            own.sigma_max = fmax(own.sigma_max, sigma_t[c]);
        }
        if (own.sigma_max == 0.0) continue;
        passed = exp(-fmin(fmin(optical_depth[0], optical_depth[1]), optical_depth[2]));
        own.error = accuracy->optical_depth / (own.sigma_max * count);
        own.light = accuracy->light / (fmax(passed, 1e-300) * count);
        column = find_column(medium, ray, near, far, &own);
        for (int c = 0; c < 3; c++) {
            // The column may be infinite, but a coefficient of 0 still attenuates nothing.
            if (sigma_t[c] > 0.0) optical_depth[c] += sigma_t[c] * column;
        }
    }
    for (int c = 0; c < 3; c++)
        share[c] = exp(-optical_depth[c]);
}

void transmittance(const struct medium *media, size_t medium_count, const struct ray *ray, double near, double far,
                   double optical_depth_tolerance, double share[static 3])
{
    transmittance_within(media, medium_count, ray, near, far,
                         &(struct transmittance_accuracy){.optical_depth = optical_depth_tolerance}, share);
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
