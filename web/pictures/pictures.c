// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/pictures.h"

#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "web/pictures/explanation.h"
#include "web/pictures/picture_ask.h"
#include "web/pictures/picture_faults.h"
#include "web/pictures/picture_lanes.h"
#include "web/pictures/picture_look.h"
#include "web/pictures/picture_maker.h"
#include "web/pictures/picture_query.h"
#include "web/pictures/picture_queue.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { LOOK_LIMIT_MS = 10000 };

struct pictures {
    void (*on_answers)(void *user);
    void *user;
    char *worker; // owned
    int look_ms;
    struct picture_cache cache;
    struct picture_lanes *lanes; // owned
    struct picture_maker makers[PICTURE_MAKER_LIMIT];
    char *folders[PICTURE_MAKER_LIMIT]; // owned
    size_t maker_count, started;
    pthread_t threads[PICTURE_MAKER_LIMIT];
    atomic_bool is_stopped;

    pthread_mutex_t lock; // guards what follows; lanes are entered without it
    pthread_cond_t queue_changed, checked;
    struct picture_ask_list looking, answered;
    size_t ask_count; // not answered
    struct picture_queue queue;
    struct picture_faults faults;
};

struct maker_thread {
    struct pictures *pictures;
    struct picture_maker *maker;
};

// What a maker waits for: which version is there after its picture was made.
struct picture_check {
    char key[HASH_TEXT_SIZE];
    bool is_done;
};

static const struct error too_many = {.message = "too many pictures are asked for: ask again in a moment"};

static const struct error no_answer = {.message = "the disk of its files does not answer"};

static int64_t now_ms(void)
{
    return (int64_t)(1000.0 * clock_now_s());
}

// With the lock. The caller wakes the loop afterwards.
static void answer(struct pictures *pictures, struct picture_ask *ask, enum picture_status status,
                   const struct error *error)
{
    pictures->ask_count--;
    ask->status = status;
    ask->is_answered = true;
    if (error) ask->error = *error;
    picture_ask_list_add(&pictures->answered, ask);
}

// With the lock.
static void enqueue(struct pictures *pictures, struct picture_ask *ask)
{
    const struct picture_fault *fault = picture_faults_find(&pictures->faults, ask->waiter.key, now_ms());
    bool is_new;

    if (fault)
        answer(pictures, ask, fault->status, &fault->error);
    else if (!picture_queue_add(&pictures->queue, &ask->waiter, &is_new))
        answer(pictures, ask, PICTURE_BUSY, &too_many);
    else if (is_new)
        pthread_cond_signal(&pictures->queue_changed);
}

// With the lock. Whoever waits for the look is told what came of it; `file` is the picture, if there is one.
static void end_look(struct pictures *pictures, struct picture_look *look, struct picture_file *file)
{
    struct picture_ask *ask = look->ask;

    if (look->check) {
        memcpy(look->check->key, look->key, sizeof look->check->key);
        look->check->is_done = true;
        pthread_cond_broadcast(&pictures->checked);
    }
    if (!ask) {
        picture_look_free(look);
        return;
    }
    picture_ask_list_remove(&pictures->looking, ask);
    ask->looking = NULL;
    ask->look = look;
    memcpy(ask->waiter.key, look->key, sizeof ask->waiter.key);
    if (look->status != PICTURE_READY) {
        answer(pictures, ask, look->status, &look->error);
    } else if (ask->known && strstr(ask->known, look->key)) {
        answer(pictures, ask, PICTURE_KNOWN, NULL);
    } else if (file && file->fd >= 0) {
        ask->file = *file;
        file->fd = -1;
        answer(pictures, ask, PICTURE_READY, NULL);
    } else {
        enqueue(pictures, ask);
    }
}

// With the lock. False: it cannot go on, and says why.
static bool go_on(struct pictures *pictures, struct picture_look *look, const char *lane)
{
    switch (picture_lanes_add(pictures->lanes, lane, &look->task)) {
    case LANE_ENTERED:
        return true;
    case LANE_FULL:
        look->status = PICTURE_BUSY;
        look->error = too_many;
        return false;
    case LANE_LATE:
        break;
    }
    look->status = PICTURE_SLOW;
    error_set(&look->error, "%s: its disk does not answer", lane);
    return false;
}

