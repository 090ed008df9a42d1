// Scenes far from the world's origin: as true as near it, whatever has a place, whether the camera stays or moves.
// SPDX-License-Identifier: Apache-2.0
#include "worker/glsl/scene_anchor.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/folders.h"
#include "tests/support/random_job.h"
#include "tests/support/render_frame.h"
#include "tests/support/temp_folder.h"
#include "tests/support/true_light.h"
#include "worker/picture/image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// The vector that moves each point "@[x, y, z]" of the texts below, m.
static const double FAR_AWAY[3] = {3e6, -7e5, 1.2345e6}, NEARBY[3] = {0, 0, 0};

static void write_moved(FILE *out, const char *text, const double by[3])
{
    for (; *text; text++) {
        double at[3];
        int length = 0;

        if (*text == '@' && sscanf(text, "@[%lf, %lf, %lf]%n", &at[0], &at[1], &at[2], &length) == 3 && length > 0) {
            fprintf(out, "[%.17g, %.17g, %.17g]", at[0] + by[0], at[1] + by[1], at[2] + by[2]);
            text += length - 1;
        } else {
            fputc(*text, out);
        }
    }
}

#define JOBS PROJECT_ROOT "/jobs"
#define CAMERA_STILL "\"position\": @[0.9, 0.7, -2.1]"
// Frame 0, at 1 s, is compared.
#define CAMERA_MOVES "\"position\": {\"keys\": [[0, [1, 2, 3]], [1, @[0.9, 0.7, -2.1]]], \"interpolation\": \"hold\"}"
#define POINT "{\"kind\": \"point\", \"intensity\": [3, 2, 1], \"position\": @[1, 1.2, -0.7]}"
#define POINT_INSIDE "{\"kind\": \"point\", \"intensity\": [3, 2, 1], \"position\": @[0.15, -0.05, 0.3]}"
#define SUN "{\"kind\": \"sun\", \"intensity\": [0.5, 1, 2], \"direction\": [1, -2, 0.5]}"
#define MEDIA(ALL) "\"media\": [" ALL "]"
#define SPHERE "\"bounds\": {\"kind\": \"sphere\", \"center\": @[0, 0.1, 0], \"radius\": 0.7, \"falloff\": 0.2}"
#define MIDPOINT "\"method\": \"midpoint\", \"step\": 0.01, \"light_step\": 0.02"
#define CACHED "\"method\": \"cached\", \"step\": 0.01, \"light_grid\": 96"

struct text {
    const char *camera, *lights, *scene, *quality;
};

static void parse(struct job *job, const struct text *scene, const double by[3])
{
    struct error error = {{0}};
    char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);

    if (!out) abort();
    fputs("{\"version\": 1, \"name\": \"far\", \"frames\": \"0-1\", \"fps\": 1, \"time_offset\": 1, \"resolution\": "
          "[12, 8], \"camera\": {",
          out);
    write_moved(out, scene->camera, by);
    write_moved(out, ", \"target\": @[0.05, 0, 0], \"fov\": 40}, \"background\": 0.1, \"lights\": [", by);
    write_moved(out, scene->lights, by);
    fputs("], \"scene\": {", out);
    write_moved(out, scene->scene, by);
    fprintf(out, "}, \"quality\": {%s}, \"output\": {\"path\": \"a.####.exr\", \"aovs\": [\"Z\", \"transmittance\"]}}",
            scene->quality);
    fclose(out);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
    free(text);
}

static double measure(const struct text *scene, const double by[3])
{
    struct true_light light;
    struct job job = {0};

    parse(&job, scene, by);
    light = true_light_compare(&job, GL_BACKEND_SOFTWARE);
    job_finish(&job);
    return fmax(light.radiance.relative_rmse, light.transmittance.relative_rmse);
}

// Renders with a camera that stands still, and with one that moves. Relative to the world's origin, floats would lose
// 0.1 and more.
static void assert_true_far_away(const char *lights, const char *content, const char *quality)
{
    static const char *const cameras[] = {CAMERA_STILL, CAMERA_MOVES};

    for (int i = 0; i < 2; i++)
        assert_true(measure(&(struct text){cameras[i], lights, content, quality}, FAR_AWAY) < 1e-3);
}

