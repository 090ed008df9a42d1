// SPDX-License-Identifier: Apache-2.0
#include "worker/render/gl_grids.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "worker/density/blackbody.h"
#include "worker/density/transfer_table.h"
#include "worker/gl/gl_functions.h"
#include "worker/render/gl_bricks.h"
#include "worker/scene/scene_inputs.h"
#include "worker/sparse/brick_store.h"
#include "worker/sparse/transfer_function.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { GRID_LIMIT = 2 * SCENE_MEDIUM_LIMIT, UNITS_PER_MEDIUM = 4 };

// Of grids that the frame does not need but a next one may: another job's, say.
static const size_t idle_bytes_limit = (size_t)1 << 30;

struct kept_grid {
    char hash[HASH_TEXT_SIZE]; // of the input; empty: none
    struct gl_grid grid;
    uint64_t used; // the frame that last needed it
};

struct kept_numbers {
    char hash[HASH_TEXT_SIZE]; // of the input and of what its values mean
    unsigned texture;
};

struct kept_table {
    char hash[HASH_TEXT_SIZE]; // of the transfer function's points; empty: none
    unsigned texture;
};

struct kept_bricks {
    char hash[HASH_TEXT_SIZE]; // of the input; empty: none
    struct gl_bricks bricks;
};

struct gl_grids {
    const struct gl_functions *gl; // borrowed; outlives us
    uint64_t frame_count;
    struct kept_grid grids[GRID_LIMIT];
    struct kept_numbers distances[SCENE_MEDIUM_LIMIT], majorants[SCENE_MEDIUM_LIMIT];
    struct kept_table tables[SCENE_MEDIUM_LIMIT];
    struct kept_bricks bricks[SCENE_MEDIUM_LIMIT];
    unsigned blackbody; // its table; 0: nothing has glowed yet
};

struct gl_grids *gl_grids_create(const struct gl_functions *gl)
{
    struct gl_grids *grids = xcalloc(1, sizeof *grids);

    grids->gl = gl;
    return grids;
}

static void drop(struct kept_grid *kept)
{
    gl_grid_finish(&kept->grid);
    *kept = (struct kept_grid){0};
}

void gl_grids_clear(struct gl_grids *grids)
{
    for (size_t i = 0; i < GRID_LIMIT; ++i)
        drop(&grids->grids[i]);
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i)
        if (grids->distances[i].texture) grids->gl->DeleteTextures(1, &grids->distances[i].texture);
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i)
        if (grids->majorants[i].texture) grids->gl->DeleteTextures(1, &grids->majorants[i].texture);
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i)
        if (grids->tables[i].texture) grids->gl->DeleteTextures(1, &grids->tables[i].texture);
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i)
        gl_bricks_finish(&grids->bricks[i].bricks);
    if (grids->blackbody) grids->gl->DeleteTextures(1, &grids->blackbody);
    memset(grids->distances, 0, sizeof grids->distances);
    memset(grids->majorants, 0, sizeof grids->majorants);
    memset(grids->tables, 0, sizeof grids->tables);
    memset(grids->bricks, 0, sizeof grids->bricks);
    grids->blackbody = 0;
}

void gl_grids_destroy(struct gl_grids *grids)
{
    if (!grids) return;
    gl_grids_clear(grids);
    free(grids);
}

static struct kept_grid *find(struct gl_grids *grids, const char *hash)
{
    for (size_t i = 0; i < GRID_LIMIT; ++i)
        if (grids->grids[i].hash[0] && strcmp(grids->grids[i].hash, hash) == 0) return &grids->grids[i];
    return NULL;
}

