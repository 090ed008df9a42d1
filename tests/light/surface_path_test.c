// Paths of many segments: mirrors, limits, clips, moving objects, and independence of the method.
// SPDX-License-Identifier: Apache-2.0
#include "core/job/job.h"
#include "tests/support/assert_near.h"
#include "tests/support/studio.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

// The two walls are 6 m long, 2 m apart and face one another.
#define CORRIDOR                                                                                                       \
    "{\"kind\": \"box\", \"center\": [3, 1.5, 0], \"size\": [6, 1, 100], \"material\": {\"kind\": \"mirror\", "        \
    "\"reflectance\": [0.9, 0.6, 0.5]}}, "                                                                             \
    "{\"kind\": \"box\", \"center\": [3, -1.5, 0], \"size\": [6, 1, 100], \"material\": {\"kind\": \"mirror\", "       \
    "\"reflectance\": [0.9, 0.6, 0.5]}}"

// The number of reflections of a ray; -1 where it hits an edge.
static int count_reflections(const struct ray *ray)
{
    double height = fabs(ray->origin.y + (6.0 - ray->origin.x) * ray->direction.y / ray->direction.x);
    double crossings = 0.5 * (height + 1.0);

    return fabs(crossings - round(crossings)) < 1e-4 ? -1 : (int)floor(crossings);
}

static void facing_mirrors(const struct ray *ray, struct studio_light *light, const void *user)
{
    static const double reflectance[3] = {0.9, 0.6, 0.5};
    int count = count_reflections(ray), limit = *(const int *)user;

    if (count < 0) return;
    for (size_t c = 0; c < 3; ++c)
        light->radiance[c] = count <= limit ? pow(reflectance[c], count) : 0.0;
    studio_set_color(light->transmittance, count == 0 ? 1.0 : 0.0);
}

static struct studio_scene corridor(const char *quality)
{
    return (struct studio_scene){.width_px = 40,
                                 .height_px = 40,
                                 .camera = {.position = {0.5, 0.24, 0}, .target = {1.5, 0.33, 0.1}, .fov = 110},
                                 .background = "1",
                                 .objects = CORRIDOR,
                                 .quality = quality};
}

static void mirrors_face_one_another(void **state)
{
    const int limit = 32;
    const struct studio_scene scene =
        corridor("\"method\": \"midpoint\", \"step\": 1, \"max_depth\": 32, \"min_throughput\": 0");

    studio_use(*(enum gl_backend *)*state);
    studio_check(&scene, facing_mirrors, &limit, 1e-5, 0.95);
}

// The last ray that is followed has this depth; the ray after it is counted as cut.
static void depth_ends_at_its_limit(void **state)
{
    const struct studio_scene scene =
        corridor("\"method\": \"midpoint\", \"step\": 1, \"max_depth\": 2, \"max_cut\": 1, \"min_throughput\": 0");
    const int limit = 2;
    double cut = 0.0, cut_rays = 0.0, rays = 0.0;
    struct studio_picture picture;

    (void)state;
    studio_shoot(&scene, &picture);
    studio_expect(&scene, &picture, facing_mirrors, &limit, 1e-5, 0.95);
    for (int i = 0; i < 1600; ++i) {
        struct ray ray = studio_ray(&scene, i % 40, i / 40);
        int count = count_reflections(&ray);

        assert_true(count >= 0);
        rays += 1 + fmin(count, 2);
        if (count > 2) cut += (pow(0.9, 3) + pow(0.6, 3) + pow(0.5, 3)) / 3.0;
        if (count > 2) cut_rays += 1;
    }
    assert_true(picture.result.ray_counts.is_known && cut > 0.0);
    assert_near(picture.result.ray_counts.cut_throughput, cut / 1600, 1e-5);
    assert_near(picture.result.ray_counts.cut_rays, cut_rays / 1600, 1e-5);
    assert_near(picture.result.ray_counts.rays, rays / 1600, 1e-5);
    studio_finish(&picture);
}

