// Marks of pixels that went wrong: an alpha that no picture has, nor a mean of up to 1024 samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

struct error;
struct scene;

// Alpha below this is a mark. Estimates of transmittance may make alpha a little negative.
#define PIXEL_MARK_LEAST (-100.0f)
// The driver cut the march.
#define PIXEL_MARK_CUT (-1e6f)
// This times PIXEL_MARK_FACTOR to the power of the medium: its density was found above its majorant.
#define PIXEL_MARK_MAJORANT (-1e10f)
#define PIXEL_MARK_FACTOR 2048.0f

enum pixel_mark { PIXEL_MARK_IS_NONE, PIXEL_MARK_IS_CUT, PIXEL_MARK_IS_MAJORANT };

// Finds the first marked pixel of `count`; `at` is its index. For a majorant `medium` is set to the medium.
enum pixel_mark pixel_mark_find(const float *rgba, size_t count, size_t *at, int *medium);
// Says why such a frame fails, and which medium of the job it is.
void pixel_mark_tell_majorant(const struct scene *scene, int medium, struct error *error);
