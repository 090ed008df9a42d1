// A list of pixels has the values that the whole frame has there, to the bit, whatever its order and length.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/job/job.h"
#include "tests/support/assert_near.h"
#include "tests/support/ball_job.h"
#include "tests/support/example_job.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "worker/picture/image.h"
#include "worker/picture/pixel.h"
#include "worker/render/renderer.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enum { WIDTH_PX = 48, HEIGHT_PX = 27, PIXELS = WIDTH_PX * HEIGHT_PX, LONGEST = 33000 };

static uint32_t draw(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

// Random pixels of the frame, some of them several times.
static void draw_list(struct pixel *pixels, size_t count, uint32_t seed)
{
    for (size_t i = 0; i < count; i++) {
        pixels[i].x = (int)(draw(&seed) % WIDTH_PX);
        pixels[i].y = (int)(draw(&seed) % HEIGHT_PX);
    }
}

static void list_all(struct pixel *pixels)
{
    for (int i = 0; i < PIXELS; i++)
        pixels[i] = (struct pixel){(PIXELS - 1 - i) % WIDTH_PX, (PIXELS - 1 - i) / WIDTH_PX};
}

static struct renderer_result render(struct renderer *renderer, const struct job *job, const struct pixel *pixels,
                                     size_t count, struct image *image)
{
    int rows = count == LONGEST ? 3 : 1; // an image has a longest side
    struct error error = {{0}};
    struct renderer_result result = {0};
    bool ok = pixels ? image_init(image, (int)count / rows, rows, job->output.has_depth, job->output.has_transmittance,
                                  &error)
                     : image_init_for_job(image, job, &error);

    ok = ok && image_ask_cut(image, &error) &&
         renderer_render(
             renderer,
             &(struct renderer_frame){.job = job, .frame = 0, .pixels = pixels, .pixel_count = count, .image = image},
             &result, &error);
    if (!ok) fail_msg("%s", error.message);
    return result;
}

static void assert_same(const struct image *frame, const struct image *list, const struct pixel *pixels, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        size_t at = (size_t)pixels[i].y * WIDTH_PX + (size_t)pixels[i].x;

        assert_memory_equal(&list->rgba[4 * i], &frame->rgba[4 * at], 4 * sizeof(float));
        assert_memory_equal(&list->transmittance[4 * i], &frame->transmittance[4 * at], 4 * sizeof(float));
        assert_memory_equal(&list->depth[i], &frame->depth[at], sizeof(float));
        assert_memory_equal(&list->cut[i], &frame->cut[at], sizeof(float));
    }
}

// The cut throughputs of single pixels are those of the frame.
static void assert_cuts(const struct image *frame, const struct ray_counts *counts)
{
    double sum = 0.0;

    for (int i = 0; i < PIXELS; i++)
        sum += frame->cut[i];
    assert_near(sum / PIXELS, counts->cut_throughput, 1e-6);
    if (!counts->is_known) return;
    assert_true(counts->most_cut.value > 0.0);
    assert_near(frame->cut[counts->most_cut.y_px * WIDTH_PX + counts->most_cut.x_px], counts->most_cut.value, 1e-6);
}

static void assert_lists_are_like_frames(struct renderer *renderer, const struct job *job)
{
    static const size_t counts[] = {1, 7, 333, 5000, LONGEST};
    struct pixel *pixels = xcalloc(LONGEST, sizeof *pixels);
    struct image frame, list;
    struct renderer_result whole = render(renderer, job, NULL, 0, &frame), all;

    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        draw_list(pixels, counts[i], (uint32_t)i);
        (void)render(renderer, job, pixels, counts[i], &list);
        assert_same(&frame, &list, pixels, counts[i]);
        image_finish(&list);
    }
    list_all(pixels);
    all = render(renderer, job, pixels, PIXELS, &list);
    assert_same(&frame, &list, pixels, PIXELS);
    assert_cuts(&frame, &whole.ray_counts);
    assert_int_equal(all.ray_counts.is_known, whole.ray_counts.is_known);
    assert_true(abs((int)(1e6 * (all.ray_counts.rays - whole.ray_counts.rays))) <= 1);
    assert_int_equal(all.ray_counts.most_cut.x_px, whole.ray_counts.most_cut.x_px);
    assert_int_equal(all.ray_counts.most_cut.y_px, whole.ray_counts.most_cut.y_px);
    image_finish(&list);
    image_finish(&frame);
    free(pixels);
}

