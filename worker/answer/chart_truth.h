// The light that some pixels of a picture should show, with what each counts.
// SPDX-License-Identifier: Apache-2.0
// It is found once, kept in a file, and compared with as many pictures as there are methods.
#pragma once

#include "core/base/hash.h"
#include "core/job/job.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct image;
struct truth_pixel;
struct truth_point;

struct chart_truth_pixel {
    int x, y;
    double weight; // how many pixels of the picture it stands for
    double rgb[3];
    double variance; // of the three values together, by the lot of rough surfaces, counted as audits do
};

enum { CHART_TRUTH_KIND_SIZE = 16 };

// The zero value is empty.
struct chart_truth {
    char scene[HASH_TEXT_SIZE];       // of what it is the truth of
    char kind[CHART_TRUTH_KIND_SIZE]; // "reference" or "midpoint": the finest march of code that has no twin
    struct chart_truth_pixel *pixels; // owned
    size_t count;
};

void chart_truth_finish(struct chart_truth *truth);
// A text, a line a pixel.
bool chart_truth_save(const struct chart_truth *truth, const char *path, struct error *error);
// False when there is no such file, or not of `scene`; `error` says which.
bool chart_truth_load(struct chart_truth *truth, const char *path, const char *scene, struct error *error);

struct chart_error {
    double relative_rmse; // sqrt(mean (I - R)^2) / sqrt(mean R^2), the numerator alone where all light is below 1e-6
    double largest;       // |I - R| of the measured pixels
};

// Values as encoded in `pixel`. One that is not finite makes the errors infinite.
struct chart_error chart_truth_compare(const struct chart_truth *truth, const struct image *image,
                                       enum job_pixel pixel);

struct chart_truth_params {
    const struct job *job; // its size and samples are the picture's; its quality is that of `finer`
    int32_t frame;
    const struct image *finer, *coarser; // of the picture's size, in steps of which the first's are shorter
    double seconds;                      // that finding it may take
    const struct image *finest;          // of code that has no twin: the picture that counts as truth; else NULL
    bool (*is_wanted)(void *user);
    void *user;
};

// Measures all pixels where there is time for that, else such as are drawn by importance. False when it is not wanted any
// more, or the frame's files cannot be read.
bool chart_truth_find(struct chart_truth *truth, const struct chart_truth_params *params, struct error *error);
