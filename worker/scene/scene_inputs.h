// Files that a frame reads, for media, textures and a dome: what they hold, and what follows for the march.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "core/job/job.h"
#include "worker/scene/texture_input.h"
#include "worker/sparse/brick_store.h"
#include "worker/volume/file_hashes.h"
#include "worker/volume/volume.h"

#include <stdbool.h>
#include <stdint.h>

struct error;

enum { SCENE_INPUT_FILE_LIMIT = 2 }; // a header and its voxels

struct scene_input {
    const struct scene_grid *source;   // borrowed from the job; NULL: the medium reads no file
    char *path;                        // owned; this frame's
    bool is_sequence;                  // one file a frame
    struct volume header;              // closed: without its layout
    const struct brick_volume *bricks; // of a sparse grid, whose header is that of its active voxels' box; else NULL
    // Hash of the contents and of how they are read; empty when only described.
    char hash[HASH_TEXT_SIZE];
    struct {
        char *path; // owned
        struct file_version version;
    } files[SCENE_INPUT_FILE_LIMIT];
    size_t file_count;
};

// What is kept of files from frame to frame.
struct scene_files {
    struct file_hashes *hashes; // owned
    struct brick_store *bricks; // owned
};

void scene_files_init(struct scene_files *files);
void scene_files_finish(struct scene_files *files); // accepts an empty one; no inputs are open

// The zero value is that of a scene without files.
struct scene_inputs {
    const struct scene *scene; // borrowed; outlives us
    int32_t frame;
    struct brick_store *bricks;                        // borrowed; outlives us. NULL when only described
    struct scene_input media[SCENE_MEDIUM_LIMIT];      // by medium
    struct texture_input textures[SCENE_OBJECT_LIMIT]; // by object
    struct texture_input dome;                         // of the scene's one dome, if it shows an image
    bool is_unneeded[SCENE_MEDIUM_LIMIT]; // the frame shows nothing of the medium; set by scene_visibility_find
    // The job's quality with its steps in metres.
    struct job_quality quality;
    // Hash of all files; empty when there are none, or when only described.
    char files_hash[HASH_TEXT_SIZE];
    // Hash of all that the frame's picture depends on: the job and the files.
    char picture_hash[HASH_TEXT_SIZE];
};

// Opens the files of frame `frame`, headers only. With `files` (NULL: describe only) the contents are hashed too. On
// failure `is_lasting` (may be NULL) says whether every frame and attempt would fail alike. `job` outlives `inputs`.
bool scene_inputs_open(struct scene_inputs *inputs, const struct job *job, int32_t frame,
                       const struct scene_files *files, bool *is_lasting, struct error *error);
// True when a file that cannot be read fails every frame and attempt: none is a sequence or being written.
bool scene_inputs_are_lasting(const struct scene_inputs *inputs);
void scene_inputs_finish(struct scene_inputs *inputs); // accepts an empty one
// Starts reading ahead, in the background, the files of frame `frame` that allow it.
void scene_inputs_expect(const struct job *job, int32_t frame, const struct scene_files *files);
// Returns false, with the reason, when a file of the input has changed since it was hashed.
bool scene_input_check(const struct scene_input *input, struct error *error);

// Returns the shortest edge of the finest grid's voxels, m; INFINITY where no medium has a grid.
double scene_inputs_find_voxel(const struct scene_inputs *inputs);

// Opens the input's voxels for reading.
bool scene_input_open_volume(const struct scene_input *input, struct volume **volume, struct error *error);
// Finds the map from voxel (i, j, k)'s centre to metres at a time, row-major 3x4, with the grid's centre where the job
// wants it.
void scene_input_find_matrix(const struct scene_input *input, double time, double index_to_world[static 12]);
// Finds the smallest box along the world's axes, in metres, that holds the grid at that time.
void scene_input_box(const struct scene_input *input, double time, double low[static 3], double high[static 3]);
