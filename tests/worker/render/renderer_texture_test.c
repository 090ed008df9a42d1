// Images on surfaces, from the file to the picture, against closed forms; files that change or cannot be read.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job_json.h"
#include "reference/vec3.h"
#include "tests/support/assert_near.h"
#include "tests/support/gl_stage.h"
#include "tests/support/png_maker.h"
#include "tests/support/random.h"
#include "tests/support/shader_dir.h"
#include "tests/support/temp_folder.h"
#include "tests/support/true_light.h"
#include "tests/support/volume_maker.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"
#include "worker/volume/volume_memory.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include <cmocka.h>

enum { SIDE = 48, WIDTH = 7, HEIGHT = 5 };

static const double PI = 3.14159265358979323846, TILE = 1.3, IRRADIANCE = 2.5;
static const struct vec3 EYE = {0.7, 2.1, 3.4}, TARGET = {0.2, -0.3, 0.1}, SUN = {-0.4, -2, -0.9};
static const double FOV_DEG = 40;

static unsigned char bytes[3 * WIDTH * HEIGHT];

struct stage {
    struct gl_stage gl;
    struct job job;
    struct image image;
    struct renderer_result result;
    struct error error;
    const char *path;
};

static void write_image(const char *path, unsigned seed)
{
    struct random random = {seed};

    for (size_t i = 0; i < sizeof bytes; ++i)
        bytes[i] = (unsigned char)random_between(&random, 0, 256);
    png_maker_write_rgb(path, WIDTH, HEIGHT, bytes);
}

// `object` has its kind and position, `texture` has members beside the file.
static void take_job(struct stage *stage, const char *object, const char *texture)
{
    char text[8192];

    snprintf(
        text, sizeof text,
        "{ \"version\": 1, \"name\": \"floor\", \"frames\": \"0-9\", \"fps\": 24, \"resolution\": [%d, %d],"
        " \"camera\": { \"position\": [%g, %g, %g], \"target\": [%g, %g, %g], \"up\": [0, 1, 0], \"fov\": %g },"
        " \"lights\": [ { \"kind\": \"sun\", \"direction\": [%g, %g, %g], \"intensity\": %g } ],"
        " \"scene\": { \"objects\": [ { %s, \"material\": { \"kind\": \"diffuse\", \"albedo\": [1, 0.5, 0.25],"
        " \"texture\": { \"file\": \"%s\"%s } } } ] },"
        " \"quality\": { \"method\": \"midpoint\", \"step\": 0.1 }, \"output\": { \"path\": \"floor.####.exr\" } }",
        SIDE, SIDE, EYE.x, EYE.y, EYE.z, TARGET.x, TARGET.y, TARGET.z, FOV_DEG, SUN.x, SUN.y, SUN.z, IRRADIANCE, object,
        stage->path, texture);
    job_finish(&stage->job);
    if (!job_parse(&stage->job, text, strlen(text), NULL, &stage->error)) fail_msg("%s", stage->error.message);
}

static const char FLOOR[] = "\"kind\": \"plane\", \"point\": [0.3, -0.5, 0.1]";

static struct stage open_stage(const char *path)
{
    struct stage stage = {.path = path};

    take_job(&stage, FLOOR, ", \"size\": 1.3");
    stage.gl = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    assert_true(image_init(&stage.image, SIDE, SIDE, false, false, NULL));
    return stage;
}

static void close_stage(struct stage *stage)
{
    image_finish(&stage->image);
    gl_stage_close(stage->gl);
    job_finish(&stage->job);
}

static bool render(struct stage *stage, int32_t frame)
{
    return renderer_render(stage->gl.renderer,
                           &(struct renderer_frame){.job = &stage->job, .frame = frame, .image = &stage->image},
                           &stage->result, &stage->error);
}

static void render_well(struct stage *stage, int32_t frame)
{
    if (!render(stage, frame)) fail_msg("%s", stage->error.message);
}

// The functions below compute the picture by hand: rays, points, light.
struct surface {
    struct vec3 point, normal, right, up;
    bool is_nearest, is_linear;
};

static struct ray ray_of(size_t pixel)
{
    struct vec3 ahead = vec3_normalize(vec3_subtract(TARGET, EYE));
    struct vec3 right = vec3_normalize(vec3_cross(ahead, (struct vec3){0, 1, 0})), up = vec3_cross(right, ahead);
    double reach = tan(FOV_DEG * PI / 360);
    double x = (2 * ((double)(pixel % SIDE) + 0.5) / SIDE - 1) * reach;
    double y = (1 - 2 * ((double)(pixel / SIDE) + 0.5) / SIDE) * reach;

