// The light that some pixels of a picture should show, with their weights: a chart's truth.
// SPDX-License-Identifier: Apache-2.0
// It is found once, kept in a file, and compared with the pictures of all methods.
#pragma once

#include "core/base/hash.h"
#include "core/job/job.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct image;
struct truth_pixel;
struct pixel;

struct chart_truth_pixel {
    int x, y;
    double weight; // the number of the picture's pixels that it stands for
    double rgb[3];
    double variance; // of the difference from a picture by random normals or paths, summed over the three values
};

enum { CHART_TRUTH_KIND_SIZE = 16 };

// The zero value is empty.
struct chart_truth {
    char scene[HASH_TEXT_SIZE];       // hash of the scene and the frame
    char kind[CHART_TRUTH_KIND_SIZE]; // "reference", or "midpoint": the finest march of code that has no twin
    struct chart_truth_pixel *pixels; // owned
    size_t count;
};

void chart_truth_finish(struct chart_truth *truth);
// Writes a text file with one line per pixel.
bool chart_truth_save(const struct chart_truth *truth, const char *path, struct error *error);
// False when there is no such file, or it is the truth of another scene; `error` says which.
bool chart_truth_load(struct chart_truth *truth, const char *path, const char *scene, struct error *error);

struct chart_error {
    double relative_rmse; // sqrt(mean (I - R)^2) / sqrt(mean R^2); the numerator alone if the picture is black
    double largest;       // |I - R| over the measured pixels
};

// Compares values as encoded in `pixel`. A value that is not finite makes the errors infinite.
struct chart_error chart_truth_compare(const struct chart_truth *truth, const struct image *image,
                                       enum job_pixel pixel);

struct chart_truth_params {
    const struct job *job; // with the picture's size and samples, and the quality of `finer`
    int32_t frame;
    const struct image *finer, *coarser; // renders of the picture's size, `finer` in shorter steps
    double seconds;                      // that the search may take
    const struct image *finest;          // the picture that counts as truth for code that has no twin; else NULL
    bool (*is_wanted)(void *user);
    void *user;
};

// Measures all pixels if there is time, else pixels drawn by importance. False when the answer is no longer wanted,
// there is too little time, or the frame's input files cannot be read.
bool chart_truth_find(struct chart_truth *truth, const struct chart_truth_params *params, struct error *error);
