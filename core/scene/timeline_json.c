// SPDX-License-Identifier: Apache-2.0
#include "core/scene/timeline_json.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

// The parts of a timeline may lie outside the range of its value: `start`, for example, is the value at time 0, which
// may be outside of the frames.
static const struct timeline_limits PART = {.min = -1e15, .max = 1e15};
static const struct timeline_limits RATE = {.min = -1e9, .max = 1e9};
static const struct timeline_limits POINT = {.components = 3, .min = -1e9, .max = 1e9};
static const struct timeline_limits AXIS = {.components = 3, .min = -1e9, .max = 1e9, .is_direction = true};
static const struct timeline_limits LENGTH = {.components = 1, .min = 0.0, .max = 1e9};
static const struct timeline_limits NUMBER = {.components = 1, .min = -1e9, .max = 1e9};

static const double DIRECTION_LENGTH_MIN = 1e-6;

static bool is_within(const struct timeline_limits *limits, double number)
{
    bool above = limits->excludes_min ? number > limits->min : number >= limits->min;
    bool below = limits->excludes_max ? number < limits->max : number <= limits->max;

    return above && below;
}

static const char *describe_range(const struct timeline_limits *limits, char text[static 64])
{
    snprintf(text, 64, "%c%.10g, %.10g%c", limits->excludes_min ? '(' : '[', limits->min, limits->max,
             limits->excludes_max ? ')' : ']');
    return text;
}

static bool fail_value(const struct json_node *node, const struct timeline_limits *limits, int components,
                       struct error *error)
{
    static const char *const forms[] = {"a number or [r, g, b]", "a number", "", "three numbers [x, y, z]"};
    char range[64], expected[128];

    snprintf(expected, sizeof expected, "%s in %s", forms[components], describe_range(limits, range));
    return json_fail_expected(node, error, expected);
}

static bool read_component(const struct json_node *node, const struct timeline_limits *limits, double *number,
                           struct error *error)
{
    if (json_node_type(node) == JSON_NUMBER && json_read_number(node, -DBL_MAX, DBL_MAX, number, NULL) &&
        is_within(limits, *number))
        return true;
    return fail_value(node, limits, 1, error);
}

// `*components` is the required number of components, or 0 for 1 or 3; it receives the number found.
static bool read_value(const struct json_node *node, const struct timeline_limits *limits, int *components,
                       double value[static 3], struct error *error)
{
    enum json_type type = json_node_type(node);
    double length;

    if (type == JSON_NUMBER && *components != 3) {
        *components = 1;
        return read_component(node, limits, &value[0], error);
    }
    if (type != JSON_ARRAY || *components == 1 || json_node_count(node) != 3)
        return fail_value(node, limits, *components, error);
    *components = 3;
    for (size_t i = 0; i < 3; i++) {
        struct json_node child = json_node_element(node, i);

        if (!read_component(&child, limits, &value[i], error)) return false;
    }
    length = hypot(hypot(value[0], value[1]), value[2]);
    if (limits->is_direction && length < DIRECTION_LENGTH_MIN)
        return json_fail(node, error, "expected a vector whose length is not 0, got one of %g", length);
    return true;
}

static bool read_member(const struct json_node *object, const char *key, const struct timeline_limits *limits,
                        double value[static 3], struct error *error)
{
    struct json_node node = json_node_child(object, key);
    int components = limits->components;

    return read_value(&node, limits, &components, value, error);
}

static bool read_optional(const struct json_node *object, const char *key, const struct timeline_limits *limits,
                          double value[static 3], struct error *error)
{
    struct json_node node = json_node_child(object, key);

    return json_node_is_absent(&node) || read_member(object, key, limits, value, error);
}

static bool read_optional_number(const struct json_node *object, const char *key, const struct timeline_limits *limits,
                                 double *number, struct error *error)
{
    struct json_node node = json_node_child(object, key);

    return json_node_is_absent(&node) || read_component(&node, limits, number, error);
}

// `limits` with the number of components of `timeline`.
static struct timeline_limits limits_like(struct timeline_limits limits, const struct timeline *timeline)
{
    limits.components = timeline->component_count;
    return limits;
}

static bool read_linear(struct timeline *timeline, const struct json_node *node, struct error *error)
{
    static const char *const keys[] = {"start", "rate", NULL};
    struct json_node start = json_node_child(node, "start");
    struct timeline_limits rate;

    timeline->kind = TIMELINE_LINEAR;
    if (!json_check_keys(node, keys, error)) return false;
    if (!read_value(&start, &PART, &timeline->component_count, timeline->linear.start, error)) return false;
    rate = limits_like(PART, timeline);
    return read_member(node, "rate", &rate, timeline->linear.rate, error);
}

static bool read_lissajous(struct timeline *timeline, const struct json_node *node, struct error *error)
{
    static const char *const outer_keys[] = {"lissajous", NULL};
    static const char *const keys[] = {"center", "amplitude", "frequency_rad", "phase_rad", "speed", NULL};
    struct json_node curve = json_node_child(node, "lissajous");
    struct json_node center = json_node_child(&curve, "center");
    struct timeline_limits amplitude, rate;

    timeline->kind = TIMELINE_LISSAJOUS;
    timeline->lissajous.speed = 1.0;
    if (!json_check_keys(node, outer_keys, error) || !json_check_object(&curve, error) ||
        !json_check_keys(&curve, keys, error))
        return false;
    if (!read_value(&center, &PART, &timeline->component_count, timeline->lissajous.center, error)) return false;
    amplitude = limits_like(PART, timeline);
    rate = limits_like(RATE, timeline);
    return read_member(&curve, "amplitude", &amplitude, timeline->lissajous.amplitude, error) &&
           read_member(&curve, "frequency_rad", &rate, timeline->lissajous.frequency_rad, error) &&
           read_optional(&curve, "phase_rad", &rate, timeline->lissajous.phase_rad, error) &&
           read_optional_number(&curve, "speed", &NUMBER, &timeline->lissajous.speed, error);
}

