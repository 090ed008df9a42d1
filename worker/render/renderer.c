// SPDX-License-Identifier: Apache-2.0
#include "worker/render/renderer.h"

#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "worker/gl/gl_context.h"
#include "worker/glsl/pixel_mark.h"
#include "worker/picture/image.h"
#include "worker/render/drawing.h"
#include "worker/render/frame_layers.h"
#include "worker/render/passes.h"
#include "worker/render/pixel_layout.h"
#include "worker/render/sparse_drawing.h"
#include "worker/scene/camera_view.h"
#include "worker/scene/pixel_samples.h"
#include "worker/scene/scene_inputs.h"
#include "worker/scene/scene_visibility.h"
#include "worker/shader/scene_program.h"
#include "worker/textures/gl_caches.h"
#include "worker/textures/gl_grids.h"
#include "worker/textures/gl_textures.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// The frame that the target shows: its program, files and uniforms.
struct shown_frame {
    bool is_whole; // false: the next frame cannot be a copy of it
    char program_hash[HASH_TEXT_SIZE], files_hash[HASH_TEXT_SIZE];
    struct passes passes;
};

struct renderer {
    const struct gl_context *context; // borrowed; outlives us
    char *shader_dir;                 // owned; NULL for the embedded modules
    int thread_count;                 // processors, among which software GL divides its work
    struct error unusable;            // why no frame can be rendered at all; empty: all is well
    struct drawing_tools tools;
    struct gl_grids *grids;       // owned
    struct gl_textures *textures; // owned
    struct scene_files files;
    struct shown_frame shown;
    char shader_hash[HASH_TEXT_SIZE]; // of the last rendering
};

// A frame that is being rendered.
struct rendering {
    const struct renderer_frame *frame; // borrowed, as is `result`
    struct scene_inputs inputs;
    struct renderer_result *result;
    struct pixel_layout layout; // of a list; else empty
    struct drawing drawing;
};

struct renderer *renderer_create(struct gl_context *context, const char *shader_dir)
{
    struct renderer *renderer = xcalloc(1, sizeof *renderer);

    renderer->context = context;
    renderer->thread_count = (int)sysconf(_SC_NPROCESSORS_ONLN);
    renderer->shader_dir = shader_dir ? xstrdup(shader_dir) : NULL;
    scene_files_init(&renderer->files);
    if (!drawing_tools_init(&renderer->tools, context, &renderer->unusable)) return renderer;
    renderer->grids = gl_grids_create(&renderer->tools.gl);
    renderer->textures = gl_textures_create(&renderer->tools.gl);
    return renderer;
}

void renderer_destroy(struct renderer *renderer)
{
    if (!renderer) return;
    gl_grids_destroy(renderer->grids);
    gl_textures_destroy(renderer->textures);
    drawing_tools_finish(&renderer->tools);
    scene_files_finish(&renderer->files);
    passes_finish(&renderer->shown.passes);
    free(renderer->shader_dir);
    free(renderer);
}

static bool is_shown(const struct renderer *renderer, const struct scene_program *scene, const struct passes *passes,
                     const struct gl_target_params *target)
{
    const struct shown_frame *shown = &renderer->shown;

    return shown->is_whole && gl_target_fits(&renderer->tools.target, target) &&
           strcmp(shown->files_hash, scene->model.inputs->files_hash) == 0 &&
           strcmp(shown->program_hash, scene->hash) == 0 && passes_are_equal(&shown->passes, passes);
}

// Takes ownership of the passes.
static void note_shown(struct shown_frame *shown, const struct scene_program *scene, struct passes *passes)
{
    passes_finish(&shown->passes);
    *shown = (struct shown_frame){.is_whole = true, .passes = *passes};
    *passes = (struct passes){0};
    memcpy(shown->program_hash, scene->hash, sizeof shown->program_hash);
    memcpy(shown->files_hash, scene->model.inputs->files_hash, sizeof shown->files_hash);
}

// The message uses the keys of the job.
static void set_cut_error(const struct renderer *renderer, const struct rendering *rendering, struct error *error)
{
    const struct job *job = rendering->frame->job;
    const char *code = scene_find_code(&job->scene);
    const char *longer_steps = job->scene.medium_count == 0               ? ""
                               : job->quality.tolerance > 0.0             ? "a larger tolerance, "
                               : job_quality_has_majorants(&job->quality) ? "thinner media, "
                                                                          : "longer steps, ";
    const char *fewer_paths =
        drawing_target(&rendering->drawing)->has_paths ? "a smaller max_depth, a larger min_throughput, " : "";
    struct pixel pixel = rendering->drawing.marked_pixel;

    error_set(error,
              "quality: pixel (%d, %d) needs more iterations of its loops than %s runs; expected %s%s%s%s%sor a GPU",
              pixel.x, pixel.y, gl_context_facts(renderer->context)->renderer, longer_steps, fewer_paths,
              code ? "short loops in " : "", code ? code : "", code ? ", " : "");
}

