// Random paths against what transport theory knows in closed form.
// SPDX-License-Identifier: Apache-2.0
#include "reference/path_walk.h"
#include "reference/phase_draw.h"
#include "reference/transmittance.h"
#include "tests/support/assert_near.h"
#include "tests/support/path_still.h"
#include "tests/support/solid_still.h"
#include "tests/support/tally.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

// The light along a ray as one that was scattered before meets it, by one path; of the first colour.
static double look_along(const struct path_scene *scene, struct vec3 origin, struct vec3 direction,
                         struct stream *stream)
{
    struct path_walk walk = {.ray = {origin, direction}, .far = INFINITY};
    double radiance[3] = {0.0, 0.0, 0.0};

    path_walk_add(scene, &walk, stream, radiance);
    return radiance[0];
}

static struct vec3 random_direction(struct stream *stream)
{
    static const struct vec3 UP = {0.0, 0.0, 1.0};

    return phase_draw_about(UP, 2.0 * stream_draw(stream) - 1.0, stream);
}

static struct vec3 random_origin(struct stream *stream)
{
    struct vec3 origin = random_direction(stream);

    return vec3_scale(origin, 2.0 * cbrt(stream_draw(stream)));
}

// Each path by itself brings exactly what the dome sends: it ends nowhere else.
static void check_furnace(struct still *still, const char *name)
{
    static const double GS[] = {0.0, 0.6, -0.5, 0.95};

    path_still_set_dome(still, 1.0);
    for (size_t k = 0; k < sizeof GS / sizeof GS[0]; k++) {
        struct path_scene scene;

        for (size_t i = 0; i < still->medium_count; i++)
            path_still_set_g(&still->media[i], GS[k]);
        path_scene_init(&scene, still, SCENE_ORDERS_ALL);
        for (uint64_t i = 0; i < 400; i++) {
            struct stream stream = stream_of(k, i);
            struct vec3 origin = random_origin(&stream);
            double seen = look_along(&scene, origin, random_direction(&stream), &stream);

            if (fabs(seen - 1.0) > 1e-9) print_error("%s, g %g\n", name, GS[k]);
            assert_near(seen, 1.0, 1e-9);
        }
        path_scene_finish(&scene);
    }
}

static void white_media_vanish_in_even_light(void **state)
{
    struct still still;

    solid_still_init(&still);
    path_still_add_ball(&still, (struct vec3){0.2, 0.0, 0.0}, 1.0, 8.0, 0.0);
    check_furnace(&still, "ball");
    solid_still_init(&still);
    path_still_add_box(&still, (struct vec3){1.0, 0.3, 0.7}, 8.0, 0.0);
    check_furnace(&still, "box");
    solid_still_init(&still);
    path_still_add_slab(&still, 1.0, 4.0, 0.0);
    check_furnace(&still, "slab");
    solid_still_init(&still);
    path_still_add_fold(&still, 4.0, 0.0);
    check_furnace(&still, "fold");
    solid_still_init(&still);
    path_still_add_noise(&still, SCENE_NOISE_ABSOLUTE, 8.0, 0.0);
    path_still_add_grid(&still, 4.0, 0.0);
    check_furnace(&still, "noise and grid");
}

static void white_surfaces_vanish_in_even_light(void **state)
{
    const struct material white = solid_diffuse(1.0);
    struct shape plane = solid_plane((struct vec3){0.0, -3.0, 0.0}, (struct vec3){0.0, 1.0, 0.2});
    struct shape box = solid_box((struct vec3){0.0, -2.5, 0.0}, (struct vec3){0.3, 0.4, 0.5});
    struct still still;

    solid_still_init(&still);
    solid_still_add(&still, &white, &plane, 1);
    solid_still_add(&still, &white, &box, 1);
    path_still_add_grid(&still, 2.0, 0.0);
    check_furnace(&still, "plane and box");
}

// Weights of colours whose extinctions are far apart differ from 1, but not their mean; what absorbs is darker.
static void white_colors_vanish_in_the_mean(void **state)
{
    static const double SIGMAS[] = {100.0, 10.0, 1.0};
    struct tally tallies[3] = {{0}};
    struct path_scene scene;
    struct medium *medium;
    struct still still;

    solid_still_init(&still);
    medium = path_still_add_ball(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0, 1.0, 0.0);
    for (int c = 0; c < 3; c++)
        medium->sigma_s[c] = SIGMAS[c];
    medium->sigma_a[2] = 0.5;
    path_still_set_dome(&still, 1.0);
    path_scene_init(&scene, &still, SCENE_ORDERS_ALL);
    for (uint64_t i = 0; i < 20000; i++) {
        struct stream stream = stream_of(1, i);
        struct path_walk walk = {.ray = {{0.3, 0.2, 3.0}, {0.0, 0.0, -1.0}}, .far = INFINITY};
        double radiance[3] = {0.0, 0.0, 0.0};

        path_walk_add(&scene, &walk, &stream, radiance);
        for (int c = 0; c < 3; c++)
            tally_add(&tallies[c], radiance[c]);
    }
    assert_by_chance(tallies[0].mean, tally_find_error(&tallies[0]), 1.0, 0.05, 0.0);
    assert_by_chance(tallies[1].mean, tally_find_error(&tallies[1]), 1.0, 0.05, 0.0);
    assert_true(tallies[2].mean < 0.8 && tally_find_error(&tallies[2]) < 0.02);
    path_scene_finish(&scene);
}

