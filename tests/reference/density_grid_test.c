// SPDX-License-Identifier: Apache-2.0
#include "reference/density_grid.h"

#include "reference/closed_form.h"
#include "reference/integrate.h"
#include "reference/transmittance.h"
#include "tests/support/assert_near.h"
#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH = 5, HEIGHT = 4, DEPTH = 3, VOXELS = WIDTH * HEIGHT * DEPTH };

// The axes are oblique, anisotropic and mirrored: voxels of 0.2, 0.3 and 0.35 m along axes that are not at right
// angles.
static const double PLACEMENT[12] = {-0.2, 0.05, 0.0, 0.3, 0.02, 0.3, 0.1, -0.5, 0.0, -0.04, 0.35, 0.2};
static const double UNIT_PLACEMENT[12] = {1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0};

static void fill_randomly(float values[static VOXELS], uint64_t seed, double low, double high)
{
    struct random random = {seed};

    for (int i = 0; i < VOXELS; i++)
        values[i] = (float)random_between(&random, low, high);
}

static struct density_grid make(const float *values, const double placement[static 12])
{
    struct density_grid density = {.scale = 2.0};
    struct grid_params params = {.values = values, .size = {WIDTH, HEIGHT, DEPTH}};

    memcpy(params.index_to_world, placement, sizeof params.index_to_world);
    grid_init(&density.grid, &params);
    return density;
}

static struct vec3 to_world(const double m[static 12], double i, double j, double k)
{
    return (struct vec3){m[0] * i + m[1] * j + m[2] * k + m[3], m[4] * i + m[5] * j + m[6] * k + m[7],
                         m[8] * i + m[9] * j + m[10] * k + m[11]};
}

// A random point between the outer centres. The coordinates are drawn in a fixed order, whatever the compiler's order
// of evaluation.
static struct vec3 random_point(const double m[static 12], struct random *random)
{
    double i = random_between(random, 0.0, WIDTH - 1.0), j = random_between(random, 0.0, HEIGHT - 1.0);
    double k = random_between(random, 0.0, DEPTH - 1.0);

    return to_world(m, i, j, k);
}

// A ray through two random points of the grid that starts outside of the box.
static struct ray ray_through(const double m[static 12], struct random *random)
{
    struct vec3 a = random_point(m, random), b = random_point(m, random);
    struct vec3 way = vec3_normalize(vec3_subtract(b, a));

    return (struct ray){vec3_subtract(a, vec3_scale(way, 6.0)), way};
}

// Trilinear interpolation by weights of the eight voxels around: each is the product of three linear weights.
static double plain_value(const float *values, double i, double j, double k)
{
    double sum = 0.0;

    for (int z = 0; z < DEPTH; z++) {
        for (int y = 0; y < HEIGHT; y++) {
            for (int x = 0; x < WIDTH; x++) {
                double weight =
                    fmax(1.0 - fabs(i - x), 0.0) * fmax(1.0 - fabs(j - y), 0.0) * fmax(1.0 - fabs(k - z), 0.0);

                sum += weight * values[x + WIDTH * (y + HEIGHT * z)];
            }
        }
    }
    return sum;
}

static double between(double value, double low, double high)
{
    return fmin(fmax(value, low), high);
}

static void values_are_trilinear_and_hold_at_the_edges(void **state)
{
    float values[VOXELS];
    struct density_grid density;
    struct random random = {31};

    fill_randomly(values, 30, -1.0, 1.0);
    density = make(values, PLACEMENT);
    for (int n = 0; n < 2000; n++) {
        double i = random_between(&random, -0.7, WIDTH - 0.3), j = random_between(&random, -0.7, HEIGHT - 0.3);
        double k = random_between(&random, -0.7, DEPTH - 0.3);
        bool is_inside = fabs(i - 2.0) < 2.5 && fabs(j - 1.5) < 2.0 && fabs(k - 1.0) < 1.5;
        struct vec3 position = to_world(PLACEMENT, i, j, k);
        double wanted =
            plain_value(values, between(i, 0.0, WIDTH - 1), between(j, 0.0, HEIGHT - 1), between(k, 0.0, DEPTH - 1));

        assert_true(grid_contains(&density.grid, position) == is_inside);
        assert_near(grid_value(&density.grid, position), wanted, 1e-13);
    }
}

