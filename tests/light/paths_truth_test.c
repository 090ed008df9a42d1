// Random paths: their mean is the light of reference/, and in media that glow as they absorb a closed form.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/bias_check.h"
#include "tests/support/temp_folder.h"
#include "tests/support/volume_maker.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define BALL "\"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 0.9"
#define COLOURED "\"sigma_s\": [2, 1, 3], \"sigma_a\": [0.2, 1, 0.5]"
#define EVEN "{ " COLOURED ", \"density\": { \"kind\": \"homogeneous\", " BALL " } } }"
#define SHARP                                                                                                          \
    "{ \"sigma_s\": [400, 12, 0.5], \"sigma_a\": [600, 18, 0.5], \"density\": { \"kind\": \"homogeneous\", " BALL      \
    " } } }"
#define RAYLEIGH                                                                                                       \
    "{ " COLOURED ", \"phase\": [ { \"kind\": \"rayleigh\", \"weight\": 0.7 }, { \"g\": -0.6, \"weight\": 0.3 } ],"    \
    " \"density\": { \"kind\": \"homogeneous\", " BALL ", \"falloff\": 0.8 } } }"
#define NOISE                                                                                                          \
    "{ " COLOURED ", \"emission\": [0.1, 0.2, 0.3], \"phase\": [ { \"g\": 0.4, \"weight\": 1 } ], \"density\": {"      \
    " \"kind\": \"noise\", \"frequency\": 2.5, \"octaves\": 2, \"H\": 0.6, \"lacunarity\": 2, \"bias\": 0.2,"          \
    " \"mode\": \"clip\", \"scale\": 4, " BALL ", \"falloff\": 0.3 } } }"
#define FRACTAL                                                                                                        \
    "{ \"density\": { \"kind\": \"fold_fractal\", \"iterations\": 3, \"offset\": 0.05, \"radius\": 0.4,"               \
    " \"rotate_x_rad\": 0.3, \"rotate_y_rad\": 0.7, \"exponent\": 1.3, \"scale\": 12 }, " COLOURED " }"
#define GLOW                                                                                                           \
    "{ \"sigma_s\": 0, \"sigma_a\": 0, \"emission\": [1, 0.4, 0.1], \"density\": { \"kind\": \"homogeneous\","         \
    " \"bounds\": { \"kind\": \"box\", \"center\": [0.4, 0.2, 0], \"size\": [0.7, 0.6, 0.5], \"falloff\": 0.2 } } }"
#define SUN "{ \"kind\": \"sun\", \"intensity\": [3, 2, 1], \"direction\": [-1, -2, 0.5] },"
#define LAMP "{ \"kind\": \"point\", \"intensity\": [1, 3, 2], \"position\": [1.2, 1, 0.9] },"
#define PATHS(COUNT) "\"method\": \"paths\", \"paths\": " COUNT

static void assert_fair(const struct bias_check_scene *scene, const double *truth, int frames)
{
    struct bias_check_errors errors = bias_check_measure(scene, truth, frames);

    assert_true(fabs(errors.sigmas) < 3.5);
    // Few bright values hold most of the variance, next to lamps most of all, and colours share collisions.
    assert_true(errors.chance > 0.1 && errors.chance < 3);
    assert_true(errors.spread > 1e-3);
}

// Both have noise: frames of 16 paths trace 1536 of each pixel, where the truth has 2048. More of one would not make
// their difference, whose variance is the sum of both, much more exact.
static void assert_as_paths(struct bias_check_scene *scene)
{
    static double truth[BIAS_CHECK_VALUES], noise[BIAS_CHECK_VALUES];

    scene->noise = noise;
    bias_check_find_paths(scene, 2048, truth, noise);
    assert_fair(scene, truth, 96);
}

// Of one scattering reference/ knows the light without noise.
static void assert_first_order(const char *media, const char *lights)
{
    static double truth[BIAS_CHECK_VALUES];
    const struct bias_check_scene scene = {.media = media, .lights = lights, .quality = PATHS("8")};

    bias_check_find_truth(&scene, truth);
    assert_fair(&scene, truth, 256);
}

// With light grids of enough cells; fewer show a bias. Surfaces lie beside their beams, and behind lamps.
static void assert_by_light_grids(const char *media, const char *lights, const char *objects)
{
    struct bias_check_scene scene = {.media = media,
                                     .lights = lights,
                                     .objects = objects,
                                     .quality = PATHS("16") ", \"light_grid\": 64",
                                     .orders = "\"all\""};

    assert_as_paths(&scene);
}

