// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/job_document.h"

#include "core/base/alloc.h"
#include "core/job/job_check.h"
#include "core/job/job_json.h"
#include "core/json/json_read.h"
#include "daemon/clients/answer.h"
#include "daemon/clients/client.h"
#include "daemon/farm/farm.h"
#include "daemon/loop/memory_return.h"
#include "daemon/requests/request.h"

#include <stdlib.h>
#include <string.h>

static void on_run(struct work_piece *piece);
static void on_done(struct work_piece *piece, bool was_run);

void job_document_read(struct request *request, const char *root, bool is_paused,
                       void (*on_read)(struct job_document *reading, bool was_read))
{
    struct job_document *reading = xcalloc(1, sizeof *reading);

    reading->piece =
        (struct work_piece){.run = on_run, .done = on_done, .uid = request->client->peer.uid, .goes_on = true};
    reading->on_read = on_read;
    reading->farm = request->farm;
    reading->client = request->client;
    reading->answer = request_defer_answer(request, false);
    reading->root = xstrdup(root);
    reading->is_paused = is_paused;
    reading->request = message_take_root(request->message);
    client_hold(request->client, CLIENT_PENDING_LIMIT);
    work_desk_put(request->farm->work, &reading->piece);
}

// Places in messages start where the client's request has the document.
static void on_run(struct work_piece *piece)
{
    struct job_document *reading = (struct job_document *)piece;
    struct json_node root = json_node_root(reading->request), params = json_node_child(&root, "params"), document;
    struct job *job = &reading->job;

    params.parent = NULL;
    document = json_node_child(&params, "document");
    reading->ok = job_from_json(job, &document, reading->root, &reading->error) &&
                  job_check_inputs(job, &document, &reading->error) && job_check_names(job, &reading->error);
    if (reading->ok) {
        job_paths_list(&reading->paths, job);
        reading->document = json_node_format(&document);
        reading->length = strlen(reading->document);
    }
    json_delete(reading->request);
    reading->request = NULL;
    memory_return_trim(reading->length * MEMORY_RETURN_PARSED);
}

static void on_done(struct work_piece *piece, bool was_run)
{
    struct job_document *reading = (struct job_document *)piece;

    reading->on_read(reading, was_run);
    memory_return_note(reading->farm->memory, reading->length * MEMORY_RETURN_PARSED);
    client_release(reading->client, CLIENT_PENDING_LIMIT);
    job_finish(&reading->job);
    job_paths_finish(&reading->paths);
    json_delete(reading->request);
    free(reading->document);
    free(reading->root);
    free(reading);
}
