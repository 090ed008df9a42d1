// Paths of light through glass balls and slabs, and absorption along them, against the path by Snell's law.
// SPDX-License-Identifier: Apache-2.0
#include "core/job/job.h"
#include "tests/support/optics.h"
#include "tests/support/studio.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define WALL                                                                                                           \
    "{\"kind\": \"plane\", \"point\": [0, 0, -3], \"normal\": [0, 0, 1], \"material\": {\"kind\": \"diffuse\", "       \
    "\"albedo\": 0.8}}, "
// The lamps are between ball and wall: each point of the wall has a colour of its own, and no glass shadows it.
#define LAMPS                                                                                                          \
    "{\"kind\": \"point\", \"position\": [2.5, 2, -2], \"intensity\": [3, 0, 0]}, "                                    \
    "{\"kind\": \"point\", \"position\": [-2.5, 1.5, -1.9], \"intensity\": [0, 3, 0]}, "                               \
    "{\"kind\": \"point\", \"position\": [0.5, -2.5, -2], \"intensity\": [0, 0, 3]}"
#define BALL(radius, ior, more)                                                                                        \
    "{\"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": " radius                                                \
    ", \"material\": {\"kind\": \"dielectric\", \"ior\": " ior more "}}"
#define DEEP "\"method\": \"equiangular\", \"points\": 8, \"max_depth\": 32, \"min_throughput\": 1e-7"

static const struct studio_camera camera = {.position = {0.3, 0.2, 4}, .target = {0, 0, 0}, .fov = 38};

// Concentric balls, outermost first.
struct onion {
    size_t count;
    double radii[3], iors[3];
    double sigma[3][3]; // absorption inside, per metre
};

static double wall_light(const struct vec3 *point, size_t color)
{
    static const struct vec3 lamps[3] = {{2.5, 2, -2}, {-2.5, 1.5, -1.9}, {0.5, -2.5, -2}};
    struct vec3 way = vec3_subtract(lamps[color], *point);
    double square = vec3_dot(way, way);

    return 0.8 / acos(-1.0) * 3.0 * way.z / sqrt(square) / square;
}

// Adds the light where a ray ends: that of the wall, or none.
static void add_wall(const struct ray *ray, double share, struct studio_light *light)
{
    double distance = optics_meet_plane(ray, (struct vec3){0, 0, -3}, (struct vec3){0, 0, 1});
    struct vec3 point;

    if (isinf(distance)) return;
    point = ray_at(ray, distance);
    for (size_t c = 0; c < 3; ++c)
        light->radiance[c] += share * wall_light(&point, c);
}

// Follows the path that is refracted wherever it can be, else reflected. False where a ball is grazed, or near the
// critical angle.
static bool follow(const struct onion *onion, struct ray *ray, double optical_depth[3])
{
    size_t layers = 0; // balls around the ray's origin
    double enter, leave;

    for (int iteration = 0; iteration < 20; ++iteration) {
        double edge, in, out, sine;
        struct vec3 normal, onwards;
        bool enters = layers < onion->count &&
                      optics_meet_ball(ray, (struct vec3){0, 0, 0}, onion->radii[layers], &enter, &leave) &&
                      enter > 0.0;

        if (layers < onion->count) {
            double nearest = -vec3_dot(ray->origin, ray->direction);

            edge = vec3_length(ray_at(ray, nearest));
            if (fabs(edge / onion->radii[layers] - 1.0) < 2e-3) return false;
        }
        if (!enters && layers == 0) return true;
        if (!enters) optics_meet_ball(ray, (struct vec3){0, 0, 0}, onion->radii[layers - 1], &edge, &enter);
        for (size_t c = 0; c < 3 && layers > 0; ++c)
            optical_depth[c] += enter * onion->sigma[layers - 1][c];
        ray->origin = ray_at(ray, enter);
        normal = vec3_normalize(ray->origin);
        in = layers == 0 ? 1.0 : onion->iors[layers - 1];
        layers = enters ? layers + 1 : layers - 1;
        out = layers == 0 ? 1.0 : onion->iors[layers - 1];
        sine = in / out * vec3_length(vec3_cross(ray->direction, normal));
        if (fabs(sine - 1.0) < 2e-3) return false;
        if (optics_refract(ray->direction, normal, in, out, &onwards)) {
            ray->direction = onwards;
        } else {
            ray->direction = optics_reflect(ray->direction, normal);
            layers = enters ? layers - 1 : layers + 1;
        }
        // The origin is moved off the surface, so that rounding does not make the ray meet it again.
        ray->origin = vec3_add(ray->origin, vec3_scale(ray->direction, 1e-12));
    }
    return false;
}

