// Grids of scattered light: a ball against walks in double precision, every march, several media, equal pictures.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/gl_stage.h"
#include "tests/support/random.h"
#include "tests/support/render_frame.h"
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

#define BALL                                                                                                           \
    "\"density\": { \"kind\": \"homogeneous\", \"bounds\": { \"kind\": \"sphere\", \"center\": [0, 0, 0], "            \
    "\"radius\": 1 } }"
#define SUN "{ \"kind\": \"sun\", \"intensity\": 3, \"direction\": [-1, -2, 0.5] }"
#define GRID ", \"scatter_grid\": 16, \"paths\": 4096"
#define CACHED "\"method\": \"cached\", \"step\": 0.02, \"light_grid\": 32" GRID

enum { WIDTH = 8, HEIGHT = 6, PIXELS = WIDTH * HEIGHT };

static const double pi = 3.14159265358979324, fov_tangent = 0.26794919243112270; // of 15 degrees

// Parses the ball's scene. `orders` is a number or "all", as text.
static void parse(struct job *job, const char *media, const char *lights, const char *orders, const char *quality)
{
    struct error error = {{0}};
    char text[4096];

    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"scattered\", \"frames\": \"0-9\", \"fps\": 24, \"resolution\": [%d, %d],"
             " \"camera\": { \"position\": [0, 0, 4], \"target\": [0, 0, 0], \"fov\": 30 }, \"lights\": [ %s ],"
             " \"scene\": { \"media\": [ %s ], \"scattering\": { \"orders\": %s } }, \"quality\": { %s },"
             " \"output\": { \"path\": \"scattered.####.exr\", \"pixel\": \"float\" } }",
             WIDTH, HEIGHT, lights, media, orders, quality);
    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s", error.message);
}

static void render(const char *media, const char *lights, const char *orders, const char *quality,
                   double light[PIXELS][3])
{
    struct image image;
    struct job job;

    parse(&job, media, lights, orders, quality);
    render_frame_zero(&job, &image);
    for (size_t i = 0; i < PIXELS; ++i)
        for (size_t k = 0; k < 3; ++k)
            light[i][k] = image.rgba[4 * i + k];
    image_finish(&image);
    job_finish(&job);
}