    return (struct ray){EYE, vec3_normalize(vec3_add(ahead, vec3_add(vec3_scale(right, x), vec3_scale(up, y))))};
}

static double light_of(const struct surface *surface, int column, int row, int channel)
{
    int i = ((column % WIDTH + WIDTH) % WIDTH + (row % HEIGHT + HEIGHT) % HEIGHT * WIDTH) * 3 + channel;
    double value = bytes[i] / 255.0;

    if (surface->is_linear) return value;
    return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4); // IEC 61966-2-1
}

// `x` and `y` are in pixels of the image, from the top left corner of the tile.
static double albedo_at(const struct surface *surface, double x, double y, int channel)
{
    double left = floor(x - 0.5), top = floor(y - 0.5), sum = 0;

    if (surface->is_nearest) return light_of(surface, (int)floor(x), (int)floor(y), channel);
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i)
            sum += (1 - fabs(x - 0.5 - left - i)) * (1 - fabs(y - 0.5 - top - j)) *
                   light_of(surface, (int)left + i, (int)top + j, channel);
    return sum;
}

// Returns false where the ray misses, or hits so near a texel's border that rounding decides.
static bool find_place(const struct surface *surface, const struct ray *ray, double *x, double *y)
{
    double way = vec3_dot(surface->normal, ray->direction);
    double distance = vec3_dot(surface->normal, vec3_subtract(surface->point, ray->origin)) / way;
    struct vec3 offset = vec3_subtract(ray_at(ray, distance), surface->point);

    if (way >= 0 || distance > 40) return false;
    *x = (0.5 + vec3_dot(offset, surface->right) / TILE) * WIDTH;
    *y = (0.5 - vec3_dot(offset, surface->up) / (TILE * HEIGHT / WIDTH)) * HEIGHT;
    return !surface->is_nearest || (fabs(*x - round(*x)) > 1e-3 && fabs(*y - round(*y)) > 1e-3);
}

// Every pixel is albedo(u, v) E cos / pi.
static void assert_picture(const struct stage *stage, const struct surface *surface)
{
    static const double colors[3] = {1, 0.5, 0.25};
    double cos_sun = -vec3_dot(vec3_normalize(SUN), surface->normal);
    size_t seen = 0;

    for (size_t i = 0; i < (size_t)SIDE * SIDE; ++i) {
        struct ray ray = ray_of(i);
        double x, y;

        if (!find_place(surface, &ray, &x, &y)) continue;
        ++seen;
        for (int c = 0; c < 3; ++c) // positions are rounded to about 1e-6 m, thousandths of a texel far away
            assert_near(stage->image.rgba[4 * i + (size_t)c],
                        colors[c] * albedo_at(surface, x, y, c) * IRRADIANCE * cos_sun / PI, 2e-4);
    }
    assert_true(seen > SIDE * SIDE / 2);
}

static void floor_is_lit_as_its_image_says(void **state)
{
    struct surface surface = {.point = {0.3, -0.5, 0.1}, .normal = {0, 1, 0}, .right = {1, 0, 0}, .up = {0, 0, -1}};
    struct stage stage;

    write_image(temp_folder_path(state, "image.png"), 3);
    stage = open_stage(temp_folder_path(state, "image.png"));
    for (int i = 0; i < 4; ++i) {
        char texture[128];

        surface.is_nearest = i & 1;
        surface.is_linear = i & 2;
        snprintf(texture, sizeof texture, ", \"size\": %g, \"filter\": \"%s\", \"color_space\": \"%s\"", TILE,
                 i & 1 ? "nearest" : "linear", i & 2 ? "linear" : "srgb");
        take_job(&stage, FLOOR, texture);
        render_well(&stage, 0);
        assert_picture(&stage, &surface);
    }
    close_stage(&stage);
}

// A ramp that rises away from the camera. The texture's up direction is the steepest one on it.
static void tilted_plane_is_lit_as_its_image_says(void **state)
{
    const struct vec3 normal = vec3_normalize((struct vec3){0.3, 2, 0.8});
    const struct vec3 right = vec3_normalize(vec3_cross((struct vec3){0, 1, 0}, normal));
    const struct surface surface = {
        .point = {0.3, -0.5, 0.1}, .normal = normal, .right = right, .up = vec3_cross(normal, right)};
    struct stage stage;

    write_image(temp_folder_path(state, "image.png"), 4);
    stage = open_stage(temp_folder_path(state, "image.png"));
    take_job(&stage, "\"kind\": \"plane\", \"point\": [0.3, -0.5, 0.1], \"normal\": [0.3, 2, 0.8]", ", \"size\": 1.3");
    render_well(&stage, 0);
    assert_picture(&stage, &surface);
    close_stage(&stage);
}

