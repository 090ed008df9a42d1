// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/openrpc.h"

#include "core/json/json_write.h"
#include "core/wire/message.h"
#include "daemon/requests/methods.h"
#include "daemon/requests/shapes.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

enum { SET_LIMIT = 64 };

static void begin_member(struct json_writer *writer, const char *key)
{
    json_write_key(writer, key);
    json_write_begin_object(writer);
}

static void write_reference(struct json_writer *writer, const char *shape, size_t length)
{
    char text[96];

    assert(shapes_find(shape, length));
    snprintf(text, sizeof text, "#/components/schemas/%.*s", (int)length, shape);
    json_write_string_member(writer, "$ref", text);
}

static void write_names(struct json_writer *writer, const char *const names[])
{
    json_write_key(writer, "enum");
    json_write_begin_array(writer);
    for (size_t i = 0; names[i]; i++)
        json_write_string(writer, names[i]);
    json_write_end_array(writer);
}

static void write_bounds(struct json_writer *writer, const struct member *member)
{
    if (member->min == 0 && member->max == 0) return;
    json_write_integer_member(writer, "minimum", member->min);
    if (member->max != 0) json_write_integer_member(writer, "maximum", member->max);
}

static bool is_basic(const char *type, size_t length)
{
    static const char *const basic[] = {"integer", "number", "string", "boolean", "object"};

    for (size_t i = 0; i < sizeof basic / sizeof basic[0]; i++) {
        if (strlen(basic[i]) == length && strncmp(basic[i], type, length) == 0) return true;
    }
    return false;
}

// Writes the members of a schema of the first `length` bytes of the member's type.
static void write_type(struct json_writer *writer, const struct member *member, size_t length)
{
    const char *type = member->type;

    if (type[length - 1] == '?') {
        json_write_key(writer, "anyOf");
        json_write_begin_array(writer);
        json_write_begin_object(writer);
        write_type(writer, member, length - 1);
        json_write_end_object(writer);
        json_write_begin_object(writer);
        json_write_string_member(writer, "type", "null");
        json_write_end_object(writer);
        json_write_end_array(writer);
    } else if (type[length - 1] == ']') {
        json_write_string_member(writer, "type", "array");
        begin_member(writer, "items");
        write_type(writer, member, length - 2);
        json_write_end_object(writer);
    } else if (is_basic(type, length)) {
        char text[16];

        snprintf(text, sizeof text, "%.*s", (int)length, type);
        json_write_string_member(writer, "type", text);
        write_bounds(writer, member);
        if (member->names) write_names(writer, member->names);
    } else {
        write_reference(writer, type, length);
    }
}

// One of the names, or an array of them.
static void write_set(struct json_writer *writer, const struct member *member)
{
    json_write_key(writer, "anyOf");
    json_write_begin_array(writer);
    json_write_begin_object(writer);
    write_type(writer, member, strlen(member->type));
    json_write_end_object(writer);
    json_write_begin_object(writer);
    json_write_string_member(writer, "type", "array");
    json_write_integer_member(writer, "maxItems", SET_LIMIT);
    begin_member(writer, "items");
    write_type(writer, member, strlen(member->type));
    json_write_end_object(writer);
    json_write_end_object(writer);
    json_write_end_array(writer);
}

static void write_schema(struct json_writer *writer, const struct member *member)
{
    if (member->is_set)
        write_set(writer, member);
    else
        write_type(writer, member, strlen(member->type));
    if (!member->fallback) return;
    json_write_key(writer, "default");
    json_write_raw(writer, member->fallback, strlen(member->fallback));
}

static void write_properties(struct json_writer *writer, const struct member *members)
{
    for (; members && members->name; members++) {
        begin_member(writer, members->name);
        json_write_string_member(writer, "description", members->meaning);
        write_schema(writer, members);
        json_write_end_object(writer);
    }
}

static void write_required(struct json_writer *writer, const struct member *members)
{
    for (; members && members->name; members++) {
        if (!members->is_optional) json_write_string(writer, members->name);
    }
}

// An object with the members of the shape, of what it has more, and `others`.
static void write_object(struct json_writer *writer, const struct shape *shape, const struct member *others)
{
    json_write_string_member(writer, "type", "object");
    begin_member(writer, "properties");
    for (const struct shape *part = shape; part; part = part->more)
        write_properties(writer, part->members);
    write_properties(writer, others);
    json_write_end_object(writer);
    json_write_key(writer, "required");
    json_write_begin_array(writer);
    for (const struct shape *part = shape; part; part = part->more)
        write_required(writer, part->members);
    write_required(writer, others);
    json_write_end_array(writer);
}

