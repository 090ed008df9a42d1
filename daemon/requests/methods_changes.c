// SPDX-License-Identifier: Apache-2.0
#include "daemon/farm/farm.h"
#include "daemon/requests/methods.h"
#include "daemon/requests/requests.h"
#include "daemon/requests/shapes.h"

#include <stddef.h>

static const struct member id_params[] = {
    {"id", "integer", .meaning = "the job", .min = 1},
    {0},
};

static const struct member submit_params[] = {
    {"document", "object", .meaning = "the job, with absolute paths of input files and GLSL as text"},
    {"paused", "boolean", .meaning = "it waits until it is resumed", .fallback = "false", .is_optional = true},
    {0},
};
static const struct member submit_result[] = {
    {"id", "integer", .meaning = "the new job", .min = 1},
    {"warnings", "string[]", .meaning = "what nobody could check now", .is_optional = true},
    {0},
};

static const struct member retry_params[] = {
    {"id", "integer", .meaning = "the job", .min = 1},
    {"state", "string", .meaning = "states of the frames: failed, canceled, succeeded or skipped",
     .names = frame_state_names, .fallback = "[\"failed\"]", .is_optional = true, .is_set = true},
    {"range", "string", .meaning = "frames, as in 1-100x2,140; absent: all", .is_optional = true},
    {"force", "boolean", .meaning = "a frame whose file is there and whole is rendered, too", .fallback = "false",
     .is_optional = true},
    {0},
};
static const struct member retry_result[] = {
    {"retried", "integer", .meaning = "frames that were queued"},
    {0},
};

static const struct member delete_params[] = {
    {"id", "integer", .meaning = "a job that is over", .min = 1},
    {"files", "boolean", .meaning = "its files are removed, too", .fallback = "false", .is_optional = true},
    {0},
};
static const struct member delete_result[] = {
    {"files_removed", "integer", .meaning = "files that are gone now"},
    {"files_kept", "integer", .meaning = "files that stay, since they are not what was published"},
    {"files_missing", "integer", .meaning = "files that were gone before"},
    {"files_found", "integer", .meaning = "files of skipped frames, which stay"},
    {0},
};

static const struct member priority_params[] = {
    {"id", "integer", .meaning = "the job", .min = 1},
    {"priority", "integer", .meaning = "at most 100, of administrators 200", .min = 0, .max = 200},
    {0},
};

const struct method methods_of_changes[] = {
    {"job.submit", requests_job_submit, "Takes a job.", NEED_SUBMIT, .params = submit_params, .result = submit_result},
    {"job.pause", requests_job_pause, "Begins none of its frames.", NEED_SUBMIT, .params = id_params,
     .result_shape = &shape_job},
    {"job.resume", requests_job_resume, "Ends a pause.", NEED_SUBMIT, .params = id_params, .result_shape = &shape_job},
    {"job.cancel", requests_job_cancel, "Ends a job.", NEED_SUBMIT, .params = id_params, .result_shape = &shape_job},
    {"job.retry", requests_job_retry, "Renders frames again.", NEED_SUBMIT, .params = retry_params,
     .result = retry_result},
    {"job.priority", requests_job_priority, "Changes a job's priority.", NEED_SUBMIT, .params = priority_params,
     .result_shape = &shape_job},
    {"job.delete", requests_job_delete, "Forgets a job.", NEED_SUBMIT, .params = delete_params,
     .result = delete_result},
    {0},
};
