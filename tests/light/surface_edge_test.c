// Rays in degenerate positions: all values are finite, and no light is gained or lost.
// SPDX-License-Identifier: Apache-2.0
// Rays run along faces and edges, through corners, tangent to balls and from surfaces, and where objects touch and
// coincide.
#include "core/job/job.h"
#include "tests/support/assert_near.h"
#include "tests/support/random.h"
#include "tests/support/studio.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define SPHERE(x, y, z, radius, material)                                                                              \
    "{\"kind\": \"sphere\", \"center\": [" #x ", " #y ", " #z "], \"radius\": " #radius ", \"material\": {" material   \
    "}}"
#define BOX(x, y, z, a, b, c, material)                                                                                \
    "{\"kind\": \"box\", \"center\": [" #x ", " #y ", " #z "], \"size\": [" #a ", " #b ", " #c                         \
    "], \"material\": {" material "}}"
#define PLANE(y, material) "{\"kind\": \"plane\", \"point\": [0, " #y ", 0], \"material\": {" material "}}"
#define GLASS(ior) "\"kind\": \"dielectric\", \"ior\": " #ior
#define SMOKE(ior) GLASS(ior) ", \"roughness\": 0.1, \"interior\": {\"sigma_s\": 1, \"sigma_a\": 0.2}"
#define WHITE "\"kind\": \"diffuse\", \"albedo\": 1"
#define GLOSS WHITE ", \"specular\": 1, \"roughness\": 1"
#define MIRROR "\"kind\": \"mirror\""
#define QUALITY                                                                                                        \
    "\"method\": \"equiangular\", \"points\": 3, \"max_cut\": 1, \"max_depth\": 8, \"min_throughput\": 0.001"

enum { FRAMES = 400 };

// Coordinates of the scenes' faces, edges, centres and touching points.
static const double nice[] = {-2, -1.5, -1, -0.5, 0, 0.5, 1, 1.5, 2, 1e-7, -1e-7, 0.9999999, 3};

static double nice_number(struct random *random)
{
    return nice[(int)random_between(random, 0, sizeof nice / sizeof *nice)];
}

static void write_point(FILE *out, double time, const double place[3])
{
    fprintf(out, "%s[%.9g, [%.9g, %.9g, %.9g]]", time < 0 ? "" : ", ", time, place[0], place[1], place[2]);
}

// Keys of one camera a frame, from a point with nice numbers towards another, mostly along axes and planes. Owned by
// the caller.
static char *write_cameras(uint64_t seed, double scale, double shift)
{
    char *text = NULL, *targets = NULL;
    size_t length, targets_length;
    FILE *out = open_memstream(&text, &length), *aims = open_memstream(&targets, &targets_length);
    struct random random = {seed};

    fputs("\"position\": {\"interpolation\": \"hold\", \"keys\": [", out);
    for (int frame = 0; frame < FRAMES; ++frame) {
        double from[3], to[3];

        do {
            for (int i = 0; i < 3; ++i) {
                from[i] = nice_number(&random);
                to[i] = random_between(&random, 0, 1) < 0.4 ? from[i] : nice_number(&random);
            }
        } while ((from[0] == to[0] && from[2] == to[2]) || hypot(from[0] - to[0], from[2] - to[2]) < 0.1);
        for (int i = 0; i < 3; ++i) {
            double way = to[i] - from[i];

            from[i] = scale * from[i] + shift;
            // A target has to be some distance away.
            to[i] = from[i] + fmax(1.0, scale) * way;
        }
        write_point(out, (frame - 0.5) / 24, from);
        write_point(aims, (frame - 0.5) / 24, to);
    }
    fclose(aims);
    fprintf(out, "]}, \"target\": {\"interpolation\": \"hold\", \"keys\": [%s]}", targets);
    fclose(out);
    free(targets);
    return text;
}

struct sweep {
    const char *objects, *lights, *media, *quality;
    uint64_t seed;
    double scale, shift, fov;
    bool is_furnace; // no light is lost except in cut rays
};