static void a_list_has_the_values_of_the_frame(void **state)
{
    static const struct {
        const char *job;
        struct job_quality quality;
    } variants[] = {
        {"cloud", {.method = JOB_METHOD_MIDPOINT, .step = 0.02, .light_step = 0.05, .samples = 1}},
        {"cloud", {.method = JOB_METHOD_JITTERED, .step = 0.02, .light_step = 0.05, .samples = 3}},
        {"cloud", {.method = JOB_METHOD_CACHED, .step = 0.02, .light_grid = 16, .samples = 1}},
        {"cloud", {.method = JOB_METHOD_TRACKING, .samples = 2}},
        {"noise", {.method = JOB_METHOD_GAUSS, .order = 2, .step = 0.1, .light_step = 0.2, .samples = 1}},
        {"glass",
         {.method = JOB_METHOD_EQUIANGULAR,
          .points = 4,
          .samples = 2,
          .max_depth = 8,
          .min_throughput = 0.01,
          .max_cut = 1.0}},
        {"scan", {.method = JOB_METHOD_MIDPOINT, .step_voxels = 2, .samples = 1}},
    };
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());

    (void)state;
    for (size_t i = 0; i < sizeof variants / sizeof *variants; i++) {
        struct job job;

        example_job_load(&job, variants[i].job);
        example_job_shrink(&job, WIDTH_PX, HEIGHT_PX, 2.0);
        job.output.has_depth = job.output.has_transmittance = true;
        job.quality = variants[i].quality;
        assert_lists_are_like_frames(stage.renderer, &job);
        job_finish(&job);
    }
    gl_stage_close(stage);
}

// The frame after a list is still a copy of the frame before it.
static void a_list_leaves_the_frame_alone(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    struct pixel pixels[50];
    struct image first, list, second;
    struct job job;

    (void)state;
    example_job_load(&job, "cloud");
    example_job_shrink(&job, WIDTH_PX, HEIGHT_PX, 2.0);
    job.quality = (struct job_quality){.method = JOB_METHOD_MIDPOINT, .step = 0.05, .light_step = 0.1, .samples = 1};
    draw_list(pixels, 50, 9);
    assert_false(render(stage.renderer, &job, NULL, 0, &first).is_copy);
    assert_false(render(stage.renderer, &job, pixels, 50, &list).is_copy);
    assert_true(render(stage.renderer, &job, NULL, 0, &second).is_copy);
    assert_memory_equal(first.rgba, second.rgba, 4 * PIXELS * sizeof(float));
    image_finish(&first);
    image_finish(&list);
    image_finish(&second);
    job_finish(&job);
    gl_stage_close(stage);
}

// Shadow rays of a million iterations are cut, in the pixels that show the ball.
static void a_cut_march_is_found_in_a_list(void **state)
{
    struct gl_stage stage = gl_stage_open(GL_BACKEND_AUTO, NULL);
    const struct pixel middle = {8, 8}, corner = {0, 0};
    const struct pixel both[] = {corner, middle};
    struct error error = {{0}};
    struct renderer_result result;
    struct image image;
    struct job job;

    (void)state;
    ball_job_parse(&job, BALL_JOB_SIGMA_S_1, BALL_JOB_POINT_LIGHT ", " BALL_JOB_MIDPOINT);
    job.width_px = job.height_px = 17;
    job.quality.light_step = 1e-6;
    (void)render(stage.renderer, &job, &corner, 1, &image);
    image_finish(&image);
    assert_true(image_init(&image, 2, 1, false, false, NULL));
    assert_false(renderer_render(
        stage.renderer,
        &(struct renderer_frame){.job = &job, .frame = 0, .pixels = both, .pixel_count = 2, .image = &image}, &result,
        &error));
    assert_int_equal(result.fault, RENDERER_FAULT_ENDLESS);
    assert_non_null(strstr(error.message, "pixel (8, 8) needs more iterations"));
    image_finish(&image);
    job_finish(&job);
    gl_stage_close(stage);
}

enum { THREAD_LIMIT = 256 };

// The processor time of each thread of this process, s. Returns their number.
static int read_threads(int threads[static THREAD_LIMIT], double seconds[static THREAD_LIMIT])
{
    DIR *folder = opendir("/proc/self/task");
    struct dirent *entry;
    int count = 0;

    assert_non_null(folder);
    while ((entry = readdir(folder)) && count < THREAD_LIMIT) {
        char path[64], text[64] = "";
        FILE *file;

        if (entry->d_name[0] == '.') continue;
        snprintf(path, sizeof path, "/proc/self/task/%.20s/schedstat", entry->d_name);
        file = fopen(path, "r");
        if (!file) continue;
        if (!fgets(text, sizeof text, file)) text[0] = 0;
        fclose(file);
        threads[count] = (int)strtol(entry->d_name, NULL, 10);
        seconds[count++] = 1e-9 * strtod(text, NULL);
    }
    closedir(folder);
    return count;
}

