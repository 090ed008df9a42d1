// Which GPUs a worker tries, and in which order, so that the workers of a machine share them. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

// A device that EGL lists.
struct gl_device {
    bool is_software;
    int cuda_number; // as EGL_NV_device_cuda tells it; -1: unknown
    char uuid[40];   // 8-4-4-4-12; empty when unknown
};

// Reads "turn:N", with N in [0, 9999].
bool gl_device_read_turn(const char *text, int *turn);
// Fills `order`, of at least `count`, with the indices of the GPUs to try; returns how many they are. The worker whose
// turn is N begins with the N-th, and after the last comes the first.
// `visible` is CUDA_VISIBLE_DEVICES (NULL: not set), as Slurm sets it for the GPUs that it lends: only GPUs that it
// names by number or UUID are tried, in its order. A number is the driver's for CUDA or, where it tells none, that of
// the GPU among those listed. If none of its entries is known, all GPUs are tried; if it has no entries, none.
size_t gl_device_order(const struct gl_device *devices, size_t count, int turn, const char *visible, int *order);