// By the thread that looked.
static void on_looked(struct lane_task *task, void *user)
{
    struct picture_look *look = picture_look_of(task);
    const char *lane = picture_look_lane(look);
    struct picture_file file = {.fd = -1};
    struct pictures *pictures = user;

    if (!lane && look->status == PICTURE_READY) (void)picture_cache_find(&pictures->cache, look->key, &file);
    pthread_mutex_lock(&pictures->lock);
    if (!lane || !(look->ask || look->check) || !go_on(pictures, look, lane)) end_look(pictures, look, &file);
    pthread_mutex_unlock(&pictures->lock);
    picture_file_close(&file);
    pictures->on_answers(pictures->user);
}

static void on_look_left(struct lane_task *task)
{
    picture_look_free(picture_look_of(task));
}

// Waits for the look. False: the disk does not answer, or all ends.
static bool wait_for_check(struct pictures *pictures, struct picture_look *look, struct picture_check *check)
{
    struct timespec until;
    int cause = 0;

    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_sec += pictures->look_ms / 1000 + 1;
    look->check = check;
    pthread_mutex_lock(&pictures->lock);
    if (!go_on(pictures, look, picture_look_lane(look))) end_look(pictures, look, NULL);
    while (!check->is_done && !cause && !atomic_load(&pictures->is_stopped))
        cause = pthread_cond_timedwait(&pictures->checked, &pictures->lock, &until);
    if (!check->is_done) look->check = NULL;
    pthread_mutex_unlock(&pictures->lock);
    return check->is_done;
}

// A file that was replaced meanwhile may have given a picture of either version.
static enum picture_status check_version(struct pictures *pictures, const struct picture_look *model,
                                         struct error *error)
{
    struct picture_check check = {0};
    struct picture_look *look = picture_look_create(&model->query, model->subject, model->worker, &model->roots);

    if (!wait_for_check(pictures, look, &check)) {
        *error = no_answer;
        return PICTURE_SLOW;
    }
    if (!strcmp(check.key, model->key)) return PICTURE_READY;
    error_set(error, "a file was replaced meanwhile: ask again");
    return PICTURE_BUSY;
}

static enum picture_status make(struct pictures *pictures, struct picture_maker *maker,
                                const struct picture_look *model, struct picture_file *file, struct error *error)
{
    const struct explanation explanation = {
        .document = model->subject, .worker = model->worker, .roots = &model->roots};
    char facts[PICTURE_MADE_FACTS + 1] = "{}";
    enum picture_status status;

    if (model->query.form == PICTURE_FORM_EXPLANATION)
        status = picture_maker_explain(maker, &explanation, error);
    else
        status = picture_maker_run(maker, &model->place, &model->query, facts, error);
    if (status == PICTURE_READY) status = check_version(pictures, model, error);
    if (status != PICTURE_READY) return status;
    if (picture_cache_take(&pictures->cache, model->key, facts, maker->folder_fd, picture_maker_file, file, error))
        return PICTURE_READY;
    return PICTURE_NO_ROOM;
}

// With the lock. Each gets a descriptor of its own.
static void answer_all(struct pictures *pictures, struct picture_waiter *waiters, enum picture_status status,
                       struct picture_file *file, const struct error *error)
{
    while (waiters) {
        struct picture_ask *ask = picture_ask_of(waiters);

        waiters = waiters->next;
        if (status == PICTURE_READY) {
            ask->file = *file;
            ask->file.fd = fcntl(file->fd, F_DUPFD_CLOEXEC, 0);
        }
        answer(pictures, ask, status == PICTURE_READY && ask->file.fd < 0 ? PICTURE_FAULT : status, error);
    }
    picture_file_close(file);
}

