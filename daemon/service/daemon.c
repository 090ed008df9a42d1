// SPDX-License-Identifier: Apache-2.0
#include "daemon/service/daemon.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "daemon/clients/listener.h"
#include "daemon/farm/farm.h"
#include "daemon/farm/limits.h"
#include "daemon/farm/pool_access.h"
#include "daemon/farm/shares.h"
#include "daemon/jobs/after_desk.h"
#include "daemon/jobs/events.h"
#include "daemon/jobs/feed.h"
#include "daemon/jobs/frame_life.h"
#include "daemon/jobs/job_ageing.h"
#include "daemon/jobs/job_delete.h"
#include "daemon/jobs/job_life.h"
#include "daemon/jobs/job_retry.h"
#include "daemon/jobs/late_sweep.h"
#include "daemon/jobs/notice_watch.h"
#include "daemon/jobs/root_desks.h"
#include "daemon/jobs/root_life.h"
#include "daemon/loop/loop_turns.h"
#include "daemon/loop/memory_return.h"
#include "daemon/loop/work_desk.h"
#include "daemon/metrics/metrics.h"
#include "daemon/output/publisher.h"
#include "daemon/output/root_watch.h"
#include "daemon/output/sweeper.h"
#include "daemon/requests/job_submit.h"
#include "daemon/requests/requests.h"
#include "daemon/service/folders.h"
#include "daemon/service/manager.h"
#include "daemon/service/opening.h"
#include "daemon/service/restore.h"
#include "daemon/service/root_settings.h"
#include "daemon/service/watchdog.h"
#include "daemon/settings/options.h"
#include "daemon/settings/reload.h"
#include "daemon/store/committer.h"
#include "daemon/store/store.h"
#include "daemon/store/store_keeper.h"
#include "daemon/store/store_reader.h"
#include "daemon/workers/worker_pool.h"

#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

enum {
    GIVE_UP_MS = 5000, // the wait for a store that does not commit, when stopping
    FIRST_LOOK_MS = 10 * 1000,
    LOOK_INTERVAL_MS = 10 * 60 * 1000 // between looks at the sums of the store's rows
};

enum daemon_phase {
    DAEMON_RUNNING,
    DAEMON_STOPPING, // workers finish the frames that they began
    DAEMON_FLUSHING, // their frames are published and committed
    DAEMON_CLOSING   // handles are being closed
};

struct daemon {
    uv_loop_t loop;
    struct farm farm;
    struct loop_task feed; // feeding goes on in the next turn
    struct store *store;
    struct listener *listener;
    struct store_keeper *keeper;
    struct watchdog *watchdog; // NULL: the service manager wants none
    struct manager *manager;
    struct root_watch *roots;
    struct job_ageing *ageing;
    struct notice_watch *notices;
    struct options *options; // borrowed; outlive us
    daemon_read_options *read_options;
    void *read_user; // borrowed; outlives us
    uv_signal_t terminate, interrupt, hang_up;
    uv_prepare_t iteration; // called at the end of each iteration of the loop
    enum daemon_phase phase;
    int64_t flushing_since_ms;
};

static void on_swept(void *user, struct job_record *record, bool was_away);
static void on_root_op(void *user, struct store_op op);
static bool on_feed_step(struct loop_task *feed);
static void on_slot_changed(struct farm *farm, int slot_index);
static void on_store_trouble(void *user);
static bool may_look_at_store(void *user);
static void on_store_repaired(void *user);
static void on_message(void *user, struct client *client, struct message *message);
static void on_client_gone(void *user, struct client *client);
static void on_iteration(uv_prepare_t *iteration);
static void on_signal(uv_signal_t *handle, int signal_number);
static void on_hang_up(uv_signal_t *handle, int signal_number);
static bool on_reload_request(void *user, const char *asked_by, struct reload_changes *changes, struct error *error);

static const struct worker_pool_handlers pool_handlers = {.on_frame_report = frame_life_note_report,
                                                          .on_frames_lost = frame_life_lose_frames,
                                                          .on_job_refused = root_life_refuse,
                                                          .on_slot_changed = on_slot_changed};

static bool open_store(struct daemon *daemon, const struct options *options, struct error *error)
{
    if (!folders_make(options->state_folder, 0700, error)) return false;
    daemon->store = opening_wait(options->state_folder, error);
    if (!daemon->store) return false;
    daemon->farm.reader = store_reader_open(options->state_folder, error);
    return daemon->farm.reader != NULL;
}