static void assert_pixels(const struct studio_picture *picture, const struct sweep *sweep, int32_t frame)
{
    // The cut throughput is summed in floats.
    const double rounding = 2e-5;
    double cut = picture->result.ray_counts.most_cut.value, sum = 0.0;
    double least = sweep->is_furnace ? 1.0 - cut - rounding : 0.0;
    int count = picture->image.width_px * picture->image.height_px;

    for (int i = 0; i < 4 * count; ++i) {
        double value = picture->image.rgba[i];

        if (!(value <= 1.0 + rounding && value >= least))
            fail_msg("frame %d: pixel %d is %.9g, not in [%.9g, 1]", (int)frame, i / 4, value, least);
        if (i % 4 < 3) sum += value / (3 * count);
    }
    if (sweep->is_furnace) assert_near(sum + picture->result.ray_counts.cut_throughput, 1.0, rounding);
}

static void check_sweep(const struct sweep *sweep)
{
    char *cameras = write_cameras(sweep->seed, sweep->scale, sweep->shift), frames[32];
    const struct studio_scene scene = {.width_px = 3,
                                       .height_px = 3,
                                       .camera = {.fov = sweep->fov},
                                       .moving_camera = cameras,
                                       .background = "1",
                                       .objects = sweep->objects,
                                       .lights = sweep->lights,
                                       .media = sweep->media,
                                       .quality = sweep->quality ? sweep->quality : QUALITY,
                                       .frames = frames};
    struct job job = {0};
    double rays = 0.0;

    snprintf(frames, sizeof frames, "0-%d", FRAMES - 1);
    studio_parse(&job, &scene);
    for (int32_t frame = 0; frame < FRAMES; ++frame) {
        struct studio_picture picture;

        studio_render(&job, frame, &picture);
        assert_pixels(&picture, sweep, frame);
        rays += picture.result.ray_counts.rays;
        studio_finish(&picture);
    }
    job_finish(&job);
    free(cameras);
    // An empty scene would be as bright; it has one ray a pixel.
    assert_true(rays > 1.05 * FRAMES);
}

// The scene has a ball and a box on water that touch each other and the water, a ball half sunk, boxes that share
// faces, and equal balls.
#define TOUCHING_GLASS                                                                                                 \
    PLANE(-1, GLASS(1.33))                                                                                             \
    ", " SPHERE(0, 0, 0, 1, GLASS(1.5)) ", " BOX(1.5, -0.5, 0, 1, 1, 1, GLASS(1.4)) ", " SPHERE(                       \
        -1.5, -1, 1, 0.5,                                                                                              \
        GLASS(0.8)) ", " BOX(1.5, 0.5, 0, 1, 1, 1,                                                                     \
                             GLASS(1.4)) ", " BOX(0, -0.5, -1.5, 2, 1, 1,                                              \
                                                  GLASS(1.6)) ", " SPHERE(0, 0, 0, 1,                                  \
                                                                          GLASS(1.2)) ", " SPHERE(0, 0, 0, 0.5,        \
                                                                                                  GLASS(1))

static void glass_that_touches_keeps_light(void **state)
{
    static const double fovs[] = {1e-3, 90};

    studio_use(*(enum gl_backend *)*state);
    for (size_t i = 0; i < 2; ++i)
        check_sweep(
            &(struct sweep){.objects = TOUCHING_GLASS, .seed = 5 + i, .scale = 1, .fov = fovs[i], .is_furnace = true});
}

// Lights stand on surfaces, in glass, in opaque material and at the cameras' positions.
#define EVEN_LIGHTS                                                                                                    \
    "{\"kind\": \"point\", \"falloff\": \"none\", \"position\": [0, 0, 0], \"intensity\": 0.6}, "                      \
    "{\"kind\": \"point\", \"falloff\": \"none\", \"position\": [1, 0, 0], \"intensity\": 0.6}, "                      \
    "{\"kind\": \"point\", \"falloff\": \"none\", \"position\": [-1.5, -0.5, 1], \"intensity\": 0.6}, "                \
    "{\"kind\": \"sun\", \"direction\": [0, -1, 0], \"intensity\": 0.6}, "                                             \
    "{\"kind\": \"sun\", \"direction\": [1, 0, 0], \"intensity\": 0.6}"
