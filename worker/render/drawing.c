// SPDX-License-Identifier: Apache-2.0
#include "worker/render/drawing.h"

#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "worker/gl/gl_program.h"
#include "worker/glsl/pixel_mark.h"
#include "worker/render/passes.h"
#include "worker/render/tile_rows.h"
#include "worker/scene/scene_inputs.h"
#include "worker/shader/scene_program.h"
#include "worker/textures/gl_caches.h"

#include <stdint.h>
#include <stdlib.h>

enum { IDLE_SLICE_LIMIT = 256 }; // slices in a row that finish no pixel of a tile: five million iterations

bool drawing_tools_init(struct drawing_tools *tools, const struct gl_context *context, struct error *error)
{
    *tools = (struct drawing_tools){0};
    if (!gl_functions_load(&tools->gl, context, error)) {
        *tools = (struct drawing_tools){0};
        return false;
    }
    gl_debug_init(&tools->debug, &tools->gl);
    gl_programs_init(&tools->programs, &tools->gl);
    tools->caches = gl_caches_create(&tools->gl, &tools->programs);
    tools->gl.CreateVertexArrays(1, &tools->vertex_array);
    tools->gl.CreateBuffers(1, &tools->uniform_buffer);
    return true;
}

void drawing_tools_finish(struct drawing_tools *tools)
{
    gl_target_finish(&tools->target);
    gl_slices_finish(&tools->slices);
    gl_caches_destroy(tools->caches);
    gl_programs_finish(&tools->programs);
    if (tools->uniform_buffer) tools->gl.DeleteBuffers(1, &tools->uniform_buffer);
    if (tools->vertex_array) tools->gl.DeleteVertexArrays(1, &tools->vertex_array);
    gl_debug_finish(&tools->debug);
    *tools = (struct drawing_tools){0};
}

// The error has its reason already, so what GL reports beside it is dropped.
static bool fail(struct drawing *drawing, enum renderer_fault fault)
{
    drawing->fault = fault;
    (void)gl_debug_check(&drawing->tools->debug, NULL);
    return false;
}

bool drawing_check_gl(struct drawing *drawing, struct error *error)
{
    switch (gl_debug_check(&drawing->tools->debug, error)) {
    case GL_DEBUG_FINE:
        return true;
    case GL_DEBUG_MEMORY:
        drawing->fault = RENDERER_FAULT_JOB;
        break;
    case GL_DEBUG_ERROR:
    case GL_DEBUG_LOST:
        drawing->fault = RENDERER_FAULT_CONTEXT;
        break;
    }
    return false;
}

bool drawing_check_marks(struct drawing *drawing, const float *rgba, int first_row, int row_count)
{
    size_t width = (size_t)drawing->tools->target.width_px, at;
    enum pixel_mark mark = pixel_mark_find(rgba, width * (size_t)row_count, &at, &drawing->marked_medium);

    if (mark == PIXEL_MARK_IS_NONE) return true;
    drawing->marked_pixel = (size_t)first_row * width + at;
    drawing->fault = mark == PIXEL_MARK_IS_CUT ? RENDERER_FAULT_ENDLESS : RENDERER_FAULT_MAJORANT;
    return false;
}

bool drawing_report(void *user)
{
    struct drawing *drawing = user;

    if (!drawing->on_progress || drawing->on_progress(drawing->user, drawing->done)) return true;
    drawing->fault = RENDERER_FAULT_STOPPED;
    return false;
}

static bool report(struct drawing *drawing, struct error *error)
{
    if (drawing_report(drawing)) return true;
    error_set(error, "the frame was stopped");
    return false;
}

bool drawing_find_program(struct drawing *drawing, struct error *error)
{
    const struct scene_program *scene = drawing->scene;

    drawing->program = gl_programs_find(&drawing->tools->programs, scene->hash,
                                        &(struct gl_program_params){.vertex = scene->vertex,
                                                                    .fragment = scene->fragment,
                                                                    .module_names = scene->module_names,
                                                                    .module_count = scene->module_count},
                                        error);
    return drawing->program || fail(drawing, RENDERER_FAULT_JOB);
}

bool drawing_fit_target(struct drawing *drawing, const struct gl_target_params *params, struct error *error)
{
    struct gl_target *target = &drawing->tools->target;

    if (gl_target_fits(target, params)) return true;
    gl_target_finish(target);
    return gl_target_init(target, &drawing->tools->gl, params, error) || fail(drawing, RENDERER_FAULT_JOB);
}

struct tile { // rows of the picture
    int row, row_count;
    double seconds; // the time of its longest draw
};

// Reads the tile only where it took long: the rest of a frame that GL cuts may take hours.
static bool check_tile(struct drawing *drawing, const struct tile *tile)
{
    const struct gl_target *target = &drawing->tools->target;
    float *rgba;
    bool ok;

    if (tile->seconds <= TILE_ROWS_SECONDS) return true;
    rgba = xmalloc(4 * (size_t)target->width_px * (size_t)tile->row_count * sizeof *rgba);
    gl_target_read_rows(target, tile->row, tile->row_count, rgba);
    ok = drawing_check_marks(drawing, rgba, tile->row, tile->row_count);
    free(rgba);
    return ok;
}

