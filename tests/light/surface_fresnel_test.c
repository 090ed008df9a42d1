// Share of the light that a smooth boundary reflects, from both sides, at angles from normal to grazing.
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/optics.h"
#include "tests/support/studio.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#define BLACK_GLASS ", \"interior\": {\"sigma_a\": [500, 700, 900]}"
#define BLACK_AIR                                                                                                      \
    "{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"slab\", \"center\": [0, 1, 0], "               \
    "\"thickness\": 2, "                                                                                               \
    "\"normal\": [0, 1, 0]}}, \"sigma_a\": [500, 700, 900]}"

// Rays lie in the plane x = 0: from straight down to almost along the water, or from straight up.
static struct studio_camera half_circle(double height, double slope)
{
    return (struct studio_camera){
        .position = {0, height, 0}, .target = {0, height + slope, 1}, .up = {0, 1, 0}, .fov = 89.8};
}

enum kind { EXACT, SCHLICK, NONE };

// A boundary in the plane y = 0.
struct boundary {
    enum kind kind;
    double above, below; // indices of refraction
    double f0, f90;      // of SCHLICK; f0 < 0: from the indices
};

// Rounding of a cosine shifts the angle, which shows near the critical angle.
static const double cosine_error = 4e-7;

static double reflected_at(const struct boundary *boundary, double cosine, double in, double out)
{
    double sine = in / out * sqrt(1.0 - cosine * cosine);
    double f0 = boundary->f0 < 0.0 ? optics_default_f0(in, out) : boundary->f0;

    switch (boundary->kind) {
    case EXACT:
        return optics_fresnel(cosine, in, out);
    case SCHLICK:
        return optics_schlick(cosine, in, out, f0, boundary->f90);
    case NONE:
        return sine >= 1.0 ? 1.0 : 0.0;
    }
    return NAN;
}

// The result is NAN where a small error of the angle makes a difference.
static double reflected(const struct boundary *boundary, const struct ray *ray)
{
    bool is_down = ray->direction.y < 0.0;
    double in = is_down ? boundary->above : boundary->below, out = is_down ? boundary->below : boundary->above;
    double cosine = fabs(ray->direction.y);
    double more = reflected_at(boundary, fmax(0.0, cosine - cosine_error), in, out);
    double less = reflected_at(boundary, fmin(1.0, cosine + cosine_error), in, out);

    return fabs(more - less) > 5e-6 ? NAN : reflected_at(boundary, cosine, in, out);
}

// Nothing is behind the boundary: light that is not reflected leaves the scene.
static void share_of_alpha(const struct ray *ray, struct studio_light *light, const void *user)
{
    light->alpha = reflected(user, ray);
    studio_set_color(light->radiance, 0.0);
    studio_set_color(light->transmittance, 1.0 - light->alpha);
}

// The background is what is reflected; the other side lets nothing through.
static void share_of_light(const struct ray *ray, struct studio_light *light, const void *user)
{
    studio_set_color(light->radiance, reflected(user, ray));
    studio_set_color(light->transmittance, 0.0);
    light->alpha = 1.0;
}

static void write_kind(char *text, size_t size, const struct boundary *boundary)
{
    if (boundary->kind == EXACT) snprintf(text, size, "\"exact\"");
    if (boundary->kind == NONE) snprintf(text, size, "\"none\"");
    if (boundary->kind == SCHLICK && boundary->f0 < 0.0) snprintf(text, size, "\"schlick\"");
    if (boundary->kind == SCHLICK && boundary->f0 >= 0.0)
        snprintf(text, size, "\"schlick\", \"f0\": %g, \"f90\": %g", boundary->f0, boundary->f90);
}

static void write_water(char *text, size_t size, const struct boundary *boundary, const char *interior)
{
    char kind[64];

    write_kind(kind, sizeof kind, boundary);
    snprintf(text, size,
             "{\"kind\": \"plane\", \"point\": [0, 0, 0], \"material\": {\"kind\": \"dielectric\", \"ior\": %g, "
             "\"fresnel\": %s%s}}",
             boundary->below, kind, interior);
}

// One shader program serves both sides: only the camera moves.
static void check_both_sides(const struct boundary *boundary)
{
    struct studio_scene scene = {.width_px = 2, .height_px = 96};
    char objects[256];

    write_water(objects, sizeof objects, boundary, "");
    scene.objects = objects;
    scene.camera = half_circle(0.5, -1);
    studio_check(&scene, share_of_alpha, boundary, 2e-6, 0.9);
    scene.camera = half_circle(-0.5, 1);
    studio_check(&scene, share_of_alpha, boundary, 2e-6, 0.9);
}

static void glass_reflects_as_fresnel_says(void **state)
{
    studio_use(*(enum gl_backend *)*state);
    check_both_sides(&(struct boundary){EXACT, 1.0, 1.5, 0, 0});
}

static void thin_stuff_reflects_as_fresnel_says(void **state)
{
    (void)state;
    check_both_sides(&(struct boundary){EXACT, 1.0, 0.6, 0, 0});
}

static void extreme_indices_reflect_as_fresnel_says(void **state)
{
    (void)state;
    check_both_sides(&(struct boundary){EXACT, 1.0, 10.0, 0, 0});
    check_both_sides(&(struct boundary){EXACT, 1.0, 0.1, 0, 0});
}

static void schlick_takes_the_thinner_side(void **state)
{
    (void)state;
    check_both_sides(&(struct boundary){SCHLICK, 1.0, 1.5, -1.0, 1.0});
    check_both_sides(&(struct boundary){SCHLICK, 1.0, 0.7, -1.0, 1.0});
}

