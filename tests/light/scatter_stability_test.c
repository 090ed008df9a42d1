// What both families of light above order 1 promise where methods fail, and that auto keeps its tolerance or says why.
// SPDX-License-Identifier: Apache-2.0
// "svg" draws all rows, in a quarter of an hour; cmocka's own lines stand around the picture.
// "print [SLUG [METHOD]]" prints the points of all rows, of one row, or of one method of it: docs/stability.md's table.
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/exr_maker.h"
#include "tests/support/shader_dir.h"
#include "tests/support/svg_map.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tolerance_stage.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 9, HEIGHT_PX = 7, PIXELS = WIDTH_PX * HEIGHT_PX, VALUE_LIMIT = 6, FRAMES = 2 };

// The scene: a lit ball of radius 1, or a box as wide and thin.
struct setup {
    double sigma_t, albedo, g, thickness; // thickness 0: a ball
    double lamp[3], move;                 // by which the lamp moves from frame 0 to frame 1
    bool is_inverse_square;
    double sun; // of a sky, relative to the sky; 0: no sky, but the lamp
};

enum row_slug { WHITE, DEEP, LOBE, THICK, WITHIN, THIN, SKY, FLICKER };

struct row {
    const char *slug, *name;
    enum row_slug which;
    double values[VALUE_LIMIT];
    int count;
    double exactness; // of the truth, relative
};

static const struct row rows[] = {
    {"white", "albedo, of optical depth 20", WHITE, {0.5, 0.9, 0.99, 0.999, 1}, 5, 0.01},
    {"deep", "albedo, of optical depth 100 and g 0.95", DEEP, {0.5, 0.99, 1}, 3, 0.02},
    {"lobe", "g, of optical depth 20 and albedo 1", LOBE, {-0.9, 0, 0.5, 0.85, 0.95, 0.99}, 6, 0.01},
    {"thick", "optical depth, of albedo 1", THICK, {0.01, 1, 10, 100, 1000}, 5, 0.02},
    {"within", "distance of a lamp in the medium from a camera ray, m", WITHIN, {0.3, 0.1, 1e-2, 1e-4, 1e-5}, 5, 0.01},
    {"thin", "thickness of a medium of optical depth 1, m", THIN, {0.5, 0.05, 5e-3, 5e-4}, 4, 0.01},
    {"sky", "how many times as bright as its sky a dome's sun is", SKY, {1, 1e2, 1e4, 1e5}, 4, 0.01},
    {"flicker",
     "flicker: false change from frame to frame as a lamp moves so far, m",
     FLICKER,
     {1e-4, 1e-2, 0.1},
     3,
     0.01},
};
enum { ROW_COUNT = sizeof rows / sizeof rows[0] };

static const struct method {
    const char *name, *quality;
    double tolerance; // 0: as stated
} methods[] = {
    {"paths", "\"method\":\"paths\",\"paths\":1024", 0},
    {"grid", "\"method\":\"cached\",\"step\":0.05,\"light_grid\":48,\"scatter_grid\":16,\"paths\":256", 0},
    {"auto", "\"tolerance\":0.03", 0.03},
};
enum { METHOD_COUNT = sizeof methods / sizeof methods[0] };

struct point {
    bool is_refused, is_finite;
    double error;
    char reason[400];
};

static struct setup setup_of(enum row_slug which, double value)
{
    struct setup setup = {.sigma_t = 10, .albedo = 0.9, .lamp = {2, 1.5, 2}};

    switch (which) {
    case WHITE:
        setup.albedo = value;
        break;
    case DEEP:
        setup = (struct setup){.sigma_t = 50, .albedo = value, .g = 0.95, .lamp = {2, 1.5, 2}};
        break;
    case LOBE:
        setup.albedo = 1;
        setup.g = value;
        break;
    case THICK:
        setup.sigma_t = value / 2;
        setup.albedo = 1;
        break;
    case WITHIN:
        setup = (struct setup){.sigma_t = 2, .albedo = 0.9, .lamp = {value, 0, 0.1}, .is_inverse_square = true};
        break;
    case THIN:
        setup.sigma_t = 1 / value;
        setup.thickness = value;
        break;
    case SKY:
        setup.sigma_t = 2;
        setup.sun = value;
        break;
    case FLICKER:
        setup.sigma_t = 3;
        setup.move = value;
        break;
    }
    return setup;
}

