// SPDX-License-Identifier: Apache-2.0
#include "worker/textures/gl_grids.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "worker/density/blackbody.h"
#include "worker/density/transfer_table.h"
#include "worker/gl/gl_functions.h"
#include "worker/gl/lru.h"
#include "worker/glsl/texture_units.h"
#include "worker/scene/scene_inputs.h"
#include "worker/sparse/brick_store.h"
#include "worker/sparse/transfer_function.h"
#include "worker/textures/gl_bricks.h"

#include <stdlib.h>
#include <string.h>

enum { GRID_LIMIT = 2 * SCENE_MEDIUM_LIMIT }; // twice what a frame has, so one is empty or idle

// Limits the grids that the frame does not need but a later one may: another job's, say.
static const size_t idle_bytes_limit = (size_t)1 << 30;

// A texture that is made again when what it depends on changes.
struct kept_texture {
    char hash[HASH_TEXT_SIZE]; // of what it depends on; empty: none
    unsigned texture;
};

struct kept_bricks {
    char hash[HASH_TEXT_SIZE]; // of the input; empty: none
    struct gl_bricks bricks;
};

// The textures of one medium besides its voxels.
struct medium_textures {
    struct kept_texture distances, majorants; // a number a brick, keyed by the input and the transfer function
    struct kept_texture table;                // keyed by the points of the transfer function
    struct kept_bricks bricks;
};

struct gl_grids {
    const struct gl_functions *gl; // borrowed; outlives us
    struct lru lru;                // keyed by the input's hash; a moment is a frame
    struct gl_grid grids[GRID_LIMIT];
    struct medium_textures media[SCENE_MEDIUM_LIMIT];
    unsigned blackbody; // the texture of its table; 0: no grid has needed it
};

struct gl_grids *gl_grids_create(const struct gl_functions *gl)
{
    struct gl_grids *grids = xcalloc(1, sizeof *grids);

    grids->gl = gl;
    grids->lru = (struct lru){.capacity = GRID_LIMIT, .idle_bytes_limit = idle_bytes_limit};
    return grids;
}

static void drop(void *user, int index)
{
    struct gl_grids *grids = user;

    gl_grid_finish(&grids->grids[index]);
}

void gl_grids_clear(struct gl_grids *grids)
{
    lru_clear(&grids->lru, drop, grids);
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i) {
        struct medium_textures *medium = &grids->media[i];

        grids->gl->DeleteTextures(1, &medium->distances.texture);
        grids->gl->DeleteTextures(1, &medium->majorants.texture);
        grids->gl->DeleteTextures(1, &medium->table.texture);
        gl_bricks_finish(&medium->bricks.bricks);
    }
    grids->gl->DeleteTextures(1, &grids->blackbody);
    memset(grids->media, 0, sizeof grids->media);
    grids->blackbody = 0;
}

void gl_grids_destroy(struct gl_grids *grids)
{
    if (!grids) return;
    gl_grids_clear(grids);
    free(grids);
}

static size_t size_of(const struct volume *header)
{
    return (size_t)header->size[0] * (size_t)header->size[1] * (size_t)header->size[2] * volume_type_size(header->type);
}

// Returns the index of the grid; -1 on failure.
static int read_grid(struct gl_grids *grids, const struct scene_input *input, gl_grid_progress *on_progress, void *user,
                     struct error *error)
{
    int index = lru_make_room(&grids->lru, size_of(&input->header), drop, grids);
    struct gl_grid *grid = &grids->grids[index];
    struct volume *volume;
    bool ok;

    if (!scene_input_open_volume(input, &volume, error)) return -1;
    ok = gl_grid_init(
        grid,
        &(struct gl_grid_params){
            .gl = grids->gl, .volume = volume, .path = input->path, .on_progress = on_progress, .user = user},
        error);
    volume_close(volume);
    if (ok && !scene_input_check(input, error)) {
        gl_grid_finish(grid);
        ok = false;
    }
    if (!ok) return -1;
    lru_put(&grids->lru, index, input->hash, grid->size_bytes);
    log_debug("grids: %s read, %zu bytes", input->path, grid->size_bytes);
    return index;
}