// Draws slices of the tile's marches until all pixels are done. Pixels that never finish fail the frame.
static bool draw_slices(struct drawing *drawing, struct tile *tile, struct error *error)
{
    int width_px = drawing->tools->target.width_px;
    int64_t left = (int64_t)width_px * tile->row_count;

    for (int idle = 0; left > 0; ++idle) {
        double start = clock_now_s(), seconds;
        int64_t done = (int64_t)gl_slices_draw(&drawing->tools->slices);

        left -= done;
        if (done > 0) idle = 0;
        if (!drawing_check_gl(drawing, error)) return false;
        seconds = clock_now_s() - start;
        if (seconds > tile->seconds) tile->seconds = seconds;
        if (!check_tile(drawing, tile)) return false;
        if (idle == IDLE_SLICE_LIMIT) {
            drawing->marked_pixel = (size_t)tile->row * (size_t)width_px;
            drawing->fault = RENDERER_FAULT_ENDLESS;
            return false;
        }
        if (left > 0 && !report(drawing, error)) return false;
    }
    return true;
}

static bool draw_whole(struct drawing *drawing, struct tile *tile, struct error *error)
{
    const struct gl_functions *gl = &drawing->tools->gl;
    double start = clock_now_s();

    gl->DrawArrays(GL_TRIANGLES, 0, 3);
    gl->Finish();
    if (!drawing_check_gl(drawing, error)) return false;
    tile->seconds = clock_now_s() - start;
    return check_tile(drawing, tile);
}

static bool draw_tiles(struct drawing *drawing, int pass, struct error *error)
{
    const struct gl_target *target = &drawing->tools->target;
    int height_px = target->height_px, *rows = &drawing->program->rows;

    if (*rows == 0) *rows = TILE_ROWS_FIRST;
    for (int row = 0; row < height_px;) {
        struct tile tile = {.row = row, .row_count = *rows < height_px - row ? *rows : height_px - row};

        drawing->tools->gl.Scissor(0, row, target->width_px, tile.row_count);
        if (!(drawing->scene->model.features.is_sliced ? draw_slices : draw_whole)(drawing, &tile, error)) return false;
        row += tile.row_count;
        *rows = tile_rows_next(tile.row_count, tile.seconds);
        drawing->done = (pass + (double)row / height_px) / target->pass_count;
        if (!report(drawing, error)) return false;
    }
    return true;
}

// Fills the caches that the pass samples, except those that are up to date, and binds them all.
static bool bind_caches(struct drawing *drawing, int pass, struct error *error)
{
    const struct scene_program *scene = drawing->scene;
    const unsigned char *blocks[SCENE_CACHE_LIMIT];
    enum gl_caches_end end;

    if (scene->cache_count == 0) return true;
    passes_cache_blocks(drawing->passes, scene, pass, blocks);
    end = gl_caches_bind(
        drawing->tools->caches,
        &(struct gl_caches_request){.caches = scene->caches,
                                    .count = scene->cache_count,
                                    .blocks = blocks,
                                    .files_hash = scene->model.inputs ? scene->model.inputs->files_hash : "",
                                    .on_strip = drawing_report,
                                    .user = drawing},
        error);
    if (end == GL_CACHES_BOUND) {
        if (drawing_check_gl(drawing, error)) return true;
        gl_caches_clear(drawing->tools->caches);
        return false;
    }
    if (end == GL_CACHES_STOPPED) error_set(error, "the frame was stopped");
    return fail(drawing, end == GL_CACHES_STOPPED ? RENDERER_FAULT_STOPPED : RENDERER_FAULT_JOB);
}

static bool begin_pass(struct drawing *drawing, int pass, struct error *error)
{
    struct drawing_tools *tools = drawing->tools;
    size_t uniform_bytes = drawing->scene->uniforms.size_bytes;

    drawing->done = (double)pass / tools->target.pass_count;
    if (!bind_caches(drawing, pass, error)) return false;
    tools->gl.UseProgram(drawing->program->name);
    if (uniform_bytes > 0) {
        tools->gl.NamedBufferData(tools->uniform_buffer, (GLsizeiptr)uniform_bytes, passes_block(drawing->passes, pass),
                                  GL_STREAM_DRAW);
        tools->gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, tools->uniform_buffer);
    }
    if (!drawing_check_gl(drawing, error)) return false;
    if (drawing->scene->model.features.is_sliced)
        gl_slices_begin(&tools->slices, &tools->gl, tools->target.width_px, tools->target.height_px);
    return true;
}

bool drawing_run(struct drawing *drawing, struct error *error)
{
    struct drawing_tools *tools = drawing->tools;

    gl_target_begin(&tools->target);
    if (drawing->scene->model.features.is_sliced)
        gl_target_clear(&tools->target); // removes the marks of pixels that were cut
    tools->gl.Enable(GL_SCISSOR_TEST);
    tools->gl.BindVertexArray(tools->vertex_array);
    for (int pass = 0; pass < drawing->passes->count; ++pass)
        if (!begin_pass(drawing, pass, error) || !draw_tiles(drawing, pass, error)) return false;
    return true;
}
