// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/requests.h"

#include "core/base/alloc.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"
#include "daemon/clients/answer.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/job_etas.h"
#include "daemon/jobs/job_view.h"
#include "daemon/loop/loop_turns.h"
#include "daemon/requests/cursor.h"
#include "daemon/requests/job_filter.h"

#include <stdlib.h>
#include <string.h>

enum { IDS_LIMIT = 1000, JOBS_LIMIT = 1000, WRITTEN_OF_A_STEP = 4, LOOKED_AT_OF_A_STEP = 1024, FETCH_AHEAD = 8 };

const char *const job_list_orders[] = {"id", "-id", NULL};

// A list that is written a few jobs at a step. Jobs are walked by their ids, which are never used again: whatever comes
// and goes between steps or pages, no job is passed twice, and none that stays is left out.
struct job_list {
    struct loop_task task;
    const struct farm *farm; // borrowed; outlives us
    struct answer *answer;   // owned
    struct job_filter filter;
    int64_t *ids; // owned; those that are asked for; NULL: all
    size_t id_count, ids_done;
    bool is_down;    // the newest first
    bool is_counted; // `total` is known without a walk
    int64_t next_id; // to look at, or the nearest that there is behind it
    int64_t last_id; // where an upward walk ends: jobs that come meanwhile are not listed
    int64_t cursor;  // only jobs behind this id are written; -1: all
    int64_t limit;   // of jobs; INT64_MAX: none
    int64_t written, written_id, total;
    bool has_more; // than the page holds
    struct job_etas etas;
    struct json_writer value;
};

static void write_job(struct job_list *list, struct job_record *record)
{
    job_view_write(list->farm, &list->etas, record, &list->value);
    list->written++;
    list->written_id = record->id;
}

static bool is_behind_cursor(const struct job_list *list, int64_t id)
{
    if (list->cursor < 0) return true;
    return list->is_down ? id < list->cursor : id > list->cursor;
}

static void look_at(struct job_list *list, struct job_record *record)
{
    if (!job_filter_has(&list->filter, record)) return;
    if (!list->is_counted) list->total++;
    if (!is_behind_cursor(list, record->id)) return;
    if (list->written < list->limit)
        write_job(list, record);
    else
        list->has_more = true;
}

// True while there is more to walk.
static bool walk_ids(struct job_list *list)
{
    for (int i = 0; i < WRITTEN_OF_A_STEP && list->ids_done < list->id_count; i++) {
        struct job_record *record = job_table_find(&list->farm->jobs, list->ids[list->ids_done++]);

        if (record) look_at(list, record);
    }
    return list->ids_done < list->id_count;
}

// Of a hundred thousand jobs few are in the processor's cache: what is looked at next is fetched meanwhile.
static void fetch(const struct job_table *jobs, size_t index, size_t further)
{
    if (index >= jobs->count || further >= jobs->count) return;
    __builtin_prefetch(jobs->records[further]);
    __builtin_prefetch(jobs->records[index]->name);
    __builtin_prefetch(jobs->records[index]->queued);
}

static bool walk_up(struct job_list *list)
{
    const struct job_table *jobs = &list->farm->jobs;
    size_t i = job_table_first_from(jobs, list->next_id), end = i + LOOKED_AT_OF_A_STEP;
    int64_t written_end = list->written + WRITTEN_OF_A_STEP;

    for (; i < jobs->count && jobs->records[i]->id <= list->last_id; i++) {
        if (i == end || list->written == written_end) return true;
        fetch(jobs, i + FETCH_AHEAD, i + 2 * (size_t)FETCH_AHEAD);
        look_at(list, jobs->records[i]);
        if (list->has_more && list->is_counted) return false;
        list->next_id = jobs->records[i]->id + 1;
    }
    return false;
}

static bool walk_down(struct job_list *list)
{
    const struct job_table *jobs = &list->farm->jobs;
    size_t i = job_table_first_from(jobs, list->next_id + 1);
    int64_t written_end = list->written + WRITTEN_OF_A_STEP;

    for (int looked_at = 0; i > 0; i--, looked_at++) {
        if (looked_at == LOOKED_AT_OF_A_STEP || list->written == written_end) return true;
        fetch(jobs, i - FETCH_AHEAD, i - 2 * (size_t)FETCH_AHEAD); // below 0 is beyond the count
        look_at(list, jobs->records[i - 1]);
        if (list->has_more && list->is_counted) return false;
        list->next_id = jobs->records[i - 1]->id - 1;
    }
    return false;
}

