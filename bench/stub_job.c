// SPDX-License-Identifier: Apache-2.0
#include "bench/stub_job.h"

#include "bench/stub_report.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "core/job/output_root.h"
#include "core/json/json_read.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int64_t read_integer(const struct json_node *object, const char *key)
{
    struct json_node node = json_node_child(object, key);
    int64_t integer = 0;

    json_read_integer(&node, 0, INT64_MAX, &integer, NULL);
    return integer;
}

// NULL: there is none.
static char *copy_text(const struct json_node *params, const char *key)
{
    struct json_node node = json_node_child(params, key);
    const char *text;

    return json_read_string(&node, &text, NULL) ? xstrdup(text) : NULL;
}

bool stub_job_read(struct stub_job *job, const struct json_node *params)
{
    struct json_node document = json_node_child(params, "document");
    struct job parsed = {0};
    struct error error = {0};

    *job = (struct stub_job){.id = read_integer(params, "job"),
                             .epoch = read_integer(params, "epoch"),
                             .root = copy_text(params, "root"),
                             .root_id = copy_text(params, "root_id"),
                             .farm_id = copy_text(params, "farm_id")};
    if (!job->root || !job_from_json(&parsed, &document, job->root, &error)) {
        fprintf(stderr, "stub: %s\n", error.message);
        stub_job_finish(job);
        return false;
    }
    job->path = parsed.output.path;
    parsed.output.path = (struct output_path){0};
    job_finish(&parsed);
    return true;
}

void stub_job_finish(struct stub_job *job)
{
    free(job->root);
    free(job->root_id);
    free(job->farm_id);
    output_path_finish(&job->path);
}

static void format_part(const struct stub_job *job, const struct stub_frame *frame, char part[static OUTPUT_NAME_SIZE])
{
    const struct output_part names = {
        .farm = job->farm_id, .job = frame->job, .epoch = job->epoch, .frame = frame->frame, .attempt = frame->attempt};

    output_path_format_part(&job->path, &names, part);
}

bool stub_job_write_file(const struct stub_job *job, const struct stub_frame *frame, bool is_found, struct stat *status,
                         char hash[static HASH_TEXT_SIZE], const char **fault, struct error *error)
{
    char part[OUTPUT_NAME_SIZE], text[64];
    int folder = output_root_open_folder(&job->path, job->root, job->root_id, false, error);
    int file = -1;
    bool ok = false;

    *fault = folder == OUTPUT_ROOT_AWAY ? "root" : "output";
    if (folder < 0) return false;
    if (is_found)
        output_path_format_name(&job->path, frame->frame, part);
    else
        format_part(job, frame, part);
    if (job->names_job)
        snprintf(text, sizeof text, "frame %d of job %lld\n", frame->frame, (long long)frame->job);
    else
        snprintf(text, sizeof text, "frame %d\n", frame->frame);
    file = openat(folder, part, O_RDWR | O_CREAT | (is_found ? 0 : O_TRUNC) | O_CLOEXEC, 0644);
    if (file < 0) {
        error_set_errno(error, errno, "%s", part);
        goto out;
    }
    if (is_found && fstat(file, status) == 0 && status->st_size > 0) {
        ok = hash_file(file, hash, NULL, error);
        goto out;
    }
    if (!file_write_all(file, text, strlen(text), error)) goto out;
    if ((!is_found && fsync(file) != 0) || fstat(file, status) != 0) {
        error_set_errno(error, errno, "%s", part);
        goto out;
    }
    hash_bytes(text, strlen(text), hash);
    ok = true;
out:
    if (file >= 0) close(file);
    if (!ok && !is_found) unlinkat(folder, part, 0);
    close(folder);
    return ok;
}

void stub_job_spoil_file(const struct stub_job *job, const struct stub_frame *frame, bool is_removed)
{
    int folder = output_root_open_folder(&job->path, job->root, job->root_id, false, NULL);
    char part[OUTPUT_NAME_SIZE];
    int file = -1;

    if (folder < 0) return;
    format_part(job, frame, part);
    if (is_removed)
        unlinkat(folder, part, 0);
    else
        file = openat(folder, part, O_WRONLY | O_CLOEXEC);
    if (file >= 0 && ftruncate(file, 3) != 0) fprintf(stderr, "stub: cannot cut %s\n", part);
    if (file >= 0) close(file);
    close(folder);
}
