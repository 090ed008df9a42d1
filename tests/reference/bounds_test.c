// SPDX-License-Identifier: Apache-2.0
#include "reference/bounds.h"

#include "reference/closed_form.h"
#include "reference/density_bounded.h"
#include "reference/density_homogeneous.h"
#include "reference/integrate.h"
#include "reference/transmittance.h"
#include "tests/support/assert_near.h"
#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const struct bounds SPHERE = {.kind = SCENE_BOUNDS_SPHERE, .center = {0.3, -0.2, 0.1}, .radius = 1.2};
static const struct bounds BOX = {.kind = SCENE_BOUNDS_BOX, .center = {0.1, 0.2, -0.3}, .half = {0.5, 1.0, 0.7}};
static const struct bounds SLAB = {
    .kind = SCENE_BOUNDS_SLAB, .center = {0.0, 0.4, 0.0}, .normal = {0.6, 0.0, 0.8}, .half_thickness = 0.4};
static const struct density_homogeneous ONE = {1.0};

static struct bounds with_falloff(struct bounds bounds, double falloff)
{
    bounds.falloff = falloff;
    return bounds;
}

static struct vec3 random_point(struct random *random, double reach)
{
    struct vec3 point;

    point.x = random_between(random, -reach, reach);
    point.y = random_between(random, -reach, reach);
    point.z = random_between(random, -reach, reach);
    return point;
}

static struct ray random_ray(struct random *random)
{
    struct vec3 origin = random_point(random, 2.5);

    return (struct ray){origin, vec3_normalize(vec3_subtract(random_point(random, 1.0), origin))};
}

static void a_clipped_ray_is_what_lies_inside(void **state)
{
    const struct bounds all[] = {SPHERE, BOX, SLAB};
    struct random random = {11};
    int hits = 0;

    for (int i = 0; i < 3000; i++) {
        const struct bounds *bounds = &all[i % 3];
        struct ray ray = random_ray(&random);
        double near = random_between(&random, 0.0, 1.0), far = i % 2 ? INFINITY : near + 2.0, at;
        double begin = near, end = far;
        bool hit = bounds_clip(bounds, &ray, &begin, &end);

        for (int k = 0; k < 20; k++) {
            at = random_between(&random, near, fmin(far, 6.0));
            // The bounds are convex: the ray is inside exactly from begin to end.
            if (fabs(bounds_depth(bounds, ray_at(&ray, at))) < 1e-9) continue;
            assert_true((bounds_depth(bounds, ray_at(&ray, at)) > 0.0) == (hit && begin < at && at < end));
            hits += hit && begin < at && at < end;
        }
        if (hit && begin > near) assert_near(bounds_depth(bounds, ray_at(&ray, begin)), 0.0, 1e-12);
        if (hit && end < far) assert_near(bounds_depth(bounds, ray_at(&ray, end)), 0.0, 1e-12);
    }
    assert_true(hits > 5000);
}

static void rays_along_a_face_stay_on_their_side(void **state)
{
    struct ray inside = {{-3.0, 1.19, 0.0}, {1.0, 0.0, 0.0}}, outside = {{-3.0, 1.21, 0.0}, {1.0, 0.0, 0.0}};
    struct ray in_slab = {{0.0, 0.0, 0.49}, {0.0, 1.0, 0.0}}, beside_slab = {{0.0, 0.0, 0.51}, {0.0, 1.0, 0.0}};
    double near = 0.0, far = INFINITY;

    assert_true(bounds_clip(&BOX, &inside, &near, &far));
    assert_near(far - near, 1.0, 1e-15);
    near = 0.0, far = INFINITY;
    assert_false(bounds_clip(&BOX, &outside, &near, &far));
    near = 0.0, far = INFINITY;
    assert_true(bounds_clip(&SLAB, &in_slab, &near, &far));
    assert_true(near == 0.0 && isinf(far));
    near = 0.0, far = INFINITY;
    assert_false(bounds_clip(&SLAB, &beside_slab, &near, &far));
}

static void depth_is_the_distance_to_the_nearest_face(void **state)
{
    assert_near(bounds_depth(&SPHERE, (struct vec3){0.3, 0.8, 0.1}), 0.2, 1e-15);
    assert_near(bounds_depth(&BOX, (struct vec3){0.1, 0.2, -0.3}), 0.5, 1e-15);
    assert_near(bounds_depth(&BOX, (struct vec3){0.1, 1.1, -0.3}), 0.1, 1e-15);
    assert_near(bounds_depth(&BOX, (struct vec3){0.1, 0.2, -0.95}), 0.05, 1e-15);
    assert_near(bounds_depth(&BOX, (struct vec3){0.7, 0.2, -0.3}), -0.1, 1e-15);
    assert_near(bounds_depth(&SLAB, (struct vec3){0.18, 7.0, 0.24}), 0.1, 1e-15);
}

static void falloff_is_a_smoothstep_of_the_depth(void **state)
{
    struct bounds sphere = with_falloff(SPHERE, 0.4);

    assert_near(bounds_weight(&sphere, (struct vec3){0.3, 0.59, 0.1}), 1.0, 0.0);
    assert_near(bounds_weight(&sphere, (struct vec3){0.3, 0.8, 0.1}), 0.5, 1e-15);
    // A quarter of the falloff gives 3/16 - 2/64.
    assert_near(bounds_weight(&sphere, (struct vec3){0.3, 0.9, 0.1}), 0.15625, 1e-15);
    assert_near(bounds_weight(&sphere, (struct vec3){0.3, 1.01, 0.1}), 0.0, 0.0);
    assert_near(bounds_weight(&SPHERE, (struct vec3){0.3, 0.99, 0.1}), 1.0, 0.0);
}

