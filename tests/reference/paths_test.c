// SPDX-License-Identifier: Apache-2.0
#include "reference/paths.h"

#include "core/base/error.h"
#include "reference/reference.h"
#include "tests/support/assert_near.h"
#include "tests/support/path_still.h"
#include "tests/support/solid_still.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { PATHS = 1 << 15 };

static struct paths_light measure(const struct still *still, int orders, int x, int y, long count, uint64_t seed)
{
    struct paths_light light;

    assert_true(paths_measure_pixel(still, orders, x, y, count, seed, &light));
    return light;
}

// Order 1 is what the march along the ray and straight to the lamps gives.
static void check_first_order(const struct still *still, double error_most)
{
    static const int PIXELS[][2] = {{2, 2}, {1, 2}, {3, 3}};

    for (size_t i = 0; i < sizeof PIXELS / sizeof PIXELS[0]; i++) {
        int x = PIXELS[i][0], y = PIXELS[i][1];
        struct reference_pixel exact = reference_measure_pixel(still, x, y, NULL);
        struct paths_light light = measure(still, 1, x, y, PATHS, 7 + i);

        for (int c = 0; c < 3; c++)
            assert_by_chance(light.mean[c], light.error[c], exact.radiance[c], error_most, 2e-4 * exact.radiance[c]);
    }
}

static void add_lamps(struct still *still)
{
    path_still_add_point(still, (struct vec3){2.0, 1.5, 1.0}, 8.0);
    path_still_add_sun(still, (struct vec3){0.3, -1.0, -0.5}, 1.5);
}

static void set_colors(struct medium *medium, double red, double green, double blue)
{
    const double factors[3] = {red, green, blue};

    for (int c = 0; c < 3; c++) {
        medium->sigma_s[c] *= factors[c];
        medium->sigma_a[c] *= factors[2 - c];
        medium->emission[c] = 0.2 * factors[c];
    }
}

static void a_ball_s_first_order_is_exact(void **state)
{
    struct still still;

    solid_still_init(&still);
    solid_still_set_background(&still, 0.5);
    path_still_set_g(path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 0.9, 0.3), 0.6);
    add_lamps(&still);
    check_first_order(&still, 0.01);
}

static void a_folded_cloud_s_first_order_is_exact(void **state)
{
    struct still still;

    solid_still_init(&still);
    set_colors(path_still_add_fold(&still, 1.5, 0.2), 1.0, 0.5, 0.2);
    add_lamps(&still);
    check_first_order(&still, 0.02);
}

static void noise_s_first_order_is_exact(void **state)
{
    struct still still;

    solid_still_init(&still);
    set_colors(path_still_add_noise(&still, SCENE_NOISE_REMAP, 2.0, 0.5), 1.0, 2.0, 3.0);
    add_lamps(&still);
    check_first_order(&still, 0.02);
}

static void a_grid_s_first_order_is_exact(void **state)
{
    struct still still;

    solid_still_init(&still);
    path_still_set_g(path_still_add_grid(&still, 2.0, 0.5), -0.3);
    add_lamps(&still);
    check_first_order(&still, 0.02);
}

static void add_mixed_media(struct still *still)
{
    set_colors(path_still_add_grid(still, 1.0, 0.2), 2.0, 1.0, 0.3);
    set_colors(path_still_add_ball(still, (struct vec3){0.3, 0.2, 0.5}, 0.7, 0.5, 0.4), 0.1, 1.0, 2.0);
    path_still_set_g(path_still_add_noise(still, SCENE_NOISE_CLIP, 2.0, 0.1), 0.8);
    add_lamps(still);
}

static void mixed_media_s_first_order_is_exact(void **state)
{
    struct still still;

    solid_still_init(&still);
    add_mixed_media(&still);
    check_first_order(&still, 0.02);
}

static void make_thinner(struct medium *medium, double by)
{
    for (int c = 0; c < 3; c++) {
        medium->sigma_s[c] /= by;
        medium->sigma_a[c] /= by;
        medium->emission[c] /= by;
    }
}

