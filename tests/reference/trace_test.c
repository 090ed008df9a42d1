// SPDX-License-Identifier: Apache-2.0
#include "reference/trace.h"

#include "reference/reference.h"
#include "tests/support/assert_near.h"
#include "tests/support/solid_still.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const double FLOOR_Z = -10.0;

static struct trace_result trace_down(const struct still *still, double x)
{
    return trace_ray(still, &(struct ray){{x, 0.0, 4.0}, {0.0, 0.0, -1.0}}, 0, NULL);
}

static void add_point_light(struct still *still, struct vec3 position, double intensity)
{
    still->lights[still->light_count++] = (struct light){.kind = SCENE_LIGHT_POINT,
                                                         .falloff = SCENE_FALLOFF_INVERSE_SQUARE,
                                                         .intensity = {intensity, intensity, intensity},
                                                         .position = position};
}

static void add_sun(struct still *still, struct vec3 direction, double irradiance)
{
    still->lights[still->light_count++] = (struct light){.kind = SCENE_LIGHT_SUN,
                                                         .intensity = {irradiance, irradiance, irradiance},
                                                         .direction = vec3_normalize(direction)};
}

// The white floor is under an unshadowed lamp 2 m above it: its radiance tells which point is seen.
static void add_lit_floor(struct still *still)
{
    const struct shape floor = solid_plane((struct vec3){0.0, 0.0, FLOOR_Z}, (struct vec3){0.0, 0.0, 1.0});
    const struct material white = solid_diffuse(1.0);

    solid_still_add(still, &white, &floor, 1);
    add_point_light(still, (struct vec3){7.0, 1.0, FLOOR_Z + 2.0}, 100.0);
}

static double floor_radiance(double x)
{
    double across = x - 7.0, distance = sqrt(across * across + 1.0 + 4.0);

    return 100.0 / M_PI * 2.0 / (distance * distance * distance);
}

// The x at which a ray meets the floor that leaves the unit sphere at `angle` from the z axis, deflected by `deviation`
// from straight down.
static double meet_floor(double angle, double deviation)
{
    return sin(angle) - tan(deviation) * (cos(angle) - FLOOR_Z);
}

static void a_ball_bends_rays_as_known(void **state)
{
    static const double IORS[] = {1.5, 1.1, 2.4, 1.0 / 1.33};

    for (int i = 0; i < 4; i++) {
        for (double offset = 0.0; offset < fmin(IORS[i], 1.0) - 0.03; offset += 0.07) {
            const struct shape ball = solid_sphere(0.0, 0.0, 0.0, 1.0);
            const struct material glass = solid_glass(SCENE_FRESNEL_NONE, IORS[i]);
            double outside = asin(offset), inside = asin(offset / IORS[i]);
            double x = meet_floor(outside + M_PI - 2.0 * inside, 2.0 * (outside - inside));
            struct trace_result seen;
            struct still still;

            solid_still_init(&still);
            solid_still_add(&still, &glass, &ball, 1);
            add_lit_floor(&still);
            if (fabs(2.0 * (outside - inside)) > 1.2) continue;
            seen = trace_down(&still, offset);
            assert_near(seen.radiance[1], floor_radiance(x), 1e-9 * floor_radiance(x));
            assert_near(seen.ray_count, 3.0, 0.0);
        }
    }
}

// Angles in two concentric spheres: n r sin(angle) stays equal to the offset.
static void a_bubble_in_glass_bends_rays_as_known(void **state)
{
    const double ior = 1.5, radius = 0.6;
    const struct shape ball = solid_sphere(0.0, 0.0, 0.0, 1.0), hole = solid_sphere(0.0, 0.0, 0.0, radius);
    const struct material glass = solid_glass(SCENE_FRESNEL_NONE, ior), air = solid_glass(SCENE_FRESNEL_NONE, 1.0);

    for (double offset = 0.0; offset < radius - 0.05; offset += 0.05) {
        double outside = asin(offset), in_glass = asin(offset / ior);
        double before_hole = asin(offset / (ior * radius)), in_hole = asin(offset / radius);
        double turned = 2.0 * (before_hole - in_glass) + M_PI - 2.0 * in_hole;
        double x = meet_floor(outside + turned, 2.0 * (outside - in_glass + before_hole - in_hole));
        struct trace_result seen;
        struct still still;

        solid_still_init(&still);
        solid_still_add(&still, &glass, &ball, 1);
        solid_still_add(&still, &air, &hole, 1);
        add_lit_floor(&still);
        seen = trace_down(&still, offset);
        assert_near(seen.radiance[1], floor_radiance(x), 1e-9 * floor_radiance(x));
        assert_near(seen.ray_count, 5.0, 0.0);
    }
}

