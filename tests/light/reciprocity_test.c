// Light goes both ways alike: what an isotropic lamp at one place sends to another is what one there would send back.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "reference/vec3.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// A place sees all around through the six faces of a cube. All of them are frames of one job, again and again.
enum { SIDE_PX = 16, FACES = 6, PLACES = 2, ROUNDS = 8, FRAMES = ROUNDS * PLACES * FACES };

// Beside the media: a path from the one to the other meets no lamp on its way, and its noise is bounded.
static const struct vec3 places[PLACES] = {{-0.7, 0.6, 0.8}, {1.3, -0.3, -0.9}};

// Media that vary, with phase functions that differ, and coefficients that differ by colour.
#define MEDIA                                                                                                          \
    "{\"sigma_s\": [3, 2, 1], \"sigma_a\": [0.2, 0.4, 0.1], \"phase\": [{\"g\": 0.7}], \"density\": {\"kind\":"        \
    " \"noise\", \"frequency\": 2, \"octaves\": 2, \"bias\": 0.3, \"bounds\": {\"kind\": \"sphere\","                  \
    " \"radius\": 1, \"falloff\": 0.4}}}, {\"sigma_s\": [0.5, 1, 2], \"sigma_a\": 0.1, \"phase\": [{\"g\": -0.6}],"    \
    " \"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"box\", \"center\": [0.7, 0, -0.3], \"size\":"  \
    " [1, 1.4, 1.2]}}}"
#define FLOOR                                                                                                          \
    "{\"kind\": \"plane\", \"point\": [0, -0.8, 0], \"material\": {\"kind\": \"diffuse\", \"albedo\": [0.9, 0.6, "     \
    "0.3]}}"

// The directions of a face: ahead, up and to the right. The first face looks from one place to the other, where light
// has a peak that the middle of a face weighs evenly.
struct view {
    struct vec3 from, ahead, up, lamp;
};

static struct view view_of(int frame)
{
    int place = frame / FACES % PLACES, face = frame % FACES;
    struct vec3 from = places[place], lamp = places[1 - place];
    struct vec3 axes[3];

    axes[0] = vec3_normalize(vec3_subtract(lamp, from));
    axes[1] = vec3_normalize(vec3_cross(axes[0], (struct vec3){0.3, 0.9, 0.2}));
    axes[2] = vec3_cross(axes[0], axes[1]);
    return (struct view){.from = from,
                         .ahead = vec3_scale(axes[face / 2], face % 2 ? -1.0 : 1.0),
                         .up = axes[(face / 2 + 1) % 3],
                         .lamp = lamp};
}

enum part { FROM, TARGET, UP, LAMP };

static struct vec3 part_of(const struct view *view, enum part part)
{
    return part == FROM     ? view->from
           : part == TARGET ? vec3_add(view->from, view->ahead)
           : part == UP     ? view->up
                            : view->lamp;
}

static void write_keys(FILE *out, enum part part)
{
    fputs("{\"keys\": [", out);
    for (int i = 0; i < FRAMES; i++) {
        struct view view = view_of(i);
        struct vec3 value = part_of(&view, part);

        fprintf(out, "%s[%d, [%.12g, %.12g, %.12g]]", i > 0 ? ", " : "", i, value.x, value.y, value.z);
    }
    fputs("]}", out);
}

static void parse(struct job *job, const char *objects, const char *quality)
{
    struct error error = {{0}};
    char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);

    assert_non_null(out);
    fprintf(out, "{\"version\": 1, \"name\": \"both\", \"frames\": \"0-%d\", \"fps\": 1, \"resolution\": [%d, %d],",
            FRAMES - 1, SIDE_PX, SIDE_PX);
    fputs("\"camera\": {\"fov\": 90, \"position\": ", out);
    write_keys(out, FROM);
    fputs(", \"target\": ", out);
    write_keys(out, TARGET);
    fputs(", \"up\": ", out);
    write_keys(out, UP);
    fputs("}, \"lights\": [{\"kind\": \"point\", \"intensity\": 1, \"position\": ", out);
    write_keys(out, LAMP);
    fprintf(out,
            "}], \"scene\": {\"scattering\": {\"orders\": \"all\"}, \"media\": [" MEDIA "], \"objects\": [%s]},"
            " \"quality\": {%s}, \"output\": {\"path\": \"a.####.exr\", \"pixel\": \"float\"}}",
            objects, quality);
    fclose(out);
    if (!job_parse(job, text, length, NULL, &error)) fail_msg("%s", error.message);
    free(text);
}

