// SPDX-License-Identifier: Apache-2.0
#include "core/job/plan_json.h"

#include "core/base/error.h"
#include "core/job/quality_json.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double NUMBER_LIMIT = 1e300;

bool plan_quality_from_json(struct job_quality *quality, const struct json_node *object, const struct job *job,
                            struct error *error)
{
    struct json_node node = json_node_child(object, "quality"), samples = json_node_child(&node, "samples");

    if (!json_check_object(&node, error) || !quality_from_json(quality, object, error)) return false;
    if (!job_quality_states_method(quality)) return json_fail_expected(&node, error, "a quality with a method");
    if (quality->samples != job->quality.samples) return json_fail_expected(&samples, error, "as many as the job has");
    quality->tolerance = job->quality.tolerance;
    quality->on_miss = job->quality.on_miss;
    quality->max_cut = job->quality.max_cut;
    if (job_limits_rays(job, quality)) return true;
    quality->max_depth = job->quality.max_depth;
    quality->min_throughput = job->quality.min_throughput;
    return true;
}

static bool read_before(struct plan_json *plan, const struct json_node *object, const struct job *job,
                        struct error *error)
{
    static const char *const keys[] = {"quality", NULL};
    struct json_node before = json_node_child(object, "before");

    plan->has_before = !json_node_is_absent(&before);
    return !plan->has_before || (json_check_object(&before, error) && json_check_keys(&before, keys, error) &&
                                 plan_quality_from_json(&plan->before, &before, job, error));
}

static bool read_scouts(struct plan_json *plan, const struct json_node *object, struct error *error)
{
    struct json_node scouts = json_node_child(object, "scouts"), scout = {0};

    if (!json_check_array(&scouts, 0, PLAN_JSON_SCOUT_LIMIT, error)) return false;
    while (json_node_next(&scouts, &scout))
        if (!json_read_number(&scout, 0.0, NUMBER_LIMIT, &plan->scout_errors[plan->scout_count++], error)) return false;
    return true;
}

// Known of plans whose light is scattered more than once.
static bool read_scattered(struct plan_json *plan, const struct json_node *object, struct error *error)
{
    struct json_node scattered = json_node_child(object, "scattered"), cells, paths;

    if (json_node_is_absent(&scattered)) return true;
    if (!json_check_array(&scattered, 2, 2, error)) return false;
    cells = json_node_element(&scattered, 0);
    paths = json_node_element(&scattered, 1);
    return json_read_number(&cells, 0.0, NUMBER_LIMIT, &plan->cells_square, error) &&
           json_read_number(&paths, 0.0, NUMBER_LIMIT, &plan->paths_square, error);
}

static bool read_views(struct plan_json *plan, const struct json_node *pilot, const struct job *job,
                       struct error *error)
{
    struct json_node frames = json_node_child(pilot, "frames"), frame = {0}, pixels = json_node_child(pilot, "pixels");
    int64_t number;

    if (!plan_quality_from_json(&plan->view_quality, pilot, job, error) ||
        !json_read_integer(&pixels, 1, PLAN_JSON_PIXEL_LIMIT, &number, error) ||
        !json_check_array(&frames, 0, PLAN_JSON_VIEW_LIMIT, error))
        return false;
    plan->view_pixels = (int)number;
    while (json_node_next(&frames, &frame)) {
        if (!json_read_integer(&frame, 0, FRAME_NUMBER_LIMIT - 1, &number, error)) return false;
        if (frame_range_index(&job->frames, (int32_t)number) < 0)
            return json_fail_expected(&frame, error, "a frame of the job");
        plan->view_frames[plan->view_count++] = (int32_t)number;
    }
    return true;
}

