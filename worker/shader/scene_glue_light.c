// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_light.h"

#include "core/job/job.h"
#include "core/scene/light_rules.h"
#include "worker/glsl/texture_units.h"
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

static void write_call(FILE *out, const struct scene_light *light, size_t i, const char *function)
{
    fprintf(out, "    return %s%s(", light_kind_of(light)->function, function);
    scene_glue_light_write_value(out, light, i);
}

static void write_image(FILE *out, const struct scene_light *light, size_t i)
{
    fprintf(out,
            "layout(binding = %d) uniform sampler2D light_%zu_image;\n"
            "layout(binding = %d) uniform sampler2D light_%zu_table;\n"
            "vec3 light_%zu_draw()\n{\n"
            "    vec2 rows = vec2(walk_random(), walk_random());\n"
            "    vec2 columns = vec2(walk_random(), walk_random());\n"
            "    vec2 inside = vec2(walk_random(), walk_random());\n",
            TEXTURE_UNIT_DOME, i, TEXTURE_UNIT_DOME_TABLE, i, i);
    write_call(out, light, i, "_draw");
    fprintf(out, ", light_%zu_image, light_%zu_table, rows, columns, inside);\n}\n", i, i);
    fprintf(out, "float light_%zu_density(vec3 toward)\n{\n", i);
    write_call(out, light, i, "_density");
    fprintf(out, ", light_%zu_image, light_%zu_table, toward);\n}\n", i, i);
}

static void write_dome(FILE *out, const struct scene_light *light, size_t i)
{
    if (light_kind_of(light)->has_image) write_image(out, light, i);
    fprintf(out, "Spectrum light_%zu_radiance(vec3 toward)\n{\n", i);
    write_call(out, light, i, "_radiance");
    if (light_kind_of(light)->has_image) fprintf(out, ", light_%zu_image", i);
    fputs(", toward);\n}\n", out);
}

void scene_glue_light_write_functions(FILE *out, const struct scene_light *light, size_t i)
{
    const struct light_kind *kind = light_kind_of(light);

    if (kind->is_dome) {
        write_dome(out, light, i);
        return;
    }
    fprintf(out, "LightSample light_%zu(vec3 point)\n{\n", i);
    write_call(out, light, i, "");
    fprintf(out, "%s%s);\n}\n", light_rules_of(light->kind)->has_position ? ", point" : "",
            kind->is_sphere ? ", vec2(walk_random(), walk_random())" : "");
}

void scene_glue_light_write_behind(FILE *out, const struct scene_model *model, const char *direction)
{
    if (!model->features.dome_is_behind) fputs("background", out);
    for (size_t i = 0; model->features.dome_is_behind && i < model->job->scene.light_count; ++i)
        if (model->job->scene.lights[i].dome.is_visible) fprintf(out, "light_%zu_radiance(%s)", i, direction);
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
