// How exact a frame proved: as workers tell it, the store keeps it and users read it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct json_node;
struct json_writer;

enum { FRAME_ACCURACY_TEXT_SIZE = 24 };

// The zero value is of a frame of which nothing is known.
struct frame_accuracy {
    char audit
        [FRAME_ACCURACY_TEXT_SIZE]; // "reference" or "step_halving", what its light was compared with; empty: it was
                                    // not, since its job states no tolerance, and up to `method` nothing is known
    double error;                   // relative RMSE, estimated from the pixels compared
    double error95;                 // that is below this, with a confidence of 95 %
    int audit_rays;                 // pixels compared
    char method[FRAME_ACCURACY_TEXT_SIZE]; // that was chosen for it
    bool has_cut_share;                    // of scenes whose rays are reflected or refracted
    double cut_share;                      // the largest share of its light that cut rays may have taken, [0, 1]
};

// Members of an object, those that are known: audit, measured_error, error95, audit_rays, method; cut_share. (`error` is a
// failure's text in every message.)
void frame_accuracy_write(const struct frame_accuracy *accuracy, struct json_writer *writer);
// Members that are absent or null are not known. On failure `accuracy` is the zero value.
bool frame_accuracy_read(struct frame_accuracy *accuracy, const struct json_node *object, struct error *error);