static bool read_samples(struct plan_json *plan, const struct json_node *pilot, struct error *error)
{
    struct json_node samples = json_node_child(pilot, "samples"), change = json_node_child(pilot, "change");
    struct json_node sample = {0};

    if (!json_read_number(&change, 0.0, NUMBER_LIMIT, &plan->sample_change, error) ||
        !json_check_array(&samples, 0, PLAN_JSON_SAMPLE_LIMIT, error))
        return false;
    while (json_node_next(&samples, &sample)) {
        double *numbers = plan->samples[plan->sample_count++];

        if (!json_check_array(&sample, PLAN_JSON_SAMPLE_NUMBERS, PLAN_JSON_SAMPLE_NUMBERS, error)) return false;
        for (size_t i = 0; i < PLAN_JSON_SAMPLE_NUMBERS; i++) {
            struct json_node node = json_node_element(&sample, i);

            if (!json_read_number(&node, -NUMBER_LIMIT, NUMBER_LIMIT, &numbers[i], error)) return false;
        }
    }
    return true;
}

bool plan_from_json(struct plan_json *plan, const struct json_node *object, const struct job *job, struct error *error)
{
    static const char *const keys[] = {"quality", "why", "before", "scouts", "scattered", "pilot", "beyond", NULL};
    static const char *const pilot_keys[] = {"quality", "pixels", "frames", "change", "samples", NULL};
    struct json_node why = json_node_child(object, "why"), pilot = json_node_child(object, "pilot");
    const char *reason;

    *plan = (struct plan_json){0};
    if (!json_check_object(object, error) || !json_check_keys(object, keys, error) ||
        !plan_quality_from_json(&plan->quality, object, job, error) || !json_read_string(&why, &reason, error))
        return false;
    if (strlen(reason) >= sizeof plan->reason) return json_fail_expected(&why, error, "a short sentence");
    snprintf(plan->reason, sizeof plan->reason, "%s", reason);
    return read_before(plan, object, job, error) && read_scouts(plan, object, error) &&
           read_scattered(plan, object, error) && json_check_object(&pilot, error) &&
           json_check_keys(&pilot, pilot_keys, error) && read_views(plan, &pilot, job, error) &&
           read_samples(plan, &pilot, error) && job_beyond_read(&plan->beyond, object, error);
}

static void write_number(struct json_writer *writer, double number)
{
    json_write_number(writer, isnan(number) ? NUMBER_LIMIT : fmin(fmax(number, -NUMBER_LIMIT), NUMBER_LIMIT));
}

static void write_pilot(struct json_writer *writer, const struct plan_json *plan, const struct job *job)
{
    json_write_begin_object(writer);
    json_write_key(writer, "quality");
    quality_to_json(writer, job, &plan->view_quality);
    json_write_integer_member(writer, "pixels", plan->view_pixels);
    json_write_key(writer, "frames");
    json_write_begin_array(writer);
    for (int i = 0; i < plan->view_count; i++)
        json_write_integer(writer, plan->view_frames[i]);
    json_write_end_array(writer);
    json_write_key(writer, "change");
    write_number(writer, plan->sample_change);
    json_write_key(writer, "samples");
    json_write_begin_array(writer);
    for (int i = 0; i < plan->sample_count; i++) {
        json_write_begin_array(writer);
        for (int k = 0; k < PLAN_JSON_SAMPLE_NUMBERS; k++)
            write_number(writer, plan->samples[i][k]);
        json_write_end_array(writer);
    }
    json_write_end_array(writer);
    json_write_end_object(writer);
}

void plan_to_json(struct json_writer *writer, const struct plan_json *plan, const struct job *job)
{
    json_write_begin_object(writer);
    json_write_key(writer, "quality");
    quality_to_json(writer, job, &plan->quality);
    json_write_string_member(writer, "why", plan->reason);
    if (plan->has_before) {
        json_write_key(writer, "before");
        json_write_begin_object(writer);
        json_write_key(writer, "quality");
        quality_to_json(writer, job, &plan->before);
        json_write_end_object(writer);
    }
    json_write_key(writer, "scouts");
    json_write_begin_array(writer);
    for (int i = 0; i < plan->scout_count; i++)
        write_number(writer, plan->scout_errors[i]);
    json_write_end_array(writer);
    if (plan->cells_square + plan->paths_square > 0.0) {
        json_write_key(writer, "scattered");
        json_write_begin_array(writer);
        write_number(writer, plan->cells_square);
        write_number(writer, plan->paths_square);
        json_write_end_array(writer);
    }
    json_write_key(writer, "pilot");
    write_pilot(writer, plan, job);
    job_beyond_write(&plan->beyond, writer);
    json_write_end_object(writer);
}
