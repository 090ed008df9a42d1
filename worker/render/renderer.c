// SPDX-License-Identifier: Apache-2.0
#include "worker/render/renderer.h"

#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "worker/gl/gl_context.h"
#include "worker/gl/gl_debug.h"
#include "worker/gl/gl_functions.h"
#include "worker/gl/gl_program.h"
#include "worker/gl/gl_programs.h"
#include "worker/glsl/pixel_mark.h"
#include "worker/picture/image.h"
#include "worker/program/scene_program.h"
#include "worker/render/gl_caches.h"
#include "worker/render/gl_grids.h"
#include "worker/render/gl_slices.h"
#include "worker/render/gl_target.h"
#include "worker/render/gl_textures.h"
#include "worker/render/passes.h"
#include "worker/render/tile_rows.h"
#include "worker/scene/camera_view.h"
#include "worker/scene/pixel_samples.h"
#include "worker/scene/scene_inputs.h"
#include "worker/scene/scene_sight.h"

#include <stdlib.h>
#include <string.h>

enum { IDLE_SLICE_LIMIT = 256 }; // in a row that no pixel of a tile was done with: five million iterations

struct renderer {
    const struct gl_context *context; // borrowed; outlives us
    char *shader_dir;                 // owned; NULL for the embedded modules
    struct gl_functions gl;
    struct gl_debug debug;
    struct gl_grids *grids;       // owned
    struct gl_textures *textures; // owned
    struct scene_files files;     // owned
    struct error unusable;        // why no frame can be rendered at all; empty when all is well
    struct gl_programs programs;
    struct gl_caches *caches; // owned
    unsigned vertex_array, uniform_buffer;
    struct gl_target target;
    struct gl_slices slices;
    // What the target shows: a whole frame of this program with these uniforms.
    bool target_is_whole;
    char shown_hash[HASH_TEXT_SIZE];  // of the program
    char shown_files[HASH_TEXT_SIZE]; // what it read
    struct passes shown;
    size_t cut_pixel; // the one of the frame that find_mark found
    int low_medium;   // whose majorant it is about
};

struct renderer *renderer_create(struct gl_context *context, const char *shader_dir)
{
    struct renderer *renderer = xcalloc(1, sizeof *renderer);

    renderer->context = context;
    renderer->shader_dir = shader_dir ? xstrdup(shader_dir) : NULL;
    scene_files_init(&renderer->files);
    if (!gl_functions_load(&renderer->gl, context, &renderer->unusable)) return renderer;
    gl_debug_init(&renderer->debug, &renderer->gl);
    renderer->grids = gl_grids_create(&renderer->gl);
    renderer->textures = gl_textures_create(&renderer->gl);
    gl_programs_init(&renderer->programs, &renderer->gl);
    renderer->caches = gl_caches_create(&renderer->gl, &renderer->programs);
    renderer->gl.CreateVertexArrays(1, &renderer->vertex_array);
    renderer->gl.CreateBuffers(1, &renderer->uniform_buffer);
    return renderer;
}

void renderer_destroy(struct renderer *renderer)
{
    if (!renderer) return;
    gl_target_finish(&renderer->target);
    gl_slices_finish(&renderer->slices);
    gl_grids_destroy(renderer->grids);
    gl_textures_destroy(renderer->textures);
    scene_files_finish(&renderer->files);
    gl_caches_destroy(renderer->caches);
    gl_programs_finish(&renderer->programs);
    if (renderer->uniform_buffer) renderer->gl.DeleteBuffers(1, &renderer->uniform_buffer);
    if (renderer->vertex_array) renderer->gl.DeleteVertexArrays(1, &renderer->vertex_array);
    gl_debug_finish(&renderer->debug);
    passes_finish(&renderer->shown);
    free(renderer->shader_dir);
    free(renderer);
}

// Turns GL's complaints since the last check, if any, into a fault.
static bool check_gl(struct renderer *renderer, struct renderer_result *result, struct error *error)
{
    switch (gl_debug_check(&renderer->debug, error)) {
    case GL_DEBUG_FINE:
        return true;
    case GL_DEBUG_MEMORY:
        result->fault = RENDERER_FAULT_JOB;
        break;
    case GL_DEBUG_ERROR:
    case GL_DEBUG_LOST:
        result->fault = RENDERER_FAULT_CONTEXT;
        break;
    }
    renderer->target_is_whole = false;
    return false;
}

