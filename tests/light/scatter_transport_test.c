// Light above order 1 as it is drawn, by paths and by grids, against what transport theory has in closed form.
// SPDX-License-Identifier: Apache-2.0
// The white furnace is in sized_light_test and scatter_grid_test, light that glows in paths_truth_test; the same of
// reference/ is in paths_transport_test.
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "reference/still.h"
#include "tests/support/bias_check.h"
#include "tests/support/render_frame.h"
#include "tests/support/temp_folder.h"
#include "tests/support/volume_maker.h"
#include "worker/picture/image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { PIXELS = BIAS_CHECK_WIDTH_PX * BIAS_CHECK_HEIGHT_PX };

struct view {
    const char *camera, *light; // `light`: a light and a comma, or nothing
    const char *orders, *media, *quality;
};

// A black light moves, so that no two frames share their random numbers.
static void parse(struct job *job, const struct view *view)
{
    struct error error = {{0}};
    char text[4096];

    snprintf(text, sizeof text,
             "{\"version\": 1, \"name\": \"theory\", \"frames\": \"0-99\", \"fps\": 24, \"resolution\": [%d, %d],"
             " \"camera\": {%s}, \"lights\": [%s {\"kind\": \"point\", \"intensity\": 0, \"position\":"
             " {\"start\": [0, 900, 0], \"rate\": [1, 0, 0]}}], \"scene\": {\"scattering\": {\"orders\": %s},"
             " \"media\": [%s]}, \"quality\": {%s}, \"output\": {\"path\": \"a.####.exr\", \"pixel\": \"float\","
             " \"aovs\": [\"Z\", \"transmittance\"]}}",
             BIAS_CHECK_WIDTH_PX, BIAS_CHECK_HEIGHT_PX, view->camera, view->light, view->orders, view->media,
             view->quality);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s\n%s", error.message, text);
}

// What theory says of a ray.
typedef double theory(const struct ray *ray, double parameter);

static void find_truth(const struct job *job, theory *says, double parameter, double truth[static BIAS_CHECK_VALUES])
{
    struct still still;

    still_init(&still, job, 0.0);
    for (int i = 0; i < BIAS_CHECK_VALUES; i++) {
        int column = i / 3 % BIAS_CHECK_WIDTH_PX, row = i / 3 / BIAS_CHECK_WIDTH_PX;
        struct ray ray = camera_pinhole_ray(&still.camera, column + 0.5, row + 0.5);

        truth[i] = says(&ray, parameter);
    }
}

// Paths are right on the average. `most`: the standard error of the mean light is to be no larger, or nothing is shown.
static void assert_paths(const struct view *view, theory *says, double parameter, int frames, double most)
{
    double truth[BIAS_CHECK_VALUES];
    struct bias_check_errors errors;
    struct job job;

    parse(&job, view);
    find_truth(&job, says, parameter, truth);
    errors = bias_check_measure_job(&job, truth, NULL, frames);
    job_finish(&job);
    print_message("paths, parameter %g: off by %+.1e, %+.1f standard errors, chance %.2f\n", parameter, errors.bias,
                  errors.sigmas, errors.chance);
    // The theory's sums and a still that is not endless are within 1e-3.
    assert_true(fabs(errors.sigmas) < 4.0 || fabs(errors.bias) < 1e-3);
    assert_true(fabs(errors.bias) < most && errors.chance < 2.5);
}

static double find_grid_error(const struct view *view, theory *says, double parameter)
{
    double truth[BIAS_CHECK_VALUES], square = 0.0, power = 0.0;
    struct image image;
    struct job job;

    parse(&job, view);
    find_truth(&job, says, parameter, truth);
    render_frame_zero(&job, &image);
    for (int i = 0; i < BIAS_CHECK_VALUES; i++) {
        square += pow(image.rgba[i / 3 * 4 + i % 3] - truth[i], 2);
        power += pow(truth[i], 2);
    }
    image_finish(&image);
    job_finish(&job);
    print_message("grid, parameter %g: error %.2f %%\n", parameter, 100.0 * sqrt(square / power));
    return sqrt(square / power);
}

enum { H_NODES = 200 };

