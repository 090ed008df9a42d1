// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/texture_glue.h"

#include "core/job/job.h"
#include "worker/glsl/texture_units.h"
#include "worker/model/scene_model.h"
#include "worker/scene/scene_inputs.h"

#include <stdbool.h>

const char *const *texture_glue_modules(const struct job *job, size_t object)
{
    static const char *const names[2][3][5] = {
        {{"texture/tile.glsl", "texture/linear.glsl", "texture/sphere.glsl", NULL},
         {"texture/tile.glsl", "texture/linear.glsl", "texture/plane.glsl", NULL},
         {"texture/tile.glsl", "texture/linear.glsl", "texture/plane.glsl", "texture/sphere.glsl", NULL}},
        {{"texture/tile.glsl", "texture/nearest.glsl", "texture/sphere.glsl", NULL},
         {"texture/tile.glsl", "texture/nearest.glsl", "texture/plane.glsl", NULL},
         {"texture/tile.glsl", "texture/nearest.glsl", "texture/plane.glsl", "texture/sphere.glsl", NULL}}};
    const struct scene_object *source = &job->scene.objects[object];
    size_t sphere_count = 0;

    for (size_t i = 0; i < source->shape_count; ++i)
        sphere_count += job->scene.shapes[source->first_shape + i].kind == SCENE_SHAPE_SPHERE;
    return names[source->material.texture.is_nearest][sphere_count == source->shape_count ? 0
                                                      : sphere_count == 0                 ? 1
                                                                                          : 2];
}

// Writes the expression of the uv coordinates of p.
static void write_uv(FILE *out, const struct scene_shape *shape, const struct texture_input *input, size_t index)
{
    double tile[2];

    if (shape->kind == SCENE_SHAPE_SPHERE) {
        fprintf(out, "texture_sphere_uv(surface_sphere_normal(shape_%zu(), p))", index);
        return;
    }
    texture_input_find_tile(input, tile);
    if (shape->kind == SCENE_SHAPE_BOX)
        fprintf(out, "texture_plane_uv(p - shape_%zu().center, surface_box_normal(shape_%zu(), p)", index, index);
    else
        fprintf(out, "texture_plane_uv(p - shape_%zu().point, shape_%zu().normal", index, index);
    fprintf(out, ", vec2(%.9e, %.9e))", tile[0], tile[1]);
}

void texture_glue_write(FILE *out, const struct scene_model *model, size_t object)
{
    const struct scene *scene = &model->job->scene;
    const struct scene_object *source = &scene->objects[object];
    const struct texture_input *input = &model->inputs->textures[object];

    fprintf(out, "layout(binding = %u) uniform sampler2D object_%zu_image;\n", texture_unit_of_object(object), object);
    fprintf(out, "vec3 object_%zu_texture(vec3 p, int shape)\n{\n    vec2 uv = ", object);
    for (size_t i = source->first_shape + source->shape_count; i-- > source->first_shape;) {
        if (i > source->first_shape) fprintf(out, "shape == %zu ? ", i);
        write_uv(out, &scene->shapes[i], input, i);
        fputs(i > source->first_shape ? "\n            : " : ";\n", out);
    }
    fprintf(out, "    return texture_%s(object_%zu_image, uv);\n}\n", input->source->is_nearest ? "nearest" : "linear",
            object);
}