static enum renderer_fault find_mark(struct renderer *renderer, const float *rgba, int first_row, int row_count)
{
    size_t width = (size_t)renderer->target.width_px, at;
    enum pixel_mark mark = pixel_mark_find(rgba, width * (size_t)row_count, &at, &renderer->low_medium);

    if (mark == PIXEL_MARK_IS_NONE) return RENDERER_FAULT_NONE;
    renderer->cut_pixel = (size_t)first_row * width + at;
    return mark == PIXEL_MARK_IS_CUT ? RENDERER_FAULT_ENDLESS : RENDERER_FAULT_MAJORANT;
}

struct reading {
    renderer_progress *on_progress;
    void *user;
    double done; // share of the frame, in [0, 1]
    bool is_stopped;
};

static bool on_slab(void *user)
{
    struct reading *reading = user;

    reading->is_stopped = reading->on_progress && !reading->on_progress(reading->user, reading->done);
    return !reading->is_stopped;
}

static bool tell_stopped(struct renderer_result *result, struct error *error)
{
    result->fault = RENDERER_FAULT_STOPPED;
    error_set(error, "the frame was stopped");
    return false;
}

struct tile { // rows of the picture
    int row, row_count;
    double seconds; // that its longest draw took
};

// Looks where a tile takes long: the rest of a frame that is cut may take hours.
static bool tile_is_cut(struct renderer *renderer, const struct tile *tile, struct renderer_result *result)
{
    float *rgba;

    if (tile->seconds <= TILE_ROWS_SECONDS) return false;
    rgba = xmalloc(4 * (size_t)renderer->target.width_px * (size_t)tile->row_count * sizeof *rgba);
    gl_target_read_rows(&renderer->target, tile->row, tile->row_count, rgba);
    result->fault = find_mark(renderer, rgba, tile->row, tile->row_count);
    free(rgba);
    return result->fault != RENDERER_FAULT_NONE;
}

// Slices of the tile, until each pixel is done: far or stuck.
static bool draw_slices(struct renderer *renderer, struct tile *tile, struct reading *reading,
                        struct renderer_result *result, struct error *error)
{
    int64_t left = (int64_t)renderer->target.width_px * tile->row_count;

    for (int idle = 0; left > 0; ++idle) {
        double start = clock_now_s();
        int64_t done = (int64_t)gl_slices_draw(&renderer->slices);

        left -= done;
        if (done > 0) idle = 0;
        if (!check_gl(renderer, result, error)) return false;
        tile->seconds = clock_now_s() - start > tile->seconds ? clock_now_s() - start : tile->seconds;
        if (tile_is_cut(renderer, tile, result)) return false;
        if (idle == IDLE_SLICE_LIMIT) {
            renderer->cut_pixel = (size_t)tile->row * (size_t)renderer->target.width_px;
            result->fault = RENDERER_FAULT_ENDLESS;
            return false;
        }
        if (left > 0 && !on_slab(reading)) return tell_stopped(result, error);
    }
    return true;
}

static bool draw_whole(struct renderer *renderer, struct tile *tile, struct renderer_result *result,
                       struct error *error)
{
    double start = clock_now_s();

    renderer->gl.DrawArrays(GL_TRIANGLES, 0, 3);
    renderer->gl.Finish();
    if (!check_gl(renderer, result, error)) return false;
    tile->seconds = clock_now_s() - start;
    return !tile_is_cut(renderer, tile, result);
}

static bool draw_tiles(struct renderer *renderer, struct kept_program *program, bool is_sliced, int pass,
                       struct reading *reading, struct renderer_result *result, struct error *error)
{
    int height_px = renderer->target.height_px, pass_count = renderer->target.pass_count;

    if (program->rows == 0) program->rows = TILE_ROWS_FIRST;
    for (int row = 0; row < height_px;) {
        struct tile tile = {.row = row, .row_count = program->rows < height_px - row ? program->rows : height_px - row};

        renderer->gl.Scissor(0, row, renderer->target.width_px, tile.row_count);
        if (!(is_sliced ? draw_slices(renderer, &tile, reading, result, error)
                        : draw_whole(renderer, &tile, result, error)))
            return false;
        row += tile.row_count;
        program->rows = tile_rows_next(tile.row_count, tile.seconds);
        reading->done = (pass + (double)row / height_px) / pass_count;
        if (!on_slab(reading)) return tell_stopped(result, error);
    }
    return true;
}