static void create_modules(struct daemon *daemon, const struct options *options)
{
    struct farm *farm = &daemon->farm;
    int workers = options->worker_count ? options->worker_count : (int)uv_available_parallelism();

    farm->turns = loop_turns_open(farm->loop);
    farm->work = work_desk_create(farm->loop);
    farm->root_desks = root_desks_create(farm->loop);
    farm->memory = memory_return_open(farm->loop);
    farm->committer = committer_create(farm->loop, daemon->store);
    committer_watch(farm->committer, on_store_trouble, daemon);
    farm->publisher = publisher_create(farm->loop, farm->id, farm->committer, frame_life_on_published, farm);
    farm->checker = publisher_create(farm->loop, farm->id, farm->committer, frame_life_on_published, farm);
    farm->sweeper = sweeper_create(farm->loop, farm->id, on_swept, farm);
    farm->events = events_create(farm);
    daemon->roots = root_watch_create(farm, root_life_note_change);
    daemon->ageing = job_ageing_create(farm);
    daemon->notices = notice_watch_open(farm);
    farm->pool = worker_pool_create(farm, workers > 0 ? workers : 0, &pool_handlers);
    daemon->keeper = store_keeper_open(farm->loop, &(struct store_keeper_params){.folder = options->state_folder,
                                                                                 .first_ms = FIRST_LOOK_MS,
                                                                                 .interval_ms = LOOK_INTERVAL_MS,
                                                                                 .may_run = may_look_at_store,
                                                                                 .on_repair = on_store_repaired,
                                                                                 .user = daemon});
    daemon->watchdog = watchdog_open(farm->loop);
    daemon->manager = manager_open(farm);
    uv_signal_init(farm->loop, &daemon->terminate);
    uv_signal_init(farm->loop, &daemon->interrupt);
    uv_signal_init(farm->loop, &daemon->hang_up);
    uv_prepare_init(farm->loop, &daemon->iteration);
    daemon->terminate.data = daemon->interrupt.data = daemon->hang_up.data = daemon->iteration.data = daemon;
}

static bool listen_for_clients(struct daemon *daemon, const struct options *options, struct error *error)
{
    const struct listener_params params = {.path = options->socket_path,
                                           .turns = daemon->farm.turns,
                                           .desk = daemon->farm.work,
                                           .memory = daemon->farm.memory,
                                           .rights = &daemon->farm.rights,
                                           .on_message = on_message,
                                           .on_gone = on_client_gone,
                                           .user = daemon};

    daemon->listener = listener_open(&daemon->loop, &params, error);
    return daemon->listener != NULL;
}

static void start(struct daemon *daemon)
{
    uv_signal_start(&daemon->terminate, on_signal, SIGTERM);
    uv_signal_start(&daemon->interrupt, on_signal, SIGINT);
    uv_signal_start(&daemon->hang_up, isatty(STDERR_FILENO) ? on_signal : on_hang_up, SIGHUP);
    uv_prepare_start(&daemon->iteration, on_iteration);
    worker_pool_start(daemon->farm.pool);
    restore_end_jobs(&daemon->farm);
    after_desk_start(daemon->farm.after);
    farm_want_feed(&daemon->farm);
    log_info("marchd %s: jobs: %zu; frames: %lld queued; output below %s", MARCHD_VERSION, daemon->farm.jobs.count,
             (long long)queue_count(daemon->farm.queue, FRAME_QUEUED), daemon->farm.options->output_roots.paths[0]);
    manager_notify_ready(daemon->manager);
}

static void close_all(struct daemon *daemon)
{
    daemon->phase = DAEMON_CLOSING;
    if (daemon->listener) listener_close(daemon->listener);
    store_keeper_close(daemon->keeper);
    loop_turns_close(daemon->farm.turns);
    memory_return_close(daemon->farm.memory);
    watchdog_close(daemon->watchdog);
    manager_close(daemon->manager);
    root_watch_close(daemon->roots);
    notice_watch_close(daemon->notices);
    worker_pool_close(daemon->farm.pool);
    events_close(daemon->farm.events);
    committer_close(daemon->farm.committer);
    uv_close((uv_handle_t *)&daemon->terminate, NULL);
    uv_close((uv_handle_t *)&daemon->interrupt, NULL);
    uv_close((uv_handle_t *)&daemon->hang_up, NULL);
    uv_close((uv_handle_t *)&daemon->iteration, NULL);
}

struct daemon *daemon_create(struct options *options, daemon_read_options *read_options, void *user,
                             struct error *error)
{
    struct daemon *daemon = xcalloc(1, sizeof *daemon);
    struct farm *farm = &daemon->farm;

