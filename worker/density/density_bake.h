// Densities that are baked: evaluated on a grid before the picture is drawn, and interpolated there.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct density_site;
struct frame_uniforms;
struct job;

// The grid of a density. Values stand at the corners of cells; the middle is the centre of the medium's bounds.
struct density_bake {
    int corners[3];      // along the grid's axes, which the density's kind knows
    double cell_m;       // a cell's side
    double half_size[3]; // m; the first corners are at minus this, the last at plus this or a part of a cell beyond
};

// Returns false where a medium's density is not baked: the job asks for no grid, the kind does not allow it or gains
// nothing, or the bounds fit into no box.
bool density_bake_find(struct density_bake *bake, const struct job *job, size_t medium);
struct density_bake density_bake_of(const struct density_site *site); // the medium is baked
// Finds half the sides of a box along the world's axes that holds the medium's bounds throughout the job. Returns false
// where there is none.
bool density_bake_find_bounds(double half_size[static 3], const struct density_site *site);
// Adds a number that follows from density_grid, so that all grids share programs: the frame value
// medium_I_grid_NAME.
void density_bake_add_number(struct frame_uniforms *uniforms, size_t medium, const char *name, double number);
// Adds the frame values that the lookup uses. The medium is baked.
void density_bake_add_values(struct frame_uniforms *uniforms, const struct density_site *site);
// Writes float medium_I_baked(vec3 p): the trilinear interpolation of the grid; p is as for density_kind.write_baked.
void density_bake_write_lookup(FILE *out, const struct density_site *site);
