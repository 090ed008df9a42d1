// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_light.h"

#include "core/job/job.h"
#include "core/scene/light_rules.h"
#include "worker/model/light_kind.h"
#include "worker/model/scene_model.h"

void scene_glue_light_write_value(FILE *out, const struct scene_light *light, size_t i)
{
    const struct light_kind *kind = light_kind_of(light);

    fprintf(out, "%s(light_%zu_intensity", kind->structure, i);
    for (size_t k = 0; k < LIGHT_VALUE_LIMIT && kind->values[k]; ++k)
        fprintf(out, ", light_%zu_%s", i, kind->values[k]->name);
    fputs(")", out);
}

void scene_glue_light_write_function(FILE *out, const struct scene_light *light, size_t i)
{
    fprintf(out, "LightSample light_%zu(vec3 point)\n{\n    return %s(", i, light_kind_of(light)->function);
    scene_glue_light_write_value(out, light, i);
    fprintf(out, "%s);\n}\n", light_rules_of(light->kind)->has_position ? ", point" : "");
}

void scene_glue_light_write_sample(FILE *out, const struct scene_model *model, size_t i)
{
    const struct scene_features *features = &model->features;
    const struct scene_light *light = &model->job->scene.lights[i];

    if (!features->has_peaks || !light_kind_of(light)->is_inverse_square) {
        fprintf(out, "light_%zu(point);\n", i);
        return;
    }
    if (light_kind_of(light)->is_spot)
        fprintf(out, "light_spot_%s(", features->is_gauss ? "node" : "segment");
    else
        fputs("light_point_segment(", out);
    scene_glue_light_write_value(out, light, i);
    fprintf(out, ", point, direction, length, %s, %s);\n",
            features->is_gauss || features->is_jittered ? "offset" : "0.5 * length",
            features->is_gauss ? "0.25" : "0.99 * LIGHT_POINT_SHARE");
}
