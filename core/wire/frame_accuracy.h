// How exact a frame is: as workers report it, the store keeps it and users read it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct json_node;
struct json_writer;

enum { FRAME_ACCURACY_TEXT_SIZE = 24, FRAME_ACCURACY_PHRASE_SIZE = 64 };

// The zero value: nothing is known.
struct frame_accuracy {
    // What the frame's light was compared with, "reference" or "step_halving". Empty: the job states no tolerance, and
    // the members up to `method` are unknown.
    char audit[FRAME_ACCURACY_TEXT_SIZE];
    double error;                          // relative RMSE, estimated from the pixels compared
    double error95;                        // upper bound of `error` with a confidence of 95 %
    int audit_rays;                        // pixels compared
    char method[FRAME_ACCURACY_TEXT_SIZE]; // the rendering method chosen for the frame
    int64_t plan;                          // the number of its plan; 0: unknown
    bool is_missed;                        // `error` is over the job's tolerance, and the job publishes such frames
    bool has_cut_share;                    // only in scenes whose rays are reflected or refracted
    double cut_share; // the largest share of the frame's light that cut rays may have carried, [0, 1]
    double traced;    // share of the frame's samples that were traced, (0, 1]; 0: no setting lets any be interpolated
};

// True when the error is known and over `tolerance`; false where that is 0.
bool frame_accuracy_is_over(const struct frame_accuracy *accuracy, double tolerance);
// The error and its bound, such as "0.5 % (95 %: below 0.75 %)". An estimate is 0 where chance makes it vanish, which
// does not say that the frame is exact: "at most 0.75 % (with 95 %)".
void frame_accuracy_describe(const struct frame_accuracy *accuracy, char text[static FRAME_ACCURACY_PHRASE_SIZE]);
// Writes the members that are known: audit, measured_error, error95, audit_rays, method, plan, and missed where it is
// true; cut_share; traced. (`error` is the text of a failure in every message.)
void frame_accuracy_write(const struct frame_accuracy *accuracy, struct json_writer *writer);
// Members that are absent or null are unknown. On failure `accuracy` is the zero value.
bool frame_accuracy_read(struct frame_accuracy *accuracy, const struct json_node *object, struct error *error);
