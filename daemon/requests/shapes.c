// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/shapes.h"

#include "core/job/job_notify.h"
#include "core/wire/frame_phase.h"
#include "daemon/farm/farm.h"

#include <string.h>

static const struct member job_members[] = {
    {"id", "integer", .meaning = "its number, which no other job ever has", .min = 1},
    {"name", "string", .meaning = "as the document has it"},
    {"state", "string", .meaning = "where it stands", .names = job_state_names},
    {"draft", "boolean", .meaning = "its quality is a draft's"},
    {"priority", "integer", .meaning = "higher ones come first", .min = 0, .max = 200},
    {"owner", "string", .meaning = "the user who submitted it"},
    {"owner_uid", "integer", .meaning = "the same as a number"},
    {"submitted", "number", .meaning = "unix seconds"},
    {"started", "number?", .meaning = "unix seconds; null: no frame was begun"},
    {"finished", "number?", .meaning = "unix seconds; null: it is not over"},
    {"frames", "integer", .meaning = "all of its frames"},
    {"queued", "integer", .meaning = "frames that wait"},
    {"running", "integer", .meaning = "frames that workers have"},
    {"succeeded", "integer", .meaning = "frames that are published"},
    {"failed", "integer", .meaning = "frames that failed in each attempt"},
    {"canceled", "integer", .meaning = "frames that were canceled"},
    {"skipped", "integer", .meaning = "frames whose file was there"},
    {"missed", "integer", .meaning = "of those that succeeded or were skipped: over the tolerance"},
    {"tolerance", "number?", .meaning = "of a frame's measured error"},
    {"method", "string?", .meaning = "that it states, or that was chosen for the frame that was done last"},
    {"measured_error", "number?", .meaning = "of that frame: the estimated relative RMSE"},
    {"error95", "number?", .meaning = "its error is below it with a confidence of 95 %"},
    {"range", "string", .meaning = "its frames, as in 1-100x2,140"},
    {"output", "string", .meaning = "the absolute pattern of its files"},
    {"pool", "string?", .meaning = "the pool that it asks for"},
    {"seconds_per_frame", "number?", .meaning = "median of recent frames, or what its plan foretells"},
    {"eta_s", "number?", .meaning = "seconds until it is over; null: unknown"},
    {"phase", "string?", .meaning = "of the frame whose phase is the furthest", .names = frame_phase_names + 1},
    {"phase_progress", "number?", .meaning = "how much of that phase is done, from 0 to 1"},
    {"reason", "string?", .meaning = "why it waits, or failed"},
    {"after", "integer[]", .meaning = "jobs that it waits for; none: it waits for no job"},
    {"comment", "string?", .meaning = "as the document has it"},
    {"tags", "string[]", .meaning = "as the document has them"},
    {0},
};
const struct shape shape_job = {"job", "A job without its document.", .members = job_members};

static const char *const audit_names[] = {"reference", "step_halving", NULL};
static const struct member accuracy_members[] = {
    {"audit", "string", .meaning = "what its pixels were compared with", .names = audit_names, .is_optional = true},
    {"measured_error", "number", .meaning = "the estimated relative RMSE", .is_optional = true},
    {"error95", "number", .meaning = "the error is below it with a confidence of 95 %", .is_optional = true},
    {"audit_rays", "integer", .meaning = "pixels compared", .is_optional = true},
    {"method", "string", .meaning = "the method that was chosen", .is_optional = true},
    {"plan", "integer", .meaning = "the number of the plan with which the frame began", .min = 1, .is_optional = true},
    {"missed", "boolean", .meaning = "true: published, although it is over the tolerance", .is_optional = true},
    {"cut_share", "number", .meaning = "share of the light that cut paths may have had", .is_optional = true},
    {"traced", "number", .meaning = "share of its samples that were traced", .is_optional = true},
    {0},
};
static const struct shape shape_accuracy = {"accuracy", "What is known of how right a file is.",
                                            .members = accuracy_members};

