// Densities that are baked: put into a grid before the picture is drawn, and looked up there.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct density_site;
struct job;

// Values stand at the corners of the grid's cells. Its middle is the centre of the medium's bounds.
struct density_bake {
    int corners[3]; // along each of its axes, which the density's kind knows
    double cell_m;  // a cell's side
    double half_size
        [3]; // m: it begins at minus this; its last corners lie there on the other side, or a part of a cell beyond
};

// False where a medium's density is taken as it is: the job asks for no grid, its kind is not for that or gains nothing, or its
// bounds fit into no box.
bool density_bake_find(struct density_bake *bake, const struct job *job, size_t medium);
struct density_bake density_bake_of(const struct density_site *site); // of a medium that is baked
// Half the sides of a box along the world's axes that holds the medium's bounds throughout the job; false where there is none.
bool density_bake_find_bounds(double half_size[static 3], const struct density_site *site);
// Emits float medium_I_baked(vec3 p), p as density_kind.write_baked has it: what the grid has there, between corners trilinear.
void density_bake_write_lookup(FILE *out, const struct density_site *site);