static void write_end(struct job_list *list)
{
    char next[CURSOR_TEXT_SIZE];

    cursor_format(next, list->is_down ? CURSOR_JOBS_DOWN : CURSOR_JOBS_UP, list->written_id);
    json_write_end_array(&list->value);
    json_write_string_member(&list->value, "next", list->has_more ? next : NULL);
    json_write_integer_member(&list->value, "total", list->total);
    json_write_end_object(&list->value);
}

static void destroy_list(struct job_list *list)
{
    json_writer_finish(&list->value);
    job_etas_finish(&list->etas);
    job_filter_finish(&list->filter);
    free(list->ids);
    free(list);
}

static bool on_list_step(struct loop_task *task)
{
    struct job_list *list = (struct job_list *)task;

    if (list->ids ? walk_ids(list) : list->is_down ? walk_down(list) : walk_up(list)) return true;
    write_end(list);
    answer_send_result(list->answer, &list->value);
    destroy_list(list);
    return false;
}

static bool read_ids(struct job_list *list, struct request *request, const struct json_node *ids)
{
    static const char *const others[] = {"order", "cursor", "limit"};
    struct json_node node = {0};

    if (!json_check_array(ids, 0, IDS_LIMIT, &request->error)) return false;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        struct json_node other = json_node_child(&request->params, others[i]);

        if (!json_node_is_absent(&other)) return json_fail(&other, &request->error, "expected none beside \"ids\"");
    }
    list->ids = xcalloc(json_node_count(ids) + 1, sizeof list->ids[0]);
    while (json_node_next(ids, &node))
        if (!json_read_integer(&node, 1, INT64_MAX, &list->ids[list->id_count++], &request->error)) return false;
    return true;
}

static bool read_cursor(struct job_list *list, struct request *request)
{
    struct json_node node = json_node_child(&request->params, "cursor");
    const char *text;

    list->cursor = -1;
    if (json_node_is_absent(&node)) return true;
    if (!json_read_string(&node, &text, &request->error)) return false;
    return cursor_parse(text, list->is_down ? CURSOR_JOBS_DOWN : CURSOR_JOBS_UP, &list->cursor) ||
           json_fail_expected(&node, &request->error, "\"next\" of a job.list in the same order");
}

static bool read_page(struct job_list *list, struct request *request)
{
    struct json_node order = json_node_child(&request->params, "order"), ids = json_node_child(&request->params, "ids");
    int choice = 0;

    request->code = MESSAGE_CODE_PARAMS;
    if (!json_node_is_absent(&ids) && !read_ids(list, request, &ids)) return false;
    if (!json_node_is_absent(&order) && !json_read_enum(&order, job_list_orders, &choice, &request->error))
        return false;
    list->is_down = choice == 1;
    return read_cursor(list, request) && request_read_count(request, "limit", 1, JOBS_LIMIT, INT64_MAX, &list->limit);
}

// A list without a filter is as long as the table, and is walked from the cursor on.
static void start_walk(struct job_list *list)
{
    const struct job_table *jobs = &list->farm->jobs;

    list->last_id = jobs->count > 0 ? jobs->records[jobs->count - 1]->id : 0;
    if (list->is_down) list->next_id = list->last_id;
    if (list->ids || !job_filter_has_all(&list->filter)) return;
    list->is_counted = true;
    list->total = (int64_t)jobs->count;
    if (list->cursor >= 0) list->next_id = list->is_down ? list->cursor - 1 : list->cursor + 1;
}

enum request_outcome requests_job_list(struct request *request)
{
    struct job_list *list = xcalloc(1, sizeof *list);

    list->task.step = on_list_step;
    list->farm = request->farm;
    if (!job_filter_read(&list->filter, request) || !read_page(list, request)) {
        destroy_list(list);
        return REQUEST_FAILED;
    }
    start_walk(list);
    list->answer = request_defer_answer(request, true);
    json_write_begin_object(&list->value);
    json_write_key(&list->value, "jobs");
    json_write_begin_array(&list->value);
    loop_turns_put(request->farm->turns, &list->task);
    return REQUEST_DEFERRED;
}