// A ball, a box and a union of both on a floor, from two sides, without the horizon, where floats are too coarse.
static void shapes_are_lit_as_their_twins(void **state, const char *eye, enum gl_backend backend)
{
    const char *path = temp_folder_path(state, "image.png");
    struct true_light light;
    struct error error = {{0}};
    struct job job;
    char text[4096];

    write_image(path, 8);
    snprintf(
        text, sizeof text,
        "{ \"version\": 1, \"name\": \"shapes\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [48, 32],"
        " \"camera\": { \"position\": %s, \"target\": [0, 0, 0], \"up\": [0, 1, 0], \"fov\": 40 },"
        " \"lights\": [ { \"kind\": \"sun\", \"direction\": [-0.4, -2, -0.9], \"intensity\": 2 },"
        " { \"kind\": \"point\", \"position\": [-3, 4, 5], \"intensity\": [40, 30, 20] } ],"
        " \"scene\": { \"objects\": [ { \"kind\": \"plane\", \"point\": [0, -1, 0], \"material\": {"
        " \"kind\": \"diffuse\", \"texture\": { \"file\": \"%s\", \"size\": 2 } } },"
        " { \"kind\": \"sphere\", \"center\": [-2, 0, 0.5], \"radius\": 1, \"material\": { \"kind\": \"diffuse\","
        " \"texture\": { \"file\": \"%s\" } } },"
        " { \"kind\": \"box\", \"center\": [0, 0, -1], \"size\": [1, 1.5, 0.8], \"material\": { \"kind\": \"diffuse\","
        " \"texture\": { \"file\": \"%s\", \"size\": [0.7, 0.6], \"color_space\": \"linear\" } } },"
        " { \"kind\": \"union\", \"of\": [ { \"kind\": \"box\", \"center\": [2, -0.5, 0], \"size\": [1, 1, 1] },"
        " { \"kind\": \"sphere\", \"center\": [2, 0.3, 0], \"radius\": 0.6 } ], \"material\": { \"kind\": \"diffuse\","
        " \"albedo\": 0.8, \"texture\": { \"file\": \"%s\", \"size\": 1 } } } ] },"
        " \"quality\": { \"method\": \"midpoint\", \"step\": 0.1 },"
        " \"output\": { \"path\": \"shapes.####.exr\", \"aovs\": [\"Z\", \"transmittance\"] } }",
        eye, path, path, path, path);
    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    light = true_light_compare(&job, backend);
    assert_true(true_light_is_within(&light, 1e-4));
    job_finish(&job);
}

static void shapes_from_the_front(void **state)
{
    shapes_are_lit_as_their_twins(state, "[1, 3, 7]", GL_BACKEND_SOFTWARE);
}

static void shapes_from_behind_on_egl(void **state)
{
    shapes_are_lit_as_their_twins(state, "[-3, 4, -7]", GL_BACKEND_EGL);
}

static void changed_texture_is_read_again(void **state)
{
    struct surface surface = {.point = {0.3, -0.5, 0.1}, .normal = {0, 1, 0}, .right = {1, 0, 0}, .up = {0, 0, -1}};
    const char *path = temp_folder_path(state, "image.png");
    char first[HASH_TEXT_SIZE];
    struct stage stage;

    write_image(path, 5);
    stage = open_stage(path);
    render_well(&stage, 0);
    memcpy(first, stage.result.picture_hash, sizeof first);
    render_well(&stage, 1);
    assert_true(stage.result.is_copy); // nothing moves
    write_image(path, 6);
    render_well(&stage, 2);
    assert_false(stage.result.is_copy);
    assert_string_not_equal(stage.result.picture_hash, first);
    assert_picture(&stage, &surface);
    close_stage(&stage);
}

