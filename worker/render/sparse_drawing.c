// SPDX-License-Identifier: Apache-2.0
#include "worker/render/sparse_drawing.h"

#include "core/base/clock.h"
#include "core/job/job.h"
#include "worker/picture/image.h"
#include "worker/picture/ray_counts.h"
#include "worker/pixels/pixel_lattice.h"
#include "worker/pixels/scene_guards.h"
#include "worker/render/drawing.h"
#include "worker/render/passes.h"
#include "worker/render/pixel_layout.h"
#include "worker/shader/scene_program.h"

#include <stddef.h>
#include <string.h>

// Levels cost about the same each, after the first few.
struct level_progress {
    struct drawing *drawing;
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
    int samples = sparse->drawing->passes->count;

    *counts = (struct ray_counts){.is_known = true};
    for (int y = 0; y < image->height_px; y++)
        ray_counts_add_row(counts, paths + 4 * (size_t)y * (size_t)image->width_px, image->width_px, y);
    for (size_t i = 0; image->cut && i < pixels; i++)
        image->cut[i] = paths[4 * i] / (float)samples;
    ray_counts_find_means(counts, (int64_t)pixels, samples);
}

static bool refine(struct sparse_drawing *sparse, struct pixel_lattice *lattice)
{
    double start = clock_now_s();
    bool is_finer = pixel_lattice_refine(lattice);

    sparse->spread_s += clock_now_s() - start;
    return is_finer;
}

bool sparse_drawing_run(struct sparse_drawing *sparse, struct ray_counts *counts, struct error *error)
{
    const struct job_quality *quality = &sparse->job->quality;
    struct image *image = sparse->image;
    struct drawing *drawing = sparse->drawing;
    struct level_progress progress = {.drawing = drawing, .on_progress = drawing->on_progress, .user = drawing->user};
    struct scene_guards guards;
    struct pixel_lattice lattice;
    int level_count = 1;
    bool ok;

    for (int stride = quality->pixels.stride; stride > 1; stride /= 2)
        level_count++;
    progress.share = 1.0 / level_count;
    drawing->on_progress = on_level_progress;
    drawing->user = &progress;
    scene_guards_init(&guards, sparse->job, drawing->scene->model.inputs, sparse->frame);
    pixel_lattice_init(&lattice, &(struct pixel_lattice_params){.image = image,
                                                                .stride = quality->pixels.stride,
                                                                .threshold = quality->pixels.threshold,
                                                                .has_paths = sparse->has_paths,
                                                                .guards = guards.list,
                                                                .guard_count = guards.count});
    do {
        ok = trace_wanted(sparse, &lattice, error);
        progress.begin += progress.share;
    } while (ok && refine(sparse, &lattice));
    drawing->on_progress = progress.on_progress;
    drawing->user = progress.user;
    if (ok && sparse->has_paths)
        count_rays(sparse, &lattice, counts);
    else if (image->cut)
        memset(image->cut, 0, (size_t)image->width_px * (size_t)image->height_px * sizeof *image->cut);
    sparse->traced = (double)lattice.traced / ((double)image->width_px * image->height_px);
    pixel_lattice_finish(&lattice);
    scene_guards_finish(&guards);
    return ok;
}
