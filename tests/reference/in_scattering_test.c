// Light that reaches a ray through a hole in a screen.
// SPDX-License-Identifier: Apache-2.0
#include "reference/integrate.h"

#include "tests/support/assert_near.h"
#include "tests/support/homogeneous.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const struct ray ALONG_Z = {{0.0, 0.0, -3.0}, {0.0, 0.0, 1.0}};
// 1 m along the ray, and so thin across it that it has no shadow.
static const struct homogeneous_box SLAB = {INFINITY, 1e-6, 0.5};
static const double SIGMA_S = 0.01;

// A screen above the ray, perpendicular to it the light of a sun overhead. Its column is `depth` but for a hole.
struct screen {
    double depth;
    double hole, width; // m along z
};

static double no_density(const void *field, struct vec3 position)
{
    return 0.0;
}

static void find_no_spans(const void *field, const struct ray *ray, double near, double far, struct span_list *spans)
{
}

static double column_at(const struct screen *screen, double z)
{
    double off = (z - screen->hole) / screen->width;

    return -screen->depth * expm1(-off * off);
}

static double find_column(const void *field, const struct ray *ray, double near, double far)
{
    return ray->direction.y > 0.5 ? column_at(field, ray->origin.z) : 0.0;
}

static struct still still_of(const struct screen *screen)
{
    struct still still = {.medium_count = 2};

    still.media[0].density = homogeneous_box_density(&SLAB);
    still.media[1].density =
        (struct density){.field = screen, .at = no_density, .spans = find_no_spans, .column = find_column};
    for (int c = 0; c < 3; c++) {
        still.media[0].sigma_s[c] = SIGMA_S;
        still.media[1].sigma_a[c] = 1.0;
    }
    return still;
}

static void add_sun(struct still *still, double y, double irradiance)
{
    struct light *light = &still->lights[still->light_count++];

    light->kind = SCENE_LIGHT_SUN;
    light->direction = (struct vec3){0.0, y, 0.0};
    for (int c = 0; c < 3; c++)
        light->intensity[c] = irradiance;
}

// The radiance for each unit of irradiance; by a sum over the slab, to 1e-6.
static double sum_light(const struct screen *screen)
{
    enum { COUNT = 20000 };
    double sum = 0.0;

    for (int i = 0; i < COUNT; i++) {
        double depth = (i + 0.5) / COUNT;
        double column = screen ? column_at(screen, depth - 0.5) : 0.0;

        sum += exp(-column - SIGMA_S * depth) / COUNT;
    }
    return sum * SIGMA_S / (4.0 * M_PI);
}

// The beam is a twelfth of the slab wide.
static void beam_between_the_first_nodes_is_found(void **state)
{
    static const double ASKED[] = {0.05, 0.01, 1e-3};

    for (double hole = -0.45; hole < 0.45; hole += 0.013) {
        const struct screen screen = {10.0, hole, 0.15};
        struct still still = still_of(&screen);
        double wanted = sum_light(&screen);

        add_sun(&still, -1.0, 1.0);
        for (size_t i = 0; i < sizeof ASKED / sizeof ASKED[0]; i++) {
            const struct integrate_accuracy accuracy = {.relative = ASKED[i], .floor = 0.1 * wanted};
            struct integrate_result result = integrate_ray(&still, &ALONG_Z, 0.0, INFINITY, &accuracy);

            assert_true(result.is_converged);
            assert_near(result.radiance[0], wanted, ASKED[i] * wanted);
        }
    }
}

// The middle node of the ray's first cell sees a sun of irradiance 1e6 through a pinhole. What it brings is next to
// nothing. The first cells' number does not matter: it is a power of two.
static void pinhole_at_a_node_hides_no_faint_light(void **state)
{
    double wanted = sum_light(NULL);

    for (double cells = 1.0; cells <= 64.0; cells *= 2.0) {
        const struct screen screen = {40.0, -0.5 + 0.5 / cells, 1e-9};
        const struct integrate_accuracy accuracy = {.relative = 0.05, .floor = 0.1 * wanted};
        struct still still = still_of(&screen);

        add_sun(&still, -1.0, 1e6);
        add_sun(&still, 1.0, 1.0);
        assert_near(integrate_ray(&still, &ALONG_Z, 0.0, INFINITY, &accuracy).radiance[0], wanted, 0.05 * wanted);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(beam_between_the_first_nodes_is_found),
        cmocka_unit_test(pinhole_at_a_node_hides_no_faint_light),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
