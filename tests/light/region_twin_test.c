// Regions, phase functions and placements of points against their twins in reference/ and against closed forms.
// SPDX-License-Identifier: Apache-2.0
#include "reference/bounds.h"
#include "reference/closed_form.h"
#include "reference/phase_rayleigh.h"
#include "tests/support/assert_near.h"
#include "tests/support/random.h"
#include "tests/support/shader_probe.h"
#include "worker/glsl/gauss_legendre.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

enum { COUNT = 256 };

static const double PI = 3.14159265358979323846;

static float inputs[SHADER_PROBE_INPUT_LIMIT][4];
static float outputs[COUNT][4];

static void probe(const char *const *modules, const char *body, size_t input_count)
{
    shader_probe_run(&(struct shader_probe_params){.modules = modules,
                                                   .body = body,
                                                   .inputs = (const float(*)[4])inputs,
                                                   .input_count = input_count,
                                                   .count = COUNT},
                     outputs);
}

// Puts a ray's origin into input 2 i and its direction, of any length, into the next. Returns the ray.
static struct ray put_ray(struct random *random, size_t i)
{
    struct vec3 origin, direction;

    for (int c = 0; c < 3; ++c) {
        inputs[2 * i][c] = (float)random_between(random, -2, 2);
        inputs[2 * i + 1][c] = (float)random_between(random, -1, 1);
    }
    // Some rays are along the axes, where they meet a box's faces at right angles or not at all.
    if (i % 8 == 0) inputs[2 * i + 1][0] = inputs[2 * i + 1][2] = 0;
    if (i % 8 == 1) inputs[2 * i + 1][1] = 0;
    origin = (struct vec3){inputs[2 * i][0], inputs[2 * i][1], inputs[2 * i][2]};
    direction = vec3_normalize((struct vec3){inputs[2 * i + 1][0], inputs[2 * i + 1][1], inputs[2 * i + 1][2]});
    return (struct ray){origin, direction};
}

static const char *const modules[] = {"math/constants.glsl", "region/span.glsl", "region/sphere.glsl",
                                      "region/box.glsl",     "region/slab.glsl", NULL};

// `region` is the GLSL expression of `bounds`.
static void assert_region(const struct bounds *bounds, const char *kind, const char *region)
{
    struct random random = {7};
    struct ray rays[COUNT];
    size_t met = 0;
    char body[512];

    for (size_t i = 0; i < COUNT; ++i)
        rays[i] = put_ray(&random, i);
    snprintf(body, sizeof body,
             "vec4 probe(int i)\n{\n    vec3 origin = inputs[2 * i].xyz;\n"
             "    return vec4(region_%s_span(%s, origin, normalize(inputs[2 * i + 1].xyz)),\n"
             "                region_%s_depth(%s, origin), 0.0);\n}\n",
             kind, region, kind, region);
    probe(modules, body, 2 * COUNT);
    for (size_t i = 0; i < COUNT; ++i) {
        double near = -100, far = 100, entry = fmax(outputs[i][0], -100), leave = fmin(outputs[i][1], 100);
        bool is_met = bounds_clip(bounds, &rays[i], &near, &far);

        assert_near(outputs[i][2], bounds_depth(bounds, rays[i].origin), 1e-6);
        // Rounding decides whether a grazing ray meets the region, so the shortest chords are left out.
        if (is_met && far - near > 0.02) {
            // The tolerance is ten roundings of numbers about 3, and more where rays meet faces at a small angle.
            assert_true(fabs(entry - near) < 1e-5 * (1 + fabs(near)));
            assert_true(fabs(leave - far) < 1e-5 * (1 + fabs(far)));
            ++met;
        } else if (!is_met) {
            assert_true(leave - entry < 0.01);
        }
    }
    assert_true(met > COUNT / 8);
}