static void nearest_is_the_voxel_around(void **state)
{
    float values[VOXELS];
    struct density_grid density;
    struct random random = {32};

    fill_randomly(values, 33, 0.0, 1.0);
    density = make(values, PLACEMENT);
    density.grid.is_nearest = true;
    for (int n = 0; n < 500; n++) {
        double i = random_between(&random, -0.5, WIDTH - 0.5), j = random_between(&random, -0.5, HEIGHT - 0.5);
        double k = random_between(&random, -0.5, DEPTH - 0.5);
        long voxel = lround(i) + WIDTH * (lround(j) + HEIGHT * lround(k));

        assert_near(grid_value(&density.grid, to_world(PLACEMENT, i, j, k)), values[voxel], 0.0);
    }
}

static void padded_boxes_end_at_the_outer_centres(void **state)
{
    float values[VOXELS] = {0};
    struct grid_params params = {.values = values, .size = {WIDTH, HEIGHT, DEPTH}, .is_padded = true};
    struct grid grid;

    memcpy(params.index_to_world, UNIT_PLACEMENT, sizeof params.index_to_world);
    grid_init(&grid, &params);
    assert_true(grid_contains(&grid, (struct vec3){3.99, 0.01, 1.0}));
    assert_false(grid_contains(&grid, (struct vec3){4.01, 0.01, 1.0}));
    assert_false(grid_contains(&grid, (struct vec3){3.0, -0.01, 1.0}));
}

// Sums by the midpoint rule with a million points along 12 m.
static double summed_column(const struct density *density, const struct ray *ray)
{
    const int count = 1000000;
    double sum = 0.0;

    for (int i = 0; i < count; i++)
        sum += density->at(density->field, ray_at(ray, (i + 0.5) * 12.0 / count));
    return sum * 12.0 / count;
}

static void columns_agree_with_plain_sums(void **state)
{
    struct random random = {34};
    float values[VOXELS];
    double densest = 0.0;

    for (int n = 0; n < 12; n++) {
        struct density_grid grid;
        struct density density;
        struct ray ray = ray_through(PLACEMENT, &random);
        double summed;

        fill_randomly(values, 40 + (uint64_t)n, n % 2 ? -1.0 : 0.0, 1.0);
        grid = make(values, PLACEMENT);
        grid.grid.is_nearest = n % 3 == 2;
        grid.grid.margin = n % 4 == 3 ? 0.0 : 0.5;
        density = density_grid(&grid);
        summed = summed_column(&density, &ray);
        densest = fmax(densest, summed);
        // 3e-5: each jump, at the box's faces or between nearest voxels, costs the sums up to half a step of 1.2e-5.
        assert_near(transmittance_density_column(&density, &ray, 0.0, INFINITY, 1.0), summed, 3e-5);
    }
    assert_true(densest > 0.5);
}

static void spans_and_closed_columns_are_the_same(void **state)
{
    struct random random = {35};
    float values[VOXELS];

    fill_randomly(values, 36, -0.5, 1.0);
    for (int n = 0; n < 200; n++) {
        struct density_grid grid = make(values, PLACEMENT);
        struct ray ray = ray_through(PLACEMENT, &random);
        double near = random_between(&random, 0.0, 7.0), far = near + random_between(&random, 0.0, 4.0);
        struct density density;
        double closed;

        grid.grid.is_nearest = n % 2;
        density = density_grid(&grid);
        closed = transmittance_density_column(&density, &ray, near, far, 1.0);
        density.column = NULL;
        // The density is a cubic without kinks in each span: Gauss' rule is exact there, whatever accuracy is asked
        // for.
        assert_near(transmittance_density_column(&density, &ray, near, far, 1.0), closed, 1e-12);
    }
}

// Rays run along a row of voxels, across a face and through cells' corners, where planes of several axes meet.
static void rays_along_the_lattice_are_walked(void **state)
{
    float values[VOXELS];
    struct density_grid grid;
    struct density density;
    struct ray row = {{-2.0, 1.0, 1.0}, {1.0, 0.0, 0.0}}, back = {{9.0, 1.0, 1.0}, {-1.0, 0.0, 0.0}};
    struct ray diagonal = {{-2.0, -2.0, -2.0}, {1.0 / sqrt(3.0), 1.0 / sqrt(3.0), 1.0 / sqrt(3.0)}};
    struct ray beside = {{-2.0, -0.51, 1.0}, {1.0, 0.0, 0.0}};
    double wanted = 0.0;

    fill_randomly(values, 37, 0.0, 1.0);
    grid = make(values, UNIT_PLACEMENT);
    density = density_grid(&grid);
    for (int i = 0; i < WIDTH; i++)
        wanted += values[i + WIDTH * (1 + HEIGHT)];
    // The integral is the plain sum: trapezoids between centres, and half a voxel of each outer value.
    assert_near(transmittance_density_column(&density, &row, 0.0, INFINITY, 1.0), 2.0 * wanted, 1e-14);
    assert_near(transmittance_density_column(&density, &back, 0.0, INFINITY, 1.0), 2.0 * wanted, 1e-14);
    assert_near(transmittance_density_column(&density, &beside, 0.0, INFINITY, 1.0), 0.0, 0.0);
    assert_near(transmittance_density_column(&density, &diagonal, 0.0, INFINITY, 1.0),
                summed_column(&density, &diagonal), 3e-5);
}