enum { COLLISIONS = 6 };

static void note_place(void *user, int order, struct vec3 position, const double throughput[static 3])
{
    struct tally *tallies = user;

    if (order <= COLLISIONS) tally_add(&tallies[order - 1], throughput[0] * position.z);
}

// A furnace does not see wrong free paths or wrong phases; places do.
static void collisions_lie_where_theory_says(void **state)
{
    static const double GS[] = {0.0, 0.5, -0.5, 0.9}, SIGMAS[] = {0.2, 1.0, 7.0};

    for (size_t k = 0; k < 4; k++)
        for (size_t s = 0; s < 3; s++) {
            struct tally tallies[COLLISIONS] = {{0}};
            struct path_scene scene;
            struct still still;

            solid_still_init(&still);
            path_still_set_g(solid_still_fill(&still, 0, SIGMAS[s], 0.0), GS[k]);
            path_scene_init(&scene, &still, COLLISIONS);
            for (uint64_t i = 0; i < 20000; i++) {
                struct path_walk walk = {
                    .ray.direction = {0.0, 0.0, 1.0}, .far = INFINITY, .on_vertex = note_place, .user = tallies};
                struct stream stream = stream_of(s, i);
                double radiance[3] = {0.0, 0.0, 0.0};

                path_walk_add(&scene, &walk, &stream, radiance);
            }
            for (int n = 1; n <= COLLISIONS; n++)
                assert_by_chance(tallies[n - 1].mean, tally_find_error(&tallies[n - 1]),
                                 (1.0 - pow(GS[k], n)) / (SIGMAS[s] * (1.0 - GS[k])), 0.03, 0.0);
            path_scene_finish(&scene);
        }
}

// The mean radiance that a vertex receives, by one path.
static double look_from(const struct path_scene *scene, const struct path_vertex *vertex, struct stream *stream)
{
    struct path_walk walk = {.from = vertex, .far = INFINITY};
    double radiance[3] = {0.0, 0.0, 0.0};

    path_walk_add(scene, &walk, stream, radiance);
    return radiance[0];
}

// 4 pi times the mean radiance from all directions, by one path.
static double look_around(const struct path_scene *scene, struct vec3 position, struct stream *stream)
{
    static const struct medium ISOTROPIC;
    const struct path_vertex vertex = {
        .position = position, .incoming = {0.0, 0.0, 1.0}, .medium = &ISOTROPIC, .throughput = {1.0, 1.0, 1.0}};

    return 4.0 * M_PI * look_from(scene, &vertex, stream);
}

static struct tally measure_fluence(const struct path_scene *scene, struct vec3 position, uint64_t seed, int count)
{
    struct tally tally = {0};

    for (uint64_t i = 0; i < (uint64_t)count; i++) {
        struct stream stream = stream_of(seed, i);

        tally_add(&tally, look_around(scene, position, &stream));
    }
    return tally;
}

// Case, de Hoffmann and Placzek, Introduction to the Theory of Neutron Diffusion, 1953: the transform of a point
// source's fluence is that of its unscattered part, atan(k) / k, over 1 less albedo times that. Here without the
// unscattered part.
static double scattered_transform(double k, double albedo)
{
    double flown = k > 0.0 ? atan(k) : 0.0;

    return k > 0.0 ? flown * flown / (k - albedo * flown) : 0.0;
}

// Half waves alternate in sign: their sums' repeated means converge quickly.
static double point_source_fluence(double distance, double albedo)
{
    enum { WAVES = 60, PIECES = 400 };
    double sums[WAVES], sum = 0.0, width = M_PI / distance;

    for (int i = 0; i < WAVES; i++) {
        for (int j = 0; j < PIECES; j++) {
            double k = width * (i + (j + 0.5) / PIECES);

            sum += sin(k * distance) * scattered_transform(k, albedo) * width / PIECES;
        }
        sums[i] = sum;
    }
    for (int length = WAVES; length > WAVES / 2; length--)
        for (int i = 0; i + 1 < length; i++)
            sums[i] = 0.5 * (sums[i] + sums[i + 1]);
    return albedo * sums[WAVES / 2 - 1] / (2.0 * M_PI * M_PI * distance);
}