// Chandrasekhar's H function for isotropic scattering (Radiative Transfer, 1950), at the middles of even pieces of
// [0, 1] and at `at`, iterated in the form whose fixed point is the physical one.
static double h_function(double albedo, double at)
{
    double h[H_NODES], next[H_NODES], value = 0.0;

    for (int i = 0; i < H_NODES; i++)
        h[i] = 1.0;
    for (int turn = 0; turn < 100; turn++) {
        for (int i = 0; i <= H_NODES; i++) {
            double mu = i < H_NODES ? (i + 0.5) / H_NODES : at, sum = 0.0;

            for (int j = 0; j < H_NODES; j++)
                sum += (j + 0.5) / H_NODES * h[j] / (mu + (j + 0.5) / H_NODES) / H_NODES;
            value = 1.0 / (sqrt(1.0 - albedo) + 0.5 * albedo * sum);
            if (i < H_NODES) next[i] = value;
        }
        for (int i = 0; i < H_NODES; i++)
            h[i] = 0.5 * (h[i] + next[i]);
    }
    return value;
}

#define SUN_COSINE 0.6
#define SUN "{\"kind\": \"sun\", \"intensity\": 1, \"direction\": [0.8, -0.6, 0]},"
#define ABOVE "\"position\": [0, 16, 12], \"target\": [0, 0, 0], \"fov\": 1"
#define HALF_SPACE(S, A, BOUNDS)                                                                                       \
    "{\"sigma_s\": " S ", \"sigma_a\": " A ", \"density\": {\"kind\": \"homogeneous\", \"bounds\": {" BOUNDS "}}}"
#define SLAB "\"kind\": \"slab\", \"center\": [0, -50, 0], \"normal\": [0, 1, 0], \"thickness\": 100"
#define BOX "\"kind\": \"box\", \"center\": [0, -4, 0], \"size\": [12, 8, 12]"

// The radiance that a half space of that albedo reflects; the sun's irradiance is 1.
static double half_space_says(const struct ray *ray, double albedo)
{
    static double known, of_sun;
    double eye = -ray->direction.y;

    if (known != albedo) of_sun = h_function(albedo, SUN_COSINE);
    known = albedo;
    return albedo / (4.0 * M_PI) * SUN_COSINE / (SUN_COSINE + eye) * of_sun * h_function(albedo, eye);
}

static void a_half_space_reflects_as_chandrasekhar_says(void **state)
{
    struct view view = {
        .camera = ABOVE, .light = SUN, .orders = "\"all\"", .quality = "\"method\": \"paths\", \"paths\": 256"};

    (void)state;
    view.media = HALF_SPACE("0.5", "0.5", SLAB);
    assert_paths(&view, half_space_says, 0.5, 10, 0.01);
    view.media = HALF_SPACE("0.95", "0.05", SLAB);
    assert_paths(&view, half_space_says, 0.95, 10, 0.01);
    // A box that is wide and deep enough that its sides and its bottom do not show.
    view.quality = "\"method\": \"cached\", \"step\": 0.1, \"light_grid\": 32, \"scatter_grid\": 32, \"paths\": 64";
    view.media = HALF_SPACE("0.6", "0.4", BOX);
    assert_true(find_grid_error(&view, half_space_says, 0.6) < 0.03);
}

// Case, de Hoffmann and Placzek, Introduction to the Theory of Neutron Diffusion, 1953: the transform of a point
// source's fluence is that of its unscattered part, atan(k) / k, over 1 less albedo times that. Here of scattered light
// and a source of 4 pi; half waves alternate in sign, and their sums' repeated means converge quickly.
static double scattered_fluence(double distance, double albedo)
{
    enum { WAVES = 40, PIECES = 200 };
    double sums[WAVES], sum = 0.0, width = M_PI / distance;

    for (int i = 0; i < WAVES; i++) {
        for (int j = 0; j < PIECES; j++) {
            double k = width * (i + (j + 0.5) / PIECES), flown = atan(k);

            sum += sin(k * distance) * flown * flown / (k - albedo * flown) * width / PIECES;
        }
        sums[i] = sum;
    }
    for (int length = WAVES; length > WAVES / 2; length--)
        for (int i = 0; i + 1 < length; i++)
            sums[i] = 0.5 * (sums[i] + sums[i + 1]);
    return 4.0 * M_PI * albedo * sums[WAVES / 2 - 1] / (2.0 * M_PI * M_PI * distance);
}

// The same from a table, in even steps of the distance's root.
static double tabled_fluence(double distance, double albedo)
{
    enum { COUNT = 300 };
    static double table[COUNT + 1], known;
    double at = sqrt(fmin(distance, 24.9) / 25.0) * COUNT;
    int i = (int)at;

    for (int k = 1; k <= COUNT && known != albedo; k++)
        table[k] = scattered_fluence(25.0 * k * k / ((double)COUNT * COUNT), albedo);
    known = albedo;
    if (i < 1) i = 1;
    return exp(log(table[i]) + (at - i) * (log(table[i + 1]) - log(table[i])));
}