static void ramp_has_its_closed_column(void **state)
{
    float values[VOXELS];
    struct density_grid grid;
    struct density density;
    struct random random = {38};

    // The ramp 0.1 + 0.2 i + 0.3 j + 0.4 k is reproduced between centres.
    for (int v = 0; v < VOXELS; v++) {
        values[v] = (float)(0.1 + 0.2 * (v % WIDTH) + 0.3 * (v / WIDTH % HEIGHT) + 0.4 * (v / WIDTH / HEIGHT));
    }
    grid = make(values, UNIT_PLACEMENT);
    density = density_grid(&grid);
    for (int n = 0; n < 50; n++) {
        struct vec3 a = random_point(UNIT_PLACEMENT, &random), b = random_point(UNIT_PLACEMENT, &random);
        struct ray ray = {a, vec3_normalize(vec3_subtract(b, a))};
        double length = vec3_length(vec3_subtract(b, a));
        double first = 0.1 + 0.2 * a.x + 0.3 * a.y + 0.4 * a.z, last = 0.1 + 0.2 * b.x + 0.3 * b.y + 0.4 * b.z;

        // 1e-6: the values are floats.
        assert_near(transmittance_density_column(&density, &ray, 0.0, length, 1.0),
                    2.0 * closed_form_ramp_column(first, last, length), 1e-6);
    }
}

static void fill(double color[static 3], double value)
{
    color[0] = color[1] = color[2] = value;
}

// The ridge of opacity is a thousandth of the values wide: narrower than the distance between the nodes of a cell.
static const struct scene_transfer_point RIDGE[] = {
    {0.4995, {0.2, 0.5, 0.9, 0.0}},
    {0.5, {1.0, 0.5, 0.1, 0.9}},
    {0.5005, {0.2, 0.5, 0.9, 0.0}},
};

static struct still transfer_still(const struct density_grid *grid)
{
    struct still still = {.medium_count = 1};

    still.media[0].density = density_grid(grid);
    still.media[0].glow = density_grid_glow(grid);
    fill(still.media[0].sigma_a, 1.0);
    return still;
}

// Light by plain sums of four million points along 12 m.
static void sum_light(const struct density_grid *grid, const struct ray *ray, double radiance[static 3])
{
    const int count = 4000000;
    const double step = 12.0 / count;
    double share = 1.0;

    fill(radiance, 0.0);
    for (int i = 0; i < count; i++) {
        struct vec3 position = ray_at(ray, (i + 0.5) * step);
        double value, sigma_t, rgb[3];

        if (!grid_contains(&grid->grid, position)) continue;
        value = grid_value(&grid->grid, position);
        sigma_t = transfer_function_extinction(&grid->transfer, value);
        transfer_function_color(&grid->transfer, value, rgb);
        for (int c = 0; c < 3; c++)
            radiance[c] -= rgb[c] * share * expm1(-sigma_t * step);
        share *= exp(-sigma_t * step);
    }
}

static void steep_transfer_functions_converge(void **state)
{
    struct random random = {39};
    float values[VOXELS];
    double brightest = 0.0;

    for (int n = 0; n < 6; n++) {
        struct density_grid grid;
        struct still still;
        struct integrate_result result;
        struct ray ray = ray_through(PLACEMENT, &random);
        double summed[3];

        fill_randomly(values, 60 + (uint64_t)n, 0.0, 1.0);
        grid = make(values, PLACEMENT);
        grid.has_transfer = true;
        grid.transfer = (struct transfer_function){RIDGE, 3, 1e-3};
        still = transfer_still(&grid);
        result = integrate_ray(&still, &ray, 0.0, INFINITY, NULL);
        assert_true(result.is_converged);
        sum_light(&grid, &ray, summed);
        for (int c = 0; c < 3; c++) {
            // 5e-5: sums of 1.6e7 points differ by no more from these, and by 1e-6 from the integrator.
            assert_near(result.radiance[c], summed[c], 1e-4 * summed[c] + 5e-5);
            brightest = fmax(brightest, summed[c]);
        }
    }
    assert_true(brightest > 0.05);
}

