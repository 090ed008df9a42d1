// SPDX-License-Identifier: Apache-2.0
#include "reference/integrate.h"

#include "reference/closed_form.h"
#include "reference/phase_henyey_greenstein.h"
#include "tests/support/assert_near.h"
#include "tests/support/homogeneous.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const struct ray ALONG_Z = {{0.0, 0.0, -3.0}, {0.0, 0.0, 1.0}};
static const struct homogeneous_box SLAB = {INFINITY, INFINITY, 0.5}; // 1 m thick

static void fill(double color[static 3], double value)
{
    color[0] = color[1] = color[2] = value;
}

static struct still slab_still(double sigma_s, double sigma_a)
{
    struct still still = {.medium_count = 1};

    still.media[0].density = homogeneous_box_density(&SLAB);
    fill(still.media[0].sigma_s, sigma_s);
    fill(still.media[0].sigma_a, sigma_a);
    return still;
}

static void add_sun(struct still *still, struct vec3 direction, double irradiance)
{
    struct light *light = &still->lights[still->light_count++];

    light->kind = SCENE_LIGHT_SUN;
    light->direction = direction;
    fill(light->intensity, irradiance);
}

static void add_point(struct still *still, struct vec3 position, double intensity)
{
    struct light *light = &still->lights[still->light_count++];

    light->kind = SCENE_LIGHT_POINT;
    light->falloff = SCENE_FALLOFF_INVERSE_SQUARE;
    light->position = position;
    fill(light->intensity, intensity);
}

// The tolerance of each radiance is the default accuracy, 1e-4.
static void assert_radiance(const struct still *still, const struct ray *ray, double wanted)
{
    struct integrate_result result = integrate_ray(still, ray, 0.0, INFINITY, NULL);

    assert_true(result.is_converged);
    for (int c = 0; c < 3; c++)
        assert_near(result.radiance[c], wanted, 1e-4 * wanted);
}

static void glowing_slab_is_as_bright_as_its_closed_form(void **state)
{
    static const double SIGMA_A[] = {0.0, 1e-6, 1.0, 50.0, 1e4};

    for (size_t i = 0; i < sizeof SIGMA_A / sizeof SIGMA_A[0]; i++) {
        struct still still = slab_still(0.0, SIGMA_A[i]);

        fill(still.media[0].emission, 3.0);
        assert_radiance(&still, &ALONG_Z, closed_form_emission_slab(3.0, SIGMA_A[i], 1.0, 0.0));
    }
}

static void front_lit_slab_sends_light_backwards(void **state)
{
    static const double SIGMA_S[] = {1e-4, 1.0, 300.0};

    for (size_t i = 0; i < sizeof SIGMA_S / sizeof SIGMA_S[0]; i++) {
        struct still still = slab_still(SIGMA_S[i], 0.5);

        still.media[0].lobes[0].g = 0.6;
        still.media[0].lobes[0].weight = 1.0;
        still.media[0].lobe_count = 1;
        add_sun(&still, (struct vec3){0.0, 0.0, 1.0}, 7.0);
        assert_radiance(
            &still, &ALONG_Z,
            closed_form_front_lit_slab(SIGMA_S[i], SIGMA_S[i] + 0.5, 1.0, phase_henyey_greenstein(0.6, -1.0), 7.0));
    }
}

static void back_lit_slab_sends_light_forwards(void **state)
{
    struct still still = slab_still(2.0, 0.5);

    still.media[0].lobes[0].g = 0.6;
    still.media[0].lobes[0].weight = 1.0;
    still.media[0].lobe_count = 1;
    add_sun(&still, (struct vec3){0.0, 0.0, -1.0}, 7.0);
    assert_radiance(&still, &ALONG_Z, closed_form_back_lit_slab(2.0, 2.5, 1.0, phase_henyey_greenstein(0.6, 1.0), 7.0));
}

// The peak that the refinement must find is the narrower, the nearer the light is to the ray.
static void light_beside_a_ray_falls_with_the_square(void **state)
{
    static const double HEIGHTS[] = {1.0, 0.1, 1e-3, 1e-5, 1e-6};
    const double thin = 1e-7;

    for (size_t i = 0; i < sizeof HEIGHTS / sizeof HEIGHTS[0]; i++) {
        struct still still = slab_still(thin, 0.0);

        add_point(&still, (struct vec3){0.0, HEIGHTS[i], 0.13}, 5e9);
        assert_radiance(&still, &ALONG_Z,
                        thin * 5e9 / (4.0 * M_PI) * closed_form_inverse_square(HEIGHTS[i], 0.13, -0.5, 0.5));
    }
}