#define SQUARE_LIGHTS                                                                                                  \
    "{\"kind\": \"point\", \"position\": [0, -1, 0], \"intensity\": 1}, "                                              \
    "{\"kind\": \"point\", \"position\": [1, 0, 0], \"intensity\": 1}, "                                               \
    "{\"kind\": \"point\", \"position\": [0.5, 0.5, 3], \"intensity\": 1}"
#define FOG                                                                                                            \
    "{\"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"box\", \"size\": [6, 4, 4]}}, \"sigma_s\": "   \
    "0.1}"
#define TOUCHING_STUFF                                                                                                 \
    PLANE(-1, GLOSS)                                                                                                   \
    ", " SPHERE(0, 0, 0, 1, SMOKE(1.5)) ", " BOX(1.5, -0.5, 0, 1, 1, 1, WHITE) ", " SPHERE(                            \
        -1.5, -1, 1, 0.5,                                                                                              \
        MIRROR ", \"roughness\": 1") ", " BOX(1.5, 0.5, 0, 1, 1, 1,                                                    \
                                              SMOKE(1.4)) ", " BOX(0, -0.5, -1.5, 2, 1, 1,                             \
                                                                   WHITE) ", " SPHERE(0, 0, 0, 0.5,                    \
                                                                                      WHITE) ", " SPHERE(0, 0, 0, 0.5, \
                                                                                                         GLASS(1.1))

// No source is over 1, and each is seen by its share of a ray that starts with 1: so no pixel is over 1.
static void no_stuff_that_touches_adds_light(void **state)
{
    (void)state;
    check_sweep(&(struct sweep){
        .objects = TOUCHING_STUFF, .lights = EVEN_LIGHTS, .media = FOG, .seed = 9, .scale = 1, .fov = 30});
}

static void assert_finite_sweep(const char *objects, const char *lights)
{
    char *cameras = write_cameras(31, 1, 0);
    const struct studio_scene scene = {.width_px = 3,
                                       .height_px = 3,
                                       .camera = {.fov = 30},
                                       .moving_camera = cameras,
                                       .objects = objects,
                                       .lights = lights,
                                       .media = FOG,
                                       .quality = QUALITY,
                                       .frames = "0-99"};
    struct job job = {0};

    studio_parse(&job, &scene);
    for (int32_t frame = 0; frame < 100; ++frame) {
        struct studio_picture picture;

        studio_render(&job, frame, &picture);
        for (int i = 0; i < 36; ++i)
            assert_true(picture.image.rgba[i] >= 0.0f);
        studio_finish(&picture);
    }
    job_finish(&job);
    free(cameras);
}

static void lamps_on_surfaces_are_finite(void **state)
{
    (void)state;
    assert_finite_sweep(TOUCHING_STUFF, SQUARE_LIGHTS);
}

static void extreme_indices_keep_light(void **state)
{
    (void)state;
    check_sweep(&(struct sweep){.objects = SPHERE(0, 0, 0, 1, GLASS(10)) ", " BOX(
                                    0.5, 0.5, 0, 1, 1, 1, GLASS(0.1)) ", " SPHERE(0.5, 0.5, 0, 0.5, GLASS(0.1)),
                                .seed = 21,
                                .scale = 1,
                                .fov = 60,
                                .is_furnace = true});
}

static void extreme_sizes_keep_light(void **state)
{
    static const char tiny[] = SPHERE(0, 0, 0, 1e-6, GLASS(1.5)) ", " BOX(1e-6, 0, 0, 1e-6, 1e-6, 1e-6, GLASS(1.3));
    static const char huge[] = SPHERE(0, 0, 0, 1e6, GLASS(1.5)) ", " BOX(
        1e6, 0, 0, 1e6, 1e6, 1e6, GLASS(1.3)) ", " SPHERE(0, 1e6, 0, 1e-3, GLASS(2));

    (void)state;
    check_sweep(&(struct sweep){.objects = tiny, .seed = 22, .scale = 1e-6, .fov = 60, .is_furnace = true});
    check_sweep(&(struct sweep){.objects = tiny, .seed = 23, .scale = 1, .fov = 1e-4, .is_furnace = true});
    check_sweep(&(struct sweep){.objects = huge, .seed = 24, .scale = 1e6, .fov = 60, .is_furnace = true});
    check_sweep(&(struct sweep){.objects = huge, .seed = 25, .scale = 1, .fov = 60, .is_furnace = true});
}