static void assert_orders(const char *media, const char *lights, const char *orders)
{
    struct bias_check_scene scene = {.media = media, .lights = lights, .quality = PATHS("16"), .orders = orders};

    assert_as_paths(&scene);
}

static void even_media_are_right_on_the_average(void **state)
{
    (void)state;
    assert_first_order(EVEN, SUN);
    assert_first_order(EVEN, SUN LAMP);
}

static void coefficients_far_apart_are_right_on_the_average(void **state)
{
    (void)state;
    assert_first_order(SHARP, SUN);
}

static void several_lobes_are_right_on_the_average(void **state)
{
    (void)state;
    assert_first_order(RAYLEIGH, LAMP);
}

static void noise_is_right_on_the_average(void **state)
{
    (void)state;
    assert_first_order(NOISE, SUN);
}

static void several_media_are_right_on_the_average(void **state)
{
    (void)state;
    assert_first_order(EVEN ", " FRACTAL ", " GLOW, SUN LAMP);
}

static void all_orders_are_those_of_the_reference(void **state)
{
    (void)state;
    assert_orders(EVEN, SUN, "2");
    assert_orders(EVEN, SUN LAMP, "\"all\"");
    assert_orders(SHARP, SUN, "\"all\"");
    assert_orders(RAYLEIGH, LAMP, "\"all\"");
    assert_orders(NOISE, SUN, "\"all\"");
    assert_orders(EVEN ", " FRACTAL ", " GLOW, SUN LAMP, "3");
}

#define INSIDE "{ \"kind\": \"point\", \"intensity\": [1, 3, 2], \"position\": [0.3, 0.25, 0.4] },"
#define SPOT                                                                                                           \
    "{ \"kind\": \"spot\", \"intensity\": 3, \"position\": [-0.4, 0.1, 0.2], \"direction\": [1, -0.3, 0.1],"           \
    " \"inner\": 20, \"outer\": 50 },"

#define BEAM                                                                                                           \
    "{ \"kind\": \"spot\", \"intensity\": 9, \"position\": [-0.5, 0.1, 0.2], \"direction\": [1, -0.1, 0.1],"           \
    " \"inner\": 8, \"outer\": 12 },"

static void lamps_inside_are_right_on_the_average(void **state)
{
    (void)state;
    assert_first_order(EVEN, INSIDE);
    assert_orders(EVEN, INSIDE, "\"all\"");
    assert_first_order(EVEN, SPOT);
    assert_first_order(EVEN, BEAM);
    assert_orders(NOISE, SPOT, "\"all\"");
    assert_orders(EVEN, BEAM, "\"all\"");
    assert_orders(NOISE, INSIDE, "\"all\"");
    assert_orders(EVEN ", " FRACTAL, INSIDE SUN, "4");
}

#define FLOOR                                                                                                          \
    "{ \"kind\": \"plane\", \"point\": [0, -0.6, 0], \"material\": { \"kind\": \"diffuse\","                           \
    " \"albedo\": [0.9, 0.5, 0.2] } }"
#define LOBED                                                                                                          \
    "{ " COLOURED ", \"phase\": [ { \"g\": 0.8, \"weight\": 0.75 }, { \"g\": -0.5, \"weight\": 0.25 } ],"              \
    " \"density\": { \"kind\": \"homogeneous\", " BALL ", \"falloff\": 0.8 } } }"
#define BACKWARD                                                                                                       \
    "{ " COLOURED ", \"phase\": [ { \"g\": -0.7 } ], \"density\": { \"kind\": \"noise\", \"frequency\": 2.5,"          \
    " \"octaves\": 2, \"bias\": 0.2, \"mode\": \"clip\", \"scale\": 4, " BALL ", \"falloff\": 0.3 } } }"

// What is drawn near lamps follows narrow lobes, also from a surface.
static void lobes_near_lamps_are_right_on_the_average(void **state)
{
    struct bias_check_scene scene = {
        .media = LOBED, .lights = INSIDE, .objects = FLOOR, .orders = "3", .quality = PATHS("16")};

    (void)state;
    assert_first_order(LOBED, INSIDE);
    assert_orders(LOBED, INSIDE, "\"all\"");
    assert_first_order(BACKWARD, INSIDE);
    assert_orders(BACKWARD, INSIDE, "3");
    assert_orders(LOBED ", " NOISE, INSIDE SPOT, "2");
    assert_as_paths(&scene);
}