static void a_lamp_in_an_endless_medium_shines_as_theory_says(void **state)
{
    static const double ALBEDOS[] = {0.5, 0.9}, DISTANCES[] = {0.3, 1.0, 3.0};

    for (size_t a = 0; a < 2; a++)
        for (size_t d = 0; d < 3; d++) {
            double truth = point_source_fluence(DISTANCES[d], ALBEDOS[a]);
            struct path_scene scene;
            struct still still;
            struct tally tally;

            solid_still_init(&still);
            solid_still_fill(&still, 0, ALBEDOS[a], 1.0 - ALBEDOS[a]);
            path_still_add_point(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0 / (4.0 * M_PI));
            path_scene_init(&scene, &still, SCENE_ORDERS_ALL);
            tally = measure_fluence(&scene, (struct vec3){0.0, DISTANCES[d], 0.0}, a, 30000);
            print_message("albedo %g, %g free paths away: %.5f +- %.5f, theory %.5f\n", ALBEDOS[a], DISTANCES[d],
                          tally.mean, tally_find_error(&tally), truth);
            assert_by_chance(tally.mean, tally_find_error(&tally), truth, 0.03, 1e-4 * truth);
            path_scene_finish(&scene);
        }
}

// It says where light is looked for, not how much there is: near, far and in between.
static void a_peak_s_reach_changes_no_light(void **state)
{
    static const double REACHES[] = {0.1, 0.4, 3.0};

    for (size_t i = 0; i < 3; i++) {
        double truth = point_source_fluence(1.0, 0.5);
        struct path_scene scene;
        struct still still;
        struct tally tally;

        solid_still_init(&still);
        solid_still_fill(&still, 0, 0.5, 0.5);
        path_still_add_point(&still, (struct vec3){0.0, 0.0, 0.0}, 1.0 / (4.0 * M_PI));
        path_scene_init(&scene, &still, SCENE_ORDERS_ALL);
        scene.peaks[0].reach = REACHES[i];
        tally = measure_fluence(&scene, (struct vec3){0.0, 1.0, 0.0}, i, 40000);
        assert_by_chance(tally.mean, tally_find_error(&tally), truth, 0.03, 1e-4 * truth);
        path_scene_finish(&scene);
    }
}

enum { H_NODES = 400 };

// Chandrasekhar's H function for isotropic scattering, at the middles of even pieces of [0, 1] and at `at`; Radiative
// Transfer, 1950: its equation is iterated in the form whose fixed point is the physical one.
static double h_function(double albedo, double at)
{
    double h[H_NODES], next[H_NODES], value = 0.0;

    for (int i = 0; i < H_NODES; i++)
        h[i] = 1.0;
    for (int turn = 0; turn < 200; turn++) {
        for (int i = 0; i <= H_NODES; i++) {
            double mu = i < H_NODES ? (i + 0.5) / H_NODES : at, sum = 0.0;

            for (int j = 0; j < H_NODES; j++) {
                double other = (j + 0.5) / H_NODES;

                sum += other * h[j] / (mu + other) / H_NODES;
            }
            value = 1.0 / (sqrt(1.0 - albedo) + 0.5 * albedo * sum);
            if (i < H_NODES) next[i] = value;
        }
        for (int i = 0; i < H_NODES; i++)
            h[i] = 0.5 * (h[i] + next[i]);
    }
    return value;
}

static void a_half_space_reflects_as_chandrasekhar_says(void **state)
{
    static const double ALBEDOS[] = {0.5, 0.9, 0.99};
    const double sun = 0.6, eye = 0.8; // cosines to the surface's normal

    for (size_t a = 0; a < 3; a++) {
        double albedo = ALBEDOS[a];
        double truth = albedo / (4.0 * M_PI) * sun / (sun + eye) * h_function(albedo, sun) * h_function(albedo, eye);
        struct path_scene scene;
        struct still still;
        struct tally tally = {0};

        solid_still_init(&still);
        path_still_add_slab(&still, 200.0, albedo, 1.0 - albedo);
        path_still_add_sun(&still, (struct vec3){sqrt(1.0 - sun * sun), 0.0, -sun}, 1.0);
        path_scene_init(&scene, &still, SCENE_ORDERS_ALL);
        for (uint64_t i = 0; i < 20000; i++) {
            struct stream stream = stream_of(a, i);

            tally_add(&tally, look_along(&scene, (struct vec3){0.0, 0.0, 101.0},
                                         (struct vec3){0.0, sqrt(1.0 - eye * eye), -eye}, &stream));
        }
        print_message("albedo %g: %.5f +- %.5f, theory %.5f\n", albedo, tally.mean, tally_find_error(&tally), truth);
        assert_by_chance(tally.mean, tally_find_error(&tally), truth, 0.02, 1e-3 * truth);
        path_scene_finish(&scene);
    }
}

