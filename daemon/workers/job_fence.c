// SPDX-License-Identifier: Apache-2.0
#include "daemon/workers/job_fence.h"

#include "core/base/alloc.h"
#include "core/base/path_list.h"
#include "core/job/input_roots.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"
#include "daemon/farm/farm.h"
#include "daemon/settings/options.h"

#include <stdlib.h>
#include <string.h>

// A fence is made on the daemon's loop.
enum {
    JOB_LIMIT = 64,
    INPUT_LIMIT = 512,  // of all its jobs; the first job may have more
    SEARCH_LIMIT = 4096 // jobs of the queue that are looked at
};

struct fenced_job {
    struct job_fence_files files;
    const struct root *root; // borrowed from the farm; of its output
    int64_t generation;      // of the root, when the fence was made
    char *folder;            // owned; of its output
};

struct job_fence {
    int64_t owner_uid;
    struct fenced_job *jobs; // owned; the first is the job that the worker is started for
    size_t count, capacity;
    bool is_shared;
};

static bool find_files(struct job_fence_files *files, const struct farm *farm, const struct job_record *record,
                       struct error *error)
{
    *files = (struct job_fence_files){.job = record->id};
    files->is_found = input_roots_find(&files->inputs, &record->inputs, &farm->options->input_roots, error);
    files->has_converter = job_inputs_need_converter(&files->inputs);
    return files->is_found;
}

void job_fence_files_finish(struct job_fence_files *files)
{
    job_inputs_finish(&files->inputs);
    *files = (struct job_fence_files){0};
}

// Takes the files over.
static void add(struct job_fence *fence, const struct job_record *record, const struct job_fence_files *files)
{
    fence->jobs = xgrow(fence->jobs, &fence->capacity, fence->count + 1, sizeof fence->jobs[0]);
    fence->jobs[fence->count++] = (struct fenced_job){.files = *files,
                                                      .root = record->output_root,
                                                      .generation = record->output_root->generation,
                                                      .folder = xstrdup(record->path.folder)};
}

// The files of the owner's jobs that come next. A job that has none to be found is left to a worker of its own.
static void add_next_jobs(struct job_fence *fence, const struct farm *farm, const struct queue_job *queued)
{
    size_t inputs = fence->jobs[0].files.inputs.count;

    for (int i = 0; queued && i < SEARCH_LIMIT && fence->count < JOB_LIMIT; queued = queued->next, i++) {
        const struct job_record *record = job_table_find(&farm->jobs, queued->id);
        struct job_fence_files files = {0};

        if (record->owner_uid != fence->owner_uid || record->needs_own_worker || queued->is_paused ||
            queued->block != QUEUE_OPEN || queued->states.counts[FRAME_QUEUED] == 0)
            continue;
        if (find_files(&files, farm, record, NULL)) inputs += files.inputs.count;
        if (files.is_found && !files.has_converter && inputs <= INPUT_LIMIT)
            add(fence, record, &files);
        else
            job_fence_files_finish(&files);
        if (inputs > INPUT_LIMIT) return;
    }
}

// Compares texts. Folders are relative to their root; "" is the root itself.
static bool is_in(const char *folder, const char *other)
{
    size_t length = strlen(other);

    return length == 0 || (strncmp(folder, other, length) == 0 && (folder[length] == '/' || folder[length] == '\0'));
}

// Whether the record's job writes into the job's output folder, or into one inside it.
static bool holds_output(const struct fenced_job *job, const struct job_record *record)
{
    return is_in(record->path.folder, job->folder) && job->root == record->output_root;
}

static void remove_job(struct job_fence *fence, size_t index)
{
    job_fence_files_finish(&fence->jobs[index].files);
    free(fence->jobs[index].folder);
    fence->jobs[index] = fence->jobs[--fence->count];
}

// Other owners' files stay closed to jobs that do not write beside them.
static void leave_out_shared(struct job_fence *fence, const struct farm *farm)
{
    for (size_t i = 0; i < farm->jobs.count; i++) {
        const struct job_record *record = farm->jobs.records[i];

        if (record->owner_uid == fence->owner_uid) continue;
        for (size_t k = fence->count; k-- > 1;)
            if (holds_output(&fence->jobs[k], record)) remove_job(fence, k);
        if (holds_output(&fence->jobs[0], record)) fence->is_shared = true;
    }
    while (fence->is_shared && fence->count > 1)
        remove_job(fence, fence->count - 1);
}

struct job_fence *job_fence_create(const struct farm *farm, const struct job_record *record, struct error *error)
{
    struct job_fence *fence;
    struct job_fence_files files;