#define EVEN(BOUNDS) "{\"sigma_s\": [2, 3, 4], \"density\": {\"kind\": \"homogeneous\", \"bounds\": {" BOUNDS "}}}"

static void even_media(void **state)
{
    (void)state;
    assert_true_far_away(
        POINT_INSIDE "," SUN,
        MEDIA(EVEN("\"kind\": \"box\", \"center\": @[0.1, -0.1, 0.2], \"size\": [1.1, 0.7, 0.9]") "," EVEN(
            "\"kind\": \"slab\", \"center\": @[0, 0.1, 0], \"thickness\": 0.3") "," EVEN("\"kind\": \"sphere\", "
                                                                                         "\"center\": @[-0.2, 0.1, 0], "
                                                                                         "\"radius\": 0.5")),
        "\"method\": \"equiangular\", \"points\": 16");
}

#define NOISE(MORE)                                                                                                    \
    "{\"sigma_s\": 4, \"emission\": 1, \"density\": {\"kind\": \"noise\", \"frequency\": 2, \"octaves\": 2, "          \
    "\"lacunarity\": 2,"                                                                                               \
    " \"H\": 0.4, " MORE "}}"
#define TURNED "\"rotate\": {\"axis\": [0, 1, 2], \"angle\": {\"start\": 30, \"rate\": 20}}"

static void noise_in_bounds(void **state)
{
    (void)state;
    assert_true_far_away(POINT "," SUN, MEDIA(NOISE(SPHERE)), MIDPOINT);
    assert_true_far_away(POINT "," SUN, MEDIA(NOISE(TURNED "," SPHERE)), MIDPOINT);
}

// Columns towards lights and the noise itself come from grids.
static void noise_that_is_cached(void **state)
{
    (void)state;
    assert_true_far_away(POINT "," SUN, MEDIA(NOISE(TURNED "," SPHERE)), CACHED ", \"density_grid\": 64");
    assert_true_far_away(POINT_INSIDE, MEDIA(NOISE(SPHERE)), CACHED);
}

// Noise without bounds lies where the world's origin is; its offset takes it along.
static void noise_of_the_world(void **state)
{
    static const double by[3] = {4e6, 0, -2e6};
    const struct text scene = {CAMERA_STILL ", \"clip\": [0.5, 3]", "", MEDIA(NOISE("\"offset\": [-8e6, 0, 4e6]")),
                               "\"method\": \"midpoint\", \"step\": 0.01"};

    (void)state;
    assert_true(measure(&scene, by) < 1e-3);
}

static void grids(void **state)
{
    const char *path = temp_folder_path(state, "a.nrrd");
    char content[1024];

    random_job_write_volume(path);
    snprintf(content, sizeof content,
             MEDIA("{\"sigma_s\": 3, \"density\": {\"kind\": \"grid\", \"file\": \"%s\", \"center\": @[0, 0.1, 0]}}"),
             path);
    assert_true_far_away(POINT "," SUN, content, MIDPOINT);
    snprintf(content, sizeof content,
             MEDIA("{\"sigma_s\": 3, \"density\": {\"kind\": \"grid\", \"file\": \"%s/smoke/smoke.0004.nvdb\","
                   " \"grid\": \"density\", \"center\": @[-1, -1, -1.5]}}"),
             JOBS);
    assert_true_far_away(POINT "," SUN, content, MIDPOINT);
}

static void objects(void **state)
{
    char content[2048];

    (void)state;
    snprintf(content, sizeof content,
             "\"objects\": [{\"kind\": \"plane\", \"point\": @[0, -1, 0], \"normal\": [0, 1, 0], \"material\":"
             " {\"kind\": \"diffuse\", \"texture\": {\"file\": \"%s/textures/floor.png\", \"size\": 6}}},"
             " {\"kind\": \"sphere\", \"center\": @[-0.4, 0, 0], \"radius\": 0.4, \"material\":"
             " {\"kind\": \"dielectric\", \"ior\": 1.5, \"interior\": {\"sigma_a\": [2, 1, 0.5]}}},"
             " {\"kind\": \"box\", \"center\": @[0.6, -0.3, 0], \"size\": [0.6, 0.5, 0.7], \"material\": {\"kind\": "
             "\"mirror\"}}]",
             JOBS);
    assert_true_far_away(POINT, content, "\"method\": \"equiangular\", \"points\": 8, \"max_cut\": 1");
}

