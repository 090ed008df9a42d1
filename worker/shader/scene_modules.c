// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_modules.h"

#include "core/job/job.h"
#include "worker/density/density_modules.h"
#include "worker/glsl/shader_assembly.h"
#include "worker/model/light_kind.h"
#include "worker/model/scene_model.h"

void scene_modules_add_density(struct shader_assembly *text, const struct scene_model *model, size_t medium)
{
    const struct density_site site = scene_model_site(model, medium);
    const struct density_kind *kind = density_kind_of(&site.source->density);

    density_modules_add(text, &site);
    if (model->features.has_majorants && kind->majorant_module) shader_assembly_add(text, kind->majorant_module);
}

static void add_phase(struct shader_assembly *text, const struct scene_medium *medium,
                      const struct medium_features *features)
{
    static const char *const modules[] = {[LOBE_ISOTROPIC] = "phase/isotropic.glsl",
                                          [LOBE_HENYEY_GREENSTEIN] = "phase/henyey_greenstein.glsl",
                                          [LOBE_RAYLEIGH] = "phase/rayleigh.glsl"};

    if (medium->lobe_count == 0) shader_assembly_add(text, "phase/isotropic.glsl");
    for (size_t i = 0; i < medium->lobe_count; ++i)
        if (features->lobes[i] != LOBE_UNSEEN) shader_assembly_add(text, modules[features->lobes[i]]);
}

static void add_light(struct shader_assembly *text, const struct light_kind *kind)
{
    for (size_t i = 0; i < LIGHT_MODULE_LIMIT && kind->modules[i]; ++i)
        shader_assembly_add(text, kind->modules[i]);
}

void scene_modules_add_lights(struct shader_assembly *text, const struct scene_model *model)
{
    const struct scene *scene = &model->job->scene;
    const struct scene_features *features = &model->features;

    for (size_t i = 0; i < scene->medium_count; ++i)
        if (features->media[i].scatters) add_phase(text, &scene->media[i], &features->media[i]);
    shader_assembly_add(text, "light/sample.glsl");
    for (size_t i = 0; i < scene->light_count; ++i)
        if (features->light_is_seen[i]) add_light(text, light_kind_of(&scene->lights[i]));
}

void scene_modules_add_draws(struct shader_assembly *text, const struct scene_model *model)
{
    for (size_t i = 0; i < model->features.medium_count; ++i)
        for (size_t k = 0; k < model->job->scene.media[i].lobe_count; ++k) {
            if (model->features.media[i].lobes[k] == LOBE_HENYEY_GREENSTEIN)
                shader_assembly_add(text, "scatter/sample_henyey_greenstein.glsl");
            if (model->features.media[i].lobes[k] == LOBE_RAYLEIGH)
                shader_assembly_add(text, "scatter/sample_rayleigh.glsl");
        }
    shader_assembly_add(text, "scatter/turn.glsl");
}