// Isotropic scattering sends fluence / 4 pi on, wherever it came from. The lamp is at the origin, of intensity 1.
static double lamp_says(const struct ray *ray, double albedo)
{
    const double step = 2e-3;
    double sum = 0.0;

    for (double at = 0.5 * step; at < 14.0; at += step) {
        struct vec3 place = vec3_add(ray->origin, vec3_scale(ray->direction, at));
        double distance = vec3_length(place);
        double fluence = exp(-distance) / (distance * distance) + tabled_fluence(distance, albedo);

        sum += exp(-at) * albedo * fluence / (4.0 * M_PI) * step;
    }
    return sum;
}

// By paths alone: a grid's walks have no vertices of their own beside a lamp, and a variance without bound there.
static void a_lamp_in_an_endless_medium_shines_as_theory_says(void **state)
{
    const struct view view = {
        .camera = "\"position\": [0, 0.6, 2.5], \"target\": [0, 0.6, 0], \"fov\": 20",
        .light = "{\"kind\": \"point\", \"intensity\": 1, \"position\": [0, 0, 0]},",
        .orders = "\"all\"",
        .media = HALF_SPACE("0.7", "0.3", "\"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 14"),
        .quality = "\"method\": \"paths\", \"paths\": 256"};

    (void)state;
    assert_paths(&view, lamp_says, 0.7, 10, 0.01);
}

// All glows by 1 + x / 20, in a medium that only scatters: scattered n - 1 times it brings what it is at the place of
// collision n, in the mean (1 - g^n) / (1 - g) ahead, in free paths. Orders 1 to 4 add up.
static double ahead_says(const struct ray *ray, double g)
{
    double sum = 0.0, ahead = 0.0, share = 1.0;

    for (int n = 1; n <= 4; n++) {
        ahead += share;
        share *= g;
        sum += 1.0 + ray->direction.x * ahead / 20.0;
    }
    return sum;
}

static void write_ramp(const char *path)
{
    // Two voxels, 40 m apart, 0 and 2: linear from x = -20 to x = 20. The wide sides are even.
    static const char HEADER[] = "NRRD0004\ntype: float\ndimension: 3\nspace dimension: 3\nsizes: 2 2 2\n"
                                 "space directions: (40,0,0) (0,80,0) (0,0,80)\nspace origin: (-20,-40,-40)\n"
                                 "endian: little\nencoding: raw\n\n";
    static const float values[8] = {0, 2, 0, 2, 0, 2, 0, 2};
    char bytes[sizeof HEADER - 1 + sizeof values];

    memcpy(bytes, HEADER, sizeof HEADER - 1);
    memcpy(bytes + sizeof HEADER - 1, values, sizeof values);
    volume_maker_write(path, bytes, sizeof bytes);
}

static void assert_places(const char *path, double g)
{
    struct view view = {.camera = "\"position\": [0, 0, 0], \"target\": [1, 0, 0], \"fov\": 20",
                        .light = "",
                        .orders = "4",
                        .quality = "\"method\": \"paths\", \"paths\": 256"};
    char media[1024];

    snprintf(media, sizeof media,
             "{\"sigma_s\": 1, \"sigma_a\": 0, \"phase\": [{\"g\": %g, \"weight\": 1}], \"density\": {\"kind\":"
             " \"homogeneous\", \"bounds\": {\"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 18}}},"
             " {\"sigma_s\": 0, \"sigma_a\": 0, \"emission\": 1, \"density\": {\"kind\": \"grid\", \"file\": \"%s\"}}",
             g, path);
    view.media = media;
    assert_paths(&view, ahead_says, g, 10, 0.01);
    view.quality = "\"method\": \"cached\", \"step\": 0.1, \"light_grid\": 16, \"scatter_grid\": 16, \"paths\": 128";
    assert_true(find_grid_error(&view, ahead_says, g) < 0.03);
}

// The furnace does not see wrong free paths and wrong phases; places do.
static void collisions_lie_where_theory_says(void **state)
{
    const char *path = temp_folder_path(state, "ramp.nrrd");

    write_ramp(path);
    assert_places(path, 0.7);
    assert_places(path, -0.5);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_half_space_reflects_as_chandrasekhar_says),
        cmocka_unit_test(a_lamp_in_an_endless_medium_shines_as_theory_says),
        cmocka_unit_test_setup_teardown(collisions_lie_where_theory_says, temp_folder_create, temp_folder_destroy),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