static const struct member frame_members[] = {
    {"frame", "integer", .meaning = "its number"},
    {"state", "string", .meaning = "where it stands", .names = frame_state_names},
    {"attempts", "integer", .meaning = "attempts that were begun"},
    {"worker", "integer?", .meaning = "the worker that has it, or had it last"},
    {"node", "string?", .meaning = "the machine of a running frame; null: the daemon's"},
    {"render_s", "number?", .meaning = "seconds of rendering"},
    {"encode_s", "number?", .meaning = "seconds until the file was whole"},
    {"audit_s", "number?", .meaning = "seconds in which pixels were compared"},
    {"size_bytes", "integer?", .meaning = "of its file"},
    {"hash", "string?", .meaning = "of its file"},
    {"path", "string?", .meaning = "the absolute path of its file"},
    {"error", "string?", .meaning = "why it failed"},
    {"phase", "string?", .meaning = "of a running frame: what its worker does", .names = frame_phase_names + 1},
    {"phase_progress", "number?", .meaning = "how much of that phase is done, from 0 to 1"},
    {0},
};
static const struct shape shape_frame = {"frame", "A frame; with a file it has the accuracy, too.",
                                         .members = frame_members, .more = &shape_accuracy};

static const char *const worker_state_names[] = {"starting", "idle",    "busy", "backing_off",
                                                 "stopping", "waiting", NULL};
static const struct member worker_members[] = {
    {"id", "integer", .meaning = "its number"},
    {"pool", "string", .meaning = "local, or the name of a pool of the settings"},
    {"node", "string?", .meaning = "its machine; null: the daemon's"},
    {"pid", "integer?", .meaning = "on its machine"},
    {"state", "string", .meaning = "what it does; waiting: for its node", .names = worker_state_names},
    {"backend", "string?", .meaning = "how it renders"},
    {"vendor", "string?", .meaning = "of GL"},
    {"renderer", "string?", .meaning = "of GL"},
    {"version", "string?", .meaning = "of GL"},
    {"device_uuid", "string?", .meaning = "of its GPU"},
    {"sandbox", "string?", .meaning = "what restricts it"},
    {"job", "integer?", .meaning = "the job whose frames it has"},
    {"frames", "integer", .meaning = "frames that it has"},
    {"done", "integer", .meaning = "frames that it did"},
    {"reason", "string?", .meaning = "why it does not work"},
    {0},
};
static const struct shape shape_worker = {"worker", "A place of a worker, with the process that is there.",
                                          .members = worker_members};

static const char *const outcome_names[] = {"failed", "lost", NULL};
static const struct member attempt_members[] = {
    {"frame", "integer", .meaning = "its number"},
    {"attempt", "integer", .meaning = "from 1", .min = 1},
    {"worker", "integer", .meaning = "the worker that had it"},
    {"ended", "number", .meaning = "unix seconds"},
    {"outcome", "string", .meaning = "lost: its worker was gone", .names = outcome_names},
    {"log", "string", .meaning = "what the worker said"},
    {0},
};
static const struct shape shape_attempt = {"attempt", "One try at a frame.", .members = attempt_members};

static const struct member plan_members[] = {
    {"number", "integer", .meaning = "frames name it as their plan", .min = 1},
    {"quality", "object", .meaning = "as a job would state it, of frames that are not refined"},
    {"why", "string", .meaning = "why this one"},
    {"scouts", "number[]", .meaning = "its relative RMSE in frames that lie evenly over the segment"},
    {"beyond", "object",
     .meaning = "what the modelled orders of scattering leave out: error, error95; or why it is unknown",
     .is_optional = true},
    {0},
};
static const struct shape shape_plan = {"plan", "How the frames of a segment are rendered.", .members = plan_members};

static const struct member root_members[] = {
    {"path", "string", .meaning = "absolute"},
    {"id", "string?", .meaning = "of its marker; null: it was never there"},
    {"is_there", "boolean", .meaning = "whether files can be written below it"},
    {"reason", "string?", .meaning = "why not"},
    {0},
};
static const struct shape shape_root = {"root", "An output root of the settings or of a job.", .members = root_members};

static const char *const store_state_names[] = {"ok", "short", "failing", NULL};
static const struct member store_members[] = {
    {"state", "string", .meaning = "short: its disk is full; failing: nothing can be stored",
     .names = store_state_names},
    {"reason", "string?", .meaning = "what is wrong"},
    {"waiting", "integer", .meaning = "changes that are not on disk"},
    {0},
};
static const struct shape shape_store = {"store", "The queue on disk.", .members = store_members};

