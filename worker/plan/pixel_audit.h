// What interpolated pixels add to a frame's error: some of them are traced, and compared.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/audit/audit_estimate.h"
#include "worker/picture/pixel.h"
#include "worker/render/renderer_fault.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct image;
struct job;
struct plan_params;

enum { PIXEL_AUDIT_RAYS = 512 };

// A frame of `planned`, which has the size of the image.
struct pixel_audit {
    const struct plan_params *params; // borrowed: renderer and progress
    const struct job *planned;        // borrowed
    int32_t frame;
    const struct image *image; // borrowed; it has `doubts`
};

// Draws PIXEL_AUDIT_RAYS pixels, more of them where the interpolation was doubtful, and traces them. The verdict is
// that of audit_estimate for the difference between the frame and one of which every pixel is traced.
bool pixel_audit_measure(const struct pixel_audit *audit, struct audit_verdict *verdict, enum renderer_fault *fault,
                         struct error *error);
// Traces any pixels; `rgba` has 4 floats for each.
bool pixel_audit_trace(const struct pixel_audit *audit, const struct pixel *points, size_t count, float *rgba,
                       enum renderer_fault *fault, struct error *error);
