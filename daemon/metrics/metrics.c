// SPDX-License-Identifier: Apache-2.0
#include "daemon/metrics/metrics.h"

#include "core/job/job.h"

#include <string.h>

const char *const metrics_end_names[METRICS_END_COUNT] = {
    [METRICS_END_REPLACED] = "replaced",    [METRICS_END_STOPPED] = "stopped", [METRICS_END_NODE] = "node_lost",
    [METRICS_END_OVER_LIMIT] = "limit",     [METRICS_END_MEMORY] = "memory",   [METRICS_END_KILLED] = "killed",
    [METRICS_END_NO_START] = "not_started", [METRICS_END_DIED] = "died",
};

static const char *const backends[] = {"egl", "osmesa", "none", "other"};

enum { BACKEND_OTHER = sizeof backends / sizeof backends[0] - 1, METHOD_OTHER = JOB_METHOD_DRAFT + 1 };

static int find_backend(const char *name)
{
    int i = 0;

    while (i < BACKEND_OTHER && !(name && strcmp(name, backends[i]) == 0))
        i++;
    return i;
}

static int find_method(const char *name)
{
    int i = 0;

    while (i < METHOD_OTHER && !(name && strcmp(name, job_method_name((enum job_method)i)) == 0))
        i++;
    return i;
}

const char *metrics_backend_name(int backend)
{
    return backends[backend];
}

const char *metrics_method_name(int method)
{
    return method == METHOD_OTHER ? "other" : job_method_name((enum job_method)method);
}

static struct metrics_frame_series *find_series(struct metrics *metrics, const struct metrics_source *source)
{
    int backend = find_backend(source->backend), method = find_method(source->method);
    struct metrics_frame_series *series = metrics->frames;

    for (; series < metrics->frames + metrics->frame_count; series++)
        if (series->pool == source->pool && series->backend == backend && series->method == method) return series;
    if (metrics->frame_count == METRICS_SERIES_LIMIT) return series;
    metrics->frame_count++;
    series->pool = source->pool;
    series->backend = backend;
    series->method = method;
    return series;
}

void metrics_note_frame(struct metrics *metrics, const struct metrics_source *source, double seconds, double error)
{
    struct metrics_frame_series *series = find_series(metrics, source);

    histogram_add(&series->seconds, &histogram_work_s, seconds);
    if (error >= 0) histogram_add(&series->error, &histogram_ratio, error);
}
