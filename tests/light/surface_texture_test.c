// The position of each texel: images on planes, boxes, balls and unions, with the mapping in words and as numbers.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/optics.h"
#include "tests/support/studio.h"
#include "tests/support/temp_folder.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"
#include "worker/picture/image_png.h"

#include <fcntl.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enum { COLUMNS = 5, ROWS = 4 };

// A lamp at the camera's position leaves nothing in shadow; white seen at normal incidence is 1.
#define LAMP(place)                                                                                                    \
    "{\"kind\": \"point\", \"falloff\": \"none\", \"position\": " place ", \"intensity\": 3.141592653589793}"

static const unsigned char bytes[ROWS][COLUMNS][3] = {
    {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {255, 255, 0}, {20, 40, 60}},
    {{10, 200, 30}, {128, 128, 128}, {5, 6, 7}, {250, 120, 60}, {1, 2, 3}},
    {{99, 0, 180}, {180, 99, 0}, {0, 180, 99}, {255, 255, 255}, {0, 0, 0}},
    {{11, 22, 33}, {44, 55, 66}, {77, 88, 99}, {111, 122, 133}, {222, 233, 244}}};

// The mapping of an image onto a shape.
struct cover {
    struct vec3 center, normal; // of a plane; a ball's or a box's center
    struct vec3 sides;          // of a box
    double radius;              // of a ball
    double across, up;          // size of a tile, m
    bool is_nearest, is_linear;
};

static double texel(const struct cover *cover, int column, int row, size_t color)
{
    double value = bytes[((row % ROWS) + ROWS) % ROWS][((column % COLUMNS) + COLUMNS) % COLUMNS][color] / 255.0;

    if (cover->is_linear) return value;
    return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4);
}

// Evaluates the image at (u, v), v upwards; false near the edge of a texel with the nearest filter.
static bool sample_image(const struct cover *cover, double u, double v, double color[3])
{
    double x = u * COLUMNS, y = (1.0 - v) * ROWS;
    int column = (int)floor(x - 0.5), row = (int)floor(y - 0.5);
    double right = x - 0.5 - column, down = y - 0.5 - row;

    if (cover->is_nearest && (fabs(x - round(x)) < 1e-4 || fabs(y - round(y)) < 1e-4)) return false;
    for (size_t c = 0; c < 3; ++c) {
        double top = (1.0 - right) * texel(cover, column, row, c) + right * texel(cover, column + 1, row, c);
        double bottom = (1.0 - right) * texel(cover, column, row + 1, c) + right * texel(cover, column + 1, row + 1, c);

        color[c] = (1.0 - down) * top + down * bottom;
        if (cover->is_nearest) color[c] = texel(cover, (int)floor(x), (int)floor(y), c);
    }
    return true;
}

static bool sample_flat(const struct cover *cover, struct vec3 offset, struct vec3 normal, double color[3])
{
    bool is_level = fabs(normal.y) > 0.999;
    struct vec3 high = is_level ? (struct vec3){0, 0, -1} : (struct vec3){0, 1, 0};
    struct vec3 right = vec3_normalize(vec3_cross(high, normal)), up = vec3_cross(normal, right);

    return sample_image(cover, 0.5 + vec3_dot(offset, right) / cover->across, 0.5 + vec3_dot(offset, up) / cover->up,
                        color);
}

static void light_up(const struct ray *ray, struct vec3 normal, const double color[3], struct studio_light *light)
{
    for (size_t c = 0; c < 3; ++c)
        light->radiance[c] = -vec3_dot(ray->direction, normal) * color[c];
}

static void plane_truth(const struct ray *ray, struct studio_light *light, const void *user)
{
    const struct cover *cover = user;
    struct vec3 normal = vec3_normalize(cover->normal);
    double distance = optics_meet_plane(ray, cover->center, normal), color[3];

    if (distance > 30.0) return;
    if (sample_flat(cover, vec3_subtract(ray_at(ray, distance), cover->center), normal, color))
        light_up(ray, normal, color, light);
}