static void wall_through_onion(const struct ray *ray, struct studio_light *light, const void *user)
{
    struct ray path = *ray;
    double optical_depth[3] = {0, 0, 0};
    struct studio_light wall = {.radiance = {0, 0, 0}};

    if (!follow(user, &path, optical_depth)) return;
    add_wall(&path, 1.0, &wall);
    for (size_t c = 0; c < 3; ++c)
        light->radiance[c] = wall.radiance[c] * exp(-optical_depth[c]);
}

static void a_ball_shows_the_wall_where_snell_says(void **state)
{
    const struct onion onion = {.count = 1, .radii = {1}, .iors = {1.5}};
    const struct studio_scene scene = {.width_px = 40,
                                       .height_px = 32,
                                       .camera = camera,
                                       .lights = LAMPS,
                                       .objects = WALL BALL("1", "1.5", ", \"fresnel\": \"none\""),
                                       .quality = DEEP};

    studio_use(*(enum gl_backend *)*state);
    studio_check(&scene, wall_through_onion, &onion, 3e-5, 0.9);
}

static void a_bubble_in_glass_bends_light_the_other_way(void **state)
{
    const struct onion onion = {.count = 2, .radii = {1, 0.7}, .iors = {1.5, 1}, .sigma = {{0.3, 0.6, 0.9}, {0, 0, 0}}};
    const struct studio_scene scene = {
        .width_px = 40,
        .height_px = 32,
        .camera = camera,
        .lights = LAMPS,
        .objects =
            WALL BALL("1", "1.5", ", \"fresnel\": \"none\", \"interior\": {\"sigma_a\": [0.3, 0.6, 0.9]}") ", " BALL(
                "0.7", "1", ", \"fresnel\": \"none\""),
        .quality = DEEP};

    (void)state;
    studio_check(&scene, wall_through_onion, &onion, 1e-4, 0.8);
}

static void each_layer_takes_its_own_part(void **state)
{
    const struct onion onion = {.count = 3,
                                .radii = {1, 0.8, 0.45},
                                .iors = {1.3, 1.6, 1.1},
                                .sigma = {{0.3, 0.6, 0.9}, {1, 0.5, 0.2}, {0.1, 2, 0.4}}};
    const struct studio_scene scene = {
        .width_px = 40,
        .height_px = 32,
        .camera = camera,
        .lights = LAMPS,
        .objects =
            WALL BALL("1", "1.3", ", \"fresnel\": \"none\", \"interior\": {\"sigma_a\": [0.3, 0.6, 0.9]}") ", " BALL(
                "0.8", "1.6",
                ", \"fresnel\": \"none\", \"interior\": {\"sigma_a\": [1, 0.5, 0.2]}") ", " BALL("0.45", "1.1",
                                                                                                 ", \"fresnel\": "
                                                                                                 "\"none\", "
                                                                                                 "\"interior\": "
                                                                                                 "{\"sigma_a\": [0.1, "
                                                                                                 "2, 0.4]}"),
        .quality = DEEP};

    (void)state;
    studio_check(&scene, wall_through_onion, &onion, 1e-4, 0.8);
}

// Sums all orders of reflection: each crosses the ball once more, at the same angle.
static void all_orders(const struct ray *ray, struct studio_light *light, const void *user)
{
    const double *sigma = user;
    double beside = vec3_length(vec3_cross(ray->origin, ray->direction)), out, reflected;

    if (fabs(beside - 1.0) < 1e-3) return;
    light->alpha = 1.0;
    if (beside > 1.0) {
        studio_set_color(light->radiance, 1.0);
        studio_set_color(light->transmittance, 1.0);
        return;
    }
    out = sqrt(1.0 - beside * beside / (1.5 * 1.5));
    reflected = optics_fresnel(sqrt(1.0 - beside * beside), 1.0, 1.5);
    for (size_t c = 0; c < 3; ++c) {
        double kept = exp(-sigma[c] * 2.0 * out), through = (1.0 - reflected) * (1.0 - reflected) * kept;

        light->transmittance[c] = through;
        light->radiance[c] = reflected + through / (1.0 - reflected * kept);
    }
}

static void a_ball_of_ink_is_beer_and_lambert_along_the_chord(void **state)
{
    static const double sigma[3] = {0.1, 0.7, 2.5};
    const struct studio_scene scene = {.width_px = 48,
                                       .height_px = 40,
                                       .camera = {.position = {0.2, 0.1, 4}, .fov = 32},
                                       .background = "1",
                                       .objects = BALL("1", "1.5", ", \"interior\": {\"sigma_a\": [0.1, 0.7, 2.5]}"),
                                       .quality = DEEP};

    studio_use(*(enum gl_backend *)*state);
    // A rounding of the position is many times as large near the edge as one of the angle.
    studio_check(&scene, all_orders, sigma, 3e-5, 0.9);
}