// Fills the caches that the pass samples and that are not as it needs them, and binds all.
static bool bind_caches(struct renderer *renderer, const struct scene_program *scene, const struct passes *passes,
                        int pass, struct reading *reading, struct renderer_result *result, struct error *error)
{
    const unsigned char *blocks[SCENE_CACHE_LIMIT];
    enum gl_caches_end end;

    if (scene->cache_count == 0) return true;
    passes_cache_blocks(passes, scene, pass, blocks);
    end = gl_caches_bind(
        renderer->caches,
        &(struct gl_caches_request){.caches = scene->caches,
                                    .count = scene->cache_count,
                                    .blocks = blocks,
                                    .files_hash = scene->model.inputs ? scene->model.inputs->files_hash : "",
                                    .on_strip = on_slab,
                                    .user = reading},
        error);
    if (end == GL_CACHES_BOUND) {
        if (check_gl(renderer, result, error)) return true;
        gl_caches_clear(renderer->caches);
        return false;
    }
    result->fault = end == GL_CACHES_STOPPED ? RENDERER_FAULT_STOPPED : RENDERER_FAULT_JOB;
    if (end == GL_CACHES_STOPPED) (void)tell_stopped(result, error);
    (void)gl_debug_check(&renderer->debug, NULL);
    return false;
}

static void begin_pass(struct renderer *renderer, const struct kept_program *program, const struct passes *passes,
                       size_t uniform_bytes, int pass)
{
    const struct gl_functions *gl = &renderer->gl;

    gl->UseProgram(program->name);
    if (uniform_bytes == 0) return;
    gl->NamedBufferData(renderer->uniform_buffer, (GLsizeiptr)uniform_bytes, passes_block(passes, pass),
                        GL_STREAM_DRAW);
    gl->BindBufferBase(GL_UNIFORM_BUFFER, 0, renderer->uniform_buffer);
}

static bool draw_passes(struct renderer *renderer, const struct scene_program *scene, struct kept_program *program,
                        const struct passes *passes, renderer_progress *on_progress, void *user,
                        struct renderer_result *result, struct error *error)
{
    const struct gl_functions *gl = &renderer->gl;

    gl_target_begin(&renderer->target);
    if (scene->model.features.is_sliced) gl_target_clear(&renderer->target); // of pixels that were cut
    gl->Enable(GL_SCISSOR_TEST);
    gl->BindVertexArray(renderer->vertex_array);
    for (int i = 0; i < passes->count; ++i) {
        struct reading reading = {
            .on_progress = on_progress, .user = user, .done = (double)i / renderer->target.pass_count};

        if (!bind_caches(renderer, scene, passes, i, &reading, result, error)) return false;
        begin_pass(renderer, program, passes, scene->uniforms.size_bytes, i);
        if (!check_gl(renderer, result, error)) return false;
        if (scene->model.features.is_sliced)
            gl_slices_begin(&renderer->slices, gl, renderer->target.width_px, renderer->target.height_px);
        if (!draw_tiles(renderer, program, scene->model.features.is_sliced, i, &reading, result, error)) return false;
    }
    return true;
}

static bool is_shown(const struct renderer *renderer, const struct scene_program *scene, const struct passes *passes,
                     const struct gl_target_params *target)
{
    return renderer->target_is_whole && gl_target_fits(&renderer->target, target) &&
           strcmp(renderer->shown_files, scene->model.inputs->files_hash) == 0 &&
           strcmp(renderer->shown_hash, scene->hash) == 0 && passes_are_equal(&renderer->shown, passes);
}

// Takes the passes over.
static void note_shown(struct renderer *renderer, const struct scene_program *scene, struct passes *passes)
{
    passes_finish(&renderer->shown);
    renderer->shown = *passes;
    *passes = (struct passes){0};
    memcpy(renderer->shown_hash, scene->hash, sizeof renderer->shown_hash);
    memcpy(renderer->shown_files, scene->model.inputs->files_hash, sizeof renderer->shown_files);
    renderer->target_is_whole = true;
}

