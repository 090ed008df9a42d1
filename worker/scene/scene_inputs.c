// SPDX-License-Identifier: Apache-2.0
#include "worker/scene/scene_inputs.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/scene/input_path.h"
#include "worker/sparse/brick_atlas.h"
#include "worker/volume/volume_layout.h"
#include "worker/volume/volume_stream.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void scene_files_init(struct scene_files *files)
{
    *files = (struct scene_files){.hashes = file_hashes_create(), .bricks = brick_store_create()};
}

void scene_files_finish(struct scene_files *files)
{
    file_hashes_destroy(files->hashes);
    brick_store_destroy(files->bricks);
    *files = (struct scene_files){0};
}

static struct volume_source source_of(const struct scene_input *input)
{
    struct volume_source source = {.path = input->path, .raw = input->source->raw};

    memcpy(source.spacing, input->source->spacing, sizeof source.spacing);
    return source;
}

bool scene_input_open_volume(const struct scene_input *input, struct volume **volume, struct error *error)
{
    struct volume_source source = source_of(input);

    return volume_open(volume, &source, error);
}

static void add_file(struct scene_input *input, const char *path)
{
    for (size_t i = 0; i < input->file_count; ++i)
        if (strcmp(input->files[i].path, path) == 0) return;
    input->files[input->file_count++].path = xstrdup(path);
}

static struct brick_source brick_source_of(const struct scene_medium *medium, const char *path)
{
    const struct scene_grid *grid = &medium->density.grid;

    return (struct brick_source){path, grid->grid_name, medium->blackbody.grid_name, grid->points, grid->point_count};
}

static void describe_bricks(struct scene_input *input)
{
    const struct brick_atlas *atlas = input->bricks->atlas;
    double *matrix = input->header.index_to_world;

    memcpy(matrix, atlas->index_to_world, sizeof input->header.index_to_world);
    for (int axis = 0; axis < 3; ++axis) {
        double edge = hypot(hypot(matrix[axis], matrix[4 + axis]), matrix[8 + axis]);
        double wanted = input->source->spacing[axis];

        input->header.size[axis] = atlas->voxel_max[axis] - atlas->voxel_min[axis] + 2;
        for (int row = 0; wanted > 0 && row < 3; ++row)
            matrix[4 * row + axis] *= wanted / edge;
    }
}

// The position of bricks in the world is stored in the tree, which is read as a whole.
static bool read_bricks(struct scene_input *input, const struct scene_medium *medium, struct brick_store *store,
                        struct error *error)
{
    struct brick_source source = brick_source_of(medium, input->path);

    input->bricks = store ? brick_store_take(store, &source, error) : brick_volume_load(&source, error);
    if (!input->bricks) return false;
    describe_bricks(input);
    add_file(input, input->path);
    input->files[0].version = input->bricks->version;
    return true;
}

static bool describe(struct scene_input *input, const struct scene_medium *medium, int32_t frame,
                     struct brick_store *store, struct error *error)
{
    const struct scene_density *density = &medium->density;
    struct volume *volume;

    input->source = &density->grid;
    input->is_sequence = scene_density_is_sequence(density);
    input->path = input_path_format(density->grid.file, frame);
    if (scene_grid_is_sparse(&density->grid)) return read_bricks(input, medium, store, error);
    if (!scene_input_open_volume(input, &volume, error)) return false;
    input->header = *volume;
    input->header.layout = NULL;
    add_file(input, input->path);
    add_file(input, volume_stream_path(volume->layout->stream));
    volume_close(volume);
    return true;
}

// The hash depends on how the bytes are read: a file can hold several grids, and one raw file can be several volumes.
static void hash_bricks(struct scene_input *input, const struct scene_medium *medium)
{
    const char *density_name = medium->density.grid.grid_name, *glow_name = medium->blackbody.grid_name;
    const struct scene_grid *grid = &medium->density.grid;
    char points[HASH_TEXT_SIZE], *text;

    hash_bytes(grid->points, grid->point_count * sizeof *grid->points, points);
    text = xasprintf("%s bricks %s\n%s\n%s", input->bricks->hash, density_name ? density_name : "",
                     glow_name ? glow_name : "", points);
    hash_bytes(text, strlen(text), input->hash);
    free(text);
}

