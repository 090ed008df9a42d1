// SPDX-License-Identifier: Apache-2.0
#include "reference/phase_draw.h"

#include <math.h>

struct turn {
    double cosine, sine;
};

// Twice the angle of a point that is even in the unit disk: von Neumann, Applied Mathematics Series 12, 1951.
static struct turn draw_turn(struct stream *stream)
{
    double x, y, square;

    do {
        x = 2.0 * stream_draw(stream) - 1.0;
        y = stream_draw(stream);
        square = x * x + y * y;
    } while (!(square <= 1.0 && square > 0x1p-80));
    return (struct turn){(x * x - y * y) / square, 2.0 * x * y / square};
}

struct vec3 phase_draw_about(struct vec3 axis, double cosine, struct stream *stream)
{
    struct turn turn = draw_turn(stream);
    double sine = sqrt(fmax(1.0 - cosine * cosine, 0.0));
    // Duff et al., Building an Orthonormal Basis, Revisited, JCGT 6, 2017.
    double sign = copysign(1.0, axis.z), a = -1.0 / (sign + axis.z), b = axis.x * axis.y * a;
    struct vec3 right = {1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x};
    struct vec3 up = {b, sign + axis.y * axis.y * a, -axis.y};
    struct vec3 side = vec3_add(vec3_scale(right, turn.cosine), vec3_scale(up, turn.sine));

    return vec3_normalize(vec3_add(vec3_scale(axis, cosine), vec3_scale(side, sine)));
}

static double draw_henyey_greenstein(double g, double u)
{
    double s = 2.0 * u - 1.0, share;

    share = (1.0 - g * g) / (1.0 + g * s);
    // Near 0 the difference below loses all digits; this is the same with g divided out.
    if (fabs(g) < 0.5) {
        double product = 1.0 + g * s, sum = s + 0.5 * g * (s * s + 3.0) + g * g * s + 0.5 * g * g * g * (s * s - 1.0);

        return fmin(fmax(sum / (product * product), -1.0), 1.0);
    }
    return fmin(fmax((1.0 + g * g - share * share) / (2.0 * g), -1.0), 1.0);
}

static double draw_rayleigh(double u)
{
    double q = 2.0 * (2.0 * u - 1.0), root = cbrt(q + sqrt(q * q + 1.0));

    return fmin(fmax(root - 1.0 / root, -1.0), 1.0);
}

double phase_draw_cosine(const struct medium *medium, struct stream *stream)
{
    double part = stream_draw(stream), u = stream_draw(stream);
    size_t lobe = 0;

    if (medium->lobe_count == 0) return 2.0 * u - 1.0;
    while (lobe + 1 < medium->lobe_count && part >= medium->lobes[lobe].weight)
        part -= medium->lobes[lobe++].weight;
    if (medium->lobes[lobe].kind == SCENE_LOBE_RAYLEIGH) return draw_rayleigh(u);
    return draw_henyey_greenstein(medium->lobes[lobe].g, u);
}