// Told in the words of the job whose pixel it was.
static void tell_cut(const struct renderer *renderer, const struct job *job, struct error *error)
{
    const char *code = scene_find_code(&job->scene);
    const char *longer_steps = job->scene.medium_count == 0               ? ""
                               : job_quality_has_majorants(&job->quality) ? "thinner media, "
                                                                          : "longer steps, ";
    const char *fewer_paths = renderer->target.has_paths ? "a smaller max_depth, a larger min_throughput, " : "";
    size_t width = (size_t)renderer->target.width_px;

    error_set(error,
              "quality: pixel (%zu, %zu) needs more turns of its loops than %s runs; expected %s%s%s%s%sor a GPU",
              renderer->cut_pixel % width, renderer->cut_pixel / width, gl_context_facts(renderer->context)->renderer,
              longer_steps, fewer_paths, code ? "short loops in " : "", code ? code : "", code ? ", " : "");
}

// Reads the grids and images that are not in GL yet, and binds all.
static bool bind_files(struct renderer *renderer, const struct scene_inputs *inputs, renderer_progress *on_progress,
                       void *user, struct renderer_result *result, struct error *error)
{
    struct reading reading = {.on_progress = on_progress, .user = user};

    if (gl_grids_bind(renderer->grids, inputs, on_slab, &reading, error) &&
        gl_textures_bind(renderer->textures, inputs, on_slab, &reading, error)) {
        if (check_gl(renderer, result, error)) return true;
        gl_grids_clear(renderer->grids);
        gl_textures_clear(renderer->textures);
        return false;
    }
    if (reading.is_stopped)
        result->fault = RENDERER_FAULT_STOPPED;
    else
        result->fault = scene_inputs_are_lasting(inputs) ? RENDERER_FAULT_JOB : RENDERER_FAULT_FRAME;
    (void)gl_debug_check(&renderer->debug, NULL);
    return false;
}

static bool render_scene(struct renderer *renderer, const struct scene_program *scene, struct passes *passes,
                         const struct gl_target_params *target, renderer_progress *on_progress, void *user,
                         struct renderer_result *result, struct error *error)
{
    struct kept_program *program = gl_programs_find(&renderer->programs, scene->hash,
                                                    &(struct gl_program_params){.vertex = scene->vertex,
                                                                                .fragment = scene->fragment,
                                                                                .module_names = scene->module_names,
                                                                                .module_count = scene->module_count},
                                                    error);

    if (!program) {
        result->fault = RENDERER_FAULT_JOB;
        (void)gl_debug_check(&renderer->debug, NULL);
        return false;
    }
    renderer->target_is_whole = false;
    if (!gl_target_fits(&renderer->target, target)) {
        gl_target_finish(&renderer->target);
        if (!gl_target_init(&renderer->target, &renderer->gl, target, error)) {
            result->fault = RENDERER_FAULT_JOB;
            (void)gl_debug_check(&renderer->debug, NULL);
            return false;
        }
    }
    if (!bind_files(renderer, scene->model.inputs, on_progress, user, result, error)) return false;
    if (!draw_passes(renderer, scene, program, passes, on_progress, user, result, error)) return false;
    note_shown(renderer, scene, passes);
    return true;
}

static bool open_inputs(struct renderer *renderer, const struct job *job, int32_t frame, struct scene_inputs *inputs,
                        enum renderer_fault *fault, struct error *error)
{
    bool is_lasting;

    if (scene_inputs_open(inputs, job, frame, &renderer->files, &is_lasting, error)) return true;
    *fault = is_lasting ? RENDERER_FAULT_JOB : RENDERER_FAULT_FRAME;
    return false;
}

bool renderer_is_software(const struct renderer *renderer)
{
    return gl_context_facts(renderer->context)->is_software;
}

bool renderer_hash_picture(struct renderer *renderer, const struct job *job, int32_t frame,
                           char hash[static HASH_TEXT_SIZE], enum renderer_fault *fault, struct error *error)
{
    struct scene_inputs inputs;

    if (!open_inputs(renderer, job, frame, &inputs, fault, error)) return false;
    memcpy(hash, inputs.picture_hash, sizeof inputs.picture_hash);
    scene_inputs_finish(&inputs);
    return true;
}

