// SPDX-License-Identifier: Apache-2.0
#include "worker/sandbox/fence.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_read.h"
#include "core/wire/message.h"

#include <stdlib.h>
#include <string.h>

enum { INPUT_LIMIT = 1024, CLOSED_LIMIT = 64, OTHER_LIMIT = 64 };

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

static bool read_inputs(struct fence_job *job, const struct json_node *object, struct error *error)
{
    struct json_node inputs = json_node_child(object, "inputs"), node = {0};

    if (!json_check_array(&inputs, 0, INPUT_LIMIT, error)) return false;
    while (json_node_next(&inputs, &node)) {
        struct fence_input *input;

        job->inputs = xgrow(job->inputs, &job->input_capacity, job->input_count + 1, sizeof job->inputs[0]);
        input = &job->inputs[job->input_count++];
        *input = (struct fence_input){0};
        if (!read_text(&node, "place", &input->place, error) || !read_path(&node, "root", true, &input->root, error) ||
            !read_path(&node, "folder", false, &input->folder, error) ||
            !read_path(&node, "path", true, &input->path, error))
            return false;
    }
    return true;
}

static bool read_job(struct fence_job *job, const struct json_node *object, struct error *error)
{
    struct json_node output = json_node_child(object, "output"), id = json_node_child(&output, "root_id");

    if (!json_node_is_absent(&id) && !read_text(&output, "root_id", &job->root_id, error)) return false;
    return read_inputs(job, object, error) && read_path(&output, "root", true, &job->output_root, error) &&
           read_path(&output, "folder", false, &job->output_folder, error);
}

static bool read_others(struct fence *fence, const struct json_node *params, struct error *error)
{
    struct json_node others = json_node_child(params, "others"), node = {0};

    if (json_node_is_absent(&others)) return true;
    if (!json_check_array(&others, 0, OTHER_LIMIT, error)) return false;
    while (json_node_next(&others, &node)) {
        fence->others = xgrow(fence->others, &fence->other_capacity, fence->other_count + 1, sizeof fence->others[0]);
        fence->others[fence->other_count] = (struct fence_job){0};
        if (!read_job(&fence->others[fence->other_count++], &node, error)) return false;
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
    struct json_node converter = json_node_child(&message->body, "converter");

    *fence = (struct fence){0};
    if (!message->method || strcmp(message->method, "worker.fence") != 0) {
        error_set(error, "expected worker.fence, got %s", message->method ? message->method : "an answer");
        return false;
    }
    if (read_job(&fence->job, &message->body, error) && read_others(fence, &message->body, error) &&
        read_closed(fence, &message->body, error) && json_read_bool(&converter, &fence->has_converter, error))
        return true;
    error_prefix(error, "worker.fence");
    fence_finish(fence);
    return false;
}

static void finish_job(struct fence_job *job)
{
    for (size_t i = 0; i < job->input_count; i++) {
        free(job->inputs[i].place);
        free(job->inputs[i].root);
        free(job->inputs[i].folder);
        free(job->inputs[i].path);
    }
    free(job->inputs);
    free(job->output_root);
    free(job->root_id);
    free(job->output_folder);
}

void fence_finish(struct fence *fence)
{
    finish_job(&fence->job);
    for (size_t i = 0; i < fence->other_count; i++)
        finish_job(&fence->others[i]);
    free(fence->others);
    path_list_finish(&fence->closed);
    *fence = (struct fence){0};
}
