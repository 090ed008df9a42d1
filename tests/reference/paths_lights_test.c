// Random paths under lamps with size, spots and domes, against closed forms.
// SPDX-License-Identifier: Apache-2.0
#include "reference/paths.h"
#include "tests/support/assert_near.h"
#include "tests/support/path_still.h"
#include "tests/support/solid_still.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { PATHS = 1 << 14 };

// A floor at y = -1 of albedo 0.6; the camera's middle pixel sees the point (0, -1, 0) from (0, 3, 4).
static void init_floor(struct still *still)
{
    const struct material material = solid_diffuse(0.6);
    struct shape floor = solid_plane((struct vec3){0.0, -1.0, 0.0}, (struct vec3){0.0, 1.0, 0.0});

    solid_still_init(still);
    camera_pinhole_init(&still->camera, &(struct camera_pinhole_params){.position = {0.0, 3.0, 4.0},
                                                                        .target = {0.0, -1.0, 0.0},
                                                                        .up = {0.0, 1.0, 0.0},
                                                                        .fov_deg = 40.0,
                                                                        .width_px = 5,
                                                                        .height_px = 5,
                                                                        .clip_far = INFINITY});
    solid_still_add(still, &material, &floor, 1);
}

static struct paths_light measure(const struct still *still, int orders, long count)
{
    struct paths_light light;

    assert_true(paths_measure_pixel(still, orders, 2, 2, count, 5, &light));
    return light;
}

static void check(const struct still *still, int orders, double truth, double error_most)
{
    struct paths_light light = measure(still, orders, PATHS);

    assert_by_chance(light.mean[1], light.error[1], truth, error_most, 1e-6 * truth);
}

static void an_even_dome_lights_a_floor_from_everywhere(void **state)
{
    struct still still;

    init_floor(&still);
    path_still_set_dome(&still, 2.5);
    check(&still, 1, 0.6 * 2.5, 0.01);
}

// The mean over a hemisphere of the cosine, weighted by the cosine, is 2 / 3.
static void a_gradient_lights_a_floor_by_its_share(void **state)
{
    struct still still;

    init_floor(&still);
    still.has_dome = true;
    still.dome = (struct dome){
        .kind = SCENE_DOME_GRADIENT, .along = {3.0, 3.0, 3.0}, .against = {1.0, 1.0, 1.0}, .axis = {0.0, 1.0, 0.0}};
    check(&still, 1, 0.6 * (1.0 + 2.0 * 0.5 * (1.0 + 2.0 / 3.0)), 0.01);
}

enum { COLUMNS = 32, ROWS = 16 };

// The sum over the whole sky in small pieces.
static double floor_light(const struct dome *dome)
{
    enum { TURNS = 1024, HEIGHTS = 1024 };
    double sum = 0.0;

    for (int j = 0; j < HEIGHTS; j++)
        for (int i = 0; i < TURNS; i++) {
            double y = (j + 0.5) / HEIGHTS, turn = 2.0 * M_PI * (i + 0.5) / TURNS, aside = sqrt(1.0 - y * y), light[3];

            dome_radiance(dome, (struct vec3){aside * sin(turn), y, aside * cos(turn)}, light);
            sum += light[1] * y;
        }
    return sum * 2.0 * M_PI / ((double)TURNS * HEIGHTS);
}

static void set_image(struct still *still, const float *rgb)
{
    still->has_dome = true;
    still->dome = (struct dome){.kind = SCENE_DOME_FILE,
                                .along = {1.0, 1.0, 1.0},
                                .axis = {0.0, 1.0, 0.0},
                                .angle = 0.7,
                                .rgb = rgb,
                                .width = COLUMNS,
                                .height = ROWS};
}

static void a_sun_in_an_image_is_found(void **state)
{
    static float rgb[3 * COLUMNS * ROWS];
    struct still still;

    for (int i = 0; i < 3 * COLUMNS * ROWS; i++)
        rgb[i] = 1.0f;
    for (int c = 0; c < 3; c++)
        rgb[3 * (4 * COLUMNS + 9) + c] = 1e5f;
    init_floor(&still);
    set_image(&still, rgb);
    check(&still, 1, 0.6 / M_PI * floor_light(&still.dome), 0.02);
}