// Sums by the midpoint rule with a million points, over the whole ray.
static double summed_column(const struct bounds *bounds, const struct ray *ray)
{
    const int count = 1000000;
    const double length = 8.0;
    double sum = 0.0;

    for (int i = 0; i < count; i++)
        sum += bounds_weight(bounds, ray_at(ray, (i + 0.5) * length / count));
    return sum * length / count;
}

static void columns_agree_with_plain_sums(void **state)
{
    // The last box falls off over more than its own depth.
    const struct bounds all[] = {with_falloff(SPHERE, 0.5), with_falloff(BOX, 0.3),  with_falloff(SLAB, 0.2),
                                 with_falloff(SPHERE, 1.5), with_falloff(SLAB, 0.7), with_falloff(BOX, 2.0)};
    struct random random = {12};
    double largest = 0.0;

    for (int i = 0; i < 18; i++) {
        struct density_bounded bounded = {density_homogeneous(&ONE), all[i % 6]};
        struct density density = density_bounded(&bounded);
        struct ray ray = random_ray(&random);
        double column;

        // A ray nearly parallel to the slab stays in it for longer than the sums go.
        if (all[i % 6].kind == SCENE_BOUNDS_SLAB && fabs(vec3_dot(ray.direction, SLAB.normal)) < 0.3) continue;
        column = transmittance_density_column(&density, &ray, 0.0, INFINITY, 1e-9);
        // 1e-8: the accuracy asked for, and sums of second order with steps of 8e-6.
        assert_near(column, summed_column(&all[i % 6], &ray), 1e-8);
        largest = fmax(largest, column);
    }
    assert_true(largest > 0.5);
}

static void even_columns_are_closed(void **state)
{
    struct density_bounded sphere = {density_homogeneous(&ONE), SPHERE}, slab = {density_homogeneous(&ONE), SLAB};
    struct ray past = {{0.3 + 0.5, -0.2, -5.0}, {0.0, 0.0, 1.0}};
    struct density densities[] = {density_bounded(&sphere), density_bounded(&slab)};

    assert_non_null(densities[0].column);
    assert_near(transmittance_density_column(&densities[0], &past, 0.0, INFINITY, 1.0),
                closed_form_sphere_chord(1.2, 0.5), 1e-14);
    assert_near(transmittance_density_column(&densities[0], &past, 5.1, 5.2, 1.0), 0.1, 1e-14);
    assert_near(transmittance_density_column(&densities[0], &past, 7.0, 9.0, 1.0), 0.0, 0.0);
    assert_near(transmittance_density_column(&densities[1], &past, 0.0, INFINITY, 1.0),
                closed_form_slab_length(0.8, 0.8), 1e-14);
}

static void fill(double color[static 3], double value)
{
    color[0] = color[1] = color[2] = value;
}

// The medium is everywhere, along an infinite ray: if it glows as it absorbs, radiance tends to source / extinction.
static void endless_fog_hides_what_is_behind(void **state)
{
    struct ray ray = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
    struct still still = {.medium_count = 1};
    struct integrate_result result;

    still.media[0].density = density_homogeneous(&ONE);
    fill(still.media[0].sigma_a, 0.02);
    still.media[0].sigma_a[2] = 0.0;
    still.media[0].emission[0] = 0.06;
    result = integrate_ray(&still, &ray, 1.0, INFINITY, NULL);
    assert_true(result.is_converged);
    assert_near(result.radiance[0], 3.0, 3e-4);
    assert_near(result.radiance[1], 0.0, 0.0);
    assert_near(result.transmittance[1], 0.0, 1e-12);
    assert_near(result.transmittance[2], 1.0, 0.0);
}

// A light stands 2 m before the camera in fog without end: T T_light = exp(-t) exp(-|2 - t|), and no falloff.
static void endless_fog_is_lit_from_within(void **state)
{
    struct ray ray = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
    struct still still = {.medium_count = 1, .light_count = 1};
    struct integrate_result result;
    double wanted = (2.0 * exp(-2.0) + exp(-2.0) / 2.0) / (4.0 * M_PI);

    still.media[0].density = density_homogeneous(&ONE);
    fill(still.media[0].sigma_s, 1.0);
    still.lights[0] =
        (struct light){.falloff = SCENE_FALLOFF_NONE, .intensity = {1.0, 1.0, 1.0}, .position = {0.0, 0.0, 2.0}};
    result = integrate_ray(&still, &ray, 0.0, INFINITY, NULL);
    assert_true(result.is_converged);
    assert_near(result.radiance[0], wanted, 1e-4 * wanted);
}

static void no_sunlight_reaches_into_endless_fog(void **state)
{
    struct ray ray = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
    struct still still = {.medium_count = 1, .light_count = 1};

    still.media[0].density = density_homogeneous(&ONE);
    fill(still.media[0].sigma_s, 1.0);
    still.lights[0] =
        (struct light){.kind = SCENE_LIGHT_SUN, .intensity = {1.0, 1.0, 1.0}, .direction = {0.0, -1.0, 0.0}};
    assert_near(integrate_ray(&still, &ray, 0.0, INFINITY, NULL).radiance[0], 0.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_clipped_ray_is_what_lies_inside),
        cmocka_unit_test(rays_along_a_face_stay_on_their_side),
        cmocka_unit_test(depth_is_the_distance_to_the_nearest_face),
        cmocka_unit_test(falloff_is_a_smoothstep_of_the_depth),
        cmocka_unit_test(columns_agree_with_plain_sums),
        cmocka_unit_test(even_columns_are_closed),
        cmocka_unit_test(endless_fog_hides_what_is_behind),
        cmocka_unit_test(endless_fog_is_lit_from_within),
        cmocka_unit_test(no_sunlight_reaches_into_endless_fog),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
