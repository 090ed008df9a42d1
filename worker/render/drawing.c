// SPDX-License-Identifier: Apache-2.0
#include "worker/render/drawing.h"

#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "worker/gl/gl_program.h"
#include "worker/glsl/pixel_mark.h"
#include "worker/render/passes.h"
#include "worker/render/pixel_layout.h"
#include "worker/render/tile_rows.h"
#include "worker/scene/scene_inputs.h"
#include "worker/shader/scene_program.h"
#include "worker/textures/gl_caches.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

// Slices in a row that finish no pixel of a tile: five million iterations. A random path in thick white media may have
// millions of scatterings, and a pixel as many more slices for each of its paths.
enum { IDLE_SLICE_LIMIT = 256, IDLE_WALK_LIMIT = 1 << 16, IDLE_SLICE_PATHS = 16 };

bool drawing_tools_init(struct drawing_tools *tools, const struct gl_context *context, struct error *error)
{
    *tools = (struct drawing_tools){0};
    if (!gl_functions_load(&tools->gl, context, error) || !gl_pixel_list_check(&tools->gl, error)) {
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
    gl_target_finish(&tools->list_target);
    gl_pixel_list_finish(&tools->list);
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

struct gl_target *drawing_target(const struct drawing *drawing)
{
    return drawing->layout ? &drawing->tools->list_target : &drawing->tools->target;
}

// Checks pixels that follow one another in the target. Sets the place of a marked one, counted from the first.
static bool check_marks(struct drawing *drawing, const float *rgba, size_t count, size_t *at)
{
    enum pixel_mark mark = pixel_mark_find(rgba, count, at, &drawing->marked_medium);

    if (mark == PIXEL_MARK_IS_NONE) return true;
    drawing->fault = mark == PIXEL_MARK_IS_CUT ? RENDERER_FAULT_ENDLESS : RENDERER_FAULT_MAJORANT;
    return false;
}

static struct pixel pixel_of_frame(const struct drawing *drawing, size_t at)
{
    size_t width = (size_t)drawing->tools->target.width_px;

    return (struct pixel){(int)(at % width), (int)(at / width)};
}

bool drawing_check_marks(struct drawing *drawing, const float *rgba, size_t count)
{
    size_t at;

    if (check_marks(drawing, rgba, count, &at)) return true;
    drawing->marked_pixel = drawing->layout ? drawing->layout->pixels[at] : pixel_of_frame(drawing, at);
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

    drawing->program = gl_programs_find(&drawing->tools->programs, scene->text_hash,
                                        &(struct gl_program_params){.vertex = scene->vertex,
                                                                    .fragment = scene->fragment,
                                                                    .module_names = scene->module_names,
                                                                    .module_count = scene->module_count},
                                        error);
    return drawing->program || fail(drawing, RENDERER_FAULT_JOB);
}

bool drawing_fit_target(struct drawing *drawing, const struct gl_target_params *params, struct error *error)
{
    struct gl_target *target = drawing_target(drawing);

    if (gl_target_fits(target, params)) return true;
    gl_target_finish(target);
    return gl_target_init(target, &drawing->tools->gl, params, error) || fail(drawing, RENDERER_FAULT_JOB);
}

struct tile { // rows of the frame, or squares of the list
    int first, count;
    double seconds; // the time of its longest draw
};

static void draw(const struct drawing *drawing, const struct tile *tile)
{
    const struct gl_functions *gl = &drawing->tools->gl;

    if (drawing->layout) {
        gl_pixel_list_draw(gl, tile->first, tile->count);
        return;
    }
    gl->Scissor(0, tile->first, drawing_target(drawing)->width_px, tile->count);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
}

static bool check_rows(struct drawing *drawing, const struct tile *tile)
{
    const struct gl_target *target = drawing_target(drawing);
    size_t count = (size_t)target->width_px * (size_t)tile->count, at;
    float *rgba = xmalloc(4 * count * sizeof *rgba);
    bool ok;

    gl_target_read_rows(target, tile->first, tile->count, rgba);
    ok = check_marks(drawing, rgba, count, &at);
    free(rgba);
    if (!ok) drawing->marked_pixel = pixel_of_frame(drawing, (size_t)tile->first * (size_t)target->width_px + at);
    return ok;
}

static bool check_square(struct drawing *drawing, int square)
{
    const struct pixel_layout *layout = drawing->layout;
    struct pixel corner = pixel_layout_square(layout, square);
    size_t row_floats = 4 * (size_t)layout->width_px, at;
    float *rgba = xmalloc((size_t)layout->side * row_floats * sizeof *rgba);
    bool ok = true;

    gl_target_read_rows(drawing_target(drawing), corner.y, layout->side, rgba);
    for (int y = 0; ok && y < layout->side; ++y) {
        ok = check_marks(drawing, rgba + (size_t)y * row_floats + 4 * (size_t)corner.x, (size_t)layout->side, &at);
        if (!ok) drawing->marked_pixel = layout->pixels[pixel_layout_index(layout, square, (int)at, y)];
    }
    free(rgba);
    return ok;
}

// Reads the tile only where it took long: the rest of a frame that GL cuts may take hours.
static bool check_tile(struct drawing *drawing, const struct tile *tile)
{
    bool ok = true;

    if (tile->seconds <= TILE_ROWS_SECONDS) return true;
    if (!drawing->layout) return check_rows(drawing, tile);
    for (int i = tile->first; ok && i < tile->first + tile->count; ++i)
        ok = check_square(drawing, i);
    return ok;
}

static int64_t count_pixels(const struct drawing *drawing, const struct tile *tile)
{
    const struct pixel_layout *layout = drawing->layout;

    return (int64_t)tile->count * (layout ? layout->side * layout->side : drawing_target(drawing)->width_px);
}

static struct pixel first_pixel(const struct drawing *drawing, const struct tile *tile)
{
    if (!drawing->layout) return (struct pixel){0, tile->first};
    return drawing->layout->pixels[pixel_layout_index(drawing->layout, tile->first, 0, 0)];
}

static int64_t find_idle_limit(const struct drawing *drawing)
{
    const struct scene_model *model = &drawing->scene->model;

    if (!model->features.is_walked) return IDLE_SLICE_LIMIT;
    return IDLE_WALK_LIMIT + (int64_t)IDLE_SLICE_PATHS * model->job->quality.paths;
}

// Returns what the share of the frame is after a part of a tile.
static double find_share(const struct drawing *drawing, int pass, const struct tile *tile, double part)
{
    int end = drawing->layout ? drawing->layout->square_count : drawing_target(drawing)->height_px;

    return (pass + (tile->first + part * tile->count) / end) / drawing->passes->count;
}

// Draws slices of the tile's marches until all pixels are done. Pixels that never finish fail the frame.
static bool draw_slices(struct drawing *drawing, int pass, struct tile *tile, struct error *error)
{
    const struct gl_slices *slices = &drawing->tools->slices;
    int64_t all = count_pixels(drawing, tile), left = all;
    int64_t limit = find_idle_limit(drawing);
    double walked_pixels = 0.0;

    for (int64_t idle = 0; left > 0; ++idle) {
        double start = clock_now_s(), seconds;
        struct gl_slices_walked walked;
        int64_t done;

        gl_slices_open(slices);
        draw(drawing, tile);
        done = (int64_t)gl_slices_close(slices, &walked);
        drawing->steps += walked.steps;
        walked_pixels += walked.pixels;
        left -= done;
        if (done > 0) idle = 0;
        if (!drawing_check_gl(drawing, error)) return false;
        seconds = clock_now_s() - start;
        if (seconds > tile->seconds) tile->seconds = seconds;
        if (!check_tile(drawing, tile)) return false;
        if (idle == limit) {
            drawing->marked_pixel = first_pixel(drawing, tile);
            drawing->fault = RENDERER_FAULT_ENDLESS;
            return false;
        }
        drawing->done =
            find_share(drawing, pass, tile, fmin(fmax(walked_pixels, (double)(all - left)) / (double)all, 1.0));
        if (left > 0 && !report(drawing, error)) return false;
    }
    return true;
}

static bool draw_whole(struct drawing *drawing, struct tile *tile, struct error *error)
{
    double start = clock_now_s();

    draw(drawing, tile);
    drawing->tools->gl.Finish();
    if (!drawing_check_gl(drawing, error)) return false;
    tile->seconds = clock_now_s() - start;
    return check_tile(drawing, tile);
}

static bool draw_tiles(struct drawing *drawing, int pass, struct error *error)
{
    const struct pixel_layout *layout = drawing->layout;
    int end = layout ? layout->square_count : drawing_target(drawing)->height_px, *next;

    next = layout ? &drawing->program->squares : &drawing->program->rows;
    if (*next == 0) *next = layout ? TILE_SQUARES_FIRST : TILE_ROWS_FIRST;
    for (int first = 0; first < end;) {
        struct tile tile = {.first = first, .count = *next < end - first ? *next : end - first};

        if (!(drawing->scene->model.features.is_sliced ? draw_slices(drawing, pass, &tile, error)
                                                       : draw_whole(drawing, &tile, error)))
            return false;
        first += tile.count;
        *next = (layout ? tile_squares_next : tile_rows_next)(tile.count, tile.seconds);
        drawing->done = find_share(drawing, pass, &tile, 1.0);
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
    const struct gl_target *target = drawing_target(drawing);
    size_t uniform_bytes = drawing->scene->uniforms.size_bytes;

    drawing->done = (double)pass / drawing->passes->count;
    if (!bind_caches(drawing, pass, error)) return false;
    tools->gl.UseProgram(drawing->program->name);
    gl_pixel_list_choose(&tools->gl, drawing->program->name, drawing->layout);
    if (uniform_bytes > 0) {
        tools->gl.NamedBufferData(tools->uniform_buffer, (GLsizeiptr)uniform_bytes, passes_block(drawing->passes, pass),
                                  GL_STREAM_DRAW);
        tools->gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, tools->uniform_buffer);
    }
    if (!drawing_check_gl(drawing, error)) return false;
    if (drawing->scene->model.features.is_sliced)
        gl_slices_begin(&tools->slices, &tools->gl, target->width_px, target->height_px,
                        drawing->scene->model.features.is_walked ? GL_SLICES_WALK_IMAGES : GL_SLICES_MARCH_IMAGES);
    return true;
}

double drawing_count_steps(const struct drawing *drawing)
{
    const struct pixel_layout *layout = drawing->layout;

    return drawing->steps *
           (layout ? (double)layout->count / ((double)layout->square_count * layout->side * layout->side) : 1.0);
}

bool drawing_run(struct drawing *drawing, struct error *error)
{
    struct drawing_tools *tools = drawing->tools;
    const struct gl_target *target = drawing_target(drawing);

    if (drawing->layout) gl_pixel_list_bind(&tools->list, &tools->gl, drawing->layout);
    gl_target_begin(target);
    if (drawing->scene->model.features.is_sliced) gl_target_clear(target); // removes the marks of pixels that were cut
    tools->gl.Enable(GL_SCISSOR_TEST);
    tools->gl.BindVertexArray(tools->vertex_array);
    for (int pass = 0; pass < drawing->passes->count; ++pass)
        if (!begin_pass(drawing, pass, error) || !draw_tiles(drawing, pass, error)) return false;
    return true;
}