// Reads the grids and images that are not in GL yet and binds them all.
static bool bind_files(struct renderer *renderer, struct drawing *drawing, struct error *error)
{
    const struct scene_inputs *inputs = drawing->scene->model.inputs;

    if (gl_grids_bind(renderer->grids, inputs, drawing_report, drawing, error) &&
        gl_textures_bind(renderer->textures, inputs, drawing_report, drawing, error)) {
        if (drawing_check_gl(drawing, error)) return true;
        gl_grids_clear(renderer->grids);
        gl_textures_clear(renderer->textures);
        return false;
    }
    if (drawing->fault != RENDERER_FAULT_STOPPED)
        drawing->fault = scene_inputs_are_lasting(inputs) ? RENDERER_FAULT_JOB : RENDERER_FAULT_FRAME;
    (void)gl_debug_check(&renderer->tools.debug, NULL);
    return false;
}

static bool draw(struct renderer *renderer, struct drawing *drawing, const struct gl_target_params *target,
                 struct error *error)
{
    if (!drawing_find_program(drawing, error)) return false;
    if (!drawing->layout) renderer->shown.is_whole = false;
    return drawing_fit_target(drawing, target, error) && bind_files(renderer, drawing, error) &&
           drawing_run(drawing, error);
}

// Copies what the target shows into the frame's image.
static bool read_target(struct renderer *renderer, struct rendering *rendering, struct error *error)
{
    struct renderer_result *result = rendering->result;

    gl_target_read(drawing_target(&rendering->drawing), rendering->drawing.layout, rendering->frame->image,
                   &result->ray_counts);
    ray_counts_find_share(&result->ray_counts, rendering->frame->image);
    if (drawing_check_gl(&rendering->drawing, error)) return true;
    renderer->shown.is_whole = false;
    return false;
}

// Traces a part of the frame's pixels. Such frames are never copied: the target does not show them.
static bool render_sparse(struct renderer *renderer, struct rendering *rendering, struct error *error)
{
    struct drawing *drawing = &rendering->drawing;
    struct sparse_drawing sparse = {.drawing = drawing,
                                    .job = rendering->frame->job,
                                    .grids = renderer->grids,
                                    .image = rendering->frame->image,
                                    .frame = rendering->frame->frame,
                                    .has_paths = drawing->scene->model.features.has_paths,
                                    .thread_count = renderer->thread_count,
                                    .on_level = rendering->frame->on_level,
                                    .user = rendering->frame->user};

    if (!drawing_find_program(drawing, error) || !bind_files(renderer, drawing, error) ||
        !sparse_drawing_run(&sparse, &rendering->result->ray_counts, error))
        return false;
    ray_counts_find_share(&rendering->result->ray_counts, sparse.image);
    rendering->result->traced = sparse.traced;
    return true;
}

static bool render_scene(struct renderer *renderer, struct rendering *rendering, const struct scene_program *scene,
                         struct passes *passes, struct error *error)
{
    const struct image *image = rendering->frame->image;
    struct renderer_result *result = rendering->result;
    struct drawing *drawing = &rendering->drawing;
    const struct gl_target_params target = {.image = image,
                                            .layout = drawing->layout,
                                            .pass_count = passes->count,
                                            .has_paths = scene->model.features.has_paths};

    drawing->scene = scene;
    drawing->passes = passes;
    result->traced = 1.0;
    if (!drawing->layout && drawing->scene->model.job->quality.pixels.stride > 0)
        return render_sparse(renderer, rendering, error);
    if (!drawing->layout) {
        free(image->doubts);
        rendering->frame->image->doubts = NULL;
    }
    result->is_copy = !drawing->layout && is_shown(renderer, scene, passes, &target);
    if (!result->is_copy) {
        if (!draw(renderer, drawing, &target, error)) return false;
        if (!drawing->layout) note_shown(&renderer->shown, scene, passes);
    } else if (drawing->on_progress) {
        (void)drawing->on_progress(drawing->user, 1);
    }
    return read_target(renderer, rendering, error) &&
           drawing_check_marks(drawing, image->rgba, (size_t)image->width_px * (size_t)image->height_px);
}