static bool hash_contents(struct scene_input *input, const struct scene_medium *medium, struct file_hashes *hashes,
                          struct error *error)
{
    const struct scene_raw *raw = &input->source->raw;
    char hash[SCENE_INPUT_FILE_LIMIT][HASH_TEXT_SIZE] = {{0}};
    char *text;

    if (input->bricks) {
        hash_bricks(input, medium);
        return true;
    }
    for (size_t i = 0; i < input->file_count; ++i)
        if (!file_hashes_find(hashes, input->files[i].path, &input->files[i].version, hash[i], error)) return false;
    text = xasprintf("%s %s raw %d %d %d type %d %d order %d skip %lld grid %s", hash[0], hash[1], raw->size[0],
                     raw->size[1], raw->size[2], raw->has_type, (int)raw->type, raw->is_big_endian,
                     (long long)raw->skip_bytes, input->source->grid_name ? input->source->grid_name : "");
    hash_bytes(text, strlen(text), input->hash);
    free(text);
    return true;
}

bool scene_input_check(const struct scene_input *input, struct error *error)
{
    for (size_t i = 0; i < input->file_count; ++i) {
        struct file_version version;

        if (!file_version_find(input->files[i].path, &version, error)) return false;
        if (file_version_is_same(&version, &input->files[i].version)) continue;
        error_set(error, "%s: it changed while the frame was made", input->files[i].path);
        return false;
    }
    return true;
}

void scene_input_find_matrix(const struct scene_input *input, double time, double index_to_world[static 12])
{
    const struct volume *header = &input->header;
    double center[9] = {0};

    memcpy(index_to_world, header->index_to_world, sizeof header->index_to_world);
    if (!input->source->has_center) return;
    timeline_evaluate(&input->source->center, time, center);
    for (int row = 0; row < 3; ++row) {
        double *to = &index_to_world[4 * row];

        if (input->bricks) { // the box changes with the active voxels, so its centre is no reference
            to[3] += center[row];
            continue;
        }
        to[3] = center[row];
        for (int axis = 0; axis < 3; ++axis)
            to[3] -= to[axis] * 0.5 * (header->size[axis] - 1);
    }
}

void scene_input_box(const struct scene_input *input, double time, double low[static 3], double high[static 3])
{
    double matrix[12], middle[3], half[3];

    scene_input_find_matrix(input, time, matrix);
    for (int axis = 0; axis < 3; ++axis) {
        const int *first = input->bricks ? input->bricks->atlas->voxel_min : NULL;
        double begin = first ? first[axis] - 1.0 : -0.5;
        double end = first ? input->bricks->atlas->voxel_max[axis] + 1.0 : input->header.size[axis] - 0.5;

        middle[axis] = 0.5 * (begin + end);
        half[axis] = 0.5 * (end - begin);
    }
    for (int row = 0; row < 3; ++row) {
        const double *from = &matrix[4 * row];
        double half_extent = fabs(from[0]) * half[0] + fabs(from[1]) * half[1] + fabs(from[2]) * half[2];
        double at = from[0] * middle[0] + from[1] * middle[1] + from[2] * middle[2] + from[3];

        low[row] = at - half_extent;
        high[row] = at + half_extent;
    }
}

static double edge_of(const struct volume *header, int axis)
{
    const double *matrix = header->index_to_world;

    return hypot(hypot(matrix[axis], matrix[4 + axis]), matrix[8 + axis]);
}

// Returns at most the longest chord of the box, m; no less than half of it.
static double box_diagonal(const struct volume *header)
{
    double longest = 0;

    for (int corner = 0; corner < 4; ++corner) {
        double square = 0;

        for (int row = 0; row < 3; ++row) {
            double sum = 0;

            for (int axis = 0; axis < 3; ++axis)
                sum += (axis > 0 && (corner >> (axis - 1) & 1) ? -1 : 1) * header->size[axis] *
                       header->index_to_world[4 * row + axis];
            square += sum * sum;
        }
        longest = fmax(longest, sqrt(square));
    }
    return longest;
}

struct march {
    const char *key, *medium;
    double length, step; // m
    int step_limit;
};

