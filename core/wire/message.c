// SPDX-License-Identifier: Apache-2.0
#include "core/wire/message.h"

#include "core/base/error.h"
#include "core/json/json_write.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum { ID_STRING_LIMIT = 60 };

static bool read_version(const struct json_node *root, struct error *error)
{
    struct json_node node = json_node_child(root, "jsonrpc");
    const char *version = "";

    if (json_node_type(&node) == JSON_STRING) json_read_string(&node, &version, NULL);
    return strcmp(version, "2.0") == 0 || json_fail_expected(&node, error, "\"2.0\"");
}

static bool fail_id(const struct json_node *node, struct error *error)
{
    return json_fail_expected(node, error, "an integer, null or a string of at most 60 bytes");
}

// An absent id leaves `id` empty.
static bool read_id(char id[static MESSAGE_ID_SIZE], const struct json_node *root, struct error *error)
{
    struct json_node node = json_node_child(root, "id");
    struct json_writer writer = {0};
    const char *text;
    int64_t number;
    bool fits;

    switch (json_node_type(&node)) {
    case JSON_ABSENT:
        return true;
    case JSON_NULL:
        json_write_null(&writer);
        break;
    case JSON_STRING:
        if (!json_read_string(&node, &text, error)) return false;
        if (strlen(text) > ID_STRING_LIMIT) return fail_id(&node, error);
        json_write_string(&writer, text);
        break;
    default:
        if (!json_read_integer(&node, INT64_MIN, INT64_MAX, &number, NULL)) return fail_id(&node, error);
        json_write_integer(&writer, number);
    }
    fits = writer.length < MESSAGE_ID_SIZE;
    if (fits) memcpy(id, writer.text, writer.length + 1);
    json_writer_finish(&writer);
    return fits || fail_id(&node, error);
}

static bool read_call(struct message *message, const struct json_node *root, struct error *error)
{
    static const char *const members[] = {"jsonrpc", "id", "method", "params", NULL};
    struct json_node method = json_node_child(root, "method");
    enum json_type type;

    message->kind = message->id[0] ? MESSAGE_REQUEST : MESSAGE_NOTIFICATION;
    if (!json_read_string(&method, &message->method, error)) return false;
    message->body = json_node_child(root, "params");
    message->body.parent = NULL;
    type = json_node_type(&message->body);
    if (type != JSON_ABSENT && type != JSON_OBJECT && type != JSON_ARRAY)
        return json_fail_expected(&message->body, error, "an object or an array");
    return message->kind == MESSAGE_NOTIFICATION || json_check_keys(root, members, error);
}

static bool read_error(struct message *message, const struct json_node *node, struct error *error)
{
    struct json_node code = json_node_child(node, "code");
    struct json_node text = json_node_child(node, "message");
    int64_t number;

    message->kind = MESSAGE_ERROR;
    if (!json_check_object(node, error)) return false;
    if (!json_read_integer(&code, INT_MIN, INT_MAX, &number, error)) return false;
    message->code = (int)number;
    return json_read_string(&text, &message->text, error);
}

static bool read_answer(struct message *message, const struct json_node *root, struct error *error)
{
    struct json_node result = json_node_child(root, "result");
    struct json_node failure = json_node_child(root, "error");

    if (json_node_is_absent(&result) == json_node_is_absent(&failure)) {
        error_set(error, "expected a method, a result or an error");
        return false;
    }
    if (!message->id[0]) {
        error_set(error, "id: expected the id of a request, got nothing");
        return false;
    }
    if (!json_node_is_absent(&failure)) return read_error(message, &failure, error);
    message->kind = MESSAGE_RESULT;
    message->body = result;
    message->body.parent = NULL;
    return true;
}

bool message_decode(struct message *message, const char *line, size_t length, enum message_code *code,
                    struct error *error)
{
    bool ok = false;
    struct json_node root;
    struct json_node method;

    *message = (struct message){0};
    *code = MESSAGE_CODE_PARSE;
    if (!json_parse(&message->root, line, length, error)) goto out;
    *code = MESSAGE_CODE_INVALID;
    root = json_node_root(message->root);
    if (!json_check_object(&root, error)) goto out;
    if (!read_id(message->id, &root, error)) goto out;
    if (!read_version(&root, error)) goto out;
    method = json_node_child(&root, "method");
    ok = json_node_is_absent(&method) ? read_answer(message, &root, error) : read_call(message, &root, error);
out:
    if (!ok) {
        json_delete(message->root);
        message->root = NULL;
        message->method = message->text = NULL;
        message->body = (struct json_node){0};
    }
    return ok;
}

void message_finish(struct message *message)
{
    json_delete(message->root);
    *message = (struct message){0};
}

struct cJSON *message_take_root(struct message *message)
{
    struct cJSON *root = message->root;

    message->root = NULL;
    return root;
}

static void begin(struct json_writer *writer)
{
    json_write_begin_object(writer);
    json_write_string_member(writer, "jsonrpc", "2.0");
}

static void write_id(struct json_writer *writer, const char *id)
{
    bool is_known = id && id[0];

    json_write_key(writer, "id");
    json_write_raw(writer, is_known ? id : "null", is_known ? strlen(id) : strlen("null"));
}

void message_begin_request(struct json_writer *writer, int64_t id, const char *method)
{
    begin(writer);
    json_write_integer_member(writer, "id", id);
    json_write_string_member(writer, "method", method);
    json_write_key(writer, "params");
}

void message_begin_notification(struct json_writer *writer, const char *method)
{
    begin(writer);
    json_write_string_member(writer, "method", method);
    json_write_key(writer, "params");
}

void message_begin_result(struct json_writer *writer, const char *id)
{
    begin(writer);
    write_id(writer, id);
    json_write_key(writer, "result");
}

void message_end(struct json_writer *writer)
{
    json_write_end_object(writer);
    writer->wants_comma = false;
    json_write_raw(writer, "\n", 1);
    writer->wants_comma = false;
}

void message_write_error(struct json_writer *writer, const char *id, enum message_code code, const char *text)
{
    begin(writer);
    write_id(writer, id);
    json_write_key(writer, "error");
    json_write_begin_object(writer);
    json_write_integer_member(writer, "code", code);
    json_write_string_member(writer, "message", text);
    json_write_end_object(writer);
    message_end(writer);
}
