// SPDX-License-Identifier: Apache-2.0
#include "tests/support/random_job.h"

#include "tests/support/random.h"
#include "tests/support/volume_maker.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct scribe {
    FILE *out;
    struct random random;
    bool is_colored, scatters, has_solids;
    const char *volume; // a file of voxels
};

static double number(struct scribe *scribe, double low, double high)
{
    return random_between(&scribe->random, low, high);
}

static int choice(struct scribe *scribe, int count)
{
    return (int)number(scribe, 0.0, count);
}

static void write_number(struct scribe *scribe, const char *key, double low, double high)
{
    fprintf(scribe->out, "\"%s\": %.6f", key, number(scribe, low, high));
}

static void write_vector(struct scribe *scribe, const char *key, double low, double high)
{
    double x = number(scribe, low, high), y = number(scribe, low, high), z = number(scribe, low, high);

    fprintf(scribe->out, "\"%s\": [%.6f, %.6f, %.6f]", key, x, y, z);
}

static void write_color(struct scribe *scribe, const char *key, double high)
{
    if (scribe->is_colored) {
        write_vector(scribe, key, 0.0, high);
    } else {
        write_number(scribe, key, 0.0, high);
    }
}

static void write_bounds(struct scribe *scribe)
{
    static const char *const KINDS[] = {"sphere", "box", "slab"};
    int kind = choice(scribe, scribe->scatters ? 2 : 3);

    fprintf(scribe->out, ", \"bounds\": {\"kind\": \"%s\", ", KINDS[kind]);
    write_vector(scribe, "center", -0.25, 0.25);
    fputs(", ", scribe->out);
    if (kind == 0) write_number(scribe, "radius", 0.4, 0.8);
    if (kind == 1) write_vector(scribe, "size", 0.7, 1.4);
    if (kind == 2) {
        // Not parallel to a camera ray, along which a slab would be long.
        double x = number(scribe, -0.3, 0.3), y = number(scribe, -0.3, 0.3);

        fprintf(scribe->out, "\"normal\": [%.6f, %.6f, 1], ", x, y);
        write_number(scribe, "thickness", 0.4, 0.8);
    }
    if (choice(scribe, 2)) {
        fputs(", ", scribe->out);
        write_number(scribe, "falloff", 0.15, 0.5);
    }
    fputs("}", scribe->out);
}

static void write_noise(struct scribe *scribe)
{
    static const char *const MODES[] = {"remap", "clip", "absolute"};
    int octaves = 1 + choice(scribe, 2);

    fprintf(scribe->out, "\"kind\": \"noise\", \"octaves\": %d, \"mode\": \"%s\", ", octaves, MODES[choice(scribe, 3)]);
    write_number(scribe, "frequency", 1.0, 2.5);
    fputs(", ", scribe->out);
    write_number(scribe, "H", 0.5, 1.5);
    fputs(", ", scribe->out);
    write_number(scribe, "lacunarity", 1.7, 2.3);
    fputs(", ", scribe->out);
    write_number(scribe, "bias", -0.3, 0.0);
    fputs(", ", scribe->out);
    write_vector(scribe, "offset", -50.0, 50.0);
    fputs(", \"rotate\": {", scribe->out);
    write_vector(scribe, "axis", 0.1, 1.0);
    fputs(", ", scribe->out);
    write_number(scribe, "angle", -180.0, 180.0);
    fputs("}, ", scribe->out);
    write_number(scribe, "scale", 2.0, 6.0);
}

// True when a transfer function stands for the medium's coefficients.
static bool write_grid(struct scribe *scribe)
{
    fprintf(scribe->out, "\"kind\": \"grid\", \"file\": \"%s\", ", scribe->volume);
    write_vector(scribe, "center", -0.2, 0.2);
    if (choice(scribe, 2)) {
        fputs(", ", scribe->out);
        write_number(scribe, "scale", 1.0, 4.0);
        return false;
    }
    fprintf(scribe->out,
            ", \"transfer_function\": [[0.1, 0.1, 0.3, 1, 0], [%.6f, 1, 0.2, 0.1, 0.3], "
            "[0.9, 1, 0.9, 0.3, 0.8]], ",
            number(scribe, 0.3, 0.7));
    write_number(scribe, "unit_distance", 0.3, 0.8);
    return true;
}

static bool write_density(struct scribe *scribe)
{
    int kind = choice(scribe, 4);
    bool has_transfer = false;

    fputs("{\"density\": {", scribe->out);
    if (kind == 0) {
        fputs("\"kind\": \"homogeneous\", ", scribe->out);
        write_number(scribe, "scale", 0.3, 2.0);
    }
    if (kind == 1) {
        fprintf(scribe->out,
                "\"kind\": \"fold_fractal\", \"iterations\": %d, \"offset\": 0.06, \"exponent\": 1.5, "
                "\"scale\": 10, ",
                1 + choice(scribe, 3));
        write_number(scribe, "radius", 0.25, 0.45);
        fputs(", ", scribe->out);
        write_number(scribe, "rotate_x_rad", -1.0, 1.0);
        fputs(", ", scribe->out);
        write_number(scribe, "rotate_y_rad", -1.0, 1.0);
    }
    if (kind == 2) write_noise(scribe);
    if (kind == 3) has_transfer = write_grid(scribe);
    // Unbounded densities need bounds.
    if (kind == 0 || kind == 2 || choice(scribe, 2)) write_bounds(scribe);
    fputs("}", scribe->out);
    return has_transfer;
}