static bool check_steps(const struct march *march, struct error *error)
{
    double count = ceil(march->length / march->step - 1e-9);

    if (count <= march->step_limit) return true;
    error_set(error,
              "quality.%s: expected at most %d steps along a ray, got %.10g: %.10g m through %s in steps of %.10g m",
              march->key, march->step_limit, count, march->length, march->medium, march->step);
    return false;
}

double scene_inputs_find_voxel(const struct scene_inputs *inputs)
{
    double shortest = INFINITY;

    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i)
        for (int axis = 0; inputs->media[i].source && axis < 3; ++axis)
            shortest = fmin(shortest, edge_of(&inputs->media[i].header, axis));
    return shortest;
}

// Steps in voxels become metres. Only then is it known how many steps a ray needs.
static bool resolve_quality(struct scene_inputs *inputs, const struct job *job, struct error *error)
{
    const struct scene_camera *camera = &job->scene.camera;
    struct job_quality *quality = &inputs->quality;
    double shortest = scene_inputs_find_voxel(inputs);

    if (quality->step_voxels > 0) quality->step = quality->step_voxels * shortest;
    if (quality->light_step_voxels > 0) quality->light_step = quality->light_step_voxels * shortest;
    if (!job_method_takes_steps(quality->method)) return true;
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i) {
        char place[64];
        double diagonal;

        if (!inputs->media[i].source) continue;
        scene_format_medium_place(&job->scene, i, place, sizeof place);
        diagonal = box_diagonal(&inputs->media[i].header);
        if (quality->step > 0 && !check_steps(&(struct march){quality->step_voxels > 0 ? "step_voxels" : "step", place,
                                                              fmin(diagonal, camera->clip_far - camera->clip_near),
                                                              quality->step, job_find_step_limit(job)},
                                              error))
            return false;
        if (job->scene.light_count > 0 && quality->light_step > 0 &&
            !check_steps(&(struct march){quality->light_step_voxels > 0 ? "light_step_voxels" : "light_step", place,
                                         diagonal, quality->light_step, JOB_MARCH_STEPS_LIMIT},
                         error))
            return false;
    }
    return true;
}

// Hashes that of the files so far together with the next.
static void add_file_hash(struct scene_inputs *inputs, const char next[static HASH_TEXT_SIZE])
{
    char both[2][HASH_TEXT_SIZE];

    memcpy(both[0], inputs->files_hash, sizeof both[0]);
    memcpy(both[1], next, sizeof both[1]);
    hash_bytes(both, sizeof both, inputs->files_hash);
}

static void hash_picture(struct scene_inputs *inputs, const struct job *job)
{
    char media[SCENE_MEDIUM_LIMIT][HASH_TEXT_SIZE] = {{0}}, textures[1 + SCENE_OBJECT_LIMIT][HASH_TEXT_SIZE] = {{0}};
    char both[2][HASH_TEXT_SIZE];
    bool has_media = false, has_textures = false;

    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i) {
        memcpy(media[i], inputs->media[i].hash, sizeof media[i]);
        has_media |= inputs->media[i].source != NULL;
    }
    for (size_t i = 0; i < SCENE_OBJECT_LIMIT; ++i) {
        memcpy(textures[1 + i], inputs->textures[i].hash, sizeof textures[1 + i]);
        has_textures |= inputs->textures[i].source != NULL;
    }
    memcpy(inputs->picture_hash, job->hash, sizeof inputs->picture_hash);
    if (!has_media && !has_textures && !inputs->dome.source) return;
    hash_bytes(media, sizeof media, inputs->files_hash);
    memcpy(textures[0], inputs->files_hash, sizeof textures[0]);
    if (has_textures) hash_bytes(textures, sizeof textures, inputs->files_hash);
    if (inputs->dome.source) add_file_hash(inputs, inputs->dome.hash);
    memcpy(both[0], job->hash, sizeof both[0]);
    memcpy(both[1], inputs->files_hash, sizeof both[1]);
    hash_bytes(both, sizeof both, inputs->picture_hash);
}

// A file that is being written may be complete the next time.
static bool is_lasting_fault(const char *path, bool is_sequence)
{
    struct file_version version;

    if (is_sequence) return false;
    return !file_version_find(path, &version, NULL) || file_version_is_settled(&version);
}