// Both ways to find the light of an image share it without loss: an even image is a furnace.
static void an_even_image_is_a_furnace(void **state)
{
    static float rgb[3 * COLUMNS * ROWS];
    struct still still;

    for (int i = 0; i < 3 * COLUMNS * ROWS; i++)
        rgb[i] = 1.0f;
    for (int k = 0; k < 3; k++) {
        solid_still_init(&still);
        path_still_set_g(path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 3.0, 0.0), 0.45 * k);
        set_image(&still, rgb);
        still.dome.is_visible = true;
        check(&still, SCENE_ORDERS_ALL, 1.0, 0.01);
    }
}

static void add_sphere(struct still *still, struct vec3 center, double radius, double intensity)
{
    struct sphere_light *lamp = &still->spheres[still->sphere_count++];

    *lamp = (struct sphere_light){.center = center, .radius = radius};
    for (int c = 0; c < 3; c++)
        lamp->radiance[c] = intensity / (M_PI * radius * radius);
}

// A sphere that is wholly above the horizon sends what a point of its intensity does.
static void a_sphere_lights_a_floor_by_its_view_factor(void **state)
{
    static const double RADII[] = {0.01, 0.5, 1.4};
    const struct vec3 center = {1.0, 0.5, -0.5};
    const double square = 1.0 + 1.5 * 1.5 + 0.25;

    for (size_t i = 0; i < 3; i++) {
        struct still still;

        init_floor(&still);
        add_sphere(&still, center, RADII[i], 4.0);
        check(&still, 1, 0.6 / M_PI * 4.0 * 1.5 / (square * sqrt(square)), 0.01);
    }
}

// A thin medium far from a lamp: a sphere's light is a point's; within, it is dark.
static void a_small_sphere_is_a_point_to_media(void **state)
{
    static const double GS[] = {0.0, 0.9};
    static const struct vec3 PLACES[] = {{0.1, 0.2, -0.1}, {0.0, 2.0, 0.5}};

    for (size_t i = 0; i < 4; i++) {
        struct paths_light of_point, of_sphere;
        struct still still;

        solid_still_init(&still);
        path_still_set_g(path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 2.0, 0.3), GS[i % 2]);
        add_sphere(&still, PLACES[i / 2], 1e-3, 1.0);
        of_sphere = measure(&still, 4, 16 * PATHS);
        still.sphere_count = 0;
        path_still_add_point(&still, PLACES[i / 2], 1.0);
        of_point = measure(&still, 4, 16 * PATHS);
        assert_by_chance(of_sphere.mean[0], hypot(of_sphere.error[0], of_point.error[0]), of_point.mean[0], 0.08,
                         1e-3 * of_point.mean[0]);
    }
}

// A lamp that surrounds everything lights nothing.
static void a_sphere_is_dark_inside(void **state)
{
    struct still still;

    solid_still_init(&still);
    path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 2.0, 0.3);
    add_sphere(&still, (struct vec3){0.0, 0.0, 0.0}, 5.0, 1.0);
    assert_near(measure(&still, SCENE_ORDERS_ALL, 256).mean[0], 0.0, 0.0);
}

static double smoothstep(double s)
{
    s = fmin(fmax(s, 0.0), 1.0);
    return s * s * (3.0 - 2.0 * s);
}

static void a_spot_lights_a_floor_by_its_angle(void **state)
{
    static const double TILTS[] = {0.0, 0.25, 0.4, 0.6}; // radians off the point

    for (size_t i = 0; i < 4; i++) {
        struct still still;
        double truth = 0.6 / M_PI * 4.0 / 9.0 * smoothstep((0.5 - TILTS[i]) / 0.3);
        struct paths_light light;

        init_floor(&still);
        path_still_add_point(&still, (struct vec3){0.0, 2.0, 0.0}, 4.0);
        still.lights[0].kind = SCENE_LIGHT_SPOT;
        still.lights[0].direction = (struct vec3){sin(TILTS[i]), -cos(TILTS[i]), 0.0};
        still.lights[0].inner = 0.2;
        still.lights[0].outer = 0.5;
        light = measure(&still, 1, 16);
        assert_near(light.mean[0], truth, 1e-9);
    }
}

