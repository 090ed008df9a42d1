// An even lattice of a frame's pixels, on which settings are tried: a small picture made of the frame's own pixels.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/picture/pixel.h"
#include "worker/render/renderer.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct image;
struct plan_params;

// The frame is divided into columns x rows blocks, each shown by the pixel in its middle. The zero value is empty.
struct plan_lattice {
    int columns, rows;
    struct pixel *pixels; // owned; columns * rows, row by row
};

// At most `pixel_limit` pixels, in the shape of the job's frames.
void plan_lattice_init(struct plan_lattice *lattice, const struct job *job, int pixel_limit);
// At most as many columns and rows as the job's frames have.
void plan_lattice_init_sized(struct plan_lattice *lattice, const struct job *job, int columns, int rows);
// Has each block shown by its brightest pixel in a picture of the job's size.
void plan_lattice_seek_light(struct plan_lattice *lattice, const struct image *frame);
void plan_lattice_finish(struct plan_lattice *lattice); // accepts an empty one
size_t plan_lattice_count(const struct plan_lattice *lattice);

// Renders the lattice's pixels of a frame into an image of columns x rows, with one sample and other random paths
// than the frame's. The image is allocated anew if its size or channels differ. On failure `result` has the fault.
bool plan_lattice_render(const struct plan_lattice *lattice, const struct plan_params *params, const struct job *job,
                         int32_t frame, struct image *image, struct renderer_result *result, struct error *error);
// The same with random paths that are independent of those.
bool plan_lattice_render_again(const struct plan_lattice *lattice, const struct plan_params *params,
                               const struct job *job, int32_t frame, struct image *image,
                               struct renderer_result *result, struct error *error);
// The same for any list of pixels and an image of columns x rows, which are as many, with all samples of the job: each
// pixel is as the frame has it.
bool plan_list_render(const struct plan_params *params, const struct job *job, int32_t frame,
                      const struct pixel *pixels, int columns, int rows, struct image *image,
                      struct renderer_result *result, struct error *error);
// The frame's pixels that points of such an image show.
void plan_lattice_find(const struct plan_lattice *lattice, const struct pixel *points, size_t count,
                       struct pixel *pixels);
