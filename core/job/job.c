// SPDX-License-Identifier: Apache-2.0
#include "core/job/job.h"

#include <stdlib.h>

void job_finish(struct job *job)
{
    free(job->name);
    free(job->pool);
    job_notes_finish(&job->notes);
    job_notify_finish(&job->notify);
    job_after_finish(&job->after);
    frame_range_finish(&job->frames);
    scene_finish(&job->scene);
    output_path_finish(&job->output.path);
    *job = (struct job){0};
}

double job_frame_time(const struct job *job, int32_t frame)
{
    // The product is an exact integer: 1e7 frames times 1e9 fit 64 bits.
    return job->time_offset + (double)(frame * job->fps_denominator) / (double)job->fps_numerator;
}

struct timeline_span job_time_span(const struct job *job)
{
    int32_t first = INT32_MAX, last = INT32_MIN;

    for (size_t i = 0; i < job->frames.span_count; i++) {
        const struct frame_span *span = &job->frames.spans[i];
        int32_t end = span->first + span->step * (span->count - 1);
        int32_t low = end < span->first ? end : span->first, high = end < span->first ? span->first : end;

        if (low < first) first = low;
        if (high > last) last = high;
    }
    return (struct timeline_span){job_frame_time(job, first),
                                  job_frame_time(job, last) + job->scene.camera.shutter * (double)job->fps_denominator /
                                                                  (double)job->fps_numerator};
}

static const struct method {
    const char *name; // in the job
    bool takes_steps;
} methods[] = {
    [JOB_METHOD_RIEMANN] = {"riemann", false},
    [JOB_METHOD_MIDPOINT] = {"midpoint", true},
    [JOB_METHOD_EQUIANGULAR] = {"equiangular", false},
    [JOB_METHOD_JITTERED] = {"jittered", true},
    [JOB_METHOD_ADAPTIVE] = {"adaptive", true},
    [JOB_METHOD_GAUSS] = {"gauss", true},
    [JOB_METHOD_CACHED] = {"cached", true},
    [JOB_METHOD_PREINTEGRATED] = {"preintegrated", true},
    [JOB_METHOD_TRACKING] = {"tracking", true},
    [JOB_METHOD_PATHS] = {"paths", false},
    [JOB_METHOD_AUTO] = {"auto", false},
    [JOB_METHOD_DRAFT] = {"draft", false},
};
_Static_assert(sizeof methods / sizeof *methods == JOB_METHOD_DRAFT + 1, "each method has a row");

bool job_method_takes_steps(enum job_method method)
{
    return methods[method].takes_steps;
}

bool job_limits_rays(const struct job *job, const struct job_quality *quality)
{
    return job->scene.object_count > 0 && quality->method != JOB_METHOD_PATHS;
}

bool job_quality_states_method(const struct job_quality *quality)
{
    return quality->method != JOB_METHOD_AUTO && quality->method != JOB_METHOD_DRAFT;
}

bool job_quality_has_majorants(const struct job_quality *quality)
{
    return quality->method == JOB_METHOD_PATHS ||
           (quality->method == JOB_METHOD_TRACKING &&
            (quality->estimator == JOB_ESTIMATOR_DELTA || quality->estimator == JOB_ESTIMATOR_RATIO));
}

int job_find_step_limit(const struct job *job)
{
    return job->scene.object_count == 0 && job->quality.method != JOB_METHOD_PREINTEGRATED ? JOB_SLICED_STEPS_LIMIT
                                                                                           : JOB_MARCH_STEPS_LIMIT;
}

const char *job_method_name(enum job_method method)
{
    return methods[method].name;
}

void job_method_list(const char *names[static JOB_METHOD_COUNT + 1])
{
    for (int i = 0; i < JOB_METHOD_COUNT; i++)
        names[i] = methods[i].name;
    names[JOB_METHOD_COUNT] = NULL;
}

const char *job_estimator_name(enum job_estimator estimator)
{
    static const char *const names[] = {"delta", "ratio", "debiased", "jackknife"};

    return names[estimator];
}

const char *job_compression_name(enum job_compression compression)
{
    switch (compression) {
    case JOB_COMPRESSION_NONE:
        return "none";
    case JOB_COMPRESSION_RLE:
        return "rle";
    case JOB_COMPRESSION_ZIPS:
        return "zips";
    case JOB_COMPRESSION_ZIP:
        return "zip";
    case JOB_COMPRESSION_PIZ:
        return "piz";
    }
    return "";
}
