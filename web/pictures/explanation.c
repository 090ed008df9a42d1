// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/explanation.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/path_list.h"
#include "core/job/input_roots.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "core/scene/input_path.h"
#include "core/wire/message.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

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

// Which version of a file is there, or that there is none.
static void write_version(struct json_writer *writer, const char *path)
{
    struct stat status;

    json_write_string(writer, path);
    if (stat(path, &status) != 0) return;
    json_write_integer(writer, (int64_t)status.st_ino);
    json_write_integer(writer, status.st_size);
    json_write_integer(writer, status.st_mtim.tv_sec);
    json_write_integer(writer, status.st_mtim.tv_nsec);
}

enum picture_status explanation_make_key(const struct explanation *explanation, char key[static HASH_TEXT_SIZE],
                                         struct error *error)
{
    struct job_inputs inputs = {0};
    struct json_writer writer = {0};
    int32_t first_frame;
    enum picture_status status = find_inputs(explanation, &inputs, &first_frame, error);

    if (status != PICTURE_READY) return status;
    json_write_begin_array(&writer);
    json_write_string(&writer, "worker.explain");
    json_write_string(&writer, explanation->document);
    write_version(&writer, explanation->worker);
    for (size_t i = 0; i < inputs.count; i++) {
        char *path = input_path_format(inputs.inputs[i].path, first_frame);

        json_write_string(&writer, inputs.inputs[i].root);
        write_version(&writer, path);
        free(path);
    }
    json_write_end_array(&writer);
    hash_bytes(writer.text, writer.length, key);
    json_writer_finish(&writer);
    job_inputs_finish(&inputs);
    return PICTURE_READY;
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
    json_write_bool_member(writer, "converter", false);
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
