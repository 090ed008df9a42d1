// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/plan_answer.h"

#include "core/base/error.h"
#include "core/job/quality_json.h"
#include "core/json/json_write.h"
#include "worker/answer/request.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_make.h"
#include "worker/plan/plan_params.h"
#include "worker/plan/plan_segment.h"

#include <stdlib.h>

enum { SEGMENT_LIMIT = 3 };

// A plan that is being made, one of `count`.
struct making {
    const struct request_tools *tools;
    int64_t index, count;
    int percent; // that was told of it
};

static void tell(struct making *making, int percent)
{
    const struct request_tools *tools = making->tools;

    making->percent = percent;
    if (tools->on_part) tools->on_part(tools->user, making->index, making->count, percent / 100.0);
}

static bool on_progress(void *user, double done)
{
    struct making *making = user;
    const struct request_tools *tools = making->tools;

    if ((int)(100.0 * done) > making->percent) tell(making, (int)(100.0 * done));
    return !tools->is_wanted || tools->is_wanted(tools->user);
}

static void write_plan(struct json_writer *writer, const struct job *job, const struct plan_segment *segment,
                       const struct plan *plan)
{
    struct job planned = plan_apply(plan, job);

    json_write_begin_object(writer);
    json_write_integer_member(writer, "segment", segment->index);
    json_write_integer_member(writer, "first_frame", frame_range_at(&job->frames, segment->first));
    json_write_integer_member(writer, "last_frame", frame_range_at(&job->frames, segment->first + segment->count - 1));
    json_write_key(writer, "quality");
    quality_to_json(writer, job, &planned.quality);
    json_write_string_member(writer, "why", plan->reason);
    json_write_number_member(writer, "frame_s", plan->predicted_frame_s);
    json_write_number_member(writer, "render_s", plan->predicted_s);
    json_write_number_member(writer, "audit_s", plan->predicted_audit_s);
    json_write_number_member(writer, "encode_s", plan->predicted_encode_s);
    json_write_number_member(writer, "plan_s", plan->plan_s);
    json_write_number_member(writer, "error", plan->predicted_error);
    json_write_number_member(writer, "traced", plan->predicted_traced);
    job_beyond_write(&plan->beyond, writer);
    json_write_end_object(writer);
}

// Extrapolates from the planned segments to all of them.
static void write_totals(struct json_writer *writer, const struct job *job, double seconds, double plan_s, double error)
{
    double plans_s = plan_s * (double)plan_segment_count(job);

    json_write_integer_member(writer, "frames", frame_range_count(&job->frames));
    json_write_integer_member(writer, "segments", plan_segment_count(job));
    json_write_number_member(writer, "frame_s", seconds);
    json_write_number_member(writer, "plans_s", plans_s);
    json_write_number_member(writer, "total_s", seconds * (double)frame_range_count(&job->frames) + plans_s);
    json_write_number_member(writer, "error", error);
}

bool plan_answer_write(const struct job *job, const struct request_tools *tools, struct json_writer *writer,
                       struct plan *first, struct error *error)
{
    int64_t count = plan_segment_count(job), planned = count < SEGMENT_LIMIT ? count : SEGMENT_LIMIT;
    double seconds = 0.0, plan_s = 0.0, largest = 0.0;

    if (!tools->renderer) {
        error_set(error, "quality.tolerance: planning for it needs a GL context, and this worker has none");
        return false;
    }
    json_write_begin_object(writer);
    json_write_number_member(writer, "tolerance", job->quality.tolerance);
    json_write_key(writer, "plans");
    json_write_begin_array(writer);
    for (int64_t i = 0; i < planned; i++) {
        struct plan_segment segment = plan_segment_at(job, planned > 1 ? i * (count - 1) / (planned - 1) : 0);
        struct making making = {.tools = tools, .index = i, .count = planned};
        struct plan plan;
        enum renderer_fault fault;

        tell(&making, 0);
        if (!plan_make(&plan,
                       &(struct plan_params){.renderer = tools->renderer,
                                             .job = job,
                                             .segment = segment,
                                             .is_timed = true,
                                             .on_progress = on_progress,
                                             .user = &making},
                       &fault, error))
            return false;
        if (first && i == 0) *first = plan;
        write_plan(writer, job, &segment, &plan);
        seconds += plan.predicted_frame_s / (double)planned;
        plan_s += plan.plan_s / (double)planned;
        if (plan.predicted_error > largest) largest = plan.predicted_error;
    }
    json_write_end_array(writer);
    write_totals(writer, job, seconds, plan_s, largest);
    json_write_end_object(writer);
    return true;
}
