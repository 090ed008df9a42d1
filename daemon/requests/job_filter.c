// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/job_filter.h"

#include "core/base/alloc.h"
#include "core/json/json_read.h"
#include "daemon/farm/job_table.h"
#include "daemon/requests/request.h"

#include <stdlib.h>
#include <string.h>

// Each of them is compared with every job.
enum { TEXT_LIMIT = 256 };
static const double time_limit_s = 1e12;

static bool read_text(struct request *request, const char *key, char **copy)
{
    struct json_node node = json_node_child(&request->params, key);
    const char *text;

    if (json_node_is_absent(&node)) return true;
    if (!json_read_string(&node, &text, &request->error)) return false;
    if (strlen(text) > TEXT_LIMIT) return json_fail(&node, &request->error, "expected at most %d bytes", TEXT_LIMIT);
    *copy = xstrdup(text);
    return true;
}

static bool read_time(struct request *request, const char *key, bool *has_time, double *time_s)
{
    struct json_node node = json_node_child(&request->params, key);

    *has_time = !json_node_is_absent(&node);
    return !*has_time || json_read_number(&node, 0, time_limit_s, time_s, &request->error);
}

static char fold(char letter)
{
    return letter >= 'A' && letter <= 'Z' ? (char)(letter - 'A' + 'a') : letter;
}

bool job_filter_read(struct job_filter *filter, struct request *request)
{
    *filter = (struct job_filter){0};
    request->code = MESSAGE_CODE_PARAMS;
    if (!request_read_set(request, "state", job_state_names, ~0U, &filter->states) ||
        !read_text(request, "owner", &filter->owner) || !read_text(request, "name", &filter->name) ||
        !read_time(request, "since", &filter->has_since, &filter->since_s) ||
        !read_time(request, "before", &filter->has_before, &filter->before_s))
        return false;
    for (char *letter = filter->name; letter && *letter; letter++)
        *letter = fold(*letter);
    return true;
}

void job_filter_finish(struct job_filter *filter)
{
    free(filter->owner);
    free(filter->name);
    *filter = (struct job_filter){0};
}

// strcasestr takes five times as long, which counts where there are a hundred thousand names.
static bool has_part(const char *text, const char *folded)
{
    for (; *text; text++) {
        size_t i = 0;

        while (folded[i] && fold(text[i]) == folded[i])
            i++;
        if (!folded[i]) return true;
    }
    return !*folded;
}

bool job_filter_has(const struct job_filter *filter, const struct job_record *record)
{
    double submitted_s = (double)record->submitted_ms / 1000;

    if (filter->has_since && submitted_s < filter->since_s) return false;
    if (filter->has_before && submitted_s >= filter->before_s) return false;
    if (filter->owner && strcmp(record->owner, filter->owner) != 0) return false;
    if (filter->name && !has_part(record->name, filter->name)) return false;
    return filter->states == ~0U || filter->states & 1U << queue_job_state(record->queued);
}

bool job_filter_has_all(const struct job_filter *filter)
{
    return filter->states == ~0U && !filter->owner && !filter->name && !filter->has_since && !filter->has_before;
}