// All light that reaches the camera has crossed the dark slab once, before it was scattered or after.
static void lamp_behind_a_dark_slab_is_seen_at_any_accuracy(void **state)
{
    static const double DEPTHS[] = {6.0, 16.0, 24.0}, ACCURACIES[] = {0.05, 0.01, 1e-3, 1e-4};
    static const struct homogeneous_box wide = {INFINITY, INFINITY, 10.0};
    const double thin = 1e-7, height = 0.01;
    struct ray ray = {{0.0, 0.0, -10.0}, {0.0, 0.0, 1.0}};

    for (size_t i = 0; i < sizeof DEPTHS / sizeof DEPTHS[0]; i++) {
        struct still still = slab_still(0.0, DEPTHS[i]);
        double wanted =
            exp(-DEPTHS[i]) * thin * 5e9 / (4.0 * M_PI) * closed_form_inverse_square(height, 2.0, -10.0, 10.0);

        still.media[still.medium_count].density = homogeneous_box_density(&wide);
        fill(still.media[still.medium_count++].sigma_s, thin);
        add_point(&still, (struct vec3){0.0, height, 2.0}, 5e9);
        for (size_t k = 0; k < sizeof ACCURACIES / sizeof ACCURACIES[0]; k++) {
            struct integrate_accuracy accuracy = {.relative = ACCURACIES[k], .floor = 0.1 * wanted};
            struct integrate_result result = integrate_ray(&still, &ray, 0.0, INFINITY, &accuracy);

            assert_true(result.is_converged);
            assert_near(result.radiance[0], wanted, ACCURACIES[k] * wanted);
        }
    }
}

// The slab extends 10 m beyond the light, all of it behind the light as seen from the ray.
static void shadows_end_at_the_light(void **state)
{
    struct homogeneous_box thick = {INFINITY, INFINITY, 10.0};
    struct still still = {.medium_count = 1};
    double toward, away;

    still.media[0].density = homogeneous_box_density(&thick);
    fill(still.media[0].sigma_s, 1.0);
    add_point(&still, (struct vec3){0.0, 0.0, -8.0}, 1.0);
    still.lights[0].falloff = SCENE_FALLOFF_NONE;
    // The ray is one metre long, the light one metre before its start: T T_light = exp(-t) exp(-(t + 1)).
    toward = integrate_ray(&still, &(struct ray){{0.0, 0.0, -7.0}, {0.0, 0.0, 1.0}}, 0.0, 1.0, NULL).radiance[0];
    assert_near(toward, exp(-1.0) * (1.0 - exp(-2.0)) / 2.0 / (4.0 * M_PI), 1e-4 * toward);
    // The opposite ray ends one metre short of the light: T T_light = exp(-t) exp(-(2 - t)).
    away = integrate_ray(&still, &(struct ray){{0.0, 0.0, -6.0}, {0.0, 0.0, -1.0}}, 0.0, 1.0, NULL).radiance[0];
    assert_near(away, exp(-2.0) / (4.0 * M_PI), 1e-4 * away);
}

static void clips_bound_the_gathering_not_the_shadows(void **state)
{
    struct still still = slab_still(1.0, 0.0);
    struct integrate_result result;

    add_sun(&still, (struct vec3){0.0, 0.0, 1.0}, 1.0);
    // The last half metre of the slab counts: its light has crossed the first half, the camera's ray has not.
    result = integrate_ray(&still, &ALONG_Z, 3.0, 3.5, NULL);
    assert_near(result.radiance[0], exp(-0.5) * (1.0 - exp(-1.0)) / 2.0 / (4.0 * M_PI), 1e-5);
    assert_near(result.transmittance[0], exp(-0.5), 1e-4);
}