static void a_plate_shifts_rays_and_no_more(void **state)
{
    const struct shape plate = solid_box((struct vec3){0.0, 0.0, 0.0}, (struct vec3){50.0, 50.0, 0.5});
    const struct material glass = solid_glass(SCENE_FRESNEL_NONE, 1.5);

    for (double angle = 0.0; angle < 0.8; angle += 0.1) {
        struct ray ray = {{0.0, 0.0, 4.0}, {sin(angle), 0.0, -cos(angle)}};
        // The path is a metre of glass, the rest of it air.
        double x = 13.0 * tan(angle) + tan(asin(sin(angle) / 1.5));
        struct still still;

        solid_still_init(&still);
        solid_still_add(&still, &glass, &plate, 1);
        add_lit_floor(&still);
        assert_near(trace_ray(&still, &ray, 0, NULL).radiance[0], floor_radiance(x), 1e-10 * floor_radiance(x));
    }
}

static void transmittance_of_a_ball_is_known(void **state)
{
    const struct shape ball = solid_sphere(0.0, 0.0, 0.0, 1.0);
    const struct material glass = solid_glass(SCENE_FRESNEL_EXACT, 1.5);

    for (double offset = 0.0; offset < 0.99; offset += 0.09) {
        double cos_in = sqrt(1.0 - offset * offset), cos_inside = sqrt(1.0 - offset * offset / 2.25);
        double across = (cos_in - 1.5 * cos_inside) / (cos_in + 1.5 * cos_inside);
        double along = (1.5 * cos_in - cos_inside) / (1.5 * cos_in + cos_inside);
        double passed = 1.0 - 0.5 * (across * across + along * along);
        struct trace_result seen;
        struct still still;

        solid_still_init(&still);
        still.max_depth = 3;
        solid_still_add(&still, &glass, &ball, 1);
        solid_still_fill(&still, 1, 0.0, 0.7)->sigma_a[2] = 0.1;
        seen = trace_down(&still, offset);
        // Beer-Lambert along the refracted chord.
        assert_near(seen.transmittance[0], passed * passed * exp(-0.7 * 2.0 * cos_inside), 1e-12);
        assert_near(seen.transmittance[2], passed * passed * exp(-0.1 * 2.0 * cos_inside), 1e-12);
        // The rays are the camera's, two at the first boundary, two at the second and two at the third; those of the
        // fourth are too deep.
        assert_near(seen.ray_count, 7.0, 0.0);
        assert_near(seen.cut_count, 2.0, 0.0);
    }
}

// The camera is within glass, at an angle to its face.
static struct trace_result look_out(double angle, enum scene_fresnel kind)
{
    const struct shape wall = solid_plane((struct vec3){0.0, 0.0, 0.0}, (struct vec3){0.0, 0.0, 1.0});
    const struct material glass = solid_glass(kind, 1.5);
    struct still still;

    solid_still_init(&still);
    solid_still_add(&still, &glass, &wall, 1);
    return trace_ray(&still, &(struct ray){{0.0, 0.0, -3.0}, {sin(angle), 0.0, cos(angle)}}, 0, NULL);
}

