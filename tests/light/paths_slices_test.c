// Random paths continued slice by slice: light as in longer slices, exact sums, and progress within a tile.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/bias_check.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "tests/support/shader_variant.h"
#include "tests/support/temp_folder.h"
#include "worker/picture/image.h"
#include "worker/picture/pixel.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#define BALL "\"bounds\": { \"kind\": \"sphere\", \"radius\": 0.9 }"
#define NARROW                                                                                                         \
    "{ \"sigma_s\": 8, \"sigma_a\": 0.1, \"phase\": [{ \"g\": 0.9 }],"                                                 \
    " \"density\": { \"kind\": \"homogeneous\", " BALL " } }"
#define SUN "{ \"kind\": \"sun\", \"intensity\": 3, \"direction\": [0.3, -1, 0.5] },"
#define PATHS(COUNT) "\"method\": \"paths\", \"paths\": " COUNT

struct watch {
    double last;
    int inner; // values told that lie well between none and all
};

static bool on_progress(void *user, double done)
{
    struct watch *watch = user;

    assert_true(done >= watch->last && done <= 1.0);
    watch->inner += done > watch->last && done > 0.1 && done < 0.9;
    watch->last = done;
    return true;
}

// Renders the frame, or of it one pixel. The caller finishes the image.
static struct image render(const struct bias_check_scene *scene, const char *shader_dir, const struct pixel *pixel,
                           struct watch *watch)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, shader_dir);
    struct renderer_result result;
    struct error error = {{0}};
    struct image image;
    struct job job;

    bias_check_parse(&job, scene);
    assert_true(image_init(&image, pixel ? 1 : job.width_px, pixel ? 1 : job.height_px, true, true, NULL));
    if (!renderer_render(stage.renderer,
                         &(struct renderer_frame){.job = &job,
                                                  .pixels = pixel,
                                                  .pixel_count = pixel != NULL,
                                                  .image = &image,
                                                  .on_progress = on_progress,
                                                  .user = watch},
                         &result, &error))
        fail_msg("%s", error.message);
    job_finish(&job);
    gl_stage_close(stage);
    return image;
}

// All that a path knows is kept, that of second paths included: but for the last digits of sums, light is the same.
static void short_slices_find_the_same_light(void **state)
{
    const struct bias_check_scene scene = {
        .media = NARROW, .lights = SUN, .orders = "\"all\"", .background = "0", .quality = PATHS("64")};
    struct watch watch = {0};
    struct image whole = render(&scene, test_shader_dir(), NULL, &watch), sliced;
    double most = 0.0;

    shader_variant_write(state, "scatter/walk.glsl", "kind == WALK_ON ? WALK_TURNS", "kind == WALK_ON ? 3");
    watch = (struct watch){0};
    sliced = render(&scene, *state, NULL, &watch);
    for (size_t i = 0; i < BIAS_CHECK_VALUES / 3; i++) {
        double value = (double)whole.rgba[4 * i], other = (double)sliced.rgba[4 * i];

        most = fmax(most, value);
        assert_true(fabs(other - value) <= 2e-5 * fabs(value));
    }
    assert_true(most > 0.1);
    assert_true(watch.inner > 20);
    image_finish(&whole);
    image_finish(&sliced);
}

// A million paths of a pixel meet a floor that all see alike: albedo / pi of what the sun sends. In single precision a
// sum of equal parts would be off by as much as the part's last digits there: some percent of what comes last.
static void sums_of_a_million_paths_lose_nothing(void **state)
{
    const struct bias_check_scene scene = {
        .media = "{ \"sigma_s\": 1, \"density\": { \"kind\": \"homogeneous\", \"bounds\": { \"kind\": \"sphere\","
                 " \"center\": [0, 0, -9], \"radius\": 0.1 } } }",
        .lights = "{ \"kind\": \"sun\", \"intensity\": 1.1, \"direction\": [0, -1, 0] },",
        .objects = "{ \"kind\": \"plane\", \"point\": [0, -1, 0], \"material\": { \"kind\": \"diffuse\","
                   " \"albedo\": 0.7 } }",
        .orders = "2",
        .background = "0",
        .quality = PATHS("1048576")};
    const struct pixel pixel = {6, 8};
    const double truth = 0.7 * 1.1 / acos(-1.0);
    struct watch watch = {0};
    struct image image = render(&scene, test_shader_dir(), &pixel, &watch);

    (void)state;
    print_message("%.6f of %.6f\n", (double)image.rgba[0], truth);
    assert_true(fabs((double)image.rgba[0] / truth - 1.0) < 2e-4);
    assert_true(watch.inner > 4);
    image_finish(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(short_slices_find_the_same_light, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test(sums_of_a_million_paths_lose_nothing),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