static void colors_are_gathered_apart(void **state)
{
    struct still still = slab_still(0.0, 0.0);
    struct integrate_result result;

    for (int c = 0; c < 3; c++)
        still.media[0].sigma_s[c] = c + 1.0;
    add_sun(&still, (struct vec3){0.0, 0.0, -1.0}, 1.0);
    still.lights[0].intensity[2] = 5.0;
    result = integrate_ray(&still, &ALONG_Z, 0.0, INFINITY, NULL);
    for (int c = 0; c < 3; c++) {
        double wanted = closed_form_back_lit_slab(c + 1.0, c + 1.0, 1.0, 1.0 / (4.0 * M_PI), c == 2 ? 5.0 : 1.0);

        assert_near(result.radiance[c], wanted, 1e-4 * wanted);
        assert_near(result.transmittance[c], exp(-(c + 1.0)), 1e-4);
    }
}

static void media_and_lights_add(void **state)
{
    struct still one = slab_still(2.0, 1.0), two = slab_still(1.5, 0.25);
    double wanted;

    fill(one.media[0].emission, 0.5);
    add_sun(&one, (struct vec3){0.0, 0.0, -1.0}, 3.0);
    fill(two.media[0].emission, 0.5);
    two.media[1] = slab_still(0.5, 0.75).media[0];
    two.medium_count = 2;
    add_sun(&two, (struct vec3){0.0, 0.0, -1.0}, 1.0);
    add_sun(&two, (struct vec3){0.0, 0.0, -1.0}, 2.0);
    wanted = closed_form_emission_slab(0.5, 3.0, 1.0, 0.0) + closed_form_back_lit_slab(2.0, 3.0, 1.0, 0.25 / M_PI, 3.0);
    assert_radiance(&one, &ALONG_Z, wanted);
    assert_radiance(&two, &ALONG_Z, wanted);
}

// Power that leaves a sphere of radius 1 in all directions, relative to the power of the sun that falls on it.
static double scattered_share(double sigma_s, double g)
{
    enum { POLAR = 10, RADIAL = 8, AROUND = 8 };
    struct homogeneous_sphere sphere = {1.0};
    struct still still = {.medium_count = 1};
    double sum = 0.0;

    still.media[0].density = homogeneous_sphere_density(&sphere);
    fill(still.media[0].sigma_s, sigma_s);
    still.media[0].lobes[0].g = g;
    still.media[0].lobes[0].weight = 1.0;
    still.media[0].lobe_count = 1;
    add_sun(&still, (struct vec3){0.0, 0.0, 1.0}, 1.0);
    for (int i = 0; i < POLAR * RADIAL * AROUND; i++) {
        double cosine = -1.0 + 2.0 * (i / (RADIAL * AROUND) + 0.5) / POLAR, sine = sqrt(1.0 - cosine * cosine);
        double radius = sqrt((i / AROUND % RADIAL + 0.5) / RADIAL), angle = 2.0 * M_PI * (i % AROUND + 0.5) / AROUND;
        struct vec3 out = {sine, 0.0, cosine}, across = {cosine, 0.0, -sine}, side = {0.0, 1.0, 0.0};
        struct vec3 start = vec3_add(vec3_scale(out, 2.0), vec3_add(vec3_scale(across, radius * cos(angle)),
                                                                    vec3_scale(side, radius * sin(angle))));
        struct ray ray = {start, vec3_scale(out, -1.0)};

        sum += integrate_ray(&still, &ray, 0.0, INFINITY, &(struct integrate_accuracy){.relative = 1e-3}).radiance[0];
    }
    // Each of the rays stands for an equal part of 4 pi directions times the sphere's cross-section.
    return 4.0 * M_PI * sum / (POLAR * RADIAL * AROUND);
}

static void no_more_light_leaves_than_arrives(void **state)
{
    assert_true(scattered_share(0.5, 0.0) <= 1.0);
    assert_true(scattered_share(5.0, 0.3) <= 1.0);
    assert_true(scattered_share(100.0, 0.0) <= 1.0);
}

static void thin_medium_sends_out_all_it_scatters(void **state)
{
    // The ratio is the volume 4 pi / 3 over the cross-section pi; 1 %: the directions and rays are few.
    assert_near(scattered_share(1e-4, 0.3) / (1e-4 * 4.0 / 3.0), 1.0, 0.01);
}

static void refinement_says_when_it_was_stopped_short(void **state)
{
    struct still still = slab_still(0.0, 1e4);
    struct integrate_accuracy accuracy = {.halving_limit = 2};

    fill(still.media[0].emission, 3.0);
    assert_false(integrate_ray(&still, &ALONG_Z, 0.0, INFINITY, &accuracy).is_converged);
}