static void write_sky(const char *path, double sun)
{
    enum { WIDTH = 64, HEIGHT = 32 };
    static float rgb[HEIGHT * WIDTH * 3];

    for (int i = 0; i < HEIGHT * WIDTH * 3; i++)
        rgb[i] = 0.5F;
    for (int c = 0; c < 3; c++)
        rgb[3 * (9 * WIDTH + 40) + c] = (float)(0.5 * sun);
    exr_maker_write(path, WIDTH, HEIGHT, JOB_PIXEL_FLOAT, rgb);
}

static void write_lights(FILE *out, const struct setup *setup, const char *sky)
{
    const double *lamp = setup->lamp;

    fputs(", \"lights\": [", out);
    if (setup->sun > 0)
        fprintf(out, "{\"kind\": \"dome\", \"file\": \"%s\"}", sky);
    else
        fprintf(out,
                "{\"kind\": \"point\", \"intensity\": 2, \"falloff\": \"%s\", \"position\": {\"keys\": [[0, [%.17g,"
                " %.17g, %.17g]], [1, [%.17g, %.17g, %.17g]]], \"interpolation\": \"hold\"}}",
                setup->is_inverse_square ? "inverse_square" : "none", lamp[0], lamp[1], lamp[2], lamp[0] + setup->move,
                lamp[1], lamp[2]);
    fputs("]", out);
}

static bool parse(struct job *job, const struct setup *setup, const char *quality, const char *sky, struct error *error)
{
    char bounds[128] = "\"kind\": \"sphere\", \"radius\": 1", *text = NULL;
    size_t length;
    bool ok;
    FILE *out = open_memstream(&text, &length);

    if (setup->thickness > 0)
        snprintf(bounds, sizeof bounds, "\"kind\": \"box\", \"size\": [1.6, 1.6, %.17g]", setup->thickness);
    fprintf(out,
            "{\"version\": 1, \"name\": \"limits\", \"frames\": \"0-%d\", \"fps\": 1, \"resolution\": [%d, %d],"
            " \"camera\": {\"position\": [0, 0, 4], \"target\": [0, 0, 0], \"fov\": 26, \"clip\": [2.5, 5.5]}",
            setup->move > 0 ? FRAMES - 1 : 0, WIDTH_PX, HEIGHT_PX);
    write_lights(out, setup, sky);
    fprintf(
        out,
        ", \"scene\": {\"scattering\": {\"orders\": \"all\"}, \"media\": [{\"sigma_s\": %.17g, \"sigma_a\": %.17g,"
        " \"phase\": [{\"g\": %g, \"weight\": 1}], \"density\": {\"kind\": \"homogeneous\", \"bounds\": {%s,"
        " \"center\": [0, 0, 0]}}}]}, \"quality\": {%s}, \"output\": {\"path\": \"a.####.exr\", \"pixel\": \"float\"}}",
        setup->sigma_t * setup->albedo, setup->sigma_t * (1 - setup->albedo), setup->g, bounds, quality);
    fclose(out);
    ok = job_parse(job, text, strlen(text), NULL, error);
    free(text);
    return ok;
}

struct lit {
    struct truth_pixel pixels[PIXELS];
};

static void find_light(const struct job *job, int32_t frame, double exactness, struct lit *light)
{
    struct integrate_accuracy accuracy = {.relative = exactness};
    struct pixel all[PIXELS];
    struct error error = {{0}};
    struct truth *truth = truth_open(&(struct truth_params){.job = job, .frame = frame}, &error);

    if (!truth) fail_msg("%s", error.message);
    for (int i = 0; i < PIXELS; i++)
        all[i] = (struct pixel){i % WIDTH_PX, i / WIDTH_PX};
    truth_measure_many(
        truth, &(struct truth_many){.points = all, .pixels = light->pixels, .count = PIXELS, .accuracy = &accuracy});
    truth_close(truth);
}

// What one frame shows.
struct shown {
    struct image image;
    struct lit light;
};

