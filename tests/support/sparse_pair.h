// A frame with every pixel traced, and the same with sparse ones.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

struct sparse_pair {
    struct image full, sparse; // with `cut`
    struct renderer_result full_result, sparse_result;
};

// A frame by the job's quality with these pixels, of which a stride of 0 traces all. Fails the test where it fails.
struct image sparse_pair_frame(struct renderer *renderer, const struct job *job, int32_t frame,
                               struct job_pixels pixels, struct renderer_result *result);
void sparse_pair_render(struct renderer *renderer, const struct job *job, int32_t frame, struct job_pixels pixels,
                        struct sparse_pair *pair);
void sparse_pair_finish(struct sparse_pair *pair);
// The relative RMSE of the sparse frame's colours.
double sparse_pair_error(const struct sparse_pair *pair);
