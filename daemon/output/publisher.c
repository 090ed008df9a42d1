// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/publisher.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/output_path.h"
#include "core/job/output_root.h"
#include "daemon/farm/job_table.h"
#include "daemon/store/committer.h"

#include <assert.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct publish_list {
    struct publish_request **requests; // owned
    size_t count, capacity;
};

// A batch at work, on a thread.
struct publish_hand {
    struct publish_lane *lane;
    uv_work_t work;
    struct publish_list requests; // used by the working thread
    bool is_working;
};

// What is published in one output root: one that hangs holds up itself.
struct publish_lane {
    struct publisher *publisher;
    const struct root *root;      // borrowed; outlives us
    struct publish_list intended; // intents on disk, to be renamed next
    struct publish_hand hands[PUBLISHER_HANDS];
    struct publish_lane *next; // on the publisher's list
};

struct publisher {
    uv_loop_t *loop;             // borrowed; outlives us
    const char *farm;            // borrowed; outlives us; the farm's id
    struct committer *committer; // borrowed; outlives us
    publisher_on_done *on_done;
    void *user;                 // borrowed
    struct publish_lane *lanes; // owned
    size_t uncommitted;         // requests whose intent is being committed
};

// The publisher and the request while the intent is committed.
struct publish_intent {
    struct publisher *publisher;
    struct publish_request *request;
};

static void on_intent_committed(void *user, bool ok, const struct error *error);
static void start_hands(struct publish_lane *lane);
static void on_publish_run(uv_work_t *work);
static void on_publish_done(uv_work_t *work, int status);

struct publisher *publisher_create(uv_loop_t *loop, const char *farm, struct committer *committer,
                                   publisher_on_done *on_done, void *user)
{
    struct publisher *publisher = xcalloc(1, sizeof *publisher);

    publisher->loop = loop;
    publisher->farm = farm;
    publisher->committer = committer;
    publisher->on_done = on_done;
    publisher->user = user;
    return publisher;
}

void publisher_destroy(struct publisher *publisher)
{
    struct publish_lane *lane;

    if (!publisher) return;
    assert(publisher_is_idle(publisher));
    while ((lane = publisher->lanes)) {
        publisher->lanes = lane->next;
        free(lane->intended.requests);
        for (int i = 0; i < PUBLISHER_HANDS; i++)
            free(lane->hands[i].requests.requests);
        free(lane);
    }
    free(publisher);
}

struct store_op publish_request_format_op(const struct publish_request *request, enum frame_state state)
{
    struct store_op op = {
        .kind = STORE_SET_FRAME,
        .frame = {.job = request->ticket.job,
                  .index = request->ticket.index,
                  .state = state,
                  .attempts = request->ticket.attempt,
                  .epoch = request->epoch,
                  .inode = request->file.inode,
                  .size_bytes = request->file.size_bytes,
                  .render_s = request->render_s,
                  .encode_s = request->encode_s,
                  .audit_s = request->audit_s,
                  .accuracy = request->accuracy},
    };

    memcpy(op.frame.hash, request->file.hash, sizeof op.frame.hash);
    return op;
}

static void list_add(struct publish_list *list, struct publish_request *request)
{
    list->requests = xgrow(list->requests, &list->capacity, list->count + 1, sizeof(struct publish_request *));
    list->requests[list->count++] = request;
}

// Begins to publish the request, whose intent is on disk or not needed.
static void put_in_lane(struct publisher *publisher, struct publish_request *request)
{
    const struct root *root = request->record->output_root;
    struct publish_lane *lane = publisher->lanes;

    while (lane && lane->root != root)
        lane = lane->next;
    if (!lane) {
        lane = xcalloc(1, sizeof *lane);
        *lane = (struct publish_lane){.publisher = publisher, .root = root, .next = publisher->lanes};
        for (int i = 0; i < PUBLISHER_HANDS; i++) {
            lane->hands[i].lane = lane;
            lane->hands[i].work.data = &lane->hands[i];
        }
        publisher->lanes = lane;
    }
    list_add(&lane->intended, request);
    start_hands(lane);
}