static void texture_that_cannot_be_read_fails_the_frame(void **state)
{
    const char *path = temp_folder_path(state, "image.png");
    struct stage stage;

    write_image(path, 7);
    stage = open_stage(path);
    // Another attempt may find the file written to its end.
    volume_maker_write(path, "\x89PNG\r\n\x1a\n", 8);
    assert_false(render(&stage, 0));
    assert_int_equal(stage.result.fault, RENDERER_FAULT_FRAME);
    assert_non_null(strstr(stage.error.message, "scene.objects[0].material.texture.file: "));
    assert_non_null(strstr(stage.error.message, "image.png: PNG: the file ends too soon"));
    write_image(path, 7);
    render_well(&stage, 0);
    assert_int_equal(unlink(path), 0);
    assert_false(render(&stage, 0));
    assert_int_equal(stage.result.fault, RENDERER_FAULT_JOB);
    assert_non_null(strstr(stage.error.message, "No such file"));
    close_stage(&stage);
}

static bool refuse(void *user, double done)
{
    *(double *)user = done;
    return false;
}

static void reading_can_be_stopped(void **state)
{
    const char *path = temp_folder_path(state, "image.png");
    struct stage stage;
    double done = -1;

    write_image(path, 9);
    stage = open_stage(path);
    assert_false(
        renderer_render(stage.gl.renderer,
                        &(struct renderer_frame){
                            .job = &stage.job, .frame = 0, .image = &stage.image, .on_progress = refuse, .user = &done},
                        &stage.result, &stage.error));
    assert_int_equal(stage.result.fault, RENDERER_FAULT_STOPPED);
    assert_true(done == 0); // before the first tile
    render_well(&stage, 0);
    close_stage(&stage);
}

// A file with a header and no pixels.
static void write_sides(const char *path, int width, int height)
{
    static const uint16_t zero;
    size_t size;
    unsigned char *png = png_maker_make(
        &(struct png_params){.width = 1, .height = 1, .color = PNG_GREY, .bits = 8, .values = &zero}, &size);
    const unsigned char sides[8] = {0, 0, (unsigned char)(width >> 8),  (unsigned char)width,
                                    0, 0, (unsigned char)(height >> 8), (unsigned char)height};
    uLong sum;

    memcpy(png + 16, sides, sizeof sides);
    sum = crc32(0, png + 12, 17);
    for (int i = 0; i < 4; ++i)
        png[29 + i] = (unsigned char)(sum >> (24 - 8 * i));
    volume_maker_write(path, png, size);
    free(png);
}

static void image_without_room_in_gl_is_not_read(void **state)
{
    const char *path = temp_folder_path(state, "image.png");
    struct stage stage;

    write_sides(path, 16384, 16384);
    stage = open_stage(path);
    assert_false(render(&stage, 0));
    if (!strstr(stage.error.message, "image.png: GL here has no room for 16384 x 16384 pixels"))
        fail_msg("%s", stage.error.message);
    close_stage(&stage);
}

// 15 balls and the floor, each with an image of some 4 GiB.
static void images_of_a_frame_have_room_together(void **state)
{
    char objects[6144] = "", path[512];
    struct stage stage;

    if (volume_memory_limit() > (int64_t)60 << 30) skip();
    for (int i = 0; i < 15; ++i) {
        size_t length = strlen(objects);
        char name[32];

        snprintf(name, sizeof name, "ball_%d.png", i);
        write_sides(temp_folder_path(state, name), 16384, 16383 - i);
        snprintf(objects + length, sizeof objects - length,
                 "\"kind\": \"sphere\", \"center\": [%d, 0, 0], \"radius\": 0.4, \"material\": {"
                 " \"kind\": \"diffuse\", \"texture\": { \"file\": \"%s\" } } }, { ",
                 i, temp_folder_path(state, name));
    }
    snprintf(path, sizeof path, "%s", temp_folder_path(state, "image.png"));
    write_sides(path, 16384, 16384);
    stage = open_stage(path);
    strcat(objects, FLOOR);
    take_job(&stage, objects, ", \"size\": 1");
    assert_false(render(&stage, 0));
    if (!strstr(stage.error.message, "scene.objects: the textures: needs 64 GiB of memory"))
        fail_msg("%s", stage.error.message);
    close_stage(&stage);
}

int main(int argc, char *argv[])
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, temp_folder_create, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        TEST(floor_is_lit_as_its_image_says),
        TEST(tilted_plane_is_lit_as_its_image_says),
        TEST(shapes_from_the_front),
        TEST(shapes_from_behind_on_egl),
        TEST(changed_texture_is_read_again),
        TEST(texture_that_cannot_be_read_fails_the_frame),
        TEST(reading_can_be_stopped),
        TEST(image_without_room_in_gl_is_not_read),
        TEST(images_of_a_frame_have_room_together),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