// Throughputs are 0.9, 0.81, 0.73, 0.66: the brightest colour decides.
static void a_faint_ray_ends(void **state)
{
    const struct studio_scene scene =
        corridor("\"method\": \"midpoint\", \"step\": 1, \"max_depth\": 32, \"max_cut\": 1, \"min_throughput\": 0.7");
    const int limit = 3;

    (void)state;
    studio_check(&scene, facing_mirrors, &limit, 1e-5, 0.95);
}

#define FOG "{\"density\": {\"kind\": \"homogeneous\"}, \"sigma_a\": [0.1, 0.2, 0.4]}"
#define WALL_MIRROR                                                                                                    \
    "{\"kind\": \"plane\", \"point\": [0, 0, -2], \"normal\": [0, 0, 1], \"material\": {\"kind\": \"mirror\"}}"

// Fog fills 1 m to 5 m of the path, wherever the mirror is.
static void clip_goes_on_behind_a_mirror(void **state)
{
    struct studio_scene scene = {
        .width_px = 8,
        .height_px = 8,
        .camera = {.position = {0, 0, 0}, .target = {0, 0, -1}, .fov = 60, .near = 1, .far = 5},
        .background = "1",
        .media = FOG,
        .objects = WALL_MIRROR};
    struct studio_picture picture;

    (void)state;
    studio_shoot(&scene, &picture);
    for (int i = 0; i < 64; ++i)
        for (int c = 0; c < 3; ++c)
            assert_near(picture.image.rgba[4 * i + c], exp(-4 * 0.1 * (1 << c)), 1e-5);
    studio_finish(&picture);
}

// Two walls stand at right angles: rays meet both, 3 m to 6 m from the camera, and leave.
static void clip_goes_on_behind_two_mirrors(void **state)
{
    const struct studio_scene scene = {
        .width_px = 8,
        .height_px = 8,
        .camera = {.position = {0, 0, 0}, .target = {0, 0, -1}, .fov = 30, .near = 1, .far = 9},
        .background = "1",
        .media = FOG,
        .objects = "{\"kind\": \"plane\", \"point\": [0, 0, -4], \"normal\": [1, 0, 1], \"material\": {\"kind\": "
                   "\"mirror\"}}, {\"kind\": \"plane\", \"point\": [0, 0, -4], \"normal\": [-1, 0, 1], \"material\": "
                   "{\"kind\": \"mirror\"}}"};
    struct studio_picture picture;

    (void)state;
    studio_shoot(&scene, &picture);
    assert_near(picture.result.ray_counts.rays, 3.0, 0.0);
    for (int i = 0; i < 64; ++i)
        for (int c = 0; c < 3; ++c)
            assert_near(picture.image.rgba[4 * i + c], exp(-8 * 0.1 * (1 << c)), 1e-5);
    studio_finish(&picture);
}

// A pane of 1 m, 1 m away, sends on the reflected ray first and the refracted one after that: 3 m of 4 are fog.
static void clip_goes_on_along_rays_that_wait(void **state)
{
    const struct studio_scene scene = {
        .width_px = 1,
        .height_px = 1,
        .camera = {.position = {0, 0, 0}, .target = {0, 0, -1}, .fov = 1, .near = 1e-9, .far = 4},
        .media = FOG,
        .objects = "{\"kind\": \"box\", \"center\": [0, 0, -1.5], \"size\": [9, 9, 1], \"material\": {\"kind\": "
                   "\"dielectric\", \"ior\": 1.5}}"};
    struct studio_picture picture;

    (void)state;
    studio_shoot(&scene, &picture);
    for (int c = 0; c < 3; ++c)
        assert_near(picture.image.transmittance[c], 0.96 * 0.96 * exp(-3 * 0.1 * (1 << c)), 1e-5);
    studio_finish(&picture);
}