static void midpoint_steps_through_ink_as_well(void **state)
{
    static const double sigma[3] = {0.1, 0.7, 2.5};
    const struct studio_scene scene = {
        .width_px = 24,
        .height_px = 20,
        .camera = {.position = {0.2, 0.1, 4}, .fov = 32},
        .background = "1",
        .objects = BALL("1", "1.5", ", \"interior\": {\"sigma_a\": [0.1, 0.7, 2.5]}"),
        .quality = "\"method\": \"midpoint\", \"step\": 0.05, \"max_depth\": 16, \"min_throughput\": 1e-6"};

    (void)state;
    studio_check(&scene, all_orders, sigma, 3e-5, 0.9);
}

// The pane of 0.4 m fills the whole view: light is reflected between its faces in all orders.
static void through_pane(const struct ray *ray, struct studio_light *light, const void *user)
{
    double cosine = fabs(ray->direction.y), inside = sqrt(1.0 - (1.0 - cosine * cosine) / (1.6 * 1.6));
    double reflected = optics_fresnel(cosine, 1.0, 1.6);
    const double *sigma = user;

    for (size_t c = 0; c < 3; ++c) {
        double kept = exp(-sigma[c] * 0.4 / inside), through = (1.0 - reflected) * (1.0 - reflected) * kept;

        light->transmittance[c] = through;
        light->radiance[c] = reflected + through / (1.0 - reflected * kept);
    }
}

static void a_pane_reflects_between_its_faces(void **state)
{
    static const double sigma[3] = {0.4, 1.5, 6};
    const struct studio_scene scene = {
        .width_px = 3,
        .height_px = 60,
        .camera = {.position = {0, 1, 0}, .target = {0, 0, 1}, .fov = 84},
        .background = "1",
        .objects = "{\"kind\": \"box\", \"center\": [0, -0.2, 0], \"size\": [400, 0.4, 400], \"material\": {\"kind\": "
                   "\"dielectric\", \"ior\": 1.6, \"interior\": {\"sigma_a\": [0.4, 1.5, 6]}}}",
        .quality = DEEP};

    (void)state;
    studio_check(&scene, through_pane, sigma, 1e-5, 0.95);
}

// Rays from the middle are not refracted; all others are, and those beyond the critical angle are reflected for ever.
static void out_of_ball(const struct ray *ray, struct studio_light *light, const void *user)
{
    double enter, leave, cosine;

    (void)user;
    optics_meet_ball(ray, (struct vec3){0, 0, 0}, 1.0, &enter, &leave);
    cosine = vec3_dot(ray_at(ray, leave), ray->direction);
    if (fabs(1.5 * sqrt(1.0 - cosine * cosine) - 1.0) < 2e-3) return;
    studio_set_color(light->transmittance, (1.0 - optics_fresnel(cosine, 1.5, 1.0)) * exp(-0.5 * leave));
}

static void from_inside_a_ball_light_is_caught_beyond_the_critical_angle(void **state)
{
    struct studio_scene scene = {.width_px = 48,
                                 .height_px = 48,
                                 .camera = {.position = {0.9, 0, 0}, .target = {0.9, 0, 1}, .fov = 120},
                                 .objects = BALL("1", "1.5", ", \"interior\": {\"sigma_a\": 0.5}"),
                                 .quality = DEEP ", \"max_cut\": 1"};

    (void)state;
    studio_check(&scene, out_of_ball, NULL, 1e-5, 0.95);
    scene.camera = (struct studio_camera){.position = {0, 0, 0}, .target = {0.2, 0.3, 1}, .fov = 120};
    studio_check(&scene, out_of_ball, NULL, 1e-5, 0.95);
}

int main(int argument_count, char **arguments)
{
    static enum gl_backend software = GL_BACKEND_SOFTWARE, egl = GL_BACKEND_EGL;
    const struct CMUnitTest tests[] = {
        {"a_ball_shows_the_wall_where_snell_says_egl", a_ball_shows_the_wall_where_snell_says, NULL, NULL, &egl},
        {"a_ball_of_ink_is_beer_and_lambert_along_the_chord_egl", a_ball_of_ink_is_beer_and_lambert_along_the_chord,
         NULL, NULL, &egl},
        {"a_ball_shows_the_wall_where_snell_says_software", a_ball_shows_the_wall_where_snell_says, NULL, NULL,
         &software},
        {"a_ball_of_ink_is_beer_and_lambert_along_the_chord_software",
         a_ball_of_ink_is_beer_and_lambert_along_the_chord, NULL, NULL, &software},
        cmocka_unit_test(a_bubble_in_glass_bends_light_the_other_way),
        cmocka_unit_test(each_layer_takes_its_own_part),
        cmocka_unit_test(midpoint_steps_through_ink_as_well),
        cmocka_unit_test(a_pane_reflects_between_its_faces),
        cmocka_unit_test(from_inside_a_ball_light_is_caught_beyond_the_critical_angle),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, studio_close);
}