static void regions_are_met_where_their_twins_are(void **state)
{
    assert_region(&(struct bounds){.kind = SCENE_BOUNDS_SPHERE, .center = {0.3, -0.2, 0.1}, .radius = 1.2}, "sphere",
                  "RegionSphere(vec3(0.3, -0.2, 0.1), 1.2)");
    assert_region(&(struct bounds){.kind = SCENE_BOUNDS_BOX, .center = {0.3, -0.2, 0.1}, .half = {1, 0.5, 1.5}}, "box",
                  "RegionBox(vec3(0.3, -0.2, 0.1), vec3(1.0, 0.5, 1.5))");
    assert_region(
        &(struct bounds){
            .kind = SCENE_BOUNDS_SLAB, .center = {0.3, -0.2, 0.1}, .normal = {0.6, 0.8, 0}, .half_thickness = 0.4},
        "slab", "RegionSlab(vec3(0.3, -0.2, 0.1), vec3(0.6, 0.8, 0.0), 0.4)");
}

// A ray in a face, or along a slab, gives no NaN. Sums and squares of the ends of its span are finite.
static void rays_along_faces_are_finite(void **state)
{
    static const char body[] =
        "vec4 probe(int i)\n{\n"
        "    vec3 origin = vec3(float(i % 3 - 1), float(i / 3 % 3 - 1), float(i / 9 % 3 - 1));\n"
        "    vec3 direction = vec3(0.0);\n    direction[i / 27 % 3] = i / 81 % 2 == 0 ? 1.0 : -1.0;\n"
        "    vec2 box = region_box_span(RegionBox(vec3(0.0), vec3(1.0)), origin, direction);\n"
        "    vec2 slab = region_slab_span(RegionSlab(vec3(0.0), vec3(0.0, 1.0, 0.0), 1.0), origin,"
        " direction);\n    return vec4(box, slab);\n}\n";

    probe(modules, body, 1);
    for (size_t i = 0; i < COUNT; ++i)
        for (int c = 0; c < 4; ++c)
            assert_true(fabsf(outputs[i][c]) <= 1.0001e18f);
    // Rays from the middle leave the box after half its side, and the slab along y only.
    assert_near(outputs[13][1], 1, 1e-6);
    assert_near(outputs[13 + 27][3], 1, 1e-6);
    assert_true(outputs[13][3] > 1e15f && outputs[13][2] < -1e15f);
}

static void rayleigh_is_its_twin(void **state)
{
    static const char *const phase[] = {"math/constants.glsl", "phase/rayleigh.glsl", NULL};

    probe(phase, "vec4 probe(int i)\n{\n    return vec4(phase_rayleigh(float(i) / 127.5 - 1.0));\n}\n", 1);
    for (size_t i = 0; i < COUNT; ++i)
        assert_near(outputs[i][0], phase_rayleigh((double)i / 127.5 - 1), 1e-7);
}

// Gauss's rule of two points over the cosine is exact for polynomials of degree 2.
static void rayleigh_is_normalized(void **state)
{
    static const char *const phase[] = {"math/constants.glsl", "phase/rayleigh.glsl", NULL};
    double points[2], weights[2], sum = 0;

    gauss_legendre(2, points, weights);
    for (int i = 0; i < 2; ++i)
        inputs[i][0] = (float)(2 * points[i] - 1);
    probe(phase, "vec4 probe(int i)\n{\n    return vec4(phase_rayleigh(inputs[i % 2].x));\n}\n", 2);
    for (int i = 0; i < 2; ++i)
        sum += 4 * PI * weights[i] * outputs[i][0];
    assert_near(sum, 1, 1e-6);
}

static void gauss_is_exact_for_polynomials(void **state)
{
    double points[GAUSS_LEGENDRE_LIMIT], weights[GAUSS_LEGENDRE_LIMIT];

    for (int count = 1; count <= GAUSS_LEGENDRE_LIMIT; ++count) {
        gauss_legendre(count, points, weights);
        for (int degree = 0; degree < 2 * count; ++degree) {
            double sum = 0;

            for (int i = 0; i < count; ++i)
                sum += weights[i] * pow(points[i], degree);
            assert_near(sum, 1.0 / (degree + 1), 1e-13);
        }
        assert_true(points[0] > 0 && points[count - 1] < 1);
    }
}

