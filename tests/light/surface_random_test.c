// Random scenes of objects against the converged light of reference/.
// SPDX-License-Identifier: Apache-2.0
// The objects have every shape and smooth material; they are nested and overlap, with media in and around them.
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "reference/reference.h"
#include "tests/support/random.h"
#include "tests/support/studio.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

enum { WIDTH_PX = 12, HEIGHT_PX = 9, PIXELS = WIDTH_PX * HEIGHT_PX };

static int first_seed = 1, last_seed = 10; // or those of the command line

// A pixel differs where a float and a double see a ray on different sides of an edge or of a shadow. The limit is that
// of a picture.
enum { STRAY_LIMIT = 2 };

// Errors relative to the brightest: of all other pixels together, and of any single one. The largest are those of rays
// that graze balls, whose directions depend most on a rounding of the position.
static const double picture_tolerance = 2e-4, pixel_tolerance = 2e-3;

struct scribe {
    FILE *out;
    struct random random;
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

static void write_phase(struct scribe *scribe)
{
    double g = number(scribe, -0.6, 0.6), weight = number(scribe, 0.2, 0.8);

    if (choice(scribe, 2) == 0) return;
    fprintf(scribe->out, ", \"phase\": [{\"g\": %.6f, \"weight\": %.6f}, {\"kind\": \"rayleigh\", \"weight\": %.6f}]",
            g, weight, 1.0 - weight);
}

// Writes the members of a medium beside its density.
static void write_stuff(struct scribe *scribe, double most)
{
    write_vector(scribe, "sigma_s", 0.0, most);
    fputs(", ", scribe->out);
    write_vector(scribe, "sigma_a", 0.0, most);
    if (choice(scribe, 3) == 0) {
        fputs(", ", scribe->out);
        write_vector(scribe, "emission", 0.0, 0.3);
    }
    write_phase(scribe);
}

static void write_fresnel(struct scribe *scribe)
{
    int kind = choice(scribe, 4);

    if (kind == 0) fputs(", \"fresnel\": \"none\"", scribe->out);
    if (kind == 1) fputs(", \"fresnel\": \"schlick\"", scribe->out);
    if (kind == 2)
        fprintf(scribe->out, ", \"fresnel\": \"schlick\", \"f0\": %.6f, \"f90\": 0.9", number(scribe, 0.05, 0.3));
}

static void write_material(struct scribe *scribe)
{
    int kind = choice(scribe, 6);

    fputs("\"material\": {", scribe->out);
    if (kind == 0) {
        fputs("\"kind\": \"mirror\", ", scribe->out);
        write_vector(scribe, "reflectance", 0.4, 1.0);
    } else if (kind < 3) {
        fputs("\"kind\": \"diffuse\", ", scribe->out);
        write_vector(scribe, "albedo", 0.1, 1.0);
        if (kind == 1) {
            fputs(", ", scribe->out);
            write_number(scribe, "specular", 0.1, 1.0);
            write_fresnel(scribe);
        }
    } else {
        fputs("\"kind\": \"dielectric\", ", scribe->out);
        write_number(scribe, "ior", 0.7, 2.0);
        write_fresnel(scribe);
        if (kind > 3) {
            fputs(", \"interior\": {", scribe->out);
            write_stuff(scribe, 1.0);
            fputs("}", scribe->out);
        }
    }
    fputs("}", scribe->out);
}

static void write_shape(struct scribe *scribe)
{
    if (choice(scribe, 2)) {
        fputs("\"kind\": \"sphere\", ", scribe->out);
        write_number(scribe, "radius", 0.25, 0.8);
    } else {
        fputs("\"kind\": \"box\", ", scribe->out);
        write_vector(scribe, "size", 0.4, 1.3);
    }
    fputs(", ", scribe->out);
    write_vector(scribe, "center", -0.6, 0.6);
}

static void write_object(struct scribe *scribe)
{
    int kind = choice(scribe, 5);

    fputs("{", scribe->out);
    if (kind == 0) {
        // The plane is a floor or a wall at some distance from the camera and the middle.
        double x = number(scribe, -0.3, 0.3), z = number(scribe, -0.1, 0.3);

        fprintf(scribe->out, "\"kind\": \"plane\", \"normal\": [%.6f, 1, %.6f], \"point\": [0, -0.9, 0]", x, z);
    } else if (kind == 1) {
        fputs("\"kind\": \"union\", \"of\": [", scribe->out);
        for (int i = 0; i < 3; ++i) {
            fputs(i > 0 ? ", {" : "{", scribe->out);
            write_shape(scribe);
            fputs("}", scribe->out);
        }
        fputs("]", scribe->out);
    } else {
        write_shape(scribe);
    }
    fputs(", ", scribe->out);
    write_material(scribe);
    fputs("}", scribe->out);
}

static void write_medium(struct scribe *scribe)
{
    fputs("{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {", scribe->out);
    if (choice(scribe, 2)) {
        fputs("\"kind\": \"sphere\", ", scribe->out);
        write_number(scribe, "radius", 0.5, 2.0);
    } else {
        fputs("\"kind\": \"box\", ", scribe->out);
        write_vector(scribe, "size", 1.0, 4.0);
    }
    fputs(", ", scribe->out);
    write_vector(scribe, "center", -0.5, 0.5);
    fputs("}}, ", scribe->out);
    write_stuff(scribe, 0.4);
    fputs("}", scribe->out);
}

static void write_light(struct scribe *scribe)
{
    double x = number(scribe, -1.0, 1.0), y = number(scribe, 1.2, 2.0), z = number(scribe, -1.0, 1.0);

    if (choice(scribe, 3) == 0) {
        fprintf(scribe->out, "{\"kind\": \"sun\", \"direction\": [%.6f, %.6f, %.6f], ", x, -y, z);
        write_vector(scribe, "intensity", 0.2, 1.0);
    } else {
        fprintf(scribe->out, "{\"kind\": \"point\", \"position\": [%.6f, %.6f, %.6f], ", x, y, z);
        write_vector(scribe, "intensity", 1.0, 5.0);
    }
    fputs("}", scribe->out);
}

// Writes a list's elements; the text is owned by the caller.
static char *write_list(struct random *random, int count, void write(struct scribe *))
{
    char *text = NULL;
    size_t length;
    struct scribe scribe = {open_memstream(&text, &length), *random};

    for (int i = 0; i < count; ++i) {
        if (i > 0) fputs(", ", scribe.out);
        write(&scribe);
    }
    fclose(scribe.out);
    *random = scribe.random;
    return text;
}

struct comparison {
    int stray_count;
    double picture_error, largest; // of the other pixels; relative to the picture's root mean square
    double cut_seen, cut_true;     // throughput
};

static int compare_doubles(const void *a, const void *b)
{
    double left = *(const double *)a, right = *(const double *)b;

    return (left > right) - (left < right);
}

// Strays are the largest errors over the tolerance; there may be more of them than are allowed.
static void sum_up(struct comparison *comparison, double errors[static PIXELS], double square)
{
    double scale = sqrt(square / PIXELS), sum = 0.0;

    qsort(errors, PIXELS, sizeof *errors, compare_doubles);
    for (int i = 0; i < PIXELS; ++i) {
        double error = errors[i] / scale;

        if (!(error <= pixel_tolerance)) {
            comparison->stray_count++;
            continue;
        }
        comparison->largest = error;
        sum += error * error;
    }
    comparison->picture_error = sqrt(sum / PIXELS);
}

static struct comparison compare(const struct job *job)
{
    struct still *still = calloc(1, sizeof *still);
    struct comparison comparison = {0};
    double errors[PIXELS], square = 0.0;
    struct studio_picture picture;

