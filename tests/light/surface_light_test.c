// Diffuse floors under lamps and suns, with fog, balls and glass in between.
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/optics.h"
#include "tests/support/studio.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#define FLOOR(more)                                                                                                    \
    "{\"kind\": \"plane\", \"point\": [0, 0, 0], \"material\": {\"kind\": \"diffuse\", \"albedo\": [0.9, 0.6, "        \
    "0.3]" more "}}"
#define LAMP "{\"kind\": \"point\", \"position\": [0.7, 2.5, -0.4], \"intensity\": [9, 12, 15]}"
#define EVEN_LAMP                                                                                                      \
    "{\"kind\": \"point\", \"falloff\": \"none\", \"position\": [0.7, 2.5, -0.4], \"intensity\": [3, 2, 1]}"
#define SUN "{\"kind\": \"sun\", \"direction\": [0.3, -0.8, 0.1], \"intensity\": [3, 2, 1]}"
#define BALL(material)                                                                                                 \
    "{\"kind\": \"sphere\", \"center\": [0.1, 1, 0.2], \"radius\": 0.5, \"material\": {" material "}}"
#define FOG "{\"density\": {\"kind\": \"homogeneous\"}, \"sigma_a\": [0.05, 0.1, 0.2]}"
#define INK "\"kind\": \"dielectric\", \"ior\": 1.5, \"interior\": {\"sigma_a\": [0.3, 0.9, 2]}"

static const double albedo[3] = {0.9, 0.6, 0.3};
static const struct vec3 lamp = {0.7, 2.5, -0.4}, sun = {0.3, -0.8, 0.1}, ball_center = {0.1, 1, 0.2};
static const struct studio_camera camera = {.position = {0, 3, 4}, .target = {0, 0, -0.2}, .fov = 50};

// A rounding of the position is many times as large near a ball's edge as one of the angle.
static const double near_edge = 3e-5;

enum lamp_kind { LAMP_SQUARE, LAMP_EVEN, LAMP_SUN };

// The lighting of a test's floor.
struct sky {
    enum lamp_kind kind;
    double fog[3]; // absorption everywhere
    bool has_ball; // opaque, or with absorption inside
    bool is_glass;
    double ink[3];
    double ior;
    double f0; // of Schlick's formula; < 0: exact
};

static double pi(void)
{
    return acos(-1.0);
}

// Points `shadow` towards the light and returns its distance, INFINITY for a sun.
static double aim_at_light(const struct sky *sky, struct vec3 place, struct ray *shadow)
{
    struct vec3 way = sky->kind == LAMP_SUN ? vec3_scale(sun, -1.0) : vec3_subtract(lamp, place);

    *shadow = (struct ray){place, vec3_normalize(way)};
    return sky->kind == LAMP_SUN ? INFINITY : vec3_length(way);
}

static double irradiance(const struct sky *sky, double distance, size_t color)
{
    static const double lamps[3] = {9, 12, 15}, suns[3] = {3, 2, 1};

    return sky->kind == LAMP_SQUARE ? lamps[color] / (distance * distance) : suns[color];
}

static double ball_fresnel(const struct sky *sky, double cosine)
{
    // The incidence is from the side of the smaller index, in whichever direction light goes.
    double low = fmin(1.0, sky->ior), high = fmax(1.0, sky->ior);

    if (sky->f0 < 0.0) return optics_fresnel(cosine, low, high);
    return sky->f0 + (1.0 - sky->f0) * pow(1.0 - cosine, 5.0);
}