// Points placed by angle cancel 1 / r^2. Their weight is its integral whatever the light's height and the stretch.
static void angles_integrate_the_inverse_square(void **state)
{
    static const char *const placement[] = {"placement/share.glsl", "math/arc.glsl", "placement/angle.glsl", NULL};
    static const char body[] =
        "vec4 probe(int i)\n{\n"
        "    PlacementAngle placement = placement_angle(vec3(inputs[i].x, inputs[i].y, 0.0), vec3(0.0, 1.0, 0.0), "
        "inputs[i].z, 0.0);\n"
        "    Placed first = placement_angle_at(placement, 0.0);\n"
        "    Placed middle = placement_angle_at(placement, 0.5);\n"
        "    return vec4(middle.weight, first.at, middle.at, placement_angle_at(placement, 1.0).at);\n}\n";
    struct random random = {3};

    for (size_t i = 0; i < COUNT; ++i) {
        inputs[i][0] = (float)pow(10, random_between(&random, -3, 4));
        inputs[i][1] = (float)(random_between(&random, -1, 1) * pow(10, random_between(&random, -2, 3)));
        inputs[i][2] = (float)pow(10, random_between(&random, -2, 3));
    }
    probe(placement, body, COUNT);
    for (size_t i = 0; i < COUNT; ++i) {
        double height = inputs[i][0], foot = inputs[i][1], length = inputs[i][2];
        double whole = closed_form_inverse_square(height, foot, 0, length);

        // The tolerance is some roundings, and more where the light is nearly in line with the stretch.
        assert_true(fabs(outputs[i][0] / whole - 1) < 2e-6);
        assert_near(outputs[i][1], 0, 1e-6 * length);
        // The last angles of nearly half a circle cover most of a long stretch, and add nearly nothing.
        assert_true(outputs[i][3] <= (float)length && outputs[i][3] > 0.97 * length);
        assert_true(fabs(closed_form_inverse_square(height, foot, 0, outputs[i][2]) / whole - 0.5) < 2e-4);
    }
}

// A point placed by transmittance has that share of the stretch's loss in front of it.
static void points_by_transmittance_share_out_the_loss(void **state)
{
    static const char *const placement[] = {"placement/share.glsl", "placement/transmittance.glsl", NULL};
    static const char body[] =
        "vec4 probe(int i)\n{\n"
        "    PlacementTransmittance placement = PlacementTransmittance(inputs[i].x * inputs[i].y, inputs[i].y);\n"
        "    Placed placed = placement_transmittance_at(placement, inputs[i].z);\n"
        "    return vec4(placed.at, placed.weight, 0.0, 0.0);\n}\n";
    struct random random = {5};

    for (size_t i = 0; i < COUNT; ++i) {
        inputs[i][1] = (float)pow(10, random_between(&random, -3, 3));
        inputs[i][0] = (float)(pow(10, random_between(&random, -6, 1.2)) / inputs[i][1]);
        inputs[i][2] = (float)random_between(&random, 0, 1);
    }
    probe(placement, body, COUNT);
    for (size_t i = 0; i < COUNT; ++i) {
        double sigma = inputs[i][0], length = inputs[i][1], share = inputs[i][2], x = sigma * length;
        double at = x < 0.1 ? share * length : -log(1 - share * (1 - exp(-x))) / sigma;
        double weight = x < 0.1 ? length : (1 - exp(-x)) / (sigma * exp(-sigma * at));

        // Tolerances are roundings of the logarithm near 1, and of the transmittance deep in the medium.
        assert_true(fabs(outputs[i][0] - at) < 2e-6 * length);
        assert_true(fabs(outputs[i][1] / weight - 1) < 1e-5 * exp(fmin(sigma * at, 8)));
    }
}

// One argument: the tests to run, by a pattern.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(regions_are_met_where_their_twins_are),
        cmocka_unit_test(rays_along_faces_are_finite),
        cmocka_unit_test(rayleigh_is_its_twin),
        cmocka_unit_test(rayleigh_is_normalized),
        cmocka_unit_test(gauss_is_exact_for_polynomials),
        cmocka_unit_test(angles_integrate_the_inverse_square),
        cmocka_unit_test(points_by_transmittance_share_out_the_loss),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