#define FRACTAL                                                                                                        \
    "{\"sigma_s\": 3e-3, \"density\": {\"kind\": \"fold_fractal\", \"iterations\": 3, \"offset\": 50, \"radius\": "    \
    "300, \"rotate_x_rad\": 0.3, \"rotate_y_rad\": 0.7, \"exponent\": 1, \"scale\": 1e-2}}"

// A fractal stays around the origin, which positions are not relative to when the camera is this far away.
static void a_large_fractal(void **state)
{
    const struct text scene = {"\"position\": [900, 700, -2100]",
                               "{\"kind\": \"point\", \"falloff\": \"none\", \"intensity\": 3, \"position\": [1000, "
                               "900, -500]}",
                               MEDIA(FRACTAL), "\"method\": \"midpoint\", \"step\": 10, \"light_step\": 10"};

    (void)state;
    assert_true(measure(&scene, NEARBY) < 1e-3);
}

static void render(const char *source, const char *quality, const double by[3], struct image *image)
{
    char content[1024];
    struct text scene = {CAMERA_STILL, SUN, content, quality};
    struct job job = {0};

    snprintf(content, sizeof content,
             MEDIA("{\"sigma_s\": 4, \"density\": {\"kind\": \"glsl\", \"source\": \"%s\", \"bounds\":"
                   " {\"kind\": \"sphere\", \"center\": @[0, 0, 0], \"radius\": 1}}}"),
             source);
    parse(&job, &scene, by);
    render_frame_zero(&job, image);
    job_finish(&job);
}

// Places of the world, which is what code of the user's is written for.
static void code_of_the_users(void **state)
{
    static const double by[3] = {4096, 0, 0};
    static const char *const qualities[] = {MIDPOINT, CACHED ", \"density_grid\": 64"};

    (void)state;
    for (int i = 0; i < 2; i++) {
        struct image near, far;
        double most = 0;

        render("float density(vec3 p, float t) { return max(1.0 - dot(p, p) - p.x, 0.0); }", qualities[i], NEARBY,
               &near);
        render("float density(vec3 p, float t) { p.x -= 4096.0; return max(1.0 - dot(p, p) - p.x, 0.0); }",
               qualities[i], by, &far);
        for (size_t k = 0; k < (size_t)12 * 8 * 4; k++)
            most = fmax(most, fabs((double)near.rgba[k] - (double)far.rgba[k]));
        print_message("differs by %.2e\n", most);
        assert_true(most < 2e-3);
        image_finish(&near);
        image_finish(&far);
    }
}

static void anchors_are_near_the_camera(void **state)
{
    const struct text scene = {CAMERA_STILL, SUN, MEDIA(NOISE(SPHERE)), MIDPOINT};
    const struct text moving = {CAMERA_MOVES, SUN, MEDIA(NOISE(SPHERE)), MIDPOINT};
    double by[3] = {510, 0, 0}, anchor[3];
    struct job job = {0};

    (void)state;
    parse(&job, &moving, by);
    assert_false(scene_anchor_is_used(&job));
    assert_false(scene_anchor_moves(&job));
    scene_anchor_find(&job, 0, anchor);
    assert_true(anchor[0] == 0 && anchor[1] == 0 && anchor[2] == 0);
    job_finish(&job);
    by[0] = 2e6;
    parse(&job, &moving, by);
    assert_true(scene_anchor_moves(&job));
    scene_anchor_find(&job, 1, anchor);
    assert_true(fabs(anchor[0] - 2e6) <= 512 && anchor[1] == 0 && anchor[2] == 0);
    scene_anchor_find(&job, 0, anchor);
    assert_true(anchor[0] == 0);
    job_finish(&job);
    parse(&job, &scene, by);
    assert_true(scene_anchor_is_used(&job));
    assert_false(scene_anchor_moves(&job));
    job_finish(&job);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(even_media),
        cmocka_unit_test(noise_in_bounds),
        cmocka_unit_test(noise_that_is_cached),
        cmocka_unit_test(noise_of_the_world),
        cmocka_unit_test_setup_teardown(grids, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test(objects),
        cmocka_unit_test(a_large_fractal),
        cmocka_unit_test(code_of_the_users),
        cmocka_unit_test(anchors_are_near_the_camera),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