    if (!find_files(&files, farm, record, error)) return NULL;
    fence = xcalloc(1, sizeof *fence);
    fence->owner_uid = record->owner_uid;
    add(fence, record, &files);
    if (!files.has_converter) add_next_jobs(fence, farm, record->queued->next);
    leave_out_shared(fence, farm);
    return fence;
}

void job_fence_destroy(struct job_fence *fence)
{
    if (!fence) return;
    while (fence->count > 0)
        remove_job(fence, fence->count - 1);
    free(fence->jobs);
    free(fence);
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

// Writes members of an object that is begun.
static void write_job(const struct fenced_job *job, struct json_writer *writer)
{
    write_inputs(&job->files.inputs, writer);
    json_write_key(writer, "output");
    json_write_begin_object(writer);
    json_write_string_member(writer, "root", job->root->path);
    json_write_string_member(writer, "root_id", job->root->id);
    json_write_string_member(writer, "folder", job->folder);
    json_write_end_object(writer);
}

static void write_others(const struct job_fence *fence, struct json_writer *writer)
{
    json_write_key(writer, "others");
    json_write_begin_array(writer);
    for (size_t i = 1; i < fence->count; i++) {
        json_write_begin_object(writer);
        write_job(&fence->jobs[i], writer);
        json_write_end_object(writer);
    }
    json_write_end_array(writer);
}

static void write_closed(const struct options *options, struct json_writer *writer)
{
    json_write_key(writer, "closed");
    json_write_begin_array(writer);
    json_write_string(writer, options->state_folder);
    json_write_string(writer, options->socket_path);
    json_write_end_array(writer);
}

void job_fence_write(const struct job_fence *fence, const struct farm *farm, struct json_writer *writer)
{
    message_begin_notification(writer, "worker.fence");
    json_write_begin_object(writer);
    write_job(&fence->jobs[0], writer);
    write_others(fence, writer);
    write_closed(farm->options, writer);
    json_write_bool_member(writer, "converter", fence->jobs[0].files.has_converter);
    json_write_end_object(writer);
    message_end(writer);
}

// An input root itself is never opened, only files in it.
static bool opens_input(const struct job_inputs *open, const struct job_input *input)
{
    for (size_t i = 0; i < open->count; i++) {
        const struct job_input *other = &open->inputs[i];

        if (strcmp(other->root, input->root) != 0) continue;
        if (strcmp(other->path, input->path) == 0) return true;
        if (*other->folder && is_in(input->folder, other->folder)) return true;
    }
    return false;
}

static bool opens_inputs(const struct job_fence *fence, const struct job_inputs *inputs)
{
    for (size_t i = 0; i < inputs->count; i++) {
        bool is_open = false;

        for (size_t k = 0; k < fence->count && !is_open; k++)
            is_open = opens_input(&fence->jobs[k].files.inputs, &inputs->inputs[i]);
        if (!is_open) return false;
    }
    return true;
}

static bool opens_output(const struct job_fence *fence, const struct job_record *record)
{
    for (size_t i = 0; i < fence->count; i++)
        if (holds_output(&fence->jobs[i], record)) return true;
    return false;
}

bool job_fence_note_job(struct job_fence *fence, const struct job_record *record)
{
    if (record->owner_uid != fence->owner_uid && opens_output(fence, record)) fence->is_shared = true;
    return fence->is_shared;
}

bool job_fence_is_shared(const struct job_fence *fence)
{
    return fence->is_shared;
}

bool job_fence_is_old(const struct job_fence *fence)
{
    for (size_t i = 0; i < fence->count; i++)
        if (fence->jobs[i].generation != fence->jobs[i].root->generation) return true;
    return false;
}

// The roots may have changed since.
static bool has_old_roots(const struct job_fence *fence, const struct path_list *roots)
{
    for (size_t i = 0; i < fence->count; i++)
        for (size_t k = 0; k < fence->jobs[i].files.inputs.count; k++) {
            const struct job_input *input = &fence->jobs[i].files.inputs.inputs[k];
            const char *root = path_list_find_root(roots, input->path);

            if (!root || strcmp(root, input->root) != 0) return true;
        }
    return false;
}

static void read_files(struct job_fence_files *files, const struct farm *farm, const struct job_record *record)
{
    job_fence_files_finish(files);
    (void)find_files(files, farm, record, NULL);
}

bool job_fence_opens(const struct job_fence *fence, const struct farm *farm, const struct job_record *record,
                     struct job_fence_files *files)
{
    if (fence->owner_uid != record->owner_uid || fence->jobs[0].files.has_converter) return false;
    if (fence->is_shared || !opens_output(fence, record) || has_old_roots(fence, &farm->options->input_roots))
        return false;
    if (files->job != record->id) read_files(files, farm, record);
    return files->is_found && !files->has_converter && opens_inputs(fence, &files->inputs);
}
