// A frame's scene as its shaders are written: the parts that are modelled, and the files that they come from.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/density/density_kind.h"
#include "worker/model/scene_features.h"

struct job;
struct job_quality;
struct scene_inputs;

// The zero value is empty.
struct scene_model {
    const struct job *job;             // borrowed; outlives us
    const struct scene_inputs *inputs; // borrowed; outlives us. The frame's; NULL where the job reads no files
    struct scene_features features;
};

void scene_model_init(struct scene_model *model, const struct job *job, const struct scene_inputs *inputs);
// Returns the job's quality. Where the frame reads files, steps in voxels have become metres there.
const struct job_quality *scene_model_quality(const struct scene_model *model);
// Returns the medium of that index, as its density's kind is asked about it.
struct density_site scene_model_site(const struct scene_model *model, size_t medium);