// Absorbs little or nothing, with a lobe of any width.
static void write_white_medium(struct scribe *scribe)
{
    static const double ABSORBED[] = {0.0, 0.02, 0.2, 1.0};

    if (!write_density(scribe)) {
        fputs(", ", scribe->out);
        write_color(scribe, "sigma_s", choice(scribe, 2) ? 2.0 : 5.0);
        fputs(", ", scribe->out);
        write_color(scribe, "sigma_a", ABSORBED[choice(scribe, 4)]);
        if (choice(scribe, 4) == 0) {
            fputs(", ", scribe->out);
            write_color(scribe, "emission", 0.3);
        }
        fprintf(scribe->out, ", \"phase\": [{\"g\": %.6f, \"weight\": 1}]", number(scribe, -0.6, 0.9));
    }
    fputs("}", scribe->out);
}

static void write_medium(struct scribe *scribe)
{
    if (!write_density(scribe)) {
        fputs(", ", scribe->out);
        write_color(scribe, "sigma_s", 1.5);
        fputs(", ", scribe->out);
        write_color(scribe, "sigma_a", 0.8);
        if (choice(scribe, 3) == 0) {
            fputs(", ", scribe->out);
            write_color(scribe, "emission", 0.3);
        }
        if (choice(scribe, 2)) {
            double g = number(scribe, -0.7, 0.7), weight = number(scribe, 0.2, 0.8);

            fprintf(scribe->out,
                    ", \"phase\": [{\"g\": %.6f, \"weight\": %.6f}, {\"kind\": \"rayleigh\", \"weight\": %.6f}]", g,
                    weight, 1.0 - weight);
        }
    }
    fputs("}", scribe->out);
}

static void write_light(struct scribe *scribe)
{
    int kind = choice(scribe, 3);

    if (kind == 0) {
        fputs("{\"kind\": \"sun\", ", scribe->out);
        write_vector(scribe, "direction", -1.0, 1.0);
    } else if (kind == 1) {
        // Anywhere, also inside media.
        fputs("{\"kind\": \"point\", \"falloff\": \"none\", ", scribe->out);
        write_vector(scribe, "position", -0.8, 0.8);
    } else {
        // Outside of all media: only some methods handle 1 / r^2 beside a ray.
        fputs("{\"kind\": \"point\", ", scribe->out);
        write_vector(scribe, "position", 1.2, 2.0);
    }
    fputs(", ", scribe->out);
    write_color(scribe, "intensity", 4.0);
    fputs("}", scribe->out);
}

static void write_sized_light(struct scribe *scribe)
{
    fputs("{\"kind\": \"sphere\", ", scribe->out);
    write_vector(scribe, "position", -1.5, 1.5);
    fputs(", ", scribe->out);
    write_number(scribe, "radius", 0.05, 0.5);
    fputs(", ", scribe->out);
    write_color(scribe, "intensity", 4.0);
    fputs("}", scribe->out);
}

static void write_spot(struct scribe *scribe)
{
    double inner = number(scribe, 0.0, 30.0);

    fprintf(scribe->out, "{\"kind\": \"spot\", \"inner\": %.6f, \"outer\": %.6f, ", inner,
            inner + number(scribe, 1.0, 30.0));
    write_vector(scribe, "position", 0.9, 1.6);
    fputs(", ", scribe->out);
    write_vector(scribe, "direction", -1.0, -0.6);
    fputs(", ", scribe->out);
    write_color(scribe, "intensity", 20.0);
    fputs("}", scribe->out);
}

static void write_dome(struct scribe *scribe)
{
    fputs("{\"kind\": \"dome\", ", scribe->out);
    if (choice(scribe, 2)) {
        write_color(scribe, "radiance", 1.0);
    } else {
        fputs("\"gradient\": {", scribe->out);
        write_color(scribe, "along", 2.0);
        fputs(", ", scribe->out);
        write_color(scribe, "against", 0.5);
        fputs(", ", scribe->out);
        write_vector(scribe, "axis", 0.1, 1.0);
        fputs("}", scribe->out);
    }
    fputs("}", scribe->out);
}

// Some light always, and at the end a black one that moves.
static void write_all_lights(struct scribe *scribe)
{
    int spots = choice(scribe, 2), others = 1 + choice(scribe, 2);

    fputs("[", scribe->out);
    for (int i = 0; i < others; i++) {
        write_light(scribe);
        fputs(", ", scribe->out);
    }
    if (spots) write_spot(scribe);
    if (spots) fputs(", ", scribe->out);
    if (choice(scribe, 2)) {
        write_dome(scribe);
        fputs(", ", scribe->out);
    }
    if (scribe->has_solids && choice(scribe, 2)) {
        write_sized_light(scribe);
        fputs(", ", scribe->out);
    }
    fputs("{\"kind\": \"point\", \"intensity\": 0, \"position\": {\"start\": [0, 9, 0], \"rate\": [1, 0, 0]}}]",
          scribe->out);
}

