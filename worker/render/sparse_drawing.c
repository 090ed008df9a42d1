// SPDX-License-Identifier: Apache-2.0
#include "worker/render/sparse_drawing.h"

#include "core/job/job.h"
#include "worker/picture/image.h"
#include "worker/picture/ray_counts.h"
#include "worker/pixels/pixel_edges.h"
#include "worker/pixels/pixel_lattice.h"
#include "worker/pixels/scene_guards.h"
#include "worker/pixels/voxel_guards.h"
#include "worker/render/drawing.h"
#include "worker/render/passes.h"
#include "worker/render/pixel_layout.h"
#include "worker/scene/scene_inputs.h"
#include "worker/shader/scene_program.h"
#include "worker/textures/gl_grids.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

// Levels cost about the same each, after the first few.
struct level_progress {
    drawing_progress *on_progress;
    void *user;
    double begin, share;
};

static bool on_level_progress(void *user, double done)
{
    const struct level_progress *progress = user;

    return !progress->on_progress || progress->on_progress(progress->user, progress->begin + done * progress->share);
}

static bool trace(struct sparse_drawing *sparse, const struct pixel_lattice *lattice, struct pixel_planes *planes,
                  struct error *error)
{
    struct drawing *drawing = sparse->drawing;
    const struct gl_target_params target = {.image = sparse->image,
                                            .layout = drawing->layout,
                                            .pass_count = drawing->passes->count,
                                            .has_paths = sparse->has_paths,
                                            .has_signature = true};

    if (!drawing_fit_target(drawing, &target, error) || !drawing_run(drawing, error)) return false;
    gl_target_read_planes(drawing_target(drawing), drawing->layout, planes);
    return drawing_check_gl(drawing, error) && drawing_check_marks(drawing, planes->rgba, lattice->wanted_count);
}

static bool trace_wanted(struct sparse_drawing *sparse, struct pixel_lattice *lattice, struct error *error)
{
    const struct pixel_channels channels = {.has_transmittance = sparse->image->transmittance != NULL,
                                            .has_paths = sparse->has_paths,
                                            .has_depth = sparse->image->depth != NULL};
    struct pixel_layout layout;
    struct pixel_planes planes;
    bool ok;

    if (lattice->wanted_count == 0) return true;
    pixel_layout_init(&layout, lattice->wanted, lattice->wanted_count, sparse->thread_count);
    pixel_planes_init(&planes, channels, lattice->wanted_count);
    sparse->drawing->layout = &layout;
    ok = trace(sparse, lattice, &planes, error);
    if (ok) pixel_lattice_give(lattice, &planes);
    sparse->drawing->layout = NULL;
    pixel_planes_finish(&planes);
    pixel_layout_finish(&layout);
    return ok;
}

static void count_rays(const struct sparse_drawing *sparse, const struct pixel_lattice *lattice,
                       struct ray_counts *counts)
{
    struct image *image = sparse->image;
    const float *paths = lattice->planes.paths;
    size_t pixels = (size_t)image->width_px * (size_t)image->height_px;

    *counts = (struct ray_counts){.is_known = true};
    for (int y = 0; y < image->height_px; y++)
        ray_counts_add_row(counts, paths + 4 * (size_t)y * (size_t)image->width_px, image->width_px, y);
    for (size_t i = 0; image->cut && i < pixels; i++)
        image->cut[i] = paths[4 * i];
    ray_counts_find_means(counts, (int64_t)pixels, 1);
}

static void show_level(const struct sparse_drawing *sparse, const struct pixel_lattice *lattice)
{
    if (!sparse->on_level) return;
    sparse->on_level(sparse->user, &(struct picture_level){.rgba = lattice->planes.rgba,
                                                           .stride = lattice->stride,
                                                           .columns = lattice->columns,
                                                           .rows = lattice->rows,
                                                           .width_px = sparse->image->width_px,
                                                           .height_px = sparse->image->height_px});
}

// Levels of pixels, of all samples each or, where these differ in their points alone, of their centres.
static bool draw_levels(struct sparse_drawing *sparse, struct pixel_lattice *lattice, struct level_progress *progress,
                        struct error *error)
{
    do {
        if (!trace_wanted(sparse, lattice, error)) return false;
        show_level(sparse, lattice);
        progress->begin += progress->share;
    } while (pixel_lattice_refine(lattice));
    return true;
}