#define LOBES(G) "\"phase\": [ { \"g\": " G ", \"weight\": 0.75 }, { \"g\": -0.5, \"weight\": 0.25 } ],"
#define THIN(G)                                                                                                        \
    "{ \"sigma_s\": [1.5, 0.5, 2], \"sigma_a\": [0.1, 0.4, 0.2], " LOBES(                                              \
        G) " \"density\": { \"kind\": \"homogeneous\", " BALL " } } }"
#define LUMPS(G)                                                                                                       \
    "{ " COLOURED ", " LOBES(G) " \"density\": { \"kind\": \"noise\", \"frequency\": 2.5, \"octaves\": 2,"             \
                                " \"mode\": \"remap\", \"scale\": 2, " BALL ", \"falloff\": 0.3 } } }"
#define DEEP(G)                                                                                                        \
    "{ \"sigma_s\": [9, 6, 12], \"sigma_a\": [0.2, 0.5, 0.1], " LOBES(                                                 \
        G) " \"density\": { \"kind\": \"homogeneous\", " BALL " } } }"
#define SKY "{ \"kind\": \"dome\", \"radiance\": [0.2, 0.3, 0.5] },"

// Thin media, and those with light grids: some directions are drawn about a lamp. Floors spare it second paths.
static void paths_towards_lamps_are_right_on_the_average(void **state)
{
    struct bias_check_scene scene = {
        .media = THIN("0.8"), .lights = SPOT SUN, .objects = FLOOR, .orders = "\"all\"", .quality = PATHS("16")};

    (void)state;
    assert_orders(THIN("0.7"), LAMP, "\"all\"");
    assert_as_paths(&scene);
    assert_by_light_grids(LUMPS("0.7"), LAMP SUN, NULL);
}

// Narrower lobes: vertices send second paths.
static void second_paths_are_right_on_the_average(void **state)
{
    (void)state;
    assert_orders(THIN("0.9"), LAMP, "\"all\"");
    assert_orders(DEEP("0.9"), LAMP SUN SKY, "\"all\"");
    assert_orders(THIN("0.9"), SUN, "3");
    assert_orders(DEEP("-0.95"), SUN, "\"all\"");
    assert_by_light_grids(LUMPS("0.9"), LAMP SUN, NULL);
}

// A lamp inside has a finite variance: the noise falls with the root of the number of paths, however many. Else its
// estimate would grow with their number, as rare paths pass by the lamp.
static double assert_even_noise(const char *media, const char *lamp, size_t steps)
{
    static const char *const qualities[] = {PATHS("64"), PATHS("4096"), PATHS("16384"), PATHS("65536")};
    static const int counts[] = {64, 4096, 16384, 65536}, frames[] = {128, 16, 8, 6};
    static double truth[BIAS_CHECK_VALUES], noise[BIAS_CHECK_VALUES];
    // What lies behind is weighed by transmittance, which more paths do not make more exact.
    struct bias_check_scene scene = {
        .media = media, .lights = lamp, .orders = "\"all\"", .noise = noise, .background = ""};
    double first = 0;

    scene.quality = qualities[0];
    bias_check_find_paths(&scene, 256, truth, noise);
    for (size_t i = 0; i < steps; ++i) {
        double even;

        scene.quality = qualities[i];
        even =
            bias_check_measure(&scene, truth, frames[i]).spread * sqrt(counts[i]) * sqrt(frames[i] / (frames[i] - 1.0));
        print_message("noise of a path: %.2f\n", even);
        if (i == 0) first = even;
        // 324 values of six frames know their mean variance within some 5 %.
        assert_true(even > 0.8 * first && even < 1.25 * first);
    }
    return first;
}

static void noise_falls_evenly_beside_a_lamp(void **state)
{
    (void)state;
    assert_even_noise(EVEN, INSIDE, 2);
    assert_even_noise(EVEN, SPOT, 2);
    assert_true(assert_even_noise(LOBED, INSIDE, 2) < 14.0);    // as if lobes were wide, it would be 17 to 20
    assert_true(assert_even_noise(THIN("0.7"), LAMP, 2) < 4.7); // without directions about the lamp it would be 5.1
    assert_true(assert_even_noise(DEEP("0.9"), LAMP, 2) < 6.0); // without second paths it would be 14
}