static void nothing_leaves_beyond_the_critical_angle(void **state)
{
    static const enum scene_fresnel KINDS[] = {SCENE_FRESNEL_EXACT, SCENE_FRESNEL_SCHLICK, SCENE_FRESNEL_NONE};
    double critical = asin(1.0 / 1.5);

    for (int k = 0; k < 3; k++) {
        assert_near(look_out(critical + 1e-6, KINDS[k]).transmittance[0], 0.0, 0.0);
        assert_near(look_out(critical + 1e-6, KINDS[k]).ray_count, 2.0, 0.0);
        assert_true(look_out(critical - 1e-6, KINDS[k]).transmittance[0] > 0.0);
    }
    assert_near(look_out(critical - 1e-6, SCENE_FRESNEL_NONE).transmittance[0], 1.0, 0.0);
    assert_near(look_out(0.0, SCENE_FRESNEL_EXACT).transmittance[0], 0.96, 1e-15);
}

// The mirrors have 3 m of glowing air between them; the last reflection is cut.
static void facing_mirrors_make_a_geometric_series(void **state)
{
    const struct shape walls[] = {solid_plane((struct vec3){-1.0, 0.0, 0.0}, (struct vec3){1.0, 0.0, 0.0}),
                                  solid_plane((struct vec3){2.0, 0.0, 0.0}, (struct vec3){-1.0, 0.0, 0.0})};
    const struct material silver = solid_mirror(0.8);
    const struct ray ray = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
    struct trace_result seen;
    struct medium *air;
    struct still still;
    double wanted;

    solid_still_init(&still);
    solid_still_add(&still, &silver, walls, 2);
    air = solid_still_fill(&still, 0, 0.0, 0.0);
    air->emission[0] = air->emission[1] = air->emission[2] = 5.0;
    still.max_depth = 6;
    seen = trace_ray(&still, &ray, 0, NULL);
    wanted = 5.0 * (2.0 + 3.0 * 0.8 * (1.0 - pow(0.8, 6.0)) / (1.0 - 0.8));
    assert_near(seen.radiance[0], wanted, 1e-4 * wanted);
    assert_near(seen.ray_count, 7.0, 0.0);
    assert_near(seen.cut_count, 1.0, 0.0);
    assert_near(seen.cut_throughput, pow(0.8, 7.0), 1e-15);
    assert_near(seen.cut_by_depth, seen.cut_throughput, 0.0);
    // The limit lies between 0.8^4 and 0.8^3; the strongest colour counts.
    still.min_throughput = 0.5;
    assert_near(trace_ray(&still, &ray, 0, NULL).cut_by_depth, 0.0, 0.0);
    assert_near(trace_ray(&still, &ray, 0, NULL).ray_count, 4.0, 0.0);
    still.objects.list[0].material.reflectance[2] = 1.0;
    assert_near(trace_ray(&still, &ray, 0, NULL).ray_count, 7.0, 0.0);
}

static void cut_rays_take_what_media_left(void **state)
{
    const struct shape wall = solid_plane((struct vec3){0.0, 0.0, 0.0}, (struct vec3){0.0, 0.0, 1.0});
    const struct material silver = solid_mirror(0.9);
    struct trace_result seen;
    struct still still;

    solid_still_init(&still);
    solid_still_add(&still, &silver, &wall, 1);
    solid_still_fill(&still, 0, 0.0, 0.5)->sigma_a[0] = 1.0;
    still.max_depth = 0;
    seen = trace_down(&still, 0.0);
    assert_near(seen.cut_throughput, 0.9 * (exp(-4.0) + 2.0 * exp(-2.0)) / 3.0, 1e-12);
    // Black mirrors reflect nothing that could be cut.
    still.objects.list[0].material = solid_mirror(0.0);
    assert_near(trace_down(&still, 0.0).cut_count, 0.0, 0.0);
}

