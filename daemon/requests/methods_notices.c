// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/methods.h"
#include "daemon/requests/requests.h"
#include "daemon/requests/shapes.h"

#include <stddef.h>

static const struct member pending_params[] = {
    {"after", "integer", .meaning = "only notices with a greater id", .min = 0, .max = (INT64_C(1) << 53) - 1,
     .fallback = "0", .is_optional = true},
    {"limit", "integer", .meaning = "so many at the most", .min = 0, .max = 1000, .fallback = "100",
     .is_optional = true},
    {"targets", "string[]", .meaning = "whom jobs may name from now on; absent: as before", .is_optional = true},
    {"webhooks", "boolean", .meaning = "jobs may name addresses, too; with `targets`", .fallback = "false",
     .is_optional = true},
    {0},
};
static const struct member pending_result[] = {
    {"notices", "notice[]", .meaning = "by their ids; of many the first"},
    {"dropped", "integer", .meaning = "how many were dropped since the daemon's start, because too many waited"},
    {0},
};

static const struct member done_params[] = {
    {"id", "integer", .meaning = "the notice", .min = 1, .max = (INT64_C(1) << 53) - 1},
    {"error", "string", .meaning = "why it was given up; absent: it is delivered", .is_optional = true},
    {0},
};

const struct method methods_of_notices[] = {
    {"notify.pending", requests_notify_pending, "What targets are to be told.", NEED_NOTICE, .params = pending_params,
     .result = pending_result},
    {"notify.done", requests_notify_done, "Forgets a notice.", NEED_NOTICE, .params = done_params},
    {0},
};