// Writes the frame's program and draws it. With `is_sliced` each march continues over several draws.
static bool render_frame(struct renderer *renderer, struct rendering *rendering, bool is_sliced, struct error *error)
{
    struct renderer_result *result = rendering->result;
    struct drawing *drawing = &rendering->drawing;
    int64_t fills = gl_caches_count_fills(renderer->tools.caches);
    struct scene_cache_walks before = gl_caches_count_walks(renderer->tools.caches), walked;
    struct scene_program scene;
    struct passes passes = {0};
    double start = clock_now_s();
    bool ok = false;

    drawing->fault = RENDERER_FAULT_JOB;
    if (!(is_sliced ? scene_program_init_sliced : scene_program_init)(&scene, rendering->frame->job, &rendering->inputs,
                                                                      renderer->shader_dir, error))
        return false;
    if (passes_plan(&passes,
                    &(struct passes_params){.scene = &scene,
                                            .job = rendering->frame->job,
                                            .frame = rendering->frame->frame,
                                            .stream = (int)rendering->frame->stream},
                    error)) {
        drawing->fault = RENDERER_FAULT_NONE;
        ok = render_scene(renderer, rendering, &scene, &passes, error);
        result->seconds = clock_now_s() - start;
        result->cache_fills = gl_caches_count_fills(renderer->tools.caches) - fills;
        walked = gl_caches_count_walks(renderer->tools.caches);
        result->walks = walked.walks - before.walks;
        result->steps = walked.steps - before.steps + drawing_count_steps(drawing);
        memcpy(renderer->shader_hash, scene.hash, sizeof renderer->shader_hash);
        result->shader_hash = renderer->shader_hash;
    }
    passes_finish(&passes);
    scene_program_finish(&scene);
    return ok;
}

static bool open_inputs(struct renderer *renderer, const struct job *job, int32_t frame, struct scene_inputs *inputs,
                        enum renderer_fault *fault, struct error *error)
{
    bool is_lasting;

    if (scene_inputs_open(inputs, job, frame, &renderer->files, &is_lasting, error)) return true;
    *fault = is_lasting ? RENDERER_FAULT_JOB : RENDERER_FAULT_FRAME;
    return false;
}

// Random paths are as long as chance wants.
static bool is_walked(const struct rendering *rendering)
{
    return scene_features_of(rendering->frame->job, rendering->inputs.is_unneeded).is_walked;
}

static bool can_be_sliced(const struct rendering *rendering)
{
    const struct scene_features features = scene_features_of(rendering->frame->job, rendering->inputs.is_unneeded);

    return scene_features_can_be_sliced(&features);
}

bool renderer_render_layer(struct renderer *renderer, const struct renderer_frame *frame,
                           struct renderer_result *result, struct error *error)
{
    const struct job *job = frame->job;
    struct rendering rendering = {.frame = frame,
                                  .result = result,
                                  .drawing = {.tools = &renderer->tools,
                                              .on_progress = frame->on_progress,
                                              .user = frame->user,
                                              .fault = RENDERER_FAULT_JOB}};
    enum renderer_fault *fault = &rendering.drawing.fault;
    struct camera_view view;
    bool ok = false;

    *result = (struct renderer_result){0};
    if (renderer->unusable.message[0]) {
        result->fault = RENDERER_FAULT_CONTEXT;
        error_set(error, "%s", renderer->unusable.message);
        return false;
    }
    if (!camera_view_init(&view, &job->scene.camera, pixel_samples_middle(job, frame->frame), job->width_px,
                          job->height_px, error))
        goto out;
    camera_view_matrices(&view, result->world_to_camera, result->world_to_ndc);
    if (!open_inputs(renderer, job, frame->frame, &rendering.inputs, fault, error)) goto out;
    if (frame->pixels) {
        pixel_layout_init(&rendering.layout, frame->pixels, frame->pixel_count, renderer->thread_count);
        rendering.drawing.layout = &rendering.layout;
    }
    memcpy(result->picture_hash, rendering.inputs.picture_hash, sizeof result->picture_hash);
    result->step = rendering.inputs.quality.step;
    scene_visibility_find(job, &rendering.inputs, frame->frame, rendering.inputs.is_unneeded);
    ok = render_frame(renderer, &rendering, is_walked(&rendering), error);
    if (*fault == RENDERER_FAULT_ENDLESS && can_be_sliced(&rendering))
        ok = render_frame(renderer, &rendering, true, error);
    if (*fault == RENDERER_FAULT_ENDLESS) set_cut_error(renderer, &rendering, error);
    if (*fault == RENDERER_FAULT_MAJORANT)
        pixel_mark_tell_majorant(&job->scene, rendering.drawing.marked_medium, error);
out:
    result->fault = *fault;
    pixel_layout_finish(&rendering.layout);
    scene_inputs_finish(&rendering.inputs);
    return ok;
}

bool renderer_render(struct renderer *renderer, const struct renderer_frame *frame, struct renderer_result *result,
                     struct error *error)
{
    const struct frame_layers layers = {frame, renderer_render_layer};

    return frame_layers_render(renderer, &layers, result, error);
}

void renderer_watch_links(struct renderer *renderer, void (*on_link)(void *user, bool begins), void *user)
{
    renderer->tools.programs.on_link = on_link;
    renderer->tools.programs.user = user;
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
    renderer->shown.is_whole = false;
    if (renderer->tools.caches) gl_caches_clear(renderer->tools.caches);
}
