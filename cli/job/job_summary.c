// SPDX-License-Identifier: Apache-2.0
#include "cli/job/job_summary.h"

#include "core/base/alloc.h"
#include "core/job/job.h"
#include "core/json/json_write.h"
#include "core/scene/density_rules.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static char *format_file(const struct job *job, int64_t index)
{
    char name[OUTPUT_NAME_SIZE];
    const char *folder = job->output.path.folder;

    output_path_format_name(&job->output.path, frame_range_at(&job->frames, index), name);
    return xasprintf("%s%s%s%s", job->output.path_is_absolute ? "/" : "", folder, *folder ? "/" : "", name);
}

static const char *plural(size_t count)
{
    return count == 1 ? "" : "s";
}

// Those of the job.
static size_t count_media(const struct scene *scene)
{
    return scene->has_vacuum ? 0 : scene->medium_count;
}

static void print_media(const struct scene *scene)
{
    size_t count = count_media(scene);

    printf("%-10s %zu medi%s", "scene", count, count == 1 ? "um" : "a");
    for (size_t i = 0; i < count; i++)
        printf("%s%s", i == 0 ? " (" : ", ", density_rules_of(&scene->media[i].density)->name);
    printf("%s", count > 0 ? ")" : "");
    if (scene->object_count > 0) printf(", %zu object%s", scene->object_count, plural(scene->object_count));
    printf(", %zu light%s%s%s\n", scene->light_count, plural(scene->light_count),
           scene->has_background ? ", a background" : "",
           scene_is_constant(scene) ? "; nothing moves: rendered once" : "");
}

static void print_input(const char *file, const char *what, size_t index)
{
    if (file) printf("%-10s %s (%s %zu)\n", "reads", file, what, index);
}

// The files that media, textures and lights read.
static void print_inputs(const struct scene *scene)
{
    for (size_t i = 0; i < scene->medium_count; i++) {
        const struct scene_density *density = &scene->media[i].density;
        const char *file = density->kind == SCENE_DENSITY_GRID   ? density->grid.file
                           : density->kind == SCENE_DENSITY_GLSL ? density->glsl.file
                                                                 : NULL;
        size_t owner = scene->media[i].owner;

        print_input(file, owner > 0 ? "interior of object" : "medium", owner > 0 ? owner - 1 : i);
    }
    for (size_t i = 0; i < scene->object_count; i++)
        print_input(scene->objects[i].material.texture.file, "texture of object", i);
    for (size_t i = 0; i < scene->light_count; i++)
        print_input(scene->lights[i].dome.image.file, "light", i);
}

static void print_orders(int orders)
{
    if (orders == SCENE_ORDERS_ALL)
        printf("%-10s scatters any number of times\n", "light");
    else if (orders > 1)
        printf("%-10s scatters up to %d times\n", "light", orders);
}

static void print_step(const char *name, double metres, double voxels)
{
    if (metres > 0.0) printf(", %s %g m", name, metres);
    if (voxels > 0.0) printf(", %s %g voxels", name, voxels);
}

// The paths above the first order of scattering.
static void print_scattered(const struct job_quality *quality)
{
    const char *what = quality->scatter_from == JOB_SCATTER_FROM_LIGHTS ? "particle" : "path";

    if (quality->scatter_grid > 0)
        printf(", a grid of %d cells for scattered light, %d %s%s a node", quality->scatter_grid, quality->paths, what,
               plural((size_t)quality->paths));
    else if (quality->paths > 0)
        printf(", %d path%s a pixel", quality->paths, plural((size_t)quality->paths));
    if (quality->similar_after > 0)
        printf(", similar media after %d scattering%s", quality->similar_after, plural((size_t)quality->similar_after));
}

