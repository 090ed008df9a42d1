// SPDX-License-Identifier: Apache-2.0
#include "tests/support/stability_sparse.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job_json.h"
#include "tests/support/png_maker.h"
#include "tests/support/shader_dir.h"
#include "tests/support/stability.h"
#include "tests/support/temp_folder.h"
#include "worker/picture/image.h"
#include "worker/plan/tolerance.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The camera is 4 m in front of the origin, where a pixel is this large. No side is a multiple of a stride.
#define PIXEL_M 0.02
#define WIDTH 250
#define HEIGHT 140
#define FOV_DEG "38.580247" // 2 atan(HEIGHT PIXEL_M / 2 / 4)

// Members of a scene's job. The quality is fine enough to stand for the truth.
struct setup {
    char *scene, *lights, *quality; // owned; lights NULL: none
    double camera, light;           // how far these move from frame 0 to 1, m
};

static bool is_slug(const struct stability_sweep *sweep, const char *slug)
{
    return strcmp(sweep->slug, slug) == 0;
}

// A soft line of light through haze, so wide to where its density is 1/e, and as bright whatever it is.
static void set_filament(struct setup *setup, double width_px)
{
    double radius = 0.5 * width_px * PIXEL_M;

    setup->scene =
        xasprintf("\"media\":[{\"sigma_a\":0.05,\"emission\":1,\"density\":{\"kind\":\"glsl\",\"source\":\"float "
                  "density(vec3 p, float t) { vec2 away = vec2(0.38942 * (p.x - 0.07) - 0.92106 * (p.y - 0.03), p.z); "
                  "return 0.05 + %.9g * exp(-dot(away, away) / %.9g); }\",\"bounds\":{\"kind\":\"sphere\",\"radius\":"
                  "1.2,\"falloff\":0.3}}}]",
                  0.56 / radius, radius * radius);
    setup->quality = xasprintf("\"method\":\"midpoint\",\"step\":%.9g", 0.5 * radius);
}

// A voxel in the middle of a grid of 80 px, on pixel (122, 70): far from every fourth of every fourth row.
static void set_speck(struct setup *setup, double width_px, const char *folder)
{
    int side = (int)lround(80 / width_px) | 1, count = side * side * side;
    double voxel = width_px * PIXEL_M;
    char *path = xasprintf("%s/speck.nrrd", folder);
    FILE *out = fopen(path, "wb");

    if (!out) abort();
    fprintf(out,
            "NRRD0004\ntype: uint8\ndimension: 3\nsizes: %d %d %d\nspacings: %.17g %.17g %.17g\nunits: \"m\" \"m\" "
            "\"m\"\nendian: little\nencoding: raw\n\n",
            side, side, side, voxel, voxel, voxel);
    for (int i = 0; i < count; i++)
        fputc(i == count / 2 ? 100 : 0, out);
    fclose(out);
    setup->scene = xasprintf("\"media\":[{\"sigma_a\":0.0001,\"emission\":%.9g,\"density\":{\"kind\":\"grid\",\"file\":"
                             "\"%s\",\"center\":[%.9g,%.9g,0]}}]",
                             0.01 / voxel, path, (122 - 124.5) * PIXEL_M, (69.5 - 70) * PIXEL_M);
    setup->quality = xasprintf("\"method\":\"midpoint\",\"step_voxels\":0.25");
    free(path);
}

// A ball beside the camera in a mirror, which shows it so large.
static void set_glint(struct setup *setup, double width_px)
{
    setup->scene = xasprintf(
        "\"objects\":[{\"kind\":\"sphere\",\"center\":[0,0,0],\"radius\":1,\"material\":{\"kind\":\"mirror\"}},"
        "{\"kind\":\"sphere\",\"center\":[2,1.5,7],\"radius\":%.9g,\"material\":{\"kind\":\"diffuse\","
        "\"albedo\":1}}]",
        0.13 * width_px);
    setup->lights = xasprintf("{\"kind\":\"point\",\"falloff\":\"none\",\"position\":[0,4,2],\"intensity\":15}");
    setup->quality = xasprintf("\"method\":\"equiangular\",\"points\":1");
}