// One path of hundreds would collide there.
static void thin_media_need_few_paths(void **state)
{
    struct still still;

    solid_still_init(&still);
    make_thinner(path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 0.9, 0.3), 1e6);
    path_still_add_sun(&still, (struct vec3){0.3, -1.0, -0.5}, 1.5);
    for (int i = 0; i < 2; i++) {
        struct paths_light light = measure(&still, SCENE_ORDERS_ALL, 2, 2, 128, (uint64_t)i);
        struct reference_pixel exact = reference_measure_pixel(&still, 2, 2, NULL);

        assert_by_chance(light.mean[0], light.error[0], exact.radiance[0], 0.07, 1e-5 * exact.radiance[0]);
    }
}

// Media are met in any order and number, though one of them at least is; what glows is met as often.
static void thin_mixed_media_s_first_order_is_exact(void **state)
{
    struct still still;

    solid_still_init(&still);
    solid_still_set_background(&still, 1e-4);
    add_mixed_media(&still);
    for (size_t i = 0; i < still.medium_count; i++)
        make_thinner(&still.media[i], i == 1 ? 3.0 : 1e3);
    check_first_order(&still, 0.05);
}

// Extinctions of 1000, 30 and 1: blue sees through where red ends at once.
static void colors_far_apart_share_their_paths(void **state)
{
    struct still still;
    struct medium *medium;

    solid_still_init(&still);
    medium = path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 0.8, 0.2);
    for (int c = 0; c < 3; c++) {
        const double factors[3] = {1000.0, 30.0, 1.0};

        medium->sigma_s[c] *= factors[c];
        medium->sigma_a[c] *= factors[c];
    }
    path_still_add_point(&still, (struct vec3){1.0, 1.5, 4.0}, 8.0);
    check_first_order(&still, 0.05);
}

static void a_diffuse_plane_s_first_order_is_exact(void **state)
{
    const struct material material = solid_diffuse(0.7);
    struct shape plane = solid_plane((struct vec3){0.0, -1.2, 0.0}, (struct vec3){0.0, 1.0, 0.2});
    struct still still;

    solid_still_init(&still);
    solid_still_add(&still, &material, &plane, 1);
    path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 1.0, 0.3);
    add_lamps(&still);
    check_first_order(&still, 0.02);
}

// Media count between the camera's clip distances, but light on its way is not clipped.
static void a_clipped_ball_s_first_order_is_exact(void **state)
{
    struct still still;

    solid_still_init(&still);
    still.camera.clip_near = 3.5;
    still.camera.clip_far = 4.6;
    path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 1.0, 0.3);
    path_still_add_point(&still, (struct vec3){0.1, 0.15, 0.3}, 1.0);
    add_lamps(&still);
    check_first_order(&still, 0.02);
}

static void a_lamp_inside_is_exact(void **state)
{
    struct still still;

    solid_still_init(&still);
    path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 1.0, 0.3);
    path_still_add_grid(&still, 1.0, 0.3);
    path_still_add_point(&still, (struct vec3){0.1, 0.15, -0.2}, 1.0);
    check_first_order(&still, 0.02);
}

// Each of the noise's halves is as far from the truth as its error says, whatever the number of paths.
static void noise_of_a_lamp_inside_falls_as_it_should(void **state)
{
    enum { BATCHES = 32 };
    struct still still;
    struct paths *paths;
    double first = 0.0;

    solid_still_init(&still);
    path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 2.5, 0.1);
    path_still_add_point(&still, (struct vec3){0.1, 0.15, -0.2}, 1.0);
    paths = paths_create(&still, SCENE_ORDERS_ALL, NULL);
    for (long count = 1 << 6; count <= 1 << 15; count *= 8) {
        double mean = 0.0, squares = 0.0, noise;

        for (int i = 0; i < BATCHES; i++) {
            struct paths_light light;
            double off;

            paths_measure_point(paths, 2.7, 2.2, count, (uint64_t)(1000 * count + i), &light);
            off = light.mean[0] - mean;
            mean += off / (i + 1);
            squares += off * (light.mean[0] - mean);
        }
        noise = sqrt(squares / (BATCHES - 1) * (double)count) / mean;
        print_message("%6ld paths: mean %.5f, noise times the root %.3f\n", count, mean, noise);
        if (first == 0.0) first = noise;
        // 32 batches know their spread within 13 % of it.
        assert_near(noise / first, 1.0, 0.4);
    }
    paths_destroy(paths);
}

