// What a plan of several orders of scattering leaves for the audits of its segment's frames.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/render/renderer_fault.h"

#include <stdbool.h>
#include <stddef.h>

struct audit_pool;
struct error;
struct image;
struct pixel;
struct plan;
struct plan_evidence;
struct plan_params;
struct truth_pixel;

// Adds to the pool what the light at `count` points of an image, which are drawn evenly, says of its errors. An image
// without light adds nothing.
void scatter_evidence_add(const struct image *image, const struct pixel *points, const struct truth_pixel *light,
                          size_t count, enum job_pixel pixel, struct audit_pool *pool);
// Adds samples of the pilot frames in the plan's own quality to the pool, where enough frames share it to repay that.
// Neither the pixels nor the random paths are those by which the plan was chosen: the picture's are the frame's own,
// the light's those of audits. A frame without light, or one that cannot be rendered, gives none. False when it was
// stopped or GL was lost.
bool scatter_evidence_measure(const struct plan *plan, const struct plan_params *params, struct plan_evidence *evidence,
                              enum renderer_fault *fault, struct error *error);