static void schlick_takes_its_ends(void **state)
{
    (void)state;
    check_both_sides(&(struct boundary){SCHLICK, 1.0, 1.4, 0.3, 0.8});
    check_both_sides(&(struct boundary){SCHLICK, 1.0, 1.4, 0.9, 0.1});
}

static void none_reflects_only_beyond_the_critical_angle(void **state)
{
    (void)state;
    check_both_sides(&(struct boundary){NONE, 1.0, 1.5, 0, 0});
}

static void equal_indices_are_no_boundary(void **state)
{
    (void)state;
    check_both_sides(&(struct boundary){EXACT, 1.0, 1.0, 0, 0});
}

// The critical angle lies between two pixels a hundredth of a degree apart.
static void the_critical_angle_is_sharp(void **state)
{
    const struct boundary boundary = {NONE, 1.0, 1.5, 0, 0};
    double critical = asin(1.0 / 1.5);
    struct studio_scene scene = {.width_px = 1, .height_px = 100};
    char objects[256];

    (void)state;
    write_water(objects, sizeof objects, &boundary, "");
    scene.objects = objects;
    scene.camera = (struct studio_camera){.position = {0, -0.5, 0}, .target = {0, 0.5, tan(critical)}, .fov = 1.0};
    studio_check(&scene, share_of_alpha, &boundary, 2e-6, 0.98);
}

static void reflections_are_seen_from_outside(void **state)
{
    const struct boundary boundary = {EXACT, 1.0, 1.5, 0, 0};
    struct studio_scene scene = {.width_px = 2, .height_px = 96, .background = "1"};
    char objects[256];

    (void)state;
    write_water(objects, sizeof objects, &boundary, BLACK_GLASS);
    scene.objects = objects;
    scene.camera = half_circle(0.5, -1);
    studio_check(&scene, share_of_light, &boundary, 2e-6, 0.9);
}

static void reflections_are_seen_from_inside(void **state)
{
    const struct boundary boundary = {EXACT, 1.0, 1.5, 0, 0};
    struct studio_scene scene = {.width_px = 2, .height_px = 96, .background = "1", .media = BLACK_AIR};
    char objects[256];

    (void)state;
    write_water(objects, sizeof objects, &boundary, "");
    scene.objects = objects;
    scene.camera = half_circle(-0.5, 1);
    studio_check(&scene, share_of_light, &boundary, 2e-6, 0.9);
}

#define WATER_ON_GLASS                                                                                                 \
    "{\"kind\": \"plane\", \"point\": [0, 1, 0], \"material\": {\"kind\": \"dielectric\", \"ior\": 1.33}}, "           \
    "{\"kind\": \"plane\", \"point\": [0, 0, 0], \"material\": {\"kind\": \"dielectric\", \"ior\": 1.8}}"

static void between_water_and_glass_both_indices_count(void **state)
{
    const struct boundary boundary = {EXACT, 1.33, 1.8, 0, 0};
    struct studio_scene scene = {.width_px = 2, .height_px = 96, .objects = WATER_ON_GLASS};

    (void)state;
    scene.camera = half_circle(0.5, -1);
    studio_check(&scene, share_of_alpha, &boundary, 2e-6, 0.9);
}

// Rays go upwards through both boundaries and lose light at each.
static void through_both(const struct ray *ray, struct studio_light *light, const void *user)
{
    double cosine = ray->direction.y, sine = sqrt(1.0 - cosine * cosine), water = 1.8 / 1.33 * sine;
    double through = 0.0;

    (void)user;
    if (fabs(1.8 * sine - 1.0) < 1e-3 || fabs(water - 1.0) < 1e-3) return;
    if (water < 1.0) {
        double second = optics_fresnel(sqrt(1.0 - water * water), 1.33, 1.0);

        through = (1.0 - optics_fresnel(cosine, 1.8, 1.33)) * (1.0 - second);
    }
    studio_set_color(light->transmittance, through);
    light->alpha = 1.0 - through;
}

static void two_boundaries_take_their_shares(void **state)
{
    struct studio_scene scene = {.width_px = 2, .height_px = 96, .objects = WATER_ON_GLASS};

    (void)state;
    scene.camera = half_circle(-0.5, 1);
    studio_check(&scene, through_both, NULL, 3e-6, 0.9);
}

int main(int argument_count, char **arguments)
{
    static enum gl_backend software = GL_BACKEND_SOFTWARE, egl = GL_BACKEND_EGL;
    const struct CMUnitTest tests[] = {
        {"glass_reflects_as_fresnel_says_egl", glass_reflects_as_fresnel_says, NULL, NULL, &egl},
        {"glass_reflects_as_fresnel_says_software", glass_reflects_as_fresnel_says, NULL, NULL, &software},
        cmocka_unit_test(thin_stuff_reflects_as_fresnel_says),
        cmocka_unit_test(extreme_indices_reflect_as_fresnel_says),
        cmocka_unit_test(schlick_takes_the_thinner_side),
        cmocka_unit_test(schlick_takes_its_ends),
        cmocka_unit_test(none_reflects_only_beyond_the_critical_angle),
        cmocka_unit_test(equal_indices_are_no_boundary),
        cmocka_unit_test(the_critical_angle_is_sharp),
        cmocka_unit_test(reflections_are_seen_from_outside),
        cmocka_unit_test(reflections_are_seen_from_inside),
        cmocka_unit_test(between_water_and_glass_both_indices_count),
        cmocka_unit_test(two_boundaries_take_their_shares),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, studio_close);
}
