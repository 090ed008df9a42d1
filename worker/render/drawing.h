// Draws a frame tile by tile, so that it can be stopped and a frame that GL cuts short is noticed early.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/gl/gl_debug.h"
#include "worker/gl/gl_functions.h"
#include "worker/gl/gl_programs.h"
#include "worker/picture/pixel.h"
#include "worker/render/gl_pixel_list.h"
#include "worker/render/gl_slices.h"
#include "worker/render/gl_target.h"
#include "worker/render/renderer_fault.h"

#include <stdbool.h>
#include <stddef.h>

struct error;
struct gl_caches;
struct gl_context;
struct passes;
struct pixel_layout;
struct scene_program;

// The GL objects that drawings use, kept from frame to frame. GL keeps the struct's address.
struct drawing_tools {
    struct gl_functions gl;
    struct gl_debug debug;
    struct gl_programs programs;
    struct gl_caches *caches;             // owned
    struct gl_target target, list_target; // of frames, and of lists of pixels
    struct gl_pixel_list list;
    struct gl_slices slices;
    unsigned vertex_array, uniform_buffer;
};

// Returns false, with the reason and empty tools, where GL lacks a function.
bool drawing_tools_init(struct drawing_tools *tools, const struct gl_context *context, struct error *error);
void drawing_tools_finish(struct drawing_tools *tools); // accepts empty ones

// Called with the share done in [0, 1]; false stops the frame.
typedef bool drawing_progress(void *user, double done);

// One frame, or a list of its pixels, that is drawn. All that it points to is borrowed and outlives it.
struct drawing {
    struct drawing_tools *tools;
    const struct scene_program *scene;
    const struct passes *passes;
    const struct pixel_layout *layout; // NULL: the whole frame
    drawing_progress *on_progress;     // may be NULL
    void *user;
    double done;                  // share of the frame, in [0, 1]
    double steps;                 // that random paths took, those of pixels that fill up a list among them
    struct kept_program *program; // set by drawing_find_program
    // The fault is set whenever a function here returns false.
    enum renderer_fault fault;
    struct pixel marked_pixel; // the pixel that the shader marked as cut
    int marked_medium;         // the medium whose majorant the shader found too small
};

// The target of frames, or that of lists.
struct gl_target *drawing_target(const struct drawing *drawing);
bool drawing_find_program(struct drawing *drawing, struct error *error);
// Makes a target for `params`, unless the one there is fits.
bool drawing_fit_target(struct drawing *drawing, const struct gl_target_params *params, struct error *error);
// Fills the caches that the scene samples, then draws all passes into the target. The scene's files are bound.
bool drawing_run(struct drawing *drawing, struct error *error);

// The steps that random paths of the frame or the list took; roughly, as pixels that fill up a list count like others.
double drawing_count_steps(const struct drawing *drawing);

// Reports progress; false when the frame is to stop. `user` is the drawing.
bool drawing_report(void *user);
// Returns false when GL reported an error since the last check.
bool drawing_check_gl(struct drawing *drawing, struct error *error);
// Returns false when a shader marked one of the pixels of the frame or of the list, 4 floats each in its order.
bool drawing_check_marks(struct drawing *drawing, const float *rgba, size_t count);