static void a_floor_is_lit_as_lambert_says(void **state)
{
    const struct shape floor = solid_plane((struct vec3){0.0, 0.0, 0.0}, (struct vec3){0.0, 0.0, 1.0});
    const struct material grey = solid_diffuse(0.6);
    struct still still;

    solid_still_init(&still);
    solid_still_add(&still, &grey, &floor, 1);
    add_point_light(&still, (struct vec3){1.5, 0.0, 2.0}, 30.0);
    add_point_light(&still, (struct vec3){1.5, 0.0, -2.0}, 1000.0);
    for (double x = -3.0; x < 3.0; x += 0.5) {
        double square = (x - 1.5) * (x - 1.5) + 4.0;

        assert_near(trace_down(&still, x).radiance[0], 0.6 / M_PI * 30.0 * 2.0 / (square * sqrt(square)), 1e-12);
    }
    still.light_count = 0;
    add_sun(&still, (struct vec3){0.3, 0.4, -1.2}, 7.0);
    assert_near(trace_down(&still, 0.3).radiance[2], 0.6 / M_PI * 7.0 * 1.2 / 1.3, 1e-13);
    add_sun(&still, (struct vec3){0.3, 0.4, 1.2}, 7.0);
    assert_near(trace_down(&still, 0.3).radiance[2], 0.6 / M_PI * 7.0 * 1.2 / 1.3, 1e-13);
}

static void a_specular_share_is_reflected_the_rest_is_not(void **state)
{
    const struct shape floor = solid_plane((struct vec3){0.0, 0.0, 0.0}, (struct vec3){0.0, 0.0, 1.0});
    struct material varnish = solid_diffuse(0.6);
    struct still still;

    varnish.specular = 0.5;
    solid_still_init(&still);
    solid_still_add(&still, &varnish, &floor, 1);
    solid_still_set_background(&still, 2.0);
    add_sun(&still, (struct vec3){0.0, 0.0, -1.0}, 7.0);
    // Reflectance is 4 % at normal incidence.
    assert_near(trace_down(&still, 0.0).radiance[0], 0.02 * 2.0 + 0.98 * 0.6 / M_PI * 7.0, 1e-13);
    assert_near(trace_down(&still, 0.0).transmittance[0], 0.0, 0.0);
    still.objects.list[0].material.fresnel.kind = SCENE_FRESNEL_NONE;
    assert_near(trace_down(&still, 0.0).radiance[0], 0.5 * 2.0 + 0.5 * 0.6 / M_PI * 7.0, 1e-13);
    still.objects.list[0].material.specular = 1.0;
    assert_near(trace_down(&still, 0.0).radiance[0], 2.0, 1e-13);
}

// The later glass ball makes a hole in the floor: the floor is seen through the ball at its far side.
static void opaque_regions_are_seen_where_another_object_ends(void **state)
{
    const struct shape floor = solid_plane((struct vec3){0.0, 0.0, 0.0}, (struct vec3){0.0, 0.0, 1.0});
    const struct shape ball = solid_sphere(0.0, 0.0, 0.0, 1.0);
    const struct material grey = solid_diffuse(0.6), glass = solid_glass(SCENE_FRESNEL_EXACT, 1.5);
    struct trace_result seen;
    struct still still;
    double lit;

    solid_still_init(&still);
    solid_still_add(&still, &grey, &floor, 1);
    solid_still_add(&still, &glass, &ball, 1);
    solid_still_fill(&still, 2, 0.0, 0.25);
    add_sun(&still, (struct vec3){0.0, 0.0, -1.0}, 7.0);
    seen = trace_down(&still, 0.0);
    lit = 0.6 / M_PI * 7.0 * exp(-0.5) * 0.96;
    assert_near(seen.radiance[0], 0.96 * exp(-0.5) * lit, 1e-12);
    // The floor hides the lower half of the ball where the order is reversed.
    still.objects.list[0] = (struct object){1, 1, glass};
    still.objects.list[1] = (struct object){0, 1, grey};
    still.media[0].region = 1;
    seen = trace_down(&still, 0.0);
    lit = 0.6 / M_PI * 7.0 * exp(-0.25) * 0.96;
    assert_near(seen.radiance[0], 0.96 * exp(-0.25) * lit, 1e-12);
}

