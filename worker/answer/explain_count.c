// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/explain_count.h"

#include "core/job/job.h"
#include "core/job/quality_json.h"
#include "core/json/json_write.h"
#include "worker/plan/draft.h"

void explain_count_write(const struct job *job, struct json_writer *writer)
{
    double evaluations = draft_count(job);
    struct draft draft;

    json_write_key(writer, "counted");
    json_write_begin_object(writer);
    json_write_integer_member(writer, "frames", frame_range_count(&job->frames));
    json_write_integer_member(writer, "pixels", (int64_t)job->width_px * job->height_px);
    if (evaluations > 0.0) json_write_number_member(writer, "evaluations", evaluations);
    if (job->quality.is_draft) {
        json_write_key(writer, "quality");
        quality_to_json(writer, job, &job->quality);
    }
    json_write_key(writer, "methods");
    json_write_begin_array(writer);
    if (!draft_choose(&draft, job, NULL)) draft.option_count = 0;
    for (size_t i = 0; i < draft.option_count; i++) {
        json_write_begin_object(writer);
        json_write_string_member(writer, "method", draft.options[i].name);
        json_write_number_member(writer, "evaluations", draft.options[i].evaluations);
        json_write_end_object(writer);
    }
    json_write_end_array(writer);
    json_write_end_object(writer);
}