// A screen passes half of the light, a mirror behind it reflects 0.4. Half of that passes the screen again, to a wall
// of radiance 1 behind the camera.
static double light_by_screen(const char *min_transmittance)
{
    char quality[128];
    const struct studio_scene scene = {
        .width_px = 1,
        .height_px = 1,
        .camera = {.position = {0, 0, 0}, .target = {0, 0, -1}, .fov = 1},
        .lights = "{\"kind\": \"sun\", \"direction\": [-1, 0, 0.2], \"intensity\": 16.01904212}", // pi / cosine
        .media = "{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"box\", \"center\": [0, 0, -1], "
                 "\"size\": [1, 1, 1]}}, \"sigma_a\": 0.69314718056}",
        .objects =
            "{\"kind\": \"box\", \"center\": [0, 0, -2.5], \"size\": [1, 1, 1], \"material\": {\"kind\": "
            "\"mirror\", \"reflectance\": 0.4}}, {\"kind\": \"plane\", \"point\": [0, 0, 2], \"normal\": [0, 0, -1], "
            "\"material\": {\"kind\": \"diffuse\", \"albedo\": 1}}",
        .quality = quality};
    struct studio_picture picture;
    double light;

    snprintf(quality, sizeof quality, "\"method\": \"midpoint\", \"step\": 0.1, \"min_transmittance\": %s",
             min_transmittance);
    studio_shoot(&scene, &picture);
    light = picture.image.rgba[0];
    studio_finish(&picture);
    return light;
}

// A ray that has ended meets no surface; the minimum counts the transmittance of each ray from where it was sent.
static void ended_rays_meet_no_surface(void **state)
{
    (void)state;
    assert_near(light_by_screen("0"), 0.1, 1e-5);
    assert_near(light_by_screen("0.4"), 0.1, 1e-5);
    assert_near(light_by_screen("0.6"), 0.0, 0.0);
}

// The camera is 1 m above an absorbing pane of 1 m: the part of the refracted path in it before the clip's end counts.
static void clipped_pane(const struct ray *ray, struct studio_light *light, const void *user)
{
    double cosine = -ray->direction.y, inside = sqrt(1.0 - (1.0 - cosine * cosine) / (1.5 * 1.5));
    double in_ink = fmax(0.0, fmin(1.0 / inside, 1.9 - 1.0 / cosine));

    (void)user;
    for (size_t c = 0; c < 3; ++c)
        light->transmittance[c] = exp(-(double)(c + 1) * in_ink);
}

static void clip_goes_along_bent_rays(void **state)
{
    const struct studio_scene scene = {
        .width_px = 4,
        .height_px = 40,
        .camera = {.position = {0, 1, 0}, .target = {0, 0, 0.5}, .fov = 70, .near = 0.5, .far = 1.9},
        .objects = "{\"kind\": \"box\", \"center\": [0, -0.5, 0], \"size\": [90, 1, 90], \"material\": {\"kind\": "
                   "\"dielectric\", \"ior\": 1.5, \"fresnel\": \"none\", \"interior\": {\"sigma_a\": [1, 2, 3]}}}"};

    (void)state;
    studio_check(&scene, clipped_pane, NULL, 1e-5, 1);
}

#define LAMP "{\"kind\": \"point\", \"position\": [1.5, 2, 1], \"intensity\": [9, 8, 7]}"
#define SMOKY_BALL                                                                                                     \
    "{\"kind\": \"plane\", \"point\": [0, -1, 0], \"material\": {\"kind\": \"diffuse\", \"albedo\": 0.7, "             \
    "\"specular\": "                                                                                                   \
    "0.3}}, {\"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 0.9, \"material\": {\"kind\": \"dielectric\", "  \
    "\"ior\": 1.4, \"interior\": {\"sigma_s\": [0.8, 0.5, 0.3], \"sigma_a\": 0.2, \"phase\": [{\"g\": 0.4}]}}}"
#define THIN_FOG                                                                                                       \
    "{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"sphere\", \"radius\": 3}}, \"sigma_s\": 0.1}"