    daemon->options = options;
    daemon->read_options = read_options;
    daemon->read_user = user;
    memory_return_prepare();
    uv_loop_init(&daemon->loop);
    daemon->feed.step = on_feed_step;
    farm->loop = &daemon->loop;
    farm->options = options;
    farm->queue = queue_create(options->max_attempts);
    farm->metrics = xcalloc(1, sizeof *farm->metrics);
    farm->started_ms = farm_clock_ms();
    farm->rights.daemon_uid = geteuid();
    farm->after = after_desk_create(farm);
    farm->reload = on_reload_request;
    farm->reload_user = daemon;
    if (!open_store(daemon, options, error) || !restore_farm(farm, daemon->store, error)) {
        daemon_destroy(daemon);
        return NULL;
    }
    create_modules(daemon, options);
    if (!listen_for_clients(daemon, options, error)) {
        close_all(daemon);
        daemon_destroy(daemon);
        return NULL;
    }
    start(daemon);
    return daemon;
}

void daemon_run(struct daemon *daemon)
{
    uv_run(&daemon->loop, UV_RUN_DEFAULT);
}

void daemon_destroy(struct daemon *daemon)
{
    struct farm *farm;

    if (!daemon) return;
    farm = &daemon->farm;
    uv_run(&daemon->loop, UV_RUN_DEFAULT);
    worker_pool_destroy(farm->pool);
    root_watch_destroy(daemon->roots);
    job_ageing_destroy(daemon->ageing);
    after_desk_destroy(farm->after);
    events_destroy(farm->events);
    sweeper_destroy(farm->sweeper);
    publisher_destroy(farm->checker);
    publisher_destroy(farm->publisher);
    committer_destroy(farm->committer);
    root_desks_destroy(farm->root_desks);
    work_desk_destroy(farm->work);
    queue_destroy(farm->queue);
    job_table_finish(&farm->jobs);
    root_table_finish(&farm->roots);
    plan_desk_finish(&farm->desk);
    late_sweep_finish(farm);
    free(farm->drain.user);
    free(farm->metrics);
    notice_list_finish(&farm->notices);
    notice_targets_finish(&farm->targets);
    quota_finish(&farm->quota);
    token_table_finish(&farm->tokens);
    store_reader_close(farm->reader);
    store_close(daemon->store);
    // An open handle is a bug: its memory is about to be freed.
    if (uv_loop_close(&daemon->loop) != 0) abort();
    free(daemon);
}

static void on_root_op(void *user, struct store_op op)
{
    farm_store(user, op);
}

static void on_swept(void *user, struct job_record *record, bool was_away)
{
    struct farm *farm = user;

    job_life_note_swept(farm, record, was_away);
    job_retry_go_on(farm, record);
    job_delete_go_on(farm);
    job_submit_go_on(farm);
}

static bool on_feed_step(struct loop_task *feed)
{
    farm_want_feed(&((struct daemon *)((char *)feed - offsetof(struct daemon, feed)))->farm);
    return false;
}

static void on_slot_changed(struct farm *farm, int slot_index)
{
    events_send_worker(farm->events, slot_index);
}

static bool may_look_at_store(void *user)
{
    const struct daemon *daemon = user;

    return daemon->phase == DAEMON_RUNNING && !committer_trouble(daemon->farm.committer);
}

// The backup may have an older state of a job, or none.
static void on_store_repaired(void *user)
{
    struct farm *farm = &((struct daemon *)user)->farm;

    for (size_t i = 0; i < farm->jobs.count; i++)
        if (!farm->jobs.records[i]->is_unreadable) farm_store_job(farm, farm->jobs.records[i]);
}

static void on_store_trouble(void *user)
{
    struct daemon *daemon = user;

    events_note_reasons(daemon->farm.events);
    farm_want_feed(&daemon->farm);
}

static void on_message(void *user, struct client *client, struct message *message)
{
    struct daemon *daemon = user;

    requests_handle(&daemon->farm, client, message);
}

static void on_client_gone(void *user, struct client *client)
{
    struct daemon *daemon = user;

    events_forget(daemon->farm.events, client);
}

static void begin_stop(struct daemon *daemon)
{
    if (queue_count(daemon->farm.queue, FRAME_RUNNING) > 0)
        log_info("stopping: running frames get %lld s", (long long)daemon->farm.options->stop_timeout_ms / 1000);
    else
        log_info("stopping: no frame is running");
    daemon->phase = DAEMON_STOPPING;
    manager_notify_stopping(daemon->manager, daemon->farm.options->stop_timeout_ms);
    listener_stop(daemon->listener);
    job_ageing_stop(daemon->ageing);
    worker_pool_stop(daemon->farm.pool, daemon->farm.options->stop_timeout_ms);
}

static void on_signal(uv_signal_t *handle, int signal_number)
{
    struct daemon *daemon = handle->data;

    if (daemon->phase == DAEMON_RUNNING) {
        begin_stop(daemon);
        return;
    }
    log_warn("stopped at once by a second signal");
    _exit(128 + signal_number);
}

