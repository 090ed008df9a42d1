// SPDX-License-Identifier: Apache-2.0
#include "cli/farm/job_pages.h"

#include "cli/farm/job_states.h"
#include "cli/peer/connection.h"
#include "core/base/alloc.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"

#include <stdlib.h>

enum { PAGE_SIZE = 1000 };

// `left`: jobs that are wanted still; negative: all.
static bool ask_page(const struct job_pages *pages, struct connection *connection, const char *cursor, int64_t left,
                     struct message *reply, struct error *error)
{
    struct json_writer params = {0};
    bool ok;

    json_write_begin_object(&params);
    job_states_write(&params, pages->states);
    if (pages->owner) json_write_string_member(&params, "owner", pages->owner);
    if (pages->name) json_write_string_member(&params, "name", pages->name);
    if (pages->since_s >= 0) json_write_integer_member(&params, "since", pages->since_s);
    if (left >= 0) json_write_string_member(&params, "order", "-id");
    if (cursor) json_write_string_member(&params, "cursor", cursor);
    json_write_integer_member(&params, "limit", left >= 0 && left < PAGE_SIZE ? left : PAGE_SIZE);
    json_write_end_object(&params);
    ok = connection_call(connection, "job.list", params.text, reply, error);
    json_writer_finish(&params);
    return ok;
}

// `*cursor` is owned by the caller; NULL after the last page.
static bool read_page(const struct job_pages *pages, const struct json_node *result, char **cursor, int64_t *left,
                      struct error *error)
{
    struct json_node jobs = json_node_child(result, "jobs"), next = json_node_child(result, "next"), job = {0};
    const char *text;

    while (json_node_next(&jobs, &job)) {
        if (*left > 0) --*left;
        if (!pages->on_job(pages->user, &job, error)) return false;
    }
    free(*cursor);
    *cursor = *left != 0 && json_read_string(&next, &text, NULL) ? xstrdup(text) : NULL;
    return true;
}

enum exit_status job_pages_read(const struct job_pages *pages, struct connection *connection, struct error *error)
{
    enum exit_status status = EXIT_STATUS_DONE;
    int64_t left = pages->limit > 0 ? pages->limit : -1;
    char *cursor = NULL;

    do {
        struct message reply;

        if (!ask_page(pages, connection, cursor, left, &reply, error)) {
            status = connection_failure(connection);
            break;
        }
        if (!read_page(pages, &reply.body, &cursor, &left, error)) status = EXIT_STATUS_FAILED;
        message_finish(&reply);
    } while (cursor && status == EXIT_STATUS_DONE);
    free(cursor);
    return status;
}