static void *run_maker(void *user)
{
    struct maker_thread own = *(struct maker_thread *)user;
    struct pictures *pictures = own.pictures;

    free(user);
    pthread_mutex_lock(&pictures->lock);
    while (!atomic_load(&pictures->is_stopped)) {
        struct picture_task *task = picture_queue_take(&pictures->queue);
        struct picture_file file = {.fd = -1};
        struct error error = {0};
        struct picture_look *model;
        enum picture_status status;

        if (!task) {
            pthread_cond_wait(&pictures->queue_changed, &pictures->lock);
            continue;
        }
        // Others may give up while it is made, the first one among them.
        model = picture_look_copy(picture_ask_of(task->waiters)->look);
        pthread_mutex_unlock(&pictures->lock);
        status = make(pictures, own.maker, model, &file, &error);
        pthread_mutex_lock(&pictures->lock);
        if (status != PICTURE_READY) picture_faults_note(&pictures->faults, model->key, status, &error, now_ms());
        answer_all(pictures, picture_queue_end(&pictures->queue, task), status, &file, &error);
        picture_look_free(model);
        pictures->on_answers(pictures->user);
    }
    pthread_mutex_unlock(&pictures->lock);
    return NULL;
}

static bool start_thread(pthread_t *thread, void *(*run)(void *), void *user, struct error *error)
{
    int cause = pthread_create(thread, NULL, run, user);

    if (cause) error_set_errno(error, cause, "no thread for pictures");
    return cause == 0;
}