static const struct member job_count_members[] = {
    {"queued", "integer", .meaning = "jobs"},
    {"running", "integer", .meaning = "jobs"},
    {"paused", "integer", .meaning = "jobs"},
    {"succeeded", "integer", .meaning = "jobs"},
    {"failed", "integer", .meaning = "jobs"},
    {"canceled", "integer", .meaning = "jobs"},
    {0},
};
static const struct shape shape_job_counts = {"job_counts", "Jobs by their state.", .members = job_count_members};

static const struct member frame_count_members[] = {
    {"queued", "integer", .meaning = "frames"},
    {"running", "integer", .meaning = "frames"},
    {"succeeded", "integer", .meaning = "frames"},
    {"failed", "integer", .meaning = "frames"},
    {"canceled", "integer", .meaning = "frames"},
    {"skipped", "integer", .meaning = "frames"},
    {0},
};
static const struct shape shape_frame_counts = {"frame_counts", "Frames by their state.",
                                                .members = frame_count_members};

static const struct member node_count_members[] = {
    {"up", "integer", .meaning = "nodes whose workers can render"},
    {"waiting", "integer", .meaning = "nodes that are waited for"},
    {0},
};
static const struct shape shape_node_counts = {"node_counts", "Other machines.", .members = node_count_members};

static const struct member drain_members[] = {
    {"user", "string", .meaning = "who asked for it"},
    {"since", "number", .meaning = "unix seconds"},
    {0},
};
static const struct shape shape_drain = {"drain", "The farm begins no frame.", .members = drain_members};

static const struct member loop_members[] = {
    {"longest_ms", "number", .meaning = "the longest turn"},
    {"sum_s", "number", .meaning = "all turns"},
    {"up_to_ms", "integer[]", .meaning = "upper bounds of classes of turns"},
    {"counts", "integer[]", .meaning = "turns in each class, and above the last"},
    {0},
};
static const struct shape shape_loop = {"loop", "Turns of the daemon's loop since its start, in processor time.",
                                        .members = loop_members};

static const struct member sample_members[] = {
    {"labels", "object", .meaning = "texts by their names"},
    {"value", "number", .meaning = "now"},
    {0},
};
static const struct shape shape_sample = {"sample", "A counter or a gauge.", .members = sample_members};

static const struct member histogram_members[] = {
    {"labels", "object", .meaning = "texts by their names"},
    {"buckets", "number[][]", .meaning = "pairs of an upper end, and how many observations are up to it"},
    {"sum", "number", .meaning = "of the observations"},
    {"count", "integer", .meaning = "all observations"},
    {0},
};
static const struct shape shape_histogram = {"histogram", "Observations by their size.", .members = histogram_members};

static const struct shape *const any_sample[] = {&shape_sample, &shape_histogram, NULL};
static const struct shape shape_any_sample = {"any_sample", "A sample or a histogram, by the family's type.",
                                              .variants = any_sample};

static const char *const family_type_names[] = {"counter", "gauge", "histogram", NULL};
static const struct member family_members[] = {
    {"name", "string", .meaning = "of letters, digits and _"},
    {"type", "string", .meaning = "what its samples are", .names = family_type_names},
    {"help", "string", .meaning = "one sentence"},
    {"samples", "any_sample[]", .meaning = "by their labels"},
    {0},
};
static const struct shape shape_family = {"family", "Samples of one name.", .members = family_members};

static const char *const job_event_name[] = {"job", NULL};
static const struct member job_event_members[] = {
    {"type", "string", .meaning = "what happened", .names = job_event_name},
    {"job", "job", .meaning = "as it is now"},
    {0},
};
static const struct shape shape_job_event = {"job_event", "A job's state or counts changed.",
                                             .members = job_event_members};

static const char *const frame_event_name[] = {"frame", NULL};
static const struct member frame_event_members[] = {
    {"type", "string", .meaning = "what happened", .names = frame_event_name},
    {"id", "integer", .meaning = "the job", .min = 1},
    {"frame", "integer", .meaning = "its number"},
    {"state", "string", .meaning = "queued: it is tried again", .names = frame_state_names},
    {"attempt", "integer", .meaning = "from 1"},
    {"error", "string?", .meaning = "why the attempt failed"},
    {0},
};
static const struct shape shape_frame_event = {"frame_event", "An attempt started or ended.",
                                               .members = frame_event_members};

