// As many objects, shapes and images as a job may have, all of them different, in one shader.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/png_maker.h"
#include "tests/support/random.h"
#include "tests/support/temp_folder.h"
#include "tests/support/true_light.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { IMAGE_SIDE = 5 };

static const char HEAD[] =
    "{ \"version\": 1, \"name\": \"limits\", \"frames\": \"0\", \"fps\": 24, \"resolution\": [24, 16],"
    " \"camera\": { \"position\": [0.3, 0.2, 6], \"target\": [0, 0, 0], \"fov\": 40 },"
    " \"lights\": [ { \"kind\": \"sun\", \"direction\": [-0.4, -1, -2], \"intensity\": 2 } ],"
    " \"background\": 0.5, \"scene\": { \"objects\": [ ";
static const char TAIL[] = " ] }, \"quality\": { \"method\": \"midpoint\", \"step\": 1, \"max_depth\": 3 },"
                           " \"output\": { \"path\": \"limits.####.exr\", \"aovs\": [\"Z\", \"transmittance\"] } }";

static void write_image(const char *path, unsigned seed)
{
    unsigned char bytes[3 * IMAGE_SIDE * IMAGE_SIDE];
    struct random random = {seed};

    for (size_t i = 0; i < sizeof bytes; ++i)
        bytes[i] = (unsigned char)random_between(&random, 0, 256);
    png_maker_write_rgb(path, IMAGE_SIDE, IMAGE_SIDE, bytes);
}

// A ball and a box overlap, at a point of a grid of four by four.
static void write_object(FILE *out, size_t i, const char *material)
{
    double x = 1.1 * (double)(i % 4) - 1.65, y = 1.1 * (double)(i / 4) - 1.65;

    fprintf(out,
            "%s{ \"kind\": \"union\", \"of\": [ { \"kind\": \"sphere\", \"center\": [%g, %g, 0], \"radius\": %g },"
            " { \"kind\": \"box\", \"center\": [%g, %g, 0.2], \"size\": [%g, 0.4, 0.5] } ], \"material\": { %s } }",
            i > 0 ? ", " : "", x, y, 0.3 + 0.01 * (double)i, x, y, 0.9 - 0.01 * (double)i, material);
}

static void parse_job(struct job *job, void **state)
{
    struct error error = {{0}};
    size_t length = 0;
    char *text = NULL;
    FILE *out = open_memstream(&text, &length);

    fputs(HEAD, out);
    for (unsigned i = 0; i < SCENE_OBJECT_LIMIT; ++i) {
        char material[768], name[32];

        snprintf(name, sizeof name, "image_%u.png", i);
        write_image(temp_folder_path(state, name), i);
        snprintf(material, sizeof material,
                 "\"kind\": \"diffuse\", \"specular\": %g, \"texture\": { \"file\": \"%s\", \"size\": %g }",
                 i % 3 == 0 ? 0.5 : 0, temp_folder_path(state, name), 0.5 + 0.05 * i);
        write_object(out, i, material);
    }
    fputs(TAIL, out);
    fclose(out);
    if (!job_parse(job, text, length, NULL, &error)) fail_msg("%s", error.message);
    assert_int_equal(job->scene.object_count, SCENE_OBJECT_LIMIT);
    assert_int_equal(job->scene.shape_count, SCENE_SHAPE_LIMIT);
    free(text);
}

static void compare(void **state, enum gl_backend backend)
{
    struct true_light light;
    struct job job;

    parse_job(&job, state);
    light = true_light_compare(&job, backend);
    assert_true(true_light_is_within(&light, 1e-4));
    job_finish(&job);
}

static void a_full_scene_is_lit_as_its_twin(void **state)
{
    compare(state, GL_BACKEND_SOFTWARE);
}

static void a_full_scene_is_lit_as_its_twin_on_egl(void **state)
{
    compare(state, GL_BACKEND_EGL);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, temp_folder_create, temp_folder_destroy)
    const struct CMUnitTest tests[] = {TEST(a_full_scene_is_lit_as_its_twin),
                                       TEST(a_full_scene_is_lit_as_its_twin_on_egl)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
