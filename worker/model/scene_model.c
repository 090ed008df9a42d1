// SPDX-License-Identifier: Apache-2.0
#include "worker/model/scene_model.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/scene/scene_inputs.h"

bool scene_model_init(struct scene_model *model, const struct job *job, const struct scene_inputs *inputs,
                      struct error *error)
{
    *model = (struct scene_model){0};
    for (size_t i = 0; i < job->scene.medium_count; ++i)
        if (!density_kind_of(&job->scene.media[i].density)) {
            char place[64];

            scene_format_medium_place(&job->scene, i, place, sizeof place);
            error_set(error, "%s.density: its kind cannot be rendered yet", place);
            return false;
        }
    *model = (struct scene_model){
        .job = job, .inputs = inputs, .features = scene_features_of(job, inputs ? inputs->is_unneeded : NULL)};
    return true;
}

const struct job_quality *scene_model_quality(const struct scene_model *model)
{
    return model->inputs ? &model->inputs->quality : &model->job->quality;
}

struct density_site scene_model_site(const struct scene_model *model, size_t medium)
{
    return (struct density_site){
        .job = model->job, .medium = medium, .source = &model->job->scene.media[medium], .inputs = model->inputs};
}