static const char *const phase_event_name[] = {"phase", NULL};
static const struct member phase_event_members[] = {
    {"type", "string", .meaning = "what happened", .names = phase_event_name},
    {"id", "integer", .meaning = "the job", .min = 1},
    {"frame", "integer", .meaning = "its number"},
    {"attempt", "integer", .meaning = "from 1"},
    {"phase", "string", .meaning = "what its worker does", .names = frame_phase_names + 1},
    {"phase_progress", "number?", .meaning = "how much of that phase is done, from 0 to 1"},
    {0},
};
static const struct shape shape_phase_event = {"phase_event", "How far a running frame is.",
                                               .members = phase_event_members};

static const struct member token_members[] = {
    {"id", "integer", .meaning = "its number, which no other token ever has", .min = 1},
    {"name", "string", .meaning = "what its user calls it"},
    {"scope", "string", .meaning = "what it is for", .names = access_scope_names},
    {"created", "number", .meaning = "unix seconds"},
    {"expires", "number?", .meaning = "unix seconds; null: never"},
    {"last_used", "number?", .meaning = "unix seconds, to a minute; null: never"},
    {"once", "boolean", .meaning = "it is for one use"},
    {"user", "string", .meaning = "whose it is"},
    {0},
};
static const struct shape shape_token = {"token", "A token without its text.", .members = token_members};

static const char *const worker_event_name[] = {"worker", NULL};
static const struct member worker_event_members[] = {
    {"type", "string", .meaning = "what happened", .names = worker_event_name},
    {"worker", "worker", .meaning = "as it is now"},
    {0},
};
static const struct shape shape_worker_event = {"worker_event", "A worker started, is ready, stops or is gone.",
                                                .members = worker_event_members};

static const char *const deleted_event_name[] = {"deleted", NULL};
static const struct member deleted_event_members[] = {
    {"type", "string", .meaning = "what happened", .names = deleted_event_name},
    {"id", "integer", .meaning = "the job", .min = 1},
    {0},
};
static const struct shape shape_deleted_event = {"deleted_event", "The last event of a job.",
                                                 .members = deleted_event_members};

static const struct shape *const event_variants[] = {&shape_job_event,    &shape_frame_event,   &shape_phase_event,
                                                     &shape_worker_event, &shape_deleted_event, NULL};
static const struct shape shape_event = {"event", "The params of a notification `event`.", .variants = event_variants};

static const struct member notice_members[] = {
    {"id", "integer", .meaning = "greater than that of each notice before", .min = 1},
    {"job", "integer", .meaning = "whose notice it is", .min = 1},
    {"owner_uid", "integer", .meaning = "of the job"},
    {"made", "number", .meaning = "unix seconds"},
    {"event", "string", .meaning = "what happened", .names = job_notify_event_names},
    {"to", "string?", .meaning = "the name of its target; null: it goes to an address"},
    {"webhook", "string?", .meaning = "the address"},
    {"body", "string", .meaning = "what the target gets, as JSON"},
    {0},
};
static const struct shape shape_notice = {"notice", "What a target is to be told.", .members = notice_members};

const struct shape *const shapes[] = {
    &shape_job,          &shape_frame,         &shape_worker,     &shape_attempt,      &shape_plan,
    &shape_root,         &shape_store,         &shape_job_counts, &shape_frame_counts, &shape_node_counts,
    &shape_drain,        &shape_loop,          &shape_sample,     &shape_histogram,    &shape_any_sample,
    &shape_family,       &shape_event,         &shape_job_event,  &shape_frame_event,  &shape_phase_event,
    &shape_worker_event, &shape_deleted_event, &shape_token,      &shape_notice,       NULL};

const struct shape *shapes_find(const char *name, size_t length)
{
    for (size_t i = 0; shapes[i]; i++) {
        if (strlen(shapes[i]->name) == length && strncmp(shapes[i]->name, name, length) == 0) return shapes[i];
    }
    return NULL;
}
