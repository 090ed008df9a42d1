// SPDX-License-Identifier: Apache-2.0
#include "reference/trace.h"

#include "tests/support/assert_near.h"
#include "tests/support/random.h"
#include "tests/support/solid_still.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

enum { SCENES = 300, RAYS = 20 };

static struct vec3 random_vector(struct random *random, double low, double high)
{
    double x = random_between(random, low, high), y = random_between(random, low, high);

    return (struct vec3){x, y, random_between(random, low, high)};
}

static struct shape random_shape(struct random *random)
{
    struct vec3 center = random_vector(random, -1.0, 1.0);

    switch ((int)random_between(random, 0.0, 3.0)) {
    case 0:
        return solid_sphere(center.x, center.y, center.z, random_between(random, 0.2, 1.0));
    case 1:
        return solid_box(center, random_vector(random, 0.1, 0.8));
    default:
        return solid_plane(vec3_scale(center, 3.0), random_vector(random, -1.0, 1.0));
    }
}

// Each material sends on all the light that it gets.
static struct material random_material(struct random *random)
{
    static const double IORS[] = {1.0, 1.2, 1.5, 2.4, 0.8};
    static const enum scene_fresnel KINDS[] = {SCENE_FRESNEL_EXACT, SCENE_FRESNEL_SCHLICK, SCENE_FRESNEL_NONE};
    struct material material;

    switch ((int)random_between(random, 0.0, 6.0)) {
    case 0:
        material = solid_mirror(1.0);
        break;
    case 1:
        material = solid_diffuse(0.5);
        material.specular = 1.0;
        material.fresnel.kind = SCENE_FRESNEL_NONE;
        break;
    default:
        material =
            solid_glass(KINDS[(int)random_between(random, 0.0, 3.0)], IORS[(int)random_between(random, 0.0, 5.0)]);
        material.fresnel.has_f0 = random_between(random, 0.0, 1.0) < 0.3;
        material.fresnel.f0 = random_between(random, 0.0, 1.0);
        material.fresnel.f90 = random_between(random, 0.0, 1.0);
    }
    if (random_between(random, 0.0, 1.0) < 0.4) material.roughness = random_between(random, 0.0, 1.0);
    return material;
}

static void make_scene(struct still *still, struct random *random)
{
    int objects = (int)random_between(random, 1.0, 6.0);

    solid_still_init(still);
    solid_still_set_background(still, 1.0);
    still->max_depth = 8;
    still->min_throughput = 0.01;
    for (int i = 0; i < objects; i++) {
        struct material material = random_material(random);
        struct shape shapes[3];
        size_t count = (size_t)random_between(random, 1.0, 4.0);

        for (size_t k = 0; k < count; k++)
            shapes[k] = random_shape(random);
        solid_still_add(still, &material, shapes, count);
    }
}

// False where the ray starts in an opaque object.
static bool pick_ray(const struct still *still, struct random *random, struct ray *ray)
{
    struct object_walk walk;

    ray->origin = random_vector(random, -2.5, 2.5);
    ray->direction = vec3_normalize(vec3_subtract(random_vector(random, -1.0, 1.0), ray->origin));
    objects_walk(&still->objects, ray, INFINITY, &walk);
    return !objects_is_opaque(&still->objects, walk.pieces[0].region);
}

// Cut rays carry all the light that is missing; 1e-12: sums of some hundred rays.
static void only_cut_light_is_lost(void **state)
{
    struct random random = {1};
    double rays = 0.0, cut = 0.0;

    for (int i = 0; i < SCENES; i++) {
        struct still still;

        make_scene(&still, &random);
        for (int k = 0; k < RAYS; k++) {
            struct trace_result seen;
            struct ray ray;

            if (!pick_ray(&still, &random, &ray)) continue;
            seen = trace_ray(&still, &ray, (uint64_t)k, NULL);
            for (int c = 0; c < 3; c++) {
                assert_near(seen.radiance[c] + seen.cut_throughput, 1.0, 1e-12);
                assert_true(seen.transmittance[c] >= 0.0 && seen.transmittance[c] <= 1.0 + 1e-12);
            }
            rays += seen.ray_count;
            cut += seen.cut_count;
        }
    }
    print_message("%.0f rays, %.0f cut\n", rays, cut);
    assert_true(rays > 10.0 * SCENES && cut > SCENES);
}