// Transmittance of a shadow ray, by colour; false near a shadow's edge.
static bool find_transmittance(const struct sky *sky, const struct ray *shadow, double distance, double left[3])
{
    struct vec3 beside = vec3_cross(vec3_subtract(ball_center, shadow->origin), shadow->direction);
    double enter, leave, share = 1.0, chord = 0.0;
    double seen = isinf(distance) ? 0.0 : distance;

    if (sky->has_ball && fabs(vec3_length(beside) / 0.5 - 1.0) < 2e-4) return false;
    if (sky->has_ball && optics_meet_ball(shadow, ball_center, 0.5, &enter, &leave) && leave > 0.0) {
        struct vec3 normal = vec3_normalize(vec3_subtract(ray_at(shadow, enter), ball_center));
        double reflected = ball_fresnel(sky, -vec3_dot(normal, shadow->direction));

        share = sky->is_glass ? (1.0 - reflected) * (1.0 - reflected) : 0.0;
        chord = leave - enter;
    }
    for (size_t c = 0; c < 3; ++c)
        left[c] = share * exp(-sky->fog[c] * (seen - chord) - sky->ink[c] * chord);
    return true;
}

// Pixels count only where the floor is seen directly.
static void lambert(const struct ray *ray, struct studio_light *light, const void *user)
{
    const struct sky *sky = user;
    double enter, leave, distance = optics_meet_plane(ray, (struct vec3){0, 0, 0}, (struct vec3){0, 1, 0}), left[3],
                         way;
    struct ray shadow;
    struct vec3 forward = vec3_normalize(vec3_subtract(camera.target, camera.position));

    if (sky->has_ball && optics_meet_ball(ray, ball_center, 0.501, &enter, &leave)) return;
    way = aim_at_light(sky, ray_at(ray, distance), &shadow);
    if (!find_transmittance(sky, &shadow, way, left)) return;
    for (size_t c = 0; c < 3; ++c)
        light->radiance[c] =
            albedo[c] / pi() * irradiance(sky, way, c) * shadow.direction.y * left[c] * exp(-sky->fog[c] * distance);
    light->alpha = 1.0;
    studio_set_color(light->transmittance, 0.0);
    // The depth may lie in a medium where there is one.
    if (sky->fog[0] == 0.0) light->depth = distance * vec3_dot(ray->direction, forward);
}

static struct studio_scene floor_under(const char *lights, const char *objects)
{
    return (struct studio_scene){
        .width_px = 60, .height_px = 40, .camera = camera, .lights = lights, .objects = objects};
}

static void a_floor_under_a_lamp_is_lamberts(void **state)
{
    const struct studio_scene scene = floor_under(LAMP, FLOOR(""));

    studio_use(*(enum gl_backend *)*state);
    studio_check(&scene, lambert, &(struct sky){.kind = LAMP_SQUARE}, 3e-6, 1);
}

static void a_lamp_may_shine_evenly(void **state)
{
    const struct studio_scene scene = floor_under(EVEN_LAMP, FLOOR(""));

    (void)state;
    studio_check(&scene, lambert, &(struct sky){.kind = LAMP_EVEN}, 3e-6, 1);
}

static void the_sun_shines_evenly(void **state)
{
    const struct studio_scene scene = floor_under(SUN, FLOOR(""));

    (void)state;
    studio_check(&scene, lambert, &(struct sky){.kind = LAMP_SUN}, 3e-6, 1);
}

static void a_ball_throws_a_shadow_with_an_edge(void **state)
{
    const struct studio_scene scenes[] = {
        floor_under(LAMP, FLOOR("") ", " BALL("\"kind\": \"diffuse\", \"albedo\": 0.5")),
        floor_under(LAMP, BALL("\"kind\": \"mirror\"") ", " FLOOR(""))};

    (void)state;
    for (size_t i = 0; i < 2; ++i)
        studio_check(&scenes[i], lambert, &(struct sky){.kind = LAMP_SQUARE, .has_ball = true}, 3e-6, 0.8);
}

static void a_ball_throws_its_shadow_away_from_the_sun(void **state)
{
    const struct studio_scene scene = floor_under(SUN, FLOOR("") ", " BALL("\"kind\": \"diffuse\", \"albedo\": 0.5"));

    (void)state;
    studio_check(&scene, lambert, &(struct sky){.kind = LAMP_SUN, .has_ball = true}, 3e-6, 0.8);
}