static void far_from_the_origin_light_is_kept(void **state)
{
    static const char far[] = PLANE(9999, GLASS(1.33)) ", " SPHERE(10000, 10000, 10000, 1, GLASS(1.5)) ", " BOX(
        10001.5, 9999.5, 10000, 1, 1, 1, GLASS(1.4)) ", " SPHERE(9998.5, 9999, 10001, 0.5, GLASS(0.8));

    (void)state;
    check_sweep(&(struct sweep){.objects = far, .seed = 26, .scale = 1, .shift = 1e4, .fov = 60, .is_furnace = true});
}

// A float's last digit is a metre at 15,000 km: the points where light enters the ball and where it leaves it are one.
static void a_ball_smaller_than_digits_ends_no_shadow_ray(void **state)
{
    const struct studio_scene scene = {
        .width_px = 5,
        .height_px = 5,
        .camera = {.position = {-14999900, 0, 0}, .target = {-15000000, 0, 0}, .fov = 1},
        .lights = "{\"kind\": \"point\", \"falloff\": \"none\", \"position\": [9, 0, 0], \"intensity\": "
                  "3.141592653589793}",
        .objects = "{\"kind\": \"plane\", \"point\": [-15000000, 0, 0], \"normal\": [1, 0, 0], \"material\": {" WHITE
                   "}}, " SPHERE(0, 0, 0, 0.5, GLASS(1.1)),
        .quality = QUALITY};
    struct studio_picture picture;

    (void)state;
    studio_shoot(&scene, &picture);
    for (int i = 0; i < 4 * 25; ++i)
        assert_near(picture.image.rgba[i], 1.0, 0.01);
    studio_finish(&picture);
}

static void roughness_of_one_keeps_light(void **state)
{
    static const char rough[] =
        PLANE(-1, GLASS(1.33) ", \"roughness\": 1") ", " SPHERE(0, 0, 0, 1, GLASS(1.5) ", \"roughness\": 1") ", " BOX(
            1.5, -0.5, 0, 1, 1, 1,
            GLASS(1.4) ", \"roughness\": 0.9") ", " SPHERE(0, 0, 0, 0.5,
                                                           GLASS(0.7) ", \"roughness\": 1, \"fresnel\": \"schlick\"");

    (void)state;
    check_sweep(&(struct sweep){.objects = rough,
                                .quality = QUALITY ", \"samples\": 4",
                                .seed = 27,
                                .scale = 1,
                                .fov = 60,
                                .is_furnace = true});
}

// Keys of cameras at a point in a room of 4 m, off its middle or on planes through it. They are aimed at corners, edges
// and what lies opposite. Owned by the caller.
static char *write_room_cameras(uint64_t seed)
{
    char *text = NULL, *targets = NULL;
    size_t length, targets_length;
    FILE *out = open_memstream(&text, &length), *aims = open_memstream(&targets, &targets_length);
    struct random random = {seed};

    fputs("\"position\": {\"interpolation\": \"hold\", \"keys\": [", out);
    for (int frame = 0; frame < FRAMES; ++frame) {
        double from[3], to[3];

        do {
            for (int i = 0; i < 3; ++i) {
                double kind = random_between(&random, 0, 3);

                from[i] = 0.5 * nice_number(&random);
                to[i] = kind < 1 ? 2 : kind < 2 ? -2 : from[i];
            }
        } while (from[0] == to[0] && from[2] == to[2]);
        write_point(out, (frame - 0.5) / 24, from);
        write_point(aims, (frame - 0.5) / 24, to);
    }
    fclose(aims);
    fprintf(out, "]}, \"target\": {\"interpolation\": \"hold\", \"keys\": [%s]}", targets);
    fclose(out);
    free(targets);
    return text;
}