static void more_orders_bring_more_light(void **state)
{
    double before = 0.0;
    struct still still;

    solid_still_init(&still);
    path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 1.5, 0.0);
    add_lamps(&still);
    for (int orders = 1; orders <= 8; orders *= 2) {
        struct paths_light light = measure(&still, orders, 2, 2, PATHS / 4, 1);

        assert_true(light.mean[0] > before + 5.0 * light.error[0]);
        before = light.mean[0];
    }
}

static void seeds_make_independent_halves(void **state)
{
    struct still still;
    struct paths_light a, b, again;

    solid_still_init(&still);
    path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 1.5, 0.0);
    add_lamps(&still);
    a = measure(&still, SCENE_ORDERS_ALL, 2, 2, 256, 1);
    again = measure(&still, SCENE_ORDERS_ALL, 2, 2, 256, 1);
    b = measure(&still, SCENE_ORDERS_ALL, 2, 2, 256, 2);
    assert_true(a.mean[0] == again.mean[0] && a.error[0] == again.error[0]);
    assert_true(a.mean[0] != b.mean[0]);
    assert_near(a.mean[0], b.mean[0], 5.0 * hypot(a.error[0], b.error[0]));
}

static void expect_refusal(const struct still *still, const char *words)
{
    struct error error = {{0}};

    assert_null(paths_create(still, 2, &error));
    assert_non_null(strstr(error.message, words));
}

static void what_paths_cannot_follow_is_refused(void **state)
{
    const struct material mirror = solid_mirror(0.9), glass = solid_glass(SCENE_FRESNEL_EXACT, 1.5);
    struct density_function function = {.scale = 1.0};
    struct shape ball = solid_sphere(0.0, 0.0, 0.0, 1.0);
    struct still still;

    solid_still_init(&still);
    solid_still_add(&still, &mirror, &ball, 1);
    expect_refusal(&still, "diffuse surfaces only");
    solid_still_init(&still);
    solid_still_add(&still, &glass, &ball, 1);
    expect_refusal(&still, "diffuse surfaces only");
    solid_still_init(&still);
    path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 1.0, 0.0)->density = density_function(&function);
    expect_refusal(&still, "bound");
    solid_still_init(&still);
    solid_still_fill(&still, 0, 1.0, 0.0);
    expect_refusal(&still, "absorbs nothing");
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_s_first_order_is_exact),
        cmocka_unit_test(a_folded_cloud_s_first_order_is_exact),
        cmocka_unit_test(noise_s_first_order_is_exact),
        cmocka_unit_test(a_grid_s_first_order_is_exact),
        cmocka_unit_test(mixed_media_s_first_order_is_exact),
        cmocka_unit_test(thin_media_need_few_paths),
        cmocka_unit_test(thin_mixed_media_s_first_order_is_exact),
        cmocka_unit_test(colors_far_apart_share_their_paths),
        cmocka_unit_test(a_diffuse_plane_s_first_order_is_exact),
        cmocka_unit_test(a_clipped_ball_s_first_order_is_exact),
        cmocka_unit_test(a_lamp_inside_is_exact),
        cmocka_unit_test(noise_of_a_lamp_inside_falls_as_it_should),
        cmocka_unit_test(more_orders_bring_more_light),
        cmocka_unit_test(seeds_make_independent_halves),
        cmocka_unit_test(what_paths_cannot_follow_is_refused),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