// The mirror is 4 m away; the media end a metre behind it.
static void clips_count_the_length_of_reflected_paths(void **state)
{
    const struct shape wall = solid_plane((struct vec3){0.0, 0.0, 0.0}, (struct vec3){0.0, 0.0, 1.0});
    const struct material silver = solid_mirror(1.0);
    struct still still;

    solid_still_init(&still);
    solid_still_add(&still, &silver, &wall, 1);
    solid_still_fill(&still, 0, 0.0, 0.3);
    solid_still_set_background(&still, 1.0);
    still.camera.clip_near = 1.5;
    still.camera.clip_far = 5.0;
    assert_near(trace_down(&still, 0.0).radiance[0], exp(-0.3 * 3.5), 1e-12);
    still.camera.clip_near = 4.5;
    assert_near(trace_down(&still, 0.0).radiance[0], exp(-0.3 * 0.5), 1e-12);
    // Surfaces are seen beyond the clip distances.
    still.camera.clip_near = 0.0;
    still.camera.clip_far = 2.0;
    assert_near(trace_down(&still, 0.0).radiance[0], exp(-0.3 * 2.0), 1e-12);
}

static void media_keep_to_their_regions(void **state)
{
    const struct shape ball = solid_sphere(0.0, 0.0, 0.0, 1.0), core = solid_sphere(0.0, 0.0, 0.0, 0.5);
    const struct material glass = solid_glass(SCENE_FRESNEL_NONE, 1.5);
    struct still still;

    solid_still_init(&still);
    solid_still_add(&still, &glass, &ball, 1);
    solid_still_add(&still, &glass, &core, 1);
    solid_still_fill(&still, 0, 0.0, 0.1);
    solid_still_fill(&still, 0, 0.0, 0.2);
    solid_still_fill(&still, 1, 0.0, 0.5);
    solid_still_fill(&still, 2, 0.0, 0.9);
    still.camera.clip_far = 8.0;
    assert_near(trace_down(&still, 0.0).transmittance[0], exp(-0.3 * 6.0 - 0.5 * 1.0 - 0.9 * 1.0), 1e-12);
}

static struct reference_pixel measure_centre(const struct still *still)
{
    return reference_measure_pixel(still, 2, 2, NULL);
}

static void alpha_and_depth_are_those_of_what_is_seen(void **state)
{
    const struct shape ball = solid_sphere(0.0, 0.0, 0.0, 1.0);
    const struct material clear = solid_glass(SCENE_FRESNEL_NONE, 1.5), silver = solid_mirror(1.0);
    struct still still;

    solid_still_init(&still);
    solid_still_add(&still, &clear, &ball, 1);
    assert_near(measure_centre(&still).alpha, 0.0, 0.0);
    assert_near(reference_measure_depth(&still, 2, 2), 3.0, 1e-12);
    assert_near(reference_measure_depth(&still, 0, 0), 0.0, 0.0);
    solid_still_fill(&still, 0, 0.0, 0.2);
    assert_near(reference_measure_depth(&still, 2, 2), 3.0, 1e-12);
    solid_still_fill(&still, 0, 0.0, 0.8);
    assert_near(reference_measure_depth(&still, 2, 2), log(2.0), 1e-9);
    still.medium_count = 0;
    still.objects.list[0].material = silver;
    assert_near(measure_centre(&still).alpha, 1.0, 0.0);
    // The camera is within an opaque object.
    still.objects.shapes[0].radius = 5.0;
    assert_near(measure_centre(&still).alpha, 1.0, 0.0);
    assert_near(measure_centre(&still).radiance[0], 0.0, 0.0);
    assert_near(reference_measure_depth(&still, 2, 2), 9.0, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_bends_rays_as_known),
        cmocka_unit_test(a_bubble_in_glass_bends_rays_as_known),
        cmocka_unit_test(a_plate_shifts_rays_and_no_more),
        cmocka_unit_test(transmittance_of_a_ball_is_known),
        cmocka_unit_test(nothing_leaves_beyond_the_critical_angle),
        cmocka_unit_test(facing_mirrors_make_a_geometric_series),
        cmocka_unit_test(cut_rays_take_what_media_left),
        cmocka_unit_test(a_floor_is_lit_as_lambert_says),
        cmocka_unit_test(a_specular_share_is_reflected_the_rest_is_not),
        cmocka_unit_test(opaque_regions_are_seen_where_another_object_ends),
        cmocka_unit_test(clips_count_the_length_of_reflected_paths),
        cmocka_unit_test(media_keep_to_their_regions),
        cmocka_unit_test(alpha_and_depth_are_those_of_what_is_seen),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
