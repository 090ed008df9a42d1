// Written from the seed's formulas alone, sharing nothing with the integrators it judges.
// SPDX-License-Identifier: Apache-2.0
// Its conventions are the seed's: columns-first matrices, a picture that counts rows from the bottom, a phase function
// without 1 / 4 pi whose cosine has the other sign.
#include "tests/support/seed_cloud.h"

#include <math.h>
#include <stddef.h>

enum { FOLDS = 8, CAMERA_STEPS = 120, LIGHT_STEPS = 16 };

static const double CAMERA_STEP = 0.01;
static const double ATTENUATION = 64.0;

// m[column][row], as GLSL's constructor fills it: the first three numbers are the first column.
struct matrix {
    double m[3][3];
};

static struct matrix axis_matrix(const double axis[3], double angle)
{
    double s = sin(angle), c = cos(angle), rest = 1.0 - cos(angle);
    double x = axis[0], y = axis[1], z = axis[2];

    return (struct matrix){{
        {c + x * x * rest, x * y * rest - z * s, x * z * rest + y * s},
        {y * x * rest + z * s, c + y * y * rest, y * z * rest - x * s},
        {z * x * rest - y * s, z * y * rest + x * s, c + z * z * rest},
    }};
}

static void multiply(const struct matrix *matrix, double v[3])
{
    double product[3];

    for (int row = 0; row < 3; row++) {
        product[row] = matrix->m[0][row] * v[0] + matrix->m[1][row] * v[1] + matrix->m[2][row] * v[2];
    }
    for (int row = 0; row < 3; row++)
        v[row] = product[row];
}

static void swap_negated(double *a, double *b)
{
    double old_a = *a;

    if (*a + *b >= 0.0) return;
    *a = -*b;
    *b = -old_a;
}

struct moment {
    struct matrix about_x, about_y;
    double light[3];
};

static struct moment moment_at(double time)
{
    static const double X_AXIS[3] = {1.0, 0.0, 0.0}, Y_AXIS[3] = {0.0, 1.0, 0.0};
    double slow = time * 0.2;

    return (struct moment){
        .about_x = axis_matrix(X_AXIS, time * 0.2),
        .about_y = axis_matrix(Y_AXIS, time * 0.1),
        .light = {1.5 * sin(3.1 * slow + 0.2), 1.2 * sin(2.2 * slow), 1.1 * sin(4.3 * slow)},
    };
}

static double density_at(const struct moment *moment, const double position[3])
{
    double p[3] = {position[0], position[1], position[2]};
    double inside;

    for (int fold = 0; fold < FOLDS; fold++) {
        multiply(&moment->about_x, p);
        multiply(&moment->about_y, p);
        swap_negated(&p[0], &p[1]);
        swap_negated(&p[1], &p[2]);
        swap_negated(&p[2], &p[0]);
        for (int i = 0; i < 3; i++)
            p[i] -= 0.06;
    }
    inside = 0.15 - sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    return inside > 0.0 ? pow(inside, 1.3) * 10.0 : 0.0;
}

static double lobe(double cosine, double g)
{
    return (1.0 - g * g) / pow(1.0 + g * g - 2.0 * g * cosine, 1.5);
}

// Light that arrives at `position` and is sent to the camera.
static double external_light(const struct moment *moment, const double position[3], const double ray[3])
{
    double way[3], distance = 0.0, cosine = 0.0, shadow = 0.0, step;

    for (int i = 0; i < 3; i++) {
        way[i] = moment->light[i] - position[i];
        distance += way[i] * way[i];
    }
    distance = sqrt(distance);
    for (int i = 0; i < 3; i++) {
        way[i] /= distance;
        cosine -= ray[i] * way[i];
    }
    step = distance / LIGHT_STEPS;
    for (int j = 0; j < LIGHT_STEPS; j++) {
        double sample[3];

        for (int i = 0; i < 3; i++)
            sample[i] = position[i] + way[i] * step * j;
        shadow += density_at(moment, sample) * step;
    }
    return exp(-shadow * ATTENUATION) * 0.5 * (lobe(cosine, 0.8) + lobe(cosine, -0.2));
}

static double pixel_value(const struct moment *moment, double u, double v)
{
    double length = sqrt(u * u + v * v + 4.0);
    double ray[3] = {u / length, v / length, 2.0 / length};
    double value = 0.0, transmittance = 1.0;

    for (int k = 1; k <= CAMERA_STEPS; k++) {
        double distance = 1.0 + k * CAMERA_STEP;
        double position[3] = {ray[0] * distance, ray[1] * distance, ray[2] * distance - 2.0};
        double density = density_at(moment, position);

        if (density <= 0.0) continue;
        value += transmittance * density * external_light(moment, position, ray);
        transmittance *= exp(-density * CAMERA_STEP * ATTENUATION);
        if (transmittance < 0.01) break;
    }
    return value;
}

void seed_cloud_render(double time, int size_px, double *rgb)
{
    struct moment moment = moment_at(time);

    for (int row = 0; row < size_px; row++) {
        int row_from_bottom = size_px - 1 - row;

        for (int column = 0; column < size_px; column++) {
            double u = ((column + 0.5) / size_px - 0.5) * 2.0;
            double v = ((row_from_bottom + 0.5) / size_px - 0.5) * 2.0;
            double value = pixel_value(&moment, u, v);

            for (int c = 0; c < 3; c++)
                rgb[3 * ((size_t)row * (size_t)size_px + (size_t)column) + (size_t)c] = value;
        }
    }
}