// A layer whose density falls linearly from its middle, in a span that ends outside of it.
struct ridge {
    double middle, half;
    double begin, end; // of the span, along ALONG_Z
};

static double ridge_at(const void *field, struct vec3 position)
{
    const struct ridge *ridge = field;

    return fmax(1.0 - fabs(position.z - ridge->middle) / ridge->half, 0.0);
}

static void ridge_spans(const void *field, const struct ray *ray, double near, double far, struct span_list *spans)
{
    const struct ridge *ridge = field;

    span_list_append(spans, fmax(near, ridge->begin), fmin(far, ridge->end), NULL);
}

static void add_ridge(struct still *still, const struct ridge *ridge, double sigma_a, double emission)
{
    struct medium *medium = &still->media[still->medium_count++];

    medium->density = (struct density){.field = ridge, .at = ridge_at, .spans = ridge_spans};
    fill(medium->sigma_a, sigma_a);
    fill(medium->emission, emission);
}

// The kinks are not ends of spans: two halvings may agree by accident before one that does not.
static void kinks_cost_no_accuracy(void **state)
{
    for (double half = 0.06; half < 0.16; half += 0.01) {
        struct ridge ridge = {0.0, half, 2.5, 3.5};
        struct still still = {.medium_count = 0};

        add_ridge(&still, &ridge, 0.0, 3.0);
        assert_radiance(&still, &ALONG_Z, 3.0 * half);
    }
}

// The first estimate in cells this thick is too bright by powers of ten. It must not leave the thin ridge in front
// unrefined.
static void wrong_guess_of_the_radiance_costs_no_accuracy(void **state)
{
    struct ridge thick = {0.0, 0.45, 2.5, 3.5}, thin = {-1.0, 0.2, 1.7, 2.45};
    struct still still = {.medium_count = 0};

    add_ridge(&still, &thick, 2000.0, 2000.0);
    add_ridge(&still, &thin, 0.0, 3.0);
    assert_radiance(&still, &ALONG_Z, 1.0 + 3.0 * 0.2);
}

static void light_near_the_ray_is_found_beside_a_bright_glow(void **state)
{
    const double thin = 1e-7, height = 1e-8, glow = 1e8;
    struct still still = slab_still(thin, 0.0);

    fill(still.media[0].emission, glow);
    add_point(&still, (struct vec3){0.0, height, 0.13}, 5e7);
    assert_radiance(&still, &ALONG_Z,
                    glow + thin * 5e7 / (4.0 * M_PI) * closed_form_inverse_square(height, 0.13, -0.5, 0.5));
}

// The medium emits nothing, so that only the transmittance asks for refinement. The density is a root, which converges
// slowly by Gauss' rule.
static void black_medium_transmits_by_its_optical_depth(void **state)
{
    struct density_fold_fractal fractal;
    struct still still = {.medium_count = 1};
    struct integrate_result result;
    double column = 2.0 * pow(0.5, 1.5) / 1.5;

    density_fold_fractal_init(
        &fractal, &(struct density_fold_fractal_params){.iterations = 1, .radius = 0.5, .exponent = 0.5, .scale = 1.0});
    still.media[0].density = still_fractal_density(&fractal);
    fill(still.media[0].sigma_a, 2.0);
    result = integrate_ray(&still, &ALONG_Z, 0.0, INFINITY, NULL);
    assert_near(result.transmittance[0], exp(-2.0 * column), 1e-4);
}

static void empty_ray_is_black_and_clear(void **state)
{
    struct still still = slab_still(1.0, 1.0);
    struct ray aside = {{0.0, 0.0, -3.0}, {1.0, 0.0, 0.0}};
    struct integrate_result result = integrate_ray(&still, &aside, 0.0, INFINITY, NULL);

    assert_true(result.radiance[0] == 0.0 && result.transmittance[0] == 1.0 && result.is_converged);
}

// The light passes an optical depth of 12 before the camera. It is all that there is.
static void light_deep_inside_counts_at_every_accuracy(void **state)
{
    static const double ASKED[] = {0.05, 0.01, 1e-3};
    struct still still = slab_still(2.0, 22.0);
    const struct ray beside = {{0.02, 0.0, -3.0}, {0.0, 0.0, 1.0}};
    double wanted;

    add_point(&still, (struct vec3){0.0, 0.0, 0.0}, 60.0);
    wanted = integrate_ray(&still, &beside, 0.0, INFINITY, &(struct integrate_accuracy){1e-5, 1e-12, 0}).radiance[0];
    assert_true(wanted > 1e-6 && wanted < 1e-2);
    for (int i = 0; i < 3; i++) {
        const struct integrate_accuracy accuracy = {.relative = ASKED[i], .floor = 0.1 * wanted};

        assert_near(integrate_ray(&still, &beside, 0.0, INFINITY, &accuracy).radiance[0], wanted, ASKED[i] * wanted);
    }
}

