// The grid of scattered light: where its nodes lie, and which media share its values.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"
#include "worker/glsl/frame_uniforms.h"

#include <stdbool.h>
#include <stddef.h>

enum { SCATTER_GRID_ROW = 64 };

struct error;
struct job;
struct scene_inputs;
struct scene_model;

// A node has the light that arrives there already scattered and would be scattered towards the camera, W/(m^2 sr),
// for one metre of medium whose scattering coefficient is 1: the mean of radiance over the phase function. Media of the
// same phase function share values; each set of values is a grid of its own, one behind the other in the texture.
struct scatter_grid {
    const struct job *job;             // borrowed; outlives us
    const struct scene_inputs *inputs; // borrowed; outlives us. NULL where the job reads no files
    size_t media[SCENE_MEDIUM_LIMIT];  // those that scatter
    size_t medium_count;
    size_t groups[SCENE_MEDIUM_LIMIT];  // by medium of the scene: its set of values; only of those that scatter
    size_t leaders[SCENE_MEDIUM_LIMIT]; // by group: a medium with its phase function
    size_t group_count;
    int nodes[3];  // along the world's axes, those of one group
    double cell_m; // the longest side of a cell when the frame begins
    // Particles from the lights fill it, else walks from the nodes. Where the job leaves it open and no medium emits,
    // they do for spheres, images of domes, and lamps that come into the box.
    bool is_from_lights;
    bool is_rgb;
    bool is_still; // the box that holds the media does not move
};

// The nodes' box at a moment, m: the first nodes lie in its low corner, the last ones in its high one.
struct scatter_grid_box {
    double low[3], size[3];
};

// Initializes the grid of a model that has one. The box is that of the media that scatter; returns false where these
// have no end.
bool scatter_grid_init(struct scatter_grid *grid, const struct scene_model *model);
struct scatter_grid_box scatter_grid_place(const struct scatter_grid *grid, double time);
// Adds scatter_grid_low and scatter_grid_size, for programs that look the grid up and the one that fills it. The grid
// outlives the values.
void scatter_grid_add_values(struct frame_uniforms *uniforms, const struct scatter_grid *grid);
// True where walks go on through similar media (quality.similar_after).
bool scatter_grid_is_similar(const struct scatter_grid *grid);
// The nodes of one set of values.
size_t scatter_grid_node_count(const struct scatter_grid *grid);
// How many invocations share the walks of a node, so that those beside each other have as many: 1 where nodes are many.
int scatter_grid_lane_count(const struct scatter_grid *grid);
// The cells a side of the lights' grids that walks have where a frame has none: about as long as its steps towards
// lights, so that walks see as much detail as the march does; 48 without such steps. All lights' together have no more
// cells than one of 192 has. Few sizes, 48 to 192: programs have them as constants.
int scatter_grid_light_cells(const struct scatter_grid *grid);
// Fails, naming quality.scatter_grid, where the grid and what fills it take more than 512 MiB.
bool scatter_grid_check_size(const struct scatter_grid *grid, struct error *error);
// How many invocations send the particles that fill a grid, in rows of SCATTER_GRID_ROW.
int scatter_grid_row_count(const struct scatter_grid *grid);
// Adds scatter_grid_nodes, the number along each axis, and scatter_grid_sent, the particles of an invocation.
void scatter_grid_add_sent(struct frame_uniforms *uniforms, const struct scatter_grid *grid);
// Adds scatter_grid_paths, the walks that begin at a node, for the program that fills the grid.
void scatter_grid_add_paths(struct frame_uniforms *uniforms, const struct scatter_grid *grid);
