// SPDX-License-Identifier: Apache-2.0
#include "worker/model/light_kind.h"

#include "worker/glsl/timeline_value.h"

#include <assert.h>

static void evaluate_toward_sun(const void *source, double time, double value[static 9])
{
    timeline_value_evaluate_unit(source, time, value);
    for (int i = 0; i < 3; ++i)
        value[i] = -value[i];
}

static void add_direction(struct frame_uniforms *uniforms, const struct scene_light *light, size_t index)
{
    struct frame_value direction =
        timeline_value(&light->direction, FRAME_VALUE_VEC3, value_range_any, "lights.direction");

    direction.evaluate = evaluate_toward_sun;
    frame_uniforms_add(uniforms, direction, "light_%zu_direction", index);
}

void light_kind_add_position(struct frame_uniforms *uniforms, const struct scene_light *light, size_t index)
{
    frame_uniforms_add(uniforms, timeline_value_position(&light->position, "lights.position"), "light_%zu_position",
                       index);
}

static const struct light_kind kinds[][2] = {
    [SCENE_LIGHT_POINT] = {[SCENE_FALLOFF_INVERSE_SQUARE] = {.module = "light/point.glsl",
                                                             .call = "light_point(LightPoint(",
                                                             .value = "position",
                                                             .takes_point = true,
                                                             .is_inverse_square = true,
                                                             .add_value = light_kind_add_position},
                           [SCENE_FALLOFF_NONE] = {.module = "light/point_even.glsl",
                                                   .call = "light_point_even(LightPointEven(",
                                                   .value = "position",
                                                   .takes_point = true,
                                                   .add_value = light_kind_add_position}},
    [SCENE_LIGHT_SUN] =
        {{.module = "light/sun.glsl", .call = "light_sun(LightSun(", .value = "direction", .add_value = add_direction}},
};

const struct light_kind *light_kind_of(const struct scene_light *light)
{
    const struct light_kind *kind = &kinds[light->kind][light->falloff];

    assert(kind->module);
    return kind;
}