// The relative error of `now`, or of its change since `then`; the truth's noise, in two halves, counts nothing.
static double find_error(const struct shown *then, const struct shown *now)
{
    double apart = 0, power = 0;

    for (size_t i = 0; i < 3 * PIXELS; i++) {
        size_t pixel = i / 3, c = i % 3;
        const struct truth_pixel *known = &now->light.pixels[pixel];
        double off = now->image.rgba[4 * pixel + c] - known->rgb[c], half = known->half[c];

        if (then) {
            const struct truth_pixel *before = &then->light.pixels[pixel];

            off -= then->image.rgba[4 * pixel + c] - before->rgb[c];
            half = hypot(half, before->half[c]);
        }
        apart += off * off - half * half;
        power += known->rgb[c] * known->rgb[c];
    }
    return sqrt(fmax(apart, 0) / power);
}

static bool render(struct tolerance_stage stage, const struct method *method, const struct job *job, int32_t frame,
                   struct image *image, struct error *error)
{
    struct renderer_result result;
    struct tolerance_result kept;

    if (method->tolerance > 0) return tolerance_stage_render(stage, job, frame, image, &kept, error);
    *image = tolerance_stage_make_image(job);
    return renderer_render(stage.gl.renderer, &(struct renderer_frame){.job = job, .frame = frame, .image = image},
                           &result, error);
}

static struct point measure(const struct row *row, double value, const struct method *method, const char *sky)
{
    struct setup setup = setup_of(row->which, value);
    struct tolerance_stage stage = tolerance_stage_open(test_shader_dir());
    struct shown shown[FRAMES];
    struct point point = {.is_finite = true};
    struct error error = {{0}};
    int frames = setup.move > 0 ? FRAMES : 1, done = 0;
    struct job job = {0};

    if (setup.sun > 0) write_sky(sky, setup.sun);
    point.is_refused = !parse(&job, &setup, method->quality, sky, &error);
    for (; done < frames && !point.is_refused; done++) {
        point.is_refused = !render(stage, method, &job, done, &shown[done].image, &error);
        if (point.is_refused) continue;
        point.is_finite = point.is_finite && image_is_finite(&shown[done].image, false, NULL);
        find_light(&job, done, row->exactness, &shown[done].light);
    }
    if (point.is_refused)
        snprintf(point.reason, sizeof point.reason, "%.300s", error.message);
    else
        point.error = find_error(frames > 1 ? &shown[0] : NULL, &shown[frames - 1]);
    while (done-- > 0)
        image_finish(&shown[done].image);
    job_finish(&job);
    tolerance_stage_close(stage);
    return point;
}

static void print(const struct row *row, double value, const struct method *method, const struct point *point)
{
    if (point->is_refused)
        printf("%-8s %-6s %-8g refused: %s\n", row->slug, method->name, value, point->reason);
    else
        printf("%-8s %-6s %-8g %s %.2f %%\n", row->slug, method->name, value,
               point->is_finite ? "error" : "not finite, error", 100 * point->error);
    (void)fflush(stdout);
}

// What is checked on every run: the largest error of a method at a value.
static const struct promise {
    const char *slug, *method;
    double value, error;
} promises[] = {
    {"white", "paths", 0.5, 0.03},  {"within", "paths", 1e-4, 0.02}, {"within", "paths", 1e-5, 0.03},
    {"thin", "paths", 5e-4, 0.06},  {"thin", "grid", 0.5, 0.05},     {"thin", "auto", 5e-4, 0.03},
    {"flicker", "grid", 0.1, 0.02}, {"sky", "paths", 1e5, 0.07},     {"thick", "auto", 0.01, 0.03},
};

static const struct row *find_row(const char *slug)
{
    const struct row *row = rows;

    while (strcmp(row->slug, slug) != 0)
        row++;
    return row;
}

static const struct method *find_method(const char *name)
{
    const struct method *method = methods;

    while (strcmp(method->name, name) != 0)
        method++;
    return method;
}

static void families_keep_their_promises(void **state)
{
    int broken = 0;

    for (size_t i = 0; i < sizeof promises / sizeof promises[0]; i++) {
        const struct promise *promise = &promises[i];
        const struct row *row = find_row(promise->slug);
        const struct method *method = find_method(promise->method);
        struct point point = measure(row, promise->value, method, temp_folder_path(state, "sky.exr"));

        print(row, promise->value, method, &point);
        if (!point.is_refused && point.is_finite && point.error <= promise->error) continue;
        printf("expected an error of at most %.2f %%\n", 100 * promise->error);
        broken++;
    }
    assert_int_equal(broken, 0);
}