void publisher_put(struct publisher *publisher, const struct publish_request *request)
{
    struct publish_intent *intent = xmalloc(sizeof *intent);
    struct store_op op = publish_request_format_op(request, FRAME_RUNNING);

    *intent = (struct publish_intent){.publisher = publisher, .request = xmalloc(sizeof *request)};
    *intent->request = *request;
    publisher->uncommitted++;
    committer_put(publisher->committer, COMMIT_CERTAIN, &op, 1, on_intent_committed, intent);
}

void publisher_put_found(struct publisher *publisher, const struct publish_request *request)
{
    struct publish_request *copy = xmalloc(sizeof *copy);

    *copy = *request;
    copy->is_found = true;
    put_in_lane(publisher, copy);
}

static bool is_working(const struct publish_lane *lane)
{
    for (int i = 0; i < PUBLISHER_HANDS; i++)
        if (lane->hands[i].is_working) return true;
    return false;
}

bool publisher_is_idle(const struct publisher *publisher)
{
    const struct publish_lane *lane = publisher->lanes;

    while (lane && lane->intended.count == 0 && !is_working(lane))
        lane = lane->next;
    return publisher->uncommitted == 0 && !lane;
}

bool publisher_is_full(const struct publisher *publisher)
{
    size_t count = publisher->uncommitted;

    for (const struct publish_lane *lane = publisher->lanes; lane; lane = lane->next)
        count += lane->intended.count;
    return count >= PUBLISHER_FULL;
}

static void on_intent_committed(void *user, bool ok, const struct error *error)
{
    struct publish_intent *intent = user;
    struct publisher *publisher = intent->publisher;

    publisher->uncommitted--;
    put_in_lane(publisher, intent->request);
    free(intent);
}

static void start_hand(struct publish_hand *hand)
{
    struct publish_list *waiting = &hand->lane->intended;
    size_t count = waiting->count < PUBLISHER_BATCH ? waiting->count : PUBLISHER_BATCH;

    for (size_t i = 0; i < count; i++)
        list_add(&hand->requests, waiting->requests[i]);
    waiting->count -= count;
    memmove(waiting->requests, waiting->requests + count, waiting->count * sizeof(struct publish_request *));
    hand->is_working = true;
    uv_queue_work(hand->lane->publisher->loop, &hand->work, on_publish_run, on_publish_done);
}

// Few requests wait for the hand that works: one sync of their folder is for all of them.
static void start_hands(struct publish_lane *lane)
{
    size_t least = is_working(lane) ? PUBLISHER_BATCH : 1;

    for (int i = 0; i < PUBLISHER_HANDS && lane->intended.count >= least; i++) {
        if (lane->hands[i].is_working) continue;
        start_hand(&lane->hands[i]);
        least = PUBLISHER_BATCH;
    }
}

static int compare_requests(const void *a, const void *b)
{
    const struct publish_request *left = *(struct publish_request *const *)a;
    const struct publish_request *right = *(struct publish_request *const *)b;

    if (left->ticket.job != right->ticket.job) return left->ticket.job < right->ticket.job ? -1 : 1;
    return left->ticket.index < right->ticket.index ? -1 : left->ticket.index > right->ticket.index;
}

static void fail(struct publish_request *request, enum publish_outcome outcome, const struct error *error)
{
    free(request->error);
    request->outcome = outcome;
    request->error = xstrdup(error->message);
}

// Files of a batch are awaited together, however many are missing.
static int64_t wait_of_ms(const struct publish_request *request)
{
    uint64_t now_ns = uv_hrtime();

    return request->seen_by_ns > now_ns ? (int64_t)((request->seen_by_ns - now_ns) / 1000000) : 0;
}

