// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/request.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_check.h"
#include "core/job/job_json.h"
#include "core/json/json_read.h"
#include "worker/plan/draft.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

struct request *request_create(struct message *message)
{
    struct request *request = xcalloc(1, sizeof *request);

    request->message = *message;
    *message = (struct message){0};
    return request;
}

void request_destroy(struct request *request)
{
    message_finish(&request->message);
    free(request);
}

void request_destroy_all(struct request *first)
{
    while (first) {
        struct request *next = first->next;

        request_destroy(first);
        first = next;
    }
}

bool request_read_job(const struct json_node *params, struct job *job, struct error *error)
{
    struct json_node document = json_node_child(params, "document");
    struct json_node document_root = json_node_root(document.value); // errors name positions as in the job file
    struct json_node output_root = json_node_child(params, "root");
    const char *output_root_path = NULL;

    if (!json_node_is_absent(&output_root) && !json_read_string(&output_root, &output_root_path, error)) return false;
    if (!job_from_json(job, &document_root, output_root_path, error)) return false;
    if (job_check_inputs(job, &document_root, error) && draft_settle(job, NULL, error)) return true;
    job_finish(job);
    return false;
}

bool request_check_renderer(const struct request_tools *tools, struct error *error)
{
    if (tools->renderer) return true;
    error_set(error, "the worker has no GL context: it was started with --backend none");
    return false;
}

int request_open_file(const char *path, int flags, struct error *error)
{
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | flags);
    struct stat status;

    if (fd < 0) {
        error_set_errno(error, errno, "it cannot be opened");
        return -1;
    }
    if (fstat(fd, &status) == 0 && S_ISREG(status.st_mode)) return fd;
    error_set(error, "it is no regular file");
    close(fd);
    return -1;
}