static const char *only_row, *only_method;

enum { LEFT = 60, CELL_WIDTH = 62, CELL_HEIGHT = 19, ROW_HEIGHT = 24 + CELL_HEIGHT * (METHOD_COUNT + 1) };
static const double GOOD = 0.01, FAIR = 0.1;

static void draw_point(const struct point *point, int x, int y)
{
    const char *class = point->is_refused     ? "refused"
                        : !point->is_finite   ? "bad"
                        : point->error > FAIR ? "bad"
                        : point->error > GOOD ? "fair"
                                              : "good";

    printf("<rect class=\"%s\" x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\"/>", class, x + 1, y + 1, CELL_WIDTH - 2,
           CELL_HEIGHT - 2);
    printf("<text class=\"cell\" x=\"%d\" y=\"%d\" text-anchor=\"middle\">", x + CELL_WIDTH / 2, y + 13);
    if (point->is_refused)
        printf("refused");
    else
        printf(point->error < 1e-3 ? "&lt; 0.1 %%" : "%.1f %%", 100 * point->error);
    printf("</text>\n");
    (void)fflush(stdout);
}

// The rows as a picture, in the colours of tests/light/stability_test's.
static void draw_all(void **state)
{
    int width = LEFT + CELL_WIDTH * VALUE_LIMIT + 10, height = 24 + ROW_HEIGHT * ROW_COUNT + 4;

    svg_map_begin(width, height);
    printf("<text x=\"8\" y=\"16\">all orders; error up to %g %% is good, up to %g %% fair, more is bad</text>\n",
           100 * GOOD, 100 * FAIR);
    for (size_t i = 0; i < ROW_COUNT; i++) {
        int top = 24 + ROW_HEIGHT * (int)i;

        printf("<text class=\"title\" x=\"8\" y=\"%d\">%s</text>\n", top + 16, rows[i].name);
        for (int v = 0; v < rows[i].count; v++)
            printf("<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">%g</text>\n", LEFT + CELL_WIDTH * v + CELL_WIDTH / 2,
                   top + 34, rows[i].values[v]);
        for (size_t k = 0; k < METHOD_COUNT; k++) {
            int y = top + 20 + CELL_HEIGHT * ((int)k + 1);

            printf("<text x=\"8\" y=\"%d\">%s</text>\n", y + 13, methods[k].name);
            for (int v = 0; v < rows[i].count; v++) {
                struct point point =
                    measure(&rows[i], rows[i].values[v], &methods[k], temp_folder_path(state, "sky.exr"));

                draw_point(&point, LEFT + CELL_WIDTH * v, y);
            }
        }
    }
    printf("</svg>\n");
}

static void print_all(void **state)
{
    for (size_t i = 0; i < ROW_COUNT; i++)
        for (size_t k = 0; k < METHOD_COUNT; k++)
            for (int v = 0; v < rows[i].count; v++) {
                struct point point;

                if (only_row && strcmp(rows[i].slug, only_row) != 0) continue;
                if (only_method && strcmp(methods[k].name, only_method) != 0) continue;
                point = measure(&rows[i], rows[i].values[v], &methods[k], temp_folder_path(state, "sky.exr"));
                print(&rows[i], rows[i].values[v], &methods[k], &point);
            }
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(families_keep_their_promises, temp_folder_create, temp_folder_destroy),
    };
    const struct CMUnitTest by_hand[] = {
        cmocka_unit_test_setup_teardown(print_all, temp_folder_create, temp_folder_destroy),
    };

    const struct CMUnitTest as_picture[] = {
        cmocka_unit_test_setup_teardown(draw_all, temp_folder_create, temp_folder_destroy),
    };

    if (argc > 1 && strcmp(argv[1], "svg") == 0) return cmocka_run_group_tests(as_picture, NULL, NULL);
    if (argc < 2 || strcmp(argv[1], "print") != 0) return cmocka_run_group_tests(tests, NULL, NULL);
    only_row = argc > 2 ? argv[2] : NULL;
    only_method = argc > 3 ? argv[3] : NULL;
    return cmocka_run_group_tests(by_hand, NULL, NULL);
}