static void write_solids(struct scribe *scribe)
{
    fputs(", \"objects\": [{\"kind\": \"plane\", ", scribe->out);
    fprintf(scribe->out, "\"point\": [0, %.6f, 0], \"material\": {\"kind\": \"diffuse\", ", number(scribe, -1.0, -0.6));
    write_color(scribe, "albedo", 1.0);
    fputs("}}, {\"kind\": \"box\", ", scribe->out);
    write_vector(scribe, "center", -0.7, 0.7);
    fputs(", ", scribe->out);
    write_vector(scribe, "size", 0.2, 0.8);
    fputs(", \"material\": {\"kind\": \"diffuse\", ", scribe->out);
    write_color(scribe, "albedo", 1.0);
    fputs("}}]", scribe->out);
}

static void write_scattering(struct scribe *scribe)
{
    static const char *const ORDERS[] = {"2", "3", "6", "\"all\"", "\"all\""};

    fprintf(scribe->out, "\"scattering\": {\"orders\": %s}, ", ORDERS[choice(scribe, 5)]);
}

static void write_list(struct scribe *scribe, int count, void write(struct scribe *))
{
    fputs("[", scribe->out);
    for (int i = 0; i < count; i++) {
        if (i > 0) fputs(", ", scribe->out);
        write(scribe);
    }
    fputs("]", scribe->out);
}

char *random_job_write(const struct random_job *params)
{
    char *text = NULL;
    size_t length;
    struct scribe scribe = {.out = open_memstream(&text, &length),
                            .random = {params->seed},
                            .volume = params->volume,
                            .scatters = params->scatters,
                            .has_solids = params->scatters && params->has_solids};
    bool is_inside;
    double x, y, z;

    // The first numbers of neighbouring seeds are similar.
    for (int i = 0; i < 20; i++)
        number(&scribe, 0.0, 1.0);
    scribe.is_colored = choice(&scribe, 2);
    is_inside = choice(&scribe, 4) == 0;
    x = number(&scribe, -0.2, 0.2);
    y = number(&scribe, -0.2, 0.2);
    z = is_inside ? number(&scribe, -0.2, 0.2) : number(&scribe, 2.0, 2.6);
    fprintf(scribe.out,
            "{\"version\": 1, \"name\": \"random\", \"frames\": \"%s\", \"fps\": 24, \"resolution\": [%d, %d],"
            " \"camera\": {\"fov\": 40, \"clip\": [0, 6], \"up\": [0.1, 1, 0], \"position\": [%.6f, %.6f, %.6f], ",
            params->scatters ? "0-99" : "0", params->width_px, params->height_px, x, y, z);
    fputs("\"target\": [0.05, 0.02, -1]}, ", scribe.out);
    if (choice(&scribe, 3) == 0) {
        write_color(&scribe, "background", 1.0);
        fputs(", ", scribe.out);
    }
    fputs("\"lights\": ", scribe.out);
    if (scribe.scatters)
        write_all_lights(&scribe);
    else
        write_list(&scribe, choice(&scribe, 4), write_light);
    fputs(", \"scene\": {", scribe.out);
    if (scribe.scatters) write_scattering(&scribe);
    fputs("\"media\": ", scribe.out);
    write_list(&scribe, 1 + choice(&scribe, scribe.scatters ? 2 : 4),
               scribe.scatters ? write_white_medium : write_medium);
    if (scribe.has_solids && choice(&scribe, 2)) write_solids(&scribe);
    fprintf(scribe.out,
            "}, \"quality\": %s, \"output\": {\"path\": \"random.####.exr\", \"aovs\": [\"Z\", \"transmittance\"]}}",
            params->quality);
    fclose(scribe.out);
    return text;
}

// 6 x 5 x 4 float voxels about 0.2 m apart, along oblique axes.
void random_job_write_volume(const char *path)
{
    enum { COUNT = 6 * 5 * 4 };
    static const char HEADER[] = "NRRD0004\ntype: float\ndimension: 3\nspace dimension: 3\nsizes: 6 5 4\n"
                                 "space directions: (0.2,0.02,0) (-0.03,0.22,0.01) (0,0.04,0.26)\n"
                                 "space origin: (0,0,0)\nendian: little\nencoding: raw\n\n";
    char bytes[sizeof HEADER - 1 + COUNT * sizeof(float)];
    struct random random = {91};

    memcpy(bytes, HEADER, sizeof HEADER - 1);
    for (int i = 0; i < COUNT; i++) {
        float value = (float)random_between(&random, -0.2, 1.0);

        memcpy(bytes + sizeof HEADER - 1 + (size_t)i * sizeof value, &value, sizeof value);
    }
    volume_maker_write(path, bytes, sizeof bytes);
}