static void closed_forms_hold_at_every_accuracy(void **state)
{
    static const double ASKED[] = {0.05, 0.01, 1e-3, 1e-5, 1e-7};

    for (double sigma_s = 0.1; sigma_s < 100.0; sigma_s *= 3.0) {
        struct still still = slab_still(sigma_s, 0.5);
        double wanted;

        add_sun(&still, (struct vec3){0.0, 0.0, 1.0}, 7.0);
        wanted = closed_form_front_lit_slab(sigma_s, sigma_s + 0.5, 1.0, 0.25 / M_PI, 7.0);
        for (int i = 0; i < 5; i++) {
            const struct integrate_accuracy accuracy = {.relative = ASKED[i]};
            struct integrate_result result = integrate_ray(&still, &ALONG_Z, 0.0, INFINITY, &accuracy);

            assert_true(result.is_converged);
            assert_near(result.radiance[0], wanted, ASKED[i] * wanted);
            assert_near(result.transmittance[0], exp(-sigma_s - 0.5), ASKED[i]);
        }
    }
}

// Grains that absorb nothing: how finely they are searched for has to follow from their light alone.
static void glowing_grains_are_all_found(void **state)
{
    const int count = 20000;
    const struct density_noise_params params = {.octaves = 2,
                                                .frequency = 4.0,
                                                .mode = SCENE_NOISE_CLIP,
                                                .lacunarity = 2.0,
                                                .hurst = 1.0,
                                                .axis = {0.0, 1.0, 0.0},
                                                .scale = 1.0};
    struct density_noise noise;
    struct still still = {.medium_count = 1};

    density_noise_init(&noise, &params);
    still.media[0].density = density_noise_field(&noise);
    fill(still.media[0].emission, 2.0);
    for (int i = 0; i < 50; i++) {
        struct ray ray = {{0.1 * i, 0.3, -1.0}, {0.6, 0.0, 0.8}};
        double sum = 0.0;

        for (int k = 0; k < count; k++)
            sum += density_noise(&noise, ray_at(&ray, 3.0 * (k + 0.5) / count)) * 3.0 / count;
        // 2e-6: the error of the sum.
        assert_near(integrate_ray(&still, &ray, 0.0, 3.0, NULL).radiance[0], 2.0 * sum, 1e-4 * sum + 2e-6);
    }
}

// One argument: the tests to run, by a pattern.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(glowing_slab_is_as_bright_as_its_closed_form),
        cmocka_unit_test(front_lit_slab_sends_light_backwards),
        cmocka_unit_test(back_lit_slab_sends_light_forwards),
        cmocka_unit_test(light_beside_a_ray_falls_with_the_square),
        cmocka_unit_test(lamp_behind_a_dark_slab_is_seen_at_any_accuracy),
        cmocka_unit_test(shadows_end_at_the_light),
        cmocka_unit_test(clips_bound_the_gathering_not_the_shadows),
        cmocka_unit_test(colors_are_gathered_apart),
        cmocka_unit_test(media_and_lights_add),
        cmocka_unit_test(no_more_light_leaves_than_arrives),
        cmocka_unit_test(thin_medium_sends_out_all_it_scatters),
        cmocka_unit_test(refinement_says_when_it_was_stopped_short),
        cmocka_unit_test(kinks_cost_no_accuracy),
        cmocka_unit_test(light_near_the_ray_is_found_beside_a_bright_glow),
        cmocka_unit_test(wrong_guess_of_the_radiance_costs_no_accuracy),
        cmocka_unit_test(black_medium_transmits_by_its_optical_depth),
        cmocka_unit_test(empty_ray_is_black_and_clear),
        cmocka_unit_test(light_deep_inside_counts_at_every_accuracy),
        cmocka_unit_test(glowing_grains_are_all_found),
        cmocka_unit_test(closed_forms_hold_at_every_accuracy),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