static void furnace_hides_grids_and_transfer_functions(void **state)
{
    static const struct scene_transfer_point WHITE[] = {
        {0.0, {1.0, 1.0, 1.0, 0.0}}, {0.5, {1.0, 1.0, 1.0, 0.999999}}, {0.6, {1.0, 1.0, 1.0, 0.2}}};
    struct random random = {41};
    float values[VOXELS];

    fill_randomly(values, 42, -0.3, 1.0);
    for (int n = 0; n < 30; n++) {
        struct density_grid grid = make(values, PLACEMENT);
        struct ray ray = ray_through(PLACEMENT, &random);
        struct integrate_result result;
        struct still still;

        grid.grid.is_nearest = n % 5 == 0;
        grid.has_transfer = n % 2;
        grid.transfer = (struct transfer_function){WHITE, 3, 0.05};
        still = transfer_still(&grid);
        if (!grid.has_transfer) {
            still.media[0].glow = (struct medium_glow){0};
            fill(still.media[0].sigma_a, 3.0);
            fill(still.media[0].emission, 3.0);
        }
        result = integrate_ray(&still, &ray, 0.0, INFINITY, NULL);
        assert_true(result.is_converged);
        for (int c = 0; c < 3; c++)
            assert_near(result.radiance[c] + result.transmittance[c], 1.0, 1e-4);
    }
}

// The grid, the light and the ray are rotated together about an axis, and moved.
static void a_turned_scene_is_as_bright(void **state)
{
    // The rotation is by 0.7 rad about z, then by 0.4 rad about x.
    const double a = cos(0.7), b = sin(0.7), c = cos(0.4), d = sin(0.4);
    const double rotation[12] = {a, -b, 0.0, 3.0, c * b, c * a, -d, -2.0, d * b, d * a, c, 1.0};
    struct random random = {43};
    double turned_placement[12];
    float values[VOXELS];

    for (int column = 0; column < 4; column++) {
        struct vec3 image = to_world(rotation, PLACEMENT[column], PLACEMENT[4 + column], PLACEMENT[8 + column]);
        struct vec3 shift = column < 3 ? to_world(rotation, 0.0, 0.0, 0.0) : (struct vec3){0.0, 0.0, 0.0};

        turned_placement[column] = image.x - shift.x;
        turned_placement[4 + column] = image.y - shift.y;
        turned_placement[8 + column] = image.z - shift.z;
    }
    fill_randomly(values, 44, 0.0, 1.0);
    for (int n = 0; n < 10; n++) {
        struct density_grid grid = make(values, PLACEMENT), turned_grid = make(values, turned_placement);
        struct still still = {.medium_count = 1, .light_count = 1}, turned;
        struct ray ray = ray_through(PLACEMENT, &random), turned_ray;
        struct vec3 ahead = vec3_add(ray.origin, ray.direction);
        struct integrate_result first, second;

        still.media[0].density = density_grid(&grid);
        fill(still.media[0].sigma_s, 2.0);
        still.media[0].lobes[0] = (struct medium_lobe){.g = 0.5, .weight = 1.0};
        still.media[0].lobe_count = 1;
        fill(still.lights[0].intensity, 3.0);
        still.lights[0].position = (struct vec3){0.7, 1.1, -0.6};
        turned = still;
        turned.media[0].density = density_grid(&turned_grid);
        turned.lights[0].position = to_world(rotation, 0.7, 1.1, -0.6);
        turned_ray.origin = to_world(rotation, ray.origin.x, ray.origin.y, ray.origin.z);
        turned_ray.direction = vec3_subtract(to_world(rotation, ahead.x, ahead.y, ahead.z), turned_ray.origin);
        first = integrate_ray(&still, &ray, 0.0, INFINITY, NULL);
        second = integrate_ray(&turned, &turned_ray, 0.0, INFINITY, NULL);
        assert_true(first.is_converged && first.radiance[0] > 1e-3);
        // Both scenes are refined alike except for roundings.
        assert_near(second.radiance[0], first.radiance[0], 1e-9 * first.radiance[0]);
        assert_near(second.transmittance[0], first.transmittance[0], 1e-12);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_trilinear_and_hold_at_the_edges),
        cmocka_unit_test(nearest_is_the_voxel_around),
        cmocka_unit_test(padded_boxes_end_at_the_outer_centres),
        cmocka_unit_test(columns_agree_with_plain_sums),
        cmocka_unit_test(spans_and_closed_columns_are_the_same),
        cmocka_unit_test(rays_along_the_lattice_are_walked),
        cmocka_unit_test(ramp_has_its_closed_column),
        cmocka_unit_test(steep_transfer_functions_converge),
        cmocka_unit_test(furnace_hides_grids_and_transfer_functions),
        cmocka_unit_test(a_turned_scene_is_as_bright),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
