// What the programs that fill the grid of scattered light have in common: the media that walks fly through.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct light_grid;
struct scatter_grid;
struct scene_cache;
struct scene_model;
struct shader_assembly;

struct scatter_grid_program {
    const struct scatter_grid *grid;
    const struct scene_model *walked;     // of the walks: its features have fills_grid
    const struct light_grid *light_grids; // of the visible lights, in order, where the walks' model has light grids
    size_t light_grid_count;
    uint64_t reads; // bit i: it samples cache i of the program
};

// Begins a program's text with the media that walks fly through: their uniforms, spans, fields, majorants.
void scatter_media_glue_add(struct shader_assembly *text, const struct scatter_grid_program *program,
                            const struct scene_cache *cache);
// True where media that walks meet come from the frame's files.
bool scatter_media_glue_reads_files(const struct scatter_grid_program *program);