    assert_non_null(still);
    studio_render(job, 0, &picture);
    still_init(still, job, job_frame_time(job, 0));
    for (int i = 0; i < PIXELS; ++i) {
        struct reference_pixel pixel = reference_measure_pixel(still, i % WIDTH_PX, i / WIDTH_PX, NULL);
        const float *rgba = &picture.image.rgba[4 * i], *through = &picture.image.transmittance[4 * i];

        errors[i] = fabs(rgba[3] - pixel.alpha);
        for (size_t c = 0; c < 3; ++c) {
            errors[i] = fmax(errors[i], fabs(rgba[c] - pixel.radiance[c]));
            errors[i] = fmax(errors[i], fabs(through[c] - pixel.transmittance[c]));
            square += (pixel.radiance[c] * pixel.radiance[c] + pixel.transmittance[c] * pixel.transmittance[c]) / 3.0;
        }
        square += pixel.alpha * pixel.alpha;
        comparison.cut_true += pixel.cut_throughput / PIXELS;
    }
    comparison.cut_seen = picture.result.ray_counts.cut_throughput;
    sum_up(&comparison, errors, square);
    studio_finish(&picture);
    free(still);
    return comparison;
}

static bool is_right(const struct comparison *comparison)
{
    // A stray pixel may also have cut whole rays.
    double cut_tolerance = 2e-4 + 0.5 * comparison->stray_count / PIXELS;

    return comparison->stray_count <= STRAY_LIMIT && comparison->picture_error <= picture_tolerance &&
           fabs(comparison->cut_seen - comparison->cut_true) <= cut_tolerance;
}

static bool check_seed(uint64_t seed)
{
    struct random random = {seed * 7919};
    struct comparison comparison;
    struct studio_scene scene = {.width_px = WIDTH_PX,
                                 .height_px = HEIGHT_PX,
                                 .quality =
                                     "\"method\": \"equiangular\", \"points\": 60, \"max_depth\": 5, \"max_cut\": 1, "
                                     "\"min_throughput\": 0.0001"};
    char *lists[3];
    struct job job = {0};

    // The first random numbers of neighbouring seeds are alike.
    for (int i = 0; i < 20; ++i)
        random_between(&random, 0, 1);
    lists[0] = write_list(&random, 1 + (int)(seed % 6), write_object);
    lists[1] = write_list(&random, (int)(seed % 3), write_medium);
    lists[2] = write_list(&random, 1 + (int)(seed % 2), write_light);
    scene.objects = lists[0];
    scene.media = lists[1];
    scene.lights = lists[2];
    scene.background = seed % 2 ? "[0.4, 0.5, 0.6]" : NULL;
    // Every fourth camera starts among the objects.
    scene.camera = (struct studio_camera){
        .position = {0.13, 0.21, seed % 4 == 3 ? 0.35 : 2.6}, .target = {0.05, 0.02, -1}, .fov = 50};
    studio_parse(&job, &scene);
    comparison = compare(&job);
    if (!is_right(&comparison)) print_message("%s\n%s\n%s\n", lists[0], lists[1], lists[2]);
    print_message("seed %2d: %d stray pixels, relative RMSE %.1e, largest %.1e, cut %.6f, truly %.6f\n", (int)seed,
                  comparison.stray_count, comparison.picture_error, comparison.largest, comparison.cut_seen,
                  comparison.cut_true);
    job_finish(&job);
    for (size_t i = 0; i < 3; ++i)
        free(lists[i]);
    return is_right(&comparison);
}

static void random_objects_are_the_converged_light(void **state)
{
    int wrong = 0;

    (void)state;
    for (int seed = first_seed; seed <= last_seed; ++seed)
        if (!check_seed((uint64_t)seed)) ++wrong;
    assert_int_equal(wrong, 0);
}

#define INK(ior, sigma) "\"kind\": \"dielectric\", \"ior\": " ior ", \"interior\": {\"sigma_a\": [" sigma "]}"
#define SPHERE(center, radius) "\"kind\": \"sphere\", \"center\": [" center "], \"radius\": " radius
#define BOX(center, size) "\"kind\": \"box\", \"center\": [" center "], \"size\": [" size "]"
#define OBJECT(shape, material) "{" shape ", \"material\": {" material "}}, "
// A ball and boxes stand on a floor and lean on one another. Boxes and balls share whole faces, in a union and outside
// of it.
#define HEAP                                                                                                           \
    OBJECT("\"kind\": \"plane\", \"point\": [0, -1, 0]", "\"kind\": \"diffuse\", \"albedo\": 0.8, \"specular\": 0.5")  \
    OBJECT(SPHERE("0, 0, 0", "1"), INK("1.5", "0.5, 1, 0.1"))                                                          \
    OBJECT(BOX("1.5, -0.5, 0", "1, 1, 1"), INK("1.4", "1, 0.2, 0.3"))                                                  \
    OBJECT(BOX("1.5, 0.5, 0", "1, 1, 1"), INK("1.4", "0.1, 2, 0.3"))                                                   \
    OBJECT("\"kind\": \"union\", \"of\": [{" SPHERE("-1.5, -0.5, 1", "0.5") "}, {" BOX(                                \
               "-1.5, -0.5, 0", "1, 1, 1") "}, {" BOX("-1.5, -0.5, -1", "1, 1, 1") "}, {" SPHERE("-1.5, 0.5, -0.5",    \
                                                                                                 "0.5") "}]",          \
           INK("1.3", "0.3, 0.1, 1"))                                                                                  \
    OBJECT(SPHERE("-1.5, -0.5, 1", "0.5"), INK("1.7", "0.2, 0.1, 0"))                                                  \
    OBJECT(BOX("0, -0.5, -1.5", "2, 1, 1"), "\"kind\": \"diffuse\", \"albedo\": 1")                                    \
    OBJECT(SPHERE("0, 0, 0", "0.5"), "\"kind\": \"dielectric\", \"ior\": 1")                                           \
    "{" SPHERE("0.25, 0, 0", "0.25") ", \"material\": {\"kind\": \"mirror\"}}"

enum { VIEWS = 120, VIEW_PX = 3 };

// Writes a key at a random point above the floor.
static void write_key(FILE *out, int frame, struct random *random, double extent)
{
    double x = random_between(random, -extent, extent), y = random_between(random, -0.95, extent);
    double z = random_between(random, -extent, extent);

    fprintf(out, "%s[%.9g, [%.9g, %.9g, %.9g]]", frame > 0 ? ", " : "", (frame - 0.5) / 24, x, y, z);
}

// Keys of one camera a frame, at any point above the floor, in objects too. Owned by the caller.
static char *write_views(struct random *random)
{
    char *text = NULL, *targets = NULL;
    size_t length, targets_length;
    FILE *out = open_memstream(&text, &length), *aims = open_memstream(&targets, &targets_length);

    fputs("\"position\": {\"interpolation\": \"hold\", \"keys\": [", out);
    for (int i = 0; i < VIEWS; ++i) {
        write_key(out, i, random, 2.5);
        write_key(aims, i, random, 1.5);
    }
    fclose(aims);
    fprintf(out, "]}, \"target\": {\"interpolation\": \"hold\", \"keys\": [%s]}", targets);
    fclose(out);
    free(targets);
    return text;
}

// Counts the pixels of a view that are off by more than rounding.
static int count_strays(const struct job *job, int32_t frame, struct still *still)
{
    struct studio_picture picture;
    int count = 0;

    studio_render(job, frame, &picture);
    still_init(still, job, job_frame_time(job, frame));
    for (int i = 0; i < VIEW_PX * VIEW_PX; ++i) {
        struct reference_pixel pixel = reference_measure_pixel(still, i % VIEW_PX, i / VIEW_PX, NULL);
        double largest = 0.0;

        for (size_t c = 0; c < 3; ++c) {
            largest = fmax(largest, fabs(picture.image.rgba[4 * i + (int)c] - pixel.radiance[c]));
            largest = fmax(largest, fabs(picture.image.transmittance[4 * i + (int)c] - pixel.transmittance[c]));
        }
        if (!(largest <= 5e-5)) ++count;
    }
    studio_finish(&picture);
    return count;
}

static void touching_objects_are_seen_from_everywhere(void **state)
{
    struct random random = {77777};
    char *views = write_views(&random);
    const struct studio_scene scene = {
        .width_px = VIEW_PX,
        .height_px = VIEW_PX,
        .camera = {.fov = 60},
        .moving_camera = views,
        .objects = HEAP,
        .lights = "{\"kind\": \"point\", \"position\": [0.3, 3, 2], \"intensity\": [10, 8, 6]}",
        .background = "[0.3, 0.6, 0.9]",
        .quality =
            "\"method\": \"equiangular\", \"points\": 3, \"max_depth\": 6, \"max_cut\": 1, \"min_throughput\": 0.0001",
        .frames = "0-119"};
    struct still *still = calloc(1, sizeof *still);
    struct job job = {0};
    int count = 0;

    (void)state;
    studio_parse(&job, &scene);
    for (int32_t frame = 0; frame < VIEWS; ++frame)
        count += count_strays(&job, frame, still);
    // The count is out of 1080 pixels. Over 200,000 pixels two differed, both by less than 3e-4.
    assert_in_range(count, 0, 1);
    job_finish(&job);
    free(still);
    free(views);
}

int main(int argument_count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_objects_are_the_converged_light),
        cmocka_unit_test(touching_objects_are_seen_from_everywhere),
    };

    if (argument_count > 2) {
        first_seed = atoi(arguments[1]);
        last_seed = atoi(arguments[2]);
    }
    return cmocka_run_group_tests(tests, NULL, studio_close);
}
