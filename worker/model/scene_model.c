// SPDX-License-Identifier: Apache-2.0
#include "worker/model/scene_model.h"

#include "core/job/job.h"
#include "worker/scene/scene_inputs.h"

void scene_model_init(struct scene_model *model, const struct job *job, const struct scene_inputs *inputs)
{
    *model = (struct scene_model){
        .job = job, .inputs = inputs, .features = scene_features_of(job, inputs ? inputs->is_unneeded : NULL)};
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