// Adds the light of a face times its solid angle.
static void add_face(const struct image *image, double fluence[static 3])
{
    const double width = 2.0 / SIDE_PX;

    for (int i = 0; i < SIDE_PX * SIDE_PX; i++) {
        double x = (i % SIDE_PX + 0.5) * width - 1.0, y = (i / SIDE_PX + 0.5) * width - 1.0;
        double angle = width * width / pow(1.0 + x * x + y * y, 1.5);

        for (int c = 0; c < 3; c++)
            fluence[c] += image->rgba[4 * i + c] * angle;
    }
}

struct mean {
    double value, square; // the mean of the rounds, and the square of its standard error
};

static struct mean mean_of(double fluences[static ROUNDS * PLACES][3], int place, int colour)
{
    double sum = 0.0, squares = 0.0;

    for (int i = place; i < ROUNDS * PLACES; i += PLACES)
        sum += fluences[i][colour];
    for (int i = place; i < ROUNDS * PLACES; i += PLACES)
        squares += pow(fluences[i][colour] - sum / ROUNDS, 2.0);
    return (struct mean){sum / ROUNDS, squares / (ROUNDS - 1) / ROUNDS};
}

static void measure(const struct job *job, double fluences[static ROUNDS * PLACES][3])
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct error error = {{0}};
    struct image image;

    if (!image_init_for_job(&image, job, &error)) fail_msg("%s", error.message);
    for (int i = 0; i < FRAMES; i++) {
        struct renderer_result result;

        if (!renderer_render(stage.renderer, &(struct renderer_frame){.job = job, .frame = i, .image = &image}, &result,
                             &error))
            fail_msg("%s", error.message);
        add_face(&image, fluences[i / FACES]);
    }
    image_finish(&image);
    gl_stage_close(stage);
}

// `most`: what the mean may be off by itself, relative to the light; `noise`: the largest standard error, or nothing is
// shown.
static void assert_both_ways(const char *objects, const char *quality, double most, double noise)
{
    double fluences[ROUNDS * PLACES][3] = {{0.0}};
    struct job job;

    parse(&job, objects, quality);
    measure(&job, fluences);
    job_finish(&job);
    for (int c = 0; c < 3; c++) {
        struct mean there = mean_of(fluences, 0, c), back = mean_of(fluences, 1, c);
        double off = there.value - back.value, error = sqrt(there.square + back.square);

        print_message("colour %d: %.4f there, %.4f back: off by %+.2f %%, %+.1f standard errors\n", c, there.value,
                      back.value, 100.0 * off / there.value, off / error);
        assert_true(error < noise * there.value);
        assert_true(fabs(off) < 4.0 * error + most * there.value);
    }
}

static void paths_go_both_ways_alike(void **state)
{
    (void)state;
    assert_both_ways(FLOOR, "\"method\": \"paths\", \"paths\": 256, \"samples\": 8", 0.0, 0.03);
}

static void paths_by_light_grids_go_both_ways_alike(void **state)
{
    (void)state;
    assert_both_ways(FLOOR, "\"method\": \"paths\", \"paths\": 256, \"samples\": 8, \"light_grid\": 48", 0.0, 0.03);
}

// Grids have the same random numbers in each round: their noise, and their cells, are what the mean may be off by.
#define GRID "\"method\": \"cached\", \"step\": 0.05, \"light_grid\": 48, \"samples\": 4, \"scatter_grid\": 16, "

static void grids_from_the_lights_go_both_ways_alike(void **state)
{
    (void)state;
    assert_both_ways("", GRID "\"scatter_from\": \"lights\", \"paths\": 128", 0.03, 0.02);
}

static void grids_from_their_nodes_go_both_ways_alike(void **state)
{
    (void)state;
    assert_both_ways("", GRID "\"scatter_from\": \"nodes\", \"paths\": 1024", 0.03, 0.02);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paths_go_both_ways_alike),
        cmocka_unit_test(paths_by_light_grids_go_both_ways_alike),
        cmocka_unit_test(grids_from_the_lights_go_both_ways_alike),
        cmocka_unit_test(grids_from_their_nodes_go_both_ways_alike),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
