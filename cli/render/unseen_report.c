// SPDX-License-Identifier: Apache-2.0
#include "cli/render/unseen_report.h"

#include "cli/peer/worker_child.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"

#include <string.h>

static bool has_grid(const struct scene *scene)
{
    for (size_t i = 0; i < scene->medium_count; i++)
        if (scene->media[i].density.kind == SCENE_DENSITY_GRID) return true;
    return false;
}

void unseen_report_find(const struct options *options, const struct job *job, const char *document,
                        job_warnings_on_found *on_found, void *user)
{
    static const char place[] = "scene.";
    struct json_writer params = {0};
    struct json_node warnings, warning = {0};
    struct error error = {0};
    struct message reply;
    const char *text;

    if (!has_grid(&job->scene)) return;
    json_write_begin_object(&params);
    json_write_key(&params, "document");
    json_write_raw(&params, document, strlen(document));
    json_write_string_member(&params, "root", "/");
    json_write_end_object(&params);
    if (worker_child_ask(options, &(struct worker_question){.method = "worker.unseen", .params = params.text}, &reply,
                         &error) == EXIT_STATUS_DONE) {
        warnings = json_node_child(&reply.body, "warnings");
        while (json_node_next(&warnings, &warning))
            if (json_read_string(&warning, &text, NULL)) on_found(user, text);
        message_finish(&reply);
    } else if (strncmp(error.message, place, strlen(place)) == 0) {
        on_found(user, error.message);
    }
    json_writer_finish(&params);
}