// An empty place, after the grids longest unused have gone that are in the way of `size_bytes` more.
static struct kept_grid *make_room(struct gl_grids *grids, size_t size_bytes)
{
    for (;;) {
        struct kept_grid *oldest = NULL, *empty = NULL;
        size_t idle_bytes = size_bytes;

        for (size_t i = 0; i < GRID_LIMIT; ++i) {
            struct kept_grid *kept = &grids->grids[i];

            if (!kept->hash[0]) {
                empty = kept;
                continue;
            }
            if (kept->used == grids->frame_count) continue;
            idle_bytes += kept->grid.size_bytes;
            if (!oldest || kept->used < oldest->used) oldest = kept;
        }
        // Of twice as many places as a frame has media one is empty or idle.
        if (!oldest || (empty && idle_bytes <= idle_bytes_limit)) return empty;
        drop(oldest);
    }
}

static size_t size_of(const struct volume *header)
{
    return (size_t)header->size[0] * (size_t)header->size[1] * (size_t)header->size[2] * volume_type_size(header->type);
}

static struct kept_grid *read_grid(struct gl_grids *grids, const struct scene_input *input,
                                   gl_grid_progress *on_progress, void *user, struct error *error)
{
    struct kept_grid *kept = make_room(grids, size_of(&input->header));
    struct volume *volume;
    bool ok;

    if (!scene_input_open_volume(input, &volume, error)) return NULL;
    ok = gl_grid_init(
        &kept->grid,
        &(struct gl_grid_params){
            .gl = grids->gl, .volume = volume, .path = input->path, .on_progress = on_progress, .user = user},
        error);
    volume_close(volume);
    if (ok && !scene_input_check(input, error)) {
        gl_grid_finish(&kept->grid);
        ok = false;
    }
    if (!ok) return NULL;
    memcpy(kept->hash, input->hash, sizeof kept->hash);
    log_debug("grids: %s read, %zu bytes", input->path, kept->grid.size_bytes);
    return kept;
}

static bool is_empty(double min, double max, const void *user)
{
    const struct scene_grid *grid = user;

    return transfer_function_is_empty(grid->points, grid->point_count, min, max);
}

static void hash_numbers(const struct scene_input *input, char hash[static HASH_TEXT_SIZE])
{
    char hashes[2][HASH_TEXT_SIZE];

    memcpy(hashes[0], input->hash, sizeof hashes[0]);
    hash_bytes(input->source->points, input->source->point_count * sizeof *input->source->points, hashes[1]);
    hash_bytes(hashes, sizeof hashes, hash);
}

static double find_most(double min, double max, const void *user)
{
    const struct scene_grid *grid = user;

    return grid->point_count == 0 ? max : transfer_function_max_opacity(grid->points, grid->point_count, min, max);
}

// A number of each brick: how far it is from one that is not empty, or its majorant.
static bool bind_brick_numbers(struct gl_grids *grids, const struct scene_input *input, const struct gl_grid *grid,
                               bool are_majorants, size_t medium, struct error *error)
{
    struct kept_numbers *kept = are_majorants ? &grids->majorants[medium] : &grids->distances[medium];
    double slope = input->header.slope, intercept = input->header.intercept;
    char hash[HASH_TEXT_SIZE];

    hash_numbers(input, hash);
    if (strcmp(hash, kept->hash) != 0) {
        if (kept->texture) grids->gl->DeleteTextures(1, &kept->texture);
        *kept = (struct kept_numbers){
            .texture = are_majorants ? gl_grid_create_majorants(grid, slope, intercept, find_most, input->source)
                                     : gl_grid_create_distances(grid, slope, intercept, is_empty, input->source)};
        if (!kept->texture) {
            error_set(error, "%s: out of memory", input->path);
            return false;
        }
        memcpy(kept->hash, hash, sizeof kept->hash);
    }
    grids->gl->BindTextureUnit((GLuint)(UNITS_PER_MEDIUM * medium + (are_majorants ? 2 : 1)), kept->texture);
    return true;
}

// A row of RGBA.
static unsigned make_row(const struct gl_functions *gl, int size, float (*table)[4])
{
    unsigned texture;

    gl->CreateTextures(GL_TEXTURE_2D, 1, &texture);
    gl->TextureStorage2D(texture, 1, GL_RGBA32F, size, 1);
    gl->TextureSubImage2D(texture, 0, 0, 0, size, 1, GL_RGBA, GL_FLOAT, table);
    gl->TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return texture;
}

