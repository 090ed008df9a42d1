// SPDX-License-Identifier: Apache-2.0
#include "worker/sparse/transfer_function.h"

#include <math.h>
#include <string.h>

static double opacity_at(const struct scene_transfer_point *points, size_t count, double value)
{
    for (size_t i = 0; i < count; ++i) {
        double share;

        if (value >= points[i].value) continue;
        if (i == 0) return points[0].rgba[3];
        share = (value - points[i - 1].value) / (points[i].value - points[i - 1].value);
        return points[i - 1].rgba[3] * (1 - share) + points[i].rgba[3] * share;
    }
    return points[count - 1].rgba[3];
}

// The function is linear between points, so the greatest opacity is at a point or at an end of the range.
double transfer_function_max_opacity(const struct scene_transfer_point *points, size_t count, double min, double max)
{
    double greatest = fmax(opacity_at(points, count, min), opacity_at(points, count, max));

    for (size_t i = 0; i < count; ++i)
        if (points[i].value >= min && points[i].value <= max) greatest = fmax(greatest, points[i].rgba[3]);
    return greatest;
}

static void write_number(FILE *out, double value)
{
    char text[32];

    snprintf(text, sizeof text, "%.9g", (double)(float)value);
    fprintf(out, "%s%s", text, strpbrk(text, ".e") ? "" : ".0");
}

static void write_components(FILE *out, const double *components, int count)
{
    if (count > 1) fputs("vec3(", out);
    for (int i = 0; i < count; ++i) {
        if (i > 0) fputs(", ", out);
        write_number(out, components[i]);
    }
    if (count > 1) fputc(')', out);
}

// Writes the components from `first` on as a function of the value.
static void write_function(FILE *out, const struct scene_transfer_point *points, size_t point_count, int first,
                           int component_count)
{
    fputs("(float value)\n{\n    ", out);
    fprintf(out, "%s seen = ", component_count > 1 ? "vec3" : "float");
    write_components(out, &points[0].rgba[first], component_count);
    fputs(";\n", out);
    for (size_t i = 1; i < point_count; ++i) {
        if (memcmp(&points[i].rgba[first], &points[i - 1].rgba[first], (size_t)component_count * sizeof(double)) == 0)
            continue;
        fputs("    seen = transfer_mix(seen, ", out);
        write_components(out, &points[i].rgba[first], component_count);
        fputs(", transfer_share(value, ", out);
        write_number(out, points[i - 1].value);
        fputs(", ", out);
        write_number(out, 1 / (points[i].value - points[i - 1].value));
        fputs("));\n", out);
    }
    fputs("    return seen;\n}\n", out);
}

bool transfer_function_is_empty(const struct scene_transfer_point *points, size_t count, double min, double max)
{
    return (count == 0 ? max : transfer_function_max_opacity(points, count, min, max)) <= 0;
}

void transfer_function_write(FILE *out, const char *prefix, const struct scene_transfer_point *points, size_t count)
{
    fprintf(out, "float %s_opacity", prefix);
    write_function(out, points, count, 3, 1);
    fprintf(out, "vec3 %s_rgb", prefix);
    write_function(out, points, count, 0, 3);
}
