// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/methods.h"
#include "daemon/requests/requests.h"

#include <stddef.h>

static const struct member status_result[] = {
    {"version", "string", .meaning = "of marchd"},
    {"pid", "integer", .meaning = "of the daemon"},
    {"started", "number", .meaning = "unix seconds"},
    {"output_root", "string", .meaning = "the first of output_roots"},
    {"output_roots", "string[]", .meaning = "folders below which output goes"},
    {"input_roots", "string[]", .meaning = "folders below which jobs may read"},
    {"roots", "root[]", .meaning = "the output roots of settings and jobs"},
    {"state_folder", "string", .meaning = "folder of the queue"},
    {"store", "store", .meaning = "whether changes can be stored"},
    {"jobs", "job_counts", .meaning = "all jobs"},
    {"frames", "frame_counts", .meaning = "all frames"},
    {"workers", "integer", .meaning = "places of workers"},
    {"nodes", "node_counts", .meaning = "other machines"},
    {"drain", "drain?", .meaning = "who drained the farm; null: nobody"},
    {"loop", "loop", .meaning = "how long the turns of the loop were"},
    {0},
};

static const struct member metrics_result[] = {
    {"families", "family[]", .meaning = "what is counted, of all labels"},
    {0},
};

static const struct member running_result[] = {
    {"running", "integer", .meaning = "frames that run"},
    {0},
};

static const struct member reload_result[] = {
    {"changed", "string[]", .meaning = "settings that hold now"},
    {"restart", "string[]", .meaning = "settings that changed, and need a restart"},
    {0},
};

static const struct member workers_result[] = {
    {"workers", "worker[]", .meaning = "all places of workers"},
    {0},
};

static const struct member subscribe_params[] = {
    {"id", "integer", .meaning = "a job; absent: all", .min = 1, .is_optional = true},
    {"frames", "boolean", .meaning = "events of frames and phases, too", .fallback = "true", .is_optional = true},
    {0},
};

static const struct member unsubscribe_params[] = {
    {"id", "integer", .meaning = "a job; absent: the subscriptions to all jobs", .min = 1, .is_optional = true},
    {0},
};

const struct method methods_of_daemon[] = {
    {"daemon.status", requests_daemon_status, "How the farm is.", NEED_READ, .result = status_result},
    {"daemon.metrics", requests_daemon_metrics, "What the daemon counts, for Prometheus and the like.", NEED_READ,
     .result = metrics_result},
    {"daemon.drain", requests_daemon_drain, "Begins no frame from now on.", NEED_ADMIN, .result = running_result},
    {"daemon.undrain", requests_daemon_undrain, "Ends a drain.", NEED_ADMIN, .result = running_result},
    {"daemon.reload", requests_daemon_reload, "Reads the settings again.", NEED_ADMIN, .result = reload_result},
    {"worker.list", requests_worker_list, "All workers.", NEED_READ, .result = workers_result},
    {"events.subscribe", requests_events_subscribe, "Sends notifications `event` from now on.", NEED_READ,
     .params = subscribe_params},
    {"events.unsubscribe", requests_events_unsubscribe, "Ends this connection's subscriptions to one job, or to all.",
     NEED_READ, .params = unsubscribe_params},
    {0},
};