void renderer_expect(struct renderer *renderer, const struct job *job, int32_t frame)
{
    scene_inputs_expect(job, frame, &renderer->files);
}

void renderer_forget(struct renderer *renderer)
{
    renderer->target_is_whole = false;
    if (renderer->caches) gl_caches_clear(renderer->caches);
}

// A frame whose files are open.
struct request {
    const struct job *job;
    int32_t frame;
    const struct scene_inputs *inputs;
    struct image *image;
    renderer_progress *on_progress;
    void *user;
};

static bool can_be_sliced(const struct job *job, const struct scene_inputs *inputs)
{
    const struct scene_features features = scene_features_of(job, inputs->is_unneeded);

    return scene_features_can_be_sliced(&features);
}

static bool render_inputs(struct renderer *renderer, const struct request *request, bool in_slices,
                          struct renderer_result *result, struct error *error)
{
    const struct job *job = request->job;
    struct image *image = request->image;
    struct gl_target_params target = {.image = image};
    int64_t fills = gl_caches_count_fills(renderer->caches);
    struct scene_program scene;
    struct passes passes = {0};
    double start = clock_now_s();
    bool ok = false;

    result->fault = RENDERER_FAULT_JOB;
    if (!(in_slices ? scene_program_init_sliced : scene_program_init)(&scene, job, request->inputs,
                                                                      renderer->shader_dir, error))
        return false;
    if (!passes_plan(&passes, &scene, job, request->frame, error)) goto out;
    result->fault = RENDERER_FAULT_NONE;
    target.pass_count = passes.count;
    target.has_paths = scene.model.features.has_paths;
    result->is_copy = is_shown(renderer, &scene, &passes, &target);
    if (result->is_copy) {
        if (request->on_progress) (void)request->on_progress(request->user, 1);
    } else if (!render_scene(renderer, &scene, &passes, &target, request->on_progress, request->user, result, error)) {
        goto out;
    }
    gl_target_read(&renderer->target, image, &result->ray_counts);
    ray_counts_find_share(&result->ray_counts, image);
    if (!check_gl(renderer, result, error)) goto out;
    result->seconds = clock_now_s() - start;
    result->cache_fills = gl_caches_count_fills(renderer->caches) - fills;
    result->shader_hash = renderer->shown_hash;
    result->fault = find_mark(renderer, image->rgba, 0, image->height_px);
    ok = result->fault == RENDERER_FAULT_NONE;
out:
    passes_finish(&passes);
    scene_program_finish(&scene);
    return ok;
}

bool renderer_render(struct renderer *renderer, const struct job *job, int32_t frame, struct image *image,
                     renderer_progress *on_progress, void *user, struct renderer_result *result, struct error *error)
{
    struct scene_inputs inputs = {0};
    const struct request request = {job, frame, &inputs, image, on_progress, user};
    struct camera_view view;
    bool ok = false;

    *result = (struct renderer_result){.fault = RENDERER_FAULT_JOB};
    if (renderer->unusable.message[0]) {
        result->fault = RENDERER_FAULT_CONTEXT;
        error_set(error, "%s", renderer->unusable.message);
        return false;
    }
    if (!camera_view_init(&view, &job->scene.camera, pixel_samples_middle(job, frame), job->width_px, job->height_px,
                          error))
        goto out;
    camera_view_matrices(&view, result->world_to_camera, result->world_to_ndc);
    if (!open_inputs(renderer, job, frame, &inputs, &result->fault, error)) goto out;
    memcpy(result->picture_hash, inputs.picture_hash, sizeof result->picture_hash);
    result->step = inputs.quality.step;
    scene_sight_find(job, &inputs, frame, inputs.is_unneeded);
    ok = render_inputs(renderer, &request, false, result, error);
    if (result->fault == RENDERER_FAULT_ENDLESS && can_be_sliced(job, &inputs))
        ok = render_inputs(renderer, &request, true, result, error);
out:
    if (result->fault == RENDERER_FAULT_ENDLESS) tell_cut(renderer, job, error);
    if (result->fault == RENDERER_FAULT_MAJORANT) pixel_mark_tell_majorant(&job->scene, renderer->low_medium, error);
    scene_inputs_finish(&inputs);
    return ok;
}