static struct studio_scene smoky_ball(const char *quality)
{
    return (struct studio_scene){.width_px = 24,
                                 .height_px = 20,
                                 .camera = {.position = {0.5, 0.8, 3}, .target = {0, -0.1, 0}, .fov = 45},
                                 .background = "[0.2, 0.3, 0.5]",
                                 .lights = LAMP,
                                 .media = THIN_FOG,
                                 .objects = SMOKY_BALL,
                                 .quality = quality};
}

static double relative_rmse(const struct image *a, const struct image *b)
{
    double difference = 0.0, square = 0.0;

    for (int i = 0; i < 4 * a->width_px * a->height_px; ++i) {
        if (i % 4 == 3) continue;
        difference += pow((double)a->rgba[i] - b->rgba[i], 2);
        square += pow(b->rgba[i], 2);
    }
    return sqrt(difference / square);
}

static void methods_agree(void **state)
{
    static const char limits[] = ", \"max_depth\": 5, \"max_cut\": 1, \"min_throughput\": 0.001";
    char qualities[3][256];
    struct studio_picture pictures[3];

    (void)state;
    snprintf(qualities[0], sizeof qualities[0], "\"method\": \"midpoint\", \"step\": 0.01%s", limits);
    snprintf(qualities[1], sizeof qualities[1], "\"method\": \"equiangular\", \"points\": 100%s", limits);
    snprintf(qualities[2], sizeof qualities[2], "\"method\": \"jittered\", \"step\": 0.02%s", limits);
    for (int i = 0; i < 3; ++i) {
        const struct studio_scene scene = smoky_ball(qualities[i]);

        studio_shoot(&scene, &pictures[i]);
    }
    // The ball's shadow in the fog has an edge, to which points converge slowly: 24 points are three times as far off.
    assert_true(relative_rmse(&pictures[0].image, &pictures[1].image) < 4e-4);
    // Jittered has random errors that exceed the errors of midpoint's steps.
    print_message("jittered is off by %.1e\n", relative_rmse(&pictures[2].image, &pictures[1].image));
    assert_true(relative_rmse(&pictures[2].image, &pictures[1].image) < 1e-3);
    for (int i = 0; i < 3; ++i)
        studio_finish(&pictures[i]);
}

// The picture is linear in the background: the lights' part and a multiple of the background's part.
static void background_light_adds(void **state)
{
    static const char quality[] = "\"method\": \"equiangular\", \"points\": 6, \"max_depth\": 5, \"max_cut\": 1";
    static const char *const backgrounds[] = {"0", "[1, 1, 1]", "[0.25, 3, 0.5]"};
    static const double third[3] = {0.25, 3, 0.5};
    struct studio_picture pictures[3];

    (void)state;
    for (int i = 0; i < 3; ++i) {
        struct studio_scene scene = smoky_ball(quality);

        scene.background = backgrounds[i];
        studio_shoot(&scene, &pictures[i]);
    }
    for (int i = 0; i < 4 * 24 * 20; ++i) {
        double black = pictures[0].image.rgba[i], white = pictures[1].image.rgba[i];

        if (i % 4 == 3) continue;
        assert_near(pictures[2].image.rgba[i], black + third[i % 4] * (white - black), 2e-6);
        // Light that passes in a straight line is a part of all light that passes.
        assert_true(white - black >= pictures[1].image.transmittance[i] - 1e-6);
    }
    for (int i = 0; i < 3; ++i)
        studio_finish(&pictures[i]);
}

static void assert_same(const struct image *a, const struct image *b, double tolerance)
{
    for (int i = 0; i < 4 * a->width_px * a->height_px; ++i)
        assert_near(a->rgba[i], b->rgba[i], tolerance);
}

#define MOVING_BALL(center, ior, sigma)                                                                                \
    "{\"kind\": \"plane\", \"point\": [0, -1, 0], \"material\": {\"kind\": \"diffuse\", \"albedo\": 0.7}}, "           \
    "{\"kind\": "                                                                                                      \
    "\"sphere\", \"center\": " center ", \"radius\": 0.5, \"material\": {\"kind\": \"dielectric\", \"ior\": " ior      \
    ", \"interior\": {\"sigma_a\": " sigma "}}}"