static void fill_two_media(struct still *still)
{
    solid_still_init(still);
    path_still_set_g(path_still_add_grid(still, 2.0, 0.3), 0.5);
    path_still_set_g(path_still_add_ball(still, (struct vec3){0.4, 0.2, 0.0}, 0.8, 1.5, 0.2), -0.3);
}

static void lamp_and_eye_may_change_places(void **state)
{
    const struct vec3 a = {0.3, 0.1, 0.2}, b = {-0.5, 0.4, -0.6};
    struct tally there, back;
    struct path_scene scene;
    struct still still;

    fill_two_media(&still);
    path_still_add_point(&still, a, 1.0);
    path_scene_init(&scene, &still, SCENE_ORDERS_ALL);
    there = measure_fluence(&scene, b, 1, 80000);
    path_scene_finish(&scene);
    still.lights[0].position = b;
    path_scene_init(&scene, &still, SCENE_ORDERS_ALL);
    back = measure_fluence(&scene, a, 2, 80000);
    path_scene_finish(&scene);
    print_message("there %.4f +- %.4f, back %.4f +- %.4f\n", there.mean, tally_find_error(&there), back.mean,
                  tally_find_error(&back));
    assert_by_chance(there.mean, hypot(tally_find_error(&there), tally_find_error(&back)), back.mean, 0.05, 0.0);
}

// The unscattered share of the lamp's light along a ray from it.
static double pass(const struct path_scene *scene, struct vec3 direction, double distance)
{
    const struct still *still = scene->still;
    struct ray ray = {still->lights[0].position, direction};
    double share[3];

    transmittance(still->media, still->medium_count, &ray, 0.0, distance, 1e-4, share);
    return share[0];
}

// What is absorbed on a random spot about the lamp, by its light and by what was scattered; lengths are even up to
// `farthest`.
static double absorb(const struct path_scene *scene, double farthest, struct stream *stream)
{
    const struct still *still = scene->still;
    struct vec3 way = random_direction(stream);
    double r = farthest * stream_draw(stream), absorption = 0.0;
    struct vec3 place = vec3_add(still->lights[0].position, vec3_scale(way, r));

    for (size_t m = 0; m < still->medium_count; m++) {
        const struct density *density = &still->media[m].density;

        absorption += still->media[m].sigma_a[0] * density->at(density->field, place);
    }
    if (absorption == 0.0) return 0.0;
    return absorption * 4.0 * M_PI * farthest * (pass(scene, way, r) + r * r * look_around(scene, place, stream));
}

// What leaves: unscattered, and by the radiance through a sphere around all.
static double leave(const struct path_scene *scene, double radius, struct stream *stream)
{
    struct vec3 outwards = random_direction(stream);
    const struct path_vertex window = {.position = vec3_scale(outwards, radius),
                                       .is_surface = true,
                                       .normal = vec3_scale(outwards, -1.0),
                                       .throughput = {1.0, 1.0, 1.0}};

    return 4.0 * M_PI * pass(scene, random_direction(stream), INFINITY) +
           4.0 * M_PI * radius * radius * M_PI * look_from(scene, &window, stream);
}

// The lamp sends 4 pi.
static void all_light_leaves_or_is_absorbed(void **state)
{
    const double radius = 2.0;
    struct tally tally = {0};
    struct path_scene scene;
    struct still still;

    fill_two_media(&still);
    path_still_add_point(&still, (struct vec3){0.1, 0.2, -0.1}, 1.0);
    path_scene_init(&scene, &still, SCENE_ORDERS_ALL);
    for (uint64_t i = 0; i < 30000; i++) {
        struct stream stream = stream_of(3, i);

        tally_add(&tally, absorb(&scene, 2.0 * radius, &stream) + leave(&scene, radius, &stream));
    }
    print_message("%.4f +- %.4f of what is sent\n", tally.mean / (4.0 * M_PI), tally_find_error(&tally) / (4.0 * M_PI));
    assert_by_chance(tally.mean / (4.0 * M_PI), tally_find_error(&tally) / (4.0 * M_PI), 1.0, 0.05, 0.0);
    path_scene_finish(&scene);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(white_media_vanish_in_even_light),
        cmocka_unit_test(white_surfaces_vanish_in_even_light),
        cmocka_unit_test(white_colors_vanish_in_the_mean),
        cmocka_unit_test(collisions_lie_where_theory_says),
        cmocka_unit_test(a_lamp_in_an_endless_medium_shines_as_theory_says),
        cmocka_unit_test(a_peak_s_reach_changes_no_light),
        cmocka_unit_test(a_half_space_reflects_as_chandrasekhar_says),
        cmocka_unit_test(lamp_and_eye_may_change_places),
        cmocka_unit_test(all_light_leaves_or_is_absorbed),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