static bool read_key(struct timeline *timeline, const struct json_node *node, const struct timeline_limits *limits,
                     size_t index, struct error *error)
{
    struct timeline_key *key = &timeline->keys.keys[index];
    struct json_node time = json_node_element(node, 0), value = json_node_element(node, 1);

    if (json_node_type(node) != JSON_ARRAY || json_node_count(node) != 2)
        return json_fail_expected(node, error, "[time, value]");
    if (!read_component(&time, &NUMBER, &key->time, error)) return false;
    if (index > 0 && key->time <= key[-1].time)
        return json_fail(&time, error, "expected a time after that of the key before it (%.10g), got %.10g",
                         key[-1].time, key->time);
    return read_value(&value, limits, &timeline->component_count, key->value, error);
}

static bool read_keys(struct timeline *timeline, const struct json_node *node, const struct timeline_limits *limits,
                      struct error *error)
{
    static const char *const keys[] = {"keys", "interpolation", NULL};
    static const char *const interpolations[] = {"linear", "smooth", "hold", NULL};
    struct json_node list = json_node_child(node, "keys"), interpolation = json_node_child(node, "interpolation");
    struct json_node child = {0};
    int choice = TIMELINE_INTERPOLATE_LINEAR;

    timeline->kind = TIMELINE_KEYS;
    if (!json_check_keys(node, keys, error) || !json_check_array(&list, 1, TIMELINE_KEY_LIMIT, error)) return false;
    if (!json_node_is_absent(&interpolation) && !json_read_enum(&interpolation, interpolations, &choice, error))
        return false;
    timeline->keys.interpolation = (enum timeline_interpolation)choice;
    timeline->keys.keys = xcalloc(json_node_count(&list), sizeof *timeline->keys.keys);
    for (; json_node_next(&list, &child); timeline->keys.count++)
        if (!read_key(timeline, &child, limits, timeline->keys.count, error)) return false;
    return true;
}

static bool read_orbit(struct timeline *timeline, const struct json_node *node, struct error *error)
{
    static const char *const outer_keys[] = {"orbit", NULL};
    static const char *const keys[] = {"center", "radius", "height", "axis", "period", "phase_deg", NULL};
    struct json_node curve = json_node_child(node, "orbit");
    struct json_node radius = json_node_child(&curve, "radius"), period = json_node_child(&curve, "period");
    double phase_deg = 0.0;

    timeline->kind = TIMELINE_ORBIT;
    timeline->component_count = 3;
    timeline->orbit.axis[1] = 1.0;
    if (!json_check_keys(node, outer_keys, error) || !json_check_object(&curve, error) ||
        !json_check_keys(&curve, keys, error))
        return false;
    if (!read_component(&radius, &LENGTH, &timeline->orbit.radius, error) ||
        !read_component(&period, &NUMBER, &timeline->orbit.period, error))
        return false;
    if (timeline->orbit.period == 0.0) return json_fail_expected(&period, error, "a number of seconds that is not 0");
    if (!read_optional(&curve, "center", &POINT, timeline->orbit.center, error) ||
        !read_optional(&curve, "axis", &AXIS, timeline->orbit.axis, error) ||
        !read_optional_number(&curve, "height", &NUMBER, &timeline->orbit.height, error) ||
        !read_optional_number(&curve, "phase_deg", &NUMBER, &phase_deg, error))
        return false;
    timeline->orbit.phase_rad = phase_deg * M_PI / 180.0;
    return true;
}

static bool has_child(const struct json_node *node, const char *key)
{
    struct json_node child = json_node_child(node, key);

    return !json_node_is_absent(&child);
}

static bool read_moving(struct timeline *timeline, const struct json_node *node, const struct timeline_limits *limits,
                        struct error *error)
{
    static const char *const keys[] = {"start", "rate", "lissajous", "keys", "interpolation", "orbit", NULL};

    if (has_child(node, "lissajous")) return read_lissajous(timeline, node, error);
    if (has_child(node, "keys")) return read_keys(timeline, node, limits, error);
    if (has_child(node, "orbit") && limits->is_position) return read_orbit(timeline, node, error);
    if (has_child(node, "orbit")) return json_fail(node, error, "an orbit drives positions only");
    if (has_child(node, "start") || has_child(node, "rate")) return read_linear(timeline, node, error);
    if (!json_check_keys(node, keys, error)) return false;
    return json_fail_expected(node, error, "start and rate, lissajous, keys or orbit");
}

static bool check_bounds(const struct timeline *timeline, const struct json_node *node,
                         const struct timeline_limits *limits, struct error *error)
{
    double min[3], max[3];
    char range[64];

    timeline_find_bounds(timeline, limits->span, min, max);
    for (int i = 0; i < timeline->component_count; i++)
        if (!is_within(limits, min[i]) || !is_within(limits, max[i]))
            return json_fail(node, error, "expected to stay in %s, got %.10g to %.10g", describe_range(limits, range),
                             min[i], max[i]);
    return true;
}

bool timeline_from_json(struct timeline *timeline, const struct json_node *node, const struct timeline_limits *limits,
                        struct error *error)
{
    bool ok;

    *timeline = (struct timeline){.component_count = limits->components};
    if (json_node_type(node) == JSON_OBJECT)
        ok = read_moving(timeline, node, limits, error) && check_bounds(timeline, node, limits, error);
    else
        ok = read_value(node, limits, &timeline->component_count, timeline->value, error);
    if (!ok) timeline_finish(timeline);
    return ok;
}
