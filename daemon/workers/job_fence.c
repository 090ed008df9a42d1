// SPDX-License-Identifier: Apache-2.0
#include "daemon/workers/job_fence.h"

#include "core/base/error.h"
#include "core/job/input_roots.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "core/scene/file_format.h"
#include "core/wire/message.h"
#include "daemon/farm/farm.h"
#include "daemon/settings/options.h"
#include "daemon/store/store_reader.h"

#include <stdlib.h>
#include <string.h>

static void write_inputs(const struct job_inputs *inputs, struct json_writer *writer)
{
    json_write_key(writer, "inputs");
    json_write_begin_array(writer);
    for (size_t i = 0; i < inputs->count; i++) {
        json_write_begin_object(writer);
        json_write_string_member(writer, "place", inputs->inputs[i].place);
        json_write_string_member(writer, "root", inputs->inputs[i].root);
        json_write_string_member(writer, "folder", inputs->inputs[i].folder);
        json_write_string_member(writer, "path", inputs->inputs[i].path);
        json_write_end_object(writer);
    }
    json_write_end_array(writer);
}

static void write_output(const struct job_record *record, struct json_writer *writer)
{
    json_write_key(writer, "output");
    json_write_begin_object(writer);
    json_write_string_member(writer, "root", record->root);
    json_write_string_member(writer, "folder", record->path.folder);
    json_write_end_object(writer);
}

static void write_closed(const struct options *options, struct json_writer *writer)
{
    json_write_key(writer, "closed");
    json_write_begin_array(writer);
    json_write_string(writer, options->state_folder);
    json_write_string(writer, options->socket_path);
    json_write_end_array(writer);
}

static bool needs_converter(const struct job_inputs *inputs)
{
    for (size_t i = 0; i < inputs->count; i++) {
        const struct file_format *format = file_format_find(inputs->inputs[i].path);

        if (format && format->needs_converter) return true;
    }
    return false;
}

static void write_fence(const struct farm *farm, const struct job_record *record, const struct job_inputs *inputs,
                        struct json_writer *writer)
{
    message_begin_notification(writer, "worker.fence");
    json_write_begin_object(writer);
    write_inputs(inputs, writer);
    write_output(record, writer);
    write_closed(farm->options, writer);
    json_write_bool_member(writer, "converter", needs_converter(inputs));
    json_write_end_object(writer);
    message_end(writer);
}

bool job_fence_write(const struct farm *farm, const struct job_record *record, struct json_writer *writer,
                     bool *is_job_fault, struct error *error)
{
    struct job_inputs inputs = {0};
    struct job job = {0};
    struct cJSON *tree = NULL;
    struct json_node root;
    char *document = NULL;
    bool ok = false;

    *is_job_fault = false;
    if (!store_read_document(farm->reader, record->id, &document, error)) return false;
    *is_job_fault = true;
    if (!json_parse(&tree, document, strlen(document), error)) goto out;
    root = json_node_root(tree);
    if (!job_from_json(&job, &root, record->root, error)) goto out;
    if (!input_roots_find(&inputs, &job, &farm->options->input_roots, error)) goto out;
    write_fence(farm, record, &inputs, writer);
    ok = true;
out:
    job_inputs_finish(&inputs);
    job_finish(&job);
    json_delete(tree);
    free(document);
    return ok;
}
