// SPDX-License-Identifier: Apache-2.0
#include "worker/glsl/frame_uniforms.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "worker/glsl/scene_anchor.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const char *const type_names[] = {"float", "vec3", "mat3"};
static const int component_counts[] = {1, 3, 9};
static const size_t alignments[] = {4, 16, 16}; // std140
static const size_t sizes_bytes[] = {4, 12, 48};

void frame_uniforms_finish(struct frame_uniforms *uniforms)
{
    free(uniforms->values);
    *uniforms = (struct frame_uniforms){0};
}

static size_t round_up(size_t bytes, size_t alignment)
{
    return (bytes + alignment - 1) & ~(alignment - 1);
}

static bool is_relative(const struct frame_value *value)
{
    return value->is_position || value->evaluate_linear;
}

void frame_uniforms_add(struct frame_uniforms *uniforms, struct frame_value value, const char *name_format, ...)
{
    struct frame_value *added;
    va_list arguments;

    va_start(arguments, name_format);
    vsnprintf(value.name, sizeof value.name, name_format, arguments);
    va_end(arguments);
    uniforms->values = xgrow(uniforms->values, &uniforms->capacity, uniforms->count + 1, sizeof *uniforms->values);
    added = &uniforms->values[uniforms->count++];
    *added = value;
    added->is_constant &= !uniforms->is_shared;
    added->is_constant &= !is_relative(added) || !uniforms->anchored || !scene_anchor_moves(uniforms->anchored);
    if (added->is_constant) return;
    added->offset_bytes = round_up(uniforms->end_bytes, alignments[added->type]);
    uniforms->end_bytes = added->offset_bytes + sizes_bytes[added->type];
    uniforms->size_bytes = round_up(uniforms->end_bytes, 16);
}

// A (p + anchor) + shift = A p + (A anchor + shift).
static void make_relative(const struct frame_value *value, const struct job *job, double time,
                          double components[static 9])
{
    double anchor[3], linear[9] = {0};

    scene_anchor_find(job, time, anchor);
    if (value->evaluate_linear) value->evaluate_linear(value->source, time, linear);
    for (int row = 0; row < 3; ++row)
        components[row] += value->is_position
                               ? -anchor[row]
                               : linear[row] * anchor[0] + linear[3 + row] * anchor[1] + linear[6 + row] * anchor[2];
}

static void evaluate(const struct frame_uniforms *uniforms, const struct frame_value *value,
                     const struct frame_moment *moment, double components[static 9])
{
    switch (value->origin) {
    case FRAME_VALUE_OF_TIME:
    case FRAME_VALUE_OF_PLAN:
        value->evaluate(value->source, moment->time, components);
        break;
    case FRAME_VALUE_GIVEN:
        memcpy(components, value->given, sizeof value->given);
        break;
    case FRAME_VALUE_FRAME_SEED:
        components[0] = moment->frame_seed;
        break;
    case FRAME_VALUE_SAMPLE_INDEX:
        components[0] = moment->sample_index;
        break;
    case FRAME_VALUE_STREAM:
        components[0] = moment->stream;
        break;
    }
    if (uniforms->anchored && is_relative(value)) make_relative(value, uniforms->anchored, moment->time, components);
}

// Nine digits read back as the same float, so that a constant and a uniform give the same picture.
static void write_float(FILE *out, double value)
{
    char text[32];

    snprintf(text, sizeof text, "%.9g", (double)(float)value);
    fprintf(out, "%s%s", text, strpbrk(text, ".e") ? "" : ".0");
}

static void write_literal(FILE *out, const struct frame_uniforms *uniforms, const struct frame_value *value)
{
    double components[9] = {0};
    int count = component_counts[value->type];

    evaluate(uniforms, value, &(struct frame_moment){0}, components);
    if (count > 1) fprintf(out, "%s(", type_names[value->type]);
    for (int i = 0; i < count; ++i) {
        if (i > 0) fputs(", ", out);
        write_float(out, components[i]);
    }
    if (count > 1) fputs(")", out);
}

// Uniforms are copied once a pixel: inside a loop software GL would fetch, check and spread each number anew.
static void write_copies(const struct frame_uniforms *uniforms, FILE *out)
{
    for (size_t i = 0; i < uniforms->count; ++i)
        if (!uniforms->values[i].is_constant)
            fprintf(out, "%s %s;\n", type_names[uniforms->values[i].type], uniforms->values[i].name);
    fputs("void frame_uniforms_read()\n{\n", out);
    for (size_t i = 0; i < uniforms->count; ++i)
        if (!uniforms->values[i].is_constant)
            fprintf(out, "    %s = frame.%s;\n", uniforms->values[i].name, uniforms->values[i].name);
    fputs("}\n", out);
}

void frame_uniforms_declare(const struct frame_uniforms *uniforms, FILE *out)
{
    for (size_t i = 0; i < uniforms->count; ++i) {
        const struct frame_value *value = &uniforms->values[i];

        if (!value->is_constant) continue;
        fprintf(out, "const %s %s = ", type_names[value->type], value->name);
        write_literal(out, uniforms, value);
        fputs(";\n", out);
    }
    if (uniforms->size_bytes == 0) return;
    fputs("layout(std140, binding = 0) uniform FrameUniforms {\n", out);
    for (size_t i = 0; i < uniforms->count; ++i)
        if (!uniforms->values[i].is_constant)
            fprintf(out, "    %s %s;\n", type_names[uniforms->values[i].type], uniforms->values[i].name);
    fputs("} frame;\n", out);
    write_copies(uniforms, out);
}

static void pack_value(const struct frame_value *value, const double components[9], unsigned char *bytes)
{
    for (int i = 0; i < component_counts[value->type]; ++i) {
        float rounded = (float)components[i];
        size_t padding = value->type == FRAME_VALUE_MAT3 ? (size_t)(i / 3) * 4 : 0; // a column is 16 bytes

        memcpy(bytes + value->offset_bytes + 4 * (size_t)i + padding, &rounded, sizeof rounded);
    }
}

bool frame_uniforms_pack(const struct frame_uniforms *uniforms, const struct frame_moment *moment, void *bytes,
                         struct error *error)
{
    memset(bytes, 0, uniforms->size_bytes);
    for (size_t i = 0; i < uniforms->count; ++i) {
        const struct frame_value *value = &uniforms->values[i];
        double components[9] = {0};

        if (value->is_constant) continue;
        evaluate(uniforms, value, moment, components);
        for (int k = 0; k < component_counts[value->type]; ++k)
            if (!(components[k] >= value->min && components[k] <= value->max)) {
                error_set(error, "%s (%s): expected a number in [%g, %g], got %g at t = %g s", value->meaning,
                          value->name, value->min, value->max, components[k], moment->time);
                return false;
            }
        pack_value(value, components, bytes);
    }
    return true;
}
