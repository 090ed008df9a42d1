// Media in the shadows of objects: the light that a thin medium scatters measures the length of the lit parts of a ray.
// SPDX-License-Identifier: Apache-2.0
#include "reference/shadow_edges.h"

#include "reference/closed_form.h"
#include "reference/integrate.h"
#include "tests/support/assert_near.h"
#include "tests/support/homogeneous.h"
#include "tests/support/random.h"
#include "tests/support/solid_still.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const double THIN = 1e-11; // per metre: attenuates by less than any tolerance here
static const struct ray ALONG_X = {{-20.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
enum { LENGTH = 40 };

static void init_thin(struct still *still, const struct shape *shapes, size_t count)
{
    // The medium is a sheet around the ray, because an endless medium would let no sunlight in.
    static const struct homogeneous_box sheet = {INFINITY, 0.1, INFINITY};
    const struct material silver = solid_mirror(1.0);

    solid_still_init(still);
    for (size_t i = 0; i < count; i++)
        solid_still_add(still, &silver, &shapes[i], 1);
    solid_still_fill(still, 0, THIN, 0.0)->density = homogeneous_box_density(&sheet);
}

static void add_sun(struct still *still, struct vec3 travel)
{
    still->lights[still->light_count++] =
        (struct light){.kind = SCENE_LIGHT_SUN, .intensity = {1.0, 1.0, 1.0}, .direction = vec3_normalize(travel)};
}

static void add_lamp(struct still *still, struct vec3 position)
{
    still->lights[still->light_count++] =
        (struct light){.falloff = SCENE_FALLOFF_NONE, .intensity = {1.0, 1.0, 1.0}, .position = position};
}

// Length of the lit parts of the ray, in metres.
static double lit_length(const struct still *still)
{
    const struct integrate_accuracy accuracy = {.floor = 1e-16};
    struct integrate_stretch stretch = {.ray = ALONG_X, .far = LENGTH};
    struct integrate_result result = integrate_stretch(still, &stretch, &accuracy);

    assert_true(result.is_converged);
    return result.radiance[0] * 4.0 * M_PI / THIN;
}

// 1e-7: the ends are where shadows end; between them the integrand is smooth.
static void assert_lit(const struct still *still, double wanted)
{
    assert_near(lit_length(still), wanted, 1e-7);
}

static void balls_cast_round_shadows(void **state)
{
    struct random random = {4};

    for (int i = 0; i < 200; i++) {
        double radius = random_between(&random, 0.001, 1.0), aside = random_between(&random, -1.0, 1.0);
        const struct shape ball = solid_sphere(random_between(&random, -9.0, 9.0), 3.0, aside, radius);
        double half = fabs(aside) < radius ? sqrt(radius * radius - aside * aside) : 0.0, near, far;
        struct still still;

        init_thin(&still, &ball, 1);
        add_sun(&still, (struct vec3){0.6, -0.8, 0.0});
        // The shadow is that of a disc, on a line that the light meets at a sine of 0.8.
        assert_lit(&still, LENGTH - 2.0 * half / 0.8);
        still.light_count = 0;
        add_lamp(&still, (struct vec3){0.0, 6.0, 0.0});
        // Angles of the tangents to the lamp's perpendicular.
        near = atan2(ball.center.x, 3.0) - asin(half / hypot(ball.center.x, 3.0));
        far = atan2(ball.center.x, 3.0) + asin(half / hypot(ball.center.x, 3.0));
        assert_lit(&still, LENGTH - fmax(fmin(6.0 * tan(far), 20.0) - fmax(6.0 * tan(near), -20.0), 0.0));
    }
}

static void boxes_cast_shadows_with_corners(void **state)
{
    struct random random = {5};

    for (int i = 0; i < 200; i++) {
        struct vec3 half = {random_between(&random, 0.01, 2.0), random_between(&random, 0.01, 0.9), 0.5};
        double aside = random_between(&random, -0.9, 0.9), x = random_between(&random, -3.0, 3.0);
        const struct shape box = solid_box((struct vec3){x, 2.0, aside}, half);
        bool is_met = fabs(aside) < 0.5;
        struct still still;

        init_thin(&still, &box, 1);
        add_sun(&still, (struct vec3){0.6, -0.8, 0.0});
        // The box's shadow is as wide as its width and the slanted shadow of its height.
        assert_lit(&still, LENGTH - (is_met ? 2.0 * half.x + 2.0 * half.y * 0.75 : 0.0));
        still.light_count = 0;
        add_lamp(&still, (struct vec3){x, 6.0, 0.0});
        // The box's upper corners limit the shadow of a lamp right above it.
        assert_lit(&still, LENGTH - (is_met ? 2.0 * half.x * 6.0 / (4.0 - half.y) : 0.0));
    }
}

static void later_shapes_take_from_the_shadows_of_others(void **state)
{
    const struct shape shapes[] = {solid_sphere(0.0, 2.0, 0.0, 1.0),
                                   solid_box((struct vec3){1.0, 2.0, 0.0}, (struct vec3){1.0, 0.5, 1.0})};
    struct still still;

    init_thin(&still, shapes, 2);
    add_sun(&still, (struct vec3){0.0, -1.0, 0.0});
    assert_lit(&still, LENGTH - 3.0);
    // The glass hides a part of the mirror: light passes where the glass is last.
    still.objects.list[0].material = solid_mirror(1.0);
    still.objects.list[1].material = solid_glass(SCENE_FRESNEL_NONE, 1.0);
    // The box replaces the disc's middle band from x = 0 on; the disc stays above and below the band.
    assert_lit(&still, LENGTH - 1.0 - sqrt(0.75));
    still.objects.shapes[1].half = (struct vec3){1.0, 1.0, 1.0};
    assert_lit(&still, LENGTH - 1.0);
    // Both are discs: nothing of the first one's shadow is left where the second has the longer chord.
    still.objects.shapes[1] = solid_sphere(0.93, 2.0, 0.0, 1.2);
    assert_lit(&still, LENGTH - 1.0 - (0.93 * 0.93 + 1.0 - 1.2 * 1.2) / (2.0 * 0.93));
}

// The section through circles and planes is slanted.
static void many_shadows_agree_with_stepping(void **state)
{
    enum { STEPS = 100000 };
    struct random random = {6};

    for (int i = 0; i < 6; i++) {
        struct shape shapes[6];
        struct still still;
        int lit = 0;

        for (int k = 0; k < 6; k++) {
            struct vec3 center = {random_between(&random, -6.0, 6.0), random_between(&random, 2.0, 4.0),
                                  random_between(&random, -0.5, 0.5)};

            shapes[k] = k % 2 ? solid_sphere(center.x, center.y, center.z, random_between(&random, 0.2, 1.5))
                              : solid_box(center, (struct vec3){random_between(&random, 0.2, 1.5), 0.5, 0.7});
        }
        init_thin(&still, shapes, 6);
        // Two of the objects pass light where they are last.
        still.objects.list[2].material = still.objects.list[5].material = solid_glass(SCENE_FRESNEL_NONE, 1.0);
        if (i % 2)
            add_sun(&still, (struct vec3){0.3, -0.9, 0.1});
        else
            add_lamp(&still, (struct vec3){0.5, 7.0, 0.3});
        for (int k = 0; k < STEPS; k++) {
            struct light_arrival arrival = light_arrive(&still.lights[0], ray_at(&ALONG_X, (k + 0.5) * LENGTH / STEPS));
            struct ray shadow_ray = {ray_at(&ALONG_X, (k + 0.5) * LENGTH / STEPS), vec3_scale(arrival.travel, -1.0)};
            struct object_walk walk;
            bool is_dark = false;

            objects_walk(&still.objects, &shadow_ray, arrival.distance, &walk);
            for (size_t p = 0; p < walk.count; p++)
                is_dark = is_dark || objects_is_opaque(&still.objects, walk.pieces[p].region);
            lit += !is_dark;
        }
        // Each edge may be half a step off; there are up to a dozen.
        assert_near(lit_length(&still), (double)lit * LENGTH / STEPS, 12.0 * LENGTH / STEPS);
    }
}

// Each object passes a share of the lamp's light. Fresnel's shares start like a root at a silhouette.
static void shadows_of_glass_converge(void **state)
{
    const struct shape shapes[] = {solid_sphere(0.0, 3.0, 0.2, 1.0),
                                   solid_box((struct vec3){4.0, 3.0, 0.1}, (struct vec3){0.5, 0.5, 0.5})};
    const struct material glass = solid_glass(SCENE_FRESNEL_EXACT, 1.5);
    const struct integrate_accuracy fine = {.relative = 1e-7, .floor = 1e-12};
    struct integrate_stretch stretch = {.ray = ALONG_X, .far = LENGTH};
    struct integrate_result coarse_light, fine_light;
    struct still still;

    solid_still_init(&still);
    solid_still_add(&still, &glass, &shapes[0], 1);
    solid_still_add(&still, &glass, &shapes[1], 1);
    solid_still_fill(&still, 0, 0.05, 0.0);
    solid_still_fill(&still, 1, 0.0, 0.7);
    add_lamp(&still, (struct vec3){0.3, 6.0, 0.0});
    coarse_light = integrate_stretch(&still, &stretch, NULL);
    fine_light = integrate_stretch(&still, &stretch, &fine);
    assert_true(coarse_light.is_converged && fine_light.is_converged);
    assert_near(coarse_light.radiance[0], fine_light.radiance[0], 1e-4 * fine_light.radiance[0]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(balls_cast_round_shadows),
        cmocka_unit_test(boxes_cast_shadows_with_corners),
        cmocka_unit_test(later_shapes_take_from_the_shadows_of_others),
        cmocka_unit_test(many_shadows_agree_with_stepping),
        cmocka_unit_test(shadows_of_glass_converge),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
