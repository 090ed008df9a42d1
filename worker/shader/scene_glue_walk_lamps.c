// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_walk_lamps.h"

#include "core/job/job.h"
#include "worker/model/scene_model.h"

#include <stddef.h>

bool scene_glue_walk_knows_lamps(const struct scene_model *model)
{
    const struct scene_features *features = &model->features;

    if (model->job->scene.orders == 1 || !features->media_are_lit) return false;
    return scene_features_count_marched(features) > 0 && (!features->tracks_to_lights || features->has_light_grids);
}

void scene_glue_write_walk_lamps(FILE *out, const struct scene_model *model)
{
    size_t lamp = 0;

    fprintf(out, "const int WALK_LAMPS = %zu;\n", scene_features_count_marched(&model->features));
    fputs("int walk_lamp_draw()\n{\n"
          "    return WALK_LAMPS > 1 ? min(int(walk_random() * float(WALK_LAMPS)), WALK_LAMPS - 1) : 0;\n}\n"
          "LightSample walk_lamp_seen(int lamp, vec3 point, out float passed)\n{\n"
          "    LightSample light = LightSample(vec3(0.0), 0.0, spectrum(0.0));\n    passed = 0.0;\n",
          out);
    for (size_t i = 0; i < model->job->scene.light_count; i++) {
        if (!model->features.light_is_marched[i]) continue;
        fprintf(out,
                "    if (lamp == %zu) {\n        light = light_%zu(point);\n"
                "        passed = spectrum_mean(walk_reached_%zu(point, 0u, light));\n    }\n",
                lamp++, i, i);
    }
    fputs("    return light;\n}\n", out);
}
