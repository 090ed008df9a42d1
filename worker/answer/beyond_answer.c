// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/beyond_answer.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "core/json/json_write.h"
#include "worker/plan/plan_beyond.h"

static bool on_progress(void *user, double done)
{
    const struct request_tools *tools = user;

    (void)done;
    return !tools->is_wanted || tools->is_wanted(tools->user);
}

bool beyond_answer_find(const struct job *job, const struct request_tools *tools, struct job_beyond *beyond,
                        struct error *error)
{
    const struct plan_params params = {.job = job, .on_progress = on_progress, .user = (void *)tools};

    if (plan_beyond_measure_asked(&params, beyond)) return true;
    error_set(error, "nobody waits for the answer");
    return false;
}

bool beyond_answer(const struct json_node *params, const struct request_tools *tools, struct json_writer *writer,
                   enum message_code *code, struct error *error)
{
    struct job_beyond beyond;
    struct job job = {0};
    bool ok;

    *code = MESSAGE_CODE_PARAMS;
    if (!request_read_job(params, &job, error)) return false;
    *code = MESSAGE_CODE_INTERNAL;
    ok = beyond_answer_find(&job, tools, &beyond, error);
    if (ok) {
        json_write_begin_object(writer);
        job_beyond_write(&beyond, writer);
        json_write_end_object(writer);
    }
    job_finish(&job);
    return ok;
}