// The ball of radius 1 around the origin that the walks below know.
struct ball {
    double sigma_s, sigma_a, g, emission; // emission is a source per metre
    double sun;                           // its irradiance
    int orders;
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void normalize(double v[3])
{
    double length = sqrt(dot(v, v));

    for (int i = 0; i < 3; ++i)
        v[i] /= length;
}

// Finds the distances to the ball's surface; false where the ray misses it.
static bool find_ends(const double p[3], const double d[3], double *entry, double *exit)
{
    double middle = -dot(p, d), square = middle * middle - dot(p, p) + 1;

    if (square <= 0) return false;
    *entry = middle - sqrt(square);
    *exit = middle + sqrt(square);
    return true;
}

static double phase(double g, double cosine)
{
    return (1 - g * g) / (4 * pi * pow(1 + g * g - 2 * g * cosine, 1.5));
}

static void turn(struct random *random, double g, double d[3])
{
    double share = random_between(random, 0, 1), angle = 2 * pi * random_between(random, 0, 1), across[3], up[3],
           turned[3];
    double ratio = (1 - g * g) / (1 - g + 2 * g * share);
    double cosine = fabs(g) < 1e-6 ? 2 * share - 1 : (1 + g * g - ratio * ratio) / (2 * g);
    double sine = sqrt(fmax(1 - cosine * cosine, 0));
    int axis = fabs(d[0]) < 0.6 ? 0 : 1;

    for (int i = 0; i < 3; ++i)
        across[i] = (i == axis) - d[axis] * d[i];
    normalize(across);
    for (int i = 0; i < 3; ++i)
        up[i] = d[(i + 1) % 3] * across[(i + 2) % 3] - d[(i + 2) % 3] * across[(i + 1) % 3];
    for (int i = 0; i < 3; ++i)
        turned[i] = cosine * d[i] + sine * (cos(angle) * across[i] + sin(angle) * up[i]);
    memcpy(d, turned, sizeof turned);
    normalize(d);
}

// Returns a random number whose mean is the light that arrives at `p` from `d`.
static double walk(struct random *random, const struct ball *ball, const double from[3], const double toward[3])
{
    static const double sun[3] = {1, 2, -0.5};
    double p[3], d[3], to_sun[3], light = 0, weight = 1, sigma_t = ball->sigma_s + ball->sigma_a;

    memcpy(p, from, sizeof p);
    memcpy(d, toward, sizeof d);
    memcpy(to_sun, sun, sizeof sun);
    normalize(to_sun);
    for (int order = 1;; ++order) {
        double entry, exit, at;

        if (!find_ends(p, d, &entry, &exit)) return light;
        at = fmax(entry, 0) - log(1 - random_between(random, 0, 1)) / sigma_t;
        if (at >= exit) return light;
        for (int i = 0; i < 3; ++i)
            p[i] += at * d[i];
        light += weight * ball->emission / sigma_t;
        weight *= ball->sigma_s / sigma_t;
        if (!find_ends(p, to_sun, &entry, &exit)) exit = 0;
        light += weight * ball->sun * phase(ball->g, dot(d, to_sun)) * exp(-sigma_t * fmax(exit, 0));
        if (order == ball->orders) return light;
        if (weight < 0.2) {
            if (random_between(random, 0, 1) < 0.5) return light;
            weight *= 2;
        }
        turn(random, ball->g, d);
    }
}

struct truth {
    double means[PIXELS], own[PIXELS]; // `own`: the squared noise of the means
};

// Follows walks from the camera.
static void find_truth(const struct ball *ball, struct truth *truth)
{
    enum { WALKS = 10000 };
    struct random random = {.state = 1};

    for (int i = 0; i < PIXELS; ++i) {
        double d[3] = {fov_tangent * WIDTH / HEIGHT * ((i % WIDTH + 0.5) / WIDTH * 2 - 1),
                       fov_tangent * (1 - (i / WIDTH + 0.5) / HEIGHT * 2), -1};
        static const double camera[3] = {0, 0, 4};
        double sum = 0, squares = 0;

        normalize(d);
        for (int k = 0; k < WALKS; ++k) {
            double value = walk(&random, ball, camera, d);

            sum += value;
            squares += value * value;
        }
        truth->means[i] = sum / WALKS;
        truth->own[i] = (squares / WALKS - pow(sum / WALKS, 2)) / WALKS;
    }
}

// The error is the root of the squared error over that of the light, without the walks' own noise.
static void assert_near_truth(const struct truth *truth, double light[PIXELS][3], double limit)
{
    double square = 0, own = 0, power = 0, off = 0, all = 0, error;

    for (int i = 0; i < PIXELS; ++i) {
        square += pow(light[i][0] - truth->means[i], 2);
        own += truth->own[i];
        power += pow(truth->means[i], 2);
        off += light[i][0] - truth->means[i];
        all += truth->means[i];
    }
    error = sqrt(fmax(square - own, 0) / power);
    print_message("error %.4f beside noise of the walks of %.4f, mean off by %+.4f\n", error, sqrt(own / power),
                  off / all);
    if (!(error < limit)) fail_msg("%.4f, expected less than %.4f", error, limit);
    assert_true(fabs(off / all) < limit);
}

static void assert_true_to(const struct ball *ball, const char *orders, const char *quality, double limit)
{
    double light[PIXELS][3];
    struct truth truth;
    char media[512];
    char lights[128] = "";

    snprintf(media, sizeof media,
             "{ " BALL
             ", \"sigma_s\": %g, \"sigma_a\": %g, \"phase\": [ { \"g\": %g, \"weight\": 1 } ], \"emission\": %g }",
             ball->sigma_s, ball->sigma_a, ball->g, ball->emission);
    if (ball->sun > 0) snprintf(lights, sizeof lights, "%s", SUN);
    print_message("%s orders, %s: ", orders, quality);
    render(media, lights, orders, quality, light);
    find_truth(ball, &truth);
    assert_near_truth(&truth, light, limit);
}

// The error of 16 cells, and of their walks, is about one percent. Without the
// orders above the first the ball would be 30 % to 60 % darker.
static void a_ball_shows_all_its_orders(void **state)
{
    (void)state;
    assert_true_to(&(struct ball){.sigma_s = 1, .sigma_a = 0.1, .sun = 3, .orders = 2}, "2", CACHED, 0.01);
    assert_true_to(&(struct ball){.sigma_s = 2, .sigma_a = 0.1, .sun = 3, .orders = 4}, "4", CACHED, 0.012);
    assert_true_to(&(struct ball){.sigma_s = 3, .sigma_a = 0, .sun = 3, .orders = 1000000}, "\"all\"", CACHED, 0.015);
    assert_true_to(&(struct ball){.sigma_s = 3, .sigma_a = 0.3, .g = 0.5, .sun = 3, .orders = 1000000}, "\"all\"",
                   CACHED, 0.015);
}

static void every_march_looks_the_grid_up(void **state)
{
    static const char *const qualities[] = {
        "\"method\": \"midpoint\", \"step\": 0.02, \"light_step\": 0.05" GRID,
        "\"method\": \"jittered\", \"step\": 0.02, \"light_step\": 0.05" GRID,
        "\"method\": \"adaptive\", \"step\": 0.02, \"light_step\": 0.05, \"depth_step\": 0.1" GRID,
        "\"method\": \"gauss\", \"step\": 0.1, \"light_step\": 0.1, \"order\": 3" GRID,
        "\"method\": \"equiangular\", \"points\": 24" GRID};
    static const char media[] = "{ " BALL ", \"sigma_s\": 2, \"sigma_a\": 0.1 }";
    double light[PIXELS][3];
    struct truth truth;

    (void)state;
    find_truth(&(struct ball){.sigma_s = 2, .sigma_a = 0.1, .sun = 3, .orders = 3}, &truth);
    for (size_t i = 0; i < sizeof qualities / sizeof *qualities; ++i) {
        print_message("%s: ", qualities[i]);
        render(media, SUN, "3", qualities[i], light);
        assert_near_truth(&truth, light, 0.015);
    }
}

static double difference(double a[PIXELS][3], double b[PIXELS][3])
{
    double square = 0, power = 0;

    for (size_t i = 0; i < PIXELS; ++i)
        for (size_t k = 0; k < 3; ++k) {
            square += (a[i][k] - b[i][k]) * (a[i][k] - b[i][k]);
            power += b[i][k] * b[i][k];
        }
    return sqrt(square / power);
}

// Two media of one lobe each are one medium of both lobes.
static void media_of_other_phases_have_values_of_their_own(void **state)
{
    static const char one[] =
        "{ " BALL ", \"sigma_s\": [2, 1, 3], \"sigma_a\": 0.2, \"phase\": [ { \"g\": 0.7, \"weight\":"
        " 0.5 }, { \"g\": -0.3, \"weight\": 0.5 } ] }";
    static const char two[] = "{ " BALL ", \"sigma_s\": [1, 0.5, 1.5], \"sigma_a\": 0.2, \"phase\": [ { \"g\": 0.7,"
                              " \"weight\": 1 } ] }, { " BALL ", \"sigma_s\": [1, 0.5, 1.5], \"sigma_a\": 0, \"phase\":"
                              " [ { \"g\": -0.3, \"weight\": 1 } ] }";
    double light_of_one[PIXELS][3], light_of_two[PIXELS][3], off;

    (void)state;
    render(one, SUN, "5", CACHED, light_of_one);
    render(two, SUN, "5", CACHED, light_of_two);
    off = difference(light_of_two, light_of_one);
    print_message("two media and one: %.4f\n", off);
    assert_true(off > 0 && off < 0.02);
}

// Colours that share their draws are as each alone.
static void colours_are_as_each_alone(void **state)
{
    static const double sigma_s[] = {4, 1.5, 0.3};
    static const char colours[] = "{ " BALL ", \"sigma_s\": [4, 1.5, 0.3], \"sigma_a\": [0.1, 0.5, 0.02] }";
    static const double sigma_a[] = {0.1, 0.5, 0.02};
    double light[PIXELS][3], alone[PIXELS][3];

    (void)state;
    render(colours, SUN, "\"all\"", CACHED, light);
    for (int k = 0; k < 3; ++k) {
        double square = 0, power = 0;
        char media[512];

        snprintf(media, sizeof media, "{ " BALL ", \"sigma_s\": %g, \"sigma_a\": %g }", sigma_s[k], sigma_a[k]);
        render(media, SUN, "\"all\"", CACHED, alone);
        for (size_t i = 0; i < PIXELS; ++i) {
            square += pow(light[i][k] - alone[i][k], 2);
            power += pow(alone[i][k], 2);
        }
        print_message("colour %d: %.4f\n", k, sqrt(square / power));
        assert_true(sqrt(square / power) < 0.01);
    }
}

static void emitted_light_scatters_once_less(void **state)
{
    (void)state;
    assert_true_to(&(struct ball){.sigma_s = 2, .sigma_a = 1, .emission = 1, .orders = 2}, "2", CACHED, 0.01);
    assert_true_to(&(struct ball){.sigma_s = 2, .sigma_a = 1, .emission = 1, .orders = 1000000}, "\"all\"", CACHED,
                   0.01);
}

struct stage {
    struct gl_stage gl;
    struct image image;
    struct renderer_result result;
};

static void render_on(struct stage *stage, const struct job *job)
{
    struct error error = {{0}};

    if (!renderer_render(stage->gl.renderer, &(struct renderer_frame){.job = job, .image = &stage->image},
                         &stage->result, &error))
        fail_msg("%s", error.message);
}

static struct stage open_stage(void)
{
    struct stage stage = {.gl = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir())};