// Black and white squares of half the period.
static void set_checker(struct setup *setup, double period_px, const char *folder)
{
    static const unsigned char squares[] = {255, 255, 255, 0, 0, 0, 0, 0, 0, 255, 255, 255};
    char *path = xasprintf("%s/checker.png", folder);

    png_maker_write_rgb(path, 2, 2, squares);
    setup->scene = xasprintf("\"objects\":[{\"kind\":\"plane\",\"point\":[0,0,0],\"normal\":[0,0,1],\"material\":{"
                             "\"kind\":\"diffuse\",\"albedo\":1,\"texture\":{\"file\":\"%s\",\"size\":%.9g,\"filter\":"
                             "\"nearest\"}}}]",
                             path, period_px * PIXEL_M);
    setup->lights = xasprintf("{\"kind\":\"sun\",\"direction\":[0,0,-1],\"intensity\":3}");
    setup->quality = xasprintf("\"method\":\"equiangular\",\"points\":1");
    free(path);
}

static void set_cloud(struct setup *setup)
{
    setup->scene =
        xasprintf("\"media\":[{\"sigma_s\":4,\"density\":{\"kind\":\"noise\",\"frequency\":2,\"octaves\":3,"
                  "\"lacunarity\":2,\"H\":0.6,\"mode\":\"clip\",\"bounds\":{\"kind\":\"sphere\",\"radius\":1.2,"
                  "\"falloff\":0.3}}}]");
    setup->lights = xasprintf("{\"kind\":\"point\",\"falloff\":\"none\",\"intensity\":10,\"position\":{\"keys\":[[0,[2,"
                              "1.5,2]],[1,[%.9g,1.5,2]]]}}",
                              2 + setup->light);
    setup->quality = xasprintf("\"method\":\"midpoint\",\"step\":0.04,\"light_step\":0.08");
}

static struct setup setup_of(const struct stability_sweep *sweep, double value, const char *folder)
{
    struct setup setup = {
        .camera = sweep->is_change ? 0 : 0.3 * PIXEL_M}; // plans of a scene in which nothing moves trace all

    if (is_slug(sweep, "filament")) set_filament(&setup, value);
    if (is_slug(sweep, "speck")) set_speck(&setup, value, folder);
    if (is_slug(sweep, "glint")) set_glint(&setup, value);
    if (is_slug(sweep, "checker")) set_checker(&setup, value, folder);
    if (is_slug(sweep, "blink")) setup.light = value;
    if (is_slug(sweep, "pan")) setup.camera = value * PIXEL_M;
    if (sweep->is_change) set_cloud(&setup);
    return setup;
}

static void finish(struct setup *setup)
{
    free(setup->scene);
    free(setup->lights);
    free(setup->quality);
}

// A frame before anything has moved, and one after it.
static bool parse(struct job *job, const struct setup *setup, const char *quality, struct error *error)
{
    char *text = xasprintf(
        "{\"version\":1,\"name\":\"sparse\",\"frames\":\"0-1\",\"fps\":1,\"resolution\":[%d,%d],\"background\":0.1,"
        "\"camera\":{\"position\":{\"keys\":[[0,[%.9g,0,4]],[1,[0,0,4]]]},\"target\":{\"keys\":[[0,[%.9g,0,0]],[1,[0,0,"
        "0]]]},\"fov\":" FOV_DEG
        "},\"lights\":[%s],\"scene\":{%s},\"quality\":{%s},\"output\":{\"path\":\"a.####.exr\","
        "\"pixel\":\"float\"}}",
        WIDTH, HEIGHT, -setup->camera, -setup->camera, setup->lights ? setup->lights : "", setup->scene, quality);
    bool ok = job_parse(job, text, strlen(text), NULL, error);

    free(text);
    return ok;
}

// A scene's jobs, which plans refer to from frame to frame, and what renders them.
struct bench {
    struct renderer *renderer;
    struct tolerance *tolerance;
    const struct stability_method *method;
    struct job full, seen; // every pixel by the stated settings; by the method
    int64_t serial;
};