static void media_that_glow_as_they_absorb_hide_in_it(void **state)
{
    struct random random = {2};

    for (int i = 0; i < SCENES / 6; i++) {
        struct still still;

        make_scene(&still, &random);
        for (size_t region = 0; region <= still.objects.count; region++) {
            double sigma_a = random_between(&random, 0.05, 3.0);
            struct medium *medium = solid_still_fill(&still, region, 0.0, sigma_a);

            for (int c = 0; c < 3; c++)
                medium->emission[c] = sigma_a;
        }
        for (int k = 0; k < RAYS / 4; k++) {
            struct trace_result seen;
            struct ray ray;

            if (!pick_ray(&still, &random, &ray)) continue;
            seen = trace_ray(&still, &ray, (uint64_t)k, NULL);
            assert_true(seen.is_converged);
            for (int c = 0; c < 3; c++)
                assert_near(seen.radiance[c] + seen.cut_throughput, 1.0, 1e-4); // the accuracy of each ray
        }
    }
}

// Coordinates are multiples of half a metre, so that faces, edges and corners of several objects coincide.
static double lattice(struct random *random, int low, int high)
{
    return 0.5 * floor(random_between(random, low, high));
}

static struct vec3 lattice_vector(struct random *random, int low, int high)
{
    double x = lattice(random, low, high), y = lattice(random, low, high);

    return (struct vec3){x, y, lattice(random, low, high)};
}

static void make_touching_scene(struct still *still, struct random *random)
{
    solid_still_init(still);
    solid_still_set_background(still, 1.0);
    still->max_depth = 6;
    still->min_throughput = 0.01;
    for (int i = 0; i < 5; i++) {
        struct material material = random_material(random);
        struct vec3 center = lattice_vector(random, -2, 3);
        struct shape shape = solid_box(center, vec3_scale(lattice_vector(random, 1, 4), 0.5));

        if (i == 2) shape = solid_sphere(center.x, center.y, center.z, lattice(random, 1, 3));
        if (i == 4) shape = solid_plane(center, (struct vec3){0.0, 1.0, 0.0});
        solid_still_add(still, &material, &shape, 1);
    }
}

// Rays run from lattice point to lattice point, along faces, through edges and corners, and start there.
static void nothing_is_lost_between_touching_objects(void **state)
{
    struct random random = {7};
    int followed = 0;

    for (int i = 0; i < SCENES * RAYS; i++) {
        struct vec3 from = lattice_vector(&random, -6, 7), to = lattice_vector(&random, -3, 4);
        struct trace_result seen;
        struct object_walk walk;
        struct still still;
        struct ray ray;

        make_touching_scene(&still, &random);
        if (vec3_length(vec3_subtract(to, from)) == 0.0) continue;
        ray = (struct ray){from, vec3_normalize(vec3_subtract(to, from))};
        objects_walk(&still.objects, &ray, INFINITY, &walk);
        if (objects_is_opaque(&still.objects, walk.pieces[0].region)) continue;
        seen = trace_ray(&still, &ray, (uint64_t)i, NULL);
        for (int c = 0; c < 3; c++)
            assert_near(seen.radiance[c] + seen.cut_throughput, 1.0, 1e-12);
        followed++;
    }
    assert_true(followed > SCENES);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_cut_light_is_lost),
        cmocka_unit_test(media_that_glow_as_they_absorb_hide_in_it),
        cmocka_unit_test(nothing_is_lost_between_touching_objects),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