bool scene_inputs_are_lasting(const struct scene_inputs *inputs)
{
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i)
        if (inputs->media[i].source && !is_lasting_fault(inputs->media[i].path, inputs->media[i].is_sequence))
            return false;
    for (size_t i = 0; i < SCENE_OBJECT_LIMIT; ++i)
        if (inputs->textures[i].source && !is_lasting_fault(inputs->textures[i].source->file, false)) return false;
    return !inputs->dome.source || is_lasting_fault(inputs->dome.source->file, false);
}

static bool open_medium(struct scene_inputs *inputs, const struct job *job, size_t medium, int32_t frame,
                        const struct scene_files *files, bool *is_lasting, struct error *error)
{
    const struct scene_medium *source = &job->scene.media[medium];
    struct scene_input *input = &inputs->media[medium];
    char place[64];

    if (source->density.kind != SCENE_DENSITY_GRID) return true;
    if (describe(input, source, frame, inputs->bricks, error) &&
        (!files || hash_contents(input, source, files->hashes, error)))
        return true;
    scene_format_medium_place(&job->scene, medium, place, sizeof place);
    error_prefix(error, "%s.density.file", place);
    *is_lasting = is_lasting_fault(input->path, input->is_sequence);
    return false;
}

static bool open_texture(struct scene_inputs *inputs, const struct job *job, size_t object,
                         const struct scene_files *files, bool *is_lasting, struct error *error)
{
    const struct scene_texture *texture = &job->scene.objects[object].material.texture;

    if (!texture->file) return true;
    if (texture_input_open(&inputs->textures[object], texture, files ? files->hashes : NULL, error)) return true;
    error_prefix(error, "scene.objects[%zu].material.texture.file", object);
    *is_lasting = is_lasting_fault(texture->file, false);
    return false;
}

static bool open_dome(struct scene_inputs *inputs, const struct job *job, size_t light, const struct scene_files *files,
                      bool *is_lasting, struct error *error)
{
    const struct scene_texture *image = &job->scene.lights[light].dome.image;

    if (!image->file) return true;
    if (texture_input_open(&inputs->dome, image, files ? files->hashes : NULL, error)) return true;
    error_prefix(error, "lights[%zu].file", light);
    *is_lasting = is_lasting_fault(image->file, false);
    return false;
}

bool scene_inputs_open(struct scene_inputs *inputs, const struct job *job, int32_t frame,
                       const struct scene_files *files, bool *is_lasting, struct error *error)
{
    bool ignored;

    if (!is_lasting) is_lasting = &ignored;
    *is_lasting = true;
    *inputs = (struct scene_inputs){
        .scene = &job->scene, .frame = frame, .bricks = files ? files->bricks : NULL, .quality = job->quality};
    for (size_t i = 0; i < job->scene.medium_count; ++i)
        if (!open_medium(inputs, job, i, frame, files, is_lasting, error)) goto fail;
    for (size_t i = 0; i < job->scene.object_count; ++i)
        if (!open_texture(inputs, job, i, files, is_lasting, error)) goto fail;
    for (size_t i = 0; i < job->scene.light_count; ++i)
        if (!open_dome(inputs, job, i, files, is_lasting, error)) goto fail;
    if (!resolve_quality(inputs, job, error)) goto fail;
    if (files) hash_picture(inputs, job);
    return true;
fail:
    scene_inputs_finish(inputs);
    return false;
}

void scene_inputs_finish(struct scene_inputs *inputs)
{
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i) {
        brick_store_release(inputs->bricks, inputs->media[i].bricks);
        free(inputs->media[i].path);
        for (size_t k = 0; k < inputs->media[i].file_count; ++k)
            free(inputs->media[i].files[k].path);
    }
    *inputs = (struct scene_inputs){0};
}

void scene_inputs_expect(const struct job *job, int32_t frame, const struct scene_files *files)
{
    for (size_t i = 0; i < job->scene.medium_count; ++i) {
        const struct scene_medium *medium = &job->scene.media[i];
        struct brick_source source;
        char *path;

        if (medium->density.kind != SCENE_DENSITY_GRID || !scene_grid_is_sparse(&medium->density.grid)) continue;
        path = input_path_format(medium->density.grid.file, frame);
        source = brick_source_of(medium, path);
        brick_store_expect(files->bricks, &source);
        free(path);
    }
}