static bool open_jobs(struct bench *bench, const struct setup *setup, struct error *error)
{
    bool is_planned = bench->method->tolerance > 0;

    bench->serial++;
    if (!parse(&bench->full, setup, setup->quality, error) ||
        !parse(&bench->seen, setup, is_planned ? bench->method->quality : setup->quality, error))
        return false;
    bench->seen.quality.pixels = bench->method->pixels;
    return true;
}

static void close_jobs(struct bench *bench)
{
    job_finish(&bench->full);
    job_finish(&bench->seen);
}

static bool render_full(struct bench *bench, int32_t frame, struct image *image, struct error *error)
{
    struct renderer_result result;

    return renderer_render(
        bench->renderer, &(struct renderer_frame){.job = &bench->full, .frame = frame, .image = image}, &result, error);
}

static bool render_seen(struct bench *bench, int32_t frame, struct image *image, struct error *error)
{
    struct renderer_result result;
    struct tolerance_result kept;

    if (bench->method->tolerance > 0)
        return tolerance_render(
            bench->tolerance,
            &(struct tolerance_params){.job = &bench->seen, .serial = bench->serial, .frame = frame, .image = image},
            &kept, error);
    return renderer_render(
        bench->renderer, &(struct renderer_frame){.job = &bench->seen, .frame = frame, .image = image}, &result, error);
}

// Seen and known, of the frame before a change and of the last.
struct frames {
    struct image seen[2], known[2];
};

static void compare(const struct frames *frames, bool is_change, struct stability_point *point)
{
    double apart = 0.0, light = 0.0, gain = 0.0, total = 0.0;

    for (size_t i = 0; i < (size_t)4 * WIDTH * HEIGHT; i++) {
        double known = (double)frames->known[1].rgba[i], off = (double)frames->seen[1].rgba[i] - known;

        if (i % 4 == 3) continue;
        gain += off;
        total += known;
        if (is_change) off -= (double)frames->seen[0].rgba[i] - (double)frames->known[0].rgba[i];
        apart += off * off;
        light += known * known;
    }
    point->error = sqrt(apart / light);
    point->gain = gain / total;
    point->is_finite = image_is_finite(&frames->seen[1], false, NULL);
    point->fits_half = image_is_finite(&frames->seen[1], true, NULL);
}

// False where the stated settings themselves fail.
static bool measure(struct bench *bench, const struct setup *setup, bool is_change, struct stability_point *point)
{
    struct frames frames = {0};
    struct error error = {{0}};
    bool ok = open_jobs(bench, setup, &error);

    for (int32_t frame = is_change ? 0 : 1; ok && frame < 2; frame++) {
        ok = image_init(&frames.seen[frame], WIDTH, HEIGHT, false, false, &error) &&
             image_init(&frames.known[frame], WIDTH, HEIGHT, false, false, &error) &&
             render_full(bench, frame, &frames.known[frame], &error);
        if (!ok || point->is_refused || render_seen(bench, frame, &frames.seen[frame], &error)) continue;
        point->is_refused = true;
        snprintf(point->reason, sizeof point->reason, "%.*s", (int)sizeof point->reason - 1, error.message);
    }
    if (!ok) printf("%s\n", error.message);
    if (ok && !point->is_refused) compare(&frames, is_change, point);
    for (int i = 0; i < 2; i++) {
        image_finish(&frames.seen[i]);
        image_finish(&frames.known[i]);
    }
    close_jobs(bench);
    return ok;
}

bool stability_sparse_measure(struct gl_context *context, const struct stability_sweep *sweep,
                              const struct stability_method *method, struct stability_point *points)
{
    struct bench bench = {.method = method, .renderer = renderer_create(context, test_shader_dir())};
    void *folder = NULL;
    bool ok = true;

    if (temp_folder_create(&folder) != 0) abort();
    bench.tolerance = tolerance_create(bench.renderer);
    for (size_t i = 0; ok && i < sweep->count; i++) {
        struct setup setup = setup_of(sweep, sweep->values[i], folder);

        points[i] = (struct stability_point){0};
        ok = measure(&bench, &setup, sweep->is_change, &points[i]);
        finish(&setup);
    }
    tolerance_destroy(bench.tolerance);
    renderer_destroy(bench.renderer);
    return temp_folder_destroy(&folder) == 0 && ok;
}