// Returns false, after deleting the old texture, when it has to be made again.
static bool is_kept(const struct gl_grids *grids, struct kept_texture *kept, const char *hash)
{
    if (strcmp(hash, kept->hash) == 0) return true;
    grids->gl->DeleteTextures(1, &kept->texture);
    *kept = (struct kept_texture){0};
    return false;
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

// Binds a number for each brick: its distance to the nearest brick that is not empty, or its majorant.
static bool bind_brick_numbers(struct gl_grids *grids, const struct scene_input *input, const struct gl_grid *grid,
                               bool are_majorants, size_t medium, struct error *error)
{
    struct kept_texture *kept = are_majorants ? &grids->media[medium].majorants : &grids->media[medium].distances;
    double slope = input->header.slope, intercept = input->header.intercept;
    char hash[HASH_TEXT_SIZE];

    hash_numbers(input, hash);
    if (!is_kept(grids, kept, hash)) {
        kept->texture = are_majorants ? gl_grid_create_majorants(grid, slope, intercept, find_most, input->source)
                                      : gl_grid_create_distances(grid, slope, intercept, is_empty, input->source);
        if (!kept->texture) {
            error_set(error, "%s: out of memory", input->path);
            return false;
        }
        memcpy(kept->hash, hash, sizeof kept->hash);
    }
    grids->gl->BindTextureUnit(
        texture_unit_of_medium(medium, are_majorants ? MEDIUM_TEXTURE_EXTRA : MEDIUM_TEXTURE_BRICKS), kept->texture);
    return true;
}

// Makes a texture of one row of RGBA.
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
    struct kept_texture *kept = &grids->media[medium].table;
    static float table[TRANSFER_TABLE_SIZE][4];
    char hash[HASH_TEXT_SIZE];

    hash_bytes(source->points, source->point_count * sizeof *source->points, hash);
    if (!is_kept(grids, kept, hash)) {
        transfer_table_fill(source->points, source->point_count, table);
        kept->texture = make_row(grids->gl, TRANSFER_TABLE_SIZE, table);
        memcpy(kept->hash, hash, sizeof kept->hash);
    }
    grids->gl->BindTextureUnit(texture_unit_of_medium(medium, MEDIUM_TEXTURE_EXTRA), kept->texture);
}

static bool bind_bricks(struct gl_grids *grids, const struct scene_input *input, size_t medium, struct error *error)
{
    struct kept_bricks *kept = &grids->media[medium].bricks;

    if (strcmp(kept->hash, input->hash) != 0) {
        gl_bricks_finish(&kept->bricks);
        *kept = (struct kept_bricks){0};
        if (!gl_bricks_init(&kept->bricks, grids->gl, input->bricks->atlas, error)) {
            error_prefix(error, "%s", input->path);
            return false;
        }
        memcpy(kept->hash, input->hash, sizeof kept->hash);
    }
    grids->gl->BindTextureUnit(texture_unit_of_medium(medium, MEDIUM_TEXTURE_VALUES), kept->bricks.values[0]);
    grids->gl->BindTextureUnit(texture_unit_of_medium(medium, MEDIUM_TEXTURE_BRICKS), kept->bricks.index);
    if (!kept->bricks.values[1]) return true;
    if (!grids->blackbody) grids->blackbody = make_blackbody(grids->gl);
    grids->gl->BindTextureUnit(texture_unit_of_medium(medium, MEDIUM_TEXTURE_EXTRA), kept->bricks.values[1]);
    grids->gl->BindTextureUnit(texture_unit_of_medium(medium, MEDIUM_TEXTURE_BLACKBODY), grids->blackbody);
    return true;
}

static bool bind_medium(struct gl_grids *grids, const struct scene_input *input, size_t medium,
                        const struct job_quality *quality, gl_grid_progress *on_progress, void *user,
                        struct error *error)
{
    int index;

    if (input->bricks) return bind_bricks(grids, input, medium, error);
    index = lru_find(&grids->lru, input->hash);
    if (index < 0) index = read_grid(grids, input, on_progress, user, error);
    if (index < 0) return false;
    grids->gl->BindTextureUnit(texture_unit_of_medium(medium, MEDIUM_TEXTURE_VALUES), grids->grids[index].voxels);
    if (quality->method == JOB_METHOD_PREINTEGRATED && input->source->point_count > 0)
        bind_table(grids, input->source, medium);
    if ((job_quality_has_majorants(quality) || quality->scatter_grid > 0) &&
        !bind_brick_numbers(grids, input, &grids->grids[index], true, medium, error))
        return false;
    return bind_brick_numbers(grids, input, &grids->grids[index], false, medium, error);
}

bool gl_grids_bind(struct gl_grids *grids, const struct scene_inputs *inputs, gl_grid_progress *on_progress, void *user,
                   struct error *error)
{
    lru_begin(&grids->lru);
    for (size_t i = 0; i < SCENE_MEDIUM_LIMIT; ++i)
        if (inputs->media[i].source) (void)lru_find(&grids->lru, inputs->media[i].hash);
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

const struct grid_bricks *gl_grids_find_bricks(struct gl_grids *grids, const struct scene_input *input)
{
    int index = input->source && !input->bricks ? lru_find(&grids->lru, input->hash) : -1;

    return index < 0 ? NULL : &grids->grids[index].bricks;
}