static void noise_falls_evenly_to_65536_paths(void **state)
{
    (void)state;
    assert_even_noise(EVEN, INSIDE, 4);
    assert_even_noise(EVEN, SPOT, 4);
}

#define WALL                                                                                                           \
    "{ \"kind\": \"box\", \"center\": [0.7, 0, -0.6], \"size\": [0.3, 1.5, 0.4], \"material\": { \"kind\": "           \
    "\"diffuse\","                                                                                                     \
    " \"albedo\": 0.7 } }"

// A dome's light has no grid: flights are tracked to it.
#define DOME "{ \"kind\": \"dome\", \"radiance\": [0.3, 0.2, 0.4] },"

// Diffuse surfaces are vertices as those in media are.
static void diffuse_surfaces_are_right_on_the_average(void **state)
{
    static double truth[BIAS_CHECK_VALUES];
    struct bias_check_scene scene = {
        .media = EVEN, .lights = SUN LAMP, .objects = FLOOR ", " WALL, .quality = PATHS("8")};

    (void)state;
    bias_check_find_truth(&scene, truth);
    assert_fair(&scene, truth, 256);
    scene = (struct bias_check_scene){.media = NOISE ", " GLOW,
                                      .lights = SUN LAMP,
                                      .objects = FLOOR ", " WALL,
                                      .orders = "\"all\"",
                                      .quality = PATHS("16")};
    assert_as_paths(&scene);
    scene.lights = NULL; // light that media emit
    scene.orders = "3";
    assert_as_paths(&scene);
}

// Between surfaces paths fly through nothing.
static void objects_alone_are_right_on_the_average(void **state)
{
    static double truth[BIAS_CHECK_VALUES], noise[BIAS_CHECK_VALUES];
    const struct bias_check_scene scene = {.media = "",
                                           .lights = SUN LAMP DOME,
                                           .objects = FLOOR ", " WALL,
                                           .orders = "\"all\"",
                                           .noise = noise,
                                           .quality = PATHS("16")};

    (void)state;
    bias_check_find_paths(&scene, 2048, truth, noise);
    assert_fair(&scene, truth, 256);
}

// A sun along the box's sides, whose column at the beam's edge is that of a whole side.
#define NOON "{ \"kind\": \"sun\", \"intensity\": [2, 3, 2], \"direction\": [0, -1, 0] },"
#define BOXED                                                                                                          \
    "{ " COLOURED ", \"density\": { \"kind\": \"noise\", \"frequency\": 2.5, \"octaves\": 2, \"mode\": \"remap\","     \
    " \"scale\": 3, \"bounds\": { \"kind\": \"box\", \"center\": [-0.2, 0, 0], \"size\": [0.7, 0.5, 0.6] } } }"

// It keeps both suns from much of the media.
#define ROOF                                                                                                           \
    "{ \"kind\": \"box\", \"center\": [-0.1, 0.8, 0], \"size\": [0.8, 0.1, 0.8], \"material\": { \"kind\": "           \
    "\"diffuse\", \"albedo\": 0.7 } }"

static void light_grids_are_right_on_the_average(void **state)
{
    (void)state;
    assert_by_light_grids(BOXED ", " EVEN, NOON SUN, FLOOR ", " WALL ", " ROOF);
    assert_by_light_grids(NOISE, INSIDE DOME, NULL);
    assert_by_light_grids(FRACTAL ", " NOISE, DOME SUN, NULL);
}

static void grids_are_right_on_the_average(void **state)
{
    enum { X = 20, Y = 18, Z = 19 };
    const char *path = temp_folder_path(state, "lumps_20x18x19xuint8.raw");
    unsigned char voxels[X * Y * Z];
    char media[1024];

    for (int n = 0; n < X * Y * Z; ++n) {
        double x = n % X, y = n / X % Y, z = n / X / Y;
        double near = hypot(hypot(x - 5, y - 6), z - 6), far = hypot(hypot(x - 14, y - 12), z - 13);

        voxels[n] = (unsigned char)fmax(60 - 12 * near, fmax(200 - 40 * far, 0));
    }
    volume_maker_write(path, voxels, sizeof voxels);
    snprintf(media, sizeof media,
             "{ " COLOURED ", \"density\": { \"kind\": \"grid\", \"file\": \"%s\", \"spacing\": [0.09, 0.09, 0.09],"
             " \"center\": [0, 0, 0], \"scale\": 0.02 } }",
             path);
    assert_first_order(media, SUN);
    assert_orders(media, SUN, "\"all\"");
}