static unsigned make_blackbody(const struct gl_functions *gl)
{
    static float table[BLACKBODY_TABLE_SIZE][4];

    blackbody_fill_table(table);
    return make_row(gl, BLACKBODY_TABLE_SIZE, table);
}

static void bind_table(struct gl_grids *grids, const struct scene_grid *source, size_t medium)
{
    struct kept_table *kept = &grids->tables[medium];
    static float table[TRANSFER_TABLE_SIZE][4];
    char hash[HASH_TEXT_SIZE];

    hash_bytes(source->points, source->point_count * sizeof *source->points, hash);
    if (strcmp(hash, kept->hash) != 0) {
        if (kept->texture) grids->gl->DeleteTextures(1, &kept->texture);
        transfer_table_fill(source->points, source->point_count, table);
        kept->texture = make_row(grids->gl, TRANSFER_TABLE_SIZE, table);
        memcpy(kept->hash, hash, sizeof kept->hash);
    }
    grids->gl->BindTextureUnit((GLuint)(UNITS_PER_MEDIUM * medium + 2), kept->texture);
}

static bool bind_bricks(struct gl_grids *grids, const struct scene_input *input, size_t medium, struct error *error)
{
    struct kept_bricks *kept = &grids->bricks[medium];
    GLuint unit = (GLuint)(UNITS_PER_MEDIUM * medium);

    if (strcmp(kept->hash, input->hash) != 0) {
        gl_bricks_finish(&kept->bricks);
        *kept = (struct kept_bricks){0};
        if (!gl_bricks_init(&kept->bricks, grids->gl, input->bricks->atlas, error)) {
            error_prefix(error, "%s", input->path);
            return false;
        }
        memcpy(kept->hash, input->hash, sizeof kept->hash);
    }
    grids->gl->BindTextureUnit(unit, kept->bricks.values[0]);
    grids->gl->BindTextureUnit(unit + 1, kept->bricks.index);
    if (!kept->bricks.values[1]) return true;
    if (!grids->blackbody) grids->blackbody = make_blackbody(grids->gl);
    grids->gl->BindTextureUnit(unit + 2, kept->bricks.values[1]);
    grids->gl->BindTextureUnit(unit + 3, grids->blackbody);
    return true;
}

static bool bind_medium(struct gl_grids *grids, const struct scene_input *input, size_t medium,
                        const struct job_quality *quality, gl_grid_progress *on_progress, void *user,
                        struct error *error)
{
    struct kept_grid *kept;

    if (input->bricks) return bind_bricks(grids, input, medium, error);
    kept = find(grids, input->hash);
    if (!kept) kept = read_grid(grids, input, on_progress, user, error);
    if (!kept) return false;
    kept->used = grids->frame_count;
    grids->gl->BindTextureUnit((GLuint)(UNITS_PER_MEDIUM * medium), kept->grid.voxels);
    if (quality->method == JOB_METHOD_PREINTEGRATED && input->source->point_count > 0)
        bind_table(grids, input->source, medium);
    if (job_quality_has_majorants(quality) && !bind_brick_numbers(grids, input, &kept->grid, true, medium, error))
        return false;
    return bind_brick_numbers(grids, input, &kept->grid, false, medium, error);
}

bool gl_grids_bind(struct gl_grids *grids, const struct scene_inputs *inputs, gl_grid_progress *on_progress, void *user,
                   struct error *error)
{
    grids->frame_count++;
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i) {
        struct kept_grid *kept = inputs->media[i].source ? find(grids, inputs->media[i].hash) : NULL;

        if (kept) kept->used = grids->frame_count;
    }
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i) {
        char place[64];

        if (!inputs->media[i].source || inputs->is_unneeded[i]) continue;
        if (bind_medium(grids, &inputs->media[i], i, &inputs->quality, on_progress, user, error)) continue;
        scene_format_medium_place(inputs->scene, i, place, sizeof place);
        error_prefix(error, "%s.density.file", place);
        return false;
    }
    return true;
}
