// SPDX-License-Identifier: Apache-2.0
#include "worker/model/light_kind.h"

#include "core/scene/timeline.h"
#include "worker/glsl/timeline_value.h"

#include <assert.h>
#include <math.h>

static void evaluate_toward(const void *source, double time, double value[static 9])
{
    timeline_value_evaluate_unit(source, time, value);
    for (int i = 0; i < 3; ++i)
        value[i] = -value[i];
}

static void add_direction(struct frame_uniforms *uniforms, const struct light_site *site)
{
    struct frame_value value =
        timeline_value(&site->light->direction, FRAME_VALUE_VEC3, value_range_any, "lights.direction");

    value.evaluate = evaluate_toward;
    frame_uniforms_add(uniforms, value, "light_%zu_direction", site->index);
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

static void add_position(struct frame_uniforms *uniforms, const struct light_site *site)
{
    light_kind_add_position(uniforms, site->light, site->index);
}

static void add_cone(struct frame_uniforms *uniforms, const struct timeline *half_angle, size_t index, const char *name)
{
    struct frame_value value = timeline_value(half_angle, FRAME_VALUE_FLOAT, value_range_positive, "a spot's cones");

    value.evaluate = evaluate_radians;
    frame_uniforms_add(uniforms, value, "light_%zu_%s", index, name);
}

static void add_inner(struct frame_uniforms *uniforms, const struct light_site *site)
{
    add_cone(uniforms, &site->light->inner, site->index, "inner");
}

static void add_outer(struct frame_uniforms *uniforms, const struct light_site *site)
{
    add_cone(uniforms, &site->light->outer, site->index, "outer");
}

static void add_radius(struct frame_uniforms *uniforms, const struct light_site *site)
{
    frame_uniforms_add(uniforms,
                       timeline_value(&site->light->radius, FRAME_VALUE_FLOAT, value_range_positive, "lights.radius"),
                       "light_%zu_radius", site->index);
}

static void add_opposite(struct frame_uniforms *uniforms, const struct light_site *site)
{
    frame_uniforms_add(uniforms,
                       timeline_value(&site->light->dome.opposite, site->spectrum, value_range_not_negative,
                                      "lights.gradient.against"),
                       "light_%zu_opposite", site->index);
}

static void add_axis(struct frame_uniforms *uniforms, const struct light_site *site)
{
    struct frame_value value =
        timeline_value(&site->light->dome.axis, FRAME_VALUE_VEC3, value_range_any, "lights.gradient.axis");

    value.evaluate = timeline_value_evaluate_unit;
    frame_uniforms_add(uniforms, value, "light_%zu_axis", site->index);
}

// From the world into a dome's image: back by its angle about its axis. Rodrigues' formula, by columns.
static void evaluate_turn(const void *source, double time, double value[static 9])
{
    const struct scene_dome *dome = source;
    double axis[9] = {0}, angle[9] = {0}, cosine, sine;

    timeline_value_evaluate_unit(&dome->axis, time, axis);
    timeline_value_evaluate(&dome->angle, time, angle);
    cosine = cos(angle[0] * M_PI / 180.0);
    sine = -sin(angle[0] * M_PI / 180.0);
    for (int column = 0; column < 3; ++column) {
        int next = (column + 1) % 3, last = (column + 2) % 3;

        for (int row = 0; row < 3; ++row)
            value[3 * column + row] = (1.0 - cosine) * axis[column] * axis[row] + (row == column ? cosine : 0.0);
        value[3 * column + next] += sine * axis[last];
        value[3 * column + last] -= sine * axis[next];
    }
}

static void add_turn(struct frame_uniforms *uniforms, const struct light_site *site)
{
    const struct scene_dome *dome = &site->light->dome;

    frame_uniforms_add(
        uniforms,
        (struct frame_value){.type = FRAME_VALUE_MAT3,
                             .is_constant = timeline_is_constant(&dome->axis) && timeline_is_constant(&dome->angle),
                             .evaluate = evaluate_turn,
                             .source = dome,
                             .min = value_range_any.min,
                             .max = value_range_any.max,
                             .meaning = "lights.rotate"},
        "light_%zu_turn", site->index);
}

static const struct light_value position = {"position", add_position}, direction = {"direction", add_direction};
static const struct light_value inner = {"inner", add_inner}, outer = {"outer", add_outer};
static const struct light_value radius = {"radius", add_radius};
static const struct light_value opposite = {"opposite", add_opposite}, axis = {"axis", add_axis};
static const struct light_value turn = {"turn", add_turn};

// By falloff or by kind of dome; of other kinds only the first is there.
static const struct light_kind kinds[][3] = {
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
    [SCENE_LIGHT_SPHERE] = {{.modules = {"math/random.glsl", "scatter/random.glsl", "scatter/turn.glsl",
                                         "light/sphere.glsl"},
                             .function = "light_sphere",
                             .structure = "LightSphere",
                             .values = {&position, &radius},
                             .is_sphere = true}},
    [SCENE_LIGHT_DOME] = {[SCENE_DOME_RADIANCE] = {.modules = {"light/dome_even.glsl"},
                                                   .function = "light_dome_even",
                                                   .structure = "LightDomeEven",
                                                   .is_dome = true},
                          [SCENE_DOME_GRADIENT] = {.modules = {"light/dome_gradient.glsl"},
                                                   .function = "light_dome_gradient",
                                                   .structure = "LightDomeGradient",
                                                   .values = {&opposite, &axis},
                                                   .is_dome = true},
                          [SCENE_DOME_FILE] = {.modules = {"math/random.glsl", "scatter/random.glsl", "math/arc.glsl",
                                                           "light/dome_image.glsl"},
                                               .function = "light_dome_image",
                                               .structure = "LightDomeImage",
                                               .values = {&turn},
                                               .is_dome = true,
                                               .has_image = true}},
};

const struct light_kind *light_kind_of(const struct scene_light *light)
{
    int choice = light->kind == SCENE_LIGHT_DOME ? (int)light->dome.kind : (int)light->falloff;
    const struct light_kind *kind = &kinds[light->kind][choice];

    assert(kind->function);
    return kind;
}

static bool is_gradient(const struct scene_light *light)
{
    return light->kind == SCENE_LIGHT_DOME && light->dome.kind == SCENE_DOME_GRADIENT;
}

bool light_kind_is_dark(const struct scene_light *light)
{
    return timeline_value_is_zero(&light->intensity) &&
           (!is_gradient(light) || timeline_value_is_zero(&light->dome.opposite));
}

bool light_kind_is_grey(const struct scene_light *light)
{
    return !light_kind_of(light)->has_image && timeline_value_is_grey(&light->intensity) &&
           (!is_gradient(light) || timeline_value_is_grey(&light->dome.opposite));
}

void light_kind_add_values(struct frame_uniforms *uniforms, const struct light_site *site)
{
    const struct light_kind *kind = light_kind_of(site->light);

    for (size_t i = 0; i < LIGHT_VALUE_LIMIT && kind->values[i]; ++i)
        kind->values[i]->add(uniforms, site);
}
