// SPDX-License-Identifier: Apache-2.0
#include "reference/spot_edges.h"

#include "reference/integrate.h"
#include "tests/support/assert_near.h"
#include "tests/support/homogeneous.h"
#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static struct vec3 random_vector(struct random *random, double size)
{
    double x = random_between(random, -size, size), y = random_between(random, -size, size);

    return (struct vec3){x, y, random_between(random, -size, size)};
}

static double angle_at(const struct light *spot, const struct ray *ray, double distance)
{
    struct vec3 away = vec3_subtract(ray_at(ray, distance), spot->position);

    return atan2(vec3_length(vec3_cross(away, spot->direction)), vec3_dot(away, spot->direction));
}

static struct light random_spot(struct random *random)
{
    return (struct light){.kind = SCENE_LIGHT_SPOT,
                          .position = random_vector(random, 1.0),
                          .direction = vec3_normalize(random_vector(random, 1.0)),
                          .outer = random_between(random, 0.01, 0.5 * M_PI)};
}

// Between neighbouring ends the ray stays in the inner cone, between the two, or outside.
static void no_cone_is_crossed_between_ends(void **state)
{
    struct random random = {41};
    int crossed = 0;

    for (int i = 0; i < 2000; i++) {
        struct light spot = random_spot(&random);
        struct ray ray = {random_vector(&random, 1.0), vec3_normalize(random_vector(&random, 1.0))};
        struct span_list spans = {0};

        spot.inner = random_between(&random, 0.3, 1.0) * spot.outer;
        span_list_append(&spans, -10.0, 10.0, NULL);
        spot_edges_split(&spot, &ray, &spans);
        crossed += (int)spans.count - 1;
        for (size_t k = 0; k < spans.count; k++) {
            double begin = spans.spans[k].begin, end = spans.spans[k].end;
            double first = angle_at(&spot, &ray, begin + 1e-6 * (end - begin));

            for (int step = 1; step < 50; step++) {
                double angle = angle_at(&spot, &ray, begin + (end - begin) * step / 50.0);

                assert_true((angle < spot.inner) == (first < spot.inner));
                assert_true((angle < spot.outer) == (first < spot.outer));
            }
        }
        span_list_finish(&spans);
    }
    assert_true(crossed > 2000);
}

// What is left of a stretch is all that the spot lights of it.
static void a_stretch_is_clipped_to_the_cone(void **state)
{
    struct random random = {43};
    int lit = 0;

    for (int i = 0; i < 2000; i++) {
        struct light spot = random_spot(&random);
        struct ray ray = {random_vector(&random, 1.0), vec3_normalize(random_vector(&random, 1.0))};
        double near = random_between(&random, -3.0, 0.0), far = random_between(&random, 0.0, 3.0);
        double begin = near, end = far;
        bool is_lit = spot_edges_clip(&spot, &ray, &begin, &end);

        lit += is_lit;
        for (int step = 1; step < 100; step++) {
            double at = near + (far - near) * step / 100.0, off = angle_at(&spot, &ray, at) - spot.outer;

            if (fabs(off) > 1e-9) assert_true((off < 0.0) == (is_lit && at > begin && at < end));
        }
    }
    assert_true(lit > 300 && lit < 1900);
}

// Across a narrow beam in a thin slab, and far from the lamp, the light is sigma_s p I times the integral of the share
// over the distance, over the height's square: with s = x / height the share is smoothstep of s, whose integral is that
// of a step at the middle.
static void narrow_beam_in_a_wide_slab_is_found(void **state)
{
    static const struct homogeneous_box slab = {INFINITY, INFINITY, 400.0};
    struct still still = {.medium_count = 1, .light_count = 1};
    struct ray ray = {{0.0, 0.0, -300.0}, {0.0, 0.0, 1.0}};
    const double inner = 1e-4, outer = 3e-4, height = 5.0;
    struct integrate_result result;

    still.media[0].density = homogeneous_box_density(&slab);
    still.lights[0] = (struct light){.kind = SCENE_LIGHT_SPOT,
                                     .falloff = SCENE_FALLOFF_INVERSE_SQUARE,
                                     .position = {0.0, height, 17.3},
                                     .direction = {0.0, -1.0, 0.0},
                                     .inner = inner,
                                     .outer = outer};
    for (int c = 0; c < 3; c++) {
        still.media[0].sigma_s[c] = 1e-7;
        still.lights[0].intensity[c] = 5e9;
    }
    result = integrate_ray(&still, &ray, 0.0, INFINITY, NULL);
    assert_true(result.is_converged);
    assert_near(result.radiance[0], 1e-7 * 5e9 / (4.0 * M_PI) * (inner + outer) / height, 1e-4 * result.radiance[0]);
    assert_true(result.radiance[0] > 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_cone_is_crossed_between_ends),
        cmocka_unit_test(a_stretch_is_clipped_to_the_cone),
        cmocka_unit_test(narrow_beam_in_a_wide_slab_is_found),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
