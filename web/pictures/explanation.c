// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/explanation.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/path_list.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "core/json/json_read.h"
#include "core/scene/input_path.h"
#include "core/wire/message.h"
#include "web/pictures/input_version.h"

#include <stdlib.h>
#include <string.h>

static const char output_root[] = "/"; // nothing is written there

// The files that the job reads. PICTURE_READY, or why not.
static enum picture_status find_inputs(const struct explanation *explanation, struct job_inputs *inputs,
                                       int32_t *first_frame, struct error *error)
{
    enum picture_status status = PICTURE_UNREADABLE;
    struct job_paths paths = {0};
    struct cJSON *root = NULL;
    struct job job = {0};
    struct json_node document;

    if (!json_parse(&root, explanation->document, strlen(explanation->document), error)) return status;
    document = json_node_root(root);
    if (job_from_json(&job, &document, output_root, error)) {
        job_paths_list(&paths, &job);
        *first_frame = frame_range_at(&job.frames, 0);
        status = input_roots_find(inputs, &paths, explanation->roots, error) ? PICTURE_READY : PICTURE_FORBIDDEN;
    }
    job_paths_finish(&paths);
    job_finish(&job);
    json_delete(root);
    return status;
}

enum picture_status explanation_key_begin(struct explanation_key *key, const struct explanation *explanation,
                                          struct error *error)
{
    enum picture_status status;

    *key = (struct explanation_key){0};
    status = find_inputs(explanation, &key->inputs, &key->first_frame, error);
    if (status != PICTURE_READY) return status;
    json_write_begin_array(&key->writer);
    json_write_string(&key->writer, "worker.explain");
    json_write_string(&key->writer, explanation->document);
    input_version_write(explanation->worker, "/", &key->writer);
    return PICTURE_READY;
}

const char *explanation_key_root(const struct explanation_key *key)
{
    return key->next < key->inputs.count ? key->inputs.inputs[key->next].root : NULL;
}

void explanation_key_look(struct explanation_key *key)
{
    const char *root = explanation_key_root(key);

    while (explanation_key_root(key) && !strcmp(explanation_key_root(key), root)) {
        char *path = input_path_format(key->inputs.inputs[key->next++].path, key->first_frame);

        json_write_string(&key->writer, root);
        input_version_write(path, root, &key->writer);
        free(path);
    }
}

void explanation_key_make(const struct explanation_key *key, char text[static HASH_TEXT_SIZE])
{
    hash_bytes(key->writer.text, key->writer.length, text);
}

void explanation_key_finish(struct explanation_key *key)
{
    json_writer_finish(&key->writer);
    job_inputs_finish(&key->inputs);
    *key = (struct explanation_key){0};
}

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

static void write_fence(const struct job_inputs *inputs, const char *folder, struct json_writer *writer)
{
    const char *slash = strrchr(folder, '/');
    char *cache = xstrndup(folder, slash == folder ? 1 : (size_t)(slash - folder));

    message_begin_notification(writer, "worker.fence");
    json_write_begin_object(writer);
    write_inputs(inputs, writer);
    json_write_key(writer, "output");
    json_write_begin_object(writer);
    json_write_string_member(writer, "root", folder);
    json_write_string_member(writer, "folder", "");
    json_write_end_object(writer);
    json_write_key(writer, "closed");
    json_write_begin_array(writer);
    json_write_string(writer, cache);
    json_write_end_array(writer);
    json_write_bool_member(writer, "converter", job_inputs_need_converter(inputs));
    json_write_end_object(writer);
    message_end(writer);
    free(cache);
}

bool explanation_write(const struct explanation *explanation, const char *folder, struct json_writer *writer,
                       struct error *error)
{
    struct job_inputs inputs = {0};
    int32_t first_frame;

    if (find_inputs(explanation, &inputs, &first_frame, error) != PICTURE_READY) return false;
    write_fence(&inputs, folder, writer);
    message_begin_request(writer, 1, "worker.explain");
    json_write_begin_object(writer);
    json_write_key(writer, "document");
    json_write_raw(writer, explanation->document, strlen(explanation->document));
    json_write_string_member(writer, "root", output_root);
    json_write_end_object(writer);
    message_end(writer);
    job_inputs_finish(&inputs);
    return true;
}