// The share of the frame's samples that are traced; 1 if centres are traced in vain.
static double find_share(const struct pixel_lattice *lattice, size_t edge_count, int sample_count)
{
    double pixels = (double)lattice->params.image->width_px * lattice->params.image->height_px;

    return fmin(((double)lattice->traced / sample_count + (double)edge_count) / pixels, 1.0);
}

// Has centres traced first, and then all samples of the pixels in which the centre does not stand for them.
static bool draw_centres(struct sparse_drawing *sparse, struct pixel_lattice *lattice, struct level_progress *progress,
                         struct error *error)
{
    struct drawing *drawing = sparse->drawing;
    const struct passes *passes = drawing->passes, centre = passes_centre(passes);
    size_t edge_count;
    bool ok;

    drawing->passes = &centre;
    ok = draw_levels(sparse, lattice, progress, error);
    drawing->passes = passes;
    if (!ok) return false;
    edge_count = pixel_edges_find(lattice);
    sparse->traced = find_share(lattice, edge_count, passes->count);
    return trace_wanted(sparse, lattice, error);
}

static void find_voxels(const struct sparse_drawing *sparse, struct voxel_guards *voxels)
{
    const struct scene_inputs *inputs = sparse->drawing->scene->model.inputs;
    struct voxel_guards_params params = {.job = sparse->job, .inputs = inputs, .frame = sparse->frame};

    for (size_t i = 0; inputs && i < SCENE_MEDIUM_LIMIT; i++)
        params.bricks[i] = gl_grids_find_bricks(sparse->grids, &inputs->media[i]);
    voxel_guards_init(voxels, &params);
}

bool sparse_drawing_run(struct sparse_drawing *sparse, struct ray_counts *counts, struct error *error)
{
    const struct job_quality *quality = &sparse->job->quality;
    struct image *image = sparse->image;
    struct drawing *drawing = sparse->drawing;
    struct level_progress progress = {.on_progress = drawing->on_progress, .user = drawing->user};
    struct scene_guards guards;
    struct voxel_guards voxels;
    struct pixel_lattice lattice;
    // The noise of a centre's paths would pass for an edge.
    bool is_scattered = drawing->scene->model.features.is_scattered;
    bool ok, has_edges = drawing->passes->count > 1 && drawing->passes->are_still && !is_scattered;
    int level_count = 2; // the last one is that of edges

    for (int stride = quality->pixels.stride; stride > 1; stride /= 2)
        level_count++;
    progress.share = 1.0 / level_count;
    drawing->on_progress = on_level_progress;
    drawing->user = &progress;
    scene_guards_init(&guards, sparse->job, drawing->scene->model.inputs, sparse->frame);
    find_voxels(sparse, &voxels);
    pixel_lattice_init(&lattice,
                       &(struct pixel_lattice_params){.image = image,
                                                      .stride = quality->pixels.stride,
                                                      .threshold = quality->pixels.threshold,
                                                      .has_paths = sparse->has_paths,
                                                      .has_noise = is_scattered,
                                                      .has_edges = has_edges,
                                                      .guards = guards.list,
                                                      .guard_count = guards.count,
                                                      .voxels = voxels.strides && !is_scattered ? &voxels : NULL});
    sparse->traced = 0.0;
    if (has_edges) {
        ok = draw_centres(sparse, &lattice, &progress, error);
    } else {
        ok = draw_levels(sparse, &lattice, &progress, error);
        sparse->traced = find_share(&lattice, 0, 1);
    }
    drawing->on_progress = progress.on_progress;
    drawing->user = progress.user;
    if (ok && sparse->has_paths)
        count_rays(sparse, &lattice, counts);
    else if (image->cut)
        memset(image->cut, 0, (size_t)image->width_px * (size_t)image->height_px * sizeof *image->cut);
    pixel_lattice_finish(&lattice);
    scene_guards_finish(&guards);
    voxel_guards_finish(&voxels);
    return ok;
}
