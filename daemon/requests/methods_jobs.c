// SPDX-License-Identifier: Apache-2.0
#include "core/job/frame_range.h"
#include "daemon/farm/farm.h"
#include "daemon/requests/methods.h"
#include "daemon/requests/requests.h"
#include "daemon/requests/shapes.h"
#include "daemon/store/store_op.h"

#include <stddef.h>

static const struct member list_params[] = {
    {"state", "string", .meaning = "job states; absent: all", .names = job_state_names, .is_optional = true,
     .is_set = true},
    {"ids", "integer[]", .meaning = "at most 1000 jobs, of which those that are known are told; absent: all", .min = 1,
     .is_optional = true},
    {"owner", "string", .meaning = "a user's name; absent: of all", .is_optional = true},
    {"name", "string", .meaning = "a part of the job's name, in capitals or not; absent: any", .is_optional = true},
    {"since", "number", .meaning = "submitted at or after it (unix seconds)", .is_optional = true},
    {"before", "number", .meaning = "submitted before it (unix seconds)", .is_optional = true},
    {"order", "string", .meaning = "-id: the newest first", .names = job_list_orders, .fallback = "\"id\"",
     .is_optional = true},
    {"cursor", "string", .meaning = "the page behind the one whose `next` this is", .is_optional = true},
    {"limit", "integer", .meaning = "so many are told; absent: all", .min = 1, .max = 1000, .is_optional = true},
    {0},
};
static const struct member list_result[] = {
    {"jobs", "job[]", .meaning = "by their ids"},
    {"next", "string?", .meaning = "the cursor of the next page; null: there is none"},
    {"total", "integer", .meaning = "how many there are on all pages"},
    {0},
};

static const struct member show_params[] = {
    {"id", "integer", .meaning = "the job", .min = 1},
    {0},
};
static const struct member show_result[] = {
    {"document", "object?", .meaning = "as it was submitted; null: of somebody else's job"},
    {0},
};

static const struct member frames_params[] = {
    {"id", "integer", .meaning = "the job", .min = 1},
    {"state", "string", .meaning = "frame states; absent: all", .names = frame_state_names, .is_optional = true,
     .is_set = true},
    {"range", "string", .meaning = "frames, as in 1-100x2,140; absent: all", .is_optional = true},
    {"cursor", "string", .meaning = "the page behind the one whose `next` this is, in place of offset",
     .is_optional = true},
    {"offset", "integer", .meaning = "so many are left out", .min = 0, .max = FRAME_COUNT_LIMIT, .fallback = "0",
     .is_optional = true},
    {"limit", "integer", .meaning = "so many are told", .min = 0, .max = 10000, .fallback = "1000",
     .is_optional = true},
    {0},
};
static const struct member frames_result[] = {
    {"frames", "frame[]", .meaning = "in the job's order"},
    {"next", "string?", .meaning = "the cursor of the next page; null: there is none"},
    {"total", "integer", .meaning = "how many there are without offset and limit"},
    {0},
};

static const struct member map_params[] = {
    {"id", "integer", .meaning = "the job", .min = 1},
    {"offset", "integer", .meaning = "so many are left out", .min = 0, .max = FRAME_COUNT_LIMIT, .fallback = "0",
     .is_optional = true},
    {"limit", "integer", .meaning = "so many are told", .min = 1, .max = 50000, .fallback = "50000",
     .is_optional = true},
    {0},
};
static const struct member map_result[] = {
    {"frames", "string", .meaning = "all frames of the job, as in 1-100x2,140"},
    {"total", "integer", .meaning = "how many they are"},
    {"offset", "integer", .meaning = "how many of them come before the first that is told"},
    {"states", "string",
     .meaning = "a letter a frame: q(ueued), r(unning), s(ucceeded), f(ailed), c(anceled), k: "
                "skipped, m(issed the tolerance)"},
    {"seconds", "number?[]", .meaning = "of rendering, audit and encoding of each frame that was rendered"},
    {"errors", "number?[]", .meaning = "measured error of each frame that has a file"},
    {"errors95", "number?[]", .meaning = "the bound of that error with a confidence of 95 %"},
    {0},
};

static const struct member plans_params[] = {
    {"id", "integer", .meaning = "the job", .min = 1},
    {"limit", "integer", .meaning = "so many of the newest", .min = 1, .max = PLANS_LIMIT, .fallback = "100",
     .is_optional = true},
    {0},
};
static const struct member plans_result[] = {
    {"plans", "plan[]", .meaning = "those of its owner for equal pictures, the newest first"},
    {0},
};

static const struct member log_params[] = {
    {"id", "integer", .meaning = "the job", .min = 1},
    {"frame", "integer", .meaning = "its number; absent: all", .min = 0, .max = FRAME_NUMBER_LIMIT - 1,
     .is_optional = true},
    {"limit", "integer", .meaning = "so many of the newest", .min = 1, .max = STORE_ATTEMPT_LIMIT, .fallback = "100",
     .is_optional = true},
    {0},
};
static const struct member log_result[] = {
    {"attempts", "attempt[]", .meaning = "that ended without a file"},
    {0},
};

const struct method methods_of_jobs[] = {
    {"job.list", requests_job_list, "All jobs, or some.", NEED_READ, .params = list_params, .result = list_result},
    {"job.show", requests_job_show, "One job with its document.", NEED_READ, .params = show_params,
     .result_shape = &shape_job, .result = show_result},
    {"job.frames", requests_job_frames, "Frames of a job.", NEED_READ, .params = frames_params,
     .result = frames_result},
    {"job.frame_map", requests_job_frame_map, "The state of each frame of a job in short.", NEED_READ,
     .params = map_params, .result = map_result},
    {"job.plans", requests_job_plans, "How frames of a job with a tolerance are rendered, and why.", NEED_READ,
     .params = plans_params, .result = plans_result},
    {"job.log", requests_job_log, "Attempts at a job's frames.", NEED_READ, .params = log_params, .result = log_result},
    {0},
};