static struct studio_picture moved(const char *objects, int32_t frame)
{
    struct studio_scene scene = smoky_ball("\"method\": \"equiangular\", \"points\": 6, \"max_cut\": 1");
    struct studio_picture picture;
    struct job job = {0};

    scene.objects = objects;
    scene.frames = "0-48";
    studio_parse(&job, &scene);
    studio_render(&job, frame, &picture);
    job_finish(&job);
    return picture;
}

static void moving_objects_equal_still_ones(void **state)
{
    // The ball is at the same position, of the same glass and ink, at frame 12, at frame 24 and in the job where it is
    // still.
    struct studio_picture pictures[] = {
        moved(MOVING_BALL("{\"start\": [-0.5, 0, 0], \"rate\": [1, 0.5, 0]}", "{\"start\": 1.25, \"rate\": 0.5}",
                          "{\"start\": 0.5, \"rate\": 1}"),
              12),
        moved(MOVING_BALL("{\"start\": [-1, 0, 0], \"rate\": [1, 0.25, 0]}", "{\"start\": 1, \"rate\": 0.5}",
                          "{\"start\": 0, \"rate\": 1}"),
              24),
        moved(MOVING_BALL("[0, 0.25, 0]", "1.5", "1"), 0)};

    (void)state;
    assert_same(&pictures[0].image, &pictures[1].image, 0.0);
    // Constant numbers are folded into the program.
    assert_same(&pictures[0].image, &pictures[2].image, 2e-5);
    for (int i = 0; i < 3; ++i)
        studio_finish(&pictures[i]);
}

// The edge of a wall passes the pixel after a quarter of the time that the shutter is open.
static void moving_objects_are_blurred(void **state)
{
    const struct studio_scene scene = {
        .width_px = 3,
        .height_px = 3,
        .camera = {.fov = 1e-3},
        .moving_camera = "\"position\": [0, 0, 4], \"target\": [0, 0, 0], \"shutter\": 1",
        .objects =
            "{\"kind\": \"box\", \"size\": [2, 2, 2], \"center\": {\"start\": [-1.25, 0, 0], \"rate\": [24, 0, 0]}, "
            "\"material\": {\"kind\": \"dielectric\", \"ior\": 1, \"interior\": {\"sigma_a\": 1}}}",
        .quality = "\"method\": \"equiangular\", \"points\": 4, \"samples\": 64"};
    struct studio_picture picture;

    (void)state;
    studio_shoot(&scene, &picture);
    for (int i = 0; i < 9; ++i)
        assert_near(picture.image.transmittance[4 * i], 0.25 + 0.75 * exp(-2.0), 1.0 / 64);
    studio_finish(&picture);
}

int main(int argument_count, char **arguments)
{
    static enum gl_backend software = GL_BACKEND_SOFTWARE, egl = GL_BACKEND_EGL;
    const struct CMUnitTest tests[] = {
        {"mirrors_face_one_another_egl", mirrors_face_one_another, NULL, NULL, &egl},
        {"mirrors_face_one_another_software", mirrors_face_one_another, NULL, NULL, &software},
        cmocka_unit_test(depth_ends_at_its_limit),
        cmocka_unit_test(a_faint_ray_ends),
        cmocka_unit_test(clip_goes_on_behind_a_mirror),
        cmocka_unit_test(clip_goes_on_behind_two_mirrors),
        cmocka_unit_test(clip_goes_on_along_rays_that_wait),
        cmocka_unit_test(clip_goes_along_bent_rays),
        cmocka_unit_test(ended_rays_meet_no_surface),
        cmocka_unit_test(methods_agree),
        cmocka_unit_test(background_light_adds),
        cmocka_unit_test(moving_objects_equal_still_ones),
        cmocka_unit_test(moving_objects_are_blurred),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, studio_close);
}