static void fog_takes_light_on_both_ways(void **state)
{
    struct studio_scene scene = floor_under(LAMP, FLOOR(""));

    (void)state;
    scene.media = FOG;
    studio_check(&scene, lambert, &(struct sky){.kind = LAMP_SQUARE, .fog = {0.05, 0.1, 0.2}}, 3e-6, 1);
}

static void a_ball_of_ink_throws_a_coloured_shadow(void **state)
{
    const struct sky sky = {
        .kind = LAMP_SQUARE, .has_ball = true, .is_glass = true, .ink = {0.3, 0.9, 2}, .ior = 1.5, .f0 = -1};
    const struct studio_scene scene = floor_under(LAMP, FLOOR("") ", " BALL(INK));

    studio_use(*(enum gl_backend *)*state);
    studio_check(&scene, lambert, &sky, near_edge, 0.8);
}

static void glass_in_fog_keeps_the_fog_out(void **state)
{
    const struct sky sky = {.kind = LAMP_SQUARE,
                            .fog = {0.05, 0.1, 0.2},
                            .has_ball = true,
                            .is_glass = true,
                            .ink = {0.3, 0.9, 2},
                            .ior = 1.5,
                            .f0 = -1};
    struct studio_scene scene = floor_under(LAMP, FLOOR("") ", " BALL(INK));

    (void)state;
    scene.media = FOG;
    studio_check(&scene, lambert, &sky, near_edge, 0.8);
}

// Boundaries reflect nothing totally along a straight line: shadow rays are not bent.
static void thin_balls_throw_no_black_shadow(void **state)
{
    const struct sky sky = {.kind = LAMP_SUN, .has_ball = true, .is_glass = true, .ior = 0.7, .f0 = -1};
    const struct studio_scene scene = floor_under(SUN, FLOOR("") ", " BALL("\"kind\": \"dielectric\", \"ior\": 0.7"));

    (void)state;
    studio_check(&scene, lambert, &sky, near_edge, 0.8);
}

static void shadows_use_schlick(void **state)
{
    const struct sky sky = {.kind = LAMP_SQUARE, .has_ball = true, .is_glass = true, .ior = 1.5, .f0 = 0.2};
    const struct studio_scene scene = floor_under(
        LAMP, FLOOR("") ", " BALL("\"kind\": \"dielectric\", \"ior\": 1.5, \"fresnel\": \"schlick\", \"f0\": 0.2"));

    (void)state;
    studio_check(&scene, lambert, &sky, near_edge, 0.8);
}

static void clear_glass_of_no_fresnel_throws_no_shadow(void **state)
{
    // The glass counts as air.
    const struct sky sky = {.kind = LAMP_SQUARE, .has_ball = true, .is_glass = true, .ior = 1.0, .f0 = -1};
    const struct studio_scene scene =
        floor_under(LAMP, FLOOR("") ", " BALL("\"kind\": \"dielectric\", \"ior\": 1.5, \"fresnel\": \"none\""));

    (void)state;
    studio_check(&scene, lambert, &sky, 3e-6, 0.8);
}

// The background reflects with share F, the rest goes to the albedo.
struct gloss {
    struct sky sky;
    double specular, ior; // without an ior F = 1
    double f0;            // < 0: exact
};

static void lambert_under_gloss(const struct ray *ray, struct studio_light *light, const void *user)
{
    const struct gloss *gloss = user;
    double cosine = -ray->direction.y, reflected = 1.0;

    if (gloss->ior > 0.0 && gloss->f0 < 0.0) reflected = optics_fresnel(cosine, 1.0, gloss->ior);
    if (gloss->ior > 0.0 && gloss->f0 >= 0.0) reflected = optics_schlick(cosine, 1.0, gloss->ior, gloss->f0, 1.0);
    lambert(ray, light, &gloss->sky);
    for (size_t c = 0; c < 3; ++c)
        light->radiance[c] =
            (1.0 - gloss->specular * reflected) * light->radiance[c] + gloss->specular * reflected * (c == 0 ? 1 : 2);
}

