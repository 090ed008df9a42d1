// Points of the stability map about sparse pixels: larger pictures, compared with the same frame of every pixel.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct gl_context;
struct stability_method;
struct stability_point;
struct stability_sweep;

// As stability_measure, for a sweep that is_sparse.
bool stability_sparse_measure(struct gl_context *context, const struct stability_sweep *sweep,
                              const struct stability_method *method, struct stability_point *points);