// Signals are the loop's matter.
static bool start_threads(struct pictures *pictures, struct error *error)
{
    sigset_t all, before;
    bool ok = true;

    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (ok && pictures->started < pictures->maker_count) {
        struct maker_thread *own = xcalloc(1, sizeof *own);

        *own = (struct maker_thread){pictures, &pictures->makers[pictures->started]};
        ok = start_thread(&pictures->threads[pictures->started], run_maker, own, error);
        if (ok)
            pictures->started++;
        else
            free(own);
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return ok;
}

static bool open_makers(struct pictures *pictures, const struct pictures_params *params, struct error *error)
{
    for (int i = 0; i < params->maker_count && i < PICTURE_MAKER_LIMIT; i++) {
        struct picture_maker *maker = &pictures->makers[i];

        pictures->folders[i] = xasprintf("%s/work-%d", params->cache_folder, i);
        *maker = (struct picture_maker){.program = pictures->worker,
                                        .folder = pictures->folders[i],
                                        .is_stopped = &pictures->is_stopped,
                                        .memory_bytes = params->worker_bytes,
                                        .limit_ms = params->limit_ms};
        if (!picture_maker_open(maker, error)) return false;
        pictures->maker_count++;
    }
    return true;
}

struct pictures *pictures_create(const struct pictures_params *params, struct error *error)
{
    struct pictures *pictures = xcalloc(1, sizeof *pictures);

    if (!picture_cache_open(&pictures->cache, params->cache_folder, params->cache_bytes, error)) {
        free(pictures);
        return NULL;
    }
    pictures->on_answers = params->on_answers;
    pictures->user = params->user;
    pictures->worker = xstrdup(params->worker);
    pthread_mutex_init(&pictures->lock, NULL);
    pthread_cond_init(&pictures->queue_changed, NULL);
    pthread_cond_init(&pictures->checked, NULL);
    picture_ask_list_init(&pictures->looking);
    picture_ask_list_init(&pictures->answered);
    pictures->look_ms = params->limit_ms < LOOK_LIMIT_MS ? params->limit_ms : LOOK_LIMIT_MS;
    pictures->lanes = picture_lanes_create(&(struct picture_lanes_params){.run = picture_look_run,
                                                                          .done = on_looked,
                                                                          .release = on_look_left,
                                                                          .user = pictures,
                                                                          .late_ms = pictures->look_ms});
    if (open_makers(pictures, params, error) && start_threads(pictures, error)) return pictures;
    pictures_destroy(pictures);
    return NULL;
}

static void stop_threads(struct pictures *pictures)
{
    pthread_mutex_lock(&pictures->lock);
    atomic_store(&pictures->is_stopped, true);
    pthread_cond_broadcast(&pictures->queue_changed);
    pthread_cond_broadcast(&pictures->checked);
    pthread_mutex_unlock(&pictures->lock);
    for (size_t i = 0; i < pictures->started; i++)
        pthread_join(pictures->threads[i], NULL);
    picture_lanes_stop(pictures->lanes);
}

static void free_waiting(struct pictures *pictures)
{
    struct picture_task *task;
    struct picture_ask *ask;

    while ((task = picture_queue_take(&pictures->queue))) {
        struct picture_waiter *waiter = picture_queue_end(&pictures->queue, task);

        while (waiter) {
            struct picture_waiter *next = waiter->next;

            picture_ask_free(picture_ask_of(waiter));
            waiter = next;
        }
    }
    while ((ask = picture_ask_list_take(&pictures->looking)))
        picture_ask_free(ask);
    while ((ask = picture_ask_list_take(&pictures->answered)))
        picture_ask_free(ask);
}

void pictures_destroy(struct pictures *pictures)
{
    stop_threads(pictures);
    free_waiting(pictures);
    for (size_t i = 0; i < pictures->maker_count; i++)
        picture_maker_close(&pictures->makers[i]);
    for (size_t i = 0; i < PICTURE_MAKER_LIMIT; i++)
        free(pictures->folders[i]);
    picture_cache_close(&pictures->cache);
    pthread_cond_destroy(&pictures->queue_changed);
    pthread_cond_destroy(&pictures->checked);
    pthread_mutex_destroy(&pictures->lock);
    free(pictures->worker);
    free(pictures);
}

struct picture_ask *pictures_ask(struct pictures *pictures, const struct picture_question *question, void *user)
{
    struct picture_ask *ask = xcalloc(1, sizeof *ask);
    struct picture_look *look =
        picture_look_create(question->query, question->subject, pictures->worker, question->roots);

    *ask = (struct picture_ask){.waiter.user = question->user, .user = user, .looking = look, .file.fd = -1};
    ask->known = question->known ? xstrdup(question->known) : NULL;
    ask->until_ms = now_ms() + pictures->look_ms;
    look->ask = ask;
    pthread_mutex_lock(&pictures->lock);
    picture_ask_list_add(&pictures->looking, ask);
    pictures->ask_count++;
    if (pictures->ask_count > 2 * PICTURE_WAIT_LIMIT) {
        look->status = PICTURE_BUSY;
        look->error = too_many;
    }
    if (look->status != PICTURE_READY || !go_on(pictures, look, picture_look_lane(look))) {
        end_look(pictures, look, NULL);
        pictures->on_answers(pictures->user);
    }
    pthread_mutex_unlock(&pictures->lock);
    return ask;
}

// With the lock. Its thread may have it for ever; whoever waited gives up.
static void leave_look(struct pictures *pictures, struct picture_ask *ask)
{
    picture_ask_list_remove(&pictures->looking, ask);
    ask->looking->ask = NULL;
    ask->looking = NULL;
}

bool pictures_expire(struct pictures *pictures)
{
    int64_t now = now_ms();
    bool is_any;

    pthread_mutex_lock(&pictures->lock);
    // They were asked one after the other.
    while (pictures->looking.first && pictures->looking.first->until_ms <= now) {
        struct picture_ask *ask = pictures->looking.first;

        leave_look(pictures, ask);
        answer(pictures, ask, PICTURE_SLOW, &no_answer);
        pictures->on_answers(pictures->user);
    }
    is_any = pictures->looking.first;
    pthread_mutex_unlock(&pictures->lock);
    return is_any;
}

void pictures_drop(struct pictures *pictures, struct picture_ask *ask)
{
    pthread_mutex_lock(&pictures->lock);
    if (ask->is_answered) {
        picture_ask_list_remove(&pictures->answered, ask);
    } else {
        if (ask->looking)
            leave_look(pictures, ask);
        else
            picture_queue_drop(&pictures->queue, &ask->waiter);
        pictures->ask_count--;
    }
    pthread_mutex_unlock(&pictures->lock);
    picture_ask_free(ask);
}

struct picture_ask *pictures_take_answer(struct pictures *pictures)
{
    struct picture_ask *ask;

    pthread_mutex_lock(&pictures->lock);
    ask = picture_ask_list_take(&pictures->answered);
    pthread_mutex_unlock(&pictures->lock);
    return ask;
}

struct picture_answer picture_ask_answer(struct picture_ask *ask)
{
    struct picture_answer answer = {.status = ask->status, .file = &ask->file};

    memcpy(answer.key, ask->waiter.key, sizeof answer.key);
    if (ask->status != PICTURE_READY && ask->status != PICTURE_KNOWN) answer.reason = ask->error.message;
    return answer;
}

void *picture_ask_user(const struct picture_ask *ask)
{
    return ask->user;
}