static void print_quality(const struct job *job)
{
    const struct job_quality *quality = &job->quality;

    if (quality->method == JOB_METHOD_AUTO)
        printf("%-10s tolerance %g", "quality", quality->tolerance);
    else
        printf("%-10s %s", "quality", job_method_name(quality->method));
    print_step("step", quality->step, quality->step_voxels);
    print_step("light step", quality->light_step, quality->light_step_voxels);
    if (quality->light_steps > 0)
        printf(", %d light step%s", quality->light_steps, plural((size_t)quality->light_steps));
    if (quality->points > 0) printf(", %d point%s", quality->points, plural((size_t)quality->points));
    print_scattered(quality);
    if (quality->light_grid > 0) printf(", a grid of %d cells for each light", quality->light_grid);
    if (quality->samples > 1) printf(", %d samples a pixel", quality->samples);
    if (job->scene.object_count > 0) printf(", rays up to depth %d", quality->max_depth);
    printf("\n");
}

void job_summary_print(const struct job *job)
{
    int64_t count = frame_range_count(&job->frames);
    char *range = frame_range_format(&job->frames);
    char *first = format_file(job, 0), *last = format_file(job, count - 1);

    printf("%-10s %s\n", "name", job->name);
    printf("%-10s %" PRId64 ": %s\n", "frames", count, range);
    printf("%-10s %d x %d\n", "resolution", job->width_px, job->height_px);
    print_media(&job->scene);
    print_inputs(&job->scene);
    print_orders(job->scene.orders);
    print_quality(job);
    printf("%-10s %s, %s%s%s\n", "channels", job->output.pixel == JOB_PIXEL_HALF ? "half RGBA" : "float RGBA",
           job_compression_name(job->output.compression), job->output.has_depth ? ", Z" : "",
           job->output.has_transmittance ? ", transmittance" : "");
    printf("%-10s %s%s%s\n", "files", first, count > 1 ? " to " : "", count > 1 ? last : "");
    free(range);
    free(first);
    free(last);
}

void job_summary_write_members(const struct job *job, struct json_writer *writer)
{
    int64_t count = frame_range_count(&job->frames);
    char *range = frame_range_format(&job->frames);
    char *first = format_file(job, 0), *last = format_file(job, count - 1);
    char orders[SCENE_ORDERS_SIZE];

    json_write_string_member(writer, "name", job->name);
    json_write_integer_member(writer, "frames", count);
    json_write_string_member(writer, "range", range);
    json_write_key(writer, "resolution");
    json_write_begin_array(writer);
    json_write_integer(writer, job->width_px);
    json_write_integer(writer, job->height_px);
    json_write_end_array(writer);
    json_write_integer_member(writer, "media", (int64_t)count_media(&job->scene));
    json_write_integer_member(writer, "objects", (int64_t)job->scene.object_count);
    json_write_integer_member(writer, "lights", (int64_t)job->scene.light_count);
    if (job->scene.orders > 1) {
        scene_format_orders(job->scene.orders, orders);
        json_write_string_member(writer, "orders", orders);
    }
    json_write_bool_member(writer, "moves", !scene_is_constant(&job->scene));
    json_write_string_member(writer, "method", job_method_name(job->quality.method));
    if (job->quality.tolerance > 0.0) json_write_number_member(writer, "tolerance", job->quality.tolerance);
    if (job->quality.step > 0.0) json_write_number_member(writer, "step", job->quality.step);
    if (job->quality.step_voxels > 0.0) json_write_number_member(writer, "step_voxels", job->quality.step_voxels);
    if (job->quality.light_grid > 0) json_write_integer_member(writer, "light_grid", job->quality.light_grid);
    if (job->quality.scatter_grid > 0) json_write_integer_member(writer, "scatter_grid", job->quality.scatter_grid);
    if (job->quality.paths > 0) json_write_integer_member(writer, "paths", job->quality.paths);
    json_write_integer_member(writer, "samples", job->quality.samples);
    json_write_string_member(writer, "first_file", first);
    json_write_string_member(writer, "last_file", last);
    json_write_string_member(writer, "hash", job->hash);
    free(range);
    free(first);
    free(last);
}
