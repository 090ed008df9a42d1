// The texture that tells shaders which pixel of a list they draw: shaders/camera/pixel.glsl.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct gl_functions;
struct pixel_layout;

// The zero value is empty.
struct gl_pixel_list {
    const struct gl_functions *gl; // borrowed; outlives us
    unsigned texture;              // RG16UI
    int width_px, height_px;
};

// False where GL cannot draw points as large as a square.
bool gl_pixel_list_check(const struct gl_functions *gl, struct error *error);

enum { GL_PIXEL_LIST_IMAGE_UNIT = 3 }; // after those of gl_slices

// Fills the texture with the list's pixels, at the places where the layout draws them, and binds it as an image. GL
// reports it when there is no memory.
void gl_pixel_list_bind(struct gl_pixel_list *list, const struct gl_functions *gl, const struct pixel_layout *layout);
void gl_pixel_list_finish(struct gl_pixel_list *list); // accepts an empty one
// Makes a program draw the bound list's pixels; NULL: the frame's.
void gl_pixel_list_choose(const struct gl_functions *gl, unsigned program, const struct pixel_layout *layout);
// Draws some squares of the list by one call: software GL copies its state for each draw with another scissor, which
// takes as long as tens of pixels.
void gl_pixel_list_draw(const struct gl_functions *gl, int first, int count);