#define ENDLESS "\"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 60"
#define GLOWING(PHASE, DENSITY)                                                                                        \
    "{ \"sigma_s\": [2, 1, 3], \"sigma_a\": [1, 1, 0.5], \"emission\": [1, 1, 0.5], \"phase\": [ " PHASE               \
    " ], \"density\": { " DENSITY " } }"
#define NOISE_EVERYWHERE                                                                                               \
    "\"kind\": \"noise\", \"frequency\": 0.7, \"octaves\": 2, \"mode\": \"remap\", \"scale\": 2, " ENDLESS " }"

// The camera is inside of a medium without an end that emits as it absorbs. Where the albedo is a everywhere, light of
// k scatterings is a^k (1 - a) in all directions, whatever density and phase: n orders sum up to 1 - a^n, since emitted
// light scatters n - 1 times.
static void assert_furnace(const char *media, const char *orders, double count)
{
    static const double albedo[3] = {2.0 / 3, 0.5, 6.0 / 7};
    const struct bias_check_scene scene = {.media = media, .quality = PATHS("2"), .background = "0", .orders = orders};
    double truth[BIAS_CHECK_VALUES];

    for (int i = 0; i < BIAS_CHECK_VALUES; ++i)
        truth[i] = 1 - pow(albedo[i % 3], count);
    assert_fair(&scene, truth, 128);
}

static void glowing_media_follow_the_geometric_series(void **state)
{
    static const char even[] = GLOWING("{ \"g\": 0.6, \"weight\": 1 }", "\"kind\": \"homogeneous\", " ENDLESS " }");
    static const char noise[] =
        GLOWING("{ \"kind\": \"rayleigh\", \"weight\": 0.5 }, { \"g\": -0.3, \"weight\": 0.5 }", NOISE_EVERYWHERE);

    (void)state;
    assert_furnace(even, "2", 2);
    assert_furnace(even, "5", 5);
    assert_furnace(even, "\"all\"", INFINITY);
    assert_furnace(noise, "1", 1);
    assert_furnace(noise, "3", 3);
    assert_furnace(noise, "\"all\"", INFINITY);
}

// So many paths take some hundred slices. One that were begun anew or went on with another weight would be seen.
static void paths_go_on_from_slice_to_slice(void **state)
{
    static const char noise[] = GLOWING("{ \"g\": 0.5, \"weight\": 1 }", NOISE_EVERYWHERE);
    const struct bias_check_scene scene = {
        .media = noise, .quality = PATHS("2048"), .background = "0", .orders = "\"all\""};
    double truth[BIAS_CHECK_VALUES];

    (void)state;
    for (int i = 0; i < BIAS_CHECK_VALUES; ++i)
        truth[i] = 1;
    assert_fair(&scene, truth, 4);
}

// One argument: a pattern of tests, or "many" for the one that takes minutes.
int main(int argc, char **argv)
{
    const struct CMUnitTest of_many[] = {
        cmocka_unit_test(noise_falls_evenly_to_65536_paths),
    };
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(even_media_are_right_on_the_average),
        cmocka_unit_test(coefficients_far_apart_are_right_on_the_average),
        cmocka_unit_test(several_lobes_are_right_on_the_average),
        cmocka_unit_test(noise_is_right_on_the_average),
        cmocka_unit_test(several_media_are_right_on_the_average),
        cmocka_unit_test(all_orders_are_those_of_the_reference),
        cmocka_unit_test(diffuse_surfaces_are_right_on_the_average),
        cmocka_unit_test(objects_alone_are_right_on_the_average),
        cmocka_unit_test(lamps_inside_are_right_on_the_average),
        cmocka_unit_test(lobes_near_lamps_are_right_on_the_average),
        cmocka_unit_test(paths_towards_lamps_are_right_on_the_average),
        cmocka_unit_test(second_paths_are_right_on_the_average),
        cmocka_unit_test(noise_falls_evenly_beside_a_lamp),
        cmocka_unit_test(light_grids_are_right_on_the_average),
        cmocka_unit_test_setup_teardown(grids_are_right_on_the_average, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test(glowing_media_follow_the_geometric_series),
        cmocka_unit_test(paths_go_on_from_slice_to_slice),
    };

    if (argc > 1 && strcmp(argv[1], "many") == 0) return cmocka_run_group_tests(of_many, NULL, NULL);
    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