static void write_shape(struct json_writer *writer, const struct shape *shape)
{
    begin_member(writer, shape->name);
    json_write_string_member(writer, "description", shape->meaning);
    if (shape->variants) {
        json_write_key(writer, "oneOf");
        json_write_begin_array(writer);
        for (size_t i = 0; shape->variants[i]; i++) {
            json_write_begin_object(writer);
            write_reference(writer, shape->variants[i]->name, strlen(shape->variants[i]->name));
            json_write_end_object(writer);
        }
        json_write_end_array(writer);
    } else {
        write_object(writer, shape, NULL);
    }
    json_write_end_object(writer);
}

static void write_param(struct json_writer *writer, const struct member *param)
{
    json_write_begin_object(writer);
    json_write_string_member(writer, "name", param->name);
    json_write_string_member(writer, "description", param->meaning);
    json_write_bool_member(writer, "required", !param->is_optional);
    begin_member(writer, "schema");
    write_schema(writer, param);
    json_write_end_object(writer);
    json_write_end_object(writer);
}

static void write_result(struct json_writer *writer, const struct method *method)
{
    begin_member(writer, "result");
    json_write_string_member(writer, "name", "result");
    begin_member(writer, "schema");
    if (method->result_shape && !method->result)
        write_reference(writer, method->result_shape->name, strlen(method->result_shape->name));
    else
        write_object(writer, method->result_shape, method->result);
    json_write_end_object(writer);
    json_write_end_object(writer);
}

// OpenRPC wants codes below -32768 to -32000 described by the application: these are docs/protocol.md's.
static const struct {
    const char *name, *meaning;
    enum message_code code;
} faults[] = {
    {"params", "wrong params", MESSAGE_CODE_PARAMS},          {"not_found", "not found", MESSAGE_CODE_NOT_FOUND},
    {"not_allowed", "not allowed", MESSAGE_CODE_NOT_ALLOWED}, {"conflict", "conflict", MESSAGE_CODE_CONFLICT},
    {"store", "the store cannot commit", MESSAGE_CODE_STORE},
};

enum { FAULT_COUNT = sizeof faults / sizeof faults[0] };

static void write_fault_references(struct json_writer *writer)
{
    char text[64];

    json_write_key(writer, "errors");
    json_write_begin_array(writer);
    for (size_t i = 0; i < FAULT_COUNT; i++) {
        json_write_begin_object(writer);
        snprintf(text, sizeof text, "#/components/errors/%s", faults[i].name);
        json_write_string_member(writer, "$ref", text);
        json_write_end_object(writer);
    }
    json_write_end_array(writer);
}

static void write_method(struct json_writer *writer, const struct method *method)
{
    json_write_begin_object(writer);
    json_write_string_member(writer, "name", method->name);
    json_write_string_member(writer, "summary", method->meaning);
    json_write_string_member(writer, "paramStructure", "by-name");
    json_write_key(writer, "params");
    json_write_begin_array(writer);
    for (const struct member *param = method->params; param && param->name; param++)
        write_param(writer, param);
    json_write_end_array(writer);
    write_result(writer, method);
    write_fault_references(writer);
    json_write_end_object(writer);
}

static void write_components(struct json_writer *writer)
{
    begin_member(writer, "components");
    begin_member(writer, "schemas");
    for (size_t i = 0; shapes[i]; i++)
        write_shape(writer, shapes[i]);
    json_write_end_object(writer);
    begin_member(writer, "errors");
    for (size_t i = 0; i < FAULT_COUNT; i++) {
        begin_member(writer, faults[i].name);
        json_write_integer_member(writer, "code", faults[i].code);
        json_write_string_member(writer, "message", faults[i].meaning);
        json_write_end_object(writer);
    }
    json_write_end_object(writer);
    json_write_end_object(writer);
}

void openrpc_write(struct json_writer *writer)
{
    struct methods_walk walk = {0};
    const struct method *method;

    json_write_begin_object(writer);
    json_write_string_member(writer, "openrpc", "1.3.2");
    begin_member(writer, "info");
    json_write_string_member(writer, "title", "marchd");
    json_write_string_member(writer, "version", MARCHD_VERSION);
    json_write_string_member(writer, "description",
                             "JSON-RPC 2.0, a message a line. After events.subscribe the notifications `event` come, "
                             "whose params are the schema `event`. Members may be added to results later.");
    json_write_end_object(writer);
    json_write_key(writer, "methods");
    json_write_begin_array(writer);
    while ((method = methods_next(&walk)))
        write_method(writer, method);
    json_write_end_array(writer);
    write_components(writer);
    json_write_end_object(writer);
}