    assert_true(image_init(&stage.image, WIDTH, HEIGHT, false, false, NULL));
    return stage;
}

static void close_stage(struct stage *stage)
{
    image_finish(&stage->image);
    gl_stage_close(stage->gl);
}

// A renderer that was busy before runs the walks in other strips. The grid is kept while nothing moves.
static void a_grid_is_the_same_for_all(void **state)
{
    static const char media[] = "{ " BALL ", \"sigma_s\": 3, \"sigma_a\": 0 }";
    struct stage alone = open_stage(), busy = open_stage();
    size_t size = PIXELS * 4 * sizeof *alone.image.rgba;
    struct job job, other;

    (void)state;
    parse(&job, media, SUN, "\"all\"", CACHED);
    parse(&other, media, SUN, "\"all\"",
          "\"method\": \"cached\", \"step\": 0.02, \"light_grid\": 32, \"scatter_grid\": 9,"
          " \"paths\": 3000");
    render_on(&alone, &job);
    assert_true(alone.result.cache_fills > 0);
    render_on(&busy, &other);
    render_on(&busy, &other);
    assert_int_equal(busy.result.cache_fills, 0);
    render_on(&busy, &job);
    assert_true(busy.result.cache_fills > 0);
    assert_memory_equal(alone.image.rgba, busy.image.rgba, size);
    job.scene.camera.position.value[0] = 0.5; // walks begin against the camera's rays
    render_on(&busy, &job);
    assert_true(busy.result.cache_fills > 0);
    job_finish(&other);
    job_finish(&job);
    close_stage(&busy);
    close_stage(&alone);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ball_shows_all_its_orders),
        cmocka_unit_test(every_march_looks_the_grid_up),
        cmocka_unit_test(media_of_other_phases_have_values_of_their_own),
        cmocka_unit_test(colours_are_as_each_alone),
        cmocka_unit_test(emitted_light_scatters_once_less),
        cmocka_unit_test(a_grid_is_the_same_for_all),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