// Software GL's threads: a list far shorter than a frame gives work to more than one.
static void a_short_list_is_for_several_threads(void **state)
{
    int threads[2][THREAD_LIMIT], counts[2], busy = 0;
    double seconds[2][THREAD_LIMIT], sum = 0.0, most = 0.0;
    struct gl_stage stage;
    struct pixel pixels[1000];
    struct image list;
    struct job job;

    (void)state;
    if (sysconf(_SC_NPROCESSORS_ONLN) < 2) {
        print_message("skipped: there is one processor\n");
        skip();
    }
    stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    example_job_load(&job, "cloud");
    example_job_shrink(&job, 640, 360, 2.0);
    job.quality = (struct job_quality){.method = JOB_METHOD_MIDPOINT, .step = 0.002, .light_step = 0.02, .samples = 1};
    for (int i = 0; i < 1000; i++)
        pixels[i] = (struct pixel){220 + 5 * (i % 40), 110 + 5 * (i / 40)};
    for (int i = 0; i < 2; i++) {
        (void)render(stage.renderer, &job, pixels, 1000, &list); // the first links
        image_finish(&list);
        counts[i] = read_threads(threads[i], seconds[i]);
    }
    for (int i = 0; i < counts[1]; i++) {
        double spent = seconds[1][i];

        for (int k = 0; k < counts[0]; k++)
            if (threads[0][k] == threads[1][i]) spent -= seconds[0][k];
        sum += spent;
        most = spent > most ? spent : most;
        busy += spent > 0.0;
    }
    print_message("%d threads, %.3f s, of one %.3f s\n", busy, sum, most);
    assert_true(sum > 0.05); // else nothing is known
    assert_true(most < 0.9 * sum);
    job_finish(&job);
    gl_stage_close(stage);
}

static int link_count;

static void count_links(enum log_level level, const struct log_subject *subject, const char *line)
{
    (void)level;
    (void)subject;
    link_count += strstr(line, " linked in ") != NULL;
}

// Linking takes as long as a small picture: a plan, a chart or a user who tries numbers must not pay it each time.
static void ten_settings_link_one_program(void **state)
{
    // `programs` are linked for the first setting: a light's grid is filled by two of its own, and so is that of a
    // density, unless a method before has linked them.
    static const struct {
        const char *job;
        int programs;
        struct job_quality quality;
    } methods[] = {
        {"cloud", 1, {.method = JOB_METHOD_RIEMANN, .step = 0.4, .light_steps = 4, .samples = 1}},
        {"cloud",
         1,
         {.method = JOB_METHOD_MIDPOINT, .step = 0.4, .light_step = 0.4, .min_transmittance = 0.01, .samples = 1}},
        {"cloud", 1, {.method = JOB_METHOD_ADAPTIVE, .step = 0.4, .light_step = 0.4, .depth_step = 2.0, .samples = 1}},
        {"cloud", 1, {.method = JOB_METHOD_GAUSS, .order = 3, .step = 0.4, .light_step = 0.4, .samples = 1}},
        {"cloud", 3, {.method = JOB_METHOD_CACHED, .step = 0.4, .light_grid = 4, .samples = 1}},
        {"custom", 5, {.method = JOB_METHOD_CACHED, .step = 0.4, .light_grid = 4, .density_grid = 9, .samples = 1}},
        {"noise", 4, {.method = JOB_METHOD_CACHED, .step = 0.4, .light_grid = 4, .density_grid = 40, .samples = 1}},
    };
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());

    (void)state;
    log_set_level(LOG_DEBUG);
    log_set_sink(count_links);
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        int first = 0;
        struct job job;

        example_job_load(&job, methods[i].job);
        example_job_shrink(&job, WIDTH_PX, HEIGHT_PX, 2.0);
        link_count = 0;
        job.quality = methods[i].quality;
        for (int k = 0; k < 10; k++) {
            struct pixel pixels[16];
            struct image image;

            draw_list(pixels, 16, (uint32_t)k);
            (void)render(stage.renderer, &job, k % 2 ? pixels : NULL, 16, &image);
            image_finish(&image);
            job.quality.step *= 0.8;
            job.quality.light_step *= 0.9;
            job.quality.depth_step *= 0.9;
            job.quality.light_steps += 3;
            job.quality.light_grid += job.quality.light_grid > 0 ? 2 : 0;
            job.quality.density_grid += job.quality.density_grid > 0 ? 1 : 0;
            job.quality.min_transmittance *= 0.7;
            if (k == 0) first = link_count;
        }
        assert_int_equal(first, methods[i].programs);
        assert_int_equal(link_count, first);
        job_finish(&job);
    }
    log_set_sink(NULL);
    log_set_level(LOG_INFO);
    gl_stage_close(stage);
}

int main(int argument_count, char **arguments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_list_has_the_values_of_the_frame), cmocka_unit_test(a_list_leaves_the_frame_alone),
        cmocka_unit_test(a_cut_march_is_found_in_a_list),     cmocka_unit_test(a_short_list_is_for_several_threads),
        cmocka_unit_test(ten_settings_link_one_program),
    };

    if (argument_count > 1) cmocka_set_test_filter(arguments[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