static void assert_dark(const struct job *job, int32_t frame)
{
    struct studio_picture picture;

    studio_render(job, frame, &picture);
    for (int i = 0; i < 36; ++i)
        if (picture.image.rgba[i] != (i % 4 == 3 ? 1.0f : 0.0f) || picture.image.transmittance[i - i % 4] != 0.0f)
            fail_msg("frame %d: pixel %d lets %g through, and %g straight", (int)frame, i / 4, picture.image.rgba[i],
                     picture.image.transmittance[i - i % 4]);
    studio_finish(&picture);
}

static void assert_dark_room(const char *walls, uint64_t seed, double fov)
{
    char *cameras = write_room_cameras(seed);
    const struct studio_scene scene = {.width_px = 3,
                                       .height_px = 3,
                                       .camera = {.fov = fov},
                                       .moving_camera = cameras,
                                       .background = "1",
                                       .objects = walls,
                                       .lights =
                                           "{\"kind\": \"point\", \"falloff\": \"none\", \"position\": [0, 9, 0], "
                                           "\"intensity\": 3}, {\"kind\": \"sun\", \"direction\": [1, -1, 1], "
                                           "\"intensity\": 3}",
                                       .quality = QUALITY,
                                       .frames = "0-399"};
    struct job job = {0};

    studio_parse(&job, &scene);
    for (int32_t frame = 0; frame < FRAMES; ++frame)
        assert_dark(&job, frame);
    job_finish(&job);
    free(cameras);
}

#define SHINY WHITE ", \"specular\": 0.7"
// The room is cut out of a block, or built of walls that lie flush, or has glass that leans on its walls.
#define CUT_ROOM BOX(0, 0, 0, 6, 6, 6, SHINY) ", " BOX(0, 0, 0, 4, 4, 4, GLASS(1))
#define BUILT_ROOM                                                                                                     \
    BOX(0, 2.5, 0, 4, 1, 4, SHINY)                                                                                     \
    ", " BOX(0, -2.5, 0, 4, 1, 4, MIRROR) ", " BOX(2.5, 0, 0, 1, 6, 4, WHITE) ", " BOX(                                \
        -2.5, 0, 0, 1, 6, 4, SHINY) ", " BOX(0, 0, 2.5, 6, 6, 1, MIRROR) ", " BOX(0, 0, -2.5, 6, 6, 1, WHITE)

static void no_light_gets_into_a_room(void **state)
{
    static const char *const rooms[] = {
        CUT_ROOM, BUILT_ROOM,
        BUILT_ROOM ", " BOX(1.5, 1.5, 1.5, 1, 1, 1, GLASS(1.5)) ", " SPHERE(-1, -1, -1, 1, GLASS(1.5))};

    (void)state;
    for (size_t i = 0; i < 3; ++i) {
        assert_dark_room(rooms[i], 41 + i, 1e-4);
        assert_dark_room(rooms[i], 51 + i, 80);
    }
}

int main(int argument_count, char **arguments)
{
    static enum gl_backend software = GL_BACKEND_SOFTWARE, egl = GL_BACKEND_EGL;
    const struct CMUnitTest tests[] = {
        {"glass_that_touches_keeps_light_egl", glass_that_touches_keeps_light, NULL, NULL, &egl},
        {"glass_that_touches_keeps_light_software", glass_that_touches_keeps_light, NULL, NULL, &software},
        cmocka_unit_test(no_stuff_that_touches_adds_light),
        cmocka_unit_test(lamps_on_surfaces_are_finite),
        cmocka_unit_test(extreme_indices_keep_light),
        cmocka_unit_test(extreme_sizes_keep_light),
        cmocka_unit_test(far_from_the_origin_light_is_kept),
        cmocka_unit_test(a_ball_smaller_than_digits_ends_no_shadow_ray),
        cmocka_unit_test(roughness_of_one_keeps_light),
        cmocka_unit_test(no_light_gets_into_a_room),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, studio_close);
}
