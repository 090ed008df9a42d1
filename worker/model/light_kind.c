// SPDX-License-Identifier: Apache-2.0
#include "worker/model/light_kind.h"

#include "worker/glsl/timeline_value.h"

#include <assert.h>
#include <math.h>

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

static void evaluate_radians(const void *source, double time, double value[static 9])
{
    timeline_value_evaluate(source, time, value);
    value[0] *= M_PI / 180.0;
}

static void add_cone(struct frame_uniforms *uniforms, const struct timeline *half_angle, size_t index, const char *name)
{
    struct frame_value value = timeline_value(half_angle, FRAME_VALUE_FLOAT, value_range_positive, "a spot's cones");

    value.evaluate = evaluate_radians;
    frame_uniforms_add(uniforms, value, "light_%zu_%s", index, name);
}

static void add_inner(struct frame_uniforms *uniforms, const struct scene_light *light, size_t index)
{
    add_cone(uniforms, &light->inner, index, "inner");
}

static void add_outer(struct frame_uniforms *uniforms, const struct scene_light *light, size_t index)
{
    add_cone(uniforms, &light->outer, index, "outer");
}

static const struct light_value position = {"position", light_kind_add_position};
static const struct light_value direction = {"direction", add_direction};
static const struct light_value inner = {"inner", add_inner}, outer = {"outer", add_outer};

// Of a kind without falloffs only the first is there.
static const struct light_kind kinds[][2] = {
    [SCENE_LIGHT_POINT] = {[SCENE_FALLOFF_INVERSE_SQUARE] = {.modules = {"light/point.glsl"},
                                                             .function = "light_point",
                                                             .structure = "LightPoint",
                                                             .values = {&position},
                                                             .is_inverse_square = true},
                           [SCENE_FALLOFF_NONE] = {.modules = {"light/point_even.glsl"},
                                                   .function = "light_point_even",
                                                   .structure = "LightPointEven",
                                                   .values = {&position}}},
    [SCENE_LIGHT_SUN] =
        {{.modules = {"light/sun.glsl"}, .function = "light_sun", .structure = "LightSun", .values = {&direction}}},
    [SCENE_LIGHT_SPOT] = {{.modules = {"math/arc.glsl", "light/point.glsl", "light/spot.glsl"},
                           .function = "light_spot",
                           .structure = "LightSpot",
                           .values = {&position, &direction, &inner, &outer},
                           .is_inverse_square = true,
                           .is_spot = true}},
};

const struct light_kind *light_kind_of(const struct scene_light *light)
{
    const struct light_kind *kind = &kinds[light->kind][light->falloff];

    assert(kind->function);
    return kind;
}

void light_kind_add_values(struct frame_uniforms *uniforms, const struct scene_light *light, size_t index)
{
    const struct light_kind *kind = light_kind_of(light);

    for (size_t i = 0; i < LIGHT_VALUE_LIMIT && kind->values[i]; ++i)
        kind->values[i]->add(uniforms, light, index);
}
