// SPDX-License-Identifier: Apache-2.0
#include "worker/model/light_kind.h"

#include "worker/glsl/timeline_value.h"

#include <assert.h>

static void evaluate_toward(const void *source, double time, double value[static 9])
{
    timeline_value_evaluate_unit(source, time, value);
    for (int i = 0; i < 3; ++i)
        value[i] = -value[i];
}

static void add_direction(struct frame_uniforms *uniforms, const struct scene_light *light, size_t index)
{
    struct frame_value value = timeline_value(&light->direction, FRAME_VALUE_VEC3, value_range_any, "lights.direction");

    value.evaluate = evaluate_toward;
    frame_uniforms_add(uniforms, value, "light_%zu_direction", index);
}

void light_kind_add_position(struct frame_uniforms *uniforms, const struct scene_light *light, size_t index)
{
    frame_uniforms_add(uniforms, timeline_value_position(&light->position, "lights.position"), "light_%zu_position",
                       index);
}

static const struct light_value position = {"position", light_kind_add_position};
static const struct light_value direction = {"direction", add_direction};

// Of a kind without falloffs only the first is there.
static const struct light_kind kinds[][2] = {
    [SCENE_LIGHT_POINT] = {[SCENE_FALLOFF_INVERSE_SQUARE] = {.module = "light/point.glsl",
                                                             .call = "light_point(LightPoint(",
                                                             .values = {&position},
                                                             .is_inverse_square = true},
                           [SCENE_FALLOFF_NONE] = {.module = "light/point_even.glsl",
                                                   .call = "light_point_even(LightPointEven(",
                                                   .values = {&position}}},
    [SCENE_LIGHT_SUN] = {{.module = "light/sun.glsl", .call = "light_sun(LightSun(", .values = {&direction}}},
};

const struct light_kind *light_kind_of(const struct scene_light *light)
{
    const struct light_kind *kind = &kinds[light->kind][light->falloff];

    assert(kind->module);
    return kind;
}

void light_kind_add_values(struct frame_uniforms *uniforms, const struct scene_light *light, size_t index)
{
    const struct light_kind *kind = light_kind_of(light);

    for (size_t i = 0; i < LIGHT_VALUE_LIMIT && kind->values[i]; ++i)
        kind->values[i]->add(uniforms, light, index);
}