// m to where a ball of radius 1 about the origin ends.
static double way_out(struct vec3 place, struct vec3 direction)
{
    double along = vec3_dot(place, direction);

    return -along + sqrt(along * along + 1.0 - vec3_dot(place, place));
}

// Light of one scattering along the ball's middle: what comes from a direction is a + b exp(-sigma_t distance out).
static double scattered_once(double sigma_s, double sigma_t, double a, double b)
{
    enum { PLACES = 400, HEIGHTS = 400 };
    double sum = 0.0;

    for (int i = 0; i < PLACES; i++) {
        struct vec3 place = {0.0, 0.0, 1.0 - 2.0 * (i + 0.5) / PLACES};
        double mean = 0.0;

        for (int j = 0; j < HEIGHTS; j++) {
            double z = -1.0 + 2.0 * (j + 0.5) / HEIGHTS;

            mean += a + b * exp(-sigma_t * way_out(place, (struct vec3){sqrt(1.0 - z * z), 0.0, z}));
        }
        sum += sigma_s * exp(-sigma_t * (1.0 - place.z)) * mean / HEIGHTS * 2.0 / PLACES;
    }
    return sum;
}

static void a_ball_under_a_dome_scatters_once_as_it_should(void **state)
{
    struct still still;

    solid_still_init(&still);
    path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 1.2, 0.5);
    path_still_set_dome(&still, 1.0);
    check(&still, 1, scattered_once(1.2, 1.7, 0.0, 1.0), 0.02);
}

// What glows is scattered once less than lamps' light: not at order 1, once at order 2.
static void glowing_light_is_scattered_once_less(void **state)
{
    const double sigma_t = 1.7, source = 0.5 / sigma_t, direct = source * (1.0 - exp(-2.0 * sigma_t));
    struct medium *medium;
    struct still still;

    solid_still_init(&still);
    medium = path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 1.2, 0.5);
    for (int c = 0; c < 3; c++)
        medium->emission[c] = 0.5;
    check(&still, 1, direct, 0.01);
    // A dome, though black, makes paths go on after their last order.
    path_still_set_dome(&still, 0.0);
    check(&still, 1, direct, 0.01);
    check(&still, 2, direct + scattered_once(1.2, sigma_t, source, -source), 0.01);
    // With a dome as bright as it glows, nothing of it is seen.
    path_still_set_dome(&still, 1.0);
    still.dome.is_visible = true;
    check(&still, SCENE_ORDERS_ALL, 1.0, 0.01);
    for (int c = 0; c < 3; c++) {
        medium->sigma_s[c] = 8.0;
        medium->sigma_a[c] = medium->emission[c] = 2.0;
    }
    check(&still, SCENE_ORDERS_ALL, 1.0, 0.001);
}

// It attenuates nothing, and yet it is seen.
static void what_glows_alone_is_seen(void **state)
{
    struct medium *medium;
    struct still still;

    solid_still_init(&still);
    medium = path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 0.0, 0.0);
    for (int c = 0; c < 3; c++)
        medium->emission[c] = 0.5;
    check(&still, 1, 1.0, 0.01);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_even_dome_lights_a_floor_from_everywhere),
        cmocka_unit_test(a_gradient_lights_a_floor_by_its_share),
        cmocka_unit_test(a_sun_in_an_image_is_found),
        cmocka_unit_test(an_even_image_is_a_furnace),
        cmocka_unit_test(a_sphere_lights_a_floor_by_its_view_factor),
        cmocka_unit_test(a_small_sphere_is_a_point_to_media),
        cmocka_unit_test(a_sphere_is_dark_inside),
        cmocka_unit_test(a_spot_lights_a_floor_by_its_angle),
        cmocka_unit_test(a_ball_under_a_dome_scatters_once_as_it_should),
        cmocka_unit_test(glowing_light_is_scattered_once_less),
        cmocka_unit_test(what_glows_alone_is_seen),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
