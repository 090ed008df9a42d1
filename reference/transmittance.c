#include "reference/transmittance.h"

#include "reference/gauss.h"

#include <math.h>

enum { HALVING_LIMIT = 24 };

// One smooth stretch of a ray through a field.
struct stretch {
    double (*at)(const void *field, struct vec3 position);
    const void *field;
    struct ray ray;
};

static double column_of_cell(const struct stretch *stretch, double begin, double end)
{
    double length = end - begin, sum = 0.0;

    for (int i = 0; i < GAUSS_NODES; i++) {
        sum += GAUSS_WEIGHT[i] * stretch->at(stretch->field, ray_at(&stretch->ray, begin + GAUSS_NODE[i] * length));
    }
    return sum * length;
}

// Halves the cell, whose column is `whole`, until a halving changes it by no more than the tolerance.
static double refine(const struct stretch *stretch, double begin, double end, double whole, double tolerance,
                     int halvings_left)
{
    double middle = 0.5 * (begin + end);
    double left = column_of_cell(stretch, begin, middle);
    double right = column_of_cell(stretch, middle, end);

    if (fabs(left + right - whole) <= tolerance || halvings_left == 0) return left + right;
    return refine(stretch, begin, middle, left, tolerance, halvings_left - 1) +
           refine(stretch, middle, end, right, tolerance, halvings_left - 1);
}

double transmittance_density_column(const struct density *density, const struct ray *ray, double near, double far,
                                    double tolerance)
{
    struct span_list spans;
    double column = 0.0;

    spans.count = 0;
    density->spans(density->field, ray, near, far, &spans);
    for (size_t i = 0; i < spans.count; i++) {
        const struct span *span = &spans.spans[i];
        struct stretch stretch = {density->at, density->field, *ray};

        if (density->at_image) {
            stretch.at = density->at_image;
            stretch.ray = span->image;
        }
        column += refine(&stretch, span->begin, span->end, column_of_cell(&stretch, span->begin, span->end),
                         tolerance / (double)spans.count, HALVING_LIMIT);
    }
    return column;
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
        column = transmittance_density_column(&medium->density, ray, near, far,
                                              optical_depth_tolerance / (largest * (double)medium_count));
        for (int c = 0; c < 3; c++)
            optical_depth[c] += sigma_t[c] * column;
    }
    for (int c = 0; c < 3; c++)
        share[c] = exp(-optical_depth[c]);
}