static void log_changes(const struct reload_changes *changes)
{
    if (changes->applied[0])
        log_info("settings: changed: %s", changes->applied);
    else
        log_info("settings: read again, none changed");
    if (changes->waiting[0]) log_warn("settings: changed, but need a restart: %s", changes->waiting);
}

static void apply_options(struct daemon *daemon, struct options *fresh, struct reload_changes *changes)
{
    bool was_quiet = daemon->options->log_level > LOG_INFO;

    reload_take(daemon->options, fresh, changes);
    if (!was_quiet) log_changes(changes);
    log_set_level(daemon->options->log_level);
    if (was_quiet) log_changes(changes);
    limits_refresh(&daemon->farm);
    pool_access_refresh(&daemon->farm);
    shares_refresh(&daemon->farm);
    root_settings_take(&daemon->farm, &daemon->options->output_roots, on_root_op, &daemon->farm);
    root_settings_tell_inputs(&daemon->options->input_roots);
    queue_set_max_attempts(daemon->farm.queue, daemon->options->max_attempts);
    worker_pool_set_progress_limit(daemon->farm.pool, daemon->options->progress_limit_ms);
    job_ageing_note_settings(daemon->ageing);
    events_note_reasons(daemon->farm.events);
    farm_want_feed(&daemon->farm);
}

// Settings that cannot be read or applied change nothing.
static bool reload(struct daemon *daemon, struct reload_changes *changes, struct error *error)
{
    struct options fresh = {0};
    bool ok;

    manager_notify_reloading(daemon->manager);
    ok = daemon->read_options(daemon->read_user, &fresh, error);
    if (ok)
        apply_options(daemon, &fresh, changes);
    else
        log_error("settings: not changed: %s", error->message);
    options_finish(&fresh);
    manager_notify_ready(daemon->manager);
    return ok;
}

static bool on_reload_request(void *user, const char *asked_by, struct reload_changes *changes, struct error *error)
{
    struct daemon *daemon = user;

    if (daemon->phase != DAEMON_RUNNING) {
        error_set(error, "settings: not changed: the daemon is stopping");
        return false;
    }
    log_info("a reload of the settings is asked for by %s", asked_by);
    if (reload(daemon, changes, error)) return true;
    error_prefix(error, "settings: not changed");
    return false;
}

static void on_hang_up(uv_signal_t *handle, int signal_number)
{
    struct daemon *daemon = handle->data;
    struct reload_changes changes;
    struct error error = {0};

    (void)signal_number;
    if (daemon->phase == DAEMON_RUNNING) reload(daemon, &changes, &error);
}

static bool is_flushed(const struct farm *farm)
{
    return publisher_is_idle(farm->publisher) && publisher_is_idle(farm->checker) && sweeper_is_idle(farm->sweeper) &&
           !farm->claims && !farm->deletions && farm->output_checks == 0 && work_desk_is_idle(farm->work) &&
           committer_is_idle(farm->committer);
}

// Files that are being published have their intent on disk: a restart finishes them. Those whose intent is not there
// are part files, which workers of the next start look for.
static void give_up_on_store(struct daemon *daemon)
{
    const char *trouble = committer_trouble(daemon->farm.committer);

    if (!trouble || farm_now_ms(&daemon->farm) - daemon->flushing_since_ms < GIVE_UP_MS) return;
    log_error("stopped with %zu changes that the store could not commit: %s", committer_waiting(daemon->farm.committer),
              trouble);
    _exit(1);
}

static void on_iteration(uv_prepare_t *iteration)
{
    struct daemon *daemon = iteration->data;

    if (daemon->phase == DAEMON_RUNNING && daemon->farm.wants_feed) {
        daemon->farm.wants_feed = false;
        if (!feed_workers(&daemon->farm)) loop_turns_put(daemon->farm.turns, &daemon->feed);
    }
    if (daemon->phase == DAEMON_RUNNING) late_sweep_run(&daemon->farm);
    if (daemon->phase == DAEMON_RUNNING) job_ageing_run(daemon->ageing);
    if (daemon->phase == DAEMON_STOPPING && worker_pool_is_empty(daemon->farm.pool)) {
        daemon->phase = DAEMON_FLUSHING;
        shares_store(&daemon->farm);
        listener_stop_reading(daemon->listener);
        work_desk_stop(daemon->farm.work);
        daemon->flushing_since_ms = farm_now_ms(&daemon->farm);
    }
    if (daemon->phase == DAEMON_FLUSHING && is_flushed(&daemon->farm))
        close_all(daemon);
    else if (daemon->phase == DAEMON_FLUSHING)
        give_up_on_store(daemon);
}