static void box_truth(const struct ray *ray, struct studio_light *light, const void *user)
{
    const struct cover *cover = user;
    const double half[3] = {0.5 * cover->sides.x, 0.5 * cover->sides.y, 0.5 * cover->sides.z};

    for (int axis = 0; axis < 3; ++axis) {
        const double direction[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
        double side = direction[axis] < 0.0 ? 1.0 : -1.0, normal_at[3] = {0, 0, 0}, color[3], distance;
        struct vec3 normal, face, offset;

        normal_at[axis] = side;
        normal = vec3_from(normal_at);
        face = vec3_add(cover->center, vec3_scale(normal, half[axis]));
        distance = optics_meet_plane(ray, face, normal);
        if (isinf(distance)) continue;
        offset = vec3_subtract(ray_at(ray, distance), face);
        if (fmax(fabs(offset.x) - half[0], fmax(fabs(offset.y) - half[1], fabs(offset.z) - half[2])) > 1e-9) continue;
        if ((fabs(offset.x) > half[0] - 1e-4) + (fabs(offset.y) > half[1] - 1e-4) + (fabs(offset.z) > half[2] - 1e-4) >
            0)
            return;
        if (sample_flat(cover, offset, normal, color)) light_up(ray, normal, color, light);
        return;
    }
}

static void ball_truth(const struct ray *ray, struct studio_light *light, const void *user)
{
    const struct cover *cover = user;
    struct vec3 normal;
    double enter, leave, color[3], pi = acos(-1.0);

    if (!optics_meet_ball(ray, cover->center, cover->radius, &enter, &leave)) return;
    normal = vec3_scale(vec3_subtract(ray_at(ray, enter), cover->center), 1.0 / cover->radius);
    // Rounding counts where u and v change fastest.
    if (fabs(normal.y) > 0.99 || vec3_dot(normal, ray->direction) > -0.05) return;
    if (sample_image(cover, 0.5 + atan2(normal.x, normal.z) / (2.0 * pi), 0.5 + asin(normal.y) / pi, color))
        light_up(ray, normal, color, light);
}

static void write_png(const char *path)
{
    struct error error = {{0}};

    if (!image_png_write(path, &bytes[0][0][0], COLUMNS, ROWS, &error)) fail_msg("%s", error.message);
}

static void write_exr(const char *path)
{
    struct image_exr_header header = {.pixel = JOB_PIXEL_FLOAT,
                                      .fps_numerator = 24,
                                      .fps_denominator = 1,
                                      .owner = "",
                                      .job_hash = "",
                                      .method = "",
                                      .backend = "",
                                      .renderer = "",
                                      .shader_hash = ""};
    int fd = open(path, O_RDWR | O_CREAT | O_TRUNC, 0600);
    struct error error = {{0}};
    struct image image;

    assert_true(fd >= 0 && image_init(&image, COLUMNS, ROWS, false, false, NULL));
    for (size_t i = 0; i < (size_t)COLUMNS * ROWS; ++i) {
        for (size_t c = 0; c < 3; ++c)
            image.rgba[4 * i + c] = (float)((&bytes[0][0][0])[3 * i + c] / 255.0);
        image.rgba[4 * i + 3] = 1.0f;
    }
    if (!image_exr_write(fd, &image, &header, 1, &error)) fail_msg("%s", error.message);
    image_finish(&image);
    close(fd);
}

// `shape` is the shape's members; `texture` is the texture's members other than its file.
static void check(const struct studio_scene *view, const char *lights, const char *shape, const char *path,
                  const char *texture, studio_truth *truth, const struct cover *cover)
{
    struct studio_scene scene = *view;
    char object[1024];

    snprintf(object, sizeof object, "{%s, \"material\": {\"kind\": \"diffuse\", \"texture\": {\"file\": \"%s\"%s}}}",
             shape, path, texture);
    scene.lights = lights;
    scene.objects = object;
    studio_check(&scene, truth, cover, 4e-5, 0.3);
}

static const struct studio_scene from_above = {
    .width_px = 40, .height_px = 32, .camera = {.position = {0.4, 2, 3}, .target = {0.2, -1, 0}, .fov = 50}};

static void a_floor_is_upright_to_a_viewer_along_minus_z(void **state)
{
    const char *path = temp_folder_path(state, "t.png");
    const struct cover cover = {.center = {0.3, -1, 0.2}, .normal = {0, 1, 0}, .across = 2, .up = 1.5};

    write_png(path);
    check(&from_above, LAMP("[0.4, 2, 3]"), "\"kind\": \"plane\", \"point\": [0.3, -1, 0.2]", path,
          ", \"size\": [2, 1.5]", plane_truth, &cover);
}

static void a_tile_is_as_high_as_its_image(void **state)
{
    const char *path = temp_folder_path(state, "t.png");
    const struct cover cover = {
        .center = {0.3, -1, 0.2}, .normal = {0, 1, 0}, .across = 2, .up = 2.0 * ROWS / COLUMNS, .is_nearest = true};

    write_png(path);
    check(&from_above, LAMP("[0.4, 2, 3]"), "\"kind\": \"plane\", \"point\": [0.3, -1, 0.2]", path,
          ", \"size\": 2, \"filter\": \"nearest\"", plane_truth, &cover);
}

static void color_space_is_the_formats_unless_given(void **state)
{
    const char *png = temp_folder_path(state, "t.png"), *exr = temp_folder_path(state, "t.exr");
    struct cover cover = {.center = {0, -1, 0}, .normal = {1, 2, 0.5}, .across = 1.5, .up = 1, .is_linear = true};
    const char *plane = "\"kind\": \"plane\", \"point\": [0, -1, 0], \"normal\": [1, 2, 0.5]";

    write_png(png);
    write_exr(exr);
    check(&from_above, LAMP("[0.4, 2, 3]"), plane, exr, ", \"size\": [1.5, 1]", plane_truth, &cover);
    check(&from_above, LAMP("[0.4, 2, 3]"), plane, png, ", \"size\": [1.5, 1], \"color_space\": \"linear\"",
          plane_truth, &cover);
    cover.is_linear = false;
    check(&from_above, LAMP("[0.4, 2, 3]"), plane, exr, ", \"size\": [1.5, 1], \"color_space\": \"srgb\"", plane_truth,
          &cover);
}

static void a_box_has_the_image_on_six_faces(void **state)
{
    const char *path = temp_folder_path(state, "t.png");
    const struct cover cover = {.center = {0.2, 0.1, -0.1}, .sides = {1.6, 1.2, 2}, .across = 1, .up = 0.8};
    const char *box = "\"kind\": \"box\", \"center\": [0.2, 0.1, -0.1], \"size\": [1.6, 1.2, 2]";
    struct studio_scene view = {.width_px = 40, .height_px = 40, .camera = {.position = {3, 2.5, 2}, .fov = 40}};

    write_png(path);
    check(&view, LAMP("[3, 2.5, 2]"), box, path, ", \"size\": [1, 0.8]", box_truth, &cover);
    view.camera.position = (struct vec3){-3, -2.5, -2};
    check(&view, LAMP("[-3, -2.5, -2]"), box, path, ", \"size\": [1, 0.8]", box_truth, &cover);
}

static void a_ball_has_the_image_once_around(void **state)
{
    const char *path = temp_folder_path(state, "t.png");
    const struct cover cover = {.center = {0.2, 0.1, -0.1}, .radius = 1};
    const char *ball = "\"kind\": \"sphere\", \"center\": [0.2, 0.1, -0.1], \"radius\": 1";
    struct studio_scene view = {.width_px = 40, .height_px = 40, .camera = {.position = {1, 2, 3}, .fov = 34}};

    write_png(path);
    check(&view, LAMP("[1, 2, 3]"), ball, path, "", ball_truth, &cover);
    // The seam is seen from here.
    view.camera.position = (struct vec3){0.5, -1, -3};
    check(&view, LAMP("[0.5, -1, -3]"), ball, path, "", ball_truth, &cover);
}

// The ball cuts a hole into a floor: the wall of the hole is coloured as the floor above it.
static void hole_truth(const struct ray *ray, struct studio_light *light, const void *user)
{
    const struct cover *cover = user;
    double enter, leave, color[3];
    struct vec3 place, normal;

    if (!optics_meet_ball(ray, (struct vec3){0, -0.6, 0}, 1.0, &enter, &leave)) return;
    place = ray_at(ray, leave);
    if (place.y > -1.001 || ray_at(ray, enter).y < -0.999) return;
    normal = vec3_subtract((struct vec3){0, -0.6, 0}, place);
    if (sample_flat(cover, vec3_subtract(place, cover->center), (struct vec3){0, 1, 0}, color))
        light_up(ray, normal, color, light);
}

static void the_wall_of_a_hole_is_coloured_as_the_floor(void **state)
{
    const char *path = temp_folder_path(state, "t.png");
    const struct cover cover = {.center = {0.3, -1, 0.2}, .normal = {0, 1, 0}, .across = 2, .up = 1.5};
    struct studio_scene scene = {
        .width_px = 40, .height_px = 32, .camera = {.position = {0.4, 3, 2}, .target = {0, -1, 0}, .fov = 36}};
    char objects[1024];

    write_png(path);
    snprintf(
        objects, sizeof objects,
        "{\"kind\": \"plane\", \"point\": [0.3, -1, 0.2], \"material\": {\"kind\": \"diffuse\", \"texture\": "
        "{\"file\": "
        "\"%s\", \"size\": [2, 1.5]}}}, {\"kind\": \"sphere\", \"center\": [0, -0.6, 0], \"radius\": 1, \"material\": "
        "{\"kind\": \"dielectric\", \"ior\": 1}}",
        path);
    scene.objects = objects;
    scene.lights = LAMP("[0.4, 3, 2]");
    studio_check(&scene, hole_truth, &cover, 4e-5, 0.2);
}

// The most frequent colour around a point of the picture, given as a share of its sides: R, G, B or White.
static char color_at(const struct studio_picture *picture, double x, double y)
{
    const struct image *image = &picture->image;
    int column = (int)(x * image->width_px), row = (int)(y * image->height_px);
    const float *rgb = &image->rgba[4 * (row * image->width_px + column)];

    if (rgb[0] > 0.4f && rgb[1] > 0.4f && rgb[2] > 0.4f) return 'W';
    if (rgb[0] > 0.4f) return 'R';
    return rgb[1] > 0.4f ? 'G' : 'B';
}

static void assert_upright(const struct studio_picture *picture)
{
    assert_int_equal(color_at(picture, 0.42, 0.42), 'R');
    assert_int_equal(color_at(picture, 0.58, 0.42), 'G');
    assert_int_equal(color_at(picture, 0.42, 0.58), 'B');
    assert_int_equal(color_at(picture, 0.58, 0.58), 'W');
}

// The image is red and green above, blue and white below. Up is -z for the upper and the lower face.
static void each_face_is_upright_from_outside(void **state)
{
    static const unsigned char flag[2][2][3] = {{{255, 0, 0}, {0, 255, 0}}, {{0, 0, 255}, {255, 255, 255}}};
    static const char *const shapes[] = {"\"kind\": \"box\", \"center\": [0, 0, 0], \"size\": [2, 2, 2]",
                                         "\"kind\": \"sphere\", \"center\": [0, 0, 0], \"radius\": 1"};
    static const char *const sizes[] = {", \"size\": 2", ""};
#define SIX                                                                                                            \
    "{\"keys\": [[0, [0, 0, 5]], [0.03, [5, 0, 0]], [0.07, [0, 0, -5]], [0.12, [-5, 0, 0]], [0.16, [0, 5, 0]], [0.2, " \
    "[0, -5, 0]]], \"interpolation\": \"hold\"}"
    struct studio_scene scene = {.width_px = 24,
                                 .height_px = 24,
                                 .camera = {.up = {0, 1, -0.05}, .fov = 40},
                                 .moving_camera = "\"target\": [0, 0, 0], \"position\": " SIX,
                                 .lights = LAMP(SIX),
                                 .frames = "0-5"};
    const char *path = temp_folder_path(state, "flag.png");
    char object[512];

    assert_true(image_png_write(path, &flag[0][0][0], 2, 2, NULL));
    for (size_t i = 0; i < 2; ++i) {
        struct job job = {0};

        snprintf(
            object, sizeof object,
            "{%s, \"material\": {\"kind\": \"diffuse\", \"texture\": {\"file\": \"%s\", \"filter\": \"nearest\"%s}}}",
            shapes[i], path, sizes[i]);
        scene.objects = object;
        studio_parse(&job, &scene);
        for (int32_t frame = 0; frame < (i == 0 ? 6 : 1); ++frame) {
            struct studio_picture picture;

            studio_render(&job, frame, &picture);
            assert_upright(&picture);
            studio_finish(&picture);
        }
        job_finish(&job);
    }
}

int main(int argument_count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_floor_is_upright_to_a_viewer_along_minus_z, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_tile_is_as_high_as_its_image, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(color_space_is_the_formats_unless_given, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_box_has_the_image_on_six_faces, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(a_ball_has_the_image_once_around, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(the_wall_of_a_hole_is_coloured_as_the_floor, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(each_face_is_upright_from_outside, temp_folder_create, temp_folder_destroy),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, studio_close);
}
