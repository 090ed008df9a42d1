// SPDX-License-Identifier: Apache-2.0
#include "reference/rough.h"

#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { DRAWS = 20000 };

static const struct vec3 NORMAL = {0.48, 0.6, -0.64};

// No normal is rejected where the ray comes along the normal; the mean of (1 + r z) / sqrt(1 + 2 r z + r^2) over z in
// [-1, 1] is 1 - r^2 / 3.
static void normals_lean_as_far_as_they_should(void **state)
{
    for (int i = 1; i <= 10; i++) {
        struct rough_random random = {(uint64_t)i};
        struct vec3 sum = {0.0, 0.0, 0.0};
        double roughness = 0.1 * i, cosine;

        for (int k = 0; k < DRAWS; k++) {
            struct vec3 normal = rough_normal(&random, NORMAL, vec3_scale(NORMAL, -1.0), roughness);

            assert_near(vec3_length(normal), 1.0, 1e-14);
            assert_true(vec3_dot(normal, NORMAL) > 0.0);
            sum = vec3_add(sum, normal);
        }
        cosine = vec3_dot(sum, NORMAL) / DRAWS;
        // The tolerance is four standard errors of a number that has a deviation of up to 0.3.
        assert_near(cosine, 1.0 - roughness * roughness / 3.0, 4.0 * 0.3 / sqrt(DRAWS));
        // The mean normal leans to no side.
        assert_near(vec3_length(vec3_subtract(vec3_scale(sum, 1.0 / DRAWS), vec3_scale(NORMAL, cosine))), 0.0, 0.02);
    }
}

static void normals_face_the_ray(void **state)
{
    const struct vec3 side = vec3_normalize(vec3_cross(NORMAL, (struct vec3){1.0, 0.0, 0.0}));
    const struct vec3 grazing = vec3_normalize(vec3_add(side, vec3_scale(NORMAL, -0.01)));
    struct rough_random random = {3};

    for (int k = 0; k < DRAWS; k++)
        assert_true(vec3_dot(rough_normal(&random, NORMAL, grazing, 0.7), grazing) < 0.0);
}

static void smooth_surfaces_draw_nothing(void **state)
{
    struct rough_random random = {3};
    struct vec3 normal = rough_normal(&random, NORMAL, vec3_scale(NORMAL, -1.0), 0.0);

    assert_near(vec3_length(vec3_subtract(normal, NORMAL)), 0.0, 0.0);
    assert_int_equal(random.state, 3);
}

static void directions_are_kept_on_their_side(void **state)
{
    const struct vec3 side = vec3_normalize(vec3_cross(NORMAL, (struct vec3){1.0, 0.0, 0.0}));
    const struct vec3 out = vec3_add(vec3_scale(side, 0.8), vec3_scale(NORMAL, 0.6));
    const struct vec3 in = vec3_add(vec3_scale(side, 0.8), vec3_scale(NORMAL, -0.6));

    assert_near(vec3_length(vec3_subtract(rough_keep_side(out, NORMAL, 1.0), out)), 0.0, 0.0);
    assert_near(vec3_length(vec3_subtract(rough_keep_side(in, NORMAL, 1.0), out)), 0.0, 1e-15);
    assert_near(vec3_length(vec3_subtract(rough_keep_side(in, NORMAL, -1.0), in)), 0.0, 0.0);
    assert_near(vec3_length(vec3_subtract(rough_keep_side(out, NORMAL, -1.0), in)), 0.0, 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normals_lean_as_far_as_they_should),
        cmocka_unit_test(normals_face_the_ray),
        cmocka_unit_test(smooth_surfaces_draw_nothing),
        cmocka_unit_test(directions_are_kept_on_their_side),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
