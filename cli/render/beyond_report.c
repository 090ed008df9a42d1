// SPDX-License-Identifier: Apache-2.0
#include "cli/render/beyond_report.h"

#include "cli/peer/worker_child.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"

#include <stdio.h>
#include <string.h>

void beyond_report_ask(const struct options *options, const struct job *job, const char *document,
                       struct job_beyond *beyond)
{
    struct json_writer params = {0};
    struct error error = {{0}};
    struct message reply;

    *beyond = (struct job_beyond){0};
    if (job->scene.orders == SCENE_ORDERS_ALL) return;
    json_write_begin_object(&params);
    json_write_key(&params, "document");
    json_write_raw(&params, document, strlen(document));
    json_write_string_member(&params, "root", "/");
    json_write_end_object(&params);
    if (worker_child_ask(options, &(struct worker_question){.method = "worker.beyond", .params = params.text}, &reply,
                         &error) == EXIT_STATUS_DONE) {
        beyond_report_read(&reply.body, beyond);
        message_finish(&reply);
    }
    json_writer_finish(&params);
}

void beyond_report_read(const struct json_node *answer, struct job_beyond *beyond)
{
    (void)job_beyond_read(beyond, answer, NULL);
}

void beyond_report_warn(const struct job_beyond *beyond, const struct job *job)
{
    char text[JOB_BEYOND_TEXT_SIZE];

    if (!job_beyond_is_over(beyond, job->quality.tolerance)) return;
    job_beyond_describe(beyond, job->scene.orders, text);
    fprintf(stderr, "warning: quality.tolerance: %g is of the orders that are modelled: %s\n", job->quality.tolerance,
            text);
}
