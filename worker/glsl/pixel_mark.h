// What shaders say of a pixel that went wrong, in an alpha that no picture has, nor has a mean of up to 1024 samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

struct error;
struct scene;

// Below it something is marked: estimates of what is left may make alpha a little negative.
#define PIXEL_MARK_LEAST (-100.0f)
// The driver cut the march.
#define PIXEL_MARK_CUT (-1e6f)
// Times PIXEL_MARK_FACTOR to the power of the medium: its density was found above its majorant.
#define PIXEL_MARK_MAJORANT (-1e10f)
#define PIXEL_MARK_FACTOR 2048.0f

enum pixel_mark { PIXEL_MARK_IS_NONE, PIXEL_MARK_IS_CUT, PIXEL_MARK_IS_MAJORANT };

// Of the first of `count` pixels that is marked, if any, which is `at`; of a majorant `medium` becomes whose it is.
enum pixel_mark pixel_mark_find(const float *rgba, size_t count, size_t *at, int *medium);
// Why such a frame fails, by the medium's place in the job.
void pixel_mark_tell_majorant(const struct scene *scene, int medium, struct error *error);