static void gloss_takes_its_share_from_the_albedo(void **state)
{
    static const struct gloss glosses[] = {{{.kind = LAMP_SQUARE}, 0.8, 1.5, -1},
                                           {{.kind = LAMP_SQUARE}, 0.5, 1.5, 0.1},
                                           {{.kind = LAMP_SQUARE}, 0.25, 0, 0}};
    const struct studio_scene scenes[] = {
        floor_under(LAMP, FLOOR(", \"specular\": 0.8")),
        floor_under(LAMP, FLOOR(", \"specular\": 0.5, \"fresnel\": \"schlick\", \"f0\": 0.1")),
        floor_under(LAMP, FLOOR(", \"specular\": 0.25, \"fresnel\": \"none\""))};

    (void)state;
    for (size_t i = 0; i < 3; ++i) {
        struct studio_scene scene = scenes[i];

        scene.background = "[1, 2, 2]";
        studio_check(&scene, lambert_under_gloss, &glosses[i], 5e-6, 1);
    }
}

// A wall that stands in the light's plane gets no light, nor does one that faces away.
static void light_from_behind_is_none(void **state)
{
    const struct studio_scene scene = {
        .width_px = 8,
        .height_px = 8,
        .camera = {.position = {0, 0, 4}, .fov = 30},
        .lights =
            "{\"kind\": \"point\", \"position\": [0, 5, -1], \"intensity\": 10}, {\"kind\": \"sun\", \"direction\": "
            "[0, 0, 1], \"intensity\": 5}, {\"kind\": \"sun\", \"direction\": [0, -1, 0], \"intensity\": 5}",
        .objects =
            "{\"kind\": \"plane\", \"point\": [0, 0, 0], \"normal\": [0, 0, 1], \"material\": {\"kind\": \"diffuse\", "
            "\"albedo\": 1}}"};
    struct studio_picture picture;

    (void)state;
    studio_shoot(&scene, &picture);
    for (size_t i = 0; i < 64; ++i) {
        assert_true(picture.image.rgba[4 * i] == 0.0f);
        assert_true(picture.image.rgba[4 * i + 3] == 1.0f);
    }
    studio_finish(&picture);
}

int main(int argument_count, char **arguments)
{
    static enum gl_backend software = GL_BACKEND_SOFTWARE, egl = GL_BACKEND_EGL;
    const struct CMUnitTest tests[] = {
        {"a_floor_under_a_lamp_is_lamberts_egl", a_floor_under_a_lamp_is_lamberts, NULL, NULL, &egl},
        {"a_ball_of_ink_throws_a_coloured_shadow_egl", a_ball_of_ink_throws_a_coloured_shadow, NULL, NULL, &egl},
        {"a_floor_under_a_lamp_is_lamberts_software", a_floor_under_a_lamp_is_lamberts, NULL, NULL, &software},
        {"a_ball_of_ink_throws_a_coloured_shadow_software", a_ball_of_ink_throws_a_coloured_shadow, NULL, NULL,
         &software},
        cmocka_unit_test(a_lamp_may_shine_evenly),
        cmocka_unit_test(the_sun_shines_evenly),
        cmocka_unit_test(a_ball_throws_a_shadow_with_an_edge),
        cmocka_unit_test(a_ball_throws_its_shadow_away_from_the_sun),
        cmocka_unit_test(fog_takes_light_on_both_ways),
        cmocka_unit_test(glass_in_fog_keeps_the_fog_out),
        cmocka_unit_test(thin_balls_throw_no_black_shadow),
        cmocka_unit_test(shadows_use_schlick),
        cmocka_unit_test(clear_glass_of_no_fresnel_throws_no_shadow),
        cmocka_unit_test(gloss_takes_its_share_from_the_albedo),
        cmocka_unit_test(light_from_behind_is_none),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, studio_close);
}