static void publish_one(const char *farm, struct publish_request *request, int folder)
{
    const struct output_path *path = &request->record->path;
    const struct output_part names = {.farm = farm,
                                      .job = request->ticket.job,
                                      .epoch = request->epoch,
                                      .frame = request->ticket.frame,
                                      .attempt = request->ticket.attempt};
    char part[OUTPUT_NAME_SIZE], name[OUTPUT_NAME_SIZE];
    struct error error = {0};
    bool ok;

    output_path_format_name(path, request->ticket.frame, name);
    if (request->is_found) {
        ok = publish_check_found(folder, name, &request->file, &error);
    } else {
        output_path_format_part(path, &names, part);
        publish_await(folder, part, &request->file, wait_of_ms(request));
        ok = publish_file(folder, part, name, &request->file, &error);
    }
    if (!ok) fail(request, PUBLISH_OUTCOME_BAD_FILE, &error);
}

static void fail_group(struct publish_request **requests, size_t count, enum publish_outcome outcome,
                       const struct error *error)
{
    for (size_t i = 0; i < count; i++) {
        if (requests[i]->outcome != PUBLISH_OUTCOME_DONE && outcome != PUBLISH_OUTCOME_NO_ROOT) continue;
        fail(requests[i], outcome, error);
    }
}

static enum publish_outcome publish_in(const char *farm, struct publish_request **requests, size_t count, int root_fd,
                                       struct error *error)
{
    const struct job_record *record = requests[0]->record;
    int folder = output_path_open_below(&record->path, root_fd, record->root, false, error);
    bool ok = folder >= 0, is_changed = false;

    for (size_t i = 0; i < count && ok; i++) {
        publish_one(farm, requests[i], folder);
        is_changed = is_changed || !requests[i]->is_found;
    }
    if (ok && is_changed) ok = publish_sync(folder, error);
    if (folder >= 0) close(folder);
    // What was unmounted since has the files: they count once it is back, when their frames are found there.
    if (output_root_is_at(root_fd, record->root)) return ok ? PUBLISH_OUTCOME_DONE : PUBLISH_OUTCOME_BAD_FOLDER;
    error_set(error, "output root %s was taken away while files were published in it", record->root);
    return PUBLISH_OUTCOME_NO_ROOT;
}

// `requests` are of one job, whose files share a folder.
static void publish_group(const char *farm, struct publish_request **requests, size_t count)
{
    const struct job_record *record = requests[0]->record;
    struct error error = {0};
    int root_fd = output_root_open(record->root, record->output_root->id, &error);
    enum publish_outcome outcome =
        root_fd < 0 ? PUBLISH_OUTCOME_NO_ROOT : publish_in(farm, requests, count, root_fd, &error);

    if (outcome != PUBLISH_OUTCOME_DONE) fail_group(requests, count, outcome, &error);
    if (root_fd >= 0) close(root_fd);
}

static void on_publish_run(uv_work_t *work)
{
    struct publish_hand *hand = work->data;
    struct publish_list *list = &hand->requests;
    size_t first = 0;

    qsort(list->requests, list->count, sizeof(struct publish_request *), compare_requests);
    for (size_t i = 1; i <= list->count; i++) {
        if (i < list->count && list->requests[i]->ticket.job == list->requests[first]->ticket.job) continue;
        publish_group(hand->lane->publisher->farm, list->requests + first, i - first);
        first = i;
    }
}

static void on_publish_done(uv_work_t *work, int status)
{
    struct publish_hand *hand = work->data;
    struct publisher *publisher = hand->lane->publisher;

    for (size_t i = 0; i < hand->requests.count; i++) {
        publisher->on_done(publisher->user, hand->requests.requests[i]);
        free(hand->requests.requests[i]->error);
        free(hand->requests.requests[i]);
    }
    hand->requests.count = 0;
    hand->is_working = false;
    start_hands(hand->lane);
}
