// SPDX-License-Identifier: Apache-2.0
#include "worker/sandbox/fence.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_read.h"
#include "core/wire/message.h"

#include <stdlib.h>
#include <string.h>

enum { INPUT_LIMIT = 1024, CLOSED_LIMIT = 64 };

static bool read_text(const struct json_node *object, const char *key, char **copy, struct error *error)
{
    struct json_node node = json_node_child(object, key);
    const char *text;

    if (!json_read_string(&node, &text, error)) return false;
    *copy = xstrdup(text);
    return true;
}

static bool read_path(const struct json_node *object, const char *key, bool is_absolute, char **path,
                      struct error *error)
{
    struct json_node node = json_node_child(object, key);

    if (!read_text(object, key, path, error)) return false;
    if ((*path[0] == '/') == is_absolute) return true;
    return json_fail_expected(&node, error, is_absolute ? "an absolute path" : "a relative path");
}

static bool read_inputs(struct fence *fence, const struct json_node *params, struct error *error)
{
    struct json_node inputs = json_node_child(params, "inputs"), node = {0};

    if (!json_check_array(&inputs, 0, INPUT_LIMIT, error)) return false;
    while (json_node_next(&inputs, &node)) {
        struct fence_input *input;

        fence->inputs = xgrow(fence->inputs, &fence->input_capacity, fence->input_count + 1, sizeof fence->inputs[0]);
        input = &fence->inputs[fence->input_count++];
        *input = (struct fence_input){0};
        if (!read_text(&node, "place", &input->place, error) || !read_path(&node, "root", true, &input->root, error) ||
            !read_path(&node, "folder", false, &input->folder, error) ||
            !read_path(&node, "path", true, &input->path, error))
            return false;
    }
    return true;
}

static bool read_closed(struct fence *fence, const struct json_node *params, struct error *error)
{
    struct json_node closed = json_node_child(params, "closed"), node = {0};
    const char *text;

    if (!json_check_array(&closed, 0, CLOSED_LIMIT, error)) return false;
    while (json_node_next(&closed, &node)) {
        if (!json_read_string(&node, &text, error)) return false;
        path_list_add(&fence->closed, xstrdup(text));
    }
    return true;
}

bool fence_read(struct fence *fence, const struct message *message, struct error *error)
{
    struct json_node output = json_node_child(&message->body, "output");
    struct json_node converter = json_node_child(&message->body, "converter");

    *fence = (struct fence){0};
    if (!message->method || strcmp(message->method, "worker.fence") != 0) {
        error_set(error, "expected worker.fence, got %s", message->method ? message->method : "an answer");
        return false;
    }
    if (read_inputs(fence, &message->body, error) && read_closed(fence, &message->body, error) &&
        read_path(&output, "root", true, &fence->output_root, error) &&
        read_path(&output, "folder", false, &fence->output_folder, error) &&
        json_read_bool(&converter, &fence->has_converter, error))
        return true;
    error_prefix(error, "worker.fence");
    fence_finish(fence);
    return false;
}

void fence_finish(struct fence *fence)
{
    for (size_t i = 0; i < fence->input_count; i++) {
        free(fence->inputs[i].place);
        free(fence->inputs[i].root);
        free(fence->inputs[i].folder);
        free(fence->inputs[i].path);
    }
    free(fence->inputs);
    free(fence->output_root);
    free(fence->output_folder);
    path_list_finish(&fence->closed);
    *fence = (struct fence){0};
}
